//! The predicted limit of the step against that of the body itself, on random extreme settings.
//!
//! Small vibrations stay bounded up to the step at which the largest eigenvalue of `M⁻¹ (dt² K + 2 s dt C)` is 4. Lanczos'
//! method finds that step on the compiled body. A few settings are also run, to check that a larger step blows up.

use gelatin::math::rng::Rng;
use gelatin::physics::BodyModel;
use gelatin::scene::body::{CellsShape, CubeShape, Inlay, MassFrom, ModelShape};
use gelatin::scene::material::Spring;
use gelatin::scene::settings::Integrator;
use gelatin::scene::{Body, Material, Scene, Shape, Solid, Springs};
use glam::DVec3;

use crate::support::{alone, simulate};

/// Steps of Lanczos' method: enough to make the largest eigenvalue exact to far more digits than are compared.
const LANCZOS: usize = 80;

struct Case {
    scene: Scene,
    /// The share `s` of the damping in the eigenvalue.
    share: f64,
}

impl Case {
    fn body(&self) -> BodyModel<f64> {
        simulate::<f64>(&self.scene).model().bodies[0].clone()
    }

    fn predicted(&self) -> f64 {
        simulate::<f64>(&self.scene).plan().limits.dt_limit_secs.expect("links limit the step")
    }

    /// The limit of the body itself, s.
    fn measured(&self, predicted: f64) -> f64 {
        let body = self.body();
        let mut dt = predicted;
        // The eigenvalue grows with dt at a power between 1 and 2.
        let mut last: Option<(f64, f64)> = None;
        for _ in 0..12 {
            let lambda = largest_eigenvalue(&body, dt, self.share);
            let power = last.map_or(1.5, |(before, at)| ((lambda / at).ln() / (dt / before).ln()).clamp(0.9, 2.1));
            let next = dt * (4.0 / lambda).powf(1.0 / power);
            last = Some((dt, lambda));
            if (next / dt - 1.0).abs() < 1e-7 {
                return next;
            }
            dt = next;
        }
        dt
    }
}

/// The largest eigenvalue of `M^-½ (dt² K + 2 s dt C) M^-½`, by Lanczos' method from a fixed start.
fn largest_eigenvalue(body: &BodyModel<f64>, dt: f64, share: f64) -> f64 {
    let root: Vec<f64> = (0..body.start.len()).map(|particle| body.inverse_mass(particle).sqrt()).collect();
    let mut links = Vec::new();
    for family in &body.links {
        for (number, link) in family.links.iter().enumerate() {
            let [k, d] = family.constants(number);
            let load = (dt * dt * k + 2.0 * share * dt * d) * link.inverse_rest_length;
            let ends = link.ends.map(|end| end as usize);
            if load > 0.0 {
                links.push((ends, (body.start[ends[1]] - body.start[ends[0]]) * link.inverse_rest_length, load));
            }
        }
    }
    let apply = |v: &[DVec3]| {
        let mut out = vec![DVec3::ZERO; v.len()];
        for &([i, j], direction, load) in &links {
            let pull = direction * (load * direction.dot(v[j] * root[j] - v[i] * root[i]));
            out[j] += pull * root[j];
            out[i] -= pull * root[i];
        }
        out
    };
    let mut rng = Rng::new(1);
    let mut v: Vec<DVec3> = root
        .iter()
        .map(|_| DVec3::new(rng.between(-1.0, 1.0), rng.between(-1.0, 1.0), rng.between(-1.0, 1.0)))
        .collect();
    let norm = |v: &[DVec3]| v.iter().map(|v| v.length_squared()).sum::<f64>().sqrt();
    let scale = norm(&v).recip();
    for v in &mut v {
        *v *= scale;
    }
    let (mut before, mut beta) = (vec![DVec3::ZERO; v.len()], 0.0);
    let (mut diagonal, mut beside) = (Vec::new(), Vec::new());
    for _ in 0..LANCZOS {
        let mut w = apply(&v);
        let alpha: f64 = w.iter().zip(&v).map(|(w, v)| w.dot(*v)).sum();
        for i in 0..w.len() {
            w[i] -= v[i] * alpha + before[i] * beta;
        }
        diagonal.push(alpha);
        beta = norm(&w);
        if beta < 1e-12 * alpha.abs() {
            break;
        }
        beside.push(beta);
        for w in &mut w {
            *w /= beta;
        }
        before = std::mem::replace(&mut v, w);
    }
    largest_of_tridiagonal(&diagonal, &beside)
}

/// The largest eigenvalue of a tridiagonal matrix, by bisection on Sturm's count of the eigenvalues above a number.
fn largest_of_tridiagonal(diagonal: &[f64], beside: &[f64]) -> f64 {
    let beta = |i: usize| if i == 0 { 0.0 } else { beside[i - 1] };
    let is_above_all = |x: f64| {
        let mut pivot = 1.0;
        (0..diagonal.len()).all(|i| {
            pivot = diagonal[i] - x - beta(i) * beta(i) / pivot;
            pivot < 0.0
        })
    };
    let mut low = diagonal.iter().copied().fold(0.0, f64::max);
    let mut high = low + 2.0 * beside.iter().copied().fold(0.0, f64::max);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if is_above_all(middle) { high = middle } else { low = middle }
    }
    high
}

/// A cube of eight particles an edge or more, whole or without a third of its cells.
fn shape(rng: &mut Rng) -> Shape {
    let size = 10f64.powf(rng.between(-2.0, 0.0));
    let cells = 7 + i32::try_from(rng.next_u64() % 3).expect("small");
    if rng.unit() < 0.6 {
        return Shape::Cube(CubeShape { cells: cells.unsigned_abs(), size: size * f64::from(cells) });
    }
    let all = (0..cells).flat_map(|x| (0..cells).flat_map(move |y| (0..cells).map(move |z| [x, y, z])));
    Shape::Cells(CellsShape { list: all.filter(|_| rng.unit() < 0.67).collect(), size })
}

fn case(rng: &mut Rng, material: impl Fn(&mut Rng) -> Material, verlet: bool) -> Case {
    let body = Body { shape: shape(rng), material: material(rng), ..Body::default() };
    let mut scene = alone(body, 1e-3);
    let mut share = 1.0;
    if verlet {
        scene.settings.integrator = Integrator::Verlet;
        share = 2.0;
    }
    Case { scene, share }
}

fn decades(rng: &mut Rng, low: f64, high: f64) -> f64 {
    10f64.powf(rng.between(low, high))
}

/// Stiffness and damping of every family over 8 decades, a third of the families without damping; mass over 8.
fn springs(rng: &mut Rng) -> Material {
    let mut spring = || Spring {
        stiffness: decades(rng, 0.0, 8.0),
        damping: if rng.unit() < 0.33 { 0.0 } else { decades(rng, -3.0, 5.0) },
    };
    let [structural, shear, bending] = [spring(), spring(), spring()];
    Material::Springs(Springs { structural, shear, bending, particle_mass: decades(rng, -6.0, 2.0) })
}

fn solid(rng: &mut Rng) -> Material {
    let damping_ratio = if rng.unit() < 0.33 { 0.0 } else { decades(rng, -4.0, 1.0) };
    Material::Solid(Solid {
        young_modulus: decades(rng, 1.0, 9.0),
        density: decades(rng, -1.0, 4.0),
        damping_ratio,
        ..Solid::DEFAULT
    })
}

/// Predicted over measured, smallest first.
fn ratios(cases: &[Case]) -> Vec<f64> {
    let mut ratios: Vec<f64> = cases
        .iter()
        .map(|case| {
            let predicted = case.predicted();
            predicted / case.measured(predicted)
        })
        .collect();
    ratios.sort_by(f64::total_cmp);
    ratios
}

fn cases(count: usize, seed: u64, material: impl Fn(&mut Rng) -> Material) -> Vec<Case> {
    let mut rng = Rng::new(seed);
    (0..count).map(|number| case(&mut rng, &material, number % 4 == 3)).collect()
}

#[test]
fn the_limit_of_springs_is_never_above_that_of_the_body_and_near_it() {
    let ratios = ratios(&cases(200, 23, springs));
    let [median, most] = [ratios[100], ratios[199]];
    assert!(most <= 1.0 + 1e-6, "predicted is above measured: {most}");
    assert!(median >= 0.9, "predicted is far below measured: {median}");
}

#[test]
fn the_limit_of_solids_is_never_above_that_of_the_body() {
    let ratios = ratios(&cases(100, 29, solid));
    let [median, most] = [ratios[50], ratios[99]];
    assert!(most <= 1.0 + 1e-6, "predicted is above measured: {most}");
    assert!(median >= 0.97, "predicted is far below measured: {median}");
}

#[test]
fn the_limit_of_two_solids_in_one_body_is_that_of_the_stiffest_cell() {
    let mut rng = Rng::new(41);
    let cases: Vec<Case> = (0..30)
        .map(|number| {
            let mut case = case(&mut rng, solid, number % 4 == 3);
            let Material::Solid(inside) = solid(&mut rng) else { panic!("a solid") };
            let end = rng.between(-0.1, 0.1);
            case.scene.bodies[0].inlays =
                vec![Inlay { min: [-20.0; 3], max: [end, 20.0, 20.0], solid: inside, ..Inlay::default() }];
            case
        })
        .collect();
    let ratios = ratios(&cases);
    let [median, most] = [ratios[15], ratios[29]];
    assert!(most <= 1.0 + 1e-6, "predicted is above measured: {most}");
    assert!(median >= 0.75, "predicted is far below measured: {median}");
}

/// Cells with sampled masses are no stiffer for their mass than full ones.
#[test]
fn the_limit_of_sampled_models_is_never_above_that_of_the_body() {
    let mut rng = Rng::new(43);
    let cases: Vec<Case> = (0..20)
        .map(|number: usize| {
            let path = format!("builtin:{}.obj", ["spot", "tree", "comb", "coupler"][number % 4]);
            let divisions = 6 + u32::try_from(rng.next_u64() % 6).expect("small");
            let shape = ModelShape { path, divisions, mass_from: MassFrom::Samples, ..ModelShape::default() };
            let body = Body { shape: Shape::Model(shape), material: solid(&mut rng), ..Body::default() };
            Case { scene: alone(body, 1e-3), share: 1.0 }
        })
        .collect();
    let ratios = ratios(&cases);
    let [median, most] = [ratios[10], ratios[19]];
    assert!(most <= 1.0 + 1e-6, "predicted is above measured: {most}");
    assert!(median >= 0.95, "predicted is far below measured: {median}");
}

/// Whether noise of a thousandth of a cell stays below a tenth of a cell for 1500 steps of this size.
fn survives(case: &Case, dt: f64) -> bool {
    let mut scene = case.scene.clone();
    scene.settings.dt = dt;
    let mut simulation = simulate::<f64>(&scene);
    let cell = simulation.model().bodies[0].inverse_cell_size.recip();
    let mut state = simulation.state().clone();
    let start = state.position.clone();
    let mut rng = Rng::new(3);
    for position in &mut state.position {
        *position += DVec3::new(rng.between(-1.0, 1.0), rng.between(-1.0, 1.0), rng.between(-1.0, 1.0)) * (1e-3 * cell);
    }
    simulation.set_state(state);
    (0..1500).all(|_| {
        let diverged = simulation.step().diverged;
        let mut moved = simulation.state().position.iter().zip(&start).map(|(now, start)| now.distance(*start));
        !diverged && moved.all(|moved| moved < 0.1 * cell)
    })
}

#[test]
fn what_is_measured_is_where_bodies_blow_up() {
    let all = cases(8, 31, springs).into_iter().chain(cases(8, 37, solid));
    for (number, case) in all.enumerate() {
        let predicted = case.predicted();
        let measured = case.measured(predicted);
        assert!(survives(&case, 0.99 * predicted), "case {number} blew up below {predicted:e} s");
        assert!(!survives(&case, 1.03 * measured), "case {number} survived above {measured:e} s");
    }
}
