//! STL files, binary and text: triangles without shared vertices, in any units, often with z up.
//!
//! Each corner is written as often as triangles meet there, with the same digits, so corners at exactly the same place
//! become one vertex. Normals and the two free bytes of a triangle are not read: a triangle has its own normal by the order
//! of its corners, and many programs write `nan` or zeros.

use glam::DVec3;

use super::assembly::{Assembly, within_reach};
use super::error::{ImportError, Place, Problem, coordinate, quote};
use super::formats::MAX_PARTS;
use super::model_file::{Imported, ModelFile};
use crate::geometry::TriMesh;

/// A binary file begins with 80 free bytes and the number of triangles.
const HEADER: usize = 84;
/// A triangle of a binary file: its normal and three corners of three numbers of four bytes, and two free bytes.
const RECORD: usize = 50;

/// Whether the length is exactly that of a binary file with the number of triangles in its header. No text has it: four
/// letters in place of that number would mean gigabytes.
pub(super) fn is_binary_stl(bytes: &[u8]) -> bool {
    claimed_triangles(bytes).is_some_and(|count| bytes.len() as u64 == file_bytes(count))
}

/// The number of triangles that the header of a binary file gives.
fn claimed_triangles(bytes: &[u8]) -> Option<u32> {
    bytes.get(80..HEADER)?.try_into().ok().map(u32::from_le_bytes)
}

fn file_bytes(triangles: u32) -> u64 {
    HEADER as u64 + u64::from(triangles) * RECORD as u64
}

/// Reads a binary STL file.
pub(super) fn read_binary(file: ModelFile<'_>) -> Result<Imported, ImportError> {
    let bytes = file.bytes;
    let short = |what, needed| Problem::TooShort { what, needed, there: bytes.len() as u64 };
    let count = claimed_triangles(bytes).ok_or_else(|| {
        file.at(Place::Header, short("an STL header and its number of triangles".into(), HEADER as u64))
    })?;
    if file_bytes(count) > bytes.len() as u64 {
        return Err(file.at(Place::Header, short(format!("{count} triangles"), file_bytes(count))));
    }
    let (records, _) = bytes[HEADER..].as_chunks::<RECORD>();
    let mut corners = Corners::new(file);
    for (number, record) in (1..).zip(&records[..count as usize]) {
        file.report_progress(number, || number as f64 / f64::from(count))?;
        let (numbers, _) = record.as_chunks::<4>();
        let numbers = numbers.iter().map(|&number| f64::from(f32::from_le_bytes(number)));
        let mut numbers = numbers.skip(3);
        for _ in 0..3 {
            let [x, y, z] = [(); 3].map(|()| numbers.next().unwrap_or(f64::NAN));
            corners.push(within_reach(file, DVec3::new(x, y, z), || Place::Triangle(number))?)?;
        }
    }
    let rest = bytes.len() as u64 - file_bytes(count);
    let warning = (rest > 0).then(|| format!("bytes after the last triangle were left out: {rest}"));
    corners.finish(warning)
}

/// Reads an STL file that is a text; several solids become one mesh.
pub(super) fn read_text(file: ModelFile<'_>) -> Result<Imported, ImportError> {
    let bytes = file.bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(file.bytes);
    let mut words = Words { rest: bytes, line: 1, ended: false };
    let mut corners = Corners::new(file);
    let mut facets = 0;
    let read = read_solids(&mut words, &mut |corner, left| {
        facets += 1;
        file.report_progress(facets, || 1.0 - left as f64 / bytes.len() as f64)?;
        corners.push(corner)
    });
    match read {
        Ok(()) => {}
        Err(Stop::Problem(problem)) => return Err(file.at(Place::Line(words.line), problem)),
        Err(Stop::Error(error)) => return Err(error),
    }
    let warning = (!words.ended).then(|| "the file ends without `endsolid`: it may have been cut off".to_owned());
    corners.finish(warning)
}

/// Why reading a text ended early.
enum Stop {
    Problem(Problem),
    Error(ImportError),
}

impl From<Problem> for Stop {
    fn from(problem: Problem) -> Self {
        Self::Problem(problem)
    }
}

/// Passes on the corners of all facets, three for each, and the number of bytes that are left.
fn read_solids(
    words: &mut Words<'_>,
    take: &mut dyn FnMut(DVec3, usize) -> Result<(), ImportError>,
) -> Result<(), Stop> {
    while let Some(word) = words.next() {
        words.ended = false;
        if is_keyword(word, "solid") || is_keyword(word, "endsolid") {
            words.ended = is_keyword(word, "endsolid");
            words.skip_line();
        } else if is_keyword(word, "facet") {
            words.expect("normal", "`normal`")?;
            for _ in 0..3 {
                words.need("a normal of three numbers")?;
            }
            words.expect("outer", "`outer loop`")?;
            words.expect("loop", "`outer loop`")?;
            for _ in 0..3 {
                words.expect("vertex", "`vertex`, three times in a facet,")?;
                let mut place = [0.0; 3];
                for number in &mut place {
                    *number = coordinate(words.need("a coordinate")?)?;
                }
                take(DVec3::from_array(place), words.rest.len()).map_err(Stop::Error)?;
            }
            words.expect("endloop", "`endloop`")?;
            words.expect("endfacet", "`endfacet`")?;
        } else {
            return Err(Problem::Unexpected { found: quote(word), needed: "`facet`, `solid` or `endsolid`" }.into());
        }
    }
    Ok(())
}

fn is_keyword(word: &[u8], keyword: &str) -> bool {
    word.eq_ignore_ascii_case(keyword.as_bytes())
}

/// The words of a text, and the line that the last one is in.
struct Words<'a> {
    rest: &'a [u8],
    line: usize,
    /// The last solid has ended.
    ended: bool,
}

impl<'a> Words<'a> {
    fn next(&mut self) -> Option<&'a [u8]> {
        let start = self.rest.iter().position(|byte| !byte.is_ascii_whitespace()).unwrap_or(self.rest.len());
        self.line += line_ends(&self.rest[..start], self.rest.get(start));
        self.rest = &self.rest[start..];
        let end = self.rest.iter().position(u8::is_ascii_whitespace).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        (!word.is_empty()).then_some(word)
    }

    /// Returns the next word, which must be there.
    fn need(&mut self, what: &'static str) -> Result<&'a [u8], Problem> {
        self.next().ok_or(Problem::Ends(what))
    }

    /// Reads the next word, which must be `keyword`.
    fn expect(&mut self, keyword: &str, needed: &'static str) -> Result<(), Problem> {
        let word = self.need(needed)?;
        if is_keyword(word, keyword) { Ok(()) } else { Err(Problem::Unexpected { found: quote(word), needed }) }
    }

    /// Skips the rest of the line: the name of a solid is free.
    fn skip_line(&mut self) {
        let end = self.rest.iter().position(|byte| matches!(byte, b'\n' | b'\r')).unwrap_or(self.rest.len());
        self.rest = &self.rest[end..];
    }
}

/// Counts the lines that end within white space; a `\r` before a `\n` ends no line of its own.
fn line_ends(space: &[u8], after: Option<&u8>) -> usize {
    let next = space.iter().skip(1).chain(after);
    let lone = |(&byte, next): (&u8, &u8)| byte == b'\r' && *next != b'\n';
    space.split(|&byte| byte == b'\n').count() - 1 + space.iter().zip(next).filter(|&pair| lone(pair)).count()
}

/// The corners of triangles, three for each.
struct Corners<'a> {
    file: ModelFile<'a>,
    places: Vec<DVec3>,
}

impl<'a> Corners<'a> {
    fn new(file: ModelFile<'a>) -> Self {
        Self { file, places: Vec::new() }
    }

    fn push(&mut self, corner: DVec3) -> Result<(), ImportError> {
        if self.places.len() >= 3 * MAX_PARTS {
            return Err(ImportError::TooDetailed { file: self.file.name.to_owned() });
        }
        self.places.push(corner);
        Ok(())
    }

    /// Returns the mesh with one vertex at each place, numbered in the order of the corners.
    fn finish(self, warning: Option<String>) -> Result<Imported, ImportError> {
        let corners = TriMesh { positions: self.places, triangles: Vec::new() };
        // The first corner at a place never comes after the others there.
        let first_there = corners.weld();
        if self.file.watch.cancelled() {
            return Err(self.file.cancelled());
        }
        let mut assembly = Assembly::new(self.file);
        let mut numbers: Vec<u32> = Vec::with_capacity(first_there.len());
        for (corner, &first) in first_there.iter().enumerate() {
            let number = if first as usize == corner {
                assembly.vertex(corners.positions[corner])?;
                u32::try_from(assembly.vertices() - 1).unwrap_or(u32::MAX)
            } else {
                numbers[first as usize]
            };
            numbers.push(number);
        }
        let mut face = Vec::new();
        for triangle in numbers.chunks_exact(3) {
            face.clear();
            face.extend_from_slice(triangle);
            assembly.face(&mut face)?;
        }
        if let Some(warning) = warning {
            assembly.warn(warning);
        }
        assembly.finish()
    }
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;

    use super::*;
    use crate::geometry::import::parse;
    use crate::geometry::import::tests::{Never, refusal, tetrahedron};

    /// A mesh as a binary file whose header begins with a word.
    fn binary(mesh: &TriMesh, word: &[u8]) -> Vec<u8> {
        let mut bytes = vec![b' '; 80];
        bytes[..word.len()].copy_from_slice(word);
        bytes.extend(u32::try_from(mesh.triangles.len()).expect("few").to_le_bytes());
        for triangle in 0..mesh.triangles.len() {
            bytes.extend([0xff; 12]);
            for corner in mesh.corners(triangle) {
                bytes.extend(corner.as_vec3().to_array().iter().flat_map(|number| number.to_le_bytes()));
            }
            bytes.extend([7, 0]);
        }
        bytes
    }

    /// A mesh as a text, a solid for each triangle.
    fn text(mesh: &TriMesh) -> String {
        let mut text = String::new();
        for triangle in 0..mesh.triangles.len() {
            text += "solid a name\n facet normal nan 0 -0\n  outer loop\n";
            for DVec3 { x, y, z } in mesh.corners(triangle) {
                writeln!(text, "   vertex {x} {y:e} {z}").expect("a text grows");
            }
            text += "  endloop\n endfacet\nendsolid\n";
        }
        text
    }

    fn mesh(bytes: &[u8]) -> TriMesh {
        let imported = parse(bytes, "m.stl").expect("a good file");
        assert_eq!(imported.warnings, [""; 0], "nothing is left out");
        imported.mesh
    }

    #[test]
    fn binary_and_text_give_the_mesh_that_obj_gives() {
        let wanted = tetrahedron();
        assert!(wanted.facts().closed, "a closed one");
        assert_eq!(mesh(&binary(&wanted, b"made by hand")), wanted, "binary");
        assert_eq!(mesh(&binary(&wanted, b"solid but binary\n")), wanted, "binary, whatever it begins with");
        for name in ["m.obj", "m", "m.glb"] {
            assert_eq!(parse(&binary(&wanted, b"v "), name).expect("STL").mesh, wanted, "{name} is STL");
            assert_eq!(parse(text(&wanted).as_bytes(), name).expect("STL").mesh, wanted, "{name} is STL");
        }
        for ends in ["\n", "\r\n", "\r", " "] {
            let one = text(&wanted).replace("a name\n", "\n").replace('\n', ends);
            // The name of a solid takes its line, and so the rest of a file of one line.
            let one =
                if ends == " " { one.replace("solid  ", "solid\n").replace("endsolid ", "endsolid\n") } else { one };
            assert_eq!(mesh(one.as_bytes()), wanted, "{ends:?}");
        }
        assert_eq!(mesh(text(&wanted).to_uppercase().as_bytes()), wanted, "capitals");
    }

    #[test]
    fn corners_are_one_vertex_only_at_exactly_the_same_place() {
        let mut apart = tetrahedron();
        apart.positions.iter_mut().for_each(|place| *place = *place * 1e-3 + DVec3::splat(1e6));
        let read = mesh(text(&apart).as_bytes());
        assert_eq!(read, apart, "text keeps every digit");
        let off = text(&apart).replacen(&apart.positions[3].x.to_string(), "1000000.0000000001", 1);
        assert_eq!(mesh(off.as_bytes()).positions.len(), 5, "a digit that differs opens it");
        let zeros = text(&tetrahedron()).replacen(" 0 ", " -0 ", 1);
        assert!(mesh(zeros.as_bytes()).positions.len() == 4, "the two zeros are one place");
    }

    #[test]
    fn damaged_files_say_what_is_wrong_where() {
        let good = text(&tetrahedron());
        let binary = binary(&tetrahedron(), b"x");
        let said = |from: &str, to: &str| refusal(good.replacen(from, to, 1).as_bytes(), "m.stl");
        assert_eq!(
            said("facet", "face"),
            "m.stl, line 2: `face` stands where `facet`, `solid` or `endsolid` is needed"
        );
        assert_eq!(said("normal", "norm"), "m.stl, line 2: `norm` stands where `normal` is needed");
        let four = said("  endloop", "vertex 1 1 1\n endloop");
        assert_eq!(four, "m.stl, line 7: `vertex` stands where `endloop` is needed");
        assert_eq!(said(" endfacet", ""), "m.stl, line 9: `endsolid` stands where `endfacet` is needed");
        assert_eq!(
            said("vertex 0", "vertex nan"),
            "m.stl, line 4: the coordinate `nan` is out of reach; every coordinate must be a number from -1e50 to 1e50"
        );
        assert_eq!(
            said("vertex 0", "vertex 0,5"),
            "m.stl, line 4: `0,5` is not a number; a coordinate such as 0.5 is needed"
        );
        let cut = refusal(&good.as_bytes()[..60], "m.stl");
        assert!(cut.starts_with("m.stl, line 4: ") && cut.ends_with("it may have been cut off"), "{cut}");
        assert_eq!(refusal(b"solid a\nendsolid a\n", "m.stl"), "m.stl has no faces; a model with a surface is needed");
        let mut infinite = binary.clone();
        infinite[HEADER + RECORD + 16..][..4].copy_from_slice(&f32::INFINITY.to_le_bytes());
        assert_eq!(
            refusal(&infinite, "m.stl"),
            "m.stl, triangle 2: the coordinate `inf` is out of reach; every coordinate must be a number from -1e50 to 1e50"
        );
        let short = "need 284 bytes, but 283 are there; the file may have been cut off";
        assert_eq!(refusal(&binary[..283], "m.stl"), format!("m.stl, header: 4 triangles {short}"));
        let mut many = binary.clone();
        many[80..HEADER].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(
            refusal(&many, "m.stl").contains("4294967295 triangles need 214748364834 bytes"),
            "nothing is reserved"
        );
        assert!(refusal(&[0; 83], "m.stl").contains("an STL header"), "not even a header");
        let collapsed = TriMesh { positions: vec![DVec3::X; 3], triangles: vec![[0, 1, 2]] };
        assert!(refusal(text(&collapsed).as_bytes(), "m.stl").contains("no faces"), "a point");
    }

    #[test]
    fn what_is_left_out_is_said() {
        let mut long = binary(&tetrahedron(), b"x");
        long.extend([1, 2, 3]);
        let warned = |bytes: &[u8]| parse(bytes, "m.stl").expect("a good file").warnings;
        assert_eq!(warned(&long), ["bytes after the last triangle were left out: 3"]);
        let cut = text(&tetrahedron());
        let cut = cut.trim_end().trim_end_matches("endsolid");
        assert_eq!(warned(cut.as_bytes()), ["the file ends without `endsolid`: it may have been cut off"]);
        let mut flat = tetrahedron();
        flat.triangles.push([1, 1, 2]);
        let collapsed = warned(&binary(&flat, b"x"));
        assert_eq!(collapsed, ["faces with fewer than three different corners were left out: 1"]);
    }

    #[test]
    fn a_watcher_can_cancel() {
        let long = TriMesh { triangles: vec![[0, 1, 2]; 70_000], ..tetrahedron() };
        for bytes in [binary(&long, b"x"), text(&long).into_bytes()] {
            let read = if is_binary_stl(&bytes) { read_binary } else { read_text };
            let cancelled = read(ModelFile { watch: &Never, ..ModelFile::new(&bytes, "m.stl") });
            assert!(matches!(cancelled, Err(ImportError::Cancelled { .. })), "stopped on the way");
        }
    }
}
