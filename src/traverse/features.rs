//! Features: sharp edges, and the paths they form.

use super::EdgeChain;
use super::region::is_sharp;
use crate::matching::NONE;
use crate::{EdgeKey, Mesh};
use glam::DVec3;

/// Which edges count as features.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeatureOptions {
    /// An edge is sharp if its [`dihedral_angle`](Mesh::dihedral_angle) is greater than this, either way. With NaN
    /// none is.
    pub degrees: f64,
    /// Whether boundary edges count too.
    pub boundary: bool,
}

impl Mesh {
    /// The feature edges: sharp ones and, if asked for, boundary edges; in storage order. O(slots).
    ///
    /// # Examples
    /// ```
    /// use meshwright::FeatureOptions;
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    /// # let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    /// # let mesh = Mesh::build(&IndexedMesh::from_triangles(points, &faces)?)?;
    /// // A tetrahedron with three right angles.
    /// let options = FeatureOptions { degrees: 100.0, boundary: false };
    /// assert_eq!(mesh.feature_edges(options).count(), 3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn feature_edges(&self, options: FeatureOptions) -> impl Iterator<Item = EdgeKey> {
        self.feature_slots(options).map(|e| self.edges.key(e))
    }

    /// The feature edges, strung into paths that end at corners or close.
    ///
    /// A corner is a vertex with one feature edge or with three or more; where there are two, a path goes on. A path
    /// that comes back to the corner it began at is not closed: closed ones have no corner. Each path runs as the
    /// [`edge_halfedge`](Self::edge_halfedge) of its first edge in storage order, and a closed one begins there; the
    /// paths come in the order of those edges. O(slots).
    ///
    /// # Examples
    /// ```
    /// use meshwright::FeatureOptions;
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    /// # let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    /// # let mesh = Mesh::build(&IndexedMesh::from_triangles(points, &faces)?)?;
    /// // A tetrahedron with three right angles: the other three edges lie around one face.
    /// let options = FeatureOptions { degrees: 100.0, boundary: false };
    /// let paths = mesh.feature_paths(options);
    /// assert_eq!((paths.len(), paths[0].halfedges.len(), paths[0].closed), (1, 3, true));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn feature_paths(&self, options: FeatureOptions) -> Vec<EdgeChain> {
        let edges: Vec<u32> = self.feature_slots(options).collect();
        let mut waits = vec![false; self.edges.slot_count()];
        let mut count = vec![0u32; self.vertices.slot_count()];
        for &e in &edges {
            waits[e as usize] = true;
            for h in [2 * e, 2 * e + 1] {
                count[self.origin[h as usize] as usize] += 1;
            }
        }
        let is_feature = waits.clone();
        let step = |h: u32| {
            let v = self.origin[h as usize ^ 1];
            let mut out = self.outgoing_slots(v).filter(|&g| is_feature[g as usize >> 1]);
            if count[v as usize] == 2 { out.find(|&g| g != h ^ 1) } else { None }
        };
        let mut paths = Vec::new();
        for e in edges {
            if waits[e as usize] {
                let path = self.chain(2 * e, step);
                path.halfedges.iter().for_each(|h| waits[h.index as usize >> 1] = false);
                paths.push(path);
            }
        }
        paths
    }

    fn feature_slots(&self, options: FeatureOptions) -> impl Iterator<Item = u32> {
        let mut normals = vec![DVec3::ZERO; self.faces.slot_count()];
        for f in self.faces.live() {
            normals[f as usize] = self.normal_of_face(f);
        }
        let is_feature = move |&e: &u32| {
            if self.face[2 * e as usize] == NONE || self.face[2 * e as usize + 1] == NONE {
                return options.boundary;
            }
            self.turn_at(2 * e, |f| normals[f as usize]).is_some_and(|turn| is_sharp(turn, options.degrees))
        };
        self.edges.live().filter(is_feature)
    }
}
