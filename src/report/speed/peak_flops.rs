//! The most that one thread of the machine can do at a level of vector instructions, with multiplications and additions
//! only.

#![expect(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest level alone")]

use std::hint::black_box;

use crate::physics::SimdLevel;

/// Numbers in the widest vector.
const LANES: usize = 16;

/// Vectors that do not wait for each other: enough to hide the latency of a multiplication with addition, two of which begin
/// at a time, and fewer than there are registers.
const CHAINS: usize = 12;

/// Operations in a round.
pub(super) const FLOPS_A_ROUND: u64 = (2 * LANES * CHAINS) as u64;

/// Does `rounds` rounds in single precision, fused where the level can. The result has no meaning.
pub(super) fn multiply_adds(level: SimdLevel, rounds: u64) -> f32 {
    let fuses = level != SimdLevel::Portable;
    level.run(
        #[inline(always)]
        || if fuses { chains::<true>(rounds) } else { chains::<false>(rounds) },
    )
}

#[inline(always)]
fn chains<const FUSES: bool>(rounds: u64) -> f32 {
    let [factor, summand] = black_box([0.999_f32, 0.001]);
    let mut chains = [[1.0_f32; LANES]; CHAINS];
    for _ in 0..rounds {
        for lane in chains.as_flattened_mut() {
            *lane = if FUSES { lane.mul_add(factor, summand) } else { *lane * factor + summand };
        }
    }
    chains.as_flattened().iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_level_does_all_of_the_rounds() {
        for level in SimdLevel::ALL {
            // The value one is mapped to one.
            let sum = multiply_adds(level, 3);
            assert!((sum - (LANES * CHAINS) as f32).abs() < 1e-3, "{}: {sum}", level.name());
        }
    }
}
