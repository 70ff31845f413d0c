//! Draw lists of a few simple things.

use std::sync::Arc;

use gelatin::extract::skin::cells_skin;
use gelatin::geometry::Lattice;
use gelatin::geometry::voxel::Cells;
use gelatin::view::{Camera, DrawList, SkinInstance, Style};
use glam::Vec3;

/// A cube of 1 m standing on the ground in the middle, 4 cells an edge.
pub(crate) fn cube() -> DrawList {
    cube_at(Vec3::Y * 0.5)
}

/// A cube of 1 m around a point.
pub(crate) fn cube_at(center: Vec3) -> DrawList {
    let lattice = Lattice::new(&Cells::cube(4, 0.25).expect("a small cube"));
    let position = |particle| (lattice.rest_position(particle).as_vec3() + center).to_array();
    let particles = (0..lattice.corners.len()).map(position).collect();
    DrawList {
        camera: camera(),
        skins: vec![SkinInstance { skin: Arc::new(cells_skin(&lattice, 0)), color: Style::default().body(0) }],
        particles: Arc::new(particles),
        ..DrawList::default()
    }
}

/// Looks along −z from 4 m away at half a metre's height; a metre at the target is a quarter of the picture's height.
pub(crate) fn camera() -> Camera {
    let target = Vec3::Y * 0.5;
    Camera { eye: target + Vec3::Z * 4.0, target, up: Vec3::Y, fov_rad: 2.0 * 0.5_f32.atan() }
}

/// As [`camera`], from above.
pub(crate) fn camera_above() -> Camera {
    Camera { eye: Vec3::Y * 4.5, target: Vec3::Y * 0.5, up: Vec3::NEG_Z, ..camera() }
}
