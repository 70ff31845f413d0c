//! The law of a link (GC §2), and walks over the links of a body. [`crate::physics::kernels`] evaluates the same law for
//! many links at a time and is tested against this module.

use glam::DVec3;

use crate::math::{Real, Vector};
use crate::physics::model::plan::Plan;
use crate::physics::model::{BodyModel, Link, LinkConstants, LinkFamily};

/// Links between two checks whether to stop: at some 20 ns each well below a hundredth of a second.
const LINKS_PER_STOP_CHECK: usize = 1 << 16;

/// Positions and velocities at which forces are evaluated.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct Configuration<'a, R: Real> {
    /// m.
    pub(in crate::physics) position: &'a [R::Vec3],
    /// m/s.
    pub(in crate::physics) velocity: &'a [R::Vec3],
    /// What rounding has kept back from the positions, m. If given, links are evaluated exactly and without damping, as the
    /// implicit integrator needs them.
    pub(in crate::physics) residual: Option<&'a [R::Vec3]>,
}

/// A link in double precision.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct ExactLink {
    /// Vector from the first end to the second, m.
    pub(in crate::physics) d: DVec3,
    /// One over the rest length, 1/m.
    pub(in crate::physics) inverse_rest_length: f64,
    /// Force at 100 % strain, N.
    pub(in crate::physics) stiffness: f64,
    /// Force at a relative speed of one rest length a second, N.
    pub(in crate::physics) damping: f64,
}

/// Calls `visit` with the ends (local numbers) of every link of the chosen families and the link between them, until it
/// `stops`. The positions and what rounding has kept back from them are the body's own.
pub(in crate::physics) fn for_each_exact_link<R: Real>(
    body: &BodyModel<R>,
    families: [bool; 3],
    [position, residual]: [&[R::Vec3]; 2],
    stops: &dyn Fn() -> bool,
    mut visit: impl FnMut([usize; 2], ExactLink),
) {
    for (family, _) in body.links.iter().zip(families).filter(|(_, chosen)| *chosen) {
        for (number, link) in family.links.iter().enumerate() {
            if number % LINKS_PER_STOP_CHECK == 0 && stops() {
                return;
            }
            let [i, j] = link.ends.map(|end| end as usize);
            let [stiffness, damping] = family.constants(number).map(Real::to_f64);
            let kept_back = residual[j].to_dvec3() - residual[i].to_dvec3();
            let d = position[j].to_dvec3() - position[i].to_dvec3() + kept_back;
            let inverse_rest_length = 1.0 / link.rest_length.to_f64();
            visit([i, j], ExactLink { d, inverse_rest_length, stiffness, damping });
        }
    }
}

/// Calls `visit` with the ends (local numbers) of every link of the plan's families and the force on the first end, N,
/// until it `stops`. `position` and `velocity` are the body's own.
pub(in crate::physics) fn for_each_link<R: Real>(
    body: &BodyModel<R>,
    plan: &Plan,
    position: &[R::Vec3],
    velocity: &[R::Vec3],
    stops: &dyn Fn() -> bool,
    mut visit: impl FnMut([usize; 2], R::Vec3),
) {
    for (family, _) in body.links.iter().zip(plan.families).filter(|(_, chosen)| *chosen) {
        let undamped = plan.lean && family.damping == R::ZERO;
        let mut evaluate = |link: &Link<R>, [stiffness, damping]: [R; 2]| {
            let [i, j] = link.ends.map(|end| end as usize);
            let d = position[j] - position[i];
            let on_i = if undamped {
                elastic_force(d, link.inverse_rest_length, stiffness)
            } else {
                link_force(d, velocity[j] - velocity[i], link.inverse_rest_length, stiffness, damping)
            };
            visit([i, j], on_i);
        };
        for (number, links) in family.links.chunks(LINKS_PER_STOP_CHECK).enumerate() {
            if stops() {
                return;
            }
            match &family.constants {
                LinkConstants::Uniform(constants) => links.iter().for_each(|link| evaluate(link, *constants)),
                LinkConstants::Classes { of_link, constants } => {
                    for (link, &class) in links.iter().zip(&of_link[number * LINKS_PER_STOP_CHECK..]) {
                        evaluate(link, constants[usize::from(class)]);
                    }
                }
            }
        }
    }
}

/// Whether the damping of a family is evaluated.
pub(in crate::physics) fn is_damped<R: Real>(plan: &Plan, family: &LinkFamily<R>) -> bool {
    family.damping > R::ZERO || !plan.lean
}

/// The tangent of a link's force: how it changes with a small change of the distance and of the speed of its ends.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct LinkTangent<R: Real> {
    /// Unit vector from the first end to the second.
    pub(in crate::physics) direction: R::Vec3,
    /// Stiffness along the direction, N/m.
    pub(in crate::physics) stiffness: R,
    /// The share of the stiffness that acts across the direction: the geometric stiffness of a link under tension, of which
    /// turning in the last step has no part; zero in a compressed link.
    pub(in crate::physics) geometric_share: R,
    /// Damping along the direction, N·s/m.
    pub(in crate::physics) damping: R,
}

/// Calls `visit` with the ends (local numbers) of every link of the chosen families that has a direction, and its
/// tangent, until it `stops`. Positions, m, and velocities, m/s, are the body's own; steps are of `dt` (s).
pub(in crate::physics) fn for_each_tangent<R: Real>(
    body: &BodyModel<R>,
    families: [bool; 3],
    [position, velocity]: [&[R::Vec3]; 2],
    dt: R,
    stops: &dyn Fn() -> bool,
    mut visit: impl FnMut([u32; 2], LinkTangent<R>),
) {
    for (family, _) in body.links.iter().zip(families).filter(|(_, chosen)| *chosen) {
        for (number, link) in family.links.iter().enumerate() {
            if number % LINKS_PER_STOP_CHECK == 0 && stops() {
                return;
            }
            let [from, to] = link.ends.map(|end| end as usize);
            let d = position[to] - position[from];
            let length = d.length();
            if length > R::ZERO {
                let inverse = R::ONE / length;
                let [stiffness, damping] = family.constants(number);
                let way = (velocity[to] - velocity[from]) * dt;
                let along = way.dot(d) * inverse;
                let unturned = (length * length - (way.dot(way) - along * along)).max(R::ZERO).sqrt();
                let tangent = LinkTangent {
                    direction: d * inverse,
                    stiffness: stiffness * link.inverse_rest_length,
                    geometric_share: (R::ONE - link.rest_length / unturned).max(R::ZERO),
                    damping: damping * link.inverse_rest_length,
                };
                visit(link.ends, tangent);
            }
        }
    }
}

/// Returns the force of a link without damping, N: bit for bit [`link_force`] with zero damping.
#[inline]
pub(in crate::physics) fn elastic_force<R: Real>(d: R::Vec3, inverse_rest_length: R, stiffness: R) -> R::Vec3 {
    let length = d.length();
    if length == R::ZERO {
        return R::Vec3::ZERO;
    }
    d * (R::ONE / length) * (stiffness * (length * inverse_rest_length - R::ONE))
}

/// Returns the force on the first end of a link, N (GC §2 with the sign of `F_j` settled: the second end gets the opposite).
///
/// `d` and `dv` are the second end's position and velocity relative to the first's, `stiffness` the force at 100 %
/// strain, `damping` the force at a relative speed of one rest length a second. Two ends in one place have no
/// direction to push in and get no force.
#[inline]
pub(in crate::physics) fn link_force<R: Real>(
    d: R::Vec3,
    dv: R::Vec3,
    inverse_rest_length: R,
    stiffness: R,
    damping: R,
) -> R::Vec3 {
    let length = d.length();
    if length == R::ZERO {
        return R::Vec3::ZERO;
    }
    let direction = d * (R::ONE / length);
    let strain = length * inverse_rest_length - R::ONE;
    let strain_rate = dv.dot(direction) * inverse_rest_length;
    direction * (stiffness * strain + damping * strain_rate)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn force(d: DVec3, dv: DVec3) -> DVec3 {
        link_force::<f64>(d, dv, 2.0, 20.0, 3.0)
    }

    #[test]
    fn a_stretched_link_pulls_with_stiffness_times_strain() {
        assert_eq!(force(DVec3::X, DVec3::ZERO), DVec3::new(20.0, 0.0, 0.0), "strain is one, the force k");
        assert_eq!(force(DVec3::X * 0.25, DVec3::ZERO), DVec3::new(-10.0, 0.0, 0.0), "half the length pushes back");
    }

    #[test]
    fn damping_acts_along_the_link_only() {
        let rest = DVec3::X * 0.5;
        assert_eq!(force(rest, DVec3::X), DVec3::new(6.0, 0.0, 0.0), "d times speed over rest length");
        assert_eq!(force(rest, DVec3::Y), DVec3::ZERO, "turning about an end is rigid motion");
    }

    #[test]
    fn without_damping_the_short_form_is_the_long_one_to_the_bit() {
        let mut rng = crate::math::rng::Rng::new(2);
        for _ in 0..1000 {
            let mut vector = || DVec3::from_array([0; 3].map(|_| rng.between(-2.0, 2.0))).as_vec3();
            let (d, dv) = (vector(), vector());
            let long = link_force::<f32>(d, dv, 1.7, 20.0, 0.0);
            assert_eq!(elastic_force::<f32>(d, 1.7, 20.0), long, "{d} {dv}");
        }
    }

    #[test]
    fn ends_in_one_place_give_a_finite_force() {
        assert_eq!(force(DVec3::ZERO, DVec3::X), DVec3::ZERO, "no direction, no force");
        let tiny = link_force::<f32>(glam::Vec3::X * 1e-19, glam::Vec3::X, 1.0, 1e8, 1e5);
        assert!(tiny.is_finite(), "a link of nearly no length is finite too: {tiny:?}");
    }
}
