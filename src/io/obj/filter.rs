//! The filter in front of tobj: it reads every statement but for the digits of coordinates, which go to tobj.

use super::super::Limits;
use super::super::error::{Malformed, NoteKind, Notes, Place, ReadError};
use super::super::text::{is_blank, number, number_at, words};
use super::super::watch::Watch;
use super::coordinates::{Coordinates, Unread};
use super::corner::{self, Attribute, Corner, Index};
use super::statement::Statements;
use crate::{Group, PolygonSoup, Polygons};
use glam::DVec3;
use std::io::Write;

/// Reads a whole text: what it says, notes, and how many statements of a kind that occurs in OBJ files there were.
///
/// # Errors
/// What is wrong, and the line before which coordinates were passed on but perhaps not read yet.
pub(super) fn read(
    text: &[u8],
    limits: &Limits,
    watch: &mut Watch<'_, '_>,
) -> Result<(PolygonSoup, Notes, u64), (u64, ReadError)> {
    let mut filter =
        Filter { text, statements: Statements::new(text), limits: *limits, seen: Seen::default() };
    let mut line = 0;
    let result = loop {
        if let Err(error) = watch.tick(filter.statements.left()) {
            break Err(error.into());
        }
        let read = match filter.plain_statement() {
            Some((number, read)) => {
                line = number;
                read
            }
            None => {
                let Some((number, statement)) = filter.statements.next() else { break Ok(()) };
                line = number;
                filter.statement(line, &statement)
            }
        };
        if let Err(error) = read {
            break Err(error);
        }
    };
    match result {
        Ok(()) => filter.seen.finish(text).map_err(|error| (u64::MAX, error)),
        Err(error) => Err((line, error)),
    }
}

/// A reader of statements.
struct Filter<'a> {
    text: &'a [u8],
    statements: Statements<'a>,
    limits: Limits,
    seen: Seen,
}

/// What was read so far.
#[derive(Default)]
struct Seen {
    coordinates: Coordinates,
    polygons: Polygons,
    statements: u64,
    colors: Vec<[f32; 4]>,
    /// Vertices without a colour, and the line of the first.
    uncolored: usize,
    first_uncolored: u64,
    normals: Attribute<DVec3>,
    uvs: Attribute<[f64; 2]>,
    groups: Vec<Group>,
    material_files: Vec<String>,
    /// Bytes of names that were copied from one group to the next.
    inherited: usize,
    notes: Notes,
    /// Scratch: coordinates in a spelling of ours, and a face.
    spelled: Vec<u8>,
    face: Vec<u32>,
}

/// Corners of a face that is read in one look.
const FEW: usize = 4;

impl Filter<'_> {
    /// Reads a statement that is nothing but three coordinates or a few corners and ends its line, as nearly all are: one
    /// look at each byte. With its line; `None`, and nothing done, for all others.
    #[inline]
    fn plain_statement(&mut self) -> Option<(u64, Result<(), ReadError>)> {
        let rest = self.statements.rest()?;
        match rest {
            [b'v', b' ', coordinates @ ..] => {
                let end = plain_coordinates(coordinates)?;
                let bytes = 2 + end + end_of_line(&coordinates[end..])?;
                let line = self.statements.take_line(bytes);
                self.seen.statements += 1;
                Some((line, self.vertex(line, &rest[1..2 + end], &[])))
            }
            [b'f', b' ', ..] => {
                let mut corners = [Corner::NONE; FEW];
                let (mut at, mut count) = (2, 0);
                let end = loop {
                    while rest.get(at) == Some(&b' ') {
                        at += 1;
                    }
                    if let Some(end) = end_of_line(&rest[at..]) {
                        break at + end;
                    }
                    let corner = corner::read_plain(rest, &mut at)?;
                    *corners.get_mut(count)? = corner;
                    count += 1;
                };
                let line = self.statements.take_line(end);
                self.seen.statements += 1;
                Some((line, self.plain_face(line, &corners[..count])))
            }
            _ => None,
        }
    }

    fn plain_face(&mut self, line: u64, corners: &[Corner]) -> Result<(), ReadError> {
        let seen = &mut self.seen;
        let before = seen.polygons.corners().len();
        self.limits.check_faces(seen.polygons.len() as u64 + 1)?;
        self.limits.check_corners((before + corners.len()) as u64)?;
        for (corner, before) in corners.iter().zip(before..) {
            seen.take_attributes(corner, before, line);
        }
        let vertices = seen.coordinates.len();
        seen.take_face(corners.iter().map(|c| c.vertex_of(vertices)), line);
        Ok(())
    }

    fn statement(&mut self, line: u64, statement: &[u8]) -> Result<(), ReadError> {
        let start = statement.iter().position(|&b| !is_blank(b)).unwrap_or(statement.len());
        let length = statement[start..].iter().position(|&b| is_blank(b)).unwrap_or(statement.len() - start);
        let (keyword, rest) = statement[start..].split_at(length);
        let seen = &mut self.seen;
        seen.statements += 1;
        match keyword {
            b"v" => return self.odd_vertex(line, rest),
            b"f" | b"fo" => return self.face(line, rest),
            b"vt" => seen.uvs.values.push(numbers(line, rest)?),
            b"vn" => seen.normals.values.push(DVec3::from(numbers::<3>(line, rest)?)),
            b"o" | b"g" => {
                let name = seen.name(line, rest);
                let material = seen.groups.last().and_then(|g| g.material.clone());
                seen.inherited += material.as_ref().map_or(0, String::len);
                seen.start_group(Group { name, material, faces: 0..0 });
                return self.check_inherited();
            }
            b"usemtl" => {
                let material = Some(seen.name(line, rest)).filter(|m| !m.is_empty());
                let name = seen.groups.last().map(|g| g.name.clone()).unwrap_or_default();
                seen.inherited += name.len();
                seen.start_group(Group { name, material, faces: 0..0 });
                return self.check_inherited();
            }
            b"l" | b"p" => seen.notes.add(NoteKind::PointOrLine, Place::Line(line)),
            // Material files are not opened.
            b"mtllib" => {
                let name = seen.name(line, rest);
                if !name.is_empty() {
                    seen.material_files.push(name);
                }
            }
            // Smoothing groups say nothing that normals do not.
            b"s" | b"vp" => {}
            b"" => seen.statements -= 1,
            _ => {
                seen.statements -= 1;
                seen.notes.add(NoteKind::Ignored, Place::Line(line));
            }
        }
        Ok(())
    }

    /// Every group holds its name and its material, so a long name could be copied for each of many short statements:
    /// memory that grows with the square of the file.
    fn check_inherited(&self) -> Result<(), ReadError> {
        const ALWAYS: u64 = 1 << 20;
        let (wanted, allowed) = (self.seen.inherited as u64, ALWAYS + 16 * self.text.len() as u64);
        let what = "bytes of names that groups take over from the group before";
        if wanted > allowed { Err(ReadError::Limit { what, wanted, allowed }) } else { Ok(()) }
    }

    /// Takes a vertex: the text of its coordinates, and what follows them.
    fn vertex(&mut self, line: u64, coordinates: &[u8], rest: &[u8]) -> Result<(), ReadError> {
        let seen = &mut self.seen;
        let vertices = seen.coordinates.len();
        self.limits.check_vertices(vertices as u64 + 1)?;
        if rest.iter().any(|&b| !is_blank(b)) {
            seen.color(line, rest);
        }
        if seen.colors.len() <= vertices {
            seen.uncolored += 1;
            if seen.uncolored == 1 {
                seen.first_uncolored = line;
            }
        }
        seen.coordinates.push(coordinates).map_err(unread)
    }

    fn odd_vertex(&mut self, line: u64, rest: &[u8]) -> Result<(), ReadError> {
        if let Some(end) = plain_coordinates(rest) {
            return self.vertex(line, &rest[..end], &rest[end..]);
        }
        // Passed on in a spelling of ours.
        let mut spelled = std::mem::take(&mut self.seen.spelled);
        spelled.clear();
        let mut after = rest;
        for _ in 0..3 {
            let start = after.iter().position(|&b| !is_blank(b));
            let Some(start) = start else {
                return Err(ReadError::line(line, Malformed::Expected("three coordinates")));
            };
            let length = after[start..].iter().position(|&b| is_blank(b)).unwrap_or(after.len() - start);
            let (word, behind) = after[start..].split_at(length);
            let value = number_at(line, word)?;
            // Writing to a vector does not fail.
            let _ = write!(spelled, " {value}");
            after = behind;
        }
        let taken = self.vertex(line, &spelled, after);
        self.seen.spelled = spelled;
        taken
    }

    fn face(&mut self, line: u64, rest: &[u8]) -> Result<(), ReadError> {
        let seen = &mut self.seen;
        self.limits.check_faces(seen.polygons.len() as u64 + 1)?;
        let (vertices, before) = (seen.coordinates.len(), seen.polygons.corners().len());
        let mut face = std::mem::take(&mut seen.face);
        face.clear();
        let mut at = 0;
        loop {
            while rest.get(at).is_some_and(|&b| is_blank(b)) {
                at += 1;
            }
            if at == rest.len() {
                break;
            }
            let corner = corner::read(rest, &mut at, line)?;
            seen.take_attributes(&corner, before + face.len(), line);
            face.push(corner.vertex_of(vertices));
            self.limits.check_corners((before + face.len()) as u64)?;
        }
        seen.take_face(face.iter().copied(), line);
        seen.face = face;
        Ok(())
    }
}

fn unread(_: Unread) -> ReadError {
    // Which of them is found out where files are refused.
    ReadError::line(1, Malformed::Expected("three coordinates"))
}

/// How many bytes there are up to the beginning of the next line, if nothing but blanks is left of this one.
fn end_of_line(text: &[u8]) -> Option<usize> {
    let blanks = text.iter().position(|&b| b != b' ' && b != b'\t')?;
    match text[blanks..] {
        [b'\n', ..] => Some(blanks + 1),
        [b'\r', b'\n', ..] => Some(blanks + 2),
        _ => None,
    }
}

/// Where the third coordinate ends, if all three are made of what numbers are usually made of.
fn plain_coordinates(rest: &[u8]) -> Option<usize> {
    let mut at = 0;
    for _ in 0..3 {
        while matches!(rest.get(at), Some(b' ' | b'\t')) {
            at += 1;
        }
        let start = at;
        while matches!(rest.get(at), Some(b'0'..=b'9' | b'.' | b'-' | b'+' | b'e' | b'E')) {
            at += 1;
        }
        if at == start || rest.get(at).is_some_and(|&b| !is_blank(b)) {
            return None;
        }
    }
    Some(at)
}

/// The first numbers of a statement; zeros for those that are missing.
fn numbers<const N: usize>(line: u64, rest: &[u8]) -> Result<[f64; N], ReadError> {
    let mut values = [0.0; N];
    for (value, word) in values.iter_mut().zip(words(rest)) {
        *value = number_at(line, word)?;
    }
    Ok(values)
}

/// The line of the face that has the corner of this number. For a note: only files with something odd pay for it.
fn line_of_corner(text: &[u8], corner: usize) -> u64 {
    let mut before = 0;
    let mut faces = Statements::new(text).map(|(line, statement)| {
        let mut words = words(&statement);
        let is_face = matches!(words.next(), Some(b"f" | b"fo"));
        (line, if is_face { words.count() } else { 0 })
    });
    let found = faces.find(|(_, corners)| {
        before += corners;
        before > corner
    });
    found.map_or(1, |f| f.0)
}

impl Seen {
    fn take_face(&mut self, corners: impl ExactSizeIterator<Item = u32>, line: u64) {
        if corners.len() < 3 {
            self.notes.add(NoteKind::ShortFace, Place::Line(line));
        }
        self.polygons.push(corners);
    }

    /// Takes the texture coordinates and the normal of a corner, before which there are so many.
    fn take_attributes(&mut self, corner: &Corner, before: usize, line: u64) {
        let is_plain = corner.uv == Index::Missing && corner.normal == Index::Missing;
        if is_plain && !self.uvs.is_used() && !self.normals.is_used() {
            return;
        }
        let known = [self.uvs.refer(corner.uv, before), self.normals.refer(corner.normal, before)];
        for _ in known.iter().filter(|k| !**k) {
            self.notes.add(NoteKind::AttributeOutOfRange, Place::Line(line));
        }
    }

    fn finish(mut self, text: &[u8]) -> Result<(PolygonSoup, Notes, u64), ReadError> {
        let vertices = self.coordinates.len();
        let positions = std::mem::take(&mut self.coordinates).finish().map_err(unread)?;
        if !self.colors.is_empty() {
            self.colors.resize(vertices, [1.0; 4]);
            for _ in 0..self.uncolored {
                self.notes.add(NoteKind::MissingColor, Place::Line(self.first_uncolored));
            }
        }
        self.end_group();
        let line_of = |corner| line_of_corner(text, corner);
        // A face may name vertices that come after it.
        let mut odd = self.polygons.corners().iter().enumerate().filter(|c| *c.1 as usize >= vertices);
        if let Some((first, _)) = odd.next() {
            let place = Place::Line(line_of(first));
            (0..=odd.count()).for_each(|_| self.notes.add(NoteKind::IndexOutOfRange, place));
        }
        let soup = PolygonSoup {
            positions,
            vertex_colors: self.colors,
            corner_normals: self.normals.finish(&mut self.notes, line_of),
            corner_uvs: self.uvs.finish(&mut self.notes, line_of),
            polygons: self.polygons,
            groups: self.groups,
            material_files: self.material_files,
            ..PolygonSoup::default()
        };
        Ok((soup, self.notes, self.statements))
    }

    /// What follows the coordinates: a weight, which says nothing about a polygon mesh, or a colour.
    fn color(&mut self, line: u64, rest: &[u8]) {
        let mut color = [1.0; 4];
        let mut count = 0;
        for (c, word) in color.iter_mut().zip(words(rest)) {
            let Some(value) = number(word) else {
                return self.notes.add(NoteKind::Ignored, Place::Line(line));
            };
            *c = value as f32;
            count += 1;
        }
        if count >= 3 {
            self.colors.resize(self.coordinates.len(), [1.0; 4]);
            self.colors.push(color);
        }
    }

    fn name(&mut self, line: u64, rest: &[u8]) -> String {
        let name = String::from_utf8_lossy(rest);
        if matches!(name, std::borrow::Cow::Owned(_)) {
            self.notes.add(NoteKind::NotText, Place::Line(line));
        }
        name.trim_matches(|c: char| c.is_whitespace() || c == '\0').to_owned()
    }

    fn start_group(&mut self, new: Group) {
        self.end_group();
        let faces = self.polygons.len();
        self.groups.push(Group { faces: faces..faces, ..new });
    }

    /// A group without faces gives its place to the next; one without name and material says nothing.
    fn end_group(&mut self) {
        let faces = self.polygons.len();
        let says_nothing = |g: &Group| g.faces.is_empty() || (g.name.is_empty() && g.material.is_none());
        if let Some(last) = self.groups.last_mut() {
            last.faces.end = faces;
        }
        self.groups.pop_if(|g| says_nothing(g));
    }
}
