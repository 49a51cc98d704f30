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
//! The [design page](design) has the module graph and the numbered invariants, the [walking page](walking) the orders
//! of walks and how to edit while walking.
//!
//! Lengths are in the units of the input; angles are given in degrees, by options whose names say so, and answered in
//! radians. Nothing is random and
//! nothing depends on hash order or on the number of threads.
//!
//! # Features
//! `io` (default): readers and writers for OBJ, STL, PLY and OFF. `serde`: accounts, facts and soups serialise.
//! `rayon`: bulk work on several threads; results are the same with and without.

#[doc = include_str!("accounts.md")]
pub mod accounts {}
mod arena;
mod attributes;
mod build;
pub mod cleanup;
mod closed;
mod column;
mod control;
#[doc = include_str!("design.md")]
pub mod design {}
mod edit;
mod geometry;
mod indexed;
#[cfg(feature = "io")]
pub mod io;
mod key;
mod matching;
mod mesh;
mod order;
mod parallel;
mod query;
mod report;
mod soup;
mod topology;
mod traverse;
mod validate;
mod walk;
#[doc = include_str!("walking.md")]
pub mod walking {}

pub use attributes::{Attributes, FaceGroups, GroupName, SetAttributeError};
pub use build::{BuildDefect, BuildError, BuildWithError};
pub use closed::{Closed, NotClosed};
pub use column::{
    Column, ColumnError, ColumnValues, Direction, ElementKey, Event, Interpolate, Rule, Turning, Value,
};
pub use control::{Cancelled, Control, Progress};
pub use edit::changes::{Change, Lineage, Numbering};
pub use edit::undo::{Checkpoint, UnknownCheckpoint};
pub use edit::{
    AddFaceError, AddVertexError, AddedFace, CollapseError, Collapsed, DissolveVertexError, DissolvedVertex,
    Few, FillHoleError, FlipEdgeError, JoinFacesError, JoinedFaces, MissingFace, PokeFaceError, PokedFace,
    RemoveEdgeError, RemoveFaceError, RemoveVertexError, Removed, SplitEdge, SplitEdgeError, SplitEdgeFaces,
    SplitFace, SplitFaceError, SplitVertex, SplitVertexError, StitchError, Stitched, TriangulateFaceError,
    TriangulatedFace,
};
pub use geometry::deform::{DeformError, DeformOptions};
pub use geometry::fill::{
    BadOption, FillHolesError, FillHolesOptions, FillMethod, FilledHole, FilledHoles, HoleRefusal,
    RefusedHole, TriangulateHoleError,
};
pub use geometry::measure::Aabb;
pub use geometry::normals::NormalWeight;
pub use geometry::reduce::{ReduceError, ReduceOptions, ReduceTarget, Reduced, Refusals, Stopped};
pub use geometry::slivers::{
    LeftSliver, ResolvedSliver, Sliver, SliverAccount, SliverAction, SliverError, SliverKind, SliverObstacle,
    SliverOptions,
};
pub use geometry::smooth::{Boundary, SmoothError, SmoothMethod, SmoothOptions};
pub use geometry::subdivide::{Scheme, SubdivideError, SubdivideOptions};
pub use geometry::transform::TransformError;
pub use geometry::weld::{BadAngle, UnweldError, UnweldOptions, WeldError, WeldOptions};
pub use glam;
pub use indexed::{IndexedDefect, IndexedError, IndexedMesh};
pub use key::{EdgeKey, FaceKey, HalfedgeKey, VertexKey};
pub use mesh::{Mesh, SetError};
pub use query::{
    ClosestOptions, ClosestPoint, Contact, Crossing, FacePair, Feature, MassProperties, MeshIndex, Nearest,
    OutwardError, OutwardOptions, OutwardPart, QueryError, Ray, RayError, RayHit, SelfIntersectionOptions,
    SelfIntersections, Side, SolidIndex, TurnedOutward, orient_outward,
};
pub use report::{
    Attribute, Element, Extent, Kind, LossReason, LostValue, MapMismatch, Maps, Outcome, Record, Relation,
    Report, Step, StepSummary,
};
pub use soup::{CornerData, Group, MAX_ELEMENTS, PolygonSoup, Polygons};
pub use topology::{
    EdgeRef, NakedEdges, NotOrientable, Topology, UnifyWithError, unify_winding, unify_winding_with,
};
pub use traverse::{EdgeChain, EdgePath, FeatureOptions, PathError};
pub use validate::Violation;

/// The README's program runs.
#[cfg(all(doctest, feature = "io"))]
#[doc = include_str!("../README.md")]
mod readme {}
