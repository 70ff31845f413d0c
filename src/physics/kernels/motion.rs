//! The loops over particles that advance them.
//!
//! What happens to a vector happens to each of its components alike, so these loops go over components as they lie in
//! memory, and have neither a branch nor an order.

use crate::math::{Real, components, components_mut};
use crate::physics::kernels::SimdLevel;

/// `v += factor F`: velocities (m/s) after forces (N), all of which count alike.
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

/// `v += dt F/m`: velocities (m/s) after forces (N) that act on masses (kg) for `secs`.
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

/// `x += dt u`, with what rounding keeps back carried to the next step (Kahan 1965): positions, m, after `secs` along a path,
/// m/s.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;
    use crate::physics::kernels::bounds::tests::random;

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
