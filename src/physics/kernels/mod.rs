//! The forces of links, many at a time: the law of [`crate::physics::forces::links`], evaluated over the grid that a body
//! was cut from.
//!
//! # Theory
//!
//! Every link of a lattice leads from a particle to one of 16 higher neighbours: 13 corners of the cells around it, and the
//! next but one along each axis. In a dense box of grid corners, numbered `x + nx (y + ny z)`, each of these 16 directions
//! is a constant distance between corner numbers. So the links of one direction need no list: one bit a corner says whether
//! a link starts there, and their constants are one law, or one value a corner where the material differs.
//!
//! ```text
//!   block of 64 corners    i ──────────────────►        positions, velocities and forces each as
//!   its ends               i + offset ─────────────►    x x x x …   y y y y …   z z z z …
//!   mask                   1 1 0 1 1 …                  bit of the direction
//! ```
//!
//! The loop over a block has no branch and reads contiguous memory, so compilers vectorise it as wide as the machine allows.
//! It is written once, in safe code, and compiled for every level ([`SimdLevel`]). It adds, multiplies, divides and takes
//! square roots as IEEE 754 says, without fused operations, and the order of the sums depends on blocks and directions
//! alone. So every level gives the same bits.
//!
//! # Practice
//!
//! [`Layout`] follows from the lattice alone and is shared between compilations; [`BoxedLinks`] adds the constants of the
//! links; both are constant. A [`Piece`] is the workspace of a sweep, one for each thread that has a part of the body, with
//! room only for the window that is being worked on. [`Tangents`] are the derivatives of the forces as a matrix, which the
//! implicit scheme multiplies with. A body has no layout if it fills so little of its box that a walk along the list of its
//! links is cheaper: what counts is the number of places in blocks for each link, which is the same on every machine.

#![expect(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest level alone")]

mod block;
mod bounds;
mod boxed;
mod energy;
mod layout;
mod level;
mod magnitude;
mod motion;
mod piece;
mod room;
mod strain;
mod sweep;
mod tangent;

pub(in crate::physics) use bounds::{GROUP_SIZE, are_finite, bounds, displacement_bounds, motion_bounds};
pub(in crate::physics) use boxed::BoxedLinks;
pub(in crate::physics) use energy::{LinkSum, sum_over_links};
pub(in crate::physics) use layout::{BYTES_PER_CORNER, Layout, MAX_CORNERS_PER_PARTICLE};
pub use level::SimdLevel;
pub(in crate::physics) use magnitude::sum_magnitudes;
pub(in crate::physics) use motion::{
    Predicted, StageSources, StageTerms, advance, kick, kick_each, next_stage, next_stage_each, predict,
};
pub(in crate::physics) use piece::{Piece, pieces};
pub(in crate::physics) use strain::are_strained;
pub(in crate::physics) use sweep::{InitialForce, Pass, add_forces};
pub(in crate::physics) use tangent::{Tangents, tangent_bytes};

#[cfg(test)]
mod oracle_tests;
#[cfg(test)]
mod piece_tests;
