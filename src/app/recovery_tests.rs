//! Drafts without a window: kept, found, claimed once, removed in time.

use super::*;
use crate::scene::presets;

const PATIENCE: Duration = Duration::from_secs(20);

fn draft(title: &str) -> Draft {
    Draft {
        scene: Arc::new(presets::ground_only()),
        camera: CameraSettings { distance: 7.0, ..CameraSettings::default() },
        base_dir: PathBuf::new(),
        title: title.to_owned(),
        file: Some("/home/a/b.ron".into()),
        on_disk: Some(u64::MAX),
    }
}

fn wait_until(what: &str, holds: impl Fn() -> bool) {
    let until = Instant::now() + PATIENCE;
    while !holds() {
        assert!(Instant::now() < until, "not within {PATIENCE:?}: {what}");
        std::thread::sleep(Duration::from_millis(10));
    }
}

fn drafts_in(folder: &Path) -> usize {
    let entries = fs::read_dir(folder).expect("a folder").filter_map(Result::ok);
    entries.filter(|entry| entry.path().extension().is_some_and(|ending| ending == "ron")).count()
}

/// Leaves a draft behind as a killed program does.
fn leave_behind(folder: &Path, pid: u32, title: &str) {
    fs::write(folder.join(format!("{pid}.lock")), "").expect("a file");
    write(&draft(title), &folder.join(format!("{pid}.ron"))).expect("a draft");
}

#[test]
fn a_draft_is_kept_and_goes_when_the_scene_is_saved_or_the_window_closed() {
    let folder = tempfile::tempdir().expect("a folder");
    let keeper = Keeper::start(folder.path(), Duration::ZERO).expect("the folder can be written");
    keeper.keep(draft("a"));
    wait_until("a draft is kept", || drafts_in(folder.path()) == 1);
    keeper.forget();
    wait_until("saved, the draft goes", || drafts_in(folder.path()) == 0);
    keeper.keep(draft("b"));
    wait_until("another draft is kept", || drafts_in(folder.path()) == 1);
    keeper.close(false);
    assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 0, "nothing is left after a clean close");
}

#[test]
fn a_program_that_failed_leaves_its_draft() {
    let folder = tempfile::tempdir().expect("a folder");
    let keeper = Keeper::start(folder.path(), Duration::from_mins(10)).expect("the folder can be written");
    keeper.keep(draft("a"));
    keeper.close(true);
    assert_eq!(find(folder.path()).len(), 1, "written at the last moment, and free to be claimed");
}

#[test]
fn the_draft_of_a_living_program_is_nobody_elses() {
    let folder = tempfile::tempdir().expect("a folder");
    let keeper = Keeper::start(folder.path(), Duration::ZERO).expect("the folder can be written");
    let second = Keeper::start(folder.path(), Duration::ZERO).expect("two windows have two names");
    keeper.keep(draft("a"));
    second.keep(draft("b"));
    wait_until("both drafts are kept", || drafts_in(folder.path()) == 2);
    assert_eq!(find(folder.path()).len(), 0, "both live");
}

#[test]
fn the_draft_of_a_dead_program_is_offered_to_one() {
    let folder = tempfile::tempdir().expect("a folder");
    leave_behind(folder.path(), 1, "a");
    let found = find(folder.path());
    let [one] = &found[..] else { panic!("one draft, not {found:?}") };
    assert_eq!((one.title.as_str(), one.file.as_deref()), ("a", Some(Path::new("/home/a/b.ron"))));
    assert_eq!(one.on_disk, Some(u64::MAX), "its file is known again");
    assert!((one.scene.view.camera.distance - 7.0).abs() < 1e-12, "with the camera");
    assert_eq!(find(folder.path()).len(), 0, "it is taken");
    drop(found);
    let again = find(folder.path());
    assert_eq!(again.len(), 1, "not answered, it is offered again");
    again.into_iter().for_each(Found::discard);
    assert_eq!(find(folder.path()).len(), 0, "discarded");
}

#[test]
fn what_is_recovered_goes_only_when_it_is_kept_anew() {
    let folder = tempfile::tempdir().expect("a folder");
    leave_behind(folder.path(), 1, "a");
    let found = find(folder.path()).pop().expect("one draft");
    let keeper = Keeper::start(folder.path(), Duration::ZERO).expect("the folder can be written");
    keeper.adopt(found);
    std::thread::sleep(Duration::from_millis(50));
    assert!(folder.path().join("1.ron").exists(), "a crash now would lose nothing");
    keeper.keep(draft("a"));
    wait_until("the new draft takes its place", || !folder.path().join("1.ron").exists());
    assert_eq!(drafts_in(folder.path()), 1, "there is one");
}

#[test]
fn a_draft_that_nobody_could_read_leaves_the_one_before() {
    let folder = tempfile::tempdir().expect("a folder");
    leave_behind(folder.path(), 1, "a");
    let camera = CameraSettings { fov_deg: 130.0, ..CameraSettings::default() };
    let refused =
        write(&Draft { camera, ..draft("b") }, &folder.path().join("1.ron")).expect_err("too wide").to_string();
    assert_eq!(refused, "draft: view.camera.fov_deg = 130 ° is outside 5 … 120 °");
    assert_eq!(find(folder.path())[0].title, "a", "it is still there");
}

#[test]
fn damaged_drafts_are_passed_over() {
    let folder = tempfile::tempdir().expect("a folder");
    leave_behind(folder.path(), 1, "a");
    let whole = fs::read_to_string(folder.path().join("1.ron")).expect("a draft");
    for (pid, text) in [(2, &whole[..whole.len() / 2]), (3, "(version: 1)"), (4, ""), (5, "// draft {}\n(version: 1)")]
    {
        fs::write(folder.path().join(format!("{pid}.ron")), text).expect("a file");
    }
    assert_eq!(find(folder.path()).len(), 1, "only the whole one is found");
}

#[test]
fn the_time_is_told_with_the_day_unless_it_was_today() {
    let now: Zoned = "2026-11-21T15:00:00+00:00[UTC]".parse().expect("a time");
    let secs = now.timestamp().as_second();
    assert_eq!(when(secs - 28 * 60, &now), "14:32");
    assert_eq!(when(secs - 24 * 3600, &now), "15:00 on 20 November");
    assert_eq!(when(i64::MAX, &now), "an unknown time");
}

#[cfg(target_os = "linux")]
#[test]
fn a_pipe_among_the_drafts_is_passed_over() {
    let folder = tempfile::tempdir().expect("a folder");
    leave_behind(folder.path(), 1, "sound");
    leave_behind(folder.path(), 2, "with a pipe for its lock");
    fs::remove_file(folder.path().join("2.lock")).expect("it was there");
    for name in ["2.lock", "3.ron"] {
        let made = std::process::Command::new("mkfifo").arg(folder.path().join(name)).status().expect("mkfifo runs");
        assert!(made.success(), "a pipe");
    }
    let titles: Vec<String> = find(folder.path()).into_iter().map(|found| found.title).collect();
    assert_eq!(titles, ["sound"], "without waiting for anyone");
}
