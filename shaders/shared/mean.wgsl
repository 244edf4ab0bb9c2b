// Means in larger voxels: along an axis `coarse` of them cover what `fine` voxels do.

// How much of fine voxel `n` lies within larger voxel `m`, in parts of which a larger one has `fine` in all. Whole
// numbers, so that voxels that only touch count nothing.
fn overlap(n: i32, m: i32, fine: i32, coarse: i32) -> f32 {
    return f32(max(min((n + 1) * coarse, (m + 1) * fine) - max(n * coarse, m * fine), 0));
}
