//! The reduced copy back onto the mesh.

use super::copy::Copy;
use super::run::Step;
use crate::matching::NONE;
use crate::{Mesh, VertexKey};

impl Copy {
    /// Each vertex that is gone with the one that it went into in the end, in the order of the mesh's slots.
    pub(super) fn merged(&mut self, mesh: &Mesh) -> Vec<(VertexKey, VertexKey)> {
        let mut pairs = Vec::new();
        for v in 0..self.vertices.len() as u32 {
            let root = self.root(v);
            if root != v {
                pairs.push((self.vertex_slot[v as usize], self.vertex_slot[root as usize]));
            }
        }
        pairs.sort_unstable();
        pairs.into_iter().map(|(v, w)| (mesh.vertices.key(v), mesh.vertices.key(w))).collect()
    }

    /// The live vertex that a vertex went into; what lies on the way is led there directly.
    pub(super) fn root(&mut self, v: u32) -> u32 {
        let mut root = v;
        while self.vertex(root).into != NONE {
            root = self.vertex(root).into;
        }
        let mut v = v;
        while v != root {
            v = std::mem::replace(&mut self.vertices[v as usize].into, root);
        }
        root
    }

    fn slot(&self, h: u32) -> u32 {
        2 * self.edge_slot[h as usize >> 1] + (h & 1)
    }
}

impl Mesh {
    /// Does the collapses again, one by one, so that columns, checkpoints and listeners see them.
    pub(super) fn replay(&mut self, copy: &Copy, log: Vec<Step>) {
        for Step { halfedge, place } in log {
            let stays = self.origin[halfedge as usize ^ 1] as usize;
            let position = place.map_or(self.positions[stays], |p| copy.frame.global(p));
            debug_assert_eq!(self.check_collapse(self.halfedge_key(halfedge), position), Ok(()));
            self.collapse_checked(halfedge, position);
        }
    }

    /// Takes the links over as they are: for a mesh without user data, checkpoints and listeners.
    pub(super) fn take_over(&mut self, copy: &Copy) {
        let mut number = vec![NONE; self.edges.slot_count()];
        (0..).zip(&copy.edge_slot).for_each(|(i, &e)| number[e as usize] = i);
        let mut is_left = vec![false; self.faces.slot_count()];
        for (i, (edge, &slot)) in copy.edges.iter().zip(&copy.edge_slot).enumerate() {
            if edge.is_dead {
                continue;
            }
            for side in 0..2 {
                let (h, at) = (2 * i as u32 + side, (2 * slot + side) as usize);
                let v = copy.vertex_slot[copy.origin(h) as usize];
                let f = copy.faces[i][side as usize];
                self.next[at] = copy.slot(copy.next(h));
                self.prev[at] = copy.slot(copy.prev(h));
                self.origin[at] = v;
                self.face[at] = f;
                match is_left.get_mut(f as usize) {
                    Some(left) => *left = true,
                    None => self.vertex_halfedge[v as usize] = at as u32,
                }
            }
        }
        for (i, &e) in copy.edge_slot.iter().enumerate() {
            // A vertex inside keeps its half-edge if that is left, and otherwise takes any.
            if !copy.edges[i].is_dead {
                for h in [2 * e, 2 * e + 1] {
                    let out = &mut self.vertex_halfedge[self.origin[h as usize] as usize];
                    let is_dead = copy.edges[number[*out as usize >> 1] as usize].is_dead;
                    if is_dead || self.origin[*out as usize] != self.origin[h as usize] {
                        *out = h;
                    }
                }
            }
        }
        for f in 0..is_left.len() as u32 {
            if is_left[f as usize] {
                let first = self.face_halfedge[f as usize];
                let now = copy.successor(2 * number[first as usize >> 1] + (first & 1));
                self.face_halfedge[f as usize] = copy.slot(now);
            } else if self.faces.is_live(f) {
                self.faces.remove(f);
            }
        }
        for (edge, &slot) in copy.edges.iter().zip(&copy.edge_slot) {
            if edge.is_dead {
                self.edges.remove(slot);
            }
        }
        for (vertex, &slot) in copy.vertices.iter().zip(&copy.vertex_slot) {
            if vertex.into != NONE {
                self.vertices.remove(slot);
            } else if vertex.is_moved {
                self.positions[slot as usize] = copy.frame.global(vertex.position);
            }
        }
    }
}
