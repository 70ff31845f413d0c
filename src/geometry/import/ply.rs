//! PLY files, binary and text: vertices with `x`, `y` and `z` and their normals, faces with any number of corners, and the
//! colours of both (`red`, `green`, `blue`). Everything else that a file's own header describes is skipped.
//!
//! ply-rs-bw reads the header and the elements of binary files, one at a time, so that errors can name the element. Texts
//! are parsed here: the crate accepts neither `nan` in an unused property nor `.5`, and drops the digits beyond single
//! precision of a `float`.

mod element;

use glam::DVec3;
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Encoding, Header, PropertyType, ScalarType};

use super::assembly::{Assembly, vertex_index, within_reach};
use super::error::{ImportError, Place, Problem, quote};
use super::model_file::{Imported, ModelFile};
use crate::geometry::paint::tint_of_srgb;
use element::{Element, INDICES, text_element};

/// The longest header, bytes.
const MAX_HEADER_BYTES: usize = 1 << 20;

/// Whether the first line says that it is a PLY file.
pub(super) fn is_ply(bytes: &[u8]) -> bool {
    bytes.strip_prefix(b"ply").is_some_and(|rest| rest.first().is_some_and(u8::is_ascii_whitespace))
}

/// Reads a PLY file.
pub(super) fn read(file: ModelFile<'_>) -> Result<Imported, ImportError> {
    let SplitFile { text, lines, payload } = split(file)?;
    let header = parse_header(file, &text)?;
    let mut rest = Payload { bytes: payload, line: lines + 1, encoding: header.encoding };
    let mut assembly = Assembly::new(file);
    for def in header.elements.values().filter(|def| !def.properties.is_empty()) {
        let kind = match def.name.as_str() {
            "vertex" => Kind::Vertex,
            "face" => Kind::Face,
            _ => Kind::Other,
        };
        check(file, def, kind, &rest, &assembly)?;
        read_elements(file, def, kind, &mut rest, &mut assembly)?;
    }
    assembly.finish()
}

/// What an element means to a surface.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Vertex,
    Face,
    Other,
}

/// A file taken apart.
struct SplitFile<'a> {
    /// The header with `\n` after each line.
    text: String,
    /// The number of its lines.
    lines: usize,
    payload: &'a [u8],
}

/// Splits the header from the rest. All lines end as the first one does.
fn split(file: ModelFile<'_>) -> Result<SplitFile<'_>, ImportError> {
    let is_end = |&byte: &u8| byte == b'\n' || byte == b'\r';
    let first = file.bytes.iter().position(is_end).unwrap_or(0);
    let lone_return = file.bytes.get(first..).is_some_and(|rest| rest.starts_with(b"\r") && !rest.starts_with(b"\r\n"));
    let end = if lone_return { b'\r' } else { b'\n' };
    let start = &file.bytes[..file.bytes.len().min(MAX_HEADER_BYTES)];
    let (mut text, mut lines, mut length) = (String::new(), 0, 0);
    for line in start.split_inclusive(|&byte| byte == end) {
        let shown = String::from_utf8_lossy(line.trim_ascii_end());
        lines += 1;
        length += line.len();
        text.push_str(&shown);
        text.push('\n');
        if shown == "end_header" {
            return Ok(SplitFile { text, lines, payload: &file.bytes[length..] });
        }
    }
    Err(file.at(Place::Line(lines), Problem::Ends("a line `end_header`")))
}

fn parse_header(file: ModelFile<'_>, text: &str) -> Result<Header, ImportError> {
    let mut reader = Reader::new(text.as_bytes());
    let header = Parser::<Element>::new().read_header(&mut reader).map_err(|error| {
        let number = error.line().unwrap_or(2);
        let line = text.lines().nth(number - 1).unwrap_or_default();
        let needed = match error.line() {
            Some(1) => "`ply`",
            Some(_) => "a line of a PLY header, such as `element vertex 8` or `property float x`,",
            None => "a line such as `format ascii 1.0`",
        };
        file.at(Place::Line(number), Problem::Unexpected { found: quote(line.as_bytes()), needed })
    })?;
    // Of two equal names the parser keeps one, and would take the bytes of the other for something else's.
    let says = |word: &str| text.lines().filter(|line| line.split_ascii_whitespace().next() == Some(word)).count();
    let properties: usize = header.elements.values().map(|def| def.properties.len()).sum();
    if says("element") != header.elements.len() || says("property") != properties {
        let problem = Problem::Unsupported { what: "a name that stands twice".into(), remedy: "each needs its own" };
        return Err(file.at(Place::Header, problem));
    }
    Ok(header)
}

/// Checks what the header says of an element against what a surface needs and the bytes that are there.
fn check(
    file: ModelFile<'_>,
    def: &ElementDef,
    kind: Kind,
    rest: &Payload<'_>,
    assembly: &Assembly<'_>,
) -> Result<(), ImportError> {
    let fail = |problem| Err(file.at(Place::Header, problem));
    let property = |name: &str| def.properties.get(name).map(|property| &property.data_type);
    let is_scalar = |name: &str| matches!(property(name), Some(PropertyType::Scalar(_)));
    match kind {
        Kind::Vertex if ["x", "y", "z"].iter().any(|name| !is_scalar(name)) => {
            return fail(Problem::Missing("a coordinate of `element vertex`, such as `property float x`,"));
        }
        Kind::Face => match INDICES.map(property) {
            [None, None] => {
                return fail(Problem::Missing("`property list uchar int vertex_indices` of `element face`"));
            }
            [Some(corners), None] | [None, Some(corners)] if is_list_of_whole_numbers(corners) => {
                if assembly.vertices() == 0 && def.count > 0 {
                    let remedy = "`element vertex` must stand before `element face` and have vertices";
                    return fail(Problem::Unsupported { what: "a file whose faces come first".into(), remedy });
                }
            }
            _ => {
                let remedy = "faces need one `property list uchar int vertex_indices`";
                return fail(Problem::Unsupported { what: "what the corners of faces are written as".into(), remedy });
            }
        },
        _ => {}
    }
    let least: u64 = def.properties.values().map(|property| rest.least_bytes(&property.data_type)).sum();
    // The last line of a text may have no end.
    let there = rest.bytes.len() as u64 + u64::from(rest.encoding == Encoding::Ascii);
    let needed = least.saturating_mul(def.count as u64);
    if needed > there {
        let what = format!("{} elements `{}`", def.count, quote(def.name.as_bytes()));
        return fail(Problem::TooShort { what, needed, there: rest.bytes.len() as u64 });
    }
    Ok(())
}

fn is_list_of_whole_numbers(property: &PropertyType) -> bool {
    let is_whole = |kind: &ScalarType| !matches!(kind, ScalarType::Float | ScalarType::Double);
    matches!(property, PropertyType::List(count, entry) if is_whole(count) && is_whole(entry))
}

fn read_elements(
    file: ModelFile<'_>,
    def: &ElementDef,
    kind: Kind,
    rest: &mut Payload<'_>,
    assembly: &mut Assembly<'_>,
) -> Result<(), ImportError> {
    let vertices = assembly.vertices();
    let mut face = Vec::new();
    for number in 0..def.count {
        file.report_progress(number, || 1.0 - rest.bytes.len() as f64 / file.bytes.len() as f64)?;
        let element = rest.next(def).map_err(|problem| file.at(rest.place(def, number), problem))?;
        let place = || rest.place(def, number);
        match kind {
            Kind::Vertex => {
                assembly.vertex(within_reach(file, DVec3::from_array(element.position), place)?)?;
                assembly.paint_vertex(tint_of_srgb(element.color));
                assembly.vertex_normal(DVec3::from_array(element.normal));
            }
            Kind::Face => {
                let corners = element.corners.iter().map(|&corner| vertex_index(corner, vertices));
                face.clear();
                for corner in corners {
                    face.push(corner.map_err(|problem| file.at(place(), problem))?);
                }
                assembly.paint_faces(tint_of_srgb(element.color));
                assembly.face(&mut face)?;
            }
            Kind::Other => {}
        }
    }
    Ok(())
}

/// The elements of a file that have not been read.
struct Payload<'a> {
    bytes: &'a [u8],
    /// In a text, the number of the next line.
    line: usize,
    encoding: Encoding,
}

impl<'a> Payload<'a> {
    fn next(&mut self, def: &ElementDef) -> Result<Element, Problem> {
        let parser = Parser::<Element>::new();
        let read = match self.encoding {
            Encoding::Ascii => {
                let line = self.next_line().ok_or(Problem::Ends("one more element"))?;
                return text_element(line, def);
            }
            Encoding::BinaryBigEndian => parser.read_big_endian_element(&mut self.bytes, def),
            Encoding::BinaryLittleEndian => parser.read_little_endian_element(&mut self.bytes, def),
        };
        // Bytes of known sizes can be wrong in two ways: they end, or a list has a negative number of entries.
        read.map_err(|error| match error.kind() {
            std::io::ErrorKind::UnexpectedEof => Problem::Ends("the rest of it"),
            _ => Problem::Refused { format: "PLY", why: quote(error.to_string().as_bytes()) },
        })
    }

    /// The next line that is not blank.
    fn next_line(&mut self) -> Option<&'a [u8]> {
        while !self.bytes.is_empty() {
            let is_end = |&byte: &u8| byte == b'\n' || byte == b'\r';
            let end = self.bytes.iter().position(is_end).unwrap_or(self.bytes.len());
            let (line, rest) = self.bytes.split_at(end);
            self.bytes = &rest[if rest.starts_with(b"\r\n") { 2 } else { rest.len().min(1) }..];
            self.line += 1;
            if !line.trim_ascii().is_empty() {
                return Some(line);
            }
        }
        None
    }

    /// Returns the place of the element that was read last.
    fn place(&self, def: &ElementDef, number: usize) -> Place {
        match self.encoding {
            Encoding::Ascii => Place::Line(self.line - 1),
            _ => Place::Element(quote(def.name.as_bytes()), number),
        }
    }

    /// The fewest bytes that a property takes.
    fn least_bytes(&self, property: &PropertyType) -> u64 {
        let (PropertyType::Scalar(first) | PropertyType::List(first, _)) = property;
        match first {
            // A digit and a separator.
            _ if self.encoding == Encoding::Ascii => 2,
            ScalarType::Char | ScalarType::UChar => 1,
            ScalarType::Short | ScalarType::UShort => 2,
            ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
            ScalarType::Double => 8,
        }
    }
}

#[cfg(test)]
mod tests;
