//! The naive twin of the operators: what each one's documentation promises, worked out on plain lists of faces, and
//! accepted if the lists build a mesh from nothing that keeps the promises.

use super::Op;
use super::merged::{dissolve, triangulate};
pub(crate) use super::plain::{Counts, E, F, Id, Plain, V};
use super::plain::{around, keeping_first, put_on_edge, rotated, without_bare_edges};
use Id::{New, Old};
use meshwright::{FaceKey, HalfedgeKey, Mesh, VertexKey};
use std::collections::BTreeSet;

/// What an operator should leave behind.
#[derive(Clone, Debug)]
pub(crate) struct After {
    pub(crate) plain: Plain,
    /// How the counts change, if the documentation says.
    pub(crate) change: Option<Counts>,
    /// Corners that hold what another held before; all that were there before and are not mixed keep theirs.
    pub(crate) corners: Vec<((F, V), (FaceKey, VertexKey))>,
    pub(crate) mixed_corners: BTreeSet<(F, V)>,
    /// Mixed corners that hold the mean of two.
    pub(crate) means: Vec<((F, V), [FaceKey; 2])>,
    pub(crate) mixed_vertices: BTreeSet<V>,
    pub(crate) mixed_edges: BTreeSet<E>,
    pub(crate) mixed_faces: BTreeSet<F>,
}

pub(crate) const SAME: Counts = Counts { euler: 0, loops: 0, components: 0, isolated: 0 };

impl After {
    pub(crate) fn new(plain: Plain, change: Option<Counts>) -> Self {
        Self {
            plain,
            change,
            corners: Vec::new(),
            mixed_corners: BTreeSet::new(),
            means: Vec::new(),
            mixed_vertices: BTreeSet::new(),
            mixed_edges: BTreeSet::new(),
            mixed_faces: BTreeSet::new(),
        }
    }

    /// Corners of a new face at old vertices hold what they held in the old face.
    pub(crate) fn carry(&mut self, to: F, from: FaceKey) {
        for &v in &self.plain.faces[&to] {
            if let Old(key) = v {
                self.corners.push(((to, v), (from, key)));
            }
        }
    }
}

/// The states that the documentation of the operator allows it to leave; or why it must refuse.
pub(crate) fn expect(mesh: &Mesh, op: &Op) -> Result<Vec<After>, String> {
    let before = Plain::of(mesh);
    let all = after(mesh, &before, op).ok_or("dead or unfit elements")?;
    let first = &all[0];
    first.plain.builds()?;
    if let Some(change) = first.change {
        let (old, new) = (before.counts(), first.plain.counts());
        let got = Counts {
            euler: new.euler - old.euler,
            loops: new.loops - old.loops,
            components: new.components - old.components,
            isolated: new.isolated - old.isolated,
        };
        if got != change {
            return Err(format!("counts change by {got:?}"));
        }
    }
    Ok(all)
}

fn ends(mesh: &Mesh, h: HalfedgeKey) -> Option<[V; 2]> {
    Some([Old(mesh.get_origin(h)?), Old(mesh.get_target(h)?)])
}

pub(crate) fn old_face(f: F) -> FaceKey {
    f.key(&[])
}

fn after(mesh: &Mesh, before: &Plain, op: &Op) -> Option<Vec<After>> {
    let mut p = before.clone();
    let left = before.left();
    Some(match *op {
        Op::AddVertex(position) => {
            p.at.insert(New(0), position);
            vec![After::new(p, Some(Counts { euler: 1, isolated: 1, ..SAME }))]
        }
        Op::AddFace(ref corners) => {
            let cycle: Vec<V> = corners.iter().map(|&v| Old(v)).collect();
            if !cycle.iter().all(|v| p.at.contains_key(v)) || cycle.is_empty() {
                return None;
            }
            let mut born = 0;
            for (a, b) in around(&cycle) {
                if p.edge_between(a, b).is_none() {
                    p.edges.insert(New(born), [a, b]);
                    born += 1;
                }
            }
            p.faces.insert(New(0), cycle);
            vec![After::new(p, None)]
        }
        Op::RemoveFace(f) => {
            p.faces.remove(&Old(f))?;
            vec![After::new(without_bare_edges(p), None)]
        }
        Op::RemoveEdge(e) => {
            let [a, b] = p.edges[p.edges.get_key_value(&Old(e))?.0];
            for f in [left.get(&(a, b)), left.get(&(b, a))].into_iter().flatten() {
                p.faces.remove(f);
            }
            vec![After::new(without_bare_edges(p), None)]
        }
        Op::RemoveVertex(v) => {
            p.at.remove(&Old(v))?;
            p.faces.retain(|_, c| !c.contains(&Old(v)));
            vec![After::new(without_bare_edges(p), None)]
        }
        Op::SplitEdge(e, position) => {
            put_on_edge(&mut p, e, position)?;
            vec![After::new(p, Some(SAME))]
        }
        Op::SplitEdgeAndFaces(e, position) => {
            let [a, b] = *before.edges.get(&Old(e))?;
            put_on_edge(&mut p, e, position)?;
            let m = New(0);
            let mut cuts = Vec::new();
            for ends in [(a, b), (b, a)] {
                let Some(&f) = left.get(&ends).filter(|f| before.faces[f].len() == 3) else { continue };
                let c = rotated(&p.faces[&f], m);
                let apex = c[2];
                p.faces.insert(f, keeping_first(before, f, vec![m, c[1], apex]));
                p.faces.insert(New(cuts.len()), vec![apex, c[3], m]);
                p.edges.insert(New(cuts.len() + 1), [m, apex]);
                cuts.push(f);
            }
            let mut after = After::new(p, Some(SAME));
            for (i, f) in cuts.into_iter().enumerate() {
                after.carry(New(i), old_face(f));
            }
            vec![after]
        }
        Op::SplitFace(from, to) => {
            let ([a, a_next], [b, b_next]) = (ends(mesh, from)?, ends(mesh, to)?);
            let f = *left.get(&(a, a_next))?;
            if left.get(&(b, b_next)) != Some(&f) || a == b {
                return None;
            }
            let c = rotated(&p.faces[&f], a);
            let at = c.iter().position(|&v| v == b)?;
            p.faces.insert(f, keeping_first(before, f, c[..=at].to_vec()));
            p.faces.insert(New(0), c[at..].iter().chain([&a]).copied().collect());
            p.edges.insert(New(0), [a, b]);
            let mut after = After::new(p, Some(SAME));
            after.carry(New(0), old_face(f));
            vec![after]
        }
        Op::PokeFace(f, position) => {
            let c = p.faces.get(&Old(f))?.clone();
            p.at.insert(New(0), position);
            for (i, (a, b)) in around(&c).enumerate() {
                p.faces.insert(if i == 0 { Old(f) } else { New(i - 1) }, vec![a, b, New(0)]);
                p.edges.insert(New(i), [a, New(0)]);
            }
            let mut after = After::new(p, Some(SAME));
            (1..c.len()).for_each(|i| after.carry(New(i - 1), f));
            after.carry(Old(f), f);
            vec![after]
        }
        Op::SplitVertex(first, last, position) => {
            let ([v, first], [w, last]) = (ends(mesh, first)?, ends(mesh, last)?);
            if v != w {
                return None;
            }
            let spokes = before.clockwise(v);
            let at = spokes.iter().position(|&n| n == first)?;
            let order: Vec<V> = spokes[at..].iter().chain(&spokes[..at]).copied().collect();
            let moved = &order[..=order.iter().position(|&n| n == last)?];
            if moved.len() == order.len() {
                return None;
            }
            p.at.insert(New(0), position);
            let mut carried = Vec::new();
            for (&f, cycle) in p.faces.iter_mut().filter(|(_, c)| c.contains(&v)) {
                let c = rotated(cycle, v);
                let corner = match (moved.contains(&c[c.len() - 1]), moved.contains(&c[1])) {
                    (true, true) => vec![New(0)],
                    (false, true) => vec![v, New(0)],
                    (true, false) => vec![New(0), v],
                    (false, false) => vec![v],
                };
                if corner.contains(&New(0)) {
                    carried.push(((f, New(0)), (old_face(f), v.key(&[]))));
                }
                let mut new = corner;
                new.extend(&c[1..]);
                // A first corner at the vertex stays a corner at it if there is one.
                let was = cycle[0];
                *cycle = if new.contains(&was) { rotated(&new, was) } else { new };
            }
            for ends in p.edges.values_mut().filter(|e| e.contains(&v)) {
                if ends.iter().any(|n| moved.contains(n)) {
                    ends.iter_mut().filter(|n| **n == v).for_each(|n| *n = New(0));
                }
            }
            p.edges.insert(New(0), [v, New(0)]);
            let mut after = After::new(p, Some(SAME));
            after.corners = carried;
            vec![after]
        }
        Op::Collapse(h, position) => {
            let [a, b] = ends(mesh, h)?;
            p.edges.remove(&p.edge_between(a, b)?);
            let mut merged = BTreeSet::new();
            for ends in [(a, b), (b, a)] {
                let Some(f) = left.get(&ends) else { continue };
                let c = &before.faces[f];
                if c.len() == 3 {
                    p.faces.remove(f);
                    let apex = *c.iter().find(|v| **v != a && **v != b)?;
                    p.edges.remove(&p.edge_between(a, apex)?);
                    merged.insert(p.edge_between(b, apex)?);
                } else {
                    // The corner that goes; where the face began there, it begins at the other.
                    let began = c[0];
                    let mut c: Vec<V> = c.iter().copied().filter(|&v| v != a).collect();
                    if began == a {
                        c = rotated(&c, b);
                    }
                    p.faces.insert(*f, c);
                }
            }
            p.rename(|v| if v == a { b } else { v });
            p.at.remove(&a);
            p.at.insert(b, position);
            let mut after = After::new(p, Some(SAME));
            after.mixed_vertices.insert(b);
            after.mixed_corners = after.plain.faces.keys().map(|&f| (f, b)).collect();
            after.mixed_edges = merged;
            vec![after]
        }
        Op::FlipEdge(e) => {
            let [a, b] = *before.edges.get(&Old(e))?;
            let (f, g) = (*left.get(&(a, b))?, *left.get(&(b, a))?);
            let (c, d) = (rotated(&before.faces[&f], b)[1], rotated(&before.faces[&g], a)[1]);
            for (f, lost, new) in [(f, b, d), (g, a, c)] {
                p.faces.get_mut(&f)?.iter_mut().filter(|v| **v == lost).for_each(|v| *v = new);
            }
            p.edges.insert(Old(e), [d, c]);
            let mut after = After::new(p, Some(SAME));
            after.corners = vec![((f, d), (old_face(g), d.key(&[]))), ((g, c), (old_face(f), c.key(&[])))];
            vec![after]
        }
        Op::JoinFaces(e) => {
            let [a, b] = *before.edges.get(&Old(e))?;
            let (f, g) = (*left.get(&(a, b))?, *left.get(&(b, a))?);
            let (of_f, of_g) = (&before.faces[&f], &before.faces[&g]);
            // Vertices of the chain, in the order of f.
            let mut chain = vec![a, b];
            while let x = rotated(of_f, chain[chain.len() - 1])[1]
                && left.get(&(x, chain[chain.len() - 1])) == Some(&g)
            {
                chain.push(x);
            }
            while let x = rotated(of_g, chain[0])[1]
                && left.get(&(x, chain[0])) == Some(&f)
            {
                chain.insert(0, x);
            }
            let (u, w) = (chain[0], chain[chain.len() - 1]);
            let part = |cycle: &[V]| cycle[chain.len() - 1..].to_vec();
            let (from_f, from_g) = (part(&rotated(of_f, u)), part(&rotated(of_g, w)));
            let merged: Vec<V> = from_f.iter().chain(&from_g).copied().collect();
            for pair in chain.windows(2) {
                p.edges.remove(&before.edge_between(pair[0], pair[1])?);
            }
            p.at.retain(|v, _| !chain[1..chain.len() - 1].contains(v));
            p.faces.remove(&g);
            p.faces.insert(f, keeping_first(before, f, merged));
            let mut after = After::new(p, Some(SAME));
            after.corners = from_g[1..].iter().map(|&v| ((f, v), (old_face(g), v.key(&[])))).collect();
            after.mixed_corners = [(f, u), (f, w)].into();
            after.means = [u, w].map(|v| ((f, v), [old_face(f), old_face(g)])).to_vec();
            after.mixed_faces = [f].into();
            vec![after]
        }
        Op::DissolveVertex(v) => return dissolve(before, Old(v)),
        Op::TriangulateFace(f) => return triangulate(before, f),
        Op::FillHole(h) => {
            let [a, b] = ends(mesh, h)?;
            if left.contains_key(&(a, b)) {
                return None;
            }
            let next = before.boundary();
            let mut cycle = vec![a];
            while let n = next[&cycle[cycle.len() - 1]]
                && n != a
            {
                cycle.push(n);
            }
            p.faces.insert(New(0), cycle);
            vec![After::new(p, Some(Counts { euler: 1, loops: -1, ..SAME }))]
        }
        Op::Stitch(first, second) => {
            let ([a, b], [c, d]) = (ends(mesh, first)?, ends(mesh, second)?);
            if left.contains_key(&(a, b)) || left.contains_key(&(c, d)) || first == second {
                return None;
            }
            let merged = |v| {
                if v == d {
                    a
                } else if v == c {
                    b
                } else {
                    v
                }
            };
            p.edges.remove(&before.edge_between(c, d)?);
            p.rename(merged);
            let mut after = After::new(p, None);
            for v in [c, d].into_iter().filter(|&v| merged(v) != v) {
                after.plain.at.remove(&v);
                for (&f, _) in before.faces.iter().filter(|(_, c)| c.contains(&v)) {
                    after.corners.push(((f, merged(v)), (old_face(f), v.key(&[]))));
                }
            }
            after.mixed_vertices = [a, b].into();
            after.mixed_edges = before.edge_between(a, b).into_iter().collect();
            vec![after]
        }
        Op::ReverseComponent(f) => {
            let mut reached: BTreeSet<V> = before.faces.get(&Old(f))?.iter().copied().collect();
            loop {
                let more: BTreeSet<V> = before
                    .faces
                    .values()
                    .filter(|c| c.iter().any(|v| reached.contains(v)))
                    .flatten()
                    .copied()
                    .collect();
                if more.len() == reached.len() {
                    break;
                }
                reached = more;
            }
            p.faces.values_mut().filter(|c| reached.contains(&c[0])).for_each(|c| c[1..].reverse());
            p.edges.values_mut().filter(|c| reached.contains(&c[0])).for_each(|c| c.reverse());
            vec![After::new(p, Some(SAME))]
        }
    })
}
