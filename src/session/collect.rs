//! A folder with a scene and every model that it reads, which another person can open anywhere:
//!
//! ```text
//! FOLDER/scene.ron              paths of models as seen from here
//! FOLDER/models/cow.obj         a model that is one file
//! FOLDER/models/lamp/lamp.gltf  a model with buffers or pictures beside it, at the paths that it gives them
//! ```
//!
//! Or one file with all of it inside.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::document::UNTITLED;
pub use super::gather::CollectError;
use super::gather::{Gathered, Source, gather, with_models_inside};
use crate::disk::{self, folder_of};
use crate::scene::Scene;
use crate::scene::embedded::PREFIX;
use crate::text::echo_path;

/// The folder of the models.
const MODELS: &str = "models";

/// What was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Collected {
    /// The scene file.
    pub scene: PathBuf,
    /// The files of models, in the order in which the scene names them; those inside the scene file by their paths in it.
    pub models: Vec<PathBuf>,
    /// How large they are together, bytes.
    pub bytes: u64,
}

/// Writes a new folder with a scene, named after its title, and its models. Relative model paths start at `base_dir`. The
/// scene itself stays as it is.
///
/// # Errors
/// If the folder is there and not empty, a model cannot be read or something cannot be written. There is no folder then.
pub fn collect(scene: &Scene, base_dir: &Path, title: &str, folder: &Path) -> Result<Collected, CollectError> {
    let refused = |source| CollectError::Folder { folder: folder.to_owned(), source };
    disk::check_new_folder(folder).map_err(refused)?;
    let mut scene = scene.clone();
    let files = gather(&mut scene, base_dir, &format!("{MODELS}/"))?;
    let name = Path::new(title).with_extension("ron");
    let name = Path::new(name.file_name().unwrap_or_else(|| UNTITLED.as_ref()));
    let text = scene.to_readable_ron(&echo_path(name))?;
    let mut bytes = 0;
    disk::write_folder(folder, |inside| {
        for Gathered { place, from } in &files {
            let to = inside.join(MODELS).join(place);
            fs::create_dir_all(folder_of(&to))?;
            bytes += match from {
                Source::Disk(from) => fs::copy(from, to)?,
                Source::Scene(file) => {
                    fs::write(to, file.unpack().map_err(|damage| io::Error::new(io::ErrorKind::InvalidData, damage))?)?;
                    file.bytes
                }
            };
        }
        disk::write(&inside.join(name), text.as_bytes())
    })
    .map_err(refused)?;
    let models = files.into_iter().map(|file| folder.join(MODELS).join(file.place)).collect();
    Ok(Collected { scene: folder.join(name), models, bytes })
}

/// Writes one file with a scene and its models. Relative model paths start at `base_dir`. The scene itself stays as it is.
///
/// # Errors
/// If a model cannot be read or the file cannot be written.
pub fn collect_into_file(scene: &Scene, base_dir: &Path, file: &Path) -> Result<Collected, CollectError> {
    let whole = with_models_inside(scene, base_dir)?;
    whole.save(file)?;
    let models = whole.models.files().iter().map(|file| PathBuf::from(format!("{PREFIX}{}", file.path))).collect();
    let bytes = whole.models.files().iter().map(|file| file.bytes).sum();
    Ok(Collected { scene: file.to_owned(), models, bytes })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::body::ModelShape;
    use crate::scene::obstacle::Mesh;
    use crate::scene::resolve::{load_meshes, resolve};
    use crate::scene::{Body, Obstacle, ObstacleShape, Shape};

    const TENT: &str = "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 0 1 0\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n";
    const GLTF: &str = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"uri":"bin/a.bin","byteLength":36}],
        "bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,
        "type":"VEC3","min":[0,0,0],"max":[1,1,0]}]}"#;

    fn body(path: &str) -> Body {
        Body {
            shape: Shape::Model(ModelShape { path: path.to_owned(), divisions: 4, ..ModelShape::default() }),
            ..Body::default()
        }
    }

    /// A folder with models in several places, and a scene in it that names them.
    fn scattered() -> (tempfile::TempDir, Scene) {
        let outer = tempfile::tempdir().expect("a folder");
        let at = |path: &str| outer.path().join(path);
        for folder in ["scenes", "one", "two/bin"] {
            fs::create_dir_all(at(folder)).expect("a folder");
        }
        for file in ["one/tent.obj", "two/Tent.obj"] {
            fs::write(at(file), TENT).expect("a file");
        }
        fs::write(at("two/flat.gltf"), GLTF).expect("a file");
        let corners = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        fs::write(at("two/bin/a.bin"), corners.map(f32::to_le_bytes).concat()).expect("a file");
        let paths = ["../one/tent.obj", "../two/Tent.obj", "../two/flat.gltf", "../one/./tent.obj", "builtin:tree.obj"];
        let bodies = paths.map(body).to_vec();
        let mesh = Mesh { path: at("two/Tent.obj").to_string_lossy().into_owned(), ..Mesh::default() };
        let obstacles = vec![Obstacle { shape: ObstacleShape::Mesh(mesh), ..Obstacle::default() }];
        (outer, Scene { bodies, obstacles, ..Scene::default() })
    }

    #[test]
    fn the_folder_opens_without_what_it_came_from() {
        let (outer, scene) = scattered();
        let elsewhere = tempfile::tempdir().expect("a folder");
        let folder = elsewhere.path().join("mine");
        let found = collect(&scene, &outer.path().join("scenes"), "my scene.ron", &folder).expect("a sound scene");
        drop(outer);
        assert_eq!(found.scene, folder.join("my scene.ron"));
        let models: Vec<_> = found.models.iter().map(|path| path.strip_prefix(&folder).expect("inside")).collect();
        let expected =
            ["tent.obj", "Tent-2.obj", "flat/flat.gltf", "flat/bin/a.bin"].map(|name| Path::new(MODELS).join(name));
        assert_eq!(models, expected, "each once, no two of one name, buffers where their model looks for them");
        assert_eq!(found.bytes, (2 * TENT.len() + GLTF.len() + 36) as u64);
        let mut read = Scene::load(&found.scene).expect("a scene");
        for (body, of) in read.bodies.iter().zip(&scene.bodies) {
            resolve(&body.shape, folder.as_path(), &()).unwrap_or_else(|error| panic!("{:?}: {error}", of.shape));
        }
        load_meshes(&mut read, &folder, &()).expect("the obstacle has its mesh");
    }

    #[test]
    fn one_file_opens_without_what_it_came_from_and_becomes_a_folder_again() {
        let (outer, scene) = scattered();
        let base_dir = outer.path().join("scenes");
        let elsewhere = tempfile::tempdir().expect("a folder");
        let file = elsewhere.path().join("mine.ron");
        let found = collect_into_file(&scene, &base_dir, &file).expect("a sound scene");
        let names = ["tent.obj", "Tent-2.obj", "flat/flat.gltf", "flat/bin/a.bin"];
        assert_eq!(found.models, names.map(|name| PathBuf::from(format!("embedded:{name}"))), "each once");
        let mesh_of = |scene: &Scene, base_dir: &Path, body: usize| {
            let jelly = resolve(&scene.bodies[body].shape, scene.model_places(base_dir), &()).expect("a model");
            jelly.mesh.expect("its mesh")
        };
        let before: Vec<_> = (0..5).map(|body| mesh_of(&scene, &base_dir, body)).collect();
        drop(outer);
        let nowhere = Path::new("/nowhere");
        let mut read = Scene::load(&file).expect("a scene");
        for (body, before) in before.iter().enumerate() {
            assert_eq!(mesh_of(&read, nowhere, body), *before, "{:?}", read.bodies[body].shape);
        }
        load_meshes(&mut read, nowhere, &()).expect("the obstacle has its mesh");
        let again = elsewhere.path().join("again.ron");
        collect_into_file(&read, nowhere, &again).expect("a sound scene");
        assert_eq!(fs::read(&again).expect("a file"), fs::read(&file).expect("a file"), "as it was");
        let folder = elsewhere.path().join("folder");
        collect(&read, nowhere, "a", &folder).expect("a sound scene");
        let scene = Scene::load(&folder.join("a.ron")).expect("a scene");
        assert!(scene.models.is_empty() && mesh_of(&scene, &folder, 2) == before[2], "files again");
        read.models = crate::scene::Embedded::default();
        let lost = collect_into_file(&read, nowhere, &again).expect_err("they are nowhere").to_string();
        assert_eq!(lost, "the model of body 1: the scene holds no tent.obj");
    }

    #[test]
    #[cfg(unix)]
    fn models_of_one_stem_keep_apart_and_no_name_is_refused() {
        let (outer, mut scene) = scattered();
        let at = |path: &str| outer.path().join(path);
        fs::create_dir(at("one/bin")).expect("a folder");
        // Its colours have the name of the other's buffer.
        let colors = "newmtl red\nKd 1 0 0\n";
        fs::write(at("one/bin/a.bin"), colors).expect("a file");
        fs::write(at("one/Flat.obj"), format!("mtllib bin/a.bin\n{TENT}")).expect("a file");
        for name in ["two/scan 10:30.obj", "two/a\\1.obj", "two/a\\2.obj"] {
            fs::write(at(name), TENT).expect("a file");
        }
        let paths = ["two/flat.gltf", "one/Flat.obj", "two/scan 10:30.obj", "two/a\\1.obj", "two/a\\2.obj"];
        scene.bodies = paths.map(|path| body(&format!("../{path}"))).to_vec();
        scene.obstacles.clear();
        let file = at("held.ron");
        let found = collect_into_file(&scene, &at("scenes"), &file).expect("a sound scene");
        let two = ["flat/flat.gltf", "flat/bin/a.bin", "Flat-2/Flat.obj", "Flat-2/bin/a.bin"];
        let names = [&two[..], &["scan 10_30.obj", "a_1.obj", "a_2.obj"]].concat();
        let within = |name: &&str| PathBuf::from(format!("embedded:{name}"));
        assert_eq!(found.models, names.iter().map(within).collect::<Vec<_>>());
        collect(&scene, &at("scenes"), "a", &at("mine")).expect("a sound scene");
        let copied = |name: &str| fs::read(at("mine/models").join(name)).expect("it was collected");
        assert_eq!(copied("flat/bin/a.bin"), fs::read(at("two/bin/a.bin")).expect("a file"), "nothing was put over it");
        assert_eq!(copied("Flat-2/bin/a.bin"), colors.as_bytes());
        let read = Scene::load(&file).expect("it can be read again");
        for body in &read.bodies {
            resolve(&body.shape, read.model_places(Path::new("/nowhere")), &()).expect("it has its model");
        }
    }

    #[test]
    fn what_a_model_spells_in_another_case_is_collected_and_found_again() {
        let (outer, mut scene) = scattered();
        let at = |path: &str| outer.path().join(path);
        fs::rename(at("two/bin"), at("two/BIN")).expect("a folder");
        fs::rename(at("two/BIN/a.bin"), at("two/BIN/A.Bin")).expect("a file");
        (scene.bodies, scene.obstacles) = (vec![body("../two/flat.gltf")], Vec::new());
        let file = at("held.ron");
        let found = collect_into_file(&scene, &at("scenes"), &file).expect("a sound scene");
        assert_eq!(
            found.models,
            ["flat/flat.gltf", "flat/BIN/A.Bin"].map(|name| PathBuf::from(format!("embedded:{name}")))
        );
        collect(&scene, &at("scenes"), "a", &at("mine")).expect("a sound scene");
        for (scene, base_dir) in [(file, at("nowhere")), (at("mine/a.ron"), at("mine"))] {
            let scene = Scene::load(&scene).expect("a scene");
            let places = scene.model_places(&base_dir);
            assert!(resolve(&scene.bodies[0].shape, places, &()).is_ok(), "it has its buffer");
        }
    }

    #[test]
    fn what_cannot_be_collected_leaves_nothing() {
        let (outer, mut scene) = scattered();
        let base_dir = outer.path().join("scenes");
        let refused = |scene: &Scene, name: &str| {
            let folder = outer.path().join(name);
            let error = collect(scene, &base_dir, "a", &folder).expect_err("refused");
            let cause = std::error::Error::source(&error).map(ToString::to_string).unwrap_or_default();
            format!("{error}: {cause}")
        };
        let words = refused(&scene, "one");
        assert!(words.contains("one cannot be written") && words.contains("not empty"), "{words}");
        let dt = std::mem::replace(&mut scene.settings.dt, 7.0);
        let words = refused(&scene, "new");
        assert!(words.starts_with("a.ron: settings.dt = 7 s is outside"), "nobody could open it: {words}");
        scene.settings.dt = dt;
        fs::remove_file(outer.path().join("two/bin/a.bin")).expect("the file is there");
        let words = refused(&scene, "new");
        assert!(words.contains("body 3") && words.contains("a.bin"), "{words}");
        scene.bodies[0] = body("none.obj");
        let words = refused(&scene, "new");
        assert!(words.contains("body 1") && words.contains("none.obj does not exist"), "{words}");
        assert!(!outer.path().join("new").exists(), "there is no folder");
    }
}
