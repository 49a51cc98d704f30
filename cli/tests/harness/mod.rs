//! The program as tests run it.

#![allow(dead_code, reason = "each test takes what it needs")]

use serde_json::Value;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A directory of this test's own.
pub(crate) fn directory(test: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).expect("a directory");
    path
}

pub(crate) fn run(directory: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_meshwright"))
        .current_dir(directory)
        .args(args)
        .output()
        .expect("it runs")
}

/// The exit code and the one JSON object on standard output.
pub(crate) fn json(directory: &Path, args: &[&str]) -> (i32, Value) {
    let output = run(directory, &[args, &["--json"]].concat());
    let text = String::from_utf8(output.stdout).expect("text");
    let value: Value = serde_json::from_str(&text).unwrap_or_else(|e| panic!("{args:?}: {e}: {text:?}"));
    assert_eq!(text.lines().count(), 1, "one line");
    let timings = value["timings_ms"].as_object().expect("timings");
    assert_eq!(timings.keys().collect::<Vec<_>>(), ["build", "read", "run", "write"]);
    assert!(value["peak_rss_bytes"].as_u64().expect("a number") > 0 || !cfg!(target_os = "linux"));
    (output.status.code().expect("a code"), value)
}

/// The exit code alone.
pub(crate) fn code(directory: &Path, args: &[&str]) -> i32 {
    run(directory, args).status.code().expect("a code")
}

/// Paths of the corpus's files in our formats, each with what the manifest says of reading it; `None`, and a word about
/// it, if there is no corpus.
pub(crate) fn corpus() -> Option<Vec<(String, String)>> {
    let Some(root) = std::env::var_os("MESHWRIGHT_CORPUS") else {
        // Straight to standard error: the harness keeps what tests print to itself.
        let _ = writeln!(std::io::stderr(), "MESHWRIGHT_CORPUS is not set: no corpus, nothing run");
        return None;
    };
    let root = Path::new(&root);
    let manifest = fs::read_to_string(root.join("MANIFEST.tsv")).expect("a corpus has a manifest");
    let mut rows = manifest.lines().map(|line| line.split('\t').collect::<Vec<_>>());
    let names = rows.next().expect("a header");
    let column = |name: &str| names.iter().position(|n| *n == name).expect("a column");
    let (path, format, read) = (column("path"), column("format"), column("read"));
    let ours = rows.filter(|r| ["OBJ", "STL", "PLY", "OFF"].iter().any(|f| r[format].starts_with(f)));
    let file = |r: &Vec<&str>| root.join(r[path]).to_str().expect("a plain name").to_owned();
    Some(ours.map(|r| (file(&r), r[read].to_owned())).collect())
}

/// OBJ text of unit cubes at the given corners, sharing vertices at equal places.
pub(crate) fn cubes(corners: &[[i32; 3]]) -> String {
    let mut vertices: Vec<[i32; 3]> = Vec::new();
    let mut faces = String::new();
    for at in corners {
        for quad in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
            faces.push('f');
            for i in quad {
                let p = [at[0] + (i & 1), at[1] + (i >> 1 & 1), at[2] + (i >> 2)];
                let index = vertices.iter().position(|q| *q == p).unwrap_or_else(|| {
                    vertices.push(p);
                    vertices.len() - 1
                });
                faces.push_str(&format!(" {}", index + 1));
            }
            faces.push('\n');
        }
    }
    let vertices: String = vertices.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n")).collect();
    vertices + &faces
}

/// A triangle and a vertex beside it.
pub(crate) const OPEN: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 5 5\nf 1 2 3\n";
