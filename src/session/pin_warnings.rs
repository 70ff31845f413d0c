//! Warnings about pins that hold nothing, a sentence each.

use std::collections::BTreeSet;

use crate::physics::{BodyModel, Model};
use crate::scene::cell_brush::{cell_in_grid, lowest_cell};
use crate::scene::{Body, Scene, named};

/// Returns the warnings about the pins of a scene.
pub(super) fn pin_warnings(scene: &Scene, model: &Model<f32>) -> Vec<String> {
    let bodies = scene.bodies.iter().zip(&model.bodies).enumerate();
    bodies
        .filter(|(_, (body, _))| body.has_pins())
        .flat_map(|(place, (body, model))| of_body(place, body, model))
        .collect()
}

fn of_body(place: usize, body: &Body, model: &BodyModel<f32>) -> Vec<String> {
    let (name, lattice) = (named(&body.name, "body", place), &model.lattice);
    let mut found = Vec::new();
    for (number, pin) in (1..).zip(&body.pins) {
        if !(0..model.particles.len()).any(|particle| pin.holds(lattice.rest_position(particle))) {
            found.push(format!("box {number} of the pins of {name} holds nothing: no particle is in it"));
        }
    }
    let low = lowest_cell(&body.shape);
    let mut missing: BTreeSet<[i32; 3]> = body.pinned_cells.iter().copied().collect();
    if missing.is_empty() {
        return found;
    }
    let count = missing.len();
    for (cell, _) in (0..).zip(&lattice.cells) {
        missing.remove(&cell_in_grid(low, lattice.low(cell)));
    }
    if let Some([i, j, k]) = missing.first() {
        let less = missing.len();
        found.push(format!(
            "of the {count} pinned cells of {name} it lacks {less}, the first of them [{i}, {j}, {k}]: these hold nothing"
        ));
    }
    found
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::scene::body::{CubeShape, PinBox};
    use crate::scene::{Scene, Shape};
    use crate::session::Session;

    fn warnings(pins: Vec<PinBox>, pinned_cells: Vec<[i32; 3]>) -> Vec<String> {
        let shape = Shape::Cube(CubeShape { cells: 2, size: 1.0 });
        let body = Body { name: "Jelly".to_owned(), shape, pins, pinned_cells, ..Body::default() };
        let scene = Scene { bodies: vec![body], ..Scene::default() };
        Session::new(scene, PathBuf::new(), String::new()).expect("a cube").warnings()
    }

    #[test]
    fn pins_that_hold_something_are_no_matter() {
        let top = PinBox { min: [-1.0, 0.4, -1.0], max: [1.0; 3] };
        assert_eq!(warnings(vec![top], vec![[0, 1, 0], [1, 1, 1]]), Vec::<String>::new());
    }

    #[test]
    fn a_box_beside_the_body_and_cells_that_it_lacks_are_named() {
        let beside = PinBox { min: [2.0; 3], max: [3.0; 3] };
        let said = warnings(vec![beside], vec![[0, 0, 0], [0, 2, 0], [5, 0, 0]]);
        assert_eq!(said.len(), 2, "{said:?}");
        assert!(said[0].contains("box 1 of the pins of Jelly holds nothing"), "{said:?}");
        assert!(
            said[1].contains("of the 3 pinned cells of Jelly it lacks 2") && said[1].contains("[0, 2, 0]"),
            "{said:?}"
        );
    }
}
