//! **meshwright** is a half-edge mesh library that does not lie: every type is a proof of what it promises, every edit
//! is checked, and every change that clean-up makes is accounted for.
//!
//! One ladder of types, each rung checked when it is climbed:
//!
//! | type | promises | refusal |
//! |---|---|---|
//! | [`PolygonSoup`] | nothing: whatever a file said | |
//! | [`IndexedMesh`] | finite positions; faces of three or more distinct, existing vertices | [`IndexedError`] |
//! | [`Mesh`] | an oriented 2-manifold with boundary, faces of any degree | [`BuildError`] |
//! | [`Closed`] | no boundary: the door to volume | [`NotClosed`] |
//!
//! [`cleanup::clean`] goes from any soup to a valid `Mesh` and says what it changed.
//! The [design page](design) has the module graph and the numbered invariants.
//!
//! Lengths are in the units of the input; angles are in radians unless a name says degrees. Nothing is random and
//! nothing depends on hash order or on the number of threads.
//!
//! # Features
//! `io` (default): readers and writers for OBJ, STL, PLY and OFF. `serde`: accounts, facts and soups serialise.
//! `rayon`: bulk work on several threads; results are the same with and without.

mod arena;
mod build;
pub mod cleanup;
mod closed;
mod control;
#[doc = include_str!("design.md")]
pub mod design {}
mod geometry;
mod indexed;
#[cfg(feature = "io")]
pub mod io;
mod key;
mod matching;
mod mesh;
mod parallel;
mod query;
mod report;
mod soup;
mod topology;
mod validate;
mod walk;

pub use build::{BuildDefect, BuildError};
pub use closed::{Closed, NotClosed};
pub use control::{Cancelled, Control, Progress};
pub use geometry::measure::Aabb;
pub use geometry::normals::NormalWeight;
pub use glam;
pub use indexed::{IndexedDefect, IndexedError, IndexedMesh};
pub use key::{EdgeKey, FaceKey, HalfedgeKey, VertexKey};
pub use mesh::{Mesh, SetError};
pub use query::{
    ClosestOptions, ClosestPoint, Crossing, Feature, MassProperties, MeshIndex, Nearest, QueryError, Ray,
    RayError, RayHit, Side, SolidIndex,
};
pub use report::{
    Attribute, Element, Kind, MapMismatch, Maps, Outcome, Record, Relation, Report, Step, StepSummary,
};
pub use soup::{CornerData, Group, MAX_ELEMENTS, PolygonSoup, Polygons};
pub use topology::{EdgeRef, MissingFace, NakedEdges, NotOrientable, Topology, unify_winding};
pub use validate::Violation;

/// The README's program runs.
#[cfg(all(doctest, feature = "io"))]
#[doc = include_str!("../README.md")]
mod readme {}
