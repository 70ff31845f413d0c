//! The axes stay where a person left them, the dot follows an edit, and a measured map is that of its scene.

use std::path::PathBuf;

use super::*;
use crate::scene::edit::Edit;
use crate::scene::{Springs, presets};
use crate::session::{Command, Session};

const LIMITING: MapOf = MapOf { body: StabilityOf::Limiting, family: None };

fn scene() -> Scene {
    let mut scene = (presets::preset("cube-on-plane").expect("a preset").build)();
    scene.bodies[0].shape = Shape::Cube(CubeShape { cells: 3, size: 1.0 });
    scene
}

fn watched(scene: &Scene) -> Session {
    let mut session = Session::new(scene.clone(), PathBuf::new(), "test".into()).expect("it resolves");
    session.handle(Command::WatchStability(Some(StabilityOf::Limiting))).expect("it looks");
    session
}

fn shown(session: &Session) -> PlaneShown {
    session.status().stability.and_then(|shown| shown.plane.clone()).expect("a body is looked at")
}

fn measured(scene: &Scene) -> StabilityMap {
    stability_map(scene, Path::new(""), LIMITING, &Progress::default(), &|| ()).expect("a map")
}

/// Counts the places predicted to be stable that blew up, and all places predicted to be stable.
fn broken_promises(map: &StabilityMap, border: impl Fn(f64) -> f64) -> [usize; 2] {
    let mut found = [0, 0];
    for (column, &damping) in map.columns.iter().zip(&map.damping) {
        for (&survived, &stiffness) in column.survived.iter().zip(&map.stiffness) {
            if stiffness <= border(damping) {
                found[0] += usize::from(survived < map.watched);
                found[1] += 1;
            }
        }
    }
    found
}

#[test]
fn what_is_predicted_to_be_stable_stays_and_a_border_that_promises_too_much_is_found_out() {
    let scene = scene();
    let map = measured(&scene);
    let plane = shown(&watched(&scene)).plane;
    let [broken, stable] = broken_promises(&map, |damping| plane.stable_stiffness(damping));
    assert!(broken == 0 && stable > 20, "{broken} of {stable}");
    let [broken, _] = broken_promises(&map, |damping| 6.0 * plane.stable_stiffness(damping));
    assert!(broken > 0, "six times the stiffness is not stable");
    let nearest = map
        .border
        .iter()
        .take_while(|at| at.stiffness > map.stiffness[1])
        .map(|at| plane.stable_stiffness(at.damping) / at.stiffness)
        .fold(0.0, f64::max);
    assert!((0.5..=1.0).contains(&nearest), "the borders come near each other: {nearest}");
}

#[test]
fn an_edit_moves_the_dot_and_a_map_stays_that_of_its_scene() {
    let scene = scene();
    let mut session = watched(&scene);
    let (before, map) = (shown(&session), measured(&scene));
    assert!(map.is_of(&scene, &before), "just measured");
    let wanted = Place { damping: 2.0 * before.now.damping, stiffness: 0.5 * before.now.stiffness };
    let moved = before.moved(&scene.bodies[0], wanted);
    session.handle(Command::Edit(Edit::Body(BodyId(0), Box::new(moved)))).expect("it is moved");
    let after = shown(&session);
    assert!((after.now.stiffness / wanted.stiffness - 1.0).abs() < 1e-9, "{:?} for {wanted:?}", after.now);
    assert!(map.is_of(session.scene(), &after), "whatever the values of the axes");
    let mut other = session.scene().clone();
    other.settings.dt *= 2.0;
    assert!(!map.is_of(&other, &shown(&watched(&other))), "of another step");
    session.handle(Command::WatchStability(None)).expect("it looks away");
    assert!(session.status().stability.is_none(), "nobody looks");
}

#[test]
fn the_axes_stay_those_of_one_family_while_another_limits() {
    let mut session = watched(&scene());
    assert_eq!(shown(&session).family(), Some(Family::Shear), "it limits most");
    let set = |session: &mut Session, change: &dyn Fn(&mut Springs)| {
        let mut body = session.scene().bodies[0].clone();
        let Material::Springs(springs) = &mut body.material else { panic!("springs") };
        change(springs);
        session.handle(Command::Edit(Edit::Body(BodyId(0), Box::new(body)))).expect("in range");
        let shown = shown(session);
        (shown.family(), shown.limiting_family())
    };
    let [structural, shear, bending] = Family::ALL.map(Some);
    assert_eq!(set(&mut session, &|s| s.shear = Spring { stiffness: 1e-3, damping: 0.0 }), (shear, bending));
    assert_eq!(set(&mut session, &|s| s.particle_mass *= 1.5), (shear, bending), "whoever limits");
    let map = |family| MapOf { body: StabilityOf::Limiting, family };
    let of_shear = stability_map(session.scene(), Path::new(""), map(shear), &Progress::default(), &|| ());
    assert!(of_shear.expect("a map").is_of(session.scene(), &shown(&session)), "what is shown is measured");
    assert_eq!(set(&mut session, &|s| s.structural.stiffness *= 2.0).0, structural, "its own slider");
    session.handle(Command::WatchStability(None)).expect("it looks away");
    assert_eq!(set_family_anew(&mut session), shear, "who looks anew sees what limits");
}

/// What is shown to who begins to look at stiff shear springs.
fn set_family_anew(session: &mut Session) -> Option<Family> {
    let mut body = session.scene().bodies[0].clone();
    let Material::Springs(springs) = &mut body.material else { panic!("springs") };
    springs.shear.stiffness = 1e4;
    session.handle(Command::Edit(Edit::Body(BodyId(0), Box::new(body)))).expect("in range");
    session.handle(Command::WatchStability(Some(StabilityOf::Limiting))).expect("it looks");
    shown(session).family()
}

#[test]
fn a_large_body_is_measured_on_a_small_cube_of_its_cells() {
    let mut large = scene();
    large.bodies[0].shape = Shape::Cube(CubeShape { cells: 24, size: 1.0 });
    large.bodies[0].pinned_cells.push([0; 3]);
    let lattice = crate::report::extremes::lattices(&large).expect("a cube").swap_remove(0);
    let cell_m = lattice.grid.cell_size;
    let subject = Subject::new(&large, 0, lattice);
    assert!(subject.steps < WATCHED_STEPS[1], "too much work: {} steps", subject.steps);
    let cube = subject.stand_in(&large).expect("a cube");
    assert!(cube.steps > WATCHED_STEPS[1] && cube.stand_in == Some(5), "{} steps", cube.steps);
    assert!((cube.lattices[0].grid.cell_size - cell_m).abs() < 1e-12, "the same cells");
    assert!(!cube.scene.bodies[0].has_pins(), "cells that are pinned in the large body are others in the cube");
}

#[test]
fn what_has_no_border_is_refused_in_words() {
    let refused = |scene: &Scene| {
        let map = stability_map(scene, Path::new(""), LIMITING, &Progress::default(), &|| ());
        map.expect_err("nothing to measure").to_string()
    };
    assert_eq!(refused(&Scene::default()), "the scene has no body");
    let mut implicit = scene();
    implicit.settings.integrator = Integrator::Implicit;
    assert!(refused(&implicit).contains("every step of this scheme is stable"), "the implicit scheme");
    let progress = Progress::default();
    progress.cancel();
    let cancelled = stability_map(&scene(), Path::new(""), LIMITING, &progress, &|| ());
    assert!(matches!(cancelled, Err(BackgroundError::Cancelled | BackgroundError::Session(_))), "{cancelled:?}");
}

#[test]
fn a_border_is_looked_at_closely_where_it_falls_and_only_there() {
    // It falls to nothing at 2, as those of a damping that is too large do.
    let border = |x: f64| [(4.0 - x * x).max(0.0), 1.0];
    let points = refine_where_steep(vec![0.5, 1.0, 3.0], 1e-3, border);
    let far = |pair: &[(f64, [f64; 2])]| pair[1].0 / pair[0].0;
    let falls = points.windows(2).filter(|pair| pair[0].1[0] > 2.0 * pair[1].1[0].max(1e-3));
    let widest = falls.map(far).fold(1.0, f64::max);
    assert!(widest < 1.05, "the fall is seen to {widest}");
    assert!((far(&points[..2]) - 2.0).abs() < 1e-9 && points.len() < 20, "and nothing else: {}", points.len());
}
