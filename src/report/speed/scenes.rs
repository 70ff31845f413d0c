//! Scenes beside real time: from their start, as a person sees them who opens them; bodies that meet, from when they meet.

use std::sync::Arc;
use std::time::Instant;

use rayon::ThreadPool;
use serde::Serialize;

use crate::geometry::Lattice;
use crate::machine::threads::kept_awake;
use crate::physics::{Simulation, StepReport};
use crate::report::extremes::lattices;
use crate::report::timer::WallTimer;

use crate::scene::resolve::ResolveError;
use crate::scene::{MovesBy, Scene, presets};

/// The most simulated time, s: bodies at rest after that cost nothing.
const MAX_SIMULATED_SECS: f64 = 1.5;

/// The scene of bodies that meet, and how long it runs before it is measured, s: until they lie on each other.
const PILE_SCENE: &str = "pile";
const PILE_SETTLING_SECS: f64 = 1.5;

/// A scene to be timed, with the cells of its bodies.
#[derive(Clone, Debug)]
pub struct TimedScene {
    name: String,
    scene: Scene,
    lattices: Vec<Arc<Lattice>>,
    /// How long it runs before it is timed, s.
    settling_secs: f64,
}

impl TimedScene {
    /// Describes a scene that is timed from its start.
    pub fn from_start(name: String, scene: Scene, lattices: Vec<Arc<Lattice>>) -> Self {
        Self { name, scene, lattices, settling_secs: 0.0 }
    }

    /// Makes the scenes of the report itself.
    pub(super) fn own() -> Result<Vec<Self>, ResolveError> {
        let timed = |(name, scene): (&str, Scene)| {
            let lattices = lattices(&scene)?;
            let settling_secs = if name == PILE_SCENE { PILE_SETTLING_SECS } else { 0.0 };
            Ok(Self { name: name.to_owned(), scene, lattices, settling_secs })
        };
        scenes().into_iter().map(timed).collect()
    }
}

/// How fast a scene is.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names are the keys of the command line's JSON")]
pub struct SceneSpeed {
    pub scene: String,
    pub particles: usize,
    pub threads: usize,
    pub simulated_secs: f64,
    pub real_time_factor: f64,
    /// When it exploded, s.
    pub exploded_at_secs: Option<f64>,
    /// Whether bodies that move by their modes are timed by their cells.
    pub modes_as_cells: bool,
    /// Contact between bodies, in scenes of several.
    pub meeting: Option<BodyContactSpeed>,
}

/// The amount and cost of contact between bodies.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the names are the keys of the command line's JSON")]
pub struct BodyContactSpeed {
    pub bodies: usize,
    /// Mean number of contacts between bodies in a substep.
    pub contacts: f64,
    /// Contacts between bodies solved per second of the wall clock.
    pub contacts_per_sec: f64,
    /// Points searched for in the cells of another body, or of their own, per second of the wall clock.
    pub points_per_sec: f64,
    /// Share of the time of a step.
    pub share: f64,
}

/// Runs each scene for some time of the wall clock, on one thread and on as many as are worthwhile.
pub(super) fn measure(
    scenes: &[TimedScene],
    wall_secs: f64,
    threads: usize,
    pool: Option<&ThreadPool>,
) -> Vec<SceneSpeed> {
    let mut speeds = Vec::new();
    for timed in scenes {
        let mut start = Simulation::<f32>::new(&timed.scene, &timed.lattices);
        start.run_for(timed.settling_secs);
        speeds.push(speed(timed, start.clone(), 1, None, wall_secs));
        let threads = start.threads_worth(threads);
        if let Some(pool) = pool.filter(|_| threads > 1) {
            speeds.push(speed(timed, start, threads, Some(pool), wall_secs));
        }
    }
    speeds
}

fn speed(
    TimedScene { name, scene, .. }: &TimedScene,
    mut simulation: Simulation<f32>,
    threads: usize,
    pool: Option<&ThreadPool>,
    wall_secs: f64,
) -> SceneSpeed {
    simulation.set_threads(threads);
    let start_secs = simulation.state().time_secs;
    let passed = |simulation: &Simulation<f32>| simulation.state().time_secs - start_secs;
    let (mut report, mut timer, mut exploded_at_secs) = (StepReport::default(), WallTimer::default(), None);
    let begin = Instant::now();
    let mut run = || {
        while begin.elapsed().as_secs_f64() < wall_secs && passed(&simulation) < MAX_SIMULATED_SECS {
            let step = simulation.step_timed(&mut timer);
            report.add(&step);
            if step.diverged {
                exploded_at_secs = Some(simulation.state().time_secs);
                return;
            }
        }
    };
    match pool {
        Some(pool) => pool.install(|| kept_awake(threads, run)),
        None => run(),
    }
    let (wall, simulated_secs) = (begin.elapsed().as_secs_f64(), passed(&simulation));
    let particles = simulation.model().particle_count();
    let meeting = body_contact_speed(simulation.model().bodies.len(), &report, &timer, wall);
    let real_time_factor = simulated_secs / wall;
    SceneSpeed {
        scene: name.clone(),
        particles,
        threads,
        simulated_secs,
        real_time_factor,
        exploded_at_secs,
        modes_as_cells: scene.bodies.iter().any(|body| body.moves_by == MovesBy::Modes),
        meeting,
    }
}

/// Contact between a number of bodies over some time of the wall clock, s.
fn body_contact_speed(bodies: usize, report: &StepReport, timer: &WallTimer, wall: f64) -> Option<BodyContactSpeed> {
    let [contacts, points, substeps] =
        [report.counters.body_contacts, report.counters.points_looked_for, report.counters.substeps]
            .map(|count| count as f64);
    (bodies > 1).then(|| BodyContactSpeed {
        bodies,
        contacts: contacts / substeps.max(1.0),
        contacts_per_sec: contacts / wall,
        points_per_sec: points / wall,
        share: timer.between_bodies().as_secs_f64() / wall,
    })
}

fn scenes() -> Vec<(&'static str, Scene)> {
    let preset = |name| presets::preset(name).map(|preset| (name, (preset.build)()));
    let mut scenes: Vec<_> =
        ["cube-on-plane", "spot", "coupler-20", "coupler-40", PILE_SCENE].into_iter().filter_map(preset).collect();
    if let Some((_, mut scene)) = preset("cube-on-plane") {
        let mut other = scene.bodies[0].clone();
        (scene.bodies[0].pose.position[0], other.pose.position[0]) = (-1.0, 1.0);
        scene.bodies.push(other);
        scenes.push(("two cubes on the ground", scene));
    }
    scenes
}
