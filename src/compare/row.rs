//! The figures of one contender and view.

use std::time::Duration;

use serde::Serialize;

use super::{Contender, Plan};
use crate::image::metrics::Comparison;
use crate::render::Frame;

/// Figures of a contender's picture of a view; those that could not be had are absent, `null` in JSON.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Row {
    /// The strategy's name.
    pub strategy: &'static str,
    /// What tells it from other rows by the same strategy: a light method, or a key of the scene and its value; absent
    /// where strategies are compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub setting: Option<String>,
    /// Number of the view, from 0.
    pub view: usize,
    /// Name of the view.
    pub view_name: String,
    /// What the picture was measured against: `cpu`, or the name of a row or of rays.
    pub reference: String,
    /// It is what it is measured against with other random numbers: how far the two are apart is chance.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub is_floor: bool,
    /// See [`Comparison::psnr_db`]: infinite where the pictures are equal, `null` in JSON.
    pub psnr_db: Option<f64>,
    /// See [`Comparison::ssim`].
    pub ssim: Option<f64>,
    /// See [`Comparison::ciede2000_mean`].
    pub ciede2000_mean: Option<f64>,
    /// See [`Comparison::ciede2000_p99`].
    pub ciede2000_p99: Option<f64>,
    /// How much brighter the picture is than its reference on average where the model is, of 255.
    pub brighter: Option<f64>,
    /// Time of the rays, of the median frame.
    pub frame_ms: Option<f64>,
    /// What the strategy's first preparation took: shaders and what it keeps beside the grid.
    pub prepare_ms: Option<f64>,
    /// Of it, what extinction and light volumes took; absent without light.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub light_ms: Option<f64>,
    /// Bytes on the device for all purposes together.
    pub gpu_bytes: Option<u64>,
    /// See [`crate::render::FrameStats::recovered_rays`].
    pub recovered_rays: Option<u64>,
    /// See [`crate::render::FrameStats::lost_rays`].
    pub lost_rays: Option<u64>,
    /// File of the picture.
    pub picture: Option<String>,
    /// File of the difference map.
    pub difference: Option<String>,
    /// Why figures are absent.
    pub error: Option<String>,
}

impl Row {
    /// A row without figures.
    pub(super) fn of(plan: &Plan, contender: &Contender, view: usize) -> Self {
        Self {
            strategy: contender.strategy().name(),
            setting: contender.setting.clone(),
            view,
            view_name: plan.views[view].clone(),
            reference: plan.truths[contender.truth].name.clone(),
            is_floor: contender.is_floor,
            ..Self::default()
        }
    }

    /// What tells it from other rows of a view.
    pub fn name(&self) -> &str {
        self.setting.as_deref().unwrap_or(self.strategy)
    }

    pub(super) fn quality(&mut self, found: &Comparison) {
        self.psnr_db = Some(found.psnr_db);
        self.ssim = Some(found.ssim);
        self.ciede2000_mean = Some(found.ciede2000_mean);
        self.ciede2000_p99 = Some(found.ciede2000_p99);
    }

    pub(super) fn cost(&mut self, frame: &Frame) {
        self.frame_ms = Some(ms(frame.stats.frame));
        self.gpu_bytes = Some(frame.bytes.total());
        self.recovered_rays = Some(frame.stats.recovered_rays);
        self.lost_rays = Some(frame.stats.lost_rays);
    }

    /// Number and name of the view.
    pub(super) fn view_title(&self) -> String {
        format!("{} ({})", self.view, self.view_name)
    }

    /// True where this is the reference itself.
    pub fn is_reference(&self) -> bool {
        self.name() == self.reference
    }
}

pub(super) fn ms(duration: Duration) -> f64 {
    1e3 * duration.as_secs_f64()
}
