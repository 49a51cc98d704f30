//! The columns of the user through weld and unweld.

use crate::Mesh;
use crate::cleanup::Sources;
use crate::column::{Columns, Event, Kind, Origin};
use crate::matching::NONE;
use crate::report::Relation;

impl Mesh {
    /// For each corner the number of its edge, as corners first use them, and how many edges there are.
    fn edges_of_corners(&self) -> (Vec<u32>, usize) {
        let mut number = vec![NONE; self.edges.slot_count()];
        let mut edges = 0;
        let of = |h: u32| {
            let number = &mut number[h as usize >> 1];
            if *number == NONE {
                *number = edges;
                edges += 1;
            }
            *number
        };
        let list = self.ordered_slots(Kind::Corner).into_iter().map(of).collect();
        (list, edges as usize)
    }

    /// For each corner the one after it in its face.
    fn corners_after(&self) -> Vec<u32> {
        let mut after = Vec::with_capacity(2 * self.edge_count());
        for f in self.faces.in_user_order() {
            let first = after.len() as u32;
            let n = self.loop_slots(self.face_halfedge[f as usize]).count() as u32;
            after.extend((first + 1..first + n).chain([first]));
        }
        after
    }
}

/// The columns of a mesh on what was welded of it.
pub(super) fn welded(old: &Mesh, new: &Mesh, vertices: &Relation, sources: &Sources) -> Columns {
    let mut columns = old.user_columns();
    if columns.is_empty() {
        return columns;
    }
    let after = new.corners_after();
    let mut before = vec![0; after.len()];
    (0..).zip(&after).for_each(|(c, &next)| before[next as usize] = c);
    let is_middle = |c: u32| sources.middles.binary_search(&c).is_ok();
    let source = |c: u32| sources.corners[c as usize];
    // The old corners that a corner in the middle of a parted edge lies between.
    let ends = |c: u32| [before[c as usize], after[c as usize]].map(|c| (source(c), 0.5));
    if !columns.none_on(Kind::Vertex) {
        let vertex_of: Vec<u32> = corner_vertices(old);
        let mut between = vec![[(NONE, 0.5); 2]; new.vertex_count()];
        let named = corner_vertices(new);
        for &c in &sources.middles {
            between[named[c as usize] as usize] = ends(c).map(|(c, w)| (vertex_of[c as usize], w));
        }
        columns.derive(Kind::Vertex, new.vertex_count(), &|emit| {
            for (v, between) in between.iter().enumerate() {
                match vertices.old_of(v) {
                    [] if between[0].0 == NONE => emit(Origin::Nothing),
                    [] => emit(Origin::Made(Event::Split, between)),
                    &[own] => emit(Origin::Same(own)),
                    [own, others @ ..] => {
                        let others = others.iter().map(|&v| (v, 0.0));
                        let all: Vec<(u32, f64)> = [(*own, 1.0)].into_iter().chain(others).collect();
                        emit(Origin::Made(Event::Merge, &all));
                    }
                }
            }
        });
    }
    columns.derive(Kind::Corner, after.len(), &|emit| {
        for c in 0..after.len() as u32 {
            if is_middle(c) {
                emit(Origin::Made(Event::Split, &ends(c)));
            } else {
                emit(Origin::Same(source(c)));
            }
        }
    });
    if !columns.none_on(Kind::Edge) {
        let (old_edge, _) = old.edges_of_corners();
        let old_after = old.corners_after();
        // The old edge along which a new corner's half-edge runs, in the old face's direction or against it.
        let along = |a: u32, b: u32| match (old_after[a as usize] == b, old_after[b as usize] == a) {
            (true, _) => Some(old_edge[a as usize]),
            (false, true) => Some(old_edge[b as usize]),
            (false, false) => None,
        };
        let side = |c: u32| {
            let next = after[c as usize];
            match (is_middle(c), is_middle(next)) {
                (false, false) => along(source(c), source(next)).map(|e| (e, false)),
                (true, false) => along(source(before[c as usize]), source(next)).map(|e| (e, true)),
                (false, true) => along(source(c), source(after[next as usize])).map(|e| (e, true)),
                (true, true) => None,
            }
        };
        let (edge_of, count) = new.edges_of_corners();
        let mut uses = vec![[None; 2]; count];
        for (c, &e) in (0..).zip(&edge_of) {
            let uses: &mut [Option<(u32, bool)>; 2] = &mut uses[e as usize];
            let place = usize::from(uses[0].is_some());
            uses[place] = side(c);
        }
        columns.derive(Kind::Edge, count, &|emit| {
            for &[first, second] in &uses {
                match (first, second) {
                    (None, _) => emit(Origin::Nothing),
                    (Some((a, _)), Some((b, _))) if a != b => {
                        emit(Origin::Made(Event::Merge, &[(a, 0.5), (b, 0.5)]));
                    }
                    (Some((a, true)), _) => emit(Origin::Made(Event::Split, &[(a, 1.0)])),
                    (Some((a, false)), _) => emit(Origin::Same(a)),
                }
            }
        });
    }
    let mut parts = vec![0u32; old.face_count()];
    sources.faces.iter().for_each(|&f| parts[f as usize] += 1);
    columns.derive(Kind::Face, sources.faces.len(), &|emit| {
        for &f in &sources.faces {
            if parts[f as usize] == 1 {
                emit(Origin::Same(f));
            } else {
                emit(Origin::Made(Event::Split, &[(f, 1.0)]));
            }
        }
    });
    columns
}

/// The columns of a mesh on what was unwelded of it: `added` names the vertices that those at the end were split from.
pub(super) fn unwelded(old: &Mesh, new: &Mesh, added: &[u32]) -> Columns {
    let mut columns = old.user_columns();
    if columns.is_empty() {
        return columns;
    }
    columns.derive(Kind::Vertex, new.vertex_count(), &|emit| {
        (0..old.vertex_count() as u32).for_each(|v| emit(Origin::Same(v)));
        added.iter().for_each(|&v| emit(Origin::Made(Event::Split, &[(v, 1.0)])));
    });
    if !columns.none_on(Kind::Edge) {
        let (edge_of, count) = new.edges_of_corners();
        let (old_edge, old_count) = old.edges_of_corners();
        // Corners are what they were; of the two edges that one became, the first stays it.
        let mut from = vec![(NONE, false); count];
        let mut first = vec![NONE; old_count];
        for (&e, &o) in edge_of.iter().zip(&old_edge) {
            let first = &mut first[o as usize];
            if *first == NONE {
                *first = e;
            }
            from[e as usize] = (o, *first == e);
        }
        columns.derive(Kind::Edge, count, &|emit| {
            for &(e, is_first) in &from {
                if is_first {
                    emit(Origin::Same(e));
                } else {
                    emit(Origin::Made(Event::Split, &[(e, 1.0)]));
                }
            }
        });
    }
    columns
}

/// For each corner the number of its vertex.
fn corner_vertices(mesh: &Mesh) -> Vec<u32> {
    let mut number = vec![0; mesh.vertices.slot_count()];
    (0..).zip(mesh.vertices.in_user_order()).for_each(|(i, v)| number[v as usize] = i);
    let corners = mesh.ordered_slots(Kind::Corner);
    corners.into_iter().map(|h| number[mesh.origin[h as usize] as usize]).collect()
}
