//! A simulation's state as bytes, exactly: what the window and `gelatin run --save-state` write and go on from.
//!
//! ```text
//! "gelatin-state 16\n"                                      magic and version; versions 11 to 15 are read as far as they go
//! {"scene": …, "bodies": […], "planes": …}\n                the scene that it belongs to: one line of JSON
//! particles, planes, steps, substep, time bits              five u64
//! bits of the velocity's lag, accelerations                 two u64
//! unused, part of the substep, its halvings, its work       four u64
//! position, residual, velocity: 3 × particles × 3 f32
//! acceleration: accelerations × 3 f32                       as many as particles, or none
//! sides: planes × particles i8
//! bodies: each a count u64 and as many cells u32             cells that may invert
//!         1 if asleep + 2 if largely strained + 4 if stuck + 8 if gone
//!         + 16 if near itself + 32 if it is a modal body + 64 if taut
//!         + 128 if what its links add is known, ns slow in a knot,
//!         substeps it has been calm after strain                           three u32
//!         where that is known: what they add to the square of a frequency,
//!         to a rate of damping                                             two f64
//!         J that recovery took of its energy, the share of the pull,
//!         cells that it may still move until folds are looked for         three f64
//!         substeps it has been still                                       u64
//!         where still: its particles × 3 f32                 where they were when they came to be still
//! obstacles on their way: a count u64, and of each
//!         its body, its place, 1 if it waits               three u64
//!         direction, length left, speed                    five f64
//! obstacles that sweep: a count u64, and of each
//!         its place                                        one u64
//!         middle, turn as a quaternion, time left          eight f64
//! springs between bodies: a count u64, and of each
//!         the particle, or 2^63 + the point of its body's
//!         mesh, its body, the body it is in                three u64
//!         how far it is pressed                            one f64
//! points of meshes and of free modal bodies that touch obstacles: a count u64, and of each
//!         its body, its number, the obstacle, its side + 1        four u64
//!         how far its spring is pressed                    one f64
//! modal bodies: a count u64, and of each
//!         its body, how many modes                         two u64
//!         how far they are from rest, how fast they go,
//!         how fast they went in the last substep           3 × modes f64
//!         1 if nothing holds it                            one u64
//!         if so, its centre of mass, its turn as a
//!         quaternion, velocity, angular momentum, mean
//!         velocity and spin of the last substep            19 f64
//! FNV-1a of everything before, u64                          all numbers little-endian
//! ```

use std::path::Path;

use glam::Vec3;
use serde_json::json;

use super::state_error::{
    MAGIC, MESH_POINT_FLAG, ON_CELLS, StateError, StateFileError, WITHOUT_FREE_MODES, WITHOUT_LOADS, WITHOUT_MODES,
    WITHOUT_TOUCHES,
};
use super::state_origin::Origin;
use super::state_reader::{FormatFeatures, Reader};
use super::{Session, SessionError};
use crate::disk::{self, fnv1a};
use crate::physics::Approach;
use crate::physics::BodyMemory;
use crate::physics::LinkLoad;
use crate::physics::RigidState;
use crate::physics::SampleTouch;
use crate::physics::Sweep;
use crate::physics::{BodyPoint, Press};
use crate::physics::{RecoveryAccount, Strain};
use crate::text::echo;

/// A larger file is no state: it would hold more particles than a body may have.
const MAX_BYTES: u64 = 4 << 30;

/// The summary of a saved state.
#[derive(Clone, Debug, PartialEq)]
pub struct StateSummary {
    /// The title of the scene that it was saved from.
    pub scene: String,
    /// The time in it, s.
    pub time_secs: f64,
}

/// Reads the summary of a state on the disk; the other numbers are not checked.
pub fn summary(path: &Path) -> Result<StateSummary, StateError> {
    let bytes = disk::read(path, MAX_BYTES)?;
    let (origin, mut reader) = opened(&bytes)?;
    Ok(StateSummary { scene: echo(origin.scene()), time_secs: reader.counts()?.time_secs })
}

/// Checks the version and the checksum of a state. Returns the scene that it belongs to, and a reader of its numbers.
fn opened(bytes: &[u8]) -> Result<(Origin, Reader<'_>), StateFileError> {
    let versions = [MAGIC, ON_CELLS, WITHOUT_LOADS, WITHOUT_FREE_MODES, WITHOUT_MODES, WITHOUT_TOUCHES];
    let known = versions.map(|magic| bytes.strip_prefix(magic.as_bytes()));
    let is_from = |version: usize| known[..=version].iter().any(Option::is_some);
    let features =
        FormatFeatures { meshes_meet: is_from(0), free_modes: is_from(2), modes: is_from(3), touches: is_from(4) };
    let Some(contents) = known.into_iter().flatten().next() else {
        let line = bytes.split(|&b| b == b'\n').next().unwrap_or_default();
        return Err(match line.strip_prefix(b"gelatin-state ") {
            Some(version) if version.len() < 8 => {
                StateFileError::OtherVersion { begins: String::from_utf8_lossy(line).into_owned() }
            }
            _ => StateFileError::NotAState,
        });
    };
    let (body, checksum) = bytes.split_last_chunk::<8>().ok_or(StateFileError::Damaged)?;
    let line_end = contents.iter().position(|&byte| byte == b'\n').ok_or(StateFileError::Damaged)?;
    let (line, numbers) = contents.split_at(line_end + 1);
    if numbers.len() < 8 || fnv1a(body) != u64::from_le_bytes(*checksum) {
        return Err(StateFileError::Damaged);
    }
    let origin = serde_json::from_slice(line).map_err(|_not_ours| StateFileError::Damaged)?;
    Ok((origin, Reader::new(&numbers[..numbers.len() - 8], features)))
}

impl Session {
    /// Writes the present state to a file.
    pub(super) fn save_state(&self, path: &Path) -> Result<(), SessionError> {
        let written = disk::write(path, &self.state_bytes());
        written.map_err(|error| SessionError::State { file: path.to_owned(), source: StateError::Write(error) })?;
        disk::remove_left_behind(path);
        Ok(())
    }

    /// Goes on from a state in a file, once time runs again.
    pub(super) fn open_state(&mut self, path: &Path) -> Result<(), SessionError> {
        let read = disk::read(path, MAX_BYTES).map_err(StateError::from);
        let taken = read.and_then(|bytes| Ok(self.set_state_bytes(&bytes)?));
        taken.map_err(|source| SessionError::State { file: path.to_owned(), source })?;
        self.playing = false;
        self.trouble = None;
        self.clock.reset();
        self.find_inversion();
        Ok(())
    }

    /// The present state as bytes.
    pub fn state_bytes(&self) -> Vec<u8> {
        let state = self.simulation().state();
        let mut bytes = MAGIC.as_bytes().to_vec();
        let origin = json!(Origin::of(self.title(), &self.scene, self.simulation())).to_string();
        bytes.extend(origin.bytes().chain([b'\n']));
        let counts = [
            state.position.len() as u64,
            state.side.len() as u64,
            state.steps,
            u64::from(state.substep),
            state.time_secs.to_bits(),
            state.velocity_lag_secs.to_bits(),
            state.acceleration.as_ref().map_or(0, Vec::len) as u64,
            0,
            state.part,
            u64::from(state.halvings),
            state.work,
        ];
        bytes.extend(counts.iter().flat_map(|count| count.to_le_bytes()));
        let vectors = [&state.position, &state.position_residual, &state.velocity];
        for vectors in vectors.into_iter().chain(&state.acceleration) {
            bytes.extend(vectors.iter().flat_map(Vec3::to_array).flat_map(f32::to_le_bytes));
        }
        bytes.extend(state.side.iter().flatten().flat_map(|side| side.to_le_bytes()));
        for (memory, body) in state.bodies.iter().zip(&self.simulation().model().bodies) {
            bytes.extend((memory.near_inversion.len() as u64).to_le_bytes());
            bytes.extend(memory.near_inversion.iter().flat_map(|cell| cell.to_le_bytes()));
            let BodyMemory { asleep, strain, load, stuck, gone, near_itself, is_modal, .. } = *memory;
            let loads = [load.stiffness, load.damping];
            let is_known = load != LinkLoad::default();
            let [large, taut] = [Strain::Large, Strain::Taut].map(|of| strain == of);
            let flags = [asleep, large, stuck, gone, near_itself, is_modal, taut, is_known].map(u32::from);
            let flags = flags.iter().rev().fold(0, |all, flag| 2 * all + flag);
            let words = [flags, memory.knotted_nanos, memory.calm_substeps];
            bytes.extend(words.iter().flat_map(|word| word.to_le_bytes()));
            bytes.extend(loads.iter().filter(|_| is_known).flat_map(|number| number.to_le_bytes()));
            let RecoveryAccount { taken_j, pull_share } = memory.account;
            bytes.extend([taken_j, pull_share, memory.apart].iter().flat_map(|number| number.to_le_bytes()));
            bytes.extend(memory.still_substeps.to_le_bytes());
            if memory.still_substeps > 0 {
                let anchor = &state.anchor[body.particles.clone()];
                bytes.extend(anchor.iter().flat_map(Vec3::to_array).flat_map(f32::to_le_bytes));
            }
        }
        bytes.extend((state.approaches.len() as u64).to_le_bytes());
        for approach in &state.approaches {
            let Approach { body, obstacle, way, left_m, speed, waits } = *approach;
            bytes.extend([body as u64, obstacle as u64, u64::from(waits)].iter().flat_map(|word| word.to_le_bytes()));
            bytes.extend([way.x, way.y, way.z, left_m, speed].iter().flat_map(|number| number.to_le_bytes()));
        }
        bytes.extend((state.sweeps.len() as u64).to_le_bytes());
        for Sweep { obstacle, center, rotation, left_secs } in &state.sweeps {
            bytes.extend((*obstacle as u64).to_le_bytes());
            let numbers = center.to_array().into_iter().chain(rotation.to_array()).chain([*left_secs]);
            bytes.extend(numbers.flat_map(f64::to_le_bytes));
        }
        bytes.extend((state.presses.len() as u64).to_le_bytes());
        for Press { bodies: [own, other], point, depth_m } in &state.presses {
            let point = match *point {
                BodyPoint::Particle(particle) => particle as u64,
                BodyPoint::OfMesh(number) => number as u64 | MESH_POINT_FLAG,
            };
            bytes.extend([point, *own as u64, *other as u64].iter().flat_map(|word| word.to_le_bytes()));
            bytes.extend(depth_m.to_le_bytes());
        }
        bytes.extend((state.touches.len() as u64).to_le_bytes());
        for &SampleTouch { body, sample, obstacle, side, depth_m } in &state.touches {
            let side = u64::from((side + 1).unsigned_abs());
            bytes
                .extend([body as u64, sample as u64, obstacle as u64, side].iter().flat_map(|word| word.to_le_bytes()));
            bytes.extend(depth_m.to_le_bytes());
        }
        let modal = || state.modal.iter().enumerate().filter(|(_, modal)| !modal.amplitude.is_empty());
        bytes.extend((modal().count() as u64).to_le_bytes());
        for (body, modal) in modal() {
            bytes.extend([body as u64, modal.amplitude.len() as u64].iter().flat_map(|word| word.to_le_bytes()));
            bytes.extend(
                modal
                    .amplitude
                    .iter()
                    .chain(&modal.rate)
                    .chain(&modal.mean_rate)
                    .flat_map(|number| number.to_le_bytes()),
            );
            bytes.extend(u64::from(modal.rigid.is_some()).to_le_bytes());
            bytes.extend(modal.rigid.iter().flat_map(RigidState::numbers).flat_map(f64::to_le_bytes));
        }
        let checksum = fnv1a(&bytes);
        bytes.extend(checksum.to_le_bytes());
        bytes
    }

    /// Goes on from a state that [`Session::state_bytes`] gave for the same scene.
    pub fn set_state_bytes(&mut self, bytes: &[u8]) -> Result<(), StateFileError> {
        let (origin, reader) = opened(bytes)?;
        if let Some(difference) = origin.difference(&Origin::of(self.title(), &self.scene, self.simulation())) {
            return Err(StateFileError::OtherScene { scene: echo(origin.scene()), difference });
        }
        let state = reader.state(self.simulation())?;
        // Numbers that are each finite may together be too large to work with.
        let mut tried = self.simulation().clone();
        tried.set_state(state.clone());
        if !tried.diagnostics().finite {
            return Err(StateFileError::Value {
                field: "the energy".to_owned(),
                value: "too large for a number".to_owned(),
                needed: "a motion that can go on".to_owned(),
            });
        }
        self.replace_state(state);
        Ok(())
    }
}
