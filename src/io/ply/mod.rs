//! PLY: ASCII, little- and big-endian.
//!
//! Read here rather than by a crate: the header has to be read before anything is reserved on its word, errors must
//! name line or byte, and files from life have comments in their data, headers that end in a lone carriage return, and
//! lists of every integer type.

mod header;
mod read;
mod write;

pub use read::read_ply;
pub use write::{write_ply, write_ply_ascii, write_ply_big_endian};
