//! Where a body is in a substep, and how fast, as a whole.

use glam::{DMat3, DVec3};

use crate::math::{Aabb, Real, Vector};
use crate::physics::kernels::bounds;
use crate::physics::model::plan::Plan;
use crate::physics::model::{ModalBody, Model};
use crate::physics::state::{ModalState, State};

/// Where a body is in the coming substep, and how fast.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct Motion<R: Real> {
    /// Box around where it is and where it would come to, m.
    pub(super) bounds: Aabb<R>,
    /// Box around its velocities, m/s.
    pub(super) velocity: Aabb<R>,
}

impl<R: Real> Motion<R> {
    /// The motion of no body.
    pub(super) fn nowhere() -> Self {
        let at_rest = Aabb { min: R::Vec3::ZERO, max: R::Vec3::ZERO };
        Self { bounds: Aabb::empty(), velocity: at_rest }
    }

    /// The motion in the next `secs` of a body whose particles have velocities (m/s) within `velocity`.
    pub(super) fn of(
        (model, plan, state): (&Model<R>, &Plan, &State<R>),
        body: usize,
        velocity: Aabb<R>,
        secs: R,
    ) -> Self {
        if let Some(modal) = &model.bodies[body].modal {
            return Self::of_modal(modal, &state.modal[body], secs);
        }
        let own = model.bodies[body].particles.clone();
        let at = bounds::<R>(plan.simd, &state.position[own]);
        if state.bodies[body].asleep {
            return Self { bounds: at, velocity: Aabb { min: R::Vec3::ZERO, max: R::Vec3::ZERO } };
        }
        Self { bounds: at.swept(velocity, secs), velocity }
    }

    /// The motion of a modal body, whose particles the state does not place: boxes around all that it may reach with its present
    /// amplitudes and rates.
    fn of_modal(modal: &ModalBody, state: &ModalState, secs: R) -> Self {
        let rest = modal.bounds;
        let [swing, speed] =
            [&state.amplitude, &state.mean_rate].map(|of| modal.displacement_bound(of.iter().copied()));
        let half = 0.5 * (rest.max - rest.min) + DVec3::splat(swing);
        let middle = rest.min + 0.5 * (rest.max - rest.min);
        let (turn, at, velocity, speed) = match (&modal.rigid, &state.rigid) {
            (Some(inertia), Some(rigid)) => {
                let turn = DMat3::from_quat(rigid.turn);
                let at = rigid.center + turn * (middle - inertia.center);
                let spin = rigid.mean_spin.length() * ((middle - inertia.center).length() + half.length());
                (turn, at, rigid.mean_velocity, speed + spin)
            }
            _ => (modal.turn, modal.origin + modal.turn * middle, DVec3::ZERO, speed),
        };
        let half = turn.x_axis.abs() * half.x + turn.y_axis.abs() * half.y + turn.z_axis.abs() * half.z;
        let around = |middle: DVec3, half: DVec3| Aabb {
            min: R::Vec3::from_dvec3(middle - half),
            max: R::Vec3::from_dvec3(middle + half),
        };
        let (now, velocity) = (around(at, half), around(velocity, DVec3::splat(speed)));
        Self { bounds: now.swept(velocity, secs), velocity }
    }
}
