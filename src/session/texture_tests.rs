//! Models with pictures in a sandbox: shared, undone, taken along, told where they are missing.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::collect::{collect, collect_into_file};
use super::document::Opened;
use super::{Command, Session};
use crate::geometry::picture_file::tests::png;
use crate::math::picture::Picture;
use crate::scene::edit::{BodyId, Edit};
use crate::scene::{ColorBy, ContactOn, MovesBy, Scene, Shape, Skin, presets};

/// A tetrahedron, every face of which has all of the picture.
const TENT: &str = "mtllib mats/tent.mtl\nv 0 0 0\nv 1 0 0\nv 0 0 1\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl cloth\n\
                    f 1/1 2/2 3/3\nf 1/1 4/2 2/3\nf 2/1 4/2 3/3\nf 3/1 4/2 1/3\n";

const TEXELS: [[u8; 4]; 4] = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [9, 9, 9, 255]];

/// A folder with the model, its materials and its picture.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    std::fs::create_dir(at("mats")).expect("a folder");
    std::fs::write(at("tent.obj"), TENT).expect("a file");
    std::fs::write(at("mats/tent.mtl"), "newmtl cloth\nmap_Kd red cloth.png\n").expect("a file");
    std::fs::write(at("mats/red cloth.png"), png([2, 2], &TEXELS)).expect("a file");
    folder
}

/// Falling bodies of the model, one for each number of divisions.
fn scene(divisions: &[u32]) -> Scene {
    let mut scene = presets::drop_model("tent.obj");
    let body = scene.bodies.remove(0);
    for &divisions in divisions {
        let mut body = body.clone();
        let Shape::Model(model) = &mut body.shape else { panic!("a model") };
        model.divisions = divisions;
        scene.bodies.push(body);
    }
    scene
}

fn session(scene: Scene, folder: &Path) -> Session {
    Session::new(scene, folder.to_owned(), String::new()).expect("a sound scene")
}

/// The pictures of all skins, one each.
fn pictures(session: &mut Session) -> Vec<Arc<Picture>> {
    let skins = session.draw_list().skins;
    let textures = skins.iter().filter_map(|instance| instance.skin.textures());
    textures.map(|textures| Arc::clone(&textures.runs[0].texture.picture)).collect()
}

#[test]
fn bodies_of_one_model_share_its_picture() {
    let folder = folder();
    let mut session = session(scene(&[4, 4, 6]), folder.path());
    assert_eq!(session.warnings(), [""; 0], "nothing is missing");
    let found = pictures(&mut session);
    assert_eq!((found.len(), &found[0].levels()[0].rgba), (3, &TEXELS.concat()));
    assert!(found.iter().all(|picture| Arc::ptr_eq(picture, &found[0])), "of whatever shape");
    let mut body = session.scene().bodies[1].clone();
    let Shape::Model(model) = &mut body.shape else { panic!("a model") };
    model.divisions = 5;
    session.handle(Command::Edit(Edit::Body(BodyId(1), Box::new(body)))).expect("a finer body");
    session.handle(Command::EndEdit).expect("no edit is open");
    assert!(pictures(&mut session).iter().all(|picture| Arc::ptr_eq(picture, &found[0])), "a new one, too");
}

#[test]
fn a_picture_counts_once_in_the_memory_of_a_scene() {
    let folder = folder();
    let bytes = || session(scene(&[4, 4, 6]), folder.path()).memory_bytes();
    let with = bytes();
    std::fs::remove_file(folder.path().join("mats/red cloth.png")).expect("it is there");
    assert_eq!(with - bytes(), 4 * (4 + 1), "four texels, and one that is coarser");
}

#[test]
fn a_picture_outlives_its_file_in_undo_and_the_map_of_a_scalar() {
    let folder = folder();
    let mut session = session(scene(&[4]), folder.path());
    let found = pictures(&mut session);
    std::fs::remove_file(folder.path().join("mats/red cloth.png")).expect("it is there");
    session.handle(Command::Edit(Edit::RemoveBody(BodyId(0)))).expect("it can go");
    session.handle(Command::EndEdit).expect("no edit is open");
    assert_eq!(pictures(&mut session).len(), 0);
    session.handle(Command::Undo).expect("it comes back");
    assert!(Arc::ptr_eq(&pictures(&mut session)[0], &found[0]), "the very same");
    assert!(session.draw_list().painted, "a model opens in its own colours");
    let skin = Arc::clone(&session.draw_list().skins[0].skin);
    let mut view = session.scene().view.clone();
    view.color = ColorBy::Load;
    session.handle(Command::Edit(Edit::View(view))).expect("another colour");
    let shown = session.draw_list();
    assert!(shown.scalars.is_some() && !shown.painted && Arc::ptr_eq(&shown.skins[0].skin, &skin), "the skin stays");
}

#[test]
fn a_body_in_any_form_has_the_picture_and_moves_as_without_it() {
    let folder = folder();
    let plain = tempfile::tempdir().expect("a folder");
    std::fs::write(plain.path().join("tent.obj"), TENT).expect("a file");
    let all = |change: &dyn Fn(&mut crate::scene::Body)| {
        let mut scene = scene(&[3]);
        change(&mut scene.bodies[0]);
        let mut both = [folder.path(), plain.path()].map(|folder| session(scene.clone(), folder));
        for session in &mut both {
            (0..8).for_each(|_| assert!(session.step(), "it moves"));
        }
        let [mut textured, plain] = both;
        assert_eq!(textured.simulation().hash(), plain.simulation().hash(), "to the last bit");
        pictures(&mut textured).len()
    };
    assert_eq!(all(&|_| ()), 1, "cells");
    assert_eq!(all(&|body| body.contact_on = ContactOn::Mesh), 1, "met on its mesh");
    assert_eq!(all(&|body| body.skin = Skin::Cells), 0, "drawn as its cells it has no picture");
    let mut modal = scene(&[3]);
    modal.bodies[0].moves_by = MovesBy::Modes;
    assert_eq!(pictures(&mut session(modal, folder.path())).len(), 1, "moved by its modes");
}

#[test]
fn a_scene_takes_its_pictures_along() {
    let folder = folder();
    let elsewhere = tempfile::tempdir().expect("a folder");
    let at = |name: &str| elsewhere.path().join(name);
    let scene = scene(&[4]);
    let collected = collect(&scene, folder.path(), "a", &at("all")).expect("a sound scene");
    collect_into_file(&scene, folder.path(), &at("whole.ron")).expect("a sound scene");
    let names = ["tent/tent.obj", "tent/mats/red cloth.png", "tent/mats/tent.mtl"];
    let models: Vec<PathBuf> = names.iter().map(|name| at("all").join("models").join(name)).collect();
    assert_eq!(collected.models, models, "where the model looks for them");
    drop(folder);
    for file in [collected.scene, at("whole.ron")] {
        let mut session = Session::open(Opened::from_file(&file).expect("a scene"), &()).expect("it has all");
        assert_eq!(session.warnings(), [""; 0], "{}", file.display());
        assert_eq!(pictures(&mut session)[0].levels()[0].rgba, TEXELS.concat(), "{}", file.display());
    }
}

#[test]
fn a_missing_picture_is_told_and_nothing_else_is_missing() {
    let folder = folder();
    std::fs::remove_file(folder.path().join("mats/red cloth.png")).expect("it is there");
    let mut session = session(scene(&[4]), folder.path());
    assert_eq!(session.warnings(), ["no picture from red cloth.png, plain colours instead: it does not exist"]);
    assert_eq!(pictures(&mut session).len(), 0);
    let elsewhere = tempfile::tempdir().expect("a folder");
    let whole = elsewhere.path().join("whole.ron");
    collect_into_file(session.scene(), folder.path(), &whole).expect("what there is");
    assert_eq!(Scene::load(&whole).expect("a scene").models.files().len(), 2, "the model and its material");
}
