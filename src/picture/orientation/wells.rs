//! Names of wells at their heads.

use glam::DVec2;

use super::{Area, Paper, Text, overlap};
use crate::view::View;
use crate::view::wells::Head;

/// Names of wells as they are laid out.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct WellNames {
    /// The names, and how many there was no room for where that is so.
    pub texts: Vec<Text>,
    /// Lines from heads to the names that stand apart from them.
    pub leaders: Vec<[DVec2; 2]>,
}

/// How far names stand apart from heads, in text heights: beside them as long as there is room, else with a line.
const APART: [f64; 3] = [0.0, 1.5, 3.0];

/// Around a head: above, beside and below it, then between these.
const SIDES: [DVec2; 8] = [
    DVec2::NEG_Y,
    DVec2::X,
    DVec2::NEG_X,
    DVec2::Y,
    DVec2::new(1.0, -1.0),
    DVec2::new(-1.0, -1.0),
    DVec2::new(1.0, 1.0),
    DVec2::new(-1.0, 1.0),
];

/// Names of the wells that a view shows, around their heads. Wells that flow are named before those that are shut, and of
/// each the nearest to the viewer first. A name that would lie on another one, or leave the picture, is left out, and one
/// line says how many are.
pub fn well_names(view: &View, paper: &Paper<'_>) -> WellNames {
    let mut heads: Vec<&Head> = view.shown.wells.heads.iter().collect();
    let depth = |head: &Head| view.camera.depth(head.at);
    heads.sort_by(|a, b| depth(a).total_cmp(&depth(b)));
    heads.sort_by_key(|head| !head.is_open);
    let mut taken = paper.taken.clone();
    let mut names = WellNames::default();
    let mut hidden = 0_usize;
    for head in heads {
        let Some(disc) = Disc::of(view, paper, head) else {
            continue;
        };
        let Some((area, leader)) = disc.place(paper, &head.name, &taken) else {
            hidden += 1;
            continue;
        };
        taken.push(area);
        names.leaders.extend(leader);
        names.texts.push(Text {
            text: head.name.clone(),
            middle: 0.5 * (area[0] + area[1]),
            height: paper.unit,
        });
    }
    names.texts.extend(left_out(hidden, paper));
    names
}

/// One line on names that there was no room for, upper left, as long as fits.
fn left_out(count: usize, paper: &Paper<'_>) -> Option<Text> {
    let words = match count {
        0 => return None,
        1 => ["1 name of a well is hidden behind others", "1 name hidden"].map(str::to_owned),
        _ => [
            format!("{count} names of wells are hidden behind others"),
            format!("{count} names hidden"),
        ],
    };
    let fits = |text: &String| (paper.width)(text) + 1.2 * paper.unit <= paper.size.x;
    let text = words.into_iter().find(fits).unwrap_or(format!("+{count}"));
    let half = 0.5 * (paper.width)(&text);
    Some(Text {
        middle: DVec2::new(0.6 * paper.unit + half, 1.2 * paper.unit),
        text,
        height: paper.unit,
    })
}

/// A head in the picture.
struct Disc {
    at: DVec2,
    radius: f64,
}

impl Disc {
    /// `None` of a head that is not in the picture.
    fn of(view: &View, paper: &Paper<'_>, head: &Head) -> Option<Self> {
        let at = view.camera.project(head.at, view.aspect())? * paper.size;
        let is_inside = at.cmpge(DVec2::ZERO).all() && at.cmple(paper.size).all();
        let half_height = view.camera.half_height(view.camera.depth(head.at));
        let radius = 0.5 * paper.size.y * head.radius / half_height;
        is_inside.then_some(Self { at, radius })
    }

    /// The first free place around it, and the line to one that stands apart.
    fn place(
        &self,
        paper: &Paper<'_>,
        name: &str,
        taken: &[Area],
    ) -> Option<(Area, Option<[DVec2; 2]>)> {
        let half = DVec2::new(0.5 * (paper.width)(name), 0.6 * paper.unit);
        let near = half + self.radius + 0.15 * paper.unit;
        let places = APART.iter().flat_map(|apart| {
            let away = near + apart * paper.unit;
            SIDES.iter().map(move |side| (*apart > 0.0, *side * away))
        });
        let mut areas = places.map(|(is_apart, way)| {
            let middle = self.at + way;
            let area = [middle - half, middle + half];
            (area, is_apart.then(|| self.leader(&area)))
        });
        let is_inside =
            |[low, high]: &Area| low.cmpge(DVec2::ZERO).all() && high.cmple(paper.size).all();
        areas.find(|(area, _)| is_inside(area) && !taken.iter().any(|t| overlap(t, area)))
    }

    /// The line from its rim to a name.
    fn leader(&self, area: &Area) -> [DVec2; 2] {
        let end = self.at.clamp(area[0], area[1]);
        [
            self.at + self.radius * (end - self.at).normalize_or_zero(),
            end,
        ]
    }
}

impl Text {
    /// What it covers, given its width.
    pub fn area(&self, width: f64) -> Area {
        let half = DVec2::new(0.5 * width, 0.6 * self.height);
        [self.middle - half, self.middle + half]
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::picture::test_view;
    use crate::view::Wells;

    fn head(name: &str, at: DVec3) -> Head {
        Head {
            name: name.into(),
            kind: crate::case::WellKind::Producer,
            is_open: true,
            at,
            radius: 0.1,
            color: [0.0; 3],
        }
    }

    fn names(heads: Vec<Head>) -> WellNames {
        let mut view = test_view([400, 300], 1.0);
        view.shown.wells = std::sync::Arc::new(Wells {
            heads,
            ..Wells::default()
        });
        let width = |text: &str| 8.0 * text.len() as f64;
        let paper = Paper {
            size: DVec2::new(400.0, 300.0),
            unit: 12.0,
            width: &width,
            is_dark: false,
            taken: Vec::new(),
        };
        well_names(&view, &paper)
    }

    #[test]
    fn names_stand_above_heads_and_never_on_another() {
        let middle = DVec3::new(5.0, 4.5, -2.0);
        let one = names(vec![head("P1", middle)]);
        let view = test_view([400, 300], 1.0);
        let at = view.camera.project(middle, view.aspect()).unwrap() * DVec2::new(400.0, 300.0);
        let name = &one.texts[0];
        assert!((name.middle.x - at.x).abs() < 1e-9 && name.middle.y < at.y);
        assert!(one.texts.len() == 1 && one.leaders.is_empty());
        // Ten wells at one place: around it, and then apart from it with a line to it.
        let all = names((0..10).map(|n| head(&format!("P{n}"), middle)).collect());
        assert_eq!(all.texts.len(), 10);
        assert_eq!(all.leaders.len(), 8);
        for (n, a) in all.texts.iter().enumerate() {
            let width = 8.0 * a.text.len() as f64;
            for b in &all.texts[..n] {
                assert!(!overlap(&a.area(width), &b.area(width)));
            }
        }
        for [start, end] in &all.leaders {
            assert!(start.distance(at) < end.distance(at));
        }
    }

    #[test]
    fn names_without_room_are_counted() {
        let middle = DVec3::new(5.0, 4.5, -2.0);
        let many = |count: usize| {
            let heads = (0..count).map(|n| head(&format!("WELL_{n:02}"), middle));
            names(heads.collect()).texts
        };
        let texts = many(60);
        let last = texts.last().unwrap();
        let hidden = 60 - (texts.len() - 1);
        assert!(hidden > 30);
        assert_eq!(
            last.text,
            format!("{hidden} names of wells are hidden behind others")
        );
        let shown = texts.len() - 1;
        assert!(many(shown).iter().all(|text| text.text.starts_with("WELL")));
        let one = many(shown + 1);
        assert_eq!(one[shown].text, "1 name of a well is hidden behind others");
    }

    #[test]
    fn what_flows_is_named_before_what_is_shut() {
        let middle = DVec3::new(5.0, 4.5, -2.0);
        let view = test_view([400, 300], 1.0);
        let mut wells: Vec<Head> = (0..9)
            .map(|n| head(&format!("S{n}"), middle - 1e-3 * view.camera.forward))
            .collect();
        for shut in &mut wells {
            shut.is_open = false;
        }
        wells.push(head("P1", middle));
        // The twin has them all open, so that the nearer ones come first.
        let mut twin = wells.clone();
        for well in &mut twin {
            well.is_open = true;
        }
        assert_eq!(names(wells).texts[0].text, "P1");
        assert_eq!(names(twin).texts[0].text, "S0");
    }

    #[test]
    fn wells_behind_the_viewer_have_no_name() {
        let view = test_view([400, 300], 1.0);
        let behind = view.camera.eye - view.camera.forward;
        assert_eq!(names(vec![head("P1", behind)]), WellNames::default());
    }
}
