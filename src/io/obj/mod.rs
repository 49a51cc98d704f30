//! OBJ: tobj behind a filter.
//!
//! tobj reads numbers well, but renumbers vertices by first use, tears groups apart, and refuses, loses or panics on much
//! that occurs in files. So [`filter`] reads the file statement by statement, faces included, and hands tobj a plain text of
//! a few thousand vertices at a time: their coordinates, and a polygon through all of them, without which tobj would
//! return none.
//!
//! Measured on 70 MB: tobj alone spends most of its time on a hash map entry for each corner of a face. Here it sees none,
//! and the whole takes less than half the time of tobj alone, and a quarter of its memory.

mod coordinates;
mod corner;
mod filter;
mod statement;
mod write;

pub use write::write_obj;

use super::error::{Malformed, NoteKind, Place, ReadError};
use super::text::{number, number_at, without_mark, words};
use super::watch::Watch;
use super::{Limits, Loaded};
use statement::Statements;
use std::borrow::Cow;

/// Reads an OBJ file: vertices with colours, faces of any degree, texture coordinates and normals of corners, groups,
/// objects, material names and the names of material files, which are not opened.
///
/// The file's numbering is kept, unused vertices included. A face index that names no vertex is kept as one that names
/// none, and noted; so is a face of fewer than three corners. A text of remarks alone is an empty soup. O(bytes).
///
/// # Errors
/// [`ReadError`], with the line.
///
/// # Examples
/// ```
/// use meshwright::{PolygonSoup, io::{Limits, read_obj}};
/// let text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -1\nf 1 2 0\n";
/// let loaded = read_obj(text, &Limits::default())?;
/// assert_eq!(&loaded.soup.polygons[0], &[0, 1, 2]);
/// assert_eq!(&loaded.soup.polygons[1], &[0, 1, PolygonSoup::NO_VERTEX]);
/// assert_eq!(loaded.notes[0].to_string(), "line 5: face indices that name no vertex");
/// # Ok::<(), meshwright::io::ReadError>(())
/// ```
pub fn read_obj(bytes: &[u8], limits: &Limits) -> Result<Loaded, ReadError> {
    super::read(bytes, super::Format::Obj, limits)
}

pub(super) fn read(bytes: &[u8], limits: &Limits, watch: &mut Watch<'_, '_>) -> Result<Loaded, ReadError> {
    let text = without_mark(bytes)?;
    let read = filter::read(text, limits, watch).map_err(|(line, error)| match error {
        ReadError::Cancelled(_) => error,
        _ => blame(text, line).unwrap_or(error),
    });
    let (soup, mut notes, statements) = read?;
    if statements == 0 && !is_remark(text) {
        let reason = if text.is_empty() { Malformed::Empty } else { Malformed::Beginning("an OBJ file") };
        return Err(ReadError::line(1, reason));
    }
    if soup.positions.iter().any(|p| !p.is_finite()) {
        let bad = |w: &[u8]| number(w).is_some_and(|x| !x.is_finite());
        for (line, _) in vertex_lines(text).filter(|(_, s)| words(s).skip(1).take(3).any(bad)) {
            notes.add(NoteKind::NonFiniteCoordinate, Place::Line(line));
        }
    }
    Ok(Loaded { soup, notes: notes.finish() })
}

/// Whether the text begins with a remark: then it may be a file without anything in it.
fn is_remark(text: &[u8]) -> bool {
    words(text).next().is_some_and(|w| w.starts_with(b"#"))
}

fn vertex_lines(text: &[u8]) -> impl Iterator<Item = (u64, Cow<'_, [u8]>)> {
    Statements::new(text).filter(|(_, s)| words(s).next() == Some(b"v"))
}

/// The first coordinate up to a line that is no number. tobj does not say which; only files that are refused pay for it.
fn blame(text: &[u8], last: u64) -> Option<ReadError> {
    let lines = vertex_lines(text).take_while(|(line, _)| *line <= last);
    lines.into_iter().find_map(|(line, s)| words(&s).skip(1).take(3).find_map(|w| number_at(line, w).err()))
}
