//! Commands that answer and write nothing.

use super::in_file;
use crate::args::{Inspect, Volume};
use crate::import;
use crate::session::{Answer, Failure, Phase, Session};
use meshwright::cleanup::{self, Facts};
use meshwright::{HalfedgeKey, Mesh, NotClosed};
use serde_json::{Map, Value, json};
use std::fmt::Write;

/// The fields of an object.
pub(super) fn fields(value: Value) -> Map<String, Value> {
    match value {
        Value::Object(fields) => fields,
        _ => Map::new(),
    }
}

pub(super) fn inspect(session: &mut Session, args: &Inspect) -> Result<Answer, Failure> {
    let loaded = import::load(session, &args.file)?;
    let facts = session.timed(Phase::Run, || cleanup::inspect(&loaded.soup, args.weld.weld))?;
    let mut json = fields(json!(facts));
    json.insert("notes".to_owned(), json!(loaded.notes));
    Ok(Answer { json, text: describe(&facts), ..Answer::default() })
}

fn describe(f: &Facts) -> String {
    let yes = |b: bool| if b { "yes" } else { "no" };
    let degrees: Vec<String> = f.face_degrees.iter().map(|(d, n)| format!("{n} of {d} corners")).collect();
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
    rows.push(("area", f.area.to_string()));
    rows.extend(f.volume.map(|v| ("volume", v.to_string())));
    rows.extend(f.bbox.map(|b| ("box", format!("{} to {}", b.min, b.max))));
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

fn boundary(f: &Facts) -> String {
    match f.boundary_edges {
        0 => String::new(),
        n => format!(", {n} naked edges in {} pieces", f.boundary_loops),
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
            [[a, b], rest @ ..] => format!("{} edges with {what}, {a}-{b} first\n", rest.len() + 1),
        };
        format!("not closed\n{}{}", list(&naked, "one face"), list(&more, "three or more faces"))
    };
    let witnesses = json!({ "empty": is_empty, "boundary_edges": naked, "nonmanifold_edges": more });
    let json = Map::from_iter([("closed".to_owned(), json!(closed)), ("witnesses".to_owned(), witnesses)]);
    Ok(Answer { json, text, is_no: !closed, ..Answer::default() })
}

pub(super) fn naked_edges(session: &mut Session, args: &Inspect) -> Result<Answer, Failure> {
    let (_, outcome) = import::indexed(session, &args.file, args.weld.weld)?;
    let mut naked = session.timed(Phase::Run, || outcome.value.topology().naked_edges());
    for v in naked.loops.iter_mut().chain(&mut naked.chains).flatten() {
        *v = in_file(&outcome.maps.vertices, *v);
    }
    let mut text = format!("{} loops and {} chains of naked edges\n", naked.loops.len(), naked.chains.len());
    let all = naked.loops.iter().map(|l| ("loop", l)).chain(naked.chains.iter().map(|c| ("chain", c)));
    for (kind, vertices) in all {
        let shown: Vec<String> = vertices.iter().take(10).map(u32::to_string).collect();
        let more = if vertices.len() > 10 { " ..." } else { "" };
        let _ = writeln!(text, "{kind} of {} vertices: {}{more}", vertices.len(), shown.join(" "));
    }
    Ok(Answer { json: fields(json!(naked)), text, ..Answer::default() })
}

pub(super) fn volume(session: &mut Session, args: &Volume) -> Result<Answer, Failure> {
    let (mesh, import) = import::mesh(session, &args.file, args.strict.strict)?;
    let measured = session
        .timed(Phase::Run, || mesh.closed().map(|solid| (solid.volume(), solid.area(), solid.centroid())));
    let (volume, area, centroid) = measured.map_err(|error| {
        let mut json =
            Map::from_iter([("closed".to_owned(), json!(false)), ("import".to_owned(), import.clone())]);
        if let NotClosed::Open { boundary } = &error {
            json.insert("boundary_edges".to_owned(), json!(boundary.len()));
            json.insert("witness".to_owned(), json!(boundary.first().map(|&h| ends(&mesh, h))));
        }
        Failure::Refused { message: format!("no volume: {error}"), json }
    })?;
    let json = json!({ "volume": volume, "area": area, "centroid": centroid, "import": import });
    let center = centroid.map_or("none: the volume is zero".to_owned(), |c| c.to_string());
    let text = format!("volume    {volume}\narea      {area}\ncentroid  {center}\n");
    Ok(Answer { json: fields(json), text, ..Answer::default() })
}

/// Where a half-edge lies.
fn ends(mesh: &Mesh, h: HalfedgeKey) -> [[f64; 3]; 2] {
    [mesh.origin(h), mesh.target(h)].map(|v| mesh.position(v).to_array())
}
