use crate::shapes::cube;
use crate::{DVec3, Subject, does, faces, hub, refuses, squares, subject};
use meshwright::{SplitVertex, SplitVertexError};

/// Splits the first vertex with the edges to these two.
fn split(s: &mut Subject, v: usize, first: usize, last: usize) -> SplitVertex {
    let (first, last) = (s.h(v, first), s.h(v, last));
    does!(s, split_vertex, check_split_vertex(first, last, DVec3::Z))
}

#[test]
fn split_vertex_inside_gives_the_faces_beside_the_new_edge_a_corner() {
    let mut s = hub(6);
    // Clockwise from 3 to 1: the edges to 3, 2 and 1 go.
    let new = split(&mut s, 0, 3, 1);
    assert_eq!((s.counts(), s.mesh.valence(s.v(0)), s.mesh.valence(new.vertex)), ([8, 13, 6], 4, 4));
    let degrees: Vec<_> = (0..6).map(|i| s.corners(s.f(i))).collect();
    assert_eq!(degrees[..2], [[7, 1, 2], [7, 2, 3]]);
    assert_eq!(degrees[2], [0, 7, 3, 4], "the first corner stays with the old vertex");
    assert_eq!(degrees[5], [0, 6, 1, 7]);
    let h = s.mesh.edge_halfedge(new.edge);
    assert_eq!((s.mesh.origin(h), s.mesh.target(h)), (s.v(0), new.vertex));
}

#[test]
fn split_vertex_with_one_edge_puts_a_vertex_on_it() {
    let mut s = subject(&cube());
    let new = split(&mut s, 0, 1, 1);
    assert_eq!((s.counts(), s.mesh.valence(new.vertex)), ([9, 13, 6], 2));
    assert_eq!(s.corners(s.f(0)), [0, 2, 3, 1, 8]);
}

#[test]
fn split_vertex_on_the_boundary_keeps_one_boundary_vertex_or_makes_two() {
    // Vertex 4 on the side of four squares has edges, clockwise from the boundary: whatever runs of them go, the mesh
    // stays valid and the boundary one loop.
    for v in [1, 4, 0] {
        let s = squares(2);
        let around: Vec<_> = s.mesh.outgoing(s.v(v)).collect();
        for i in 0..around.len() {
            for j in 0..around.len() - 1 {
                let mut s = squares(2);
                let (first, last) = (around[i], around[(i + j) % around.len()]);
                let new = does!(s, split_vertex, check_split_vertex(first, last, DVec3::Z));
                assert_eq!((s.mesh.boundary_loops().len(), s.mesh.euler_characteristic()), (1, 1));
                assert_eq!(s.mesh.valence(new.vertex), j + 2);
            }
        }
    }
}

#[test]
fn collapse_takes_split_vertex_back() {
    for v in 0..9 {
        let around: Vec<_> = {
            let s = squares(2);
            s.mesh.outgoing(s.v(v)).collect()
        };
        for &first in &around {
            for &last in &around {
                let mut s = squares(2);
                let before = s.mesh.to_indexed();
                let Ok(new) = s.mesh.split_vertex(first, last, DVec3::Z) else { continue };
                let back = s.mesh.twin(s.mesh.edge_halfedge(new.edge));
                let done = does!(s, collapse, check_collapse(back, s.mesh.position(s.v(v))));
                assert_eq!((done.vertex, s.mesh.to_indexed()), (s.v(v), before));
            }
        }
    }
}

#[test]
fn split_vertex_refuses_a_dead_half_edge() {
    let mut s = hub(4);
    let (live, dead) = (s.h(1, 0), s.h(2, 3));
    let f = s.f(1);
    s.mesh.remove_face(f).expect("can be removed");
    let missing = SplitVertexError::Missing(dead);
    refuses!(s, split_vertex, check_split_vertex(dead, live, DVec3::Z), e if e == missing);
    refuses!(s, split_vertex, check_split_vertex(live, dead, DVec3::Z), e if e == missing);
}

#[test]
fn split_vertex_refuses_edges_of_two_vertices() {
    let mut s = hub(4);
    let (first, last) = (s.h(0, 1), s.h(1, 0));
    let expected = SplitVertexError::DifferentOrigins(s.v(0), s.v(1));
    refuses!(s, split_vertex, check_split_vertex(first, last, DVec3::Z), e if e == expected);
}

#[test]
fn split_vertex_refuses_to_take_all_edges() {
    let mut s = hub(4);
    let (first, last, v) = (s.h(0, 3), s.h(0, 4), s.v(0));
    refuses!(s, split_vertex, check_split_vertex(first, last, DVec3::Z), SplitVertexError::NothingLeft(w) if w == v);
    let mut s = faces(3, &[&[0, 1, 2]]);
    let (first, last, v) = (s.h(0, 2), s.h(0, 1), s.v(0));
    refuses!(s, split_vertex, check_split_vertex(first, last, DVec3::Z), SplitVertexError::NothingLeft(w) if w == v);
}

#[test]
fn split_vertex_refuses_a_position_that_is_not_finite() {
    let mut s = hub(4);
    let h = s.h(0, 1);
    refuses!(s, split_vertex, check_split_vertex(h, h, DVec3::NAN), SplitVertexError::NonFinite(_));
}
