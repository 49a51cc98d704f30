//! Commands that take faces away.

use super::in_file;
use crate::args::{Collapse, Reduce};
use crate::import::Imported;
use crate::session::{Answer, Failure, Phase, Session};
use crate::text::{counted, number};
use crate::{import, output, progress};
use meshwright::{CollapseError, Control, Maps, Mesh, ReduceError, ReduceOptions, ReduceTarget};

pub(super) fn reduce(session: &mut Session, args: &Reduce) -> Result<Answer, Failure> {
    args.output.format()?;
    let target = match (args.goal.faces, args.goal.ratio, args.goal.max_error) {
        (Some(n), ..) => ReduceTarget::Faces(n),
        (_, Some(r), _) => ReduceTarget::Ratio(r),
        (.., Some(e)) => ReduceTarget::MaxError(e),
        (None, None, None) => return Err(Failure::Usage("one of --faces, --ratio, --max-error".to_owned())),
    };
    let Imported { value: mut mesh, json: import, not_carried, .. } =
        import::mesh(session, &args.file, args.strict.strict)?;
    not_carried.iter().for_each(|line| session.say(line));
    let account = session.timed(Phase::Run, || {
        progress::shown(|hook| {
            mesh.reduce(ReduceOptions {
                target,
                sharp_degrees: args.sharp,
                control: Control::new(hook),
                ..Default::default()
            })
        })
    });
    let account = account.map_err(|error: ReduceError| Failure::Refused {
        message: error.to_string(),
        json: session.fields(false).with_object("import", &import),
    })?;
    let pool = session.timed(Phase::Run, || mesh.to_indexed());
    let vertices = pool.vertex_count();
    let lost = output::write_mesh(session, &args.output, &pool.into())?;
    if !account.cut.is_empty() {
        session.say(&format!("cut into triangles first: {}", counted(account.cut.len(), "face")));
    }
    let json = session
        .fields(false)
        .with("faces", &account.faces)
        .with("vertices", &vertices)
        .with("faces_before", &account.faces_before)
        .with("collapses", &account.collapses)
        .with("stopped", &account.stopped)
        .with("max_error", &account.max_error)
        .with("refusals", &account.refusals)
        .with("faces_cut", &account.cut.len())
        .with("lost", &lost)
        .with_object("import", &import);
    let text = format!(
        "wrote {}: {} of {}; stopped: {}; error at most {}\n",
        args.output.output.display(),
        account.faces,
        counted(account.faces_before, "face"),
        account.stopped,
        number(account.max_error)
    );
    Ok(Answer { json, text, ..Answer::default() })
}

pub(super) fn collapse(session: &mut Session, args: &Collapse) -> Result<Answer, Failure> {
    args.output.format()?;
    let Imported { value: mut mesh, maps, json: import, not_carried } =
        import::mesh(session, &args.file, args.strict.strict)?;
    not_carried.iter().for_each(|line| session.say(line));
    let [i, j] = args.edge;
    let done = session.timed(Phase::Run, || collapse_edge(&mut mesh, &maps, i, j));
    let position = done.map_err(|why| Failure::Refused {
        message: format!("edge {i}-{j} is not collapsed: {why}"),
        json: session.fields(false).with_object("import", &import),
    })?;
    let pool = session.timed(Phase::Run, || mesh.to_indexed());
    let (vertices, faces) = (pool.vertex_count(), pool.face_count());
    let lost = output::write_mesh(session, &args.output, &pool.into())?;
    let json = session
        .fields(false)
        .with("vertices", &vertices)
        .with("faces", &faces)
        .with("edge", &[i, j])
        .with("position", &position)
        .with("lost", &lost)
        .with_object("import", &import);
    let destination = args.output.output.display();
    let text = format!("wrote {destination}: {}, {}\n", counted(vertices, "vertex"), counted(faces, "face"));
    Ok(Answer { json, text, ..Answer::default() })
}

/// Collapses the edge between two vertices of the file to its middle; returns where that is. A vertex that the import
/// split stands for all it became.
fn collapse_edge(mesh: &mut Mesh, maps: &Maps, i: usize, j: usize) -> Result<[f64; 3], String> {
    let vertices = mesh.numbering().vertices;
    let stands_for = |i: usize| match maps.vertices.new_of(i) {
        [] => Err(format!("there is no vertex {i}")),
        new => Ok(new.iter().filter_map(|&v| vertices.get(v as usize).copied())),
    };
    let (from, to) = (stands_for(i)?, stands_for(j)?);
    let mut joined = from.flat_map(|a| to.clone().map(move |b| (a, b)));
    let h = joined.find_map(|(a, b)| mesh.find_halfedge(a, b)).ok_or("no edge joins the two vertices")?;
    // In the numbers that the caller knows.
    let name = |v| in_file(&maps.vertices, vertices.binary_search(&v).unwrap_or_default() as u32);
    let done = mesh.collapse_to_midpoint(h).map_err(|error| match error {
        CollapseError::CommonNeighbor(v) => format!("both ends are joined to vertex {}", name(v)),
        CollapseError::LastFace(v) => format!("vertex {} has no other face", name(v)),
        CollapseError::Duplicate(..) => "two faces would have the same corners".to_owned(),
        CollapseError::CommonFace(_) => "another face has both ends".to_owned(),
        CollapseError::BetweenBoundaries(_) => {
            "it runs through the inside from boundary to boundary".to_owned()
        }
        other => other.to_string(),
    })?;
    Ok(mesh.position(done.vertex).to_array())
}
