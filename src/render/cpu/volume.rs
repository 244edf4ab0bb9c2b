//! Volumes over the box of the active cells, and numbers between their voxels.

use std::ops::{Add, Mul, Sub};

use glam::{Vec2, Vec3A, Vec4};

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
}

impl Voxel for f32 {
    type Number = Self;

    fn number(self) -> Self {
        self
    }
}

impl Voxel for Vec4 {
    type Number = Self;

    fn number(self) -> Self {
        self
    }
}

/// Parts of one, in 16 bits each.
impl Voxel for [u16; 2] {
    type Number = Vec2;

    fn number(self) -> Vec2 {
        Vec2::from_array(self.map(f32::from)) * ONE_PART
    }
}

/// Parts of one, in 16 bits each.
impl Voxel for [u16; 4] {
    type Number = Vec4;

    fn number(self) -> Vec4 {
        Vec4::from_array(self.map(f32::from)) * ONE_PART
    }
}

const ONE_PART: f32 = 1.0 / 65535.0;

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
}

impl<T: Copy + Default + Send + Sync> Voxels<T> {
    /// So many voxels, all zero.
    pub fn new(size: [u32; 3]) -> Self {
        let size = size.map(|n| n as usize);
        Self {
            size,
            data: vec![T::default(); size.iter().product()],
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
    pub fn sample(&self, at: Vec3A) -> T::Number {
        let [width, height, depth] = self.size;
        let count = Vec3A::new(width as f32, height as f32, depth as f32);
        let place = (at * count - 0.5).clamp(Vec3A::ZERO, count - 1.0);
        let low = place.floor().min((count - 2.0).max(Vec3A::ZERO));
        let [fx, fy, fz] = (place - low).to_array();
        let [x, y, z] = low.to_array().map(|n| n as usize);
        let first = x + width * (y + height * z);
        let next = |step: usize, n: usize| if n > 1 { step } else { 0 };
        let (dx, dy, dz) = (
            next(1, width),
            next(width, height),
            next(width * height, depth),
        );
        let cube = &self.data[first..=first + dx + dy + dz];
        let along = |n: usize| {
            let (a, b) = (cube[n].number(), cube[n + dx].number());
            a + (b - a) * fx
        };
        let across = |n: usize| {
            let (a, b) = (along(n), along(n + dy));
            a + (b - a) * fy
        };
        let (a, b) = (across(0), across(dz));
        a + (b - a) * fz
    }
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
