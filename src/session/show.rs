//! What the panels show, gathered from all parts of a session.

use std::sync::Arc;

use glam::DVec3;

use super::model_paths::chooses_models;
use super::{BodyStatus, Session, Status};
use crate::math::{Aabb, rotation};

impl Session {
    /// What the panels show.
    pub fn status(&self) -> Status {
        let plan = self.simulation.plan();
        let model = self.simulation.model();
        let links: usize = model.link_counts().iter().sum();
        let recent = self.clock.recent();
        Status {
            title: self.document.title.clone(),
            file: self.document.file.clone(),
            unsaved: self.document.is_unsaved(&self.scene),
            on_disk: self.document.on_disk,
            refused_saves: self.document.refused_saves,
            models: self.document.models(&self.scene),
            chooses_models: chooses_models(&self.scene),
            base_dir: self.document.base_dir.clone(),
            playing: self.playing,
            at_rest: self.simulation.is_asleep(),
            time_secs: self.simulation.state().time_secs,
            speed: self.speed,
            real_time_factor: recent.real_time_factor().unwrap_or(self.speed),
            behind: self.is_behind(),
            stepping_share: recent.stepping_secs / recent.wall_secs.max(1e-9),
            processor_share: self.clock.processor_share(),
            speed_alone: recent.speed_alone(),
            limited_by: self.slowness(links),
            dt_secs: plan.substep_secs(),
            dt_safe_secs: plan.limits_at_work().dt_safe_secs.unwrap_or(f64::INFINITY),
            integrator: plan.scheme.into(),
            dt_limited_by: plan.limits_at_work().limited_by(plan.dt_secs).words(),
            substeps: plan.max_substeps_in_step(),
            particles: model.particle_count(),
            links,
            contacts: self.report.last.contacts + self.report.last.body_contacts,
            message: self.message(),
            failed: false,
            undo: self.history.undo_words().to_owned(),
            redo: self.history.redo_words().to_owned(),
            bodies: self.body_statuses(),
            trouble: self.current_trouble(),
            cost: self.costs.as_ref().map(|costs| costs.shown(plan)),
            stability: self.stability.clone(),
            swing: self.swing().cloned(),
            marked_box: self.marked_box,
            awaited_modes: self.awaited_modes().cloned(),
            step_error: self.step_error(),
        }
    }

    fn message(&self) -> String {
        match &self.awaited_modes {
            // The window shows the wait for modes itself, with its progress.
            Some(_) => String::new(),
            None if self.too_slow_reason.is_empty() => self.notice.clone(),
            None => self.too_slow_reason.clone(),
        }
    }

    /// What there is to know of every body, in the scene's order.
    fn body_statuses(&self) -> Vec<BodyStatus> {
        (0..self.scene.bodies.len()).map(|body| self.body_status(body)).collect()
    }

    fn body_status(&self, body: usize) -> BodyStatus {
        let (model, memory) = (&self.simulation.model().bodies[body], &self.simulation.state().bodies[body]);
        let own = &self.simulation.state().position[model.particles.clone()];
        let sum = own.iter().fold(DVec3::ZERO, |sum, at| sum + at.as_dvec3());
        let bounds = || Aabb::around(own.iter().map(|at| at.as_dvec3()));
        let analysis = &self.body_analyses[body];
        BodyStatus {
            cells: model.lattice.cells.len(),
            particles: own.len(),
            links: std::array::from_fn(|family| model.links[family].links.len()),
            mass_kg: f64::from(model.particle_mass) * own.len() as f64,
            center: (sum / own.len().max(1) as f64).to_array(),
            bounds: if memory.gone { Aabb::empty() } else { bounds() },
            start_size: self.start_size(body),
            gone: memory.gone,
            asleep: self.simulation.is_body_asleep(body),
            modes_hz: model.modes().map(|modes| Arc::clone(modes.frequencies_hz())),
            stature: analysis.stature,
            safe: Arc::clone(&analysis.safe),
            part_names: model.lattice.parts.as_ref().map(|parts| parts.names.shared_names()).unwrap_or_default(),
            other_form: Arc::clone(&analysis.other_form),
        }
    }

    /// The size of the box around a body at its start, m.
    fn start_size(&self, body: usize) -> [f64; 3] {
        let grid = self.simulation.model().bodies[body].lattice.grid;
        let half = DVec3::from(grid.dims.map(|cells| 0.5 * f64::from(cells) * grid.cell_size));
        let turn = rotation::from_euler_deg(self.scene.bodies[body].pose.rotation_deg);
        (2.0 * (turn.x_axis.abs() * half.x + turn.y_axis.abs() * half.y + turn.z_axis.abs() * half.z)).to_array()
    }
}
