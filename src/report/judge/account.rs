//! The energy of one body since a watch began: what it has, and what it can have.

use glam::DVec3;

use super::energy_sample::EnergySample;
use super::fault::{Fault, GAIN, REACH};
use super::rounding::Rounding;
use crate::math::{Real, Vector};
use crate::physics::{BodyModel, SAFETY, Simulation, StepReport};
use crate::physics::{Diagnostics, Energy};

/// Particles are light below this share of the mean: a corner of a cube of one solid weighs more.
const LIGHT: f64 = 0.1;

/// The energy of one body since the start.
#[derive(Debug)]
pub(super) struct Account {
    body: usize,
    start: Diagnostics,
    own_at_start: f64,
    /// Done from outside but by gravity, J.
    work: f64,
    /// Of it what was done at once, J.
    meddling: f64,
    /// The fastest surface of an obstacle that was met, m/s.
    fastest_push: f64,
    /// The most that its springs and those of contact held since then, J.
    squeezed: f64,
    /// The most that its springs held, J.
    held: f64,
    /// What the part of it weighs that the rest can throw, kg; infinite where no part is that much lighter.
    light_kg: f64,
    /// Whether it has met itself.
    strikes_itself: bool,
    /// The fastest that the spring of one contact made its particle then, had the particle no links, m/s.
    released: f64,
    gravity: DVec3,
    dt: f64,
    rounding: Rounding,
    now: Diagnostics,
    substeps: u64,
    /// Sums over the window: own energy, what it may be without work from outside, and that work.
    sums: [f64; 3],
    looks: u32,
    /// What it might have had more at the last look, J.
    lacks: f64,
    /// The largest that start and work came to, J.
    turnover: f64,
    gain: Option<String>,
}

impl Account {
    pub(super) fn open<R: Real>(simulation: &Simulation<R>, body: usize, start: Diagnostics) -> Self {
        let own_at_start = own(&start);
        let gravity = simulation.model().gravity.to_dvec3();
        let now = start.clone();
        Self {
            body,
            start,
            own_at_start,
            work: 0.0,
            meddling: 0.0,
            fastest_push: 0.0,
            squeezed: 0.0,
            held: 0.0,
            light_kg: light_mass(&simulation.model().bodies[body]),
            strikes_itself: false,
            released: 0.0,
            gravity,
            dt: simulation.plan().substep_secs(),
            rounding: Rounding::of(&simulation.model().bodies[body]),
            now,
            substeps: 0,
            sums: [0.0; 3],
            looks: 0,
            lacks: 0.0,
            turnover: own_at_start,
            gain: None,
        }
    }

    /// Counts work done at once from outside, J.
    pub(super) fn meddle(&mut self, work: f64) {
        self.work += work;
        self.meddling += work.max(0.0);
    }

    /// Counts the work (J) of obstacles of which the fastest surface moves at `speed` (m/s).
    pub(super) fn push(&mut self, speed: f64, work: f64) {
        self.work += work;
        self.fastest_push = self.fastest_push.max(speed);
    }

    /// It has met itself.
    pub(super) fn strike_itself(&mut self) {
        self.strikes_itself = true;
    }

    /// Looks at the energy; none of a body that fell out of the scene, which stays what it was when it was seen last.
    pub(super) fn look<R: Real>(
        &mut self,
        simulation: &Simulation<R>,
        now: Diagnostics,
        taken: &StepReport,
    ) -> Option<EnergySample> {
        let is_gone = simulation.state().bodies[self.body].gone;
        if !is_gone {
            self.now = now;
            self.rounding.see(self.now.bounds);
            let Energy { elastic, contact, recovery, .. } = self.now.energy;
            let held = elastic + contact + recovery;
            self.held = self.held.max(held);
            if self.fastest_push > 0.0 {
                self.squeezed = self.squeezed.max(held);
            }
            if self.fastest_push > 0.0 || self.looks == 0 && self.substeps == 0 {
                self.released = self.released.max(fastest_release(simulation, self.body));
            }
        }
        let by_itself = self.own_at_start + self.start.energy.gravity - self.now.energy.gravity;
        let allowed = by_itself + self.work;
        self.turnover = self.turnover.max(allowed);
        // One that is gone has what it had not when it was seen last: another may have it.
        if !is_gone {
            self.lacks = (allowed - own(&self.now)).max(0.0);
        }
        let terms = if is_gone { [0.0, self.lacks, 0.0] } else { [own(&self.now), by_itself, self.work] };
        for (sum, now) in self.sums.iter_mut().zip(terms) {
            *sum += now;
        }
        self.looks += 1;
        (!is_gone).then(|| EnergySample {
            time_secs: simulation.state().time_secs,
            body: self.body,
            kinetic: self.now.energy.kinetic,
            elastic: self.now.energy.elastic,
            recovery: self.now.energy.recovery,
            contact: self.now.energy.contact,
            own: own(&self.now),
            work: self.work,
            allowed,
            substeps: taken.counters.substeps,
            halved: taken.counters.halved,
            contacts: taken.last.contacts + taken.last.body_contacts,
            depth_m: taken.last.max_penetration_m,
        })
    }

    /// Closes a window of some bodies that share what they have, and tells of their gain as a share.
    pub(super) fn close(those: &mut [&mut Self], substeps: u64) -> f64 {
        let (mut sum, mut excused, mut turnover) = ([0.0, 0.0, 0.0_f64], 0.0, 0.0);
        for account in &mut *those {
            account.substeps = substeps;
            let [own, by_itself, work] = account.sums.map(|sum| sum / f64::from(account.looks.max(1)));
            (account.sums, account.looks) = ([0.0; 3], 0);
            // Work from outside is counted for all bodies together.
            sum = [sum[0] + own, sum[1] + by_itself, if work.abs() > sum[2].abs() { work } else { sum[2] }];
            excused += account.rounding.energy(substeps) + account.unresolved();
            turnover += account.turnover;
        }
        let [own, allowed] = [sum[0], sum[1] + sum[2]];
        let share = (own - allowed - excused) / turnover.max(f64::MIN_POSITIVE);
        if share > GAIN || share.is_nan() {
            let bodies: Vec<String> = those.iter().map(|account| account.body.to_string()).collect();
            let words = match &bodies[..] {
                [body] => format!("body {body}"),
                bodies => format!("bodies {}", bodies.join(", ")),
            };
            those[0].gain = Some(format!("{own:e} J where {allowed:e} J can be, {words}"));
        }
        share
    }

    /// The most energy that it had to give to others, J.
    pub(super) fn turnover(&self) -> f64 {
        self.turnover
    }

    /// What gravity gives a body that is let go in the middle of a substep, J: steps cannot tell when. It is nothing but
    /// where gravity is great and the step long.
    fn unresolved(&self) -> f64 {
        let speed = 0.5 * self.gravity.length() * self.dt;
        0.5 * self.start.mass_kg * speed * speed
    }

    /// What is wrong, where others that it has met could give the body so much energy (J).
    pub(super) fn fault(&self, seconds: f64, given: Option<f64>) -> Option<(Fault, String)> {
        if !self.now.finite {
            return Some((Fault::NotFinite, format!("after {seconds} s")));
        }
        if let Some(words) = &self.gain {
            return Some((Fault::Energy, format!("{words}, after {seconds} s")));
        }
        let [reach, furthest] = [self.reach(seconds, given), self.furthest()];
        (furthest > REACH * reach).then(|| (Fault::Reach, format!("{furthest} m away of {reach} m, after {seconds} s")))
    }

    /// How far the body could get by its start: by its speed, by gravity, by what it is pushed out of obstacles with, by
    /// obstacles that push it and its own size, m. A body that is squeezed between obstacles leaves faster than they move,
    /// by what its springs held. Where links are next to nothing, one particle leaves with all
    /// that the spring of its own contact held. A light part that is caught by an obstacle while the heavy rest flies on
    /// is thrown by what the springs between them held; one that the heavy rest strikes as bodies strike each other, by all
    /// that this had. What rounding may show it may fly apart with, and what other bodies could give it. Bodies meet each
    /// other by points of their cells, and a cell that is thrown back at a point near a corner may leave that with all that
    /// its eight have: √8 times as fast.
    fn reach(&self, seconds: f64, given: Option<f64>) -> f64 {
        let stored = (self.own_at_start - self.start.energy.kinetic).max(self.squeezed)
            + self.meddling
            + given.unwrap_or(0.0)
            + self.rounding.energy(self.substeps);
        let whole = (2.0 * stored.max(0.0) / self.start.mass_kg).sqrt();
        let struck = if self.strikes_itself { self.turnover } else { 0.0 };
        let thrown = (2.0 * (self.held + struck).max(0.0) / self.light_kg).sqrt();
        let gathered = if self.strikes_itself || given.is_some() { 8.0_f64.sqrt() } else { 1.0 };
        let speed = gathered * (self.start.max_speed + whole.max(self.released).max(thrown)) + self.fastest_push;
        let size = self.start.bounds.size().length();
        speed * seconds + 0.5 * self.gravity.length() * seconds * (seconds + self.dt) + size
    }

    /// Of the start's middle, m.
    fn furthest(&self) -> f64 {
        let bounds = self.now.bounds;
        let middle = self.start.bounds.center();
        (bounds.min - middle).abs().max((bounds.max - middle).abs()).length()
    }
}

/// What the light particles of a body weigh together, kg; infinite where none is light to the others.
fn light_mass<R: Real>(body: &BodyModel<R>) -> f64 {
    let masses = || (0..body.particles.len()).map(|particle| body.mass(particle).to_f64());
    let light = LIGHT * masses().sum::<f64>() / body.particles.len() as f64;
    let sum: f64 = masses().filter(|mass| *mass < light).sum();
    if sum > 0.0 { sum } else { f64::INFINITY }
}

/// The fastest that the spring of a contact in the last substep could make its particle, m/s.
fn fastest_release<R: Real>(simulation: &Simulation<R>, number: usize) -> f64 {
    let body = &simulation.model().bodies[number];
    let own = simulation.contacts().iter().filter(|contact| body.particles.contains(&contact.particle));
    let speeds = own.map(|contact| {
        let stored = body.contacts[contact.obstacle].to_f64().energy(-contact.gap.to_f64());
        (2.0 * stored / body.mass(contact.particle - body.particles.start).to_f64()).sqrt()
    });
    let on_mesh = simulation.sample_contacts().iter().filter(|contact| contact.body == number);
    let of_points = on_mesh.map(|contact| {
        let stored = body.contacts[contact.obstacle].to_f64().energy(-contact.gap);
        let carried = contact.carriers.iter().zip(contact.weights);
        let mobility = carried.map(|(at, w)| w * w / body.mass(at - body.particles.start).to_f64()).sum::<f64>();
        (2.0 * stored * mobility).sqrt()
    });
    speeds.chain(of_points).fold(0.0, f64::max)
}

/// Energy without that of height, J, as leapfrog keeps it: what is in links swings by up to a fifth of the whole as it
/// becomes motion and back, which is no gain. Not more is taken off than a vibration within the bound has, or one that
/// grows would not be seen.
fn own(diagnostics: &Diagnostics) -> f64 {
    let Diagnostics { energy, half_step, .. } = diagnostics;
    energy.total() - energy.gravity - half_step.min(SAFETY * SAFETY * energy.elastic)
}
