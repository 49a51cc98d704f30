//! The filter in front of tobj: it reads every statement, keeps what tobj would lose, and passes on what tobj does well.

use super::super::Limits;
use super::super::error::{Malformed, NoteKind, Notes, Place, ReadError};
use super::super::text::{is_blank, number, number_at, words};
use super::super::watch::Watch;
use super::corner::{self, Attribute, Index};
use super::statement::Statements;
use crate::{CornerData, Group, PolygonSoup, Polygons};
use glam::DVec3;
use std::io::{BufRead, Read, Write};

/// tobj takes a polygon of fewer corners for a point or a line; so there are at least so many vertices in its text.
pub(super) const FEWEST: usize = 3;

/// What the filter kept.
pub(super) struct Kept {
    pub(super) vertices: usize,
    pub(super) faces: usize,
    pub(super) held: Held,
    pub(super) colors: Vec<[f32; 4]>,
    pub(super) corner_normals: Option<CornerData<DVec3>>,
    pub(super) corner_uvs: Option<CornerData<[f64; 2]>>,
    pub(super) groups: Vec<Group>,
    pub(super) material_files: Vec<String>,
    pub(super) notes: Notes,
    /// Statements of a kind that occurs in OBJ files.
    pub(super) statements: u64,
}

/// Faces that were not passed on: short ones, and those that name vertices which were not there yet.
#[derive(Default)]
pub(super) struct Held {
    /// Their numbers and lines.
    pub(super) faces: Vec<(usize, u64)>,
    pub(super) polygons: Polygons,
}

/// A reader of plain OBJ text over the file's text.
pub(super) struct Filter<'a, 'w, 'c> {
    watch: &'a mut Watch<'w, 'c>,
    text: &'a [u8],
    statements: Statements<'a>,
    limits: Limits,
    /// Plain text not yet read.
    plain: Vec<u8>,
    at: usize,
    is_ended: bool,
    error: Option<(u64, ReadError)>,
    seen: Seen,
}

/// What was read so far.
#[derive(Default)]
struct Seen {
    vertices: usize,
    faces: usize,
    corners: usize,
    statements: u64,
    held: Held,
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
    /// Scratch for one face.
    face: Vec<u32>,
}

impl<'a, 'w, 'c> Filter<'a, 'w, 'c> {
    pub(super) fn new(text: &'a [u8], limits: Limits, watch: &'a mut Watch<'w, 'c>) -> Self {
        Self {
            watch,
            text,
            statements: Statements::new(text),
            limits,
            plain: Vec::new(),
            at: 0,
            is_ended: false,
            error: None,
            seen: Seen::default(),
        }
    }

    /// What was kept, once tobj has read to the end.
    ///
    /// # Errors
    /// What was wrong with the file, with the line.
    pub(super) fn finish(self) -> Result<Kept, (u64, ReadError)> {
        if let Some(error) = self.error {
            return Err(error);
        }
        let text = self.text;
        let mut seen = self.seen;
        if !seen.colors.is_empty() {
            seen.colors.resize(seen.vertices, [1.0; 4]);
            for _ in 0..seen.uncolored {
                seen.notes.add(NoteKind::MissingColor, Place::Line(seen.first_uncolored));
            }
        }
        seen.end_group();
        for (face, (_, line)) in seen.held.polygons.iter().zip(&seen.held.faces) {
            for _ in face.iter().filter(|&&v| v as usize >= seen.vertices) {
                seen.notes.add(NoteKind::IndexOutOfRange, Place::Line(*line));
            }
        }
        let line_of = |corner| line_of_corner(text, corner);
        let corner_normals = seen.normals.finish(&mut seen.notes, line_of);
        let corner_uvs = seen.uvs.finish(&mut seen.notes, line_of);
        Ok(Kept {
            vertices: seen.vertices,
            faces: seen.faces,
            held: seen.held,
            colors: seen.colors,
            corner_normals,
            corner_uvs,
            groups: seen.groups,
            material_files: seen.material_files,
            notes: seen.notes,
            statements: seen.statements,
        })
    }

    /// Reads statements until there is plain text to pass on.
    fn fill(&mut self) {
        const ENOUGH: usize = 1 << 16;
        self.plain.clear();
        self.at = 0;
        while self.plain.len() < ENOUGH && !self.is_ended {
            let Some((line, statement)) = self.statements.next() else {
                self.is_ended = true;
                self.end();
                return;
            };
            let watched = self.watch.tick(self.statements.left()).map_err(ReadError::from);
            if let Err(error) = watched.and_then(|()| self.statement(line, &statement)) {
                self.error = Some((line, error));
                self.is_ended = true;
                self.plain.clear();
            }
        }
    }

    /// At the end: the polygon through all vertices in order, which says what number tobj gave to each.
    fn end(&mut self) {
        let vertices = self.seen.vertices;
        for _ in vertices..FEWEST {
            self.plain.extend_from_slice(b"v 0 0 0\n");
        }
        self.plain.push(b'f');
        for i in 1..=vertices.max(FEWEST) {
            push_integer(&mut self.plain, i as u32);
        }
        self.plain.push(b'\n');
    }

    fn statement(&mut self, line: u64, statement: &[u8]) -> Result<(), ReadError> {
        let start = statement.iter().position(|&b| !is_blank(b)).unwrap_or(statement.len());
        let length = statement[start..].iter().position(|&b| is_blank(b)).unwrap_or(statement.len() - start);
        let (keyword, rest) = statement[start..].split_at(length);
        let seen = &mut self.seen;
        seen.statements += 1;
        match keyword {
            b"v" => return self.vertex(line, rest),
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

    fn vertex(&mut self, line: u64, rest: &[u8]) -> Result<(), ReadError> {
        self.limits.check_vertices(self.seen.vertices as u64 + 1)?;
        self.plain.extend_from_slice(b"v");
        let rest = match plain_coordinates(rest) {
            // Most likely numbers: tobj finds out, and the line is looked for only if they are none.
            Some(end) => {
                self.plain.extend_from_slice(&rest[..end]);
                &rest[end..]
            }
            None => self.odd_coordinates(line, rest)?,
        };
        self.plain.push(b'\n');
        let seen = &mut self.seen;
        if rest.iter().any(|&b| !is_blank(b)) {
            seen.color(line, rest);
        }
        if seen.colors.len() <= seen.vertices {
            seen.uncolored += 1;
            if seen.uncolored == 1 {
                seen.first_uncolored = line;
            }
        }
        seen.vertices += 1;
        Ok(())
    }

    /// Passes on three coordinates in a spelling of ours, and returns what follows them.
    fn odd_coordinates<'s>(&mut self, line: u64, mut rest: &'s [u8]) -> Result<&'s [u8], ReadError> {
        for _ in 0..3 {
            let start = rest.iter().position(|&b| !is_blank(b));
            let Some(start) = start else {
                return Err(ReadError::line(line, Malformed::Expected("three coordinates")));
            };
            let length = rest[start..].iter().position(|&b| is_blank(b)).unwrap_or(rest.len() - start);
            let (word, after) = rest[start..].split_at(length);
            let value = number_at(line, word)?;
            // Writing to a vector does not fail.
            let _ = write!(self.plain, " {value}");
            rest = after;
        }
        Ok(rest)
    }

    fn face(&mut self, line: u64, rest: &[u8]) -> Result<(), ReadError> {
        let seen = &mut self.seen;
        let place = Place::Line(line);
        self.limits.check_faces(seen.faces as u64 + 1)?;
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
            face.push(corner.vertex.resolve(seen.vertices).unwrap_or(PolygonSoup::NO_VERTEX));
            if corner.uv != Index::Missing || corner.normal != Index::Missing || seen.has_attributes() {
                seen.refer(corner.uv, corner.normal, place);
            }
            seen.corners += 1;
            self.limits.check_corners(seen.corners as u64)?;
        }
        if face.len() < 3 {
            seen.notes.add(NoteKind::ShortFace, place);
        }
        if face.len() < 3 || face.iter().any(|&v| v as usize >= seen.vertices) {
            seen.held.faces.push((seen.faces, line));
            seen.held.polygons.push(face.iter().copied());
        } else {
            self.plain.push(b'f');
            if rest.iter().all(|b| b.is_ascii_digit() | (*b == b' ')) {
                self.plain.extend_from_slice(rest);
            } else {
                for &v in &face {
                    push_integer(&mut self.plain, v + 1);
                }
            }
            self.plain.push(b'\n');
        }
        seen.face = face;
        seen.faces += 1;
        Ok(())
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

/// Appends a space and a number.
fn push_integer(text: &mut Vec<u8>, mut n: u32) {
    let mut digits = [b' '; 11];
    let mut at = digits.len();
    loop {
        at -= 1;
        digits[at] = b'0' + (n % 10) as u8;
        n /= 10;
        if n == 0 {
            break;
        }
    }
    text.extend_from_slice(&digits[at - 1..]);
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
    fn has_attributes(&self) -> bool {
        self.uvs.is_used() || self.normals.is_used()
    }

    fn refer(&mut self, uv: Index, normal: Index, place: Place) {
        let known = [self.uvs.refer(uv, self.corners), self.normals.refer(normal, self.corners)];
        for _ in known.iter().filter(|k| !**k) {
            self.notes.add(NoteKind::AttributeOutOfRange, place);
        }
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
            self.colors.resize(self.vertices, [1.0; 4]);
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
        self.groups.push(Group { faces: self.faces..self.faces, ..new });
    }

    /// A group without faces gives its place to the next; one without name and material says nothing.
    fn end_group(&mut self) {
        let faces = self.faces;
        let says_nothing = |g: &Group| g.faces.is_empty() || (g.name.is_empty() && g.material.is_none());
        if let Some(last) = self.groups.last_mut() {
            last.faces.end = faces;
        }
        self.groups.pop_if(|g| says_nothing(g));
    }
}

impl Read for Filter<'_, '_, '_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let text = self.fill_buf()?;
        let count = text.len().min(buffer.len());
        buffer[..count].copy_from_slice(&text[..count]);
        self.consume(count);
        Ok(count)
    }
}

impl BufRead for Filter<'_, '_, '_> {
    fn fill_buf(&mut self) -> std::io::Result<&[u8]> {
        while self.at == self.plain.len() && !self.is_ended {
            self.fill();
        }
        Ok(&self.plain[self.at..])
    }

    fn consume(&mut self, count: usize) {
        self.at = (self.at + count).min(self.plain.len());
    }
}
