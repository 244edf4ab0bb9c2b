//! Light volumes: what the rays sample instead of tracing cones (campagnolo-2021, 3.3.3 and 4.2), and gradients.
//! The twin of `shaders/illuminate.wgsl`.

use glam::{IVec3, Vec3A, Vec4};

use super::cones::Cones;
use super::light::Lamp;
use super::resample::FieldVoxel;
use super::volume::Voxels;
use crate::render::job::Progress;
use crate::render::plan::layout::LightingInfo;

/// Transmittances of the cones from the middles of voxels to one emitter.
pub async fn light_volume(
    cones: &Cones<'_>,
    lamp: &Lamp,
    size: [u32; 3],
    progress: &Progress,
) -> Voxels<f32> {
    let spacing = cones.size / voxels(size);
    Voxels::by_rows(size, progress, |y, z| {
        let found = |x| cones.transmittance(lamp, middle([x, y, z]) * spacing);
        (0..size[0] as usize).map(found).collect()
    })
    .await
}

/// Change of the transfer function's position a unit of lighting space, times presence; and presence. Least squares
/// over the voxels of values around, each axis for itself; those in no cell say nothing.
pub async fn gradients(
    field: &Voxels<u16>,
    info: &LightingInfo,
    progress: &Progress,
) -> Voxels<Vec4> {
    let size = info.light_size;
    let count = IVec3::from_array(field.size.map(|n| n as i32));
    let spacing = Vec3A::from(info.size) / count.as_vec3a();
    let to_field = count.as_vec3a() / voxels(size);
    Voxels::by_rows(size, progress, |y, z| {
        let gradient = |x| {
            let slope = slope_at(field, count, middle([x, y, z]) * to_field - 0.5)?;
            Some((slope * info.position_scale / spacing).extend(1.0))
        };
        let row = (0..size[0] as usize).map(gradient);
        row.map(Option::unwrap_or_default).collect()
    })
    .await
}

/// Change of the values from voxel to voxel around a place; `None` where there are none.
fn slope_at(field: &Voxels<u16>, count: IVec3, place: Vec3A) -> Option<Vec3A> {
    let nearest = place.to_array().map(f32::round_ties_even);
    let nearest = IVec3::from_array(nearest.map(|n| n as i32));
    let low = (nearest - 2).max(IVec3::ZERO);
    let high = (nearest + 2).min(count - 1);
    let (mut weights, mut mean) = (0.0, 0.0);
    let [mut off, mut square, mut product] = [Vec3A::ZERO; 3];
    for z in low.z..=high.z {
        for y in low.y..=high.y {
            for x in low.x..=high.x {
                let packed = field.at([x, y, z].map(|n| n as usize));
                let voxel = FieldVoxel::of(packed);
                if voxel.coverage == 0.0 || voxel.is_ghost {
                    continue;
                }
                let d = IVec3::new(x, y, z).as_vec3a() - place;
                let weight = voxel.coverage * (-0.5 * d.length_squared()).exp();
                weights += weight;
                mean += weight * voxel.value;
                off += weight * d;
                square += weight * d * d;
                product += weight * voxel.value * d;
            }
        }
    }
    let total = f32::max(weights, 1e-6);
    let spread = square - off * off / total;
    let slope = (product - mean * off / total) / spread;
    let is_known = spread.cmpgt(Vec3A::splat(0.01 * total));
    (weights > 1e-3).then_some(Vec3A::select(is_known, slope, Vec3A::ZERO))
}

fn voxels(size: [u32; 3]) -> Vec3A {
    Vec3A::from_array(size.map(|n| n as f32))
}

/// The middle of a voxel, in voxels.
fn middle(voxel: [usize; 3]) -> Vec3A {
    Vec3A::from_array(voxel.map(|n| n as f32)) + 0.5
}
