//! Breadth-first walks that spread from one element: rings of vertices and faces, regions of faces.

use super::read_with;
use super::slots::SlotSet;
use crate::matching::NONE;
use crate::{FaceKey, HalfedgeKey, Mesh, VertexKey};
use std::collections::VecDeque;

/// Slots in breadth-first order, each once, with its distance from the first in steps.
///
/// A slot's neighbours are looked at when it is handed out, so a walk that is dropped early has cost little.
struct Flood<S, M> {
    queue: VecDeque<(u32, u32)>,
    reached: SlotSet,
    /// No further than this.
    limit: u32,
    /// From a slot, each half-edge that leads on and the slot it leads to.
    steps: S,
    /// Whether a half-edge to a slot not yet reached may be taken.
    may: M,
}

impl<I: Iterator<Item = (u32, u32)>, S: Fn(u32) -> I, M: FnMut(u32) -> bool> Flood<S, M> {
    fn new(first: u32, limit: u32, steps: S, may: M) -> Self {
        Self { queue: [(first, 0)].into(), reached: SlotSet::from_iter([first]), limit, steps, may }
    }
}

impl<I: Iterator<Item = (u32, u32)>, S: Fn(u32) -> I, M: FnMut(u32) -> bool> Iterator for Flood<S, M> {
    type Item = (u32, u32);

    fn next(&mut self) -> Option<(u32, u32)> {
        let (slot, distance) = self.queue.pop_front()?;
        if distance < self.limit {
            for (h, to) in (self.steps)(slot) {
                if !self.reached.contains(&to) && (self.may)(h) {
                    self.reached.insert(to);
                    self.queue.push_back((to, distance + 1));
                }
            }
        }
        Some((slot, distance))
    }
}

impl Mesh {
    read_with! {
        /// The k-ring: the vertices within `k` edges of a vertex, each once, with its distance in edges.
        ///
        /// Breadth-first: the vertex itself at 0, then its [`neighbors`](Self::neighbors) in their order at 1, then
        /// theirs. `u32::MAX` sets no limit. Costs what it has reached, and nothing before it is asked.
        ///
        /// # Examples
        /// ```
        /// # use meshwright::{IndexedMesh, Mesh, Polygons, glam::DVec3};
        /// # let points = (0..4).map(|i| DVec3::X * f64::from(i % 2) + DVec3::Y * f64::from(i / 2)).collect();
        /// # let mesh = Mesh::build(&IndexedMesh::new(points, Polygons::from(vec![vec![0, 1, 3, 2]]))?)?;
        /// let v = mesh.vertices().next().unwrap();
        /// let distances: Vec<u32> = mesh.k_ring(v, 2).map(|(_, distance)| distance).collect();
        /// assert_eq!(distances, [0, 1, 1, 2], "a square");
        /// # Ok::<(), Box<dyn std::error::Error>>(())
        /// ```
        k_ring, get_k_ring(self, v: VertexKey => vertex_slot, k: u32)
            -> impl Iterator<Item = (VertexKey, u32)>
        {
            let steps = |v| self.outgoing_slots(v).map(|h| (h, self.origin[h as usize ^ 1]));
            Flood::new(v, k, steps, |_| true).map(|(v, distance)| (self.vertices.key(v), distance))
        }
    }

    read_with! {
        /// The faces that can be reached from a face across at most `k` edges, each once, with the number of edges
        /// crossed.
        ///
        /// Breadth-first, each face's neighbours counter-clockwise from its first corner. `u32::MAX` sets no limit and
        /// gives the component. Costs what it has reached, and nothing before it is asked.
        ///
        /// # Examples
        /// ```
        /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
        /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        /// # let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        /// # let mesh = Mesh::build(&IndexedMesh::from_triangles(points, &faces)?)?;
        /// let f = mesh.faces().next().unwrap();
        /// assert_eq!(mesh.face_ring(f, 1).count(), 4, "a tetrahedron");
        /// # Ok::<(), Box<dyn std::error::Error>>(())
        /// ```
        face_ring, get_face_ring(self, f: FaceKey => face_slot, k: u32)
            -> impl Iterator<Item = (FaceKey, u32)>
        {
            self.flood_faces(f, k, |_| true).map(|(f, distance)| (self.faces.key(f), distance))
        }
    }

    read_with! {
        /// Grows a region: the faces that can be reached from a face across edges for which `across` holds, each once,
        /// breadth-first; the face itself comes first.
        ///
        /// `across` is given the half-edge of the face already reached, and only if the face on the other side is not
        /// reached yet: at most once for each side of an edge. Costs what it has reached, and nothing before it is
        /// asked.
        ///
        /// # Examples
        /// ```
        /// # use meshwright::{IndexedMesh, Mesh, Polygons, glam::DVec3};
        /// # let points = (0..8).map(|i| DVec3::X * f64::from(i / 2) + DVec3::Y * f64::from(i % 2)).collect();
        /// # let strip = Polygons::from(vec![vec![0, 2, 3, 1], vec![2, 4, 5, 3], vec![4, 6, 7, 5]]);
        /// # let mesh = Mesh::build(&IndexedMesh::new(points, strip)?)?;
        /// // A strip of three squares, up to x = 2.
        /// let f = mesh.faces().next().unwrap();
        /// let region = mesh.grow_region(f, |h| mesh.position(mesh.origin(h)).x < 2.0);
        /// assert!(region.eq(mesh.faces().take(2)));
        /// # Ok::<(), Box<dyn std::error::Error>>(())
        /// ```
        grow_region, get_grow_region(self, f: FaceKey => face_slot, across: impl FnMut(HalfedgeKey) -> bool)
            -> impl Iterator<Item = FaceKey>
        {
            let mut across = across;
            self.flood_faces(f, u32::MAX, move |h| across(self.halfedge_key(h))).map(|(f, _)| self.faces.key(f))
        }
    }

    /// Faces from `f` across at most `limit` edges whose half-edge on the near side may be taken, with the number of
    /// edges crossed.
    pub(crate) fn flood_faces(
        &self,
        f: u32,
        limit: u32,
        may: impl FnMut(u32) -> bool,
    ) -> impl Iterator<Item = (u32, u32)> {
        let steps = |f: u32| {
            let loop_ = self.loop_slots(self.face_halfedge[f as usize]);
            loop_.map(|h| (h, self.face[h as usize ^ 1])).filter(|&(_, g)| g != NONE)
        };
        Flood::new(f, limit, steps, may)
    }
}
