//! The numbers in which colors are blended: as they are displayed, or in linear light.

use serde::{Deserialize, Serialize};

use crate::image::color::{linear_from_srgb, srgb_from_linear};

/// In which numbers colors are shaded, blended along a ray and laid over the background.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Blending {
    /// As they are displayed (sRGB), as ParaView and VTK do: half of a color over white is halfway to white on
    /// the screen.
    #[default]
    Display,
    /// As light adds up: half of a color over white is lighter than halfway.
    Linear,
}

impl Blending {
    /// A color (sRGB, 0..1) in the numbers that are blended.
    pub fn of_srgb(self, color: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Display => color,
            Self::Linear => color.map(linear_from_srgb),
        }
    }

    /// The color (sRGB, 0..1) that blended numbers stand for; beyond what is displayable they are clamped.
    pub fn to_srgb(self, blended: [f64; 3]) -> [f64; 3] {
        let clamped = blended.map(|v| v.clamp(0.0, 1.0));
        match self {
            Self::Display => clamped,
            Self::Linear => clamped.map(srgb_from_linear),
        }
    }

    /// The linear light that blended numbers stand for.
    pub fn to_linear(self, blended: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Display => blended.map(linear_from_srgb),
            Self::Linear => blended,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_come_back_from_the_numbers_that_are_blended() {
        let color = [0.02, 0.5, 0.93];
        for blending in [Blending::Display, Blending::Linear] {
            let blended = blending.of_srgb(color);
            let linear = blending.to_linear(blended);
            for c in 0..3 {
                assert!((blending.to_srgb(blended)[c] - color[c]).abs() < 1e-12);
                assert!((linear[c] - linear_from_srgb(color[c])).abs() < 1e-12);
            }
        }
        assert_ne!(
            Blending::Display.of_srgb(color),
            Blending::Linear.of_srgb(color)
        );
        let clamped = Blending::Linear.to_srgb([-0.5, 7.0, 1.0]);
        assert!(
            clamped
                .iter()
                .zip([0.0, 1.0, 1.0])
                .all(|(a, b)| (a - b).abs() < 1e-12)
        );
    }
}
