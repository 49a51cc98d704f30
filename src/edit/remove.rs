//! Removing faces, edges and vertices.

use super::{Few, Slots};
use crate::matching::NONE;
use crate::{EdgeKey, FaceKey, Mesh, VertexKey};
use smallvec::SmallVec;

/// Why a face was not removed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RemoveFaceError {
    /// The key names no live face.
    #[error("{0:?} is not a face of the mesh")]
    Missing(FaceKey),
    /// The faces that are left around a vertex would form more than one fan.
    #[error("{0:?} would be pinched")]
    Pinch(VertexKey),
}

/// Why an edge was not removed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RemoveEdgeError {
    /// The key names no live edge.
    #[error("{0:?} is not an edge of the mesh")]
    Missing(EdgeKey),
    /// The faces that are left around a vertex would form more than one fan.
    #[error("{0:?} would be pinched")]
    Pinch(VertexKey),
}

/// Why a vertex was not removed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RemoveVertexError {
    /// The key names no live vertex.
    #[error("{0:?} is not a vertex of the mesh")]
    Missing(VertexKey),
    /// The faces that are left around a vertex would form more than one fan.
    #[error("{0:?} would be pinched")]
    Pinch(VertexKey),
}

/// What a removal took away.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Removed {
    /// The faces that are gone.
    pub faces: Few<FaceKey>,
    /// The edges that are gone: those that have no face left.
    pub edges: Few<EdgeKey>,
    /// The vertices that lost their last face and are isolated now.
    pub isolated: Few<VertexKey>,
}

impl Mesh {
    /// Removes a face, and the edges that have no other.
    ///
    /// ```text
    ///   ●───●───●        ●───●───●
    ///   │ ╱   ╲ │        │ ╱   ╲ │
    ///   ●── f ──●   →    ●       ●     Vertices stay; one without a face left is isolated.
    ///   │ ╲   ╱ │        │ ╲   ╱ │
    ///   ●───●───●        ●───●───●
    /// ```
    ///
    /// O(valences of its corners).
    ///
    /// # Errors
    /// [`RemoveFaceError`]; nothing has changed then.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2], [2, 1, 3]])?)?;
    /// let f = mesh.faces().next().unwrap();
    /// let removed = mesh.remove_face(f)?;
    /// assert_eq!((removed.edges.len(), removed.isolated.len()), (2, 1));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn remove_face(&mut self, f: FaceKey) -> Result<Removed, RemoveFaceError> {
        self.check_remove_face(f)?;
        let slot = self.face_slot(f).ok_or(RemoveFaceError::Missing(f))?;
        Ok(self.take_faces(&[slot]))
    }

    /// Whether [`remove_face`](Self::remove_face) would be done.
    ///
    /// # Errors
    /// As there.
    pub fn check_remove_face(&self, f: FaceKey) -> Result<(), RemoveFaceError> {
        let slot = self.face_slot(f).ok_or(RemoveFaceError::Missing(f))?;
        match self.pinch_without(&[slot], None) {
            Some(v) => Err(RemoveFaceError::Pinch(v)),
            None => Ok(()),
        }
    }

    /// Removes an edge with the one or two faces beside it. To merge the two faces instead,
    /// [`join_faces`](Self::join_faces).
    ///
    /// ```text
    ///   ●───●───●───●        ●───●   ●───●
    ///   │ ╱ │   │ ╲ │        │ ╱       ╲ │
    ///   ●   │ e │   ●   →    ●           ●     Vertices stay, and edges that have another face.
    ///   │ ╲ │   │ ╱ │        │ ╲       ╱ │
    ///   ●───●───●───●        ●───●   ●───●
    /// ```
    ///
    /// O(valences of the faces' corners).
    ///
    /// # Errors
    /// [`RemoveEdgeError`]; nothing has changed then.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2], [2, 1, 3]])?)?;
    /// let inner = mesh.edges().find(|&e| !mesh.is_boundary_edge(e)).unwrap();
    /// assert_eq!(mesh.remove_edge(inner)?.faces.len(), 2);
    /// assert_eq!(mesh.face_count(), 0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn remove_edge(&mut self, e: EdgeKey) -> Result<Removed, RemoveEdgeError> {
        self.check_remove_edge(e)?;
        let slot = self.edge_slot(e).ok_or(RemoveEdgeError::Missing(e))?;
        Ok(self.take_faces(&self.faces_beside(slot)))
    }

    /// Whether [`remove_edge`](Self::remove_edge) would be done.
    ///
    /// # Errors
    /// As there.
    pub fn check_remove_edge(&self, e: EdgeKey) -> Result<(), RemoveEdgeError> {
        let slot = self.edge_slot(e).ok_or(RemoveEdgeError::Missing(e))?;
        match self.pinch_without(&self.faces_beside(slot), None) {
            Some(v) => Err(RemoveEdgeError::Pinch(v)),
            None => Ok(()),
        }
    }

    /// Removes a vertex with all faces around it. To merge the faces instead, [`dissolve_vertex`](Self::dissolve_vertex).
    ///
    /// ```text
    ///   ●───●───●        ●───●───●
    ///   │ ╲ │ ╱ │        │       │
    ///   ●── v ──●   →    ●       ●     Other vertices stay; one without a face left is isolated.
    ///   │ ╱ │ ╲ │        │       │
    ///   ●───●───●        ●───●───●
    /// ```
    ///
    /// O(valences of the faces' corners).
    ///
    /// # Errors
    /// [`RemoveVertexError`]; nothing has changed then.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2], [2, 1, 3]])?)?;
    /// let corner = mesh.vertices().next().unwrap();
    /// mesh.remove_vertex(corner)?;
    /// assert_eq!((mesh.vertex_count(), mesh.face_count()), (3, 1));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn remove_vertex(&mut self, v: VertexKey) -> Result<Removed, RemoveVertexError> {
        self.check_remove_vertex(v)?;
        let slot = self.vertex_slot(v).ok_or(RemoveVertexError::Missing(v))?;
        let mut removed = self.take_faces(&self.faces_at(slot));
        removed.isolated.retain(|left| *left != v);
        self.drop_vertex(slot, None);
        Ok(removed)
    }

    /// Whether [`remove_vertex`](Self::remove_vertex) would be done.
    ///
    /// # Errors
    /// As there.
    pub fn check_remove_vertex(&self, v: VertexKey) -> Result<(), RemoveVertexError> {
        let slot = self.vertex_slot(v).ok_or(RemoveVertexError::Missing(v))?;
        match self.pinch_without(&self.faces_at(slot), Some(slot)) {
            Some(v) => Err(RemoveVertexError::Pinch(v)),
            None => Ok(()),
        }
    }

    fn faces_beside(&self, e: u32) -> Slots {
        let mut faces: Slots =
            [2 * e, 2 * e + 1].into_iter().map(|h| self.face[h as usize]).filter(|&f| f != NONE).collect();
        faces.sort_unstable();
        faces
    }

    fn faces_at(&self, v: u32) -> Slots {
        let mut faces: Slots =
            self.outgoing_slots(v).map(|h| self.face[h as usize]).filter(|&f| f != NONE).collect();
        faces.sort_unstable();
        faces
    }

    /// The corners of faces, each vertex once.
    fn corners_of(&self, faces: &[u32]) -> Slots {
        let loops = faces.iter().flat_map(|&f| self.loop_slots(self.face_halfedge[f as usize]));
        let mut corners: Slots = loops.map(|h| self.origin[h as usize]).collect();
        corners.sort_unstable();
        corners.dedup();
        corners
    }

    /// A vertex that would be pinched without these faces, which are sorted; but for `spared`, which goes too.
    fn pinch_without(&self, faces: &[u32], spared: Option<u32>) -> Option<VertexKey> {
        let is_open = |h: u32| {
            let f = self.face[h as usize];
            f == NONE || faces.binary_search(&f).is_ok()
        };
        // How often the faces that stay begin anew around a vertex.
        let fans = |v: u32| {
            let begins = |&h: &u32| is_open(h) && !is_open(self.next[h as usize ^ 1]);
            self.outgoing_slots(v).filter(begins).count()
        };
        if let &[f] = faces {
            // One face parts a fan unless it stands at its end, or the fan is whole.
            let parts = |&h: &u32| {
                let sides = [h ^ 1, self.prev[h as usize] ^ 1];
                self.is_open_vertex(self.origin[h as usize]) && !sides.iter().any(|&h| self.is_open(h))
            };
            let corners = self.loop_slots(self.face_halfedge[f as usize]).filter(parts);
            let pinched = corners.map(|h| self.origin[h as usize]).filter(|&v| Some(v) != spared).min();
            return pinched.map(|v| self.vertices.key(v));
        }
        let mut corners = self.corners_of(faces).into_iter().filter(|&v| Some(v) != spared);
        corners.find(|&v| fans(v) > 1).map(|v| self.vertices.key(v))
    }

    /// What will be left around each corner of a face once it is gone, in the order of slots: the vertex, and the open half-edges
    /// into it and out of it.
    fn opened_by(&self, f: u32) -> SmallVec<[(u32, Option<[u32; 2]>); 4]> {
        let mut opened: SmallVec<[(u32, Option<[u32; 2]>); 4]> = SmallVec::new();
        for h in self.loop_slots(self.face_halfedge[f as usize]) {
            let p = self.prev[h as usize];
            let out = if self.is_open(h ^ 1) { self.next[h as usize ^ 1] } else { h };
            let into = if self.is_open(p ^ 1) { self.prev[p as usize ^ 1] } else { p };
            // Both edges have this face only: then they are the vertex's only ones.
            let is_left = out != p ^ 1;
            opened.push((self.origin[h as usize], is_left.then_some([into, out])));
        }
        opened.sort_unstable();
        opened
    }

    /// Removes all faces of a component, with its edges and vertices.
    pub(crate) fn remove_part(&mut self, faces: &[u32]) {
        let vertices = self.take_faces(faces).isolated;
        for v in vertices.iter().filter_map(|&v| self.vertex_slot(v)).collect::<Slots>() {
            self.drop_vertex(v, None);
        }
    }

    /// Removes a vertex that has no face.
    pub(crate) fn remove_isolated(&mut self, v: u32) {
        debug_assert_eq!(self.vertex_halfedge[v as usize], NONE);
        self.drop_vertex(v, None);
    }

    /// Removes faces whose going pinches no vertex.
    fn take_faces(&mut self, faces: &[u32]) -> Removed {
        let corners = self.corners_of(faces);
        // Found before links are written.
        let one = if let &[f] = faces { self.opened_by(f) } else { SmallVec::new() };
        // The edges around each corner, in order.
        let around = if one.is_empty() { &corners[..] } else { &[] };
        let fans: SmallVec<[Slots; 4]> = around.iter().map(|&v| self.spokes(v)).collect();
        let mut halfedges = Slots::new();
        for &f in faces {
            halfedges.extend(self.loop_slots(self.face_halfedge[f as usize]));
        }
        for &h in &halfedges {
            self.set_face(h, NONE);
            self.reset_corner(h);
        }
        for (&v, fan) in corners.iter().zip(&fans) {
            let is_left = |h: &u32| !(self.is_open(*h) && self.is_open(*h ^ 1));
            let out = fan.iter().copied().find(|h| is_left(h) && self.is_open(*h));
            let into = fan.iter().map(|h| h ^ 1).find(|h| is_left(h) && self.is_open(*h));
            match (into, out) {
                (Some(into), Some(out)) => {
                    self.link(into, out);
                    self.set_vertex_halfedge(v, out);
                }
                _ => self.set_vertex_halfedge(v, NONE),
            }
        }
        for (v, left) in one {
            if let Some([into, out]) = left {
                self.link(into, out);
            }
            self.set_vertex_halfedge(v, left.map_or(NONE, |[_, out]| out));
        }
        let mut removed = Removed::default();
        for &h in &halfedges {
            if self.is_open(h ^ 1) && self.edges.is_live(h >> 1) {
                removed.edges.push(self.drop_edge(h >> 1, None));
            }
        }
        for &f in faces {
            removed.faces.push(self.drop_face(f, None));
        }
        let isolated = corners.into_iter().filter(|&v| self.vertex_halfedge[v as usize] == NONE);
        removed.isolated = isolated.map(|v| self.vertices.key(v)).collect();
        removed
    }
}
