//! Modal bodies that contacts may change: the mean of particles that a contact weighs moves by all of a body's motions at once.
//!
//! ```text
//!   u = u* + Pᵀ a      a ← a + w P J        P  how the mean of particles moves by each motion, w  how far each one yields
//! ```

use glam::DVec3;

use crate::math::Aabb;

/// Modal bodies in a substep. All in the scene's coordinates.
pub(in crate::physics) trait ModalBodies {
    /// Whether a body moves by its modes in this substep.
    fn moves(&self, body: usize) -> bool;

    /// A box around all of its particles over the substep, m.
    fn motion_bounds(&mut self, body: usize) -> Aabb<f64>;

    /// How fast it moves on the whole, m/s.
    fn drift(&mut self, body: usize) -> DVec3;

    /// Writes where its particles are when the substep begins and would be at its end, m. Only those of cells that a point of
    /// this region may be in are written.
    fn predict_positions(&mut self, body: usize, region: &Aabb<f64>, places: [&mut [DVec3]; 2]);

    /// By how much an impulse of 1 changes the rate of each of its motions.
    fn mobilities(&self, body: usize) -> impl Iterator<Item = f64>;

    /// Returns how fast the mean of some of its particles (local numbers, and weights that sum to one) moves if nothing pushes,
    /// m/s. Adds to `rows` how the mean moves by each motion.
    fn weigh(&mut self, body: usize, particles: &[(usize, f64)], rows: &mut Vec<DVec3>) -> DVec3;

    /// Damping of a contact's spring over the critical one, if it has to stand for the give of such a body alone.
    fn damping_ratio(&mut self, body: usize) -> f64;

    /// Solves the obstacles and the hand at a body for what all other contacts leave. `change` is the change of the rates of its
    /// motions so far. Returns the largest change of one of their impulses, N·s.
    fn solve_round(&mut self, body: usize, change: &mut [f64]) -> f64;

    /// Forgets what [`ModalBodies::solve_round`] did.
    fn reset(&mut self);

    /// Takes over the change of the rates of a body's motions, including that by [`ModalBodies::solve_round`].
    fn apply_change(&mut self, body: usize, change: &[f64]);
}

/// Where no body moves by modes.
impl ModalBodies for () {
    fn moves(&self, _: usize) -> bool {
        false
    }

    fn motion_bounds(&mut self, _: usize) -> Aabb<f64> {
        Aabb::empty()
    }

    fn drift(&mut self, _: usize) -> DVec3 {
        DVec3::ZERO
    }

    fn predict_positions(&mut self, _: usize, _: &Aabb<f64>, _: [&mut [DVec3]; 2]) {}

    fn mobilities(&self, _: usize) -> impl Iterator<Item = f64> {
        std::iter::empty()
    }

    fn weigh(&mut self, _: usize, _: &[(usize, f64)], _: &mut Vec<DVec3>) -> DVec3 {
        DVec3::ZERO
    }

    fn damping_ratio(&mut self, _: usize) -> f64 {
        1.0
    }

    fn solve_round(&mut self, _: usize, _: &mut [f64]) -> f64 {
        0.0
    }

    fn reset(&mut self) {}

    fn apply_change(&mut self, _: usize, _: &[f64]) {}
}

/// A modal body that contacts may change.
#[derive(Clone, Debug, Default)]
pub(in crate::physics::contact) struct ModalMover {
    pub(in crate::physics::contact) body: usize,
    /// By how much an impulse of 1 changes the rate of each motion.
    mobilities: Vec<f64>,
    /// By how much contacts have changed the rates.
    pub(in crate::physics::contact) change: Vec<f64>,
}

/// The share of a modal body in a contact.
#[derive(Clone, Copy, Debug)]
struct ModalShare {
    /// The place of the body among those that contacts may change.
    mover: u32,
    /// Where its row begins.
    row: usize,
    /// 1, or −1 where the point meets a cell of it.
    weight: f64,
    /// The speed without contacts, m/s.
    predicted_velocity: DVec3,
    /// By how much an impulse of 1 changes the speed, summed over the three axes, 1/kg.
    mobility: f64,
}

/// All modal bodies that contacts may change, and how each contact weighs them.
#[derive(Clone, Debug, Default)]
pub(in crate::physics::contact) struct ModalMovers {
    /// The first `count` are in use.
    all: Vec<ModalMover>,
    count: usize,
    shares: Vec<ModalShare>,
    rows: Vec<DVec3>,
}

/// Which shares of modal bodies a contact has: none, one or two.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::physics::contact) struct ModalShares {
    first: u32,
    count: u32,
}

impl ModalShares {
    /// Whether there are none.
    pub(super) fn is_empty(self) -> bool {
        self.count == 0
    }
}

impl ModalMovers {
    /// Forgets all.
    pub(super) fn clear(&mut self) {
        self.count = 0;
        self.shares.clear();
        self.rows.clear();
    }

    /// Whether contacts may change none.
    pub(super) fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// All of them.
    pub(in crate::physics::contact) fn all(&mut self) -> &mut [ModalMover] {
        &mut self.all[..self.count]
    }

    /// Returns the place of a body, which is added if it is not there yet.
    fn place(&mut self, body: usize, modal: &impl ModalBodies) -> usize {
        if let Some(known) = self.all[..self.count].iter().position(|mover| mover.body == body) {
            return known;
        }
        if self.count == self.all.len() {
            self.all.push(ModalMover::default());
        }
        let mover = &mut self.all[self.count];
        mover.body = body;
        mover.mobilities.clear();
        mover.mobilities.extend(modal.mobilities(body));
        mover.change.clear();
        mover.change.resize(mover.mobilities.len(), 0.0);
        self.count += 1;
        self.count - 1
    }

    /// Adds the mean of particles of a body with this weight to the next contact. Returns its velocity without contacts, m/s.
    #[expect(clippy::cast_possible_truncation, reason = "bodies and contacts are fewer")]
    pub(in crate::physics::contact) fn weigh(
        &mut self,
        body: usize,
        particles: &[(usize, f64)],
        weight: f64,
        modal: &mut impl ModalBodies,
    ) -> DVec3 {
        let mover = self.place(body, modal);
        let row = self.rows.len();
        let predicted_velocity = modal.weigh(body, particles, &mut self.rows);
        let mobilities = &self.all[mover].mobilities;
        let of_row = self.rows[row..].iter().zip(mobilities);
        let mobility = of_row.fold(0.0, |sum, (way, mobility)| sum + mobility * way.length_squared());
        self.shares.push(ModalShare { mover: mover as u32, row, weight, predicted_velocity, mobility });
        predicted_velocity
    }

    /// How many shares there are.
    #[expect(clippy::cast_possible_truncation, reason = "contacts are fewer")]
    pub(in crate::physics::contact) fn share_count(&self) -> u32 {
        self.shares.len() as u32
    }

    /// The shares that were added since there were `first` of them.
    pub(in crate::physics::contact) fn shares_since(&self, first: u32) -> ModalShares {
        ModalShares { first, count: self.share_count() - first }
    }

    fn shares_of(&self, shares: ModalShares) -> impl Iterator<Item = (&ModalShare, &[DVec3], &ModalMover)> {
        self.shares[shares.first as usize..][..shares.count as usize].iter().map(|share| {
            let mover = &self.all[share.mover as usize];
            (share, &self.rows[share.row..][..mover.change.len()], mover)
        })
    }

    /// By how much an impulse of 1 changes a contact's speed along a normal, and across it, summed over both axes, 1/kg.
    pub(super) fn mobility(&self, shares: ModalShares, normal: DVec3) -> [f64; 2] {
        self.shares_of(shares).fold([0.0; 2], |[mut along, mut across], (_, row, mover)| {
            for (way, mobility) in row.iter().zip(&mover.mobilities) {
                let part = way.dot(normal);
                along += mobility * part * part;
                across += mobility * (*way - normal * part).length_squared();
            }
            [along, across]
        })
    }

    /// The part of modal bodies in a contact's velocity without contacts, m/s.
    pub(in crate::physics::contact) fn predicted_velocity(&self, shares: ModalShares) -> DVec3 {
        self.shares_of(shares).fold(DVec3::ZERO, |sum, (share, ..)| sum + share.predicted_velocity * share.weight)
    }

    /// The same with what contacts have changed.
    pub(super) fn velocity_now(&self, shares: ModalShares) -> DVec3 {
        self.shares_of(shares).fold(DVec3::ZERO, |sum, (share, row, mover)| {
            let changed = row.iter().zip(&mover.change).fold(DVec3::ZERO, |sum, (way, change)| sum + *way * *change);
            sum + (share.predicted_velocity + changed) * share.weight
        })
    }

    /// Applies an impulse on a contact's point, N·s, to the modal bodies in it.
    pub(super) fn push(&mut self, shares: ModalShares, impulse: DVec3) {
        for share in &self.shares[shares.first as usize..][..shares.count as usize] {
            let ModalMover { mobilities, change, .. } = &mut self.all[share.mover as usize];
            let own = impulse * share.weight;
            for ((change, way), mobility) in change.iter_mut().zip(&self.rows[share.row..]).zip(mobilities) {
                *change += *mobility * way.dot(own);
            }
        }
    }

    /// Forgets what contacts have changed.
    pub(super) fn forget_changes(&mut self) {
        self.all().iter_mut().for_each(|mover| mover.change.fill(0.0));
    }

    /// About the kinetic energy of the shares of all contacts, J.
    pub(super) fn kinetic_energy(&self) -> f64 {
        let moving = self.shares.iter().filter(|share| share.mobility > 0.0);
        moving.map(|share| 0.5 / share.mobility * share.predicted_velocity.length_squared()).sum()
    }
}
