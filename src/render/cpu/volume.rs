//! Volumes over the box of the active cells, and numbers between their voxels.

use std::ops::{Add, Mul, Sub};

use glam::{Vec2, Vec3A, Vec4, Vec4Swizzles};

use super::mean::overlap;
use super::pieces::in_groups;
use crate::render::job::Progress;

/// What a voxel holds.
pub trait Voxel: Copy + Default + Send + Sync {
    /// What is interpolated.
    type Number: Copy
        + Add<Output = Self::Number>
        + Sub<Output = Self::Number>
        + Mul<f32, Output = Self::Number>;

    /// The voxel as numbers.
    fn number(self) -> Self::Number;

    /// The voxel of numbers.
    fn of(number: Self::Number) -> Self;

    /// Linear between the corners of a cube, x fastest, by the parts of its edges along x, y and depth.
    #[inline]
    fn between(cube: [Self; 8], [x, y, z]: [f32; 3]) -> Self::Number {
        let lerp = |a: Self::Number, b: Self::Number, part: f32| a + (b - a) * part;
        let along = |n: usize| lerp(cube[n].number(), cube[n + 1].number(), x);
        let across = |n: usize| lerp(along(n), along(n + 2), y);
        lerp(across(0), across(4), z)
    }
}

impl Voxel for f32 {
    type Number = Self;

    fn number(self) -> Self {
        self
    }

    fn of(number: Self) -> Self {
        number
    }

    /// Both faces across the depth in one vector each.
    #[inline]
    fn between([a, b, c, d, e, f, g, h]: [Self; 8], [x, y, z]: [f32; 3]) -> Self {
        let face = Vec4::new(a, b, c, d).lerp(Vec4::new(e, f, g, h), z);
        let edge = face.xy().lerp(face.zw(), y);
        edge.x + (edge.y - edge.x) * x
    }
}

impl Voxel for Vec4 {
    type Number = Self;

    fn number(self) -> Self {
        self
    }

    fn of(number: Self) -> Self {
        number
    }
}

/// Numbers are so many [`ONE_PART`]s.
impl Voxel for [u16; 2] {
    type Number = Vec2;

    fn number(self) -> Vec2 {
        Vec2::from_array(self.map(f32::from))
    }

    fn of(number: Vec2) -> Self {
        number.to_array().map(|n| (n + 0.5) as u16)
    }

    /// Both ends of an edge along x in one vector.
    #[inline]
    fn between(cube: [Self; 8], [x, y, z]: [f32; 3]) -> Vec2 {
        let edge = |n: usize| {
            let ([a, b], [c, d]) = (cube[n], cube[n + 1]);
            Vec4::from_array([a, b, c, d].map(f32::from))
        };
        let across = |n: usize| edge(n).lerp(edge(n + 2), y);
        let ends = across(0).lerp(across(4), z);
        ends.xy().lerp(ends.zw(), x)
    }
}

/// Numbers are so many [`ONE_PART`]s.
impl Voxel for [u16; 4] {
    type Number = Vec4;

    fn number(self) -> Vec4 {
        Vec4::from_array(self.map(f32::from))
    }

    fn of(number: Vec4) -> Self {
        number.to_array().map(|n| (n + 0.5) as u16)
    }
}

/// What numbers from 0 to 1 are stored in.
pub const ONE_PART: f32 = 1.0 / 65535.0;

/// A number from 0 to 1 in 16 bits.
pub fn in_parts(number: f32) -> u16 {
    (number * 65535.0 + 0.5) as u16
}

/// Voxels of a volume.
///
/// **Shape**: x fastest, then y, then depth; voxel n of N along an axis has its middle at (n + 1/2) / N of the box.
pub struct Voxels<T> {
    /// Voxels along x, y and depth.
    pub size: [usize; 3],
    /// All of them.
    pub data: Vec<T>,
    /// The same numbers as `size`, those of the last voxel along each axis, and those of the last pair.
    counts: Vec3A,
    last: Vec3A,
    last_pair: Vec3A,
    /// From a voxel to the next one along each axis; none where there is but one.
    steps: [usize; 3],
}

impl<T: Copy + Default + Send + Sync> Voxels<T> {
    /// So many voxels, all zero.
    pub fn new(size: [u32; 3]) -> Self {
        let counts = Vec3A::from_array(size.map(|n| n as f32));
        let size = size.map(|n| n as usize);
        let [width, height, depth] = size;
        let next = |step: usize, n: usize| if n > 1 { step } else { 0 };
        Self {
            size,
            data: vec![T::default(); width * height * depth],
            counts,
            last: counts - 1.0,
            last_pair: (counts - 2.0).max(Vec3A::ZERO),
            steps: [
                next(1, width),
                next(width, height),
                next(width * height, depth),
            ],
        }
    }

    /// Makes all voxels row by row: `make` gets y and depth of one.
    pub async fn by_rows(
        size: [u32; 3],
        progress: &Progress,
        make: impl Fn(usize, usize) -> Vec<T> + Sync,
    ) -> Self {
        let mut made = Self::new(size);
        let [width, height, depth] = made.size;
        let row = |n: usize| make(n % height, n / height);
        let data = &mut made.data;
        in_groups(height * depth, progress, row, |n, row| {
            data[n * width..(n + 1) * width].copy_from_slice(&row);
        })
        .await;
        made
    }

    /// Makes all voxels line by line down: `make` gets x, y and a line of zeros to fill.
    pub async fn by_lines(
        size: [u32; 3],
        progress: &Progress,
        make: impl Fn(usize, usize, &mut [T]) + Sync,
    ) -> Self {
        let mut made = Self::new(size);
        let [width, height, depth] = made.size;
        let lines = |y: usize| {
            let mut lines = vec![T::default(); width * depth];
            for (x, line) in lines.chunks_exact_mut(depth).enumerate() {
                make(x, y, line);
            }
            lines
        };
        let data = &mut made.data;
        in_groups(height, progress, lines, |y, lines| {
            for z in 0..depth {
                let first = width * (y + height * z);
                let row = &mut data[first..first + width];
                for (voxel, line) in row.iter_mut().zip(lines.chunks_exact(depth)) {
                    *voxel = line[z];
                }
            }
        })
        .await;
        made
    }

    /// A voxel.
    pub fn at(&self, [x, y, z]: [usize; 3]) -> T {
        self.data[x + self.size[0] * (y + self.size[1] * z)]
    }

    /// A row of voxels.
    pub fn row(&self, y: usize, z: usize) -> &[T] {
        let first = self.size[0] * (y + self.size[1] * z);
        &self.data[first..first + self.size[0]]
    }

    /// Bytes that they take.
    pub fn bytes(&self) -> u64 {
        size_of_val(self.data.as_slice()) as u64
    }
}

impl<T: Voxel> Voxels<T> {
    /// Linear between the middles of voxels at a place of the box, 0 to 1 each way; behind the outermost as there.
    #[inline]
    pub fn sample(&self, at: Vec3A) -> T::Number {
        let place = (at * self.counts - 0.5).clamp(Vec3A::ZERO, self.last);
        // Whole parts, as places are not negative. Numbers of 16 bits are the fastest to get from f32.
        let [x, y, z] = place.min(self.last_pair).to_array().map(|n| n as u16);
        let parts = place - Vec3A::new(f32::from(x), f32::from(y), f32::from(z));
        let [x, y, z] = [x, y, z].map(usize::from);
        let [width, height, _] = self.size;
        let first = x + width * (y + height * z);
        let [dx, dy, dz] = self.steps;
        let cube = &self.data[first..=first + dx + dy + dz];
        let corners = [
            cube[0],
            cube[dx],
            cube[dy],
            cube[dy + dx],
            cube[dz],
            cube[dz + dx],
            cube[dz + dy],
            cube[dz + dy + dx],
        ];
        T::between(corners, parts.to_array())
    }
}

/// The voxels along an axis that a larger one covers, and what part of it each is, given how many there are of both.
///
/// An odd number of voxels has no pairs: up to four along an axis lie within a larger one, in whole or in part.
pub fn covered([from, to]: [usize; 2], voxel: usize) -> impl Iterator<Item = (usize, f32)> {
    let range = voxel * from / to..((voxel + 1) * from).div_ceil(to);
    let [fine, coarse] = [from, to].map(|n| n as i32);
    range.map(move |n| {
        let part = overlap(n as i32, voxel as i32, fine, coarse);
        (n, part as f32 / from as f32)
    })
}

/// Coarser voxels, each the mean of what it covers.
pub async fn averages<T: Voxel>(fine: &Voxels<T>, progress: &Progress) -> Voxels<T> {
    let size = fine.size.map(|n| (n / 2).max(1));
    let covered = |axis: usize, voxel: usize| covered([fine.size[axis], size[axis]], voxel);
    Voxels::by_rows(size.map(|n| n as u32), progress, |y, z| {
        let mean = |x| {
            let mut sum = T::default().number();
            for (z, in_z) in covered(2, z) {
                for (y, in_y) in covered(1, y) {
                    let row = fine.row(y, z);
                    for (x, in_x) in covered(0, x) {
                        sum = sum + row[x].number() * (in_x * in_y * in_z);
                    }
                }
            }
            T::of(sum)
        };
        (0..size[0]).map(mean).collect()
    })
    .await
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_linear_between_voxels_and_even_behind_them() {
        let mut voxels = Voxels::<f32>::new([4, 3, 1]);
        for (n, voxel) in voxels.data.iter_mut().enumerate() {
            *voxel = (n % 4) as f32 + 10.0 * (n / 4) as f32;
        }
        let at = |x: f32, y: f32, z: f32| voxels.sample(Vec3A::new(x / 4.0, y / 3.0, z));
        assert_eq!(at(0.5, 0.5, 0.0), 0.0);
        assert!((at(1.75, 1.25, 0.7) - (1.25 + 7.5)).abs() < 1e-5);
        assert_eq!(at(-3.0, 9.0, 5.0), 20.0);
        assert_eq!(at(9.0, -1.0, 0.5), 3.0);
    }
}
