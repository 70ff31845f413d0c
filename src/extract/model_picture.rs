//! A picture of a model and its cells before it becomes a body. Its surface is coloured where the cells lose detail (SC,
//! limitations a and b); the frames of the cells show the steps of a slope.

use std::sync::Arc;

use glam::DVec3;

use super::skin::model_skin;
use crate::geometry::Lattice;
use crate::geometry::paint::{NO_TINT, Paint, Tint};
use crate::geometry::voxel::{Lost, LostDetail};
use crate::math::Aabb;
use crate::view::overlay::CellFrames;
use crate::view::{DrawList, Orbit, Overlay, SafeArea, Skin, SkinInstance, Style};

/// sRGB, distinct for colour-blind people too (after Okabe and Ito): parts that are thinner than a cell, ...
pub const THIN_COLOR: [u8; 3] = [230, 159, 0];
/// ... parts that move as one with another part, ...
pub const JOINED_COLOR: [u8; 3] = [86, 130, 233];
/// ... and parts that are both.
pub const THIN_AND_JOINED_COLOR: [u8; 3] = [204, 60, 120];

/// The colour of a surface that loses no detail, linear red, green, blue.
const PLAIN_COLOR: [f32; 3] = [0.55, 0.56, 0.58];

/// A model and its cells.
#[derive(Clone, Debug)]
pub struct ModelPicture {
    skin: Arc<Skin>,
    particles: Arc<Vec<[f32; 3]>>,
    cells: Arc<Vec<[u32; 8]>>,
    bounds: Aabb<f32>,
}

impl ModelPicture {
    /// The picture of a lattice and of the detail that it loses of its model.
    pub fn new(lattice: &Lattice, lost: &LostDetail) -> Self {
        let tint = |lost: &Lost| match (lost.thin, lost.joined) {
            (false, false) => NO_TINT,
            (true, false) => opaque(THIN_COLOR),
            (false, true) => opaque(JOINED_COLOR),
            (true, true) => opaque(THIN_AND_JOINED_COLOR),
        };
        let paint = Paint::new(Vec::new(), lost.lost.iter().map(tint).collect(), None);
        let skin = model_skin(lattice, &lost.pieces, paint.as_ref(), None, 0);
        // The model stands on the ground.
        let lift = DVec3::Y * -lattice.grid.origin.y;
        let particles: Vec<[f32; 3]> =
            lattice.corners.iter().map(|corner| (lattice.grid.corner(*corner) + lift).as_vec3().to_array()).collect();
        let bounds = particles.iter().fold(Aabb::empty(), |bounds, place| bounds.include((*place).into()));
        let cells = Arc::new(lattice.cells.clone());
        Self { skin: Arc::new(skin), particles: Arc::new(particles), cells, bounds }
    }

    /// The orbit from which the whole model is seen in the same direction, in a picture of this width over height.
    pub fn framed(&self, mut orbit: Orbit, aspect: f32) -> Orbit {
        orbit.frame(self.bounds, SafeArea::whole(aspect));
        orbit
    }

    /// The picture as a draw list.
    pub fn draw_list(&self, orbit: &Orbit, style: Style, cells: bool, scale: f32) -> DrawList {
        let mut overlay = Overlay { scale, ..Overlay::default() };
        if cells {
            overlay.cells.push(CellFrames { cells: Arc::clone(&self.cells), first: 0, width: 1.0 });
        }
        DrawList {
            camera: orbit.camera(),
            style,
            skins: vec![SkinInstance { skin: Arc::clone(&self.skin), color: PLAIN_COLOR }],
            particles: Arc::clone(&self.particles),
            painted: true,
            overlay,
            ..DrawList::default()
        }
    }
}

fn opaque([red, green, blue]: [u8; 3]) -> Tint {
    [red, green, blue, 255]
}
