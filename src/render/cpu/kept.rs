//! What is kept from image to image.

/// Something that is made anew where its revision has counted up.
pub struct Kept<T>(Option<(u64, T)>);

impl<T> Default for Kept<T> {
    fn default() -> Self {
        Self(None)
    }
}

impl<T> Kept<T> {
    /// What is kept.
    pub fn get(&self) -> Option<&T> {
        self.0.as_ref().map(|(_, kept)| kept)
    }

    /// What is kept, to be changed.
    pub fn get_mut(&mut self) -> Option<&mut T> {
        self.0.as_mut().map(|(_, kept)| kept)
    }

    /// True where it is of a revision.
    pub fn is_of(&self, revision: u64) -> bool {
        self.0.as_ref().is_some_and(|(of, _)| *of == revision)
    }

    /// Keeps what was made of a revision.
    pub fn keep(&mut self, revision: u64, made: T) -> &T {
        &self.0.insert((revision, made)).1
    }

    /// Keeps nothing.
    pub fn forget(&mut self) {
        self.0 = None;
    }

    /// What is kept of a revision, made where there is none.
    ///
    /// # Errors
    /// When it cannot be made.
    pub fn update<E>(
        &mut self,
        revision: u64,
        make: impl FnOnce() -> Result<T, E>,
    ) -> Result<&T, E> {
        let kept = match self.0.take().filter(|(of, _)| *of == revision) {
            Some(known) => known,
            None => (revision, make()?),
        };
        Ok(&self.0.insert(kept).1)
    }
}
