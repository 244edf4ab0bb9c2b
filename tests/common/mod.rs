//! Helpers of the tests: where the data is, whether there is a GPU, how to compare.
#![allow(dead_code, reason = "each test file uses its own part")]
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "tests"
)]

pub mod cone;
pub mod images;
pub mod light;
pub mod shape;
pub mod tiny;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use strataray::render::Executor;
use strataray::render::cpu::CpuExecutor;
use strataray::render::gpu::{Gpu, GpuExecutor};

/// A file in the folder of real models, or `None` with a sentence where the folder is absent, which is a failure
/// where REQUIRE_DATA is 1.
pub fn data(file: &str) -> Option<PathBuf> {
    let Some(folder) = std::env::var_os("STRATARAY_DATA") else {
        let missing = format!("STRATARAY_DATA is not set, so {file} is not there");
        assert!(!is_required("REQUIRE_DATA"), "{missing}");
        eprintln!("SKIPPED: {missing}");
        return None;
    };
    let path = Path::new(&folder).join(file);
    assert!(path.exists(), "{} is missing", path.display());
    Some(path)
}

/// A file of the tests' own small data, which every clone has.
pub fn bundled(file: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    folder.join(file)
}

/// Whether a variable says that what a test needs must be there.
fn is_required(variable: &str) -> bool {
    std::env::var(variable).is_ok_and(|v| v == "1")
}

/// The bundled sample.
pub fn sample() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/scissor/SCISSOR.EGRID")
}

/// A copy of the sample in a folder.
pub fn copy_of_sample(folder: &Path) -> PathBuf {
    let from = sample();
    for file in std::fs::read_dir(from.parent().unwrap()).unwrap() {
        let file = file.unwrap().path();
        std::fs::copy(&file, folder.join(file.file_name().unwrap())).unwrap();
    }
    folder.join(from.file_name().unwrap())
}

/// The sample and the real models that pictures are compared on.
pub fn models() -> Vec<PathBuf> {
    let real = [
        "reek/REEK.EGRID",
        "brugge/BRUGGE_0000.EGRID",
        "editnnc/9_EDITNNC.EGRID",
    ];
    let mut models = vec![sample()];
    models.extend(real.iter().filter_map(|f| data(f)));
    models
}

/// All executors that there are.
pub fn executors() -> Vec<Arc<dyn Executor>> {
    let gpu = gpu().map(|gpu| Arc::new(GpuExecutor::from(gpu)) as Arc<dyn Executor>);
    let cpu: Arc<dyn Executor> = Arc::new(CpuExecutor::default());
    gpu.into_iter().chain([cpu]).collect()
}

/// An adapter; without one the test is skipped, or fails where REQUIRE_GPU is 1.
pub fn gpu() -> Option<Arc<Gpu>> {
    match Gpu::new(None) {
        Ok(gpu) => Some(Arc::new(gpu)),
        Err(error) if is_required("REQUIRE_GPU") => panic!("{error}"),
        Err(error) => {
            eprintln!("SKIPPED: {error}");
            None
        }
    }
}
