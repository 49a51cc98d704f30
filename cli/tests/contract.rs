//! Every command on real files: the fields that programs rely on, what is written, and what is refused.

mod harness;

use harness::{corpus, directory, json};
use serde_json::Value;
use std::fs;
use std::path::Path;

const BRACKET: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/data/broken_bracket.obj");

/// The commands with an argument list, where FILE stands for the input and OUT for the output, and the fields beside
/// those that every answer has. Some may answer "no".
const COMMANDS: [(&[&str], &[&str]); 22] = [
    (
        &["weld", "--tolerance", "1e-6", "FILE", "-o", "OUT"],
        &["vertices", "faces", "counts", "defects", "import", "lost"],
    ),
    (
        &["unweld", "--angle", "30", "FILE", "-o", "OUT"],
        &["vertices", "faces", "counts", "defects", "import", "lost"],
    ),
    (&["unify", "FILE", "-o", "OUT"], &["orientable", "flipped", "lost", "import"]),
    (&["unify", "FILE", "--outward", "-o", "OUT"], &["orientable", "flipped", "parts", "lost", "import"]),
    (&["flip", "FILE", "-o", "OUT"], &["faces", "import", "lost"]),
    (&["convert", "FILE", "-o", "OUT"], &["faces", "import", "lost"]),
    (
        &["reduce", "--ratio", "0.5", "FILE", "-o", "OUT"],
        &["stopped", "faces", "vertices", "max_error", "import"],
    ),
    (&["reduce", "--max-error", "0.01", "FILE", "-o", "OUT"], &["stopped", "faces", "faces_before"]),
    (
        &["smooth", "--iterations", "2", "--lambda", "0.5", "FILE", "-o", "OUT"],
        &["vertices", "faces", "import", "lost"],
    ),
    (
        &["smooth", "--iterations", "2", "--lambda", "0.5", "--mu", "-0.53", "FILE", "-o", "OUT"],
        &["vertices", "faces"],
    ),
    (
        &["subdivide", "--scheme", "midpoint", "--levels", "1", "FILE", "-o", "OUT"],
        &["vertices", "faces", "import"],
    ),
    (
        &["subdivide", "--scheme", "catmull-clark", "--levels", "1", "FILE", "-o", "OUT"],
        &["vertices", "faces"],
    ),
    (
        &["transform", "--translate", "-1,2,-3.5", "FILE", "-o", "OUT"],
        &["vertices", "faces", "import", "lost"],
    ),
    (
        &["transform", "--scale", "-2", "--rotate", "-1,0,0,-90", "--origin", "center", "FILE", "-o", "OUT"],
        &["vertices", "faces"],
    ),
    (&["deform", "--wave", "-0.1", "FILE", "-o", "OUT"], &["vertices", "faces", "import", "lost"]),
    (&["clean", "FILE", "-o", "OUT"], &["schema", "defects", "counts", "steps", "before", "after"]),
    (&["inspect", "FILE"], &["vertices", "faces", "components", "closed", "orientable", "bbox"]),
    (&["is-closed", "FILE"], &["closed", "witnesses"]),
    (&["naked-edges", "FILE"], &["loops", "chains"]),
    (&["raycast", "FILE", "--origin", "-1,-2,-3", "--direction", "0.3,0.5,0.7"], &["hits", "import"]),
    (&["raycast", "FILE", "--origin", "-1,-2,-3", "--direction", "0.3,0.5,0.7", "--first"], &["hits"]),
    (
        &["closest", "FILE", "--point", "-1,2,-3", "--to", "surface"],
        &["point", "distance", "element", "face", "signed_distance"],
    ),
];

/// Runs all commands on a file; returns how many were refused.
fn commands_answer(dir: &Path, file: &str) -> usize {
    let mut refused = 0;
    for (args, fields) in COMMANDS {
        let out = dir.join("out.ply");
        let _ = fs::remove_file(&out);
        let fill = |a: &&'static str| match *a {
            "FILE" => file.to_owned(),
            "OUT" => "out.ply".to_owned(),
            other => other.to_owned(),
        };
        let filled: Vec<String> = args.iter().map(fill).collect();
        let filled: Vec<&str> = filled.iter().map(String::as_str).collect();
        let (code, answer) = json(dir, &filled);
        assert!(code == 0 || code == 1, "{filled:?}: {code} {answer}");
        if code == 1 && !answer["error"].is_null() {
            assert_eq!(answer["error"]["kind"], "refused", "{filled:?}");
            assert!(!out.exists(), "{filled:?}: refused, and still something is written");
            refused += 1;
            continue;
        }
        let object = answer.as_object().expect("an object");
        for field in fields {
            assert!(object.contains_key(*field), "{filled:?}: no {field} in {answer}");
        }
        assert_eq!(out.exists(), args.contains(&"OUT"), "{filled:?}");
        if out.exists() {
            let (code, after) = json(dir, &["inspect", "out.ply", "--weld", "none"]);
            assert_eq!(code, 0, "{filled:?}");
            for counted in ["vertices", "faces"] {
                assert!(
                    object.get(counted).is_none_or(|n| !n.is_number() || *n == after[counted]),
                    "{filled:?}: {counted}"
                );
            }
        }
    }
    refused
}

#[test]
fn every_command_answers_with_the_fields_of_the_contract() {
    let dir = directory("contract");
    assert_eq!(commands_answer(&dir, BRACKET), 0);
    // Collapse names an edge, volume wants a closed mesh: what the clean-up makes of the bracket is one.
    assert_eq!(json(&dir, &["clean", BRACKET, "-o", "bracket.ply"]).0, 0);
    let (code, answer) = json(&dir, &["volume", "bracket.ply"]);
    assert_eq!(code, 0, "{answer}");
    for field in ["volume", "area"] {
        assert!(answer[field].as_f64().is_some_and(|x| x > 0.0), "{answer}");
    }
    assert_eq!(answer["centroid"].as_array().map(Vec::len), Some(3));
    let naked = json(&dir, &["closest", "bracket.ply", "--point", "0,0,0", "--to", "edge"]).1;
    let [a, b] = [0, 1].map(|i| naked["element"]["edge"][i].as_u64().expect("a vertex"));
    let (code, answer) =
        json(&dir, &["collapse", "bracket.ply", "--edge", &format!("{a},{b}"), "-o", "c.ply"]);
    assert!(code == 0 || answer["error"]["kind"] == "refused", "{answer}");
    if code == 0 {
        for field in ["vertices", "faces", "edge", "position", "import"] {
            assert!(!answer[field].is_null(), "{answer}");
        }
    }
}

#[test]
fn every_command_works_on_models_of_the_corpus() {
    let Some(files) = corpus() else { return };
    let dir = directory("contract_corpus");
    let wanted = [
        "/clean/trimesh__featuretype.ply",
        "/clean/openmesh__sphere840.ply",
        "/clean/cgal__colored_tetra.ply",
    ];
    let mut run = 0;
    for (file, _) in files.iter().filter(|(f, _)| wanted.iter().any(|w| f.ends_with(w))) {
        assert_eq!(commands_answer(&dir, file), 0, "{file}");
        run += 1;
    }
    assert_eq!(run, wanted.len());
}

const CUBE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n\
    f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";

#[test]
fn what_is_written_is_what_the_commands_name_says() {
    let dir = directory("contract_meaning");
    fs::write(dir.join("a.obj"), CUBE).expect("written");
    let facts = |args: &[&str]| {
        let (code, answer) = json(&dir, &[args, &["a.obj", "-o", "b.ply"]].concat());
        assert_eq!(code, 0, "{args:?}: {answer}");
        json(&dir, &["inspect", "b.ply", "--weld", "none"]).1
    };
    let volume = |args: &[&str]| facts(args)["volume"].as_f64();
    assert_eq!(volume(&["flip"]), Some(-1.0));
    assert_eq!(volume(&["unify", "--outward"]), Some(1.0));
    assert_eq!(volume(&["transform", "--scale", "3"]), Some(27.0));
    assert_eq!(volume(&["transform", "--translate", "-7,0,0"]), Some(1.0));
    assert_eq!(volume(&["subdivide", "--scheme", "midpoint", "--levels", "2"]), Some(1.0));
    assert_eq!(facts(&["unweld", "--angle", "45"])["components"], 6);
    assert_eq!(facts(&["reduce", "--faces", "8"])["faces"], 6, "few enough: the quads stay");
    assert_eq!(facts(&["collapse", "--edge", "0,1"])["vertices"], 7);
    let smooth = volume(&["smooth", "--iterations", "1", "--lambda", "1"]).expect("closed");
    assert!((smooth - 1.0 / 27.0).abs() < 1e-12);
    assert_ne!(facts(&["deform", "--wave", "0.5"])["bbox"], facts(&["convert"])["bbox"]);
}

#[test]
fn bad_values_are_refused_and_write_nothing() {
    let dir = directory("contract_refusals");
    fs::write(dir.join("a.obj"), CUBE).expect("written");
    fs::write(dir.join("open.obj"), CUBE.trim_end().rsplit_once('\n').expect("lines").0).expect("written");
    let write = |args: &[&'static str]| [args, &["a.obj", "-o", "b.ply"]].concat();
    let one: Vec<Vec<&str>> = vec![
        write(&["weld", "--tolerance", "-1"]),
        write(&["weld", "--tolerance", "nan"]),
        write(&["weld", "--tolerance", "inf"]),
        write(&["unweld", "--angle", "-1"]),
        write(&["unweld", "--angle", "181"]),
        write(&["reduce", "--faces", "0"]),
        write(&["reduce", "--ratio", "0"]),
        write(&["reduce", "--ratio", "1.5"]),
        write(&["reduce", "--max-error", "-1"]),
        write(&["reduce", "--faces", "4", "--sharp", "nan"]),
        write(&["smooth", "--iterations", "1", "--lambda", "0"]),
        write(&["smooth", "--iterations", "1", "--lambda", "1.5"]),
        write(&["smooth", "--iterations", "1", "--lambda", "0.5", "--mu", "-0.4"]),
        write(&["subdivide", "--scheme", "loop", "--levels", "99"]),
        write(&["transform", "--scale", "0"]),
        write(&["transform", "--scale", "1,0,1"]),
        write(&["transform", "--rotate", "0,0,0,90"]),
        write(&["transform", "--rotate", "1,0,0,nan"]),
        write(&["transform", "--translate", "inf,0,0"]),
        write(&["transform", "--scale", "2", "--origin", "nan,0,0"]),
        write(&["deform", "--wave", "nan"]),
        write(&["collapse", "--edge", "0,3"]),
        write(&["collapse", "--edge", "0,99"]),
        vec!["volume", "open.obj"],
        vec!["is-closed", "open.obj"],
        vec!["raycast", "a.obj", "--origin", "0,0,0", "--direction", "0,0,0"],
        vec!["closest", "a.obj", "--point", "nan,0,0", "--to", "vertex"],
    ];
    for args in one {
        let (code, answer) = json(&dir, &args);
        assert_eq!(code, 1, "{args:?}: {answer}");
        assert!(
            args[0] == "is-closed" || answer["error"]["message"].as_str().is_some_and(|m| !m.is_empty()),
            "{args:?}"
        );
    }
    let two: Vec<Vec<&str>> = vec![
        write(&["weld"]),
        write(&["unweld", "--angle", "wide"]),
        write(&["reduce"]),
        write(&["reduce", "--faces", "-3"]),
        write(&["smooth", "--lambda", "0.5"]),
        write(&["smooth", "--iterations", "1", "--lambda", "0.5", "--boundary", "loose"]),
        write(&["subdivide", "--scheme", "loop"]),
        write(&["transform", "--rotate", "1,2,3"]),
        write(&["deform"]),
        write(&["collapse"]),
        write(&["unify", "--inward"]),
        vec!["raycast", "a.obj", "--origin", "0,0,0"],
        vec!["closest", "a.obj", "--point", "0,0,0"],
    ];
    for args in two {
        assert_eq!(harness::code(&dir, &args), 2, "{args:?}");
    }
    assert!(!dir.join("b.ply").exists());
}

#[test]
fn an_empty_file_of_faces_is_refused_where_there_is_no_answer() {
    let dir = directory("contract_empty");
    fs::write(dir.join("a.obj"), "v 0 0 0\nv 1 0 0\n").expect("written");
    for (args, expected) in [
        (&["volume", "a.obj"][..], 1),
        (&["is-closed", "a.obj"], 1),
        (&["naked-edges", "a.obj"], 0),
        (&["reduce", "--faces", "4", "a.obj", "-o", "b.ply"], 1),
        (&["smooth", "--iterations", "1", "--lambda", "0.5", "a.obj", "-o", "c.ply"], 0),
        (&["transform", "--scale", "2", "a.obj", "-o", "c.ply"], 0),
        (&["subdivide", "--scheme", "loop", "--levels", "1", "a.obj", "-o", "b.ply"], 1),
        (&["raycast", "a.obj", "--origin", "0,0,0", "--direction", "1,0,0"], 0),
        (&["closest", "a.obj", "--point", "0,0,0", "--to", "vertex"], 0),
        (&["closest", "a.obj", "--point", "0,0,0", "--to", "surface"], 1),
    ] {
        let (code, answer): (i32, Value) = json(&dir, args);
        assert_eq!(code, expected, "{args:?}: {answer}");
    }
    // Without vertices either.
    fs::write(dir.join("a.obj"), "").expect("written");
    for args in [
        &["weld", "--tolerance", "0.1"][..],
        &["unweld", "--angle", "30"],
        &["smooth", "--iterations", "1", "--lambda", "0.5"],
        &["transform", "--scale", "2"],
        &["deform", "--wave", "0.1"],
    ] {
        let (code, answer) = json(&dir, &[args, &["a.obj", "-o", "b.ply"]].concat());
        assert_eq!(
            (code, answer["error"]["message"].as_str()),
            (1, Some("there are no vertices")),
            "{args:?}"
        );
    }
    assert!(!dir.join("b.ply").exists());
}
