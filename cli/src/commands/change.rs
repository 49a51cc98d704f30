//! Commands that write a mesh much as it was read.

use super::in_file;
use crate::args::{Convert, Unify};
use crate::import::Imported;
use crate::session::{Answer, Failure, Fields, Phase, Session};
use crate::text::{self, counted};
use crate::{import, output, progress};
use meshwright::io::Lost;
use meshwright::{
    Control, Element, IndexedMesh, Mesh, OutwardOptions, OutwardPart, Record, Report, UnifyWithError,
    orient_outward, unify_winding_with,
};
use std::collections::BTreeSet;

pub(super) fn convert(session: &mut Session, args: &Convert) -> Result<Answer, Failure> {
    import_change_write(session, args, |pool| pool)
}

pub(super) fn flip(session: &mut Session, args: &Convert) -> Result<Answer, Failure> {
    import_change_write(session, args, IndexedMesh::reversed)
}

fn import_change_write(
    session: &mut Session,
    args: &Convert,
    change: impl FnOnce(IndexedMesh) -> IndexedMesh,
) -> Result<Answer, Failure> {
    args.output.format()?;
    let Imported { value, json: import, not_carried, .. } =
        import::pool(session, &args.file, args.strict.strict)?;
    not_carried.iter().for_each(|line| session.say(line));
    let pool = session.timed(Phase::Run, || change(value));
    let size = (pool.vertex_count(), pool.face_count());
    let lost = output::write_mesh(session, &args.output, &pool.into())?;
    let (json, text) = written(session, args, size, &lost, &import);
    Ok(Answer { json, text, ..Answer::default() })
}

/// Imports a mesh, changes it as a mesh, and writes it. The change may have an account.
pub(super) fn import_edit_write(
    session: &mut Session,
    args: &Convert,
    change: impl FnOnce(&mut Mesh) -> Result<Option<Report>, Failure>,
) -> Result<Answer, Failure> {
    args.output.format()?;
    let Imported { value: mut mesh, json: import, not_carried, .. } =
        import::mesh(session, &args.file, args.strict.strict)?;
    not_carried.iter().for_each(|line| session.say(line));
    let report = session.timed(Phase::Run, || change(&mut mesh))?;
    let soup = session.timed(Phase::Run, || mesh.to_indexed().into());
    let lost = output::write_mesh(session, &args.output, &soup)?;
    let size = (mesh.vertex_count(), mesh.face_count());
    let (mut json, last) = written(session, args, size, &lost, &import);
    let mut text = String::new();
    if let Some(report) = report {
        json = json
            .with("counts", &report.counts())
            .with("steps", &report.steps)
            .with("not_carried", &report.not_carried)
            .with("lost_values", &import::lost_values(&report))
            .with("defects", &report.records);
        for line in text::changes(&report).into_iter().chain(text::not_carried(&report)) {
            text += &line;
            text.push('\n');
        }
    }
    text += &last;
    Ok(Answer { json, text, is_no: false })
}

/// What every command says that writes a mesh.
fn written(
    session: &Session,
    args: &Convert,
    (vertices, faces): (usize, usize),
    lost: &[Lost],
    import: &Fields,
) -> (Fields, String) {
    let json = session.fields(false).with("vertices", &vertices).with("faces", &faces).with("lost", &lost);
    let destination = args.output.output.display();
    let text = format!("wrote {destination}: {}, {}\n", counted(vertices, "vertex"), counted(faces, "face"));
    (json.with_object("import", import), text)
}

pub(super) fn unify(session: &mut Session, args: &Unify) -> Result<Answer, Failure> {
    args.output.format()?;
    let (loaded, outcome) = import::indexed(session, &args.file, args.weld.weld)?;
    text::not_carried(&outcome.report).iter().for_each(|line| session.say(line));
    let faces = &outcome.maps.faces;
    let unified = session.timed(Phase::Run, || {
        progress::shown(|hook| unify_winding_with(&outcome.value.topology(), Control::new(hook)))
    });
    let unified = unified.map_err(|error| {
        let mut json = session.fields(false);
        if let UnifyWithError::Refused(refused) = &error {
            let cycle = |c: &Vec<u32>| c.iter().map(|&f| in_file(faces, f)).collect::<Vec<_>>();
            let cycles: Vec<_> = refused.cycles.iter().map(cycle).collect();
            json = json.with("orientable", &false).with("cycles", &cycles);
        }
        Failure::Refused { message: error.to_string(), json }
    })?;
    let mut flipped = flipped_faces(&unified.report);
    let mut value = unified.value;
    let mut parts = None;
    if args.outward {
        let turned = session.timed(Phase::Run, || {
            progress::shown(|hook| {
                let options = OutwardOptions { control: Control::new(hook), ..Default::default() };
                orient_outward(&value.topology(), options)
            })
        });
        let turned = turned.map_err(Failure::refused)?;
        // What was flipped twice is as it was.
        flipped = flipped.symmetric_difference(&flipped_faces(&turned.outcome.report)).copied().collect();
        value = turned.outcome.value;
        parts = Some(turned.parts);
    }
    let mut flipped: Vec<u32> = flipped.into_iter().map(|f| in_file(faces, f)).collect();
    flipped.dedup();
    let lost = output::write_mesh(session, &args.output, &value.into())?;
    let mut json =
        session.fields(false).with("orientable", &true).with("flipped", &flipped).with("lost", &lost);
    let mut text = String::new();
    if let Some(parts) = parts {
        let parts: Vec<_> =
            parts.iter().map(|p| OutwardPart { face: in_file(faces, p.face), ..*p }).collect();
        parts.iter().for_each(|part| text += &outward_line(part));
        json = json.with("parts", &parts);
    }
    json = json.with_object("import", &import::import_json(session, &loaded, &outcome.report));
    let reversed = counted(flipped.len(), "face");
    text += &format!("wrote {}: {reversed} reversed\n", args.output.output.display());
    Ok(Answer { json, text, ..Answer::default() })
}

fn flipped_faces(report: &Report) -> BTreeSet<u32> {
    let face = |r: &Record| match r.element {
        Element::Face(f) => Some(f),
        _ => None,
    };
    report.records.iter().filter_map(face).collect()
}

fn outward_line(part: &OutwardPart<u32>) -> String {
    let kind = match (part.closed, part.depth % 2) {
        (false, _) => format!("open, direction {:.0} % sure", part.confidence * 100.0),
        (true, _) if part.crosses => "closed, crosses another part".to_owned(),
        (true, 0) => "solid".to_owned(),
        (true, _) => "cavity".to_owned(),
    };
    let done = if part.reversed { "turned" } else { "left as it is" };
    format!("part of {} from face {}: {kind}, {done}\n", counted(part.faces, "face"), part.face)
}
