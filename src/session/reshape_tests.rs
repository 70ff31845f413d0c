//! A model that is filled anew while it moves.

use std::path::PathBuf;

use glam::DVec3;

use super::{Command, Session};
use crate::geometry::embed::{Embedder, Embedding};
use crate::scene::body::{ContactOn, Keep, ModelShape, OccupancyChoice, Shape};
use crate::scene::edit::{BodyId, Edit};
use crate::scene::{Body, Material, Solid, presets};

/// Spot as a solid in 8 divisions, after some steps of 1 ms.
fn spot(steps: usize) -> Session {
    let mut scene = presets::drop_model("builtin:spot.obj");
    let Shape::Model(model) = &mut scene.bodies[0].shape else { panic!("a model") };
    model.divisions = 8;
    scene.bodies[0].material = Material::Solid(Solid { young_modulus: 1e5, ..Solid::default() });
    scene.bodies[0].velocity = [0.5, 0.0, 0.0];
    let mut session = Session::new(scene, PathBuf::new(), String::new()).expect("spot");
    (0..steps).for_each(|_| assert!(session.step(), "the scene is stable"));
    session
}

fn edit(session: &mut Session, change: impl FnOnce(&mut ModelShape)) {
    let mut body = Body::clone(&session.scene().bodies[0]);
    let Shape::Model(model) = &mut body.shape else { panic!("a model") };
    change(model);
    session.handle(Command::Edit(Edit::Body(BodyId(0), Box::new(body)))).expect("it can be filled so");
    session.handle(Command::EndEdit).expect("one step of undo");
}

/// How far the middle of the body's mass is from its start, m, its mean velocity, m/s, and its mass, kg.
fn motion(session: &Session) -> (DVec3, DVec3, f64) {
    let diagnostics = session.simulation().diagnostics();
    let mass = diagnostics.mass_kg;
    let body = &session.simulation().model().bodies[0];
    let start = body.start.iter().enumerate().map(|(at, start)| start.as_dvec3() * f64::from(body.mass(at)));
    (diagnostics.center - start.sum::<DVec3>() / mass, diagnostics.momentum / mass, mass)
}

#[test]
fn a_model_filled_anew_goes_on_from_where_it_was() {
    let changes: [&dyn Fn(&mut ModelShape); 4] = [
        &|model| model.divisions = 15,
        &|model| model.divisions = 5,
        &|model| model.occupancy = OccupancyChoice::Solid,
        &|model| model.keep = Keep::Largest,
    ];
    for (number, change) in changes.into_iter().enumerate() {
        let mut session = spot(200);
        let (at, speed, mass) = motion(&session);
        let (steps, hash) = (session.simulation().state().steps, session.simulation().hash());
        edit(&mut session, change);
        let (now_at, now_speed, now_mass) = motion(&session);
        assert_eq!(session.simulation().state().steps, steps, "{number}: time goes on");
        assert!(at.distance(now_at) < 0.002, "{number}: it was {at} from its start, now {now_at}");
        assert!(speed.distance(now_speed) < 0.02, "{number}: it moved with {speed}, now with {now_speed}");
        assert!(speed.y < -1.5, "{number}: it falls");
        assert!((now_mass / mass - 1.0).abs() < 1e-5, "{number}: it weighs {mass} kg, now {now_mass} kg");
        (0..400).for_each(|_| assert!(session.step(), "{number}: it lands"));
        session.handle(Command::Undo).expect("what was done can be undone");
        assert_eq!(session.simulation().hash(), hash, "{number}: and is as it was");
    }
}

#[test]
fn a_model_that_has_landed_is_as_squashed_as_before_and_stays_on_the_ground() {
    let mut session = spot(1500);
    let low = |session: &Session| session.simulation().diagnostics().bounds.min.y;
    let before = low(&session);
    edit(&mut session, |model| model.divisions = 14);
    assert!((low(&session) - before).abs() < 0.05, "{before} m, now {} m", low(&session));
    (0..500).for_each(|_| assert!(session.step(), "it rests"));
    assert!(low(&session) > -0.02, "on the ground, not in it: {} m", low(&session));
    let mut large = spot(300);
    let (at, _, mass) = motion(&large);
    edit(&mut large, |model| model.length = 1.5);
    let (now_at, _, now_mass) = motion(&large);
    assert!(at.distance(now_at) < 0.05, "about its middle: {at}, {now_at} from its start");
    assert!((now_mass / mass / 1.5f64.powi(3) - 1.0).abs() < 1e-5, "{mass} kg, {now_mass} kg");
    (0..500).for_each(|_| assert!(large.step(), "it comes out of the ground where it has grown into it"));
}

#[test]
fn one_that_lies_on_its_mesh_goes_on_lying_on_it() {
    let mut session = spot(0);
    let mut body = Body::clone(&session.scene().bodies[0]);
    body.contact_on = ContactOn::Mesh;
    // So firm that it keeps its form: where cells are crushed the mesh in them is, too.
    body.material = Material::Solid(Solid { young_modulus: 1e6, ..Solid::default() });
    session.handle(Command::Edit(Edit::Body(BodyId(0), Box::new(body)))).expect("it has a mesh");
    (0..1500).for_each(|_| assert!(session.step(), "it lands"));
    let low = lowest_vertex(&session);
    assert!(low.abs() < 0.01, "on its mesh: {low} m");
    for divisions in [15, 20] {
        edit(&mut session, |model| model.divisions = divisions);
        let mut deepest = lowest_vertex(&session);
        let before = deepest;
        for _ in 0..100 {
            (0..15).for_each(|_| assert!(session.step(), "it lies"));
            deepest = deepest.min(lowest_vertex(&session));
        }
        assert!(deepest > before - 0.01, "{divisions} divisions: it went from {before} m down to {deepest} m");
        let low = lowest_vertex(&session);
        assert!(low.abs() < 0.01, "{divisions} divisions: the lowest vertex is at {low} m");
    }
}

/// How high the lowest vertex of the body's mesh is, m.
fn lowest_vertex(session: &Session) -> f64 {
    let simulation = session.simulation();
    let lattice = &simulation.model().bodies[0].lattice;
    let mesh = lattice.mesh.as_ref().expect("a model has a mesh");
    let embedded = Embedder::new(lattice).embed_all(&mesh.positions).expect("finite");
    let height = |at: &Embedding| {
        let terms = at.particles.iter().zip(&at.weights);
        terms.map(|(particle, weight)| f64::from(simulation.state().position[*particle as usize].y) * weight).sum()
    };
    embedded.iter().map(height).fold(f64::INFINITY, f64::min)
}

#[test]
fn at_its_start_a_model_stays_at_its_start() {
    let mut session = spot(0);
    edit(&mut session, |model| model.divisions = 10);
    let state = session.simulation().state();
    let start = &session.simulation().model().bodies[0].start;
    assert!(state.position.iter().zip(start).all(|(at, start)| at == start), "nothing has moved");
}
