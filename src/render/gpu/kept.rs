//! What has been compiled for a device.

use std::any::{Any, TypeId};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use crate::render::RenderError;

/// Things by their type and key, the last [`MOST_KEPT`] of them at most: those who come back to a look, and cases that
/// are opened beside others, find there what was compiled for it.
#[derive(Default)]
pub struct Kept(Mutex<HashMap<(TypeId, String), Arc<dyn Any + Send + Sync>>>);

/// Things that are kept. Some constants of pipelines are free numbers, so that there is no end to them; who uses a
/// pipeline holds it beside.
const MOST_KEPT: usize = 64;

impl Kept {
    /// What is kept by a key, or made now: nobody waits meanwhile who wants something else.
    ///
    /// # Errors
    /// When it cannot be made.
    pub fn get_or_make<T: Any + Send + Sync>(
        &self,
        key: String,
        make: impl FnOnce() -> Result<T, RenderError>,
    ) -> Result<Arc<T>, RenderError> {
        let key = (TypeId::of::<T>(), key);
        let kept = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let known = kept().get(&key).cloned();
        if let Some(Ok(known)) = known.map(Arc::downcast) {
            return Ok(known);
        }
        let made = Arc::new(make()?);
        let mut kept = kept();
        if kept.len() >= MOST_KEPT {
            kept.clear();
        }
        kept.insert(key, made.clone());
        Ok(made)
    }
}
