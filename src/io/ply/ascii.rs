//! Elements as text, one a line.

use super::super::error::{Malformed, NoteKind, Notes, Place, ReadError};
use super::super::text::{Lines, integer, number_at, shown, words};
use super::super::watch::Watch;
use super::header::{Element, Header, Scalar};
use super::read::{Reader, Role};
use crate::PolygonSoup;

pub(super) fn read(
    reader: &mut Reader,
    header: &Header,
    data: &[u8],
    watch: &mut Watch<'_, '_>,
) -> Result<(), ReadError> {
    let mut rows = Rows { lines: Lines::new(data), header_lines: header.lines, last: 0, in_remark: false };
    let mut row = Row::default();
    for element in &header.elements {
        let role = reader.role(element, Place::Line(header.lines), data.len());
        if element.properties.is_empty() {
            continue;
        }
        for _ in 0..element.count {
            watch.tick(rows.lines.left())?;
            let Some((line, content)) = rows.next(&mut reader.notes) else {
                let last = header.lines + rows.last;
                return Err(ReadError::line(last, Malformed::Truncated("the elements")));
            };
            row.read(element, &role, line, content)?;
            match &role {
                Role::Vertex(layout) => {
                    let value = |i: usize| row.values.get(i).copied().unwrap_or_default();
                    reader.take_vertex(layout, value, Place::Line(line));
                }
                Role::Face { .. } => reader.take_face(&row.corners, &row.texcoords, Place::Line(line))?,
                Role::Other => {}
            }
        }
    }
    if let Some((line, _)) = rows.next(&mut reader.notes) {
        reader.notes.add(NoteKind::TrailingData, Place::Line(line));
    }
    Ok(())
}

/// One element.
#[derive(Default)]
struct Row {
    /// The scalars, with zeros in the places of lists.
    values: Vec<f64>,
    /// The vertex indices of a face.
    corners: Vec<u32>,
    /// The texture coordinates of a face.
    texcoords: Vec<f64>,
}

impl Row {
    fn read(&mut self, element: &Element, role: &Role, line: u64, content: &[u8]) -> Result<(), ReadError> {
        let mut words = words(content);
        self.values.clear();
        self.corners.clear();
        self.texcoords.clear();
        for (i, property) in element.properties.iter().enumerate() {
            let word = words.next().ok_or(ReadError::line(line, Malformed::Truncated("an element")))?;
            if property.list.is_none() {
                self.values.push(value(line, word, property.scalar)?);
                continue;
            }
            self.values.push(0.0);
            let length = index(line, word)?;
            for _ in 0..length {
                let word = words.next().ok_or(ReadError::line(line, Malformed::Truncated("a list")))?;
                match role {
                    Role::Face { corners, .. } if *corners == i => self.corners.push(index(line, word)?),
                    Role::Face { texcoords, .. } if *texcoords == Some(i) => {
                        self.texcoords.push(value(line, word, property.scalar)?);
                    }
                    _ => {
                        value(line, word, property.scalar)?;
                    }
                }
            }
        }
        match words.next() {
            Some(_) => Err(ReadError::line(line, Malformed::Expected("no more values than properties"))),
            None => Ok(()),
        }
    }
}

/// A number, and a whole one where the header says so.
fn value(line: u64, word: &[u8], scalar: Scalar) -> Result<f64, ReadError> {
    let value = number_at(line, word)?;
    let is_of_type = !scalar.is_integer() || value.fract() == 0.0;
    if is_of_type { Ok(value) } else { Err(ReadError::line(line, Malformed::Number(shown(word)))) }
}

/// A whole number, in the spelling of fractions too; what cannot be an index becomes the one that names nothing.
fn index(line: u64, word: &[u8]) -> Result<u32, ReadError> {
    if let Some(i) = integer(word) {
        return Ok(u32::try_from(i).unwrap_or(PolygonSoup::NO_VERTEX));
    }
    let value = value(line, word, Scalar::U32)?;
    let fits = (0.0..=f64::from(u32::MAX)).contains(&value);
    Ok(if fits { value as u32 } else { PolygonSoup::NO_VERTEX })
}

/// The lines that hold elements: not empty, and without the remarks that some files have among their data.
struct Rows<'a> {
    lines: Lines<'a>,
    header_lines: u64,
    /// The last line that held an element.
    last: u64,
    in_remark: bool,
}

impl<'a> Rows<'a> {
    fn next(&mut self, notes: &mut Notes) -> Option<(u64, &'a [u8])> {
        for (number, line) in self.lines.by_ref() {
            let place = Place::Line(self.header_lines + number);
            let content = line.trim_ascii();
            if self.in_remark || content.starts_with(b"{") || content.starts_with(b"comment") {
                self.in_remark = (self.in_remark || content.starts_with(b"{")) && !content.contains(&b'}');
                notes.add(NoteKind::StrayComment, place);
            } else if !content.is_empty() {
                self.last = number;
                // Remarks in braces may follow the values.
                let end = content.iter().position(|&b| b == b'{').unwrap_or(content.len());
                if end < content.len() {
                    notes.add(NoteKind::StrayComment, place);
                }
                return Some((self.header_lines + number, &content[..end]));
            }
        }
        None
    }
}
