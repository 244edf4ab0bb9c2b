//! Camera rays and the sample lattice. The twin of `shaders/shared/frame.wgsl`.

use glam::{Mat3A, Vec3A, Vec4};

use crate::render::plan::layout;

/// Numbers of four samples, less that of the first.
pub const AHEAD: Vec4 = Vec4::new(0.0, 1.0, 2.0, 3.0);

/// The numbers of a frame, see [`layout::Frame`].
pub struct Frame {
    /// As they are.
    pub numbers: layout::Frame,
    /// From world-space displacements to those of grid space.
    pub to_grid: Mat3A,
    /// Kept is where dot(xyz, point) + w >= 0.
    pub clip_planes: Vec<Vec4>,
}

/// The ray through the middle of a pixel.
#[derive(Clone, Copy)]
pub struct PixelRay {
    /// The eye, or in parallel a point of the plane through it.
    pub origin: Vec3A,
    /// Grid-space displacement per world-space length.
    pub direction: Vec3A,
    /// World-space length a unit along the camera's axis.
    pub slant: f32,
}

/// A pixel's ray, cut to the model's box and the clip planes.
#[derive(Clone, Copy)]
pub struct Ray {
    /// Sample n of the ray lies at `base + n * advance`, grid space relative to the origin, and at distance
    /// `(first + n + 1/2) * step` from the ray's origin.
    pub base: Vec3A,
    /// See `base`.
    pub advance: Vec3A,
    /// See `base`.
    pub first: f32,
    /// Number of samples inside the model's box and the kept side of all clip planes.
    pub count: f32,
    /// The eye, or in parallel a point of the plane through it.
    pub origin: Vec3A,
    /// Grid-space displacement per world-space length.
    pub direction: Vec3A,
    /// Distances from the origin between which the ray is kept; none where `leave <= enter`.
    pub enter: f32,
    /// See `enter`.
    pub leave: f32,
    /// The clip plane through which it enters.
    pub cut: Option<usize>,
    /// The section of that is opaque.
    pub opaque_cut: bool,
    /// The ray starts inside the box: its origin is there, or a clip plane opens it.
    pub starts_inside: bool,
}

impl Frame {
    /// A frame of these numbers.
    pub fn new(numbers: layout::Frame) -> Self {
        let planes = &numbers.clip_planes[..numbers.clip_count as usize];
        Self {
            to_grid: Mat3A::from_cols(
                numbers.grid_from_world_x.into(),
                numbers.grid_from_world_y.into(),
                numbers.grid_from_world_z.into(),
            ),
            clip_planes: planes.iter().map(|p| Vec4::from_array(*p)).collect(),
            numbers,
        }
    }

    /// The middle of a pixel: from -1 to 1, to the right and up.
    pub fn middle(&self, [x, y]: [u32; 2]) -> [f32; 2] {
        let part = |n: u32, of: u32| 2.0 * (n as f32 + 0.5) / of as f32;
        let numbers = &self.numbers;
        [part(x, numbers.width) - 1.0, 1.0 - part(y, numbers.height)]
    }

    /// The ray of a pixel.
    pub fn pixel_ray(&self, pixel: [u32; 2]) -> PixelRay {
        let [x, y] = self.middle(pixel);
        let numbers = &self.numbers;
        let at = |[zero, x_axis, y_axis]: [[f32; 3]; 3]| {
            Vec3A::from(zero) + x * Vec3A::from(x_axis) + y * Vec3A::from(y_axis)
        };
        let world = at([numbers.forward, numbers.right, numbers.up]);
        let slant = world.length();
        PixelRay {
            origin: at([numbers.eye, numbers.origin_right, numbers.origin_up]),
            direction: self.to_grid * (world / slant),
            slant,
        }
    }

    /// How a point of a ray moves from a pixel of the final image to the next one to the right, and to the one below:
    /// grid space.
    pub fn pixel_steps(&self, direction: Vec3A, distance: f32) -> [Vec3A; 2] {
        let numbers = &self.numbers;
        let depth = distance * Vec3A::from(numbers.view_z).dot(direction);
        let across = |origin: [f32; 3], axis: [f32; 3]| {
            Vec3A::from(origin) + self.to_grid * (depth * Vec3A::from(axis))
        };
        let pixel = |rays: u32| 2.0 * numbers.rays_across / rays as f32;
        [
            pixel(numbers.width) * across(numbers.origin_right, numbers.right),
            -pixel(numbers.height) * across(numbers.origin_up, numbers.up),
        ]
    }

    /// True where a point lies in the model's box.
    pub fn is_in_box(&self, point: Vec3A) -> bool {
        let [low, high] = [self.numbers.box_low, self.numbers.box_high].map(Vec3A::from);
        (point.cmpge(low) & point.cmple(high)).all()
    }

    /// True on the kept side of all clip planes.
    pub fn is_kept(&self, point: Vec3A) -> bool {
        let mut planes = self.clip_planes.iter();
        planes.all(|plane| Vec3A::from_vec4(*plane).dot(point) + plane.w >= 0.0)
    }

    /// The ray of a pixel, cut to the model's box and the clip planes.
    pub fn ray_of(&self, pixel: [u32; 2]) -> Ray {
        let PixelRay {
            origin, direction, ..
        } = self.pixel_ray(pixel);
        let numbers = &self.numbers;
        let step = numbers.step;
        let tiny = Vec3A::splat(1e-12);
        let safe = Vec3A::select(direction.abs().cmplt(tiny), tiny, direction);
        let a = (Vec3A::from(numbers.box_low) - origin) / safe;
        let b = (Vec3A::from(numbers.box_high) - origin) / safe;
        let box_enter = a.min(b).max_element();
        let box_leave = a.max(b).min_element();
        let clip = self.clipped(origin, direction);
        let (enter, leave) = (box_enter.max(clip.enter), box_leave.min(clip.leave));
        let is_kept = leave > enter;
        // The box has slack of a sample, clip planes have none: they cut through cells.
        let first = (box_enter / step - 0.5)
            .floor()
            .max(0.0)
            .max((clip.enter / step - 0.5).ceil());
        let end = (box_leave / step - 0.5)
            .ceil()
            .min((clip.leave / step - 0.5).floor());
        let starts_inside = is_kept && clip.enter >= box_enter;
        let is_opaque = |cut: usize| numbers.opaque_cuts >> cut & 1 == 1;
        Ray {
            base: origin + (first + 0.5) * step * direction,
            advance: step * direction,
            first,
            count: if is_kept {
                (end - first + 1.0).max(0.0)
            } else {
                0.0
            },
            origin,
            direction,
            enter,
            leave,
            cut: clip.cut,
            opaque_cut: starts_inside && clip.cut.is_some_and(is_opaque),
            starts_inside,
        }
    }

    /// Distances between which clip planes keep a pixel's ray.
    pub fn kept(&self, ray: &PixelRay) -> [f32; 2] {
        let Clipped { enter, leave, .. } = self.clipped(ray.origin, ray.direction);
        [enter, leave]
    }

    /// What clip planes leave of a ray.
    fn clipped(&self, origin: Vec3A, direction: Vec3A) -> Clipped {
        let mut clipped = Clipped {
            enter: 0.0,
            leave: 1e30,
            cut: None,
        };
        for (n, plane) in self.clip_planes.iter().enumerate() {
            let normal = Vec3A::from_vec4(*plane);
            let height = normal.dot(origin) + plane.w;
            let rate = normal.dot(direction);
            if rate.abs() < 1e-12 {
                if height < 0.0 {
                    clipped.leave = -1.0;
                }
            } else if rate < 0.0 {
                clipped.leave = clipped.leave.min(-height / rate);
            } else if -height / rate > clipped.enter {
                clipped.enter = -height / rate;
                clipped.cut = Some(n);
            }
        }
        clipped
    }
}

/// The stretch of a ray between clip planes.
struct Clipped {
    enter: f32,
    leave: f32,
    /// The plane through which it enters.
    cut: Option<usize>,
}

impl Ray {
    /// Samples straight down from a point, so many of them `spacing` apart.
    pub fn down(from: Vec3A, spacing: f32, count: f32) -> Self {
        let advance = spacing * Vec3A::Z;
        Self {
            base: from,
            advance,
            first: 0.0,
            count,
            origin: from,
            direction: Vec3A::Z,
            enter: 0.0,
            leave: spacing * count,
            cut: None,
            opaque_cut: false,
            starts_inside: true,
        }
    }

    /// Place of a sample.
    pub fn sample(&self, n: f32) -> Vec3A {
        self.base + n * self.advance
    }

    /// Distance of a sample.
    pub fn distance(&self, step: f32, n: f32) -> f32 {
        (self.first + n + 0.5) * step
    }

    /// Place at a distance.
    pub fn at(&self, distance: f32) -> Vec3A {
        self.origin + distance * self.direction
    }
}
