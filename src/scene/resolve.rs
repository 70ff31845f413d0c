//! From a shape in the document to its lattice: cubes and lists of cells are built, models are read and filled. The only
//! place where a scene reads other files.

use std::path::Path;
use std::sync::Arc;

use glam::DVec3;
use thiserror::Error;

use super::body::{MassFrom, ModelShape, Shape};
use super::obstacle::Mesh;
use super::{Embedded, ObstacleShape, Scene, builtin, embedded};
use crate::geometry::import::{self, Detail, ImportError, Imported};
use crate::geometry::part_cells::Parts;
use crate::geometry::surface::SurfaceError;
use crate::geometry::voxel::{
    Cells, CellsError, Contents, Grid, VoxelReport, VoxelizeError, VoxelizeOptions, voxelize,
};
use crate::geometry::watch::{CancelOnly, Portion, Rising};
use crate::geometry::{Lattice, LatticeCounts, Paint, Shading, Surface, TriMesh, UpAxis, Watch};
use crate::text::{echo, listed};

/// The most particles of a body: its links alone then take more than a gigabyte.
pub const MAX_PARTICLES: usize = 8_000_000;

/// The shortest and longest a body may be, m: what single precision can move and a camera can see.
pub const MODEL_LENGTH_RANGE: [f64; 2] = [1e-4, 1e4];

/// A body's shape, ready to be given a material. Body coordinates: the origin is the middle of the grid's box.
#[derive(Clone, Debug)]
pub struct Jelly {
    /// Particles, links and cells.
    pub lattice: Arc<Lattice>,
    /// The model's own surface; none for cubes and lists of cells.
    pub mesh: Option<Arc<TriMesh>>,
    /// The colours and pictures of the model's own surface; none where its file gives none.
    pub paint: Option<Arc<Paint>>,
    /// Where the surface is smooth according to the model's file.
    pub shading: Option<Arc<Shading>>,
    /// How the model was filled, lengths in metres; none for cubes and lists of cells.
    pub report: Option<VoxelReport>,
    /// The axis of the model's file that points up, never `Auto`; y for cubes and lists of cells.
    pub up: UpAxis,
    /// What a person should know, a sentence each.
    pub warnings: Vec<String>,
    /// Warnings about the mass of a solid, a sentence each.
    pub mass_warnings: Vec<String>,
}

/// Why a shape gives no lattice.
#[derive(Debug, Error)]
pub enum ResolveError {
    /// The cells cannot be held.
    #[error(transparent)]
    Cells(#[from] CellsError),
    /// The model cannot be read.
    #[error(transparent)]
    Import(#[from] ImportError),
    /// The model cannot be filled.
    #[error("{model} cannot be filled with cells")]
    Voxelize {
        /// The model's path.
        model: String,
        /// Why.
        source: VoxelizeError,
    },
    /// The program carries no such model.
    #[error("the program carries no model {name}; it carries {}", builtin_names())]
    NoSuchBuiltin {
        /// The name asked for.
        name: String,
    },
    /// The scene holds no such model.
    #[error("the scene holds no model {name}; it holds {held}")]
    NoSuchEmbedded {
        /// The name asked for.
        name: String,
        /// What it holds, in words.
        held: String,
    },
    /// The model cannot be an obstacle.
    #[error("{model} cannot be an obstacle")]
    Surface {
        /// The model's path.
        model: String,
        /// Why.
        source: SurfaceError,
    },
    /// Too many particles to hold.
    #[error("the body would have {particles} particles, at most {MAX_PARTICLES} can be held; use fewer divisions")]
    TooManyParticles {
        /// How many it would have.
        particles: usize,
    },
    /// An obstacle too long or too short to simulate.
    #[error("{model}: the obstacle would be {length_m:e} m long; set its length to something from 0.0001 to 1000 m")]
    MeshLength {
        /// The model's path.
        model: String,
        /// The longest extent, m.
        length_m: f64,
    },
    /// Too long or too short to simulate.
    #[error("{model}: the body would be {length_m:e} m long; set its length to something from 0.0001 to 1000 m")]
    Length {
        /// The model's path.
        model: String,
        /// The longest extent, m.
        length_m: f64,
    },
}

impl ResolveError {
    /// The path, within the body, of the value that must change.
    pub fn path(&self) -> &'static str {
        match self {
            Self::Cells(_) => "shape",
            Self::Import(_)
            | Self::NoSuchBuiltin { .. }
            | Self::NoSuchEmbedded { .. }
            | Self::Voxelize { .. }
            | Self::Surface { .. } => "shape.model.path",
            Self::TooManyParticles { .. } => "shape.model.divisions",
            Self::Length { .. } | Self::MeshLength { .. } => "shape.model.length",
        }
    }
}

/// A shape as filled cells: what a body will be, before its particles and links take their memory.
#[derive(Clone, Debug)]
pub struct Filled {
    cells: Cells,
    contents: Option<Contents>,
    mesh: Option<Arc<TriMesh>>,
    paint: Option<Arc<Paint>>,
    shading: Option<Arc<Shading>>,
    parts: Option<Arc<Parts>>,
    report: Option<VoxelReport>,
    up: UpAxis,
    warnings: Vec<String>,
}

/// How large a body will be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outline {
    /// Particles, links and cells.
    pub counts: LatticeCounts,
    /// The box and the edge of a cell, m.
    pub grid: Grid,
    /// Vertices of the model's own surface.
    pub mesh_vertices: usize,
}

impl Filled {
    /// The box around the cells.
    pub fn grid(&self) -> &Grid {
        &self.cells.grid
    }

    /// The axis of the model's file that points up, never `Auto`.
    pub fn up(&self) -> UpAxis {
        self.up
    }

    /// How large the body will be.
    pub fn outline(&self) -> Outline {
        let mesh_vertices = self.mesh.as_ref().map_or(0, |mesh| mesh.positions.len());
        Outline { counts: LatticeCounts::of(&self.cells), grid: self.cells.grid, mesh_vertices }
    }

    /// Applies the cells that are added to and erased from a model by hand. An added cell is full.
    pub fn with_manual_changes(mut self, model: &ModelShape) -> Result<Self, ResolveError> {
        if model.erased.is_empty() && model.attached.is_empty() {
            return Ok(self);
        }
        let (cells, places) = self.cells.changed(&model.erased, &model.attached)?;
        let counts = LatticeCounts::of(&cells);
        if counts.particles > MAX_PARTICLES {
            return Err(ResolveError::TooManyParticles { particles: counts.particles });
        }
        if let Some(contents) = &mut self.contents {
            contents.shares = places.iter().map(|place| place.map_or(1.0, |place| contents.shares[place])).collect();
        }
        if let Some(report) = &mut self.report {
            (report.cells, report.particles, report.links) =
                (counts.cells, counts.particles, counts.links.iter().sum());
            report.dims = cells.grid.dims;
        }
        Ok(Self { cells, ..self })
    }

    /// Builds the lattice.
    pub fn build(self) -> Jelly {
        let Self { cells, contents, mesh, paint, shading, parts, report, up, warnings } = self;
        let mass_warnings = contents.as_ref().map(Contents::warnings).unwrap_or_default();
        let shares = contents.map(|contents| contents.shares);
        let lattice = Arc::new(Lattice { shares, mesh: mesh.clone(), parts, ..Lattice::new(&cells) });
        Jelly { lattice, mesh, paint, shading, report, up, warnings, mass_warnings }
    }
}

impl Jelly {
    /// How large the body is.
    pub fn outline(&self) -> Outline {
        let mesh_vertices = self.mesh.as_ref().map_or(0, |mesh| mesh.positions.len());
        Outline { counts: self.lattice.counts(), grid: self.lattice.grid, mesh_vertices }
    }
}

/// Where to find the models of a scene. A folder alone is enough for a scene that holds no model files itself.
#[derive(Clone, Copy, Debug)]
pub struct ModelPlaces<'a> {
    /// The folder that relative paths start at.
    pub base_dir: &'a Path,
    /// The model files within the scene.
    pub embedded: Option<&'a Embedded>,
}

impl<'a> From<&'a Path> for ModelPlaces<'a> {
    fn from(base_dir: &'a Path) -> Self {
        Self { base_dir, embedded: None }
    }
}

impl Scene {
    /// Returns the places of its models; relative paths start at `base_dir`.
    pub fn model_places<'a>(&'a self, base_dir: &'a Path) -> ModelPlaces<'a> {
        ModelPlaces { base_dir, embedded: Some(&self.models) }
    }
}

/// Builds the lattice of a shape.
pub fn resolve<'a>(
    shape: &Shape,
    places: impl Into<ModelPlaces<'a>>,
    watch: &dyn Watch,
) -> Result<Jelly, ResolveError> {
    fill(shape, places, watch).map(Filled::build)
}

/// Fills a shape with cells.
pub fn fill<'a>(shape: &Shape, places: impl Into<ModelPlaces<'a>>, watch: &dyn Watch) -> Result<Filled, ResolveError> {
    let cells = match shape {
        Shape::Cube(cube) => Cells::cube(cube.cells, cube.size / f64::from(cube.cells.max(1)))?,
        Shape::Cells(cells) => Cells::from_list(&cells.list, cells.size)?,
        Shape::Model(model) => return fill_model(model, places.into(), watch)?.with_manual_changes(model),
    };
    Ok(Filled {
        cells,
        contents: None,
        mesh: None,
        paint: None,
        shading: None,
        parts: None,
        report: None,
        up: UpAxis::Y,
        warnings: Vec::new(),
    })
}

/// The share of reading in the progress of making a model ready.
pub(crate) const READ_PROGRESS: f64 = 0.4;

/// The most names listed in an error about a wrong one.
pub(super) const MAX_NAMES_LISTED: usize = 12;

/// Reads a model: a file, one within the scene or one that the program carries.
pub fn load_model<'a>(
    path: &str,
    places: impl Into<ModelPlaces<'a>>,
    detail: Detail,
    watch: &dyn Watch,
) -> Result<Imported, ResolveError> {
    let ModelPlaces { base_dir, embedded } = places.into();
    if let Some(name) = path.strip_prefix(embedded::PREFIX) {
        let none = Embedded::default();
        let held = embedded.unwrap_or(&none);
        if held.find(name).is_none() {
            return Err(ResolveError::NoSuchEmbedded { name: echo(name), held: embedded_names(held) });
        }
        return Ok(import::load_held(held, name, detail, watch)?);
    }
    match path.strip_prefix(builtin::PREFIX) {
        Some(name) => {
            let bytes = builtin::model(name).ok_or_else(|| ResolveError::NoSuchBuiltin { name: name.to_owned() })?;
            Ok(import::parse_obj(bytes, path)?)
        }
        None => Ok(import::load_watched(&base_dir.join(path), detail, watch)?),
    }
}

/// Why the model of an obstacle cannot be used.
#[derive(Debug, Error)]
#[error("obstacles.{obstacle}: its model cannot be met")]
pub struct MeshError {
    /// The obstacle's place, from 0.
    pub obstacle: usize,
    /// Why.
    pub source: ResolveError,
}

/// Reads the models of all obstacles that have not been read. Relative paths start at `base_dir`.
///
/// # Errors
/// The first model that cannot be read or used.
pub fn load_meshes(scene: &mut Scene, base_dir: &Path, watch: &dyn Watch) -> Result<(), MeshError> {
    let models = scene.models.clone();
    let places = ModelPlaces { base_dir, embedded: Some(&models) };
    for place in 0..scene.obstacles.len() {
        let (known, rest) = scene.obstacles.split_at_mut(place);
        let Some(ObstacleShape::Mesh(mesh)) = rest.first_mut().map(|obstacle| &mut obstacle.shape) else { continue };
        if mesh.surface().is_some() {
            continue;
        }
        let twin = known.iter().find_map(|obstacle| match &obstacle.shape {
            ObstacleShape::Mesh(twin) if twin.path == mesh.path && twin.up == mesh.up => twin.surface(),
            _ => None,
        });
        let surface = match twin {
            Some(surface) => surface,
            None => load_surface(mesh, places, watch).map_err(|source| MeshError { obstacle: place, source })?,
        };
        mesh.load(surface);
    }
    Ok(())
}

/// Reads the model of an obstacle.
fn load_surface(mesh: &Mesh, places: ModelPlaces<'_>, watch: &dyn Watch) -> Result<Arc<Surface>, ResolveError> {
    let mut model = load_model(&mesh.path, places, Detail::Form, &CancelOnly(watch))?.mesh;
    mesh.up.found(&model).turn(&mut model);
    let surface = Surface::new(&model).map_err(|source| ResolveError::Surface { model: mesh.path.clone(), source })?;
    let length_m = mesh.scale(&surface);
    if !(MODEL_LENGTH_RANGE[0]..=MODEL_LENGTH_RANGE[1]).contains(&length_m) {
        return Err(ResolveError::MeshLength { model: mesh.path.clone(), length_m });
    }
    Ok(Arc::new(surface))
}

fn fill_model(model: &ModelShape, places: ModelPlaces<'_>, watch: &dyn Watch) -> Result<Filled, ResolveError> {
    let rising = Rising::new(watch);
    let imported = load_model(&model.path, places, Detail::Pictures, &Portion::new(&rising, [0.0, READ_PROGRESS]))?;
    let watch = &Portion::new(&rising, [READ_PROGRESS, 1.0]);
    let Imported { mut mesh, parts, paint, shading, mut warnings } = imported;
    let up = model.up.found(&mesh);
    up.turn(&mut mesh);
    if up != model.up && up != UpAxis::Y {
        warnings
            .push("z is taken for up: the model stands only that way; choose y to leave it as its file has it".into());
    }
    let options = VoxelizeOptions { divisions: model.divisions, occupancy: model.occupancy, keep: model.keep };
    let named = |source| ResolveError::Voxelize { model: model.path.clone(), source };
    let mut filled = voxelize(&mesh, &options, watch).map_err(named)?;
    if filled.report.particles > MAX_PARTICLES {
        return Err(ResolveError::TooManyParticles { particles: filled.report.particles });
    }
    let contents = match model.mass_from {
        MassFrom::Cells => None,
        MassFrom::Samples => Some(filled.sample(&mesh, watch).map_err(named)?),
    };
    let (mut cells, mut report) = (filled.cells, filled.report);
    let Grid { origin, cell_size, dims } = cells.grid;
    let own_length = mesh.bounds().size().max_element();
    let length_m = if model.length > 0.0 { model.length } else { own_length };
    if !(MODEL_LENGTH_RANGE[0]..=MODEL_LENGTH_RANGE[1]).contains(&length_m) {
        return Err(ResolveError::Length { model: model.path.clone(), length_m });
    }
    let scale = length_m / own_length;
    let middle = origin + DVec3::from_array(dims.map(f64::from)) * (0.5 * cell_size);
    for position in &mut mesh.positions {
        *position = (*position - middle) * scale;
    }
    cells.grid = Grid::centred(dims, cell_size * scale);
    report.cell_size_m = cells.grid.cell_size;
    report.volume_m3 *= scale.powi(3);
    warnings.extend(report.warnings.iter().cloned());
    let parts = parts.map(|names| Arc::new(Parts::new(names)));
    Ok(Filled {
        cells,
        contents,
        mesh: Some(Arc::new(mesh)),
        paint: paint.map(Arc::new),
        shading: shading.map(Arc::new),
        parts,
        report: Some(report),
        up,
        warnings,
    })
}

/// Lists the model files within a scene, at most [`MAX_NAMES_LISTED`] by name.
fn embedded_names(held: &Embedded) -> String {
    let names = held.files().iter().map(|file| echo(&file.path));
    if names.len() == 0 { "none".to_owned() } else { listed(names, MAX_NAMES_LISTED) }
}

fn builtin_names() -> String {
    builtin::MODELS.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::body::CellsShape;
    use crate::scene::{Shape, presets};

    fn jelly(shape: &Shape) -> Jelly {
        resolve(shape, Path::new("."), &()).expect("a sound shape")
    }

    #[test]
    fn cubes_and_cells_are_centred_on_the_origin() {
        let cube = jelly(&Shape::default());
        assert_eq!(cube.lattice.corners.len(), 1000, "9 cells an edge are 10 particles an edge");
        assert!((cube.lattice.grid.origin - DVec3::splat(-0.5)).length() < 1e-12, "half a metre on every side");
        let two = jelly(&Shape::Cells(CellsShape { list: vec![[0, 0, 0], [1, 0, 0]], size: 0.5 }));
        assert_eq!(two.lattice.corners.len(), 12, "two cells share four particles");
    }

    #[test]
    fn a_model_is_scaled_and_centred_together_with_its_cells() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("slab.obj");
        let slab = "v 10 0 0\nv 30 0 0\nv 30 5 0\nv 10 5 0\nf 1 2 3 4\n";
        std::fs::write(&path, slab).expect("a file");
        let shape = ModelShape { path: "slab.obj".into(), divisions: 4, length: 2.0, ..ModelShape::default() };
        let body = resolve(&Shape::Model(shape.clone()), folder.path(), &()).expect("a flat model");
        let bounds = body.mesh.expect("a model has a mesh").bounds();
        assert!((bounds.size().x - 2.0).abs() < 1e-12, "as long as asked: {bounds:?}");
        assert!((body.lattice.grid.cell_size - 0.5).abs() < 1e-12, "a quarter of it");
        let grid = body.lattice.grid;
        let far_corner = grid.corner(grid.dims);
        assert!((far_corner + grid.origin).length() < 1e-12, "the middle of the box is the origin");
        assert!(bounds.center().x.abs() < 1e-12, "the mesh moved with it");
        let own = ModelShape { length: 0.0, ..shape };
        let body = resolve(&Shape::Model(own), folder.path(), &()).expect("a flat model");
        assert!((body.lattice.grid.cell_size - 5.0).abs() < 1e-12, "0 keeps the file's size");
    }

    #[test]
    fn a_model_with_z_up_stands_and_old_files_mean_y() {
        let folder = tempfile::tempdir().expect("a folder");
        let pyramid = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 2 2 3\nf 1 4 3 2\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";
        std::fs::write(folder.path().join("pyramid.obj"), pyramid).expect("a file");
        let tip = |up: &str| {
            let text = format!("(version: 1, bodies: [(shape: model(path: \"pyramid.obj\"{up}))])");
            let scene = crate::scene::Scene::from_ron(&text, "a.ron").expect("a scene");
            let jelly = resolve(&scene.bodies[0].shape, folder.path(), &()).expect("a pyramid");
            let tip = jelly.mesh.expect("a mesh").positions[4];
            (tip.to_array().map(|at| format!("{:.1}", at + 1e-9)), jelly.up, jelly.warnings)
        };
        let at = |place: [&str; 3]| place.map(str::to_owned);
        let (standing, lying) = (at(["0.0", "0.4", "0.0"]), at(["0.0", "0.0", "0.4"]));
        assert_eq!(tip(""), (lying, UpAxis::Y, Vec::new()), "as it was read before there was a choice");
        assert_eq!(tip(", up: z"), (standing.clone(), UpAxis::Z, Vec::new()), "as asked for");
        let (place, up, warnings) = tip(", up: auto");
        assert_eq!((place, up), (standing, UpAxis::Z), "guessed");
        assert!(warnings[0].contains("z is taken for up"), "and said: {warnings:?}");
        assert_eq!(tip(", up: minus_z").0, at(["0.0", "-0.4", "0.0"]), "upside down");
    }

    #[test]
    fn every_preset_resolves() {
        for preset in presets::presets() {
            for body in (preset.build)().bodies {
                let jelly = jelly(&body.shape);
                assert!(!jelly.lattice.corners.is_empty(), "{}", preset.name);
            }
        }
    }

    #[test]
    fn what_cannot_be_resolved_is_a_sentence() {
        let model =
            |path: &str, length| Shape::Model(ModelShape { path: path.into(), length, ..ModelShape::default() });
        let message = |shape: &Shape| resolve(shape, Path::new("/nowhere"), &()).expect_err("refused").to_string();
        assert!(message(&model("builtin:none.obj", 1.0)).contains("spot.obj"), "the carried ones are listed");
        assert!(message(&model("none.obj", 1.0)).contains("/nowhere/none.obj does not exist"), "the full path");
        let far = Shape::Cells(CellsShape { list: vec![[-1000; 3], [1000; 3]], size: 1.0 });
        assert!(message(&far).contains("at most"), "too large a box");
    }
}
