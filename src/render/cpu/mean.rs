//! Means in larger voxels: along an axis `coarse` of them cover what `fine` voxels do.
//! The twin of `shaders/shared/mean.wgsl`.

/// How much of fine voxel `n` lies within larger voxel `m`, in parts of which a larger one has `fine` in all. Whole
/// numbers, so that voxels that only touch count nothing.
pub fn overlap(n: i32, m: i32, fine: i32, coarse: i32) -> i32 {
    let end = ((n + 1) * coarse).min((m + 1) * fine);
    (end - (n * coarse).max(m * fine)).max(0)
}
