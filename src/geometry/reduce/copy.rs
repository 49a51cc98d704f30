//! The private copy that is reduced: triangles alone, in an order in which neighbours lie together in memory.

use super::features::Hold;
use super::quadric::{Planes, Quadric};
use super::queue::PARKED;
use crate::Mesh;
use crate::geometry::measure::Aabb;
use crate::geometry::unit_scale;
use crate::matching::NONE;
use glam::DVec3;

/// A vertex of the copy: three cache lines.
#[derive(Clone, Copy, Default)]
#[repr(align(64))]
pub(super) struct Vertex {
    pub(super) position: DVec3,
    /// The planes of its faces and of its feature edges as they are now: what a collapse costs.
    pub(super) fan: Planes,
    /// The planes of all faces that ever went into it, about the position: the error that is told.
    pub(super) memory: Quadric,
    /// The vertex it went into, once it is dead.
    pub(super) into: u32,
    /// The number of edges.
    pub(super) valence: u32,
    pub(super) hold: Hold,
    pub(super) is_open: bool,
    pub(super) is_moved: bool,
}

/// An edge of the copy: two half-edges, `2 * edge` and its twin.
#[derive(Clone, Copy)]
#[repr(align(32))]
pub(super) struct Edge {
    /// By side. In a dead edge, the half-edge that took the place of this one in its face.
    next: [u32; 2],
    prev: [u32; 2],
    origin: [u32; 2],
    /// Where in the queue it is.
    pub(super) bucket: u32,
    is_open: [bool; 2],
    pub(super) is_dead: bool,
    pub(super) is_feature: bool,
}

/// To numbers about zero and about one, and back.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    /// A power of two that brings coordinates to about one.
    scale: f64,
    center: DVec3,
    /// A power of two that brings distances from the centre to about one.
    zoom: f64,
}

impl Frame {
    pub(super) fn around(points: impl Iterator<Item = DVec3> + Clone) -> Self {
        let scale = unit_scale(points.clone());
        let center = Aabb::around(points.clone()).map_or(DVec3::ZERO, |b| b.center() * scale);
        Self { scale, center, zoom: unit_scale(points.map(|p| p * scale - center)) }
    }

    #[inline]
    pub(super) fn local(&self, p: DVec3) -> DVec3 {
        (p * self.scale - self.center) * self.zoom
    }

    #[inline]
    pub(super) fn global(&self, p: DVec3) -> DVec3 {
        (p / self.zoom + self.center) / self.scale
    }

    /// A local length in the units of the mesh.
    pub(super) fn length(&self, local: f64) -> f64 {
        local / self.zoom / self.scale
    }
}

/// The copy. Half-edges and vertices have numbers of their own.
pub(super) struct Copy {
    pub(super) frame: Frame,
    pub(super) vertices: Vec<Vertex>,
    pub(super) edges: Vec<Edge>,
    /// The face of the mesh beside each half-edge, by edge and side.
    pub(super) faces: Vec<[u32; 2]>,
    /// The slot in the mesh of each vertex.
    pub(super) vertex_slot: Vec<u32>,
    /// The slot in the mesh of each edge.
    pub(super) edge_slot: Vec<u32>,
    /// How many faces are gone.
    pub(super) removed: usize,
}

impl Copy {
    /// Copies a mesh of triangles; isolated vertices stay out.
    pub(super) fn of(mesh: &Mesh) -> Self {
        let used = || mesh.vertices.live().filter(|&v| mesh.vertex_halfedge[v as usize] != NONE);
        let frame = Frame::around(used().map(|v| mesh.positions[v as usize]));
        let vertex_slot = along_a_curve(used().map(|v| (frame.local(mesh.positions[v as usize]), v)));
        let mut number = vec![NONE; mesh.vertices.slot_count()];
        (0..).zip(&vertex_slot).for_each(|(i, &v)| number[v as usize] = i);
        let vertex = |&v: &u32| Vertex {
            position: frame.local(mesh.positions[v as usize]),
            into: NONE,
            is_open: mesh.face[mesh.vertex_halfedge[v as usize] as usize] == NONE,
            ..Vertex::default()
        };
        let mut vertices: Vec<Vertex> = vertex_slot.iter().map(vertex).collect();

        // Edges by their lower vertex.
        let ends = |e: u32| [2 * e, 2 * e + 1].map(|h| number[mesh.origin[h as usize] as usize]);
        let lower = |e: u32| ends(e)[0].min(ends(e)[1]) as usize;
        let mut place = vec![0u32; vertices.len() + 1];
        mesh.edges.live().for_each(|e| place[lower(e) + 1] += 1);
        for i in 1..place.len() {
            place[i] += place[i - 1];
        }
        let mut edge_number = vec![NONE; mesh.edges.slot_count()];
        for e in mesh.edges.live() {
            let place = &mut place[lower(e)];
            edge_number[e as usize] = *place;
            *place += 1;
        }
        let halfedge = |h: u32| 2 * edge_number[h as usize >> 1] + (h & 1);
        let blank = Edge {
            next: [NONE; 2],
            prev: [NONE; 2],
            origin: [NONE; 2],
            bucket: PARKED,
            is_open: [false; 2],
            is_dead: false,
            is_feature: false,
        };
        let mut edges = vec![blank; mesh.edge_count()];
        let mut faces = vec![[NONE; 2]; edges.len()];
        let mut edge_slot = vec![NONE; edges.len()];
        for e in mesh.edges.live() {
            let i = edge_number[e as usize] as usize;
            let sides = [2 * e as usize, 2 * e as usize + 1];
            faces[i] = sides.map(|h| mesh.face[h]);
            edge_slot[i] = e;
            edges[i] = Edge {
                next: sides.map(|h| halfedge(mesh.next[h])),
                prev: sides.map(|h| halfedge(mesh.prev[h])),
                origin: ends(e),
                is_open: faces[i].map(|f| f == NONE),
                ..blank
            };
            ends(e).into_iter().for_each(|v| vertices[v as usize].valence += 1);
        }
        Self { frame, vertices, edges, faces, vertex_slot, edge_slot, removed: 0 }
    }

    #[inline]
    pub(super) fn vertex(&self, v: u32) -> &Vertex {
        &self.vertices[v as usize]
    }

    #[inline]
    fn edge(&self, h: u32) -> (&Edge, usize) {
        (&self.edges[h as usize >> 1], (h & 1) as usize)
    }

    #[inline]
    pub(super) fn next(&self, h: u32) -> u32 {
        let (edge, side) = self.edge(h);
        edge.next[side]
    }

    #[inline]
    pub(super) fn prev(&self, h: u32) -> u32 {
        let (edge, side) = self.edge(h);
        edge.prev[side]
    }

    #[inline]
    pub(super) fn origin(&self, h: u32) -> u32 {
        let (edge, side) = self.edge(h);
        edge.origin[side]
    }

    /// Whether the half-edge has no face.
    #[inline]
    pub(super) fn is_open(&self, h: u32) -> bool {
        let (edge, side) = self.edge(h);
        edge.is_open[side]
    }

    #[inline]
    pub(super) fn set_origin(&mut self, h: u32, v: u32) {
        self.edges[h as usize >> 1].origin[(h & 1) as usize] = v;
    }

    #[inline]
    pub(super) fn link(&mut self, h: u32, n: u32) {
        self.edges[h as usize >> 1].next[(h & 1) as usize] = n;
        self.edges[n as usize >> 1].prev[(n & 1) as usize] = h;
    }

    /// Lets `stays` take the place of `goes` in its face, or on the boundary; the edge of `goes` dies.
    pub(super) fn replace(&mut self, goes: u32, stays: u32) {
        let (before, after) = (self.prev(goes), self.next(goes));
        self.link(before, stays);
        self.link(stays, after);
        let [from, to] = [goes, stays].map(|h| (h as usize >> 1, (h & 1) as usize));
        self.faces[to.0][to.1] = self.faces[from.0][from.1];
        self.edges[to.0].is_open[to.1] = self.edges[from.0].is_open[from.1];
        self.edges[to.0].is_feature |= self.edges[from.0].is_feature;
        self.edges[from.0].next[from.1] = stays;
        self.bury(goes >> 1);
    }

    pub(super) fn bury(&mut self, e: u32) {
        let edge = &mut self.edges[e as usize];
        (edge.is_dead, edge.bucket) = (true, PARKED);
    }

    /// The half-edge that stands for this one in its face, which must be live.
    pub(super) fn successor(&self, h: u32) -> u32 {
        let mut h = h;
        while self.edges[h as usize >> 1].is_dead {
            h = self.next(h);
        }
        h
    }
}

/// Slots in the order in which their points lie along Morton's curve: what is near in space is near in the order.
fn along_a_curve(points: impl Iterator<Item = (DVec3, u32)> + Clone) -> Vec<u32> {
    let bounds =
        Aabb::around(points.clone().map(|p| p.0)).unwrap_or(Aabb { min: DVec3::ZERO, max: DVec3::ZERO });
    let per_unit = 1023.0 / (bounds.max - bounds.min).max_element().max(f64::MIN_POSITIVE);
    let spread = |x: f64| {
        let mut bits = (x as u32).min(1023);
        for (shift, mask) in [(16, 0x0300_00FF), (8, 0x0300_F00F), (4, 0x030C_30C3), (2, 0x0924_9249)] {
            bits = (bits | bits << shift) & mask;
        }
        bits
    };
    let code = |(p, slot): (DVec3, u32)| {
        let cell = (p - bounds.min) * per_unit;
        (spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2, slot)
    };
    let mut from: Vec<(u32, u32)> = points.map(code).collect();
    let mut to = vec![(0, 0); from.len()];
    // A radix sort, ten bits at a time.
    for shift in [0, 10, 20] {
        let digit = |code: u32| (code >> shift & 1023) as usize;
        let mut starts = [0usize; 1025];
        from.iter().for_each(|p| starts[digit(p.0) + 1] += 1);
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        for &p in &from {
            let start = &mut starts[digit(p.0)];
            to[*start] = p;
            *start += 1;
        }
        std::mem::swap(&mut from, &mut to);
    }
    from.into_iter().map(|p| p.1).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_fill_whole_cache_lines() {
        assert_eq!((size_of::<Vertex>(), size_of::<Edge>()), (192, 32));
    }

    #[test]
    fn a_frame_brings_any_points_to_about_one_and_back() {
        for (offset, size) in [(0.0, 1e-300), (1e6, 1.0), (0.0, 1e300), (-1e30, 1e20), (0.0, 0.0)] {
            let points =
                [DVec3::splat(offset), DVec3::splat(offset + size), DVec3::new(offset, 0.0, -offset)];
            let frame = Frame::around(points.into_iter());
            for p in points {
                let local = frame.local(p);
                assert!(local.is_finite() && local.abs().max_element() <= 2.0, "{p} {local}");
                let error = (frame.global(local) - p).abs().max_element();
                assert!(error <= 1e-15 * p.abs().max_element(), "{p}: {error}");
            }
        }
    }
}
