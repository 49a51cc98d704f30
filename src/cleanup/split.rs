//! One vertex for each fan, one edge for each pair: the last step before the build.

use super::pool::Pool;
use crate::Polygons;
use crate::matching::{Matching, NONE};
use crate::report::{Element, Kind, Relation, Step};
use crate::topology::{FaceOf, fan_roots, next_corner};
use std::collections::BTreeMap;

/// Gives each fan of corners a vertex of its own, renumbers the vertices, and parts edges that would double another.
/// Returns how many vertices were added, and the relation of the soup's vertices to the result's.
pub(super) fn split(pool: &mut Pool<'_>, mates: &[u32]) -> (usize, Relation) {
    let before = pool.positions.len();
    let fans = Fans::new(pool, mates);
    fans.record(pool);
    let relation = fans.renumber(pool);
    part_parallel_edges(pool, mates);
    (pool.positions.len() - before, relation.widened(pool.positions.len()))
}

/// The fans of all corners.
struct Fans {
    /// For each corner its fan.
    of: Vec<u32>,
    /// For each fan its vertex in the pool.
    vertex: Vec<u32>,
    /// For each fan the lowest of the soup's vertices that its corners name.
    source: Vec<u32>,
    /// For each fan whether it shares one of the soup's vertices with another.
    shares: Vec<bool>,
    /// For each fan whether its corners name several of the soup's vertices.
    is_merged: Vec<bool>,
}

impl Fans {
    fn new(pool: &Pool<'_>, mates: &[u32]) -> Self {
        let face_of = FaceOf::new(&pool.polygons);
        let pairs = mates.iter().enumerate().filter(|&(c, &m)| m != NONE && m as usize > c);
        let pairs = pairs.map(|(c, &m)| (c, m as usize));
        let (of, count) = fan_roots(&pool.polygons, |c| face_of.face(c), pairs).labels();
        let mut fans = Self {
            of,
            vertex: vec![NONE; count],
            source: vec![NONE; count],
            shares: vec![false; count],
            is_merged: vec![false; count],
        };
        // The first fan to name each of the soup's vertices.
        let mut owner = vec![NONE; pool.soup.positions.len()];
        for (c, &fan) in fans.of.iter().enumerate() {
            let source = pool.named_at(c);
            fans.vertex[fan as usize] = pool.polygons.corners()[c];
            let lowest = &mut fans.source[fan as usize];
            fans.is_merged[fan as usize] |= *lowest != NONE && *lowest != source;
            *lowest = source.min(*lowest);
            match owner[source as usize] {
                NONE => owner[source as usize] = fan,
                first if first != fan => {
                    fans.shares[first as usize] = true;
                    fans.shares[fan as usize] = true;
                }
                _ => {}
            }
        }
        fans
    }

    /// Records the vertices that were one in the soup and become several; a merge of the weld that is merely taken back
    /// leaves no record.
    fn record(&self, pool: &mut Pool<'_>) {
        let mut count = vec![0u32; pool.positions.len()];
        for (fan, &v) in self.vertex.iter().enumerate() {
            count[v as usize] += u32::from(self.shares[fan]);
        }
        for v in (0..count.len()).filter(|&v| count[v] > 1) {
            let (element, place) = (Element::Vertex(pool.named(v as u32)), pool.positions[v]);
            pool.record(Step::SplitVertices, Kind::PinchedVertex, element, Some(place));
        }
    }

    /// Numbers the vertices anew: in the order of the lowest of the soup's vertices in each, and further fans around
    /// one of the soup's vertices at the end.
    fn renumber(&self, pool: &mut Pool<'_>) -> Relation {
        let mut first_fan = vec![NONE; pool.positions.len()];
        for (fan, &v) in self.vertex.iter().enumerate() {
            let first = &mut first_fan[v as usize];
            if *first == NONE || (self.source[fan], fan as u32) < (self.source[*first as usize], *first) {
                *first = fan as u32;
            }
        }
        // A vertex keeps its place with its first fan, or without any; other fans get one by their own source.
        let mut order: Vec<(u32, u32, u32)> = Vec::with_capacity(pool.positions.len());
        let mut appended = Vec::new();
        let mut taken = vec![false; pool.soup.positions.len()];
        for (v, &fan) in first_fan.iter().enumerate() {
            let source = pool.vertex_source[v];
            taken[source as usize] = true;
            order.push((source, v as u32, fan));
        }
        for (fan, &v) in self.vertex.iter().enumerate() {
            let source = self.source[fan];
            if first_fan[v as usize] == fan as u32 {
                continue;
            }
            if std::mem::replace(&mut taken[source as usize], true) {
                appended.push((source, v, fan as u32));
            } else {
                order.push((source, v, fan as u32));
            }
        }
        order.sort_unstable();
        order.extend(appended);

        let mut number_of_fan = vec![NONE; self.vertex.len()];
        let mut number_of_vertex = vec![NONE; pool.positions.len()];
        // What was cut stays at one place. A merge that is taken back goes where it was; but where two of the soup's
        // vertices stay merged, they stay where the weld put them, within its tolerance.
        let mut is_cut = vec![false; pool.positions.len()];
        pool.cut.iter().for_each(|&v| is_cut[v as usize] = true);
        let mut positions = Vec::with_capacity(order.len());
        let mut sources = Vec::with_capacity(order.len());
        for (number, &(source, v, fan)) in order.iter().enumerate() {
            let number = number as u32;
            if fan != NONE {
                number_of_fan[fan as usize] = number;
            }
            let is_first = fan == first_fan[v as usize];
            if is_first {
                number_of_vertex[v as usize] = number;
            }
            if is_first || is_cut[v as usize] || self.is_merged[fan as usize] {
                positions.push(pool.positions[v as usize]);
            } else {
                positions.push(pool.soup.positions[source as usize]);
            }
            sources.push(source);
        }

        let soup_vertices = pool.soup.positions.len();
        let mut named = vec![false; soup_vertices];
        let mut pairs: Vec<(u32, u32)> = Vec::with_capacity(self.of.len());
        for (c, &fan) in self.of.iter().enumerate() {
            let source = pool.named_at(c);
            named[source as usize] = true;
            pairs.push((source, number_of_fan[fan as usize]));
        }
        // What no corner names stays with the first fan of the vertex it was merged into.
        for (source, &v) in pool.vertex_of.iter().enumerate() {
            if !named[source] && v != NONE {
                pairs.push((source as u32, number_of_vertex[v as usize]));
            }
        }
        let mut corner = 0;
        pool.polygons.map_corners(|_| {
            corner += 1;
            number_of_fan[self.of[corner - 1] as usize]
        });
        pool.positions = positions;
        pool.vertex_source = sources;
        Relation::from_pairs(soup_vertices, pool.positions.len(), pairs)
    }
}

/// Where several pairs of faces, or open faces, still lie on one edge, all but the first get a vertex of their own at
/// its middle. Faces gain a corner.
fn part_parallel_edges(pool: &mut Pool<'_>, mates: &[u32]) {
    let matching = Matching::new(pool.positions.len(), &pool.polygons);
    let face_of = FaceOf::new(&pool.polygons);
    // For each corner whose half-edge is to be parted, the new vertex.
    let mut parted: BTreeMap<usize, u32> = BTreeMap::new();
    let doubled = (0..matching.edges.len()).filter(|&e| matching.edges[e].second().is_some());
    for e in doubled {
        let first = matching.edges[e].first();
        for c in matching.uses(e).skip(1) {
            let mate = mates[c] as usize;
            // The first use and its mate keep the edge; a later use goes with its own mate, which may come before it.
            if mate == first || parted.contains_key(&c) {
                continue;
            }
            let end = next_corner(&pool.polygons, face_of.face(c), c);
            let ends = [c, end].map(|c| pool.polygons.corners()[c]);
            let [a, b] = ends.map(|v| pool.positions[v as usize]);
            let vertex = pool.positions.len() as u32;
            let middle = a * 0.5 + b * 0.5;
            pool.positions.push(middle);
            pool.parted.push(ends);
            let [a, b] = ends.map(|v| pool.named(v));
            pool.vertex_source.push(a.min(b));
            let element = Element::Edge([a.min(b), a.max(b)]);
            pool.record(Step::SplitVertices, Kind::ParallelEdge, element, Some(middle));
            parted.insert(c, vertex);
            if mates[c] != NONE {
                parted.insert(mate, vertex);
            }
        }
    }
    insert_corners(pool, &parted);
}

/// Inserts a corner after each corner given, with the vertex given.
fn insert_corners(pool: &mut Pool<'_>, parted: &BTreeMap<usize, u32>) {
    if parted.is_empty() {
        return;
    }
    let mut polygons = Polygons::with_capacity(pool.polygons.len(), pool.corner_source.len() + parted.len());
    let mut sources = Vec::with_capacity(pool.corner_source.len() + parted.len());
    let mut c = 0;
    for face in pool.polygons.iter() {
        let mut corners = Vec::with_capacity(face.len() + 1);
        for &v in face {
            corners.push(v);
            sources.push(pool.corner_source[c]);
            if let Some(&middle) = parted.get(&c) {
                corners.push(middle);
                pool.middles.push(sources.len() as u32);
                sources.push(pool.corner_source[c]);
            }
            c += 1;
        }
        polygons.push(corners);
    }
    pool.polygons = polygons;
    pool.corner_source = sources;
}
