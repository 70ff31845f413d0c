//! A brush over the cells of a body: what is touched, what stays, what is taken back.

use std::path::PathBuf;

use super::*;
use crate::math::Vector;
use crate::physics::Quantity;
use crate::scene::body::{CellsShape, CubeShape, Inlay, ModelShape};
use crate::scene::cell_brush::{CellChange, own_cells};
use crate::scene::edit::{BodyId, Edit};
use crate::scene::settings::Integrator;
use crate::scene::{Body, Material, Pose, Scene, Shape, Solid};
use glam::{DVec3, Vec3};

fn session_of(shape: Shape) -> Session {
    let pose = Pose { position: [0.0, 2.0, 0.0], rotation_deg: [0.0, 40.0, 0.0] };
    let body = Body { name: "Jelly".to_owned(), shape, pose, ..Body::default() };
    let scene = Scene { bodies: vec![body], ..Scene::default() };
    Session::new(scene, PathBuf::new(), "jelly".to_owned()).expect("it resolves")
}

/// A cube of three cells an edge.
fn cube() -> Session {
    session_of(Shape::Cube(CubeShape { cells: 3, size: 0.6 }))
}

/// The touch of a point at rest, in cells from the middle of the body.
fn touch(session: &Session, at: [f64; 3], change: CellChange) -> CellTouch {
    let body = &session.simulation().model().bodies[0];
    let size = body.lattice.grid.cell_size;
    let embedder = crate::geometry::embed::Embedder::new(&body.lattice);
    let at = embedder.embed(DVec3::from(at) * size).expect("it has cells");
    #[expect(clippy::cast_possible_truncation, reason = "as the view has it")]
    let weights = at.particles.into_iter().zip(at.weights.map(|weight| weight as f32)).collect();
    CellTouch { body: BodyId(0), weights, change }
}

fn brush(session: &mut Session, at: [f64; 3], change: CellChange) {
    let touch = touch(session, at, change);
    session.handle(Command::Brush(touch)).expect("a touch");
}

fn cells(session: &Session) -> Vec<[i32; 3]> {
    let mut list = own_cells(&session.scene().bodies[0].shape).expect("it has cells").0;
    list.sort_unstable();
    list
}

/// Where particles are and how fast, by their place at rest in the scene's grid (thousandths of a metre).
fn particles(session: &Session) -> Vec<([i64; 3], Vec3, Vec3)> {
    let (body, state) = (&session.simulation().model().bodies[0], session.simulation().state());
    let mut all: Vec<_> = (0..body.particles.len())
        .map(|local| {
            #[expect(clippy::cast_possible_truncation, reason = "thousandths of a metre")]
            let start = (body.start[local].to_dvec3() * 1e3).round().to_array().map(|x| x as i64);
            (start, state.position[local], state.velocity[local])
        })
        .collect();
    all.sort_unstable_by_key(|particle| particle.0);
    all
}

#[test]
fn a_cell_is_put_on_the_face_that_is_touched_and_the_rest_goes_on_as_it_moves() {
    let mut session = cube();
    for _ in 0..100 {
        session.step();
    }
    let before = particles(&session);
    let count = cells(&session).len();
    brush(&mut session, [0.2, 1.5, -0.3], CellChange::Attach);
    assert_eq!(cells(&session).len(), count + 1);
    assert!(cells(&session).contains(&[1, 3, 1]), "above the middle one: {:?}", cells(&session));
    let after = particles(&session);
    assert_eq!(after.len(), before.len() + 4, "four corners more");
    for (start, position, velocity) in &before {
        let now = after.iter().find(|particle| particle.0 == *start).expect("it stays");
        assert!(now.1.distance(*position) < 1e-5 && now.2.distance(*velocity) < 1e-5, "{start:?}: where it was");
    }
    assert!(session.step() && !session.simulation().has_diverged(), "and goes on");
}

#[test]
fn a_cell_is_taken_away_and_a_stroke_is_taken_back_as_one() {
    let mut session = cube();
    let before = (session.scene().clone(), particles(&session));
    brush(&mut session, [-1.5, 1.2, 0.1], CellChange::Erase);
    brush(&mut session, [-1.2, 1.5, 1.1], CellChange::Erase);
    session.handle(Command::EndEdit).expect("it is lifted");
    assert_eq!(cells(&session).len(), 25);
    assert!(!cells(&session).contains(&[0, 2, 1]) && !cells(&session).contains(&[0, 2, 2]), "{:?}", cells(&session));
    session.handle(Command::Undo).expect("there is one");
    assert_eq!((session.scene().clone(), particles(&session)), before, "to the bit");
    session.handle(Command::Redo).expect("and again");
    assert_eq!(cells(&session).len(), 25);
}

#[test]
fn a_brush_that_is_held_still_neither_piles_up_nor_digs_on() {
    let mut session = cube();
    brush(&mut session, [0.2, 1.5, -0.3], CellChange::Attach);
    // The middle has moved up by half a cell.
    brush(&mut session, [0.2, 2.0, -0.3], CellChange::Attach);
    assert_eq!(cells(&session).len(), 28, "one upon the one just put there is none");
    session.handle(Command::EndEdit).expect("it is lifted");
    brush(&mut session, [0.2, 2.0, -0.3], CellChange::Attach);
    assert_eq!(cells(&session).len(), 29, "a stroke of its own");
    session.handle(Command::EndEdit).expect("it is lifted");
    let mut session = cube();
    brush(&mut session, [0.2, 1.5, -0.3], CellChange::Erase);
    brush(&mut session, [0.2, 0.5, -0.3], CellChange::Erase);
    assert_eq!(cells(&session).len(), 26, "what was laid bare stays");
}

#[test]
fn the_last_cell_stays() {
    let mut session = session_of(Shape::Cells(CellsShape { list: vec![[5, 5, 5]], size: 0.2 }));
    let before = session.scene().clone();
    let last = touch(&session, [0.5, 0.1, 0.0], CellChange::Erase);
    let said = session.handle(Command::Brush(last)).expect_err("it is refused").to_string();
    assert!(said.contains("the last cell of Jelly stays"), "{said}");
    assert_eq!(session.scene(), &before);
}

/// Spot in few divisions.
fn spot() -> Session {
    let model = ModelShape { path: "builtin:spot.obj".to_owned(), divisions: 8, ..ModelShape::for_new() };
    session_of(Shape::Model(model))
}

/// What is changed by hand of the cells of a model: those more and those less.
fn by_hand(session: &Session) -> [Vec<[i32; 3]>; 2] {
    let Shape::Model(model) = &session.scene().bodies[0].shape else { return [Vec::new(), Vec::new()] };
    [model.attached.clone(), model.erased.clone()]
}

#[test]
fn cells_of_a_model_are_changed_by_hand_and_it_goes_on_as_it_moves() {
    let mut session = spot();
    for _ in 0..50 {
        session.step();
    }
    let (start, before) = (session.scene().clone(), particles(&session));
    let lattice = std::sync::Arc::clone(&session.simulation().model().bodies[0].lattice);
    let (last, grid) = (lattice.cells.len() - 1, lattice.grid);
    // The cell that comes last is at the far end along z: what is put on that face makes the box grow.
    let low = lattice.low(u32::try_from(last).expect("few cells"));
    let face = (grid.corner(low) + DVec3::new(0.5, 0.5, 1.0) * grid.cell_size) / grid.cell_size;
    brush(&mut session, face.to_array(), CellChange::Attach);
    session.handle(Command::EndEdit).expect("it is lifted");
    let beyond = low.map(u32::cast_signed);
    let beyond = [beyond[0], beyond[1], beyond[2] + 1];
    assert_eq!(by_hand(&session), [vec![beyond], Vec::new()], "one more beside the last");
    let now = &session.simulation().model().bodies[0];
    assert_eq!(now.lattice.cells.len(), lattice.cells.len() + 1);
    let shares = now.lattice.shares.as_ref().expect("it weighs what is in its cells");
    assert_eq!(shares.len(), now.lattice.cells.len(), "a share for each");
    let after = particles(&session);
    for (start, position, velocity) in &before {
        let now = after.iter().find(|particle| particle.0 == *start).expect("it stays");
        assert!(now.1.distance(*position) < 1e-5 && now.2.distance(*velocity) < 1e-4, "{start:?}: where it was");
    }
    // Taking the added cell away again erases none of the model's own; taking the one below it does.
    let above = (grid.corner(low) + DVec3::new(0.5, 0.5, 2.0) * grid.cell_size) / grid.cell_size;
    brush(&mut session, above.to_array(), CellChange::Erase);
    session.handle(Command::EndEdit).expect("it is lifted");
    assert_eq!(by_hand(&session), [const { Vec::<[i32; 3]>::new() }; 2]);
    brush(&mut session, face.to_array(), CellChange::Erase);
    session.handle(Command::EndEdit).expect("it is lifted");
    assert_eq!(by_hand(&session), [Vec::new(), vec![low.map(u32::cast_signed)]]);
    assert!(session.step() && !session.simulation().has_diverged(), "and goes on");
    for _ in 0..3 {
        session.handle(Command::Undo).expect("there is one");
    }
    assert_eq!(session.scene(), &start, "all taken back");
}

#[test]
fn a_scene_file_has_the_cells_that_were_changed_by_hand() {
    let mut session = spot();
    let body = &session.simulation().model().bodies[0];
    let (low, grid) = (body.lattice.low(0), body.lattice.grid);
    let face = (grid.corner(low) + DVec3::new(0.5, 0.5, 0.0) * grid.cell_size) / grid.cell_size;
    brush(&mut session, face.to_array(), CellChange::Attach);
    let [attached, _] = by_hand(&session);
    assert!(attached[0][2] < 0, "below the box: {attached:?}");
    let text = session.scene().to_ron().expect("a scene");
    let read = Scene::from_ron(&text, "spot.ron").expect("it is read");
    assert_eq!(&read, session.scene());
    let again = Session::new(read, PathBuf::new(), "spot".to_owned()).expect("it resolves");
    let [one, other] = [&session, &again].map(|of| &of.simulation().model().bodies[0].lattice);
    assert_eq!((&one.cells, &one.grid, &one.shares), (&other.cells, &other.grid, &other.shares), "the same body");
}

/// A cube of three cells an edge, of a solid with an inlay of a stiffer one that has no cell yet.
fn of_solids() -> Session {
    let mut session = cube();
    let body = session.scene().bodies[0].clone();
    let stiff = Solid { young_modulus: 1e6, ..Solid::default() };
    let inlay = Inlay { min: [0.0; 3], max: [-1.0; 3], solid: stiff, ..Inlay::default() };
    let inlays = vec![inlay.clone(), inlay];
    let body = Body { material: Material::Solid(Solid::default()), inlays, ..body };
    session.handle(Command::Edit(Edit::Body(BodyId(0), Box::new(body)))).expect("two solids");
    session
}

#[test]
fn a_painted_cell_is_of_the_inlay_and_shown_as_stiff_as_that() {
    let mut session = of_solids();
    let stiff = |session: &Session| {
        let shown = session.simulation().scalars(Quantity::Modulus);
        shown.iter().filter(|kilopascals| (**kilopascals - 1e3).abs() < 0.1).count()
    };
    assert_eq!(stiff(&session), 0, "no cell is of it");
    brush(&mut session, [1.2, 1.5, 1.1], CellChange::Paint(0));
    brush(&mut session, [1.2, 1.5, 1.1], CellChange::Paint(0));
    session.handle(Command::EndEdit).expect("it is lifted");
    let inlays = |session: &Session| session.scene().bodies[0].inlays.clone();
    assert_eq!((inlays(&session)[0].cells.clone(), inlays(&session)[1].cells.len()), (vec![[2, 2, 2]], 0));
    assert_eq!(stiff(&session), 1, "the corner is in no other cell");
    brush(&mut session, [1.2, 1.5, 1.1], CellChange::Paint(1));
    assert_eq!((inlays(&session)[0].cells.len(), inlays(&session)[1].cells.len()), (0, 1), "of one of them");
    session.handle(Command::EndEdit).expect("it is lifted");
    brush(&mut session, [1.2, 1.5, 1.1], CellChange::Scrape(1));
    session.handle(Command::EndEdit).expect("it is lifted");
    assert_eq!(inlays(&session)[1].cells.len(), 0);
    brush(&mut session, [1.2, 1.5, 1.1], CellChange::Paint(7));
    brush(&mut session, [1.2, 1.5, 1.1], CellChange::Scrape(1));
    for _ in 0..2 {
        session.handle(Command::Undo).expect("there is one");
    }
    assert_eq!(inlays(&session)[0].cells, vec![[2, 2, 2]], "taken back");
    assert!(session.step() && !session.simulation().has_diverged());
}

#[test]
fn what_is_painted_no_box_takes() {
    let mut session = of_solids();
    let mut body = session.scene().bodies[0].clone();
    (body.inlays[1].min, body.inlays[1].max) = ([-1.0; 3], [1.0; 3]);
    body.inlays[1].solid.young_modulus = 5e5;
    session.handle(Command::Edit(Edit::Body(BodyId(0), Box::new(body)))).expect("a box around all");
    brush(&mut session, [1.2, 1.5, 1.1], CellChange::Paint(0));
    let shown = session.simulation().scalars(Quantity::Modulus);
    let near = |kilopascals: f32| shown.iter().filter(|shown| (**shown - kilopascals).abs() < 0.1).count();
    assert_eq!((near(1e3), near(500.0)), (1, 64 - 8), "the corner, and all that are not in the painted cell");
}

#[test]
fn painted_cells_stay_the_same_where_the_box_grows() {
    let mut session = of_solids();
    brush(&mut session, [-1.2, -1.5, -1.1], CellChange::Paint(0));
    session.handle(Command::EndEdit).expect("it is lifted");
    let stiff = |session: &Session| -> Vec<[i64; 3]> {
        let shown = session.simulation().scalars(Quantity::Modulus);
        let body = &session.simulation().model().bodies[0];
        let starts = shown.iter().zip(&body.start).filter(|(kilopascals, _)| **kilopascals > 900.0);
        #[expect(clippy::cast_possible_truncation, reason = "thousandths of a metre")]
        starts.map(|(_, start)| (start.to_dvec3() * 1e3).round().to_array().map(|x| x as i64)).collect()
    };
    let before = stiff(&session);
    assert_eq!(before.len(), 1, "a corner");
    brush(&mut session, [-1.5, 0.2, 0.1], CellChange::Attach);
    assert_eq!(stiff(&session), before, "the same corner");
}

/// The particles of the only body that are held.
fn held(session: &Session) -> Vec<usize> {
    let body = &session.simulation().model().bodies[0];
    (0..body.particles.len()).filter(|particle| body.is_pinned(*particle)).collect()
}

#[test]
fn what_is_pinned_in_flight_hangs_where_it_was_whatever_the_scheme() {
    for scheme in Integrator::ALL {
        let mut session = cube();
        let mut settings = session.scene().settings.clone();
        settings.integrator = scheme;
        session.handle(Command::Edit(Edit::Settings(settings))).expect("a scheme");
        (0..200).for_each(|_| _ = session.step());
        let before = session.simulation().state().position.clone();
        brush(&mut session, [1.2, 1.5, 1.1], CellChange::Pin);
        assert_eq!(session.simulation().state().position, before, "nothing jumps");
        let pinned = held(&session);
        assert_eq!(pinned.len(), 8, "the corners of a cell");
        (0..300).for_each(|_| _ = session.step());
        let now = &session.simulation().state().position;
        assert!(pinned.iter().all(|&particle| now[particle] == before[particle]), "{scheme:?}: it is held");
        let moved = now.iter().zip(&before).map(|(now, before)| now.distance(*before)).fold(0.0, f32::max);
        assert!(moved > 0.02, "{scheme:?}: the rest of it swings: {moved} m");
    }
}

#[test]
fn a_pin_taken_back_lets_go_where_the_body_is() {
    let mut session = cube();
    brush(&mut session, [1.2, 1.5, 1.1], CellChange::Pin);
    brush(&mut session, [1.2, 1.5, 1.1], CellChange::Pin);
    brush(&mut session, [-1.2, 1.5, 1.1], CellChange::Pin);
    session.handle(Command::EndEdit).expect("it is lifted");
    assert_eq!(session.scene().bodies[0].pinned_cells, [[2, 2, 2], [0, 2, 2]]);
    (0..100).for_each(|_| _ = session.step());
    let before = session.simulation().state().position.clone();
    brush(&mut session, [-1.2, 1.5, 1.1], CellChange::Release);
    session.handle(Command::EndEdit).expect("it is lifted");
    assert_eq!((session.scene().bodies[0].pinned_cells.len(), held(&session).len()), (1, 8));
    session.handle(Command::Undo).expect("there is one");
    assert_eq!((session.scene().bodies[0].pinned_cells.len(), held(&session).len()), (2, 16));
    session.handle(Command::Undo).expect("the stroke of two cells");
    assert!(held(&session).is_empty());
    assert_eq!(session.simulation().state().position, before, "it is where it was");
    (0..20).for_each(|_| _ = session.step());
    assert!(session.simulation().state().position[63].y < before[63].y, "and falls");
}

#[test]
fn pinned_cells_stay_the_same_where_the_box_grows_and_where_the_cube_becomes_a_list() {
    let mut session = cube();
    brush(&mut session, [-1.2, -1.5, -1.1], CellChange::Pin);
    session.handle(Command::EndEdit).expect("it is lifted");
    let places = |session: &Session| -> Vec<DVec3> {
        let start = &session.simulation().model().bodies[0].start;
        held(session).into_iter().map(|particle| start[particle].to_dvec3()).collect()
    };
    let before = places(&session);
    brush(&mut session, [-1.5, 0.2, 0.1], CellChange::Attach);
    let after = places(&session);
    assert!(before.len() == 8 && after.iter().zip(&before).all(|(a, b)| a.distance(*b) < 1e-6), "{after:?}");
    session.handle(Command::EndEdit).expect("it is lifted");
    brush(&mut session, [-1.2, -1.5, -1.1], CellChange::Erase);
    assert!(
        session.scene().bodies[0].pinned_cells.is_empty() && held(&session).is_empty(),
        "what is gone holds nothing"
    );
}

#[test]
fn a_touch_of_another_body_or_of_none_is_refused() {
    let mut session = cube();
    let touch = touch(&session, [0.2, 1.5, -0.3], CellChange::Attach);
    let far = touch.weights.iter().map(|(particle, weight)| (particle + 1000, *weight)).collect();
    let bad = [
        CellTouch { body: BodyId(7), ..touch.clone() },
        CellTouch { weights: far, ..touch.clone() },
        CellTouch { weights: vec![(0, f32::NAN)], ..touch },
    ];
    for touch in bad {
        session.handle(Command::Brush(touch)).expect_err("it is refused");
        assert_eq!(cells(&session).len(), 27);
    }
}
