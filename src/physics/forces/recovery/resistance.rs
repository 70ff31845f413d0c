//! The push against inversion in the equations of the implicit integrator, and its part in their balance of energy.

use glam::DVec3;

use crate::math::{Real, Vector};
use crate::physics::forces::recovery::edges::{MeanEdges, Strength, mean_edges};
use crate::physics::forces::recovery::pull;
use crate::physics::model::{BodyModel, Scheme};
use crate::physics::state::BodyMemory;

/// What a cell that is pushed resists while it moves: its part of the equations of the implicit integrator.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct Resistance {
    corners: [u32; 8],
    /// What brings the cell out of its depth when the mean edges gain it, 1/m.
    growth: [DVec3; 3],
    /// The energy's second derivative by that, J.
    stiffness: f64,
    /// That of the pull by the mean edges, at most, N/m.
    pull: f64,
}

impl Resistance {
    /// Adds the force on the corners that move by these ways (m), times −`scale`, to `to`: `scale κ ∇V (∇V · way)`, which
    /// leaves out that ∇V changes (Gauss and Newton) and so never pushes, and as for the pull, that the rotation does.
    pub(in crate::physics) fn add_product(&self, scale: f64, ways: &[DVec3], to: &mut [DVec3]) {
        let rates = mean_edges::<f64>(ways, &self.corners, 1.0);
        let grown = (0..3).fold(0.0, |sum, axis| sum + rates[axis].dot(self.growth[axis]));
        for (place, &corner) in self.corners.iter().enumerate() {
            let pulled = quarters(&rates, place) * (scale * self.pull);
            to[corner as usize] += self.gradient(place) * (scale * self.stiffness * grown) + pulled;
        }
    }

    /// Calls `visit` with every corner and a third of the trace of its block, N/m.
    pub(in crate::physics) fn for_each_diagonal(&self, mut visit: impl FnMut(usize, f64)) {
        for (place, &corner) in self.corners.iter().enumerate() {
            let pull = self.pull * 3.0 / 16.0;
            visit(corner as usize, self.stiffness * self.gradient(place).length_squared() / 3.0 + pull);
        }
    }

    fn gradient(&self, place: usize) -> DVec3 {
        quarters(&self.growth, place)
    }
}

/// What a corner gets of what its mean edges get.
fn quarters(edges: &[DVec3; 3], place: usize) -> DVec3 {
    (0..3).fold(DVec3::ZERO, |sum, axis| sum + edges[axis] * if place >> axis & 1 == 1 { 0.25 } else { -0.25 })
}

/// The resistances of the cells on a body's list that are pushed. `position` is the body's own.
pub(in crate::physics) fn resistances<R: Real>(
    body: &BodyModel<R>,
    memory: &BodyMemory,
    position: &[R::Vec3],
) -> impl Iterator<Item = Resistance> {
    let stiffness = body.recovery.push.to_f64();
    let inverse_cell_size = body.inverse_cell_size;
    let per_size = inverse_cell_size.to_f64();
    let pull = pull::stiffness(body, memory).map_or(0.0, |pull| pull.to_f64() * per_size * per_size);
    memory.near_inversion.iter().filter_map(move |&cell| {
        let corners = body.lattice.cells[cell as usize];
        let edges = MeanEdges::of(position, &corners, inverse_cell_size);
        edges.is_pushed().then(|| Resistance {
            corners,
            growth: edges.way_out(&[R::Vec3::ZERO; 3]).map(|way| way.to_dvec3() * per_size),
            stiffness: stiffness * edges.resistance(),
            pull: if pull > 0.0 { pull * pull::resistance(&edges) } else { 0.0 },
        })
    })
}

/// What the pushed cells of a body have of energy past the work of their forces, J, when its particles, that had one
/// velocity, go on with another (m/s) for `dt` (s): see [`crate::physics::schemes::implicit::balance`].
pub(in crate::physics) fn energy_past_work<R: Real>(
    body: &BodyModel<R>,
    memory: &BodyMemory,
    [position, velocity, path]: [&[R::Vec3]; 3],
    dt: R,
) -> f64 {
    let stiffness = body.recovery.push;
    let pull = pull::stiffness(body, memory);
    let energy_of = |edges: &MeanEdges<R>| {
        let pulled = pull.map_or(0.0, |pull| pull::cell_energy(edges) * pull.to_f64());
        edges.energy() * stiffness.to_f64() + pulled
    };
    let strength = |stiffness| Strength::of(body, stiffness, Scheme::Implicit, dt);
    let mut sum = 0.0;
    for &cell in &memory.near_inversion {
        let corners = &body.lattice.cells[cell as usize];
        let at = corners.map(|corner| position[corner as usize]);
        let moved = corners.map(|corner| position[corner as usize] + path[corner as usize] * dt);
        let own = [0, 1, 2, 3, 4, 5, 6, 7];
        let before = MeanEdges::of(&at, &own, body.inverse_cell_size);
        let after = MeanEdges::of(&moved, &own, body.inverse_cell_size);
        let way = mean_edges(path, corners, dt);
        let rates = mean_edges(velocity, corners, R::ONE);
        let work_of = |force: [R::Vec3; 3]| (0..3).fold(0.0, |sum, axis| sum + force[axis].dot(way[axis]).to_f64());
        let pulled = pull.and_then(|pull| pull::cell_force(&before, &rates, strength(pull)));
        let pushed = before.push(&rates, strength(stiffness));
        let work = pushed.map_or(0.0, work_of) + pulled.map_or(0.0, work_of);
        sum += energy_of(&after) - energy_of(&before) + work;
    }
    sum
}
