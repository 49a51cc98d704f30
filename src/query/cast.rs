//! A line cast through a tree of triangles: which triangles it passes, exactly.
//!
//! A line passes a triangle if it lies on one side of all three edges. Sides are decided by a filter, and where that
//! cannot tell, [exactly](super::exact). A line that meets an edge or a vertex is moved by an infinitesimal step, always
//! the same (Edelsbrunner and Mücke, "Simulation of Simplicity", ACM Transactions on Graphics 9, 1990); then it passes
//! each triangle or does not, and the passings of a closed surface add up to its winding number.

use super::bvh::{Frame, Node, Tree, WIDTH, not_above, rounded_down, rounded_up};
use super::exact::{Line, rounded};
use crate::geometry::unit_scale;
use glam::DVec3;
use smallvec::SmallVec;

/// Origins are kept within this many lengths of the mesh.
const FARTHEST: f64 = f64::from_bits((1023 + 960) << 52);
/// Directions steeper than this are as good as parallel to the box's side, within what is added to the box.
const STEEPEST: f64 = f64::from_bits((1023 - 60) << 52);
/// More than the rounding of a box test in single precision, about ten half-ulps.
const WIDER: f32 = 1.000_002;

/// A ray made ready for a tree.
#[derive(Clone, Debug)]
pub(crate) struct Cast<'t> {
    tree: &'t Tree,
    /// Scaled as the tree is, the direction's largest component between one and two.
    line: Line,
    /// That component's reciprocal, in its place.
    depth: DVec3,
    /// Parameter from a scaled one: by this, then by that.
    unit: [f64; 2],
    /// The scaled parameter at which the boxes begin at the earliest.
    start: f64,
    /// The line's point there.
    entry: DVec3,
    /// The same in single precision about the tree's center, moved so that no box that the ray meets is missed: for the
    /// near sides of boxes, and for the far ones.
    near: [f32; 3],
    far: [f32; 3],
    inverse: [f32; 3],
    /// The rows of a node's bounds that are near and far.
    rows: [(usize, usize); 3],
}

/// A part of a triangle: its inside (a cut through a polygon is none of its parts), the edge from a corner, or a corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    Inside,
    Edge(usize),
    Corner(usize),
}

/// How a line meets a triangle.
#[derive(Debug)]
pub(crate) enum Meeting {
    Miss,
    /// At one point of its inside.
    Through(Passing),
    /// At an edge or a corner, or in its plane.
    Touching(Contact),
}

/// A line through the inside of a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passing {
    pub(crate) triangle: u32,
    /// The scaled parameter, not negative; zero only if the origin is on the triangle.
    pub(crate) t: f64,
    /// Barycentric.
    pub(crate) weights: [f64; 3],
    /// 1 along the triangle's normal, -1 against it.
    pub(crate) facing: i8,
}

/// A vertex, twice, or the two vertices of an edge, the lower first; then, for a cut, the face it cuts and one.
pub(crate) type Key = (u32, u32, u32);

/// Where a line meets the boundary of a triangle.
#[derive(Clone, Debug)]
pub(crate) struct Contact {
    pub(crate) triangle: u32,
    pub(crate) at: SmallVec<[Touched; 3]>,
    /// The sign of the angle to the normal; 0 in the triangle's plane.
    pub(crate) facing: i8,
    /// `facing` if the moved line passes, else 0.
    pub(crate) passes: i8,
}

/// A vertex or an edge that a line meets.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Touched {
    pub(crate) key: Key,
    pub(crate) part: Part,
    /// The scaled parameter; its sign is exact.
    pub(crate) t: f64,
    /// Where on the edge, from the corner to the next.
    pub(crate) along: f64,
}

impl<'t> Cast<'t> {
    /// Makes a ray ready: finite, the direction not zero.
    pub(crate) fn new(tree: &'t Tree, origin: DVec3, direction: DVec3) -> Self {
        // Twice, for directions too short for one scale.
        let first = unit_scale(std::iter::once(direction));
        let second = unit_scale(std::iter::once(direction * first));
        let d = rounded(direction * first * second);
        let o = rounded((origin * tree.scale).clamp(DVec3::splat(-FARTHEST), DVec3::splat(FARTHEST)));
        let line = Line { origin: o, direction: d };
        let depth = match d.abs() {
            a if a.x >= a.y && a.x >= a.z => DVec3::X / d.x,
            a if a.y >= a.z => DVec3::Y / d.y,
            _ => DVec3::Z / d.z,
        };

        let from_center = o - tree.center;
        let closest = -from_center.dot(d) / d.length_squared();
        let reach = tree.radius / d.length() * (1.0 + 1e-9) + closest.abs() * 1e-12;
        let start = (closest - reach).max(0.0);
        let entry = from_center + d * start;
        let (mut near, mut far, mut inverse, mut rows) = ([0.0; 3], [0.0; 3], [0.0; 3], [(0, 0); 3]);
        for i in 0..3 {
            let moved = o[i].abs() + tree.center[i].abs() + (start * d[i]).abs();
            let pad = moved * (8.0 * f64::EPSILON) + reach * (4.0 * STEEPEST) + f64::MIN_POSITIVE;
            let (low, high) = (rounded_down(entry[i] - pad), rounded_up(entry[i] + pad));
            inverse[i] = (1.0 / d[i].abs().max(STEEPEST).copysign(d[i])) as f32;
            (near[i], far[i], rows[i]) =
                if inverse[i] > 0.0 { (high, low, (i, i + 3)) } else { (low, high, (i + 3, i)) };
        }
        let unit = [first / tree.scale, second];
        Self { tree, line, depth, unit, start, entry: o + d * start, near, far, inverse, rows }
    }

    pub(crate) fn tree(&self) -> &'t Tree {
        self.tree
    }

    /// The parameter of the ray as it was given.
    pub(crate) fn parameter(&self, t: f64) -> f64 {
        t * self.unit[0] * self.unit[1]
    }

    /// A limit for [`walk`](Self::walk) that keeps everything up to a scaled parameter.
    pub(crate) fn limit(&self, t: f64) -> f32 {
        rounded_up((t - self.start) + t.abs() * 1e-12) * WIDER
    }

    /// Shows `leaf` the triangles of all boxes that the ray meets before a limit, which `leaf` returns anew each time;
    /// roughly the nearest first if `ordered`.
    #[inline]
    pub(crate) fn walk(&self, ordered: bool, mut leaf: impl FnMut(std::ops::Range<u32>) -> f32) {
        let mut limit = f32::INFINITY;
        let mut stack: SmallVec<[(f32, u32, Frame); 64]> = SmallVec::new();
        stack.extend(self.tree.root().map(|(root, frame)| (0.0, root, frame)));
        while let Some((enter, at, frame)) = stack.pop() {
            if enter > limit {
                continue;
            }
            let node = &self.tree.nodes[at as usize];
            let (enter, mut met) = self.meets(node, &frame, limit);
            let bottom = stack.len();
            let mut leaves = 0u32;
            while met != 0 {
                let i = met.trailing_zeros() as usize % WIDTH;
                met &= met - 1;
                let Some(child) = node.inner(i) else {
                    self.tree.touch_triangle(node.leaf(i).start);
                    leaves |= 1 << i;
                    continue;
                };
                self.tree.touch(child);
                let mut j = stack.len();
                stack.push((enter[i], child, frame.of_child(node, i)));
                // The nearest on top.
                while ordered && j > bottom && stack[j - 1].0 < stack[j].0 {
                    stack.swap(j - 1, j);
                    j -= 1;
                }
            }
            while leaves != 0 {
                let i = leaves.trailing_zeros() as usize % WIDTH;
                leaves &= leaves - 1;
                if enter[i] <= limit {
                    limit = leaf(node.leaf(i));
                }
            }
        }
    }

    /// Where the ray enters each child, and which children it meets before the limit.
    #[inline(always)]
    pub(super) fn meets(&self, node: &Node, frame: &Frame, limit: f32) -> ([f32; WIDTH], u32) {
        let mut enter = [0.0f32; WIDTH];
        let mut exit = [limit; WIDTH];
        for axis in 0..3 {
            let (near, far) = (node.sides(frame, self.rows[axis].0), node.sides(frame, self.rows[axis].1));
            for i in 0..WIDTH {
                let a = (near[i] - self.near[axis]) * self.inverse[axis];
                let b = (far[i] - self.far[axis]) * self.inverse[axis];
                enter[i] = if a > enter[i] { a } else { enter[i] };
                exit[i] = if b < exit[i] { b } else { exit[i] };
            }
        }
        (enter, not_above(&enter, &exit.map(|x| x * WIDER)))
    }

    /// How the ray meets a triangle; what lies behind the origin or beyond the scaled parameter `limit` may count as
    /// missed.
    #[inline]
    pub(crate) fn meet(&self, triangle: u32, limit: f64) -> Meeting {
        let places = self.tree.places(triangle);
        let d = self.line.direction;
        let [a, b, c] = places.map(|p| p - self.line.origin);
        // Parameters at which the corners are level; a difference has the exact sign.
        let [za, zb, zc] = [a, b, c].map(|p| p.dot(self.depth));
        let (lowest, highest) = (za.min(zb).min(zc), za.max(zb).max(zc));
        if highest < 0.0 || lowest > limit {
            return Meeting::Miss;
        }
        let (da, db, dc) = (d.cross(a), d.cross(b), d.cross(c));
        let (ab, bc, ca) = (da.dot(b), db.dot(c), dc.dot(a));
        let largest = a.abs().max(b.abs()).max(c.abs()).max_element();
        // A sum of six products of three factors, of which the direction's are below two.
        let doubt = largest * largest * SIDE_ERROR + TINIEST;
        let (least, most) = (ab.min(bc).min(ca), ab.max(bc).max(ca));
        if least < -doubt && most > doubt {
            return Meeting::Miss;
        }
        if lowest > 0.0 && (least > doubt || most < -doubt) {
            let inverse = 1.0 / (ab + bc + ca);
            let weights = [bc * inverse, ca * inverse, ab * inverse];
            // Not outside by rounding, or a limit below could hide it.
            let t = (weights[0] * za + weights[1] * zb + weights[2] * zc).clamp(lowest, highest);
            let facing = if least > 0.0 { 1 } else { -1 };
            return Meeting::Through(Passing { triangle, t, weights, facing });
        }
        self.meet_exactly(triangle, places, [ab, bc, ca], doubt)
    }

    /// The same where the filter cannot tell: near an edge, or near the origin.
    #[cold]
    fn meet_exactly(&self, triangle: u32, places: [DVec3; 3], sides: [f64; 3], doubt: f64) -> Meeting {
        let signs: [i8; 3] = std::array::from_fn(|i| match sides[i] {
            s if s > doubt => 1,
            s if s < -doubt => -1,
            _ => self.line.side(places[i], places[(i + 1) % 3]),
        });
        let (least, most) = (signs.into_iter().min().unwrap_or(0), signs.into_iter().max().unwrap_or(0));
        if least < 0 && most > 0 {
            return Meeting::Miss;
        }
        let facing = least + most;
        if least * most == 1 {
            let facing = facing.signum();
            return self.through(triangle, places, facing);
        }
        let touched = if facing == 0 {
            let Some(touched) = self.in_plane(triangle, places) else { return Meeting::Miss };
            touched
        } else {
            // A zero at two edges is the corner between them.
            let zero = signs.map(|s| s == 0);
            let part = match (0..3).find(|&i| zero[i] && zero[(i + 2) % 3]) {
                Some(corner) => Part::Corner(corner),
                None => Part::Edge(zero.iter().position(|&z| z).unwrap_or(0)),
            };
            SmallVec::from_slice(&[self.touched(triangle, places, part)])
        };
        let moved = |i: usize| match signs[i] {
            0 => self.line.moved_side(places[i], places[(i + 1) % 3]),
            s => s,
        };
        let passes = facing != 0 && (0..3).all(|i| moved(i) == facing.signum());
        let facing = facing.signum();
        Meeting::Touching(Contact { triangle, at: touched, facing, passes: if passes { facing } else { 0 } })
    }

    /// Through the inside for certain: where, if not behind the origin.
    fn through(&self, triangle: u32, places: [DVec3; 3], facing: i8) -> Meeting {
        let depths = places.map(|p| (p - self.line.origin).dot(self.depth));
        let ahead = if depths.iter().all(|&z| z > 0.0) {
            1
        } else if depths.iter().all(|&z| z < 0.0) {
            -1
        } else {
            self.line.origin_side(places) * facing
        };
        if ahead < 0 {
            return Meeting::Miss;
        }
        // About the entry, where digits are left if the origin is far away.
        let d = self.line.direction;
        let [a, b, c] = places.map(|p| p - self.entry);
        let side = |p: DVec3, q: DVec3| (d.cross(p).dot(q) * f64::from(facing)).max(0.0);
        let sides = [side(b, c), side(c, a), side(a, b)];
        let sum = sides[0] + sides[1] + sides[2];
        let weights = if sum > 0.0 && sum.is_finite() { sides.map(|s| s / sum) } else { [1.0 / 3.0; 3] };
        let [lowest, highest] = [f64::min, f64::max].map(|f| f(f(depths[0], depths[1]), depths[2]));
        let level: f64 = (0..3).map(|i| weights[i] * depths[i]).sum();
        let t = if ahead == 0 { 0.0 } else { level.clamp(lowest, highest).max(f64::MIN_POSITIVE) };
        Meeting::Through(Passing { triangle, t, weights, facing })
    }

    /// The corners and edges that a line in the plane of a triangle meets; `None` if it passes by. The triangle may have
    /// no area.
    fn in_plane(&self, triangle: u32, places: [DVec3; 3]) -> Option<SmallVec<[Touched; 3]>> {
        let moments = places.map(|p| self.line.moment(p));
        // All moments are multiples of one vector: any component in which one is not zero tells their signs.
        let axis = (0..3).find(|&k| moments.iter().any(|m| m[k] != 0)).unwrap_or(0);
        let signs = moments.map(|m| m[axis]);
        let corners = (0..3).filter(|&i| signs[i] == 0).map(Part::Corner);
        let edges = (0..3).filter(|&i| signs[i] * signs[(i + 1) % 3] < 0).map(Part::Edge);
        let met: SmallVec<[Touched; 3]> =
            corners.chain(edges).map(|part| self.touched(triangle, places, part)).collect();
        (!met.is_empty()).then_some(met)
    }

    fn touched(&self, triangle: u32, places: [DVec3; 3], part: Part) -> Touched {
        let corners = self.tree.corners(triangle);
        let level = |p: DVec3| (p - self.line.origin).dot(self.depth);
        match part {
            Part::Edge(i) => {
                let j = (i + 1) % 3;
                let is_swapped = corners[i] > corners[j];
                // The same computation from both faces.
                let (i, j) = if is_swapped { (j, i) } else { (i, j) };
                let (p, q) = (places[i], places[j]);
                let moment = |p: DVec3| (p - self.entry).cross(self.line.direction).length();
                let (of_p, of_q) = (moment(p), moment(q));
                let along = if of_p + of_q > 0.0 { of_p / (of_p + of_q) } else { 0.5 };
                let (zp, zq) = (level(p), level(q));
                let t = zp + (zq - zp) * along;
                let t = if (zp > 0.0 && zq > 0.0) || (zp < 0.0 && zq < 0.0) {
                    t
                } else {
                    match self.line.ahead(p, q) {
                        0 => 0.0,
                        1 => t.max(f64::MIN_POSITIVE),
                        _ => t.min(-f64::MIN_POSITIVE),
                    }
                };
                let cut = if self.is_edge(triangle, part) { 0 } else { self.tree.face(triangle) + 1 };
                let along = if is_swapped { 1.0 - along } else { along };
                Touched { key: (corners[i], corners[j], cut), part, t, along }
            }
            Part::Corner(i) => {
                Touched { key: (corners[i], corners[i], 0), part, t: level(places[i]), along: 0.0 }
            }
            // Not asked for.
            Part::Inside => Touched { key: (0, 0, 0), part, t: 0.0, along: 0.0 },
        }
    }

    fn is_edge(&self, triangle: u32, part: Part) -> bool {
        matches!(part, Part::Edge(i) if self.tree.is_edge(triangle, i))
    }
}

/// Times the square of the largest coordinate: more than the rounding error of a side.
const SIDE_ERROR: f64 = 128.0 * f64::EPSILON / 2.0;
/// More than what is lost below the smallest numbers.
const TINIEST: f64 = 1e-290;
