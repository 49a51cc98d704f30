//! Commands that write a mesh much as it was read.

use super::in_file;
use super::look::fields;
use crate::args::{Convert, Unify};
use crate::session::{Answer, Failure, Phase, Session};
use crate::{import, output, progress};
use meshwright::{
    Control, Element, IndexedMesh, Mesh, OutwardOptions, OutwardPart, Record, Report, orient_outward,
    unify_winding,
};
use serde_json::{Map, json};
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
    let (pool, import) = import::pool(session, &args.file, args.strict.strict)?;
    let pool = session.timed(Phase::Run, || change(pool));
    let (vertices, faces) = (pool.vertex_count(), pool.face_count());
    let lost = output::write_mesh(session, &args.output, &pool.into())?;
    let json = json!({ "vertices": vertices, "faces": faces, "lost": lost, "import": import });
    let text = format!("wrote {}: {vertices} vertices, {faces} faces\n", args.output.output.display());
    Ok(Answer { json: fields(json), text, ..Answer::default() })
}

/// Imports a mesh, changes it as a mesh, and writes it. The change may have an account.
pub(super) fn import_edit_write(
    session: &mut Session,
    args: &Convert,
    change: impl FnOnce(&mut Mesh) -> Result<Option<Report>, Failure>,
) -> Result<Answer, Failure> {
    args.output.format()?;
    let (mut mesh, import) = import::mesh(session, &args.file, args.strict.strict)?;
    let report = session.timed(Phase::Run, || change(&mut mesh))?;
    let soup = session.timed(Phase::Run, || mesh.to_indexed().into());
    let lost = output::write_mesh(session, &args.output, &soup)?;
    let json = json!({
        "vertices": mesh.vertex_count(), "faces": mesh.face_count(), "lost": lost, "import": import,
    });
    let mut json = fields(json);
    let mut list = None;
    let mut text = String::new();
    if let Some(report) = report {
        json.extend(fields(json!({
            "counts": report.counts(), "steps": report.steps, "not_carried": report.not_carried,
            "lost_values": import::lost_values(&report),
        })));
        list = Some(("defects", serde_json::to_string(&report.records).map_err(Failure::refused)?));
        for line in import::changes(&report) {
            text.push_str(&line);
            text.push('\n');
        }
    }
    let destination = args.output.output.display();
    let (vertices, faces) = (mesh.vertex_count(), mesh.face_count());
    text.push_str(&format!("wrote {destination}: {vertices} vertices, {faces} faces\n"));
    Ok(Answer { json, list, text, is_no: false })
}

pub(super) fn unify(session: &mut Session, args: &Unify) -> Result<Answer, Failure> {
    args.output.format()?;
    let (loaded, outcome) = import::indexed(session, &args.file, args.weld.weld)?;
    let faces = &outcome.maps.faces;
    let unified = session.timed(Phase::Run, || unify_winding(&outcome.value.topology()));
    let unified = unified.map_err(|error| {
        let cycle = |c: &Vec<u32>| c.iter().map(|&f| in_file(faces, f)).collect::<Vec<_>>();
        let cycles: Vec<_> = error.cycles.iter().map(cycle).collect();
        let json = json!({ "orientable": false, "cycles": cycles });
        Failure::Refused { message: error.to_string(), json: fields(json) }
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
    let mut json = Map::from_iter([("orientable".to_owned(), json!(true))]);
    json.insert("flipped".to_owned(), json!(flipped));
    json.insert("lost".to_owned(), json!(lost));
    json.insert("import".to_owned(), import::import_json(&loaded, &outcome.report));
    let mut text = String::new();
    if let Some(parts) = parts {
        for part in &parts {
            text.push_str(&outward_line(in_file(faces, part.face), part));
        }
        let place = |part: &OutwardPart<u32>| OutwardPart { face: in_file(faces, part.face), ..*part };
        json.insert("parts".to_owned(), json!(parts.iter().map(place).collect::<Vec<_>>()));
    }
    text.push_str(&format!("wrote {}: {} faces flipped\n", args.output.output.display(), flipped.len()));
    Ok(Answer { json, text, ..Answer::default() })
}

fn flipped_faces(report: &Report) -> BTreeSet<u32> {
    let face = |r: &Record| match r.element {
        Element::Face(f) => Some(f),
        _ => None,
    };
    report.records.iter().filter_map(face).collect()
}

fn outward_line(face: u32, part: &OutwardPart<u32>) -> String {
    let kind = match (part.closed, part.depth % 2) {
        (false, _) => format!("open, direction {:.0} % sure", part.confidence * 100.0),
        (true, _) if part.crosses => "closed, crosses another part".to_owned(),
        (true, 0) => "solid".to_owned(),
        (true, _) => "cavity".to_owned(),
    };
    let done = if part.reversed { "turned" } else { "left as it is" };
    format!("part of {} faces from face {face}: {kind}, {done}\n", part.faces)
}
