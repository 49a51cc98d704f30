//! Vertex and face normals.

use super::{direction, unit_scale};
use crate::mesh::read;
use crate::{FaceKey, Mesh, Polygons, VertexKey};
use glam::DVec3;

/// How much each face counts in the normal of a vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum NormalWeight {
    /// By its area.
    Area,
    /// By its angle at the vertex: independent of how the surface is cut into faces.
    #[default]
    Angle,
}

/// Twice the area vector of a polygon (Newell): its length is twice the area of a plane polygon, and it points to where
/// the polygon is seen counter-clockwise.
pub(crate) fn double_area_vector(points: impl Iterator<Item = DVec3>) -> DVec3 {
    let mut points = points;
    let Some(first) = points.next() else { return DVec3::ZERO };
    let mut before = DVec3::ZERO;
    points.fold(DVec3::ZERO, |sum, p| {
        let here = p - first;
        let sum = sum + before.cross(here);
        before = here;
        sum
    })
}

/// The angle at `b` between the edges to `a` and `c`, in radians.
pub(crate) fn angle(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let (u, v) = (direction(a - b), direction(c - b));
    // Kahan: exact to rounding for every angle, where acos loses half the digits.
    2.0 * (u - v).length().atan2((u + v).length())
}

pub(crate) fn vertex_normals(positions: &[DVec3], polygons: &Polygons, weight: NormalWeight) -> Vec<DVec3> {
    let scale = unit_scale(positions.iter().copied());
    let at = |v: u32| positions[v as usize] * scale;
    let mut sums = vec![DVec3::ZERO; positions.len()];
    for corners in polygons.iter() {
        let area = double_area_vector(corners.iter().map(|&v| at(v)));
        match weight {
            NormalWeight::Area => corners.iter().for_each(|&v| sums[v as usize] += area),
            NormalWeight::Angle => {
                let normal = direction(area);
                let n = corners.len();
                for i in 0..n {
                    let (a, b, c) = (corners[(i + n - 1) % n], corners[i], corners[(i + 1) % n]);
                    sums[b as usize] += normal * angle(at(a), at(b), at(c));
                }
            }
        }
    }
    sums.into_iter().map(direction).collect()
}

impl Mesh {
    read! {
        /// The unit normal of a face (Newell); zero if it has no area. O(degree).
        face_normal, get_face_normal(self, f: FaceKey => face_slot) -> DVec3 { self.normal_of_face(f) }
    }

    /// The unit normal of a vertex computed from its faces, or `None` on a dead key; zero where there is no face or
    /// the faces cancel. O(corners of the faces around it).
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, NormalWeight, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let pool = IndexedMesh::from_triangles(points, &[[0, 1, 2]])?;
    /// # let mut mesh = Mesh::build(&pool)?;
    /// let v = mesh.vertices().next().unwrap();
    /// assert_eq!(mesh.vertex_normal(v, NormalWeight::Area), Some(DVec3::Z));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn vertex_normal(&self, v: VertexKey, weight: NormalWeight) -> Option<DVec3> {
        let slot = self.vertex_slot(v)?;
        let corners =
            || self.outgoing_slots(slot).filter(|&h| self.face[h as usize] != crate::matching::NONE);
        let scale = unit_scale(corners().flat_map(|h| self.loop_slots(h)).map(|h| self.at(h)));
        let sum: DVec3 = corners()
            .map(|h| {
                let area = double_area_vector(self.loop_slots(h).map(|h| self.at(h) * scale));
                let prev = self.at(self.prev[h as usize]);
                match weight {
                    NormalWeight::Area => area,
                    NormalWeight::Angle => {
                        let next = self.at(self.next[h as usize]);
                        direction(area) * angle(prev * scale, self.at(h) * scale, next * scale)
                    }
                }
            })
            .sum();
        Some(direction(sum))
    }

    /// Computes a normal for every vertex from its faces and lets the mesh carry them: [`normal`](Self::normal) reads
    /// them. Zero where there is no face or the faces cancel. O(corners).
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, NormalWeight, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let pool = IndexedMesh::from_triangles(points, &[[0, 1, 2]])?;
    /// # let mut mesh = Mesh::build(&pool)?;
    /// mesh.compute_normals(NormalWeight::Angle);
    /// assert!(mesh.vertices().all(|v| mesh.normal(v) == Some(DVec3::Z)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn compute_normals(&mut self, weight: NormalWeight) {
        let pool = self.to_indexed();
        let computed = pool.vertex_normals(weight);
        let mut column = vec![DVec3::ZERO; self.vertices.slot_count()];
        for (slot, normal) in self.vertices.in_user_order().into_iter().zip(computed) {
            column[slot as usize] = normal;
        }
        self.replace_normals(column);
    }

    /// Where a half-edge starts.
    pub(crate) fn at(&self, h: u32) -> DVec3 {
        self.positions[self.origin[h as usize] as usize]
    }

    pub(crate) fn normal_of_face(&self, f: u32) -> DVec3 {
        let first = self.corner_across_longest(self.face_halfedge[f as usize]);
        let corners = || self.loop_slots(first).map(|h| self.at(h));
        let scale = unit_scale(corners());
        direction(double_area_vector(corners().map(|p| p * scale)))
    }

    /// The half-edge of a triangle whose origin lies across from its longest side: of a sliver, only the product of the
    /// two shorter sides keeps the digits of the normal. The half-edge itself on other faces.
    fn corner_across_longest(&self, h: u32) -> u32 {
        let [a, b, c] = [h, self.next[h as usize], self.prev[h as usize]];
        if self.next[b as usize] != c {
            return h;
        }
        let across = |h: u32| super::distance(self.at(self.next[h as usize]), self.at(self.prev[h as usize]));
        [b, c]
            .into_iter()
            .fold((a, across(a)), |best, h| {
                let length = across(h);
                if length > best.1 { (h, length) } else { best }
            })
            .0
    }
}
