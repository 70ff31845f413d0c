//! The picture of a model in its cells: its contents, its view, and the texture into which the window has drawn it.

use std::sync::Arc;

use egui::{Color32, Rect, Sense, TextureId, Ui, Vec2, pos2};

use crate::app::ui::figure::fixed_figure;
use crate::app::ui::theme;
use crate::extract::model_picture::{JOINED_COLOR, ModelPicture, THIN_AND_JOINED_COLOR, THIN_COLOR};
use crate::session::jellify::Preview;
use crate::view::{DrawList, Orbit, Style};

/// The turn per point of a drag, radians.
const TURN: f32 = 0.01;

/// The height of a line of the key to the colours, points.
const KEY_HEIGHT: f32 = 16.0;

/// A picture that the window is to draw.
#[derive(Debug)]
pub struct InsetRequest {
    /// The contents of the picture.
    pub draw_list: DrawList,
    /// Width and height, pixels.
    pub size: [u32; 2],
}

/// The picture of a model in its cells.
#[derive(Debug, Default)]
pub(super) struct Inset {
    /// The model, and the orbit from which it is seen.
    of: Option<(Arc<ModelPicture>, Orbit)>,
    shows_cells: bool,
    /// What the texture shows, or will show.
    requested: Option<PictureKey>,
    request: Option<InsetRequest>,
    texture: Option<TextureId>,
}

/// The properties that distinguish one picture from another.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PictureKey {
    orbit: Orbit,
    cells: bool,
    size: [u32; 2],
    is_dark: bool,
}

impl Inset {
    /// Takes the picture that the window is to draw, if any.
    pub(super) fn take_request(&mut self) -> Option<InsetRequest> {
        self.request.take()
    }

    /// Whether the window is to draw a picture.
    pub(super) fn has_request(&self) -> bool {
        self.request.is_some()
    }

    /// Sets the texture drawn by the window; `None` if the window has lost it.
    pub(super) fn drawn(&mut self, texture: Option<TextureId>) {
        self.texture = texture;
        if texture.is_none() {
            self.requested = None;
        }
    }

    /// The picture in a given size, with the key to its colours below it.
    pub(super) fn ui(&mut self, ui: &mut Ui, picture: &Arc<ModelPicture>, preview: &Preview, size: Vec2) {
        let (rect, response) = ui.allocate_exact_size(size, Sense::drag());
        let label = "The model and its cells; drag to turn";
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, label));
        let orbit = match &mut self.of {
            Some((of, orbit)) if Arc::ptr_eq(of, picture) => orbit,
            of => {
                self.requested = None;
                let turned = of.as_ref().map_or_else(Orbit::default, |(_, orbit)| *orbit);
                let orbit = picture.framed(turned, size.x / size.y);
                &mut of.insert((Arc::clone(picture), orbit)).1
            }
        };
        let drag = response.drag_delta() * TURN;
        if drag != Vec2::ZERO {
            orbit.orbit(-drag.x, drag.y);
        }
        let points = ui.ctx().pixels_per_point();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few hundred")]
        let pixels = [size.x, size.y].map(|side| (side * points).round().max(1.0) as u32);
        let key = PictureKey { orbit: *orbit, cells: self.shows_cells, size: pixels, is_dark: ui.visuals().dark_mode };
        if self.requested != Some(key) {
            self.requested = Some(key);
            let style = if key.is_dark { Style::dark() } else { Style::light() };
            let draw_list = picture.draw_list(orbit, style, key.cells, points);
            self.request = Some(InsetRequest { draw_list, size: pixels });
        }
        match self.texture {
            Some(texture) => {
                let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
                ui.painter().image(texture, rect, whole, Color32::WHITE);
            }
            None => {
                ui.painter().rect_filled(rect, 4.0, ui.visuals().extreme_bg_color);
            }
        }
        (ui.spacing_mut().interact_size.y, ui.spacing_mut().item_spacing.y) = (KEY_HEIGHT, 4.0);
        let percent = |share: f64| format!("{} %", fixed_figure(100.0 * share, 0));
        key_ui(ui, THIN_COLOR, &format!("thinner than a cell: {}", percent(preview.thin_share)))
            .on_hover_text("It becomes a cell thick, and bends less than it should");
        key_ui(ui, JOINED_COLOR, &format!("moves as one with what is near: {}", percent(preview.joined_share)))
            .on_hover_text("A part or a fold nearer than a cell: cells hold both. More divisions tell them apart");
        if preview.thin_share > 0.0 && preview.joined_share > 0.0 {
            key_ui(ui, THIN_AND_JOINED_COLOR, "both");
        }
        ui.checkbox(&mut self.shows_cells, "Cells").on_hover_text("Slopes become steps of cells");
    }
}

/// A colour and its meaning.
fn key_ui(ui: &mut Ui, [red, green, blue]: [u8; 3], words: &str) -> egui::Response {
    let row = ui.horizontal(|ui| {
        let (rect, _) = ui.allocate_exact_size(Vec2::splat(10.0), Sense::hover());
        ui.painter().rect_filled(rect, 2.0, Color32::from_rgb(red, green, blue));
        ui.label(egui::RichText::new(words).color(theme::of(ui).weak).small());
    });
    row.response
}
