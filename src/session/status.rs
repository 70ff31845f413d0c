//! What the panels show of a running sandbox: plain numbers and words, no physics types.

use std::path::PathBuf;
use std::sync::Arc;

use super::document::ModelPlace;
use super::modes::Swing;
use super::stability_map::StabilityShown;
use super::step_error::StepError;
use super::wanted_modes::WantedModes;
use super::{BoxOfBody, StepCost, Trouble};
use crate::math::Aabb;
pub use crate::physics::{OtherForm, SafeValue};
use crate::scene::own_weight::Stature;
use crate::scene::settings::Integrator;

/// The state of a session, published with every snapshot.
#[derive(Clone, Debug, Default, PartialEq)]
#[expect(clippy::struct_excessive_bools, reason = "independent facts, each true or not")]
pub struct Status {
    /// A preset's name or a file's.
    pub title: String,
    /// The scene file; none for presets, models and new scenes.
    pub file: Option<PathBuf>,
    /// Whether the scene holds changes that are in no file.
    pub unsaved: bool,
    /// The checksum of the scene file as it was last read or written; none where that is not known.
    pub on_disk: Option<u64>,
    /// How often saving was refused since the last success because another program had changed the file.
    pub refused_saves: u32,
    /// Where its file has its models, or would have them.
    pub models: ModelPlace,
    /// Whether a person can choose that: some models are files, and none are inside the scene.
    pub chooses_models: bool,
    /// Where relative model paths of the scene start.
    pub base_dir: PathBuf,
    /// Whether time runs.
    pub playing: bool,
    /// Whether all bodies have come to rest: time stands still until something is touched.
    pub at_rest: bool,
    /// Simulated time, s.
    pub time_secs: f64,
    /// Speed asked for: simulated seconds a wall second.
    pub speed: f64,
    /// Speed reached over the last second; 1 is real time.
    pub real_time_factor: f64,
    /// Whether simulated time is owed for which there was no wall time.
    pub behind: bool,
    /// The share of the last second that was spent in steps.
    pub stepping_share: f64,
    /// The share of the recent step time in which a processor worked on the steps: drawing and other programs have the rest.
    pub processor_share: f64,
    /// Simulated seconds per second of processor time lately; infinite where nothing moves.
    pub speed_alone: f64,
    /// Why the speed asked for is not reached, in plain words; empty when it is.
    pub limited_by: String,
    /// The substep in use, s.
    pub dt_secs: f64,
    /// The largest safe step, s; the implicit integrator takes longer ones. [`super::step_words`] words it for a person.
    pub dt_safe_secs: f64,
    /// The scheme in use: the one chosen, or another that has taken over.
    pub integrator: Integrator,
    /// What limits the step, in plain words ("shear stiffness", "the step asked for").
    pub dt_limited_by: String,
    /// The most substeps in a whole step.
    pub substeps: u32,
    /// Particles in the scene.
    pub particles: usize,
    /// Links in the scene.
    pub links: usize,
    /// Contacts in the last substep.
    pub contacts: usize,
    /// What a person should know, as a sentence; empty when there is nothing.
    pub message: String,
    /// Whether the message says what went wrong; otherwise it is just worth knowing.
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
    /// The stability of a body over its stiffness and damping; none while nobody looks.
    pub stability: Option<Arc<StabilityShown>>,
    /// What is shown of a body's modes; none while nobody looks.
    pub swing: Option<Swing>,
    /// The box of a body that is marked in the view.
    pub marked_box: Option<BoxOfBody>,
    /// The modes that a body waits for, while time stands still for that.
    pub awaited_modes: Option<Arc<WantedModes>>,
    /// The predicted error of the steps, as far as it is known.
    pub step_error: StepError,
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
    /// The frequencies of the modes that it moves by, Hz; none where it moves by its cells.
    pub modes_hz: Option<Arc<[f64]>>,
    /// The build of the body, as far as it matters to whether it stands.
    pub stature: Stature,
    /// How far each value of its material may go before the step asked for has to be divided.
    pub safe: Arc<Vec<SafeValue>>,
    /// The parts that its model's file names, in the order of the file.
    pub part_names: Arc<[String]>,
    /// Its materials in the other form: springs of a solid, a solid of springs.
    pub other_form: Arc<OtherForm>,
}
