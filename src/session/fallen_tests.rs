//! A body that falls out of the scene, as a person and a script meet it.

use super::*;
use crate::scene::edit::{BodyId, Edit};
use crate::scene::obstacle::Plane;
use crate::scene::{Body, Obstacle, ObstacleShape};

/// A cube that stands on a small floor, and one that falls past it.
fn session() -> Session {
    let named = |name: &str, x: f64| {
        let mut body = Body { name: name.to_owned(), ..Body::default() };
        body.pose.position = [x, 0.51, 0.0];
        body
    };
    let plane = Plane { half_extents: [1.0; 2], ..Plane::default() };
    let scene = Scene {
        bodies: vec![named("Stays", 0.0), named("Falls", 2.5)],
        obstacles: vec![Obstacle { shape: ObstacleShape::Plane(plane), ..Obstacle::default() }],
        ..Scene::default()
    };
    Session::new(scene, PathBuf::new(), String::new()).expect("cubes resolve")
}

fn after_the_fall() -> Session {
    let mut session = session();
    let steps = (0..8000).take_while(|_| !session.status().bodies[1].gone && session.step()).count();
    assert!((1000..8000).contains(&steps), "it falls for a while and is gone: {steps} ms");
    session
}

#[test]
fn it_is_in_no_picture_no_bounds_and_nobodys_way() {
    assert_eq!(session().draw_list().skins[1].skin.triangles().len(), 972, "at first it is seen");
    let mut session = after_the_fall();
    let picture = session.draw_list();
    assert_eq!(picture.skins.len(), 2, "it keeps its place in the list");
    assert!(picture.skins[1].skin.triangles().is_empty(), "but nothing of it is drawn");
    let bounds = picture.body_bounds();
    assert!(bounds.min.y > -0.1 && bounds.max.x < 1.0, "the picture reaches as far as what is there: {bounds:?}");
    let status = session.status();
    assert!(status.bodies[1].bounds.size().x < 0.0 && !status.bodies[0].gone, "{:?}", status.bodies[1].bounds);
}

#[test]
fn a_teleport_to_its_start_brings_it_back_and_undo_takes_that_back() {
    let mut session = after_the_fall();
    let (scene, hash) = (session.scene().clone(), session.simulation().hash());
    let start = scene.bodies[1].pose.position;
    session.handle(Command::Teleport(BodyId(1), start)).expect("it can be anywhere");
    assert!(!session.status().bodies[1].gone, "it is back");
    let center = session.status().bodies[1].center;
    assert!((0..3).all(|axis| (center[axis] - start[axis]).abs() < 1e-5), "at its start: {center:?}");
    assert_eq!(session.draw_list().skins[1].skin.triangles().len(), 972, "and is seen");
    session.handle(Command::Undo).expect("it can be taken back");
    assert_eq!((session.scene(), session.simulation().hash()), (&scene, hash), "gone as before");
    assert!(session.status().bodies[1].gone, "and known to be");
    session.handle(Command::Redo).expect("and made again");
    assert!(!session.status().bodies[1].gone, "back once more");
}

#[test]
fn it_stays_gone_when_others_come_and_go_and_comes_back_with_a_new_start() {
    let mut session = after_the_fall();
    session.handle(Command::Edit(Edit::InsertBody(BodyId(0), Box::default()))).expect("another cube");
    assert!(session.status().bodies[2].gone, "it has another number");
    session.handle(Command::Edit(Edit::RemoveBody(BodyId(2)))).expect("away with it");
    session.handle(Command::Undo).expect("it comes back");
    assert!(session.status().bodies[2].gone, "as it was");
    session.handle(Command::Restart).expect("from the start");
    assert!(!session.status().bodies[2].gone, "everything is at its start");
}

#[test]
fn a_saved_state_remembers_it() {
    let mut fallen = after_the_fall();
    let mut other = session();
    other.set_state_bytes(&fallen.state_bytes()).expect("a state of the same scene");
    assert!(other.status().bodies[1].gone, "it is gone there, too");
    for _ in 0..50 {
        fallen.step();
        other.step();
    }
    assert_eq!(fallen.simulation().state(), other.simulation().state(), "both go on alike");
}

#[test]
fn a_run_counts_it_in_a_warning() {
    let mut session = session();
    let figures = run::run(&mut session, 6.0, &());
    assert_eq!((figures.bodies_gone, figures.bodies), (1, 2));
    let said = figures.warnings.join("; ");
    assert!(said.contains("1 of 2 bodies (Falls) fell past everything"), "{said}");
    assert!(figures.bounds.min[1] > -0.1, "the bounds are those of what is there: {:?}", figures.bounds.min);
}
