//! Slivers at boundaries.

use super::*;
use meshwright::{SliverAction, SliverObstacle};

fn flat(points: &[[f64; 2]], faces: &[&[u32]]) -> Mesh {
    let points = points.iter().map(|p| dvec3(p[0], p[1], 0.0)).collect();
    shapes::mesh(&shapes::pool(points, faces.iter().map(|f| f.to_vec()).collect()))
}

#[test]
fn a_cap_with_its_longest_edge_on_the_boundary_is_taken_off() {
    let mut mesh = flat(
        &[[0., 0.], [2., 0.], [1., 0.], [0., 1.], [2., 1.]],
        &[&[0, 1, 2], &[0, 2, 3], &[2, 4, 3], &[2, 1, 4]],
    );
    let account = resolve(&mut mesh);
    assert_eq!(account.resolved[0].action, SliverAction::Removed);
    assert_eq!((mesh.face_count(), mesh.vertex_count()), (3, 5));
}

#[test]
fn an_ear_without_width_is_drawn_in_at_last_and_its_length_told() {
    // The tip sticks out two units.
    let mut mesh = flat(&[[0., 0.], [1., 0.], [0., 1.], [3., 0.]], &[&[0, 1, 2], &[1, 0, 3]]);
    let account = resolve_any(&mut mesh, 1e-12);
    assert_eq!(account.left, []);
    assert_eq!((mesh.face_count(), mesh.vertex_count()), (1, 3));
    assert_eq!(account.moved, 2.0);
}

#[test]
fn a_needle_at_the_boundary_keeps_the_boundary_in_place() {
    let mut mesh = flat(
        &[[0., 0.], [2., 0.], [2., 2.], [0., 2.], [1., 1e-13]],
        &[&[0, 4, 3], &[4, 1, 2], &[4, 2, 3], &[0, 1, 4]],
    );
    resolve(&mut mesh);
    assert_eq!(mesh.face_count(), 3);
    let mut mesh = flat(
        &[[0., 0.], [2., 0.], [2., 2.], [0., 2.], [1., 0.], [1., 1e-13]],
        &[&[0, 4, 5], &[4, 1, 5], &[0, 5, 3], &[5, 1, 2], &[5, 2, 3]],
    );
    let bottom = mesh.vertices().nth(4).unwrap();
    resolve(&mut mesh);
    assert!(mesh.contains_vertex(bottom) || mesh.vertices().all(|v| mesh.position(v).y != 1e-13));
}

#[test]
fn a_neck_without_width_between_two_places_of_the_boundary_is_left_and_named() {
    let mut mesh = flat(
        &[[0., 0.], [0., 1e-14], [-1., 1.], [-1., -1.], [1., 1.], [1., -1.]],
        &[&[0, 1, 2], &[0, 2, 3], &[1, 0, 5], &[1, 5, 4]],
    );
    let account = resolve_any(&mut mesh, 1e-12);
    assert!(!account.left.is_empty() && account.left.iter().all(|l| l.obstacle == SliverObstacle::Pinch));
}

#[test]
fn a_triangle_without_area_alone_is_left_and_named() {
    let mut mesh = flat(&[[0., 0.], [2., 0.], [1., 0.]], &[&[0, 1, 2]]);
    let account = resolve_any(&mut mesh, 1e-12);
    assert_eq!(account.left.iter().map(|l| l.obstacle).collect::<Vec<_>>(), [SliverObstacle::WholeComponent]);
}
