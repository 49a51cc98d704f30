//! `clean --profile solid` from outside: what it answers, what it writes, what it says.

mod harness;

use harness::{directory, json, run};
use serde_json::Value;
use std::fs;

/// A unit cube of quads at a place along x, without its top if so told, its vertices numbered from `first`.
fn cube(x: i32, first: usize, is_open: bool) -> String {
    let mut text = String::new();
    for i in 0..8 {
        text += &format!("v {} {} {}\n", x + (i & 1), i >> 1 & 1, i >> 2);
    }
    let walls = [[0, 2, 3, 1], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5], [4, 5, 7, 6]];
    for wall in walls.iter().take(if is_open { 5 } else { 6 }) {
        let [a, b, c, d] = wall.map(|v| v + first);
        text += &format!("f {a} {b} {c} {d}\n");
    }
    text
}

const SHEET: &str = "v 9 0 0\nv 10 0 0\nv 9 1 0\nf -3 -2 -1\n";

#[test]
fn an_open_box_becomes_a_solid_and_the_account_tells_how() {
    let dir = directory("solid_box");
    fs::write(dir.join("a.obj"), cube(0, 1, true)).expect("written");
    let args = ["clean", "a.obj", "-o", "b.ply", "--profile", "solid"];
    let (code, account) = json(&dir, &args);
    assert_eq!((code, &account["solid"], &account["profile"]), (0, &true.into(), &"solid".into()));
    assert_eq!(account["counts"], serde_json::json!({ "filled_hole": 1 }));
    let hole = &account["defects"][0];
    assert_eq!(
        (&hole["element"]["vertex"], &hole["place"]),
        (&4.into(), &serde_json::json!([0.5, 0.5, 1.0]))
    );
    assert_eq!(hole["extent"], serde_json::json!({ "elements": 4, "area": 1.0 }));
    let tally = serde_json::json!({ "input": 5, "kept": 5, "changed": 0, "dropped": 0, "added": 1 });
    assert_eq!((&account["face_tally"], &account["moved"]), (&tally, &0.0.into()));
    assert_eq!(account["after"]["volume"], 1.0);
    assert_eq!(json(&dir, &["volume", "b.ply"]).1["volume"], 1.0);
    let text = String::from_utf8(run(&dir, &args).stdout).expect("text");
    assert!(text.contains("1 hole filled\n      vertex 4 at (0.5, 0.5, 1), 4 edges, area 1"), "{text}");
    assert!(text.contains("a solid: closed, manifold, oriented, outward"), "{text}");
}

#[test]
fn what_cannot_become_a_solid_is_written_and_named_and_the_answer_is_no() {
    let dir = directory("solid_no");
    fs::write(dir.join("a.obj"), cube(0, 1, true) + SHEET).expect("written");
    let args = ["clean", "a.obj", "-o", "b.ply", "--profile", "solid"];
    let (code, account) = json(&dir, &args);
    assert_eq!((code, &account["solid"]), (1, &false.into()));
    assert_eq!(account["counts"], serde_json::json!({ "filled_hole": 1, "open_sheet": 1 }));
    assert_eq!(json(&dir, &["inspect", "b.ply"]).1["faces"], 7);
    let output = run(&dir, &args);
    let text = String::from_utf8(output.stdout).expect("text");
    assert_eq!(output.status.code(), Some(1));
    assert!(text.contains("Left as it is\n  1 sheet that cannot become a solid"), "{text}");
    assert!(text.contains("no solid: not closed"), "{text}");
    // Asked for, small parts are dropped.
    let (code, account) = json(&dir, &[&args[..], &["--debris", "2"]].concat());
    assert_eq!((code, &account["solid"], &account["counts"]["debris"]), (0, &true.into(), &1.into()));
}

#[test]
fn the_tolerance_is_proposed_unless_it_is_given() {
    let dir = directory("solid_weld");
    // Every face with corners of its own, a little off.
    let walls = [[0, 2, 3, 1], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5], [4, 5, 7, 6]];
    let mut text = String::new();
    for (f, wall) in (1..).zip(walls) {
        for (c, v) in (1..).zip(wall) {
            let off = 1e-6 * f64::from((f * 7 + c * 3) % 5);
            text += &format!(
                "v {} {} {}\n",
                f64::from(v & 1) + off,
                f64::from(v >> 1 & 1),
                f64::from(v >> 2) - off
            );
        }
        text += "f -4 -3 -2 -1\n";
    }
    fs::write(dir.join("a.obj"), text).expect("written");
    let solid = ["clean", "a.obj", "-o", "b.ply", "--profile", "solid"];
    let (code, account) = json(&dir, &solid);
    assert_eq!((code, &account["after"]["vertices"]), (0, &8.into()));
    let tolerance = account["tolerance"].as_f64().expect("a number");
    assert!((4e-6..0.01).contains(&tolerance), "{tolerance}");
    assert!(account["moved"].as_f64().is_some_and(|m| m > 0.0 && m <= tolerance));
    let (code, account) = json(&dir, &[&solid[..], &["--weld", "exact"]].concat());
    assert!(account["tolerance"] == 0.0, "{code} {account}");
    // The other profile merges what is equal.
    assert_eq!(json(&dir, &["clean", "a.obj", "-o", "b.ply"]).1["tolerance"], 0.0);
}

#[test]
fn vertices_that_stl_will_merge_again_are_told() {
    let dir = directory("solid_stl");
    // Two cubes that share an edge.
    let mut text = cube(0, 1, false);
    for i in 0..8 {
        text += &format!("v {} {} {}\n", 1 + (i & 1), 1 + (i >> 1 & 1), i >> 2);
    }
    text += "f 9 11 12 10\nf 13 14 16 15\nf 9 10 14 13\nf 11 15 16 12\nf 9 13 15 11\nf 10 12 16 14\n";
    fs::write(dir.join("a.obj"), text).expect("written");
    let told = |out: &str| {
        let args = ["clean", "a.obj", "-o", out, "--profile", "solid"];
        let text = String::from_utf8(run(&dir, &args).stdout).expect("text");
        (json(&dir, &args).1["remerged_vertices"].clone(), text.contains("STL knows no vertices"))
    };
    assert_eq!(told("b.stl"), (Value::from(2), true));
    assert_eq!(told("b.ply"), (Value::from(0), false));
}
