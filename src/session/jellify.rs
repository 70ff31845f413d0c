//! A model made into a body before anyone decides to use it: what it will be, how fast it will run, and the body
//! itself, so that nothing is computed twice. Works on the caller's thread; reports and stops through [`Progress`].

use std::path::PathBuf;
use std::sync::Arc;

use glam::DVec3;
use thiserror::Error;

use super::document::Opened;
use super::predict::Prediction;
use super::progress::Progress;
use super::{Command, Document, Session, SessionError, ShapeCache, memory};
use crate::extract::model_picture::ModelPicture;
use crate::geometry::voxel::{LostDetail, OccupancyChoice, VoxelReport, VoxelizeError};
use crate::geometry::watch::Portion;
use crate::geometry::{TriMesh, Watch};
use crate::scene::body::{Body, ModelShape, Pose, Shape, UpAxis};
use crate::scene::edit::BodyId;
use crate::scene::embedded::Embedded;
use crate::scene::param::{self, Problem};
use crate::scene::placement::{Look, Surroundings};
use crate::scene::resolve::{Jelly, ModelPlaces, ResolveError, fill};
use crate::scene::view_settings::CameraSettings;
use crate::scene::{MovesBy, Scene, Settings, presets};

/// The progress of the work once the model is read and filled with cells.
const FILLED_PROGRESS: f64 = 0.7;
/// The progress once the detail that is lost in the cells is found.
const DETAIL_CHECKED_PROGRESS: f64 = 0.85;
/// A body is let fall from this height, as a share of its longest extent.
const DROP_HEIGHT_SHARE: f64 = 0.4;

/// Why a model gives no body.
#[derive(Debug, Error)]
pub enum JellifyError {
    /// It was asked to stop.
    #[error("cancelled")]
    Cancelled,
    /// The model cannot be read or filled.
    #[error(transparent)]
    Resolve(ResolveError),
    /// The body would have values that no scene may have.
    #[error("{0}")]
    Value(Problem),
    /// The body cannot be simulated.
    #[error(transparent)]
    Session(#[from] SessionError),
}

/// What a model is to become.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted {
    /// The model and how it is filled.
    pub model: ModelShape,
    /// The body that gets the model; none makes a new one.
    pub body: Option<Box<Body>>,
    /// The settings that it is to run under.
    pub settings: Settings,
    /// The folder that relative paths start at.
    pub base_dir: PathBuf,
    /// The model files within the scene.
    pub held: Embedded,
}

impl Wanted {
    /// A new body of a model by its absolute path.
    pub fn new(model: ModelShape, settings: Settings) -> Self {
        Self { model, body: None, settings, base_dir: PathBuf::new(), held: Embedded::default() }
    }
}

/// A model made into a body, ready to be added.
#[derive(Clone, Debug)]
pub struct Jellified {
    /// The body: a new one at the place it falls from in an empty scene, an existing one at its start.
    pub body: Body,
    /// Its shape, made ready.
    pub jelly: Jelly,
    /// What a person should know before deciding.
    pub preview: Preview,
    /// The model in its cells.
    pub picture: Arc<ModelPicture>,
}

/// What a body made from a model will be.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Preview {
    /// Triangles of the model.
    pub triangles: usize,
    /// Whether its surface is closed.
    pub closed: bool,
    /// Connected pieces of the model.
    pub parts: usize,
    /// Pieces of the model that cells join to another.
    pub joined_parts: usize,
    /// Pieces of the model thinner than a cell.
    pub thin_parts: usize,
    /// The share of its surface behind which it is thinner than a cell.
    pub thin_share: f64,
    /// The share of its surface that moves as one with something else.
    pub joined_share: f64,
    /// The axis of the model's file that points up.
    pub up: UpAxis,
    /// Whether that axis was guessed.
    pub up_guessed: bool,
    /// Which cells are filled, in a word, and why.
    pub occupancy: [String; 2],
    /// Filled cells.
    pub cells: usize,
    /// Cells that were not kept.
    pub dropped_cells: usize,
    /// Groups of cells that share no particle, before some were dropped.
    pub components: usize,
    /// Particles.
    pub particles: usize,
    /// Links.
    pub links: usize,
    /// What it weighs, kg.
    pub mass_kg: f64,
    /// The memory that it needs by itself, without a window, bytes.
    pub memory_bytes: u64,
    /// The edge of a cell, m.
    pub cell_size_m: f64,
    /// The body's box, m.
    pub size_m: [f64; 3],
    /// The largest step that is safe, s; infinite without a limit.
    pub dt_safe_secs: f64,
    /// What limits it, in plain words.
    pub dt_limited_by: String,
    /// Simulated seconds per second of this machine's processor time, for the body alone on the ground; none where it explodes.
    pub speed_alone: Option<f64>,
    /// What a person should know, a sentence each.
    pub warnings: Vec<String>,
}

/// Makes a model into a body and predicts how it runs.
pub fn jellify(wanted: &Wanted, progress: &Progress) -> Result<Jellified, JellifyError> {
    let Wanted { settings, base_dir, held, .. } = wanted;
    let existing = wanted.body.as_ref().map(|body| body.with_model(wanted.model.clone()));
    let model = match existing.as_ref().map(|body| &body.shape) {
        Some(Shape::Model(model)) => model,
        _ => &wanted.model,
    };
    let places = ModelPlaces { base_dir, embedded: Some(held) };
    let cancelled = |_: VoxelizeError| JellifyError::Cancelled;
    let check_cancelled = || if progress.is_cancelled() { Err(JellifyError::Cancelled) } else { Ok(()) };
    let filled = fill(&Shape::Model(model.clone()), places, &Portion::new(progress, [0.0, FILLED_PROGRESS])).map_err(
        |error| match error {
            ResolveError::Voxelize { source: VoxelizeError::Cancelled, .. } => JellifyError::Cancelled,
            error => JellifyError::Resolve(error),
        },
    )?;
    check_cancelled()?;
    // The axis that was guessed is kept: a scene file names it.
    let model = ModelShape { up: filled.up(), ..model.clone() };
    let grid = *filled.grid();
    let size_m = grid.dims.map(|n| f64::from(n) * grid.cell_size);
    let longest = size_m.into_iter().fold(0.0, f64::max);
    let new = |shape: ModelShape| Body {
        name: name_of(&shape.path),
        shape: Shape::Model(shape),
        pose: Pose { position: [0.0, 0.5 * size_m[1] + DROP_HEIGHT_SHARE * longest, 0.0], ..Pose::default() },
        material: presets::jelly(grid.cell_size),
        ..Body::default()
    };
    let body = match existing {
        Some(body) => Body { shape: Shape::Model(model), ..body },
        None => new(model),
    };
    let mut scene = Scene { bodies: vec![body.clone()], settings: settings.clone(), ..presets::ground_only() };
    scene.models = held.clone();
    if let Some(problem) = param::validate(&scene).into_iter().next() {
        return Err(JellifyError::Value(problem));
    }
    memory::check_memory(&scene, &[filled.outline()])?;
    let jelly = filled.build();
    let mesh = jelly.lattice.mesh.as_deref().or(jelly.mesh.as_deref());
    let none = TriMesh::default();
    let lost = LostDetail::of(mesh.unwrap_or(&none), &jelly.lattice.grid, progress).map_err(cancelled)?;
    let picture = Arc::new(ModelPicture::new(&jelly.lattice, &lost));
    progress.progress(DETAIL_CHECKED_PROGRESS);
    check_cancelled()?;
    // Its cost is measured on the ground: most of the time it will touch something.
    scene.bodies[0].pose = Pose { position: [0.0, 0.5 * size_m[1], 0.0], ..Pose::default() };
    scene.bodies[0].moves_by = MovesBy::Cells;
    let mut shape_cache = ShapeCache::new(base_dir.clone());
    shape_cache.set_embedded(held);
    shape_cache.insert(body.shape.clone(), jelly.clone());
    let document = Document::new(&Opened::without_file(scene.clone(), body.name.clone(), base_dir.clone()));
    let session = Session::start(scene, document, shape_cache, &())?;
    check_cancelled()?;
    let preview = Preview {
        up_guessed: wanted.model.up == UpAxis::Auto,
        thin_share: lost.thin_share,
        joined_share: lost.joined_share,
        ..preview(&jelly, size_m, &session)
    };
    Ok(Jellified { body, jelly, preview, picture })
}

impl Jellified {
    /// Adds the body where a person looks, apart from what is there.
    pub fn add_to(self, surroundings: &Surroundings, look: Look) -> Command {
        let Self { mut body, jelly, preview, .. } = self;
        let size = DVec3::from(preview.size_m);
        body.pose.position = surroundings.place(look, size, DROP_HEIGHT_SHARE * size.max_element()).to_array();
        Command::AddBody { body: Box::new(body), jelly: Box::new(jelly) }
    }

    /// Gives an existing body its new cells.
    pub fn refill(self, body: BodyId) -> Command {
        Command::Refill { id: body, body: Box::new(self.body), jelly: Box::new(self.jelly) }
    }

    /// Makes a scene of nothing but the body on the ground.
    pub fn replace(self) -> [Command; 2] {
        let Self { body, jelly, preview, .. } = self;
        let mut scene = presets::ground_only();
        let longest = preview.size_m.into_iter().fold(0.0, f64::max);
        scene.view.camera =
            CameraSettings { target: [0.0, 0.45 * longest, 0.0], distance: 3.6 * longest, ..scene.view.camera };
        let title = body.name.clone();
        let replace = Command::Replace { scene: Box::new(scene), base_dir: PathBuf::new(), title };
        [replace, Command::AddBody { body: Box::new(body), jelly: Box::new(jelly) }]
    }
}

fn preview(jelly: &Jelly, size_m: [f64; 3], session: &Session) -> Preview {
    let report: VoxelReport = jelly.report.clone().unwrap_or_default();
    let prediction = Prediction::of(session);
    let status = session.status();
    Preview {
        triangles: report.triangles,
        closed: report.closed,
        parts: report.parts,
        joined_parts: report.joined_parts,
        thin_parts: report.thin_parts,
        thin_share: 0.0,
        joined_share: 0.0,
        up: jelly.up,
        up_guessed: false,
        occupancy: [occupancy_word(report.occupancy).to_owned(), report.why],
        cells: report.cells,
        dropped_cells: report.dropped_cells,
        components: report.components,
        particles: prediction.particles,
        links: prediction.links,
        mass_kg: prediction.mass_kg,
        memory_bytes: prediction.memory_bytes,
        cell_size_m: report.cell_size_m,
        size_m,
        dt_safe_secs: status.dt_safe_secs,
        dt_limited_by: status.dt_limited_by,
        speed_alone: prediction.predicted_real_time_factor,
        warnings: jelly.warnings.clone(),
    }
}

/// What an axis is called.
pub fn up_axis_word(up: UpAxis) -> &'static str {
    match up {
        UpAxis::Auto => "automatic",
        UpAxis::Y => "y",
        UpAxis::Z => "z",
        UpAxis::X => "x",
        UpAxis::MinusY => "−y",
        UpAxis::MinusZ => "−z",
        UpAxis::MinusX => "−x",
    }
}

/// What an occupancy is called.
pub fn occupancy_word(occupancy: OccupancyChoice) -> &'static str {
    match occupancy {
        OccupancyChoice::Auto => "automatic",
        OccupancyChoice::Centre => "centre",
        OccupancyChoice::Surface => "surface",
        OccupancyChoice::Solid => "solid",
    }
}

fn name_of(path: &str) -> String {
    let file = path.rsplit(['/', '\\']).next().unwrap_or(path);
    file.rsplit_once('.').map_or(file, |(stem, _)| stem).to_owned()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    const TENT: &str = "v 0 0 0\nv 4 0 0\nv 4 0 2\nv 0 0 2\nv 2 3 1\nf 1 2 3 4\nf 1 5 2\nf 2 5 3\nf 3 5 4\nf 4 5 1\n";

    fn model(folder: &Path, text: &str) -> ModelShape {
        let path = folder.join("tent.obj");
        std::fs::write(&path, text).expect("a file");
        ModelShape { path: path.to_string_lossy().into_owned(), divisions: 8, ..ModelShape::default() }
    }

    fn tent(length: f64) -> Jellified {
        let folder = tempfile::tempdir().expect("a folder");
        let shape = ModelShape { length, ..model(folder.path(), TENT) };
        jellify(&Wanted::new(shape, Settings::default()), &Progress::default()).expect("a sound model")
    }

    #[test]
    fn the_preview_is_what_the_session_gets_and_the_file_is_not_read_again() {
        let tent = tent(1.0);
        let preview = tent.preview.clone();
        assert!(preview.cells > 10 && preview.closed && preview.parts == 1, "{preview:?}");
        assert!(preview.dt_safe_secs > 1e-6 && preview.speed_alone.is_some_and(|speed| speed > 0.0), "{preview:?}");
        let mut session = Session::new(presets::ground_only(), PathBuf::new(), String::new()).expect("a session");
        let command = tent.add_to(&Surroundings::new(session.scene(), []), Look::default());
        session.handle(command).expect("the folder is gone, but nobody reads it");
        let status = session.status();
        assert_eq!((status.particles, status.links), (preview.particles, preview.links));
        assert_eq!(status.undo, "add tent", "one step of undo");
    }

    #[test]
    fn a_scene_of_its_own_shows_a_body_of_any_size() {
        for length in [0.02, 1.0, 300.0] {
            let mut session = Session::new(Scene::default(), PathBuf::new(), String::new()).expect("a session");
            for command in tent(length).replace() {
                session.handle(command).expect("a scene with one body");
            }
            let camera = session.scene().view.camera;
            assert!((camera.distance - 3.6 * length).abs() < 0.2 * length, "{length} m: {camera:?}");
            assert!(session.status().unsaved, "a scene that someone has made");
        }
    }

    #[test]
    fn the_axis_that_was_guessed_is_the_bodys_from_then_on() {
        let folder = tempfile::tempdir().expect("a folder");
        let lying = "v 0 0 0\nv 4 0 0\nv 4 2 0\nv 0 2 0\nv 2 1 3\nf 1 2 3 4\nf 1 5 2\nf 2 5 3\nf 3 5 4\nf 4 5 1\n";
        let shape = ModelShape { up: UpAxis::Auto, ..model(folder.path(), lying) };
        let made = jellify(&Wanted::new(shape, Settings::default()), &Progress::default()).expect("a tent");
        assert_eq!((made.preview.up, made.preview.up_guessed), (UpAxis::Z, true), "it stands only that way");
        let Shape::Model(body) = &made.body.shape else { panic!("a model") };
        assert_eq!(body.up, UpAxis::Z, "a later guess changes nothing");
        let upright = tent(1.0).preview.size_m;
        assert_eq!(made.preview.size_m.map(f64::to_bits), upright.map(f64::to_bits), "as if written with y up");
    }

    #[test]
    fn a_body_that_there_is_gets_other_cells_and_goes_on() {
        let mut session = Session::new(presets::ground_only(), PathBuf::new(), String::new()).expect("a session");
        let command = tent(1.0).add_to(&Surroundings::new(session.scene(), []), Look::default());
        session.handle(command).expect("there is room");
        for _ in 0..30 {
            session.step();
        }
        let (body, cells) = (session.scene().bodies[0].clone(), session.status().particles);
        let Shape::Model(model) = body.shape.clone() else { panic!("a model") };
        let folder = tempfile::tempdir().expect("a folder");
        let again = super::tests::model(folder.path(), TENT);
        let finer = ModelShape { divisions: 14, path: again.path, ..model };
        let wanted = Wanted { body: Some(Box::new(body.clone())), ..Wanted::new(finer, Settings::default()) };
        let made = jellify(&wanted, &Progress::default()).expect("a finer tent");
        assert_eq!((made.body.pose, &made.body.material), (body.pose, &body.material), "it stays the body it is");
        let before = session.status().bodies[0].bounds.center();
        session.handle(made.refill(BodyId(0))).expect("it is ready");
        let status = session.status();
        assert!(status.particles > 2 * cells, "{} particles, not {cells}", status.particles);
        assert!((status.bodies[0].bounds.center() - before).length() < 0.1, "where it has fallen to");
        session.handle(Command::Undo).expect("one step");
        assert_eq!((session.status().particles, &session.scene().bodies[0]), (cells, &body));
    }

    #[test]
    fn what_cells_lose_is_told() {
        let thick = tent(1.0).preview;
        assert!(thick.thin_share < 0.3, "{}", thick.thin_share);
        let folder = tempfile::tempdir().expect("a folder");
        let coarse = ModelShape { divisions: 1, ..model(folder.path(), TENT) };
        let made = jellify(&Wanted::new(coarse, Settings::default()), &Progress::default()).expect("one cell");
        assert!(made.preview.thin_share > 0.9, "all of it is in one cell: {}", made.preview.thin_share);
    }

    #[test]
    fn what_cannot_be_made_names_the_file_and_the_line() {
        let folder = tempfile::tempdir().expect("a folder");
        let bad = model(folder.path(), "v 0 0 0\nv 1 0 0\nv 0 1 zero\nf 1 2 3\n");
        let refused = |shape: &ModelShape| {
            let error = jellify(&Wanted::new(shape.clone(), Settings::default()), &Progress::default());
            error.expect_err("it cannot be made").to_string()
        };
        assert!(refused(&bad).contains("tent.obj, line 3"), "{}", refused(&bad));
        let huge = ModelShape { length: 9e9, ..model(folder.path(), TENT) };
        assert!(refused(&huge).contains("length"), "longer than anything can be: {}", refused(&huge));
    }

    #[test]
    fn what_is_no_longer_wanted_stops() {
        let folder = tempfile::tempdir().expect("a folder");
        let progress = Progress::default();
        progress.cancel();
        let shape = ModelShape { divisions: 60, ..model(folder.path(), TENT) };
        let stopped = jellify(&Wanted::new(shape, Settings::default()), &progress);
        assert!(stopped.is_err(), "nothing comes of it");
    }

    #[test]
    fn a_body_is_put_apart_from_the_others() {
        let scene = (presets::presets()[0].build)();
        let mut session = Session::new(scene, PathBuf::new(), String::new()).expect("a session");
        for _ in 0..3 {
            let boxes: Vec<_> = session.status().bodies.iter().map(|body| body.bounds).collect();
            let there = Surroundings::new(session.scene(), boxes);
            session.handle(tent(1.0).add_to(&there, Look::default())).expect("there is room");
        }
        let boxes: Vec<_> = session.status().bodies.iter().map(|body| body.bounds).collect();
        for (number, body) in boxes.iter().enumerate() {
            let clear = boxes[..number].iter().all(|other| !other.overlaps(body));
            assert!(clear && body.center().length() < 4.0, "near by and in nobody's way: {body:?}");
        }
    }
}
