//! East, north and up as the camera sees them, north standing out; in index space I, J and K.

use glam::{DVec2, DVec3};

use super::{Arrangement, Arrow, Text};
use crate::scene::Space;
use crate::view::View;

/// A direction of the world.
#[derive(Clone, Copy)]
struct Direction {
    axis: DVec3,
    name: &'static str,
    /// Colors on bright and on dark ground.
    colors: [[u8; 3]; 2],
    /// Size, as a factor on what is common.
    size: f64,
}

const DIRECTIONS: [Direction; 3] = [
    Direction {
        axis: DVec3::X,
        name: "E",
        colors: [[120, 120, 128], [160, 160, 170]],
        size: 0.8,
    },
    Direction {
        axis: DVec3::Y,
        name: "N",
        colors: [[205, 45, 40], [242, 96, 86]],
        size: 1.15,
    },
    Direction {
        axis: DVec3::Z,
        name: "Up",
        colors: [[45, 85, 210], [110, 155, 255]],
        size: 0.8,
    },
];

/// I, J and K, all alike; where they go is the view's.
const INDICES: [Direction; 3] = [
    Direction {
        axis: DVec3::X,
        name: "I",
        colors: [[205, 45, 40], [242, 96, 86]],
        size: 1.0,
    },
    Direction {
        axis: DVec3::Y,
        name: "J",
        colors: [[30, 130, 60], [90, 200, 120]],
        size: 1.0,
    },
    Direction {
        axis: DVec3::NEG_Z,
        name: "K",
        colors: [[45, 85, 210], [110, 155, 255]],
        size: 1.0,
    },
];

/// The directions of the space that a view shows.
fn directions(view: &View) -> [Direction; 3] {
    let to_world = &view.world.spaces.world_from_grid;
    match view.world.space {
        Space::Map => DIRECTIONS,
        Space::Ijk => std::array::from_fn(|n| Direction {
            axis: to_world.transform_vector3(DVec3::AXES[n]).normalize(),
            ..INDICES[n]
        }),
    }
}

/// Length of an arrow of common size in text heights, and as a part of the smaller side at most.
const LENGTH: f64 = 3.0;
const LONGEST: f64 = 0.09;
/// Part of the smaller side that all of it may take.
const WIDEST: f64 = 0.35;

/// Adds arrows and names, bottom left, where there is room.
pub fn add(layout: &mut Arrangement<'_>, view: &View) {
    let camera = &view.camera;
    let unit = layout.paper.unit;
    let side = layout.paper.size.min_element();
    let length = (LENGTH * unit).min(LONGEST * side);
    // The longest arrow, and names about it.
    let reach = 1.15 * length + 1.5 * unit;
    if 2.0 * reach > WIDEST * side {
        return;
    }
    // Above the vertical exaggeration where that is written.
    let below = if layout.made.texts.is_empty() {
        0.8
    } else {
        2.2
    } * unit;
    let center = DVec2::new(0.8 * unit + reach, layout.paper.size.y - below - reach);
    let mut arrows = directions(view).map(|d| {
        let seen = DVec2::new(d.axis.dot(camera.right), -d.axis.dot(camera.up));
        let tip = center + d.size * length * seen;
        (d.axis.dot(camera.forward), tip, d)
    });
    // Far ones first.
    arrows.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut taken: Vec<Taken> = arrows.iter().map(|a| ([center, a.1], ARROW)).collect();
    let mut covered = [center, center];
    for (_, tip, direction) in arrows {
        layout.made.arrows.push(Arrow {
            ends: [center, tip],
            shape: [0.18, 0.7, 1.0].map(|width| width * direction.size * unit),
            color: direction.colors[usize::from(layout.paper.is_dark)],
        });
        let height = direction.size.max(1.0) * unit;
        let middle = free_place(center, tip, &taken, height);
        taken.push(([middle, middle], NAME));
        let half = layout.half(direction.name, height);
        covered = [
            covered[0].min(tip).min(middle - half),
            covered[1].max(tip).max(middle + half),
        ];
        layout.made.texts.push(Text {
            text: direction.name.to_owned(),
            middle,
            height,
        });
    }
    layout.paper.taken.push(covered);
}

/// A line that is there already, and what distances from it count.
type Taken = ([DVec2; 2], f64);

/// What distances from arrows count, and those from the middles of names, which are wider.
const ARROW: f64 = 1.0;
const NAME: f64 = 0.55;

/// A place for a label near an arrow's tip, as far from all else as it can be.
fn free_place(center: DVec2, tip: DVec2, taken: &[Taken], unit: f64) -> DVec2 {
    let ahead = (tip - center).try_normalize().unwrap_or(DVec2::X);
    let room = |place: DVec2| {
        let distances = taken
            .iter()
            .map(|&(line, part)| part * distance(place, line));
        distances.fold(0.85 * unit, f64::min)
    };
    // The first of the best: straight ahead, unless something is there.
    let (mut best, mut best_room) = (tip + 0.85 * unit * ahead, 0.0);
    for degrees in [
        0.0f64, 30.0, -30.0, 60.0, -60.0, 100.0, -100.0, 140.0, -140.0, 180.0,
    ] {
        let place = tip + 0.85 * unit * DVec2::from_angle(degrees.to_radians()).rotate(ahead);
        if room(place) > best_room + 0.05 * unit {
            (best, best_room) = (place, room(place));
        }
    }
    best
}

fn distance(point: DVec2, [a, b]: [DVec2; 2]) -> f64 {
    let along = (point - a).dot(b - a) / a.distance_squared(b).max(1e-12);
    point.distance(a + along.clamp(0.0, 1.0) * (b - a))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_keep_away_from_arrows_ahead() {
        let (center, tip) = (DVec2::ZERO, DVec2::new(0.0, -20.0));
        let own = [center, tip];
        assert!(
            free_place(center, tip, &[(own, ARROW)], 10.0)
                .abs_diff_eq(DVec2::new(0.0, -28.5), 1e-9)
        );
        let longer = [center, DVec2::new(0.0, -40.0)];
        let place = free_place(center, tip, &[(own, ARROW), (longer, ARROW)], 10.0);
        assert!(distance(place, longer) > 5.0);
        // Of an arrow that points at the viewer, beside one that does not.
        let east = [center, DVec2::new(20.0, 0.0)];
        let place = free_place(center, center, &[([center; 2], ARROW), (east, ARROW)], 10.0);
        assert!(distance(place, east) > 8.0);
    }
}
