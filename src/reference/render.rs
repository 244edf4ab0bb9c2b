//! A whole image, row by row on all cores.

use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use super::integrate::{Integrator, Ray};
use crate::image::Image;
use crate::image::resampling::reduced;
use crate::model::Grid;
use crate::view::View;

/// Renders a view in f64; `None` when `progress` asked to stop.
///
/// `progress` is called after each row, from any thread, with the fraction done, and returns
/// false to stop.
pub fn render(grid: &Grid, view: &View, progress: &(dyn Fn(f64) -> bool + Sync)) -> Option<Image> {
    let rays = view.of_rays();
    let integrator = Integrator::new(grid, &rays);
    let [width, height] = rays.size;
    let done = AtomicU32::new(0);
    let rows: Option<Vec<Vec<[f32; 4]>>> = (0..height)
        .into_par_iter()
        .map(|y| {
            let pixel = |x| integrator.ray(Ray::through_pixel(&rays, x, y));
            let row = (0..width).map(|x| pixel(x).map(|v| v as f32)).collect();
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            progress(f64::from(done) / f64::from(height)).then_some(row)
        })
        .collect();
    let image = Image {
        size: rays.size,
        blending: view.style.blending,
        pixels: rows?.concat(),
    };
    Some(reduced(image, view.size))
}
