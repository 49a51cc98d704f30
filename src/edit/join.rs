//! Joining two faces.

use super::{Few, Slots};
use crate::column::{Event, Kind};
use crate::{EdgeKey, FaceKey, Mesh, VertexKey};

/// Why faces were not joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum JoinFacesError {
    /// The key names no live edge.
    #[error("{0:?} is not an edge of the mesh")]
    Missing(EdgeKey),
    /// The edge has only one face.
    #[error("{0:?} lies on the boundary")]
    Boundary(EdgeKey),
    /// The faces share more than the edge, or the chain of edges it belongs to: the joined face would touch itself here.
    #[error("the faces also meet at {0:?}")]
    SharedVertex(VertexKey),
    /// The joined face would have the corners of another.
    #[error("{0:?} would have the same corners")]
    Duplicate(FaceKey),
}

/// What [`Mesh::join_faces`] did.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JoinedFaces {
    /// The face that is left: that of the edge's [half-edge](Mesh::edge_halfedge).
    pub face: FaceKey,
    /// The face that is gone.
    pub dead_face: FaceKey,
    /// The edges that are gone: the edge, and those that continue it between the two faces.
    pub dead_edges: Few<EdgeKey>,
    /// The vertices within that chain, which are gone too.
    pub dead_vertices: Few<VertexKey>,
}

impl Mesh {
    /// Joins the two faces at an edge into one. If the faces share a simple chain of edges, the whole chain goes, with
    /// the vertices within it.
    ///
    /// ```text
    ///   ●───────●───────●        ●───────●───────●
    ///   │   f   e       │   →    │       f       │
    ///   ●───────●───────●        ●───────●───────●
    /// ```
    ///
    /// Corners at the chain's ends are merged, so a seam along it is lost: see [`is_seam`](Self::is_seam). Face data is
    /// merged by area. O(degrees, with a sort).
    ///
    /// # Errors
    /// [`JoinFacesError`]; nothing has changed then.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2], [2, 1, 3]])?)?;
    /// let e = mesh.edges().find(|&e| !mesh.is_boundary_edge(e)).unwrap();
    /// let joined = mesh.join_faces(e)?;
    /// assert_eq!((mesh.face_count(), mesh.degree(joined.face)), (1, 4));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn join_faces(&mut self, e: EdgeKey) -> Result<JoinedFaces, JoinFacesError> {
        let chain = self.plan_join(e)?;
        let (first, last) = (chain[0], chain[chain.len() - 1]);
        let (f, g) = (self.face[first as usize], self.face[first as usize ^ 1]);
        let (u, w) = (self.origin[first as usize], self.target_slot(last));
        // The chain runs from u to w in f; in g its twins run back.
        let (f_before, f_after) = (self.prev[first as usize], self.next[last as usize]);
        let (g_before, g_after) = (self.prev[last as usize ^ 1], self.next[first as usize ^ 1]);
        if !self.columns.none_on(Kind::Face) {
            let weights = [self.face_weight(f), self.face_weight(g)];
            let sum: f64 = weights.iter().sum();
            let shares = if sum.is_finite() { weights.map(|w| w / sum) } else { [0.5, 0.5] };
            self.mix(Kind::Face, Event::Merge, f, &[(f, shares[0]), (g, shares[1])]);
        }
        self.mix(Kind::Corner, Event::Merge, g_after, &[(first, 0.5), (g_after, 0.5)]);
        self.mix(Kind::Corner, Event::Merge, f_after, &[(f_after, 0.5), (last ^ 1, 0.5)]);
        let mut h = g_after;
        while h != last ^ 1 {
            self.set_face(h, f);
            h = self.next[h as usize];
        }
        self.link(f_before, g_after);
        self.link(g_before, f_after);
        let at_first = self.face_halfedge[f as usize];
        if at_first == first {
            self.set_face_halfedge(f, g_after);
        } else if chain.contains(&at_first) {
            self.set_face_halfedge(f, f_after);
        }
        for (v, gone, instead) in [(u, first, g_after), (w, last ^ 1, f_after)] {
            if self.vertex_halfedge[v as usize] == gone {
                self.set_vertex_halfedge(v, instead);
            }
        }
        let within: Slots = chain[1..].iter().map(|&h| self.origin[h as usize]).collect();
        let dead_edges = chain.iter().map(|&h| self.drop_edge(h >> 1, None)).collect();
        let dead_vertices = within.iter().map(|&v| self.drop_vertex(v, None)).collect();
        let dead_face = self.drop_face(g, Some(f));
        Ok(JoinedFaces { face: self.faces.key(f), dead_face, dead_edges, dead_vertices })
    }

    /// Whether [`join_faces`](Self::join_faces) would be done.
    ///
    /// # Errors
    /// As there.
    pub fn check_join_faces(&self, e: EdgeKey) -> Result<(), JoinFacesError> {
        self.plan_join(e).map(|_| ())
    }

    /// The chain of half-edges that the two faces share, in the order of the first.
    fn plan_join(&self, e: EdgeKey) -> Result<Slots, JoinFacesError> {
        let slot = self.edge_slot(e).ok_or(JoinFacesError::Missing(e))?;
        let h = 2 * slot;
        if self.is_open(h) || self.is_open(h ^ 1) {
            return Err(JoinFacesError::Boundary(e));
        }
        // Where two edges of the chain meet, no third one does. The faces differ, so the chain ends.
        let mut first = h;
        while self.prev[first as usize] ^ 1 == self.next[first as usize ^ 1] {
            first = self.prev[first as usize];
        }
        let mut chain: Slots = Slots::from_slice(&[first]);
        let mut last = first;
        while self.next[last as usize] ^ 1 == self.prev[last as usize ^ 1] {
            last = self.next[last as usize];
            chain.push(last);
        }
        let rest = |after: u32, until: u32| {
            std::iter::successors(Some(after), |&h| Some(self.next[h as usize]))
                .take_while(move |&h| h != until)
        };
        let of_f = rest(self.next[last as usize], first);
        let of_g = rest(self.next[first as usize ^ 1], last ^ 1);
        // The ends of the chain are the first corners of the two rests.
        let mut corners: Slots =
            of_f.clone().skip(1).chain(of_g.clone().skip(1)).map(|h| self.origin[h as usize]).collect();
        corners.sort_unstable();
        if let Some(twice) = corners.windows(2).find(|w| w[0] == w[1]) {
            return Err(JoinFacesError::SharedVertex(self.vertices.key(twice[0])));
        }
        match self.is_closed_off(of_f.chain(of_g)) {
            Some(f) => Err(JoinFacesError::Duplicate(self.faces.key(f))),
            None => Ok(chain),
        }
    }
}
