//! Scenes as RON files: read with errors that name file, line and what was expected, written so that there is never
//! half a file. The text reads like the paths: `shape: cube(cells: 9, size: 1.0)`.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use ron::extensions::Extensions;
use ron::ser::PrettyConfig;
use thiserror::Error;

use super::param::{self, Problem};
use super::ron_lines;
use super::{Scene, VERSION};

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
    #[error("{0}: is a folder or a device, not a scene file")]
    NotAFile(String),
    /// Far too large.
    #[error("{0}: is larger than 64 MiB, so it is no scene")]
    TooLarge(String),
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
    /// A version that never was.
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
                message: code.to_string(),
            },
        })?;
        let mut problems = param::validate(&scene);
        for problem in &mut problems {
            if let Some(line) = ron_lines::line_of(text, &problem.path) {
                problem.message = format!("{} (line {line})", problem.message);
            }
        }
        if problems.is_empty() { Ok(scene) } else { Err(SceneFileError::Values { name: name(), problems }) }
    }

    /// The scene as RON, for a person to read and edit.
    pub fn to_ron(&self) -> Result<String, SceneFileError> {
        let config = PrettyConfig::new().depth_limit(4).struct_names(false).new_line("\n".to_owned());
        let body = options().to_string_pretty(self, config).map_err(|source| SceneFileError::Serialise { source })?;
        let program = env!("CARGO_PKG_VERSION");
        Ok(format!("// A Gelatin {program} scene, format version {VERSION}. SI units, y up.\n{body}\n"))
    }

    /// Reads a scene file.
    pub fn load(path: &Path) -> Result<Self, SceneFileError> {
        let name = path.display().to_string();
        let read = |source| SceneFileError::Read { name: name.clone(), source };
        let about = fs::metadata(path).map_err(read)?;
        if !about.is_file() {
            return Err(SceneFileError::NotAFile(name));
        }
        if about.len() > MAX_BYTES {
            return Err(SceneFileError::TooLarge(name));
        }
        match String::from_utf8(fs::read(path).map_err(read)?) {
            Ok(text) => Self::from_ron(text.trim_start_matches('\u{feff}'), &name),
            Err(_not_utf8) => Err(SceneFileError::NotText(name)),
        }
    }

    /// Writes a scene file: all of it, or the file that was there stays as it was.
    pub fn save(&self, path: &Path) -> Result<(), SceneFileError> {
        let text = self.to_ron()?;
        let name = path.display().to_string();
        write_atomically(path, text.as_bytes()).map_err(|source| SceneFileError::Write { name, source })
    }
}

/// Writes a whole file or nothing: into a temporary file in the same folder, synced, then moved over the old one. A
/// link is followed; the permissions of an old file are kept.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let target = fs::canonicalize(path).unwrap_or_else(|_new_file| path.to_owned());
    let old = fs::metadata(&target).ok();
    if old.as_ref().is_some_and(|about| !about.is_file()) {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "there is a folder or a device of this name"));
    }
    if old.as_ref().is_some_and(|about| about.permissions().readonly()) {
        return Err(io::Error::new(io::ErrorKind::PermissionDenied, "the file is read-only"));
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(".gelatin-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(folder_of(&target))?;
    file.write_all(bytes)?;
    if let Some(about) = old {
        file.as_file().set_permissions(about.permissions())?;
    }
    file.as_file().sync_all()?;
    file.persist(&target).map_err(|error| error.error)?;
    Ok(())
}

/// The folder a file is in; the current one for a bare name.
pub fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
        _ => PathBuf::from("."),
    }
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
        let form = refusal("(version: 1, obstacles: [(name: \"a\")])");
        assert!(form.contains("`plane` and `sphere`"), "{form}");
        let value = refusal("(version: 1, settings: (dt: 7.0))");
        assert_eq!(value, "a.ron: settings.dt = 7 s is outside 1e-6 … 0.1 s (line 1)");
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
