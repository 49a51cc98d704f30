//! Splitting a vertex: the inverse of collapse.

use super::Slots;
use crate::matching::NONE;
use crate::{EdgeKey, HalfedgeKey, Mesh, VertexKey};
use glam::DVec3;

/// Why a vertex was not split.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SplitVertexError {
    /// The key names no live half-edge.
    #[error("{0:?} is not a half-edge of the mesh")]
    Missing(HalfedgeKey),
    /// The two half-edges start at different vertices.
    #[error("the half-edges start at {0:?} and {1:?}")]
    DifferentOrigins(VertexKey, VertexKey),
    /// All edges of the vertex would go to the new one.
    #[error("{0:?} would be left without an edge")]
    NothingLeft(VertexKey),
    /// A coordinate is NaN or infinite.
    #[error("the position {0} is not finite")]
    NonFinite(DVec3),
}

/// What [`Mesh::split_vertex`] made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SplitVertex {
    /// The new vertex.
    pub vertex: VertexKey,
    /// The edge to it; its [half-edge](Mesh::edge_halfedge) runs from the old vertex to the new.
    pub edge: EdgeKey,
}

impl Mesh {
    /// Splits a vertex in two, joined by a new edge: the edges from `first` clockwise to `last`, both included, go to the
    /// new vertex. The two faces beside the new edge gain a corner. [`collapse`](Self::collapse) of the new edge takes
    /// it back.
    ///
    /// ```text
    ///      first                first
    ///   ╲   │   ╱              ╲   │   ╱
    ///     ╲ │ ╱                  ╲ │ ╱
    ///   ─── ● ─── last   →         ● ─── last
    ///     ╱ │ ╲                    │ new edge
    ///   ╱   │   ╲            ───── ● ─────
    ///                            ╱ │ ╲
    /// ```
    ///
    /// The new vertex and the corners at it take over the data of the old. O(valence).
    ///
    /// # Errors
    /// [`SplitVertexError`]; nothing has changed then.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2], [2, 1, 3]])?)?;
    /// let v = mesh.vertices().nth(1).unwrap();
    /// let h = mesh.vertex_halfedge(v).unwrap();
    /// let new = mesh.split_vertex(h, h, DVec3::X * 1.5)?;
    /// assert_eq!((mesh.valence(v), mesh.valence(new.vertex)), (3, 2));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn split_vertex(
        &mut self,
        first: HalfedgeKey,
        last: HalfedgeKey,
        position: DVec3,
    ) -> Result<SplitVertex, SplitVertexError> {
        let moved = self.plan_split_vertex(first, last, position)?;
        let (first, last) = (moved[0], moved[moved.len() - 1]);
        let v = self.origin[first as usize];
        // Clockwise the faces are: `a` between the half-edge before and `first`, ..., `b` between `last` and `after`.
        let (before, after) = (self.prev[first as usize], self.next[last as usize ^ 1]);
        let (a, b) = (self.face[first as usize], self.face[after as usize]);
        let open = moved.iter().copied().find(|&h| self.is_open(h));
        let w = self.new_vertex(position, &[(v, 1.0)]);
        let n = self.new_edge(v, w, None);
        for &h in &moved {
            self.set_origin(h, w);
        }
        if a != NONE {
            self.copy_corner(first, n);
            if self.face_halfedge[a as usize] == first {
                self.set_face_halfedge(a, n);
            }
        }
        if b != NONE {
            self.copy_corner(after, n ^ 1);
        }
        self.link(before, n);
        self.link(n, first);
        self.link(last ^ 1, n ^ 1);
        self.link(n ^ 1, after);
        self.set_face(n, a);
        self.set_face(n ^ 1, b);
        let at_new = if b == NONE { n ^ 1 } else { open.unwrap_or(n ^ 1) };
        self.set_vertex_halfedge(w, at_new);
        if a == NONE {
            self.set_vertex_halfedge(v, n);
        } else if self.origin[self.vertex_halfedge[v as usize] as usize] == w {
            self.set_vertex_halfedge(v, after);
        }
        Ok(SplitVertex { vertex: self.vertices.key(w), edge: self.edges.key(n >> 1) })
    }

    /// Whether [`split_vertex`](Self::split_vertex) would be done.
    ///
    /// # Errors
    /// As there.
    pub fn check_split_vertex(
        &self,
        first: HalfedgeKey,
        last: HalfedgeKey,
        position: DVec3,
    ) -> Result<(), SplitVertexError> {
        self.plan_split_vertex(first, last, position).map(|_| ())
    }

    /// The half-edges that move.
    fn plan_split_vertex(
        &self,
        first: HalfedgeKey,
        last: HalfedgeKey,
        position: DVec3,
    ) -> Result<Slots, SplitVertexError> {
        let slot = |h: HalfedgeKey| self.halfedge_slot(h).ok_or(SplitVertexError::Missing(h));
        let (first, last) = (slot(first)?, slot(last)?);
        let [v, w] = [first, last].map(|h| self.origin[h as usize]);
        if v != w {
            let [v, w] = [v, w].map(|v| self.vertices.key(v));
            return Err(SplitVertexError::DifferentOrigins(v, w));
        }
        if !position.is_finite() {
            return Err(SplitVertexError::NonFinite(position));
        }
        let mut moved = Slots::new();
        let mut h = first;
        loop {
            moved.push(h);
            let next = self.next[h as usize ^ 1];
            if next == first {
                return Err(SplitVertexError::NothingLeft(self.vertices.key(v)));
            }
            if h == last {
                return Ok(moved);
            }
            h = next;
        }
    }
}
