//! A folder with a scene and every model that it reads, which another person can open anywhere:
//!
//! ```text
//! FOLDER/scene.ron              paths of models as seen from here
//! FOLDER/models/cow.obj         a model that is one file
//! FOLDER/models/lamp/lamp.gltf  one that has its buffers beside it, and they as it names them
//! ```

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::document::{self, UNTITLED};
use crate::disk::{self, folder_of};
use crate::geometry::import::{self, ImportError};
use crate::scene::Scene;
use crate::scene::file::SceneFileError;

/// The folder of the models.
const MODELS: &str = "models";

/// Why a scene cannot be collected; nothing has been written then.
#[derive(Debug, Error)]
pub enum CollectError {
    /// A model cannot be read.
    #[error("the model of {whose}")]
    Model {
        /// The body or obstacle.
        whose: String,
        /// Why.
        source: Box<ImportError>,
    },
    /// A file's name cannot be written into the scene.
    #[error("the model of {whose}: {} is not UTF-8, so it cannot be written; rename the file", path.display())]
    Name {
        /// The body or obstacle.
        whose: String,
        /// The model.
        path: PathBuf,
    },
    /// The folder cannot be written.
    #[error("{} cannot be written", folder.display())]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The scene has no text.
    #[error(transparent)]
    Scene(#[from] SceneFileError),
}

/// What was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Collected {
    /// The scene file.
    pub scene: PathBuf,
    /// The files of models, in the order in which the scene names them.
    pub models: Vec<PathBuf>,
    /// How large they are together, bytes.
    pub bytes: u64,
}

/// A file to be copied, and its place in the folder.
struct Copy {
    from: PathBuf,
    to: PathBuf,
}

/// Writes a new folder with a scene, called by its title, and its models, whose relative paths start at `base_dir`. The
/// scene itself stays as it is.
///
/// # Errors
/// If the folder is there and not empty, a model cannot be read or something cannot be written. There is no folder then.
pub fn collect(scene: &Scene, base_dir: &Path, title: &str, folder: &Path) -> Result<Collected, CollectError> {
    let refused = |source| CollectError::Folder { folder: folder.to_owned(), source };
    disk::check_new_folder(folder).map_err(refused)?;
    let mut scene = scene.clone();
    let copies = copies(&mut scene, base_dir)?;
    let text = scene.to_ron()?;
    let name = Path::new(title).with_extension("ron");
    let name = Path::new(name.file_name().unwrap_or_else(|| UNTITLED.as_ref()));
    let mut bytes = 0;
    disk::write_folder(folder, |inside| {
        for Copy { from, to } in &copies {
            let to = inside.join(to);
            fs::create_dir_all(folder_of(&to))?;
            bytes += fs::copy(from, to)?;
        }
        disk::write(&inside.join(name), text.as_bytes())
    })
    .map_err(refused)?;
    let models = copies.into_iter().map(|copy| folder.join(copy.to)).collect();
    Ok(Collected { scene: folder.join(name), models, bytes })
}

/// The files of all models of a scene, each once, and the scene with their new paths.
fn copies(scene: &mut Scene, base_dir: &Path) -> Result<Vec<Copy>, CollectError> {
    let mut taken: Vec<(PathBuf, String)> = Vec::new();
    let mut copies = Vec::new();
    for (whose, path) in document::model_paths(scene) {
        let from = base_dir.join(&*path);
        if let Some((_, place)) = taken.iter().find(|(known, _)| disk::is_same_file(known, &from)) {
            path.clone_from(place);
            continue;
        }
        // What another person could not open is found here and now.
        import::load(&from).map_err(|source| CollectError::Model { whose: whose.clone(), source: Box::new(source) })?;
        let named = || CollectError::Name { whose: whose.clone(), path: from.clone() };
        let name = from.file_name().and_then(|name| name.to_str()).ok_or_else(named)?;
        let files = import::files_of(&from);
        let own = |place: &str| {
            if files.len() > 1 { format!("{MODELS}/{}/{name}", stem(place)) } else { format!("{MODELS}/{place}") }
        };
        let is_free = |place: &String| taken.iter().all(|(_, other)| !other.eq_ignore_ascii_case(place));
        let numbered = (2..).map(|number| own(&with_number(name, number)));
        let place = std::iter::once(own(name)).chain(numbered).find(is_free).unwrap_or_default();
        let (beside, target) = (folder_of(&from), folder_of(Path::new(&place)));
        for file in files {
            // What lies beside a model is never above it.
            let to = target.join(file.strip_prefix(&beside).unwrap_or(Path::new(name)));
            copies.push(Copy { to: if file == from { PathBuf::from(&place) } else { to }, from: file });
        }
        path.clone_from(&place);
        taken.push((from, place));
    }
    Ok(copies)
}

fn stem(name: &str) -> &str {
    name.rsplit_once('.').map_or(name, |(stem, _)| stem)
}

/// A file's name with a number before its ending.
fn with_number(name: &str, number: u32) -> String {
    match name.rsplit_once('.') {
        Some((stem, ending)) => format!("{stem}-{number}.{ending}"),
        None => format!("{name}-{number}"),
    }
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
            resolve(&body.shape, &folder, &()).unwrap_or_else(|error| panic!("{:?}: {error}", of.shape));
        }
        load_meshes(&mut read, &folder, &()).expect("the obstacle has its mesh");
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
        fs::remove_file(outer.path().join("two/bin/a.bin")).expect("the file is there");
        let words = refused(&scene, "new");
        assert!(words.contains("body 3") && words.contains("a.bin"), "{words}");
        scene.bodies[0] = body("none.obj");
        let words = refused(&scene, "new");
        assert!(words.contains("body 1") && words.contains("none.obj does not exist"), "{words}");
        assert!(!outer.path().join("new").exists(), "there is no folder");
    }
}
