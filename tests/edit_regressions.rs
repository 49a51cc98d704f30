//! What edit scripts found, each once.

use meshwright::glam::DVec3;
use meshwright::{IndexedMesh, Lineage, Mesh};

fn square() -> Mesh {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y];
    Mesh::build(&IndexedMesh::new(corners.to_vec(), vec![vec![0, 1, 2, 3]].into()).expect("a pool"))
        .expect("a mesh")
}

#[test]
fn a_face_keeps_its_first_corner_when_a_cut_ends_there() {
    let mut mesh = square();
    let f = mesh.faces().next().expect("a face");
    let corners: Vec<_> = mesh.face_halfedges(f).collect();
    let first = mesh.origin(corners[0]);
    mesh.split_face(corners[2], corners[0]).expect("a diagonal");
    assert_eq!(mesh.origin(mesh.face_halfedge(f)), first);
}

#[test]
fn a_state_from_before_the_recording_is_told_once_however_often_it_is_restored() {
    let mut mesh = square();
    let v = mesh.vertices().next().expect("a vertex");
    let before = mesh.checkpoint();
    mesh.remove_vertex(v).expect("a corner of the only face");
    mesh.record_changes();
    let mut lineage = Lineage::default();
    mesh.restore(before).expect("a checkpoint");
    lineage.extend(mesh.take_changes());
    let told = lineage.changes().len();
    assert!(told > 0);
    mesh.restore(before).expect("a checkpoint");
    lineage.extend(mesh.take_changes());
    assert_eq!(lineage.changes().len(), told);
    mesh.add_vertex(DVec3::ONE).expect("a position");
    mesh.restore(before).expect("a checkpoint");
    lineage.extend(mesh.take_changes());
    assert_eq!(lineage.changes().len(), told);
}
