//! Filling a hole with one face.

use crate::{FaceKey, HalfedgeKey, Mesh};

/// Why a hole was not filled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FillHoleError {
    /// The key names no live half-edge.
    #[error("{0:?} is not a half-edge of the mesh")]
    Missing(HalfedgeKey),
    /// The half-edge has a face.
    #[error("{0:?} has a face")]
    NotBoundary(HalfedgeKey),
    /// The hole is the outside of one face: it would be there twice.
    #[error("{0:?} has the same corners")]
    Duplicate(FaceKey),
}

impl Mesh {
    /// Fills the hole along a boundary loop with one face, whose first corner is where the half-edge starts. No vertex
    /// or edge is made; [`triangulate_face`](Self::triangulate_face) or [`poke_face`](Self::poke_face) cut it up.
    ///
    /// ```text
    ///   ●───●───●        ●───●───●
    ///   │ ╱   ╲ │        │ ╱   ╲ │
    ///   ●       ●   →    ●   f   ●
    ///   │ ╲   ╱ │        │ ╲   ╱ │
    ///   ●───●───●        ●───●───●
    /// ```
    ///
    /// O(length of the loop).
    ///
    /// # Errors
    /// [`FillHoleError`]; nothing has changed then.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    /// # let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3]];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &faces)?)?;
    /// let h = mesh.boundary_halfedges().next().unwrap();
    /// mesh.fill_hole(h)?;
    /// assert!(mesh.is_closed());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn fill_hole(&mut self, h: HalfedgeKey) -> Result<FaceKey, FillHoleError> {
        let first = self.plan_fill(h)?;
        let f = self.new_face(first, None);
        let mut h = first;
        loop {
            self.set_face(h, f);
            h = self.next[h as usize];
            if h == first {
                return Ok(self.faces.key(f));
            }
        }
    }

    /// Whether [`fill_hole`](Self::fill_hole) would be done.
    ///
    /// # Errors
    /// As there.
    pub fn check_fill_hole(&self, h: HalfedgeKey) -> Result<(), FillHoleError> {
        self.plan_fill(h).map(|_| ())
    }

    fn plan_fill(&self, h: HalfedgeKey) -> Result<u32, FillHoleError> {
        let first = self.halfedge_slot(h).ok_or(FillHoleError::Missing(h))?;
        if !self.is_open(first) {
            return Err(FillHoleError::NotBoundary(h));
        }
        match self.is_closed_off(self.loop_slots(first)) {
            Some(f) => Err(FillHoleError::Duplicate(self.faces.key(f))),
            None => Ok(first),
        }
    }
}
