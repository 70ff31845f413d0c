//! The rigid motion of a free modal body: position, rotation, velocity and angular momentum.

use glam::{DQuat, DVec3};

use crate::physics::model::Inertia;

/// The rigid motion of a free modal body, without its vibration. All in the scene's coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidState {
    /// The centre of mass, m.
    pub center: DVec3,
    /// From the body's coordinates to the scene's; of length 1.
    pub turn: DQuat,
    /// The velocity of the centre of mass at the start of the next substep, m/s.
    pub velocity: DVec3,
    /// The angular momentum about the centre of mass, kg m²/s.
    pub momentum: DVec3,
    /// The mean velocity over the last substep, m/s: the speed that is shown.
    pub mean_velocity: DVec3,
    /// The mean angular velocity over the last substep, 1/s.
    pub mean_spin: DVec3,
}

impl RigidState {
    /// How many numbers it consists of.
    pub const NUMBERS: usize = 19;

    /// All its numbers, in the order of its fields.
    pub fn numbers(&self) -> [f64; Self::NUMBERS] {
        let Self { center, turn, velocity, momentum, mean_velocity, mean_spin } = self;
        let ([x, y, z], [i, j, k, w]) = (center.to_array(), turn.to_array());
        let mut all = [0.0; Self::NUMBERS];
        all[..7].copy_from_slice(&[x, y, z, i, j, k, w]);
        let vectors = [velocity, momentum, mean_velocity, mean_spin];
        for (to, vector) in all[7..].chunks_exact_mut(3).zip(vectors) {
            to.copy_from_slice(&vector.to_array());
        }
        all
    }

    /// The motion that consists of these numbers.
    pub fn from_numbers(all: [f64; Self::NUMBERS]) -> Self {
        let vector = |first: usize| DVec3::new(all[first], all[first + 1], all[first + 2]);
        Self {
            center: vector(0),
            turn: DQuat::from_xyzw(all[3], all[4], all[5], all[6]),
            velocity: vector(7),
            momentum: vector(10),
            mean_velocity: vector(13),
            mean_spin: vector(16),
        }
    }

    /// The kinetic energy of moving and turning, J.
    pub fn energy(&self, inertia: &Inertia) -> f64 {
        let own = self.turn.conjugate() * self.momentum;
        0.5 * (inertia.mass * self.velocity.length_squared() + own.dot(inertia.angular_velocity(own)))
    }

    /// Stops the motion in place.
    pub(in crate::physics) fn stop(&mut self) {
        (self.velocity, self.momentum, self.mean_velocity, self.mean_spin) = Default::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn its_numbers_make_it_again() {
        let all: [f64; RigidState::NUMBERS] = std::array::from_fn(|place| place as f64);
        assert_eq!(RigidState::from_numbers(all).numbers().map(f64::to_bits), all.map(f64::to_bits));
        assert_eq!(RigidState::from_numbers(all).mean_spin, DVec3::new(16.0, 17.0, 18.0), "to the last");
    }
}
