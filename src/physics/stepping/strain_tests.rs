//! Strained bodies take their substeps in parts, as many as they need.

use std::path::Path;
use std::sync::Arc;

use glam::DVec3;

use crate::geometry::Lattice;
use crate::math::rng::Rng;
use crate::physics::Simulation;
use crate::physics::limits::load::{DAMPING_SAFETY, HOLDING_SHARE, SAFETY};
use crate::physics::state::Strain;
use crate::scene::body::CubeShape;
use crate::scene::material::Spring;
use crate::scene::resolve::resolve;
use crate::scene::settings::Stepping;
use crate::scene::{Body, Material, Scene, Shape, Springs};

fn cube(dt: f64) -> (Scene, Vec<Arc<Lattice>>) {
    let mut scene = Scene { bodies: vec![Body::default()], ..Scene::default() };
    scene.settings.gravity = [0.0; 3];
    (scene.settings.dt, scene.settings.allow_implicit) = (dt, false);
    scene.bodies[0].self_collides = false;
    let lattice = resolve(&scene.bodies[0].shape, Path::new("."), &()).expect("a cube").lattice;
    (scene, vec![lattice])
}

/// Particles at random places, up to `size` (m) from the origin along each axis.
fn crumpled(scene: &Scene, lattices: &[Arc<Lattice>], size: f64) -> Simulation<f64> {
    let mut simulation = Simulation::<f64>::new(scene, lattices);
    let mut rng = Rng::new(5);
    let mut state = simulation.state().clone();
    for x in &mut state.position {
        *x = DVec3::from([0; 3].map(|_| rng.between(-size, size)));
    }
    simulation.set_state(state);
    simulation
}

#[test]
fn a_body_at_rest_takes_its_substeps_whole_and_one_in_shreds_in_parts() {
    let (scene, lattices) = cube(1e-3);
    let mut calm = Simulation::<f64>::new(&scene, &lattices);
    assert!(calm.plan().parts > 1, "the safe step at rest is too long for shreds: {}", calm.plan().parts);
    assert_eq!(calm.substep(&mut ()).counters.substeps, 1, "nothing is stretched");
    let mut shreds = crumpled(&scene, &lattices, 5.0);
    let parts = u64::from(shreds.plan().parts);
    let taken = shreds.substep(&mut ()).counters.substeps;
    assert!(taken > 1 && taken <= parts, "links many times their length: {taken} of {parts}");
    let mut long = Simulation::<f64>::new(&scene, &lattices);
    let mut state = long.state().clone();
    state.position.iter_mut().for_each(|x| x.y *= 1.9);
    long.set_state(state);
    let of_long = long.substep(&mut ()).counters.substeps;
    assert!(of_long < taken, "its links point where they did: {of_long}, {taken} in shreds");
    assert!((shreds.state().time_secs - calm.state().time_secs).abs() < 1e-15, "the same time has passed");
    let (small, _) = cube(1e-5);
    assert_eq!(Simulation::<f64>::new(&small, &lattices).plan().parts, 1, "a small step needs no parts");
}

/// The most energy of a damped cube that was crumpled into a box of this half size (m), over that at the start, and the
/// parts that its substeps took on average in the first 50; without bound where it blew up.
fn crushed(size: f64, with_parts: bool) -> [f64; 2] {
    let (scene, lattices) = cube(1e-3);
    let mut simulation = crumpled(&scene, &lattices, size);
    if !with_parts {
        simulation.plan_mut().parts = 0;
    }
    let begin = simulation.diagnostics().energy.total();
    let (mut most, mut parts) = (1.0_f64, 0);
    for substep in 0..2000 {
        let report = simulation.substep(&mut ());
        if report.diverged {
            return [f64::INFINITY; 2];
        }
        parts += if substep < 50 { report.counters.substeps } else { 0 };
        most = most.max(simulation.diagnostics().energy.total() / begin);
    }
    [most, parts as f64 / 50.0]
}

#[test]
fn crushed_cells_are_pushed_in_fewer_parts_than_any_state_needs_and_give_no_energy() {
    let (scene, lattices) = cube(1e-3);
    let any_state = f64::from(Simulation::<f64>::new(&scene, &lattices).plan().parts);
    for size in [0.1, 0.3, 0.5] {
        let [most, parts] = crushed(size, true);
        assert!(most < 1.001, "{size} m: {most} of the energy");
        assert!(parts > 1.0 && parts < any_state, "{size} m: {parts} parts, {any_state} in any state");
    }
    let [most, _] = crushed(0.5, false);
    assert!(most > 1.1, "{most} of the energy in whole substeps: the parts are for nothing");
}

/// The energy after a while over that at the start of an undamped body in shreds; without bound where it blew up.
fn gain(with_parts: bool) -> f64 {
    let (mut scene, _) = cube(0.1);
    scene.settings.inversion_recovery = false;
    scene.settings.allow_implicit = false;
    scene.bodies[0].shape = Shape::Cube(CubeShape { cells: 2, size: 0.1 });
    let [structural, bending] = [24.0, 4.0].map(|stiffness| Spring { stiffness, damping: 0.0 });
    let shear = Spring { stiffness: 0.0, damping: 0.0 };
    scene.bodies[0].material = Material::Springs(Springs { structural, shear, bending, particle_mass: 3e-5 });
    let lattices = vec![resolve(&scene.bodies[0].shape, Path::new("."), &()).expect("a cube").lattice];
    let mut simulation = crumpled(&scene, &lattices, 0.3);
    if !with_parts {
        simulation.plan_mut().parts = 0;
    }
    let mean = |simulation: &mut Simulation<f64>| {
        let energies = (0..200).map(|_| {
            let diverged = simulation.substep(&mut ()).diverged;
            if diverged { f64::INFINITY } else { simulation.diagnostics().energy.total() }
        });
        energies.sum::<f64>() / 200.0
    };
    let begin = mean(&mut simulation);
    let is_finite = (0..1000).all(|_| !simulation.substep(&mut ()).diverged);
    if is_finite { mean(&mut simulation) / begin } else { f64::INFINITY }
}

/// The energy of a cube that swings across the limit of strain, undamped, over that at the start.
fn swung(mut change: impl FnMut(&mut Simulation<f64>)) -> f64 {
    let (mut scene, _) = cube(0.02);
    scene.settings.allow_implicit = false;
    scene.settings.inversion_recovery = false;
    scene.obstacles.clear();
    scene.bodies[0].shape = Shape::Cube(CubeShape { cells: 4, size: 0.0072 });
    let [structural, shear, bending] = [10.7, 145.4, 163.9].map(|stiffness| Spring { stiffness, damping: 0.0 });
    scene.bodies[0].material = Material::Springs(Springs { structural, shear, bending, particle_mass: 0.14 });
    let lattices = vec![resolve(&scene.bodies[0].shape, Path::new("."), &()).expect("a cube").lattice];
    let mut simulation = Simulation::<f64>::new(&scene, &lattices);
    let mut state = simulation.state().clone();
    let mut rng = Rng::new(3);
    for v in &mut state.velocity {
        *v = DVec3::from([0; 3].map(|_| rng.between(-0.5, 0.5)));
    }
    simulation.set_state(state);
    let mean = |simulation: &mut Simulation<f64>, change: &mut dyn FnMut(&mut Simulation<f64>)| {
        let energies = (0..300).map(|_| {
            change(simulation);
            assert!(!simulation.substep(&mut ()).diverged, "it stays finite");
            simulation.diagnostics().energy.total()
        });
        energies.sum::<f64>() / 300.0
    };
    let begin = mean(&mut simulation, &mut change);
    for _ in 0..6000 {
        change(&mut simulation);
        simulation.substep(&mut ());
    }
    mean(&mut simulation, &mut change) / begin
}

/// The most energy that is seen of a body with these dampings by family whose particles are misplaced by up to that
/// share of a cell, over that at the start, in steps of a share of its limit.
fn most(dampings: [f64; 3], noise: f64, share: f64) -> f64 {
    let is_damped = dampings.iter().any(|damping| *damping > 0.0);
    let stiffness = |damping: f64| if is_damped { 20.0 * damping.max(0.02) } else { 20.0 };
    let spring = |damping: f64| Spring { stiffness: stiffness(damping), damping: 2.0 * damping };
    most_of(dampings.map(spring), noise, share)
}

fn most_of([structural, shear, bending]: [Spring; 3], noise: f64, share: f64) -> f64 {
    let (mut scene, _) = cube(1e-3);
    (scene.settings.inversion_recovery, scene.settings.stepping) = (false, Stepping::Manual);
    scene.bodies[0].shape = Shape::Cube(CubeShape { cells: 6, size: 0.6 });
    let springs = Springs { structural, shear, bending, particle_mass: 0.01 };
    scene.bodies[0].material = Material::Springs(springs);
    let lattices = vec![resolve(&scene.bodies[0].shape, Path::new("."), &()).expect("a cube").lattice];
    let limit = Simulation::<f64>::new(&scene, &lattices).plan().limits.dt_limit_secs.expect("a limit");
    scene.settings.dt = share * limit;
    let mut simulation = Simulation::<f64>::new(&scene, &lattices);
    simulation.plan_mut().watched = false;
    let mut rng = Rng::new(5);
    let mut state = simulation.state().clone();
    for x in &mut state.position {
        *x += DVec3::from([0; 3].map(|_| 0.1 * noise * rng.between(-1.0, 1.0)));
    }
    simulation.set_state(state);
    let begin = simulation.diagnostics().energy.total();
    let energies = (0..2000).map(|_| {
        let diverged = simulation.substep(&mut ()).diverged;
        if diverged { f64::INFINITY } else { simulation.diagnostics().energy.total() / begin }
    });
    energies.fold(0.0, f64::max)
}

#[test]
fn damping_may_come_nearer_to_its_limit_than_stiffness_where_shear_links_hold_a_body() {
    let [folding, held, alike] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0; 3]];
    for noise in [0.1, 0.5, 1.0] {
        for (dampings, share) in [(folding, DAMPING_SAFETY[0]), (held, DAMPING_SAFETY[1]), (alike, DAMPING_SAFETY[1])] {
            let kept = most(dampings, noise, share);
            assert!(kept < 1.0, "{dampings:?}: {kept} of the energy, misplaced by {noise} cells");
        }
    }
    for (dampings, share) in [(folding, 0.9), (alike, 1.1), ([0.0; 3], 0.9)] {
        let gained = most(dampings, 0.5, share);
        assert!(gained > 1e3, "{dampings:?}: {gained} of the energy at {share}: the margin is for nothing");
    }
}

#[test]
fn damping_of_bending_links_may_come_near_its_limit_where_shear_links_are_stiff_enough() {
    let kept = |shear: f64, share: f64| {
        let [structural, shear] = [40.0, shear].map(|stiffness| Spring { stiffness, damping: 0.0 });
        let bending = Spring { stiffness: 40.0, damping: 1.0 };
        [0.5, 1.0].map(|noise| most_of([structural, shear, bending], noise, share))
    };
    for shear in [1.01, 3.0, 10.0].map(|times| times * HOLDING_SHARE * 40.0) {
        let held = kept(shear, DAMPING_SAFETY[2]);
        assert!(held.into_iter().all(|kept| kept < 1.0), "{shear} N/m: {held:?} of the energy");
    }
    let [free, folded] = [SAFETY, DAMPING_SAFETY[2]].map(|share| kept(0.0, share));
    assert!(free.into_iter().all(|kept| kept < 1.0), "{free:?} of the energy");
    assert!(folded.into_iter().all(|gained| gained > 1e3), "{folded:?} of the energy: the margin is for nothing");
}

#[test]
fn what_swings_across_the_limit_gains_no_energy_and_would_if_it_changed_its_step_every_time() {
    let mut strained = 0;
    let kept = swung(|simulation| strained += usize::from(simulation.state().bodies[0].strain > Strain::Small));
    assert!(strained > 1000, "it swings across: strained in {strained} substeps");
    assert!(kept < 1.01, "{kept} of the energy");
    let hasty = swung(|simulation| {
        let mut state = simulation.state().clone();
        // One calm check is enough.
        state.bodies[0].calm_substeps = if state.bodies[0].strain > Strain::Small { u32::MAX - 1 } else { 0 };
        simulation.set_state(state);
    });
    assert!(hasty > 1.05, "{hasty} of the energy: to wait is for nothing");
}

#[test]
fn a_body_that_is_about_to_be_torn_takes_its_first_substep_in_parts() {
    let (scene, lattices) = cube(1e-3);
    let mut simulation = Simulation::<f64>::new(&scene, &lattices);
    let mut state = simulation.state().clone();
    state.velocity[0] = DVec3::X * 1e3;
    simulation.set_state(state);
    let parts = u64::from(simulation.plan().parts);
    let taken = simulation.substep(&mut ()).counters.substeps;
    assert!(parts > 1 && taken > parts, "a corner leaves it at 1000 m/s: {taken}, {parts} for the strain alone");
}

#[test]
fn shreds_gain_no_energy_and_would_without_parts() {
    let [with, without] = [true, false].map(gain);
    assert!(with < 1.05, "{with} of the energy");
    assert!(without > 1.3, "{without} of the energy: parts are for nothing");
}
