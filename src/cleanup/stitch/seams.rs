//! Naked edges, their ends, and what is around those.

use crate::Polygons;
use crate::geometry::unit_scale;
use crate::matching::{Matching, NONE};
use crate::topology::{FaceOf, next_corner, prev_corner};
use glam::DVec3;

/// A naked edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Naked {
    /// The corner it runs from.
    pub(super) corner: u32,
    pub(super) face: u32,
    /// Its ends, in the direction of the face.
    pub(super) ends: [u32; 2],
}

/// The naked edges of a pool and their ends, which are numbered on their own, in the pool's order.
pub(super) struct Seams<'p> {
    pub(super) polygons: &'p Polygons,
    face_of: FaceOf,
    /// In the order of corners.
    pub(super) edges: Vec<Naked>,
    /// For each end its vertex in the pool.
    pub(super) vertex: Vec<u32>,
    /// For each vertex of the pool its number here, or [`NONE`].
    number: Vec<u32>,
    /// Where the corners of each end begin in `corners`.
    starts: Vec<u32>,
    corners: Vec<u32>,
    /// Where all vertices of the pool are; lengths are scaled by `scale`.
    positions: &'p [DVec3],
    pub(super) scale: f64,
    /// How far anything may move, scaled.
    pub(super) reach: f64,
}

impl<'p> Seams<'p> {
    pub(super) fn new(
        positions: &'p [DVec3],
        polygons: &'p Polygons,
        matching: &Matching,
        tolerance: f64,
    ) -> Self {
        let face_of = FaceOf::new(polygons);
        let vertices = polygons.corners();
        let mut naked: Vec<u32> =
            matching.edges.iter().filter(|e| e.second().is_none()).map(|e| e.first() as u32).collect();
        naked.sort_unstable();
        let ends = |c: u32| {
            let end = next_corner(polygons, face_of.face(c as usize), c as usize);
            [vertices[c as usize], vertices[end]]
        };
        let mut number = vec![NONE; positions.len()];
        naked.iter().flat_map(|&c| ends(c)).for_each(|v| number[v as usize] = 0);
        let vertex: Vec<u32> = (0..positions.len() as u32).filter(|&v| number[v as usize] == 0).collect();
        (0..).zip(&vertex).for_each(|(i, &v)| number[v as usize] = i);
        let edge = |&corner: &u32| Naked {
            corner,
            face: face_of.face(corner as usize),
            ends: ends(corner).map(|v| number[v as usize]),
        };
        let edges = naked.iter().map(edge).collect();

        let mut starts = vec![0u32; vertex.len() + 1];
        let of = |v: &u32| Some(number[*v as usize]).filter(|&i| i != NONE);
        vertices.iter().filter_map(of).for_each(|i| starts[i as usize + 1] += 1);
        (0..vertex.len()).for_each(|i| starts[i + 1] += starts[i]);
        let mut corners = vec![0; starts[vertex.len()] as usize];
        let mut place = starts.clone();
        for (c, v) in (0u32..).zip(vertices) {
            if let Some(i) = of(v) {
                corners[place[i as usize] as usize] = c;
                place[i as usize] += 1;
            }
        }
        let scale = unit_scale(positions.iter().copied());
        // Scaled, nothing is farther apart than this.
        let reach = (tolerance * scale).min(16.0);
        Self { polygons, face_of, edges, vertex, number, starts, corners, positions, scale, reach }
    }

    pub(super) fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// Where an end is, scaled.
    pub(super) fn at(&self, end: u32) -> DVec3 {
        self.positions[self.vertex[end as usize] as usize] * self.scale
    }

    /// The number of an end by its vertex.
    pub(super) fn number(&self, vertex: u32) -> Option<u32> {
        Some(self.number[vertex as usize]).filter(|&i| i != NONE)
    }

    /// The corners at an end.
    pub(super) fn corners_at(&self, end: u32) -> &[u32] {
        &self.corners[self.starts[end as usize] as usize..self.starts[end as usize + 1] as usize]
    }

    pub(super) fn face(&self, corner: u32) -> u32 {
        self.face_of.face(corner as usize)
    }

    /// The vertices before and behind a corner in its face.
    pub(super) fn beside(&self, corner: u32) -> [u32; 2] {
        let (face, c) = (self.face(corner), corner as usize);
        let vertices = self.polygons.corners();
        [vertices[prev_corner(self.polygons, face, c)], vertices[next_corner(self.polygons, face, c)]]
    }

    /// The vertex opposite a naked edge of a triangle, with its place.
    pub(super) fn apex(&self, edge: Naked) -> Option<(u32, DVec3)> {
        let is_triangle = self.polygons[edge.face as usize].len() == 3;
        let apex = is_triangle.then(|| self.beside(edge.corner)[0])?;
        Some((apex, self.positions[apex as usize] * self.scale))
    }
}
