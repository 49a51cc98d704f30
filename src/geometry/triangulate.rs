//! The one triangulation rule for polygons, used wherever a polygon must become triangles: volume, area, files that
//! hold only triangles.
//!
//! The rule reads the polygon from its lowest vertex towards the lower neighbour, so it does not depend on the first
//! corner, and the reversed polygon gives the same triangles reversed. Of the diagonals of a quad that are as long but for
//! rounding it takes that from the lowest vertex. Ears are clipped in the plane of the polygon's
//! area vector (Meisters, "Polygons have ears", American Mathematical Monthly 82, 1975), tested against reflex corners
//! only, which lie in a grid. A polygon that crosses itself or has no area still gives `n - 2` triangles.

use super::normals::double_area_vector;
use super::{direction, unit_scale};
use crate::Polygons;
use crate::topology::Cycle;
use glam::{DVec2, DVec3};

/// Reusable triangulation of one polygon after the other.
#[derive(Clone, Debug, Default)]
pub(crate) struct Triangulator {
    cycle: Vec<u32>,
    plane: Vec<DVec2>,
    triangles: Vec<[u32; 3]>,
    next: Vec<u32>,
    prev: Vec<u32>,
    /// Within this of the line between its neighbours, rounding may have put a straight corner.
    noise: f64,
}

impl Triangulator {
    /// The triangles of a polygon, as its corners' vertices and in its winding: `n - 2` of them, none below three
    /// corners. O(n log n) on polygons from life; at worst a fixed multiple of n, then the rest is cut as a fan.
    pub(crate) fn triangulate(&mut self, corners: &[u32], at: impl Fn(u32) -> DVec3) -> &[[u32; 3]] {
        self.triangulate_by(corners, |v| v, at)
    }

    /// [`triangulate`](Self::triangulate) where vertices are low by what stands for them in some order.
    pub(crate) fn triangulate_by(
        &mut self,
        corners: &[u32],
        order: impl Fn(u32) -> u32,
        at: impl Fn(u32) -> DVec3,
    ) -> &[[u32; 3]] {
        self.triangles.clear();
        match *corners {
            [] | [_] | [_, _] => {}
            [a, b, c] => self.triangles.push([a, b, c]),
            _ => {
                let cycle = Cycle::by(corners, order);
                self.cycle.clear();
                self.cycle.extend(cycle.iter());
                let scale = unit_scale(corners.iter().map(|&v| at(v)));
                if self.cycle.len() == 4 {
                    let quad = [0, 1, 2, 3].map(|i| at(self.cycle[i]) * scale);
                    let cut =
                        if first_diagonal(quad) { [[0, 1, 2], [0, 2, 3]] } else { [[0, 1, 3], [1, 2, 3]] };
                    self.triangles.extend(cut);
                } else {
                    self.flatten(|v| at(v) * scale);
                    self.clip_ears();
                }
                for t in &mut self.triangles {
                    *t = t.map(|i| self.cycle[i as usize]);
                    if cycle.is_reversed() {
                        t.swap(1, 2);
                    }
                }
            }
        }
        &self.triangles
    }

    /// Projects the cycle along its area vector, to be seen counter-clockwise.
    fn flatten(&mut self, at: impl Fn(u32) -> DVec3) {
        let points = || self.cycle.iter().map(|&v| at(v));
        let normal = direction(double_area_vector(points()));
        let (x, y) = if normal == DVec3::ZERO { (DVec3::X, DVec3::Y) } else { normal.any_orthonormal_pair() };
        let origin = points().next().unwrap_or_default();
        self.noise = noise(points());
        // glam's pair (x, y) is right-handed with the normal.
        self.plane = points().map(|p| DVec2::new((p - origin).dot(x), (p - origin).dot(y))).collect();
    }

    fn clip_ears(&mut self) {
        let n = self.plane.len();
        self.next = (1..n as u32).chain([0]).collect();
        self.prev = [n as u32 - 1].into_iter().chain(0..n as u32 - 1).collect();
        let mut reflex: Vec<bool> = (0..n).map(|i| !self.is_convex(i)).collect();
        let grid = Grid::new(&self.plane, &reflex);
        // Some tens of times what polygons from life take; without a bound one file could take minutes.
        let mut budget = 128 * n + 4096;
        let (mut left, mut at, mut since_ear) = (n, 0u32, 0);
        while left > 3 {
            budget = budget.saturating_sub(1);
            let i = at as usize;
            let (p, q) = (self.prev[i], self.next[i]);
            let ear = budget > 0 && !reflex[i] && self.is_ear(i, &reflex, &grid, &mut budget);
            // Round once without an ear: the polygon crosses itself or lies on a line. Cut anyway.
            if !ear && since_ear < left && budget > 0 {
                since_ear += 1;
                at = q;
                continue;
            }
            self.triangles.push([p, at, q]);
            self.next[p as usize] = q;
            self.prev[q as usize] = p;
            reflex[i] = false;
            for k in [p, q] {
                reflex[k as usize] = reflex[k as usize] && !self.is_convex(k as usize);
            }
            left -= 1;
            since_ear = 0;
            // Skipping a corner keeps ears from forming one long fan.
            at = self.next[q as usize];
        }
        self.triangles.push([self.prev[at as usize], at, self.next[at as usize]]);
    }

    /// Whether a corner turns to the left by more than rounding explains: an ear at a straight corner would have no area.
    fn is_convex(&self, i: usize) -> bool {
        let [a, b, c] = [self.prev[i] as usize, i, self.next[i] as usize].map(|k| self.plane[k]);
        (b - a).perp_dot(c - b) > self.noise * a.distance(b).max(b.distance(c))
    }

    /// Whether no reflex corner lies in the corner's triangle, its edges included.
    fn is_ear(&self, i: usize, reflex: &[bool], grid: &Grid, budget: &mut usize) -> bool {
        let (p, q) = (self.prev[i] as usize, self.next[i] as usize);
        let [a, b, c] = [p, i, q].map(|k| self.plane[k]);
        let (min, max) = (a.min(b).min(c), a.max(b).max(c));
        grid.cells(min, max).all(|cell| {
            *budget = budget.saturating_sub(1 + cell.len());
            cell.iter().all(|&k| {
                let k = k as usize;
                let x = self.plane[k];
                // Corners at the same place as one of the triangle's (keyholes) do not stand in the way.
                !reflex[k]
                    || k == p
                    || k == q
                    || x == a
                    || x == b
                    || x == c
                    || (b - a).perp_dot(x - a) < 0.0
                    || (c - b).perp_dot(x - b) < 0.0
                    || (a - c).perp_dot(x - c) < 0.0
            })
        })
    }
}

/// Whether a quad is cut from corner 0 to corner 2: the cut that leaves two triangles on the quad's side, or of two such
/// the shorter. Of two that are as long but for rounding it is the first: how a quad is cut must not depend on where it is
/// moved and turned.
fn first_diagonal([a, b, c, d]: [DVec3; 4]) -> bool {
    let normal = direction(double_area_vector([a, b, c, d].into_iter()));
    let noise = noise([a, b, c, d].into_iter());
    let up = |p: DVec3, q: DVec3, r: DVec3| {
        (q - p).cross(r - p).dot(normal) > noise * p.distance(q).max(q.distance(r)).max(r.distance(p))
    };
    let (ac, bd) = (up(a, b, c) && up(a, c, d), up(a, b, d) && up(b, c, d));
    if ac == bd { a.distance(c) <= b.distance(d) * (1.0 + 1e-12) + noise } else { ac }
}

/// How far rounding may move points, with some room for projecting them.
fn noise(points: impl Iterator<Item = DVec3>) -> f64 {
    16.0 * f64::EPSILON * points.fold(0.0, |m, p| p.abs().max_element().max(m))
}

/// The reflex corners of a polygon in a grid of about as many cells.
pub(super) struct Grid {
    origin: DVec2,
    per_unit: DVec2,
    columns: usize,
    rows: usize,
    starts: Vec<u32>,
    corners: Vec<u32>,
}

impl Grid {
    pub(super) fn new(plane: &[DVec2], reflex: &[bool]) -> Self {
        let corners = || (0..plane.len()).filter(|&i| reflex[i]);
        let side = (corners().count() as f64).sqrt().ceil().clamp(1.0, 1024.0) as usize;
        let min = plane.iter().fold(DVec2::INFINITY, |m, &p| m.min(p));
        let max = plane.iter().fold(DVec2::NEG_INFINITY, |m, &p| m.max(p));
        let size = max - min;
        let per = |length: f64| if length > 0.0 { side as f64 / length } else { 0.0 };
        let per_unit = DVec2::new(per(size.x), per(size.y));
        let mut grid = Self {
            origin: min,
            per_unit,
            columns: side,
            rows: side,
            starts: vec![0; side * side + 1],
            corners: vec![],
        };
        let cell = |i: usize| {
            let [x, y] = grid.cell(plane[i]);
            y * side + x
        };
        let mut placed: Vec<(u32, u32)> = corners().map(|i| (cell(i) as u32, i as u32)).collect();
        placed.sort_unstable();
        for &(cell, _) in &placed {
            grid.starts[cell as usize + 1] += 1;
        }
        for i in 0..side * side {
            grid.starts[i + 1] += grid.starts[i];
        }
        grid.corners = placed.into_iter().map(|p| p.1).collect();
        grid
    }

    fn cell(&self, p: DVec2) -> [usize; 2] {
        let at = (p - self.origin) * self.per_unit;
        [(at.x as usize).min(self.columns - 1), (at.y as usize).min(self.rows - 1)]
    }

    pub(super) fn cells(&self, min: DVec2, max: DVec2) -> impl Iterator<Item = &[u32]> {
        let ([x0, y0], [x1, y1]) = (self.cell(min), self.cell(max));
        // A row of cells lies together.
        (y0..=y1).map(move |y| {
            let row = y * self.columns;
            &self.corners[self.starts[row + x0] as usize..self.starts[row + x1 + 1] as usize]
        })
    }
}

/// Calls `f` with every triangle of every polygon, in order.
pub(crate) fn for_each_triangle(polygons: &Polygons, positions: &[DVec3], mut f: impl FnMut([u32; 3])) {
    let mut rule = Triangulator::default();
    for corners in polygons.iter() {
        match *corners {
            [a, b, c] => f([a, b, c]),
            _ => rule.triangulate(corners, |v| positions[v as usize]).iter().for_each(|&t| f(t)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;

    fn area(points: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
        let each = triangles.iter().map(|t| double_area_vector(t.iter().map(|&i| points[i as usize])));
        each.map(|a| a.length() / 2.0).sum()
    }

    fn cut(points: &[DVec3], corners: &[u32]) -> Vec<[u32; 3]> {
        Triangulator::default().triangulate(corners, |v| points[v as usize]).to_vec()
    }

    /// A star with `2 n` corners, radii one and a third.
    fn star(n: usize) -> Vec<DVec3> {
        let corner = |i: usize| {
            let (s, c) = (i as f64 * std::f64::consts::PI / n as f64).sin_cos();
            let r = if i.is_multiple_of(2) { 1.0 } else { 1.0 / 3.0 };
            dvec3(c * r, s * r, 0.5 * c * r)
        };
        (0..2 * n).map(corner).collect()
    }

    #[test]
    fn triangles_of_a_concave_polygon_cover_it_once() {
        for n in [3, 5, 40, 1000] {
            let points = star(n);
            let corners: Vec<u32> = (0..points.len() as u32).collect();
            let triangles = cut(&points, &corners);
            assert_eq!(triangles.len(), points.len() - 2);
            let whole = double_area_vector(points.iter().copied()).length() / 2.0;
            assert!((area(&points, &triangles) / whole - 1.0).abs() < 1e-9, "n = {n}");
        }
    }

    #[test]
    fn a_concave_quad_is_cut_along_its_inner_diagonal() {
        let dart = [dvec3(0., 0., 0.), dvec3(2., 1., 0.), dvec3(0., 2., 0.), dvec3(0.5, 1., 0.)];
        for turn in 0..4u32 {
            let corners = [0, 1, 2, 3].map(|i| (i + turn) % 4);
            assert!((area(&dart, &cut(&dart, &corners)) - 1.5).abs() < 1e-12);
        }
    }

    #[test]
    fn a_twisted_square_is_cut_alike_however_it_is_moved_and_turned() {
        let twisted = [dvec3(1., 0., 1.), dvec3(0., 1., -1.), dvec3(-1., 0., 1.), dvec3(0., -1., -1.)];
        for turn in 0..4u32 {
            let corners = [0, 1, 2, 3].map(|i| (i + turn) % 4);
            for axis in [DVec3::X, DVec3::Y, DVec3::Z, dvec3(1., 2., 3.), dvec3(-3., 1., 0.5)] {
                for step in 0..100 {
                    let rotation = glam::DQuat::from_axis_angle(axis.normalize(), f64::from(step) * 0.37);
                    for offset in [0.0, 1.0, 1e6] {
                        let moved = twisted.map(|p| rotation * (p * 0.3) + DVec3::splat(offset));
                        assert_eq!(
                            normalised(cut(&moved, &corners), false),
                            [[0, 1, 2], [0, 2, 3]],
                            "{turn} {axis} {step} {offset}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn the_rule_depends_neither_on_the_first_corner_nor_on_the_direction() {
        let points = star(6);
        let n = points.len() as u32;
        let expected = normalised(cut(&points, &(0..n).collect::<Vec<_>>()), false);
        for turn in 0..n {
            let mut corners: Vec<u32> = (0..n).map(|i| (i + turn) % n).collect();
            assert_eq!(normalised(cut(&points, &corners), false), expected);
            corners.reverse();
            assert_eq!(normalised(cut(&points, &corners), true), expected);
        }
    }

    /// Triangles from their lowest vertex, sorted; reversed first on demand.
    fn normalised(triangles: Vec<[u32; 3]>, reversed: bool) -> Vec<[u32; 3]> {
        let turned = triangles.into_iter().map(|[a, b, c]| {
            let mut t = if reversed { [a, c, b] } else { [a, b, c] };
            let low = (0..3).min_by_key(|&i| t[i]).unwrap();
            t.rotate_left(low);
            t
        });
        let mut all: Vec<_> = turned.collect();
        all.sort_unstable();
        all
    }

    #[test]
    fn straight_corners_are_no_ears_whatever_rounding_does_to_them() {
        // A triangle with many corners on its sides, in any plane, of any number.
        let ends = [dvec3(0.3, 0.1, 0.7), dvec3(1.1, -0.2, 0.4), dvec3(0.9, 1.3, -0.6)];
        for n in [1, 2, 5, 40] {
            let side = |i: usize| (0..n).map(move |k| ends[i].lerp(ends[(i + 1) % 3], k as f64 / n as f64));
            let last =
                if n == 1 { vec![ends[1].lerp(ends[2], 1.0 / 3.0), ends[2]] } else { side(2).collect() };
            let points: Vec<DVec3> = side(0).chain(side(1)).chain(last).collect();
            for turn in 0..points.len() as u32 {
                let corners: Vec<u32> = (0..points.len() as u32).collect();
                let rotated: Vec<DVec3> =
                    corners.iter().map(|i| points[(i + turn) as usize % points.len()]).collect();
                for t in cut(&rotated, &corners) {
                    assert!(area(&rotated, &[t]) > 1e-4, "{n} {turn} {t:?}");
                }
            }
        }
    }

    #[test]
    fn polygons_without_area_or_with_crossings_give_all_their_triangles() {
        let line: Vec<DVec3> = (0..9).map(|i| dvec3(i as f64, 0., 0.)).collect();
        assert_eq!(cut(&line, &[0, 3, 1, 4, 2, 8, 5]).len(), 5);
        let bow =
            [dvec3(0., 0., 0.), dvec3(2., 2., 0.), dvec3(2., 0., 0.), dvec3(0., 2., 0.), dvec3(-1., 1., 0.)];
        assert_eq!(cut(&bow, &[0, 1, 2, 3, 4]).len(), 3);
    }
}
