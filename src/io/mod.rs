//! Files to and from [`PolygonSoup`]: OBJ, STL, PLY and OFF, under [`Limits`].
//!
//! Readers take bytes and promise nothing about what they return except that the file said it; what they skipped or
//! tolerated stands in [`Loaded::notes`] with its line or byte. Errors blame the source, the file, the caller or a
//! limit. OBJ, PLY and OFF keep coordinates exactly.

mod error;
mod limits;
mod obj;
mod off;
mod ply;
mod stl;
mod text;
mod watch;

pub use error::{Lost, Malformed, Note, NoteKind, Place, ReadError, WriteError};
pub use limits::Limits;
pub use obj::{read_obj, write_obj};
pub use off::{read_off, write_off};
pub use ply::{read_ply, write_ply, write_ply_ascii, write_ply_big_endian};
pub use stl::{read_stl, write_stl, write_stl_ascii};

use crate::{Cancelled, Control, CornerData, PolygonSoup, Polygons};
use glam::DVec3;
use std::borrow::Cow;
use std::fs::File;
use std::io::{Read, Write};
use std::path::Path;
use watch::{Watch, Watched};

/// What a file held.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Loaded {
    /// Its vertices and faces, in the file's numbering.
    pub soup: PolygonSoup,
    /// What was tolerated or left out, in the order of places.
    pub notes: Vec<Note>,
}

/// A file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Format {
    /// Wavefront OBJ.
    Obj,
    /// STL, ASCII or binary.
    Stl,
    /// PLY, ASCII or binary.
    Ply,
    /// OFF and its variants.
    Off,
}

/// How numbers are written, where a format offers a choice: STL and PLY. The default is the format's compact binary form.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Encoding {
    /// Binary, little-endian.
    #[default]
    Binary,
    /// Binary, big-endian: PLY only; others are written as [`Binary`](Self::Binary).
    BigEndian,
    /// Text.
    Ascii,
}

impl Format {
    /// By the name's extension, in any case.
    pub fn from_path(path: &Path) -> Option<Self> {
        Self::from_extension(path.extension()?.to_str()?)
    }

    /// By an extension without its dot, in any case.
    pub fn from_extension(extension: &str) -> Option<Self> {
        Some(match extension.to_ascii_lowercase().as_str() {
            "obj" => Self::Obj,
            "stl" => Self::Stl,
            "ply" => Self::Ply,
            "off" | "coff" | "noff" | "cnoff" => Self::Off,
            _ => return None,
        })
    }

    /// By the content, as far as it tells.
    pub fn detect(bytes: &[u8]) -> Option<Self> {
        const BEGINNING: usize = 4096;
        let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
        let text = &text[..text.len().min(BEGINNING)];
        let mut words = text::words(text);
        let first = words.next().unwrap_or_default();
        if first == b"ply" {
            Some(Self::Ply)
        } else if first.windows(3).take(4).any(|w| w == b"OFF") {
            Some(Self::Off)
        } else if stl::is_binary(bytes) || first.eq_ignore_ascii_case(b"solid") {
            Some(Self::Stl)
        } else {
            let is_statement = |l: &[u8]| {
                let keyword = text::words(l).next().unwrap_or_default();
                [&b"v"[..], b"vt", b"vn", b"f", b"o", b"g", b"usemtl", b"mtllib"].contains(&keyword)
            };
            text::Lines::new(text).any(|(_, l)| is_statement(l)).then_some(Self::Obj)
        }
    }
}

/// Reads a file's bytes in a given format.
///
/// # Errors
/// [`ReadError`].
///
/// # Examples
/// ```
/// use meshwright::io::{Format, Limits, read};
/// let bytes = b"OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
/// let format = Format::detect(bytes).expect("OFF says what it is");
/// assert_eq!(read(bytes, format, &Limits::default())?.soup.polygons.len(), 1);
/// # Ok::<(), meshwright::io::ReadError>(())
/// ```
pub fn read(bytes: &[u8], format: Format, limits: &Limits) -> Result<Loaded, ReadError> {
    read_with(bytes, format, limits, Control::none())
}

/// As [`read`], with a progress-and-cancel hook.
///
/// # Errors
/// [`ReadError`]; when cancelled.
///
/// # Examples
/// ```
/// use meshwright::{Control, Progress, io::{Format, Limits, ReadError, read_with}};
/// use std::ops::ControlFlow;
/// let mut stop = |_: Progress| ControlFlow::Break(());
/// let bytes = b"OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
/// let refused = read_with(bytes, Format::Off, &Limits::default(), Control::new(&mut stop));
/// assert!(matches!(refused, Err(ReadError::Cancelled(_))));
/// ```
pub fn read_with(
    bytes: &[u8],
    format: Format,
    limits: &Limits,
    mut control: Control<'_>,
) -> Result<Loaded, ReadError> {
    read_watched(bytes, format, limits, &mut control, 0.0)
}

/// Reads; `from` is the share of the whole call that is done already.
fn read_watched(
    bytes: &[u8],
    format: Format,
    limits: &Limits,
    control: &mut Control<'_>,
    from: f64,
) -> Result<Loaded, ReadError> {
    let mut watch = Watch::new(control, bytes.len(), from);
    watch.report(bytes.len())?;
    let loaded = match format {
        Format::Obj => obj::read(bytes, limits, &mut watch),
        Format::Stl => stl::read(bytes, limits, &mut watch),
        Format::Ply => ply::read(bytes, limits, &mut watch),
        Format::Off => off::read(bytes, limits, &mut watch),
    }?;
    watch.end()?;
    Ok(loaded)
}

/// Reads a file, by its name's extension, or by its content if the extension tells nothing.
///
/// # Errors
/// [`ReadError`].
///
/// # Examples
/// ```no_run
/// use meshwright::io::{Limits, read_file};
/// let loaded = read_file("bracket.stl", &Limits::default())?;
/// for note in &loaded.notes {
///     eprintln!("{note}");
/// }
/// # Ok::<(), meshwright::io::ReadError>(())
/// ```
pub fn read_file(path: impl AsRef<Path>, limits: &Limits) -> Result<Loaded, ReadError> {
    read_file_with(path, limits, Control::none())
}

/// As [`read_file`], with a progress-and-cancel hook, as [`read_with`].
///
/// # Errors
/// [`ReadError`]; when cancelled.
pub fn read_file_with(
    path: impl AsRef<Path>,
    limits: &Limits,
    mut control: Control<'_>,
) -> Result<Loaded, ReadError> {
    /// Bytes between two reports, and the share of the call that loading them all takes.
    const PIECE: u64 = 1 << 26;
    const LOADING: f64 = 0.2;
    control.report("load", 0.0)?;
    let path = path.as_ref();
    let file = File::open(path)?;
    let length = file.metadata()?.len();
    limits.check_bytes(length)?;
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(usize::try_from(length).unwrap_or(usize::MAX)).map_err(std::io::Error::from)?;
    // A pipe or a device has no length, and may have no end.
    let mut source = file.take(limits.bytes.saturating_add(1));
    while source.by_ref().take(PIECE).read_to_end(&mut bytes)? > 0 {
        let share = bytes.len() as f64 / length.max(1) as f64;
        control.report("load", LOADING * share.min(1.0))?;
    }
    limits.check_bytes(bytes.len() as u64)?;
    let format =
        Format::from_path(path).or_else(|| Format::detect(&bytes)).ok_or(ReadError::UnknownFormat)?;
    read_watched(&bytes, format, limits, &mut control, LOADING)
}

/// Writes a soup in a given format; returns what the format could not carry. The same soup gives the same bytes. Wants a
/// buffered sink.
///
/// # Errors
/// [`WriteError`].
///
/// # Examples
/// ```
/// use meshwright::{PolygonSoup, Polygons, glam::DVec3, io::{self, Encoding, Format}};
/// let soup = PolygonSoup::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], Polygons::from_triangles(&[[0, 1, 2]]));
/// let mut file = Vec::new();
/// let lost = io::write(&soup, Format::Ply, Encoding::Ascii, &mut file)?;
/// assert!(lost.is_empty());
/// # Ok::<(), io::WriteError>(())
/// ```
pub fn write(
    soup: &PolygonSoup,
    format: Format,
    encoding: Encoding,
    sink: &mut impl Write,
) -> Result<Vec<Lost>, WriteError> {
    match (format, encoding) {
        (Format::Obj, _) => write_obj(soup, sink),
        (Format::Off, _) => write_off(soup, sink),
        (Format::Stl, Encoding::Ascii) => write_stl_ascii(soup, sink),
        (Format::Stl, _) => write_stl(soup, sink),
        (Format::Ply, Encoding::Ascii) => write_ply_ascii(soup, sink),
        (Format::Ply, Encoding::BigEndian) => write_ply_big_endian(soup, sink),
        (Format::Ply, Encoding::Binary) => write_ply(soup, sink),
    }
}

/// As [`write`](fn@write), with a progress-and-cancel hook. What was written before it was cancelled stays in the sink.
///
/// # Errors
/// [`WriteError`]; when cancelled.
///
/// # Examples
/// ```
/// use meshwright::{Control, PolygonSoup, Progress, io::{self, Encoding, Format, WriteError}};
/// use std::ops::ControlFlow;
/// let mut stop = |_: Progress| ControlFlow::Break(());
/// let soup = PolygonSoup::default();
/// let refused =
///     io::write_with(&soup, Format::Obj, Encoding::Ascii, &mut Vec::new(), Control::new(&mut stop));
/// assert!(matches!(refused, Err(WriteError::Cancelled(_))));
/// ```
pub fn write_with(
    soup: &PolygonSoup,
    format: Format,
    encoding: Encoding,
    sink: &mut impl Write,
    mut control: Control<'_>,
) -> Result<Vec<Lost>, WriteError> {
    control.report("write", 0.0)?;
    let (vertices, faces) = (soup.positions.len() as u64, soup.polygons.len() as u64);
    let corners = soup.polygons.corners().len() as u64;
    let triangles = corners.saturating_sub(2 * faces);
    // Without attributes: only progress depends on it.
    let expected = match (format, encoding) {
        (Format::Stl, Encoding::Ascii) => 280 * triangles,
        (Format::Stl, _) => 50 * triangles,
        (Format::Ply, Encoding::Binary | Encoding::BigEndian) => 24 * vertices + faces + 4 * corners,
        _ => 56 * vertices + 8 * corners + 2 * faces,
    };
    let mut watched =
        Watched { sink, control: &mut control, written: 0, expected, next: 0, is_cancelled: false };
    let result = write(soup, format, encoding, &mut watched);
    if watched.is_cancelled { Err(Cancelled.into()) } else { result }
}

/// Refuses what a file could not say.
fn check_writable(soup: &PolygonSoup) -> Result<(), WriteError> {
    if let Some(vertex) = soup.positions.iter().position(|p| !p.is_finite()) {
        return Err(WriteError::NonFinite { vertex });
    }
    let count = soup.positions.len();
    for (face, corners) in soup.polygons.iter().enumerate() {
        if corners.len() < 3 {
            return Err(WriteError::ShortFace { face });
        }
        if let Some(corner) = corners.iter().position(|&v| v as usize >= count) {
            return Err(WriteError::IndexOutOfRange { face, corner });
        }
    }
    Ok(())
}

/// Data that stand one for each vertex, if there are any.
fn per_vertex<'s, T>(data: &'s [T], soup: &PolygonSoup) -> Option<&'s [T]> {
    (!data.is_empty() && data.len() == soup.positions.len()).then_some(data)
}

/// What stands at vertices: as it is given there, or as all corners of each vertex say the same.
struct VertexData<'s> {
    normals: Option<Cow<'s, [DVec3]>>,
    colors: Option<&'s [[f32; 4]]>,
    uvs: Option<Cow<'s, [[f64; 2]]>>,
}

impl<'s> VertexData<'s> {
    fn of(soup: &'s PolygonSoup) -> Self {
        let given = per_vertex(&soup.vertex_normals, soup).map(Cow::Borrowed);
        let of_corners =
            || at_vertices(soup, soup.corner_normals.as_ref()?, |n| n.to_array().map(f64::to_bits));
        let uvs = soup.corner_uvs.as_ref();
        Self {
            normals: given.or_else(of_corners),
            colors: per_vertex(&soup.vertex_colors, soup),
            uvs: uvs.and_then(|uvs| at_vertices(soup, uvs, |uv| uv.map(f64::to_bits))),
        }
    }

    fn kinds(&self, soup: &PolygonSoup) -> Vec<Lost> {
        // Beside vertex normals, those of corners are not looked at.
        let is_all = soup.vertex_normals.is_empty() || !has_values(soup.corner_normals.as_ref());
        let kinds = [
            (Lost::Normals, self.normals.is_some() && is_all),
            (Lost::Colors, self.colors.is_some()),
            (Lost::TextureCoordinates, self.uvs.is_some()),
        ];
        kinds.into_iter().filter(|k| k.1).map(|k| k.0).collect()
    }
}

/// The values of corners as those of vertices, if each vertex has one; the default where no corner names it.
fn at_vertices<'s, T: Copy + Default, B: PartialEq>(
    soup: &PolygonSoup,
    data: &'s CornerData<T>,
    bits: impl Fn(&T) -> B,
) -> Option<Cow<'s, [T]>> {
    let corners = soup.polygons.corners();
    if data.indices == corners && data.values.len() == soup.positions.len() {
        return Some(Cow::Borrowed(&data.values));
    }
    if data.indices.len() != corners.len() || corners.is_empty() {
        return None;
    }
    let mut of: Vec<Option<T>> = vec![None; soup.positions.len()];
    for (&v, &i) in corners.iter().zip(&data.indices) {
        let value = data.values.get(i as usize)?;
        let own = of.get_mut(v as usize)?.get_or_insert(*value);
        if bits(own) != bits(value) {
            return None;
        }
    }
    Some(of.into_iter().map(Option::unwrap_or_default).collect())
}

/// Whether a corner has a value.
fn has_values<T>(data: Option<&CornerData<T>>) -> bool {
    data.is_some_and(|d| d.indices.iter().any(|&i| (i as usize) < d.values.len()))
}

/// What the soup has beyond positions and faces, less what was carried.
fn lost(soup: &PolygonSoup, carried: &[Lost]) -> Vec<Lost> {
    let has = [
        (Lost::Normals, !soup.vertex_normals.is_empty() || has_values(soup.corner_normals.as_ref())),
        (Lost::Colors, !soup.vertex_colors.is_empty()),
        (Lost::TextureCoordinates, has_values(soup.corner_uvs.as_ref())),
        (Lost::Groups, !soup.groups.is_empty()),
        (Lost::MaterialFiles, !soup.material_files.is_empty()),
    ];
    has.into_iter().filter(|(kind, present)| *present && !carried.contains(kind)).map(|h| h.0).collect()
}

/// Texture coordinates that stand one for each vertex, as those of corners.
fn uvs_of_vertices(polygons: &Polygons, uvs: Vec<[f64; 2]>) -> CornerData<[f64; 2]> {
    let index = |v: &u32| if (*v as usize) < uvs.len() { *v } else { CornerData::<[f64; 2]>::NONE };
    CornerData { indices: polygons.corners().iter().map(index).collect(), values: uvs }
}
