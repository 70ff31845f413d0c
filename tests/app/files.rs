//! The dialogs about files by the names a screen reader says: requests that wait for an answer, and messages while typing.

use std::path::{Path, PathBuf};

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use gelatin::app::frame_meter::DrawingCost;
use gelatin::app::theme;
use gelatin::app::ui::files::{FileAction, FileRequest, FoundDraft, PathUse};
use gelatin::app::ui::{Running, Shown, UiState, panels_ui};
use gelatin::scene::view_settings::CameraSettings;
use gelatin::scene::{Scene, presets};
use gelatin::session::document::ModelPlace;
use gelatin::session::{Command, Session, Status};

/// The state that the panels show, and the commands they gave.
pub(crate) struct Stage {
    pub(crate) status: Status,
    pub(crate) scene: Scene,
    pub(crate) ui: UiState,
    pub(crate) commands: Vec<Command>,
}

pub(crate) fn show(file: Option<&Path>, unsaved: bool) -> Harness<'static, Stage> {
    let status = Status { title: "a.ron".into(), file: file.map(Path::to_owned), unsaved, ..Status::default() };
    let mut ui = UiState::new(presets::presets());
    ui.files.camera = CameraSettings { distance: 3.5, ..CameraSettings::default() };
    let stage = Stage { status, scene: Scene::default(), ui, commands: Vec::new() };
    let mut harness = Harness::builder().with_size([1280.0, 800.0]).build_ui_state(
        |ui, stage: &mut Stage| {
            theme::apply(ui.ctx());
            let running = Running { status: &stage.status, scene: &stage.scene, color_key: None, is_painted: false };
            // The commands of a frame are sent before the next one.
            let mut commands = Vec::new();
            panels_ui(
                ui,
                &Shown {
                    running: Some(running),
                    failure: "",
                    value: "",
                    opening: None,
                    making: None,
                    drawing: DrawingCost::default(),
                },
                &mut stage.ui,
                &mut commands,
            );
            stage.commands.append(&mut commands);
        },
        stage,
    );
    harness.run_steps(3);
    harness
}

pub(crate) fn ask(harness: &mut Harness<'_, Stage>, action: FileAction) -> Vec<Command> {
    harness.state_mut().ui.files.ask(action);
    harness.run_steps(3);
    std::mem::take(&mut harness.state_mut().commands)
}

pub(crate) fn click(harness: &mut Harness<'_, Stage>, label: &str) -> Vec<Command> {
    harness.get_by_label(label).click();
    harness.run_steps(3);
    std::mem::take(&mut harness.state_mut().commands)
}

/// Puts a path into the open dialog, as the system's own would.
fn choose(harness: &mut Harness<'_, Stage>, purpose: PathUse, path: &Path) {
    harness.state_mut().ui.files.browsed(purpose, Some(path));
    harness.run_steps(2);
}

pub(crate) fn is_open(harness: &Harness<'_, Stage>, label: &str) -> bool {
    harness.query_by_label(label).is_some()
}

fn folder_with_a_scene() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a.ron");
    Scene::default().save(&file).expect("a scene");
    (folder, file)
}

#[test]
fn the_menu_saves_and_opens() {
    let mut harness = show(Some(Path::new("/a.ron")), true);
    click(&mut harness, "File");
    let commands = click(&mut harness, "Save");
    assert!(
        matches!(&commands[..], [Command::Save { camera }] if (camera.distance - 3.5).abs() < 1e-9),
        "{commands:?}"
    );
    click(&mut harness, "File");
    click(&mut harness, "Open…");
    harness.get_by_label("Open scene");
    harness.get_by_label("Browse…").click();
    harness.run_steps(2);
    assert!(matches!(harness.state().ui.files.requests[..], [FileRequest::Browse(PathUse::OpenScene, _)]));
}

#[test]
fn a_state_is_saved_and_opened_from_the_menu() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = folder.path().join("a.ron");
    let mut harness = show(Some(&scene), false);
    click(&mut harness, "File");
    let commands = click(&mut harness, "Save state…");
    assert!(matches!(commands[..], [Command::Pause]), "the moment waits for its name: {commands:?}");
    harness.get_by_label("Save state as");
    let commands = click(&mut harness, "Save");
    let [Command::SaveState { path }] = &commands[..] else { panic!("a state to save, not {commands:?}") };
    assert_eq!(*path, folder.path().join("a.state"), "beside the scene, under its name");
    let mut session =
        Session::new((presets::presets()[0].build)(), PathBuf::new(), "tower".to_owned()).expect("a session");
    (0..250).for_each(|_| assert!(session.step(), "it falls"));
    session.handle(commands[0].clone()).expect("the folder can be written");
    click(&mut harness, "File");
    click(&mut harness, "Open state…");
    choose(&mut harness, PathUse::OpenState, &folder.path().join("a.state"));
    harness.get_by_label("A state of tower at 0.250 s");
    let opened = click(&mut harness, "Open");
    assert!(matches!(&opened[..], [Command::OpenState { path }] if path.ends_with("a.state")), "{opened:?}");
}

#[test]
fn what_another_program_wrote_is_replaced_only_after_a_question() {
    let file = Path::new("/scenes/a.ron");
    let mut harness = show(Some(file), true);
    let refuse = |harness: &mut Harness<'_, Stage>| {
        harness.state_mut().status.refused_saves += 1;
        harness.run_steps(3);
        harness.get_by_label("Changed on the disk");
    };
    refuse(&mut harness);
    assert!(click(&mut harness, "Cancel").is_empty() && !is_open(&harness, "Changed on the disk"), "left alone");
    refuse(&mut harness);
    let commands = click(&mut harness, "Replace");
    assert!(matches!(&commands[..], [Command::SaveAs { path, .. }] if path == file), "{commands:?}");
    harness.state_mut().status.refused_saves = 0;
    harness.run_steps(3);
    refuse(&mut harness);
    click(&mut harness, "Save as…");
    assert!(is_open(&harness, "Save scene as") && !is_open(&harness, "Changed on the disk"), "another name");
}

#[test]
fn a_recent_file_is_opened_from_the_menu() {
    let mut harness = show(None, false);
    harness.state_mut().ui.files.recent = vec!["/home/a/deep/cow.ron".into()];
    click(&mut harness, "File");
    harness.get_by_label_contains("Open recent").hover();
    harness.run_steps(30);
    let commands = click(&mut harness, "cow.ron");
    let [Command::Open { path }] = &commands[..] else { panic!("one file to open, not {commands:?}") };
    assert_eq!(path, Path::new("/home/a/deep/cow.ron"));
}

#[test]
fn without_changes_nothing_is_asked() {
    let mut harness = show(None, false);
    assert!(matches!(ask(&mut harness, FileAction::New)[..], [Command::New]));
    ask(&mut harness, FileAction::Quit);
    assert_eq!(harness.state().ui.files.requests, [FileRequest::Quit]);
}

#[test]
fn what_would_lose_changes_waits_for_an_answer() {
    let mut harness = show(Some(Path::new("/a.ron")), true);
    assert!(ask(&mut harness, FileAction::New).is_empty(), "it waits");
    harness.get_by_label("Unsaved changes");
    assert!(click(&mut harness, "Cancel").is_empty(), "nothing happens");
    assert!(!is_open(&harness, "Unsaved changes"), "the question is gone");
    ask(&mut harness, FileAction::New);
    assert!(matches!(click(&mut harness, "Discard")[..], [Command::New]), "now it happens");
    ask(&mut harness, FileAction::Quit);
    assert!(harness.state().ui.files.requests.is_empty(), "closing waits too");
    click(&mut harness, "Discard");
    assert_eq!(harness.state().ui.files.requests, [FileRequest::Quit]);
}

#[test]
fn a_preset_waits_too_and_goes_on_once_all_is_saved() {
    let mut harness = show(Some(Path::new("/a.ron")), true);
    click(&mut harness, "Scene");
    assert!(click(&mut harness, "incline-slide").is_empty(), "it waits");
    assert!(matches!(click(&mut harness, "Save")[..], [Command::Save { .. }]));
    assert!(is_open(&harness, "Unsaved changes"), "not saved yet: it may fail");
    harness.state_mut().status.unsaved = false;
    harness.run_steps(2);
    let commands = std::mem::take(&mut harness.state_mut().commands);
    assert!(matches!(&commands[..], [Command::Replace { title, .. }] if title == "incline-slide"), "{commands:?}");
    assert!(!is_open(&harness, "Unsaved changes"), "answered");
}

#[test]
fn a_scene_without_a_file_is_asked_for_one_before_closing() {
    let (folder, _) = folder_with_a_scene();
    let mut harness = show(None, true);
    ask(&mut harness, FileAction::Quit);
    click(&mut harness, "Save as…");
    harness.get_by_label("Save scene as");
    choose(&mut harness, PathUse::SaveScene, &folder.path().join("new"));
    let commands = click(&mut harness, "Save");
    let [Command::SaveAs { path, .. }] = &commands[..] else { panic!("saved under a name, not {commands:?}") };
    assert_eq!(*path, folder.path().join("new.ron"), "with its ending");
    harness.state_mut().status.unsaved = false;
    harness.run_steps(2);
    assert_eq!(harness.state().ui.files.requests, [FileRequest::Quit]);
}

#[test]
fn a_scene_is_collected_into_a_new_folder() {
    let (folder, file) = folder_with_a_scene();
    let mut harness = show(Some(&file), false);
    click(&mut harness, "File");
    click(&mut harness, "Collect…");
    harness.get_by_label("Collect the scene and its models");
    choose(&mut harness, PathUse::Collect, folder.path());
    assert!(click(&mut harness, "Collect").is_empty(), "a folder that is not empty is left alone");
    choose(&mut harness, PathUse::Collect, &folder.path().join("mine"));
    let commands = click(&mut harness, "Collect");
    let [Command::Collect { folder: made, .. }] = &commands[..] else { panic!("one folder, not {commands:?}") };
    assert_eq!(*made, folder.path().join("mine"));
}

#[test]
fn a_scene_is_saved_with_its_models_inside_where_it_has_some() {
    let (folder, file) = folder_with_a_scene();
    let mut harness = show(Some(&file), false);
    ask(&mut harness, FileAction::SaveAs);
    assert!(harness.query_by_label("With its models inside").is_none(), "it has no model");
    harness.key_press(egui::Key::Escape);
    harness.run_steps(3);
    harness.state_mut().status.chooses_models = true;
    ask(&mut harness, FileAction::SaveAs);
    click(&mut harness, "With its models inside");
    choose(&mut harness, PathUse::SaveScene, &folder.path().join("whole"));
    let commands = click(&mut harness, "Save");
    let [Command::SaveAs { models, .. }] = &commands[..] else { panic!("saved under a name, not {commands:?}") };
    assert_eq!(*models, ModelPlace::Inside);
}

#[test]
fn a_path_is_judged_while_it_is_typed() {
    let (folder, file) = folder_with_a_scene();
    let mut harness = show(None, false);
    ask(&mut harness, FileAction::Open);
    let missing = folder.path().join("b.ron");
    choose(&mut harness, PathUse::OpenScene, &missing);
    harness.get_by_label(&format!("{} does not exist", missing.display()));
    assert!(click(&mut harness, "Open").is_empty(), "there is nothing to open");
    choose(&mut harness, PathUse::OpenScene, &file);
    harness.get_by_label("A scene of 0 bodies and 0 obstacles");
    let commands = click(&mut harness, "Open");
    assert!(matches!(&commands[..], [Command::Open { path }] if *path == file), "{commands:?}");
    assert!(!is_open(&harness, "Open scene"), "the dialog is closed");
}

#[test]
fn a_path_is_typed_and_entered_with_the_keyboard_alone() {
    let (folder, file) = folder_with_a_scene();
    let mut harness = show(Some(&folder.path().join("none.ron")), false);
    ask(&mut harness, FileAction::Open);
    harness.get_by_label("Path").type_text("a.ron");
    harness.run_steps(2);
    harness.key_press(egui::Key::Enter);
    harness.run_steps(3);
    let commands = &harness.state().commands;
    assert!(matches!(&commands[..], [Command::Open { path }] if *path == file), "{commands:?}");
}

#[test]
fn folders_are_walked_by_clicks_and_a_file_that_is_there_is_replaced_knowingly() {
    let (folder, file) = folder_with_a_scene();
    std::fs::create_dir(folder.path().join("deep")).expect("a folder");
    let mut harness = show(Some(&folder.path().join("deep/x.ron")), false);
    ask(&mut harness, FileAction::SaveAs);
    click(&mut harness, "Up one folder");
    click(&mut harness, "a.ron");
    let commands = click(&mut harness, "Replace");
    assert!(matches!(&commands[..], [Command::SaveAs { path, .. }] if *path == file), "{commands:?}");
}

#[test]
fn escape_closes_a_dialog_and_keeps_the_changes() {
    let mut harness = show(None, true);
    ask(&mut harness, FileAction::New);
    harness.key_press(egui::Key::Escape);
    harness.run_steps(3);
    assert!(!is_open(&harness, "Unsaved changes") && harness.state().commands.is_empty(), "as with Cancel");
    ask(&mut harness, FileAction::Open);
    harness.key_press(egui::Key::Escape);
    harness.run_steps(3);
    assert!(!is_open(&harness, "Open scene"), "closed");
}

#[test]
fn what_was_found_after_a_crash_is_offered() {
    let mut harness = show(None, false);
    harness.state_mut().ui.files.found = Some(FoundDraft { title: "tower".into(), when: "14:32".into() });
    harness.run_steps(2);
    harness.get_by_label("Recover unsaved changes of tower from 14:32?");
    click(&mut harness, "Recover");
    assert_eq!(harness.state().ui.files.requests, [FileRequest::Recover]);
    harness.state_mut().ui.files.requests.clear();
    harness.state_mut().status.unsaved = true;
    click(&mut harness, "Recover");
    assert!(harness.state().ui.files.requests.is_empty(), "there are new changes: it waits for an answer");
    harness.get_by_label("Unsaved changes");
}

/// The places of things that must stay where they are.
pub(crate) fn places(harness: &Harness<'_, Stage>, labels: &[&str]) -> Vec<egui::Rect> {
    labels.iter().map(|label| harness.get_all_by_label(label).next().expect("it is there").rect()).collect()
}

#[test]
fn a_dialog_stands_still_whatever_is_typed_and_found() {
    let (folder, file) = folder_with_a_scene();
    let at = |name: &str| folder.path().join(name);
    std::fs::create_dir_all(at("empty")).expect("a folder");
    std::fs::create_dir_all(at("full")).expect("a folder");
    for number in 0..40 {
        std::fs::copy(&file, at(&format!("full/{number}.ron"))).expect("a file");
    }
    std::fs::write(at("cow.obj"), "v 0 0 0").expect("a file");
    let long = "a rather long name of a folder that is not there/".repeat(8);
    let mut harness = show(None, false);
    harness.state_mut().ui.files.recent = vec!["/home/a/deep/cow.ron".into()];
    ask(&mut harness, FileAction::Open);
    let labels = ["Open scene", "Browse…", "Recent", "Cancel"];
    let still = places(&harness, &labels);
    for path in [at("empty/"), at("full/"), at("a.ron"), at("cow.obj"), at("none.ron"), at(&long)] {
        choose(&mut harness, PathUse::OpenScene, &path);
        assert_eq!(places(&harness, &labels), still, "with {}", path.display());
    }
    assert!(harness.query_by_label_contains("xdg-desktop-portal").is_none(), "nobody knows yet");
    harness.state_mut().ui.files.has_no_browser();
    harness.run_steps(3);
    assert_eq!(places(&harness, &labels), still, "once the system is known to have no window of its own");
    harness.get_by_label_contains("xdg-desktop-portal");
}

#[test]
fn a_click_in_the_list_leaves_the_keyboard_to_the_field() {
    let (folder, file) = folder_with_a_scene();
    let mut harness = show(Some(&folder.path().join("none.ron")), false);
    ask(&mut harness, FileAction::Open);
    click(&mut harness, "a.ron");
    harness.key_press(egui::Key::Enter);
    harness.run_steps(3);
    let commands = &harness.state().commands;
    assert!(matches!(&commands[..], [Command::Open { path }] if *path == file), "{commands:?}");
}

#[test]
fn a_path_that_cannot_be_used_leaves_the_keyboard_to_the_field() {
    let (folder, file) = folder_with_a_scene();
    std::fs::create_dir(folder.path().join("sub.ron")).expect("a folder");
    let mut harness = show(Some(&file), false);
    ask(&mut harness, FileAction::SaveAs);
    for (name, why) in [("sub.ron", "sub.ron is a folder"), ("none/a.ron", "does not exist")] {
        choose(&mut harness, PathUse::SaveScene, &folder.path().join(name));
        harness.key_press(egui::Key::Enter);
        harness.run_steps(3);
        assert!(harness.query_by_label_contains(why).is_some(), "{why}");
        assert!(harness.get_by_label("Path").is_focused(), "{name}: typing goes on");
        assert!(harness.state().commands.is_empty(), "{name}: nothing is saved");
    }
}

#[test]
fn a_dialog_is_as_high_as_what_it_holds() {
    let heights = |heading: &str, last: &str, harness: &Harness<'_, Stage>| {
        let rects = places(harness, &[heading, last]);
        rects[1].bottom() - rects[0].top()
    };
    let mut harness = show(None, true);
    ask(&mut harness, FileAction::New);
    let question = heights("Unsaved changes", "Cancel", &harness);
    assert!(question < 140.0, "a sentence and a row of buttons: {question}");
    click(&mut harness, "Cancel");
    ask(&mut harness, FileAction::Open);
    let open = heights("Open scene", "Cancel", &harness);
    assert!(open < 360.0, "a field, a list and a row of buttons: {open}");
}
