//! Push and pull against inversion in the equations of the implicit integrator, and their part in its energy balance.

use glam::{DMat3, DVec3};

use crate::math::{Real, Vector};
use crate::physics::forces::recovery::edges::{MeanEdges, Strength, mean_edges};
use crate::physics::forces::recovery::pull;
use crate::physics::model::{BodyModel, Scheme};
use crate::physics::state::BodyMemory;

/// The resistance of a pushed cell to motion: its part of the equations of the implicit integrator.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct Resistance {
    corners: [u32; 8],
    /// The way of the mean edges out of the cell's depth, 1/m.
    growth: [DVec3; 3],
    /// Second derivative of the energy along that way, J.
    stiffness: f64,
    /// Second derivative of the pull's energy by the mean edges, at most, N/m.
    pull: f64,
}

impl Resistance {
    /// Adds `−scale` times the force on corners that move by `ways` (m) to `to`: `scale κ ∇V (∇V · way)`. Changes of ∇V (as
    /// in Gauss-Newton) and, for the pull, of the rotation are left out, so it never pushes.
    pub(in crate::physics) fn add_product(&self, scale: f64, ways: &[DVec3], to: &mut [DVec3]) {
        let rates = mean_edges::<f64>(ways, &self.corners, 1.0);
        let grown = (0..3).fold(0.0, |sum, axis| sum + rates[axis].dot(self.growth[axis]));
        for (place, &corner) in self.corners.iter().enumerate() {
            let pulled = quarters(&rates, place) * (scale * self.pull);
            to[corner as usize] += self.gradient(place) * (scale * self.stiffness * grown) + pulled;
        }
    }

    /// Calls `visit` with every corner and a third of the trace of its diagonal block, N/m.
    pub(in crate::physics) fn for_each_diagonal(&self, mut visit: impl FnMut(usize, f64)) {
        for (place, &corner) in self.corners.iter().enumerate() {
            let pull = self.pull * 3.0 / 16.0;
            visit(corner as usize, self.stiffness * self.gradient(place).length_squared() / 3.0 + pull);
        }
    }

    /// The particles of the cell, by their local numbers.
    pub(in crate::physics) fn corners(&self) -> [u32; 8] {
        self.corners
    }

    /// The block between two of these corners, N/m: what [`Self::add_product`] makes of the way of the second at the first.
    pub(in crate::physics) fn block(&self, [one, other]: [usize; 2]) -> DMat3 {
        let [of_one, of_other] = [one, other].map(|place| self.gradient(place) * self.stiffness.sqrt());
        let along = DMat3::from_cols(of_one * of_other.x, of_one * of_other.y, of_one * of_other.z);
        let alike: f64 = (0..3).map(|axis| if (one ^ other) >> axis & 1 == 0 { 1.0 / 16.0 } else { -1.0 / 16.0 }).sum();
        along + DMat3::from_diagonal(DVec3::splat(self.pull * alike))
    }

    fn gradient(&self, place: usize) -> DVec3 {
        quarters(&self.growth, place)
    }
}

/// Returns a corner's part of vectors that act on its cell's mean edges.
fn quarters(edges: &[DVec3; 3], place: usize) -> DVec3 {
    (0..3).fold(DVec3::ZERO, |sum, axis| sum + edges[axis] * if place >> axis & 1 == 1 { 0.25 } else { -0.25 })
}

/// Returns the resistances of the cells on a body's list that are pushed. `position` is the body's own.
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
            growth: edges.recovery_direction(&[R::Vec3::ZERO; 3]).map(|way| way.to_dvec3() * per_size),
            stiffness: stiffness * edges.resistance(),
            pull: if pull > 0.0 { pull * pull::resistance(&edges) } else { 0.0 },
        })
    })
}

/// Returns the energy that the pushed cells of a body gain beyond what the work of their forces accounts for, J, while its
/// particles, which had one velocity, move with another (m/s) for `dt` (s): see
/// [`crate::physics::schemes::implicit::balance`].
pub(in crate::physics) fn energy_past_work<R: Real>(
    body: &BodyModel<R>,
    memory: &BodyMemory,
    [position, velocity, moving_velocity]: [&[R::Vec3]; 3],
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
        let moved = corners.map(|corner| position[corner as usize] + moving_velocity[corner as usize] * dt);
        let own = [0, 1, 2, 3, 4, 5, 6, 7];
        let before = MeanEdges::of(&at, &own, body.inverse_cell_size);
        let after = MeanEdges::of(&moved, &own, body.inverse_cell_size);
        let way = mean_edges(moving_velocity, corners, dt);
        let rates = mean_edges(velocity, corners, R::ONE);
        let work_of = |force: [R::Vec3; 3]| (0..3).fold(0.0, |sum, axis| sum + force[axis].dot(way[axis]).to_f64());
        let pulled = pull.and_then(|pull| pull::cell_force(&before, &rates, strength(pull)));
        let pushed = before.push(&rates, strength(stiffness));
        let work = pushed.map_or(0.0, work_of) + pulled.map_or(0.0, work_of);
        sum += energy_of(&after) - energy_of(&before) + work;
    }
    sum
}
