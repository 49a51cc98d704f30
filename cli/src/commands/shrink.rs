//! Commands that take faces away.

use super::look::fields;
use crate::args::{Collapse, Reduce};
use crate::session::{Answer, Failure, Phase, Session};
use crate::{import, output, progress};
use meshwright::{Control, Mesh, ReduceError, ReduceOptions, ReduceTarget};
use serde_json::{Map, json};

pub(super) fn reduce(session: &mut Session, args: &Reduce) -> Result<Answer, Failure> {
    args.output.format()?;
    let target = match (args.goal.faces, args.goal.ratio, args.goal.max_error) {
        (Some(n), ..) => ReduceTarget::Faces(n),
        (_, Some(r), _) => ReduceTarget::Ratio(r),
        (.., Some(e)) => ReduceTarget::MaxError(e),
        (None, None, None) => return Err(Failure::Usage("one of --faces, --ratio, --max-error".to_owned())),
    };
    let (mut mesh, import) = import::mesh(session, &args.file, args.strict.strict)?;
    let account = session.timed(Phase::Run, || {
        progress::shown(|hook| {
            let sharp_angle = args.sharp.map(f64::to_radians);
            mesh.reduce(ReduceOptions {
                target,
                sharp_angle,
                control: Control::new(hook),
                ..Default::default()
            })
        })
    });
    let account = account.map_err(|error: ReduceError| Failure::Refused {
        message: error.to_string(),
        json: Map::from_iter([("import".to_owned(), import.clone())]),
    })?;
    let pool = session.timed(Phase::Run, || mesh.to_indexed());
    let vertices = pool.vertex_count();
    let lost = output::write_mesh(session, &args.output, &pool.into())?;
    if !account.cut.is_empty() {
        session.say(&format!("{} faces were cut into triangles first", account.cut.len()));
    }
    let json = json!({
        "faces": account.faces,
        "vertices": vertices,
        "faces_before": account.faces_before,
        "collapses": account.collapses,
        "stopped": account.stopped,
        "max_error": account.max_error,
        "refusals": account.refusals,
        "faces_cut": account.cut.len(),
        "lost": lost,
        "import": import,
    });
    let text = format!(
        "wrote {}: {} of {} faces; stopped: {}; error at most {}\n",
        args.output.output.display(),
        account.faces,
        account.faces_before,
        account.stopped,
        account.max_error
    );
    Ok(Answer { json: fields(json), text, ..Answer::default() })
}

pub(super) fn collapse(session: &mut Session, args: &Collapse) -> Result<Answer, Failure> {
    args.output.format()?;
    let (mut mesh, import) = import::mesh(session, &args.file, args.strict.strict)?;
    let refuse = |message: String| Failure::Refused {
        message,
        json: Map::from_iter([("import".to_owned(), import.clone())]),
    };
    let [i, j] = args.edge;
    let done = session.timed(Phase::Run, || collapse_edge(&mut mesh, i, j));
    let position = done.map_err(|why| refuse(format!("edge {i}-{j} is not collapsed: {why}")))?;
    let pool = session.timed(Phase::Run, || mesh.to_indexed());
    let (vertices, faces) = (pool.vertex_count(), pool.face_count());
    let lost = output::write_mesh(session, &args.output, &pool.into())?;
    let json = json!({
        "vertices": vertices,
        "faces": faces,
        "edge": [i, j],
        "position": position,
        "lost": lost,
        "import": import,
    });
    let text = format!("wrote {}: {vertices} vertices, {faces} faces\n", args.output.output.display());
    Ok(Answer { json: fields(json), text, ..Answer::default() })
}

/// Collapses the edge between two vertices of the imported mesh to its middle; returns where that is.
fn collapse_edge(mesh: &mut Mesh, i: usize, j: usize) -> Result<[f64; 3], String> {
    let vertices = mesh.numbering().vertices;
    let vertex = |i: usize| vertices.get(i).copied().ok_or_else(|| format!("there is no vertex {i}"));
    let (a, b) = (vertex(i)?, vertex(j)?);
    let h = mesh.find_halfedge(a, b).ok_or("no edge joins the two vertices")?;
    // In the numbers that the caller knows.
    let name = |v| vertices.iter().position(|&w| w == v).unwrap_or_default();
    let done = mesh.collapse_to_midpoint(h).map_err(|error| match error {
        meshwright::CollapseError::CommonNeighbor(v) => format!("both ends are joined to vertex {}", name(v)),
        meshwright::CollapseError::LastFace(v) => format!("vertex {} has no other face", name(v)),
        meshwright::CollapseError::Duplicate(..) => "two faces would have the same corners".to_owned(),
        meshwright::CollapseError::CommonFace(_) => "another face has both ends".to_owned(),
        meshwright::CollapseError::BetweenBoundaries(_) => {
            "it runs through the inside from boundary to boundary".to_owned()
        }
        other => other.to_string(),
    })?;
    Ok(mesh.position(done.vertex).to_array())
}
