//! Commands that write a mesh much as it was read.

use super::in_file;
use crate::args::{Convert, Unify};
use crate::import::Imported;
use crate::session::{Answer, Failure, Phase, Session};
use crate::text::{counted, not_carried};
use crate::{import, output};
use meshwright::{Mesh, unify_winding};

pub(super) fn convert(session: &mut Session, args: &Convert) -> Result<Answer, Failure> {
    import_change_write(session, args, |_| {})
}

pub(super) fn flip(session: &mut Session, args: &Convert) -> Result<Answer, Failure> {
    import_change_write(session, args, Mesh::reverse)
}

fn import_change_write(
    session: &mut Session,
    args: &Convert,
    change: impl FnOnce(&mut Mesh),
) -> Result<Answer, Failure> {
    args.output.format()?;
    let Imported { mut mesh, json: import, not_carried } =
        import::mesh(session, &args.file, args.strict.strict)?;
    if let Some(line) = not_carried {
        session.say(&line);
    }
    session.timed(Phase::Run, || change(&mut mesh));
    let soup = mesh.to_indexed().into();
    let lost = output::write_mesh(session, &args.output, &soup)?;
    let (vertices, faces) = (mesh.vertex_count(), mesh.face_count());
    let json = session.fields(false).with("vertices", &vertices).with("faces", &faces).with("lost", &lost);
    let json = json.with_object("import", &import);
    let destination = args.output.output.display();
    let text = format!("wrote {destination}: {}, {}\n", counted(vertices, "vertex"), counted(faces, "face"));
    Ok(Answer { json, text, ..Answer::default() })
}

pub(super) fn unify(session: &mut Session, args: &Unify) -> Result<Answer, Failure> {
    args.output.format()?;
    let (loaded, outcome) = import::indexed(session, &args.file, args.weld.weld)?;
    if let Some(line) = not_carried(&outcome.report) {
        session.say(&line);
    }
    let faces = &outcome.maps.faces;
    let unified = session.timed(Phase::Run, || unify_winding(&outcome.value.topology()));
    let unified = unified.map_err(|error| {
        let cycle = |c: &Vec<u32>| c.iter().map(|&f| in_file(faces, f)).collect::<Vec<_>>();
        let cycles: Vec<_> = error.cycles.iter().map(cycle).collect();
        let json = session.fields(false).with("orientable", &false).with("cycles", &cycles);
        Failure::Refused { message: error.to_string(), json }
    })?;
    let flipped = unified.report.records.iter().filter_map(|r| match r.element {
        meshwright::Element::Face(f) => Some(in_file(faces, f)),
        _ => None,
    });
    let mut flipped: Vec<u32> = flipped.collect();
    flipped.dedup();
    let lost = output::write_mesh(session, &args.output, &unified.value.into())?;
    let json = session
        .fields(false)
        .with("orientable", &true)
        .with("flipped", &flipped)
        .with("lost", &lost)
        .with_object("import", &import::import_json(session, &loaded, &outcome.report));
    let reversed = counted(flipped.len(), "face");
    let text = format!("wrote {}: {reversed} reversed\n", args.output.output.display());
    Ok(Answer { json, text, ..Answer::default() })
}
