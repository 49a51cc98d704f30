//! Growing a tree of boxes.
//!
//! From the top by the surface area heuristic over bins (Wald, "On fast Construction of SAH-based Bounding Volume
//! Hierarchies", 2007), always splitting the child of largest area until a node is full (Wald, Benthin and Boulos,
//! "Getting Rid of Packets", 2008).

use super::bvh::{Frame, LEAF, Node, WIDTH};
use crate::{Cancelled, Control};
use glam::Vec4;
use smallvec::SmallVec;
use std::ops::Range;

/// Below this depth splits halve the count, so that no input makes the tree deep.
const BALANCED_BELOW: u32 = 40;
/// A power of two.
const BINS: usize = 16;
/// So few are sorted instead of binned.
const FEW: usize = 8;
/// Between two reports, about.
const ROUND: usize = 1 << 18;

/// A triangle's box; in the fourth components the lower and the upper half of the triangle's number.
#[derive(Clone, Copy)]
pub(super) struct Primitive {
    low: Vec4,
    high: Vec4,
}

impl Primitive {
    pub(super) fn new(low: [f32; 3], high: [f32; 3], triangle: u32) -> Self {
        let with = |[x, y, z]: [f32; 3], half: u32| Vec4::new(x, y, z, half as f32);
        Self { low: with(low, triangle & 0xffff), high: with(high, triangle >> 16) }
    }

    fn triangle(&self) -> u32 {
        self.low.w as u32 | (self.high.w as u32) << 16
    }

    /// Twice the middle of the box.
    fn middle(&self) -> Vec4 {
        self.low + self.high
    }
}

/// A box; the fourth components mean nothing.
#[derive(Clone, Copy)]
pub(super) struct Bounds {
    low: Vec4,
    high: Vec4,
}

impl Bounds {
    const EMPTY: Self = Self { low: Vec4::INFINITY, high: Vec4::NEG_INFINITY };

    #[inline(always)]
    fn add(&mut self, low: Vec4, high: Vec4) {
        (self.low, self.high) = (self.low.min(low), self.high.max(high));
    }

    pub(super) fn of(primitives: &[Primitive]) -> Self {
        let mut all = Self::EMPTY;
        primitives.iter().for_each(|p| all.add(p.low, p.high));
        all
    }

    pub(super) fn low(&self) -> [f32; 3] {
        self.low.truncate().to_array()
    }

    pub(super) fn high(&self) -> [f32; 3] {
        self.high.truncate().to_array()
    }

    #[inline(always)]
    fn half_area(&self) -> f32 {
        let [x, y, z, _] = (self.high - self.low).max(Vec4::ZERO).to_array();
        x * y + y * z + z * x
    }
}

/// The nodes over primitives within the root's frame, the root first, and the order of the triangles in their leaves.
pub(super) fn grown(
    primitives: &mut [Primitive],
    frame: Frame,
    control: &mut Control<'_>,
) -> Result<(Vec<Node>, Vec<u32>), Cancelled> {
    let mut order = vec![0; primitives.len()];
    let mut nodes = vec![Node::EMPTY];
    let whole = Twig { primitives, order: &mut order, first: 0, depth: 0, frame, at: 0 };
    let of = whole.primitives.len();
    grow_with(whole, &mut nodes, &mut |done| control.report("index", f64::from(done) / of as f64))?;
    nodes.shrink_to_fit();
    Ok((nodes, order))
}

/// A node that is yet to be made.
struct Twig<'p> {
    primitives: &'p mut [Primitive],
    /// Where to write the numbers of their triangles.
    order: &'p mut [u32],
    /// The number of the first of these in the whole order.
    first: u32,
    depth: u32,
    frame: Frame,
    /// Which node it is.
    at: usize,
}

impl<'p> Twig<'p> {
    /// Makes the node, and what is to grow on it.
    fn node(self, nodes: &mut Vec<Node>) -> SmallVec<[Self; WIDTH]> {
        let Self { primitives, mut order, first, depth, frame, at } = self;
        let parts = parts(primitives, depth);
        let mut node = Node::new(&parts, &frame, first, nodes.len());
        // The triangles of leaves before those of inner nodes.
        let mut after = first;
        for (range, _) in parts.iter().filter(|p| p.0.len() <= LEAF) {
            let (own, rest) = order.split_at_mut(range.len());
            order = rest;
            own.iter_mut().zip(&primitives[range.clone()]).for_each(|(at, p)| *at = p.triangle());
            after += range.len() as u32;
        }
        let mut twigs = SmallVec::new();
        let (mut rest, mut passed) = (primitives, 0);
        for (i, (range, _)) in parts.iter().enumerate().filter(|(_, p)| p.0.len() > LEAF) {
            let (own, behind) = rest.split_at_mut(range.end - passed);
            let primitives = &mut own[range.start - passed..];
            let (own, left) = order.split_at_mut(range.len());
            let frame = frame.of_child(&node, i);
            twigs.push(Self {
                primitives,
                order: own,
                first: after,
                depth: depth + 1,
                frame,
                at: nodes.len(),
            });
            nodes.push(Node::EMPTY);
            (rest, order, passed, after) = (behind, left, range.end, after + range.len() as u32);
        }
        std::mem::swap(&mut nodes[at], &mut node);
        twigs
    }
}

/// [`grow`], from the calling thread down to where a report is due.
fn grow_with(
    twig: Twig<'_>,
    nodes: &mut Vec<Node>,
    report: &mut impl FnMut(u32) -> Result<(), Cancelled>,
) -> Result<(), Cancelled> {
    report(twig.first)?;
    if twig.primitives.len() <= ROUND {
        grow(twig, nodes);
        return Ok(());
    }
    twig.node(nodes).into_iter().try_for_each(|twig| grow_with(twig, nodes, report))
}

fn grow(twig: Twig<'_>, nodes: &mut Vec<Node>) {
    #[cfg(feature = "rayon")]
    if twig.primitives.len() > 1 << 15 {
        use rayon::prelude::*;
        let grown = |mut twig: Twig<'_>| {
            let (at, mut below) = (std::mem::take(&mut twig.at), vec![Node::EMPTY]);
            grow(twig, &mut below);
            (at, below)
        };
        let twigs: Vec<Twig<'_>> = twig.node(nodes).into_iter().collect();
        let all: Vec<(usize, Vec<Node>)> = twigs.into_par_iter().map(grown).collect();
        for (at, mut below) in all {
            // The first is at its place already; the others follow.
            below.iter_mut().for_each(|node| node.nodes += nodes.len() as u32 - 1);
            nodes[at] = below[0];
            nodes.extend(&below[1..]);
        }
        return;
    }
    twig.node(nodes).into_iter().for_each(|twig| grow(twig, nodes));
}

type Parts = SmallVec<[(Range<usize>, Bounds); WIDTH]>;

/// Orders primitives into the children of a node: ranges with their bounds.
fn parts(primitives: &mut [Primitive], depth: u32) -> Parts {
    let mut parts = Parts::new();
    if primitives.len() <= WIDTH {
        parts.extend(
            primitives.iter().enumerate().map(|(i, p)| (i..i + 1, Bounds { low: p.low, high: p.high })),
        );
        return parts;
    }
    parts.push((0..primitives.len(), Bounds::of(primitives)));
    // The widest of those too large for a leaf, then of all: a node is full unless triangles run out.
    for most in [LEAF, 1] {
        while parts.len() < WIDTH {
            let large = parts.iter().enumerate().filter(|(_, p)| p.0.len() > most);
            let widest = large.max_by(|a, b| a.1.1.half_area().total_cmp(&b.1.1.half_area()));
            let Some((i, (range, _))) = widest else { break };
            let range = range.clone();
            let (count, left, right) = split(&mut primitives[range.clone()], depth > BALANCED_BELOW);
            let middle = range.start + count;
            parts[i] = (range.start..middle, left);
            parts.insert(i + 1, (middle..range.end, right));
        }
    }
    parts
}

/// Parts primitives (two at least) in two, and says how many are in the first part, and the bounds of both.
fn split(primitives: &mut [Primitive], balanced: bool) -> (usize, Bounds, Bounds) {
    let mut middles = Bounds::EMPTY;
    primitives.iter().for_each(|p| middles.add(p.middle(), p.middle()));
    let extent = (middles.high - middles.low).to_array();
    let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
    let count = if balanced {
        None
    } else if primitives.len() <= FEW {
        return sorted_split(primitives, axis);
    } else {
        match binned_split(primitives, &middles) {
            Some(all) => return all,
            None => Some(primitives.len() / 2),
        }
    };
    let count = count.unwrap_or_else(|| {
        let key = |p: &Primitive| p.middle()[axis];
        let order =
            |a: &Primitive, b: &Primitive| key(a).total_cmp(&key(b)).then(a.triangle().cmp(&b.triangle()));
        primitives.select_nth_unstable_by(primitives.len() / 2, order);
        primitives.len() / 2
    });
    (count, Bounds::of(&primitives[..count]), Bounds::of(&primitives[count..]))
}

/// Few primitives, sorted along an axis and parted where it is best.
fn sorted_split(primitives: &mut [Primitive], axis: usize) -> (usize, Bounds, Bounds) {
    let count = primitives.len();
    for i in 1..count {
        let mut j = i;
        while j > 0 && primitives[j].middle()[axis] < primitives[j - 1].middle()[axis] {
            primitives.swap(j - 1, j);
            j -= 1;
        }
    }
    let mut rights = [Bounds::EMPTY; FEW];
    let mut right = Bounds::EMPTY;
    for i in (1..count).rev() {
        right.add(primitives[i].low, primitives[i].high);
        rights[i] = right;
    }
    let (mut left, mut best) = (Bounds::EMPTY, (f32::INFINITY, 1, Bounds::EMPTY));
    for i in 1..count {
        left.add(primitives[i - 1].low, primitives[i - 1].high);
        let cost = left.half_area() * i as f32 + rights[i].half_area() * (count - i) as f32;
        if cost < best.0 || i == 1 {
            best = (cost, i, left);
        }
    }
    (best.1, best.2, rights[best.1])
}

/// Primitives parted between two bins of one axis; `None` if all middles are the same.
fn binned_split(primitives: &mut [Primitive], middles: &Bounds) -> Option<(usize, Bounds, Bounds)> {
    let used = if primitives.len() <= 4 * BINS { BINS / 2 } else { BINS };
    let per_unit =
        (middles.high - middles.low).map(|e| if e > 0.0 { used as f32 * 0.999_999 / e } else { 0.0 });
    // Rounded to the nearest, there being no fractions in single precision from there on: the last bits are the bin.
    let bins_of = |p: &Primitive| {
        let at = (p.middle() - middles.low) * per_unit - Vec4::splat(0.5) + Vec4::splat(WHOLE);
        at.to_array().map(|x| x.to_bits() as usize % BINS)
    };
    let mut bins = [[Bounds::EMPTY; BINS]; 3];
    let mut counts = [[0u32; BINS]; 3];
    for p in primitives.iter() {
        let at = bins_of(p);
        for axis in 0..3 {
            bins[axis][at[axis]].add(p.low, p.high);
            counts[axis][at[axis]] += 1;
        }
    }
    // Cost, axis, first bin of the right part, its count, the bounds of both.
    let mut best = (f32::INFINITY, 0, 0, 0, Bounds::EMPTY, Bounds::EMPTY);
    for axis in 0..3 {
        let (bins, counts) = (&bins[axis], &counts[axis]);
        let mut rights = [(0, Bounds::EMPTY); BINS];
        let (mut count, mut right) = (0, Bounds::EMPTY);
        for i in (1..used).rev() {
            right.add(bins[i].low, bins[i].high);
            count += counts[i];
            rights[i] = (count, right);
        }
        let (mut count, mut left) = (0, Bounds::EMPTY);
        for i in 1..used {
            left.add(bins[i - 1].low, bins[i - 1].high);
            count += counts[i - 1];
            let (others, right) = &rights[i];
            if count == 0 || *others == 0 {
                continue;
            }
            let cost = left.half_area() * count as f32 + right.half_area() * *others as f32;
            if cost < best.0 {
                best = (cost, axis, i, count as usize, left, *right);
            }
        }
    }
    let (_, axis, at, count, left, right) = best;
    if count == 0 {
        return None;
    }
    let mut next = 0;
    for i in 0..primitives.len() {
        let is_left = bins_of(&primitives[i])[axis] < at;
        // Without a branch: what is swapped for nothing belongs to the right.
        primitives.swap(i, next);
        next += usize::from(is_left);
    }
    Some((count, left, right))
}

/// One and a half times 2^23.
const WHOLE: f32 = 12_582_912.0;
