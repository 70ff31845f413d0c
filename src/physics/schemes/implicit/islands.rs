//! Bodies that touch each other are solved for together: an island of them at a time.

use crate::math::Real;
use crate::physics::contact::{ParticleConstraint, WeightedConstraint};
use crate::physics::state::State;

/// Which bodies touch each other in a substep, directly or by others between.
#[derive(Clone, Debug, Default)]
pub(super) struct Islands {
    /// For every body the first of its island.
    first_of: Vec<usize>,
    /// The bodies that are awake, island by island.
    order: Vec<usize>,
}

impl Islands {
    /// Room for so many bodies.
    pub(super) fn new(bodies: usize) -> Self {
        Self { first_of: Vec::with_capacity(bodies), order: Vec::with_capacity(bodies) }
    }

    /// Finds the islands, and sorts constraints island by island.
    pub(super) fn find<R: Real>(
        &mut self,
        state: &State<R>,
        at_obstacles: &mut [ParticleConstraint],
        points: &mut [WeightedConstraint],
    ) {
        let bodies = state.bodies.len();
        self.first_of.clear();
        self.first_of.extend(0..bodies);
        for contact in &*points {
            let bodies = contact.touching.bodies();
            if bodies.iter().all(|body| !state.bodies[*body].asleep) {
                self.join(bodies);
            }
        }
        for body in 0..bodies {
            self.first_of[body] = self.first(body);
        }
        self.order.clear();
        self.order.extend((0..bodies).filter(|body| !state.bodies[*body].asleep));
        if points.is_empty() {
            return;
        }
        let first_of = &self.first_of;
        self.order.sort_unstable_by_key(|body| (first_of[*body], *body));
        at_obstacles.sort_unstable_by_key(|one| (first_of[one.body], one.place()));
        // A body that sleeps is in no island.
        points.sort_unstable_by_key(|contact| (self.of_contact(state, contact), contact.number));
    }

    /// The first body of the island of a contact.
    pub(super) fn of_contact<R: Real>(&self, state: &State<R>, contact: &WeightedConstraint) -> usize {
        let bodies = contact.touching.bodies();
        let awake = bodies.into_iter().find(|body| !state.bodies[*body].asleep);
        self.first_of[awake.unwrap_or(bodies[0])]
    }

    /// The first body of the island of a body.
    pub(super) fn of_body(&self, body: usize) -> usize {
        self.first_of[body]
    }

    /// The bodies that are awake, island by island.
    pub(super) fn order(&self) -> &[usize] {
        &self.order
    }

    /// The first body of the island as known so far.
    fn first(&self, mut body: usize) -> usize {
        while self.first_of[body] != body {
            body = self.first_of[body];
        }
        body
    }

    fn join(&mut self, bodies: [usize; 2]) {
        let [one, other] = bodies.map(|body| self.first(body));
        self.first_of[one.max(other)] = one.min(other);
    }
}
