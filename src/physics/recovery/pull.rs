//! Bodies that are stuck: slow, with cells that are inverted.

use super::THRESHOLD;
use super::edges::{MeanEdges, spread};
use super::rotation::nearest_rotation;
use crate::math::{Real, Vector};
use crate::physics::model::BodyModel;
use crate::physics::plan::Plan;
use crate::physics::state::BodyMemory;
use crate::scene::settings::Integrator;

/// The stiffness of the pull over that of the push, at most.
const SHARE: f64 = 0.5;

/// A body is slow while no link changes its length faster than by this, body sizes a second.
const SLOW: f64 = 1e-2;

/// For how long a body with inverted cells must be slow to be stuck, s: less than it takes to fall asleep.
const SLOW_SECS: f64 = 0.1;

/// Tells whether a body is stuck whose cells' smallest volume is `smallest`, before a substep of `secs`.
pub(super) fn judge<R: Real>(
    body: &BodyModel<R>,
    memory: &mut BodyMemory,
    smallest: f64,
    position: &[R::Vec3],
    velocity: &[R::Vec3],
    secs: f64,
) {
    if memory.stuck {
        memory.stuck = smallest < THRESHOLD;
        return;
    }
    if smallest > 0.0 || !is_slow(body, position, velocity) {
        memory.knotted_nanos = 0;
        return;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a time of at least one, saturating")]
    let nanos = libm::ceil(secs * 1e9) as u32;
    memory.knotted_nanos = memory.knotted_nanos.saturating_add(nanos);
    if f64::from(memory.knotted_nanos) >= SLOW_SECS * 1e9 {
        forget(memory);
        memory.stuck = true;
    }
}

/// The body is not stuck, and not about to be.
pub(super) fn forget(memory: &mut BodyMemory) {
    (memory.stuck, memory.knotted_nanos) = (false, 0);
}

/// Whether no link changes its length fast, however the body moves and turns as a whole.
fn is_slow<R: Real>(body: &BodyModel<R>, position: &[R::Vec3], velocity: &[R::Vec3]) -> bool {
    let slow = R::from_f64(SLOW) * body.size;
    body.links.iter().flat_map(|family| &family.links).all(|link| {
        let [i, j] = link.ends.map(|end| end as usize);
        let (d, dv) = (position[j] - position[i], velocity[j] - velocity[i]);
        let along = d.dot(dv);
        along * along <= slow * slow * d.dot(d)
    })
}

/// The stiffness of the pull as far as the substep bears it, N·m.
///
/// With `x = κ dt²/(m h²)` for a stiffness κ of the push, links are at most 8 x of the limit, 4, the push 4 x, and a pull
/// of stiffness p κ adds 4 p x.
pub(super) fn bearable_stiffness<R: Real>(plan: &Plan, body: &BodyModel<R>) -> R {
    if plan.integrator == Integrator::Implicit {
        return body.recovery_stiffness * R::from_f64(SHARE);
    }
    let inverse = body.inverse_cell_size.to_f64() * plan.substep_secs();
    let load = body.recovery_stiffness.to_f64() * inverse * inverse / body.recovery_mass.to_f64();
    body.recovery_stiffness * R::from_f64((1.0 / load - 3.0).clamp(0.0, SHARE))
}

/// Adds the pull of all cells of a body for a stiffness over the cell size, N.
pub(super) fn add_forces<R: Real>(body: &BodyModel<R>, position: &[R::Vec3], stiffness: R, force: &mut [R::Vec3]) {
    for corners in &body.lattice.cells {
        let edges = MeanEdges::of(position, corners, body.inverse_cell_size);
        spread::<R>(&cell_force(&edges, stiffness), corners, force);
    }
}

/// The forces on the three mean edges for a stiffness over the cell size, N.
pub(super) fn cell_force<R: Real>(edges: &MeanEdges<R>, stiffness: R) -> [R::Vec3; 3] {
    let (rotation, _) = nearest_rotation::<R>(&edges.edges, &edges.faces);
    std::array::from_fn(|axis| (rotation[axis] - edges.edges[axis]) * stiffness)
}

/// The energy of the pull of all cells of a body for a stiffness of one.
pub(super) fn energy<R: Real>(body: &BodyModel<R>, position: &[R::Vec3]) -> f64 {
    let of = |corners: &[u32; 8]| cell_energy(&MeanEdges::of(position, corners, body.inverse_cell_size));
    body.lattice.cells.iter().map(of).sum()
}

/// The energy of the pull of a cell for a stiffness of one: half the square of what is missing to a rotation.
pub(super) fn cell_energy<R: Real>(edges: &MeanEdges<R>) -> f64 {
    let (_, along) = nearest_rotation::<R>(&edges.edges, &edges.faces);
    let size = edges.edges.iter().fold(0.0, |sum, edge| sum + edge.dot(*edge).to_f64());
    0.5 * (size + 3.0 - 2.0 * along.to_f64()).max(0.0)
}
