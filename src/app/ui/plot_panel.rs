//! A panel of words with a plot beside them. The words begin with a title and a button that begins or stops the work; its
//! progress and remarks follow.

use egui::{Color32, Label, RichText, ScrollArea, Ui, vec2};

use super::theme;
use super::work::{PanelJob, Work, progress_ui};

/// Between the words and the plot, points.
const GAP: f32 = 18.0;

/// The words beside a plot.
pub(super) struct Side {
    /// The title of the panel.
    pub(super) title: &'static str,
    /// The label of the button that begins the work.
    pub(super) begin: &'static str,
    /// How wide the words may be, points.
    pub(super) width: f32,
}

/// Shows the panel of some work, with its words and its plot.
pub(super) fn plot_panel_ui<T>(
    ui: &mut Ui,
    side: &Side,
    panel: &mut PanelJob<T>,
    words: impl FnOnce(&mut Ui, &Work<T>),
    plot: impl FnOnce(&mut Ui, &Work<T>),
) {
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = GAP;
        ui.allocate_ui(vec2(side.width, ui.available_height()), |ui| {
            ui.vertical(|ui| {
                ui.set_width(side.width);
                panel.title_ui(ui, side.title, side.begin);
                ScrollArea::vertical().show(ui, |ui| {
                    match &panel.work {
                        Work::Running(progress) => progress_ui(ui, progress, side.width - theme::SCROLL_BAR),
                        Work::Failed(why) => say(ui, &format!("No result: {why}."), theme::of(ui).error),
                        Work::Idle | Work::Ready(_) => {}
                    }
                    words(ui, &panel.work);
                });
            });
        });
        plot(ui, &panel.work);
    });
}

/// A sentence in a colour.
pub(super) fn say(ui: &mut Ui, text: &str, color: Color32) {
    ui.add(Label::new(RichText::new(text).color(color)).wrap());
}
