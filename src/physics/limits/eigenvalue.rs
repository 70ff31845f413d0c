//! Largest eigenvalues of symmetric 3×3 matrices, and the largest multiple of one matrix that may be added to another below
//! a limit.

use glam::{DMat3, DVec3};

/// Steps of a bisection: enough for any range of values to a millionth.
const BISECTION_STEPS: usize = 60;

/// Returns a symmetric matrix less the mean of its eigenvalues, that mean, and the root of a sixth of the sum of squares of
/// what is left.
pub(super) fn shifted(a: DMat3) -> (DMat3, f64, f64) {
    let mean = (a.x_axis.x + a.y_axis.y + a.z_axis.z) / 3.0;
    let shifted = a - DMat3::from_diagonal(DVec3::splat(mean));
    let spread =
        (shifted.x_axis.length_squared() + shifted.y_axis.length_squared() + shifted.z_axis.length_squared()) / 6.0;
    (shifted, mean, spread.sqrt())
}

/// Returns the largest eigenvalue of a symmetric 3×3 matrix (Smith, "Eigenvalues of a symmetric 3 × 3 matrix", CACM 4(4),
/// 1961).
pub(in crate::physics) fn largest_eigenvalue(a: DMat3) -> f64 {
    let (shifted, mean, p) = shifted(a);
    if p * p <= f64::MIN_POSITIVE {
        return mean;
    }
    let half_determinant = ((shifted * (1.0 / p)).determinant() / 2.0).clamp(-1.0, 1.0);
    mean + 2.0 * p * libm::cos(libm::acos(half_determinant) / 3.0)
}

/// A matrix `to` which a multiple of another, `of`, is added, and the largest eigenvalue of `of` alone.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct Addition {
    pub(in crate::physics) to: DMat3,
    pub(in crate::physics) of: DMat3,
    pub(in crate::physics) alone: f64,
}

/// Returns the largest multiple for which no eigenvalue of any sum is above a limit; zero if one is above it without any
/// addition. An addition that is next to nothing limits no multiple.
pub(in crate::physics) fn largest_multiple(additions: impl Iterator<Item = Addition>, limit: f64) -> f64 {
    let mut multiple = f64::INFINITY;
    for Addition { to, of, alone } in additions {
        let fits = |multiple: f64| is_below(to + of * multiple, limit);
        if alone <= 1e-9 {
            if !fits(0.0) {
                return 0.0;
            }
            continue;
        }
        // Even alone it may add no more than this.
        let high = multiple.min(limit / alone);
        multiple = if fits(high) { high } else { bisect(0.0, high, fits) };
        if multiple <= 0.0 {
            return 0.0;
        }
    }
    multiple
}

/// Whether every eigenvalue of a symmetric matrix is below a limit: the pivots of limit less matrix are positive. This is a
/// tenth of the work of an eigenvalue.
fn is_below(a: DMat3, limit: f64) -> bool {
    let left = DMat3::from_diagonal(DVec3::splat(limit)) - a;
    let [xx, xy, xz] = left.x_axis.to_array();
    let [_, yy, yz] = left.y_axis.to_array();
    if xx <= 0.0 {
        return false;
    }
    let (yy, yz, zz) = (yy - xy * xy / xx, yz - xy * xz / xx, left.z_axis.z - xz * xz / xx);
    yy > 0.0 && zz - yz * yz / yy > 0.0
}

/// Returns the largest allowed value between two values, the lower of which is taken to be allowed.
fn bisect(mut low: f64, mut high: f64, is_allowed: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..BISECTION_STEPS {
        let middle = 0.5 * (low + high);
        if is_allowed(middle) {
            low = middle;
        } else {
            high = middle;
        }
        if high - low <= 1e-9 * high {
            break;
        }
    }
    low
}
