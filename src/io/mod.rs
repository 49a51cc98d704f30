//! Files to and from [`PolygonSoup`](crate::PolygonSoup): OBJ, STL, PLY and OFF, under [`Limits`].
//!
//! Readers take bytes and promise nothing about what they return except that the file said it; what they skipped or
//! tolerated stands in [`Loaded::notes`] with its line or byte. Errors blame the source, the file, the caller or a limit.

mod error;
mod limits;
mod obj;
mod off;
mod ply;
mod stl;

pub use error::{Note, Place, ReadError, WriteError};
pub use limits::Limits;
