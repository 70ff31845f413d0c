//! Error against grid resolution: how far a body of ever more cells misses the solid that it stands for, beside the error
//! that its time steps add, so that the two can be weighed against each other.
//!
//! The cells' error is that of a displacement at rest, found by [`Linear`]. It is measured against theory or, where there is
//! none, against the value that three grids converge to (Richardson's extrapolation). The steps' error is that of the same
//! body let go under its own weight, in automatic stepping at 1 ms, against steps many times smaller.

use std::sync::Arc;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::recording::{record_run, rms_distance, rounded_count};
use super::reference::fine_step;
use super::{REFERENCE, SAMPLE_INTERVAL_SECS, SteppingMethod};
use crate::geometry::Watch;
use crate::physics::Simulation;
use crate::report::extremes::lattices;
use crate::report::statics::{Linear, face_load, mean_displacement};
use crate::scene::body::{CellsShape, PinBox};
use crate::scene::settings::{EARTH_GRAVITY, Stepping};
use crate::scene::{Body, Material, Scene, Shape, Solid};

/// The bodies are 1 m long and of this density, kg/m³, and damping.
const DENSITY: f64 = 1000.0;
const DAMPING_RATIO: f64 = 0.05;
/// Length over thickness of the cantilever.
const SLENDERNESS: u32 = 8;
/// The standing block stands on a patch that reaches this far from the middle of its bottom, m.
const PATCH_HALF_WIDTH: f64 = 0.25;
/// The step whose error is compared, s.
pub const STEP_SECS: f64 = 1e-3;
/// Simulated time of the motion in which the steps' error is measured, s, and of the runs that measure the wall time.
const MOTION_SECS: f64 = 0.4;
const TIMED_SECS: f64 = 0.02;
/// A case converges if the finest cells miss by less than `CONVERGED_ERROR_RATIO` of the coarsest cells' error, or by less
/// than `NEGLIGIBLE_ERROR_SHARE` of the solid's displacement.
const CONVERGED_ERROR_RATIO: f64 = 0.7;
const NEGLIGIBLE_ERROR_SHARE: f64 = 1e-3;
/// Of two errors, the larger one is worth paying for if it is at least this many times the other.
const DOMINANT_ERROR_RATIO: f64 = 2.0;

/// A body whose cells are counted along its longest extent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Case {
    /// A cube pulled at both ends by a force of its weight: its stretch is known.
    Tension,
    /// A cube held all over its top: how far its bottom sags under its weight.
    Hanging,
    /// A beam held at one end: how far a load of its weight bends the other end, by Timoshenko's theory.
    Cantilever,
    /// A cube that sticks to the ground by the middle of its bottom: how far its top sinks under its weight.
    Patch,
}

impl Case {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Tension, Self::Hanging, Self::Cantilever, Self::Patch];

    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tension => "tension bar",
            Self::Hanging => "hanging block",
            Self::Cantilever => "cantilever",
            Self::Patch => "contact patch",
        }
    }

    /// Young's modulus, Pa: stiff enough that the displacements stay some per cent of the body.
    fn young_modulus(self) -> f64 {
        match self {
            Self::Cantilever => 2e7,
            _ => 2e5,
        }
    }

    /// The numbers of cells along the body; those of the standing block put the patch's edge on an edge of cells.
    fn divisions(self, quick: bool) -> &'static [u32] {
        match (self, quick) {
            (Self::Cantilever, false) => &[8, 16, 24, 32, 40],
            (Self::Cantilever, true) => &[8, 16, 24],
            (Self::Patch, false) => &[8, 12, 16, 20, 28, 40],
            (Self::Patch, true) => &[8, 12, 16, 20],
            (_, false) => &[7, 10, 14, 20, 28, 40],
            (_, true) => &[7, 10, 14, 20],
        }
    }

    /// Three grids, each twice as fine as the one before, from which the converged value is extrapolated.
    fn extrapolation_grids(quick: bool) -> [u32; 3] {
        if quick { [8, 16, 32] } else { [12, 24, 48] }
    }

    /// The number of cells with which the steps' error is measured.
    fn motion_divisions(self) -> u32 {
        match self {
            Self::Cantilever => 16,
            Self::Patch => 12,
            _ => 10,
        }
    }

    /// The body's extents, m.
    fn size(self) -> DVec3 {
        match self {
            Self::Cantilever => DVec3::new(1.0, 1.0, 1.0) / DVec3::new(1.0, 8.0, 8.0),
            _ => DVec3::ONE,
        }
    }

    /// Where particles are held, in the body's coordinates.
    fn pinned_box(self) -> [DVec3; 2] {
        let (all, end) = (DVec3::splat(2.0), 0.5 - 1e-6);
        match self {
            Self::Tension | Self::Hanging => [DVec3::new(-2.0, end, -2.0), all],
            Self::Cantilever => [-all, DVec3::new(-end, 2.0, 2.0)],
            Self::Patch => {
                let reach = PATCH_HALF_WIDTH + 1e-6;
                [DVec3::new(-reach, -2.0, -reach), DVec3::new(reach, -end, reach)]
            }
        }
    }

    fn body(self, divisions: u32) -> Body {
        let dims = (self.size() * f64::from(divisions))
            .to_array()
            .map(|cells| u32::try_from(rounded_count(cells)).unwrap_or(1));
        let [x, y, z] = dims.map(|cells| i32::try_from(cells.max(1)).unwrap_or(1));
        let list = (0..x).flat_map(|i| (0..y).flat_map(move |j| (0..z).map(move |k| [i, j, k]))).collect();
        let [min, max] = self.pinned_box().map(|corner| corner.to_array());
        Body {
            shape: Shape::Cells(CellsShape { list, size: 1.0 / f64::from(divisions) }),
            material: Material::Solid(Solid {
                young_modulus: self.young_modulus(),
                density: DENSITY,
                damping_ratio: DAMPING_RATIO,
                ..Solid::DEFAULT
            }),
            pins: vec![PinBox { min, max }],
            ..Body::default()
        }
    }

    /// The body in the unstrained state, under its own weight.
    fn scene(self, divisions: u32) -> Scene {
        let mut scene = Scene { bodies: vec![self.body(divisions)], ..Scene::default() };
        scene.settings.gravity = [0.0, -EARTH_GRAVITY, 0.0];
        scene.settings.dt = STEP_SECS;
        scene.settings.stepping = Stepping::Auto;
        scene.settings.sleeping = false;
        scene
    }

    /// Finds the body's displacement at rest, m, and theory's where there is one.
    fn displacement(self, divisions: u32) -> Option<Displacement> {
        let scene = self.scene(divisions);
        let simulation = Simulation::<f64>::new(&scene, &lattices(&scene).ok()?);
        let mut body = Linear::of(&simulation.model().bodies[0]);
        let (size, cell) = (self.size(), 1.0 / f64::from(divisions));
        let weight = DENSITY * EARTH_GRAVITY * size.element_product();
        let on = |body: &Linear, face: DVec3, direction: DVec3| face_load(body, size, cell, face, direction);
        let [min, max] = self.pinned_box();
        if self != Self::Tension {
            body.hold_axes(DVec3::ONE, |start| start.cmpge(min).all() && start.cmple(max).all());
        }
        let scaled = |load: Vec<DVec3>| -> Vec<DVec3> { load.into_iter().map(|force| force * weight).collect() };
        let own = || -> Vec<DVec3> { body.mass.iter().map(|mass| DVec3::NEG_Y * (EARTH_GRAVITY * mass)).collect() };
        let (load, seen, theory_m) = match self {
            Self::Tension => {
                let ends = [DVec3::Y, DVec3::NEG_Y].map(|face| on(&body, face, face));
                let both: Vec<DVec3> = ends[0].iter().zip(&ends[1]).map(|(a, b)| *a + *b).collect();
                (scaled(both.clone()), both, Some(weight / self.young_modulus()))
            }
            Self::Hanging => (own(), on(&body, DVec3::NEG_Y, DVec3::NEG_Y), None),
            Self::Patch => (own(), on(&body, DVec3::Y, DVec3::NEG_Y), None),
            Self::Cantilever => {
                let end = on(&body, DVec3::X, DVec3::NEG_Y);
                (scaled(end.clone()), end, Some(weight * timoshenko(size) / self.young_modulus()))
            }
        };
        let found_m = mean_displacement(&seen, &body.solve(&load)?);
        Some(Displacement { found_m, theory_m, particles: body.start.len() })
    }
}

/// The displacement of a body of some cells.
struct Displacement {
    found_m: f64,
    theory_m: Option<f64>,
    particles: usize,
}

/// The deflection of a beam's end under 1 N for a modulus of 1 Pa: bending and shear (Timoshenko, with Cowper's
/// coefficient, *Journal of Applied Mechanics* 33, 1966), for Poisson's ratio 1/4.
fn timoshenko(size: DVec3) -> f64 {
    let (length, width, height) = (size.x, size.z, size.y);
    let (poisson, second_moment) = (0.25, width * height.powi(3) / 12.0);
    let shear_modulus = 0.5 / (1.0 + poisson);
    let coefficient = 10.0 * (1.0 + poisson) / (12.0 + 11.0 * poisson);
    length.powi(3) / (3.0 * second_moment) + length / (coefficient * shear_modulus * width * height)
}

/// The deflection of the cantilever with `cells_across` cells across it, and that of beam theory, m; none where nothing
/// holds it.
pub fn cantilever(cells_across: u32) -> Option<(f64, f64)> {
    let found = Case::Cantilever.displacement(cells_across * SLENDERNESS)?;
    Some((found.found_m, found.theory_m?))
}

/// One resolution; the names are those of the table and the JSON object.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the names are the keys of the JSON object")]
pub struct CellsRow {
    pub divisions: u32,
    pub particles: usize,
    pub displacement_m: f64,
    /// Distance from the solid's displacement.
    pub error_m: f64,
    /// Wall time for a simulated second, in automatic stepping at 1 ms.
    pub wall_secs: f64,
}

/// The measurements of one case; the names are those of the JSON object. SI units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the names are the keys of the JSON object")]
pub struct CellsFigures {
    pub case: String,
    /// The solid's displacement, and how it is known.
    pub reference_m: f64,
    pub reference: String,
    pub rows: Vec<CellsRow>,
    /// Whether the finest cells miss by less than the coarsest; if not, they converge to another solid.
    pub converges: bool,
    /// The resolution at which the steps' error was measured, the step, and the error: root mean square distance of the
    /// particles in motion.
    pub steps_divisions: u32,
    pub step_secs: f64,
    pub steps_error_m: f64,
}

/// Measures a case; none where `watch` cancels or nothing holds the body.
pub fn measure(case: Case, quick: bool, watch: &dyn Watch) -> Option<CellsFigures> {
    let divisions = case.divisions(quick);
    let work = (divisions.len() + 4) as f64;
    let mut rows = Vec::new();
    let mut theory_m = None;
    for (done, &divisions) in divisions.iter().enumerate() {
        let Displacement { found_m, theory_m: known_m, particles } = case.displacement(divisions)?;
        theory_m = known_m;
        let wall_secs = wall_secs_per_second(&case.scene(divisions), watch)?;
        rows.push(CellsRow { divisions, particles, displacement_m: found_m, error_m: f64::NAN, wall_secs });
        watch.progress((done + 1) as f64 / work);
        if watch.cancelled() {
            return None;
        }
    }
    let (reference_m, reference) = match theory_m {
        Some(theory_m) => (theory_m, "theory".to_owned()),
        None => extrapolated_displacement(case, quick)?,
    };
    for row in &mut rows {
        row.error_m = (row.displacement_m - reference_m).abs();
    }
    watch.progress((work - 1.0) / work);
    let converges = converges(&rows, reference_m);
    let steps_error_m = steps_error(case, watch)?;
    let case_name = case.name().to_owned();
    let (steps_divisions, step_secs) = (case.motion_divisions(), STEP_SECS);
    Some(CellsFigures {
        case: case_name,
        reference_m,
        reference,
        rows,
        converges,
        steps_divisions,
        step_secs,
        steps_error_m,
    })
}

/// Whether the finest cells miss by less than the coarsest, or by hardly anything.
fn converges(rows: &[CellsRow], reference_m: f64) -> bool {
    let [Some(coarsest), Some(finest)] = [rows.first(), rows.last()] else { return false };
    finest.error_m < (CONVERGED_ERROR_RATIO * coarsest.error_m).max(NEGLIGIBLE_ERROR_SHARE * reference_m.abs())
}

/// The value that three grids converge to, and in words how it was found.
fn extrapolated_displacement(case: Case, quick: bool) -> Option<(f64, String)> {
    let grids = Case::extrapolation_grids(quick);
    let [coarse, middle, fine] = grids.map(|divisions| case.displacement(divisions).map(|found| found.found_m));
    let (value, order) = richardson_extrapolation([coarse?, middle?, fine?])?;
    let [_, _, finest] = grids;
    Some((value, format!("grids of up to {finest} divisions, which converge with order {order:.1}")))
}

/// Richardson's extrapolation of three values, each of a grid twice as fine as the one before, and the order of convergence;
/// none where they do not converge.
fn richardson_extrapolation([coarse, middle, fine]: [f64; 3]) -> Option<(f64, f64)> {
    let ratio = (middle - coarse) / (fine - middle);
    (ratio > 1.0).then(|| (fine + (fine - middle) / (ratio - 1.0), ratio.log2()))
}

/// How far automatic stepping is from steps many times smaller, in motion, m.
fn steps_error(case: Case, watch: &dyn Watch) -> Option<f64> {
    let scene = case.scene(case.motion_divisions());
    let lattices = lattices(&scene).ok()?;
    let dt = fine_step(&scene, &lattices, STEP_SECS);
    let samples = rounded_count(MOTION_SECS / SAMPLE_INTERVAL_SECS);
    let truth =
        record_run::<f64>(&SteppingMethod::Manual(REFERENCE).applied(&scene, dt), &lattices, samples, None, watch);
    let run = record_run::<f32>(&SteppingMethod::Automatic.applied(&scene, STEP_SECS), &lattices, samples, None, watch);
    (!truth.cancelled && !run.cancelled).then(|| rms_distance(&run.samples, &truth.samples))
}

/// Wall time of a simulated second; none where `watch` cancels.
fn wall_secs_per_second(scene: &Scene, watch: &dyn Watch) -> Option<f64> {
    let lattices: Vec<Arc<_>> = lattices(scene).ok()?;
    let mut simulation = Simulation::<f32>::new(scene, &lattices);
    let begin = std::time::Instant::now();
    for _ in 0..rounded_count(TIMED_SECS / STEP_SECS) {
        if watch.cancelled() {
            return None;
        }
        simulation.step();
    }
    Some(begin.elapsed().as_secs_f64() / TIMED_SECS)
}

/// Says in a sentence which of the two errors is worth paying for.
pub fn advice(figures: &CellsFigures) -> String {
    let CellsFigures { case, steps_divisions, steps_error_m, step_secs, rows, .. } = figures;
    let nearest = rows.iter().min_by_key(|row| row.divisions.abs_diff(*steps_divisions));
    let Some(row) = nearest else { return format!("Of the {case} nothing was measured.") };
    let (cells_m, steps_m) = (row.error_m, *steps_error_m);
    let (cells, steps) = (millimetres(cells_m), millimetres(steps_m));
    let step = step_secs * 1e3;
    let worth = if cells_m > DOMINANT_ERROR_RATIO * steps_m {
        "finer cells are worth paying for, smaller steps are not"
    } else if steps_m > DOMINANT_ERROR_RATIO * cells_m {
        "smaller steps or a scheme of higher order are worth paying for, finer cells are not"
    } else {
        "both count alike: neither alone is worth paying for"
    };
    format!(
        "{case}, {} divisions and steps of {step} ms: the cells miss by {cells}, the steps by {steps}: {worth}.",
        row.divisions
    )
}

/// A small length in words.
pub(super) fn millimetres(meters: f64) -> String {
    let value = meters * 1e3;
    if value == 0.0 || value >= 0.1 { format!("{value:.2} mm") } else { format!("{value:.1e} mm") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figures(cells_m: f64, steps_m: f64) -> CellsFigures {
        let row = CellsRow { divisions: 10, particles: 1, displacement_m: 0.1, error_m: cells_m, wall_secs: 1.0 };
        CellsFigures {
            case: "hanging block".into(),
            reference_m: 0.1,
            reference: "theory".into(),
            rows: vec![row],
            converges: true,
            steps_divisions: 10,
            step_secs: 1e-3,
            steps_error_m: steps_m,
        }
    }

    #[test]
    fn the_sentence_names_the_larger_error() {
        assert_eq!(
            advice(&figures(5e-3, 1e-5)),
            "hanging block, 10 divisions and steps of 1 ms: the cells miss by 5.00 mm, the steps by 1.0e-2 mm: finer cells \
             are worth paying for, smaller steps are not."
        );
        assert!(advice(&figures(1e-5, 5e-3)).contains("smaller steps or a scheme of higher order are worth"));
        assert!(advice(&figures(1e-3, 1.5e-3)).contains("both count alike"));
    }

    #[test]
    fn three_grids_lead_to_the_value_and_the_order() {
        let grid = |h: f64| 2.0 + 0.3 * h * h;
        let (value, order) = richardson_extrapolation([grid(0.4), grid(0.2), grid(0.1)]).expect("they converge");
        assert!((value - 2.0).abs() < 1e-12 && (order - 2.0).abs() < 1e-9, "{value}, order {order}");
        assert_eq!(richardson_extrapolation([1.0, 2.0, 4.0]), None, "these run away");
    }

    #[test]
    fn cells_that_are_finer_miss_by_less_and_a_pulled_cube_by_nothing() {
        let error = |case: Case, divisions: u32, reference: f64| {
            let found = case.displacement(divisions).expect("it is held");
            (found.found_m - found.theory_m.unwrap_or(reference)).abs()
        };
        assert!(error(Case::Tension, 7, f64::NAN) < 1e-5, "its stretch is exact");
        assert!(error(Case::Cantilever, 16, f64::NAN) < 0.6 * error(Case::Cantilever, 8, f64::NAN));
        for case in [Case::Hanging, Case::Patch] {
            let (reference, _) = extrapolated_displacement(case, true).expect("it converges");
            assert!(error(case, 20, reference) < 0.7 * error(case, 8, reference), "{}", case.name());
            assert!((0.005..0.2).contains(&reference), "{} moves by {reference} m", case.name());
        }
    }

    /// The negative control: cells of the wrong stiffness keep an error however many there are.
    #[test]
    fn a_wrong_stiffness_is_found_out() {
        let rows = |factor: f64| {
            let row = |divisions: u32| {
                let found = Case::Cantilever.displacement(divisions).expect("it is held");
                let displacement_m = factor * found.found_m;
                let error_m = (displacement_m - found.theory_m.expect("theory")).abs();
                CellsRow { divisions, particles: found.particles, displacement_m, error_m, wall_secs: 1.0 }
            };
            [8, 16, 24].map(row).to_vec()
        };
        assert!(converges(&rows(1.0), 0.05), "as it is");
        assert!(!converges(&rows(2.0), 0.05), "links half as stiff");
    }
}
