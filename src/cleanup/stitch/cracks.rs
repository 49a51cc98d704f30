//! Whole naked edges that become one with another.

use super::classes::Classes;
use crate::cleanup::near::Tree;

/// No more of what lies around a naked edge is looked at.
const LOOKS: usize = 64;
/// No more partners of an edge are thought of.
const PARTNERS: usize = 6;

/// Two naked edges that might become one.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    /// The greater distance of two ends; twice that for edges that run the same way.
    cost: f64,
    edges: [u32; 2],
}

/// Joins the ends of naked edges, the nearest pairs first, as far as classes allow.
pub(super) fn pair_edges(classes: &mut Classes<'_, '_>) {
    let seams = classes.seams;
    let mut paired = vec![false; seams.edges.len()];
    for Candidate { edges: [e, f], .. } in candidates(classes) {
        if paired[e as usize] || paired[f as usize] {
            continue;
        }
        let [[a, b], [c, d]] = [e, f].map(|e| seams.edges[e as usize].ends);
        let (_, is_opposite) = cost(classes, e, f);
        let [c, d] = if is_opposite { [d, c] } else { [c, d] };
        // Asked twice, so that not one end is joined for nothing.
        if classes.can_join(b, d) && classes.join(a, c) && classes.join(b, d) {
            paired[e as usize] = true;
            paired[f as usize] = true;
        }
    }
}

/// The pairs of naked edges within reach of each other, the nearest first.
fn candidates(classes: &mut Classes<'_, '_>) -> Vec<Candidate> {
    let seams = classes.seams;
    let middle = |[a, b]: [u32; 2]| seams.at(a) * 0.5 + seams.at(b) * 0.5;
    let tree = Tree::new(seams.edges.iter().map(|e| middle(e.ends)).zip(0..));
    let mut all: Vec<Candidate> = Vec::new();
    let mut own: Vec<Candidate> = Vec::new();
    for (e, edge) in (0u32..).zip(&seams.edges) {
        own.clear();
        let most = LOOKS.min(classes.looks());
        if most == 0 {
            classes.looked(e, 0, false);
            continue;
        }
        let mut looks = 0;
        tree.ball(middle(edge.ends), seams.reach, |f, _| {
            looks += 1;
            if seams.edges[f as usize].face != edge.face {
                let (cost, is_opposite) = cost(classes, e, f);
                let farthest = if is_opposite { cost } else { cost * 0.5 };
                if farthest <= seams.reach {
                    own.push(Candidate { cost, edges: [e.min(f), e.max(f)] });
                }
            }
            if looks < most { seams.reach } else { -1.0 }
        });
        classes.looked(e, looks, looks < most);
        own.sort_unstable_by(Candidate::order);
        // Its partner thinks of it too.
        all.extend(own.iter().take(PARTNERS).filter(|c| c.edges[0] == e));
    }
    all.sort_unstable_by(Candidate::order);
    all
}

impl Candidate {
    fn order(&self, other: &Self) -> std::cmp::Ordering {
        self.cost.total_cmp(&other.cost).then(self.edges.cmp(&other.edges))
    }
}

/// What pairing two edges costs, and whether as edges that run opposite ways.
fn cost(classes: &Classes<'_, '_>, e: u32, f: u32) -> (f64, bool) {
    let seams = classes.seams;
    let [[a, b], [c, d]] = [e, f].map(|e| seams.edges[e as usize].ends.map(|end| seams.at(end)));
    let opposite = a.distance(d).max(b.distance(c));
    let same = 2.0 * a.distance(c).max(b.distance(d));
    (opposite.min(same), opposite <= same)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Polygons;
    use crate::cleanup::stitch::seams::Seams;
    use crate::matching::Matching;
    use glam::DVec3;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn candidates_are_all_pairs_of_edges_within_reach(points in prop::collection::vec([0i32..4, 0..4, 0..4], 9..36), off in prop::collection::vec([-0.1f64..0.1, -0.1..0.1, -0.1..0.1], 36)) {
            let place = |(p, o): (&[i32; 3], &[f64; 3])| DVec3::from(p.map(f64::from)) + DVec3::from(*o);
            let positions: Vec<DVec3> = points.iter().zip(&off).map(place).collect();
            let faces: Polygons = (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            let seams = Seams::new(&positions, &faces, &Matching::new(positions.len(), &faces), 0.3);
            let mut classes = Classes::new(&seams);
            let mut naive: Vec<[u32; 2]> = Vec::new();
            for e in 0..seams.edges.len() as u32 {
                for f in e + 1..seams.edges.len() as u32 {
                    let [p, q] = [e, f].map(|e| seams.edges[e as usize]);
                    let far = |a: [u32; 2], b: [u32; 2]| {
                        let apart = |i: usize| seams.at(a[i]).distance(seams.at(b[i]));
                        apart(0).max(apart(1))
                    };
                    let (same, opposite) = (far(p.ends, q.ends), far(p.ends, [q.ends[1], q.ends[0]]));
                    let farthest = if opposite <= 2.0 * same { opposite } else { same };
                    if p.face != q.face && farthest <= seams.reach {
                        naive.push([e, f]);
                    }
                }
            }
            let found = candidates(&mut classes);
            prop_assert!(found.is_sorted_by(|a, b| a.cost <= b.cost));
            let mut found: Vec<[u32; 2]> = found.iter().map(|c| c.edges).collect();
            found.sort_unstable();
            let partners = |e: u32| naive.iter().filter(|n| n.contains(&e)).count();
            if (0..seams.edges.len() as u32).all(|e| partners(e) <= PARTNERS) {
                prop_assert_eq!(found, naive);
            } else {
                prop_assert!(found.iter().all(|pair| naive.contains(pair)));
            }
        }
    }
}
