//! The brush over the cells of a body, in the inspector.

use gelatin::app::theme::Theme;
use gelatin::app::ui::Brush;
use gelatin::scene::body::ModelShape;
use gelatin::scene::cell_brush::CellChange;
use gelatin::scene::edit::BodyId;
use gelatin::scene::{Scene, Shape, presets};

use crate::live::Window;

/// A window in which the shape of the only body is shown.
fn window(scene: Scene) -> Window {
    let mut window = Window::on(scene, "cube", [1280.0, 1000.0], Theme::Dark);
    window.choose_thing("Jelly");
    window.control("Shape").scroll_to_me();
    window.wait();
    window
}

#[test]
fn a_brush_is_taken_turned_round_and_put_down() {
    let mut window = window((presets::preset("cube-on-plane").expect("a preset").build)());
    let brush = |window: &Window| window.harness.state().ui.brush;
    assert_eq!(brush(&window), None);
    window.control("Brush").scroll_to_me();
    window.wait();
    window.choose("Brush", "adds cells");
    assert_eq!(brush(&window), Some(Brush { body: BodyId(0), change: CellChange::Attach }));
    window.choose("Brush", "takes cells away");
    assert_eq!(brush(&window), Some(Brush { body: BodyId(0), change: CellChange::Erase }));
    window.choose("Brush", "none");
    assert_eq!(brush(&window), None);
}

#[test]
fn a_model_has_no_cells_of_its_own_to_draw_over() {
    let mut scene = (presets::preset("cube-on-plane").expect("a preset").build)();
    let model = ModelShape { path: "builtin:spot.obj".to_owned(), divisions: 6, ..ModelShape::default() };
    scene.bodies[0].shape = Shape::Model(model);
    assert!(!window(scene).has("Brush"));
}
