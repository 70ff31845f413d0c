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

use std::collections::BTreeMap;

use super::crossings::{Crossing, Crossings, spans};
use super::holes::Patched;
use super::pieces::{Divider, PIECE, takers};
use super::report::VoxelReport;
use super::shell::CHUNK;
use super::{Cells, Grid, OccupancyChoice, VoxelizeError};
use crate::geometry::places::Places;
use crate::geometry::{TriMesh, Watch};

/// How many samples the box of a model has at most, if its cells are no more.
const MOST_SAMPLES: f64 = 1.7e7;

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

/// The samples of thin open pieces are as rough as this.
const MOST_OFF_OF_LIDS: f64 = 0.3;

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
    /// What is in the cells that hold anything, in cells, in the order of [`Grid::index`].
    of_cell: Vec<(u32, f32)>,
    samples: usize,
    /// What all of it is for certain, in cells.
    known: Option<f64>,
}

impl Sampled {
    /// What was found, in cells.
    fn all(&self) -> f64 {
        self.of_cell.iter().map(|(_, share)| f64::from(*share)).sum()
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
        return Ok(share_out(&sheet()?, cells, true));
    }
    let sampled = inside(mesh, &cells.grid, report, watch)?;
    let found = sampled.all();
    if !report.closed {
        let in_air = sampled.of_cell.iter().filter(|(cell, _)| !cells.filled[*cell as usize]);
        let in_air = in_air.map(|(_, share)| f64::from(*share)).sum::<f64>() - report.dropped_cells as f64;
        let is_hollow = report.occupancy == OccupancyChoice::Solid && in_air > (1.0 - LEAST_HELD) * found;
        if found == 0.0 || is_hollow {
            return Ok(share_out(&sheet()?, cells, true));
        }
    }
    if let Some(known) = sampled.known.filter(|known| (found - known).abs() > MOST_OFF * known) {
        let on_surface = surface(mesh, &cells.grid, 1.0, watch)?;
        return Ok(share_out(&Sampled { known: Some(known), ..on_surface }, cells, true));
    }
    if found == 0.0 {
        return Ok(share_out(&sheet()?, cells, true));
    }
    Ok(share_out(&sampled, cells, false))
}

/// Samples the inside of a mesh that may have to be made whole to have one.
fn inside(mesh: &TriMesh, grid: &Grid, report: &VoxelReport, watch: &dyn Watch) -> Result<Sampled, VoxelizeError> {
    let parity = report.occupancy == OccupancyChoice::Centre;
    let volume = |mesh: &TriMesh| volume(mesh, grid, parity, watch);
    if report.closed {
        let as_it_is = volume(mesh)?;
        if as_it_is.known.is_some() {
            return Ok(as_it_is);
        }
    }
    let Some(Patched { whole, closed, lidded, .. }) = Patched::of(mesh) else {
        return Ok(Sampled { known: None, ..volume(mesh)? });
    };
    let all = volume(&whole)?;
    let Some(closed) = closed else {
        return Ok(all);
    };
    // What open pieces add to the others is known by samples; if they find about what lids would enclose, by that.
    let part = volume(&closed)?;
    let found = (all.all() - part.all()).max(0.0);
    let lidded = lidded / grid.cell_size.powi(3);
    let added = if (lidded - found).abs() <= MOST_OFF_OF_LIDS * lidded { lidded } else { found };
    let known = part.known.map(|known| known + added);
    Ok(Sampled { known, ..all })
}

/// Samples the inside. `parity` is as centre occupancy has it: what surfaces wind around an even number of times is out.
fn volume(mesh: &TriMesh, grid: &Grid, parity: bool, watch: &dyn Watch) -> Result<Sampled, VoxelizeError> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most 200")]
    let along = libm::cbrt(MOST_SAMPLES / grid.len() as f64).max(1.0) as u32;
    let ([along_x, along_y, along_z], fine) = Crossings::along_axes(mesh, grid, along, 1, watch)?;
    let along = fine.dims[0] / grid.dims[0];
    let [nx, ny, nz] = fine.dims;
    let mut seen = Seen { parity, leaks: false, ways: [false; 2], wound: 0, inside: 0 };
    // The rays along z stand side by side.
    let mut columns = vec![Column::default(); nx as usize * ny as usize];
    let cell_of: Vec<usize> = (0..nx.max(ny)).map(|step| (step / along) as usize).collect();
    let mut votes = vec![0_u8; columns.len()];
    let each = 1.0 / f64::from(along).powi(3);
    let mut of_cell = Vec::new();
    let mut of_layer = vec![0_u32; (grid.dims[0] * grid.dims[1]) as usize];
    let mut samples = 0;
    for k in 0..nz {
        across(&mut votes, [&along_x, &along_y], [nx, ny], k, &mut seen);
        let of_columns = (0..ny).flat_map(|j| (0..nx).map(move |i| [i, j]));
        for ((column, votes), [i, j]) in columns.iter_mut().zip(&votes).zip(of_columns) {
            if column.until == k {
                column.go_on(along_z.of_ray(i, j), nz, &mut seen);
            }
            if votes + column.of_each > 3 {
                of_layer[cell_of[i as usize] + cell_of[j as usize] * grid.dims[0] as usize] += 1;
                samples += 1;
            }
        }
        if (k + 1) % along == 0 {
            let layer = of_layer.len() * (k / along) as usize;
            for (at, count) in of_layer.iter_mut().enumerate().filter(|(_, count)| **count > 0) {
                #[expect(clippy::cast_possible_truncation, reason = "as precise as it is needed")]
                of_cell.push((number(layer + at), (f64::from(*count) * each) as f32));
                *count = 0;
            }
        }
    }
    // Where pieces lie in each other Gauss counts what is in both twice: the samples tell which share that is.
    let Seen { leaks, ways, wound, inside, .. } = seen;
    let is_alike = !(leaks || ways == [true; 2]);
    let once = if wound > 0 { inside as f64 / wound as f64 } else { 1.0 };
    let known = is_alike.then(|| enclosed(mesh, grid) * once);
    Ok(Sampled { of_cell, samples, known })
}

/// How many of the ways along x and y find each sample of a layer inside.
fn across(votes: &mut [u8], [along_x, along_y]: [&Crossings; 2], [nx, ny]: [u32; 2], k: u32, seen: &mut Seen) {
    for j in 0..ny {
        let row = &mut votes[(j * nx) as usize..][..nx as usize];
        let ray = along_x.of_ray(j, k);
        let total = total(ray);
        spans(ray, nx, |first, end, winding| {
            row[first as usize..end as usize].fill(seen.see(winding, total, end - first));
        });
    }
    for i in 0..nx {
        let ray = along_y.of_ray(k, i);
        let total = total(ray);
        spans(ray, ny, |first, end, winding| {
            let of_each = seen.see(winding, total, end - first);
            if of_each > 0 {
                (first..end).for_each(|j| votes[(j * nx + i) as usize] += of_each);
            }
        });
    }
}

/// A ray along z, as far as its samples were looked at.
#[derive(Clone, Copy, Default)]
struct Column {
    /// How many of its crossings are behind.
    crossed: u32,
    winding: i16,
    /// How many of the two ways along the ray find the samples inside, ...
    of_each: u8,
    /// ... up to this one.
    until: u32,
}

impl Column {
    /// Goes on from where the last samples ended, of so many.
    fn go_on(&mut self, ray: &[Crossing], samples: u32, seen: &mut Seen) {
        let from = self.until;
        while let Some(crossing) = ray.get(self.crossed as usize).filter(|crossing| u32::from(crossing.at) <= from) {
            self.winding = self.winding.wrapping_add(crossing.sign);
            self.crossed += 1;
        }
        self.until = ray.get(self.crossed as usize).map_or(samples, |crossing| u32::from(crossing.at).min(samples));
        self.of_each = seen.see(self.winding, total(ray), self.until - from);
    }
}

/// What rays saw of the samples on them.
struct Seen {
    parity: bool,
    /// A ray crosses more surfaces inwards than outwards, or fewer.
    leaks: bool,
    /// Surfaces wind around a sample the one way, and the other.
    ways: [bool; 2],
    /// How often around all samples along all axes, ...
    wound: u64,
    /// ... and how many of these are inside.
    inside: u64,
}

impl Seen {
    /// Of so many samples on a ray that crosses so many more surfaces inwards than outwards, with this many of them before the
    /// samples: how many of the two ways along the ray find them inside.
    fn see(&mut self, winding: i16, total: i16, samples: u32) -> u8 {
        let is_odd = |winding: i16| winding % 2 != 0;
        self.leaks |= total != 0;
        if winding != 0 {
            self.ways[usize::from(winding < 0)] = true;
            self.wound += u64::from(winding.unsigned_abs()) * u64::from(samples);
            self.inside += u64::from(!self.parity || is_odd(winding)) * u64::from(samples);
        }
        // A ray that does not come out as it went in passes a hole, or what is oriented as it comes.
        let is_in = |seen: i16| if self.parity || total != 0 { is_odd(seen) } else { seen != 0 };
        u8::from(is_in(winding)) + u8::from(is_in(winding.wrapping_sub(total)))
    }
}

fn total(ray: &[Crossing]) -> i16 {
    ray.iter().fold(0, |sum: i16, crossing| sum.wrapping_add(crossing.sign))
}

/// A place in the grid, of which there are fewer than 2³².
fn number(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(u32::MAX)
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
    let mut of_cell: BTreeMap<u32, f32> = BTreeMap::new();
    let (mut samples, mut all) = (0, 0.0);
    let mut divider = Divider::new(mesh, grid, PIECE);
    for triangle in 0..mesh.triangles.len() {
        if triangle % CHUNK == 0 && watch.cancelled() {
            return Err(VoxelizeError::Cancelled);
        }
        divider.pieces(triangle, |cell, area| {
            #[expect(clippy::cast_possible_truncation, reason = "as precise as it is needed")]
            let volume = (area * thickness) as f32;
            *of_cell.entry(number(grid.index(cell))).or_default() += volume;
            all += area * thickness;
            samples += 1;
        });
    }
    Ok(Sampled { of_cell: of_cell.into_iter().collect(), samples, known: Some(all) })
}

/// Gives filled cells what is in them and beside them, and none less than the least.
fn share_out(sampled: &Sampled, cells: &Cells, of_surface: bool) -> Contents {
    let (all, Sampled { of_cell, samples, known }) = (sampled.all(), sampled);
    let grid = cells.grid;
    let places = Places::new(cells.filled.clone());
    let mut of_filled = vec![0.0_f32; places.len()];
    for &(cell, share) in of_cell {
        if let Some(number) = places.number(cell as usize) {
            of_filled[number as usize] = share;
        }
    }
    let mut lost = 0.0;
    for &(cell, share) in of_cell.iter().filter(|(cell, _)| !cells.filled[*cell as usize]) {
        let takers = takers(&grid, grid.cell(cell as usize), |near| cells.filled[near]);
        match u8::try_from(takers.clone().count()).unwrap_or(u8::MAX) {
            0 => lost += f64::from(share),
            count => {
                let part = share / f32::from(count);
                takers.filter_map(|near| places.number(near)).for_each(|number| of_filled[number as usize] += part);
            }
        }
    }
    let mut shares: Vec<f64> = of_filled.into_iter().map(f64::from).collect();
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
    Contents { shares, of_surface, samples: *samples, raised, lost: if all > 0.0 { lost / all } else { 0.0 } }
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

#[cfg(test)]
mod tests;
