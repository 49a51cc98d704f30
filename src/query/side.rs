//! On which side of the surface a point is, seen from its nearest point.

use super::cast::Part;
use super::{MeshIndex, Side};
use crate::geometry::normals::{angle, double_area_vector};
use crate::geometry::triangulate::Triangulator;
use crate::geometry::{direction, unit_scale};
use crate::matching::NONE;
use glam::DVec3;
use smallvec::SmallVec;

impl MeshIndex<'_> {
    /// The side of `point` by the normal at its nearest point `place`, on a part of a triangle: the sum of the unit normals
    /// of all triangles there, at a vertex weighted by their angles.
    pub(super) fn side_at(&self, triangle: u32, part: Part, point: DVec3, place: DVec3) -> Side {
        let scale = unit_scale([point, place].into_iter());
        let away = direction(point * scale - place * scale);
        let sign = away.dot(self.normal_at(triangle, part));
        match sign {
            s if s > 0.0 => Side::Outside,
            s if s < 0.0 => Side::Inside,
            _ => Side::On,
        }
    }

    fn normal_at(&self, triangle: u32, part: Part) -> DVec3 {
        let (mesh, corners) = (self.mesh, self.corner_slots(triangle));
        let unit = |t: [u32; 3]| {
            let places = t.map(|v| mesh.positions[v as usize] * self.tree.scale);
            direction(double_area_vector(places.into_iter()))
        };
        let mut rule = Triangulator::default();
        // The normals of the triangles of a face that have all these corners.
        let mut sum_over = |face: u32, of: &[u32]| {
            let around = mesh.loop_slots(mesh.face_halfedge[face as usize]);
            let polygon: SmallVec<[u32; 8]> = around.map(|h| mesh.origin[h as usize]).collect();
            let whole;
            let triangles = if let [a, b, c] = polygon[..] {
                whole = [[a, b, c]];
                whole.iter()
            } else {
                rule.triangulate_by(&polygon, |v| mesh.vertices.rank(v), |v| mesh.positions[v as usize])
                    .iter()
            };
            let normal = |t: &[u32; 3]| match (of, t.iter().position(|v| *v == of[0])) {
                ([_], Some(i)) => {
                    let at = |k: usize| mesh.positions[t[(i + k) % 3] as usize] * self.tree.scale;
                    unit(*t) * angle(at(2), at(0), at(1))
                }
                _ => unit(*t),
            };
            triangles.filter(|t| of.iter().all(|v| t.contains(v))).map(normal).sum::<DVec3>()
        };
        match part {
            Part::Inside => unit(corners),
            Part::Edge(i) => {
                let ends = [corners[i], corners[(i + 1) % 3]];
                let own = self.face_slot(triangle);
                let across = self.halfedge_slot(triangle, i).map_or(NONE, |h| mesh.face[h as usize ^ 1]);
                let other = if across == NONE { DVec3::ZERO } else { sum_over(across, &ends) };
                sum_over(own, &ends) + other
            }
            Part::Corner(i) => {
                let around = mesh.outgoing_slots(corners[i]).map(|h| mesh.face[h as usize]);
                around.filter(|&f| f != NONE).map(|f| sum_over(f, &corners[i..=i])).sum()
            }
        }
    }
}
