//! `gelatin voxelize`: fills a model with cells and says what came of it.

use std::ffi::OsString;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, anyhow};
use clap::{Args, ValueEnum};
use serde_json::json;

use super::Failure;
use super::named_parts;
use super::out::{self, Progress};
use super::scene_args::up_axis;
use crate::geometry::UpAxis;
use crate::geometry::import::{self, Detail, FORMATS, Imported};
use crate::geometry::part_cells::{PartCells, PartCount};
use crate::geometry::voxel::{Cells, Keep, MAX_DIVISIONS, OccupancyChoice, VoxelReport, VoxelizeOptions, voxelize};
use crate::geometry::watch::{Portion, Rising};
use crate::scene::MaterialValue;
use crate::scene::resolve::{self, MODEL_LENGTH_RANGE, READ_PROGRESS};
use crate::text::{counted, echo_path};
use crate::view::legend::three_digits;

/// The model and how it is filled.
#[derive(Debug, Args)]
pub(super) struct VoxelizeArgs {
    /// The model file; `gelatin --help` lists the formats.
    model: OsString,
    /// Cells along the longest extent.
    #[arg(long, default_value_t = 20, allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_DIVISIONS)))]
    divisions: u32,
    /// Which cells are filled.
    #[arg(long, value_enum, default_value_t = Occupancy::Auto)]
    occupancy: Occupancy,
    /// Which connected pieces of the cells are kept.
    #[arg(long, value_enum, default_value_t = KeepWord::All)]
    keep: KeepWord,
    /// The axis of the model that points up: y, z, x, -y, -z, -x, or auto, which is z where it stands only that
    /// way and y otherwise.
    #[arg(long, value_name = "AXIS", default_value = "auto", allow_hyphen_values = true, value_parser = up_axis)]
    up: UpAxis,
    /// The longest extent of the body, m, which the lengths of the report are for; 0 keeps the model's own.
    #[arg(long, value_name = "M", default_value_t = 1.0, allow_negative_numbers = true, value_parser = length)]
    length: f64,
    /// What the mass comes from: samples of the model, or cells that are all full.
    #[arg(long, value_enum, default_value_t = MassWord::Samples)]
    mass_from: MassWord,
    /// The density that the mass of the report is for, kg/m³.
    #[arg(long, value_name = "KG/M3", default_value_t = 1000.0, allow_negative_numbers = true, value_parser = density)]
    density: f64,
    /// Write the outer faces of the cells to an OBJ file, in the model's own coordinates.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// Parses a length: that of a body, or 0.
fn length(text: &str) -> Result<f64, String> {
    let [least, most] = MODEL_LENGTH_RANGE;
    match text.parse::<f64>() {
        Ok(length) if length == 0.0 || (least..=most).contains(&length) => Ok(length),
        _ => Err(format!("a length from {least:e} to {most:e} m is needed, or 0")),
    }
}

/// Parses a density that a material may have.
fn density(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(density)
            if density.is_finite() && MaterialValue::Density.in_range(density).to_bits() == density.to_bits() =>
        {
            Ok(density)
        }
        _ => {
            let [least, most] = [0.0, f64::MAX].map(|end| MaterialValue::Density.in_range(end));
            Err(format!("a density from {least:e} to {most:e} kg/m³ is needed"))
        }
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum MassWord {
    Cells,
    Samples,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Occupancy {
    Auto,
    Centre,
    Surface,
    Solid,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum KeepWord {
    All,
    Largest,
}

/// Refuses a file whose name promises another format than the one that is written.
fn check_names_obj(path: &Path) -> Result<(), Failure> {
    match path.extension() {
        Some(extension) if !extension.eq_ignore_ascii_case("obj") => {
            let (shown, right) = (echo_path(path), echo_path(&path.with_extension("obj")));
            Err(Failure::usage(anyhow!("{shown} would be an OBJ file; call it {right}")))
        }
        _ => Ok(()),
    }
}

/// Fills the model and prints the report.
pub(super) fn run(args: &VoxelizeArgs) -> Result<(), Failure> {
    if let Some(path) = &args.output {
        out::check_writable(path)?;
        out::check_spares(path, &import::files_of(Path::new(&args.model)))?;
        check_names_obj(path)?;
    }
    if args.model.is_empty() {
        return Err(Failure::usage(anyhow!("no model is named; give the path of a model file ({FORMATS})")));
    }
    let shown = echo_path(Path::new(&args.model));
    let model = args.model.to_str().with_context(|| format!("{shown}: the name is not UTF-8; rename the file"))?;
    let options = VoxelizeOptions {
        divisions: args.divisions,
        occupancy: match args.occupancy {
            Occupancy::Auto => OccupancyChoice::Auto,
            Occupancy::Centre => OccupancyChoice::Centre,
            Occupancy::Surface => OccupancyChoice::Surface,
            Occupancy::Solid => OccupancyChoice::Solid,
        },
        keep: match args.keep {
            KeepWord::All => Keep::All,
            KeepWord::Largest => Keep::Largest,
        },
    };
    let started = Instant::now();
    let progress = Progress::new("filling");
    let rising = Rising::new(&progress);
    let reading = Portion::new(&rising, [0.0, READ_PROGRESS]);
    let mut imported = resolve::load_model(model, Path::new(""), Detail::Form, &reading)?;
    let filling = Portion::new(&rising, [READ_PROGRESS, 1.0]);
    let up = args.up.found(&imported.mesh);
    up.turn(&mut imported.mesh);
    let mut filled = voxelize(&imported.mesh, &options, &filling).with_context(|| shown.clone())?;
    if let MassWord::Samples = args.mass_from {
        let contents = filled.sample(&imported.mesh, &filling).with_context(|| shown.clone())?;
        filled.report.warnings.extend(contents.warnings());
    }
    let parts = part_counts(&imported, &filled.cells);
    drop(progress);
    let wall_secs = started.elapsed().as_secs_f64();
    if let Some(path) = &args.output {
        out::write(path, outer_faces(&filled.cells, up).as_bytes())?;
    }
    let mut report = filled.report;
    let own_length = imported.mesh.bounds().size().max_element();
    let length_m = if args.length > 0.0 { args.length } else { own_length };
    report.cell_size_m *= length_m / own_length;
    report.volume_m3 *= (length_m / own_length).powi(3);
    let mass_kg = args.density * report.volume_m3;
    report.warnings.splice(0..0, imported.warnings);
    if args.json {
        let mut object = serde_json::to_value(&report)?;
        object["model"] = json!(shown);
        object["up"] = json!(up);
        object["length_m"] = json!(length_m);
        object["mass_kg"] = json!(mass_kg);
        object["named_parts"] = json!(parts);
        object["wall_secs"] = json!(wall_secs);
        out::json(&object)?;
    } else {
        out::figures(&text(&shown, &report, up, length_m, wall_secs))?;
        out::figures(&mass_text(&report, args.density, mass_kg))?;
        named_parts::print(&shown, &parts)?;
        for warning in &report.warnings {
            out::note(&format!("warning: {warning}"));
        }
    }
    Ok(())
}

/// The parts that the file names, and how many cells each has.
fn part_counts(imported: &Imported, cells: &Cells) -> Vec<PartCount> {
    let Some(names) = &imported.parts else { return Vec::new() };
    let grid = &cells.grid;
    let filled: Vec<[u32; 3]> = cells.iter().collect();
    PartCells::new(&imported.mesh, names, grid, &filled).counts(names)
}

fn text(model: &str, report: &VoxelReport, up: UpAxis, length_m: f64, wall_secs: f64) -> String {
    let closed = if report.closed { "closed" } else { "open" };
    let occupancy = format!("{:?}", report.occupancy).to_lowercase();
    format!(
        "{model}: {}, {}, {closed} ({}), {}, {} up\n\
         {occupancy} occupancy: {}\n\
         {} of {} m, cells of {} m → {}, {}, {}\n\
         {}, {} dropped, {} joined, {} thinner than a cell\n\
         {wall_secs:.3} s",
        counted(report.vertices, "vertex", "vertices"),
        counted(report.triangles, "triangle", "triangles"),
        counted(report.boundary_edges, "boundary edge", "boundary edges"),
        counted(report.parts, "part", "parts"),
        up.name().replace('_', " "),
        report.why,
        counted(report.divisions, "division", "divisions"),
        three_digits(length_m),
        three_digits(report.cell_size_m),
        counted(report.cells, "cell", "cells"),
        counted(report.particles, "particle", "particles"),
        counted(report.links, "link", "links"),
        counted(report.components, "component", "components"),
        counted(report.dropped_cells, "cell", "cells"),
        counted(report.joined_parts, "part", "parts"),
        counted(report.thin_parts, "part", "parts"),
    )
}

fn mass_text(report: &VoxelReport, density: f64, mass_kg: f64) -> String {
    let what = match report.samples {
        0 => "all cells are full".to_owned(),
        samples => format!("{samples} samples, {} nearly empty", counted(report.raised_cells, "cell", "cells")),
    };
    let [volume, mass, density] = [report.volume_m3, mass_kg, density].map(three_digits);
    format!("{volume} m³ ({what}): {mass} kg at {density} kg/m³")
}

/// Writes the faces between filled and empty cells as an OBJ file: quads, counter-clockwise from outside, with shared
/// corners, in the orientation that the model had before `up` was turned upward.
fn outer_faces(cells: &Cells, up: UpAxis) -> String {
    /// The corners of the face towards −x; the other faces follow by turning the axes cyclically.
    const LOW: [[u32; 3]; 4] = [[0, 0, 0], [0, 0, 1], [0, 1, 1], [0, 1, 0]];
    let grid = cells.grid;
    let [nx, ny, _] = grid.dims.map(|n| n as usize + 1);
    let mut names = vec![0_u32; grid.dims.iter().map(|&n| n as usize + 1).product()];
    let (mut vertices, mut faces, mut count) = (String::new(), String::new(), 0);
    for cell in cells.iter() {
        for (axis, high) in (0..3).flat_map(|axis| [(axis, 0), (axis, 1)]) {
            let mut next = cell;
            next[axis] = if high == 1 { cell[axis] + 1 } else { cell[axis].wrapping_sub(1) };
            if next[axis] < grid.dims[axis] && cells.is_filled(next) {
                continue;
            }
            let mut face = LOW.map(|mut corner| {
                corner[0] += high;
                corner.rotate_right(axis);
                let corner = [0, 1, 2].map(|axis| cell[axis] + corner[axis]);
                let name = &mut names[corner[0] as usize + nx * (corner[1] as usize + ny * corner[2] as usize)];
                if *name == 0 {
                    count += 1;
                    *name = count;
                    let p = up.turned_back(grid.corner(corner));
                    // Writing to a string cannot fail.
                    let _ = writeln!(vertices, "v {} {} {}", p.x, p.y, p.z);
                }
                *name
            });
            if high == 1 {
                face.reverse();
            }
            let _ = writeln!(faces, "f {} {} {} {}", face[0], face[1], face[2], face[3]);
        }
    }
    format!("# The outer faces of {} cells, written by gelatin.\n{vertices}{faces}", cells.count())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::import::parse_obj;

    #[test]
    fn the_outer_faces_close_around_the_volume_of_the_cells() {
        let cells = Cells::from_list(&[[0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 1, 1]], 0.5).expect("four cells");
        let mesh = parse_obj(outer_faces(&cells, UpAxis::X).as_bytes(), "cells.obj").expect("an OBJ file").mesh;
        assert!(mesh.facts().closed, "no hole");
        let six_volumes: f64 =
            (0..mesh.triangles.len()).map(|at| mesh.corners(at)).map(|[a, b, c]| a.dot(b.cross(c))).sum();
        assert!((six_volumes / 6.0 - 0.5).abs() < 1e-12, "four times an eighth, facing outward: {six_volumes}");
    }
}
