//! Changes that are made, taken back and made again, with the motion that hangs on them.

use std::path::PathBuf;

use glam::{DVec3, Vec3};

use super::{Command, Pull, Session};
use crate::scene::body::PinBox;
use crate::scene::edit::{BodyId, Edit, ObstacleId};
use crate::scene::obstacle::ObstacleShape;
use crate::scene::presets::preset;
use crate::scene::{Body, Material, Obstacle};

fn session(name: &str) -> Session {
    let preset = preset(name).expect("a preset of this name");
    Session::new((preset.build)(), PathBuf::new(), name.to_owned()).expect("presets resolve")
}

fn run(session: &mut Session, steps: usize) {
    (0..steps).for_each(|_| assert!(session.step(), "the scene is stable"));
}

fn change(session: &mut Session, change: impl FnOnce(&mut Body)) {
    let mut body = session.scene().bodies[0].clone();
    change(&mut body);
    session.handle(Command::Edit(Edit::Body(BodyId(0), Box::new(body)))).expect("the change is allowed");
}

fn drag_obstacle(session: &mut Session, place: usize, change: impl FnOnce(&mut Obstacle)) {
    let mut obstacle = session.scene().obstacles[place].clone();
    change(&mut obstacle);
    session.handle(Command::Drag(Edit::Obstacle(ObstacleId(place), Box::new(obstacle)))).expect("it is allowed");
}

fn set_shear(session: &mut Session, stiffness: f64) {
    change(session, |body| {
        let Material::Springs(springs) = &mut body.material else { return };
        springs.shear.stiffness = stiffness;
    });
}

fn shear(session: &Session) -> f64 {
    let Material::Springs(springs) = &session.scene().bodies[0].material else { return f64::NAN };
    springs.shear.stiffness
}

fn undo(session: &mut Session) {
    session.handle(Command::Undo).expect("what was done can be undone");
}

fn center(session: &Session) -> DVec3 {
    session.status().bodies[0].center.into()
}

fn lowest(session: &Session) -> f32 {
    session.simulation().state().position.iter().fold(f32::INFINITY, |lowest, at| lowest.min(at.y))
}

#[test]
fn a_drag_that_is_cancelled_was_never_made() {
    let mut session = session("cube-on-plane");
    set_shear(&mut session, 20.0);
    session.handle(Command::EndEdit).expect("letting go is always possible");
    let before = session.scene().clone();
    for tick in 1..5 {
        drag_obstacle(&mut session, 1, |ball| {
            let ObstacleShape::Sphere(sphere) = &mut ball.shape else { return };
            sphere.center[1] += 0.1 * f64::from(tick);
        });
    }
    assert_ne!(session.scene(), &before, "it was dragged");
    session.handle(Command::CancelEdit).expect("it goes back");
    assert_eq!(session.scene(), &before, "as if never dragged");
    assert_eq!((session.status().undo.as_str(), session.status().redo.as_str()), ("shear stiffness of Jelly", ""));
    session.handle(Command::Undo).expect("it goes back");
    let redo = session.status().redo;
    for _ in 0..2 {
        drag_obstacle(&mut session, 1, |ball| ball.hidden = !ball.hidden);
        session.handle(Command::CancelEdit).expect("it goes back");
        assert_eq!(session.status().redo, redo, "what was taken back can still be made again");
    }
    session.handle(Command::Redo).expect("it is made again");
    assert_eq!(session.scene(), &before, "to the last value");
    session.handle(Command::CancelEdit).expect("nothing goes on");
    assert_eq!(session.scene(), &before, "what a person had let go before stays");
}

#[test]
fn a_value_that_is_dragged_is_taken_back_as_one() {
    let mut session = session("cube-on-plane");
    let before = session.scene().clone();
    (0..20).for_each(|tick| set_shear(&mut session, 10.0 + f64::from(tick)));
    session.handle(Command::EndEdit).expect("letting go is always possible");
    (0..20).for_each(|tick| set_shear(&mut session, 50.0 + f64::from(tick)));
    assert_eq!(session.status().undo, "shear stiffness of Jelly");
    undo(&mut session);
    assert!((shear(&session) - 29.0).abs() < 1e-12, "the second drag is gone, the first is not");
    undo(&mut session);
    assert_eq!(session.scene(), &before, "both are gone");
    assert_eq!(session.status().undo, "", "nothing is left to take back");
    session.handle(Command::Redo).expect("what was undone can be done again");
    session.handle(Command::Redo).expect("what was undone can be done again");
    assert!((shear(&session) - 69.0).abs() < 1e-12, "both are back");
    assert_eq!(session.status().redo, "", "nothing is left to do again");
}

#[test]
fn another_value_of_the_same_body_is_another_change() {
    let mut session = session("cube-on-plane");
    set_shear(&mut session, 10.0);
    change(&mut session, |body| body.name = "Pudding".into());
    undo(&mut session);
    assert_eq!(session.scene().bodies[0].name, "Jelly", "the name alone is taken back");
    assert!((shear(&session) - 10.0).abs() < 1e-12, "the stiffness stays");
}

#[test]
fn a_new_change_forgets_what_was_taken_back_and_an_empty_one_is_none() {
    let mut session = session("cube-on-plane");
    set_shear(&mut session, 10.0);
    undo(&mut session);
    change(&mut session, |_| ());
    assert_eq!(session.status().redo, "shear stiffness of Jelly", "a change of nothing is no change");
    set_shear(&mut session, 20.0);
    assert_eq!(session.status().redo, "", "now there is another way ahead");
}

#[test]
fn a_teleport_keeps_the_form_stops_the_body_and_undo_restores_both() {
    let mut session = session("cube-on-plane");
    run(&mut session, 700);
    let before = session.simulation().state().clone();
    let target = DVec3::new(2.0, 3.0, -1.0);
    change(&mut session, |body| body.pose.position = target.to_array());
    let after = session.simulation().state();
    assert!(center(&session).distance(target) < 1e-5, "the centre is where it was put");
    let shape = |at: &[Vec3]| at.iter().map(|point| *point - at[0]).collect::<Vec<_>>();
    let bent = shape(&after.position).into_iter().zip(shape(&before.position)).map(|(a, b)| a.distance(b));
    assert!(bent.fold(0.0, f32::max) < 1e-5, "it is bent as it was");
    assert!(after.velocity.iter().all(|v| *v == Vec3::ZERO), "and at rest");
    undo(&mut session);
    assert_eq!(session.simulation().state(), &before, "back where it was, as fast as it was, touching what it did");
}

#[test]
fn a_teleport_to_where_the_body_starts_brings_it_back_there() {
    let mut session = session("cube-on-plane");
    run(&mut session, 700);
    let before = session.simulation().state().clone();
    let start = session.scene().bodies[0].pose.position;
    session.handle(Command::Teleport(BodyId(0), start)).expect("a place");
    assert!(center(&session).distance(start.into()) < 1e-5, "it is where it started, though its start is unchanged");
    undo(&mut session);
    assert_eq!(session.simulation().state(), &before, "and back again");
    session.handle(Command::Redo).expect("what was undone can be done again");
    assert!(center(&session).distance(start.into()) < 1e-5, "and there again");
    session.handle(Command::Teleport(BodyId(7), start)).expect_err("there is no such body");
}

#[test]
fn a_body_without_a_name_is_called_by_its_place() {
    let mut session = session("cube-on-plane");
    change(&mut session, |body| body.name.clear());
    session.handle(Command::Teleport(BodyId(0), [0.0, 2.0, 0.0])).expect("a place");
    assert_eq!(session.status().undo, "teleport body 1");
}

#[test]
fn before_time_runs_a_moved_start_is_the_start() {
    let mut moved = session("cube-on-plane");
    change(&mut moved, |body| (body.pose.position[1], body.velocity[0]) = (2.0, 1.0));
    let fresh = Session::new(moved.scene().clone(), PathBuf::new(), String::new()).expect("the same scene");
    assert_eq!(moved.simulation().hash(), fresh.simulation().hash(), "as if it had been opened so");
}

#[test]
fn a_new_velocity_throws_the_body_as_it_is() {
    let mut session = session("cube-on-plane");
    run(&mut session, 300);
    let before = session.simulation().state().position.clone();
    change(&mut session, |body| body.velocity = [0.0, 5.0, 0.0]);
    let state = session.simulation().state();
    assert_eq!(state.position, before, "it is where it was");
    assert!(state.velocity.iter().all(|v| *v == Vec3::Y * 5.0), "and flies up");
}

#[test]
fn pins_and_a_new_place_at_once_do_both() {
    let mut session = session("cube-on-plane");
    run(&mut session, 10);
    change(&mut session, |body| {
        body.pins.push(PinBox { min: [-9.0, 0.4, -9.0], max: [9.0, 9.0, 9.0] });
        body.pose.position = [0.0, 4.0, 0.0];
    });
    assert!(center(&session).distance(DVec3::Y * 4.0) < 1e-3, "it is at its new place");
    run(&mut session, 200);
    assert!(center(&session).y > 3.7, "and hangs from its top");
}

#[test]
fn a_removed_body_comes_back_moving_as_it_did() {
    let mut session = session("cube-on-plane");
    run(&mut session, 900);
    let before = session.simulation().state().clone();
    session.handle(Command::Edit(Edit::RemoveBody(BodyId(0)))).expect("it is there");
    assert_eq!(session.simulation().state().position.len(), 0, "nothing is left");
    undo(&mut session);
    assert_eq!(session.simulation().state(), &before, "where it was, as fast as it was");
    run(&mut session, 100);
    assert!(lowest(&session) > -0.05, "it still stands on the ground");
}

#[test]
fn another_body_leaves_one_at_rest_on_the_ground() {
    let mut session = session("cube-on-plane");
    run(&mut session, 2500);
    let mut second = session.scene().bodies[0].clone();
    second.pose.position = [4.0, 2.0, 0.0];
    session.handle(Command::Edit(Edit::InsertBody(BodyId(0), Box::new(second)))).expect("a second cube");
    run(&mut session, 500);
    assert!(lowest(&session) > -0.05, "neither has fallen through the ground");
}

#[test]
fn edits_in_the_middle_of_expensive_steps_do_not_stop_time() {
    let mut session = session("cube-on-plane");
    let mut divided = session.scene().settings.clone();
    divided.allow_implicit = false;
    session.handle(Command::Edit(Edit::Settings(divided))).expect("a setting");
    set_shear(&mut session, 1e6);
    let substeps = session.status().substeps;
    assert!(substeps > 20, "the step is divided into {substeps}");
    for tick in 0..200 {
        session.simulation.substep(&mut ());
        set_shear(&mut session, 1e6 + f64::from(tick));
    }
    let state = session.simulation().state();
    assert!(state.steps >= u64::from(150 / substeps), "{} steps in 200 of {substeps} substeps", state.steps);
}

#[test]
fn ground_that_is_moved_while_paused_still_carries() {
    let mut session = session("cube-on-plane");
    run(&mut session, 2500);
    session.handle(Command::Pause).expect("pausing is always possible");
    drag_obstacle(&mut session, 0, |ground| {
        let ObstacleShape::Plane(plane) = &mut ground.shape else { panic!("the ground is a plane") };
        plane.center[0] += 0.3;
        plane.center[1] += 0.002;
    });
    run(&mut session, 500);
    assert!(lowest(&session) > -0.02, "nothing fell through: {}", lowest(&session));
}

#[test]
fn ground_that_is_lifted_while_time_runs_takes_the_body_along() {
    let mut session = session("cube-on-plane");
    run(&mut session, 2500);
    for _ in 0..30 {
        drag_obstacle(&mut session, 0, |ground| {
            let ObstacleShape::Plane(plane) = &mut ground.shape else { panic!("the ground is a plane") };
            plane.center[1] += 0.05;
        });
        run(&mut session, 17);
    }
    run(&mut session, 3000);
    let low = lowest(&session);
    assert!((1.45..1.52).contains(&low), "the cube stands on the ground lifted to 1.5 m, not at {low}");
}

#[test]
fn a_ball_that_is_dragged_through_a_body_pushes_it_aside() {
    let mut session = session("cube-on-plane");
    run(&mut session, 2500);
    let before = center(&session);
    for _ in 0..40 {
        drag_obstacle(&mut session, 1, |ball| {
            let ObstacleShape::Sphere(sphere) = &mut ball.shape else { panic!("it is a ball") };
            sphere.center[0] -= 0.05;
        });
        run(&mut session, 17);
    }
    let pushed = before.x - center(&session).x;
    assert!(pushed > 0.5, "the ball went 2 m and pushed the cube {pushed} m");
    let ObstacleShape::Sphere(ball) = session.scene().obstacles[1].shape else { panic!("it is a ball") };
    let inside = session.simulation().state().position.iter();
    let deepest = inside.fold(f64::INFINITY, |deepest, at| deepest.min(at.as_dvec3().distance(ball.center.into())));
    assert!(deepest > 0.9 * ball.radius, "no particle is deep in the ball: {deepest} of {}", ball.radius);
}

#[test]
fn an_upright_plane_dragged_fast_catches_every_particle() {
    let mut session = session("cube-on-plane");
    run(&mut session, 2500);
    let wall = ObstacleShape::Plane(crate::scene::obstacle::Plane {
        center: [-2.0, 1.0, 0.0],
        rotation_deg: [0.0, 0.0, -90.0],
        half_extents: [3.0, 3.0],
    });
    let insert = Edit::InsertObstacle(ObstacleId(2), Box::new(Obstacle { shape: wall, ..Obstacle::default() }));
    session.handle(Command::Edit(insert)).expect("a wall");
    // Two metres in one frame: 120 m/s.
    drag_obstacle(&mut session, 2, |wall| {
        let ObstacleShape::Plane(plane) = &mut wall.shape else { panic!("it is a plane") };
        plane.center[0] = 0.0;
    });
    // Its way takes a frame, and what covers several steps ends with the last of them.
    run(&mut session, 20);
    let behind = session.simulation().state().position.iter().filter(|at| at.x < -0.03).count();
    assert_eq!(behind, 0, "no particle is left behind the wall");
}

#[test]
fn a_body_is_pulled_and_let_go() {
    let mut session = session("cube-on-plane");
    run(&mut session, 2500);
    let pull = Pull { body: BodyId(0), weights: vec![(0, 0.5), (1, 0.5)], target: [0.0, 3.0, 0.0] };
    session.handle(Command::Grab(Some(pull.clone()))).expect("the particles are the body's");
    run(&mut session, 1500);
    assert!(lowest(&session) > 0.5, "it hangs from the hand");
    session.handle(Command::Grab(None)).expect("letting go is always possible");
    run(&mut session, 4000);
    assert!(lowest(&session) < 0.05, "it fell and has done bouncing");
    let elsewhere = Pull { weights: vec![(1_000_000, 1.0)], ..pull.clone() };
    session.handle(Command::Grab(Some(elsewhere))).expect_err("there is no such particle");
    let nowhere = Pull { target: [f32::NAN; 3], ..pull };
    session.handle(Command::Grab(Some(nowhere))).expect_err("not a place");
}
