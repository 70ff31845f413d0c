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

/// A link's block of the matrix: `across I + along alongᵀ` between its ends. In the precision of the state: reading these
/// is what an iteration takes longest for, and the matrix may be a little off as long as it is the same throughout.
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

/// What the equations of the largest body are solved in.
#[derive(Clone, Debug, Default)]
pub(in crate::physics::schemes) struct ImplicitWorkspace<R: Real> {
    /// The links of a body in its box, ...
    pub(super) tangents: Tangents<R>,
    /// ... and of one that has none, in their order.
    pub(super) blocks: Vec<LinkBlock<R>>,
    /// Of cells that are pushed back from inversion.
    pub(super) resistances: Vec<Resistance>,
    /// What the matrix has on its diagonal without constraints, by particle, kg, ...
    pub(super) diagonal: Vec<f64>,
    /// ... and its inverse for each component; zero where a particle is pinned.
    pub(super) inverse_diagonal: Vec<DVec3>,
    /// The inverse blocks of the touched particles, one for each constraint; only the first of a particle's counts.
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
        // What is crushed or touched beyond a body's surface makes room for itself once.
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
    /// Its place among the bodies.
    pub(super) number: usize,
    pub(super) dt: f64,
    /// The instructions that products are worked out with, ...
    pub(super) level: SimdLevel,
    /// ... and by how many threads.
    pub(super) threads: usize,
    pub(super) grab: Option<&'a Grab<R>>,
    pub(super) constraints: &'a mut [ContactConstraint],
    /// Whether the coarse grids take part.
    pub(super) uses_grids: bool,
    /// The links in the box of the body.
    pub(super) exact: &'a mut ExactLinks,
    pub(super) workspace: &'a mut ImplicitWorkspace<R>,
}
