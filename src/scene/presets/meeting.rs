//! Bodies that meet each other, and one that meets itself.

use super::parts::{damped, jelly, looking_at, mesh, scene, turned, u};
use crate::scene::body::{Body, CellsShape, CubeShape, PinBox, Pose, Shape, Skin};
use crate::scene::material::{Material, Spring, Springs};
use crate::scene::{Obstacle, Scene};

/// Without friction: the motion of the first cube passes to the last.
pub(super) fn newton() -> Scene {
    const SIZE: f64 = 0.4;
    let cube = |place: u32| Body {
        name: format!("Jelly {}", place + 1),
        shape: Shape::Cube(CubeShape { cells: 8, size: SIZE }),
        pose: Pose { position: [0.55 * f64::from(place) - 1.1, 0.5 * SIZE, 0.0], ..Pose::default() },
        material: damped(&jelly(SIZE / 8.0), 0.2),
        friction_static: 0.0,
        friction_dynamic: 0.0,
        ..Body::default()
    };
    let mut bodies: Vec<Body> = (0..5).map(cube).collect();
    bodies[0].pose.position[0] = -1.8;
    bodies[0].velocity = [3.0, 0.0, 0.0];
    let mut scene = turned(15.0, 16.0, looking_at([0.5, 0.2, 0.0], 7.2, scene(Body::default(), Vec::new())));
    scene.bodies = bodies;
    let ice = &mut scene.obstacles[0];
    (ice.friction_static, ice.friction_dynamic) = (0.0, 0.0);
    scene
}

/// The falling U is turned across the hanging one: its bridge goes between the other's legs, its own legs on either side.
pub(super) fn hook() -> Scene {
    const SIZE: f64 = 0.1;
    let body = |name: &str, pose: Pose| Body {
        name: name.to_owned(),
        shape: u(2, SIZE),
        pose,
        material: damped(&jelly(SIZE), 2.0),
        skin: Skin::Cells,
        ..Body::default()
    };
    let mut held = body("Hanging", Pose { position: [0.0, 1.8, 0.0], ..Pose::default() });
    held.pins = vec![PinBox { min: [-1.0, 0.25, -1.0], max: [1.0; 3] }];
    let mut heavy = body("Heavy", Pose { position: [0.0, 1.8, 0.0], rotation_deg: [180.0, 90.0, 0.0] });
    if let Material::Springs(springs) = &mut heavy.material {
        springs.particle_mass *= 5.0;
    }
    let mut scene = looking_at([0.0, 1.3, 0.0], 4.6, scene(held, Vec::new()));
    scene.bodies.push(heavy);
    turned(35.0, 12.0, scene)
}

/// Set down with a small gap between each cube and the next.
pub(super) fn stack() -> Scene {
    const SIZE: f64 = 0.6;
    const CELLS: u32 = 5;
    let cube = |place: u32| Body {
        name: format!("Jelly {}", place + 1),
        shape: Shape::Cube(CubeShape { cells: CELLS, size: SIZE }),
        pose: Pose { position: [0.0, 0.5 * SIZE + 0.62 * f64::from(place), 0.0], ..Pose::default() },
        material: damped(&jelly(SIZE / f64::from(CELLS)), 3.0),
        ..Body::default()
    };
    let bodies = (0..5).map(cube).collect();
    Scene { bodies, ..looking_at([0.0, 1.4, 0.0], 7.0, scene(Body::default(), Vec::new())) }
}

/// So soft that it buckles under its own weight, and a little aslant, so that it buckles the same way every time.
pub(super) fn fold() -> Scene {
    let spring = |stiffness: f64| Spring { stiffness, damping: 0.02 };
    let ribbon = Body {
        name: "Ribbon".to_owned(),
        shape: Shape::Cells(CellsShape { list: (0..160).map(|cell| [cell % 5, cell / 5, 0]).collect(), size: 0.06 }),
        pose: Pose { position: [0.0, 1.2, 0.0], rotation_deg: [3.0, 0.0, 0.0] },
        velocity: [0.0, -3.0, 0.0],
        material: Material::Springs(Springs {
            structural: spring(8.0),
            shear: spring(8.0),
            bending: spring(1.0),
            particle_mass: 0.004,
        }),
        ..Body::default()
    };
    turned(50.0, 15.0, looking_at([0.0, 0.8, 0.2], 4.2, scene(ribbon, Vec::new())))
}

/// Cubes, balls, bars and tiles of cells, one after another.
pub(super) fn pile() -> Scene {
    const SIZE: f64 = 0.11;
    let filled = |dims: [i32; 3]| {
        let rows = (0..dims[2]).flat_map(move |k| (0..dims[1]).map(move |j| [j, k]));
        rows.flat_map(move |[j, k]| (0..dims[0]).map(move |i| [i, j, k])).collect::<Vec<_>>()
    };
    let is_round = |cell: &[i32; 3]| cell.iter().map(|&at| (2 * at - 3) * (2 * at - 3)).sum::<i32>() <= 24;
    let ball = filled([4; 3]).into_iter().filter(is_round).collect();
    let shapes = [filled([3; 3]), ball, filled([6, 2, 2]), filled([4, 2, 3])];
    let body = |place: usize| {
        let (number, angle) = (place as f64, 2.4 * place as f64);
        let position = [0.3 * libm::cos(angle), 0.75 + 0.3 * number, 0.3 * libm::sin(angle)];
        Body {
            name: format!("Jelly {}", place + 1),
            shape: Shape::Cells(CellsShape { list: shapes[place % 4].clone(), size: SIZE }),
            pose: Pose { position, rotation_deg: [20.0, 37.0, 53.0].map(|turn| (turn * number) % 180.0) },
            material: damped(&jelly(SIZE), 2.0),
            ..Body::default()
        }
    };
    let bowl = Obstacle { friction_static: 0.3, friction_dynamic: 0.3, ..mesh("Bowl", "bowl.obj", 2.6) };
    let bodies = (0..12).map(body).collect();
    turned(-30.0, 34.0, Scene { bodies, ..looking_at([0.0, 1.8, 0.0], 11.5, scene(Body::default(), vec![bowl])) })
}
