//! Native walks over the half-edge mesh: boundary loops, components, reversal.

use crate::matching::NONE;
use crate::{FaceKey, HalfedgeKey, Mesh};

/// An operation on a part of the mesh was given a face that is not there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0:?} is not a face of the mesh")]
pub struct MissingFace(pub FaceKey);

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
        self.edges.live().flat_map(|e| [2 * e, 2 * e + 1]).filter(|&h| self.face[h as usize] == NONE)
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

    /// Flips the mesh: reverses the winding of every face and negates carried normals. Twice is the identity; all keys
    /// stay valid, each half-edge stays with its face and now runs the other way. O(slots).
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// let h = mesh.halfedges().next().unwrap();
    /// let (a, b) = (mesh.origin(h), mesh.target(h));
    /// mesh.reverse();
    /// assert_eq!((mesh.origin(h), mesh.target(h)), (b, a));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn reverse(&mut self) {
        let edges: Vec<u32> = self.edges.live().collect();
        let vertices: Vec<u32> = self.vertices.live().collect();
        let faces: Vec<u32> = self.faces.live().collect();
        self.reverse_elements(&edges, &vertices, &faces);
    }

    /// Flips one component: reverses the winding of every face that can be reached from `f` across edges, and negates
    /// the normals its vertices carry. As with [`reverse`](Self::reverse) all keys stay valid. O(its size).
    ///
    /// # Errors
    /// [`MissingFace`] on a dead key.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, NormalWeight, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let pool = IndexedMesh::from_triangles(points, &[[0, 1, 2]])?;
    /// # let mut mesh = Mesh::build(&pool)?;
    /// let f = mesh.faces().next().unwrap();
    /// mesh.reverse_component(f)?;
    /// assert_eq!(&mesh.to_indexed().polygons()[0], &[0, 2, 1]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn reverse_component(&mut self, f: FaceKey) -> Result<(), MissingFace> {
        let first = self.face_slot(f).ok_or(MissingFace(f))?;
        let faces: Vec<u32> = self.flood_faces(first, u32::MAX, |_| true).map(|(f, _)| f).collect();
        let mut edges = Vec::new();
        let mut vertices = Vec::new();
        for &f in &faces {
            for h in self.loop_slots(self.face_halfedge[f as usize]) {
                // Each edge at the even one of its half-edges that have a face, each vertex at its first corner.
                if h & 1 == 0 || self.face[h as usize ^ 1] == NONE {
                    edges.push(h >> 1);
                }
                let v = self.origin[h as usize];
                let first = self.vertex_halfedge[v as usize];
                if h == first || self.face[first as usize] == NONE && h == self.next[first as usize ^ 1] {
                    vertices.push(v);
                }
            }
        }
        self.reverse_elements(&edges, &vertices, &faces);
        Ok(())
    }

    /// Reverses whole components, given all their elements.
    fn reverse_elements(&mut self, edges: &[u32], vertices: &[u32], faces: &[u32]) {
        // The half-edge that ends at a corner starts there afterwards, and stays with its face: so the one before the
        // vertex's (on the boundary, the other boundary half-edge) and the one before the face's first take over.
        for &v in vertices {
            let h = &mut self.vertex_halfedge[v as usize];
            if *h != NONE {
                *h = self.prev[*h as usize];
            }
            if let Some(normals) = &mut self.normals {
                normals[v as usize] = -normals[v as usize];
            }
        }
        for &f in faces {
            let h = &mut self.face_halfedge[f as usize];
            *h = self.prev[*h as usize];
        }
        for &e in edges {
            let h = 2 * e as usize;
            self.origin.swap(h, h + 1);
            for h in [h, h + 1] {
                std::mem::swap(&mut self.next[h], &mut self.prev[h]);
            }
        }
    }
}
