//! Stitching two boundary edges.

use super::{Few, Slots};
use crate::column::{Event, Kind};
use crate::{EdgeKey, FaceKey, HalfedgeKey, Mesh, VertexKey};

/// Why edges were not stitched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum StitchError {
    /// The key names no live half-edge.
    #[error("{0:?} is not a half-edge of the mesh")]
    Missing(HalfedgeKey),
    /// The half-edge has a face.
    #[error("{0:?} has a face")]
    NotBoundary(HalfedgeKey),
    /// Both half-edges are the same.
    #[error("{0:?} cannot be stitched to itself")]
    SameEdge(HalfedgeKey),
    /// Two vertices that would become one are joined by an edge.
    #[error("{0:?} joins two vertices that would become one")]
    Joined(EdgeKey),
    /// Two edges would join the same vertices.
    #[error("{0:?} and {1:?} would join the same vertices")]
    Parallel(EdgeKey, EdgeKey),
    /// A face has two vertices that would become one.
    #[error("{0:?} has two vertices that would become one")]
    CommonFace(FaceKey),
}

/// What [`Mesh::stitch`] did.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stitched {
    /// The edge that is left: that of the first half-edge, with its two vertices where they were.
    pub edge: EdgeKey,
    /// The edge that is gone.
    pub dead_edge: EdgeKey,
    /// The vertices that are gone: those of the second half-edge that were not vertices of the first.
    pub dead_vertices: Few<VertexKey>,
}

impl Mesh {
    /// Stitches two boundary half-edges together, against each other's direction: they become one edge with a face on
    /// either side. The second one's ends are merged into the first one's, which stay where they are.
    ///
    /// ```text
    ///   ────── ● ── first → ●        ─────────
    ///          :            :    →   ● ───── ●
    ///   ────── ● ← second ─ ●        ─────────
    /// ```
    ///
    /// A slit of two edges between the same vertices is no valid boundary, so the last two pairs of edges of a closing seam
    /// are refused as [`Parallel`](StitchError::Parallel). O(valences of the four ends, with sorts).
    ///
    /// # Errors
    /// [`StitchError`]; nothing has changed then.
    ///
    /// # Examples
    /// ```
    /// use meshwright::{Mesh, glam::DVec3};
    /// let mut mesh = Mesh::default();
    /// let mut triangle = |corners: [DVec3; 3]| {
    ///     let keys = corners.map(|p| mesh.add_vertex(p).unwrap());
    ///     mesh.add_face(&keys).unwrap();
    ///     keys
    /// };
    /// let [a, b, _] = triangle([DVec3::ZERO, DVec3::X, DVec3::Y]);
    /// let [c, d, _] = triangle([DVec3::X, DVec3::ZERO, DVec3::NEG_Y]);
    /// let first = mesh.find_halfedge(b, a).unwrap();
    /// let second = mesh.find_halfedge(d, c).unwrap();
    /// let done = mesh.stitch(first, second)?;
    /// assert!(!mesh.is_boundary_edge(done.edge));
    /// assert_eq!((mesh.vertex_count(), done.dead_vertices.len()), (4, 2));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn stitch(&mut self, first: HalfedgeKey, second: HalfedgeKey) -> Result<Stitched, StitchError> {
        let [h, s] = self.plan_stitch(first, second)?;
        // h: a -> b and s: c -> d, to be b -> a; d becomes a and c becomes b.
        let (a, b) = (self.origin[h as usize], self.target_slot(h));
        let (c, d) = (self.origin[s as usize], self.target_slot(s));
        let (inner, f) = (s ^ 1, self.face[s as usize ^ 1]);
        let (h_before, h_after) = (self.prev[h as usize], self.next[h as usize]);
        let (s_before, s_after) = (self.prev[s as usize], self.next[s as usize]);
        let mut dead_vertices = Few::new();
        for (stays, goes) in [(a, d), (b, c)] {
            if stays == goes {
                continue;
            }
            self.mix(Kind::Vertex, Event::Merge, stays, &[(stays, 1.0), (goes, 0.0)]);
            for out in self.spokes(goes) {
                self.set_origin(out, stays);
            }
        }
        self.mix(Kind::Edge, Event::Merge, h >> 1, &[(h >> 1, 0.5), (s >> 1, 0.5)]);
        // The first half-edge takes the place that the second one's twin has in its face.
        self.copy_corner(inner, h);
        self.set_face(h, f);
        let (before, after) = (self.prev[inner as usize], self.next[inner as usize]);
        self.link(before, h);
        self.link(h, after);
        if self.face_halfedge[f as usize] == inner {
            self.set_face_halfedge(f, h);
        }
        // The boundary closes over each end, unless it ends there.
        if a == d {
            self.set_vertex_halfedge(a, h);
        } else {
            self.link(h_before, s_after);
            self.set_vertex_halfedge(a, s_after);
        }
        if b == c {
            self.set_vertex_halfedge(b, h ^ 1);
        } else {
            self.link(s_before, h_after);
            self.set_vertex_halfedge(b, h_after);
        }
        let dead_edge = self.drop_edge(s >> 1, Some(h >> 1));
        for (stays, goes) in [(a, d), (b, c)] {
            if stays != goes {
                dead_vertices.push(self.drop_vertex(goes, Some(stays)));
            }
        }
        Ok(Stitched { edge: self.edges.key(h >> 1), dead_edge, dead_vertices })
    }

    /// Whether [`stitch`](Self::stitch) would be done.
    ///
    /// # Errors
    /// As there.
    pub fn check_stitch(&self, first: HalfedgeKey, second: HalfedgeKey) -> Result<(), StitchError> {
        self.plan_stitch(first, second).map(|_| ())
    }

    fn plan_stitch(&self, first: HalfedgeKey, second: HalfedgeKey) -> Result<[u32; 2], StitchError> {
        let slot = |key: HalfedgeKey| match self.halfedge_slot(key) {
            None => Err(StitchError::Missing(key)),
            Some(h) if !self.is_open(h) => Err(StitchError::NotBoundary(key)),
            Some(h) => Ok(h),
        };
        let (h, s) = (slot(first)?, slot(second)?);
        if h == s {
            return Err(StitchError::SameEdge(first));
        }
        let (a, b) = (self.origin[h as usize], self.target_slot(h));
        let (c, d) = (self.origin[s as usize], self.target_slot(s));
        let merged = |v: u32| {
            if v == d {
                a
            } else if v == c {
                b
            } else {
                v
            }
        };
        for (stays, goes) in [(a, d), (b, c)].into_iter().filter(|(stays, goes)| stays != goes) {
            if let Some(e) = self.find_slot(stays, goes) {
                return Err(StitchError::Joined(self.edges.key(e >> 1)));
            }
            let faces =
                |v: u32| self.outgoing_slots(v).filter(|&h| !self.is_open(h)).map(|h| self.face[h as usize]);
            let mut beside: Slots = faces(stays).collect();
            beside.sort_unstable();
            if let Some(f) = faces(goes).find(|f| beside.binary_search(f).is_ok()) {
                return Err(StitchError::CommonFace(self.faces.key(f)));
            }
            let edges = |v: u32| self.outgoing_slots(v).map(|e| (merged(self.target_slot(e)), e >> 1));
            let mut all: smallvec::SmallVec<[(u32, u32); 16]> = edges(stays).chain(edges(goes)).collect();
            all.sort_unstable();
            let stitched = |e: u32| e == h >> 1 || e == s >> 1;
            for pair in all.windows(2).filter(|w| w[0].0 == w[1].0) {
                if !(stitched(pair[0].1) && stitched(pair[1].1)) {
                    let [e, g] = [pair[0].1, pair[1].1].map(|e| self.edges.key(e));
                    return Err(StitchError::Parallel(e, g));
                }
            }
        }
        // Two faces of the same corners would have come with parallel edges: those next to the stitched ones.
        Ok([h, s])
    }
}
