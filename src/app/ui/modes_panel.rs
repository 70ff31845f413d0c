//! The modes panel: how a body swings about rest. Sliders move the body by its modes in the view; a button lets one mode
//! swing. The modes are computed elsewhere, at a person's request.

use std::sync::Arc;

use egui::{Grid, Label, RichText, ScrollArea, Slider, Ui, vec2};

use super::icon::{Icon, icon_button_ui};
use super::plot_panel::{Side, plot_panel_ui, say};
use super::work::{PanelJob, Work};
use super::{Running, theme, things};
use crate::app::hand::Target;
use crate::scene::Scene;
use crate::scene::edit::BodyId;
use crate::session::modes::{BodyModes, Swing};
use crate::view::legend::three_digits;

/// The words beside the list.
const SIDE: Side = Side { title: "Modes of a body", begin: "Find", width: 258.0 };

const WHAT: &str = "How a body swings about rest, and how often in a second. Computed in the background.";

const LINEAR: &str = "Linear: right for small motion; where a part turns far it looks wrong, it grows.";

/// The largest displacement by a mode, and that of a played mode whose slider is at rest, % of the body's size.
const MAX_AMPLITUDE_PERCENT: f64 = 20.0;
const PLAYED_AMPLITUDE_PERCENT: f64 = 10.0;
/// Width of a slider, points.
const SLIDER_WIDTH: f32 = 180.0;

/// The memory of the panel.
#[derive(Debug, Default)]
pub struct ModesPanel {
    /// The modes, with the progress of the work on them.
    pub job: PanelJob<Arc<BodyModes>>,
    /// The modes shown in the view.
    swing: Option<Swing>,
}

/// The body whose modes are computed: the selected one, otherwise the first.
pub(super) fn body_of(selection: Option<Target>) -> BodyId {
    match selection {
        Some(Target::Body(id)) => id,
        Some(Target::Obstacle(_)) | None => BodyId(0),
    }
}

impl ModesPanel {
    /// Forgets the modes when another scene is opened.
    pub(super) fn forget(&mut self) {
        self.job.forget();
        self.swing = None;
    }

    /// The modes to be shown in the view; `None` while all are at rest.
    pub(super) fn shown(&self, scene: &Scene) -> Option<Swing> {
        let moves = |swing: &&Swing| swing.played.is_some() || swing.amplitudes.iter().any(|share| share.abs() > 0.0);
        let of_work = |swing: &&Swing| matches!(&self.job.work, Work::Ready(of) if Arc::ptr_eq(of, &swing.of));
        self.swing.as_ref().filter(moves).filter(of_work).filter(|swing| swing.of.is_of(scene)).cloned()
    }
}

/// The panel.
pub(super) fn modes_panel_ui(ui: &mut Ui, running: Running<'_>, selection: Option<Target>, panel: &mut ModesPanel) {
    let ModesPanel { job, swing } = panel;
    if let Work::Ready(of) = &job.work
        && swing.as_ref().is_none_or(|swing| !Arc::ptr_eq(&swing.of, of))
    {
        *swing = Some(Swing { of: Arc::clone(of), amplitudes: vec![0.0; of.modes.modes.len()], played: None });
    }
    let words = swing.clone();
    plot_panel_ui(
        ui,
        &SIDE,
        job,
        |ui, work| words_ui(ui, running, selection, words.as_ref(), work),
        |ui, work| {
            if let (Work::Ready(of), Some(swing)) = (work, swing)
                && of.is_of(running.scene)
            {
                list_ui(ui, swing);
            }
        },
    );
}

fn words_ui(
    ui: &mut Ui,
    running: Running<'_>,
    selection: Option<Target>,
    swing: Option<&Swing>,
    work: &Work<Arc<BodyModes>>,
) {
    let colors = theme::of(ui);
    match work {
        Work::Idle => {
            say(ui, WHAT, colors.weak);
            let body = Target::Body(body_of(selection));
            if things::exists(running.scene, body) {
                say(
                    ui,
                    &format!("Of {}; choose another body for its own.", things::name(running.scene, body)),
                    colors.weak,
                );
            }
        }
        Work::Ready(of) => {
            if !of.is_of(running.scene) {
                say(ui, "The body has changed since: find its modes again.", colors.warning);
                return;
            }
            let name = things::name(running.scene, Target::Body(of.body));
            let rigid = match of.modes.rigid {
                0 => "it is held".to_owned(),
                count => format!("{count} motions as a rigid body have no frequency"),
            };
            say(ui, &format!("{name}: {rigid}."), colors.text);
            say(ui, LINEAR, colors.weak);
            if let Some((played, (shown, slower))) = swing.and_then(|swing| Some((swing.played?, swing.shown_hz()?))) {
                let pace = if slower > 1.0 {
                    format!("shown {} times slower, {} times a second", three_digits(slower), three_digits(shown))
                } else {
                    "shown as fast as it is".to_owned()
                };
                say(ui, &format!("Mode {} is {pace}.", played + 1), colors.text);
            }
            say(ui, "Time stands still while the body is moved by its modes.", colors.weak);
        }
        Work::Running(_) | Work::Failed(_) => {}
    }
}

fn list_ui(ui: &mut Ui, swing: &mut Swing) {
    let of = Arc::clone(&swing.of);
    let colors = theme::of(ui);
    ScrollArea::vertical().auto_shrink([false, true]).show(ui, |ui| {
        if ui.button("All to rest").clicked() {
            swing.amplitudes.fill(0.0);
            swing.played = None;
        }
        Grid::new("modes").num_columns(4).spacing(vec2(12.0, 4.0)).show(ui, |ui| {
            for (number, (mode, share)) in of.modes.modes.iter().zip(&mut swing.amplitudes).enumerate() {
                let name = format!("mode {}", number + 1);
                let plays = swing.played == Some(number);
                let (icon, verb) = if plays { (Icon::Pause, "Stop") } else { (Icon::Play, "Swing") };
                let swings = mode.frequency_hz > 0.0;
                if icon_button_ui(ui, icon, &format!("{verb} {name}"), "", swings).clicked() {
                    swing.played = (!plays).then_some(number);
                    if !plays && share.abs() <= 0.0 {
                        *share = PLAYED_AMPLITUDE_PERCENT / 100.0;
                    }
                }
                let hertz = if swings { format!("{} Hz", three_digits(mode.frequency_hz)) } else { "loose".to_owned() };
                let words = RichText::new(format!("{}:  {hertz}", number + 1)).color(colors.strong);
                let damped = mode
                    .damping_ratio()
                    .map(|ratio| format!("{} of the damping at which it would not swing", three_digits(ratio)));
                ui.add(Label::new(words).extend()).on_hover_text(damped.unwrap_or_default());
                let mut percent = 100.0 * *share;
                ui.spacing_mut().slider_width = SLIDER_WIDTH;
                let track = ui.add(
                    Slider::new(&mut percent, -MAX_AMPLITUDE_PERCENT..=MAX_AMPLITUDE_PERCENT)
                        .show_value(false)
                        .step_by(0.5),
                );
                ui.ctx().accesskit_node_builder(track.id, |node| node.set_label(format!("Amplitude of {name}")));
                if track.changed() {
                    *share = percent / 100.0;
                }
                ui.label(RichText::new(format!("{percent:.1} % of its size")).color(colors.weak));
                ui.end_row();
            }
        });
    });
}
