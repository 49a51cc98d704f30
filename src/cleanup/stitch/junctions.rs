//! Ends of naked edges put into the edges that they lie on; and what of all that is tentative pairs naked edges.

use super::classes::Classes;
use super::{NewCorner, Plan};
use crate::cleanup::near::Tree;
use crate::geometry::direction;
use crate::matching::NONE;
use crate::query::segment_foot;
use crate::topology::UnionFind;
use glam::DVec3;

/// No more of what lies around an end is looked at, and no more ends are thought of as one with it.
const LOOKS: usize = 32;
const PARTNERS: usize = 6;
/// No end is put into more edges.
const EDGES: u32 = 4;
/// What is tentative settles in two or three rounds on any file from life.
const ROUNDS: usize = 8;

/// An end to be put into a naked edge.
#[derive(Clone, Copy, Debug)]
struct Cut {
    edge: u32,
    /// How far along it, from 0 to 1.
    at: f64,
    end: u32,
}

/// A part of a naked edge between two nodes: ends, and behind those cuts.
#[derive(Clone, Copy, Debug)]
struct Piece {
    edge: u32,
    nodes: [u32; 2],
}

/// What a piece comes to lie on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mate {
    /// Nothing.
    None,
    /// One other piece.
    Piece(u32),
    /// More than one.
    Many,
}

/// Finds cuts, and what of joins and cuts pairs naked edges.
pub(super) fn settle(classes: &mut Classes<'_, '_>) -> Option<Plan> {
    let blocks = inner_edges(classes);
    let whole = pieces(classes, &[]);
    let mates = mates(classes, &blocks, &[], &whole);
    let loose: Vec<u32> =
        (0..).zip(&mates).filter(|(_, m)| !matches!(m, Mate::Piece(_))).map(|(e, _)| e).collect();
    let mut cuts = Vec::new();
    if loose.len() > 1 {
        join_loose_ends(classes, &loose);
        cuts = find_cuts(classes, &loose);
    }
    for round in 0.. {
        if round >= ROUNDS {
            cuts.clear();
        }
        let pieces = pieces(classes, &cuts);
        let mates = self::mates(classes, &blocks, &cuts, &pieces);
        if round < ROUNDS && prune(classes, &mut cuts, &pieces, &mates) {
            continue;
        }
        let (plan, unfit) = carry_out(classes, &cuts, &pieces, &mates);
        if unfit.is_empty() || round > ROUNDS {
            return plan;
        }
        for class in unfit {
            cuts.retain(|c| classes.of(c.end) != class);
            classes.dissolve(class);
        }
    }
    None
}

/// Edges between ends of naked edges that are not naked themselves.
fn inner_edges(classes: &Classes<'_, '_>) -> Vec<[u32; 2]> {
    let seams = classes.seams;
    let mut naked = seams.edges.iter().map(|e| e.corner).peekable();
    let mut inner = Vec::new();
    let mut corner = 0u32;
    for face in seams.polygons.iter() {
        for (i, &v) in face.iter().enumerate() {
            let next = face[if i + 1 == face.len() { 0 } else { i + 1 }];
            if naked.next_if_eq(&corner).is_none()
                && let (Some(a), Some(b)) = (seams.number(v), seams.number(next))
            {
                inner.push([a, b]);
            }
            corner += 1;
        }
    }
    inner
}

/// All naked edges, parted at the cuts, which are sorted.
fn pieces(classes: &Classes<'_, '_>, cuts: &[Cut]) -> Vec<Piece> {
    let ends = classes.seams.vertex.len() as u32;
    let mut pieces = Vec::with_capacity(classes.seams.edges.len() + cuts.len());
    let mut next = 0;
    for (edge, naked) in (0u32..).zip(&classes.seams.edges) {
        let mut from = naked.ends[0];
        while cuts.get(next).is_some_and(|c| c.edge == edge) {
            let node = ends + next as u32;
            pieces.push(Piece { edge, nodes: [from, node] });
            from = node;
            next += 1;
        }
        pieces.push(Piece { edge, nodes: [from, naked.ends[1]] });
    }
    pieces
}

fn class_of(classes: &Classes<'_, '_>, cuts: &[Cut], node: u32) -> u32 {
    match node.checked_sub(classes.seams.vertex.len() as u32) {
        None => classes.of(node),
        Some(cut) => classes.of(cuts[cut as usize].end),
    }
}

fn mates(classes: &Classes<'_, '_>, blocks: &[[u32; 2]], cuts: &[Cut], pieces: &[Piece]) -> Vec<Mate> {
    let key = |[a, b]: [u32; 2]| (a.min(b), a.max(b));
    let own = |(i, p): (u32, &Piece)| (key(p.nodes.map(|n| class_of(classes, cuts, n))), i);
    let mut lying: Vec<((u32, u32), u32)> = (0..).zip(pieces).map(own).collect();
    lying.extend(blocks.iter().map(|b| (key(b.map(|end| classes.of(end))), NONE)));
    lying.sort_unstable();
    let mut mates = vec![Mate::None; pieces.len()];
    for together in lying.chunk_by(|a, b| a.0 == b.0) {
        match *together {
            [_] => {}
            [(_, p), (_, q)] if q != NONE && pieces[p as usize].edge != pieces[q as usize].edge => {
                mates[p as usize] = Mate::Piece(q);
                mates[q as usize] = Mate::Piece(p);
            }
            _ => {
                for &(_, p) in together.iter().filter(|l| l.1 != NONE) {
                    mates[p as usize] = Mate::Many;
                }
            }
        }
    }
    mates
}

/// Takes back cuts beside which no piece has a mate, or one has too many. Whether there were any.
fn prune(classes: &Classes<'_, '_>, cuts: &mut Vec<Cut>, pieces: &[Piece], mates: &[Mate]) -> bool {
    let ends = classes.seams.vertex.len() as u32;
    let before = cuts.len();
    let mut stays = vec![false; before];
    for i in 1..pieces.len() {
        if let Some(cut) = pieces[i].nodes[0].checked_sub(ends) {
            let sides = [mates[i - 1], mates[i]];
            stays[cut as usize] = !sides.contains(&Mate::Many) && sides != [Mate::None; 2];
        }
    }
    let mut stays = stays.into_iter();
    cuts.retain(|_| stays.next().unwrap_or(false));
    cuts.len() < before
}

/// Joins ends of edges that are left to others within reach, the nearest first.
fn join_loose_ends(classes: &mut Classes<'_, '_>, loose: &[u32]) {
    let seams = classes.seams;
    let ends = loose_ends(classes, loose);
    let tree = Tree::new(ends.iter().map(|&end| (seams.at(end), end)));
    let mut all: Vec<(f64, u32, u32)> = Vec::new();
    let mut own: Vec<(f64, u32, u32)> = Vec::new();
    for &end in &ends {
        own.clear();
        let most = LOOKS.min(classes.looks());
        if most == 0 {
            // Edges, not ends, are counted, where cuts are looked for.
            break;
        }
        let mut looks = 0;
        tree.ball(seams.at(end), seams.reach, |other, apart| {
            looks += 1;
            if other != end {
                own.push((apart, end.min(other), end.max(other)));
            }
            if looks < most { seams.reach } else { -1.0 }
        });
        classes.looked(0, looks, true);
        own.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        all.extend(own.iter().take(PARTNERS));
    }
    all.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    all.dedup();
    for (_, a, b) in all {
        classes.join(a, b);
    }
}

/// The ends of some edges, ascending.
fn loose_ends(classes: &Classes<'_, '_>, loose: &[u32]) -> Vec<u32> {
    let mut ends: Vec<u32> = loose.iter().flat_map(|&e| classes.seams.edges[e as usize].ends).collect();
    ends.sort_unstable();
    ends.dedup();
    ends
}

/// Where ends of edges that are left lie within others of these edges.
fn find_cuts(classes: &mut Classes<'_, '_>, loose: &[u32]) -> Vec<Cut> {
    let seams = classes.seams;
    let mut all: Vec<u32> = loose_ends(classes, loose).into_iter().map(|end| classes.of(end)).collect();
    all.sort_unstable();
    all.dedup();
    let tree = Tree::new(all.iter().map(|&class| (classes.place(class), class)));
    let mut cuts = Vec::new();
    // For each vertex of the pool the last face that had its class as a corner.
    let mut in_face = vec![NONE; seams.polygons.corners().iter().max().map_or(0, |&v| v as usize + 1)];
    let mut last_face = NONE;
    // For each class how many edges it is put into.
    let mut edges_cut = vec![0; seams.vertex.len()];
    let mut hits: Vec<(f64, u32)> = Vec::new();
    for &e in loose {
        let edge = seams.edges[e as usize];
        if edge.face != last_face {
            last_face = edge.face;
            for &v in &seams.polygons[edge.face as usize] {
                in_face[classes.key(v) as usize] = edge.face;
            }
        }
        let [a, b] = edge.ends.map(|end| seams.at(end));
        hits.clear();
        let most = classes.looks();
        if most == 0 {
            classes.looked(e, 0, false);
            continue;
        }
        let mut looks = 0;
        tree.tube([a, b], seams.reach, |class, p| {
            looks += 1;
            let (square, at) = segment_foot(a - p, b - p);
            let is_inside = p.distance(a) > seams.reach && p.distance(b) > seams.reach;
            let is_near = square.sqrt() <= seams.reach && at > 0.0 && at < 1.0;
            if is_near && is_inside && edges_cut[class as usize] < EDGES {
                hits.push((at, class));
            }
            looks < most
        });
        classes.looked(e, looks, looks < most);
        if looks == most {
            continue;
        }
        hits.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let apex = seams.apex(edge);
        let mut fan = apex.map(|(_, apex)| Fan::new([a, b], apex));
        for &(at, class) in &hits {
            let vertex = classes.key(seams.vertex[class as usize]) as usize;
            if in_face[vertex] == edge.face
                || fan.as_ref().is_some_and(|fan| !fan.may_reach(classes.place(class)))
                || apex.is_some_and(|(apex, _)| classes.is_joined(class, apex))
            {
                continue;
            }
            if let Some(fan) = &mut fan {
                fan.from = classes.place(class);
            }
            in_face[vertex] = edge.face;
            edges_cut[class as usize] += 1;
            cuts.push(Cut { edge: e, at, end: classes.kept(class) });
        }
    }
    cuts
}

/// A triangle that is cut into a fan from its apex, from one end of an edge to the other.
struct Fan {
    from: DVec3,
    to: DVec3,
    apex: DVec3,
    normal: DVec3,
}

impl Fan {
    fn new([from, to]: [DVec3; 2], apex: DVec3) -> Self {
        let normal = direction(to - from).cross(direction(apex - from));
        Self { from, to, apex, normal }
    }

    /// Whether it may go on to a point: if the part up to it and the part that is left then face as the triangle does. In a
    /// triangle without area there is no such point.
    fn may_reach(&self, p: DVec3) -> bool {
        let faces = |a: DVec3, b: DVec3| {
            let normal = direction(b - a).cross(direction(self.apex - a));
            normal.dot(self.normal) > 0.0
        };
        faces(self.from, p) && faces(p, self.to)
    }
}

/// What becomes of the pool: ends become one only where pieces that are mates need it. Also the classes of which no
/// member is within reach of all that come to it.
fn carry_out(
    classes: &Classes<'_, '_>,
    cuts: &[Cut],
    pieces: &[Piece],
    mates: &[Mate],
) -> (Option<Plan>, Vec<u32>) {
    let seams = classes.seams;
    let ends = seams.vertex.len() as u32;
    let mut sets = UnionFind::new(seams.vertex.len() + cuts.len());
    let mut cracks = Vec::new();
    let is_whole = |p: &Piece| p.nodes.iter().all(|&n| n < ends);
    for (i, (p, mate)) in (0u32..).zip(pieces.iter().zip(mates)) {
        let Mate::Piece(j) = *mate else { continue };
        let q = &pieces[j as usize];
        if j < i {
            continue;
        }
        let class = |node| class_of(classes, cuts, node);
        let [a, b] = if class(p.nodes[0]) == class(q.nodes[0]) { [0, 1] } else { [1, 0] };
        sets.join(p.nodes[0], q.nodes[a]);
        sets.join(p.nodes[1], q.nodes[b]);
        if is_whole(p) && is_whole(q) {
            cracks.push(seams.edges[p.edge as usize].corner);
        }
    }
    // A vertex that was put into several edges that are mates of each other only.
    for (node, cut) in (ends..).zip(cuts) {
        if sets.root(node) >= ends {
            sets.join(node, cut.end);
        }
    }
    let mut nodes: Vec<(u32, u32)> =
        (0..ends + cuts.len() as u32).filter(|&n| !sets.is_single(n)).map(|n| (n, n)).collect();
    nodes.iter_mut().for_each(|n| n.0 = sets.root(n.1));
    nodes.sort_unstable();

    let mut plan = Plan {
        into: (0..seams.vertex_count() as u32).collect(),
        places: Vec::new(),
        cuts: Vec::with_capacity(cuts.len()),
        cracks,
        moved: 0.0,
    };
    let mut unfit = Vec::new();
    for set in nodes.chunk_by(|a, b| a.0 == b.0) {
        let distance = |node: u32, place: DVec3| match node.checked_sub(ends) {
            None => seams.at(node).distance(place),
            Some(cut) => {
                let ends = seams.edges[cuts[cut as usize].edge as usize].ends;
                let [a, b] = ends.map(|end| seams.at(end) - place);
                segment_foot(a, b).0.sqrt()
            }
        };
        let farthest = |end: u32| set.iter().fold(0.0f64, |m, n| m.max(distance(n.1, seams.at(end))));
        let may_keep = set.iter().map(|n| n.1).filter(|&n| n < ends).take(LOOKS);
        let kept = may_keep.map(|end| (end, farthest(end))).find(|k| k.1 <= seams.reach);
        let Some((kept, moved)) = kept else {
            unfit.push(class_of(classes, cuts, set[0].1));
            continue;
        };
        plan.moved = plan.moved.max(moved / seams.scale);
        // Ends come before cuts, and in the order of vertices.
        let lowest = seams.vertex[set[0].1 as usize];
        let kept = seams.vertex[kept as usize];
        if kept != lowest {
            plan.places.push((lowest, kept));
        }
        for &(_, node) in set {
            match node.checked_sub(ends) {
                None => plan.into[seams.vertex[node as usize] as usize] = lowest,
                Some(cut) => {
                    let Cut { edge, at, .. } = cuts[cut as usize];
                    let corner = seams.edges[edge as usize].corner;
                    plan.cuts.push(NewCorner { corner, at, vertex: lowest });
                }
            }
        }
    }
    plan.cuts.sort_unstable_by(|a, b| a.corner.cmp(&b.corner).then(a.at.total_cmp(&b.at)));
    let is_any = !plan.cuts.is_empty() || !plan.cracks.is_empty();
    (is_any.then_some(plan), unfit)
}
