//! The workspace of contact on the meshes of bodies, and the contacts of the last substep.

use glam::DVec3;

use super::clearance::Clearances;
use super::record::SampleContact;
use crate::math::Real;
use crate::physics::contact::bodies::{Buckets, CandidatePoint};
use crate::physics::contact::narrow::mesh::NearestPointCache;
use crate::physics::contact::weighted::{Movers, PartingPush, PointConstraint, WeightedParticles};
use crate::physics::model::plan::Plan;
use crate::physics::model::{BodyModel, Model};
use crate::physics::state::State;
use crate::physics::state::touch::SampleTouch;

/// Particles that a contact weighs.
const CONTACT_PARTICLES: usize = 8;

/// A point of a body that meets an obstacle.
#[derive(Clone, Copy, Debug)]
pub(super) struct FoundContact {
    /// The body.
    pub(super) body: usize,
    /// The point, by its number in the body, or as in [`FIRST_EDGE_POINT`](crate::physics::model::FIRST_EDGE_POINT).
    pub(super) sample: usize,
    pub(super) obstacle: usize,
    /// The particles that carry it.
    pub(super) own: WeightedParticles,
    /// Unit normal, away from the obstacle.
    pub(super) normal: DVec3,
    /// Distance from the surface along the normal when the substep begins, m; negative inside.
    pub(super) gap: f64,
    /// Velocity of the surface, m/s.
    pub(super) surface_velocity: DVec3,
}

/// Workspace for edges; empty where obstacles have none.
#[derive(Clone, Debug, Default)]
pub(super) struct EdgesWorkspace {
    /// Where the particles of the present body would be at the end of the substep, m.
    pub(super) predicted: Vec<DVec3>,
    /// The points that may be in its cells then.
    pub(super) candidates: Vec<CandidatePoint>,
    /// For each of them.
    pub(super) points: Vec<EdgePoint>,
    pub(super) buckets: Buckets,
    /// The outcodes of the body's particles, for the box around those points.
    pub(super) outcodes: Vec<u8>,
    /// Whether each particle of the body is deep in an obstacle, where that is known.
    pub(super) deep: Vec<Option<bool>>,
}

impl EdgesWorkspace {
    fn new<R: Real>(model: &Model<R>) -> Self {
        let room = model.edge_room();
        let largest = model.bodies.iter().map(|body| body.particles.len()).max().unwrap_or(0);
        let predicted = Vec::with_capacity(if room > 0 { largest } else { 0 });
        Self {
            predicted,
            candidates: Vec::with_capacity(room),
            points: Vec::with_capacity(room),
            buckets: Buckets::new(room),
            outcodes: Vec::with_capacity(if room > 0 { largest } else { 0 }),
            deep: Vec::with_capacity(if room > 0 { largest } else { 0 }),
        }
    }
}

/// A point on an edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct EdgePoint {
    /// Its number.
    pub(super) sample: usize,
    /// Where it is when the substep begins, m.
    pub(super) from: DVec3,
    /// The way out of the obstacle, of length 1, or zero.
    pub(super) outward: DVec3,
}

/// A point that was parted from an obstacle.
#[derive(Clone, Copy, Debug)]
pub(super) struct PartedPoint {
    /// The particles that carry it.
    pub(super) own: WeightedParticles,
    /// Velocity of the surface, m/s.
    pub(super) surface_velocity: DVec3,
    pub(super) push: PartingPush,
}

/// The workspace of contact on meshes; empty where there is no such contact.
#[derive(Clone, Debug, Default)]
pub(in crate::physics) struct SamplesWorkspace<R: Real> {
    /// The first point of each body among those of all.
    pub(super) first_sample: Vec<usize>,
    /// Cached search results of every point and mesh obstacle, by point.
    pub(super) caches: Vec<NearestPointCache>,
    /// How far the cells of each body are from all obstacles.
    pub(super) clearances: Vec<Clearances<R>>,
    /// The obstacles that the present body may meet.
    pub(super) near_obstacles: Vec<usize>,
    /// The contacts of the present body, or of all that the implicit integrator solves for.
    pub(super) found_contacts: Vec<FoundContact>,
    /// Those of the present body as pairs of point and obstacle, sorted.
    pub(super) found_pairs: Vec<(usize, usize)>,
    pub(super) edges: EdgesWorkspace,
    pub(super) movers: Movers,
    pub(super) constraints: Vec<PointConstraint>,
    /// Where their equations begin among those of the implicit integrator.
    pub(super) first_equation: usize,
    /// The contacts of the last substep, by body, point and obstacle.
    pub(in crate::physics) contacts: Vec<SampleContact>,
    /// The touches at its end.
    pub(in crate::physics) touches: Vec<SampleTouch>,
    /// What parted points in the last substep.
    pub(super) parted: Vec<PartedPoint>,
    /// The greatest depth then, m.
    pub(in crate::physics::contact) deepest: f64,
}

impl<R: Real> SamplesWorkspace<R> {
    /// Room for a model.
    pub(in crate::physics) fn new(model: &Model<R>, plan: &Plan) -> Self {
        if plan.on_mesh.is_none() {
            return Self::default();
        }
        let counts = model.bodies.iter().map(BodyModel::sample_count);
        let first_sample = counts.scan(0, |next, count| Some(std::mem::replace(next, *next + count))).collect();
        let largest = model.bodies.iter().map(BodyModel::sample_count).max().unwrap_or(0);
        let (pairs, most) = (model.max_touches(), model.obstacles.len());
        let of_one = largest * most.min(3) + model.edge_room();
        Self {
            first_sample,
            caches: vec![NearestPointCache::default(); model.sample_count() * model.mesh_count()],
            clearances: (0..model.bodies.len()).map(|body| Clearances::new(model, body)).collect(),
            near_obstacles: Vec::with_capacity(most),
            found_contacts: Vec::with_capacity(of_one),
            found_pairs: Vec::with_capacity(of_one),
            edges: EdgesWorkspace::new(model),
            movers: Movers::new(model.particle_count(), CONTACT_PARTICLES * of_one),
            constraints: Vec::with_capacity(of_one),
            first_equation: 0,
            contacts: Vec::with_capacity(pairs),
            touches: Vec::with_capacity(pairs),
            parted: Vec::with_capacity(pairs),
            deepest: 0.0,
        }
    }

    /// How many contacts there is room for.
    pub(in crate::physics::contact) fn room(&self) -> usize {
        self.constraints.capacity()
    }

    /// How many contacts push.
    pub(in crate::physics) fn pushing_count(&self) -> usize {
        self.contacts.iter().filter(|contact| contact.force != DVec3::ZERO).count()
    }

    /// Forgets the contacts found so far.
    pub(in crate::physics) fn forget_found(&mut self) {
        self.found_contacts.clear();
        self.constraints.clear();
        self.movers.clear();
    }

    /// Sorts contacts by body, point and obstacle, and touches likewise.
    pub(super) fn sort(&mut self) {
        self.contacts.sort_unstable_by_key(|contact| (contact.body, contact.sample, contact.obstacle));
        self.touches.sort_unstable_by_key(SampleTouch::place);
    }

    /// Forgets all contacts and touches but those of sleeping bodies.
    pub(in crate::physics) fn keep_sleeping_contacts(&mut self, state: &State<R>) {
        self.contacts.retain(|contact| state.bodies[contact.body].asleep);
        self.parted.clear();
        self.touches.clear();
        self.touches.extend(state.touches.iter().filter(|touch| state.bodies[touch.body].asleep));
        self.deepest = self.contacts.iter().fold(0.0, |deepest, contact| deepest.max(-contact.gap));
    }
}
