//! Dissolving a vertex.

use super::{Few, Slots};
use crate::column::{Event, Kind};
use crate::matching::NONE;
use crate::{EdgeKey, FaceKey, Mesh, VertexKey};
use smallvec::SmallVec;

/// Why a vertex was not dissolved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DissolveVertexError {
    /// The key names no live vertex.
    #[error("{0:?} is not a vertex of the mesh")]
    Missing(VertexKey),
    /// No face names the vertex: [`remove_vertex`](Mesh::remove_vertex) takes it away.
    #[error("{0:?} is isolated")]
    Isolated(VertexKey),
    /// The faces around the vertex meet elsewhere too: the merged face would touch itself here.
    #[error("the merged face would name {0:?} twice")]
    RepeatedVertex(VertexKey),
    /// The edge that would close the gap is there already.
    #[error("{0:?} is there already")]
    Joined(EdgeKey),
    /// The merged face would have the corners of another.
    #[error("{0:?} would have the same corners")]
    Duplicate(FaceKey),
}

/// What [`Mesh::dissolve_vertex`] did.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DissolvedVertex {
    /// The faces that are left: one, or both around a vertex that lay between two edges.
    pub faces: Few<FaceKey>,
    /// The edge that now closes the gap, if the vertex lay on the boundary or between two edges; it was one of the two.
    pub edge: Option<EdgeKey>,
    /// The faces that are gone.
    pub dead_faces: Few<FaceKey>,
    /// The edges that are gone.
    pub dead_edges: Few<EdgeKey>,
}

impl Mesh {
    /// Dissolves a vertex: it goes with its edges, and the faces around it become one.
    ///
    /// ```text
    ///   ●───●───●        ●───●───●       A vertex between two edges only goes out of their faces, and the
    ///   │ ╲   ╱ │        │       │       two edges become one. On the boundary likewise: the faces become
    ///   │   ●   │   →    │       │       one, and one edge closes the gap.
    ///   │ ╱   ╲ │        │       │
    ///   ●───●───●        ●───●───●
    /// ```
    ///
    /// Euler characteristic, boundary loops and components stay what they are. Face data is merged by area.
    /// O(degrees of the faces, with a sort).
    ///
    /// # Errors
    /// [`DissolveVertexError`]; nothing has changed then.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y];
    /// # let mut mesh = Mesh::build(&IndexedMesh::new(points, vec![vec![0, 1, 2, 3]].into())?)?;
    /// let quad = mesh.faces().next().unwrap();
    /// let new = mesh.poke_face(quad, DVec3::new(0.5, 0.5, 0.0))?;
    /// let done = mesh.dissolve_vertex(new.vertex)?;
    /// assert_eq!((mesh.face_count(), done.dead_faces.len()), (1, 3));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn dissolve_vertex(&mut self, v: VertexKey) -> Result<DissolvedVertex, DissolveVertexError> {
        self.check_dissolve_vertex(v)?;
        let v = self.vertex_slot(v).ok_or(DissolveVertexError::Missing(v))?;
        let spokes = self.spokes(v);
        if spokes.len() == 2 {
            return Ok(self.take_out(spokes[0], spokes[1]));
        }
        Ok(self.merge_around(v, &spokes))
    }

    /// Whether [`dissolve_vertex`](Self::dissolve_vertex) would be done.
    ///
    /// # Errors
    /// As there.
    pub fn check_dissolve_vertex(&self, v: VertexKey) -> Result<(), DissolveVertexError> {
        let slot = self.vertex_slot(v).ok_or(DissolveVertexError::Missing(v))?;
        if self.vertex_halfedge[slot as usize] == NONE {
            return Err(DissolveVertexError::Isolated(v));
        }
        let spokes = self.spokes(slot);
        let ends = [spokes[0], spokes[spokes.len() - 1]].map(|h| self.target_slot(h));
        let is_open = self.is_open(spokes[0]);
        if (is_open || spokes.len() == 2)
            && let Some(h) = self.find_slot(ends[0], ends[1])
        {
            return Err(DissolveVertexError::Joined(self.edges.key(h >> 1)));
        }
        if spokes.len() == 2 {
            return Ok(());
        }
        let rim = self.rim(&spokes);
        let mut corners: Slots = rim.iter().map(|&h| self.origin[h as usize]).collect();
        if is_open {
            corners.push(ends[0]);
        }
        corners.sort_unstable();
        if let Some(twice) = corners.windows(2).find(|w| w[0] == w[1]) {
            return Err(DissolveVertexError::RepeatedVertex(self.vertices.key(twice[0])));
        }
        if !is_open && let Some(f) = self.is_closed_off(rim.iter().copied()) {
            return Err(DissolveVertexError::Duplicate(self.faces.key(f)));
        }
        Ok(())
    }

    /// The half-edges of the faces around a vertex that do not touch it, counter-clockwise: from the target of the last
    /// spoke to that of the first on the boundary, all around inside.
    fn rim(&self, spokes: &[u32]) -> Slots {
        let mut rim = Slots::new();
        for &out in spokes.iter().rev().filter(|&&h| !self.is_open(h)) {
            let mut h = self.next[out as usize];
            while self.target_slot(h) != self.origin[out as usize] {
                rim.push(h);
                h = self.next[h as usize];
            }
        }
        rim
    }

    /// Takes a vertex out from between two edges, of which the first stays.
    fn take_out(&mut self, stays: u32, goes: u32) -> DissolvedVertex {
        // a <-stays- v -goes-> b becomes a <-stays- b.
        let (v, b) = (self.origin[stays as usize], self.target_slot(goes));
        let (f, g) = (self.face[stays as usize], self.face[goes as usize]);
        let (before, after) = (self.prev[goes as usize ^ 1], self.next[goes as usize]);
        self.mix(Kind::Edge, Event::Merge, stays >> 1, &[(stays >> 1, 0.5), (goes >> 1, 0.5)]);
        if f != NONE {
            // The corner of b in f began at the twin of the edge that goes.
            self.copy_corner(goes ^ 1, stays);
            if self.face_halfedge[f as usize] == goes ^ 1 {
                self.set_face_halfedge(f, stays);
            }
        }
        if g != NONE && self.face_halfedge[g as usize] == goes {
            self.set_face_halfedge(g, after);
        }
        self.set_origin(stays, b);
        self.link(before, stays);
        self.link(stays ^ 1, after);
        if self.vertex_halfedge[b as usize] == goes ^ 1 {
            self.set_vertex_halfedge(b, stays);
        }
        let dead = self.drop_edge(goes >> 1, Some(stays >> 1));
        self.drop_vertex(v, None);
        DissolvedVertex {
            faces: [f, g].into_iter().filter_map(|f| self.face_key(f)).collect(),
            edge: Some(self.edges.key(stays >> 1)),
            dead_faces: Few::new(),
            dead_edges: Few::from_slice(&[dead]),
        }
    }

    /// Merges the faces around a vertex of three or more edges.
    fn merge_around(&mut self, v: u32, spokes: &[u32]) -> DissolvedVertex {
        let rim = self.rim(spokes);
        let is_open = self.is_open(spokes[0]);
        let faces: Slots = spokes.iter().map(|&h| self.face[h as usize]).filter(|&f| f != NONE).collect();
        let f = faces[0];
        if !self.columns.none_on(Kind::Face) {
            let weights: SmallVec<[f64; 12]> = faces.iter().map(|&f| self.face_weight(f)).collect();
            let sum: f64 = weights.iter().sum();
            let share = |w: f64| if sum.is_finite() { w / sum } else { 1.0 / weights.len() as f64 };
            let sources: SmallVec<[(u32, f64); 12]> =
                faces.iter().zip(&weights).map(|(&f, &w)| (f, share(w))).collect();
            self.mix(Kind::Face, Event::Merge, f, &sources);
        }
        // Where two faces met at a spoke, the corner of the one counter-clockwise ends the rim's part before it; the
        // other, whose half-edge stays, takes in what went with the spoke.
        for &out in spokes {
            if self.is_open(out) || self.is_open(out ^ 1) {
                continue;
            }
            let stays = self.next[out as usize];
            self.mix(Kind::Corner, Event::Merge, stays, &[(stays, 0.5), (out ^ 1, 0.5)]);
        }
        let closing = is_open.then(|| {
            // The first spoke, turned to run from the last one's target, is the edge that closes the gap.
            let (gap, last) = (spokes[0], spokes[spokes.len() - 1]);
            let from = self.target_slot(last);
            let (before, after) = (self.prev[last as usize ^ 1], self.next[gap as usize]);
            self.set_origin(gap, from);
            self.link(before, gap);
            self.link(gap, after);
            if self.vertex_halfedge[from as usize] == last ^ 1 {
                self.set_vertex_halfedge(from, gap);
            }
            gap ^ 1
        });
        let loop_: Slots = rim.iter().copied().chain(closing).collect();
        for (i, &h) in loop_.iter().enumerate() {
            self.link(h, loop_[(i + 1) % loop_.len()]);
            self.set_face(h, f);
            let at = self.origin[h as usize];
            // A vertex inside loses its spoke.
            if spokes.contains(&(self.vertex_halfedge[at as usize] ^ 1)) && Some(h) != closing {
                self.set_vertex_halfedge(at, h);
            }
        }
        let first = self.face_halfedge[f as usize];
        if !loop_.contains(&first) {
            let at = self.origin[first as usize];
            let same = loop_.iter().copied().find(|&h| self.origin[h as usize] == at);
            self.set_face_halfedge(f, same.unwrap_or(loop_[0]));
        }
        let kept_edge = closing.map(|h| h >> 1);
        let dead_edges = spokes.iter().map(|h| h >> 1).filter(|&e| Some(e) != kept_edge).collect::<Slots>();
        let done = DissolvedVertex {
            faces: Few::from_slice(&[self.faces.key(f)]),
            edge: kept_edge.map(|e| self.edges.key(e)),
            dead_edges: dead_edges.into_iter().map(|e| self.drop_edge(e, None)).collect(),
            dead_faces: faces[1..].iter().map(|&g| self.drop_face(g, Some(f))).collect(),
        };
        self.drop_vertex(v, None);
        done
    }
}
