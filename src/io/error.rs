//! Who is to blame: the source, the file, the caller, or a limit; and notes on what was tolerated.

use crate::Cancelled;
use std::collections::BTreeMap;
use std::fmt;

/// Where in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Place {
    /// A line of a text file, counted from 1.
    Line(u64),
    /// A byte of a binary file, counted from 0.
    Byte(u64),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(n) => write!(f, "line {n}"),
            Self::Byte(n) => write!(f, "byte {n}"),
        }
    }
}

/// What a reader tolerated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, thiserror::Error)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum NoteKind {
    /// A coordinate is NaN or infinite; kept.
    #[error("coordinates that are not finite")]
    NonFiniteCoordinate,
    /// A face index is zero, negative beyond the beginning, or beyond the vertices; kept as an index that names none.
    #[error("face indices that name no vertex")]
    IndexOutOfRange,
    /// A face has fewer than three corners; kept.
    #[error("faces of fewer than three corners")]
    ShortFace,
    /// Some vertices have colours and some have none; those are white.
    #[error("vertices without a colour beside some that have one, white")]
    MissingColor,
    /// A texture or normal index names nothing; that corner has no value.
    #[error("texture or normal indices that name nothing, left out")]
    AttributeOutOfRange,
    /// The texture coordinates of a face are not two numbers for each corner; left out.
    #[error("texture coordinates that do not fit their face, left out")]
    TextureCoordinateCount,
    /// Statements, elements or properties that a mesh has no place for.
    #[error("statements or properties that a mesh has no place for, left out")]
    Ignored,
    /// Point and line elements; left out.
    #[error("points or lines, left out")]
    PointOrLine,
    /// Colours of faces; left out.
    #[error("face colours, left out")]
    FaceColor,
    /// Data after the promised end; left out.
    #[error("data after the end, left out")]
    TrailingData,
    /// The closing statement of an ASCII STL is missing; everything before was read.
    #[error("a missing closing statement")]
    MissingEnd,
    /// Comments where the format allows none; skipped.
    #[error("comments where the format allows none, skipped")]
    StrayComment,
    /// Bytes that are no text; read as unknown characters.
    #[error("bytes that are no text")]
    NotText,
}

/// Something a reader tolerated: the first place, and how often in all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Note {
    /// What.
    pub kind: NoteKind,
    /// Where first.
    pub place: Place,
    /// How often.
    pub count: u64,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.kind)?;
        if self.count > 1 { write!(f, " ({} in all)", self.count) } else { Ok(()) }
    }
}

/// Collects notes, one per kind, so that no file can make them grow.
#[derive(Clone, Debug, Default)]
pub(super) struct Notes(BTreeMap<NoteKind, Note>);

impl Notes {
    pub(super) fn add(&mut self, kind: NoteKind, place: Place) {
        self.0.entry(kind).or_insert(Note { kind, place, count: 0 }).count += 1;
    }

    /// In the order of first places.
    pub(super) fn finish(self) -> Vec<Note> {
        let mut notes: Vec<Note> = self.0.into_values().collect();
        notes.sort_by_key(|n| (n.place, n.kind));
        notes
    }
}

/// Why a file makes no sense.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Malformed {
    /// The file holds nothing.
    #[error("the file is empty")]
    Empty,
    /// The beginning is not that of the format.
    #[error("this is not the beginning of {0}")]
    Beginning(&'static str),
    /// Something else was expected.
    #[error("expected {0}")]
    Expected(&'static str),
    /// A number cannot be read.
    #[error("{0:?} is not a number")]
    Number(String),
    /// The file ends before what it promises.
    #[error("the file ends within {0}")]
    Truncated(&'static str),
    /// A count promises more than the file can hold.
    #[error("{wanted} {what} are promised, the file has room for {room}")]
    Promise {
        /// Of what.
        what: &'static str,
        /// How many are promised.
        wanted: u64,
        /// How many would fit.
        room: u64,
    },
    /// The header of a PLY file does not describe a mesh.
    #[error("the header {0}")]
    Header(&'static str),
    /// The text is in an encoding other than ASCII or UTF-8.
    #[error("the text is UTF-16")]
    Utf16,
}

/// Why a file was not read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The source failed.
    #[error("cannot read: {0}")]
    Io(#[from] std::io::Error),
    /// The file is not what it should be.
    #[error("{place}: {reason}")]
    Malformed {
        /// Where.
        place: Place,
        /// Why.
        reason: Malformed,
    },
    /// The file is of a kind that this crate does not read.
    #[error("{place}: {what} is not supported")]
    Unsupported {
        /// Where that is said.
        place: Place,
        /// What it is.
        what: &'static str,
    },
    /// Neither name nor content tell a format this crate reads.
    #[error("not a format that can be read here")]
    UnknownFormat,
    /// The file is larger than the caller allows.
    #[error("{wanted} {what} are more than the limit of {allowed}")]
    Limit {
        /// Of what.
        what: &'static str,
        /// How many the file has, or promises.
        wanted: u64,
        /// How many the caller allows.
        allowed: u64,
    },
    /// The hook said stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ReadError {
    pub(super) fn line(line: u64, reason: Malformed) -> Self {
        Self::Malformed { place: Place::Line(line), reason }
    }

    pub(super) fn byte(byte: usize, reason: Malformed) -> Self {
        Self::Malformed { place: Place::Byte(byte as u64), reason }
    }

    /// Where in the file, if the file is to blame.
    pub fn place(&self) -> Option<Place> {
        match self {
            Self::Malformed { place, .. } | Self::Unsupported { place, .. } => Some(*place),
            _ => None,
        }
    }
}

/// Why a file was not written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The sink failed.
    #[error("cannot write: {0}")]
    Io(#[from] std::io::Error),
    /// A corner names no vertex; a file with it could not be read back.
    #[error("corner {corner} of face {face} names no vertex")]
    IndexOutOfRange {
        /// The face.
        face: usize,
        /// Which of its corners, counted from 0.
        corner: usize,
    },
    /// A face has fewer than three corners.
    #[error("face {face} has fewer than three corners")]
    ShortFace {
        /// The face.
        face: usize,
    },
    /// A position is NaN or infinite.
    #[error("vertex {vertex} is not finite")]
    NonFinite {
        /// The vertex.
        vertex: usize,
    },
    /// A position is too large for the single precision that binary STL has.
    #[error("vertex {vertex} is beyond single precision")]
    BeyondSingle {
        /// The vertex.
        vertex: usize,
    },
    /// More elements than the format can count.
    #[error("{count} {what} are more than the format can count")]
    TooLarge {
        /// Of what.
        what: &'static str,
        /// How many.
        count: usize,
    },
    /// The hook said stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// What a format could not carry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, thiserror::Error)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Lost {
    /// Which vertices are shared: every face has corners of its own, and vertices at one place merge on reading.
    #[error("which vertices faces share: vertices at the same place will merge when the file is read")]
    SharedVertices,
    /// Digits of coordinates beyond single precision.
    #[error("digits of coordinates beyond single precision")]
    Precision,
    /// Polygons, cut into triangles.
    #[error("polygons of more than three corners: cut into triangles")]
    Polygons,
    /// Vertices that no face names.
    #[error("vertices that no face names")]
    IsolatedVertices,
    /// Vertex or corner normals.
    #[error("normals")]
    Normals,
    /// Colours.
    #[error("colours")]
    Colors,
    /// How transparent colours are.
    #[error("the transparency of colours")]
    Transparency,
    /// Texture coordinates.
    #[error("texture coordinates")]
    TextureCoordinates,
    /// Groups and materials.
    #[error("groups and materials")]
    Groups,
    /// Normals of vertices that no corner has, because corners have their own or there are none.
    #[error("normals of vertices beside those of corners")]
    VertexNormals,
    /// The names of files that describe materials.
    #[error("the names of material files")]
    MaterialFiles,
}
