//! Files written whole or not at all.

use crate::args::Output;
use crate::session::{Failure, Phase, Session};
use meshwright::PolygonSoup;
use meshwright::io::{self, Encoding, Lost, WriteError};
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// Writes a mesh; returns, and says on standard error, what the format could not carry.
pub(crate) fn write_mesh(
    session: &mut Session,
    output: &Output,
    soup: &PolygonSoup,
) -> Result<Vec<Lost>, Failure> {
    let (path, format) = (&output.output, output.format()?);
    let encoding = if output.ascii { Encoding::Ascii } else { Encoding::Binary };
    let lost = session
        .timed(Phase::Write, || whole_or_not_at_all(path, |sink| io::write(soup, format, encoding, sink)));
    let lost = lost.map_err(|error| match error {
        WriteError::Io(error) => Failure::Output(format!("{}: {error}", path.display())),
        refused => Failure::refused(format!("{}: {refused}", path.display())),
    })?;
    for kind in &lost {
        session.say(&format!("{} cannot hold {kind}", path.display()));
    }
    Ok(lost)
}

/// Writes a JSON file.
pub(crate) fn write_json(path: &Path, value: &impl serde::Serialize) -> Result<(), Failure> {
    write_with(path, |sink| {
        serde_json::to_writer(&mut *sink, value)?;
        sink.write_all(b"\n")
    })
}

/// Writes a text file.
pub(crate) fn write_text(path: &Path, text: &str) -> Result<(), Failure> {
    write_with(path, |sink| sink.write_all(text.as_bytes()))
}

fn write_with(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> std::io::Result<()>,
) -> Result<(), Failure> {
    whole_or_not_at_all(path, write).map_err(|error| Failure::Output(format!("{}: {error}", path.display())))
}

/// Writes to a file beside the destination, and moves it there once it is complete and on disk.
fn whole_or_not_at_all<T, E: From<std::io::Error>>(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> Result<T, E>,
) -> Result<T, E> {
    let beside = beside(path);
    let written = File::create_new(&beside).map_err(E::from).and_then(|file| {
        let mut sink = BufWriter::new(file);
        let result = write(&mut sink)?;
        sink.flush()?;
        sink.get_ref().sync_all()?;
        drop(sink);
        fs::rename(&beside, path)?;
        Ok(result)
    });
    if written.is_err() {
        // Gone already, or never made.
        let _ = fs::remove_file(&beside);
    }
    written
}

fn beside(path: &Path) -> PathBuf {
    let mut name = OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(format!(".{}.part", std::process::id()));
    path.with_file_name(name)
}
