use crate::shapes::{both, cube, cube_at};
use crate::{DVec3, does, faces, hinge, refuses, squares, subject};
use meshwright::StitchError;

#[test]
fn stitch_two_triangles_at_an_edge() {
    let mut s = faces(6, &[&[0, 1, 2], &[3, 4, 5]]);
    let (first, second) = (s.h(1, 0), s.h(4, 3));
    let (edge, dead, stays) = (s.e(0, 1), s.e(3, 4), s.mesh.position(s.v(1)));
    let done = does!(s, stitch, check_stitch(first, second));
    assert_eq!((done.edge, done.dead_edge), (edge, dead));
    // The target of the second goes into the origin of the first.
    assert_eq!(done.dead_vertices.as_slice(), [s.v(3), s.v(4)]);
    assert_eq!((s.counts(), s.mesh.components().len(), s.mesh.boundary_loops()[0].len()), ([4, 5, 2], 1, 4));
    assert_eq!((s.corners(s.f(1)), s.mesh.position(s.v(1))), (vec![1, 0, 5], stays));
}

#[test]
fn stitch_edges_that_share_a_vertex_closes_a_fan() {
    let mut s = faces(6, &[&[0, 1, 2], &[0, 2, 3], &[0, 3, 4], &[0, 4, 5]]);
    let (first, second) = (s.h(1, 0), s.h(0, 5));
    assert!(s.mesh.is_boundary(first) && s.mesh.is_boundary(second));
    let done = does!(s, stitch, check_stitch(first, second));
    assert_eq!((done.dead_vertices.as_slice(), s.counts()), ([s.v(5)].as_slice(), [5, 8, 4]));
    assert!(!s.mesh.is_boundary_vertex(s.v(0)));
}

#[test]
fn stitch_refuses_to_leave_a_slit_of_two_edges() {
    // Two cubes that lost the faces they would share: two edges can be stitched, the third would leave a slit.
    let mut s = subject(&both(&cube(), &cube_at(DVec3::Z)));
    let (top, bottom) = (s.f(1), s.f(6));
    s.mesh.remove_face(top).expect("closed");
    s.mesh.remove_face(bottom).expect("closed");
    let counterpart = |s: &crate::Subject, h| {
        let at = |v| s.mesh.position(v);
        let (from, to) = (at(s.mesh.origin(h)), at(s.mesh.target(h)));
        let mut others = s.mesh.boundary_halfedges().filter(|&k| k != h);
        others.find(|&k| at(s.mesh.origin(k)) == to && at(s.mesh.target(k)) == from).expect("the other side")
    };
    // The top's vertices are 4, 5, 7, 6.
    for (a, b) in [(4, 5), (5, 7)] {
        let first = s.h(a, b);
        let second = counterpart(&s, first);
        does!(s, stitch, check_stitch(first, second));
    }
    assert_eq!((s.counts(), s.mesh.boundary_loops()[0].len()), ([13, 22, 10], 4));
    let first = s.h(7, 6);
    let second = counterpart(&s, first);
    refuses!(s, stitch, check_stitch(first, second), StitchError::Parallel(_, _));
}

#[test]
fn stitch_refuses_a_dead_half_edge() {
    let mut s = hinge();
    let (dead, live) = (s.mesh.twin(s.h(0, 1)), s.mesh.twin(s.h(1, 3)));
    let f = s.f(0);
    s.mesh.remove_face(f).expect("can be removed");
    refuses!(s, stitch, check_stitch(dead, live), StitchError::Missing(h) if h == dead);
    refuses!(s, stitch, check_stitch(live, dead), StitchError::Missing(h) if h == dead);
}

#[test]
fn stitch_refuses_a_half_edge_with_a_face() {
    let mut s = hinge();
    let (inner, outer) = (s.h(0, 1), s.mesh.twin(s.h(1, 3)));
    refuses!(s, stitch, check_stitch(outer, inner), StitchError::NotBoundary(h) if h == inner);
}

#[test]
fn stitch_refuses_an_edge_with_itself() {
    let mut s = hinge();
    let outer = s.mesh.twin(s.h(0, 1));
    refuses!(s, stitch, check_stitch(outer, outer), StitchError::SameEdge(h) if h == outer);
}

#[test]
fn stitch_refuses_to_merge_the_ends_of_an_edge() {
    let mut s = squares(1);
    let (first, second) = (s.h(1, 0), s.h(2, 3));
    let between = [s.e(1, 3), s.e(0, 2)];
    refuses!(s, stitch, check_stitch(first, second), StitchError::Joined(e) if between.contains(&e));
}

#[test]
fn stitch_refuses_edges_that_would_be_parallel() {
    let mut s = hinge();
    // At vertex 1: its outer edges to 0 and 3 leave both to 2.
    let (first, second, pair) = (s.h(1, 0), s.h(3, 1), [s.e(0, 2), s.e(2, 3)]);
    refuses!(s, stitch, check_stitch(first, second),
        StitchError::Parallel(a, b) if a != b && pair.contains(&a) && pair.contains(&b));
}

#[test]
fn stitch_refuses_to_merge_two_corners_of_a_face() {
    let mut s = faces(6, &[&[0, 1, 2, 3, 4, 5]]);
    let (first, across, next, f) = (s.h(1, 0), s.h(4, 3), s.h(2, 1), s.f(0));
    refuses!(s, stitch, check_stitch(first, across), StitchError::CommonFace(g) if g == f);
    refuses!(s, stitch, check_stitch(first, next), StitchError::CommonFace(g) if g == f);
}

#[test]
fn stitch_never_puts_two_faces_back_to_back() {
    // Two equal polygons on each other: after one edge, every further one makes parallel edges first.
    for n in [3u32, 4, 5] {
        let (a, b): (Vec<u32>, Vec<u32>) = ((0..n).collect(), (n..2 * n).rev().collect());
        let mut s = faces(2 * n, &[&a, &b]);
        let (first, second) = (s.h(1, 0), s.h(n as usize, n as usize + 1));
        does!(s, stitch, check_stitch(first, second));
        let (mut done, mut progress) = (1, true);
        while progress {
            let open: Vec<_> = s.mesh.boundary_halfedges().collect();
            let pairs = open.iter().flat_map(|&h| open.iter().map(move |&k| (h, k)));
            progress = pairs.into_iter().any(|(h, k)| s.mesh.stitch(h, k).is_ok());
            done += u32::from(progress);
            s.mesh.validate().expect("valid");
        }
        assert!(done < n - 1, "{done} edges of {n}");
    }
}
