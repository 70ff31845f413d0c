//! The equations of one body, and the workspace that they are solved in.

use glam::{DMat3, DVec3};

use super::multigrid::Multigrid;
use crate::math::{Real, Vector};
use crate::physics::contact::ContactConstraint;
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

/// The workspace for the equations, with room for the largest body.
#[derive(Clone, Debug, Default)]
pub(in crate::physics::schemes) struct ImplicitWorkspace<R: Real> {
    /// The blocks of links for a body with a box, ...
    pub(super) tangents: Tangents<R>,
    /// ... and for one without, in the order of the links.
    pub(super) blocks: Vec<LinkBlock<R>>,
    /// The resistances of cells that are pushed back from inversion.
    pub(super) resistances: Vec<Resistance>,
    /// The diagonal of the matrix without constraints, by particle, kg, ...
    pub(super) diagonal: Vec<f64>,
    /// ... and its inverse for each component; zero where a particle is pinned.
    pub(super) inverse_diagonal: Vec<DVec3>,
    /// The inverse blocks of touched particles, in order; room for one for each constraint.
    pub(super) inverse_blocks: Vec<DMat3>,
    pub(super) right_hand_side: Vec<DVec3>,
    pub(super) velocity: Vec<DVec3>,
    pub(super) residual: Vec<DVec3>,
    pub(super) scaled: Vec<DVec3>,
    pub(super) search: Vec<DVec3>,
    pub(super) product: Vec<DVec3>,
    /// The velocity before a round, and the residual there.
    pub(super) before: Vec<DVec3>,
    pub(super) residual_before: Vec<DVec3>,
    /// The coarse grids of every body that is large enough for them.
    pub(super) grids: Vec<Option<Multigrid>>,
}

impl<R: Real> ImplicitWorkspace<R> {
    /// Room for the bodies of a model.
    pub(in crate::physics::schemes) fn new(model: &Model<R>) -> Self {
        let most = |count: fn(&BodyModel<R>) -> usize| model.bodies.iter().map(count).max().unwrap_or(0);
        let particles = most(|body| body.particles.len());
        let links = most(|body| if body.boxed_links.is_some() { 0 } else { body.link_count() });
        // More crushed cells or contacts than a body has surface particles allocate room once.
        let surface = most(|body| body.lattice.surface);
        let vectors = || vec![DVec3::ZERO; particles];
        Self {
            tangents: Tangents::new(model.bodies.iter().filter_map(|body| body.boxed_links.as_ref())),
            blocks: Vec::with_capacity(links),
            resistances: Vec::with_capacity(surface),
            diagonal: vec![0.0; particles],
            inverse_diagonal: vectors(),
            inverse_blocks: Vec::with_capacity(surface),
            right_hand_side: vectors(),
            velocity: vectors(),
            residual: vectors(),
            scaled: vectors(),
            search: vectors(),
            product: vectors(),
            before: vectors(),
            residual_before: vectors(),
            grids: model.bodies.iter().map(Multigrid::new).collect(),
        }
    }
}

/// The equations of one body.
pub(super) struct System<'a, R: Real> {
    pub(super) body: &'a BodyModel<R>,
    /// The body's place among the bodies.
    pub(super) number: usize,
    pub(super) dt: f64,
    /// The instruction set for products, ...
    pub(super) level: SimdLevel,
    /// ... and the number of threads.
    pub(super) threads: usize,
    pub(super) grab: Option<&'a Grab<R>>,
    pub(super) constraints: &'a mut [ContactConstraint],
    /// Whether the coarse grids take part.
    pub(super) uses_grids: bool,
    /// The links in the box of the body.
    pub(super) exact: &'a mut ExactLinks,
    pub(super) workspace: &'a mut ImplicitWorkspace<R>,
}
