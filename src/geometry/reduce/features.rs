//! What must be kept: boundaries, seams, borders of groups, sharp edges, and what the caller locked.

use super::copy::Copy;
use super::part::Part;
use super::quadric::Planes;
use super::{ReduceError, ReduceOptions};
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
        let is_sharp = sharp_edges(mesh, options.sharp_degrees);
        let has_locked = !options.locked_edges.is_empty();
        let mut locked_edges = vec![false; if has_locked { mesh.edges.slot_count() } else { 0 }];
        for e in options.locked_edges.iter().filter_map(|&e| mesh.edge_slot(e)) {
            locked_edges[e as usize] = true;
        }
        let mut count = vec![0u8; self.spots.len()];
        let mut locked = vec![false; self.spots.len()];
        let has_others = has_locked
            || !is_sharp.is_empty()
            || mesh.columns.each(Kind::Corner).next().is_some()
            || mesh.columns.each(Kind::Face).next().is_some();
        for i in 0..self.edges.len() {
            if !has_others && !self.edges[i].is_open() {
                continue;
            }
            let e = self.edge_slot[i];
            let sides = [2 * e as usize, 2 * e as usize + 1];
            let [left, right] = self.faces[i];
            let inner = sides.iter().all(|&h| mesh.face[h] != crate::matching::NONE);
            let is_locked = locked_edges.get(e as usize).is_some_and(|&locked| locked);
            let is_feature = !inner
                || is_locked
                || is_sharp.get(e as usize).is_some_and(|&sharp| sharp)
                || options.keep_seams && mesh.is_seam_of_any(e)
                || options.keep_groups && mesh.is_group_border(left, right);
            if is_feature {
                self.edges[i].set_feature();
                for v in self.edges[i].ends().map(|v| v as usize) {
                    count[v] = count[v].saturating_add(1);
                    locked[v] |= is_locked;
                }
            }
        }
        let mut locked_vertices = vec![false; mesh.vertices.slot_count()];
        for v in options.locked_vertices.iter().filter_map(|&v| mesh.vertex_slot(v)) {
            locked_vertices[v as usize] = true;
        }
        for (i, spot) in self.spots.iter_mut().enumerate() {
            spot.set_hold(match count[i] {
                _ if locked[i] || locked_vertices[self.vertex_slot[i] as usize] => Hold::Fixed,
                0 => Hold::Free,
                2 => Hold::Line,
                _ => Hold::Fixed,
            });
        }
    }
}

impl Part<'_> {
    /// The planes that a collapse at the origin of a half-edge is to keep to.
    ///
    /// The weight of a face is more than its area, and [`Copy::candidate`] adds to that: what counts is the mean distance,
    /// not its square, and on smooth surfaces the one grows as the square root of the other. The exponents are measured.
    pub(super) fn fan_around(&self, first: u32, line_weight: f64) -> Planes {
        let mut fan = Planes::default();
        self.each_around(first, |square, double_area, along| match along {
            None => fan = fan + Planes::one(double_area, weight(square)),
            Some(along) => {
                fan = fan + upright(along, double_area, line_weight * weigh(along.length_squared()))
            }
        });
        fan
    }

    /// Adds the planes of each face to those of its corners, and to those that the error is told from, which count by area;
    /// returns a half-edge of each face that is not all here.
    pub(super) fn add_planes(&mut self, line_weight: f64) -> Vec<u32> {
        let edges = self.first_edge..self.first_edge + self.edges.len() as u32;
        let vertices = self.first_vertex..self.first_vertex + self.spots.len() as u32;
        let mut others = Vec::new();
        for h in 2 * edges.start..2 * edges.end {
            if self.is_open(h) {
                continue;
            }
            let n = self.next(h);
            if n < h {
                continue;
            }
            if !edges.contains(&(n >> 1)) {
                others.push(h);
                continue;
            }
            let p = self.next(n);
            if p < h {
                continue;
            }
            let is_here = |&v: &u32| vertices.contains(&v);
            if edges.contains(&(p >> 1)) && [h, n, p].map(|h| self.origin(h)).iter().all(is_here) {
                self.add_face([h, n, p], line_weight);
            } else {
                others.push(h);
            }
        }
        others
    }

    /// Adds the planes of one face.
    pub(super) fn add_face(&mut self, sides: [u32; 3], line_weight: f64) {
        let corners = sides.map(|h| self.origin(h));
        let [a, b, c] = corners.map(|v| self.spot(v).position);
        let double_area = (b - a).cross(c - a);
        let square = double_area.length_squared();
        if square <= NO_AREA {
            return;
        }
        let area = 0.5 * square.sqrt();
        let face = Planes::one(double_area, 0.25 / area);
        let counts = face * area.sqrt();
        for v in corners {
            self.add(v, counts, face);
        }
        for (i, h) in sides.into_iter().enumerate() {
            if self.is_feature(h) {
                let along = [b - a, c - b, a - c][i];
                let length_squared = along.length_squared();
                let plane = upright(along, double_area, 1.0);
                let counts = plane * (line_weight * weigh(length_squared));
                for v in [corners[i], corners[(i + 1) % 3]] {
                    self.add(v, counts, plane * length_squared);
                }
            }
        }
    }

    #[inline(always)]
    fn add(&mut self, v: u32, counts: Planes, plane: Planes) {
        let fan = self.fan_mut(v);
        *fan = *fan + counts;
        let origin = self.origin_mut(v);
        *origin = *origin + plane;
    }

    /// Visits the faces around the origin of a half-edge: the square of twice the area and twice the area vector, and then
    /// the same with each of its feature edges that start there.
    #[inline(always)]
    fn each_around(&self, first: u32, mut visit: impl FnMut(f64, DVec3, Option<DVec3>)) {
        let at = self.spot(self.origin(first)).position;
        let mut h = first;
        let (mut end, mut next) = self.around(h);
        let mut along = self.spot(end).position - at;
        loop {
            // The face to the right of this spoke lies between it and the next.
            let after = next;
            (end, next) = self.around(after);
            let next_along = self.spot(end).position - at;
            if !self.is_open(h ^ 1) {
                let double_area = next_along.cross(along);
                let square = double_area.length_squared();
                if square > NO_AREA {
                    visit(square, double_area, None);
                    for (h, along) in [(h, along), (after, next_along)] {
                        if self.is_feature(h) {
                            visit(square, double_area, Some(along));
                        }
                    }
                }
            }
            (h, along) = (after, next_along);
            if h == first {
                return;
            }
        }
    }
}

/// The plane that stands upright on a face along an edge. A vanishing edge has no direction, and no weight either.
fn upright(along: DVec3, double_area: DVec3, weight: f64) -> Planes {
    Planes::one(along.cross(double_area).normalize_or_zero(), weight)
}

/// The square of twice an area, below which it is what rounding leaves of none.
const NO_AREA: f64 = 1e-300;

/// The weight of a face by its area.
#[inline]
fn weigh(area: f64) -> f64 {
    area * area.sqrt()
}

/// The weight of a face in a fan, over the square of twice its area, by that square.
#[inline(always)]
pub(super) fn weight(square: f64) -> f64 {
    // The area to the power of 3/2, over its square and four.
    if square > NO_AREA { 0.25 / (0.5 * square.sqrt()).sqrt() } else { 0.0 }
}

/// By slot; empty if none is asked for.
fn sharp_edges(mesh: &Mesh, degrees: Option<f64>) -> Vec<bool> {
    let Some(degrees) = degrees else { return Vec::new() };
    let mut sharp = vec![false; mesh.edges.slot_count()];
    for e in mesh.feature_edges(FeatureOptions { degrees, boundary: false }) {
        if let Some(e) = mesh.edge_slot(e) {
            sharp[e as usize] = true;
        }
    }
    sharp
}

impl Mesh {
    /// Whether what is locked is there.
    pub(super) fn check_locks(&self, options: &ReduceOptions<'_>) -> Result<(), ReduceError> {
        let dead_vertex = options.locked_vertices.iter().find(|&&v| !self.contains_vertex(v));
        let dead_edge = options.locked_edges.iter().find(|&&e| !self.contains_edge(e));
        match (dead_vertex, dead_edge) {
            (Some(&v), _) => Err(ReduceError::MissingVertex(v)),
            (_, Some(&e)) => Err(ReduceError::MissingEdge(e)),
            (None, None) => Ok(()),
        }
    }

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::IndexedMesh;
    use glam::dvec3;

    #[test]
    fn planes_summed_by_face_are_those_summed_around_each_vertex() -> Result<(), Box<dyn std::error::Error>> {
        let hill = |i: u32| dvec3(f64::from(i % 8), f64::from(i / 8), f64::from(i * i % 7) * 0.3);
        let squares = (0..49).map(|i| i / 7 * 8 + i % 7);
        let triangles: Vec<_> = squares.flat_map(|a| [[a, a + 1, a + 9], [a, a + 9, a + 8]]).collect();
        let mesh = Mesh::build(&IndexedMesh::from_triangles((0..64).map(hill).collect(), &triangles)?)?;
        let mut copy = Copy::of(&mesh);
        copy.mark(&mesh, &ReduceOptions { sharp_degrees: Some(40.0), ..Default::default() });
        copy.sum_planes(10.0, false);
        let part = copy.whole();
        let starts = (0..).zip(part.edges.iter()).flat_map(|(e, edge): (u32, _)| (2 * e..).zip(edge.ends()));
        for (h, v) in starts {
            let (summed, around) = (*part.fan(v), part.fan_around(h, 10.0));
            let difference = summed - around;
            for x in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::ONE] {
                let off = difference.about(x).at_origin().abs();
                assert!(off <= 1e-12 * around.weight(), "{v}: {off}");
            }
        }
        Ok(())
    }
}
