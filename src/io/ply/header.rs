//! The header of a PLY file.

use super::super::error::{Malformed, NoteKind, Notes, Place, ReadError};
use super::super::text::{integer, words};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    Little,
    Big,
}

/// A number type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn named(word: &[u8]) -> Option<Self> {
        Some(match word {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    pub(super) fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }

    /// The largest value that stands for one in a colour.
    pub(super) fn full(self) -> f64 {
        match self {
            Self::I8 => 127.0,
            Self::U8 => 255.0,
            Self::I16 => 32767.0,
            Self::U16 => 65535.0,
            Self::I32 => 2_147_483_647.0,
            Self::U32 => 4_294_967_295.0,
            Self::F32 | Self::F64 => 1.0,
        }
    }

    /// A value of this type from the bytes it begins with; all values fit an `f64`. `None` if there are too few.
    pub(super) fn decode(self, bytes: &[u8], big: bool) -> Option<f64> {
        macro_rules! decode {
            ($t:ty) => {{
                let b = bytes.get(..size_of::<$t>())?.try_into().ok()?;
                f64::from(if big { <$t>::from_be_bytes(b) } else { <$t>::from_le_bytes(b) })
            }};
        }
        Some(match self {
            Self::I8 => decode!(i8),
            Self::U8 => decode!(u8),
            Self::I16 => decode!(i16),
            Self::U16 => decode!(u16),
            Self::I32 => decode!(i32),
            Self::U32 => decode!(u32),
            Self::F32 => decode!(f32),
            Self::F64 => decode!(f64),
        })
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Property {
    pub(super) name: Vec<u8>,
    /// The type of the count, if it is a list.
    pub(super) list: Option<Scalar>,
    pub(super) scalar: Scalar,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Element {
    pub(super) name: Vec<u8>,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

impl Element {
    /// The fewest bytes one of them takes in a binary file.
    pub(super) fn fewest_bytes(&self) -> u64 {
        self.properties.iter().map(|p| p.list.unwrap_or(p.scalar).size() as u64).sum()
    }

    /// The bytes each of them takes in a binary file, if there are no lists.
    pub(super) fn fixed_bytes(&self) -> Option<usize> {
        self.properties.iter().map(|p| p.list.is_none().then_some(p.scalar.size())).sum()
    }

    pub(super) fn find(&self, name: &[u8]) -> Option<usize> {
        self.properties.iter().position(|p| p.name == name)
    }
}

#[derive(Clone, Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Where the data begin.
    pub(super) end: usize,
    /// How many lines the header has.
    pub(super) lines: u64,
}

/// Reads a header. Lines may end in `\n`, `\r\n` or a lone `\r`, be empty, or be indented.
pub(super) fn read(bytes: &[u8], notes: &mut Notes) -> Result<Header, ReadError> {
    if bytes.is_empty() {
        return Err(ReadError::line(1, Malformed::Empty));
    }
    let mut header = Header { encoding: Encoding::Ascii, elements: Vec::new(), end: 0, lines: 0 };
    let mut has_format = false;
    let mut in_comment = false;
    loop {
        let rest = &bytes[header.end..];
        let Some(length) = rest.iter().position(|&b| b == b'\n' || b == b'\r') else {
            return Err(ReadError::line(header.lines + 1, Malformed::Truncated("the header")));
        };
        let content = &rest[..length];
        header.lines += 1;
        header.end += length + 1;
        let line = header.lines;
        let malformed = |reason| Err(ReadError::line(line, reason));
        // A `\r\n`; but after `end_header\r` a newline may be the first byte of the data, see below.
        let is_pair = rest[length..].starts_with(b"\r\n");
        let mut words = words(content);
        let keyword = words.next();
        if line == 1 {
            if keyword != Some(b"ply") {
                return malformed(Malformed::Beginning("a PLY file"));
            }
            header.end += usize::from(is_pair);
            continue;
        }
        if in_comment || content.trim_ascii_start().starts_with(b"{") {
            // Remarks in braces stand in an old description of the format.
            in_comment = !content.trim_ascii_end().ends_with(b"}");
            notes.add(NoteKind::StrayComment, Place::Line(line));
            header.end += usize::from(is_pair);
            continue;
        }
        match keyword {
            Some(b"end_header") => {
                // Lone carriage returns so far mean that a newline here belongs to the data.
                let lone = bytes[..header.end - 1].contains(&b'\r')
                    && !bytes[..header.end].windows(2).any(|w| w == b"\r\n");
                if is_pair && !lone {
                    header.end += 1;
                }
                break;
            }
            Some(b"format") => {
                has_format = true;
                header.encoding = match words.next() {
                    Some(b"ascii") => Encoding::Ascii,
                    Some(b"binary_little_endian") => Encoding::Little,
                    Some(b"binary_big_endian") => Encoding::Big,
                    _ => {
                        return malformed(Malformed::Expected(
                            "ascii, binary_little_endian or binary_big_endian",
                        ));
                    }
                };
            }
            Some(b"element") => {
                let (name, count) = (words.next(), words.next());
                let count = count.and_then(integer).and_then(|n| u64::try_from(n).ok());
                let (Some(name), Some(count)) = (name, count) else {
                    return malformed(Malformed::Expected("the name and number of an element"));
                };
                header.elements.push(Element { name: name.to_vec(), count, properties: Vec::new() });
            }
            Some(b"property") => {
                let Some(element) = header.elements.last_mut() else {
                    return malformed(Malformed::Header("has a property before any element"));
                };
                element.properties.push(
                    property(words).ok_or(ReadError::line(
                        line,
                        Malformed::Expected("the type and name of a property"),
                    ))?,
                );
            }
            Some(b"comment" | b"obj_info") | None => {}
            Some(_) => return malformed(Malformed::Expected("a statement of a PLY header")),
        }
        header.end += usize::from(is_pair);
    }
    if !has_format {
        return Err(ReadError::line(header.lines, Malformed::Header("has no format")));
    }
    Ok(header)
}

fn property<'a>(mut words: impl Iterator<Item = &'a [u8]>) -> Option<Property> {
    let first = words.next()?;
    let list = match first {
        b"list" => Some(Scalar::named(words.next()?).filter(|t| t.is_integer())?),
        _ => None,
    };
    let scalar = Scalar::named(if list.is_some() { words.next()? } else { first })?;
    Some(Property { name: words.next()?.to_vec(), list, scalar })
}
