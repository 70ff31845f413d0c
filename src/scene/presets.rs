//! The scenes that the program carries. Tests, benches, the window and the command line use the same ones.

mod meeting;
mod models;
mod parts;

pub use parts::jelly;

use super::body::{Body, CubeShape, ModelShape, Pose, Shape, Skin};
use super::material::{Material, Spring, Springs};
use super::obstacle::{Cuboid, Cylinder, Motion, Obstacle, ObstacleShape, Oscillate, Plane, Turn};
use super::settings::Stepping;
use super::{ColorBy, Scene};
use parts::{ball, builtin_model, damped, in_steps_of, looking_at, mesh, scene, turned, u};

/// The preset that opens when none is asked for.
pub const DEFAULT: &str = "cube-on-plane";

/// A scene that the program carries.
#[derive(Clone, Copy, Debug)]
pub struct Preset {
    /// The name on the command line and in lists.
    pub name: &'static str,
    /// One line for a person.
    pub summary: &'static str,
    /// Builds the scene.
    pub build: fn() -> Scene,
}

/// Every preset, in the order of lists.
pub fn presets() -> &'static [Preset] {
    &PRESETS
}

/// A preset by its name.
pub fn preset(name: &str) -> Option<&'static Preset> {
    PRESETS.iter().find(|preset| preset.name == name)
}

/// The scene a model file opens in: jellified with default settings, dropped on the default ground, in its own colours
/// where it has some. `path` is as in [`ModelShape::path`].
pub fn drop_model(path: &str) -> Scene {
    let shape = ModelShape { path: path.to_owned(), ..ModelShape::for_new() };
    let file = path.rsplit(['/', '\\']).next().unwrap_or(path);
    let name = file.rsplit_once('.').map_or(file, |(stem, _)| stem);
    let mut scene = looking_at([0.0, 0.45, 0.0], 3.6, scene(model_body(name, shape, 1.1), Vec::new()));
    scene.view.color = ColorBy::Model;
    scene
}

/// Returns the scene to start with before it holds anything of one's own: the default ground.
pub fn ground_only() -> Scene {
    let mut scene = drop_model("");
    scene.bodies.clear();
    scene.view.color = ColorBy::Plain;
    scene
}

/// The step of presets so finely divided and so well damped that the stabilised scheme takes them, s: that scheme costs less
/// in longer steps.
const DAMPED_DT_SECS: f64 = 4e-3;

const PRESETS: [Preset; 27] = [
    Preset { name: DEFAULT, summary: "A jelly cube falls on the ground beside a sphere.", build: cube_on_plane },
    Preset {
        name: "cube-on-sphere",
        summary: "A cube lands off-centre on a sphere, turns and falls off.",
        build: cube_on_sphere,
    },
    Preset { name: "incline", summary: "A cube on a slope that friction holds.", build: incline },
    Preset { name: "incline-slide", summary: "A cube on a slope too steep for its friction.", build: incline_slide },
    Preset { name: "u-on-sphere", summary: "A U made of cells drops on a sphere.", build: u_on_sphere },
    Preset { name: "tree", summary: "A tree made of blocks falls on the ground.", build: tree },
    Preset {
        name: "coupler-7",
        summary: "An elastic coupler in 7 divisions, set down on the ground.",
        build: || coupler(7),
    },
    Preset { name: "coupler-8", summary: "The same coupler in 8 divisions.", build: || coupler(8) },
    Preset { name: "coupler-20", summary: "The same coupler in 20 divisions.", build: || coupler(20) },
    Preset { name: "coupler-40", summary: "The same coupler in 40 divisions.", build: || coupler(40) },
    Preset { name: "spot", summary: "A cow by Keenan Crane, jellified in 20 divisions.", build: spot },
    Preset {
        name: "chair",
        summary: "A flexible plastic chair sways as a jelly is thrown into it.",
        build: models::chair,
    },
    Preset {
        name: "bridge",
        summary: "A bridge of 310 loose parts, joined by its cells, sways under a gust and a load.",
        build: models::bridge,
    },
    Preset {
        name: "chair-modes",
        summary: "Two chairs without weight get the same push: one moves by its cells, the other by 30 modes.",
        build: models::chair_modes,
    },
    Preset {
        name: "bridge-modes",
        summary: "The bridge moved by 40 modes, which cost next to nothing; a ball knocks at it.",
        build: models::bridge_modes,
    },
    Preset {
        name: "spot-modes",
        summary: "A firm cow tumbles over a sphere by 30 modes, many times as fast as by its cells.",
        build: models::spot_modes,
    },
    Preset { name: "shell", summary: "The open body shell of a car falls on its nose.", build: models::shell },
    Preset { name: "many", summary: "A dozen jellified models fall together.", build: models::many },
    Preset {
        name: "exploding",
        summary: "Springs too stiff for the step: see what happens, and why.",
        build: exploding,
    },
    Preset {
        name: "broken",
        summary: "A soft cube hits the ground so hard that cells stay inside out.",
        build: broken,
    },
    Preset { name: "newton", summary: "A row of jelly cubes on ice is hit from one side.", build: meeting::newton },
    Preset {
        name: "hook",
        summary: "A heavy U falls into another that hangs, and hooks into it.",
        build: meeting::hook,
    },
    Preset { name: "stack", summary: "Five cubes of jelly stand on each other.", build: meeting::stack },
    Preset { name: "fold", summary: "A soft ribbon falls on its end and folds onto itself.", build: meeting::fold },
    Preset { name: "pile", summary: "A dozen jellies of four shapes fall into a bowl.", build: meeting::pile },
    Preset { name: "comb", summary: "A press that goes up and down squeezes a jelly into a comb.", build: comb },
    Preset { name: "conveyor", summary: "Jellies ride on turning rollers and fall off their end.", build: conveyor },
];

fn cube_on_plane() -> Scene {
    let cube = Body {
        name: "Jelly".to_owned(),
        pose: Pose { position: [0.0, 1.0, 0.0], rotation_deg: [5.0, 0.0, 8.0] },
        ..Body::default()
    };
    looking_at([0.6, 0.55, 0.0], 5.4, scene(cube, vec![ball([1.5, 0.4, -0.3], 0.4)]))
}

fn cube_on_sphere() -> Scene {
    let cube = Body {
        name: "Jelly".to_owned(),
        pose: Pose { position: [0.22, 1.65, 0.06], rotation_deg: [0.0, 20.0, 0.0] },
        ..Body::default()
    };
    // It rolls for six metres along x: seen from behind, all of that is in the picture.
    turned(-55.0, 18.0, looking_at([2.65, 0.6, 0.05], 9.0, scene(cube, vec![ball([0.0, 0.45, 0.0], 0.45)])))
}

/// Held with μ = 0.6: tan 20° = 0.36.
fn incline() -> Scene {
    on_incline(20.0, 0.6)
}

/// Not held with μ = 0.3: tan 30° = 0.58.
fn incline_slide() -> Scene {
    on_incline(30.0, 0.3)
}

/// A cube aligned with a slope and almost touching it; the slope rises towards +x.
fn on_incline(angle_deg: f64, friction: f64) -> Scene {
    const CENTER: [f64; 3] = [0.0, 1.4, 0.0];
    const GAP: f64 = 1e-4;
    let shape = CubeShape::default();
    let (sin, cos) = (libm::sin(angle_deg.to_radians()), libm::cos(angle_deg.to_radians()));
    let (along, above) = (0.8, shape.size / 2.0 + GAP);
    let cube = Body {
        name: "Jelly".to_owned(),
        pose: Pose {
            position: [CENTER[0] + cos * along - sin * above, CENTER[1] + sin * along + cos * above, CENTER[2]],
            rotation_deg: [0.0, 0.0, angle_deg],
        },
        shape: Shape::Cube(shape),
        ..Body::default()
    };
    let plane = Plane { center: CENTER, rotation_deg: [0.0, 0.0, angle_deg], half_extents: [2.0, 1.2] };
    let slope = Obstacle {
        name: "Slope".to_owned(),
        shape: ObstacleShape::Plane(plane),
        friction_static: friction,
        friction_dynamic: friction,
        ..Obstacle::default()
    };
    turned(-35.0, 24.0, looking_at([-0.2, 0.9, 0.1], 7.8, scene(cube, vec![slope])))
}

fn u_on_sphere() -> Scene {
    const SIZE: f64 = 0.11;
    let body = Body {
        name: "U".to_owned(),
        shape: u(3, SIZE),
        pose: Pose { position: [0.2, 1.9, 0.05], rotation_deg: [0.0, 25.0, 0.0] },
        material: jelly(SIZE),
        ..Body::default()
    };
    looking_at([0.0, 0.9, 0.0], 6.0, scene(body, vec![ball([0.0, 0.5, 0.0], 0.5)]))
}

fn tree() -> Scene {
    let shape = ModelShape { divisions: 10, length: 1.5, ..builtin_model("tree.obj") };
    let body = Body { skin: Skin::Cells, ..model_body("Tree", shape, 1.15) };
    looking_at([0.0, 0.8, 0.0], 6.0, scene(body, Vec::new()))
}

/// Set down rather than dropped: its thin webs would swing for long. The finest one is set down from lower: more damping
/// would quiet it sooner, but cost many substeps.
fn coupler(divisions: u32) -> Scene {
    let (height, damping) = if divisions > 20 { (0.51, 1.7) } else { (0.65, 2.0) };
    let body = model_body("Coupler", ModelShape { divisions, ..builtin_model("coupler.obj") }, height);
    let turned = Pose { rotation_deg: [0.0, 30.0, 0.0], ..body.pose };
    let material = damped(&body.material, damping);
    let scene = scene(Body { skin: Skin::Cells, pose: turned, material, ..body }, Vec::new());
    let dt = match divisions {
        ..20 => scene.settings.dt,
        20..=39 => DAMPED_DT_SECS,
        _ => 0.5 * DAMPED_DT_SECS,
    };
    in_steps_of(dt, looking_at([0.0, 0.5, 0.0], 3.4, scene))
}

fn spot() -> Scene {
    let body = model_body("Spot", builtin_model("spot.obj"), 0.65);
    let turned = Pose { rotation_deg: [0.0, -30.0, 0.0], ..body.pose };
    let material = damped(&body.material, 3.0);
    let spot = scene(Body { pose: turned, material, ..body }, Vec::new());
    in_steps_of(DAMPED_DT_SECS, looking_at([0.0, 0.45, 0.0], 3.2, spot))
}

/// GC Fig 23: structural springs a little too stiff for a step of 1 ms that nothing divides. The cube falls well, and the
/// first touch of the ground excites the mode that grows.
fn exploding() -> Scene {
    let damping = 0.01;
    let soft = Springs::default();
    let stiff = Springs {
        structural: Spring { stiffness: 1010.0, damping },
        shear: Spring { damping, ..soft.shear },
        bending: Spring { damping, ..soft.bending },
        ..soft
    };
    let cube = Body {
        name: "Jelly".to_owned(),
        pose: Pose { position: [0.0, 1.2, 0.0], rotation_deg: [5.0, 0.0, 8.0] },
        material: Material::Springs(stiff),
        ..Body::default()
    };
    let mut scene = scene(cube, Vec::new());
    scene.settings.stepping = Stepping::Manual;
    scene
}

/// GC Fig 24: thrown at 16 m/s, tilted, with springs half as stiff as usual and no recovery of crushed cells. It comes to
/// rest in a wrong shape in which its springs balance. Few cells, so that each can be seen.
fn broken() -> Scene {
    let springs = Springs::default();
    let soft = |of: Spring| Spring { stiffness: 0.5 * of.stiffness, ..of };
    let cube = Body {
        name: "Jelly".to_owned(),
        pose: Pose { position: [0.0, 1.4, 0.0], rotation_deg: [5.0, 0.0, 30.0] },
        velocity: [0.0, -16.0, 0.0],
        shape: Shape::Cube(CubeShape { cells: 5, size: 1.0 }),
        material: Material::Springs(Springs {
            structural: soft(springs.structural),
            shear: soft(springs.shear),
            bending: soft(springs.bending),
            particle_mass: 0.03,
        }),
        ..Body::default()
    };
    let mut scene = looking_at([0.0, 0.75, 0.0], 4.6, scene(cube, Vec::new()));
    scene.settings.stepping = Stepping::Manual;
    scene.settings.dt = 5e-4;
    scene.settings.inversion_recovery = false;
    scene.view.overlays.cells = true;
    scene
}

/// The jelly's cells are as large as the teeth are thick: its particles meet every tooth.
fn comb() -> Scene {
    const SIZE: f64 = 0.6;
    const CELLS: u32 = 10;
    let cube = Body {
        name: "Jelly".to_owned(),
        shape: Shape::Cube(CubeShape { cells: CELLS, size: SIZE }),
        pose: Pose { position: [0.0, 0.8, 0.0], ..Pose::default() },
        material: damped(&jelly(SIZE / f64::from(CELLS)), 2.0),
        ..Body::default()
    };
    let press = Cuboid { center: [0.0, 1.4, 0.0], half_extents: [0.5, 0.05, 0.4], ..Cuboid::default() };
    let down = Oscillate { axis: [0.0, -1.0, 0.0], amplitude: 0.4, period_secs: 4.0 };
    let press = Obstacle {
        name: "Press".to_owned(),
        shape: ObstacleShape::Box(press),
        motion: Some(Motion::Oscillate(down)),
        ..Obstacle::default()
    };
    let comb = mesh("Comb", "comb.obj", 1.2);
    turned(-40.0, 18.0, looking_at([0.0, 0.7, 0.0], 5.0, scene(cube, vec![comb, press])))
}

/// The tops of the rollers move along x at one metre a second.
fn conveyor() -> Scene {
    const RADIUS: f64 = 0.2;
    const HEIGHT: f64 = 0.6;
    let roller = |place: u32| {
        let center = [0.42 * f64::from(place) - 1.8, HEIGHT, 0.0];
        let shape = Cylinder { center, rotation_deg: [90.0, 0.0, 0.0], radius: RADIUS, half_height: 0.7 };
        Obstacle {
            name: format!("Roller {}", place + 1),
            shape: ObstacleShape::Cylinder(shape),
            motion: Some(Motion::Turn(Turn { axis: [0.0, 0.0, -1.0], turns_per_sec: 0.8 })),
            ..Obstacle::default()
        }
    };
    let jelly_at = |name: &str, cells: u32, size: f64, x: f64| Body {
        name: name.to_owned(),
        shape: Shape::Cube(CubeShape { cells, size }),
        pose: Pose { position: [x, HEIGHT + RADIUS + 0.55 * size, 0.0], ..Pose::default() },
        material: damped(&jelly(size / f64::from(cells)), 2.0),
        ..Body::default()
    };
    let rollers = (0..9).map(roller).collect();
    let bodies = vec![jelly_at("Small jelly", 5, 0.5, -1.5), jelly_at("Jelly", 8, 0.8, -0.4)];
    let rolling = scene(Body::default(), rollers);
    turned(-25.0, 22.0, Scene { bodies, ..looking_at([0.3, 0.6, 0.0], 8.0, rolling) })
}

fn model_body(name: &str, shape: ModelShape, height: f64) -> Body {
    let length = if shape.length > 0.0 { shape.length } else { 1.0 };
    let material = jelly(length / f64::from(shape.divisions));
    let pose = Pose { position: [0.0, height, 0.0], ..Pose::default() };
    Body { name: name.to_owned(), shape: Shape::Model(shape), pose, material, ..Body::default() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::param;

    #[test]
    fn every_preset_is_sound_and_stands_on_its_own_ground() {
        for preset in presets() {
            let scene = (preset.build)();
            assert_eq!(param::validate(&scene), [], "{}", preset.name);
            assert_eq!(crate::scene::warnings(&scene), Vec::<String>::new(), "{}", preset.name);
            assert_eq!(scene.obstacles[0].name, "Ground", "{}", preset.name);
            assert!(preset.summary.ends_with('.'), "the summary of {} is a sentence", preset.name);
        }
    }

    #[test]
    fn a_name_finds_its_preset_and_no_other() {
        for listed in presets() {
            assert_eq!(preset(listed.name).map(|found| found.summary), Some(listed.summary), "{}", listed.name);
        }
        assert!(preset("nothing").is_none(), "an unknown name finds none");
        assert!(preset(DEFAULT).is_some(), "the default exists");
    }

    #[test]
    fn a_model_file_gives_its_name_to_the_body() {
        let scene = drop_model("some/folder/cow.obj");
        assert_eq!(scene.bodies[0].name, "cow");
        assert_eq!(param::validate(&scene), []);
    }
}
