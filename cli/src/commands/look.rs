//! Commands that answer and write nothing.

use super::in_file;
use crate::args::{Inspect, Volume};
use crate::import::{self, Imported};
use crate::progress;
use crate::session::{Answer, Failure, Phase, Session};
use crate::text::{counted, number, point};
use meshwright::cleanup::{self, Facts};
use meshwright::{Control, HalfedgeKey, Mesh, NotClosed};
use std::fmt::Write;

pub(super) fn inspect(session: &mut Session, args: &Inspect) -> Result<Answer, Failure> {
    let loaded = import::load(session, &args.file)?;
    let facts = session.timed(Phase::Run, || {
        progress::shown(|hook| cleanup::inspect_with(&loaded.soup, args.weld.weld, Control::new(hook)))
    })?;
    let json = session.fields(false).with_all(&facts).with("notes", &loaded.notes);
    Ok(Answer { json, text: describe(&facts), ..Answer::default() })
}

fn describe(f: &Facts) -> String {
    let yes = |b: bool| if b { "yes" } else { "no" };
    let degrees: Vec<String> = f.face_degrees.iter().map(|(&d, &n)| of_degree(d, n)).collect();
    let mut rows: Vec<(&str, String)> = vec![
        ("vertices", format!("{} ({} used after welding)", f.vertices, f.used_vertices)),
        (
            "faces",
            if degrees.is_empty() {
                "none".to_owned()
            } else {
                format!("{}: {}", f.faces, degrees.join(", "))
            },
        ),
        ("components", f.components.to_string()),
        ("closed", format!("{}{}", yes(f.closed), boundary(f))),
        ("manifold", yes(f.manifold).to_owned()),
        (
            "oriented",
            format!("{}{}", yes(f.oriented), if f.orientable { "" } else { ", and cannot be oriented" }),
        ),
        ("Euler characteristic", f.euler_characteristic.to_string()),
    ];
    rows.extend(f.genus.map(|g| ("genus", g.to_string())));
    rows.push(("area", number(f.area)));
    rows.extend(f.volume.map(|v| ("volume", number(v))));
    rows.extend(f.bbox.map(|b| ("box", format!("{} to {}", point(b.min), point(b.max)))));
    let defects = [
        ("edges with 3 or more faces", f.nonmanifold_edges),
        ("pinched vertices", f.nonmanifold_vertices),
        ("edges of conflicting winding", f.conflicting_edges),
        ("degenerate faces", f.degenerate_faces),
        ("duplicate faces", f.duplicate_faces),
        ("faces out of range", f.out_of_range_faces),
        ("faces of fewer than 3 corners", f.short_faces),
        ("vertices that are not finite", f.nonfinite_vertices),
        ("isolated vertices", f.isolated_vertices),
    ];
    rows.extend(defects.into_iter().filter(|d| d.1 > 0).map(|(name, count)| (name, count.to_string())));
    let mut text = String::new();
    for (name, value) in rows {
        // Writing to a string does not fail.
        let _ = writeln!(text, "{name:<30} {value}");
    }
    text
}

/// The faces of one degree, by their name if they have one.
fn of_degree(degree: usize, count: usize) -> String {
    match degree {
        3 => counted(count, "triangle"),
        4 => counted(count, "quad"),
        _ => format!("{count} of {}", counted(degree, "corner")),
    }
}

fn boundary(f: &Facts) -> String {
    match f.boundary_edges {
        0 => String::new(),
        n => format!(", {} in {}", counted(n, "naked edge"), counted(f.boundary_loops, "piece")),
    }
}

pub(super) fn is_closed(session: &mut Session, args: &Inspect) -> Result<Answer, Failure> {
    let (_, outcome) = import::indexed(session, &args.file, args.weld.weld)?;
    let vertices = &outcome.maps.vertices;
    let named = |[a, b]: [u32; 2]| [in_file(vertices, a), in_file(vertices, b)];
    let (naked, more) = session.timed(Phase::Run, || {
        let topology = outcome.value.topology();
        let naked: Vec<[u32; 2]> = topology.boundary_edges().map(|e| named(e.vertices())).collect();
        let more: Vec<[u32; 2]> = topology.nonmanifold_edges().map(|e| named(e.vertices())).collect();
        (naked, more)
    });
    let is_empty = outcome.value.face_count() == 0;
    let closed = !is_empty && naked.is_empty() && more.is_empty();
    let text = if closed {
        "closed: every edge has exactly two faces\n".to_owned()
    } else if is_empty {
        "not closed: there are no faces\n".to_owned()
    } else {
        let list = |edges: &[[u32; 2]], what: &str| match edges {
            [] => String::new(),
            [[a, b], ..] => format!("{} with {what}, {a}-{b} first\n", counted(edges.len(), "edge")),
        };
        format!("not closed\n{}{}", list(&naked, "one face"), list(&more, "three or more faces"))
    };
    let witnesses = session.fields(false).with("empty", &is_empty);
    let witnesses = witnesses.with("boundary_edges", &naked).with("nonmanifold_edges", &more);
    let json = session.fields(false).with("closed", &closed).with_object("witnesses", &witnesses);
    Ok(Answer { json, text, is_no: !closed })
}

pub(super) fn naked_edges(session: &mut Session, args: &Inspect) -> Result<Answer, Failure> {
    let (_, outcome) = import::indexed(session, &args.file, args.weld.weld)?;
    let mut naked = session.timed(Phase::Run, || outcome.value.topology().naked_edges());
    for v in naked.loops.iter_mut().chain(&mut naked.chains).flatten() {
        *v = in_file(&outcome.maps.vertices, *v);
    }
    let [loops, chains] =
        [(&naked.loops, "loop"), (&naked.chains, "chain")].map(|(l, noun)| counted(l.len(), noun));
    let mut text = format!("{loops} and {chains} of naked edges\n");
    let all = naked.loops.iter().map(|l| ("loop", l)).chain(naked.chains.iter().map(|c| ("chain", c)));
    for (kind, vertices) in all {
        let shown: Vec<String> = vertices.iter().take(10).map(u32::to_string).collect();
        let more = if vertices.len() > 10 { " ..." } else { "" };
        let _ = writeln!(text, "{kind} of {}: {}{more}", counted(vertices.len(), "vertex"), shown.join(" "));
    }
    Ok(Answer { json: session.fields(false).with_all(&naked), text, ..Answer::default() })
}

pub(super) fn volume(session: &mut Session, args: &Volume) -> Result<Answer, Failure> {
    let Imported { value: mesh, json: import, .. } = import::mesh(session, &args.file, args.strict.strict)?;
    let measured = session
        .timed(Phase::Run, || mesh.closed().map(|solid| (solid.volume(), solid.area(), solid.centroid())));
    let fields = session.fields(false);
    let (volume, area, centroid) = match measured {
        Ok(measured) => measured,
        Err(error) => {
            let mut json = fields.with("closed", &false).with_object("import", &import);
            if let NotClosed::Open { boundary } = &error {
                json = json.with("boundary_edges", &boundary.len());
                json = json.with("witness", &boundary.first().map(|&h| ends(&mesh, h)));
            }
            return Err(Failure::Refused { message: format!("no volume: {error}"), json });
        }
    };
    let json = fields.with("volume", &volume).with("area", &area).with("centroid", &centroid);
    let json = json.with_object("import", &import);
    let center = centroid.map_or("none: the volume is zero".to_owned(), point);
    let text = format!("volume    {}\narea      {}\ncentroid  {center}\n", number(volume), number(area));
    Ok(Answer { json, text, ..Answer::default() })
}

/// Where a half-edge lies.
fn ends(mesh: &Mesh, h: HalfedgeKey) -> [[f64; 3]; 2] {
    [mesh.origin(h), mesh.target(h)].map(|v| mesh.position(v).to_array())
}
