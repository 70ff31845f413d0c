//! The equations of bodies that touch, and the workspace that all bodies' equations are solved in.

use std::ops::Range;

use glam::{DMat3, DVec3};

use super::direct::DirectSolver;
use super::islands::Islands;
use super::multigrid::Multigrid;
use super::points::PointBlocks;
use super::rigid::RigidMotions;
use crate::math::{Real, Vector};
use crate::physics::contact::{DepthLimit, ParticleConstraint, WeightedConstraint};
use crate::physics::forces::exact::ExactLinks;
use crate::physics::forces::recovery::Resistance;
use crate::physics::interaction::Grab;
use crate::physics::kernels::{SimdLevel, Tangents};
use crate::physics::model::{BodyModel, Model};

/// A link's block of the matrix: `across I + along alongᵀ` between its ends. It is in the precision of the state: an
/// iteration spends most of its time reading blocks, and the matrix may be a little off as long as it is the same
/// throughout.
#[derive(Clone, Copy, Debug)]
pub(super) struct LinkBlock<R: Real> {
    pub(super) ends: [u32; 2],
    pub(super) across: R,
    pub(super) along: R::Vec3,
}

impl<R: Real> LinkBlock<R> {
    #[inline]
    pub(super) fn times(&self, v: DVec3) -> DVec3 {
        let along = self.along.to_dvec3();
        v * self.across.to_f64() + along * along.dot(v)
    }
}

/// The part of one body in the equations.
#[derive(Clone, Debug)]
pub(super) struct BodyEquations<R: Real> {
    /// The blocks of links of a body with a box, ...
    pub(super) tangents: Tangents<R>,
    /// ... and of one without, in the order of the links.
    pub(super) blocks: Vec<LinkBlock<R>>,
    /// The resistances of cells that are pushed back from inversion.
    pub(super) resistances: Vec<Resistance>,
    /// The coarse grids, if it is large enough for them.
    pub(super) grids: Option<Multigrid>,
    /// Whether the coarse grids take part.
    pub(super) uses_grids: bool,
    /// The squared norm of its residual, ...
    pub(super) squared_residual: f64,
    /// ... and what that has to come down to, ...
    pub(super) squared_tolerance: f64,
    /// ... and the same in a rough round.
    pub(super) goal: f64,
}

impl<R: Real> BodyEquations<R> {
    fn new(body: &BodyModel<R>) -> Self {
        let links = if body.boxed_links.is_some() { 0 } else { body.link_count() };
        Self {
            tangents: Tangents::new(body.boxed_links.as_ref()),
            blocks: Vec::with_capacity(links),
            // More crushed cells than a body has surface particles allocate room once.
            resistances: Vec::with_capacity(body.lattice.surface),
            grids: Multigrid::new(body),
            uses_grids: false,
            squared_residual: 0.0,
            squared_tolerance: 0.0,
            goal: 0.0,
        }
    }
}

/// The workspace for the equations. Vectors have an entry for every particle of the scene.
#[derive(Clone, Debug, Default)]
pub(in crate::physics::schemes) struct ImplicitWorkspace<R: Real> {
    pub(super) bodies: Vec<BodyEquations<R>>,
    pub(super) islands: Islands,
    /// The diagonal of the matrix without constraints, by particle, kg, ...
    pub(super) diagonal: Vec<f64>,
    /// ... and its inverse for each component; zero where a particle is pinned.
    pub(super) inverse_diagonal: Vec<DVec3>,
    /// The inverse blocks of particles that touch obstacles, in order.
    pub(super) inverse_blocks: Vec<(usize, DMat3)>,
    /// What the preconditioner knows of contacts of points.
    pub(super) point_blocks: PointBlocks,
    /// The bodies as rigid ones.
    pub(super) rigid: RigidMotions,
    /// The direct solver, for bodies that all this does not suffice for.
    pub(super) direct: DirectSolver,
    pub(super) right_hand_side: Vec<DVec3>,
    pub(super) velocity: Vec<DVec3>,
    pub(super) residual: Vec<DVec3>,
    pub(super) scaled: Vec<DVec3>,
    pub(super) search: Vec<DVec3>,
    pub(super) product: Vec<DVec3>,
    /// The velocity before a round, and the residual there.
    pub(super) before: Vec<DVec3>,
    pub(super) residual_before: Vec<DVec3>,
}

impl<R: Real> ImplicitWorkspace<R> {
    /// Room for the bodies of a model.
    pub(in crate::physics::schemes) fn new(model: &Model<R>) -> Self {
        let particles = model.particle_count();
        // More contacts than there are surface particles allocate room once.
        let surface = model.bodies.iter().map(|body| body.lattice.surface).sum();
        let vectors = || vec![DVec3::ZERO; particles];
        Self {
            bodies: model.bodies.iter().map(BodyEquations::new).collect(),
            islands: Islands::new(model.bodies.len()),
            diagonal: vec![0.0; particles],
            inverse_diagonal: vectors(),
            inverse_blocks: Vec::with_capacity(surface),
            point_blocks: PointBlocks::default(),
            rigid: RigidMotions::default(),
            direct: DirectSolver::default(),
            right_hand_side: vectors(),
            velocity: vectors(),
            residual: vectors(),
            scaled: vectors(),
            search: vectors(),
            product: vectors(),
            before: vectors(),
            residual_before: vectors(),
        }
    }
}

/// The equations of one body, or of several that touch each other.
pub(super) struct System<'a, R: Real> {
    pub(super) model: &'a Model<R>,
    /// The numbers of the bodies, ascending.
    pub(super) bodies: &'a [usize],
    pub(super) dt: f64,
    /// The instruction set for products, ...
    pub(super) level: SimdLevel,
    /// ... and the number of threads.
    pub(super) threads: usize,
    pub(super) grab: Option<&'a Grab<R>>,
    /// The constraints of particles at obstacles, by particle.
    pub(super) at_obstacles: &'a mut [ParticleConstraint],
    /// Those of points of these bodies in cells of these bodies, and of their meshes at obstacles, ...
    pub(super) points: &'a mut [WeightedConstraint],
    /// ... and the particles that all contacts of points weigh.
    pub(super) weights: &'a [(u32, f64)],
    pub(super) depth_limit: DepthLimit,
    /// The links in the boxes of bodies.
    pub(super) exact: &'a mut ExactLinks,
    pub(super) workspace: &'a mut ImplicitWorkspace<R>,
}

impl<'a, R: Real> System<'a, R> {
    /// The numbers of the bodies, with their particles.
    pub(super) fn ranges(&self) -> impl Iterator<Item = (usize, Range<usize>)> + Clone + use<'a, R> {
        let model = self.model;
        self.bodies.iter().map(move |number| (*number, model.bodies[*number].particles.clone()))
    }

    /// Whether nothing but itself acts on a single body.
    pub(super) fn is_untouched(&self) -> bool {
        self.at_obstacles.is_empty() && self.points.is_empty()
    }
}
