//! The brush over the cells of a body, in the inspector.

use gelatin::app::theme::Theme;
use gelatin::app::ui::Brush;
use gelatin::scene::body::ModelShape;
use gelatin::scene::cell_brush::CellChange;
use gelatin::scene::edit::BodyId;
use gelatin::scene::{Scene, Shape, Skin, presets};

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
fn a_model_shows_its_cells_for_the_brush_and_has_its_own_again() {
    let mut scene = (presets::preset("cube-on-plane").expect("a preset").build)();
    let erased = vec![[1, 2, 3], [1, 2, 4]];
    let model = ModelShape { path: "builtin:spot.obj".to_owned(), divisions: 6, erased, ..ModelShape::default() };
    scene.bodies[0].shape = Shape::Model(model);
    let mut window = window(scene);
    let body = |window: &Window| window.scene().bodies[0].clone();
    assert_eq!(body(&window).skin, Skin::Auto);
    window.control("Brush").scroll_to_me();
    window.wait();
    window.choose("Brush", "adds cells");
    window.wait();
    assert_eq!(body(&window).skin, Skin::Cells, "what is drawn over is seen");
    window.control("Clear").scroll_to_me();
    window.wait();
    window.click("Clear");
    window.wait();
    let Shape::Model(model) = body(&window).shape else { panic!("it is a model") };
    assert!(model.erased.is_empty(), "it has its own cells again");
}
