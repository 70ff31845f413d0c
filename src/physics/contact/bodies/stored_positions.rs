//! Where bodies were when neighbour lists were made, and how far they have moved since.

use glam::DVec3;

use crate::math::{Aabb, Real};
use crate::physics::kernels::displacement_bounds;
use crate::physics::model::Model;
use crate::physics::model::plan::Plan;
use crate::physics::team;

/// How far bodies may move past each other until lists are rebuilt, in cells.
pub(super) const LIST_MARGIN: f64 = 0.25;

/// The share of the margin that is used: the rest is for rounding error.
pub(super) const USED_MARGIN_SHARE: f64 = 0.999;

/// No displacement.
const NO_DISPLACEMENT: Aabb<f64> = Aabb { min: DVec3::ZERO, max: DVec3::ZERO };

/// Where bodies were when lists were made, and how far they have moved since.
#[derive(Clone, Debug, Default)]
pub(super) struct StoredPositions {
    /// The stored positions of the particles of each body, m.
    pub(super) positions: Vec<DVec3>,
    /// The box around the displacements of each body since, m.
    pub(super) displacement_bounds: Vec<Aabb<f64>>,
    /// How often the positions of each body were stored.
    store_counts: Vec<u32>,
}

impl StoredPositions {
    /// Makes room for this many particles and bodies.
    pub(super) fn new(particles: usize, bodies: usize) -> Self {
        Self {
            positions: Vec::with_capacity(particles),
            displacement_bounds: Vec::with_capacity(bodies),
            store_counts: vec![0; bodies],
        }
    }

    /// Updates the displacements; `predicted` is where particles would be at the end of the substep, m.
    pub(super) fn update_displacements<R: Real>(&mut self, plan: &Plan, model: &Model<R>, predicted: &[DVec3]) {
        if self.positions.len() != predicted.len() {
            self.positions.clear();
            self.positions.extend_from_slice(predicted);
            self.displacement_bounds.clear();
            self.displacement_bounds.resize(model.bodies.len(), NO_DISPLACEMENT);
            self.store_counts.iter_mut().for_each(|count| *count = count.wrapping_add(1));
            return;
        }
        let stored = &self.positions;
        team::by_bodies(plan.threads, model, &mut self.displacement_bounds, |part, displacements| {
            for (body, displacements) in model.bodies[part].iter().zip(displacements) {
                let [stored, now] = [stored, predicted].map(|of| &of[body.particles.clone()]);
                *displacements = displacement_bounds::<f64>(plan.simd, stored, now);
            }
        });
    }

    /// Stores positions anew where the bodies of a pair have moved past each other by more than the margin, so that their lists
    /// are rebuilt. Renews only the body that moved further, and the other where that is not enough.
    pub(super) fn renew_outdated<R: Real>(&mut self, model: &Model<R>, pairs: &[[usize; 2]], predicted: &[DVec3]) {
        loop {
            let mut has_renewed = false;
            for pair in pairs {
                let mut order = *pair;
                order.sort_by(|one, other| {
                    self.largest_displacement(*other).total_cmp(&self.largest_displacement(*one))
                });
                for body in order {
                    // A NaN distance counts as too far.
                    let displacement = self.relative_displacement(*pair);
                    if !displacement.is_nan() && displacement <= USED_MARGIN_SHARE * list_margin(model, *pair) {
                        break;
                    }
                    let own = model.bodies[body].particles.clone();
                    self.positions[own.clone()].copy_from_slice(&predicted[own]);
                    self.displacement_bounds[body] = NO_DISPLACEMENT;
                    self.store_counts[body] = self.store_counts[body].wrapping_add(1);
                    has_renewed = true;
                }
            }
            // A renewed body has now moved past another that had moved along with it.
            if !has_renewed {
                return;
            }
        }
    }

    /// How far a body has moved along an axis at most, m.
    fn largest_displacement(&self, body: usize) -> f64 {
        let Aabb { min, max } = self.displacement_bounds[body];
        max.max(-min).max_element()
    }

    /// How far the points of one body may have moved past the cells of another since the positions of both were stored, m.
    pub(super) fn relative_displacement(&self, pair: [usize; 2]) -> f64 {
        let [points, cells] = pair.map(|body| self.displacement_bounds[body]);
        (points.max - cells.min).max(cells.max - points.min).max_element()
    }

    /// How often the positions of the two bodies of a pair were stored.
    pub(super) fn store_counts(&self, pair: [usize; 2]) -> [u32; 2] {
        pair.map(|body| self.store_counts[body])
    }
}

/// How far the bodies of a pair may move past each other until their list is rebuilt, m.
pub(super) fn list_margin<R: Real>(model: &Model<R>, [_, cells]: [usize; 2]) -> f64 {
    LIST_MARGIN * model.bodies[cells].lattice.grid.cell_size
}
