//! How long a hand that turns the model waits: drafts made as the window makes them, but without a window.

use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use eframe::egui::Context;

use super::job::RenderRequest;
use super::pictures::{Event, Pictures};
use crate::case::Case;
use crate::scene::{CameraSpec, FramingCamera, Projection, Scene};

/// A draft from one of the cameras around the model.
#[derive(Debug, Clone, Copy)]
pub struct Turned {
    /// From when it was asked for until it could be shown.
    pub took: Duration,
    /// Of it, what its rays took.
    pub rays: Duration,
    /// Of it, what its light volumes took.
    pub light_volumes: Duration,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Voxels of its light volume along each axis; `None` without light.
    pub light: Option<[u32; 3]>,
}

/// Degrees that a move of the pointer turns.
const DEGREES: f64 = 1.5;
/// Longest wait for a picture.
const PATIENCE: Duration = Duration::from_secs(600);

/// Turns the model by so many moves of the pointer and makes a draft of each; `scene.size` is that of the
/// picture in the window. The first ones, which find out what drafts cost, are among them.
///
/// # Errors
/// When there is no adapter, or no picture is made; the sentence says why.
pub fn turn(case: &Arc<Case>, scene: &Scene, moves: usize) -> Result<Vec<Turned>, String> {
    let (wake, woken) = channel();
    let mut pictures = Pictures::new(move || {
        // Nobody listens anymore once the last draft is there.
        let _ = wake.send(());
    });
    let ctx = Context::default();
    let mut turned = Vec::new();
    for n in 0..moves {
        let camera = CameraSpec::Framing(FramingCamera {
            azimuth_degrees: (45.0 + DEGREES * n as f64) % 360.0,
            elevation_degrees: 30.0,
            zoom: 1.0,
            projection: Projection::Perspective,
        });
        let wanted = RenderRequest {
            case: case.clone(),
            scene: Scene {
                camera: camera.clone(),
                ..scene.clone()
            },
        };
        let start = Instant::now();
        loop {
            for event in pictures.listen(&ctx) {
                if let Event::Failed(error) = event {
                    return Err(error);
                }
            }
            let shown = pictures.shown(0, case).map(|s| &s.picture);
            if let Some(picture) = shown.filter(|p| p.wanted.scene.camera == camera) {
                let lighting = &picture.view.style.lighting;
                turned.push(Turned {
                    took: start.elapsed(),
                    rays: picture.stats.wall,
                    light_volumes: picture.light.volumes,
                    size: picture.rgb.size,
                    light: (!lighting.is_off()).then(|| lighting.light_size()),
                });
                break;
            }
            pictures.schedule(&ctx, vec![wanted.clone()], true, false);
            match woken.recv_timeout(PATIENCE) {
                Ok(()) => {}
                Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => {
                    return Err("no picture came within ten minutes".into());
                }
            }
        }
    }
    Ok(turned)
}
