//! Handles to elements of a [`Mesh`](crate::Mesh): small, copyable, and checked on every use.
//!
//! A key names a slot and the version of what lives there. Removing an element makes its key stale for good (until
//! 2^31 reuses of one slot); a stale key is detected, never taken for the slot's new owner. Keys of another mesh are
//! *not* detected: keep each mesh's keys with the mesh.

use std::fmt;
use std::num::NonZeroU32;

slotmap::new_key_type! {
    /// A vertex of a [`Mesh`](crate::Mesh).
    pub struct VertexKey;
    /// An edge of a [`Mesh`](crate::Mesh): a pair of half-edges.
    pub struct EdgeKey;
    /// A face of a [`Mesh`](crate::Mesh).
    pub struct FaceKey;
}

/// A half-edge of a [`Mesh`](crate::Mesh): one of the two directions of an edge.
///
/// Eight bytes, `Option` included. It lives and dies with its edge. Not a [`slotmap::Key`] (implementing that trait
/// takes `unsafe`), so it cannot index a `SecondaryMap`.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct HalfedgeKey {
    /// Twice the edge's slot, plus the direction.
    pub(crate) index: u32,
    /// The edge's version.
    pub(crate) version: NonZeroU32,
}

impl fmt::Debug for HalfedgeKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "HalfedgeKey({}{}v{})",
            self.index >> 1,
            ["a", "b"][(self.index & 1) as usize],
            self.version
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_and_its_option_is_eight_bytes() {
        assert_eq!(size_of::<Option<VertexKey>>(), 8);
        assert_eq!(size_of::<Option<EdgeKey>>(), 8);
        assert_eq!(size_of::<Option<FaceKey>>(), 8);
        assert_eq!(size_of::<Option<HalfedgeKey>>(), 8);
    }
}
