//! The pile of the comparison: the jellies of a preset before they fall.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::geometry::Lattice;
use crate::physics::{BodyModel, Simulation};
use crate::report::extremes::lattices;
use crate::scene::resolve::ResolveError;
use crate::scene::{Scene, presets};

/// The preset.
const PRESET: &str = "pile";

/// The corners of a cell's six faces, counter-clockwise from outside. In a corner's number bit 0 is x, bit 1 y, bit 2 z.
const FACES: [[usize; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

/// The pile before it falls.
pub(super) struct Pile {
    pub(super) scene: Scene,
    pub(super) lattices: Vec<Arc<Lattice>>,
    pub(super) bodies: Vec<BodyModel<f64>>,
}

impl Pile {
    /// The pile of the preset; an error if it cannot be made, which the preset should not cause.
    pub(super) fn new() -> Result<Self, ResolveError> {
        let mut scene = presets::preset(PRESET).map(|preset| (preset.build)()).unwrap_or_default();
        scene.settings.sleeping = false;
        for body in &mut scene.bodies {
            body.self_collides = false;
        }
        let lattices = lattices(&scene)?;
        let bodies = Simulation::<f64>::new(&scene, &lattices).model().bodies.clone();
        Ok(Self { scene, lattices, bodies })
    }
}

/// The outer faces of a body's cells, two triangles each, counter-clockwise from outside, by particle.
pub(super) fn outer_faces(body: &BodyModel<f64>) -> Vec<[u32; 3]> {
    let mut faces: BTreeMap<[u32; 4], Vec<[u32; 4]>> = BTreeMap::new();
    for cell in &body.lattice.cells {
        for face in FACES.map(|places| places.map(|place| cell[place])) {
            let mut key = face;
            key.sort_unstable();
            faces.entry(key).or_default().push(face);
        }
    }
    let outer = faces.into_values().filter(|same| same.len() == 1).flatten();
    outer.flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Surface, TriMesh};

    #[test]
    fn outer_faces_are_closed_and_face_outwards() {
        let pile = Pile::new().expect("a pile");
        for body in &pile.bodies {
            let mesh = TriMesh { positions: body.start.clone(), triangles: outer_faces(body) };
            let surface = Surface::new(&mesh).expect("a surface");
            assert!(surface.is_closed(), "every body has an inside");
            let volume: f64 = (0..mesh.triangles.len())
                .map(|triangle| {
                    let [a, b, c] = mesh.corners(triangle);
                    a.dot(b.cross(c)) / 6.0
                })
                .sum();
            let cell = body.lattice.grid.cell_size;
            let expected = body.lattice.cells.len() as f64 * cell * cell * cell;
            assert!((volume / expected - 1.0).abs() < 1e-9, "{volume} m³ of {expected} m³");
        }
    }
}
