//! Translate, scale, rotate, and any affine map. Keys stay valid; a map that mirrors reverses the winding, so that
//! outside stays outside. Normals that the mesh carries, and columns of directions, turn along.

use super::direction;
use super::measure::Aabb;
use super::unit_scale;
use crate::column::Turning;
use crate::{Mesh, SetError, VertexKey};
use glam::{DAffine3, DMat3, DMat4, DVec3};

/// Why a mesh was not transformed; nothing has changed then.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TransformError {
    /// A number in the arguments is NaN or infinite.
    #[error("an argument is not finite")]
    NonFinite,
    /// A scale factor is zero.
    #[error("a scale factor is zero")]
    ZeroFactor,
    /// The axis of a rotation has no direction.
    #[error("the axis is zero")]
    ZeroAxis,
    /// The map flattens space.
    #[error("the matrix is singular")]
    Singular,
    /// The last row of a 4x4 matrix is not `0 0 0 1`: the map is projective.
    #[error("the last row of the matrix is {0:?}, not 0 0 0 1")]
    NotAffine([f64; 4]),
    /// The mesh has no vertices.
    #[error("there are no vertices")]
    Empty,
    /// A vertex would move beyond the largest number.
    #[error("{0:?} would leave the range of numbers")]
    OutOfRange(VertexKey),
}

impl From<SetError> for TransformError {
    fn from(error: SetError) -> Self {
        match error {
            SetError::Missing(v) | SetError::NonFinite(v) => Self::OutOfRange(v),
        }
    }
}

fn finite(values: &[DVec3]) -> Result<(), TransformError> {
    if values.iter().all(|v| v.is_finite()) { Ok(()) } else { Err(TransformError::NonFinite) }
}

/// The sine and cosine of an angle in degrees: exact at multiples of 90.
fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    // The remainder is exact, and the quarter turns are taken off before anything rounds.
    let turn = degrees % 360.0;
    let quarters = (turn / 90.0).round();
    let (s, c) = (turn - quarters * 90.0).to_radians().sin_cos();
    match quarters.rem_euclid(4.0) as u32 {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

/// The rotation about a unit axis (Rodrigues, "Des lois géométriques", Journal de Mathématiques 5, 1840).
fn rodrigues(axis: DVec3, degrees: f64) -> DMat3 {
    let (sin, cos) = sin_cos_degrees(degrees);
    let turned = |v: DVec3| v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos));
    DMat3::from_cols(turned(DVec3::X), turned(DVec3::Y), turned(DVec3::Z))
}

/// The inverse transpose up to a positive factor, and whether the map mirrors; `None` if it is singular.
fn inverse_transpose(m: &DMat3) -> Option<(DMat3, DVec3, bool)> {
    // Every column is brought to about one, so that small maps are not taken for singular ones. With M = N S, the
    // inverse transpose is that of N, its columns scaled alike by S.
    let scales = [m.x_axis, m.y_axis, m.z_axis].map(|c| unit_scale(std::iter::once(c)));
    let [x, y, z] = [m.x_axis * scales[0], m.y_axis * scales[1], m.z_axis * scales[2]];
    let determinant = x.cross(y).dot(z);
    if determinant == 0.0 || !determinant.is_finite() {
        return None;
    }
    let sign = determinant.signum();
    let cofactors = DMat3::from_cols(y.cross(z) * sign, z.cross(x) * sign, x.cross(y) * sign);
    Some((cofactors, DVec3::from(scales), sign < 0.0))
}

/// What a linear map does to vectors; `None` if it is singular.
fn affine(m: &DMat3) -> Option<Turning> {
    let (bend, scales, mirrors) = inverse_transpose(m)?;
    Some(Turning::affine(*m, bend, scales, mirrors))
}

impl Mesh {
    /// The smallest box around all vertices, isolated ones included; `None` if there are none. Its
    /// [`center`](Aabb::center) is a common origin to scale and rotate about. O(vertices).
    pub fn bounds(&self) -> Option<Aabb> {
        Aabb::around(self.vertices.live().map(|v| self.positions[v as usize]))
    }

    /// Adds a vector to every position. O(vertices).
    ///
    /// # Errors
    /// [`TransformError`] on a vector that is not finite, a mesh without vertices, or a vertex that would leave the range
    /// of numbers.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// mesh.translate(DVec3::Z)?;
    /// assert_eq!(mesh.bounds().unwrap().min, DVec3::Z);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn translate(&mut self, by: DVec3) -> Result<(), TransformError> {
        finite(&[by])?;
        self.map(|p| p + by, None)
    }

    /// Scales by one factor about an origin. A negative factor mirrors through the origin, and reverses the winding
    /// with it: the volume goes with the cube of the factor's size. Tangents in columns are scaled too.
    /// O(vertices), or O(elements) if it mirrors.
    ///
    /// # Errors
    /// [`TransformError`] on a factor of zero, an argument that is not finite, a mesh without vertices, or a vertex that
    /// would leave the range of numbers.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, TransformError, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    /// # let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &faces)?)?;
    /// let before = mesh.closed()?.volume();
    /// mesh.scale(-2.0, DVec3::ONE)?;
    /// assert!((mesh.closed()?.volume() - 8.0 * before).abs() < 1e-12);
    /// assert_eq!(mesh.scale(0.0, DVec3::ONE), Err(TransformError::ZeroFactor));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn scale(&mut self, factor: f64, origin: DVec3) -> Result<(), TransformError> {
        finite(&[DVec3::splat(factor), origin])?;
        if factor == 0.0 {
            return Err(TransformError::ZeroFactor);
        }
        self.map(|p| origin + (p - origin) * factor, Some(Turning::scaling(factor)))
    }

    /// Scales by a factor for each axis about an origin. If an odd number of them is negative, that mirrors, and the
    /// winding reverses. Normals turn by the inverse transpose, tangents in columns are scaled. O(vertices), or
    /// O(elements) if it mirrors.
    ///
    /// # Errors
    /// As [`scale`](Self::scale).
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::{DVec3, dvec3}};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// mesh.scale_axes(dvec3(3.0, 1.0, 1.0), DVec3::ZERO)?;
    /// assert_eq!(mesh.bounds().unwrap().max, dvec3(3.0, 1.0, 0.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn scale_axes(&mut self, factors: DVec3, origin: DVec3) -> Result<(), TransformError> {
        finite(&[factors, origin])?;
        if factors.min_element() == factors.max_element() {
            return self.scale(factors.x, origin);
        }
        let turning = affine(&DMat3::from_diagonal(factors)).ok_or(TransformError::ZeroFactor)?;
        self.map(|p| origin + (p - origin) * factors, Some(turning))
    }

    /// Rotates about an axis through an origin by an angle in degrees, counter-clockwise seen against the axis
    /// (Rodrigues). Multiples of 90 degrees about the coordinate axes are exact. Normals and tangents turn along.
    /// O(vertices).
    ///
    /// # Errors
    /// [`TransformError`] on an axis without direction, an argument that is not finite, a mesh without vertices, or a
    /// vertex that would leave the range of numbers.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// let v = mesh.vertices().nth(1).unwrap();
    /// mesh.rotate_degrees(DVec3::Z, 90.0, DVec3::ZERO)?;
    /// assert_eq!(mesh.position(v), DVec3::Y);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn rotate_degrees(&mut self, axis: DVec3, degrees: f64, origin: DVec3) -> Result<(), TransformError> {
        finite(&[axis, DVec3::splat(degrees), origin])?;
        let axis = direction(axis);
        if axis == DVec3::ZERO {
            return Err(TransformError::ZeroAxis);
        }
        let rotation = rodrigues(axis, degrees);
        self.map(|p| origin + rotation * (p - origin), Some(Turning::rotation(rotation)))
    }

    /// Applies an affine map. One that mirrors reverses the winding; normals turn by the inverse transpose and keep their
    /// lengths, tangents in columns go through the linear part (see [`Rule::normals`](crate::Rule::normals) and
    /// [`Rule::tangents`](crate::Rule::tangents)). O(vertices), or O(elements) if it mirrors.
    ///
    /// # Errors
    /// [`TransformError`] on a map that is singular or not finite, a mesh without vertices, or a vertex that would leave
    /// the range of numbers.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, TransformError, glam::{DAffine3, DMat3, DVec3}};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// let shear = DMat3::from_cols(DVec3::X, DVec3::X + DVec3::Y, DVec3::Z);
    /// mesh.transform(&DAffine3::from_mat3_translation(shear, DVec3::Z))?;
    /// assert_eq!(mesh.position(mesh.vertices().nth(2).unwrap()), DVec3::ONE);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn transform(&mut self, map: &DAffine3) -> Result<(), TransformError> {
        let linear = map.matrix3;
        finite(&[linear.x_axis, linear.y_axis, linear.z_axis, map.translation])?;
        let turning = affine(&linear).ok_or(TransformError::Singular)?;
        self.map(|p| map.transform_point3(p), Some(turning))
    }

    /// [`transform`](Self::transform) by a 4x4 matrix whose last row is `0 0 0 1`.
    ///
    /// # Errors
    /// As there, and [`TransformError::NotAffine`].
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, TransformError, glam::{DMat4, DVec3}};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// mesh.transform_matrix(&DMat4::from_translation(DVec3::X))?;
    /// let half = DMat4::IDENTITY * 0.5;
    /// assert_eq!(mesh.transform_matrix(&half), Err(TransformError::NotAffine([0.0, 0.0, 0.0, 0.5])));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn transform_matrix(&mut self, matrix: &DMat4) -> Result<(), TransformError> {
        let row = matrix.row(3).to_array();
        if row.iter().any(|x| !x.is_finite()) {
            return Err(TransformError::NonFinite);
        }
        if row != [0.0, 0.0, 0.0, 1.0] {
            return Err(TransformError::NotAffine(row));
        }
        self.transform(&DAffine3::from_mat4(*matrix))
    }

    /// Moves every vertex, turns directions, and reverses the winding of a map that mirrors.
    fn map(&mut self, at: impl Fn(DVec3) -> DVec3, turning: Option<Turning>) -> Result<(), TransformError> {
        if self.vertex_count() == 0 {
            return Err(TransformError::Empty);
        }
        let moved: Vec<DVec3> = self.positions.iter().map(|&p| at(p)).collect();
        self.replace_positions(moved)?;
        if let Some(turning) = turning {
            if turning.flips() {
                self.reverse_all_links();
            }
            self.turn_all_values(&turning);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_have_exact_sines() {
        let expected = [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)];
        for k in -9i32..9 {
            assert_eq!(sin_cos_degrees(f64::from(k) * 90.0), expected[k.rem_euclid(4) as usize], "{k}");
        }
        let (s, c) = sin_cos_degrees(30.0);
        assert!((s - 0.5).abs() < 1e-15 && (c - 0.75f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn a_small_map_is_not_singular_and_a_flat_one_is() {
        let small = DMat3::from_diagonal(DVec3::new(1e-300, -1e-300, 1e-200));
        assert!(inverse_transpose(&small).is_some_and(|(_, _, mirrors)| mirrors));
        assert!(inverse_transpose(&DMat3::from_cols(DVec3::X, DVec3::X * 2.0, DVec3::Z)).is_none());
    }
}
