//! Contacts of points that are weighted means of particles, or belong to a modal body, solved together: a particle of one body
//! in a cell of another ([`super::bodies`]), a point of a body's mesh at an obstacle ([`super::samples`]).
//!
//! ```text
//! particles   what carries a point: a few particles with weights
//! movers      the particles that contacts may change, and their weights in each contact
//! modal       the same for modal bodies, which move as a whole
//! law         how hard a contact pushes and rubs
//! constraint  one contact, with one effective mass
//! equations   the same among the equations of the implicit integrator
//! solve       all of them together, in a fixed order
//! ```

mod constraint;
mod equations;
mod law;
mod modal;
mod movers;
mod particles;
mod solve;

pub(in crate::physics) use constraint::pressed_at_end;
pub(super) use constraint::{ContactPlane, PartingPush, PointConstraint, SpringBefore};
pub(in crate::physics) use equations::{BYTES_A_CONTACT, Touching, WeightedConstraint, WeightedConstraints};
pub use law::DEPTH_SHARE;
pub(in crate::physics) use law::{MIN_MOBILITY, PARTING_SPEED_SHARE, PointLaw, STIFFNESS_OVER_MASS, coulomb_impulse};
pub(in crate::physics) use modal::ModalBodies;
pub(super) use movers::{Mover, Movers, Shares};
pub use particles::WeightedParticles;
pub(super) use solve::solve;
