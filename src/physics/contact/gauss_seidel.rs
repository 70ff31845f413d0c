//! A particle between several obstacles, by projected Gauss–Seidel. A push out of one obstacle may lead into the next, and
//! a soft push into a stiff obstacle would store energy there that came from nowhere. So the pushes are found together.
//!
//! The pushes are those of [`super::response`], each a spring taken implicitly; together they minimise `½ |v − v*|² + Σ
//! energy of the springs at the end of the step`, which is convex. Gauss–Seidel solves each contact in turn for what the
//! others leave, and converges to that minimum, at which the energy is no larger than without any push.
//!
//! Friction is solved in the same rounds. Found once, before the pushes, it would brake a motion that they then reverse,
//! and so drive the particle. Friction that has settled opposes the sliding that is left, and takes energy.

use super::record::ContactRecord;
use super::response::{self, Friction};
use super::surface::Surface;
use crate::math::{Real, Vector};
use crate::physics::model::{ContactModel, ObstacleModel};

/// Rounds over the contacts in which static friction may hold and the pushes have to settle to rounding error. After them
/// friction is dynamic, which does not jump between holding and sliding.
const STATIC_FRICTION_ROUNDS: usize = 16;

/// Most rounds in all, where the pushes are still changing after `STATIC_FRICTION_ROUNDS`: each round multiplies the error
/// by the cos² of the angle between two surfaces, so a narrow wedge needs many.
const MAX_ROUNDS: usize = 256;

/// Rounds between two looks at how fast the error falls. Where two in a row foretell that it will not have fallen far enough by
/// `MAX_ROUNDS`, the rest is spared: surfaces all but meet, or friction wedges the particle in and the error rises.
const ROUNDS_BETWEEN_FORECASTS: usize = 32;

/// After `STATIC_FRICTION_ROUNDS` the contacts have settled where none changes by more than this share of the largest speed at
/// hand. The predicted one is included: a particle held between obstacles has next to none.
const SETTLED_SHARE: f64 = 1e-5;

/// Returns the velocity that the contacts in `records` together leave a particle that would have `predicted`, and writes
/// their forces anew. None where the rounds do not settle: the particle is pinched between surfaces that all but meet.
pub(super) fn solve<R: Real>(
    predicted: R::Vec3,
    contacts: &[ContactModel<R>],
    obstacles: &[ObstacleModel<R>],
    mass: R,
    dt: R,
    records: &mut [ContactRecord<R>],
) -> Option<R::Vec3> {
    let corner = Corner { predicted, contacts, obstacles, mass, dt };
    // Where friction wedges a particle in, pushes and friction raise each other without end; the pushes alone settle.
    let settled = corner.settle(true, records).or_else(|| corner.settle(false, records));
    for record in records {
        record.force = record.force * if settled.is_some() { mass / dt } else { R::ZERO };
    }
    settled
}

/// A particle that meets several obstacles.
struct Corner<'a, R: Real> {
    predicted: R::Vec3,
    contacts: &'a [ContactModel<R>],
    obstacles: &'a [ObstacleModel<R>],
    mass: R,
    dt: R,
}

impl<R: Real> Corner<'_, R> {
    /// Goes round the contacts until they settle, `with_friction` or without. Returns the velocity, and writes each
    /// contact's change of it, m/s, as its force; none where they do not settle.
    fn settle(&self, with_friction: bool, records: &mut [ContactRecord<R>]) -> Option<R::Vec3> {
        let mut velocity = self.predicted;
        for record in &mut *records {
            record.force = R::Vec3::ZERO;
        }
        let mut forecast = Forecast { earlier: None, bad: 0 };
        for round in 0..MAX_ROUNDS {
            let is_static_phase = round < STATIC_FRICTION_ROUNDS;
            let friction = match () {
                () if !with_friction => Friction::Without,
                () if is_static_phase => Friction::Coulomb,
                () => Friction::Dynamic,
            };
            let mut largest = R::ZERO;
            let mut speeds = self.predicted.length();
            for record in &mut *records {
                let others = velocity - record.force;
                velocity = self.after(record, friction, others);
                let change = velocity - others;
                largest = largest.max((change - record.force).length());
                speeds = speeds.max(record.surface_velocity.length()).max(velocity.length());
                record.force = change;
            }
            let share = if is_static_phase { R::from_f64(4.0) * R::EPSILON } else { R::from_f64(SETTLED_SHARE) };
            if largest <= share * speeds {
                return Some(velocity);
            }
            if forecast.is_hopeless(round, largest, share * speeds) {
                return None;
            }
        }
        None
    }

    /// Returns the velocity after one contact, where the `others` leave this one.
    fn after(&self, record: &ContactRecord<R>, friction: Friction, others: R::Vec3) -> R::Vec3 {
        let surface = Surface { normal: record.normal, gap: record.gap };
        let (contact, obstacle) = (&self.contacts[record.obstacle], &self.obstacles[record.obstacle]);
        let relative_velocity = others - record.surface_velocity;
        let after = response::respond(&surface, contact, obstacle, friction, self.mass, self.dt, relative_velocity);
        // A particle that is not pushed keeps its velocity to the last bit.
        if after == relative_velocity { others } else { after + record.surface_velocity }
    }
}

/// How the error of rounds falls.
struct Forecast<R> {
    /// The error at the last look.
    earlier: Option<R>,
    /// How many looks in a row foretold that it will not fall far enough.
    bad: u32,
}

impl<R: Real> Forecast<R> {
    /// Looks at the `error` after a round, where it is time to. Returns whether it will be above `limit` even after the last one.
    fn is_hopeless(&mut self, round: usize, error: R, limit: R) -> bool {
        let rounds_left = MAX_ROUNDS - 1 - round;
        if !rounds_left.is_multiple_of(ROUNDS_BETWEEN_FORECASTS) {
            return false;
        }
        let more = rounds_left / ROUNDS_BETWEEN_FORECASTS;
        let falls_short = self.earlier.is_some_and(|earlier| {
            let ratio = error / earlier;
            (0..more).fold(error, |error, _| error * ratio) > limit
        });
        (self.earlier, self.bad) = (Some(error), if falls_short { self.bad + 1 } else { 0 });
        self.bad >= 2
    }
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
            motion: None,
            carry: None,
            edges: std::sync::Arc::default(),
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

    /// Solves for a particle on a stiff floor under a plate that comes down at 60 m/s, at an angle to the floor.
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
    fn friction_does_no_work_on_what_a_plate_drags_against_its_links() {
        // Links pull the particle one way all along, a plate that comes aslant takes it the other.
        let links = DVec3::new(-197.0, 407.0, -460.0);
        let floor = record(0, DVec3::new(0.538, 0.2, 0.819).normalize(), 0.0);
        let plate = record(1, DVec3::new(0.745, -0.615, -0.257).normalize(), 0.0);
        let mut records = [floor, ContactRecord { surface_velocity: DVec3::new(5.0, -31.4, 42.0), ..plate }];
        let mut obstacles = [obstacle(0.3), obstacle(0.3)];
        obstacles[0].friction_static = 4.0;
        let contacts = [contact(1e9), contact(1e9)];
        let velocity = solve(links, &contacts, &obstacles, MASS, DT, &mut records).expect("they agree");
        for record in records {
            let past = velocity - record.surface_velocity;
            let sliding = past - record.normal * past.dot(record.normal);
            let power = (record.force - record.normal * record.force.dot(record.normal)).dot(sliding);
            assert!(power <= 1e-6 * record.force.length() * velocity.length(), "{power} W: {velocity}, {record:?}");
        }
        let [work, given] = [
            records[1].force.dot(records[1].surface_velocity),
            records.iter().map(|record| record.force.dot(velocity)).sum(),
        ];
        assert!(given <= 1.01 * work, "the contacts give {given} W, of which the plate has {work} W");
    }

    /// The round after which an error that is `error` after each round is given up.
    fn given_up(error: impl Fn(usize) -> f64) -> Option<usize> {
        let mut forecast = Forecast { earlier: None, bad: 0 };
        (0..MAX_ROUNDS).find(|round| forecast.is_hopeless(*round, error(*round), 1e-5))
    }

    #[test]
    fn what_falls_too_slowly_is_given_up_and_what_will_settle_is_not() {
        let last = MAX_ROUNDS - 1;
        let falls_to = |end: f64| move |round: usize| libm::pow(end, round as f64 / last as f64);
        assert_eq!(given_up(falls_to(0.9e-5)), None, "it settles in the last round");
        assert_eq!(given_up(falls_to(1.1e-5)), Some(95), "it would not");
        assert_eq!(given_up(|round| libm::exp2(round as f64)), Some(95), "it rises");
        assert_eq!(given_up(|_| 1.0), Some(95), "it stays");
        let once = |round| if round < 70 { 1.0 } else { libm::exp2(-((round - 70) as f64)) };
        assert_eq!(given_up(once), None, "after one bad look a contact lets go, and the rest settles");
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
            Friction::Coulomb,
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
