//! The material files that an OBJ file names (`mtllib`).

use super::mtl::MAX_LIBRARIES;

/// The material files that an OBJ file names, each once.
pub(super) fn libraries(bytes: &[u8]) -> Vec<String> {
    let mut found = Vec::new();
    let lines = bytes.split(|byte| matches!(byte, b'\n' | b'\r'));
    let is_library =
        |line: &&[u8]| line.split(u8::is_ascii_whitespace).find(|word| !word.is_empty()) == Some(b"mtllib");
    lines.filter(is_library).for_each(|line| add_library(&mut found, line));
    found
}

/// Adds the name in a line `mtllib`.
pub(super) fn add_library(libraries: &mut Vec<String>, line: &[u8]) {
    let rest = line.trim_ascii().strip_prefix(b"mtllib").unwrap_or_default();
    let name = String::from_utf8_lossy(rest.trim_ascii()).into_owned();
    if libraries.len() < MAX_LIBRARIES && !name.is_empty() && !libraries.contains(&name) {
        libraries.push(name);
    }
}
