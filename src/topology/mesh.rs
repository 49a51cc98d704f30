//! Native walks over the half-edge mesh: boundary loops, components.

use crate::matching::NONE;
use crate::{FaceKey, HalfedgeKey, Mesh};

impl Mesh {
    /// Whether there is a face and no boundary. [`closed`](Self::closed) gives the proof, or the witnesses. O(slots).
    pub fn is_closed(&self) -> bool {
        self.face_count() > 0 && self.boundary_slots().next().is_none()
    }

    /// The half-edges without a face, in the order of edges. O(slots).
    pub fn boundary_halfedges(&self) -> impl Iterator<Item = HalfedgeKey> + '_ {
        self.boundary_slots().map(|h| self.halfedge_key(h))
    }

    pub(crate) fn boundary_slots(&self) -> impl Iterator<Item = u32> + '_ {
        // Dead slots may hold anything, so few of the entries are looked at twice.
        let open = self.face.iter().zip(0u32..).filter(|(f, _)| **f == NONE).map(|(_, h)| h);
        open.filter(|h| self.edges.is_live(h >> 1))
    }

    /// The boundary loops (naked edges), each as its half-edges in [`next`](Self::next) order, in the order of their
    /// first edges. A closed mesh has none. O(slots).
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, NormalWeight, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let pool = IndexedMesh::from_triangles(points, &[[0, 1, 2]])?;
    /// # let mut mesh = Mesh::build(&pool)?;
    /// let loops = mesh.boundary_loops();
    /// assert_eq!((loops.len(), loops[0].len()), (1, 3));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn boundary_loops(&self) -> Vec<Vec<HalfedgeKey>> {
        let mut seen = vec![false; self.edges.slot_count()];
        let mut loops = Vec::new();
        for first in self.boundary_slots() {
            if !seen[first as usize >> 1] {
                loops.push(
                    self.loop_slots(first)
                        .inspect(|&h| seen[h as usize >> 1] = true)
                        .map(|h| self.halfedge_key(h))
                        .collect(),
                );
            }
        }
        loops
    }

    /// The components: faces joined across edges, each list in the order of a breadth-first walk from its first face,
    /// the lists in the order of their first faces. O(slots).
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, NormalWeight, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let pool = IndexedMesh::from_triangles(points, &[[0, 1, 2]])?;
    /// # let mut mesh = Mesh::build(&pool)?;
    /// assert_eq!(mesh.components(), [vec![mesh.faces().next().unwrap()]]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn components(&self) -> Vec<Vec<FaceKey>> {
        let mut seen = vec![false; self.faces.slot_count()];
        let mut components = Vec::new();
        for f in self.faces.live() {
            if !seen[f as usize] {
                components.push(
                    self.component_slots(f, &mut seen).into_iter().map(|f| self.faces.key(f)).collect(),
                );
            }
        }
        components
    }

    fn component_slots(&self, first: u32, seen: &mut [bool]) -> Vec<u32> {
        seen[first as usize] = true;
        let mut faces = vec![first];
        let mut done = 0;
        while let Some(&f) = faces.get(done) {
            done += 1;
            for h in self.loop_slots(self.face_halfedge[f as usize]) {
                let g = self.face[h as usize ^ 1];
                if g != NONE && !std::mem::replace(&mut seen[g as usize], true) {
                    faces.push(g);
                }
            }
        }
        faces
    }

    /// Vertices that have a face, less edges, plus faces. O(slots).
    pub fn euler_characteristic(&self) -> i64 {
        let used = self.vertices.live().filter(|&v| self.vertex_halfedge[v as usize] != NONE).count();
        used as i64 - self.edge_count() as i64 + self.face_count() as i64
    }
}
