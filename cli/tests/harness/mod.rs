//! The program as tests run it.

#![allow(dead_code, reason = "each test takes what it needs")]

use serde_json::Value;
use std::fs;
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
