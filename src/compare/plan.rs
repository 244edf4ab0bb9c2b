//! What is compared: contenders, and the truths that they are measured against.

use crate::scene::StrategyKind;
use crate::view::{NamedView, View};

/// What strategies are measured against.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reference {
    /// The f64 reference on the CPU.
    Cpu,
    /// The pictures of a strategy, whose own figures are perfect then.
    Strategy(StrategyKind),
}

/// What is compared, in views of the same size and of one grid.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Names of the views.
    pub views: Vec<String>,
    /// Whose pictures are measured, each name once.
    pub contenders: Vec<Contender>,
    /// What they are measured against.
    pub truths: Vec<Truth>,
    /// Frames to time for each picture, after one to warm up.
    pub frames: usize,
}

/// A way of making the pictures.
#[derive(Debug, Clone)]
pub struct Contender {
    /// What tells it from others by the same strategy, which is its name; absent where strategies are compared.
    pub setting: Option<String>,
    /// What it draws for each view of the plan.
    pub views: Vec<View>,
    /// Number of the truth that it is measured against.
    pub truth: usize,
    /// It is its truth with other random numbers: how far the two are apart is chance.
    pub is_floor: bool,
}

impl Contender {
    /// Its name in rows and files.
    pub fn name(&self) -> &str {
        self.setting
            .as_deref()
            .unwrap_or_else(|| self.strategy().name())
    }

    /// Its strategy.
    pub fn strategy(&self) -> StrategyKind {
        let first = self.views.first();
        first.map_or(StrategyKind::accurate(), |v| v.sampling.strategy)
    }
}

/// Pictures that others are measured against.
#[derive(Debug, Clone)]
pub struct Truth {
    /// Its name in rows and files.
    pub name: String,
    /// Who makes them.
    pub source: Source,
}

/// Who makes the pictures of a truth.
#[derive(Debug, Clone)]
pub enum Source {
    /// The f64 reference on the CPU, given what it draws for each view.
    Cpu(Vec<View>),
    /// A contender, by its number.
    Contender(usize),
    /// The executor, given what it draws for each view; they have no rows.
    Executor(Vec<View>),
}

/// What the truth of the f64 reference is called.
pub(super) const CPU: &str = "cpu";

impl Plan {
    /// Strategies, each once, against one reference.
    pub fn of_strategies(
        strategies: &[StrategyKind],
        reference: Reference,
        views: Vec<NamedView>,
        frames: usize,
    ) -> Self {
        let (names, views): (Vec<String>, Vec<View>) =
            views.into_iter().map(|v| (v.name, v.view)).unzip();
        let by = |kind: StrategyKind| views.iter().map(|v| v.by(kind)).collect();
        let contender = |kind: &StrategyKind| Contender {
            setting: None,
            views: by(*kind),
            truth: 0,
            is_floor: false,
        };
        let truth = match reference {
            Reference::Cpu => Truth {
                name: CPU.into(),
                source: Source::Cpu(views.clone()),
            },
            Reference::Strategy(kind) => Truth {
                name: kind.name().into(),
                source: match strategies.iter().position(|k| *k == kind) {
                    Some(n) => Source::Contender(n),
                    None => Source::Executor(by(kind)),
                },
            },
        };
        Self {
            views: names,
            contenders: strategies.iter().map(contender).collect(),
            truths: vec![truth],
            frames,
        }
    }

    /// What is drawn first.
    pub(super) fn first_view(&self) -> Option<&View> {
        self.contenders.first().and_then(|c| c.views.first())
    }

    /// Pictures of each view of a contender.
    pub(super) fn images_of(&self, contender: &Contender) -> usize {
        match contender.is_floor {
            // Nobody asks what it costs.
            true => 1,
            false => 1 + self.frames.max(1),
        }
    }

    /// Pictures of each view, of all.
    pub(super) fn images_per_view(&self) -> usize {
        let own = |t: &&Truth| !matches!(t.source, Source::Contender(_));
        let of_truths = self.truths.iter().filter(own).count();
        let of_contenders = self.contenders.iter().map(|c| self.images_of(c));
        of_contenders.sum::<usize>() + of_truths
    }

    /// File of a picture of a view; sorted by name they stand in the order of the views.
    pub(super) fn picture_file(&self, view: usize, what: &str) -> String {
        let digits = self.views.len().saturating_sub(1).to_string().len();
        let safe = |c: char| match c {
            c if c.is_ascii_alphanumeric() || "._-".contains(c) => c,
            _ => '_',
        };
        let what: String = what.chars().map(safe).collect();
        format!("view_{view:0digits$}_{what}.png")
    }
}
