//! From a file to what a command works on.

use crate::progress;
use crate::session::{Failure, Phase, Session};
use meshwright::cleanup::{CleanOptions, Weld, clean, index};
use meshwright::io::{Limits, Loaded, read_file};
use meshwright::{Control, IndexedMesh, Maps, Mesh, Outcome, Report, Step};
use serde_json::{Map, Value, json};
use std::path::Path;

/// Reads a file, and says on standard error what the reader tolerated.
pub(crate) fn load(session: &mut Session, path: &Path) -> Result<Loaded, Failure> {
    let loaded = session.timed(Phase::Read, || read_file(path, &Limits::default()));
    let loaded = loaded.map_err(|error| Failure::input(path, &error))?;
    for note in &loaded.notes {
        session.say(&format!("{}: {note}", path.display()));
    }
    Ok(loaded)
}

/// Reads a file and makes a mesh of it, by the `preserve` clean-up or, if `strict`, only if it is one. Returns the mesh
/// and what is to be told about the import.
pub(crate) fn mesh(session: &mut Session, path: &Path, strict: bool) -> Result<(Mesh, Value), Failure> {
    mesh_with_maps(session, path, strict).map(|(mesh, _, import)| (mesh, import))
}

/// The same with the relations between the file's elements and the mesh's.
pub(crate) fn mesh_with_maps(
    session: &mut Session,
    path: &Path,
    strict: bool,
) -> Result<(Mesh, Maps, Value), Failure> {
    let loaded = load(session, path)?;
    if strict {
        let (mesh, maps) = strict_mesh(session, &loaded)?;
        return Ok((mesh, maps, json!({ "notes": loaded.notes, "counts": {} })));
    }
    let outcome = session.timed(Phase::Build, || {
        progress::shown(|hook| {
            clean(&loaded.soup, CleanOptions { control: Control::new(hook), ..Default::default() })
        })
    })?;
    say_changes(session, &outcome.report);
    let import = import_json(&loaded, &outcome.report);
    Ok((outcome.value, outcome.maps, import))
}

/// What the import changed, for `"import"`.
pub(crate) fn import_json(loaded: &Loaded, report: &Report) -> Value {
    json!({
        "notes": loaded.notes,
        "counts": report.counts(),
        "defects": report.records,
        "steps": report.steps,
        "not_carried": report.not_carried,
    })
}

fn strict_mesh(session: &mut Session, loaded: &Loaded) -> Result<(Mesh, Maps), Failure> {
    let indexed = session.timed(Phase::Build, || index(&loaded.soup, Weld::Exact))?;
    let refuse = |message: String, defects: Value| {
        let json = Map::from_iter([("defects".to_owned(), defects)]);
        Err(Failure::Refused { message, json })
    };
    if let Some(first) = indexed.report.records.first() {
        let more = indexed.report.records.len() - 1;
        let message = format!("not a valid vertex pool: {} at {} and {more} more", first.kind, first.element);
        return refuse(message, json!(indexed.report.records));
    }
    match session.timed(Phase::Build, || Mesh::build(&indexed.value)) {
        Ok(mesh) => Ok((mesh, indexed.maps)),
        Err(error) => refuse(error.to_string(), json!(error.defects)),
    }
}

/// Reads a file and welds it, whatever its state.
pub(crate) fn indexed(
    session: &mut Session,
    path: &Path,
    weld: Weld,
) -> Result<(Loaded, Outcome<IndexedMesh>), Failure> {
    let loaded = load(session, path)?;
    let outcome = session.timed(Phase::Build, || index(&loaded.soup, weld))?;
    say_changes(session, &outcome.report);
    Ok((loaded, outcome))
}

/// Says on standard error what was changed, in a line per kind.
pub(crate) fn say_changes(session: &Session, report: &Report) {
    for line in changes(report) {
        session.say(&line);
    }
}

/// What was changed, a line per kind, with the first few elements.
pub(crate) fn changes(report: &Report) -> Vec<String> {
    const SHOWN: usize = 5;
    let mut lines = Vec::new();
    let weld = report.steps.iter().find(|s| s.step == Step::Weld && s.changed > 0);
    if let Some(weld) = weld {
        let how = match weld.tolerance {
            Some(t) if t > 0.0 => format!("closer than {t}"),
            _ => "at equal coordinates".to_owned(),
        };
        lines.push(format!("merged {} vertices {how}", weld.changed));
    }
    for (kind, count) in report.counts() {
        let records = report.records.iter().filter(|r| r.kind == kind).take(SHOWN);
        let shown: Vec<String> = records.map(|r| r.element.to_string()).collect();
        let more = if count > SHOWN { format!(" and {} more", count - SHOWN) } else { String::new() };
        lines.push(format!("{count} x {}: {}{more}", kind.as_str().replace('_', " "), shown.join(", ")));
    }
    if !report.not_carried.is_empty() {
        let names: Vec<String> = report.not_carried.iter().map(|a| a.as_str().replace('_', " ")).collect();
        lines.push(format!("not carried: {}", names.join(", ")));
    }
    lines
}
