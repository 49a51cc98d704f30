//! What a reduction works on: the compact copy, or a part of it that nothing outside touches.

use super::HEAVY;
use super::features::Hold;
use super::quadric::{Planes, Quadric};
use super::queue::PARKED;
use crate::matching::NONE;
use glam::DVec3;

/// A vertex: half a cache line.
#[derive(Clone, Copy)]
#[repr(align(32))]
pub(super) struct Spot {
    pub(super) position: DVec3,
    /// The boundary half-edge that ends here, if there is one. Of a dead vertex, the one it went into.
    pub(super) link: u32,
    /// The number of edges, above bits that say the rest.
    state: u32,
}

const HOLD: u32 = 3;
const MOVED: u32 = 1 << 2;
const DEAD: u32 = 1 << 3;
const SEAM: u32 = 1 << 4;
const ONE_EDGE: u32 = 1 << 8;
/// As many edges or more; no longer counted down.
const VERY_MANY: u32 = u32::MAX >> 8;

impl Spot {
    pub(super) fn new(position: DVec3) -> Self {
        Self { position, link: NONE, state: 0 }
    }

    #[inline]
    pub(super) fn hold(&self) -> Hold {
        match self.state & HOLD {
            0 => Hold::Free,
            1 => Hold::Line,
            _ => Hold::Fixed,
        }
    }

    pub(super) fn set_hold(&mut self, hold: Hold) {
        self.state = self.state & !HOLD | hold as u32;
    }

    #[inline]
    pub(super) fn valence(&self) -> u32 {
        self.state / ONE_EDGE
    }

    #[inline]
    pub(super) fn set_valence(&mut self, valence: u32) {
        if self.valence() < VERY_MANY {
            self.state = (self.state % ONE_EDGE) | (valence.min(VERY_MANY) * ONE_EDGE);
        }
    }

    /// Counts one more.
    #[inline]
    pub(super) fn count_edge(&mut self) {
        if self.valence() < VERY_MANY {
            self.state += ONE_EDGE;
        }
    }

    #[inline]
    pub(super) fn is_heavy(&self) -> bool {
        self.valence() > HEAVY
    }

    /// Whether it is on the boundary.
    #[inline]
    pub(super) fn is_open(&self) -> bool {
        self.link != NONE
    }

    #[inline]
    pub(super) fn is_moved(&self) -> bool {
        self.state & MOVED != 0
    }

    #[inline]
    pub(super) fn move_to(&mut self, position: DVec3) {
        self.position = position;
        self.state |= MOVED;
    }

    #[inline]
    pub(super) fn is_dead(&self) -> bool {
        self.state & DEAD != 0
    }

    pub(super) fn go_into(&mut self, v: u32) {
        self.link = v;
        self.state |= DEAD;
    }

    /// Whether it has to wait until the parts come together.
    #[inline]
    pub(super) fn is_seam(&self) -> bool {
        self.state & SEAM != 0
    }

    pub(super) fn set_seam(&mut self, is_seam: bool) {
        self.state = self.state & !SEAM | if is_seam { SEAM } else { 0 };
    }
}

/// An edge: two half-edges, `2 * edge` and its twin; a quarter of a cache line.
#[derive(Clone, Copy, Default)]
#[repr(align(16))]
pub(super) struct Edge {
    /// By side; the top bit tells that the side has no face. In a dead edge, the half-edge that took the place of this one.
    next: [u32; 2],
    /// By side; the top bits tell whether the edge is dead, and whether it is a feature.
    origin: [u32; 2],
}

/// The bit above all numbers of vertices and of half-edges.
const TOP: u32 = 1 << 31;
pub(super) const MAX_EDGES: usize = (1 << 30) - 1;

impl Edge {
    pub(super) fn new(next: [u32; 2], origin: [u32; 2], is_open: [bool; 2]) -> Self {
        let open = is_open.map(|open| if open { TOP } else { 0 });
        Self { next: [next[0] | open[0], next[1] | open[1]], origin }
    }

    #[inline]
    pub(super) fn ends(&self) -> [u32; 2] {
        [self.origin[0] & !TOP, self.origin[1] & !TOP]
    }

    #[inline]
    pub(super) fn is_dead(&self) -> bool {
        self.origin[0] & TOP != 0
    }

    #[inline]
    pub(super) fn is_feature(&self) -> bool {
        self.origin[1] & TOP != 0
    }

    pub(super) fn set_feature(&mut self) {
        self.origin[1] |= TOP;
    }

    #[inline]
    pub(super) fn next(&self, side: usize) -> u32 {
        self.next[side] & !TOP
    }

    /// Whether either side has no face.
    pub(super) fn is_open(&self) -> bool {
        (self.next[0] | self.next[1]) & TOP != 0
    }
}

/// Slices of the arrays of a copy.
pub(super) struct Part<'a> {
    pub(super) spots: &'a mut [Spot],
    /// The planes around each vertex as they are now: what a collapse costs.
    pub(super) fans: &'a mut [Planes],
    /// The planes of the faces around each vertex as they were.
    pub(super) origins: &'a mut [Planes],
    /// The planes of all faces that ever went into a vertex, about its position; empty if the error has no bound.
    pub(super) memory: &'a mut [Quadric],
    pub(super) edges: &'a mut [Edge],
    /// The bucket of each edge.
    pub(super) keys: &'a mut [u16],
    /// The face of the mesh beside each half-edge.
    pub(super) faces: &'a mut [[u32; 2]],
    pub(super) first_vertex: u32,
    pub(super) first_edge: u32,
    /// Whether there are no others.
    pub(super) is_whole: bool,
    /// How many faces are gone.
    pub(super) removed: usize,
}

impl<'a> Part<'a> {
    /// The first vertices and edges, and the others.
    pub(super) fn split(self, vertices: usize, edges: usize) -> (Self, Self) {
        let (spots, other_spots) = self.spots.split_at_mut(vertices);
        let (fans, other_fans) = self.fans.split_at_mut(vertices);
        let (origins, other_origins) = self.origins.split_at_mut(vertices);
        let (memory, other_memory) = self.memory.split_at_mut(vertices.min(self.memory.len()));
        let (first, other_edges) = self.edges.split_at_mut(edges);
        let (keys, other_keys) = self.keys.split_at_mut(edges);
        let (faces, other_faces) = self.faces.split_at_mut(edges);
        let (first_vertex, first_edge) = (self.first_vertex, self.first_edge);
        let others = Part {
            spots: other_spots,
            fans: other_fans,
            origins: other_origins,
            memory: other_memory,
            edges: other_edges,
            keys: other_keys,
            faces: other_faces,
            first_vertex: first_vertex + vertices as u32,
            first_edge: first_edge + edges as u32,
            is_whole: false,
            removed: 0,
        };
        let (edges, is_whole, removed) = (first, false, 0);
        let part = Part {
            spots,
            fans,
            origins,
            memory,
            edges,
            keys,
            faces,
            first_vertex,
            first_edge,
            is_whole,
            removed,
        };
        (part, others)
    }
}

impl Part<'_> {
    #[inline]
    pub(super) fn spot(&self, v: u32) -> &Spot {
        &self.spots[v.wrapping_sub(self.first_vertex) as usize]
    }

    #[inline]
    pub(super) fn spot_mut(&mut self, v: u32) -> &mut Spot {
        &mut self.spots[v.wrapping_sub(self.first_vertex) as usize]
    }

    #[inline]
    pub(super) fn fan(&self, v: u32) -> &Planes {
        &self.fans[v.wrapping_sub(self.first_vertex) as usize]
    }

    #[inline]
    pub(super) fn fan_mut(&mut self, v: u32) -> &mut Planes {
        &mut self.fans[v.wrapping_sub(self.first_vertex) as usize]
    }

    #[inline]
    pub(super) fn origin_mut(&mut self, v: u32) -> &mut Planes {
        &mut self.origins[v.wrapping_sub(self.first_vertex) as usize]
    }

    #[inline]
    pub(super) fn memory_mut(&mut self, v: u32) -> Option<&mut Quadric> {
        self.memory.get_mut(v.wrapping_sub(self.first_vertex) as usize)
    }

    #[inline]
    fn place_of(&self, e: u32) -> usize {
        e.wrapping_sub(self.first_edge) as usize
    }

    #[inline]
    pub(super) fn edge(&self, e: u32) -> &Edge {
        &self.edges[self.place_of(e)]
    }

    #[inline]
    fn edge_mut(&mut self, e: u32) -> &mut Edge {
        let at = self.place_of(e);
        &mut self.edges[at]
    }

    #[inline]
    pub(super) fn key(&self, e: u32) -> u16 {
        self.keys[self.place_of(e)]
    }

    #[inline]
    pub(super) fn key_mut(&mut self, e: u32) -> &mut u16 {
        let at = self.place_of(e);
        &mut self.keys[at]
    }

    #[inline]
    pub(super) fn next(&self, h: u32) -> u32 {
        self.edge(h >> 1).next[(h & 1) as usize] & !TOP
    }

    #[inline]
    pub(super) fn prev(&self, h: u32) -> u32 {
        if self.is_open(h) { self.spot(self.origin(h)).link } else { self.next(self.next(h)) }
    }

    #[inline]
    pub(super) fn origin(&self, h: u32) -> u32 {
        self.edge(h >> 1).origin[(h & 1) as usize] & !TOP
    }

    /// The target of a spoke and the spoke after it, clockwise.
    #[inline]
    pub(super) fn around(&self, h: u32) -> (u32, u32) {
        let (edge, other) = (self.edge(h >> 1), (h & 1 ^ 1) as usize);
        (edge.origin[other] & !TOP, edge.next[other] & !TOP)
    }

    /// Whether the half-edge has no face.
    #[inline]
    pub(super) fn is_open(&self, h: u32) -> bool {
        self.edge(h >> 1).next[(h & 1) as usize] & TOP != 0
    }

    #[inline]
    pub(super) fn is_feature(&self, h: u32) -> bool {
        self.edge(h >> 1).is_feature()
    }

    #[inline]
    pub(super) fn set_origin(&mut self, h: u32, v: u32) {
        let origin = &mut self.edge_mut(h >> 1).origin[(h & 1) as usize];
        *origin = *origin & TOP | v;
    }

    #[inline]
    pub(super) fn link(&mut self, h: u32, n: u32) {
        let next = &mut self.edge_mut(h >> 1).next[(h & 1) as usize];
        *next = *next & TOP | n;
    }

    /// Lets `stays` take the place of `goes` in its face, or on the boundary; the edge of `goes` dies.
    pub(super) fn replace(&mut self, goes: u32, stays: u32) {
        let before = self.prev(goes);
        let gone = *self.edge(goes >> 1);
        let gone_next = gone.next[(goes & 1) as usize];
        self.link(before, stays);
        self.edge_mut(stays >> 1).next[(stays & 1) as usize] = gone_next;
        if gone.is_feature() {
            self.edge_mut(stays >> 1).set_feature();
        }
        if gone_next & TOP != 0 {
            let end = self.origin(stays ^ 1);
            self.spot_mut(end).link = stays;
        }
        let (from, to) = (self.place_of(goes >> 1), self.place_of(stays >> 1));
        self.faces[to][(stays & 1) as usize] = self.faces[from][(goes & 1) as usize];
        self.edges[from].next[(goes & 1) as usize] = stays;
        self.bury(goes >> 1);
    }

    pub(super) fn bury(&mut self, e: u32) {
        self.edge_mut(e).origin[0] |= TOP;
        *self.key_mut(e) = PARKED;
    }

    /// The half-edge that stands for this one in its face, which must be live.
    pub(super) fn successor(&self, h: u32) -> u32 {
        let mut h = h;
        while self.edge(h >> 1).is_dead() {
            h = self.next(h);
        }
        h
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_fill_fractions_of_a_cache_line() {
        assert_eq!((size_of::<Spot>(), size_of::<Edge>()), (32, 16));
    }

    #[test]
    fn the_number_of_edges_stays_apart_from_the_rest() {
        let mut spot = Spot::new(DVec3::ONE);
        spot.set_hold(Hold::Fixed);
        spot.set_valence(7);
        spot.set_seam(true);
        assert_eq!((spot.hold(), spot.valence(), spot.is_seam()), (Hold::Fixed, 7, true));
        spot.set_valence(u32::MAX);
        spot.set_seam(false);
        spot.set_valence(3);
        assert_eq!(
            (spot.hold(), spot.valence(), spot.is_seam()),
            (Hold::Fixed, VERY_MANY, false),
            "for good"
        );
    }
}
