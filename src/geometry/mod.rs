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
pub(crate) mod triangles;
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

/// Whether all coordinates are zero or so far from the ends of the range that neither products of two differences nor
/// sums of those overflow or lose digits: then scaling by a power of two changes no bit of a direction.
pub(crate) fn is_tame(mut points: impl Iterator<Item = DVec3>) -> bool {
    let is_tame = |x: f64| x == 0.0 || (x.abs() > 1e-60) & (x.abs() < 1e60);
    points.all(|p| is_tame(p.x) & is_tame(p.y) & is_tame(p.z))
}

/// The same of many points, several at once.
pub(crate) fn are_tame(points: &[DVec3]) -> bool {
    let is_tame = |x: f64| (x == 0.0) | ((x.abs() > 1e-60) & (x.abs() < 1e60));
    let tame = |p: &DVec3| is_tame(p.x) & is_tame(p.y) & is_tame(p.z);
    points.chunks(64).all(|block| block.iter().fold(true, |all, p| all & tame(p)))
}

/// The direction of a vector, or zero if it has none; safe for any length.
#[inline]
pub(crate) fn direction(v: DVec3) -> DVec3 {
    // Within this range scaling by a power of two changes no bit, but of components that all but vanish.
    let square = v.length_squared();
    if square > 1e-240 && square < 1e240 { v / square.sqrt() } else { scaled_direction(v) }
}

/// For lengths whose squares overflow or vanish.
#[cold]
fn scaled_direction(v: DVec3) -> DVec3 {
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
