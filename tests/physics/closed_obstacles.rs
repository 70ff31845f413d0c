//! Boxes, capsules and cylinders: bodies rest on every side of them, nothing tunnels, friction holds or does not, and the
//! way in which contact is found changes no bit.

use gelatin::math::Real;
use gelatin::math::rotation::from_euler_deg;
use gelatin::physics::{Arrival, Simulation};
use gelatin::scene::obstacle::{Capsule, Cuboid, Cylinder};
use gelatin::scene::settings::{ContactRule, Integrator};
use gelatin::scene::{Obstacle, ObstacleShape, Scene};
use glam::DVec3;

use crate::determinism::assert_the_same_however_found;
use crate::support::{cube, falling, lattices, plane, run, simulate, springs};

/// The largest depth of a cube of a metre, plus rounding errors of single precision.
const DEEPEST: f64 = 0.0201;

fn board(center: [f64; 3], rotation_deg: [f64; 3], half_extents: [f64; 3]) -> ObstacleShape {
    ObstacleShape::Box(Cuboid { center, rotation_deg, half_extents })
}

fn capsule(rotation_deg: [f64; 3], radius: f64, half_height: f64) -> ObstacleShape {
    ObstacleShape::Capsule(Capsule { center: [0.0; 3], rotation_deg, radius, half_height })
}

fn cylinder(rotation_deg: [f64; 3], radius: f64, half_height: f64) -> ObstacleShape {
    ObstacleShape::Cylinder(Cylinder { center: [0.0; 3], rotation_deg, radius, half_height })
}

/// How deep a point is inside, m, by the definition of the shape; negative outside.
fn depth(shape: &ObstacleShape, at: DVec3) -> f64 {
    let turn = from_euler_deg(shape.rotation_deg().unwrap_or_default());
    let own = turn.transpose() * (at - DVec3::from(shape.center()));
    let radial = DVec3::new(own.x, 0.0, own.z).length();
    match *shape {
        ObstacleShape::Box(Cuboid { half_extents, .. }) => (DVec3::from(half_extents) - own.abs()).min_element(),
        ObstacleShape::Capsule(Capsule { radius, half_height, .. }) => {
            radius - own.distance(DVec3::Y * own.y.clamp(-half_height, half_height))
        }
        ObstacleShape::Cylinder(Cylinder { radius, half_height, .. }) => {
            (radius - radial).min(half_height - own.y.abs())
        }
        _ => panic!("it has an inside"),
    }
}

fn deepest<R: Real<Vec3: Into<DVec3>>>(simulation: &Simulation<R>, shape: &ObstacleShape) -> f64 {
    simulation.state().position.iter().map(|&at| depth(shape, at.into())).fold(f64::NEG_INFINITY, f64::max)
}

/// A cube of a metre, its underside `gap` above the highest point of an obstacle.
fn above(shape: ObstacleShape, gap: f64) -> Scene {
    let height = shape.bounds().max.y + gap + 0.5;
    let mut scene = falling(cube(4, 1.0, springs(60.0, 0.5, 0.008), [0.0, height, 0.0]));
    scene.obstacles = vec![Obstacle { shape, friction_static: 0.6, friction_dynamic: 0.5, ..Obstacle::default() }];
    scene
}

#[test]
fn a_cube_rests_on_every_face_and_end() {
    let faces = [[0.0; 3], [90.0, 0.0, 0.0], [180.0, 0.0, 0.0], [-90.0, 0.0, 0.0], [0.0, 0.0, 90.0], [0.0, 0.0, -90.0]];
    let boxes = faces.map(|turn| board([0.0; 3], turn, [1.5, 1.0, 2.0]));
    let ends = [[0.0; 3], [180.0, 30.0, 0.0]].map(|turn| cylinder(turn, 1.2, 0.4));
    for shape in boxes.into_iter().chain(ends) {
        for integrator in [Integrator::SemiImplicit, Integrator::Verlet, Integrator::Stabilised, Integrator::Implicit] {
            let mut scene = above(shape.clone(), 0.02);
            scene.settings.integrator = integrator;
            let mut simulation = simulate::<f32>(&scene);
            run(&mut simulation, 2.0);
            let deep = deepest(&simulation, &shape);
            assert!(deep > 0.0 && deep < DEEPEST, "{shape:?}, {integrator:?}: {deep} m deep");
            let end = simulation.diagnostics();
            assert!(end.max_speed < 0.02, "{shape:?}, {integrator:?}: it moves at {} m/s", end.max_speed);
        }
    }
}

#[test]
fn over_edges_and_round_sides_it_is_never_deeper_than_it_may_be() {
    let edges = [[0.0, 0.0, 45.0], [45.0, 20.0, 0.0], [30.0, 40.0, 50.0]];
    let boxes = edges.map(|turn| board([0.0; 3], turn, [0.6, 0.3, 0.5]));
    let round = [[0.0, 0.0, 90.0], [0.0; 3], [50.0, 0.0, 60.0]];
    let capsules = round.map(|turn| capsule(turn, 0.3, 0.5));
    let cylinders = round.map(|turn| cylinder(turn, 0.3, 0.5));
    for shape in boxes.into_iter().chain(capsules).chain(cylinders) {
        let mut simulation = simulate::<f32>(&above(shape.clone(), 0.1));
        let before = simulation.diagnostics().energy.total();
        for _ in 0..40 {
            run(&mut simulation, 0.025);
            let deep = deepest(&simulation, &shape);
            assert!(deep < DEEPEST, "{shape:?}: {deep} m deep");
        }
        let after = simulation.diagnostics().energy.total();
        assert!(after <= before * 1.0005, "{shape:?}: {before} J became {after} J");
    }
}

#[test]
fn friction_holds_on_a_slope_below_its_limit_and_lets_go_above() {
    // The tangent of 20° is 0.364.
    for (friction, holds) in [([0.6, 0.5], true), ([0.2, 0.2], false)] {
        let turn = [0.0, 0.0, -20.0];
        let along = from_euler_deg(turn) * DVec3::X;
        for shape in [board([0.0; 3], turn, [4.0, 0.5, 2.0]), cylinder(turn, 4.0, 0.5)] {
            let mut scene = above(shape.clone(), 0.0);
            scene.bodies[0].pose.rotation_deg = turn;
            scene.bodies[0].pose.position = (from_euler_deg(turn) * DVec3::Y * 1.01).to_array();
            let (was, now) = (&mut scene.obstacles[0], friction);
            [was.friction_static, was.friction_dynamic] = now;
            let mut simulation = simulate::<f32>(&scene);
            run(&mut simulation, 0.5);
            let start = simulation.diagnostics().center.dot(along);
            run(&mut simulation, 1.0);
            let way = simulation.diagnostics().center.dot(along) - start;
            assert!(if holds { way.abs() < 1e-3 } else { way > 0.5 }, "{shape:?}, {friction:?}: it slid {way} m");
        }
    }
}

#[test]
fn nothing_passes_a_thin_one_at_any_speed() {
    for shape in [board([0.0; 3], [0.0; 3], [3.0, 0.01, 3.0]), cylinder([0.0; 3], 3.0, 0.01)] {
        for integrator in [Integrator::SemiImplicit, Integrator::Stabilised, Integrator::Implicit] {
            for (speed, dt) in [(1.0, 1e-3), (10.0, 1e-3), (100.0, 1e-3), (1000.0, 1e-3), (100.0, 0.1)] {
                let mut scene = above(shape.clone(), 0.5);
                scene.settings.gravity = [0.0; 3];
                (scene.settings.integrator, scene.settings.dt) = (integrator, dt);
                scene.bodies[0].velocity = [0.0, -speed, 0.0];
                let mut simulation = simulate::<f32>(&scene);
                run(&mut simulation, (1.0 / speed).clamp(0.1, 1.0));
                let past = simulation.state().position.iter().filter(|at| at.y < -0.011 && at.x.hypot(at.z) < 2.9);
                assert_eq!(past.count(), 0, "{shape:?}, {integrator:?}, {speed} m/s, dt {dt}: particles are below");
            }
        }
    }
}

#[test]
fn one_that_is_dragged_through_a_body_takes_all_of_it_along() {
    let mut shapes = [
        board([-0.9, 1.5, 0.0], [0.0, 0.0, 90.0], [2.0, 0.02, 2.0]),
        board([-1.1, 1.5, 0.0], [0.0, 0.0, 0.0], [0.4, 1.0, 1.0]),
        cylinder([0.0, 0.0, 90.0], 2.0, 0.05),
        capsule([0.0; 3], 0.3, 1.0),
    ];
    for shape in &mut shapes[2..] {
        *shape.center_mut() = [-0.95, 1.5, 0.0];
    }
    for shape in shapes {
        for way in [0.5, 1.5, 5.0] {
            let mut scene = above(shape.clone(), 0.0);
            scene.bodies[0].pose.position = [0.0, 1.5, 0.0];
            scene.settings.gravity = [0.0; 3];
            let mut simulation = simulate::<f32>(&scene);
            run(&mut simulation, 0.01);
            let moved = &mut scene.obstacles[0].shape;
            moved.center_mut()[0] += way;
            let moved = moved.clone();
            simulation.set_parameters(&scene, &lattices(&scene), &[Some(0)], Arrival::Swept);
            run(&mut simulation, 0.05);
            let deep = deepest(&simulation, &moved);
            assert!(deep < DEEPEST, "{shape:?}, {way} m in a frame: {deep} m deep");
            assert!(simulation.diagnostics().center.x > 0.0, "{shape:?}, {way} m in a frame: it was pushed");
        }
    }
}

#[test]
fn one_that_is_put_into_a_body_moves_it_out_whole() {
    for mut shape in [
        board([0.0; 3], [0.0, 30.0, 0.0], [0.2, 0.3, 0.4]),
        board([0.0; 3], [0.0; 3], [2.0, 0.001, 2.0]),
        capsule([0.0, 0.0, 90.0], 0.2, 0.4),
        cylinder([30.0, 0.0, 0.0], 0.3, 0.3),
    ] {
        let mut scene = above(shape.clone(), 5.0);
        scene.bodies[0].pose.position = [0.0, 0.5, 0.0];
        scene.obstacles = vec![plane([0.0; 3], [0.0; 3], [0.6, 0.5])];
        let mut simulation = simulate::<f32>(&scene);
        run(&mut simulation, 0.5);
        *shape.center_mut() = [0.2, 0.4, 0.1];
        scene.obstacles.push(Obstacle { shape: shape.clone(), ..Obstacle::default() });
        simulation.set_parameters(&scene, &lattices(&scene), &[Some(0), None], Arrival::Placed);
        assert_eq!(simulation.state().approaches.len(), 1, "{shape:?}: it is inside");
        for _ in 0..30 {
            run(&mut simulation, 0.1);
            let now = simulation.diagnostics();
            assert!(now.max_strain < 0.5 && now.inverted_cells == 0, "{shape:?}: strained by {}", now.max_strain);
        }
        assert_eq!(simulation.state().approaches.len(), 0, "{shape:?}: it has arrived");
        let deep = deepest(&simulation, &shape);
        assert!(deep < DEEPEST, "{shape:?}: still {deep} m deep");
    }
}

/// A cube that tumbles over one obstacle of each shape.
fn landing() -> Scene {
    let mut scene = falling(cube(5, 1.0, springs(40.0, 0.2, 0.01), [0.0, 1.3, 0.0]));
    scene.bodies[0].pose.rotation_deg = [10.0, 20.0, 30.0];
    let mut shapes = [
        board([0.5, 0.3, 0.1], [20.0, 30.0, 40.0], [0.4, 0.2, 0.3]),
        capsule([70.0, 10.0, 0.0], 0.15, 0.3),
        cylinder([30.0, 0.0, 15.0], 0.2, 0.3),
    ];
    *shapes[1].center_mut() = [-0.4, 0.3, 0.4];
    *shapes[2].center_mut() = [-0.3, 0.3, -0.5];
    scene.obstacles = vec![plane([0.0; 3], [0.0; 3], [0.6, 0.5])];
    scene.obstacles.extend(shapes.map(|shape| Obstacle { shape, ..Obstacle::default() }));
    scene
}

#[test]
fn how_they_are_found_changes_no_bit() {
    for (integrator, rule) in [
        (Integrator::SemiImplicit, ContactRule::Implicit),
        (Integrator::Implicit, ContactRule::Implicit),
        (Integrator::Stabilised, ContactRule::Implicit),
        (Integrator::SemiImplicit, ContactRule::Thesis),
    ] {
        let mut scene = landing();
        (scene.settings.integrator, scene.settings.contact) = (integrator, rule);
        let [with, without] = assert_the_same_however_found(&scene, 0.6);
        assert!(with < without, "{integrator:?}: it saves tests: {with} of {without}");
    }
}

#[test]
fn what_lies_on_them_sleeps_and_wakes_when_they_are_moved() {
    let shape = board([0.0; 3], [0.0; 3], [2.0, 0.5, 2.0]);
    let mut scene = above(shape, 0.0);
    scene.settings.sleeping = true;
    let mut simulation = simulate::<f32>(&scene);
    run(&mut simulation, 6.0);
    assert!(simulation.state().bodies[0].asleep, "it has come to rest");
    scene.obstacles[0].shape.center_mut()[1] += 0.02;
    simulation.set_parameters(&scene, &lattices(&scene), &[Some(0)], Arrival::Swept);
    run(&mut simulation, 0.1);
    assert!(!simulation.state().bodies[0].asleep, "it wakes");
    run(&mut simulation, 3.0);
    let bottom = simulation.diagnostics().bounds.min.y;
    assert!((bottom - 0.52).abs() < 0.02, "it is lifted, to {bottom} m");
}
