//! What contact asks of the coming substep: by which scheme it is taken, and in how many parts.

use super::speeds::Speeds;
use crate::math::Real;
use crate::physics::contact::bodies::{self, BodiesWorkspace};
use crate::physics::contact::{Placed, near, samples};
use crate::physics::model::Model;
use crate::physics::model::plan::{BodyContactPlan, Plan};
use crate::physics::state::State;

/// What contact asks of a substep.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContactNeed {
    /// How the substep is taken where contact divides it; none where nothing comes near, or the implicit scheme solves for it.
    pub(super) plan: Option<BodyContactPlan>,
    /// Into how many parts it is divided at least.
    pub(super) parts: u32,
    /// How often the implicit scheme would halve it so that no body travels past another.
    halvings: u32,
    /// Whether bodies come near each other or themselves.
    pub(super) bodies_are_near: bool,
    /// Whether points of a mesh come near an obstacle, or an obstacle's edges near a body.
    pub(super) points_are_near: bool,
}

impl ContactNeed {
    /// That of the coming substep, in which obstacles are there and a hand pulls or not. Wakes bodies that others come to, and
    /// notes which bodies are near themselves.
    pub(super) fn of<R: Real>(
        model: &Model<R>,
        plan: &Plan,
        state: &mut State<R>,
        (obstacles, hand_pulls): (&Placed<R>, bool),
        speeds: &Speeds<R>,
        of_bodies: &mut BodiesWorkspace<R>,
    ) -> Self {
        let secs = plan.substep_secs();
        let by_travel = bodies::parts(model, plan, secs, state, speeds, of_bodies);
        let scene = (model, plan, obstacles);
        let bodies_are_near = by_travel.is_some();
        let points_are_near =
            plan.on_mesh.is_some() && samples::comes_near(scene, state, &speeds.velocity_bounds, secs);
        let needs_parts_at_obstacles =
            || hand_pulls || near::comes_near_obstacle(scene, state, &speeds.velocity_bounds, secs);
        // The scheme for contact of meshes with obstacles has a place for contact between bodies, too.
        let by_parts = plan
            .on_mesh
            .filter(|_| points_are_near)
            .or(plan.between_bodies.filter(|_| bodies_are_near))
            .or_else(|| plan.at_obstacles.filter(|_| needs_parts_at_obstacles()));
        Self { bodies_are_near, points_are_near, ..Self::decided(by_parts, by_travel.unwrap_or(1)) }
    }

    /// That of a substep in contact that `plan` divides, in which bodies travel past each other so far that it takes `by_travel`
    /// parts; none divides it where nothing is near.
    fn decided(plan: Option<BodyContactPlan>, by_travel: u32) -> Self {
        let parts = plan.map_or(1, |plan| plan.parts.max(by_travel));
        let halvings = plan.map_or(0, |_| by_travel.next_power_of_two().trailing_zeros());
        Self { plan, parts, halvings, bodies_are_near: false, points_are_near: false }.with_parts(1)
    }

    /// The same where strained bodies need at least so many parts, too. The implicit scheme solves for the contact where its
    /// halves cost less than the parts.
    #[must_use]
    pub(super) fn with_parts(self, parts: u32) -> Self {
        let parts = self.parts.max(parts);
        match self.plan.and_then(|plan| plan.parts_a_solve) {
            Some(a_solve) if a_solve * f64::from(1 << self.halvings) < f64::from(parts) => {
                Self { plan: None, parts: 1, ..self }
            }
            _ => Self { parts, ..self },
        }
    }

    /// How often the implicit scheme halves the substep, where it solves for the contact, so that no body travels past another.
    pub(super) fn halvings(&self) -> u32 {
        if self.plan.is_none() { self.halvings } else { 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::model::Scheme;

    #[test]
    fn a_substep_is_divided_for_contact_or_solved_for_whichever_is_cheaper() {
        let plan = |parts, parts_a_solve| {
            let scheme = Scheme::SemiImplicit;
            Some(BodyContactPlan { scheme, parts, strained_parts: 2 * parts, parts_a_solve })
        };
        // The parts, the halvings, and whether contact divides the substep.
        for (plan, by_travel, wanted) in [
            (None, 1, (1, 0, false)),
            (plan(3, None), 1, (3, 0, true)),
            (plan(3, None), 5, (5, 0, true)),
            // Eight halves are as many as five parts take: each may cost 100 / 8.
            (plan(100, Some(12.4)), 5, (1, 3, false)),
            (plan(100, Some(12.6)), 5, (100, 0, true)),
            (plan(100, Some(99.0)), 1, (1, 0, false)),
        ] {
            let need = ContactNeed::decided(plan, by_travel);
            assert_eq!((need.parts, need.halvings(), need.plan.is_some()), wanted, "{plan:?}, {by_travel} by travel");
        }
        // Strained bodies need twice as many parts, which may be more than the halves cost.
        let of_strained = |a_solve| ContactNeed::decided(plan(100, Some(a_solve)), 5).with_parts(200);
        let decision = |need: ContactNeed| (need.parts, need.halvings(), need.plan.is_some());
        assert_eq!([24.9, 25.1].map(|a_solve| decision(of_strained(a_solve))), [(1, 3, false), (200, 0, true)]);
        assert_eq!(decision(ContactNeed::decided(None, 1).with_parts(4)), (4, 0, false), "strain alone");
    }
}
