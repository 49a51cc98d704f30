//! Writing OBJ.

use super::super::error::{Lost, WriteError};
use super::super::text::Number;
use super::super::{check_writable, has_values, lost, per_vertex};
use crate::{CornerData, PolygonSoup};
use glam::DVec3;
use std::io::Write;

/// Writes an OBJ file: vertices with colours, normals and texture coordinates of corners, groups with material names and
/// the names of material files. Coordinates keep all their digits. Vertex normals become those of all their corners.
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
    if soup.positions.is_empty() {
        writeln!(sink, "# no vertices")?;
    }
    for file in &soup.material_files {
        writeln!(sink, "{}", statement("mtllib", file))?;
    }
    let colors = per_vertex(&soup.vertex_colors, soup);
    for (i, p) in soup.positions.iter().enumerate() {
        write!(sink, "v {} {} {}", Number(p.x), Number(p.y), Number(p.z))?;
        if let Some([r, g, b, _]) = colors.map(|c| c[i]) {
            write!(sink, " {r} {g} {b}")?;
        }
        writeln!(sink)?;
    }
    let corners = soup.polygons.corners().len();
    let uvs = soup.corner_uvs.as_ref().filter(|d| d.indices.len() == corners && has_values(Some(d)));
    for [u, v] in uvs.map_or(&[][..], |d| &d.values) {
        writeln!(sink, "vt {} {}", Number(*u), Number(*v))?;
    }
    // Corner normals say more than vertex normals.
    let corner_normals = soup.corner_normals.as_ref();
    let corner_normals = corner_normals.filter(|d| d.indices.len() == corners && has_values(Some(d)));
    let vertex_normals = per_vertex(&soup.vertex_normals, soup).filter(|_| corner_normals.is_none());
    for n in corner_normals.map(|d| &d.values[..]).or(vertex_normals).unwrap_or(&[]) {
        writeln!(sink, "vn {} {} {}", Number(n.x), Number(n.y), Number(n.z))?;
    }

    let mut groups = soup.groups.iter().filter(|g| !g.faces.is_empty()).peekable();
    let mut group_end = None;
    let mut material = None;
    let mut corner = 0;
    for (f, face) in soup.polygons.iter().enumerate() {
        let mut group = None;
        while let Some(next) = groups.next_if(|g| g.faces.start <= f) {
            group = Some(next);
        }
        if let Some(group) = group {
            writeln!(sink, "{}", statement("g", &group.name))?;
            set_material(sink, &mut material, group.material.as_deref())?;
            group_end = Some(group.faces.end);
        } else if group_end.is_some_and(|end| end <= f) {
            // Faces behind a group's end belong to none.
            writeln!(sink, "g")?;
            set_material(sink, &mut material, None)?;
            group_end = None;
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
    let mut carried = Vec::new();
    if carries_groups(soup) {
        carried.push(Lost::Groups);
    }
    carried.extend(uvs.map(|_| Lost::TextureCoordinates));
    carried.extend(colors.map(|_| Lost::Colors));
    if corner_normals.is_some() || vertex_normals.is_some() {
        carried.push(Lost::Normals);
    }
    if soup.material_files.iter().all(|name| !name.is_empty() && one_line(name) == *name) {
        carried.push(Lost::MaterialFiles);
    }
    let mut lost = lost(soup, &carried);
    if let Some(normals) = per_vertex(&soup.vertex_normals, soup) {
        let mut named = vec![false; normals.len()];
        soup.polygons.corners().iter().for_each(|&v| named[v as usize] = corner_normals.is_none());
        if normals.iter().zip(named).any(|(n, named)| !named && *n != DVec3::ZERO) {
            lost.push(Lost::VertexNormals);
        }
    }
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

/// Puts a material in use, or none, unless it is in use.
fn set_material<'s>(
    sink: &mut impl Write,
    current: &mut Option<&'s str>,
    new: Option<&'s str>,
) -> std::io::Result<()> {
    if *current != new {
        *current = new;
        writeln!(sink, "{}", statement("usemtl", new.unwrap_or_default()))?;
    }
    Ok(())
}

/// A statement with a name that cannot end its line, begin a comment or continue on the next line.
fn statement(keyword: &str, name: &str) -> String {
    let name = one_line(name);
    if name.is_empty() { keyword.to_owned() } else { format!("{keyword} {name}") }
}

fn one_line(name: &str) -> String {
    name.trim().chars().map(|c| if c.is_control() || c == '#' || c == '\\' { '_' } else { c }).collect()
}

/// Whether all groups read back as they are: in order, apart, of existing faces, with names that fit a line, and each
/// saying something.
fn carries_groups(soup: &PolygonSoup) -> bool {
    let mut before = 0;
    soup.groups.iter().all(|group| {
        let names = [Some(&group.name), group.material.as_ref()];
        let is_carried = before <= group.faces.start
            && group.faces.start < group.faces.end
            && names.into_iter().flatten().all(|n| one_line(n) == *n)
            && group.material.as_deref() != Some("")
            && (!group.name.is_empty() || group.material.is_some());
        before = group.faces.end;
        is_carried
    }) && before <= soup.polygons.len()
}
