//! The error that is told.

use super::copy::Copy;
use super::place::error;
use crate::Mesh;

impl Copy {
    /// The largest error of a live vertex: the root of the mean squared distance to the planes of the original faces it stands
    /// for; in local units.
    pub(super) fn error(&self, mesh: &Mesh, roots: &[u32]) -> f64 {
        // The sum of squares, the weight, and how far the faces are.
        let mut sums = vec![(0.0f64, 0.0f64, 0.0f64); self.spots.len()];
        for ((&root, &slot), planes) in roots.iter().zip(&self.vertex_slot).zip(&self.origins) {
            let by = self.spots[root as usize].position - self.frame.local(mesh.positions[slot as usize]);
            let (sum, weight, reach) = &mut sums[root as usize];
            *sum += planes.about(by).at_origin();
            *weight += planes.weight();
            *reach = reach.max(by.length_squared());
        }
        let errors =
            sums.into_iter().filter(|s| s.1 > 0.0).map(|(sum, weight, reach)| error(sum, weight, reach));
        errors.fold(0.0, f64::max)
    }
}
