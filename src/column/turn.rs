//! Values that point somewhere, and what maps of space make of them.

use crate::geometry::{direction, distance, unit_scale};
use glam::{DMat3, DVec3, DVec4, Vec3, Vec4};

/// Values that point somewhere: a vector, and perhaps a handedness behind it. The fourth number of [`DVec4`] and [`Vec4`]
/// is one, 1 or -1, as glTF has it: the bitangent is `normal.cross(tangent) * handedness`.
pub trait Direction: Clone + 'static {
    /// The vector, if there is one.
    fn vector(&self) -> Option<DVec3>;
    /// The same value with another vector; if `flips`, the handedness changes its sign.
    fn with_vector(&self, vector: DVec3, flips: bool) -> Self;
}

impl Direction for DVec3 {
    fn vector(&self) -> Option<DVec3> {
        Some(*self)
    }

    fn with_vector(&self, vector: DVec3, _: bool) -> Self {
        vector
    }
}

impl Direction for Vec3 {
    fn vector(&self) -> Option<DVec3> {
        Some(self.as_dvec3())
    }

    fn with_vector(&self, vector: DVec3, _: bool) -> Self {
        narrow(vector)
    }
}

impl Direction for DVec4 {
    fn vector(&self) -> Option<DVec3> {
        Some(self.truncate())
    }

    fn with_vector(&self, vector: DVec3, flips: bool) -> Self {
        vector.extend(if flips { -self.w } else { self.w })
    }
}

impl Direction for Vec4 {
    fn vector(&self) -> Option<DVec3> {
        Some(self.truncate().as_dvec3())
    }

    fn with_vector(&self, vector: DVec3, flips: bool) -> Self {
        narrow(vector).extend(if flips { -self.w } else { self.w })
    }
}

impl<D: Direction> Direction for Option<D> {
    fn vector(&self) -> Option<DVec3> {
        self.as_ref()?.vector()
    }

    fn with_vector(&self, vector: DVec3, flips: bool) -> Self {
        self.as_ref().map(|value| value.with_vector(vector, flips))
    }
}

/// In single precision; what is too long for it loses its length, not its direction.
fn narrow(vector: DVec3) -> Vec3 {
    let narrow = vector.as_vec3();
    if narrow.is_finite() || !vector.is_finite() { narrow } else { direction(vector).as_vec3() }
}

/// What a map of space, or a flip of the winding, does to vectors: what [`Rule::turning`](super::Rule::turning) is told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turning {
    linear: DMat3,
    normals: Bend,
    flips: bool,
}

/// What becomes of normals.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Bend {
    Keep,
    Negate,
    /// The linear part itself keeps lengths and angles.
    Rotate,
    /// The inverse transpose of the linear part, up to a factor, of what is scaled along the axes first.
    By(DMat3, DVec3),
}

impl Turning {
    /// The winding reverses, and nothing moves.
    pub(crate) const REVERSAL: Self = Self { linear: DMat3::IDENTITY, normals: Bend::Negate, flips: true };

    /// Scaling by one factor; a negative one mirrors.
    pub(crate) fn scaling(factor: f64) -> Self {
        let flips = factor < 0.0;
        let normals = if flips { Bend::Negate } else { Bend::Keep };
        Self { linear: DMat3::from_diagonal(DVec3::splat(factor)), normals, flips }
    }

    pub(crate) fn rotation(linear: DMat3) -> Self {
        Self { linear, normals: Bend::Rotate, flips: false }
    }

    /// A linear map with its inverse transpose, which counts up to a positive factor and is that of what is scaled first by
    /// powers of two along the axes (their product might have no number), and whether it mirrors.
    pub(crate) fn affine(linear: DMat3, inverse_transpose: DMat3, scales: DVec3, flips: bool) -> Self {
        Self { linear, normals: Bend::By(inverse_transpose, scales), flips }
    }

    /// The linear part of the map; the identity where only the winding reverses.
    pub fn linear(&self) -> DMat3 {
        self.linear
    }

    /// Whether the winding of faces reverses: they were flipped, or the map mirrors.
    pub fn flips(&self) -> bool {
        self.flips
    }

    /// What a normal becomes: turned by the inverse transpose, so that it stays at right angles to what it was at right
    /// angles to, and on the side of the surface where it was; negated where only the winding reverses. Its length stays.
    pub fn normal(&self, normal: DVec3) -> DVec3 {
        if !normal.is_finite() {
            return normal;
        }
        let turned = match &self.normals {
            Bend::Keep => normal,
            Bend::Negate => -normal,
            Bend::Rotate => self.linear * normal,
            Bend::By(m, scales) => {
                let scaled = direction(normal) * *scales;
                let scaled = scaled * unit_scale(std::iter::once(scaled));
                direction(*m * scaled) * distance(DVec3::ZERO, normal)
            }
        };
        // As long as the largest numbers, it loses its length, not its direction.
        if turned.is_finite() { turned } else { direction(self.normal(direction(normal))) }
    }

    /// What a vector along the surface becomes, or any vector between two points: the linear part of the map of it, its
    /// length included.
    pub fn tangent(&self, tangent: DVec3) -> DVec3 {
        let turned = self.linear * tangent;
        if turned.is_finite() {
            return turned;
        }
        if !tangent.is_finite() {
            return tangent;
        }
        let scale = unit_scale(self.linear.to_cols_array_2d().into_iter().map(DVec3::from));
        direction(self.linear * scale * direction(tangent))
    }
}

/// What [`Rule::normals`](super::Rule::normals) makes of sources: their mean direction.
pub(super) fn mixed_normal<T: Direction>(sources: &[(&T, f64)]) -> T {
    mixed(sources, direction, direction)
}

/// What [`Rule::tangents`](super::Rule::tangents) makes of sources: their sum.
pub(super) fn mixed_tangent<T: Direction>(sources: &[(&T, f64)]) -> T {
    mixed(sources, |v| v, |v| v)
}

/// The sum of vectors, with what else the heaviest source holds. A source without a vector leaves none.
fn mixed<T: Direction>(
    sources: &[(&T, f64)],
    before: impl Fn(DVec3) -> DVec3,
    after: impl Fn(DVec3) -> DVec3,
) -> T {
    let (mut sum, mut heaviest) = (DVec3::ZERO, sources[0]);
    for &(value, weight) in sources.iter().filter(|s| s.1 != 0.0) {
        let Some(vector) = value.vector() else { return value.clone() };
        sum += before(vector) * weight;
        if weight > heaviest.1 {
            heaviest = (value, weight);
        }
    }
    heaviest.0.with_vector(after(sum), false)
}
