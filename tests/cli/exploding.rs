//! A simulation that explodes: the same exit code and the same words for every command.

use crate::bad_input::FAILED;
use crate::program::Folder;

/// The scene's own step is too large for its springs.
const WHY: &str = "too large for structural stiffness of 1010 N";

#[test]
fn run_and_render_fail_and_say_why() {
    let folder = Folder::new();
    for line in ["run exploding --seconds 1", "render exploding --at 1 --size 64x64 -o boom.png"] {
        let ran = folder.run(line);
        assert_eq!(ran.code, Some(FAILED), "{line}: {ran:?}");
        let error = ran.notes.lines().find(|note| note.starts_with("error: ") && note.contains(WHY));
        assert!(error.is_some(), "{line}: {ran:?}");
        assert_eq!(ran.notes.matches(WHY).count(), 1, "{line} says it once: {ran:?}");
    }
    assert!(!folder.path("boom.png").exists(), "there is no picture of it");
}

#[test]
fn the_figures_of_a_run_that_explodes_are_printed_all_the_same() {
    let folder = Folder::new();
    let ran = folder.run("run exploding --seconds 1 --save-state last.state --json");
    let figures: serde_json::Value = serde_json::from_str(&ran.figures).expect("one object");
    assert_eq!((ran.code, &figures["finite"]), (Some(FAILED), &false.into()), "{ran:?}");
    assert!(figures["trouble"].as_str().is_some_and(|words| words.contains(WHY)), "{figures}");
    assert!(folder.path("last.state").exists(), "the last good state is kept");
    let sound = folder.json("run exploding --seconds 0.01 --stepping auto --json");
    assert_eq!((&sound["finite"], &sound["trouble"]), (&true.into(), &serde_json::Value::Null), "{sound}");
}

#[test]
fn the_exit_codes_are_in_the_help() {
    let help = Folder::new().run("--help");
    assert!(help.figures.contains("also where `run` or `render` explodes"), "{help:?}");
}
