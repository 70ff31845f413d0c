//! The material files of OBJ: texts beside the model. A material's colour (`Kd`) and the picture of its colours (`map_Kd`)
//! are read; a line that is not understood does not affect the others.

use std::collections::BTreeMap;

use super::error::coordinate;
use super::model_file::ModelFile;
use super::mtl_map::TextureMap;
use super::sibling_files::{SiblingFiles, below, folder_and_name};
use crate::disk::ReadError;
use crate::geometry::named_parts::clean;
use crate::geometry::paint::{NO_TINT, Tint, tint_of_srgb};
use crate::text::echo_up_to;

/// The most bytes of all material files of a model together.
const MAX_BYTES: u64 = 16 << 20;

/// The most material files of a model that are looked for.
pub(super) const MAX_LIBRARIES: usize = 64;

/// Materials by their names, as [`clean`] leaves them.
pub(super) type Materials = BTreeMap<String, Material>;

/// What a material looks like.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Material {
    /// Its colour.
    pub(super) tint: Tint,
    /// The picture that its colour is multiplied by.
    pub(super) map: Option<TextureMap>,
}

/// Reads the material files that a model names; a file that cannot be read gives a warning. A model that is not a file has
/// none beside it.
pub(super) fn read(file: ModelFile<'_>, named: &[String], warnings: &mut Vec<String>) -> Materials {
    let mut materials = Materials::new();
    let Some(beside) = file.beside else { return materials };
    let mut budget = MAX_BYTES;
    for named in named {
        match find(beside, named, budget) {
            Ok(files) => {
                for (name, bytes) in files {
                    budget = budget.saturating_sub(bytes.len() as u64);
                    add(&mut materials, &bytes, folder_and_name(&name).0);
                }
            }
            Err(why) => warnings.push(format!("no colours from the materials in {}: {why}", echo_up_to(named, 60))),
        }
    }
    materials
}

/// Returns the names of the material files beside a model, and of the pictures in them, as far as the files exist.
pub(super) fn names_beside(beside: SiblingFiles<'_>, named: &[String]) -> Vec<String> {
    let (mut names, mut materials) = (Vec::new(), Materials::new());
    for (name, bytes) in named.iter().filter_map(|named| find(beside, named, MAX_BYTES).ok()).flatten() {
        add(&mut materials, &bytes, folder_and_name(&name).0);
        names.push(name);
    }
    names.extend(materials.values().filter_map(|material| material.map.as_ref()?.find(beside)));
    names
}

/// Reads the file that a line `mtllib` names, with blanks in its name, or else the several files that it names.
fn find(beside: SiblingFiles<'_>, named: &str, limit: u64) -> Result<Vec<(String, Vec<u8>)>, String> {
    let one = |name: &str| {
        let elsewhere = || "only files beside the model and in folders below it are read".to_owned();
        let name = below(name).ok_or_else(elsewhere)?;
        let bytes = beside.read(&name, limit).map_err(|error| match error {
            ReadError::Refused(source) if source.kind() == std::io::ErrorKind::NotFound => {
                "there is no such file".to_owned()
            }
            other => other.to_string(),
        })?;
        Ok((name, bytes))
    };
    let whole = one(named).map(|file| vec![file]);
    if whole.is_err() && named.contains(char::is_whitespace) {
        let several: Result<Vec<_>, String> = named.split_whitespace().map(one).collect();
        return several.or(whole);
    }
    whole
}

/// Adds the materials of a file in a folder.
fn add(materials: &mut Materials, bytes: &[u8], folder: &str) {
    let mut now = None;
    for line in bytes.split(|byte| matches!(byte, b'\n' | b'\r')).map(<[u8]>::trim_ascii) {
        let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
        let (word, rest) = line.split_at(end);
        match word {
            b"newmtl" => now = Some(clean(&String::from_utf8_lossy(rest))),
            b"Kd" => {
                let channels = rest.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
                let found: Vec<f64> = channels.map_while(|word| coordinate(word).ok()).collect();
                let tint = match found[..] {
                    [grey] => tint_of_srgb([grey; 3]),
                    [red, green, blue, ..] => tint_of_srgb([red, green, blue]),
                    _ => NO_TINT,
                };
                if let Some(name) = &now {
                    materials.entry(name.clone()).or_default().tint = tint;
                }
            }
            b"map_Kd" => {
                if let Some((name, map)) = now.as_ref().zip(TextureMap::parse(rest, folder)) {
                    materials.entry(name.clone()).or_default().map = Some(map);
                }
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_read_whatever_else_is_there() {
        let text = "# a\nKd 1 1 1\nnewmtl Red Rubber #25\nd -halo 0.5\n\tKd 1 0 0.5\nmap_Kd\nnewmtl grey\r\nKd 0.2\n\
                    newmtl measured\nKd spectral a.rfl 1\nnewmtl two\nKd 1 2\nnewmtl bright\nKd 9 0 0\nKs x\n";
        let mut found = Materials::new();
        add(&mut found, text.as_bytes(), "");
        let names = ["Red Rubber #25", "grey", "measured", "two", "bright"].map(|name| found[name].tint);
        assert_eq!(names, [[255, 0, 128, 255], [51, 51, 51, 255], NO_TINT, NO_TINT, [255, 0, 0, 255]]);
        assert!(found.values().all(|material| material.map.is_none()), "`map_Kd` names no file");
        assert_eq!(found.len(), 5, "a colour without a material is nobody's");
    }
}
