//! The loops over particles that advance them.
//!
//! All components of a vector are treated alike, so these loops go over components as they lie in memory, without branches
//! and in no particular order.

use crate::math::{Real, components, components_mut};
use crate::physics::kernels::SimdLevel;

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
