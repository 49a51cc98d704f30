//! From a file to what a command works on.

use crate::progress;
use crate::session::{Failure, Phase, Session};
use meshwright::cleanup::{CleanError, CleanOptions, Weld, clean, clean_indexed, index};
use meshwright::io::{Limits, Loaded, read_file};
use meshwright::{Control, IndexedMesh, LostValue, Maps, Mesh, Outcome, PolygonSoup, Report, Step};
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
    import(session, path, strict, clean, |(_, mesh)| mesh)
}

/// As [`mesh`], but gives the vertex pool of the mesh, with all attributes.
pub(crate) fn pool(
    session: &mut Session,
    path: &Path,
    strict: bool,
) -> Result<(IndexedMesh, Value), Failure> {
    import(session, path, strict, clean_indexed, |(pool, _)| pool).map(|(pool, _, import)| (pool, import))
}

fn import<T>(
    session: &mut Session,
    path: &Path,
    strict: bool,
    clean: impl FnOnce(&PolygonSoup, CleanOptions<'_>) -> Result<Outcome<T>, CleanError>,
    choose: impl FnOnce((IndexedMesh, Mesh)) -> T,
) -> Result<(T, Maps, Value), Failure> {
    let loaded = load(session, path)?;
    if strict {
        let (pool, mesh, maps, report) = strict_mesh(session, &loaded)?;
        return Ok((choose((pool, mesh)), maps, import_json(&loaded, &report)));
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
        "lost_values": lost_values(report),
    })
}

fn strict_mesh(session: &mut Session, loaded: &Loaded) -> Result<(IndexedMesh, Mesh, Maps, Report), Failure> {
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
    say_changes(session, &indexed.report);
    match session.timed(Phase::Build, || Mesh::build(&indexed.value)) {
        Ok(mesh) => Ok((indexed.value, mesh, indexed.maps, indexed.report)),
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
    for lost in alike(report) {
        let [attribute, reason] =
            [lost[0].attribute.as_str(), lost[0].reason.as_str()].map(|n| n.replace('_', " "));
        let (count, first) = (lost.len(), lost[0].element);
        lines.push(format!("{count} values of {attribute} not carried ({reason}): {first} first"));
    }
    lines
}

/// The values that were not carried, those of one attribute and reason together.
fn alike(report: &Report) -> impl Iterator<Item = &[LostValue]> {
    report.lost_values.chunk_by(|a, b| (a.attribute, a.reason) == (b.attribute, b.reason))
}

/// The values that were not carried, for `"lost_values"`: how many, and the first, as there may be one at each vertex.
pub(crate) fn lost_values(report: &Report) -> Value {
    let summary = |lost: &[LostValue]| {
        let LostValue { attribute, reason, element } = lost[0];
        json!({ "attribute": attribute, "reason": reason, "count": lost.len(), "first": element })
    };
    alike(report).map(summary).collect()
}
