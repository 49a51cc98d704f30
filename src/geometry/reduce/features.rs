//! What must be kept: boundaries, seams, borders of groups, sharp edges, and what the caller locked.

use super::ReduceOptions;
use super::copy::Copy;
use super::quadric::Quadric;
use crate::column::Kind;
use crate::{FeatureOptions, Mesh};

/// What holds a vertex of the copy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Hold {
    /// Nothing: it may go anywhere.
    #[default]
    Free,
    /// Two feature edges: it stays on the line they make.
    Line,
    /// It stays, and stays where it is: a feature ends or branches here, or the caller locked it.
    Fixed,
}

impl Copy {
    /// Marks feature edges and holds the vertices at them.
    pub(super) fn mark(&mut self, mesh: &Mesh, options: &ReduceOptions<'_>) {
        let is_sharp = sharp_edges(mesh, options.sharp_angle);
        let mut count = vec![0u8; self.vertices.len()];
        let mut locked = vec![false; self.vertices.len()];
        for i in 0..self.edges.len() {
            let e = self.edge_slot[i];
            let sides = [2 * e as usize, 2 * e as usize + 1];
            let [left, right] = self.faces[i];
            let inner = sides.iter().all(|&h| mesh.face[h] != crate::matching::NONE);
            let is_locked = options.locked_edges.is_some_and(|is_locked| is_locked(mesh.edges.key(e)));
            let is_feature = !inner
                || is_locked
                || is_sharp.get(e as usize).is_some_and(|&sharp| sharp)
                || options.keep_seams && mesh.is_seam_of_any(e)
                || options.keep_groups && mesh.is_group_border(left, right);
            self.edges[i].is_feature = is_feature;
            for side in 0..2 {
                let v = self.origin(2 * i as u32 + side) as usize;
                count[v] = count[v].saturating_add(u8::from(is_feature));
                locked[v] |= is_locked;
            }
        }
        for (i, vertex) in self.vertices.iter_mut().enumerate() {
            let is_locked =
                || options.locked_vertices.is_some_and(|is_locked| is_locked(mesh.vertices.key(self.vertex_slot[i])));
            vertex.hold = match count[i] {
                _ if locked[i] || is_locked() => Hold::Fixed,
                0 => Hold::Free,
                2 => Hold::Line,
                _ => Hold::Fixed,
            };
        }
    }

    /// Gives every vertex the planes of its faces, by area, and those that stand on its feature edges.
    pub(super) fn sum_quadrics(&mut self, line_weight: f64) {
        for h in 0..2 * self.edges.len() as u32 {
            if self.is_open(h) {
                continue;
            }
            let (n, p) = (self.next(h), self.prev(h));
            let corners = [h, n, p].map(|h| self.origin(h));
            let [a, b, c] = corners.map(|v| self.vertex(v).position);
            let double_area = (b - a).cross(c - a);
            let length = double_area.length();
            if length > 0.0 && h < n && h < p {
                self.add(&corners, Quadric::plane(double_area / length, 0.5 * length));
            }
            if self.edges[h as usize >> 1].is_feature && length > 0.0 {
                // Upright on the face, through the edge.
                let along = b - a;
                let upright = along.cross(double_area / length);
                self.add(&corners[..2], Quadric::plane(upright, line_weight));
            }
        }
    }

    fn add(&mut self, vertices: &[u32], plane: Quadric) {
        for &v in vertices {
            let vertex = &mut self.vertices[v as usize];
            vertex.quadric = vertex.quadric + plane;
        }
    }
}

/// By slot; empty if none is asked for.
fn sharp_edges(mesh: &Mesh, angle: Option<f64>) -> Vec<bool> {
    let Some(angle) = angle else { return Vec::new() };
    let mut sharp = vec![false; mesh.edges.slot_count()];
    for e in mesh.feature_edges(FeatureOptions { angle, boundary: false }) {
        if let Some(e) = mesh.edge_slot(e) {
            sharp[e as usize] = true;
        }
    }
    sharp
}

impl Mesh {
    /// Whether any column on corners, normals aside, differs across an inner edge.
    fn is_seam_of_any(&self, e: u32) -> bool {
        let normals = self.carried.corner_normals.map(|c| c.index);
        let (h, t) = (2 * e, 2 * e + 1);
        let (after, across) = (self.next[h as usize], self.next[t as usize]);
        let mut columns = self.columns.each(Kind::Corner).filter(|(i, _)| Some(*i) != normals);
        columns.any(|(_, c)| !c.is_same(h, across) || !c.is_same(t, after))
    }

    fn is_group_border(&self, f: u32, g: u32) -> bool {
        let groups = self.carried.groups.map(|c| c.index);
        self.columns.each(Kind::Face).any(|(i, c)| Some(i) == groups && !c.is_same(f, g))
    }
}
