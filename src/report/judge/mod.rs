//! Judges the motion of a scene (R2): nothing becomes infinite, no energy comes from nowhere, nothing gets further than
//! it could be thrown.
//!
//! ```text
//! own energy   motion (velocities half a step before × after), links, recovery, and the penalty springs of contact;
//!              mean over 1/60 s and no fewer than eight substeps
//! work         what gravity did to the body since the start, moving obstacles (force × velocity of the surface) and what
//!              else was done to it from outside, and what parted bodies that were inside each other, which no spring
//!              held: obstacles that stand still do none, as what they give back was
//!              stored in their penalty springs, at the start too where a body was put into them
//! faultless    own energy ≤ own energy at the start + work + 5 % of the largest that sum has been,
//!              and what rounding shows and a fall within one substep gives, both next to nothing in common scenes
//! ```
//!
//! Each body is judged by itself, so that a heavy one does not hide a light one, until it meets another: from then on they
//! are judged together, with all that they have met. The velocities at a position's time have a share of the coming
//! substep's push, so a look sees whom a body meets in it.

mod account;
mod energy_sample;
mod fault;
mod met;
mod rounding;
#[cfg(test)]
mod tests;

pub use energy_sample::{EnergySample, Seen};
pub use fault::{Fault, GAIN, REACH};

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use account::Account;
use met::Met;

use super::disturb::Disturbance;
use crate::geometry::Lattice;
use crate::math::{FRAME_SECS, Real};
use crate::physics::SOLVE_WORK;
use crate::physics::{Simulation, StageTimer, StepReport};
use crate::scene::Scene;

/// Energies are means over so much simulated time, s, ...
const WINDOW_SECS: f64 = FRAME_SECS;

/// ... and over no fewer substeps: the energy of the highest mode swings within a period of some six of them.
const WINDOW_SUBSTEPS: u64 = 8;

/// `gelatin check` measures so much simulated time, s.
const FORETOLD_SECS: f64 = 0.5;

/// So many times the work that was foretold is not taken without a word.
const MORE_WORK: f64 = 100.0;

/// Looks at the energy in that time, not evenly spaced: see [`nth_look`].
const LOOKS: u64 = 8;

/// How long a scene is watched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patience {
    /// Simulated time, s.
    pub seconds: f64,
    /// Link forces after which a scene is cut short.
    pub most_link_forces: u64,
}

/// What became of a substep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Advance {
    Taken,
    /// Nothing has happened in its last part.
    GivenUp,
    Diverged,
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
    /// Substeps between two looks, in the mean.
    between_looks: u64,
    /// Looks taken.
    looked: u64,
    bodies: Vec<Account>,
    met: Met,
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
        let window = count(WINDOW_SECS / dt).max(WINDOW_SUBSTEPS).min(substeps);
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
        let (bodies, _) = simulation.diagnostics_of_each();
        let bodies = (0..).zip(bodies).map(|(body, start)| Account::open(simulation, body, start));
        let met = Met::new(simulation.model().bodies.len());
        Self {
            patience,
            links,
            substeps,
            window,
            between_looks: window.div_ceil(LOOKS),
            looked: 0,
            bodies: bodies.collect(),
            met,
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
        self.substep_unless(simulation, &mut ())
    }

    /// The same, but a substep that `timer` gives up is taken at the next call, with the same outcome.
    pub fn substep_unless<R: Real>(&mut self, simulation: &mut Simulation<R>, timer: &mut impl StageTimer) -> bool {
        if self.forces > self.patience.most_link_forces {
            self.verdict.cut_short = true;
            return false;
        }
        self.looks.clear();
        let substep = self.verdict.substeps;
        let begin_secs = simulation.state().time_secs;
        let advance = self.advance(simulation, timer);
        self.verdict.simulated_secs += simulation.state().time_secs - begin_secs;
        if advance == Advance::GivenUp {
            return true;
        }
        self.verdict.substeps = substep + 1;
        if advance == Advance::Diverged {
            self.condemn(Fault::NotFinite, format!("after {} s", self.verdict.simulated_secs));
            return false;
        }
        let look = substep == nth_look(self.looked, self.between_looks);
        self.looked += u64::from(look);
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

    /// Takes a whole substep, in parts where it is halved; what was given up leaves no trace.
    fn advance<R: Real>(&mut self, simulation: &mut Simulation<R>, timer: &mut impl StageTimer) -> Advance {
        loop {
            let report = simulation.substep(timer);
            if report.stopped {
                return Advance::GivenUp;
            }
            self.taken.add(&report);
            self.forces += report.counters.link_forces + report.counters.iterations * self.links;
            for account in &mut self.bodies {
                let work = report.counters.obstacle_work_j + report.counters.parting_work_j;
                account.push(report.counters.fastest_surface_m_s, work);
            }
            self.meet(simulation.met());
            let is_whole = simulation.state().is_between_substeps();
            if report.diverged {
                return Advance::Diverged;
            }
            if is_whole || self.forces > self.patience.most_link_forces {
                return Advance::Taken;
            }
        }
    }

    /// These pairs push each other.
    fn meet(&mut self, pairs: &[[usize; 2]]) {
        for &[one, other] in pairs {
            self.met.meet([one, other]);
            if one == other {
                self.bodies[one].strike_itself();
            }
        }
    }

    fn look<R: Real>(&mut self, simulation: &Simulation<R>, look: bool, close: bool) {
        let (seen, met) = if look { simulation.diagnostics_of_each() } else { Default::default() };
        self.meet(&met);
        let mut seen = seen.into_iter();
        for account in &mut self.bodies {
            if let Some(now) = seen.next() {
                self.looks.extend(account.look(simulation, now, &self.taken));
            }
        }
        if close {
            self.close();
        }
        let fault = (0..self.bodies.len())
            .find_map(|body| self.bodies[body].fault(self.verdict.simulated_secs, self.given_by_others(body)));
        if let Some((fault, words)) = fault {
            self.condemn(fault, words);
        }
    }

    /// Closes the window of every body, together with those that it has met.
    fn close(&mut self) {
        let Self { bodies, met, verdict, taken, .. } = self;
        // Rounding goes by the parts of substeps, too.
        let parts = taken.counters.substeps.max(verdict.substeps);
        for first in 0..bodies.len() {
            let those = bodies.iter_mut().zip(met.first()).filter(|(_, of)| **of == first);
            let mut those: Vec<&mut Account> = those.map(|(account, _)| account).collect();
            if !those.is_empty() {
                verdict.largest_gain = verdict.largest_gain.max(Account::close(&mut those, parts));
            }
        }
    }

    /// What those that a body has met could have given it at most, J; none where it has met no other.
    fn given_by_others(&self, body: usize) -> Option<f64> {
        let first = self.met.first();
        let others = self.bodies.iter().enumerate().filter(|(other, _)| *other != body && first[*other] == first[body]);
        others.map(|(_, account)| account.turnover()).reduce(|sum, one| sum + one)
    }

    fn condemn(&mut self, fault: Fault, words: String) {
        (self.verdict.fault, self.verdict.words) = (Some(fault), words);
    }
}

/// The substep of a look: so many substeps after the one before in the mean, earlier or later by a multiple of the golden
/// ratio (Weyl 1916). The energy of a vibration swings twice in its period, by a quarter of `(dt ω)²`; looks in step with it
/// would take one end of the swing for the mean.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of a few substeps")]
fn nth_look(number: u64, between: u64) -> u64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_8;
    let share = number as f64 * GOLDEN;
    number * between + ((share - share.floor()) * between as f64) as u64
}

/// At least one.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at least one, saturating")]
fn count(share: f64) -> u64 {
    libm::round(share).max(1.0) as u64
}
