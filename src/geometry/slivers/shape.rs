//! How far a face is from having no area.

use super::{Sliver, SliverKind};
use crate::Mesh;
use crate::geometry::normals::double_area_vector;
use crate::geometry::triangulate::Triangulator;
use crate::geometry::{direction, unit_scale};
use glam::DVec3;
use smallvec::SmallVec;

/// The corners of a face as it is or would be: vertex slots and scaled positions.
pub(super) type Corners = SmallVec<[(u32, DVec3); 8]>;

/// By what slivers are ordered: the number of corners, then the bits of the longest extent, which order as the length does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Size(pub(super) u32, pub(super) u64);

/// What there is to see of a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    /// What makes it a sliver, and at which corner the edge in question begins: the short one of a needle, the long one of
    /// a cap.
    pub(super) fault: Option<(SliverKind, usize)>,
    /// What it counts if it is a sliver.
    pub(super) size: Size,
    /// The direction of its area vector; zero if it has no height.
    pub(super) normal: DVec3,
    /// Scaled.
    pub(super) height: f64,
}

impl Look {
    pub(super) fn counts(&self) -> Option<Size> {
        self.fault.map(|_| self.size)
    }

    /// What it counts if a rule that cuts it badly does not matter.
    pub(super) fn counts_whole(&self) -> Option<Size> {
        match self.fault {
            Some((SliverKind::Flat, _)) if self.normal != DVec3::ZERO => None,
            _ => self.counts(),
        }
    }
}

/// Measures faces in units in which no product of lengths leaves f64.
pub(super) struct Gauge {
    /// What brings a position to these units.
    pub(super) scale: f64,
    /// Scaled.
    pub(super) tolerance: f64,
    rule: Triangulator,
    /// Corners looked at so far.
    pub(super) work: u64,
}

impl Gauge {
    pub(super) fn new(mesh: &Mesh, tolerance: f64) -> Self {
        let scale = unit_scale(mesh.vertices.live().map(|v| mesh.positions[v as usize]));
        Self { scale, tolerance: tolerance * scale, rule: Triangulator::default(), work: 0 }
    }

    pub(super) fn at(&self, mesh: &Mesh, v: u32) -> DVec3 {
        mesh.positions[v as usize] * self.scale
    }

    pub(super) fn corners(&self, mesh: &Mesh, f: u32) -> Corners {
        let loop_ = mesh.loop_slots(mesh.face_halfedge[f as usize]).map(|h| mesh.origin[h as usize]);
        loop_.map(|v| (v, self.at(mesh, v))).collect()
    }

    /// Whether a face is a triangle that is far from being a sliver, in few steps.
    fn is_plainly_fine(&self, mesh: &Mesh, f: u32) -> bool {
        let h = mesh.face_halfedge[f as usize];
        let (n, p) = (mesh.next[h as usize], mesh.prev[h as usize]);
        if mesh.next[n as usize] != p {
            return false;
        }
        let [a, b, c] = [h, n, p].map(|h| self.at(mesh, mesh.origin[h as usize]));
        let (u, v) = (b - a, c - a);
        let edges = [u, v, c - b].map(DVec3::length_squared);
        let longest = edges[0].max(edges[1]).max(edges[2]);
        let shortest = edges[0].min(edges[1]).min(edges[2]);
        let square = self.tolerance * self.tolerance * 1.001;
        // Not where squares are near the end of f64.
        longest > 1e-100 && shortest > square && u.cross(v).length_squared() > square * longest
    }

    /// The face as a sliver, if it is one.
    pub(super) fn sliver(&mut self, mesh: &Mesh, f: u32) -> Option<Sliver> {
        if self.is_plainly_fine(mesh, f) {
            return None;
        }
        let corners = self.corners(mesh, f);
        let look = self.look(&corners);
        look.fault.map(|(kind, _)| Sliver {
            face: mesh.faces.key(f),
            kind,
            height: look.height / self.scale,
            place: corners.iter().map(|c| c.1 / corners.len() as f64).sum::<DVec3>() / self.scale,
        })
    }

    pub(super) fn look(&mut self, corners: &Corners) -> Look {
        let n = corners.len();
        self.work += n as u64;
        let first = corners[0].1;
        // The face's own units: a small face far from small coordinates keeps its digits.
        let unit = unit_scale(corners.iter().map(|c| c.1 - first));
        let points: SmallVec<[DVec3; 8]> = corners.iter().map(|c| (c.1 - first) * unit).collect();
        let edge = |i: usize| points[i].distance(points[(i + 1) % n]);
        let (mut shortest, mut longest) = ((edge(0), 0), (edge(0), 0));
        for i in 1..n {
            let length = edge(i);
            if length < shortest.0 {
                shortest = (length, i);
            }
            if length > longest.0 {
                longest = (length, i);
            }
        }
        let extent = if n == 3 { longest.0 } else { extent(&points) };
        let area = double_area_vector(points.iter().copied());
        let height = if extent > 0.0 { area.length() / extent / unit } else { 0.0 };
        let is_flat = height <= self.tolerance;
        let fault = if shortest.0 / unit <= self.tolerance {
            Some((SliverKind::Needle, shortest.1))
        } else if n == 3 {
            is_flat.then_some((SliverKind::Cap, longest.1))
        } else {
            (is_flat || self.is_cut_badly(corners)).then_some((SliverKind::Flat, 0))
        };
        let normal = if is_flat { DVec3::ZERO } else { direction(area) };
        Look { fault, size: Size(n as u32, (extent / unit).to_bits()), normal, height }
    }

    /// Whether the shared rule cuts off a triangle that has no height.
    fn is_cut_badly(&mut self, corners: &Corners) -> bool {
        let mut sorted = corners.clone();
        sorted.sort_unstable_by_key(|c| c.0);
        let slots: SmallVec<[u32; 8]> = corners.iter().map(|c| c.0).collect();
        let at = |v: u32| sorted[sorted.binary_search_by_key(&v, |c| c.0).unwrap_or(0)].1;
        let tolerance = self.tolerance;
        self.rule.triangulate(&slots, at).iter().any(|t| height(t.map(at)) <= tolerance)
    }
}

/// The height of a triangle over its longest edge.
pub(super) fn height([a, b, c]: [DVec3; 3]) -> f64 {
    let (u, v) = (b - a, c - a);
    let unit = unit_scale([u, v].into_iter());
    let (u, v) = (u * unit, v * unit);
    let longest = u.length().max(v.length()).max(u.distance(v));
    if longest > 0.0 { u.cross(v).length() / longest / unit } else { 0.0 }
}

/// The distance of two corners that are about as far from each other as any: at least 1 / √3 of the largest.
fn extent(points: &[DVec3]) -> f64 {
    let furthest = |from: DVec3| {
        points.iter().fold((0.0, from), |best: (f64, DVec3), &p| {
            let apart = p.distance(from);
            if apart > best.0 { (apart, p) } else { best }
        })
    };
    furthest(furthest(points[0]).1).0
}

/// The distance of a point from the segment between two others.
pub(super) fn to_segment(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    p.distance(a.lerp(b, share(p, a, b)))
}

/// Where on the segment from `a` to `b` a point is closest, from 0 to 1.
pub(super) fn share(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let unit = unit_scale([p - a, b - a].into_iter());
    let (along, to) = ((b - a) * unit, (p - a) * unit);
    let share = to.dot(along) / along.length_squared();
    if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 }
}
