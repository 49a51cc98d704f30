//! The third rung: the half-edge mesh, its storage and its accessors.

use crate::arena::Arena;
use crate::attributes::Carried;
use crate::column::{Columns, Kind};
use crate::edit::changes::Changes;
use crate::edit::undo::Undo;
use crate::matching::NONE;
use crate::{EdgeKey, FaceKey, HalfedgeKey, VertexKey};
use glam::DVec3;
use std::fmt;
use std::num::NonZeroU32;

/// An oriented 2-manifold with boundary, of faces of any degree, stored as half-edges behind checked keys.
///
/// Every `Mesh` satisfies the invariants M1..M18 of the [design page](crate::design); no public call can break them.
/// An edge is a pair of half-edges, [`twin`](Self::twin)s of each other; the half-edges of a face run around it
/// counter-clockwise seen from outside; a half-edge without a face is a *boundary half-edge* and lies on a boundary
/// loop.
///
/// Reading with a dead key panics, like indexing past the end of a slice; every such reader has a twin whose name
/// begins with `get_` and that answers `None`. Keys of another mesh are not detected.
///
/// # Examples
/// ```
/// use meshwright::{IndexedMesh, Mesh, Polygons, glam::DVec3};
/// let corners = [DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y];
/// let square = IndexedMesh::new(corners.to_vec(), Polygons::from(vec![vec![0, 1, 2, 3]]))?;
/// let mesh = Mesh::build(&square)?;
/// let f = mesh.faces().next().unwrap();
/// for h in mesh.face_halfedges(f) {
///     assert!(mesh.is_boundary(mesh.twin(h)));
///     assert_eq!(mesh.target(h), mesh.origin(mesh.next(h)));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct Mesh {
    pub(crate) vertices: Arena<VertexKey>,
    pub(crate) edges: Arena<EdgeKey>,
    pub(crate) faces: Arena<FaceKey>,
    /// By half-edge (`2 * edge slot + side`); entries of dead slots mean nothing.
    pub(crate) next: Vec<u32>,
    /// `prev[next[h]] == h`.
    pub(crate) prev: Vec<u32>,
    /// The slot of the vertex a half-edge starts at.
    pub(crate) origin: Vec<u32>,
    /// The slot of the face to the left, or `NONE` on the boundary.
    pub(crate) face: Vec<u32>,
    /// By vertex slot: a half-edge that starts there, the boundary half-edge if there is one; `NONE` if isolated.
    pub(crate) vertex_halfedge: Vec<u32>,
    /// By face slot: the half-edge that starts at the face's first corner.
    pub(crate) face_halfedge: Vec<u32>,
    /// By vertex slot; finite.
    pub(crate) positions: Vec<DVec3>,
    /// User data.
    pub(crate) columns: Columns,
    /// Which of the columns hold the attributes that files know; finite.
    pub(crate) carried: Carried,
    /// What was overwritten since the oldest checkpoint, if there is one.
    pub(crate) undo: Option<Box<Undo>>,
    /// What edits did, if somebody listens.
    pub(crate) changes: Option<Box<Changes>>,
}

/// Why a position was not set.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SetError {
    /// The key names no live vertex.
    #[error("{0:?} is not a vertex of the mesh")]
    Missing(VertexKey),
    /// The value is NaN or infinite.
    #[error("the position for {0:?} is not finite")]
    NonFinite(VertexKey),
}

/// Defines a reader that panics on a dead key, and its `get_` twin.
macro_rules! read {
    ($(#[$doc:meta])* $name:ident, $get:ident($self:ident, $slot:ident: $key:ty => $check:ident) -> $out:ty $body:block) => {
        $(#[$doc])*
        ///
        /// # Panics
        #[doc = concat!("On a dead key; [`", stringify!($get), "`](Self::", stringify!($get), ") does not.")]
        #[inline]
        #[track_caller]
        pub fn $name(&$self, key: $key) -> $out {
            let $slot = match $self.$check(key) {
                Some(slot) => slot,
                None => $crate::mesh::dead(&key),
            };
            $body
        }

        #[doc = concat!("[`", stringify!($name), "`](Self::", stringify!($name), "), or `None` on a dead key.")]
        #[inline]
        pub fn $get(&$self, key: $key) -> Option<$out> {
            let $slot = $self.$check(key)?;
            Some($body)
        }
    };
}
pub(crate) use read;

/// The one documented panic: reading with a key whose element is gone.
#[cold]
#[track_caller]
pub(crate) fn dead(key: &dyn fmt::Debug) -> ! {
    panic!("{key:?} names no live element of this mesh")
}

impl Mesh {
    /// The number of vertices, isolated ones included.
    pub fn vertex_count(&self) -> usize {
        self.vertices.len()
    }

    /// The number of edges.
    pub fn edge_count(&self) -> usize {
        self.edges.len()
    }

    /// The number of faces.
    pub fn face_count(&self) -> usize {
        self.faces.len()
    }

    /// Whether the key names a live vertex.
    pub fn contains_vertex(&self, v: VertexKey) -> bool {
        self.vertex_slot(v).is_some()
    }

    /// Whether the key names a live edge.
    pub fn contains_edge(&self, e: EdgeKey) -> bool {
        self.edge_slot(e).is_some()
    }

    /// Whether the key names a live half-edge.
    pub fn contains_halfedge(&self, h: HalfedgeKey) -> bool {
        self.halfedge_slot(h).is_some()
    }

    /// Whether the key names a live face.
    pub fn contains_face(&self, f: FaceKey) -> bool {
        self.face_slot(f).is_some()
    }

    read! {
        /// The position of a vertex.
        position, get_position(self, v: VertexKey => vertex_slot) -> DVec3 { self.positions[v as usize] }
    }

    /// Moves a vertex.
    ///
    /// # Errors
    /// [`SetError`] on a dead key or a position that is not finite; nothing has changed then.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, NormalWeight, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let pool = IndexedMesh::from_triangles(points, &[[0, 1, 2]])?;
    /// # let mut mesh = Mesh::build(&pool)?;
    /// let v = mesh.vertices().next().unwrap();
    /// mesh.set_position(v, DVec3::Z)?;
    /// assert!(mesh.set_position(v, DVec3::NAN).is_err());
    /// assert_eq!(mesh.position(v), DVec3::Z);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn set_position(&mut self, v: VertexKey, position: DVec3) -> Result<(), SetError> {
        let slot = self.vertex_slot(v).ok_or(SetError::Missing(v))?;
        if !position.is_finite() {
            return Err(SetError::NonFinite(v));
        }
        self.write_position(slot, position);
        Ok(())
    }

    /// The one door for bulk writes of positions: a whole column by slot, all or nothing. Entries of dead slots mean
    /// nothing. Refused by the first vertex in storage order.
    pub(crate) fn replace_positions(&mut self, new: Vec<DVec3>) -> Result<(), SetError> {
        debug_assert_eq!(new.len(), self.vertices.slot_count());
        let bad = |&v: &u32| !new.get(v as usize).is_some_and(|p| p.is_finite());
        if let Some(v) = self.vertices.live().find(bad) {
            return Err(SetError::NonFinite(self.vertices.key(v)));
        }
        if self.undo.is_none() && self.changes.is_none() && self.columns.none_on(Kind::Vertex) {
            self.positions = new;
            return Ok(());
        }
        // Somebody remembers, listens or is moved along.
        for v in self.vertices.live().collect::<Vec<_>>() {
            if self.positions[v as usize] != new[v as usize] {
                self.write_position(v, new[v as usize]);
            }
        }
        Ok(())
    }

    read! {
        /// The next half-edge around the face, or along the boundary loop.
        next, get_next(self, h: HalfedgeKey => halfedge_slot) -> HalfedgeKey { self.halfedge_key(self.next[h as usize]) }
    }

    read! {
        /// The previous half-edge around the face, or along the boundary loop.
        prev, get_prev(self, h: HalfedgeKey => halfedge_slot) -> HalfedgeKey { self.halfedge_key(self.prev[h as usize]) }
    }

    read! {
        /// The other half-edge of the edge.
        twin, get_twin(self, h: HalfedgeKey => halfedge_slot) -> HalfedgeKey { self.halfedge_key(h ^ 1) }
    }

    read! {
        /// The vertex a half-edge starts at.
        origin, get_origin(self, h: HalfedgeKey => halfedge_slot) -> VertexKey { self.vertices.key(self.origin[h as usize]) }
    }

    read! {
        /// The vertex a half-edge ends at.
        target, get_target(self, h: HalfedgeKey => halfedge_slot) -> VertexKey {
            self.vertices.key(self.origin[h as usize ^ 1])
        }
    }

    read! {
        /// The face to the left of a half-edge, or `None` on the boundary.
        face, get_face(self, h: HalfedgeKey => halfedge_slot) -> Option<FaceKey> { self.face_key(self.face[h as usize]) }
    }

    read! {
        /// The edge of a half-edge.
        edge, get_edge(self, h: HalfedgeKey => halfedge_slot) -> EdgeKey { self.edges.key(h >> 1) }
    }

    read! {
        /// A half-edge of an edge: on a freshly built mesh, the one whose face came first.
        edge_halfedge, get_edge_halfedge(self, e: EdgeKey => edge_slot) -> HalfedgeKey { self.halfedge_key(e << 1) }
    }

    read! {
        /// A half-edge that starts at a vertex: the boundary half-edge if there is one; `None` if the vertex is isolated.
        vertex_halfedge, get_vertex_halfedge(self, v: VertexKey => vertex_slot) -> Option<HalfedgeKey> {
            match self.vertex_halfedge[v as usize] { NONE => None, h => Some(self.halfedge_key(h)) }
        }
    }

    read! {
        /// The half-edge of a face that starts at its first corner.
        face_halfedge, get_face_halfedge(self, f: FaceKey => face_slot) -> HalfedgeKey {
            self.halfedge_key(self.face_halfedge[f as usize])
        }
    }

    read! {
        /// The outgoing half-edge clockwise after this one around its origin: `next(twin(h))`.
        rotate_cw, get_rotate_cw(self, h: HalfedgeKey => halfedge_slot) -> HalfedgeKey {
            self.halfedge_key(self.next[h as usize ^ 1])
        }
    }

    read! {
        /// The outgoing half-edge counter-clockwise after this one around its origin: `twin(prev(h))`.
        rotate_ccw, get_rotate_ccw(self, h: HalfedgeKey => halfedge_slot) -> HalfedgeKey {
            self.halfedge_key(self.prev[h as usize] ^ 1)
        }
    }

    read! {
        /// The vertex of the triangle that faces this half-edge; `None` on the boundary and on larger faces.
        apex, get_apex(self, h: HalfedgeKey => halfedge_slot) -> Option<VertexKey> {
            let p = self.prev[h as usize];
            let is_triangle = self.face[h as usize] != NONE && self.next[self.next[h as usize] as usize] == p;
            is_triangle.then(|| self.vertices.key(self.origin[p as usize]))
        }
    }

    read! {
        /// Whether a half-edge has no face.
        is_boundary, get_is_boundary(self, h: HalfedgeKey => halfedge_slot) -> bool { self.face[h as usize] == NONE }
    }

    read! {
        /// Whether an edge has only one face.
        is_boundary_edge, get_is_boundary_edge(self, e: EdgeKey => edge_slot) -> bool {
            self.face[2 * e as usize] == NONE || self.face[2 * e as usize + 1] == NONE
        }
    }

    read! {
        /// Whether a vertex lies on a boundary loop. An isolated vertex does not.
        is_boundary_vertex, get_is_boundary_vertex(self, v: VertexKey => vertex_slot) -> bool {
            let h = self.vertex_halfedge[v as usize];
            h != NONE && self.face[h as usize] == NONE
        }
    }

    read! {
        /// Whether no face names a vertex.
        is_isolated, get_is_isolated(self, v: VertexKey => vertex_slot) -> bool { self.vertex_halfedge[v as usize] == NONE }
    }

    /// Bytes of heap memory the mesh holds: what values of user data own on the heap themselves, and changes that wait to be
    /// fetched, aside. O(columns).
    pub fn heap_bytes(&self) -> usize {
        let links =
            [&self.next, &self.prev, &self.origin, &self.face, &self.vertex_halfedge, &self.face_halfedge];
        self.vertices.bytes()
            + self.edges.bytes()
            + self.faces.bytes()
            + links.iter().map(|c| c.capacity() * 4).sum::<usize>()
            + self.positions.capacity() * size_of::<DVec3>()
            + self.columns.bytes()
            + self.checkpoint_bytes()
    }

    /// Calls `f` with every live face slot in the user's order.
    pub(crate) fn for_each_in_user_order(&self, f: impl FnMut(u32)) {
        if self.faces.is_in_user_order() {
            self.faces.live().for_each(f);
        } else {
            self.faces.in_user_order().into_iter().for_each(f);
        }
    }

    #[inline]
    pub(crate) fn vertex_slot(&self, v: VertexKey) -> Option<u32> {
        self.vertices.slot(v)
    }

    #[inline]
    pub(crate) fn edge_slot(&self, e: EdgeKey) -> Option<u32> {
        self.edges.slot(e)
    }

    #[inline]
    pub(crate) fn face_slot(&self, f: FaceKey) -> Option<u32> {
        self.faces.slot(f)
    }

    #[inline]
    pub(crate) fn halfedge_slot(&self, h: HalfedgeKey) -> Option<u32> {
        self.edges.is_version(h.index >> 1, h.version.get()).then_some(h.index)
    }

    /// The key of a live half-edge.
    #[inline]
    pub(crate) fn halfedge_key(&self, h: u32) -> HalfedgeKey {
        // Live versions are odd, so the bit changes nothing; it spares a branch that cannot be taken.
        HalfedgeKey { index: h, version: NonZeroU32::MIN | self.edges.version(h >> 1) }
    }

    #[inline]
    pub(crate) fn face_key(&self, f: u32) -> Option<FaceKey> {
        (f != NONE).then(|| self.faces.key(f))
    }
}

impl fmt::Debug for Mesh {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Mesh")
            .field("vertices", &self.vertex_count())
            .field("edges", &self.edge_count())
            .field("faces", &self.face_count())
            .finish_non_exhaustive()
    }
}

impl Default for Mesh {
    /// The empty mesh.
    fn default() -> Self {
        Self {
            vertices: Arena::filled(0),
            edges: Arena::filled(0),
            faces: Arena::filled(0),
            next: vec![NONE; 2],
            prev: vec![NONE; 2],
            origin: vec![NONE; 2],
            face: vec![NONE; 2],
            vertex_halfedge: vec![NONE],
            face_halfedge: vec![NONE],
            positions: vec![DVec3::ZERO],
            columns: Columns::default(),
            carried: Carried::default(),
            undo: None,
            changes: None,
        }
    }
}
