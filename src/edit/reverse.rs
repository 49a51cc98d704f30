//! Reversing the winding of a component, or of the whole mesh.

use crate::column::{Kind, Turning};
use crate::matching::NONE;
use crate::{FaceKey, Mesh};

/// An operation on a part of the mesh was given a face that is not there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0:?} is not a face of the mesh")]
pub struct MissingFace(pub FaceKey);

impl Mesh {
    /// Flips the mesh: reverses the winding of every face and negates normals, carried ones and those in columns of
    /// [`Rule::normals`](crate::Rule::normals). Twice is the identity; all keys stay valid, each half-edge stays with its
    /// face and now runs the other way, so that corner data moves to the half-edge that now starts at the corner. O(slots).
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
        self.turn_all_values(&Turning::REVERSAL);
        self.reverse_all_links();
    }

    /// Reverses the winding of every face, and turns no values.
    pub(crate) fn reverse_all_links(&mut self) {
        let edges: Vec<u32> = self.edges.live().collect();
        let vertices: Vec<u32> = self.vertices.live().collect();
        let faces: Vec<u32> = self.faces.live().collect();
        self.reverse_elements(&edges, &vertices, &faces);
    }

    /// Flips one component: reverses the winding of every face that can be reached from `f` across edges, and negates
    /// its normals. As with [`reverse`](Self::reverse) all keys stay valid. O(its size).
    ///
    /// ```text
    ///       c                c
    ///     ╱   ╲            ╱   ╲
    ///   ↙   ↺   ↖    →   ↗   ↻   ↘
    ///   a ──→── b        a ──←── b
    /// ```
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
        self.turn_values(Kind::Vertex, &Turning::REVERSAL, |_| vertices.clone());
        self.turn_values(Kind::Edge, &Turning::REVERSAL, |_| edges.clone());
        self.turn_values(Kind::Face, &Turning::REVERSAL, |_| faces.clone());
        self.turn_values(Kind::Corner, &Turning::REVERSAL, |mesh| {
            faces.iter().flat_map(|&f| mesh.loop_slots(mesh.face_halfedge[f as usize])).collect()
        });
        self.reverse_elements(&edges, &vertices, &faces);
        Ok(())
    }

    /// Whether [`reverse_component`](Self::reverse_component) would be done.
    ///
    /// # Errors
    /// As there.
    pub fn check_reverse_component(&self, f: FaceKey) -> Result<(), MissingFace> {
        self.face_slot(f).map(|_| ()).ok_or(MissingFace(f))
    }

    /// Reverses whole components, given all their elements.
    fn reverse_elements(&mut self, edges: &[u32], vertices: &[u32], faces: &[u32]) {
        // The half-edge that ends at a corner starts there afterwards, and stays with its face: so the one before the
        // vertex's (on the boundary, the other boundary half-edge) and the one before the face's first take over.
        for &v in vertices {
            let h = self.vertex_halfedge[v as usize];
            if h != NONE {
                self.set_vertex_halfedge(v, self.prev[h as usize]);
            }
        }
        for &f in faces {
            self.rotate_corners(self.face_halfedge[f as usize]);
            self.set_face_halfedge(f, self.prev[self.face_halfedge[f as usize] as usize]);
        }
        for &e in edges {
            let (h, t) = (2 * e, 2 * e + 1);
            let (a, b) = (self.origin[h as usize], self.origin[t as usize]);
            self.set_origin(h, b);
            self.set_origin(t, a);
            for h in [h, t] {
                let (next, prev) = (self.next[h as usize], self.prev[h as usize]);
                self.write_next(h, prev);
                self.write_prev(h, next);
            }
        }
    }
}
