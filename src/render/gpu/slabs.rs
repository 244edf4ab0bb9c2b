//! Work on volumes in parts, each short enough for a slow adapter.

use super::device::Gpu;
use super::tiles::Pace;
use crate::render::RenderError;
use crate::render::job::Progress;
use crate::render::plan::layout::Slab;

/// Makes volumes and pyramids in parts, each short enough for a slow adapter.
pub struct Slabs<'a> {
    /// The device.
    pub gpu: &'a Gpu,
    /// What the adapter does in the time of a submission.
    pub pace: &'a mut Pace,
    /// Told the fraction done.
    pub progress: &'a Progress,
}

impl<'a> Slabs<'a> {
    /// Work at a pace that it goes on learning.
    pub fn new(gpu: &'a Gpu, pace: &'a mut Pace, progress: &'a Progress) -> Self {
        Self {
            gpu,
            pace,
            progress,
        }
    }

    /// Submits `record` for slabs that cover `size`.
    ///
    /// A slab has whole rows, at most `deepest` slices, and at most `most_rows` rows; each element of it
    /// costs about `work` loop iterations.
    ///
    /// # Errors
    /// When the device reports an error.
    pub async fn cover(
        &mut self,
        size: [u32; 3],
        [most_rows, deepest]: [u32; 2],
        work: u64,
        record: &dyn Fn(&mut wgpu::CommandEncoder, &Slab),
    ) -> Result<(), RenderError> {
        for z in (0..size[2]).step_by(deepest as usize) {
            let depth = deepest.min(size[2] - z);
            let row_work = work * u64::from(size[0]) * u64::from(depth);
            let mut y = 0;
            while y < size[1] {
                let most = u64::from(most_rows.min(size[1] - y));
                let rows = self.pace.pieces(row_work).clamp(1, most);
                let slab = Slab {
                    first: [0, y, z],
                    row: size[0],
                    size: [size[0], rows as u32, depth],
                    level: 0,
                };
                self.submit(&slab, rows * row_work, record)?;
                y += rows as u32;
                let slices = f64::from(z) + f64::from(depth) * f64::from(y) / f64::from(size[1]);
                self.progress.reached(slices / f64::from(size[2])).await;
            }
        }
        Ok(())
    }

    fn submit(
        &mut self,
        slab: &Slab,
        work: u64,
        record: &dyn Fn(&mut wgpu::CommandEncoder, &Slab),
    ) -> Result<(), RenderError> {
        let start = std::time::Instant::now();
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        record(&mut encoder, slab);
        self.gpu.queue.submit([encoder.finish()]);
        self.gpu.wait()?;
        self.pace.learn(start.elapsed(), work);
        Ok(())
    }
}
