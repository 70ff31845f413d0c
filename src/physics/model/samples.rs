//! Points on the mesh that a body's cells were made of, which meet obstacles in place of its particles (C8).
//!
//! They follow from the lattice alone, and are constant: each is a mean of the eight particles of one cell, at most eight to a
//! cell ([`crate::geometry::sampling`]).

use std::ops::Range;

use crate::geometry::Lattice;
use crate::geometry::sampling::surface_samples;

/// The points of a body's mesh, by cell. Numbers of particles are local to the body.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::physics) struct Samples {
    /// The cells that carry any, ascending.
    pub(in crate::physics) cells: Vec<SampledCell>,
    /// The weights of the eight particles, of every point.
    pub(in crate::physics) weights: Vec<[f64; 8]>,
    /// The place among `cells` of the one that carries each point.
    pub(in crate::physics) cell_of: Vec<u32>,
}

/// A cell that carries points.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::physics) struct SampledCell {
    /// Its particles.
    pub(in crate::physics) carriers: [u32; 8],
    /// Its points.
    pub(in crate::physics) points: Range<usize>,
    /// How far its points may be from the middle of its box, as a share of half the box: the largest Σ |weight|, which is one
    /// where all are inside it.
    pub(in crate::physics) reach: f64,
}

impl Samples {
    /// Those of a lattice; none where it was made of no mesh, or nothing of that is near a cell.
    pub(in crate::physics) fn new(lattice: &Lattice) -> Option<Self> {
        let samples = surface_samples(lattice.mesh.as_ref()?, lattice);
        let (mut cells, mut cell_of, mut first) = (Vec::<SampledCell>::new(), Vec::with_capacity(samples.len()), 0);
        for of_cell in samples.chunk_by(|one, next| one.cell == next.cell) {
            let points = first..first + of_cell.len();
            first = points.end;
            let spread = |weights: &[f64; 8]| weights.iter().map(|weight| weight.abs()).sum::<f64>();
            let reach = of_cell.iter().map(|sample| spread(&sample.weights)).fold(1.0, f64::max);
            let carriers = lattice.cells[of_cell[0].cell as usize];
            cell_of.extend(of_cell.iter().map(|_| u32::try_from(cells.len()).unwrap_or(u32::MAX)));
            cells.push(SampledCell { carriers, points, reach });
        }
        let weights = samples.iter().map(|sample| sample.weights).collect();
        (!cells.is_empty()).then_some(Self { cells, weights, cell_of })
    }

    /// How many points there are.
    pub(in crate::physics) fn count(&self) -> usize {
        self.weights.len()
    }

    /// The particles that carry a point, and their weights.
    #[inline]
    pub(in crate::physics) fn point(&self, number: usize) -> (&[u32; 8], &[f64; 8]) {
        (&self.cells[self.cell_of[number] as usize].carriers, &self.weights[number])
    }
}
