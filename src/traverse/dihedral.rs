//! The angle between the two faces of an edge.

use crate::geometry::direction;
use crate::matching::NONE;
use crate::mesh::read;
use crate::{EdgeKey, Mesh};
use glam::DVec3;

impl Mesh {
    read! {
        /// The signed dihedral angle of an edge: by how much the surface turns there, in radians within ±π.
        ///
        /// 0 where it is flat, positive where it is convex (π/2 along the edges of a cube), negative where it is
        /// concave, close to ±π where it folds back on itself. In size it is the angle between the normals of the two
        /// faces ([`face_normal`](Self::face_normal)). `None` if there is only one face, or if a face has no area or
        /// the edge no length. O(corners of the two faces).
        ///
        /// # Examples
        /// ```
        /// # use meshwright::{IndexedMesh, Mesh, Polygons, glam::DVec3};
        /// // A roof: two squares that meet at a right angle.
        /// let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X + DVec3::Y, DVec3::NEG_Z, DVec3::X - DVec3::Z];
        /// let roof = Polygons::from(vec![vec![0, 1, 3, 2], vec![1, 0, 4, 5]]);
        /// let mut mesh = Mesh::build(&IndexedMesh::new(points, roof)?)?;
        /// let v: Vec<_> = mesh.vertices().collect();
        /// let ridge = mesh.edge(mesh.find_halfedge(v[0], v[1]).unwrap());
        /// assert_eq!(mesh.dihedral_angle(ridge), Some(std::f64::consts::FRAC_PI_2));
        /// mesh.reverse();
        /// assert_eq!(mesh.dihedral_angle(ridge), Some(-std::f64::consts::FRAC_PI_2), "a valley from below");
        /// # Ok::<(), Box<dyn std::error::Error>>(())
        /// ```
        dihedral_angle, get_dihedral_angle(self, e: EdgeKey => edge_slot) -> Option<f64> {
            self.turn_at(2 * e, |f| self.normal_of_face(f))
        }
    }

    /// The dihedral angle at a half-edge, given the normals of faces.
    pub(super) fn turn_at(&self, h: u32, mut normal: impl FnMut(u32) -> DVec3) -> Option<f64> {
        let [left, right] = [h, h ^ 1].map(|h| self.face[h as usize]);
        if left == NONE || right == NONE {
            return None;
        }
        let (a, b) = (normal(left), normal(right));
        // Halved: the difference of two finite points may overflow.
        let along = direction(self.at(h ^ 1) * 0.5 - self.at(h) * 0.5);
        if [a, b, along].contains(&DVec3::ZERO) {
            return None;
        }
        // Of faces that are not flat, the normals may turn about another axis than the edge: it gives the sign alone.
        let axis = a.cross(b);
        let turn = axis.length().atan2(a.dot(b));
        Some(if along.dot(axis) < 0.0 { -turn } else { turn })
    }
}
