//! Smooth regions of faces, and the boundaries of regions.

use super::read_with;
use super::slots::{BySlot, SlotSet};
use crate::matching::NONE;
use crate::{FaceKey, HalfedgeKey, Mesh};

impl Mesh {
    read_with! {
        /// The smooth region of a face: the faces that can be reached across edges that are not sharp, each once,
        /// breadth-first; the face itself comes first.
        ///
        /// An edge is sharp if its [`dihedral_angle`](Self::dihedral_angle) is greater than `degrees`, either
        /// way: exactly the edges that [`feature_edges`](Self::feature_edges) lists. Costs the corners of what
        /// it has reached.
        ///
        /// # Examples
        /// ```
        /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
        /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        /// # let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        /// # let mesh = Mesh::build(&IndexedMesh::from_triangles(points, &faces)?)?;
        /// // A tetrahedron with three right angles.
        /// let f = mesh.faces().next().unwrap();
        /// assert_eq!(mesh.smooth_region(f, 60.0).count(), 1);
        /// assert_eq!(mesh.smooth_region(f, 91.0).count(), 3);
        /// # Ok::<(), Box<dyn std::error::Error>>(())
        /// ```
        smooth_region, get_smooth_region(self, f: FaceKey => face_slot, degrees: f64)
            -> impl Iterator<Item = FaceKey>
        {
            let mut normals = BySlot::default();
            let mut normal = move |f| *normals.entry(f).or_insert_with(|| self.normal_of_face(f));
            let smooth = move |h| self.turn_at(h, &mut normal).is_none_or(|turn| !is_sharp(turn, degrees));
            self.flood_faces(f, u32::MAX, smooth).map(|(f, _)| self.faces.key(f))
        }
    }

    /// The boundary of a set of faces, as loops of the half-edges of those faces that have a face outside the set, or
    /// none, on the other side.
    ///
    /// The set lies to the left of its loops. At a vertex where it touches itself a loop turns around one wedge of
    /// its faces, and goes on past the others. The loops come in the order of their first half-edges: by faces as
    /// given, then around each face. Faces given twice count once; a whole component without boundary has no loops.
    /// O(corners of the faces).
    ///
    /// # Panics
    /// On a dead key; [`get_region_boundary`](Self::get_region_boundary) does not.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    /// # let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    /// # let mesh = Mesh::build(&IndexedMesh::from_triangles(points, &faces)?)?;
    /// // Two faces of a tetrahedron.
    /// let loops = mesh.region_boundary(mesh.faces().take(2));
    /// assert_eq!((loops.len(), loops[0].len()), (1, 4));
    /// assert!(mesh.region_boundary(mesh.faces()).is_empty());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[track_caller]
    pub fn region_boundary(&self, faces: impl IntoIterator<Item = FaceKey>) -> Vec<Vec<HalfedgeKey>> {
        let mut slots = Vec::new();
        for f in faces {
            match self.face_slot(f) {
                Some(slot) => slots.push(slot),
                None => crate::mesh::dead(&f),
            }
        }
        self.boundary_of(&slots)
    }

    /// [`region_boundary`](Self::region_boundary), or `None` on a dead key.
    pub fn get_region_boundary(
        &self,
        faces: impl IntoIterator<Item = FaceKey>,
    ) -> Option<Vec<Vec<HalfedgeKey>>> {
        let slots = faces.into_iter().map(|f| self.face_slot(f)).collect::<Option<Vec<u32>>>()?;
        Some(self.boundary_of(&slots))
    }

    fn boundary_of(&self, faces: &[u32]) -> Vec<Vec<HalfedgeKey>> {
        let inside: SlotSet = faces.iter().copied().collect();
        let leaves = |h: u32| {
            let f = self.face[h as usize ^ 1];
            f == NONE || !inside.contains(&f)
        };
        let mut done = SlotSet::default();
        let mut loops = Vec::new();
        for first in faces.iter().flat_map(|&f| self.loop_slots(self.face_halfedge[f as usize])) {
            if !leaves(first) || done.contains(&first) {
                continue;
            }
            let mut halfedges = Vec::new();
            let mut at = first;
            loop {
                done.insert(at);
                halfedges.push(self.halfedge_key(at));
                // Through the set's own corners around the target, to the half-edge where they end.
                at = self.next[at as usize];
                while !leaves(at) {
                    at = self.next[at as usize ^ 1];
                }
                if at == first {
                    break;
                }
            }
            loops.push(halfedges);
        }
        loops
    }
}

/// Whether a dihedral angle counts as sharp.
pub(super) fn is_sharp(turn: f64, degrees: f64) -> bool {
    turn.abs().to_degrees() > degrees
}
