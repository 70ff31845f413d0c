//! The laws of contact between bodies, by measured figures: Coulomb friction, depth, the energy of a
//! drop; what shows them, what they cost where nothing is near, and what sleeps together.

use gelatin::math::Real;
use gelatin::physics::{Grab, Quantity, Simulation};
use gelatin::scene::body::{CellsShape, Pose};
use gelatin::scene::obstacle::ContactStiffness;
use gelatin::scene::{Body, Scene, Shape};
use glam::DVec3;

use crate::bodies::{free, jelly, on_ground, stack};
use crate::support::{cube, plane, run, simulate, springs};

const MU: f64 = 0.5;
const GRAVITY: f64 = 9.81;

/// A cube of 0.6 m near the upper end of a slab 3 m long that a slope of this tangent holds, and the direction down the slope.
///
/// Slab and cube have the friction [`MU`]; the slope has far more.
fn cube_on_held_slab(slope: f64) -> (Scene, DVec3) {
    let angle = slope.atan();
    let rotation_deg = [0.0, 0.0, angle.to_degrees()];
    let up = gelatin::math::rotation::from_euler_deg(rotation_deg).y_axis;
    let jelly = springs(60.0, 0.6, 0.008);
    let down = DVec3::new(-angle.cos(), -angle.sin(), 0.0);
    let with_friction = |body: Body, height: f64, way: f64| Body {
        pose: Pose { position: (up * height + down * way).to_array(), rotation_deg },
        friction_static: MU,
        friction_dynamic: MU,
        ..body
    };
    let list = (0..20 * 2 * 6).map(|cell| [cell % 20, cell / 120, cell / 20 % 6]).collect();
    let slab = Body { shape: Shape::Cells(CellsShape { list, size: 0.15 }), ..cube(1, 1.0, jelly, [0.0; 3]) };
    let upper = cube(4, 0.6, jelly, [0.0; 3]);
    let mut scene = on_ground(vec![with_friction(slab, 0.15, 0.0), with_friction(upper, 0.6, -1.0)]);
    scene.obstacles = vec![plane([0.0; 3], rotation_deg, [10.0 * MU; 2])];
    (scene, down)
}

/// How far the cube is down the slab, m.
fn way<R: Real>(simulation: &mut Simulation<R>, down: DVec3) -> f64 {
    let [slab, cube] = [0, 1].map(|body| simulation.diagnostics_of(body).center);
    (cube - slab).dot(down)
}

/// How far the cube moves down the slab in 10 s after it has settled, m.
fn drift<R: Real>() -> f64 {
    let (scene, down) = cube_on_held_slab(0.95 * MU);
    let mut simulation = simulate::<R>(&scene);
    run(&mut simulation, 5.0);
    let settled = way(&mut simulation, down);
    run(&mut simulation, 10.0);
    (way(&mut simulation, down) - settled).abs()
}

#[test]
fn below_the_friction_angle_a_body_rests_upon_another_and_does_not_creep() {
    // What the rounds over the contacts leave moves it by a tenth of a micrometre in a second.
    let (double, single) = (drift::<f64>(), drift::<f32>());
    assert!(double < 2.5e-6 && single < 2.5e-6, "{double:e} and {single:e} m in 10 s");
}

#[test]
fn above_the_friction_angle_a_body_slides_upon_another_with_newtons_acceleration() {
    for (slope, [settling_secs, seconds]) in [(1.05 * MU, [2.0, 1.5]), (1.5 * MU, [0.5, 0.5])] {
        let (scene, down) = cube_on_held_slab(slope);
        let mut simulation = simulate::<f64>(&scene);
        run(&mut simulation, settling_secs);
        let speed = |simulation: &mut Simulation<f64>| {
            let [slab, cube] = [0, 1].map(|body| simulation.diagnostics_of(body));
            cube.momentum.dot(down) / cube.mass_kg - slab.momentum.dot(down) / slab.mass_kg
        };
        let early = speed(&mut simulation);
        run(&mut simulation, seconds);
        let angle = slope.atan();
        let analytic = GRAVITY * (angle.sin() - MU * angle.cos());
        let ratio = (speed(&mut simulation) - early) / seconds / analytic;
        assert!((ratio - 1.0).abs() < 0.05, "slope {slope}: {ratio} of the analytic {analytic} m/s²");
    }
}

/// A cube that lies on another one on the ground: size (m) and mass of a particle (kg) of the lower and the upper one.
fn one_on_another(sizes: [f64; 2], masses: [f64; 2]) -> Scene {
    let heights = [0.5 * sizes[0], sizes[0] + 0.5 * sizes[1]];
    let body = |which: usize| {
        // A cube of a metre weighs 12 N and is pressed together by less than a hundredth.
        let stiffness = 1e4 * masses[0].max(masses[1]) / sizes[which].min(1.0);
        let jelly = springs(stiffness, 0.01 * stiffness, masses[which]);
        cube(4, sizes[which], jelly, [0.0, heights[which], 0.0])
    };
    on_ground(vec![body(0), body(1)])
}

#[test]
fn unequal_bodies_rest_no_deeper_than_a_fiftieth_of_the_smaller() {
    let cases = [
        ([1.0, 0.3], [0.01, 0.01]),
        ([0.3, 1.0], [0.01, 0.01]),
        ([1.0, 1.0], [0.001, 1.0]),
        ([1.0, 1.0], [1.0, 0.001]),
        ([0.3, 1.0], [0.001, 1.0]),
    ];
    for (sizes, masses) in cases {
        let mut simulation = simulate::<f32>(&one_on_another(sizes, masses));
        run(&mut simulation, 3.0);
        let deepest = simulation.body_contacts().iter().fold(0.0_f64, |deepest, contact| deepest.max(-contact.gap));
        assert!(deepest > 0.0, "{sizes:?} m, {masses:?} kg: one stands on the other");
        assert!(deepest < 0.02 * sizes[0].min(sizes[1]), "{sizes:?} m, {masses:?} kg: {deepest} m deep");
    }
}

#[test]
fn a_heavy_body_on_a_light_one_costs_no_halved_steps_even_on_ground_too_soft_for_them() {
    for stiffness in [ContactStiffness::Auto, ContactStiffness::Given(1.0)] {
        let mut scene = one_on_another([1.0, 1.0], [0.001, 1.0]);
        scene.obstacles[0].stiffness = stiffness;
        let mut simulation = simulate::<f32>(&scene);
        let (mut substeps, mut halved) = (0, 0);
        while simulation.state().time_secs < 1.0 {
            let counters = simulation.substep(&mut ()).counters;
            substeps += counters.substeps;
            halved += counters.halved;
            assert!(halved <= 20, "{stiffness:?}: {halved} of {substeps} within {} s", simulation.state().time_secs);
        }
    }
}

/// The most energy within 0.6 s once a cube that falls 0.3 m has met another one on the ground, undamped and without friction, over
/// that before; of what the fall gives.
fn drop_ratio(stiffness: f64, masses: [f64; 2]) -> f64 {
    let body = |which: usize, height: f64| cube(3, 0.6, springs(stiffness, 0.0, masses[which]), [0.0, height, 0.0]);
    let mut scene = on_ground(vec![body(0, 0.3), body(1, 1.2)]);
    scene.obstacles = vec![plane([0.0; 3], [0.0; 3], [0.0; 2])];
    let mut simulation = simulate::<f64>(&scene);
    let fall = simulation.diagnostics_of(1).mass_kg * GRAVITY * 0.3;
    let before = simulation.diagnostics().energy.total();
    let (mut met, mut peak) = (false, f64::NEG_INFINITY);
    for _ in 0..600 {
        let report = simulation.step();
        assert!(!report.diverged, "{stiffness} N, {masses:?} kg: it stays sound");
        met |= report.last.body_contacts > 0;
        if met {
            peak = peak.max(simulation.diagnostics().energy.total());
        }
    }
    assert!(met, "{stiffness} N, {masses:?} kg: they meet");
    (peak - before + fall) / fall
}

#[test]
fn a_body_dropped_on_another_gains_nothing_over_six_decades_of_stiffness_and_any_ratio_of_masses() {
    for decade in 1..=7 {
        for masses in [[0.01, 0.01], [0.001, 1.0], [1.0, 0.001]] {
            let ratio = drop_ratio(10f64.powi(decade), masses);
            assert!(ratio <= 1.0, "1e{decade} N, {masses:?} kg: {ratio} of the energy of the fall");
        }
    }
}

#[test]
fn what_lies_on_a_body_is_seen_in_the_force_map_of_both() {
    let mut simulation = simulate::<f64>(&stack(2, 4));
    run(&mut simulation, 6.0);
    let force = simulation.scalars(Quantity::ContactForce);
    let weight = simulation.diagnostics_of(1).mass_kg * GRAVITY;
    for (body, side) in [(0, 1.0), (1, -1.0)] {
        let center = simulation.diagnostics_of(body).center;
        let particles = simulation.model().bodies[body].particles.clone();
        let on_it = particles.filter(|&particle| side * (simulation.state().position[particle] - center).y > 0.4);
        // All of these are pushed along one line, so that their magnitudes sum to the force.
        let sum: f64 = on_it.map(|particle| f64::from(force[particle])).sum();
        assert!((sum / weight - 1.0).abs() < 0.03, "body {body} shows {sum} N of {weight} N where they meet");
    }
}

#[test]
fn bodies_that_are_not_near_each_other_cost_no_search() {
    let searched = |gap: f64| {
        let side = |towards: f64| jelly(5, [-towards * (0.5 + 0.5 * gap), 0.0, 0.0], [0.0; 3]);
        simulate::<f32>(&free(vec![side(1.0), side(-1.0)])).run_for(0.2).counters.points_looked_for
    };
    let [near, apart] = [-0.05, 0.5].map(searched);
    assert!(near > 1000 && apart == 0, "{near} points are looked for where they meet, {apart} where they do not");
}

/// Two cubes on the ground, a third upon both, and a fourth that lies for itself.
fn heap_and_one() -> Scene {
    let still = |position: [f64; 3]| cube(4, 1.0, springs(60.0, 1.0, 0.01), position);
    let mut scene = on_ground(vec![
        still([-0.55, 0.5, 0.0]),
        still([0.55, 0.5, 0.0]),
        still([0.0, 1.5, 0.0]),
        still([8.0, 0.5, 0.0]),
    ]);
    scene.settings.sleeping = true;
    scene
}

#[test]
fn a_heap_falls_asleep_as_one_and_wakes_as_one() {
    let mut simulation = simulate::<f32>(&heap_and_one());
    let asleep = |simulation: &Simulation<f32>| [0, 1, 2, 3].map(|body| simulation.state().bodies[body].asleep);
    let mut others = 0;
    for step in 0..20_000 {
        simulation.step();
        let [left, right, upper, alone] = asleep(&simulation);
        assert!(left == right && right == upper, "the heap is one in step {step}: {:?}", asleep(&simulation));
        others += usize::from(alone && !upper);
        if upper && alone {
            break;
        }
    }
    assert_eq!(asleep(&simulation), [true; 4], "all come to rest");
    assert!(others > 0, "what lies for itself does not wait for the heap");
    let particle = simulation.model().bodies[0].particles.start;
    let target = simulation.state().position[particle] + glam::Vec3::Y * 0.3;
    simulation.set_grab(Some(Grab { body: 0, weights: vec![(particle, 1.0)], target, stiffness: 5.0 }));
    simulation.step();
    assert_eq!(asleep(&simulation), [false, false, false, true], "a hand at one wakes the heap, and nothing else");
}
