//! The adapters of a machine.

/// An adapter that the system offers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AdapterFacts {
    /// Its name.
    pub name: String,
    /// What it is, such as `discrete GPU` or `software`.
    pub kind: &'static str,
    /// What it is reached by, such as `vulkan`.
    pub backend: &'static str,
    /// The driver and its version; may be empty.
    pub driver: String,
    /// Bytes that one array of a model can have.
    pub most_bytes: u64,
    /// Pixels along the edge of an image, and voxels along that of a volume, at most.
    pub most_texels: [u32; 2],
    /// Why it cannot be used.
    pub lacking: Option<String>,
}
