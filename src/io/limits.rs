//! What a reader may spend.

use super::error::ReadError;

/// The most that a reader accepts; checked before memory is taken.
///
/// Readers hold the file's bytes (given by the caller) and what they return, and reserve nothing on the word of a
/// header that the rest of the file cannot make good. Beside the file's bytes a mesh takes up to 2.5 times their number
/// while it is read; at the very worst, from files made for the purpose, that is 12 times, and 24 times from OBJ (a group
/// for every face). Measured on meshes of a million triangles and on the shortest statements there are.
///
/// # Examples
/// ```
/// use meshwright::io::{Limits, ReadError, read_off};
/// let limits = Limits { vertices: 3, ..Limits::default() };
/// let refused = read_off(b"OFF 4 0 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n", &limits);
/// assert!(matches!(refused, Err(ReadError::Limit { wanted: 4, allowed: 3, .. })));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Limits {
    /// The most bytes that [`read_file`](super::read_file) takes from a file.
    pub bytes: u64,
    /// The most vertices.
    pub vertices: u64,
    /// The most faces.
    pub faces: u64,
    /// The most corners of all faces together.
    pub corners: u64,
}

impl Default for Limits {
    /// What a mesh can number, 2^31 - 2 of each; and files of 8 GiB.
    fn default() -> Self {
        let most = crate::soup::MAX_ELEMENTS as u64;
        Self { bytes: 8 << 30, vertices: most, faces: most, corners: most }
    }
}

impl Limits {
    pub(super) fn check_bytes(&self, wanted: u64) -> Result<(), ReadError> {
        check("bytes", wanted, self.bytes)
    }

    pub(super) fn check_vertices(&self, wanted: u64) -> Result<(), ReadError> {
        check("vertices", wanted, self.vertices)
    }

    pub(super) fn check_faces(&self, wanted: u64) -> Result<(), ReadError> {
        check("faces", wanted, self.faces)
    }

    pub(super) fn check_corners(&self, wanted: u64) -> Result<(), ReadError> {
        check("corners", wanted, self.corners)
    }
}

fn check(what: &'static str, wanted: u64, allowed: u64) -> Result<(), ReadError> {
    if wanted > allowed { Err(ReadError::Limit { what, wanted, allowed }) } else { Ok(()) }
}
