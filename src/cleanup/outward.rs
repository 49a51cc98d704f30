//! Shells turned outward, with an account.

use super::CleanError;
use super::step::{Areas, Before, Parts, middle, unchanged};
use crate::report::{Kind, Outcome, Record, Step, StepSummary};
use crate::{Cancelled, Control, FaceKey, Mesh, OutwardOptions, OutwardPart};

/// Turns closed parts outward, and those that bound a cavity inward: [`Mesh::orient_outward`] with an account. Open parts
/// stay as they are. A record for each part that was turned, and for each that crosses another and was judged by its own
/// volume; it names the part's first face, in the numbers of the mesh before.
///
/// # Errors
/// [`CleanError::Cancelled`]; nothing has changed then.
///
/// # Examples
/// ```
/// use meshwright::{Control, IndexedMesh, Kind, Mesh, cleanup::turn_outward, glam::DVec3};
/// let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &faces)?)?;
/// mesh.reverse();
/// let turned = turn_outward(&mut mesh, Control::none())?;
/// assert_eq!(turned.report.count(Kind::TurnedShell), 1);
/// assert!(mesh.closed()?.volume() > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn turn_outward(
    mesh: &mut Mesh,
    control: Control<'_>,
) -> Result<Outcome<Vec<OutwardPart<FaceKey>>>, CleanError> {
    let options = OutwardOptions { control, ..Default::default() };
    // The confidence makes sense, so this is the only reason.
    let found = mesh.orient_parts_outward(options, false).map_err(|_| CleanError::Cancelled(Cancelled))?;
    let mut outcome = unchanged(mesh, (), Step::TurnOutward);
    if found.iter().any(|p| p.reversed || p.crosses) {
        // Reversing renumbers nothing.
        let (before, parts, areas) = (Before::of(mesh), Parts::of(mesh), Areas::of(mesh));
        let mut records = Vec::new();
        for (part, faces) in found.iter().zip(&parts.faces) {
            let kinds = [(part.reversed, Kind::TurnedShell), (part.crosses, Kind::CrossingShell)];
            for (_, kind) in kinds.into_iter().filter(|(is, _)| *is) {
                let place = Some(middle(mesh, faces[0]));
                let record = Record::new(Step::TurnOutward, kind, before.face(faces[0]), place);
                records.push(record.sized(faces.len(), areas.plain(areas.scaled(faces))));
            }
        }
        let changed = found.iter().filter(|p| p.reversed).count();
        outcome.report.steps = vec![StepSummary::new(Step::TurnOutward, changed)];
        outcome.report.records = records;
    }
    Ok(Outcome { value: found, report: outcome.report, maps: outcome.maps })
}
