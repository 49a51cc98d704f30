//! `raycast` and `closest` from outside.

mod harness;

use harness::run;
use serde_json::{Value, json};
use std::fs;
use std::path::PathBuf;

const CUBE: &str = "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
    f 2 2 2\nf 2 5 4 3\nf 6 7 8 9\nf 2 3 7 6\nf 3 4 8 7\nf 4 5 9 8\nf 5 2 6 9\n";

fn directory(test: &str) -> PathBuf {
    let path = harness::directory(&format!("ask-{test}"));
    fs::write(path.join("cube.obj"), CUBE).expect("written");
    path
}

#[test]
fn raycast_lists_hits_in_the_files_numbering() {
    let dir = directory("hits");
    // The dropped face comes first in the file and is counted there.
    let ray = ["raycast", "cube.obj", "--origin", "-1,0.25,0.5", "--direction", "1,0,0"];
    let (code, answer) = harness::json(&dir, &ray);
    assert_eq!(code, 0);
    let hits = answer["hits"].as_array().expect("hits");
    assert_eq!(hits.len(), 2);
    assert_eq!((&hits[0]["t"], &hits[1]["t"]), (&json!(1.0), &json!(2.0)));
    assert_eq!(hits[0]["point"], json!([0.0, 0.25, 0.5]));
    assert_eq!((&hits[0]["face"], &hits[1]["face"]), (&json!(6), &json!(4)));
    assert_eq!(hits[0]["feature"], json!({ "face": 6 }));
    assert_eq!((&hits[0]["entering"], &hits[1]["entering"]), (&json!(true), &json!(false)));
    assert!(answer["import"].is_object());
    let (_, first) = harness::json(&dir, &[&ray[..], &["--first"]].concat());
    assert_eq!(first["hits"], json!([hits[0]]));
    let text = String::from_utf8(run(&dir, &ray).stdout).expect("text");
    assert!(text.starts_with("2 hits\nt 1: enters at (0, 0.25, 0.5), face 6\n"), "{text}");
}

#[test]
fn the_diagonal_crosses_twice_and_a_graze_is_a_touch() {
    let dir = directory("diagonal");
    let cast = |o: &str, d: &str| {
        let (code, answer) = harness::json(&dir, &["raycast", "cube.obj", "--origin", o, "--direction", d]);
        assert_eq!(code, 0);
        answer["hits"].as_array().expect("hits").clone()
    };
    let hits = cast("-1,-1,-1", "1,1,1");
    assert_eq!(hits.len(), 2);
    assert_eq!(
        (&hits[0]["feature"], &hits[1]["feature"]),
        (&json!({ "vertex": 1 }), &json!({ "vertex": 7 }))
    );
    let hits = cast("2,0,0.5", "-1,1,0");
    assert_eq!((hits.len(), &hits[0]["entering"], &hits[0]["touch"]), (1, &Value::Null, &json!(true)));
    assert_eq!(hits[0]["feature"], json!({ "edge": [3, 7] }));
    assert_eq!(cast("5,5,5", "1,0,0").len(), 0);
}

#[test]
fn closest_finds_each_kind_of_element() {
    let dir = directory("closest");
    let ask = |point: &str, to: &str| {
        let (code, answer) = harness::json(&dir, &["closest", "cube.obj", "--point", point, "--to", to]);
        assert_eq!(code, 0);
        (answer["element"].clone(), answer["point"].clone(), answer["distance"].clone())
    };
    assert_eq!(ask("8,8,8", "vertex").0, json!({ "vertex": 0 }), "no face names it");
    assert_eq!(ask("-1,0,0", "vertex"), (json!({ "vertex": 1 }), json!([0.0, 0.0, 0.0]), json!(1.0)));
    assert_eq!(ask("0.5,-1,0", "edge"), (json!({ "edge": [1, 2] }), json!([0.5, 0.0, 0.0]), json!(1.0)));
    assert_eq!(ask("0.5,0.25,3", "face"), (json!({ "face": 2 }), json!([0.5, 0.25, 1.0]), json!(2.0)));
    assert_eq!(ask("0.5,0.5,3", "face-center"), (json!({ "face": 2 }), json!([0.5, 0.5, 1.0]), json!(2.0)));
    assert_eq!(ask("1,2,0.5", "surface"), (json!({ "edge": [3, 7] }), json!([1.0, 1.0, 0.5]), json!(1.0)));
    let inside = ["closest", "cube.obj", "--point", "0.5,0.5,0.875", "--to", "surface"];
    assert_eq!(harness::json(&dir, &inside).1["signed_distance"], json!(-0.125));
    let text = String::from_utf8(run(&dir, &inside).stdout).expect("text");
    assert_eq!(text, "face 2 at (0.5, 0.5, 1), distance 0.125\n");
    let far = [&inside[..], &["--max-distance", "0.1"]].concat();
    let (code, answer) = harness::json(&dir, &far);
    assert_eq!((code, &answer["element"]), (1, &Value::Null));
}

#[test]
fn batches_answer_each_line_as_a_single_question() {
    let dir = directory("batch");
    fs::write(dir.join("rays.txt"), "-1,0.25,0.5,1,0,0\n\n-1, -1, -1, 1, 1, 1\n5,5,5,1,0,0\n")
        .expect("written");
    let (code, answer) = harness::json(&dir, &["raycast", "cube.obj", "--queries", "rays.txt"]);
    assert_eq!(code, 0);
    let results = answer["results"].as_array().expect("results");
    let counts: Vec<_> = results.iter().map(|r| r["hits"].as_array().map(Vec::len)).collect();
    assert_eq!(counts, [Some(2), Some(2), Some(0)]);
    let single =
        harness::json(&dir, &["raycast", "cube.obj", "--origin", "-1,0.25,0.5", "--direction", "1,0,0"]).1;
    assert_eq!(results[0]["hits"], single["hits"]);
    fs::write(dir.join("points.txt"), "0.5,0.25,3\n-1,0,0\n").expect("written");
    for to in ["vertex", "edge", "face", "face-center", "surface"] {
        let (code, answer) =
            harness::json(&dir, &["closest", "cube.obj", "--to", to, "--queries", "points.txt"]);
        let results = answer["results"].as_array().expect("results");
        assert_eq!((code, results.len()), (0, 2));
        let single = harness::json(&dir, &["closest", "cube.obj", "--to", to, "--point", "-1,0,0"]).1;
        assert_eq!((&results[1]["element"], &results[1]["point"]), (&single["element"], &single["point"]));
    }
}

#[test]
fn bad_questions_are_told_apart() {
    let dir = directory("bad");
    let code = |args: &[&str]| run(&dir, args).status.code().expect("a code");
    assert_eq!(code(&["raycast", "cube.obj", "--origin", "0,0,0", "--direction", "0,0,0"]), 1);
    assert_eq!(code(&["raycast", "cube.obj", "--origin", "nan,0,0", "--direction", "1,0,0"]), 1);
    assert_eq!(code(&["closest", "cube.obj", "--point", "inf,0,0", "--to", "face"]), 1);
    assert_eq!(
        code(&["closest", "cube.obj", "--point", "0,0,0", "--to", "face", "--max-distance", "nan"]),
        1
    );
    assert_eq!(code(&["raycast", "cube.obj", "--origin", "0,0,0"]), 2);
    assert_eq!(code(&["raycast", "cube.obj"]), 2);
    assert_eq!(code(&["closest", "cube.obj", "--point", "0,0", "--to", "face"]), 2);
    assert_eq!(code(&["closest", "cube.obj", "--point", "0,0,0", "--to", "moon"]), 2);
    assert_eq!(code(&["closest", "cube.obj", "--to", "face", "--queries", "absent.txt"]), 3);
    fs::write(dir.join("q.txt"), "1,2,3\n1,2\n").expect("written");
    let (code, answer) = harness::json(&dir, &["closest", "cube.obj", "--to", "face", "--queries", "q.txt"]);
    assert_eq!((code, &answer["error"]["line"]), (3, &json!(2)));
    fs::write(dir.join("q.txt"), "0,0,0,0,0,0\n").expect("written");
    let (code, answer) = harness::json(&dir, &["raycast", "cube.obj", "--queries", "q.txt"]);
    assert!(
        code == 1 && answer["error"]["message"].as_str().is_some_and(|m| m.contains("line 1")),
        "{answer}"
    );
}
