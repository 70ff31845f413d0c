//! How a body moves, in the inspector: cells or modes are chosen, modes are found and can be stopped, explained in words,
//! and undone.

use egui_kittest::kittest::Queryable as _;
use gelatin::app::theme::Theme;
use gelatin::scene::body::{CellsShape, CubeShape, PinBox};
use gelatin::scene::{MovesBy, Scene, Shape, presets};

use crate::live::{SIZES, Window};

/// A cube that is held below, and a sphere.
fn held() -> Scene {
    let mut scene = (presets::preset("cube-on-plane").expect("a preset").build)();
    scene.bodies[0].shape = Shape::Cube(CubeShape { cells: 3, size: 1.0 });
    scene.bodies[0].pins = vec![PinBox { min: [-9.0; 3], max: [9.0, -0.49, 9.0] }];
    scene
}

/// A window in which the motion of the only body is shown.
fn window(scene: Scene, size: [f32; 2]) -> Window {
    let mut window = Window::on(scene, "held cube", size, Theme::Dark);
    window.press("Jelly");
    window.control("Motion").scroll_to_me();
    window.wait();
    window.click("Motion");
    window
}

/// Whether a text that contains these words is shown.
fn says(window: &Window, words: &str) -> bool {
    window.harness.query_all_by_label_contains(words).next().is_some()
}

fn choose_modes(window: &mut Window) {
    window.control("Moves by").scroll_to_me();
    window.wait();
    window.choose("Moves by", "its lowest modes");
}

#[test]
fn a_held_body_moves_by_modes_when_they_are_found_and_by_its_cells_after_undo() {
    let mut window = window(held(), [1280.0, 1000.0]);
    choose_modes(&mut window);
    assert_eq!(window.scene().bodies[0].moves_by, MovesBy::Modes);
    assert!(says(&window, "Finding the modes of Jelly") && window.has("Stop: move by its cells"), "with a stop");
    window.harness.state_mut().session.find_modes(None, &());
    window.wait();
    assert!(!says(&window, "Finding the modes of Jelly"), "they are there");
    assert!(says(&window, "times a second") && says(&window, "where a part turns far against the rest"), "as they are");
    window.click("Undo");
    assert_eq!(window.scene().bodies[0].moves_by, MovesBy::Cells, "one change");
    assert!(!says(&window, "times a second"), "nothing is said of modes any more");
}

#[test]
fn who_does_not_want_to_wait_has_the_body_move_by_its_cells() {
    let mut window = window(held(), [1280.0, 1000.0]);
    choose_modes(&mut window);
    window.click("Stop: move by its cells");
    assert!(window.harness.state().session.awaited_modes().is_none(), "nothing is looked for");
    assert!(says(&window, "the search for its modes was stopped"), "and it is said");
    assert!(says(&window, "It moves by its cells as yet"), "in the inspector too");
}

#[test]
fn a_body_that_nothing_holds_moves_by_modes_too_and_one_of_loose_pieces_says_what_it_needs() {
    let mut scene = held();
    scene.bodies[0].pins.clear();
    let mut free = window(scene.clone(), [1280.0, 1000.0]);
    choose_modes(&mut free);
    assert!(says(&free, "Finding the modes of Jelly"), "they are looked for");
    free.harness.state_mut().session.find_modes(None, &());
    free.wait();
    assert!(says(&free, "times a second"), "it moves by them");
    scene.bodies[0].shape = Shape::Cells(CellsShape { list: vec![[0, 0, 0], [2, 0, 0]], size: 0.3 });
    let mut loose = window(scene, [1280.0, 1000.0]);
    choose_modes(&mut loose);
    loose.harness.state_mut().session.find_modes(None, &());
    loose.wait();
    assert!(says(&loose, "join them or hold each"), "what would be right");
}

#[test]
fn the_card_is_in_every_window() {
    for size in SIZES {
        let mut scene = held();
        scene.bodies[0].moves_by = MovesBy::Modes;
        let window = Window::on(scene, "held cube", size, Theme::Dark);
        let stop = window.rect("Stop: move by its cells");
        let inside = stop.min.x >= 0.0 && stop.min.y >= 0.0 && stop.max.x <= size[0] && stop.max.y <= size[1];
        assert!(inside, "{stop:?} in {size:?}");
    }
}
