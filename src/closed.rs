//! The last rung: proof that a mesh is closed, the only door to volume and mass properties.

use crate::geometry::measure::{Measures, measures, volume};
use crate::{HalfedgeKey, Mesh};
use glam::DVec3;

/// Borrowed proof that a [`Mesh`] has a face and no boundary. Made by [`Mesh::closed`].
///
/// The components of the surface may lie inside each other (a cavity is a shell wound the other way, and subtracts) and
/// may cross; each then counts by itself.
///
/// # Examples
/// ```
/// use meshwright::{IndexedMesh, Mesh, glam::DVec3};
/// let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// let mesh = Mesh::build(&IndexedMesh::from_triangles(points, &faces)?)?;
/// assert!((mesh.closed()?.volume() - 1.0 / 6.0).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Closed<'m> {
    mesh: &'m Mesh,
}

/// Why a mesh is not closed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NotClosed {
    /// There is no face.
    #[error("the mesh has no faces")]
    Empty,
    /// There is a boundary.
    #[error("the mesh has {} boundary edges", boundary.len())]
    Open {
        /// Every boundary half-edge.
        boundary: Vec<HalfedgeKey>,
    },
}

impl Mesh {
    /// Proves that the mesh has a face and no boundary. O(slots).
    ///
    /// # Errors
    /// [`NotClosed`], with every boundary half-edge.
    pub fn closed(&self) -> Result<Closed<'_>, NotClosed> {
        if self.face_count() == 0 {
            return Err(NotClosed::Empty);
        }
        let boundary: Vec<_> = self.boundary_halfedges().collect();
        if boundary.is_empty() { Ok(Closed { mesh: self }) } else { Err(NotClosed::Open { boundary }) }
    }
}

impl<'m> Closed<'m> {
    /// The mesh the proof is about.
    pub fn mesh(&self) -> &'m Mesh {
        self.mesh
    }

    /// The enclosed volume in cubic units, by the divergence theorem; negative if the surface is inside out.
    ///
    /// Summed about the middle of the bounding box with compensation, so a mesh far from the origin loses no digits;
    /// polygons that are not flat count by one fixed triangulation rule that does not depend on winding. Infinite if
    /// the volume is beyond f64. O(corners).
    pub fn volume(&self) -> f64 {
        let pool = self.mesh.to_indexed();
        volume(pool.positions(), pool.polygons())
    }

    /// The area of the surface in square units. O(corners).
    pub fn area(&self) -> f64 {
        self.measures().area
    }

    /// The centre of mass of the enclosed solid; `None` if the volume is zero, where there is none. O(corners).
    pub fn centroid(&self) -> Option<DVec3> {
        self.measures().centroid
    }

    fn measures(&self) -> Measures {
        let pool = self.mesh.to_indexed();
        measures(pool.positions(), pool.polygons())
    }
}
