//! What cells weigh where values are summed up, and how far one looks through them.

use std::sync::Arc;

use glam::{DVec3, DVec4};
use rayon::prelude::*;

use super::pores::Pores;
use super::{Case, Kind};
use crate::model::Column;
use crate::model::derived::Derived;

/// The array of pore volumes.
const PORE_VOLUME: &str = "PORV";

/// A volume, 0 where unknown.
fn kept(volume: f32) -> f32 {
    if volume.is_finite() && volume > 0.0 {
        volume
    } else {
        0.0
    }
}

/// What cells are weighted by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weighting {
    /// PORV of the file.
    PoreVolume,
    /// Bulk volume times porosity, and times net-to-gross where the case has it.
    PorosityVolume,
    /// Bulk volume, where nothing is known of the pores.
    BulkVolume,
}

/// A weight for each active cell.
#[derive(Debug, Clone)]
pub struct Weights {
    /// What they are.
    pub weighting: Weighting,
    /// By active index; never negative, 0 where unknown.
    pub values: Arc<Vec<f32>>,
}

/// Extents of an active cell in grid space.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Extent {
    /// The shorter of its mean edges along i and j.
    pub lateral: f32,
    /// Its thickness, without vertical exaggeration.
    pub vertical: f32,
}

impl Case {
    /// The pore volume of each active cell, or what stands in for it. Found at the first call.
    pub fn weights(&self) -> Weights {
        self.over_steps.weights(|| self.found_weights())
    }

    /// The weights for the values of a property: with dual porosity those of the fractures, or of matrix and fractures.
    pub fn weights_of(&self, property: &str) -> Weights {
        let (_, pores) = Pores::of(property);
        let volumes = |pores: Pores| self.field(&pores.name(PORE_VOLUME), 0).ok();
        let matrix = || self.weights();
        if pores == Pores::Matrix {
            return matrix();
        }
        let Some(fractures) = volumes(Pores::Fracture) else {
            return matrix();
        };
        let mut values: Vec<f32> = fractures.values().iter().map(|v| kept(*v)).collect();
        if pores == Pores::Total {
            let matrix = matrix().values;
            let both = values.iter_mut().zip(&*matrix);
            both.for_each(|(value, of_matrix)| *value += of_matrix);
        }
        Weights {
            weighting: Weighting::PoreVolume,
            values: Arc::new(values),
        }
    }

    fn found_weights(&self) -> Weights {
        let field = |name: &str| {
            let known = self
                .properties
                .iter()
                .any(|p| p.name == name && p.kind != Kind::Dynamic);
            let field = known.then(|| self.field(name, 0).ok()).flatten()?;
            field.values().iter().any(|v| *v > 0.0).then_some(field)
        };
        if let Some(porv) = field(PORE_VOLUME) {
            let mut values: Vec<f32> = porv.values().par_iter().map(|v| kept(*v)).collect();
            self.grid.share_out(&mut values);
            return Weights {
                weighting: Weighting::PoreVolume,
                values: Arc::new(values),
            };
        }
        let bulk = Derived::Volume.field(self.grid.in_map_space());
        let mut values: Vec<f32> = bulk.values().iter().map(|v| kept(*v)).collect();
        let mut weighting = Weighting::BulkVolume;
        if let Some(porosity) = field("PORO") {
            weighting = Weighting::PorosityVolume;
            for field in [Some(porosity), field("NTG")].into_iter().flatten() {
                for (value, factor) in values.iter_mut().zip(field.values()) {
                    *value *= kept(*factor);
                }
            }
        }
        Weights {
            weighting,
            values: Arc::new(values),
        }
    }

    /// The extents of each active cell. Found at the first call.
    pub fn extents(&self) -> Arc<Vec<Extent>> {
        self.over_steps.extents(self.grid.space(), || {
            let extent = |column: &Column<'_>, k: usize| {
                let edges = column.hexahedron(k).mean_edges();
                Extent {
                    lateral: edges.x.min(edges.y) as f32,
                    vertical: column.thickness(k) as f32,
                }
            };
            Arc::new(self.grid.map_active(extent))
        })
    }

    /// Mean edge lengths along i, j and k of the cells with a thickness, in world space. Found at the first call for
    /// an exaggeration.
    pub fn mean_edges(&self, exaggeration: f64) -> DVec3 {
        let space = self.grid.space();
        self.over_steps.mean_edges(space, exaggeration, || {
            let edges_and_one = |column: &Column<'_>, k: usize| {
                if !column.has_thickness(k) {
                    return DVec4::ZERO;
                }
                let mut hexahedron = column.hexahedron(k);
                for corner in &mut hexahedron.0 {
                    corner.z *= exaggeration;
                }
                hexahedron.mean_edges().extend(1.0)
            };
            let sum = self.grid.sum_active(edges_and_one);
            (sum.truncate() / sum.w.max(1.0)).max(DVec3::splat(1e-6))
        })
    }

    /// The thinnest extent of the whole model in world space, of its active cells alone: mean thickness of its
    /// columns, or cells along i or j times their mean edge.
    pub fn thinnest_extent(&self, exaggeration: f64) -> f64 {
        let dims = self.grid.main_dims();
        let extents = self.extents();
        let sum =
            |of: &dyn Fn(&Extent) -> f32| extents.iter().map(|e| f64::from(of(e))).sum::<f64>();
        let has_cells = |column: &Column<'_>| column.active().next().is_some();
        let columns = self.grid.columns().filter(has_cells).count();
        let vertical = exaggeration * sum(&|e| e.vertical) / columns.max(1) as f64;
        let lateral = sum(&|e| e.lateral) / extents.len().max(1) as f64;
        vertical.min(lateral * dims.ni.min(dims.nj) as f64)
    }
}
