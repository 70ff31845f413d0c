//! The assistant that makes a body of a model, by the names a screen reader says.

use std::path::{Path, PathBuf};

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use gelatin::app::ui::files::{FileRequest, Work};
use gelatin::scene::Shape;
use gelatin::scene::body::UpAxis;
use gelatin::session::Command;
use gelatin::session::jellify::{Wanted, jellify};
use gelatin::session::progress::Progress;

use crate::files::{Stage, click, is_open, places, show};

/// Opens the assistant on a model and makes the body, as the window would on another thread.
fn jellify_in_assistant(harness: &mut Harness<'_, Stage>, path: &Path) {
    harness.state_mut().ui.files.load_model(path);
    jellify_requested(harness);
}

/// Makes the body that the assistant's values describe.
fn jellify_requested(harness: &mut Harness<'_, Stage>) {
    let work = match jellify(&requested(harness), &Progress::default()) {
        Ok(body) => Work::Ready(Box::new(body)),
        Err(error) => Work::Failed(error.to_string()),
    };
    answer(harness, work);
}

/// The body that the assistant asks for.
fn requested(harness: &mut Harness<'_, Stage>) -> Box<Wanted> {
    // The work begins only after the values have been unchanged for a while.
    harness.run_steps(60);
    let requests = std::mem::take(&mut harness.state_mut().ui.files.requests);
    let asked = requests.into_iter().find_map(|request| match request {
        FileRequest::Jellify(wanted) => Some(wanted),
        _ => None,
    });
    asked.expect("the work is asked for")
}

fn answer(harness: &mut Harness<'_, Stage>, work: Work) {
    harness.state_mut().ui.files.set_work(work);
    // The dialog grows with the preview of the model before it stands still.
    harness.run_steps(10);
}

fn box_model(folder: &Path) -> PathBuf {
    let path = folder.join("slab.obj");
    std::fs::write(
        &path,
        "v 0 0 0\nv 3 0 0\nv 3 0 1\nv 0 0 1\nv 1 2 0\nf 1 2 3 4\nf 1 5 2\nf 2 5 3\nf 3 5 4\nf 4 5 1\n",
    )
    .expect("a file");
    path
}

#[test]
fn a_model_is_looked_at_before_it_is_added() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = show(None, false);
    jellify_in_assistant(&mut harness, &box_model(folder.path()));
    for label in [
        "Cells",
        "Particles",
        "Links",
        "Components",
        "Safe step",
        "Speed",
        "Divisions",
        "Length",
        "Fill",
        "Keep",
        "Up axis",
    ] {
        assert!(harness.query_all_by_label(label).next().is_some(), "{label} is shown");
    }
    assert!(is_open(&harness, "y, guessed"), "it stands as it is");
    let commands = click(&mut harness, "Add to scene");
    let [Command::AddBody { body, jelly }] = &commands[..] else { panic!("one body, not {commands:?}") };
    assert_eq!(body.name, "slab");
    assert!(jelly.report.as_ref().is_some_and(|report| report.cells > 10), "filled already");
    assert!(!is_open(&harness, "Load model"), "the assistant is closed");
}

#[test]
fn what_is_wrong_with_a_model_is_read_without_scrolling() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = show(None, false);
    harness.state_mut().ui.files.load_model(&box_model(folder.path()));
    let mut body = jellify(&requested(&mut harness), &Progress::default()).expect("a slab");
    body.preview.warnings = ["the surface is open", "two parts are one"].map(str::to_owned).to_vec();
    answer(&mut harness, Work::Ready(Box::new(body)));
    let [first, second, figures] =
        ["The surface is open", "Two parts are one", "Mesh"].map(|label| harness.get_by_label(label).rect());
    assert!(first.bottom() <= second.top() && second.bottom() <= figures.top(), "{first}, {second}, {figures}");
}

#[test]
fn a_picture_of_the_model_shows_what_cells_lose() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = show(None, false);
    jellify_in_assistant(&mut harness, &box_model(folder.path()));
    assert!(harness.query_by_label_contains("thinner than a cell:").is_some(), "what the first colour means");
    assert!(harness.query_by_label_contains("moves as one with").is_some(), "and the second");
    let next_request = |harness: &mut Harness<'_, Stage>| harness.state_mut().ui.files.take_inset();
    let first = next_request(&mut harness).expect("the window is to draw it");
    assert!(first.size.iter().all(|side| *side > 100), "{:?}", first.size);
    assert!(first.draw_list.skins.len() == 1 && first.draw_list.overlay.cells.is_empty(), "the model alone");
    harness.run_steps(3);
    assert!(next_request(&mut harness).is_none(), "once, as long as it stays the same");
    harness.state_mut().ui.files.inset_drawn(Some(egui::TextureId::User(7)));
    harness.run_steps(3);
    assert!(next_request(&mut harness).is_none(), "it is shown");
    let place = harness.get_by_label("The model and its cells; drag to turn").rect().center();
    harness.drag_at(place);
    harness.run_steps(2);
    harness.hover_at(place + egui::vec2(60.0, 0.0));
    harness.run_steps(2);
    harness.drop_at(place + egui::vec2(60.0, 0.0));
    harness.run_steps(2);
    let turned = next_request(&mut harness).expect("it was turned");
    assert!(turned.draw_list.camera != first.draw_list.camera, "seen from elsewhere");
    harness.get_by_role_and_label(egui::accesskit::Role::CheckBox, "Cells").click();
    harness.run_steps(3);
    assert!(!next_request(&mut harness).expect("another picture").draw_list.overlay.cells.is_empty(), "with its cells");
    harness.state_mut().ui.files.inset_drawn(None);
    harness.run_steps(3);
    assert!(next_request(&mut harness).is_some(), "the window lost it: once more");
}

#[test]
fn a_model_that_lies_on_its_side_is_stood_up_by_a_guess_or_by_choice() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = box_model(folder.path());
    let lying = "v 0 0 0\nv 3 0 0\nv 3 1 0\nv 0 1 0\nv 1 0 2\nf 1 2 3 4\nf 1 5 2\nf 2 5 3\nf 3 5 4\nf 4 5 1\n";
    std::fs::write(&path, lying.replace("v 1 0 2", "v 1.5 0.5 2")).expect("a file");
    let mut harness = show(None, false);
    jellify_in_assistant(&mut harness, &path);
    assert!(is_open(&harness, "z, guessed"), "it stands only that way");
    let choose = |harness: &mut Harness<'_, Stage>, label: &str| {
        harness.get_by_role_and_label(egui::accesskit::Role::ComboBox, "Up axis").click();
        harness.run_steps(3);
        click(harness, label);
        jellify_requested(harness);
    };
    choose(&mut harness, "−x");
    let commands = click(&mut harness, "Add to scene");
    let [Command::AddBody { body, .. }] = &commands[..] else { panic!("one body, not {commands:?}") };
    let Shape::Model(model) = &body.shape else { panic!("a model") };
    assert_eq!(model.up, UpAxis::MinusX, "as chosen");
}

#[test]
fn a_model_that_takes_the_scenes_place_waits_for_unsaved_changes_as_a_whole() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = show(None, true);
    jellify_in_assistant(&mut harness, &box_model(folder.path()));
    assert!(click(&mut harness, "Replace scene").is_empty(), "the body must not fall into the old scene");
    let commands = click(&mut harness, "Discard");
    assert!(matches!(commands[..], [Command::Replace { .. }, Command::AddBody { .. }]), "{commands:?}");
}

#[test]
fn a_model_that_cannot_be_read_is_explained_in_the_assistant() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("bad.obj");
    std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 zero\nf 1 2 3\n").expect("a file");
    let mut harness = show(None, false);
    jellify_in_assistant(&mut harness, &path);
    assert!(harness.query_by_label_contains("bad.obj, line 3").is_some(), "file and line");
    assert!(click(&mut harness, "Add to scene").is_empty(), "there is nothing to add");
}

#[test]
fn work_that_is_stopped_or_closed_is_no_longer_wanted() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = show(None, false);
    harness.state_mut().ui.files.load_model(&box_model(folder.path()));
    harness.run_steps(2);
    harness.state_mut().ui.files.set_work(Work::Running(std::sync::Arc::default()));
    harness.run_steps(2);
    for label in ["Stop", "Close"] {
        harness.state_mut().ui.files.requests.clear();
        click(&mut harness, label);
        assert!(harness.state().ui.files.requests.contains(&FileRequest::StopJellifying), "{label}");
    }
}

#[test]
fn the_assistant_stands_still_while_it_works() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = show(None, false);
    harness.state_mut().ui.files.load_model(folder.path());
    harness.run_steps(3);
    let labels = ["Load model", "Divisions", "Close", "Add to scene"];
    let still = places(&harness, &labels);
    let words = "a sentence about what is wrong with this model, which is long. ".repeat(9);
    for work in [Work::Running(std::sync::Arc::default()), Work::Failed(words), Work::Idle] {
        let what = format!("{work:?}");
        harness.state_mut().ui.files.set_work(work);
        harness.run_steps(3);
        assert_eq!(places(&harness, &labels), still, "{what}");
    }
    jellify_in_assistant(&mut harness, &box_model(folder.path()));
    assert_eq!(places(&harness, &labels), still, "the body is ready");
}
