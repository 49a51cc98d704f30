//! Parts that are open: which can be closed, and what is said of those that stay so.

use super::CleanError;
use super::step::{Areas, Before, Parts, middle, unchanged};
use super::weld::weld;
use crate::matching::NONE;
use crate::report::{Kind, Outcome, Record, Step, StepSummary};
use crate::{Control, Mesh};

/// How much of a part's area its holes must not reach for it to be a body with holes: from a half on a sphere cut through
/// the middle to the whole on a flat sheet.
const SHEET: f64 = 0.75;

/// Why each part cannot become a solid, if so; a closed one can.
pub(super) fn hopeless(mesh: &Mesh, parts: &Parts) -> Result<Vec<Option<Kind>>, CleanError> {
    let twisted = twisted(mesh, parts)?;
    let areas = Areas::of(mesh);
    let mut holes = vec![0.0; parts.len()];
    let mut seen = vec![false; mesh.edges.slot_count()];
    for first in mesh.boundary_slots() {
        if !seen[first as usize >> 1] {
            mesh.loop_slots(first).for_each(|h| seen[h as usize >> 1] = true);
            holes[parts.of[mesh.face[first as usize ^ 1] as usize] as usize] += areas.vector(first).length();
        }
    }
    let judge = |part: usize| {
        if parts.is_closed[part] {
            None
        } else if twisted[part] {
            Some(Kind::NotOrientable)
        } else {
            (holes[part] > SHEET * areas.scaled(&parts.faces[part])).then_some(Kind::OpenSheet)
        }
    };
    Ok((0..parts.len()).map(judge).collect())
}

/// Whether two boundary edges of a part lie at one place and run the same way: what a cut leaves of a surface that cannot
/// be oriented.
fn twisted(mesh: &Mesh, parts: &Parts) -> Result<Vec<bool>, CleanError> {
    let rim: Vec<u32> = mesh.boundary_slots().collect();
    let at = |h: u32| mesh.positions[mesh.origin[h as usize] as usize];
    // A vertex has one boundary half-edge from it and one to it.
    let positions: Vec<_> = rim.iter().map(|&h| at(h)).collect();
    let places = weld(&positions, Some(0.0), &mut Control::none())?;
    let mut place = vec![NONE; mesh.vertices.slot_count()];
    rim.iter().zip(&places).for_each(|(&h, &p)| place[mesh.origin[h as usize] as usize] = p);
    let mut runs: Vec<[u32; 3]> = rim
        .iter()
        .map(|&h| {
            let [from, to] = [h, h ^ 1].map(|h| place[mesh.origin[h as usize] as usize]);
            [from, to, parts.of[mesh.face[h as usize ^ 1] as usize]]
        })
        .collect();
    runs.sort_unstable();
    let mut twisted = vec![false; parts.len()];
    runs.windows(2).filter(|r| r[0] == r[1]).for_each(|r| twisted[r[0][2] as usize] = true);
    Ok(twisted)
}

/// Names the parts that are still open, each by its first face.
pub(super) fn name_open(mesh: &Mesh) -> Result<Outcome<usize>, CleanError> {
    let step = Step::FindOpenParts;
    if mesh.is_closed() {
        return Ok(unchanged(mesh, 0, step));
    }
    let parts = Parts::of(mesh);
    let (before, areas) = (Before::of(mesh), Areas::of(mesh));
    let why = hopeless(mesh, &parts)?;
    let record = |part: usize| {
        let faces = &parts.faces[part];
        let kind = why[part].unwrap_or(Kind::OpenPart);
        let record = Record::new(step, kind, before.face(faces[0]), Some(middle(mesh, faces[0])));
        record.sized(faces.len(), areas.plain(areas.scaled(faces)))
    };
    let records: Vec<Record> = parts.open().map(record).collect();
    let mut outcome = unchanged(mesh, records.len(), step);
    outcome.report.steps = vec![StepSummary::new(step, outcome.value)];
    outcome.report.records = records;
    Ok(outcome)
}
