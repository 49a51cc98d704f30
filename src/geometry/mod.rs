//! Geometry on the indexed form and the mesh: the shared triangulation rule, normals, measures; transforms, weld,
//! subdivision, smoothing and the filling of holes in bulk.

pub(crate) mod deform;
pub(crate) mod fill;
pub(crate) mod measure;
pub(crate) mod normals;
pub(crate) mod reduce;
pub(crate) mod slivers;
pub(crate) mod smooth;
pub(crate) mod subdivide;
pub(crate) mod transform;
pub(crate) mod triangulate;
pub(crate) mod weld;

use glam::DVec3;

/// The power of two that brings the largest coordinate of all points to about one, so that products of coordinates
/// neither overflow nor vanish. 1 if there is nothing to scale.
pub(crate) fn unit_scale(points: impl Iterator<Item = DVec3>) -> f64 {
    // One instruction each, where `f64::max` takes four to see to NaN; a comparison leaves it out as well.
    let larger = |m: f64, x: f64| if x.abs() > m { x.abs() } else { m };
    let largest = points.fold(0.0, |m, p| larger(larger(larger(m, p.x), p.y), p.z));
    if largest > 0.0 && largest.is_finite() {
        // 2^-exponent, kept where it and its inverse are normal numbers.
        let exponent = (largest.to_bits() >> 52) as i64 - 1023;
        f64::from_bits(((1023 - exponent.clamp(-1000, 1000)) as u64) << 52)
    } else {
        1.0
    }
}

/// The direction of a vector, or zero if it has none; safe for any length.
#[inline]
pub(crate) fn direction(v: DVec3) -> DVec3 {
    let scale = unit_scale(std::iter::once(v));
    let scaled = v * scale;
    let length = scaled.length();
    if length > 0.0 && length.is_finite() { scaled / length } else { DVec3::ZERO }
}

/// The distance of two points; safe for any two, infinite if it is beyond f64.
pub(crate) fn distance(a: DVec3, b: DVec3) -> f64 {
    let apart = b - a;
    let scale = unit_scale(std::iter::once(apart));
    (apart * scale).length() / scale
}
