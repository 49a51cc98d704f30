use crate::shapes::cube;
use crate::{does, faces, hinge, refuses, squares, subject, three_faced_sphere};
use meshwright::SplitFaceError;

#[test]
fn split_face_cuts_a_quad_in_two() {
    let mut s = subject(&cube());
    let (f, from, to) = (s.f(0), s.h(2, 3), s.h(1, 0));
    let new = does!(s, split_face, check_split_face(from, to));
    assert_eq!(s.counts(), [8, 13, 7]);
    // f is [0, 2, 3, 1]: it keeps what begins at vertex 2, and its first corner is vertex 2 now that 0 is cut off.
    assert_eq!((s.corners(f), s.corners(new.face)), (vec![2, 3, 1], vec![1, 0, 2]));
    let h = s.mesh.edge_halfedge(new.edge);
    assert_eq!((s.mesh.origin(h), s.mesh.target(h), s.mesh.face(h)), (s.v(2), s.v(1), Some(new.face)));
}

#[test]
fn split_face_keeps_the_first_corner_where_it_can() {
    let mut s = faces(6, &[&[0, 1, 2, 3, 4, 5]]);
    let (from, to) = (s.h(5, 0), s.h(2, 3));
    let new = does!(s, split_face, check_split_face(from, to));
    assert_eq!((s.corners(s.f(0)), s.corners(new.face)), (vec![0, 1, 2, 5], vec![2, 3, 4, 5]));
    assert_eq!(s.mesh.boundary_loops()[0].len(), 6);
}

#[test]
fn split_face_refuses_a_dead_half_edge() {
    let mut s = hinge();
    let (h, other) = (s.h(0, 1), s.h(2, 1));
    let f = s.f(0);
    s.mesh.remove_face(f).expect("can be removed");
    refuses!(s, split_face, check_split_face(h, other), SplitFaceError::Missing(dead) if dead == h);
    refuses!(s, split_face, check_split_face(other, h), SplitFaceError::Missing(dead) if dead == h);
}

#[test]
fn split_face_refuses_a_half_edge_without_a_face() {
    let mut s = squares(1);
    let (inner, outer) = (s.h(0, 1), s.h(1, 0));
    refuses!(s, split_face, check_split_face(inner, outer), SplitFaceError::Boundary(h) if h == outer);
}

#[test]
fn split_face_refuses_corners_of_two_faces() {
    let mut s = squares(2);
    let (from, to, f, g) = (s.h(0, 1), s.h(8, 7), s.f(0), s.f(3));
    refuses!(s, split_face, check_split_face(from, to), SplitFaceError::DifferentFaces(a, b) if (a, b) == (f, g));
}

#[test]
fn split_face_refuses_a_diagonal_from_a_corner_to_itself() {
    let mut s = squares(1);
    let from = s.h(0, 1);
    refuses!(s, split_face, check_split_face(from, from), SplitFaceError::SameCorner(h) if h == from);
}

#[test]
fn split_face_refuses_neighbours_within_the_face() {
    let mut s = squares(1);
    let (from, to, e) = (s.h(0, 1), s.h(1, 3), s.e(0, 1));
    refuses!(s, split_face, check_split_face(from, to), SplitFaceError::Joined(joined) if joined == e);
}

#[test]
fn split_face_refuses_corners_joined_elsewhere() {
    // The six-sided face has both ends of the edge 0-1, which is not its own.
    let mut s = three_faced_sphere();
    let (from, to, e) = (s.h(0, 2), s.h(1, 4), s.e(0, 1));
    refuses!(s, split_face, check_split_face(from, to), SplitFaceError::Joined(joined) if joined == e);
}
