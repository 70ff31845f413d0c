//! From a scene and a simulation to a draw list: the surface that follows the particles, the places of obstacles, the view
//! of the scene. Knows both sides, but neither a window nor a graphics library.

pub mod guilty;
pub mod model_picture;
pub mod overlay;
pub mod own_box;
pub mod scalars;
pub mod skin;
pub mod solid;
pub mod solid_mesh;
pub mod view;
