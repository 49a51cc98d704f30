//! Cutting a face into triangles.

use super::{Few, SplitFace};
use crate::geometry::triangulate::Triangulator;
use crate::{EdgeKey, FaceKey, Mesh};
use smallvec::SmallVec;

/// Why a face was not cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TriangulateFaceError {
    /// The key names no live face.
    #[error("{0:?} is not a face of the mesh")]
    Missing(FaceKey),
    /// A diagonal of the rule is an edge of the mesh already.
    #[error("{0:?} lies where a diagonal would")]
    Joined(EdgeKey),
}

/// What [`Mesh::triangulate_face`] made.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TriangulatedFace {
    /// For each diagonal the triangle it cut off; the face itself is the last that was left. None if it was a triangle.
    pub cuts: Few<SplitFace>,
}

impl Mesh {
    /// Cuts a face into triangles by the one rule that the whole crate uses: ears in the plane of its area vector, or for
    /// a quad the shorter diagonal that lies inside. A quad whose diagonal is an edge already takes the other one; a larger
    /// face of which a diagonal is an edge already is refused, as any other cut would not be that of the rule: part the
    /// edge with [`split_edge`](Self::split_edge) first, or cut by hand with [`split_face`](Self::split_face).
    ///
    /// ```text
    ///   ●───────●        ●───────●
    ///   │       │        │     ╱ │
    ///   │       │   →    │   ╱   │
    ///   │       │        │ ╱     │
    ///   ●───────●        ●───────●
    /// ```
    ///
    /// O(n log n) in the degree, and the valences of the corners.
    ///
    /// # Errors
    /// [`TriangulateFaceError`]; nothing has changed then.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y];
    /// # let mut mesh = Mesh::build(&IndexedMesh::new(points, vec![vec![0, 1, 2, 3]].into())?)?;
    /// let quad = mesh.faces().next().unwrap();
    /// assert_eq!(mesh.triangulate_face(quad)?.cuts.len(), 1);
    /// assert!(mesh.faces().all(|f| mesh.degree(f) == 3));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn triangulate_face(&mut self, f: FaceKey) -> Result<TriangulatedFace, TriangulateFaceError> {
        let ears = self.plan_triangulation(f)?;
        let slot = self.face_slot(f).ok_or(TriangulateFaceError::Missing(f))?;
        // The half-edge of what is left of the face that starts at each corner, by vertex.
        let corners = self.loop_slots(self.face_halfedge[slot as usize]);
        let mut at: SmallVec<[(u32, u32); 8]> = corners.map(|h| (self.origin[h as usize], h)).collect();
        at.sort_unstable();
        let mut cuts = Few::new();
        // The last triangle is what is left.
        for [p, _, q] in ears.into_iter().rev().skip(1).rev() {
            let find = |v: u32| at.binary_search_by_key(&v, |a| a.0).unwrap_or(0);
            // The face keeps what begins at q; the ear p, i, q goes, and its diagonal stands in for it at p.
            let (i, j) = (find(p), find(q));
            let (face, diagonal) = self.cut_face(at[j].1, at[i].1);
            at[i].1 = 2 * diagonal + 1;
            cuts.push(SplitFace { face: self.faces.key(face), edge: self.edges.key(diagonal) });
        }
        Ok(TriangulatedFace { cuts })
    }

    /// Whether [`triangulate_face`](Self::triangulate_face) would be done.
    ///
    /// # Errors
    /// As there.
    pub fn check_triangulate_face(&self, f: FaceKey) -> Result<(), TriangulateFaceError> {
        self.plan_triangulation(f).map(|_| ())
    }

    /// The triangles as vertices, in the winding of the face: each but the last is an ear of what the ones before left,
    /// with its tip in the middle.
    fn plan_triangulation(&self, f: FaceKey) -> Result<Vec<[u32; 3]>, TriangulateFaceError> {
        let slot = self.face_slot(f).ok_or(TriangulateFaceError::Missing(f))?;
        let corners: SmallVec<[u32; 8]> =
            self.loop_slots(self.face_halfedge[slot as usize]).map(|h| self.origin[h as usize]).collect();
        let mut rule = Triangulator::default();
        let triangles =
            rule.triangulate_by(&corners, |v| self.vertices.rank(v), |v| self.positions[v as usize]);
        // The rule may read the face backwards; an ear's tip is the corner between its neighbours in what is left.
        let ears = in_order(&corners, triangles);
        match self.blocked(&ears) {
            None => Ok(ears),
            Some(_) if corners.len() == 4 => {
                let tip = (0..4).find(|&i| corners[i] == ears[0][1]).unwrap_or(0);
                let at = |i: usize| corners[(tip + i) % 4];
                let other = vec![[at(0), at(1), at(2)], [at(2), at(3), at(0)]];
                self.blocked(&other).map_or(Ok(other), |e| Err(TriangulateFaceError::Joined(e)))
            }
            Some(e) => Err(TriangulateFaceError::Joined(e)),
        }
    }

    /// An edge where a diagonal would be.
    fn blocked(&self, ears: &[[u32; 3]]) -> Option<EdgeKey> {
        let diagonals = ears.iter().rev().skip(1).rev();
        diagonals.filter_map(|&[p, _, q]| self.find_slot(p, q)).next().map(|h| self.edges.key(h >> 1))
    }
}

/// Turns each triangle so that its tip, the corner that leaves the polygon with it, stands in the middle.
fn in_order(corners: &[u32], triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let n = corners.len();
    let mut place: SmallVec<[(u32, u32); 8]> = corners.iter().copied().zip(0..).collect();
    place.sort_unstable();
    let place_of = |v: u32| place[place.binary_search_by_key(&v, |p| p.0).unwrap_or(0)].1 as usize;
    let mut next: SmallVec<[usize; 8]> = (0..n).map(|i| (i + 1) % n).collect();
    let mut prev: SmallVec<[usize; 8]> = (0..n).map(|i| (i + n - 1) % n).collect();
    let mut out = Vec::with_capacity(triangles.len());
    for &t in triangles {
        let mut ear = t;
        for turn in 0..3 {
            let [p, i, q] = [t[turn], t[(turn + 1) % 3], t[(turn + 2) % 3]];
            let tip = place_of(i);
            if (prev[tip], next[tip]) == (place_of(p), place_of(q)) {
                ear = [p, i, q];
                (next[prev[tip]], prev[next[tip]]) = (next[tip], prev[tip]);
                break;
            }
        }
        out.push(ear);
    }
    out
}
