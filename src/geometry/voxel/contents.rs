//! Finds how full every cell is by near-uniform samples of a model's volume, or of its surface if it has no inside (SC).
//!
//! Volume samples are the centres of a finer grid, a whole number of them along the edge of a cell. A sample is inside if at
//! least four of six rays from it, both ways along each axis, find it inside by the surfaces that they cross. Within a
//! closed mesh all six agree; a hole misleads only the rays that leave through it. Surface samples are the centres of pieces
//! of the triangles, none longer than half a cell, each with its piece's area. A sheet is taken to be [`SHEET_SHARE`] of the
//! model's longest extent thick.
//!
//! Every sample falls into a cell. The contents of an empty cell go in equal parts to the filled cells that share a face
//! with it, else an edge, else a corner. The volume of closed pieces, and of those with small holes, is known exactly
//! (Gauss) if their triangles face alike; the samples then only distribute it. If pieces overlap, the samples tell how much
//! of the volume is in several of them.

use std::collections::BTreeMap;

use super::crossings::{Crossing, Crossings, winding_spans};
use super::holes::Patched;
use super::pieces::{Divider, MAX_SAMPLE_EDGE, receiving_cells};
use super::report::VoxelReport;
use super::shell::CHUNK_TRIANGLES;
use super::{Cells, Grid, OccupancyChoice, VoxelizeError};
use crate::geometry::places::Places;
use crate::geometry::{TriMesh, Watch};

/// The most samples in a model's bounding box, unless it has more cells than that.
const MAX_SAMPLES: f64 = 1.7e7;

/// The thickness of a sheet, as a share of the model's longest extent.
pub const SHEET_SHARE: f64 = 1.0 / 20.0;

/// Every filled cell counts as at least this full: links of almost no material would bear nothing, and particles of almost
/// no mass would be thrown about by contacts.
pub const MIN_CELL_SHARE: f64 = 1.0 / 8.0;

/// If all cells are nearly empty, each counts as at least this share of their mean instead.
const MIN_SHARE_OF_MEAN: f64 = 0.5;

/// The percentage of cells emptier than the least from which a warning is given.
const RAISED_WARNING_PERCENT: f64 = 25.0;

/// An open mesh counts as a sheet if its cells hold less than this share of its inside: the air gets in.
const MIN_SHARE_IN_CELLS: f64 = 0.8;

/// If the samples miss the known volume by more than this share, they are too few: the model is thinner than their spacing.
const MAX_VOLUME_ERROR: f64 = 0.2;

/// The largest error of the samples of thin open pieces, as a share of the volume under flat lids.
const MAX_LIDDED_VOLUME_ERROR: f64 = 0.3;

/// How full the cells of a model are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contents {
    /// The volume in every filled cell over the cell's own, in the order of [`Grid::index`]. It is above 1 where the cell
    /// also holds what is beside it, and at least [`MIN_CELL_SHARE`] except for sheets.
    pub shares: Vec<f64>,
    /// Whether the samples are of the surface.
    pub of_surface: bool,
    /// Samples inside the model or on it.
    pub samples: usize,
    /// Cells that were less full than the least.
    pub raised: usize,
    /// The share of the sampled volume that lies neither in a filled cell nor beside one.
    pub lost: f64,
}

impl Contents {
    /// Returns warnings for the user, a sentence each.
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
        if raised >= RAISED_WARNING_PERCENT {
            warnings.push(format!(
                "{raised:.0} % of the cells hold next to nothing and are taken to be {:.0} % full at the cost of the \
                 others; more divisions fit the model better",
                100.0 * MIN_CELL_SHARE
            ));
        }
        warnings
    }

    /// Returns the volume in all cells, in cells.
    pub fn volume_cells(&self) -> f64 {
        self.shares.iter().sum()
    }
}

/// Sampled volume by cell of the grid.
struct SampledVolume {
    /// The index of each cell with samples and the volume in it, in cells, in the order of [`Grid::index`].
    of_cell: Vec<(u32, f32)>,
    samples: usize,
    /// The exact volume of all cells together, if known, in cells.
    known_volume: Option<f64>,
}

impl SampledVolume {
    /// Returns the sampled volume of all cells together, in cells.
    fn sampled_volume(&self) -> f64 {
        self.of_cell.iter().map(|(_, share)| f64::from(*share)).sum()
    }
}

/// Finds how full every cell of a mesh is; `report` is the one of its voxelization. The result does not depend on the number
/// of threads.
pub(super) fn contents(
    mesh: &TriMesh,
    cells: &Cells,
    report: &VoxelReport,
    watch: &dyn Watch,
) -> Result<Contents, VoxelizeError> {
    let mesh = &*mesh.without_duplicates();
    let sheet = || sample_surface(mesh, &cells.grid, SHEET_SHARE * f64::from(report.divisions), watch);
    if report.occupancy == OccupancyChoice::Surface {
        return Ok(distribute(&sheet()?, cells, true));
    }
    let sampled = sample_inside(mesh, &cells.grid, report, watch)?;
    let found = sampled.sampled_volume();
    if !report.closed {
        let in_air = sampled.of_cell.iter().filter(|(cell, _)| !cells.filled[*cell as usize]);
        let in_air = in_air.map(|(_, share)| f64::from(*share)).sum::<f64>() - report.dropped_cells as f64;
        let is_hollow = report.occupancy == OccupancyChoice::Solid && in_air > (1.0 - MIN_SHARE_IN_CELLS) * found;
        if found == 0.0 || is_hollow {
            return Ok(distribute(&sheet()?, cells, true));
        }
    }
    if let Some(known_volume) =
        sampled.known_volume.filter(|known_volume| (found - known_volume).abs() > MAX_VOLUME_ERROR * known_volume)
    {
        let on_surface = sample_surface(mesh, &cells.grid, 1.0, watch)?;
        return Ok(distribute(&SampledVolume { known_volume: Some(known_volume), ..on_surface }, cells, true));
    }
    if found == 0.0 {
        return Ok(distribute(&sheet()?, cells, true));
    }
    Ok(distribute(&sampled, cells, false))
}

/// Samples the inside of a mesh; its small holes are closed first if its volume is not known exactly without that.
fn sample_inside(
    mesh: &TriMesh,
    grid: &Grid,
    report: &VoxelReport,
    watch: &dyn Watch,
) -> Result<SampledVolume, VoxelizeError> {
    let parity = report.occupancy == OccupancyChoice::Centre;
    let sample = |mesh: &TriMesh| sample_volume(mesh, grid, parity, watch);
    if report.closed {
        let as_it_is = sample(mesh)?;
        if as_it_is.known_volume.is_some() {
            return Ok(as_it_is);
        }
    }
    let Some(Patched { whole, closed, lidded_volume, .. }) = Patched::of(mesh) else {
        return Ok(SampledVolume { known_volume: None, ..sample(mesh)? });
    };
    let all = sample(&whole)?;
    let Some(closed) = closed else {
        return Ok(all);
    };
    // Open pieces add a volume known only by samples; if it is close to the volume under flat lids, that one is used.
    let part = sample(&closed)?;
    let found = (all.sampled_volume() - part.sampled_volume()).max(0.0);
    let lidded_volume = lidded_volume / grid.cell_size.powi(3);
    let added =
        if (lidded_volume - found).abs() <= MAX_LIDDED_VOLUME_ERROR * lidded_volume { lidded_volume } else { found };
    let known_volume = part.known_volume.map(|known_volume| known_volume + added);
    Ok(SampledVolume { known_volume, ..all })
}

/// Samples the inside. With `parity`, as in centre occupancy, a sample with an even winding number is outside.
fn sample_volume(mesh: &TriMesh, grid: &Grid, parity: bool, watch: &dyn Watch) -> Result<SampledVolume, VoxelizeError> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most 200")]
    let samples_per_edge = libm::cbrt(MAX_SAMPLES / grid.len() as f64).max(1.0) as u32;
    let ([along_x, along_y, along_z], fine) = Crossings::along_axes(mesh, grid, samples_per_edge, 1, watch)?;
    let samples_per_edge = fine.dims[0] / grid.dims[0];
    let [nx, ny, nz] = fine.dims;
    let mut summary =
        WindingSummary { parity, leaks: false, winding_signs: [false; 2], winding_sum: 0, inside_samples: 0 };
    // A column for every ray along z.
    let mut columns = vec![Column::default(); nx as usize * ny as usize];
    let cell_of: Vec<usize> = (0..nx.max(ny)).map(|step| (step / samples_per_edge) as usize).collect();
    let mut votes = vec![0_u8; columns.len()];
    let volume_per_sample = 1.0 / f64::from(samples_per_edge).powi(3);
    let mut of_cell = Vec::new();
    let mut of_layer = vec![0_u32; (grid.dims[0] * grid.dims[1]) as usize];
    let mut samples = 0;
    for k in 0..nz {
        count_layer_votes(&mut votes, [&along_x, &along_y], [nx, ny], k, &mut summary);
        let of_columns = (0..ny).flat_map(|j| (0..nx).map(move |i| [i, j]));
        for ((column, votes), [i, j]) in columns.iter_mut().zip(&votes).zip(of_columns) {
            if column.span_end == k {
                column.advance(along_z.of_ray(i, j), nz, &mut summary);
            }
            if votes + column.votes > 3 {
                of_layer[cell_of[i as usize] + cell_of[j as usize] * grid.dims[0] as usize] += 1;
                samples += 1;
            }
        }
        if (k + 1) % samples_per_edge == 0 {
            let layer = of_layer.len() * (k / samples_per_edge) as usize;
            for (at, count) in of_layer.iter_mut().enumerate().filter(|(_, count)| **count > 0) {
                #[expect(clippy::cast_possible_truncation, reason = "as precise as it is needed")]
                of_cell.push((index_as_u32(layer + at), (f64::from(*count) * volume_per_sample) as f32));
                *count = 0;
            }
        }
    }
    // Gauss counts the overlap of pieces twice; the samples tell the share of the volume that counts once.
    let WindingSummary { leaks, winding_signs, winding_sum, inside_samples, .. } = summary;
    let is_alike = !(leaks || winding_signs == [true; 2]);
    let once = if winding_sum > 0 { inside_samples as f64 / winding_sum as f64 } else { 1.0 };
    let known_volume = is_alike.then(|| enclosed_volume(mesh, grid) * once);
    Ok(SampledVolume { of_cell, samples, known_volume })
}

/// Counts, for each sample of a layer, the ways along x and y that find it inside.
fn count_layer_votes(
    votes: &mut [u8],
    [along_x, along_y]: [&Crossings; 2],
    [nx, ny]: [u32; 2],
    k: u32,
    summary: &mut WindingSummary,
) {
    for j in 0..ny {
        let row = &mut votes[(j * nx) as usize..][..nx as usize];
        let ray = along_x.of_ray(j, k);
        let total = total_winding(ray);
        winding_spans(ray, nx, |first, end, winding| {
            row[first as usize..end as usize].fill(summary.add_samples(winding, total, end - first));
        });
    }
    for i in 0..nx {
        let ray = along_y.of_ray(k, i);
        let total = total_winding(ray);
        winding_spans(ray, ny, |first, end, winding| {
            let ray_votes = summary.add_samples(winding, total, end - first);
            if ray_votes > 0 {
                (first..end).for_each(|j| votes[(j * nx + i) as usize] += ray_votes);
            }
        });
    }
}

/// A ray along z and how far it has been followed.
#[derive(Clone, Copy, Default)]
struct Column {
    /// Crossings already passed.
    crossed: u32,
    winding: i16,
    /// How many of the two ways along the ray find the current samples inside.
    votes: u8,
    /// The first sample after the current ones.
    span_end: u32,
}

impl Column {
    /// Follows the ray from the last samples to its next crossing, or to its end at `samples`.
    fn advance(&mut self, ray: &[Crossing], samples: u32, summary: &mut WindingSummary) {
        let from = self.span_end;
        while let Some(crossing) = ray.get(self.crossed as usize).filter(|crossing| u32::from(crossing.cell) <= from) {
            self.winding = self.winding.wrapping_add(crossing.winding_change);
            self.crossed += 1;
        }
        self.span_end =
            ray.get(self.crossed as usize).map_or(samples, |crossing| u32::from(crossing.cell).min(samples));
        self.votes = summary.add_samples(self.winding, total_winding(ray), self.span_end - from);
    }
}

/// What the rays found about all samples.
struct WindingSummary {
    parity: bool,
    /// Some ray crosses more surfaces inwards than outwards, or fewer.
    leaks: bool,
    /// Surfaces wind around some sample one way, and around some sample the other way.
    winding_signs: [bool; 2],
    /// The winding numbers without signs, summed over all samples along all axes.
    winding_sum: u64,
    /// The samples inside, summed along all axes.
    inside_samples: u64,
}

impl WindingSummary {
    /// Records consecutive samples of a ray and returns how many of the two ways along the ray find them inside. `winding`
    /// is the number of surfaces entered less those left before the samples, `total` the same along the whole ray.
    fn add_samples(&mut self, winding: i16, total: i16, samples: u32) -> u8 {
        let is_odd = |winding: i16| winding % 2 != 0;
        self.leaks |= total != 0;
        if winding != 0 {
            self.winding_signs[usize::from(winding < 0)] = true;
            self.winding_sum += u64::from(winding.unsigned_abs()) * u64::from(samples);
            self.inside_samples += u64::from(!self.parity || is_odd(winding)) * u64::from(samples);
        }
        // If surfaces entered and left differ in number, the ray passes a hole or inconsistent triangles: parity decides.
        let is_in = |seen: i16| if self.parity || total != 0 { is_odd(seen) } else { seen != 0 };
        u8::from(is_in(winding)) + u8::from(is_in(winding.wrapping_sub(total)))
    }
}

fn total_winding(ray: &[Crossing]) -> i16 {
    ray.iter().fold(0, |sum: i16, crossing| sum.wrapping_add(crossing.winding_change))
}

/// Returns a grid index as `u32`; a grid has fewer than 2³² cells.
fn index_as_u32(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(u32::MAX)
}

/// The volume that a closed mesh encloses (Gauss), in cells.
fn enclosed_volume(mesh: &TriMesh, grid: &Grid) -> f64 {
    let six = |triangle: usize| {
        let [a, b, c] = mesh.corners(triangle).map(|corner| (corner - grid.origin) / grid.cell_size);
        a.dot(b.cross(c))
    };
    ((0..mesh.triangles.len()).map(six).sum::<f64>() / 6.0).abs()
}

/// Samples the surface as a sheet that is `thickness` cells thick.
fn sample_surface(
    mesh: &TriMesh,
    grid: &Grid,
    thickness: f64,
    watch: &dyn Watch,
) -> Result<SampledVolume, VoxelizeError> {
    let mut of_cell: BTreeMap<u32, f32> = BTreeMap::new();
    let (mut samples, mut all) = (0, 0.0);
    let mut divider = Divider::new(mesh, grid, MAX_SAMPLE_EDGE);
    for triangle in 0..mesh.triangles.len() {
        if triangle % CHUNK_TRIANGLES == 0 && watch.cancelled() {
            return Err(VoxelizeError::Cancelled);
        }
        divider.pieces(triangle, |cell, area| {
            #[expect(clippy::cast_possible_truncation, reason = "as precise as it is needed")]
            let volume = (area * thickness) as f32;
            *of_cell.entry(index_as_u32(grid.index(cell))).or_default() += volume;
            all += area * thickness;
            samples += 1;
        });
    }
    Ok(SampledVolume { of_cell: of_cell.into_iter().collect(), samples, known_volume: Some(all) })
}

/// Gives every filled cell the volume in it and beside it, and raises cells that are emptier than the least.
fn distribute(sampled: &SampledVolume, cells: &Cells, of_surface: bool) -> Contents {
    let (all, SampledVolume { of_cell, samples, known_volume }) = (sampled.sampled_volume(), sampled);
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
        let receiving_cells = receiving_cells(&grid, grid.cell(cell as usize), |near| cells.filled[near]);
        match u8::try_from(receiving_cells.clone().count()).unwrap_or(u8::MAX) {
            0 => lost += f64::from(share),
            count => {
                let part = share / f32::from(count);
                receiving_cells
                    .filter_map(|near| places.number(near))
                    .for_each(|number| of_filled[number as usize] += part);
            }
        }
    }
    let mut shares: Vec<f64> = of_filled.into_iter().map(f64::from).collect();
    let kept: f64 = shares.iter().sum();
    if kept == 0.0 {
        shares.fill(1.0);
    } else if let Some(known_volume) = known_volume {
        // The lost samples keep their share of the known volume.
        let exact = known_volume * (1.0 - lost / all) / kept;
        for share in &mut shares {
            *share *= exact;
        }
    }
    let raised = raise_shares(&mut shares);
    Contents { shares, of_surface, samples: *samples, raised, lost: if all > 0.0 { lost / all } else { 0.0 } }
}

/// Raises shares below the least and lowers the others in proportion: the sum stays. Returns how many were raised.
fn raise_shares(shares: &mut [f64]) -> usize {
    let all: f64 = shares.iter().sum();
    let least = MIN_CELL_SHARE.min(MIN_SHARE_OF_MEAN * all / shares.len().max(1) as f64);
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
