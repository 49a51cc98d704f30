//! Rays and nearest points in rational arithmetic, over all triangles.

use super::{Point, Triangle, is_on};
use std::cmp::Ordering;

/// What a ray meets: where, how it goes on (1 out, -1 in, 0 a touch), and whether that can be at a vertex, on an edge, or
/// inside a face.
#[derive(Clone, Debug)]
pub(crate) struct Event {
    /// Above and below, below positive.
    pub(crate) t: (i128, i128),
    pub(crate) crossing: i32,
    pub(crate) kinds: [bool; 3],
}

fn compare(a: (i128, i128), b: (i128, i128)) -> Ordering {
    (a.0 * b.1).cmp(&(b.0 * a.1))
}

/// The parameter of a point of the line.
fn parameter(x: Point, origin: Point, direction: Point) -> (i128, i128) {
    // (x - o) . d / d . d
    let v = x.minus(origin);
    (v.dot(direction) * direction.d, v.d * direction.dot(direction))
}

/// The ends of what a line has in common with a triangle.
fn span(t: &Triangle, origin: Point, direction: Point) -> Option<[Point; 2]> {
    let n = t.normal();
    let slope = n.dot(direction);
    if t.has_area() && slope != 0 {
        let v = t.at[0].minus(origin);
        let x = origin.plus(direction, n.dot(v) * direction.d, slope * v.d);
        return t.contains(x).then_some([x, x]);
    }
    let on_line = |x: Point| x.minus(origin).cross(direction).is_zero();
    let mut met: Vec<Point> = t.at.into_iter().filter(|&x| on_line(x)).collect();
    met.extend((0..3).filter_map(|i| on_edge(t.edge(i), origin, direction)));
    let order =
        |a: &Point, b: &Point| compare(parameter(*a, origin, direction), parameter(*b, origin, direction));
    Some([met.iter().copied().min_by(order)?, met.iter().copied().max_by(order)?])
}

/// How the line, moved a little, passes a triangle; `None` if it meets an edge or is parallel all the same.
fn passes(t: &Triangle, origin: Point, direction: Point) -> Option<i32> {
    let mut sides = [0; 3];
    for (i, side) in sides.iter_mut().enumerate() {
        let [p, q] = t.edge(i);
        *side = direction.dot(p.minus(origin).cross(q.minus(origin))).signum();
    }
    let slope = t.normal().dot(direction).signum();
    if slope == 0 {
        // In its plane, or beside it: moved off it, whichever way.
        return Some(0);
    }
    if sides.contains(&1) && sides.contains(&-1) {
        return Some(0);
    }
    (!sides.contains(&0)).then_some(slope as i32)
}

/// All meetings of a ray with the surface, sorted; as [`hits`](meshwright::MeshIndex::hits) says.
pub(crate) fn hits(all: &[Triangle], origin: Point, direction: Point) -> Vec<Event> {
    let met: Vec<(usize, [Point; 2])> =
        (0..all.len()).filter_map(|i| Some((i, span(&all[i], origin, direction)?))).collect();
    let on_line = |x: Point| x.minus(origin).cross(direction).is_zero();
    let is_ahead = |x: Point| parameter(x, origin, direction).0 >= 0;
    // Triangles hang together at a vertex on the line, or at an edge that the line meets; not behind the origin.
    let share = |a: &Triangle, b: &Triangle| {
        let same = |i: usize, j: usize| a.vertices[i] == b.vertices[j];
        (0..3).any(|i| {
            (0..3).any(|j| {
                let edge = same(i, (j + 1) % 3)
                    && same((i + 1) % 3, j)
                    && (a.face == b.face || a.is_side[i] && b.is_side[j]);
                same(i, j) && on_line(a.at[i]) && is_ahead(a.at[i])
                    || edge && on_edge(a.edge(i), origin, direction).is_some_and(is_ahead)
            })
        })
    };
    let mut group: Vec<usize> = (0..met.len()).collect();
    for i in 0..met.len() {
        for j in 0..i {
            if group[i] != group[j] && share(&all[met[i].0], &all[met[j].0]) {
                let (from, to) = (group[i], group[j]);
                group.iter_mut().filter(|g| **g == from).for_each(|g| *g = to);
            }
        }
    }
    let mut events = Vec::new();
    for id in 0..met.len() {
        let own: Vec<_> = (0..met.len()).filter(|&i| group[i] == id).map(|i| met[i]).collect();
        if own.is_empty() {
            continue;
        }
        let at = |x: Point| parameter(x, origin, direction);
        let begin = own.iter().map(|m| at(m.1[0])).min_by(|a, b| compare(*a, *b)).expect("not empty");
        let last = own.iter().map(|m| at(m.1[1])).max_by(|a, b| compare(*a, *b)).expect("not empty");
        if last.0 < 0 {
            continue;
        }
        let is_rim = own.iter().any(|&(i, _)| {
            (0..3).any(|k| {
                let (a, b) = (all[i].vertices[k], all[i].vertices[(k + 1) % 3]);
                let has = |t: &Triangle, v: u32, w: u32| {
                    (0..3).any(|j| t.is_side[j] && t.vertices[j] == v && t.vertices[(j + 1) % 3] == w)
                };
                let is_open =
                    |v: u32, w: u32| all.iter().any(|t| has(t, v, w)) && !all.iter().any(|t| has(t, w, v));
                let at_vertex = on_line(all[i].at[k])
                    && all.iter().flat_map(|t| t.vertices).any(|w| is_open(a, w) || is_open(w, a));
                at_vertex
                    || all[i].is_side[k] && is_open(a, b) && meets_edge(all[i].edge(k), origin, direction)
            })
        });
        let sum = if begin.0 < 0 || is_rim { 0 } else { sum(all, &own, origin, direction) };
        let t = if begin.0 < 0 { (0, 1) } else { begin };
        let x = origin.plus(direction, t.0, t.1);
        let mut kinds = [false; 3];
        for &(i, _) in own.iter().filter(|m| all[m.0].contains(x)) {
            let t = &all[i];
            // Both, where a vertex lies on an edge.
            let is_vertex = t.at.contains(&x);
            let on_side = |k: usize| t.is_side[k] && !t.edge(k).contains(&x) && is_on(x, t.edge(k));
            let is_edge = (0..3).any(on_side);
            kinds = [kinds[0] | is_vertex, kinds[1] | is_edge, kinds[2] | !(is_vertex || is_edge)];
        }
        let event = Event { t, crossing: sum.signum(), kinds };
        events.extend(std::iter::repeat_n(event, sum.unsigned_abs().max(1) as usize));
    }
    events.sort_by(|a, b| compare(a.t, b.t));
    events
}

fn meets_edge(edge: [Point; 2], origin: Point, direction: Point) -> bool {
    let [p, q] = edge;
    let (a, b) = (p.minus(origin).cross(direction), q.minus(origin).cross(direction));
    a.cross(b).is_zero() && a.dot(b) <= 0
}

/// The one point that a line has in common with a segment that is not on it.
fn on_edge([p, q]: [Point; 2], origin: Point, direction: Point) -> Option<Point> {
    let (m, along) = (p.minus(origin).cross(direction), q.minus(p).cross(direction));
    if along.is_zero() || !m.cross(along).is_zero() {
        return None;
    }
    // p + s (q - p) with (p + s (q - p) - o) x d = 0.
    let x = p.plus(q.minus(p), -m.dot(along) * along.d, along.dot(along) * m.d);
    (is_on(x, [p, q]) && x.minus(origin).cross(direction).is_zero()).then_some(x)
}

/// How the triangles are passed in all by the line moved a little, in a direction in which it meets no edge.
fn sum(all: &[Triangle], own: &[(usize, [Point; 2])], origin: Point, direction: Point) -> i32 {
    for odd in (1..).step_by(2) {
        let step = Point { n: [3 * odd, 7 * odd + 2, 11 - 5 * odd], d: 1 << 22 };
        let moved = origin.plus(step, 1, 1);
        let each: Option<Vec<i32>> = own.iter().map(|m| passes(&all[m.0], moved, direction)).collect();
        if let Some(each) = each {
            return each.iter().sum();
        }
        assert!(odd < 50, "no way is free");
    }
    0
}

/// The square of the distance of a point from a triangle, above and below.
pub(crate) fn square(t: &Triangle, p: Point) -> (i128, i128) {
    let far = |x: Point| {
        let v = x.minus(p);
        (v.dot(v), v.d * v.d)
    };
    let n = t.normal();
    if t.has_area() {
        let v = t.at[0].minus(p);
        // p + n (n . v) / (n . n)
        let x = p.plus(n, n.dot(v) * n.d, n.dot(n) * v.d);
        if t.contains(x) {
            return far(x);
        }
    }
    (0..3).map(|i| segment_square(t.edge(i), p)).min_by(|a, b| compare(*a, *b)).expect("three")
}

pub(crate) fn segment_square([a, b]: [Point; 2], p: Point) -> (i128, i128) {
    let (v, w) = (b.minus(a), p.minus(a));
    let (above, below) = (v.dot(w) * v.d, v.dot(v) * w.d);
    let x = if above <= 0 || below == 0 {
        a
    } else if above >= below {
        b
    } else {
        a.plus(v, above, below)
    };
    let d = x.minus(p);
    (d.dot(d), d.d * d.d)
}
