//! Grids of cases that are open at a time: equal ones are held once.

use std::sync::{Arc, Mutex, OnceLock, PoisonError, Weak};

use super::{Case, Simbox};
use crate::model::Grid;

/// The grids that are in use.
#[derive(Default)]
pub struct GridPool(Mutex<Vec<Known>>);

/// A grid, and its copy in index space, for as long as a case has them.
struct Known {
    grid: Weak<Grid>,
    flat: Weak<OnceLock<Arc<Grid>>>,
}

impl GridPool {
    /// Gives a case the grid of one that is open where both are equal, or the geometry alone where other cells are active.
    pub fn share(&self, case: &mut Case) {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        known.retain(|known| known.grid.strong_count() > 0);
        let open = known
            .iter()
            .filter_map(|k| Some((k.grid.upgrade()?, k.flat.upgrade())));
        let equal: Vec<_> = open
            .filter(|(grid, _)| grid.has_equal_geometry(&case.grid))
            .collect();
        let is_same = |(grid, _): &&(Arc<Grid>, _)| grid.active_cells() == case.grid.active_cells();
        if let Some((grid, flat)) = equal.iter().find(is_same) {
            case.grid = grid.clone();
            if let Some(flat) = flat {
                case.simbox = Simbox::of_grid(flat.clone());
            }
            return;
        }
        if let Some((grid, _)) = equal.first() {
            case.grid = Arc::new(case.grid.with_geometry_of(grid));
        }
        known.push(Known {
            grid: Arc::downgrade(&case.grid),
            flat: Arc::downgrade(&case.simbox.grid),
        });
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::case::load;

    #[test]
    fn equal_grids_are_held_once() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let open = || load::open(&root.join("samples/scissor/SCISSOR.EGRID")).unwrap();
        let pool = GridPool::default();
        let mut cases = [open(), open(), open()];
        let mut fewer = (*cases[2].grid).clone();
        fewer.retain_active(|cell| cell.0 % 2 == 0);
        cases[2].grid = Arc::new(fewer);
        assert!(!Arc::ptr_eq(&cases[0].grid, &cases[1].grid));
        cases.iter_mut().for_each(|case| pool.share(case));
        let [a, b, fewer] = cases.map(Arc::new);
        assert!(Arc::ptr_eq(&a.grid, &b.grid));
        let flat = |case: &Arc<Case>| case.in_space(crate::model::Space::Ijk).grid.clone();
        assert!(Arc::ptr_eq(&flat(&a), &flat(&b)));
        // Other cells are active: the geometry alone is shared.
        assert!(!Arc::ptr_eq(&a.grid, &fewer.grid) && a.grid.shares_geometry(&fewer.grid));
        assert!(fewer.grid.active_cells().len() < a.grid.active_cells().len());
        // What nobody has is not kept.
        drop((a, b, fewer));
        let mut again = open();
        let own = again.grid.clone();
        pool.share(&mut again);
        assert!(Arc::ptr_eq(&own, &again.grid));
    }
}
