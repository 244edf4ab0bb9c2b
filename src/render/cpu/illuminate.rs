//! Light volumes: what the rays sample instead of tracing cones (campagnolo-2021, 3.3.3 and 4.2), and gradients.
//! The twin of `shaders/illuminate.wgsl`.

use glam::{IVec3, Vec3A, Vec4};

use super::resample::FieldVoxel;
use super::volume::Voxels;
use crate::render::job::Progress;
use crate::render::plan::layout::LightingInfo;
use crate::render::plan::occluders::Occluders;

/// Transmittances at the middles of voxels over a box of a size in lighting space; 1 where nothing is so near that it
/// matters.
pub async fn light_volume(
    box_size: Vec3A,
    transmittance: &(dyn Fn(Vec3A) -> f32 + Sync),
    near: &Voxels<bool>,
    progress: &Progress,
) -> Voxels<f32> {
    let size = near.size.map(|n| n as u32);
    let spacing = box_size / voxels(size);
    Voxels::by_rows(size, progress, |y, z| {
        let found = |(x, is_near): (usize, &bool)| match is_near {
            true => transmittance(middle([x, y, z]) * spacing),
            false => 1.0,
        };
        near.row(y, z).iter().enumerate().map(found).collect()
    })
    .await
}

/// Which voxels of light volumes of a size count for places in cells, or within a voxel of values from them.
pub async fn near_cells(field: &Voxels<u16>, size: [u32; 3], progress: &Progress) -> Voxels<bool> {
    let is_cell = |y, z| field.row(y, z).iter().map(|packed| *packed != 0).collect();
    near(field.size, &is_cell, size, progress).await
}

/// As [`near_cells`], with places in wells and sheets of faults, or within a voxel from them.
pub async fn near_occluders(
    cells: &Voxels<bool>,
    occluders: &Occluders,
    progress: &Progress,
) -> Voxels<bool> {
    let size = cells.size.map(|n| n as u32);
    let is_there = |y, z| occluders.row(y, z).map(|opacity| opacity > 0.0).collect();
    let from = occluders.size.map(|n| n as usize);
    let near = near(from, &is_there, size, progress).await;
    Voxels::by_rows(size, progress, |y, z| {
        let both = near.row(y, z).iter().zip(cells.row(y, z));
        both.map(|(a, b)| *a || *b).collect()
    })
    .await
}

/// Which voxels of a size count for places in the voxels of a size `from` that rows along x tell, or within one of those
/// from them.
async fn near(
    from: [usize; 3],
    is_there: &(dyn Fn(usize, usize) -> Vec<bool> + Sync),
    size: [u32; 3],
    progress: &Progress,
) -> Voxels<bool> {
    // Voxels so near to a voxel of light that it counts there.
    let around = |axis: usize, voxel: usize| {
        let (from, to) = (from[axis], size[axis]);
        let ratio = from as f32 / to as f32;
        let low = ((voxel as f32 - 0.5) * ratio - 2.0).ceil().max(0.0) as usize;
        let high = ((voxel as f32 + 1.5) * ratio + 1.0).floor() as usize;
        low..(high + 1).min(from)
    };
    let any_row = |rows: &mut dyn Iterator<Item = &[bool]>| {
        let mut any = vec![false; size[0] as usize];
        for row in rows {
            any.iter_mut()
                .zip(row)
                .for_each(|(any, is_near)| *any |= is_near);
        }
        any
    };
    let [_, height, depth] = from.map(|n| n as u32);
    let first = Voxels::by_rows([size[0], height, depth], progress, |y, z| {
        let row = is_there(y, z);
        let is_near = |x| row[around(0, x)].contains(&true);
        (0..size[0] as usize).map(is_near).collect()
    });
    let first = first.await;
    let second = Voxels::by_rows([size[0], size[1], depth], progress, |y, z| {
        any_row(&mut around(1, y).map(|n| first.row(n, z)))
    });
    let second = second.await;
    let third = |y, z| any_row(&mut around(2, z).map(|n| second.row(y, n)));
    Voxels::by_rows(size, progress, third).await
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
