//! Splitting a face along a diagonal.

use crate::{EdgeKey, FaceKey, HalfedgeKey, Mesh};

/// Why a face was not split.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SplitFaceError {
    /// The key names no live half-edge.
    #[error("{0:?} is not a half-edge of the mesh")]
    Missing(HalfedgeKey),
    /// The half-edge has no face.
    #[error("{0:?} has no face")]
    Boundary(HalfedgeKey),
    /// The corners are those of two faces.
    #[error("the corners lie in {0:?} and {1:?}")]
    DifferentFaces(FaceKey, FaceKey),
    /// The two corners are one.
    #[error("both corners are that of {0:?}")]
    SameCorner(HalfedgeKey),
    /// The two vertices are joined by an edge already: of this face or of others.
    #[error("{0:?} joins the corners already")]
    Joined(EdgeKey),
}

/// What [`Mesh::split_face`] made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SplitFace {
    /// The new face: the part that begins at the second corner.
    pub face: FaceKey,
    /// The diagonal; its [half-edge](Mesh::edge_halfedge) runs from the first corner to the second and has the new face.
    pub edge: EdgeKey,
}

impl Mesh {
    /// Splits a face along the diagonal between two of its corners, each given by the half-edge of the face that starts
    /// there.
    ///
    /// ```text
    ///   ●── from ──●        ●─────────●
    ///   │          │        │ ╲       │
    ///   │    f     │   →    │   ╲  f  │     f keeps the part that begins with `from`.
    ///   │          │        │ new ╲   │
    ///   ●──  to  ──●        ●─────────●
    /// ```
    ///
    /// O(corners of the new face + valence).
    ///
    /// # Errors
    /// [`SplitFaceError`]; nothing has changed then.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y];
    /// # let mut mesh = Mesh::build(&IndexedMesh::new(points, vec![vec![0, 1, 2, 3]].into())?)?;
    /// let quad = mesh.faces().next().unwrap();
    /// let corners: Vec<_> = mesh.face_halfedges(quad).collect();
    /// let new = mesh.split_face(corners[0], corners[2])?;
    /// assert_eq!((mesh.degree(quad), mesh.degree(new.face)), (3, 3));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn split_face(&mut self, from: HalfedgeKey, to: HalfedgeKey) -> Result<SplitFace, SplitFaceError> {
        let [a, b] = self.plan_split_face(from, to)?;
        let (face, edge) = self.cut_face(a, b);
        Ok(SplitFace { face: self.faces.key(face), edge: self.edges.key(edge) })
    }

    /// Whether [`split_face`](Self::split_face) would be done.
    ///
    /// # Errors
    /// As there.
    pub fn check_split_face(&self, from: HalfedgeKey, to: HalfedgeKey) -> Result<(), SplitFaceError> {
        self.plan_split_face(from, to).map(|_| ())
    }

    fn plan_split_face(&self, from: HalfedgeKey, to: HalfedgeKey) -> Result<[u32; 2], SplitFaceError> {
        let slot = |h: HalfedgeKey| {
            let slot = self.halfedge_slot(h).ok_or(SplitFaceError::Missing(h))?;
            let face = self.face_key(self.face[slot as usize]).ok_or(SplitFaceError::Boundary(h))?;
            Ok((slot, face))
        };
        let ((a, f), (b, g)) = (slot(from)?, slot(to)?);
        if f != g {
            return Err(SplitFaceError::DifferentFaces(f, g));
        }
        if a == b {
            return Err(SplitFaceError::SameCorner(from));
        }
        match self.find_slot(self.origin[a as usize], self.origin[b as usize]) {
            Some(h) => Err(SplitFaceError::Joined(self.edges.key(h >> 1))),
            None => Ok([a, b]),
        }
    }

    /// The new face and the diagonal between the corners of two half-edges of one face.
    pub(super) fn cut_face(&mut self, a: u32, b: u32) -> (u32, u32) {
        let f = self.face[a as usize];
        let (before_a, before_b) = (self.prev[a as usize], self.prev[b as usize]);
        let n = self.new_edge(self.origin[a as usize], self.origin[b as usize], None);
        let g = self.new_face(b, Some(f));
        self.copy_corner(a, n);
        self.copy_corner(b, n ^ 1);
        self.link(before_a, n);
        self.link(n, b);
        self.link(before_b, n ^ 1);
        self.link(n ^ 1, a);
        self.set_face(n ^ 1, f);
        // The first corner stays if its vertex does.
        let first = self.face_halfedge[f as usize];
        let mut h = b;
        loop {
            self.set_face(h, g);
            if h == first {
                self.set_face_halfedge(f, if h == b { n ^ 1 } else { a });
            }
            h = self.next[h as usize];
            if h == b {
                break;
            }
        }
        (g, n >> 1)
    }
}
