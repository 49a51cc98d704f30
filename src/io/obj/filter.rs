//! The filter in front of tobj: it reads every statement, keeps what tobj would lose, and passes on what tobj does well.

use super::super::Limits;
use super::super::error::{Malformed, NoteKind, Notes, Place, ReadError};
use super::super::text::{Lines, before_comment, integer, is_integer, number, number_at, shown, words};
use crate::{CornerData, Group, PolygonSoup};
use glam::DVec3;
use std::borrow::Cow;
use std::io::{BufRead, Read, Write};

/// tobj takes a polygon of fewer corners for a point or a line; so there are at least so many vertices in its text.
pub(super) const FEWEST: usize = 3;

/// Statements with the number of their first line: comments taken out, lines joined that end in a backslash.
pub(super) fn statements(text: &[u8]) -> impl Iterator<Item = (u64, Cow<'_, [u8]>)> {
    let mut lines = Lines::new(text);
    std::iter::from_fn(move || {
        let (number, line) = lines.next()?;
        let first = before_comment(line);
        if !first.ends_with(b"\\") {
            return Some((number, Cow::Borrowed(first)));
        }
        let mut joined = first[..first.len() - 1].to_vec();
        for (_, line) in lines.by_ref() {
            let line = before_comment(line);
            let (part, more) = line.strip_suffix(b"\\").map_or((line, false), |l| (l, true));
            joined.push(b' ');
            joined.extend_from_slice(part);
            if !more {
                break;
            }
        }
        Some((number, Cow::Owned(joined)))
    })
}

/// What a first look counts.
#[derive(Clone, Copy, Default)]
pub(super) struct Counts {
    pub(super) vertices: u64,
    pub(super) faces: u64,
    /// Statements of a kind that occurs in OBJ files.
    pub(super) statements: u64,
}

impl Counts {
    pub(super) fn of(text: &[u8]) -> Self {
        let mut counts = Self::default();
        for (_, statement) in statements(text) {
            match words(&statement).next() {
                Some(b"v") => counts.vertices += 1,
                Some(b"f" | b"fo") => counts.faces += 1,
                Some(b"vt" | b"vn" | b"vp" | b"o" | b"g" | b"s" | b"usemtl" | b"mtllib" | b"l" | b"p") => {}
                _ => continue,
            }
            counts.statements += 1;
        }
        counts
    }
}

/// What the filter kept.
pub(super) struct Kept {
    pub(super) vertices: usize,
    pub(super) faces: usize,
    /// Faces that were not passed on, by their number.
    pub(super) odd: Vec<(usize, Vec<u32>)>,
    pub(super) colors: Vec<[f32; 4]>,
    pub(super) corner_normals: Option<CornerData<DVec3>>,
    pub(super) corner_uvs: Option<CornerData<[f64; 2]>>,
    pub(super) groups: Vec<Group>,
    pub(super) notes: Notes,
}

/// A reader of plain OBJ text over the file's text.
pub(super) struct Filter<'a> {
    statements: Box<dyn Iterator<Item = (u64, Cow<'a, [u8]>)> + 'a>,
    counts: Counts,
    limits: Limits,
    /// Plain text not yet read.
    plain: Vec<u8>,
    at: usize,
    /// Faces are passed on after all vertices and the polygon through them, so they wait here.
    faces: Vec<u8>,
    is_ended: bool,
    error: Option<ReadError>,
    seen: Seen,
}

/// What was read so far.
#[derive(Default)]
struct Seen {
    vertices: usize,
    faces: usize,
    corners: u64,
    odd: Vec<(usize, Vec<u32>)>,
    colors: Vec<[f32; 4]>,
    normals: Attribute<DVec3>,
    uvs: Attribute<[f64; 2]>,
    groups: Vec<Group>,
    notes: Notes,
    /// Scratch for one face.
    corner: Vec<u32>,
}

/// Values that corners refer to.
#[derive(Default)]
struct Attribute<T> {
    values: Vec<T>,
    /// One per corner from the first corner that has a value; shorter until then.
    indices: Vec<u32>,
    is_used: bool,
}

impl<T> Attribute<T> {
    /// Notes the value of the next corner, and answers whether there is one if there should be.
    fn refer(&mut self, word: Option<&[u8]>, corners_before: u64) -> bool {
        let Some(word) = word.filter(|w| !w.is_empty()) else {
            if self.is_used {
                self.indices.push(CornerData::<T>::NONE);
            }
            return true;
        };
        if !self.is_used {
            self.is_used = true;
            self.indices.resize(corners_before as usize, CornerData::<T>::NONE);
        }
        // Values may come after the faces that use them; whether they do is seen at the end.
        let index = resolve(word, self.values.len()).unwrap_or(CornerData::<T>::NONE);
        self.indices.push(index);
        index != CornerData::<T>::NONE
    }

    fn finish(mut self, notes: &mut Notes) -> Option<CornerData<T>> {
        let count = self.values.len() as u32;
        for i in self.indices.iter_mut().filter(|i| **i != CornerData::<T>::NONE && **i >= count) {
            *i = CornerData::<T>::NONE;
            notes.add(NoteKind::AttributeOutOfRange, Place::Line(1));
        }
        let any = self.indices.iter().any(|&i| i != CornerData::<T>::NONE);
        any.then_some(CornerData { values: self.values, indices: self.indices })
    }
}

/// An index from 1, or from the end of what was read so far if negative, as an index from 0.
fn resolve(word: &[u8], so_far: usize) -> Option<u32> {
    let i = integer(word)?;
    let from_zero = if i < 0 { i.checked_add(so_far as i64)? } else { i - 1 };
    u32::try_from(from_zero).ok()
}

impl<'a> Filter<'a> {
    pub(super) fn new(text: &'a [u8], counts: Counts, limits: Limits) -> Self {
        Self {
            statements: Box::new(statements(text)),
            counts,
            limits,
            plain: Vec::new(),
            at: 0,
            faces: Vec::new(),
            is_ended: false,
            error: None,
            seen: Seen::default(),
        }
    }

    /// What was kept, once tobj has read to the end.
    ///
    /// # Errors
    /// What was wrong with the file.
    pub(super) fn finish(mut self) -> Result<Kept, ReadError> {
        if let Some(error) = self.error.take() {
            return Err(error);
        }
        let Seen { vertices, faces, odd, mut colors, normals, uvs, mut groups, mut notes, .. } = self.seen;
        if !colors.is_empty() && colors.len() < vertices {
            colors.resize(vertices, [1.0; 4]);
            notes.add(NoteKind::MissingColor, Place::Line(1));
        }
        if let Some(last) = groups.last_mut() {
            last.faces.end = faces;
        }
        groups.retain(|g| !g.faces.is_empty());
        let corner_normals = normals.finish(&mut notes);
        let corner_uvs = uvs.finish(&mut notes);
        Ok(Kept { vertices, faces, odd, colors, corner_normals, corner_uvs, groups, notes })
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
            if let Err(error) = self.statement(line, &statement) {
                self.error = Some(error);
                self.is_ended = true;
                self.plain.clear();
            }
        }
    }

    /// After all vertices: the polygon through them, then the faces.
    fn end(&mut self) {
        let vertices = self.seen.vertices;
        for _ in vertices..FEWEST {
            self.plain.extend_from_slice(b"v 0 0 0\n");
        }
        self.plain.push(b'f');
        for i in 1..=vertices.max(FEWEST) {
            // Writing to a vector does not fail.
            let _ = write!(self.plain, " {i}");
        }
        self.plain.push(b'\n');
        self.plain.append(&mut self.faces);
    }

    fn statement(&mut self, line: u64, statement: &[u8]) -> Result<(), ReadError> {
        let place = Place::Line(line);
        let mut words = words(statement);
        let seen = &mut self.seen;
        match words.next() {
            Some(b"v") => return self.vertex(line, words),
            Some(b"f" | b"fo") => return self.face(line, words),
            Some(b"vt") => {
                let mut values = words.take(2).map(|w| number_at(line, w));
                let u = values.next().unwrap_or(Ok(0.0))?;
                seen.uvs.values.push([u, values.next().unwrap_or(Ok(0.0))?]);
            }
            Some(b"vn") => {
                let mut normal = DVec3::ZERO;
                for (i, w) in words.take(3).enumerate() {
                    normal[i] = number_at(line, w)?;
                }
                seen.normals.values.push(normal);
            }
            Some(keyword @ (b"o" | b"g" | b"usemtl")) => {
                let name = rest_of(statement, keyword);
                let old = seen.groups.last().cloned().unwrap_or_default();
                let new = if keyword == b"usemtl" {
                    Group { material: Some(name), name: old.name, faces: 0..0 }
                } else {
                    Group { name, material: old.material, faces: 0..0 }
                };
                seen.start_group(new);
            }
            Some(b"l" | b"p") => seen.notes.add(NoteKind::PointOrLine, place),
            // Material files are not opened; smoothing groups say nothing that normals do not.
            Some(b"mtllib" | b"s") | None => {}
            Some(_) => seen.notes.add(NoteKind::Ignored, place),
        }
        Ok(())
    }

    fn vertex<'w>(
        &mut self,
        line: u64,
        words: impl Iterator<Item = &'w [u8]> + Clone,
    ) -> Result<(), ReadError> {
        self.plain.push(b'v');
        for word in words.clone().take(3) {
            self.plain.push(b' ');
            if word.iter().all(|b| matches!(b, b'0'..=b'9' | b'.' | b'-' | b'+' | b'e' | b'E')) {
                // Most likely a number: tobj finds out, and the line is looked for only if it is none.
                self.plain.extend_from_slice(word);
                continue;
            }
            let value = number_at(line, word)?;
            let _ = write!(self.plain, "{value}");
        }
        self.plain.push(b'\n');
        let mut rest = words.skip(2);
        if rest.next().is_none() {
            return Err(ReadError::line(line, Malformed::Expected("three coordinates")));
        }
        let rest: Vec<&[u8]> = rest.take(4).collect();
        // A fourth number alone is a weight, which says nothing about a polygon mesh.
        if rest.len() >= 3 {
            let mut color = [1.0; 4];
            for (c, word) in color.iter_mut().zip(&rest) {
                *c = number(word).unwrap_or(1.0) as f32;
            }
            if self.seen.colors.len() < self.seen.vertices {
                self.seen.notes.add(NoteKind::MissingColor, Place::Line(line));
            }
            self.seen.colors.resize(self.seen.vertices, [1.0; 4]);
            self.seen.colors.push(color);
        }
        self.seen.vertices += 1;
        Ok(())
    }

    fn face<'w>(&mut self, line: u64, words: impl Iterator<Item = &'w [u8]>) -> Result<(), ReadError> {
        let seen = &mut self.seen;
        let place = Place::Line(line);
        let total = self.counts.vertices;
        let before = seen.corners;
        let mut corners = std::mem::take(&mut seen.corner);
        corners.clear();
        let mut is_odd = false;
        for word in words {
            let mut parts = word.split(|&b| b == b'/');
            let vertex = parts.next().unwrap_or_default();
            if !is_integer(vertex) {
                return Err(ReadError::line(line, Malformed::Number(shown(word))));
            }
            let index = resolve(vertex, seen.vertices).unwrap_or(PolygonSoup::NO_VERTEX);
            if u64::from(index) >= total {
                is_odd = true;
                seen.notes.add(NoteKind::IndexOutOfRange, place);
            }
            let at = before + corners.len() as u64;
            let (uv, normal) = (parts.next(), parts.next());
            let both = [seen.uvs.refer(uv, at), seen.normals.refer(normal, at)];
            if both != [true; 2] {
                seen.notes.add(NoteKind::AttributeOutOfRange, place);
            }
            corners.push(index);
        }
        seen.corners += corners.len() as u64;
        self.limits.check_corners(seen.corners)?;
        if corners.len() < 3 {
            is_odd = true;
            seen.notes.add(NoteKind::ShortFace, place);
        }
        if is_odd {
            seen.odd.push((seen.faces, corners.clone()));
        } else {
            self.faces.push(b'f');
            for &v in &corners {
                push_integer(&mut self.faces, v + 1);
            }
            self.faces.push(b'\n');
        }
        seen.corner = corners;
        seen.faces += 1;
        Ok(())
    }
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

impl Seen {
    fn start_group(&mut self, mut new: Group) {
        let faces = self.faces;
        if let Some(last) = self.groups.last_mut() {
            last.faces.end = faces;
            // A group without faces gives its place to the next.
            if last.faces.is_empty() {
                self.groups.pop();
            }
        }
        new.faces = faces..faces;
        self.groups.push(new);
    }
}

fn rest_of(statement: &[u8], keyword: &[u8]) -> String {
    let start = statement.windows(keyword.len()).position(|w| w == keyword).unwrap_or(0) + keyword.len();
    String::from_utf8_lossy(statement.get(start..).unwrap_or_default()).trim().to_owned()
}

impl Read for Filter<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let text = self.fill_buf()?;
        let count = text.len().min(buffer.len());
        buffer[..count].copy_from_slice(&text[..count]);
        self.consume(count);
        Ok(count)
    }
}

impl BufRead for Filter<'_> {
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
