//! OFF: text in all its header variants (`OFF`, `COFF`, `NOFF`, `CNOFF`, `STOFF`, glued and one-line headers, missing edge
//! count), and `OFF BINARY`.

mod binary;
mod write;

pub use write::write_off;

use super::error::{Malformed, NoteKind, Notes, Place, ReadError};
use super::text::{
    Lines, before_comment, integer, is_blank, is_integer, number_at, shown, without_mark, words,
};
use super::watch::Watch;
use super::{Limits, Loaded};
use crate::{PolygonSoup, Polygons};
use glam::DVec3;

/// Reads an OFF file.
///
/// Vertex normals (`N`), colours (`C`) and texture coordinates (`ST`) are kept, face colours noted and left out. Data
/// after the promised faces is noted. O(bytes).
///
/// # Errors
/// [`ReadError`], with the line, or the byte of a binary file.
///
/// # Examples
/// ```
/// use meshwright::io::{Limits, read_off};
/// let loaded = read_off(b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", &Limits::default())?;
/// assert_eq!(&loaded.soup.polygons[0], &[0, 1, 2]);
/// # Ok::<(), meshwright::io::ReadError>(())
/// ```
pub fn read_off(bytes: &[u8], limits: &Limits) -> Result<Loaded, ReadError> {
    super::read(bytes, super::Format::Off, limits)
}

pub(super) fn read(bytes: &[u8], limits: &Limits, watch: &mut Watch<'_, '_>) -> Result<Loaded, ReadError> {
    let text = without_mark(bytes)?;
    let mut file = Words::new(text);
    let header = Header::read(&mut file)?;
    if header.binary {
        return binary::read(bytes, limits, watch);
    }
    let mut notes = Notes::default();
    let (_, vertices) = file.count("the number of vertices")?;
    let (_, faces) = file.count("the number of faces")?;
    // The number of edges may be missing, and means nothing.
    if file.line_has_more() {
        file.skip_line();
    }
    // Every number takes two bytes at least; nothing is reserved for more.
    for (what, wanted, each) in [("vertices", vertices, 3), ("faces", faces, 1)] {
        let room = text.len() as u64 / 2 / each;
        if wanted > room {
            return Err(ReadError::line(file.line, Malformed::Promise { what, wanted, room }));
        }
    }
    limits.check_vertices(vertices)?;
    limits.check_faces(faces)?;
    let (vertices, faces) = (vertices as usize, faces as usize);

    let mut soup = PolygonSoup::default();
    let mut uvs = Vec::new();
    soup.positions.reserve(vertices);
    for _ in 0..vertices {
        watch.tick(file.lines.left())?;
        let (line, p) = file.vector("a vertex")?;
        if !p.is_finite() {
            notes.add(NoteKind::NonFiniteCoordinate, Place::Line(line));
        }
        soup.positions.push(p);
        if header.normals {
            soup.vertex_normals.push(file.vector("a vertex normal")?.1);
        }
        let mut given = file.rest_of_line();
        let count = given.clone().count();
        let after_color = if header.uvs { 2 } else { 0 };
        if header.colors {
            let components = count.saturating_sub(after_color);
            soup.vertex_colors.push(color(given.by_ref().take(components), line)?);
        }
        if header.uvs {
            let mut uv = [0.0; 2];
            for part in &mut uv {
                let word =
                    given.next().ok_or(ReadError::line(line, Malformed::Expected("texture coordinates")))?;
                *part = number_at(line, word)?;
            }
            uvs.push(uv);
        }
        if given.next().is_some() {
            notes.add(NoteKind::Ignored, Place::Line(line));
        }
    }
    soup.polygons = Polygons::with_capacity(faces, (3 * faces).min(text.len() / 2));
    let mut corners = Vec::new();
    for _ in 0..faces {
        watch.tick(file.lines.left())?;
        corners.clear();
        read_face(&mut file, vertices, &mut corners, &mut notes)?;
        limits.check_corners((soup.polygons.corners().len() + corners.len()) as u64)?;
        soup.polygons.push(corners.iter().copied());
    }
    if let Some((line, _)) = file.next() {
        notes.add(NoteKind::TrailingData, Place::Line(line));
    }
    if header.uvs {
        soup.corner_uvs = Some(super::uvs_of_vertices(&soup.polygons, uvs));
    }
    Ok(Loaded { soup, notes: notes.finish() })
}

/// Reads one face. It may run over lines, but then nothing follows it on its last one: most likely the line was too
/// short, and the next face would be taken for the rest of it.
fn read_face(
    file: &mut Words<'_>,
    vertices: usize,
    corners: &mut Vec<u32>,
    notes: &mut Notes,
) -> Result<(), ReadError> {
    let (first, degree) = file.count("the number of corners of a face")?;
    let place = Place::Line(first);
    for _ in 0..degree {
        let Some((line, word)) = file.next() else {
            return Err(ReadError::line(first, Malformed::Truncated("a face")));
        };
        if !is_integer(word) {
            return Err(ReadError::line(line, Malformed::Number(shown(word))));
        }
        let index = integer(word).and_then(|i| u32::try_from(i).ok()).unwrap_or(PolygonSoup::NO_VERTEX);
        if index as usize >= vertices {
            notes.add(NoteKind::IndexOutOfRange, place);
        }
        corners.push(index);
    }
    if degree < 3 {
        notes.add(NoteKind::ShortFace, place);
    }
    if file.line_has_more() {
        if file.line > first {
            return Err(ReadError::line(
                first,
                Malformed::Expected("as many indices as the face has corners"),
            ));
        }
        file.skip_line();
        notes.add(NoteKind::FaceColor, place);
    }
    Ok(())
}

/// Three or four components, whole numbers in 0..=255 or fractions in 0..=1.
fn color<'a>(given: impl Iterator<Item = &'a [u8]>, line: u64) -> Result<[f32; 4], ReadError> {
    let mut color = [1.0; 4];
    let mut count = 0;
    let mut is_whole = true;
    for (c, word) in color.iter_mut().zip(given) {
        *c = number_at(line, word)?;
        is_whole &= is_integer(word);
        count += 1;
    }
    if count < 3 {
        return Err(ReadError::line(line, Malformed::Expected("a vertex colour")));
    }
    let full = if is_whole { 255.0 } else { 1.0 };
    // An alpha that is not given is full.
    color.iter_mut().take(count).for_each(|c| *c /= full);
    Ok(color.map(|c: f64| c as f32))
}

/// The words of all lines, comments left out, with their lines.
struct Words<'a> {
    lines: Lines<'a>,
    /// The current line, and what is left of it.
    content: &'a [u8],
    rest: &'a [u8],
    line: u64,
}

impl<'a> Words<'a> {
    fn new(text: &'a [u8]) -> Self {
        Self { lines: Lines::new(text), content: &[], rest: &[], line: 1 }
    }

    fn next(&mut self) -> Option<(u64, &'a [u8])> {
        while !self.line_has_more() {
            let (number, line) = self.lines.next()?;
            self.line = number;
            self.content = before_comment(line);
            self.rest = self.content;
        }
        let end = self.rest.iter().position(|&b| is_blank(b)).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        Some((self.line, word))
    }

    fn expect(&mut self, what: &'static str) -> Result<(u64, &'a [u8]), ReadError> {
        self.next().ok_or(ReadError::line(self.line, Malformed::Truncated(what)))
    }

    fn count(&mut self, what: &'static str) -> Result<(u64, u64), ReadError> {
        let (line, word) = self.expect(what)?;
        let count = integer(word).and_then(|n| u64::try_from(n).ok());
        Ok((line, count.ok_or(ReadError::line(line, Malformed::Expected(what)))?))
    }

    fn vector(&mut self, what: &'static str) -> Result<(u64, DVec3), ReadError> {
        let mut p = DVec3::ZERO;
        for i in 0..3 {
            let (line, word) = self.expect(what)?;
            p[i] = number_at(line, word)?;
        }
        Ok((self.line, p))
    }

    /// Makes a word, or the end of it, the next again.
    fn put_back(&mut self, word: &[u8]) {
        let end = self.content.len() - self.rest.len();
        self.rest = &self.content[end.saturating_sub(word.len())..];
    }

    /// Whether there is a word left on this line; moves to it.
    fn line_has_more(&mut self) -> bool {
        let blank = self.rest.iter().position(|&b| !is_blank(b)).unwrap_or(self.rest.len());
        self.rest = &self.rest[blank..];
        !self.rest.is_empty()
    }

    fn skip_line(&mut self) {
        self.rest = &[];
    }

    fn rest_of_line(&mut self) -> impl Iterator<Item = &'a [u8]> + Clone {
        words(std::mem::take(&mut self.rest))
    }
}

#[derive(Clone, Copy, Debug)]
struct Header {
    uvs: bool,
    colors: bool,
    normals: bool,
    binary: bool,
}

impl Header {
    /// `[ST][C][N]OFF`, perhaps with `BINARY` or the counts behind it, even glued. Without a keyword a file may begin
    /// with its counts.
    fn read(file: &mut Words<'_>) -> Result<Self, ReadError> {
        let (line, word) = file.next().ok_or(ReadError::line(1, Malformed::Empty))?;
        let bad = || ReadError::line(line, Malformed::Beginning("an OFF file"));
        let mut header = Self { uvs: false, colors: false, normals: false, binary: false };
        let Some(end) = word.windows(3).position(|w| w == b"OFF") else {
            if !is_integer(word) {
                return Err(bad());
            }
            file.put_back(word);
            return Ok(header);
        };
        let mut prefix = &word[..end];
        for (letters, has) in
            [(&b"ST"[..], &mut header.uvs), (b"C", &mut header.colors), (b"N", &mut header.normals)]
        {
            if let Some(rest) = prefix.strip_prefix(letters) {
                (prefix, *has) = (rest, true);
            }
        }
        let unsupported = |what| Err(ReadError::Unsupported { place: Place::Line(line), what });
        let glued = &word[end + 3..];
        match prefix {
            b"" if glued.is_empty() => {}
            b"" if is_integer(glued) => file.put_back(glued),
            b"4" | b"n" | b"4n" => return unsupported("OFF in other than three dimensions"),
            _ => return Err(bad()),
        }
        header.binary = words(file.rest).next() == Some(b"BINARY");
        if header.binary && (header.uvs || header.colors || header.normals) {
            return unsupported("OFF BINARY with data beyond positions");
        }
        Ok(header)
    }
}
