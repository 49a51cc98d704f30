//! From a file to what a command works on.

use crate::progress;
use crate::session::{Failure, Fields, Phase, Session};
use crate::text;
use meshwright::cleanup::{CleanOptions, Weld, clean, index};
use meshwright::io::{Limits, Loaded, read_file};
use meshwright::{Control, IndexedMesh, Mesh, Outcome, Report};
use serde_json::json;
use std::path::Path;

/// Reads a file, and says on standard error what the reader tolerated.
pub(crate) fn load(session: &mut Session, path: &Path) -> Result<Loaded, Failure> {
    let loaded =
        session.timed(Phase::Read, || progress::named("reading", || read_file(path, &Limits::default())));
    let loaded = loaded.map_err(|error| Failure::input(path, &error))?;
    for note in &loaded.notes {
        session.say(&format!("{}: {note}", path.display()));
    }
    Ok(loaded)
}

/// A file made into a mesh.
pub(crate) struct Imported {
    pub(crate) mesh: Mesh,
    /// What is to be told about it, for `"import"`.
    pub(crate) json: Fields,
    /// What of the file the mesh does not have, in a line.
    pub(crate) not_carried: Option<String>,
}

/// Reads a file and makes a mesh of it, by the `preserve` clean-up or, if `strict`, only if it is one.
pub(crate) fn mesh(session: &mut Session, path: &Path, strict: bool) -> Result<Imported, Failure> {
    let loaded = load(session, path)?;
    if strict {
        let mesh = strict_mesh(session, &loaded)?;
        let json = session.fields(false).with("notes", &loaded.notes).with("counts", &json!({}));
        return Ok(Imported { mesh, json, not_carried: None });
    }
    let outcome = session.timed(Phase::Build, || {
        progress::shown(|hook| {
            clean(&loaded.soup, CleanOptions { control: Control::new(hook), ..Default::default() })
        })
    })?;
    say_changes(session, &outcome.report);
    let json = import_json(session, &loaded, &outcome.report);
    Ok(Imported { mesh: outcome.value, json, not_carried: text::not_carried(&outcome.report) })
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
}

fn strict_mesh(session: &mut Session, loaded: &Loaded) -> Result<Mesh, Failure> {
    let indexed =
        session.timed(Phase::Build, || progress::named("welding", || index(&loaded.soup, Weld::Exact)))?;
    let fields = session.fields(false);
    if let Some(first) = indexed.report.records.first() {
        let more = indexed.report.records.len() - 1;
        let message = format!("not a valid vertex pool: {} at {} and {more} more", first.kind, first.element);
        return Err(Failure::Refused { message, json: fields.with("defects", &indexed.report.records) });
    }
    session.timed(Phase::Build, || progress::named("building", || Mesh::build(&indexed.value))).map_err(
        |error| Failure::Refused { message: error.to_string(), json: fields.with("defects", &error.defects) },
    )
}

/// Reads a file and welds it, whatever its state.
pub(crate) fn indexed(
    session: &mut Session,
    path: &Path,
    weld: Weld,
) -> Result<(Loaded, Outcome<IndexedMesh>), Failure> {
    let loaded = load(session, path)?;
    let outcome = session.timed(Phase::Build, || progress::named("welding", || index(&loaded.soup, weld)))?;
    say_changes(session, &outcome.report);
    Ok((loaded, outcome))
}

/// Says on standard error what was changed, in a line per kind.
fn say_changes(session: &Session, report: &Report) {
    for line in text::changes(report) {
        session.say(&line);
    }
}
