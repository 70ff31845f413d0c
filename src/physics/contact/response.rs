//! Contact response: a penalty spring with critical damping, taken implicitly per particle, then Coulomb friction.
//!
//! With the depth p and the velocity `v_n` along the normal at the end of the step, `N = k (p − dt v_n) − d v_n`, which
//! solves to the velocity below. It only ever takes energy out, at any stiffness, and so never limits the step.
//! Deviates from GC §5.2, whose force `k p + |⟨F, n⟩|` is explicit and adds energy on the way out; that rule is in
//! [`super::thesis`].

use super::surface::Surface;
use crate::math::{Real, Vector};
use crate::physics::model::{ContactModel, ObstacleModel};

/// Which friction is computed; makes no difference where the coefficients are zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Friction {
    /// None.
    Without,
    /// Static friction where it can hold, else dynamic.
    Coulomb,
    /// Dynamic friction, also where static friction could hold.
    Dynamic,
}

/// The velocity of a particle after it met a surface with the velocity `predicted`, m/s.
pub(super) fn respond<R: Real>(
    surface: &Surface<R>,
    contact: &ContactModel<R>,
    obstacle: &ObstacleModel<R>,
    friction: Friction,
    mass: R,
    dt: R,
    predicted: R::Vec3,
) -> R::Vec3 {
    let approach = predicted.dot(surface.normal);
    let after = normal_velocity(surface, contact, mass, dt, approach);
    let impulse = after - approach;
    if impulse <= R::ZERO {
        return predicted;
    }
    let tangential = predicted - surface.normal * approach;
    if friction == Friction::Without {
        return surface.normal * after + tangential;
    }
    surface.normal * after + slowed_by_friction::<R>(tangential, impulse, obstacle, friction)
}

/// Returns the velocity along the normal that the spring leaves of `approach`, m/s; less than `approach` where it would pull.
pub(super) fn normal_velocity<R: Real>(
    surface: &Surface<R>,
    contact: &ContactModel<R>,
    mass: R,
    dt: R,
    approach: R,
) -> R {
    // A body put deep inside is pushed out as if it were at the limit: it leaves, it is not shot out.
    let depth = (-surface.gap).min(contact.depth_limit);
    let pushed = (approach + dt * contact.stiffness * depth / mass)
        / (R::ONE + (dt * dt * contact.stiffness + dt * contact.damping) / mass);
    pushed.max(min_normal_velocity(surface, contact, dt))
}

/// The least velocity along the normal that ends the step no deeper than the limit, or than where it began, m/s.
pub(super) fn min_normal_velocity<R: Real>(surface: &Surface<R>, contact: &ContactModel<R>, dt: R) -> R {
    let deepest = contact.depth_limit.max(-surface.gap);
    -(deepest + surface.gap) / dt
}

/// Whether an obstacle rubs at all.
pub(super) fn has_friction<R: Real>(obstacle: &ObstacleModel<R>) -> bool {
    obstacle.friction_static > R::ZERO || obstacle.friction_dynamic > R::ZERO
}

/// Coulomb friction as a stop (GC §6, settled): the tangential velocity the particle would have is taken away where
/// static friction can hold it, else reduced by dynamic friction, never reversed. `impulse` is the normal impulse over
/// the mass, m/s.
fn slowed_by_friction<R: Real>(
    tangential: R::Vec3,
    impulse: R,
    obstacle: &ObstacleModel<R>,
    friction: Friction,
) -> R::Vec3 {
    let speed = tangential.length();
    if friction == Friction::Coulomb && speed <= obstacle.friction_static * impulse {
        return R::Vec3::ZERO;
    }
    let braked = speed - (obstacle.friction_dynamic * impulse).min(speed);
    if speed > R::ZERO { tangential * (braked / speed) } else { tangential }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::math::Aabb;
    use crate::physics::model::ObstacleShape;

    const MASS: f64 = 0.1;
    const DT: f64 = 1e-3;

    fn after(gap: f64, stiffness: f64, friction: [f64; 2], predicted: DVec3) -> DVec3 {
        let surface = Surface { normal: DVec3::Y, gap };
        let contact = ContactModel {
            stiffness,
            damping: 2.0 * (stiffness * MASS).sqrt(),
            depth_limit: 0.02,
            thesis_threshold: 0.0,
        };
        let obstacle = ObstacleModel {
            shape: ObstacleShape::Sphere { center: DVec3::ZERO, radius: 1.0 },
            bounds: Aabb::empty(),
            motion: None,
            carry: None,
            edges: std::sync::Arc::default(),
            friction_static: friction[0],
            friction_dynamic: friction[1],
        };
        respond(&surface, &contact, &obstacle, Friction::Coulomb, MASS, DT, predicted)
    }

    #[test]
    fn a_weight_at_its_resting_depth_stays() {
        let g = 9.81;
        let v = after(-MASS * g / 1e4, 1e4, [0.0; 2], DVec3::NEG_Y * g * DT);
        assert!(v.length() < 1e-15, "k p = m g holds it still: {v}");
    }

    #[test]
    fn no_stiffness_and_no_speed_leads_deeper_than_the_limit() {
        for stiffness in [0.0, 1.0, 1e4, 1e9] {
            let v = after(0.5, stiffness, [0.0; 2], DVec3::NEG_Y * 1e4);
            assert!(0.5 + v.y * DT >= -0.02 - 1e-12, "stiffness {stiffness} ends at {}", 0.5 + v.y * DT);
        }
    }

    #[test]
    fn contact_never_pulls() {
        let leaving = DVec3::Y * 100.0;
        assert_eq!(after(-0.001, 1e4, [1.0; 2], leaving), leaving, "a particle that leaves is let go");
    }

    #[test]
    fn what_starts_deep_is_not_shot_out() {
        let v = after(-10.0, 1e6, [0.0; 2], DVec3::ZERO);
        assert!(v.y > 0.0 && v.y * v.y <= 1e6 / MASS * 0.02 * 0.02, "no more than the energy at the limit: {v}");
    }

    #[test]
    fn friction_holds_below_its_limit_brakes_above_and_never_reverses() {
        let push = DVec3::new(0.4, -1.0, 0.0);
        assert!(after(-0.01, 1e9, [0.5, 0.3], push).x.abs() < 1e-15, "0.4 of the normal impulse is held by 0.5");
        let sliding = after(-0.01, 0.0, [0.3, 0.2], DVec3::new(1.0, -1.0, 0.0));
        assert!(sliding.x > 0.0, "a braked particle goes on in its direction: {sliding}");
    }
}
