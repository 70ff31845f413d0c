//! Finds by trial the largest step that a scene's bodies take without blowing up.

use std::sync::Arc;

use glam::DVec3;

use crate::geometry::{Lattice, Watch};
use crate::math::rng::Rng;
use crate::math::{Aabb, Vector};
use crate::physics::Simulation;
use crate::scene::Scene;
use crate::scene::settings::Stepping;

/// A body that has not blown up after this many steps is stable; and with `quick`.
const STEPS: [usize; 2] = [1500, 400];

/// The most link forces spent on a body's steps: large bodies are watched for fewer steps.
const MAX_LINK_FORCES: usize = 8_000_000;

/// Steps between two checks whether a body has blown up already.
const CHECK_INTERVAL_STEPS: usize = 50;

/// The limit is sought from the predicted one in strides of a third of an octave, at most this many down and up: between
/// half of it and four times as much.
const STRIDES_PER_OCTAVE: f64 = 3.0;
const MAX_STRIDES: [i32; 2] = [3, 6];

/// Halvings of the stride that holds a border: give the largest step to 0.4 %.
pub(super) const BISECTION_STEPS: usize = 6;

/// The largest step with which the scene's shaken bodies stay together when nothing else happens to them, s; `None` if none
/// of the steps tried does, or all of them do.
pub(super) fn measured_limit(scene: &Scene, lattices: &[Arc<Lattice>], predicted: f64, quick: bool) -> Option<f64> {
    let mut alone = isolated_bodies(scene);
    let steps = STEPS[usize::from(quick)];
    let stays = |dt: f64| {
        alone.settings.dt = dt;
        survives(&mut Simulation::new(&alone, lattices), steps)
    };
    find_edge(predicted, stays)
}

/// The scene's bodies at rest, with nothing around them.
pub fn isolated_bodies(scene: &Scene) -> Scene {
    let mut alone = scene.clone();
    alone.obstacles.clear();
    alone.settings.gravity = [0.0; 3];
    alone.settings.stepping = Stepping::Manual;
    alone.settings.sleeping = false;
    alone.settings.body_contact = false;
    for body in &mut alone.bodies {
        body.velocity = [0.0; 3];
        body.pose.position = [0.0; 3];
    }
    alone
}

/// The largest good value below the first bad one, sought in strides from `start`; `None` if all are good or none is.
fn find_edge(start: f64, mut is_good: impl FnMut(f64) -> bool) -> Option<f64> {
    let at = |stride: i32| start * libm::exp2(f64::from(stride) / STRIDES_PER_OCTAVE);
    let [down, up] = MAX_STRIDES;
    let ends = if is_good(start) {
        let bad = (1..=up).find(|stride| !is_good(at(*stride)))?;
        [at(bad - 1), at(bad)]
    } else {
        let good = (1..=down).find(|stride| is_good(at(-stride)))?;
        [at(-good), at(1 - good)]
    };
    Some(bisect(ends, is_good)[0])
}

/// Narrows the range between a good value and a bad one by halving, and returns its ends.
pub(super) fn bisect([mut good, mut bad]: [f64; 2], mut is_good: impl FnMut(f64) -> bool) -> [f64; 2] {
    for _ in 0..BISECTION_STEPS {
        let middle = (good * bad).sqrt();
        if is_good(middle) {
            good = middle;
        } else {
            bad = middle;
        }
    }
    [good, bad]
}

fn survives(simulation: &mut Simulation<f64>, steps: usize) -> bool {
    let links: usize = simulation.model().link_counts().iter().sum();
    let affordable = (MAX_LINK_FORCES / links.max(1)).max(200);
    let steps = steps.min(affordable);
    steps_survived(simulation, steps, &()) == steps
}

/// The number of steps, at most `steps`, for which shaken bodies stay together. Meaningless where `watch` cancels.
pub(super) fn steps_survived(simulation: &mut Simulation<f64>, steps: usize, watch: &dyn Watch) -> usize {
    let mut state = simulation.state().clone();
    let mut rng = Rng::new(3);
    for body in &simulation.model().bodies {
        let noise = 1e-3 * body.lattice.grid.cell_size;
        for position in &mut state.position[body.particles.clone()] {
            *position += DVec3::from([0; 3].map(|_| rng.between(-noise, noise)));
        }
    }
    simulation.set_state(state);
    // A check now and then finds a blow-up before its numbers overflow.
    let blows_up = |step: &usize| {
        watch.progress((*step - 1) as f64 / steps as f64);
        let is_check_due = step.is_multiple_of(CHECK_INTERVAL_STEPS) || *step == steps;
        watch.cancelled() || simulation.step().diverged || (is_check_due && !are_all_together(simulation))
    };
    (1..=steps).find(blows_up).map_or(steps, |step| step - 1)
}

/// Whether no body has grown by half.
fn are_all_together(simulation: &Simulation<f64>) -> bool {
    (0..simulation.model().bodies.len()).all(|number| {
        let body = &simulation.model().bodies[number];
        let start = body.start.iter().fold(Aabb::<f64>::empty(), |bounds, x| bounds.include(x.to_dvec3()));
        let now = simulation.diagnostics_of(number);
        now.finite && now.bounds.size().max_element() < 1.5 * start.size().max_element()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::extremes::lattices;
    use crate::report::matrix::matrix;

    #[test]
    fn the_search_finds_an_edge_on_both_sides_and_says_where_there_is_none() {
        for place in [0.51, 0.7, 0.99, 1.0, 1.01, 1.7, 3.9] {
            let edge = find_edge(2.0, |x| x < 2.0 * place).expect("there is an edge");
            assert!(edge < 2.0 * place && edge > 2.0 * place * 0.996, "{edge} instead of {}", 2.0 * place);
        }
        assert_eq!(find_edge(1.0, |_| true), None);
        assert_eq!(find_edge(1.0, |_| false), None);
        assert_eq!(
            (find_edge(1.0, |x| x < 0.49), find_edge(1.0, |x| x < 4.1)),
            (None, None),
            "not looked for so far away"
        );
    }

    #[test]
    fn the_first_step_that_blows_up_counts_whatever_a_longer_one_does() {
        let edge = find_edge(1.0, |x| !(1.1..1.4).contains(&x)).expect("there is an edge");
        assert!((1.095..1.1).contains(&edge), "{edge}");
    }

    #[test]
    fn a_step_above_the_limit_is_seen_before_its_numbers_overflow() {
        let (_, scene) = &matrix()[0];
        let lattices = lattices(scene).expect("sound shapes");
        let limit = Simulation::<f64>::new(scene, &lattices).plan().limits.dt_limit_secs.expect("a limit");
        let mut alone = isolated_bodies(scene);
        let mut survives_at = |dt: f64| {
            alone.settings.dt = dt;
            let mut simulation = Simulation::new(&alone, &lattices);
            let survives = survives(&mut simulation, STEPS[0]);
            (survives, simulation.state().time_secs / dt, simulation.diagnostics().finite)
        };
        let (survives, steps, _) = survives_at(limit);
        assert!(survives && steps > 1000.0, "watched to the end: {steps} steps");
        let (survives, steps, finite) = survives_at(1.5 * limit);
        assert!(!survives && finite && steps < 150.0, "{steps} steps");
    }
}
