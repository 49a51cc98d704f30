//! OBJ: tobj behind a filter.
//!
//! tobj reads numbers and faces well, but renumbers vertices by first use, tears groups apart, and refuses, loses or
//! panics on much that occurs in files. So [`filter`](filter::Filter) reads the file line by line and hands tobj a plain
//! text as it goes: the vertices, the faces that name three or more vertices read before, and at the end one polygon
//! through all vertices, which tells how tobj numbered them. Everything else the filter keeps itself.
//!
//! The price, measured on 68 MB: tobj alone reads 126 MB/s, most of it spent on a hash map entry for each corner.

mod corner;
mod filter;
mod statement;
mod write;

pub use write::write_obj;

use super::error::{Malformed, NoteKind, Notes, Place, ReadError};
use super::text::{number, number_at, without_mark, words};
use super::watch::Watch;
use super::{Limits, Loaded};
use crate::{PolygonSoup, Polygons};
use filter::{Filter, Kept};
use glam::DVec3;
use statement::Statements;
use std::borrow::Cow;
use std::path::Path;

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
    watch.leave_after_bytes(0.5);
    let mut filter = Filter::new(text, *limits, watch);
    let options = tobj::LoadOptions {
        single_index: false,
        triangulate: false,
        ignore_points: false,
        ignore_lines: false,
    };
    let loaded = tobj::load_obj_buf(&mut filter, &options, |_: &Path| Err(tobj::LoadError::OpenFileFailed));
    let kept = filter.finish().map_err(|(line, error)| match error {
        ReadError::Cancelled(_) => error,
        _ => blame(text, line).unwrap_or(error),
    })?;
    if kept.statements == 0 && !is_remark(text) {
        let reason = if text.is_empty() { Malformed::Empty } else { Malformed::Beginning("an OBJ file") };
        return Err(ReadError::line(1, reason));
    }
    let combined = loaded.ok().and_then(|(models, _)| combine(&models.first()?.mesh, kept));
    let Some((soup, mut notes)) = combined else {
        return Err(
            blame(text, u64::MAX).unwrap_or(ReadError::line(1, Malformed::Expected("three coordinates")))
        );
    };
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

/// The first coordinate before a line that is no number. tobj does not say which; only files that are refused pay for it.
fn blame(text: &[u8], before: u64) -> Option<ReadError> {
    let lines = vertex_lines(text).take_while(|(line, _)| *line < before);
    lines.into_iter().find_map(|(line, s)| words(&s).skip(1).take(3).find_map(|w| number_at(line, w).err()))
}

/// Gives the vertices the file's numbers, and puts the faces tobj read and those the filter kept back into the file's
/// order. `None` if tobj did not read what it was given.
fn combine(model: &tobj::Mesh, kept: Kept) -> Option<(PolygonSoup, Notes)> {
    let vertices = kept.vertices;
    // tobj numbers vertices by first use. The last polygon runs through all of them, padding included.
    let (indices, order) =
        model.indices.split_at_checked(model.indices.len().checked_sub(vertices.max(filter::FEWEST))?)?;
    let mut number = vec![PolygonSoup::NO_VERTEX; order.len()];
    let mut positions = Vec::with_capacity(vertices);
    for (v, &i) in order.iter().enumerate() {
        *number.get_mut(i as usize)? = v as u32;
        if v < vertices {
            positions.push(DVec3::from_slice(model.positions.get(3 * i as usize..3 * i as usize + 3)?));
        }
    }
    let corners = indices.len() + kept.held.polygons.corners().len();
    let mut polygons = Polygons::with_capacity(kept.faces, corners);
    let mut at = 0;
    let mut held = kept.held.faces.iter().zip(kept.held.polygons.iter()).peekable();
    let mut arities = model.face_arities.iter();
    for face in 0..kept.faces {
        if let Some((_, corners)) = held.next_if(|((f, _), _)| *f == face) {
            polygons.push(corners.iter().copied());
            continue;
        }
        // tobj gives no arities when all faces are triangles, the last included.
        let degree = arities.next().map_or(3, |&n| n as usize);
        let corners = indices.get(at..at + degree)?.iter();
        polygons.push(corners.map(|&i| number.get(i as usize).copied().unwrap_or(PolygonSoup::NO_VERTEX)));
        at += degree;
    }
    let soup = PolygonSoup {
        positions,
        polygons,
        vertex_colors: kept.colors,
        corner_normals: kept.corner_normals,
        corner_uvs: kept.corner_uvs,
        groups: kept.groups,
        material_files: kept.material_files,
        ..PolygonSoup::default()
    };
    Some((soup, kept.notes))
}
