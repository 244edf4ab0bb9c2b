#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

use std::path::Path;
use std::sync::{Condvar, Mutex};

use super::*;
use crate::render::gpu::Gpu;
use crate::scene::lighting::LightMethod;
use crate::scene::{CameraSpec, FramingCamera, LightingSpec, Projection, Scene};
use crate::view::Lighting;
use crate::viewer::budget::COARSEST;

/// Longest wait for anything.
const PATIENCE: Duration = Duration::from_secs(120);

/// A gate on the way of the thread that makes pictures: while it is closed, the device is as busy as can be.
#[derive(Default)]
struct Gate {
    is_closed: Mutex<bool>,
    opens: Condvar,
}

impl Gate {
    fn set(&self, is_closed: bool) {
        *self.is_closed.lock().unwrap() = is_closed;
        self.opens.notify_all();
    }

    fn pass(&self) {
        let closed = self.is_closed.lock().unwrap();
        let waited = self.opens.wait_timeout_while(closed, PATIENCE, |c| *c);
        assert!(!waited.unwrap().1.timed_out(), "the gate was left closed");
    }
}

struct Turning {
    ctx: Context,
    pictures: Pictures,
    gate: Arc<Gate>,
    case: Arc<Case>,
    lighting: LightingSpec,
}

const SIZE: [u32; 2] = [400, 300];

fn turning(light: &str) -> Option<Turning> {
    if Gpu::new(None).is_err() {
        assert!(std::env::var_os("REQUIRE_GPU").is_none());
        return None;
    }
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/scissor/SCISSOR.EGRID");
    let gate = Arc::<Gate>::default();
    let passed = gate.clone();
    Some(Turning {
        ctx: Context::default(),
        pictures: Pictures::new(move || passed.pass()),
        gate,
        case: Arc::new(crate::case::load::open(&sample).unwrap()),
        lighting: LightingSpec::preset(light).unwrap(),
    })
}

impl Turning {
    fn wanted(&self, degrees: u32) -> RenderRequest {
        let camera = CameraSpec::Framing(FramingCamera {
            azimuth_degrees: f64::from(degrees),
            elevation_degrees: 30.0,
            zoom: 1.0,
            projection: Projection::Perspective,
        });
        RenderRequest {
            case: self.case.clone(),
            scene: Scene {
                camera,
                size: SIZE,
                lighting: self.lighting.clone(),
                ..Scene::default()
            },
        }
    }

    /// A frame in which the pointer is down and the camera stands there.
    fn frame(&mut self, degrees: u32) {
        let wanted = vec![self.wanted(degrees)];
        self.pictures.listen(&self.ctx);
        self.pictures.schedule(&self.ctx, wanted, true, false);
    }

    /// Frames at rest until the final picture from there is shown.
    fn rest(&mut self, degrees: u32) {
        let start = Instant::now();
        while !self.pictures.sides[0].is_finished(&self.wanted(degrees)) {
            self.pictures.listen(&self.ctx);
            let wanted = vec![self.wanted(degrees)];
            self.pictures.schedule(&self.ctx, wanted, false, false);
            assert!(start.elapsed() < PATIENCE, "no final picture");
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    /// Azimuth of the camera of the picture that is shown.
    fn shown(&self) -> Option<f64> {
        let shown = self.pictures.shown(0, &self.case)?;
        match &shown.picture.wanted.scene.camera {
            CameraSpec::Framing(camera) => Some(camera.azimuth_degrees),
            CameraSpec::Explicit(_) | CameraSpec::Automatic(_) => None,
        }
    }

    /// Frames until the picture from there is shown; the azimuths that were shown on the way.
    fn until(&mut self, degrees: u32) -> Vec<f64> {
        let start = Instant::now();
        let mut seen = Vec::new();
        loop {
            self.frame(degrees);
            let shown = self.shown();
            if shown != seen.last().copied() {
                seen.extend(shown);
            }
            if shown == Some(f64::from(degrees)) {
                return seen;
            }
            assert!(start.elapsed() < PATIENCE, "no picture from {degrees}");
            std::thread::sleep(Duration::from_millis(2));
        }
    }
}

#[test]
fn no_frame_waits_for_the_device_and_no_draft_is_stale_by_more_than_one() {
    let Some(mut turning) = turning("off") else {
        return;
    };
    turning.until(10);
    // The thread is held as soon as the next picture is made, while the pointer goes on.
    turning.gate.set(true);
    let before = turning.pictures.drafts;
    for degrees in 20..60 {
        // Were a frame to wait for the device, it would wait here for as long as the gate is patient.
        turning.frame(degrees);
        assert!(turning.pictures.drafts.asked <= before.asked + 2);
    }
    turning.gate.set(false);
    let seen = turning.until(59);
    // The drafts that were on their way, the oldest first, and then the newest camera at once.
    assert!(seen.len() <= 3, "{seen:?}");
    assert!(turning.pictures.drafts.made - before.made <= 3, "{seen:?}");
}

#[test]
fn every_move_leads_to_a_draft_within_bounds_and_the_light_with_it() {
    for light in ["off", "soft"] {
        let Some(mut turning) = turning(light) else {
            return;
        };
        let first = turning.pictures.drafts;
        for degrees in 1..=20 {
            turning.until(degrees);
            let picture = &turning.pictures.shown(0, &turning.case).unwrap().picture;
            for (n, whole) in picture.rgb.size.into_iter().zip(SIZE) {
                let least = (COARSEST * f64::from(whole)).floor();
                assert!(f64::from(n) >= least && n <= whole, "{n} of {whole}");
            }
            if light != "off" {
                let lighting = &picture.view.style.lighting;
                let whole = Lighting::light_size_of(lighting.size());
                let voxels = |s: [u32; 3]| s.iter().product::<u32>();
                let made = lighting.light_size();
                assert!(voxels(made) <= voxels(whole), "{made:?} of {whole:?}");
            }
        }
        // As many drafts as moves: each was of the newest camera. Whole pictures that are made in time count
        // for none.
        let drafts = turning.pictures.drafts;
        assert_eq!(drafts.asked, drafts.made);
        assert!(drafts.made - first.made <= 20);
        assert!(drafts.made > first.made, "the first one is a draft");
    }
}

#[test]
fn light_from_all_sides_stays_whole_while_the_camera_turns() {
    let Some(mut turning) = turning("strong") else {
        return;
    };
    if let Some(occlusion) = &mut turning.lighting.occlusion {
        occlusion.method = LightMethod::Surround;
    }
    turning.rest(10);
    for degrees in 11..15 {
        turning.until(degrees);
        let picture = &turning.pictures.shown(0, &turning.case).unwrap().picture;
        let lighting = &picture.view.style.lighting;
        let whole = Lighting::light_size_of(lighting.size());
        assert_eq!(lighting.light_size(), whole);
    }
}

#[test]
fn a_case_that_is_closed_is_let_go() {
    let Some(mut turning) = turning("soft") else {
        return;
    };
    turning.until(10);
    // One is on its way.
    turning.frame(20);
    let case = Arc::downgrade(&turning.case);
    turning.pictures.forget(&turning.case);
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/scissor/SCISSOR.EGRID");
    turning.case = Arc::new(crate::case::load::open(&sample).unwrap());
    let start = Instant::now();
    while case.strong_count() > 0 {
        turning.pictures.listen(&turning.ctx);
        assert!(start.elapsed() < PATIENCE, "{}", case.strong_count());
        std::thread::sleep(Duration::from_millis(2));
    }
    // What is opened next is drawn as ever.
    turning.until(30);
}

#[test]
fn only_clicks_take_the_place_of_a_final_picture() {
    let Some(mut turning) = turning("off") else {
        return;
    };
    let wanted = turning.wanted(10);
    for (why, is_left) in [(PickPurpose::Hover, false), (PickPurpose::Select, true)] {
        turning.pictures.flight = Some(Flight {
            side: 0,
            wanted: wanted.clone(),
            is_draft: false,
            is_slow: true,
            is_canceled: false,
            is_forgotten: false,
        });
        let pictures = &mut turning.pictures;
        pictures.pick(0, wanted.clone(), DVec2::splat(0.5), why);
        assert_eq!(pictures.flight.as_ref().unwrap().is_canceled, is_left);
    }
}
