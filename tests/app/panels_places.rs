//! Where new things are placed, what the first look shows, and what happens to bodies that fell out of the scene.

use gelatin::app::hand::Target;
use gelatin::app::theme::Theme;
use gelatin::app::ui::Framing;
use gelatin::extract;
use gelatin::math::Aabb;
use gelatin::scene::edit::{BodyId, ObstacleId};
use gelatin::scene::obstacle::Plane;
use gelatin::scene::placement::Look;
use gelatin::scene::{Body, Obstacle, ObstacleShape, Scene, presets};
use gelatin::view::{DrawList, Orbit};
use glam::DVec3;

use crate::live::{SIZES, Window};

/// A window on the default scene, whose panels know where its camera looks.
fn looking_at(at: DVec3) -> Window {
    let mut window = Window::open("cube-on-plane");
    window.harness.state_mut().ui.look = Look { at, ahead: DVec3::new(-0.5, -0.3, -0.8) };
    window
}

fn boxes(window: &Window) -> Vec<Aabb<f64>> {
    window.harness.state().session.status().bodies.iter().map(|body| body.bounds).collect()
}

/// Whether two boxes overlap as seen from above.
fn share_a_column(a: &Aabb<f64>, b: &Aabb<f64>) -> bool {
    [0, 2].into_iter().all(|axis| a.min[axis] < b.max[axis] && b.min[axis] < a.max[axis])
}

#[test]
fn twenty_new_cubes_stand_on_the_ground_around_what_is_looked_at_and_each_is_chosen() {
    let mut window = looking_at(DVec3::new(0.5, 0.6, 0.0));
    for number in 1..=20 {
        window.click("+ Cube");
        assert_eq!(window.harness.state().ui.selection, Some(Target::Body(BodyId(number))));
    }
    let boxes = boxes(&window);
    for (number, body) in boxes.iter().enumerate().skip(1) {
        assert!(body.min.y > 0.0 && body.max.y < 1.5, "just above the ground: {body:?}");
        assert!(body.center().length() < 6.0, "near by: {body:?}");
        let apart = boxes[..number].iter().all(|other| !share_a_column(other, body));
        assert!(apart, "it falls on none of the others: {body:?}");
    }
}

#[test]
fn new_things_come_where_a_person_looks_and_are_shown_if_they_are_out_of_sight() {
    let at = DVec3::new(-5.0, 0.5, 4.0);
    for (button, target) in [
        ("+ Cube", Target::Body(BodyId(1))),
        ("+ Sphere", Target::Obstacle(ObstacleId(2))),
        ("+ Plane", Target::Obstacle(ObstacleId(2))),
        ("+ Box", Target::Obstacle(ObstacleId(2))),
        ("+ Capsule", Target::Obstacle(ObstacleId(2))),
        ("+ Cylinder", Target::Obstacle(ObstacleId(2))),
    ] {
        let mut window = looking_at(at);
        window.click(button);
        let state = window.harness.state();
        assert_eq!(state.ui.selection, Some(target), "{button}");
        assert_eq!(state.ui.frame, Some(Framing::Arrived), "{button}: the camera looks whether it is in sight");
        let place: DVec3 = match target {
            Target::Body(id) => window.scene().bodies[id.0].pose.position.into(),
            Target::Obstacle(id) => window.scene().obstacles[id.0].shape.center().into(),
        };
        assert!((place - at).with_y(0.0).length() < 0.1 && place.y < 1.0, "{button}: {place}");
    }
}

#[test]
fn a_copy_comes_beside_its_original_wherever_that_is_now() {
    let mut window = looking_at(DVec3::new(-5.0, 0.5, 4.0));
    (0..900).for_each(|_| assert!(window.harness.state_mut().session.step(), "it lands"));
    window.wait();
    window.click("Jelly");
    window.choose("Edit", "Duplicate Jelly");
    let [original, copy] = boxes(&window)[..] else { panic!("two bodies") };
    assert!(!share_a_column(&original, &copy), "{original:?} beside {copy:?}");
    assert!(original.center().distance(copy.center()) < 2.5, "{original:?} near {copy:?}");
    window.click("Sphere");
    window.choose("Edit", "Duplicate Sphere");
    let balls: Vec<DVec3> = window.scene().obstacles[1..]
        .iter()
        .filter_map(|obstacle| match obstacle.shape {
            ObstacleShape::Sphere(sphere) => Some(sphere.center.into()),
            _ => None,
        })
        .collect();
    let off = balls[0].distance(balls[1]);
    assert!(off > 0.8 && off < 2.5 && (balls[1].y - 0.4).abs() < 1e-3, "on the ground, {off} m away: {balls:?}");
}

/// The picture at the start, and its camera.
fn first_look(scene: &Scene, window: &mut Window) -> (DrawList, Orbit) {
    (window.harness.state_mut().session.draw_list(), extract::view::orbit(&scene.view.camera))
}

#[test]
fn the_first_look_at_every_preset_shows_all_of_it_between_the_panels() {
    for preset in presets::presets() {
        let mut window = Window::open(preset.name);
        let scene = (preset.build)();
        let (picture, orbit) = first_look(&scene, &mut window);
        let area = window.harness.state().ui.safe_area();
        assert!(area.min.y > -0.95, "the card in the corner covers a part: {area:?}");
        assert!(orbit.shows(picture.bounds(), area), "{} in {area:?}: {:?}", preset.name, picture.bounds());
        let near = Orbit { distance: 0.6 * orbit.distance, ..orbit };
        assert!(!near.shows(picture.bounds(), area), "{}: and not from needlessly far away", preset.name);
    }
}

#[test]
fn in_a_window_of_any_size_the_first_look_is_from_far_enough_away() {
    for size in SIZES {
        let mut window = Window::sized("cube-on-plane", size, Theme::Dark);
        let scene = window.scene().clone();
        let (picture, mut orbit) = first_look(&scene, &mut window);
        let area = window.harness.state().ui.safe_area();
        orbit.pull_back(picture.bounds(), area);
        assert!(orbit.shows(picture.bounds(), area), "{size:?}: {area:?}");
        assert!(orbit.distance < 20.0, "{size:?}: it is still seen well from {} m", orbit.distance);
    }
}

#[test]
fn a_body_that_fell_out_has_a_mark_and_one_click_brings_it_back() {
    let mut body = Body { name: "Lost".to_owned(), ..Body::default() };
    body.pose.position = [2.5, 1.0, 0.0];
    let plane = Plane { half_extents: [1.0; 2], ..Plane::default() };
    let floor = Obstacle { shape: ObstacleShape::Plane(plane), ..Obstacle::default() };
    let scene = Scene { bodies: vec![body], obstacles: vec![floor], ..Scene::default() };
    let mut window = Window::on(scene, "falling", [1280.0, 800.0], Theme::Dark);
    assert!(!window.has("Bring Lost back"), "it is there");
    while !window.harness.state().session.status().bodies[0].gone {
        assert!(window.harness.state_mut().session.step(), "it falls");
    }
    window.wait();
    window.click("Lost");
    assert!(window.has("fallen out of the scene"), "the values say so");
    window.click("Bring Lost back");
    let status = window.harness.state().session.status();
    assert!(!status.bodies[0].gone && (status.bodies[0].center[1] - 1.0).abs() < 1e-5, "back at its start");
    assert!(!window.has("Bring Lost back"), "and the mark is gone");
    assert_eq!(status.undo, "teleport Lost", "one step of undo");
}

#[test]
fn what_is_chosen_is_followed_by_the_menu() {
    let mut window = Window::open("cube-on-plane");
    window.choose("View", "Follow what is chosen");
    assert!(window.harness.state().ui.follow_chosen, "from now on");
    window.click("Follow what is chosen");
    assert!(!window.harness.state().ui.follow_chosen, "no longer");
}
