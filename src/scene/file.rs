//! Scenes as RON files: read with errors that name file, line and what was expected, written so that there is never
//! half a file. The text reads like the paths: `shape: cube(cells: 9, size: 1.0)`.

use std::io;
use std::path::Path;

use ron::extensions::Extensions;
use ron::ser::PrettyConfig;
use thiserror::Error;

use super::param::{self, Kind, Problem};
use super::{Scene, VERSION, embedded_check};
use super::{ron_lines, ron_words};
use crate::disk::{self, ReadError};
use crate::text::{echo, echo_path};

/// A larger file is no scene; models are files of their own.
const MAX_BYTES: u64 = 64 << 20;

/// Why a scene file could not be read or written. Each is a sentence that starts with the file.
#[derive(Debug, Error)]
pub enum SceneFileError {
    /// The file system refused to read.
    #[error("{name}: cannot be read")]
    Read {
        /// The file.
        name: String,
        /// Why.
        source: io::Error,
    },
    /// The file system refused to write; what was there is unchanged.
    #[error("{name}: cannot be written; what was there is unchanged")]
    Write {
        /// The file.
        name: String,
        /// Why.
        source: io::Error,
    },
    /// The path is a folder or a device.
    #[error("{name}: is a {kind}, not a scene file")]
    NotAFile {
        /// The path.
        name: String,
        /// What it is.
        kind: &'static str,
    },
    /// Far too large.
    #[error("{0}: is larger than 64 MiB, so it is no scene")]
    TooLarge(String),
    /// What would be written could not be read again.
    #[error(
        "{name}: is not written: with its models inside it takes {mib} MiB, and at most 64 MiB can be read again; collect \
         the scene into a folder instead"
    )]
    TooLargeToRead {
        /// The file.
        name: String,
        /// How large it would be.
        mib: usize,
    },
    /// Bytes that are no text.
    #[error("{0}: is not text, so it is no scene; a scene file starts with (version: {VERSION}, …")]
    NotText(String),
    /// Nothing in it.
    #[error("{0}: is empty; a scene file starts with (version: {VERSION}, …")]
    Empty(String),
    /// No version is given.
    #[error("{0}: has no version; a scene file starts with (version: {VERSION}, …")]
    NoVersion(String),
    /// Written by a newer program.
    #[error("{name}: has format version {found}, this program reads up to {VERSION}; open it with a newer Gelatin")]
    Newer {
        /// The file.
        name: String,
        /// Its version.
        found: u64,
    },
    /// A version below the first one.
    #[error("{name}: has format version {found}, the first one is 1")]
    Older {
        /// The file.
        name: String,
        /// Its version.
        found: u64,
    },
    /// Not RON, or a field that a scene does not have.
    #[error("{name}:{line}:{column}: {message}")]
    Syntax {
        /// The file.
        name: String,
        /// The line, from 1.
        line: usize,
        /// The column, from 1.
        column: usize,
        /// The path of the value or field there.
        path: String,
        /// What is wrong and what was expected.
        message: String,
    },
    /// Values outside their ranges.
    #[error("{name}: {}", list(problems))]
    Values {
        /// The file.
        name: String,
        /// All of them; at least one.
        problems: Vec<Problem>,
    },
    /// The scene has no form in RON.
    #[error("the scene cannot be written as text")]
    Serialise {
        /// Why.
        source: ron::Error,
    },
}

impl SceneFileError {
    /// The values or fields of the scene that are wrong; none where the whole file is.
    pub fn problems(&self) -> Vec<Problem> {
        let version = |message: String| vec![Problem { path: "version".to_owned(), message }];
        match self {
            Self::Values { problems, .. } => problems.clone(),
            Self::Syntax { path, .. } => vec![Problem { path: path.clone(), message: self.to_string() }],
            Self::NoVersion(_) | Self::Newer { .. } | Self::Older { .. } => version(self.to_string()),
            _ => Vec::new(),
        }
    }
}

impl Scene {
    /// Reads a scene from RON; `name` is what errors call the file. All values are then within their ranges.
    pub fn from_ron(text: &str, name: &str) -> Result<Self, SceneFileError> {
        let name = || name.to_owned();
        if text.trim().is_empty() {
            return Err(SceneFileError::Empty(name()));
        }
        if text.contains('\0') {
            return Err(SceneFileError::NotText(name()));
        }
        let version = version_of(text);
        match version {
            Some(found) if found > u64::from(VERSION) => return Err(SceneFileError::Newer { name: name(), found }),
            Some(0) => return Err(SceneFileError::Older { name: name(), found: 0 }),
            _ => {}
        }
        let scene: Self = options().from_str(text).map_err(|error| match error.code {
            ron::Error::MissingStructField { field: "version", .. } => SceneFileError::NoVersion(name()),
            code => SceneFileError::Syntax {
                name: name(),
                line: error.span.start.line,
                column: error.span.start.col,
                path: path_of(&code, &ron_lines::path_before(text, error.span.end.line, error.span.end.col)),
                message: misfit(&code, text, [error.span.start.line, error.span.start.col])
                    .unwrap_or_else(|| ron_words::words(&code)),
            },
        })?;
        let mut problems = scene.problems();
        if problems.is_empty() {
            return Ok(scene);
        }
        let lines = ron_lines::lines_of(text, problems.iter().map(|problem| problem.path.as_str()));
        for (problem, line) in problems.iter_mut().zip(lines) {
            if let Some(line) = line {
                problem.message = format!("{} (line {line})", problem.message);
            }
        }
        Err(SceneFileError::Values { name: name(), problems })
    }

    /// The scene as RON, for a person to read and edit.
    pub fn to_ron(&self) -> Result<String, SceneFileError> {
        let config = PrettyConfig::new().depth_limit(4).struct_names(false).new_line("\n".to_owned());
        let body = options().to_string_pretty(self, config).map_err(|source| SceneFileError::Serialise { source })?;
        let program = env!("CARGO_PKG_VERSION");
        Ok(format!("// A Gelatin {program} scene, format version {VERSION}. SI units, y up.\n{body}\n"))
    }

    /// As [`Scene::to_ron`], unless the text could not be read again: the error is then that of reading it. `name` is what
    /// errors call the file.
    pub fn to_readable_ron(&self, name: &str) -> Result<String, SceneFileError> {
        let problems = self.problems();
        if problems.is_empty() {
            self.to_ron()
        } else {
            Err(SceneFileError::Values { name: name.to_owned(), problems })
        }
    }

    /// Every value and every model file inside that is not allowed.
    fn problems(&self) -> Vec<Problem> {
        let mut problems = param::validate(self);
        problems.extend(embedded_check::problems(&self.models));
        problems
    }

    /// Reads a scene file.
    pub fn load(path: &Path) -> Result<Self, SceneFileError> {
        let name = echo_path(path);
        let bytes = match disk::read(path, MAX_BYTES) {
            Ok(bytes) => bytes,
            Err(ReadError::NotAFile(kind)) => return Err(SceneFileError::NotAFile { name, kind }),
            Err(ReadError::TooLarge(_limit)) => return Err(SceneFileError::TooLarge(name)),
            Err(ReadError::Refused(source)) => return Err(SceneFileError::Read { name, source }),
        };
        match String::from_utf8(bytes) {
            Ok(text) => Self::from_ron(text.trim_start_matches('\u{feff}'), &name),
            Err(_not_utf8) => Err(SceneFileError::NotText(name)),
        }
    }

    /// Writes a scene file: all of it, or the file that was there stays as it was. What could not be read again is not written.
    pub fn save(&self, path: &Path) -> Result<(), SceneFileError> {
        let name = echo_path(path);
        let text = self.to_readable_ron(&name)?;
        if text.len() as u64 > MAX_BYTES {
            return Err(SceneFileError::TooLargeToRead { name, mib: text.len().div_ceil(1 << 20) });
        }
        disk::write(path, text.as_bytes()).map_err(|source| SceneFileError::Write { name, source })?;
        disk::remove_left_behind(path);
        Ok(())
    }
}

/// Returns the path that an error is about; `last` is the path that was read last.
fn path_of(error: &ron::Error, last: &str) -> String {
    match error {
        ron::Error::MissingStructField { field, .. } => match last.rsplit_once('.') {
            Some((holder, _)) => format!("{holder}.{field}"),
            None => (*field).to_owned(),
        },
        _ => echo(last),
    }
}

/// Says what may stand at a line and column, both from 1, where a value of another kind does.
fn misfit(error: &ron::Error, text: &str, [line, column]: [usize; 2]) -> Option<String> {
    use ron::Error as E;
    let (path, found) = ron_lines::value_at(text, line, column)?;
    let param = param::find(&path)?;
    let is_misfit = match error {
        E::ExpectedInteger
        | E::ExpectedFloat
        | E::IntegerOutOfBounds
        | E::InvalidIntegerDigit { .. }
        | E::ExpectedBoolean => true,
        // What follows the point of a number that must be whole.
        E::ExpectedComma => matches!(param.kind, Kind::Integer { .. }) && found.contains('.'),
        // A word in quotes.
        E::ExpectedIdentifier => matches!(param.kind, Kind::Word(_)),
        _ => false,
    };
    let allowed = super::path::allowed(param, &path);
    is_misfit.then(|| format!("{} = {} does not fit; allowed: {allowed}", echo(&path), echo(found)))
}

fn options() -> ron::Options {
    let plain = Extensions::IMPLICIT_SOME | Extensions::UNWRAP_NEWTYPES | Extensions::UNWRAP_VARIANT_NEWTYPES;
    ron::Options::default().with_default_extension(plain)
}

fn list(problems: &[Problem]) -> String {
    const SHOWN: usize = 5;
    let more = (problems.len() > SHOWN).then(|| format!("and {} more", problems.len() - SHOWN));
    problems.iter().take(SHOWN).map(ToString::to_string).chain(more).collect::<Vec<_>>().join("; ")
}

/// The version a text gives at its top level, found without understanding the rest, which may be in a newer form.
fn version_of(text: &str) -> Option<u64> {
    let mut depth = 0_u32;
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let mut skip = first.len_utf8();
        match first {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth = depth.saturating_sub(1),
            '"' => skip = string_length(rest),
            '/' if rest.starts_with("//") => skip = rest.find('\n').unwrap_or(rest.len()),
            '/' if rest.starts_with("/*") => skip = rest.find("*/").map_or(rest.len(), |end| end + 2),
            letter if letter.is_alphabetic() || letter == '_' => {
                skip = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
                let (word, after) = rest.split_at(skip);
                if let (1, "version", Some(value)) = (depth, word, after.trim_start().strip_prefix(':')) {
                    let value = value.trim_start();
                    let end = value.find(|c: char| !c.is_ascii_digit()).unwrap_or(value.len());
                    return if end == 0 { None } else { Some(value[..end].parse().unwrap_or(u64::MAX)) };
                }
            }
            _ => {}
        }
        rest = &rest[skip..];
    }
    None
}

fn string_length(text: &str) -> usize {
    let mut escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            '"' if !escaped => return at + 1,
            _ => escaped = c == '\\' && !escaped,
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use std::fs;

    use proptest::prelude::*;

    use super::*;
    use crate::scene::presets;

    fn refusal(text: &str) -> String {
        Scene::from_ron(text, "a.ron").expect_err(&format!("{text} is refused")).to_string()
    }

    #[test]
    fn every_preset_survives_the_file() {
        for preset in presets::presets() {
            let scene = (preset.build)();
            let text = scene.to_ron().expect("a preset can be written");
            let again = Scene::from_ron(&text, preset.name).unwrap_or_else(|error| panic!("{error}\n{text}"));
            assert_eq!(again, scene, "{}", preset.name);
        }
        let all = param::specimen();
        assert_eq!(Scene::from_ron(&all.to_ron().expect("written"), "all").expect("read"), all, "one of everything");
    }

    #[test]
    fn a_file_reads_like_the_paths() {
        let text = (presets::presets()[0].build)().to_ron().expect("a preset can be written");
        assert!(text.starts_with("// A Gelatin "), "{text}");
        for part in ["shape: cube(", "cells: 9", "material: springs(", "gravity: (0.0, -9.81, 0.0)", "plane: ("] {
            assert!(text.contains(part), "{part} is in {text}");
        }
    }

    #[test]
    fn a_short_file_gets_defaults_and_a_single_gravity_points_down() {
        let text = "(version: 1, settings: (gravity: 3.0), bodies: [(name: \"a\", shape: cube(cells: 3))], obstacles: [(plane: ())])";
        let scene = Scene::from_ron(text, "a.ron").expect("a short scene");
        assert_eq!(scene.settings, crate::scene::Settings { gravity: [0.0, -3.0, 0.0], ..Default::default() });
        assert_eq!(scene.bodies.len() + scene.obstacles.len(), 2);
    }

    #[test]
    fn errors_name_the_line_and_what_was_expected() {
        let unknown = refusal("(version: 1,\n bodies: [\n  (nam: \"a\")])");
        assert!(
            unknown.starts_with("a.ron:3:") && unknown.contains("`nam`") && unknown.contains("`name`"),
            "{unknown}"
        );
        let kind = refusal("(version: 1,\n settings: (dt: \"slow\"))");
        assert!(kind.starts_with("a.ron:2:"), "{kind}");
        for (text, words) in [
            ("(version: 1, settings: (1))", "a name without quotes is expected here"),
            ("(version: 1, bodies: [(name: 3)])", "a text in quotes is expected"),
            ("(version: 1, bodies: [(shape: 5)])", "a name without quotes is expected here"),
            ("(version: 1, bodies: [", "an opening ( is expected"),
            ("(version: 1, bodies: [(name: \"a\"", "is expected here"),
            ("(version: 1, bodies: {})", "an opening [ of a list"),
            ("(version: 1) 7", "more text behind"),
            ("(version: 1, version: 1)", "`version` is given twice"),
        ] {
            let message = refusal(text);
            assert!(message.contains(words), "{text}: {message}");
            let jargon = ["dentifier", "r#", "RON", "struct", "enum", "Expected"];
            assert!(!jargon.iter().any(|word| message.contains(word)), "{text}: {message}");
        }
        let body = "bodies.0.shape.cube.cells";
        for cells in ["-4", "1e3", "4.5", "\"x\"", "nine", "99999999999"] {
            let message =
                refusal(&format!("(version: 1,\n bodies: [(name: \"ü, (\", shape: cube(size: 1.0, cells: {cells}))])"));
            let said = format!(": {body} = {cells} does not fit; allowed: a whole number, 1 … 199");
            assert!(message.starts_with("a.ron:2:") && message.ends_with(&said), "{message}");
        }
        let quoted = refusal("(version: 1, settings: (integrator: \"rk4\"))");
        assert!(quoted.contains("settings.integrator = \"rk4\" does not fit; allowed: "), "{quoted}");
        assert!(quoted.contains("rk4,") || quoted.ends_with("rk4"), "the word itself is right: {quoted}");
        let bare = refusal("(version: 1, obstacles: [plane(half_extents: (5, 5))])");
        assert!(bare.ends_with("an opening ( is expected here, before plane"), "{bare}");
        let two = refusal("(version: 1, bodies: [(velocity: (1, 2))])");
        assert!(two.ends_with("3 values in ( ) are expected here, not 2"), "{two}");
        let no_comma = refusal("(version: 1, bodies: [(shape: cube(cells: 4 size: 1.0))])");
        assert!(no_comma.ends_with("a comma is expected here"), "{no_comma}");
        let form = refusal("(version: 1, obstacles: [(name: \"a\")])");
        assert!(form.contains("one of `plane`, `sphere`, `box`, `capsule`, `cylinder` and `mesh`"), "{form}");
        let several = refusal("(version: 1, obstacles: [(box: (), capsule: ())])");
        assert!(several.contains("not several"), "{several}");
        let value = refusal("(version: 1, settings: (dt: 7.0))");
        assert_eq!(value, "a.ron: settings.dt = 7 s is outside 1e-6 … 0.1 s (line 1)");
    }

    #[test]
    fn thousands_of_bad_values_are_found_on_their_lines_at_once() {
        let cells = "(9999, 9999, 9999),\n".repeat(3000);
        let text = format!("(version: 1, bodies: [(shape: cells(list: [\n{cells}]))])");
        let begun = std::time::Instant::now();
        let message = refusal(&text);
        // It took 11 s when the text was read again for every value; read once it takes hundredths of a second.
        assert!(begun.elapsed() < std::time::Duration::from_secs(4), "{:?}", begun.elapsed());
        assert!(message.contains("list.1.1 = 9999 is outside -1000 … 1000 (line 3)"), "{message}");
        assert!(message.ends_with("and 8995 more"), "the rest is counted");
    }

    #[test]
    fn the_version_is_checked_before_anything_else() {
        assert!(refusal("(version: 2, wobble: %&!").contains("newer Gelatin"), "newer, in a form nobody can read");
        assert!(
            refusal("// version: 1\n(bodies: [(version: 1)], version: 99)").contains("version 99"),
            "not the inner one"
        );
        assert!(refusal("(version: 0)").contains("the first one is 1"), "older");
        assert!(refusal("(bodies: [])").contains("has no version"), "missing");
        assert!(refusal("(version: 99999999999999999999999)").contains("newer"), "beyond any integer");
        assert!(refusal("  \n").contains("is empty"), "empty");
    }

    #[test]
    fn files_that_are_no_scene_are_refused_with_a_sentence() {
        let folder = tempfile::tempdir().expect("a folder");
        let load = |name: &str, bytes: &[u8]| {
            let path = folder.path().join(name);
            fs::write(&path, bytes).expect("a file");
            Scene::load(&path).expect_err("it is no scene").to_string()
        };
        assert!(load("binary.ron", &[0, 159, 146, 150]).contains("is not text"));
        assert!(load("empty.ron", b"").contains("is empty"));
        assert!(Scene::load(folder.path()).expect_err("a folder").to_string().contains("is a folder"));
        assert!(
            Scene::load(&folder.path().join("none.ron")).expect_err("nothing").to_string().contains("cannot be read")
        );
    }

    #[test]
    fn saving_replaces_the_whole_file_or_leaves_it() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.ron");
        let scene = (presets::presets()[0].build)();
        scene.save(&path).expect("a new file");
        Scene::default().save(&path).expect("an old file");
        assert_eq!(Scene::load(&path).expect("the newer one"), Scene::default());
        let mut slow = Scene::default();
        slow.settings.dt = 7.0;
        let refused = slow.save(&path).expect_err("nobody could read it").to_string();
        assert!(refused.ends_with("a.ron: settings.dt = 7 s is outside 1e-6 … 0.1 s"), "{refused}");
        assert_eq!(Scene::load(&path).expect("it is still there"), Scene::default());
        assert!(scene.save(&folder.path().join("none/a.ron")).is_err(), "no such folder");
        assert!(scene.save(folder.path()).is_err(), "a folder");
        assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 1, "no temporary file is left");
    }

    proptest! {
        #[test]
        fn no_damage_panics(at in 0usize..3000, bytes in proptest::collection::vec(any::<u8>(), 0..6), cut in 0usize..20) {
            let mut text = param::specimen().to_ron().expect("written").into_bytes();
            let at = at.min(text.len());
            text.splice(at..(at + cut).min(text.len()), bytes);
            let text = String::from_utf8_lossy(&text);
            if let Ok(scene) = Scene::from_ron(&text, "damaged") {
                prop_assert!(param::validate(&scene).is_empty(), "what is read is sound");
            }
        }
    }
}
