//! Map coordinates and depths along the outline of the model's box.

use glam::{DVec2, DVec3};

use super::edges::{self, Edge};
use super::{Area, Arrangement, overlap};
use crate::picture::annotate::short_unit;
use crate::picture::ticks::plain_labels;
use crate::scene::View;
use crate::scene::camera::middle;

/// Labels that an edge has at most, and at least if any.
const LABELS: [usize; 2] = [6, 2];
/// Lengths of edges, in text heights, below which they have none.
const SHORTEST: f64 = 3.0;
/// Length of a tick, and of the gap behind it, in text heights.
const TICK: f64 = 0.4;
const GAP: f64 = 0.25;

/// How far an edge's outward direction goes to the side where the edge is upright.
const UPRIGHT: f64 = 0.9;

/// A coordinate that is written along an edge.
#[derive(Clone, Copy)]
enum Coordinate {
    Easting,
    Northing,
    Depth,
}

impl Coordinate {
    /// What the edges along each axis of the grid are labeled by: of the two horizontal ones the one that
    /// goes east more than the other by the easting.
    fn along_axes(view: &View) -> [Self; 3] {
        let corners = &view.subject.outline;
        let way = |axis: usize| corners[1 << axis] - corners[0];
        let [a, b] = [way(0), way(1)];
        match (a.x * b.y).abs() >= (a.y * b.x).abs() {
            true => [Self::Easting, Self::Northing, Self::Depth],
            false => [Self::Northing, Self::Easting, Self::Depth],
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Easting => "Easting",
            Self::Northing => "Northing",
            Self::Depth => "Depth",
        }
    }

    fn of(self, view: &View, point: DVec3) -> f64 {
        let map = view.spaces.map_from_world(point);
        match self {
            Self::Easting => map.x,
            Self::Northing => map.y,
            Self::Depth => map.z,
        }
    }
}

impl Coordinate {
    /// Its unit: that of the map where it is not the grid's.
    fn unit(self, view: &View, length_unit: &str) -> String {
        match (self, view.spaces.map_unit) {
            (Self::Easting | Self::Northing, Some(unit)) => short_unit(unit.name),
            _ => length_unit.to_owned(),
        }
    }
}

/// The visible part of an edge of the outline.
struct Scale {
    coordinate: Coordinate,
    ends: [DVec3; 2],
    /// In the picture.
    seen: [DVec2; 2],
    /// Away from the box, at right angles to the edge.
    outward: DVec2,
}

/// Adds ticks, labels and names along one edge in each direction: the lowest horizontal ones and the
/// leftmost vertical one that have room.
pub fn add(layout: &mut Arrangement<'_>, view: &View, length_unit: &str) {
    let coordinates = Coordinate::along_axes(view);
    let outline: Vec<Edge> = edges::far(view)
        .into_iter()
        .filter(|e| e.is_outline)
        .collect();
    for (axis, coordinate) in coordinates.into_iter().enumerate() {
        let along = outline.iter().filter(|e| e.axis == axis);
        let scale = |e: &Edge| Scale::new(layout, view, coordinate, e);
        let mut scales: Vec<Scale> = along.filter_map(scale).collect();
        let rank = |s: &Scale| match axis {
            2 => s.seen[0].x + s.seen[1].x,
            _ => -s.seen[0].y - s.seen[1].y,
        };
        scales.sort_by(|a, b| rank(a).total_cmp(&rank(b)));
        for moves in [false, true] {
            if scales
                .iter()
                .any(|s| s.add(layout, view, length_unit, moves))
            {
                break;
            }
        }
    }
}

impl Scale {
    fn new(
        layout: &Arrangement<'_>,
        view: &View,
        coordinate: Coordinate,
        edge: &Edge,
    ) -> Option<Self> {
        let aspect = view.aspect();
        let ends = edge.corners.map(|c| view.subject.outline[c]);
        let ends = edges::visible(&view.camera, ends, aspect)?;
        let seen = |p: DVec3| Some(view.camera.project(p, aspect)? * layout.paper.size);
        let [a, b] = [seen(ends[0])?, seen(ends[1])?];
        let along = (b - a).try_normalize()?;
        let inside = seen(middle(&view.subject.outline))? - a;
        let outward = along.perp() * -along.perp().dot(inside).signum();
        let is_long = a.distance(b) >= SHORTEST * layout.paper.unit;
        (is_long && outward.is_finite()).then_some(Self {
            coordinate,
            ends,
            seen: [a, b],
            outward,
        })
    }

    /// As many labels as have room, and the name; false where too few have. Labels that would be cut at the
    /// picture's rim are moved into it where one `moves` them.
    fn add(
        &self,
        layout: &mut Arrangement<'_>,
        view: &View,
        length_unit: &str,
        moves: bool,
    ) -> bool {
        let range = self.ends.map(|p| self.coordinate.of(view, p));
        for wanted in (LABELS[1]..2 * LABELS[0]).rev() {
            let labels = self.labels(layout, view, range, wanted);
            let apart = |n: usize| {
                let rest = &labels[n + 1..];
                !rest.iter().any(|l| overlap(&l.area, &labels[n].area))
            };
            let few = labels.len() <= LABELS[0] && (0..labels.len()).all(apart);
            let free = labels.into_iter();
            let free = free.filter(|l| layout.is_free(&l.area) && (moves || !l.is_moved));
            let free: Vec<Label> = free.collect();
            if few && free.len() >= LABELS[1] {
                self.write(layout, &free, &self.coordinate.unit(view, length_unit));
                return true;
            }
        }
        false
    }

    /// Labels at round values, about `wanted` of them, wherever they may lie.
    fn labels(
        &self,
        layout: &Arrangement<'_>,
        view: &View,
        [a, b]: [f64; 2],
        wanted: usize,
    ) -> Vec<Label> {
        let at = |(value, text): (f64, String)| {
            let point = self.ends[0].lerp(self.ends[1], (value - a) / (b - a));
            let at = view.camera.project(point, view.aspect())? * layout.paper.size;
            let half = layout.half(&text, layout.paper.unit);
            let out = (TICK + GAP) * layout.paper.unit + half.dot(self.outward.abs());
            let middle = at + out * self.outward;
            let area = layout.area(&text, middle);
            at.is_finite().then_some(Label {
                is_moved: middle.distance(0.5 * (area[0] + area[1])) > 0.5,
                text,
                at,
                area,
            })
        };
        let values = plain_labels([a.min(b), a.max(b)], wanted).into_iter();
        let values = values.filter(|(v, _)| (a.min(b)..=a.max(b)).contains(v));
        values.filter_map(at).collect()
    }

    fn write(&self, layout: &mut Arrangement<'_>, labels: &[Label], length_unit: &str) {
        let unit = layout.paper.unit;
        let mut deepest: f64 = 0.0;
        for label in labels {
            layout.write(&label.text, label.area);
            let tick = [label.at, label.at + TICK * unit * self.outward];
            layout.made.strokes.push(tick);
            let half = 0.5 * (label.area[1] - label.area[0]);
            deepest = deepest.max(2.0 * half.dot(self.outward.abs()));
        }
        let name = match length_unit.is_empty() {
            true => self.coordinate.name().to_owned(),
            false => format!("{} ({length_unit})", self.coordinate.name()),
        };
        let half = layout.half(&name, unit);
        let out = (TICK + 1.5 * GAP) * unit + deepest + half.dot(self.outward.abs());
        // Beyond the labels, in the middle of the edge or as near to that as there is room; of an upright edge
        // above or below them, where it is narrower.
        let places = [0.5, 0.35, 0.65, 0.2, 0.8, 0.0, 1.0, -0.1, 1.1];
        let beyond = places.map(|t| self.seen[0].lerp(self.seen[1], t) + out * self.outward);
        let start = [DVec2::INFINITY, DVec2::NEG_INFINITY];
        let column = labels.iter().fold(start, |[low, high], l| {
            [low.min(l.area[0]), high.max(l.area[1])]
        });
        let x = match self.outward.x < 0.0 {
            true => column[1].x - half.x,
            false => column[0].x + half.x,
        };
        let ends = [column[0].y - half.y, column[1].y + half.y].map(|y| DVec2::new(x, y));
        let mut places = [&ends[..], &beyond].concat();
        if self.outward.x.abs() < UPRIGHT {
            places.rotate_left(ends.len());
        }
        // Where it would be moved into the picture it may come to lie on the model.
        let moved = |(at, area): &(DVec2, Area)| at.distance(0.5 * (area[0] + area[1]));
        let areas = places.into_iter().map(|at| (at, layout.area(&name, at)));
        let free = areas.filter(|(_, area)| layout.is_free(area));
        let least = free.min_by(|a, b| moved(a).round().total_cmp(&moved(b).round()));
        if let Some((_, area)) = least {
            layout.write(&name, area);
        }
    }
}

/// A value on an edge.
struct Label {
    text: String,
    /// Where on the edge.
    at: DVec2,
    area: Area,
    /// It would have been cut at the rim.
    is_moved: bool,
}
