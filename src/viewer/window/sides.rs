//! The middle of the window: one picture, or two that are compared.

use std::sync::Arc;

use eframe::egui::{self, Context, Rect, Sense, Ui, UiBuilder, pos2, vec2};
use glam::DVec2;

use super::Window;
use crate::case::Case;
use crate::picking::Pick;
use crate::picture::Annotations;
use crate::picture::compared::differing;
use crate::scene::{CameraSpec, Scene, Show};
use crate::view::View;
use crate::viewer::action::Action;
use crate::viewer::job::{PickPurpose, RenderRequest};
use crate::viewer::keys::Command;
use crate::viewer::pages::{self, Page};
use crate::viewer::render_session::difference_title;
use crate::viewer::state::{CompareLayout, Comparison};
use crate::viewer::viewport::{self, Touched, Viewport};
use crate::viewer::welcome::{self, MissingCaseAnswer, WelcomeRequest};
use crate::viewer::{handles, marks, overlay, panels};

/// Where the pictures are, and what the pointer is on.
#[derive(Default)]
pub struct Sides {
    viewports: [Viewport; 2],
    /// Where the volume of each picture is, in points.
    rects: [Option<Rect>; 2],
    /// What is seen where the pointer rests.
    pub hover: Option<Pick>,
    /// For where that was asked.
    asked: Option<Pointed>,
}

/// The case and scene of a side.
type Seen = Option<(Arc<Case>, Scene)>;

/// A place that the pointer is on.
#[derive(PartialEq)]
struct Pointed {
    pointer: egui::Pos2,
    side: usize,
    /// In the picture, 0 to 1, right and down.
    at: DVec2,
    wanted: RenderRequest,
}

/// Seconds that the pointer rests before what is under it is read.
const REST: f64 = 0.3;
/// Points on both sides of a wipe's line within which it is taken.
const GRIP: f32 = 8.0;
/// Points beside the image, from which the edges of the panels are dragged.
const EDGE: f32 = 4.0;

impl Sides {
    /// Pixels of the volume of each picture.
    pub fn sizes(&self, pixels_per_point: f32) -> [Option<[u32; 2]>; 2] {
        let pixels = |rect: Rect| viewport::pixels(rect, pixels_per_point, 1.0);
        self.rects.map(|r| r.map(pixels))
    }
}

impl Window {
    /// Panels and pictures, or the welcome page.
    pub(super) fn body(&mut self, ui: &mut Ui, ctx: &Context) {
        let Some(document) = self.documents.get_mut(self.current) else {
            match welcome::show(ui, &self.settings) {
                Some(WelcomeRequest::Open(path)) => self.open(ctx, vec![path]),
                Some(WelcomeRequest::Dialog) => self.perform(ctx, Command::Open),
                None => {}
            }
            return;
        };
        if document.case.is_none() {
            match welcome::waiting(ui, document) {
                Some(MissingCaseAnswer::Close) => self.close(self.current),
                Some(MissingCaseAnswer::Again) => self.reload(ctx),
                None => {}
            }
            return;
        }
        let Some((case, scene)) = self.subject() else {
            return;
        };
        let mut actions = Vec::new();
        if !self.settings.hides_panels {
            self.panels(ui, &case, &scene, &mut actions);
        }
        if let Some(command) = self.curves(ui, &case, &scene, &mut actions) {
            self.perform(ctx, command);
        }
        let touched = self.pictures(ui, ctx, &case, &scene);
        actions.extend(touched.camera.map(Action::Camera));
        actions.extend(touched.actions);
        for action in actions {
            self.apply(action);
        }
    }

    fn pictures(
        &mut self,
        ui: &mut Ui,
        ctx: &Context,
        case: &Arc<Case>,
        subject: &Scene,
    ) -> Touched {
        let Some(document) = self.documents.get(self.current) else {
            return Touched::default();
        };
        let setup = document.state.setup.clone();
        // The edges of the panels are caught beside it.
        let place = ui.available_rect_before_wrap();
        let fill = ui.visuals().panel_fill;
        ui.painter().rect_filled(place, 0.0, fill);
        let place = place.shrink2(vec2(EDGE, 0.0));
        let (mut rects, layout) = layout(place, setup.comparison.as_ref());
        let other = self.other();
        if other.is_none() {
            rects = [Some(place), None];
        }
        let cases = [Some(case.clone()), other.as_ref().map(|o| o.0.clone())];
        let pages = self.pages(ui, rects, &cases, &setup.scene.show);
        self.beside(ui, &pages, &cases, layout);
        let rects = pages.map(|p| p.as_ref().map(Page::volume));
        self.sides.rects = rects;
        let mut touched = self.viewport(ui, case, subject, rects[0], 0);
        let sides = [Some((case.clone(), subject.clone())), other.clone()];
        let mut clicked = touched.pick.map(|at| (side_at(layout, at), at));
        if let (Some((other, scene)), Some(rect), Some(comparison)) =
            (other, rects[1], &setup.comparison)
        {
            match layout {
                Some(CompareLayout::Beside) => {
                    let there = self.viewport(ui, &other, &scene, Some(rect), 1);
                    let link = self.link();
                    let back = |c| link.map_or_else(|| CameraSpec::clone(&c), |l| l.back(&c));
                    touched.camera = touched.camera.or(there.camera.map(back));
                    clicked = clicked.or(there.pick.map(|at| (1, at)));
                }
                Some(CompareLayout::Wipe(at)) => {
                    let moved = self.wipe(ui, &other, &scene, rect, at);
                    if let Some(at) = moved {
                        touched.actions.push(Action::Compare(Some(Comparison {
                            layout: CompareLayout::Wipe(at),
                            ..comparison.clone()
                        })));
                    }
                }
                _ => self.difference_map(ui, rect),
            }
            if layout == Some(CompareLayout::ColorDifference) && self.pictures.are_final() {
                self.pictures.compare();
            }
        }
        if let (Some(Err(why)), Some(rect)) = (self.difference_of_values(), rects[0]) {
            overlay::refusal(&ui.painter_at(rect), rect, &why);
        }
        if let Some(shown) = self.pictures.shown(0, case)
            && let Some(rect) = rects[0]
        {
            let view = shown.picture.view.clone();
            self.mark(ui, &rects, case, setup.comparison.as_ref(), subject);
            if let Some(planes) = handles::show(ui, rect, &view, subject) {
                touched.actions.push(Action::Clip(planes));
            }
        }
        self.pick(ctx, &sides, clicked);
        self.hover(ui, ctx, &sides, layout);
        touched
    }

    /// Marks the selected cells in each picture of their case.
    fn mark(
        &self,
        ui: &Ui,
        rects: &[Option<Rect>; 2],
        case: &Arc<Case>,
        comparison: Option<&Comparison>,
        scene: &Scene,
    ) {
        let Some(document) = self.document() else {
            return;
        };
        let is_beside = comparison.is_some_and(|c| c.layout == CompareLayout::Beside);
        for (n, rect) in rects.iter().enumerate().take(1 + usize::from(is_beside)) {
            if let (Some(rect), Some(shown)) = (rect, self.pictures.shown(n, case)) {
                let view = &shown.picture.view;
                marks::show(ui, *rect, view, scene, case, &document.state.selected);
            }
        }
    }

    /// One picture with what is drawn over it.
    fn viewport(
        &mut self,
        ui: &mut Ui,
        case: &Arc<Case>,
        scene: &Scene,
        rect: Option<Rect>,
        side: usize,
    ) -> Touched {
        let Some(rect) = rect else {
            return Touched::default();
        };
        let shown = self.pictures.shown(side, case);
        let viewport = &mut self.sides.viewports[side];
        let builder = UiBuilder::new().id_salt(("side", side)).max_rect(rect);
        let mut child = ui.new_child(builder);
        viewport.show(&mut child, case, scene, shown, self.settings.mouse)
    }

    /// The second picture over the first one, right of a line; where the line was dragged to.
    fn wipe(
        &self,
        ui: &mut Ui,
        case: &Arc<Case>,
        scene: &Scene,
        rect: Rect,
        at: f64,
    ) -> Option<f64> {
        let x = rect.left() + at as f32 * rect.width();
        let right = Rect::from_min_max(pos2(x, rect.top()), rect.max);
        if let Some(shown) = self.pictures.shown(1, case) {
            let painter = ui.painter_at(right);
            let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            painter.image(shown.texture.id(), rect, uv, egui::Color32::WHITE);
            let view = &shown.picture.view;
            let size = view.size;
            let now = view
                .seen_from(&scene.camera, size)
                .map_or_else(|_| view.clone(), Arc::new);
            overlay::draw(
                &painter,
                rect,
                &shown.picture,
                &now,
                &Annotations::of(case, &now),
            );
        }
        let grip = Rect::from_x_y_ranges(x - GRIP..=x + GRIP, rect.y_range());
        let response = ui.interact(grip, ui.scope_id().with("wipe"), Sense::drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, "wipe"));
        let response = response.on_hover_cursor(egui::CursorIcon::ResizeHorizontal);
        let width = if response.hovered() || response.dragged() {
            3.0
        } else {
            1.5
        };
        let light = egui::Stroke::new(width + 2.0, egui::Color32::WHITE);
        let dark = egui::Stroke::new(width, egui::Color32::BLACK);
        for stroke in [light, dark] {
            ui.painter().vline(x, rect.y_range(), stroke);
        }
        let pointer = response
            .interact_pointer_pos()
            .filter(|_| response.dragged())?;
        Some(f64::from(
            ((pointer.x - rect.left()) / rect.width()).clamp(0.0, 1.0),
        ))
    }

    /// The parts of each picture, from what was shown last; pictures beside each other have the same.
    fn pages(
        &self,
        ui: &Ui,
        places: [Option<Rect>; 2],
        cases: &[Option<Arc<Case>>; 2],
        show: &Show,
    ) -> [Option<Page>; 2] {
        let shown = self.shown_views(cases);
        pages::laid_out(ui.painter(), places, &shown, show)
    }

    /// The view and case of each picture that is shown.
    fn shown_views(&self, cases: &[Option<Arc<Case>>; 2]) -> [Option<(Arc<View>, Arc<Case>)>; 2] {
        [0, 1].map(|n| {
            let case = cases[n].as_ref()?;
            let shown = self.pictures.shown(n, case)?;
            Some((shown.picture.view.clone(), case.clone()))
        })
    }

    /// Draws what stands beside the volume of each picture.
    fn beside(
        &self,
        ui: &Ui,
        pages: &[Option<Page>; 2],
        cases: &[Option<Arc<Case>>; 2],
        layout: Option<CompareLayout>,
    ) {
        for (n, page) in pages.iter().flatten().enumerate() {
            let id = ui.scope_id().with(("image", n));
            let image = ui.interact(page.place(), id, Sense::hover());
            image.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "image"));
        }
        let shown = self.shown_views(cases);
        let own = match &shown {
            [Some(first), Some(second)] => {
                differing([(&*first.1, &*first.0), (&*second.1, &*second.0)])
            }
            _ => Default::default(),
        };
        let figures = match layout {
            Some(CompareLayout::ColorDifference) => self.pictures.difference(),
            _ => None,
        };
        let figures = figures.map(|d| difference_title(&d.difference.figures));
        let is_shared = matches!(layout, Some(CompareLayout::Wipe(_)));
        if is_shared && let ([Some(page), _], [Some(first), Some(second)]) = (pages, &shown) {
            pages::draw_shared(ui.painter(), page, [first, second], &own);
            return;
        }
        for (n, page) in pages.iter().enumerate() {
            if let (Some(page), Some(shown)) = (page, &shown[n]) {
                let title = figures.as_deref();
                pages::draw(ui.painter(), page, shown, title, &own[n]);
            }
            // Both have the same place.
            if layout == Some(CompareLayout::ColorDifference) {
                break;
            }
        }
    }

    /// The map of differences over the first picture, once it is known.
    fn difference_map(&self, ui: &mut Ui, rect: Rect) {
        let Some(shown) = self.pictures.difference() else {
            return;
        };
        let painter = ui.painter_at(rect);
        let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        painter.image(shown.texture.id(), rect, uv, egui::Color32::WHITE);
    }

    /// Asks for the cell that was clicked in the picture of a side.
    fn pick(&mut self, ctx: &Context, sides: &[Seen; 2], clicked: Option<(usize, DVec2)>) {
        let why = match ctx.input(|i| i.modifiers.command) {
            true => PickPurpose::AddToSelection,
            false => PickPurpose::Select,
        };
        let Some((side, at)) = clicked else { return };
        let [Some((first, _)), _] = sides else { return };
        match &sides[side] {
            Some((case, scene)) if Arc::ptr_eq(case, first) => {
                if let Some(wanted) = self.sized(ctx, case, scene) {
                    self.pictures.pick(side, wanted, at, why);
                }
            }
            Some(_) => self.tell("cells of the other case are selected in its own tab"),
            None => {}
        }
    }

    /// A scene in the size of the first picture; of two beside each other the second one has that too.
    fn sized(&self, ctx: &Context, case: &Arc<Case>, scene: &Scene) -> Option<RenderRequest> {
        let size = self.sides.sizes(ctx.pixels_per_point())[0]?;
        Some(RenderRequest {
            case: case.clone(),
            scene: Scene {
                size,
                ..scene.clone()
            },
        })
    }

    /// Reads the cell and the fault that the pointer rests on, once all pictures are there: none waits for it.
    fn hover(&mut self, ui: &Ui, ctx: &Context, sides: &[Seen; 2], layout: Option<CompareLayout>) {
        let pointed = self.pointed(ui, ctx, sides, layout);
        if self.sides.asked != pointed {
            self.sides.hover = None;
        }
        let Some(pointed) = pointed else {
            self.sides.asked = None;
            return;
        };
        if self.sides.asked.as_ref() != Some(&pointed) {
            let still = ctx.input(|i| f64::from(i.pointer.time_since_last_movement()));
            if still < REST {
                ctx.request_repaint_after_secs((REST - still).max(0.02) as f32);
            } else if self.pictures.are_final() {
                let Pointed { side, at, .. } = pointed;
                let wanted = pointed.wanted.clone();
                self.pictures.pick(side, wanted, at, PickPurpose::Hover);
                self.sides.asked = Some(pointed);
            }
            return;
        }
        let pick = self.sides.hover.as_ref();
        let wanted = &pointed.wanted;
        let units = wanted.scene.units.into();
        let text = pick.and_then(|pick| panels::hover_text(pick, &wanted.case, units));
        if let Some(text) = text {
            overlay::tip(ui, pointed.pointer + vec2(14.0, 14.0), &text);
        }
    }

    /// What the pointer is on: a picture with nothing over it.
    fn pointed(
        &self,
        ui: &Ui,
        ctx: &Context,
        sides: &[Seen; 2],
        layout: Option<CompareLayout>,
    ) -> Option<Pointed> {
        let pointer = ctx.input(|i| i.pointer.hover_pos())?;
        let is_covered = ctx.layer_id_at(pointer).is_some_and(|l| l != ui.layer_id());
        if is_covered
            || ctx.egui_is_using_pointer()
            || layout == Some(CompareLayout::ColorDifference)
        {
            return None;
        }
        let is_on = |rect: &Option<Rect>| rect.is_some_and(|r| r.contains(pointer));
        let number = self.sides.rects.iter().position(is_on)?;
        let rect = self.sides.rects[number]?;
        let at = (pointer - rect.min) / rect.size();
        let at = DVec2::new(f64::from(at.x), f64::from(at.y));
        let side = number.max(side_at(layout, at));
        let (case, scene) = sides[side].as_ref()?;
        Some(Pointed {
            pointer,
            side,
            at,
            wanted: self.sized(ctx, case, scene)?,
        })
    }
}

/// The side that is seen at a place in the first picture.
fn side_at(layout: Option<CompareLayout>, at: DVec2) -> usize {
    match layout {
        Some(CompareLayout::Wipe(line)) if at.x > line => 1,
        _ => 0,
    }
}

/// Places of both pictures, and how they are shown.
fn layout(
    place: Rect,
    comparison: Option<&Comparison>,
) -> ([Option<Rect>; 2], Option<CompareLayout>) {
    let layout = comparison.map(|c| c.layout);
    let rects = match layout {
        None => [Some(place), None],
        Some(CompareLayout::Beside) => {
            let (left, right) = place.split_left_right_at_fraction(0.5);
            [
                left.with_max_x(left.right() - 1.0),
                right.with_min_x(right.left() + 1.0),
            ]
            .map(Some)
        }
        Some(CompareLayout::Difference) => [Some(place), None],
        Some(CompareLayout::Wipe(_) | CompareLayout::ColorDifference) => [Some(place), Some(place)],
    };
    (rects, layout)
}
