//! Dispatches: every entry has its own workgroup size, and what a device does not take is a plain error.

use crate::common;
use strataray::render::RenderError;
use strataray::render::gpu::shader::{ENTRIES, compose};
use strataray::render::gpu::{Pipeline, tiles};

/// Names and workgroup sizes of the compute entries of a shader, as its text has them.
fn entries(shader: &str) -> Vec<(String, [u32; 3])> {
    let text = compose(shader).unwrap();
    let module = wgpu::naga::front::wgsl::parse_str(&text).unwrap();
    let entries = module.entry_points.into_iter();
    entries
        .filter(|e| e.stage == wgpu::naga::ShaderStage::Compute)
        .map(|e| (e.name, e.workgroup_size))
        .collect()
}

#[test]
fn every_entry_is_dispatched_by_its_own_workgroup_size() {
    let Some(gpu) = common::gpu() else { return };
    let mut sizes = Vec::new();
    for &shader in ENTRIES {
        for (entry, workgroup) in entries(shader) {
            let pipeline = Pipeline::variant(&gpu, shader, &entry, &[]).unwrap();
            assert_eq!(pipeline.workgroup, workgroup, "{shader}, {entry}");
            let covered = pipeline.groups_for([1000, 10, 1]);
            for axis in 0..3 {
                let invocations = covered[axis] * workgroup[axis];
                let spare = invocations - [1000, 10, 1][axis];
                assert!(spare < workgroup[axis], "{shader}, {entry}");
            }
            sizes.push((shader, workgroup));
        }
    }
    // The test means something where entries of one shader differ.
    let differ = |a: &(&str, [u32; 3])| sizes.iter().any(|b| a.0 == b.0 && a.1 != b.1);
    assert!(sizes.len() > 12 && sizes.iter().any(differ), "{sizes:?}");
}

#[test]
fn all_rays_of_the_largest_tile_fit_into_a_dispatch() {
    let Some(gpu) = common::gpu() else { return };
    let most = gpu.device.limits().max_compute_workgroups_per_dimension;
    let rays = u32::try_from(tiles::MAX_AREA).unwrap();
    for entry in ["walk", "set_right"] {
        let pipeline = Pipeline::variant(&gpu, "libc", entry, &[]).unwrap();
        let [groups, ..] = pipeline.groups_for([rays, 1, 1]);
        assert!(groups <= most, "{entry}: {groups} of {most}");
    }
}

#[test]
fn err_a_dispatch_that_is_too_large_is_named() {
    let Some(gpu) = common::gpu() else { return };
    let pipeline = Pipeline::variant(&gpu, "libc", "walk", &[]).unwrap();
    let most = gpu.device.limits().max_compute_workgroups_per_dimension;
    let rays = 64 * (most + 1);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    pipeline.dispatch(&mut encoder, &[], [rays, 1, 1]);
    gpu.queue.submit([encoder.finish()]);
    let error = gpu.check().unwrap_err();
    assert!(
        matches!(error, RenderError::TooManyGroups { .. }),
        "{error}"
    );
    let words = error.to_string();
    assert!(
        words.contains("libc, walk") && words.contains("smaller"),
        "{words}"
    );
    // It is told once; the device goes on.
    gpu.check().unwrap();
    let error = Pipeline::variant(&gpu, "libc", "wander", &[])
        .err()
        .unwrap();
    assert!(error.to_string().contains("has no entry wander"), "{error}");
}
