//! What rays cost, counted by each thread for itself.

use std::ops::AddAssign;

use crate::render::FrameStats;

/// Counts of [`FrameStats`], which describes them.
#[derive(Debug, Clone, Copy, Default)]
pub struct Tally {
    /// Lattice samples inside drawn cells.
    pub samples: u64,
    /// Newton iterations.
    pub iterations: u64,
    /// Steps from a cell to its neighbor.
    pub steps: u64,
    /// Point locations through the acceleration grid.
    pub locations: u64,
    /// Points of opaque sections that were located.
    pub sections: u64,
    /// Times that rays came into the model.
    pub entries: u64,
    /// Cells that rays passed through.
    pub crossings: u64,
    /// Samples found in no cell that lie in one.
    pub lost_samples: u64,
    /// Entries of the ray that has most of them.
    pub peels: u64,
    /// Rays set right by point location.
    pub recovered: u64,
    /// Rays that could not be set right.
    pub lost_rays: u64,
    /// Rays that have reached their end.
    pub rays: u64,
    /// Steps of rays through a volume that met no sample.
    pub skips: u64,
    /// Surface points that got their colors.
    pub painted: u64,
    /// Samples of a cube beside the model.
    pub cube_samples: u64,
}

impl AddAssign for Tally {
    fn add_assign(&mut self, other: Self) {
        self.samples += other.samples;
        self.iterations += other.iterations;
        self.steps += other.steps;
        self.locations += other.locations;
        self.sections += other.sections;
        self.entries += other.entries;
        self.crossings += other.crossings;
        self.lost_samples += other.lost_samples;
        self.peels = self.peels.max(other.peels);
        self.recovered += other.recovered;
        self.lost_rays += other.lost_rays;
        self.rays += other.rays;
        self.skips += other.skips;
        self.painted += other.painted;
        self.cube_samples += other.cube_samples;
    }
}

impl Tally {
    /// The statistics of a frame, times and bytes apart.
    pub fn stats(&self) -> FrameStats {
        FrameStats {
            samples: self.samples,
            newton_iterations: self.iterations,
            topological_steps: self.steps,
            grid_fallbacks: self.locations,
            entries: self.entries,
            point_locations: self.locations + self.sections,
            cell_crossings: self.crossings,
            lost_samples: self.lost_samples,
            finished_rays: self.rays,
            peels: self.peels,
            recovered_rays: self.recovered,
            lost_rays: self.lost_rays,
            cube_samples: self.cube_samples,
            work: self.samples
                + self.iterations
                + self.steps
                + self.skips
                + self.painted
                + self.cube_samples,
            ..FrameStats::default()
        }
    }
}
