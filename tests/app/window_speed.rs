//! The speed that drawing the window leaves to the simulation, on the machine's own processors, and the window's cost at
//! rest.

use std::process::Command;
use std::time::Duration;

use super::shot::Shot;
use super::window::{Window, alone};

/// The least speed of the simulation beside its window, as a share of its speed alone.
const SHARE: f64 = 0.5;
/// The real-time factor of a simulation that keeps up; it never runs faster than asked.
const KEEPS_UP: f64 = 0.95;

/// Simulated seconds per second without a window.
fn speed_alone() -> f64 {
    let output = Command::new(env!("CARGO_BIN_EXE_gelatin"))
        .args(["run", "cube-on-plane", "--seconds", "4", "--json"])
        .output()
        .expect("the program starts");
    let figures: serde_json::Value = serde_json::from_slice(&output.stdout).expect("figures in JSON");
    figures["real_time_factor"].as_f64().expect("a number")
}

/// The real-time factors that the window has shown, from its log.
fn factors(log: &str) -> Vec<f64> {
    let before = log.lines().filter_map(|line| line.split_once(" x real time"));
    before.filter_map(|(before, _)| before.rsplit(' ').next()?.parse().ok()).collect()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[test]
fn the_window_leaves_the_simulation_half_of_what_it_makes_alone() {
    alone(|| {
        let before = speed_alone();
        let mut window = Window::open("cube-on-plane", None);
        window.key("r");
        let said = window.log().len();
        std::thread::sleep(Duration::from_secs(6));
        let shown = factors(&window.log()[said..]);
        window.still_runs();
        drop(window);
        let alone = 0.5 * (before + speed_alone());
        assert!(shown.len() >= 5, "the factor was told again and again: {shown:?}");
        let shown = median(shown);
        let least = KEEPS_UP.min(SHARE * alone);
        assert!(shown >= least, "{shown} x real time in the window, {alone} x without");
    });
}

#[test]
fn a_window_in_which_everything_sleeps_draws_nothing() {
    alone(|| {
        let mut window = Window::open("u-on-sphere", None);
        window.wait_until_still();
        std::thread::sleep(Duration::from_secs(1));
        let before = window.cpu_ticks();
        std::thread::sleep(Duration::from_secs(4));
        let used = window.cpu_ticks() - before;
        assert!(used <= 8, "{used} hundredths of a second of processor time in four seconds at rest");
    });
}

#[test]
fn panels_drawn_in_parts_look_like_panels_drawn_at_once() {
    alone(|| {
        let mut window = Window::open("u-on-sphere", None);
        window.wait_until_still();
        // Buttons light up and fade, a menu opens and closes, a new choice changes the inspector.
        for at in [[60, 20], [300, 20], [60, 720], [1150, 120], [1150, 300], [700, 780]] {
            window.point_at(at);
            std::thread::sleep(Duration::from_millis(150));
        }
        window.click("1", [30, 20]);
        window.wait_until_still();
        window.key("Escape");
        window.click("1", [60, 80]);
        window.point_at([560, 100]);
        window.wait_until_still();
        let in_parts = window.shot();
        window.hide_and_show();
        // A busy machine leaves it black for a while, which is still, too.
        window.wait_until("it is drawn again", Shot::has_bottom_bar);
        window.wait_until_still();
        let at_once = window.shot();
        let left = at_once.difference(&in_parts, at_once.whole());
        assert_eq!(left, 0, "pixels are left of what the panels showed before");
    });
}

#[test]
fn factors_are_read_from_a_log() {
    let log = "[now DEBUG gelatin::app::shell::drawing] 0.831 x real time, 25 frames a second, 0.4 of the processors, at 1\n\
               [now INFO  gelatin::app::canvas] drawing with llvmpipe\n";
    assert_eq!(factors(log), [0.831]);
    assert_eq!(factors("no such line"), [0.0; 0]);
}
