//! Parts of a model that are of other solids, edited and taken back.

use std::path::PathBuf;

use super::{Command, Session, SessionError};
use crate::scene::body::{Part, Shape};
use crate::scene::edit::{BodyId, Edit};
use crate::scene::{Body, Material, Solid, presets};

const NAMED: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\no a\nf 1 3 2\nf 1 2 4\nusemtl b\nf 1 4 3\nf 2 3 4\n";

/// A tetrahedron with two parts, and the folder that it is in.
fn tetrahedron() -> (Session, tempfile::TempDir) {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("m.obj"), NAMED).expect("a file");
    let mut scene = presets::drop_model("m.obj");
    let Shape::Model(model) = &mut scene.bodies[0].shape else { panic!("a model") };
    model.divisions = 6;
    scene.bodies[0].material = Material::Solid(Solid::default());
    (Session::new(scene, folder.path().to_owned(), String::new()).expect("a sound scene"), folder)
}

fn edit(session: &mut Session, change: impl FnOnce(&mut Body)) -> Result<(), SessionError> {
    let mut body = Body::clone(&session.scene().bodies[0]);
    change(&mut body);
    session.handle(Command::Edit(Edit::Body(BodyId(0), Box::new(body))))?;
    session.handle(Command::EndEdit)
}

fn part(name: &str) -> Part {
    Part { name: name.to_owned(), solid: Solid { density: 5000.0, ..Solid::default() }, ..Part::default() }
}

#[test]
fn a_part_is_made_of_another_solid_and_taken_back_while_it_moves() {
    let (mut session, _folder) = tetrahedron();
    (0..5).for_each(|_| assert!(session.step(), "it falls"));
    let mass = |session: &Session| session.simulation().diagnostics().mass_kg;
    let (light, height) = (mass(&session), session.simulation().diagnostics().center.y);
    edit(&mut session, |body| body.parts = vec![part("b")]).expect("the model has it");
    assert!(mass(&session) > 1.5 * light, "{light} kg, then {} kg", mass(&session));
    assert!(session.simulation().diagnostics().center.y < height + 0.2, "the motion goes on");
    session.handle(Command::Undo).expect("there is an edit");
    assert!((mass(&session) - light).abs() < 1e-9 && session.scene().bodies[0].parts.is_empty(), "as before");
    session.handle(Command::Redo).expect("there is an edit");
    assert_eq!(session.scene().bodies[0].parts, [part("b")]);
}

#[test]
fn an_edit_to_a_part_that_is_not_there_changes_nothing() {
    let (mut session, _folder) = tetrahedron();
    edit(&mut session, |body| body.parts = vec![part("a")]).expect("the model has it");
    let before = session.scene().bodies[0].clone();
    let said = edit(&mut session, |body| body.parts.push(part("c"))).expect_err("the model has no c").to_string();
    assert!(
        said.ends_with("\"c\" is no part of the model, which has \"a\", \"b\"") && !said.contains("bodies."),
        "{said}"
    );
    let said = edit(&mut session, |body| body.shape = Shape::default()).expect_err("a cube has no parts").to_string();
    assert!(said.contains("only a model has parts"), "{said}");
    assert_eq!(session.scene().bodies[0], before, "as it was");
}

#[test]
fn a_scene_with_a_part_that_is_not_there_does_not_open() {
    let (session, folder) = tetrahedron();
    let mut scene = crate::scene::Scene::clone(session.scene());
    scene.bodies[0].parts = vec![part("wheels")];
    let said = Session::new(scene, PathBuf::from(folder.path()), String::new()).expect_err("no wheels").to_string();
    assert_eq!(said, "bodies.0.parts.0.name = \"wheels\" is no part of the model, which has \"a\", \"b\"");
}
