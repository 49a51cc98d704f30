//! A tree of boxes over triangles, eight to a node.
//!
//! The boxes are single precision about the middle of all, rounded outward: eight fit three cache lines and one pass of
//! vector instructions. They only ever rule out; what is hit or nearest is decided on the triangles in f64. The tree is
//! grown from the top by the surface area heuristic over bins (Wald, "On fast Construction of SAH-based Bounding Volume
//! Hierarchies", 2007), always splitting the child of largest area until a node is full (Wald, Benthin and Boulos,
//! "Getting Rid of Packets", 2008).

use super::exact::rounded;
use crate::geometry::measure::Aabb;
use crate::geometry::unit_scale;
use crate::matching::NONE;
use crate::{Cancelled, Control};
use glam::DVec3;
use smallvec::SmallVec;

/// Children of a node.
pub(crate) const WIDTH: usize = 8;
/// The most triangles of a leaf; fewer where a node has room.
const LEAF: usize = 4;
/// Below this depth splits halve the count, so that no input makes the tree deep.
const BALANCED_BELOW: u32 = 40;
const BINS: usize = 16;
/// A child's count that says it is a node.
pub(crate) const INNER: u8 = u8::MAX;
/// In a triangle's corner: the edge from it to the next corner is no edge of the face, but a cut through it.
pub(crate) const CUT: u32 = 1 << 31;

/// Triangles, their points, and the boxes around them. Lengths are scaled by a power of two that brings the largest
/// coordinate to about one.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tree {
    pub(crate) nodes: Vec<Node>,
    /// Corners as indices of `points`, with [`CUT`]; those of a leaf lie together.
    triangles: Vec<[u32; 3]>,
    /// The face each triangle belongs to, by the caller's number.
    pub(crate) faces: Vec<u32>,
    /// Scaled and on the grid of [`rounded`], in the order in which triangles name them.
    pub(crate) points: Vec<DVec3>,
    /// The caller's number of each point.
    pub(crate) vertices: Vec<u32>,
    pub(crate) scale: f64,
    /// What the boxes are relative to, scaled.
    pub(crate) center: DVec3,
    /// No point is farther from the center, scaled.
    pub(crate) radius: f64,
}

/// Up to eight boxes with what is in them. The boxes lie on a grid of the node's own, whose lines are exact in single
/// precision (Ylitie, Karras and Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", 2017).
#[derive(Clone, Debug)]
pub(crate) struct Node {
    /// Line 0 of the grid, a multiple of the step.
    pub(crate) origin: [f32; 3],
    /// From one line to the next: a power of two.
    pub(crate) step: [f32; 3],
    /// Lowest x, y, z, then highest x, y, z, of each child.
    pub(crate) lines: [[u8; WIDTH]; 6],
    /// How many triangles, or [`INNER`]; nothing where there is no child.
    pub(crate) count: [u8; WIDTH],
    /// A node, or the first triangle.
    pub(crate) child: [u32; WIDTH],
}

impl Node {
    /// A node of boxes, with no children yet.
    fn around(boxes: &[(usize, usize, Bounds)]) -> Self {
        let mut all = Bounds::EMPTY;
        boxes.iter().for_each(|b| all.add(&b.2.low, &b.2.high));
        let lines = [[u8::MAX; WIDTH], [0; WIDTH]];
        let mut node = Self {
            origin: [0.0; 3],
            step: [0.0; 3],
            lines: [lines[0], lines[0], lines[0], lines[1], lines[1], lines[1]],
            count: [0; WIDTH],
            child: [0; WIDTH],
        };
        for axis in 0..3 {
            let [low, high] = [all.low[axis], all.high[axis]].map(f64::from);
            // At most 254 steps, and the origin at most 2^22 of them away.
            let least = ((high - low) / 254.0).max(low.abs().max(high.abs()) * FINEST).max(SMALLEST);
            let step = f64::from_bits(((least.to_bits() >> 52) + 1) << 52);
            let origin = (low / step).floor() * step;
            (node.origin[axis], node.step[axis]) = (origin as f32, step as f32);
            for (i, (_, _, bounds)) in boxes.iter().enumerate() {
                node.lines[axis][i] = ((f64::from(bounds.low[axis]) - origin) / step).floor() as u8;
                node.lines[axis + 3][i] = ((f64::from(bounds.high[axis]) - origin) / step).ceil() as u8;
            }
        }
        node
    }

    /// Where a side of each child's box is: 0, 1, 2 are the low sides, 3, 4, 5 the high ones.
    #[inline(always)]
    pub(crate) fn sides(&self, row: usize) -> [f32; WIDTH] {
        let (origin, step) = (self.origin[row % 3], self.step[row % 3]);
        self.lines[row].map(|line| origin + f32::from(line) * step)
    }
}

/// The grid's step relative to the largest coordinate, and at all, at least.
const FINEST: f64 = 1.0 / (1 << 22) as f64;
const SMALLEST: f64 = f64::from_bits((1023 - 120) << 52);

impl Tree {
    /// The tree over triangles (corners into `positions`, perhaps with [`CUT`]) of the given faces. O(n log n).
    pub(crate) fn new(positions: &[DVec3], triangles: &[[u32; 3]], faces: &[u32]) -> Self {
        Self::new_with(positions, triangles, faces, Control::none()).unwrap_or_default()
    }

    /// The same with a hook.
    pub(crate) fn new_with(
        positions: &[DVec3],
        triangles: &[[u32; 3]],
        faces: &[u32],
        mut control: Control<'_>,
    ) -> Result<Self, Cancelled> {
        let used = || triangles.iter().flatten().map(|&v| positions[(v & !CUT) as usize]);
        let scale = unit_scale(used());
        let bounds = Aabb::around(used().map(|p| p * scale));
        let center = bounds.map_or(DVec3::ZERO, |b| b.center());
        let radius = bounds.map_or(0.0, |b| (b.max - b.min).length() * (0.5 + 1e-9));
        let boxed = |(i, t): (usize, &[u32; 3])| {
            let [a, b, c] = t.map(|v| positions[(v & !CUT) as usize] * scale - center);
            let (low, high) = (a.min(b).min(c), a.max(b).max(c));
            Primitive {
                low: low.to_array().map(|x| rounded_down(x - SLOP)),
                high: high.to_array().map(|x| rounded_up(x + SLOP)),
                triangle: i as u32,
            }
        };
        let mut primitives: Vec<Primitive> = triangles.iter().enumerate().map(boxed).collect();
        let mut nodes = Vec::new();
        if !primitives.is_empty() {
            grow_with(
                &mut primitives,
                0,
                0,
                &mut nodes,
                &mut Reports { control: &mut control, of: triangles.len() },
            )?;
        }

        let order = primitives.iter().map(|p| p.triangle as usize);
        Ok(Self {
            nodes,
            center,
            radius,
            ..Self::flat(positions, order.map(|i| (triangles[i], faces[i])), scale)
        })
    }

    /// Triangles and faces in the order given, without boxes: no walk finds them.
    pub(crate) fn flat(
        positions: &[DVec3],
        triangles: impl ExactSizeIterator<Item = ([u32; 3], u32)>,
        scale: f64,
    ) -> Self {
        let mut number = vec![NONE; positions.len()];
        let mut tree = Self {
            nodes: vec![],
            triangles: Vec::with_capacity(triangles.len()),
            faces: Vec::with_capacity(triangles.len()),
            points: vec![],
            vertices: vec![],
            scale,
            center: DVec3::ZERO,
            radius: 0.0,
        };
        for (corners, face) in triangles {
            let corners = corners.map(|v| {
                let of = &mut number[(v & !CUT) as usize];
                if *of == NONE {
                    *of = tree.points.len() as u32;
                    tree.points.push(rounded(positions[(v & !CUT) as usize] * scale));
                    tree.vertices.push(v & !CUT);
                }
                *of | v & CUT
            });
            tree.triangles.push(corners);
            tree.faces.push(face);
        }
        tree.points.shrink_to_fit();
        tree.vertices.shrink_to_fit();
        tree
    }

    /// The corners of a triangle, as indices of points.
    pub(crate) fn corners(&self, triangle: u32) -> [u32; 3] {
        self.triangles[triangle as usize].map(|v| v & !CUT)
    }

    /// Whether the edge from a corner to the next is an edge of the face.
    pub(crate) fn is_edge(&self, triangle: u32, corner: usize) -> bool {
        self.triangles[triangle as usize][corner] & CUT == 0
    }

    /// The corners' positions, scaled.
    #[inline]
    pub(crate) fn places(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|v| self.points[(v & !CUT) as usize])
    }

    /// A box in the terms of the nodes': whatever meets it meets their boxes.
    pub(crate) fn boxed(&self, low: DVec3, high: DVec3) -> ([f32; 3], [f32; 3]) {
        let [low, high] = [low, high].map(|p| (p - self.center).to_array());
        (low.map(|x| rounded_down(x - SLOP)), high.map(|x| rounded_up(x + SLOP)))
    }

    pub(crate) fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Heap bytes held.
    pub(crate) fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>()
            + self.triangles.capacity() * 12
            + (self.faces.capacity() + self.vertices.capacity()) * 4
            + self.points.capacity() * size_of::<DVec3>()
    }
}

/// More than subtracting the center rounds off, coordinates being below two.
const SLOP: f64 = 8.0 * f64::EPSILON;

/// The next number of single precision that is not above `x`.
pub(crate) fn rounded_down(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) > x { near.next_down() } else { near }
}

/// The next number of single precision that is not below `x`.
pub(crate) fn rounded_up(x: f64) -> f32 {
    -rounded_down(-x)
}

#[derive(Clone, Copy)]
struct Primitive {
    low: [f32; 3],
    high: [f32; 3],
    triangle: u32,
}

#[derive(Clone, Copy)]
struct Bounds {
    low: [f32; 3],
    high: [f32; 3],
}

impl Bounds {
    const EMPTY: Self = Self { low: [f32::INFINITY; 3], high: [f32::NEG_INFINITY; 3] };

    #[inline]
    fn add(&mut self, low: &[f32; 3], high: &[f32; 3]) {
        for i in 0..3 {
            self.low[i] = if low[i] < self.low[i] { low[i] } else { self.low[i] };
            self.high[i] = if high[i] > self.high[i] { high[i] } else { self.high[i] };
        }
    }

    fn of(primitives: &[Primitive]) -> Self {
        let mut all = Self::EMPTY;
        primitives.iter().for_each(|p| all.add(&p.low, &p.high));
        all
    }

    fn half_area(&self) -> f32 {
        let [x, y, z] = [0, 1, 2].map(|i| (self.high[i] - self.low[i]).max(0.0));
        x * y + y * z + z * x
    }
}

#[cfg(feature = "rayon")]
/// The nodes over primitives, the root first; `first` is the number of the first of them in the whole order.
fn grow(primitives: &mut [Primitive], first: u32, depth: u32) -> Vec<Node> {
    let mut nodes = Vec::new();
    grow_into(primitives, first, depth, &mut nodes);
    nodes
}

/// The hook of a tree that grows, and over how many primitives.
struct Reports<'c, 'a> {
    control: &'c mut Control<'a>,
    of: usize,
}

/// Between two reports, about.
const ROUND: usize = 1 << 18;

/// [`grow_into`], from the calling thread down to where a report is due.
fn grow_with(
    primitives: &mut [Primitive],
    first: u32,
    depth: u32,
    nodes: &mut Vec<Node>,
    reports: &mut Reports<'_, '_>,
) -> Result<(), Cancelled> {
    reports.control.report("index", f64::from(first) / reports.of as f64)?;
    if primitives.len() <= ROUND {
        grow_into(primitives, first, depth, nodes);
        return Ok(());
    }
    let parts = parts(primitives, depth);
    let here = nodes.len();
    nodes.push(node(&parts, first));
    for (i, &(start, end, _)) in parts.iter().enumerate().filter(|(_, p)| p.1 - p.0 > LEAF) {
        nodes[here].child[i] = nodes.len() as u32;
        grow_with(&mut primitives[start..end], first + start as u32, depth + 1, nodes, reports)?;
    }
    Ok(())
}

type Parts = SmallVec<[(usize, usize, Bounds); WIDTH]>;

/// Orders primitives into the children of a node: ranges with their bounds.
fn parts(primitives: &mut [Primitive], depth: u32) -> Parts {
    let mut parts = Parts::new();
    parts.push((0, primitives.len(), Bounds::of(primitives)));
    // The widest of those too large for a leaf, then of all: a node is full unless triangles run out.
    for most in [LEAF, 1] {
        while parts.len() < WIDTH {
            let large = parts.iter().enumerate().filter(|(_, p)| p.1 - p.0 > most);
            let area = |p: &(usize, &(usize, usize, Bounds))| p.1.2.half_area();
            let Some((i, &(start, end, _))) = large.max_by(|a, b| area(a).total_cmp(&area(b))) else { break };
            let middle = start + split(&mut primitives[start..end], depth > BALANCED_BELOW);
            parts[i] = (start, middle, Bounds::of(&primitives[start..middle]));
            parts.insert(i + 1, (middle, end, Bounds::of(&primitives[middle..end])));
        }
    }
    parts
}

/// The node over these parts; children that are nodes are yet to be linked.
fn node(parts: &Parts, first: u32) -> Node {
    let mut node = Node::around(parts);
    for (i, (start, end, _)) in parts.iter().enumerate() {
        let count = end - start;
        (node.child[i], node.count[i]) =
            if count > LEAF { (0, INNER) } else { (first + *start as u32, count as u8) };
    }
    node
}

fn grow_into(primitives: &mut [Primitive], first: u32, depth: u32, nodes: &mut Vec<Node>) {
    let parts = parts(primitives, depth);
    let here = nodes.len();
    nodes.push(node(&parts, first));
    let is_inner = |p: &(usize, usize, Bounds)| p.1 - p.0 > LEAF;
    #[cfg(feature = "rayon")]
    if primitives.len() > 1 << 15 {
        use rayon::prelude::*;
        let mut rest = primitives;
        let mut ranges = Vec::new();
        for part in &parts {
            let (own, after) = rest.split_at_mut(part.1 - part.0);
            rest = after;
            ranges.push((own, first + part.0 as u32));
        }
        let below: Vec<Vec<Node>> = ranges
            .into_par_iter()
            .map(|(own, first)| if own.len() > LEAF { grow(own, first, depth + 1) } else { vec![] })
            .collect();
        for (i, mut below) in below.into_iter().enumerate().filter(|b| !b.1.is_empty()) {
            let offset = nodes.len() as u32;
            nodes[here].child[i] = offset;
            for node in &mut below {
                for (child, _) in node.child.iter_mut().zip(node.count).filter(|c| c.1 == INNER) {
                    *child += offset;
                }
            }
            nodes.append(&mut below);
        }
        return;
    }
    for (i, &(start, end, _)) in parts.iter().enumerate().filter(|(_, p)| is_inner(p)) {
        nodes[here].child[i] = nodes.len() as u32;
        grow_into(&mut primitives[start..end], first + start as u32, depth + 1, nodes);
    }
}

/// Parts primitives (two at least) in two, and says how many are in the first part.
fn split(primitives: &mut [Primitive], balanced: bool) -> usize {
    let half = primitives.len() / 2;
    let mut middles = Bounds::EMPTY;
    for p in primitives.iter() {
        let twice = [0, 1, 2].map(|i| p.low[i] + p.high[i]);
        middles.add(&twice, &twice);
    }
    let extent = [0, 1, 2].map(|i| middles.high[i] - middles.low[i]);
    if balanced {
        let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
        let key = |p: &Primitive| p.low[axis] + p.high[axis];
        primitives
            .select_nth_unstable_by(half, |a, b| key(a).total_cmp(&key(b)).then(a.triangle.cmp(&b.triangle)));
        return half;
    }
    let per_unit = extent.map(|e| if e > 0.0 { BINS as f32 / e } else { 0.0 });
    let bin = |p: &Primitive, axis: usize| {
        let at = (p.low[axis] + p.high[axis] - middles.low[axis]) * per_unit[axis];
        (at as usize).min(BINS - 1)
    };
    let mut bins = [[(0u32, Bounds::EMPTY); BINS]; 3];
    for p in primitives.iter() {
        for (axis, bins) in bins.iter_mut().enumerate() {
            let (count, bounds) = &mut bins[bin(p, axis)];
            *count += 1;
            bounds.add(&p.low, &p.high);
        }
    }
    // Cost, axis, first bin of the right part.
    let mut best: Option<(f32, usize, usize)> = None;
    for (axis, bins) in bins.iter().enumerate().filter(|&(axis, _)| extent[axis] > 0.0) {
        let mut right = [0.0f32; BINS];
        let (mut count, mut bounds) = (0, Bounds::EMPTY);
        for i in (1..BINS).rev() {
            count += bins[i].0;
            bounds.add(&bins[i].1.low, &bins[i].1.high);
            right[i] = if count == 0 { f32::NAN } else { bounds.half_area() * count as f32 };
        }
        let (mut count, mut bounds) = (0, Bounds::EMPTY);
        for i in 1..BINS {
            count += bins[i - 1].0;
            bounds.add(&bins[i - 1].1.low, &bins[i - 1].1.high);
            let cost = bounds.half_area() * count as f32 + right[i];
            // Not a number where nothing is to the right.
            if count > 0 && cost < best.map_or(f32::INFINITY, |b| b.0) {
                best = Some((cost, axis, i));
            }
        }
    }
    let Some((_, axis, at)) = best else { return half };
    let mut left = 0;
    for i in 0..primitives.len() {
        if bin(&primitives[i], axis) < at {
            primitives.swap(i, left);
            left += 1;
        }
    }
    if left == 0 || left == primitives.len() { half } else { left }
}
