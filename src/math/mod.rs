//! Small numeric vocabulary shared by every layer: the scalar and vector traits the physics is generic over,
//! boxes, rotations, colours, textures as numbers, the frame and a seeded random generator. Knows nothing of bodies or files.

pub mod aabb;
pub mod color;
pub mod frame;
pub mod picture;
pub mod real;
pub mod rigid_motion;
pub mod rng;
pub mod rotation;

pub use aabb::Aabb;
pub use frame::{FRAME, FRAME_SECS, whole_steps};
pub use real::{Real, Vector, components, components_mut};
pub use rigid_motion::RigidMotion;
