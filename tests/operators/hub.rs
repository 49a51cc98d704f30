//! Edits around a vertex of a thousand edges, which take ways of their own, beside the same around a vertex of few.

use super::*;
use meshwright::glam::dvec3;

/// Triangles around one vertex; the last are missing if the fan is to be open.
fn fan(n: u32, is_whole: bool) -> Mesh {
    let turn = |i: u32| f64::from(i) / f64::from(n) * std::f64::consts::TAU;
    let points = [DVec3::ZERO].into_iter().chain((0..n).map(|i| dvec3(turn(i).cos(), turn(i).sin(), 0.0)));
    let count = if is_whole { n } else { n - 2 };
    let triangles: Vec<[u32; 3]> = (0..count).map(|i| [0, 1 + i, 1 + (i + 1) % n]).collect();
    Mesh::build(&IndexedMesh::from_triangles(points.collect(), &triangles).unwrap()).unwrap()
}

/// Does the same at the spokes and rim edges of the first triangles, of a fan of few and of many; says what was done.
fn done(n: u32, is_whole: bool, kind: usize) -> Vec<String> {
    let mut mesh = fan(n, is_whole);
    let numbering = mesh.numbering();
    let vertices = numbering.vertices.clone();
    let number = |v| vertices.iter().position(|&w| w == v);
    let mut said = Vec::new();
    for i in 1..7 {
        let spoke = mesh.find_halfedge(vertices[0], vertices[i]);
        let rim = mesh.find_halfedge(vertices[i], vertices[i + 1]);
        let (before, checked) = (mesh.face_count(), mesh.vertex_count());
        let result = match kind {
            0 => spoke.map(|h| {
                let into_hub = mesh.twin(h);
                mesh.collapse_into_target(into_hub)
                    .map(|c| number(c.vertex))
                    .map_err(|e| name_of(&format!("{e:?}")))
            }),
            1 => rim.map(|h| {
                mesh.collapse_into_target(h).map(|c| number(c.vertex)).map_err(|e| name_of(&format!("{e:?}")))
            }),
            2 => spoke.and_then(|h| mesh.face(h)).map(|f| {
                mesh.remove_face(f).map(|r| Some(r.edges.len())).map_err(|e| name_of(&format!("{e:?}")))
            }),
            _ => spoke.map(|h| {
                let e = mesh.edge(h);
                mesh.flip_edge(e).map(|()| None).map_err(|e| name_of(&format!("{e:?}")))
            }),
        };
        mesh.validate().unwrap();
        said.push(format!("{result:?} {} {}", before - mesh.face_count(), checked - mesh.vertex_count()));
    }
    said
}

/// The reason without the keys.
fn name_of(error: &str) -> String {
    error.split('(').next().unwrap_or_default().to_owned()
}

#[test]
fn edits_around_a_hub_do_what_they_do_around_a_vertex_of_few_edges() {
    for is_whole in [true, false] {
        for kind in 0..4 {
            assert_eq!(done(20, is_whole, kind), done(1000, is_whole, kind), "{is_whole} {kind}");
        }
    }
}

#[test]
fn what_a_collapse_into_a_hub_would_break_is_named() {
    // A bipyramid whose two hubs share all the rim: its only legal collapses are along the rim.
    let n = 100;
    let ring = (0..n).map(|i| {
        let (s, c) = (f64::from(i) / f64::from(n) * std::f64::consts::TAU).sin_cos();
        dvec3(c, s, 0.0)
    });
    let at = |i: u32| 2 + i % n;
    let points = [DVec3::Z, DVec3::NEG_Z].into_iter().chain(ring).collect();
    let faces: Vec<[u32; 3]> = (0..n).flat_map(|i| [[0, at(i), at(i + 1)], [1, at(i + 1), at(i)]]).collect();
    let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &faces).unwrap()).unwrap();
    let v = mesh.numbering().vertices;
    // Joins the hubs: the vertex goes into one of them, and the other hub stays its neighbour.
    let h = mesh.find_halfedge(v[50], v[0]).unwrap();
    mesh.collapse_into_target(h).unwrap();
    let between = mesh.find_halfedge(v[0], v[1]).unwrap();
    let refused = mesh.collapse_into_target(between);
    assert!(matches!(refused, Err(CollapseError::CommonNeighbor(_))), "{refused:?}");
    // And one more would join them twice.
    let h = mesh.find_halfedge(v[20], v[0]).unwrap();
    assert_eq!(mesh.collapse_into_target(h), Err(CollapseError::CommonNeighbor(v[1])));
    let h = mesh.find_halfedge(v[0], v[20]).unwrap();
    assert_eq!(mesh.collapse_into_target(h), Err(CollapseError::CommonNeighbor(v[1])));
    mesh.validate().unwrap();
}
