//! The fans around a vertex: its corners, joined where their faces share an edge.

use super::{Topology, UnionFind, next_corner};
use crate::Polygons;

/// Corners joined into fans by the given pairs of corners that share an edge. Corners at one vertex belong to one fan
/// if a chain of such edges leads from one to the other.
pub(crate) fn fan_roots(
    polygons: &Polygons,
    face_of: impl Fn(usize) -> u32,
    pairs: impl Iterator<Item = (usize, usize)>,
) -> UnionFind {
    let corners = polygons.corners();
    let mut fans = UnionFind::new(corners.len());
    for (a, b) in pairs {
        let (a_end, b_end) = (next_corner(polygons, face_of(a), a), next_corner(polygons, face_of(b), b));
        if corners[a] == corners[b] {
            fans.join(a as u32, b as u32);
            fans.join(a_end as u32, b_end as u32);
        } else {
            fans.join(a as u32, b_end as u32);
            fans.join(a_end as u32, b as u32);
        }
    }
    fans
}

pub(super) fn pinched_vertices(topology: &Topology<'_>) -> Vec<(u32, u32)> {
    let polygons = topology.mesh.polygons();
    let pairs = (0..topology.edge_count()).flat_map(|e| {
        let first = topology.matching.edges[e].first();
        topology.matching.uses(e).skip(1).map(move |c| (first, c))
    });
    let mut fans = fan_roots(polygons, |c| topology.face_of.face(c), pairs);
    let mut count = vec![0u32; topology.mesh.vertex_count()];
    for (c, &v) in polygons.corners().iter().enumerate() {
        count[v as usize] += u32::from(fans.root(c as u32) as usize == c);
    }
    (0..).zip(count).filter(|&(_, fans)| fans > 1).collect()
}
