//! The converged motion that errors are measured against: the scene in double precision at a small step, and once more at
//! twice that. The difference of the two runs is the error of the reference.

use std::sync::Arc;

use super::recording::{SAMPLE_INTERVAL_SECS, record_run, rms_distance};
use crate::geometry::watch::{CancelOnly, Portion};
use crate::geometry::{Lattice, Watch};
use crate::physics::Simulation;
use crate::scene::Scene;

/// The step of the reference as a share of the smallest one measured, or of the largest stable one.
pub(in crate::report) const REFERENCE_STEP_RATIO: f64 = 1.0 / 16.0;

/// The converged motion of a scene.
pub(in crate::report) struct Reference {
    /// Positions of the particles at every sample, m.
    pub(in crate::report) samples: Vec<Vec<[f64; 3]>>,
    /// Its step, s.
    pub(in crate::report) dt_secs: f64,
    /// Its difference from the run at twice the step, m.
    pub(in crate::report) error_m: f64,
}

impl Reference {
    /// Runs a scene, given with the small step and with twice that; both at the same time if `side_by_side`. None where
    /// `watch` cancels. `ends` are the fractions of progress at which the first and the second run end.
    pub(in crate::report) fn of(
        [finest, check]: [&Scene; 2],
        lattices: &[Arc<Lattice>],
        samples: u64,
        side_by_side: bool,
        ends: [f64; 2],
        watch: &dyn Watch,
    ) -> Option<Self> {
        let run = |scene: &Scene, watch: &dyn Watch| record_run::<f64>(scene, lattices, samples, None, watch);
        let [first, second] = ends;
        let (found, checked) = if side_by_side {
            let whole = Portion::new(watch, [0.0, second]);
            rayon::join(|| run(finest, &whole), || run(check, &CancelOnly(watch)))
        } else {
            let found = run(finest, &Portion::new(watch, [0.0, first]));
            (found, run(check, &Portion::new(watch, [first, second])))
        };
        let is_complete = !found.cancelled && !checked.cancelled;
        let error_m = rms_distance(&found.samples, &checked.samples);
        is_complete.then_some(Self { samples: found.samples, dt_secs: finest.settings.dt, error_m })
    }
}

/// A step well below the largest stable one and below `most_secs`, which divides the time between two samples, s.
pub(in crate::report) fn fine_step(scene: &Scene, lattices: &[Arc<Lattice>], most_secs: f64) -> f64 {
    let safe = Simulation::<f32>::new(scene, lattices).plan().limits.dt_safe_secs.unwrap_or(most_secs);
    SAMPLE_INTERVAL_SECS / (SAMPLE_INTERVAL_SECS / (REFERENCE_STEP_RATIO * safe.min(most_secs))).ceil()
}
