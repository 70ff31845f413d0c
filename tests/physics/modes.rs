//! Modes against beam theory and against the frequencies of the full simulation. Motion by modes is tested in `modal`.

use std::f64::consts::PI;

use gelatin::modal::{self, Mode, Modes, Wanted};
use gelatin::physics::{BodyModel, Simulation};
use gelatin::scene::body::{CellsShape, CubeShape, PinBox};
use gelatin::scene::{Body, Material, Shape, Solid};
use glam::DVec3;

use super::support::{alone, simulate};

pub(crate) const SOLID: Solid = Solid { young_modulus: 1e5, density: 1000.0, damping_ratio: 0.0, ..Solid::DEFAULT };
/// The speed of waves along a thin bar, m/s.
const BAR_SPEED: f64 = 10.0;
/// Length over thickness.
const SLENDERNESS: i32 = 8;

/// A bar of 1 m along x with so many cells across it.
fn bar(across: i32) -> Body {
    let all =
        (0..across * SLENDERNESS).flat_map(|x| (0..across).flat_map(move |y| (0..across).map(move |z| [x, y, z])));
    let shape = CellsShape { list: all.collect(), size: 1.0 / f64::from(across * SLENDERNESS) };
    Body { shape: Shape::Cells(shape), material: Material::Solid(SOLID), ..Body::default() }
}

pub(crate) fn cantilever(across: i32) -> Body {
    Body { pins: vec![PinBox { min: [-9.0; 3], max: [-0.4999, 9.0, 9.0] }], ..bar(across) }
}

fn cube() -> Body {
    let shape = Shape::Cube(CubeShape { cells: 5, size: 1.0 });
    Body { shape, material: Material::Solid(SOLID), ..Body::default() }
}

fn compiled(body: Body) -> BodyModel<f64> {
    simulate::<f64>(&alone(body, 1e-3)).model().bodies[0].clone()
}

fn found(body: &BodyModel<f64>, count: usize) -> Modes {
    modal::modes(body, Wanted { count, ..Wanted::default() }, &()).expect("modes")
}

/// The mode most similar to a displacement of the particles, weighted by mass.
fn nearest<'a>(body: &BodyModel<f64>, modes: &'a [Mode], way: impl Fn(f64) -> f64) -> &'a Mode {
    let likeness = |mode: &Mode| {
        let of = |p: usize| body.mass(p) * mode.shape[p].x * way(body.start[p].x);
        (0..body.start.len()).map(of).sum::<f64>().abs()
    };
    modes.iter().max_by(|a, b| likeness(a).total_cmp(&likeness(b))).expect("there are modes")
}

#[test]
fn a_free_bar_swings_along_itself_as_theory_says() {
    for across in [2, 3] {
        let body = compiled(bar(across));
        let modes = found(&body, 12).modes;
        let along = nearest(&body, &modes, |x| (PI * x).sin());
        // Rayleigh's correction for lateral motion is less than a thousandth here.
        let theory = 0.5 * BAR_SPEED;
        let off = along.frequency_hz / theory - 1.0;
        assert!(off.abs() < 0.005, "{across} cells across: {} Hz for {theory} Hz", along.frequency_hz);
    }
}

/// The lowest frequency of Timoshenko's cantilever of 1 m, Hz (T. C. Huang, *Journal of Applied Mechanics* 28, 1961), for
/// Poisson's ratio 1/4 and Cowper's coefficient.
fn timoshenko_hz() -> f64 {
    let thickness = 1.0 / f64::from(SLENDERNESS);
    let r2 = thickness * thickness / 12.0;
    let poisson = 0.25;
    let coefficient = 10.0 * (1.0 + poisson) / (12.0 + 11.0 * poisson);
    let s2 = r2 * 2.0 * (1.0 + poisson) / coefficient;
    let equation = |b: f64| {
        let (sum, difference) = (r2 + s2, r2 - s2);
        let root = (difference * difference + 4.0 / (b * b)).sqrt();
        let [alpha, beta] = [-sum, sum].map(|part| f64::midpoint(part, root).sqrt());
        let shared = b * sum / (1.0 - b * b * r2 * s2).sqrt();
        2.0 + (b * b * difference * difference + 2.0) * (b * alpha).cosh() * (b * beta).cos()
            - shared * (b * alpha).sinh() * (b * beta).sin()
    };
    let [mut low, mut high] = [1.0, 4.0];
    assert!(equation(low) > 0.0 && equation(high) < 0.0, "the first root is between");
    while high - low > 1e-12 {
        let middle = 0.5 * (low + high);
        if equation(middle) > 0.0 { low = middle } else { high = middle }
    }
    low * r2.sqrt() * BAR_SPEED / (2.0 * PI)
}

#[test]
fn a_cantilever_comes_nearer_to_beam_theory_with_every_cell_across_it() {
    let theory = timoshenko_hz();
    let euler = 1.875_104_f64.powi(2) * (1.0 / 12.0_f64).sqrt() / f64::from(SLENDERNESS) * BAR_SPEED / (2.0 * PI);
    assert!(theory < euler && theory > 0.97 * euler, "{theory} Hz by Timoshenko, {euler} Hz by Euler and Bernoulli");
    let ratios: Vec<f64> = [2, 3, 4, 6]
        .into_iter()
        .map(|across| {
            let modes = found(&compiled(cantilever(across)), 3).modes;
            let [first, second] = [0, 1].map(|mode| modes[mode].frequency_hz);
            assert!((first / second - 1.0).abs() < 1e-6, "up and down as to and fro: {first} and {second} Hz");
            first / theory
        })
        .collect();
    // Links across a cell make the bar too stiff in bending, as they do at rest.
    assert!(ratios.is_sorted_by(|a, b| a > b) && ratios[3] > 1.0, "from the stiff side: {ratios:?}");
    assert!(ratios[0] < 1.2 && ratios[3] < 1.04, "and near in the end: {ratios:?}");
}

/// Decomposes Lamé's mode of a free cube into the cube's modes. Returns their mean frequency, weighted by their shares, Hz,
/// and the sum of the shares.
fn lame(cells: u32) -> (f64, f64) {
    let shape = Shape::Cube(CubeShape { cells, size: 1.0 });
    let body = compiled(Body { shape, material: Material::Solid(SOLID), ..Body::default() });
    let way = |at: DVec3| {
        let [x, y, _] = (at * PI).to_array();
        DVec3::new(-x.sin() * y.cos(), x.cos() * y.sin(), 0.0)
    };
    let by_mass = |a: &dyn Fn(usize) -> DVec3, b: &dyn Fn(usize) -> DVec3| {
        (0..body.start.len()).map(|p| body.mass(p) * a(p).dot(b(p))).sum::<f64>()
    };
    let wanted = |p: usize| way(body.start[p]);
    let all = by_mass(&wanted, &wanted);
    let (mut sum, mut share) = (0.0, 0.0);
    for mode in &found(&body, 24).modes {
        let shape = |p: usize| mode.shape[p];
        let part = by_mass(&shape, &wanted).powi(2) / (by_mass(&shape, &shape) * all);
        (sum, share) = (sum + part * mode.frequency_hz, share + part);
    }
    (sum / share, share)
}

/// The only modes of a free cube known in closed form: `√(G/ρ)/(√2 L)`, independent of Poisson's ratio (Lamé 1852; Mindlin,
/// "Simple modes of vibration of crystals", *Journal of Applied Physics* 27, 1956).
#[test]
fn a_free_cube_swings_in_lames_mode_as_theory_says() {
    let theory = BAR_SPEED * (1.0_f64 / 2.5).sqrt() / 2.0_f64.sqrt();
    let off = [4, 8, 12].map(|cells| {
        let (frequency, share) = lame(cells);
        assert!(share > 0.98, "{cells} cells: only {share} of it is in the lowest modes");
        frequency / theory - 1.0
    });
    assert!(off.is_sorted_by(|a, b| a.abs() > 1.8 * b.abs()), "second order or nearly: {off:?}");
    assert!(off[2].abs() < 0.01, "{off:?}");
}

/// The frequency of the full simulation when it is thrown into a mode, Hz, from the zeros of the mode's amplitude.
fn simulated_hz(body: Body, number: usize) -> (f64, f64) {
    let start = simulate::<f64>(&alone(body.clone(), 1e-3));
    let modes = found(&start.model().bodies[0], number + 1).modes;
    let mode = &modes[number];
    let dt = (0.2 * start.plan().limits.dt_limit_secs.unwrap_or(1.0)).min(0.005 / mode.frequency_hz);
    let mut simulation: Simulation<f64> = simulate(&alone(body, dt));
    let model = simulation.model().bodies[0].clone();
    let mut state = simulation.state().clone();
    let small = 1e-4 * model.lattice.grid.cell_size / mode.reach() * mode.angular_frequency();
    for (velocity, way) in state.velocity.iter_mut().zip(&mode.shape) {
        *velocity = *way * small;
    }
    simulation.set_state(state);
    let (mut before, mut crossings) = (0.0, Vec::new());
    while crossings.len() < 5 {
        assert!(!simulation.step().diverged, "a small motion");
        let position = &simulation.state().position;
        let of = |p: usize| model.mass(p) * mode.shape[p].dot(position[p] - model.start[p]);
        let now: f64 = (0..model.start.len()).map(of).sum();
        if before * now < 0.0 {
            crossings.push(simulation.state().time_secs - dt * now / (now - before));
        }
        before = now;
    }
    let periods = (crossings.len() - 1) as f64 / 2.0;
    (periods / (crossings[crossings.len() - 1] - crossings[0]), mode.frequency_hz)
}

#[test]
fn the_full_simulation_swings_as_often_as_the_mode_that_it_is_thrown_into() {
    for (name, body) in [("cube", cube()), ("bar", bar(2)), ("cantilever", cantilever(2))] {
        for number in [0, 3] {
            let (simulated, modal) = simulated_hz(body.clone(), number);
            assert!((simulated / modal - 1.0).abs() < 0.01, "{name}, mode {number}: {simulated} Hz for {modal} Hz");
        }
    }
}
