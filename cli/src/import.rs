//! From a file to what a command works on.

use crate::progress;
use crate::session::{Failure, Fields, Phase, Session};
use crate::text;
use meshwright::cleanup::{CleanError, CleanOptions, Weld, clean, clean_indexed, index_with};
use meshwright::io::{Limits, Loaded, read_file_with};
use meshwright::{BuildWithError, Control, IndexedMesh, LostValue, Maps, Mesh, Outcome, PolygonSoup, Report};
use serde_json::{Value, json};
use std::path::Path;

/// Reads a file, and says on standard error what the reader tolerated.
pub(crate) fn load(session: &mut Session, path: &Path) -> Result<Loaded, Failure> {
    let loaded = session.timed(Phase::Read, || {
        progress::shown(|hook| read_file_with(path, &Limits::default(), Control::new(hook)))
    });
    let loaded = loaded.map_err(|error| Failure::input(path, &error))?;
    for note in &loaded.notes {
        session.say(&format!("{}: {note}", path.display()));
    }
    Ok(loaded)
}

/// A file made into a mesh, or into the vertex pool of one.
pub(crate) struct Imported<T> {
    pub(crate) value: T,
    /// From the file's elements to the mesh's.
    pub(crate) maps: Maps,
    /// What is to be told about it, for `"import"`.
    pub(crate) json: Fields,
    /// What of the file the result does not have, in lines.
    pub(crate) not_carried: Vec<String>,
}

/// Reads a file and makes a mesh of it, by the `preserve` clean-up or, if `strict`, only if it is one.
pub(crate) fn mesh(session: &mut Session, path: &Path, strict: bool) -> Result<Imported<Mesh>, Failure> {
    import(session, path, strict, clean, |(_, mesh)| mesh)
}

/// As [`mesh`], but gives the vertex pool of the mesh.
pub(crate) fn pool(
    session: &mut Session,
    path: &Path,
    strict: bool,
) -> Result<Imported<IndexedMesh>, Failure> {
    import(session, path, strict, clean_indexed, |(pool, _)| pool)
}

fn import<T>(
    session: &mut Session,
    path: &Path,
    strict: bool,
    clean: impl FnOnce(&PolygonSoup, CleanOptions<'_>) -> Result<Outcome<T>, CleanError>,
    choose: impl FnOnce((IndexedMesh, Mesh)) -> T,
) -> Result<Imported<T>, Failure> {
    let loaded = load(session, path)?;
    let Outcome { value, report, maps } = if strict {
        strict_mesh(session, &loaded, choose)?
    } else {
        session.timed(Phase::Build, || {
            progress::shown(|hook| {
                clean(&loaded.soup, CleanOptions { control: Control::new(hook), ..Default::default() })
            })
        })?
    };
    say_changes(session, &report);
    let json = import_json(session, &loaded, &report);
    Ok(Imported { value, maps, json, not_carried: text::not_carried(&report) })
}

/// What the import changed, for `"import"`.
pub(crate) fn import_json(session: &Session, loaded: &Loaded, report: &Report) -> Fields {
    session
        .fields(false)
        .with("notes", &loaded.notes)
        .with("counts", &report.counts())
        .with("defects", &report.records)
        .with("steps", &report.steps)
        .with("not_carried", &report.not_carried)
        .with("lost_values", &lost_values(report))
}

/// The values that were not carried, for `"lost_values"`: how many, and the first, as there may be one at each vertex.
pub(crate) fn lost_values(report: &Report) -> Vec<Value> {
    let summary = |lost: &[LostValue]| {
        let LostValue { attribute, reason, element } = lost[0];
        json!({ "attribute": attribute, "reason": reason, "count": lost.len(), "first": element })
    };
    text::alike(report).map(summary).collect()
}

fn strict_mesh<T>(
    session: &mut Session,
    loaded: &Loaded,
    choose: impl FnOnce((IndexedMesh, Mesh)) -> T,
) -> Result<Outcome<T>, Failure> {
    let indexed = index_shown(session, &loaded.soup, Weld::Exact)?;
    let fields = session.fields(false);
    if let Some(first) = indexed.report.records.first() {
        let more = indexed.report.records.len() - 1;
        let message = format!("not a valid vertex pool: {} at {} and {more} more", first.kind, first.element);
        return Err(Failure::Refused { message, json: fields.with("defects", &indexed.report.records) });
    }
    let Outcome { value: pool, report, maps } = indexed;
    let built =
        session.timed(Phase::Build, || progress::shown(|hook| Mesh::build_with(&pool, Control::new(hook))));
    match built {
        Ok(mesh) => Ok(Outcome { value: choose((pool, mesh)), report, maps }),
        Err(error) => {
            let json = match &error {
                BuildWithError::Refused(refused) => fields.with("defects", &refused.defects),
                _ => fields,
            };
            Err(Failure::Refused { message: error.to_string(), json })
        }
    }
}

/// Reads a file and welds it, whatever its state.
pub(crate) fn indexed(
    session: &mut Session,
    path: &Path,
    weld: Weld,
) -> Result<(Loaded, Outcome<IndexedMesh>), Failure> {
    let loaded = load(session, path)?;
    let outcome = index_shown(session, &loaded.soup, weld)?;
    say_changes(session, &outcome.report);
    Ok((loaded, outcome))
}

fn index_shown(
    session: &mut Session,
    soup: &PolygonSoup,
    weld: Weld,
) -> Result<Outcome<IndexedMesh>, CleanError> {
    session.timed(Phase::Build, || progress::shown(|hook| index_with(soup, weld, Control::new(hook))))
}

/// Says on standard error what was changed, in a line per kind.
fn say_changes(session: &Session, report: &Report) {
    for line in text::changes(report) {
        session.say(&line);
    }
}
