//! Volumes read back, Gaussians and cones in f64: what light is compared with.

use glam::DVec3;
use half::f16;
use strataray::case::Case;
use strataray::render::gpu::Gpu;
use strataray::render::gpu::volume::Volume;
use strataray::render::{Frame, Renderer};
use strataray::scene::{Interpolation, LightingSpec, OpacitySpec, RangeSpec, Scene};
use strataray::view::{self, View};

/// A scene of the property `VALUE` from 0 to 1 whose picture is as small as possible; opacities are per
/// world-space length `reference_length`.
pub fn scene(opacity: &[[f64; 2]], reference_length: f64, lighting: LightingSpec) -> Scene {
    let mut scene = Scene {
        size: [2, 2],
        property: Some("VALUE".into()),
        range: RangeSpec::Fixed([0.0, 1.0]),
        interpolation: Interpolation::Cell,
        vertical_exaggeration: Some(1.0),
        lighting,
        ..Scene::default()
    };
    scene.transfer.opacity = Some(OpacitySpec::Points(opacity.to_vec()));
    scene.transfer.reference_length = Some(reference_length);
    scene
}

/// Lighting as a scene file has it.
pub fn lighting(json: serde_json::Value) -> LightingSpec {
    serde_json::from_value(json).unwrap()
}

/// Renders a scene, so that its light is there.
pub fn render(renderer: &mut dyn Renderer, case: &Case, scene: &Scene) -> (View, Frame) {
    let view = view::resolve(scene, case).unwrap();
    let frame = renderer.render(&view, &|_| true).unwrap();
    (view, frame)
}

/// A level of a volume of 16 bits a voxel.
pub fn bits(gpu: &Gpu, volume: &Volume, level: u32) -> Vec<u16> {
    let size = volume.shape.at(level).map(|n| n as usize);
    let words = volume.read(gpu, level).unwrap();
    let rows = words.chunks(size[0].div_ceil(2));
    let of = |row: &[u32]| -> Vec<u16> {
        let halves = row.iter().flat_map(|w| [*w as u16, (*w >> 16) as u16]);
        halves.take(size[0]).collect()
    };
    let bits: Vec<u16> = rows.flat_map(of).collect();
    assert_eq!(bits.len(), size.iter().product::<usize>());
    bits
}

/// Numbers at the middles of voxels, x fastest, then y, then depth.
#[derive(Clone)]
pub struct Block {
    pub size: [usize; 3],
    pub values: Vec<f64>,
}

impl Block {
    /// A level of a volume of single half floats.
    pub fn read(gpu: &Gpu, volume: &Volume, level: u32) -> Self {
        let halves = bits(gpu, volume, level).into_iter().map(f16::from_bits);
        let values: Vec<f64> = halves.map(f64::from).collect();
        assert!(values.iter().all(|v| v.is_finite()));
        Self {
            size: volume.shape.at(level).map(|n| n as usize),
            values,
        }
    }

    /// All levels of a volume.
    pub fn levels(gpu: &Gpu, volume: &Volume) -> Vec<Self> {
        let levels = 0..volume.shape.levels;
        levels.map(|level| Self::read(gpu, volume, level)).collect()
    }

    pub fn at(&self, [x, y, z]: [usize; 3]) -> f64 {
        self.values[x + self.size[0] * (y + self.size[1] * z)]
    }

    pub fn at_mut(&mut self, [x, y, z]: [usize; 3]) -> &mut f64 {
        &mut self.values[x + self.size[0] * (y + self.size[1] * z)]
    }

    /// The voxels in order.
    pub fn voxels(&self) -> impl Iterator<Item = [usize; 3]> + use<> {
        let [nx, ny, nz] = self.size;
        (0..nx * ny * nz).map(move |n| [n % nx, n / nx % ny, n / nx / ny])
    }

    /// Middle of a voxel as a part of the box.
    pub fn middle(&self, voxel: [usize; 3]) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|a| {
            (voxel[a] as f64 + 0.5) / self.size[a] as f64
        }))
    }

    /// Linear between the middles of voxels, at a part of the box; the border goes on outside.
    pub fn linear(&self, part: DVec3) -> f64 {
        let size = DVec3::from_array(self.size.map(|n| n as f64));
        let at = (part * size - 0.5).clamp(DVec3::ZERO, size - 1.0);
        let low = at.floor();
        let corner = |n: usize| {
            let off = [n & 1, n >> 1 & 1, n >> 2];
            let voxel = std::array::from_fn(|a| (low[a] as usize + off[a]).min(self.size[a] - 1));
            let weights = off.iter().enumerate().map(|(a, &o)| match o {
                0 => 1.0 - (at[a] - low[a]),
                _ => at[a] - low[a],
            });
            weights.product::<f64>() * self.at(voxel)
        };
        (0..8).map(corner).sum()
    }

    #[must_use]
    pub fn map(&self, f: impl Fn(f64) -> f64) -> Self {
        Self {
            size: self.size,
            values: self.values.iter().map(|v| f(*v)).collect(),
        }
    }

    /// Opacities of the depths that a pyramid holds.
    #[must_use]
    pub fn opacities(&self) -> Self {
        self.map(|depth| -(-depth).exp_m1())
    }

    /// Largest difference.
    pub fn apart(&self, other: &Self) -> f64 {
        assert_eq!(self.size, other.size);
        let pairs = self.values.iter().zip(&other.values);
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    pub fn sum(&self) -> f64 {
        self.values.iter().sum()
    }

    /// The mean of what is around, nothing of it outside: at `size` middles of voxels, by a Gaussian whose
    /// standard deviation along each axis is given in voxels, and which ends after `reach` of them and half
    /// a voxel.
    #[must_use]
    pub fn blurred(&self, size: [usize; 3], deviation: DVec3, reach: f64) -> Self {
        let weights: [Vec<Vec<f64>>; 3] =
            std::array::from_fn(|a| gaussians(self.size[a], size[a], deviation[a], reach));
        self.by(size, &weights)
    }

    /// Sums of all voxels, with weights along each axis for each voxel made.
    fn by(&self, size: [usize; 3], weights: &[Vec<Vec<f64>>; 3]) -> Self {
        let mut made = Self {
            size,
            values: Vec::new(),
        };
        for z in &weights[2] {
            for y in &weights[1] {
                for x in &weights[0] {
                    made.values.push(self.weighted([x, y, z]));
                }
            }
        }
        made
    }

    /// The means in `size` voxels of what lies within each.
    #[must_use]
    pub fn means(&self, size: [usize; 3]) -> Self {
        let weights: [Vec<Vec<f64>>; 3] = std::array::from_fn(|a| overlaps(self.size[a], size[a]));
        self.by(size, &weights)
    }

    fn weighted(&self, [x, y, z]: [&Vec<f64>; 3]) -> f64 {
        let mut rows = self.values.chunks(self.size[0]);
        let mut sum = 0.0;
        for wz in z {
            for wy in y {
                let row = rows.next().unwrap();
                if wy * wz > 0.0 {
                    let part: f64 = row.iter().zip(x).map(|(v, w)| v * w).sum();
                    sum += wy * wz * part;
                }
            }
        }
        sum
    }
}

/// How much of each voxel lies within each of `made` larger ones, as a part of the larger one.
fn overlaps(source: usize, made: usize) -> Vec<Vec<f64>> {
    let ratio = source as f64 / made as f64;
    let part = |n: usize, m: usize| {
        let from = (m as f64 * ratio).max(n as f64);
        let to = ((m + 1) as f64 * ratio).min((n + 1) as f64);
        (to - from).max(0.0) / ratio
    };
    (0..made)
        .map(|m| (0..source).map(|n| part(n, m)).collect())
        .collect()
}

/// Weights of `count` voxels around the middle of each of `made` over the same length.
fn gaussians(count: usize, made: usize, deviation: f64, reach: f64) -> Vec<Vec<f64>> {
    let ratio = count as f64 / made as f64;
    let of = |n: usize| {
        let center = (n as f64 + 0.5) * ratio - 0.5;
        let weight = |at: i64| {
            let off = at as f64 - center;
            let is_within = off.abs() <= reach * deviation + 0.5 + 1e-9;
            f64::from(u8::from(is_within)) * (-0.5 * (off / deviation).powi(2)).exp()
        };
        let far = (reach.min(12.0) * deviation + 1.0).ceil() as i64;
        let all = center.floor() as i64 - far..=center.ceil() as i64 + far;
        let total: f64 = all.map(weight).sum();
        (0..count as i64).map(|at| weight(at) / total).collect()
    };
    (0..made).map(of).collect()
}

/// Lighting space: the grid's axes from the low corner of the box, in standard deviations of the finest
/// level, which is the mean edge of a voxel in world space.
pub struct Space {
    low: DVec3,
    axes: [DVec3; 3],
    /// Edges of the box in world space.
    pub edges: DVec3,
    /// World-space length of the unit.
    pub sigma: f64,
}

impl Space {
    /// That of a view whose extinction volume has `size` voxels.
    pub fn new(view: &View, size: [usize; 3]) -> Self {
        let low = view.world.corners[0];
        let sides = [1, 2, 4].map(|c: usize| view.world.corners[c] - low);
        let edges = DVec3::from_array(sides.map(DVec3::length));
        let voxels = DVec3::from_array(size.map(|n| n as f64));
        Self {
            low,
            axes: sides.map(DVec3::normalize),
            edges,
            sigma: (edges / voxels).element_sum() / 3.0,
        }
    }

    /// The box's size in lighting space.
    pub fn size(&self) -> DVec3 {
        self.edges / self.sigma
    }

    /// Where a point of world space is.
    pub fn point(&self, world: DVec3) -> DVec3 {
        let off = (world - self.low) / self.sigma;
        DVec3::from_array(self.axes.map(|axis| axis.dot(off)))
    }

    /// The point of world space at a part of the box.
    pub fn world(&self, part: DVec3) -> DVec3 {
        let off = (part * self.edges).to_array();
        self.low + self.axes[0] * off[0] + self.axes[1] * off[1] + self.axes[2] * off[2]
    }
}
