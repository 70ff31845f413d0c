//! One coarse grid: its corners and a symmetric matrix that connects each with its 26 neighbours, made from that of the
//! finer grid and from contact. [`super::colours`] sweeps over it.

use glam::DMat3;

use super::colours::Colours;
use super::parents::{Parents, find};

/// The neighbours that come before a corner in their order, and the corner itself.
const ROW: usize = 14;

/// The place of the corner itself.
const DIAGONAL: usize = ROW - 1;

/// A coarse grid.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    /// Where its corners are, in its own numbers; x fastest, ascending.
    pub(super) corners: Vec<[u32; 3]>,
    /// Their parents on the next coarser grid; none on the coarsest.
    pub(super) parents: Parents,
    /// The numbers of the neighbours that come before; the corner's own number where there is none.
    near: Vec<[u32; DIAGONAL]>,
    /// The rows of the matrix up to the diagonal, kg; zero where there is no neighbour.
    rows: Vec<[DMat3; ROW]>,
    /// The matrix and the vectors in the form that sweeps use.
    pub(super) colours: Colours,
    /// The rows without contact of the corners where contact resists, and which corners these are.
    free: Vec<(u32, [DMat3; ROW])>,
    is_held: Vec<bool>,
}

impl Grid {
    /// Returns the memory of a corner in a box with this many places for each, bytes; the rows kept for contact are left
    /// out.
    pub(super) const fn bytes_a_corner(places: usize) -> usize {
        size_of::<[u32; 3]>()
            + size_of::<[u32; DIAGONAL]>()
            + size_of::<[DMat3; ROW]>()
            + size_of::<(u32, [DMat3; ROW])>()
            + Colours::bytes_a_corner(places)
    }

    /// Makes a grid without a matrix, with its parents on the next coarser one, whose corners are `coarser`.
    pub(super) fn new(corners: Vec<[u32; 3]>, parents: Parents, coarser: &[[u32; 3]]) -> Self {
        let colours = Colours::new(&corners, coarser);
        let count = corners.len();
        let near_of = |(number, corner): (u32, &[u32; 3])| {
            std::array::from_fn(|place| {
                let step = [place % 3, place / 3 % 3, place / 9];
                let at = [0, 1, 2].map(|axis| (corner[axis] as usize + step[axis]).checked_sub(1));
                let [Some(x), Some(y), Some(z)] = at.map(|at| at.and_then(|at| u32::try_from(at).ok())) else {
                    return number;
                };
                find(&corners, [x, y, z]).unwrap_or(number)
            })
        };
        let near = (0..).zip(&corners).map(near_of).collect();
        Self {
            near,
            corners,
            parents,
            rows: vec![[DMat3::ZERO; ROW]; count],
            colours,
            free: Vec::new(),
            is_held: vec![false; count],
        }
    }

    /// Makes the matrix zero.
    pub(super) fn clear(&mut self) {
        self.remove_resistance();
        self.rows.fill([DMat3::ZERO; ROW]);
    }

    /// Adds `w wᵀ block`, where w are the weights.
    pub(super) fn add(&mut self, weights: &CornerWeights, block: &DMat3) {
        for &(row, factor) in weights.parts() {
            for &(column, other) in weights.parts() {
                if column <= row {
                    let place = self.place(row, column);
                    self.rows[row as usize][place] += *block * (factor * other);
                }
            }
        }
    }

    /// Returns the place in a row of a column that does not come after it.
    fn place(&self, row: u32, column: u32) -> usize {
        let (from, to) = (self.corners[row as usize], self.corners[column as usize]);
        let step = |axis: usize| 1 + to[axis] as usize - from[axis] as usize;
        step(0) + 3 * step(1) + 9 * step(2)
    }

    /// Makes the matrix `Pᵀ A P` of the finer grid.
    pub(super) fn project(&mut self, finer: &Self) {
        self.clear();
        for number in 0..finer.corners.len() {
            let (own, own_weight) = finer.parents.of(number);
            for (other, block) in finer.row(number) {
                let (others, other_weight) = finer.parents.of(other);
                let (block, mirrored) = (block * (own_weight * other_weight), other != number);
                for &row in own {
                    for &column in others {
                        if column <= row {
                            let place = self.place(row, column);
                            self.rows[row as usize][place] += block;
                        }
                        if row <= column && mirrored {
                            let place = self.place(column, row);
                            self.rows[column as usize][place] += block.transpose();
                        }
                    }
                }
            }
        }
    }

    /// Copies the matrix to where it is swept.
    pub(super) fn copy_all_to_colours(&mut self) {
        (0..self.corners.len()).for_each(|number| self.copy_to_colours(number));
    }

    /// Removes the resistance of contact.
    pub(super) fn remove_resistance(&mut self) {
        while let Some((number, row)) = self.free.pop() {
            let number = number as usize;
            (self.rows[number], self.is_held[number]) = (row, false);
            self.copy_to_colours(number);
        }
    }

    /// Adds the resistance of contact, kg, of a particle whose velocity is the sum of `parts` times those of corners.
    /// [`Self::copy_held_to_colours`] passes it on to sweeps.
    pub(super) fn add_resistance(&mut self, parts: &CornerMatrices, resistance: &DMat3) {
        for (row, by_row) in parts.all() {
            let number = *row as usize;
            if !self.is_held[number] {
                self.is_held[number] = true;
                // Room for all of them, once something touches.
                self.free.reserve(self.corners.len() - self.free.len());
                self.free.push((*row, self.rows[number]));
            }
            let across = by_row.transpose() * *resistance;
            for (column, by_column) in parts.all() {
                if column <= row {
                    let place = self.place(*row, *column);
                    self.rows[number][place] += across * *by_column;
                }
            }
        }
    }

    /// Copies the rows where contact resists to where they are swept.
    pub(super) fn copy_held_to_colours(&mut self) {
        for at in 0..self.free.len() {
            self.copy_to_colours(self.free[at].0 as usize);
        }
    }

    /// Returns a sum over corners as one over their parents.
    pub(super) fn on_parents(&self, parts: &CornerMatrices) -> CornerMatrices {
        let mut sum = CornerMatrices::NONE;
        if self.parents.len() == 0 {
            return sum;
        }
        for (corner, part) in parts.all() {
            let (corners, weight) = self.parents.of(*corner as usize);
            for &corner in corners {
                sum.add(corner, &(*part * weight));
            }
        }
        sum
    }

    /// Returns a corner's row of the matrix up to the diagonal, with the numbers of the columns.
    pub(super) fn row(&self, number: usize) -> impl Iterator<Item = (usize, DMat3)> {
        let before = self.near[number].iter().map(|near| *near as usize).zip(self.rows[number]);
        before.filter(move |(near, _)| *near != number).chain([(number, self.rows[number][DIAGONAL])])
    }

    /// Copies the row of a corner to where it is swept.
    fn copy_to_colours(&mut self, number: usize) {
        let row = &self.rows[number];
        for (step, (near, block)) in self.near[number].iter().zip(row).enumerate() {
            if *near as usize != number {
                self.colours.set([number, *near as usize], step, block);
            }
        }
        self.colours.set_inverse(number, &inverted(&row[DIAGONAL]));
    }
}

/// Returns the inverse of a block on the diagonal: zero if only pinned particles belong to the corner.
fn inverted(block: &DMat3) -> DMat3 {
    if block.determinant() == 0.0 { DMat3::ZERO } else { block.inverse() }
}

/// A sum over corners, each with its factor: up to eight, and as many from another sum.
#[derive(Clone, Copy, Debug)]
pub(super) struct CornerWeights {
    parts: [(u32, f64); 16],
    count: usize,
}

impl CornerWeights {
    /// Returns the mean of parents, times a factor.
    pub(super) fn of((corners, weight): (&[u32], f64), factor: f64) -> Self {
        let mut weights = Self { parts: [(0, 0.0); 16], count: 0 };
        for &corner in corners {
            weights.add(corner, weight * factor);
        }
        weights
    }

    /// Returns the mean of the parents that two corners have in common.
    pub(super) fn common([(one, _), (other, _)]: [(&[u32], f64); 2]) -> Self {
        let mut weights = Self::of((&[], 0.0), 0.0);
        one.iter().filter(|corner| other.contains(corner)).for_each(|&corner| weights.add(corner, 1.0));
        let weight = 1.0 / weights.count as f64;
        weights.parts.iter_mut().for_each(|(_, factor)| *factor *= weight);
        weights
    }

    fn add(&mut self, corner: u32, factor: f64) {
        if let Some((_, sum)) = self.parts[..self.count].iter_mut().find(|(known, _)| *known == corner) {
            *sum += factor;
        } else {
            self.parts[self.count] = (corner, factor);
            self.count += 1;
        }
    }

    pub(super) fn minus(mut self, other: &Self) -> Self {
        other.parts().iter().for_each(|&(corner, factor)| self.add(corner, -factor));
        self
    }

    fn parts(&self) -> &[(u32, f64)] {
        &self.parts[..self.count]
    }
}

/// A sum over corners, each with its matrix: the velocity of a particle, whose corners lie about one cell of every grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct CornerMatrices {
    parts: [(u32, DMat3); 8],
    count: usize,
}

impl CornerMatrices {
    pub(super) const NONE: Self = Self { parts: [(0, DMat3::ZERO); 8], count: 0 };

    pub(super) fn add(&mut self, corner: u32, part: &DMat3) {
        if let Some((_, sum)) = self.parts[..self.count].iter_mut().find(|(known, _)| *known == corner) {
            *sum += *part;
        } else {
            self.parts[self.count] = (corner, *part);
            self.count += 1;
        }
    }

    fn all(&self) -> &[(u32, DMat3)] {
        &self.parts[..self.count]
    }
}
