//! Flipping an edge.

use crate::{EdgeKey, FaceKey, Mesh, VertexKey};

/// Why an edge was not flipped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FlipEdgeError {
    /// The key names no live edge.
    #[error("{0:?} is not an edge of the mesh")]
    Missing(EdgeKey),
    /// The edge has only one face.
    #[error("{0:?} lies on the boundary")]
    Boundary(EdgeKey),
    /// The edge that would come about is there already.
    #[error("{0:?} joins the new ends already")]
    Joined(EdgeKey),
    /// A face would name a vertex twice: the two faces share more than the edge.
    #[error("{face:?} would name {vertex:?} twice")]
    RepeatedVertex {
        /// The face.
        face: FaceKey,
        /// The vertex.
        vertex: VertexKey,
    },
}

impl Mesh {
    /// Flips an edge: turns it counter-clockwise by one corner at each end, within its two faces. In triangles it then
    /// joins the two apexes. All keys stay; each face keeps its degree. Twice in triangles is a flip back, with the edge
    /// reversed.
    ///
    /// ```text
    ///       c                 c
    ///     ╱   ╲             ╱ ↑ ╲
    ///   a ──→── b     →   a   │   b
    ///     ╲   ╱             ╲ │ ╱
    ///       d                 d
    /// ```
    ///
    /// A corner at a new end takes the value of its neighbour in the other face, so a seam along the edge is lost: see
    /// [`is_seam`](Self::is_seam). O(degrees + valence).
    ///
    /// # Errors
    /// [`FlipEdgeError`]; nothing has changed then.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2], [2, 1, 3]])?)?;
    /// let e = mesh.edges().find(|&e| !mesh.is_boundary_edge(e)).unwrap();
    /// mesh.flip_edge(e)?;
    /// let h = mesh.edge_halfedge(e);
    /// assert_eq!(mesh.position(mesh.origin(h)) + mesh.position(mesh.target(h)), DVec3::ONE);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn flip_edge(&mut self, e: EdgeKey) -> Result<(), FlipEdgeError> {
        self.check_flip_edge(e)?;
        let e = self.edge_slot(e).ok_or(FlipEdgeError::Missing(e))?;
        // L = h n .. p and R = t m .. q, with n: b -> c and m: a -> d.
        let (h, t) = (2 * e, 2 * e + 1);
        let (n, p) = (self.next[h as usize], self.prev[h as usize]);
        let (m, q) = (self.next[t as usize], self.prev[t as usize]);
        let (a, b) = (self.origin[h as usize], self.origin[t as usize]);
        let (c, d) = (self.target_slot(n), self.target_slot(m));
        let (after_n, after_m) = (self.next[n as usize], self.next[m as usize]);
        let (f, g) = (self.face[h as usize], self.face[t as usize]);
        // Each face keeps its own data at the corner it keeps; that at its new corner comes from the other face.
        self.copy_corner(h, m);
        self.copy_corner(t, n);
        self.copy_corner(after_m, h);
        self.copy_corner(after_n, t);
        // L becomes .. p m h, and R becomes .. q n t.
        self.link(p, m);
        self.link(m, h);
        self.link(h, after_n);
        self.link(q, n);
        self.link(n, t);
        self.link(t, after_m);
        self.set_face(m, f);
        self.set_face(n, g);
        self.set_origin(h, d);
        self.set_origin(t, c);
        for (v, lost, other) in [(a, h, m), (b, t, n)] {
            if self.vertex_halfedge[v as usize] == lost {
                self.set_vertex_halfedge(v, other);
            }
        }
        // The first corner stays if its vertex does.
        for (face, own, kept, left) in [(f, h, m, n), (g, t, n, m)] {
            let first = self.face_halfedge[face as usize];
            if first == own {
                self.set_face_halfedge(face, kept);
            } else if first == left {
                self.set_face_halfedge(face, own);
            }
        }
        Ok(())
    }

    /// Whether [`flip_edge`](Self::flip_edge) would be done.
    ///
    /// # Errors
    /// As there.
    pub fn check_flip_edge(&self, e: EdgeKey) -> Result<(), FlipEdgeError> {
        let slot = self.edge_slot(e).ok_or(FlipEdgeError::Missing(e))?;
        let (h, t) = (2 * slot, 2 * slot + 1);
        if self.is_open(h) || self.is_open(t) {
            return Err(FlipEdgeError::Boundary(e));
        }
        let (n, m) = (self.next[h as usize], self.next[t as usize]);
        let (c, d) = (self.target_slot(n), self.target_slot(m));
        // The new end of each face must not be one of its corners; in triangles that is the same for both.
        for (h, new) in [(h, d), (t, c)] {
            if c == d || !self.is_triangle(h) && self.loop_slots(h).any(|h| self.origin[h as usize] == new) {
                let face = self.faces.key(self.face[h as usize]);
                return Err(FlipEdgeError::RepeatedVertex { face, vertex: self.vertices.key(new) });
            }
        }
        match self.find_slot(c, d) {
            Some(h) => Err(FlipEdgeError::Joined(self.edges.key(h >> 1))),
            None => Ok(()),
        }
    }
}
