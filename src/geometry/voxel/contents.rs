//! What is in every cell: near-uniform samples of a model's volume, or of its surface where it has no inside (J5, SC).
//!
//! The samples of the volume are the middles of a finer grid, a whole number of them along the edge of a cell. One is
//! inside where at least four of six rays from it, both ways along each axis, find it so by the surfaces that they cross:
//! within a closed mesh all six agree, and a hole misleads no more than those that leave through it. The samples of a surface are the middles of pieces of its
//! triangles, none longer than half a cell, each with its piece's area; a sheet is taken to be [`SHEET_SHARE`] of the
//! model's longest extent thick.
//!
//! Every sample falls into a cell. What falls into one that is not filled goes in equal parts to the filled cells that
//! share a face with it, else an edge, else a corner. The volume of closed pieces, and of those with small holes, is known
//! exactly (Gauss) if they face alike, and the samples only share it out; where pieces lie in each other they tell how much
//! of it is in several.

use holes::Patched;

use super::centre::crossings;
use super::pieces::{Divider, PIECE, area, takers};
use super::quantized_mesh::QuantizedMesh;
use super::report::VoxelReport;
use super::shell::CHUNK;
use super::{Cells, Grid, OccupancyChoice, VoxelizeError};
use crate::geometry::watch::{CancelOnly, Pieces};
use crate::geometry::{TriMesh, Watch};

/// How many samples of the volume there are along the longest extent, if the cells are no finer.
const SAMPLES_ALONG: u32 = 192;

/// Up to so many divisions a cell has at least two samples along an edge, beyond one.
const DIVISIONS_OF_TWO: u32 = 128;

/// The thickness of a sheet over the model's longest extent.
pub const SHEET_SHARE: f64 = 1.0 / 20.0;

/// No cell is taken to be less full than this: links of nearly nothing would bear nothing, and particles would be thrown
/// about by what they touch.
pub const LEAST_SHARE: f64 = 1.0 / 8.0;

/// No cell is taken to be less full than this share of the mean, where all are nearly empty.
const LEAST_OF_MEAN: f64 = 0.5;

/// A person is told of cells that hold less than the least where there are more, in percent.
const MANY_RAISED: f64 = 25.0;

/// An open mesh of whose inside the cells hold less is a sheet: the air gets in.
const LEAST_HELD: f64 = 0.8;

/// Samples that miss the known volume by more are too few: the model is thinner than they are apart.
const MOST_OFF: f64 = 0.2;

/// The most crossings of rays with the surface, along an axis.
const MOST_CROSSINGS: f64 = 1e8;

/// How full the cells of a model are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contents {
    /// Of every filled cell, in the order of [`Grid::index`], what is in it over its volume; above 1 where it holds what
    /// is beside it, and at least [`LEAST_SHARE`] but for sheets.
    pub shares: Vec<f64>,
    /// The samples are of the surface.
    pub of_surface: bool,
    /// Samples inside the model or on it.
    pub samples: usize,
    /// Cells that were less full than the least.
    pub raised: usize,
    /// The share of the samples' volume that is in no filled cell or beside one.
    pub lost: f64,
}

impl Contents {
    /// What a person should know, a sentence each.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if self.of_surface {
            warnings.push(format!(
                "the model has no inside to weigh: its surface is taken to be a sheet, {:.0} % of its longest extent thick",
                100.0 * SHEET_SHARE
            ));
        }
        let lost = 100.0 * self.lost;
        if lost >= 0.5 {
            warnings.push(format!("{lost:.0} % of the model is in no cell that was kept and weighs nothing"));
        }
        let raised = 100.0 * self.raised as f64 / self.shares.len().max(1) as f64;
        if raised >= MANY_RAISED {
            warnings.push(format!(
                "{raised:.0} % of the cells hold next to nothing and are taken to be {:.0} % full at the cost of the \
                 others; more divisions fit the model better",
                100.0 * LEAST_SHARE
            ));
        }
        warnings
    }

    /// What is in all cells, in cells.
    pub fn volume_cells(&self) -> f64 {
        self.shares.iter().sum()
    }
}

/// What was sampled, by cells of the grid.
struct Sampled {
    /// In cells.
    of_cell: Vec<f32>,
    samples: usize,
    /// What all of it is for certain, in cells.
    known: Option<f64>,
}

impl Sampled {
    /// What was found, in cells.
    fn all(&self) -> f64 {
        self.of_cell.iter().copied().map(f64::from).sum()
    }
}

/// Finds how full every cell of a mesh is; `report` is of its filling. The result does not depend on the number of
/// threads.
pub(super) fn contents(
    mesh: &TriMesh,
    cells: &Cells,
    report: &VoxelReport,
    watch: &dyn Watch,
) -> Result<Contents, VoxelizeError> {
    let mesh = &*mesh.without_duplicates();
    let sheet = || surface(mesh, &cells.grid, SHEET_SHARE * f64::from(report.divisions), watch);
    if report.occupancy == OccupancyChoice::Surface {
        return Ok(share_out(sheet()?, cells, true));
    }
    let sampled = inside(mesh, &cells.grid, report, watch)?;
    let found = sampled.all();
    if !report.closed {
        let in_air = sampled.of_cell.iter().zip(&cells.filled).filter(|&(_, &filled)| !filled);
        let in_air = in_air.map(|(share, _)| f64::from(*share)).sum::<f64>() - report.dropped_cells as f64;
        let is_hollow = report.occupancy == OccupancyChoice::Solid && in_air > (1.0 - LEAST_HELD) * found;
        if found == 0.0 || is_hollow {
            return Ok(share_out(sheet()?, cells, true));
        }
    }
    if let Some(known) = sampled.known.filter(|known| (found - known).abs() > MOST_OFF * known) {
        let on_surface = surface(mesh, &cells.grid, 1.0, watch)?;
        return Ok(share_out(Sampled { known: Some(known), ..on_surface }, cells, true));
    }
    if found == 0.0 {
        return Ok(share_out(sheet()?, cells, true));
    }
    Ok(share_out(sampled, cells, false))
}

/// Samples the inside of a mesh that may have to be made whole to have one.
fn inside(mesh: &TriMesh, grid: &Grid, report: &VoxelReport, watch: &dyn Watch) -> Result<Sampled, VoxelizeError> {
    let parity = report.occupancy == OccupancyChoice::Centre;
    let volume = |mesh: &TriMesh| volume(mesh, grid, report.divisions, parity, watch);
    if report.closed {
        let as_it_is = volume(mesh)?;
        if as_it_is.known.is_some() {
            return Ok(as_it_is);
        }
    }
    let Some(Patched { whole, closed }) = Patched::of(mesh) else {
        return Ok(Sampled { known: None, ..volume(mesh)? });
    };
    let all = volume(&whole)?;
    let Some(closed) = closed else {
        return Ok(all);
    };
    // What open pieces add to the others is known by samples alone.
    let part = volume(&closed)?;
    let known = part.known.map(|known| (known + all.all() - part.all()).max(0.0));
    Ok(Sampled { known, ..all })
}

/// Samples the inside. `parity` is as centre occupancy has it: what surfaces wind around an even number of times is out.
fn volume(
    mesh: &TriMesh,
    grid: &Grid,
    divisions: u32,
    parity: bool,
    watch: &dyn Watch,
) -> Result<Sampled, VoxelizeError> {
    let mut along = if divisions > DIVISIONS_OF_TWO { 1 } else { (SAMPLES_ALONG / divisions).max(2) };
    let area = area(mesh, grid);
    while along > 1 && area * f64::from(along).powi(2) > MOST_CROSSINGS {
        along /= 2;
    }
    let fine =
        Grid { cell_size: grid.cell_size / f64::from(along), dims: grid.dims.map(|n| n * along), origin: grid.origin };
    let mut quantized = QuantizedMesh::within(mesh, fine);
    let mut votes = vec![0_u8; fine.len()];
    // Surfaces that wind around everything the same way; how often around all samples along all axes, and how many are inside.
    let mut is_alike = true;
    let (mut way, mut wound, mut inside) = (0, 0_u64, 0_u64);
    for axis in 0..3 {
        if axis > 0 {
            for corner in quantized.triangles.iter_mut().flatten() {
                corner.rotate_left(1);
            }
        }
        let turned = |mut dims: [u32; 3]| {
            dims.rotate_left(axis);
            dims
        };
        let padded = Grid { dims: turned(quantized.padded.dims), ..quantized.padded };
        let pieces = quantized.triangles.len().div_ceil(CHUNK);
        let silent = CancelOnly(watch);
        let crossings = crossings(&quantized.triangles, &padded, &Pieces::new(&silent, pieces, [0.0, 1.0]))?;
        let dims = turned(fine.dims);
        let [nx, ny, _] = fine.dims.map(|n| n as usize);
        let mut strides = [1, nx, nx * ny];
        strides.rotate_left(axis);
        for (k, j) in (0..dims[2]).flat_map(|k| (0..dims[1]).map(move |j| (k, j))) {
            let row = padded.index([1, j + 1, k + 1]);
            let row = &crossings[row..=row + dims[0] as usize];
            let total = row.iter().fold(0_i16, |sum, crossing| sum.wrapping_add(*crossing));
            is_alike &= total == 0;
            let mut at = j as usize * strides[1] + k as usize * strides[2];
            let mut winding = 0_i16;
            for &crossing in &row[..dims[0] as usize] {
                winding = winding.wrapping_add(crossing);
                let is_odd = |winding: i16| winding % 2 != 0;
                if winding != 0 || total != 0 {
                    // A ray that does not come out as it went in passes a hole, or what is oriented as it comes.
                    let is_in = |seen: i16| if parity || total != 0 { is_odd(seen) } else { seen != 0 };
                    votes[at] += u8::from(is_in(winding)) + u8::from(is_in(winding.wrapping_sub(total)));
                }
                if winding != 0 {
                    is_alike &= way == 0 || way == winding.signum();
                    way = winding.signum();
                    wound += u64::from(winding.unsigned_abs());
                    inside += u64::from(!parity || is_odd(winding));
                }
                at += strides[0];
            }
        }
    }
    // At most 192: as exact in single precision.
    let each = 1.0 / f32::from(u8::try_from(along).unwrap_or(u8::MAX)).powi(3);
    let mut of_cell = vec![0.0; grid.len()];
    let mut samples = 0;
    for (cell, _) in fine.iter().zip(&votes).filter(|&(_, &votes)| votes > 3) {
        of_cell[grid.index(cell.map(|n| n / along))] += 1.0_f32;
        samples += 1;
    }
    for count in &mut of_cell {
        *count *= each;
    }
    // Where pieces lie in each other Gauss counts what is in both twice: the samples tell which share that is.
    let once = if wound > 0 { inside as f64 / wound as f64 } else { 1.0 };
    let known = is_alike.then(|| enclosed(mesh, grid) * once);
    Ok(Sampled { of_cell, samples, known })
}

/// The volume that a closed mesh encloses (Gauss), in cells.
fn enclosed(mesh: &TriMesh, grid: &Grid) -> f64 {
    let six = |triangle: usize| {
        let [a, b, c] = mesh.corners(triangle).map(|corner| (corner - grid.origin) / grid.cell_size);
        a.dot(b.cross(c))
    };
    ((0..mesh.triangles.len()).map(six).sum::<f64>() / 6.0).abs()
}

/// Samples the surface, `thickness` cells thick.
fn surface(mesh: &TriMesh, grid: &Grid, thickness: f64, watch: &dyn Watch) -> Result<Sampled, VoxelizeError> {
    let mut of_cell = vec![0.0_f32; grid.len()];
    let (mut samples, mut all) = (0, 0.0);
    let mut divider = Divider::new(mesh, grid, PIECE);
    for triangle in 0..mesh.triangles.len() {
        if triangle % CHUNK == 0 && watch.cancelled() {
            return Err(VoxelizeError::Cancelled);
        }
        divider.pieces(triangle, |cell, area| {
            #[expect(clippy::cast_possible_truncation, reason = "as precise as it is needed")]
            let volume = (area * thickness) as f32;
            of_cell[grid.index(cell)] += volume;
            all += area * thickness;
            samples += 1;
        });
    }
    Ok(Sampled { of_cell, samples, known: Some(all) })
}

/// Gives filled cells what is in them and beside them, and none less than the least.
fn share_out(sampled: Sampled, cells: &Cells, of_surface: bool) -> Contents {
    let all = sampled.all();
    let Sampled { mut of_cell, samples, known } = sampled;
    let grid = cells.grid;
    let mut lost = 0.0;
    for (cell, at) in grid.iter().zip(0..).filter(|&(_, at)| !cells.filled[at]) {
        if of_cell[at] == 0.0 {
            continue;
        }
        let takers = takers(&grid, cell, |near| cells.filled[near]);
        match u8::try_from(takers.clone().count()).unwrap_or(u8::MAX) {
            0 => lost += f64::from(of_cell[at]),
            count => {
                let part = of_cell[at] / f32::from(count);
                takers.for_each(|near| of_cell[near] += part);
            }
        }
    }
    let of_filled = of_cell.iter().zip(&cells.filled).filter(|&(_, &filled)| filled);
    let mut shares: Vec<f64> = of_filled.map(|(share, _)| f64::from(*share)).collect();
    let kept: f64 = shares.iter().sum();
    if kept == 0.0 {
        shares.fill(1.0);
    } else if let Some(known) = known {
        // What was dropped has its part of what is known.
        let exact = known * (1.0 - lost / all) / kept;
        for share in &mut shares {
            *share *= exact;
        }
    }
    let raised = raise(&mut shares);
    Contents { shares, of_surface, samples, raised, lost: if all > 0.0 { lost / all } else { 0.0 } }
}

/// Raises shares that are less than the least, and lowers the others in proportion: the sum stays. How many were raised.
fn raise(shares: &mut [f64]) -> usize {
    let all: f64 = shares.iter().sum();
    let least = LEAST_SHARE.min(LEAST_OF_MEAN * all / shares.len().max(1) as f64);
    let mut scale = 1.0;
    let mut raised = 0;
    loop {
        let (mut count, mut rest) = (0, 0.0);
        for &share in &*shares {
            if share * scale < least { count += 1 } else { rest += share }
        }
        if count == raised {
            break;
        }
        // Each round lowers the scale and so raises more, until none is below.
        raised = count;
        scale = if rest > 0.0 { (all - least * count as f64) / rest } else { 1.0 };
    }
    for share in &mut *shares {
        *share = if *share * scale < least { least } else { *share * scale };
    }
    raised
}

mod holes;
#[cfg(test)]
mod tests;
