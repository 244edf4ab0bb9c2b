//! Light methods side by side: one scene by each, measured against many rays.
//!
//! Methods that look to all sides have a truth of their own: what they show is not what cones toward the viewer show.

use super::plan::{CPU, Contender, Plan, Source, Truth};
use crate::scene::Scene;
use crate::scene::lighting::{LightMethod, LightMode, LightingSpec};
use crate::view::{NamedView, View};

/// A row of a comparison of light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LightRow {
    /// A method.
    Method(LightMethod),
    /// Many rays, which the others are measured against.
    Rays,
    /// No occlusion, and lights without shadows.
    Off,
}

impl LightRow {
    /// As people write it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Method(method) => method.name(),
            Self::Rays => "rays",
            Self::Off => "off",
        }
    }
}

/// What methods are measured against that look toward the viewer and the lights, or to all sides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    Toward,
    Around,
}

impl Side {
    fn of(method: LightMethod) -> Self {
        match method.is_around() {
            true => Self::Around,
            false => Self::Toward,
        }
    }

    /// A name that rows of both sides can have.
    fn named(self, name: &str) -> String {
        match self {
            Self::Toward => name.to_owned(),
            Self::Around => format!("{name} to all sides"),
        }
    }
}

/// How light of a scene is found in a row of one side.
fn lit(scene: &Scene, row: LightRow, side: Side) -> Scene {
    let mut scene = scene.clone();
    let lighting = &mut scene.lighting;
    match row {
        LightRow::Off => {
            lighting.occlusion = None;
            lighting.shadows.mode = LightMode::Off;
        }
        LightRow::Rays => by_rays(lighting, side),
        LightRow::Method(method) => by_method(lighting, method),
    }
    scene
}

/// A scene whose light is found by many rays.
pub(super) fn rays_of(scene: &Scene) -> Scene {
    let occlusion = scene.lighting.occlusion;
    let side = Side::of(occlusion.map_or_else(LightMethod::default, |o| o.method));
    let mut lit = lit(scene, LightRow::Rays, side);
    if let (Some(to), Some(from)) = (&mut lit.lighting.occlusion, occlusion)
        && from.mode == LightMode::Off
    {
        to.mode = LightMode::Off;
    }
    lit
}

/// A scene with other random numbers.
pub(super) fn reseeded(scene: &Scene) -> Scene {
    let mut other = scene.clone();
    other.lighting.seed = other.lighting.seed.wrapping_add(1);
    other
}

fn by_rays(lighting: &mut LightingSpec, side: Side) {
    if let Some(occlusion) = &mut lighting.occlusion {
        occlusion.mode = LightMode::MonteCarlo;
        occlusion.method = match side {
            Side::Toward => LightMethod::Cones,
            Side::Around => LightMethod::Surround,
        };
    }
    if lighting.shadows.mode != LightMode::Off {
        lighting.shadows.mode = LightMode::MonteCarlo;
    }
}

fn by_method(lighting: &mut LightingSpec, method: LightMethod) {
    // Rays are no method, and what looks to all sides is found before the image.
    let found = |mode| match mode {
        LightMode::MonteCarlo => LightMode::Preilluminated,
        mode => mode,
    };
    if let Some(occlusion) = &mut lighting.occlusion {
        occlusion.method = method;
        occlusion.mode = match method.is_around() {
            true => LightMode::Preilluminated,
            false => found(occlusion.mode),
        };
    }
    lighting.shadows.mode = found(lighting.shadows.mode);
    if !method.is_around() {
        lighting.shadows.method = method;
    }
}

impl Plan {
    /// Light methods, each once, by the strategy of a scene, in the views that `views` makes of a scene. They are
    /// measured against many rays, or where `uses_cpu` is true against the f64 reference. A scene without light gets
    /// occlusion.
    ///
    /// # Errors
    /// Those of `views`.
    pub fn of_light<E>(
        rows: &[LightRow],
        scene: &Scene,
        uses_cpu: bool,
        frames: usize,
        views: impl Fn(&Scene) -> Result<Vec<NamedView>, E>,
    ) -> Result<Self, E> {
        let mut scene = scene.clone();
        let lighting = &mut scene.lighting;
        lighting
            .occlusion
            .take_if(|occlusion| occlusion.mode == LightMode::Off);
        let looks = |side| {
            let is_of = |row: &LightRow| matches!(row, LightRow::Method(m) if Side::of(*m) == side);
            rows.iter().any(is_of)
        };
        if lighting.lights.is_empty() || looks(Side::Around) {
            lighting.occlusion.get_or_insert_default();
        }
        let mut sides = vec![Side::Toward, Side::Around];
        sides.retain(|side| looks(*side));
        if sides.is_empty() {
            sides.push(Side::Toward);
        }
        let mut plan = Self {
            views: views(&scene)?.into_iter().map(|v| v.name).collect(),
            contenders: Vec::new(),
            truths: Vec::new(),
            frames,
        };
        let drawn = |scene: &Scene| -> Result<Vec<View>, E> {
            Ok(views(scene)?.into_iter().map(|v| v.view).collect())
        };
        for side in sides {
            plan.add_side(side, rows, &scene, uses_cpu, &drawn)?;
        }
        Ok(plan)
    }

    fn add_side<E>(
        &mut self,
        side: Side,
        rows: &[LightRow],
        scene: &Scene,
        uses_cpu: bool,
        drawn: &dyn Fn(&Scene) -> Result<Vec<View>, E>,
    ) -> Result<(), E> {
        let truth = self.truths.len();
        let rays = side.named(LightRow::Rays.name());
        let mut of_rays = None;
        for row in rows {
            let setting = match row {
                LightRow::Method(method) if Side::of(*method) != side => continue,
                LightRow::Method(method) => method.name().to_owned(),
                LightRow::Rays => rays.clone(),
                LightRow::Off => side.named(row.name()),
            };
            if *row == LightRow::Rays {
                of_rays = Some(self.contenders.len());
            }
            self.contenders.push(Contender {
                setting: Some(setting),
                views: drawn(&lit(scene, *row, side))?,
                truth,
                is_floor: false,
            });
        }
        let by_rays = lit(scene, LightRow::Rays, side);
        let views = drawn(&by_rays)?;
        self.truths.push(match (uses_cpu, of_rays) {
            (true, _) => Truth {
                name: side.named(CPU),
                source: Source::Cpu(views),
            },
            (false, Some(number)) => Truth {
                name: rays.clone(),
                source: Source::Contender(number),
            },
            (false, None) => Truth {
                name: rays.clone(),
                source: Source::Executor(views),
            },
        });
        if !uses_cpu {
            // The f64 reference has no random numbers.
            self.contenders.push(Contender {
                setting: Some(format!("{rays} again")),
                views: drawn(&reseeded(&by_rays))?,
                truth,
                is_floor: true,
            });
        }
        Ok(())
    }
}
