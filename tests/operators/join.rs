use crate::shapes::{cube, tetrahedron};
use crate::{DVec3, does, faces, hinge, refuses, squares, subject, three_faced_sphere};
use meshwright::JoinFacesError;

#[test]
fn join_two_triangles_to_a_quad() {
    let mut s = hinge();
    let e = s.e(1, 2);
    let stays = s.mesh.face(s.mesh.edge_halfedge(e)).expect("inner");
    let done = does!(s, join_faces, check_join_faces(e));
    assert_eq!((done.face, done.dead_edges.as_slice(), s.counts()), (stays, [e].as_slice(), [4, 4, 1]));
    assert!(done.dead_vertices.is_empty() && !s.mesh.contains_face(done.dead_face));
    assert_eq!(s.corners(done.face), [0, 1, 3, 2]);
}

#[test]
fn join_keeps_the_first_corner_and_takes_the_next_if_it_was_on_the_edge() {
    let mut s = squares(2);
    let e = s.e(1, 4);
    let done = does!(s, join_faces, check_join_faces(e));
    assert_eq!(s.corners(done.face), [0, 1, 2, 5, 4, 3]);
    let mut s = subject(&cube());
    let e = s.e(0, 2);
    let done = does!(s, join_faces, check_join_faces(e));
    assert_eq!((done.face, s.corners(done.face)), (s.f(0), vec![0, 4, 6, 2, 3, 1]));
}

#[test]
fn join_takes_a_whole_chain() {
    let mut s = hinge();
    let e = s.e(1, 2);
    let new = s.mesh.split_edge(e, DVec3::ONE / 2.0).expect("always");
    let more = s.mesh.split_edge(new.edge, DVec3::ONE / 3.0).expect("always");
    let done = does!(s, join_faces, check_join_faces(new.edge));
    assert_eq!((done.dead_edges.len(), done.dead_vertices.len(), s.counts()), (3, 2, [4, 4, 1]));
    assert!(done.dead_vertices.contains(&new.vertex) && done.dead_vertices.contains(&more.vertex));
}

#[test]
fn join_undoes_split_face() {
    let mut s = squares(1);
    let before = s.mesh.to_indexed();
    let (from, to) = (s.h(0, 1), s.h(3, 2));
    let new = s.mesh.split_face(from, to).expect("a diagonal");
    let kept = s.f(0);
    let done = does!(s, join_faces, check_join_faces(new.edge));
    assert_eq!((done.face, done.dead_face), (new.face, kept), "the diagonal's half-edge has the new face");
    assert_eq!(s.mesh.face_count(), before.face_count());
}

#[test]
fn join_refuses_a_dead_edge() {
    let mut s = hinge();
    let e = s.e(0, 1);
    s.mesh.remove_edge(e).expect("can be removed");
    refuses!(s, join_faces, check_join_faces(e), JoinFacesError::Missing(dead) if dead == e);
}

#[test]
fn join_refuses_a_boundary_edge() {
    let mut s = hinge();
    let outer = s.e(0, 1);
    refuses!(s, join_faces, check_join_faces(outer), JoinFacesError::Boundary(e) if e == outer);
}

#[test]
fn join_refuses_faces_that_meet_at_another_edge() {
    let mut s = faces(8, &[&[0, 1, 2, 6, 5, 4], &[2, 3, 0, 4, 7, 6]]);
    let (e, elsewhere) = (s.e(2, 6), [s.v(0), s.v(4)]);
    refuses!(s, join_faces, check_join_faces(e), JoinFacesError::SharedVertex(v) if elsewhere.contains(&v));
}

#[test]
fn join_refuses_faces_that_meet_at_another_vertex() {
    // Two faces that share the edge 0-1 and, on the far side, vertex 2; four triangles close its fan.
    let mut s = faces(7, &[&[0, 1, 3, 2, 4], &[1, 0, 5, 2, 6], &[4, 2, 5], &[3, 6, 2]]);
    let (e, far) = (s.e(0, 1), s.v(2));
    refuses!(s, join_faces, check_join_faces(e), JoinFacesError::SharedVertex(v) if v == far);
}

#[test]
fn join_refuses_to_double_a_face() {
    let mut s = three_faced_sphere();
    for (a, b, other) in [(0, 1, 2), (0, 2, 1), (4, 5, 0)] {
        let (e, other) = (s.e(a, b), s.f(other));
        refuses!(s, join_faces, check_join_faces(e), JoinFacesError::Duplicate(f) if f == other);
    }
    // Of a tetrahedron a quad and two triangles are left, then nothing more can go.
    let mut s = subject(&tetrahedron());
    let e = s.e(0, 1);
    does!(s, join_faces, check_join_faces(e));
    assert!(s.mesh.edges().all(|e| s.mesh.check_join_faces(e).is_err()));
}
