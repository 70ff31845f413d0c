//! The look of the interface: a neutral dark theme and a light one with one accent, a real interface font, and numbers that
//! do not jitter while they change. Knows nothing of the contents of panels.

use std::sync::Arc;

use egui::epaint::{CornerRadius, Shadow};
use egui::{
    Color32, Context, FontData, FontDefinitions, FontFamily, FontId, Margin, Response, Sense, Stroke, TextStyle, Ui,
    Vec2, Visuals, WidgetInfo, vec2,
};
use serde::{Deserialize, Serialize};

use crate::view::Style;

/// The body size of text, points.
pub const TEXT_SIZE: f32 = 13.5;

/// The room for a scroll bar beside scrolled contents, so that the bar covers nothing, points.
pub const SCROLL_BAR: f32 = 10.0;

/// The width of the edge by which a panel is resized, points.
pub const GRIP: f32 = 6.0;

/// A side of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Left of the view.
    Left,
    /// Right of the view.
    Right,
}

/// The colours of the interface and the view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Theme {
    /// Light text on dark grey.
    #[default]
    Dark,
    /// Dark text on light grey: for bright rooms and projectors.
    Light,
}

impl Theme {
    /// The colours of the view.
    pub fn style(self) -> Style {
        match self {
            Self::Dark => Style::dark(),
            Self::Light => Style::light(),
        }
    }
}

/// The colours of the interface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Palette {
    /// What a person is to look at: selected or running things.
    pub accent: Color32,
    /// All is well. Differs from `warning` in lightness too, not in hue alone.
    pub good: Color32,
    /// Something deserves a look.
    pub warning: Color32,
    /// Something went wrong.
    pub error: Color32,
    /// Numbers and selected things.
    pub strong: Color32,
    /// Plain text.
    pub text: Color32,
    /// Names of numbers, units, remarks.
    pub weak: Color32,
    /// Panels and bars.
    pub panel: Color32,
    /// Cards over the view.
    pub float: Color32,
    /// Fields to type in.
    pub field: Color32,
    /// Lines between things.
    pub line: Color32,
    /// The rail that a slider or a meter runs along.
    pub rail: Color32,
    /// Buttons: at rest, under the pointer, pressed.
    pub widget: [Color32; 3],
    /// How dark the shadow of a card is, 0 to 255.
    pub shadow: u8,
}

const DARK: Palette = Palette {
    accent: Color32::from_rgb(94, 160, 255),
    good: Color32::from_rgb(120, 190, 235),
    warning: Color32::from_rgb(245, 190, 80),
    error: Color32::from_rgb(255, 140, 120),
    strong: Color32::from_gray(238),
    text: Color32::from_gray(208),
    weak: Color32::from_gray(158),
    panel: Color32::from_rgb(27, 29, 33),
    float: Color32::from_rgb(33, 35, 40),
    field: Color32::from_rgb(20, 21, 24),
    line: Color32::from_rgb(52, 55, 62),
    rail: Color32::from_rgb(58, 62, 70),
    widget: [Color32::from_rgb(45, 48, 54), Color32::from_rgb(58, 62, 70), Color32::from_rgb(70, 75, 85)],
    shadow: 110,
};

const LIGHT: Palette = Palette {
    accent: Color32::from_rgb(24, 98, 205),
    good: Color32::from_rgb(10, 92, 150),
    warning: Color32::from_rgb(150, 86, 0),
    error: Color32::from_rgb(180, 38, 24),
    strong: Color32::from_gray(18),
    text: Color32::from_gray(48),
    weak: Color32::from_gray(92),
    panel: Color32::from_rgb(243, 244, 246),
    float: Color32::from_rgb(252, 252, 253),
    field: Color32::from_rgb(255, 255, 255),
    line: Color32::from_rgb(205, 209, 216),
    rail: Color32::from_rgb(202, 206, 214),
    widget: [Color32::from_rgb(224, 227, 232), Color32::from_rgb(211, 215, 222), Color32::from_rgb(196, 201, 210)],
    shadow: 45,
};

/// Gives a context both themes.
pub fn apply(context: &Context) {
    context.set_fonts(fonts());
    context.set_theme(egui_theme(Theme::default()));
    for (theme, palette) in [(egui::Theme::Dark, &DARK), (egui::Theme::Light, &LIGHT)] {
        context.style_mut_of(theme, |style| {
            style.visuals = visuals(theme, palette);
            style.text_styles = [
                (TextStyle::Small, 11.5),
                (TextStyle::Body, TEXT_SIZE),
                (TextStyle::Button, TEXT_SIZE),
                (TextStyle::Heading, 17.0),
                (TextStyle::Monospace, 13.0),
            ]
            .into_iter()
            .map(|(style, size)| {
                let monospace = style == TextStyle::Monospace;
                let family = if monospace { FontFamily::Monospace } else { FontFamily::Proportional };
                (style, FontId::new(size, family))
            })
            .collect();
            style.spacing.item_spacing = vec2(8.0, 6.0);
            style.spacing.button_padding = vec2(9.0, 4.0);
            style.spacing.interact_size = vec2(40.0, 26.0);
            // High enough for the longest list of this program.
            style.spacing.combo_height = 420.0;
            style.spacing.menu_margin = Margin::same(6);
            style.spacing.window_margin = Margin::same(14);
            // An open list is as high as it needs and the window allows: the default of 400 points hides the ends of lists.
            style.spacing.default_area_size = vec2(600.0, 4000.0);
            style.interaction.selectable_labels = false;
            style.interaction.tooltip_delay = 0.4;
        });
    }
}

/// Switches a root panel, and everything drawn after it, to one of the themes.
pub fn choose(ui: &mut Ui, theme: Theme) {
    let theme = egui_theme(theme);
    if ui.ctx().theme() != theme {
        ui.ctx().set_theme(theme);
        ui.reset_style();
    }
}

/// The colours of the theme in which a panel is drawn.
pub fn of(ui: &Ui) -> &'static Palette {
    if ui.visuals().dark_mode { &DARK } else { &LIGHT }
}

/// The frame of a card over the view.
pub fn float_frame(ui: &Ui) -> egui::Frame {
    let palette = of(ui);
    egui::Frame::new()
        .fill(palette.float.gamma_multiply(0.94))
        .stroke(Stroke::new(1.0, palette.line))
        .corner_radius(CornerRadius::same(7))
        .inner_margin(Margin::symmetric(12, 10))
}

/// The frame of a bar along an edge of the window.
pub fn bar_frame(ui: &Ui) -> egui::Frame {
    egui::Frame::new().fill(of(ui).panel).inner_margin(Margin::symmetric(12, 7))
}

/// The frame of a panel at a side of the window. Scrolled contents leave [`SCROLL_BAR`] free on the right; on the side of
/// the view there is room for the [`GRIP`].
pub fn side_frame(ui: &Ui, side: Side) -> egui::Frame {
    let right = match side {
        Side::Left => 6,
        Side::Right => 2,
    };
    bar_frame(ui).inner_margin(Margin { left: 12, right, top: 7, bottom: 7 })
}

/// A number in digits of equal width, so that nothing jitters while it changes. `widest` is a text as wide as the number
/// will get: its width is reserved, and the number stands at the right end.
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

fn egui_theme(theme: Theme) -> egui::Theme {
    match theme {
        Theme::Dark => egui::Theme::Dark,
        Theme::Light => egui::Theme::Light,
    }
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

fn visuals(theme: egui::Theme, palette: &Palette) -> Visuals {
    let mut visuals = theme.default_visuals();
    visuals.panel_fill = palette.panel;
    visuals.window_fill = palette.float;
    visuals.window_stroke = Stroke::new(1.0, palette.line);
    visuals.window_corner_radius = CornerRadius::same(9);
    visuals.menu_corner_radius = CornerRadius::same(7);
    visuals.extreme_bg_color = palette.field;
    visuals.weak_text_color = Some(palette.weak);
    visuals.selection.bg_fill = palette.accent.gamma_multiply(0.35);
    visuals.selection.stroke = Stroke::new(1.0, palette.strong);
    visuals.hyperlink_color = palette.accent;
    visuals.warn_fg_color = palette.warning;
    visuals.error_fg_color = palette.error;
    let color = Color32::from_black_alpha(palette.shadow);
    let shadow = Shadow { offset: [0, 4], blur: 16, spread: 0, color };
    visuals.window_shadow = shadow;
    visuals.popup_shadow = shadow;
    let [rest, hovered, active] = palette.widget;
    let widgets = &mut visuals.widgets;
    for (widget, fill, text) in [
        (&mut widgets.noninteractive, palette.panel, palette.text),
        (&mut widgets.inactive, rest, palette.text),
        (&mut widgets.hovered, hovered, palette.strong),
        (&mut widgets.active, active, palette.strong),
        (&mut widgets.open, hovered, palette.strong),
    ] {
        // The boxes of check marks are filled with the first, buttons with the second.
        widget.bg_fill = if fill == rest { palette.rail } else { fill };
        widget.weak_bg_fill = fill;
        widget.bg_stroke = Stroke::NONE;
        widget.fg_stroke = Stroke::new(1.0, text);
        widget.corner_radius = CornerRadius::same(5);
        widget.expansion = 0.0;
    }
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, palette.line);
    visuals
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance, 0 black to 1 white (WCAG 2).
    fn luminance(color: Color32) -> f64 {
        let linear = |channel: u8| {
            let share = f64::from(channel) / 255.0;
            if share <= 0.040_45 { share / 12.92 } else { ((share + 0.055) / 1.055).powf(2.4) }
        };
        0.212_6 * linear(color.r()) + 0.715_2 * linear(color.g()) + 0.072_2 * linear(color.b())
    }

    fn contrast(a: Color32, b: Color32) -> f64 {
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn every_text_can_be_read_on_what_lies_behind_it() {
        for (name, palette) in [("dark", &DARK), ("light", &LIGHT)] {
            let texts = [
                palette.accent,
                palette.good,
                palette.warning,
                palette.error,
                palette.strong,
                palette.text,
                palette.weak,
            ];
            for (place, text) in texts.into_iter().enumerate() {
                for behind in [palette.panel, palette.float, palette.field] {
                    let contrast = contrast(text, behind);
                    assert!(contrast >= 4.5, "{name} text {place} on {behind:?}: {contrast:.2}");
                }
            }
            for (widget, text) in palette.widget.into_iter().zip([palette.text, palette.strong, palette.strong]) {
                assert!(contrast(text, widget) >= 4.5, "{name} buttons are legible");
            }
        }
    }

    #[test]
    fn contrast_is_that_of_the_definition() {
        assert!((contrast(Color32::BLACK, Color32::WHITE) - 21.0).abs() < 1e-9, "black on white");
        assert!(contrast(Color32::GRAY, Color32::GRAY) < 1.001, "grey on itself cannot be read");
    }

    #[test]
    fn good_and_bad_differ_in_lightness_not_only_in_hue() {
        for palette in [&DARK, &LIGHT] {
            assert!(contrast(palette.good, palette.warning) > 1.1, "good and warning");
        }
    }
}
