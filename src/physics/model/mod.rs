//! The constant side of a scene: particles, links and obstacles with their numbers, ready for the step. It lives from
//! one compilation to the next; live parameter changes replace it and keep the [`super::State`].

mod cell_kind;
mod composition;
mod edge;
mod frame;
mod hull;
mod inertia;
pub(in crate::physics) mod levels;
pub(in crate::physics) mod link;
mod modal;
mod modal_body;
mod modal_points;
mod obstacle;
pub(in crate::physics) mod plan;
mod samples;
mod scheme;
mod skin;

pub(in crate::physics) use samples::{SampledCell, Samples};
pub use scheme::Scheme;
pub(in crate::physics) use skin::{MeshPenetration, Skin};

pub(in crate::physics) use cell_kind::CellKind;
pub(in crate::physics) use composition::{Composition, LatticeConstants};
pub(in crate::physics) use edge::{Edge, Edges, FIRST_EDGE_POINT};
pub(in crate::physics) use frame::Frame;
pub(in crate::physics) use hull::{Hull, Surroundings};
pub use inertia::Inertia;
pub(in crate::physics) use link::LinkConstants;
pub use link::{Link, LinkFamily};
pub use modal::ModalModel;
pub(in crate::physics) use modal_body::ModalBody;
pub(in crate::physics) use modal_points::ModalPoints;
pub(in crate::physics) use obstacle::{Carry, grown_for_rounding};
pub use obstacle::{MeshModel, ObstacleModel, ObstacleShape, OrientedForm, OrientedModel, PlaneModel};

use std::ops::Range;
use std::sync::{Arc, OnceLock};

use crate::geometry::Lattice;
use crate::math::Real;
use crate::physics::kernels::BoxedLinks;

/// Everything about a scene that a step reads and never writes.
#[derive(Clone, Debug)]
pub struct Model<R: Real> {
    /// The bodies; their particles follow one another in the state's arrays.
    pub bodies: Vec<BodyModel<R>>,
    /// The obstacles.
    pub obstacles: Vec<ObstacleModel<R>>,
    /// m/s².
    pub gravity: R::Vec3,
    /// How far bodies may fall; none where nothing falls.
    pub(in crate::physics) fall_limit: Option<FallLimit<R>>,
}

/// How far a body may fall before it is gone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::physics) struct FallLimit<R: Real> {
    /// Where gravity points; of unit length.
    pub(in crate::physics) down: R::Vec3,
    /// The distance along it from the world's origin, m.
    pub(in crate::physics) depth: R,
}

impl<R: Real> Model<R> {
    /// Obstacles that are meshes.
    pub(in crate::physics) fn mesh_count(&self) -> usize {
        self.obstacles.iter().filter(|obstacle| matches!(obstacle.shape, ObstacleShape::Mesh(_))).count()
    }

    /// Points of the meshes of all bodies that meet obstacles in place of particles.
    pub fn sample_count(&self) -> usize {
        self.bodies.iter().map(BodyModel::sample_count).sum()
    }

    /// The most touches of points with obstacles that can be remembered.
    pub(in crate::physics) fn max_touches(&self) -> usize {
        self.bodies.iter().map(|body| self.max_touches_of(body)).sum()
    }

    /// The same of one body: every point may touch as many obstacles as meet in a corner.
    pub(in crate::physics) fn max_touches_of(&self, body: &BodyModel<R>) -> usize {
        const OBSTACLES_IN_CORNER: usize = 3;
        body.remembered_point_count() * self.obstacles.len().min(OBSTACLES_IN_CORNER) + self.edge_room()
    }

    /// Room for contacts of obstacles' edges with the cells of a body: no more than are on an edge across it and in its corners;
    /// where more meet, lists grow.
    pub(in crate::physics) fn edge_room(&self) -> usize {
        const MOST_EDGE_POINTS: usize = 256;
        let most = |obstacle: &ObstacleModel<R>| obstacle.edges.iter().map(|edges| edges.point_count()).max();
        self.obstacles.iter().filter_map(most).sum::<usize>().min(MOST_EDGE_POINTS)
    }

    /// Whether any obstacle has edges.
    pub(in crate::physics) fn has_edges(&self) -> bool {
        self.obstacles.iter().any(ObstacleModel::has_edges)
    }

    /// Whether any obstacle moves by itself.
    pub(in crate::physics) fn has_moving_obstacle(&self) -> bool {
        self.obstacles.iter().any(|obstacle| obstacle.motion.is_some())
    }

    /// Particles in all bodies.
    pub fn particle_count(&self) -> usize {
        self.bodies.last().map_or(0, |body| body.particles.end)
    }

    /// The body that a particle (in the state's arrays) belongs to.
    pub fn body_of(&self, particle: usize) -> Option<usize> {
        let body = self.bodies.partition_point(|body| body.particles.end <= particle);
        (body < self.bodies.len()).then_some(body)
    }

    /// Links in all bodies, by family.
    pub fn link_counts(&self) -> [usize; 3] {
        self.bodies.iter().fold([0; 3], |sum, body| std::array::from_fn(|f| sum[f] + body.links[f].links.len()))
    }
}

/// A body at rest and what it is made of.
#[derive(Clone, Debug)]
pub struct BodyModel<R: Real> {
    /// Its particles in the state's arrays.
    pub particles: Range<usize>,
    /// Where its particles start, m.
    pub start: Vec<R::Vec3>,
    /// The velocity its particles start with, m/s.
    pub(in crate::physics) start_velocity: R::Vec3,
    /// Mass of every particle where all weigh alike, else their mean, kg: times their number the body's mass.
    pub particle_mass: R,
    /// Masses of the particles, kg.
    pub(in crate::physics) masses: Values<R>,
    /// How the constants of its links and particles follow from its cells.
    pub(in crate::physics) composition: Composition,
    /// Young's modulus of its cells, Pa; of springs, that of the solid whose diagonal links are as stiff.
    pub(in crate::physics) moduli: Values<f32>,
    /// Which particles are held.
    pub(in crate::physics) pinned: Values<bool>,
    /// Links by family: structural, shear, bending. Particle numbers are local to the body.
    pub links: [LinkFamily<R>; 3],
    /// The same links in the box of the body's grid corners; none where it is mostly empty.
    pub(in crate::physics) boxed_links: Option<BoxedLinks<R>>,
    /// The sums of the inverse rest lengths of a particle's links by family, 1/m; each combination that occurs once.
    pub(in crate::physics) inverse_length_sums: Arc<[[f64; 3]]>,
    /// What it was built from: cells and corners, for diagnostics and pictures.
    pub lattice: Arc<Lattice>,
    /// The longest extent at rest, m.
    pub size: R,
    /// The inverse of its cells' size at rest, 1/m.
    pub inverse_cell_size: R,
    /// How its cells resist inversion.
    pub recovery: RecoveryModel<R>,
    /// How it meets each obstacle, in the obstacles' order.
    pub contacts: Vec<ContactModel<R>>,
    /// How it meets other bodies and itself.
    pub(in crate::physics) body_contact: BodyContactModel,
    /// Its modes, where it is a modal body.
    pub(in crate::physics) modal: Option<ModalBody>,
    /// Points of its mesh that meet obstacles in place of its particles; none where the particles meet them, or there is no
    /// mesh.
    pub(in crate::physics) samples: Option<Arc<Samples>>,
}

/// How a body meets others and itself.
#[derive(Clone, Debug)]
pub(in crate::physics) struct BodyContactModel {
    pub(in crate::physics) meets_others: bool,
    pub(in crate::physics) meets_itself: bool,
    /// Its hull, made once something comes near.
    pub(in crate::physics) hull: Arc<OnceLock<Hull>>,
    /// Coulomb's coefficients, at rest and sliding; of two bodies their geometric means count.
    pub(in crate::physics) friction: [f64; 2],
    /// Mass of its heaviest particle, kg.
    pub(in crate::physics) heaviest: f64,
    /// The part of its weight that one outer particle may have to carry at rest, N.
    pub(in crate::physics) max_load: f64,
}

impl<R: Real> BodyModel<R> {
    /// The lattices that it is made of: one, or one for each kind of its cells.
    pub(in crate::physics) fn lattices(&self) -> impl Iterator<Item = LatticeConstants> {
        self.composition.lattices(&self.links)
    }

    /// Whether a particle (local number) is held.
    #[inline]
    pub fn is_pinned(&self, particle: usize) -> bool {
        self.pinned.of(particle)
    }

    /// Mass of a particle (local number), kg.
    #[inline]
    pub fn mass(&self, particle: usize) -> R {
        self.masses.of(particle)
    }

    /// Mass of all of it, kg.
    pub fn total_mass(&self) -> R {
        self.particle_mass * R::from_f64(self.particles.len() as f64)
    }

    /// Mass of the lightest particle, kg.
    pub(in crate::physics) fn lightest_mass(&self) -> R {
        match &self.masses {
            Values::Uniform(mass) => *mass,
            Values::Each(masses) => masses.iter().copied().fold(self.particle_mass, R::min),
        }
    }

    /// The modes that it moves by; none where it moves by its cells.
    pub fn modes(&self) -> Option<&Arc<ModalModel>> {
        self.modal.as_ref().map(|modal| &modal.modes)
    }

    /// Its mass and moments of inertia, where it is a free modal body.
    pub fn inertia(&self) -> Option<&Inertia> {
        self.modal.as_ref()?.rigid.as_ref()
    }

    /// How many points have their touches remembered: points of its mesh that stand for its particles, or those of a free
    /// modal body.
    pub(in crate::physics) fn remembered_point_count(&self) -> usize {
        let free = self.modal.as_ref().filter(|modal| modal.rigid.is_some());
        free.map_or_else(|| self.sample_count(), |modal| modal.points.count())
    }

    /// Whether any particle is held.
    pub fn is_held(&self) -> bool {
        match &self.pinned {
            Values::Uniform(held) => *held,
            Values::Each(held) => held.contains(&true),
        }
    }

    /// Links of all families.
    pub(in crate::physics) fn link_count(&self) -> usize {
        self.links.iter().map(|family| family.links.len()).sum()
    }

    /// Whether it is to meet other bodies.
    pub fn meets_others(&self) -> bool {
        self.body_contact.meets_others
    }

    /// Whether it is to meet itself.
    pub(in crate::physics) fn meets_itself(&self) -> bool {
        self.body_contact.meets_itself
    }

    /// How many points of its mesh meet obstacles in place of its particles.
    pub fn sample_count(&self) -> usize {
        self.samples.as_ref().map_or(0, |samples| samples.count())
    }

    /// The points of its mesh that meet other bodies; none where the body meets them with its cells. A modal body meets them
    /// with its particles.
    pub(in crate::physics) fn samples_among_bodies(&self) -> Option<&Samples> {
        self.samples.as_deref().filter(|_| self.modal.is_none())
    }

    /// Its hull, for contact with others and itself.
    pub(in crate::physics) fn hull(&self) -> &Hull {
        self.body_contact.hull.get_or_init(|| Hull::new(&self.lattice))
    }

    /// The inverse of a particle's mass (local number), 1/kg.
    #[inline]
    pub fn inverse_mass(&self, particle: usize) -> R {
        R::ONE / self.mass(particle)
    }
}

/// One value for all elements, or one for each.
#[derive(Clone, Debug, PartialEq)]
pub enum Values<T> {
    /// All the same.
    Uniform(T),
    /// One each, in their order.
    Each(Vec<T>),
}

impl<T: Copy> Values<T> {
    /// The value of one of them.
    #[inline]
    pub fn of(&self, place: usize) -> T {
        match self {
            Self::Uniform(value) => *value,
            Self::Each(values) => values[place],
        }
    }
}

/// How the cells of a body resist inversion. The constants are the same in whatever parts a substep is taken: shorter parts
/// could bear more, but a stiffness that changes from one part to the next gives energy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecoveryModel<R> {
    /// The stiffness of a cell against inversion, N·m; zero where recovery is off.
    pub stiffness: R,
    /// The mass with which a particle of the lightest cell resists the push, kg.
    pub mass: R,
    /// The stiffness of the push, N·m: as much of `stiffness` as a substep bears.
    pub(in crate::physics) push: R,
    /// The stiffness of the pull on the cells of a body that is stuck, N·m: as much as a substep bears beside the push.
    pub(in crate::physics) pull: R,
    /// For how long soft links flow in a substep, s; zero where recovery is part of the equations that are solved.
    pub(in crate::physics) flow_secs: R,
}

/// How obstacles push back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactRule {
    /// A stiff, critically damped spring taken implicitly, with Coulomb friction.
    Implicit,
    /// The thesis's own (GC §5.2, §6).
    Thesis,
}

/// How one body meets one obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactModel<R> {
    /// Penalty stiffness per particle, N/m.
    pub stiffness: R,
    /// Critical damping of that stiffness, N·s/m.
    pub damping: R,
    /// No particle ends a step deeper than this unless it started deeper, m.
    pub(in crate::physics) depth_limit: R,
    /// The distance below which the thesis rule sees a particle, m.
    pub(in crate::physics) thesis_threshold: R,
}

impl<R: Real> ContactModel<R> {
    /// The energy of the spring at a depth (m, negative outside), J. Beyond the limit the push is constant, so it grows
    /// linearly.
    pub fn energy(&self, depth: R) -> R {
        let sprung = depth.max(R::ZERO).min(self.depth_limit);
        self.stiffness * sprung * (depth - R::from_f64(0.5) * sprung)
    }

    /// The same in double precision.
    pub fn to_f64(&self) -> ContactModel<f64> {
        let Self { stiffness, damping, depth_limit, thesis_threshold } = self;
        ContactModel {
            stiffness: stiffness.to_f64(),
            damping: damping.to_f64(),
            depth_limit: depth_limit.to_f64(),
            thesis_threshold: thesis_threshold.to_f64(),
        }
    }
}
