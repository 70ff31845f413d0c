//! From a scene and a simulation to a draw list: which surface follows which particles, where obstacles are, how the
//! scene is looked at. Knows both sides and neither a window nor a graphics library.

pub mod guilty;
pub mod model_picture;
pub mod overlay;
pub mod own_box;
pub mod scalars;
pub mod skin;
pub mod solid;
pub mod solid_mesh;
pub mod view;
