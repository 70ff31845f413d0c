//! Coulomb friction on an incline and at rest.

use gelatin::math::Real;
use gelatin::scene::Scene;
use glam::DVec3;

use crate::support::{cube, falling, plane, run, simulate, springs, thesis};

const MU: f64 = 0.5;
const GRAVITY: f64 = 9.81;

/// A cube touching an incline about z whose slope is `slope` = tan θ.
fn on_incline(slope: f64, friction: [f64; 2]) -> (Scene, DVec3) {
    let angle = slope.atan();
    let tilt = [0.0, 0.0, angle.to_degrees()];
    let up = gelatin::math::rotation::from_euler_deg(tilt).y_axis;
    let mut scene = falling(cube(4, 1.0, springs(60.0, 0.6, 0.008), (up * 0.5).to_array()));
    scene.bodies[0].pose.rotation_deg = tilt;
    scene.obstacles.push(plane([0.0; 3], tilt, friction));
    let down = DVec3::new(-angle.cos(), -angle.sin(), 0.0);
    (scene, down)
}

/// Centre of mass along the slope after settling, and its speed.
fn slide(slope: f64, friction: [f64; 2], seconds: f64) -> (f64, f64) {
    let (scene, down) = on_incline(slope, friction);
    let mut simulation = simulate::<f64>(&scene);
    run(&mut simulation, seconds);
    let now = simulation.diagnostics();
    (now.center.dot(down), now.momentum.dot(down) / now.mass_kg)
}

/// Distance that a cube on a slope of 0.95 μ moves in a minute after it has settled, body sizes; it never sleeps.
fn drift<R: Real>() -> f64 {
    let (scene, down) = on_incline(0.95 * MU, [MU, MU]);
    let mut simulation = simulate::<R>(&scene);
    run(&mut simulation, 5.0);
    let settled = simulation.diagnostics().center.dot(down);
    run(&mut simulation, 55.0);
    (simulation.diagnostics().center.dot(down) - settled).abs()
}

#[test]
fn below_the_friction_angle_it_rests_and_does_not_creep() {
    let (double, single) = (drift::<f64>(), drift::<f32>());
    assert!(double < 1e-6 && single < 1e-6, "{double:e} and {single:e} body sizes");
}

/// By the rule as written, the cube creeps down the same slope, so the test can see creeping.
#[test]
fn by_the_rule_of_the_thesis_it_creeps() {
    let (scene, down) = on_incline(0.95 * MU, [MU, MU]);
    let mut simulation = simulate::<f64>(&thesis(scene));
    run(&mut simulation, 5.0);
    let settled = simulation.diagnostics().center.dot(down);
    run(&mut simulation, 10.0);
    let crept = (simulation.diagnostics().center.dot(down) - settled).abs();
    assert!(crept > 1e-3, "{crept:e} body sizes in ten seconds");
}

#[test]
fn above_the_friction_angle_it_slides_with_newtons_acceleration() {
    for slope in [1.05 * MU, 1.5 * MU] {
        let (_, early) = slide(slope, [MU, MU], 3.0);
        let (_, late) = slide(slope, [MU, MU], 4.0);
        let angle = slope.atan();
        let analytic = GRAVITY * (angle.sin() - MU * angle.cos());
        let ratio = (late - early) / analytic;
        assert!((ratio - 1.0).abs() < 0.02, "slope {slope}: {ratio} of the analytic {analytic} m/s²");
    }
}

#[test]
fn without_friction_it_slides_freely() {
    let (_, early) = slide(0.3, [0.0; 2], 3.0);
    let (_, late) = slide(0.3, [0.0; 2], 4.0);
    let ratio = (late - early) / (GRAVITY * 0.3f64.atan().sin());
    assert!((ratio - 1.0).abs() < 1e-3, "g sin θ: {ratio}");
}

/// Between the two coefficients the outcome depends on how the body is set down: here its own settling makes it slip.
#[test]
fn with_two_coefficients_it_rests_below_the_smaller_and_slides_above_the_larger() {
    let friction = [MU, 0.5 * MU];
    let (_, held) = slide(0.9 * 0.5 * MU, friction, 10.0);
    assert!(held.abs() < 1e-6, "below μ_d it comes to rest: {held} m/s");
    let (_, sliding) = slide(1.05 * MU, friction, 4.0);
    assert!(sliding > 1.0, "above μ_s it slides: {sliding} m/s");
}
