//! One picture: tiles on all threads, in groups so short that whoever waits can look at the clock between them.

use std::time::{Duration, Instant};

use glam::Vec4;
use rayon::prelude::*;

use super::boundary::Boundary;
use super::libc::{self, Entry, Way};
use super::plts;
use super::raster::{FaceBins, Met, Projector, TILE, TileRect};
use super::scene::Scene;
use super::section::section_color;
use super::srg::{self, SrgVolume};
use super::surfaces::{Layers, Painter, SurfaceFaces};
use super::tally::Tally;
use super::transfer::Accumulated;
use crate::image::Image;
use crate::render::FrameStats;
use crate::render::job::Progress;
use crate::render::plan::tubes::TubePoint;
use crate::view::View;

/// What casts the rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Strategy {
    /// Point location with topological search.
    Plts,
    /// Linear interpolation with barycentric coordinates.
    Libc,
    /// Structured resampled grid.
    Srg,
    /// Nothing: surfaces and sections are all there is.
    Solid,
}

/// Time that a group of tiles should take.
const GROUP: Duration = Duration::from_millis(30);

/// What a picture is made of.
pub struct Picture<'a> {
    /// What all rays read.
    pub scene: &'a Scene<'a>,
    /// What is looked at.
    pub view: &'a View,
    /// What casts the rays.
    pub strategy: Strategy,
    /// What rays of SRG sample.
    pub srg: Option<SrgVolume<'a>>,
    /// Boundary faces of the drawn cells.
    pub boundary: &'a [u32],
    /// Faces of the surfaces.
    pub surfaces: &'a SurfaceFaces,
}

/// The faces of a picture by tiles.
struct Bins<'a> {
    projector: Projector<'a>,
    boundary: FaceBins,
    hull: FaceBins,
    faults: FaceBins,
}

/// What a thread uses again for each tile.
#[derive(Default)]
struct Scratch {
    /// Faces met by each pixel of the tile, of the boundary, the hull and the faults.
    met: [Vec<Vec<Met>>; 3],
    /// Of the ray under way.
    ray: OfRay,
}

/// What a ray meets.
#[derive(Default)]
struct OfRay {
    boundary: Boundary,
    entries: Vec<Entry>,
    layers: Layers,
}

/// Tiles in an order in which those that cost much are not together, so that each group says of the next one what that
/// will cost.
fn scattered(mut tiles: Vec<TileRect>) -> Vec<TileRect> {
    fastrand::Rng::with_seed(0).shuffle(&mut tiles);
    tiles
}

/// A tile and what its rays cost.
struct Made {
    pixels: Vec<[f32; 4]>,
    tally: Tally,
}

impl Picture<'_> {
    /// Makes the picture.
    pub async fn render(&self, progress: &Progress) -> (Image, FrameStats) {
        let start = Instant::now();
        let size = self.view.size;
        let bins = self.bins();
        let painter = Painter::new(self.surfaces, self.view);
        let tiles = scattered(TileRect::all(size));
        let mut pixels = vec![[0.0; 4]; size[0] as usize * size[1] as usize];
        let mut tally = Tally::default();
        let mut stats = FrameStats::default();
        let mut group = rayon::current_num_threads();
        let mut done = 0;
        while done < tiles.len() {
            let began = Instant::now();
            let now = &tiles[done..(done + group).min(tiles.len())];
            let made: Vec<Made> = now
                .par_iter()
                .map_init(Scratch::default, |scratch, tile| {
                    self.tile(&bins, &painter, tile, scratch)
                })
                .collect();
            for (tile, made) in now.iter().zip(made) {
                tally += made.tally;
                let rows = made.pixels.chunks(tile.size[0] as usize);
                for (row, y) in rows.zip(tile.origin[1]..) {
                    let at = (tile.origin[0] + size[0] * y) as usize;
                    pixels[at..at + row.len()].copy_from_slice(row);
                }
            }
            done += now.len();
            let took = began.elapsed();
            stats.submissions += 1;
            stats.longest_submission = stats.longest_submission.max(took);
            let change = GROUP.as_secs_f64() / took.as_secs_f64().max(1e-6);
            let wanted = group as f64 * change.clamp(0.25, 1.7);
            group = (wanted as usize).max(rayon::current_num_threads());
            progress.reached(done as f64 / tiles.len() as f64).await;
        }
        let wall = start.elapsed();
        let stats = FrameStats {
            frame: wall,
            wall,
            longest_submission: stats.longest_submission,
            submissions: stats.submissions,
            covered_pixels: pixels.iter().filter(|pixel| pixel[3] != 0.0).count() as u64,
            target_bytes: 16 * pixels.len() as u64,
            ..tally.stats()
        };
        let image = Image {
            size,
            blending: self.view.style.blending,
            pixels,
        };
        (image, stats)
    }

    fn bins(&self) -> Bins<'_> {
        let projector = Projector::new(self.scene.grid, &self.scene.frame);
        let boundary = match self.strategy {
            Strategy::Solid => &[],
            Strategy::Plts | Strategy::Libc | Strategy::Srg => self.boundary,
        };
        Bins {
            boundary: FaceBins::new(&projector, boundary),
            hull: FaceBins::new(&projector, &self.surfaces.hull),
            faults: FaceBins::new(&projector, &self.surfaces.faults),
            projector,
        }
    }

    fn tile(
        &self,
        bins: &Bins<'_>,
        painter: &Painter<'_>,
        tile: &TileRect,
        scratch: &mut Scratch,
    ) -> Made {
        let Scratch { met, ray } = scratch;
        let faces = [&bins.boundary, &bins.hull, &bins.faults];
        for (met, faces) in met.iter_mut().zip(faces) {
            met.resize_with((TILE * TILE) as usize, Vec::new);
            faces.meet(&bins.projector, tile, met);
        }
        let mut tally = Tally::default();
        let pixels = tile.pixels().enumerate().map(|(n, pixel)| {
            let [of_boundary, hull, faults] = [0, 1, 2].map(|list| met[list][n].as_slice());
            let pixel = Pixel {
                at: pixel,
                met: of_boundary,
                surfaces: [hull, faults],
                tube: painter.tube(pixel),
            };
            self.pixel(painter, &pixel, ray, &mut tally)
        });
        Made {
            pixels: pixels.collect(),
            tally,
        }
    }

    fn pixel(
        &self,
        painter: &Painter<'_>,
        pixel: &Pixel<'_>,
        of_ray: &mut OfRay,
        tally: &mut Tally,
    ) -> [f32; 4] {
        tally.rays += 1;
        let is_empty = pixel.is_empty();
        if is_empty && self.scene.cube.is_none() {
            return [0.0; 4];
        }
        let scene = self.scene;
        let OfRay {
            boundary,
            entries,
            layers,
        } = of_ray;
        let through = scene.frame.pixel_ray(pixel.at);
        let whole = scene.frame.ray_of(pixel.at);
        let surfaces = (pixel.surfaces, pixel.tube);
        painter.find(scene, &through, surfaces, layers, tally);
        let section = match is_empty {
            true => Vec4::ZERO,
            false => section_color(scene, &whole, tally),
        };
        let mut sum = Accumulated::of(section);
        let ray = layers.before_opaque(scene, &whole);
        match self.strategy {
            _ if is_empty || !scene.transfer.is_open(&sum) => {}
            Strategy::Solid => {}
            Strategy::Plts => {
                let inside = scene.frame.is_in_box(through.origin);
                boundary.gather(pixel.met, &through, &ray, scene.frame.numbers.step, inside);
                let way = plts::Way {
                    scene,
                    ray: &ray,
                    boundary,
                    integration: self.view.sampling.plts.integration,
                };
                way.cast(layers, &mut sum, tally);
            }
            Strategy::Libc => {
                libc::gather(pixel.met, &through, entries);
                let way = Way {
                    scene,
                    ray: &ray,
                    entries,
                    settings: self.view.sampling.libc,
                    // Where layers cross, cells may overlap anywhere: every entry counts.
                    margin: match scene.grid.compact.facts.layers_cross {
                        true => f32::MAX,
                        false => self.view.fault_gap() as f32,
                    },
                };
                libc::cast(&way, layers, &mut sum, tally);
            }
            Strategy::Srg => {
                let span = srg::span(pixel.met, &through, &ray, scene.frame.numbers.step);
                if let (Some(volume), Some(span)) = (&self.srg, span) {
                    tally.entries += 1;
                    let way = srg::Way {
                        scene,
                        volume,
                        pixel: pixel.at,
                        ray: &ray,
                        span,
                    };
                    srg::cast(&way, layers, &mut sum, tally);
                }
            }
        }
        layers.blend_rest(scene, &mut sum);
        tally.cube_samples += layers.cube_samples;
        sum.pixel()
    }
}

/// A pixel and the faces that its ray meets.
struct Pixel<'a> {
    at: [u32; 2],
    /// Of the boundary.
    met: &'a [Met],
    /// Of hull and faults.
    surfaces: [&'a [Met]; 2],
    /// Of wells.
    tube: Option<TubePoint>,
}

impl Pixel<'_> {
    /// True where its ray meets nothing; no cell either, for it would leave that through its boundary.
    fn is_empty(&self) -> bool {
        self.met.is_empty() && self.surfaces.iter().all(|met| met.is_empty()) && self.tube.is_none()
    }
}
