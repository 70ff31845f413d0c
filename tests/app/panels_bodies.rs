//! What a person does first with several jellies: drop one on another, pull it off, and sweep a mesh through the heap.

use gelatin::app::theme::Theme;
use gelatin::scene::body::{CubeShape, Pose};
use gelatin::scene::edit::{BodyId, Edit, ObstacleId};
use gelatin::scene::presets::preset;
use gelatin::scene::{Body, ObstacleShape, Scene, Shape};
use gelatin::session::{Command, Pull};
use glam::Vec3;

use crate::live::Window;

/// The middle of a body.
fn middle(window: &Window, body: usize) -> Vec3 {
    let simulation = window.harness.state().session.simulation();
    let particles = simulation.model().bodies[body].particles.clone();
    let count = particles.len() as f32;
    simulation.state().position[particles].iter().sum::<Vec3>() / count
}

fn handle(window: &mut Window, command: Command) {
    window.harness.state_mut().session.handle(command).expect("it is allowed");
}

/// Takes steps of a millisecond.
fn run(window: &mut Window, steps: u32) {
    for _ in 0..steps {
        assert!(window.harness.state_mut().session.step(), "it stays sound");
    }
}

/// How hard two bodies press each other, N.
fn force_between(window: &Window) -> f64 {
    let contacts = window.harness.state().session.simulation().body_contacts();
    contacts.iter().map(|contact| contact.force.length()).sum()
}

#[test]
fn an_added_cube_lands_on_another_and_is_pulled_off_it() {
    let mut window = Window::open("cube-on-plane");
    run(&mut window, 1500);
    window.click("+ Cube");
    let below = middle(&window, 0);
    handle(&mut window, Command::Teleport(BodyId(1), (below + 1.3 * Vec3::Y).as_dvec3().to_array()));
    run(&mut window, 1500);
    let [lower, upper] = [0, 1].map(|body| middle(&window, body));
    assert!(upper.y - lower.y > 0.8, "it stands on the other: {lower} and {upper}");
    assert!(force_between(&window) > 1.0, "and presses it: {} N", force_between(&window));
    let particles = window.harness.state().session.simulation().model().bodies[1].particles.clone();
    let weights: Vec<(u32, f32)> = particles
        .clone()
        .map(|particle| (u32::try_from(particle).expect("a small body"), 1.0 / particles.len() as f32))
        .collect();
    // Up and away, and down beside it.
    for way in 1..=25_u8 {
        let along = f32::from(way.min(15)) * 0.2;
        let target = (upper + Vec3::new(along, if way <= 15 { 0.5 } else { -1.0 }, 0.0)).to_array();
        handle(&mut window, Command::Grab(Some(Pull { body: BodyId(1), weights: weights.clone(), target })));
        run(&mut window, 100);
    }
    handle(&mut window, Command::Grab(None));
    run(&mut window, 2000);
    let [left, pulled] = [0, 1].map(|body| middle(&window, body));
    assert!(pulled.x - left.x > 1.5 && (pulled.y - left.y).abs() < 0.1, "both lie on the ground: {left} and {pulled}");
    assert!(force_between(&window) == 0.0, "and press each other no more");
}

/// Three cubes beside and upon each other, and a comb across their way on the left.
fn heap_and_comb() -> Scene {
    let build = |name: &str| (preset(name).expect("a preset").build)();
    let mut scene = build("cube-on-plane");
    let cube = &scene.bodies[0];
    let at = |position: [f64; 3]| {
        let pose = Pose { position, ..Pose::default() };
        Body { shape: Shape::Cube(CubeShape { cells: 5, size: 0.5 }), pose, ..cube.clone() }
    };
    scene.bodies = vec![at([0.0, 0.25, -0.3]), at([0.0, 0.25, 0.3]), at([0.05, 0.76, 0.0])];
    let mut comb = build("comb").obstacles.into_iter().find(|obstacle| obstacle.name == "Comb").expect("a mesh");
    let ObstacleShape::Mesh(mesh) = &mut comb.shape else { panic!("the comb is a mesh") };
    mesh.rotation_deg = [0.0, 90.0, 0.0];
    *comb.shape.center_mut() = [-1.5, 0.25, 0.0];
    scene.obstacles.push(comb);
    scene
}

#[test]
fn a_mesh_that_is_dragged_through_a_heap_takes_it_along() {
    let mut window = Window::on(heap_and_comb(), "heap", [1280.0, 800.0], Theme::Dark);
    run(&mut window, 500);
    handle(&mut window, Command::Play);
    let place = window.scene().obstacles.len() - 1;
    let mut met = 0;
    for frame in 0..120 {
        let mut comb = window.scene().obstacles[place].clone();
        comb.shape.center_mut()[0] = -1.5 + 0.025 * f64::from(frame);
        handle(&mut window, Command::Drag(Edit::Obstacle(ObstacleId(place), Box::new(comb))));
        run(&mut window, 17);
        let simulation = window.harness.state().session.simulation();
        met += usize::from(simulation.contacts().iter().any(|contact| contact.obstacle == place));
    }
    let middles = [0, 1, 2].map(|body| middle(&window, body));
    assert!(met > 20, "it meets them in {met} frames");
    assert!(middles.iter().all(|middle| middle.x > 1.0 && middle.y > 0.1), "it takes all along: {middles:?}");
}
