//! Points that lie near a point or a line: a tree over points (Bentley, "Multidimensional binary search trees used for
//! associative searching", 1975), balanced whatever the input.

use glam::DVec3;

/// Points with numbers. The tree is implicit: the point in the middle of a range parts the rest of it along an axis.
pub(super) struct Tree {
    nodes: Vec<Node>,
}

#[derive(Clone, Copy)]
struct Node {
    point: DVec3,
    id: u32,
    axis: u32,
}

/// Ranges of no more points are searched one by one.
const LEAF: usize = 8;

impl Tree {
    /// O(n log n). Points are finite.
    pub(super) fn new(points: impl Iterator<Item = (DVec3, u32)>) -> Self {
        let mut nodes: Vec<Node> = points.map(|(point, id)| Node { point, id, axis: 0 }).collect();
        part(&mut nodes);
        Self { nodes }
    }

    /// Calls `visit` with points no farther from `center` than the radius, and their distances; it returns the radius
    /// from there on, which may shrink.
    pub(super) fn ball(&self, center: DVec3, radius: f64, mut visit: impl FnMut(u32, f64) -> f64) {
        let mut radius = radius;
        ball(&self.nodes, center, &mut radius, &mut visit);
    }

    /// Calls `visit` with points near the segment, and their places: with all that are no farther from it than the radius, and some
    /// others. It returns whether to go on.
    pub(super) fn tube(&self, [a, b]: [DVec3; 2], radius: f64, mut visit: impl FnMut(u32, DVec3) -> bool) {
        tube(&self.nodes, a, b - a, [0.0, 1.0], radius, &mut visit);
    }
}

fn part(nodes: &mut [Node]) {
    if nodes.len() <= LEAF {
        return;
    }
    let (mut low, mut high) = (nodes[0].point, nodes[0].point);
    for n in nodes.iter() {
        (low, high) = (low.min(n.point), high.max(n.point));
    }
    let axis = (high - low).max_position();
    let middle = nodes.len() / 2;
    // By number where coordinates are equal, so that the order does not depend on the selection.
    nodes
        .select_nth_unstable_by(middle, |a, b| a.point[axis].total_cmp(&b.point[axis]).then(a.id.cmp(&b.id)));
    nodes[middle].axis = axis as u32;
    let (below, above) = nodes.split_at_mut(middle);
    part(below);
    part(&mut above[1..]);
}

fn ball(nodes: &[Node], center: DVec3, radius: &mut f64, visit: &mut impl FnMut(u32, f64) -> f64) {
    let mut test = |n: &Node, radius: &mut f64| {
        let apart = n.point.distance(center);
        if apart <= *radius {
            *radius = visit(n.id, apart);
        }
    };
    if nodes.len() <= LEAF {
        nodes.iter().for_each(|n| test(n, radius));
        return;
    }
    let (below, rest) = nodes.split_at(nodes.len() / 2);
    let (n, above) = (&rest[0], &rest[1..]);
    test(n, radius);
    let across = center[n.axis as usize] - n.point[n.axis as usize];
    let (near, far) = if across < 0.0 { (below, above) } else { (above, below) };
    ball(near, center, radius, visit);
    if across.abs() <= *radius {
        ball(far, center, radius, visit);
    }
}

/// `from..to` is the part of the segment near which the range may have points.
fn tube(
    nodes: &[Node],
    start: DVec3,
    along: DVec3,
    [from, to]: [f64; 2],
    radius: f64,
    visit: &mut impl FnMut(u32, DVec3) -> bool,
) -> bool {
    if nodes.len() <= LEAF {
        return nodes.iter().all(|n| visit(n.id, n.point));
    }
    let (below, rest) = nodes.split_at(nodes.len() / 2);
    let (n, above) = (&rest[0], &rest[1..]);
    if !visit(n.id, n.point) {
        return false;
    }
    let (x, dx, split) = (start[n.axis as usize], along[n.axis as usize], n.point[n.axis as usize]);
    // The part with coordinates up to `split + radius`, and the part with those from `split - radius`.
    let [up_to, down_to] = [split + radius, split - radius].map(|limit| (limit - x) / dx);
    let (low, high) = if dx > 0.0 {
        ([from, to.min(up_to)], [from.max(down_to), to])
    } else if dx < 0.0 {
        ([from.max(up_to), to], [from, to.min(down_to)])
    } else {
        let all = [from, to];
        let none = [1.0, 0.0];
        (if x <= split + radius { all } else { none }, if x >= split - radius { all } else { none })
    };
    // Room for the rounding of the quotients.
    let has_any = |[from, to]: [f64; 2]| from <= to + 1e-9;
    (!has_any(low) || tube(below, start, along, low, radius, visit))
        && (!has_any(high) || tube(above, start, along, high, radius, visit))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::query::segment_foot;
    use proptest::prelude::*;

    fn points() -> impl Strategy<Value = Vec<DVec3>> {
        let coordinate = prop_oneof![(-3i32..3).prop_map(f64::from), -3.0f64..3.0];
        prop::collection::vec(
            [coordinate.clone(), coordinate.clone(), coordinate].prop_map(DVec3::from),
            2..200,
        )
    }

    proptest! {
        #[test]
        fn what_is_near_a_point_or_a_segment_is_found(points in points(), radius in prop_oneof![Just(1.0), 0.0f64..3.0]) {
            let tree = Tree::new(points.iter().copied().zip(0..));
            let (a, b) = (points[0], points[1]);
            let mut found = Vec::new();
            tree.ball(a, radius, |id, apart| {
                assert_eq!(apart, points[id as usize].distance(a));
                found.push(id);
                radius
            });
            found.sort_unstable();
            let near: Vec<u32> = (0..points.len() as u32).filter(|&i| points[i as usize].distance(a) <= radius).collect();
            prop_assert_eq!(found, near);

            let mut found = vec![false; points.len()];
            tree.tube([a, b], radius, |id, p| {
                assert_eq!(p, points[id as usize]);
                assert!(!std::mem::replace(&mut found[id as usize], true), "once");
                true
            });
            for (i, &p) in points.iter().enumerate() {
                prop_assert!(found[i] || segment_foot(a - p, b - p).0.sqrt() >= radius);
            }
        }
    }
}
