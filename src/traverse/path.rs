//! Shortest paths along edges.

use super::slots::BySlot;
use crate::geometry::distance;
use crate::{HalfedgeKey, Mesh, VertexKey};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A path along edges from one vertex to another.
#[derive(Clone, Debug, PartialEq)]
pub struct EdgePath {
    /// Its half-edges in order, all running along the path; none if it begins where it ends.
    pub halfedges: Vec<HalfedgeKey>,
    /// The sum of what they cost: for [`Mesh::shortest_path`] the length, in the units of the positions.
    pub length: f64,
}

/// Why no shortest path was looked for.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PathError {
    /// The key names no live vertex.
    #[error("{0:?} is not a vertex of the mesh")]
    Missing(VertexKey),
    /// A cost is negative, NaN or infinite.
    #[error("{halfedge:?} costs {cost}, which is negative or not finite")]
    BadCost {
        /// The half-edge.
        halfedge: HalfedgeKey,
        /// What it is said to cost.
        cost: f64,
    },
}

/// What is known of a vertex that has been reached.
struct Label {
    length: f64,
    edges: u32,
    /// The half-edge it was reached by, unless it is the first vertex.
    by: u32,
}

impl Mesh {
    /// The shortest path along edges from `a` to `b`, or `None` if there is none.
    ///
    /// Of paths equally long (as f64 adds up, from `a` on) one with the fewest edges is taken; which of those is
    /// settled by storage order. Costs O(n log n) for the n half-edges at vertices nearer to `a` than `b` is; nothing
    /// else is looked at. (Dijkstra, "A note on two problems in connexion with graphs", 1959.)
    ///
    /// # Errors
    /// [`PathError`] on a dead key, and when an edge is longer than an f64 can tell.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, Polygons, glam::DVec3};
    /// # let points = (0..9).map(|i| DVec3::X * f64::from(i % 3) + DVec3::Y * f64::from(i / 3)).collect();
    /// # let quads: Polygons = [0, 1, 3, 4].map(|a| [a, a + 1, a + 4, a + 3]).into_iter().collect();
    /// # let mesh = Mesh::build(&IndexedMesh::new(points, quads)?)?;
    /// // Two by two unit squares, from corner to corner.
    /// let v: Vec<_> = mesh.vertices().collect();
    /// let path = mesh.shortest_path(v[0], v[8])?.expect("connected");
    /// assert_eq!((path.halfedges.len(), path.length), (4, 4.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn shortest_path(&self, a: VertexKey, b: VertexKey) -> Result<Option<EdgePath>, PathError> {
        self.cheapest(a, b, |h| distance(self.at(h), self.at(h ^ 1)))
    }

    /// The path along edges from `a` to `b` whose half-edges cost least in sum, or `None` if there is none.
    ///
    /// As [`shortest_path`](Self::shortest_path), with a cost for each half-edge instead of its length: finite and
    /// not negative. It is asked at most once for each half-edge, and may differ between the two directions of an
    /// edge. To close an edge to the path, give it a cost no path would pay, and look at what the path cost in the
    /// end. A sum beyond f64 is infinite.
    ///
    /// # Errors
    /// [`PathError`] on a dead key, and at the first cost met that is negative, NaN or infinite.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, Polygons, glam::DVec3};
    /// # let points = (0..9).map(|i| DVec3::X * f64::from(i % 3) + DVec3::Y * f64::from(i / 3)).collect();
    /// # let quads: Polygons = [0, 1, 3, 4].map(|a| [a, a + 1, a + 4, a + 3]).into_iter().collect();
    /// # let mesh = Mesh::build(&IndexedMesh::new(points, quads)?)?;
    /// // Two by two squares: keep to the boundary where that is possible.
    /// let v: Vec<_> = mesh.vertices().collect();
    /// let cost = |h| if mesh.is_boundary_edge(mesh.edge(h)) { 1.0 } else { 10.0 };
    /// let path = mesh.shortest_path_by(v[1], v[7], cost)?.expect("connected");
    /// assert_eq!((path.halfedges.len(), path.length), (4, 4.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn shortest_path_by(
        &self,
        a: VertexKey,
        b: VertexKey,
        mut cost: impl FnMut(HalfedgeKey) -> f64,
    ) -> Result<Option<EdgePath>, PathError> {
        self.cheapest(a, b, |h| cost(self.halfedge_key(h)))
    }

    fn cheapest(
        &self,
        a: VertexKey,
        b: VertexKey,
        mut cost: impl FnMut(u32) -> f64,
    ) -> Result<Option<EdgePath>, PathError> {
        let from = self.vertex_slot(a).ok_or(PathError::Missing(a))?;
        let to = self.vertex_slot(b).ok_or(PathError::Missing(b))?;
        let mut labels = BySlot::from_iter([(from, Label { length: 0.0, edges: 0, by: u32::MAX })]);
        // Lengths are not negative, so their bits order as they do.
        let mut heap = BinaryHeap::from([Reverse((0.0f64.to_bits(), 0u32, from))]);
        while let Some(Reverse((bits, edges, v))) = heap.pop() {
            let length = f64::from_bits(bits);
            if v == to {
                return Ok(Some(self.path_to(to, from, &labels, length)));
            }
            if labels.get(&v).is_some_and(|l| (l.length, l.edges) != (length, edges)) {
                // A shorter way was found after this one; the vertex has been dealt with.
                continue;
            }
            for h in self.outgoing_slots(v) {
                let cost = cost(h);
                if !(cost >= 0.0 && cost.is_finite()) {
                    return Err(PathError::BadCost { halfedge: self.halfedge_key(h), cost });
                }
                let (length, edges) = (length + cost, edges + 1);
                let end = self.origin[h as usize ^ 1];
                if labels.get(&end).is_none_or(|l| (length, edges) < (l.length, l.edges)) {
                    labels.insert(end, Label { length, edges, by: h });
                    heap.push(Reverse((length.to_bits(), edges, end)));
                }
            }
        }
        Ok(None)
    }

    fn path_to(&self, to: u32, from: u32, labels: &BySlot<Label>, length: f64) -> EdgePath {
        let mut halfedges = Vec::new();
        let mut at = to;
        while at != from
            && let Some(label) = labels.get(&at)
        {
            halfedges.push(self.halfedge_key(label.by));
            at = self.origin[label.by as usize];
        }
        halfedges.reverse();
        EdgePath { halfedges, length }
    }
}
