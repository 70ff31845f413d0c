//! Judges the motion of a scene (R2): nothing becomes infinite, no energy comes from nowhere, nothing gets further than
//! it could be thrown.
//!
//! ```text
//! own energy   motion (centred velocity), links, recovery, and the penalty springs of contact; mean over 1/60 s
//! work         what gravity did to the body since the start, moving obstacles (force × velocity of the surface) and what
//!              else was done to it from outside: obstacles that stand still do none, as what they give back was
//!              stored in their penalty springs, at the start too where a body was put into them
//! faultless    own energy ≤ own energy at the start + work + 5 % of the largest that sum has been,
//!              and what rounding shows and a fall within one substep gives, both next to nothing in common scenes
//! ```
//!
//! Each body is judged by itself, so that a heavy one does not hide a light one.

mod account;
mod energy_sample;
mod fault;
mod rounding;

pub use energy_sample::{EnergySample, Seen};
pub use fault::{Fault, GAIN, REACH};

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use account::Account;

use super::disturb::Disturbance;
use crate::geometry::Lattice;
use crate::math::{FRAME_SECS, Real};
use crate::physics::SOLVE_WORK;
use crate::physics::{Simulation, StepReport};
use crate::scene::Scene;

/// Energies are means over so much simulated time, s.
const WINDOW_SECS: f64 = FRAME_SECS;

/// `gelatin check` measures so much simulated time, s.
const FORETOLD_SECS: f64 = 0.5;

/// So many times the work that was foretold is not taken without a word.
const MORE_WORK: f64 = 100.0;

/// Looks at the energy in that time.
const LOOKS: u64 = 8;

/// How long a scene is watched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patience {
    /// Simulated time, s.
    pub seconds: f64,
    /// Link forces after which a scene is cut short.
    pub most_link_forces: u64,
}

/// What was seen of a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// What is wrong, if anything.
    pub fault: Option<Fault>,
    /// The fault in numbers.
    pub words: String,
    /// Simulated time that was watched, s.
    pub simulated_secs: f64,
    /// Whether that is less than it should have been, as it took too many substeps.
    pub cut_short: bool,
    /// Substeps taken.
    pub substeps: u64,
    /// Link forces and products of the implicit integrator's solver, over the links.
    pub work: u64,
    /// Substeps that reached the limit of the implicit integrator's work.
    pub slowed: u64,
    /// The most energy from nowhere, as a share of what was there.
    pub largest_gain: f64,
}

/// Watches a scene, in single precision as the sandbox runs it or in double; `lattices` are those of its bodies.
pub fn judge<R: Real>(scene: &Scene, lattices: &[Arc<Lattice>], patience: Patience) -> Verdict {
    judge_disturbed::<R>(scene, &[], lattices, patience)
}

/// The same of a scene of one body to which something happens in the order given.
pub fn judge_disturbed<R: Real>(
    scene: &Scene,
    disturbances: &[Disturbance],
    lattices: &[Arc<Lattice>],
    patience: Patience,
) -> Verdict {
    judge_followed::<R>(scene, disturbances, lattices, patience, |_| ())
}

/// The same, telling of every look and of everything that is done to the scene.
pub fn judge_followed<R: Real>(
    scene: &Scene,
    disturbances: &[Disturbance],
    lattices: &[Arc<Lattice>],
    patience: Patience,
    mut follow: impl FnMut(Seen<'_>),
) -> Verdict {
    let mut simulation = Simulation::<R>::new(scene, lattices);
    let mut coming = disturbances.iter().peekable();
    let mut watch = Watch::open(&simulation, patience);
    loop {
        let now = watch.verdict.substeps as f64 * simulation.plan().substep_secs();
        let mut before = None;
        while let Some(disturbance) = coming.next_if(|coming| coming.at_secs <= now) {
            let had = before.unwrap_or_else(|| simulation.diagnostics().energy.total());
            disturbance.happen(&mut simulation, scene, lattices);
            let has = energy_to_keep(&simulation);
            before = Some(has);
            watch.meddle(has - had);
            follow(Seen::Disturbed(disturbance, has - had));
        }
        let goes_on = watch.substep(&mut simulation);
        watch.looks.iter().for_each(|look| follow(Seen::Look(look)));
        if !goes_on {
            return watch.verdict;
        }
    }
}

/// All energy, J, that nothing need take after something was done to the scene.
///
/// The velocity at a position's time is that of half a substep ago and a share s of what the coming substep adds,
/// `v + s (dt F + J)/m`, where J is the impulse of contact with obstacles that stand still. A body that is thrown at a
/// plane has lost energy in it before it gets there. If the plane sweeps out of its way in that substep there is no J and
/// the body keeps all of its energy. If the plane comes towards it, what it has past that is the plane's work.
fn energy_to_keep<R: Real>(simulation: &Simulation<R>) -> f64 {
    let met = simulation.diagnostics().energy;
    if simulation.state().sweeps.is_empty() {
        return met.total();
    }
    let mut unmet = simulation.clone();
    unmet.plan_mut().contact = false;
    met.total().max(unmet.diagnostics().energy.total() + met.contact)
}

/// A simulation that is watched, substep by substep.
#[derive(Debug)]
pub struct Watch {
    patience: Patience,
    links: u64,
    /// Substeps to be taken at most.
    substeps: u64,
    /// Substeps in a window.
    window: u64,
    between_looks: u64,
    bodies: Vec<Account>,
    /// What was looked at in the last substep.
    looks: Vec<EnergySample>,
    forces: u64,
    taken: StepReport,
    /// The work that is to be expected, passes over the links in a second.
    foretold: f64,
    verdict: Verdict,
}

impl Watch {
    /// Begins with a simulation as it is.
    pub fn open<R: Real>(simulation: &Simulation<R>, patience: Patience) -> Self {
        let dt = simulation.plan().substep_secs();
        let links = simulation.model().link_counts().iter().sum::<usize>() as u64;
        let affordable = patience.most_link_forces / links.max(1);
        let wanted = count(patience.seconds / dt);
        let substeps = wanted.min(affordable.max(1));
        let window = count(WINDOW_SECS / dt).min(substeps);
        let verdict = Verdict {
            fault: None,
            words: String::new(),
            simulated_secs: 0.0,
            cut_short: substeps < wanted,
            substeps: 0,
            work: 0,
            slowed: 0,
            largest_gain: 0.0,
        };
        let bodies = (0..).zip(simulation.diagnostics_of_each());
        let bodies = bodies.map(|(body, start)| Account::open(simulation, body, start));
        Self {
            patience,
            links,
            substeps,
            window,
            between_looks: window.div_ceil(LOOKS),
            bodies: bodies.collect(),
            looks: Vec::new(),
            forces: 0,
            taken: StepReport::default(),
            foretold: f64::INFINITY,
            verdict,
        }
    }

    /// Counts work (J) that was done at once from outside.
    fn meddle(&mut self, work: f64) {
        self.bodies.iter_mut().for_each(|account| account.meddle(work));
    }

    /// Takes one substep and looks at it. Says whether there is more to see.
    pub fn substep<R: Real>(&mut self, simulation: &mut Simulation<R>) -> bool {
        if self.forces > self.patience.most_link_forces {
            self.verdict.cut_short = true;
            return false;
        }
        self.looks.clear();
        let substep = self.verdict.substeps;
        let begin_secs = simulation.state().time_secs;
        let diverged = self.advance(simulation);
        self.verdict.substeps = substep + 1;
        self.verdict.simulated_secs += simulation.state().time_secs - begin_secs;
        if diverged {
            self.condemn(Fault::NotFinite, format!("after {} s", self.verdict.simulated_secs));
            return false;
        }
        let look = substep.is_multiple_of(self.between_looks);
        let close = (substep + 1).is_multiple_of(self.window);
        if look || close {
            self.look(simulation, look, close);
        }
        self.count_work(simulation);
        self.verdict.fault.is_none() && self.verdict.substeps < self.substeps
    }

    /// Counts the work, and condemns a scene that takes far more of it than its first half second let expect.
    fn count_work<R: Real>(&mut self, simulation: &Simulation<R>) {
        let secs = self.verdict.simulated_secs;
        self.verdict.work = self.forces / self.links.max(1);
        self.verdict.slowed = self.taken.counters.slowed;
        let rate = self.verdict.work as f64 / secs;
        // What a body takes that does anything at all: one that sleeps takes nothing.
        let least = (1 + SOLVE_WORK) as f64 / simulation.plan().substep_secs();
        if secs <= FORETOLD_SECS {
            self.foretold = rate.max(least);
        } else if rate > MORE_WORK * self.foretold && self.taken.counters.slowed == 0 {
            self.condemn(Fault::Work, format!("{rate:.0} passes over the links a second, not {:.0}", self.foretold));
        }
    }

    /// What was seen.
    pub fn verdict(self) -> Verdict {
        self.verdict
    }

    /// Takes a whole substep, in parts where it is halved. Says whether it diverged.
    fn advance<R: Real>(&mut self, simulation: &mut Simulation<R>) -> bool {
        loop {
            let report = simulation.substep(&mut ());
            self.taken.add(&report);
            self.forces += report.counters.link_forces + report.counters.iterations * self.links;
            for account in &mut self.bodies {
                account.push(report.counters.fastest_surface_m_s, report.counters.obstacle_work_j);
            }
            let is_whole = simulation.state().is_between_substeps();
            if report.diverged || is_whole || self.forces > self.patience.most_link_forces {
                return report.diverged;
            }
        }
    }

    fn look<R: Real>(&mut self, simulation: &Simulation<R>, look: bool, close: bool) {
        let seen = if look { simulation.diagnostics_of_each() } else { Vec::new() };
        let mut seen = seen.into_iter();
        for account in &mut self.bodies {
            if let Some(now) = seen.next() {
                self.looks.extend(account.look(simulation, now, &self.taken));
            }
            if close {
                self.verdict.largest_gain = self.verdict.largest_gain.max(account.close(self.verdict.substeps));
            }
        }
        let fault = self.bodies.iter().find_map(|account| account.fault(self.verdict.simulated_secs));
        if let Some((fault, words)) = fault {
            self.condemn(fault, words);
        }
    }

    fn condemn(&mut self, fault: Fault, words: String) {
        (self.verdict.fault, self.verdict.words) = (Some(fault), words);
    }
}

/// At least one.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at least one, saturating")]
fn count(share: f64) -> u64 {
    libm::round(share).max(1.0) as u64
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::math::rng::Rng;
    use crate::physics::Arrival;
    use crate::report::disturb::What;
    use crate::report::extremes::{extreme, extreme_scene, lattices};
    use crate::scene::body::{CubeShape, Pose};
    use crate::scene::material::{Material, Spring, Springs};
    use crate::scene::obstacle::{Plane, Sphere};
    use crate::scene::settings::Stepping;
    use crate::scene::{Body, Obstacle, ObstacleShape, Shape};

    const PATIENCE: Patience = Patience { seconds: 0.5, most_link_forces: 30_000_000 };

    fn falling_cube() -> Scene {
        let mut scene = Scene { bodies: vec![Body::default()], ..Scene::default() };
        scene.bodies[0].pose.position[1] = 2.0;
        scene
    }

    fn seen(scene: &Scene, mut meddle: impl FnMut(&mut Simulation<f32>, u64)) -> Verdict {
        let mut simulation = Simulation::new(scene, &lattices(scene).expect("sound shapes"));
        let mut watch = Watch::open(&simulation, PATIENCE);
        loop {
            meddle(&mut simulation, watch.verdict.substeps);
            if !watch.substep(&mut simulation) {
                return watch.verdict();
            }
        }
    }

    #[test]
    fn a_sound_motion_is_left_alone() {
        let verdict = seen(&falling_cube(), |_, _| ());
        assert_eq!((verdict.fault, verdict.cut_short), (None, false), "{verdict:?}");
        assert!(verdict.largest_gain < 1e-3 && (verdict.simulated_secs - 0.5).abs() < 1e-3, "{verdict:?}");
    }

    #[test]
    fn a_body_that_is_squeezed_may_leave_faster_than_it_is_pushed() {
        // A ball of 300 m presses a body into the ground at 28 km/s and leaves it.
        let (scene, disturbances) = extreme(1, 6809);
        let lattices = lattices(&scene).expect("sound shapes");
        let verdict = judge_disturbed::<f32>(&scene, &disturbances, &lattices, PATIENCE);
        assert_eq!(verdict.fault, None, "{verdict:?}");
    }

    #[test]
    fn an_explosion_is_seen() {
        let mut scene = falling_cube();
        scene.settings.stepping = Stepping::Manual;
        scene.settings.dt = 0.1;
        let mut rng = Rng::new(1);
        let verdict = seen(&scene, |simulation, substep| {
            if substep == 0 {
                let mut state = simulation.state().clone();
                for v in &mut state.velocity {
                    *v += Vec3::X.lerp(Vec3::NEG_X, if rng.unit() < 0.5 { 0.4 } else { 0.6 });
                }
                simulation.set_state(state);
            }
        });
        assert!(verdict.fault.is_some(), "a manual step far above the limit: {verdict:?}");
    }

    #[test]
    fn a_tenth_more_energy_is_seen_and_a_fiftieth_is_not() {
        let gained = |share: f32| {
            seen(&falling_cube(), |simulation, substep| {
                if substep == 250 {
                    let mut state = simulation.state().clone();
                    state.velocity.iter_mut().for_each(|v| *v *= (1.0 + share).sqrt());
                    simulation.set_state(state);
                }
            })
        };
        let (tenth, fiftieth) = (gained(0.1), gained(0.02));
        assert_eq!(tenth.fault, Some(Fault::Energy), "{tenth:?}");
        assert!((0.05..0.11).contains(&tenth.largest_gain), "as soon as it is told: {tenth:?}");
        assert_eq!(fiftieth.fault, None, "{fiftieth:?}");
    }

    /// A ball sweeps into a cube that floats; later the cube has `share` more kinetic energy.
    fn kicked(share: f32) -> Verdict {
        let sphere = Sphere { center: [-1.2, 0.0, 0.0], radius: 0.5 };
        let ball = Obstacle { shape: ObstacleShape::Sphere(sphere), ..Obstacle::default() };
        let mut scene = Scene { bodies: vec![Body::default()], obstacles: vec![ball], ..Scene::default() };
        scene.bodies[0].pose.position = [0.0; 3];
        scene.settings.gravity = [0.0; 3];
        scene.settings.dt = 2e-4;
        let mut after = scene.clone();
        if let ObstacleShape::Sphere(sphere) = &mut after.obstacles[0].shape {
            sphere.center[0] = -0.7;
        }
        seen(&scene, |simulation, substep| match substep {
            10 => {
                simulation.set_parameters(&after, &lattices(&after).expect("sound shapes"), &[Some(0)], Arrival::Swept);
            }
            1000 => {
                let mut state = simulation.state().clone();
                state.velocity.iter_mut().for_each(|v| *v *= (1.0 + share).sqrt());
                simulation.set_state(state);
            }
            _ => (),
        })
    }

    #[test]
    fn the_work_of_an_obstacle_may_be_had_and_more_may_not() {
        let sound = kicked(0.0);
        assert!(sound.fault.is_none() && sound.largest_gain < GAIN && sound.substeps > 1500, "{sound:?}");
        // The kick keeps a tenth of it, the damping takes the rest.
        let gained = kicked(12.0);
        assert_eq!(gained.fault, Some(Fault::Energy), "{gained:?}");
    }

    /// A soft cube without gravity, in steps so long that an obstacle sweeps to its place in one of them.
    fn soft_cube(velocity: [f64; 3], ground: f64) -> Scene {
        let [structural, none] = [20.0, 0.0].map(|stiffness| Spring { stiffness, damping: 0.0 });
        let springs = Springs { structural, shear: none, bending: none, particle_mass: 1.0 };
        let shape = Shape::Cube(CubeShape { cells: 2, size: 0.2 });
        let material = Material::Springs(springs);
        let pose = Pose { position: [0.0; 3], ..Pose::default() };
        let body = Body { shape, pose, velocity, material, ..Body::default() };
        let mut scene = Scene { bodies: vec![body], obstacles: vec![plane_at(ground)], ..Scene::default() };
        scene.settings.gravity = [0.0; 3];
        scene.settings.dt = 0.05;
        scene.settings.inversion_recovery = false;
        scene
    }

    fn plane_at(height: f64) -> Obstacle {
        let plane = Plane { center: [0.0, height, 0.0], ..Plane::default() };
        Obstacle { shape: ObstacleShape::Plane(plane), ..Obstacle::default() }
    }

    #[test]
    fn a_plane_that_sweeps_away_leaves_a_thrown_body_all_its_energy() {
        // In the coming substep the plane would stop it.
        let scene = soft_cube([0.0, -100.0, 0.0], -0.2);
        let away = Box::new(Scene { obstacles: vec![plane_at(-1000.0)], ..scene.clone() });
        let sweep = What::Obstacles { scene: away, arrival: Arrival::Swept };
        let at_once = [sweep, What::Throw(0)].map(|what| Disturbance { at_secs: 0.01, what });
        let lattices = lattices(&scene).expect("a cube");
        let mut works = Vec::new();
        let verdict = judge_followed::<f32>(&scene, &at_once, &lattices, PATIENCE, |seen| {
            if let Seen::Disturbed(_, work) = seen {
                works.push(work);
            }
        });
        let thrown = 0.5 * 27.0 * 100.0 * 100.0;
        assert!(works.iter().sum::<f64>() > 0.9 * thrown, "{works:?} J of {thrown} J");
        assert!(works.iter().sum::<f64>() < 1.1 * thrown, "{works:?} J of {thrown} J");
        assert_eq!(verdict.fault, None, "{verdict:?}");
    }

    #[test]
    fn a_strained_body_gets_as_far_as_it_is_pushed_in_the_first_part_of_a_substep() {
        let scene = soft_cube([0.0; 3], -1.0);
        let lattices = lattices(&scene).expect("a cube");
        let mut simulation = Simulation::<f32>::new(&scene, &lattices);
        let mut state = simulation.state().clone();
        state.position.iter_mut().for_each(|x| *x *= 3.0);
        simulation.set_state(state);
        let mut watch = Watch::open(&simulation, PATIENCE);
        let after = Scene { obstacles: vec![plane_at(15.0)], ..scene.clone() };
        simulation.set_parameters(&after, &lattices, &[Some(0)], Arrival::Swept);
        assert!(watch.substep(&mut simulation) && watch.taken.counters.substeps > 1, "in parts: {watch:?}");
        while watch.substep(&mut simulation) {}
        assert!(simulation.diagnostics().center.y > 300.0, "{} m up", simulation.diagnostics().center.y);
        assert_eq!(watch.verdict().fault, None, "it is pushed at 960 m/s");
    }

    #[test]
    fn a_body_that_is_suddenly_elsewhere_is_seen() {
        let mut scene = falling_cube();
        scene.settings.gravity = [0.0; 3];
        let verdict = seen(&scene, |simulation, substep| {
            if substep == 100 {
                let mut state = simulation.state().clone();
                state.position.iter_mut().for_each(|x| x.x += 30.0);
                simulation.set_state(state);
            }
        });
        assert_eq!(verdict.fault, Some(Fault::Reach), "{verdict:?}");
    }

    #[test]
    fn a_nan_is_seen() {
        let verdict = seen(&falling_cube(), |simulation, substep| {
            if substep == 3 {
                let mut state = simulation.state().clone();
                state.velocity[5].y = f32::NAN;
                simulation.set_state(state);
            }
        });
        assert_eq!(verdict.fault, Some(Fault::NotFinite), "{verdict:?}");
    }

    #[test]
    fn what_takes_too_long_is_cut_short_and_says_so() {
        let hasty = Patience { most_link_forces: 100_000, ..PATIENCE };
        let scene = extreme_scene(1, 7);
        let verdict = judge::<f32>(&scene, &lattices(&scene).expect("sound shapes"), hasty);
        let cut_short = seen(&scene, |_, _| ()).substeps > verdict.substeps;
        assert_eq!(verdict.cut_short, cut_short, "{verdict:?}");
        let cube = judge::<f32>(&falling_cube(), &lattices(&falling_cube()).expect("sound shapes"), hasty);
        assert!(cube.cut_short && cube.simulated_secs < 0.05, "{cube:?}");
    }
}
