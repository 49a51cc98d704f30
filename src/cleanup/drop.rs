//! Dropping what no solid needs: small parts, on request, and vertices without a face.

use super::step::{Before, Parts, record_faces, unchanged};
use crate::Mesh;
use crate::matching::NONE;
use crate::report::{Kind, Outcome, Record, Step, StepSummary};

/// Drops parts with fewer faces than a number, faces joined across edges; how many parts. A record for each face. The
/// account is in the numbers of the mesh before. O(elements).
///
/// # Examples
/// ```
/// use meshwright::{IndexedMesh, Mesh, cleanup::drop_debris, glam::DVec3};
/// let points = (0..6).map(|i| DVec3::new(f64::from(i % 2), f64::from(i % 3), f64::from(i / 3))).collect();
/// let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2], [3, 4, 5]])?)?;
/// assert_eq!(drop_debris(&mut mesh, 1).value, 0);
/// let dropped = drop_debris(&mut mesh, 2);
/// assert_eq!((dropped.value, dropped.report.records.len(), mesh.vertex_count()), (2, 2, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn drop_debris(mesh: &mut Mesh, fewer_than: usize) -> Outcome<usize> {
    let parts = Parts::of(mesh);
    let small: Vec<usize> = (0..parts.len()).filter(|&p| parts.faces[p].len() < fewer_than).collect();
    drop_parts(mesh, &parts, &small, (Step::DropDebris, Kind::Debris))
}

/// Drops whole parts, with a record for each face.
pub(super) fn drop_parts(
    mesh: &mut Mesh,
    parts: &Parts,
    gone: &[usize],
    (step, kind): (Step, Kind),
) -> Outcome<usize> {
    if gone.is_empty() {
        return unchanged(mesh, 0, step);
    }
    let before = Before::of(mesh);
    let mut records = Vec::new();
    for &part in gone {
        record_faces(mesh, &before, &parts.faces[part], (step, kind), &mut records);
        mesh.remove_part(&parts.faces[part]);
    }
    let summary = StepSummary::new(step, records.len());
    before.outcome(mesh, gone.len(), summary, records)
}

/// Drops vertices that have no face; how many. A record for each, in the numbers of the mesh before. O(vertices).
///
/// # Examples
/// ```
/// use meshwright::{IndexedMesh, Mesh, cleanup::drop_isolated, glam::DVec3};
/// let points = vec![DVec3::ZERO, DVec3::X, DVec3::ONE, DVec3::Y];
/// let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 3]])?)?;
/// let dropped = drop_isolated(&mut mesh);
/// assert_eq!((dropped.value, dropped.maps.vertices.new_of(3)), (1, &[2][..]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn drop_isolated(mesh: &mut Mesh) -> Outcome<usize> {
    let gone: Vec<u32> = mesh.vertices.live().filter(|&v| mesh.vertex_halfedge[v as usize] == NONE).collect();
    let step = Step::DropIsolated;
    if gone.is_empty() {
        return unchanged(mesh, 0, step);
    }
    let before = Before::of(mesh);
    let record = |&v: &u32| {
        Record::new(step, Kind::IsolatedVertex, before.vertex(v), Some(mesh.positions[v as usize]))
    };
    let records = gone.iter().map(record).collect();
    gone.iter().for_each(|&v| mesh.remove_isolated(v));
    before.outcome(mesh, gone.len(), StepSummary::new(step, gone.len()), records)
}
