//! Checks what must hold of the modes of any body: they solve the equations, are orthonormal, and none is missed.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::lanczos::{solve_dense, solve_sparse};
use super::stiffness::System;
use super::{ModalError, Modes, Wanted, modes, rigid};
use crate::geometry::Watch;
use crate::physics::{BodyModel, Simulation};
use crate::scene::body::{CellsShape, CubeShape, PinBox};
use crate::scene::material::Spring;
use crate::scene::{Body, Material, Scene, Shape, Solid, Springs};

fn compiled(body: Body) -> BodyModel<f64> {
    let scene = Scene { bodies: vec![body], ..Scene::default() };
    let simulation = Simulation::<f64>::from_scene(&scene, "".as_ref()).expect("a sound scene");
    simulation.model().bodies[0].clone()
}

fn cube(cells: u32, material: Material) -> Body {
    Body { shape: Shape::Cube(CubeShape { cells, size: 1.0 }), material, ..Body::default() }
}

fn solid() -> Material {
    Material::Solid(Solid::default())
}

fn springs() -> Material {
    Material::Springs(Springs::default())
}

fn of_cells(list: Vec<[i32; 3]>) -> Body {
    Body { shape: Shape::Cells(CellsShape { list, size: 0.1 }), material: solid(), ..Body::default() }
}

/// A bend of 3 × 3 cells across, held at one end.
fn bend() -> Body {
    let leg = |at: [i32; 3]| at[2] < 3 && at[..2].iter().any(|at| *at < 3);
    let all = (0..7).flat_map(|x| (0..7).flat_map(move |y| (0..3).map(move |z| [x, y, z])));
    let pins = vec![PinBox { min: [-9.0, 0.349, -9.0], max: [9.0; 3] }];
    Body { pins, ..of_cells(all.filter(|at| leg(*at)).collect()) }
}

fn held_below(body: Body) -> Body {
    Body { pins: vec![PinBox { min: [-9.0; 3], max: [9.0, -0.499, 9.0] }], ..body }
}

fn found(body: Body, count: usize) -> Modes {
    modes(&compiled(body), Wanted { count, ..Wanted::default() }, &()).expect("modes")
}

#[test]
fn sparse_and_dense_solutions_agree_and_none_is_passed_over() {
    let bodies = [
        ("free cube", cube(5, solid())),
        ("free cube of springs", cube(5, springs())),
        ("held cube", held_below(cube(5, solid()))),
        ("bend", bend()),
    ];
    for (name, body) in bodies {
        let system = System::of(&compiled(body));
        let rigid = rigid::rigid_motions(&system).expect("one piece");
        let wanted = Wanted { count: 14, ..Wanted::default() };
        let (sparse, _) = solve_sparse(&system, rigid.as_ref(), wanted, &()).expect("modes");
        let (dense, _) = solve_dense(&system, rigid.as_ref(), wanted.count).expect("modes");
        for (mode, (found, expected)) in sparse.eigenvalues.iter().zip(&dense.eigenvalues).enumerate() {
            assert!((found / expected - 1.0).abs() < 1e-7, "{name}, mode {mode}: {found} for {expected}");
        }
    }
}

#[test]
fn modes_solve_the_equations_and_are_orthonormal_by_mass() {
    for body in [cube(7, solid()), held_below(cube(7, springs()))] {
        let model = compiled(body);
        let found = modes(&model, Wanted { count: 12, ..Wanted::default() }, &()).expect("modes");
        assert_eq!(found.modes.len(), 12, "as many as asked for");
        assert!(found.residual < 1e-7, "{}", found.residual);
        for (i, a) in found.modes.iter().enumerate() {
            for (j, b) in found.modes.iter().enumerate() {
                let of = |p: usize| model.mass(p) * a.shape[p].dot(b.shape[p]);
                let product: f64 = (0..model.start.len()).map(of).sum();
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((product - expected).abs() < 1e-9, "{i} and {j}: {product}");
            }
            let still = (0..model.start.len()).filter(|&p| model.is_pinned(p)).all(|p| a.shape[p].length() <= 0.0);
            assert!(still, "what is held does not move");
        }
        assert!(found.modes.is_sorted_by(|a, b| a.frequency_hz <= b.frequency_hz), "the lowest first");
    }
}

#[test]
fn what_nothing_holds_moves_as_a_rigid_body_without_frequency() {
    let corner = |size: f64| vec![PinBox { min: [-9.0; 3], max: [-size; 3] }];
    let cells = |list: &[[i32; 3]]| of_cells(list.to_vec());
    let cases = [
        ("free", cube(3, solid()), 6),
        ("two pieces", cells(&[[0; 3], [3, 0, 0]]), 12),
        ("held at a corner", Body { pins: corner(0.499), ..cube(3, solid()) }, 3),
        ("held below", held_below(cube(3, solid())), 0),
    ];
    for (name, body, expected) in cases {
        let found = found(body, 5);
        assert_eq!(found.rigid, expected, "{name}");
        assert!(found.modes[0].frequency_hz > 0.1, "{name}: {} Hz", found.modes[0].frequency_hz);
    }
    // Two cells of a solid that share an edge turn about it like a hinge.
    let hinge = found(cells(&[[0; 3], [1, 1, 0]]), 5);
    assert_eq!(hinge.rigid, 6, "a body in one piece");
    assert!(hinge.modes[0].frequency_hz <= 0.0 && hinge.modes[1].frequency_hz > 0.1, "one loose motion");
    assert_eq!(hinge.modes[0].damping_ratio(), None, "which is not damped towards anything");
}

#[test]
fn the_damping_of_a_solid_is_proportional_to_the_square_of_the_frequency() {
    let found = found(cube(4, solid()), 10);
    let slowest = std::f64::consts::PI * 10.0;
    for mode in &found.modes {
        let ratio = mode.damping_ratio().expect("it swings");
        let expected = 0.05 * mode.angular_frequency() / slowest;
        assert!((ratio / expected - 1.0).abs() < 1e-6, "{ratio} at {} Hz, not {expected}", mode.frequency_hz);
    }
}

#[test]
fn a_body_that_cannot_swing_is_refused_in_words() {
    let refused = |body: Body, wanted: Wanted| modes(&compiled(body), wanted, &()).expect_err("refused");
    let all = vec![PinBox { min: [-9.0; 3], max: [9.0; 3] }];
    assert_eq!(refused(Body { pins: all, ..cube(2, solid()) }, Wanted::default()), ModalError::NothingFree);
    let none = Spring { stiffness: 0.0, damping: 0.0 };
    let loose = Springs { structural: none, shear: none, bending: none, ..Springs::default() };
    let dust = refused(cube(3, Material::Springs(loose)), Wanted::default());
    assert_eq!(dust, ModalError::Pieces { pieces: 64, most: 16 }, "{dust}");
    let little = Wanted { max_bytes: 1 << 20, ..Wanted::default() };
    let too_large = refused(cube(9, solid()), little);
    assert!(matches!(too_large, ModalError::Memory { free: 1_048_576, needed } if needed > 2 << 20), "{too_large}");
    assert!(too_large.to_string().contains("MB of memory, of which 1 MB"), "{too_large}");
}

/// Cancels at one of its checks.
struct At {
    checks: AtomicUsize,
    last: usize,
}

impl Watch for At {
    fn cancelled(&self) -> bool {
        self.checks.fetch_add(1, Ordering::Relaxed) == self.last
    }
}

#[test]
fn the_work_stops_wherever_it_is_asked_to() {
    let body = compiled(cube(7, solid()));
    let at = |last: usize| At { checks: AtomicUsize::new(0), last };
    let whole = at(usize::MAX);
    modes(&body, Wanted::default(), &whole).expect("modes");
    let checks = whole.checks.into_inner();
    assert!(checks > 4, "{checks} checks");
    for last in 0..checks {
        let stopped = modes(&body, Wanted::default(), &at(last));
        assert_eq!(stopped.map(|found| found.rigid), Err(ModalError::Cancelled), "at check {last} of {checks}");
    }
}
