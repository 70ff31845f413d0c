//! The program killed at random moments while it writes: the file on the disk is whole, either the old one or the new one.

use std::process::{Command, Stdio};
use std::time::Instant;

use gelatin::math::rng::Rng;

use crate::program::Folder;

/// Number of kills; `GELATIN_KILLS` asks for more.
fn kills() -> u64 {
    std::env::var("GELATIN_KILLS").ok().and_then(|text| text.parse().ok()).unwrap_or(8)
}

/// A cube whose state is some megabytes long.
const LARGE: &str = "(version: 1, bodies: [(shape: cube(cells: 36))])";
const LINE: &str = "run large.ron --seconds 0 --save-state kept.state";

#[test]
fn a_state_is_whole_whenever_the_program_is_killed() {
    let folder = Folder::new();
    folder.write("large.ron", LARGE);
    let begin = Instant::now();
    assert_eq!(folder.run(LINE).code, Some(0), "it is saved");
    let (whole, first) = (begin.elapsed(), std::fs::read(folder.path("kept.state")).expect("a state"));
    let mut rng = Rng::new(9);
    let mut survived = 0;
    for kill in 0..kills() {
        let mut child = Command::new(env!("CARGO_BIN_EXE_gelatin"))
            .args(LINE.split(' '))
            .current_dir(folder.path(""))
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the program starts");
        // The program writes at its end.
        std::thread::sleep(whole.mul_f64(rng.between(0.5, 1.1)));
        survived += u64::from(child.try_wait().expect("a child").is_some());
        child.kill().expect("ours");
        child.wait().expect("ours");
        let kept = std::fs::read(folder.path("kept.state")).expect("there is always one");
        assert!(kept == first, "kill {kill}: a state is the same whenever it is saved, and this one is not");
    }
    eprintln!("{} runs of {whole:?} killed, {survived} had ended", kills());
    assert!(survived < kills(), "some were killed on the way");
    let again = folder.run("run large.ron --seconds 0 --from-state kept.state");
    assert_eq!(again.code, Some(0), "it is taken up: {again:?}");
}
