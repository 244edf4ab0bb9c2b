//! What each thing on a ray adds to the color of its pixel.

use std::collections::HashMap;

use glam::DVec3;

use super::Part;
use crate::image::Blending;
use crate::model::{FaceHit, Ijk};
use crate::view::View;

/// A sample of the volume, or a point of a surface: what a ray passes in one step.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    /// Distance along the ray.
    pub at: f64,
    /// Half the length that a sample stands for; none of a point.
    pub reach: f64,
    /// 0..1.
    pub opacity: f64,
    /// In sRGB, 0..1, without any light.
    pub color: [f64; 3],
    pub of: PieceSource,
}

/// What a piece belongs to.
#[derive(Debug, Clone)]
pub(super) enum PieceSource {
    /// A drawn cell: what of it, and its value there in the scale of the view.
    Cell { ijk: Ijk, value: f64, part: Part },
    /// A fault's sheet between the cells.
    Sheet(FaceHit),
    /// An inactive cell, which has no value.
    Ghost,
    /// A well, by its number in the view.
    Well(usize),
    /// A volume beside the model, with its value there.
    Cube(f64),
}

/// What a ray has passed, and the color of its pixel without light and background.
pub(super) struct Gathered {
    /// Nearest first, each with how much of the pixel it is, 0..1.
    pub pieces: Vec<(Piece, f64)>,
    /// Of all of them, 0..1.
    pub opacity: f64,
    /// Sum of the blended colors, each times what it contributes.
    color: DVec3,
    blending: Blending,
}

/// A cell that a ray meets.
#[derive(Debug, Clone, Copy)]
pub(super) struct Passed {
    pub ijk: Ijk,
    /// Distances at which it begins and ends; with what is between, where the ray meets it more than once.
    pub from: f64,
    pub to: f64,
    /// Of the pixel, 0..1.
    pub contribution: f64,
}

impl Gathered {
    /// Goes along the pieces of a ray, nearest first. Behind a transmittance of less than that at which rays end
    /// nothing contributes, as in the picture.
    pub fn of(pieces: Vec<Piece>, view: &View) -> Self {
        let mut transmittance = 1.0;
        let mut color = DVec3::ZERO;
        let weigh = |piece: Piece| {
            let is_open = transmittance > 0.0 && transmittance >= view.sampling.early_termination;
            let contribution = match is_open {
                true => transmittance * piece.opacity,
                false => 0.0,
            };
            transmittance -= contribution;
            color += contribution * DVec3::from_array(view.style.blending.of_srgb(piece.color));
            (piece, contribution)
        };
        Self {
            pieces: pieces.into_iter().map(weigh).collect(),
            opacity: 1.0 - transmittance,
            color,
            blending: view.style.blending,
        }
    }

    /// The pixel's color in sRGB, as if what contributes to it were opaque.
    pub fn color(&self) -> [f64; 3] {
        let color = self.color / self.opacity.max(f64::MIN_POSITIVE);
        self.blending.to_srgb(color.to_array())
    }

    /// The cells, each once, in the order in which the ray meets them.
    pub fn cells(&self) -> Vec<Passed> {
        let mut cells: Vec<Passed> = Vec::new();
        let mut places: HashMap<Ijk, usize> = HashMap::new();
        for (piece, contribution) in &self.pieces {
            let (ijk, contribution) = match &piece.of {
                PieceSource::Cell { ijk, .. } => (*ijk, *contribution),
                // It has its own color, but lies on a face of that cell.
                PieceSource::Sheet(hit) => (hit.cell, 0.0),
                PieceSource::Ghost | PieceSource::Well(_) | PieceSource::Cube(_) => continue,
            };
            let place = *places.entry(ijk).or_insert(cells.len());
            match cells.get_mut(place) {
                Some(cell) => {
                    cell.to = piece.at + piece.reach;
                    cell.contribution += contribution;
                }
                None => cells.push(Passed {
                    ijk,
                    from: piece.at - piece.reach,
                    to: piece.at + piece.reach,
                    contribution,
                }),
            }
        }
        cells
    }
}
