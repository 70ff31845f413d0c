//! Contact of particles with obstacles (GC §5–§7).
//!
//! ```text
//! broad phase   box of a body's motion against box of an obstacle, then box of a particle's motion
//! narrow phase  does this particle cross the obstacle's surface in this step, on which side, where (plane, sphere)
//! response      a stiff, critically damped spring taken implicitly, then Coulomb friction (response)
//! ```
//!
//! Particles do not meet each other. What several obstacles do to one particle is found together (settle), and it is
//! brought to a velocity that none of them forbids.

mod account;
mod approach;
pub(super) mod arrive;
mod between;
mod broad;
mod meeting;
mod narrow;
pub(super) mod placed;
mod record;
mod response;
mod scratch;
mod settle;
mod sides;
mod solved;
mod surface;
pub(super) mod sweep;
pub(super) mod thesis;
mod touch;
mod way_out;

pub(super) use meeting::{respond, respond_to_paths};
pub use placed::Placed;
pub use record::ContactRecord;
pub(super) use scratch::Scratch;
pub(super) use sides::remember_sides;
pub(super) use solved::{find as find_touches, settle as settle_touches};
pub(super) use touch::Touch;
