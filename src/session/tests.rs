//! What a person does to a sandbox, without a window.

use std::sync::Arc;

use super::state_error::StateFileError;
use super::*;
use crate::extract;
use crate::math::FRAME;
use crate::physics::{BodyMemory, LinkLoad, RecoveryAccount, Strain};
use crate::scene::body::CubeShape;
use crate::scene::edit::{BodyId, Edit, ObstacleId};
use crate::scene::obstacle::Mesh;
use crate::scene::presets::preset;
use crate::scene::{Body, Material, Obstacle, ObstacleShape, Shape};
use crate::view::SafeArea;
use crate::view::style::Tint;

const PLENTY: Duration = Duration::MAX;

fn session(name: &str) -> Session {
    let preset = preset(name).expect("a preset of this name");
    Session::new((preset.build)(), PathBuf::new(), name.to_owned()).expect("presets resolve")
}

fn edited_body(session: &Session, change: impl FnOnce(&mut Body)) -> Command {
    let mut body = session.scene().bodies[0].clone();
    change(&mut body);
    Command::Edit(Edit::Body(BodyId(0), Box::new(body)))
}

fn first_place(session: &Session) -> glam::Vec3 {
    session.simulation().state().position[0]
}

#[test]
fn a_second_of_frames_is_a_second_of_steps_and_a_pause_is_none() {
    let mut session = session("cube-on-plane");
    (0..30).for_each(|_| session.advance(FRAME, PLENTY));
    assert_eq!(session.simulation().state().steps, 500, "30 frames at 1 ms steps");
    session.handle(Command::Pause).expect("pausing is always possible");
    session.advance(FRAME, PLENTY);
    assert_eq!(session.simulation().state().steps, 500, "a paused sandbox stays");
}

#[test]
fn any_frame_rate_gives_the_same_bits() {
    let hash = |frames_ms: &[u64]| {
        let (mut session, mut left_ms) = (session("stack"), 600);
        for frame_ms in frames_ms.iter().cycle() {
            let frame_ms = left_ms.min(*frame_ms);
            session.advance(Duration::from_millis(frame_ms), PLENTY);
            left_ms -= frame_ms;
            if left_ms == 0 {
                break;
            }
        }
        assert_eq!(session.simulation().state().steps, 600, "0.6 s at 1 ms steps in frames of {frames_ms:?} ms");
        session.simulation().hash()
    };
    let steady = hash(&[10]);
    for frames_ms in [&[1][..], &[7], &[16, 17, 17], &[33], &[2, 40, 5, 1, 23]] {
        assert_eq!(hash(frames_ms), steady, "frames of {frames_ms:?} ms");
    }
}

#[test]
fn a_budget_of_nothing_takes_no_step_and_the_window_goes_on() {
    let mut session = session("cube-on-plane");
    session.advance(FRAME, Duration::ZERO);
    assert_eq!(session.simulation().state().steps, 0, "no time, no step");
}

#[test]
fn a_change_that_nobody_waits_for_any_more_leaves_everything_as_it_was() {
    let mut session = session("cube-on-plane");
    assert!(session.step(), "it falls");
    let seen = |session: &Session| (session.scene().clone(), session.simulation().hash());
    let finer = edited_body(&session, |body| body.shape = Shape::Cube(CubeShape { cells: 12, size: 1.0 }));
    let (before, left) = (seen(&session), Arc::new(Progress::default()));
    left.cancel();
    let stopped = session.handle_awaited(finer.clone(), &left);
    assert!(matches!(stopped, Err(SessionError::ChangeStopped)), "{stopped:?}");
    assert_eq!(left.particles(), 13 * 13 * 13, "how large it would have been is known");
    assert!(seen(&session) == before && session.status().undo.is_empty(), "there is nothing to take back");
    session.handle_awaited(finer, &Arc::default()).expect("it is waited for");
    assert_eq!(session.simulation().model().particle_count(), 13 * 13 * 13);
    let made = seen(&session);
    let stopped = session.handle_awaited(Command::Undo, &left);
    assert!(matches!(stopped, Err(SessionError::ChangeStopped)), "{stopped:?}");
    assert!(seen(&session) == made && !session.status().undo.is_empty(), "it can still be taken back");
    session.handle(Command::Undo).expect("one step back");
    assert!(seen(&session) == before, "with its motion");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("tent.obj");
    std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 0 1 0\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n").expect("a file");
    let mesh = ObstacleShape::Mesh(Mesh { path: path.to_string_lossy().into_owned(), ..Mesh::default() });
    let place = ObstacleId(session.scene().obstacles.len());
    let tent = Obstacle { shape: mesh, ..Obstacle::default() };
    let insert = Command::Edit(Edit::InsertObstacle(place, Box::new(tent)));
    let stopped = session.handle_awaited(insert.clone(), &left);
    assert!(matches!(stopped, Err(SessionError::ChangeStopped)), "nor does the model of an obstacle come: {stopped:?}");
    assert!(seen(&session) == before, "everything is as it was");
    session.handle_awaited(insert, &Arc::default()).expect("it is waited for");
}

#[test]
fn live_material_keeps_the_motion_and_restart_takes_it_back() {
    let mut session = session("cube-on-plane");
    let start = first_place(&session);
    (0..200).for_each(|_| assert!(session.step(), "the preset is stable"));
    let (before, velocity) = (first_place(&session), session.simulation().state().velocity[0]);
    let softer = edited_body(&session, |body| {
        let Material::Springs(springs) = &mut body.material else { return };
        springs.shear.stiffness *= 0.5;
    });
    session.handle(softer).expect("half the stiffness is in range");
    assert_eq!(first_place(&session), before, "the motion goes on from where it was");
    assert_eq!(session.simulation().state().velocity[0], velocity, "with the speed it had");
    session.handle(Command::Restart).expect("restarting is always possible");
    assert_eq!(first_place(&session), start, "back at the start");
}

#[test]
fn a_restart_forgets_the_contacts_there_were() {
    let mut session = session("cube-on-plane");
    (0..2000).find(|_| session.step() && session.status().contacts > 0).expect("it lands");
    session.handle(Command::Restart).expect("restarting is always possible");
    assert_eq!(session.status().contacts, 0, "it is in the air again");
}

#[test]
fn a_second_body_leaves_the_first_where_it_is() {
    let mut session = session("cube-on-plane");
    (0..100).for_each(|_| assert!(session.step(), "the preset is stable"));
    let before = first_place(&session);
    let mut second = session.scene().bodies[0].clone();
    second.pose.position = [3.0, 2.0, 0.0];
    session.handle(Command::Edit(Edit::InsertBody(BodyId(1), Box::new(second)))).expect("a second cube");
    assert_eq!(first_place(&session), before, "the first goes on");
    assert_eq!(session.draw_list().skins.len(), 2, "both are drawn");
    session.handle(Command::Edit(Edit::RemoveBody(BodyId(1)))).expect("away with it");
    assert_eq!(first_place(&session), before, "the first still goes on");
}

#[test]
fn a_refused_edit_changes_nothing() {
    let mut session = session("cube-on-plane");
    let scene = session.scene().clone();
    let impossible = edited_body(&session, |body| body.pose.position[0] = f64::NAN);
    assert!(session.handle(impossible).is_err(), "NaN is no place");
    assert_eq!(session.scene(), &scene, "the document is untouched");
    assert!(session.handle(Command::SetSpeed(0.0)).is_err(), "a speed of zero is a pause");
}

#[test]
fn colours_that_are_off_are_not_computed() {
    let mut session = session("cube-on-plane");
    session.step();
    assert!(session.draw_list().scalars.is_none(), "plain has no scalars");
    let first = session.draw_list();
    assert!(Arc::ptr_eq(&first.particles, &session.draw_list().particles), "nothing moved, nothing is copied");
    session.step();
    assert!(!Arc::ptr_eq(&first.particles, &session.draw_list().particles), "a step moves the picture");
}

#[test]
fn a_state_goes_to_bytes_and_back_bit_for_bit() {
    let mut session_a = session("cube-on-plane");
    (0..700).for_each(|_| assert!(session_a.step(), "the preset is stable"));
    let bytes = session_a.state_bytes();
    let mut session_b = session("cube-on-plane");
    session_b.set_state_bytes(&bytes).expect("a state of the same scene");
    for _ in 0..200 {
        session_a.step();
        session_b.step();
    }
    assert_eq!(session_a.simulation().hash(), session_b.simulation().hash(), "both go on alike");
}

#[test]
fn what_is_remembered_of_a_body_goes_to_bytes_and_back() {
    let mut session_a = session("cube-on-plane");
    let mut state = session_a.simulation().state().clone();
    for (strain, stuck, knotted_nanos) in
        [(Strain::Large, false, 0), (Strain::Small, true, 0), (Strain::Taut, true, 98_765_432)]
    {
        let (before, near_inversion) = (state.bodies[0].clone(), vec![1, 5]);
        let calm_substeps = if strain > Strain::Small { 77 } else { 0 };
        let known = LinkLoad { stiffness: 2e6, damping: 300.5 };
        let load = if strain == Strain::Taut { known } else { LinkLoad::default() };
        let account = RecoveryAccount { taken_j: 0.25, pull_share: if stuck { 0.75 } else { 0.0 } };
        state.bodies[0] =
            BodyMemory { near_inversion, strain, calm_substeps, load, knotted_nanos, stuck, account, ..before };
        session_a.replace_state(state.clone());
        let mut session_b = session("cube-on-plane");
        session_b.set_state_bytes(&session_a.state_bytes()).expect("a state of the same scene");
        assert_eq!(session_b.simulation().state().bodies, state.bodies, "the same is remembered");
    }
}

#[test]
fn what_sleeps_is_not_copied_for_a_picture_and_looking_at_it_does_not_wake_it() {
    let mut session = session("tree");
    let steps = (0..20_000).take_while(|_| session.step() && !session.status().bodies[0].asleep).count();
    assert!((1000..20_000).contains(&steps), "it falls, rests and sleeps: {steps} ms");
    let first = session.draw_list();
    let rests_at = session.status().time_secs;
    session.handle(Command::Play).expect("it plays");
    session.advance(Duration::from_secs(1), Duration::from_secs(1));
    let status = session.status();
    assert!(status.at_rest && status.time_secs.to_bits() == rests_at.to_bits(), "time stands still at {rests_at} s");
    assert!(Arc::ptr_eq(&first.particles, &session.draw_list().particles), "the picture is the one before");
    let mut view = session.scene().view.clone();
    view.color = crate::scene::ColorBy::Contact;
    session.handle(Command::Edit(Edit::View(view))).expect("a view can be changed");
    let shown = session.draw_list().scalars.expect("colours are on");
    assert!(shown.iter().sum::<f32>() > 1.0, "its contacts are still to be seen");
    assert!(session.status().bodies[0].asleep, "a look wakes nothing");
    session.handle(edited_body(&session, |body| body.pose.position[1] += 1.0)).expect("it can be lifted");
    assert!(session.step() && !session.status().bodies[0].asleep, "a hand does");
    session.advance(Duration::from_millis(20), Duration::from_secs(1));
    let status = session.status();
    assert!(!status.at_rest && status.time_secs > rests_at, "time goes on from there");
    assert!(status.time_secs < rests_at + 0.1, "and makes up for nothing: {} s", status.time_secs);
}

#[test]
fn the_cube_that_rolls_off_its_ball_stays_in_the_picture() {
    let mut session = session("cube-on-sphere");
    let orbit = extract::view::orbit(&session.scene().view.camera);
    // As wide as the view between the panels.
    let area = SafeArea::whole(1.1);
    while session.status().time_secs < 5.0 {
        session.advance(FRAME, PLENTY);
        let bodies = session.draw_list().body_bounds();
        assert!(orbit.shows(bodies, area), "after {:.2} s: {bodies:?}", session.status().time_secs);
    }
}

#[test]
fn damaged_and_foreign_states_are_refused() {
    let bytes = session("cube-on-plane").state_bytes();
    let refused = |bytes: &[u8]| session("cube-on-plane").set_state_bytes(bytes).expect_err("this must be refused");
    for place in [20, 60, bytes.len() / 2, bytes.len() - 1] {
        let mut damaged = bytes.clone();
        damaged[place] ^= 1;
        assert_eq!(refused(&damaged), StateFileError::Damaged, "one bit at {place}");
    }
    assert_eq!(refused(&bytes[..bytes.len() / 2]), StateFileError::Damaged, "half a file");
    assert_eq!(refused(b"hello"), StateFileError::NotAState, "something else");
    assert!(matches!(refused(b"gelatin-state 17\n"), StateFileError::OtherVersion { .. }), "a later version");
    let other = session("cube-on-sphere").state_bytes();
    let words = session("coupler-7").set_state_bytes(&other).expect_err("another scene's").to_string();
    assert!(
        words.contains("saved from cube-on-sphere") && words.contains("its body Jelly has 1000 particles"),
        "{words}"
    );
}

#[test]
fn a_state_saved_in_the_middle_of_a_motion_is_opened_again_and_goes_on_bit_for_bit() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("falling.state");
    let mut first = session("cube-on-sphere");
    first.advance(Duration::from_millis(700), PLENTY);
    let (saved, time) = (first.simulation().hash(), first.status().time_secs);
    first.handle(Command::SaveState { path: path.clone() }).expect("the folder can be written");
    first.advance(Duration::from_millis(300), PLENTY);
    let gone_on = first.simulation().hash();
    assert_ne!(gone_on, saved, "time went on");
    for session in [&mut first, &mut session("cube-on-sphere")] {
        session.handle(Command::OpenState { path: path.clone() }).expect("a state of this scene");
        let status = session.status();
        assert_eq!((session.simulation().hash(), status.time_secs, status.playing), (saved, time, false), "as it was");
        assert!(!status.unsaved && status.undo.is_empty(), "the scene is not touched");
        session.handle(Command::Play).expect("time can run");
        session.advance(Duration::from_millis(300), PLENTY);
        assert_eq!(session.simulation().hash(), gone_on, "the same motion");
    }
}

#[test]
fn a_state_that_does_not_fit_changes_nothing_and_says_which_scene_it_needs() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("cube.state");
    let mut saving = session("cube-on-plane");
    saving.handle(Command::SaveState { path: path.clone() }).expect("the folder can be written");
    assert_eq!(state_file::summary(&path).expect("a state").scene, "cube-on-plane");
    let mut spot = session("coupler-7");
    (0..50).for_each(|_| assert!(spot.step(), "it falls"));
    let before = spot.simulation().hash();
    let refused = |session: &mut Session, path: &std::path::Path| {
        let error = session.handle(Command::OpenState { path: path.to_owned() }).expect_err("it does not fit");
        format!("{error}: {}", std::error::Error::source(&error).expect("a cause"))
    };
    let words = refused(&mut spot, &path);
    assert!(words.contains("cube.state") && words.contains("saved from cube-on-plane"), "{words}");
    assert!(refused(&mut spot, folder.path()).contains("is a folder"), "no file");
    assert_eq!(spot.simulation().hash(), before, "nothing has moved");
    assert!(spot.status().playing, "time still runs");
    let lost = Command::SaveState { path: folder.path().join("none/a.state") };
    assert!(spot.handle(lost).is_err(), "there is no such folder");
}

#[test]
fn too_large_a_manual_step_pauses_on_the_last_good_state_and_says_why() {
    let mut session = session("cube-on-plane");
    let mut settings = session.scene().settings.clone();
    settings.stepping = crate::scene::settings::Stepping::Manual;
    settings.dt = 0.05;
    session.handle(Command::Edit(Edit::Settings(settings))).expect("50 ms is in range");
    for _ in 0..2000 {
        session.advance(Duration::from_millis(50), Duration::from_secs(1));
    }
    let status = session.status();
    let trouble = status.trouble.expect("it says what was wrong");
    assert!(!status.playing && trouble.words.contains("step of 50.0 ms"), "it stops and names the step: {trouble:?}");
    assert!(session.simulation().diagnostics().finite, "the picture stays whole");
}

#[test]
fn the_exploding_preset_explodes_soon_names_the_cause_and_every_cure_cures_it() {
    let mut exploding = session("exploding");
    let steps = (0..2000).take_while(|_| exploding.step()).count();
    assert!((100..1000).contains(&steps), "it falls well and explodes within a second: {steps} ms");
    let diagnostics = exploding.simulation().diagnostics();
    assert!(diagnostics.finite && diagnostics.max_speed < 1e4, "it is stopped while there is something to see");
    let trouble = exploding.status().trouble.expect("the explosion is explained");
    assert!(trouble.words.contains("structural stiffness of 1010 N"), "the cause is named: {}", trouble.words);
    let guilty = &trouble.guilty_links;
    assert!(!guilty.is_empty() && guilty.len() < 2000, "some of the structural links are at fault: {}", guilty.len());
    let marked = |session: &mut Session| session.draw_list().overlay.lines.iter().any(|l| l.tint == Tint::Broken);
    assert!(marked(&mut exploding), "and marked in the picture");
    assert!(trouble.cures.is_empty() && trouble.looking, "nothing is offered before it is tried");
    exploding.find_cures();
    let cures = exploding.status().trouble.expect("it is still explained").cures;
    assert!(cures.len() >= 3, "{cures:?}");
    for cure in &cures {
        let mut session = session("exploding");
        while session.step() {}
        for command in cure.commands() {
            session.handle(command).expect("a cure is allowed");
        }
        assert!(session.status().playing && session.status().trouble.is_none(), "{}: it runs again", cure.words);
        assert!(!marked(&mut session), "{}: nothing is marked any more", cure.words);
        assert!((0..3000).all(|_| session.step()), "{}: three seconds later it still stands", cure.words);
    }
}

#[test]
fn the_broken_preset_stays_broken_says_so_and_is_turned_back_while_it_runs() {
    let mut broken = session("broken");
    (0..4000).for_each(|_| assert!(broken.step(), "it does not explode"));
    let trouble = broken.status().trouble.expect("it says that it is broken");
    assert!(trouble.words.contains("inside out"), "{}", trouble.words);
    assert!(broken.simulation().diagnostics().inverted_cells > 50, "many cells are inside out");
    broken.find_cures();
    let cures = broken.status().trouble.expect("it is still broken").cures;
    for command in cures[0].commands() {
        broken.handle(command).expect("a cure is allowed");
    }
    (0..8000).for_each(|_| assert!(broken.step(), "it does not explode"));
    assert_eq!(broken.simulation().diagnostics().inverted_cells, 0, "all cells are whole again");
    assert!(broken.status().trouble.is_none(), "nothing is left to say");
}

/// The default scene once the cube has come to rest, and its ground.
fn rested() -> (Session, crate::scene::Obstacle) {
    let mut session = session("cube-on-plane");
    (0..1500).for_each(|_| assert!(session.step(), "the preset is stable"));
    let is_plane = |obstacle: &&crate::scene::Obstacle| matches!(obstacle.shape, crate::scene::ObstacleShape::Plane(_));
    let ground = session.scene().obstacles.iter().find(is_plane).cloned().expect("there is a ground");
    (session, ground)
}

/// The largest strain of the next two seconds, and the cells that are inverted at their end.
fn strained(session: &mut Session) -> (f64, usize) {
    let mut strain = 0.0_f64;
    for _ in 0..2000 {
        assert!(session.step(), "the preset is stable");
        strain = strain.max(session.simulation().diagnostics().max_strain);
    }
    (strain, session.simulation().diagnostics().inverted_cells)
}

#[test]
fn a_plane_typed_through_the_cube_is_no_blow_and_a_plane_dragged_through_it_is() {
    let through = |dragged: bool| {
        let (mut session, mut wall) = rested();
        let id = ObstacleId(session.scene().obstacles.len());
        let crate::scene::ObstacleShape::Plane(plane) = &mut wall.shape else { panic!("a plane") };
        (plane.center, plane.rotation_deg, plane.half_extents) = ([3.0, 0.5, 0.0], [0.0, 0.0, 90.0], [2.0; 2]);
        session
            .handle(Command::Edit(Edit::InsertObstacle(id, Box::new(wall.clone()))))
            .expect("a wall beside the cube");
        assert_eq!(strained(&mut session).1, 0, "it stands beside it");
        let middle = session.status().bodies[0].center[0];
        let crate::scene::ObstacleShape::Plane(plane) = &mut wall.shape else { panic!("a plane") };
        plane.center[0] = middle + 0.1;
        let edit = Edit::Obstacle(id, Box::new(wall));
        session.handle(if dragged { Command::Drag(edit) } else { Command::Edit(edit) }).expect("in range");
        let seen = strained(&mut session);
        session.handle(Command::Undo).expect("back");
        (seen, strained(&mut session))
    };
    let ((strain, inverted), (strain_undone, inverted_undone)) = through(false);
    assert!(strain < 0.5 && inverted == 0, "typed: {strain}, {inverted} inverted");
    assert!(strain_undone < 0.5 && inverted_undone == 0, "undone: {strain_undone}, {inverted_undone} inverted");
    assert!(through(true).0.0 > 0.8, "dragged at 200 m/s it pushes with all its might");
}

#[test]
fn undo_of_what_was_dragged_is_no_blow() {
    let (mut session, mut wall) = rested();
    let id = ObstacleId(session.scene().obstacles.len());
    let middle = session.status().bodies[0].center[0];
    let crate::scene::ObstacleShape::Plane(plane) = &mut wall.shape else { panic!("a plane") };
    (plane.center, plane.rotation_deg, plane.half_extents) = ([middle + 0.6, 0.5, 0.0], [0.0, 0.0, 90.0], [2.0; 2]);
    session.handle(Command::Edit(Edit::InsertObstacle(id, Box::new(wall.clone())))).expect("a wall beside the cube");
    session.handle(Command::EndEdit).expect("always possible");
    // Dragged away, the cube pulled after it to where the wall was.
    let crate::scene::ObstacleShape::Plane(plane) = &mut wall.shape else { panic!("a plane") };
    plane.center[0] += 2.0;
    session.handle(Command::Drag(Edit::Obstacle(id, Box::new(wall)))).expect("in range");
    session.handle(Command::EndEdit).expect("always possible");
    let mut state = session.simulation().state().clone();
    state.position.iter_mut().for_each(|at| at.x += 0.6);
    session.replace_state(state);
    session.handle(Command::Undo).expect("back");
    let (strain, inverted) = strained(&mut session);
    assert!(strain < 0.5 && inverted == 0, "{strain}, {inverted} inverted");
}

#[test]
fn an_obstacle_on_its_way_goes_to_bytes_and_back() {
    let (mut session_a, mut wall) = rested();
    let crate::scene::ObstacleShape::Plane(plane) = &mut wall.shape else { panic!("a plane") };
    let middle = session_a.status().bodies[0].center[0];
    (plane.center, plane.rotation_deg) = ([middle + 0.1, 0.5, 0.0], [0.0, 0.0, 90.0]);
    let id = crate::scene::edit::ObstacleId(session_a.scene().obstacles.len());
    session_a.handle(Command::Edit(Edit::InsertObstacle(id, Box::new(wall)))).expect("in range");
    (0..50).for_each(|_| assert!(session_a.step(), "the preset is stable"));
    assert_eq!(session_a.simulation().state().approaches.len(), 1, "it is on its way");
    let mut session_b = Session::new(session_a.scene().clone(), PathBuf::new(), String::new()).expect("resolves");
    session_b.set_state_bytes(&session_a.state_bytes()).expect("a state of the same scene");
    for _ in 0..300 {
        session_a.step();
        session_b.step();
    }
    assert_eq!(session_a.simulation().hash(), session_b.simulation().hash(), "both go on alike");
}
