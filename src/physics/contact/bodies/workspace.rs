//! What contact between bodies works in, and what the last substep found.

use glam::DVec3;

use super::buckets::{Buckets, NONE, Seen};
use super::constraint::{Mover, PointConstraint};
use super::near::Motion;
use super::record::BodyContact;
use crate::math::{Aabb, Real};
use crate::physics::model::Model;
use crate::physics::model::plan::Plan;
use crate::physics::state::State;
use crate::physics::state::press::Press;

/// What contact between bodies works in; of no length where there is none.
#[derive(Clone, Debug, Default)]
pub(in crate::physics) struct BodiesWorkspace<R: Real> {
    pub(in crate::physics) motions: Vec<Motion<R>>,
    /// Where every particle would be at the end of the substep, m.
    pub(super) ahead: Vec<DVec3>,
    /// The boxes around each body there, m.
    pub(super) boxes: Vec<Aabb<f64>>,
    pub(super) seen: Vec<Seen>,
    pub(super) buckets: Buckets,
    /// The place of a particle among the movers.
    pub(super) mover_of: Vec<u32>,
    pub(super) movers: Vec<Mover>,
    pub(super) constraints: Vec<PointConstraint>,
    /// The particles that contact between bodies has just given another velocity, and that velocity, m/s.
    pub(in crate::physics) moved: Vec<(usize, R::Vec3)>,
    /// What met in the last substep, in the order of bodies and points.
    pub(in crate::physics) contacts: Vec<BodyContact>,
    /// Their springs as they are at its end, by particle and body.
    pub(in crate::physics) presses: Vec<Press>,
}

impl<R: Real> BodiesWorkspace<R> {
    /// Room for a model.
    pub(in crate::physics) fn new(model: &Model<R>, plan: &Plan) -> Self {
        if plan.between_bodies.is_none() {
            return Self::default();
        }
        let (count, bodies) = (model.particle_count(), model.bodies.len());
        let surfaces = || model.bodies.iter().map(|body| body.lattice.surface);
        let (all, largest) = (surfaces().sum(), surfaces().max().unwrap_or(0));
        Self {
            motions: Vec::with_capacity(bodies),
            ahead: vec![DVec3::ZERO; count],
            boxes: Vec::with_capacity(bodies),
            seen: Vec::with_capacity(largest),
            buckets: Buckets::new(largest),
            mover_of: vec![NONE; count],
            movers: Vec::with_capacity(count),
            moved: Vec::with_capacity(count),
            constraints: Vec::with_capacity(all),
            contacts: Vec::with_capacity(all),
            presses: Vec::with_capacity(all),
        }
    }

    /// The pairs of bodies of contacts that push.
    pub(in crate::physics) fn touching(&self) -> impl Iterator<Item = [usize; 2]> + Clone {
        self.contacts.iter().filter(|contact| contact.force != DVec3::ZERO).map(|contact| contact.bodies)
    }

    /// How many contacts push.
    pub(in crate::physics) fn pushing(&self) -> usize {
        self.touching().count()
    }

    /// Forgets all contacts but those between bodies that sleep, and what these moved.
    pub(in crate::physics) fn keep_of_sleepers(&mut self, state: &State<R>) {
        let sleep = |bodies: &[usize; 2]| bodies.iter().all(|body| state.bodies[*body].asleep);
        self.moved.clear();
        self.contacts.retain(|contact| sleep(&contact.bodies));
        self.presses.clear();
        self.presses.extend(state.presses.iter().filter(|press| sleep(&press.bodies)));
    }
}
