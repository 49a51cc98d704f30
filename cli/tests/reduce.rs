//! `reduce` and `collapse` from outside.

mod harness;

use harness::{directory, json, run};
use serde_json::Value;
use std::fs;

/// A square of `n` by `n` quads, a little hilly.
fn hills(n: usize) -> String {
    let mut text = String::new();
    for i in 0..(n + 1) * (n + 1) {
        let (x, y) = ((i % (n + 1)) as f64, (i / (n + 1)) as f64);
        text.push_str(&format!("v {x} {y} {}\n", (x * 0.7).sin() * (y * 0.5).cos()));
    }
    for i in 0..n * n {
        let a = i / n * (n + 1) + i % n + 1;
        text.push_str(&format!("f {a} {} {} {}\n", a + 1, a + n + 2, a + n + 1));
    }
    text
}

const TETRAHEDRON: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

#[test]
fn reduce_meets_each_kind_of_target_and_says_how_it_ended() {
    let dir = directory("reduce-reduce_targets");
    fs::write(dir.join("hills.obj"), hills(20)).expect("written");
    for (flag, value, stopped) in
        [("--faces", "100", "target"), ("--ratio", "0.25", "target"), ("--max-error", "0.05", "error-bound")]
    {
        let (code, answer) = json(&dir, &["reduce", "hills.obj", flag, value, "-o", "out.ply"]);
        assert_eq!((code, &answer["stopped"]), (0, &Value::from(stopped)), "{answer}");
        assert_eq!((&answer["faces_before"], &answer["faces_cut"]), (&400.into(), &400.into()));
        let faces = answer["faces"].as_u64().expect("a number");
        assert!(faces <= 100 || flag == "--max-error", "{answer}");
        assert!(answer["max_error"].as_f64().expect("a number") > 0.0);
        let (_, facts) = json(&dir, &["inspect", "out.ply"]);
        assert_eq!(
            (&facts["faces"], &facts["boundary_loops"], &facts["manifold"]),
            (&faces.into(), &1.into(), &true.into())
        );
    }
}

#[test]
fn reduce_stops_at_a_tetrahedron_without_failing() {
    let dir = directory("reduce-reduce_tetrahedron");
    fs::write(dir.join("a.obj"), TETRAHEDRON).expect("written");
    let (code, answer) = json(&dir, &["reduce", "a.obj", "--faces", "1", "-o", "out.obj"]);
    assert_eq!((code, &answer["faces"], &answer["stopped"]), (0, &4.into(), &"no-legal-collapse".into()));
}

#[test]
fn reduce_refuses_what_makes_no_sense_and_writes_nothing() {
    let dir = directory("reduce-reduce_refuses");
    fs::write(dir.join("a.obj"), TETRAHEDRON).expect("written");
    for (flag, value) in [
        ("--faces", "0"),
        ("--ratio", "0"),
        ("--ratio", "-1"),
        ("--ratio", "2"),
        ("--max-error", "-1"),
        ("--max-error", "NaN"),
    ] {
        let (code, answer) = json(&dir, &["reduce", "a.obj", flag, value, "-o", "out.obj"]);
        assert_eq!((code, &answer["error"]["kind"]), (1, &"refused".into()), "{flag} {value}");
    }
    let usage: [&[&str]; 3] = [&[], &["--faces", "4", "--ratio", "0.5"], &["--faces", "x"]];
    for flags in usage {
        let args = [&["reduce", "a.obj", "-o", "out.obj"], flags].concat();
        assert_eq!(run(&dir, &args).status.code(), Some(2), "{flags:?}");
    }
    assert!(!dir.join("out.obj").exists());
}

#[test]
fn collapse_merges_the_ends_at_the_middle() {
    let dir = directory("reduce-collapse");
    fs::write(dir.join("hills.obj"), hills(4)).expect("written");
    let (code, answer) = json(&dir, &["collapse", "hills.obj", "--edge", "6,7", "-o", "out.obj"]);
    assert_eq!((code, &answer["vertices"], &answer["faces"]), (0, &24.into(), &16.into()), "{answer}");
    assert_eq!(answer["position"][0], 1.5);
}

#[test]
fn collapse_refuses_with_the_reason() {
    let dir = directory("reduce-collapse_refuses");
    fs::write(dir.join("a.obj"), TETRAHEDRON).expect("written");
    for (edge, reason) in [("0,1", "same corners"), ("0,9", "no vertex 9"), ("2,2", "no edge")] {
        let (code, answer) = json(&dir, &["collapse", "a.obj", "--edge", edge, "-o", "out.obj"]);
        let message = answer["error"]["message"].as_str().expect("a message");
        assert_eq!(code, 1);
        assert!(message.contains(reason), "{edge}: {message}");
    }
    assert!(!dir.join("out.obj").exists());
    assert_eq!(run(&dir, &["collapse", "a.obj", "--edge", "1", "-o", "out.obj"]).status.code(), Some(2));
}
