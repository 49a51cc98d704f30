//! How triangles in one plane meet, and triangles without area any other: the rest of [`meet`](super::facet::meet).

use super::exact::{side, turn};
use super::facet::{Contact, End, Facet, contact};
use glam::DVec3;
use smallvec::SmallVec;

/// How two triangles in one plane meet, seen along an axis along which they have area.
pub(crate) fn overlap(s: &Facet, t: &Facet, axis: usize) -> Option<(Contact, DVec3)> {
    // By edge of the one and corner of the other: whether the corner is on the side of the edge's own triangle.
    let sides = |s: &Facet, t: &Facet| {
        let own = turn(axis, s.at[0], s.at[1], s.at[2]);
        [0, 1, 2].map(|i| {
            let (p, q) = (s.at[i], s.at[(i + 1) % 3]);
            t.at.map(|r| if r == p || r == q { 0 } else { turn(axis, p, q, r) * own })
        })
    };
    let (of_t, of_s) = (sides(s, t), sides(t, s));
    if of_s.iter().chain(&of_t).any(|edge| edge.iter().all(|&sign| sign <= 0)) {
        return beside_cut(s, t, axis);
    }
    // The corners of what they have in common.
    let within = |facet: &Facet, sides: [[i8; 3]; 3]| {
        let corners = (0..3).filter(move |&j| sides.iter().all(|edge| edge[j] >= 0));
        corners.map(|j| facet.at[j]).collect::<SmallVec<[DVec3; 3]>>()
    };
    let mut corners: SmallVec<[DVec3; 12]> = within(t, of_t).into_iter().chain(within(s, of_s)).collect();
    for i in 0..3 {
        for j in 0..3 {
            let (k, l) = ((i + 1) % 3, (j + 1) % 3);
            if of_t[i][j] * of_t[i][l] < 0 && of_s[j][i] * of_s[j][k] < 0 {
                corners.push(crossing(axis, [s.at[i], s.at[k]], [t.at[j], t.at[l]]));
            }
        }
    }
    let place = corners.iter().sum::<DVec3>() / corners.len() as f64;
    Some((Contact::Overlap, place))
}

/// For triangles in one plane without common area: whether they meet in a cut.
fn beside_cut(s: &Facet, t: &Facet, axis: usize) -> Option<(Contact, DVec3)> {
    let mut found = None;
    for i in 0..3 {
        for j in 0..3 {
            let (a, b) = ([s.at[i], s.at[(i + 1) % 3]], [t.at[j], t.at[(j + 1) % 3]]);
            let of_s = s.cuts[i] && meets_open(axis, a, b);
            let of_t = t.cuts[j] && meets_open(axis, b, a);
            let contact = contact(of_s, of_t).map(|contact| (contact, common(axis, a, b)));
            if contact.map(|c| c.0) > found.map(|f: (Contact, DVec3)| f.0) {
                found = contact;
            }
        }
    }
    found
}

/// Whether a segment without its ends meets another with its ends, both in a plane that is seen along an axis.
fn meets_open(axis: usize, [u, w]: [DVec3; 2], [p, q]: [DVec3; 2]) -> bool {
    let (of_p, of_q) = (turn(axis, u, w, p), turn(axis, u, w, q));
    if of_p * of_q > 0 {
        false
    } else if of_p == 0 && of_q == 0 {
        let [u, w, p, q] = [u, w, p, q].map(|x| rank(axis, x));
        let (first, last) = if p < q { (p, q) } else { (q, p) };
        let (low, high) = if u < w { (u, w) } else { (w, u) };
        last > low && first < high
    } else {
        turn(axis, p, q, u) * turn(axis, p, q, w) < 0
    }
}

/// Orders the points of a line.
fn rank(axis: usize, point: DVec3) -> [f64; 2] {
    [point[(axis + 1) % 3], point[(axis + 2) % 3]]
}

/// A point that two segments of a plane have in common, given that they meet.
fn common(axis: usize, a: [DVec3; 2], b: [DVec3; 2]) -> DVec3 {
    if [b[0], b[1]].iter().any(|&p| turn(axis, a[0], a[1], p) != 0) {
        return crossing(axis, a, b);
    }
    let mut ends = [a[0], a[1], b[0], b[1]];
    ends.sort_by(|p, q| rank(axis, *p).partial_cmp(&rank(axis, *q)).unwrap_or(std::cmp::Ordering::Equal));
    (ends[1] + ends[2]) * 0.5
}

/// Where the line through two points meets a segment.
fn crossing(axis: usize, [u, w]: [DVec3; 2], [p, q]: [DVec3; 2]) -> DVec3 {
    let height = |x: DVec3| (w - u).cross(x - u)[axis].abs();
    let (of_p, of_q) = (height(p), height(q));
    p + (q - p) * if of_p + of_q > 0.0 { of_p / (of_p + of_q) } else { 0.5 }
}

/// The ends of a triangle without area.
pub(crate) fn spine(at: [DVec3; 3]) -> [DVec3; 2] {
    let less = |p: &DVec3, q: &DVec3| p.to_array() < q.to_array();
    let [mut low, mut high] = [at[0]; 2];
    for p in at {
        low = if less(&p, &low) { p } else { low };
        high = if less(&high, &p) { p } else { high };
    }
    [low, high]
}

/// Whether a segment, or a point, meets the inside of a triangle that has area along an axis.
pub(crate) fn segment_meets([p, q]: [DVec3; 2], t: &Facet, axis: usize) -> Option<(Contact, DVec3)> {
    let edge = |i: usize| [t.at[i], t.at[(i + 1) % 3]];
    let (of_p, of_q) = (t.side(p), t.side(q));
    if of_p * of_q > 0 {
        return None;
    }
    if of_p != 0 || of_q != 0 {
        let signs = [0, 1, 2].map(|i| side(p, q, edge(i)[0], edge(i)[1]));
        let zeros = signs.iter().filter(|&&s| s == 0).count();
        let is_within = !(signs.contains(&1) && signs.contains(&-1));
        let is_inside = zeros == 0 || zeros == 1 && (0..3).any(|i| signs[i] == 0 && t.cuts[i]);
        let end = End { from: p, to: q, slope: 0, corner: of_p == 0, inside: false };
        let place = if of_q == 0 { q } else { end.place(t) };
        return (is_within && is_inside).then_some((Contact::Touch, place));
    }
    let own = turn(axis, t.at[0], t.at[1], t.at[2]);
    let signs = [0, 1, 2].map(|i| [p, q].map(|x| turn(axis, edge(i)[0], edge(i)[1], x) * own));
    let across = t.at.map(|x| turn(axis, p, q, x));
    let is_through = p == q || across.contains(&1) && across.contains(&-1);
    if is_through && signs.iter().all(|of| of[0] > 0 || of[1] > 0) {
        // The middle of what is left between the edges.
        let height = |i: usize, x: DVec3| {
            let [a, b] = edge(i);
            (b - a).cross(x - a)[axis] * f64::from(own)
        };
        let (mut from, mut to) = (0.0f64, 1.0f64);
        for (i, signs) in signs.iter().enumerate() {
            let (a, b) = (height(i, p), height(i, q));
            match signs {
                [-1, 1] => from = from.max(a / (a - b)),
                [1, -1] => to = to.min(a / (a - b)),
                _ => {}
            }
        }
        return Some((Contact::Touch, p + (q - p) * ((from + to) * 0.5).clamp(0.0, 1.0)));
    }
    let cut = (0..3).find(|&i| t.cuts[i] && meets_open(axis, edge(i), [p, q]))?;
    Some((Contact::Touch, common(axis, edge(cut), [p, q])))
}
