use crate::shapes::{cube, tetrahedron};
use crate::{does, hinge, hub, refuses, squares, subject};
use meshwright::{RemoveEdgeError, RemoveFaceError, RemoveVertexError};

#[test]
fn remove_face_opens_a_closed_mesh() {
    let mut s = subject(&cube());
    let f = s.f(2);
    let removed = does!(s, remove_face, check_remove_face(f));
    assert_eq!(removed.faces.as_slice(), [f]);
    assert!(removed.edges.is_empty() && removed.isolated.is_empty() && !s.mesh.contains_face(f));
    assert_eq!((s.counts(), s.mesh.boundary_loops()[0].len()), ([8, 12, 5], 4));
}

#[test]
fn remove_face_takes_edges_without_another_face_and_leaves_vertices_isolated() {
    let mut s = hinge();
    let (f, kept) = (s.f(0), s.e(1, 2));
    let gone = [s.e(0, 1), s.e(2, 0)];
    let removed = does!(s, remove_face, check_remove_face(f));
    assert_eq!(removed.edges.as_slice(), gone);
    assert_eq!(removed.isolated.as_slice(), [s.v(0)]);
    assert!(s.mesh.contains_edge(kept) && s.mesh.is_boundary_edge(kept));
    assert_eq!(s.counts(), [4, 3, 1]);
}

#[test]
fn remove_the_only_face_and_only_points_are_left() {
    let mut s = hub(3);
    for i in 0..3 {
        let f = s.f(i);
        does!(s, remove_face, check_remove_face(f));
    }
    assert_eq!(s.counts(), [4, 0, 0]);
    assert!(s.mesh.vertices().all(|v| s.mesh.is_isolated(v)));
}

#[test]
fn remove_face_refuses_to_pinch_a_boundary_vertex() {
    // The middle square of nine touches nothing; the one at (1, 0) lies with a whole edge on the boundary, and that next
    // to a corner removed before would leave a vertex in two fans.
    let mut s = squares(3);
    let (corner, middle, pinched) = (s.f(0), s.f(4), s.v(5));
    does!(s, remove_face, check_remove_face(corner));
    refuses!(s, remove_face, check_remove_face(middle), RemoveFaceError::Pinch(v) if v == pinched);
    let beside = s.f(1);
    does!(s, remove_face, check_remove_face(beside));
    does!(s, remove_face, check_remove_face(middle));
}

#[test]
fn remove_face_refuses_a_dead_key() {
    let mut s = hinge();
    let f = s.f(0);
    s.mesh.remove_face(f).expect("can be removed");
    refuses!(s, remove_face, check_remove_face(f), RemoveFaceError::Missing(dead) if dead == f);
}

#[test]
fn remove_edge_takes_both_faces_beside_it() {
    let mut s = subject(&tetrahedron());
    let e = s.e(0, 1);
    let removed = does!(s, remove_edge, check_remove_edge(e));
    assert_eq!((removed.faces.len(), removed.edges.as_slice()), (2, [e].as_slice()));
    assert_eq!(s.counts(), [4, 5, 2]);
}

#[test]
fn remove_edge_on_the_boundary_takes_its_one_face() {
    let mut s = squares(2);
    let (e, f) = (s.e(0, 1), s.f(0));
    let removed = does!(s, remove_edge, check_remove_edge(e));
    assert_eq!(removed.faces.as_slice(), [f]);
    assert_eq!((removed.edges.len(), removed.isolated.as_slice()), (2, [s.v(0)].as_slice()));
}

#[test]
fn remove_edge_refuses_to_pinch() {
    // The squares beside the edge between (1, 1) and (2, 1) of nine are the middle ones below and in the middle.
    let mut s = squares(4);
    let e = s.e(6, 7);
    does!(s, remove_edge, check_remove_edge(e));
    let mut s = squares(4);
    // Faces at (1, 1) and (1, 2): the corner at (1, 1) is touched by the hole at (0, 0) from the other side.
    let (corner, e) = (s.f(0), s.e(11, 12));
    s.mesh.remove_face(corner).expect("a corner");
    let pinched = s.v(6);
    refuses!(s, remove_edge, check_remove_edge(e), RemoveEdgeError::Pinch(v) if v == pinched);
}

#[test]
fn remove_edge_refuses_a_dead_key() {
    let mut s = hinge();
    let e = s.e(0, 1);
    s.mesh.remove_edge(e).expect("can be removed");
    refuses!(s, remove_edge, check_remove_edge(e), RemoveEdgeError::Missing(dead) if dead == e);
}

#[test]
fn remove_vertex_inside_leaves_a_hole_where_its_faces_were() {
    let mut s = hub(6);
    let mut t = squares(4);
    let hub = s.v(0);
    let removed = does!(s, remove_vertex, check_remove_vertex(hub));
    assert_eq!((removed.faces.len(), removed.edges.len(), removed.isolated.len()), (6, 12, 6));
    assert_eq!(s.counts(), [6, 0, 0]);
    let middle = t.v(12);
    let removed = does!(t, remove_vertex, check_remove_vertex(middle));
    assert_eq!((removed.faces.len(), removed.edges.len(), removed.isolated.len()), (4, 4, 0));
    assert_eq!((t.counts(), t.mesh.boundary_loops().len()), ([24, 36, 12], 2));
}

#[test]
fn remove_vertex_on_the_boundary_and_an_isolated_one() {
    let mut s = squares(2);
    let corner = s.v(0);
    let removed = does!(s, remove_vertex, check_remove_vertex(corner));
    assert_eq!((removed.faces.len(), removed.edges.len(), removed.isolated.len()), (1, 2, 0));
    let alone = s.vertex(crate::DVec3::Z);
    let removed = does!(s, remove_vertex, check_remove_vertex(alone));
    assert_eq!(removed, meshwright::Removed::default());
    assert_eq!(s.counts(), [8, 10, 3]);
}

#[test]
fn remove_vertex_refuses_to_pinch() {
    // The squares around (1, 1) of sixteen, and a hole that touches their corner (2, 2).
    let mut s = squares(4);
    let (hole, v, pinched) = (s.f(10), s.v(6), s.v(12));
    s.mesh.remove_face(hole).expect("inside");
    refuses!(s, remove_vertex, check_remove_vertex(v), RemoveVertexError::Pinch(at) if at == pinched);
}

#[test]
fn remove_vertex_refuses_a_dead_key() {
    let mut s = hinge();
    let v = s.v(0);
    s.mesh.remove_vertex(v).expect("can be removed");
    refuses!(s, remove_vertex, check_remove_vertex(v), RemoveVertexError::Missing(dead) if dead == v);
}
