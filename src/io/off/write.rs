//! Writing OFF.

use super::super::error::{Lost, WriteError};
use super::super::text::Number;
use super::super::{VertexData, check_writable, lost};
use crate::PolygonSoup;
use std::io::Write;

/// Writes an OFF file: `NOFF` with vertex normals, `COFF` with colours, `STOFF` with texture coordinates where all corners
/// of each vertex have the same. Coordinates keep all their digits.
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
    let data = VertexData::of(soup);
    let letters = [("ST", data.uvs.is_some()), ("C", data.colors.is_some()), ("N", data.normals.is_some())];
    let prefix: String = letters.into_iter().filter(|l| l.1).map(|l| l.0).collect();
    writeln!(sink, "{prefix}OFF\n{} {} 0", soup.positions.len(), soup.polygons.len())?;
    for (i, p) in soup.positions.iter().enumerate() {
        write!(sink, "{} {} {}", Number(p.x), Number(p.y), Number(p.z))?;
        if let Some(n) = data.normals.as_ref().map(|n| n[i]) {
            write!(sink, " {} {} {}", Number(n.x), Number(n.y), Number(n.z))?;
        }
        if let Some([r, g, b, a]) = data.colors.map(|c| c[i]) {
            // With a point, so that no reader takes them for bytes.
            write!(sink, " {r:?} {g:?} {b:?} {a:?}")?;
        }
        if let Some([u, v]) = data.uvs.as_ref().map(|uvs| uvs[i]) {
            write!(sink, " {} {}", Number(u), Number(v))?;
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
    Ok(lost(soup, &data.kinds(soup)))
}
