use crate::shapes::{cube, fanned, grid, icosphere, tetrahedron, torus};
use crate::{DVec3, Subject, does, faces, hinge, hub, refuses, squares, subject, three_faced_sphere};
use meshwright::{CollapseError, Collapsed};

/// Collapses an edge, given from the vertex that goes to the one that stays, into that.
fn collapse(s: &mut Subject, from: usize, to: usize) -> Collapsed {
    let h = s.h(from, to);
    does!(s, collapse, check_collapse(h, s.mesh.position(s.v(to))))
}

#[test]
fn collapse_inside_takes_both_triangles() {
    let mut s = subject(&grid(4));
    let (dead_faces, before) = ([s.mesh.face(s.h(6, 12)), s.mesh.face(s.h(12, 6))], s.counts());
    let done = collapse(&mut s, 6, 12);
    assert_eq!((done.vertex, done.dead_vertex), (s.v(12), s.v(6)));
    assert_eq!(done.dead_faces.iter().map(|&f| Some(f)).collect::<Vec<_>>(), dead_faces);
    assert_eq!((done.dead_edges.len(), s.counts()), (3, [before[0] - 1, before[1] - 3, before[2] - 2]));
    assert!(!s.mesh.contains_vertex(s.v(6)) && s.mesh.boundary_loops().len() == 1);
}

#[test]
fn collapse_in_polygons_takes_a_corner_from_each() {
    let mut s = subject(&cube());
    let e = s.e(0, 1);
    let done = collapse(&mut s, 0, 1);
    assert_eq!((done.dead_faces.len(), done.dead_edges.as_slice()), (0, [e].as_slice()));
    assert_eq!(s.counts(), [7, 11, 6]);
    assert_eq!((s.corners(s.f(0)), s.corners(s.f(2))), (vec![1, 2, 3], vec![1, 5, 4]));
    assert_eq!(s.corners(s.f(4)), [1, 4, 6, 2], "the first corner goes with its vertex");
}

#[test]
fn collapse_beside_a_triangle_and_a_quad() {
    let mut s = faces(8, &[&[0, 1, 2], &[1, 0, 3, 4], &[2, 1, 4, 5], &[0, 2, 5, 6], &[3, 0, 6, 7]]);
    let done = collapse(&mut s, 0, 1);
    assert_eq!((done.dead_faces.as_slice(), done.dead_edges.len()), ([s.f(0)].as_slice(), 2));
    assert_eq!(s.corners(s.f(1)), [1, 3, 4]);
}

#[test]
fn collapse_moves_the_vertex_that_stays() {
    let mut s = squares(2);
    let h = s.h(4, 5);
    does!(s, collapse, check_collapse(h, DVec3::Z));
    assert_eq!(s.mesh.position(s.v(5)), DVec3::Z);
}

#[test]
fn collapse_into_target_leaves_it_and_to_midpoint_goes_half_way() {
    let mut s = squares(2);
    let h = s.h(4, 5);
    let done = s.mesh.collapse_into_target(h).expect("inside");
    assert_eq!(s.mesh.position(done.vertex), DVec3::new(2., 1., 0.));
    let mut s = squares(2);
    let h = s.h(4, 5);
    let done = s.mesh.collapse_to_midpoint(h).expect("inside");
    assert_eq!(s.mesh.position(done.vertex), DVec3::new(1.5, 1., 0.));
}

#[test]
fn the_midpoint_of_the_largest_numbers_is_finite() {
    let mut s = hub(5);
    let (a, b) = (s.v(0), s.v(1));
    s.mesh.set_position(a, DVec3::splat(f64::MAX)).expect("finite");
    s.mesh.set_position(b, DVec3::splat(f64::MAX)).expect("finite");
    let h = s.h(0, 1);
    let done = s.mesh.collapse_to_midpoint(h).expect("done");
    assert_eq!(s.mesh.position(done.vertex), DVec3::splat(f64::MAX));
}

#[test]
fn collapse_on_the_boundary_takes_one_triangle_and_shortens_the_loop() {
    let mut s = subject(&grid(4));
    let done = collapse(&mut s, 1, 2);
    assert_eq!((done.dead_faces.len(), done.dead_edges.len()), (1, 2));
    assert_eq!((s.mesh.boundary_loops()[0].len(), s.mesh.euler_characteristic()), (15, 1));
}

#[test]
fn collapse_an_edge_from_inside_to_the_boundary_and_back() {
    for (from, to) in [(6, 1), (1, 6)] {
        let mut s = subject(&grid(4));
        let done = collapse(&mut s, from, to);
        assert!(s.mesh.is_boundary_vertex(done.vertex));
        assert_eq!((s.mesh.boundary_loops()[0].len(), s.mesh.euler_characteristic()), (16, 1));
    }
}

#[test]
fn an_ear_may_collapse_along_its_free_edges() {
    let mut s = hinge();
    let done = collapse(&mut s, 0, 1);
    assert_eq!((done.dead_faces.as_slice(), s.counts()), ([s.f(0)].as_slice(), [3, 3, 1]));
    assert_eq!(s.corners(s.f(1)), [2, 1, 3]);
}

#[test]
fn a_hub_collapses_into_its_rim() {
    let mut s = hub(1000);
    let done = collapse(&mut s, 0, 500);
    assert_eq!((done.dead_faces.len(), s.counts()), (2, [1000, 1997, 998]));
    let mut s = hub(1000);
    collapse(&mut s, 500, 0);
    assert_eq!(s.mesh.valence(s.v(0)), 999);
}

#[test]
fn a_quad_on_the_boundary_becomes_a_triangle() {
    let mut s = squares(1);
    collapse(&mut s, 0, 1);
    assert_eq!((s.corners(s.f(0)), s.counts()), (vec![1, 3, 2], [3, 3, 1]));
}

#[test]
fn collapse_refuses_a_dead_half_edge() {
    let mut s = hinge();
    let h = s.h(0, 1);
    let f = s.f(0);
    s.mesh.remove_face(f).expect("can be removed");
    refuses!(s, collapse, check_collapse(h, DVec3::X), CollapseError::Missing(dead) if dead == h);
    assert_eq!(s.mesh.collapse_to_midpoint(h), Err(CollapseError::Missing(h)));
    assert_eq!(s.mesh.collapse_into_target(h), Err(CollapseError::Missing(h)));
}

#[test]
fn collapse_refuses_a_position_that_is_not_finite() {
    let mut s = hub(4);
    let h = s.h(0, 1);
    refuses!(s, collapse, check_collapse(h, DVec3::NAN), CollapseError::NonFinite(_));
}

#[test]
fn collapse_refuses_an_inner_edge_from_boundary_to_boundary() {
    for mut s in [hinge(), faces(6, &[&[0, 1, 2, 3], &[0, 3, 4, 5]])] {
        let inner = s.mesh.edges().find(|&e| !s.mesh.is_boundary_edge(e)).expect("one");
        let h = s.mesh.edge_halfedge(inner);
        refuses!(s, collapse, check_collapse(h, DVec3::X), CollapseError::BetweenBoundaries(e) if e == inner);
    }
}

#[test]
fn collapse_refuses_when_both_ends_have_another_common_neighbor() {
    // Around a tube of three.
    let quads = torus(3, 5);
    for pool in [fanned(&quads), quads] {
        let mut s = subject(&pool);
        let (h, third) = (s.h(0, 5), s.v(10));
        refuses!(s, collapse, check_collapse(h, DVec3::X), CollapseError::CommonNeighbor(v) if v == third);
    }
}

#[test]
fn collapse_refuses_to_close_a_hole_of_three_edges() {
    let mut s = faces(6, &[&[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]]);
    let (h, third) = (s.h(0, 1), s.v(2));
    refuses!(s, collapse, check_collapse(h, DVec3::X), CollapseError::CommonNeighbor(v) if v == third);
}

#[test]
fn collapse_refuses_when_another_face_has_both_ends() {
    let mut s = three_faced_sphere();
    let (h, six) = (s.h(0, 1), s.f(2));
    refuses!(s, collapse, check_collapse(h, DVec3::X), CollapseError::CommonFace(f) if f == six);
}

#[test]
fn collapse_refuses_the_only_triangle() {
    let mut s = faces(3, &[&[0, 1, 2]]);
    let (h, apex) = (s.h(0, 1), s.v(2));
    refuses!(s, collapse, check_collapse(h, DVec3::X), CollapseError::LastFace(v) if v == apex);
    let t = s.mesh.twin(h);
    refuses!(s, collapse, check_collapse(t, DVec3::X), CollapseError::LastFace(v) if v == apex);
}

#[test]
fn collapse_refuses_to_make_a_pillow_of_a_tetrahedron() {
    let s = subject(&tetrahedron());
    for h in s.mesh.halfedges() {
        let mut s = subject(&tetrahedron());
        refuses!(s, collapse, check_collapse(h, DVec3::X), CollapseError::Duplicate(_, _));
    }
}

#[test]
fn collapse_refuses_a_pillow_of_larger_faces() {
    // A triangle on a pillow of two pentagons, one of which was cut: closing it puts the pentagons back to back.
    let mut s = faces(6, &[&[0, 1, 2], &[1, 3, 4, 5, 2], &[0, 2, 5, 4, 3], &[0, 3, 1]]);
    let (h, pair) = (s.h(0, 1), [s.f(1), s.f(2)]);
    refuses!(s, collapse, check_collapse(h, DVec3::X),
        CollapseError::Duplicate(f, g) if pair.contains(&f) && pair.contains(&g) && f != g);
}

#[test]
fn a_sphere_collapses_to_a_tetrahedron_and_no_further() {
    let mut s = subject(&icosphere(2));
    loop {
        let Some(h) = s.mesh.halfedges().find(|&h| s.mesh.check_collapse(h, DVec3::ZERO).is_ok()) else {
            break;
        };
        let p = s.mesh.position(s.mesh.target(h));
        s.mesh.collapse(h, p).expect("the check said so");
    }
    s.mesh.validate().expect("valid");
    assert_eq!((s.counts(), s.mesh.euler_characteristic()), ([4, 6, 4], 2));
}
