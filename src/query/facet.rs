//! How two triangles of a surface meet, exactly: whether in more than their edges.
//!
//! Each triangle meets the other's plane in a span of the line that the planes have in common; signs of determinants tell
//! where the spans begin and end, and which comes first (after Guigue and Devillers, "Fast and Robust Triangle-Triangle
//! Overlap Test Using Orientation Predicates", Journal of Graphics Tools 8(1), 2003). Here the ends also know whether they
//! lie on an edge.

use super::coplanar::{overlap, segment_meets, spine};
use super::exact::{TURN_ERROR, side, turn};
use glam::DVec3;

/// How two faces meet in more than their edges; the later outranks the earlier.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Contact {
    /// An edge or a vertex of the one lies on the inside of the other, and their insides do not meet. Whether the surface
    /// goes on to the other side there is not looked at.
    Touch,
    /// Their insides have points in common, but no area.
    Cross,
    /// They lie in one plane and have area in common.
    Overlap,
}

/// A triangle of a face made ready. Coordinates are those of a tree: differences and products of three lose nothing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facet {
    pub(super) at: [DVec3; 3],
    /// Whether the edge from a corner to the next is a cut: inside the face.
    pub(super) cuts: [bool; 3],
    /// The normal, rounded, and the sums of the magnitudes of the products in it.
    normal: DVec3,
    size: DVec3,
    /// Seen along this axis the triangle has area; none if it has no area.
    axis: Option<usize>,
}

/// Times the sum of the magnitudes of products of three differences: more than the rounding error of theirs (Shewchuk's
/// `o3derrboundA`, and a little).
const SIDE_ERROR: f64 = 4.0 * f64::EPSILON;

impl Facet {
    pub(crate) fn new(at: [DVec3; 3], cuts: [bool; 3]) -> Self {
        let [a, b, c] = at;
        let (u, v) = (b - a, c - a);
        let normal = u.cross(v);
        let size =
            DVec3::from([(1, 2), (2, 0), (0, 1)].map(|(j, k)| (u[j] * v[k]).abs() + (u[k] * v[j]).abs()));
        let longest = (0..3).max_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs())).unwrap_or(0);
        let axis = if normal[longest].abs() > size[longest] * TURN_ERROR {
            Some(longest)
        } else {
            (0..3).find(|&axis| turn(axis, a, b, c) != 0)
        };
        Self { at, cuts, normal, size, axis }
    }

    pub(crate) fn has_area(&self) -> bool {
        self.axis.is_some()
    }

    /// The side of the plane a point is on.
    #[inline]
    pub(super) fn side(&self, point: DVec3) -> i8 {
        let w = point - self.at[0];
        let (value, doubt) = (self.normal.dot(w), self.size.dot(w.abs()) * SIDE_ERROR);
        if value > doubt {
            1
        } else if value < -doubt {
            -1
        } else {
            side(self.at[0], self.at[1], self.at[2], point)
        }
    }

    /// The sides the corners of another triangle are on.
    fn sides(&self, other: &Self) -> [i8; 3] {
        other.at.map(|p| if self.at.contains(&p) { 0 } else { self.side(p) })
    }
}

/// How two triangles meet in more than edges of both, and a point where they do.
pub(crate) fn meet(s: &Facet, t: &Facet) -> Option<(Contact, DVec3)> {
    let (s_axis, t_axis) = match (s.axis, t.axis) {
        (Some(s_axis), Some(t_axis)) => (s_axis, t_axis),
        (Some(axis), None) => return segment_meets(spine(t.at), s, axis),
        (None, Some(axis)) => return segment_meets(spine(s.at), t, axis),
        (None, None) => return None,
    };
    if are_plainly_apart(s, t, s_axis) || are_plainly_apart(t, s, t_axis) {
        return None;
    }
    let of_t = s.sides(t);
    if are_beside(of_t) {
        return None;
    }
    if of_t == [0; 3] {
        return overlap(s, t, s_axis);
    }
    let of_s = t.sides(s);
    if are_beside(of_s) {
        return None;
    }
    let a = Span::new(s, of_s);
    // Along the same direction: the cross product of the normals in this order.
    let Span { low, high, open, single } = Span::new(t, of_t);
    let b = Span { low: high, high: low, open, single };
    let (before, after) = (order(&a.high, &b.low), order(&a.low, &b.high));
    if before > 0 || after < 0 {
        return None;
    }
    if before == 0 || after == 0 {
        let (of_s, of_t) = if before == 0 { (a.high, b.low) } else { (a.low, b.high) };
        let contact = contact(of_s.inside, of_t.inside)?;
        return Some((contact, if of_t.corner { of_t.place(s) } else { of_s.place(t) }));
    }
    let contact = contact(!a.single && a.open, !b.single && b.open)?;
    // The middle of the two ends in the middle.
    let along = s.normal.cross(t.normal);
    let mut ends = [a.low.place(t), a.high.place(t), b.low.place(s), b.high.place(s)];
    ends.sort_by(|p, q| p.dot(along).total_cmp(&q.dot(along)));
    Some((contact, (ends[1] + ends[2]) * 0.5))
}

pub(super) fn contact(of_s: bool, of_t: bool) -> Option<Contact> {
    match (of_s, of_t) {
        (true, true) => Some(Contact::Cross),
        (false, false) => None,
        _ => Some(Contact::Touch),
    }
}

fn are_beside(signs: [i8; 3]) -> bool {
    signs[0] != 0 && signs[0] == signs[1] && signs[0] == signs[2]
}

/// Whether two triangles with a common vertex or a common edge lie on two sides of a line when seen along an axis along
/// which the first has area. What neighbours mostly do; asks nothing exactly, so `false` means nothing.
#[inline]
fn are_plainly_apart(s: &Facet, t: &Facet, axis: usize) -> bool {
    let equal = s.at.map(|p| t.at.iter().position(|&q| p == q));
    let count = equal.iter().flatten().count();
    let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
    let sure = |u: DVec3, v: DVec3| {
        let (left, right) = (u[j] * v[k], u[k] * v[j]);
        if (left - right).abs() <= (left.abs() + right.abs()) * TURN_ERROR {
            0
        } else if left > right {
            1
        } else {
            -1
        }
    };
    if count == 1 {
        let Some((i, at)) = equal.iter().enumerate().find_map(|(i, e)| e.map(|e| (i, e))) else {
            return false;
        };
        let from = s.at[i];
        let [b, c] = [1, 2].map(|n| s.at[(i + n) % 3] - from);
        let [d, e] = [1, 2].map(|n| t.at[(at + n) % 3] - from);
        let (own, other) = (sure(b, c), sure(d, e));
        let (bd, be, cd, ce) = (sure(b, d), sure(b, e), sure(c, d), sure(c, e));
        let beyond = |x: i8, y: i8, sign: i8| sign != 0 && x == sign && y == sign;
        beyond(bd, be, -own) || beyond(cd, ce, own) || beyond(bd, cd, other) || beyond(be, ce, -other)
    } else if count == 2 {
        let i = (0..3).find(|&i| equal[i].is_some() && equal[(i + 1) % 3].is_some()).unwrap_or(0);
        let (Some(p), Some(q)) = (equal[i], equal[(i + 1) % 3]) else { return false };
        // The edge of the other triangle, from whichever corner.
        let edge = if (p + 1) % 3 == q { p } else { q };
        if p == q || s.cuts[i] || t.cuts[edge] {
            return false;
        }
        let (from, along) = (s.at[i], s.at[(i + 1) % 3] - s.at[i]);
        let (own, other) = (sure(along, s.at[(i + 2) % 3] - from), sure(along, t.at[(edge + 2) % 3] - from));
        own != 0 && other == -own
    } else {
        false
    }
}

/// Where a triangle's span of a line ends: where the line through two corners, off the other triangle's plane with at
/// least the second of them, meets that plane.
#[derive(Clone, Copy)]
pub(super) struct End {
    pub(super) from: DVec3,
    pub(super) to: DVec3,
    /// The sign by which the second is higher.
    pub(super) slope: i8,
    /// Whether the first corner is in the plane: then it is the end.
    pub(super) corner: bool,
    /// Whether the end is inside the face: on a cut.
    pub(super) inside: bool,
}

impl End {
    /// Where it is, given the triangle whose plane is met.
    pub(super) fn place(&self, other: &Facet) -> DVec3 {
        if self.corner {
            return self.from;
        }
        let [from, to] = [self.from, self.to].map(|p| other.normal.dot(p - other.at[0]).abs());
        let share = if from + to > 0.0 { from / (from + to) } else { 0.5 };
        self.from + (self.to - self.from) * share
    }
}

/// Which of an end of the one triangle and an end of the other comes first along the cross product of their normals: 1 if
/// the first does, 0 if they are one point.
fn order(a: &End, b: &End) -> i8 {
    if [b.from, b.to].iter().any(|p| a.from == *p || a.to == *p) {
        // A line through a common corner and another: they meet there.
        return 0;
    }
    let (u, v, w) = (a.to - a.from, b.from - a.from, b.to - a.from);
    let (x, y, z) = (u.cross(v), u.abs(), v.abs());
    let size = DVec3::new(y.y * z.z + y.z * z.y, y.z * z.x + y.x * z.z, y.x * z.y + y.y * z.x);
    let (value, doubt) = (x.dot(w), size.dot(w.abs()) * SIDE_ERROR);
    let sign =
        if value.abs() > doubt { if value > 0.0 { 1 } else { -1 } } else { side(a.from, a.to, b.from, b.to) };
    sign * a.slope * b.slope
}

/// What a triangle has in common with the plane of another that it is not beside.
struct Span {
    /// Along the cross product of its normal and the plane's.
    low: End,
    high: End,
    /// Whether what is between the ends is inside the face.
    open: bool,
    /// Whether the ends are one corner.
    single: bool,
}

impl Span {
    /// The span of a triangle whose corners are on these sides of a plane: neither all on one nor all in it.
    fn new(facet: &Facet, signs: [i8; 3]) -> Self {
        let end = |i: usize, j: usize, inside: bool| End {
            from: facet.at[i],
            to: facet.at[j],
            slope: (signs[j] - signs[i]).signum(),
            corner: signs[i] == 0,
            inside,
        };
        let crossing = |i: usize| end(i, (i + 1) % 3, facet.cuts[i]);
        let zeros = signs.iter().filter(|&&s| s == 0).count();
        let falls = |i: usize| signs[i] > 0 && signs[(i + 1) % 3] < 0;
        let rises = |i: usize| signs[i] < 0 && signs[(i + 1) % 3] > 0;
        match zeros {
            // Counter-clockwise around the triangle, facing up, the boundary falls on the left, where the line leads.
            0 => {
                let high = (0..3).find(|&i| falls(i)).unwrap_or(0);
                let low = (0..3).find(|&i| rises(i)).unwrap_or(0);
                Self { low: crossing(low), high: crossing(high), open: true, single: false }
            }
            1 => {
                let i = signs.iter().position(|&s| s == 0).unwrap_or(0);
                let j = (i + 1) % 3;
                let corner = end(i, j, false);
                if falls(j) {
                    Self { low: corner, high: crossing(j), open: true, single: false }
                } else if rises(j) {
                    Self { low: crossing(j), high: corner, open: true, single: false }
                } else {
                    Self { low: corner, high: corner, open: false, single: true }
                }
            }
            _ => {
                let k = signs.iter().position(|&s| s != 0).unwrap_or(0);
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                let (first, second) = (end(i, k, false), end(j, k, false));
                let (low, high) = if signs[k] > 0 { (second, first) } else { (first, second) };
                Self { low, high, open: facet.cuts[i], single: false }
            }
        }
    }
}
