//! The stretch of time that is taken at once, and what a substep begins with: read by all its stages, written by none.

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

/// The stretch of time that one evaluation of a scheme covers: a substep or a part of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::physics) struct Part {
    /// Its length, s.
    pub(in crate::physics) secs: f64,
    /// What takes it.
    pub(in crate::physics) scheme: Scheme,
    /// What becomes of it where the implicit scheme would give energy from nowhere.
    pub(in crate::physics) gain: Gain,
    /// Whether the substep begins with it: what is under way is not given up.
    pub(in crate::physics) is_first: bool,
    /// Whether the substep ends with it.
    pub(in crate::physics) is_last: bool,
}

/// What becomes of a part in which the implicit scheme would give a body energy from nowhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::physics) enum Gain {
    /// It is refused, the state untouched.
    Refuse,
    /// It is taken, with as much of the motion as gives none: there was enough work on the substep.
    Slow,
    /// It is taken as it is; nobody looks.
    Take,
}

impl Part {
    /// A whole substep, come what may, in one of so many equal parts.
    pub(in crate::physics) fn one_of(plan: &Plan, parts: u32) -> Self {
        let secs = plan.substep_secs() / f64::from(parts);
        Self { secs, scheme: plan.scheme, gain: Gain::Take, is_first: true, is_last: true }
    }
}
