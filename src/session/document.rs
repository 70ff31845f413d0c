//! What a sandbox knows of the file its scene came from: where it is, and whether the scene differs from it. Reads and
//! writes scene files; never changes the scene, so that nothing a person can undo depends on what was saved.
//!
//! ```text
//! file ─ Opened::from_file ─► Session        base_dir: where relative model paths start, for the session's whole life
//! file ◄─ Document::save ──── Session        model paths are written as seen from the file's own folder, or the models
//!                                            themselves
//! ```

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::gather::{CollectError, with_models_inside};
use super::model_paths::{absolute, model_files, normalized, relative_to};
use crate::disk::{self, fnv1a, folder_of};
use crate::geometry::import;
use crate::scene::file::SceneFileError;
use crate::scene::view_settings::CameraSettings;
use crate::scene::{Scene, ViewSettings, presets};
use crate::text::echo_path;

/// What a scene without a file is called.
pub const UNTITLED: &str = "untitled";

/// Why a scene cannot be saved.
#[derive(Debug, Error)]
pub enum SaveError {
    /// There is no file to save to.
    #[error("the scene has no file yet; use Save as… to give it one")]
    NoFile,
    /// The name would not be recognised as a scene's.
    #[error("{}: the name of a scene file ends in .ron", echo_path(.0))]
    NotAScene(PathBuf),
    /// Another program has written to it.
    #[error("{} has changed on the disk since it was opened; use Save as… to replace it or to keep both", echo_path(.0))]
    ChangedOnDisk(PathBuf),
    /// A model's place cannot be written into the file.
    #[error("the model of {whose}: {} is not UTF-8, so it cannot be written; rename the folder", echo_path(path))]
    ModelPath {
        /// The body or obstacle.
        whose: String,
        /// Where its model is.
        path: PathBuf,
    },
    /// A model cannot be put inside.
    #[error(transparent)]
    Inside(#[from] Box<CollectError>),
    /// The file cannot be written.
    #[error(transparent)]
    File(#[from] SceneFileError),
}

/// Where a scene file has its models.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ModelPlace {
    /// In files of their own, which the scene file names.
    #[default]
    Beside,
    /// Inside the scene file, so that it can be opened anywhere.
    Inside,
}

/// A scene on its way into a sandbox, with all that is known of its file.
#[derive(Clone, Debug, PartialEq)]
pub struct Opened {
    /// The scene.
    pub scene: Scene,
    /// A preset's name or a file's.
    pub title: String,
    /// The folder that relative model paths start at.
    pub base_dir: PathBuf,
    /// The scene file; none for presets, models and new scenes.
    pub file: Option<PathBuf>,
    /// Whether the scene holds changes that are in no file.
    pub unsaved: bool,
    /// The checksum of the scene file as it was last read or written; only for changes that were recovered.
    pub on_disk: Option<u64>,
}

impl Opened {
    /// A scene that comes from no scene file: a preset, or one made around a model.
    pub fn without_file(scene: Scene, title: String, base_dir: PathBuf) -> Self {
        Self { scene, title, base_dir, file: None, unsaved: false, on_disk: None }
    }

    /// A new scene: nothing but the ground.
    pub fn blank() -> Self {
        Self::without_file(presets::ground_only(), UNTITLED.to_owned(), PathBuf::new())
    }

    /// Reads a scene file.
    pub fn from_file(path: &Path) -> Result<Self, SceneFileError> {
        let scene = Scene::load(path)?;
        let file = std::path::absolute(path).unwrap_or_else(|_no_current_folder| path.to_owned());
        let (title, base_dir) = (title_of(&file), folder_of(path));
        Ok(Self { file: Some(file), ..Self::without_file(scene, title, base_dir) })
    }
}

impl Opened {
    /// The files that the scene is read from: its own, those of its models, and the buffers beside them.
    pub fn inputs(&self) -> Vec<PathBuf> {
        let mut scene = self.scene.clone();
        let read = model_files(&mut scene).flat_map(|(_, path)| import::files_of(&self.base_dir.join(&*path)));
        read.chain(self.file.clone()).collect()
    }
}

/// Whether two scenes differ in anything that a person would miss. The camera, the colours and the overlays are saved, but
/// do not count as changes.
pub fn differs(saved: &Scene, scene: &Scene) -> bool {
    let Scene { version, settings, bodies, obstacles, view, models } = scene;
    let ViewSettings { camera: _, light, color: _, color_range: _, overlays: _ } = view;
    let same = saved.version == *version
        && saved.settings == *settings
        && saved.bodies == *bodies
        && saved.obstacles == *obstacles
        && saved.view.light == *light
        && saved.models == *models;
    !same
}

/// Whether a file's name is that of a scene.
pub fn is_scene_path(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("ron"))
}

/// A sandbox's file and the scene as it is there.
#[derive(Clone, Debug)]
pub(super) struct Document {
    pub(super) title: String,
    pub(super) base_dir: PathBuf,
    pub(super) file: Option<PathBuf>,
    /// The scene as last opened or saved; none for a scene recovered after a crash.
    saved: Option<Scene>,
    /// The fingerprint of the file as last opened or saved; none where there was none.
    pub(super) on_disk: Option<u64>,
    /// Where the file has its models.
    models: ModelPlace,
    /// How often saving was refused because another program had changed the file.
    pub(super) refused_saves: u32,
}

impl Document {
    /// The document of a scene just opened.
    pub(super) fn new(opened: &Opened) -> Self {
        let Opened { scene, title, base_dir, file, unsaved, on_disk } = opened;
        let saved = (!unsaved).then(|| scene.clone());
        // Another program may have changed the file since a scene was lost that is recovered now.
        let on_disk = on_disk.or_else(|| file.as_deref().and_then(fingerprint));
        // A recovered scene keeps its models where its own file has them, which is not the file that it was read from.
        let of_file = || file.as_deref().filter(|_| *unsaved).and_then(|file| Scene::load(file).ok());
        let has_inside = !scene.models.is_empty() || of_file().is_some_and(|scene| !scene.models.is_empty());
        let models = if has_inside { ModelPlace::Inside } else { ModelPlace::Beside };
        let (title, base_dir, file) = (title.clone(), base_dir.clone(), file.clone());
        Self { title, base_dir, file, saved, on_disk, models, refused_saves: 0 }
    }

    /// Whether the scene holds changes that are in no file.
    pub(super) fn is_unsaved(&self, scene: &Scene) -> bool {
        self.saved.as_ref().is_none_or(|saved| differs(saved, scene))
    }

    /// Where the file of a scene has its models: a scene with model files inside has nowhere else to put them.
    pub(super) fn models(&self, scene: &Scene) -> ModelPlace {
        if scene.models.is_empty() { self.models } else { ModelPlace::Inside }
    }

    /// Writes the scene, seen by `camera`, to its own file or to a named one, which is its own from then on and has its
    /// models in the given place. A file that another program has changed in the meantime is replaced only if it is named.
    pub(super) fn save(
        &mut self,
        scene: &Scene,
        camera: CameraSettings,
        to: Option<(PathBuf, ModelPlace)>,
    ) -> Result<(), SaveError> {
        let named = to.is_some();
        let to = to.or_else(|| self.file.clone().map(|file| (file, self.models)));
        let (file, models) = to.ok_or(SaveError::NoFile)?;
        let file = std::path::absolute(&file).unwrap_or(file);
        if !is_scene_path(&file) {
            return Err(SaveError::NotAScene(file));
        }
        let present = fingerprint(&file);
        if !named && present.is_some() && present != self.on_disk {
            self.refused_saves += 1;
            return Err(SaveError::ChangedOnDisk(file));
        }
        let mut written = match models {
            ModelPlace::Beside if scene.models.is_empty() => {
                rebase_model_paths(scene, &self.base_dir, &folder_of(&file))?
            }
            _ => with_models_inside(scene, &self.base_dir).map_err(Box::new)?,
        };
        written.view.camera = camera;
        written.save(&file)?;
        self.title = title_of(&file);
        self.on_disk = fingerprint(&file);
        self.refused_saves = 0;
        self.models = models;
        self.file = Some(file);
        self.saved = Some(scene.clone());
        Ok(())
    }
}

/// Returns a checksum of a file's contents; none where there is no file.
fn fingerprint(file: &Path) -> Option<u64> {
    disk::read(file, u64::MAX).ok().map(|bytes| fnv1a(&bytes))
}

/// Returns the scene with its model paths as seen from another folder: relative where the two have a folder in common,
/// absolute otherwise.
pub fn rebase_model_paths(scene: &Scene, from: &Path, to: &Path) -> Result<Scene, SaveError> {
    let mut scene = scene.clone();
    let [from, to] = [from, to].map(|folder| normalized(&absolute(folder)));
    for (whose, path) in model_files(&mut scene) {
        if from != to || Path::new(&*path).is_absolute() {
            let found = relative_to(&from.join(&*path), &to);
            let text = found.to_str().map(|text| if cfg!(windows) { text.replace('\\', "/") } else { text.to_owned() });
            *path = text.ok_or(SaveError::ModelPath { whose, path: found })?;
        }
    }
    Ok(scene)
}

/// Returns the scene with model paths that mean the same from any folder.
pub fn anchored(scene: &Scene, base_dir: &Path) -> Scene {
    let mut scene = scene.clone();
    let base_dir = absolute(base_dir);
    for (_, path) in model_files(&mut scene) {
        if let Some(anchored) = base_dir.join(&*path).to_str().map(str::to_owned) {
            *path = anchored;
        }
    }
    scene
}

fn title_of(file: &Path) -> String {
    file.file_name().unwrap_or(OsStr::new(UNTITLED)).to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use std::error::Error;

    use super::*;
    use crate::scene::body::{Body, ModelShape};
    use crate::scene::edit::{BodyId, Edit};
    use crate::scene::{ColorBy, Shape};
    use crate::session::{Command, Session, SessionError};

    use ModelPlace::{Beside, Inside};

    fn with_model(path: &str) -> Scene {
        let shape = Shape::Model(ModelShape { path: path.to_owned(), ..ModelShape::default() });
        Scene { bodies: vec![Body { shape, ..Body::default() }], ..Scene::default() }
    }

    fn moved_path(path: &str, from: &str, to: &str) -> String {
        let scene = rebase_model_paths(&with_model(path), Path::new(from), Path::new(to)).expect("UTF-8");
        let Shape::Model(model) = &scene.bodies[0].shape else { panic!("a model") };
        model.path.clone()
    }

    #[test]
    fn model_paths_are_written_as_seen_from_the_files_folder() {
        let cases = [
            ("cow.obj", "/home/a/scenes", "/home/a/scenes", "cow.obj"),
            ("../models/cow.obj", "/home/a/scenes", "/home/a/scenes/.", "../models/cow.obj"),
            ("cow.obj", "/home/a", "/home/a/scenes", "../cow.obj"),
            ("cow.obj", "/home/a/scenes", "/home/a", "scenes/cow.obj"),
            ("../models/cow.obj", "/home/a/scenes", "/home/a/other/deep", "../../models/cow.obj"),
            ("/home/a/models/cow.obj", "/home/a", "/home/a", "models/cow.obj"),
            ("cow.obj", "/mnt/models", "/home/a", "/mnt/models/cow.obj"),
            ("builtin:spot.obj", "/home/a", "/mnt", "builtin:spot.obj"),
        ];
        for (path, from, to, expected) in cases {
            assert_eq!(moved_path(path, from, to), expected, "{path} from {from} to {to}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_link_on_the_way_does_not_mislead() {
        let folder = tempfile::tempdir().expect("a folder");
        let root = folder.path().canonicalize().expect("it exists");
        for name in ["far/away", "near"] {
            std::fs::create_dir_all(root.join(name)).expect("a folder");
        }
        std::os::unix::fs::symlink(root.join("far/away"), root.join("link")).expect("a link");
        std::fs::write(root.join("near/cow.obj"), "v 0 0 0").expect("a file");
        let from = root.join("near");
        let written = moved_path("cow.obj", &from.to_string_lossy(), &root.join("link").to_string_lossy());
        let found = root.join("link").join(&written).canonicalize().expect("the path leads to the model");
        assert_eq!(found, from.join("cow.obj"), "not ../near, which starts at far/away: {written}");
    }

    #[test]
    fn another_look_at_the_same_scene_is_no_change() {
        let opened = Opened::blank();
        let document = Document::new(&opened);
        let mut scene = opened.scene.clone();
        scene.view.camera.distance = 42.0;
        (scene.view.color, scene.view.color_range) = (ColorBy::Load, Some([0.0, 2.0]));
        scene.view.overlays.particles = true;
        assert!(!document.is_unsaved(&scene), "only the camera, the colours and the overlays are others");
        scene.view.light.strength = 2.0;
        assert!(document.is_unsaved(&scene), "the light is brighter");
        assert!(Document::new(&Opened { unsaved: true, ..opened }).is_unsaved(&scene), "recovered is unsaved");
    }

    #[test]
    fn colours_are_saved_though_they_are_no_change() {
        let folder = tempfile::tempdir().expect("a folder");
        let (mut session, file) = opened(folder.path(), "a.ron");
        let view = ViewSettings { color: ColorBy::Strain, ..session.scene().view.clone() };
        session.handle(Command::Edit(Edit::View(view))).expect("another colour");
        assert!(!session.status().unsaved, "nobody is asked about colours");
        session.handle(Command::Save { camera: CameraSettings::default() }).expect("the folder can be written");
        assert_eq!(Scene::load(&file).expect("a scene").view.color, ColorBy::Strain);
    }

    #[test]
    fn a_draft_names_its_models_from_anywhere() {
        let scene = anchored(&with_model("cow.obj"), Path::new("/home/a"));
        let Shape::Model(model) = &scene.bodies[0].shape else { panic!("a model") };
        assert_eq!(model.path, "/home/a/cow.obj");
        assert_eq!(anchored(&with_model("builtin:spot.obj"), Path::new("/x")), with_model("builtin:spot.obj"));
    }

    fn opened(folder: &Path, name: &str) -> (Session, PathBuf) {
        let file = folder.join(name);
        std::fs::write(folder.join("box.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("a model");
        with_model("box.obj").save(&file).expect("a scene file");
        let session = Session::open(Opened::from_file(&file).expect("a scene"), &()).expect("it can be simulated");
        (session, file)
    }

    fn brighten(session: &mut Session) {
        let mut view = session.scene().view.clone();
        view.light.strength += 0.5;
        session.handle(Command::Edit(Edit::View(view))).expect("the light may be brighter");
    }

    #[test]
    fn a_scene_is_saved_with_the_camera_and_is_then_no_longer_unsaved() {
        let folder = tempfile::tempdir().expect("a folder");
        let (mut session, file) = opened(folder.path(), "a.ron");
        assert!(!session.status().unsaved, "just opened");
        brighten(&mut session);
        assert!(session.status().unsaved, "edited");
        let camera = CameraSettings { distance: 9.0, ..CameraSettings::default() };
        session.handle(Command::Save { camera }).expect("the folder can be written");
        assert!(!session.status().unsaved, "saved");
        let written = Scene::load(&file).expect("a scene");
        assert_eq!((written.view.camera, written.view.light), (camera, session.scene().view.light));
        session.handle(Command::Undo).expect("the light goes back");
        assert!(session.status().unsaved, "the file has the brighter light");
        session.handle(Command::Redo).expect("and forth");
        assert!(!session.status().unsaved, "as in the file again");
    }

    #[test]
    fn a_scene_saved_elsewhere_finds_its_models_and_can_still_be_undone() {
        let folder = tempfile::tempdir().expect("a folder");
        let (mut session, _) = opened(folder.path(), "a.ron");
        session.handle(Command::Edit(Edit::RemoveBody(BodyId(0)))).expect("away with it");
        let other = folder.path().join("other");
        std::fs::create_dir(&other).expect("a folder");
        let to = other.join("b.ron");
        session
            .handle(Command::SaveAs { path: to.clone(), camera: CameraSettings::default(), models: Beside })
            .expect("it is saved");
        session.handle(Command::Undo).expect("the body comes back");
        session.handle(Command::Save { camera: CameraSettings::default() }).expect("to the new file");
        assert_eq!((session.title(), session.status().file), ("b.ron", Some(to.clone())));
        let again = Opened::from_file(&to).expect("a scene");
        let Shape::Model(model) = &again.scene.bodies[0].shape else { panic!("a model") };
        assert_eq!(model.path, "../box.obj");
        Session::open(again, &()).expect("the model is found");
    }

    #[test]
    fn a_scene_with_its_models_inside_needs_no_other_file_and_stays_so() {
        let folder = tempfile::tempdir().expect("a folder");
        let (mut session, _) = opened(folder.path(), "a.ron");
        let camera = CameraSettings::default();
        assert_eq!((session.status().models, session.status().chooses_models), (Beside, true));
        let whole = folder.path().join("whole.ron");
        session.handle(Command::SaveAs { path: whole.clone(), camera, models: Inside }).expect("it is saved");
        assert_eq!(session.status().models, Inside, "as the file has them");
        let elsewhere = tempfile::tempdir().expect("another folder");
        let there = elsewhere.path().join("b.ron");
        std::fs::copy(&whole, &there).expect("one file");
        let mut again = Session::open(Opened::from_file(&there).expect("a scene"), &()).expect("it has its model");
        assert_eq!(again.simulation().hash(), session.simulation().hash(), "the very same body");
        assert_eq!((again.status().models, again.status().chooses_models), (Inside, false), "it has no other place");
        brighten(&mut again);
        again.handle(Command::Save { camera }).expect("saved");
        let written = Scene::load(&there).expect("a scene");
        assert_eq!(written.models, again.scene().models, "nothing is lost or doubled");
        again.handle(Command::Edit(Edit::RemoveBody(BodyId(0)))).expect("away with it");
        again.handle(Command::Save { camera }).expect("saved");
        assert!(Scene::load(&there).expect("a scene").models.is_empty(), "nobody needs it");
        again.handle(Command::Undo).expect("it comes back without a file");
        again.handle(Command::Save { camera }).expect("saved");
        assert_eq!(Scene::load(&there).expect("a scene"), written, "as it was");
        let recover = Command::Recover {
            scene: Box::new(with_model("builtin:spot.obj")),
            title: "b".into(),
            file: Some(there),
            on_disk: None,
        };
        again.handle(recover).expect("a scene");
        assert_eq!(again.status().models, Inside, "its file goes on as it was");
    }

    #[test]
    fn what_cannot_be_opened_or_saved_changes_nothing_and_says_why() {
        let folder = tempfile::tempdir().expect("a folder");
        let (mut session, _) = opened(folder.path(), "a.ron");
        brighten(&mut session);
        let (scene, status) = (session.scene().clone(), session.status());
        let lost = folder.path().join("lost.ron");
        with_model("missing.obj").save(&lost).expect("a scene file");
        let camera = CameraSettings::default();
        let refused = [
            (Command::Open { path: folder.path().join("none.ron") }, "none.ron"),
            (Command::Open { path: folder.path().join("box.obj") }, "box.obj:1"),
            (Command::Open { path: lost }, "missing.obj"),
            (Command::SaveAs { path: folder.path().join("none/a.ron"), camera, models: Beside }, "cannot be written"),
            (Command::SaveAs { path: folder.path().join("a.obj"), camera, models: Beside }, "ends in .ron"),
        ];
        for (command, word) in refused {
            let error = session.handle(command.clone()).expect_err("it must be refused");
            let cause = error.source().map(ToString::to_string).unwrap_or_default();
            assert!(format!("{error}: {cause}").contains(word), "{command:?}: {error}: {cause}");
            assert_eq!((session.scene(), session.status()), (&scene, status.clone()), "{command:?}");
        }
        session.handle(Command::New).expect("a new scene is always possible");
        let status = session.status();
        assert_eq!((status.title.as_str(), status.unsaved, status.file), (UNTITLED, false, None));
        assert!(matches!(session.handle(Command::Save { camera }), Err(SessionError::Save(SaveError::NoFile))));
    }

    #[test]
    fn what_another_program_wrote_is_replaced_only_by_name() {
        let folder = tempfile::tempdir().expect("a folder");
        let (mut session, file) = opened(folder.path(), "a.ron");
        let camera = CameraSettings::default();
        session.handle(Command::Save { camera }).expect("nobody else has touched it");
        std::fs::write(&file, "(version: 1)").expect("another program's work");
        let refused = session.handle(Command::Save { camera }).expect_err("it would be lost").to_string();
        assert!(refused.contains("a.ron has changed on the disk"), "{refused}");
        assert_eq!(std::fs::read_to_string(&file).expect("a file"), "(version: 1)", "it is still there");
        assert_eq!(session.status().refused_saves, 1, "the window can ask");
        session.handle(Command::SaveAs { path: file.clone(), camera, models: Beside }).expect("by name");
        assert!(Scene::load(&file).expect("a scene") != Scene::default(), "replaced");
        assert_eq!(session.status().refused_saves, 0, "answered");
        session.handle(Command::Save { camera }).expect("it is as this session left it");
        std::fs::remove_file(&file).expect("it was there");
        session.handle(Command::Save { camera }).expect("there is nothing to lose");
    }

    #[test]
    fn a_recovered_scene_is_unsaved_until_it_is_saved() {
        let folder = tempfile::tempdir().expect("a folder");
        let (mut session, file) = opened(folder.path(), "a.ron");
        let scene = Box::new(anchored(session.scene(), folder.path()));
        let on_disk = session.status().on_disk;
        let recover = |scene| Command::Recover { scene, title: "a.ron".into(), file: Some(file.clone()), on_disk };
        session.handle(recover(scene.clone())).expect("the model is found");
        assert!(session.status().unsaved, "it is in no file yet");
        session.handle(Command::Save { camera: CameraSettings::default() }).expect("it has a file");
        assert!(!session.status().unsaved, "now it is");
        let written = Scene::load(&file).expect("a scene");
        let Shape::Model(model) = &written.bodies[0].shape else { panic!("a model") };
        assert_eq!(model.path, "box.obj", "relative again");
        let other = std::fs::read_to_string(&file).expect("a scene") + "// Written by hand.\n";
        std::fs::write(&file, other).expect("a file");
        session.handle(recover(scene)).expect("the model is found");
        let refused = session.handle(Command::Save { camera: CameraSettings::default() });
        assert!(refused.is_err(), "the file is another than when the scene was lost");
    }
}
