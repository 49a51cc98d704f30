//! What becomes of values when elements are split, merged and moved.

use crate::shapes::{cube, grid, mesh, tetrahedron};
use crate::{halfedge, middle, two_squares, vertex, with_x};
use meshwright::glam::{DVec3, dvec3};
use meshwright::{Event, Mesh, Rule};
use std::sync::{Arc, Mutex};

#[test]
fn an_interpolated_value_goes_by_weight_when_an_edge_splits_and_collapses() {
    let (mut mesh, x) = with_x(Rule::interpolate());
    let h = halfedge(&mesh, DVec3::ZERO, DVec3::X);
    let new = mesh.split_edge(mesh.edge(h), DVec3::X * 0.25).expect("always");
    assert_eq!(*mesh.value(x, new.vertex), 0.25);
    let h = mesh.find_halfedge(new.vertex, vertex(&mesh, DVec3::X)).expect("the new half");
    let done = mesh.collapse(h, DVec3::X * 0.625).expect("a boundary edge");
    assert_eq!(*mesh.value(x, done.vertex), 0.625);
}

#[test]
fn an_averaged_value_is_the_mean_whatever_the_weights() {
    let (mut mesh, x) = with_x(Rule::average());
    let h = halfedge(&mesh, DVec3::ZERO, DVec3::X);
    let new = mesh.split_edge(mesh.edge(h), DVec3::X * 0.25).expect("always");
    assert_eq!(*mesh.value(x, new.vertex), 0.5);
    let f = mesh.face(middle(&mesh)).expect("the left square");
    let poked = mesh.poke_face(f, dvec3(0.1, 0.1, 0.0)).expect("finite");
    assert_eq!(*mesh.value(x, poked.vertex), (0.0 + 0.5 + 1.0 + 1.0 + 0.0) / 5.0);
}

#[test]
fn a_kept_value_is_that_of_the_nearer_end() {
    let (mut mesh, x) = with_x(Rule::keep());
    for (at, expected) in [(0.25, 0.0), (0.75, 1.0)] {
        let h = halfedge(&mesh, dvec3(0., 1., 0.), dvec3(1., 1., 0.));
        let mut other = mesh.clone();
        let new = other.split_edge(mesh.edge(h), dvec3(at, 1., 0.)).expect("always");
        assert_eq!(*other.value(x, new.vertex), expected);
    }
    let h = halfedge(&mesh, DVec3::ZERO, DVec3::X);
    let done = mesh.collapse(h, DVec3::X * 0.25).expect("a boundary edge");
    assert_eq!(*mesh.value(x, done.vertex), 0.0, "the position lies nearer to the vertex that is gone");
}

#[test]
fn a_reset_value_is_the_default_again() {
    let (mut mesh, x) = with_x(Rule::reset());
    let h = halfedge(&mesh, DVec3::ZERO, DVec3::X);
    let new = mesh.split_edge(mesh.edge(h), DVec3::X * 0.25).expect("always");
    assert_eq!(*mesh.value(x, new.vertex), -1.0);
    assert_eq!(*mesh.value(x, vertex(&mesh, DVec3::X)), 1.0, "nothing else");
}

#[test]
fn a_custom_rule_sees_splits_merges_and_moves() {
    type Seen = Arc<Mutex<Vec<(Event, Vec<f64>)>>>;
    let seen: Seen = Arc::default();
    let log = Arc::clone(&seen);
    let rule = Rule::custom(move |event, sources: &[(&f64, f64)]| {
        log.lock().expect("one thread").push((event, sources.iter().map(|s| s.1).collect()));
        *sources[0].0
    });
    let (mut mesh, _) = with_x(rule);
    let h = halfedge(&mesh, DVec3::ZERO, DVec3::X);
    let new = mesh.split_edge(mesh.edge(h), DVec3::X * 0.25).expect("always");
    assert_eq!(*seen.lock().expect("one thread"), [(Event::Split, vec![0.75, 0.25])]);
    mesh.set_position(new.vertex, DVec3::X * 0.5).expect("finite");
    assert_eq!(seen.lock().expect("one thread").last(), Some(&(Event::Move, vec![1.0])));
    let h = mesh.find_halfedge(new.vertex, vertex(&mesh, DVec3::X)).expect("the new half");
    mesh.collapse(h, DVec3::X * 0.625).expect("a boundary edge");
    // The survivor's own value comes first; then it moves.
    let all = seen.lock().expect("one thread");
    assert_eq!(all[2..], [(Event::Merge, vec![0.25, 0.75]), (Event::Move, vec![1.0])]);
}

#[test]
fn a_refused_edit_asks_no_rule() {
    let rule = Rule::custom(|_, _: &[(&f64, f64)]| panic!("asked"));
    let (mut mesh, x) = with_x(rule);
    assert!(mesh.collapse(middle(&mesh), DVec3::X).is_err());
    assert!(mesh.split_edge(mesh.edge(middle(&mesh)), DVec3::NAN).is_err());
    assert_eq!(*mesh.value(x, vertex(&mesh, DVec3::X)), 1.0);
}

#[test]
fn an_edges_halves_keep_its_value_and_edges_that_become_one_are_merged() {
    let mut mesh = mesh(&grid(4));
    let mark = mesh.add_edge_column(false, Rule::custom(|_, s: &[(&bool, f64)]| s.iter().any(|s| *s.0)));
    let e = mesh.edges().find(|&e| !mesh.is_boundary_edge(e)).expect("inner");
    mesh.set_value(mark, e, true).expect("live");
    let new =
        mesh.split_edge_and_faces(e, mesh.position(mesh.origin(mesh.edge_halfedge(e))) + DVec3::X * 0.1);
    let new = new.expect("finite");
    assert!(*mesh.value(mark, new.edge) && *mesh.value(mark, e));
    assert!(new.cuts.iter().all(|c| !*mesh.value(mark, c.edge)), "a cut is made from nothing");
    // Collapse an edge beside the marked one, so that one of a triangle's sides is it.
    let before = mesh.edges().filter(|&e| *mesh.value(mark, e)).count();
    let h = mesh.find_halfedge(new.vertex, mesh.target(mesh.edge_halfedge(new.cuts[0].edge))).expect("a cut");
    mesh.collapse_into_target(h).expect("inside");
    let after = mesh.edges().filter(|&e| *mesh.value(mark, e)).count();
    assert_eq!((before, after), (2, 2), "both halves live on as the other sides of the triangles that went");
}

#[test]
fn faces_hand_their_value_to_their_parts_and_are_merged_by_area() {
    let mut mesh = two_squares();
    let area = mesh.add_face_column(0.0f64, Rule::interpolate());
    let [left, right] = [0, 1].map(|i| mesh.numbering().faces[i]);
    mesh.set_value(area, left, 10.0).expect("live");
    mesh.set_value(area, right, 40.0).expect("live");
    let poked = mesh.poke_face(left, dvec3(0.5, 0.5, 0.0)).expect("finite");
    assert!(poked.faces.iter().all(|&f| *mesh.value(area, f) == 10.0));
    // The triangle beside the right square has a quarter of its area.
    let joined = mesh.join_faces(mesh.edge(middle(&mesh))).expect("a triangle and a square");
    assert!((*mesh.value(area, joined.face) - (10.0 * 0.2 + 40.0 * 0.8)).abs() < 1e-12);
    let dissolved = mesh.dissolve_vertex(poked.vertex).expect("inside");
    assert!((*mesh.value(area, dissolved.faces[0]) - 25.0).abs() < 1e-12);
}

#[test]
fn what_is_made_from_nothing_holds_the_default() {
    let mut mesh = mesh(&tetrahedron());
    let (on_vertices, on_faces) =
        (mesh.add_vertex_column(1, Rule::keep()), mesh.add_face_column(2, Rule::keep()));
    let (on_corners, on_edges) =
        (mesh.add_corner_column(3, Rule::keep()), mesh.add_edge_column(4, Rule::keep()));
    let all = |mesh: &Mesh| {
        assert!(mesh.vertices().all(|v| *mesh.value(on_vertices, v) == 1));
        assert!(mesh.faces().all(|f| *mesh.value(on_faces, f) == 2));
        assert!(mesh.halfedges().all(|h| *mesh.value(on_corners, h) == 3));
        assert!(mesh.edges().all(|e| *mesh.value(on_edges, e) == 4));
    };
    all(&mesh);
    let f = mesh.faces().next().expect("four");
    mesh.set_value(on_faces, f, 20).expect("live");
    let corner = mesh.face_halfedge(f);
    mesh.set_value(on_corners, corner, 30).expect("live");
    mesh.remove_face(f).expect("closed");
    assert_eq!(*mesh.value(on_corners, corner), 3, "the half-edge lost its corner");
    mesh.fill_hole(corner).expect("a hole");
    let v = mesh.add_vertex(DVec3::ONE).expect("finite");
    let w = mesh.add_vertex(DVec3::X * 9.0).expect("finite");
    let u = mesh.add_vertex(DVec3::Y * 9.0).expect("finite");
    mesh.add_face(&[v, w, u]).expect("a component of its own");
    all(&mesh);
}

#[test]
fn slots_that_are_reused_forget_what_they_held() {
    let mut mesh = two_squares();
    let column = mesh.add_face_column(0, Rule::keep());
    let f = mesh.numbering().faces[1];
    mesh.set_value(column, f, 9).expect("live");
    mesh.remove_face(f).expect("an end");
    let corners = [DVec3::X, DVec3::X * 2.0, dvec3(2., 1., 0.), dvec3(1., 1., 0.)].map(|p| vertex(&mesh, p));
    let new = mesh.add_face(&corners).expect("where it was").face;
    assert_eq!((mesh.get_value(column, f), *mesh.value(column, new)), (None, 0));
}

#[test]
fn a_corner_keeps_its_value_when_its_face_is_cut() {
    let mut mesh = mesh(&cube());
    let column = mesh.add_corner_column(String::new(), Rule::keep());
    let name = |mesh: &Mesh, h| format!("{:?} {:?}", mesh.position(mesh.origin(h)), 0);
    for h in mesh.halfedges().collect::<Vec<_>>() {
        mesh.set_value(column, h, name(&mesh, h)).expect("closed");
    }
    for f in mesh.faces().collect::<Vec<_>>() {
        mesh.triangulate_face(f).expect("a square");
    }
    for e in mesh.edges().collect::<Vec<_>>() {
        let _ = mesh.flip_edge(e);
    }
    for h in mesh.halfedges() {
        assert_eq!(*mesh.value(column, h), name(&mesh, h));
    }
}

#[test]
fn reversing_moves_corner_data_with_the_corners() {
    let mut mesh = mesh(&grid(3));
    let column = mesh.add_corner_column(DVec3::ZERO, Rule::keep());
    let inner: Vec<_> = mesh.halfedges().filter(|&h| !mesh.is_boundary(h)).collect();
    for &h in &inner {
        mesh.set_value(column, h, mesh.position(mesh.origin(h))).expect("inner");
    }
    mesh.reverse();
    assert!(inner.iter().all(|&h| *mesh.value(column, h) == mesh.position(mesh.origin(h))));
}
