//! The naive twin of operators that have a choice: dissolving a vertex, triangulating a face.

use super::plain::Id::{New, Old};
use super::plain::{Plain, V, keeping_first, rotated};
use super::twin::{After, SAME, old_face};
use meshwright::{FaceKey, IndexedMesh, Mesh, VertexKey};
use std::collections::BTreeMap;

pub(crate) fn dissolve(before: &Plain, v: V) -> Option<Vec<After>> {
    let spokes = before.clockwise(v);
    let left = before.left();
    let (&first, &last) = (spokes.first()?, spokes.last()?);
    let is_open = !left.contains_key(&(v, first));
    let mut p = before.clone();
    p.at.remove(&v);
    let at = |n| before.edge_between(v, n);
    let gap = [at(first)?, at(last)?];
    let mut states = Vec::new();
    if spokes.len() == 2 {
        for c in p.faces.values_mut() {
            c.retain(|&n| n != v);
        }
        states.push(After::new(p, Some(SAME)));
    } else {
        // Counter-clockwise around the vertex.
        let mut rim = Vec::new();
        let mut corners = Vec::new();
        let mut faces = Vec::new();
        for &n in spokes.iter().rev() {
            let Some(&f) = left.get(&(v, n)) else { continue };
            let c = rotated(&before.faces[&f], v);
            rim.extend(&c[1..c.len() - 1]);
            corners.extend(c[1..].iter().map(|&n| (n, f)));
            faces.push(f);
        }
        if is_open {
            rim.push(first);
        }
        let twice = |n: V| corners.iter().filter(|c| c.0 == n).count() > 1;
        for n in &spokes {
            p.edges.remove(&at(*n)?);
        }
        for &keeps in &faces {
            let mut p = p.clone();
            faces.iter().for_each(|f| drop(p.faces.remove(f)));
            p.faces.insert(keeps, keeping_first(before, keeps, rim.clone()));
            let mut state = After::new(p, Some(SAME));
            state.mixed_faces.insert(keeps);
            state.mixed_corners = rim.iter().filter(|&&n| twice(n)).map(|&n| (keeps, n)).collect();
            for &n in rim.iter().filter(|&&n| twice(n)) {
                let both: Vec<FaceKey> = corners.iter().filter(|c| c.0 == n).map(|c| old_face(c.1)).collect();
                state.means.extend(both.try_into().map(|both: [FaceKey; 2]| ((keeps, n), both)));
            }
            let whole = corners.iter().filter(|c| !twice(c.0));
            state.corners = whole.map(|&(n, f)| ((keeps, n), (old_face(f), n.key(&[])))).collect();
            states.push(state);
        }
    }
    if !is_open && spokes.len() > 2 {
        return Some(states);
    }
    // One of the edges at the ends of the gap closes it.
    let closed = |state: &After, keeps: usize| {
        let mut state = state.clone();
        let other = [last, first][keeps];
        state.plain.edges.remove(&gap[1 - keeps]);
        let turned = before.edges[&gap[keeps]].map(|n| if n == v { other } else { n });
        state.plain.edges.insert(gap[keeps], turned);
        state.mixed_edges.insert(gap[keeps]);
        state
    };
    Some(states.iter().flat_map(|s| [closed(s, 0), closed(s, 1)]).collect())
}

/// The crate's rule for a polygon, asked about the polygon alone; a quad may take its other diagonal.
pub(crate) fn triangulate(before: &Plain, f: FaceKey) -> Option<Vec<After>> {
    let cycle = before.faces.get(&Old(f))?;
    // The rule breaks ties by the order of vertices.
    let mut order = cycle.clone();
    order.sort_unstable();
    let points = order.iter().map(|v| before.at[v]).collect();
    let numbers: Vec<u32> =
        cycle.iter().filter_map(|v| order.binary_search(v).ok()).map(|i| i as u32).collect();
    let mut alone = Mesh::build(&IndexedMesh::new(points, vec![numbers].into()).ok()?).ok()?;
    let name: BTreeMap<VertexKey, V> = alone.vertices().zip(order).collect();
    let only = alone.faces().next()?;
    let cuts = alone.triangulate_face(only).ok()?.cuts;
    let corners = |f| alone.face_vertices(f).map(|v| name[&v]).collect::<Vec<V>>();
    let mut p = before.clone();
    p.faces.insert(Old(f), keeping_first(before, Old(f), corners(only)));
    for (i, cut) in cuts.iter().enumerate() {
        let h = alone.edge_halfedge(cut.edge);
        let diagonal = [alone.origin(h), alone.target(h)].map(|v| name[&v]);
        p.edges.insert(New(i), diagonal);
        p.faces.insert(New(i), corners(cut.face));
    }
    let state = |p: Plain| {
        let mut after = After::new(p, Some(SAME));
        (0..cuts.len()).for_each(|i| after.carry(New(i), f));
        after
    };
    let blocked = (0..cuts.len()).any(|i| {
        let [a, b] = p.edges[&New(i)];
        before.edge_between(a, b).is_some()
    });
    if !blocked || cycle.len() != 4 {
        return Some(vec![state(p)]);
    }
    let [a, b] = p.edges[&New(0)];
    let c = rotated(cycle, a);
    debug_assert_eq!(c[2], b);
    let halves = [vec![c[1], c[2], c[3]], vec![c[3], c[0], c[1]]];
    let other = |new: usize| {
        let mut p = p.clone();
        p.faces.insert(New(0), halves[new].clone());
        p.faces.insert(Old(f), keeping_first(before, Old(f), halves[1 - new].clone()));
        let h = &halves[new];
        p.edges.insert(New(0), [h[2], h[0]]);
        state(p)
    };
    Some(vec![other(0), other(1)])
}
