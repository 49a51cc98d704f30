//! A boundary loop as the planners see it: corners by their number along the loop.

use crate::Mesh;
use crate::geometry::normals::double_area_vector;
use crate::geometry::unit_scale;
use glam::DVec3;

/// Below this share of its longest side a triangle's height is nothing.
const FLAT: f64 = 1e-10;

/// Corner numbers of triangles, each an ear of what the ones before left, its tip in the middle; the last is what is left.
pub(super) type Ears = Vec<[u32; 3]>;

/// The corners of a loop.
pub(super) struct Ring {
    /// The boundary half-edge at corner 0: the one that starts at the lowest vertex.
    pub(super) first: u32,
    /// The vertices.
    pub(super) vertices: Vec<u32>,
    /// Their places, seen from corner 0 and scaled by a power of two.
    pub(super) points: Vec<DVec3>,
    pub(super) scale: f64,
    /// Pairs of corners that an edge off the loop joins, the lower first, sorted.
    pub(super) chords: Vec<[u32; 2]>,
    /// Heights up to this, in scaled lengths, are what rounding of the coordinates leaves of nothing.
    blur: f64,
}

impl Ring {
    /// The loop through a boundary half-edge. O(n log n + valences).
    pub(super) fn of(mesh: &Mesh, h: u32) -> Self {
        let first = mesh.loop_slots(h).min_by_key(|&h| mesh.origin[h as usize]).unwrap_or(h);
        let vertices: Vec<u32> = mesh.loop_slots(first).map(|h| mesh.origin[h as usize]).collect();
        let places = || vertices.iter().map(|&v| mesh.positions[v as usize]);
        let scale = unit_scale(places());
        let origin = places().next().unwrap_or_default() * scale;
        let points = places().map(|p| p * scale - origin).collect();
        let largest = places().fold(0.0f64, |m, p| m.max((p * scale).abs().max_element()));
        let mut ring =
            Self { first, vertices, points, scale, chords: vec![], blur: 8.0 * f64::EPSILON * largest };
        ring.find_chords(mesh);
        ring
    }

    fn find_chords(&mut self, mesh: &Mesh) {
        let n = self.vertices.len() as u32;
        let mut corner: Vec<(u32, u32)> = self.vertices.iter().copied().zip(0..).collect();
        corner.sort_unstable();
        for (&v, i) in self.vertices.iter().zip(0..) {
            for h in mesh.outgoing_slots(v) {
                let target = mesh.origin[h as usize ^ 1];
                let Ok(at) = corner.binary_search_by_key(&target, |c| c.0) else { continue };
                let j = corner[at].1;
                // No two edges join the same vertices, so neighbours along the loop are joined by the loop's own.
                if i + 1 < j && (i, j) != (0, n - 1) {
                    self.chords.push([i, j]);
                }
            }
        }
        self.chords.sort_unstable();
    }

    pub(super) fn len(&self) -> usize {
        self.vertices.len()
    }

    pub(super) fn is_chord(&self, a: u32, b: u32) -> bool {
        !self.chords.is_empty() && self.chords.binary_search(&[a.min(b), a.max(b)]).is_ok()
    }

    /// Twice the area vector of the loop, scaled.
    pub(super) fn double_area_vector(&self) -> DVec3 {
        double_area_vector(self.points.iter().copied())
    }

    /// The area of a triangle, scaled, and whether it is nothing to rounding.
    #[inline]
    pub(super) fn triangle(&self, a: DVec3, b: DVec3, c: DVec3) -> Triangle {
        let (u, v) = (b - a, c - a);
        let double = u.cross(v).length();
        let (uu, vv, ww) = (u.length_squared(), v.length_squared(), (v - u).length_squared());
        let longest = uu.max(vv).max(ww);
        // Most are far from flat, and need no second root to tell.
        let is_flat = double * double <= 2.0 * longest * (FLAT * FLAT * longest + self.blur * self.blur) && {
            let longest = longest.sqrt();
            double <= longest * (FLAT * longest + self.blur)
        };
        Triangle { area: 0.5 * double, squares: uu + vv + ww, is_flat }
    }

    /// The area of a filler, scaled.
    pub(super) fn area_of(&self, ears: &[[u32; 3]]) -> f64 {
        let areas = ears.iter().map(|t| {
            let [a, b, c] = t.map(|i| self.points[i as usize]);
            0.5 * (b - a).cross(c - a).length()
        });
        areas.sum()
    }
}

/// What a triangle counts for.
pub(super) struct Triangle {
    pub(super) area: f64,
    /// The sum of its squared sides.
    pub(super) squares: f64,
    pub(super) is_flat: bool,
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A ring of these points, in no mesh.
    pub(in super::super) fn ring_of(points: Vec<DVec3>) -> Ring {
        let vertices = (0..points.len() as u32).collect();
        Ring { first: 0, vertices, points, scale: 1.0, chords: vec![], blur: 8.0 * f64::EPSILON }
    }

    /// A wavy ring around the origin; every third seed gives a flat one.
    pub(in super::super) fn noisy_ring(n: usize, seed: u64) -> Ring {
        let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0xD1B5;
        let mut unit = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let point = |i: usize| {
            let (s, c) = (i as f64 / n as f64 * std::f64::consts::TAU).sin_cos();
            let (r, z) = (0.4 + unit() * 0.6, unit() - 0.5);
            DVec3::new(c * r, s * r, if seed.is_multiple_of(3) { 0.0 } else { z })
        };
        ring_of((0..n).map(point).collect())
    }
}
