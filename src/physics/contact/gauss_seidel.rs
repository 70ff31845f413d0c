//! A particle between several obstacles, by projected Gauss–Seidel: what pushes it out of one may push it into the
//! next, and a soft push into a stiff obstacle would store energy there that nobody had. So the pushes are found
//! together.
//!
//! The pushes are those of [`super::response`], each a spring taken implicitly; together they minimise `½ |v − v*|² + Σ
//! energy of the springs at the end of the step`, which is convex. Going round the contacts, each push in turn being
//! what the others leave to it (Gauss–Seidel), comes to that minimum, at which the energy is no larger than without any
//! push.

use super::record::ContactRecord;
use super::response;
use super::surface::Surface;
use crate::math::{Real, Vector};
use crate::physics::model::{ContactModel, ObstacleModel};

/// Rounds about the contacts, before and after friction; they are for rounding to settle, too.
const ROUNDS: usize = 16;

/// Rounds at most where the pushes are still changing after these: each takes the share cos² of the angle between two
/// surfaces off what is missing, so a narrow wedge needs many.
const MOST_ROUNDS: usize = 256;

/// The pushes have settled where none changes by more than this share of the speeds at hand.
const SETTLED_SHARE: f64 = 1e-5;

/// The velocity that the contacts in `records` together leave a particle that would have `predicted`; their forces are
/// written anew. None where they do not agree on one: the particle is pinched between surfaces that all but meet.
pub(super) fn solve<R: Real>(
    predicted: R::Vec3,
    contacts: &[ContactModel<R>],
    obstacles: &[ObstacleModel<R>],
    mass: R,
    dt: R,
    records: &mut [ContactRecord<R>],
) -> Option<R::Vec3> {
    let mut velocity = predicted;
    // Until the end the forces are changes of velocity: along the normal the push, across it friction.
    for record in &mut *records {
        record.force = R::Vec3::ZERO;
    }
    let mut has_settled = push_together(&mut velocity, contacts, mass, dt, records);
    for record in &mut *records {
        let obstacle = &obstacles[record.obstacle];
        let impulse = record.force.dot(record.normal);
        if impulse > R::ZERO && response::has_friction(obstacle) {
            let past = velocity - record.surface_velocity;
            let tangential = past - record.normal * past.dot(record.normal);
            let braking = response::slowed_by_friction::<R>(tangential, impulse, obstacle) - tangential;
            velocity += braking;
            record.force += braking;
        }
    }
    // Friction on one may press into another.
    has_settled &= push_together(&mut velocity, contacts, mass, dt, records);
    for record in records {
        record.force = record.force * if has_settled { mass / dt } else { R::ZERO };
    }
    has_settled.then_some(velocity)
}

/// Says whether the pushes have settled.
fn push_together<R: Real>(
    velocity: &mut R::Vec3,
    contacts: &[ContactModel<R>],
    mass: R,
    dt: R,
    records: &mut [ContactRecord<R>],
) -> bool {
    for round in 0..MOST_ROUNDS {
        let mut largest = R::ZERO;
        let mut speeds = velocity.length();
        for record in &mut *records {
            let surface = Surface { normal: record.normal, gap: record.gap };
            let had = record.force.dot(record.normal);
            let left = (*velocity - record.surface_velocity).dot(record.normal) - had;
            let pushed = response::normal_velocity(&surface, &contacts[record.obstacle], mass, dt, left);
            let change = (pushed - left).max(R::ZERO) - had;
            if change != R::ZERO {
                *velocity += record.normal * change;
                record.force += record.normal * change;
                largest = largest.max(change.abs());
                speeds = speeds.max(record.surface_velocity.length()).max(velocity.length());
            }
        }
        let settled = if round < ROUNDS { R::ZERO } else { R::from_f64(SETTLED_SHARE) * speeds };
        if largest <= settled {
            return true;
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::math::Aabb;
    use crate::physics::model::ObstacleShape;

    const MASS: f64 = 0.1;
    const DT: f64 = 1e-3;

    fn contact(stiffness: f64) -> ContactModel<f64> {
        let damping = 2.0 * (stiffness * MASS).sqrt();
        ContactModel { stiffness, damping, depth_limit: 0.02, thesis_threshold: 0.0 }
    }

    fn obstacle(friction: f64) -> ObstacleModel<f64> {
        ObstacleModel {
            shape: ObstacleShape::Sphere { center: DVec3::ZERO, radius: 1.0 },
            bounds: Aabb::empty(),
            carry: None,
            friction_static: friction,
            friction_dynamic: friction,
        }
    }

    fn record(obstacle: usize, normal: DVec3, gap: f64) -> ContactRecord<f64> {
        ContactRecord { particle: 0, obstacle, normal, gap, surface_velocity: DVec3::ZERO, force: DVec3::ZERO }
    }

    #[test]
    fn a_soft_obstacle_does_not_push_into_a_stiff_one() {
        // Deep in the soft one, at the surface of the stiff one, squeezed between them.
        let contacts = [contact(1e9), contact(1e4)];
        for friction in [0.0, 1.0] {
            let obstacles = [obstacle(friction), obstacle(friction)];
            let aslant = DVec3::new(0.6, -0.8, 0.0);
            let mut records = [record(0, DVec3::Y, 0.0), record(1, aslant, -0.5)];
            let settled = solve(DVec3::ZERO, &contacts, &obstacles, MASS, DT, &mut records);
            let velocity = settled.expect("they agree");
            let depth = -velocity.y * DT;
            let stored = 0.5 * 1e9 * depth * depth.max(0.0);
            let given = 1e4 * 0.02 * velocity.dot(aslant) * DT;
            assert!(stored <= given, "{stored} J are stored, {given} J were given: {velocity}");
            let forces = (records[0].force + records[1].force) * (DT / MASS);
            assert!((forces - velocity).length() < 1e-9, "the forces make the velocity: {forces} and {velocity}");
        }
    }

    /// What a plate that comes down at 60 m/s, aslant by an angle to a stiff floor, makes of a particle on it.
    fn under_a_plate(degrees: f64) -> (Option<DVec3>, [ContactRecord<f64>; 2]) {
        let down = DVec3::new(degrees.to_radians().sin(), -degrees.to_radians().cos(), 0.0);
        let plate = ContactRecord { surface_velocity: down * 60.0, ..record(1, down, 0.0) };
        let mut records = [record(0, DVec3::Y, 0.0), plate];
        let (contacts, obstacles) = ([contact(1e9), contact(1e4)], [obstacle(0.0), obstacle(0.0)]);
        (solve(DVec3::ZERO, &contacts, &obstacles, MASS, DT, &mut records), records)
    }

    #[test]
    fn a_narrow_wedge_that_closes_stores_no_more_than_its_work() {
        for degrees in [60.0, 30.0, 17.0] {
            let (velocity, [floor, plate]) = under_a_plate(degrees);
            let velocity = velocity.expect("it slips out");
            let stored = contact(1e9).energy(-velocity.y * DT) + 0.5 * MASS * velocity.length_squared();
            let work = plate.force.dot(plate.surface_velocity) * DT;
            assert!(stored <= work, "{degrees}°: {stored} J are stored, {work} J were given: {velocity}, {floor:?}");
        }
    }

    #[test]
    fn a_particle_between_surfaces_that_all_but_meet_is_pinched() {
        let (velocity, records) = under_a_plate(0.5);
        assert_eq!(velocity, None, "no slipping out of half a degree");
        assert!(
            records.iter().all(|record| record.force == DVec3::ZERO),
            "and no forces of half a solution: {records:?}"
        );
    }

    #[test]
    fn one_contact_is_as_it_is_alone() {
        let contacts = [contact(1e5)];
        let obstacles = [obstacle(0.3)];
        let predicted = DVec3::new(1.0, -2.0, 0.5);
        let alone = response::respond(
            &Surface { normal: DVec3::Y, gap: -0.01 },
            &contacts[0],
            &obstacles[0],
            true,
            MASS,
            DT,
            predicted,
        );
        let mut records = [record(0, DVec3::Y, -0.01)];
        let settled = solve(predicted, &contacts, &obstacles, MASS, DT, &mut records);
        let settled = settled.expect("it is alone");
        assert!((alone - settled).length() < 1e-12, "{alone} and {settled}");
    }
}
