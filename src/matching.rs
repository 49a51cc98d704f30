//! Which corners share an edge: the one edge matching that the builder, the topology checks and the clean-up use.
//!
//! The half-edge of a corner runs from the corner's vertex to the next corner's. Every edge hangs in a chain at the
//! lower of its two vertices; a chain is a handful of links on real meshes, and past [`MAX_CHAIN`] of them (a hub
//! vertex) the half-edges are set aside and sorted instead. So no hashing, and never quadratic.

use crate::Polygons;

/// No corner, face or half-edge.
pub(crate) const NONE: u32 = u32::MAX;

/// How long a chain may grow before its vertex counts as a hub.
const MAX_CHAIN: usize = 32;

/// The matching in the making. Edges are numbered in the order of their first use (those at hubs after all others).
#[derive(Clone, Debug)]
pub(crate) struct Chains {
    edges: Vec<Link>,
    /// For each corner, twice its edge, plus one unless it was the edge's first use.
    use_of: Vec<u32>,
    /// `(edge, corner)` of third and later uses, sorted.
    more: Vec<(u32, u32)>,
    /// Whether some edge's first two uses run the same way.
    any_conflict: bool,
}

/// An edge in the chain of its lower vertex. Vertices and edges are numbered below 2^31, which leaves a bit in each word.
#[derive(Clone, Copy, Debug)]
struct Link {
    /// The higher vertex; the top bit tells whether the edge has a second use.
    hi: u32,
    /// The next edge of the chain; the top bit tells whether the first use runs downwards.
    next: u32,
}

const TOP: u32 = 1 << 31;
const END: u32 = TOP - 1;

impl Chains {
    /// Matches all corners. Indices must be below `vertex_count`, and no face may repeat a corner in a row.
    /// O(corners), with a sort of the edges at hubs; 8 bytes an edge and 4 a corner.
    pub(crate) fn new(vertex_count: usize, polygons: &Polygons) -> Self {
        let corners = polygons.corners();
        let mut m = Self {
            edges: Vec::with_capacity(corners.len() / 2 + corners.len() / 16 + 4),
            use_of: vec![0; corners.len()],
            more: Vec::new(),
            any_conflict: false,
        };
        let mut heads = vec![END; vertex_count];
        let mut at_hubs: Vec<(u32, u32, u32)> = Vec::new();
        for_each_halfedge(polygons, |corner, a, b| m.add(&mut heads, &mut at_hubs, corner, a, b));
        m.add_hubs(at_hubs);
        m.more.sort_unstable();
        m
    }

    /// Whether every edge has one use, or two that run opposite ways.
    pub(crate) fn is_paired(&self) -> bool {
        self.more.is_empty() && !self.any_conflict
    }

    /// How many third and later uses of edges there are.
    pub(crate) fn more_uses(&self) -> usize {
        self.more.len()
    }

    #[inline]
    fn add(&mut self, heads: &mut [u32], at_hubs: &mut Vec<(u32, u32, u32)>, corner: u32, a: u32, b: u32) {
        let (lo, hi, down) = if a < b { (a, b, 0) } else { (b, a, TOP) };
        let head = &mut heads[lo as usize];
        let mut edge = *head;
        let mut length = 0;
        while edge != END {
            let link = self.edges[edge as usize];
            if link.hi & !TOP == hi {
                return self.use_again(edge, corner, down);
            }
            edge = link.next & !TOP;
            length += 1;
            if length == MAX_CHAIN {
                return at_hubs.push((lo, hi, corner << 1 | down >> 31));
            }
        }
        self.use_of[corner as usize] = (self.edges.len() as u32) << 1;
        let next = std::mem::replace(head, self.edges.len() as u32);
        self.edges.push(Link { hi, next: next | down });
    }

    fn use_again(&mut self, edge: u32, corner: u32, down: u32) {
        self.use_of[corner as usize] = edge << 1 | 1;
        let link = &mut self.edges[edge as usize];
        if link.hi & TOP == 0 {
            link.hi |= TOP;
            self.any_conflict |= link.next & TOP == down;
        } else {
            self.more.push((edge, corner));
        }
    }

    /// Half-edges at full chains that the chain does not hold: a chain that is full never changes, so they are apart
    /// from every edge so far.
    fn add_hubs(&mut self, mut at_hubs: Vec<(u32, u32, u32)>) {
        at_hubs.sort_unstable();
        let mut last = None;
        for (lo, hi, entry) in at_hubs {
            let (corner, down) = (entry >> 1, entry << 31);
            if last == Some((lo, hi)) {
                self.use_again(self.edges.len() as u32 - 1, corner, down);
            } else {
                last = Some((lo, hi));
                self.use_of[corner as usize] = (self.edges.len() as u32) << 1;
                self.edges.push(Link { hi, next: END | down });
            }
        }
    }

    /// Lets go of all that a build does not need.
    pub(crate) fn into_pairing(self) -> Pairing {
        let open = (0..).zip(&self.edges).filter(|(_, e)| e.hi & TOP == 0).map(|(i, _)| i).collect();
        Pairing { edges: self.edges.len(), use_of: self.use_of, open }
    }
}

/// Calls `f` with every corner, its vertex and the next corner's.
#[inline]
fn for_each_halfedge(polygons: &Polygons, mut f: impl FnMut(u32, u32, u32)) {
    let mut corner = 0;
    for face in polygons.iter() {
        let mut here = face.first().copied().unwrap_or(0);
        for i in 0..face.len() {
            let there = face[if i + 1 == face.len() { 0 } else { i + 1 }];
            f(corner, here, there);
            here = there;
            corner += 1;
        }
    }
}

/// What is left of a matching of which every edge has one or two uses: enough to build, and little memory, so that the
/// columns of the mesh can take over the rest from the allocator.
#[derive(Clone, Debug)]
pub(crate) struct Pairing {
    /// The number of edges.
    pub(crate) edges: usize,
    /// For each corner, twice its edge, plus one unless it was the edge's first use.
    pub(crate) use_of: Vec<u32>,
    /// The edges with one use, ascending.
    pub(crate) open: Vec<u32>,
}

/// One edge: who uses it, in the order of corners.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EdgeUse {
    /// The first corner, times two, plus one if it runs from the higher to the lower vertex.
    first: u32,
    /// The second, likewise; [`NONE`] on an edge with one face.
    second: u32,
}

impl EdgeUse {
    /// The corner that used this edge first.
    pub(crate) fn first(&self) -> usize {
        (self.first >> 1) as usize
    }

    /// The corner that used this edge second.
    pub(crate) fn second(&self) -> Option<usize> {
        (self.second != NONE).then_some((self.second >> 1) as usize)
    }

    /// Whether the first two uses run the same way.
    pub(crate) fn is_conflict(&self) -> bool {
        self.second != NONE && (self.first ^ self.second) & 1 == 0
    }
}

/// The edges of an indexed mesh.
#[derive(Clone, Debug)]
pub(crate) struct Matching {
    pub(crate) edges: Vec<EdgeUse>,
    /// For each corner, twice its edge, plus one unless it was the edge's first use.
    pub(crate) use_of: Vec<u32>,
    /// `(edge, corner)` of third and later uses, sorted.
    pub(crate) more: Vec<(u32, u32)>,
    /// Whether some edge's first two uses run the same way.
    pub(crate) any_conflict: bool,
}

impl Matching {
    /// Matches all corners, as [`Chains::new`].
    pub(crate) fn new(vertex_count: usize, polygons: &Polygons) -> Self {
        let Chains { edges, use_of, more, any_conflict } = Chains::new(vertex_count, polygons);
        let mut uses = vec![EdgeUse { first: NONE, second: NONE }; edges.len()];
        drop(edges);
        for_each_halfedge(polygons, |corner, a, b| {
            let edge = &mut uses[(use_of[corner as usize] >> 1) as usize];
            let entry = corner << 1 | u32::from(a > b);
            // Corners come in order, so the third and later ones find both places taken.
            if edge.first == NONE {
                edge.first = entry;
            } else if edge.second == NONE {
                edge.second = entry;
            }
        });
        Self { edges: uses, use_of, more, any_conflict }
    }

    /// The edge of a corner's half-edge.
    pub(crate) fn edge_of(&self, corner: usize) -> usize {
        (self.use_of[corner] >> 1) as usize
    }

    /// The corners that use `edge`, ascending.
    pub(crate) fn uses(&self, edge: usize) -> impl Iterator<Item = usize> + Clone + '_ {
        let e = self.edges[edge];
        let from = self.more.partition_point(|m| (m.0 as usize) < edge);
        let more = self.more[from..].iter().take_while(move |m| m.0 as usize == edge);
        std::iter::once(e.first()).chain(e.second()).chain(more.map(|m| m.1 as usize))
    }

    /// Whether `edge` has more than two uses.
    pub(crate) fn is_nonmanifold(&self, edge: usize) -> bool {
        !self.more.is_empty() && self.more.binary_search_by_key(&(edge as u32), |m| m.0).is_ok()
    }

    /// The edges with more than two uses, ascending.
    pub(crate) fn nonmanifold_edges(&self) -> impl Iterator<Item = usize> + '_ {
        self.more.chunk_by(|a, b| a.0 == b.0).map(|uses| uses[0].0 as usize)
    }

    /// For each corner, the corner across its edge, or [`NONE`] where the edge has not exactly two faces.
    pub(crate) fn mates(&self) -> Vec<u32> {
        let mut mates = vec![NONE; self.use_of.len()];
        for (e, edge) in self.edges.iter().enumerate() {
            if let Some(second) = edge.second()
                && !self.is_nonmanifold(e)
            {
                mates[edge.first()] = second as u32;
                mates[second] = edge.first() as u32;
            }
        }
        mates
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    /// Every edge with its corners, the slow way.
    fn naive(polygons: &Polygons) -> BTreeMap<(u32, u32), Vec<usize>> {
        let mut edges = BTreeMap::<_, Vec<_>>::new();
        let mut c = 0;
        for face in polygons.iter() {
            for i in 0..face.len() {
                let (a, b) = (face[i], face[(i + 1) % face.len()]);
                edges.entry((a.min(b), a.max(b))).or_default().push(c);
                c += 1;
            }
        }
        edges
    }

    fn agree(vertex_count: usize, polygons: &Polygons) {
        let m = Matching::new(vertex_count, polygons);
        let expected = naive(polygons);
        let mut ours: Vec<Vec<usize>> = (0..m.edges.len()).map(|e| m.uses(e).collect()).collect();
        for (e, uses) in ours.iter().enumerate() {
            for (i, &c) in uses.iter().enumerate() {
                assert_eq!(m.use_of[c] as usize, 2 * e + usize::from(i > 0));
            }
            assert_eq!(m.is_nonmanifold(e), uses.len() > 2);
            if uses.len() > 1 {
                assert_eq!(
                    m.edges[e].is_conflict(),
                    polygons.corners()[uses[0]] == polygons.corners()[uses[1]]
                );
            }
        }
        ours.sort();
        let mut expected: Vec<_> = expected.into_values().collect();
        expected.sort();
        assert_eq!(ours, expected);
    }

    proptest! {
        #[test]
        fn matching_equals_a_map_of_vertex_pairs(faces in prop::collection::vec(prop::sample::subsequence((0..9u32).collect::<Vec<_>>(), 3..6), 0..40)) {
            agree(9, &faces.into_iter().collect());
        }

        #[test]
        fn matching_equals_a_map_of_vertex_pairs_at_hubs(rim in prop::collection::vec((1..120u32, 1..120u32), 0..400)) {
            agree(120, &rim.into_iter().filter(|(a, b)| a != b).map(|(a, b)| [0, a, b]).collect());
        }
    }
}
