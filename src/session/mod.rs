//! The running sandbox with no window, no GPU and no thread of its own: commands go in, time goes in, a status and
//! a picture come out. Deterministic in everything but how many steps fit into a stretch of wall time, so that
//! everything a person can do is a test.

mod bodies;
mod clock;
pub mod command;
pub mod predict;
pub mod run;
pub mod state_file;
pub mod status;
pub mod timer;
mod warnings;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use thiserror::Error;

pub use command::Command;
pub use status::Status;

use crate::extract;
use crate::geometry::Watch;
use crate::physics::{Simulation, State, StepReport};
use crate::scene::edit::{Edit, EditError, Impact};
use crate::scene::resolve::ResolveError;
use crate::scene::{ColorBy, Scene};
use crate::view::DrawList;
use crate::view::legend::three_digits;
use bodies::Bodies;
use clock::Clock;

/// The share of particles that the automatic colour range covers: one torn corner must not grey out all others.
const RANGE_SHARE: f64 = 0.99;

/// Speeds a person may ask for, simulated seconds a wall second.
const SPEEDS: [f64; 2] = [0.01, 10.0];

/// Why a session refuses something.
#[derive(Debug, Error)]
pub enum SessionError {
    /// A body's shape gives no lattice.
    #[error("bodies.{index}.shape")]
    Shape {
        /// The body's place.
        index: usize,
        /// Why.
        #[source]
        source: ResolveError,
    },
    /// An edit does not fit the scene.
    #[error(transparent)]
    Edit(#[from] EditError),
    /// A speed outside the range.
    #[error("a speed of {speed} is outside {} … {}", SPEEDS[0], SPEEDS[1])]
    Speed {
        /// The speed asked for.
        speed: f64,
    },
}

/// A running sandbox.
#[derive(Debug)]
pub struct Session {
    scene: Scene,
    base_dir: PathBuf,
    title: String,
    bodies: Bodies,
    simulation: Simulation<f32>,
    clock: Clock,
    playing: bool,
    speed: f64,
    report: StepReport,
    message: String,
    /// The first warning about the scene; found anew after every edit, not every frame.
    notice: String,
    picture: Picture,
}

/// What was last drawn, so that nothing is copied or computed for a picture that has not changed.
#[derive(Debug, Default)]
struct Picture {
    drawn: Option<(u64, ColorBy)>,
    revision: u64,
    particles: Arc<Vec<[f32; 3]>>,
    scalars: Option<Arc<Vec<f32>>>,
    automatic_range: [f32; 2],
}

impl Session {
    /// A scene at its start, time running. Relative model paths start at `base_dir`.
    pub fn new(scene: Scene, base_dir: PathBuf, title: String) -> Result<Self, SessionError> {
        Self::watched(scene, base_dir, title, &())
    }

    /// As [`Session::new`], with someone to watch the filling of models.
    pub fn watched(scene: Scene, base_dir: PathBuf, title: String, watch: &dyn Watch) -> Result<Self, SessionError> {
        let bodies = Bodies::resolve(&scene, &base_dir, watch, &Bodies::default(), &[])?;
        let simulation = Simulation::new(&scene, &bodies.lattices());
        let mut session = Self {
            scene,
            base_dir,
            title,
            bodies,
            simulation,
            clock: Clock::default(),
            playing: true,
            speed: 1.0,
            report: StepReport::default(),
            message: String::new(),
            notice: String::new(),
            picture: Picture::default(),
        };
        session.find_notice();
        Ok(session)
    }

    fn find_notice(&mut self) {
        self.notice = self.warnings().into_iter().next().unwrap_or_default();
    }

    /// Does what a person asked for; nothing has changed where it is refused.
    pub fn handle(&mut self, command: Command) -> Result<(), SessionError> {
        match command {
            Command::Play => {
                self.playing = !self.simulation.has_diverged();
                self.clock.forgive();
            }
            Command::Pause => {
                self.playing = false;
                self.clock.forgive();
            }
            Command::StepOnce => {
                self.playing = false;
                self.clock.forgive();
                self.step();
            }
            Command::Restart => {
                self.simulation = Simulation::new(&self.scene, &self.bodies.lattices());
                self.clock.forgive();
                self.message.clear();
                self.picture.revision += 1;
            }
            Command::SetSpeed(speed) if (SPEEDS[0]..=SPEEDS[1]).contains(&speed) => {
                self.speed = speed;
                self.clock.forgive();
            }
            Command::SetSpeed(speed) => return Err(SessionError::Speed { speed }),
            Command::Replace { scene, base_dir, title } => *self = Self::new(*scene, base_dir, title)?,
            Command::Edit(edit) => self.edit(edit)?,
        }
        Ok(())
    }

    fn edit(&mut self, edit: Edit) -> Result<(), SessionError> {
        let kept = kept_bodies(&edit, self.scene.bodies.len());
        let moved = if let Edit::Body(id, _) = &edit { Some(id.0) } else { None };
        let mut scene = self.scene.clone();
        let impact = scene.apply(edit)?.impact;
        if impact == Impact::Topology {
            let same_shape = |(new, old): (usize, Option<usize>)| {
                old.filter(|&old| scene.bodies[new].shape == self.scene.bodies[old].shape)
            };
            let kept: Vec<_> = kept.into_iter().enumerate().map(same_shape).collect();
            self.bodies = Bodies::resolve(&scene, &self.base_dir, &(), &self.bodies, &kept)?;
            let mut simulation = Simulation::new(&scene, &self.bodies.lattices());
            simulation.carry_over(&self.simulation, &kept);
            self.simulation = simulation;
        } else if impact >= Impact::Parameters {
            self.simulation.set_parameters(&scene, &self.bodies.lattices());
        }
        if impact == Impact::Motion
            && let Some(body) = moved
        {
            self.simulation.restart_body(body);
        }
        let looks = |scene: &Scene| scene.bodies.iter().map(|body| (body.hidden, body.skin)).collect::<Vec<_>>();
        if looks(&scene) != looks(&self.scene) {
            self.bodies.dress(&scene);
        }
        self.scene = scene;
        self.find_notice();
        self.message.clear();
        self.picture.revision += 1;
        Ok(())
    }

    /// Lets `wall` time pass: takes the steps that are owed, and returns after about `budget` even if some are not
    /// taken; a dear step is left half done and goes on at the next call.
    pub fn advance(&mut self, wall: Duration, budget: Duration) {
        if !self.playing {
            return;
        }
        let begin = Instant::now();
        let time_before = self.simulation.state().time_secs;
        let dt_secs = self.scene.settings.dt;
        self.clock.owe(wall.as_secs_f64(), self.speed);
        while self.clock.owes(dt_secs) && begin.elapsed() < budget {
            if !self.substep() {
                break;
            }
            if self.simulation.state().substep == 0 {
                self.clock.pay(dt_secs);
            }
        }
        self.clock.note(wall.as_secs_f64(), self.simulation.state().time_secs - time_before);
    }

    /// Takes one whole step. Says whether the simulation is still sound.
    pub fn step(&mut self) -> bool {
        loop {
            if !self.substep() {
                return false;
            }
            if self.simulation.state().substep == 0 {
                return true;
            }
        }
    }

    fn substep(&mut self) -> bool {
        self.report = self.simulation.substep(&mut ());
        self.picture.revision += 1;
        if self.report.diverged {
            self.playing = false;
            self.message = self.explain_divergence();
        }
        !self.report.diverged
    }

    fn explain_divergence(&self) -> String {
        let plan = self.simulation.plan();
        let safe = plan.limits.dt_safe_secs().map_or(String::new(), |safe| {
            format!(
                ": the step of {} ms is larger than the {} ms that {} allows",
                three_digits(plan.substep_secs() * 1e3),
                three_digits(safe * 1e3),
                plan.limits.limited_by(plan.dt_secs).words(),
            )
        });
        format!(
            "The simulation became unstable{safe}. It stopped at its last good state; restart it or use automatic stepping."
        )
    }

    /// What the panels show.
    pub fn status(&self) -> Status {
        let plan = self.simulation.plan();
        let model = self.simulation.model();
        let links: usize = model.link_counts().iter().sum();
        let factor = self.clock.real_time_factor().unwrap_or(self.speed);
        Status {
            title: self.title.clone(),
            playing: self.playing,
            time_secs: self.simulation.state().time_secs,
            speed: self.speed,
            real_time_factor: factor,
            limited_by: self.slowness(factor, links),
            dt_secs: plan.substep_secs(),
            dt_safe_secs: plan.limits.dt_safe_secs().unwrap_or(f64::INFINITY),
            dt_limited_by: plan.limits.limited_by(plan.dt_secs).words(),
            substeps: plan.substeps,
            particles: model.particle_count(),
            links,
            contacts: self.report.contacts,
            message: if self.message.is_empty() { self.notice.clone() } else { self.message.clone() },
        }
    }

    fn slowness(&self, factor: f64, links: usize) -> String {
        let plan = self.simulation.plan();
        if !self.playing || factor >= 0.95 * self.speed || factor <= 0.0 {
            return String::new();
        }
        let times = self.speed / factor;
        let pace = if (self.speed - 1.0).abs() < 1e-9 { "real time" } else { "the speed asked for" };
        let cause = if plan.substeps > 1 {
            format!(
                "{} takes {} substeps in every step of {links} links",
                plan.limits.limited_by(plan.dt_secs).words(),
                plan.substeps
            )
        } else {
            format!("limited by the number of links, {links}")
        };
        format!("{times:.1} times slower than {pace}: {cause}")
    }

    /// The document.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// A preset's name or a file's.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// The physics.
    pub fn simulation(&self) -> &Simulation<f32> {
        &self.simulation
    }

    fn replace_state(&mut self, state: State<f32>) {
        self.simulation.set_state(state);
        self.picture.revision += 1;
    }

    /// The picture of the present state, from the scene's own camera.
    #[expect(clippy::cast_possible_truncation, reason = "a picture needs no more than single precision")]
    pub fn draw_list(&mut self) -> DrawList {
        let view = &self.scene.view;
        let now = (self.picture.revision, view.color);
        if self.picture.drawn != Some(now) {
            let positions = self.simulation.state().position.iter().map(glam::Vec3::to_array);
            self.picture.particles = Arc::new(positions.collect());
            let scalars = self.simulation.scalars(view.color);
            self.picture.automatic_range = automatic_range(&scalars);
            self.picture.scalars = (view.color != ColorBy::Plain).then(|| Arc::new(scalars));
            self.picture.drawn = Some(now);
        }
        DrawList {
            camera: extract::view::orbit(&view.camera).camera(),
            light: extract::view::light(&view.light),
            skins: self.bodies.skins().to_vec(),
            particles: Arc::clone(&self.picture.particles),
            scalars: self.picture.scalars.clone(),
            color_range: view.color_range.map_or(self.picture.automatic_range, |range| range.map(|end| end as f32)),
            solids: extract::solid::solids(&self.scene.obstacles),
            ..DrawList::default()
        }
    }
}

/// Which body of the scene before an edit each body after it was, if it was one.
fn kept_bodies(edit: &Edit, before: usize) -> Vec<Option<usize>> {
    let mut kept: Vec<Option<usize>> = (0..before).map(Some).collect();
    match edit {
        Edit::InsertBody(id, _) if id.0 <= before => kept.insert(id.0, None),
        Edit::RemoveBody(id) if id.0 < before => {
            kept.remove(id.0);
        }
        _ => {}
    }
    kept
}

/// From zero to the value that all but the last hundredth stay below.
fn automatic_range(scalars: &[f32]) -> [f32; 2] {
    let mut sorted: Vec<f32> = scalars.iter().copied().filter(|x| x.is_finite()).collect();
    if sorted.is_empty() {
        return [0.0, 1.0];
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of a length is an index")]
    let place = ((sorted.len() - 1) as f64 * RANGE_SHARE) as usize;
    let (_, high, _) = sorted.select_nth_unstable_by(place, f32::total_cmp);
    [0.0, if *high > 0.0 { *high } else { 1.0 }]
}

#[cfg(test)]
mod tests;
