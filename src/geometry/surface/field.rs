//! A lower bound of the distance to a surface, from a coarse grid of distances with a finer one near the surface. Most
//! points are so far away that no search is needed.

use glam::{DVec3, UVec3};

/// Cells along the longest extent.
const COARSE_CELLS: f64 = 16.0;
/// Cells along an edge of a coarse cell near the surface.
const FINE_CELLS: u32 = 4;
/// The largest rounding error of a distance kept in single precision, over the size of the surface.
const ROUNDING_ERROR: f64 = 1e-6;

/// The grid.
#[derive(Clone, Debug)]
pub(super) struct DistanceField {
    origin: DVec3,
    cell: f64,
    dims: UVec3,
    /// The distance from the middle of every cell, negative inside, and the index of its first finer cell.
    coarse: Vec<(f32, u32)>,
    /// The distance from the middle of every finer cell, and the triangle that is nearest to it.
    fine: Vec<(f32, u32)>,
}

/// What is known of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Bound {
    /// It is outside, at least that far.
    Outside(f64),
    /// It is inside.
    Inside,
    /// It is near the surface, on either side.
    Near {
        /// It is no farther than that.
        max_distance: f64,
        /// A triangle that is near.
        triangle: u32,
    },
}

impl DistanceField {
    /// Builds the grid of a surface in a box `±extent` about the origin. `distance` gives the signed distance of a point and
    /// the triangle nearest to it.
    #[expect(clippy::cast_possible_truncation, reason = "a few dozen cells, and what is lost is allowed for")]
    pub(super) fn new(extent: DVec3, distance: impl Fn(DVec3) -> (f64, u32)) -> Self {
        let cell = 2.0 * extent.max_element() / COARSE_CELLS;
        let dims = (extent * 2.0 / cell).ceil().max(DVec3::ONE).as_uvec3() + 2;
        let origin = dims.as_dvec3() * (-0.5 * cell);
        let mut field = Self { origin, cell, dims, coarse: Vec::new(), fine: Vec::new() };
        let reach = 0.5 * cell * 3.0_f64.sqrt();
        for z in 0..dims.z {
            for y in 0..dims.y {
                for x in 0..dims.x {
                    let corner = origin + UVec3::new(x, y, z).as_dvec3() * cell;
                    let (middle, _) = distance(corner + 0.5 * cell);
                    let first = if middle.abs() <= reach { field.fine.len() as u32 } else { u32::MAX };
                    field.coarse.push((middle as f32, first));
                    if first == u32::MAX {
                        continue;
                    }
                    let part = cell / f64::from(FINE_CELLS);
                    for number in 0..FINE_CELLS * FINE_CELLS * FINE_CELLS {
                        let place = UVec3::new(
                            number % FINE_CELLS,
                            number / FINE_CELLS % FINE_CELLS,
                            number / (FINE_CELLS * FINE_CELLS),
                        );
                        let (distance, triangle) = distance(corner + (place.as_dvec3() + 0.5) * part);
                        field.fine.push((distance as f32, triangle));
                    }
                }
            }
        }
        field
    }

    /// The bytes that it takes.
    pub(super) fn bytes(&self) -> usize {
        (self.coarse.capacity() + self.fine.capacity()) * size_of::<(f32, u32)>()
    }

    /// What is known of a point.
    pub(super) fn bound(&self, at: DVec3) -> Bound {
        let place = (at - self.origin) / self.cell;
        let size = self.dims.as_dvec3();
        if !(place.cmpge(DVec3::ZERO) & place.cmplt(size)).all() {
            let beyond = (-place).max(place - size).max(DVec3::ZERO);
            // The grid reaches a cell beyond the surface.
            return Bound::Outside(beyond.length() * self.cell);
        }
        let index = place.as_uvec3();
        let (middle, first) = self.coarse[(index.x + self.dims.x * (index.y + self.dims.y * index.z)) as usize];
        let within = place - place.floor();
        if first == u32::MAX {
            return Self::bound_from_sample(f64::from(middle), ((within - 0.5) * self.cell).length(), 0);
        }
        let part = (within * f64::from(FINE_CELLS)).as_uvec3().min(UVec3::splat(FINE_CELLS - 1));
        let (middle, triangle) = self.fine[(first + part.x + FINE_CELLS * (part.y + FINE_CELLS * part.z)) as usize];
        let from_middle = within - (part.as_dvec3() + 0.5) / f64::from(FINE_CELLS);
        Self::bound_from_sample(f64::from(middle), (from_middle * self.cell).length(), triangle)
    }

    /// Returns the bound of a point from the `distance` of a place that is `away` from it.
    fn bound_from_sample(distance: f64, away: f64, triangle: u32) -> Bound {
        let least = distance.abs() - away - ROUNDING_ERROR;
        if least <= 0.0 {
            Bound::Near { max_distance: distance.abs() + away + ROUNDING_ERROR, triangle }
        } else if distance > 0.0 {
            Bound::Outside(least)
        } else {
            Bound::Inside
        }
    }
}
