//! Geometry without physics: a model file becomes a triangle mesh, the mesh becomes cells of a grid, the cells become the
//! particles and links of a lattice, and points of the mesh are embedded in the lattice; a few sample points stand for the
//! whole surface. Cells belong to the parts that the file names, and the mesh has the colours and pictures of the file.

pub mod embed;
pub mod import;
pub mod lattice;
pub mod named_parts;
pub mod paint;
pub mod part_cells;
pub mod picture_file;
pub(crate) mod places;
pub mod sampling;
pub mod shading;
pub mod surface;
pub mod texturing;
pub mod trimesh;
pub mod up_axis;
pub mod voxel;
pub mod watch;

pub use lattice::{Family, Lattice, LatticeCounts};
pub use paint::Paint;
pub use sampling::SurfaceSample;
pub use shading::Shading;
pub use surface::Surface;
pub use trimesh::TriMesh;
pub use up_axis::UpAxis;
pub use watch::Watch;
