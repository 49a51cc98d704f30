//! The reduced copy back onto the mesh.

use super::copy::Copy;
use super::run::Step;
use crate::matching::NONE;
use crate::{Mesh, VertexKey};

impl Copy {
    /// The live vertex that each vertex went into, or itself.
    pub(super) fn roots(&self) -> Vec<u32> {
        let mut roots: Vec<u32> = (0..)
            .zip(&self.spots)
            .map(|(v, spot): (u32, _)| if spot.is_dead() { spot.link } else { v })
            .collect();
        for v in 0..roots.len() {
            let mut root = roots[v];
            while roots[root as usize] != root {
                root = roots[root as usize];
            }
            let mut v = v;
            while roots[v] != root {
                v = std::mem::replace(&mut roots[v], root) as usize;
            }
        }
        roots
    }

    /// Each vertex that is gone with the one that it went into in the end, in the order of the mesh's slots.
    pub(super) fn merged(&self, mesh: &Mesh, roots: &[u32]) -> Vec<(VertexKey, VertexKey)> {
        let mut into = vec![NONE; mesh.vertices.slot_count()];
        for (v, &root) in roots.iter().enumerate() {
            if root as usize != v {
                into[self.vertex_slot[v] as usize] = self.vertex_slot[root as usize];
            }
        }
        let gone = (0..).zip(&into).filter(|pair| *pair.1 != NONE);
        gone.map(|(v, &root): (u32, _)| (mesh.vertices.key(v), mesh.vertices.key(root))).collect()
    }

    fn slot(&self, h: u32) -> u32 {
        2 * self.edge_slot[h as usize >> 1] + (h & 1)
    }
}

impl Mesh {
    /// Does the collapses again, one by one, so that columns, checkpoints and listeners see them.
    pub(super) fn replay(&mut self, copy: &Copy, log: Vec<Step>) {
        for Step { halfedge, place } in log {
            let halfedge = copy.slot(halfedge);
            let stays = self.origin[halfedge as usize ^ 1] as usize;
            let position = place.map_or(self.positions[stays], |p| copy.frame.global(p));
            debug_assert_eq!(self.check_collapse(self.halfedge_key(halfedge), position), Ok(()));
            self.collapse_checked(halfedge, position);
        }
    }

    /// Takes the links over as they are: for a mesh without user data, checkpoints and listeners.
    pub(super) fn take_over(&mut self, copy: &mut Copy) {
        let mut number = vec![NONE; self.edges.slot_count()];
        (0..).zip(&copy.edge_slot).for_each(|(i, &e)| number[e as usize] = i);
        let mut is_left = vec![false; self.faces.slot_count()];
        for i in 0..copy.edges.len() {
            if copy.edges[i].is_dead() {
                continue;
            }
            for (side, end) in copy.edges[i].ends().into_iter().enumerate() {
                let h = copy.slot(2 * i as u32 + side as u32);
                let (next, v) = (copy.slot(copy.edges[i].next(side)), copy.vertex_slot[end as usize]);
                let (f, at) = (copy.faces[i][side], h as usize);
                self.next[at] = next;
                self.prev[next as usize] = h;
                self.origin[at] = v;
                self.face[at] = f;
                match is_left.get_mut(f as usize) {
                    Some(left) => *left = true,
                    None => self.vertex_halfedge[v as usize] = h,
                }
            }
        }
        for (edge, &e) in copy.edges.iter().zip(&copy.edge_slot) {
            // A vertex inside keeps its half-edge if that is left, and otherwise takes any.
            if !edge.is_dead() {
                for h in [2 * e, 2 * e + 1] {
                    let out = &mut self.vertex_halfedge[self.origin[h as usize] as usize];
                    let is_dead = copy.edges[number[*out as usize >> 1] as usize].is_dead();
                    if is_dead || self.origin[*out as usize] != self.origin[h as usize] {
                        *out = h;
                    }
                }
            }
        }
        for f in 0..is_left.len() as u32 {
            if is_left[f as usize] {
                let first = self.face_halfedge[f as usize];
                let now = copy.whole().successor(2 * number[first as usize >> 1] + (first & 1));
                self.face_halfedge[f as usize] = copy.slot(now);
            } else if self.faces.is_live(f) {
                self.faces.remove(f);
            }
        }
        for (edge, &slot) in copy.edges.iter().zip(&copy.edge_slot) {
            if edge.is_dead() {
                self.edges.remove(slot);
            }
        }
        for (spot, &slot) in copy.spots.iter().zip(&copy.vertex_slot) {
            if spot.is_dead() {
                self.vertices.remove(slot);
            } else if spot.is_moved() {
                self.positions[slot as usize] = copy.frame.global(spot.position);
            }
        }
    }
}
