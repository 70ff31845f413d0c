//! Models in every format: one tetrahedron, always filled with the same cells.

use serde_json::Value;

use crate::bad_input::{FAILED, USAGE, refused};
use crate::program::Folder;

const PLACES: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [0.0, 2.0, 0.0], [3.0, 0.0, 0.0], [0.0, 0.0, 5.0]];
const FACES: [[u8; 3]; 4] = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];

/// The numbers of one line of a text.
fn line<T: ToString>(numbers: &[T]) -> String {
    numbers.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
}

fn obj() -> String {
    let vertices = PLACES.map(|place| format!("v {}\n", line(&place)));
    let faces = FACES.map(|face| format!("f {}\n", line(&face.map(|corner| corner + 1))));
    [vertices.concat(), faces.concat()].concat()
}

fn stl() -> Vec<u8> {
    let mut bytes = [&b"solid in name only"[..], &[0; 62], &4_u32.to_le_bytes()].concat();
    for face in FACES {
        bytes.extend([0; 12]);
        bytes.extend(face.iter().flat_map(|&corner| PLACES[usize::from(corner)]).flat_map(f32::to_le_bytes));
        bytes.extend([0; 2]);
    }
    bytes
}

fn ply() -> String {
    let places = PLACES.map(|place| line(&place) + "\n").concat();
    let faces = FACES.map(|face| format!("3 {}\n", line(&face))).concat();
    format!(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\n\
         property list uchar int vertex_indices\nend_header\n{places}{faces}"
    )
}

/// A glTF text, and the file of its data.
fn gltf() -> (String, Vec<u8>) {
    let text = r#"{"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                      {"bufferView": 1, "componentType": 5121, "count": 12, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
        "buffers": [{"uri": "beside.bin", "byteLength": 60}]}"#;
    let places = PLACES.iter().flatten().flat_map(|number| number.to_le_bytes());
    (text.to_owned(), places.chain(FACES.into_iter().flatten()).collect())
}

fn folder() -> Folder {
    let folder = Folder::new();
    let (text, beside) = gltf();
    folder.write("m.obj", obj()).write("m.stl", stl()).write("m.ply", ply()).write("m.gltf", text);
    folder.write("beside.bin", beside);
    folder
}

/// The part of a report that does not depend on the clock and the name.
fn lasting(mut report: Value) -> Value {
    for key in ["model", "scene", "wall_secs"] {
        report.as_object_mut().expect("an object").remove(key);
    }
    report
}

#[test]
fn every_format_gives_the_cells_that_obj_gives() {
    let folder = folder();
    let filled = |name: &str| lasting(folder.json(&format!("voxelize {name} --divisions 6 --json")));
    let wanted = filled("m.obj");
    assert!(wanted["closed"] == true && wanted["triangles"] == 4, "{wanted}");
    for name in ["m.stl", "m.ply", "m.gltf"] {
        assert_eq!(filled(name), wanted, "{name}");
    }
}

#[test]
fn every_format_runs_and_stops_what_falls_on_it() {
    let folder = folder();
    let hash = |name: &str| folder.json(&format!("run {name} --divisions 4 --seconds 0.05 --json"))["hash"].clone();
    let scene =
        |name: &str| format!("(version: 1, bodies: [(shape: cube())], obstacles: [(mesh: (path: \"{name}\"))])");
    for name in ["m.stl", "m.ply", "m.gltf"] {
        assert_eq!(hash(name), hash("m.obj"), "{name} moves as OBJ does");
        folder.write("mesh.ron", scene(name));
        assert_eq!(folder.json("check mesh.ron --json")["ok"], true, "{name} as an obstacle");
    }
}

#[test]
fn a_buffer_beside_a_model_is_not_replaced() {
    let folder = folder();
    for command in ["voxelize m.gltf -o beside.bin", "run m.gltf --seconds 0.01 --save-state beside.bin"] {
        refused(&folder, command, USAGE, &["beside.bin is what is read"]);
        assert_eq!(std::fs::read(folder.path("beside.bin")).expect("it is there"), gltf().1, "{command}");
    }
}

#[test]
fn no_picture_replaces_a_scene_or_its_model() {
    let folder = folder();
    folder.write("s.ron", "(version: 1, bodies: [(shape: model(path: \"m.obj\", divisions: 2))])");
    std::fs::hard_link(folder.path("m.obj"), folder.path("f_0002.png")).expect("a second name");
    std::fs::hard_link(folder.path("s.ron"), folder.path("s.png")).expect("a second name");
    for (output, replaced) in [("s.png", "s.png"), ("f.png --frames 3", "f_0002.png")] {
        let command = format!("render s.ron --at 0 --size 8x8 -o {output}");
        refused(&folder, &command, USAGE, &[&format!("{replaced} is what is read")]);
    }
    assert_eq!(std::fs::read_to_string(folder.path("m.obj")).expect("it is there"), obj());
}

#[test]
fn a_state_that_is_gone_on_from_is_not_replaced() {
    let folder = folder();
    folder.json("run cube-on-plane --seconds 0.01 --save-state a.state --json");
    let command = "run cube-on-plane --seconds 0.01 --from-state a.state --save-state a.state";
    refused(&folder, command, USAGE, &["a.state is what is read"]);
}

#[test]
fn a_collected_scene_moves_as_the_one_it_was() {
    let folder = folder();
    let body = "(shape: model(path: \"m.gltf\", divisions: 4))";
    folder.write("a.ron", format!("(version: 1, bodies: [{body}], obstacles: [(mesh: (path: \"m.stl\"))])"));
    let found = folder.json("collect a.ron -o there --set settings.gravity=5 --json");
    assert_eq!(found["scene"], "there/a.ron", "{found}");
    assert_eq!(found["models"].as_array().expect("a list").len(), 3, "a model, its buffer and a mesh: {found}");
    let hash = |scene: &str| folder.json(&format!("run {scene} --seconds 0.05 --json"))["hash"].clone();
    let wanted = hash("a.ron --set settings.gravity=5");
    for file in ["m.gltf", "m.stl", "beside.bin", "a.ron"] {
        std::fs::remove_file(folder.path(file)).expect("it is there");
    }
    assert_eq!(hash("there/a.ron"), wanted, "without what it came from");
    assert!(folder.run("collect tree -o tree").figures.contains("it reads no model"), "a preset carries its own");
    refused(&folder, "collect tree -o there", FAILED, &["there cannot be written", "not empty"]);
    refused(&folder, "collect tree", USAGE, &["--output"]);
}

#[test]
fn a_scene_with_its_models_inside_moves_as_the_one_it_was() {
    let folder = folder();
    let body = "(shape: model(path: \"m.gltf\", divisions: 4))";
    folder.write("a.ron", format!("(version: 1, bodies: [{body}], obstacles: [(mesh: (path: \"m.stl\"))])"));
    let found = folder.json("collect a.ron -o whole.ron --json");
    let inside = ["embedded:m/m.gltf", "embedded:m/beside.bin", "embedded:m.stl"];
    assert_eq!(found["models"], serde_json::json!(inside), "{found}");
    let hash = |scene: &str| folder.json(&format!("run {scene} --seconds 0.05 --json"))["hash"].clone();
    let wanted = hash("a.ron");
    for file in ["m.gltf", "m.stl", "beside.bin", "a.ron"] {
        std::fs::remove_file(folder.path(file)).expect("it is there");
    }
    assert_eq!(hash("whole.ron"), wanted, "one file alone");
    let set = "--set bodies.0.shape.model.path=embedded:m.stl";
    assert_eq!(folder.json(&format!("check whole.ron {set} --json"))["ok"], true, "one of them by its path");
    let unknown = "run whole.ron --set bodies.0.shape.model.path=embedded:cow.obj";
    refused(&folder, unknown, FAILED, &["the scene holds no model cow.obj; it holds m/m.gltf, m/beside.bin, m.stl"]);
    refused(&folder, "collect whole.ron -o whole.ron --force", USAGE, &["whole.ron is what is read"]);
    folder.write("mine.ron", "somebody's work");
    refused(&folder, "collect whole.ron -o mine.ron", USAGE, &["mine.ron is there", "--force"]);
    assert_eq!(std::fs::read_to_string(folder.path("mine.ron")).expect("a text"), "somebody's work");
    folder.json("collect whole.ron -o mine.ron --force --json");
    assert_eq!(hash("mine.ron"), wanted, "the same scene");
    let text = std::fs::read_to_string(folder.path("whole.ron")).expect("a text");
    folder.write("cut.ron", text.replacen("bytes: ", "bytes: 1", 1));
    refused(&folder, "run cut.ron", FAILED, &["cut.ron: models.0.bytes = 1", "but it has fewer", "(line "]);
}

#[test]
fn damaged_models_of_every_format_are_refused_by_name() {
    let folder = folder();
    folder
        .write("cut.stl", &stl()[..200])
        .write("line.ply", ply().replace("3 1 3 2", "3 1 3 7"))
        .write("json.gltf", gltf().0.replace("\"nodes\": [0]", "\"nodes\": [0"))
        .write("lost.gltf", gltf().0.replace("beside.bin", "lost.bin"))
        .write("old.fbx", "Kaydara");
    let cut = ["cut.stl, header: 4 triangles need 284 bytes, but 200 are there"];
    refused(&folder, "voxelize cut.stl", FAILED, &cut);
    refused(&folder, "voxelize line.ply", FAILED, &["line.ply, line 17: the face asks for vertex 7"]);
    refused(&folder, "check json.gltf", FAILED, &["json.gltf, line 1: this cannot be read as glTF"]);
    refused(&folder, "check lost.gltf", FAILED, &["lost.gltf, buffer 0", "lost.bin", "does not exist"]);
    refused(
        &folder,
        "run old.fbx",
        FAILED,
        &["old.fbx is in no format that is read; export the model as OBJ, STL, PLY"],
    );
    folder.write("mesh.ron", "(version: 1, obstacles: [(mesh: (path: \"cut.stl\"))])");
    refused(&folder, "run mesh.ron", FAILED, &["obstacle", "cut.stl, header"]);
}

/// The mean colour of the pixels of a picture that are as saturated as jelly.
fn body_color(folder: &Folder, command: &str) -> [f64; 3] {
    let ran = folder.run(&format!("{command} -o p.png --size 200x200 --at 0"));
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let picture = image::open(folder.path("p.png")).expect("a picture").to_rgb8();
    let is_body =
        |pixel: &&image::Rgb<u8>| pixel.0.iter().max() > pixel.0.iter().min().map(|least| least + 60).as_ref();
    let body: Vec<_> = picture.pixels().filter(is_body).collect();
    assert!(body.len() > 300, "the body is seen: {} pixels", body.len());
    [0, 1, 2].map(|channel| body.iter().map(|pixel| f64::from(pixel.0[channel])).sum::<f64>() / body.len() as f64)
}

#[test]
fn a_model_is_drawn_in_the_colours_of_its_file() {
    let folder = folder();
    let green = ply().replace(
        "property float z\n",
        "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n",
    );
    let green = PLACES.iter().fold(green, |text, place| {
        text.replacen(&format!("\n{}\n", line(place)), &format!("\n{} 0 200 0\n", line(place)), 1)
    });
    folder.write("green.ply", green);
    folder
        .write("blue.obj", format!("mtllib blue.mtl\nusemtl b\n{}", obj()))
        .write("blue.mtl", "newmtl b\nKd 0 0 0.8\n");
    let is_most = |color: [f64; 3], most: usize| (0..3).all(|other| other == most || color[most] > 1.5 * color[other]);
    let found = body_color(&folder, "render green.ply");
    assert!(is_most(found, 1), "a model that is opened looks like itself: {found:?}");
    let found = body_color(&folder, "render blue.obj --color model");
    assert!(is_most(found, 2), "by its material: {found:?}");
    let plain = body_color(&folder, "render green.ply --color plain");
    assert!(!is_most(plain, 1), "or as jelly: {plain:?}");
    folder.json("collect blue.obj -o whole.ron --json");
    std::fs::remove_file(folder.path("blue.mtl")).expect("it is there");
    let found = body_color(&folder, "render whole.ron");
    assert!(is_most(found, 2), "the material is in the scene file: {found:?}");
    let said = folder.run("render m.obj -o p.png --color model --at 0 --size 64x64");
    assert!(said.notes.contains("no model of this scene has colours in its file"), "{said:?}");
}

#[test]
fn a_model_is_drawn_with_its_pictures_wherever_it_is_taken() {
    let folder = folder();
    let vertices = PLACES.map(|place| format!("v {}\n", line(&place))).concat();
    let face = |[a, b, c]: [u8; 3]| format!("f {}/1 {}/1 {}/1\n", a + 1, b + 1, c + 1);
    let faces = FACES.map(face).concat();
    folder
        .write("leaf.obj", format!("mtllib leaf.mtl\nusemtl leaf\nvt 0.5 0.5\n{vertices}{faces}"))
        .write("leaf.mtl", "newmtl leaf\nKd 0.9 0.9 0.1\nmap_Kd green leaf.png\n");
    let green = image::RgbImage::from_pixel(2, 2, image::Rgb([0, 200, 0]));
    green.save(folder.path("green leaf.png")).expect("written");
    let is_green = |[red, green, blue]: [f64; 3]| green > 1.5 * red && green > 1.5 * blue;
    let found = body_color(&folder, "render leaf.obj");
    assert!(is_green(found), "a model that is opened looks like itself: {found:?}");
    assert!(!is_green(body_color(&folder, "render leaf.obj --color plain")), "or as jelly");
    folder.json("collect leaf.obj -o whole.ron --json");
    let collected = folder.json("collect leaf.obj -o all --json");
    assert_eq!(collected["models"].as_array().map(Vec::len), Some(3), "model, material and picture: {collected}");
    std::fs::remove_file(folder.path("green leaf.png")).expect("it is there");
    for scene in ["whole.ron", "all/leaf.ron"] {
        let found = body_color(&folder, &format!("render {scene}"));
        assert!(is_green(found), "{scene} has its picture: {found:?}");
    }
    let without = folder.run("render leaf.obj -o p.png --size 8x8 --at 0");
    let said = "warning: no picture from green leaf.png, plain colours instead: it does not exist";
    assert!(without.code == Some(0) && without.notes.contains(said), "{without:?}");
    assert!(!is_green(body_color(&folder, "render leaf.obj")), "in the plain colour");
    let checked = folder.run("check leaf.obj");
    assert!(checked.code == Some(0) && checked.notes.contains(said), "{checked:?}");
}

#[test]
fn a_check_says_which_material_file_is_missing_whether_a_face_asks_for_it_or_not() {
    let folder = folder();
    folder
        .write("asked.obj", format!("mtllib gone.mtl\nusemtl b\n{}", obj()))
        .write("plain.obj", format!("mtllib gone.mtl\n{}", obj()));
    for model in ["asked.obj", "plain.obj"] {
        let said = "no colours from the materials in gone.mtl: there is no such file";
        let checked = folder.run(&format!("check {model}"));
        assert!(checked.code == Some(0) && checked.notes.contains(&format!("warning: {said}\n")), "{checked:?}");
        let figures = folder.json(&format!("check {model} --json"));
        assert!(figures["warnings"].as_array().is_some_and(|all| all.contains(&said.into())), "{figures}");
    }
}
