//! Bodies that meet themselves.

use gelatin::math::{Real, Vector, whole_steps};
use gelatin::physics::{SimdLevel, Simulation};
use gelatin::scene::body::CellsShape;
use gelatin::scene::{Body, Scene, Shape};
use glam::DVec3;

use crate::bodies::momenta;
use crate::determinism::within;
use crate::support::{cube, falling, plane, run, simulate, springs};

/// Size of the tongs, cells: width and height.
const WIDE: u32 = 7;
const TALL: u32 = 10;

/// A weightless U of 10 cm cells, 0.7 m wide, its legs 0.2 m thick and 0.3 m apart.
fn tongs() -> Scene {
    let is_in = |[x, y, _]: [i32; 3]| y == 0 || !(2..=4).contains(&x);
    let (wide, tall) = (WIDE.cast_signed(), TALL.cast_signed());
    let all = (0..2).flat_map(|z| (0..tall).flat_map(move |y| (0..wide).map(move |x| [x, y, z])));
    let shape = Shape::Cells(CellsShape { list: all.filter(|cell| is_in(*cell)).collect(), size: 0.1 });
    let mut scene = falling(Body { shape, ..cube(1, 1.0, springs(60.0, 0.1, 0.01), [0.0; 3]) });
    scene.settings.gravity = [0.0; 3];
    scene
}

/// The scene with the ends of the legs thrown at each other with this speed, m/s.
fn thrown<R: Real>(scene: &Scene, speed: f64) -> Simulation<R> {
    let mut simulation = simulate::<R>(scene);
    let mut state = simulation.state().clone();
    for (velocity, [x, y, _]) in state.velocity.iter_mut().zip(&simulation.model().bodies[0].lattice.corners) {
        let (side, height) = (f64::from(WIDE) / 2.0 - f64::from(*x), f64::from(*y) / f64::from(TALL));
        *velocity = R::Vec3::from_dvec3(DVec3::X * (speed * height * side.signum()));
    }
    simulation.set_state(state);
    simulation
}

/// The smallest distance from the inner side of the left leg to that of the right one, m; negative if the legs overlap.
fn gap<R: Real>(simulation: &Simulation<R>) -> f64 {
    let corners = &simulation.model().bodies[0].lattice.corners;
    let at = |place: [u32; 3]| {
        let particle = corners.iter().position(|corner| *corner == place).expect("a corner of it");
        simulation.state().position[particle].to_dvec3()
    };
    let ways = (TALL / 2..=TALL).flat_map(|y| (0..3).map(move |z| [y, z]));
    ways.map(|[y, z]| at([5, y, z]).x - at([2, y, z]).x).fold(f64::INFINITY, f64::min)
}

/// The least gap within half a second.
fn least_gap(scene: &Scene, speed: f64) -> f64 {
    let mut simulation = thrown::<f32>(scene, speed);
    (0..whole_steps(0.5, scene.settings.dt)).fold(f64::INFINITY, |least, _| {
        assert!(!simulation.step().diverged, "it stays sound");
        least.min(gap(&simulation))
    })
}

#[test]
fn legs_that_are_thrown_at_each_other_do_not_pass() {
    // The faster the legs and the longer the substeps, the less do the springs of all points settle within one; the depth is at
    // most a cell.
    for (dt, depths) in [(1e-3, [0.03, 0.1, 0.1]), (5e-4, [0.03, 0.03, 0.1])] {
        let mut scene = tongs();
        scene.settings.dt = dt;
        for (speed, deepest) in [3.0, 10.0, 30.0].into_iter().zip(depths) {
            let least = least_gap(&scene, speed);
            assert!(least > -deepest && least < 0.05, "at {speed} m/s in steps of {dt} s they come to {least} m");
        }
    }
    let mut off = tongs();
    off.bodies[0].self_collides = false;
    assert!(least_gap(&off, 10.0) < -0.1, "told not to, they do");
    off.bodies[0].self_collides = true;
    off.settings.body_contact = false;
    assert!(least_gap(&off, 10.0) < -0.1, "and in a scene where nothing does");
}

#[test]
fn a_body_that_meets_itself_keeps_its_momenta_and_gains_no_energy() {
    let mut scene = tongs();
    scene.bodies[0].material = gelatin::scene::Material::Springs(springs(60.0, 0.0, 0.01));
    for speed in [3.0, 10.0] {
        let mut simulation = thrown::<f64>(&scene, speed);
        // One leg comes faster and sideways, so that the legs turn each other.
        let mut state = simulation.state().clone();
        for velocity in state.velocity.iter_mut().filter(|velocity| velocity.x > 0.0) {
            *velocity = *velocity * 1.5 + DVec3::Z * (0.2 * velocity.x);
        }
        simulation.set_state(state);
        let (before, mut peak, mut met) = (simulation.diagnostics(), 0.0_f64, 0);
        let momenta_before = momenta(&simulation, 0);
        for _ in 0..1000 {
            assert!(!simulation.step().diverged, "it stays sound");
            met += usize::from(simulation.body_contacts().iter().any(|contact| contact.force != DVec3::ZERO));
            peak = peak.max(simulation.diagnostics().energy.total());
        }
        let after = simulation.diagnostics();
        assert!(met > 10, "at {speed} m/s they meet in {met} steps");
        let exchanged = simulation.model().bodies[0].total_mass() * speed;
        assert!((after.momentum - before.momentum).length() < 1e-12 * exchanged, "{}", after.momentum);
        let turned = (momenta(&simulation, 0)[1] - momenta_before[1]).length();
        assert!(turned < 1e-12 * exchanged, "at {speed} m/s the angular momentum is off by {turned}");
        let energy = before.energy.total();
        assert!(peak < 1.01 * energy, "at {speed} m/s {peak} J of {energy} J");
    }
}

#[test]
fn a_body_that_does_not_fold_is_not_near_itself() {
    for [cells, stiffness] in [[8, 300], [20, 100]] {
        let mut dropped = cube(cells, 1.0, springs(f64::from(stiffness), 0.2, 0.01), [0.0, 0.8, 0.0]);
        dropped.pose.rotation_deg = [20.0, 10.0, 30.0];
        let mut scene = falling(dropped);
        scene.obstacles = vec![plane([0.0; 3], [0.0; 3], [0.6, 0.5])];
        let mut simulation = simulate::<f32>(&scene);
        for _ in 0..600 {
            simulation.step();
            assert!(!simulation.state().bodies[0].near_itself, "at {} s", simulation.state().time_secs);
        }
        scene.bodies[0].self_collides = false;
        let mut without = simulate::<f32>(&scene);
        run(&mut without, 0.6);
        assert_eq!(simulation.state().position, without.state().position, "it costs no bit");
    }
}

#[test]
fn a_folded_body_is_the_same_for_any_level_and_number_of_threads_and_without_a_broad_phase() {
    let after = |change: &dyn Fn(&mut Simulation<f32>)| {
        let mut simulation = thrown::<f32>(&tongs(), 10.0);
        change(&mut simulation);
        run(&mut simulation, 0.025);
        simulation.state().clone()
    };
    let usual = after(&|_| ());
    assert!(!usual.presses.is_empty(), "the legs press each other");
    assert!(after(&|simulation| simulation.plan_mut().broad_phase = false) == usual, "the broad phase");
    for level in SimdLevel::ALL.into_iter().filter(|level| level.is_available()) {
        assert!(after(&|simulation| simulation.plan_mut().simd = level) == usual, "{level:?}");
    }
    for threads in [1, 2, 3] {
        let with = within(threads, || after(&|_| ()));
        assert!(with == usual, "{threads} threads");
    }
}

#[test]
fn a_state_from_within_a_fold_goes_on_bit_for_bit() {
    let mut whole = thrown::<f32>(&tongs(), 10.0);
    run(&mut whole, 0.025);
    let kept = whole.state().clone();
    assert!(kept.bodies[0].near_itself, "it is folding");
    run(&mut whole, 0.1);
    let mut again = simulate::<f32>(&tongs());
    again.set_state(kept);
    run(&mut again, 0.1);
    assert!(again.state() == whole.state(), "as if it had not been stopped");
}
