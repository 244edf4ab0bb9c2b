//! Map coordinates and depths along the outline of the model's box; in index space numbers of cells.

use glam::{DVec2, DVec3};

use super::edges::{self, Edge};
use super::{Area, Arrangement, overlap};
use crate::case::Measure;
use crate::model::Space;
use crate::picture::ticks::plain_labels;
use crate::picture::units::Lengths;
use crate::view::View;
use crate::view::camera::middle;

/// Labels that an edge has at most, and at least if any.
const LABELS: [usize; 2] = [6, 2];
/// Lengths of edges, in text heights, below which they have none.
const SHORTEST: f64 = 3.0;
/// Length of a tick, and of the gap behind it, in text heights.
const TICK: f64 = 0.4;
const GAP: f64 = 0.25;

/// Places between the labels of an edge that are tried for its name.
const BETWEEN: i32 = 24;
/// Pixels by which a name is not said to be moved.
const NOT_MOVED: f64 = 1.0;
/// Length of a tick at most where it is not at right angles to its edge, in text heights.
const LONGEST_TICK: f64 = 1.2;
/// Rotation of the box on the map, in degrees, from which ticks follow the lines of the map.
const LEAST_ROTATION: f64 = 1.0;

/// Names of the axes of index space.
const AXES: [&str; 3] = ["I", "J", "K"];

/// How far an edge's outward direction goes to the side where the edge is upright.
const UPRIGHT: f64 = 0.9;

/// A coordinate that is written along an edge.
#[derive(Clone, Copy)]
enum Coordinate {
    Easting,
    Northing,
    Depth,
    /// The number of a cell along an axis, from 1.
    Index(usize),
}

impl Coordinate {
    /// What the edges along each axis of the grid are labeled by: of the two horizontal ones the one that
    /// goes east more than the other by the easting.
    fn along_axes(view: &View) -> [Self; 3] {
        if view.world.space == Space::Ijk {
            return [0, 1, 2].map(Self::Index);
        }
        let corners = &view.world.subject.outline;
        let way = |axis: usize| corners[1 << axis] - corners[0];
        let [a, b] = [way(0), way(1)];
        match (a.x * b.y).abs() >= (a.y * b.x).abs() {
            true => [Self::Easting, Self::Northing, Self::Depth],
            false => [Self::Northing, Self::Easting, Self::Depth],
        }
    }

    /// Its name, and a short one.
    fn names(self, lengths: &Lengths) -> [&'static str; 2] {
        match self {
            Self::Easting => ["Easting", "E"],
            Self::Northing => ["Northing", "N"],
            Self::Depth if lengths.is_time => ["Time"; 2],
            Self::Depth => ["Depth"; 2],
            Self::Index(axis) => [AXES[axis]; 2],
        }
    }

    fn of(self, view: &View, point: DVec3) -> f64 {
        let map = view.world.spaces.map_from_world(point);
        match self {
            Self::Easting => map.x,
            Self::Northing => map.y,
            Self::Depth => map.z,
            Self::Index(axis) => view.world.spaces.grid_from_world.transform_point3(point)[axis],
        }
    }
}

impl Coordinate {
    /// How its numbers are written.
    fn measure(self, lengths: &Lengths) -> Measure {
        match self {
            Self::Index(_) => Measure::default(),
            Self::Easting | Self::Northing => lengths.map.clone(),
            Self::Depth => lengths.vertical.clone(),
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
pub fn add(layout: &mut Arrangement<'_>, view: &View, lengths: &Lengths) {
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
            if scales.iter().any(|s| s.add(layout, view, lengths, moves)) {
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
        let ends = edge.corners.map(|c| view.world.subject.outline[c]);
        let ends = edges::visible(&view.camera, ends, aspect)?;
        let seen = |p: DVec3| Some(view.camera.project(p, aspect)? * layout.paper.size);
        let [a, b] = [seen(ends[0])?, seen(ends[1])?];
        let along = (b - a).try_normalize()?;
        let inside = seen(middle(&view.world.subject.outline))? - a;
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
        lengths: &Lengths,
        moves: bool,
    ) -> bool {
        let measure = self.coordinate.measure(lengths);
        let range = self.ends;
        let range = range.map(|p| measure.show(self.coordinate.of(view, p)));
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
                let names = self.coordinate.names(lengths);
                self.write(layout, &free, names, &measure.unit);
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
            let tick = self.tick(layout, view, point, at);
            let out = GAP * layout.paper.unit + half.dot(self.outward.abs());
            let middle = at + tick + out * self.outward;
            let area = layout.area(&text, middle);
            at.is_finite().then_some(Label {
                is_moved: middle.distance(0.5 * (area[0] + area[1])) > 0.5,
                text,
                at,
                tick,
                area,
            })
        };
        let values = plain_labels([a.min(b), a.max(b)], wanted).into_iter();
        // Between whole numbers there are no cells.
        let is_index = matches!(self.coordinate, Coordinate::Index(_));
        let values = values.filter(|(_, text)| !(is_index && text.contains('.')));
        let values = values.filter(|(v, _)| (a.min(b)..=a.max(b)).contains(v));
        values.filter_map(at).collect()
    }

    /// The tick of a point on the edge, at right angles to the edge; where the box is rotated on the map, along
    /// the line of the map that has the point's value, since the other coordinate changes along the edge too.
    fn tick(&self, layout: &Arrangement<'_>, view: &View, point: DVec3, at: DVec2) -> DVec2 {
        let unit = layout.paper.unit;
        let right = TICK * unit * self.outward;
        let value = |p: DVec3| self.coordinate.of(view, p);
        let edge = self.ends[1] - self.ends[0];
        // Horizontal steps that show in the picture and in the digits of a coordinate.
        let step = 0.05 * edge.length();
        let change = [DVec3::X, DVec3::Y].map(|way| value(point + step * way) - value(point));
        let line = DVec3::new(-change[1], change[0], 0.0);
        let (Some(line), Some(edge)) = (line.try_normalize(), edge.try_normalize()) else {
            return right;
        };
        if edge.z.abs() > 0.5 || line.dot(edge).abs() < LEAST_ROTATION.to_radians() {
            return right;
        }
        let beyond = view.camera.project(point + step * line, view.aspect());
        let beyond = beyond.map(|p| p * layout.paper.size - at);
        let Some(way) = beyond.and_then(DVec2::try_normalize) else {
            return right;
        };
        let outward = way.dot(self.outward);
        let length = (TICK * unit / outward.abs()).min(LONGEST_TICK * unit);
        length * outward.signum() * way
    }

    fn write(&self, layout: &mut Arrangement<'_>, labels: &[Label], names: [&str; 2], unit: &str) {
        for label in labels {
            layout.write(&label.text, label.area);
            layout.made.strokes.push([label.at, label.at + label.tick]);
        }
        let named = |name: &str| match unit.is_empty() {
            true => name.to_owned(),
            false => format!("{name} ({unit})"),
        };
        let names = names.map(named);
        let places = names.each_ref().map(|n| self.place(layout, labels, n));
        // The short one where the other would be moved, and may come to lie on the model.
        let is_short = places[0].is_none_or(|(moved, _)| moved > NOT_MOVED);
        let chosen = usize::from(is_short && places[1].is_some());
        if let Some((_, area)) = places[chosen] {
            layout.write(&names[chosen], area);
        }
    }

    /// Where a name goes, and how far it is moved there to be in the picture.
    fn place(&self, layout: &Arrangement<'_>, labels: &[Label], name: &str) -> Option<(f64, Area)> {
        let unit = layout.paper.unit;
        let half = layout.half(name, unit);
        let deep = |l: &Label| (l.area[1] - l.area[0]).dot(self.outward.abs());
        let deepest = labels.iter().map(deep).fold(0.0, f64::max);
        let near = (TICK + GAP) * unit + half.dot(self.outward.abs());
        let out = near + 0.5 * GAP * unit + deepest;
        let on_edge = |t: f64| self.seen[0].lerp(self.seen[1], t);
        // Beyond the labels, in the middle of the edge or as near to that as there is room; of an upright edge
        // above or below them, where it is narrower; else between them.
        let beyond = [0.5, 0.35, 0.65, 0.2, 0.8, 0.0, 1.0, -0.1, 1.1];
        let beyond = beyond.map(|t| on_edge(t) + out * self.outward);
        let between = (0..=BETWEEN).map(|n| f64::from(n) / f64::from(BETWEEN));
        let between = between.map(|t| on_edge(t) + near * self.outward);
        let height = |l: &&Label| l.area[0].y;
        let order = |a: &&Label, b: &&Label| height(a).total_cmp(&height(b));
        let [top, bottom] = [labels.iter().min_by(order), labels.iter().max_by(order)];
        let level = |l: &Label| match self.outward.x < 0.0 {
            true => l.area[1].x - half.x,
            false => l.area[0].x + half.x,
        };
        let above = top.map(|l| DVec2::new(level(l), l.area[0].y - half.y));
        let below = bottom.map(|l| DVec2::new(level(l), l.area[1].y + half.y));
        let ends: Vec<DVec2> = above.into_iter().chain(below).collect();
        let mut places = [&ends[..], &beyond].concat();
        if self.outward.x.abs() < UPRIGHT {
            places.rotate_left(ends.len());
        }
        let placed = |at: DVec2| {
            let area = layout.area(name, at);
            (at.distance(0.5 * (area[0] + area[1])), area)
        };
        let all = places.into_iter().chain(between).map(placed);
        let free = all.filter(|(_, area)| layout.is_free(area));
        free.min_by(|a, b| a.0.round().total_cmp(&b.0.round()))
    }
}

/// A value on an edge.
struct Label {
    text: String,
    /// Where on the edge.
    at: DVec2,
    /// From there to the end of its tick.
    tick: DVec2,
    area: Area,
    /// It would have been cut at the rim.
    is_moved: bool,
}
