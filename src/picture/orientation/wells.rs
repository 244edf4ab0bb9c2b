//! Names of wells at their heads.

use glam::DVec2;

use super::{Area, Paper, Text, overlap};
use crate::view::View;
use crate::view::wells::Head;

/// Names of the wells that a view shows, above their heads or beside them. Wells that flow are named before those that
/// are shut, and of each the nearest to the viewer first; a name that would lie on another one or leave the picture is left out.
pub fn well_names(view: &View, paper: &Paper<'_>) -> Vec<Text> {
    let mut heads: Vec<&Head> = view.shown.wells.heads.iter().collect();
    let depth = |head: &Head| view.camera.depth(head.at);
    heads.sort_by(|a, b| depth(a).total_cmp(&depth(b)));
    heads.sort_by_key(|head| !head.is_open);
    let mut taken = paper.taken.clone();
    let mut names = Vec::new();
    for head in heads {
        if let Some(area) = area(view, paper, head, &taken) {
            taken.push(area);
            names.push(Text {
                text: head.name.clone(),
                middle: 0.5 * (area[0] + area[1]),
                height: paper.unit,
            });
        }
    }
    names
}

/// The first free place around a head.
fn area(view: &View, paper: &Paper<'_>, head: &Head, taken: &[Area]) -> Option<Area> {
    let at = view.camera.project(head.at, view.aspect())? * paper.size;
    let half_height = view.camera.half_height(view.camera.depth(head.at));
    let radius = 0.5 * paper.size.y * head.radius / half_height;
    let half = DVec2::new(0.5 * (paper.width)(&head.name), 0.6 * paper.unit);
    let away = half + radius + 0.15 * paper.unit;
    let sides = [DVec2::NEG_Y, DVec2::X, DVec2::NEG_X, DVec2::Y];
    let areas = sides.map(|side| {
        let middle = at + side * away;
        [middle - half, middle + half]
    });
    let is_inside =
        |[low, high]: &Area| low.cmpge(DVec2::ZERO).all() && high.cmple(paper.size).all();
    let is_free = |area: &&Area| is_inside(area) && !taken.iter().any(|t| overlap(t, area));
    areas.iter().find(is_free).copied()
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

    fn names(heads: Vec<Head>) -> Vec<Text> {
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
        assert!((one[0].middle.x - at.x).abs() < 1e-9 && one[0].middle.y < at.y);
        // Ten wells at one place: names above and below it, the others are left out.
        let all = names((0..10).map(|n| head(&format!("P{n}"), middle)).collect());
        assert_eq!(all.len(), 2);
        for (n, a) in all.iter().enumerate() {
            let width = 8.0 * a.text.len() as f64;
            for b in &all[..n] {
                assert!(!overlap(&a.area(width), &b.area(width)));
            }
        }
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
        assert_eq!(names(wells)[0].text, "P1");
        assert_eq!(names(twin)[0].text, "S0");
    }

    #[test]
    fn wells_behind_the_viewer_have_no_name() {
        let view = test_view([400, 300], 1.0);
        let behind = view.camera.eye - view.camera.forward;
        assert!(names(vec![head("P1", behind)]).is_empty());
    }
}
