//! Where a step is stable in the plane of stiffness and damping, each per unit mass: the predicted border, and what happens
//! on both sides of it.
//!
//! ```text
//! stiffness ▲  blows up in a few steps
//!           │▒▒▒▒▒▒▒▒▒▒▒▒▒▒▒▒▒▒▒
//!           │────────────╮▒▒▒▒▒▒   the border: predicted as a line, measured as the first blow-up above it
//!           │   stays    │▒▒▒▒▒▒
//!           └────────────┴─────► damping
//! ```
//!
//! A step of another length gives the same map of stiffness times its square and damping times itself, so one step is
//! enough.

use std::sync::Arc;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::limit::{BISECTION_STEPS, bisect, isolated_bodies, steps_survived};
use crate::geometry::watch::Portion;
use crate::geometry::{Lattice, Watch};
use crate::physics::Simulation;
use crate::report::extremes::lattices;
use crate::scene::body::{Body, CubeShape};
use crate::scene::material::{Material, Spring, Springs};
use crate::scene::resolve::ResolveError;
use crate::scene::settings::Integrator;
use crate::scene::{Scene, Shape};

/// The step, s.
pub const DT_SECS: f64 = 1e-3;
/// The cube: cells an edge, the edge of a cell in m.
const CELLS: u32 = 5;
const CELL_M: f64 = 0.2;
/// The mass of a particle of the report's own cubes, kg.
pub(super) const PARTICLE_KG: f64 = 0.008;

/// The ranges of the axes, as powers of ten: stiffness per unit mass 1/s², damping per unit mass 1/s.
const STIFFNESS_DECADES: [f64; 2] = [3.0, 6.0];
const DAMPING_DECADES: [f64; 2] = [0.0, 3.0];
/// Values along each axis; and with `quick`.
const VALUE_COUNTS: [usize; 2] = [25, 9];
/// Steps that are watched; and with `quick`.
const STEPS: [usize; 2] = [1500, 300];

/// Points of the predicted border between the columns where it falls off the map.
const FALL_POINTS: u32 = 6;

/// The map of one scheme. SI units; both axes per unit mass of a particle, of the stiffness and damping of all links.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the names are the keys of the command line's JSON")]
pub struct MapFigures {
    pub integrator: Integrator,
    pub dt_secs: f64,
    /// Steps for which each material was watched.
    pub watched: usize,
    pub stiffness: Vec<f64>,
    pub columns: Vec<Column>,
    /// Damping and stiffness along the predicted border where it falls off the map, with rising damping; the last point is
    /// at the least stiffness. Empty where the border does not fall off.
    pub predicted_fall: Vec<[f64; 2]>,
    /// The largest stable damping at the least stiffness; none where all dampings of the map are stable or none is.
    pub measured_fall: Option<f64>,
    pub passed: bool,
}

/// One damping of a map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the names are the keys of the command line's JSON")]
pub struct Column {
    pub damping: f64,
    /// Steps until the blow-up, for every stiffness of the map; the number watched where there was none.
    pub survived: Vec<usize>,
    /// The largest stiffness predicted to be stable; none where none of the map is.
    pub predicted: Option<f64>,
    /// The largest stiffness below the first one that blows up, and that one; none where all stiffnesses of the map blow up
    /// or none does.
    pub measured: Option<[f64; 2]>,
    /// Whether nothing that is predicted to be stable blows up.
    pub passed: bool,
}

/// Measures the map of one scheme.
///
/// # Errors
/// If a shape cannot be made, which no cube should cause.
pub fn map(integrator: Integrator, quick: bool) -> Result<MapFigures, ResolveError> {
    measured(integrator, quick, 1.0)
}

/// As [`map`], with a prediction that is wrong by a factor.
fn measured(integrator: Integrator, quick: bool, prediction_factor: f64) -> Result<MapFigures, ResolveError> {
    let count = VALUE_COUNTS[usize::from(quick)];
    let [stiffness, damping] = [STIFFNESS_DECADES, DAMPING_DECADES].map(|ends| values(ends, count));
    let (scene, watched) = (cube(integrator), STEPS[usize::from(quick)]);
    let trial =
        StabilityTrial { scene: &scene, lattices: &lattices(&scene)?, material: &cube_material, steps: watched };
    let columns: Vec<Column> = damping
        .par_iter()
        .with_max_len(1)
        .map(|&damping| trial.column(damping, &stiffness, prediction_factor))
        .collect();
    let predicted_fall = trial.predicted_fall(&columns, &stiffness, prediction_factor);
    let stays = |column: &Column| column.survived.first() == Some(&watched);
    let measured_fall = boundary_columns(&columns, stays).map(|ends| trial.damping_border(ends, stiffness[0], &())[0]);
    let too_far = predicted_fall.last().zip(measured_fall).is_some_and(|([predicted, _], most)| *predicted > most);
    let passed = columns.iter().all(|column| column.passed) && !too_far;
    Ok(MapFigures { integrator, dt_secs: DT_SECS, watched, stiffness, columns, predicted_fall, measured_fall, passed })
}

/// The dampings of the last column for which `holds` is true and of the next one.
fn boundary_columns(columns: &[Column], holds: impl Fn(&Column) -> bool) -> Option<[f64; 2]> {
    let pair = columns.windows(2).find(|pair| holds(&pair[0]) && !holds(&pair[1]))?;
    Some([pair[0].damping, pair[1].damping])
}

/// `count` values from one power of ten to another, evenly spaced in the logarithm.
pub fn values([from, to]: [f64; 2], count: usize) -> Vec<f64> {
    (0..count).map(|at| libm::pow(10.0, from + (to - from) * at as f64 / (count - 1) as f64)).collect()
}

/// Bodies that are tried with different damping and stiffness.
pub(crate) struct StabilityTrial<'a> {
    /// The bodies with nothing around them, and the step.
    pub(crate) scene: &'a Scene,
    /// Their lattices.
    pub(crate) lattices: &'a [Arc<Lattice>],
    /// The material of the first body at a damping and a stiffness, both per unit mass.
    pub(crate) material: &'a (dyn Fn(f64, f64) -> Material + Sync),
    /// Steps for which each material is watched.
    pub(crate) steps: usize,
}

/// The outcome of trying a row of stiffnesses.
#[derive(Clone, Debug, PartialEq)]
pub struct Survival {
    /// Steps until the blow-up; the number watched where there was none.
    pub survived: Vec<usize>,
    /// The largest stiffness below the first one that blows up, and that one; none where all blow up or none does.
    pub border: Option<[f64; 2]>,
}

impl StabilityTrial<'_> {
    /// Tries rising stiffnesses. None where `watch` cancels.
    pub(crate) fn survival(&self, damping: f64, stiffness: &[f64], watch: &dyn Watch) -> Option<Survival> {
        let runs = (stiffness.len() + BISECTION_STEPS) as f64;
        let portion = |run: usize| Portion::new(watch, [run as f64 / runs, (run + 1) as f64 / runs]);
        let trial = |run: usize, stiffness: f64| self.survived(stiffness, damping, &portion(run));
        let survived: Vec<usize> =
            stiffness.iter().enumerate().map(|(run, &stiffness)| trial(run, stiffness)).collect();
        let first = survived.iter().position(|&steps| steps < self.steps).filter(|&first| first > 0);
        let mut run = stiffness.len();
        let border = first.map(|first| {
            bisect([stiffness[first - 1], stiffness[first]], |stiffness| {
                run += 1;
                trial(run - 1, stiffness) == self.steps
            })
        });
        (!watch.cancelled()).then_some(Survival { survived, border })
    }

    /// Narrows the border at some damping to a good and a bad stiffness.
    pub(crate) fn stiffness_border(&self, damping: f64, ends: [f64; 2], watch: &dyn Watch) -> [f64; 2] {
        bisect(ends, |stiffness| self.survived(stiffness, damping, watch) == self.steps)
    }

    /// Narrows the border at some stiffness to a good and a bad damping.
    pub(crate) fn damping_border(&self, ends: [f64; 2], stiffness: f64, watch: &dyn Watch) -> [f64; 2] {
        bisect(ends, |damping| self.survived(stiffness, damping, watch) == self.steps)
    }

    /// The bodies with this stiffness and damping per unit mass.
    fn simulation(&self, stiffness: f64, damping: f64) -> Simulation<f64> {
        let mut scene = self.scene.clone();
        scene.bodies[0].material = (self.material)(damping, stiffness);
        Simulation::new(&scene, self.lattices)
    }

    fn survived(&self, stiffness: f64, damping: f64, watch: &dyn Watch) -> usize {
        if watch.cancelled() {
            return 0;
        }
        steps_survived(&mut self.simulation(stiffness, damping), self.steps, watch)
    }

    fn is_predicted(&self, stiffness: f64, damping: f64, prediction_factor: f64) -> bool {
        let limit = self.simulation(stiffness, damping).plan().limits.dt_limit_secs;
        limit.is_none_or(|limit| self.scene.settings.dt <= prediction_factor * limit)
    }

    /// The largest stiffness predicted to be stable, between the first and the last of `stiffness`.
    fn predicted(&self, damping: f64, stiffness: &[f64], prediction_factor: f64) -> Option<f64> {
        let (least, most) = (*stiffness.first()?, *stiffness.last()?);
        let is_predicted = |stiffness: f64| self.is_predicted(stiffness, damping, prediction_factor);
        is_predicted(least).then(|| if is_predicted(most) { most } else { bisect_twice([least, most], is_predicted) })
    }

    /// The predicted border between the last column that it crosses and the next.
    fn predicted_fall(&self, columns: &[Column], stiffness: &[f64], prediction_factor: f64) -> Vec<[f64; 2]> {
        let Some(ends @ [last, _]) = boundary_columns(columns, |column| column.predicted.is_some()) else {
            return Vec::new();
        };
        let end = bisect_twice(ends, |damping| self.is_predicted(stiffness[0], damping, prediction_factor));
        // The border falls ever more steeply, so its points lie ever closer.
        let dampings = (1..=FALL_POINTS).map(|part| end - (end - last) * libm::exp2(-f64::from(part)));
        let place = |damping: f64| Some([damping, self.predicted(damping, stiffness, prediction_factor)?]);
        dampings.filter_map(place).chain([[end, stiffness[0]]]).collect()
    }

    /// A column of the report's map, with a prediction that is wrong by a factor.
    fn column(&self, damping: f64, stiffness: &[f64], prediction_factor: f64) -> Column {
        let Survival { survived, border: measured } =
            self.survival(damping, stiffness, &()).unwrap_or(Survival { survived: Vec::new(), border: None });
        let predicted = self.predicted(damping, stiffness, prediction_factor);
        let blows_up_at = match (survived.first(), measured) {
            (Some(&steps), _) if steps < self.steps => stiffness[0],
            (_, Some([_, bad])) => bad,
            _ => f64::INFINITY,
        };
        let passed = predicted.is_none_or(|predicted| predicted < blows_up_at);
        Column { damping, survived, predicted, measured, passed }
    }
}

/// The cube of the report.
fn cube(integrator: Integrator) -> Scene {
    let size = CELL_M * f64::from(CELLS);
    let body = Body { shape: Shape::Cube(CubeShape { cells: CELLS, size }), ..Body::default() };
    let mut scene = isolated_bodies(&Scene { bodies: vec![body], ..Scene::default() });
    (scene.settings.integrator, scene.settings.dt) = (integrator, DT_SECS);
    scene
}

/// The cube's material, with the same springs in all families.
fn cube_material(damping: f64, stiffness: f64) -> Material {
    let of_mass = PARTICLE_KG * CELL_M;
    let spring = Spring { stiffness: stiffness * of_mass, damping: damping * of_mass };
    Material::Springs(Springs { structural: spring, shear: spring, bending: spring, particle_mass: PARTICLE_KG })
}

/// The last good value, to about a thousandth.
fn bisect_twice(ends: [f64; 2], is_good: impl Fn(f64) -> bool) -> f64 {
    bisect(bisect(ends, &is_good), &is_good)[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_predicted_border_is_below_the_measured_one_and_near_it() {
        for integrator in Integrator::LIMITED {
            let map = map(integrator, true).expect("a cube");
            assert!(map.passed, "{integrator:?}: {map:?}");
            let first = &map.columns[0];
            let ([good, _], predicted) = (first.measured.expect("a border"), first.predicted.expect("a prediction"));
            let ratio = predicted / good;
            assert!((0.6..=1.0).contains(&ratio), "{integrator:?} next to undamped: {ratio}");
            let last = map.columns.last().expect("a column");
            let (end, most) = (map.predicted_fall.last().expect("an end"), map.measured_fall.expect("an end"));
            assert!(end[0] <= most && end[0] > 0.6 * most, "{integrator:?} next to no stiffness: {end:?} of {most}");
            assert!(map.predicted_fall.is_sorted_by(|a, b| a[0] <= b[0] && a[1] >= b[1]), "{:?}", map.predicted_fall);
            assert_eq!(
                (last.predicted, last.survived[0] < map.watched),
                (None, true),
                "{integrator:?}: too much damping"
            );
        }
    }

    #[test]
    fn a_bound_that_promises_too_much_fails() {
        let map = measured(Integrator::SemiImplicit, true, 1.3).expect("a cube");
        assert!(!map.passed, "1.3 times the largest step: {map:?}");
    }
}
