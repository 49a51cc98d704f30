//! Elements as bytes, one behind the other.

use super::super::error::{Malformed, NoteKind, Place, ReadError};
use super::super::watch::Watch;
use super::header::{Element, Encoding, Header, Scalar};
use super::read::{Reader, Role, VertexLayout};
use crate::PolygonSoup;

pub(super) fn read(
    reader: &mut Reader,
    header: &Header,
    data: &[u8],
    watch: &mut Watch<'_, '_>,
) -> Result<(), ReadError> {
    let mut input = Input { data, at: 0, start: header.end, is_big: header.encoding == Encoding::Big };
    for element in &header.elements {
        let role = reader.role(element, input.place(), data.len() - input.at);
        match (&role, element.fixed_bytes()) {
            (Role::Vertex(layout), Some(size)) => {
                take_vertices(reader, &mut input, element, layout, size, watch)?;
            }
            (Role::Other, Some(size)) => {
                input.elements(element.count, size)?;
            }
            _ => read_varying(reader, &mut input, element, &role, watch)?,
        }
    }
    if input.at < data.len() {
        reader.notes.add(NoteKind::TrailingData, input.place());
    }
    Ok(())
}

/// Vertices without lists: all of the same size.
fn take_vertices(
    reader: &mut Reader,
    input: &mut Input<'_>,
    element: &Element,
    layout: &VertexLayout,
    size: usize,
    watch: &mut Watch<'_, '_>,
) -> Result<(), ReadError> {
    let first = input.start + input.at;
    let bytes = input.elements(element.count, size)?;
    let places: Vec<(Scalar, usize)> = element
        .properties
        .iter()
        .scan(0, |at, p| {
            let place = (p.scalar, *at);
            *at += p.scalar.size();
            Some(place)
        })
        .collect();
    let is_big = input.is_big;
    let left = input.data.len() - input.at + bytes.len();
    for (i, vertex) in bytes.chunks_exact(size).enumerate() {
        watch.tick(left - i * size)?;
        let value = |property: usize| {
            let value =
                places.get(property).and_then(|&(scalar, at)| scalar.decode(vertex.get(at..)?, is_big));
            value.unwrap_or_default()
        };
        reader.take_vertex(layout, value, Place::Byte((first + i * size) as u64));
    }
    Ok(())
}

/// Elements with lists.
fn read_varying(
    reader: &mut Reader,
    input: &mut Input<'_>,
    element: &Element,
    role: &Role,
    watch: &mut Watch<'_, '_>,
) -> Result<(), ReadError> {
    let (mut values, mut corners, mut texcoords) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..element.count {
        watch.tick(input.data.len() - input.at)?;
        let start = input.at;
        let place = input.place();
        values.clear();
        texcoords.clear();
        for (i, property) in element.properties.iter().enumerate() {
            let Some(count) = property.list else {
                values.push(input.value(property.scalar, start)?);
                continue;
            };
            values.push(0.0);
            let length = input.value(count, start)?;
            if length < 0.0 {
                return Err(ReadError::byte(
                    input.start + start,
                    Malformed::Expected("a list of no negative length"),
                ));
            }
            // Below 2^32 times 8: fits.
            let bytes = input.bytes(length as usize * property.scalar.size(), start)?;
            match role {
                Role::Face { corners: list, .. } if *list == i => {
                    corners.clear();
                    property.scalar.decode_indices(bytes, input.is_big, &mut corners);
                }
                Role::Face { texcoords: Some(list), .. } if *list == i => {
                    let each = bytes.chunks_exact(property.scalar.size());
                    texcoords.extend(each.filter_map(|b| property.scalar.decode(b, input.is_big)));
                }
                _ => {}
            }
        }
        match role {
            Role::Vertex(layout) => {
                reader.take_vertex(layout, |i| values.get(i).copied().unwrap_or_default(), place);
            }
            Role::Face { .. } => reader.take_face(&corners, &texcoords, place)?,
            Role::Other => {}
        }
    }
    Ok(())
}

struct Input<'a> {
    data: &'a [u8],
    at: usize,
    /// Where the data begin in the file.
    start: usize,
    is_big: bool,
}

impl<'a> Input<'a> {
    fn place(&self) -> Place {
        Place::Byte((self.start + self.at) as u64)
    }

    /// The next bytes of the element that begins at `element`.
    fn bytes(&mut self, count: usize, element: usize) -> Result<&'a [u8], ReadError> {
        let bytes = self.data.get(self.at..).and_then(|d| d.get(..count));
        let truncated = ReadError::byte(self.start + element, Malformed::Truncated("an element"));
        self.at += bytes.map_or(0, <[u8]>::len);
        bytes.ok_or(truncated)
    }

    fn value(&mut self, scalar: Scalar, element: usize) -> Result<f64, ReadError> {
        let bytes = self.bytes(scalar.size(), element)?;
        Ok(scalar.decode(bytes, self.is_big).unwrap_or_default())
    }

    /// The bytes of many elements of one size.
    fn elements(&mut self, count: u64, size: usize) -> Result<&'a [u8], ReadError> {
        let room = (self.data.len() - self.at).checked_div(size).unwrap_or(0);
        let broken = self.at + room * size;
        match usize::try_from(count).ok().filter(|c| *c <= room) {
            Some(count) => self.bytes(count * size, self.at),
            None => Err(ReadError::byte(self.start + broken, Malformed::Truncated("an element"))),
        }
    }
}

impl Scalar {
    /// Appends the indices that an array of this type holds; what cannot be an index becomes the one that names nothing.
    fn decode_indices(self, bytes: &[u8], is_big: bool, indices: &mut Vec<u32>) {
        macro_rules! decode {
            ($t:ty) => {{
                let (chunks, _) = bytes.as_chunks();
                let index = |n: $t| u32::try_from(n).unwrap_or(PolygonSoup::NO_VERTEX);
                if is_big {
                    indices.extend(chunks.iter().map(|b| index(<$t>::from_be_bytes(*b))));
                } else {
                    indices.extend(chunks.iter().map(|b| index(<$t>::from_le_bytes(*b))));
                }
            }};
        }
        match self {
            Self::I8 => decode!(i8),
            Self::U8 => indices.extend(bytes.iter().map(|&n| u32::from(n))),
            Self::I16 => decode!(i16),
            Self::U16 => {
                indices.extend(
                    bytes.as_chunks().0.iter().map(|b| {
                        u32::from(if is_big { u16::from_be_bytes(*b) } else { u16::from_le_bytes(*b) })
                    }),
                )
            }
            Self::I32 => decode!(i32),
            Self::U32 => indices.extend(
                bytes
                    .as_chunks()
                    .0
                    .iter()
                    .map(|b| if is_big { u32::from_be_bytes(*b) } else { u32::from_le_bytes(*b) }),
            ),
            // Ruled out when the property was chosen.
            Self::F32 | Self::F64 => {}
        }
    }
}
