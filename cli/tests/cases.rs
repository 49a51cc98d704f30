//! The cases in which known tools were measured and found wrong, each through the program.

mod harness;

use harness::{directory, json};
use serde_json::{Value, json};
use std::fs;

/// A mesh as text, made of boxes.
#[derive(Default)]
struct Shape {
    points: Vec<[f64; 3]>,
    triangles: Vec<[usize; 3]>,
}

impl Shape {
    /// Adds twelve triangles around a box, inside out if so wished. Equal places share a vertex if that is wished.
    fn and(mut self, at: [f64; 3], size: f64, inverted: bool, shared: bool) -> Self {
        let mut corners = Vec::new();
        for i in 0..8 {
            let p: [f64; 3] = std::array::from_fn(|k| at[k] + f64::from(i >> k & 1) * size);
            let known = self.points.iter().position(|q| shared && *q == p);
            corners.push(known.unwrap_or(self.points.len()));
            if known.is_none() {
                self.points.push(p);
            }
        }
        for [a, b, c, d] in
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
        {
            for t in [[a, b, c], [a, c, d]] {
                let mut t = t.map(|v: usize| corners[v]);
                if inverted {
                    t.swap(1, 2);
                }
                self.triangles.push(t);
            }
        }
        self
    }

    fn text(&self) -> String {
        let points = self.points.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n"));
        let triangles = self.triangles.iter().map(|[a, b, c]| format!("f {} {} {}\n", a + 1, b + 1, c + 1));
        points.chain(triangles).collect()
    }
}

fn cube() -> Shape {
    Shape::default().and([0.0; 3], 1.0, false, false)
}

/// What is expected of a case.
struct Case {
    name: &'static str,
    shape: Shape,
    closed: bool,
    /// Of the mesh as it is imported; none if it is open.
    volume: Option<f64>,
    /// How long the loops of naked edges are.
    loops: Vec<usize>,
    /// After `unify --outward`, as `inspect` sees it; none where there is none.
    outward: Option<f64>,
    /// Vertices and faces after an exact weld.
    welded: [usize; 2],
}

fn cases() -> Vec<Case> {
    let mut mixed = cube();
    [1, 4, 6, 11].into_iter().for_each(|t: usize| mixed.triangles[t].swap(1, 2));
    let mut open = cube();
    open.triangles.drain(..2);
    let mut twice = cube();
    twice.triangles.push(twice.triangles[3]);
    let mut soup = Shape::default();
    for t in cube().triangles {
        let n = soup.points.len();
        soup.points.extend(t.map(|v| cube().points[v]));
        soup.triangles.push([n, n + 1, n + 2]);
    }
    let strip = Shape {
        points: vec![[0., 0., 0.], [0., 0., 1.], [1., 0., 0.], [1., 0., 1.], [0., 1., 0.], [0., 1., 1.]],
        triangles: vec![[0, 2, 3], [0, 3, 1], [2, 4, 5], [2, 5, 3], [4, 1, 0], [4, 0, 5]],
    };
    let case = |name, shape, closed, volume, outward, welded| Case {
        name,
        shape,
        closed,
        volume,
        loops: Vec::new(),
        outward,
        welded,
    };
    let one = Some(1.0);
    let far = [5.0, 0.0, 0.0];
    vec![
        case("cube", cube(), true, one, one, [8, 12]),
        case("mixed", mixed, true, one, one, [8, 12]),
        case("inverted", Shape::default().and([0.0; 3], 1.0, true, false), true, Some(-1.0), one, [8, 12]),
        Case { loops: vec![4], ..case("open", open, false, None, None, [8, 10]) },
        case(
            "cavity",
            Shape::default().and([0.0; 3], 3.0, false, false).and([1.0; 3], 1.0, true, false),
            true,
            Some(26.0),
            Some(26.0),
            [16, 24],
        ),
        case("one inverted", cube().and(far, 1.0, true, false), true, Some(0.0), Some(2.0), [16, 24]),
        case("edge", cube().and([1., 1., 0.], 1.0, false, true), false, Some(2.0), None, [16, 24]),
        case("vertex", cube().and([1.0; 3], 1.0, false, true), true, Some(2.0), Some(2.0), [16, 24]),
        case("twice", twice, false, one, None, [8, 12]),
        case("soup", soup, true, one, one, [8, 12]),
        Case { loops: vec![6], ..case("moebius", strip, false, None, None, [8, 6]) },
    ]
}

#[test]
fn every_measured_case_is_answered_rightly_by_the_program() {
    let dir = directory("cases");
    for case in cases() {
        let name = case.name;
        fs::write(dir.join("a.obj"), case.shape.text()).expect("written");
        let (code, answer) = json(&dir, &["is-closed", "a.obj"]);
        assert_eq!((code, &answer["closed"]), (i32::from(!case.closed), &case.closed.into()), "{name}");
        let witnesses =
            ["boundary_edges", "nonmanifold_edges"].map(|w| answer["witnesses"][w].as_array().map(Vec::len));
        assert_eq!(witnesses == [Some(0), Some(0)], case.closed, "{name}: {witnesses:?}");

        let (code, answer) = json(&dir, &["volume", "a.obj"]);
        assert_eq!(
            (code, answer["volume"].as_f64()),
            (i32::from(case.volume.is_none()), case.volume),
            "{name}"
        );
        let told = &answer["import"]["counts"];
        let flips = if name == "mixed" { json!(4) } else { Value::Null };
        assert!(
            told["flipped_face"] == flips || name == "moebius",
            "{name}: what the import changed is told"
        );
        assert_eq!(told["cut_edge"].is_null(), name != "moebius", "{name}: {told}");

        let (code, answer) = json(&dir, &["naked-edges", "a.obj"]);
        let loops = answer["loops"].as_array().expect("loops");
        let lengths: Vec<_> = loops.iter().map(|l| l.as_array().map_or(0, Vec::len)).collect();
        assert_eq!((code, lengths, &answer["chains"]), (0, case.loops, &json!([])), "{name}");

        let (code, answer) = json(&dir, &["unify", "a.obj", "--outward", "-o", "b.obj"]);
        if name == "moebius" {
            assert_eq!((code, answer["cycles"][0].as_array().map(Vec::len)), (1, Some(6)), "{name}");
            assert!(!dir.join("b.obj").exists());
        } else {
            assert_eq!(code, 0, "{name}: {answer}");
            assert!(answer["parts"].as_array().is_some_and(|p| !p.is_empty()), "{name}");
            let volume = json(&dir, &["inspect", "b.obj"]).1["volume"].as_f64();
            assert_eq!(volume, case.outward, "{name}");
        }

        let (code, answer) = json(&dir, &["weld", "--tolerance", "0", "a.obj", "-o", "c.obj"]);
        let [vertices, faces] = case.welded;
        assert_eq!(
            (code, &answer["vertices"], &answer["faces"]),
            (0, &vertices.into(), &faces.into()),
            "{name}"
        );
        let _ = fs::remove_file(dir.join("b.obj"));
    }
}

#[test]
fn thirty_six_corners_are_open_until_they_are_welded() {
    let dir = directory("cases_soup");
    let soup = cases().into_iter().find(|c| c.name == "soup").expect("there");
    fs::write(dir.join("a.obj"), soup.shape.text()).expect("written");
    let (code, answer) = json(&dir, &["naked-edges", "a.obj", "--weld", "none"]);
    assert_eq!((code, answer["loops"].as_array().map(Vec::len)), (0, Some(12)));
    assert_eq!(json(&dir, &["is-closed", "a.obj", "--weld", "none"]).0, 1);
}

#[test]
fn volume_at_an_offset_of_a_million_is_one() {
    let dir = directory("cases_far");
    fs::write(dir.join("a.obj"), Shape::default().and([1e6; 3], 1.0, false, false).text()).expect("written");
    assert_eq!(json(&dir, &["volume", "a.obj"]).1["volume"], 1.0);
    fs::write(dir.join("b.obj"), cube().text()).expect("written");
    let args = ["transform", "--translate", "1000000,-1000000,1000000", "b.obj", "-o", "c.ply"];
    assert_eq!(json(&dir, &args).0, 0);
    assert_eq!(json(&dir, &["volume", "c.ply"]).1["volume"], 1.0);
}

#[test]
fn rays_along_the_diagonals_of_a_cube_cross_twice() {
    let dir = directory("cases_rays");
    fs::write(dir.join("a.obj"), cube().text()).expect("written");
    let rays = "-1,-1,-1,1,1,1\n2,-1,-1,-1,1,1\n0.5,0.5,-1,0,0,1\n-1,-1,0.5,1,1,0\n-1,2,0.25,1,-1,0\n";
    fs::write(dir.join("rays.txt"), rays).expect("written");
    let (code, answer) = json(&dir, &["raycast", "a.obj", "--queries", "rays.txt"]);
    assert_eq!(code, 0);
    for hits in answer["results"].as_array().expect("results") {
        let entering: Vec<_> =
            hits["hits"].as_array().expect("hits").iter().map(|h| &h["entering"]).collect();
        assert_eq!(entering, [&json!(true), &json!(false)], "{hits}");
    }
}

#[test]
fn reduce_to_one_face_keeps_a_tetrahedron_and_says_why() {
    let dir = directory("cases_reduce");
    for case in cases().into_iter().filter(|c| ["cube", "cavity", "one inverted"].contains(&c.name)) {
        fs::write(dir.join("a.obj"), case.shape.text()).expect("written");
        let (code, answer) = json(&dir, &["reduce", "--faces", "1", "a.obj", "-o", "b.obj"]);
        assert_eq!((code, &answer["stopped"]), (0, &json!("no-legal-collapse")), "{}", case.name);
        let (before, after) = (json(&dir, &["inspect", "a.obj"]).1, json(&dir, &["inspect", "b.obj"]).1);
        for kept in ["components", "closed", "manifold", "euler_characteristic"] {
            assert_eq!(before[kept], after[kept], "{}: {kept}", case.name);
        }
    }
}
