//! What a person sees in the real window: new things come into sight, and the eye stays above the floor.

use gelatin::app::input::ViewRect;
use glam::Vec2;

use super::window::{IN_VIEW, Window, alone};

/// The button that adds a cube.
const ADD_CUBE: [i32; 2] = [52, 655];
/// The part between the panels.
const BETWEEN: ViewRect = ViewRect { origin: Vec2::new(192.0, 45.0), size: Vec2::new(750.0, 710.0) };
/// The middle of the part between the panels, down to the card at the bottom.
const HORIZON: ViewRect = ViewRect { origin: Vec2::new(192.0, 560.0), size: Vec2::new(750.0, 120.0) };

/// The green of the second body.
fn is_second([red, green, blue]: [u8; 3]) -> bool {
    let [red, green, blue] = [red, green, blue].map(u32::from);
    green > 90 && 4 * green > 5 * red && 4 * green > 5 * blue
}

/// The grey of the floor, lit.
fn is_floor([red, green, blue]: [u8; 3]) -> bool {
    let (low, high) = (red.min(green).min(blue), red.max(green).max(blue));
    low > 70 && high - low < 40
}

#[test]
fn a_new_cube_comes_into_sight_between_the_panels() {
    alone(|| {
        let mut window = Window::open("cube-on-plane", None);
        window.key("space");
        window.wait_until_still();
        assert!(window.shot().share_of(BETWEEN, is_second) < 0.001, "there is none yet");
        window.click("1", ADD_CUBE);
        window.wait_until("the cube is seen", |shot| shot.share_of(BETWEEN, is_second) > 0.02);
        window.point_at(IN_VIEW);
        window.key("f");
        window.wait_until("and chosen: it is shown whole", |shot| shot.share_of(BETWEEN, is_second) > 0.1);
    });
}

#[test]
fn the_eye_does_not_dive_through_the_floor() {
    alone(|| {
        let mut window = Window::open("cube-on-plane", None);
        window.key("space");
        window.wait_until_still();
        let before = window.shot();
        let [x, y] = IN_VIEW;
        for _ in 0..3 {
            window.drag("2", [x, y + 400], [x, y - 100]);
        }
        window.wait_until("the view has turned", |shot| shot.differs(&before, BETWEEN));
        window.wait_until_still();
        let floor = window.shot().share_of(HORIZON, is_floor);
        assert!(floor > 0.3, "the floor still lies below what is seen: {floor}");
    });
}
