//! Shader sources: `#import name` by stem from `shaders/shared/`, each once.

use crate::render::RenderError;

macro_rules! sources {
    ($($name:literal => $path:literal),* $(,)?) => {
        /// Every shader by stem; what tests validate and pipelines are made from.
        const SOURCES: &[(&str, &str)] = &[$(($name, include_str!(concat!("../../../shaders/", $path)))),*];
    };
}

sources! {
    "layout" => "shared/layout.wgsl",
    "grid" => "shared/grid.wgsl",
    "cell" => "shared/cell.wgsl",
    "thorough" => "shared/thorough.wgsl",
    "locate" => "shared/locate.wgsl",
    "frame" => "shared/frame.wgsl",
    "table" => "shared/table.wgsl",
    "transfer" => "shared/transfer.wgsl",
    "topology" => "shared/topology.wgsl",
    "section" => "shared/section.wgsl",
    "facing" => "shared/facing.wgsl",
    "raster" => "shared/raster.wgsl",
    "projection" => "shared/projection.wgsl",
    "surfaces" => "shared/surfaces.wgsl",
    "edges" => "shared/edges.wgsl",
    "light" => "shared/light.wgsl",
    "cones" => "shared/cones.wgsl",
    "cone_rays" => "shared/cone_rays.wgsl",
    "shading" => "shared/shading.wgsl",
    "random" => "shared/random.wgsl",
    "mean" => "shared/mean.wgsl",
    "groups" => "shared/groups.wgsl",
    "extinction" => "extinction.wgsl",
    "faces" => "faces.wgsl",
    "illuminate" => "illuminate.wgsl",
    "libc" => "libc.wgsl",
    "paint" => "paint.wgsl",
    "peel" => "peel.wgsl",
    "plts" => "plts.wgsl",
    "probe" => "probe.wgsl",
    "pyramids" => "pyramids.wgsl",
    "resample" => "resample.wgsl",
    "solid" => "solid.wgsl",
    "srg" => "srg.wgsl",
}

/// The stems of all shaders that are entry points of a pipeline.
pub const ENTRIES: [&str; 12] = [
    "extinction",
    "faces",
    "illuminate",
    "libc",
    "paint",
    "peel",
    "plts",
    "probe",
    "pyramids",
    "resample",
    "solid",
    "srg",
];

/// The whole text of a shader with its imports in front, each once.
///
/// # Errors
/// When an imported name does not exist.
pub fn compose(name: &str) -> Result<String, RenderError> {
    let mut text = String::new();
    append(name, &mut Vec::new(), &mut text)?;
    Ok(text)
}

fn append(name: &str, done: &mut Vec<String>, text: &mut String) -> Result<(), RenderError> {
    if done.iter().any(|d| d == name) {
        return Ok(());
    }
    done.push(name.to_owned());
    let source = SOURCES.iter().find(|(n, _)| *n == name).map(|(_, s)| *s);
    let source = source.ok_or_else(|| RenderError::Shader {
        name: name.to_owned(),
        message: "is imported but does not exist".into(),
    })?;
    for import in source.lines().filter_map(|l| l.strip_prefix("#import ")) {
        append(import.trim(), done, text)?;
    }
    for line in source.lines().filter(|l| !l.starts_with("#import ")) {
        text.push_str(line);
        text.push('\n');
    }
    Ok(())
}
