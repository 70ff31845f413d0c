//! Buttons with drawn icons: sharp at any scale, without the need for a font.

use egui::{Color32, Pos2, Rect, Response, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo, pos2, vec2};

use super::theme;

/// An icon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Icon {
    /// Let time run.
    Play,
    /// Stop time.
    Pause,
    /// One step.
    Step,
    /// Back to the start.
    Restart,
    /// Show everything.
    Frame,
    /// The list of keys.
    Help,
    /// Close.
    Close,
    /// The thing is drawn.
    Eye,
    /// The thing is not drawn.
    EyeClosed,
    /// The body has fallen out of the scene.
    Gone,
    /// Undo.
    Undo,
    /// Redo.
    Redo,
}

/// A button with an icon and a name for screen readers; its tooltip has the name and the key.
pub(super) fn icon_button_ui(ui: &mut Ui, icon: Icon, name: &str, key: &str, enabled: bool) -> Response {
    let response = sign_ui(ui, icon, name, Vec2::new(32.0, 26.0), enabled);
    if key.is_empty() { response.on_hover_text(name) } else { response.on_hover_text(format!("{name}  ({key})")) }
}

/// A button for a row of a list: an icon without a background; its tooltip says what it does.
pub(super) fn small_button_ui(ui: &mut Ui, icon: Icon, name: &str, help: &str) -> Response {
    let ground = ui.visuals().widgets.inactive.weak_bg_fill;
    ui.visuals_mut().widgets.inactive.weak_bg_fill = Color32::TRANSPARENT;
    let response = sign_ui(ui, icon, name, Vec2::new(24.0, 22.0), true);
    ui.visuals_mut().widgets.inactive.weak_bg_fill = ground;
    response.on_hover_text(help)
}

fn sign_ui(ui: &mut Ui, icon: Icon, name: &str, size: Vec2, enabled: bool) -> Response {
    let sense = if enabled { Sense::click() } else { Sense::hover() };
    let (rect, response) = ui.allocate_exact_size(size, sense);
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, enabled && ui.is_enabled(), name));
    let visuals = ui.style().interact(&response);
    let color = match (enabled, icon) {
        (false, _) => theme::of(ui).weak.gamma_multiply(0.45),
        (true, Icon::Play) => theme::of(ui).accent,
        (true, _) => visuals.fg_stroke.color,
    };
    ui.painter().rect_filled(
        rect,
        visuals.corner_radius,
        if enabled { visuals.weak_bg_fill } else { Color32::TRANSPARENT },
    );
    if response.has_focus() {
        let outline = Stroke::new(1.5, theme::of(ui).accent);
        ui.painter().rect_stroke(rect, visuals.corner_radius, outline, egui::StrokeKind::Inside);
    }
    ui.painter().extend(shapes(icon, rect.center(), color));
    response
}

fn shapes(icon: Icon, center: Pos2, color: Color32) -> Vec<Shape> {
    let at = |x: f32, y: f32| center + vec2(x, y);
    let bar = |x: f32| Shape::rect_filled(Rect::from_center_size(at(x, 0.0), vec2(3.0, 11.0)), 0.5, color);
    let triangle = |x: f32, width: f32| {
        let points = vec![at(x, -5.5), at(x + width, 0.0), at(x, 5.5)];
        Shape::convex_polygon(points, color, Stroke::NONE)
    };
    let line = |from: Pos2, to: Pos2| Shape::line_segment([from, to], Stroke::new(1.6, color));
    match icon {
        Icon::Play => vec![triangle(-3.5, 9.5)],
        Icon::Pause => vec![bar(-3.0), bar(3.0)],
        Icon::Step => vec![triangle(-5.5, 8.5), bar(4.5)],
        Icon::Restart => vec![bar(-4.5), triangle(5.5, -8.5)],
        Icon::Frame => {
            let corner = |sx: f32, sy: f32| {
                let points = vec![at(6.0 * sx, 2.5 * sy), at(6.0 * sx, 5.5 * sy), at(2.5 * sx, 5.5 * sy)];
                Shape::line(points, Stroke::new(1.6, color))
            };
            vec![corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, 1.0), corner(-1.0, -1.0)]
        }
        Icon::Help => {
            let hook = (0..=12).map(|step| {
                let angle = std::f32::consts::PI * (1.0 - 1.5 * step as f32 / 12.0);
                pos2(center.x + 3.2 * angle.cos(), center.y - 2.2 - 3.2 * angle.sin())
            });
            let hook: Vec<Pos2> = hook.chain([at(0.0, 2.6)]).collect();
            vec![Shape::line(hook, Stroke::new(1.6, color)), Shape::circle_filled(at(0.0, 5.4), 1.2, color)]
        }
        Icon::Eye => {
            let lid = |side: f32| {
                let arc = (0..=8).map(|step| {
                    let x = step as f32 / 4.0 - 1.0;
                    at(7.0 * x, side * 4.2 * (1.0 - x * x))
                });
                Shape::line(arc.collect(), Stroke::new(1.4, color))
            };
            vec![lid(1.0), lid(-1.0), Shape::circle_filled(at(0.0, 0.0), 2.2, color)]
        }
        Icon::EyeClosed => {
            let faint = color.gamma_multiply(0.5);
            let lid = (0..=8).map(|step| {
                let x = step as f32 / 4.0 - 1.0;
                at(7.0 * x, 3.0 * (1.0 - x * x))
            });
            vec![Shape::line(lid.collect(), Stroke::new(1.4, faint))]
        }
        Icon::Gone => {
            // An arrow that falls past an edge.
            let tip = vec![at(-3.8, 1.2), at(3.8, 1.2), at(0.0, 6.0)];
            let edge = |side: f32| line(at(7.0 * side, -2.6), at(3.0 * side, -2.6));
            let shaft = line(at(0.0, -6.0), at(0.0, 2.0));
            vec![edge(-1.0), edge(1.0), shaft, Shape::convex_polygon(tip, color, Stroke::NONE)]
        }
        Icon::Undo | Icon::Redo => {
            let side = if icon == Icon::Undo { 1.0 } else { -1.0 };
            let bow = (0..=10).map(|step| {
                let angle = std::f32::consts::PI * (0.5 - step as f32 / 10.0);
                at(side * (1.0 + 4.5 * angle.cos()), 0.8 - 4.5 * angle.sin())
            });
            let bow: Vec<Pos2> = [at(-4.0 * side, -3.7)].into_iter().chain(bow.rev()).collect();
            let tip = vec![at(-6.5 * side, -3.7), at(-2.0 * side, -7.0), at(-2.0 * side, -0.4)];
            let tail = line(at(1.0 * side, 5.3), at(-3.0 * side, 5.3));
            let mut shapes = vec![Shape::convex_polygon(tip, color, Stroke::NONE), tail];
            shapes.extend(bow.windows(2).map(|pair| line(pair[0], pair[1])));
            shapes
        }
        Icon::Close => vec![line(at(-4.0, -4.0), at(4.0, 4.0)), line(at(-4.0, 4.0), at(4.0, -4.0))],
    }
}
