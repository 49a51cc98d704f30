//! The corpus of real meshes, where the environment names one.

#![allow(dead_code, reason = "each test takes what it needs")]

use meshwright::PolygonSoup;
use meshwright::io::{Limits, ReadError, read_file};
use std::collections::HashMap;
use std::io::Write;
use std::path::{Path, PathBuf};

/// A row of the corpus's manifest.
pub(crate) struct Row {
    pub(crate) path: String,
    pub(crate) file: PathBuf,
    fields: HashMap<String, String>,
}

impl Row {
    pub(crate) fn get(&self, field: &str) -> &str {
        self.fields.get(field).map_or_else(|| panic!("the manifest has no column {field}"), String::as_str)
    }

    pub(crate) fn number(&self, field: &str) -> Option<f64> {
        self.get(field).parse().ok()
    }

    pub(crate) fn count(&self, field: &str) -> i64 {
        self.get(field).parse().unwrap_or_else(|_| panic!("{}: {field} is no number", self.path))
    }

    /// Whether the manifest's author could read it.
    pub(crate) fn is_readable(&self) -> bool {
        ["ok", "issues", "no faces"].contains(&self.get("read"))
    }

    /// Whether a file in which something is wrong may be refused.
    pub(crate) fn may_be_refused(&self) -> bool {
        self.get("read") == "issues"
    }

    pub(crate) fn load(&self) -> Result<PolygonSoup, ReadError> {
        read_file(&self.file, &Limits::default()).map(|l| l.soup)
    }
}

/// The corpus's meshes in the formats we read; `None`, and a word about it, if there is no corpus.
pub(crate) fn rows() -> Option<Vec<Row>> {
    let Some(root) = std::env::var_os("MESHWRIGHT_CORPUS") else {
        // Straight to standard error: the harness keeps what tests print to itself.
        let _ = writeln!(std::io::stderr(), "MESHWRIGHT_CORPUS is not set: no corpus, nothing compared");
        return None;
    };
    let root = Path::new(&root);
    let manifest = std::fs::read_to_string(root.join("MANIFEST.tsv")).expect("a corpus has a manifest");
    let mut lines = manifest.lines();
    let names: Vec<&str> = lines.next().expect("a manifest has a header").split('\t').collect();
    let rows = lines.map(|line| {
        let fields: HashMap<String, String> =
            names.iter().map(|n| n.to_string()).zip(line.split('\t').map(str::to_owned)).collect();
        let path = fields["path"].clone();
        Row { file: root.join(&path), path, fields }
    });
    let formats = ["OBJ", "STL", "PLY", "OFF"];
    Some(rows.filter(|r| formats.iter().any(|f| r.get("format").starts_with(f))).collect())
}

/// Differences that are known, with their reasons: `path field ours theirs reason`, separated by tabs.
pub(crate) struct Exceptions {
    known: HashMap<(String, String), (String, String)>,
    met: Vec<(String, String)>,
    failures: Vec<String>,
}

impl Exceptions {
    pub(crate) fn new(table: &str) -> Self {
        let rows = table.lines().filter(|l| !l.is_empty() && !l.starts_with('#'));
        let known = rows.map(|line| {
            let cells: Vec<&str> = line.split('\t').collect();
            let [path, field, ours, theirs, reason] = cells[..] else { panic!("five cells: {line}") };
            assert!(!reason.is_empty(), "a reason: {line}");
            ((path.to_owned(), field.to_owned()), (ours.to_owned(), theirs.to_owned()))
        });
        Self { known: known.collect(), met: Vec::new(), failures: Vec::new() }
    }

    /// Compares one field, by the words in which both are written.
    pub(crate) fn compare(&mut self, path: &str, field: &str, ours: &str, theirs: &str) {
        let key = (path.to_owned(), field.to_owned());
        let listed = self.known.get(&key);
        let same = ours == theirs;
        match listed {
            Some((o, t)) if !same && o == ours && t == theirs => self.met.push(key),
            None if same => {}
            _ => self.failures.push(format!("{path}\t{field}\t{ours}\t{theirs}")),
        }
    }

    /// Fails on differences that are not listed and on rows that are not met.
    pub(crate) fn finish(self) {
        let stale: Vec<_> = self.known.keys().filter(|k| !self.met.contains(k)).collect();
        assert!(self.failures.is_empty(), "differences:\n{}", self.failures.join("\n"));
        assert!(stale.is_empty(), "stale exceptions: {stale:?}");
    }
}
