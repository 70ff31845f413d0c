//! The running sandbox with no window, no GPU and no thread of its own: commands go in, time goes in, a status and a picture
//! come out. Deterministic in everything but how many steps fit into a stretch of wall time, so that everything a person can
//! do can be tested.

pub mod background;
mod bodies;
mod body_analysis;
mod brush;
pub mod cancellation;
mod clock;
pub mod collect;
mod color_range;
pub mod command;
mod costs;
mod cures;
pub mod document;
mod draw;
mod editing;
mod error;
pub mod error_curve;
mod explain;
mod gather;
mod grab;
mod handle;
mod history;
pub mod jellify;
mod live_predictions;
mod memory;
pub mod modal;
mod model_paths;
pub mod modes;
mod modes_cache;
mod picture;
mod pin_warnings;
pub mod predict;
pub mod progress;
pub mod run;
mod sample;
mod shape_cache;
mod show;
mod slowness;
pub mod stability_map;
pub mod state_error;
pub mod state_file;
mod state_origin;
mod state_reader;
pub mod status;
pub mod step_error;
pub mod step_gate;
pub mod step_words;
mod stop;
mod stoppable;
mod stroke;
mod swing;
pub mod threads;
mod trials;
pub mod trouble;
pub mod wanted_modes;
mod warnings;
mod words;

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use cpu_time::ThreadTime;

pub use bodies::BodyParts;
pub use command::{BoxOfBody, CellTouch, Command, Pull};
pub use costs::{StageCost, StepCost};
pub use cures::Cure;
pub use error::SessionError;
pub use gather::checksum;
pub use slowness::KEEPS_UP;
pub use status::{BodyStatus, SafeValue, Status};
pub use trouble::Trouble;

use crate::geometry::Watch;
use crate::machine::threads::kept_awake;
use crate::physics::{Simulation, State, StepReport};
use crate::scene::Scene;
use crate::scene::resolve::load_meshes;
use bodies::Bodies;
use clock::{Clock, ClockInterval};
use costs::Costs;
use document::{Document, Opened};
use history::History;
use modes::Swinging;
use picture::Picture;
use progress::Progress;
use sample::StageSample;
use shape_cache::ShapeCache;
use stability_map::StabilityShown;
use step_error::StepErrors;
use step_gate::StepGate;
use stoppable::Stoppable;
use stroke::Stroke;
use trials::Trials;
use wanted_modes::{FoundModes, WantedModes};

/// While time runs, trying cures takes one part in this many of the time budget.
const CURES_TIME_DIVISOR: u32 = 4;

/// A running sandbox.
#[derive(Debug)]
pub struct Session {
    /// Shared with whoever shows it; another allocation after every edit.
    scene: Arc<Scene>,
    document: Document,
    shape_cache: ShapeCache,
    bodies: Bodies,
    simulation: Simulation<f32>,
    history: History,
    /// The changes of the present brush stroke.
    stroke: Stroke,
    clock: Clock,
    playing: bool,
    speed: f64,
    report: StepReport,
    /// Why the simulation was stopped, if it was.
    trouble: Option<Trouble>,
    /// The cures under trial for what is wrong.
    trials: Option<Trials>,
    /// Cells turned inside out; 0 while recovery from inversion is on.
    inverted_cells: usize,
    /// The first warning about the scene; found anew after every edit, not every frame.
    notice: String,
    picture: Picture,
    /// How far the material values of each body may go.
    body_analyses: Vec<body_analysis::BodyAnalysis>,
    /// What the steps cost, while someone looks.
    costs: Option<Costs>,
    /// Where the time of the steps goes, from a sample of them.
    stage_sample: StageSample,
    /// The share of the processors that drawing takes.
    drawing_share: f64,
    /// The stability of a body, while someone looks.
    stability: Option<Arc<StabilityShown>>,
    /// Predictions of the error of the steps.
    step_errors: StepErrors,
    /// Set by whoever wants a substep given up.
    stop: Arc<AtomicBool>,
    step_gate: Arc<StepGate>,
    /// The progress of the present command, if someone waits for it who may leave.
    progress: Option<Arc<Progress>>,
    /// The modes that are shown of a body, while someone looks.
    swinging: Option<Swinging>,
    /// The box of a body that is marked in the view.
    marked_box: Option<BoxOfBody>,
    /// What is known of the modes that bodies move by.
    found_modes: Vec<FoundModes>,
    /// The modes that a body waits for.
    awaited_modes: Option<Arc<WantedModes>>,
    /// Why time stands still until a person lets it run; empty where it does not.
    too_slow_reason: String,
    /// Whether it is still to be found out if time would run too slowly.
    may_be_too_slow: bool,
}

impl Session {
    /// Opens a scene at its start, time running. Relative model paths start at `base_dir`.
    pub fn new(scene: Scene, base_dir: PathBuf, title: String) -> Result<Self, SessionError> {
        Self::open(Opened::without_file(scene, title, base_dir), &())
    }

    /// Opens a scene from a file or elsewhere at its start, time running; `watch` follows the filling of models.
    pub fn open(opened: Opened, watch: &dyn Watch) -> Result<Self, SessionError> {
        let document = Document::new(&opened);
        let shape_cache = ShapeCache::new(opened.base_dir);
        Self::start(opened.scene, document, shape_cache, watch)
    }

    /// Opens another scene in another sandbox, at its start; shapes and modes that are ready here are used again.
    pub fn with_scene(&self, scene: Scene) -> Result<Self, SessionError> {
        let mut other = Self::start(scene, self.document.clone(), self.shape_cache.clone(), &())?;
        other.found_modes.clone_from(&self.found_modes);
        other.update_modes();
        Ok(other)
    }

    fn start(
        mut scene: Scene,
        document: Document,
        mut shape_cache: ShapeCache,
        watch: &dyn Watch,
    ) -> Result<Self, SessionError> {
        shape_cache.set_embedded(&scene.models);
        load_meshes(&mut scene, shape_cache.base_dir(), watch)?;
        let mut bodies = Bodies::resolve(&scene, &mut shape_cache, watch)?;
        bodies.update_skins(&scene);
        let simulation = Simulation::new(&scene, &bodies.lattices());
        let mut session = Self {
            scene: Arc::new(scene),
            document,
            shape_cache,
            bodies,
            simulation,
            history: History::default(),
            stroke: Stroke::default(),
            clock: Clock::default(),
            playing: true,
            speed: 1.0,
            report: StepReport::default(),
            trouble: None,
            trials: None,
            inverted_cells: 0,
            notice: String::new(),
            picture: Picture::default(),
            costs: None,
            stability: None,
            step_errors: StepErrors::default(),
            stage_sample: StageSample::default(),
            drawing_share: 0.0,
            stop: Arc::default(),
            step_gate: Arc::default(),
            progress: None,
            swinging: None,
            marked_box: None,
            found_modes: Vec::new(),
            awaited_modes: None,
            too_slow_reason: String::new(),
            may_be_too_slow: false,
            body_analyses: Vec::new(),
        };
        session.update_modes();
        session.find_notice();
        session.update_body_analyses();
        Ok(session)
    }

    fn find_notice(&mut self) {
        self.notice = self.warnings().into_iter().next().unwrap_or_default();
    }

    /// Finds how far values may go; the results of unchanged bodies are kept.
    fn update_body_analyses(&mut self) {
        self.body_analyses =
            body_analysis::analyse_bodies(&self.scene, &self.simulation.model().bodies, &self.body_analyses);
        self.find_stability();
    }

    fn restart(&mut self) {
        let modes = self.known_modes(&self.scene);
        self.simulation = Simulation::with_modes(&self.scene, &self.bodies.lattices(), &modes);
        self.report = StepReport::default();
        self.step_errors.reset();
        self.clock.reset();
        self.forget_trouble();
        self.find_inversion();
        self.picture.invalidate();
    }

    /// Forgets what was wrong, and the cures under trial.
    fn forget_trouble(&mut self) {
        (self.trouble, self.trials) = (None, None);
    }

    /// Lets `wall` time pass: takes the steps that are owed, and returns after about `budget` even if some are not taken; an
    /// expensive step is left half done and goes on at the next call. Tries cures where something is wrong.
    pub fn advance(&mut self, wall: Duration, budget: Duration) {
        if self.advance_swing(wall) || self.awaited_modes.is_some() {
            return;
        }
        let (begin, processor) = (Instant::now(), ThreadTime::now());
        let share = if self.playing { budget / CURES_TIME_DIVISOR } else { budget };
        self.continue_trials(begin.checked_add(share));
        if self.playing && self.may_be_too_slow {
            self.pause_if_too_slow();
        }
        if !self.playing {
            return;
        }
        if self.is_stopped_by_rest() {
            let wall_secs = wall.as_secs_f64();
            self.clock.record(ClockInterval {
                wall_secs,
                simulated_secs: self.speed * wall_secs,
                ..ClockInterval::default()
            });
            // What was known of its motion is no longer so.
            self.predict_step_error(budget);
            return;
        }
        let time_before = self.simulation.state().time_secs;
        let dt_secs = self.simulation.plan().dt_secs;
        self.clock.accumulate(wall.as_secs_f64(), self.speed);
        kept_awake(self.simulation.plan().threads, || {
            while self.clock.is_step_due(dt_secs) && begin.elapsed() < budget && !self.is_stopped_by_rest() {
                self.step_gate.wait();
                if !self.substep() || self.report.stopped {
                    break;
                }
                if self.simulation.state().is_between_steps() {
                    self.clock.consume(dt_secs);
                }
            }
        });
        self.simulation.place_modal();
        self.clock.record(ClockInterval {
            wall_secs: wall.as_secs_f64(),
            simulated_secs: self.simulation.state().time_secs - time_before,
            stepping_secs: begin.elapsed().as_secs_f64(),
            processor_secs: processor.elapsed().as_secs_f64(),
        });
        self.predict_step_error(budget);
        self.find_inversion();
    }

    /// Whether simulated time stands still because nothing moves: the picture of a scene at rest is not drawn again, and a
    /// clock that ran on unseen would jump at the next drawing. A step that has begun is ended.
    fn is_stopped_by_rest(&self) -> bool {
        // The first substep of a state that was opened asleep counts its contacts.
        let is_counted = self.report.counters.substeps > 0;
        is_counted && self.simulation.is_asleep() && self.simulation.state().is_between_steps()
    }

    /// Tries all cures where something is wrong, however long it takes.
    pub fn find_cures(&mut self) {
        self.continue_trials(None);
    }

    /// Takes one whole step; none while modes are to be found. Returns whether the simulation is still sound.
    pub fn step(&mut self) -> bool {
        if self.awaited_modes.is_some() {
            return true;
        }
        let is_sound = self.take_step();
        self.simulation.place_modal();
        is_sound
    }

    fn take_step(&mut self) -> bool {
        loop {
            if !self.substep() {
                return false;
            }
            if self.report.stopped {
                return true;
            }
            if self.simulation.state().is_between_steps() {
                self.find_inversion();
                return true;
            }
        }
    }

    fn substep(&mut self) -> bool {
        let asleep = self.simulation.is_asleep();
        let timer = match &mut self.costs {
            None => self.stage_sample.next_timer(),
            Some(costs) => Some(costs.timer()),
        };
        self.report = self.simulation.substep(&mut Stoppable { timer, stop: &self.stop });
        if let Some(costs) = &mut self.costs {
            costs.note(&self.report, &self.simulation);
        }
        if !asleep && !self.report.stopped {
            self.picture.invalidate();
        }
        if self.report.diverged {
            self.playing = false;
            self.find_trouble();
        }
        !self.report.diverged
    }

    /// Sets the flag that gives substeps up while it is set; they are taken anew later.
    pub fn set_stop(&mut self, stop: Arc<AtomicBool>) {
        self.stop = stop;
    }

    /// Sets the gate at which [`Session::advance`] waits between substeps.
    pub fn set_step_gate(&mut self, step_gate: Arc<StepGate>) {
        self.step_gate = step_gate;
    }

    /// The bodies whose models have parts with names, and how many cells each part has.
    pub fn named_parts(&self) -> Vec<BodyParts> {
        self.bodies.named_parts()
    }

    /// The memory that the scene needs without a window, bytes.
    pub fn memory_bytes(&self) -> u64 {
        let scheme = Some(self.simulation.plan().scheme);
        memory::needed_bytes(&self.scene, &self.bodies.outlines(), scheme) + self.bodies.picture_bytes()
    }

    /// Whether time runs.
    pub fn is_playing(&self) -> bool {
        self.playing
    }

    /// Whether cures of what is wrong are still being tried.
    pub fn is_looking_for_cures(&self) -> bool {
        self.trials.as_ref().is_some_and(|trials| !trials.are_over())
    }

    /// Whether nothing moves and nothing will, until someone touches it.
    pub fn is_at_rest(&self) -> bool {
        let waits = self.swinging.is_some() || self.awaited_modes.is_some();
        let stands = waits || !self.playing || self.simulation.is_asleep();
        stands && !self.is_looking_for_cures() && !self.is_swinging()
    }

    /// The document.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The document; the same allocation as before when nothing touched it.
    pub fn shared_scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// A preset's name or a file's.
    pub fn title(&self) -> &str {
        &self.document.title
    }

    /// The physics.
    pub fn simulation(&self) -> &Simulation<f32> {
        &self.simulation
    }

    fn replace_state(&mut self, state: State<f32>) {
        self.simulation.set_state(state);
        self.step_errors.reset();
        self.picture.invalidate();
    }
}

#[cfg(test)]
mod brush_tests;
#[cfg(test)]
mod cure_tests;
#[cfg(test)]
mod fallen_tests;
#[cfg(test)]
mod history_tests;
#[cfg(test)]
mod mesh_tests;
#[cfg(test)]
mod modal_tests;
#[cfg(test)]
mod part_tests;
#[cfg(test)]
mod random_tests;
#[cfg(test)]
mod reshape_tests;
#[cfg(test)]
mod state_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod texture_tests;
