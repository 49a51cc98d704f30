//! Writing PLY.

use super::super::error::{Lost, WriteError};
use super::super::text::Number;
use super::super::{VertexData, check_writable, has_values, lost};
use crate::{CornerData, PolygonSoup};
use std::io::Write;

/// Writes a little-endian PLY file: positions, normals and texture coordinates in double precision, colours as bytes if they
/// were bytes. Normals stand at vertices; so do texture coordinates if all corners of each vertex have the same, and
/// if not, each face has a list of them (`texcoord`), in single precision if they fit.
///
/// # Errors
/// [`WriteError`] when the soup could not be read back, or the sink fails.
///
/// # Examples
/// ```
/// use meshwright::{PolygonSoup, Polygons, glam::DVec3, io::{Limits, read_ply, write_ply}};
/// let soup = PolygonSoup::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], Polygons::from_triangles(&[[0, 1, 2]]));
/// let mut file = Vec::new();
/// write_ply(&soup, &mut file)?;
/// assert_eq!(read_ply(&file, &Limits::default())?.soup, soup);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_ply(soup: &PolygonSoup, sink: &mut impl Write) -> Result<Vec<Lost>, WriteError> {
    write(soup, "binary_little_endian", sink, |sink, v| match v {
        Value::Double(x) => sink.write_all(&x.to_le_bytes()),
        Value::Float(x) => sink.write_all(&x.to_le_bytes()),
        Value::Single(x) => sink.write_all(&(x as f32).to_le_bytes()),
        Value::Byte(x) => sink.write_all(&[x]),
        Value::Index(x) => sink.write_all(&x.to_le_bytes()),
        Value::EndOfElement => Ok(()),
    })
}

/// Writes a big-endian PLY file; otherwise as [`write_ply`].
///
/// # Errors
/// [`WriteError`] when the soup could not be read back, or the sink fails.
///
/// # Examples
/// ```
/// use meshwright::{PolygonSoup, Polygons, glam::DVec3, io::write_ply_big_endian};
/// let soup = PolygonSoup::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], Polygons::from_triangles(&[[0, 1, 2]]));
/// let mut file = Vec::new();
/// write_ply_big_endian(&soup, &mut file)?;
/// assert!(file.starts_with(b"ply\nformat binary_big_endian 1.0\n"));
/// # Ok::<(), meshwright::io::WriteError>(())
/// ```
pub fn write_ply_big_endian(soup: &PolygonSoup, sink: &mut impl Write) -> Result<Vec<Lost>, WriteError> {
    write(soup, "binary_big_endian", sink, |sink, v| match v {
        Value::Double(x) => sink.write_all(&x.to_be_bytes()),
        Value::Float(x) => sink.write_all(&x.to_be_bytes()),
        Value::Single(x) => sink.write_all(&(x as f32).to_be_bytes()),
        Value::Byte(x) => sink.write_all(&[x]),
        Value::Index(x) => sink.write_all(&x.to_be_bytes()),
        Value::EndOfElement => Ok(()),
    })
}

/// Writes an ASCII PLY file; otherwise as [`write_ply`]. Coordinates keep all their digits.
///
/// # Errors
/// [`WriteError`] when the soup could not be read back, or the sink fails.
///
/// # Examples
/// ```
/// use meshwright::{PolygonSoup, Polygons, glam::DVec3, io::write_ply_ascii};
/// let soup = PolygonSoup::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], Polygons::from_triangles(&[[0, 1, 2]]));
/// let mut file = Vec::new();
/// write_ply_ascii(&soup, &mut file)?;
/// assert!(file.ends_with(b"end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"));
/// # Ok::<(), meshwright::io::WriteError>(())
/// ```
pub fn write_ply_ascii(soup: &PolygonSoup, sink: &mut impl Write) -> Result<Vec<Lost>, WriteError> {
    let mut separator = "";
    write(soup, "ascii", sink, |sink, v| {
        let before = std::mem::replace(&mut separator, " ");
        match v {
            Value::Double(x) | Value::Single(x) => write!(sink, "{before}{}", Number(x)),
            Value::Float(x) => write!(sink, "{before}{x}"),
            Value::Byte(x) => write!(sink, "{before}{x}"),
            Value::Index(x) => write!(sink, "{before}{x}"),
            Value::EndOfElement => {
                separator = "";
                writeln!(sink)
            }
        }
    })
}

enum Value {
    Double(f64),
    Float(f32),
    /// Fits single precision; in text it has the digits of double.
    Single(f64),
    Byte(u8),
    Index(u32),
    EndOfElement,
}

fn write<W: Write>(
    soup: &PolygonSoup,
    encoding: &str,
    sink: &mut W,
    mut put: impl FnMut(&mut W, Value) -> std::io::Result<()>,
) -> Result<Vec<Lost>, WriteError> {
    check_writable(soup)?;
    let data = VertexData::of(soup);
    let VertexData { normals, colors, uvs } = &data;
    let byte = |c: f32| (c * 255.0).round() as u8;
    let bytes = colors
        .is_some_and(|c| c.iter().flatten().all(|&c| (f32::from(byte(c)) / 255.0).to_bits() == c.to_bits()));
    let corners = soup.polygons.corners().len();
    let of_faces = soup.corner_uvs.as_ref().filter(|d| uvs.is_none() && d.indices.len() == corners);
    let of_faces = of_faces.filter(|d| has_values(Some(*d)));
    let fits_single = |x: f64| f64::from(x as f32).to_bits() == x.to_bits();
    let is_single = of_faces.is_some_and(|d| d.values.iter().flatten().all(|&x| fits_single(x)));

    writeln!(sink, "ply\nformat {encoding} 1.0\nelement vertex {}", soup.positions.len())?;
    let mut properties = |names: &[&str], kind: &str| {
        names.iter().try_for_each(|name| writeln!(sink, "property {kind} {name}"))
    };
    properties(&["x", "y", "z"], "double")?;
    if normals.is_some() {
        properties(&["nx", "ny", "nz"], "double")?;
    }
    if colors.is_some() {
        properties(&["red", "green", "blue", "alpha"], if bytes { "uchar" } else { "float" })?;
    }
    if uvs.is_some() {
        properties(&["s", "t"], "double")?;
    }
    // A byte counts the corners of nearly every file.
    let most = soup.polygons.iter().map(<[u32]>::len).max().unwrap_or(0);
    let is_small = |most: usize| most <= 255;
    let list = |most| if is_small(most) { "list uchar" } else { "list uint" };
    writeln!(sink, "element face {}\nproperty {} uint vertex_indices", soup.polygons.len(), list(most))?;
    if of_faces.is_some() {
        // Programs that know of such lists expect them in single precision.
        let kind = if is_single { "float" } else { "double" };
        writeln!(sink, "property {} {kind} texcoord", list(2 * most))?;
    }
    writeln!(sink, "end_header")?;
    let count = |n: usize, most| if is_small(most) { Value::Byte(n as u8) } else { Value::Index(n as u32) };

    for (i, p) in soup.positions.iter().enumerate() {
        for x in p.to_array().into_iter().chain(normals.iter().flat_map(|n| n[i].to_array())) {
            put(sink, Value::Double(x))?;
        }
        for c in colors.iter().flat_map(|c| c[i]) {
            put(sink, if bytes { Value::Byte(byte(c)) } else { Value::Float(c) })?;
        }
        for x in uvs.iter().flat_map(|uvs| uvs[i]) {
            put(sink, Value::Double(x))?;
        }
        put(sink, Value::EndOfElement)?;
    }
    let mut first = 0;
    let mut is_whole = true;
    for face in soup.polygons.iter() {
        put(sink, count(face.len(), most))?;
        for &v in face {
            put(sink, Value::Index(v))?;
        }
        if let Some(data) = of_faces {
            let own = first..first + face.len();
            let is_complete = own.clone().all(|c| uv(data, c).is_some());
            // A list has all or none.
            is_whole &= is_complete || own.clone().all(|c| uv(data, c).is_none());
            put(sink, count(if is_complete { 2 * face.len() } else { 0 }, 2 * most))?;
            for x in own.filter(|_| is_complete).filter_map(|c| uv(data, c)).flatten() {
                put(sink, if is_single { Value::Single(x) } else { Value::Double(x) })?;
            }
            first += face.len();
        }
        put(sink, Value::EndOfElement)?;
    }
    let mut carried = data.kinds(soup);
    carried.extend(of_faces.filter(|_| is_whole).map(|_| Lost::TextureCoordinates));
    Ok(lost(soup, &carried))
}

fn uv(data: &CornerData<[f64; 2]>, corner: usize) -> Option<[f64; 2]> {
    data.values.get(*data.indices.get(corner)? as usize).copied()
}
