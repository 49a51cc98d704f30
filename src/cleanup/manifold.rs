//! From any vertex pool to pairs of half-edges that are wound alike.

use super::pair;
use super::pool::Pool;
use crate::matching::{Matching, NONE};
use crate::report::{Element, Kind, Record, Step, StepSummary};
use crate::topology::{FaceOf, duplicate_faces, flip_faces, next_corner, orient};
use glam::DVec3;

/// Drops faces that are there already. Whether there were any.
pub(super) fn drop_duplicates(pool: &mut Pool<'_>, matching: &Matching) -> bool {
    let duplicates = duplicate_faces(&pool.polygons, matching);
    let mut gone = vec![false; pool.polygons.len()];
    for &(face, _) in &duplicates {
        gone[face as usize] = true;
        record_face(pool, face, Step::DropDuplicates, Kind::DuplicateFace);
    }
    pool.report.add_step(StepSummary::new(Step::DropDuplicates, duplicates.len()));
    if !duplicates.is_empty() {
        pool.remove_faces(&gone);
    }
    !duplicates.is_empty()
}

/// Records a change to a face, by the face of the soup it comes from; once, if that became several.
fn record_face(pool: &mut Pool<'_>, face: u32, step: Step, kind: Kind) {
    let element = Element::Face(pool.face_source[face as usize]);
    let is_same = |r: &Record| (r.step, r.kind, r.element) == (step, kind, element);
    if !pool.report.records.last().is_some_and(is_same) {
        let place = pool.middle(&pool.soup.polygons[pool.face_source[face as usize] as usize]);
        pool.record(step, kind, element, place);
    }
}

/// Unifies windings, pairs the faces at edges with three or more, unifies again and cuts what cannot be oriented:
/// returns for each corner its mate across the edge, wound alike, or [`NONE`].
pub(super) fn make_manifold(pool: &mut Pool<'_>, matching: &Matching) -> Vec<u32> {
    let mut mates = matching.mates();
    let mut flipped = vec![false; pool.polygons.len()];
    let mut unify = |pool: &mut Pool<'_>, mates: &mut Vec<u32>| {
        let found = orient(&pool.polygons, &FaceOf::new(&pool.polygons), mates);
        for &c in &found.conflicts {
            let m = std::mem::replace(&mut mates[c as usize], NONE);
            mates[m as usize] = NONE;
        }
        let cut: Vec<[u32; 2]> = found.conflicts.iter().map(|&c| edge_of(pool, c as usize)).collect();
        pool.cut.extend(cut.as_flattened());
        flip_faces(&mut pool.polygons, Some(mates), &found.flip);
        flip_sources(pool, &found.flip);
        flipped.iter_mut().zip(&found.flip).for_each(|(all, &now)| *all ^= now);
        cut
    };
    let mut cut = Vec::new();
    if matching.any_conflict {
        cut = unify(pool, &mut mates);
    }
    let mut unpaired = 0;
    if !matching.more.is_empty() {
        // Flips have moved corners within their faces, so edges are matched again.
        let matching = Matching::new(pool.positions.len(), &pool.polygons);
        let face_of = FaceOf::new(&pool.polygons);
        let left = pair::pair_faces(&pool.polygons, &pool.positions, &matching, &face_of, &mut mates);
        for (e, left) in left {
            if left > 0 || !is_undone_weld(pool, &matching, &mates, e as usize) {
                let c = matching.edges[e as usize].first();
                record_edge(pool, edge_of(pool, c), Step::PairFaces, Kind::NonManifoldEdge);
            }
            unpaired += left as usize;
        }
        cut.extend(unify(pool, &mut mates));
    }
    if flipped.contains(&true) {
        pool.flipped.clone_from(&flipped);
    }
    for face in (0..flipped.len()).filter(|&f| flipped[f]) {
        record_face(pool, face as u32, Step::Unify, Kind::FlippedFace);
    }
    for edge in &cut {
        record_edge(pool, *edge, Step::CutEdges, Kind::CutEdge);
    }
    let changed = flipped.iter().filter(|f| **f).count();
    let steps = [(Step::Unify, changed), (Step::PairFaces, unpaired), (Step::CutEdges, cut.len())];
    pool.report.steps.extend(steps.map(|(step, changed)| StepSummary::new(step, changed)));
    mates
}

/// The two vertices of a corner's half-edge.
fn edge_of(pool: &Pool<'_>, corner: usize) -> [u32; 2] {
    let face = pool.polygons.starts().partition_point(|&s| s <= corner) - 1;
    [corner, next_corner(&pool.polygons, face as u32, corner)].map(|c| pool.polygons.corners()[c])
}

fn record_edge(pool: &mut Pool<'_>, [a, b]: [u32; 2], step: Step, kind: Kind) {
    let [p, q] = [a, b].map(|v| pool.positions[v as usize]);
    let [a, b] = [pool.named(a), pool.named(b)];
    let place: DVec3 = p * 0.5 + q * 0.5;
    pool.record(step, kind, Element::Edge([a.min(b), a.max(b)]), Some(place));
}

/// Moves the sources of corners along with the corners of reversed faces, which keep their first.
fn flip_sources(pool: &mut Pool<'_>, flip: &[bool]) {
    for face in (0..flip.len()).filter(|&f| flip[f]) {
        let range = pool.polygons.starts()[face] + 1..pool.polygons.starts()[face + 1];
        pool.corner_source[range].reverse();
    }
}

/// Whether an edge with three or more faces is not one in the soup: each pair of its faces names vertices there that no
/// other pair does, so only the weld brought them together.
fn is_undone_weld(pool: &Pool<'_>, matching: &Matching, mates: &[u32], edge: usize) -> bool {
    let mut named: Vec<(u32, u32)> = Vec::new();
    for c in matching.uses(edge) {
        let face = pool.polygons.starts().partition_point(|&s| s <= c) - 1;
        let pair = (c as u32).min(mates[c]);
        for c in [c, next_corner(&pool.polygons, face as u32, c)] {
            named.push((pool.named_at(c), pair));
        }
    }
    named.sort_unstable();
    named.dedup();
    named.windows(2).all(|w| w[0].0 != w[1].0)
}
