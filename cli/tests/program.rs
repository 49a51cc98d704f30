//! The program from outside: what it prints, what it writes, and how it ends.

mod harness;

use harness::{OPEN, code, cubes, directory, json, run};
use serde_json::Value;
use std::fs;

const MOEBIUS: &str =
    "v 0 0 0\nv 0 0 1\nv 1 0 0\nv 1 0 1\nv 0 1 0\nv 0 1 1\nf 1 3 4 2\nf 3 5 6 4\nf 5 2 1 6\n";

#[test]
fn inspect_prints_every_field_of_the_contract() {
    let dir = directory("inspect");
    fs::write(dir.join("a.obj"), cubes(&[[0, 0, 0]])).expect("written");
    let (code, facts) = json(&dir, &["inspect", "a.obj"]);
    assert_eq!(code, 0);
    for (field, expected) in [
        ("vertices", Value::from(8)),
        ("faces", 6.into()),
        ("used_vertices", 8.into()),
        ("face_degrees", serde_json::json!({ "4": 6 })),
        ("components", 1.into()),
        ("boundary_edges", 0.into()),
        ("boundary_loops", 0.into()),
        ("nonmanifold_edges", 0.into()),
        ("nonmanifold_vertices", 0.into()),
        ("conflicting_edges", 0.into()),
        ("degenerate_faces", 0.into()),
        ("duplicate_faces", 0.into()),
        ("isolated_vertices", 0.into()),
        ("out_of_range_faces", 0.into()),
        ("nonfinite_vertices", 0.into()),
        ("closed", true.into()),
        ("manifold", true.into()),
        ("oriented", true.into()),
        ("orientable", true.into()),
        ("euler_characteristic", 2.into()),
        ("genus", 0.into()),
        ("area", 6.0.into()),
        ("volume", 1.0.into()),
        ("bbox", serde_json::json!({ "min": [0.0, 0.0, 0.0], "max": [1.0, 1.0, 1.0] })),
    ] {
        assert_eq!(facts[field], expected, "{field}");
    }
    fs::write(dir.join("open.obj"), OPEN).expect("written");
    let (_, facts) = json(&dir, &["inspect", "open.obj"]);
    assert!(facts["volume"].is_null() && facts["genus"].is_null() && facts["isolated_vertices"] == 1);
    let text = String::from_utf8(run(&dir, &["inspect", "open.obj"]).stdout).expect("text");
    assert!(text.contains("no, 3 naked edges in 1 piece\n"), "{text}");
}

#[test]
fn clean_prints_its_account_and_writes_it_to_files() {
    let dir = directory("clean");
    fs::write(dir.join("a.obj"), cubes(&[[0, 0, 0], [1, 1, 0]]) + "f 1 2 99\n").expect("written");
    let args = ["clean", "a.obj", "-o", "b.ply", "--report", "r.json", "--maps", "m.json"];
    let (code, account) = json(&dir, &args);
    assert_eq!((code, &account["schema"]), (0, &Value::from(1)));
    assert_eq!(account["counts"]["out_of_range_face"], 1);
    assert_eq!(account["counts"]["non_manifold_edge"], 1);
    assert_eq!(account["counts"]["pinched_vertex"], 2);
    let first = &account["defects"][0];
    assert_eq!((&first["kind"], &first["element"]["face"]), (&"out_of_range_face".into(), &12.into()));
    assert!(first["place"].is_array() && account["steps"].is_array());
    assert_eq!((&account["before"]["closed"], &account["after"]["closed"]), (&false.into(), &true.into()));
    assert_eq!(account["after"]["volume"], 2.0);
    assert_eq!(account["notes"][0]["place"]["line"], 27);
    let report: Value =
        serde_json::from_slice(&fs::read(dir.join("r.json")).expect("a report")).expect("JSON");
    assert_eq!(report["defects"], account["defects"]);
    let maps: Value = serde_json::from_slice(&fs::read(dir.join("m.json")).expect("maps")).expect("JSON");
    assert_eq!(maps["faces"]["new_of"].as_array().map(Vec::len), Some(13));
    assert_eq!(maps["faces"]["new_of"][12], serde_json::json!([]));
    assert_eq!(maps["vertices"]["old_of"].as_array().map(Vec::len), Some(16));
    let text = String::from_utf8(run(&dir, &args).stdout).expect("text");
    assert!(text.contains("2 vertices where surfaces touch, split\n      vertex"), "{text}");
    assert!(text.contains("of 13 faces: 12 kept, 1 dropped\n"), "{text}");
    assert!(text.contains("--weld none"), "{text}");
    // Both looks are whole ones.
    let looked = json(&dir, &["inspect", "a.obj"]).1;
    let keys = |v: &Value| -> Vec<String> { v.as_object().expect("an object").keys().cloned().collect() };
    let extra = ["notes", "peak_rss_bytes", "timings_ms"];
    let expected: Vec<String> = keys(&looked).into_iter().filter(|k| !extra.contains(&k.as_str())).collect();
    assert_eq!((keys(&account["before"]), keys(&account["after"])), (expected.clone(), expected));
}

#[test]
fn commands_that_import_say_what_the_import_changed() {
    let dir = directory("import");
    fs::write(dir.join("a.obj"), cubes(&[[0, 0, 0], [1, 1, 0]]) + "f 1 2 99\n").expect("written");
    for args in [
        &["convert", "a.obj", "-o", "b.ply"][..],
        &["flip", "a.obj", "-o", "b.ply"],
        &["volume", "a.obj"],
        &["unify", "a.obj", "-o", "b.ply"],
    ] {
        let output = run(&dir, args);
        let message = String::from_utf8(output.stderr).expect("text");
        assert!(message.contains("1 face naming vertices that do not exist, dropped: face 12"), "{message}");
        let (code, answer) = json(&dir, args);
        assert_eq!((code, &answer["import"]["counts"]["out_of_range_face"]), (0, &1.into()), "{args:?}");
        let import = &answer["import"];
        assert!(import["defects"].is_array() && import["steps"].is_array() && import["notes"].is_array());
    }
}

#[test]
fn time_is_told_for_each_part_and_zero_where_there_is_none() {
    let dir = directory("timings");
    fs::write(dir.join("a.obj"), cubes(&[[0, 0, 0]])).expect("written");
    for (args, parts) in [
        (&["inspect", "a.obj"][..], &["read", "run"][..]),
        (&["volume", "a.obj"], &["read", "build", "run"]),
        (&["convert", "a.obj", "-o", "b.ply"], &["read", "build", "write"]),
        (&["clean", "a.obj", "-o", "b.ply"], &["read", "run", "write"]),
    ] {
        let timings = json(&dir, args).1["timings_ms"].clone();
        for part in ["read", "build", "write"] {
            let spent = timings[part].as_f64().expect("a number");
            assert_eq!(spent > 0.0, parts.contains(&part), "{args:?}: {part} {spent}");
        }
    }
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let dir = directory("threads");
    let corners: Vec<[i32; 3]> = (0..400).map(|i| [i % 20, i / 20, (i * 7) % 3]).collect();
    fs::write(dir.join("a.obj"), cubes(&corners)).expect("written");
    let account = |threads: &str| {
        let (code, mut account) =
            json(&dir, &["clean", "a.obj", "-o", "b.ply", "--maps", "m.json", "--threads", threads]);
        assert_eq!(code, 0);
        for varies in ["timings_ms", "peak_rss_bytes"] {
            account[varies] = Value::Null;
        }
        (account, fs::read(dir.join("b.ply")).expect("b"), fs::read(dir.join("m.json")).expect("m"))
    };
    let alone = account("1");
    assert!(alone.0["counts"]["non_manifold_edge"].as_u64() > Some(100));
    for threads in ["2", "3", "8"] {
        assert!(account(threads) == alone, "{threads} threads");
    }
}

#[test]
fn cubes_that_touch_become_closed_cubes_of_total_volume_two() {
    let dir = directory("touching");
    for (name, other) in [("edge", [1, 1, 0]), ("vertex", [1, 1, 1])] {
        fs::write(dir.join("a.obj"), cubes(&[[0, 0, 0], other])).expect("written");
        for output in ["b.ply", "b.off", "b.obj"] {
            let (code, account) = json(&dir, &["clean", "a.obj", "-o", output]);
            assert_eq!((code, &account["after"]["components"]), (0, &2.into()), "{name}");
            assert_eq!(account["after"]["volume"], 2.0);
        }
        let (code, measured) = json(&dir, &["volume", "b.off"]);
        assert_eq!((code, &measured["volume"], &measured["area"]), (0, &2.0.into(), &12.0.into()));
        assert_eq!(measured["centroid"].as_array().map(Vec::len), Some(3));
    }
}

#[test]
fn a_second_pass_gives_the_same_bytes_and_no_counts() {
    let dir = directory("second_pass");
    for (name, text) in
        [("edge", cubes(&[[0, 0, 0], [1, 1, 0]])), ("open", OPEN.into()), ("moebius", MOEBIUS.into())]
    {
        fs::write(dir.join("a.obj"), text).expect("written");
        assert_eq!(code(&dir, &["clean", "a.obj", "-o", "b.ply"]), 0);
        let (code, account) = json(&dir, &["clean", "b.ply", "--weld", "none", "-o", "c.ply"]);
        assert_eq!((code, &account["counts"]), (0, &serde_json::json!({})), "{name}");
        assert_eq!(
            fs::read(dir.join("b.ply")).expect("b"),
            fs::read(dir.join("c.ply")).expect("c"),
            "{name}"
        );
    }
}

#[test]
fn is_closed_answers_by_exit_code_and_shows_witnesses() {
    let dir = directory("is_closed");
    fs::write(dir.join("closed.obj"), cubes(&[[0, 0, 0]])).expect("written");
    fs::write(dir.join("open.obj"), OPEN).expect("written");
    fs::write(dir.join("cloud.obj"), "v 0 0 0\n").expect("written");
    fs::write(dir.join("touch.obj"), cubes(&[[0, 0, 0], [1, 1, 0]])).expect("written");
    assert_eq!(json(&dir, &["is-closed", "closed.obj"]).0, 0);
    let (code, answer) = json(&dir, &["is-closed", "open.obj"]);
    assert_eq!((code, &answer["closed"]), (1, &false.into()));
    assert_eq!(answer["witnesses"]["boundary_edges"], serde_json::json!([[0, 1], [1, 2], [0, 2]]));
    assert_eq!(json(&dir, &["is-closed", "cloud.obj"]).1["witnesses"]["empty"], true);
    let (code, answer) = json(&dir, &["is-closed", "touch.obj"]);
    assert_eq!((code, answer["witnesses"]["nonmanifold_edges"].as_array().map(Vec::len)), (1, Some(1)));
    // Unwelded, every face is open.
    fs::write(
        dir.join("soup.obj"),
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 6 5 4\n",
    )
    .expect("written");
    let edges = |weld: &str| {
        let answer = json(&dir, &["is-closed", "soup.obj", "--weld", weld]).1;
        answer["witnesses"]["boundary_edges"].as_array().map(Vec::len)
    };
    assert_eq!((edges("none"), edges("exact"), edges("0.5")), (Some(6), Some(4), Some(4)));
}

#[test]
fn naked_edges_are_loops_in_the_files_numbering() {
    let dir = directory("naked");
    fs::write(dir.join("a.obj"), format!("v 9 9 9\nv 9 9 9\n{}", OPEN.replace("f 1 2 3", "f 3 4 5")))
        .expect("written");
    let (code, naked) = json(&dir, &["naked-edges", "a.obj"]);
    assert_eq!(
        (code, &naked["loops"], &naked["chains"]),
        (0, &serde_json::json!([[3, 2, 4]]), &serde_json::json!([]))
    );
    fs::write(
        dir.join("fins.obj"),
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 -1 0\nf 1 2 3\nf 1 2 4\nf 2 1 5\n",
    )
    .expect("written");
    let (code, naked) = json(&dir, &["naked-edges", "fins.obj"]);
    assert_eq!((code, naked["chains"].as_array().map(Vec::len)), (0, Some(3)));
}

#[test]
fn volume_of_an_open_mesh_is_refused() {
    let dir = directory("volume");
    fs::write(dir.join("open.obj"), OPEN).expect("written");
    let (code, answer) = json(&dir, &["volume", "open.obj"]);
    assert_eq!(
        (code, &answer["error"]["kind"], &answer["boundary_edges"]),
        (1, &"refused".into(), &3.into())
    );
}

#[test]
fn unify_flips_and_tells_or_shows_the_cycle() {
    let dir = directory("unify");
    fs::write(dir.join("a.obj"), cubes(&[[0, 0, 0]]).replace("f 1 2 3 4", "f 4 3 2 1")).expect("written");
    let (code, answer) = json(&dir, &["unify", "a.obj", "-o", "b.obj"]);
    assert_eq!((code, &answer["flipped"]), (0, &serde_json::json!([0])));
    assert_eq!(json(&dir, &["inspect", "b.obj"]).1["volume"], 1.0);
    fs::write(dir.join("m.obj"), MOEBIUS).expect("written");
    let (code, answer) = json(&dir, &["unify", "m.obj", "-o", "never.obj"]);
    assert_eq!((code, answer["cycles"][0].as_array().map(Vec::len)), (1, Some(3)));
    assert!(!dir.join("never.obj").exists());
}

#[test]
fn unify_outward_turns_solids_out_and_keeps_cavities() {
    let dir = directory("outward");
    // A cube of side 3 with one of side 1 in it, both inside out but for one face.
    let shell = |at: f64, size: f64| {
        let corner = |i: u32| [i & 1, i >> 1 & 1, i >> 2].map(|bit| at + f64::from(bit) * size);
        let line = |[x, y, z]: [f64; 3]| format!("v {x} {y} {z}\n");
        (0..8).map(|i| line(corner(i))).collect::<String>()
    };
    let inward = [[1, 2, 4, 3], [5, 7, 8, 6], [1, 5, 6, 2], [3, 4, 8, 7], [1, 3, 7, 5], [2, 6, 8, 4]];
    let mut text = shell(0.0, 3.0) + &shell(1.0, 1.0);
    for (offset, mut faces) in [(0, inward), (8, inward)] {
        faces[5].reverse();
        for [a, b, c, d] in faces.map(|f| f.map(|v| v + offset)) {
            text += &format!("f {a} {b} {c} {d}\n");
        }
    }
    fs::write(dir.join("a.obj"), text).expect("written");
    let (code, answer) = json(&dir, &["unify", "a.obj", "--outward", "-o", "b.obj"]);
    assert_eq!(code, 0);
    let parts = answer["parts"].as_array().expect("parts");
    assert_eq!(parts.iter().map(|p| &p["depth"]).collect::<Vec<_>>(), [0, 1]);
    assert_eq!(json(&dir, &["inspect", "b.obj"]).1["volume"], 26.0);
    let flipped = answer["flipped"].as_array().expect("faces").len();
    let (_, again) = json(&dir, &["unify", "b.obj", "--outward", "-o", "c.obj"]);
    assert_eq!((&again["flipped"], flipped > 0), (&serde_json::json!([]), true));
    assert_eq!(fs::read(dir.join("b.obj")).expect("a file"), fs::read(dir.join("c.obj")).expect("a file"));
    let text =
        String::from_utf8(run(&dir, &["unify", "b.obj", "--outward", "-o", "c.obj"]).stdout).expect("text");
    assert!(text.contains("solid, left as it is") && text.contains("cavity, left as it is"), "{text}");
}

#[test]
fn flip_reverses_and_convert_keeps() {
    let dir = directory("convert");
    fs::write(dir.join("a.obj"), cubes(&[[0, 0, 0]])).expect("written");
    assert_eq!(json(&dir, &["flip", "a.obj", "-o", "b.ply"]).0, 0);
    assert_eq!(json(&dir, &["inspect", "b.ply"]).1["volume"], -1.0);
    for (name, ascii) in [("c.stl", false), ("c.stl", true), ("c.ply", true), ("c.off", false)] {
        let args = ["convert", "a.obj", "-o", name];
        let (code, answer) =
            json(&dir, &if ascii { [&args[..], &["--ascii"]].concat() } else { args.to_vec() });
        assert_eq!(
            (code, &answer["faces"], &answer["import"]["counts"]),
            (0, &6.into(), &serde_json::json!({}))
        );
        assert_eq!(json(&dir, &["inspect", name]).1["volume"], 1.0, "{name}");
        assert_eq!(fs::read(dir.join(name)).expect("a file").starts_with(b"solid"), name == "c.stl" && ascii);
    }
}

#[test]
fn textures_normals_and_groups_go_along_and_what_does_not_is_told() {
    let dir = directory("attributes");
    // Two triangles with vertices of their own, wound apart, with a seam between them, a group, and a normal that is none.
    let text = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 0.1 0\nvt 0 0.1\nvt 0.5 0.5\n\
        vt 0.6 0.5\nvt 0.6 0.7\nvn 0 0 1\nvn nan 0 1\ng left\nusemtl red\nf 1/1/1 2/2/1 3/3/1\ng right\nf 4/4/1 5/5/2 6/6/1\n";
    fs::write(dir.join("a.obj"), text).expect("written");
    let nothing = serde_json::json!([]);
    let lost = serde_json::json!([{
        "attribute": "corner_normals", "reason": "non_finite", "count": 1, "first": { "corner": [1, 1] }
    }]);
    let (code, answer) = json(&dir, &["clean", "a.obj", "-o", "b.obj"]);
    assert_eq!((code, &answer["not_carried"], &answer["lost_values"]), (0, &nothing, &lost));
    assert_eq!((&answer["lost"], &answer["counts"]["flipped_face"]), (&nothing, &1.into()));
    let expected = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 0.1 0\nvt 0 0.1\nvt 0.5 0.5\nvt 0.6 0.7\n\
        vt 0.6 0.5\nvn 0 0 1\ng left\nusemtl red\nf 1/1/1 2/2/1 3/3/1\ng right\nf 2/4/1 4/5/1 3/6\n";
    let written = |name: &str| fs::read_to_string(dir.join(name)).expect("text");
    assert_eq!(written("b.obj"), expected);
    let (code, answer) = json(&dir, &["convert", "b.obj", "-o", "c.obj", "--strict"]);
    assert_eq!((code, &answer["import"]["lost_values"], &answer["lost"]), (0, &nothing, &nothing));
    assert_eq!(written("c.obj"), expected);
    let (_, answer) = json(&dir, &["convert", "b.obj", "-o", "d.stl"]);
    for kind in ["normals", "texture_coordinates", "groups", "material_files"] {
        assert!(answer["lost"].as_array().expect("a list").contains(&kind.into()), "{answer}");
    }
    assert_eq!(json(&dir, &["flip", "b.obj", "-o", "e.obj"]).0, 0);
    assert!(written("e.obj").contains("vn -0 -0 -1\n") && written("e.obj").contains("f 1/1/1 3/2/1 2/3/1\n"));
}
