//! Cotangent weights of edges.

use crate::Mesh;
use crate::geometry::triangulate::Triangulator;
use crate::matching::NONE;
use glam::DVec3;

/// For each half-edge slot the vertex slot opposite it in its face: the apex of the triangle, or of that triangle of a
/// larger face, as the shared rule cuts it, which has the half-edge as a side. [`NONE`] on the boundary.
pub(super) struct Apexes(Vec<u32>);

impl Apexes {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let mut apexes = vec![NONE; mesh.origin.len()];
        let mut rule = Triangulator::default();
        let (mut corners, mut sides) = (Vec::new(), Vec::new());
        // The corner at which a vertex stands in the face at hand.
        let mut corner_of = vec![0usize; mesh.vertex_halfedge.len()];
        for f in mesh.faces.live() {
            sides.clear();
            sides.extend(mesh.loop_slots(mesh.face_halfedge[f as usize]));
            let n = sides.len();
            if let [a, b, c] = sides[..] {
                for (h, opposite) in [(a, c), (b, a), (c, b)] {
                    apexes[h as usize] = mesh.origin[opposite as usize];
                }
                continue;
            }
            corners.clear();
            corners.extend(sides.iter().map(|&h| mesh.origin[h as usize]));
            corners.iter().enumerate().for_each(|(i, &v)| corner_of[v as usize] = i);
            for &[a, b, c] in
                rule.triangulate_by(&corners, |v| mesh.vertices.rank(v), |v| mesh.positions[v as usize])
            {
                for (from, to, opposite) in [(a, b, c), (b, c, a), (c, a, b)] {
                    let i = corner_of[from as usize];
                    if corners[(i + 1) % n] == to {
                        apexes[sides[i] as usize] = opposite;
                    }
                }
            }
        }
        Self(apexes)
    }

    /// The sum of the cotangents of the angles opposite an edge, or zero if that is negative or none.
    pub(super) fn weight(&self, mesh: &Mesh, at: &[DVec3], edge: u32) -> f64 {
        let [h, t] = [2 * edge as usize, 2 * edge as usize + 1];
        let [a, b] = [h, t].map(|h| at[mesh.origin[h] as usize]);
        let opposite = |apex: u32| if apex == NONE { 0.0 } else { cotangent(a, at[apex as usize], b) };
        (opposite(self.0[h]) + opposite(self.0[t])).max(0.0)
    }
}

/// The cotangent of the angle at `apex`; zero where there is no angle.
fn cotangent(a: DVec3, apex: DVec3, b: DVec3) -> f64 {
    let (u, v) = (a - apex, b - apex);
    let cotangent = u.dot(v) / u.cross(v).length();
    if cotangent.is_finite() { cotangent } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cotangent_of_a_right_angle_is_zero_and_of_none_too() {
        assert_eq!(cotangent(DVec3::X, DVec3::ZERO, DVec3::Y), 0.0);
        assert!((cotangent(DVec3::X, DVec3::ZERO, DVec3::X + DVec3::Y) - 1.0).abs() < 1e-15);
        assert_eq!(cotangent(DVec3::X, DVec3::ZERO, DVec3::X * 2.0), 0.0);
        assert_eq!(cotangent(DVec3::X, DVec3::X, DVec3::Y), 0.0);
    }
}
