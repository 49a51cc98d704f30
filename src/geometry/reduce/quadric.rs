//! Quadrics: sums of squared distances to planes.
//!
//! Garland and Heckbert, "Surface simplification using quadric error metrics", SIGGRAPH 1997. Each is kept about a point
//! of its own, near where it is small, so that the digits do not go into the distance from the origin.

use glam::DVec3;
use std::ops::{Add, Mul, Sub};

/// The sum of `weight * normal normalᵀ` over planes: xx xy xz yy yz zz.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Planes([f64; 6]);

/// The sum of `weight * distance^2` over planes, as a function of `x`: `xᵀAx + 2b·x + c`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Quadric {
    a: Planes,
    b: DVec3,
    c: f64,
}

impl Planes {
    /// One plane; the normal need not have unit length, its square counts.
    #[inline(always)]
    pub(super) fn one(normal: DVec3, weight: f64) -> Self {
        let (n, m) = (normal, normal * weight);
        Self([m.x * n.x, m.x * n.y, m.x * n.z, m.y * n.y, m.y * n.z, m.z * n.z])
    }

    /// The sum of the weights.
    #[inline(always)]
    pub(super) fn weight(&self) -> f64 {
        self.0[0] + self.0[3] + self.0[5]
    }

    #[inline(always)]
    fn times(&self, x: DVec3) -> DVec3 {
        let [xx, xy, xz, yy, yz, zz] = self.0;
        DVec3::new(
            xx * x.x + xy * x.y + xz * x.z,
            xy * x.x + yy * x.y + yz * x.z,
            xz * x.x + yz * x.y + zz * x.z,
        )
    }

    /// Two sums about the middle between two points: all of the one pass through the point at `-half`, all of the other
    /// through that at `half`.
    #[inline(always)]
    pub(super) fn joined(a: &Self, b: &Self, half: DVec3) -> Quadric {
        let (mut sum, mut difference) = (a.0, a.0);
        for i in 0..6 {
            sum[i] += b.0[i];
            difference[i] -= b.0[i];
        }
        let (sum, difference) = (Self(sum), Self(difference));
        Quadric { a: sum, b: difference.times(half), c: sum.times(half).dot(half) }
    }

    /// Where all of them pass through one point, as seen from the point at `by`.
    #[inline(always)]
    pub(super) fn about(&self, by: DVec3) -> Quadric {
        let b = self.times(by);
        Quadric { a: *self, b, c: b.dot(by) }
    }
}

impl Quadric {
    /// The same about the point at `by`.
    #[inline(always)]
    pub(super) fn about(&self, by: DVec3) -> Self {
        let turned = self.a.times(by);
        Self { a: self.a, b: self.b + turned, c: self.c + (self.b + self.b + turned).dot(by) }
    }

    #[inline(always)]
    pub(super) fn at_origin(&self) -> f64 {
        self.c
    }

    #[inline(always)]
    pub(super) fn at(&self, x: DVec3) -> f64 {
        (self.b + self.b + self.a.times(x)).dot(x) + self.c
    }

    /// The value where it is least, `least(pull)` says where.
    #[inline(always)]
    pub(super) fn at_least(&self, least: DVec3, pull: f64) -> f64 {
        self.b.dot(least) + self.c - pull * self.weight() * least.length_squared()
    }

    /// The sum of the weights.
    #[inline(always)]
    pub(super) fn weight(&self) -> f64 {
        self.a.weight()
    }

    /// Where it is least, drawn towards the point it is about by `pull` times its weight, so that there is one such place:
    /// on a plane or along a crease the one nearest to that point.
    #[inline(always)]
    pub(super) fn least(&self, pull: f64) -> Option<(DVec3, Factors)> {
        let factors = Factors::of(&self.a.0, pull * self.weight())?;
        Some((factors.solve(-self.b), factors))
    }
}

impl From<Planes> for Quadric {
    /// About the point through which all of them pass.
    fn from(a: Planes) -> Self {
        Self { a, b: DVec3::ZERO, c: 0.0 }
    }
}

impl Sub for Planes {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let mut a = self.0;
        a.iter_mut().zip(other.0).for_each(|(a, b)| *a -= b);
        Self(a)
    }
}

impl Mul<f64> for Planes {
    type Output = Self;

    #[inline(always)]
    fn mul(self, by: f64) -> Self {
        Self(self.0.map(|a| a * by))
    }
}

impl Add for Planes {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let mut a = self.0;
        a.iter_mut().zip(other.0).for_each(|(a, b)| *a += b);
        Self(a)
    }
}

impl Add for Quadric {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { a: self.a + other.a, b: self.b + other.b, c: self.c + other.c }
    }
}

/// A symmetric positive matrix after elimination without division (Bareiss, "Sylvester's identity and multistep
/// integer-preserving Gaussian elimination", 1968); keeps its digits where A is all but singular, which Cramer's rule does
/// not, and no division waits for another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Factors {
    /// The first row, and the second of what is left after the first step.
    xx: f64,
    xy: f64,
    xz: f64,
    yy: f64,
    yz: f64,
    /// Inverses of the pivots.
    inverse: DVec3,
}

impl Factors {
    #[inline(always)]
    fn of(&[xx, xy, xz, yy, yz, zz]: &[f64; 6], shift: f64) -> Option<Self> {
        let (xx, yy, zz) = (xx + shift, yy + shift, zz + shift);
        let (yy, yz, zz) = (xx * yy - xy * xy, xx * yz - xy * xz, xx * zz - xz * xz);
        let last = yy * zz - yz * yz;
        let is_positive = xx > 0.0 && yy > 0.0 && last > 0.0;
        let inverse = DVec3::new(1.0 / xx, 1.0 / yy, 1.0 / last);
        (is_positive && inverse.is_finite()).then_some(Self { xx, xy, xz, yy, yz, inverse })
    }

    #[inline(always)]
    pub(super) fn solve(&self, v: DVec3) -> DVec3 {
        let y = self.xx * v.y - self.xy * v.x;
        let z = self.xx * v.z - self.xz * v.x;
        let z = (self.yy * z - self.yz * y) * self.inverse.z;
        let y = (y - self.yz * z) * self.inverse.y;
        DVec3::new((v.x - self.xy * y - self.xz * z) * self.inverse.x, y, z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;

    #[test]
    fn three_planes_meet_where_their_sum_is_least() {
        let corner = dvec3(0.25, -0.5, 0.125);
        let planes = [dvec3(1., 1., 0.), dvec3(0., 1., -1.), dvec3(2., 0., 1.)];
        let sum = planes.iter().fold(Planes::default(), |q, &n| q + Planes::one(n, 1.0)).about(-corner);
        let (least, _) = sum.least(1e-14).expect("one place");
        assert!((least - corner).length() < 1e-12, "{least}");
        assert!(sum.at(corner).abs() < 1e-15);
        let far: f64 = planes.iter().map(|n| n.dot(DVec3::ONE - corner).powi(2)).sum();
        assert!((sum.at(DVec3::ONE) - far).abs() < 1e-12);
    }

    #[test]
    fn on_a_plane_the_nearest_place_is_taken() {
        let q = Planes::one(DVec3::Z, 3.0).about(dvec3(5., 7., -1.));
        let (least, _) = q.least(1e-10).expect("one place");
        assert!((least - DVec3::Z).length() < 1e-9, "{least}");
        assert_eq!(q.weight(), 3.0);
    }
}
