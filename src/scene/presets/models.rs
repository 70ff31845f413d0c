//! Jellified models: one with thin parts, a long one, an open one, and many at once. All are solids, which are as stiff
//! in few cells as in many.

use super::parts::{ball, builtin_model, looking_at, scene, turned};
use crate::scene::Scene;
use crate::scene::body::{Body, ContactOn, CubeShape, ModelShape, MovesBy, OccupancyChoice, PinBox, Pose, Shape};
use crate::scene::material::{Material, Solid};
use crate::scene::obstacle::{Motion, Obstacle, Oscillate};

/// The chair of SC, Fig 1. A jelly is thrown into it and swings it; its feet are held.
pub(super) fn chair() -> Scene {
    const HEIGHT: f64 = 1.2;
    let chair = Body {
        pose: Pose { position: [0.0, 0.5 * HEIGHT, 0.0], ..Pose::default() },
        // Below the height of a cell and a half.
        pins: vec![pin([-1.0; 3], [1.0, 0.06 - 0.5 * HEIGHT, 1.0])],
        ..solid("Chair", thin("chair.obj", 30, HEIGHT), [1.2e6, 300.0, 0.01])
    };
    let jelly = Body {
        pose: Pose { position: [0.0, 1.0, 1.3], rotation_deg: [20.0, 10.0, 0.0] },
        velocity: [0.0, 1.4, -4.0],
        ..solid("Jelly", Shape::Cube(CubeShape { cells: 5, size: 0.3 }), [3e4, 150.0, 0.03])
    };
    let mut scene = looking_at([0.0, 0.55, 0.45], 3.8, scene(chair, Vec::new()));
    scene.bodies.push(jelly);
    turned(50.0, 14.0, scene)
}

/// The bridge of SC, Fig 1: its model is 310 loose parts, which the cells join. It is held at both ends and where its
/// towers stand, a gust pushes it sideways as it takes up its own weight, and a load falls onto it. Cells that meet across
/// a gap in the model would be in contact from the start, so it does not meet itself.
pub(super) fn bridge() -> Scene {
    const LENGTH: f64 = 9.0;
    /// The middle of its box above the ground, m.
    const MIDDLE: f64 = 1.4;
    let held = |side: f64| {
        let [inner, outer] = [0.48, 0.51].map(|part| part * LENGTH * side);
        pin([inner.min(outer), -2.0, -2.0], [inner.max(outer), 2.0, 2.0])
    };
    let bridge = Body {
        pose: Pose { position: [0.0, MIDDLE, 0.0], ..Pose::default() },
        velocity: [0.0, 0.0, 1.0],
        pins: vec![held(-1.0), held(1.0), pin([-LENGTH, -2.0, -2.0], [LENGTH, 0.15 - MIDDLE, 2.0])],
        self_collides: false,
        ..solid("Bridge", thin("bridge.obj", 90, LENGTH), [1e6, 200.0, 0.006])
    };
    let load = Body {
        pose: Pose { position: [0.3, 2.3, 0.1], rotation_deg: [0.0, 20.0, 10.0] },
        ..solid("Load", Shape::Cube(CubeShape { cells: 4, size: 0.5 }), [5e4, 300.0, 0.08])
    };
    let mut scene = looking_at([0.4, 1.2, 0.0], 14.6, scene(bridge, Vec::new()));
    scene.bodies.push(load);
    turned(20.0, 12.0, scene)
}

/// The chair twice, with the same push at the start: the left one moves by its cells, the right one by its modes. There is
/// no gravity: it would nearly buckle legs as soft as these, and modes, computed about rest, do not show that.
pub(super) fn chair_modes() -> Scene {
    let mut scene = chair();
    let Some(chair) = scene.bodies.first().cloned() else { return scene };
    let beside = |name: &str, x: f64, moves_by| Body {
        name: name.to_owned(),
        pose: Pose { position: [x, chair.pose.position[1], 0.0], ..chair.pose },
        velocity: [0.0, 0.0, -0.3],
        moves_by,
        mode_count: 30,
        collides: false,
        self_collides: false,
        ..chair.clone()
    };
    scene.settings.gravity = [0.0; 3];
    scene.bodies = vec![beside("By cells", -0.6, MovesBy::Cells), beside("By modes", 0.6, MovesBy::Modes)];
    turned(25.0, 14.0, looking_at([0.0, 0.55, 0.0], 4.2, scene))
}

/// The bridge by its modes, with the same gust; a ball that swings to and fro knocks at its deck.
pub(super) fn bridge_modes() -> Scene {
    let mut scene = bridge();
    scene.bodies.truncate(1);
    for bridge in &mut scene.bodies {
        (bridge.moves_by, bridge.mode_count) = (MovesBy::Modes, 40);
    }
    let knocks = Motion::Oscillate(Oscillate { axis: [0.0, 0.0, 1.0], amplitude: 0.5, period_secs: 3.0 });
    let ball = Obstacle { name: "Ball".to_owned(), motion: Some(knocks), ..ball([0.0, 1.35, -1.2], 0.25) };
    scene.obstacles.push(ball);
    scene
}

/// A cow so firm that its cells would need many small steps. It moves, turns and swings by its modes, falls on a sphere and
/// tumbles off.
pub(super) fn spot_modes() -> Scene {
    let spot = Body {
        pose: Pose { position: [0.0, 1.35, 0.0], rotation_deg: [0.0, 60.0, 20.0] },
        moves_by: MovesBy::Modes,
        mode_count: 30,
        contact_on: ContactOn::Mesh,
        ..solid("Spot", Shape::Model(ModelShape { divisions: 20, ..builtin_model("spot.obj") }), [2e6, 300.0, 0.05])
    };
    turned(30.0, 14.0, looking_at([0.0, 0.85, 0.0], 4.6, scene(spot, vec![ball([0.3, 0.3, 0.05], 0.3)])))
}

/// A sheet without thickness that has no inside. It falls on its nose.
pub(super) fn shell() -> Scene {
    let shell = Body {
        pose: Pose { position: [0.0, 1.0, 0.0], rotation_deg: [0.0, 0.0, -12.0] },
        ..solid("Shell", thin("shell.obj", 36, 2.4), [2.5e5, 200.0, 0.025])
    };
    turned(35.0, 18.0, looking_at([0.0, 0.65, 0.0], 4.8, scene(shell, Vec::new())))
}

/// Three layers of four, one above the other, each turned another way. None folds so far that it would meet itself.
pub(super) fn many() -> Scene {
    let spot =
        || solid("Spot", Shape::Model(ModelShape { divisions: 12, length: 0.8, ..builtin_model("spot.obj") }), SOFT);
    let tree =
        || solid("Tree", Shape::Model(ModelShape { divisions: 10, length: 0.8, ..builtin_model("tree.obj") }), SOFT);
    let coupler = || {
        solid("Coupler", Shape::Model(ModelShape { divisions: 8, length: 0.6, ..builtin_model("coupler.obj") }), SOFT)
    };
    let chair = || solid("Chair", thin("chair.obj", 14, 0.95), STIFF);
    let shell = || solid("Shell", thin("shell.obj", 15, 1.1), STIFF);
    let bodies =
        [spot(), chair(), coupler(), shell(), tree(), chair(), spot(), shell(), coupler(), chair(), spot(), tree()];
    let place = |(number, body): (usize, Body)| {
        let (layer, number) = ((number / 4) as f64, number as f64);
        let angle = 0.5 * std::f64::consts::PI * (number % 4.0) + 0.8 * layer;
        let position = [0.5 * libm::cos(angle), 0.85 + layer, 0.5 * libm::sin(angle)];
        let rotation_deg = [50.0, 77.0, 33.0].map(|turn| (turn * number + 180.0) % 360.0 - 180.0);
        let name = format!("{} {}", body.name, number + 1.0);
        Body { name, pose: Pose { position, rotation_deg }, self_collides: false, ..body }
    };
    let bodies = bodies.into_iter().enumerate().map(place).collect();
    turned(30.0, 14.0, Scene { bodies, ..looking_at([0.0, 1.45, 0.0], 7.4, scene(Body::default(), Vec::new())) })
}

/// Young's modulus (Pa), density (kg/m³) and damping ratio of thick models.
const SOFT: [f64; 3] = [5e4, 200.0, 0.03];
/// The same for thin models, which would lie flat if they were as soft.
const STIFF: [f64; 3] = [2e5, 200.0, 0.02];

/// A carried model whose walls are thinner than a cell: every cell that they touch is filled.
fn thin(name: &str, divisions: u32, length: f64) -> Shape {
    let occupancy = OccupancyChoice::Solid;
    Shape::Model(ModelShape { divisions, occupancy, length, ..builtin_model(name) })
}

/// A body of Young's modulus (Pa), density (kg/m³) and damping ratio.
fn solid(name: &str, shape: Shape, [young_modulus, density, damping_ratio]: [f64; 3]) -> Body {
    let material = Material::Solid(Solid { young_modulus, density, damping_ratio, ..Solid::DEFAULT });
    Body { name: name.to_owned(), shape, material, ..Body::default() }
}

fn pin(min: [f64; 3], max: [f64; 3]) -> PinBox {
    PinBox { min, max }
}
