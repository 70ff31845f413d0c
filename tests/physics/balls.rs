//! Balls that meet: pressed on a plane and on each other, against Hertz's theory, and head on.

use gelatin::physics::Simulation;
use gelatin::report::stability::hertz::measure;
use gelatin::scene::body::{CellsShape, Pose};
use gelatin::scene::material::Solid;
use gelatin::scene::{Body, Material, Scene, Shape};

use crate::support::{falling, run, simulate};

#[test]
fn a_pressed_ball_comes_nearer_to_hertz_the_finer_its_cells_are() {
    let figures = measure(true).expect("a ball");
    assert!(figures.passed && figures.rows.len() == 4, "a plane and its like in two resolutions: {figures:?}");
    for pair in figures.rows.chunks(2) {
        assert!(pair[1].error() < 0.7 * pair[0].error(), "{pair:?}");
    }
}

/// A ball of `cells` cells across, 1 m large and undamped, at this place along x (m) and with this speed along x (m/s).
fn ball(cells: i32, at: f64, speed: f64) -> Body {
    let off_middle = |cell: i32| f64::from(2 * cell + 1 - cells);
    let is_in =
        |cell: &[i32; 3]| cell.iter().map(|at| off_middle(*at).powi(2)).sum::<f64>() <= f64::from(cells).powi(2);
    let all = (0..cells.pow(3)).map(|place| [place % cells, place / cells % cells, place / (cells * cells)]);
    Body {
        shape: Shape::Cells(CellsShape { list: all.filter(is_in).collect(), size: 1.0 / f64::from(cells) }),
        material: Material::Solid(Solid { young_modulus: 1e5, damping_ratio: 0.0, ..Solid::default() }),
        pose: Pose { position: [at, 0.0, 0.0], rotation_deg: [0.0; 3] },
        velocity: [speed, 0.0, 0.0],
        ..Body::default()
    }
}

/// Weightless bodies that meet only each other.
fn meeting(bodies: [Body; 2]) -> Scene {
    let mut scene = falling(Body::default());
    scene.settings.gravity = [0.0; 3];
    scene.bodies = bodies.into();
    scene
}

#[test]
fn equal_balls_exchange_their_speeds_the_better_the_rounder_they_are() {
    // The share of its momentum that the first ball keeps when it meets one at rest.
    let kept = |cells: i32| {
        let mut simulation = simulate::<f32>(&meeting([ball(cells, -0.52, 1.0), ball(cells, 0.52, 0.0)]));
        let first = |simulation: &Simulation<f32>| simulation.diagnostics_of(0).momentum.x;
        let before = first(&simulation);
        run(&mut simulation, 0.7);
        assert!(simulation.body_contacts().is_empty(), "they have met and gone");
        first(&simulation) / before
    };
    let [coarse, fine] = [10, 24].map(kept);
    assert!((0.0..0.05).contains(&coarse) && (0.0..0.02).contains(&fine), "{coarse} of the momentum, then {fine}");
}
