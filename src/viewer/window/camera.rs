//! What keys and menus do to the camera.

use std::sync::Arc;

use glam::DVec2;

use super::Window;
use crate::case::Case;
use crate::scene::CameraSpec;
use crate::view::View;
use crate::viewer::action::Action;
use crate::viewer::keys::CameraMove;
use crate::viewer::orbit;

/// Degrees of a step of [`CameraMove::Turn`], and factor of one of [`CameraMove::Zoom`].
const STEP: f64 = 10.0;
const CLOSER: f64 = 1.25;

impl Window {
    /// Changes the camera of the document in front; nothing before there is a picture.
    pub(super) fn move_camera(&mut self, change: CameraMove) {
        let view = self.picture(0).map(|(picture, _)| picture.view.clone());
        let document = self.document();
        let Some((document, case)) = document.and_then(|d| Some((d, d.case.clone()?))) else {
            return;
        };
        let camera = &document.state.setup.scene.camera;
        let now = view.and_then(|v| v.seen_from(camera, v.size).ok());
        let selected = &document.state.selected;
        let camera = match (change, now) {
            (CameraMove::From(n), _) => Some(orbit::standard(n, camera.projection())),
            (_, Some(now)) => {
                let case = case.in_space(now.world.space);
                changed(change, camera, &now, &case, selected)
            }
            (_, None) => None,
        };
        match camera {
            Some(camera) => {
                if let Some(document) = self.document_mut() {
                    document.history.end_gesture();
                }
                self.apply(Action::Camera(camera));
            }
            None if change == CameraMove::FrameSelection => self.tell("no cell is drawn"),
            None => {}
        }
    }
}

impl Window {
    /// The camera of the picture as a place in the world, where that of the scene would follow what is drawn.
    pub(super) fn held_camera(&self) -> Option<CameraSpec> {
        let camera = &self.document()?.state.setup.scene.camera;
        camera.framing_zoom()?;
        let view = &self.picture(0)?.0.view;
        let now = view.seen_from(camera, view.size).ok()?;
        Some(orbit::spec(&now.camera, &now.world.corners))
    }
}

fn changed(
    change: CameraMove,
    spec: &CameraSpec,
    now: &View,
    case: &Arc<Case>,
    selected: &[[usize; 3]],
) -> Option<CameraSpec> {
    let (camera, aspect) = (&now.camera, now.aspect());
    let corners = &now.world.corners;
    let drawn = || now.drawn_bounds(&case.grid).map(|b| now.corners_of(b));
    let center = || orbit::point_under(now, now.drawn_bounds(&case.grid), DVec2::splat(0.5));
    let camera = match change {
        CameraMove::From(n) => return Some(orbit::standard(n, spec.projection())),
        CameraMove::FrameAll => {
            let points = &now.world.subject.points;
            return Some(orbit::frame_all(spec, camera, points, corners, aspect));
        }
        CameraMove::Projection => return Some(orbit::switched(spec, camera, corners)),
        CameraMove::FrameSelection => {
            let cells = selected
                .iter()
                .filter_map(|ijk| case.grid.dims().one_based(*ijk));
            match orbit::on_cells(now, &case.grid, cells) {
                Some(camera) => camera,
                None => camera.framed(&drawn()?, aspect),
            }
        }
        CameraMove::Turn(right, up) => {
            let steps = DVec2::new(-f64::from(right), f64::from(up));
            orbit::rotate(camera, center(), orbit::drag_of(STEP.to_radians() * steps))
        }
        CameraMove::Zoom(is_closer) => orbit::zoom(
            camera,
            center(),
            if is_closer { CLOSER } else { 1.0 / CLOSER },
        ),
    };
    Some(orbit::spec(&camera, corners))
}
