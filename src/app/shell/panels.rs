//! What the panels are given, and what they ask for.

use super::Shell;
use crate::app::ui::{self, Running};
use crate::app::worker::Snapshot;
use crate::extract;
use crate::view::DrawList;

impl Shell {
    /// Lays the panels out and sends what they ask for.
    pub(super) fn lay_out_panels(&mut self) -> egui::FullOutput {
        let raw_input = self.egui.take_egui_input(&self.window);
        self.ui.files.camera = extract::view::camera_settings(&self.orbit);
        self.ui.look = self.look();
        let value = self.value_under_pointer();
        let drawing = self.drawing.cost();
        let Self { context, snapshot, ui, failure, worker, .. } = self;
        let shown = ui::Shown { running: snapshot.as_ref().map(running), failure, value: &value, drawing };
        let (mut commands, looks) = (Vec::new(), (ui.theme, ui.selection, ui.follow_chosen));
        let output = context.run_ui(raw_input, |root| ui::panels_ui(root, &shown, ui, &mut commands));
        for command in commands {
            worker.send(command);
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
        // While an edge is dragged its width is not settled.
        if !self.context.input(|input| input.pointer.any_down()) {
            self.preferences.keep(self.ui.arrangement(self.context.zoom_factor()));
        }
        output
    }
}

/// The running sandbox, as panels are given it.
pub(super) fn running(snapshot: &Snapshot) -> Running<'_> {
    let DrawList { scalars, colormap, color_range, .. } = &snapshot.draw_list;
    Running {
        status: &snapshot.status,
        scene: &snapshot.scene,
        color_key: scalars.as_ref().map(|_scalars| (*colormap, *color_range)),
    }
}
