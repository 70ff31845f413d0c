//! Damaged states: a number that no simulation has is named, with what would be right.

use std::path::PathBuf;

use super::state_error::StateFileError;
use super::{Command, Session};
use crate::disk::fnv1a;
use crate::physics::{BodyPoint, Press, SampleTouch};
use crate::scene::edit::{BodyId, Edit, ObstacleId};
use crate::scene::settings::Settings;
use crate::scene::{ContactOn, ObstacleShape, Scene, Shape, presets};

/// Where the numbers of a state of the cube on a plane stand, after its lines of text.
const STEPS: usize = 16;
const SUBSTEP: usize = 24;
const TIME: usize = 32;
const LAG: usize = 40;
const ACCELERATIONS: usize = 48;
const PART: usize = 64;
const HALVINGS: usize = 72;
const VECTORS: usize = 88;
const PARTICLES: usize = 1000;
const SIDES: usize = VECTORS + 36 * PARTICLES;
const CELLS: usize = SIDES + PARTICLES;

fn session() -> Session {
    let scene = (presets::preset("cube-on-plane").expect("a preset").build)();
    Session::new(scene, PathBuf::new(), "cube-on-plane".to_owned()).expect("it resolves")
}

/// Returns the error for a state in which some bytes are replaced and the checksum is made anew.
fn refused(place: usize, replaced: &[u8]) -> String {
    let mut bytes = session().state_bytes();
    let text = bytes.iter().enumerate().filter(|(_, byte)| **byte == b'\n').nth(1).expect("two lines").0 + 1;
    bytes[text + place..][..replaced.len()].copy_from_slice(replaced);
    said(bytes)
}

/// Returns the error for bytes with a new checksum.
fn said(mut bytes: Vec<u8>) -> String {
    bytes.truncate(bytes.len() - 8);
    let checksum = fnv1a(&bytes);
    bytes.extend(checksum.to_le_bytes());
    session().set_state_bytes(&bytes).err().map_or("nothing".to_owned(), |error| error.to_string())
}

#[test]
fn every_number_of_a_state_is_checked() {
    assert_eq!(refused(STEPS, &5_u64.to_le_bytes()), "nothing", "a sound number is taken");
    let word = |place: usize, word: u64| refused(place, &word.to_le_bytes());
    let number = |place: usize, number: f64| refused(place, &number.to_le_bytes());
    let part = |place: usize, number: f32| refused(place, &number.to_le_bytes());
    let said = [
        (word(0, 999), "the count of particles is 999, and 1000 is needed"),
        (word(8, 2), "the count of planes is 2, and 1 is needed"),
        (word(STEPS, u64::MAX), "the count of steps is 18446744073709551615"),
        (word(SUBSTEP, u64::MAX), "the count of substeps is"),
        (number(TIME, f64::NAN), "the time is NaN, and a time of 0 s or more is needed"),
        (number(TIME, f64::INFINITY), "the time is inf"),
        (number(TIME, -1.0), "the time is -1"),
        (number(LAG, f64::NAN), "the velocities' lag is NaN, and a time from 0 to 0.1 s is needed"),
        (number(LAG, 7.0), "the velocities' lag is 7"),
        (word(ACCELERATIONS, 3), "the count of accelerations is 3, and 1000 is needed"),
        (word(PART, 2), "the part of the substep that is done is 2, and a multiple of 16777216"),
        (word(HALVINGS, 25), "the count of halvings is 25, and at most 24 is needed"),
        (part(VECTORS + 24, f32::NAN), "the position of particle 2 is [NaN"),
        (part(VECTORS + 12 * PARTICLES, f32::INFINITY), "the residual of the position of particle 0 is [inf"),
        (part(VECTORS + 24 * PARTICLES + 8, f32::NAN), "the velocity of particle 0 is ["),
        (refused(SIDES, &[7]), "the side of a plane is 7, and -1, 0 or 1 is needed"),
        (word(CELLS, 1 << 60), "the list of cells that may invert of body 0 is 1152921504606846976 long"),
        (refused(CELLS + 8, &999_u32.to_le_bytes()), "the memory of body 0 is 999"),
        (refused(CELLS + 8, &66_u32.to_le_bytes()), "the memory of body 0 is one of two strains"),
        (refused(CELLS + 8, &8_u32.to_le_bytes()), "fallen out and is awake"),
        (refused(CELLS + 16, &7_u32.to_le_bytes()), "calm after no strain, and 0 substeps"),
        (number(CELLS + 20, f64::NAN), "the account of recovery of body 0 is NaN J, and a finite number"),
        (number(CELLS + 28, 1.5), "the account of recovery of body 0 is a share of 1.5, and 0 to 1"),
        (number(CELLS + 36, f64::NAN), "the way to the next look at folds of body 0 is NaN cells, and a finite number"),
        (word(CELLS + 44, u64::MAX), "the count of still substeps of body 0 is"),
        (word(CELLS + 52, 3), "not as many bytes as the obstacles on their way"),
        (word(CELLS + 60, 3), "not as many bytes as the obstacles that sweep"),
        (word(CELLS + 68, 3), "not as many bytes as the springs between bodies"),
    ];
    for (said, words) in said {
        assert!(said.starts_with("the state is damaged: ") && said.contains(words), "{words:?} in {said:?}");
    }
}

#[test]
fn a_state_of_a_body_that_presses_itself_is_read_again() {
    let scene = (presets::preset("fold").expect("a preset").build)();
    let open = || Session::new(scene.clone(), PathBuf::new(), "fold".to_owned()).expect("it resolves");
    let mut folds = open();
    let presses_itself = |session: &Session| {
        let presses = &session.simulation().state().presses;
        presses.iter().any(|press| press.bodies[0] == press.bodies[1])
    };
    assert!((0..2000).any(|_| folds.step() && presses_itself(&folds)), "it folds onto itself");
    let mut again = open();
    again.set_state_bytes(&folds.state_bytes()).expect("it is sound");
    assert!(presses_itself(&again) && again.simulation().hash() == folds.simulation().hash());
}

#[test]
fn a_state_whose_energy_is_no_number_is_refused() {
    let huge = refused(VECTORS + 24 * PARTICLES, &f32::MAX.to_le_bytes());
    assert_eq!(huge, "nothing", "fast, but a number");
    let mut session = session();
    let mut state = session.simulation().state().clone();
    state
        .position
        .iter_mut()
        .enumerate()
        .for_each(|(at, position)| position.y = if at % 2 == 0 { 3e38 } else { -3e38 });
    session.replace_state(state);
    assert!(!session.simulation().diagnostics().finite, "the links between them are too long");
    assert!(said(session.state_bytes()).contains("the energy is too large for a number"), "and this is said");
}

#[test]
fn a_state_of_another_length_says_where_that_is_seen() {
    let bytes = session().state_bytes();
    let text = bytes.iter().enumerate().filter(|(_, byte)| **byte == b'\n').nth(1).expect("two lines").0 + 1;
    let cut = |numbers: usize| said(bytes[..text + numbers + 8].to_vec());
    assert!(cut(VECTORS + 5).contains("not as many bytes as the position of every particle"), "{}", cut(VECTORS + 5));
    assert!(cut(20).contains("not as many bytes as the counts"), "{}", cut(20));
    assert!(cut(SIDES + 5).contains("the side of a plane"), "{}", cut(SIDES + 5));
    let longer = said([&bytes[..bytes.len() - 8], &[0; 16]].concat());
    assert!(longer.contains("all the numbers"), "{longer}");
    let foreign = session().set_state_bytes(&bytes[..40]);
    assert_eq!(foreign, Err(StateFileError::Damaged), "no checksum fits");
}

#[test]
fn a_substep_under_way_is_in_parts_that_end_with_it() {
    let mut bytes = session().state_bytes();
    let text = bytes.iter().enumerate().filter(|(_, byte)| **byte == b'\n').nth(1).expect("two lines").0 + 1;
    bytes[text + PART..][..8].copy_from_slice(&(3_u64 << 20).to_le_bytes());
    bytes[text + HALVINGS..][..8].copy_from_slice(&3_u64.to_le_bytes());
    assert!(said(bytes.clone()).contains("a multiple of 2097152 below 16777216 after 3 halvings"), "{}", said(bytes));
    bytes[text + HALVINGS..][..8].copy_from_slice(&4_u64.to_le_bytes());
    assert_eq!(said(bytes), "nothing", "three of sixteen parts");
}

#[test]
fn a_run_is_finite_only_where_all_of_it_is() {
    use glam::Vec3;
    let spoils: [fn(&mut crate::physics::State<f32>); 6] = [
        |_| (),
        |state| state.position[3].x = f32::INFINITY,
        |state| state.position_residual[3].x = f32::NAN,
        |state| state.velocity[3] = Vec3::NAN,
        |state| state.velocity_lag_secs = f64::NAN,
        |state| state.time_secs = f64::INFINITY,
    ];
    for (number, spoil) in spoils.iter().enumerate() {
        let mut session = session();
        // A velocity that lags behind is remembered by this scheme.
        let settings = Settings { allow_implicit: false, ..session.scene().settings.clone() };
        session.handle(Command::Edit(Edit::Settings(settings))).expect("a setting");
        let mut state = session.simulation().state().clone();
        spoil(&mut state);
        session.replace_state(state);
        assert_eq!(session.simulation().diagnostics().finite, number == 0, "number {number}");
    }
}

#[test]
fn a_state_saved_while_an_obstacle_sweeps_goes_on_bit_for_bit() {
    let mut first = session();
    (0..700).for_each(|_| assert!(first.step(), "the preset is stable"));
    let (id, mut plane) = (ObstacleId(0), first.scene().obstacles[0].clone());
    let ObstacleShape::Plane(shape) = &mut plane.shape else { unreachable!("a plane") };
    (shape.center[1], shape.rotation_deg[2]) = (0.04, 7.0);
    first.handle(Command::Play).expect("time can run");
    first.handle(Command::Drag(Edit::Obstacle(id, Box::new(plane)))).expect("it can be dragged");
    (0..5).for_each(|_| assert!(first.step(), "it is pushed"));
    assert_eq!(first.simulation().state().sweeps.len(), 1, "in the middle of the sweep");
    let opened =
        || Session::new(first.scene().clone(), PathBuf::new(), "cube-on-plane".to_owned()).expect("it resolves");
    let [mut second, mut at_once] = [opened(), opened()];
    second.set_state_bytes(&first.state_bytes()).expect("a state of the same scene");
    let mut arrived = first.simulation().state().clone();
    arrived.sweeps.clear();
    at_once.replace_state(arrived);
    for session in [&mut first, &mut second, &mut at_once] {
        (0..200).for_each(|_| assert!(session.step(), "it goes on"));
    }
    assert_eq!(first.simulation().state(), second.simulation().state(), "the same motion");
    assert_ne!(first.simulation().hash(), at_once.simulation().hash(), "the sweep is part of it");
}

/// Two cubes on each other.
fn stacked() -> Session {
    let mut scene = (presets::preset("cube-on-plane").expect("a preset").build)();
    let mut upper = scene.bodies[0].clone();
    upper.pose.position[1] += 1.05;
    scene.bodies.push(upper);
    Session::new(scene, PathBuf::new(), "stacked".to_owned()).expect("it resolves")
}

#[test]
fn a_state_saved_while_bodies_press_each_other_goes_on_bit_for_bit() {
    let mut first = stacked();
    let press = |session: &Session| session.simulation().state().presses.iter().any(|press| press.depth_m > 0.0);
    let alone = (0..5000).take_while(|_| first.step() && !press(&first)).count();
    assert!(alone < 5000, "they meet");
    (0..20).for_each(|_| assert!(first.step(), "they press each other"));
    let [mut second, mut forgetful] = [stacked(), stacked()];
    second.set_state_bytes(&first.state_bytes()).expect("a state of the same scene");
    let mut state = first.simulation().state().clone();
    state.presses.clear();
    forgetful.replace_state(state);
    for session in [&mut first, &mut second, &mut forgetful] {
        (0..100).for_each(|_| assert!(session.step(), "it goes on"));
    }
    assert_eq!(first.simulation().state(), second.simulation().state(), "the same motion");
    assert_ne!(first.simulation().hash(), forgetful.simulation().hash(), "what is pressed is part of it");
}

#[test]
fn springs_between_bodies_are_checked() {
    let said = |change: &dyn Fn(&mut Vec<Press>)| {
        let mut session = stacked();
        let mut state = session.simulation().state().clone();
        state.presses = vec![
            Press { bodies: [0, 1], point: BodyPoint::Particle(5), depth_m: 0.01 },
            Press { bodies: [1, 0], point: BodyPoint::Particle(1005), depth_m: 0.02 },
        ];
        change(&mut state.presses);
        session.replace_state(state);
        let bytes = session.state_bytes();
        stacked().set_state_bytes(&bytes).err().map_or("nothing".to_owned(), |error| error.to_string())
    };
    assert_eq!(said(&|_| ()), "nothing", "these may be");
    assert!(said(&|presses| presses.reverse()).contains("out of order"));
    assert!(said(&|presses| presses[1].bodies = [0, 1]).contains("one of particle 1005 and bodies [0, 1]"));
    assert_eq!(said(&|presses| presses[0].bodies = [0, 0]), "nothing", "a body may press itself");
    assert!(said(&|presses| presses[0].bodies = [1, 1]).contains("a particle of the first"));
    assert!(said(&|presses| presses[0].depth_m = f64::NAN).contains("is NaN, and a length of 0 m or more"));
    assert!(said(&|presses| presses[0].depth_m = -1.0).contains("is -1"));
}

#[test]
fn a_body_that_is_added_leaves_those_that_press_each_other_as_they_are() {
    let mut alone = stacked();
    (0..1500).for_each(|_| assert!(alone.step(), "it falls"));
    let mut edited = stacked();
    edited.set_state_bytes(&alone.state_bytes()).expect("a state of the same scene");
    let mut far = edited.scene().bodies[0].clone();
    far.pose.position = [4.0, 3.0, 0.0];
    let place = edited.scene().bodies.len();
    edited.handle(Command::Edit(Edit::InsertBody(BodyId(place), Box::new(far)))).expect("it can be added");
    assert_eq!(edited.simulation().state().presses, alone.simulation().state().presses, "they still press");
}

/// Spot comes down on the ground with its mesh.
fn on_its_mesh() -> Session {
    let mut scene = presets::drop_model("builtin:spot.obj");
    let Shape::Model(model) = &mut scene.bodies[0].shape else { panic!("it is a model") };
    model.divisions = 8;
    scene.bodies[0].contact_on = ContactOn::Mesh;
    Session::new(scene, PathBuf::new(), "spot".to_owned()).expect("it resolves")
}

#[test]
fn a_state_saved_while_a_mesh_touches_goes_on_bit_for_bit() {
    let mut first = on_its_mesh();
    let touches = |session: &Session| session.simulation().state().touches.iter().any(|touch| touch.depth_m > 0.0);
    let alone = (0..5000).take_while(|_| first.step() && !touches(&first)).count();
    assert!(alone < 5000, "it lands");
    (0..10).for_each(|_| assert!(first.step(), "it is pressed"));
    let [mut second, mut forgetful] = [on_its_mesh(), on_its_mesh()];
    second.set_state_bytes(&first.state_bytes()).expect("a state of the same scene");
    let mut state = first.simulation().state().clone();
    state.touches.clear();
    forgetful.replace_state(state);
    for session in [&mut first, &mut second, &mut forgetful] {
        (0..60).for_each(|_| assert!(session.step(), "it goes on"));
    }
    assert_eq!(first.simulation().state(), second.simulation().state(), "the same motion");
    assert_ne!(first.simulation().hash(), forgetful.simulation().hash(), "what is pressed is part of it");
}

/// Two of Spot meet with their meshes, the upper one upside down.
fn meshes_meet() -> Session {
    let mut scene = Scene::clone(on_its_mesh().scene());
    scene.bodies[0].pose.position[1] = 0.5;
    let mut other = scene.bodies[0].clone();
    (other.pose.position[1], other.pose.rotation_deg) = (1.3, [0.0, 0.0, 180.0]);
    scene.bodies.push(other);
    Session::new(scene, PathBuf::new(), "two".to_owned()).expect("it resolves")
}

#[test]
fn a_state_saved_while_meshes_press_each_other_goes_on_bit_for_bit() {
    let mut first = meshes_meet();
    let presses = |session: &Session| {
        let mut all = session.simulation().state().presses.iter();
        all.any(|press| matches!(press.point, BodyPoint::OfMesh(_)) && press.depth_m > 0.0)
    };
    let alone = (0..5000).take_while(|_| first.step() && !presses(&first)).count();
    assert!(alone < 5000, "they meet");
    (0..5).for_each(|_| assert!(first.step(), "they press each other"));
    let [mut second, mut forgetful] = [meshes_meet(), meshes_meet()];
    second.set_state_bytes(&first.state_bytes()).expect("a state of the same scene");
    let mut state = first.simulation().state().clone();
    state.presses.clear();
    forgetful.replace_state(state);
    for session in [&mut first, &mut second, &mut forgetful] {
        (0..40).for_each(|_| assert!(session.step(), "it goes on"));
    }
    assert_eq!(first.simulation().state(), second.simulation().state(), "the same motion");
    assert_ne!(first.simulation().hash(), forgetful.simulation().hash(), "what is pressed is part of it");
    let said = |point| {
        let mut session = meshes_meet();
        let mut state = session.simulation().state().clone();
        state.presses = vec![Press { bodies: [0, 1], point, depth_m: 0.01 }];
        session.replace_state(state);
        let bytes = session.state_bytes();
        meshes_meet().set_state_bytes(&bytes).err().map_or("nothing".to_owned(), |error| error.to_string())
    };
    assert_eq!(said(BodyPoint::OfMesh(3)), "nothing", "it may be");
    assert!(said(BodyPoint::Particle(3)).contains("one of particle 3"), "its particles meet nobody");
    assert!(said(BodyPoint::OfMesh(100_000)).contains("100000"), "there are not as many");
}

#[test]
fn touching_points_are_checked_and_states_of_versions_before_are_read() {
    let said = |change: &dyn Fn(&mut Vec<SampleTouch>)| {
        let mut session = on_its_mesh();
        let mut state = session.simulation().state().clone();
        let touch = SampleTouch { body: 0, sample: 3, obstacle: 0, side: 1, depth_m: 0.01 };
        state.touches = vec![touch, SampleTouch { sample: 7, side: -1, ..touch }];
        change(&mut state.touches);
        session.replace_state(state);
        let bytes = session.state_bytes();
        on_its_mesh().set_state_bytes(&bytes).err().map_or("nothing".to_owned(), |error| error.to_string())
    };
    assert_eq!(said(&|_| ()), "nothing", "these may be");
    assert!(said(&|touches| touches.swap(0, 1)).contains("out of order"));
    assert!(said(&|touches| touches[0].depth_m = f64::NAN).contains("is NaN, and a length of 0 m or more"));
    assert!(said(&|touches| touches[0].side = 5).contains("-1, 0 or 1"));
    let mut session = on_its_mesh();
    assert!(session.step(), "it falls");
    let written = session.state_bytes();
    // What a version did not know is up to two empty lists at the end.
    for (version, unknown) in [(13, 0), (12, 8), (11, 16)] {
        let contents =
            written[..written.len() - unknown - 8].strip_prefix(b"gelatin-state 16\n").expect("this version");
        let mut before = [format!("gelatin-state {version}\n").as_bytes(), contents].concat();
        let checksum = fnv1a(&before);
        before.extend(checksum.to_le_bytes());
        let mut other = on_its_mesh();
        other.set_state_bytes(&before).expect("a state of a version before");
        assert_eq!(other.simulation().state(), session.simulation().state(), "the same from version {version}");
    }
}
