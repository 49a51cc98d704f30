//! Inside or outside of a closed surface.

use super::batch::each_with;
use super::bvh::Tree;
use super::cast::{Cast, Meeting};
use super::{MeshIndex, QueryError};
use crate::geometry::unit_scale;
use crate::{Cancelled, Closed, Control};
use glam::{DVec3, dvec3};

/// Where a point is relative to a closed surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// The surface winds about it.
    Inside,
    /// It does not.
    Outside,
    /// On the surface itself.
    On,
}

/// A [`MeshIndex`] of a closed mesh: tells inside from outside. Made by [`Closed::index`].
#[derive(Debug)]
pub struct SolidIndex<'m> {
    index: MeshIndex<'m>,
}

impl<'m> Closed<'m> {
    /// Builds the spatial index of the mesh, with the proof that it is closed. As [`Mesh::index`](crate::Mesh::index).
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, Side, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    /// # let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    /// # let mesh = Mesh::build(&IndexedMesh::from_triangles(points, &faces)?)?;
    /// let solid = mesh.closed()?.index();
    /// assert_eq!(solid.contains(DVec3::splat(0.2))?, Side::Inside);
    /// assert_eq!(solid.contains(DVec3::splat(1.0 / 3.0))?, Side::Inside, "just so: a third is rounded down");
    /// assert_eq!(solid.contains_batch(&[DVec3::ONE, DVec3::X / 2.0])?, [Side::Outside, Side::On]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn index(&self) -> SolidIndex<'m> {
        SolidIndex { index: self.mesh().index() }
    }

    /// [`index`](Self::index) with a progress-and-cancel hook.
    ///
    /// # Errors
    /// [`Cancelled`] when the hook says so.
    pub fn index_with(&self, control: Control<'_>) -> Result<SolidIndex<'m>, Cancelled> {
        Ok(SolidIndex { index: self.mesh().index_with(control)? })
    }

    /// Where a point is: inside if the surface winds about it, whichever way and however often; so a cavity is outside,
    /// and where solids overlap is inside. Exact. O(corners); for many points build an [`index`](Self::index).
    ///
    /// # Errors
    /// [`QueryError::NonFinitePoint`].
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, Side, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    /// # let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    /// # let mesh = Mesh::build(&IndexedMesh::from_triangles(points, &faces)?)?;
    /// assert_eq!(mesh.closed()?.contains(DVec3::ONE)?, Side::Outside);
    /// assert_eq!(mesh.closed()?.contains(DVec3::ZERO)?, Side::On);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn contains(&self, point: DVec3) -> Result<Side, QueryError> {
        if !point.is_finite() {
            return Err(QueryError::NonFinitePoint(point));
        }
        let mesh = self.mesh();
        let mut triangles = Vec::with_capacity(mesh.face_count());
        mesh.for_each_cut_triangle(|f, t| triangles.push((t, f)));
        let used = mesh.vertices.live().map(|v| mesh.positions[v as usize]);
        let tree = Tree::flat(&mesh.positions, triangles.into_iter(), unit_scale(used));
        let cast = Cast::new(&tree, point, SKEW);
        let mut all = 0..tree.triangle_count() as u32;
        Ok(side(winding(&cast, |count| {
            all.all(count);
        })))
    }

    /// [`contains`](Self::contains) for every point, through an index built for them, on several threads with the feature
    /// `rayon`.
    ///
    /// # Errors
    /// [`QueryError::NonFinitePoint`], of the first such point.
    pub fn contains_batch(&self, points: &[DVec3]) -> Result<Vec<Side>, QueryError> {
        self.index().contains_batch(points)
    }
}

impl<'m> SolidIndex<'m> {
    /// The index of the mesh, for rays and nearest elements.
    pub fn index(&self) -> &MeshIndex<'m> {
        &self.index
    }

    /// Where a point is, as [`Closed::contains`].
    ///
    /// # Errors
    /// [`QueryError::NonFinitePoint`].
    pub fn contains(&self, point: DVec3) -> Result<Side, QueryError> {
        self.winding_number(point).map(side)
    }

    /// [`contains`](Self::contains) for every point, on several threads with the feature `rayon`.
    ///
    /// # Errors
    /// [`QueryError::NonFinitePoint`], of the first such point.
    pub fn contains_batch(&self, points: &[DVec3]) -> Result<Vec<Side>, QueryError> {
        self.contains_batch_with(points, Control::none())
    }

    /// [`contains_batch`](Self::contains_batch) with a progress-and-cancel hook.
    ///
    /// # Errors
    /// [`QueryError::NonFinitePoint`], of the first such point, or [`QueryError::Cancelled`].
    pub fn contains_batch_with(
        &self,
        points: &[DVec3],
        control: Control<'_>,
    ) -> Result<Vec<Side>, QueryError> {
        each_with(points, "contains", control, |&p| self.contains(p))?.into_iter().collect()
    }

    /// How often the surface winds about a point: 1 in a solid, 0 outside and in its cavities, 2 where two solids overlap,
    /// -1 in one that is inside out; `None` on the surface. Exact.
    ///
    /// # Errors
    /// [`QueryError::NonFinitePoint`].
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    /// # let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &faces)?)?;
    /// mesh.reverse();
    /// assert_eq!(mesh.closed()?.index().winding_number(DVec3::splat(0.2))?, Some(-1));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn winding_number(&self, point: DVec3) -> Result<Option<i32>, QueryError> {
        if !point.is_finite() {
            return Err(QueryError::NonFinitePoint(point));
        }
        let tree = &self.index.tree;
        // Towards the nearest corner of the box: the way out is short.
        let outward = point * tree.scale - tree.center;
        let cast = Cast::new(tree, point, SKEW.copysign(outward));
        Ok(winding(&cast, |count| {
            cast.walk(
                false,
                |mut triangles| {
                    if triangles.all(&mut *count) { f32::INFINITY } else { f32::NEG_INFINITY }
                },
            );
        }))
    }
}

/// A direction in the plane of no face that people draw.
pub(super) const SKEW: DVec3 = dvec3(0.883_211, 0.402_377, 0.241_093);

/// The sum of the passings along a ray, `None` if its origin is on a triangle. `walk` counts triangles until the answer is
/// known: until it is told `false`.
fn winding(cast: &Cast<'_>, walk: impl FnOnce(&mut dyn FnMut(u32) -> bool)) -> Option<i32> {
    let (mut sum, mut is_on) = (0i32, false);
    walk(&mut |triangle| {
        match cast.meet(triangle, f64::INFINITY) {
            Meeting::Miss => {}
            Meeting::Through(passing) => {
                is_on |= passing.t == 0.0;
                sum += i32::from(passing.facing);
            }
            Meeting::Touching(contact) => {
                let is_ahead = contact.at.iter().any(|touched| touched.t >= 0.0);
                is_on |= is_ahead && contact.at.iter().any(|touched| touched.t <= 0.0);
                sum += if is_ahead { i32::from(contact.passes) } else { 0 };
            }
        }
        !is_on
    });
    (!is_on).then_some(sum)
}

fn side(winding: Option<i32>) -> Side {
    match winding {
        None => Side::On,
        Some(0) => Side::Outside,
        Some(_) => Side::Inside,
    }
}
