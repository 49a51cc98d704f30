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

/// Elements between two looks at the hook: few enough to stay in the nearest memory.
const BLOCK: usize = 1024;

/// Vertices without lists: all of the same size.
fn take_vertices(
    reader: &mut Reader,
    input: &mut Input<'_>,
    element: &Element,
    layout: &VertexLayout,
    size: usize,
    watch: &mut Watch<'_, '_>,
) -> Result<(), ReadError> {
    let mut byte = input.start + input.at;
    let bytes = input.elements(element.count, size)?;
    let mut left = input.data.len() - input.at + bytes.len();
    let places = element.properties.iter().scan(0, |at, p| {
        let place = (p.scalar, *at);
        *at += p.scalar.size();
        Some(place)
    });
    let places: Vec<(Scalar, usize)> = places.collect();
    let mut columns = Default::default();
    for block in bytes.chunks(BLOCK * size) {
        watch.ticks(block.len() / size, left)?;
        let records = Records { bytes: block, size, places: &places, is_big: input.is_big };
        reader.take_vertices(layout, &records, byte, &mut columns);
        left -= block.len();
        byte += block.len();
    }
    Ok(())
}

/// Elements of one size.
pub(super) struct Records<'a> {
    bytes: &'a [u8],
    pub(super) size: usize,
    /// The type of each property, and where in an element it stands.
    places: &'a [(Scalar, usize)],
    is_big: bool,
}

impl Records<'_> {
    /// The values of a few properties, for each element; `columns` is scratch. A column is decoded at a time, so that types
    /// are not asked for with each value.
    pub(super) fn rows<'c, const N: usize>(
        &self,
        properties: [usize; N],
        columns: &'c mut [Vec<f64>; 4],
    ) -> impl Iterator<Item = [f64; N]> + 'c {
        const { assert!(N <= 4) };
        columns.iter_mut().zip(properties).for_each(|(column, i)| self.column(i, column));
        (0..columns[0].len()).map(|i| std::array::from_fn(|k| columns[k][i]))
    }

    fn column(&self, property: usize, values: &mut Vec<f64>) {
        values.clear();
        let Some(&(scalar, at)) = self.places.get(property) else { return };
        macro_rules! column {
            ($t:ty) => {{
                let fields = self.bytes.chunks_exact(self.size).filter_map(|r| r[at..].first_chunk());
                if self.is_big {
                    values.extend(fields.map(|b| f64::from(<$t>::from_be_bytes(*b))));
                } else {
                    values.extend(fields.map(|b| f64::from(<$t>::from_le_bytes(*b))));
                }
            }};
        }
        match scalar {
            Scalar::I8 => column!(i8),
            Scalar::U8 => column!(u8),
            Scalar::I16 => column!(i16),
            Scalar::U16 => column!(u16),
            Scalar::I32 => column!(i32),
            Scalar::U32 => column!(u32),
            Scalar::F32 => column!(f32),
            Scalar::F64 => column!(f64),
        }
    }
}

/// A triangle as nearly all files have it: a byte that counts, and three indices of 32 bits.
const TRIANGLE: usize = 13;

/// Whether triangles of an element may be such.
fn has_plain_triangles(element: &Element, role: &Role) -> bool {
    matches!(role, Role::Face { .. })
        && matches!(&element.properties[..],
            [p] if p.list == Some(Scalar::U8) && matches!(p.scalar, Scalar::I32 | Scalar::U32))
}

/// Takes triangles in a row, at most `most`, as long as the next face is one; how many there were.
fn take_triangles(
    reader: &mut Reader,
    input: &mut Input<'_>,
    scalar: Scalar,
    most: u64,
    watch: &mut Watch<'_, '_>,
) -> Result<u64, ReadError> {
    let most = most.min(reader.room_for_triangles());
    let (records, _) = input.data[input.at..].as_chunks::<TRIANGLE>();
    let records = &records[..records.len().min(usize::try_from(most).unwrap_or(usize::MAX))];
    let (is_signed, is_big) = (scalar == Scalar::I32, input.is_big);
    let mut taken = 0;
    for block in records.chunks(BLOCK) {
        let run = block.iter().position(|r| r[0] != 3).unwrap_or(block.len());
        watch.ticks(run, input.data.len() - input.at)?;
        let triangles = block[..run].iter().map(|r| {
            let (corners, _) = r[1..].as_chunks();
            [corners[0], corners[1], corners[2]].map(|b| {
                let index = if is_big { u32::from_be_bytes(b) } else { u32::from_le_bytes(b) };
                if is_signed && index > i32::MAX as u32 { PolygonSoup::NO_VERTEX } else { index }
            })
        });
        reader.take_triangles(triangles, input.start + input.at, TRIANGLE);
        input.at += run * TRIANGLE;
        taken += run as u64;
        if run < block.len() {
            break;
        }
    }
    Ok(taken)
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
    let is_plain = has_plain_triangles(element, role);
    let mut left = element.count;
    loop {
        if is_plain {
            left -= take_triangles(reader, input, element.properties[0].scalar, left, watch)?;
        }
        if left == 0 {
            break;
        }
        left -= 1;
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
