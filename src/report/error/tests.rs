//! The error report: known orders of convergence, a wrong force that must be found out, planted rows.

use super::words::{advice, csv, markdown};
use super::*;
use crate::report::extremes::lattices;
use crate::scene::Material;

fn scene(name: &str) -> Scene {
    scenes::scenes().into_iter().find(|(own, _)| own == name).expect("a scene").1
}

fn measured(name: &str) -> ErrorFigures {
    let scene = scene(name);
    measure(name, &scene, &lattices(&scene).expect("cubes"), Effort::full(2.0 * SAMPLE_INTERVAL_SECS), &())
        .expect("not cancelled")
}

fn rows(figures: &ErrorFigures, integrator: Integrator) -> Vec<&Row> {
    figures.rows.iter().filter(|row| row.integrator == SteppingMethod::Manual(integrator)).collect()
}

/// The order of convergence between the steps `dt` and `dt / 2`.
fn order(figures: &ErrorFigures, integrator: Integrator, dt: f64) -> f64 {
    let error = |dt: f64| {
        let rows = rows(figures, integrator);
        rows.iter().find(|row| (row.dt_secs - dt).abs() < 1e-12).expect("it was measured").error_rms_m
    };
    (error(dt) / error(dt / 2.0)).log2()
}

#[test]
fn a_free_vibration_shows_the_order_of_every_scheme() {
    let figures = measured("free vibration");
    assert!(figures.reference_error_m < 1e-6, "{} m", figures.reference_error_m);
    for (integrator, wanted) in [
        (Integrator::SemiImplicit, 1.0),
        (Integrator::Explicit, 1.0),
        (Integrator::Implicit, 1.0),
        (Integrator::Verlet, 2.0),
        (Integrator::Rk2, 2.0),
    ] {
        let order = order(&figures, integrator, 0.001);
        assert!((order - wanted).abs() < 0.3, "{}: order {order}, {wanted} is right", integrator.name());
    }
    assert!(figures.not_converging.is_empty(), "{:?}", figures.not_converging);
}

#[test]
fn a_wrong_force_is_found_out() {
    let (scene, lattices) = (scene("free vibration"), lattices(&scene("free vibration")).expect("cubes"));
    let mut wrong = scene.clone();
    let Material::Springs(springs) = &mut wrong.bodies[0].material else { panic!("springs") };
    springs.shear.stiffness *= 1.3;
    let figures = compare("wrong", [&wrong, &scene], &lattices, Effort::full(2.0 * SAMPLE_INTERVAL_SECS), &());
    let figures = figures.expect("not cancelled");
    for integrator in [Integrator::Verlet, Integrator::Rk4] {
        assert!(figures.not_converging.contains(&integrator.name().to_owned()), "{:?}", figures.not_converging);
        let method = SteppingMethod::Manual(integrator);
        let steps = figures.rows.iter().filter(|row| row.integrator == method).map(|row| row.dt_secs);
        let steps: Vec<f64> = steps.collect();
        assert!(steps.is_sorted_by(|one, next| one > next), "{steps:?}");
        let last_rung = figures.rows.last().expect("automatic stepping").dt_secs;
        assert!((steps[steps.len() - 1] / last_rung - 0.25).abs() < 1e-9, "two more before it is condemned: {steps:?}");
    }
    assert!(markdown(&[figures]).contains("does not converge"), "the page says so");
}

#[test]
fn what_diverges_is_a_row_of_its_own() {
    let figures = measured("stiff solid");
    let semi_implicit = rows(&figures, Integrator::SemiImplicit);
    assert!(semi_implicit[0].diverged && !semi_implicit[0].pareto, "8 ms: {:?}", semi_implicit[0]);
    assert!(!semi_implicit.last().expect("rows").diverged, "far below the limit");
    let line = format!("stiff solid,semi-implicit,{},", semi_implicit[0].dt_secs);
    let csv = csv(std::slice::from_ref(&figures));
    let found = csv.lines().find(|row| row.starts_with(&line)).expect("a row in the table");
    assert!(found.contains(",true,false,"), "{found}");
    assert!(markdown(&[figures]).contains("| diverged |"));
}

fn row(dt_secs: f64, error_rms_m: f64, wall_secs_median: f64) -> Row {
    Row {
        integrator: SteppingMethod::Manual(Integrator::Verlet),
        dt_secs,
        steps: 1,
        error_rms_m,
        wall_secs_median,
        wall_secs_min: wall_secs_median,
        wall_secs_max: wall_secs_median,
        diverged: error_rms_m.is_infinite(),
        pareto: false,
    }
}

fn planted(mut rows: Vec<Row>) -> ErrorFigures {
    mark_pareto(&mut rows);
    ErrorFigures {
        scene: "a, \"b\"".into(),
        particles: 1,
        links: 0,
        simulated_secs: 1.0,
        size_m: 1.0,
        reference_dt_secs: 1e-5,
        reference_error_m: 1e-9,
        rows,
        not_converging: Vec::new(),
    }
}

#[test]
fn the_front_is_what_nothing_else_beats_in_both() {
    let figures = planted(vec![
        row(8e-3, f64::INFINITY, 0.001),
        row(4e-3, 5e-3, 0.01),
        row(2e-3, 6e-3, 0.02),
        row(1e-3, 1e-4, 0.04),
        row(1e-3, 1e-4, 0.04),
    ]);
    let pareto_front: Vec<bool> = figures.rows.iter().map(|row| row.pareto).collect();
    assert_eq!(pareto_front, [false, true, false, true, false]);
    let sentence = advice(&figures, 1e-3);
    assert_eq!(
        sentence,
        "For 1 mm of error on this scene use velocity Verlet with a step of 1 ms: 40.0 ms per simulated second."
    );
    assert_eq!(advice(&figures, 1e-5), "Nothing measured stays below 0.01 mm of error on this scene.");
    assert!(csv(&[figures]).contains("\n\"a, \"\"b\"\"\",verlet,0.008,1,,"), "a name with a comma is quoted");
}

#[test]
fn figures_survive_being_kept() {
    let figures = planted(vec![row(8e-3, f64::INFINITY, 0.001), row(4e-3, 5e-3, 0.01)]);
    let kept = serde_json::to_string(&figures).expect("written");
    assert_eq!(serde_json::from_str::<ErrorFigures>(&kept).expect("read"), figures);
}

#[test]
fn what_nobody_waits_for_stops_within_a_step() {
    struct Impatient(std::sync::atomic::AtomicU32);
    impl Watch for Impatient {
        fn cancelled(&self) -> bool {
            self.0.fetch_add(1, std::sync::atomic::Ordering::Relaxed) >= 3
        }
    }
    let (scene, impatient) = (scene("hanging"), Impatient(0.into()));
    let lattices = lattices(&scene).expect("cubes");
    let effort = Effort { side_by_side: false, ..Effort::full(1.0) };
    assert!(measure("hanging", &scene, &lattices, effort, &impatient).is_none(), "nothing comes of it");
    assert!(impatient.0.into_inner() < 8, "it stops at the next step");
}
