//! Rules that a compiler does not check: layers only use lower ones, graphics and window crates stay in their places, banned
//! calls, the shader table, names. Every rule has a test in which it must fail.

use std::fs;
use std::path::{Path, PathBuf};

#[path = "tidy/imports.rs"]
mod imports;

/// Layers and the crate's own modules each may name, lowest first.
const LAYERS: [(&str, &[&str]); 16] = [
    ("math", &[]),
    ("text", &[]),
    ("disk", &["text"]),
    ("machine", &[]),
    ("geometry", &["math", "disk", "text"]),
    ("scene", &["math", "disk", "text", "geometry"]),
    ("physics", &["math", "machine", "geometry", "scene"]),
    ("modal", &["math", "machine", "geometry", "physics"]),
    ("view", &["math"]),
    ("extract", &["math", "geometry", "scene", "physics", "view"]),
    ("render", &["math", "view"]),
    ("report", &["math", "machine", "geometry", "scene", "physics"]),
    (
        "session",
        &["math", "disk", "machine", "text", "geometry", "scene", "physics", "modal", "view", "extract", "report"],
    ),
    ("export", &["math", "disk", "text", "geometry", "view"]),
    ("app", &["math", "disk", "machine", "text", "scene", "view", "extract", "session", "export", "render"]),
    // The command line opens the window, so it is the top layer of the program.
    (
        "cli",
        &[
            "math", "disk", "machine", "text", "geometry", "scene", "modal", "view", "extract", "session", "report",
            "export", "render", "app",
        ],
    ),
];

/// Modules that a layer may name only in one of its folders, its room.
const ROOMS: [(&str, &str, &str); 1] = [("src/physics/", "scene", "src/physics/compile/")];

/// Words that may appear only in files below these places.
const PLACES: [(&str, &[&str]); 6] = [
    ("wgpu::", &["src/render/", "src/app/canvas/"]),
    ("egui", &["src/app/"]),
    ("winit::", &["src/app/"]),
    ("Instant::now", &["src/app/", "src/session/", "src/report/", "src/cli/"]),
    ("rayon", &["src/machine/threads.rs", "src/geometry/", "src/report/", "src/session/", "src/cli/", "src/app/"]),
    // This is the only place where the command line writes.
    ("stdout()", &["src/cli/out.rs"]),
];

/// Words that may not appear anywhere below a place.
const BANNED: [(&str, &[&str]); 3] = [
    // Results must not depend on hashing order, fused operations or a machine's own transcendental functions.
    (
        "src/physics/",
        &[
            "HashMap",
            "HashSet",
            // Only `team` shares out work, by `machine::threads`; no other loop may depend on which thread does what.
            "par_iter",
            "thread::",
            "mul_add",
            ".sin()",
            ".cos()",
            ".tan()",
            ".exp()",
            ".ln()",
            ".powf(",
            ".powi(",
            ".normalize()",
        ],
    ),
    ("src/geometry/", &["HashMap", "HashSet", "mul_add", ".sin()", ".cos()", ".powf("]),
    ("src/", &[".unwrap()", "println!", "TODO", "FIXME", "#[allow(", "dbg!"]),
];

/// Names that say nothing.
const EMPTY_NAMES: [&str; 8] = ["data", "manager", "handler", "helper", "helpers", "util", "utils", "common"];

/// A longer file is hard to remember as a whole.
const LONGEST_FILE: usize = 500;

/// The most files that a walk from one end of the program to the other may enter.
const LONGEST_WALK: usize = 20;

/// A source file: its path from the root with forward slashes, and its text.
struct Source {
    path: String,
    text: String,
}

impl Source {
    fn new(path: &str, text: &str) -> Self {
        Self { path: path.to_owned(), text: text.to_owned() }
    }

    /// The text up to its tests, without comments.
    fn code(&self) -> String {
        let own = self.text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
        let is_tests = self.path.ends_with("/tests.rs") || self.path.ends_with("_tests.rs");
        let lines = if is_tests { "" } else { own }.lines();
        lines.map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
    }
}

/// Modules that a file names in violation of the layers.
fn wrong_layers(source: &Source) -> Vec<String> {
    let Some(inside) = source.path.strip_prefix("src/") else { return Vec::new() };
    let Some((layer, allowed)) = LAYERS.iter().find(|(layer, _)| inside.starts_with(&format!("{layer}/"))) else {
        return Vec::new();
    };
    let named = modules_named(source);
    let named = named.iter().filter(|module| LAYERS.iter().any(|(known, _)| known == module));
    named
        .filter(|module| module != layer && !allowed.contains(&module.as_str()))
        .map(|module| format!("{}: {layer} must not name {module}", source.path))
        .collect()
}

/// Modules that a file names although only a room of its layer may.
fn wrong_rooms(source: &Source) -> Vec<String> {
    let here = ROOMS.iter().filter(|(layer, _, room)| source.path.starts_with(layer) && !source.path.starts_with(room));
    here.filter(|(_, module, _)| modules_named(source).iter().any(|named| named == module))
        .map(|(_, module, room)| format!("{}: only {room} names {module}", source.path))
        .collect()
}

/// The crate's own modules that a file names, with repetitions.
fn modules_named(source: &Source) -> Vec<String> {
    let code = source.code();
    let named = code.match_indices("crate::").map(|(at, word)| {
        let rest = &code[at + word.len()..];
        rest.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or_default().to_owned()
    });
    named.collect()
}

fn wrong_places(source: &Source) -> Vec<String> {
    let code = source.code();
    let misplaced = PLACES
        .iter()
        .filter(|(word, places)| code.contains(word) && !places.iter().any(|place| source.path.starts_with(place)));
    let misplaced = misplaced.map(|(word, places)| format!("{}: {word} belongs in {places:?}", source.path));
    let banned = BANNED.iter().filter(|(place, _)| source.path.starts_with(place)).flat_map(|(_, words)| *words);
    let banned = banned.filter(|word| code.contains(*word)).map(|word| format!("{}: {word} is banned", source.path));
    misplaced.chain(banned).collect()
}

fn wrong_shape(source: &Source) -> Vec<String> {
    let mut found = Vec::new();
    if !source.text.starts_with("//!") {
        found.push(format!("{}: says nothing of its job (//!)", source.path));
    }
    let lines = source.text.lines().count();
    if lines > LONGEST_FILE {
        found.push(format!("{}: {lines} lines are too many to hold in the head", source.path));
    }
    let names = source.path.trim_end_matches(".rs").split('/');
    found.extend(
        names.filter(|name| EMPTY_NAMES.contains(name)).map(|name| format!("{}: {name} says nothing", source.path)),
    );
    found
}

/// Shader files missing from the table, and entries of the table without a file.
fn wrong_shaders(table: &str, files: &[String]) -> Vec<String> {
    let included: Vec<&str> =
        table.match_indices("shaders/").filter_map(|(at, word)| table[at + word.len()..].split('"').next()).collect();
    let unused = files.iter().filter(|file| !included.contains(&file.as_str()));
    let absent = included.iter().filter(|name| !files.iter().any(|file| file == *name));
    unused.map(|file| format!("{file} is in no table")).chain(absent.map(|name| format!("{name} is no file"))).collect()
}

/// Errors in the walks that a page describes: blocks of lines that each begin with a file and a function in it.
fn wrong_walks(page: &str, sources: &[Source]) -> Vec<String> {
    let blocks = page.split("//! ```text").skip(1).filter_map(|rest| rest.split("//! ```").next());
    let mut found = Vec::new();
    for block in blocks {
        let words = block.lines().map(|line| line.trim_start_matches("//!").split_whitespace());
        let walk: Vec<(&str, &str)> = words
            .filter_map(|mut words| Some((words.next()?, words.next()?)))
            .filter(|(file, _)| Path::new(file).extension().is_some_and(|ending| ending == "rs"))
            .collect();
        if walk.len() > LONGEST_WALK {
            found.push(format!("{} files are a long walk", walk.len()));
        }
        for (place, (file, function)) in walk.iter().enumerate() {
            if walk[..place].iter().any(|(before, _)| before == file) {
                found.push(format!("{file} is entered twice"));
            }
            let Some(source) = sources.iter().find(|source| source.path == format!("src/{file}")) else {
                found.push(format!("{file} is no file"));
                continue;
            };
            if ![format!("fn {function}("), format!("fn {function}<")].iter().any(|head| source.code().contains(head)) {
                found.push(format!("{file} has no {function}"));
            }
        }
    }
    found
}

fn sources() -> Vec<Source> {
    let mut paths = Vec::new();
    rust_files(Path::new("src"), &mut paths);
    paths.sort();
    let read = |path: &PathBuf| Source {
        path: path.to_string_lossy().replace('\\', "/"),
        text: fs::read_to_string(path).expect("source files can be read"),
    };
    paths.iter().map(read).collect()
}

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("tests run in the root of the repository") {
        let path = entry.expect("a folder can be listed").path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(path);
        }
    }
}

fn check(rule: impl Fn(&Source) -> Vec<String>) {
    let sources = sources();
    assert!(sources.len() > 50, "the sources are found: {}", sources.len());
    let found: Vec<String> = sources.iter().flat_map(rule).collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn layers_go_down_only() {
    check(wrong_layers);
    check(wrong_rooms);
}

#[test]
fn crates_and_calls_stay_in_their_places() {
    check(wrong_places);
}

#[test]
fn files_are_short_and_say_their_job() {
    check(wrong_shape);
}

#[test]
fn no_files_name_each_other_in_a_circle() {
    let sources = sources();
    let modules: Vec<imports::Module> =
        sources.iter().map(|source| imports::Module { file: source.path.clone(), code: source.code() }).collect();
    let found: Vec<String> = imports::circles(&modules).iter().map(|knot| knot.join("\n  ")).collect();
    assert!(found.is_empty(), "{} circles:\n{}", found.len(), found.join("\n"));
}

#[test]
fn every_folder_of_the_sources_is_a_layer() {
    let folders = fs::read_dir("src").expect("tests run in the root of the repository");
    for path in folders.map(|entry| entry.expect("a folder can be listed").path()).filter(|path| path.is_dir()) {
        let name = path.file_name().expect("a folder has a name").to_string_lossy().into_owned();
        assert!(LAYERS.iter().any(|(layer, _)| *layer == name), "{name} has no place among the layers");
    }
}

#[test]
fn shader_files_and_their_table_agree() {
    let table = fs::read_to_string("src/render/shader.rs").expect("the table of shaders");
    let files: Vec<String> = fs::read_dir("shaders")
        .expect("the shaders")
        .map(|entry| entry.expect("a folder can be listed").file_name().to_string_lossy().into_owned())
        .collect();
    assert_eq!(wrong_shaders(&table, &files), Vec::<String>::new(), "table against folder");
}

#[test]
fn the_walks_through_the_code_can_be_walked() {
    let page = fs::read_to_string("src/lib.rs").expect("the page of the crate");
    let all = ["apply           --dt", "springs_ui      the sliders"];
    assert!(all.iter().all(|begin| page.contains(begin)), "both walks are described");
    assert_eq!(wrong_walks(&page, &sources()), Vec::<String>::new(), "as the page has them");
}

#[test]
fn the_rules_can_fail() {
    let one = |rule: fn(&Source) -> Vec<String>, path: &str, text: &str| rule(&Source::new(path, text)).len();
    assert_eq!(one(wrong_layers, "src/render/x.rs", "use crate::physics::Model;"), 1, "render knows no physics");
    assert_eq!(one(wrong_layers, "src/app/ui/x.rs", "let s = crate::physics::step();"), 1, "nor does the window");
    assert_eq!(one(wrong_layers, "src/app/x.rs", "// crate::physics\nuse crate::session::Status;"), 0, "comments may");
    let naming = "use crate::scene::Scene;\nfn f(_: &crate::scene::Body) {}\n#[cfg(test)]\nmod tests {\n";
    assert_eq!(one(wrong_rooms, "src/physics/forces/x.rs", naming), 1, "only what compiles it names the document");
    assert_eq!(one(wrong_rooms, "src/physics/compile/x.rs", naming), 0, "here it may");
    let in_tests = "#[cfg(test)]\nmod tests {\nuse crate::scene::Scene;";
    assert_eq!(one(wrong_rooms, "src/physics/x.rs", in_tests), 0, "tests may");
    assert_eq!(one(wrong_places, "src/view/x.rs", "use wgpu::Device;"), 1, "only render names wgpu");
    assert_eq!(one(wrong_places, "src/physics/x.rs", "let t = Instant::now(); a.mul_add(b, c);"), 2, "clock and fma");
    assert_eq!(one(wrong_places, "src/physics/x.rs", "rayon::join(a, b); std::thread::sleep(c);"), 2, "other threads");
    assert_eq!(one(wrong_places, "src/scene/x.rs", "#[cfg(test)]\nmod tests {\nx.unwrap()"), 0, "tests may unwrap");
    assert_eq!(one(wrong_shape, "src/scene/utils.rs", "fn f() {}"), 2, "no job, no name");
    assert_eq!(one(wrong_shape, "src/scene/x.rs", &"//!\n".repeat(LONGEST_FILE + 1)), 1, "too long");
    let walked =
        [Source::new("src/a.rs", "//! A.\nfn a<T>() {}"), Source::new("src/b.rs", "//! B.\n// fn b()\nfn c() {}")];
    let wrong = |walk: &str| wrong_walks(&format!("//! ```text\n{walk}\n//! ```"), &walked).len();
    assert_eq!(wrong("//! a.rs  a  first\n//! b.rs  c  then"), 0, "a walk");
    assert_eq!(wrong("//! a.rs  a  first\n//! b.rs  b  then"), 1, "a function that only a comment has");
    assert_eq!(wrong("//! d.rs  a  first"), 1, "a file that is not there");
    assert_eq!(wrong("//! a.rs  a  first\n//! b.rs  c  then\n//! a.rs  a  again"), 1, "back to one");
    let long: Vec<String> = (0..=LONGEST_WALK).map(|step| format!("//! {step}.rs  a  on")).collect();
    let steps: Vec<Source> =
        (0..=LONGEST_WALK).map(|step| Source::new(&format!("src/{step}.rs"), "fn a() {}")).collect();
    assert_eq!(wrong_walks(&format!("//! ```text\n{}\n//! ```", long.join("\n")), &steps).len(), 1, "a long walk");
    let files = ["a.wgsl".to_owned()];
    assert_eq!(wrong_shaders("include_str!(\"../shaders/b.wgsl\")", &files).len(), 2, "one unused, one absent");
}
