//! Contacts of points that are weighted means of particles, and what they do together: a particle of one body in a cell of
//! another ([`super::bodies`]), a point of a body's mesh at an obstacle ([`super::samples`]).
//!
//! ```text
//! movers      the particles that contacts may change, and which contact weighs which how much
//! law         how hard a contact pushes and rubs
//! constraint  one contact, with one effective mass
//! solve       all of them together, in a fixed order
//! ```

mod constraint;
mod law;
mod movers;
mod solve;

pub(super) use constraint::{PointConstraint, SpringBefore, Where};
pub use law::DEPTH_SHARE;
pub(in crate::physics) use law::{GENTLE_SHARE, PointLaw, STIFFNESS_OVER_MASS};
pub(super) use movers::{Mover, Movers};
pub(super) use solve::solve;
