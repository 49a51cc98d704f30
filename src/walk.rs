//! Walks: over all elements, around a vertex, around a face, along boundary loops, over components.
//!
//! A local walk checks its key once, then follows plain links: O(1) memory, and O(1) per step. The order is part of
//! the contract. Around a vertex it is **clockwise** seen from outside, beginning at
//! [`vertex_halfedge`](Mesh::vertex_halfedge): on a boundary vertex that is its boundary half-edge, so the walk sees
//! the fan of faces in one sweep, from one boundary edge to the other. Around a face it is **counter-clockwise**,
//! beginning at the face's first corner.
//!
//! What the caller is told of this, and how to edit while walking, is on the [walking page](crate::walking).

use crate::matching::NONE;
use crate::mesh::read;
use crate::{EdgeKey, FaceKey, HalfedgeKey, Mesh, VertexKey};

/// Half-edge slots that follow one another by `step`, from `first` around to it again.
#[derive(Clone)]
struct Ring<'a, F> {
    mesh: &'a Mesh,
    first: u32,
    at: u32,
    step: F,
}

impl<'a, F: Fn(&Mesh, u32) -> u32> Ring<'a, F> {
    /// From `first`, or empty if that is `NONE`.
    fn new(mesh: &'a Mesh, first: u32, step: F) -> Self {
        Self { mesh, first, at: first, step }
    }
}

impl<F: Fn(&Mesh, u32) -> u32> Iterator for Ring<'_, F> {
    type Item = u32;

    #[inline]
    fn next(&mut self) -> Option<u32> {
        let here = self.at;
        if here == NONE {
            return None;
        }
        let there = (self.step)(self.mesh, here);
        self.at = if there == self.first { NONE } else { there };
        Some(here)
    }
}

impl<F: Fn(&Mesh, u32) -> u32> std::iter::FusedIterator for Ring<'_, F> {}

impl Mesh {
    /// Outgoing half-edge slots of a vertex slot, clockwise.
    #[inline]
    pub(crate) fn outgoing_slots(&self, v: u32) -> impl Iterator<Item = u32> + Clone + '_ {
        Ring::new(self, self.vertex_halfedge[v as usize], |m, h| m.next[h as usize ^ 1])
    }

    /// The half-edge slots of the loop through a half-edge slot.
    #[inline]
    pub(crate) fn loop_slots(&self, h: u32) -> impl Iterator<Item = u32> + Clone + '_ {
        Ring::new(self, h, |m, h| m.next[h as usize])
    }

    /// All vertices, in storage order: on a freshly built mesh the `i`-th is vertex `i` of the input. O(slots).
    pub fn vertices(&self) -> impl DoubleEndedIterator<Item = VertexKey> + Clone + '_ {
        self.vertices.live().map(|v| self.vertices.key(v))
    }

    /// All edges, in storage order. O(slots).
    pub fn edges(&self) -> impl DoubleEndedIterator<Item = EdgeKey> + Clone + '_ {
        self.edges.live().map(|e| self.edges.key(e))
    }

    /// All faces, in storage order: on a freshly built mesh the `i`-th is face `i` of the input. O(slots).
    pub fn faces(&self) -> impl DoubleEndedIterator<Item = FaceKey> + Clone + '_ {
        self.faces.live().map(|f| self.faces.key(f))
    }

    /// All half-edges, twins side by side, in the order of [`edges`](Self::edges). O(slots).
    pub fn halfedges(&self) -> impl Iterator<Item = HalfedgeKey> + Clone + '_ {
        self.edges.live().flat_map(|e| [2 * e, 2 * e + 1]).map(|h| self.halfedge_key(h))
    }

    read! {
        /// The half-edges that start at a vertex, clockwise from [`vertex_halfedge`](Self::vertex_halfedge).
        outgoing, get_outgoing(self, v: VertexKey => vertex_slot) -> impl Iterator<Item = HalfedgeKey> + Clone + '_ {
            self.outgoing_slots(v).map(|h| self.halfedge_key(h))
        }
    }

    read! {
        /// The half-edges that end at a vertex, clockwise: the twins of [`outgoing`](Self::outgoing).
        incoming, get_incoming(self, v: VertexKey => vertex_slot) -> impl Iterator<Item = HalfedgeKey> + Clone + '_ {
            self.outgoing_slots(v).map(|h| self.halfedge_key(h ^ 1))
        }
    }

    read! {
        /// The one-ring: the vertices joined to a vertex by an edge, clockwise, each once.
        neighbors, get_neighbors(self, v: VertexKey => vertex_slot) -> impl Iterator<Item = VertexKey> + Clone + '_ {
            self.outgoing_slots(v).map(|h| self.vertices.key(self.origin[h as usize ^ 1]))
        }
    }

    read! {
        /// The faces around a vertex, clockwise, each once.
        faces_around, get_faces_around(self, v: VertexKey => vertex_slot) -> impl Iterator<Item = FaceKey> + Clone + '_ {
            self.outgoing_slots(v).filter_map(|h| self.face_key(self.face[h as usize]))
        }
    }

    read! {
        /// The edges around a vertex, clockwise, each once.
        edges_around, get_edges_around(self, v: VertexKey => vertex_slot) -> impl Iterator<Item = EdgeKey> + Clone + '_ {
            self.outgoing_slots(v).map(|h| self.edges.key(h >> 1))
        }
    }

    read! {
        /// The loop through a half-edge: around its face, or along its boundary loop. Begins with the half-edge itself.
        loop_of, get_loop_of(self, h: HalfedgeKey => halfedge_slot) -> impl Iterator<Item = HalfedgeKey> + Clone + '_ {
            self.loop_slots(h).map(|h| self.halfedge_key(h))
        }
    }

    read! {
        /// The half-edges of a face, counter-clockwise from its first corner.
        face_halfedges, get_face_halfedges(self, f: FaceKey => face_slot) -> impl Iterator<Item = HalfedgeKey> + Clone + '_ {
            self.loop_slots(self.face_halfedge[f as usize]).map(|h| self.halfedge_key(h))
        }
    }

    read! {
        /// The vertices of a face, counter-clockwise from its first corner, each once.
        face_vertices, get_face_vertices(self, f: FaceKey => face_slot) -> impl Iterator<Item = VertexKey> + Clone + '_ {
            self.loop_slots(self.face_halfedge[f as usize]).map(|h| self.vertices.key(self.origin[h as usize]))
        }
    }

    read! {
        /// The edges of a face, counter-clockwise from its first corner, each once.
        face_edges, get_face_edges(self, f: FaceKey => face_slot) -> impl Iterator<Item = EdgeKey> + Clone + '_ {
            self.loop_slots(self.face_halfedge[f as usize]).map(|h| self.edges.key(h >> 1))
        }
    }

    read! {
        /// The faces across the edges of a face, counter-clockwise; a face that shares several edges comes once for
        /// each, boundary edges give none.
        face_neighbors, get_face_neighbors(self, f: FaceKey => face_slot) -> impl Iterator<Item = FaceKey> + Clone + '_ {
            let loop_ = self.loop_slots(self.face_halfedge[f as usize]);
            loop_.filter_map(|h| self.face_key(self.face[h as usize ^ 1]))
        }
    }

    read! {
        /// The number of edges at a vertex. O(valence).
        valence, get_valence(self, v: VertexKey => vertex_slot) -> usize { self.outgoing_slots(v).count() }
    }

    read! {
        /// The number of corners of a face. O(degree).
        degree, get_degree(self, f: FaceKey => face_slot) -> usize {
            self.loop_slots(self.face_halfedge[f as usize]).count()
        }
    }

    /// The half-edge from one vertex to another, or `None` if no edge joins them or a key is dead. O(the lower valence).
    pub fn find_halfedge(&self, a: VertexKey, b: VertexKey) -> Option<HalfedgeKey> {
        let (a, b) = (self.vertex_slot(a)?, self.vertex_slot(b)?);
        self.find_slot(a, b).map(|h| self.halfedge_key(h))
    }
}
