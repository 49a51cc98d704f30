//! The private copy that is reduced: triangles alone, in an order in which neighbours lie together in memory.

use super::part::{Edge, Part, Spot};
use super::quadric::{Planes, Quadric};
use super::queue::PARKED;
use crate::Mesh;
use crate::geometry::measure::Aabb;
use crate::geometry::unit_scale;
use crate::matching::NONE;
use crate::order::along_a_curve;
use glam::DVec3;

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
    pub(super) spots: Vec<Spot>,
    pub(super) fans: Vec<Planes>,
    /// The planes of the faces around each vertex as they were.
    pub(super) origins: Vec<Planes>,
    pub(super) memory: Vec<Quadric>,
    pub(super) edges: Vec<Edge>,
    keys: Vec<u16>,
    /// The face of the mesh beside each half-edge, by edge and side.
    pub(super) faces: Vec<[u32; 2]>,
    /// The slot in the mesh of each vertex.
    pub(super) vertex_slot: Vec<u32>,
    /// The slot in the mesh of each edge.
    pub(super) edge_slot: Vec<u32>,
    pub(super) face_count: usize,
}

impl Copy {
    /// Copies a mesh of triangles; isolated vertices stay out.
    pub(super) fn of(mesh: &Mesh) -> Self {
        let used = || mesh.vertices.live().filter(|&v| mesh.vertex_halfedge[v as usize] != NONE);
        let frame = Frame::around(used().map(|v| mesh.positions[v as usize]));
        let vertex_slot = along_a_curve(used().map(|v| (frame.local(mesh.positions[v as usize]), v)));
        let mut number = vec![NONE; mesh.vertices.slot_count()];
        (0..).zip(&vertex_slot).for_each(|(i, &v)| number[v as usize] = i);
        let spot = |&v: &u32| Spot::new(frame.local(mesh.positions[v as usize]));
        let mut spots: Vec<Spot> = vertex_slot.iter().map(spot).collect();

        // Edges by their lower vertex.
        let ends = |e: u32| [2 * e, 2 * e + 1].map(|h| number[mesh.origin[h as usize] as usize]);
        let mut place = vec![0u32; spots.len() + 1];
        let mut edge_number = vec![NONE; mesh.edges.slot_count()];
        for e in mesh.edges.live() {
            let ends = ends(e);
            let lower = ends[0].min(ends[1]);
            edge_number[e as usize] = lower;
            place[lower as usize + 1] += 1;
        }
        for i in 1..place.len() {
            place[i] += place[i - 1];
        }
        let mut edge_slot = vec![0u32; mesh.edge_count()];
        for e in mesh.edges.live() {
            let number = &mut edge_number[e as usize];
            let place = &mut place[*number as usize];
            edge_slot[*place as usize] = e;
            *number = *place;
            *place += 1;
        }
        let halfedge = |h: u32| 2 * edge_number[h as usize >> 1] + (h & 1);
        let mut faces = vec![[0u32; 2]; edge_slot.len()];
        let mut edges = vec![Edge::default(); edge_slot.len()];
        for e in mesh.edges.live() {
            let sides = [2 * e as usize, 2 * e as usize + 1];
            let (i, ends) = (edge_number[e as usize], ends(e));
            let beside = sides.map(|h| mesh.face[h]);
            let is_open = beside.map(|f| f == NONE);
            faces[i as usize] = beside;
            edges[i as usize] = Edge::new(sides.map(|h| halfedge(mesh.next[h])), ends, is_open);
            for side in 0..2 {
                spots[ends[side] as usize].count_edge();
                if is_open[side] {
                    spots[ends[1 - side] as usize].link = 2 * i + side as u32;
                }
            }
        }
        let keys = vec![PARKED; edges.len()];
        let (fans, origins, memory) = (Vec::new(), Vec::new(), Vec::new());
        let face_count = mesh.face_count();
        Self { frame, spots, fans, origins, memory, edges, keys, faces, vertex_slot, edge_slot, face_count }
    }

    /// All of it.
    pub(super) fn whole(&mut self) -> Part<'_> {
        Part {
            spots: &mut self.spots,
            fans: &mut self.fans,
            origins: &mut self.origins,
            memory: &mut self.memory,
            edges: &mut self.edges,
            keys: &mut self.keys,
            faces: &mut self.faces,
            first_vertex: 0,
            first_edge: 0,
            is_whole: true,
            removed: 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
