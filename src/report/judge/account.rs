//! The energy account of one body since a watch began: the energy that it has, and the most that it can have.

use glam::DVec3;

use super::energy_sample::EnergySample;
use super::fault::{Fault, MAX_ENERGY_GAIN, REACH_TOLERANCE};
use super::pinch::pinched_speed;
use super::rounding::Rounding;
use crate::math::{Real, Vector};
use crate::physics::{BodyModel, SAFETY, Simulation, StepReport};
use crate::physics::{Diagnostics, Energy};

/// Particles below this share of the mean mass are light: a corner of a cube of one solid weighs more.
const LIGHT_MASS_SHARE: f64 = 0.1;

/// The energy account of one body since the start of the watch.
#[derive(Debug)]
pub(super) struct EnergyAccount {
    body: usize,
    start: Diagnostics,
    own_at_start: f64,
    /// Work done from outside, without gravity's, J.
    work: f64,
    /// The part of it that was done at once, J.
    sudden_work: f64,
    /// The work that obstacles did in the last substep, J.
    work_in_substep: f64,
    /// The fastest surface of an obstacle that the body met, m/s.
    max_surface_speed: f64,
    /// The largest speed of a particle that leaves between two surfaces, m/s.
    max_pinched_speed: f64,
    /// The most energy in its springs and contact springs since it met a moving surface, J.
    max_squeezed_energy: f64,
    /// The most energy in its springs and contact springs, J.
    max_stored_energy: f64,
    /// Mass of the light particles, which the rest can throw, kg; infinite where no particle is light.
    light_mass_kg: f64,
    /// Whether it has met itself.
    has_self_contact: bool,
    /// Whether it meets obstacles by points of its mesh, which its cells carry.
    meets_by_points: bool,
    /// The largest speed to which a single contact spring could push its particle, if the particle had no links, m/s; at the
    /// start and since the body met a moving surface.
    max_release_speed: f64,
    gravity: DVec3,
    dt: f64,
    rounding: Rounding,
    now: Diagnostics,
    substeps: u64,
    /// Sums over the window: own energy, the energy allowed without work from outside, and that work.
    sums: [f64; 3],
    sample_count: u32,
    /// The last sample, as long as the work of the coming substep is not known.
    pending: Option<PendingSample>,
    /// The allowed energy that it did not have at the last sample, J.
    missing_energy: f64,
    /// The largest sum so far of energy at the start and work, J.
    max_allowed_energy: f64,
    gain: Option<String>,
}

/// A sample of the energy, J. The velocity at a position's time has half of the coming substep's change already, so half of
/// the work of obstacles in that substep belongs to it: all there is to allow for a body that an obstacle is about to strike.
#[derive(Clone, Debug)]
struct PendingSample {
    /// The sample, with the work until then.
    sample: EnergySample,
    /// The energy allowed without work from outside.
    by_itself: f64,
    /// The work of obstacles in the substep before.
    work_before: f64,
    is_gone: bool,
}

impl EnergyAccount {
    /// Opens the account of a body with these diagnostics of the start, and those without contact: a body that is thrown at
    /// something has lost energy to it before it gets there, see [`super::energy_to_keep`].
    pub(super) fn open<R: Real>(
        simulation: &Simulation<R>,
        body: usize,
        (start, without_contact): (Diagnostics, Diagnostics),
    ) -> Self {
        let own_at_start = own(&start).max(own(&without_contact) + start.energy.contact);
        let model = simulation.model();
        let gravity = model.gravity.to_dvec3();
        let now = start.clone();
        Self {
            body,
            start,
            own_at_start,
            work: 0.0,
            sudden_work: 0.0,
            work_in_substep: 0.0,
            max_surface_speed: 0.0,
            max_pinched_speed: 0.0,
            max_squeezed_energy: 0.0,
            max_stored_energy: 0.0,
            light_mass_kg: light_mass(&simulation.model().bodies[body]),
            has_self_contact: false,
            meets_by_points: model.bodies[body].sample_count() > 0,
            max_release_speed: 0.0,
            gravity,
            dt: simulation.plan().substep_secs(),
            rounding: Rounding::of(&simulation.model().bodies[body]),
            now,
            substeps: 0,
            sums: [0.0; 3],
            sample_count: 0,
            pending: None,
            missing_energy: 0.0,
            max_allowed_energy: own_at_start,
            gain: None,
        }
    }

    /// Counts work done at once from outside, J.
    pub(super) fn add_sudden_work(&mut self, work: f64) {
        self.work += work;
        self.sudden_work += work.max(0.0);
    }

    /// Begins a substep.
    pub(super) fn begin_substep(&mut self) {
        self.work_in_substep = 0.0;
    }

    /// Counts the work (J) in the last substep of obstacles whose fastest surface moves at `speed` (m/s).
    pub(super) fn add_obstacle_work<R: Real>(&mut self, simulation: &Simulation<R>, speed: f64, work: f64) {
        self.work += work;
        self.work_in_substep += work;
        self.max_surface_speed = self.max_surface_speed.max(speed);
        if speed > 0.0 {
            self.max_pinched_speed = self.max_pinched_speed.max(pinched_speed(simulation, self.body));
        }
    }

    /// Notes that the body has met itself.
    pub(super) fn mark_self_contact(&mut self) {
        self.has_self_contact = true;
    }

    /// Samples the energy. A body that fell out of the scene keeps its last values.
    pub(super) fn take_sample<R: Real>(&mut self, simulation: &Simulation<R>, now: Diagnostics, totals: &StepReport) {
        let is_gone = simulation.state().bodies[self.body].gone;
        if !is_gone {
            self.now = now;
            self.rounding.include(self.now.bounds);
            let Energy { elastic, contact, recovery, .. } = self.now.energy;
            let stored_energy = elastic + contact + recovery;
            self.max_stored_energy = self.max_stored_energy.max(stored_energy);
            if self.max_surface_speed > 0.0 {
                self.max_squeezed_energy = self.max_squeezed_energy.max(stored_energy);
            }
            if self.max_surface_speed > 0.0 || self.sample_count == 0 && self.substeps == 0 {
                self.max_release_speed = self.max_release_speed.max(release_speed(simulation, self.body));
            }
        }
        let by_itself = self.own_at_start + self.start.energy.gravity - self.now.energy.gravity;
        let sample = EnergySample {
            time_secs: simulation.state().time_secs,
            body: self.body,
            kinetic: self.now.energy.kinetic,
            elastic: self.now.energy.elastic,
            recovery: self.now.energy.recovery,
            contact: self.now.energy.contact,
            own: own(&self.now),
            work: self.work,
            allowed: by_itself + self.work,
            substeps: totals.counters.substeps,
            halved: totals.counters.halved,
            contacts: totals.last.contacts + totals.last.body_contacts,
            depth_m: totals.last.max_penetration_m,
        };
        self.pending = Some(PendingSample { sample, by_itself, work_before: self.work_in_substep, is_gone });
    }

    /// Completes the last sample: the work in the substep after it is known, or there is none. Gives no sample of a body that
    /// fell out of the scene.
    pub(super) fn settle_sample(&mut self) -> Option<EnergySample> {
        let PendingSample { mut sample, by_itself, work_before, is_gone } = self.pending.take()?;
        sample.work += 0.5 * self.work_in_substep.max(work_before).max(0.0);
        sample.allowed = by_itself + sample.work;
        let EnergySample { own, work, allowed, .. } = sample;
        self.max_allowed_energy = self.max_allowed_energy.max(allowed);
        // A body that is gone may have given the energy it lacked when last seen to another body.
        if !is_gone {
            self.missing_energy = (allowed - own).max(0.0);
        }
        let terms = if is_gone { [0.0, self.missing_energy, 0.0] } else { [own, by_itself, work] };
        for (sum, now) in self.sums.iter_mut().zip(terms) {
            *sum += now;
        }
        self.sample_count += 1;
        (!is_gone).then_some(sample)
    }

    /// Closes a window of some bodies that share their energy, and returns their gain as a share.
    pub(super) fn close_window(those: &mut [&mut Self], substeps: u64) -> f64 {
        let (mut sum, mut excused, mut max_allowed_energy) = ([0.0, 0.0, 0.0_f64], 0.0, 0.0);
        for account in &mut *those {
            account.substeps = substeps;
            let [own, by_itself, work] = account.sums.map(|sum| sum / f64::from(account.sample_count.max(1)));
            (account.sums, account.sample_count) = ([0.0; 3], 0);
            // Work from outside is counted for all bodies together, so it is added once.
            sum = [sum[0] + own, sum[1] + by_itself, if work.abs() > sum[2].abs() { work } else { sum[2] }];
            excused += account.rounding.energy(substeps) + account.unresolved_fall_energy();
            max_allowed_energy += account.max_allowed_energy;
        }
        let [own, allowed] = [sum[0], sum[1] + sum[2]];
        let share = (own - allowed - excused) / max_allowed_energy.max(f64::MIN_POSITIVE);
        if share > MAX_ENERGY_GAIN || share.is_nan() {
            let bodies: Vec<String> = those.iter().map(|account| account.body.to_string()).collect();
            let words = match &bodies[..] {
                [body] => format!("body {body}"),
                bodies => format!("bodies {}", bodies.join(", ")),
            };
            those[0].gain = Some(format!("{own:e} J where {allowed:e} J can be, {words}"));
        }
        share
    }

    /// The most energy that the body could have given to others, J.
    pub(super) fn max_allowed_energy(&self) -> f64 {
        self.max_allowed_energy
    }

    /// The energy that gravity may give a body that is let go in the middle of a substep, J, as steps do not resolve when
    /// that is. It is negligible unless gravity is strong and the step long.
    fn unresolved_fall_energy(&self) -> f64 {
        let speed = 0.5 * self.gravity.length() * self.dt;
        0.5 * self.start.mass_kg * speed * speed
    }

    /// Finds what is wrong; `given` is the energy that the bodies it has met could have given it (J).
    pub(super) fn fault(&self, seconds: f64, given: Option<f64>) -> Option<(Fault, String)> {
        if !self.now.finite {
            return Some((Fault::NotFinite, format!("after {seconds} s")));
        }
        if let Some(words) = &self.gain {
            return Some((Fault::Energy, format!("{words}, after {seconds} s")));
        }
        let [reach, furthest] = [self.reach(seconds, given), self.furthest()];
        (furthest > REACH_TOLERANCE * reach)
            .then(|| (Fault::Reach, format!("{furthest} m away of {reach} m, after {seconds} s")))
    }

    /// How far the body can have got, m, by its speed at the start, by gravity, by being pushed out of obstacles, by moving
    /// obstacles, and by its own size.
    ///
    /// - A body squeezed between obstacles may leave faster than they move, by the energy of its springs.
    /// - A particle that a moving surface pinches against another leaves faster than either ([`pinched_speed`]).
    /// - If links are next to nothing, one particle leaves with all the energy of its own contact spring.
    /// - A light part that an obstacle catches while the heavy rest flies on is thrown by the springs between them. If the
    ///   body meets itself, the heavy rest may also strike the light part with all its energy.
    /// - The body may fly apart with the energy of rounding errors, and with the energy that other bodies could give it.
    /// - Bodies meet each other by points of their cells, and meshes meet obstacles so. A cell thrown back at a point near a
    ///   corner may give that corner the energy of all its eight corners: √8 times the speed.
    fn reach(&self, seconds: f64, given: Option<f64>) -> f64 {
        let stored = (own(&self.start) - self.start.energy.kinetic).max(self.max_squeezed_energy)
            + self.sudden_work
            + given.unwrap_or(0.0)
            + self.rounding.energy(self.substeps);
        let whole = (2.0 * stored.max(0.0) / self.start.mass_kg).sqrt();
        let struck = if self.has_self_contact { self.max_allowed_energy } else { 0.0 };
        let thrown = (2.0 * (self.max_stored_energy + struck).max(0.0) / self.light_mass_kg).sqrt();
        let meets_by_points = self.meets_by_points || self.has_self_contact || given.is_some();
        let gathered = if meets_by_points { 8.0_f64.sqrt() } else { 1.0 };
        let pushed = self.max_surface_speed.max(self.max_pinched_speed);
        let speed = gathered * (self.start.max_speed + whole.max(self.max_release_speed).max(thrown)) + pushed;
        let size = self.start.bounds.size().length();
        speed * seconds + 0.5 * self.gravity.length() * seconds * (seconds + self.dt) + size
    }

    /// The furthest that the body is now from its middle at the start, m.
    fn furthest(&self) -> f64 {
        let bounds = self.now.bounds;
        let middle = self.start.bounds.center();
        (bounds.min - middle).abs().max((bounds.max - middle).abs()).length()
    }
}

/// Mass of all light particles of a body, kg; infinite where none is light compared with the others.
fn light_mass<R: Real>(body: &BodyModel<R>) -> f64 {
    let masses = || (0..body.particles.len()).map(|particle| body.mass(particle).to_f64());
    let light = LIGHT_MASS_SHARE * masses().sum::<f64>() / body.particles.len() as f64;
    let sum: f64 = masses().filter(|mass| *mass < light).sum();
    if sum > 0.0 { sum } else { f64::INFINITY }
}

/// The largest speed to which a contact spring of the last substep could push its particle, m/s.
fn release_speed<R: Real>(simulation: &Simulation<R>, number: usize) -> f64 {
    let body = &simulation.model().bodies[number];
    let own = simulation.contacts().iter().filter(|contact| body.particles.contains(&contact.particle));
    let speeds = own.map(|contact| {
        let stored = body.contacts[contact.obstacle].to_f64().energy(-contact.gap.to_f64());
        (2.0 * stored / body.mass(contact.particle - body.particles.start).to_f64()).sqrt()
    });
    let on_mesh = simulation.sample_contacts().iter().filter(|contact| contact.body == number);
    let of_points = on_mesh.map(|contact| {
        let stored = body.contacts[contact.obstacle].to_f64().energy(-contact.gap);
        let carried = contact.own.iter();
        let mobility = carried.map(|(at, w)| w * w / body.mass(at - body.particles.start).to_f64()).sum::<f64>();
        (2.0 * stored * mobility).sqrt()
    });
    speeds.chain(of_points).fold(0.0, f64::max)
}

/// Energy without that of height, J, as leapfrog keeps it. The energy in links swings by up to a fifth of the whole as it
/// becomes motion and back; that is no gain, so it is taken off. At most the swing of a vibration within the stability bound
/// is taken off, or a growing one would not be noticed.
fn own(diagnostics: &Diagnostics) -> f64 {
    let Diagnostics { energy, half_step, .. } = diagnostics;
    energy.total() - energy.gravity - half_step.min(SAFETY * SAFETY * energy.elastic)
}
