//! A function that is linear in the position stays so.

use crate::shapes::{Noise, fanned, icosphere, mesh, pool};
use crate::two_squares;
use meshwright::glam::{DVec3, dvec3};
use meshwright::{IndexedMesh, Rule};

/// A linear function of position.
fn linear(p: DVec3) -> f64 {
    p.dot(dvec3(3., -2., 0.5)) + 7.0
}

/// Splits, pokes, flips and cuts faces of a plane mesh at random, with a linear function on vertices and corners.
fn stays_linear(of: &IndexedMesh, seed: u64) {
    let mut mesh = mesh(of);
    let on_vertices = mesh.add_vertex_column(0.0, Rule::interpolate());
    let on_corners = mesh.add_corner_column(0.0, Rule::interpolate());
    for v in mesh.vertices().collect::<Vec<_>>() {
        mesh.set_value(on_vertices, v, linear(mesh.position(v))).expect("live");
    }
    for h in mesh.halfedges().filter(|&h| !mesh.is_boundary(h)).collect::<Vec<_>>() {
        mesh.set_value(on_corners, h, linear(mesh.position(mesh.origin(h)))).expect("inner");
    }
    let mut noise = Noise(seed);
    let mut done = [0; 4];
    for round in 0..400 {
        let edges: Vec<_> = mesh.edges().collect();
        let faces: Vec<_> = mesh.faces().collect();
        let e = edges[noise.below(edges.len() as u32) as usize];
        let f = faces[noise.below(faces.len() as u32) as usize];
        let h = mesh.edge_halfedge(e);
        let (a, b) = (mesh.position(mesh.origin(h)), mesh.position(mesh.target(h)));
        let ok = match round % 4 {
            0 => mesh.split_edge(e, a.lerp(b, 0.1 + 0.8 * noise.unit())).is_ok(),
            1 => {
                // A point of the face's plane near its middle: inside where the face is convex.
                let corners: Vec<_> = mesh.face_vertices(f).map(|v| mesh.position(v)).collect();
                mesh.poke_face(f, corners.iter().sum::<DVec3>() / corners.len() as f64).is_ok()
            }
            2 => mesh.flip_edge(e).is_ok(),
            _ => mesh.split_edge_and_faces(e, a.lerp(b, 0.1 + 0.8 * noise.unit())).is_ok(),
        };
        done[round % 4] += u32::from(ok);
    }
    assert!(done.iter().all(|&n| n > 20), "{done:?}");
    mesh.validate().expect("valid");
    for h in mesh.halfedges() {
        let expected = linear(mesh.position(mesh.origin(h)));
        assert!((mesh.value(on_vertices, mesh.origin(h)) - expected).abs() < 1e-12 * expected.abs().max(1.0));
        if !mesh.is_boundary(h) {
            let off = (mesh.value(on_corners, h) - expected).abs();
            assert!(off < 1e-12 * expected.abs().max(1.0), "off by {off}");
        }
    }
}

#[test]
fn a_linear_function_stays_linear_on_triangles() {
    stays_linear(&fanned(&two_squares().to_indexed()), 1);
}

#[test]
fn a_linear_function_stays_linear_on_polygons() {
    stays_linear(&two_squares().to_indexed(), 2);
}

#[test]
fn a_linear_function_stays_linear_in_concave_faces_and_in_space() {
    let l = [(0., 0.), (3., 0.), (3., 1.), (1., 1.), (1., 3.), (0., 3.)];
    // In a plane that lies aslant.
    let at = |(x, y): (f64, f64)| dvec3(x, y, 0.3 * x - 0.7 * y + 2.0);
    stays_linear(&pool(l.map(at).to_vec(), vec![vec![0, 1, 2, 3, 4, 5]]), 3);
    let dart = [(0., 0.), (2., 1.), (0., 2.), (0.5, 1.)];
    stays_linear(&pool(dart.map(at).to_vec(), vec![vec![0, 1, 2, 3]]), 4);
}

#[test]
fn a_linear_function_stays_linear_through_collapse_along_the_edge() {
    let mut mesh = mesh(&icosphere(3));
    let column = mesh.add_vertex_column(0.0, Rule::interpolate());
    for v in mesh.vertices().collect::<Vec<_>>() {
        mesh.set_value(column, v, linear(mesh.position(v))).expect("live");
    }
    let mut noise = Noise(5);
    for _ in 0..300 {
        let edges: Vec<_> = mesh.edges().collect();
        let h = mesh.edge_halfedge(edges[noise.below(edges.len() as u32) as usize]);
        let (a, b) = (mesh.position(mesh.origin(h)), mesh.position(mesh.target(h)));
        let _ = mesh.collapse(h, a.lerp(b, noise.unit()));
    }
    for v in mesh.vertices() {
        assert!((mesh.value(column, v) - linear(mesh.position(v))).abs() < 1e-12 * 10.0);
    }
}
