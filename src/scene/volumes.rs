//! Regular volumes beside the model, such as seismic.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::transfer::TransferSpec;

/// A regular volume that is drawn together with the model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VolumeSpec {
    /// The file: SEG-Y, NRRD, MetaImage, VTK ImageData, or a raw volume with its description. Its places are map
    /// coordinates, those of a relative path begin at the folder of the case.
    pub file: PathBuf,
    /// False: it is not drawn.
    #[serde(default = "yes")]
    pub show: bool,
    /// What the third coordinate of the file is; where absent depth for SEG-Y and elevation for all others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vertical: Option<VerticalSpec>,
    /// The third coordinate is two-way time in milliseconds, and this the speed of sound, in lengths of the grid a
    /// second.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity: Option<f64>,
    /// Values at both ends of the color map; those that leave out 2 % of the samples where absent, around zero where
    /// values have both signs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range: Option<[f64; 2]>,
    /// Color and opacity; where absent those that suit the values. The reference length is the mean edge of a voxel
    /// where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub transfer: Option<TransferSpec>,
    /// The samples of the file that are drawn.
    #[serde(default, skip_serializing_if = "CropSpec::is_none")]
    pub crop: CropSpec,
}

impl VolumeSpec {
    /// A file with all else as it comes.
    pub fn of(file: PathBuf) -> Self {
        Self {
            file,
            show: true,
            vertical: None,
            velocity: None,
            range: None,
            transfer: None,
            crop: CropSpec::default(),
        }
    }
}

/// What the third coordinate of a volume's file is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum VerticalSpec {
    /// It grows downward.
    Depth,
    /// It grows upward.
    Elevation,
}

/// Samples along each axis of the file, `[first, last]` from 1; all where absent.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CropSpec {
    /// Along the first axis: inlines of SEG-Y.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub i: Option<[usize; 2]>,
    /// Along the second axis: crosslines of SEG-Y.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub j: Option<[usize; 2]>,
    /// Along the third axis.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub k: Option<[usize; 2]>,
}

impl CropSpec {
    fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

fn yes() -> bool {
    true
}
