//! Parts that are open: which can be closed, and what is said of those that stay so.

use super::step::{Areas, Before, Parts, middle, unchanged};
use crate::report::{Kind, Outcome, Record, Step, StepSummary};
use crate::{FaceKey, Mesh};

/// How much of a part's area its holes must not reach for it to be a body with holes: from a half on a sphere cut through
/// the middle to the whole on a flat sheet.
const SHEET: f64 = 0.75;

/// Why each part cannot become a solid, if so; a closed one can. `cut` are faces of parts that were cut because they
/// cannot be oriented.
pub(super) fn hopeless(mesh: &Mesh, parts: &Parts, cut: &[FaceKey]) -> Vec<Option<Kind>> {
    let areas = Areas::of(mesh);
    let cut = parts_with(mesh, parts, cut);
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
        } else if cut[part] {
            Some(Kind::NotOrientable)
        } else {
            (holes[part] > SHEET * areas.scaled(&parts.faces[part])).then_some(Kind::OpenSheet)
        }
    };
    (0..parts.len()).map(judge).collect()
}

/// Names the parts that are still open, each by its first face.
pub(super) fn name_open(mesh: &Mesh, cut: &[FaceKey]) -> Outcome<usize> {
    let parts = Parts::of(mesh);
    let step = Step::FindOpenParts;
    if parts.open().next().is_none() {
        return unchanged(mesh, 0, step);
    }
    let (before, areas) = (Before::of(mesh), Areas::of(mesh));
    let why = hopeless(mesh, &parts, cut);
    let record = |part: usize| {
        let faces = &parts.faces[part];
        let kind = why[part].unwrap_or(Kind::OpenPart);
        let record = Record::new(step, kind, before.face(faces[0]), Some(middle(mesh, faces[0])));
        record.sized(faces.len(), areas.plain(areas.scaled(faces)))
    };
    let records: Vec<Record> = parts.open().map(record).collect();
    let mut outcome = unchanged(mesh, records.len(), step);
    outcome.report.steps = vec![StepSummary::new(step, 0)];
    outcome.report.records = records;
    outcome
}

/// Which parts have one of some faces; those that are gone do not count.
fn parts_with(mesh: &Mesh, parts: &Parts, faces: &[FaceKey]) -> Vec<bool> {
    let mut of_part = vec![false; parts.len()];
    faces
        .iter()
        .filter_map(|&f| mesh.face_slot(f))
        .for_each(|f| of_part[parts.of[f as usize] as usize] = true);
    of_part
}
