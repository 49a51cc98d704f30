//! Reads a file from the wild, cleans it, and tells what was changed.
//!
//! `cargo run --example clean_import -- FILE`; without a file, the broken sample.

use meshwright::Mesh;
use meshwright::cleanup::{CleanOptions, clean};
use meshwright::io::{Limits, read_file};
use std::error::Error;
use std::path::Path;

/// The mesh, and the account in lines.
pub(crate) fn run(path: &Path) -> Result<(Mesh, Vec<String>), Box<dyn Error>> {
    let loaded = read_file(path, &Limits::default())?;
    let mut account: Vec<String> = loaded.notes.iter().map(ToString::to_string).collect();
    let cleaned = clean(&loaded.soup, CleanOptions::default())?;
    for record in &cleaned.report.records {
        let place = record.place.map_or(String::new(), |p| format!(" at {p}"));
        account.push(format!("{}: {} at {}{place}", record.step, record.kind, record.element));
    }
    match cleaned.value.closed() {
        Ok(solid) => account.push(format!("closed, of volume {}", solid.volume())),
        Err(open) => account.push(open.to_string()),
    }
    Ok((cleaned.value, account))
}

#[allow(dead_code, reason = "the tests call run")]
fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args_os().nth(1);
    let path = file.as_deref().map_or(Path::new("examples/data/broken_bracket.obj"), Path::new);
    let (mesh, account) = run(path)?;
    println!("{mesh:?}");
    for line in account {
        println!("{line}");
    }
    Ok(())
}
