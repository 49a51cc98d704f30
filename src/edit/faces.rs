//! Adding vertices and faces.

use super::Few;
use crate::matching::NONE;
use crate::{EdgeKey, FaceKey, Mesh, VertexKey};
use glam::DVec3;
use smallvec::SmallVec;

/// Why a vertex was not added.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AddVertexError {
    /// A coordinate is NaN or infinite.
    #[error("the position {0} is not finite")]
    NonFinite(DVec3),
}

/// Why a face was not added.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum AddFaceError {
    /// A key names no live vertex.
    #[error("{0:?} is not a vertex of the mesh")]
    Missing(VertexKey),
    /// Fewer than three corners.
    #[error("a face of {0} corners")]
    TooFewCorners(usize),
    /// A vertex is named twice.
    #[error("{0:?} is named twice")]
    RepeatedVertex(VertexKey),
    /// An edge has a face on that side already: it has two, or the face is wound the wrong way.
    #[error("{0:?} has a face on that side")]
    EdgeTaken(EdgeKey),
    /// A vertex has faces all around, or would get a second fan.
    #[error("{0:?} would get a second fan")]
    SecondFan(VertexKey),
    /// The mesh has the face already, the other way round.
    #[error("{0:?} has the same corners")]
    Duplicate(FaceKey),
}

/// What [`Mesh::add_face`] made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AddedFace {
    /// The new face; its first corner is the first vertex given.
    pub face: FaceKey,
    /// The new edges, in the order of the corners they start at.
    pub edges: Few<EdgeKey>,
}

impl Mesh {
    /// Adds an isolated vertex. O(1).
    ///
    /// # Errors
    /// [`AddVertexError`]; nothing has changed then.
    ///
    /// # Examples
    /// ```
    /// use meshwright::{Mesh, glam::DVec3};
    /// let mut mesh = Mesh::default();
    /// let v = mesh.add_vertex(DVec3::X)?;
    /// assert!(mesh.is_isolated(v));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn add_vertex(&mut self, position: DVec3) -> Result<VertexKey, AddVertexError> {
        self.check_add_vertex(position)?;
        let v = self.new_vertex(position, &[]);
        Ok(self.vertices.key(v))
    }

    /// Whether [`add_vertex`](Self::add_vertex) would be done.
    ///
    /// # Errors
    /// As there.
    pub fn check_add_vertex(&self, position: DVec3) -> Result<(), AddVertexError> {
        if position.is_finite() { Ok(()) } else { Err(AddVertexError::NonFinite(position)) }
    }

    /// Adds a face between vertices, given counter-clockwise as seen from outside.
    ///
    /// ```text
    ///   c           c
    ///                \       Edges that are there are used (their boundary half-edge
    ///   a ──── b     a ─── b  must run the face's way), others are made.
    /// ```
    ///
    /// Each vertex is isolated or on the boundary beforehand, and keeps one fan. O(degree + valences of the corners).
    ///
    /// # Errors
    /// [`AddFaceError`]; nothing has changed then.
    ///
    /// # Examples
    /// ```
    /// use meshwright::{Mesh, glam::DVec3};
    /// let mut mesh = Mesh::default();
    /// let [a, b, c, d] = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|p| mesh.add_vertex(p).unwrap());
    /// for face in [[a, c, b], [a, b, d], [b, c, d], [c, a, d]] {
    ///     mesh.add_face(&face)?;
    /// }
    /// assert!(mesh.is_closed());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn add_face(&mut self, vertices: &[VertexKey]) -> Result<AddedFace, AddFaceError> {
        let Plan { corners, mut inner } = self.plan_face(vertices)?;
        let n = corners.len();
        let is_new: SmallVec<[bool; 8]> = inner.iter().map(|&h| h == NONE).collect();
        // What joins the boundary at each corner, read before anything is written.
        let around: SmallVec<[(u32, u32); 8]> = (0..n)
            .map(|i| {
                let before = (i + n - 1) % n;
                let out = if is_new[before] { NONE } else { self.next[inner[before] as usize] };
                let into = if is_new[i] { NONE } else { self.prev[inner[i] as usize] };
                (into, out)
            })
            .collect();
        let mut edges = Few::new();
        for i in 0..n {
            if is_new[i] {
                inner[i] = self.new_edge(corners[i], corners[(i + 1) % n], None);
                edges.push(self.edges.key(inner[i] >> 1));
            }
        }
        for i in 0..n {
            let before = (i + n - 1) % n;
            let (came, goes) = (inner[before], inner[i]);
            let (into, out) = around[i];
            // The boundary half-edges that pass the corner afterwards; the one that leaves it is the vertex's (M13).
            match (is_new[before], is_new[i]) {
                (false, false) => {}
                (false, true) => self.link(goes ^ 1, out),
                (true, false) => {
                    self.link(into, came ^ 1);
                    self.set_vertex_halfedge(corners[i], came ^ 1);
                }
                (true, true) => {
                    self.link(goes ^ 1, came ^ 1);
                    self.set_vertex_halfedge(corners[i], came ^ 1);
                }
            }
        }
        let f = self.new_face(inner[0], None);
        for i in 0..n {
            self.link(inner[i], inner[(i + 1) % n]);
            self.set_face(inner[i], f);
        }
        Ok(AddedFace { face: self.faces.key(f), edges })
    }

    /// Whether [`add_face`](Self::add_face) would be done.
    ///
    /// # Errors
    /// As there.
    pub fn check_add_face(&self, vertices: &[VertexKey]) -> Result<(), AddFaceError> {
        self.plan_face(vertices).map(|_| ())
    }

    fn plan_face(&self, vertices: &[VertexKey]) -> Result<Plan, AddFaceError> {
        let n = vertices.len();
        if n < 3 {
            return Err(AddFaceError::TooFewCorners(n));
        }
        let corners = vertices
            .iter()
            .map(|&v| self.vertex_slot(v).ok_or(AddFaceError::Missing(v)))
            .collect::<Result<SmallVec<[u32; 8]>, _>>()?;
        let mut sorted = corners.clone();
        sorted.sort_unstable();
        if let Some(twice) = sorted.windows(2).find(|w| w[0] == w[1]) {
            return Err(AddFaceError::RepeatedVertex(self.vertices.key(twice[0])));
        }
        let mut inner = SmallVec::new();
        for i in 0..n {
            let h = self.find_slot(corners[i], corners[(i + 1) % n]).unwrap_or(NONE);
            if h != NONE && !self.is_open(h) {
                return Err(AddFaceError::EdgeTaken(self.edges.key(h >> 1)));
            }
            inner.push(h);
        }
        for i in 0..n {
            let (before, v) = (inner[(i + n - 1) % n], corners[i]);
            let is_isolated = self.vertex_halfedge[v as usize] == NONE;
            // Joined to neither of its edges, the face would be a fan of its own.
            if before == NONE && inner[i] == NONE && !is_isolated {
                return Err(AddFaceError::SecondFan(self.vertices.key(v)));
            }
        }
        if inner.iter().all(|&h| h != NONE)
            && let Some(f) = self.is_closed_off(inner.iter().copied())
        {
            return Err(AddFaceError::Duplicate(self.faces.key(f)));
        }
        Ok(Plan { corners, inner })
    }
}

/// A face that can be added: its corners, and the boundary half-edge at each that is there already.
struct Plan {
    corners: SmallVec<[u32; 8]>,
    inner: SmallVec<[u32; 8]>,
}
