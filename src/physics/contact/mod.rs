//! Contact (GC §5–§7): of particles and points of meshes with obstacles, and of bodies with each other and themselves.
//!
//! ```text
//! broad phase   box of a body's motion against box of an obstacle, then box of a particle's motion
//! narrow phase  does this particle cross the obstacle's surface in this step, on which side, where
//! response      a stiff, critically damped spring taken implicitly, then Coulomb friction (response)
//! ```
//!
//! Files, by what they are about:
//!
//! ```text
//! particles   candidates: all that are near obstacles; candidate: what one of them meets; response: the law; between,
//!             gauss_seidel: several obstacles at one particle; account: the energy of all that
//! search      near: whether a body comes near at all; broad, near_particles, distance_cache: what is far; narrow, swept_point,
//!             surface: where a path meets a shape
//! schemes     constraint, solved: contact within the equations of the implicit scheme, of points by weighted::equations;
//!             held: through the stages of the stabilised scheme; thesis: the thesis's own rule
//! obstacles   placed, moving, sweep: where obstacles are on their way; arrive, approach, way_out: those put into a body
//! points      weighted: contacts of points that several particles carry; samples: points of a mesh that meet obstacles,
//!             and edges of obstacles that meet cells; bodies: bodies that meet each other and themselves
//! results     record, sides, workspace
//! ```
//!
//! A body that is a model may meet obstacles with points of its mesh in place of its particles, and every body meets with its
//! cells what would pass between these points: see [`samples`].
//!
//! Several obstacles at one particle are solved for together (`gauss_seidel`), and leave it a velocity that none of them
//! forbids. Bodies meet each other before that: see [`bodies`]. The implicit scheme solves for all of these at once.

mod account;
mod approach;
pub(super) mod arrive;
mod between;
pub(super) mod bodies;
mod broad;
mod candidate;
mod candidates;
mod constraint;
mod distance_cache;
mod gauss_seidel;
mod held;
mod moving;
mod narrow;
pub(super) mod near;
mod near_particles;
pub(super) mod placed;
mod record;
mod response;
pub(super) mod samples;
mod sides;
mod solved;
mod surface;
pub(super) mod sweep;
mod swept_point;
pub(super) mod thesis;
mod way_out;
pub(super) mod weighted;
mod workspace;

pub(super) use bodies::BYTES_A_POINT;
pub use bodies::BodyContact;
pub(super) use candidates::{meet_obstacles, meet_on_paths};
pub(super) use constraint::{ContactConstraint, DepthLimit, ParticleConstraint};
pub(super) use held::limit_depths;
pub(super) use narrow::mesh::NearestPointCache;
pub use placed::Placed;
pub use record::ContactRecord;
pub use samples::SampleContact;
pub(super) use sides::{contact_side, remember_sides};
pub(super) use solved::{find_constraints, finish_constraints};
pub(super) use surface::Surface;
pub(super) use swept_point::SweptPoint;
pub(super) use weighted::{
    BYTES_A_CONTACT, MIN_MOBILITY, PARTING_SPEED_SHARE, STIFFNESS_OVER_MASS, Touching, WeightedConstraint,
    WeightedConstraints, coulomb_impulse, pressed_at_end,
};
pub use weighted::{DEPTH_SHARE, WeightedParticles};
pub(super) use workspace::{BYTES_A_PARTICLE_AND_MESH, ContactWorkspace, Contacts, SURFACE_PARTICLES_A_CONTACT};
