//! The picture itself: drawn into its space, and the pointer's and arrow keys' way to the camera.

use crate::viewer::document::Document;
use crate::viewer::picture::crop;
use crate::viewer::picture::false_colour::FalseColour;
use crate::viewer::picture::legend::{self, Pixel};
use crate::viewer::picture::maps::Layer;
use crate::viewer::picture::orbit;
use crate::viewer::picture::side::Side;
use crate::viewer::picture::texture::Look;
use crate::viewer::picture::versus::{self, DifferenceTexture, Versus};
use crate::viewer::style::theme;
use crate::viewer::style::widgets;
use burnish::progressive::{Params, Snapshot, State, TileGrid};
use burnish::scene::{Camera, Scene};
use egui::{
    CursorIcon, EventFilter, Id, Key, Modifiers, PointerButton, Pos2, Rect, Response, Role, Sense,
    Stroke, StrokeKind, TextureOptions, Ui, Vec2, WidgetInfo, vec2,
};
use glam::DVec3;
use std::sync::Arc;

/// Orbit angle for a drag across the whole picture, in radians.
const TURN: f64 = std::f64::consts::PI;
/// Orbit angle of one press of an arrow key.
const STEP: f64 = std::f64::consts::PI / 36.0;
/// Shift of one press of an arrow key, in heights of the picture.
const SHIFT: f64 = 0.05;

/// Size at which the picture is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Zoom {
    /// As large as the space allows.
    Fit,
    /// Pixels of the screen for one of the picture.
    Times(f32),
}

/// A pixel under the pointer: its place, its radiance, the standard error of that once it is
/// known, of how many passes, and how many samples it has itself; 0 for the coarse preview.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hover {
    pub(crate) pixel: [u32; 2],
    pub(crate) mean: [f32; 3],
    pub(crate) standard_error: Option<[f32; 3]>,
    pub(crate) passes: u64,
    pub(crate) samples: u64,
}

pub(crate) struct Canvas {
    /// The picture, and the one that it is compared with.
    sides: [Side; 2],
    difference: DifferenceTexture,
    /// The colours of what is shown of the pictures.
    pub(crate) maps: FalseColour,
    /// Place of the bar between the two, as a part of the picture's width.
    pub(crate) wipe: f32,
    /// View and epoch of the picture last shown.
    seen: Option<Seen>,
    zoom: Zoom,
    /// Offset of the picture's middle from the middle of the space, in points.
    offset: Vec2,
    /// The pixel under the pointer, for the status line.
    pub(crate) hover: Option<Hover>,
    /// The point that a drag turns about or moves along: where it began, if a surface was there.
    held: Option<DVec3>,
    /// Corner at which a crop that is being dragged began, in points.
    cropping: Option<Pos2>,
    /// Place of the picture as last drawn, in points; it may reach beyond its space.
    pub(crate) place: Option<Rect>,
    id: Option<Id>,
    /// Pixels of the screen that a picture has room for.
    pub(crate) room: [u32; 2],
}

/// View and epoch of a picture.
struct Seen {
    scene: Arc<Scene>,
    camera: Camera,
    epoch: u64,
}

impl Canvas {
    pub(crate) fn new() -> Canvas {
        Canvas {
            sides: Default::default(),
            difference: DifferenceTexture::default(),
            maps: FalseColour::default(),
            wipe: 0.5,
            seen: None,
            zoom: Zoom::Fit,
            offset: Vec2::ZERO,
            hover: None,
            held: None,
            cropping: None,
            place: None,
            id: None,
            room: [640, 480],
        }
    }

    /// Whether all that has come is shown.
    #[cfg(test)]
    pub(crate) fn is_settled(&self) -> bool {
        self.sides.iter().all(Side::is_settled)
    }

    /// Whether anything has been shown yet.
    pub(crate) fn is_empty(&self) -> bool {
        self.sides[0].texture.is_none()
    }

    /// Whether the arrow keys go to the picture.
    pub(crate) fn has_focus(&self, ctx: &egui::Context) -> bool {
        self.id.is_some_and(|id| ctx.memory(|m| m.has_focus(id)))
    }

    /// Fits the picture to its space, or shows its pixels one to one.
    pub(crate) fn toggle_zoom(&mut self) {
        self.zoom = if self.zoom == Zoom::Fit { Zoom::Times(1.0) } else { Zoom::Fit };
        self.offset = Vec2::ZERO;
    }

    /// Takes over the new tiles of a snapshot, unless the picture before is of the same view and this
    /// one is to wait until it has as many passes as `hold`. Whether it did.
    pub(crate) fn show(&mut self, snapshot: &Snapshot, document: &Document, hold: u64) -> bool {
        let params = &document.params;
        let waits = self.seen.as_ref().is_some_and(|seen| {
            let same_view = Arc::ptr_eq(&seen.scene, &params.scene) && seen.camera == params.camera;
            let same_size = self.sides[0].size() == Some(snapshot.grid.size);
            let coarse = snapshot.passes < hold && snapshot.state == State::Running;
            seen.epoch != snapshot.epoch && same_view && same_size && coarse
        });
        if !waits {
            self.maps.news |= self.sides[0].show(snapshot, Look::Tone(document.tone));
            let (scene, camera) = (params.scene.clone(), params.camera);
            self.seen = Some(Seen { scene, camera, epoch: snapshot.epoch });
        }
        !waits
    }

    /// Shows a picture in place of the one being traced (0), or as the second one (1).
    pub(crate) fn put(&mut self, side: usize, snapshot: &Snapshot, document: &Document) {
        self.maps.news |= self.sides[side].show(snapshot, Look::Tone(document.tone));
    }

    /// Has no second picture any more.
    pub(crate) fn alone(&mut self) {
        self.sides[1] = Side::default();
        self.difference = DifferenceTexture::default();
    }

    /// The value at the pointer on the scale.
    fn pointed(&self, layer: Layer) -> Pixel {
        let texture = self.sides[0].texture.as_ref();
        let pointed = self.hover.zip(texture).and_then(|(h, texture)| texture.tile_of(h.pixel));
        pointed.map_or(Pixel::None, |(tile, rect, at)| Pixel::of(layer, tile, rect, at))
    }

    /// Draws the picture and lets the pointer and the arrow keys move the camera, pick and zoom.
    pub(crate) fn ui(
        &mut self,
        ui: &mut Ui,
        document: Option<&mut Document>,
        versus: Option<Versus>,
    ) -> Response {
        let space = ui.available_rect_before_wrap();
        let response = ui.allocate_rect(space, Sense::click_and_drag());
        self.id = Some(response.id);
        (self.hover, self.place) = (None, None);
        let pixels_per_point = ui.pixels_per_point();
        let layout = versus.as_ref().map(|v| v.layout);
        let spaces = versus::spaces(space, layout);
        let margin = Vec2::splat(2.0 * theme::GROUP);
        let room = |space: Rect| (space.size() - margin).max(Vec2::splat(1.0));
        let most = Params::MAX_SIDE as f32;
        self.room = [room(space).x, room(space).y]
            .map(|side| (side * pixels_per_point).clamp(1.0, most) as u32);
        let room = room(spaces[0]) * pixels_per_point;
        if let Some(document) = &document {
            let options = filter(self.times(room));
            let look = self.maps.look(document.layer, document.tone, layout, &self.sides);
            for side in &mut self.sides {
                side.refresh(ui.ctx(), look, options);
            }
        }
        let times = self.times(room);
        if let (Some(size), Some(document)) = (self.sides[0].size(), document) {
            let size = vec2(size[0] as f32, size[1] as f32) * times / pixels_per_point;
            // Some of it stays within reach.
            let reach = (0.5 * (size + spaces[0].size()) - margin).max(Vec2::ZERO);
            self.offset = self.offset.clamp(-reach, reach);
            let places = spaces.map(|space| {
                let place = Rect::from_center_size(space.center() + self.offset, size);
                // On whole pixels of the screen, or every texel would be a little blurred.
                let at = (place.min * pixels_per_point).round() / pixels_per_point;
                place.translate(at - place.min)
            });
            match (versus, &self.sides[0].texture) {
                (Some(versus), _) => {
                    let options = filter(times);
                    let Canvas { sides, difference, wipe, .. } = self;
                    versus.paint(ui, [spaces, places], sides, wipe, difference, options);
                }
                (None, Some(texture)) => texture.paint(&ui.painter_at(space), places[0]),
                (None, None) => {}
            }
            self.place = Some(places[0]);
            let under = response.hover_pos().is_some_and(|at| spaces[1].contains(at));
            let place = places[usize::from(under)];
            if !self.crop(ui, &response, document, place) {
                self.pointer(ui, &response, document, place, times);
            }
            keyboard(ui, &response, document);
            if let Some(scale) = &self.maps.scale() {
                let at = [spaces[0], places[0]];
                legend::paint(ui, scale, at, self.pointed(scale.layer));
            }
            if response.has_focus() {
                widgets::focus_frame(ui, places[0].intersect(space));
            }
        }
        response.widget_info(|| WidgetInfo::labeled(Role::Image, ui.is_enabled(), "Picture"));
        response
    }

    /// Pixels of the screen for one of the picture, where it has `room` of them.
    fn times(&self, room: Vec2) -> f32 {
        match (self.zoom, self.sides[0].size()) {
            (Zoom::Times(times), _) => times,
            // A picture made for the room: pixel by pixel.
            (Zoom::Fit, Some([width, height]))
                if (room.x as u32, room.y as u32) == (width, height) =>
            {
                1.0
            }
            (Zoom::Fit, Some([width, height])) => {
                (room / vec2(width as f32, height as f32)).min_elem()
            }
            (Zoom::Fit, None) => 1.0,
        }
    }

    /// Ctrl and a drag: the part of the picture that is to be traced. Whether it is being chosen.
    fn crop(&mut self, ui: &Ui, response: &Response, document: &mut Document, place: Rect) -> bool {
        let (held, origin, at) =
            ui.input(|i| (i.modifiers.command, i.pointer.press_origin(), i.pointer.interact_pos()));
        if response.drag_started_by(PointerButton::Primary) && held {
            self.cropping = origin.filter(|at| place.contains(*at));
        }
        let (Some(from), Some(to)) = (self.cropping, at) else { return false };
        let part = crop::dragged(place, from, to);
        if response.dragged_by(PointerButton::Primary) {
            let stroke = Stroke::new(1.5, theme::accent_of(ui.visuals()));
            let square = crop::on_screen(place, part.unwrap_or_default());
            ui.painter().rect_stroke(square, 0.0, stroke, StrokeKind::Outside);
            return true;
        }
        self.cropping = None;
        if let Some(part) = part {
            let camera = &mut document.params.camera;
            camera.crop = camera.crop.of(part);
        }
        false
    }

    fn pointer(
        &mut self,
        ui: &Ui,
        response: &Response,
        document: &mut Document,
        place: Rect,
        times: f32,
    ) {
        let [shift, wheel, zoom] = ui.input(|i| {
            [f32::from(u8::from(i.modifiers.shift)), i.smooth_scroll_delta().y, i.zoom_delta()]
        });
        let delta = response.drag_delta();
        let drag = |button| response.dragged_by(button) && delta != Vec2::ZERO;
        if response.drag_started() {
            let origin = ui.input(|i| i.pointer.press_origin());
            let begun = origin.and_then(|at| self.pixel_at(at, place));
            let params = &document.params;
            let surface = begun
                .and_then(|(_, exact)| params.scene.first_hit(&params.camera, params.size, exact));
            self.held = Some(surface.map_or_else(|| document.pivot(), |hit| hit.point));
        }
        let subject = document.subject();
        let pivot = self.held.unwrap_or_else(|| subject.pivot(&document.params.camera));
        let camera = &mut document.params.camera;
        if drag(PointerButton::Middle) || (drag(PointerButton::Primary) && shift > 0.0) {
            let by = delta / place.height().max(1.0);
            *camera = orbit::pan(camera, pivot, -f64::from(by.x), f64::from(by.y));
        } else if drag(PointerButton::Primary) {
            let turn = delta / place.size().max_elem().max(1.0);
            *camera =
                orbit::orbit(camera, pivot, -TURN * f64::from(turn.x), -TURN * f64::from(turn.y));
        } else if drag(PointerButton::Secondary) {
            self.offset += delta;
        }
        let Some(at) = response.hover_pos() else { return };
        if zoom != 1.0 {
            let next = (times * zoom).clamp(0.05, 64.0);
            // Beside the picture its nearest point is held, or it would leave its space.
            let at = place.clamp(at);
            self.offset += (at - place.center()) * (1.0 - next / times);
            self.zoom = Zoom::Times(next);
        } else if wheel != 0.0 {
            let factor = (-f64::from(wheel) / 400.0).exp();
            *camera = orbit::dolly(camera, subject, factor);
        }
        let Some((pixel, exact)) = self.pixel_at(at, place) else { return };
        let grid = self.sides[0].size().unwrap_or_default();
        self.hover =
            self.sides[0].texture.as_ref().and_then(|t| t.pixel(pixel)).map(|(tile, i)| Hover {
                pixel,
                mean: tile.mean[i],
                standard_error: tile.standard_error.get(i).copied(),
                passes: tile.passes,
                samples: tile.samples_of(TileGrid { size: grid }, pixel),
            });
        if response.clicked_by(PointerButton::Primary) {
            let params = &document.params;
            let hit = params.scene.pick(&params.camera, params.size, exact);
            document.pick(hit);
            document.clicked = Some(pixel);
        }
        ui.set_cursor_icon(match (response.dragged(), shift > 0.0) {
            (true, true) => CursorIcon::Move,
            (true, false) => CursorIcon::Grabbing,
            _ => CursorIcon::Crosshair,
        });
    }

    /// The pixel of the picture at a point of the screen, and where in it.
    fn pixel_at(&self, at: Pos2, place: Rect) -> Option<([u32; 2], [f32; 2])> {
        let size = self.sides[0].size()?;
        let t = (at - place.min) / place.size();
        if !(0.0..1.0).contains(&t.x) || !(0.0..1.0).contains(&t.y) {
            return None;
        }
        let exact = [t.x * size[0] as f32, t.y * size[1] as f32];
        let pixel = [0, 1].map(|i| (exact[i] as u32).min(size[i].saturating_sub(1)));
        Some((pixel, exact))
    }
}

/// Pixels stay square and sharp once each covers several of the screen's. Between one and two,
/// "nearest" would draw some rows twice as wide as their neighbours.
fn filter(times: f32) -> TextureOptions {
    let whole = (times - times.round()).abs() < 1e-3;
    if times >= 2.0 || (times >= 1.0 && whole) {
        TextureOptions { minification: egui::TextureFilter::Linear, ..TextureOptions::NEAREST }
    } else {
        TextureOptions::LINEAR
    }
}

/// The arrow and page keys, while the picture has the focus.
fn keyboard(ui: &Ui, response: &Response, document: &mut Document) {
    if !response.has_focus() {
        return;
    }
    // Else the arrows would take the focus to the next widget.
    let filter =
        EventFilter { horizontal_arrows: true, vertical_arrows: true, ..Default::default() };
    ui.memory_mut(|m| m.set_focus_lock_filter(response.id, filter));
    let subject = document.subject();
    let moves: [(Key, [f64; 2]); 4] = [
        (Key::ArrowLeft, [-1.0, 0.0]),
        (Key::ArrowRight, [1.0, 0.0]),
        (Key::ArrowUp, [0.0, 1.0]),
        (Key::ArrowDown, [0.0, -1.0]),
    ];
    // The middle of a material's surfaces is looked for among all shapes: not with every frame.
    let moved = ui.input(|i| moves.iter().any(|(key, _)| i.key_pressed(*key)));
    let pivot = if moved { document.pivot() } else { subject.pivot(&document.params.camera) };
    let mut camera: Camera = document.params.camera;
    ui.input_mut(|input| {
        for (key, [x, y]) in moves {
            for _ in 0..input.count_and_consume_key(Modifiers::SHIFT, key) {
                camera = orbit::pan(&camera, pivot, SHIFT * x, SHIFT * y);
            }
            for _ in 0..input.count_and_consume_key(Modifiers::NONE, key) {
                camera = orbit::orbit(&camera, pivot, STEP * x, -STEP * y);
            }
        }
        for (key, factor) in [(Key::PageUp, 1.0 / 1.1), (Key::PageDown, 1.1)] {
            for _ in 0..input.count_and_consume_key(Modifiers::NONE, key) {
                camera = orbit::dolly(&camera, subject, factor);
            }
        }
    });
    document.params.camera = camera;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn magnified_pixels_are_crisp_and_reduced_ones_smooth() {
        use egui::TextureFilter::{Linear, Nearest};
        for (times, magnified) in
            [(0.3, Linear), (1.0, Nearest), (1.4, Linear), (2.0, Nearest), (7.3, Nearest)]
        {
            let options = filter(times);
            assert_eq!(
                (options.magnification, options.minification),
                (magnified, Linear),
                "{times}"
            );
        }
    }
}
