//! Model files within a scene, so that one file holds all that the scene is made of. A path that begins with
//! [`PREFIX`] names one of them, as `builtin:` names a model that the program carries.
//!
//! ```text
//! bodies: [(shape: model(path: "embedded:lamp/lamp.gltf"))]
//! models: [
//!     (path: "lamp/lamp.gltf", bytes: 700, deflated: "eJx…"),    a zlib stream, as base64
//!     (path: "lamp/bin/a.bin", bytes: 36, deflated: "eJy…"),     where lamp.gltf looks for it
//! ]
//! ```
//!
//! The files stay packed as in the scene file and are shared between all copies of a scene: an edit, its inverse and a save
//! in the background copy none of their bytes. No edit changes them.

use std::fmt;
use std::io::{self, Read, Write};
use std::sync::Arc;

use base64::prelude::{BASE64_STANDARD, Engine as _};
use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use thiserror::Error;

use crate::disk::ReadError;
use crate::geometry::import::HeldFiles;
use crate::text::echo;

/// The prefix of a model path that names one of these files.
pub const PREFIX: &str = "embedded:";

/// Model files within a scene.
#[derive(Clone, Default, PartialEq)]
pub struct Embedded(Arc<Vec<EmbeddedFile>>);

/// A model file within a scene.
#[derive(Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EmbeddedFile {
    /// Its path among the others, with `/` between folders.
    pub path: String,
    /// How many bytes it has.
    pub bytes: u64,
    /// The bytes as a zlib stream in base64.
    deflated: String,
}

/// Why an embedded file cannot be unpacked.
#[derive(Debug, Error)]
pub enum Damage {
    /// Letters that base64 does not have, or too few.
    #[error("a damaged text: {0}")]
    Text(base64::DecodeError),
    /// No zlib stream, or one that was changed.
    #[error("damaged: {0}")]
    Stream(#[from] io::Error),
    /// More or fewer bytes than the scene says.
    #[error("{found} bytes and not {said}")]
    Length {
        /// How many bytes there are; reading stops one beyond the number the scene says.
        found: u64,
        /// How many the scene says.
        said: u64,
    },
}

impl EmbeddedFile {
    /// Packs the bytes of a file.
    pub fn pack(path: String, bytes: &[u8]) -> Self {
        let mut packer = ZlibEncoder::new(Vec::new(), Compression::default());
        // Writing to memory cannot fail.
        let packed = packer.write_all(bytes).and_then(|()| packer.finish()).unwrap_or_default();
        Self { path, bytes: bytes.len() as u64, deflated: BASE64_STANDARD.encode(packed) }
    }

    /// The same file at another path.
    pub fn at(self, path: String) -> Self {
        Self { path, ..self }
    }

    /// Unpacks its bytes.
    ///
    /// # Errors
    /// If the bytes are damaged, or more or fewer than the scene says.
    pub fn unpack(&self) -> Result<Vec<u8>, Damage> {
        let mut bytes = Vec::new();
        self.unpack_into(&mut bytes)?;
        Ok(bytes)
    }

    /// Unpacks its bytes into a writer, without keeping them.
    pub(super) fn unpack_into(&self, to: &mut impl Write) -> Result<(), Damage> {
        // A person or a mail program may have broken the line.
        let is_broken = self.deflated.contains(|letter: char| letter.is_ascii_whitespace());
        let packed = if is_broken {
            let whole: String = self.deflated.split_ascii_whitespace().collect();
            BASE64_STANDARD.decode(whole)
        } else {
            BASE64_STANDARD.decode(&self.deflated)
        };
        let packed = packed.map_err(Damage::Text)?;
        let mut rest = ZlibDecoder::new(&packed[..]).take(self.bytes.saturating_add(1));
        match io::copy(&mut rest, to)? {
            found if found == self.bytes => Ok(()),
            found => Err(Damage::Length { found, said: self.bytes }),
        }
    }
}

impl Embedded {
    /// Files within a scene.
    pub fn new(files: Vec<EmbeddedFile>) -> Self {
        Self(Arc::new(files))
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// All of them.
    pub fn files(&self) -> &[EmbeddedFile] {
        &self.0
    }

    /// Finds the file at a path, or at one that differs in case alone, as files on the disk are found.
    pub fn find(&self, path: &str) -> Option<&EmbeddedFile> {
        let of_any_case = || {
            let small = path.to_lowercase();
            self.0.iter().find(|file| file.path.to_lowercase() == small)
        };
        self.0.iter().find(|file| file.path == path).or_else(of_any_case)
    }
}

impl HeldFiles for Embedded {
    fn read(&self, place: &str, limit: u64) -> Result<Vec<u8>, ReadError> {
        let file = self.find(place).ok_or_else(|| io::Error::from(io::ErrorKind::NotFound))?;
        if file.bytes > limit {
            return Err(ReadError::TooLarge(limit));
        }
        file.unpack().map_err(|damage| ReadError::Refused(io::Error::new(io::ErrorKind::InvalidData, damage)))
    }

    fn shown(&self, place: &str) -> String {
        echo(&format!("{PREFIX}{place}"))
    }
}

impl fmt::Debug for Embedded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.files()).finish()
    }
}

impl fmt::Debug for EmbeddedFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({} bytes, {} packed)", self.path, self.bytes, self.deflated.len())
    }
}

impl Serialize for Embedded {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.files().serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Embedded {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Vec::deserialize(deserializer).map(Self::new)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    /// A scene whose one model is a file with these values.
    fn text(path: &str, bytes: u64, deflated: &str) -> String {
        format!("(version: 1,\n models: [\n  (path: \"{path}\", bytes: {bytes},\n   deflated: \"{deflated}\")])")
    }

    fn deflated(bytes: &[u8]) -> String {
        EmbeddedFile::pack("a".into(), bytes).deflated
    }

    fn refusal(text: &str) -> String {
        Scene::from_ron(text, "a.ron").expect_err("refused").to_string()
    }

    #[test]
    fn what_was_packed_is_there_again_however_its_line_was_broken() {
        for bytes in [&b""[..], b"v 0 0 0\n", &vec![7; 100_000]] {
            let file = EmbeddedFile::pack("a.obj".into(), bytes);
            assert_eq!(file.unpack().expect("sound"), bytes);
            let (first, second) = file.deflated.split_at(5);
            let broken = Scene::from_ron(&text("a.obj", file.bytes, &format!("{first}\r\n  {second}")), "a.ron");
            let models = broken.expect("a scene").models;
            assert_eq!(models.read("a.obj", u64::MAX).expect("sound"), bytes);
        }
        assert!(deflated(&vec![7; 100_000]).len() < 500, "it takes less room");
    }

    #[test]
    fn what_is_damaged_is_named_with_its_field_and_line() {
        let good = deflated(b"v 0 0 0\n");
        Scene::from_ron(&text("lamp/bin/a.bin", 8, &good), "a.ron").expect("a sound one");
        let letters = refusal(&text("a", 8, &good.replacen('J', "!", 1)));
        assert!(
            letters.starts_with("a.ron: models.0.deflated = a damaged text") && letters.ends_with("(line 4)"),
            "{letters}"
        );
        let cut = refusal(&text("a", 8, &good[..good.len() - 4]));
        assert!(cut.contains("models.0.deflated = damaged"), "{cut}");
        let mut changed = BASE64_STANDARD.decode(&good).expect("base64");
        *changed.last_mut().expect("a checksum") ^= 1;
        let changed = refusal(&text("a", 8, &BASE64_STANDARD.encode(changed)));
        assert!(changed.contains("models.0.deflated = damaged"), "another checksum: {changed}");
        for (bytes, words) in [(7, "7, but it has more"), (9, "9, but it has fewer")] {
            let length = refusal(&text("a", bytes, &good));
            assert!(length.contains(&format!("models.0.bytes = {words} (line 3)")), "{length}");
        }
        for path in ["", "/etc/passwd", "../a", "a//b", "a/./b", "C:a", "a\\\\b"] {
            let words = refusal(&text(path, 8, &good));
            assert!(words.contains("models.0.path") && words.contains("no path"), "{path}: {words}");
        }
        let entry = format!("(path: \"a\", bytes: 8, deflated: \"{good}\")");
        let twice = refusal(&format!("(version: 1, models: [{entry},\n{entry}])"));
        assert!(twice.contains("models.1.path = \"a\", which is there twice") && twice.contains("line 2"), "{twice}");
    }

    #[test]
    fn a_short_text_does_not_become_very_many_bytes() {
        let zeros = deflated(&vec![0; 1 << 20]);
        let more = refusal(&text("a", 9, &zeros));
        assert!(more.contains("models.0.bytes = 9, but it has more"), "no more than was said is unpacked: {more}");
        let entry = format!("(path: \"a\", bytes: {}, deflated: \"\"),", 1_u64 << 29);
        let too_many = refusal(&format!("(version: 1, models: [{}])", entry.repeat(3)));
        assert!(too_many.contains("together hold at most 1024 MiB"), "nothing is unpacked: {too_many}");
        let huge = refusal(&format!(
            "(version: 1, models: [{}])",
            entry.replace("536870912", &u64::MAX.to_string()).repeat(2)
        ));
        assert!(huge.contains("together hold at most 1024 MiB"), "{huge}");
    }

    #[test]
    fn copies_share_the_bytes_and_edits_leave_them_alone() {
        let mut scene = Scene::from_ron(&text("a.obj", 8, &deflated(b"v 0 0 0\n")), "a.ron").expect("a scene");
        let copy = scene.clone();
        assert!(Arc::ptr_eq(&copy.models.0, &scene.models.0), "one and the same");
        crate::scene::path::set(&mut scene, "settings.gravity", "3").expect("a value");
        assert!(Arc::ptr_eq(&copy.models.0, &scene.models.0), "setting a value writes nothing down");
        assert_eq!(
            Scene::from_ron(&scene.to_ron().expect("text"), "b.ron").expect("a scene"),
            scene,
            "the file has it"
        );
    }
}
