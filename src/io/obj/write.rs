//! Writing OBJ.

use super::super::error::{Lost, WriteError};
use super::super::text::Number;
use super::super::{check_writable, lost, per_vertex};
use crate::{CornerData, PolygonSoup};
use std::io::Write;

/// Writes an OBJ file: vertices with colours, normals and texture coordinates, groups with material names. Coordinates
/// keep all their digits.
///
/// # Errors
/// [`WriteError`] when the soup could not be read back, or the sink fails.
///
/// # Examples
/// ```
/// use meshwright::{PolygonSoup, Polygons, glam::DVec3, io::write_obj};
/// let soup = PolygonSoup::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], Polygons::from_triangles(&[[0, 1, 2]]));
/// let mut file = Vec::new();
/// write_obj(&soup, &mut file)?;
/// assert_eq!(file, b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
/// # Ok::<(), meshwright::io::WriteError>(())
/// ```
pub fn write_obj(soup: &PolygonSoup, sink: &mut impl Write) -> Result<Vec<Lost>, WriteError> {
    check_writable(soup)?;
    let colors = per_vertex(&soup.vertex_colors, soup);
    for (i, p) in soup.positions.iter().enumerate() {
        write!(sink, "v {} {} {}", Number(p.x), Number(p.y), Number(p.z))?;
        if let Some([r, g, b, _]) = colors.map(|c| c[i]) {
            write!(sink, " {r} {g} {b}")?;
        }
        writeln!(sink)?;
    }
    let corners = soup.polygons.corners().len();
    let uvs = soup.corner_uvs.as_ref().filter(|d| d.indices.len() == corners);
    for [u, v] in uvs.map_or(&[][..], |d| &d.values) {
        writeln!(sink, "vt {} {}", Number(*u), Number(*v))?;
    }
    // Corner normals say more than vertex normals.
    let corner_normals = soup.corner_normals.as_ref().filter(|d| d.indices.len() == corners);
    let vertex_normals = per_vertex(&soup.vertex_normals, soup).filter(|_| corner_normals.is_none());
    for n in corner_normals.map(|d| &d.values[..]).or(vertex_normals).unwrap_or(&[]) {
        writeln!(sink, "vn {} {} {}", Number(n.x), Number(n.y), Number(n.z))?;
    }

    let mut groups = soup.groups.iter().peekable();
    let mut material = None;
    let mut corner = 0;
    for (f, face) in soup.polygons.iter().enumerate() {
        while let Some(group) = groups.next_if(|g| g.faces.start <= f) {
            writeln!(sink, "g {}", one_line(&group.name))?;
            if group.material != material {
                material.clone_from(&group.material);
                writeln!(sink, "usemtl {}", one_line(material.as_deref().unwrap_or_default()))?;
            }
        }
        write!(sink, "f")?;
        for &v in face {
            let uv = uvs.and_then(|d| index(d, corner));
            let normal = match corner_normals {
                Some(d) => index(d, corner),
                None => vertex_normals.map(|_| v + 1),
            };
            match (uv, normal) {
                (None, None) => write!(sink, " {}", v + 1)?,
                (Some(t), None) => write!(sink, " {}/{t}", v + 1)?,
                (None, Some(n)) => write!(sink, " {}//{n}", v + 1)?,
                (Some(t), Some(n)) => write!(sink, " {}/{t}/{n}", v + 1)?,
            }
            corner += 1;
        }
        writeln!(sink)?;
    }
    let mut carried = vec![Lost::Groups];
    carried.extend(uvs.map(|_| Lost::TextureCoordinates));
    carried.extend(colors.map(|_| Lost::Colors));
    if corner_normals.is_some() || vertex_normals.is_some() {
        carried.push(Lost::Normals);
    }
    let mut lost = lost(soup, &carried);
    if colors.is_some_and(|c| c.iter().any(|rgba| rgba[3] != 1.0)) {
        lost.push(Lost::Transparency);
    }
    Ok(lost)
}

/// The index from 1 of a corner's value, if it has one.
fn index<T>(data: &CornerData<T>, corner: usize) -> Option<u32> {
    let i = *data.indices.get(corner)?;
    ((i as usize) < data.values.len()).then(|| i + 1)
}

/// A name that cannot end its line, begin a comment or continue on the next line.
fn one_line(name: &str) -> String {
    name.chars().map(|c| if c.is_control() || c == '#' || c == '\\' { '_' } else { c }).collect()
}
