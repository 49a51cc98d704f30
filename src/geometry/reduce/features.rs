//! What must be kept: boundaries, seams, borders of groups, sharp edges, and what the caller locked.

use super::ReduceOptions;
use super::copy::Copy;
use super::quadric::Planes;
use crate::column::Kind;
use crate::{FeatureOptions, Mesh};
use glam::DVec3;

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
            let is_locked = || {
                options
                    .locked_vertices
                    .is_some_and(|is_locked| is_locked(mesh.vertices.key(self.vertex_slot[i])))
            };
            vertex.hold = match count[i] {
                _ if locked[i] || is_locked() => Hold::Fixed,
                0 => Hold::Free,
                2 => Hold::Line,
                _ => Hold::Fixed,
            };
        }
    }

    /// Sums up the planes at every vertex.
    pub(super) fn sum_planes(&mut self, line_weight: f64) {
        let mut first = vec![u32::MAX; self.vertices.len()];
        for h in 0..2 * self.edges.len() as u32 {
            first[self.origin(h) as usize] = h;
        }
        for (v, h) in first.into_iter().enumerate() {
            let fan = self.fan_around(h, line_weight);
            let memory = self.planes_around(h, |area| area, 1.0).into();
            let vertex = &mut self.vertices[v];
            (vertex.fan, vertex.memory) = (fan, memory);
        }
    }

    /// The planes that a collapse at the origin of a half-edge is to keep to.
    ///
    /// The weight of a face is more than its area, and [`Copy::candidate`] adds to that: what counts is the mean distance,
    /// not its square, and on smooth surfaces the one grows as the square root of the other. The exponents are measured.
    pub(super) fn fan_around(&self, first: u32, line_weight: f64) -> Planes {
        self.planes_around(first, weigh, line_weight)
    }

    /// The planes of the faces around the origin of a half-edge, each with a weight by its area, and those that stand
    /// upright on these faces along feature edges, by the square of the edge.
    fn planes_around(&self, first: u32, weigh: impl Fn(f64) -> f64, line_weight: f64) -> Planes {
        let mut planes = Planes::default();
        let at = self.vertex(self.origin(first)).position;
        let end = |h: u32| self.vertex(self.origin(h ^ 1)).position - at;
        let mut h = first;
        let mut along = end(h);
        loop {
            // The face to the right of this spoke lies between it and the next.
            let after = self.next(h ^ 1);
            let next_along = end(after);
            if !self.is_open(h ^ 1) {
                let double_area = next_along.cross(along);
                let square = double_area.length_squared();
                // Below, what rounding leaves of no area.
                if square > 1e-300 {
                    let length = square.sqrt();
                    planes = planes + Planes::one(double_area, weigh(0.5 * length) / square);
                    for (h, along) in [(h, along), (after, next_along)] {
                        if self.edges[h as usize >> 1].is_feature {
                            // A vanishing edge has no direction, and no weight either.
                            let upright = along.cross(double_area).normalize_or_zero();
                            let weight = line_weight * weigh(along.length_squared());
                            planes = planes + Planes::one(upright, weight);
                        }
                    }
                }
            }
            (h, along) = (after, next_along);
            if h == first {
                return planes;
            }
        }
    }
}

/// The weight of a face by its area.
#[inline]
fn weigh(area: f64) -> f64 {
    area * area.sqrt()
}

/// The plane of one face as it counts in a fan, times a factor.
#[inline]
pub(super) fn plane(double_area: DVec3, factor: f64) -> Planes {
    let square = double_area.length_squared();
    let weight = weigh(0.5 * square.sqrt()) / square;
    if square > 1e-300 { Planes::one(double_area, factor * weight) } else { Planes::default() }
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
