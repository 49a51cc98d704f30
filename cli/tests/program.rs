//! The program from outside: what it prints, what it writes, and how it ends.

mod harness;

use harness::{code, directory, json, run};
use serde_json::Value;
use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// OBJ text of unit cubes at the given corners, sharing vertices at equal places.
fn cubes(corners: &[[i32; 3]]) -> String {
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

const OPEN: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 5 5\nf 1 2 3\n";
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
    assert!(text.contains("2 vertices where surfaces touch, split: vertex"), "{text}");
    assert!(text.contains("--weld none"), "{text}");
    // Both looks are whole ones.
    let looked = json(&dir, &["inspect", "a.obj"]).1;
    let keys = |v: &Value| -> Vec<String> { v.as_object().expect("an object").keys().cloned().collect() };
    let extra = ["notes", "peak_rss_bytes", "timings_ms"];
    let expected: Vec<String> = keys(&looked).into_iter().filter(|k| !extra.contains(&k.as_str())).collect();
    assert_eq!((keys(&account["before"]), keys(&account["after"])), (expected.clone(), expected));
}

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

/// Paths of the corpus's files in our formats, each with what the manifest says of reading it; `None`, and a word about
/// it, if there is no corpus.
fn corpus() -> Option<Vec<(String, String)>> {
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
