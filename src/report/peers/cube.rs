//! The cube of the comparison: it hangs by its top and is let go unstretched.

use std::sync::Arc;

use crate::geometry::{Lattice, Watch};
use crate::physics::{BodyModel, Simulation};
use crate::report::error::SAMPLE_INTERVAL_SECS;
use crate::report::error::SteppingMethod;
use crate::report::error::recording::{record_run, rounded_count};
use crate::report::error::scenes::hanging;
use crate::report::extremes::lattices;
use crate::scene::resolve::ResolveError;
use crate::scene::{Material, Scene, Solid};

/// The time in which a strongly damped body comes to rest, s.
pub(super) const REST_SECS: f64 = 1.6;
/// The step on the way to rest, s. The rest position does not depend on it.
pub(super) const REST_STEP_SECS: f64 = 0.008;
/// The damping ratio of our cube on the way to rest. The rest position does not depend on it.
const REST_DAMPING_RATIO: f64 = 0.7;

/// A cube of 1 m.
pub(super) struct Cube {
    pub(super) divisions: u32,
    pub(super) scene: Scene,
    pub(super) lattices: Vec<Arc<Lattice>>,
    /// Its particles, masses, links and pins.
    pub(super) body: BodyModel<f64>,
}

impl Cube {
    /// A hanging cube of this solid; an error if it cannot be made, which no number of divisions in use should cause.
    pub(super) fn hanging(divisions: u32, solid: Solid) -> Result<Self, ResolveError> {
        let mut scene = hanging(divisions);
        for body in &mut scene.bodies {
            body.material = Material::Solid(solid);
        }
        let lattices = lattices(&scene)?;
        let body = Simulation::<f64>::new(&scene, &lattices).model().bodies[0].clone();
        Ok(Self { divisions, scene, lattices, body })
    }

    /// The particles' rest positions, by automatic stepping in double precision, m; none where `watch` cancels.
    pub(super) fn rest_positions(&self, watch: &dyn Watch) -> Option<Vec<[f64; 3]>> {
        let mut scene = SteppingMethod::Automatic.applied(&self.scene, REST_STEP_SECS);
        for body in &mut scene.bodies {
            if let Material::Solid(solid) = &mut body.material {
                solid.damping_ratio = REST_DAMPING_RATIO;
            }
        }
        record_run::<f64>(&scene, &self.lattices, rounded_count(REST_SECS / SAMPLE_INTERVAL_SECS), None, watch)
            .samples
            .pop()
    }

    /// How far the lowest layer of particles has sunk on average, m.
    pub(super) fn sag(&self, now: &[[f64; 3]]) -> f64 {
        let start = &self.body.start;
        let lowest = start.iter().map(|start| start.y).fold(f64::INFINITY, f64::min);
        let is_low = |start: f64| start - lowest < 0.5 / f64::from(self.divisions);
        let sunk: Vec<f64> =
            start.iter().zip(now).filter(|(start, _)| is_low(start.y)).map(|(a, b)| a.y - b[1]).collect();
        sunk.iter().sum::<f64>() / sunk.len().max(1) as f64
    }
}
