//! Where two pictures differ: colors for differences, alone or with title and scale.

use glam::DVec2;

use super::legend::Key;
use super::pen::Pen;
use super::ticks::label;
use crate::case::Measure;
use crate::image::{Rgb8, srgb_8bit};
use crate::transfer::{TransferFunction, presets};

/// CIEDE2000 differences as colors, from black for none to pale yellow for `scale` and more.
///
/// **Shape**: `differences[y * width + x]`.
pub fn difference_colors(differences: &[f64], size: [u32; 2], scale: f64) -> Rgb8 {
    let colors = colors(scale);
    let color = |&d: &f64| srgb_8bit(colors.srgb(colors.position(d)));
    let pixels = differences.iter().map(color).collect();
    Rgb8 { size, pixels }
}

/// The picture of [`difference_colors`] under a title and beside its scale, which also tells the
/// largest difference; it is larger than the pictures compared.
///
/// **Shape**: `differences[y * width + x]`.
pub fn difference_picture(differences: &[f64], size: [u32; 2], scale: f64, title: &str) -> Rgb8 {
    let unit = Pen::unit_of(size);
    let units = |n: f64| (n * unit).round() as u32;
    // Room for title and scale, also beside tiny pictures.
    let beside = size[0].max(units(12.0)) + units(2.0);
    let framed = [beside + units(10.0), size[1].max(units(10.0)) + units(3.8)];
    let white = [1.0; 3];
    let mut picture = Rgb8::filled(framed, srgb_8bit(white));
    let map = difference_colors(differences, size, scale);
    picture.paste(&map, [units(1.0), units(2.8)]);
    let mut pen = Pen::new(picture.canvas(), white, unit);
    pen.title(title);
    let largest = differences.iter().copied().fold(0.0, f64::max);
    let beyond = largest > scale;
    let largest = format!("largest {}", label(largest, largest, 0.01 * largest));
    let low = DVec2::new(f64::from(beside), 2.2 * unit);
    let high = DVec2::from_array(framed.map(f64::from));
    let legend = Key {
        transfer: &colors(scale),
        beyond: [false, beyond],
        heading: ["CIEDE2000", &largest],
        measure: &Measure::default(),
        has_opacity: false,
        unit,
        width: &|text| pen.canvas.text_width(text, unit),
    }
    .laid_out([low, high], false);
    pen.legend(&legend);
    picture
}

fn colors(scale: f64) -> TransferFunction {
    TransferFunction {
        color: presets::inferno(),
        opacity: vec![(0.0, 0.0)],
        range: [0.0, scale],
        scale: crate::transfer::Scale::Linear,
        bands: None,
        reference_length: 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn difference_colors_end_at_the_scale() {
        let differences = [0.0, 2.5, 5.0, 60.0];
        let found = difference_colors(&differences, [2, 2], 5.0);
        assert_eq!(found.size, [2, 2]);
        // First and last row of the published table.
        let (low, high) = ([0, 0, 4], [252, 255, 164]);
        assert_eq!(
            [found.pixels[0], found.pixels[2], found.pixels[3]],
            [low, high, high]
        );
        assert!(found.pixels[1] != low && found.pixels[1] != high);
        // A larger scale darkens.
        let darker = difference_colors(&differences, [2, 2], 10.0);
        assert_eq!(darker.pixels[2], found.pixels[1]);
    }

    #[test]
    fn difference_picture_holds_the_whole_map() {
        let size = [300, 200];
        let ramp: Vec<f64> = (0..300 * 200).map(|n| f64::from(n % 300) / 30.0).collect();
        let picture = difference_picture(&ramp, size, 10.0, "plts against cpu");
        let map = difference_colors(&ramp, size, 10.0);
        let width = picture.size[0] as usize;
        assert_eq!(picture.pixels.len(), width * picture.size[1] as usize);
        // The map is untouched by title and scale, which stand above and beside it.
        for (y, row) in map.pixels.chunks(300).enumerate() {
            let start = (y + 31) * width + 11;
            assert_eq!(&picture.pixels[start..start + 300], row, "{y}");
        }
        let drawn = |x: usize, y: usize| picture.pixels[y * width + x] != [255; 3];
        assert!((0..31).any(|y| (0..311).any(|x| drawn(x, y))));
        assert!((0..200).any(|y| (311..width).any(|x| drawn(x, y))));
        let other = difference_picture(&ramp, size, 20.0, "plts against cpu");
        assert_ne!(picture, other);
    }

    #[test]
    fn ok_odd_maps_and_scales_are_drawn_without_panic() {
        for scale in [0.0, -1.0, 1e-300, 1e300, f64::INFINITY, f64::NAN] {
            for size in [[0, 0], [1, 1], [3, 500]] {
                let map = vec![f64::NAN; (size[0] * size[1]) as usize];
                difference_picture(&map, size, scale, "title \u{0} 漢字");
            }
        }
        // Fewer differences than pixels.
        difference_picture(&[1.0], [50, 50], 1.0, "");
    }
}
