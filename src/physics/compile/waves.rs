//! How much of a step's limit one family of links may take up while the others stay as they are, over all plane waves of a
//! lattice.

use std::sync::OnceLock;

use glam::DMat3;

use crate::geometry::Family;
use crate::physics::limits::{WaveTensors, largest_eigenvalue, lattice_waves};

/// Steps of a bisection: enough for any range of values to a millionth.
const HALVINGS: usize = 60;

/// The waves of a lattice, each with the largest eigenvalue of every family alone.
pub(super) struct Waves {
    pub(super) tensors: Vec<WaveTensors>,
    alone: Vec<[f64; 3]>,
}

/// They are the same for every lattice.
pub(super) fn waves() -> &'static Waves {
    static WAVES: OnceLock<Waves> = OnceLock::new();
    WAVES.get_or_init(|| {
        let tensors = lattice_waves();
        let alone = tensors.iter().map(|tensors| tensors.map(largest_eigenvalue)).collect();
        Waves { tensors, alone }
    })
}

/// How much one family may add to the loads of the others on every wave, up to a limit. A family that is zero for some
/// wave is not limited by it.
pub(super) fn largest_share(waves: &Waves, rest: [f64; 3], family: Family, limit: f64) -> f64 {
    let mut share = f64::INFINITY;
    let fits = |tensors: &WaveTensors, share: f64| {
        let mut constants = rest.map(|load| load.max(0.0));
        constants[family as usize] += share;
        is_below(tensors[0] * constants[0] + tensors[1] * constants[1] + tensors[2] * constants[2], limit)
    };
    for (tensors, alone) in waves.tensors.iter().zip(&waves.alone) {
        let own = alone[family as usize];
        if own <= 1e-9 {
            if !fits(tensors, 0.0) {
                return 0.0;
            }
            continue;
        }
        // Alone it may not add more than this.
        let high = share.min(limit / own);
        share = if fits(tensors, high) { high } else { bisect(0.0, high, |share| fits(tensors, share)) };
        if share <= 0.0 {
            return 0.0;
        }
    }
    share
}

/// Whether every eigenvalue of a symmetric matrix is below a limit: the pivots of what is left are positive. A tenth of
/// the work of an eigenvalue.
fn is_below(a: DMat3, limit: f64) -> bool {
    let left = DMat3::from_diagonal(glam::DVec3::splat(limit)) - a;
    let [xx, xy, xz] = left.x_axis.to_array();
    let [_, yy, yz] = left.y_axis.to_array();
    if xx <= 0.0 {
        return false;
    }
    let (yy, yz, zz) = (yy - xy * xy / xx, yz - xy * xz / xx, left.z_axis.z - xz * xz / xx);
    yy > 0.0 && zz - yz * yz / yy > 0.0
}

/// The end of what is allowed between two values, the lower of which is taken to be.
fn bisect(mut low: f64, mut high: f64, is_allowed: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..HALVINGS {
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
