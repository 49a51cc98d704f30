//! Where a surface meets itself.

use super::MeshIndex;
use super::batch::each_piece;
use super::bvh::{Frame, Node, WIDTH};
use super::facet::{Contact, Facet, meet};
use crate::{Cancelled, Control, FaceKey, Mesh};
use glam::DVec3;
use smallvec::SmallVec;
use std::ops::Range;

/// How intersections are looked for and listed.
#[derive(Debug)]
pub struct SelfIntersectionOptions<'a> {
    /// No more than this many pairs are listed, the first in storage order; all are counted. 2^20 by default.
    pub max_listed: usize,
    /// When about this many triangles have been held against each other the search ends, and
    /// [`unsearched`](SelfIntersections::unsearched) is not 0; 2^30 by default. Triangles whose boxes do not meet count little,
    /// and where the search ends does not depend on the number of threads.
    pub max_tests: usize,
    /// The progress-and-cancel hook.
    pub control: Control<'a>,
}

impl Default for SelfIntersectionOptions<'_> {
    fn default() -> Self {
        Self { max_listed: 1 << 20, max_tests: 1 << 30, control: Control::none() }
    }
}

/// Two faces that meet in more than their edges.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct FacePair {
    /// The faces, in storage order.
    pub faces: [FaceKey; 2],
    /// How they meet: where they meet in several ways, the strongest.
    pub contact: Contact,
    /// A point where they do, to rounding.
    pub place: DVec3,
}

/// What [`MeshIndex::self_intersections`] found.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct SelfIntersections {
    /// The pairs in storage order, by the first face, then by the second; no more than asked for.
    pub pairs: Vec<FacePair>,
    /// How many pairs overlap, listed or not.
    pub overlaps: usize,
    /// How many pairs cross.
    pub crossings: usize,
    /// How many pairs only touch.
    pub touches: usize,
    /// How many faces (triangles, of larger ones) were not held against all others, because the search ended: see
    /// [`max_tests`](SelfIntersectionOptions::max_tests).
    pub unsearched: usize,
    /// One of them.
    pub first_unsearched: Option<FaceKey>,
}

impl SelfIntersections {
    /// How many pairs there are, listed or not.
    pub fn count(&self) -> usize {
        self.overlaps + self.crossings + self.touches
    }

    fn add(&mut self, contact: Contact) {
        match contact {
            Contact::Overlap => self.overlaps += 1,
            Contact::Cross => self.crossings += 1,
            Contact::Touch => self.touches += 1,
        }
    }
}

impl Mesh {
    /// [`MeshIndex::self_intersections`], with an index built for it.
    ///
    /// # Errors
    /// [`Cancelled`] when the hook says so.
    pub fn self_intersections(
        &self,
        mut options: SelfIntersectionOptions<'_>,
    ) -> Result<SelfIntersections, Cancelled> {
        let index = self.index_with(options.control.part(0.0, 0.5))?;
        let control = options.control.part(0.5, 1.0);
        index.self_intersections(SelfIntersectionOptions { control, ..options })
    }
}

impl MeshIndex<'_> {
    /// All pairs of faces that meet in more than their edges: that have a point in common which is on the inside of at
    /// least one of them, where the inside of a face is the face without its edges and vertices.
    ///
    /// It is a question about places alone: faces that share a vertex or an edge are asked like any others, and vertices at
    /// the same position are one place. So what only touches along edges or at vertices does not count: shells with a
    /// common edge or vertex, as a split leaves them, a vertex in the middle of an edge, two edges that cross in one point.
    /// Nor does a surface count that goes through another exactly along edges of both. A vertex or an edge that rests on
    /// the inside of a face does count, as [`Touch`](Contact::Touch), and two solids with a common wall do, as
    /// [`Overlap`](Contact::Overlap).
    ///
    /// Polygons are cut into triangles by the rule that volume and export use; a cut is inside its face, and the triangles
    /// of one face are not held against each other. A face without area has edges only; so has a triangle without area,
    /// and a cut next to it counts as an edge.
    ///
    /// Decided exactly, in the limits of the [index](MeshIndex). O(n log n) on surfaces from life, and the number of pairs of
    /// faces whose boxes meet, up to [`max_tests`](SelfIntersectionOptions::max_tests); on several threads with the feature `rayon`.
    ///
    /// # Errors
    /// [`Cancelled`] when the hook says so.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::{DVec3, dvec3}};
    /// use meshwright::{Contact, SelfIntersectionOptions};
    /// // A sheet, and one that stands across it.
    /// let points = vec![DVec3::ZERO, DVec3::X * 4.0, DVec3::Y * 4.0, dvec3(1., 1., -1.), dvec3(1., 1., 1.), dvec3(1., 5., 0.)];
    /// let mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2], [3, 4, 5]])?)?;
    /// let found = mesh.index().self_intersections(SelfIntersectionOptions::default())?;
    /// assert_eq!((found.count(), found.crossings), (1, 1));
    /// assert_eq!(found.pairs[0].contact, Contact::Cross);
    /// assert_eq!(found.pairs[0].faces, [mesh.faces().nth(0).unwrap(), mesh.faces().nth(1).unwrap()]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn self_intersections(
        &self,
        options: SelfIntersectionOptions<'_>,
    ) -> Result<SelfIntersections, Cancelled> {
        let SelfIntersectionOptions { max_listed, max_tests, mut control } = options;
        let mut left = (max_tests as u64).saturating_mul(TEST);
        let search = Search::new(self);
        let count = self.triangle_count() as u32;
        let mut all = Found::new(max_listed, u64::MAX);
        for first in (0..count).step_by(ROUND as usize) {
            control.report("self-intersections", f64::from(first) / f64::from(count))?;
            let last = count.min(first.saturating_add(ROUND));
            let batches: Vec<Range<u32>> = (first..last)
                .step_by(BATCH as usize)
                .map(|at| at..last.min(at.saturating_add(BATCH)))
                .collect();
            // An equal share for each, and what others leave for those with which it does not do.
            let share = left / batches.len() as u64;
            let pieces = each_piece(&batches, |batch| search.batch(batch.clone(), max_listed, share));
            for (mut found, batch) in pieces.into_iter().zip(batches) {
                if found.first_unsearched.is_some() && left > 2 * share {
                    left -= share;
                    found = search.batch(batch, max_listed, left);
                }
                left = left.saturating_sub(found.work);
                all.merge(found);
            }
        }
        all.cut();
        let key = |f: u32| self.mesh.faces.key(f);
        let first_unsearched = all.first_unsearched.map(|t| key(self.tree.face(t)));
        let pair = |p: Pair| FacePair {
            faces: p.faces.map(key),
            contact: p.contact,
            place: p.place / self.tree.scale,
        };
        Ok(SelfIntersections {
            pairs: all.pairs.into_iter().map(pair).collect(),
            first_unsearched,
            ..all.counts
        })
    }
}

/// Triangles between two calls of the hook.
const ROUND: u32 = 1 << 14;
/// Triangles of a piece of work.
const BATCH: u32 = 1 << 8;

/// What holding two triangles against each other costs, in triangles whose boxes are looked at.
const TEST: u64 = 8;

/// A pair in slots.
#[derive(Clone, Copy, Debug)]
struct Pair {
    faces: [u32; 2],
    contact: Contact,
    place: DVec3,
}

/// Pairs found so far: the first in order, not many more than asked for; and how many.
struct Found {
    pairs: Vec<Pair>,
    counts: SelfIntersections,
    max: usize,
    /// What it took, and what it may.
    work: u64,
    most: u64,
    first_unsearched: Option<u32>,
}

impl Found {
    fn new(max: usize, most: u64) -> Self {
        let counts = SelfIntersections::default();
        Self { pairs: Vec::new(), counts, max, work: 0, most, first_unsearched: None }
    }

    /// Whether there is something left to spend; if not, a triangle is written down as not searched.
    fn may_search(&mut self, triangle: u32) -> bool {
        let may = self.work < self.most;
        if !may {
            self.counts.unsearched += 1;
            self.first_unsearched.get_or_insert(triangle);
        }
        may
    }

    fn push(&mut self, pair: Pair) {
        self.pairs.push(pair);
        self.counts.add(pair.contact);
        if self.pairs.len() / 2 > self.max.saturating_add(512) {
            self.cut();
        }
    }

    fn merge(&mut self, other: Self) {
        self.pairs.extend(other.pairs);
        self.counts.overlaps += other.counts.overlaps;
        self.counts.crossings += other.counts.crossings;
        self.counts.touches += other.counts.touches;
        self.counts.unsearched += other.counts.unsearched;
        self.first_unsearched = self.first_unsearched.or(other.first_unsearched);
        if self.pairs.len() / 2 > self.max.saturating_add(512) {
            self.cut();
        }
    }

    /// Sorts, and leaves what was asked for.
    fn cut(&mut self) {
        self.pairs.sort_unstable_by_key(|p| p.faces);
        self.pairs.truncate(self.max);
    }
}

/// The index with what this question needs besides.
struct Search<'i> {
    index: &'i MeshIndex<'i>,
    /// Triangles in order of their faces; empty if all faces are triangles.
    by_face: Vec<u32>,
    /// Where in there the triangles of a face begin, by slot.
    starts: Vec<u32>,
    /// By triangle, a bit for each edge that is inside its face.
    cuts: Vec<u8>,
}

impl<'i> Search<'i> {
    fn new(index: &'i MeshIndex<'i>) -> Self {
        let (tree, mesh) = (&index.tree, index.mesh);
        let count = tree.triangle_count();
        let mut search = Self { index, by_face: Vec::new(), starts: Vec::new(), cuts: Vec::new() };
        if count == mesh.face_count() {
            return search;
        }
        search.starts = vec![0; mesh.faces.slot_count() + 1];
        tree.faces().for_each(|f| search.starts[f as usize + 1] += 1);
        for f in 1..search.starts.len() {
            search.starts[f] += search.starts[f - 1];
        }
        let mut next = search.starts.clone();
        search.by_face = vec![0; count];
        for (triangle, f) in (0..).zip(tree.faces()) {
            let at = &mut next[f as usize];
            search.by_face[*at as usize] = triangle;
            *at += 1;
        }
        search.cuts = cuts(index);
        search
    }

    /// Where the triangles of a face are, if not all faces are triangles.
    fn range(&self, face: u32) -> Range<usize> {
        self.starts[face as usize] as usize..self.starts[face as usize + 1] as usize
    }

    fn first_of(&self, triangle: u32) -> u32 {
        let face = self.index.tree.face(triangle) as usize;
        if self.starts.is_empty() { triangle } else { self.by_face[self.starts[face] as usize] }
    }

    fn facet(&self, triangle: u32) -> Facet {
        let bits = self.cuts.get(triangle as usize).copied().unwrap_or(0);
        Facet::new(self.index.tree.places(triangle), [0, 1, 2].map(|i| bits & 1 << i != 0))
    }

    /// The pairs whose first face, in the order of the tree, has its first triangle among these.
    /// No more work is done than so much, and that of one triangle.
    fn batch(&self, triangles: Range<u32>, max: usize, most: u64) -> Found {
        let tree = &self.index.tree;
        let mut found = Found::new(max, most);
        let mut of_face: Vec<Pair> = Vec::new();
        for first in triangles {
            if self.by_face.is_empty() {
                if found.may_search(first) {
                    found.work += self.triangle(first, first, &mut |pair| found.push(pair));
                }
                continue;
            }
            if self.first_of(first) != first {
                continue;
            }
            let mut enough = 1024;
            for &piece in &self.by_face[self.range(tree.face(first))] {
                if found.may_search(piece) {
                    found.work += self.triangle(first, piece, &mut |pair| of_face.push(pair));
                }
                if of_face.len() > enough {
                    strongest(&mut of_face);
                    enough = 2 * of_face.len() + 1024;
                }
            }
            strongest(&mut of_face);
            of_face.drain(..).for_each(|pair| found.push(pair));
        }
        found
    }

    /// Holds a triangle of the face whose first triangle is `first` against those of all faces that come after it. What it took.
    fn triangle(&self, first: u32, piece: u32, push: &mut impl FnMut(Pair)) -> u64 {
        let mut work = 0;
        let tree = &self.index.tree;
        let face = tree.face(piece);
        let [a, b, c] = tree.places(piece);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let around = tree.boxed(low, high);
        let mut own: Option<Facet> = None;
        let mut stack: SmallVec<[(u32, Frame); 64]> = tree.root().into_iter().collect();
        while let Some((at, frame)) = stack.pop() {
            let node = &tree.nodes[at as usize];
            let mut met = meets(node, &frame, &around);
            while met != 0 {
                let i = met.trailing_zeros() as usize % WIDTH;
                met &= met - 1;
                if let Some(child) = node.inner(i) {
                    stack.push((child, frame.of_child(node, i)));
                    continue;
                }
                work += node.leaf(i).len() as u64;
                for other in node.leaf(i) {
                    if self.first_of(other) <= first {
                        continue;
                    }
                    let [a, b, c] = tree.places(other);
                    let (l, h) = (a.min(b).min(c), a.max(b).max(c));
                    if !(low.cmple(h) & l.cmple(high)).all() {
                        continue;
                    }
                    work += TEST;
                    let own = own.get_or_insert_with(|| self.facet(piece));
                    let (facet, of_other) = (self.facet(other), tree.face(other));
                    let met = if face < of_other { meet(own, &facet) } else { meet(&facet, own) };
                    if let Some((contact, place)) = met {
                        push(Pair { faces: [face.min(of_other), face.max(of_other)], contact, place });
                    }
                }
            }
        }
        work
    }
}

/// By triangle, a bit for each edge that is inside its face.
fn cuts(index: &MeshIndex<'_>) -> Vec<u8> {
    let tree = &index.tree;
    let cut = |triangle: u32, i: usize| u8::from(!tree.is_edge(triangle, i)) << i;
    let mut cuts: Vec<u8> =
        (0..tree.triangle_count() as u32).map(|t| cut(t, 0) | cut(t, 1) | cut(t, 2)).collect();
    // A cut beside a triangle without area is none.
    let mut flat: Vec<(u32, u32, u32)> = Vec::new();
    for (triangle, cuts) in (0..).zip(&mut cuts) {
        if *cuts != 0 && !Facet::new(tree.places(triangle), [false; 3]).has_area() {
            let (face, of) = (tree.face(triangle), tree.corners(triangle));
            flat.extend((0..3).map(|i| (face, of[(i + 1) % 3], of[i])));
            *cuts = 0;
        }
    }
    flat.sort_unstable();
    if !flat.is_empty() {
        for (triangle, cuts) in (0..).zip(&mut cuts) {
            let (face, of) = (tree.face(triangle), tree.corners(triangle));
            let is_flat = |i: usize| flat.binary_search(&(face, of[i], of[(i + 1) % 3])).is_ok();
            (0..3).filter(|&i| is_flat(i)).for_each(|i| *cuts &= !(1 << i));
        }
    }
    cuts
}

/// Which children's boxes meet a box.
#[inline]
fn meets(node: &Node, frame: &Frame, (low, high): &([f32; 3], [f32; 3])) -> u32 {
    let mut apart = [false; WIDTH];
    for axis in 0..3 {
        let (lows, highs) = (node.sides(frame, axis), node.sides(frame, axis + 3));
        for i in 0..WIDTH {
            apart[i] |= (lows[i] > high[axis]) | (highs[i] < low[axis]);
        }
    }
    (0..WIDTH).fold(0, |met, i| met | u32::from(!apart[i]) << i) & node.children()
}

/// Leaves of each pair of faces what is strongest, and of that what was found first.
fn strongest(pairs: &mut Vec<Pair>) {
    pairs.sort_by(|a, b| a.faces.cmp(&b.faces).then(b.contact.cmp(&a.contact)));
    pairs.dedup_by_key(|p| p.faces);
}
