use crate::shapes::{cube, fanned, icosphere, tetrahedron};
use crate::{DVec3, does, faces, hinge, refuses, squares, subject};
use meshwright::FlipEdgeError;

#[test]
fn flip_joins_the_apexes_of_two_triangles() {
    let mut s = hinge();
    let e = s.e(1, 2);
    does!(s, flip_edge, check_flip_edge(e));
    assert_eq!((s.e(0, 3), s.counts()), (e, [4, 5, 2]));
    let mut cycles = [s.corners(s.f(0)), s.corners(s.f(1))];
    cycles.sort();
    assert!(cycles.iter().all(|c| c.contains(&0) && c.contains(&3)), "{cycles:?}");
}

#[test]
fn flip_twice_is_back_with_the_edge_reversed() {
    let mut s = subject(&icosphere(1));
    let corners = |s: &crate::Subject| {
        let mut all: Vec<_> = s
            .mesh
            .faces()
            .map(|f| {
                let mut c = s.corners(f);
                c.sort();
                (f, c)
            })
            .collect();
        all.sort();
        all.into_iter().map(|x| x.1).collect::<std::collections::BTreeSet<_>>()
    };
    let before = corners(&s);
    for e in s.mesh.edges().collect::<Vec<_>>() {
        let h = s.mesh.edge_halfedge(e);
        let ends = (s.mesh.origin(h), s.mesh.target(h));
        does!(s, flip_edge, check_flip_edge(e));
        does!(s, flip_edge, check_flip_edge(e));
        assert_eq!((s.mesh.target(h), s.mesh.origin(h)), ends);
        assert_eq!(corners(&s), before);
    }
}

#[test]
fn flip_between_polygons_turns_the_edge_by_one_corner() {
    let mut s = squares(2);
    let e = s.e(1, 4);
    let h = s.mesh.edge_halfedge(e);
    let (from, to) = (s.number(s.mesh.origin(h)), s.number(s.mesh.target(h)));
    assert_eq!((from, to), (1, 4));
    does!(s, flip_edge, check_flip_edge(e));
    // Counter-clockwise: its lower end goes to the right, its upper end to the left.
    assert_eq!((s.number(s.mesh.origin(h)), s.number(s.mesh.target(h))), (2, 3));
    assert_eq!((s.corners(s.f(0)), s.corners(s.f(1))), (vec![0, 1, 2, 3], vec![3, 2, 5, 4]));
    assert_eq!(s.counts(), [9, 12, 4]);
}

#[test]
fn flip_keeps_the_first_corner_whose_vertex_stays() {
    let s = subject(&fanned(&cube()));
    for e in s.mesh.edges() {
        let mut s = subject(&fanned(&cube()));
        let firsts: Vec<_> = s.mesh.faces().map(|f| (f, s.corners(f)[0])).collect();
        if s.mesh.flip_edge(e).is_ok() {
            for (f, first) in firsts {
                assert!(s.corners(f)[0] == first || !s.corners(f).contains(&first));
            }
        }
    }
}

#[test]
fn flip_beside_the_boundary() {
    let mut s = faces(5, &[&[0, 1, 2], &[0, 2, 3], &[0, 3, 4]]);
    let e = s.e(0, 2);
    does!(s, flip_edge, check_flip_edge(e));
    assert_eq!((s.mesh.valence(s.v(0)), s.mesh.valence(s.v(1)), s.mesh.boundary_loops()[0].len()), (3, 3, 5));
}

#[test]
fn flip_refuses_a_dead_edge() {
    let mut s = hinge();
    let e = s.e(0, 1);
    s.mesh.remove_edge(e).expect("can be removed");
    refuses!(s, flip_edge, check_flip_edge(e), FlipEdgeError::Missing(dead) if dead == e);
}

#[test]
fn flip_refuses_a_boundary_edge() {
    let mut s = hinge();
    let outer = s.e(0, 1);
    refuses!(s, flip_edge, check_flip_edge(outer), FlipEdgeError::Boundary(e) if e == outer);
}

#[test]
fn flip_refuses_every_edge_of_a_tetrahedron() {
    let s = subject(&tetrahedron());
    for (e, across) in [((0, 1), (2, 3)), ((2, 3), (0, 1)), ((1, 2), (0, 3))] {
        let (e, across) = (s.e(e.0, e.1), s.e(across.0, across.1));
        let mut s = subject(&tetrahedron());
        refuses!(s, flip_edge, check_flip_edge(e), FlipEdgeError::Joined(j) if j == across);
    }
}

#[test]
fn flip_refuses_when_the_faces_share_the_next_edge_too() {
    let mut s = hinge();
    let e = s.e(1, 2);
    let new = s.mesh.split_edge(e, DVec3::ONE / 2.0).expect("always");
    for e in [e, new.edge] {
        let ends = [s.v(1), s.v(2)];
        refuses!(s, flip_edge, check_flip_edge(e),
            FlipEdgeError::RepeatedVertex { vertex, .. } if ends.contains(&vertex));
    }
}

#[test]
fn flip_refuses_a_face_that_has_the_new_end_already() {
    // Two faces around a ring that meet at 2-6 and at 0-4.
    let mut s = faces(8, &[&[0, 1, 2, 6, 5, 4], &[2, 3, 0, 4, 7, 6]]);
    let e = s.e(2, 6);
    does!(s, flip_edge, check_flip_edge(e));
    // Without vertices 5 and 7 the edge's next corners are those of the other meeting.
    let mut s = faces(6, &[&[0, 1, 2, 5, 4], &[2, 3, 0, 4, 5]]);
    let e = s.e(2, 5);
    refuses!(s, flip_edge, check_flip_edge(e), FlipEdgeError::RepeatedVertex { .. });
}
