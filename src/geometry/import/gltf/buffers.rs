//! The bytes of a glTF file: within it, in its text or in files beside it. Each buffer is read once, when it is first asked
//! for.

use std::borrow::Cow;

use base64::Engine as _;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use gltf_json::Root;
use percent_encoding::percent_decode_str;

use crate::disk::ReadError;
use crate::geometry::import::error::{ImportError, Place, Problem};
use crate::geometry::import::formats::MAX_FILE_BYTES;
use crate::geometry::import::model_file::ModelFile;
use crate::geometry::import::sibling_files::below;
use crate::text::echo_up_to;

/// Standard base64, with or without `=` at its end.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// The buffers of a file.
pub(super) struct Buffers<'a> {
    file: ModelFile<'a>,
    root: &'a Root,
    blob: Option<&'a [u8]>,
    read: Vec<Option<Cow<'a, [u8]>>>,
    /// The bytes that all buffers together may still have.
    budget: u64,
}

impl<'a> Buffers<'a> {
    /// The buffers of a file; `blob` is the one within a binary file.
    pub(super) fn new(file: ModelFile<'a>, root: &'a Root, blob: Option<&'a [u8]>) -> Self {
        Self { file, root, blob, read: vec![None; root.buffers.len()], budget: MAX_FILE_BYTES }
    }

    /// The bytes of a view into a buffer.
    pub(super) fn view(&mut self, view: usize, place: &Place) -> Result<&[u8], ImportError> {
        let file = self.file;
        let of = self.root.buffer_views.get(view).ok_or_else(|| file.no_such(place.clone(), "buffer view", view))?;
        let buffer = of.buffer.value();
        let start = of.byte_offset.map_or(0, |offset| offset.0);
        let end = start.saturating_add(of.byte_length.0);
        let bytes = self.buffer(buffer, place)?;
        let range = usize::try_from(start).ok().zip(usize::try_from(end).ok());
        range.and_then(|(start, end)| bytes.get(start..end)).ok_or_else(|| {
            let what = format!("buffer view {view} and what is before it");
            file.at(Place::Buffer(buffer), Problem::TooShort { what, needed: end, there: bytes.len() as u64 })
        })
    }

    fn buffer(&mut self, number: usize, place: &Place) -> Result<&[u8], ImportError> {
        let slot = self.read.get(number).ok_or_else(|| self.file.no_such(place.clone(), "buffer", number))?;
        if slot.is_none() {
            let bytes = self.fetch(number).map_err(|problem| match problem {
                Fault::TooLarge => ImportError::TooLarge { file: self.file.name.to_owned() },
                Fault::Problem(problem) => self.file.at(Place::Buffer(number), problem),
            })?;
            self.budget = self.budget.saturating_sub(bytes.len() as u64);
            self.read[number] = Some(bytes);
        }
        Ok(self.read[number].as_deref().unwrap_or_default())
    }

    fn fetch(&self, number: usize) -> Result<Cow<'a, [u8]>, Fault> {
        let bytes = match (self.root.buffers[number].uri.as_deref(), self.blob) {
            (Some(uri), _) => Cow::Owned(self.named(uri, "buffer")?),
            (None, Some(blob)) if number == 0 => Cow::Borrowed(blob),
            (None, _) => return Err(Problem::Missing("what it holds, a `uri` or a chunk `BIN`,").into()),
        };
        let (needed, there) = (self.root.buffers[number].byte_length.0, bytes.len() as u64);
        if needed > there {
            return Err(Problem::TooShort { what: "its contents".into(), needed, there }.into());
        }
        Ok(bytes)
    }

    /// Returns the bytes that a URI names, or why there are none; `what` says what they are of.
    pub(super) fn of_uri(&mut self, uri: &str, what: &str) -> Result<Vec<u8>, String> {
        let bytes = self.named(uri, what).map_err(|fault| match fault {
            Fault::TooLarge => format!("it would make the model larger than {} MiB", MAX_FILE_BYTES >> 20),
            Fault::Problem(problem) => problem.to_string(),
        })?;
        self.budget = self.budget.saturating_sub(bytes.len() as u64);
        Ok(bytes)
    }

    fn named(&self, uri: &str, what: &str) -> Result<Vec<u8>, Fault> {
        uri.strip_prefix("data:").map_or_else(|| self.beside(uri, what), |rest| embedded(rest, self.budget))
    }

    /// The bytes of a file beside the model or in a folder below it.
    fn beside(&self, uri: &str, what: &str) -> Result<Vec<u8>, Fault> {
        let Some((beside, name)) = self.file.beside.zip(below(&decoded(uri))) else {
            let what = format!("the {what} `{}`", echo_up_to(&decoded(uri), 60));
            let remedy = "only files beside the model and in folders below it are";
            return Err(Problem::Unsupported { what, remedy }.into());
        };
        beside.read(&name, self.budget).map_err(|error| {
            let why = match &error {
                ReadError::TooLarge(_) => return Fault::TooLarge,
                ReadError::Refused(source) if source.kind() == std::io::ErrorKind::NotFound => "does not exist".into(),
                other => other.to_string(),
            };
            Problem::Beside { file: beside.shown(&name), why }.into()
        })
    }
}

/// Returns the bytes of a `data:` URI, given what follows the colon, if there are no more than `budget`.
fn embedded(rest: &str, budget: u64) -> Result<Vec<u8>, Fault> {
    let refused = |why: String| Fault::from(Problem::Refused { format: "a data URI", why });
    let (kind, text) = rest.split_once(',').ok_or_else(|| refused("it has no comma".into()))?;
    let is_base64 = kind.ends_with(";base64");
    // Four letters of base64 hold three bytes.
    let held = if is_base64 { text.len() as u64 / 4 * 3 } else { percent_decode_str(text).count() as u64 };
    if held > budget {
        return Err(Fault::TooLarge);
    }
    if is_base64 {
        BASE64.decode(text).map_err(|error| refused(error.to_string()))
    } else {
        Ok(percent_decode_str(text).collect())
    }
}

/// Decodes the percent signs of a URI.
fn decoded(uri: &str) -> Cow<'_, str> {
    percent_decode_str(uri).decode_utf8_lossy()
}

/// Returns the name of the file beside a model that a URI means; none if it means no such file.
pub(super) fn name_beside(uri: &str) -> Option<String> {
    if uri.starts_with("data:") { None } else { below(&decoded(uri)) }
}

/// Why a buffer gives no bytes.
enum Fault {
    TooLarge,
    Problem(Problem),
}

impl From<Problem> for Fault {
    fn from(problem: Problem) -> Self {
        Self::Problem(problem)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_data_uri_is_as_large_as_what_it_holds() {
        for (rest, held) in [(",a%20b", b"a b".as_slice()), (",%41%42", b"AB"), ("x/y;base64,AAEC", &[0, 1, 2])] {
            let size = held.len() as u64;
            assert!(matches!(embedded(rest, size), Ok(bytes) if bytes == held), "{rest}");
            assert!(matches!(embedded(rest, size - 1), Err(Fault::TooLarge)), "{rest}");
        }
        assert!(matches!(embedded("base64", 9), Err(Fault::Problem(_))), "no comma");
    }
}
