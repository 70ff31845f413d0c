//! The loops over the vectors of a solve. They go over components as these lie in memory; sums are of eight parts in a fixed
//! order, the same at every level of vector instructions.

use glam::DVec3;

use crate::math::{components, components_mut};
use crate::physics::kernels::SimdLevel;

/// Partial sums of a sum.
const PARTIAL_SUMS: usize = 8;

/// Returns the inner product.
pub(super) fn dot(level: SimdLevel, a: &[DVec3], b: &[DVec3]) -> f64 {
    level.run(
        #[inline(always)]
        || {
            let (a, a_rest) = components::<f64>(a).as_chunks::<PARTIAL_SUMS>();
            let (b, b_rest) = components::<f64>(b).as_chunks::<PARTIAL_SUMS>();
            let mut sums = [0.0; PARTIAL_SUMS];
            for (a, b) in a.iter().zip(b) {
                add_products(a, b, &mut sums);
            }
            add_products(a_rest, b_rest, &mut sums);
            sum_of(&sums)
        },
    )
}

/// `scaled = residual × inverse`, component by component. Returns the inner product of `residual` and `scaled`.
pub(super) fn scale(level: SimdLevel, residual: &[DVec3], inverse: &[DVec3], scaled: &mut [DVec3]) -> f64 {
    level.run(
        #[inline(always)]
        || {
            let components = components::<f64>(residual).iter().zip(components::<f64>(inverse));
            for (scaled, (residual, inverse)) in components_mut::<f64>(scaled).iter_mut().zip(components) {
                *scaled = residual * inverse;
            }
        },
    );
    dot(level, residual, scaled)
}

/// `to += factor × by`.
pub(super) fn add_scaled(level: SimdLevel, factor: f64, by: &[DVec3], to: &mut [DVec3]) {
    level.run(
        #[inline(always)]
        || {
            for (to, by) in components_mut::<f64>(to).iter_mut().zip(components::<f64>(by)) {
                *to += by * factor;
            }
        },
    );
}

/// `to = by + factor × to`.
pub(super) fn scale_and_add(level: SimdLevel, factor: f64, by: &[DVec3], to: &mut [DVec3]) {
    level.run(
        #[inline(always)]
        || {
            for (to, by) in components_mut::<f64>(to).iter_mut().zip(components::<f64>(by)) {
                *to = by + *to * factor;
            }
        },
    );
}

#[inline(always)]
fn add_products(a: &[f64], b: &[f64], sums: &mut [f64; PARTIAL_SUMS]) {
    for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
        *sum += a * b;
    }
}

fn sum_of([a, b, c, d, e, f, g, h]: &[f64; PARTIAL_SUMS]) -> f64 {
    ((a + b) + (c + d)) + ((e + f) + (g + h))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;

    #[test]
    fn an_inner_product_is_that_of_the_vectors_one_by_one_and_the_same_at_every_level() {
        let mut rng = Rng::new(5);
        for count in [0_u16, 1, 2, 3, 8, 100, 1001] {
            let [a, b] = [0; 2].map(|_| {
                let vector = |_| DVec3::from([0; 3].map(|_| rng.between(-1.0, 1.0)));
                (0..count).map(vector).collect::<Vec<_>>()
            });
            let plain: f64 = a.iter().zip(&b).map(|(a, b)| a.dot(*b)).sum();
            let found = dot(SimdLevel::Portable, &a, &b);
            assert!((found - plain).abs() < 1e-12 * (1.0 + f64::from(count)), "{found}, not {plain}");
            for level in SimdLevel::ALL {
                let bits = dot(level, &a, &b).to_bits();
                assert_eq!(bits, found.to_bits(), "{count} at {level:?}");
            }
        }
    }
}
