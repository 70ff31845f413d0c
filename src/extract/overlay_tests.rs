//! The overlays of a small cube.

use super::*;
use crate::geometry::voxel::Cells;
use crate::scene::body::CubeShape;
use crate::scene::{Obstacle, Scene, Shape};

/// A cube of 2³ cells of half a metre, with its middle at a height above the ground.
fn cube(height: f64) -> (Scene, Simulation<f32>) {
    let mut body = Body { shape: Shape::Cube(CubeShape { cells: 2, size: 1.0 }), ..Body::default() };
    body.pose.position = [0.0, height, 0.0];
    let scene = Scene { bodies: vec![body], obstacles: vec![Obstacle::default()], ..Scene::default() };
    let lattice = Arc::new(Lattice::new(&Cells::cube(2, 0.5).expect("a small cube")));
    let simulation = Simulation::new(&scene, &[lattice]);
    (scene, simulation)
}

fn filled(height: f64, steps: usize, wanted: Overlays) -> Overlay {
    let (scene, mut simulation) = cube(height);
    for _ in 0..steps {
        simulation.step();
    }
    OverlaySource::default().fill(&simulation, &scene.bodies, wanted)
}

fn segments(lines: &Lines) -> &[Segment] {
    match &lines.ends {
        LineEnds::Placed(segments) => segments,
        other => panic!("placed lines, not {other:?}"),
    }
}

#[test]
fn nothing_wanted_is_nothing_made_and_nothing_kept() {
    let (scene, simulation) = cube(1.0);
    let mut source = OverlaySource::default();
    source.fill(&simulation, &scene.bodies, Overlays { structural: true, ..Overlays::default() });
    assert_eq!(source.lattices.len(), 1, "the links of one lattice are kept");
    let overlay = source.fill(&simulation, &scene.bodies, Overlays::default());
    assert_eq!(overlay, Overlay::default(), "nothing to draw");
    assert!(source.lattices.is_empty(), "nor to keep");
}

#[test]
fn each_family_has_its_links_its_colour_and_its_toggle() {
    let all = Overlays { structural: true, shear: true, bending: true, ..Overlays::default() };
    let overlay = filled(1.0, 0, all);
    let counts: Vec<usize> = overlay
        .lines
        .iter()
        .map(|lines| match &lines.ends {
            LineEnds::Particles { ends, .. } => ends.len(),
            other => panic!("links hang on particles, not {other:?}"),
        })
        .collect();
    assert_eq!(counts, [54, 104, 27], "the links of 3³ particles by family");
    let tints: Vec<Tint> = overlay.lines.iter().map(|lines| lines.tint).collect();
    assert_eq!(tints, [Tint::Link(0), Tint::Link(1), Tint::Link(2)], "a colour each");
    let shear = filled(1.0, 0, Overlays { shear: true, ..Overlays::default() });
    assert_eq!(shear.lines, overlay.lines[1..2], "one toggle, one family");
}

#[test]
fn links_are_listed_once_however_often_they_are_drawn() {
    let (scene, simulation) = cube(1.0);
    let mut source = OverlaySource::default();
    let wanted = Overlays { cells: true, ..Overlays::default() };
    let mut cells = || {
        let overlay = source.fill(&simulation, &scene.bodies, wanted);
        Arc::clone(&overlay.cells[0].cells)
    };
    assert!(Arc::ptr_eq(&cells(), &cells()), "the second frame names the list of the first");
}

#[test]
fn hidden_bodies_show_nothing_of_their_inside() {
    let (mut scene, simulation) = cube(1.0);
    scene.bodies[0].hidden = true;
    let wanted = Overlays { structural: true, particles: true, wireframe: true, ..Overlays::default() };
    let overlay = OverlaySource::default().fill(&simulation, &scene.bodies, wanted);
    assert!(overlay.is_empty(), "no links, particles or edges");
}

#[test]
fn pins_are_marked_where_there_are_any() {
    let wanted = Overlays { pins: true, ..Overlays::default() };
    assert!(filled(1.0, 0, wanted).is_empty(), "all of it moves");
    let (mut scene, _) = cube(1.0);
    scene.bodies[0].pinned_cells = vec![[0, 0, 0], [9, 9, 9]];
    let lattice = Arc::new(Lattice::new(&Cells::cube(2, 0.5).expect("a small cube")));
    let simulation = Simulation::new(&scene, &[lattice]);
    let overlay = OverlaySource::default().fill(&simulation, &scene.bodies, wanted);
    let [Points { places: PointPlaces::Placed(places), tint: Tint::Pin, .. }] = &overlay.points[..] else {
        panic!("the points of one body, not {:?}", overlay.points)
    };
    assert_eq!(places.len(), 8, "of the cell that there is");
    assert!(places.iter().all(|[x, y, z]| *x <= 0.0 && *y <= 1.0 && *z <= 0.0), "{places:?}");
}

#[test]
fn arrows_of_a_cube_at_rest_carry_its_weight() {
    let wanted = Overlays { contacts: true, ..Overlays::default() };
    assert!(segments(&filled(3.0, 1, wanted).lines[0]).is_empty(), "in the air nothing touches");
    let (_, simulation) = cube(1.0);
    let body = &simulation.model().bodies[0];
    let weight = body.particle_mass * 27.0 * 9.81;
    let overlay = filled(0.51, 4000, wanted);
    let up: f32 = segments(&overlay.lines[0]).iter().map(|arrow| arrow.ends[1][1] - arrow.ends[0][1]).sum();
    let shown = up * newtons_per_metre(body, Vec3::NEG_Y * 9.81);
    assert!((shown / weight - 1.0).abs() < 0.05, "{shown} N of {weight} N");
    assert!((up / (9.0 * WEIGHT_ARROW_LENGTH) - 1.0).abs() < 0.06, "nine particles, a fifth of a metre each: {up}");
}

#[test]
fn arrows_between_bodies_carry_the_weight_of_the_upper_one() {
    let (mut scene, of_one) = cube(0.5);
    let mut upper = scene.bodies[0].clone();
    upper.pose.position[1] += 1.01;
    scene.bodies.push(upper);
    let lattice = &of_one.model().bodies[0].lattice;
    let mut simulation = Simulation::new(&scene, &[Arc::clone(lattice), Arc::clone(lattice)]);
    for _ in 0..4000 {
        simulation.step();
    }
    let wanted = Overlays { contacts: true, ..Overlays::default() };
    let overlay = OverlaySource::default().fill(&simulation, &scene.bodies, wanted);
    let body = &simulation.model().bodies[0];
    let weight = body.particle_mass * 27.0 * 9.81;
    let between = segments(&overlay.lines[0]).iter().filter(|arrow| arrow.ends[0][1] > 0.5);
    let (mut up, mut down) = (0.0, 0.0);
    for way in between.map(|arrow| arrow.ends[1][1] - arrow.ends[0][1]) {
        *if way > 0.0 { &mut up } else { &mut down } += way.abs();
    }
    let shown = (up + down) * newtons_per_metre(body, Vec3::NEG_Y * 9.81);
    assert!((shown / weight - 1.0).abs() < 0.05, "{shown} N of {weight} N");
    assert!(up > 0.0 && down > 0.0, "points of either are pushed by the other: {up} up, {down} down");
}

#[test]
fn boxes_fit_their_bodies_and_are_strong_where_they_meet() {
    let wanted = Overlays { boxes: true, ..Overlays::default() };
    let widths = |height| {
        let overlay = filled(height, 0, wanted);
        let [of_body, of_ground] = [0, 1].map(|lines| segments(&overlay.lines[lines]));
        assert_eq!((of_body.len(), of_ground.len()), (12, 12), "twelve edges each");
        let low = of_body.iter().flat_map(|edge| edge.ends).map(|end| end[1]).fold(f32::INFINITY, f32::min);
        assert!((f64::from(low) - (height - 0.5)).abs() < 1e-5, "the box begins below the body: {low}");
        of_ground[0].widths[0]
    };
    assert!(widths(0.4) > widths(3.0), "a pair that passes the broad phase stands out");
}

#[test]
fn a_pull_begins_where_it_was_grabbed() {
    let mut overlay = Overlay::default();
    add_grab(&mut overlay, Vec3::X, Vec3::Y);
    assert_eq!(segments(&overlay.lines[0])[0].ends, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], "from grabbed to target");
    assert_eq!(overlay.points.len(), 2, "a dot at either end");
}

#[test]
fn what_is_selected_keeps_its_name_among_hidden_things() {
    let body = |hidden| Body { hidden, ..Body::default() };
    let bodies = [body(true), body(false), body(true), body(false)];
    assert_eq!(selected_body(&bodies, 3), Some(Selected::Skin(1)), "the second that is drawn");
    assert_eq!(selected_body(&bodies, 2), None, "a hidden one has no outline");
    let obstacles = [Obstacle { hidden: true, ..Obstacle::default() }, Obstacle::default()];
    assert_eq!(selected_obstacle(&obstacles, 1), Some(Selected::Solid(0)), "the first that is drawn");
    assert_eq!(selected_obstacle(&obstacles, 7), None, "nor one that is not there");
}
