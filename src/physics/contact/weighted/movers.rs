//! The particles and modal bodies that contacts of points may change, and their weights in each contact.

use super::particles::WeightedParticles;
use glam::DVec3;

use super::modal::{ModalMovers, ModalShares};
use crate::math::{Real, Vector};
use crate::physics::step::substep::Substep;

/// Stands where a particle is not among the movers.
const NO_PLACE: u32 = u32::MAX;

/// A particle that contacts may change.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics::contact) struct Mover {
    /// The particle, in the state's arrays.
    pub(in crate::physics::contact) particle: u32,
    /// The inverse of its mass, 1/kg; zero where it is held.
    pub(in crate::physics::contact) mobility: f64,
    /// The velocity it would have without these contacts, m/s.
    pub(in crate::physics::contact) predicted_velocity: DVec3,
}

/// The particle that an impulse on a contact moves fastest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fastest {
    /// Its place among the movers.
    pub(super) place: u32,
    /// Its speed for an impulse of 1, 1/kg; negative against the impulse.
    pub(super) speed_per_impulse: f64,
}

/// The share of a mover in a contact.
#[derive(Clone, Copy, Debug)]
struct Share {
    /// The mover's place among all.
    place: u32,
    weight: f64,
    /// By how much an impulse of 1 on the contact's point changes the mover's speed, 1/kg.
    speed_per_impulse: f64,
}

/// All particles that contacts may change, and the weights that contacts give them.
#[derive(Clone, Debug, Default)]
pub(in crate::physics::contact) struct Movers {
    pub(in crate::physics::contact) all: Vec<Mover>,
    /// Their present velocities, m/s.
    pub(in crate::physics::contact) velocity: Vec<DVec3>,
    /// Contact after contact.
    shares: Vec<Share>,
    /// The place of every particle of the scene among all.
    place_of: Vec<u32>,
    /// The modal bodies.
    pub(in crate::physics::contact) modal: ModalMovers,
}

/// Which particles and modal bodies a contact weighs, and how much: ranges of the shares in [`Movers`].
#[derive(Clone, Copy, Debug)]
pub(in crate::physics::contact) struct Shares {
    first: u32,
    count: u32,
    modal: ModalShares,
}

impl Movers {
    /// Makes room for a scene of this many particles, with `weighed` shares in all contacts.
    pub(in crate::physics::contact) fn new(particles: usize, weighed: usize) -> Self {
        Self {
            all: Vec::with_capacity(particles),
            velocity: Vec::with_capacity(particles),
            shares: Vec::with_capacity(weighed),
            place_of: vec![NO_PLACE; particles],
            modal: ModalMovers::default(),
        }
    }

    /// Forgets all.
    pub(in crate::physics::contact) fn clear(&mut self) {
        for mover in &self.all {
            self.place_of[mover.particle as usize] = NO_PLACE;
        }
        self.all.clear();
        self.velocity.clear();
        self.shares.clear();
        self.modal.clear();
    }

    /// Gives all of them the velocities that they would have without contacts.
    pub(in crate::physics::contact) fn forget_changes(&mut self) {
        for (velocity, mover) in self.velocity.iter_mut().zip(&self.all) {
            *velocity = mover.predicted_velocity;
        }
        self.modal.forget_changes();
    }

    /// Returns the place of a particle of a body, which is added if it is not there yet.
    pub(in crate::physics::contact) fn place<R: Real>(
        &mut self,
        substep: Substep<'_, R>,
        body: usize,
        particle: usize,
        velocity: &[R::Vec3],
    ) -> u32 {
        let place = &mut self.place_of[particle];
        if *place == NO_PLACE {
            let (model, local) = (&substep.model.bodies[body], particle - substep.model.bodies[body].particles.start);
            let is_asleep = substep.state.bodies[body].asleep;
            let is_held = model.is_pinned(local) || is_asleep;
            let mobility = if is_held { 0.0 } else { 1.0 / model.mass(local).to_f64() };
            let predicted_velocity = if is_asleep { DVec3::ZERO } else { velocity[particle].to_dvec3() };
            #[expect(clippy::cast_possible_truncation, reason = "particles are counted in 32 bits")]
            let (next, particle) = (self.all.len() as u32, particle as u32);
            *place = next;
            self.all.push(Mover { particle, mobility, predicted_velocity });
            self.velocity.push(predicted_velocity);
        }
        *place
    }

    /// Adds the shares of a contact of a point that particles of a body carry.
    pub(in crate::physics::contact) fn weigh_particles<R: Real>(
        &mut self,
        substep: Substep<'_, R>,
        body: usize,
        own: &WeightedParticles,
        velocity: &[R::Vec3],
    ) -> Shares {
        let (mut places, mut count) = ([(0, 0.0); 8], 0);
        for (particle, weight) in own.iter() {
            places[count] = (self.place(substep, body, particle, velocity), weight);
            count += 1;
        }
        self.weigh(places[..count].iter().copied(), ModalShares::default())
    }

    /// Adds the shares of a contact: places with their weights, and its shares of modal bodies.
    pub(in crate::physics::contact) fn weigh(
        &mut self,
        shares: impl Iterator<Item = (u32, f64)>,
        modal: ModalShares,
    ) -> Shares {
        let (first, all) = (self.shares.len(), &self.all);
        let share = |(place, weight): (u32, f64)| Share {
            place,
            weight,
            speed_per_impulse: weight * all[place as usize].mobility,
        };
        self.shares.extend(shares.map(share));
        #[expect(clippy::cast_possible_truncation, reason = "contacts weigh fewer")]
        let [first, count] = [first, self.shares.len() - first].map(|count| count as u32);
        Shares { first, count, modal }
    }

    /// The particles that a contact weighs, with their weights.
    pub(in crate::physics::contact) fn weighted_movers(&self, shares: Shares) -> impl Iterator<Item = (&Mover, f64)> {
        self.shares_of(shares).iter().map(|share| (&self.all[share.place as usize], share.weight))
    }

    fn shares_of(&self, shares: Shares) -> &[Share] {
        &self.shares[shares.first as usize..][..shares.count as usize]
    }

    /// By how much an impulse of 1 along a normal changes a contact's speed along it, 1/kg; and an upper bound of the same
    /// across it.
    pub(super) fn mobility(&self, shares: Shares, normal: DVec3) -> [f64; 2] {
        let of_particles = self.weighted_movers(shares).map(|(mover, w)| w * w * mover.mobility).sum::<f64>();
        if shares.modal.is_empty() {
            return [of_particles; 2];
        }
        self.modal.mobility(shares.modal, normal).map(|of_modal| of_particles + of_modal)
    }

    /// The particle whose speed an impulse on a contact changes most, with its speed for an impulse of 1, 1/kg; none where only
    /// modal bodies move.
    pub(super) fn fastest(&self, shares: Shares) -> Option<Fastest> {
        let all = self
            .shares_of(shares)
            .iter()
            .map(|share| Fastest { place: share.place, speed_per_impulse: share.speed_per_impulse });
        all.max_by(|one, other| one.speed_per_impulse.abs().total_cmp(&other.speed_per_impulse.abs()))
    }

    /// The mean velocity, without any contacts, of the particles that an impulse on a contact pushes along it, or against it
    /// if `sign` is negative, m/s.
    pub(super) fn side_velocity(&self, shares: Shares, sign: f64) -> DVec3 {
        let side = self.weighted_movers(shares).filter(|(_, weight)| weight * sign > 0.0);
        let (sum, total) = side.fold((DVec3::ZERO, 0.0), |(sum, total), (mover, weight)| {
            (sum + mover.predicted_velocity * weight, total + weight)
        });
        sum / total
    }

    /// The present velocity of a mover, m/s.
    pub(super) fn velocity_of(&self, place: u32) -> DVec3 {
        self.velocity[place as usize]
    }

    /// The velocity of a contact without any contacts, m/s.
    pub(in crate::physics::contact) fn predicted_velocity(&self, shares: Shares) -> DVec3 {
        let of_particles = self
            .weighted_movers(shares)
            .fold(DVec3::ZERO, |sum, (mover, weight)| sum + mover.predicted_velocity * weight);
        if shares.modal.is_empty() { of_particles } else { of_particles + self.modal.predicted_velocity(shares.modal) }
    }

    /// The velocity of a contact if particles have the velocities `of`, m/s.
    pub(super) fn velocity_with(&self, shares: Shares, of: impl Fn(&Mover) -> DVec3) -> DVec3 {
        let of_particles =
            self.weighted_movers(shares).fold(DVec3::ZERO, |sum, (mover, weight)| sum + of(mover) * weight);
        if shares.modal.is_empty() { of_particles } else { of_particles + self.modal.velocity_now(shares.modal) }
    }

    /// The present velocity of a contact, m/s.
    pub(super) fn velocity_now(&self, shares: Shares) -> DVec3 {
        let particles = self.shares_of(shares).iter();
        let of_particles =
            particles.fold(DVec3::ZERO, |sum, share| sum + self.velocity[share.place as usize] * share.weight);
        if shares.modal.is_empty() { of_particles } else { of_particles + self.modal.velocity_now(shares.modal) }
    }

    /// Applies an impulse on a contact's point, N·s, to everything that the contact weighs.
    pub(super) fn push(&mut self, shares: Shares, impulse: DVec3) {
        let Self { velocity, shares: of_all, modal, .. } = self;
        for share in &of_all[shares.first as usize..][..shares.count as usize] {
            velocity[share.place as usize] += impulse * share.speed_per_impulse;
        }
        if !shares.modal.is_empty() {
            modal.push(shares.modal, impulse);
        }
    }
}
