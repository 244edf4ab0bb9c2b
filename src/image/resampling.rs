//! Images in another size: fewer pixels from many rays, or many pixels from a draft.

use rayon::prelude::*;

use super::Image;

/// How values between pixels follow from those of the pixels around.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kernel {
    /// The mean over a pixel where the image shrinks; the nearest pixel where it grows.
    Mean,
    /// Linear between neighbors; the mean under a tent where the image shrinks.
    Bilinear,
    /// The interpolating cubic of Catmull and Rom.
    CatmullRom,
    /// Cardinal cubic O-MOMS (Blu, Thevenaz and Unser): the cubic of least error among those of four pixels' width. What
    /// it is laid over is filtered once by the inverse of its samples, so that it interpolates.
    OMoms,
}

/// Pole of the recursive filter that makes O-MOMS interpolate: (sqrt(105) - 13) / 8.
const POLE: f64 = -0.344_131_154_255_05;

/// Terms of the filter's sum that count: the pole to the power of so many is below the precision of f32.
const TERMS: usize = 16;

/// Rounding of places, in pixels.
const SLACK: f64 = 1e-9;

impl Kernel {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Mean, Self::Bilinear, Self::CatmullRom, Self::OMoms];

    /// What it is called.
    pub fn name(self) -> &'static str {
        ["mean", "bilinear", "Catmull-Rom", "O-MOMS"][self as usize]
    }

    /// Half its width in pixels.
    fn radius(self) -> f64 {
        match self {
            Self::Mean => 0.5,
            Self::Bilinear => 1.0,
            Self::CatmullRom | Self::OMoms => 2.0,
        }
    }

    /// Its value at a distance in pixels.
    fn at(self, distance: f64) -> f64 {
        let x = distance.abs();
        match (self, x) {
            // What lies on the border of two pixels counts for both.
            (Self::Mean, _) => f64::from(u8::from(x < 0.5 + SLACK)),
            (Self::Bilinear, _) => (1.0 - x).max(0.0),
            (_, 2.0..) => 0.0,
            (Self::CatmullRom, ..1.0) => (1.5 * x - 2.5) * x * x + 1.0,
            (Self::CatmullRom, _) => ((2.5 - 0.5 * x) * x - 4.0) * x + 2.0,
            (Self::OMoms, ..1.0) => ((0.5 * x - 1.0) * x + 1.0 / 14.0) * x + 13.0 / 21.0,
            (Self::OMoms, _) => ((1.0 - x / 6.0) * x - 85.0 / 42.0) * x + 29.0 / 21.0,
        }
    }
}

/// How the pixels of a final image are made of several rays each: it adds no halos to edges, and is nearest to many rays
/// (docs/methods.md has the figures).
pub const REDUCTION: Kernel = Kernel::Mean;

/// The image of rays in the size of the final image.
pub fn reduced(rays: Image, size: [u32; 2]) -> Image {
    match rays.size == size {
        true => rays,
        false => resampled(&rays, size, REDUCTION),
    }
}

/// The image in another size, of the same extent: a smaller one holds means over its pixels, a larger one what lies
/// between. Mixed are the numbers in which the image was blended.
///
/// A size without pixels, of either, gives an image without pixels.
pub fn resampled(image: &Image, size: [u32; 2], kernel: Kernel) -> Image {
    let [width, height] = image.size.map(|n| n as usize);
    let [new_width, new_height] = size.map(|n| n as usize);
    let mut made = Image {
        size,
        blending: image.blending,
        pixels: vec![[0.0; 4]; new_width * new_height],
    };
    if made.pixels.is_empty() || image.pixels.len() != width * height || width * height == 0 {
        return made;
    }
    let across = Axis::new(width, new_width, kernel);
    let down = Axis::new(height, new_height, kernel);
    let mut narrow = vec![[0.0; 4]; new_width * height];
    let rows = image.pixels.par_chunks(width);
    rows.zip(narrow.par_chunks_mut(new_width))
        .for_each(|(from, to)| across.line(from, to));
    // Columns side by side, as lines of rows.
    let mut source = narrow;
    if down.sharpens_source() {
        sharpen_rows(&mut source, new_width);
    }
    let target = made.pixels.par_chunks_mut(new_width);
    target.zip(&down.weights).for_each(|(to, weights)| {
        for (row, weight) in weights.places() {
            add(to, &source[row * new_width..][..new_width], weight);
        }
    });
    if down.sharpens_target() {
        sharpen_rows(&mut made.pixels, new_width);
    }
    made.pixels.par_iter_mut().for_each(displayable);
    made
}

/// A kernel with negative parts goes beyond what it interpolates.
fn displayable(pixel: &mut [f32; 4]) {
    pixel[3] = pixel[3].clamp(0.0, 1.0);
    for channel in 0..3 {
        pixel[channel] = pixel[channel].clamp(0.0, pixel[3]);
    }
}

/// How lines of one length become lines of another.
struct Axis {
    kernel: Kernel,
    shrinks: bool,
    /// For each new pixel.
    weights: Vec<Weights>,
}

/// What a new pixel takes of those along a line.
struct Weights {
    /// The first one; may lie before the line.
    first: isize,
    weights: Vec<f32>,
    length: usize,
}

impl Weights {
    /// Places along the line and their weights. Beyond its ends the line is mirrored.
    fn places(&self) -> impl Iterator<Item = (usize, f32)> {
        let places = (self.first..).map(|place| mirrored(place, self.length));
        places.zip(self.weights.iter().copied())
    }
}

/// A place of a line that goes back and forth beyond its ends, its last pixels once each.
fn mirrored(place: isize, length: usize) -> usize {
    let period = (2 * length).saturating_sub(2).max(1);
    let place = place.rem_euclid(period as isize) as usize;
    place.min(period - place).min(length - 1)
}

impl Axis {
    fn new(length: usize, new_length: usize, kernel: Kernel) -> Self {
        let pitch = length as f64 / new_length as f64;
        let widened = pitch.max(1.0);
        let weights = (0..new_length).map(|n| {
            let center = (n as f64 + 0.5) * pitch - 0.5;
            let radius = kernel.radius() * widened;
            let [first, last] = [
                (center - radius - SLACK).ceil(),
                (center + radius + SLACK).floor(),
            ];
            let places = first as isize..=last as isize;
            let values: Vec<f64> = places
                .map(|place| kernel.at((place as f64 - center) / widened))
                .collect();
            let sum: f64 = values.iter().sum();
            Weights {
                first: first as isize,
                weights: values.iter().map(|v| (v / sum) as f32).collect(),
                length,
            }
        });
        Self {
            kernel,
            shrinks: pitch > 1.0,
            weights: weights.collect(),
        }
    }

    fn sharpens_source(&self) -> bool {
        self.kernel == Kernel::OMoms && !self.shrinks
    }

    fn sharpens_target(&self) -> bool {
        self.kernel == Kernel::OMoms && self.shrinks
    }

    fn line(&self, from: &[[f32; 4]], to: &mut [[f32; 4]]) {
        let mut source = std::borrow::Cow::Borrowed(from);
        if self.sharpens_source() {
            sharpen_rows(source.to_mut(), 1);
        }
        for (pixel, weights) in to.iter_mut().zip(&self.weights) {
            for (place, weight) in weights.places() {
                add(std::slice::from_mut(pixel), &source[place..=place], weight);
            }
        }
        if self.sharpens_target() {
            sharpen_rows(to, 1);
        }
    }
}

fn add(to: &mut [[f32; 4]], from: &[[f32; 4]], weight: f32) {
    let pairs = to.as_flattened_mut().iter_mut().zip(from.as_flattened());
    pairs.for_each(|(to, from)| *to += weight * from);
}

/// The inverse, from row to row, of what the kernel has at whole pixels (4/21, 13/21, 4/21): a recursive filter forth and
/// one back over a line that is mirrored at its ends. A line of single pixels has rows of one.
fn sharpen_rows(pixels: &mut [[f32; 4]], width: usize) {
    let rows = pixels.len() / width;
    if rows < 2 {
        return;
    }
    let pole = POLE as f32;
    let gain = ((1.0 - POLE) * (1.0 - POLE)) as f32;
    let mut first = vec![[0.0; 4]; width];
    let mut power = 1.0;
    for n in 0..TERMS as isize {
        let row = mirrored(n, rows);
        add(&mut first, &pixels[row * width..][..width], power);
        power *= pole;
    }
    pixels[..width].copy_from_slice(&first);
    for row in 1..rows {
        let (before, from) = pixels.split_at_mut(row * width);
        add(&mut from[..width], &before[(row - 1) * width..], pole);
    }
    let (before, last) = pixels.split_at_mut((rows - 1) * width);
    add(last, &before[(rows - 2) * width..], pole);
    scale(last, 1.0 / (1.0 - pole * pole));
    for row in (0..rows - 1).rev() {
        let (to, after) = pixels.split_at_mut((row + 1) * width);
        add(&mut to[row * width..], &after[..width], pole);
    }
    scale(pixels, gain);
}

fn scale(pixels: &mut [[f32; 4]], factor: f32) {
    let numbers = pixels.as_flattened_mut().iter_mut();
    numbers.for_each(|number| *number *= factor);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Blending;

    /// An image whose alpha is a function of the place, 0 to 1 each way, and whose colors are half of that.
    fn image(size: [u32; 2], value: impl Fn(f64, f64) -> f64) -> Image {
        let [width, height] = size.map(|n| n as usize);
        let pixel = |n: usize| {
            let place = |n: usize, length: usize| (n as f64 + 0.5) / length as f64;
            let v = value(place(n % width, width), place(n / width, height)) as f32;
            [0.5 * v, 0.5 * v, 0.5 * v, v]
        };
        Image {
            size,
            blending: Blending::Display,
            pixels: (0..width * height).map(pixel).collect(),
        }
    }

    /// Largest difference away from the border.
    fn difference(a: &Image, b: &Image, border: usize) -> f32 {
        let [width, height] = a.size.map(|n| n as usize);
        let inside = |n: &usize| {
            let (x, y) = (n % width, n / width);
            (border..width - border).contains(&x) && (border..height - border).contains(&y)
        };
        let places = (0..width * height).filter(inside);
        let differences = places.map(|n| (a.pixels[n][3] - b.pixels[n][3]).abs());
        differences.fold(0.0, f32::max)
    }

    /// The response of a line of pixels of which one is 1, at a place.
    fn cardinal(place: f64) -> f64 {
        const MIDDLE: usize = 20;
        let mut line = vec![[0.0; 4]; 2 * MIDDLE + 1];
        line[MIDDLE] = [1.0; 4];
        sharpen_rows(&mut line, 1);
        let part = |(n, c): (usize, &[f32; 4])| {
            f64::from(c[3]) * Kernel::OMoms.at(n as f64 - MIDDLE as f64 - place)
        };
        line.iter().enumerate().map(part).sum()
    }

    #[test]
    fn filtered_o_moms_interpolates() {
        assert!((POLE - (105.0_f64.sqrt() - 13.0) / 8.0).abs() < 1e-12);
        assert!((cardinal(0.0) - 1.0).abs() < 1e-6);
        for n in 1..8 {
            assert!(cardinal(f64::from(n)).abs() < 1e-6);
            assert!(cardinal(f64::from(-n)).abs() < 1e-6);
        }
        // Not so without the filter.
        assert!((Kernel::OMoms.at(0.0) - 13.0 / 21.0).abs() < 1e-12);
    }

    #[test]
    fn larger_images_lie_on_the_polynomials_that_a_kernel_reproduces() {
        let error = |kernel, value: &dyn Fn(f64, f64) -> f64| {
            let large = resampled(&image([60, 50], value), [151, 131], kernel);
            difference(&large, &image([151, 131], value), 50)
        };
        let exact = [
            (Kernel::Bilinear, 1),
            (Kernel::CatmullRom, 2),
            (Kernel::OMoms, 3),
        ];
        for (kernel, degree) in exact {
            let smooth = |x: f64, y: f64| 0.5 + 0.8 * (x - 0.5).powi(degree) + 0.05 * (y - 0.4);
            assert!(error(kernel, &smooth) < 2e-6, "{kernel:?}");
        }
        let waves = |x: f64, _: f64| 0.5 + 0.4 * (60.0 * x).sin();
        let errors = Kernel::ALL.map(|kernel| error(kernel, &waves));
        assert!(errors.windows(2).all(|e| e[0] > 3.0 * e[1]), "{errors:?}");
        assert!(errors[3] > 1e-4, "{errors:?}");
    }

    #[test]
    fn small_and_large_again_is_what_it_was_where_waves_are_long() {
        let waves =
            |x: f64, y: f64| 0.5 + 0.2 * (25.0 * x).sin() + 0.2 * (21.0 * y + 4.0 * x).cos();
        let before = image([96, 80], waves);
        let error = |kernel| {
            let small = resampled(&before, [48, 40], kernel);
            difference(&resampled(&small, [96, 80], kernel), &before, 16)
        };
        // 45 dB of a range of 1 is 5.6e-3.
        assert!(error(Kernel::OMoms) < 5e-3, "{}", error(Kernel::OMoms));
        assert!(
            error(Kernel::Bilinear) > 2e-2,
            "{}",
            error(Kernel::Bilinear)
        );
    }

    #[test]
    fn a_mean_is_that_of_the_pixels_covered() {
        let before = image([6, 4], |x, y| 0.3 + 0.5 * x * x + 0.1 * y);
        let small = resampled(&before, [2, 2], Kernel::Mean);
        for (n, pixel) in small.pixels.iter().enumerate() {
            let [x, y] = [3 * (n % 2), 2 * (n / 2)];
            let places = (0..6).map(|k| x + k % 3 + 6 * (y + k / 3));
            let mean = places.map(|at| before.pixels[at][3]).sum::<f32>() / 6.0;
            assert!((pixel[3] - mean).abs() < 1e-6);
        }
        let large = resampled(&before, [12, 8], Kernel::Mean);
        assert_eq!(large.pixels[4 + 12 * 3], before.pixels[2 + 6]);
    }

    #[test]
    fn an_even_image_stays_even_in_any_size() {
        let even = image([13, 7], |_, _| 0.75);
        for kernel in Kernel::ALL {
            for size in [[1, 1], [4, 3], [13, 7], [14, 20]] {
                let made = resampled(&even, size, kernel);
                assert!(
                    made.pixels.iter().all(|p| (p[3] - 0.75).abs() < 1e-5),
                    "{kernel:?} {size:?}"
                );
                assert_eq!(made.pixels.len(), (size[0] * size[1]) as usize);
            }
            let point = resampled(&image([1, 1], |_, _| 0.25), [3, 2], kernel);
            assert!(point.pixels.iter().all(|p| (p[3] - 0.25).abs() < 1e-6));
            assert!(resampled(&even, [0, 4], kernel).pixels.is_empty());
        }
    }

    #[test]
    fn colors_stay_within_their_opacity() {
        let edge = image([32, 32], |x, y| f64::from(u8::from(x + 0.3 * y > 0.6)));
        for size in [[16, 16], [80, 80]] {
            let made = resampled(&edge, size, Kernel::OMoms);
            let is_color = |p: &[f32; 4]| {
                (0.0..=1.0).contains(&p[3]) && p[..3].iter().all(|c| (0.0..=p[3]).contains(c))
            };
            assert!(made.pixels.iter().all(is_color));
        }
    }

    #[test]
    fn beyond_its_ends_a_line_is_mirrored() {
        let places: Vec<usize> = (-3..8).map(|n| mirrored(n, 4)).collect();
        assert_eq!(places, [3, 2, 1, 0, 1, 2, 3, 2, 1, 0, 1]);
        assert_eq!(mirrored(-5, 1), 0);
    }
}
