//! The loops over particles that advance them.
//!
//! All components of a vector are treated alike, so these loops go over components as they lie in memory, without branches
//! and in no particular order.

use crate::math::{Aabb, Real, components, components_mut};
use crate::physics::kernels::SimdLevel;
use crate::physics::kernels::bounds::{Extremes, PLACES, are_finite, bounds};

/// `v += factor F`: changes velocities (m/s) by forces (N), with the same factor for all.
pub(in crate::physics) fn kick<R: Real>(level: SimdLevel, factor: R, force: &[R::Vec3], velocity: &mut [R::Vec3]) {
    level.run(
        #[inline(always)]
        || {
            for (velocity, force) in components_mut::<R>(velocity).iter_mut().zip(components::<R>(force)) {
                *velocity += *force * factor;
            }
        },
    );
}

/// `v += dt F/m`: changes velocities (m/s) by forces (N) that act on masses (kg) for `secs`.
pub(in crate::physics) fn kick_each<R: Real>(
    level: SimdLevel,
    secs: R,
    masses: &[R],
    force: &[R::Vec3],
    velocity: &mut [R::Vec3],
) {
    level.run(
        #[inline(always)]
        || {
            for ((velocity, force), mass) in velocity.iter_mut().zip(force).zip(masses) {
                *velocity += *force * (secs / *mass);
            }
        },
    );
}

/// What is known of velocities as soon as they are predicted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::physics) struct Predicted<R: Real> {
    /// The box around them, m/s.
    pub(in crate::physics) bounds: Aabb<R>,
    /// Whether they lead all particles to finite places.
    pub(in crate::physics) is_finite: bool,
}

impl<R: Real> Predicted<R> {
    /// Of no particles.
    pub(in crate::physics) fn nothing() -> Self {
        Self { bounds: Aabb::empty(), is_finite: true }
    }

    /// Of velocities (m/s) with which particles move from `position` (m) for `secs`.
    pub(in crate::physics) fn of(level: SimdLevel, position: &[R::Vec3], velocity: &[R::Vec3], secs: R) -> Self {
        Self { bounds: bounds::<R>(level, velocity), is_finite: are_finite::<R>(level, position, velocity, secs) }
    }

    /// Of the particles of both.
    pub(in crate::physics) fn joined(self, other: Self) -> Self {
        Self { bounds: self.bounds.joined(other.bounds), is_finite: self.is_finite && other.is_finite }
    }
}

/// [`kick`] and [`Predicted::of`] in one loop: `position` (m) and `from` (m/s) are the motion before the kick, and `velocity`
/// receives that after it.
pub(in crate::physics) fn predict<R: Real>(
    level: SimdLevel,
    factor: R,
    secs: R,
    force: &[R::Vec3],
    [position, from]: [&[R::Vec3]; 2],
    velocity: &mut [R::Vec3],
) -> Predicted<R> {
    level.run(
        #[inline(always)]
        || {
            let (mut extremes, mut is_finite) = (Extremes::none(), true);
            let (velocities, velocity_rest) = components_mut::<R>(velocity).as_chunks_mut::<PLACES>();
            let [(forces, force_rest), (positions, position_rest), (starts, start_rest)] =
                [force, position, from].map(|of| components::<R>(of).as_chunks::<PLACES>());
            for (((velocity, from), force), position) in velocities.iter_mut().zip(starts).zip(forces).zip(positions) {
                for place in 0..PLACES {
                    velocity[place] = from[place] + force[place] * factor;
                }
                extremes.include_numbers(velocity);
                for place in 0..PLACES {
                    is_finite &= (position[place] + velocity[place] * secs).is_finite();
                }
            }
            for (place, velocity) in velocity_rest.iter_mut().enumerate() {
                *velocity = start_rest[place] + force_rest[place] * factor;
                is_finite &= (position_rest[place] + *velocity * secs).is_finite();
            }
            extremes.include_numbers(velocity_rest);
            Predicted { bounds: extremes.bounds(), is_finite }
        },
    )
}

/// `x += dt u`: moves positions, m, for `secs` along a path, m/s. What rounding keeps back is carried to the next step
/// (Kahan 1965).
pub(in crate::physics) fn advance<R: Real>(
    level: SimdLevel,
    secs: R,
    path: &[R::Vec3],
    position: &mut [R::Vec3],
    residual: &mut [R::Vec3],
) {
    level.run(
        #[inline(always)]
        || {
            let (position, residual) = (components_mut::<R>(position), components_mut::<R>(residual));
            for ((x, residual), path) in position.iter_mut().zip(residual).zip(components::<R>(path)) {
                let change = *path * secs + *residual;
                let moved = *x + change;
                *residual = change - (moved - *x);
                *x = moved;
            }
        },
    );
}

/// The weights of the next stage of a scheme: of how far the last stage and the one before it have gone from the state, and
/// of the slopes at the last stage and at the first, s.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct StageTerms<R> {
    pub(in crate::physics) last: R,
    pub(in crate::physics) before: R,
    pub(in crate::physics) slope: R,
    pub(in crate::physics) first: R,
}

/// The inputs of a stage, by particle: how far the last stage has gone from the state, the slopes before they are multiplied
/// by their scale, and the state.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct StageSources<'a, R: Real> {
    pub(in crate::physics) last: &'a [R::Vec3],
    pub(in crate::physics) slope: &'a [R::Vec3],
    pub(in crate::physics) first: &'a [R::Vec3],
    pub(in crate::physics) start: &'a [R::Vec3],
}

/// Goes to the next stage. `displacement` holds how far the stage before the last has gone from the state and receives
/// how far the next one has; `at` receives the next stage itself. Slopes are multiplied by `scale`.
pub(in crate::physics) fn next_stage<R: Real>(
    level: SimdLevel,
    terms: StageTerms<R>,
    scale: R,
    sources: StageSources<'_, R>,
    displacement: &mut [R::Vec3],
    at: &mut [R::Vec3],
) {
    let StageSources { last, slope, first, start } = sources;
    let [last, slope, first, start] = [last, slope, first, start].map(components::<R>);
    level.run(
        #[inline(always)]
        || {
            stage_components(
                terms,
                scale,
                [last, slope, first, start],
                components_mut::<R>(displacement),
                components_mut::<R>(at),
            );
        },
    );
}

/// The outputs are separate arguments: a compiler that must ask which of six slices overlap does not vectorise this loop.
#[inline(always)]
fn stage_components<R: Real>(
    terms: StageTerms<R>,
    scale: R,
    [last, slope, first, start]: [&[R]; 4],
    displacement: &mut [R],
    at: &mut [R],
) {
    let count = displacement.len();
    let [last, slope, first, start] = [last, slope, first, start].map(|of| &of[..count]);
    let at = &mut at[..count];
    for i in 0..count {
        let next = last[i] * terms.last
            + displacement[i] * terms.before
            + (slope[i] * scale) * terms.slope
            + (first[i] * scale) * terms.first;
        displacement[i] = next;
        at[i] = start[i] + next;
    }
}

/// [`next_stage`] where each particle's slopes are divided by a mass of its own.
pub(in crate::physics) fn next_stage_each<R: Real>(
    level: SimdLevel,
    terms: StageTerms<R>,
    masses: &[R],
    StageSources { last, slope, first, start }: StageSources<'_, R>,
    displacement: &mut [R::Vec3],
    at: &mut [R::Vec3],
) {
    level.run(
        #[inline(always)]
        || {
            for (i, mass) in masses.iter().enumerate() {
                let scale = R::ONE / *mass;
                displacement[i] = last[i] * terms.last
                    + displacement[i] * terms.before
                    + (slope[i] * scale) * terms.slope
                    + (first[i] * scale) * terms.first;
                at[i] = start[i] + displacement[i];
            }
        },
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;
    use crate::physics::kernels::bounds::tests::random;

    /// The loop as one reads it.
    fn next_stage_one_by_one(
        terms: StageTerms<f32>,
        masses: &[f32],
        sources: StageSources<'_, f32>,
        displacement: &[glam::Vec3],
    ) -> Vec<[glam::Vec3; 2]> {
        let stage = |p: usize| {
            let [slope, first] = [sources.slope[p], sources.first[p]].map(|force| force * (1.0 / masses[p]));
            let way = sources.last[p] * terms.last
                + displacement[p] * terms.before
                + slope * terms.slope
                + first * terms.first;
            [way, sources.start[p] + way]
        };
        (0..masses.len()).map(stage).collect()
    }

    #[test]
    fn stages_are_those_of_one_particle_after_the_other_at_every_level() {
        let mut rng = Rng::new(7);
        let terms = StageTerms { last: 1.7, before: -0.8, slope: 0.3, first: -0.2 };
        for level in SimdLevel::ALL.into_iter().filter(|level| level.is_available()) {
            for count in [0, 1, 5, 16, 67] {
                let [last, slope, first, start, displacement] = [0; 5].map(|_| random(count, &mut rng));
                let sources = StageSources { last: &last, slope: &slope, first: &first, start: &start };
                for is_alike in [true, false] {
                    let mass = |at: usize| if is_alike { 3.0 } else { 1.0 + at as f32 };
                    let masses: Vec<f32> = (0..count).map(mass).collect();
                    let (mut way, mut at) = (displacement.clone(), slope.clone());
                    if is_alike {
                        next_stage(level, terms, 1.0 / 3.0, sources, &mut way, &mut at);
                    } else {
                        next_stage_each(level, terms, &masses, sources, &mut way, &mut at);
                    }
                    let stages: Vec<_> = way.into_iter().zip(at).map(|(way, at)| [way, at]).collect();
                    let oracle = next_stage_one_by_one(terms, &masses, sources, &displacement);
                    assert_eq!(stages, oracle, "{count} at {level:?}");
                }
            }
        }
    }

    #[test]
    fn a_prediction_is_a_kick_whose_velocities_are_looked_at() {
        let mut rng = Rng::new(11);
        for level in SimdLevel::ALL.into_iter().filter(|level| level.is_available()) {
            for count in [0, 1, 5, 15, 16, 17, 67] {
                for bad in [None, Some(f32::NAN), Some(f32::INFINITY)] {
                    let [position, from, mut force] = [0; 3].map(|_| random(count, &mut rng));
                    if let (Some(bad), Some(force)) = (bad, force.last_mut()) {
                        force.y = bad;
                    }
                    let (mut kicked, mut velocity) = (from.clone(), vec![glam::Vec3::NAN; count]);
                    kick::<f32>(level, 0.7, &force, &mut kicked);
                    let predicted = predict::<f32>(level, 0.7, 0.3, &force, [&position, &from], &mut velocity);
                    let bits =
                        |of: &[glam::Vec3]| of.iter().map(|v| v.to_array().map(f32::to_bits)).collect::<Vec<_>>();
                    assert_eq!(bits(&velocity), bits(&kicked), "{count} at {level:?}");
                    assert_eq!(predicted, Predicted::of(level, &position, &kicked, 0.3), "{count} at {level:?}");
                    assert_eq!(predicted.is_finite, bad.is_none() || count == 0, "{bad:?} among {count} at {level:?}");
                }
            }
        }
    }

    #[test]
    fn particles_move_as_one_by_one_at_every_level() {
        let mut rng = Rng::new(9);
        for level in SimdLevel::ALL.into_iter().filter(|level| level.is_available()) {
            for count in [0, 1, 5, 16, 67] {
                let [start, start_residual, path, force] = [0; 4].map(|_| random(count, &mut rng));
                let masses: Vec<f32> = (0..count).map(|at| 1.0 + at as f32).collect();
                let (mut position, mut residual) = (start.clone(), start_residual.clone());
                advance::<f32>(level, 0.3, &path, &mut position, &mut residual);
                let (mut alike, mut each) = (path.clone(), path.clone());
                kick::<f32>(level, 0.7, &force, &mut alike);
                kick_each::<f32>(level, 0.3, &masses, &force, &mut each);
                for p in 0..count {
                    let change = path[p] * 0.3 + start_residual[p];
                    assert_eq!(position[p], start[p] + change, "{p} of {count} at {level:?}");
                    assert_eq!(residual[p], change - (position[p] - start[p]), "{p} of {count} at {level:?}");
                    assert_eq!(alike[p], path[p] + force[p] * 0.7, "{p} of {count} at {level:?}");
                    assert_eq!(each[p], path[p] + force[p] * (0.3 / masses[p]), "{p} of {count} at {level:?}");
                }
            }
        }
    }
}
