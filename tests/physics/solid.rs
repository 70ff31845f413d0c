//! Bodies given by Young's modulus and density are the same solid at every resolution.

use gelatin::physics::Arrival;
use gelatin::physics::BodyModel;
use gelatin::physics::Simulation;
use gelatin::report::statics::{Linear, dot, face_load, mean_displacement};
use gelatin::scene::body::{CellsShape, CubeShape, Inlay, PinBox};
use gelatin::scene::material::Spring;
use gelatin::scene::{Body, Material, Scene, Shape, Solid, Springs};
use glam::{DVec3, Vec3};

use crate::support::{alone, falling, lattices, plane, run, simulate};

const SOLID: Solid = Solid { young_modulus: 2e5, density: 1000.0, damping_ratio: 0.05, ..Solid::DEFAULT };

fn compiled(body: Body) -> BodyModel<f64> {
    simulate::<f64>(&alone(body, 1e-3)).model().bodies[0].clone()
}

/// A cube of 1 m.
fn cube(cells: u32, material: Material) -> Body {
    Body { shape: Shape::Cube(CubeShape { cells, size: 1.0 }), material, ..Body::default() }
}

fn solid_cube(cells: u32) -> Body {
    cube(cells, Material::Solid(SOLID))
}

/// The modulus, Pa, and Poisson's ratio, measured by a pull of 1 N at both ends along x.
fn pulled(body: &BodyModel<f64>, cells: u32) -> [f64; 2] {
    let body = Linear::of(body);
    let cell = 1.0 / f64::from(cells);
    let on = |face: DVec3, direction: DVec3| face_load(&body, DVec3::ONE, cell, face, direction);
    let ends = [on(DVec3::X, DVec3::X), on(DVec3::NEG_X, DVec3::NEG_X)];
    let load: Vec<DVec3> = ends[0].iter().zip(&ends[1]).map(|(a, b)| *a + *b).collect();
    let displacement = body.solve(&load).expect("it is in balance");
    let stretch = mean_displacement(&load, &displacement);
    let across = mean_displacement(&on(DVec3::Y, DVec3::Y), &displacement)
        + mean_displacement(&on(DVec3::NEG_Y, DVec3::NEG_Y), &displacement);
    [1.0 / stretch, -across / stretch]
}

#[test]
fn a_pull_measures_the_modulus_at_every_resolution() {
    for cells in [7, 10, 20, 40] {
        let [modulus, poisson] = pulled(&compiled(solid_cube(cells)), cells);
        let ratio = modulus / SOLID.young_modulus;
        assert!((ratio - 1.0).abs() < 2e-4, "{cells} cells an edge: {ratio} of the modulus");
        assert!((poisson - 0.25).abs() < 2e-4, "{cells} cells an edge: Poisson's ratio {poisson}");
    }
}

/// The patch test: an even stretch needs no forces except at its ends.
#[test]
fn an_even_stretch_is_in_balance_inside_and_at_free_surfaces() {
    let strain = DVec3::new(1.0, -0.25, -0.25);
    for cells in [7, 10, 20] {
        let body = Linear::of(&compiled(solid_cube(cells)));
        let displacement: Vec<DVec3> = body.start.iter().map(|start| *start * strain).collect();
        let force = body.stiffness_forces(&displacement);
        let at_ends = |start: &DVec3| start.x.abs() > 0.5 - 1e-9;
        let largest = |ends: bool| {
            let chosen = force.iter().zip(&body.start).filter(|(_, start)| at_ends(start) == ends);
            chosen.map(|(force, _)| force.length()).fold(0.0, f64::max)
        };
        assert!(largest(false) < 1e-5 * largest(true), "{cells}: {} N of {} N", largest(false), largest(true));
    }
}

/// The control: links that are not shared out are too stiff at every surface, the more so the more surface there is.
#[test]
fn springs_that_are_all_alike_are_stiffer_the_fewer_they_are() {
    let mut last = f64::INFINITY;
    for (cells, expected) in [(7, 1.174), (10, 1.126), (20, 1.068)] {
        let solid = compiled(solid_cube(cells));
        let alike = |family: usize| Spring { stiffness: solid.links[family].stiffness, damping: 0.0 };
        let springs = Springs {
            structural: alike(0),
            shear: alike(1),
            bending: Spring { stiffness: 0.0, damping: 0.0 },
            particle_mass: 0.01,
        };
        let [modulus, _] = pulled(&compiled(cube(cells, Material::Springs(springs))), cells);
        let ratio = modulus / SOLID.young_modulus;
        assert!((ratio - expected).abs() < 0.005 && ratio < last, "{cells} cells an edge: {ratio}, not {expected}");
        last = ratio;
    }
}

fn spread(of: &[f64]) -> f64 {
    of.iter().copied().fold(0.0, f64::max) / of.iter().copied().fold(f64::INFINITY, f64::min) - 1.0
}

fn weight(body: &Linear) -> Vec<DVec3> {
    body.mass.iter().map(|mass| DVec3::NEG_Y * (9.81 * mass)).collect()
}

/// The solid cube hung by its top, with the axes `held` held there.
fn hung(cells: u32, held: DVec3) -> Linear {
    let mut body = Linear::of(&compiled(solid_cube(cells)));
    body.hold_axes(held, |start| start.y > 0.5 - 1e-9);
    body
}

#[test]
fn a_hanging_body_sags_alike_at_every_resolution() {
    // If its top is free to shrink, the cube is a bar: ρ g L²/(2 E).
    let bar = SOLID.density * 9.81 / (2.0 * SOLID.young_modulus);
    let mut pinned = Vec::new();
    for cells in [7, 20, 40] {
        let sag = |held: DVec3| {
            let body = hung(cells, held);
            let bottom = face_load(&body, DVec3::ONE, 1.0 / f64::from(cells), DVec3::NEG_Y, DVec3::NEG_Y);
            mean_displacement(&bottom, &body.solve(&weight(&body)).expect("it is held"))
        };
        let [free, held] = [DVec3::Y, DVec3::ONE].map(sag);
        assert!((free / bar - 1.0).abs() < 2e-4, "{cells} divisions sag {free} m, a bar {bar} m");
        pinned.push(held);
    }
    assert!(spread(&pinned) < 0.02, "with a pinned top: {pinned:?}");
}

#[test]
fn a_body_swings_along_itself_alike_at_every_resolution() {
    let bar = std::f64::consts::FRAC_PI_2 * (SOLID.young_modulus / SOLID.density).sqrt();
    let mut found = Vec::new();
    for cells in [7, 20, 40] {
        let body = hung(cells, DVec3::Y);
        let sag = body.solve(&weight(&body)).expect("it is held");
        let omega = body.lowest_squared_frequency(sag).expect("it is held").sqrt();
        found.push(omega);
    }
    assert!(spread(&found) < 0.02, "rad/s: {found:?}");
    // A bar as thick as it is long swings more slowly, by the inertia of its own narrowing (Rayleigh, Love).
    assert!(found.iter().all(|omega| (0.9..1.0).contains(&(omega / bar))), "{found:?} against {bar}");
}

#[test]
fn a_body_weighs_its_cells() {
    let list = vec![[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [2, 1, 0]];
    let shape = Shape::Cells(CellsShape { list, size: 0.3 });
    let body = compiled(Body { shape, material: Material::Solid(SOLID), ..Body::default() });
    let mass: f64 = (0..body.start.len()).map(|particle| body.mass(particle)).sum();
    let expected = 5.0 * 0.3f64.powi(3) * SOLID.density;
    assert!((mass / expected - 1.0).abs() < 1e-12, "{mass} kg, not {expected} kg");
    let weight = weight(&Linear::of(&body));
    assert!((-dot(&weight, &vec![DVec3::Y; weight.len()]) / (9.81 * expected) - 1.0).abs() < 1e-12, "and its weight");
}

/// A cube hung by its top; the half of positive x is ten times as stiff.
fn half_stiff() -> Scene {
    let stiff = Solid { young_modulus: 10.0 * SOLID.young_modulus, ..SOLID };
    let mut body = solid_cube(6);
    body.inlays.push(Inlay { min: [0.0, -1.0, -1.0], max: [1.0; 3], solid: stiff, ..Inlay::default() });
    body.pins.push(PinBox { min: [-1.0, 0.49, -1.0], max: [1.0; 3] });
    falling(body)
}

#[test]
fn of_two_materials_in_one_body_the_stiffer_sags_less() {
    let scene = half_stiff();
    let mut simulation = simulate::<f32>(&scene);
    run(&mut simulation, 2.0);
    let body = &simulation.model().bodies[0];
    let sag = |x: f32| {
        let at = |start: &Vec3| (start.x - x).abs() < 1e-3 && start.y < -0.49 && start.z.abs() < 1e-3;
        let particle = body.start.iter().position(at).expect("a particle below");
        body.start[particle].y - simulation.state().position[particle].y
    };
    let [soft, middle, stiff] = [-0.5, 0.0, 0.5].map(sag);
    // The pull of the soft side tilts the stiff one, whose outer edge may even rise.
    assert!(soft > 2.0 * middle && middle > stiff, "{soft}, {middle}, {stiff} m");
}

#[test]
fn the_stiffest_part_of_a_body_limits_its_step_and_a_change_of_it_is_heeded() {
    let limit = |simulation: &Simulation<f64>| simulation.plan().limits.dt_limit_secs.expect("limited");
    let scene = half_stiff();
    let mut simulation = simulate::<f64>(&scene);
    let mut soft = scene.clone();
    soft.bodies[0].inlays.clear();
    let before = limit(&simulation);
    simulation.set_parameters(&soft, &lattices(&soft), &[Some(0)], Arrival::Placed);
    assert!(limit(&simulation) > 3.0 * before, "without the stiff half: {before} s, then {} s", limit(&simulation));
    let fresh = limit(&simulate::<f64>(&soft));
    assert!((limit(&simulation) / fresh - 1.0).abs() < 1e-15, "as if it had never been there: {fresh} s");
}

/// The force that holds a body at rest is its weight, however unequal its particles are.
#[test]
fn a_solid_rests_on_a_plane_with_its_weight() {
    let solid = Solid { damping_ratio: 0.5, ..SOLID };
    let mut scene = falling(cube(4, Material::Solid(solid)));
    scene.bodies[0].pose.position = [0.0, 0.5, 0.0];
    scene.obstacles.push(plane([0.0; 3], [0.0; 3], [0.5, 0.4]));
    let mut simulation = simulate::<f64>(&scene);
    run(&mut simulation, 4.0);
    let push: f64 = simulation.contacts().iter().map(|contact| contact.force.y).sum();
    let weight = SOLID.density * 9.81;
    assert!((push / weight - 1.0).abs() < 1e-2, "pushed by {push} N against a weight of {weight} N");
    let depth = -simulation.diagnostics().bounds.min.y;
    assert!((0.0..=0.02).contains(&depth), "no deeper than a fiftieth of its size: {depth} m");
    assert!(simulation.diagnostics().max_speed < 1e-3, "and still");
}
