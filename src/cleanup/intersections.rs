//! Faces that pass through each other, with an account.

use super::step::{Before, middle, unchanged};
use crate::report::{Element, Kind, Outcome, Record, Step, StepSummary};
use crate::{Cancelled, Contact, Mesh, SelfIntersectionOptions, SelfIntersections};

/// Looks for faces that cross or overlap: [`Mesh::self_intersections`] with an account, which changes nothing. A record for
/// each pair that is listed; pairs that only touch have none. [`StepSummary::changed`] counts all, listed or not. If the search
/// ended before all was looked at ([`max_tests`](SelfIntersectionOptions::max_tests)), a record says so, with the number of
/// faces that were not held against all others.
///
/// # Errors
/// [`Cancelled`] when the hook says so.
///
/// # Examples
/// ```
/// use meshwright::{IndexedMesh, Kind, Mesh, SelfIntersectionOptions, cleanup::find_intersections, glam::{DVec3, dvec3}};
/// // A sheet, and one that stands across it.
/// let points = vec![DVec3::ZERO, DVec3::X * 4.0, DVec3::Y * 4.0, dvec3(1., 1., -1.), dvec3(1., 1., 1.), dvec3(1., 5., 0.)];
/// let mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2], [3, 4, 5]])?)?;
/// let found = find_intersections(&mesh, SelfIntersectionOptions::default())?;
/// assert_eq!((found.value.crossings, found.report.count(Kind::SelfIntersection)), (1, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn find_intersections(
    mesh: &Mesh,
    options: SelfIntersectionOptions<'_>,
) -> Result<Outcome<SelfIntersections>, Cancelled> {
    let step = Step::FindIntersections;
    let found = mesh.self_intersections(options)?;
    let count = found.crossings + found.overlaps;
    let mut records = Vec::new();
    if count > 0 || found.unsearched > 0 {
        let before = Before::of(mesh);
        for pair in found.pairs.iter().filter(|pair| pair.contact != Contact::Touch) {
            if let [Some(Element::Face(a)), Some(Element::Face(b))] = pair.faces.map(|f| before.face_of(f)) {
                let element = Element::Faces([a.min(b), a.max(b)]);
                records.push(Record::new(step, Kind::SelfIntersection, element, Some(pair.place)));
            }
        }
        if let Some((slot, element)) =
            found.first_unsearched.and_then(|f| Some((mesh.face_slot(f)?, before.face_of(f)?)))
        {
            let record = Record::new(step, Kind::UnsearchedFaces, element, Some(middle(mesh, slot)));
            records.push(record.sized(found.unsearched, 0.0));
        }
    }
    let mut outcome = unchanged(mesh, found, step);
    outcome.report.steps = vec![StepSummary::new(step, count)];
    outcome.report.records = records;
    Ok(outcome)
}
