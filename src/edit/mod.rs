//! Operators: checked, local, atomic edits.
//!
//! Each operator `x` comes with `check_x`, which says whether it would be done and changes nothing: `check_x` is `Ok`
//! exactly when the edit leaves a valid mesh and keeps what its documentation promises. `x` checks itself once, so there
//! is no need to call both; on `Err` nothing has changed: not a link, a version, a free slot or a value. An operator's
//! result names every element born and dead; all other keys stay valid and keep their meaning.
//!
//! `split_edge_and_faces`, `collapse_to_midpoint` and `collapse_into_target` are conveniences: the `check_` of the operator
//! they are made of answers for them.
//!
//! Cost is O(elements touched): the faces and vertices around the place. No operator looks at the rest of the mesh.
//! Links are written here, through [`link`], and in the builder; nowhere else.

pub(crate) mod changes;
mod collapse;
mod dissolve;
mod faces;
mod fill;
mod flip;
mod join;
mod link;
mod poke;
mod remove;
mod reverse;
mod split_edge;
mod split_face;
mod split_vertex;
mod stitch;
mod triangulate;
pub(crate) mod undo;
mod weights;

pub use collapse::{CollapseError, Collapsed};
pub use dissolve::{DissolveVertexError, DissolvedVertex};
pub use faces::{AddFaceError, AddVertexError, AddedFace};
pub use fill::FillHoleError;
pub use flip::FlipEdgeError;
pub use join::{JoinFacesError, JoinedFaces};
pub use poke::{PokeFaceError, PokedFace};
pub use remove::{RemoveEdgeError, RemoveFaceError, RemoveVertexError, Removed};
pub use reverse::MissingFace;
pub use split_edge::{SplitEdge, SplitEdgeError, SplitEdgeFaces};
pub use split_face::{SplitFace, SplitFaceError};
pub use split_vertex::{SplitVertex, SplitVertexError};
pub use stitch::{StitchError, Stitched};
pub use triangulate::{TriangulateFaceError, TriangulatedFace};

/// A short list that is kept in place up to four entries.
pub type Few<T> = smallvec::SmallVec<[T; 4]>;

/// Slots around a place, while an operator works.
pub(crate) type Slots = smallvec::SmallVec<[u32; 12]>;
