//! Slivers resolved, with an account.

use super::step::{Before, middle, unchanged};
use crate::report::{Element, Kind, Outcome, Record, Report, Step, StepSummary};
use crate::{Lineage, Mesh, Sliver, SliverAccount, SliverError, SliverKind, SliverOptions};
use glam::DVec3;
use std::collections::BTreeSet;

/// Resolves faces without height: [`Mesh::resolve_slivers`] with an account. A record for each that was found and for each
/// that is left, in the numbers of the mesh before; maps tell what became of the faces and vertices.
///
/// # Errors
/// [`SliverError`]; nothing has changed then.
///
/// # Examples
/// ```
/// use meshwright::{IndexedMesh, Kind, Mesh, SliverOptions, cleanup::resolve_slivers, glam::DVec3};
/// // The third corner of the second triangle lies on the first's edge.
/// let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X / 2.0];
/// let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2], [1, 0, 3]])?)?;
/// let resolved = resolve_slivers(&mut mesh, SliverOptions::new(1e-9))?;
/// assert_eq!((resolved.report.count(Kind::Cap), mesh.face_count()), (1, 2));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn resolve_slivers(
    mesh: &mut Mesh,
    options: SliverOptions<'_>,
) -> Result<Outcome<SliverAccount>, SliverError> {
    let tolerance = options.tolerance;
    let step = Step::ResolveSlivers;
    if mesh.slivers(tolerance).is_empty() {
        // For the refusal of a tolerance.
        let account = mesh.resolve_slivers(options)?;
        let mut outcome = unchanged(mesh, account, step);
        outcome.report.steps = vec![StepSummary { tolerance: Some(tolerance), ..StepSummary::new(step, 0) }];
        return Ok(outcome);
    }
    let before = Before::of(mesh);
    let middles: Vec<DVec3> = mesh.faces.in_user_order().into_iter().map(|f| middle(mesh, f)).collect();
    let (account, changes) = mesh.traced(|mesh| mesh.resolve_slivers(options));
    let account = account?;
    let maps = Lineage::of(changes).maps(before.numbering(), &mesh.numbering());
    let mut records: Vec<Record> = Vec::new();
    let mut tell = |sliver: &Sliver, kind: Kind| {
        // One that arose on the way comes from others, which have records.
        if let Some(element) = before.face_of(sliver.face) {
            records.push(Record::new(step, kind, element, Some(sliver.place)));
        }
    };
    for resolved in &account.resolved {
        let kind = match resolved.sliver.kind {
            SliverKind::Needle => Kind::Needle,
            SliverKind::Cap => Kind::Cap,
            SliverKind::Flat => Kind::FlatFace,
        };
        tell(&resolved.sliver, kind);
    }
    account.left.iter().for_each(|left| tell(&left.sliver, Kind::LeftSliver));
    let named: BTreeSet<Element> = records.iter().map(|r| r.element).collect();
    let gone = (0..maps.faces.old_len()).filter(|&f| maps.faces.new_of(f).is_empty());
    let unnamed = gone.map(|f| (f, Element::Face(f as u32))).filter(|(_, element)| !named.contains(element));
    let absorbed =
        unnamed.map(|(f, element)| Record::new(step, Kind::AbsorbedFace, element, Some(middles[f])));
    records.extend(absorbed.collect::<Vec<_>>());
    records.sort_by_key(|r| r.element);
    let summary = StepSummary {
        tolerance: Some(tolerance),
        moved: account.moved,
        ..StepSummary::new(step, account.resolved.len())
    };
    let report = Report { steps: vec![summary], records, ..Report::default() };
    Ok(Outcome { value: account, report, maps })
}
