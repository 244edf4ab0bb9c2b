//! Shader sources: `#import name` by stem from `shaders/shared/`, each once.

use crate::render::RenderError;

macro_rules! sources {
    (shared: $($shared:literal)* entries: $($entry:literal)*) => {
        /// Every shader by stem.
        const SOURCES: &[(&str, &str)] = &[
            $(($shared, include_str!(concat!("../../../shaders/shared/", $shared, ".wgsl"))),)*
            $(($entry, include_str!(concat!("../../../shaders/", $entry, ".wgsl"))),)*
        ];

        /// The stems of all shaders that are entry points of a pipeline.
        pub const ENTRIES: &[&str] = &[$($entry),*];
    };
}

sources! {
    shared:
        "layout"
        "grid"
        "cell"
        "thorough"
        "locate"
        "frame"
        "table"
        "transfer"
        "topology"
        "boundary"
        "ways"
        "segments"
        "section"
        "facing"
        "raster"
        "projection"
        "surfaces"
        "edges"
        "light"
        "cones"
        "cube"
        "around"
        "openness"
        "inside"
        "opacity"
        "sat"
        "vct"
        "cone_rays"
        "shading"
        "random"
        "mean"
        "groups"
    entries:
        "extinction"
        "faces"
        "illuminate"
        "libc"
        "moments"
        "paint"
        "peel"
        "plts"
        "probe"
        "pyramids"
        "resample"
        "solid"
        "srg"
        "sums"
}

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
