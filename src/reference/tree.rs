//! A tree of bounding boxes: which of many boxes contain a point.

use glam::DVec3;

/// Boxes in a leaf at most.
const LEAF: usize = 4;

/// A binary tree over boxes, split at the median of the centers along the widest axis.
#[derive(Debug)]
pub struct Tree {
    /// In depth-first order: the first child follows its parent.
    nodes: Vec<Node>,
    /// Numbers of the boxes, leaf by leaf.
    order: Vec<u32>,
}

#[derive(Debug)]
struct Node {
    bounds: [DVec3; 2],
    content: Content,
}

#[derive(Debug, Clone, Copy)]
enum Content {
    /// Position of the second child.
    Children(usize),
    /// Range of `order`.
    Boxes(usize, usize),
}

impl Tree {
    /// A tree over boxes given by their smallest and largest corners.
    pub fn new(boxes: &[[DVec3; 2]]) -> Self {
        let mut tree = Self {
            nodes: Vec::new(),
            order: (0..boxes.len() as u32).collect(),
        };
        if !boxes.is_empty() {
            tree.build(boxes, 0, boxes.len());
        }
        tree
    }

    fn build(&mut self, boxes: &[[DVec3; 2]], start: usize, end: usize) {
        let members = &mut self.order[start..end];
        let centers = bounds_of(members.iter().map(|&n| [center(boxes[n as usize]); 2]));
        let node = self.nodes.len();
        self.nodes.push(Node {
            bounds: bounds_of(members.iter().map(|&n| boxes[n as usize])),
            content: Content::Boxes(start, end),
        });
        if end - start <= LEAF {
            return;
        }
        let axis = widest_axis(centers);
        let half = (end - start) / 2;
        members.select_nth_unstable_by(half, |&a, &b| {
            let along = |n: u32| center(boxes[n as usize])[axis];
            along(a).total_cmp(&along(b))
        });
        self.build(boxes, start, start + half);
        self.nodes[node].content = Content::Children(self.nodes.len());
        self.build(boxes, start + half, end);
    }

    /// Calls `visit` with the number of every box in a leaf whose bounds contain the point, in no
    /// particular order: all boxes that contain it, and perhaps some that do not.
    pub fn near(&self, point: DVec3, visit: &mut impl FnMut(usize)) {
        let contains = |[low, high]: [DVec3; 2]| (point.cmpge(low) & point.cmple(high)).all();
        self.meeting(&contains, visit);
    }

    /// Calls `visit` with the number of every box in a leaf whose bounds, and those of all above it, meet
    /// something: all boxes that do, and perhaps some that do not.
    pub fn meeting(&self, meets: &impl Fn([DVec3; 2]) -> bool, visit: &mut impl FnMut(usize)) {
        if !self.nodes.is_empty() {
            self.descend(0, meets, visit);
        }
    }

    fn descend(
        &self,
        node: usize,
        meets: &impl Fn([DVec3; 2]) -> bool,
        visit: &mut impl FnMut(usize),
    ) {
        let Node { bounds, content } = &self.nodes[node];
        if !meets(*bounds) {
            return;
        }
        match *content {
            Content::Children(second) => {
                self.descend(node + 1, meets, visit);
                self.descend(second, meets, visit);
            }
            Content::Boxes(start, end) => {
                for &number in &self.order[start..end] {
                    visit(number as usize);
                }
            }
        }
    }
}

fn center([low, high]: [DVec3; 2]) -> DVec3 {
    0.5 * (low + high)
}

fn bounds_of(boxes: impl Iterator<Item = [DVec3; 2]>) -> [DVec3; 2] {
    let nothing = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    boxes.fold(nothing, |[a, b], [low, high]| [a.min(low), b.max(high)])
}

fn widest_axis([low, high]: [DVec3; 2]) -> usize {
    (high - low).max_position()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_gives_every_box_that_contains_the_point() {
        let mut random = fastrand::Rng::with_seed(11);
        let mut point = |scale: f64| {
            let mut unit = || random.f64() * scale;
            DVec3::new(unit(), unit(), unit())
        };
        let boxes: Vec<[DVec3; 2]> = (0..500)
            .map(|_| {
                let low = point(1.0);
                [low, low + point(0.8)]
            })
            .collect();
        let tree = Tree::new(&boxes);
        let mut found = 0;
        for _ in 0..500 {
            let p = point(1.3);
            let mut near = Vec::new();
            tree.near(p, &mut |n| near.push(n));
            let inside = |b: &[DVec3; 2]| (p.cmpge(b[0]) & p.cmple(b[1])).all();
            for n in (0..boxes.len()).filter(|&n| inside(&boxes[n])) {
                assert_eq!(near.iter().filter(|&&m| m == n).count(), 1);
                found += 1;
            }
        }
        assert!(found > 500);
    }

    #[test]
    fn ok_no_boxes_and_equal_boxes() {
        Tree::new(&[]).near(DVec3::ZERO, &mut |_| unreachable!());
        let mut count = 0;
        Tree::new(&[[DVec3::ZERO, DVec3::ONE]; 100]).near(DVec3::splat(0.5), &mut |_| count += 1);
        assert_eq!(count, 100);
    }
}
