//! What filling is asked for, and what it tells.

use crate::{Cancelled, Control, EdgeKey, FaceKey, HalfedgeKey, VertexKey};
use glam::DVec3;
use std::fmt;

/// The most corners that [`FillHolesOptions::exact_edges`] may be.
pub(super) const MOST_EXACT: usize = 2000;

/// How holes are filled.
#[derive(Debug)]
pub struct FillHolesOptions<'a> {
    /// Loops of more edges stay open.
    pub max_edges: Option<usize>,
    /// Loops of up to this many edges are filled with least area in O(n^3), longer ones in O(n log n) by ears; at most 2000.
    pub exact_edges: usize,
    /// How much the O(n^3) method may cost in all loops together, in cubes of their edges; once it is spent, the shortest loops
    /// first, ears serve for the rest. By default 2^32, about five seconds.
    pub exact_cost: u64,
    /// A loop stays open if its filler's area is this share of the area of its part (the faces joined to it across edges),
    /// or more. The outside of a lone sheet is a hole as large as the sheet: filled, the part would be a bag without content. An
    /// open box has 0.2, half a sphere 0.5, a flat sheet 1. Infinite to fill sheets too.
    pub max_area_ratio: f64,
    /// Loops whose corners lie no further than this from a plane, and that do not cross themselves there, are filled with one
    /// polygon: a length in the units of the mesh. Without, all fillers are triangles.
    pub polygon_tolerance: Option<f64>,
    /// A loop counts as within the hole of another if its corners are no further from that one's plane than this share of
    /// the root of its area.
    pub island_depth: f64,
    /// Progress and cancelling.
    pub control: Control<'a>,
}

impl Default for FillHolesOptions<'_> {
    /// All loops but sheets; least area up to 500 edges, triangles.
    fn default() -> Self {
        Self {
            max_edges: None,
            exact_edges: 500,
            exact_cost: 1 << 32,
            max_area_ratio: 0.8,
            polygon_tolerance: None,
            island_depth: 0.25,
            control: Control::none(),
        }
    }
}

impl FillHolesOptions<'_> {
    pub(super) fn check(&self) -> Result<(), BadOption> {
        let in_range = |option, value: f64, is_fine: bool| {
            if is_fine { Ok(()) } else { Err(BadOption { option, value }) }
        };
        in_range("exact_edges", self.exact_edges as f64, self.exact_edges <= MOST_EXACT)?;
        in_range("max_area_ratio", self.max_area_ratio, self.max_area_ratio > 0.0)?;
        let depth = self.island_depth;
        in_range("island_depth", depth, depth >= 0.0 && depth.is_finite())?;
        match self.polygon_tolerance {
            Some(tolerance) => in_range("polygon_tolerance", tolerance, tolerance >= 0.0),
            None => Ok(()),
        }
    }
}

/// An option out of range.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{option} cannot be {value}")]
pub struct BadOption {
    /// The name of the option.
    pub option: &'static str,
    /// What it was.
    pub value: f64,
}

/// Why [`fill_holes`](crate::Mesh::fill_holes) did nothing. Nothing has changed then.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FillHolesError {
    /// An option is out of range.
    #[error(transparent)]
    BadOption(#[from] BadOption),
    /// The hook said stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Why [`triangulate_hole`](crate::Mesh::triangulate_hole) did nothing. Nothing has changed then.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TriangulateHoleError {
    /// The key names no live half-edge.
    #[error("{0:?} is not a half-edge of the mesh")]
    Missing(HalfedgeKey),
    /// The half-edge has a face.
    #[error("{0:?} has a face")]
    NotBoundary(HalfedgeKey),
    /// The hole stays open.
    #[error("{}", .0.reason)]
    Refused(RefusedHole),
    /// An option is out of range.
    #[error(transparent)]
    BadOption(#[from] BadOption),
    /// The hook said stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// How a hole was filled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum FillMethod {
    /// With one face: a triangle, or a polygon that was asked for.
    OneFace,
    /// With the triangles of least area.
    LeastArea,
    /// Ear by ear.
    Ears,
}

impl FillMethod {
    /// The name used in JSON.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::OneFace => "one_face",
            Self::LeastArea => "least_area",
            Self::Ears => "ears",
        }
    }
}

impl fmt::Display for FillMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

/// A hole that was filled.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct FilledHole {
    /// A half-edge of the loop, which has one of the new faces now: that which starts at the vertex that is first in storage
    /// order.
    pub halfedge: HalfedgeKey,
    /// The number of edges of the loop.
    pub edges: usize,
    /// The new faces.
    pub faces: Vec<FaceKey>,
    /// Their area, in square units.
    pub area: f64,
    /// The mean of the loop's vertices.
    pub place: DVec3,
    /// How.
    pub method: FillMethod,
}

/// A hole that stays open.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct RefusedHole {
    /// The half-edge of the loop that starts at the vertex that is first in storage order.
    pub halfedge: HalfedgeKey,
    /// The vertices of the loop, from there on.
    pub vertices: Vec<VertexKey>,
    /// Their mean.
    pub place: DVec3,
    /// Why.
    pub reason: HoleRefusal,
}

/// Why a hole stays open.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum HoleRefusal {
    /// The loop has more than [`max_edges`](FillHolesOptions::max_edges) edges.
    #[error("the hole has {0} edges")]
    TooLong(usize),
    /// It is the outside of one face, which would be there twice.
    #[error("the hole is the outside of {0:?}")]
    OneFace(FaceKey),
    /// The filler would be this share of the area of the part: see [`max_area_ratio`](FillHolesOptions::max_area_ratio).
    #[error("the filler would have {0} times the area of its part: a sheet")]
    Sheet(f64),
    /// These loops, each given by a half-edge, lie around one hole: an island within it, or the two rims of a wall. Filled
    /// one by one, their fillers would lie upon each other.
    #[error("{} loops lie around one hole", .0.len())]
    Islands(Vec<HalfedgeKey>),
    /// Edges off the loop join so many of its vertices that no triangulation does without them; this is one. Up to
    /// [`exact_edges`](FillHolesOptions::exact_edges) edges that is certain, above it is what was found.
    #[error("every filler would double an edge such as {0:?}")]
    EdgesInTheWay(EdgeKey),
}

/// The account of [`fill_holes`](crate::Mesh::fill_holes). Together its two lists hold every boundary loop there was, each in
/// the order of the loops' first edges.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct FilledHoles {
    /// What was filled.
    pub filled: Vec<FilledHole>,
    /// What stays open.
    pub refused: Vec<RefusedHole>,
    /// How many loops were not looked through for [islands](HoleRefusal::Islands) to the end, as there were so many loops that
    /// might lie within each other: some may have been filled over one.
    pub unsearched: usize,
}
