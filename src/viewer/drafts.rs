//! What is shown of a side, and which picture of it is due next: a draft of a size that is made in time, or
//! the final one.

use std::sync::{Arc, Weak};

use eframe::egui::{ColorImage, Context, TextureHandle, TextureOptions};

use super::budget::{COARSEST, DraftBudget, DraftSize, Spent};
use super::job::{Picture, RenderRequest};
use crate::case::Case;
use crate::image::Rgb8;
use crate::scene::lighting::OcclusionSpec;
use crate::scene::{LightingSpec, Scene, StrategyKind};
use crate::view::Lighting;

/// Rays of a draft by LIBC that take longer, however few its pixels are, are bound by the faces it draws.
const TOO_SLOW_MS: f64 = 150.0;
/// Active cells from where that is taken for granted on a software adapter.
const MANY_CELLS: usize = 200_000;
/// Voxels of the light volume of a draft before it is known how many the scene has.
const FIRST_LIGHT: [u32; 3] = [24, 24, 24];

/// What is shown of a side, and what its pictures have cost.
#[derive(Default)]
pub struct ShownSide {
    /// Of what the draft, and the final picture, are shown.
    drafted: Option<RenderRequest>,
    finished: Option<RenderRequest>,
    /// The picture that is shown.
    pub shown: Option<ShownImage>,
    /// What cannot be shown.
    refused: Option<RenderRequest>,
    /// Costs of the pictures of this case.
    budget: DraftBudget,
    budget_of: Weak<Case>,
    /// Voxels of the light volume of a final picture along each axis.
    light_size: Option<[u32; 3]>,
}

/// A picture and the texture that has it.
pub struct ShownImage {
    /// The picture.
    pub picture: Picture,
    /// Its texture.
    pub texture: TextureHandle,
}

/// What a side needs next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Due {
    /// Nothing.
    Nothing,
    /// A picture that takes no longer than a draft may, smaller than the whole one or as it is.
    Quick(Option<DraftSize>),
    /// The final picture.
    Slow,
}

impl ShownSide {
    /// The picture that is due, where a draft may take `goal_ms`.
    pub fn due(&self, wanted: &RenderRequest, goal_ms: f64, is_software: bool) -> Due {
        let is = |known: &Option<RenderRequest>| known.as_ref() == Some(wanted);
        if is(&self.finished) || is(&self.refused) {
            return Due::Nothing;
        }
        let fresh = DraftBudget::default();
        let is_known = std::ptr::eq(self.budget_of.as_ptr(), Arc::as_ptr(&wanted.case));
        let budget = if is_known { &self.budget } else { &fresh };
        let [width, height] = wanted.scene.size.map(f64::from);
        let pixels = width * height;
        let voxels = match self.has_light(wanted) {
            true => 0.0,
            false => self.voxels(&wanted.scene),
        };
        let asked = wanted.scene.strategy;
        let of_draft = self.draft_strategy(wanted, is_software);
        let rays = pixels * f64::from(wanted.scene.supersample.pow(2));
        if of_draft == asked && budget.affords_whole(asked, goal_ms, rays, voxels) {
            Due::Quick(None)
        } else if !is(&self.drafted) {
            Due::Quick(Some(budget.draft(of_draft, goal_ms, pixels, voxels)))
        } else {
            Due::Slow
        }
    }

    /// Makes a draft of what is wanted.
    pub fn make_draft(&self, wanted: &mut RenderRequest, draft: DraftSize, is_software: bool) {
        wanted.scene.strategy = self.draft_strategy(wanted, is_software);
        let has_light = self.has_light(wanted);
        let scene = &mut wanted.scene;
        let smaller = |n: u32| ((f64::from(n) * draft.part).round() as u32).max(16);
        scene.size = scene.size.map(smaller);
        scene.supersample = 1;
        if is_lit(&scene.lighting) && scene.lighting.volume.light_size.is_none() {
            let part = draft.light_part;
            let coarse = self
                .light_size
                .map(|size| coarser(size, part))
                .unwrap_or(FIRST_LIGHT);
            let is_whole = self.light_size.is_some() && (part == 1 || has_light);
            scene.lighting.volume.light_size = (!is_whole).then_some(coarse);
        }
    }

    /// True where the whole light of what is wanted is there, from what is shown: the camera alone has moved since, and
    /// light does not follow it.
    fn has_light(&self, wanted: &RenderRequest) -> bool {
        let follows = |o: &OcclusionSpec| !o.method.is_around();
        let is_same = |shown: &ShownImage| {
            let known = &shown.picture.wanted;
            let size = shown.picture.view.style.lighting.light_size();
            let seen_alike = Scene {
                camera: wanted.scene.camera.clone(),
                size: wanted.scene.size,
                strategy: wanted.scene.strategy,
                supersample: wanted.scene.supersample,
                lighting: LightingSpec {
                    volume: wanted.scene.lighting.volume,
                    ..known.scene.lighting.clone()
                },
                ..known.scene.clone()
            };
            self.light_size == Some(size)
                && Arc::ptr_eq(&known.case, &wanted.case)
                && seen_alike == wanted.scene
        };
        !wanted
            .scene
            .lighting
            .occlusion
            .as_ref()
            .is_some_and(follows)
            && self.shown.as_ref().is_some_and(is_same)
    }

    /// Voxels of the light volume of a final picture; 0 where there is none, or it is not known.
    fn voxels(&self, scene: &Scene) -> f64 {
        let size = scene.lighting.volume.light_size.or(self.light_size);
        let size = size.filter(|_| is_lit(&scene.lighting));
        size.map_or(0.0, |s| s.iter().map(|n| f64::from(*n)).product())
    }

    /// PLTS for a draft where LIBC would draw so many faces that no draft is quick: the picture is the same
    /// but for what samples leave out.
    fn draft_strategy(&self, wanted: &RenderRequest, is_software: bool) -> StrategyKind {
        let asked = wanted.scene.strategy;
        let [width, height] = wanted.scene.size.map(f64::from);
        let fewest = COARSEST * COARSEST * width * height;
        let ms = |strategy| self.budget.rays_ms(strategy, fewest);
        let plts = ms(StrategyKind::Plts);
        let is_slow = ms(StrategyKind::Libc)
            .is_some_and(|libc| libc > TOO_SLOW_MS && plts.is_none_or(|plts| plts < libc));
        let is_large = is_software && wanted.case.grid.active_cells().len() > MANY_CELLS;
        match asked {
            StrategyKind::Libc if is_slow || is_large => StrategyKind::Plts,
            _ => asked,
        }
    }

    /// Takes a picture in.
    pub fn arrive(&mut self, ctx: &Context, picture: Picture, of: RenderRequest) {
        if !std::ptr::eq(self.budget_of.as_ptr(), Arc::as_ptr(&of.case)) {
            self.budget = DraftBudget::default();
            self.budget_of = Arc::downgrade(&of.case);
        }
        self.budget.learn(&spent(&picture), picture.is_draft);
        let whole = picture.view.style.lighting.size();
        self.light_size = Some(Lighting::light_size_of(whole));
        // A draft replaces what was finished before.
        self.finished = (!picture.is_draft).then(|| of.clone());
        self.drafted = Some(of);
        self.shown = Some(ShownImage {
            texture: texture(ctx, &picture.rgb),
            picture,
        });
    }

    /// Does not ask again for what cannot be shown.
    pub fn refuse(&mut self, wanted: RenderRequest) {
        self.refused = Some(wanted);
    }

    /// Keeps nothing of a case.
    pub fn forget(&mut self, case: &Arc<Case>) {
        let is_of = |wanted: &RenderRequest| Arc::ptr_eq(&wanted.case, case);
        for known in [&mut self.drafted, &mut self.finished, &mut self.refused] {
            known.take_if(|w| is_of(w));
        }
        self.shown.take_if(|s| is_of(&s.picture.wanted));
    }

    /// True where the final picture of this is shown.
    pub fn is_finished(&self, wanted: &RenderRequest) -> bool {
        self.finished.as_ref() == Some(wanted)
    }
}

/// A light volume with `part` times fewer voxels along each axis, on average: less so along the depth, where light
/// changes most.
fn coarser([x, y, depth]: [u32; 3], part: u32) -> [u32; 3] {
    let fewer = |n: u32, power: f64| {
        let fewer = f64::from(n) / f64::from(part).powf(power);
        (fewer.ceil() as u32).max(2)
    };
    [fewer(x, 1.25), fewer(y, 1.25), fewer(depth, 0.5)]
}

fn is_lit(lighting: &LightingSpec) -> bool {
    lighting.occlusion.is_some() || !lighting.lights.is_empty()
}

fn spent(picture: &Picture) -> Spent {
    let ms = |time: std::time::Duration| 1e3 * time.as_secs_f64();
    let [width, height] = picture.view.of_rays().size.map(f64::from);
    let light = picture.light.volumes;
    let voxels = picture.view.style.lighting.light_size();
    let voxels: f64 = voxels.into_iter().map(f64::from).product();
    Spent {
        strategy: picture.view.sampling.strategy,
        pixels: width * height,
        rays_ms: ms(picture.stats.wall),
        voxels: if light.is_zero() { 0.0 } else { voxels },
        light_ms: ms(light),
        rest_ms: ms(picture.took.saturating_sub(picture.stats.wall + light)),
    }
}

/// A texture with a picture.
pub fn texture(ctx: &Context, rgb: &Rgb8) -> TextureHandle {
    let size = rgb.size.map(|n| n as usize);
    let image = ColorImage::from_rgb(size, rgb.pixels.as_flattened());
    ctx.load_texture("picture", image, TextureOptions::LINEAR)
}
