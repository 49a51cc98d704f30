//! Edge loops and edge rings: the straight lines of quads.

use super::EdgeChain;
use crate::matching::NONE;
use crate::mesh::read;
use crate::{HalfedgeKey, Mesh};

impl Mesh {
    read! {
        /// The edge loop through a half-edge: straight on from edge to edge.
        ///
        /// At an inner vertex with four edges it takes the one opposite; at any other it ends, and at the boundary,
        /// whatever the faces are. A boundary edge's loop is its boundary loop. All half-edges run the way the given
        /// one does; an open loop is listed from its first edge to its last, the given one somewhere between, a
        /// closed one from the given one on. It may cross itself and holds each edge once all the same. O(edges
        /// found).
        ///
        /// # Examples
        /// ```
        /// # use meshwright::{IndexedMesh, Mesh, Polygons, glam::DVec3};
        /// # let points = (0..9).map(|i| DVec3::X * f64::from(i % 3) + DVec3::Y * f64::from(i / 3)).collect();
        /// # let quads: Polygons = [0, 1, 3, 4].map(|a| [a, a + 1, a + 4, a + 3]).into_iter().collect();
        /// # let mesh = Mesh::build(&IndexedMesh::new(points, quads)?)?;
        /// // Two by two squares; from the middle of an outer side through the centre.
        /// let v: Vec<_> = mesh.vertices().collect();
        /// let h = mesh.find_halfedge(v[1], v[4]).unwrap();
        /// let through = mesh.edge_loop(h);
        /// assert_eq!((through.halfedges.len(), through.closed), (2, false));
        /// assert!(mesh.edge_loop(mesh.find_halfedge(v[0], v[1]).unwrap()).closed, "the outline");
        /// # Ok::<(), Box<dyn std::error::Error>>(())
        /// ```
        edge_loop, get_edge_loop(self, h: HalfedgeKey => halfedge_slot) -> EdgeChain {
            self.chain(h, |h| self.straight_on(h))
        }
    }

    read! {
        /// The edge ring through a half-edge: across quads from each edge to the opposite one, as the rungs of a
        /// ladder.
        ///
        /// It ends at the boundary and at faces that are no quads. All half-edges run the way the given one does, so
        /// that the face of each is the quad crossed next; an open ring is listed from its first rung to its last,
        /// the given one somewhere between, a closed one from the given one on. It may cross itself and holds each
        /// edge once all the same. O(edges found).
        ///
        /// # Examples
        /// ```
        /// # use meshwright::{IndexedMesh, Mesh, Polygons, glam::DVec3};
        /// # let points = (0..8).map(|i| DVec3::X * f64::from(i / 2) + DVec3::Y * f64::from(i % 2)).collect();
        /// # let strip = Polygons::from(vec![vec![0, 2, 3, 1], vec![2, 4, 5, 3], vec![4, 6, 7, 5]]);
        /// # let mesh = Mesh::build(&IndexedMesh::new(points, strip)?)?;
        /// // A strip of three squares.
        /// let v: Vec<_> = mesh.vertices().collect();
        /// let ring = mesh.edge_ring(mesh.find_halfedge(v[2], v[3]).unwrap());
        /// assert_eq!((ring.halfedges.len(), ring.closed), (4, false));
        /// # Ok::<(), Box<dyn std::error::Error>>(())
        /// ```
        edge_ring, get_edge_ring(self, h: HalfedgeKey => halfedge_slot) -> EdgeChain {
            self.chain(h, |h| self.across_quad(h))
        }
    }

    /// Half-edges from `h` on by `step` and, if that does not come back to `h`, from before it.
    ///
    /// `step` must be reversible: `step(h) == g` exactly when `step(twin(g)) == twin(h)`. Then it is one-to-one, a
    /// walk that comes back to any half-edge comes back to its first, and stepping from the twin leads backwards.
    pub(super) fn chain(&self, h: u32, step: impl Fn(u32) -> Option<u32>) -> EdgeChain {
        let mut forth = vec![h];
        let mut at = h;
        let closed = loop {
            match step(at) {
                Some(next) if next == h => break true,
                Some(next) => {
                    forth.push(next);
                    at = next;
                }
                None => break false,
            }
        };
        let mut all = Vec::new();
        if !closed {
            all.extend(std::iter::successors(step(h ^ 1), |&b| step(b)).map(|b| b ^ 1));
            all.reverse();
        }
        all.append(&mut forth);
        EdgeChain { halfedges: all.into_iter().map(|h| self.halfedge_key(h)).collect(), closed }
    }

    /// The half-edge that follows in an edge loop.
    fn straight_on(&self, h: u32) -> Option<u32> {
        if self.face[h as usize] == NONE {
            return Some(self.next[h as usize]);
        }
        if self.face[h as usize ^ 1] == NONE {
            return Some(self.prev[h as usize ^ 1] ^ 1);
        }
        let cw = |h: u32| self.next[h as usize ^ 1];
        let target = self.origin[h as usize ^ 1];
        if self.face[self.vertex_halfedge[target as usize] as usize] == NONE {
            return None;
        }
        let ahead = cw(cw(h ^ 1));
        // Around in four steps and not in two: four edges.
        (ahead != h ^ 1 && cw(cw(ahead)) == h ^ 1).then_some(ahead)
    }

    /// The half-edge that follows in an edge ring.
    fn across_quad(&self, h: u32) -> Option<u32> {
        if self.face[h as usize] == NONE {
            return None;
        }
        let opposite = self.next[self.next[h as usize] as usize];
        let back = self.next[self.next[opposite as usize] as usize];
        (opposite != h && back == h).then_some(opposite ^ 1)
    }
}
