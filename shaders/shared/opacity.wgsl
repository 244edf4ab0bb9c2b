// Opacities of the volume of values, and what clip planes leave of it.
#import light

// Clip planes cut values away.
override CLIPS: bool = false;

@group(3) @binding(0) var<uniform> blur: BlurInfo;

// Whether clip planes leave the middle of a voxel.
fn is_unclipped(at: vec3i) -> bool {
    var kept = true;
    if CLIPS {
        let point = blur.box_low + (vec3f(at) + 0.5) * blur.spacing;
        for (var n = 0u; n < blur.clip_count; n++) {
            let plane = blur.clip_planes[n];
            kept = kept && dot(plane.xyz, point) + plane.w >= 0.0;
        }
    }
    return kept;
}

// Opacity of a unit of length.
fn opacity_of_values(at: vec3i) -> f32 {
    let voxel = field_voxel(at);
    let in_cell = transfer_at(blur.position_low + blur.position_scale * voxel.value).w;
    let coverage = select(0.0, voxel.coverage, is_unclipped(at));
    return coverage * (1.0 - exp(-select(in_cell, blur.ghost, voxel.is_ghost) * blur.sigma));
}

// The same with the opacity of what stands in the way beside cells.
fn with_others(at: vec3i, others: f32) -> f32 {
    let kept = select(0.0, others, is_unclipped(at));
    return 1.0 - (1.0 - opacity_of_values(at)) * (1.0 - kept);
}
