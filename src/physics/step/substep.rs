//! What a substep begins with: read by all its stages, written by none.

use crate::math::Real;
use crate::physics::contact::placed::Placed;
use crate::physics::interaction::Grab;
use crate::physics::model::Model;
use crate::physics::model::Scheme;
use crate::physics::model::plan::Plan;
use crate::physics::state::State;

/// A substep, or a part of one, as it begins.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct Substep<'a, R: Real> {
    pub(in crate::physics) model: &'a Model<R>,
    pub(in crate::physics) plan: &'a Plan,
    /// What moves, before it does.
    pub(in crate::physics) state: &'a State<R>,
    /// Where obstacles are in it.
    pub(in crate::physics) obstacles: &'a Placed<R>,
    /// Its length, s.
    pub(in crate::physics) dt: R,
    /// What takes it.
    pub(in crate::physics) scheme: Scheme,
    /// A hand that pulls.
    pub(in crate::physics) grab: Option<&'a Grab<R>>,
}
