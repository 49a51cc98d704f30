//! How the program ends: wrong usage, what cannot be read or written, and files that are whole or not there.

mod harness;

use harness::{OPEN, code, cubes, directory, json, run};
use std::fs;
use std::process::{Command, Stdio};

#[test]
fn every_file_of_a_clean_up_is_written_or_none() {
    let dir = directory("all_or_none");
    fs::write(dir.join("a.obj"), OPEN).expect("written");
    for flag in ["--report", "--maps"] {
        let (code, answer) = json(&dir, &["clean", "a.obj", "-o", "b.ply", flag, "no/such/place.json"]);
        assert_eq!((code, &answer["error"]["kind"]), (4, &"output".into()), "{flag}");
    }
    let names: Vec<_> =
        fs::read_dir(&dir).expect("listed").map(|e| e.expect("an entry").file_name()).collect();
    assert_eq!(names, ["a.obj"]);
}

#[cfg(unix)]
#[test]
fn links_stay_and_devices_are_not_replaced() {
    let dir = directory("links");
    fs::write(dir.join("a.obj"), OPEN).expect("written");
    fs::write(dir.join("b.ply"), "old").expect("written");
    std::os::unix::fs::symlink("b.ply", dir.join("link.ply")).expect("a link");
    assert_eq!(code(&dir, &["convert", "a.obj", "-o", "link.ply"]), 0);
    assert!(dir.join("link.ply").is_symlink());
    assert_eq!(code(&dir, &["inspect", "b.ply"]), 0);
    for device in ["/dev/null", "/dev/stdout"] {
        assert_eq!(code(&dir, &["clean", "a.obj", "-o", "c.ply", "--report", device]), 4);
        assert!(!dir.join("c.ply").exists());
    }
}

#[test]
fn strict_refuses_what_the_import_would_change() {
    let dir = directory("strict");
    fs::write(dir.join("bad.obj"), cubes(&[[0, 0, 0], [1, 1, 0]])).expect("written");
    fs::write(dir.join("range.obj"), format!("{OPEN}f 1 2 9\n")).expect("written");
    for (name, kind) in [("bad.obj", "non_manifold_edge"), ("range.obj", "out_of_range_face")] {
        assert_eq!(json(&dir, &["convert", name, "-o", "c.off"]).0, 0);
        let (code, answer) = json(&dir, &["convert", name, "-o", "never.off", "--strict"]);
        assert_eq!(code, 1);
        assert!(answer["defects"][0].to_string().contains(kind), "{answer}");
        assert!(!dir.join("never.off").exists());
    }
    fs::write(dir.join("good.obj"), cubes(&[[0, 0, 0]])).expect("written");
    assert_eq!(code(&dir, &["volume", "good.obj", "--strict"]), 0);
}

#[test]
fn wrong_usage_is_two() {
    let dir = directory("usage");
    fs::write(dir.join("a.obj"), OPEN).expect("written");
    for args in [
        &["inspect"][..],
        &["frobnicate", "a.obj"],
        &["inspect", "a.obj", "--depth", "3"],
        &["clean", "a.obj"],
        &["clean", "a.obj", "-o", "b.xyz"],
        &["clean", "a.obj", "-o", "b.ply", "--weld", "some"],
        &["clean", "a.obj", "-o", "b.ply", "--profile", "perfect"],
        &["clean", "a.obj", "-o", "b.ply", "--debris", "few"],
        &["weld", "a.obj", "-o", "b.ply"],
        &["reduce", "a.obj", "-o", "b.ply"],
        &["reduce", "a.obj", "-o", "b.ply", "--faces", "1", "--ratio", "0.5"],
        &["collapse", "a.obj", "-o", "b.ply", "--edge", "0"],
        &["raycast", "a.obj", "--origin", "-1,0,0"],
        &["smooth", "a.obj", "-o", "b.ply", "--lambda"],
        &["clean", "a.obj", "-o", "b.ply", "--strict"],
        &["volume", "a.obj", "-o", "b.ply"],
        &["inspect", "a.obj", "--weld", "auto"],
        &["inspect", "a.obj", "--threads", "0"],
    ] {
        assert_eq!(code(&dir, args), 2, "{args:?}");
    }
    assert!(!dir.join("b.ply").exists());
    // The extension is looked at by the program itself, which answers as it was asked to.
    let (code_, answer) = json(&dir, &["flip", "a.obj", "-o", "b"]);
    assert_eq!((code_, &answer["error"]["kind"]), (2, &"usage".into()));
    assert_eq!(code(&dir, &["--help"]), 0);
    assert_eq!(code(&dir, &["--version"]), 0);
    assert_eq!(code(&dir, &["inspect", "a.obj", "--threads", "1"]), 0);
}

#[test]
fn a_senseless_tolerance_is_one_though_it_begins_with_a_minus() {
    let dir = directory("tolerance");
    fs::write(dir.join("a.obj"), OPEN).expect("written");
    let (code, answer) = json(&dir, &["clean", "a.obj", "-o", "b.ply", "--weld", "-1"]);
    assert_eq!((code, &answer["error"]["kind"]), (1, &"refused".into()));
    assert!(!dir.join("b.ply").exists());
}

#[test]
fn unreadable_input_is_three_with_its_place() {
    let dir = directory("unreadable");
    fs::write(dir.join("bad.obj"), "v 0 0 0\nv 1 x 0\n").expect("written");
    let (code, answer) = json(&dir, &["inspect", "bad.obj"]);
    assert_eq!((code, &answer["error"]["line"]), (3, &2.into()));
    fs::write(dir.join("bad.ply"), "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar uchar vertex_index\nend_header\n123456789012\u{5}ab").expect("written");
    let (code, answer) = json(&dir, &["clean", "bad.ply", "-o", "c.ply"]);
    assert_eq!((code, answer["error"]["byte"].is_u64()), (3, true));
    let message = String::from_utf8(run(&dir, &["inspect", "bad.obj"]).stderr).expect("text");
    assert!(message.contains("bad.obj: line 2: \"x\" is not a number"), "{message}");
    assert_eq!(json(&dir, &["inspect", "missing.obj"]).0, 3);
    fs::write(dir.join("what"), "hello").expect("written");
    assert_eq!(json(&dir, &["inspect", "what"]).0, 3);
    // Content tells where the name does not.
    fs::write(dir.join("nameless"), OPEN).expect("written");
    assert_eq!(json(&dir, &["inspect", "nameless"]).0, 0);
}

#[test]
fn output_that_cannot_be_written_is_four_and_leaves_nothing() {
    let dir = directory("unwritable");
    fs::write(dir.join("a.obj"), OPEN).expect("written");
    let (code, answer) = json(&dir, &["clean", "a.obj", "-o", "no/such/place.ply"]);
    assert_eq!((code, &answer["error"]["kind"]), (4, &"output".into()));
    fs::create_dir(dir.join("taken.ply")).expect("a directory");
    assert_eq!(json(&dir, &["convert", "a.obj", "-o", "taken.ply"]).0, 4);
    let names: Vec<_> =
        fs::read_dir(&dir).expect("listed").map(|e| e.expect("an entry").file_name()).collect();
    assert_eq!(names.len(), 2, "no part is left behind: {names:?}");
}

#[cfg(unix)]
#[test]
fn names_that_are_no_text_are_taken() {
    use std::os::unix::ffi::OsStrExt;
    let dir = directory("names");
    let [from, to] = [&b"a\xFF.obj"[..], b"b\xFF.ply"].map(std::ffi::OsStr::from_bytes);
    fs::write(dir.join(from), OPEN).expect("written");
    let mut command = Command::new(env!("CARGO_BIN_EXE_meshwright"));
    let status =
        command.current_dir(&dir).arg("convert").arg(from).arg("-o").arg(to).stderr(Stdio::null()).status();
    assert_eq!(status.expect("it runs").code(), Some(0));
    assert!(dir.join(to).exists());
}

#[test]
fn a_file_may_be_replaced_by_its_own_result() {
    let dir = directory("in_place");
    fs::write(dir.join("a.obj"), cubes(&[[0, 0, 0]])).expect("written");
    assert_eq!(code(&dir, &["flip", "a.obj", "-o", "a.obj"]), 0);
    assert_eq!(json(&dir, &["volume", "a.obj"]).1["volume"], -1.0);
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let dir = directory("pipe");
    fs::write(dir.join("a.obj"), OPEN).expect("written");
    let mut child = Command::new(env!("CARGO_BIN_EXE_meshwright"))
        .current_dir(&dir)
        .args(["inspect", "a.obj"])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("it runs");
    drop(child.stdout.take());
    assert_eq!(child.wait().expect("it ends").code(), Some(0));
}
