//! Files written whole or not at all.

use crate::args::Output;
use crate::progress;
use crate::session::{Failure, Phase, Session};
use meshwright::io::{self, Encoding, Lost, WriteError};
use meshwright::{Control, PolygonSoup};
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// A file that is complete, but not yet in its place; dropped, it is gone.
#[derive(Debug)]
pub(crate) struct Staged {
    beside: PathBuf,
    destination: PathBuf,
}

impl Staged {
    /// Puts it in its place.
    pub(crate) fn commit(self) -> Result<(), Failure> {
        fs::rename(&self.beside, &self.destination).map_err(|error| failed(&self.destination, &error))
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        // Committed, or never made, it is not there.
        let _ = fs::remove_file(&self.beside);
    }
}

/// Writes a mesh; returns, and says on standard error, what the format could not carry.
pub(crate) fn write_mesh(
    session: &mut Session,
    output: &Output,
    soup: &PolygonSoup,
) -> Result<Vec<Lost>, Failure> {
    let (staged, lost) = stage_mesh(session, output, soup)?;
    staged.commit()?;
    Ok(lost)
}

/// As [`write_mesh`], but for the last step.
pub(crate) fn stage_mesh(
    session: &mut Session,
    output: &Output,
    soup: &PolygonSoup,
) -> Result<(Staged, Vec<Lost>), Failure> {
    let (path, format) = (&output.output, output.format()?);
    let encoding = if output.ascii { Encoding::Ascii } else { Encoding::Binary };
    let staged = session.timed(Phase::Write, || {
        progress::shown(|hook| {
            stage(path, |sink| io::write_with(soup, format, encoding, sink, Control::new(hook)))
        })
    });
    let (staged, lost) = staged.map_err(|error| match error {
        WriteError::Io(error) => failed(path, &error),
        refused => Failure::refused(format!("{}: {refused}", path.display())),
    })?;
    for kind in &lost {
        session.say(&format!("{} cannot hold {kind}", path.display()));
    }
    Ok((staged, lost))
}

/// Stages a JSON file.
pub(crate) fn stage_json(path: &Path, value: &impl serde::Serialize) -> Result<Staged, Failure> {
    let write = |sink: &mut BufWriter<File>| -> std::io::Result<()> {
        serde_json::to_writer(&mut *sink, value)?;
        sink.write_all(b"\n")
    };
    stage(path, write).map(|s| s.0).map_err(|error| failed(path, &error))
}

/// Stages what is written.
pub(crate) fn stage_with(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> std::io::Result<()>,
) -> Result<Staged, Failure> {
    stage(path, write).map(|s| s.0).map_err(|error| failed(path, &error))
}

fn failed(path: &Path, error: &std::io::Error) -> Failure {
    Failure::Output(format!("{}: {error}", path.display()))
}

/// Writes to a file beside the destination, all of it and onto the disk.
fn stage<T, E: From<std::io::Error>>(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> Result<T, E>,
) -> Result<(Staged, T), E> {
    // A link stays, what it leads to is replaced; a directory or device never is, nor what `/dev/stdout` leads to.
    let destination = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    if path.starts_with("/dev") || fs::metadata(&destination).is_ok_and(|there| !there.is_file()) {
        return Err(std::io::Error::other("is no file that can be replaced").into());
    }
    let beside = beside(&destination);
    let file = File::create_new(&beside)?;
    let staged = Staged { beside, destination };
    let mut sink = BufWriter::new(file);
    let result = write(&mut sink)?;
    sink.flush()?;
    sink.get_ref().sync_all()?;
    Ok((staged, result))
}

fn beside(path: &Path) -> PathBuf {
    let mut name = OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(format!(".{}.part", std::process::id()));
    path.with_file_name(name)
}
