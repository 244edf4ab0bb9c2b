//! The scene file: what to look at and how, as JSON. Every field has a default.
//!
//! Commands, window and `Session::scene` lay the keys of a file over the scene in which the case opens
//! (`view::look::opening`): there absent keys follow the case. [`Scene::default`] is plain and the same for all.

mod camera;
mod file;
mod filter;
pub mod lighting;
pub mod names;
mod settings;
mod strategy;
mod surfaces;
pub mod transfer;
mod volumes;

use serde::{Deserialize, Serialize};

pub use camera::{AutomaticCamera, CameraSpec, ExplicitCamera, FramingCamera, Projection};
pub use file::read_text;
pub use filter::{Filter, Indices, PropertyFilter};
pub use lighting::{LightMode, LightSpec, LightingSpec};
pub use settings::{
    ClipSpec, CutFace, Integration, LibcSettings, PltsSettings, SrgSettings, Storage,
};
pub use strategy::StrategyKind;
pub use surfaces::{Hull, ShownFaults, ShownWells};
pub use transfer::{
    ColorSpec, Coloring, FoundOpacity, OpacitySpec, OwnRange, RangeSpec, ScaleSpec, TransferSpec,
};
pub use volumes::{CropSpec, VerticalSpec, VolumeSpec};

use crate::image::Blending;

/// A scene as users write it. Unknown fields are errors; absent ones have defaults.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Scene {
    /// Version of the format.
    pub version: u32,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// `#rrggbb`.
    pub background: String,
    /// Where to look from; chosen from the shape of what is drawn where absent.
    pub camera: CameraSpec,
    /// Vertical exaggeration; chosen from the model's shape where absent.
    pub vertical_exaggeration: Option<f64>,
    /// Property to show; chosen where absent.
    pub property: Option<String>,
    /// Time step: a number, a date, `first` or `last`.
    pub step: StepSpec,
    /// What one looks at: the faces of the cells, or into the volume.
    pub mode: Mode,
    /// The true geometry, or flat layers and square columns by I, J and K.
    #[serde(skip_serializing_if = "Space::is_map")]
    pub space: Space,
    /// The units in which numbers are shown and typed. All numbers of the scene itself are in those of the files.
    #[serde(skip_serializing_if = "Units::are_of_file")]
    pub units: Units,
    /// How values vary inside a cell; in the mode `cells` each has one value.
    pub interpolation: Interpolation,
    /// Values at both ends of the color map; those of the step shown where absent.
    #[serde(deserialize_with = "transfer::null_is_default")]
    pub range: RangeSpec,
    /// Color and opacity.
    pub transfer: TransferSpec,
    /// How colors are blended.
    pub blending: Blending,
    /// Ray-casting strategy.
    pub strategy: StrategyKind,
    /// Distance of samples in world space; an eighth of the smallest mean cell edge where absent.
    pub sampling_step: Option<f64>,
    /// Transmittance at which a ray ends; 0 turns early termination off.
    pub early_termination: f64,
    /// Rays along each axis of a pixel, whose color is made of theirs: edges get smooth.
    #[serde(skip_serializing_if = "is_one")]
    pub supersample: u32,
    /// Settings of the resampled-grid strategy.
    pub srg: SrgSettings,
    /// Settings of the cell-to-cell strategy.
    pub libc: LibcSettings,
    /// Settings of PLTS.
    pub plts: PltsSettings,
    /// How depths and values are held.
    pub storage: Storage,
    /// Occlusion and lights.
    pub lighting: LightingSpec,
    /// Which local grids are drawn in place of the cells that they refine: all, but those that are named.
    #[serde(skip_serializing_if = "Grids::is_default")]
    pub grids: Grids,
    /// Which cells are drawn.
    pub filter: Filter,
    /// Clip planes; kept is what all of them keep.
    pub clip: Vec<ClipSpec>,
    /// Regular volumes that are drawn together with the model; one of them at a time.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub volumes: Vec<VolumeSpec>,
    /// What is drawn beside the volume.
    pub show: Show,
}

impl Default for Scene {
    fn default() -> Self {
        Self {
            version: 1,
            size: [1000, 1000],
            background: "#ffffff".into(),
            camera: CameraSpec::default(),
            vertical_exaggeration: None,
            property: None,
            step: StepSpec::Name("last".into()),
            mode: Mode::default(),
            space: Space::default(),
            units: Units::default(),
            interpolation: Interpolation::Vertex,
            range: RangeSpec::STEP,
            transfer: TransferSpec::default(),
            blending: Blending::default(),
            strategy: StrategyKind::Plts,
            sampling_step: None,
            early_termination: 0.01,
            supersample: 1,
            srg: SrgSettings::default(),
            libc: LibcSettings::default(),
            plts: PltsSettings::default(),
            storage: Storage::default(),
            lighting: LightingSpec::default(),
            grids: Grids::default(),
            filter: Filter::default(),
            clip: Vec::new(),
            volumes: Vec::new(),
            show: Show::default(),
        }
    }
}

impl Scene {
    /// The same in a space. Places and lengths mean something in the other one alone: where that was another, camera,
    /// exaggeration, clip planes, sampling and lights that stand somewhere are as if they had not been given.
    #[must_use]
    pub fn in_space(self, space: Space) -> Self {
        if space == self.space {
            return self;
        }
        let mut lighting = self.lighting;
        let is_far = |light: &LightSpec| matches!(light, LightSpec::Directional { .. });
        lighting.lights.retain(is_far);
        Self {
            space,
            camera: CameraSpec::Automatic(AutomaticCamera {
                projection: self.camera.projection(),
                ..AutomaticCamera::default()
            }),
            vertical_exaggeration: None,
            clip: Vec::new(),
            sampling_step: None,
            transfer: TransferSpec {
                reference_length: None,
                ..self.transfer
            },
            lighting,
            ..self
        }
    }
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "what serde calls")]
fn is_one(number: &u32) -> bool {
    *number == 1
}

/// Which local grids are drawn.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Grids {
    /// Names of those that are not: the cells that they refine are drawn in their place.
    pub hidden: Vec<String>,
}

impl Grids {
    fn is_default(&self) -> bool {
        self.hidden.is_empty()
    }
}

/// A time step by number, date or name.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "step must be a number from 0, a date such as \"2001-06-30\", \"first\" or \"last\""
)]
pub enum StepSpec {
    /// Position in file order, from 0.
    Index(usize),
    /// `first`, `last`, a date `2001-06-30`, or a number as text.
    Name(String),
}

/// What places of cells go by.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Space {
    /// Their true geometry.
    #[default]
    Map,
    /// Their numbers I, J and K: flat layers and square columns (simbox).
    Ijk,
}

impl Space {
    /// The other one.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::Map => Self::Ijk,
            Self::Ijk => Self::Map,
        }
    }

    /// True of the true geometry.
    #[allow(clippy::trivially_copy_pass_by_ref, reason = "what serde calls")]
    fn is_map(&self) -> bool {
        *self == Self::Map
    }
}

/// In which units numbers are shown and typed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Units {
    /// Those of the files.
    #[default]
    File,
    /// Meters, bar, standard cubic meters.
    Metric,
    /// Feet, psi, barrels.
    Field,
    /// Centimeters, atmospheres, standard cubic centimeters, hours.
    Lab,
    /// Meters, atmospheres, standard cubic meters.
    PvtM,
}

impl Units {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::File, Self::Metric, Self::Field, Self::Lab, Self::PvtM];

    /// Name in scene files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::File => "file",
            Self::Metric => "metric",
            Self::Field => "field",
            Self::Lab => "lab",
            Self::PvtM => "pvt-m",
        }
    }

    /// What they are, in a few words.
    pub const fn describe(self) -> &'static str {
        match self {
            Self::File => "As in the files",
            Self::Metric => "m, bar, sm3, days",
            Self::Field => "ft, psi, stb and Mscf, days",
            Self::Lab => "cm, atm, scc, hours",
            Self::PvtM => "m, atm, sm3, days",
        }
    }

    #[allow(clippy::trivially_copy_pass_by_ref, reason = "what serde calls")]
    fn are_of_file(&self) -> bool {
        *self == Self::File
    }
}

/// What one looks at.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// Rays through the inside of the cells: the values looked for are solid.
    #[default]
    Volume,
    /// Opaque cells: their outer faces and the sections of clip planes, each cell in the color of its value.
    Cells,
}

impl Mode {
    /// The other one.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::Cells => Self::Volume,
            Self::Volume => Self::Cells,
        }
    }
}

/// How values vary inside a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Interpolation {
    /// The cell's own value everywhere in it.
    Cell,
    /// Trilinear between averages at the vertices.
    Vertex,
}

/// How inactive cells look.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Inactive {
    /// Not at all.
    #[default]
    Hidden,
    /// Faint and gray.
    Ghost,
}

/// What is drawn beside the volume.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Show {
    /// Inactive cells.
    pub inactive: Inactive,
    /// The boundary of the drawn cells.
    pub hull: Hull,
    /// Faults as half-transparent sheets: all, none, or those of some names.
    pub faults: ShownFaults,
    /// Lines between the cells of non-neighbor connections.
    pub nnc: bool,
    /// Wells, with their names: all, none, or those whose names match patterns.
    pub wells: ShownWells,
    /// Edges of the cells on hull, faults and opaque sections; where absent they are drawn in the mode `cells`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cell_edges: Option<bool>,
    /// Box around the model with map coordinates, scale bar and orientation axes.
    pub r#box: bool,
    /// Legend and title.
    pub legend: bool,
    /// The line below: date, cells, values, exaggeration, filters.
    pub info: bool,
}

impl Default for Show {
    fn default() -> Self {
        Self {
            inactive: Inactive::Hidden,
            hull: Hull::Hidden,
            faults: ShownFaults::All(false),
            nnc: false,
            wells: ShownWells::All(false),
            cell_edges: None,
            r#box: true,
            legend: true,
            info: true,
        }
    }
}
