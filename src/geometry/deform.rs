//! Any function of position, once per vertex.

use crate::{Cancelled, Control, Mesh, SetError, VertexKey};
use glam::DVec3;

/// How to deform.
#[derive(Debug, Default)]
pub struct DeformOptions<'a> {
    /// The progress-and-cancel hook.
    pub control: Control<'a>,
}

/// Why a mesh was not deformed; nothing has changed then.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DeformError {
    /// The mesh has no vertices.
    #[error("there are no vertices")]
    Empty,
    /// The function gave a position that is NaN or infinite.
    #[error("the new position of {0:?} is not finite")]
    NonFinite(VertexKey),
    /// The hook said stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl Mesh {
    /// Moves every vertex to where `f` sends its position. `f` is called once per vertex, in the order of
    /// [`to_indexed`](Self::to_indexed). Carried normals stay as they are:
    /// [compute](Self::compute_normals) them anew if the shape has changed. O(vertices).
    ///
    /// # Errors
    /// [`DeformError`] naming the first vertex that got no finite position; on a mesh without vertices; when cancelled.
    ///
    /// # Examples
    /// A wave:
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// let amplitude = 0.25;
    /// let wave = |p: DVec3| p + DVec3::Z * ((5.0 * p.x).sin() * (5.0 * p.y).cos() * amplitude);
    /// mesh.deform(wave, Default::default())?;
    /// let v = mesh.vertices().nth(1).unwrap();
    /// assert_eq!(mesh.position(v).z, 5f64.sin() * 0.25);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn deform(
        &mut self,
        mut f: impl FnMut(DVec3) -> DVec3,
        options: DeformOptions<'_>,
    ) -> Result<(), DeformError> {
        let mut control = options.control;
        if self.vertex_count() == 0 {
            return Err(DeformError::Empty);
        }
        let mut moved = self.positions.clone();
        let order = self.vertices.in_user_order();
        for (i, &v) in order.iter().enumerate() {
            if i.is_multiple_of(1 << 19) {
                control.report("deform", i as f64 / order.len() as f64)?;
            }
            let p = f(self.positions[v as usize]);
            if !p.is_finite() {
                return Err(DeformError::NonFinite(self.vertices.key(v)));
            }
            moved[v as usize] = p;
        }
        self.replace_positions(moved).map_err(|error| match error {
            SetError::Missing(v) | SetError::NonFinite(v) => DeformError::NonFinite(v),
        })
    }
}
