//! What in a tree of triangles is nearest to a point.

use super::bvh::{Frame, Node, Tree, WIDTH, not_above, rounded_down, rounded_up};
use super::cast::Part;
use glam::DVec3;
use smallvec::SmallVec;

/// Points farther than this are as good as at infinity: brought nearer on a straight line to the mesh's center.
const FARTHEST: f64 = f64::from_bits((1023 + 300) << 52);
/// Where single precision would no longer tell boxes apart, in lengths of the mesh.
const FAR: f64 = 1024.0;

/// A point made ready for a tree.
#[derive(Clone, Debug)]
pub(crate) struct Probe<'t> {
    tree: &'t Tree,
    /// Scaled as the tree is.
    pub(crate) point: DVec3,
    /// About the tree's center.
    from_center: DVec3,
    /// The same in single precision, rounded down and up by more than what the center cost.
    low: [f32; 3],
    high: [f32; 3],
    is_far: bool,
}

impl<'t> Probe<'t> {
    /// Makes a finite point ready.
    pub(crate) fn new(tree: &'t Tree, point: DVec3) -> Self {
        let largest = point.abs().max_element();
        let scaled =
            if largest * tree.scale > FARTHEST { point * (FARTHEST / largest) } else { point * tree.scale };
        let from_center = scaled - tree.center;
        let pad = (scaled.abs() + tree.center.abs()) * (2.0 * f64::EPSILON);
        let low = (from_center - pad).to_array().map(rounded_down);
        let high = (from_center + pad).to_array().map(rounded_up);
        Self { tree, point: scaled, from_center, low, high, is_far: largest * tree.scale > FAR }
    }

    /// Shows `leaf` the triangles of all boxes that are not farther than a squared distance, which `leaf` returns anew
    /// each time; roughly the nearest first.
    #[inline]
    pub(crate) fn walk(&self, bound: f64, mut leaf: impl FnMut(u32) -> f64) {
        let mut limit = bound;
        let mut stack: SmallVec<[(f32, u32, Frame); 64]> = SmallVec::new();
        stack.extend(self.tree.root().map(|(root, frame)| (0.0, root, frame)));
        while let Some((distance, at, frame)) = stack.pop() {
            let mut reach = rounded_up(limit * WIDER);
            if distance > reach {
                continue;
            }
            let node = &self.tree.nodes[at as usize];
            let distances =
                if self.is_far { self.far_distances(node, &frame) } else { self.distances(node, &frame) };
            let mut near = not_above(&distances, &[reach; WIDTH]);
            let bottom = stack.len();
            while near != 0 {
                let i = near.trailing_zeros() as usize % WIDTH;
                near &= near - 1;
                let Some(child) = node.inner(i) else {
                    if distances[i] <= reach {
                        node.leaf(i).for_each(|triangle| limit = leaf(triangle));
                        reach = rounded_up(limit * WIDER);
                    }
                    continue;
                };
                self.tree.touch(child);
                // The nearest on top.
                let mut j = stack.len();
                stack.push((distances[i], child, frame.of_child(node, i)));
                while j > bottom && stack[j - 1].0 < stack[j].0 {
                    stack.swap(j - 1, j);
                    j -= 1;
                }
            }
        }
    }

    /// Squared distances to the boxes, at most a few half-ulps too large.
    #[inline]
    fn distances(&self, node: &Node, frame: &Frame) -> [f32; WIDTH] {
        let mut squares = [0.0f32; WIDTH];
        for axis in 0..3 {
            let (low, high) = (node.sides(frame, axis), node.sides(frame, axis + 3));
            for i in 0..WIDTH {
                let below = low[i] - self.high[axis];
                let above = self.low[axis] - high[i];
                let gap = if below > above { below } else { above };
                let gap = if gap > 0.0 { gap } else { 0.0 };
                squares[i] += gap * gap;
            }
        }
        squares
    }

    /// The same in double precision, for points so far away that single precision tells nothing.
    #[cold]
    fn far_distances(&self, node: &Node, frame: &Frame) -> [f32; WIDTH] {
        let sides: [[f32; WIDTH]; 6] = std::array::from_fn(|row| node.sides(frame, row));
        std::array::from_fn(|i| {
            let low = DVec3::from_array([0, 1, 2].map(|k| f64::from(sides[k][i])));
            let high = DVec3::from_array([3, 4, 5].map(|k| f64::from(sides[k][i])));
            let gap = (low - self.from_center).max(self.from_center - high).max(DVec3::ZERO);
            // A few ulps less, for what was rounded; infinite beyond single precision, as the limit is.
            rounded_down(gap.length_squared() * (1.0 - 1e-14))
        })
    }
}

/// More than the rounding of a squared distance in single precision.
const WIDER: f64 = 1.000_002;

/// The nearest point of a triangle, seen from a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Foot {
    pub(crate) square: f64,
    pub(crate) weights: [f64; 3],
    pub(crate) part: Part,
}

/// The nearest point to the origin of a segment: the square of its distance, and where it is from the first end to the
/// second. Safe for equal ends.
#[inline]
pub(crate) fn segment_foot(p: DVec3, q: DVec3) -> (f64, f64) {
    let along = q - p;
    let square = along.length_squared();
    let t = if square > 0.0 { (-p.dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
    // Exactly the ends at the ends.
    match t {
        0.0 => (p.length_squared(), 0.0),
        1.0 => (q.length_squared(), 1.0),
        t => ((p + along * t).length_squared(), t),
    }
}

/// The nearest point to the origin of a triangle, or `None` if it is certainly not within the squared distance `bound`.
/// `order` are the corners' numbers: equal edges of two triangles give equal answers.
///
/// By the regions of the plane (Ericson, "Real-Time Collision Detection", 2005, 5.1.5); triangles that are nearly a line
/// by their edges.
#[inline]
pub(crate) fn triangle_foot(places: [DVec3; 3], order: [u32; 3], bound: f64) -> Option<Foot> {
    let [a, b, c] = places;
    let (ab, ac) = (b - a, c - a);
    let normal = ab.cross(ac);
    let (square, longest) = (normal.length_squared(), ab.length_squared().max(ac.length_squared()));
    if square <= longest * longest * NEEDLE {
        return Some(needle_foot(places, order));
    }
    let height = a.dot(normal);
    if height * height > square * (bound * (1.0 + 1e-6) + a.length_squared() * 1e-14) {
        return None;
    }
    let corner = |i: usize| {
        let mut weights = [0.0; 3];
        weights[i] = 1.0;
        Foot { square: places[i].length_squared(), weights, part: Part::Corner(i) }
    };
    let (d1, d2) = (-ab.dot(a), -ac.dot(a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return Some(corner(0));
    }
    let (d3, d4) = (-ab.dot(b), -ac.dot(b));
    if d3 >= 0.0 && d4 <= d3 {
        return Some(corner(1));
    }
    let (d5, d6) = (-ab.dot(c), -ac.dot(c));
    if d6 >= 0.0 && d5 <= d6 {
        return Some(corner(2));
    }
    // Areas by the normal: the products of d1 to d6 would lose their digits far away.
    let (vb, vc) = (normal.dot(ac.cross(a)), normal.dot(a.cross(ab)));
    let va = square - vb - vc;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return Some(edge_foot(places, order, 0));
    }
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return Some(edge_foot(places, order, 1));
    }
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return Some(edge_foot(places, order, 2));
    }
    let (v, w) = (vb / square, vc / square);
    let foot = a + ab * v + ac * w;
    Some(Foot { square: foot.length_squared(), weights: [1.0 - v - w, v, w], part: Part::Inside })
}

/// The square of the sine below which a corner is taken for none.
const NEEDLE: f64 = 1e-16;

/// The nearest point on the edge from a corner to the next.
fn edge_foot(places: [DVec3; 3], order: [u32; 3], i: usize) -> Foot {
    let j = (i + 1) % 3;
    let is_swapped = order[i] > order[j];
    let (p, q) = if is_swapped { (j, i) } else { (i, j) };
    let (square, along) = segment_foot(places[p], places[q]);
    let mut weights = [0.0; 3];
    (weights[p], weights[q]) = (1.0 - along, along);
    let part = match along {
        0.0 => Part::Corner(p),
        1.0 => Part::Corner(q),
        _ => Part::Edge(i),
    };
    Foot { square, weights, part }
}

/// The nearest point of a triangle that is nearly a line, or a point: on its edges, to rounding.
#[cold]
fn needle_foot(places: [DVec3; 3], order: [u32; 3]) -> Foot {
    let [first, second, third] = [0, 1, 2].map(|i| edge_foot(places, order, i));
    let nearer = |a: Foot, b: Foot| if b.square < a.square { b } else { a };
    nearer(nearer(first, second), third)
}
