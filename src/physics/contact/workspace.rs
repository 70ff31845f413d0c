//! The contacts of a substep, and the workspace they are found in.

use super::bodies::{BodiesWorkspace, BodyContact};
use super::broad::BroadPhase;
use super::constraint::{ContactConstraint, DepthLimit, ParticleConstraint};
use super::distance_cache::DISTANCE_CACHE_BYTES;
use super::narrow::mesh::NearestPointCache;
use super::record::ContactRecord;
use super::samples::{SampleContact, SamplesWorkspace};
use super::weighted::WeightedConstraints;
use crate::math::{Real, Vector};
use crate::physics::model::Scheme;
use crate::physics::model::plan::Plan;
use crate::physics::model::{BodyModel, Model};
use crate::physics::report::{Counters, Recorder};
use crate::physics::state::press::Press;
use crate::physics::state::touch::SampleTouch;
use crate::physics::state::{State, sleep};

/// Obstacles that meet in a corner.
const OBSTACLES_IN_CORNER: usize = 3;

/// Bytes cached for each pair of a particle and a mesh.
pub(in crate::physics) const BYTES_A_PARTICLE_AND_MESH: usize = size_of::<NearestPointCache>() + DISTANCE_CACHE_BYTES;

/// Workspace for contact of one body's particles with obstacles. Each body has its own, so that threads work on bodies in
/// parallel.
#[derive(Clone, Debug)]
pub(super) struct ObstaclesWorkspace<R: Real> {
    pub(super) broad_phase: BroadPhase<R>,
    /// Cached search results of every particle and mesh, by particle.
    pub(super) caches: Vec<NearestPointCache>,
    /// The contacts found in the present substep.
    pub(super) found_contacts: Vec<ContactRecord<R>>,
    pub(super) tests: TestCounts,
}

impl<R: Real> ObstaclesWorkspace<R> {
    fn new(model: &Model<R>, body: &BodyModel<R>) -> Self {
        let (particles, meshes) = (body.particles.len(), model.mesh_count());
        let met = if model.obstacles.is_empty() { 0 } else { body.lattice.surface / SURFACE_PARTICLES_A_CONTACT };
        Self {
            broad_phase: BroadPhase::new(model, particles),
            caches: vec![NearestPointCache::default(); particles * meshes],
            found_contacts: Vec::with_capacity(met),
            tests: TestCounts::default(),
        }
    }

    /// Returns the cached search results of a particle of the body, by mesh.
    pub(super) fn caches_of_particle(&mut self, local: usize, meshes: usize) -> &mut [NearestPointCache] {
        &mut self.caches[local * meshes..][..meshes]
    }
}

/// There is room for contacts of one in this many surface particles in a substep; where there are more, the list grows once.
pub(in crate::physics) const SURFACE_PARTICLES_A_CONTACT: usize = 2;

/// Numbers of tests made.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TestCounts {
    pub(super) all: u64,
    pub(super) of_spheres: u64,
    pub(super) frictions: u64,
}

impl TestCounts {
    /// Adds the numbers of others.
    pub(super) fn add(&mut self, Self { all, of_spheres, frictions }: Self) {
        self.all += all;
        self.of_spheres += of_spheres;
        self.frictions += frictions;
    }

    /// Adds them to the counters.
    pub(super) fn count(self, counters: &mut Counters) {
        counters.narrow_tests += self.all;
        counters.sphere_tests += self.of_spheres;
        counters.frictions += self.frictions;
    }
}

/// The workspace of contact, and the contacts of the last substep.
#[derive(Clone, Debug)]
pub(crate) struct ContactWorkspace<R: Real> {
    /// The workspace of each body.
    pub(super) of_bodies: Vec<ObstaclesWorkspace<R>>,
    /// Particle–obstacle pairs that met in the last substep, by particle.
    pub contacts: Vec<ContactRecord<R>>,
    /// For every body and obstacle, whether they count as near without a test of bounding boxes: planes and open meshes of
    /// which a side is remembered, and all before the first substep.
    pub(super) marked_near: Vec<bool>,
    /// The constraints of the implicit integrator, by particle, ...
    pub(in crate::physics) constraints: Vec<ParticleConstraint>,
    /// ... and those of points that it solves for with them: of bodies in each other, then of meshes at obstacles.
    pub(in crate::physics) equations: WeightedConstraints,
    /// How stiff the depth limit is in both.
    pub(in crate::physics) depth_limit: DepthLimit,
    /// Workspace and results of contact between bodies.
    pub(in crate::physics) bodies: BodiesWorkspace<R>,
    /// Workspace and results of contact on meshes of bodies.
    pub(in crate::physics) samples: SamplesWorkspace<R>,
}

/// All contacts of a substep.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct Contacts<'a, R: Real> {
    /// Of particles with obstacles, by particle.
    pub(in crate::physics) at_obstacles: &'a [ContactRecord<R>],
    /// Of bodies with each other and with themselves.
    pub(in crate::physics) between_bodies: &'a [BodyContact],
    /// Of points of meshes with obstacles.
    pub(in crate::physics) on_mesh: &'a [SampleContact],
}

impl<R: Real> Contacts<'_, R> {
    /// The particles that have any. One with several comes up with each.
    pub(in crate::physics) fn particles(&self) -> impl Iterator<Item = usize> {
        let between_bodies = self.between_bodies.iter().flat_map(|met| met.cell.iter().chain(met.own.iter()));
        let of_points = between_bodies.chain(self.on_mesh.iter().flat_map(|met| met.own.iter()));
        let at_obstacles = self.at_obstacles.iter().map(|contact| contact.particle);
        at_obstacles.chain(of_points.map(|(particle, _)| particle))
    }
}

impl<R: Real> ContactWorkspace<R> {
    /// Room for a model.
    pub(crate) fn new(model: &Model<R>, plan: &Plan) -> Self {
        // Enough for every surface particle in a corner of obstacles; where there are more contacts, the lists grow once.
        let surface: usize = model.bodies.iter().map(|body| body.lattice.surface).sum();
        let pairs = surface * model.obstacles.len().min(OBSTACLES_IN_CORNER);
        let solved_for = if plan.scheme == Scheme::Implicit { pairs } else { 0 };
        Self {
            of_bodies: model.bodies.iter().map(|body| ObstaclesWorkspace::new(model, body)).collect(),
            contacts: Vec::with_capacity(pairs),
            marked_near: vec![true; model.bodies.len() * model.obstacles.len()],
            constraints: Vec::with_capacity(solved_for),
            depth_limit: DepthLimit::default(),
            equations: WeightedConstraints::default(),
            bodies: BodiesWorkspace::new(model, plan),
            samples: SamplesWorkspace::new(model, plan),
        }
    }

    /// The contacts of the last substep, of all kinds.
    pub(in crate::physics) fn all_contacts(&self) -> Contacts<'_, R> {
        Contacts {
            at_obstacles: &self.contacts,
            between_bodies: &self.bodies.contacts,
            on_mesh: &self.samples.contacts,
        }
    }

    /// Forgets the contacts among the equations, and makes room for as many as there may be.
    pub(in crate::physics) fn begin_equations(&mut self) {
        self.equations.clear();
        self.equations.make_room(self.bodies.room() + self.samples.room());
    }

    /// Whether the last solution of the equations has a point at the limit of its depth.
    pub(in crate::physics) fn is_at_depth_limit(&self) -> bool {
        let of_particles = self.constraints.iter().map(|one| &one.constraint);
        of_particles
            .chain(self.equations.all.iter().map(|one| &one.constraint))
            .any(ContactConstraint::is_at_depth_limit)
    }

    /// Presses no spring of a point further than it was when the substep began: the motion that presses it was not made.
    pub(in crate::physics) fn press_no_further(&mut self, state: &State<R>) {
        for press in &mut self.bodies.presses {
            let known = state.presses.binary_search_by_key(&press.place(), Press::place);
            press.depth_m = press.depth_m.min(known.map_or(0.0, |place| state.presses[place].depth_m));
        }
        for touch in &mut self.samples.touches {
            let known = state.touches.binary_search_by_key(&touch.place(), SampleTouch::place);
            touch.depth_m = touch.depth_m.min(known.map_or(0.0, |place| state.touches[place].depth_m));
        }
    }

    /// How many contacts push.
    pub(in crate::physics) fn pushing_count(&self) -> usize {
        self.contacts.iter().filter(|contact| contact.force != R::Vec3::ZERO).count() + self.samples.pushing_count()
    }

    /// Forgets all contacts but those of bodies that sleep.
    pub(in crate::physics) fn keep_sleeping_contacts(&mut self, model: &Model<R>, state: &State<R>) {
        if sleep::asleep_count(state) == 0 {
            self.contacts.clear();
        } else {
            self.contacts
                .retain(|contact| model.body_of(contact.particle).is_some_and(|body| state.bodies[body].asleep));
        }
    }

    /// Sorts contacts by particle again where some were kept or found later.
    pub(super) fn sort(&mut self) {
        let place = |contact: &ContactRecord<R>| (contact.particle, contact.obstacle);
        if !self.contacts.is_sorted_by_key(place) {
            self.contacts.sort_unstable_by_key(place);
        }
    }

    /// Forgets the contacts of particles that nothing pushed, of bodies that are awake: their path may need a push.
    pub(super) fn forget_unpushed(&mut self, model: &Model<R>, state: &State<R>) {
        let (mut kept, mut first) = (0, 0);
        while let Some(contact) = self.contacts.get(first) {
            let particle = contact.particle;
            let same = self.contacts[first..].iter().take_while(|contact| contact.particle == particle);
            let (count, pushed) = same.fold((0, false), |(n, pushed), c| (n + 1, pushed || c.force != R::Vec3::ZERO));
            if pushed || model.body_of(contact.particle).is_some_and(|body| state.bodies[body].asleep) {
                self.contacts.copy_within(first..first + count, kept);
                kept += count;
            }
            first += count;
        }
        self.contacts.truncate(kept);
    }

    /// The depth of the deepest contact as it was found, m.
    pub(super) fn deepest(&self) -> R {
        let of_samples = self.samples.contacts.iter().fold(0.0, |deepest: f64, contact| deepest.max(-contact.gap));
        self.contacts.iter().fold(R::from_f64(of_samples), |deepest, contact| deepest.max(-contact.gap))
    }

    /// Reports the contacts that sleeping bodies keep.
    pub(in crate::physics) fn report_kept(&self, recorder: &mut Recorder<'_>) {
        recorder.last.contacts = self.pushing_count();
        recorder.last.body_contacts = self.bodies.pushing_count();
        recorder.note_depth(self.deepest().to_f64());
    }

    /// Takes every body to be near every obstacle, as obstacles have been moved.
    pub(in crate::physics) fn mark_all_near(&mut self) {
        self.marked_near.fill(true);
    }
}
