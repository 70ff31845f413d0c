//! Bodies of a sandbox that move by their modes: which modes are known, and which are still to be found. Until they are, time
//! stands still, so that the motion is the same however long that takes.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::Serialize;

use super::Session;
use super::wanted_modes::{FoundModes, SearchOutcome, WantedModes, folder, has_same_modes_and_count, is_wanted};
use crate::geometry::Watch;
use crate::physics::{BodyModel, ModalModel};
use crate::scene::{Body, Scene, named};
use crate::view::legend::three_digits;

/// How many bodies outside the scene keep their known modes, so that undo finds them at once.
const MAX_SPARE_MODES: usize = 8;

/// The modes that a body moves by; the names are those of the JSON object of the command line.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the names are the documented keys of the command line's JSON")]
pub struct ModesFigures {
    pub body: String,
    pub frequencies_hz: Vec<f64>,
}

impl ModesFigures {
    /// The same as a person reads it.
    pub fn words(&self) -> String {
        let Self { body, frequencies_hz } = self;
        let [lowest, highest] = [frequencies_hz.first(), frequencies_hz.last()].map(|hz| hz.copied().unwrap_or(0.0));
        let count = frequencies_hz.len();
        format!("{body} moves by {count} modes, {} to {} Hz", three_digits(lowest), three_digits(highest))
    }
}

impl Session {
    /// The modes that a body waits for, while time stands still for that.
    pub fn awaited_modes(&self) -> Option<&Arc<WantedModes>> {
        self.awaited_modes.as_ref()
    }

    /// The folder in which modes of its scene are kept: see [`folder`].
    pub fn modes_folder(&self, spare: Option<PathBuf>) -> Option<PathBuf> {
        folder(self.document.file.as_deref(), spare)
    }

    /// The modes of every body that moves by modes.
    pub fn modes_figures(&self) -> Vec<ModesFigures> {
        let bodies = self.scene.bodies.iter().zip(&self.simulation.model().bodies).enumerate();
        let of = |(number, (body, model)): (usize, (&Body, &BodyModel<f32>))| {
            let frequencies_hz = model.modes()?.frequencies_hz().to_vec();
            Some(ModesFigures { body: named(&body.name, "body", number), frequencies_hz })
        };
        bodies.filter_map(of).collect()
    }

    /// Finds the modes of all bodies that are to move by them, however long it takes; `folder` keeps them. A body whose
    /// search `watch` cancels moves by its cells.
    pub fn find_modes(&mut self, folder: Option<&Path>, watch: &dyn Watch) {
        while let Some(wanted) = self.awaited_modes.clone() {
            let found = wanted.find_in(&self.simulation, wanted.body.0, folder, watch);
            self.receive_modes(found.unwrap_or_else(|_cancelled| wanted.stopped()));
        }
    }

    /// Takes the outcome of a search for modes, and goes on.
    pub(super) fn receive_modes(&mut self, found: FoundModes) {
        self.found_modes.retain(|known| !has_same_modes_and_count(&known.source_body, &found.source_body));
        self.found_modes.push(found);
        self.update_modes();
        self.find_notice();
    }

    /// The modes that bodies of a scene move by, as far as they are known.
    pub(super) fn known_modes(&self, scene: &Scene) -> Vec<Option<Arc<ModalModel>>> {
        let of = |body: &Body| match &self.outcome(body)?.outcome {
            SearchOutcome::Found(modes) => Some(Arc::clone(modes)),
            SearchOutcome::Refused(_) | SearchOutcome::Stopped => None,
        };
        scene.bodies.iter().map(of).collect()
    }

    /// Makes bodies move by cells or by modes as the scene says, as far as the modes are known.
    pub(super) fn update_modes(&mut self) {
        // A stopped search is forgotten once no body wants its modes, so that asking for them again starts it anew.
        let scene = Arc::clone(&self.scene);
        let is_used = |known: &FoundModes| {
            scene.bodies.iter().any(|body| is_wanted(body) && has_same_modes_and_count(body, &known.source_body))
        };
        self.found_modes.retain(|known| !matches!(known.outcome, SearchOutcome::Stopped) || is_used(known));
        let spare = self.found_modes.iter().filter(|known| !is_used(known)).count();
        if spare > MAX_SPARE_MODES
            && let Some(oldest) = self.found_modes.iter().position(|known| !is_used(known))
        {
            self.found_modes.remove(oldest);
        }
        let modes = self.known_modes(&scene);
        let now = self.simulation.model().bodies.iter().map(|body| body.modes());
        let is_current = |(now, modes): (Option<&Arc<ModalModel>>, &Option<Arc<ModalModel>>)| match (now, modes) {
            (Some(now), Some(modes)) => Arc::ptr_eq(now, modes),
            (now, modes) => now.is_none() && modes.is_none(),
        };
        if !now.zip(&modes).all(is_current) {
            self.simulation.set_modes(&scene, &self.bodies.lattices(), &modes);
            self.step_errors.reset();
            self.picture.invalidate();
        }
        let mut bodies = (0..scene.bodies.len()).filter(|body| self.outcome(&scene.bodies[*body]).is_none());
        let awaited = bodies.find_map(|body| WantedModes::of(&scene, body));
        if self.awaited_modes.as_deref() != awaited.as_ref() {
            self.awaited_modes = awaited.map(Arc::new);
            self.clock.reset();
        }
    }

    /// What is known of the modes of a body that is to move by them.
    fn outcome(&self, body: &Body) -> Option<&FoundModes> {
        let wanted = is_wanted(body).then_some(body)?;
        self.found_modes.iter().find(|known| has_same_modes_and_count(wanted, &known.source_body))
    }

    /// Warnings about bodies that are to move by modes, a sentence each.
    pub(super) fn modes_warnings(&self) -> Vec<String> {
        let of = |(number, body): (usize, &Body)| {
            let name = named(&body.name, "body", number);
            match &self.outcome(body)?.outcome {
                SearchOutcome::Found(_) => None,
                SearchOutcome::Refused(why) => Some(format!("{name} moves by its cells: {why}")),
                SearchOutcome::Stopped => {
                    Some(format!("{name} moves by its cells: the search for its modes was stopped; choose modes anew"))
                }
            }
        };
        self.scene.bodies.iter().enumerate().filter_map(of).collect()
    }
}
