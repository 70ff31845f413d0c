//! The input of every case, and the checks of its outcome.

use std::io;
use std::path::PathBuf;
use std::time::Duration;

use gelatin::disk::ReadError;
use gelatin::geometry::import::{Detail, HeldFiles, ImportError, Imported, load_held, parse};
use gelatin::geometry::voxel::{Keep, OccupancyChoice, VoxelizeOptions, voxelize};
use gelatin::math::rng::Rng;
use gelatin::scene::{Scene, param, path, presets};
use gelatin::session::Session;
use gelatin::text::echo;

use crate::models;
use crate::mutate::{below, bytes, extreme, pick, text};
use crate::pictures::Painted;

/// The part of the program that gets the input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Target {
    /// The reader of OBJ files, and the filling of their meshes with cells.
    Obj,
    /// As `Obj`, for STL files, text and binary.
    Stl,
    /// As `Obj`, for PLY files, text and binary in both byte orders.
    Ply,
    /// As `Obj`, for glTF files, text and binary.
    Gltf,
    /// The readers of an OBJ file's materials and of the pictures that they name.
    Materials,
    /// The reader of scenes, and the sandbox that opens them.
    Scene,
    /// The reader of states, and the simulation that continues from them.
    State,
    /// `--set`.
    Set,
    /// A target with known faults.
    Planted,
}

const MODELS: [&str; 3] = [
    "# a box\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nf 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\n\
     f 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n",
    "mtllib a.mtl\no first\ng a b\nusemtl red\ns 1\nv 0 0 0 1 1 1\r\nv 1.5e0 0 0 \\\n\nvt 0 0\nvn 0 0 1\nv 1 1 .5\nv 0 1 -3\n\
     f 1/1 2/1 3/1\nf -1 -2 -3 -4\nl 1 2\np 3\nf 1//1 2//1 4//1\n",
    "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0.5 0.5 2\nf 1 2 3 4 5 6\nf 1 2 7\nf 2 3 4 7\nf 4 5 6 7\nf 6 1 7\n",
];

/// A triangle painted by a material of a file beside it.
const PAINTED: &str = "mtllib a.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 1 1 1\nvt 0 0\nvt 1 0\nvt 0.5 7\nf 1/1 2/2 3/3\n";

const MODEL_WORDS: [&str; 16] =
    ["v ", "f ", "l ", "vn ", "o ", "\n", "\\\n", "/", "//", " 1", " -1", "#", "curv ", "usemtl ", "1/1/1 ", "\u{fe}"];

const SCENES: [&str; 5] = [
    "(version: 1, settings: (dt: 0.001, integrator: semi_implicit, stepping: auto, gravity: (0, -9.81, 0)),\n\
     bodies: [(name: \"A\", shape: cube(cells: 3, size: 0.5), pose: (position: (0, 1, 0), rotation_deg: (0, 10, 0)),\n\
     velocity: (1, 0, 0), material: springs(structural: (stiffness: 100, damping: 0.1), shear: (stiffness: 50, \
     damping: 0.1), bending: (stiffness: 20, damping: 0.1), particle_mass: 0.01), pins: [(min: (-1, 0.2, -1), \
     max: (1, 1, 1))])],\nobstacles: [(plane: (center: (0, 0, 0), half_extents: (5, 5)), friction_static: 0.5)])",
    "(version: 1, bodies: [(shape: cells(list: [(0, 0, 0), (1, 0, 0), (1, 1, 0)], size: 0.2), material: \
     solid(young_modulus: 1e5, density: 1000, damping_ratio: 0.1))],\nobstacles: [(sphere: (center: (0, -1, 0), \
     radius: 0.5), stiffness: 1e4), (plane: ())], view: (color: strain))",
    "(version: 1, settings: (dt: 0.01, integrator: implicit, contact: thesis), bodies: [(shape: \
     model(path: \"builtin:spot.obj\", divisions: 4, length: 1.0, occupancy: auto, keep: largest)), (shape: cube(cells: 2))])",
    "(version: 1, bodies: [(shape: model(path: \"embedded:a/m.obj\", divisions: 3))], obstacles: [(mesh: (path: \
     \"embedded:a/m.obj\", center: (0, -2, 0)))],\nmodels: [(path: \"a/m.obj\", bytes: 64, deflated: \
     \"eNorUzAAQa4yIGkEpo3hfAMFU640BUOguDGYNlYwAdMmCkZA2ghIG3MBAH9tC2k=\")])",
    "(version: 1, bodies: [(shape: cube(cells: 2), material: solid(young_modulus: 1e5, density: 500), \
     inlays: [(min: (-1, 0, -1), max: (1, 1, 1), solid: (young_modulus: 1e6))], pins: [(min: (-1, 0.2, -1), max: (1, 1, \
     1))], moves_by: modes, mode_count: 7, skin: cells, hidden: true), (shape: model(path: \"embedded:b.obj\", \
     divisions: 3, mass_from: samples), parts: [(name: \"b\", solid: (density: 100))], contact_on: mesh, \
     self_collides: false, friction_dynamic: 0.2)],\nobstacles: [(box: (center: (0, -1, 0)), motion: turn(axis: (0, 1, \
     0), turns_per_sec: 0.5)), (capsule: (half_height: 0.2), motion: oscillate(amplitude: 0.1, period_secs: 2)), \
     (cylinder: (radius: 0.1, rotation_deg: (0, 0, 90)), hidden: true)],\nmodels: [(path: \"b.obj\", bytes: 132, \
     deflated: \"eNo9i8ENwCAMA/+ZwiNgKJB12kfZgPnrRhHK4y6xs3DbRvlH5CGD5VCWOTNn5rQXFxpqWMfAhMuoy0C3hUdbVWNiyJrajhlfVN/tA19uF/4=\")])",
];

const SCENE_WORDS: [&str; 34] = [
    "(",
    ")",
    "[",
    "]",
    ",",
    ":",
    "\"",
    "version: 1",
    "bodies: ",
    "cells: 199",
    "cube(",
    "cells(list: ",
    "(0, 0, 0),",
    "(2147483647, 0, -2147483648),",
    "size: ",
    "true",
    "None",
    "Some(",
    "r#",
    "/*",
    "*/",
    "//",
    "\\u{",
    "'",
    "settings: (",
    "solid(",
    "obstacles: [(plane: ())]",
    "allow_implicit: false",
    "dt: 1e-6",
    "embedded:",
    "models: [(path: \"b\", bytes: 1073741824, deflated: \"eJztwQEBAAAAgJD+r+4ICgAAAAAAAAA=\")]",
    "bytes: 0",
    "AAAA",
    "\u{1b}[2J",
];

const VALUES: [&str; 12] = [
    "true",
    "implicit",
    "(0, 1, 0)",
    "[1, 2",
    "auto",
    "\"",
    "solid(young_modulus: 1e9)",
    "cube(cells: 3)",
    "null",
    "",
    "(min: (0,0,0), max: (1,1,1))",
    "\u{7}",
];

impl Target {
    pub(crate) const ALL: [Self; 9] = [
        Self::Obj,
        Self::Stl,
        Self::Ply,
        Self::Gltf,
        Self::Materials,
        Self::Scene,
        Self::State,
        Self::Set,
        Self::Planted,
    ];

    /// The most processor time of a case.
    pub(crate) fn processor_time(self) -> Duration {
        Duration::from_secs(if self == Self::Planted { 1 } else { 10 })
    }

    /// The input of a case.
    pub(crate) fn input(self, seed: u64, case: u64) -> Vec<u8> {
        let mut rng = Rng::new(seed.wrapping_mul(0x9e37_79b9).wrapping_add(case));
        // The first numbers of neighbouring seeds are alike in nothing, but the case is.
        rng.next_u64();
        match self {
            Self::Obj => text(&mut rng, &MODELS, &MODEL_WORDS),
            Self::Stl => models::stl(&mut rng),
            Self::Ply => models::ply(&mut rng),
            Self::Gltf => models::gltf(&mut rng),
            Self::Materials => Painted::draw(&mut rng).to_bytes(),
            Self::Scene => text(&mut rng, &SCENES, &SCENE_WORDS),
            Self::State => state(&mut rng),
            Self::Set => assignment(&mut rng).into_bytes(),
            Self::Planted => Vec::new(),
        }
    }

    /// Gives an input to the program; panics where something is wrong.
    pub(crate) fn try_input(self, input: &[u8]) {
        match self {
            Self::Obj => try_model(parse(input, "m.obj")),
            Self::Stl => try_model(parse(input, "m.stl")),
            Self::Ply => try_model(parse(input, "m.ply")),
            Self::Gltf => try_model(parse(input, "m.glb")),
            Self::Materials => try_painted(&Painted::from_bytes(input)),
            Self::Scene => try_scene(input),
            Self::State => try_state(input),
            Self::Set => try_set(input),
            Self::Planted => (),
        }
    }

    /// Runs a case of planted faults.
    pub(crate) fn try_case(self, case: u64) {
        match case {
            3 if self == Self::Planted => panic!("it is planted"),
            5 if self == Self::Planted => assert!(vec![1_u8; 4 << 30].iter().all(|byte| *byte == 1), "it is there"),
            8 if self == Self::Planted => {
                let mut rng = Rng::new(8);
                while rng.unit() < 2.0 {}
            }
            _ => (),
        }
    }
}

/// Checks that a message is one short text without terminal escapes.
fn check_words(words: &str) {
    assert!(words.len() < 2500, "{} bytes are said", words.len());
    assert!(!words.is_empty() && !words.contains('\u{1b}'), "{words:?}");
}

fn try_model(imported: Result<Imported, ImportError>) {
    let Imported { mesh, paint, warnings, .. } = match imported {
        Ok(imported) => imported,
        Err(error) => return check_words(&error.to_string()),
    };
    for warning in &warnings {
        check_words(warning);
    }
    assert!(mesh.triangles.iter().flatten().all(|&v| (v as usize) < mesh.positions.len()), "indices in range");
    assert!(mesh.positions.iter().all(|position| position.is_finite()), "finite positions");
    if let Some(paint) = paint {
        let corners =
            mesh.triangles.iter().enumerate().flat_map(|(at, corners)| corners.map(|vertex| (at, vertex as usize)));
        let mut tints = corners.map(|(triangle, vertex)| paint.tint(triangle, vertex));
        assert!(tints.all(|[.., there]| matches!(there, 0 | 255)), "a colour or none");
        for (texture, places) in (0..mesh.triangles.len()).filter_map(|triangle| paint.texture(triangle)) {
            assert!(usize::from(texture) < paint.textures().len(), "a picture that is there");
            assert!(places.as_flattened().iter().all(|along| along.is_finite()), "and a place in it");
        }
    }
    let options = VoxelizeOptions { divisions: 6, occupancy: OccupancyChoice::Auto, keep: Keep::All };
    match voxelize(&mesh, &options, &()) {
        Ok(filled) => assert!(filled.report.cells > 0, "success means cells"),
        Err(error) => check_words(&error.to_string()),
    }
}

/// Reads a triangle with its material file and picture.
fn try_painted(painted: &Painted) {
    let imported = load_held(painted, "m.obj", Detail::Pictures, &()).expect("the model itself is whole");
    assert_eq!(imported.mesh.triangles.len(), 1, "none is lost");
    try_model(Ok(imported));
}

impl HeldFiles for Painted {
    fn read(&self, place: &str, limit: u64) -> Result<Vec<u8>, ReadError> {
        let bytes = match place {
            "m.obj" => PAINTED.as_bytes(),
            "a.mtl" => &self.materials,
            "p.png" => &self.picture,
            _ => return Err(io::Error::from(io::ErrorKind::NotFound).into()),
        };
        if bytes.len() as u64 > limit { Err(ReadError::TooLarge(limit)) } else { Ok(bytes.to_vec()) }
    }

    fn shown(&self, place: &str) -> String {
        place.to_owned()
    }
}

fn try_scene(input: &[u8]) {
    let text = String::from_utf8_lossy(input);
    let scene = match Scene::from_ron(&text, "a.ron") {
        Ok(scene) => scene,
        Err(error) => return check_words(&error.to_string()),
    };
    assert!(param::validate(&scene).is_empty(), "what is read is within its ranges");
    let written = scene.to_ron().expect("what was read can be written");
    assert_eq!(Scene::from_ron(&written, "b.ron").expect("and read again"), scene, "the same scene");
    match Session::new(scene, PathBuf::from("/nowhere"), String::new()) {
        Ok(mut session) => {
            session.find_modes(None, &());
            session.advance(Duration::from_millis(2), Duration::from_millis(100));
        }
        Err(error) => check_words(&echo(&error.to_string())),
    }
}

/// The scenes of the states: two small bodies, one of them watched, on a plane; a modal body beside a body that meets
/// itself, meets a moving obstacle with its mesh, and keeps its accelerations.
const OF_STATES: [&str; 2] = [
    "(version: 1, bodies: [(shape: cube(cells: 2)), (shape: cube(cells: 1), pose: (position: (3, 1, 0)))], \
     obstacles: [(plane: ())])",
    "(version: 1, settings: (integrator: verlet), bodies: [(shape: cube(cells: 2), material: solid(young_modulus: 1e5, \
     density: 500), pins: [(min: (-1, 0.2, -1), max: (1, 1, 1))], moves_by: modes, mode_count: 5), (shape: model(path: \
     \"embedded:a/m.obj\", divisions: 2, length: 1), pose: (position: (3, 0.5, 0)), velocity: (0, -4, 0), material: \
     solid(young_modulus: 2e3, density: 500), contact_on: mesh)], obstacles: [(plane: ()), (sphere: (center: (3, -0.4, \
     0), radius: 0.5), motion: oscillate(axis: (1, 0, 0), amplitude: 0.2, period_secs: 0.5))], models: [(path: \
     \"a/m.obj\", bytes: 64, deflated: \"eNorUzAAQa4yIGkEpo3hfAMFU640BUOguDGYNlYwAdMmCkZA2ghIG3MBAH9tC2k=\")])",
];

fn session(text: &str) -> Session {
    let scene = Scene::from_ron(text, "s.ron").expect("a scene");
    let mut session = Session::new(scene, PathBuf::new(), "s".to_owned()).expect("it resolves");
    session.find_modes(None, &());
    session
}

/// A state with changes, in most cases sealed again.
fn state(rng: &mut Rng) -> Vec<u8> {
    let mut session = session(OF_STATES[below(rng, OF_STATES.len())]);
    for _ in 0..below(rng, 4) * 40 {
        session.step();
    }
    let mut state = session.state_bytes();
    state.truncate(state.len() - 8);
    let lines = state.iter().enumerate().filter(|(_, byte)| **byte == b'\n');
    let text = lines.map(|(at, _)| at).nth(1).expect("two lines of text");
    for _ in 0..=below(rng, 3) {
        match below(rng, 5) {
            0 => bytes(rng, &mut state),
            // A word at the beginning, where the counts are, or anywhere.
            1 | 2 => {
                let end = if below(rng, 2) == 0 { text + 90 } else { state.len() - 8 };
                let at = (text + below(rng, end.saturating_sub(text).max(1))).min(state.len() - 8);
                let words = [0, 1, 2, 25, 1 << 24, u64::MAX, 1 << 63, f64::NAN.to_bits(), f64::INFINITY.to_bits()];
                let word = pick(rng, &words).to_le_bytes();
                state[at..at + 8].copy_from_slice(&word);
            }
            3 => {
                let at = text + 1 + 4 * below(rng, (state.len() - text - 8) / 4);
                let number: f32 = extreme(rng).parse().unwrap_or(f32::NAN);
                state[at..at + 4].copy_from_slice(&number.to_le_bytes());
            }
            _ => {
                let length = below(rng, state.len());
                if below(rng, 4) == 0 { state.truncate(length) } else { state.extend(vec![0; length % 100]) }
            }
        }
        if state.len() < text + 100 {
            break;
        }
    }
    let fnv = |hash: u64, &byte: &u8| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
    let sum = state.iter().fold(0xcbf2_9ce4_8422_2325_u64, fnv);
    state.extend((if below(rng, 8) == 0 { !sum } else { sum }).to_le_bytes());
    state
}

/// Loads a state into a session of its own scene, and into those of others.
fn try_state(input: &[u8]) {
    for scene in OF_STATES {
        try_state_with(session(scene), input);
    }
}

fn try_state_with(mut session: Session, input: &[u8]) {
    let before = session.simulation().hash();
    if let Err(error) = session.set_state_bytes(input) {
        check_words(&error.to_string());
        assert_eq!(session.simulation().hash(), before, "what is refused changes nothing");
        return;
    }
    assert!(session.simulation().diagnostics().finite, "what is taken up is finite");
    let begun = session.simulation().state().steps;
    // Either the step ends, or the simulation reports that it is broken.
    assert!(!session.step() || session.simulation().state().steps > begun, "a step is a step");
    session.step();
    assert!(session.simulation().state().position.iter().all(|at| at.is_finite()), "it stays finite");
}

fn assignment(rng: &mut Rng) -> String {
    let paths = [
        "settings.dt",
        "settings.gravity",
        "settings.integrator",
        "bodies.0.shape.cube.cells",
        "bodies.0.material.springs.structural.stiffness",
        "bodies.0.material.solid.young_modulus",
        "bodies.0.pose.position",
        "bodies.0.pins",
        "bodies",
        "obstacles.0.plane.half_extents",
        "obstacles.0.sphere.radius",
        "view.color",
        "bodies.0",
        "",
    ];
    let mut path = (*pick(rng, &paths)).to_owned().into_bytes();
    if below(rng, 3) == 0 {
        path = text(rng, &paths, &[".", "0", "bodies", "-1", "4294967296"]);
    }
    let mut value = match below(rng, 3) {
        0 => extreme(rng).as_bytes().to_vec(),
        1 => pick(rng, &VALUES).as_bytes().to_vec(),
        _ => text(rng, &SCENES, &SCENE_WORDS),
    };
    if below(rng, 3) == 0 {
        bytes(rng, &mut value);
    }
    format!("{}={}", String::from_utf8_lossy(&path), String::from_utf8_lossy(&value))
}

fn try_set(input: &[u8]) {
    let text = String::from_utf8_lossy(input);
    let Some((name, value)) = text.split_once('=') else { return };
    let mut scene = (presets::preset("cube-on-plane").expect("a preset").build)();
    let before = scene.clone();
    match path::set(&mut scene, name, value) {
        Ok(()) => {
            let problems = param::validate(&scene);
            problems.iter().take(1).for_each(|problem| check_words(&problem.to_string()));
            assert!(!problems.is_empty() || scene.to_ron().is_ok(), "what was set can be written");
        }
        Err(error) => {
            check_words(&error.to_string());
            assert_eq!(scene, before, "what is refused changes nothing");
        }
    }
}

#[test]
fn what_is_mutated_is_good() {
    for text in SCENES {
        let scene = Scene::from_ron(text, "a.ron").unwrap();
        Session::new(scene, PathBuf::from("/nowhere"), String::new()).unwrap();
    }
    for text in OF_STATES {
        let mut begun = session(text);
        (0..40).for_each(|_| assert!(begun.step()));
        session(text).set_state_bytes(&begun.state_bytes()).unwrap();
    }
    for text in MODELS {
        parse(text.as_bytes(), "m.obj").unwrap();
    }
}
