//! What a substep begins with: read by all its stages, written by none.

use super::contact::Placed;
use super::interaction::Grab;
use super::model::Model;
use super::plan::Plan;
use super::state::State;
use crate::math::Real;

/// A substep, or a part of one, as it begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Substep<'a, R: Real> {
    pub(super) model: &'a Model<R>,
    pub(super) plan: &'a Plan,
    /// What moves, before it does.
    pub(super) state: &'a State<R>,
    /// Where obstacles are in it.
    pub(super) obstacles: &'a Placed<R>,
    /// Its length, s.
    pub(super) dt: R,
    /// A hand that pulls.
    pub(super) grab: Option<&'a Grab<R>>,
}
