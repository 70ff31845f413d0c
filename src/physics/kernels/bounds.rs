//! Bounding boxes of many vectors at a time, and whether all of them are finite.
//!
//! Vectors lie in memory as `x y z x y z …`. Each number of 16 contiguous vectors has a place in an array of 48, and the
//! smallest number at each place is found for all places at once, without a branch. In the end the smallest of a component
//! is the smallest of its 16 places: the order does not matter, so every level finds the same.

use crate::math::{Aabb, Real, Vector, components};
use crate::physics::kernels::SimdLevel;

/// Numbers that are worked on at a time: those of 16 vectors.
pub(super) const PLACES: usize = 3 * 16;

/// Vectors that share a bounding box, where they are boxed in groups.
pub(in crate::physics) const GROUP_SIZE: usize = 64;

/// Returns the bounding box of some vectors.
pub(in crate::physics) fn bounds<R: Real>(level: SimdLevel, of: &[R::Vec3]) -> Aabb<R> {
    level.run(
        #[inline(always)]
        || {
            let mut extremes = Extremes::none();
            extremes.include::<false>(components(of), components(of), R::ZERO);
            extremes.bounds()
        },
    )
}

/// Returns the bounding box of the differences `to - from` of pairs of vectors.
pub(in crate::physics) fn displacement_bounds<R: Real>(level: SimdLevel, from: &[R::Vec3], to: &[R::Vec3]) -> Aabb<R> {
    level.run(
        #[inline(always)]
        || {
            let mut extremes = Extremes::none();
            extremes.include_displacements(components(from), components(to));
            extremes.bounds()
        },
    )
}

/// Writes the bounding box of the motion of each [`GROUP_SIZE`] of particles that move from `position` (m) for `secs`
/// with `velocity` (m/s).
pub(in crate::physics) fn motion_bounds<R: Real>(
    level: SimdLevel,
    position: &[R::Vec3],
    velocity: &[R::Vec3],
    secs: R,
    boxes: &mut [Aabb<R>],
) {
    level.run(
        #[inline(always)]
        || {
            for ((position, velocity), to) in position.chunks(GROUP_SIZE).zip(velocity.chunks(GROUP_SIZE)).zip(boxes) {
                let mut extremes = Extremes::none();
                extremes.include::<true>(components(position), components(velocity), secs);
                *to = extremes.bounds();
            }
        },
    );
}

/// Whether all particles that move from `position` (m) for `secs` with `velocity` (m/s) come to a finite place. False if
/// an input is not finite.
pub(in crate::physics) fn are_finite<R: Real>(
    level: SimdLevel,
    position: &[R::Vec3],
    path: &[R::Vec3],
    secs: R,
) -> bool {
    level.run(
        #[inline(always)]
        || {
            let (position, path) = (components::<R>(position), components::<R>(path));
            let mut all = true;
            for (position, path) in position.iter().zip(path) {
                all &= (*position + *path * secs).is_finite();
            }
            all
        },
    )
}

/// The smallest and the largest number at each place.
pub(super) struct Extremes<R> {
    low: [R; PLACES],
    high: [R; PLACES],
}

impl<R: Real> Extremes<R> {
    #[inline(always)]
    pub(super) fn none() -> Self {
        let infinity = R::from_f64(f64::INFINITY);
        Self { low: [infinity; PLACES], high: [-infinity; PLACES] }
    }

    /// Includes the numbers `from` and, if they `MOVE`, those they come to.
    #[inline(always)]
    fn include<const MOVE: bool>(&mut self, from: &[R], velocity: &[R], secs: R) {
        let (whole, rest) = from.as_chunks::<PLACES>();
        let (velocities, velocity_rest) = velocity.as_chunks::<PLACES>();
        for (from, velocity) in whole.iter().zip(velocities) {
            for place in 0..PLACES {
                self.include_number::<MOVE>(place, from[place], velocity[place], secs);
            }
        }
        for (place, (from, velocity)) in rest.iter().zip(velocity_rest).enumerate() {
            self.include_number::<MOVE>(place, *from, *velocity, secs);
        }
    }

    /// Includes the numbers of up to 16 vectors.
    #[inline(always)]
    pub(super) fn include_numbers(&mut self, of: &[R]) {
        for (place, number) in of.iter().enumerate() {
            self.include_number::<false>(place, *number, R::ZERO, R::ZERO);
        }
    }

    /// Includes the differences `to - from`.
    #[inline(always)]
    fn include_displacements(&mut self, from: &[R], to: &[R]) {
        let ((whole, rest), (ends, ends_rest)) = (from.as_chunks::<PLACES>(), to.as_chunks::<PLACES>());
        for (from, to) in whole.iter().zip(ends) {
            for place in 0..PLACES {
                self.include_number::<false>(place, to[place] - from[place], R::ZERO, R::ZERO);
            }
        }
        for (place, (from, to)) in rest.iter().zip(ends_rest).enumerate() {
            self.include_number::<false>(place, *to - *from, R::ZERO, R::ZERO);
        }
    }

    #[inline(always)]
    fn include_number<const MOVE: bool>(&mut self, place: usize, from: R, velocity: R, secs: R) {
        // Not `min`, whose rules for NaN double the cost. A NaN is passed over here too.
        let smaller = |a: R, b: R| if b < a { b } else { a };
        let larger = |a: R, b: R| if b > a { b } else { a };
        let (mut low, mut high) = (smaller(self.low[place], from), larger(self.high[place], from));
        if MOVE {
            let to = from + velocity * secs;
            (low, high) = (smaller(low, to), larger(high, to));
        }
        (self.low[place], self.high[place]) = (low, high);
    }

    #[inline(always)]
    pub(super) fn bounds(&self) -> Aabb<R> {
        let at = |of: &[R; PLACES], place: usize| R::Vec3::new(of[place], of[place + 1], of[place + 2]);
        (0..PLACES).step_by(3).fold(Aabb::empty(), |bounds, place| {
            bounds.joined(Aabb { min: at(&self.low, place), max: at(&self.high, place) })
        })
    }
}

#[cfg(test)]
pub(super) mod tests {
    use glam::{DVec3, Vec3};

    use super::*;
    use crate::math::rng::Rng;

    /// Draws `count` random vectors.
    pub(in crate::physics::kernels) fn random(count: usize, rng: &mut Rng) -> Vec<Vec3> {
        let vector = |rng: &mut Rng| Vec3::from_dvec3(DVec3::from([0; 3].map(|_| rng.between(-5.0, 5.0))));
        (0..count).map(|_| vector(rng)).collect()
    }

    #[test]
    fn boxes_are_those_of_the_points_one_by_one() {
        let mut rng = Rng::new(7);
        for count in [0, 1, 15, 16, 63, 64, 65, 200] {
            let [position, velocity] = [0; 2].map(|_| random(count, &mut rng));
            for level in SimdLevel::ALL.into_iter().filter(|level| level.is_available()) {
                assert_eq!(bounds::<f32>(level, &position), Aabb::around(position.iter().copied()), "{count}");
                let ways = position.iter().zip(&velocity).map(|(from, to)| *to - *from);
                assert_eq!(displacement_bounds::<f32>(level, &position, &velocity), Aabb::around(ways), "{count}");
                let mut boxes = vec![Aabb::empty(); count.div_ceil(GROUP_SIZE)];
                motion_bounds::<f32>(level, &position, &velocity, 0.25, &mut boxes);
                let ends = |group: usize| {
                    let own = group * GROUP_SIZE..count.min((group + 1) * GROUP_SIZE);
                    own.flat_map(|p| [position[p], position[p] + velocity[p] * 0.25]).collect::<Vec<_>>()
                };
                let expected: Vec<_> = (0..count.div_ceil(GROUP_SIZE)).map(|group| Aabb::around(ends(group))).collect();
                assert_eq!(boxes, expected, "{count} at {level:?}");
            }
        }
    }

    #[test]
    fn one_number_that_is_not_finite_is_found_wherever_it_is() {
        let mut rng = Rng::new(8);
        let sound = random(70, &mut rng);
        let level = SimdLevel::best();
        assert!(are_finite::<f32>(level, &sound, &sound, 0.1), "all of them are");
        for place in [0, 17, 69] {
            for bad in [f32::NAN, f32::INFINITY, -f32::INFINITY] {
                let mut broken = sound.clone();
                broken[place].y = bad;
                assert!(!are_finite::<f32>(level, &sound, &broken, 0.1), "{bad} in the path of {place}");
                assert!(!are_finite::<f32>(level, &broken, &sound, 0.1), "{bad} in the place of {place}");
            }
        }
    }
}
