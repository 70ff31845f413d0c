//! The pictures that the materials of a model ask for: each is read once, and all are unpacked in parallel. A picture that
//! cannot be read is left out with a warning, and the model is read without it.

use std::sync::Arc;

use rayon::prelude::*;

use super::error::ImportError;
use super::model_file::ModelFile;
use crate::geometry::picture_file::{self, Opacity, PictureError};
use crate::math::picture::{Picture, Sampling, Texture};
use crate::text::echo_up_to;

/// The most texels that the pictures of a model have together, at the sizes in their files.
const MAX_TEXELS_TOGETHER: u64 = 1 << 27;

/// The most textures of a model.
const MAX_TEXTURES: usize = 1024;

/// The file of a picture: its name in messages, and its bytes or why there are none.
pub(super) struct PictureBytes {
    pub(super) name: String,
    pub(super) bytes: Result<Vec<u8>, String>,
}

/// The textures that are asked for; `K` identifies a picture.
pub(super) struct TextureRequests<K> {
    pictures: Vec<(K, Opacity)>,
    /// The index of the picture, and how it is looked up.
    textures: Vec<(usize, Sampling)>,
    is_full: bool,
    /// The most texels of all pictures together.
    max_texels: u64,
}

/// The textures that could be read.
#[derive(Default)]
pub(super) struct Textures {
    /// All of them.
    pub(super) all: Vec<Texture>,
    /// For every texture that was asked for, its index among them.
    places: Vec<Option<u16>>,
}

impl<K: PartialEq> TextureRequests<K> {
    pub(super) fn new() -> Self {
        Self { pictures: Vec::new(), textures: Vec::new(), is_full: false, max_texels: MAX_TEXELS_TOGETHER }
    }

    /// Asks for a texture and returns its number; none if there are too many.
    pub(super) fn request(&mut self, picture: K, opacity: Opacity, sampling: Sampling) -> Option<u16> {
        let wanted = (picture, opacity);
        let known = self.pictures.iter().position(|known| *known == wanted);
        let texture = (known.unwrap_or(self.pictures.len()), sampling);
        let place = self.textures.iter().position(|known| *known == texture).unwrap_or(self.textures.len());
        if place >= MAX_TEXTURES {
            self.is_full = true;
            return None;
        }
        if known.is_none() {
            self.pictures.push(wanted);
        }
        if place == self.textures.len() {
            self.textures.push(texture);
        }
        u16::try_from(place).ok()
    }

    /// Whether nothing was asked for.
    pub(super) fn is_empty(&self) -> bool {
        self.textures.is_empty()
    }

    /// Reads and unpacks the pictures; a picture that cannot be read gives a warning.
    ///
    /// # Errors
    /// If the watch has cancelled.
    pub(super) fn load(
        self,
        file: ModelFile<'_>,
        read: impl FnMut(K) -> PictureBytes,
        warnings: &mut Vec<String>,
    ) -> Result<Textures, ImportError> {
        if self.is_full {
            warnings.push(format!("only the first {MAX_TEXTURES} textures of the model are shown"));
        }
        let (keys, opacities): (Vec<K>, Vec<Opacity>) = self.pictures.into_iter().unzip();
        let read = keys.into_iter().map(read);
        let pictures = decode_pictures(file, read.zip(opacities), self.max_texels, warnings)?;
        let mut textures = Textures { all: Vec::new(), places: Vec::new() };
        for (picture, sampling) in self.textures {
            let picture = pictures[picture].clone();
            textures.places.push(picture.as_ref().and_then(|_| u16::try_from(textures.all.len()).ok()));
            textures.all.extend(picture.map(|picture| Texture { picture, sampling }));
        }
        Ok(textures)
    }
}

impl Textures {
    /// Returns the index of a texture by the number that asking for it gave.
    pub(super) fn place(&self, number: u16) -> Option<u16> {
        self.places.get(usize::from(number)).copied().flatten()
    }
}

/// Returns the warning about a picture that is not shown.
fn picture_warning(name: &str, why: &str) -> String {
    format!("no picture from {}, plain colours instead: {why}", echo_up_to(name, 60))
}

fn decode_pictures(
    file: ModelFile<'_>,
    read: impl Iterator<Item = (PictureBytes, Opacity)>,
    max_texels: u64,
    warnings: &mut Vec<String>,
) -> Result<Vec<Option<Arc<Picture>>>, ImportError> {
    let (mut texels, mut packed) = (0, Vec::new());
    for (PictureBytes { name, bytes }, opacity) in read {
        if file.watch.cancelled() {
            return Err(file.cancelled());
        }
        let bytes = bytes.and_then(|bytes| {
            let [width, height] = picture_file::size(&bytes).map_err(|error| sentence(&error))?;
            texels += u64::from(width) * u64::from(height);
            if texels > max_texels {
                let most = max_texels >> 20;
                return Err(format!("the pictures of the model have more than {most} million texels together"));
            }
            Ok(bytes)
        });
        packed.push((name, bytes, opacity));
    }
    let unpacked: Vec<Result<Picture, String>> = packed
        .par_iter()
        .map(|(_, bytes, opacity)| match bytes {
            _ if file.watch.cancelled() => Err(String::new()),
            Ok(bytes) => picture_file::decode(bytes, *opacity).map_err(|error| sentence(&error)),
            Err(why) => Err(why.clone()),
        })
        .collect();
    if file.watch.cancelled() {
        return Err(file.cancelled());
    }
    let kept = packed.iter().zip(unpacked).map(|((name, ..), picture)| {
        let told = picture.map_err(|why| warnings.push(picture_warning(name, &why)));
        told.ok().map(Arc::new)
    });
    Ok(kept.collect())
}

/// An error as a sentence of its own.
fn sentence(error: &PictureError) -> String {
    format!("it {error}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::import::model_file::Detail;
    use crate::geometry::import::tests::Never;
    use crate::geometry::picture_file::tests::png;

    fn sound(name: &str, size: [u32; 2]) -> PictureBytes {
        let texels = vec![[7, 8, 9, 255]; size[0] as usize * size[1] as usize];
        PictureBytes { name: name.to_owned(), bytes: Ok(png(size, &texels)) }
    }

    const FILE: ModelFile<'static> =
        ModelFile { bytes: b"", name: "m.obj", beside: None, detail: Detail::Pictures, watch: &() };

    #[test]
    fn a_picture_is_unpacked_once_and_a_bad_one_is_told() {
        let mut requests = TextureRequests::new();
        let (plain, sharp) = (Sampling::default(), Sampling { levels: None, ..Sampling::default() });
        let asked = [("a", plain), ("bad", plain), ("a", sharp), ("a", plain), ("gone", sharp)];
        let numbers = asked.map(|(name, sampling)| requests.request(name, Opacity::Counts, sampling));
        assert_eq!(numbers, [Some(0), Some(1), Some(2), Some(0), Some(3)]);
        let (mut warnings, mut read) = (Vec::new(), Vec::new());
        let bytes = |name: &str| {
            read.push(name.to_owned());
            match name {
                "a" => sound(name, [1, 1]),
                "bad" => PictureBytes { name: name.to_owned(), bytes: Ok(b"GIF89a".to_vec()) },
                _ => PictureBytes { name: name.to_owned(), bytes: Err("it does not exist".to_owned()) },
            }
        };
        let textures = requests.load(FILE, bytes, &mut warnings).expect("nobody cancels");
        assert_eq!(read, ["a", "bad", "gone"], "each once");
        assert_eq!([0, 1, 2, 3, 4].map(|number| textures.place(number)), [Some(0), None, Some(1), None, None]);
        assert!(Arc::ptr_eq(&textures.all[0].picture, &textures.all[1].picture), "one picture, looked up in two ways");
        assert_eq!(
            warnings,
            [
                "no picture from bad, plain colours instead: it is no PNG or JPEG picture; save it as one of them",
                "no picture from gone, plain colours instead: it does not exist",
            ]
        );
    }

    #[test]
    fn all_pictures_together_have_a_limit_and_may_be_given_up() {
        let asked = || {
            let mut requests = TextureRequests { max_texels: 3 << 20, ..TextureRequests::new() };
            let numbers = [0, 1, 2].map(|number| requests.request(number, Opacity::Ignored, Sampling::default()));
            assert_eq!(numbers, [0, 1, 2].map(Some));
            requests
        };
        let large = |number: i32| sound(&number.to_string(), [1 << 10, 1 << (10 + number.min(1))]);
        let mut warnings = Vec::new();
        let textures = asked().load(FILE, large, &mut warnings).expect("nobody cancels");
        let places = [0, 1, 2].map(|number| textures.place(number));
        assert_eq!(places, [Some(0), Some(1), None], "the last is one too many: {warnings:?}");
        let why = "no picture from 2, plain colours instead: the pictures of the model have more than 3 million texels \
                   together";
        assert_eq!(warnings, [why]);
        let given_up = asked().load(ModelFile { watch: &Never, ..FILE }, |_| sound("a", [1, 1]), &mut warnings);
        assert!(matches!(given_up, Err(ImportError::Cancelled { .. })));
        let mut full = TextureRequests::new();
        let numbers: Vec<_> =
            (0..=MAX_TEXTURES).map(|n| full.request(n, Opacity::Counts, Sampling::default())).collect();
        assert!(numbers[MAX_TEXTURES - 1].is_some() && numbers[MAX_TEXTURES].is_none(), "so many and no more");
        assert_eq!(full.pictures.len(), MAX_TEXTURES, "what is not shown is not read");
    }
}
