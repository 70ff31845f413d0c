//! The window killed at random moments of editing and saving: no file is ever half written, and at most the last five
//! seconds are lost.

use std::path::Path;
use std::time::{Duration, Instant};

use gelatin::math::rng::Rng;
use gelatin::scene::{Scene, presets};

use super::window::{Window, alone};

/// The most that may be lost.
const LOST: Duration = Duration::from_secs(5);

/// Number of kills; `GELATIN_KILLS` asks for more.
fn kills() -> u64 {
    std::env::var("GELATIN_KILLS").ok().and_then(|text| text.parse().ok()).unwrap_or(2)
}

#[test]
fn a_window_that_is_killed_loses_five_seconds_at_most_and_leaves_whole_files() {
    alone(|| {
        let mut rng = Rng::new(50);
        for kill in 0..kills() {
            let folder = tempfile::tempdir().expect("a folder");
            let file = folder.path().join("tower.ron");
            (presets::presets()[0].build)().save(&file).expect("a scene file");
            let at_first = Scene::load(&file).expect("a scene").obstacles.len();
            let window = Window::open(&file.display().to_string(), Some(folder.path()));
            let mut edits = Vec::new();
            let end = Instant::now() + Duration::from_secs_f64(rng.between(0.5, 12.0));
            while Instant::now() < end {
                window.add_sphere();
                edits.push(Instant::now());
                if rng.unit() < 0.3 {
                    window.key("ctrl+s");
                }
                let pause = Duration::from_secs_f64(rng.between(0.0, 1.5));
                std::thread::sleep(pause.min(end.saturating_duration_since(Instant::now())));
            }
            drop(window);
            let killed = Instant::now();
            let kept = drafts(folder.path()).chain([file.clone()]).map(|path| {
                let text = std::fs::read_to_string(&path).expect("a file");
                let scene =
                    Scene::from_ron(&text, "kept").unwrap_or_else(|error| panic!("{}: {error}", path.display()));
                scene.obstacles.len() - at_first
            });
            let kept = kept.max().expect("there is the file");
            let safe = edits.iter().filter(|edit| killed - **edit > LOST).count();
            eprintln!("kill {kill}: {} edits, {safe} of them old enough, {kept} kept", edits.len());
            assert!(kept >= safe, "kill {kill}: {kept} of {} edits kept, {safe} were old enough", edits.len());
        }
    });
}

fn drafts(state: &Path) -> impl Iterator<Item = std::path::PathBuf> {
    let entries = std::fs::read_dir(state.join("gelatin/drafts")).into_iter().flatten();
    let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
    paths.filter(|path| path.extension().is_some_and(|ending| ending == "ron"))
}
