//! How the interface looks: a neutral dark theme with one accent, a real interface font, and figures that stand still
//! while they change. Knows nothing of what the panels say.

use std::sync::Arc;

use egui::epaint::{CornerRadius, Shadow};
use egui::{
    Color32, Context, FontData, FontDefinitions, FontFamily, FontId, Margin, Response, Sense, Stroke, TextStyle, Theme,
    Ui, Vec2, Visuals, WidgetInfo, vec2,
};

/// The body size of text, points.
pub const TEXT_SIZE: f32 = 13.5;
/// What a person is to look at: what is chosen, what runs.
pub const ACCENT: Color32 = Color32::from_rgb(94, 160, 255);
/// All is well; told from [`WARNING`] by lightness too, not by hue alone.
pub const GOOD: Color32 = Color32::from_rgb(120, 190, 235);
/// Something deserves a look.
pub const WARNING: Color32 = Color32::from_rgb(245, 190, 80);
/// Something went wrong.
pub const ERROR: Color32 = Color32::from_rgb(255, 140, 120);
/// Numbers and what is chosen.
pub const STRONG: Color32 = Color32::from_gray(238);
/// Names of numbers, units, what stands beside.
pub const WEAK: Color32 = Color32::from_gray(158);

const TEXT: Color32 = Color32::from_gray(208);
const PANEL: Color32 = Color32::from_rgb(27, 29, 33);
const FLOAT: Color32 = Color32::from_rgb(33, 35, 40);
const LINE: Color32 = Color32::from_rgb(52, 55, 62);
const WIDGET: Color32 = Color32::from_rgb(45, 48, 54);
const WIDGET_HOVERED: Color32 = Color32::from_rgb(58, 62, 70);
const WIDGET_ACTIVE: Color32 = Color32::from_rgb(70, 75, 85);

/// Gives a context this look.
pub fn apply(context: &Context) {
    context.set_fonts(fonts());
    context.set_theme(Theme::Dark);
    context.all_styles_mut(|style| {
        style.visuals = visuals();
        style.text_styles = [
            (TextStyle::Small, 11.5),
            (TextStyle::Body, TEXT_SIZE),
            (TextStyle::Button, TEXT_SIZE),
            (TextStyle::Heading, 17.0),
            (TextStyle::Monospace, 13.0),
        ]
        .into_iter()
        .map(|(style, size)| {
            let family = if style == TextStyle::Monospace { FontFamily::Monospace } else { FontFamily::Proportional };
            (style, FontId::new(size, family))
        })
        .collect();
        style.spacing.item_spacing = vec2(8.0, 6.0);
        style.spacing.button_padding = vec2(9.0, 4.0);
        style.spacing.interact_size = vec2(40.0, 26.0);
        style.spacing.menu_margin = Margin::same(6);
        style.spacing.window_margin = Margin::same(14);
        style.interaction.selectable_labels = false;
        style.interaction.tooltip_delay = 0.4;
    });
}

/// The frame of what floats over the view.
pub fn float_frame() -> egui::Frame {
    egui::Frame::new()
        .fill(FLOAT.gamma_multiply(0.94))
        .stroke(Stroke::new(1.0, LINE))
        .corner_radius(CornerRadius::same(7))
        .inner_margin(Margin::symmetric(12, 10))
}

/// The frame of a bar along an edge of the window.
pub fn bar_frame() -> egui::Frame {
    egui::Frame::new().fill(PANEL).inner_margin(Margin::symmetric(12, 7))
}

/// A number in figures of equal width, so that nothing jitters while it changes. `widest` is a text that is as wide
/// as the number will get: the space is kept for it, and the number stands at its right end.
pub fn figures_ui(ui: &mut Ui, text: &str, widest: &str, color: Color32) -> Response {
    let font = TextStyle::Body.resolve(ui.style());
    let cell = ('0'..='9').map(|digit| glyph_width(ui, &font, digit)).fold(0.0, f32::max);
    let width_of = |ui: &Ui, text: &str| {
        text.chars().map(|letter| if letter.is_ascii_digit() { cell } else { glyph_width(ui, &font, letter) }).sum()
    };
    let own: f32 = width_of(ui, text);
    let kept: f32 = width_of(ui, widest);
    let height = ui.fonts_mut(|fonts| fonts.row_height(&font));
    let (rect, response) = ui.allocate_exact_size(vec2(own.max(kept).ceil(), height), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, ui.is_enabled(), text));
    let mut pen = rect.right_top() - vec2(own, 0.0);
    for letter in text.chars() {
        let galley = ui.painter().layout_no_wrap(letter.to_string(), font.clone(), color);
        let glyph = galley.size().x;
        let room = if letter.is_ascii_digit() { cell } else { glyph_width(ui, &font, letter) };
        ui.painter().galley(pen + vec2(0.5 * (room - glyph), 0.0), galley, color);
        pen.x += room;
    }
    response
}

/// A filled dot in the middle of a line.
pub fn dot_ui(ui: &mut Ui, color: Color32) {
    let (rect, _) = ui.allocate_exact_size(Vec2::splat(9.0), Sense::hover());
    ui.painter().circle_filled(rect.center(), 4.0, color);
}

fn glyph_width(ui: &Ui, font: &FontId, letter: char) -> f32 {
    ui.fonts_mut(|fonts| fonts.glyph_width(font, letter))
}

fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::default();
    let inter = FontData::from_static(include_bytes!("../../assets/fonts/Inter-Regular.otf"));
    fonts.font_data.insert("Inter".to_owned(), Arc::new(inter));
    fonts.families.entry(FontFamily::Proportional).or_default().insert(0, "Inter".to_owned());
    fonts
}

fn visuals() -> Visuals {
    let mut visuals = Visuals::dark();
    visuals.panel_fill = PANEL;
    visuals.window_fill = FLOAT;
    visuals.window_stroke = Stroke::new(1.0, LINE);
    visuals.window_corner_radius = CornerRadius::same(9);
    visuals.menu_corner_radius = CornerRadius::same(7);
    visuals.extreme_bg_color = Color32::from_rgb(20, 21, 24);
    visuals.weak_text_color = Some(WEAK);
    visuals.selection.bg_fill = ACCENT.gamma_multiply(0.35);
    visuals.selection.stroke = Stroke::new(1.0, STRONG);
    visuals.hyperlink_color = ACCENT;
    visuals.warn_fg_color = WARNING;
    visuals.error_fg_color = ERROR;
    let shadow = Shadow { offset: [0, 4], blur: 16, spread: 0, color: Color32::from_black_alpha(110) };
    visuals.window_shadow = shadow;
    visuals.popup_shadow = shadow;
    let widgets = &mut visuals.widgets;
    for (widget, fill, text) in [
        (&mut widgets.noninteractive, PANEL, TEXT),
        (&mut widgets.inactive, WIDGET, TEXT),
        (&mut widgets.hovered, WIDGET_HOVERED, STRONG),
        (&mut widgets.active, WIDGET_ACTIVE, STRONG),
        (&mut widgets.open, WIDGET_HOVERED, STRONG),
    ] {
        widget.bg_fill = fill;
        widget.weak_bg_fill = fill;
        widget.bg_stroke = Stroke::NONE;
        widget.fg_stroke = Stroke::new(1.0, text);
        widget.corner_radius = CornerRadius::same(5);
        widget.expansion = 0.0;
    }
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, LINE);
    visuals
}
