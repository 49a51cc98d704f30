use crate::shapes::{cube, tetrahedron};
use crate::{DVec3, does, hinge, refuses, subject};
use meshwright::SplitEdgeError;

#[test]
fn split_edge_inside_gives_both_faces_a_corner() {
    let mut s = subject(&cube());
    let e = s.e(0, 1);
    let h = s.mesh.edge_halfedge(e);
    let (from, to) = (s.mesh.origin(h), s.mesh.target(h));
    let new = does!(s, split_edge, check_split_edge(e, DVec3::X * 0.25));
    assert_eq!(s.counts(), [9, 13, 6]);
    assert_eq!((s.mesh.origin(h), s.mesh.target(h)), (from, new.vertex), "the edge keeps its first half");
    assert_eq!(s.mesh.find_halfedge(new.vertex, to).map(|h| s.mesh.edge(h)), Some(new.edge));
    assert_eq!((s.corners(s.f(0)), s.corners(s.f(2))), (vec![0, 2, 3, 1, 8], vec![0, 8, 1, 5, 4]));
    assert_eq!(s.mesh.position(new.vertex), DVec3::X * 0.25);
}

#[test]
fn split_edge_on_the_boundary_leaves_the_boundary_whole() {
    for (a, b) in [(0, 1), (3, 2), (1, 3)] {
        let mut s = hinge();
        let e = s.e(a, b);
        let new = does!(s, split_edge, check_split_edge(e, DVec3::Z));
        assert_eq!((s.counts(), s.mesh.boundary_loops()[0].len()), ([5, 6, 2], 5));
        assert!(s.mesh.is_boundary_vertex(new.vertex));
    }
}

#[test]
fn split_edge_keeps_first_corners() {
    let mut s = subject(&tetrahedron());
    let firsts: Vec<usize> = (0..4).map(|i| s.corners(s.f(i))[0]).collect();
    for e in s.mesh.edges().collect::<Vec<_>>() {
        does!(s, split_edge, check_split_edge(e, DVec3::ONE));
    }
    assert_eq!((0..4).map(|i| s.corners(s.f(i))[0]).collect::<Vec<_>>(), firsts);
    assert!(s.mesh.faces().all(|f| s.mesh.degree(f) == 6));
}

#[test]
fn split_edge_and_faces_keeps_triangles_and_names_the_cuts() {
    let mut s = hinge();
    let e = s.e(1, 2);
    let new = does!(s, split_edge_and_faces, check_split_edge(e, DVec3::ONE * 0.5));
    assert_eq!((s.counts(), new.cuts.len()), ([5, 8, 4], 2));
    assert!(s.mesh.faces().all(|f| s.mesh.degree(f) == 3));
    for cut in &new.cuts {
        let h = s.mesh.edge_halfedge(cut.edge);
        assert_eq!((s.mesh.origin(h), s.mesh.face(h)), (new.vertex, Some(cut.face)));
    }
    assert_eq!((s.corners(s.f(0)), s.corners(s.f(1))), (vec![0, 4, 2], vec![4, 1, 3]));
}

#[test]
fn split_edge_and_faces_on_the_boundary_makes_one_cut() {
    let mut s = hinge();
    let e = s.e(0, 1);
    let new = does!(s, split_edge_and_faces, check_split_edge(e, DVec3::X * 0.5));
    assert_eq!((s.counts(), new.cuts.len()), ([5, 7, 3], 1));
}

#[test]
fn split_edge_and_faces_cuts_no_polygon() {
    let mut s = subject(&cube());
    let e = s.e(0, 1);
    let new = does!(s, split_edge_and_faces, check_split_edge(e, DVec3::X * 0.5));
    assert!(new.cuts.is_empty());
    assert_eq!(s.counts(), [9, 13, 6]);
}

#[test]
fn split_edge_refuses_a_dead_edge() {
    let mut s = hinge();
    let e = s.e(0, 1);
    s.mesh.remove_edge(e).expect("can be removed");
    refuses!(s, split_edge, check_split_edge(e, DVec3::X), SplitEdgeError::Missing(dead) if dead == e);
    refuses!(s, split_edge_and_faces, check_split_edge(e, DVec3::X), SplitEdgeError::Missing(dead) if dead == e);
}

#[test]
fn split_edge_refuses_a_position_that_is_not_finite() {
    let mut s = hinge();
    let e = s.e(0, 1);
    refuses!(s, split_edge, check_split_edge(e, DVec3::NAN), SplitEdgeError::NonFinite(_));
    refuses!(s, split_edge_and_faces, check_split_edge(e, DVec3::NAN), SplitEdgeError::NonFinite(_));
}
