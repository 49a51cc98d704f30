//! Signs of small polynomials in coordinates, exact: the ground on which rays are told to pass left or right.
//!
//! Sums of products are kept as expansions, lists of numbers that do not overlap (Shewchuk, "Adaptive Precision
//! Floating-Point Arithmetic and Fast Robust Geometric Predicates", Discrete & Computational Geometry 18, 1997). Nothing
//! is lost as long as products neither overflow nor underflow; [`rounded`] sees to that.

use glam::DVec3;
use smallvec::SmallVec;

/// The grid on which all coordinates lie: a product of three is still a number.
const GRID: f64 = f64::from_bits((1023 - 340) << 52);

/// Numbers below this do not fit the grid at full precision.
const COARSE: f64 = f64::from_bits((1023 - 286) << 52);

/// The vector on the grid of 2^-340. Changes only components below 2^-286.
pub(crate) fn rounded(v: DVec3) -> DVec3 {
    let on_grid = |x: f64| if x.abs() < COARSE { (x / GRID).round() * GRID } else { x };
    DVec3::from(v.to_array().map(on_grid))
}

/// An exact sum.
#[derive(Default)]
struct Exact {
    /// Not overlapping, ascending in magnitude, none zero.
    parts: SmallVec<[f64; 32]>,
}

impl Exact {
    fn add(&mut self, x: f64) {
        let mut carry = x;
        let mut kept = 0;
        for i in 0..self.parts.len() {
            let (sum, lost) = two_sum(carry, self.parts[i]);
            carry = sum;
            if lost != 0.0 {
                self.parts[kept] = lost;
                kept += 1;
            }
        }
        self.parts.truncate(kept);
        if carry != 0.0 {
            self.parts.push(carry);
        }
    }

    fn add_product(&mut self, a: f64, b: f64) {
        let (high, low) = two_product(a, b);
        if low != 0.0 {
            self.add(low);
        }
        if high != 0.0 {
            self.add(high);
        }
    }

    fn add_product3(&mut self, a: f64, b: f64, c: f64) {
        let (high, low) = two_product(a, b);
        self.add_product(low, c);
        self.add_product(high, c);
    }

    /// Adds the determinant of three columns.
    fn add_determinant(&mut self, a: DVec3, b: DVec3, c: DVec3) {
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            self.add_product3(a[i], b[j], c[k]);
            self.add_product3(-a[i], b[k], c[j]);
        }
    }

    /// Adds a component of a cross product.
    fn add_cross(&mut self, a: DVec3, b: DVec3, axis: usize) {
        let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
        self.add_product(a[j], b[k]);
        self.add_product(-a[k], b[j]);
    }

    fn sign(&self) -> i8 {
        self.parts.last().map_or(0, |&x| if x > 0.0 { 1 } else { -1 })
    }
}

fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    (product, a.mul_add(b, -product))
}

/// On which side of the plane of `a`, `b` and `c` a point is: 1 where their normal points, 0 in the plane.
#[cold]
pub(crate) fn side(a: DVec3, b: DVec3, c: DVec3, point: DVec3) -> i8 {
    let mut sum = Exact::default();
    if let (Some(a), Some(b), Some(c)) = (difference(a, point), difference(b, point), difference(c, point)) {
        sum.add_determinant(a, b, c);
    } else {
        sum.add_determinant(a, b, c);
        sum.add_determinant(-point, b, c);
        sum.add_determinant(a, -point, c);
        sum.add_determinant(a, b, -point);
    }
    -sum.sign()
}

/// Which way the path `a`, `b`, `c` turns, seen against an axis: 1 to the left, 0 not at all.
pub(crate) fn turn(axis: usize, a: DVec3, b: DVec3, c: DVec3) -> i8 {
    let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
    let (left, right) = ((b[j] - a[j]) * (c[k] - a[k]), (b[k] - a[k]) * (c[j] - a[j]));
    if (left - right).abs() > (left.abs() + right.abs()) * TURN_ERROR {
        return if left > right { 1 } else { -1 };
    }
    let mut sum = Exact::default();
    if let (Some(b), Some(c)) = (difference(b, a), difference(c, a)) {
        sum.add_cross(b, c, axis);
    } else {
        sum.add_cross(a, b, axis);
        sum.add_cross(b, c, axis);
        sum.add_cross(c, a, axis);
    }
    sum.sign()
}

/// Times the sum of the magnitudes of two products of differences: more than the rounding error of theirs (Shewchuk's
/// `ccwerrboundA`, and a little).
pub(crate) const TURN_ERROR: f64 = 2.0 * f64::EPSILON;

/// The difference, if nothing is rounded.
fn difference(a: DVec3, b: DVec3) -> Option<DVec3> {
    let (difference, lost) = (a - b, |i: usize| two_sum(a[i], -b[i]).1);
    (lost(0) == 0.0 && lost(1) == 0.0 && lost(2) == 0.0).then_some(difference)
}

/// A line through `origin`, for which sides are decided exactly.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    pub(crate) origin: DVec3,
    pub(crate) direction: DVec3,
}

impl Line {
    /// On which side the line passes the directed segment: the sign of `direction . ((p - origin) x (q - origin))`.
    pub(crate) fn side(&self, p: DVec3, q: DVec3) -> i8 {
        // In Plücker's form, d . (p x q) + (d x o) . (p - q), nothing but coordinates is multiplied.
        let (d, o) = (self.direction, self.origin);
        let mut sum = Exact::default();
        sum.add_determinant(d, p, q);
        sum.add_determinant(d, o, p);
        sum.add_determinant(d, q, o);
        sum.sign()
    }

    /// The side of a segment that the line meets, once the line is moved by an infinitesimal `(e, e^2, e^3)`: zero only
    /// if the segment is parallel to it, and opposite for the reversed segment.
    pub(crate) fn moved_side(&self, p: DVec3, q: DVec3) -> i8 {
        let slope = |axis| {
            let mut sum = Exact::default();
            sum.add_cross(p, self.direction, axis);
            sum.add_cross(-q, self.direction, axis);
            sum.sign()
        };
        (0..3).map(slope).find(|&s| s != 0).unwrap_or(0)
    }

    /// The signs of the components of `(p - origin) x direction`: all zero if the point is on the line.
    pub(crate) fn moment(&self, p: DVec3) -> [i8; 3] {
        [0, 1, 2].map(|axis| {
            let mut sum = Exact::default();
            sum.add_cross(p, self.direction, axis);
            sum.add_cross(-self.origin, self.direction, axis);
            sum.sign()
        })
    }

    /// For a segment that crosses the line: the sign of the parameter where it does.
    pub(crate) fn ahead(&self, p: DVec3, q: DVec3) -> i8 {
        let o = self.origin;
        for axis in 0..3 {
            let mut below = Exact::default();
            below.add_cross(self.direction, q, axis);
            below.add_cross(self.direction, -p, axis);
            if below.sign() != 0 {
                let mut above = Exact::default();
                above.add_cross(p, q, axis);
                above.add_cross(o, p, axis);
                above.add_cross(q, o, axis);
                return above.sign() * below.sign();
            }
        }
        0
    }

    /// The sign of the determinant of the corners seen from the origin: zero if it lies in their plane.
    pub(crate) fn origin_side(&self, [a, b, c]: [DVec3; 3]) -> i8 {
        -side(a, b, c, self.origin)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;

    #[test]
    fn sums_that_cancel_to_the_last_bit_keep_their_sign() {
        let mut sum = Exact::default();
        for x in [1e300, 1.0, -1e300, 1e-300, -1.0] {
            sum.add(x);
        }
        assert_eq!(sum.sign(), 1);
        sum.add(-1e-300);
        assert_eq!(sum.sign(), 0);
    }

    #[test]
    fn a_line_through_a_point_of_a_segment_is_on_no_side_and_an_ulp_decides() {
        let line = Line { origin: dvec3(0.1, 0.7, -3.0), direction: dvec3(0.3, 0.3, 1.0) };
        let p = line.origin + dvec3(0.0, 1.0, 0.0);
        let on = line.origin;
        assert_eq!(line.side(p, on), 0);
        let off = dvec3(on.x.next_up(), on.y, on.z);
        assert_ne!(line.side(p, off), 0);
        assert_eq!(line.side(p, off), -line.side(off, p));
        assert_ne!(line.moved_side(p, on), 0);
        let exact = Line { origin: dvec3(0.125, 0.75, -3.0), direction: dvec3(0.25, 0.5, 1.0) };
        let ahead = exact.origin + 2.0 * exact.direction;
        assert_eq!(exact.moved_side(exact.origin, ahead), 0, "parallel, as nothing is rounded");
    }

    #[test]
    fn tiny_components_are_rounded_to_the_grid_and_others_are_not() {
        let v = dvec3(1.0 / 3.0, -1e-80, 5e-324);
        let r = rounded(v);
        assert_eq!((r.x, r.y, r.z), (v.x, v.y, 0.0));
        assert!((rounded(DVec3::splat(1e-95)).x / 1e-95 - 1.0).abs() < 1e-6);
    }
}
