//! What the panels show of a running sandbox: plain numbers and words, no physics types.

use std::path::PathBuf;
use std::sync::Arc;

use glam::DVec3;

use super::{Session, StepCost, Trouble};
use crate::math::{Aabb, rotation};
pub use crate::physics::SafeValue;
use crate::scene::Material;
use crate::scene::own_weight::Stature;
use crate::scene::settings::Integrator;

/// The state of a session, published with every snapshot.
#[derive(Clone, Debug, Default, PartialEq)]
#[expect(clippy::struct_excessive_bools, reason = "four independent facts, each true or not")]
pub struct Status {
    /// A preset's name or a file's.
    pub title: String,
    /// The scene file; none for presets, models and new scenes.
    pub file: Option<PathBuf>,
    /// Whether the scene holds changes that are in no file.
    pub unsaved: bool,
    /// How often saving was refused since the last success because another program had changed the file.
    pub refused_saves: u32,
    /// Where relative model paths of the scene start.
    pub base_dir: PathBuf,
    /// Whether time runs.
    pub playing: bool,
    /// Whether all bodies have come to rest: time runs, but nothing moves until something is touched.
    pub at_rest: bool,
    /// Simulated time, s.
    pub time_secs: f64,
    /// Speed asked for: simulated seconds a wall second.
    pub speed: f64,
    /// Speed reached over the last second; 1 is real time.
    pub real_time_factor: f64,
    /// Whether simulated time is owed that there was no time for.
    pub behind: bool,
    /// The share of the last second that was spent in steps.
    pub stepping_share: f64,
    /// The share of the time that steps took lately in which a processor was at work on them: drawing and other
    /// programs have the rest.
    pub processor_share: f64,
    /// Simulated seconds in a second of processor time lately; infinite where nothing moves.
    pub speed_alone: f64,
    /// Why the speed asked for is not reached, in plain words; empty when it is.
    pub limited_by: String,
    /// The step in use, s: a whole step divided by its substeps.
    pub dt_secs: f64,
    /// The largest safe step, s; the implicit integrator takes longer ones. A person reads it as [`super::step_words`] has it.
    pub dt_safe_secs: f64,
    /// The scheme in use: the one chosen, or the implicit one that has taken over.
    pub integrator: Integrator,
    /// What limits the step, in plain words ("shear stiffness", "the step asked for").
    pub dt_limited_by: String,
    /// Substeps in a whole step.
    pub substeps: u32,
    /// Particles in the scene.
    pub particles: usize,
    /// Links in the scene.
    pub links: usize,
    /// Contacts in the last substep.
    pub contacts: usize,
    /// What a person should know, as a sentence; empty when there is nothing.
    pub message: String,
    /// Whether the message says what went wrong; otherwise it is worth knowing, no more.
    pub failed: bool,
    /// What undo would take back, in words; empty when there is nothing.
    pub undo: String,
    /// What redo would make again, in words; empty when there is nothing.
    pub redo: String,
    /// The bodies, in the scene's order.
    pub bodies: Vec<BodyStatus>,
    /// Why the simulation was stopped, if it was.
    pub trouble: Option<Trouble>,
    /// What a step costs; none while nobody looks.
    pub cost: Option<StepCost>,
}

/// What there is to know of a body beside what the scene says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodyStatus {
    /// Filled cells.
    pub cells: usize,
    /// Particles.
    pub particles: usize,
    /// Links: structural, shear, bending.
    pub links: [usize; 3],
    /// Mass of the whole body, kg.
    pub mass_kg: f64,
    /// The centre of mass now, m.
    pub center: [f64; 3],
    /// The box around it now, m; empty where it is gone.
    pub bounds: Aabb<f64>,
    /// The size of the box around it at its start, m.
    pub start_size: [f64; 3],
    /// Whether it has fallen out of the scene, far below everything: it is left alone until it is brought back.
    pub gone: bool,
    /// Whether it has come to rest and is left alone until something touches it or a value changes.
    pub asleep: bool,
    /// How it is built, as far as it matters to how it stands.
    pub stature: Stature,
    /// How far each value of its material may go before the step asked for has to be divided.
    pub safe: Arc<Vec<SafeValue>>,
    /// Its material in the other form: springs of a solid, a solid of springs.
    pub other_form: Material,
}

impl Session {
    /// What there is to know of every body, in the scene's order.
    pub(super) fn body_statuses(&self) -> Vec<BodyStatus> {
        (0..self.scene.bodies.len()).map(|body| self.body_status(body)).collect()
    }

    fn body_status(&self, body: usize) -> BodyStatus {
        let (model, memory) = (&self.simulation.model().bodies[body], &self.simulation.state().bodies[body]);
        let own = &self.simulation.state().position[model.particles.clone()];
        let sum = own.iter().fold(DVec3::ZERO, |sum, at| sum + at.as_dvec3());
        let bounds = || Aabb::around(own.iter().map(|at| at.as_dvec3()));
        let found = &self.safe[body];
        BodyStatus {
            cells: model.lattice.cells.len(),
            particles: own.len(),
            links: std::array::from_fn(|family| model.links[family].links.len()),
            mass_kg: f64::from(model.particle_mass) * own.len() as f64,
            center: (sum / own.len().max(1) as f64).to_array(),
            bounds: if memory.gone { Aabb::empty() } else { bounds() },
            start_size: self.start_size(body),
            gone: memory.gone,
            asleep: memory.asleep,
            stature: found.stature,
            safe: Arc::clone(&found.safe),
            other_form: found.other.clone(),
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
