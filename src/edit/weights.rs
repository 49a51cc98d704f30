//! How much each corner of a face counts at a point: mean value coordinates.

use crate::Mesh;
use crate::geometry::normals::double_area_vector;
use crate::geometry::{direction, unit_scale};
use glam::{DVec2, DVec3};
use smallvec::SmallVec;

type Weights = SmallVec<[f64; 8]>;

/// Slots with their weights.
type Sources = SmallVec<[(u32, f64); 8]>;

/// The mean value coordinates of a point in a polygon, projected along the polygon's area vector: weights that sum to one
/// and give back every linear function on a plane polygon. Equal weights where there are none (no area).
///
/// Hormann and Floater, "Mean value coordinates for arbitrary planar polygons", ACM Transactions on Graphics 25(4), 2006.
pub(super) fn mean_value(corners: &[DVec3], point: DVec3) -> Weights {
    let n = corners.len();
    let equal = || smallvec::smallvec![1.0 / n as f64; n];
    let scale = unit_scale(corners.iter().copied().chain([point]));
    let normal = direction(double_area_vector(corners.iter().map(|&p| p * scale)));
    if normal == DVec3::ZERO {
        return equal();
    }
    let (x, y) = normal.any_orthonormal_pair();
    let s: SmallVec<[DVec2; 8]> =
        corners.iter().map(|&p| (p - point) * scale).map(|d| DVec2::new(d.dot(x), d.dot(y))).collect();
    let next = |i: usize| if i + 1 == n { 0 } else { i + 1 };
    for i in 0..n {
        let (a, b) = (s[i], s[next(i)]);
        let mut weights: Weights = smallvec::smallvec![0.0; n];
        if a == DVec2::ZERO {
            weights[i] = 1.0;
            return weights;
        }
        if a.perp_dot(b) == 0.0 && a.dot(b) < 0.0 {
            let (ra, rb) = (a.length(), b.length());
            weights[i] = rb / (ra + rb);
            weights[next(i)] = ra / (ra + rb);
            return weights;
        }
    }
    let mut weights: Weights = smallvec::smallvec![0.0; n];
    for i in 0..n {
        let j = next(i);
        let (a, b) = (s[i], s[j]);
        let area = a.perp_dot(b);
        if area != 0.0 {
            // The tangent of half the angle that the edge is seen under.
            let (ra, rb) = (a.length(), b.length());
            let tangent = (ra * rb - a.dot(b)) / area;
            weights[i] += tangent / ra;
            weights[j] += tangent / rb;
        }
    }
    let sum: f64 = weights.iter().sum();
    if sum == 0.0 || !sum.is_finite() || weights.iter().any(|w| !(w / sum).is_finite()) {
        return equal();
    }
    weights.iter_mut().for_each(|w| *w /= sum);
    weights
}

impl Mesh {
    /// The corners of a loop with their weights at a point: one list by vertex, one by half-edge.
    pub(super) fn loop_weights(&self, first: u32, point: DVec3) -> (Sources, Sources) {
        let points: SmallVec<[DVec3; 8]> = self.loop_slots(first).map(|h| self.at(h)).collect();
        let weights = mean_value(&points, point);
        let each = || self.loop_slots(first).zip(weights.iter().copied());
        (each().map(|(h, w)| (self.origin[h as usize], w)).collect(), each().collect())
    }

    /// Twice the area of a face, to weigh it by; 1 where that is no number or nothing.
    pub(super) fn face_weight(&self, f: u32) -> f64 {
        let area =
            double_area_vector(self.loop_slots(self.face_halfedge[f as usize]).map(|h| self.at(h))).length();
        if area.is_finite() && area > 0.0 { area } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;

    #[test]
    fn weights_give_back_the_point_inside_on_an_edge_and_at_a_corner() {
        // A dart, which is not convex.
        let dart = [dvec3(0., 0., 1.), dvec3(2., 1., 1.), dvec3(0., 2., 1.), dvec3(0.5, 1., 1.)];
        for p in
            [dvec3(1.0, 1.0, 1.0), dvec3(1.0, 0.5, 1.0), dart[3], dvec3(0.25, 0.5, 1.0), dvec3(3., 3., 1.)]
        {
            let w = mean_value(&dart, p);
            let back: DVec3 = dart.iter().zip(&w).map(|(&q, &w)| q * w).sum();
            assert!((back - p).length() < 1e-13, "{p} from {w:?}");
            assert!((w.iter().sum::<f64>() - 1.0).abs() < 1e-13);
        }
    }

    #[test]
    fn a_face_without_area_weighs_its_corners_alike() {
        let line = [DVec3::ZERO, DVec3::X, DVec3::X * 3.0];
        assert_eq!(mean_value(&line, DVec3::X).as_slice(), [1.0 / 3.0; 3]);
    }
}
