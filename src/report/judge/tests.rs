//! The judge finds faults, and condemns nothing else.

use glam::{DVec3, Vec3};

use super::*;
use crate::math::rng::Rng;
use crate::physics::Arrival;
use crate::report::disturb::DisturbanceKind;
use crate::report::extremes::{Edition, extreme_of, lattices};
use crate::scene::body::{CubeShape, Pose};
use crate::scene::material::{Material, Spring, Springs};
use crate::scene::obstacle::{ContactStiffness, Plane, Sphere};
use crate::scene::settings::Stepping;
use crate::scene::{Body, Obstacle, ObstacleShape, Shape};

const PATIENCE: Patience = Patience { seconds: 0.5, most_link_forces: 60_000_000 };

fn falling_cube() -> Scene {
    let mut scene = Scene { bodies: vec![Body::default()], ..Scene::default() };
    scene.bodies[0].pose.position[1] = 2.0;
    scene.settings.allow_implicit = false;
    scene
}

fn seen(scene: &Scene, mut disturb: impl FnMut(&mut Simulation<f32>, u64)) -> Verdict {
    let mut simulation = Simulation::new(scene, &lattices(scene).expect("sound shapes"));
    let mut motion_judge = MotionJudge::open(&simulation, PATIENCE);
    loop {
        disturb(&mut simulation, motion_judge.verdict.substeps);
        if !motion_judge.substep(&mut simulation) {
            return motion_judge.verdict();
        }
    }
}

/// Judges a random scene that once was at fault by the judge's mistake.
fn assert_passes(edition: Edition, seed: u64, number: u64) {
    let (scene, disturbances) = extreme_of(edition, seed, number);
    let lattices = lattices(&scene).expect("sound shapes");
    let verdict = judge_disturbed::<f32>(&scene, &disturbances, &lattices, PATIENCE);
    assert_eq!(verdict.fault, None, "{verdict:?}");
}

#[test]
fn a_sound_motion_is_left_alone() {
    let verdict = seen(&falling_cube(), |_, _| ());
    assert_eq!((verdict.fault, verdict.cut_short), (None, false), "{verdict:?}");
    assert!(verdict.largest_gain < 1e-3 && (verdict.simulated_secs - 0.5).abs() < 1e-3, "{verdict:?}");
}

#[test]
fn a_body_that_is_squeezed_may_leave_faster_than_it_is_pushed() {
    // A ball of 300 m presses a body into the ground at 28 km/s and leaves it.
    assert_passes(Edition::First, 1, 6809);
}

#[test]
fn a_body_that_falls_out_after_it_was_put_back_has_gained_nothing() {
    assert_passes(Edition::Second, 2_950_612_423, 4861);
}

#[test]
fn a_body_that_is_thrown_anew_deep_in_an_obstacle_has_the_energy_of_the_throw() {
    assert_passes(Edition::Fifth, 2_742_469_007, 6384);
}

#[test]
fn what_an_obstacle_takes_from_one_body_is_not_taken_from_another() {
    // The ground turns slowly and brakes two heavy bodies, beside a light one.
    assert_passes(Edition::Fifth, 2_742_469_007, 2760);
}

#[test]
fn a_vibration_that_comes_near_an_obstacle_again_and_again_gains_no_energy() {
    // A stiff body held at its top, by a Runge–Kutta scheme, around a model smaller than a cell.
    assert_passes(Edition::Fifth, 3_613_812_433, 4169);
}

#[test]
fn a_body_that_begins_in_what_it_is_thrown_at_has_the_energy_that_it_came_with() {
    // The velocity half a step later, in the mean, is half of what it was: a bowl of one cell's depth is parted from a ball.
    assert_passes(Edition::Fourth, 4_143_628_233, 811);
}

#[test]
fn an_explosion_is_seen() {
    let mut scene = falling_cube();
    scene.settings.stepping = Stepping::Manual;
    scene.settings.dt = 0.1;
    let mut rng = Rng::new(1);
    let verdict = seen(&scene, |simulation, substep| {
        if substep == 0 {
            let mut state = simulation.state().clone();
            for v in &mut state.velocity {
                *v += Vec3::X.lerp(Vec3::NEG_X, if rng.unit() < 0.5 { 0.4 } else { 0.6 });
            }
            simulation.set_state(state);
        }
    });
    assert!(verdict.fault.is_some(), "a manual step far above the limit: {verdict:?}");
}

#[test]
fn a_tenth_more_energy_is_seen_and_a_fiftieth_is_not() {
    let gained = |share: f32| {
        seen(&falling_cube(), |simulation, substep| {
            if substep == 250 {
                let mut state = simulation.state().clone();
                state.velocity.iter_mut().for_each(|v| *v *= (1.0 + share).sqrt());
                simulation.set_state(state);
            }
        })
    };
    let (tenth, fiftieth) = (gained(0.1), gained(0.02));
    assert_eq!(tenth.fault, Some(Fault::Energy), "{tenth:?}");
    assert!((0.05..0.11).contains(&tenth.largest_gain), "as soon as it is told: {tenth:?}");
    assert_eq!(fiftieth.fault, None, "{fiftieth:?}");
}

/// A ball sweeps into a cube that floats; later the cube gains `share` of its kinetic energy.
fn kicked(share: f32) -> Verdict {
    let sphere = Sphere { center: [-1.2, 0.0, 0.0], radius: 0.5 };
    let ball = Obstacle { shape: ObstacleShape::Sphere(sphere), ..Obstacle::default() };
    let mut scene = Scene { bodies: vec![Body::default()], obstacles: vec![ball], ..Scene::default() };
    scene.bodies[0].pose.position = [0.0; 3];
    scene.settings.gravity = [0.0; 3];
    scene.settings.dt = 2e-4;
    let mut after = scene.clone();
    if let ObstacleShape::Sphere(sphere) = &mut after.obstacles[0].shape {
        sphere.center[0] = -0.7;
    }
    seen(&scene, |simulation, substep| match substep {
        10 => {
            simulation.set_parameters(&after, &lattices(&after).expect("sound shapes"), &[Some(0)], Arrival::Swept);
        }
        1000 => {
            let mut state = simulation.state().clone();
            state.velocity.iter_mut().for_each(|v| *v *= (1.0 + share).sqrt());
            simulation.set_state(state);
        }
        _ => (),
    })
}

#[test]
fn the_work_of_an_obstacle_may_be_had_and_more_may_not() {
    let sound = kicked(0.0);
    assert!(sound.fault.is_none() && sound.largest_gain < MAX_ENERGY_GAIN && sound.substeps > 1500, "{sound:?}");
    // The kick keeps a tenth of it, the damping takes the rest.
    let gained = kicked(12.0);
    assert_eq!(gained.fault, Some(Fault::Energy), "{gained:?}");
}

/// A cube floats and a heavy one hits it; later the floating cube gains `share` of its kinetic energy.
fn hit(share: f32) -> Verdict {
    let mut scene = Scene { bodies: vec![Body::default(); 2], ..Scene::default() };
    scene.settings.gravity = [0.0; 3];
    for (body, [x, speed, mass]) in scene.bodies.iter_mut().zip([[0.0, 0.0, 1e-3], [-1.1, 3.0, 1.0]]) {
        (body.pose.position, body.velocity) = ([x, 0.0, 0.0], [speed, 0.0, 0.0]);
        body.shape = Shape::Cube(CubeShape { cells: 3, size: 1.0 });
        let Material::Springs(springs) = &mut body.material else { unreachable!("it has springs") };
        springs.particle_mass = mass;
    }
    let light = Simulation::<f32>::new(&scene, &lattices(&scene).expect("cubes")).model().bodies[0].particles.clone();
    let mut substeps = 0;
    seen(&scene, |simulation, _| {
        substeps += 1;
        if share > 0.0 && simulation.state().time_secs > 0.3 && substeps > 0 {
            substeps = i64::MIN;
            let mut state = simulation.state().clone();
            state.velocity[light.clone()].iter_mut().for_each(|v| *v *= (1.0 + share).sqrt());
            simulation.set_state(state);
        }
    })
}

#[test]
fn what_one_body_gives_another_may_be_had_and_more_may_not() {
    let sound = hit(0.0);
    assert!(sound.fault.is_none() && sound.simulated_secs > 0.45, "it floats away at twice the speed: {sound:?}");
    let gained = hit(2000.0);
    assert_eq!(gained.fault, Some(Fault::Energy), "{gained:?}");
    assert!(gained.words.contains("bodies 0, 1"), "both are judged: {gained:?}");
}

/// A soft cube without gravity. Its steps are so long that an obstacle sweeps to its place within one of them.
fn soft_cube(velocity: [f64; 3], ground: f64) -> Scene {
    let [structural, none] = [20.0, 0.0].map(|stiffness| Spring { stiffness, damping: 0.0 });
    let springs = Springs { structural, shear: none, bending: none, particle_mass: 1.0 };
    let shape = Shape::Cube(CubeShape { cells: 2, size: 0.2 });
    let material = Material::Springs(springs);
    let pose = Pose { position: [0.0; 3], ..Pose::default() };
    let body = Body { shape, pose, velocity, material, ..Body::default() };
    let mut scene = Scene { bodies: vec![body], obstacles: vec![plane_at(ground)], ..Scene::default() };
    scene.settings.gravity = [0.0; 3];
    scene.settings.dt = 0.05;
    scene.settings.inversion_recovery = false;
    scene
}

fn plane_at(height: f64) -> Obstacle {
    let plane = Plane { center: [0.0, height, 0.0], ..Plane::default() };
    Obstacle { shape: ObstacleShape::Plane(plane), ..Obstacle::default() }
}

#[test]
fn a_plane_that_sweeps_away_leaves_a_thrown_body_all_its_energy() {
    // The plane would stop the body in the coming substep.
    let scene = soft_cube([0.0, -100.0, 0.0], -0.2);
    let away = Box::new(Scene { obstacles: vec![plane_at(-1000.0)], ..scene.clone() });
    let sweep = DisturbanceKind::Obstacles { scene: away, arrival: Arrival::Swept };
    let at_once = [sweep, DisturbanceKind::Throw(0)].map(|kind| Disturbance { at_secs: 0.01, kind });
    let lattices = lattices(&scene).expect("a cube");
    let mut works = Vec::new();
    let verdict = judge_with_events::<f32>(&scene, &at_once, &lattices, PATIENCE, |seen| {
        if let JudgeEvent::Disturbed(_, work) = seen {
            works.push(work);
        }
    });
    let thrown = 0.5 * 27.0 * 100.0 * 100.0;
    assert!(works.iter().sum::<f64>() > 0.9 * thrown, "{works:?} J of {thrown} J");
    assert!(works.iter().sum::<f64>() < 1.1 * thrown, "{works:?} J of {thrown} J");
    assert_eq!(verdict.fault, None, "{verdict:?}");
}

#[test]
fn a_sample_has_no_push_of_an_obstacle_that_is_put_elsewhere_before_it_comes() {
    let speed = 100.0;
    let mut scene = soft_cube([0.0, -speed, 0.0], -1000.0);
    let lattices = lattices(&scene).expect("a cube");
    let away = Box::new(scene.clone());
    // The cube's lower face ends the first substep 5 cm above the plane, which would stop it in the second.
    let dt = Simulation::<f32>::new(&scene, &lattices).plan().substep_secs();
    scene.obstacles = vec![plane_at(-0.15 - speed * dt)];
    let kind = DisturbanceKind::Obstacles { scene: away, arrival: Arrival::Placed };
    let put_away = [Disturbance { at_secs: 0.5 * dt, kind }];
    let first_kinetic = |disturbances: &[Disturbance]| {
        let mut first = None;
        judge_with_events::<f32>(&scene, disturbances, &lattices, PATIENCE, |seen| {
            if let JudgeEvent::Sample(sample) = seen {
                first = first.or(Some(sample.kinetic));
            }
        });
        first.expect("one after the first substep")
    };
    let thrown = 0.5 * 27.0 * speed * speed;
    let [stopped, flying] = [&[], &put_away[..]].map(first_kinetic);
    assert!(stopped < 0.5 * thrown, "half of the push is in the sample: {stopped} J of {thrown} J");
    assert!((flying / thrown - 1.0).abs() < 0.01, "no push comes: {flying} J of {thrown} J");
}

#[test]
fn a_strained_body_gets_as_far_as_it_is_pushed_in_the_first_part_of_a_substep() {
    let scene = soft_cube([0.0; 3], -1.0);
    let lattices = lattices(&scene).expect("a cube");
    let mut simulation = Simulation::<f32>::new(&scene, &lattices);
    let mut state = simulation.state().clone();
    // This lines up all its links.
    state.position.iter_mut().for_each(|x| *x = Vec3::X * (3.0 * x.x + 2.0 * x.y + 1.5 * x.z));
    simulation.set_state(state);
    let mut motion_judge = MotionJudge::open(&simulation, PATIENCE);
    let after = Scene { obstacles: vec![plane_at(15.0)], ..scene.clone() };
    simulation.set_parameters(&after, &lattices, &[Some(0)], Arrival::Swept);
    assert!(
        motion_judge.substep(&mut simulation) && motion_judge.totals.counters.substeps > 1,
        "in parts: {motion_judge:?}"
    );
    while motion_judge.substep(&mut simulation) {}
    assert!(simulation.diagnostics().center.y > 300.0, "{} m up", simulation.diagnostics().center.y);
    assert_eq!(motion_judge.verdict().fault, None, "it is pushed at 960 m/s");
}

#[test]
fn a_particle_without_links_to_speak_of_gets_as_far_as_its_own_contact_throws_it() {
    let mut scene = falling_cube();
    scene.settings.gravity = [0.0; 3];
    scene.bodies[0].material = Material::Springs(Springs {
        structural: Spring { stiffness: 1e-6, damping: 0.0 },
        shear: Spring { stiffness: 1e-6, damping: 0.0 },
        bending: Spring { stiffness: 1e-6, damping: 0.0 },
        particle_mass: 1.0,
    });
    // A ball around one corner of the cube.
    let corner = Simulation::<f32>::new(&scene, &lattices(&scene).expect("a cube")).state().position[0].as_dvec3();
    let ball = Sphere { center: (corner + DVec3::splat(-0.001)).to_array(), radius: 0.02 };
    let (shape, stiffness) = (ObstacleShape::Sphere(ball), ContactStiffness::Given(1e7));
    scene.obstacles = vec![Obstacle { shape, stiffness, ..Obstacle::default() }];
    let mut furthest = 0.0_f64;
    let verdict =
        seen(&scene, |simulation, _| furthest = simulation.diagnostics().bounds.size().length().max(furthest));
    assert!(furthest > 4.0, "it flies away from the others: {furthest} m");
    assert_eq!(verdict.fault, None, "{verdict:?}");
}

/// Judges a scene whose particles all jump by `way` (m) in substep `at`.
fn catapult(scene: &Scene, at: u64, way: f32) -> Verdict {
    seen(scene, |simulation, substep| {
        if substep == at {
            let mut state = simulation.state().clone();
            state.position.iter_mut().for_each(|x| x.x += way);
            simulation.set_state(state);
        }
    })
}

#[test]
fn a_light_part_gets_as_far_as_the_heavy_rest_throws_it_and_no_further() {
    // In the first scene, two planes catch the light half while the heavy one flies on. In the second, the heavy half is
    // caught and strikes the light one.
    let mut thrown = (extreme_of(Edition::First, 1_623_209_670, 3728).0, 40, 3000.0);
    thrown.0.bodies.iter_mut().for_each(|body| body.self_collides = false);
    let struck = (extreme_of(Edition::Second, 1_158_365_644, 907).0, 10, 1e6);
    for (scene, at, way) in [thrown, struck] {
        let sound = catapult(&scene, at, 0.0);
        assert_eq!(sound.fault, None, "{sound:?}");
        let elsewhere = catapult(&scene, at, way);
        assert_eq!(elsewhere.fault, Some(Fault::Reach), "{elsewhere:?}");
    }
}

#[test]
fn looks_are_in_step_with_no_vibration() {
    for between in 2..40 {
        // Evenly spaced samples would all see the end of the swing.
        let swing = |look| (2.0 * std::f64::consts::PI * look as f64 / between as f64).cos();
        let samples: Vec<u64> = (0..80).map(|number| nth_sample_substep(number, between)).collect();
        assert!(samples.is_sorted_by(|one, next| one < next), "one after another");
        for window in samples.chunks(usize::try_from(SAMPLES_PER_WINDOW).expect("a few")) {
            let mean = window.iter().map(|&substep| swing(substep)).sum::<f64>() / SAMPLES_PER_WINDOW as f64;
            assert!(mean.abs() < 0.3, "{mean} of the swing, {between} substeps to a look");
        }
    }
}

#[test]
fn a_body_that_is_suddenly_elsewhere_is_seen() {
    let mut scene = falling_cube();
    scene.settings.gravity = [0.0; 3];
    let verdict = seen(&scene, |simulation, substep| {
        if substep == 100 {
            let mut state = simulation.state().clone();
            state.position.iter_mut().for_each(|x| x.x += 30.0);
            simulation.set_state(state);
        }
    });
    assert_eq!(verdict.fault, Some(Fault::Reach), "{verdict:?}");
}

#[test]
fn a_nan_is_seen() {
    let verdict = seen(&falling_cube(), |simulation, substep| {
        if substep == 3 {
            let mut state = simulation.state().clone();
            state.velocity[5].y = f32::NAN;
            simulation.set_state(state);
        }
    });
    assert_eq!(verdict.fault, Some(Fault::NotFinite), "{verdict:?}");
}

#[test]
fn what_takes_too_long_is_cut_short_and_says_so() {
    let hasty = Patience { most_link_forces: 100_000, ..PATIENCE };
    let scene = extreme_of(Edition::First, 1, 7).0;
    let verdict = judge::<f32>(&scene, &lattices(&scene).expect("sound shapes"), hasty);
    let cut_short = seen(&scene, |_, _| ()).substeps > verdict.substeps;
    assert_eq!(verdict.cut_short, cut_short, "{verdict:?}");
    let cube = judge::<f32>(&falling_cube(), &lattices(&falling_cube()).expect("sound shapes"), hasty);
    assert!(cube.cut_short && cube.simulated_secs < 0.05, "{cube:?}");
}

#[test]
fn what_cannot_be_over_in_time_is_cut_short_early() {
    let scene = falling_cube();
    let lattices = lattices(&scene).expect("sound shapes");
    let whole = judge::<f32>(&scene, &lattices, PATIENCE);
    let links = Simulation::<f32>::new(&scene, &lattices).model().link_counts().iter().sum::<usize>() as u64;
    let of = |share: f64| {
        let most_link_forces = count(share * (whole.work * links) as f64);
        judge::<f32>(&scene, &lattices, Patience { most_link_forces, ..PATIENCE })
    };
    let [hopeful, half, hopeless] = [0.95, 0.5, 0.3].map(of);
    assert!([&hopeful, &half, &hopeless].iter().all(|verdict| verdict.cut_short) && !whole.cut_short, "{whole:?}");
    let share = |verdict: &Verdict| verdict.work as f64 / whole.work as f64;
    assert!(share(&hopeful) > 0.9, "nearly all may be enough: {hopeful:?} of {whole:?}");
    // It is over with what is left if it then goes on three times as fast.
    assert!((0.22..0.28).contains(&share(&half)), "half may be enough until a quarter is over: {half:?} of {whole:?}");
    assert!(share(&hopeless) < 0.1, "three tenths cannot be: {hopeless:?} of {whole:?}");
}

#[test]
fn work_that_nobody_told_of_is_seen() {
    let scene = falling_cube();
    let lattices = lattices(&scene).expect("sound shapes");
    let patience = Patience { seconds: 1.0, most_link_forces: u64::MAX };
    let fault = |told: bool| {
        let mut simulation = Simulation::<f32>::new(&scene, &lattices);
        let mut motion_judge = MotionJudge::open(&simulation, patience);
        while motion_judge.verdict.simulated_secs < 0.6 {
            assert!(motion_judge.substep(&mut simulation), "{:?}", motion_judge.verdict);
        }
        let passes = count(200.0 * motion_judge.predicted_work_rate);
        motion_judge.link_forces += passes * motion_judge.links;
        motion_judge.totals.counters.contact_parts += if told { passes } else { 0 };
        motion_judge.substep(&mut simulation);
        motion_judge.verdict.fault
    };
    assert_eq!([true, false].map(fault), [None, Some(Fault::Work)]);
}
