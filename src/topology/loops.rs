//! Naked edges as loops and chains.

use super::{Topology, next_corner, prev_corner};

/// The naked edges of an indexed mesh, strung together.
///
/// They are strung through the fans of faces, so a pinched vertex gives two loops, not one that crosses itself. A loop
/// runs as its boundary half-edges do, against the winding of its faces; on a mesh of mixed winding, as that of its
/// first edge.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct NakedEdges {
    /// Closed loops as vertices; the first is not repeated at the end.
    pub loops: Vec<Vec<u32>>,
    /// Open chains as vertices, which end where the boundary meets an edge with three or more faces.
    pub chains: Vec<Vec<u32>>,
}

pub(super) fn naked_edges(topology: &Topology<'_>) -> NakedEdges {
    let edges = &topology.matching.edges;
    let mut done = vec![false; edges.len()];
    let mut found = NakedEdges::default();
    for e in 0..edges.len() {
        if edges[e].second().is_some() || done[e] {
            continue;
        }
        done[e] = true;
        // The boundary half-edge runs from `b` to `a`.
        let [a, b] = topology.corner_edge(edges[e].first());
        let mut vertices = vec![b, a];
        let mut at = e;
        let closed = loop {
            let end = vertices[vertices.len() - 1];
            match across_fan(topology, at, end) {
                Some(next) if next == e => break true,
                Some(next) => {
                    done[next] = true;
                    at = next;
                    vertices.push(other_end(topology, next, end));
                }
                None => break false,
            }
        };
        if closed {
            // The last edge came back to the first vertex.
            vertices.pop();
            found.loops.push(vertices);
            continue;
        }
        let mut before = Vec::new();
        let (mut at, mut end) = (e, b);
        while let Some(next) = across_fan(topology, at, end) {
            done[next] = true;
            end = other_end(topology, next, end);
            before.push(end);
            at = next;
        }
        before.reverse();
        before.append(&mut vertices);
        found.chains.push(before);
    }
    found
}

fn other_end(topology: &Topology<'_>, edge: usize, end: u32) -> u32 {
    let [a, b] = topology.corner_edge(topology.matching.edges[edge].first());
    if a == end { b } else { a }
}

/// The naked edge at the other side of the fan of faces that begins at naked edge `edge` around vertex `v`, or `None`
/// if the fan ends at an edge with three or more faces. A naked edge may lie on both sides only of one face: then the
/// fan is that face.
fn across_fan(topology: &Topology<'_>, edge: usize, v: u32) -> Option<usize> {
    let polygons = topology.mesh.polygons();
    let mut along = topology.matching.edges[edge].first();
    loop {
        // `along` is a corner whose half-edge has `v` as one end; step to the other half-edge of its face at `v`.
        let face = topology.face_of.face(along);
        let other = if polygons.corners()[along] == v {
            prev_corner(polygons, face, along)
        } else {
            next_corner(polygons, face, along)
        };
        let e = topology.matching.edge_of(other);
        let uses = &topology.matching.edges[e];
        match uses.second() {
            None => return Some(e),
            Some(_) if topology.matching.is_nonmanifold(e) => return None,
            Some(second) => along = if second == other { uses.first() } else { second },
        }
    }
}
