//! The workspace of contact between bodies, and the contacts of the last substep.

use glam::DVec3;

use super::motion::Motion;
use super::points::PointsWorkspace;
use super::predicted::PredictedBody;
use super::record::BodyContact;
use super::stored_positions::StoredPositions;
use crate::math::Real;
use crate::physics::contact::weighted::{Movers, PointConstraint};
use crate::physics::model::Model;
use crate::physics::model::plan::Plan;
use crate::physics::state::State;
use crate::physics::state::press::Press;
use crate::physics::state::sleep;

/// Particles that a contact weighs at most: those that carry its point, and those of the cell.
pub(super) const MAX_CONTACT_PARTICLES: usize = 16;

/// The same where the point is a particle.
const PARTICLE_CONTACT_PARTICLES: usize = 9;

/// The workspace of contact between bodies; empty where there is no such contact, and for one body until it comes near itself.
#[derive(Clone, Debug, Default)]
pub(in crate::physics) struct BodiesWorkspace<R: Real> {
    pub(super) motions: Vec<Motion<R>>,
    /// Where every particle would be at the end of the substep, m.
    pub(super) predicted_positions: Vec<DVec3>,
    /// Where the particles of modal bodies are when it begins, m, which the state does not tell; empty where no body is modal.
    pub(super) modal_positions: Vec<DVec3>,
    /// Each body at the end of the substep.
    pub(super) predicted_bodies: Vec<PredictedBody>,
    pub(super) stored_positions: StoredPositions,
    /// The bodies that may meet, of points and of cells, in the order in which they are solved for.
    pub(super) pairs: Vec<[usize; 2]>,
    /// Workspace and results for each body's points.
    pub(super) points: Vec<PointsWorkspace>,
    pub(super) movers: Movers,
    pub(super) constraints: Vec<PointConstraint>,
    /// The pairs of bodies that pushed each other since this was cleared.
    pub(in crate::physics) pushed_pairs: Vec<[usize; 2]>,
    /// How many contacts of sleeping bodies come before those of the present substep.
    pub(super) kept: usize,
    /// The contacts of the last substep, in the order of bodies and points.
    pub(in crate::physics) contacts: Vec<BodyContact>,
    /// Their springs as they are at its end, by body, point and the other body.
    pub(in crate::physics) presses: Vec<Press>,
}

impl<R: Real> BodiesWorkspace<R> {
    /// Room for a model.
    pub(in crate::physics) fn new(model: &Model<R>, plan: &Plan) -> Self {
        let mut room = Self::default();
        if plan.between_bodies.is_some() && model.bodies.len() > 1 {
            room.make_room(model);
        }
        room
    }

    /// Makes room, where there is none yet.
    pub(super) fn make_room(&mut self, model: &Model<R>) {
        let (count, bodies) = (model.particle_count(), model.bodies.len());
        if self.predicted_positions.len() == count {
            return;
        }
        // Meshes have more points than these; where that many meet, the lists grow once.
        let surfaces = || model.bodies.iter().map(|body| body.lattice.surface);
        let all: usize = surfaces().sum();
        *self = Self {
            motions: Vec::with_capacity(bodies),
            predicted_positions: vec![DVec3::ZERO; count],
            modal_positions: vec![
                DVec3::ZERO;
                if model.bodies.iter().any(|body| body.modal.is_some()) { count } else { 0 }
            ],
            predicted_bodies: vec![PredictedBody::nowhere(); bodies],
            stored_positions: StoredPositions::new(count, bodies),
            pairs: Vec::with_capacity(2 * all.min(bodies * bodies)),
            points: surfaces().map(|points| PointsWorkspace::new(points, bodies)).collect(),
            movers: Movers::new(count, PARTICLE_CONTACT_PARTICLES * all),
            pushed_pairs: Vec::with_capacity((bodies * bodies).min(all)),
            constraints: Vec::with_capacity(all),
            kept: 0,
            contacts: Vec::with_capacity(all),
            presses: Vec::with_capacity(all),
        };
    }

    /// How many contacts there is room for.
    pub(in crate::physics::contact) fn room(&self) -> usize {
        self.constraints.capacity()
    }

    /// The pairs of bodies of contacts that push.
    pub(in crate::physics) fn pushing_pairs(&self) -> impl Iterator<Item = [usize; 2]> + Clone {
        self.contacts.iter().filter(|contact| contact.force != DVec3::ZERO).map(|contact| contact.bodies)
    }

    /// How many contacts push.
    pub(in crate::physics) fn pushing_count(&self) -> usize {
        self.pushing_pairs().count()
    }

    /// Forgets all contacts but those between sleeping bodies.
    pub(in crate::physics) fn keep_sleeping_contacts(&mut self, model: &Model<R>, plan: &Plan, state: &State<R>) {
        let both_sleep =
            |bodies: &[usize; 2]| bodies.iter().all(|body| !sleep::moves(model, plan, &state.bodies[*body]));
        self.contacts.retain(|contact| both_sleep(&contact.bodies));
        self.presses.clear();
        self.presses.extend(state.presses.iter().filter(|press| both_sleep(&press.bodies)));
    }
}
