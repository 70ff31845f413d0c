//! The stability meter: how much of the largest safe step is in use, as a bar and in words.

use egui::{Color32, Rect, Sense, Ui, WidgetInfo, vec2};

use super::figure::length;
use super::theme;
use super::words::capitalised;
use crate::scene::settings::Integrator;
use crate::session::Status;
use crate::session::step_error::{Prediction, StepError};
use crate::session::step_words::{limit_text, step_text};

/// Size of the bar, points.
const BAR: egui::Vec2 = vec2(72.0, 6.0);
/// Rounding errors may put a step this much above the bound that it was computed from.
const TOLERANCE: f64 = 1e-9;

/// Whether the step in use is larger than is safe, or no step is safe.
pub(super) fn is_unsafe(status: &Status) -> bool {
    has_no_safe_step(status)
        || !is_implicit(status) && status.dt_safe_secs > 0.0 && status.dt_secs > status.dt_safe_secs * (1.0 + TOLERANCE)
}

/// Whether the active scheme feeds energy into undamped vibrations at any step.
pub(super) fn has_no_safe_step(status: &Status) -> bool {
    !status.integrator.has_stable_step()
}

/// Whether the implicit integrator is active, whose steps have no limit.
pub(super) fn is_implicit(status: &Status) -> bool {
    status.integrator == Integrator::Implicit
}

/// The largest safe step, in words.
pub(super) fn limit_words(status: &Status) -> String {
    if has_no_safe_step(status) { "none".to_owned() } else { limit_text(status.dt_safe_secs) }
}

/// The bar, with its percentage. Laid out from right to left.
pub(super) fn meter_ui(ui: &mut Ui, status: &Status) {
    let share = share(status);
    let color = color(ui, status);
    let words = words(status);
    let text = match () {
        () if has_no_safe_step(status) => "unstable".to_owned(),
        () if is_implicit(status) => "implicit".to_owned(),
        () => share_text(share),
    };
    theme::figures_ui(ui, &text, "100 %", theme::of(ui).strong).on_hover_text(&words);
    let (rect, response) = ui.allocate_exact_size(vec2(BAR.x, ui.spacing().interact_size.y), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::ProgressIndicator, true, format!("Stability: {words}")));
    let bar = Rect::from_center_size(rect.center(), BAR);
    ui.painter().rect_filled(bar, 3.0, theme::of(ui).rail);
    #[expect(clippy::cast_possible_truncation, reason = "a share of a width")]
    let filled = bar.width() * share.clamp(0.0, 1.0) as f32;
    ui.painter().rect_filled(Rect::from_min_size(bar.min, vec2(filled, bar.height())), 3.0, color);
    response.on_hover_text(words);
}

/// The error of the steps, beside the bar. Laid out from right to left.
pub(super) fn error_ui(ui: &mut Ui, status: &Status) {
    let text = match &status.step_error {
        StepError::Found(found) if found.is_rounding => format!("< {}", about(found)),
        StepError::Found(found) => format!("± {}", about(found)),
        StepError::Unknown | StepError::TooExpensive | StepError::Breaks => "± –".to_owned(),
    };
    let response = theme::figures_ui(ui, &text, "± 0.00 mm", theme::of(ui).strong);
    let (words, how) = (error_words(status), how_words(status));
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, &words));
    response.on_hover_text(format!("{}.{how}", capitalised(&words)));
}

/// The error of the steps, as words without a full stop.
pub(super) fn error_words(status: &Status) -> String {
    match &status.step_error {
        StepError::Found(found) if found.is_rounding => {
            format!("step error below {} in {:.1} s: no more than rounding", about(found), found.ahead_secs)
        }
        StepError::Found(found) => format!("step error about {} in {:.1} s", about(found), found.ahead_secs),
        StepError::TooExpensive => "step error not estimated: it would be too much work".to_owned(),
        StepError::Breaks => "step error not estimated: the motion breaks".to_owned(),
        StepError::Unknown if status.at_rest => "no step error: nothing moves".to_owned(),
        StepError::Unknown if !status.playing => "step error not estimated while time stands still".to_owned(),
        StepError::Unknown => "step error not estimated yet".to_owned(),
    }
}

/// How the error was found.
fn how_words(status: &Status) -> String {
    let StepError::Found(found) = &status.step_error else { return String::new() };
    let Prediction { difference_m, order, from_secs, ahead_secs, dt_secs, .. } = found;
    let ordinal = ["first", "second", "third", "fourth"][(*order as usize - 1).min(3)];
    format!(
        "\nFrom {from_secs:.2} s on, a copy of the scene went on for {ahead_secs:.1} s with steps of {}, another one with \
         half of that. They came {} apart (RMS of all particles); for a scheme of {ordinal} order the first one is this far \
         from the truth.",
        step_text(*dt_secs),
        length(*difference_m)
    )
}

/// An error in one or two digits, which is as well as it is known.
fn about(found: &Prediction) -> String {
    let meters = found.error_m.max(1e-12);
    let scale = 10_f64.powf(1.0 - meters.log10().floor());
    length((meters * scale).round() / scale)
}

/// Red if no step is safe, a warning if this one is not.
fn color(ui: &Ui, status: &Status) -> Color32 {
    let colors = theme::of(ui);
    match () {
        () if has_no_safe_step(status) => colors.error,
        () if is_unsafe(status) => colors.warning,
        () => colors.good,
    }
}

/// The step in use as a fraction of the largest safe one: 0 if nothing limits it, 1 if no step is safe.
fn share(status: &Status) -> f64 {
    if has_no_safe_step(status) {
        return 1.0;
    }
    let share = status.dt_secs / status.dt_safe_secs;
    if is_implicit(status) {
        return 0.0;
    }
    if share.is_finite() && share > 0.0 { share } else { 0.0 }
}

fn share_text(share: f64) -> String {
    if share < 9.995 { format!("{:.0} %", share * 100.0) } else { format!("{:.0}×", share.min(9999.0)) }
}

/// The meter as a sentence.
fn words(status: &Status) -> String {
    let step = step_text(status.dt_secs);
    if has_no_safe_step(status) {
        let scheme = status.integrator.words();
        return format!("a step of {step}, and no step is safe: undamped vibrations grow with {scheme} at any step");
    }
    if is_implicit(status) && status.dt_safe_secs.is_finite() {
        let (explicit, whose) = (limit_text(status.dt_safe_secs), &status.dt_limited_by);
        return format!(
            "a step of {step} of the implicit integrator, which has taken over: {whose} would allow others {explicit}"
        );
    }
    if share(status) == 0.0 {
        return format!("a step of {step}; nothing limits it");
    }
    let of = share_text(share(status));
    let bound = limit_text(status.dt_safe_secs);
    let whose = if status.dt_limited_by.is_empty() { "links and contacts" } else { &status.dt_limited_by };
    let advice = if is_unsafe(status) { ": it may explode" } else { "" };
    format!("a step of {step}, {of} of the {bound} that are safe{advice}; limited by {whose}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn status(dt_secs: f64, dt_safe_secs: f64) -> Status {
        Status { dt_secs, dt_safe_secs, dt_limited_by: "shear stiffness".into(), ..Status::default() }
    }

    #[test]
    fn the_words_say_step_bound_share_and_cause() {
        let words = |dt, safe| words(&status(dt, safe));
        let calm = "a step of 1.00 ms, 29 % of the 3.40 ms that are safe; limited by shear stiffness";
        assert_eq!(words(0.001, 0.003_4), calm);
        let wild = "a step of 1.00 ms, 200 % of the 0.500 ms that are safe: it may explode; limited by shear stiffness";
        assert_eq!(words(0.001, 0.000_5), wild);
        assert_eq!(words(0.001, f64::INFINITY), "a step of 1.00 ms; nothing limits it");
    }

    #[test]
    fn an_implicit_step_is_safe_and_says_what_it_replaces() {
        let taken_over = Status { integrator: Integrator::Implicit, ..status(0.004, 2e-5) };
        assert!(!is_unsafe(&taken_over), "nothing limits it");
        let words = words(&taken_over);
        assert!(
            words.contains("implicit") && words.contains("shear stiffness") && words.contains("20.0 µs"),
            "{words}"
        );
    }

    #[test]
    fn a_scheme_without_a_stable_step_is_unsafe_at_any_step() {
        let explicit = Status { integrator: Integrator::Explicit, ..status(1e-5, 0.001) };
        assert!(is_unsafe(&explicit) && share(&explicit) >= 1.0, "a full red bar");
        let words = words(&explicit);
        assert!(words.contains("no step is safe: undamped vibrations grow with explicit Euler"), "{words}");
    }

    #[test]
    fn the_error_is_told_with_how_it_was_found() {
        let found = Prediction {
            error_m: 2.134e-4,
            is_rounding: false,
            difference_m: 1.067e-4,
            order: 1,
            from_secs: 1.5,
            ahead_secs: 0.1,
            dt_secs: 1e-3,
        };
        let with = |step_error| Status { step_error, ..status(0.001, 0.002) };
        let known = with(StepError::Found(found));
        assert_eq!(error_words(&known), "step error about 210 µm in 0.1 s");
        let how = how_words(&known);
        assert!(how.contains("first order") && how.contains("107 µm apart") && how.contains("1.00 ms"), "{how}");
        let rounding = with(StepError::Found(Prediction { error_m: 2e-5, is_rounding: true, ..found }));
        assert_eq!(error_words(&rounding), "step error below 20 µm in 0.1 s: no more than rounding");
        assert!(error_words(&with(StepError::TooExpensive)).contains("too much work"), "it says why not");
        assert!(error_words(&Status { at_rest: true, ..Status::default() }).contains("nothing moves"), "at rest");
        assert_eq!(how_words(&with(StepError::Unknown)), "", "nothing was found");
    }

    #[test]
    fn a_share_stays_short_however_large() {
        for (share, text) in [(0.0, "0 %"), (0.294, "29 %"), (1.4, "140 %"), (25.0, "25×"), (1e9, "9999×")] {
            assert_eq!(share_text(share), text);
        }
    }

    #[test]
    fn a_step_as_large_as_its_bound_is_safe_and_a_larger_one_is_not() {
        assert!(!is_unsafe(&status(0.001, 0.001)), "just safe");
        assert!(is_unsafe(&status(0.001_1, 0.001)), "too large");
        assert!(!is_unsafe(&Status::default()), "no simulation yet");
    }
}
