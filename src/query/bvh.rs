//! A tree of boxes over triangles, eight to a node.
//!
//! The boxes are single precision about the middle of all, rounded outward: eight and what is in them fit one cache line,
//! because a node's grid follows from its parent's (Ylitie, Karras and Laine, "Efficient Incoherent Ray Traversal on GPUs
//! Through Compressed Wide BVHs", 2017, store it). They only ever rule out; what is hit or nearest is decided on the
//! triangles in f64. [`grow`](super::grow) makes the tree.

use super::exact::rounded;
use super::grow::{Bounds, Primitive, grown};
use crate::geometry::measure::Aabb;
use crate::geometry::unit_scale;
use crate::{Cancelled, Control};
use glam::{DVec3, Vec4};
use std::ops::Range;

/// Children of a node.
pub(crate) const WIDTH: usize = 8;
/// The most triangles of a leaf; fewer where a node has room.
pub(crate) const LEAF: usize = 4;
/// In the lowest three bits of a child's kind: it is a node.
const INNER: u8 = 7;
/// In a triangle's corner: the edge from it to the next corner is no edge of the face, but a cut through it.
pub(crate) const CUT: u32 = 1 << 31;

/// Triangles, their points, and the boxes around them. Lengths are scaled by a power of two that brings the largest
/// coordinate to about one.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tree {
    /// The root first; the children of a node lie together.
    pub(crate) nodes: Vec<Node>,
    /// The root's grid.
    root: Frame,
    /// Those of a leaf lie together.
    triangles: Vec<Triangle>,
    pub(crate) scale: f64,
    /// What the boxes are relative to, scaled.
    pub(crate) center: DVec3,
    /// No point is farther from the center, scaled.
    pub(crate) radius: f64,
}

/// All that is asked of a triangle, in one place, because each is one of millions and seldom in a cache.
#[derive(Clone, Copy, Debug)]
struct Triangle {
    /// The corners, scaled and on the grid of [`rounded`].
    places: [DVec3; 3],
    /// The caller's numbers of the corners, with [`CUT`].
    corners: [u32; 3],
    /// The caller's number of the face it belongs to.
    face: u32,
}

/// The grid on which the boxes in a node lie. All lines are exact in single precision.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Frame {
    /// Line 0, a multiple of the step.
    origin: [f32; 3],
    /// From one line to the next: a power of two, not below `finest`.
    step: [f32; 3],
    finest: f32,
}

impl Frame {
    /// A grid around a box and, within it, the finest there can be.
    pub(crate) fn around(all: &Bounds) -> Self {
        let (low, high) = (all.low(), all.high());
        let power = |least: f64| f64::from_bits(((least.to_bits() >> 52) + 1) << 52);
        let largest = [low, high].into_iter().flatten().fold(0.0, |m: f64, x| m.max(f64::from(x).abs()));
        let finest = power((largest * FINEST).max(SMALLEST));
        let mut frame = Self { finest: finest as f32, ..Self::default() };
        for axis in 0..3 {
            let [low, high] = [low[axis], high[axis]].map(f64::from);
            // At most 254 steps.
            let step = power((high - low) / 254.0).max(finest);
            (frame.origin[axis], frame.step[axis]) = (((low / step).floor() * step) as f32, step as f32);
        }
        frame
    }

    /// The grid in a child: as fine as 255 lines let it be.
    #[inline(always)]
    pub(crate) fn of_child(&self, node: &Node, i: usize) -> Self {
        let mut frame = *self;
        for axis in 0..3 {
            let (low, high) = (node.lines[axis][i], node.lines[axis + 3][i]);
            // Halved as often as twice the width still fits: the exponent less that.
            let halved = self.step[axis].to_bits().saturating_sub((high - low).leading_zeros() << 23);
            frame.origin[axis] = self.origin[axis] + f32::from(low) * self.step[axis];
            frame.step[axis] = f32::from_bits(halved.max(self.finest.to_bits()));
        }
        frame
    }
}

/// The finest step relative to the largest coordinate, and at all, at least.
const FINEST: f64 = 1.0 / (1 << 22) as f64;
const SMALLEST: f64 = f64::from_bits((1023 - 120) << 52);

/// Up to eight boxes with what is in them: a cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Node {
    /// Lowest x, y, z, then highest x, y, z, of each child, as lines of the node's grid.
    lines: [[u8; WIDTH]; 6],
    /// In the lowest three bits how many triangles are in a child, or [`INNER`], or 0: there is no child; above where
    /// they begin after `first`, or which of `nodes` it is.
    kinds: [u8; WIDTH],
    /// The first child that is a node.
    pub(super) nodes: u32,
    /// The first triangle in the leaves.
    first: u32,
}

impl Node {
    /// A node without children.
    pub(crate) const EMPTY: Self = {
        let lines = [[u8::MAX; WIDTH], [0; WIDTH]];
        let lines = [lines[0], lines[0], lines[0], lines[1], lines[1], lines[1]];
        Self { lines, kinds: [0; WIDTH], nodes: 0, first: 0 }
    };

    /// A node of boxes over ranges of triangles, those in leaves from `first` on, and with nodes from `nodes` on.
    pub(super) fn new(parts: &[(Range<usize>, Bounds)], frame: &Frame, first: u32, nodes: usize) -> Self {
        let mut node = Self { nodes: nodes as u32, first, ..Self::EMPTY };
        let (mut inner, mut triangles) = (0u8, 0u8);
        for (i, (range, bounds)) in parts.iter().enumerate() {
            let (low, high) = (bounds.low(), bounds.high());
            for axis in 0..3 {
                // Rounded only where it is divided, by a power of two: not at all.
                let line =
                    |x: f32| (f64::from(x) - f64::from(frame.origin[axis])) / f64::from(frame.step[axis]);
                // A cast rounds down.
                node.lines[axis][i] = line(low[axis]) as u8;
                node.lines[axis + 3][i] = 255 - (255.0 - line(high[axis])) as u8;
            }
            if range.len() > LEAF {
                node.kinds[i] = inner << 3 | INNER;
                inner += 1;
            } else {
                node.kinds[i] = triangles << 3 | range.len() as u8;
                triangles += range.len() as u8;
            }
        }
        node
    }

    /// Where a side of each child's box is: 0, 1, 2 are the low sides, 3, 4, 5 the high ones.
    #[inline(always)]
    pub(crate) fn sides(&self, frame: &Frame, row: usize) -> [f32; WIDTH] {
        let (origin, step) = (frame.origin[row % 3], frame.step[row % 3]);
        self.lines[row].map(|line| origin + f32::from(line) * step)
    }

    /// The children that exist, a bit for each.
    pub(crate) fn children(&self) -> u32 {
        (0..WIDTH).fold(0, |all, i| all | u32::from(self.kinds[i] != 0) << i)
    }

    /// The child, if it is a node.
    #[inline(always)]
    pub(crate) fn inner(&self, i: usize) -> Option<u32> {
        let kind = self.kinds[i];
        (kind & 7 == INNER).then(|| self.nodes + u32::from(kind >> 3))
    }

    /// The triangles of a child that is none.
    #[inline(always)]
    pub(crate) fn leaf(&self, i: usize) -> Range<u32> {
        let kind = self.kinds[i];
        let first = self.first + u32::from(kind >> 3);
        first..first + u32::from(kind & 7)
    }
}

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
            let low = low.to_array().map(|x| rounded_down(x - SLOP));
            Primitive::new(low, high.to_array().map(|x| rounded_up(x + SLOP)), i as u32)
        };
        let mut primitives: Vec<Primitive> = triangles.iter().enumerate().map(boxed).collect();
        let (mut nodes, mut order, mut root) = (vec![], vec![], Frame::default());
        if !primitives.is_empty() {
            root = Frame::around(&Bounds::of(&primitives));
            (nodes, order) = grown(&mut primitives, root, &mut control)?;
        }
        drop(primitives);
        let order = order.into_iter().map(|i| (triangles[i as usize], faces[i as usize]));
        Ok(Self { nodes, root, center, radius, ..Self::flat(positions, order, scale) })
    }

    /// Triangles and faces in the order given, without boxes: no walk finds them.
    pub(crate) fn flat(
        positions: &[DVec3],
        triangles: impl ExactSizeIterator<Item = ([u32; 3], u32)>,
        scale: f64,
    ) -> Self {
        let place = |v: u32| rounded(positions[(v & !CUT) as usize] * scale);
        let whole = |(corners, face): ([u32; 3], u32)| Triangle { places: corners.map(place), corners, face };
        Self { triangles: triangles.map(whole).collect(), scale, ..Self::default() }
    }

    /// The caller's numbers of the corners of a triangle.
    #[inline]
    pub(crate) fn corners(&self, triangle: u32) -> [u32; 3] {
        self.triangles[triangle as usize].corners.map(|v| v & !CUT)
    }

    /// Whether the edge from a corner to the next is an edge of the face.
    #[inline]
    pub(crate) fn is_edge(&self, triangle: u32, corner: usize) -> bool {
        self.triangles[triangle as usize].corners[corner] & CUT == 0
    }

    /// The corners' positions, scaled.
    #[inline]
    pub(crate) fn places(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].places
    }

    /// The caller's number of the face a triangle belongs to.
    #[inline]
    pub(crate) fn face(&self, triangle: u32) -> u32 {
        self.triangles[triangle as usize].face
    }

    /// The faces of all triangles.
    pub(crate) fn faces(&self) -> impl Iterator<Item = u32> + '_ {
        self.triangles.iter().map(|t| t.face)
    }

    /// A box in the terms of the nodes': whatever meets it meets their boxes.
    pub(crate) fn boxed(&self, low: DVec3, high: DVec3) -> ([f32; 3], [f32; 3]) {
        let [low, high] = [low, high].map(|p| (p - self.center).to_array());
        (low.map(|x| rounded_down(x - SLOP)), high.map(|x| rounded_up(x + SLOP)))
    }

    /// The root, if there is one, with its grid.
    #[inline]
    pub(crate) fn root(&self) -> Option<(u32, Frame)> {
        (!self.nodes.is_empty()).then_some((0, self.root))
    }

    /// A number that is close for points close to each other (Morton, "A Computer Oriented Geodetic Data Base", 1966).
    pub(crate) fn point_key(&self, point: DVec3) -> u64 {
        let at = (point * self.scale - self.center) * (512.0 / (2.0 * self.radius));
        // A cast keeps what is far away, and what is no number, at the ends.
        let of = at.to_array().map(|x| ((x + 512.0) as u64).min(1023));
        (0..10).rev().fold(0, |key, bit| of.iter().fold(key, |key, x| key << 1 | x >> bit & 1))
    }

    /// Has a node fetched while others are looked at.
    #[inline(always)]
    pub(crate) fn touch(&self, node: u32) {
        std::hint::black_box(self.nodes[node as usize].kinds[0]);
    }

    /// The same for a triangle.
    #[inline(always)]
    pub(crate) fn touch_triangle(&self, triangle: u32) {
        if let Some(t) = self.triangles.get(triangle as usize) {
            std::hint::black_box(t.places[1].x);
        }
    }

    pub(crate) fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Heap bytes held.
    pub(crate) fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>() + self.triangles.capacity() * size_of::<Triangle>()
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

/// In which lanes the first is not above the second, a bit for each.
#[inline(always)]
pub(crate) fn not_above(a: &[f32; WIDTH], b: &[f32; WIDTH]) -> u32 {
    let half = |i: usize| {
        let four = |of: &[f32; WIDTH]| Vec4::new(of[i], of[i + 1], of[i + 2], of[i + 3]);
        four(a).cmple(four(b)).bitmask()
    };
    half(0) | half(4) << 4
}
