//! Bodies of a sandbox that move by their modes: waiting for them, moving by them, and what edits, states and files make of it.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use glam::DVec3;

use super::progress::Progress;
use super::wanted_modes::find_modes;
use super::*;
use crate::disk::fnv1a;
use crate::geometry::watch::CancelOnly;
use crate::physics::{ModalState, RigidState};
use crate::scene::body::{CellsShape, CubeShape, PinBox};
use crate::scene::edit::{BodyId, Edit};
use crate::scene::{Body, Material, MovesBy, Obstacle, Pose, Shape, Solid};

/// A cube that is held below and moves by its modes.
fn held() -> Body {
    Body {
        name: "Pudding".to_owned(),
        shape: Shape::Cube(CubeShape { cells: 4, size: 1.0 }),
        material: Material::Solid(Solid::default()),
        velocity: [0.3, 0.0, 0.0],
        pins: vec![PinBox { min: [-9.0; 3], max: [9.0, -0.49, 9.0] }],
        moves_by: MovesBy::Modes,
        mode_count: 10,
        ..Body::default()
    }
}

fn session_of(body: Body) -> Session {
    let scene = Scene { bodies: vec![body], ..Scene::default() };
    Session::new(scene, PathBuf::new(), "pudding".to_owned()).expect("it resolves")
}

fn found() -> Session {
    let mut session = session_of(held());
    session.find_modes(None, &());
    session
}

/// By how many modes the body moves.
fn modes_of(session: &Session) -> Option<usize> {
    session.status().bodies[0].modes_hz.as_ref().map(|modes| modes.len())
}

fn edit(session: &mut Session, change: impl FnOnce(&mut Body)) {
    let mut body = session.scene().bodies[0].clone();
    change(&mut body);
    session.handle(Command::Edit(Edit::Body(BodyId(0), Box::new(body)))).expect("an edit");
    session.handle(Command::EndEdit).expect("it ends");
}

fn pass(session: &mut Session, millis: u64) {
    session.advance(Duration::from_millis(millis), Duration::from_secs(20));
}

#[test]
fn time_stands_still_until_the_modes_are_there() {
    let mut session = session_of(held());
    pass(&mut session, 100);
    assert!(session.step() && session.simulation().state().steps == 0, "nothing moves");
    let wanted = session.status().awaited_modes.expect("it waits for them");
    assert_eq!(wanted.name, "Pudding");
    assert!(session.is_at_rest() && session.is_playing(), "and goes on by itself");
    let found = find_modes(session.scene(), Path::new(""), &wanted, None, &Progress::default(), &|| ());
    session.handle(Command::TakeModes(Box::new(found.expect("modes")))).expect("they are taken");
    assert!(session.status().awaited_modes.is_none(), "it waits no longer");
    pass(&mut session, 100);
    let status = session.status();
    assert_eq!((modes_of(&session), status.message.as_str()), (Some(10), ""), "it moves by them");
    assert!(session.simulation().state().steps > 50, "{} steps", session.simulation().state().steps);
    let moved = session.simulation().state().position.iter().zip(&session.simulation().model().bodies[0].start);
    let farthest = moved.map(|(at, start)| at.distance(*start)).fold(0.0, f32::max);
    assert!(farthest > 0.003, "its particles are where the modes have them: {farthest} m");
}

#[test]
fn modes_found_beside_the_sandbox_or_by_it_give_the_same_bits() {
    let (mut one, mut other) = (found(), session_of(held()));
    let wanted = other.awaited_modes().cloned().expect("it waits");
    let beside = find_modes(other.scene(), Path::new(""), &wanted, None, &Progress::default(), &|| ());
    other.handle(Command::TakeModes(Box::new(beside.expect("modes")))).expect("they are taken");
    (0..200).for_each(|_| assert!(one.step() && other.step(), "a sound motion"));
    assert_eq!(one.simulation().hash(), other.simulation().hash());
}

#[test]
fn a_body_whose_search_is_stopped_moves_by_its_cells_until_it_is_asked_anew() {
    let mut session = session_of(held());
    let stopped = Progress::default();
    stopped.cancel();
    session.find_modes(None, &CancelOnly(&stopped));
    pass(&mut session, 50);
    let status = session.status();
    assert!(modes_of(&session).is_none() && session.simulation().state().steps > 0, "by its cells");
    assert!(status.message.contains("Pudding moves by its cells"), "{}", status.message);
    edit(&mut session, |body| body.moves_by = MovesBy::Cells);
    assert_eq!(session.status().message, "", "as it is told");
    edit(&mut session, |body| body.moves_by = MovesBy::Modes);
    assert!(session.awaited_modes().is_some(), "it is looked for anew");
}

#[test]
fn a_body_of_which_a_part_can_move_freely_moves_by_its_cells_and_says_why() {
    let apart = Shape::Cells(CellsShape { list: vec![[0, 0, 0], [3, 0, 0]], size: 0.3 });
    let mut loose = session_of(Body { pins: Vec::new(), shape: apart, ..held() });
    loose.find_modes(None, &());
    assert!(loose.awaited_modes().is_none() && modes_of(&loose).is_none(), "by its cells");
    assert!(loose.warnings().iter().any(|said| said.contains("it is of loose pieces")), "{:?}", loose.warnings());
    let corner = vec![PinBox { min: [-9.0; 3], max: [-0.49; 3] }];
    let mut hung = session_of(Body { pins: corner, ..held() });
    hung.find_modes(None, &());
    assert!(hung.awaited_modes().is_none() && modes_of(&hung).is_none(), "by its cells");
    assert!(hung.warnings().iter().any(|said| said.contains("hold it at three places")), "{:?}", hung.warnings());
    pass(&mut hung, 20);
    assert!(hung.simulation().state().steps > 0, "time goes on");
}

#[test]
fn every_edit_is_taken_back_to_the_same_bytes_and_the_modes_come_back_with_it() {
    let mut session = found();
    pass(&mut session, 50);
    let before = session.scene().to_ron().expect("a scene");
    let edits: [fn(&mut Body); 5] = [
        |body| body.moves_by = MovesBy::Cells,
        |body| body.mode_count = 5,
        |body| body.material = Material::Solid(Solid { young_modulus: 2e5, ..Solid::default() }),
        |body| body.pins[0].max[1] = -0.2,
        |body| body.pose.position[1] = 3.0,
    ];
    for change in edits {
        edit(&mut session, change);
        session.find_modes(None, &());
        pass(&mut session, 20);
        session.handle(Command::Undo).expect("it is taken back");
        assert_eq!(session.scene().to_ron().expect("a scene"), before, "to the same bytes");
        assert!(session.awaited_modes().is_none(), "its modes are known");
        assert_eq!(modes_of(&session), Some(10), "and it moves by them");
        pass(&mut session, 20);
    }
}

#[test]
fn a_body_that_is_moved_keeps_its_swing_about_the_new_place() {
    let mut session = found();
    pass(&mut session, 50);
    let before = session.simulation().state().modal[0].clone();
    edit(&mut session, |body| body.pose.position = [1.0, 2.0, 0.5]);
    let after = &session.simulation().state().modal[0];
    for (before, after) in before.amplitude.iter().zip(&after.amplitude) {
        assert!((before - after).abs() < 1e-4, "{before} became {after}");
    }
    session.handle(Command::Undo).expect("it goes back");
    assert_eq!(session.simulation().state().modal[0], before, "and moves as it did, to the bit");
    session.handle(Command::Restart).expect("a new start");
    assert_eq!(modes_of(&session), Some(10), "by its modes again");
}

#[test]
fn a_saved_state_goes_on_bit_for_bit() {
    let mut session = found();
    (0..300).for_each(|_| assert!(session.step(), "a sound motion"));
    let (bytes, mut again) = (session.state_bytes(), found());
    again.set_state_bytes(&bytes).expect("a state of this scene");
    assert_eq!(again.simulation().hash(), session.simulation().hash(), "where it was");
    (0..300).for_each(|_| assert!(session.step() && again.step(), "a sound motion"));
    assert_eq!(again.simulation().hash(), session.simulation().hash(), "and on from there");
    let mut by_cells = session_of(Body { moves_by: MovesBy::Cells, ..held() });
    by_cells.set_state_bytes(&bytes).expect("a state of these cells");
    assert!(by_cells.step() && !by_cells.simulation().state().bodies[0].is_modal, "its cells go on from there too");
    let cells = by_cells.state_bytes();
    again.set_state_bytes(&cells).expect("and back");
    assert!(again.step() && again.simulation().state().bodies[0].is_modal, "by modes");
}

/// The same cube, which nothing holds: it falls on the ground.
fn free() -> Session {
    let mut body = Body { pins: Vec::new(), velocity: [0.3, -2.0, 0.1], ..held() };
    body.pose = Pose { position: [0.0, 0.8, 0.0], rotation_deg: [20.0, 0.0, 10.0] };
    let scene = Scene { bodies: vec![body], obstacles: vec![Obstacle::default()], ..Scene::default() };
    let mut session = Session::new(scene, PathBuf::new(), "pudding".to_owned()).expect("it resolves");
    session.find_modes(None, &());
    session
}

#[test]
fn a_body_that_nothing_holds_falls_and_lands_by_its_modes() {
    let mut session = free();
    assert_eq!((modes_of(&session), session.warnings()), (Some(10), Vec::new()), "it moves by them");
    pass(&mut session, 1500);
    let lowest = session.simulation().state().position.iter().map(|at| at.y).fold(f32::INFINITY, f32::min);
    assert!((-0.02..0.05).contains(&lowest), "it has landed: {lowest} m");
    assert!(session.simulation().model().bodies[0].inertia().is_some_and(|inertia| inertia.mass > 0.0));
}

#[test]
fn a_free_body_that_is_pinned_is_held_where_it_has_come_to() {
    let mut session = free();
    // It lands on a corner and falls over.
    (0..10).for_each(|_| pass(&mut session, 100));
    let (start, before) = (session.scene().bodies[0].pose, session.state_bytes());
    let there = session.simulation().state().position.clone();
    edit(&mut session, |body| body.pinned_cells = vec![[0, 3, 0]]);
    session.find_modes(None, &());
    let now = session.scene().bodies[0].pose;
    let turned = DVec3::from(now.rotation_deg).distance(DVec3::from(start.rotation_deg));
    assert!(turned > 5.0, "it has fallen and turned since: {turned}°");
    let farthest = || {
        let pairs = session.simulation().state().position.iter().zip(&there);
        pairs.map(|(now, before)| now.distance(*before)).fold(0.0, f32::max)
    };
    assert!(farthest() < 0.02, "a cube of 1 m turned by {turned}° has some of its swing to lose: {} m", farthest());
    session.handle(Command::Undo).expect("there is a change");
    session.find_modes(None, &());
    assert_eq!(session.scene().bodies[0].pose, start, "it starts where it did");
    assert!(session.state_bytes() == before, "and falls on");
}

#[test]
fn a_saved_state_of_a_free_body_goes_on_bit_for_bit_and_is_checked() {
    let mut session = free();
    let lands = |session: &mut Session| session.step() && !session.simulation().state().touches.is_empty();
    assert!((0..2000).any(|_| lands(&mut session)), "it touches the ground");
    let (bytes, mut again) = (session.state_bytes(), free());
    again.set_state_bytes(&bytes).expect("a state of this scene");
    assert_eq!(again.simulation().state(), session.simulation().state(), "where it was");
    (0..300).for_each(|_| assert!(session.step() && again.step(), "a sound motion"));
    assert_eq!(again.simulation().hash(), session.simulation().hash(), "and on from there");
    let said = |change: &dyn Fn(&mut RigidState)| {
        let mut odd = free();
        let mut state = session.simulation().state().clone();
        state.modal[0].rigid.iter_mut().for_each(change);
        odd.replace_state(state);
        let bytes = odd.state_bytes();
        free().set_state_bytes(&bytes).err().map_or("nothing".to_owned(), |error| error.to_string())
    };
    assert_eq!(said(&|_| ()), "nothing", "this may be");
    assert!(said(&|rigid| rigid.momentum.y = f64::NAN).contains("a modal body as a whole is NaN"));
    assert!(said(&|rigid| rigid.turn.x += 1.0).contains("a quaternion of length 1"));
    assert!(said(&|rigid| rigid.velocity.x = 1e100).contains("from -1e12 to 1e12"));
}

#[test]
fn states_of_the_version_before_are_read() {
    let mut session = found();
    (0..100).for_each(|_| assert!(session.step(), "a sound motion"));
    let written = session.state_bytes();
    // Version 13 did not know free bodies: it lacks the word at the end of the only modal body.
    let contents = written[..written.len() - 16].strip_prefix(b"gelatin-state 16\n").expect("this version");
    let mut before = [b"gelatin-state 13\n", contents].concat();
    before.extend(fnv1a(&before).to_le_bytes());
    let mut other = found();
    other.set_state_bytes(&before).expect("a state of the version before");
    assert_eq!(other.simulation().hash(), session.simulation().hash(), "the same");
}

#[test]
fn what_a_state_says_of_modes_is_checked_and_other_modes_take_up_its_motion() {
    let mut session = found();
    (0..100).for_each(|_| assert!(session.step(), "a sound motion"));
    let said = |change: &dyn Fn(&mut ModalState)| {
        let mut odd = found();
        let mut state = session.simulation().state().clone();
        change(&mut state.modal[0]);
        odd.replace_state(state);
        let bytes = odd.state_bytes();
        found().set_state_bytes(&bytes).err().map_or("nothing".to_owned(), |error| error.to_string())
    };
    assert_eq!(said(&|_| ()), "nothing", "this may be");
    assert!(said(&|modal| modal.rate[3] = f64::NAN).contains("is NaN, and a number from -1e12 to 1e12"));
    assert!(said(&|modal| modal.rate[9] = 1e100).contains("a number from"));
    let mut fewer = session_of(Body { mode_count: 4, ..held() });
    fewer.find_modes(None, &());
    fewer.set_state_bytes(&session.state_bytes()).expect("a state of these cells");
    let [all, own] = [&session, &fewer].map(|of| &of.simulation().state().modal[0].amplitude);
    // The first two modes have the same frequency, so that their directions are arbitrary.
    let of_pair = |of: &[f64]| of[0].hypot(of[1]);
    let off = [of_pair(own) - of_pair(all), own[3] - all[3]];
    assert!(own.len() == 4 && off.iter().all(|off| off.abs() < 1e-5), "{own:?} of {all:?}");
}

#[test]
fn modes_that_were_kept_are_found_at_once_and_damaged_ones_anew() {
    let folder = tempfile::tempdir().expect("a folder");
    let cache = folder.path().join("modes");
    let mut first = session_of(held());
    first.find_modes(Some(&cache), &());
    let files = || fs::read_dir(&cache).expect("it is made").map(|entry| entry.expect("an entry").path());
    let kept: Vec<PathBuf> = files().collect();
    assert_eq!(kept.len(), 1, "{kept:?}");
    // A cancelled search still finds modes that are kept.
    let stopped = Progress::default();
    stopped.cancel();
    let mut second = session_of(held());
    second.find_modes(Some(&cache), &CancelOnly(&stopped));
    assert_eq!(modes_of(&second), Some(10), "they were there");
    (0..100).for_each(|_| assert!(first.step() && second.step(), "a sound motion"));
    assert_eq!(first.simulation().hash(), second.simulation().hash(), "the same to the bit");
    let sound = fs::read(&kept[0]).expect("a file");
    for damage in [0, sound.len() / 2, sound.len() - 1] {
        let mut bytes = sound.clone();
        bytes[damage] ^= 1;
        fs::write(&kept[0], bytes).expect("it is damaged");
        let mut third = session_of(held());
        third.find_modes(Some(&cache), &());
        assert_eq!(modes_of(&third), Some(10), "found anew");
        assert_eq!(fs::read(&kept[0]).expect("a file"), sound, "and kept again");
    }
    fs::write(&kept[0], &sound[..20]).expect("it is cut short");
    let mut other = session_of(Body { mode_count: 3, ..held() });
    other.find_modes(Some(&cache), &());
    assert_eq!((modes_of(&other), files().count()), (Some(3), 2), "other modes are others");
}

#[test]
fn a_body_that_moves_by_modes_meets_one_that_falls_on_it() {
    let mut session = found();
    let pose = Pose { position: [0.0, 1.2, 0.0], ..Pose::default() };
    let cube = Body { name: "Cube".to_owned(), pose, ..Body::default() };
    session.handle(Command::Edit(Edit::InsertBody(BodyId(1), Box::new(cube)))).expect("a body more");
    assert_eq!(modes_of(&session), Some(10), "it goes on by its modes");
    assert!(session.warnings().is_empty(), "{:?}", session.warnings());
    let mut meets = || session.step() && !session.simulation().body_contacts().is_empty();
    assert!((0..3000).any(|_| meets()), "and the cube falls on it");
}
