//! Points on the mesh that a body's cells were made from, which meet obstacles and other bodies in place of its
//! particles, and the mesh itself, out of which points of other bodies are pushed.
//!
//! They follow from the lattice alone, and are constant. Each point is a mean of the eight particles of one cell; a cell has
//! at most eight points ([`crate::geometry::sampling`]).

use std::ops::Range;

use glam::DVec3;

use super::skin::Skin;
use crate::geometry::Lattice;
use crate::geometry::sampling::{SurfaceSample, surface_samples};

/// The least weight of a point inside its cell: zero but for rounding errors.
const MIN_WEIGHT: f64 = -1e-3;

/// The points of a body's mesh, by cell. Numbers of particles are local to the body.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::physics) struct Samples {
    /// The cells that carry points, ascending.
    pub(in crate::physics) cells: Vec<SampledCell>,
    /// The weights of the eight particles, by point.
    pub(in crate::physics) weights: Vec<[f64; 8]>,
    /// The place in `cells` of the cell that carries each point.
    pub(in crate::physics) cell_of: Vec<u32>,
    /// Whether other bodies may meet them.
    pub(in crate::physics) meet_bodies: bool,
    /// The mesh, where other bodies may meet the points and the mesh has an inside.
    pub(in crate::physics) skin: Option<Skin>,
    /// The normal of that mesh at every point of the body at rest; empty where there is no such mesh.
    normals: Vec<DVec3>,
}

/// A cell that carries points.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::physics) struct SampledCell {
    /// Its particles.
    pub(in crate::physics) carriers: [u32; 8],
    /// Its points.
    pub(in crate::physics) points: Range<usize>,
    /// How far its points may be from the middle of its box, as a share of half the box: the largest Σ |weight| of a point,
    /// 1 where all points are inside it.
    pub(in crate::physics) reach: f64,
}

impl Samples {
    /// The points of a lattice, with the mesh itself if other bodies may meet it; none where the lattice was not made from a
    /// mesh, or no part of the mesh is near a cell.
    pub(in crate::physics) fn new(lattice: &Lattice, meet_bodies: bool) -> Option<Self> {
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
        let skin = if meet_bodies { Skin::of(lattice) } else { None };
        let normal = |(skin, sample): (&Skin, &SurfaceSample)| {
            let corners = lattice.cells[sample.cell as usize].map(|p| lattice.grid.corner(lattice.corners[p as usize]));
            let weighed = corners.iter().zip(sample.weights);
            skin.normal(weighed.fold(DVec3::ZERO, |sum, (corner, weight)| sum + *corner * weight))
        };
        let normals =
            skin.iter().flat_map(|skin| samples.iter().map(move |sample| (skin, sample))).map(normal).collect();
        let weights = samples.iter().map(|sample| sample.weights).collect();
        (!cells.is_empty()).then_some(Self { cells, weights, cell_of, meet_bodies, skin, normals })
    }

    /// Whether a point is inside the cell that carries it, and so between the cell's particles however these move. A point
    /// outside its cell meets no other body.
    pub(in crate::physics) fn is_in_its_cell(&self, number: usize) -> bool {
        self.weights[number].iter().all(|weight| *weight >= MIN_WEIGHT)
    }

    /// The normal of the mesh at a point, of a body at rest; none where the mesh has no inside.
    pub(in crate::physics) fn normal(&self, number: usize) -> Option<DVec3> {
        self.normals.get(number).copied()
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
