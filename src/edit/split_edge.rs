//! Splitting an edge.

use super::{Few, SplitFace};
use crate::column::{Event, Kind};
use crate::{EdgeKey, Mesh, VertexKey};
use glam::DVec3;

/// Why an edge was not split.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SplitEdgeError {
    /// The key names no live edge.
    #[error("{0:?} is not an edge of the mesh")]
    Missing(EdgeKey),
    /// A coordinate is NaN or infinite.
    #[error("the position {0} is not finite")]
    NonFinite(DVec3),
}

/// What [`Mesh::split_edge`] made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SplitEdge {
    /// The vertex on the edge.
    pub vertex: VertexKey,
    /// The new half: from the vertex to where the edge's [half-edge](Mesh::edge_halfedge) led. The edge itself keeps the
    /// other half.
    pub edge: EdgeKey,
}

/// What [`Mesh::split_edge_and_faces`] made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SplitEdgeFaces {
    /// The vertex on the edge.
    pub vertex: VertexKey,
    /// The new half of the edge.
    pub edge: EdgeKey,
    /// For each triangle beside the edge the cut to its apex.
    pub cuts: Few<SplitFace>,
}

impl Mesh {
    /// Splits an edge with a new vertex. The faces beside it gain a corner; nothing else changes, so this can always be
    /// done.
    ///
    /// ```text
    ///   a ─────────── b   →   a ──── ● ──── b
    ///         edge              edge    new
    /// ```
    ///
    /// Data of the new vertex and corners is made from the two ends, weighted by where on the edge the position lies. O(1).
    ///
    /// # Errors
    /// [`SplitEdgeError`]; nothing has changed then.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// let e = mesh.edges().next().unwrap();
    /// let new = mesh.split_edge(e, DVec3::X / 2.0)?;
    /// let f = mesh.faces().next().unwrap();
    /// assert_eq!((mesh.degree(f), mesh.valence(new.vertex)), (4, 2));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn split_edge(&mut self, e: EdgeKey, position: DVec3) -> Result<SplitEdge, SplitEdgeError> {
        self.check_split_edge(e, position)?;
        let e = self.edge_slot(e).ok_or(SplitEdgeError::Missing(e))?;
        let (vertex, edge) = self.cut_edge(e, position);
        Ok(SplitEdge { vertex: self.vertices.key(vertex), edge: self.edges.key(edge) })
    }

    /// Whether [`split_edge`](Self::split_edge) would be done.
    ///
    /// # Errors
    /// As there.
    pub fn check_split_edge(&self, e: EdgeKey, position: DVec3) -> Result<(), SplitEdgeError> {
        self.edge_slot(e).ok_or(SplitEdgeError::Missing(e))?;
        if position.is_finite() { Ok(()) } else { Err(SplitEdgeError::NonFinite(position)) }
    }

    /// Splits an edge with a new vertex, and cuts each triangle beside it from the vertex to its apex: triangles stay
    /// triangles. Larger faces gain a corner.
    ///
    /// ```text
    ///       c                 c
    ///     ╱   ╲             ╱ │ ╲
    ///   a ───── b     →   a ─ ● ─ b
    ///     ╲   ╱             ╲ │ ╱
    ///       d                 d
    /// ```
    ///
    /// # Errors
    /// [`SplitEdgeError`]; nothing has changed then.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2], [2, 1, 3]])?)?;
    /// let inner = mesh.edges().find(|&e| !mesh.is_boundary_edge(e)).unwrap();
    /// let new = mesh.split_edge_and_faces(inner, (DVec3::X + DVec3::Y) / 2.0)?;
    /// assert_eq!((mesh.face_count(), mesh.valence(new.vertex)), (4, 4));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn split_edge_and_faces(
        &mut self,
        e: EdgeKey,
        position: DVec3,
    ) -> Result<SplitEdgeFaces, SplitEdgeError> {
        self.check_split_edge(e, position)?;
        let e = self.edge_slot(e).ok_or(SplitEdgeError::Missing(e))?;
        let h = 2 * e;
        let triangles = [h, h ^ 1].map(|h| self.is_triangle(h));
        let (vertex, edge) = self.cut_edge(e, position);
        let mut cuts = Few::new();
        // From the new vertex, the apex is two corners on in either face.
        for (from, is_triangle) in [2 * edge, h ^ 1].into_iter().zip(triangles) {
            if is_triangle {
                let apex = self.next[self.next[from as usize] as usize];
                let (face, diagonal) = self.cut_face(from, apex);
                cuts.push(SplitFace { face: self.faces.key(face), edge: self.edges.key(diagonal) });
            }
        }
        Ok(SplitEdgeFaces { vertex: self.vertices.key(vertex), edge: self.edges.key(edge), cuts })
    }

    /// The new vertex and edge. `a ─h→ b` becomes `a ─h→ m ─n→ b`.
    pub(super) fn cut_edge(&mut self, e: u32, position: DVec3) -> (u32, u32) {
        let (h, t) = (2 * e, 2 * e + 1);
        let (a, b) = (self.origin[h as usize], self.origin[t as usize]);
        let (f, g) = (self.face[h as usize], self.face[t as usize]);
        let (after, before) = (self.next[h as usize], self.prev[t as usize]);
        let s = self.share_along(a, b, position);
        let ends = [(a, 1.0 - s), (b, s)];
        let m = self.new_vertex(position, &ends);
        let n = self.new_edge(m, b, Some(e));
        // Corners in f: a at h, b at `after`. In g: b at t until now, a at what follows t.
        if !self.is_open(h) {
            self.mix(Kind::Corner, Event::Split, n, &[(h, 1.0 - s), (after, s)]);
        }
        if !self.is_open(t) {
            let at_a = self.next[t as usize];
            self.copy_corner(t, n ^ 1);
            self.mix(Kind::Corner, Event::Split, t, &[(at_a, 1.0 - s), (n ^ 1, s)]);
            if self.face_halfedge[g as usize] == t {
                self.set_face_halfedge(g, n ^ 1);
            }
        }
        self.set_origin(t, m);
        self.link(h, n);
        self.link(n, after);
        self.link(before, n ^ 1);
        self.link(n ^ 1, t);
        self.set_face(n, f);
        self.set_face(n ^ 1, g);
        if self.vertex_halfedge[b as usize] == t {
            self.set_vertex_halfedge(b, n ^ 1);
        }
        self.set_vertex_halfedge(m, if self.is_open(t) { t } else { n });
        (m, n >> 1)
    }
}
