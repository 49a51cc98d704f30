use crate::shapes::cube;
use crate::{DVec3, does, hinge, refuses, subject};
use meshwright::PokeFaceError;

#[test]
fn poke_makes_as_many_triangles_as_the_face_had_corners() {
    let mut s = subject(&cube());
    let f = s.f(1);
    let new = does!(s, poke_face, check_poke_face(f, DVec3::Z * 2.0));
    assert_eq!((s.counts(), s.mesh.valence(new.vertex)), ([9, 16, 9], 4));
    assert_eq!(s.corners(f), [4, 5, 8], "the face is the triangle at its first edge");
    let others: Vec<_> = new.faces.iter().map(|&f| s.corners(f)).collect();
    assert_eq!(others, [[5, 7, 8], [7, 6, 8], [6, 4, 8]]);
    let spokes: Vec<_> =
        new.edges.iter().map(|&e| s.number(s.mesh.origin(s.mesh.edge_halfedge(e)))).collect();
    assert_eq!(spokes, [4, 5, 7, 6]);
}

#[test]
fn poke_a_triangle_on_the_boundary_leaves_the_boundary_alone() {
    let mut s = hinge();
    let (f, boundary) = (s.f(0), s.mesh.boundary_loops());
    let new = does!(s, poke_face, check_poke_face(f, DVec3::ONE / 3.0));
    assert_eq!((s.counts(), new.faces.len()), ([5, 8, 4], 2));
    assert_eq!(s.mesh.boundary_loops(), boundary);
    assert!(!s.mesh.is_boundary_vertex(new.vertex));
}

#[test]
fn poke_refuses_a_dead_face() {
    let mut s = hinge();
    let f = s.f(0);
    s.mesh.remove_face(f).expect("can be removed");
    refuses!(s, poke_face, check_poke_face(f, DVec3::X), PokeFaceError::Missing(dead) if dead == f);
}

#[test]
fn poke_refuses_a_position_that_is_not_finite() {
    let mut s = hinge();
    let f = s.f(0);
    refuses!(
        s,
        poke_face,
        check_poke_face(f, DVec3::NEG_INFINITY),
        PokeFaceError::NonFinite(DVec3::NEG_INFINITY)
    );
}
