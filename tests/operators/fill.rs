use crate::shapes::cube;
use crate::{does, faces, hinge, hub, refuses, squares, subject};
use meshwright::FillHoleError;

#[test]
fn fill_closes_a_cube_without_a_face() {
    let mut s = subject(&cube());
    let f = s.f(3);
    s.mesh.remove_face(f).expect("closed");
    let h = s.h(7, 3);
    assert!(s.mesh.is_boundary(h));
    let new = does!(s, fill_hole, check_fill_hole(h));
    assert_eq!((s.corners(new), s.counts(), s.mesh.is_closed()), (vec![7, 3, 2, 6], [8, 12, 6], true));
}

#[test]
fn fill_the_outside_of_a_disc() {
    let mut s = hub(9);
    let h = s.mesh.boundary_halfedges().next().expect("open");
    let new = does!(s, fill_hole, check_fill_hole(h));
    assert_eq!((s.mesh.degree(new), s.mesh.euler_characteristic()), (9, 2));
    assert_eq!(s.mesh.face_halfedge(new), h);
}

#[test]
fn fill_one_of_two_holes() {
    let mut s = squares(3);
    let f = s.f(4);
    s.mesh.remove_face(f).expect("inside");
    let h = s.mesh.boundary_loops().into_iter().find(|l| l.len() == 4).expect("the hole")[0];
    does!(s, fill_hole, check_fill_hole(h));
    assert_eq!((s.mesh.boundary_loops().len(), s.counts()), (1, [16, 24, 9]));
}

#[test]
fn fill_refuses_a_dead_half_edge() {
    let mut s = hinge();
    let h = s.mesh.twin(s.h(0, 1));
    let f = s.f(0);
    s.mesh.remove_face(f).expect("can be removed");
    refuses!(s, fill_hole, check_fill_hole(h), FillHoleError::Missing(dead) if dead == h);
}

#[test]
fn fill_refuses_a_half_edge_with_a_face() {
    let mut s = hinge();
    let h = s.h(0, 1);
    refuses!(s, fill_hole, check_fill_hole(h), FillHoleError::NotBoundary(inner) if inner == h);
}

#[test]
fn fill_refuses_the_outside_of_one_face() {
    let mut s = faces(5, &[&[0, 1, 2, 3, 4]]);
    let (h, f) = (s.mesh.twin(s.h(0, 1)), s.f(0));
    refuses!(s, fill_hole, check_fill_hole(h), FillHoleError::Duplicate(other) if other == f);
}
