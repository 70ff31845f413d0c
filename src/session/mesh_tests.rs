//! Obstacles that are meshes in a sandbox: read once, undone, named where they cannot be read.

use std::path::{Path, PathBuf};

use super::document::{ModelPlace, Opened};
use super::{Command, Session};
use crate::scene::edit::{Edit, ObstacleId};
use crate::scene::obstacle::Mesh;
use crate::scene::view_settings::CameraSettings;
use crate::scene::{Body, Obstacle, ObstacleShape, Scene};

/// A pyramid two units wide.
const PYRAMID: &str =
    "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv 0 1 0\nf 1 2 3 4\nf 2 1 5\nf 3 2 5\nf 4 3 5\nf 1 4 5\n";

fn folder() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("pyramid.obj"), PYRAMID).expect("a file");
    let path = folder.path().to_owned();
    (folder, path)
}

fn mesh(path: &str) -> Obstacle {
    Obstacle { shape: ObstacleShape::Mesh(Mesh { path: path.into(), ..Mesh::default() }), ..Obstacle::default() }
}

fn session(folder: &Path) -> Session {
    let scene = Scene { bodies: vec![Body::default()], obstacles: vec![mesh("pyramid.obj")], ..Scene::default() };
    Session::new(scene, folder.to_owned(), String::new()).expect("a sound scene")
}

fn surface_of(session: &Session, place: usize) -> std::sync::Arc<crate::geometry::Surface> {
    let ObstacleShape::Mesh(mesh) = &session.scene().obstacles[place].shape else { panic!("a mesh") };
    mesh.surface().expect("it is read")
}

#[test]
fn a_mesh_is_read_once_and_outlives_its_file_in_undo() {
    let (_kept, folder) = folder();
    let mut session = session(&folder);
    let first = surface_of(&session, 0);
    let before = session.scene().to_ron().expect("a text");
    std::fs::remove_file(folder.join("pyramid.obj")).expect("the file is there");
    let mut moved = session.scene().obstacles[0].clone();
    *moved.shape.center_mut() = [3.0, 0.2, 0.0];
    session.handle(Command::Edit(Edit::Obstacle(ObstacleId(0), Box::new(moved)))).expect("it needs no file");
    session.handle(Command::EndEdit).expect("no edit is open");
    session.handle(Command::Edit(Edit::RemoveObstacle(ObstacleId(0)))).expect("it can go");
    session.handle(Command::EndEdit).expect("no edit is open");
    session.handle(Command::Undo).expect("it comes back");
    assert!(std::sync::Arc::ptr_eq(&first, &surface_of(&session, 0)), "the very same");
    session.handle(Command::Undo).expect("to where it was");
    assert_eq!(session.scene().to_ron().expect("a text"), before, "byte for byte");
    session.step();
    assert!(session.draw_list().solids.len() == 1, "it is drawn");
}

#[test]
fn a_mesh_that_cannot_be_read_changes_nothing_and_is_named() {
    let (_kept, folder) = folder();
    let mut session = session(&folder);
    let before = session.scene().clone();
    let insert = |path: &str| Command::Edit(Edit::InsertObstacle(ObstacleId(1), Box::new(mesh(path))));
    for (path, text, said) in [
        ("none.obj", None, "does not exist"),
        ("line.obj", Some("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"), "no triangle with an area"),
        ("builtin:none.obj", None, "carries no model"),
    ] {
        if let Some(text) = text {
            std::fs::write(folder.join(path), text).expect("a file");
        }
        let error = session.handle(insert(path)).expect_err("it is refused");
        let cause = std::error::Error::source(&error).map(ToString::to_string).unwrap_or_default();
        let deeper = std::error::Error::source(&error).and_then(std::error::Error::source);
        let chain = format!("{error}: {cause} {}", deeper.map(ToString::to_string).unwrap_or_default());
        assert!(chain.starts_with("the model of obstacle 2") && chain.contains(said), "{chain}");
        assert_eq!(*session.scene(), before, "{path}: nothing has changed");
    }
    session.handle(insert("pyramid.obj")).expect("a sound one");
    assert!(std::sync::Arc::ptr_eq(&surface_of(&session, 0), &surface_of(&session, 1)), "the same file is one surface");
}

#[test]
fn the_path_of_a_mesh_is_written_as_seen_from_the_scenes_folder() {
    let (_kept, folder) = folder();
    let mut session = session(&folder);
    let deeper = folder.join("scenes");
    std::fs::create_dir(&deeper).expect("a folder");
    let path = deeper.join("a.ron");
    session
        .handle(Command::SaveAs { path: path.clone(), camera: CameraSettings::default(), models: ModelPlace::Beside })
        .expect("it is written");
    let opened = Opened::from_file(&path).expect("a scene");
    let ObstacleShape::Mesh(mesh) = &opened.scene.obstacles[0].shape else { panic!("a mesh") };
    assert_eq!(mesh.path, "../pyramid.obj");
    assert!(opened.inputs().iter().any(|input| input.ends_with("pyramid.obj")), "{:?}", opened.inputs());
    let again = Session::open(opened, &()).expect("it is found from there");
    assert!(surface_of(&again, 0).is_closed(), "a pyramid has an inside");
}

#[test]
fn a_mesh_that_is_added_stands_where_a_cube_would() {
    let (_kept, folder) = folder();
    let mut session = session(&folder);
    let before = session.scene().to_ron().expect("a text");
    let added = |path: &str| {
        let mut obstacle = mesh(path);
        *obstacle.shape.center_mut() = [3.0, 1.0, 0.0];
        Command::AddMesh(Box::new(obstacle))
    };
    session.handle(added("pyramid.obj")).expect("a sound mesh");
    let shape = &session.scene().obstacles[1].shape;
    let (half, center) = (0.5 * shape.bounds().size(), shape.center());
    assert!(half.y < 0.6 * half.x, "a pyramid half as high as wide: {half}");
    let (cubes_bottom, bottom) = (1.0 - 0.5 * Mesh::default().length, center[1] - half.y);
    assert!((bottom - cubes_bottom).abs() < 1e-12, "its bottom is at {bottom} m, not {cubes_bottom} m");
    assert!(std::sync::Arc::ptr_eq(&surface_of(&session, 0), &surface_of(&session, 1)), "the same file is one surface");
    session.handle(Command::Undo).expect("it can go");
    assert_eq!(session.scene().to_ron().expect("a text"), before, "byte for byte");
    let refused = session.handle(added("gone.obj")).expect_err("there is no such file").to_string();
    assert_eq!(refused, "the model of obstacle 2");
    assert_eq!(session.scene().to_ron().expect("a text"), before, "nothing has changed");
}
