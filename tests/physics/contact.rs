//! Planes, spheres, drops: nothing tunnels, nothing gains energy, depth stays within the limit.

use gelatin::physics::Arrival;
use gelatin::physics::DEPTH_SHARE;
use gelatin::physics::Simulation;
use gelatin::scene::obstacle::ContactStiffness;
use gelatin::scene::{Obstacle, ObstacleShape, Scene};
use glam::Vec3;

use crate::support::{ball, cube, falling, lattices, plane, run, simulate, springs, thesis};

/// A 1 m cube of 4 cells over a horizontal plane at y = 0, its underside `gap` above.
fn drop(gap: f64, friction: [f64; 2]) -> Scene {
    let mut scene = falling(cube(4, 1.0, springs(60.0, 0.0, 0.008), [0.0, 0.5 + gap, 0.0]));
    scene.obstacles.push(plane([0.0; 3], [0.0; 3], friction));
    scene
}

#[test]
fn nothing_passes_a_plane_at_a_kilometre_a_second() {
    for tilt in [0.0, 30.0, 90.0, 180.0] {
        for dt in [1e-3, 0.1] {
            let mut scene = drop(3.0, [0.5, 0.4]);
            let normal = gelatin::math::rotation::from_euler_deg([0.0, 0.0, tilt]).y_axis;
            let toward = if tilt > 90.0 { 1.0 } else { -1.0 };
            scene.settings.dt = dt;
            scene.settings.gravity = [0.0; 3];
            scene.obstacles = vec![plane([0.0; 3], [0.0, 0.0, tilt], [0.5, 0.4])];
            scene.bodies[0].pose.position = (normal * -toward * 3.0).to_array();
            scene.bodies[0].velocity = (normal * toward * 1000.0).to_array();
            let mut simulation = simulate::<f32>(&scene);
            run(&mut simulation, 0.2);
            let normal = (normal * -toward).as_vec3();
            let lowest = simulation.state().position.iter().map(|x| x.dot(normal)).fold(f32::MAX, f32::min);
            assert!(lowest >= -0.0201, "tilt {tilt}, dt {dt}: {lowest} is behind the plane");
        }
    }
}

#[test]
fn nothing_passes_a_ball_or_a_small_plate_at_a_kilometre_a_second() {
    for dt in [1e-4, 1e-3, 0.1] {
        for speed in [1.0, 30.0, 1000.0] {
            let mut scene = drop(2.0, [0.5, 0.4]);
            scene.settings.dt = dt;
            scene.settings.gravity = [0.0; 3];
            scene.bodies[0].velocity = [0.0, -speed, 0.0];
            scene.obstacles = vec![ball([0.0, -0.5, 0.0], 2.0)];
            let mut simulation = simulate::<f32>(&scene);
            run(&mut simulation, (4.0 / speed).clamp(0.2, 2.0));
            let center = Vec3::new(0.0, -0.5, 0.0);
            let deepest = simulation.state().position.iter().map(|x| 2.0 - x.distance(center)).fold(0.0, f32::max);
            let lowest = simulation.diagnostics().bounds.min.y;
            assert!(deepest < 0.0201, "{speed} m/s, dt {dt}: {deepest} m deep in the ball");
            assert!(lowest > -2.6, "{speed} m/s, dt {dt}: no particle is below the ball: {lowest}");
            // A plate just under the body, without thickness.
            let ObstacleShape::Plane(mut plate) = plane([0.0; 3], [0.0; 3], [0.5, 0.4]).shape else { continue };
            plate.half_extents = [3.0, 3.0];
            scene.obstacles[0].shape = ObstacleShape::Plane(plate);
            let mut simulation = simulate::<f32>(&scene);
            run(&mut simulation, 0.1);
            let through =
                simulation.state().position.iter().filter(|x| x.y < -0.0201 && x.x.abs().max(x.z.abs()) < 2.9);
            assert_eq!(through.count(), 0, "{speed} m/s, dt {dt}: particles are below the plate");
        }
    }
}

/// A cube at rest in the air, and an obstacle that is dragged to `to` while time runs.
fn dragged(obstacle: Obstacle, to: ObstacleShape) -> Simulation<f32> {
    let mut scene = drop(1.0, [0.5, 0.4]);
    scene.settings.gravity = [0.0; 3];
    scene.obstacles = vec![obstacle];
    let mut simulation = simulate::<f32>(&scene);
    run(&mut simulation, 0.01);
    scene.obstacles[0].shape = to;
    simulation.set_parameters(&scene, &lattices(&scene), &[Some(0)], Arrival::Swept);
    run(&mut simulation, 0.05);
    simulation
}

#[test]
fn a_plane_dragged_through_a_body_at_any_speed_takes_all_of_it_along() {
    // The half extents just cover the cube; these are the distance and tilt of the dragged plane.
    for (way, tilt) in [(0.7, 0.0), (2.0, 0.0), (20.0, 0.0), (2.0, 15.0)] {
        let upright = |x: f64, tilt: f64| {
            let mut plate = plane([x, 1.5, 0.0], [0.0, 0.0, -90.0 + tilt], [0.5, 0.4]);
            if let ObstacleShape::Plane(plate) = &mut plate.shape {
                plate.half_extents = [2.0, 2.0];
            }
            plate
        };
        let simulation = dragged(upright(-0.6, 0.0), upright(-0.6 + way, tilt).shape);
        let normal = gelatin::math::rotation::from_euler_deg([0.0, 0.0, -90.0 + tilt]).y_axis.as_vec3();
        #[expect(clippy::cast_possible_truncation, reason = "metres to compare with")]
        let center = Vec3::new((-0.6 + way) as f32, 1.5, 0.0);
        let behind = simulation.state().position.iter().map(|x| (*x - center).dot(normal)).fold(f32::MAX, f32::min);
        assert!(behind > -0.0201, "{way} m in a frame, turned by {tilt}°: a particle is {behind} m behind the plane");
        assert!(simulation.diagnostics().momentum.x > 0.0, "it was pushed");
    }
}

#[test]
fn a_ball_dragged_into_a_body_pushes_it_and_holds_none_of_it() {
    for way in [0.5, 1.0, 5.0] {
        let simulation = dragged(ball([-1.2, 1.5, 0.0], 0.6), ball([-1.2 + way, 1.5, 0.0], 0.6).shape);
        #[expect(clippy::cast_possible_truncation, reason = "metres to compare with")]
        let center = Vec3::new((-1.2 + way) as f32, 1.5, 0.0);
        let deepest = simulation.state().position.iter().map(|x| 0.6 - x.distance(center)).fold(0.0, f32::max);
        assert!(deepest < 0.0201, "{way} m in a frame: {deepest} m deep in the ball");
        assert!(simulation.diagnostics().momentum.x > 0.0, "{way} m in a frame: it was pushed");
    }
}

#[test]
fn beyond_the_edge_a_body_falls_past() {
    let mut scene = drop(0.1, [0.5, 0.4]);
    scene.bodies[0].pose.position[0] = 20.6;
    let mut simulation = simulate::<f32>(&scene);
    run(&mut simulation, 1.0);
    assert!(simulation.diagnostics().bounds.max.y < -3.0, "nothing was there to stop it");
}

#[test]
fn a_drop_never_gains_energy_at_any_stiffness() {
    for exponent in -3..=3 {
        let mut scene = drop(0.5, [0.0; 2]);
        // s = k dt²/m over six decades.
        let stiffness = 0.008 / 1e-6 * 10f64.powi(exponent);
        scene.obstacles[0].stiffness = ContactStiffness::Given(stiffness);
        let mut simulation = simulate::<f64>(&scene);
        let before = simulation.diagnostics().energy.total();
        for _ in 0..5 {
            run(&mut simulation, 0.2);
            let after = simulation.diagnostics().energy.total();
            assert!(after <= before * 1.0005, "stiffness {stiffness}: {before} J became {after} J");
        }
    }
}

#[test]
fn the_thesis_rule_gains_energy_where_the_implicit_one_loses_it() {
    let energy_ratio = |scene: Scene| {
        let mut scene = scene;
        scene.obstacles[0].stiffness = ContactStiffness::Given(0.008 / 1e-6 * 0.01);
        let mut simulation = simulate::<f64>(&scene);
        let before = simulation.diagnostics().energy.total();
        let mut peak: f64 = 0.0;
        for _ in 0..20 {
            run(&mut simulation, 0.05);
            peak = peak.max(simulation.diagnostics().energy.total());
        }
        (peak / before, simulation.diagnostics().energy.total() / before)
    };
    let (_, implicit) = energy_ratio(drop(0.5, [0.0; 2]));
    let (thesis_peak, _) = energy_ratio(thesis(drop(0.5, [0.0; 2])));
    assert!(implicit < 1.0, "implicit contact dissipates: {implicit}");
    assert!(thesis_peak > 1.2, "the rule as written adds energy: {thesis_peak}");
}

#[test]
fn a_body_at_rest_is_still_and_hardly_sunk() {
    let mut scene = drop(0.0, [0.6, 0.5]);
    let springs = springs(60.0, 0.6, 0.008);
    scene.bodies[0] = cube(4, 1.0, springs, [0.0, 0.5, 0.0]);
    let mut simulation = simulate::<f32>(&scene);
    run(&mut simulation, 10.0);
    let report = simulation.step();
    assert!(simulation.diagnostics().max_speed < 1e-4, "at rest: {}", simulation.diagnostics().max_speed);
    assert!(report.last.contacts == 25, "the whole underside touches: {}", report.last.contacts);
    assert!(report.last.max_penetration_m < DEPTH_SHARE, "within 2 % of a metre: {}", report.last.max_penetration_m);
    let weight = 0.008 * 125.0 * 9.81;
    let carried: f32 = simulation.contacts().iter().map(|contact| contact.force.y).sum();
    assert!((f64::from(carried) / weight - 1.0).abs() < 1e-3, "the ground carries the weight: {carried} of {weight}");
}

#[test]
fn put_into_a_ball_a_body_is_pushed_out_and_not_shot_out() {
    let mut scene = drop(1.0, [0.5, 0.4]);
    scene.obstacles = vec![ball([0.1, 1.4, 0.05], 0.6)];
    scene.settings.gravity = [0.0; 3];
    let mut simulation = simulate::<f32>(&scene);
    run(&mut simulation, 1.0);
    let now = simulation.diagnostics();
    assert!(now.finite && now.max_speed < 20.0, "it leaves at a walk: {}", now.max_speed);
}

#[test]
fn a_corner_of_three_planes_lets_nothing_through() {
    let mut scene = drop(2.0, [0.2, 0.2]);
    scene.obstacles = vec![
        plane([0.0; 3], [0.0, 0.0, 45.0], [0.2, 0.2]),
        plane([0.0; 3], [0.0, 0.0, -45.0], [0.2, 0.2]),
        ball([0.0, -0.2, 0.0], 0.5),
    ];
    scene.bodies[0].velocity = [0.0, -200.0, 0.0];
    let mut simulation = simulate::<f32>(&scene);
    for _ in 0..500 {
        simulation.step();
        for position in &simulation.state().position {
            // It lies above both arms of the V, except for the allowed depth of 2 % of a metre.
            let above = position.y - position.x.abs();
            assert!(above > -0.021 * std::f32::consts::SQRT_2, "{position} went through at {above}");
        }
    }
}

#[test]
fn a_particle_pressed_on_a_plane_never_changes_sides() {
    // Difficult cases: resting exactly at the surface, rounding either way, a long time.
    for height in [0.0f64, 1e-9, 1e3] {
        let mut scene = drop(0.0, [0.6, 0.5]);
        scene.bodies[0].pose.position[1] = 0.5 + height;
        let ObstacleShape::Plane(ground) = &mut scene.obstacles[0].shape else { unreachable!("drop has a plane") };
        ground.center[1] = height;
        let mut simulation = simulate::<f32>(&scene);
        run(&mut simulation, 3.0);
        let lowest = simulation.diagnostics().bounds.min.y - height;
        assert!(lowest > -0.021, "at {height} m the body hangs {lowest} m below the plane");
    }
}

#[test]
fn a_two_sided_plane_stops_a_body_from_below() {
    let mut scene = drop(0.0, [0.5, 0.4]);
    scene.settings.gravity = [0.0, 9.81, 0.0];
    scene.bodies[0].pose.position[1] = -1.0;
    let mut simulation = simulate::<f32>(&scene);
    run(&mut simulation, 2.0);
    let highest = simulation.state().position.iter().fold(f32::MIN, |high, x: &Vec3| high.max(x.y));
    assert!(highest < 0.021 && highest > -0.5, "it rests against the underside: {highest}");
}

#[test]
fn boxes_save_tests_and_change_nothing() {
    let mut scene = drop(0.3, [0.6, 0.5]);
    scene.obstacles.push(ball([0.7, 0.2, 0.0], 0.3));
    scene.obstacles.push(plane([0.0, -1.0, 0.0], [0.0, 0.0, 20.0], [0.5, 0.5]));
    let mut with = simulate::<f32>(&scene);
    let mut without = simulate::<f32>(&scene);
    without.plan_mut().broad_phase = false;
    let (mut saved, mut tests) = (0, [0; 2]);
    for step in 0..1500 {
        let (a, b) = (with.step(), without.step());
        saved += a.counters.narrow_tests_saved;
        tests = [tests[0] + a.counters.narrow_tests, tests[1] + b.counters.narrow_tests];
        assert_eq!(with.hash(), without.hash(), "the same bits after step {step}");
    }
    // The tilted plane's bounding box holds the whole body, so at best two thirds of the pairs are saved.
    assert!(saved > 0 && tests[0] * 2 < tests[1], "most tests are saved: {tests:?}");
}
