use crate::shapes::{cube, tetrahedron};
use crate::{DVec3, does, faces, hinge, hub, refuses, squares, subject, three_faced_sphere};
use meshwright::DissolveVertexError;

#[test]
fn dissolve_inside_makes_one_face_of_all_around() {
    let mut s = hub(7);
    let v = s.v(0);
    let done = does!(s, dissolve_vertex, check_dissolve_vertex(v));
    assert_eq!((done.faces.len(), done.dead_faces.len(), done.dead_edges.len(), done.edge), (1, 6, 7, None));
    assert_eq!((s.counts(), s.mesh.degree(done.faces[0])), ([7, 7, 1], 7));
}

#[test]
fn dissolve_in_polygons() {
    let mut s = squares(2);
    let v = s.v(4);
    let done = does!(s, dissolve_vertex, check_dissolve_vertex(v));
    let mut corners = s.corners(done.faces[0]);
    corners.sort();
    assert_eq!((s.counts(), corners), ([8, 8, 1], vec![0, 1, 2, 3, 5, 6, 7, 8]));
    let mut s = subject(&cube());
    let v = s.v(0);
    let done = does!(s, dissolve_vertex, check_dissolve_vertex(v));
    assert_eq!((s.counts(), s.mesh.degree(done.faces[0])), ([7, 9, 4], 6));
}

#[test]
fn dissolve_on_the_boundary_closes_the_gap_with_one_of_the_edges() {
    let mut s = squares(2);
    let (v, spoke) = (s.v(1), s.e(1, 4));
    let done = does!(s, dissolve_vertex, check_dissolve_vertex(v));
    let edge = done.edge.expect("on the boundary");
    assert_eq!((s.e(0, 2), s.counts()), (edge, [8, 10, 3]));
    assert!(s.mesh.is_boundary_edge(edge) && done.dead_edges.contains(&spoke));
    assert_eq!(
        (done.dead_faces.len(), s.mesh.degree(done.faces[0]), s.mesh.boundary_loops()[0].len()),
        (1, 5, 7)
    );
}

#[test]
fn dissolve_between_two_edges_undoes_split_edge() {
    for e in hinge().mesh.edges() {
        let mut s = hinge();
        let before = s.mesh.to_indexed();
        let new = s.mesh.split_edge(e, DVec3::Z).expect("always");
        let done = does!(s, dissolve_vertex, check_dissolve_vertex(new.vertex));
        assert_eq!(s.mesh.to_indexed().polygons(), before.polygons());
        let faces = if s.mesh.is_boundary_edge(done.edge.expect("one of two")) { 1 } else { 2 };
        assert_eq!((done.faces.len(), done.dead_faces.len(), done.dead_edges.len()), (faces, 0, 1));
    }
}

#[test]
fn dissolve_undoes_poke_but_for_the_first_corner() {
    let mut s = squares(1);
    let f = s.f(0);
    let new = s.mesh.poke_face(f, DVec3::ONE / 2.0).expect("finite");
    let done = does!(s, dissolve_vertex, check_dissolve_vertex(new.vertex));
    assert_eq!((done.faces.len(), s.counts()), (1, [4, 4, 1]));
}

#[test]
fn dissolve_refuses_a_dead_vertex() {
    let mut s = hinge();
    let v = s.v(0);
    s.mesh.remove_vertex(v).expect("can be removed");
    refuses!(s, dissolve_vertex, check_dissolve_vertex(v), DissolveVertexError::Missing(dead) if dead == v);
}

#[test]
fn dissolve_refuses_an_isolated_vertex() {
    let mut s = hinge();
    let v = s.vertex(DVec3::Z);
    refuses!(s, dissolve_vertex, check_dissolve_vertex(v), DissolveVertexError::Isolated(alone) if alone == v);
}

#[test]
fn dissolve_refuses_a_merged_face_that_touches_itself() {
    let mut s = three_faced_sphere();
    let v = s.v(0);
    refuses!(s, dissolve_vertex, check_dissolve_vertex(v), DissolveVertexError::RepeatedVertex(_));
    // A hub of quads whose far corners are one vertex, on the boundary as well.
    let mut s = faces(6, &[&[0, 1, 5, 2], &[0, 2, 3], &[0, 3, 5, 4], &[2, 5, 3]]);
    let (v, twice) = (s.v(0), s.v(5));
    refuses!(s, dissolve_vertex, check_dissolve_vertex(v), DissolveVertexError::RepeatedVertex(w) if w == twice);
}

#[test]
fn dissolve_refuses_when_the_closing_edge_is_there() {
    let mut s = hinge();
    let (ear, e) = (s.v(0), s.e(1, 2));
    refuses!(s, dissolve_vertex, check_dissolve_vertex(ear), DissolveVertexError::Joined(j) if j == e);
    // A vertex between two edges inside, one of whose faces is a triangle.
    let mut s = faces(4, &[&[0, 1, 2], &[1, 0, 2, 3]]);
    let (v, e) = (s.v(0), s.e(1, 2));
    refuses!(s, dissolve_vertex, check_dissolve_vertex(v), DissolveVertexError::Joined(j) if j == e);
    // A boundary vertex whose two outer neighbours are joined around the back.
    let mut s = faces(4, &[&[0, 1, 2], &[0, 2, 3], &[2, 1, 3]]);
    let (v, e) = (s.v(0), s.e(1, 3));
    refuses!(s, dissolve_vertex, check_dissolve_vertex(v), DissolveVertexError::Joined(j) if j == e);
}

#[test]
fn dissolve_refuses_to_double_the_face_across() {
    let mut s = subject(&tetrahedron());
    let (v, across) = (s.v(3), s.f(0));
    refuses!(s, dissolve_vertex, check_dissolve_vertex(v), DissolveVertexError::Duplicate(f) if f == across);
}
