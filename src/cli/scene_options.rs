//! The scene file and the options that override it, the same for every command that makes pictures.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::Context;
use strataray::case::load::{self, CasePaths};
use strataray::case::{Case, GridPool, Minus, distinct_names, minus};
use strataray::render::{self, Executor};
use strataray::scene::lighting::{LightMethod, PRESETS};
use strataray::scene::read_text;
use strataray::scene::{
    CameraSpec, FramingCamera, Interpolation, LightMode, LightingSpec, Mode, Projection, Scene,
    Space, StepSpec, Storage, StrategyKind, Units, VolumeSpec,
};
use strataray::view::{self, look};

use super::choice::{
    INTERPOLATIONS, LIGHT_MODES, MODES, OCCLUSION_METHODS, SPACES, STORAGES, STRATEGIES, UNITS,
    one_of,
};
use super::progress::Reporter;

#[derive(clap::Args)]
pub struct SceneOptions {
    /// Scene file (JSON), or - for standard input; the options below override it.
    #[arg(long)]
    pub scene: Option<PathBuf>,
    /// Property, or a difference such as PRESSURE-PRESSURE@0.
    #[arg(long)]
    property: Option<String>,
    /// Time step: number from 0, date, first or last.
    #[arg(long)]
    step: Option<String>,
    /// Ray-casting strategy.
    #[arg(long, value_parser = one_of(&STRATEGIES))]
    pub strategy: Option<StrategyKind>,
    /// Values within a cell.
    #[arg(long, value_parser = one_of(&INTERPOLATIONS))]
    interpolation: Option<Interpolation>,
    /// How depths and values are held.
    #[arg(long, value_parser = one_of(&STORAGES))]
    storage: Option<Storage>,
    /// Opaque cells, or rays through the inside; by default the one that shows more of the property.
    #[arg(long, value_parser = one_of(&MODES))]
    mode: Option<Mode>,
    /// True places of the cells, or those by I, J and K (simbox).
    #[arg(long, value_parser = one_of(&SPACES))]
    space: Option<Space>,
    /// Units of the numbers that are written; those of the scene itself stay in the units of the files.
    #[arg(long, value_parser = one_of(&UNITS))]
    units: Option<Units>,
    /// Image size, such as 1000x1000.
    #[arg(long, value_name = "WxH")]
    pub size: Option<String>,
    /// Occlusion toward the viewer, and where it is found.
    #[arg(long, value_name = "MODE", value_parser = one_of(&LIGHT_MODES))]
    occlusion: Option<LightMode>,
    /// How occlusion is found, toward the viewer or to all sides.
    #[arg(long, value_name = "METHOD", value_parser = one_of(&OCCLUSION_METHODS))]
    occlusion_method: Option<LightMethod>,
    /// How shadows of lights are found, by a method that looks along cones.
    #[arg(long, value_name = "METHOD", value_parser = one_of(&OCCLUSION_METHODS), hide_possible_values = true)]
    shadow_method: Option<LightMethod>,
    /// Preset of occlusion and lights.
    #[arg(long, value_name = "NAME", value_parser = lighting_preset, help = lighting_help())]
    lighting: Option<LightingSpec>,
    /// Direction to look from, and zoom.
    #[arg(
        long,
        value_name = "AZIMUTH,ELEVATION[,ZOOM]",
        allow_hyphen_values = true
    )]
    camera: Option<String>,
    /// Vertical exaggeration.
    #[arg(long)]
    exaggeration: Option<f64>,
    /// A regular volume to draw together with the model, such as seismic: SEG-Y, NRRD, MetaImage, VTK ImageData or raw; in
    /// place of those of the scene.
    #[arg(long, value_name = "FILE")]
    volume: Option<PathBuf>,
    /// Rays along each axis of a pixel, 1 to 8: 2 makes edges smooth and takes four times as long.
    #[arg(long, value_name = "N")]
    supersample: Option<u32>,
    /// Threads of the CPU work.
    #[arg(long)]
    threads: Option<usize>,
    /// Part of the name of the GPU adapter to use, or cpu; by default the best GPU, or without one the CPU. The
    /// variable STRATARAY_ADAPTER does the same, also for the window.
    #[arg(long)]
    adapter: Option<String>,
    #[command(flatten)]
    added: AddedFiles,
}

/// Files that are added to a case, and cases that it is compared with.
#[derive(clap::Args, Default)]
pub struct AddedFiles {
    /// Files to add to the case: properties or faults in text, paths of wells (.dev and others), a deck or its schedule with
    /// wells, an INIT, restart or summary of another name; of several restarts steps are put together. To a volume
    /// another one on the same samples.
    #[arg(long, value_name = "FILE", num_args = 1..)]
    with: Vec<PathBuf>,
    /// Another case on the same grid, whose values on the same date are subtracted: PRESSURE-PRESSURE@NAME is one more
    /// property, which is shown in place of PRESSURE.
    #[arg(long, value_name = "CASE")]
    minus: Option<PathBuf>,
    /// Further cases on the same grid, such as realizations: PRESSURE.MEAN, .STD, .MIN, .P10, .P50, .P90 and .MAX are of
    /// all of them on the same date.
    #[arg(long, value_name = "CASE", num_args = 1.., conflicts_with = "minus")]
    ensemble: Vec<PathBuf>,
}

impl SceneOptions {
    /// The scene in which a case opens, with the keys of the scene file over it, and the options over these; says
    /// what of it is not drawn.
    pub fn scene(&self, case: &Case, reporter: &Reporter) -> anyhow::Result<Scene> {
        let mut written = self.written()?;
        if let Some(property) = &self.property {
            written.insert("property".into(), property.clone().into());
        }
        if self.added.minus.is_some() {
            let given = written.get("property").and_then(|p| p.as_str());
            let property = given.map_or_else(|| look::default_property(case), str::to_owned);
            if let Some(difference) = case.minus_of(&property) {
                written.insert("property".into(), difference.into());
            }
        }
        if let Some(mode) = self.mode {
            written.insert("mode".into(), serde_json::to_value(mode)?);
        }
        let scene = self.over(look::opening(case, &written.into())?)?;
        for warning in view::warnings(&scene, case)? {
            reporter.note(&warning);
        }
        Ok(scene)
    }

    /// The scene of the file with plain defaults, whatever the case, and the options over it: what times of
    /// different cases and versions are compared by.
    pub fn plain_scene(&self) -> anyhow::Result<Scene> {
        let mut scene: Scene = serde_json::from_value(self.written()?.into())?;
        if self.property.is_some() {
            scene.property.clone_from(&self.property);
        }
        scene.mode = self.mode.unwrap_or(scene.mode);
        self.over(scene)
    }

    fn over(&self, scene: Scene) -> anyhow::Result<Scene> {
        let space = self.space.unwrap_or(scene.space);
        // First: what follows holds for this space.
        let mut scene = scene.in_space(space);
        if let Some(step) = &self.step {
            scene.step = StepSpec::Name(step.clone());
        }
        if let Some(strategy) = &self.strategy {
            scene.strategy = *strategy;
        }
        if let Some(interpolation) = self.interpolation {
            scene.interpolation = interpolation;
        }
        scene.units = self.units.unwrap_or(scene.units);
        if let Some(storage) = self.storage {
            scene.storage = storage;
        }
        if let Some(lighting) = &self.lighting {
            scene.lighting.clone_from(lighting);
        }
        if let Some(mode) = self.occlusion {
            scene.lighting.occlusion.get_or_insert_default().mode = mode;
        }
        if let Some(method) = self.occlusion_method {
            scene.lighting.occlusion.get_or_insert_default().method = method;
        }
        if let Some(method) = self.shadow_method {
            scene.lighting.shadows.method = method;
        }
        if let Some(size) = &self.size {
            let parsed = size
                .split_once(['x', 'X'])
                .and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
            scene.size = parsed
                .with_context(|| format!("--size {size}: give width and height like 1000x800"))?;
        }
        if let Some(camera) = &self.camera {
            let projection = scene.camera.projection();
            scene.camera = CameraSpec::Framing(FramingCamera {
                projection,
                ..framing(camera)?
            });
        }
        scene.supersample = self.supersample.unwrap_or(scene.supersample);
        if let Some(volume) = &self.volume {
            // The paths of scenes begin at the case, those of options where one is.
            let path = std::path::absolute(volume)?;
            scene.volumes = vec![VolumeSpec::of(path)];
        }
        if self.exaggeration.is_some() {
            scene.vertical_exaggeration = self.exaggeration;
        }
        Ok(scene)
    }

    /// The keys of the scene file; none without one.
    fn written(&self) -> anyhow::Result<SceneKeys> {
        self.scene
            .as_deref()
            .map_or(Ok(SceneKeys::new()), read_keys)
    }

    /// True where an option picks one time step.
    pub fn picks_step(&self) -> bool {
        self.step.is_some()
    }

    /// Limits the threads of the CPU work where asked to.
    pub fn set_threads(&self) -> anyhow::Result<()> {
        if let Some(threads) = self.threads {
            rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build_global()?;
        }
        Ok(())
    }

    /// Opens a case with the files added to it and says what was not loaded.
    pub fn open_case(&self, path: &Path, reporter: &Reporter) -> anyhow::Result<Case> {
        self.added.open_case(path, reporter)
    }

    /// The scene of a case, as [`Self::scene`], and the case in the scene's space; says what of it is not drawn there.
    pub fn scene_in_space(
        &self,
        case: Case,
        reporter: &Reporter,
    ) -> anyhow::Result<(Scene, Arc<Case>)> {
        let scene = self.scene(&case, reporter)?;
        let case = in_space(case, &scene, reporter);
        Ok((scene, case))
    }

    /// Opens what makes the images, and says where it is no GPU.
    pub fn open_executor(&self, reporter: &Reporter) -> anyhow::Result<Arc<dyn Executor>> {
        open_executor(self.adapter.as_deref(), reporter)
    }
}

/// A case in the space of a scene; says what of it is not drawn there.
pub fn in_space(case: Case, scene: &Scene, reporter: &Reporter) -> Arc<Case> {
    let case = Arc::new(case);
    let seen = case.in_space(scene.space);
    if !Arc::ptr_eq(&seen, &case) {
        for note in &seen.about.notes {
            reporter.note(note);
        }
    }
    seen
}

/// Opens what makes the images, by a part of its adapter's name where one is given, and says where it is no GPU.
pub fn open_executor(
    adapter: Option<&str>,
    reporter: &Reporter,
) -> anyhow::Result<Arc<dyn Executor>> {
    let executor = render::executor(adapter)?;
    let info = executor.info();
    if info.is_software {
        let why = match &info.problem {
            Some(problem) => format!(" ({problem})"),
            None => String::new(),
        };
        reporter.note(&format!(
            "no GPU is used{why}: images are made by {}",
            info.adapter
        ));
    }
    Ok(executor)
}

/// Keys of a scene file with their values.
pub type SceneKeys = serde_json::Map<String, serde_json::Value>;

/// The keys of a scene file, or of standard input for `-`.
pub fn read_keys(path: &Path) -> anyhow::Result<SceneKeys> {
    let text = match path.as_os_str() == "-" {
        true => std::io::read_to_string(std::io::stdin()),
        false => read_text(path),
    };
    let text = text.with_context(|| format!("cannot read {}", path.display()))?;
    // As a whole scene first, for errors that name line and column.
    let _: Scene = serde_json::from_str(&text).with_context(|| format!("{}", path.display()))?;
    Ok(serde_json::from_str(&text)?)
}

impl AddedFiles {
    /// Opens a case with the files added to it and says what was not loaded.
    pub fn open_case(&self, path: &Path, reporter: &Reporter) -> anyhow::Result<Case> {
        let pool = GridPool::default();
        let paths = CasePaths {
            path: path.to_owned(),
            with: self.with.clone(),
            others: self.ensemble.iter().cloned().map(CasePaths::of).collect(),
        };
        let opened = load::open_paths(&paths, &pool, &|_| true)?;
        let mut case = opened.context("the case was not opened")?;
        if let Some(other) = &self.minus {
            let mut other = load::open(other)?;
            pool.share(&mut other);
            case = subtracted(case, other)?;
        }
        for note in &case.about.notes {
            reporter.note(note);
        }
        Ok(case)
    }
}

/// A case with its differences to another one.
fn subtracted(case: Case, other: Case) -> anyhow::Result<Case> {
    let [case, other] = [case, other].map(Arc::new);
    let names = distinct_names(&[&case, &other]);
    let differences = Minus::of_all(&case, &other, &names[1]);
    if differences.is_empty() {
        anyhow::bail!("{} and {} have no property in common", names[0], names[1]);
    }
    let mut made = minus(&case, &other, &differences, None).map_err(anyhow::Error::msg)?;
    let notes = case.about.notes.iter().cloned();
    made.about.notes.splice(0..0, notes);
    Ok(made)
}

/// Opens a case and says what was not loaded.
pub fn open_case(path: &Path, reporter: &Reporter) -> anyhow::Result<Case> {
    AddedFiles::default().open_case(path, reporter)
}

/// The preset of light that has a name.
///
/// # Errors
/// What there is, where none has it.
pub fn lighting_preset(name: &str) -> Result<LightingSpec, String> {
    let names = || PRESETS.map(|(name, _)| name).join(", ");
    LightingSpec::preset(name).ok_or_else(|| format!("there are {}", names()))
}

fn lighting_help() -> String {
    let presets = PRESETS.map(|(name, what)| format!("{name} ({what})"));
    format!("Preset of occlusion and lights: {}", presets.join(", "))
}

fn framing(text: &str) -> anyhow::Result<FramingCamera> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some([azimuth, elevation, rest @ ..]) if rest.len() < 2 => Ok(FramingCamera {
            azimuth_degrees: *azimuth,
            elevation_degrees: *elevation,
            zoom: rest.first().copied().unwrap_or(1.0),
            projection: Projection::default(),
        }),
        _ => anyhow::bail!(
            "--camera {text}: give azimuth and elevation in degrees and perhaps a zoom, like 220,35,1.2"
        ),
    }
}
