//! Filling a hole with one face; the links of a hole filled with triangles.

use crate::column::Kind;
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
    /// or edge is made; [`triangulate_face`](Self::triangulate_face) or [`poke_face`](Self::poke_face) cut it up, and
    /// [`triangulate_hole`](Self::triangulate_hole) fills it with triangles of least area.
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
        let f = self.fill_with_face(first);
        Ok(self.faces.key(f))
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
    fn fill_with_face(&mut self, first: u32) -> u32 {
        let f = self.new_face(first, None);
        let mut h = first;
        loop {
            self.set_face(h, f);
            h = self.next[h as usize];
            if h == first {
                return f;
            }
        }
    }

    /// Fills a boundary loop with triangles, given by the numbers of their corners along the loop: each but the last is an
    /// ear of what the ones before left, its tip in the middle. With one face if there are none. The group is that of all.
    ///
    /// The caller has made sure that no diagonal is an edge, and that the face does not exist.
    pub(crate) fn fill_loop(&mut self, first: u32, ears: &[[u32; 3]], group: Option<u32>) -> Vec<FaceKey> {
        // The half-edge of what is left that starts at each corner.
        let mut at: Vec<u32> = self.loop_slots(first).collect();
        let f = self.fill_with_face(first);
        if let (Some(group), Some(column)) = (group, self.carried.groups) {
            self.write_value(Kind::Face, column.index, f, group);
        }
        let mut faces = vec![self.faces.key(f)];
        for &[p, _, q] in ears.iter().rev().skip(1).rev() {
            let (face, diagonal) = self.cut_face(at[q as usize], at[p as usize]);
            at[p as usize] = 2 * diagonal + 1;
            faces.push(self.faces.key(face));
        }
        faces
    }
}
