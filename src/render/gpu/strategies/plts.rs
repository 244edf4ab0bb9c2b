//! PLTS, point location with topological search: the accurate strategy.
//!
//! Each sample is located exactly, by Newton's method on the trilinear map from the previous sample's
//! cell through shared faces (in closed form where all pillars are vertical), and behind the boundary faces
//! that the ray passes where the topology ends (campagnolo-2021, 4.1.3). Cost: about one Newton iteration
//! a sample inside a cell, a look at the faces in the bins on the way; a point location where that leaves doubt.

use std::sync::Arc;

use crate::render::gpu::faces::FaceList;
use crate::render::gpu::strategy::{Common, Preparation, RenderStrategy};
use crate::render::gpu::{Pipeline, Place, Round, flag};
use crate::render::job::Work;
use crate::render::plan::face_bins;
use crate::render::plan::layout::RAY_STATE;
use crate::render::{DeviceBytes, RenderError};
use crate::scene::Integration;

/// The strategy with its shader, compiled when it is first asked for, and the faces that rays come in by.
#[derive(Default)]
pub struct Plts {
    pipeline: Option<Arc<Pipeline>>,
    faces: Option<Faces>,
}

/// The boundary faces of the drawn cells in the bins of the acceleration grid.
struct Faces {
    /// Of the list that they are from.
    revision: u64,
    bins: wgpu::Buffer,
    /// There are too many of them for one buffer: all samples are searched.
    are_missing: bool,
}

impl Faces {
    fn new(what: &Preparation<'_>, list: &FaceList) -> Result<Self, RenderError> {
        let Preparation { gpu, grid, .. } = what;
        let bins = face_bins(what.model, &grid.sizes, grid.facts.origin, &list.listed);
        let are_missing = size_of_val(&bins[..]) as u64 > gpu.most_bytes();
        let held = if are_missing { &[] } else { &bins[..] };
        Ok(Self {
            revision: list.revision,
            bins: gpu.storage("faces in bins", held)?,
            are_missing,
        })
    }
}

impl RenderStrategy for Plts {
    fn ray_state_bytes(&self) -> u64 {
        16 * u64::from(RAY_STATE)
    }

    fn needs_faces(&self) -> bool {
        true
    }

    fn bytes(&self) -> DeviceBytes {
        DeviceBytes {
            acceleration: self.faces.as_ref().map_or(0, |f| f.bins.size()),
            ..DeviceBytes::default()
        }
    }

    fn prepare<'a>(&'a mut self, what: &'a Preparation<'a>) -> Work<'a, ()> {
        Box::pin(async move {
            let known = self.faces.take();
            self.faces = match (known, what.faces) {
                (Some(known), Some(list)) if known.revision == list.revision => Some(known),
                (_, Some(list)) => Some(Faces::new(what, list)?),
                _ => None,
            };
            let by_faces = self.faces.as_ref().is_some_and(|f| !f.are_missing);
            let common = Common::of(what);
            // Where layers cross, a point of several cells belongs to the first of them: each sample is located. Many rays
            // a sample are more than a segment can wait for.
            let by_segment = what.view.sampling.plts.integration == Integration::Segments
                && !what.grid.facts.layers_cross
                && !common.casts_rays();
            let own = [
                ("BY_FACES", flag(by_faces)),
                ("BY_SEGMENT", flag(by_segment)),
            ];
            let constants: Vec<_> = own.into_iter().chain(common.pairs()).collect();
            self.pipeline = Some(Pipeline::variant(what.gpu, "plts", "main", &constants)?);
            Ok(())
        })
    }

    fn encode(&mut self, round: &Round<'_>, encoder: &mut wgpu::CommandEncoder) {
        if let (Some(pipeline), Some(faces)) = (&self.pipeline, &self.faces) {
            let own = [faces.bins.as_entire_binding()];
            let own = round.gpu.bind(&pipeline.own, &own);
            round.compute(encoder, pipeline, Some(&own), round.size, Place::Only);
        }
    }
}
