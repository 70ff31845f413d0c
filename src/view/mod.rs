//! The abstract picture: what is to be drawn and from where, with no graphics library and no physics.
//!
//! A [`DrawList`] is plain data that any thread may build and any renderer may consume. Distances are metres,
//! right-handed, y up; colours are linear red, green, blue unless a name says sRGB.

pub mod axes;
pub mod camera;
mod clusters;
pub mod colormap;
pub mod difference;
pub mod draw_list;
mod extent;
pub mod framing;
pub mod gizmo;
pub mod image;
pub mod legend;
pub mod orbit;
pub mod overlay;
pub mod pick;
pub mod ray;
pub mod skin;
pub mod skin_textures;
pub mod skin_vertex;
pub mod solid;
mod solid_mesh;
pub mod style;

pub use camera::Camera;
pub use colormap::Colormap;
pub use difference::Change;
pub use draw_list::{DrawList, Light, Selected, SkinInstance};
pub use framing::SafeArea;
pub use gizmo::Gizmo;
pub use image::Image;
pub use legend::Legend;
pub use orbit::Orbit;
pub use overlay::Overlay;
pub use pick::{Hit, Thing};
pub use ray::Ray;
pub use skin::Skin;
pub use skin_textures::{SkinTextures, TexturedRun};
pub use skin_vertex::SkinVertex;
pub use solid::Solid;
pub use solid_mesh::{SolidCorner, SolidEdge, SolidMesh};
pub use style::Style;
