//! A fingerprint of a state: equal bits, equal hash.

use crate::math::{Real, Vector};
use crate::physics::state::{RigidState, State};

/// FNV-1a over the bits of all positions, all velocities, the distances left of approaches and times left of sweeps, the
/// contact springs between bodies and those of points that touch obstacles, the amplitudes and rates of modes, and the rigid
/// motions of free bodies (Fowler, Noll and Vo; 64 bits, eight bytes at a time).
pub(crate) fn state_hash<R: Real>(state: &State<R>) -> u64 {
    const OFFSET: u64 = 0xcbf2_9ce4_8422_2325;
    const PRIME: u64 = 0x0000_0100_0000_01b3;
    state
        .position
        .iter()
        .chain(&state.velocity)
        .flat_map(|v| v.components())
        .flat_map(|x| x.bits().to_le_bytes())
        .chain(state.approaches.iter().flat_map(|approach| approach.left_m.to_bits().to_le_bytes()))
        .chain(state.sweeps.iter().flat_map(|sweep| sweep.left_secs.to_bits().to_le_bytes()))
        .chain(state.presses.iter().flat_map(|press| press.depth_m.to_bits().to_le_bytes()))
        .chain(state.touches.iter().flat_map(|touch| touch.depth_m.to_bits().to_le_bytes()))
        .chain(
            state
                .modal
                .iter()
                .flat_map(|modal| modal.amplitude.iter().chain(&modal.rate).chain(&modal.mean_rate))
                .flat_map(|x| x.to_bits().to_le_bytes()),
        )
        .chain(
            (state.modal.iter().filter_map(|modal| modal.rigid.as_ref()))
                .flat_map(RigidState::numbers)
                .flat_map(|x| x.to_bits().to_le_bytes()),
        )
        .fold(OFFSET, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(PRIME))
}
