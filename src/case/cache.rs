//! The fields used last, so that what is looked at again, or was read ahead, is not read again.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use crate::model::CellField;

/// Bytes of values that are kept: some hundred steps of a model of a million cells.
const BUDGET: usize = 256 << 20;

/// Fields by property and step, the one used last in front.
///
/// **Invariants**: never more than 256 MB; a field larger than that is not kept.
#[derive(Default)]
pub struct FieldCache(Mutex<VecDeque<Entry>>);

struct Entry {
    name: String,
    step: usize,
    field: Arc<CellField>,
}

impl FieldCache {
    /// The field, if it is kept.
    pub fn find(&self, name: &str, step: usize) -> Option<Arc<CellField>> {
        let mut entries = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let at = entries
            .iter()
            .position(|e| e.step == step && e.name == name)?;
        let entry = entries.remove(at)?;
        let field = entry.field.clone();
        entries.push_front(entry);
        Some(field)
    }

    /// Keeps a field, at the cost of those not used for longest.
    pub fn keep(&self, name: &str, step: usize, field: &Arc<CellField>) {
        let bytes = |field: &CellField| size_of_val(field.values());
        let mut entries = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        entries.retain(|e| e.step != step || e.name != name);
        entries.push_front(Entry {
            name: name.to_owned(),
            step,
            field: field.clone(),
        });
        let mut total = 0;
        entries.retain(|e| {
            total += bytes(&e.field);
            total <= BUDGET
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_kept_until_newer_ones_need_the_room() {
        let cache = FieldCache::default();
        let field = |value: f32| Arc::new(CellField::new(vec![value; BUDGET / 4 / 4]));
        for step in 0..4 {
            cache.keep("SWAT", step, &field(step as f32));
        }
        // Step 0 is used again, so that step 1 has to go.
        assert_eq!(cache.find("SWAT", 0).unwrap().values()[0], 0.0);
        cache.keep("SWAT", 4, &field(4.0));
        assert!(cache.find("SWAT", 1).is_none());
        for step in [0, 2, 3, 4] {
            assert_eq!(cache.find("SWAT", step).unwrap().values()[0], step as f32);
        }
        assert!(cache.find("SOIL", 0).is_none());
        // One that is read again replaces itself.
        cache.keep("SWAT", 4, &field(9.0));
        assert_eq!(cache.find("SWAT", 4).unwrap().values()[0], 9.0);
        assert!(cache.find("SWAT", 0).is_some());
    }
}
