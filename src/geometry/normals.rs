//! Vertex and face normals.

use super::triangles::{Faces, normalize};
use super::{are_tame, direction, distance, is_tame, unit_scale};
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

/// Twice the area vector of a triangle, to the bit that of its three corners as a polygon.
fn double_area(a: DVec3, b: DVec3, c: DVec3) -> DVec3 {
    DVec3::ZERO + (b - a).cross(c - a)
}

pub(crate) fn vertex_normals(positions: &[DVec3], polygons: &Polygons, weight: NormalWeight) -> Vec<DVec3> {
    let mut sums = Sums::new(positions.iter().copied(), positions.len(), weight);
    for corners in polygons.iter() {
        sums.add(positions, corners);
    }
    sums.directions()
}

/// The normals of faces summed at their vertices.
struct Sums {
    scale: f64,
    weight: NormalWeight,
    sums: Vec<DVec3>,
}

impl Sums {
    fn new(used: impl Iterator<Item = DVec3> + Clone, count: usize, weight: NormalWeight) -> Self {
        let scale = if is_tame(used.clone()) { 1.0 } else { unit_scale(used) };
        Self { scale, weight, sums: vec![DVec3::ZERO; count] }
    }

    fn add(&mut self, positions: &[DVec3], corners: &[u32]) {
        if let &[a, b, c] = corners {
            let corners = [a, b, c];
            return self.add_triangle(corners, corners.map(|v| positions[v as usize]));
        }
        let at = |v: u32| positions[v as usize] * self.scale;
        let area = double_area_vector(corners.iter().map(|&v| at(v)));
        match self.weight {
            NormalWeight::Area => corners.iter().for_each(|&v| self.sums[v as usize] += area),
            NormalWeight::Angle => {
                let normal = direction(area);
                let n = corners.len();
                for i in 0..n {
                    let (a, b, c) = (corners[(i + n - 1) % n], corners[i], corners[(i + 1) % n]);
                    self.sums[b as usize] += normal * angle(at(a), at(b), at(c));
                }
            }
        }
    }

    #[inline]
    fn add_triangle(&mut self, corners: [u32; 3], points: [DVec3; 3]) {
        let [a, b, c] = if self.scale == 1.0 { points } else { points.map(|p| p * self.scale) };
        let area = double_area(a, b, c);
        let parts = match self.weight {
            NormalWeight::Area => [area; 3],
            NormalWeight::Angle => {
                let normal = direction(area);
                [angle(c, a, b), angle(a, b, c), angle(b, c, a)].map(|angle| normal * angle)
            }
        };
        for (v, part) in corners.into_iter().zip(parts) {
            self.sums[v as usize] += part;
        }
    }

    fn directions(mut self) -> Vec<DVec3> {
        normalize(&mut self.sums);
        self.sums
    }
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
        let (at_vertices, _) = self.normals_by(weight, false);
        self.replace_normals(at_vertices);
    }

    /// As [`compute_normals`](Self::compute_normals), and gives the unit normals of all faces as
    /// [`face_normals`](Self::face_normals) does, in one pass over the faces. O(corners).
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, NormalWeight, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// assert_eq!(mesh.compute_all_normals(NormalWeight::Area), mesh.face_normals());
    /// assert!(mesh.vertices().all(|v| mesh.normal(v) == Some(DVec3::Z)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn compute_all_normals(&mut self, weight: NormalWeight) -> Vec<DVec3> {
        let in_order = self.faces.is_in_user_order();
        let (at_vertices, at_faces) = self.normals_by(weight, in_order);
        self.replace_normals(at_vertices);
        if in_order { at_faces } else { self.face_normals() }
    }

    /// The normals of vertex slots, and if they are wanted those of faces in the user's order.
    fn normals_by(&self, weight: NormalWeight, with_faces: bool) -> (Vec<DVec3>, Vec<DVec3>) {
        let mut at_faces = Vec::with_capacity(if with_faces { self.face_count() } else { 0 });
        let count = self.vertices.slot_count();
        let is_tame = self.is_tame();
        if is_tame && weight == NormalWeight::Area {
            let mut sums = Sums { scale: 1.0, weight, sums: vec![DVec3::ZERO; count] };
            let mut polygon = Vec::new();
            let take = |faces: Faces<'_>| match faces {
                Faces::Triangles(triangles) => {
                    triangles.add_areas(&mut sums.sums);
                    if with_faces {
                        triangles.push_normals(&mut at_faces);
                    }
                }
                Faces::Mixed(slots) => {
                    for &f in slots {
                        polygon.clear();
                        let corners = self.loop_slots(self.face_halfedge[f as usize]);
                        polygon.extend(corners.map(|h| self.origin[h as usize]));
                        sums.add(&self.positions, &polygon);
                        if with_faces {
                            at_faces.push(self.normal_of_face(f));
                        }
                    }
                }
            };
            if self.faces.is_in_user_order() {
                self.in_blocks(self.faces.live(), take);
            } else {
                self.in_blocks(self.faces.in_user_order().into_iter(), take);
            }
            return (sums.directions(), at_faces);
        }
        let normal_of = if is_tame { tame_triangle_normal } else { triangle_normal };
        let sums = self.normal_sums(weight, |f, triangle| {
            if with_faces {
                at_faces.push(triangle.map_or_else(|| self.normal_of_face(f), normal_of));
            }
        });
        (sums.directions(), at_faces)
    }

    /// The normals of faces summed at vertex slots. `each` is called with every face, in the user's order, and its corners if
    /// it is a triangle.
    fn normal_sums(&self, weight: NormalWeight, mut each: impl FnMut(u32, Option<[DVec3; 3]>)) -> Sums {
        let used = self.vertices.live().map(|v| self.positions[v as usize]);
        let mut sums = Sums::new(used, self.vertices.slot_count(), weight);
        let mut polygon = Vec::new();
        self.for_each_in_user_order(|f| {
            let h = self.face_halfedge[f as usize];
            match self.triangle_slots(h) {
                Some(halfedges) => {
                    let corners = halfedges.map(|h| self.origin[h as usize]);
                    let points = corners.map(|v| self.positions[v as usize]);
                    sums.add_triangle(corners, points);
                    each(f, Some(points));
                }
                None => {
                    polygon.clear();
                    polygon.extend(self.loop_slots(h).map(|h| self.origin[h as usize]));
                    sums.add(&self.positions, &polygon);
                    each(f, None);
                }
            }
        });
        sums
    }

    /// The half-edges of a triangle from one of them; `None` for other faces.
    #[inline]
    fn triangle_slots(&self, h: u32) -> Option<[u32; 3]> {
        let second = self.next[h as usize];
        let third = self.next[second as usize];
        (self.next[third as usize] == h).then_some([h, second, third])
    }

    /// The unit normals of all faces, in the order of [`faces`](Self::faces), each as [`face_normal`](Self::face_normal)
    /// has it. O(corners).
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// assert_eq!(mesh.face_normals(), [DVec3::Z]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn face_normals(&self) -> Vec<DVec3> {
        let mut normals = Vec::with_capacity(self.face_count());
        if self.is_tame() {
            self.in_blocks(self.faces.live(), |faces| match faces {
                Faces::Triangles(triangles) => triangles.push_normals(&mut normals),
                Faces::Mixed(slots) => normals.extend(slots.iter().map(|&f| self.normal_of_face(f))),
            });
        } else {
            normals.extend(self.faces.live().map(|f| self.normal_of_face(f)));
        }
        normals
    }

    /// Whether all coordinates are tame.
    fn is_tame(&self) -> bool {
        // What dead vertices left behind may be anything.
        are_tame(&self.positions) || is_tame(self.vertices.live().map(|v| self.positions[v as usize]))
    }

    /// Where a half-edge starts.
    pub(crate) fn at(&self, h: u32) -> DVec3 {
        self.positions[self.origin[h as usize] as usize]
    }

    #[inline]
    pub(crate) fn normal_of_face(&self, f: u32) -> DVec3 {
        let h = self.face_halfedge[f as usize];
        if let Some(halfedges) = self.triangle_slots(h) {
            return triangle_normal(halfedges.map(|h| self.at(h)));
        }
        let corners = || self.loop_slots(h).map(|h| self.at(h));
        let scale = unit_scale(corners());
        direction(double_area_vector(corners().map(|p| p * scale)))
    }
}

/// The unit normal of a triangle, from the corner across its longest side (the first of equals): of a sliver, only the
/// product of the two shorter sides keeps the digits of the normal.
fn triangle_normal(corners: [DVec3; 3]) -> DVec3 {
    let scale = unit_scale(corners.into_iter());
    let [a, b, c] = corners.map(|p| p * scale);
    // Each side with the one after it, as they run into and out of the corner between them.
    let sides = [b - a, c - b, a - c];
    let corner = by_distance(corners);
    direction(DVec3::ZERO + sides[(corner + 2) % 3].cross(sides[corner]))
}

/// The same to the bit, if the coordinates are [tame](is_tame).
#[inline]
pub(super) fn tame_triangle_normal(corners: [DVec3; 3]) -> DVec3 {
    let [a, b, c] = corners;
    let sides = [b - a, c - b, a - c];
    let across = [sides[1], sides[2], sides[0]].map(|side| side.length_squared());
    let longer = |x: f64, y: f64| if y > x { y } else { x };
    let longest = longer(longer(across[0], across[1]), across[2]);
    // The squares tell, unless unequal ones have roots that may round to the same number.
    let is_clear = |x: f64| (x == longest) | (x * (1.0 + 1e-14) < longest);
    let corner = if is_clear(across[0]) & is_clear(across[1]) & is_clear(across[2]) {
        // Without a branch that nobody can foresee.
        usize::from(across[0] != longest) * (1 + usize::from(across[1] != longest))
    } else {
        by_distance(corners)
    };
    direction(DVec3::ZERO + sides[[2, 0, 1][corner]].cross(sides[corner]))
}

/// Which corner lies across from the longest side; the first of equals. Safe for any lengths.
#[cold]
fn by_distance([a, b, c]: [DVec3; 3]) -> usize {
    let across = [distance(b, c), distance(c, a), distance(a, b)];
    (1..3).fold(0, |best, i| if across[i] > across[best] { i } else { best })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;
    use proptest::prelude::*;

    /// As the definition has it.
    fn naive(corners: [DVec3; 3]) -> DVec3 {
        let scale = unit_scale(corners.into_iter());
        let from = by_distance(corners);
        let turned = (0..3).map(|i| corners[(from + i) % 3] * scale);
        direction(double_area_vector(turned))
    }

    proptest! {
        #[test]
        fn the_normal_of_a_triangle_is_that_of_the_polygon_from_the_corner_across_its_longest_side(
            mut coordinates in prop::array::uniform9(prop_oneof![-1.0f64..1.0, (-2i32..3).prop_map(f64::from)]),
            size in prop_oneof![Just(1.0), Just(1e-300), Just(1e300), Just(1e-160), Just(3e100)],
            flat in 0usize..9,
        ) {
            coordinates[flat] *= 1e-9;
            let [x, y, z, u, v, w, p, q, r] = coordinates.map(|c| c * size);
            let corners = [dvec3(x, y, z), dvec3(u, v, w), dvec3(p, q, r)];
            let bits = |n: DVec3| n.to_array().map(f64::to_bits);
            prop_assert_eq!(bits(triangle_normal(corners)), bits(naive(corners)));
            if is_tame(corners.into_iter()) {
                prop_assert_eq!(bits(tame_triangle_normal(corners)), bits(naive(corners)));
            }
        }
    }
}
