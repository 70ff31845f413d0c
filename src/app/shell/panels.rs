//! The input of the panels, and the commands that they send.

use std::time::Instant;

use super::Shell;
use crate::app::frame_pacer::Reason;
use crate::app::ui::{self, Running};
use crate::app::worker::Snapshot;
use crate::extract;
use crate::scene::Scene;
use crate::view::DrawList;

impl Shell {
    /// Lays the panels out and sends what they ask for.
    pub(super) fn lay_out_panels(&mut self) -> egui::FullOutput {
        let raw_input = self.egui.take_egui_input(&self.window);
        self.ui.files.camera = extract::view::camera_settings(&self.orbit);
        self.ui.look = self.look();
        let value = self.value_under_pointer();
        let drawing = self.drawing.cost();
        let Self { context, snapshot, unanswered, ui, failure, worker, .. } = self;
        let (opening, making) = (worker.opening(), worker.making());
        let running = snapshot.as_ref().map(|snapshot| running(snapshot, unanswered.scene(&snapshot.scene)));
        let (opening, making) = (opening.as_deref(), making.as_deref());
        let shown = ui::Shown { running, failure, value: &value, opening, making, drawing };
        let (mut commands, looks) = (Vec::new(), (ui.theme, ui.selection, ui.follow_chosen));
        let output = context.run_ui(raw_input, |root| ui::panels_ui(root, &shown, ui, &mut commands));
        self.send_all(commands);
        if self.ui.files.wants_inset() {
            self.drawing.panels_due.ask(Instant::now(), Reason::Input);
        }
        if (self.ui.theme, self.ui.selection, self.ui.follow_chosen) != looks {
            self.follow();
            self.changed = true;
        }
        if let Some(framing) = self.ui.frame.take() {
            self.show(framing);
        }
        if std::mem::take(&mut self.ui.revive) {
            self.revive();
        }
        // The width of an edge is not final while it is dragged.
        if !self.context.input(|input| input.pointer.any_down()) {
            self.preferences.keep(self.ui.preferences(self.context.zoom_factor()));
        }
        output
    }

    /// Runs the panels when work on the worker begins to count as long, so that they show it.
    pub(super) fn ask_for_long_work(&mut self) {
        if let Some(at) = self.worker.report_time() {
            self.drawing.panels_due.ask(at, Reason::Input);
        }
    }
}

/// The running sandbox in the form that panels take, with the scene as it will be.
pub(super) fn running<'a>(snapshot: &'a Snapshot, scene: &'a Scene) -> Running<'a> {
    let DrawList { skins, scalars, colormap, color_range, .. } = &snapshot.draw_list;
    Running {
        status: &snapshot.status,
        scene,
        color_key: scalars.as_ref().map(|_scalars| (*colormap, *color_range)),
        is_painted: skins.iter().any(|instance| instance.skin.is_painted()),
    }
}
