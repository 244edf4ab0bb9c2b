//! What the interface does to a tab's state: every change has a name, so that it can be undone, tested and told.

use serde::{Deserialize, Serialize};

use super::slices::Slicing;
use super::state::{Comparison, CurvePlots, Playback, State};
use crate::scene::{
    CameraSpec, ClipSpec, Filter, Grids, Interpolation, LibcSettings, LightingSpec, Mode,
    PltsSettings, RangeSpec, Scene, Show, Space, SrgSettings, StepSpec, Storage, StrategyKind,
    TransferSpec, Units,
};

/// A change of a tab's state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Action {
    /// Shows another property, in the look that it has.
    Property(String),
    /// Shows another step, by number.
    Step(usize),
    /// Cells as solid bodies, or rays through the volume.
    Mode(Mode),
    /// True places of the cells, or those by I, J and K; the camera frames the model anew.
    Space(Space),
    /// Values in a cell.
    Interpolation(Interpolation),
    /// Ends of the color map.
    Range(RangeSpec),
    /// Colors and opacities.
    Transfer(TransferSpec),
    /// Ray-casting strategy by name.
    Strategy(StrategyKind),
    /// Settings of SRG.
    Srg(SrgSettings),
    /// Settings of LIBC.
    Libc(LibcSettings),
    /// Settings of PLTS.
    Plts(PltsSettings),
    /// How depths and values are held.
    Storage(Storage),
    /// Distance of samples; `None` for the default.
    SamplingStep(Option<f64>),
    /// Rays along each axis of a pixel.
    Supersample(u32),
    /// Occlusion and lights.
    Lighting(LightingSpec),
    /// Which local grids are drawn.
    Grids(Grids),
    /// Which cells are drawn.
    Filter(Filter),
    /// Clip planes.
    Clip(Vec<ClipSpec>),
    /// Where to look from.
    Camera(CameraSpec),
    /// Vertical exaggeration; `None` for one that suits the model.
    Exaggeration(Option<f64>),
    /// What is drawn beside the volume.
    Show(Show),
    /// Background color.
    Background(String),
    /// Units in which numbers are shown and typed.
    Units(Units),
    /// A whole scene, as from a file.
    Scene(Box<Scene>),
    /// A second picture, or none.
    Compare(Option<Comparison>),
    /// Selects a cell by I, J, K from 1, beside those selected or alone; one that is selected is let go.
    Select([usize; 3], Beside),
    /// Selects a well by name, and the cells that it is connected to alone.
    Well(String, Vec<[usize; 3]>),
    /// Selects none.
    Deselect,
    /// Shows curves over time.
    Curves(CurvePlots),
    /// How time plays.
    Playback(Playback),
    /// How slices are stepped through.
    Slicing(Slicing),
}

/// Whether a cell joins those that are selected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Beside {
    /// It does.
    Others,
    /// It replaces them.
    Nothing,
    /// It replaces the one selected last.
    AllButLast,
}

impl Action {
    /// What it is called in the menu of undo.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Property(_) => "property",
            Self::Step(_) => "time step",
            Self::Mode(_) => "mode",
            Self::Space(_) => "space",
            Self::Interpolation(_) => "interpolation",
            Self::Range(_) => "color range",
            Self::Transfer(_) => "transfer function",
            Self::Strategy(_) => "strategy",
            Self::Srg(_) | Self::Libc(_) | Self::Plts(_) => "strategy settings",
            Self::Storage(_) => "storage",
            Self::SamplingStep(_) => "sampling step",
            Self::Supersample(_) => "rays per pixel",
            Self::Lighting(_) => "lighting",
            Self::Grids(_) => "local grids",
            Self::Filter(_) => "filter",
            Self::Clip(_) => "clip planes",
            Self::Camera(_) => "camera",
            Self::Exaggeration(_) => "vertical exaggeration",
            Self::Show(_) => "what is shown",
            Self::Background(_) => "background",
            Self::Units(_) => "units",
            Self::Scene(_) => "scene",
            Self::Compare(_) => "comparison",
            Self::Select(..) | Self::Well(..) | Self::Deselect => "selection",
            Self::Curves(_) => "curves",
            Self::Playback(_) => "pace",
            Self::Slicing(_) => "slices",
        }
    }

    /// Makes the change.
    pub fn apply(self, state: &mut State) {
        let scene = &mut state.setup.scene;
        match self {
            Self::Property(name) => state.setup.show(name),
            Self::Step(step) => scene.step = StepSpec::Index(step),
            Self::Mode(v) => state.setup.scene.mode = v,
            Self::Space(v) => *scene = std::mem::take(scene).in_space(v),
            Self::Interpolation(v) => state.setup.change_look(|look| look.interpolation = v),
            Self::Range(v) => state.setup.change_look(|look| look.range = v),
            Self::Transfer(v) => state.setup.change_look(|look| look.transfer = v),
            Self::Strategy(v) => scene.strategy = v,
            Self::Srg(v) => scene.srg = v,
            Self::Libc(v) => scene.libc = v,
            Self::Plts(v) => scene.plts = v,
            Self::Storage(v) => scene.storage = v,
            Self::SamplingStep(v) => scene.sampling_step = v,
            Self::Supersample(v) => scene.supersample = v,
            Self::Lighting(v) => scene.lighting = v,
            Self::Grids(v) => scene.grids = v,
            Self::Filter(v) => scene.filter = v,
            Self::Clip(v) => scene.clip = v,
            Self::Camera(v) => scene.camera = v,
            Self::Exaggeration(v) => scene.vertical_exaggeration = v,
            Self::Show(v) => scene.show = v,
            Self::Background(v) => scene.background = v,
            Self::Units(v) => scene.units = v,
            Self::Scene(v) => *scene = *v,
            Self::Compare(v) => state.setup.comparison = v,
            Self::Select(cell, beside) => {
                select(&mut state.selected, cell, beside);
                state.well.take_if(|_| beside == Beside::Nothing);
            }
            Self::Well(name, cells) => {
                (state.well, state.selected) = (Some(name), cells);
            }
            Self::Deselect => {
                state.well = None;
                state.selected.clear();
            }
            Self::Curves(v) => state.curves = v,
            Self::Playback(v) => state.pace = v,
            Self::Slicing(v) => state.slicing = v,
        }
    }
}

fn select(selected: &mut Vec<[usize; 3]>, cell: [usize; 3], beside: Beside) {
    match (beside, selected.iter().position(|c| *c == cell)) {
        (Beside::Nothing, _) => *selected = vec![cell],
        (Beside::AllButLast, _) => {
            selected.pop();
            selected.retain(|c| *c != cell);
            selected.push(cell);
        }
        (Beside::Others, Some(at)) => {
            selected.remove(at);
        }
        (Beside::Others, None) => selected.push(cell),
    }
}
