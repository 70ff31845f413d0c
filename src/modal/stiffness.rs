//! The equations of a body's small motion about rest, in its own coordinates and weighted by its masses:
//! `A = M^-½ K M^-½` over the particles that are not held.

use faer::MatMut;
use glam::DVec3;

use super::ordering::nested_dissection;
use crate::math::Real;
use crate::physics::BodyModel;

/// Stands for the place of a held particle, which has none.
const HELD: u32 = u32::MAX;

/// The equations of a body.
#[derive(Debug)]
pub(super) struct System {
    /// The particles that are not held, in the order in which they are eliminated. Three equations each.
    pub(super) free: Vec<u32>,
    /// Where every particle is at rest, m, in the body's coordinates.
    pub(super) rest: Vec<DVec3>,
    /// One over the root of each free particle's mass, kg^-½.
    pub(super) inverse_root_mass: Vec<f64>,
    /// Links with a force or a damping.
    pub(super) links: Vec<RestLink>,
    /// The mean of the diagonal of `A`, 1/s²: a measure of the overall stiffness.
    pub(super) mean_diagonal: f64,
}

/// A link at rest.
#[derive(Clone, Copy, Debug)]
pub(super) struct RestLink {
    /// Its particles, numbers of the body.
    pub(super) particles: [u32; 2],
    /// Their places among the free ones.
    places: [u32; 2],
    direction: DVec3,
    /// N/m.
    pub(super) stiffness: f64,
    /// N·s/m.
    damping: f64,
}

/// The lower half of a symmetric matrix by columns, rows ascending.
#[derive(Debug)]
pub(super) struct LowerColumns {
    /// Where every column begins, and the end of the last.
    pub(super) begins: Vec<usize>,
    pub(super) rows: Vec<usize>,
    pub(super) values: Vec<f64>,
}

impl System {
    /// The equations of a compiled body.
    pub(super) fn of<R: Real>(body: &BodyModel<R>) -> Self {
        let rest: Vec<DVec3> = (0..body.lattice.corners.len()).map(|p| body.lattice.rest_position(p)).collect();
        let mut links = Vec::new();
        let mut reach = 1;
        for (number, family) in body.links.iter().enumerate() {
            for (at, link) in family.links.iter().enumerate() {
                let [stiffness, damping] = family.constants(at).map(Real::to_f64);
                if stiffness <= 0.0 && damping <= 0.0 {
                    continue;
                }
                // Bending links span two cells.
                reach = reach.max(if number == 2 { 2 } else { 1 });
                let way = rest[link.ends[1] as usize] - rest[link.ends[0] as usize];
                let length = way.length();
                let [stiffness, damping] = [stiffness, damping].map(|constant| constant / length);
                links.push(RestLink {
                    particles: link.ends,
                    places: [HELD; 2],
                    direction: way / length,
                    stiffness,
                    damping,
                });
            }
        }
        let free_by_number: Vec<u32> = (0..).take(rest.len()).filter(|&p| !body.is_pinned(p as usize)).collect();
        let corners: Vec<[u32; 3]> = free_by_number.iter().map(|&p| body.lattice.corners[p as usize]).collect();
        let order = nested_dissection(&corners, reach);
        let free: Vec<u32> = order.iter().map(|&at| free_by_number[at as usize]).collect();
        let mut place = vec![HELD; rest.len()];
        for (at, &particle) in (0..).zip(&free) {
            place[particle as usize] = at;
        }
        for link in &mut links {
            link.places = link.particles.map(|particle| place[particle as usize]);
        }
        let inverse_root_mass = free.iter().map(|&p| 1.0 / body.mass(p as usize).to_f64().sqrt()).collect();
        let mut system = Self { free, rest, inverse_root_mass, links, mean_diagonal: 0.0 };
        let size = system.size().max(1) as f64;
        system.mean_diagonal = system.diagonals().iter().map(|d| d[0] + d[4] + d[8]).sum::<f64>() / size;
        system
    }

    /// The number of equations.
    pub(super) fn size(&self) -> usize {
        3 * self.free.len()
    }

    /// `to = A of` for every column.
    pub(super) fn apply(&self, of: &MatMut<'_, f64>, mut to: MatMut<'_, f64>) {
        to.fill(0.0);
        for column in 0..of.ncols() {
            for link in &self.links {
                let ends = link.places.map(|place| if place == HELD { None } else { Some(place as usize) });
                let at = |end: Option<usize>| {
                    end.map_or(DVec3::ZERO, |end| {
                        let x = [0, 1, 2].map(|axis| of[(3 * end + axis, column)]);
                        DVec3::from(x) * self.inverse_root_mass[end]
                    })
                };
                let pull = link.direction * (link.stiffness * link.direction.dot(at(ends[1]) - at(ends[0])));
                for (end, pull) in ends.into_iter().zip([-pull, pull]) {
                    let Some(end) = end else { continue };
                    for axis in 0..3 {
                        to[(3 * end + axis, column)] += pull[axis] * self.inverse_root_mass[end];
                    }
                }
            }
        }
    }

    /// The power that the links' damping takes from a motion of the particles: `vᵀ C v`, for velocities `v` by particle.
    pub(super) fn damping_power(&self, velocity: &[DVec3]) -> f64 {
        let of = |link: &RestLink| {
            let [a, b] = link.particles.map(|particle| velocity[particle as usize]);
            let along = link.direction.dot(b - a);
            link.damping * along * along
        };
        self.links.iter().map(of).sum()
    }

    /// The matrix with `shift` added to its diagonal, 1/s².
    pub(super) fn matrix(&self, shift: f64) -> LowerColumns {
        // The links of every free particle to free ones after it, the nearest in the order first.
        let both: Vec<(u32, u32, u32)> = {
            let free = (0..).zip(&self.links).filter(|(_, link)| link.places.iter().all(|&place| place != HELD));
            let mut both: Vec<_> = free
                .filter(|(_, link)| link.stiffness > 0.0)
                .map(|(number, link)| {
                    let [a, b] = link.places;
                    (a.min(b), a.max(b), number)
                })
                .collect();
            both.sort_unstable();
            both
        };
        let entries = 6 * self.free.len() + 9 * both.len();
        let mut begins = Vec::with_capacity(self.size() + 1);
        let (mut rows, mut values) = (Vec::with_capacity(entries), Vec::with_capacity(entries));
        let diagonals = self.diagonals();
        let mut rest = &both[..];
        begins.push(0);
        for (place, diagonal) in diagonals.iter().enumerate() {
            let own = rest.partition_point(|&(low, ..)| low as usize == place);
            let after;
            (after, rest) = rest.split_at(own);
            for axis in 0..3 {
                for row in axis..3 {
                    rows.push(3 * place + row);
                    values.push(diagonal[3 * row + axis] + if row == axis { shift } else { 0.0 });
                }
                for &(_, high, number) in after {
                    let link = &self.links[number as usize];
                    let weight = self.inverse_root_mass[place] * self.inverse_root_mass[high as usize];
                    for row in 0..3 {
                        rows.push(3 * high as usize + row);
                        values.push(-link.stiffness * link.direction[row] * link.direction[axis] * weight);
                    }
                }
                begins.push(rows.len());
            }
        }
        LowerColumns { begins, rows, values }
    }

    /// The 3×3 blocks on the diagonal of `A`, by free particle and row.
    fn diagonals(&self) -> Vec<[f64; 9]> {
        let mut diagonals = vec![[0.0; 9]; self.free.len()];
        for link in &self.links {
            for place in link.places.into_iter().filter(|&place| place != HELD) {
                let weight = self.inverse_root_mass[place as usize] * self.inverse_root_mass[place as usize];
                for row in 0..3 {
                    for column in 0..3 {
                        let entry = link.stiffness * link.direction[row] * link.direction[column] * weight;
                        diagonals[place as usize][3 * row + column] += entry;
                    }
                }
            }
        }
        diagonals
    }
}
