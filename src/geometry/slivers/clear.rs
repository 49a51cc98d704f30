//! Clearing the way: what stands in the way of an operator is split, which moves nothing.
//!
//! Where both ends of an edge are joined to a third vertex, one of those two edges gets a vertex on it; where two faces
//! would have the same corners, one gets a vertex inside. Neither may make a sliver.

use super::run::Run;
use super::shape::Corners;
use crate::matching::NONE;
use crate::{CollapseError, FaceKey};
use glam::DVec3;

impl Run {
    /// Splits what a collapse was refused for. Whether something was done.
    pub(super) fn clear_collapse(&mut self, h: u32, refusal: CollapseError) -> bool {
        match refusal {
            CollapseError::CommonNeighbor(v) => {
                let Some(v) = self.mesh.vertex_slot(v) else { return false };
                let ends = [h, h ^ 1].map(|h| self.mesh.origin[h as usize]);
                let edges = ends.map(|end| self.mesh.find_slot(end, v));
                edges.into_iter().flatten().any(|h| self.split_out(h >> 1))
            }
            CollapseError::CommonFace(f) => self.cut_up(f),
            CollapseError::Duplicate(f, g) => {
                [f, g].into_iter().any(|f| self.is_triangle_key(f) && self.poke(f))
            }
            _ => false,
        }
    }

    /// Splits what joins the corner of a cap to the face across its longest edge `h`. Whether something was done.
    pub(super) fn clear_merge(&mut self, h: u32) -> bool {
        let t = h ^ 1;
        let c = self.mesh.origin[self.mesh.prev[h as usize] as usize];
        if !self.mesh.is_triangle(t) {
            let g = self.mesh.faces.key(self.mesh.face[t as usize]);
            return self.cut_up(g);
        }
        let d = self.mesh.origin[self.mesh.prev[t as usize] as usize];
        match self.mesh.find_slot(c, d) {
            Some(h) => self.split_out(h >> 1),
            None => false,
        }
    }

    fn is_triangle_key(&self, f: FaceKey) -> bool {
        self.mesh.face_slot(f).is_some_and(|f| self.mesh.is_triangle(self.mesh.face_halfedge[f as usize]))
    }

    fn may_split(&self) -> bool {
        self.splits_left > 0
    }

    fn note_split(&mut self) -> bool {
        self.splits_left -= 1;
        self.account.splits += 1;
        true
    }

    /// Puts a vertex in the middle of an edge whose faces are and stay no slivers.
    fn split_out(&mut self, e: u32) -> bool {
        let ends = [2 * e, 2 * e + 1].map(|h| self.mesh.at(h));
        let middle = ends[0] * 0.5 + ends[1] * 0.5;
        let new = (NONE, middle * self.gauge.scale);
        for h in [2 * e, 2 * e + 1] {
            let f = self.mesh.face[h as usize];
            if f == NONE {
                continue;
            }
            let corners = self.gauge.corners(&self.mesh, f);
            if self.gauge.look(&corners).fault.is_some() {
                return false;
            }
            let from = self.mesh.origin[h as usize];
            let place = corners.iter().position(|c| c.0 == from).unwrap_or(0);
            let mut all = corners.clone();
            all.insert(place + 1, new);
            if corners.len() == 3 {
                // The middle and the two ends' parts.
                let apex = all[(place + 3) % 4];
                let halves: [Corners; 2] = [
                    [all[place], all[place + 1], apex].into_iter().collect(),
                    [all[place + 1], all[(place + 2) % 4], apex].into_iter().collect(),
                ];
                if halves.iter().any(|half| self.gauge.look(half).fault.is_some()) {
                    return false;
                }
            } else if self.gauge.look(&all).fault.is_some() {
                return false;
            }
        }
        let key = self.mesh.edges.key(e);
        self.may_split() && self.mesh.split_edge_and_faces(key, middle).is_ok() && self.note_split()
    }

    /// Cuts a larger face into triangles.
    fn cut_up(&mut self, f: FaceKey) -> bool {
        if !self.may_split() {
            return false;
        }
        let Ok(cut) = self.mesh.triangulate_face(f) else { return false };
        let parts = cut.cuts.iter().map(|c| c.face).chain([f]);
        // They may be slivers.
        parts.for_each(|part| self.look_at(part));
        !cut.cuts.is_empty() && self.note_split()
    }

    /// Puts a vertex in the middle of a face, if that makes no sliver and nothing turned over.
    pub(super) fn poke(&mut self, f: FaceKey) -> bool {
        let Some(slot) = self.mesh.face_slot(f) else { return false };
        let corners = self.gauge.corners(&self.mesh, slot);
        let (n, normal) = (corners.len(), self.gauge.look(&corners).normal);
        let middle: DVec3 = corners.iter().map(|c| self.mesh.positions[c.0 as usize] / n as f64).sum();
        let new = (NONE, middle * self.gauge.scale);
        let is_fit = (0..n).all(|i| {
            let part: Corners = [corners[i], corners[(i + 1) % n], new].into_iter().collect();
            let look = self.gauge.look(&part);
            look.fault.is_none() && look.normal.dot(normal) > 0.0
        });
        is_fit && self.may_split() && self.mesh.poke_face(f, middle).is_ok() && self.note_split()
    }
}
