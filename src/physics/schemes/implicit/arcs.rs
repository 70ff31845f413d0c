//! A body that turns moves along arcs.
//!
//! Velocities that belong to a turning body lead its particles off along straight lines, by which it grows by half the square of
//! the angle in every step. In a stiff body that is far more energy than it has; the step would be taken in ever shorter parts.
//! So the rigid part of the motion is followed exactly:
//!
//! ```text
//! x' = x + dt v' + (R − 1 − dt [ω]) r     r from the centre of mass, ω by the angular momentum, R the rotation by ω dt
//! ```
//!
//! which differs from `x + dt v'` by an error of the order of the scheme, and for a body that does not turn not at all.

use std::ops::Range;

use glam::{DMat3, DVec3};

use crate::math::{Real, Vector};
use crate::physics::model::{BodyModel, Model, Values};
use crate::physics::state::State;

/// Below this share of the cube of its mean inertia the determinant of a body's inertia is taken for zero: all of its
/// particles are on a line.
const MIN_DETERMINANT_SHARE: f64 = 1e-9;

/// Writes the velocities that lead particles along arcs in a step of `dt` (s), given those at its end.
pub(in crate::physics) fn write<R: Real>(
    model: &Model<R>,
    state: &State<R>,
    dt: f64,
    velocity: &[R::Vec3],
    moving: &mut [R::Vec3],
) {
    for (body, memory) in model.bodies.iter().zip(&state.bodies) {
        let own = body.particles.clone();
        if memory.asleep {
            moving[own].fill(R::Vec3::ZERO);
            continue;
        }
        moving[own.clone()].copy_from_slice(&velocity[own.clone()]);
        // What is pinned does not turn as a whole.
        if body.pinned != Values::Uniform(false) {
            continue;
        }
        let (center, turn) = rigid_motion(body, own.clone(), state, velocity);
        let angle = turn.length() * dt;
        if !angle.is_finite() || angle == 0.0 {
            continue;
        }
        let axis = turn * (dt / angle);
        let [ahead, inwards] = [(libm::sin(angle) - angle) / dt, (1.0 - libm::cos(angle)) / dt];
        for (particle, moving) in own.clone().zip(&mut moving[own]) {
            let side = axis.cross(state.position[particle].to_dvec3() - center);
            *moving += R::Vec3::from_dvec3(side * ahead + axis.cross(side) * inwards);
        }
    }
}

/// Returns the centre of mass of a body, m, and how it turns about it, 1/s.
fn rigid_motion<R: Real>(
    body: &BodyModel<R>,
    own: Range<usize>,
    state: &State<R>,
    velocity: &[R::Vec3],
) -> (DVec3, DVec3) {
    let masses = || own.clone().enumerate().map(|(local, particle)| (body.mass(local).to_f64(), particle));
    let position = |particle: usize| state.position[particle].to_dvec3();
    let (sum, total) = masses()
        .fold((DVec3::ZERO, 0.0), |(sum, total), (mass, particle)| (sum + position(particle) * mass, total + mass));
    let center = sum / total;
    let (mut inertia, mut moment) = (DMat3::ZERO, DVec3::ZERO);
    for (mass, particle) in masses() {
        let from = position(particle) - center;
        let outer = DMat3::from_cols(from * from.x, from * from.y, from * from.z);
        inertia += (DMat3::from_diagonal(DVec3::splat(from.length_squared())) - outer) * mass;
        moment += from.cross(velocity[particle].to_dvec3()) * mass;
    }
    let mean = (inertia.x_axis.x + inertia.y_axis.y + inertia.z_axis.z) / 3.0;
    let is_thin = inertia.determinant() <= MIN_DETERMINANT_SHARE * mean * mean * mean;
    (center, if is_thin { DVec3::ZERO } else { inertia.inverse() * moment })
}
