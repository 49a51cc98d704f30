//! Transforms, weld, subdivision and smoothing from outside.

mod harness;

use harness::json;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// A directory of this test's own, with a cube, a sheet and a soup in it.
fn directory(test: &str) -> PathBuf {
    let path = harness::directory(&format!("bulk-{test}"));
    fs::write(path.join("cube.obj"), CUBE).expect("written");
    fs::write(path.join("sheet.obj"), SHEET).expect("written");
    fs::write(path.join("soup.obj"), SOUP).expect("written");
    path
}

const CUBE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n\
    f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
const SHEET: &str = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 1\nv 2 1 0\nv 0 2 0\nv 1 2 0\nv 2 2 0\n\
    f 1 2 5 4\nf 2 3 6 5\nf 4 5 8 7\nf 5 6 9 8\n";
const SOUP: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1.001 0 0\nv 1 1 0\nv 0 1.001 0\nf 1 2 3\nf 4 5 6\n";

fn inspect(directory: &Path, file: &str) -> Value {
    json(directory, &["inspect", file]).1
}

fn close(value: &Value, expected: f64) -> bool {
    (value.as_f64().expect("a number") - expected).abs() < 1e-9
}

#[test]
fn weld_merges_and_tells() {
    let dir = directory("weld");
    let (code, answer) = json(&dir, &["weld", "--tolerance", "0.01", "soup.obj", "-o", "b.off"]);
    assert_eq!((code, &answer["vertices"], &answer["faces"]), (0, &4.into(), &2.into()));
    assert_eq!(answer["counts"]["merged_vertex"], 2);
    assert_eq!(answer["defects"].as_array().map(Vec::len), Some(2));
    assert_eq!(inspect(&dir, "b.off")["boundary_edges"], 4);
    let (_, answer) = json(&dir, &["weld", "--tolerance", "0", "soup.obj", "-o", "c.off"]);
    assert_eq!(answer["vertices"], 6);
    let (code, answer) = json(&dir, &["weld", "--tolerance", "-1", "soup.obj", "-o", "never.off"]);
    assert_eq!((code, &answer["error"]["kind"]), (1, &"refused".into()));
    assert!(!dir.join("never.off").exists());
}

#[test]
fn unweld_parts_and_weld_gives_back() {
    let dir = directory("unweld");
    let (code, answer) = json(&dir, &["unweld", "--angle", "30", "cube.obj", "-o", "b.obj"]);
    assert_eq!((code, &answer["vertices"], &answer["counts"]["sharp_edge"]), (0, &24.into(), &12.into()));
    let (_, facts) = json(&dir, &["inspect", "b.obj", "--weld", "none"]);
    assert_eq!((&facts["components"], &facts["boundary_edges"]), (&6.into(), &24.into()));
    assert_eq!(inspect(&dir, "b.obj")["volume"], 1.0);
    assert_eq!(json(&dir, &["unweld", "--angle", "-3", "cube.obj", "-o", "never.obj"]).0, 1);
    assert!(!dir.join("never.obj").exists());
}

#[test]
fn smooth_takes_its_methods_and_boundaries() {
    let dir = directory("smooth");
    let base = ["smooth", "--iterations", "10", "--lambda", "0.5", "-o", "b.ply"];
    let run = |more: &[&str]| harness::code(&dir, &[&base[..], more].concat());
    for more in [
        &["cube.obj"][..],
        &["cube.obj", "--method", "laplacian"],
        &["cube.obj", "--method", "taubin"],
        &["cube.obj", "--method", "taubin", "--mu", "-0.53"],
        &["cube.obj", "--mu", "-0.53"],
        &["cube.obj", "--method", "cotan"],
        &["cube.obj", "--method", "implicit"],
        &["sheet.obj", "--boundary", "fixed"],
        &["sheet.obj", "--boundary", "slide"],
        &["sheet.obj", "--boundary", "free"],
    ] {
        assert_eq!(run(more), 0, "{more:?}");
    }
    assert_eq!(run(&["cube.obj", "--mu", "-0.3"]), 1, "mu must be below -lambda");
    assert_eq!(run(&["cube.obj", "--mu", "-0.53", "--method", "cotan"]), 2);
    assert_eq!(run(&["cube.obj", "--method", "magic"]), 2);
    for lambda in ["0", "1.5", "-0.5", "nan"] {
        let args = ["smooth", "--iterations", "1", "--lambda", lambda, "cube.obj", "-o", "never.ply"];
        assert_eq!(json(&dir, &args).0, 1, "{lambda}");
    }
    assert!(!dir.join("never.ply").exists());
    let (_, answer) =
        json(&dir, &["smooth", "--iterations", "1", "--lambda", "1", "cube.obj", "-o", "c.ply"]);
    assert_eq!(answer["vertices"], 8);
    assert!(close(&inspect(&dir, "c.ply")["volume"], 1.0 / 27.0));
}

#[test]
fn subdivide_knows_four_schemes() {
    let dir = directory("subdivide");
    for (scheme, faces) in [("midpoint", 96), ("loop", 192), ("catmull-clark", 96), ("sqrt3", 108)] {
        let args = ["subdivide", "--scheme", scheme, "--levels", "2", "cube.obj", "-o", "b.obj"];
        let (code, answer) = json(&dir, &args);
        assert_eq!((code, &answer["faces"]), (0, &faces.into()), "{scheme}");
        let facts = inspect(&dir, "b.obj");
        assert_eq!((&facts["closed"], &facts["genus"]), (&true.into(), &0.into()), "{scheme}");
        assert!(facts["volume"].as_f64().expect("closed") > 0.2);
    }
    let args = ["subdivide", "--scheme", "loop", "--levels", "99", "cube.obj", "-o", "never.obj"];
    let (code, answer) = json(&dir, &args);
    assert_eq!((code, &answer["error"]["kind"]), (1, &"refused".into()));
    assert!(!dir.join("never.obj").exists());
    let args = ["subdivide", "--scheme", "butterfly", "--levels", "1", "cube.obj", "-o", "b.obj"];
    assert_eq!(harness::code(&dir, &args), 2);
}

#[test]
fn transform_scales_rotates_and_translates_in_this_order() {
    let dir = directory("transform");
    let run = |more: &[&str]| {
        let (code, answer) = json(&dir, &[&["transform", "cube.obj", "-o", "b.obj"], more].concat());
        assert_eq!(code, 0, "{more:?}: {answer}");
        inspect(&dir, "b.obj")
    };
    let facts = run(&["--scale", "2", "--rotate", "0,0,1,90", "--translate", "-1,0,3.5"]);
    assert_eq!(facts["bbox"], serde_json::json!({ "min": [-3.0, 0.0, 3.5], "max": [-1.0, 2.0, 5.5] }));
    let facts = run(&["--scale", "-1,2,3"]);
    assert_eq!(facts["volume"], 6.0, "mirrored, and still outside out");
    let facts = run(&["--scale", "-2", "--origin", "center"]);
    assert_eq!(facts["bbox"], serde_json::json!({ "min": [-0.5, -0.5, -0.5], "max": [1.5, 1.5, 1.5] }));
    assert_eq!(facts["volume"], 8.0);
    let facts = run(&["--rotate", "-1,0,0,90", "--origin", "-1,0,0"]);
    assert_eq!(facts["bbox"]["min"], serde_json::json!([0.0, 0.0, -1.0]));
    for more in
        [&["--scale", "0"][..], &["--rotate", "0,0,0,90"], &["--translate", "nan,0,0"], &["--scale", "1,0,1"]]
    {
        let args = [&["transform", "cube.obj", "-o", "never.obj"], more].concat();
        let (code, answer) = json(&dir, &args);
        assert_eq!((code, &answer["error"]["kind"]), (1, &"refused".into()), "{more:?}");
    }
    for more in
        [&["--scale", "a"][..], &["--rotate", "0,0,1"], &["--translate", "1,2"], &["--origin", "middle"]]
    {
        let args = [&["transform", "cube.obj", "-o", "never.obj"], more].concat();
        assert_eq!(harness::code(&dir, &args), 2, "{more:?}");
    }
    assert!(!dir.join("never.obj").exists());
}

#[test]
fn deform_makes_the_wave() {
    let dir = directory("deform");
    let (code, _) = json(&dir, &["deform", "--wave", "-0.25", "sheet.obj", "-o", "b.obj"]);
    assert_eq!(code, 0);
    let text = fs::read_to_string(dir.join("b.obj")).expect("written");
    let z: f64 =
        text.lines().nth(1).and_then(|l| l.split(' ').nth(3)).and_then(|z| z.parse().ok()).expect("a vertex");
    assert_eq!(z, -0.25 * 5f64.sin());
    assert_eq!(json(&dir, &["deform", "--wave", "inf", "sheet.obj", "-o", "never.obj"]).0, 1);
    assert!(!dir.join("never.obj").exists());
}

#[test]
fn strict_import_and_wrong_usage_are_as_everywhere() {
    let dir = directory("usage");
    fs::write(dir.join("bad.obj"), format!("{CUBE}f 1 2 99\n")).expect("written");
    let args = ["weld", "--tolerance", "0", "bad.obj", "-o", "b.obj"];
    let (code, answer) = json(&dir, &args);
    assert_eq!((code, &answer["import"]["counts"]["out_of_range_face"]), (0, &1.into()));
    assert_eq!(json(&dir, &[&args[..], &["--strict"]].concat()).0, 1);
    for args in [
        &["weld", "cube.obj", "-o", "b.obj"][..],
        &["unweld", "cube.obj", "-o", "b.obj"],
        &["smooth", "cube.obj", "-o", "b.obj"],
        &["subdivide", "cube.obj", "-o", "b.obj"],
        &["deform", "cube.obj", "-o", "b.obj"],
        &["transform", "cube.obj"],
        &["transform", "cube.obj", "-o", "b.xyz"],
    ] {
        assert_eq!(harness::code(&dir, args), 2, "{args:?}");
    }
}
