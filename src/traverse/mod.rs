//! Traversal beyond the next step, as editors want it: rings, edge loops, shortest paths, regions, features.
//!
//! What spreads from one element is a walk that goes as far as it is asked to, and costs what it has reached: it
//! remembers elements in a hash table, which is looked up in and never listed, so that no order depends on it. What
//! is about the whole mesh uses columns.

mod dihedral;
mod features;
mod flood;
mod loops;
mod path;
mod region;
mod slots;

pub use features::FeatureOptions;
pub use path::{EdgePath, PathError};

use crate::HalfedgeKey;

/// Edges strung one after another, as half-edges that all run the same way.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EdgeChain {
    /// The half-edges in order, each edge once; never empty.
    pub halfedges: Vec<HalfedgeKey>,
    /// Whether the chain goes on from its last half-edge to its first.
    pub closed: bool,
}

/// As `read!`, for readers that take more than a key.
macro_rules! read_with {
    ($(#[$doc:meta])* $name:ident, $get:ident($self:ident, $slot:ident: $key:ty => $check:ident, $arg:ident: $type:ty)
        -> $out:ty $body:block) => {
        $(#[$doc])*
        ///
        /// # Panics
        #[doc = concat!("On a dead key; [`", stringify!($get), "`](Self::", stringify!($get), ") does not.")]
        #[track_caller]
        pub fn $name(&$self, key: $key, $arg: $type) -> $out {
            let $slot = match $self.$check(key) {
                Some(slot) => slot,
                None => $crate::mesh::dead(&key),
            };
            $body
        }

        #[doc = concat!("[`", stringify!($name), "`](Self::", stringify!($name), "), or `None` on a dead key.")]
        pub fn $get(&$self, key: $key, $arg: $type) -> Option<$out> {
            let $slot = $self.$check(key)?;
            Some($body)
        }
    };
}
use read_with;
