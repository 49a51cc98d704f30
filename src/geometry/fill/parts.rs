//! The areas of a mesh's parts.

use crate::Mesh;
use crate::geometry::measure::Sum;
use crate::geometry::normals::double_area_vector;
use crate::matching::NONE;

/// Which part each face is of, and their areas.
pub(super) struct Parts {
    /// By face slot.
    labels: Vec<u32>,
    /// Scaled. Polygons that are not flat count by their area vector.
    areas: Vec<f64>,
}

impl Parts {
    /// The parts: faces joined across edges. O(corners).
    pub(super) fn of(mesh: &Mesh, scale: f64) -> Self {
        let mut parts = Self { labels: vec![NONE; mesh.faces.slot_count()], areas: Vec::new() };
        let mut open = Vec::new();
        for first in mesh.faces.live() {
            if parts.labels[first as usize] != NONE {
                continue;
            }
            let label = parts.areas.len() as u32;
            parts.labels[first as usize] = label;
            open.push(first);
            let mut area = Sum::default();
            while let Some(f) = open.pop() {
                let corners = || mesh.loop_slots(mesh.face_halfedge[f as usize]);
                area.add(0.5 * double_area_vector(corners().map(|h| mesh.at(h) * scale)).length());
                for g in corners().map(|h| mesh.face[h as usize ^ 1]) {
                    if g != NONE && parts.labels[g as usize] == NONE {
                        parts.labels[g as usize] = label;
                        open.push(g);
                    }
                }
            }
            parts.areas.push(area.value());
        }
        parts
    }

    /// The area of the part that a face is of.
    pub(super) fn area_at(&self, f: u32) -> f64 {
        let label = self.labels.get(f as usize).copied().unwrap_or(NONE);
        self.areas.get(label as usize).copied().unwrap_or(0.0)
    }
}
