//! The program on the whole corpus, where the environment names one.

mod harness;

use harness::{corpus, directory, json};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// As [`json`], but killed after ten seconds, and where there is a shell that can, held to a gibibyte of memory.
fn json_within_limits(directory: &Path, args: &[&str]) -> (i32, Value) {
    let mut command = if cfg!(target_os = "linux") {
        let mut shell = Command::new("sh");
        shell.args(["-c", "ulimit -v 1048576; exec \"$0\" \"$@\""]).arg(env!("CARGO_BIN_EXE_meshwright"));
        shell
    } else {
        Command::new(env!("CARGO_BIN_EXE_meshwright"))
    };
    // As the answer fits no pipe, it goes to a file.
    let out = fs::File::create(directory.join("stdout")).expect("a file");
    command.current_dir(directory).args(args).args(["--json", "--threads", "2"]);
    let mut child = command.stdout(out).stderr(Stdio::null()).spawn().expect("it runs");
    let start = Instant::now();
    let status = loop {
        match child.try_wait().expect("a child") {
            Some(status) => break status,
            None if start.elapsed() > Duration::from_secs(10) => {
                let _ = child.kill();
                panic!("{args:?} hangs");
            }
            None => std::thread::sleep(Duration::from_millis(1)),
        }
    };
    let text = fs::read_to_string(directory.join("stdout")).expect("text");
    let answer: Value = serde_json::from_str(&text).unwrap_or_else(|e| panic!("{args:?}: {status}: {e}"));
    assert!(answer["peak_rss_bytes"].as_u64().is_some_and(|b| b < 1 << 30), "{args:?}");
    (status.code().expect("a code"), answer)
}

#[test]
fn malformed_corpus_files_end_well_within_ten_seconds_and_a_gibibyte() {
    let Some(files) = corpus() else { return };
    let dir = directory("malformed");
    let mut count = 0;
    for (file, _) in files.iter().filter(|(f, read)| f.contains("/malformed/") || read == "reject") {
        for command in ["inspect", "is-closed", "naked-edges", "volume", "clean", "convert", "flip", "unify"]
        {
            let args = match command {
                "inspect" | "is-closed" | "naked-edges" | "volume" => vec![command, file],
                _ => vec![command, file, "-o", "out.ply"],
            };
            let (code, answer) = json_within_limits(&dir, &args);
            assert!([0, 1, 3].contains(&code), "{args:?}: {code}");
            let error = &answer["error"];
            assert!(code != 3 || error["line"].is_u64() || error["byte"].is_u64(), "{args:?}: {error}");
            count += 1;
        }
    }
    assert!(count > 400, "only {count} runs");
}

#[test]
fn a_second_pass_over_any_corpus_file_gives_the_same_bytes_and_no_counts() {
    let Some(files) = corpus() else { return };
    let dir = directory("corpus_twice");
    let mut count = 0;
    for (file, read) in files.iter().filter(|(_, read)| ["ok", "issues", "no faces"].contains(&read.as_str()))
    {
        let (code, account) = json(&dir, &["clean", file, "-o", "b.ply"]);
        if code == 3 && read == "issues" {
            continue;
        }
        assert_eq!((code, &account["after"]["manifold"]), (0, &true.into()), "{file}");
        let (code, account) = json(&dir, &["clean", "b.ply", "--weld", "none", "-o", "c.ply"]);
        assert_eq!((code, &account["counts"]), (0, &serde_json::json!({})), "{file}");
        assert!(fs::read(dir.join("b.ply")).expect("b") == fs::read(dir.join("c.ply")).expect("c"), "{file}");
        count += 1;
    }
    assert!(count > 200, "only {count} files");
}
