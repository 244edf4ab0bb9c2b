//! Why there is no image.

/// Why there is no image.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// Whoever asked for it does not want it anymore.
    #[error("it was canceled")]
    Canceled,
    /// No adapter at all.
    #[error(
        "no GPU adapter was found; install a Vulkan driver (on Debian the package mesa-vulkan-drivers has a software one)"
    )]
    NoAdapter,
    /// None with the wanted name.
    #[error("no GPU adapter is called {wanted}; there are: {known}")]
    NoSuchAdapter {
        /// What was asked for.
        wanted: String,
        /// What there is.
        known: String,
    },
    /// The adapter offers too little.
    #[error("the adapter {adapter} cannot be used: {reason}")]
    Unsuitable {
        /// Adapter name.
        adapter: String,
        /// Which limit or request failed.
        reason: String,
    },
    /// A buffer is larger than the adapter allows.
    #[error(
        "the model does not fit this adapter: {what} needs {needed} bytes and one binding holds {limit}; choose the CPU (`--adapter cpu`), which has no such limit, or an adapter with larger bindings"
    )]
    TooLarge {
        /// Which array.
        what: &'static str,
        /// Bytes it takes.
        needed: u64,
        /// Bytes that fit.
        limit: u64,
    },
    /// A dispatch is larger than the adapter allows.
    #[error(
        "the shader {shader} would need {groups:?} workgroups and the adapter takes {limit} along an axis; make the image smaller"
    )]
    TooManyGroups {
        /// Shader and entry.
        shader: String,
        /// Workgroups along x, y and z.
        groups: [u32; 3],
        /// Workgroups along an axis, at most.
        limit: u32,
    },
    /// The driver reported an error.
    #[error("the GPU reported an error: {0}")]
    Device(String),
    /// The device is gone: the driver was reset or updated, or the card was taken away.
    #[error("the GPU device was lost{0}; it is reopened on the next action")]
    Lost(String),
    /// A shader of this program is broken.
    #[error("shader {name}: {message}")]
    Shader {
        /// File stem.
        name: String,
        /// The compiler's words.
        message: String,
    },
}
