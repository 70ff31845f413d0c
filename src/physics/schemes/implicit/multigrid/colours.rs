//! Gauss–Seidel over a coarse grid, colour by colour.
//!
//! Corners whose numbers are even and odd along the same axes are not connected: each of these eight colours is relaxed at
//! once. The corners of one colour lie in a box of half the size, with room for one more at each end. So the neighbour of a
//! corner in any direction is at a constant distance, and vector instructions take many corners at a time:
//!
//! ```text
//!   x of the corners    0 1 2 3 4 5 …     even   0 2 4 …     odd   1 3 5 …
//!   next to an odd one  one less: the even one at the same place; one more: the one at the next place
//! ```
//!
//! A block of the symmetric matrix is kept once, with the corner of the later colour. Blocks are in single precision, as a
//! sweep spends most of its time reading them. Vectors are in double precision: the rounding errors of single precision are
//! waves of high frequency, which a stiff body resists with more than there was to solve for, and iterations go up by half.

use std::ops::Range;

use glam::{DMat3, DVec3};

use super::parents::find;
use crate::math::Real;

/// Places of the box that are worked on at a time.
const LANES: usize = 32;

/// How many colours there are.
const COLOURS: usize = 8;

/// Steps to the neighbours of a corner: `step = 1 + dx + 3 (1 + dy) + 9 (1 + dz)`.
const STEPS: usize = 27;

type Lanes = [f64; LANES];

/// Blocks of three rows and columns, row by row.
type LaneBlocks = [Lanes; 9];

/// Blocks in single precision.
type TermBlocks = [[f32; LANES]; 9];

/// The corners of a grid by colours, with the matrix and the vectors of a V-cycle.
#[derive(Clone, Debug)]
pub(super) struct Colours {
    /// Places before the first corner of a colour.
    margin: usize,
    /// Places to the next corner along each axis.
    strides: [usize; 3],
    /// Places of a colour.
    length: usize,
    groups: Vec<Group>,
    /// The groups of each colour.
    of_colour: [Range<usize>; COLOURS],
    /// The blocks of the matrix between a group's corners and those of earlier colours, kg.
    terms: Vec<Term>,
    /// The inverses of the blocks on the diagonal, 1/kg, by group.
    inverse: Vec<LaneBlocks>,
    /// Where each corner is.
    places: Vec<Place>,
    /// Where the corners of the next coarser grid are in `coarse`.
    parents: Vec<u32>,
    /// Right-hand side, N·s.
    load: [Vec<f64>; 3],
    /// Solution, m/s.
    solution: [Vec<f64>; 3],
    /// Residual, N·s.
    residual: [Vec<f64>; 3],
    /// Load that is handed on to the next coarser grid, and then its solution.
    coarse: [Vec<f64>; 3],
}

/// Corners of one colour that are relaxed together.
#[derive(Clone, Debug)]
struct Group {
    /// The place of the first within its colour.
    first: usize,
    terms: Range<usize>,
}

/// The blocks of a group's corners in one direction, to corners of an earlier colour.
#[derive(Clone, Debug)]
struct Term {
    step: usize,
    /// The place of the neighbour of the corner at place 0 of the colour.
    offset: usize,
    blocks: TermBlocks,
}

/// Where a corner is.
#[derive(Clone, Copy, Debug)]
struct Place {
    /// Its place in vectors.
    at: u32,
    group: u32,
    lane: u32,
}

impl Colours {
    /// Sorts the corners of a grid, which are x fastest, ascending, into colours, without a matrix; `coarser` are the
    /// corners of the next coarser grid.
    pub(super) fn new(corners: &[[u32; 3]], coarser: &[[u32; 3]]) -> Self {
        let most = |axis: usize| corners.iter().map(|corner| corner[axis] as usize).max().unwrap_or(0);
        // As many as the next coarser grid has, and one empty place.
        let [x, y, z] = [0, 1, 2].map(|axis| most(axis).div_ceil(2) + 2);
        let strides = [1, x, x * y];
        let margin: usize = strides.iter().sum();
        let length = x * y * z + 2 * margin + LANES;
        let flat = |of: [u32; 3]| margin + (0..3).map(|axis| of[axis] as usize * strides[axis]).sum::<usize>();
        let mut by_colour: [Vec<(usize, usize)>; COLOURS] = Default::default();
        for (number, corner) in corners.iter().enumerate() {
            by_colour[colour_of(*corner)].push((flat(corner.map(|c| c / 2)), number));
        }
        let mut this = Self {
            margin,
            strides,
            length,
            groups: Vec::new(),
            of_colour: Default::default(),
            terms: Vec::new(),
            inverse: Vec::new(),
            places: vec![Place { at: 0, group: 0, lane: 0 }; corners.len()],
            parents: coarser.iter().map(|corner| as_u32(flat(*corner))).collect(),
            load: [(); 3].map(|()| vec![0.0; COLOURS * length]),
            solution: [(); 3].map(|()| vec![0.0; COLOURS * length]),
            residual: [(); 3].map(|()| vec![0.0; COLOURS * length]),
            coarse: [(); 3].map(|()| vec![0.0; length]),
        };
        for (colour, own) in by_colour.iter().enumerate() {
            let begin = this.groups.len();
            for &(place, number) in own {
                if this.groups[begin..].last().is_none_or(|group| place >= group.first + LANES) {
                    let first = this.terms.len();
                    this.groups.push(Group { first: place, terms: first..first });
                    this.inverse.push([[0.0; LANES]; 9]);
                }
                let group = this.groups.len() - 1;
                let lane = place - this.groups[group].first;
                this.places[number] =
                    Place { at: as_u32(colour * length + place), group: as_u32(group), lane: as_u32(lane) };
                let near = |step: &usize| {
                    let there = [0, 1, 2]
                        .map(|axis| (corners[number][axis] as usize + step_component(*step, axis)).checked_sub(1));
                    let [Some(x), Some(y), Some(z)] = there.map(|at| at.map(as_u32)) else { return false };
                    find(corners, [x, y, z]).is_some()
                };
                for step in (0..STEPS).filter(|step| neighbour(colour, *step) < colour).filter(near) {
                    let known = this.groups[group].terms.clone();
                    if this.terms[known].iter().all(|term| term.step != step) {
                        let offset = this.offset(colour, step);
                        this.terms.push(Term { step, offset, blocks: [[0.0; LANES]; 9] });
                        this.groups[group].terms.end += 1;
                    }
                }
            }
            this.of_colour[colour] = begin..this.groups.len();
        }
        this
    }

    /// Returns the place of the neighbour of the corner at place 0 of a colour.
    fn offset(&self, colour: usize, step: usize) -> usize {
        let (mut ahead, mut back) = (neighbour(colour, step) * self.length, 0);
        for axis in 0..3 {
            match (step_component(step, axis), colour >> axis & 1) {
                // One less than an even corner is the odd one before, one more than an odd one the next even one.
                (0, 0) => back += self.strides[axis],
                (2, 1) => ahead += self.strides[axis],
                _ => {}
            }
        }
        ahead - back
    }

    /// Returns the memory of a corner, bytes: blocks if half of the places are empty, and vectors over `places` of the box.
    pub(super) const fn bytes_a_corner(places: usize) -> usize {
        let blocks = size_of::<[f32; 9]>() * (STEPS / 2) + size_of::<[f64; 9]>();
        2 * blocks + places * size_of::<[f64; 9]>() + size_of::<Place>()
    }

    /// Sets the block of the matrix in the row of one corner and the column of another, a `step` away from it, kg, and so
    /// also the mirrored block.
    pub(super) fn set(&mut self, [row, column]: [usize; 2], step: usize, block: &DMat3) {
        let colour = |number: usize| self.places[number].at as usize / self.length;
        if colour(row) > colour(column) {
            self.set_term(row, step, &block.transpose());
        } else {
            self.set_term(column, STEPS - 1 - step, block);
        }
    }

    /// Sets a block, given its transpose: the columns of the transpose are the rows that are stored.
    fn set_term(&mut self, row: usize, step: usize, transpose: &DMat3) {
        let Place { group, lane, .. } = self.places[row];
        let terms = self.groups[group as usize].terms.clone();
        if let Some(term) = self.terms[terms].iter_mut().find(|term| term.step == step) {
            for (lanes, value) in term.blocks.iter_mut().zip(transpose.to_cols_array()) {
                lanes[lane as usize] = f32::from_f64(value);
            }
        }
    }

    /// Sets the inverse of a corner's block on the diagonal, 1/kg.
    pub(super) fn set_inverse(&mut self, number: usize, inverse: &DMat3) {
        let Place { group, lane, .. } = self.places[number];
        for (lanes, value) in self.inverse[group as usize].iter_mut().zip(inverse.transpose().to_cols_array()) {
            lanes[lane as usize] = value;
        }
    }

    /// Sets the load of a corner.
    #[inline(always)]
    pub(super) fn set_load(&mut self, number: usize, load: DVec3) {
        let at = self.places[number].at as usize;
        for (of, value) in self.load.iter_mut().zip(load.to_array()) {
            of[at] = value;
        }
    }

    /// Returns the load of a corner.
    #[inline(always)]
    pub(super) fn load(&self, number: usize) -> DVec3 {
        self.at(&self.load, number)
    }

    /// Returns the solution at a corner.
    #[inline(always)]
    pub(super) fn solution(&self, number: usize) -> DVec3 {
        self.at(&self.solution, number)
    }

    /// Sets the solution at a corner.
    #[inline(always)]
    pub(super) fn set_solution(&mut self, number: usize, solution: DVec3) {
        let at = self.places[number].at as usize;
        for (of, value) in self.solution.iter_mut().zip(solution.to_array()) {
            of[at] = value;
        }
    }

    #[inline(always)]
    fn at(&self, of: &[Vec<f64>; 3], number: usize) -> DVec3 {
        let at = self.places[number].at as usize;
        let [x, y, z] = of;
        DVec3::new(x[at], y[at], z[at])
    }

    /// Relaxes all corners from a solution of zero, in the order of colours. What the later colours do to a corner remains
    /// as its residual.
    #[inline(always)]
    pub(super) fn sweep_forward(&mut self) {
        for of in self.solution.iter_mut().chain(&mut self.residual) {
            of.fill(0.0);
        }
        for colour in 0..COLOURS {
            let own = colour * self.length;
            let [load_x, load_y, load_z] = &self.load;
            let [x, y, z] = &mut self.solution;
            let ((x, own_x), (y, own_y), (z, own_z)) = (x.split_at_mut(own), y.split_at_mut(own), z.split_at_mut(own));
            let [left_x, left_y, left_z] = &mut self.residual;
            for number in self.of_colour[colour].clone() {
                let Group { first, terms } = &self.groups[number];
                let load = [&load_x[own..], &load_y[own..], &load_z[own..]];
                relax(
                    Relaxed {
                        first: *first,
                        terms: &self.terms[terms.clone()],
                        inverse: &self.inverse[number],
                        load: [lanes(load[0], *first), lanes(load[1], *first), lanes(load[2], *first)],
                        before: [x, y, z],
                    },
                    lanes_mut(own_x, *first),
                    lanes_mut(own_y, *first),
                    lanes_mut(own_z, *first),
                    left_x,
                    left_y,
                    left_z,
                );
            }
        }
    }

    /// Relaxes all corners against the order of colours. Uses up the load.
    #[inline(always)]
    pub(super) fn sweep_backward(&mut self) {
        for colour in (0..COLOURS).rev() {
            let own = colour * self.length;
            let [load_x, load_y, load_z] = &mut self.load;
            let ((left_x, load_x), (left_y, load_y), (left_z, load_z)) =
                (load_x.split_at_mut(own), load_y.split_at_mut(own), load_z.split_at_mut(own));
            let [x, y, z] = &mut self.solution;
            let ((x, own_x), (y, own_y), (z, own_z)) = (x.split_at_mut(own), y.split_at_mut(own), z.split_at_mut(own));
            for number in self.of_colour[colour].clone() {
                let Group { first, terms } = &self.groups[number];
                relax(
                    Relaxed {
                        first: *first,
                        terms: &self.terms[terms.clone()],
                        inverse: &self.inverse[number],
                        load: [lanes(load_x, *first), lanes(load_y, *first), lanes(load_z, *first)],
                        before: [x, y, z],
                    },
                    lanes_mut(own_x, *first),
                    lanes_mut(own_y, *first),
                    lanes_mut(own_z, *first),
                    left_x,
                    left_y,
                    left_z,
                );
            }
        }
    }

    /// Hands the residual after [`Self::sweep_forward`] on to the next coarser grid.
    #[inline(always)]
    pub(super) fn restrict(&mut self, coarser: &mut Self) {
        for (left, coarse) in self.residual.iter().zip(&mut self.coarse) {
            coarse.fill(0.0);
            let places = self.margin..self.length - self.margin - LANES;
            for Interpolation { colour, ahead, weight } in interpolations(self.strides) {
                let left = &left[colour * self.length..][places.start - ahead..];
                for (to, left) in coarse[places.clone()].iter_mut().zip(left) {
                    *to += *left * weight;
                }
            }
        }
        for (number, at) in self.parents.iter().enumerate() {
            let at = *at as usize;
            let [x, y, z] = &self.coarse;
            coarser.set_load(number, DVec3::new(x[at], y[at], z[at]));
        }
    }

    /// Adds the solution of the next coarser grid.
    #[inline(always)]
    pub(super) fn prolong(&mut self, coarser: &Self) {
        for (number, at) in self.parents.iter().enumerate() {
            for (coarse, value) in self.coarse.iter_mut().zip(coarser.solution(number).to_array()) {
                coarse[*at as usize] = value;
            }
        }
        for (coarse, solution) in self.coarse.iter().zip(&mut self.solution) {
            let places = self.margin..self.length - self.margin - LANES;
            for Interpolation { colour, ahead, weight } in interpolations(self.strides) {
                let solution = &mut solution[colour * self.length..][places.clone()];
                for (to, coarse) in solution.iter_mut().zip(&coarse[places.start + ahead..]) {
                    *to += *coarse * weight;
                }
            }
        }
    }
}

/// How corners of a colour are interpolated from those of the next coarser grid.
#[derive(Clone, Copy, Debug)]
struct Interpolation {
    colour: usize,
    /// How far the coarse corner's place is past the corner's.
    ahead: usize,
    weight: f64,
}

/// Returns all pairs of a corner's colour and a coarse corner: along each axis along which it is odd a corner lies between
/// two coarse ones.
fn interpolations(strides: [usize; 3]) -> impl Iterator<Item = Interpolation> {
    (0..COLOURS).flat_map(move |colour| {
        let weight = [1.0, 0.5, 0.25, 0.125][colour.count_ones() as usize];
        (0..COLOURS).filter(move |past| past & !colour == 0).map(move |past| {
            let ahead = (0..3).filter(|axis| past >> axis & 1 == 1).map(|axis| strides[axis]).sum();
            Interpolation { colour, ahead, weight }
        })
    })
}

/// Returns the colour of a corner: one bit each for x, y and z, 1 where odd.
fn colour_of(corner: [u32; 3]) -> usize {
    (0..3).map(|axis| (corner[axis] as usize & 1) << axis).sum()
}

/// Returns a component of a step, plus one.
fn step_component(step: usize, axis: usize) -> usize {
    step / [1, 3, 9][axis] % 3
}

/// Returns the colour of a corner's neighbour.
fn neighbour(colour: usize, step: usize) -> usize {
    (0..3).filter(|axis| step_component(step, *axis) != 1).fold(colour, |colour, axis| colour ^ 1 << axis)
}

fn as_u32(of: usize) -> u32 {
    u32::try_from(of).unwrap_or(u32::MAX)
}

#[inline(always)]
fn lanes(of: &[f64], first: usize) -> &Lanes {
    of[first..].first_chunk().expect("there is room for a group past the last corner")
}

#[inline(always)]
fn lanes_mut(of: &mut [f64], first: usize) -> &mut Lanes {
    of[first..].first_chunk_mut().expect("there is room for a group past the last corner")
}

/// A group of corners of one colour that is relaxed.
struct Relaxed<'a> {
    /// The place of the first.
    first: usize,
    /// The blocks that connect them with the earlier colours.
    terms: &'a [Term],
    /// The inverses of their own blocks.
    inverse: &'a LaneBlocks,
    load: [&'a Lanes; 3],
    /// The solution of the earlier colours.
    before: [&'a [f64]; 3],
}

/// Relaxes a group of corners: solves for them with their load and the solution of the earlier colours. Their effect on
/// those colours is subtracted from what is `left` there.
///
/// The outputs are separate arguments, or the loops are not vectorised.
#[inline(always)]
fn relax(
    Relaxed { first, terms, inverse, load, before: [before_x, before_y, before_z] }: Relaxed<'_>,
    x: &mut Lanes,
    y: &mut Lanes,
    z: &mut Lanes,
    left_x: &mut [f64],
    left_y: &mut [f64],
    left_z: &mut [f64],
) {
    let (mut sum_x, mut sum_y, mut sum_z) = (*load[0], *load[1], *load[2]);
    for Term { offset, blocks, .. } in terms {
        let at = offset + first;
        let by = [lanes(before_x, at), lanes(before_y, at), lanes(before_z, at)];
        take_products(blocks.each_ref(), by, &mut sum_x, &mut sum_y, &mut sum_z);
    }
    write_products(inverse, [&sum_x, &sum_y, &sum_z], x, y, z);
    for Term { offset, blocks, .. } in terms {
        let at = offset + first;
        let [xx, xy, xz, yx, yy, yz, zx, zy, zz] = blocks;
        take_products(
            [xx, yx, zx, xy, yy, zy, xz, yz, zz],
            [x, y, z],
            lanes_mut(left_x, at),
            lanes_mut(left_y, at),
            lanes_mut(left_z, at),
        );
    }
}

#[inline(always)]
#[expect(clippy::assign_op_pattern, reason = "as of the forces of links")]
fn take_products(
    [xx, xy, xz, yx, yy, yz, zx, zy, zz]: [&[f32; LANES]; 9],
    [x, y, z]: [&Lanes; 3],
    from_x: &mut Lanes,
    from_y: &mut Lanes,
    from_z: &mut Lanes,
) {
    for lane in 0..LANES {
        let (vx, vy, vz) = (x[lane], y[lane], z[lane]);
        from_x[lane] = from_x[lane] - (f64::from(xx[lane]) * vx + f64::from(xy[lane]) * vy + f64::from(xz[lane]) * vz);
        from_y[lane] = from_y[lane] - (f64::from(yx[lane]) * vx + f64::from(yy[lane]) * vy + f64::from(yz[lane]) * vz);
        from_z[lane] = from_z[lane] - (f64::from(zx[lane]) * vx + f64::from(zy[lane]) * vy + f64::from(zz[lane]) * vz);
    }
}

#[inline(always)]
fn write_products(
    [xx, xy, xz, yx, yy, yz, zx, zy, zz]: &LaneBlocks,
    [x, y, z]: [&Lanes; 3],
    to_x: &mut Lanes,
    to_y: &mut Lanes,
    to_z: &mut Lanes,
) {
    for lane in 0..LANES {
        let (vx, vy, vz) = (x[lane], y[lane], z[lane]);
        to_x[lane] = xx[lane] * vx + xy[lane] * vy + xz[lane] * vz;
        to_y[lane] = yx[lane] * vx + yy[lane] * vy + yz[lane] * vz;
        to_z[lane] = zx[lane] * vx + zy[lane] * vy + zz[lane] * vz;
    }
}

#[cfg(test)]
mod tests;
