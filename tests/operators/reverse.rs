use crate::shapes::{both, cube, cube_at, tetrahedron};
use crate::{DVec3, hinge, squares, subject};
use meshwright::MissingFace;

#[test]
fn reverse_component_turns_every_face_of_one_component() {
    let mut s = subject(&both(&cube(), &cube_at(DVec3::X * 5.0)));
    let f = s.f(0);
    assert_eq!(s.mesh.check_reverse_component(f), Ok(()));
    s.mesh.reverse_component(f).expect("a live face");
    s.mesh.validate().expect("valid");
    assert_eq!((s.corners(s.f(0)), s.corners(s.f(6))), (vec![0, 1, 3, 2], vec![8, 10, 11, 9]));
    assert_eq!(s.mesh.closed().expect("closed").volume(), 0.0);
}

#[test]
fn reverse_twice_is_the_identity_on_open_and_closed_meshes() {
    for pool in [cube(), tetrahedron(), squares(3).mesh.to_indexed()] {
        let mut s = subject(&pool);
        let before = crate::state(&s.mesh);
        let f = s.f(1);
        for _ in 0..2 {
            s.mesh.reverse_component(f).expect("a live face");
            s.mesh.validate().expect("valid");
        }
        assert!(crate::state(&s.mesh) == before);
        s.mesh.reverse();
        s.mesh.reverse();
        assert!(crate::state(&s.mesh) == before);
    }
}

#[test]
fn every_half_edge_stays_with_its_face() {
    let mut s = squares(2);
    let faces: Vec<_> = s.mesh.halfedges().map(|h| (h, s.mesh.face(h), s.mesh.origin(h))).collect();
    s.mesh.reverse();
    for (h, f, origin) in faces {
        assert_eq!((s.mesh.face(h), s.mesh.target(h)), (f, origin));
    }
}

#[test]
fn reverse_component_refuses_a_dead_face() {
    let mut s = hinge();
    let f = s.f(0);
    s.mesh.remove_face(f).expect("can be removed");
    let before = crate::state(&s.mesh);
    assert_eq!(s.mesh.check_reverse_component(f), Err(MissingFace(f)));
    assert_eq!(s.mesh.reverse_component(f), Err(MissingFace(f)));
    assert!(crate::state(&s.mesh) == before);
}
