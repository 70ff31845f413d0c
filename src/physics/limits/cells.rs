//! The stability bound of bodies whose cells share out links and masses.
//!
//! The largest eigenvalue of an assembly is no larger than that of its stiffest part (Irons and Treharne 1971; Fried,
//! *Bounding the extremal eigenvalues of the finite element stiffness and mass matrices*, 1973): with every cell's own
//! 24×24 matrices,
//!
//! ```text
//! λ_max(M⁻¹ A) ≤ max over cells λ_max(M_c⁻¹ A_c)
//! ```
//!
//! It holds for every set of cells, mixed materials and pinned particles, where the bound by plane waves does not: particles
//! at a surface weigh less than those inside. For a body of one solid a tighter bound is known (`lattice`).

use crate::physics::model::CellKind;

/// Three components for each of the eight corners of a cell.
pub(super) const SIZE: usize = 24;

type Matrix = [[f64; SIZE]; SIZE];

/// Largest eigenvalues over all cells: of stiffness over mass (1/s²) and of damping over mass (1/s).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::physics) struct CellLoads {
    /// Stiffness of each family alone.
    pub(in crate::physics) stiffness_alone: [f64; 3],
    /// Damping of each family alone.
    pub(in crate::physics) damping_alone: [f64; 3],
    /// All stiffness.
    pub(in crate::physics) stiffness: f64,
    /// All damping.
    pub(in crate::physics) damping: f64,
    /// The largest ratio of stiffness to damping of any link, 1/s: infinite if a link has only stiffness.
    pub(in crate::physics) stiffness_per_damping: f64,
}

impl CellLoads {
    /// Returns the loads over cells of some kinds and one size, m.
    pub(in crate::physics) fn of(kinds: &[CellKind], cell_size: f64) -> Self {
        let unit = [unit_cell([1.0, 0.0]), unit_cell([0.0, 1.0])];
        let alone = unit.map(largest_eigenvalue);
        let mut loads = Self::default();
        for kind in kinds {
            // An eighth of the mass at every corner.
            let scale = 8.0 / (kind.mass * cell_size);
            let stiffness = largest_eigenvalue(unit_cell(of_cells(kind.stiffness)));
            let [[ks, kd], [ds, dd]] = [kind.stiffness, kind.damping].map(of_cells);
            let is_proportional = (ks * dd - kd * ds).abs() <= 1e-12 * (ks * dd).abs() && kd > 0.0;
            let damping = if is_proportional {
                stiffness * dd / kd
            } else {
                largest_eigenvalue(unit_cell(of_cells(kind.damping)))
            };
            for family in 0..2 {
                let [k, d] = [kind.stiffness, kind.damping].map(|of| of[family] * alone[family] * scale);
                loads.stiffness_alone[family] = loads.stiffness_alone[family].max(k);
                loads.damping_alone[family] = loads.damping_alone[family].max(d);
                let per_damping = if k > 0.0 { k / d } else { 0.0 };
                loads.stiffness_per_damping = loads.stiffness_per_damping.max(per_damping);
            }
            loads.stiffness = loads.stiffness.max(stiffness * scale);
            loads.damping = loads.damping.max(damping * scale);
        }
        loads
    }

    /// Returns the loads of a lattice that bears a share of what its cells would alone. No family alone bears more than all.
    pub(in crate::physics) fn shared(self, share: f64) -> Self {
        let (stiffness, damping) = (self.stiffness * share, self.damping * share);
        Self {
            stiffness_alone: self.stiffness_alone.map(|alone| alone.min(stiffness)),
            damping_alone: self.damping_alone.map(|alone| alone.min(damping)),
            stiffness,
            damping,
            ..self
        }
    }

    /// Returns the largest dt with `dt² stiffness + 2 dt damping ≤ 4`, s. The sum of the largest eigenvalues of two matrices
    /// is at least that of their sum, and equal if damping is in proportion to stiffness.
    pub(in crate::physics) fn dt_limit_secs(stiffness: f64, damping: f64) -> Option<f64> {
        let root = damping + (damping * damping + 4.0 * stiffness).sqrt();
        (root > 0.0).then(|| 4.0 / root)
    }
}

/// Returns the constants of the families that cells hold: links that run straight through a particle have no force in a
/// solid.
fn of_cells([structural, shear, _]: [f64; 3]) -> [f64; 2] {
    [structural, shear]
}

/// Returns the matrix of one cell of edge 1 whose links have their shares of these structural and shear constants.
pub(super) fn unit_cell([structural, shear]: [f64; 2]) -> Matrix {
    let mut matrix = [[0.0; SIZE]; SIZE];
    for a in 0..8_usize {
        for b in a + 1..8 {
            let offset: [f64; 3] = std::array::from_fn(|axis| {
                let [from, to] = [a, b].map(|corner| f64::from(u8::from(corner >> axis & 1 == 1)));
                to - from
            });
            let squared: f64 = offset.iter().map(|c| c * c).sum();
            let share = match (a ^ b).count_ones() {
                1 => structural / 4.0,
                2 => shear / 2.0,
                _ => shear,
            };
            // k/l0 times the outer product of the unit vector: that of the offset over its length cubed.
            let weight = share / (squared * squared.sqrt());
            for (i, x) in offset.iter().enumerate() {
                for (j, y) in offset.iter().enumerate() {
                    let entry = weight * x * y;
                    matrix[3 * a + i][3 * a + j] += entry;
                    matrix[3 * b + i][3 * b + j] += entry;
                    matrix[3 * a + i][3 * b + j] -= entry;
                    matrix[3 * b + i][3 * a + j] -= entry;
                }
            }
        }
    }
    matrix
}

/// Returns the largest eigenvalue of a symmetric matrix, by cyclic Jacobi rotations (Golub and Van Loan, *Matrix
/// Computations*, §8.5).
pub(super) fn largest_eigenvalue(mut a: Matrix) -> f64 {
    let norm: f64 = a.iter().flatten().map(|x| x * x).sum();
    for _ in 0..30 {
        let mut off = 0.0;
        for p in 0..SIZE {
            for q in p + 1..SIZE {
                off += a[p][q] * a[p][q];
                rotate(&mut a, p, q);
            }
        }
        if off <= 1e-26 * norm {
            break;
        }
    }
    (0..SIZE).map(|i| a[i][i]).fold(0.0, f64::max)
}

/// Rotates one off-diagonal entry to zero.
fn rotate(a: &mut Matrix, p: usize, q: usize) {
    if a[p][q] == 0.0 {
        return;
    }
    let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
    let c = 1.0 / (t * t + 1.0).sqrt();
    let s = t * c;
    for row in a.iter_mut() {
        let (x, y) = (row[p], row[q]);
        row[p] = c * x - s * y;
        row[q] = s * x + c * y;
    }
    if let Ok([first, second]) = a.get_disjoint_mut([p, q]) {
        for (x, y) in first.iter_mut().zip(second) {
            (*x, *y) = (c * *x - s * *y, s * *x + c * *y);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_alone_are_pairs_of_springs() {
        // Two corners joined by k/4 over length 1: the largest eigenvalue is twice that.
        assert!((largest_eigenvalue(unit_cell([4.0, 0.0])) - 2.0).abs() < 1e-12, "2 · 4/4");
    }

    #[test]
    fn a_solid_cell_vibrates_at_eight_times_modulus_over_density() {
        // E = 3.69227 shear/h²: in a unit cell of unit density, 8/m λ = w² ≤ 8 E/(ρ h²).
        let kind = CellKind { stiffness: [2.246_71, 1.0, 0.0], damping: [0.0; 3], mass: 1.0 };
        let loads = CellLoads::of(&[kind], 1.0);
        assert!((loads.stiffness / 3.692_27 - 8.0).abs() < 0.01, "{}", loads.stiffness / 3.692_27);
    }

    #[test]
    fn the_limit_solves_its_equation() {
        let dt = CellLoads::dt_limit_secs(50.0, 3.0).expect("limited");
        assert!((dt * dt * 50.0 + 2.0 * dt * 3.0 - 4.0).abs() < 1e-12, "with equality at {dt} s");
        assert_eq!(CellLoads::dt_limit_secs(0.0, 0.0), None, "nothing limits");
    }

    #[test]
    fn the_softest_cell_does_not_hide_the_stiffest() {
        let soft = CellKind { stiffness: [2.0, 1.0, 0.0], damping: [0.1, 0.3, 0.0], mass: 1.0 };
        let hard = CellKind { stiffness: [200.0, 100.0, 0.0], ..soft };
        let [one, both] = [CellLoads::of(&[hard], 0.5), CellLoads::of(&[soft, hard], 0.5)];
        assert_eq!(one, both, "the stiffest decides");
    }
}
