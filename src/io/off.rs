//! OFF: text in all its header variants (`OFF`, `COFF`, `NOFF`, `CNOFF`, `STOFF`, glued and one-line headers, missing edge
//! count), and `OFF BINARY`.

use super::error::{Malformed, NoteKind, Notes, Place, ReadError, WriteError};
use super::text::{
    Lines, Number, before_comment, integer, is_integer, number_at, shown, without_mark, words,
};
use super::{Limits, Loaded, Lost, check_writable};
use crate::{PolygonSoup, Polygons};
use glam::DVec3;
use std::io::Write;

/// Reads an OFF file.
///
/// Vertex normals (`N`) and colours (`C`) are kept, texture coordinates and face colours noted and left out. Data after
/// the promised faces is noted. O(bytes).
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
    let text = without_mark(bytes)?;
    let mut file = Words::new(text);
    let header = Header::read(&mut file)?;
    if header.binary {
        return read_binary(bytes, limits);
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
    soup.positions.reserve(vertices);
    for _ in 0..vertices {
        let (line, p) = file.vector("a vertex")?;
        if !p.is_finite() {
            notes.add(NoteKind::NonFiniteCoordinate, Place::Line(line));
        }
        soup.positions.push(p);
        if header.normals {
            soup.vertex_normals.push(file.vector("a vertex normal")?.1);
        }
        if header.colors {
            let given = file.rest_of_line();
            soup.vertex_colors.push(color(&given, line)?);
        } else if file.line_has_more() {
            file.skip_line();
            notes.add(NoteKind::Ignored, Place::Line(line));
        }
    }
    soup.polygons = Polygons::with_capacity(faces, 3 * faces);
    for _ in 0..faces {
        read_face(&mut file, vertices, limits, &mut soup.polygons, &mut notes)?;
    }
    if let Some((line, _)) = file.next() {
        notes.add(NoteKind::TrailingData, Place::Line(line));
    }
    Ok(Loaded { soup, notes: notes.finish() })
}

fn read_face(
    file: &mut Words<'_>,
    vertices: usize,
    limits: &Limits,
    polygons: &mut Polygons,
    notes: &mut Notes,
) -> Result<(), ReadError> {
    let (line, degree) = file.count("the number of corners of a face")?;
    let place = Place::Line(line);
    limits.check_corners(polygons.corners().len() as u64 + degree)?;
    let mut corners = Vec::new();
    for _ in 0..degree {
        let (line, word) = file.expect("a vertex index")?;
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
    polygons.push(corners);
    if file.line_has_more() {
        file.skip_line();
        notes.add(NoteKind::FaceColor, place);
    }
    Ok(())
}

/// Three or four components, whole numbers in 0..=255 or fractions in 0..=1.
fn color(given: &[&[u8]], line: u64) -> Result<[f32; 4], ReadError> {
    let mut color = [1.0; 4];
    if given.len() < 3 {
        return Err(ReadError::line(line, Malformed::Expected("a vertex colour")));
    }
    let whole = given.iter().take(4).all(|w| is_integer(w));
    for (c, word) in color.iter_mut().zip(given) {
        let value = number_at(line, word)?;
        *c = (if whole { value / 255.0 } else { value }) as f32;
    }
    Ok(color)
}

/// The words of all lines, comments left out, with their lines.
struct Words<'a> {
    lines: Lines<'a>,
    words: Vec<&'a [u8]>,
    at: usize,
    line: u64,
}

impl<'a> Words<'a> {
    fn new(text: &'a [u8]) -> Self {
        Self { lines: Lines::new(text), words: Vec::new(), at: 0, line: 1 }
    }

    fn next(&mut self) -> Option<(u64, &'a [u8])> {
        while self.at == self.words.len() {
            let (number, line) = self.lines.next()?;
            self.line = number;
            self.at = 0;
            self.words.clear();
            self.words.extend(words(before_comment(line)));
        }
        self.at += 1;
        Some((self.line, self.words[self.at - 1]))
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

    fn line_has_more(&self) -> bool {
        self.at < self.words.len()
    }

    fn skip_line(&mut self) {
        self.at = self.words.len();
    }

    fn rest_of_line(&mut self) -> Vec<&'a [u8]> {
        let rest = self.words[self.at..].to_vec();
        self.skip_line();
        rest
    }
}

struct Header {
    normals: bool,
    colors: bool,
    binary: bool,
}

impl Header {
    /// `[ST][C][N]OFF`, perhaps with `BINARY` or the counts behind it, even glued. Without a keyword a file may begin
    /// with its counts.
    fn read(file: &mut Words<'_>) -> Result<Self, ReadError> {
        let (line, word) = file.next().ok_or(ReadError::line(1, Malformed::Empty))?;
        let bad = || ReadError::line(line, Malformed::Beginning("an OFF file"));
        let Some(end) = word.windows(3).position(|w| w == b"OFF") else {
            if !is_integer(word) {
                return Err(bad());
            }
            file.at -= 1;
            return Ok(Self { normals: false, colors: false, binary: false });
        };
        let prefix = word[..end].strip_prefix(b"ST").unwrap_or(&word[..end]);
        let (colors, prefix) = prefix.strip_prefix(b"C").map_or((false, prefix), |p| (true, p));
        let (normals, prefix) = prefix.strip_prefix(b"N").map_or((false, prefix), |p| (true, p));
        let glued = &word[end + 3..];
        if !prefix.is_empty() || !(glued.is_empty() || is_integer(glued)) {
            return Err(bad());
        }
        if !glued.is_empty() {
            file.at -= 1;
            file.words[file.at] = glued;
        }
        let binary = file.words.get(file.at).is_some_and(|w| *w == b"BINARY");
        Ok(Self { normals, colors, binary })
    }
}

/// `OFF BINARY`: counts and indices of 32 bits, coordinates in single precision; big-endian by the book, little-endian in
/// life; with or without a colour count behind each face.
fn read_binary(bytes: &[u8], limits: &Limits) -> Result<Loaded, ReadError> {
    let start = bytes.iter().position(|&b| b == b'\n').map_or(bytes.len(), |i| i + 1);
    let data = &bytes[start..];
    let word = |i: usize| data.get(4 * i..4 * i + 4).and_then(|b| <[u8; 4]>::try_from(b).ok());
    let truncated = |i: usize, what| ReadError::byte(start + 4 * i, Malformed::Truncated(what));
    let counts = |read: fn([u8; 4]) -> u32| Some([read(word(0)?), read(word(1)?), read(word(2)?)]);
    let fits = |c: &[u32; 3]| 3 + 3 * u64::from(c[0]) + u64::from(c[1]) <= data.len() as u64 / 4;
    let big = counts(u32::from_be_bytes).ok_or(truncated(0, "the counts"))?;
    let (read, [vertices, faces, _]): (fn([u8; 4]) -> u32, _) = match counts(u32::from_le_bytes).filter(fits)
    {
        Some(little) if !fits(&big) || little[0] <= big[0] => (u32::from_le_bytes, little),
        _ => (u32::from_be_bytes, big),
    };
    if !fits(&[vertices, faces, 0]) {
        let room = data.len() as u64 / 12;
        let reason = Malformed::Promise { what: "vertices", wanted: u64::from(vertices), room };
        return Err(ReadError::byte(start, reason));
    }
    limits.check_vertices(u64::from(vertices))?;
    limits.check_faces(u64::from(faces))?;
    let get = |i: usize, what| word(i).map(read).ok_or(truncated(i, what));
    let mut notes = Notes::default();
    let mut soup = PolygonSoup::default();
    for v in 0..vertices as usize {
        let mut p = DVec3::ZERO;
        for i in 0..3 {
            p[i] = f64::from(f32::from_bits(get(3 + 3 * v + i, "a vertex")?));
        }
        if !p.is_finite() {
            notes.add(NoteKind::NonFiniteCoordinate, Place::Byte((start + 4 * (3 + 3 * v)) as u64));
        }
        soup.positions.push(p);
    }
    let first = 3 + 3 * vertices as usize;
    // Walk the faces without colours; if that does not end at the end, with them.
    let end = |colors: bool| {
        (0..faces).try_fold(first, |at, _| {
            let at = at.checked_add(1)?.checked_add(get(at, "a face").ok()? as usize)?;
            if colors { at.checked_add(1)?.checked_add(get(at, "a face").ok()? as usize) } else { Some(at) }
        })
    };
    let colors = end(false) != Some(data.len() / 4) && end(true) == Some(data.len() / 4);
    let mut at = first;
    for _ in 0..faces {
        let place = Place::Byte((start + 4 * at) as u64);
        let degree = get(at, "a face")? as usize;
        let room = (data.len() / 4).saturating_sub(at + 1);
        if degree > room {
            return Err(truncated(at, "a face"));
        }
        limits.check_corners((soup.polygons.corners().len() + degree) as u64)?;
        let corners: Vec<u32> = (at + 1..=at + degree).filter_map(|i| word(i).map(read)).collect();
        if corners.iter().any(|&v| v >= vertices) {
            notes.add(NoteKind::IndexOutOfRange, place);
        }
        if degree < 3 {
            notes.add(NoteKind::ShortFace, place);
        }
        soup.polygons.push(corners);
        at += 1 + degree;
        if colors {
            at = at.saturating_add(1).saturating_add(get(at, "a face colour")? as usize);
            notes.add(NoteKind::FaceColor, place);
        }
    }
    if data.len() > 4 * at {
        notes.add(NoteKind::TrailingData, Place::Byte((start + 4 * at) as u64));
    }
    Ok(Loaded { soup, notes: notes.finish() })
}

/// Writes an OFF file: `NOFF` with vertex normals, `COFF` with colours. Coordinates keep all their digits.
///
/// # Errors
/// [`WriteError`] when the soup could not be read back, or the sink fails.
///
/// # Examples
/// ```
/// use meshwright::{PolygonSoup, Polygons, glam::DVec3, io::write_off};
/// let soup = PolygonSoup::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], Polygons::from_triangles(&[[0, 1, 2]]));
/// let mut file = Vec::new();
/// write_off(&soup, &mut file)?;
/// assert!(file.starts_with(b"OFF\n3 1 0\n"));
/// # Ok::<(), meshwright::io::WriteError>(())
/// ```
pub fn write_off(soup: &PolygonSoup, sink: &mut impl Write) -> Result<Vec<Lost>, WriteError> {
    check_writable(soup)?;
    let normals = super::per_vertex(&soup.vertex_normals, soup);
    let colors = super::per_vertex(&soup.vertex_colors, soup);
    let prefix = [if colors.is_some() { "C" } else { "" }, if normals.is_some() { "N" } else { "" }].concat();
    writeln!(sink, "{prefix}OFF\n{} {} 0", soup.positions.len(), soup.polygons.len())?;
    for (i, p) in soup.positions.iter().enumerate() {
        write!(sink, "{} {} {}", Number(p.x), Number(p.y), Number(p.z))?;
        if let Some(n) = normals.map(|n| n[i]) {
            write!(sink, " {} {} {}", Number(n.x), Number(n.y), Number(n.z))?;
        }
        if let Some([r, g, b, a]) = colors.map(|c| c[i]) {
            // With a point, so that no reader takes them for bytes.
            write!(sink, " {r:?} {g:?} {b:?} {a:?}")?;
        }
        writeln!(sink)?;
    }
    for face in soup.polygons.iter() {
        write!(sink, "{}", face.len())?;
        for v in face {
            write!(sink, " {v}")?;
        }
        writeln!(sink)?;
    }
    Ok(super::lost(soup, &super::vertex_data(soup)))
}
