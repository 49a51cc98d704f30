//! Shortest paths.

use crate::shapes::{self, cube, mesh};
use crate::{all, cylinder, length, naive_distances, quads, vertex_pairs};
use meshwright::glam::{DVec3, dvec3};
use meshwright::{HalfedgeKey, IndexedMesh, Mesh, PathError, VertexKey};

pub(crate) fn check_path(mesh: &Mesh, a: VertexKey, b: VertexKey, cost: impl Fn(HalfedgeKey) -> f64) {
    let far = naive_distances(&vertex_pairs(mesh, &cost), a);
    let path = mesh.shortest_path_by(a, b, &cost).expect("costs are fine");
    assert_eq!(path.is_some(), far.contains_key(&b));
    let Some(path) = path else { return };
    let sum = path.halfedges.iter().fold(0.0, |sum, &h| sum + cost(h));
    assert_eq!(path.length, sum, "the length is what the half-edges cost");
    assert!((path.length - far[&b]).abs() <= 1e-12 * sum, "{} {}", path.length, far[&b]);
    let mut at = a;
    for &h in &path.halfedges {
        assert_eq!(mesh.origin(h), at);
        at = mesh.target(h);
    }
    assert_eq!(at, b);
}

#[test]
fn shortest_paths_equal_distances_found_slowly() {
    for mesh in all() {
        let ends: Vec<_> = mesh.vertices().step_by(3).collect();
        for &a in &ends {
            for &b in &ends {
                check_path(&mesh, a, b, |h| length(&mesh, h));
                let path = mesh.shortest_path(a, b).expect("lengths are fine");
                assert_eq!(path, mesh.shortest_path_by(a, b, |h| length(&mesh, h)).expect("so are these"));
            }
        }
    }
}

#[test]
fn of_equally_long_paths_the_one_with_the_fewest_edges_is_taken() {
    let mesh = mesh(&quads(4, 4));
    let v: Vec<_> = mesh.vertices().collect();
    let free = mesh.shortest_path_by(v[0], v[24], |_| 0.0).expect("costs are fine").expect("connected");
    assert_eq!((free.halfedges.len(), free.length), (8, 0.0));
}

#[test]
fn the_shortest_path_to_itself_is_empty_and_to_another_component_is_none() {
    let mesh = mesh(&shapes::both(&cube(), &quads(2, 2)));
    let v: Vec<_> = mesh.vertices().collect();
    let path = mesh.shortest_path(v[3], v[3]).expect("live").expect("here");
    assert!(path.halfedges.is_empty() && path.length == 0.0);
    assert_eq!(mesh.shortest_path(v[3], v[12]), Ok(None));
}

#[test]
fn costs_that_make_no_sense_are_refused_with_their_half_edge() {
    let mesh = mesh(&cube());
    let v: Vec<_> = mesh.vertices().collect();
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        let refusal = mesh.shortest_path_by(v[0], v[7], |_| bad).expect_err("a bad cost");
        assert!(matches!(refusal, PathError::BadCost { halfedge, cost }
            if mesh.origin(halfedge) == v[0] && cost.to_bits() == bad.to_bits()));
    }
    let dead = VertexKey::default();
    assert_eq!(mesh.shortest_path(dead, v[0]), Err(PathError::Missing(dead)));
    assert_eq!(mesh.shortest_path(v[0], dead), Err(PathError::Missing(dead)));
}

#[test]
fn lengths_at_the_ends_of_f64_are_exact_or_refused() {
    for (scale, fine) in [(1e-200, true), (1e200, true), (1e-310, true), (1.7e308, false)] {
        let points = quads(2, 1).positions().iter().map(|&p| (p - DVec3::X) * scale).collect();
        let mesh = mesh(&IndexedMesh::new(points, quads(2, 1).polygons().clone()).expect("finite"));
        let v: Vec<_> = mesh.vertices().collect();
        let path = mesh.shortest_path(v[0], v[2]);
        if fine {
            assert_eq!(path.expect("finite").expect("connected").length, 2.0 * scale);
        } else {
            assert_eq!(path.expect("finite edges").expect("connected").length, f64::INFINITY);
            let cost = |h| length(&mesh, h) * f64::MAX;
            assert!(mesh.shortest_path_by(v[0], v[2], cost).is_err());
        }
    }
    let long = [dvec3(-1.7e308, 0.0, 0.0), dvec3(1.7e308, 0.0, 0.0), DVec3::Y];
    let mesh = mesh(&IndexedMesh::from_triangles(long.to_vec(), &[[0, 1, 2]]).expect("finite"));
    let v: Vec<_> = mesh.vertices().collect();
    assert!(matches!(mesh.shortest_path(v[0], v[2]), Err(PathError::BadCost { .. })));
}

#[test]
fn a_path_of_free_and_of_dear_half_edges_may_differ_by_direction() {
    let mesh = mesh(&cylinder(6));
    let v: Vec<_> = mesh.vertices().collect();
    // Only up costs.
    let up = |h| if mesh.position(mesh.target(h)).z > mesh.position(mesh.origin(h)).z { 5.0 } else { 0.0 };
    assert_eq!(mesh.shortest_path_by(v[0], v[9], up).expect("fine").expect("connected").length, 5.0);
    assert_eq!(mesh.shortest_path_by(v[9], v[0], up).expect("fine").expect("connected").length, 0.0);
}
