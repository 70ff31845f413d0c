//! Bodies that meet each other with their original meshes: points of one against the surface of the other.

use std::path::Path;
use std::sync::Arc;

use gelatin::math::Real;
use gelatin::physics::{Arrival, BodyPoint, SimdLevel, Simulation};
use gelatin::scene::body::{ModelShape, OccupancyChoice, Pose};
use gelatin::scene::material::Solid;
use gelatin::scene::{Body, ContactOn, Material, Scene, Shape};
use glam::DVec3;

use crate::bodies::momenta;
use crate::determinism::within;
use crate::mesh_models::{ball_obj, box_obj};
use crate::support::{falling, plane, run};

/// A model of an OBJ text in `divisions` divisions, with this position of its middle (m) and this velocity (m/s).
fn model(folder: &Path, obj: &str, divisions: u32, position: [f64; 3], velocity: [f64; 3]) -> Body {
    let path = folder.join(format!("{}.obj", obj.len()));
    std::fs::write(&path, obj).expect("a file");
    let path = path.to_string_lossy().into_owned();
    Body {
        shape: Shape::Model(ModelShape { path, divisions, ..ModelShape::default() }),
        material: Material::Solid(Solid { young_modulus: 1e5, damping_ratio: 0.0, ..Solid::default() }),
        pose: Pose { position, ..Pose::default() },
        velocity,
        contact_on: ContactOn::Mesh,
        ..Body::default()
    }
}

/// Weightless bodies that meet only each other.
fn meeting(bodies: Vec<Body>) -> Scene {
    let mut scene = falling(Body::default());
    scene.settings.gravity = [0.0; 3];
    scene.bodies = bodies;
    scene
}

fn simulate<R: Real>(scene: &Scene) -> Simulation<R> {
    Simulation::from_scene(scene, Path::new("")).expect("a sound scene")
}

/// Two balls of 1 m that come at each other along the diagonal, where cells stick out, at 1 m/s and slightly offset.
fn balls(folder: &Path, divisions: u32, contact_on: ContactOn) -> Scene {
    balls_of(folder, &ball_obj(24), divisions, contact_on)
}

/// As [`balls`], with a given model text.
fn balls_of(folder: &Path, obj: &str, divisions: u32, contact_on: ContactOn) -> Scene {
    let half = 0.5 * 1.3 / 3.0_f64.sqrt();
    let ball = |sign: f64| {
        let at = [sign * half, sign * half + 0.1 * sign, sign * half];
        let speed = -sign * 0.5 / 3.0_f64.sqrt();
        Body { contact_on, ..model(folder, obj, divisions, at, [speed; 3]) }
    };
    meeting(vec![ball(-1.0), ball(1.0)])
}

fn apart<R: Real>(simulation: &Simulation<R>) -> f64 {
    simulation.diagnostics_of(0).center.distance(simulation.diagnostics_of(1).center)
}

fn pushes<R: Real>(simulation: &Simulation<R>) -> bool {
    simulation.body_contacts().iter().any(|contact| contact.force != DVec3::ZERO)
}

#[test]
fn balls_meet_where_their_surfaces_are_and_not_where_their_cells_end() {
    // Balls with a hole are tested, too: one face is missing from the northern half and one from the southern.
    let whole = ball_obj(24);
    let is_kept = |(number, _): &(usize, &str)| ![1500, 2000].contains(number);
    let kept: Vec<&str> = whole.lines().enumerate().filter(is_kept).map(|(_, line)| line).collect();
    let holed = kept.join("\n");
    assert_eq!(holed.matches('f').count() + 2, whole.matches('f').count());
    let first_contact = |obj: &str, divisions, contact_on| {
        let folder = tempfile::tempdir().expect("a folder");
        let mut simulation = simulate::<f64>(&balls_of(folder.path(), obj, divisions, contact_on));
        (0..2000).find(|_| {
            simulation.step();
            pushes(&simulation)
        });
        let all = simulation.body_contacts();
        let of_mesh = all.iter().filter(|contact| matches!(contact.point, BodyPoint::OfMesh(_))).count();
        assert_eq!(of_mesh, if contact_on == ContactOn::Mesh { all.len() } else { 0 }, "points of {contact_on:?}");
        apart(&simulation)
    };
    for divisions in [6, 12] {
        let [on_mesh, on_cells] = [ContactOn::Mesh, ContactOn::Cells].map(|on| first_contact(&whole, divisions, on));
        let with_holes = first_contact(&holed, divisions, ContactOn::Mesh);
        eprintln!("{divisions} divisions: {on_mesh} m apart, with holes {with_holes} m, on cells {on_cells} m");
        for on_mesh in [on_mesh, with_holes] {
            assert!((on_mesh - 1.0).abs() < 0.01, "their surfaces meet 1 m apart, not {on_mesh} m");
        }
        assert!(on_cells > 1.0 + 0.3 / f64::from(divisions), "cells stick out: {on_cells} m");
    }
}

#[test]
fn equal_balls_head_on_exchange_their_speeds_within_two_percent() {
    let folder = tempfile::tempdir().expect("a folder");
    let ball = |at: f64, speed: f64| model(folder.path(), &ball_obj(24), 16, [at, 0.0, 0.0], [speed, 0.0, 0.0]);
    let mut simulation = simulate::<f32>(&meeting(vec![ball(-0.55, 1.0), ball(0.55, 0.0)]));
    let first = |simulation: &Simulation<f32>| simulation.diagnostics_of(0).momentum.x;
    let before = first(&simulation);
    run(&mut simulation, 0.7);
    assert!(!pushes(&simulation) && apart(&simulation) > 1.05, "they have met and gone");
    let kept = first(&simulation) / before;
    assert!((0.0..0.02).contains(&kept), "the first keeps {kept} of its momentum");
}

#[test]
fn momentum_and_angular_momentum_are_kept_and_no_energy_is_made() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut scene = balls(folder.path(), 8, ContactOn::Mesh);
    scene.bodies.iter_mut().for_each(|body| (body.friction_static, body.friction_dynamic) = (0.6, 0.4));
    let mut simulation = simulate::<f64>(&scene);
    let before = [0, 1].map(|body| momenta(&simulation, body));
    let energy = |simulation: &Simulation<f64>| simulation.diagnostics().energy.total();
    let (start, mut peak, mut met) = (energy(&simulation), 0.0_f64, 0);
    for _ in 0..1500 {
        simulation.step();
        met += usize::from(pushes(&simulation));
        peak = peak.max(energy(&simulation));
    }
    assert!(met > 20 && apart(&simulation) > 1.05 && !pushes(&simulation), "they met for {met} ms and have parted");
    let after = [0, 1].map(|body| momenta(&simulation, body));
    for (which, least) in [(0, 1.0), (1, 0.1)] {
        let all = before[0][which].length();
        let change = |body: usize| after[body][which] - before[body][which];
        let (given, lost) = (change(0).length(), (change(0) + change(1)).length());
        assert!(given > least && lost < 1e-13 * all.max(given), "{lost} of {given} that was exchanged, of {all}");
    }
    assert!(peak <= start * (1.0 + 1e-3), "{peak} J of {start} J");
}

#[test]
fn a_ball_lies_on_a_box_and_not_on_its_cells() {
    let gap = |contact_on| {
        let folder = tempfile::tempdir().expect("a folder");
        // With seven divisions the box's cells end above and below its surface.
        let mut lower = model(folder.path(), &box_obj(), 7, [0.0, 0.301, 0.0], [0.0; 3]);
        let mut upper = model(folder.path(), &ball_obj(24), 7, [0.0, 1.16, 0.0], [0.0; 3]);
        for body in [&mut lower, &mut upper] {
            body.material =
                Material::Solid(Solid { young_modulus: 2e6, density: 300.0, damping_ratio: 0.3, ..Solid::default() });
            (body.contact_on, body.friction_static, body.friction_dynamic) = (contact_on, 0.6, 0.5);
        }
        let mut scene = falling(lower);
        scene.bodies.push(upper);
        scene.obstacles.push(plane([0.0; 3], [0.0; 3], [0.6, 0.5]));
        let mut simulation = simulate::<f32>(&scene);
        run(&mut simulation, 3.0);
        let [low, high] = [0, 1].map(|body| simulation.diagnostics_of(body).center.y);
        high - low - 0.8
    };
    let [on_mesh, on_cells] = [ContactOn::Mesh, ContactOn::Cells].map(gap);
    eprintln!("surfaces {on_mesh} m apart, on cells {on_cells} m");
    assert!((-0.02..0.01).contains(&on_mesh), "the surfaces are {on_mesh} m apart");
    assert!(on_cells > 0.03, "the cells keep them {on_cells} m apart");
}

#[test]
fn a_plate_of_a_fifth_of_a_cell_is_not_passed_at_sixty_metres_a_second() {
    let folder = tempfile::tempdir().expect("a folder");
    let plate = box_obj().replace("0.3 ", "0.01 ");
    let mut plate = model(folder.path(), &plate, 10, [0.0; 3], [0.0; 3]);
    plate.material = Material::Solid(Solid { young_modulus: 1e6, damping_ratio: 0.3, ..Solid::default() });
    let ball = Body {
        material: plate.material.clone(),
        ..model(folder.path(), &ball_obj(24), 8, [0.0, 0.7, 0.0], [0.0, -60.0, 0.0])
    };
    let mut simulation = simulate::<f32>(&meeting(vec![plate, ball]));
    let places = |simulation: &Simulation<f32>| [0, 1].map(|body| simulation.diagnostics_of(body).center.y);
    let mut met = false;
    for _ in 0..60 {
        simulation.step();
        met |= pushes(&simulation);
        let [plate, ball] = places(&simulation);
        assert!(ball > plate, "the ball is still above: {ball} m over {plate} m");
    }
    assert!(met, "they meet");
}

#[test]
fn what_has_no_inside_is_met_at_its_cells() {
    let folder = tempfile::tempdir().expect("a folder");
    let sheet = "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nf 1 2 3 4\n";
    let mut sheet = model(folder.path(), sheet, 12, [0.0; 3], [0.0, 0.5, 0.0]);
    let Shape::Model(shape) = &mut sheet.shape else { panic!("a model") };
    (shape.length, shape.occupancy) = (2.0, OccupancyChoice::Solid);
    let ball = model(folder.path(), &ball_obj(24), 8, [0.0, 0.8, 0.0], [0.0, -0.5, 0.0]);
    let mut simulation = simulate::<f32>(&meeting(vec![sheet, ball]));
    run(&mut simulation, 1.5);
    let [low, high] = [0, 1].map(|body| simulation.diagnostics_of(body));
    assert!(high.center.y > low.center.y + 0.4, "the ball is above: {} over {}", high.center.y, low.center.y);
    assert!(high.momentum.y > -0.5 * simulation.diagnostics_of(1).mass_kg * 0.5, "it was pushed back");
}

#[test]
fn threads_levels_and_the_broad_phase_come_to_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = balls(folder.path(), 8, ContactOn::Mesh);
    let hash = |threads: usize, level: SimdLevel, broad_phase: bool| {
        let mut simulation = simulate::<f32>(&scene);
        (simulation.plan_mut().simd, simulation.plan_mut().broad_phase) = (level, broad_phase);
        simulation.set_threads(threads);
        within(threads, || run(&mut simulation, 0.5));
        assert!(pushes(&simulation), "they are in contact");
        simulation.hash()
    };
    let expected = hash(1, SimdLevel::best(), true);
    for threads in [2, 3] {
        assert_eq!(hash(threads, SimdLevel::best(), true), expected, "{threads} threads");
    }
    for level in SimdLevel::ALL.into_iter().filter(|level| level.is_available()) {
        assert_eq!(hash(1, level, true), expected, "{level:?}");
    }
    assert_eq!(hash(1, SimdLevel::best(), false), expected, "every point against every cell");
}

#[test]
fn what_bodies_meet_with_may_change_while_they_touch() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = balls(folder.path(), 8, ContactOn::Mesh);
    let mut simulation = simulate::<f32>(&scene);
    (0..2000).find(|_| simulation.step().last.body_contacts > 0).expect("they meet");
    let presses = |simulation: &Simulation<f32>, of_mesh: bool| {
        let mut all = simulation.state().presses.iter();
        all.all(|press| matches!(press.point, BodyPoint::OfMesh(_)) == of_mesh)
    };
    assert!(presses(&simulation, true) && !simulation.state().presses.is_empty());
    let mut other = scene.clone();
    other.bodies.iter_mut().for_each(|body| body.contact_on = ContactOn::Cells);
    for (scene, of_mesh) in [(&other, false), (&scene, true)] {
        let lattices: Vec<_> = simulation.model().bodies.iter().map(|body| Arc::clone(&body.lattice)).collect();
        simulation.set_parameters(scene, &lattices, &[], Arrival::Placed);
        assert!(presses(&simulation, of_mesh), "springs of what no longer meets are gone");
        let before = simulation.diagnostics().energy.total();
        run(&mut simulation, 0.05);
        assert!(simulation.diagnostics().energy.total() < 1.2 * before, "and nothing flies apart");
    }
}
