//! A picture as a line of a material file names it: options, then the name of a file with all its blanks.
//!
//! ```text
//! map_Kd -s 2 2 1 -o 0.5 0 -clamp on bark of oak.png      place in the picture = s × vt + o, and no further than its edges
//! ```

use super::error::coordinate;
use super::sibling_files::{SiblingFiles, below_from};
use crate::math::picture::{Sampling, Wrap};

/// A picture that a material asks for.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TextureMap {
    /// The file as it is named, with `/` between folders.
    pub(super) file: String,
    /// The folder of the material file, relative to that of the model.
    pub(super) folder: String,
    /// How it is looked up.
    pub(super) sampling: Sampling,
    /// The options that are not read although they would change something.
    pub(super) left_out: Vec<&'static str>,
    scale: [f64; 2],
    offset: [f64; 2],
}

/// An option of a picture.
struct MapOption {
    word: &'static str,
    arguments: Arguments,
    /// For an option that is not read, the value that changes nothing; none if every value would.
    usual: Option<&'static str>,
}

/// The arguments of an option.
#[derive(Clone, Copy)]
enum Arguments {
    /// One word.
    Word,
    /// Up to this many numbers, of which all but the first may be left out.
    Numbers(usize),
}

const OPTIONS: [MapOption; 12] = [
    MapOption { word: "-s", arguments: Arguments::Numbers(3), usual: None },
    MapOption { word: "-o", arguments: Arguments::Numbers(3), usual: None },
    MapOption { word: "-clamp", arguments: Arguments::Word, usual: None },
    MapOption { word: "-t", arguments: Arguments::Numbers(3), usual: Some("0") },
    MapOption { word: "-mm", arguments: Arguments::Numbers(2), usual: Some("0 1") },
    MapOption { word: "-blendu", arguments: Arguments::Word, usual: Some("on") },
    MapOption { word: "-blendv", arguments: Arguments::Word, usual: Some("on") },
    MapOption { word: "-cc", arguments: Arguments::Word, usual: Some("off") },
    MapOption { word: "-boost", arguments: Arguments::Word, usual: None },
    MapOption { word: "-texres", arguments: Arguments::Word, usual: None },
    MapOption { word: "-bm", arguments: Arguments::Word, usual: Some("1") },
    MapOption { word: "-imfchan", arguments: Arguments::Word, usual: None },
];

impl TextureMap {
    /// Parses what follows `map_Kd` in a material file of a folder; none if no file is named.
    pub(super) fn parse(line: &[u8], folder: &str) -> Option<Self> {
        let line = String::from_utf8_lossy(line);
        let mut rest = line.trim();
        let mut map = Self {
            file: String::new(),
            folder: folder.to_owned(),
            sampling: Sampling::default(),
            left_out: Vec::new(),
            scale: [1.0; 2],
            offset: [0.0; 2],
        };
        while let Some((option, after)) = OPTIONS.iter().find_map(|option| Some((option, after(rest, option.word)?))) {
            let mut values = Vec::new();
            rest = after;
            let most = if let Arguments::Numbers(most) = option.arguments { most } else { 1 };
            while values.len() < most {
                // The last word belongs to the name of the file.
                let Some((word, after)) = rest.split_once(char::is_whitespace) else { break };
                if matches!(option.arguments, Arguments::Numbers(_)) && coordinate(word.as_bytes()).is_err() {
                    break;
                }
                values.push(word);
                rest = after.trim_start();
            }
            map.set_option(option, &values);
        }
        let quoted = rest.strip_prefix('"').and_then(|rest| rest.strip_suffix('"'));
        map.file = quoted.unwrap_or(rest).trim().replace('\\', "/");
        (!map.file.is_empty()).then_some(map)
    }

    /// Where a texture coordinate of the model lies in the picture. OBJ counts from the lower left corner of a picture.
    #[expect(clippy::cast_possible_truncation, reason = "a place in a picture needs no more than single precision")]
    pub(super) fn place(&self, coordinate: [f64; 2]) -> [f32; 2] {
        let [u, v] = [0, 1].map(|axis| self.scale[axis] * coordinate[axis] + self.offset[axis]);
        [u as f32, (1.0 - v) as f32]
    }

    /// Finds the file beside the model: by its name or, since the name often has a folder of another machine, by the last
    /// part of it beside the material file.
    pub(super) fn find(&self, beside: SiblingFiles<'_>) -> Option<String> {
        let last = self.file.rsplit('/').next().unwrap_or_default();
        let names = [&self.file, last].into_iter().filter_map(|name| below_from(&self.folder, name));
        names.into_iter().find(|name| beside.has(name))
    }

    /// Why there is no such file.
    pub(super) fn why_missing(&self) -> &'static str {
        match below_from(&self.folder, &self.file) {
            Some(_) => "it does not exist",
            None => "only files beside the model and in folders below it are read",
        }
    }

    fn set_option(&mut self, option: &MapOption, values: &[&str]) {
        let numbers = |otherwise: f64| {
            let mut found = values.iter().map(|word| coordinate(word.as_bytes()).unwrap_or(otherwise));
            [0; 2].map(|_| found.next().unwrap_or(otherwise))
        };
        match option.word {
            "-s" => self.scale = numbers(1.0),
            "-o" => self.offset = numbers(0.0),
            "-clamp" if values.first() == Some(&"on") => self.sampling.wrap = [Wrap::Clamp; 2],
            "-clamp" => {}
            word => {
                let is_usual = option.usual.is_some_and(|usual| {
                    let mut usual = usual.split(' ').cycle();
                    values.iter().all(|value| {
                        let (value, usual) = (value, usual.next().unwrap_or_default());
                        let [number, same] = [value, usual].map(|word| coordinate(word.as_bytes()).ok());
                        *value == usual || number.is_some() && number == same
                    })
                });
                if !is_usual && !self.left_out.contains(&word) {
                    self.left_out.push(word);
                }
            }
        }
    }
}

/// Returns what follows a word at the beginning of a line.
fn after<'a>(line: &'a str, word: &str) -> Option<&'a str> {
    let rest = line.strip_prefix(word)?;
    rest.starts_with(char::is_whitespace).then(|| rest.trim_start())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(line: &str) -> TextureMap {
        TextureMap::parse(line.as_bytes(), "").expect("a file is named")
    }

    #[test]
    fn names_keep_their_blanks_and_lose_their_marks() {
        for (line, file) in [
            ("wood.png", "wood.png"),
            ("  bark of oak.png \t", "bark of oak.png"),
            ("\"bark of oak.png\"", "bark of oak.png"),
            ("..\\textures\\Oak 2.JPG", "../textures/Oak 2.JPG"),
            ("-s 1 1 1 bark of oak.png", "bark of oak.png"),
            ("-s 2 4.png", "4.png"),
            ("-s 1 2 3 4", "4"),
            ("-s 1 2 3", "3"),
            ("-o 0.5 oak.png", "oak.png"),
            ("-clamp on -blendu off oak.png", "oak.png"),
            ("-final.png", "-final.png"),
            ("-s.png", "-s.png"),
        ] {
            assert_eq!(map(line).file, file, "{line}");
        }
        for line in ["", "  ", "\"\""] {
            assert_eq!(TextureMap::parse(line.as_bytes(), ""), None, "{line:?} names none");
        }
    }

    #[test]
    #[expect(clippy::float_cmp, reason = "sums of a few halves are exact")]
    fn options_move_the_picture_or_are_named() {
        assert_eq!(map("a.png").place([0.25, 0.25]), [0.25, 0.75], "v points up in OBJ and down in a picture");
        let moved = map("-s 2 4 1 -o 0.5 0.25 0 a.png");
        assert_eq!(moved.place([0.25, 0.125]), [1.0, 0.25]);
        assert_eq!(map("-s 3 a.png").place([1.0, 1.0]), [3.0, 0.0], "what is not said is as it was");
        assert_eq!(map("-clamp on a.png").sampling.wrap, [Wrap::Clamp; 2]);
        assert_eq!(map("-clamp off a.png").sampling, Sampling::default());
        let usual = "-t 0 0 0 -mm 0.0 1 -blendu on -blendv on -cc off -bm 1.0 a.png";
        assert_eq!(map(usual).left_out, [""; 0], "these say nothing");
        let others = "-t 0 0.5 -mm 0.2 1 -blendu off -cc on -boost 2 -texres 512 -imfchan r -t 1 a.png";
        let left_out = ["-t", "-mm", "-blendu", "-cc", "-boost", "-texres", "-imfchan"];
        assert_eq!(map(others), TextureMap { left_out: left_out.to_vec(), ..map("a.png") }, "and these are not read");
    }
}
