//! Commands that write a mesh much as it was read.

use super::in_file;
use super::look::fields;
use crate::args::{Convert, Unify};
use crate::session::{Answer, Failure, Phase, Session};
use crate::{import, output};
use meshwright::{IndexedMesh, Mesh, Report, unify_winding};
use serde_json::{Map, json};

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
    let flipped = unified.report.records.iter().filter_map(|r| match r.element {
        meshwright::Element::Face(f) => Some(in_file(faces, f)),
        _ => None,
    });
    let mut flipped: Vec<u32> = flipped.collect();
    flipped.dedup();
    let lost = output::write_mesh(session, &args.output, &unified.value.into())?;
    let mut json = Map::from_iter([("orientable".to_owned(), json!(true))]);
    json.insert("flipped".to_owned(), json!(flipped));
    json.insert("lost".to_owned(), json!(lost));
    json.insert("import".to_owned(), import::import_json(&loaded, &outcome.report));
    let text = format!("wrote {}: {} faces flipped\n", args.output.output.display(), flipped.len());
    Ok(Answer { json, text, ..Answer::default() })
}
