//! Which lateral faces of cells lie on which fault, as decks say.

use std::collections::HashMap;
use std::ops::RangeInclusive;

use super::grid::Grid;
use super::ids::Ijk;
use super::topology::Face;

/// Layers of a column, and the number of the fault that their faces lie on.
type Layers = (RangeInclusive<usize>, usize);

/// Numbers of the faults that lateral faces lie on.
///
/// **Invariants**: a face is the same seen from both of its cells; where two faults claim it, the first
/// one has it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct FaultFaces {
    /// By column (i, j) and axis (0 for i, 1 for j) of its face toward the larger index.
    faces: HashMap<(usize, usize, usize), Vec<Layers>>,
}

impl FaultFaces {
    /// Adds a face of all cells in a box (zero-based, both ends in it) to a fault. Upper and lower faces
    /// are no part of a fault here, nor are those at the grid's outside.
    pub fn add(&mut self, fault: usize, [i, j, k]: [RangeInclusive<usize>; 3], face: Face) {
        for i in i {
            for j in j.clone() {
                if let Some(key) = key(i, j, face) {
                    self.faces.entry(key).or_default().push((k.clone(), fault));
                }
            }
        }
    }

    /// The number of the fault and the cell of lower index of each face, with the face as that cell has it;
    /// layers beyond `layers` are left out. In no order.
    pub fn faces(&self, layers: usize) -> impl Iterator<Item = (usize, Ijk, Face)> + '_ {
        let columns = self.faces.iter();
        columns.flat_map(move |((i, j, axis), all)| {
            let face = if *axis == 0 { Face::IPlus } else { Face::JPlus };
            let (i, j) = (*i, *j);
            all.iter().flat_map(move |(range, fault)| {
                let range = *range.start()..(range.end().saturating_add(1)).min(layers);
                range.map(move |k| (*fault, Ijk { i, j, k }, face))
            })
        })
    }

    /// True without any face.
    pub fn is_empty(&self) -> bool {
        self.faces.is_empty()
    }

    /// Number of the fault that a face of a cell lies on.
    pub fn fault_of(&self, cell: Ijk, face: Face) -> Option<usize> {
        let layers = self.faces.get(&key(cell.i, cell.j, face)?)?;
        let found = layers.iter().find(|(k, _)| k.contains(&cell.k));
        found.map(|(_, fault)| *fault)
    }
}

impl Grid {
    /// How much deeper the same layer lies beyond a lateral face of a cell: the mean over the face's corners,
    /// below 0 where it lies higher. `None` where one of the cells is not active.
    pub fn throw(&self, ijk: Ijk, face: Face) -> Option<f64> {
        let beyond = self.adjacent(ijk, face)?;
        if !self.is_active(ijk) || !self.is_active(beyond) {
            return None;
        }
        let [mine, theirs] = face.corners();
        let pairs = mine.iter().zip(theirs);
        let drops = pairs.map(|(&a, b)| self.corner_depth(beyond, b) - self.corner_depth(ijk, a));
        Some(drops.sum::<f64>() / 4.0)
    }
}

fn key(i: usize, j: usize, face: Face) -> Option<(usize, usize, usize)> {
    Some(match face {
        Face::IPlus => (i, j, 0),
        Face::IMinus => (i.checked_sub(1)?, j, 0),
        Face::JPlus => (i, j, 1),
        Face::JMinus => (i, j.checked_sub(1)?, 1),
        Face::KMinus | Face::KPlus => return None,
    })
}

impl Grid {
    /// The lateral faces of the cells that `drawn` (by active index) names behind which an active cell
    /// of equal k is displaced in map space, and those that lie on a named fault, whatever its throw. A face between
    /// two drawn cells is there twice, once for each.
    pub fn fault_faces_of(&self, drawn: &[bool], named: &FaultFaces) -> Vec<(Ijk, Face)> {
        let drawn = self.bits_of(drawn);
        self.faces_where(&drawn, |column, face| {
            if matches!(face, Face::KMinus | Face::KPlus) {
                return vec![0; drawn.column(column).len()];
            }
            let mut faces = self.in_map_space().displaced(&drawn, column, face);
            if !named.is_empty() {
                let (i, j) = (column % self.dims().ni, column / self.dims().ni);
                let has_name = |k: &usize| named.fault_of(Ijk { i, j, k: *k }, face).is_some();
                for k in drawn.layers(column).filter(has_name) {
                    faces[k / 64] |= 1 << (k % 64);
                }
            }
            faces
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_face_is_found_from_both_of_its_cells() {
        let mut faults = FaultFaces::default();
        faults.add(4, [2..=3, 5..=5, 0..=1], Face::IPlus);
        faults.add(7, [4..=4, 5..=5, 1..=2], Face::IMinus);
        faults.add(9, [0..=0, 0..=0, 0..=9], Face::JMinus);
        let at = |i, j, k, face| faults.fault_of(Ijk { i, j, k }, face);
        assert_eq!(at(2, 5, 0, Face::IPlus), Some(4));
        assert_eq!(at(3, 5, 0, Face::IMinus), Some(4));
        // The first has what both claim.
        assert_eq!(at(3, 5, 1, Face::IPlus), Some(4));
        assert_eq!(at(3, 5, 2, Face::IPlus), Some(7));
        assert_eq!(at(2, 5, 2, Face::IPlus), None);
        assert_eq!(at(2, 5, 0, Face::JPlus), None);
        assert_eq!(at(0, 0, 0, Face::JMinus), None);
    }
}
