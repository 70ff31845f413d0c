//! How much of a step's limit one family of links may take up while the others stay as they are, over all plane waves of a
//! lattice.

use std::sync::OnceLock;

use crate::geometry::Family;
use crate::physics::limits::eigenvalue::{Addition, largest_eigenvalue, largest_multiple};
use crate::physics::limits::{WaveTensors, lattice_waves};

/// The waves of a lattice, each with the largest eigenvalue of every family alone.
pub(super) struct Waves {
    pub(super) tensors: Vec<WaveTensors>,
    alone: Vec<[f64; 3]>,
}

/// The waves, which are the same for every lattice.
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
    let sum = |tensors: &WaveTensors, of: [f64; 3]| tensors[0] * of[0] + tensors[1] * of[1] + tensors[2] * of[2];
    let rest = rest.map(|load| load.max(0.0));
    let additions = waves.tensors.iter().zip(&waves.alone).map(|(tensors, alone)| Addition {
        to: sum(tensors, rest),
        of: tensors[family as usize],
        alone: alone[family as usize],
    });
    largest_multiple(additions, limit)
}
