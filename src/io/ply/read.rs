//! Reading PLY.

use super::super::error::{Malformed, NoteKind, Notes, Place, ReadError};
use super::super::text::{Lines, number_at, shown, words};
use super::super::{Limits, Loaded};
use super::header::{self, Element, Encoding, Header, Scalar};
use crate::{CornerData, PolygonSoup};
use glam::DVec3;

/// Reads a PLY file: positions, vertex normals, colours and texture coordinates, faces of any degree. Elements may come in
/// any order. O(bytes).
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
    let mut notes = Notes::default();
    let header = header::read(bytes, &mut notes)?;
    let data = &bytes[header.end..];
    check_promises(&header, data.len() as u64, limits)?;
    let mut reader = Reader {
        soup: PolygonSoup::default(),
        uvs: Vec::new(),
        vertices: header.elements.iter().find(|e| e.name == b"vertex").map_or(0, |e| e.count),
        limits: *limits,
        notes,
    };
    match header.encoding {
        Encoding::Ascii => reader.read_ascii(&header, data)?,
        Encoding::Little | Encoding::Big => reader.read_binary(&header, data)?,
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
struct VertexLayout {
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

struct Reader {
    soup: PolygonSoup,
    uvs: Vec<[f64; 2]>,
    vertices: u64,
    limits: Limits,
    notes: Notes,
}

impl Reader {
    fn take_vertex(&mut self, layout: &VertexLayout, values: &[f64], place: Place) {
        let three = |at: [usize; 3]| DVec3::from(at.map(|i| values[i]));
        let p = three(layout.position);
        if !p.is_finite() {
            self.notes.add(NoteKind::NonFiniteCoordinate, place);
        }
        self.soup.positions.push(p);
        self.soup.vertex_normals.extend(layout.normal.map(three));
        if let Some((rgb, alpha, full)) = layout.color {
            let [r, g, b] = rgb.map(|i| (values[i] / full) as f32);
            self.soup.vertex_colors.push([r, g, b, alpha.map_or(1.0, |i| (values[i] / full) as f32)]);
        }
        self.uvs.extend(layout.uv.map(|at| at.map(|i| values[i])));
    }

    fn take_face(&mut self, indices: &[f64], place: Place) -> Result<(), ReadError> {
        self.limits.check_faces(self.soup.polygons.len() as u64 + 1)?;
        self.limits.check_corners((self.soup.polygons.corners().len() + indices.len()) as u64)?;
        let (vertices, notes) = (self.vertices as f64, &mut self.notes);
        self.soup.polygons.push(indices.iter().map(|&i| {
            let inside = i >= 0.0 && i < vertices;
            if !inside {
                notes.add(NoteKind::IndexOutOfRange, place);
            }
            // What does not fit becomes the index that names nothing.
            if i >= 0.0 { i as u32 } else { PolygonSoup::NO_VERTEX }
        }));
        if indices.len() < 3 {
            self.notes.add(NoteKind::ShortFace, place);
        }
        Ok(())
    }

    /// What an element is to be read for.
    fn role(&mut self, element: &Element, place: Place) -> Role {
        if element.name == b"vertex"
            && self.soup.positions.is_empty()
            && let Some(layout) = VertexLayout::of(element)
        {
            if !layout.is_complete {
                self.notes.add(NoteKind::Ignored, place);
            }
            self.soup.positions.reserve(element.count as usize);
            return Role::Vertex(layout);
        }
        match face_list(element).filter(|_| element.name == b"face") {
            Some(list) => {
                if element.properties.len() > 1 {
                    self.notes.add(NoteKind::Ignored, place);
                }
                Role::Face(list)
            }
            None => {
                if element.count > 0 {
                    self.notes.add(NoteKind::Ignored, place);
                }
                Role::Other
            }
        }
    }

    fn read_binary(&mut self, header: &Header, data: &[u8]) -> Result<(), ReadError> {
        let big = header.encoding == Encoding::Big;
        let mut at = 0;
        let mut values: Vec<f64> = Vec::new();
        let mut list: Vec<f64> = Vec::new();
        for element in &header.elements {
            let role = self.role(element, Place::Byte((header.end + at) as u64));
            for _ in 0..element.count {
                let start = header.end + at;
                let truncated = || ReadError::byte(start, Malformed::Truncated("an element"));
                values.clear();
                for (i, property) in element.properties.iter().enumerate() {
                    let Some(count) = property.list else {
                        values.push(property.scalar.decode(&data[at..], big).ok_or_else(truncated)?);
                        at += property.scalar.size();
                        continue;
                    };
                    let length = count.decode(&data[at..], big).ok_or_else(truncated)?;
                    at += count.size();
                    if length < 0.0 {
                        return Err(ReadError::byte(
                            start,
                            Malformed::Expected("a list of no negative length"),
                        ));
                    }
                    let size = property.scalar.size();
                    // Below 2^32 times 8: fits.
                    let bytes =
                        data.get(at..).and_then(|d| d.get(..length as usize * size)).ok_or_else(truncated)?;
                    at += bytes.len();
                    if matches!(role, Role::Face(l) if l == i) {
                        list.clear();
                        list.extend(bytes.chunks_exact(size).filter_map(|b| property.scalar.decode(b, big)));
                    }
                    // Keeps the places of later values.
                    values.push(0.0);
                }
                let place = Place::Byte(start as u64);
                match &role {
                    Role::Vertex(layout) => self.take_vertex(layout, &values, place),
                    Role::Face(_) => self.take_face(&list, place)?,
                    Role::Other => {}
                }
            }
        }
        if at < data.len() {
            self.notes.add(NoteKind::TrailingData, Place::Byte((header.end + at) as u64));
        }
        Ok(())
    }

    fn read_ascii(&mut self, header: &Header, data: &[u8]) -> Result<(), ReadError> {
        let mut lines = Lines::new(data).map(|(n, l)| (n + header.lines, l));
        let mut last = header.lines;
        let mut in_comment = false;
        let mut next_line = |notes: &mut Notes| {
            for (number, line) in lines.by_ref() {
                let content = line.trim_ascii();
                if in_comment || content.starts_with(b"{") || content.starts_with(b"comment") {
                    in_comment = (in_comment || content.starts_with(b"{")) && !content.contains(&b'}');
                    notes.add(NoteKind::StrayComment, Place::Line(number));
                } else if !content.is_empty() {
                    last = number;
                    // Remarks in braces may follow the values.
                    let end = content.iter().position(|&b| b == b'{').unwrap_or(content.len());
                    if end < content.len() {
                        notes.add(NoteKind::StrayComment, Place::Line(number));
                    }
                    return Ok((number, &content[..end]));
                }
            }
            Err(ReadError::line(last, Malformed::Truncated("the elements")))
        };
        let (mut values, mut list): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
        for element in &header.elements {
            let role = self.role(element, Place::Line(header.lines));
            for _ in 0..element.count {
                if element.properties.is_empty() {
                    continue;
                }
                let (line, content) = next_line(&mut self.notes)?;
                let mut words = words(content);
                let mut value = |whole: bool| {
                    let Some(word) = words.next() else {
                        return Err(ReadError::line(line, Malformed::Truncated("an element")));
                    };
                    let value = number_at(line, word)?;
                    let fits = !whole || value.fract() == 0.0;
                    if fits { Ok(value) } else { Err(ReadError::line(line, Malformed::Number(shown(word)))) }
                };
                let whole = |scalar: Scalar| scalar.is_integer();
                values.clear();
                for (i, property) in element.properties.iter().enumerate() {
                    if property.list.is_none() {
                        values.push(value(whole(property.scalar))?);
                        continue;
                    }
                    let length = value(true)?;
                    if !(0.0..=content.len() as f64).contains(&length) {
                        return Err(ReadError::line(line, Malformed::Truncated("a list")));
                    }
                    let mut items = Vec::new();
                    for _ in 0..length as usize {
                        items.push(value(whole(property.scalar))?);
                    }
                    if matches!(role, Role::Face(l) if l == i) {
                        list = items;
                    }
                    values.push(0.0);
                }
                let place = Place::Line(line);
                if words.next().is_some() {
                    return Err(ReadError::line(line, Malformed::Expected("no more values than properties")));
                }
                match &role {
                    Role::Vertex(layout) => self.take_vertex(layout, &values, place),
                    Role::Face(_) => self.take_face(&list, place)?,
                    Role::Other => {}
                }
            }
        }
        if let Ok((line, _)) = next_line(&mut self.notes) {
            self.notes.add(NoteKind::TrailingData, Place::Line(line));
        }
        Ok(())
    }

    fn finish(mut self) -> Loaded {
        if !self.uvs.is_empty() {
            let corners = self.soup.polygons.corners().iter();
            let indices =
                corners.map(|&v| if (v as usize) < self.uvs.len() { v } else { CornerData::<f64>::NONE });
            self.soup.corner_uvs = Some(CornerData { indices: indices.collect(), values: self.uvs });
        }
        Loaded { soup: self.soup, notes: self.notes.finish() }
    }
}

enum Role {
    Vertex(VertexLayout),
    /// With the property that holds the vertex indices.
    Face(usize),
    Other,
}
