//! The windows in which large bodies are swept.

use super::oracle_tests::{Material, Shape, families, in_box, motion, shape};
use super::{InitialForce, Pass, SimdLevel, add_forces, pieces};

#[test]
fn a_window_has_less_room_than_a_large_body() {
    let Shape { lattice, .. } = shape("block", [9, 9, 300], |_| true);
    let links = in_box(&lattice, &families::<f32>(&lattice, Material::Alike, [0.1; 3]));
    for piece in pieces(&links, &[]).into_iter().chain(pieces(&links, &[0.5])) {
        let (room, own) = (piece.room.places(), piece.own.len());
        assert!(room < own, "{room} places for {own} corners");
    }
}

#[test]
fn blocks_of_a_full_box_begin_with_lines_of_the_caches() {
    // Numbers of single precision in a line.
    const LINE: usize = 16;
    let Shape { lattice, .. } = shape("block", [9, 11, 300], |_| true);
    let links = in_box(&lattice, &families::<f32>(&lattice, Material::Alike, [0.1; 3]));
    for piece in pieces(&links, &[]).into_iter().chain(pieces(&links, &[0.3, 0.7])) {
        assert!(piece.panels.len() > 1, "the window moves on");
        for panel in &piece.panels {
            for block in &links.layout.blocks[panel.blocks.clone()] {
                assert!((block.first - panel.first).is_multiple_of(LINE), "{} of {panel:?}", block.first);
            }
        }
    }
}

#[test]
fn a_pass_that_is_given_up_looks_at_no_more_links() {
    let Shape { lattice, .. } = shape("block", [30, 30, 30], |_| true);
    let families = families::<f32>(&lattice, Material::Alike, [0.1; 3]);
    let links = in_box(&lattice, &families);
    let [position, velocity] = motion::<f32>(&lattice);
    let looks = std::cell::Cell::new(0);
    let stops = || {
        looks.set(looks.get() + 1);
        looks.get() > 2
    };
    let pass = Pass { level: SimdLevel::best(), families: [true; 3], damped: [true; 3] };
    let mut force = vec![glam::Vec3::ZERO; position.len()];
    let mut whole = pieces(&links, &[]);
    let count = add_forces(
        &links,
        pass,
        [&position, &velocity],
        InitialForce::Each,
        &mut force,
        &mut whole[0],
        &stops,
        &mut |_, _| (),
    );
    let all: usize = families.iter().map(|family| family.links.len()).sum();
    // Two panels, of 4096 corners with up to 16 links each.
    assert!((1 << 16..=2 << 16).contains(&count) && count < all as u64, "{count} of {all}");
}
