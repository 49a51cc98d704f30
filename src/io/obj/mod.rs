//! OBJ: tobj behind a filter.
//!
//! tobj reads numbers and faces well, but renumbers vertices by first use, tears groups apart, and refuses, loses or
//! panics on much that occurs in files. So [`filter`](filter::Filter) reads the file line by line and hands tobj a plain
//! text: the vertices, one polygon through all of them in order (so that its numbering is the file's), and the faces
//! that name three or more existing vertices. Everything else the filter keeps itself.

mod filter;
mod write;

pub use write::write_obj;

use super::error::{Malformed, NoteKind, Notes, Place, ReadError};
use super::text::{number, number_at, without_mark, words};
use super::{Limits, Loaded};
use crate::{PolygonSoup, Polygons};
use filter::{Counts, Filter, Kept, statements};
use glam::DVec3;
use std::borrow::Cow;
use std::path::Path;

/// Reads an OBJ file: vertices with colours, faces of any degree, texture coordinates and normals of corners, groups,
/// objects and material names. Material files are not opened.
///
/// The file's numbering is kept, unused vertices included. A face index that names no vertex is kept as one that names
/// none, and noted; so is a face of fewer than three corners. O(bytes).
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
/// assert_eq!(loaded.notes[0].to_string(), "line 5: face indices that name no vertex, kept");
/// # Ok::<(), meshwright::io::ReadError>(())
/// ```
pub fn read_obj(bytes: &[u8], limits: &Limits) -> Result<Loaded, ReadError> {
    let text = without_mark(bytes)?;
    let counts = Counts::of(text);
    limits.check_vertices(counts.vertices)?;
    limits.check_faces(counts.faces)?;
    if counts.statements == 0 {
        let reason = if text.is_empty() { Malformed::Empty } else { Malformed::Beginning("an OBJ file") };
        return Err(ReadError::line(1, reason));
    }
    let mut filter = Filter::new(text, counts, *limits);
    let options = tobj::LoadOptions {
        single_index: false,
        triangulate: false,
        ignore_points: false,
        ignore_lines: false,
    };
    let loaded = tobj::load_obj_buf(&mut filter, &options, |_: &Path| Err(tobj::LoadError::OpenFileFailed));
    let kept = filter.finish()?;
    let model = match loaded {
        Ok((models, _)) => models.into_iter().next().map(|m| m.mesh).unwrap_or_default(),
        Err(_) => return Err(blame(text)),
    };
    let (soup, mut notes) = combine(model, kept);
    if soup.positions.iter().any(|p| !p.is_finite()) {
        let bad = |w: &[u8]| number(w).is_some_and(|x| !x.is_finite());
        for (line, _) in vertex_lines(text).filter(|(_, s)| words(s).skip(1).take(3).any(bad)) {
            notes.add(NoteKind::NonFiniteCoordinate, Place::Line(line));
        }
    }
    Ok(Loaded { soup, notes: notes.finish() })
}

fn vertex_lines(text: &[u8]) -> impl Iterator<Item = (u64, Cow<'_, [u8]>)> {
    statements(text).filter(|(_, s)| words(s).next() == Some(b"v"))
}

/// The line tobj could not read: a coordinate, as the filter has seen to everything else.
fn blame(text: &[u8]) -> ReadError {
    let error = vertex_lines(text)
        .find_map(|(line, s)| words(&s).skip(1).take(3).find_map(|w| number_at(line, w).err()));
    error.unwrap_or(ReadError::line(1, Malformed::Expected("numbers")))
}

/// Puts the faces tobj read and those the filter kept back into the order of the file.
fn combine(model: tobj::Mesh, kept: Kept) -> (PolygonSoup, Notes) {
    let vertices = kept.vertices;
    let coordinates = model.positions.chunks_exact(3).take(vertices);
    let positions: Vec<DVec3> = coordinates.map(DVec3::from_slice).collect();
    let mut polygons = Polygons::with_capacity(kept.faces, model.indices.len());
    // The first polygon runs through all vertices, padding included.
    let mut at = vertices.max(filter::FEWEST);
    let mut odd = kept.odd.iter().peekable();
    let mut arities = model.face_arities.iter().skip(1);
    for face in 0..kept.faces {
        if let Some((_, corners)) = odd.next_if(|o| o.0 == face) {
            polygons.push(corners.iter().copied());
            continue;
        }
        // All faces are triangles, the first included, when tobj gives no arities.
        let degree = arities.next().map_or(3, |&n| n as usize);
        polygons.push(model.indices.get(at..at + degree).unwrap_or(&[]).iter().copied());
        at += degree;
    }
    let soup = PolygonSoup {
        positions,
        polygons,
        vertex_colors: kept.colors,
        corner_normals: kept.corner_normals,
        corner_uvs: kept.corner_uvs,
        groups: kept.groups,
        ..PolygonSoup::default()
    };
    (soup, kept.notes)
}
