//! Judges the motion of a scene: nothing becomes infinite, no energy comes from nowhere, nothing gets further than
//! it could be thrown.
//!
//! ```text
//! own energy   motion (velocities half a step before × after), links, recovery, and the penalty springs of contact;
//!              mean over 1/60 s and no fewer than eight substeps
//! work         since the start: gravity's, that of moving obstacles (force × velocity of the surface), disturbances from
//!              outside, and what parted bodies inside each other, which no spring held. Obstacles that stand still do
//!              none: they give back what their penalty springs stored, at the start too where a body was put into them
//! faultless    own energy ≤ own energy at the start + work + 5 % of the largest that sum has been,
//!              and the energy of rounding errors and of a fall within one substep, both next to nothing in common scenes
//! ```
//!
//! Each body is judged alone, so that a heavy one does not hide a light one, until it meets another: from then on it is
//! judged together with all bodies that it has met. The velocities at a position's time include a share of the coming
//! substep's push, so a sample also counts the bodies that meet in that substep, and is complete once the work of obstacles in
//! it is known.

mod account;
mod contact_groups;
mod energy_sample;
mod fault;
mod pinch;
mod rounding;
#[cfg(test)]
mod tests;

pub use energy_sample::{EnergySample, JudgeEvent};
pub use fault::{Fault, MAX_ENERGY_GAIN, REACH_TOLERANCE};

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use account::EnergyAccount;
use contact_groups::ContactGroups;

use super::disturb::Disturbance;
use crate::geometry::Lattice;
use crate::math::{FRAME_SECS, Real};
use crate::physics::SOLVE_WORK;
use crate::physics::{Counters, Simulation, StageTimer, StepReport};
use crate::scene::Scene;

/// Energies are means over this much simulated time, s, ...
const WINDOW_SECS: f64 = FRAME_SECS;

/// ... and over no fewer substeps: the energy of the highest mode swings within a period of some six of them.
const WINDOW_SUBSTEPS: u64 = 8;

/// `gelatin check` measures this much simulated time, s, and foretells the work from it.
const PREDICTION_SECS: f64 = 0.5;

/// A scene that takes more than this many times the work foretold, without being slowed, is at fault.
const MAX_WORK_RATIO: f64 = 100.0;

/// Samples of the energy in a window, not evenly spaced: see [`nth_sample_substep`].
const SAMPLES_PER_WINDOW: u64 = 8;

/// A scene that has taken this share of the most work is cut short ...
const TRIAL_SHARE: f64 = 0.1;

/// ... unless what is left of it would be enough for the rest at this many times the speed so far. Most scenes that are slow stay
/// so, and all of the work can take minutes; but violent motions calm down: of three scenes that would have taken 1.2 to
/// 1.3 times all of it at their first speed, two were over within it.
const HOPED_SPEEDUP: f64 = 3.0;

/// How long a scene is watched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patience {
    /// Simulated time, s.
    pub seconds: f64,
    /// Link forces after which a scene is cut short; after a tenth of them, where they cannot be enough.
    pub most_link_forces: u64,
}

/// The outcome of a substep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SubstepOutcome {
    Taken,
    /// The substep was given up; its last part has left no trace.
    GivenUp,
    Diverged,
}

/// What was found of a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// What is wrong, if anything.
    pub fault: Option<Fault>,
    /// The fault in numbers.
    pub words: String,
    /// Simulated time that was watched, s.
    pub simulated_secs: f64,
    /// Whether the time was cut short, as the scene took too much work.
    pub cut_short: bool,
    /// Substeps taken.
    pub substeps: u64,
    /// Link forces and products of the implicit integrator's solver, over the links.
    pub work: u64,
    /// Substeps that reached the limit of the implicit integrator's work.
    pub slowed: u64,
    /// The largest gain of energy from nowhere, as a share of the energy there was.
    pub largest_gain: f64,
}

/// Judges a scene, in single precision as the sandbox runs it or in double; `lattices` are those of its bodies.
pub fn judge<R: Real>(scene: &Scene, lattices: &[Arc<Lattice>], patience: Patience) -> Verdict {
    judge_disturbed::<R>(scene, &[], lattices, patience)
}

/// Judges a scene of one body with disturbances in the order given.
pub fn judge_disturbed<R: Real>(
    scene: &Scene,
    disturbances: &[Disturbance],
    lattices: &[Arc<Lattice>],
    patience: Patience,
) -> Verdict {
    judge_with_events::<R>(scene, disturbances, lattices, patience, |_| ())
}

/// As [`judge_disturbed`], reporting every sample and every disturbance.
pub fn judge_with_events<R: Real>(
    scene: &Scene,
    disturbances: &[Disturbance],
    lattices: &[Arc<Lattice>],
    patience: Patience,
    mut on_event: impl FnMut(JudgeEvent<'_>),
) -> Verdict {
    let mut simulation = Simulation::<R>::new(scene, lattices);
    let mut coming = disturbances.iter().peekable();
    let mut judge = MotionJudge::open(&simulation, patience);
    loop {
        let now = judge.verdict.substeps as f64 * simulation.plan().substep_secs();
        let mut before = None;
        while let Some(disturbance) = coming.next_if(|coming| coming.at_secs <= now) {
            let had = before.unwrap_or_else(|| energy_so_far(&simulation));
            disturbance.apply(&mut simulation, scene, lattices);
            let has = energy_to_keep(&simulation);
            before = Some(has);
            judge.add_sudden_work(has - had);
            on_event(JudgeEvent::Disturbed(disturbance, has - had));
        }
        if before.is_some() && judge.sample_pending {
            // The push in the coming substep, which the sample has half of, is another one now.
            judge.take_sample(&simulation);
        }
        let goes_on = judge.substep(&mut simulation);
        judge.samples.iter().for_each(|sample| on_event(JudgeEvent::Sample(sample)));
        if !goes_on {
            return judge.verdict;
        }
    }
}

/// The energy, J, that the bodies have before a disturbance: without what a push of contact would add in the coming substep,
/// which comes no more and is not in the work so far.
fn energy_so_far<R: Real>(simulation: &Simulation<R>) -> f64 {
    let with_contact = simulation.diagnostics().energy;
    let without_contact = without_contact(simulation).diagnostics().energy;
    with_contact.total().min(without_contact.total() + with_contact.contact)
}

/// The energy, J, that the bodies may keep after a disturbance.
///
/// The velocity at a position's time is that of half a substep ago plus a share s of the coming substep's change, `v + s (dt
/// F + J)/m`, where J is the impulse of contact with obstacles that stand still. With J, a body thrown at a plane loses
/// energy before it gets there. If the plane sweeps out of its way in that substep, or what a body is thrown in deep inside parts
/// it otherwise than that, there is no J and the body keeps all of its energy. If the plane comes towards the body, the energy
/// beyond that is the plane's work.
fn energy_to_keep<R: Real>(simulation: &Simulation<R>) -> f64 {
    let with_contact = simulation.diagnostics().energy;
    let without_contact = without_contact(simulation).diagnostics().energy;
    with_contact.total().max(without_contact.total() + with_contact.contact)
}

/// The same state in a scene where nothing touches.
fn without_contact<R: Real>(simulation: &Simulation<R>) -> Simulation<R> {
    let mut apart = simulation.clone();
    let plan = apart.plan_mut();
    (plan.contact, plan.between_bodies, plan.on_mesh) = (false, None, None);
    apart
}

/// A simulation that is watched, substep by substep.
#[derive(Debug)]
pub struct MotionJudge {
    patience: Patience,
    links: u64,
    /// The most substeps to take.
    substeps: u64,
    /// Substeps in a window.
    window: u64,
    /// Substeps between two samples, in the mean.
    sample_interval: u64,
    /// Samples taken.
    sample_count: u64,
    accounts: Vec<EnergyAccount>,
    contact_groups: ContactGroups,
    /// Whether a window ended with the last substep; it is closed after the coming one.
    window_ended: bool,
    /// Whether the last sample is incomplete.
    sample_pending: bool,
    /// The samples completed in the last substep.
    samples: Vec<EnergySample>,
    link_forces: u64,
    totals: StepReport,
    /// The work to be expected, as passes over the links in a second.
    predicted_work_rate: f64,
    verdict: Verdict,
}

impl MotionJudge {
    /// Begins with a simulation in its present state.
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
        let [with_contact, without_contact] =
            [simulation.diagnostics_of_each().0, without_contact(simulation).diagnostics_of_each().0];
        let starts = (0..).zip(with_contact.into_iter().zip(without_contact));
        let accounts = starts.map(|(body, starts)| EnergyAccount::open(simulation, body, starts));
        let contact_groups = ContactGroups::new(simulation.model().bodies.len());
        Self {
            patience,
            links,
            substeps,
            window,
            sample_interval: window.div_ceil(SAMPLES_PER_WINDOW),
            sample_count: 0,
            accounts: accounts.collect(),
            contact_groups,
            window_ended: false,
            sample_pending: false,
            samples: Vec::new(),
            link_forces: 0,
            totals: StepReport::default(),
            predicted_work_rate: f64::INFINITY,
            verdict,
        }
    }

    /// Counts work (J) that was done at once from outside.
    fn add_sudden_work(&mut self, work: f64) {
        self.accounts.iter_mut().for_each(|account| account.add_sudden_work(work));
    }

    /// Takes one substep and looks at it. Returns whether there is more to see.
    pub fn substep<R: Real>(&mut self, simulation: &mut Simulation<R>) -> bool {
        self.substep_unless(simulation, &mut ())
    }

    /// As [`MotionJudge::substep`], but a substep that `timer` gives up is taken at the next call, with the same outcome.
    pub fn substep_unless<R: Real>(&mut self, simulation: &mut Simulation<R>, timer: &mut impl StageTimer) -> bool {
        self.samples.clear();
        if self.link_forces > self.patience.most_link_forces || self.is_hopeless() {
            self.verdict.cut_short = true;
            self.settle();
            return false;
        }
        self.accounts.iter_mut().for_each(EnergyAccount::begin_substep);
        let substep = self.verdict.substeps;
        let begin_secs = simulation.state().time_secs;
        let advance = self.advance(simulation, timer);
        self.verdict.simulated_secs += simulation.state().time_secs - begin_secs;
        if advance == SubstepOutcome::GivenUp {
            return true;
        }
        self.verdict.substeps = substep + 1;
        if advance == SubstepOutcome::Diverged {
            self.record_fault(Fault::NotFinite, format!("after {} s", self.verdict.simulated_secs));
            return false;
        }
        self.settle();
        let is_sample_due = substep == nth_sample_substep(self.sample_count, self.sample_interval);
        self.sample_count += u64::from(is_sample_due);
        let ends_window = (substep + 1).is_multiple_of(self.window);
        if is_sample_due {
            self.take_sample(simulation);
        }
        self.window_ended = ends_window;
        self.count_work(simulation);
        if self.verdict.substeps >= self.substeps {
            self.settle();
        }
        self.verdict.fault.is_none() && self.verdict.substeps < self.substeps
    }

    /// Whether the scene would not be over by the most work that it may take.
    fn is_hopeless(&self) -> bool {
        let share = self.link_forces as f64 / self.patience.most_link_forces as f64;
        let secs = self.verdict.simulated_secs;
        share > TRIAL_SHARE && HOPED_SPEEDUP * secs * (1.0 - share) < share * (self.patience.seconds - secs)
    }

    /// Counts the work, and condemns a scene that takes far more of it than its first half second suggests.
    fn count_work<R: Real>(&mut self, simulation: &Simulation<R>) {
        let secs = self.verdict.simulated_secs;
        self.verdict.work = self.link_forces / self.links.max(1);
        self.verdict.slowed = self.totals.counters.slowed;
        // Into how many parts contact of points divides a substep is told before, and may be thousands.
        let not_told = self.verdict.work.saturating_sub(self.totals.counters.contact_parts);
        let rate = not_told as f64 / secs;
        // The least work of a body that moves; a sleeping body takes none.
        let least = (1 + SOLVE_WORK) as f64 / simulation.plan().substep_secs();
        if secs <= PREDICTION_SECS {
            self.predicted_work_rate = rate.max(least);
        } else if rate > MAX_WORK_RATIO * self.predicted_work_rate && self.totals.counters.slowed == 0 {
            self.record_fault(
                Fault::Work,
                format!("{rate:.0} passes over the links a second, not {:.0}", self.predicted_work_rate),
            );
        }
    }

    /// Returns what was found.
    pub fn verdict(self) -> Verdict {
        self.verdict
    }

    /// Takes a whole substep, in parts where it is halved; a part that was given up leaves no trace.
    fn advance<R: Real>(&mut self, simulation: &mut Simulation<R>, timer: &mut impl StageTimer) -> SubstepOutcome {
        loop {
            let report = simulation.substep(timer);
            if report.stopped {
                return SubstepOutcome::GivenUp;
            }
            self.totals.add(&report);
            self.link_forces += report.counters.link_forces + report.counters.iterated_links;
            // An obstacle that takes energy from one of several bodies takes none from the others.
            let is_alone = self.accounts.len() == 1;
            let Counters { obstacle_work_j, obstacle_gain_j, .. } = report.counters;
            let by_obstacles = if is_alone { obstacle_work_j } else { obstacle_gain_j };
            for account in &mut self.accounts {
                let work = by_obstacles + report.counters.parting_work_j;
                account.add_obstacle_work(simulation, report.counters.fastest_surface_m_s, work);
            }
            self.record_contacts(simulation.met());
            let is_whole = simulation.is_between_substeps();
            if report.diverged {
                return SubstepOutcome::Diverged;
            }
            if is_whole || self.link_forces > self.patience.most_link_forces {
                return SubstepOutcome::Taken;
            }
        }
    }

    /// Notes the pairs of bodies that push each other.
    fn record_contacts(&mut self, pairs: &[[usize; 2]]) {
        for &[one, other] in pairs {
            self.contact_groups.join([one, other]);
            if one == other {
                self.accounts[one].mark_self_contact();
            }
        }
    }

    fn take_sample<R: Real>(&mut self, simulation: &Simulation<R>) {
        let (seen, met) = simulation.diagnostics_of_each();
        self.record_contacts(&met);
        for (account, now) in self.accounts.iter_mut().zip(seen) {
            account.take_sample(simulation, now, &self.totals);
        }
        self.sample_pending = true;
    }

    /// Completes the sample and the window that ended with the substep before, and looks for faults.
    fn settle(&mut self) {
        if !(std::mem::take(&mut self.sample_pending) || self.window_ended) {
            return;
        }
        self.samples.extend(self.accounts.iter_mut().filter_map(EnergyAccount::settle_sample));
        if std::mem::take(&mut self.window_ended) {
            self.close_window();
        }
        let fault = (0..self.accounts.len())
            .find_map(|body| self.accounts[body].fault(self.verdict.simulated_secs, self.energy_from_others(body)));
        if let Some((fault, words)) = fault {
            self.record_fault(fault, words);
        }
    }

    /// Closes the window of every body, together with those that it has met.
    fn close_window(&mut self) {
        let Self { accounts, contact_groups, verdict, totals, .. } = self;
        // Rounding errors grow with the parts of substeps, too.
        let parts = totals.counters.substeps.max(verdict.substeps);
        for first in 0..accounts.len() {
            let those = accounts.iter_mut().zip(contact_groups.representatives()).filter(|(_, of)| **of == first);
            let mut those: Vec<&mut EnergyAccount> = those.map(|(account, _)| account).collect();
            if !those.is_empty() {
                verdict.largest_gain = verdict.largest_gain.max(EnergyAccount::close_window(&mut those, parts));
            }
        }
    }

    /// The most energy that the bodies met by a body could have given it, J; none where it has met no other.
    fn energy_from_others(&self, body: usize) -> Option<f64> {
        let representatives = self.contact_groups.representatives();
        let others = self
            .accounts
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != body && representatives[*other] == representatives[body]);
        others.map(|(_, account)| account.max_allowed_energy()).reduce(|sum, one| sum + one)
    }

    fn record_fault(&mut self, fault: Fault, words: String) {
        (self.verdict.fault, self.verdict.words) = (Some(fault), words);
    }
}

/// The substep of a sample. Samples are `between` substeps apart on average, shifted by multiples of the golden ratio (Weyl
/// 1916). The energy of a vibration swings twice in its period, by a quarter of `(dt ω)²`; samples in step with it would take
/// one end of the swing for the mean.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of a few substeps")]
fn nth_sample_substep(number: u64, between: u64) -> u64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_8;
    let share = number as f64 * GOLDEN;
    number * between + ((share - share.floor()) * between as f64) as u64
}

/// A count of at least one.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at least one, saturating")]
fn count(share: f64) -> u64 {
    libm::round(share).max(1.0) as u64
}
