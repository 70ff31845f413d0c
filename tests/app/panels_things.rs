//! The list of things and the menus: their commands are carried out by a sandbox that really runs.

use std::path::{Path, PathBuf};

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use gelatin::app::hand::Target;
use gelatin::app::theme::Theme;
use gelatin::app::ui::Framing;
use gelatin::app::ui::files::{FileAction, FileRequest, PathUse, Work};
use gelatin::scene::body::ModelShape;
use gelatin::scene::edit::{BodyId, ObstacleId};
use gelatin::scene::obstacle::Motion;
use gelatin::scene::{ColorBy, ObstacleShape, Shape};
use gelatin::session::Command;
use gelatin::session::jellify::{Wanted, jellify};
use gelatin::session::progress::Progress;

use crate::live::Window;

const SPHERE: &str = "Sphere";

#[test]
fn new_things_are_chosen_and_have_names_of_their_own() {
    let mut window = Window::open("cube-on-plane");
    let (bodies, obstacles) = (window.scene().bodies.len(), window.scene().obstacles.len());
    window.click("+ Cube");
    assert_eq!(window.scene().bodies.len(), bodies + 1);
    assert_eq!(window.harness.state().ui.selection, Some(Target::Body(BodyId(bodies))));
    window.click("+ Sphere");
    window.click("+ Plane");
    assert_eq!(window.scene().obstacles.len(), obstacles + 2);
    assert_eq!(window.harness.state().ui.selection, Some(Target::Obstacle(ObstacleId(obstacles + 1))));
    let names: Vec<&str> = window.scene().obstacles.iter().map(|obstacle| obstacle.name.as_str()).collect();
    assert!(names.iter().all(|name| names.iter().filter(|other| *other == name).count() == 1), "{names:?} differ");
}

#[test]
fn no_two_things_have_one_name_however_they_come() {
    let mut window = Window::open("cube-on-plane");
    for thing in ["Sphere", "Sphere 2", "Jelly"] {
        window.click(thing);
        window.choose("Edit", &format!("Duplicate {thing}"));
    }
    window.click("+ Cube");
    window.click("+ Cube");
    let bodies = window.scene().bodies.iter().map(|body| body.name.clone());
    let names: Vec<String> =
        bodies.chain(window.scene().obstacles.iter().map(|obstacle| obstacle.name.clone())).collect();
    assert_eq!(names, ["Jelly", "Jelly 2", "Cube", "Cube 2", "Ground", "Sphere", "Sphere 2", "Sphere 3"]);
    window.choose("Edit", "Rename Cube 2");
    window.harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.enter("Ground");
    assert_eq!(window.scene().bodies[3].name, "Ground 2", "a name that is taken gets a number");
    window.click("Undo");
    assert_eq!(window.scene().bodies[3].name, "Cube 2");
}

/// A model file.
fn ogre(folder: &Path) -> PathBuf {
    let path = folder.join("ogre.obj");
    std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n").expect("a file");
    path
}

/// Loads a model in the assistant, as the window would on another thread, and clicks on a button of it.
fn load_model(window: &mut Window, path: &Path, button: &str) {
    window.harness.state_mut().ui.files.load_model(path);
    jellify_again(window);
    window.click(button);
}

#[test]
fn a_body_is_filled_anew_once_a_person_has_seen_what_becomes_of_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = ogre(folder.path());
    let mut window = Window::open("cube-on-plane");
    load_model(&mut window, &path, "Add to scene");
    let before = window.scene().bodies[1].clone();
    window.press("Preview…");
    let wanted = jellify_again(&mut window);
    assert_eq!(wanted.body.as_deref(), Some(&before), "the body that there is");
    assert!(window.harness.query_by_label("Add to scene").is_none(), "it is in the scene");
    window.click("Close");
    assert_eq!(window.scene().bodies[1], before, "nothing was changed");
    window.press("Preview…");
    let Shape::Model(model) = &before.shape else { panic!("a model") };
    window.harness.state_mut().ui.files.refill(BodyId(1), ModelShape { divisions: 9, ..model.clone() });
    jellify_again(&mut window);
    window.click("Apply");
    let Shape::Model(model) = &window.scene().bodies[1].shape else { panic!("a model") };
    assert_eq!((model.divisions, &window.scene().bodies[1].material), (9, &before.material));
    window.click("Undo");
    assert_eq!(window.scene().bodies[1], before, "one step");
}

/// Makes the body that the assistant asks for.
fn jellify_again(window: &mut Window) -> Wanted {
    window.harness.run_steps(60);
    let requests = std::mem::take(&mut window.harness.state_mut().ui.files.requests);
    let asked = requests.into_iter().find_map(|request| match request {
        FileRequest::Jellify(wanted) => Some(*wanted),
        _ => None,
    });
    let wanted = asked.expect("the work is asked for");
    let body = jellify(&wanted, &Progress::default()).expect("a body");
    window.harness.state_mut().ui.files.set_work(Work::Ready(Box::new(body)));
    window.wait();
    wanted
}

#[test]
fn a_model_is_chosen_as_soon_as_it_is_there() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = ogre(folder.path());
    let mut window = Window::open("cube-on-plane");
    for (place, name) in [(1, "ogre"), (2, "ogre 2")] {
        load_model(&mut window, &path, "Add to scene");
        assert_eq!(window.scene().bodies[place].name, name);
        assert_eq!(window.harness.state().ui.selection, Some(Target::Body(BodyId(place))), "{name} is chosen");
    }
    assert_eq!(window.harness.state().ui.files.folders.model.as_deref(), Some(folder.path()), "its folder is known");
    load_model(&mut window, &path, "Replace scene");
    window.click("Discard");
    assert_eq!(window.scene().bodies.len(), 1, "a scene of its own");
    assert_eq!(window.harness.state().ui.selection, Some(Target::Body(BodyId(0))), "and chosen in it");
    window.harness.state_mut().ui.files.ask(FileAction::New);
    window.wait();
    window.click("Discard");
    assert_eq!(window.harness.state().ui.selection, None, "nothing comes along with an empty scene");
}

#[test]
fn a_mesh_is_found_added_chosen_and_set_in_motion() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("wedge.obj");
    std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n").expect("a file");
    let mut window = Window::open("cube-on-plane");
    let place = window.scene().obstacles.len();
    window.click("+ Mesh…");
    window.harness.state_mut().ui.files.browsed(PathUse::OpenMesh, Some(&path));
    window.wait();
    window.click("Add");
    let wedge = window.scene().obstacles[place].clone();
    let ObstacleShape::Mesh(mesh) = &wedge.shape else { panic!("a mesh") };
    assert!(wedge.name == "wedge" && mesh.surface().is_some_and(|surface| surface.is_closed()), "{wedge:?}");
    assert_eq!(window.harness.state().ui.selection, Some(Target::Obstacle(ObstacleId(place))), "it is chosen");
    window.click("Motion");
    window.wait();
    window.click("Kind");
    window.click("Turns");
    assert!(matches!(window.scene().obstacles[place].motion, Some(Motion::Turn(_))), "it turns");
    window.click("Undo");
    window.click("Undo");
    assert_eq!(window.scene().obstacles.len(), place, "all of it is taken back");
}

#[test]
fn all_that_was_added_is_taken_back_by_the_menu_in_words() {
    let mut window = Window::open("cube-on-plane");
    let before = window.scene().clone();
    window.click("+ Sphere");
    let words = window.harness.state().session.status().undo;
    assert!(!words.is_empty(), "there is something to take back");
    window.choose("Edit", &format!("Undo {words}"));
    assert_eq!(*window.scene(), before);
    window.choose("Edit", &format!("Redo {words}"));
    assert_eq!(window.scene().obstacles.len(), before.obstacles.len() + 1);
}

#[test]
fn a_thing_is_renamed_in_its_place_and_escape_gives_up() {
    let mut window = Window::open("cube-on-plane");
    window.click("Jelly");
    window.choose("Edit", "Rename Jelly");
    window.harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.enter("Pudding");
    assert_eq!(window.scene().bodies[0].name, "Pudding");
    window.choose("Edit", "Rename Pudding");
    window.harness.event(egui::Event::Text("Other".into()));
    window.wait();
    window.key(Modifiers::NONE, Key::Escape);
    assert_eq!(window.scene().bodies[0].name, "Pudding", "given up");
    assert!(window.has("Pudding"), "and the list is as before");
}

#[test]
fn a_double_click_renames() {
    let mut window = Window::open("cube-on-plane");
    window.double_click("Jelly");
    assert!(window.harness.state().ui.renaming.is_some(), "the name can be typed");
}

#[test]
fn hiding_duplicating_and_deleting_act_on_what_is_chosen() {
    let mut window = Window::open("cube-on-plane");
    window.click(SPHERE);
    window.choose("Edit", "Hide Sphere");
    assert!(window.scene().obstacles[1].hidden, "hidden");
    window.choose("Edit", "Show Sphere");
    assert!(!window.scene().obstacles[1].hidden, "shown");
    window.choose("Edit", "Duplicate Sphere");
    assert_eq!(window.scene().obstacles.len(), 3);
    window.choose("Edit", "Delete Sphere 2");
    assert_eq!(window.scene().obstacles.len(), 2);
    assert_eq!(window.harness.state().ui.selection, None, "nothing is chosen that is not there");
}

#[test]
fn the_eye_hides_without_choosing() {
    let mut window = Window::open("cube-on-plane");
    window.click("Hide Jelly");
    assert!(window.scene().bodies[0].hidden, "hidden");
    assert_eq!(window.harness.state().ui.selection, None);
    window.click("Show Jelly");
    assert!(!window.scene().bodies[0].hidden, "shown");
}

#[test]
fn without_a_choice_nothing_can_be_deleted() {
    let mut window = Window::open("cube-on-plane");
    let before = window.scene().clone();
    window.choose("Edit", "Delete");
    assert_eq!(*window.scene(), before);
}

#[test]
fn a_choice_does_not_outlive_what_was_chosen() {
    let mut window = Window::open("cube-on-plane");
    window.click("+ Sphere");
    let added = window.harness.state().ui.selection;
    window.harness.state_mut().session.handle(Command::Undo).expect("it is taken back");
    window.wait();
    assert!(added.is_some() && window.harness.state().ui.selection.is_none(), "{added:?} is gone");
}

#[test]
fn a_choice_stays_with_what_was_chosen_when_undo_brings_another_back_before_it() {
    let mut window = Window::open("cube-on-plane");
    window.click("+ Cube");
    window.click("+ Cube");
    window.click("Cube");
    window.choose("Edit", "Delete Cube");
    window.click("Cube 2");
    window.harness.state_mut().session.handle(Command::Undo).expect("it comes back");
    window.wait();
    assert_eq!(window.harness.state().ui.selection, Some(Target::Body(BodyId(2))), "it is the third again");
    window.harness.state_mut().session.handle(Command::Redo).expect("it goes");
    window.wait();
    assert_eq!(window.harness.state().ui.selection, Some(Target::Body(BodyId(1))), "and the second");
}

#[test]
fn the_view_menu_colours_draws_over_and_frames() {
    let mut window = Window::open("cube-on-plane");
    window.click("View");
    window.click("Colour by");
    window.click("Strain, %");
    assert_eq!(window.scene().view.color, ColorBy::Strain);
    window.click("Draw over the jelly");
    for name in ["Wire frame", "Particles"] {
        window.click(name);
    }
    let overlays = window.scene().view.overlays;
    assert!(overlays.wireframe && overlays.particles && !overlays.cells, "the two that were clicked: {overlays:?}");
    window.click("Show everything");
    assert_eq!(window.harness.state().ui.frame, Some(Framing::Everything));
}

#[test]
fn panels_are_folded_away_and_come_back() {
    let mut window = Window::open("cube-on-plane");
    let narrow = window.harness.state().ui.view_rect.width();
    window.choose("View", "List of things");
    window.click("Values");
    let wide = window.harness.state().ui.view_rect.width();
    assert!(wide > narrow + 400.0 && !window.has("+ Cube"), "the view has all the width: {wide}");
    window.click("List of things");
    window.click("Values");
    assert!(window.has("+ Cube"), "the list is back");
}

#[test]
fn the_theme_is_chosen_from_the_menu() {
    let mut window = Window::open("cube-on-plane");
    window.choose("View", "Light");
    assert_eq!(window.harness.state().ui.theme, Theme::Light);
    assert!(!window.harness.ctx.global_style().visuals.dark_mode, "it is light");
    window.click("Dark");
    assert!(window.harness.ctx.global_style().visuals.dark_mode, "it is dark again");
}

#[test]
fn the_range_of_the_colours_is_held_and_let_go() {
    let mut window = Window::open("cube-on-plane");
    window.choose("Colour by", "load, N");
    window.click("Fixed range");
    assert_eq!(window.scene().view.color_range, Some([0.0, 12.4]), "as it was when it was held");
    window.click("Range to");
    window.harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.enter("5");
    assert_eq!(window.scene().view.color_range, Some([0.0, 5.0]));
    window.click("Fixed range");
    assert_eq!(window.scene().view.color_range, None, "it follows the motion again");
}
