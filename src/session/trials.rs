//! Cures are tried before they are offered, each on a copy for a simulated second: one that explodes again, or gains energy
//! from nowhere, is not offered. The trials run in slices between steps, so that nobody waits for them. Their results depend
//! on the scene alone, as work is counted in link forces and not in time.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use super::cures::Cure;
use super::stoppable::Stoppable;
use crate::geometry::Lattice;
use crate::physics::Arrival;
use crate::physics::Simulation;
use crate::report::judge::{MotionJudge, Patience};
use crate::scene::Scene;

/// The simulated time of a trial, and the link forces after which it is cut short: some seconds of work.
const TRIAL_LIMITS: Patience = Patience { seconds: 1.0, most_link_forces: 300_000_000 };

/// A trial that was cut short counts if nothing was wrong for this long, s: explosions take less.
const MIN_CUT_SHORT_SECS: f64 = 0.1;

/// Cures that are tried one after another.
#[derive(Debug)]
pub(super) struct Trials {
    scene: Scene,
    lattices: Vec<Arc<Lattice>>,
    /// The state from which a cure without a restart goes on.
    start: Box<Simulation<f32>>,
    waiting: VecDeque<Cure>,
    running: Option<Trial>,
    helpful_cures: Vec<Cure>,
}

/// A cure under trial.
#[derive(Debug)]
struct Trial {
    cure: Cure,
    simulation: Box<Simulation<f32>>,
    criterion: Criterion,
}

/// What a cure has to achieve.
#[derive(Debug)]
enum Criterion {
    /// A scene that starts anew must stay sound, with no energy from nowhere.
    StaysSound(Box<MotionJudge>),
    /// A body that goes on must be healed. Its energy is not checked, as turning its cells back adds some.
    HealsInversion { link_forces: u64, diverged: bool },
}

impl Trials {
    /// Prepares trials of cures for a scene that moves as `from` does now.
    pub(super) fn new(scene: &Scene, lattices: Vec<Arc<Lattice>>, from: &Simulation<f32>, cures: Vec<Cure>) -> Self {
        Self {
            scene: scene.clone(),
            lattices,
            start: Box::new(from.clone()),
            waiting: cures.into(),
            running: None,
            helpful_cures: Vec::new(),
        }
    }

    /// The cures that hold, of those tried so far.
    pub(super) fn helpful_cures(&self) -> &[Cure] {
        &self.helpful_cures
    }

    /// Whether all have been tried.
    pub(super) fn are_over(&self) -> bool {
        self.waiting.is_empty() && self.running.is_none()
    }

    /// The simulated time of the state that they go on from, s.
    pub(super) fn began_at_secs(&self) -> f64 {
        self.start.state().time_secs
    }

    /// Goes on until this instant, until all have been tried, or until `stop` is set.
    pub(super) fn run_until(&mut self, until: Option<Instant>, stop: &AtomicBool) {
        let goes_on = || until.is_none_or(|until| Instant::now() < until) && !stop.load(Ordering::Relaxed);
        while !self.are_over() && goes_on() {
            match &mut self.running {
                None => self.running = self.waiting.pop_front().and_then(|cure| self.begin(cure)),
                Some(trial) => {
                    if !trial.substep(self.start.state().time_secs, stop) {
                        self.finish_trial();
                    }
                }
            }
        }
    }

    /// Tries the next substep of the cure under trial and gives it up. Returns whether there was one.
    #[cfg(test)]
    pub(super) fn given_up(&mut self, stop: &AtomicBool) -> bool {
        let begin_secs = self.began_at_secs();
        self.running.as_mut().is_some_and(|trial| trial.substep(begin_secs, stop))
    }

    /// Begins a trial; none where the change is not allowed.
    fn begin(&self, cure: Cure) -> Option<Trial> {
        let mut scene = self.scene.clone();
        let _applied = scene.apply(cure.edit.clone()).ok()?;
        let simulation = if cure.restart {
            Simulation::new(&scene, &self.lattices)
        } else {
            let mut simulation = (*self.start).clone();
            let kept: Vec<_> = (0..scene.obstacles.len()).map(Some).collect();
            simulation.set_parameters(&scene, &self.lattices, &kept, Arrival::Placed);
            simulation
        };
        let criterion = if cure.restart {
            Criterion::StaysSound(Box::new(MotionJudge::open(&simulation, TRIAL_LIMITS)))
        } else {
            Criterion::HealsInversion { link_forces: 0, diverged: false }
        };
        Some(Trial { cure, simulation: Box::new(simulation), criterion })
    }

    fn finish_trial(&mut self) {
        let Some(Trial { cure, simulation, criterion }) = self.running.take() else { return };
        let helps = match criterion {
            Criterion::StaysSound(watch) => {
                let verdict = watch.verdict();
                verdict.fault.is_none() && (!verdict.cut_short || verdict.simulated_secs >= MIN_CUT_SHORT_SECS)
            }
            Criterion::HealsInversion { diverged, .. } => {
                !diverged && simulation.inverted_cells() < self.start.inverted_cells()
            }
        };
        if helps {
            self.helpful_cures.push(cure);
        }
    }
}

impl Trial {
    /// Takes a substep of a trial; one that is given up is taken at the next call. A motion without a restart began at
    /// `begin_secs`. Returns whether the trial goes on.
    fn substep(&mut self, begin_secs: f64, stop: &AtomicBool) -> bool {
        let mut timer = Stoppable { timer: None, stop };
        match &mut self.criterion {
            Criterion::StaysSound(watch) => watch.substep_unless(&mut self.simulation, &mut timer),
            Criterion::HealsInversion { link_forces, diverged } => {
                let report = self.simulation.substep(&mut timer);
                if report.stopped {
                    return true;
                }
                *link_forces += report.counters.link_forces;
                *diverged = report.diverged;
                let passed = self.simulation.state().time_secs - begin_secs;
                !report.diverged && passed < TRIAL_LIMITS.seconds && *link_forces < TRIAL_LIMITS.most_link_forces
            }
        }
    }
}
