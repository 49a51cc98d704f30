//! Reading PLY.

use super::super::error::{Malformed, NoteKind, Notes, Place, ReadError};
use super::super::watch::Watch;
use super::super::{Limits, Loaded};
use super::binary::Records;
use super::header::{self, Element, Encoding, Header};
use crate::{CornerData, PolygonSoup, Polygons};
use glam::DVec3;

/// Reads a PLY file: positions, vertex normals and colours, texture coordinates of vertices or, where faces have lists of them
/// (`texcoord`), of corners; faces of any degree. Elements may come in any order. O(bytes).
///
/// # Errors
/// [`ReadError`], with the line, or the byte of a binary file.
///
/// # Examples
/// ```
/// use meshwright::io::{Limits, read_ply};
/// let text = b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
/// element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
/// let loaded = read_ply(text, &Limits::default())?;
/// assert_eq!(&loaded.soup.polygons[0], &[0, 1, 2]);
/// # Ok::<(), meshwright::io::ReadError>(())
/// ```
pub fn read_ply(bytes: &[u8], limits: &Limits) -> Result<Loaded, ReadError> {
    super::super::read(bytes, super::super::Format::Ply, limits)
}

pub(in crate::io) fn read(
    bytes: &[u8],
    limits: &Limits,
    watch: &mut Watch<'_, '_>,
) -> Result<Loaded, ReadError> {
    let mut notes = Notes::default();
    let header = header::read(bytes, &mut notes)?;
    let data = &bytes[header.end..];
    check_promises(&header, data.len() as u64, limits)?;
    let mut reader = Reader {
        soup: PolygonSoup::default(),
        uvs: Vec::new(),
        uvs_at: None,
        face_uvs: None,
        vertices: header.elements.iter().find(|e| e.name == b"vertex").map_or(0, |e| e.count),
        has_vertices: false,
        limits: *limits,
        notes,
    };
    match header.encoding {
        Encoding::Ascii => super::ascii::read(&mut reader, &header, data, watch)?,
        Encoding::Little | Encoding::Big => super::binary::read(&mut reader, &header, data, watch)?,
    }
    Ok(reader.finish())
}

/// Counts that the file cannot make good, or that the caller does not allow.
fn check_promises(header: &Header, room: u64, limits: &Limits) -> Result<(), ReadError> {
    let at_end = |reason| Err(ReadError::line(header.lines, reason));
    let Some(vertex) = header.elements.iter().find(|e| e.name == b"vertex") else {
        return at_end(Malformed::Header("has no vertices"));
    };
    if [b"x", b"y", b"z"].iter().any(|n| vertex.find(*n).is_none_or(|i| vertex.properties[i].list.is_some()))
    {
        return at_end(Malformed::Header("gives vertices no x, y and z"));
    }
    for face in header.elements.iter().filter(|e| e.name == b"face") {
        if face_list(face).is_none() && face.count > 0 {
            return at_end(Malformed::Header("gives faces no list of vertex indices"));
        }
    }
    for element in &header.elements {
        // An ASCII value takes a digit and a separator.
        let each = match header.encoding {
            Encoding::Ascii => 2 * element.properties.len() as u64,
            _ => element.fewest_bytes(),
        };
        let fits = (room + 1).checked_div(each).unwrap_or(0);
        if element.count > fits && element.count > 0 {
            return at_end(Malformed::Promise { what: "elements", wanted: element.count, room: fits });
        }
    }
    limits.check_vertices(vertex.count)?;
    header.elements.iter().filter(|e| e.name == b"face").try_for_each(|face| limits.check_faces(face.count))
}

fn face_list(face: &Element) -> Option<usize> {
    let named = face.find(b"vertex_indices").or(face.find(b"vertex_index"))?;
    let list = &face.properties[named];
    (list.list.is_some() && list.scalar.is_integer()).then_some(named)
}

/// Where the values of a vertex go.
pub(super) struct VertexLayout {
    position: [usize; 3],
    normal: Option<[usize; 3]>,
    /// With the value that stands for one.
    color: Option<([usize; 3], Option<usize>, f64)>,
    uv: Option<[usize; 2]>,
    is_complete: bool,
}

impl VertexLayout {
    /// `None` is ruled out by the check of the header.
    fn of(vertex: &Element) -> Option<Self> {
        let scalar = |name: &&[u8]| vertex.find(name).filter(|&i| vertex.properties[i].list.is_none());
        let three = |names: [&[u8]; 3]| {
            let [a, b, c] = names;
            Some([scalar(&a)?, scalar(&b)?, scalar(&c)?])
        };
        let color = three([b"red", b"green", b"blue"]).or(three([b"r", b"g", b"b"]));
        let color = color.map(|c| (c, scalar(&&b"alpha"[..]), vertex.properties[c[0]].scalar.full()));
        let pairs: [[&[u8]; 2]; 4] =
            [[b"s", b"t"], [b"u", b"v"], [b"texture_u", b"texture_v"], [b"s0", b"t0"]];
        let uv = pairs.iter().find_map(|[u, v]| Some([scalar(u)?, scalar(v)?]));
        let (position, normal) = (three([b"x", b"y", b"z"])?, three([b"nx", b"ny", b"nz"]));
        let alpha = color.is_some_and(|c| c.1.is_some());
        let used = 3
            + if normal.is_some() { 3 } else { 0 }
            + if color.is_some() { 3 } else { 0 }
            + usize::from(alpha)
            + if uv.is_some() { 2 } else { 0 };
        Some(Self { position, normal, color, uv, is_complete: used == vertex.properties.len() })
    }
}

/// What was read so far.
pub(super) struct Reader {
    soup: PolygonSoup,
    uvs: Vec<[f64; 2]>,
    /// Where they are said to be.
    uvs_at: Option<Place>,
    /// Those that faces give their corners, up to the last face that did.
    face_uvs: Option<CornerData<[f64; 2]>>,
    /// How many vertices the header promises.
    vertices: u64,
    /// Whether the element that holds them was met; any other of that name is left out.
    has_vertices: bool,
    limits: Limits,
    pub(super) notes: Notes,
}

impl Reader {
    /// Takes vertices of one size, the first of which begins at `byte`; `columns` is scratch.
    pub(super) fn take_vertices(
        &mut self,
        layout: &VertexLayout,
        records: &Records<'_>,
        byte: usize,
        columns: &mut [Vec<f64>; 4],
    ) {
        let soup = &mut self.soup;
        let first = soup.positions.len();
        soup.positions.extend(records.rows(layout.position, columns).map(DVec3::from_array));
        if soup.positions[first..].iter().any(|p| !p.is_finite()) {
            let odd = soup.positions[first..].iter().enumerate().filter(|(_, p)| !p.is_finite());
            for (i, _) in odd {
                let place = Place::Byte((byte + i * records.size) as u64);
                self.notes.add(NoteKind::NonFiniteCoordinate, place);
            }
        }
        if let Some([x, y, z]) = layout.normal {
            soup.vertex_normals.extend(records.rows([x, y, z], columns).map(DVec3::from_array));
        }
        if let Some(([r, g, b], alpha, full)) = layout.color {
            let part = |x: f64| (x / full) as f32;
            let colors = records.rows([r, g, b, alpha.unwrap_or(b)], columns).map(|rgba| rgba.map(part));
            soup.vertex_colors
                .extend(colors.map(|[r, g, b, a]| [r, g, b, if alpha.is_some() { a } else { 1.0 }]));
        }
        if let Some(uv) = layout.uv {
            self.uvs.extend(records.rows(uv, columns));
        }
    }

    /// How many more triangles the limits allow.
    pub(super) fn room_for_triangles(&self) -> u64 {
        let polygons = &self.soup.polygons;
        let faces = self.limits.faces.saturating_sub(polygons.len() as u64);
        faces.min(self.limits.corners.saturating_sub(polygons.corners().len() as u64) / 3)
    }

    /// Takes triangles, no more than there is [room](Self::room_for_triangles) for; each is as long as the others, and the
    /// first begins at `byte`.
    pub(super) fn take_triangles(
        &mut self,
        triangles: impl Iterator<Item = [u32; 3]>,
        byte: usize,
        size: usize,
    ) {
        let polygons = &mut self.soup.polygons;
        let first = polygons.corners().len();
        polygons.push_triangles(triangles);
        let corners = &polygons.corners()[first..];
        let vertices = self.vertices;
        let is_odd = |v: u32| u64::from(v) >= vertices;
        if is_odd(corners.iter().copied().max().unwrap_or(0)) {
            for (i, _) in corners.iter().enumerate().filter(|(_, v)| is_odd(**v)) {
                self.notes.add(NoteKind::IndexOutOfRange, Place::Byte((byte + i / 3 * size) as u64));
            }
        }
    }

    pub(super) fn take_vertex(&mut self, layout: &VertexLayout, value: impl Fn(usize) -> f64, place: Place) {
        let three = |at: [usize; 3]| DVec3::from(at.map(&value));
        let p = three(layout.position);
        if !p.is_finite() {
            self.notes.add(NoteKind::NonFiniteCoordinate, place);
        }
        self.soup.positions.push(p);
        if let Some(at) = layout.normal {
            self.soup.vertex_normals.push(three(at));
        }
        if let Some((rgb, alpha, full)) = layout.color {
            let part = |i: usize| (value(i) / full) as f32;
            let [r, g, b] = rgb.map(part);
            self.soup.vertex_colors.push([r, g, b, alpha.map_or(1.0, part)]);
        }
        if let Some(at) = layout.uv {
            self.uvs.push(at.map(&value));
        }
    }

    /// Takes a face with its texture coordinates, if it has any.
    pub(super) fn take_face(
        &mut self,
        corners: &[u32],
        texcoords: &[f64],
        place: Place,
    ) -> Result<(), ReadError> {
        self.limits.check_faces(self.soup.polygons.len() as u64 + 1)?;
        self.limits.check_corners((self.soup.polygons.corners().len() + corners.len()) as u64)?;
        for _ in corners.iter().filter(|&&v| u64::from(v) >= self.vertices) {
            self.notes.add(NoteKind::IndexOutOfRange, place);
        }
        if corners.len() < 3 {
            self.notes.add(NoteKind::ShortFace, place);
        }
        let (uvs, rest) = texcoords.as_chunks();
        if uvs.len() != corners.len() || !rest.is_empty() {
            if !texcoords.is_empty() {
                self.notes.add(NoteKind::TextureCoordinateCount, place);
            }
        } else if !uvs.is_empty() {
            let data = self.face_uvs.get_or_insert_default();
            data.indices.resize(self.soup.polygons.corners().len(), CornerData::<[f64; 2]>::NONE);
            let first = data.values.len() as u32;
            data.indices.extend(first..first + uvs.len() as u32);
            data.values.extend_from_slice(uvs);
        }
        self.soup.polygons.push(corners.iter().copied());
        Ok(())
    }

    /// What an element is to be read for; `room` is the number of bytes left.
    pub(super) fn role(&mut self, element: &Element, place: Place, room: usize) -> Role {
        if element.name == b"vertex" && !std::mem::replace(&mut self.has_vertices, true) {
            // The check of the header has seen that there is a layout.
            if let Some(layout) = VertexLayout::of(element) {
                if !layout.is_complete {
                    self.notes.add(NoteKind::Ignored, place);
                }
                self.uvs_at = layout.uv.map(|_| place);
                let count = element.count as usize;
                let room = |has: bool| if has { count } else { 0 };
                self.soup.positions.reserve(count);
                self.soup.vertex_normals.reserve(room(layout.normal.is_some()));
                self.soup.vertex_colors.reserve(room(layout.color.is_some()));
                self.uvs.reserve(room(layout.uv.is_some()));
                return Role::Vertex(layout);
            }
        }
        if let Some(corners) = face_list(element).filter(|_| element.name == b"face") {
            let texcoords = element.find(b"texcoord").filter(|&i| element.properties[i].list.is_some());
            let has_color = element.find(b"red").is_some();
            if has_color {
                self.notes.add(NoteKind::FaceColor, place);
            }
            let known = |name: &[u8]| [&b"red"[..], b"green", b"blue", b"alpha"].contains(&name) && has_color;
            let mut properties = element.properties.iter().enumerate();
            if properties.any(|(i, p)| i != corners && Some(i) != texcoords && !known(&p.name)) {
                self.notes.add(NoteKind::Ignored, place);
            }
            if self.soup.polygons.is_empty() {
                let count = element.count as usize;
                self.soup.polygons = Polygons::with_capacity(count, (3 * count).min(room));
            }
            return Role::Face { corners, texcoords };
        }
        if element.count > 0 {
            self.notes.add(NoteKind::Ignored, place);
        }
        Role::Other
    }

    fn finish(mut self) -> Loaded {
        if let Some(mut data) = self.face_uvs {
            data.indices.resize(self.soup.polygons.corners().len(), CornerData::<[f64; 2]>::NONE);
            self.soup.corner_uvs = Some(data);
            // Those of vertices as well are left out.
            self.uvs_at.into_iter().for_each(|place| self.notes.add(NoteKind::Ignored, place));
        } else if !self.uvs.is_empty() {
            self.soup.corner_uvs = Some(super::super::uvs_of_vertices(&self.soup.polygons, self.uvs));
        }
        Loaded { soup: self.soup, notes: self.notes.finish() }
    }
}

/// What an element is read for.
pub(super) enum Role {
    Vertex(VertexLayout),
    Face {
        /// The property that holds the vertex indices.
        corners: usize,
        /// The property that holds texture coordinates, two for each corner.
        texcoords: Option<usize>,
    },
    Other,
}
