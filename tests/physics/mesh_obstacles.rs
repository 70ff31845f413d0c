//! Meshes as obstacles: they stop bodies as the shapes do that they imitate, a bowl holds things thrown into it, a sheet
//! stops from both sides, and the way in which contact is found changes no bit.

use std::sync::Arc;

use gelatin::geometry::{Surface, TriMesh};
use gelatin::math::rotation::from_euler_deg;
use gelatin::physics::{Arrival, Simulation};
use gelatin::report::disturb::{Disturbance, DisturbanceKind};
use gelatin::report::extremes::{Edition, extreme_of};
use gelatin::report::judge::{Patience, judge_disturbed};
use gelatin::scene::obstacle::{Cuboid, Mesh, Motion, Oscillate, Plane, Turn};
use gelatin::scene::settings::{ContactRule, Integrator};
use gelatin::scene::{Obstacle, ObstacleShape, Scene};
use glam::DVec3;

use crate::determinism::assert_the_same_however_found;
use crate::support::{cube, falling, lattices, run, simulate, springs};

/// The largest depth of a cube of a metre, plus rounding errors of single precision.
const DEEPEST: f64 = 0.0201;

/// A mesh as an obstacle, not turned.
pub(crate) fn obstacle(mesh: &TriMesh) -> ObstacleShape {
    let surface = Arc::new(Surface::new(mesh).expect("a surface"));
    let center = mesh.bounds().center().to_array();
    let mut shape = Mesh { path: "in memory".to_owned(), center, length: 0.0, ..Mesh::default() };
    shape.load(surface);
    ObstacleShape::Mesh(shape)
}

/// A sheet in the plane of x and z about the origin, with `squares` squares along each side.
fn sheet(half: f64, squares: u32) -> TriMesh {
    let mut mesh = TriMesh::default();
    let at = |step: u32| half * (2.0 * f64::from(step) / f64::from(squares) - 1.0);
    for z in 0..=squares {
        mesh.positions.extend((0..=squares).map(|x| DVec3::new(at(x), 0.0, at(z))));
    }
    for z in 0..squares {
        for x in 0..squares {
            let corner = z * (squares + 1) + x;
            let [a, b, c, d] = [corner, corner + 1, corner + squares + 1, corner + squares + 2];
            mesh.triangles.extend([[a, c, b], [b, c, d]]);
        }
    }
    mesh
}

/// A box about the origin.
fn boxed(half: DVec3) -> TriMesh {
    let mut mesh = TriMesh::default();
    for corner in 0..8_u8 {
        let sign = |bit: u8| if corner & bit == 0 { -1.0 } else { 1.0 };
        mesh.positions.push(half * DVec3::new(sign(1), sign(2), sign(4)));
    }
    for [a, b, c, d] in [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]] {
        mesh.triangles.extend([[a, c, b], [a, d, c]]);
    }
    mesh
}

/// The bowl that the program carries, 3 m wide, its foot at the origin.
fn bowl() -> ObstacleShape {
    let mut mesh = Mesh { path: "builtin:bowl.obj".to_owned(), length: 3.0, ..Mesh::default() };
    mesh.center = [0.0, mesh.half_extents().y, 0.0];
    ObstacleShape::Mesh(mesh)
}

/// A cube of edge `size` (m) with its middle at `position`, and one obstacle.
fn over(shape: ObstacleShape, size: f64, position: [f64; 3]) -> Scene {
    let mut scene = falling(cube(4, size, springs(60.0, 0.5, 0.008), position));
    scene.obstacles = vec![Obstacle { shape, friction_static: 0.6, friction_dynamic: 0.5, ..Obstacle::default() }];
    scene
}

/// The largest depth of a particle in a closed mesh, m; negative if none is inside.
fn deepest(simulation: &Simulation<f32>, shape: &ObstacleShape) -> f64 {
    let ObstacleShape::Mesh(mesh) = shape else { panic!("a mesh") };
    let surface = mesh.surface().expect("it is read");
    let (scale, turn) = (mesh.scale(&surface), from_euler_deg(mesh.rotation_deg).transpose());
    let depth = |at: &glam::Vec3| {
        let own = turn * (at.as_dvec3() - DVec3::from(mesh.center)) / scale;
        let distance = surface.nearest(own).distance * scale;
        if surface.holds(own) { distance } else { -distance }
    };
    simulation.state().position.iter().map(depth).fold(f64::NEG_INFINITY, f64::max)
}

#[test]
fn a_box_of_triangles_does_what_a_box_does() {
    let half = DVec3::new(0.8, 0.4, 0.6);
    let turn = [20.0, 30.0, 10.0];
    let cuboid = ObstacleShape::Box(Cuboid { center: [0.1, 0.0, 0.0], rotation_deg: turn, half_extents: half.into() });
    let mut mesh = obstacle(&boxed(half));
    *mesh.center_mut() = [0.1, 0.0, 0.0];
    *mesh.rotation_deg_mut().expect("it can be turned") = turn;
    for integrator in [Integrator::SemiImplicit, Integrator::Verlet, Integrator::Stabilised, Integrator::Implicit] {
        let [one, other] = [&cuboid, &mesh].map(|shape| {
            let mut scene = over(shape.clone(), 1.0, [0.0, 1.3, 0.0]);
            scene.settings.integrator = integrator;
            let mut simulation = simulate::<f64>(&scene);
            run(&mut simulation, 0.4);
            let report = simulation.run_for(0.01);
            assert!(report.last.contacts > 0, "{integrator:?}: it has landed");
            simulation.diagnostics().center
        });
        assert!(one.distance(other) < 1e-4, "{integrator:?}: {other}, not {one}");
    }
}

#[test]
fn a_slope_of_triangles_holds_and_lets_go_as_a_plane_does() {
    let turn = [0.0, 0.0, -20.0];
    let flat = ObstacleShape::Plane(Plane { rotation_deg: turn, half_extents: [5.0; 2], ..Plane::default() });
    let mut mesh = obstacle(&sheet(5.0, 13));
    *mesh.rotation_deg_mut().expect("it can be turned") = turn;
    // The tangent of 20° is 0.364.
    for (friction, holds) in [([0.6, 0.5], true), ([0.2, 0.2], false)] {
        let [plane, mesh] = [&flat, &mesh].map(|shape| {
            let up = from_euler_deg(turn) * DVec3::Y;
            let mut scene = over(shape.clone(), 1.0, (up * 0.51).to_array());
            scene.bodies[0].pose.rotation_deg = turn;
            [scene.obstacles[0].friction_static, scene.obstacles[0].friction_dynamic] = friction;
            let mut simulation = simulate::<f64>(&scene);
            run(&mut simulation, 1.5);
            simulation.diagnostics().center
        });
        let way = plane.length();
        assert!(plane.distance(mesh) < 1e-6, "{friction:?}: {mesh}, not {plane}");
        assert_eq!(way < 0.6, holds, "{friction:?}: it is {way} m from where it began");
    }
}

#[test]
fn a_bowl_holds_what_is_dropped_into_it() {
    for integrator in [Integrator::SemiImplicit, Integrator::Stabilised, Integrator::Implicit] {
        let mut scene = over(bowl(), 0.7, [0.5, 2.0, 0.2]);
        scene.settings.integrator = integrator;
        let mut simulation = simulate::<f32>(&scene);
        let before = simulation.diagnostics().energy.total();
        for _ in 0..60 {
            run(&mut simulation, 0.05);
            let deep = deepest(&simulation, &scene.obstacles[0].shape);
            assert!(deep < 0.7 * DEEPEST, "{integrator:?}: {deep} m deep");
            let now = simulation.diagnostics().energy.total();
            assert!(now <= before * 1.0005, "{integrator:?}: {before} J became {now} J");
        }
        let end = simulation.diagnostics();
        assert!(end.center.y > 0.3 && end.center.y < 0.9, "{integrator:?}: it is at {}", end.center);
    }
}

#[test]
fn no_throw_at_a_bowl_gains_energy() {
    for (speed, way) in
        [(1.0, [0.0, -1.0, 0.0]), (10.0, [0.3, -1.0, 0.1]), (100.0, [-0.6, -0.8, 0.0]), (40.0, [1.0, 0.0, 0.0])]
    {
        let velocity = DVec3::from(way) * speed;
        let start = DVec3::new(0.1, 0.8, 0.0) - DVec3::from(way) * 1.2;
        let mut scene = over(bowl(), 0.5, start.to_array());
        scene.bodies[0].velocity = velocity.to_array();
        let patience = Patience { seconds: 0.5, most_link_forces: 200_000_000 };
        let verdict = judge_disturbed::<f32>(&scene, &[], &lattices(&scene), patience);
        assert!(verdict.fault.is_none(), "{speed} m/s: {}", verdict.words);
    }
}

#[test]
fn nothing_passes_a_sheet_from_either_side_at_any_speed() {
    for integrator in [Integrator::SemiImplicit, Integrator::Stabilised, Integrator::Implicit] {
        for (speed, dt) in [(1.0, 1e-3), (10.0, 1e-3), (100.0, 1e-3), (1000.0, 1e-3), (100.0, 0.1)] {
            for side in [1.0, -1.0] {
                let mut scene = over(obstacle(&sheet(3.0, 7)), 1.0, [0.3, side, 0.1]);
                scene.settings.gravity = [0.0; 3];
                (scene.settings.integrator, scene.settings.dt) = (integrator, dt);
                scene.bodies[0].velocity = [0.0, -side * speed, 0.0];
                let mut simulation = simulate::<f32>(&scene);
                run(&mut simulation, (1.0 / speed).clamp(0.1, 1.0));
                #[expect(clippy::cast_possible_truncation, reason = "a sign")]
                let past = simulation
                    .state()
                    .position
                    .iter()
                    .filter(|at| at.y * (side as f32) < -0.0202 && at.x.abs().max(at.z.abs()) < 2.9);
                assert_eq!(past.count(), 0, "{integrator:?}, {speed} m/s from {side}, dt {dt}: particles are past it");
            }
        }
    }
}

#[test]
fn one_that_is_dragged_through_a_body_takes_all_of_it_along() {
    let upright = |mut shape: ObstacleShape, x: f64| {
        *shape.rotation_deg_mut().expect("it can be turned") = [0.0, 0.0, -90.0];
        *shape.center_mut() = [x, 1.5, 0.0];
        shape
    };
    for (shape, behind) in [(obstacle(&sheet(2.0, 5)), 0.0), (obstacle(&boxed(DVec3::new(2.0, 0.02, 2.0))), 0.02)] {
        for way in [0.5, 1.5, 5.0] {
            let mut scene = over(upright(shape.clone(), -0.6), 1.0, [0.0, 1.5, 0.0]);
            scene.settings.gravity = [0.0; 3];
            let mut simulation = simulate::<f32>(&scene);
            run(&mut simulation, 0.01);
            scene.obstacles[0].shape.center_mut()[0] += way;
            simulation.set_parameters(&scene, &lattices(&scene), &[Some(0)], Arrival::Swept);
            run(&mut simulation, 0.05);
            let least = simulation.state().position.iter().map(|at| f64::from(at.x)).fold(f64::INFINITY, f64::min);
            let front = way - 0.6 + behind;
            assert!(least > front - DEEPEST, "{way} m in a frame: a particle is {} m behind", front - least);
            assert!(simulation.diagnostics().momentum.x > 0.0, "{way} m in a frame: it was pushed");
        }
    }
}

#[test]
fn one_that_is_put_into_a_body_moves_it_out_whole() {
    let ball = {
        let mut mesh = boxed(DVec3::new(0.2, 0.3, 0.4));
        mesh.positions.iter_mut().for_each(|at| *at = from_euler_deg([0.0, 30.0, 0.0]) * *at);
        obstacle(&mesh)
    };
    for mut shape in [ball, obstacle(&sheet(2.0, 9)), obstacle(&boxed(DVec3::new(2.0, 0.001, 2.0)))] {
        let mut scene = over(shape.clone(), 1.0, [0.0, 0.5, 0.0]);
        scene.obstacles = vec![crate::support::plane([0.0; 3], [0.0; 3], [0.6, 0.5])];
        let mut simulation = simulate::<f32>(&scene);
        run(&mut simulation, 0.5);
        *shape.center_mut() = [0.2, 0.4, 0.1];
        let words = format!("{:?}", shape.bounds().size());
        scene.obstacles.push(Obstacle { shape, ..Obstacle::default() });
        simulation.set_parameters(&scene, &lattices(&scene), &[Some(0), None], Arrival::Placed);
        assert_eq!(simulation.state().approaches.len(), 1, "{words}: it is inside");
        for _ in 0..30 {
            run(&mut simulation, 0.1);
            let now = simulation.diagnostics();
            assert!(now.max_strain < 0.5 && now.inverted_cells == 0, "{words}: strained by {}", now.max_strain);
        }
        assert_eq!(simulation.state().approaches.len(), 0, "{words}: it has arrived");
        let bounds = simulation.diagnostics().bounds;
        let is_beside = bounds.min.x > 0.2 || bounds.max.x < 0.2 || bounds.min.y > 0.37 || bounds.max.y < 0.43;
        let is_beside = is_beside || bounds.min.z > 0.1 || bounds.max.z < 0.1;
        assert!(is_beside, "{words}: the body is at {bounds:?}");
    }
}

#[test]
fn how_they_are_found_changes_no_bit() {
    for (integrator, rule) in [
        (Integrator::SemiImplicit, ContactRule::Implicit),
        (Integrator::Implicit, ContactRule::Implicit),
        (Integrator::Stabilised, ContactRule::Implicit),
        (Integrator::SemiImplicit, ContactRule::Thesis),
    ] {
        let mut scene = over(bowl(), 0.7, [0.5, 1.6, 0.2]);
        let shape = obstacle(&sheet(0.4, 3));
        scene.obstacles.push(Obstacle { shape, ..Obstacle::default() });
        *scene.obstacles[1].shape.center_mut() = [0.2, 0.7, 0.0];
        (scene.settings.integrator, scene.settings.contact) = (integrator, rule);
        let [with, without] = assert_the_same_however_found(&scene, 0.5);
        assert!(with < without, "{integrator:?}: it saves tests: {with} of {without}");
    }
}

#[test]
fn what_is_far_from_a_bowl_meets_it_when_it_is_moved() {
    let mut scene = over(bowl(), 0.7, [0.3, 1.0, 0.2]);
    scene.bodies[0] = cube(9, 0.7, springs(60.0, 0.5, 0.002), [0.3, 1.0, 0.2]);
    let mut after = scene.clone();
    *after.obstacles[0].shape.center_mut() = [0.5, 1.0, 0.2];
    for arrival in [Arrival::Swept, Arrival::Placed] {
        let run_with = |broad_phase: bool| {
            let mut simulation = simulate::<f32>(&scene);
            let plan = |simulation: &mut Simulation<f32>| simulation.plan_mut().broad_phase = broad_phase;
            plan(&mut simulation);
            let lying = simulation.run_for(1.0).counters.narrow_tests;
            simulation.set_parameters(&after, &lattices(&after), &[Some(0)], arrival);
            plan(&mut simulation);
            let moved = simulation.run_for(0.3);
            assert!(moved.counters.peak_penetration_m > 0.0, "{arrival:?}: it is met");
            (simulation.hash(), lying)
        };
        let ((hash, with), (same, without)) = (run_with(true), run_with(false));
        assert_eq!(hash, same, "{arrival:?}");
        assert!(with * 3 < without, "{arrival:?}: most of a body that lies in it is far from it: {with} of {without}");
    }
}

#[test]
fn how_they_are_found_while_they_move_changes_no_bit() {
    let turn = Motion::Turn(Turn { axis: [0.3, 1.0, 0.2], turns_per_sec: 0.7 });
    let swing = Motion::Oscillate(Oscillate { axis: [1.0, 0.5, 0.0], amplitude: 0.2, period_secs: 0.6 });
    for (integrator, motion) in
        [(Integrator::SemiImplicit, turn), (Integrator::SemiImplicit, swing), (Integrator::Implicit, turn)]
    {
        let mut scene = over(bowl(), 0.7, [0.3, 1.6, 0.2]);
        scene.obstacles[0].motion = Some(motion);
        scene.settings.integrator = integrator;
        let [with, without] = assert_the_same_however_found(&scene, 0.8);
        assert!(with * 3 < without, "{integrator:?}, {motion:?}: {with} of {without} tests");
    }
}

#[test]
fn a_bowl_that_is_swept_about_does_the_work_that_bodies_gain() {
    let scene = over(bowl(), 0.6, [0.0, 0.7, 0.0]);
    let mut after = scene.clone();
    *after.obstacles[0].shape.center_mut() = [0.8, 1.4, 0.2];
    let mut last = after.clone();
    *last.obstacles[0].shape.rotation_deg_mut().expect("it can be turned") = [0.0, 0.0, 70.0];
    let kind = |scene: Scene| DisturbanceKind::Obstacles { scene: Box::new(scene), arrival: Arrival::Swept };
    let disturbances =
        [Disturbance { at_secs: 0.3, kind: kind(after) }, Disturbance { at_secs: 0.5, kind: kind(last) }];
    let patience = Patience { seconds: 0.9, most_link_forces: 200_000_000 };
    let verdict = judge_disturbed::<f32>(&scene, &disturbances, &lattices(&scene), patience);
    assert!(verdict.fault.is_none(), "{}", verdict.words);
}

/// A random extreme scene whose closed obstacles are replaced by bowls, combs and sheets of the same size, some of which
/// move.
fn among_meshes(seed: u64, number: u64) -> Scene {
    let (mut scene, _) = extreme_of(Edition::Second, seed, number);
    for (place, obstacle) in (number..).zip(&mut scene.obstacles) {
        let size = obstacle.shape.bounds().size().max_element();
        if matches!(obstacle.shape, ObstacleShape::Plane(_)) || size > 1e3 {
            continue;
        }
        let rotation_deg = obstacle.shape.rotation_deg().unwrap_or([20.0, 70.0, 130.0]);
        let mut shape = match place % 3 {
            0 => bowl(),
            1 => ObstacleShape::Mesh(Mesh { path: "builtin:comb.obj".to_owned(), ..Mesh::default() }),
            _ => obstacle_of_sheet(),
        };
        if let ObstacleShape::Mesh(mesh) = &mut shape {
            (mesh.center, mesh.rotation_deg, mesh.length) = (obstacle.shape.center(), rotation_deg, size);
        }
        obstacle.shape = shape;
        obstacle.motion = match place % 5 {
            0 => Some(Motion::Turn(Turn { axis: [1.0, 2.0, 3.0], turns_per_sec: 0.3 })),
            1 => Some(Motion::Oscillate(Oscillate { amplitude: (0.3 * size).min(50.0), ..Oscillate::default() })),
            _ => None,
        };
    }
    scene
}

fn obstacle_of_sheet() -> ObstacleShape {
    let mut mesh = sheet(0.5, 4);
    // The sheet is folded, so that it has an edge.
    mesh.positions.iter_mut().for_each(|at| at.y = 0.3 * at.x.abs());
    obstacle(&mesh)
}

#[test]
fn no_random_extreme_scene_among_meshes_explodes() {
    const SCENES: u64 = 120;
    let patience = Patience { seconds: 1.0, most_link_forces: 1_000_000 };
    let mut found = Vec::new();
    for number in 0..SCENES {
        let scene = among_meshes(11, number);
        let verdict = judge_disturbed::<f32>(&scene, &[], &lattices(&scene), patience);
        found.extend(verdict.fault.map(|fault| format!("scene {number}: {}: {}", fault.words(), verdict.words)));
    }
    assert!(found.is_empty(), "{} of {SCENES}:\n{}", found.len(), found.join("\n"));
}
