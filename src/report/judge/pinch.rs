//! How fast a particle leaves that surfaces pinch.
//!
//! A surface that moves at the speed s along its normal pushes what it meets at that speed. Where another surface stands in
//! the way at an angle, the particle can only leave along it, and does so faster, like a pip between two fingers. Surfaces
//! with the normals nᵢ and the speeds sᵢ along them give it at least the shortest velocity u with `u · nᵢ = sᵢ` for each of
//! them.

use glam::{DMat3, DVec3};

use crate::math::{Real, Vector};
use crate::physics::{ContactRecord, SampleContact, Simulation, WeightedParticles};

/// Surfaces whose normals span less than this of a plane, or of space, are nearly parallel: the particle cannot leave.
const MIN_SPAN: f64 = 1e-3;

/// Returns the largest speed at which surfaces that pushed a particle of a body in the last substep, or a point of its mesh,
/// made a particle leave, m/s.
pub(super) fn pinched_speed<R: Real>(simulation: &Simulation<R>, body: usize) -> f64 {
    let particles = &simulation.model().bodies[body].particles;
    let of_particle = simulation.contacts().chunk_by(|one, next| one.particle == next.particle);
    let own = of_particle.filter(|those| those.len() > 1 && particles.contains(&those[0].particle));
    let of_particles = own.map(|those| {
        let pushing = those.iter().filter(|contact| contact.force.dot(contact.normal) > R::ZERO);
        leaving_speed(&pushing.map(Surface::of).collect::<Vec<_>>())
    });
    let of_point =
        simulation.sample_contacts().chunk_by(|one, next| (one.body, one.sample) == (next.body, next.sample));
    let of_points = of_point.filter(|those| those[0].body == body).map(|those| {
        let pushing = those.iter().filter(|contact| contact.force.dot(contact.normal) > 0.0);
        let surfaces: Vec<Surface> = pushing.map(Surface::of_point).collect();
        let alone = surfaces.iter().fold(0.0, |most: f64, surface| most.max(surface.speed));
        alone.max(leaving_speed(&surfaces)) * throw_ratio(&those[0].own)
    });
    of_particles.chain(of_points).fold(0.0, f64::max)
}

/// How many times as fast as a point of a cell its fastest corner moves, if the corners are alike and nothing but what pushes
/// the point moves them.
fn throw_ratio(corners: &WeightedParticles) -> f64 {
    let squares: f64 = corners.iter().map(|(_, weight)| weight * weight).sum();
    corners.iter().fold(0.0, |most: f64, (_, weight)| most.max(weight.abs())) / squares
}

/// A surface that pushes a particle.
#[derive(Clone, Copy, Debug)]
struct Surface {
    normal: DVec3,
    /// Its speed along the normal, m/s.
    speed: f64,
}

impl Surface {
    fn of<R: Real>(contact: &ContactRecord<R>) -> Self {
        let normal = contact.normal.to_dvec3();
        Self { normal, speed: contact.surface_velocity.to_dvec3().dot(normal) }
    }

    fn of_point(contact: &SampleContact) -> Self {
        Self { normal: contact.normal, speed: contact.surface_velocity.dot(contact.normal) }
    }
}

/// Returns the largest speed of a particle that two or three of these surfaces push, m/s.
fn leaving_speed(surfaces: &[Surface]) -> f64 {
    let mut most = 0.0_f64;
    for (place, a) in surfaces.iter().enumerate() {
        for (next, b) in surfaces.iter().enumerate().skip(place + 1) {
            let across = a.normal.cross(b.normal);
            if across.length() < MIN_SPAN {
                continue;
            }
            // Across both normals nothing pushes: two surfaces are three, and the third does not move.
            let free = Surface { normal: across.normalize(), speed: 0.0 };
            for c in surfaces[next + 1..].iter().chain([&free]) {
                let normals = DMat3::from_cols(a.normal, b.normal, c.normal);
                if normals.determinant().abs() >= MIN_SPAN {
                    let velocity = normals.transpose().inverse() * DVec3::new(a.speed, b.speed, c.speed);
                    most = most.max(velocity.length());
                }
            }
        }
    }
    most
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_particle_leaves_a_wedge_faster_the_sharper_it_is() {
        let ground = Surface { normal: DVec3::Y, speed: 0.0 };
        for angle in [0.1_f64, 0.5, 1.0] {
            // A plate comes down on the ground at this angle to it.
            let plate = Surface { normal: DVec3::new(angle.sin(), -angle.cos(), 0.0), speed: 2.0 * angle.cos() };
            let found = leaving_speed(&[ground, plate]);
            assert!((found * angle.tan() / 2.0 - 1.0).abs() < 1e-9, "{angle}: {found} m/s");
        }
        let parallel = Surface { normal: DVec3::NEG_Y, speed: 2.0 };
        assert!(leaving_speed(&[ground, parallel]) < 1e-12, "it cannot leave");
    }

    #[test]
    fn three_surfaces_leave_one_way_out() {
        let side = Surface { normal: DVec3::X, speed: 0.0 };
        let ground = Surface { normal: DVec3::Y, speed: 0.0 };
        let plate = Surface { normal: DVec3::new(-0.48, -0.64, 0.6), speed: 1.5 };
        let found = leaving_speed(&[side, ground, plate]);
        assert!((found - 2.5).abs() < 1e-12, "{found} m/s along z, 1.5 of them along the normal of the plate");
    }
}
