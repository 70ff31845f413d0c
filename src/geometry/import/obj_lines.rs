//! The text of an OBJ file as the lines that matter here: checked, cleaned and counted, for tobj to parse.
//!
//! tobj names no line in its errors, takes `l` for a face, wants every texture coordinate in order and opens materials. So
//! it is given only vertices (three coordinates) and faces (position indices, counted from 1), each checked where it stands;
//! everything else that a surface does not need is left out. If a vertex of the file has a colour, all vertices get three
//! more numbers, -1 for those without one. Kept beside these lines are the smoothing of corners, by their normals (`vn`) or
//! the smoothing group (`s`) of the face; their texture coordinates (`vt`), if there may be pictures; and the names of faces
//! (`usemtl`, `g`, `o`): all of the line after the first word, with blanks and `#`.

use std::io::{self, BufRead, Read};

use super::assembly::set;
use super::error::{Problem, coordinate, quote};
use super::obj_coordinates::{Coordinates, CornerPlace};
use super::obj_libraries::add_library;
use super::smooth_groups::SmoothGroups;
use crate::geometry::Watch;
use crate::geometry::named_parts::{NameKind, Namer};
use crate::geometry::shading::SmoothGroup;

/// What was left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct LeftOut {
    /// Faces with fewer than three different corners.
    pub(super) small_faces: usize,
    /// `p` and `l` elements.
    pub(super) points_and_lines: usize,
    /// Curves and free-form surfaces.
    pub(super) curves: usize,
}

/// Reads the bytes of an OBJ file and passes them on as clean lines, one at a time.
pub(super) struct ObjLines<'a> {
    rest: &'a [u8],
    total_bytes: usize,
    total_vertices: u64,
    vertices: u64,
    /// Whether a vertex of the file has a colour.
    has_colors: bool,
    faces: usize,
    next_line: usize,
    /// The line being read, counted from 1; of a continued line the first.
    line: usize,
    clean: Vec<u8>,
    given: usize,
    left_out: LeftOut,
    namer: Namer,
    /// The label of every face passed on, once something has a name.
    labels: Vec<u16>,
    smooth_groups: SmoothGroups,
    /// The group of every normal that was read.
    normals: Vec<SmoothGroup>,
    smoothing: Smoothing,
    /// The number of corners of the faces passed on, and their groups, once one has any.
    corners: usize,
    corner_groups: Vec<SmoothGroup>,
    /// None if nothing can have a picture.
    coordinates: Option<Coordinates>,
    /// The material files that are named.
    libraries: Vec<String>,
    stop: Option<Stop>,
    watch: &'a dyn Watch,
}

/// The smoothing of faces whose corners have no normals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Smoothing {
    /// Nothing was said yet.
    Unsaid,
    /// Not at all.
    Off,
    /// With the faces of this group.
    Group(u64),
}

/// A corner of a face.
struct Corner {
    /// The index of its vertex, counted from 1.
    position: u64,
    /// The group of its normal, if that stands above the face.
    by_normal: SmoothGroup,
    /// Its texture coordinate.
    place: CornerPlace,
}

/// Why reading ended early.
#[derive(Debug)]
pub(super) enum Stop {
    Problem(Problem),
    Cancelled,
}

impl<'a> ObjLines<'a> {
    /// Prepares to read the bytes of a file. Texture coordinates are kept if they are wanted and a material file is named.
    pub(super) fn new(bytes: &'a [u8], wants_coordinates: bool, watch: &'a dyn Watch) -> Self {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let mut lines = Self {
            rest: bytes,
            total_bytes: bytes.len(),
            total_vertices: 0,
            vertices: 0,
            has_colors: false,
            faces: 0,
            next_line: 1,
            line: 0,
            clean: Vec::new(),
            given: 0,
            left_out: LeftOut::default(),
            namer: Namer::new(),
            labels: Vec::new(),
            smooth_groups: SmoothGroups::default(),
            normals: Vec::new(),
            smoothing: Smoothing::Unsaid,
            corners: 0,
            corner_groups: Vec::new(),
            coordinates: None,
            libraries: Vec::new(),
            stop: None,
            watch,
        };
        while let Some(line) = lines.take_line() {
            let mut words = words(&line);
            match words.next() {
                Some(b"v") => {
                    lines.total_vertices += 1;
                    lines.has_colors = lines.has_colors || color(words.skip(3)).is_some();
                }
                Some(b"mtllib") if wants_coordinates => lines.coordinates = Some(Coordinates::default()),
                _ => {}
            }
        }
        lines.rest = bytes;
        lines.next_line = 1;
        lines
    }

    pub(super) fn line(&self) -> usize {
        self.line
    }

    pub(super) fn faces(&self) -> usize {
        self.faces
    }

    /// The material files that it names, as the file has them, each once.
    pub(super) fn libraries(&self) -> &[String] {
        &self.libraries
    }

    pub(super) fn left_out(&self) -> LeftOut {
        self.left_out
    }

    /// Returns the names of the faces and the label of each; faces before the first name have none.
    pub(super) fn take_names(&mut self) -> (Namer, Vec<u16>) {
        (std::mem::replace(&mut self.namer, Namer::new()), std::mem::take(&mut self.labels))
    }

    /// Returns the groups of the corners of faces, in the order of the file; empty if no corner has one.
    pub(super) fn take_smooth_groups(&mut self) -> Vec<SmoothGroup> {
        std::mem::take(&mut self.corner_groups)
    }

    /// Returns the texture coordinates and those of the corners of faces; none if they were not kept.
    pub(super) fn take_coordinates(&mut self) -> Option<Coordinates> {
        self.coordinates.take()
    }

    pub(super) fn take_stop(&mut self) -> Option<Stop> {
        self.stop.take()
    }

    /// The next line of the file without its comment, joined with those it continues on.
    fn take_line(&mut self) -> Option<std::borrow::Cow<'a, [u8]>> {
        if self.rest.is_empty() {
            return None;
        }
        self.line = self.next_line;
        let (first, continued) = self.take_physical_line();
        if !continued {
            return Some(first.into());
        }
        let mut whole = first.to_vec();
        let mut more = true;
        while more && !self.rest.is_empty() {
            let (next, continued) = self.take_physical_line();
            whole.push(b' ');
            whole.extend_from_slice(next);
            more = continued;
        }
        Some(whole.into())
    }

    /// Takes one line as it stands, without comment, line end and continuation mark; returns whether it had such a mark.
    fn take_physical_line(&mut self) -> (&'a [u8], bool) {
        let is_end = |&byte: &u8| byte == b'\n' || byte == b'\r';
        let end = self.rest.iter().position(is_end).unwrap_or(self.rest.len());
        let (line, rest) = self.rest.split_at(end);
        let end_len = if rest.starts_with(b"\r\n") { 2 } else { rest.len().min(1) };
        self.rest = &rest[end_len..];
        self.next_line += 1;
        let is_name = || words(line).next().is_some_and(|word| name_of(word).is_some());
        let end = line.iter().position(|&byte| byte == b'#').filter(|_| !is_name()).unwrap_or(line.len());
        let code = &line[..end];
        let comment_follows = code.len() < line.len();
        match code.trim_ascii_end().strip_suffix(b"\\") {
            Some(continued) if !comment_follows => (continued, true),
            _ => (code, false),
        }
    }

    /// Fills `clean` with the next line that tobj should see; leaves it empty at the end of the file.
    fn advance(&mut self) -> Result<(), Stop> {
        self.clean.clear();
        self.given = 0;
        while self.clean.is_empty() {
            let Some(line) = self.take_line() else { return Ok(()) };
            if self.line.is_multiple_of(1 << 16) {
                self.watch.progress(1.0 - self.rest.len() as f64 / self.total_bytes as f64);
                if self.watch.cancelled() {
                    return Err(Stop::Cancelled);
                }
            }
            let mut words = words(&line);
            match words.next() {
                Some(b"v") => self.vertex(words),
                Some(b"vn") => {
                    self.normal(words);
                    Ok(())
                }
                Some(b"vt") => {
                    self.coordinates.iter_mut().for_each(|coordinates| coordinates.add(words.by_ref()));
                    Ok(())
                }
                Some(b"s") => {
                    self.smooth(words);
                    Ok(())
                }
                Some(b"f" | b"fo") => self.face(words),
                Some(b"p" | b"l") => {
                    self.left_out.points_and_lines += 1;
                    Ok(())
                }
                Some(b"curv" | b"curv2" | b"surf") => {
                    self.left_out.curves += 1;
                    Ok(())
                }
                Some(b"mtllib") => {
                    add_library(&mut self.libraries, &line);
                    Ok(())
                }
                Some(word) => {
                    self.set_name(word, &line);
                    Ok(())
                }
                None => Ok(()),
            }
            .map_err(Stop::Problem)?;
        }
        Ok(())
    }

    fn vertex<'w>(&mut self, mut words: impl Iterator<Item = &'w [u8]>) -> Result<(), Problem> {
        self.clean.push(b'v');
        for found in 0..3 {
            let word = words.next().ok_or(Problem::MissingCoordinate(found))?;
            coordinate(word)?;
            self.clean.push(b' ');
            self.clean.extend_from_slice(word);
        }
        if self.has_colors {
            for channel in color(words).unwrap_or([b"-1"; 3]) {
                self.clean.push(b' ');
                self.clean.extend_from_slice(channel);
            }
        }
        self.clean.push(b'\n');
        self.vertices += 1;
        Ok(())
    }

    fn face<'w>(&mut self, words: impl Iterator<Item = &'w [u8]>) -> Result<(), Problem> {
        let mut corners = words.map(|word| self.corner(word)).collect::<Result<Vec<_>, _>>()?;
        corners.dedup_by_key(|corner| corner.position);
        while corners.len() > 1 && corners[0].position == corners[corners.len() - 1].position {
            corners.pop();
        }
        if corners.len() < 3 {
            self.left_out.small_faces += 1;
            return Ok(());
        }
        set(&mut self.labels, self.faces, self.namer.label());
        self.faces += 1;
        self.clean.push(b'f');
        let by_face = match self.smoothing {
            Smoothing::Unsaid => None,
            Smoothing::Off => self.smooth_groups.alone(),
            Smoothing::Group(number) => self.smooth_groups.of_number(number),
        };
        for Corner { position, by_normal, place } in corners {
            set(&mut self.corner_groups, self.corners, by_normal.or(by_face));
            if let Some(coordinates) = &mut self.coordinates {
                set(&mut coordinates.of_corners, self.corners, place);
            }
            self.corners += 1;
            self.clean.extend_from_slice(format!(" {position}").as_bytes());
        }
        self.clean.push(b'\n');
        Ok(())
    }

    fn normal<'w>(&mut self, words: impl Iterator<Item = &'w [u8]>) {
        let mut parts = words.map(|word| coordinate(word).unwrap_or(f64::NAN));
        let normal = [0; 3].map(|_| parts.next().unwrap_or(f64::NAN));
        let group = self.smooth_groups.of_normal(normal);
        self.normals.push(group);
    }

    /// Takes note of a smoothing group, a number or `off`: it holds for the faces that follow.
    fn smooth<'w>(&mut self, mut words: impl Iterator<Item = &'w [u8]>) {
        let number = words.next().and_then(|word| std::str::from_utf8(word).ok()?.parse().ok());
        self.smoothing = number.filter(|&number| number > 0).map_or(Smoothing::Off, Smoothing::Group);
    }

    /// Takes note of a name: it holds for the faces that follow. A new object has no group yet.
    fn set_name(&mut self, word: &[u8], line: &[u8]) {
        let Some(kind) = name_of(word) else { return };
        let name = line.trim_ascii_start().get(word.len()..).unwrap_or_default();
        self.namer.set_name(kind, &String::from_utf8_lossy(name));
        if kind == NameKind::Object {
            self.namer.set_name(NameKind::Group, "");
        }
    }

    /// A face corner: `1`, `1/2`, `1//3`, `-4/…`.
    fn corner(&self, word: &[u8]) -> Result<Corner, Problem> {
        let parse = |part: &[u8]| std::str::from_utf8(part).ok().and_then(|text| text.parse::<i64>().ok());
        let bad = || Problem::BadIndex(quote(word));
        let mut parts = word.split(|&byte| byte == b'/');
        let index = parts.next().and_then(parse).ok_or_else(bad)?;
        let place = parts.clone().next().and_then(parse);
        let place = self.coordinates.as_ref().zip(place).and_then(|(coordinates, index)| coordinates.place(index));
        let normal = parts
            .clone()
            .nth(1)
            .and_then(parse)
            .and_then(|index| self.normals.get(place_of(index, self.normals.len())?));
        let rest_is_good = parts.clone().count() <= 2 && parts.all(|part| part.is_empty() || parse(part).is_some());
        if !rest_is_good {
            return Err(bad());
        }
        let found = match index {
            0 => return Err(Problem::ZeroIndex),
            1.. => u64::try_from(index).ok().filter(|&position| position <= self.total_vertices),
            _ => (self.vertices + 1).checked_sub(index.unsigned_abs()).filter(|&position| position > 0),
        };
        let vertices = if index < 0 { self.vertices } else { self.total_vertices };
        let position = found.ok_or(Problem::OutOfRange { index, vertices, so_far: index < 0 })?;
        Ok(Corner { position, by_normal: normal.copied().flatten(), place })
    }
}

impl Read for ObjLines<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let count = self.fill_buf()?.read(into)?;
        self.consume(count);
        Ok(count)
    }
}

impl BufRead for ObjLines<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.given == self.clean.len() {
            self.advance().map_err(|stop| {
                self.stop = Some(stop);
                io::Error::from(io::ErrorKind::InvalidData)
            })?;
        }
        Ok(&self.clean[self.given..])
    }

    fn consume(&mut self, count: usize) {
        self.given += count;
    }
}

/// Resolves an index of the file, counted from 1 or back from the last of `count`, to a place from 0.
fn place_of(index: i64, count: usize) -> Option<usize> {
    match index {
        0 => None,
        1.. => usize::try_from(index - 1).ok(),
        _ => count.checked_sub(usize::try_from(index.unsigned_abs()).ok()?),
    }
}

fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// Returns the colour after a vertex's coordinates: three numbers, which an opacity may follow.
fn color<'w>(mut words: impl Iterator<Item = &'w [u8]>) -> Option<[&'w [u8]; 3]> {
    let channels = [words.next()?, words.next()?, words.next()?];
    let is_channel = |word: &&[u8]| coordinate(word).is_ok_and(|channel| channel >= 0.0);
    (channels.iter().all(is_channel) && words.nth(1).is_none()).then_some(channels)
}

/// Returns the kind of name that a line with this first word gives.
fn name_of(word: &[u8]) -> Option<NameKind> {
    match word {
        b"usemtl" => Some(NameKind::Material),
        b"g" => Some(NameKind::Group),
        b"o" => Some(NameKind::Object),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clean(text: &str) -> (String, LeftOut) {
        let mut lines = ObjLines::new(text.as_bytes(), true, &());
        let mut all = String::new();
        lines.read_to_string(&mut all).expect("good lines");
        (all, lines.left_out())
    }

    fn problem(text: &str) -> (usize, Problem) {
        let mut lines = ObjLines::new(text.as_bytes(), true, &());
        lines.read_to_end(&mut Vec::new()).expect_err("a bad line");
        match lines.take_stop() {
            Some(Stop::Problem(problem)) => (lines.line(), problem),
            stop => panic!("a problem was expected, not {stop:?}"),
        }
    }

    #[test]
    fn only_vertices_and_faces_come_through() {
        let text = "mtllib gone.mtl\r\nv 0 0 0 1 0 0 # red\rv 1 0 0\nv 0 1\\\n 0\nvt 1\nusemtl\no a\ns off\nf 1/9 2//7 -1/2/3\n";
        let read = "v 0 0 0 1 0 0\nv 1 0 0 -1 -1 -1\nv 0 1 0 -1 -1 -1\nf 1 2 3\n";
        assert_eq!(clean(text).0, read, "three line ends, a comment, a continuation, a colour");
        assert!(clean(&text.replace(" 1 0 0 #", " 1 0 x #")).0.starts_with("v 0 0 0\nv 1"), "no colour");
    }

    #[test]
    fn small_faces_points_and_lines_are_counted_and_left_out() {
        let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\nf 1 1 2\nf 1 2 2 3 1\np 1\nl 1 2 3\nf 1 2 3\nsurf 0 1\n";
        let (all, left_out) = clean(text);
        assert!(all.ends_with("f 1 2 3\nf 1 2 3\n"), "a repeated corner is dropped, the face kept: {all}");
        assert_eq!(left_out, LeftOut { small_faces: 2, points_and_lines: 2, curves: 1 }, "two faces collapse");
    }

    #[test]
    fn a_face_may_name_vertices_that_follow_but_none_that_do_not_exist() {
        assert!(clean("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").0.starts_with("f 1 2 3"), "all three follow");
        let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
        let fails = |face: &str| problem(&format!("{vertices}{face}\nv 1 1 1\n"));
        assert_eq!(
            fails("f 1 2 5"),
            (4, Problem::OutOfRange { index: 5, vertices: 4, so_far: false }),
            "beyond the file"
        );
        assert_eq!(
            fails("f 1 2 -4"),
            (4, Problem::OutOfRange { index: -4, vertices: 3, so_far: true }),
            "before the file"
        );
        assert_eq!(fails("f 1 2 0"), (4, Problem::ZeroIndex), "OBJ counts from 1");
        assert_eq!(fails("f 1 2 x"), (4, Problem::BadIndex("x".into())), "no number");
        assert_eq!(fails("f 1 2 3/4/5/6"), (4, Problem::BadIndex("3/4/5/6".into())), "too many parts");
        assert_eq!(fails("f 1 2 3/a"), (4, Problem::BadIndex("3/a".into())), "a bad texture index");
        let min = format!("f 1 2 {}", i64::MIN);
        assert!(matches!(fails(&min).1, Problem::OutOfRange { .. }), "the lowest number has no magnitude");
    }

    #[test]
    fn a_bad_coordinate_is_named_with_its_line() {
        assert_eq!(problem("v 0 0 0\n\nv 1 nan 2\n"), (3, Problem::OutOfReach("nan".into())), "NaN");
        assert_eq!(problem("v 0 -inf 0"), (1, Problem::OutOfReach("-inf".into())), "infinite");
        assert_eq!(problem("v 0 1e400 0"), (1, Problem::OutOfReach("1e400".into())), "beyond a double");
        assert_eq!(problem("v 0 1e308 0"), (1, Problem::OutOfReach("1e308".into())), "its square would be infinite");
        assert_eq!(problem("v 0 0,5 0"), (1, Problem::BadNumber("0,5".into())), "a comma");
        assert_eq!(problem("v 0 \\\n 0 \\\n"), (1, Problem::MissingCoordinate(2)), "continued into the void");
    }
}
