//! Files in the real window: saved by the keyboard alone, asked about before closing, found again after a kill.

use std::path::Path;
use std::time::Duration;

use gelatin::app::ui::files::MAIN_FILL;
use gelatin::scene::{Scene, presets};

use super::window::{Window, alone};
use super::worker_stop::HEAVY;

/// A point of the view where a body in the middle is, pixels.
const MIDDLE: [i32; 2] = [620, 420];

#[test]
fn a_scene_is_saved_edited_killed_and_recovered() {
    alone(|| {
        let folder = tempfile::tempdir().expect("a folder");
        let (state, file) = (folder.path(), folder.path().join("tower.ron"));
        let window = Window::open("cube-on-plane", Some(state));
        save_as(&window, &file);
        window.add_sphere();
        window.wait_for("the title has a mark", |window| window.title() == "• tower.ron — Gelatin");
        window.wait_for("a draft is kept", |_| drafts(state) == 1);
        // The program is killed, as if for lack of memory, so nothing is tidied up.
        drop(window);
        assert_eq!(drafts(state), 1, "the draft outlives the program");
        let mut window = Window::open("cube-on-plane", Some(state));
        window.click_color(main_fill());
        window.wait_for("the scene is back", |window| window.title() == "• tower.ron — Gelatin");
        window.key("ctrl+s");
        window.wait_for("it is saved", |window| window.title() == "tower.ron — Gelatin");
        let saved = std::fs::read_to_string(&file).expect("the scene file");
        assert!(saved.contains("Sphere 2"), "with the sphere added before the kill: {saved}");
        window.wait_for("no draft is left", |_| drafts(state) == 0);
    });
}

#[test]
fn closing_asks_about_changes_and_enter_saves_them() {
    alone(|| {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("tower.ron");
        let mut window = Window::open("cube-on-plane", Some(folder.path()));
        save_as(&window, &file);
        window.add_sphere();
        window.wait_for("the title has a mark", |window| window.title() == "• tower.ron — Gelatin");
        window.key("ctrl+q");
        std::thread::sleep(Duration::from_secs(1));
        assert!(!window.has_ended(), "it asks first");
        window.key("Escape");
        window.wait_until("the question is gone", |shot| shot.places_of(main_fill()).is_empty());
        window.key("ctrl+q");
        window.wait_until("the question is back", |shot| !shot.places_of(main_fill()).is_empty());
        window.key("Return");
        let mut patience = 100;
        while !window.has_ended() && patience > 0 {
            std::thread::sleep(Duration::from_millis(200));
            patience -= 1;
        }
        assert!(window.has_ended(), "saved and closed");
        let saved = std::fs::read_to_string(&file).expect("the scene file");
        assert!(saved.contains("Sphere 2"), "with the sphere: {saved}");
        assert_eq!(drafts(folder.path()), 0, "nothing is left to recover");
    });
}

#[test]
fn what_was_arranged_is_found_at_the_next_start() {
    /// A pixel that lies in the list once it is wider, and in the view before that.
    const BESIDE: [i32; 2] = [240, 400];
    alone(|| {
        let folder = tempfile::tempdir().expect("a folder");
        let mut window = Window::open("cube-on-plane", Some(folder.path()));
        let panel = window.shot().at([100, 400]);
        assert_ne!(window.shot().at(BESIDE), panel, "the view begins left of it");
        window.drag("1", [191, 400], [260, 400]);
        window.wait_until("the list is wider", |shot| shot.at(BESIDE) == panel);
        let kept = folder.path().join("gelatin/preferences.json");
        window.wait_for("the width is kept", |_| kept.is_file());
        // The program is killed, as if for lack of memory.
        drop(window);
        let mut window = Window::open("cube-on-plane", Some(folder.path()));
        window.wait_until("the list is as wide again", |shot| shot.at(BESIDE) == panel);
        drop(window);
        std::fs::write(&kept, "{\"widths\": {\"li").expect("a file");
        let mut window = Window::open("cube-on-plane", Some(folder.path()));
        window.wait_until("a damaged file is as none", |shot| shot.at(BESIDE) != panel);
    });
}

#[test]
fn values_given_at_the_start_are_an_unsaved_change_of_a_file_and_of_nothing_else() {
    alone(|| {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("tower.ron");
        (presets::presets()[0].build)().save(&file).expect("a scene file");
        let options = "--dt 0.002 --set bodies.0.name=Tower";
        let window = Window::open(&format!("{} {options}", file.display()), Some(folder.path()));
        window.wait_for("the title has a mark", |window| window.title() == "• tower.ron — Gelatin");
        window.key("ctrl+s");
        window.wait_for("it is saved", |window| window.title() == "tower.ron — Gelatin");
        let saved = Scene::load(&file).expect("the scene file");
        assert_eq!((saved.settings.dt, saved.bodies[0].name.as_str()), (0.002, "Tower"), "with the values given");
        drop(window);
        let window = Window::open(&format!("cube-on-plane {options}"), Some(folder.path()));
        window.wait_for("the title has no mark", |window| window.title() == "cube-on-plane — Gelatin");
    });
}

#[test]
fn two_changes_during_a_substep_of_seconds_are_both_made() {
    alone(|| {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("tower.ron");
        std::fs::write(&file, HEAVY).expect("a scene file");
        let window = Window::open(&file.to_string_lossy(), Some(folder.path()));
        window.click("1", MIDDLE);
        window.key("h");
        window.key("F2");
        window.key("ctrl+a");
        window.type_text("Slow");
        window.key("Return");
        window.wait_for("the title has a mark", |window| window.title() == "• tower.ron — Gelatin");
        window.key("ctrl+s");
        window.wait_for("it is saved", |window| window.title() == "tower.ron — Gelatin");
        let text = std::fs::read_to_string(&file).expect("the scene file");
        let saved = Scene::from_ron(&text, "tower.ron").expect("a scene");
        assert!(saved.bodies[0].hidden && saved.bodies[0].name == "Slow", "{:?}", saved.bodies[0]);
    });
}

fn save_as(window: &Window, file: &Path) {
    window.key("ctrl+s");
    window.key("ctrl+a");
    window.type_text(&file.to_string_lossy());
    window.key("Return");
    window.wait_for("the scene is saved", |window| window.title() == "tower.ron — Gelatin");
}

fn drafts(state: &Path) -> usize {
    let Ok(entries) = std::fs::read_dir(state.join("gelatin/drafts")) else { return 0 };
    entries
        .filter_map(Result::ok)
        .filter(|entry| entry.path().extension().is_some_and(|ending| ending == "ron"))
        .count()
}

fn main_fill() -> [u8; 3] {
    let [red, green, blue, _] = MAIN_FILL.to_array();
    [red, green, blue]
}
