//! Models whose cells weigh the sampled part of the model in them.

use std::fmt::Write;
use std::path::Path;

use gelatin::math::rng::Rng;
use gelatin::physics::{BodyModel, Simulation};
use gelatin::report::extremes::{Edition, extreme_of, lattices};
use gelatin::report::judge::{Patience, judge_disturbed};
use gelatin::report::statics::{Linear, dot};
use gelatin::scene::body::{MassFrom, ModelShape};
use gelatin::scene::resolve::resolve;
use gelatin::scene::{Body, Material, Shape, Solid};
use glam::DVec3;

use crate::support::alone;

const SOLID: Solid = Solid { young_modulus: 2e5, density: 1000.0, damping_ratio: 0.05, ..Solid::DEFAULT };

fn compiled(path: &Path, divisions: u32, mass_from: MassFrom) -> BodyModel<f64> {
    let path = path.to_string_lossy().into_owned();
    let shape = ModelShape { path, divisions, mass_from, ..ModelShape::default() };
    let body = Body { shape: Shape::Model(shape), material: Material::Solid(SOLID), ..Body::default() };
    let simulation = Simulation::from_scene(&alone(body, 1e-3), Path::new("")).expect("a sound model");
    simulation.model().bodies[0].clone()
}

/// A rod along x, 1 m long, whose section is a polygon of `corners` corners in a circle.
fn rod(radius: f64, corners: usize) -> String {
    let mut text = String::new();
    for x in [0.0, 1.0] {
        for corner in 0..corners {
            let angle = std::f64::consts::TAU * corner as f64 / corners as f64;
            let _ = writeln!(text, "v {x} {} {}", radius * libm::cos(angle), radius * libm::sin(angle));
        }
    }
    for corner in 0..corners {
        let next = (corner + 1) % corners;
        let [a, b, c, d] = [corner + 1, next + 1, corners + next + 1, corners + corner + 1];
        let _ = writeln!(text, "f {a} {b} {c} {d}");
    }
    let face = |numbers: &mut dyn Iterator<Item = usize>| {
        numbers.fold("f".to_owned(), |face, number| [face, number.to_string()].join(" "))
    };
    let _ = writeln!(text, "{}\n{}", face(&mut (1..=corners).rev()), face(&mut (corners + 1..=2 * corners)));
    text
}

/// Puts closed models of all sizes into extreme scenes, as solids with sampled masses.
#[test]
fn sampled_models_stay_whole_in_extreme_scenes() {
    let patience = Patience { seconds: 2.0, most_link_forces: 2_000_000 };
    let mut found = Vec::new();
    let (mut looked_at, mut whole) = (0, 0);
    for number in 0..300 {
        let (mut scene, disturbances) = extreme_of(Edition::Second, 3, number);
        let mut rng = Rng::new(number);
        let mut sampled = false;
        for body in &mut scene.bodies {
            let Shape::Model(model) = &mut body.shape else { continue };
            model.mass_from = MassFrom::Samples;
            let density = 10f64.powf(rng.between(1.0, 4.0));
            let speed = model.length / f64::from(model.divisions) / 10f64.powf(rng.between(-4.3, -1.5));
            let young_modulus = (density * speed * speed).clamp(1.0, 1e10);
            let damping_ratio = if rng.unit() < 0.4 { 0.0 } else { 10f64.powf(rng.between(-4.0, 0.0)) };
            body.material = Material::Solid(Solid { young_modulus, density, damping_ratio, ..Solid::DEFAULT });
            body.inlays.clear();
            sampled = true;
        }
        if sampled {
            let lattices = lattices(&scene).expect("sound shapes");
            let verdict = judge_disturbed::<f32>(&scene, &disturbances, &lattices, patience);
            looked_at += 1;
            whole += u32::from(!verdict.cut_short);
            found.extend(verdict.fault.map(|fault| format!("scene {number}: {}: {}", fault.words(), verdict.words)));
        }
    }
    assert!(found.is_empty(), "{} of {looked_at}:\n{}", found.len(), found.join("\n"));
    assert!(looked_at > 35 && 3 * whole > looked_at, "only {whole} of {looked_at} were watched to their end");
}

/// The volume of a body's mesh, m³ (Gauss).
fn enclosed(path: &Path) -> f64 {
    let shape = ModelShape { path: path.to_string_lossy().into_owned(), ..ModelShape::default() };
    let mesh = resolve(&Shape::Model(shape), Path::new(""), &()).expect("a sound model").mesh.expect("a model");
    let six = |at: usize| {
        let [a, b, c] = mesh.corners(at);
        a.dot(b.cross(c))
    };
    (0..mesh.triangles.len()).map(six).sum::<f64>() / 6.0
}

fn mass(body: &BodyModel<f64>) -> f64 {
    (0..body.start.len()).map(|particle| body.mass(particle)).sum()
}

#[test]
fn a_model_weighs_its_density_times_its_volume_in_any_number_of_divisions() {
    let folder = tempfile::tempdir().expect("a folder");
    let round = folder.path().join("rod.obj");
    std::fs::write(&round, rod(0.13, 96)).expect("a file");
    let section = std::f64::consts::PI * 0.13 * 0.13;
    assert!((enclosed(&round) / section - 1.0).abs() < 1e-3, "96 corners are nearly round");
    for (path, least_off) in [(Path::new("builtin:spot.obj"), 0.05), (&round, 0.1)] {
        let exact = SOLID.density * enclosed(path);
        let mut most_off: f64 = 0.0;
        for divisions in [7, 20, 40] {
            let [whole, part] = [MassFrom::Cells, MassFrom::Samples].map(|from| mass(&compiled(path, divisions, from)));
            assert!((part / exact - 1.0).abs() < 1e-9, "{path:?} in {divisions}: {part} kg, not {exact} kg");
            most_off = most_off.max((whole / exact - 1.0).abs());
        }
        assert!(most_off > least_off, "the control: {path:?} of full cells is {most_off} off at most");
    }
}

/// Boxes, each given by two corners, all facing outwards.
fn boxes(of: &[[[f64; 3]; 2]]) -> String {
    let mut text = String::new();
    for (number, ends) in of.iter().enumerate() {
        for corner in 0..8 {
            let [x, y, z] = [0, 1, 2].map(|axis| ends[corner >> axis & 1][axis]);
            let _ = writeln!(text, "v {x} {y} {z}");
        }
        for face in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
            let [a, b, c, d] = face.map(|corner| 8 * number + corner + 1);
            let _ = writeln!(text, "f {a} {b} {c} {d}");
        }
    }
    text
}

#[test]
fn a_table_whose_legs_reach_into_its_top_weighs_what_both_have_together() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("table.obj");
    let leg = |x: f64, z: f64| [[x, 0.0, z], [x + 0.05, 0.57, z + 0.05]];
    let top = [[0.0, 0.55, 0.0], [1.0, 0.6, 0.7]];
    let all = [top, leg(0.05, 0.05), leg(0.9, 0.05), leg(0.05, 0.6), leg(0.9, 0.6)];
    std::fs::write(&path, boxes(&all)).expect("a file");
    let exact = SOLID.density * (0.05 * 0.7 + 4.0 * 0.05 * 0.05 * 0.55);
    for divisions in [7, 20, 40] {
        let mass = mass(&compiled(&path, divisions, MassFrom::Samples));
        assert!((mass / exact - 1.0).abs() < 1e-2, "{divisions}: {mass} kg, not {exact} kg");
    }
}

/// The mean deflection of a round cantilever under its own weight, weighted by mass, over that of Timoshenko's beam:
/// `ρ g L² (L²/(5 E r²) + 1/(3 k G))` with Poisson's ratio 1/4 and Cowper's k = 15/17 for it.
fn deflection(body: &Linear, radius: f64) -> f64 {
    let mut body = body.clone();
    body.hold_axes(DVec3::ONE, |start| start.x < -0.5 + 1e-9);
    let load: Vec<DVec3> = body.mass.iter().map(|mass| DVec3::NEG_Y * (9.81 * mass)).collect();
    let found = dot(&load, &body.solve(&load).expect("it is held")) / (9.81 * body.mass.iter().sum::<f64>());
    let weight = SOLID.density * 9.81 / SOLID.young_modulus;
    found / (weight * (1.0 / (5.0 * radius * radius) + 2.5 * 17.0 / (3.0 * 15.0)))
}

/// The stretch of a rod that hangs from its end under its own weight and is free to grow thinner, weighted by mass, over `ρ
/// g L²/(3 E)`.
fn stretch(body: &Linear) -> f64 {
    let mut body = body.clone();
    let is_end = |start: DVec3| start.x < -0.5 + 1e-9;
    // Two particles side by side along z keep the rod from moving across and from turning about its axis.
    let near_axis = |a: &&DVec3, b: &&DVec3| a.y.abs().total_cmp(&b.y.abs()).then(a.z.total_cmp(&b.z));
    let first = *body.start.iter().filter(|start| is_end(**start)).min_by(near_axis).expect("an end");
    let is_beside = |start: DVec3| is_end(start) && start.y.to_bits() == first.y.to_bits();
    body.hold_axes(DVec3::X, is_end);
    body.hold_axes(DVec3::Y, is_beside);
    body.hold_axes(DVec3::Z, |start| start == first);
    let load: Vec<DVec3> = body.mass.iter().map(|mass| DVec3::X * (9.81 * mass)).collect();
    let found = dot(&load, &body.solve(&load).expect("it is held")) / (9.81 * body.mass.iter().sum::<f64>());
    found / (SOLID.density * 9.81 / (3.0 * SOLID.young_modulus))
}

/// Few cells across bend less than many, independently of sampling; a hanging rod stretches alike.
#[test]
fn a_round_rod_that_hangs_sags_alike_in_any_number_of_divisions() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("rod.obj");
    for radius in [0.13, 0.09] {
        std::fs::write(&path, rod(radius, 96)).expect("a file");
        let of = |divisions: u32, from: MassFrom| stretch(&Linear::of(&compiled(&path, divisions, from)));
        let [coarse, middle, fine] = [7, 20, 40].map(|divisions| of(divisions, MassFrom::Samples));
        let words = format!("{radius} m: {coarse}, {middle} and {fine} of what a bar has");
        assert!((coarse / fine - 1.0).abs() < 0.02 && (middle / fine - 1.0).abs() < 0.02, "{words}");
        assert!((fine - 1.0).abs() < 0.03, "{words}");
    }
}

/// If only the masses came from samples (SC), the rod would be lighter but as stiff as its cells; so the stiffness follows,
/// too.
#[test]
fn a_round_rod_bends_more_like_a_beam_if_its_cells_are_as_full_as_they_are() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("rod.obj");
    for radius in [0.13, 0.09] {
        std::fs::write(&path, rod(radius, 96)).expect("a file");
        for divisions in [20, 40] {
            let [whole, part] =
                [MassFrom::Cells, MassFrom::Samples].map(|from| Linear::of(&compiled(&path, divisions, from)));
            let mut light = whole.clone();
            light.mass.clone_from(&part.mass);
            let [whole, part, light] = [whole, part, light].map(|body| (deflection(&body, radius) - 1.0).abs());
            let words =
                format!("{radius} m in {divisions}: off by {part}, {whole} of full cells, {light} if only lighter");
            assert!(part < whole && part < light, "{words}");
            assert!(divisions < 40 || part < 0.6 * whole, "{words}");
        }
    }
}
