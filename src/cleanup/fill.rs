//! Holes filled, with an account.

use super::step::{Before, unchanged};
use crate::report::{Kind, Outcome, Record, Step, StepSummary};
use crate::{FillHolesError, FillHolesOptions, FillMethod, FilledHoles, HalfedgeKey, HoleRefusal, Mesh};

/// Fills holes: [`Mesh::fill_holes`] with an account. A record for each hole, filled or left, with its number of edges and
/// the area of what fills it; it names the vertex of the loop that comes first, in the numbers of the mesh before. If there
/// were too many for the least area ([`exact_cost`](FillHolesOptions::exact_cost)), or to be
/// [searched for islands](FilledHoles::unsearched), one record more tells how many.
///
/// # Errors
/// [`FillHolesError`]; nothing has changed then.
///
/// # Examples
/// ```
/// use meshwright::{FillHolesOptions, IndexedMesh, Kind, Mesh, cleanup::fill_holes, glam::DVec3};
/// // A tetrahedron without its bottom.
/// let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 3], [1, 2, 3], [2, 0, 3]])?)?;
/// let filled = fill_holes(&mut mesh, FillHolesOptions::default())?;
/// let record = filled.report.records[0];
/// assert_eq!((record.kind, record.extent.map(|e| (e.elements, e.area))), (Kind::FilledHole, Some((3, 0.5))));
/// assert!(filled.maps.faces.old_of(3).is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fill_holes(
    mesh: &mut Mesh,
    options: FillHolesOptions<'_>,
) -> Result<Outcome<FilledHoles>, FillHolesError> {
    fill_holes_of(mesh, options, |_| true)
}

/// Fills the holes at whose loops a wanted face lies, given by its slot.
pub(super) fn fill_holes_of(
    mesh: &mut Mesh,
    options: FillHolesOptions<'_>,
    is_wanted: impl Fn(u32) -> bool,
) -> Result<Outcome<FilledHoles>, FillHolesError> {
    let before = Before::of(mesh);
    let exact_edges = options.exact_edges;
    let found = mesh.fill_holes_beside(options, is_wanted)?;
    if found.filled.is_empty() && found.refused.is_empty() {
        return Ok(unchanged(mesh, found, Step::FillHoles));
    }
    let at = |h: HalfedgeKey| {
        let slot = mesh.halfedge_slot(h).map_or(0, |h| mesh.origin[h as usize]);
        before.vertex(slot)
    };
    let filled = found.filled.iter().map(|hole| {
        let record = Record::new(Step::FillHoles, Kind::FilledHole, at(hole.halfedge), Some(hole.place));
        record.sized(hole.edges, hole.area)
    });
    let left = found.refused.iter().map(|hole| {
        let kind = match hole.reason {
            HoleRefusal::TooLong(_) => Kind::LongHole,
            HoleRefusal::OneFace(_) | HoleRefusal::Sheet(_) => Kind::OutsideOfSheet,
            HoleRefusal::Islands(_) => Kind::HoleWithIslands,
            HoleRefusal::EdgesInTheWay(_) => Kind::HemmedInHole,
        };
        let record = Record::new(Step::FillHoles, kind, at(hole.halfedge), Some(hole.place));
        record.sized(hole.vertices.len(), 0.0)
    });
    let mut hasty =
        found.filled.iter().filter(|hole| hole.method == FillMethod::Ears && hole.edges <= exact_edges);
    let hasty = hasty.next().map(|first| {
        let record = Record::new(Step::FillHoles, Kind::HastyFillers, at(first.halfedge), Some(first.place));
        record.sized(1 + hasty.count(), 0.0)
    });
    let unsearched = found.filled.first().filter(|_| found.unsearched > 0).map(|first| {
        let record =
            Record::new(Step::FillHoles, Kind::UnsearchedHoles, at(first.halfedge), Some(first.place));
        record.sized(found.unsearched, 0.0)
    });
    let records = filled.chain(left).chain(hasty).chain(unsearched).collect();
    let summary = StepSummary::new(Step::FillHoles, found.filled.len());
    Ok(before.outcome(mesh, found, summary, records))
}
