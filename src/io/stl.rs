//! STL, ASCII and binary. Read here: an ASCII file keeps its digits beyond single precision, and the two kinds are told
//! apart by their length first, not by the word "solid" that binary files begin with too.

use super::error::{Lost, Malformed, NoteKind, Notes, Place, ReadError, WriteError};
use super::text::{Lines, Number, before_comment, number_at, shown, without_mark, words};
use super::watch::Watch;
use super::{Limits, Loaded, check_writable};
use crate::geometry::triangulate::for_each_triangle;
use crate::{PolygonSoup, Polygons};
use glam::DVec3;
use std::io::Write;

const HEADER: usize = 84;
const FACET: usize = 50;
/// Facets between two looks at the hook.
const BLOCK: usize = 1024;
/// Within so many bytes an ASCII file has said what it is.
const BEGINNING: usize = 4096;

/// Reads an STL file: three vertices of its own for every facet. Facets of an ASCII file may have more corners. Several
/// solids are read as one. Facet normals are left out, as the faces imply them. O(bytes).
///
/// # Errors
/// [`ReadError`], with the line or byte.
///
/// # Examples
/// ```
/// use meshwright::io::{Limits, read_stl};
/// let text = b"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n";
/// let loaded = read_stl(text, &Limits::default())?;
/// assert_eq!(&loaded.soup.polygons[0], &[0, 1, 2]);
/// # Ok::<(), meshwright::io::ReadError>(())
/// ```
pub fn read_stl(bytes: &[u8], limits: &Limits) -> Result<Loaded, ReadError> {
    super::read(bytes, super::Format::Stl, limits)
}

pub(super) fn read(bytes: &[u8], limits: &Limits, watch: &mut Watch<'_, '_>) -> Result<Loaded, ReadError> {
    if bytes.is_empty() {
        return Err(ReadError::byte(0, Malformed::Empty));
    }
    if is_binary(bytes) {
        return read_binary(bytes, limits, watch);
    }
    let text = without_mark(bytes)?;
    let beginning = &text[..text.len().min(BEGINNING)];
    let has = |keyword: &[u8]| words(beginning).any(|w| w.eq_ignore_ascii_case(keyword));
    // A binary file that was cut short may begin with "solid", too.
    if has(b"facet") || has(b"endsolid") || (has(b"solid") && !beginning.contains(&0)) {
        return read_ascii(text, limits, watch);
    }
    // Not text: say what a binary file would be missing.
    read_binary(bytes, limits, watch)
}

fn promised(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(80..HEADER)?;
    Some(u64::from(u32::from_le_bytes(count.try_into().ok()?)))
}

/// Whether the length is that of the facets promised, give or take less than one.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    let length = |count: u64| HEADER as u64 + FACET as u64 * count;
    promised(bytes).is_some_and(|n| (length(n)..length(n + 1)).contains(&(bytes.len() as u64)))
}

fn read_binary(bytes: &[u8], limits: &Limits, watch: &mut Watch<'_, '_>) -> Result<Loaded, ReadError> {
    let Some(wanted) = promised(bytes) else {
        return Err(ReadError::byte(bytes.len(), Malformed::Truncated("the header")));
    };
    let data = &bytes[HEADER..];
    let room = (data.len() / FACET) as u64;
    if wanted > room {
        return Err(ReadError::byte(80, Malformed::Promise { what: "facets", wanted, room }));
    }
    limits.check_faces(wanted)?;
    limits.check_vertices(3 * wanted)?;
    limits.check_corners(3 * wanted)?;
    let count = wanted as usize;
    let mut notes = Notes::default();
    let mut positions = Vec::with_capacity(3 * count);
    let (facets, _) = data.as_chunks::<FACET>();
    for (block, facets) in facets[..count].chunks(BLOCK).enumerate() {
        watch.ticks(facets.len(), FACET * (count - BLOCK * block))?;
        let first = positions.len();
        for facet in facets {
            let (numbers, _) = facet[12..48].as_chunks();
            let at = |i: usize| f64::from(f32::from_le_bytes(numbers[i]));
            positions.extend([0, 3, 6].map(|i| DVec3::new(at(i), at(i + 1), at(i + 2))));
        }
        let odd = positions[first..].iter().enumerate().filter(|(_, p)| !p.is_finite());
        for (i, _) in odd {
            let byte = HEADER + FACET * (BLOCK * block + i / 3);
            notes.add(NoteKind::NonFiniteCoordinate, Place::Byte(byte as u64));
        }
    }
    if data.len() > FACET * count {
        notes.add(NoteKind::TrailingData, Place::Byte((HEADER + FACET * count) as u64));
    }
    let polygons = Polygons::uniform(3, (0..3 * wanted as u32).collect());
    Ok(Loaded { soup: PolygonSoup::new(positions, polygons), notes: notes.finish() })
}

fn read_ascii(text: &[u8], limits: &Limits, watch: &mut Watch<'_, '_>) -> Result<Loaded, ReadError> {
    let mut notes = Notes::default();
    let mut soup = PolygonSoup::default();
    let mut corners: Vec<u32> = Vec::new();
    let (mut in_facet, mut in_solid) = (false, false);
    let mut last = 1;
    let mut lines = Lines::new(text);
    while let Some((line, content)) = lines.next() {
        watch.tick(lines.left())?;
        last = line;
        let mut words = words(before_comment(content));
        let Some(keyword) = words.next() else { continue };
        let is = |name: &str| keyword.eq_ignore_ascii_case(name.as_bytes());
        let malformed = |reason| Err(ReadError::line(line, reason));
        if is("vertex") {
            if !in_facet {
                return malformed(Malformed::Expected("a facet before its vertices"));
            }
            let mut p = DVec3::ZERO;
            for i in 0..3 {
                let Some(word) = words.next() else {
                    return malformed(Malformed::Expected("three coordinates"));
                };
                p[i] = number_at(line, word)?;
            }
            if !p.is_finite() {
                notes.add(NoteKind::NonFiniteCoordinate, Place::Line(line));
            }
            limits.check_vertices(soup.positions.len() as u64 + 1)?;
            limits.check_corners(soup.positions.len() as u64 + 1)?;
            corners.push(soup.positions.len() as u32);
            soup.positions.push(p);
        } else if is("facet") {
            if in_facet {
                return malformed(Malformed::Expected("the end of a facet before the next"));
            }
            in_facet = true;
        } else if is("endfacet") {
            if !in_facet {
                return malformed(Malformed::Expected("a facet before its end"));
            }
            if corners.len() < 3 {
                notes.add(NoteKind::ShortFace, Place::Line(line));
            }
            limits.check_faces(soup.polygons.len() as u64 + 1)?;
            soup.polygons.push(corners.drain(..));
            in_facet = false;
        } else if is("solid") {
            in_solid = true;
        } else if is("endsolid") || is("end") {
            in_solid = false;
        } else if !(is("outer") || is("endloop")) {
            if in_facet || !in_solid {
                return malformed(Malformed::Number(shown(keyword)));
            }
            // Names of solids run over lines in some files.
            notes.add(NoteKind::Ignored, Place::Line(line));
        }
    }
    if in_facet {
        return Err(ReadError::line(last, Malformed::Truncated("a facet")));
    }
    if in_solid {
        notes.add(NoteKind::MissingEnd, Place::Line(last));
    }
    Ok(Loaded { soup, notes: notes.finish() })
}

/// Writes a binary STL file: single precision, every triangle with corners of its own; polygons are cut by the shared
/// triangulation rule.
///
/// # Errors
/// [`WriteError`] when the soup could not be read back (a position beyond single precision counts), or the sink fails.
///
/// # Examples
/// ```
/// use meshwright::{PolygonSoup, Polygons, glam::DVec3, io::{Lost, write_stl}};
/// let soup = PolygonSoup::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], Polygons::from_triangles(&[[0, 1, 2]]));
/// let mut file = Vec::new();
/// assert_eq!(write_stl(&soup, &mut file)?, [Lost::SharedVertices]);
/// assert_eq!(file.len(), 84 + 50);
/// # Ok::<(), meshwright::io::WriteError>(())
/// ```
pub fn write_stl(soup: &PolygonSoup, sink: &mut impl Write) -> Result<Vec<Lost>, WriteError> {
    check_writable(soup)?;
    let single = |v: u32| soup.positions[v as usize].as_vec3();
    if let Some(vertex) = (0..soup.positions.len()).find(|&v| !single(v as u32).is_finite()) {
        return Err(WriteError::BeyondSingle { vertex });
    }
    let triangles = triangles(soup);
    let count = u32::try_from(triangles.len())
        .map_err(|_| WriteError::TooLarge { what: "triangles", count: triangles.len() })?;
    let mut header = [0; 80];
    let title = b"binary STL by meshwright";
    header[..title.len()].copy_from_slice(title);
    sink.write_all(&header)?;
    sink.write_all(&count.to_le_bytes())?;
    for t in triangles {
        let mut facet = [0; FACET];
        let points = [facet_normal(soup, t).as_vec3(), single(t[0]), single(t[1]), single(t[2])];
        let numbers = points.iter().flat_map(|p| p.to_array());
        for (slot, x) in facet.chunks_exact_mut(4).zip(numbers) {
            slot.copy_from_slice(&x.to_le_bytes());
        }
        sink.write_all(&facet)?;
    }
    let exact = soup.positions.iter().all(|p| p.as_vec3().as_dvec3() == *p);
    Ok(lost(soup, exact))
}

/// Writes an ASCII STL file, otherwise as [`write_stl`]; coordinates keep all their digits.
///
/// # Errors
/// [`WriteError`] when the soup could not be read back, or the sink fails.
///
/// # Examples
/// ```
/// use meshwright::{PolygonSoup, Polygons, glam::DVec3, io::write_stl_ascii};
/// let soup = PolygonSoup::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], Polygons::from_triangles(&[[0, 1, 2]]));
/// let mut file = Vec::new();
/// write_stl_ascii(&soup, &mut file)?;
/// assert!(file.starts_with(b"solid meshwright\nfacet normal 0 0 1\n"));
/// # Ok::<(), meshwright::io::WriteError>(())
/// ```
pub fn write_stl_ascii(soup: &PolygonSoup, sink: &mut impl Write) -> Result<Vec<Lost>, WriteError> {
    check_writable(soup)?;
    writeln!(sink, "solid meshwright")?;
    for t in triangles(soup) {
        let n = facet_normal(soup, t);
        writeln!(sink, "facet normal {} {} {}\n outer loop", Number(n.x), Number(n.y), Number(n.z))?;
        for p in t.map(|v| soup.positions[v as usize]) {
            writeln!(sink, "  vertex {} {} {}", Number(p.x), Number(p.y), Number(p.z))?;
        }
        writeln!(sink, " endloop\nendfacet")?;
    }
    writeln!(sink, "endsolid meshwright")?;
    Ok(lost(soup, true))
}

fn triangles(soup: &PolygonSoup) -> Vec<[u32; 3]> {
    let mut triangles = Vec::with_capacity(soup.polygons.len());
    for_each_triangle(&soup.polygons, &soup.positions, |t| triangles.push(t));
    triangles
}

fn facet_normal(soup: &PolygonSoup, t: [u32; 3]) -> DVec3 {
    let [a, b, c] = t.map(|v| soup.positions[v as usize]);
    crate::geometry::direction((b - a).cross(c - a))
}

fn lost(soup: &PolygonSoup, exact: bool) -> Vec<Lost> {
    let mut lost = Vec::new();
    if !soup.polygons.is_empty() {
        lost.push(Lost::SharedVertices);
    }
    if !exact {
        lost.push(Lost::Precision);
    }
    if soup.polygons.iter().any(|f| f.len() > 3) {
        lost.push(Lost::Polygons);
    }
    let mut named = vec![false; soup.positions.len()];
    soup.polygons.corners().iter().for_each(|&v| named[v as usize] = true);
    if named.contains(&false) {
        lost.push(Lost::IsolatedVertices);
    }
    lost.extend(super::lost(soup, &[]));
    lost
}
