use crate::{DVec3, Subject, does, faces, hinge, hub, refuses, subject};
use meshwright::{AddFaceError, AddVertexError, IndexedMesh, Mesh, Polygons};

fn points(n: usize) -> Subject {
    let all = (0..n).map(|i| DVec3::X * i as f64).collect();
    subject(&IndexedMesh::new(all, Polygons::new()).expect("points"))
}

#[test]
fn add_vertex_makes_an_isolated_vertex_last_in_order() {
    let mut s = hinge();
    assert_eq!(s.mesh.check_add_vertex(DVec3::Z), Ok(()));
    let v = s.mesh.add_vertex(DVec3::Z).expect("finite");
    s.mesh.validate().expect("valid");
    assert!(s.mesh.is_isolated(v));
    assert_eq!((s.mesh.position(v), s.number(v)), (DVec3::Z, 4));
}

#[test]
fn add_vertex_refuses_a_position_that_is_not_finite() {
    let mut s = hinge();
    refuses!(s, add_vertex, check_add_vertex(DVec3::NAN), AddVertexError::NonFinite(_));
    refuses!(s, add_vertex, check_add_vertex(DVec3::INFINITY), AddVertexError::NonFinite(DVec3::INFINITY));
}

#[test]
fn add_face_between_isolated_vertices_makes_all_edges() {
    let mut s = points(5);
    let corners: Vec<_> = [3, 1, 0, 4].map(|i| s.v(i)).to_vec();
    let new = does!(s, add_face, check_add_face(&corners));
    assert_eq!(s.corners(new.face), [3, 1, 0, 4]);
    assert_eq!(new.edges.as_slice(), [s.e(3, 1), s.e(1, 0), s.e(0, 4), s.e(4, 3)]);
    assert_eq!(s.mesh.boundary_loops().len(), 1);
}

#[test]
fn add_face_uses_boundary_edges_that_are_there() {
    let mut s = hinge();
    let v = s.vertex(DVec3::Z);
    // Across the edge 1-3, which the second triangle walks from 1 to 3.
    let (one, three, shared) = (s.v(1), s.v(3), s.e(1, 3));
    let new = does!(s, add_face, check_add_face(&[three, one, v]));
    assert_eq!((new.edges.len(), s.counts()), (2, [5, 7, 3]));
    assert!(!s.mesh.is_boundary_edge(shared));
}

#[test]
fn add_face_closes_the_last_hole() {
    let mut s = faces(4, &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3]]);
    let new = {
        let corners = [2, 0, 3].map(|i| s.v(i));
        does!(s, add_face, check_add_face(&corners))
    };
    assert!(new.edges.is_empty() && s.mesh.is_closed());
    assert_eq!(s.corners(new.face), [2, 0, 3]);
}

#[test]
fn add_face_fits_between_two_faces_of_one_fan() {
    // A hub with one of five triangles missing.
    let mut s = faces(6, &[&[0, 1, 2], &[0, 2, 3], &[0, 3, 4], &[0, 4, 5]]);
    let corners = [0, 5, 1].map(|i| s.v(i));
    let new = does!(s, add_face, check_add_face(&corners));
    assert_eq!(new.edges.as_slice(), [s.e(5, 1)]);
    assert!(!s.mesh.is_boundary_vertex(s.v(0)));
}

#[test]
fn a_box_can_be_built_face_by_face() {
    let cube = crate::shapes::cube();
    let mut mesh = Mesh::default();
    let keys: Vec<_> = cube.positions().iter().map(|&p| mesh.add_vertex(p).expect("finite")).collect();
    for f in cube.polygons().iter() {
        mesh.add_face(&f.iter().map(|&v| keys[v as usize]).collect::<Vec<_>>()).expect("fits");
        mesh.validate().expect("valid");
    }
    assert_eq!(mesh.to_indexed(), cube);
}

#[test]
fn add_face_refuses_a_dead_vertex() {
    let mut s = points(4);
    let dead = s.v(3);
    s.mesh.remove_vertex(dead).expect("isolated");
    let corners = [s.v(0), s.v(1), dead];
    refuses!(s, add_face, check_add_face(&corners), AddFaceError::Missing(v) if v == dead);
}

#[test]
fn add_face_refuses_fewer_than_three_corners() {
    let mut s = points(3);
    let corners = [s.v(0), s.v(1)];
    refuses!(s, add_face, check_add_face(&corners), AddFaceError::TooFewCorners(2));
    refuses!(s, add_face, check_add_face(&[]), AddFaceError::TooFewCorners(0));
}

#[test]
fn add_face_refuses_a_vertex_named_twice() {
    let mut s = points(3);
    let corners = [0, 1, 2, 1].map(|i| s.v(i));
    let twice = s.v(1);
    refuses!(s, add_face, check_add_face(&corners), AddFaceError::RepeatedVertex(v) if v == twice);
}

#[test]
fn add_face_refuses_a_third_face_at_an_edge() {
    let mut s = hinge();
    let v = s.vertex(DVec3::Z);
    let (corners, e) = ([s.v(1), s.v(2), v], s.e(1, 2));
    refuses!(s, add_face, check_add_face(&corners), AddFaceError::EdgeTaken(taken) if taken == e);
}

#[test]
fn add_face_refuses_the_wrong_winding() {
    let mut s = hinge();
    let v = s.vertex(DVec3::Z);
    // The second triangle walks from 1 to 3 itself.
    let (corners, e) = ([s.v(1), s.v(3), v], s.e(1, 3));
    refuses!(s, add_face, check_add_face(&corners), AddFaceError::EdgeTaken(taken) if taken == e);
}

#[test]
fn add_face_refuses_a_second_fan_on_the_boundary() {
    let mut s = hinge();
    let (v, w) = (s.vertex(DVec3::Z), s.vertex(DVec3::ONE));
    let (corners, pinched) = ([s.v(3), v, w], s.v(3));
    refuses!(s, add_face, check_add_face(&corners), AddFaceError::SecondFan(at) if at == pinched);
}

#[test]
fn add_face_refuses_a_vertex_with_faces_all_around() {
    let mut s = hub(5);
    let (v, w) = (s.vertex(DVec3::Z), s.vertex(DVec3::ONE));
    let (corners, hub) = ([s.v(0), v, w], s.v(0));
    refuses!(s, add_face, check_add_face(&corners), AddFaceError::SecondFan(at) if at == hub);
}

#[test]
fn add_face_refuses_the_back_of_the_only_face() {
    for n in [3, 4, 7] {
        let corners: Vec<u32> = (0..n).collect();
        let mut s = faces(n, &[&corners]);
        let back: Vec<_> = (0..n as usize).rev().map(|i| s.v(i)).collect();
        let front = s.f(0);
        refuses!(s, add_face, check_add_face(&back), AddFaceError::Duplicate(f) if f == front);
    }
}
