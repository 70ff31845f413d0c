//! The real program in a real window under a virtual display, driven by real mouse and keys, judged by screenshots.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use gelatin::app::input::ViewRect;
use glam::Vec2;

use crate::shot::Shot;

/// Pause between two events of the mouse. Sent in one burst they would fall into one frame, and a drag would be missed.
const HAND: Duration = Duration::from_millis(300);
/// The longest wait for the program, even on a busy machine.
const PATIENCE: Duration = Duration::from_mins(1);
/// A pixel of the view, away from the panels and from everything over the view.
pub(super) const IN_VIEW: [i32; 2] = [640, 200];
/// A pixel of the jelly of the default scene, at the start and once it has landed, in a window of 1280 × 800.
pub(super) const JELLY: [i32; 2] = [480, 370];
/// The picture without its panels and bars.
const BETWEEN_PANELS: ViewRect = ViewRect { origin: Vec2::new(200.0, 60.0), size: Vec2::new(720.0, 600.0) };
/// A part of the view well above the resting jelly.
const HIGH: ViewRect = ViewRect { origin: Vec2::new(360.0, 60.0), size: Vec2::new(240.0, 220.0) };
/// The field for the stiffness of the structural springs.
const STIFFNESS: [i32; 2] = [1218, 185];
/// The button that adds a sphere.
const ADD_SPHERE: [i32; 2] = [137, 683];
/// The panel of values.
pub(super) const VALUES: ViewRect = ViewRect { origin: Vec2::new(950.0, 45.0), size: Vec2::new(325.0, 700.0) };
/// The list of bodies and obstacles.
const LIST: ViewRect = ViewRect { origin: Vec2::new(4.0, 45.0), size: Vec2::new(180.0, 400.0) };
/// Only one window at a time: screenshots of two would time out on a small machine.
pub(crate) static ALONE: Mutex<()> = Mutex::new(());

#[test]
fn the_picture_lives_while_playing_and_stands_still_when_paused() {
    with_window("cube-on-sphere", |window| {
        let first = window.shot();
        window.wait_until("the picture moves", |shot| shot.differs(&first, shot.view()));
        window.key("space");
        window.wait_until_still();
        let paused = window.shot();
        std::thread::sleep(Duration::from_secs(1));
        assert!(!window.shot().differs(&paused, paused.whole()), "a paused window does not change by a pixel");
        window.key("period");
        window.wait_until("one step changes the time shown", |shot| shot.differs(&paused, shot.whole()));
    });
}

#[test]
fn a_paused_window_uses_no_processor() {
    with_window("cube-on-plane", |window| {
        window.key("space");
        window.wait_until_still();
        let before = window.cpu_ticks();
        std::thread::sleep(Duration::from_secs(2));
        let used = window.cpu_ticks() - before;
        assert!(used <= 4, "{used} hundredths of a second of processor time in two idle seconds");
    });
}

#[test]
fn dragging_turns_the_view_and_f_comes_back_to_the_jelly() {
    with_window("cube-on-plane", |window| {
        window.key("space");
        window.wait_until_still();
        for button in ["1", "2", "3"] {
            let before = window.shot();
            window.drag(button, IN_VIEW, [IN_VIEW[0] + 120, IN_VIEW[1] + 30]);
            window.wait_until("a drag moves the picture", |shot| shot.differs(&before, shot.view()));
        }
        let before = window.shot();
        window.click("4", IN_VIEW);
        window.wait_until("the wheel moves the picture", |shot| shot.differs(&before, shot.view()));
        window.key("f");
        window.wait_until("the jelly is in sight", |shot| shot.jelly_share() > 0.02);
    });
}

#[test]
fn a_drag_on_a_panel_leaves_the_picture_alone() {
    with_window("cube-on-plane", |window| {
        window.key("space");
        window.wait_until_still();
        let before = window.shot();
        let bar = window.size[1] - 20;
        window.drag("2", [500, bar], [700, bar - 200]);
        window.click("4", [500, bar]);
        window.point_at(IN_VIEW);
        std::thread::sleep(HAND);
        let after = window.shot();
        assert!(!after.differs(&before, after.view()), "the view has not moved");
    });
}

#[test]
fn colours_get_a_legend_and_the_list_of_keys_opens() {
    with_window("cube-on-plane", |window| {
        window.key("space");
        window.wait_until_still();
        let plain = window.shot();
        window.key("2");
        window.wait_until("the jelly is coloured", |shot| shot.differs(&plain, shot.view()));
        window.wait_until_still();
        let colored = window.shot();
        window.key("F1");
        window.wait_until("the keys are listed", |shot| shot.differs(&colored, shot.view()));
    });
}

#[test]
fn the_picture_follows_the_size_of_the_window() {
    with_window("cube-on-plane", |window| {
        for size in [[900, 600], [1600, 900], [820, 460]] {
            window.resize(size);
            window.wait_until("the jelly is in sight", |shot| shot.size == size && shot.jelly_share() > 0.005);
            window.wait_until("the bar at the bottom has moved along", Shot::has_bottom_bar);
        }
    });
}

#[test]
fn the_jelly_is_pulled_chosen_and_the_pull_ends_with_the_button() {
    with_window("cube-on-plane", |window| {
        std::thread::sleep(4 * HAND);
        let [x, y] = JELLY;
        window.point_at([x, y]);
        window.hand(&["mousedown", "1"]);
        window.point_at([x + 20, y - 60]);
        window.point_at([x, y - 260]);
        window.wait_until("the jelly hangs from the pointer", |shot| shot.jelly_share_of(HIGH) > 0.1);
        let swings = window.view_lives();
        window.hand(&["mouseup", "1"]);
        // It is thrown in the direction of its swing, and comes to rest whatever the pointer does.
        window.wait_for_view_at_rest();
        window.point_at([x, y - 100]);
        assert!(swings && !window.view_lives(), "it swings while it is held, and lies when it is not");
    });
}

#[test]
fn a_click_chooses_typing_changes_and_undo_takes_back() {
    with_window("cube-on-plane", |window| {
        window.key("space");
        window.wait_until_still();
        let nothing = window.shot();
        window.click("1", JELLY);
        window.wait_until("its values are shown", |shot| shot.differs(&nothing, VALUES));
        window.wait_until_still();
        let chosen = window.shot();
        window.click("1", STIFFNESS);
        window.hand(&["type", "--delay", "60", "2000"]);
        window.key("Return");
        window.wait_until("the value is another", |shot| shot.differs(&chosen, VALUES));
        window.point_at(IN_VIEW);
        window.key("ctrl+z");
        window.wait_until("the value is back", |shot| !shot.differs(&chosen, VALUES));
    });
}

#[test]
fn an_added_sphere_is_in_the_list_and_goes_with_delete() {
    with_window("cube-on-plane", |window| {
        window.key("space");
        window.wait_until_still();
        let before = window.shot();
        window.add_sphere();
        window.wait_until("the list is longer", |shot| shot.differs(&before, LIST));
        window.point_at(IN_VIEW);
        window.key("Delete");
        window.wait_until("the list is as it was", |shot| !shot.differs(&before, LIST));
    });
}

#[test]
fn without_a_display_there_is_a_sentence_and_no_panic() {
    let output = Command::new(env!("CARGO_BIN_EXE_gelatin"))
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .output()
        .expect("the program starts");
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("DISPLAY") && said.contains("gelatin render") && !said.contains("panicked"), "{said}");
}

#[test]
fn screenshots_that_differ_in_one_place_are_told_apart_only_there() {
    let black = Shot { size: [4, 2], pixels: vec![[0; 3]; 8] };
    let mut dotted = black.clone();
    dotted.pixels[7] = [90, 90, 90];
    assert!(dotted.differs(&black, dotted.whole()), "the dot is seen");
    let left = ViewRect { origin: Vec2::ZERO, size: Vec2::new(2.0, 2.0) };
    assert!(!dotted.differs(&black, left), "but not where it is not");
    let other = Shot { size: [2, 4], ..black.clone() };
    assert!(other.differs(&black, black.whole()), "another size is another picture");
}

/// Runs a test on a window of the program, one at a time.
fn with_window(scene: &str, test: impl FnOnce(&mut Window)) {
    alone(|| test(&mut Window::open(scene, None)));
}

/// Runs a test that opens windows itself, one at a time.
pub(super) fn alone(test: impl FnOnce()) {
    let _alone = ALONE.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    test();
}

/// The program under a virtual display of its own.
pub(super) struct Window {
    program: Child,
    server: Child,
    display: String,
    folder: PathBuf,
    size: [i32; 2],
}

impl Drop for Window {
    fn drop(&mut self) {
        for child in [&mut self.program, &mut self.server] {
            drop(child.kill());
            drop(child.wait());
        }
        drop(std::fs::remove_dir_all(&self.folder));
    }
}

impl Window {
    /// Opens a window with a scene and options after it. Its state folder is its own, or one that outlives it.
    pub(super) fn open(scene: &str, state: Option<&Path>) -> Self {
        let folder = std::env::temp_dir().join(format!("gelatin-window-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a temporary folder can be made");
        let (server, display) = start_server(&folder);
        let log = std::fs::File::create(folder.join("log")).expect("a file in the temporary folder");
        let program = Command::new(env!("CARGO_BIN_EXE_gelatin"))
            .args(scene.split_whitespace())
            .env("DISPLAY", &display)
            .env("XDG_RUNTIME_DIR", &folder)
            .env("XDG_STATE_HOME", state.map_or_else(|| folder.join("state"), Path::to_owned))
            .env_remove("WAYLAND_DISPLAY")
            .env("WINIT_X11_SCALE_FACTOR", "1")
            .env("RUST_LOG", "gelatin::app=debug")
            .stderr(log)
            .spawn()
            .expect("the program starts");
        let mut window = Self { program, server, display, folder, size: [1280, 800] };
        window.wait_until("the window shows the jelly", |shot| shot.jelly_share() > 0.005);
        window.focus();
        window
    }

    fn tool(&self, name: &str, arguments: &[&str]) -> String {
        let output = Command::new(name).args(arguments).env("DISPLAY", &self.display).output();
        let output = output.unwrap_or_else(|error| panic!("{name}: {error}; {INSTALL}"));
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{name} {arguments:?} failed: {said}");
        String::from_utf8_lossy(&output.stdout).into_owned()
    }

    fn hand(&self, arguments: &[&str]) {
        self.tool("xdotool", arguments);
        std::thread::sleep(HAND);
    }

    fn id(&self) -> String {
        let found = self.tool("xdotool", &["search", "--onlyvisible", "--name", "Gelatin"]);
        found.lines().last().expect("the window is there").to_owned()
    }

    /// Gives the window the keyboard, as there is no window manager to do it.
    fn focus(&self) {
        self.click("1", IN_VIEW);
        self.hand(&["windowfocus", "--sync", &self.id()]);
    }

    pub(super) fn key(&self, key: &str) {
        self.hand(&["key", key]);
    }

    pub(super) fn type_text(&self, text: &str) {
        self.hand(&["type", "--delay", "30", text]);
    }

    pub(super) fn title(&self) -> String {
        self.tool("xdotool", &["getwindowname", &self.id()]).trim().to_owned()
    }

    /// Whether the program has ended on its own.
    pub(super) fn has_ended(&mut self) -> bool {
        self.program.try_wait().expect("the program can be asked").is_some()
    }

    /// Clicks into the middle of the pixels of exactly this colour.
    pub(super) fn click_color(&mut self, color: [u8; 3]) {
        self.wait_until("the colour is there", |shot| !shot.places_of(color).is_empty());
        let places = self.shot().places_of(color);
        let count = i32::try_from(places.len()).expect("a small picture").max(1);
        let sum = places.iter().fold([0, 0], |sum, place| [sum[0] + place[0], sum[1] + place[1]]);
        self.click("1", sum.map(|axis| axis / count));
    }

    /// Adds a sphere by the button below the list.
    pub(super) fn add_sphere(&self) {
        self.click("1", ADD_SPHERE);
    }

    pub(super) fn point_at(&self, [x, y]: [i32; 2]) {
        self.hand(&["mousemove", &x.to_string(), &y.to_string()]);
    }

    pub(super) fn click(&self, button: &str, at: [i32; 2]) {
        self.point_at(at);
        self.hand(&["click", button]);
    }

    pub(super) fn drag(&self, button: &str, from: [i32; 2], to: [i32; 2]) {
        self.point_at(from);
        self.hand(&["mousedown", button]);
        self.point_at([i32::midpoint(from[0], to[0]), i32::midpoint(from[1], to[1])]);
        self.point_at(to);
        self.hand(&["mouseup", button]);
    }

    fn resize(&mut self, size: [i32; 2]) {
        self.hand(&["windowsize", &self.id(), &size[0].to_string(), &size[1].to_string()]);
        self.size = size;
    }

    /// Unmaps the window and maps it again, which redraws everything.
    pub(super) fn hide_and_show(&self) {
        let id = self.id();
        self.tool("xdotool", &["windowunmap", "--sync", &id]);
        std::thread::sleep(2 * HAND);
        self.tool("xdotool", &["windowmap", "--sync", &id]);
        self.hand(&["windowfocus", "--sync", &id]);
    }

    /// Fails if the program has ended.
    pub(super) fn still_runs(&mut self) {
        if let Some(status) = self.program.try_wait().expect("the program can be asked") {
            panic!("the program ended with {status}: {}", self.log());
        }
    }

    pub(super) fn shot(&mut self) -> Shot {
        self.still_runs();
        let path = self.folder.join("shot.png");
        let [width, height] = self.size;
        let crop = format!("{width}x{height}+0+0");
        self.tool("import", &["-window", "root", "-crop", &crop, "+repage", &path.to_string_lossy()]);
        Shot::open(&path)
    }

    pub(super) fn wait_until(&mut self, what: &str, holds: impl Fn(&Shot) -> bool) {
        let until = Instant::now() + PATIENCE;
        while Instant::now() < until {
            if holds(&self.shot()) {
                return;
            }
            std::thread::sleep(HAND);
        }
        panic!("not within {PATIENCE:?}: {what}; the program said: {}", self.log());
    }

    pub(super) fn wait_for(&self, what: &str, holds: impl Fn(&Self) -> bool) {
        let until = Instant::now() + PATIENCE;
        while !holds(self) {
            assert!(Instant::now() < until, "not within {PATIENCE:?}: {what}; the program said: {}", self.log());
            std::thread::sleep(HAND);
        }
    }

    /// Whether anything moves between the panels within a second.
    fn view_lives(&mut self) -> bool {
        let before = self.shot();
        std::thread::sleep(Duration::from_secs(1));
        self.shot().differs(&before, BETWEEN_PANELS)
    }

    fn wait_for_view_at_rest(&mut self) {
        let until = Instant::now() + PATIENCE;
        while self.view_lives() {
            assert!(Instant::now() < until, "the view does not come to rest within {PATIENCE:?}");
        }
    }

    pub(super) fn wait_until_still(&mut self) {
        let mut last = self.shot();
        let until = Instant::now() + PATIENCE;
        while Instant::now() < until {
            std::thread::sleep(2 * HAND);
            let now = self.shot();
            if !now.differs(&last, last.whole()) {
                return;
            }
            last = now;
        }
        panic!("the window does not come to rest within {PATIENCE:?}");
    }

    /// Processor time that the program has used, hundredths of a second.
    pub(super) fn cpu_ticks(&self) -> u64 {
        let path = format!("/proc/{}/stat", self.program.id());
        let stat = std::fs::read_to_string(path).expect("the program runs");
        let (_, fields) = stat.rsplit_once(')').expect("a name in brackets");
        let ticks = fields.split_whitespace().skip(11).take(2);
        ticks.map(|field| field.parse::<u64>().expect("a number")).sum()
    }

    pub(super) fn log(&self) -> String {
        std::fs::read_to_string(self.folder.join("log")).unwrap_or_default()
    }
}

const INSTALL: &str = "the tests of the window need the packages `xvfb`, `xdotool` and `imagemagick`";

/// Starts a virtual display with a free number.
fn start_server(folder: &Path) -> (Child, String) {
    let number_path = folder.join("display");
    let number_file = std::fs::File::create(&number_path).expect("a file in the temporary folder");
    let mut server = Command::new("Xvfb")
        .args(["-displayfd", "1", "-screen", "0", "1920x1080x24", "-nolisten", "tcp"])
        .stdout(number_file)
        .stderr(Stdio::null())
        .spawn()
        .unwrap_or_else(|error| panic!("Xvfb: {error}; {INSTALL}"));
    let until = Instant::now() + PATIENCE;
    while Instant::now() < until {
        let number = std::fs::read_to_string(&number_path).unwrap_or_default();
        if number.ends_with('\n') {
            return (server, format!(":{}", number.trim()));
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    drop(server.kill());
    drop(server.wait());
    panic!("Xvfb names no display within {PATIENCE:?}");
}
