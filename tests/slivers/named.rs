//! Closed shapes with slivers of every kind.

use super::*;
use meshwright::{Cancelled, Control, SliverAction, SliverError, SliverKind, SliverObstacle};
use std::ops::ControlFlow;

fn cube() -> Mesh {
    shapes::mesh(&shapes::fanned(&shapes::cube()))
}

fn build(points: &[[f64; 3]], faces: &[&[u32]]) -> Mesh {
    let points = points.iter().map(|&p| p.into()).collect();
    shapes::mesh(&shapes::pool(points, faces.iter().map(|f| f.to_vec()).collect()))
}

#[test]
fn a_mesh_without_slivers_is_left_as_it_is() {
    for pool in [shapes::cube(), shapes::torus(12, 8), bracket(), shapes::grid(5), shapes::icosphere(2)] {
        let mut mesh = shapes::mesh(&pool);
        assert_eq!(resolve(&mut mesh).found, 0);
        assert_eq!(mesh.to_indexed(), pool);
    }
}

#[test]
fn a_cap_on_an_edge_of_a_cube_is_merged() {
    let mut mesh = cube();
    let e = edge(&mesh, 0, 1);
    put_cap(&mut mesh, e, 0.3, false);
    let account = resolve(&mut mesh);
    assert_eq!(account.resolved.len(), 1);
    let [one] = account.resolved[..] else { panic!() };
    assert_eq!((one.sliver.kind, one.action), (SliverKind::Cap, SliverAction::Merged));
    assert!(one.sliver.height < 1e-15 && one.moved < 1e-15);
    assert_eq!(mesh.face_count(), 14);
}

#[test]
fn a_cap_next_to_a_square_goes_into_it_and_the_square_stays_one_face() {
    let mut mesh = shapes::mesh(&shapes::cube());
    let e = edge(&mesh, 0, 1);
    put_cap(&mut mesh, e, 0.25, false);
    resolve(&mut mesh);
    let mut degrees: Vec<usize> = mesh.faces().map(|f| mesh.degree(f)).collect();
    degrees.sort_unstable();
    assert_eq!(degrees, [4, 4, 4, 4, 5, 5]);
}

#[test]
fn a_needle_of_a_doubled_vertex_is_collapsed() {
    for cut in [false, true] {
        for offset in [DVec3::ZERO, dvec3(1e-14, 0.0, 0.0), dvec3(1e-13, -1e-14, 3e-14)] {
            let mut mesh = cube();
            let v = mesh.vertices().nth(3).unwrap();
            put_needle(&mut mesh, v, 0, offset, cut);
            let account = resolve(&mut mesh);
            assert!(account.resolved.iter().all(|r| r.sliver.kind == SliverKind::Needle));
            assert!(account.resolved.iter().all(|r| r.action == SliverAction::Collapsed));
            assert_eq!((mesh.vertex_count(), mesh.face_count()), (8, 12));
        }
    }
}

#[test]
fn a_needle_keeps_the_end_on_the_feature() {
    // A corner of the cube, and beside it a vertex within a face: the corner stays where it is.
    let mut mesh = cube();
    let corner = mesh.vertices().next().unwrap();
    let near = mesh.position(corner) + dvec3(1e-12, 2e-12, 0.0);
    let f = mesh.faces_around(corner).find(|&f| mesh.face_normal(f) == DVec3::NEG_Z).unwrap();
    mesh.poke_face(f, near).unwrap();
    resolve(&mut mesh);
    assert!(
        mesh.vertices()
            .all(|v| mesh.position(v).abs().max_element() == 0.0 || mesh.position(v).max_element() == 1.0)
    );
    assert!(mesh.vertices().any(|v| mesh.position(v) == DVec3::ZERO));
}

#[test]
fn two_caps_that_face_each_other_are_resolved() {
    // Between two triangles, a gap of two caps with their longest edge in common.
    let mut mesh = cube();
    let e = edge(&mesh, 0, 1);
    put_cap(&mut mesh, e, 0.3, false);
    let e = edge(&mesh, 0, 1);
    put_cap(&mut mesh, e, 0.6, true);
    assert!(mesh.slivers(1e-12).len() >= 2);
    resolve(&mut mesh);
}

#[test]
fn a_strip_of_caps_along_an_edge_is_resolved() {
    for is_fan in [false, true] {
        let mut mesh = cube();
        for i in 1..40 {
            // Always the edge from 0 to 1, or what is left of it.
            let v: Vec<VertexKey> = mesh.vertices().collect();
            let e = if is_fan {
                mesh.find_halfedge(v[0], v[1])
            } else {
                mesh.find_halfedge(v[0], v[v.len() - 1])
            };
            let Some(h) = e.or(mesh.find_halfedge(v[0], v[1])) else { break };
            let e = mesh.edge(h);
            put_cap(&mut mesh, e, 1.0 - 1.0 / f64::from(i + 1), i % 2 == 0);
        }
        assert!(mesh.slivers(1e-12).len() > 5, "{}", mesh.slivers(1e-12).len());
        resolve(&mut mesh);
    }
}

#[test]
fn a_fan_of_faces_without_area_around_a_vertex_is_resolved() {
    // An edge of a cube, opened to a polygon without width, with a vertex in it.
    let mut mesh = cube();
    let e = edge(&mesh, 0, 1);
    let v: Vec<VertexKey> = mesh.vertices().collect();
    put_cap(&mut mesh, e, 0.5, false);
    let cap = mesh.slivers(1e-12)[0].face;
    for share in [0.2, 0.4, 0.7] {
        let along = mesh.position(v[0]).lerp(mesh.position(v[1]), share);
        let f = mesh.slivers(1e-12).iter().map(|s| s.face).max_by_key(|&f| mesh.degree(f)).unwrap_or(cap);
        mesh.poke_face(f, along).unwrap();
    }
    assert!(mesh.slivers(1e-12).len() >= 7);
    resolve(&mut mesh);
}

#[test]
fn a_region_that_is_one_point_is_resolved() {
    // A sphere on which a whole disc has been drawn to one place.
    let mut mesh = shapes::mesh(&shapes::icosphere(3));
    let top = mesh.vertices().next().unwrap();
    let at = mesh.position(top);
    let near: Vec<VertexKey> = mesh.vertices().filter(|&v| mesh.position(v).distance(at) < 0.5).collect();
    assert!(near.len() > 30);
    near.into_iter().for_each(|v| mesh.set_position(v, at).unwrap());
    resolve(&mut mesh);
}

#[test]
fn a_region_that_is_one_segment_is_resolved() {
    let mut mesh = shapes::mesh(&shapes::icosphere(3));
    let top = mesh.vertices().next().unwrap();
    let at = mesh.position(top);
    let near: Vec<VertexKey> = mesh.vertices().filter(|&v| mesh.position(v).distance(at) < 0.5).collect();
    for v in near {
        let x = mesh.position(v).x - at.x;
        mesh.set_position(v, at + DVec3::X * x).unwrap();
    }
    let tolerance = mesh.propose_sliver_tolerance();
    let account = resolve_any(&mut mesh, tolerance);
    assert_eq!(account.left, []);
}

#[test]
fn a_square_without_width_or_folded_on_itself_is_resolved() {
    // A square face of a cube drawn to a segment, and to the diagonal.
    for to in [
        [[0., 0., 1.], [1., 0., 1.], [1., 0., 1.], [0., 0., 1.]],
        [[0., 0., 1.], [0.5, 0.5, 1.], [1., 1., 1.], [0.5, 0.5, 1.]],
    ] {
        let mut mesh = shapes::mesh(&shapes::cube());
        let v: Vec<VertexKey> = mesh.vertices().collect();
        for (v, p) in [v[4], v[5], v[7], v[6]].into_iter().zip(to) {
            mesh.set_position(v, p.into()).unwrap();
        }
        let tolerance = mesh.propose_sliver_tolerance();
        assert!(!mesh.slivers(tolerance).is_empty());
        let account = resolve_any(&mut mesh, tolerance);
        assert_eq!(account.left, [], "{to:?}");
        assert_eq!(by_brute_force(&mesh, 0.99 * tolerance), []);
    }
}

#[test]
fn a_polygon_that_the_rule_would_cut_badly_is_cut_well() {
    // A prism over a triangle with many vertices on one slanted side.
    let side = (1..20).map(|i| dvec3(1.0, 0.1, 0.3).lerp(dvec3(0.2, 1.3, 0.7), f64::from(i) / 20.0));
    let base: Vec<DVec3> = [dvec3(0., 0., 0.), dvec3(1.0, 0.1, 0.3)]
        .into_iter()
        .chain(side)
        .chain([dvec3(0.2, 1.3, 0.7)])
        .collect();
    let k = base.len() as u32;
    let points = base.iter().copied().chain(base.iter().map(|&p| p + dvec3(0.1, 0.2, 1.0))).collect();
    let sides = (0..k).map(|i| vec![i, (i + 1) % k, (i + 1) % k + k, i + k]);
    let faces = sides.chain([(0..k).rev().collect(), (k..2 * k).collect()]).collect();
    let mut mesh = shapes::mesh(&shapes::pool(points, faces));
    resolve(&mut mesh);
    assert!(mesh.faces().all(|f| mesh.degree(f) > 2));
}

#[test]
fn a_needle_in_a_loop_of_three_edges_is_collapsed_after_a_split() {
    // Two pyramids on a common triangle whose short edge has ends joined to the third corner outside of their own faces.
    let (a, b, x) = ([0., 0., 0.], [0., 1e-14, 0.], [3., 0., 0.]);
    let mut mesh = build(
        &[a, b, x, [1., 0.5, 1.], [1., -0.5, 1.], [1., 0.5, -1.], [1., -0.5, -1.]],
        &[
            &[0, 1, 3],
            &[1, 2, 3],
            &[0, 3, 4],
            &[3, 2, 4],
            &[4, 2, 0],
            &[1, 0, 5],
            &[2, 1, 5],
            &[0, 6, 5],
            &[5, 6, 2],
            &[6, 0, 2],
        ],
    );
    let account = resolve(&mut mesh);
    assert!(account.splits > 0);
}

#[test]
fn a_tetrahedron_with_a_short_edge_becomes_a_pillow() {
    let mut mesh = build(
        &[[0., 0., 0.], [0., 1e-14, 0.], [1., 0., 0.], [1., 1., 0.]],
        &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]],
    );
    let account = resolve(&mut mesh);
    assert_eq!(account.splits, 1);
    assert!(mesh.is_closed());
}

#[test]
fn a_component_without_area_is_left_and_named() {
    let line = [[0., 0., 0.], [1., 0., 0.], [2., 0., 0.], [3., 0., 0.]];
    let mut mesh = build(&line, &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]]);
    let account = resolve_any(&mut mesh, 1e-12);
    assert!(!account.left.is_empty());
    assert!(account.left.iter().all(|l| l.obstacle == SliverObstacle::WholeComponent));
    let mut points = vec![DVec3::ZERO; 26];
    points.iter_mut().zip(0..).for_each(|(p, i)| p.x = f64::from(i % 3));
    let cube = shapes::fanned(&shapes::cube());
    let pool = shapes::pool(
        cube.positions().iter().map(|p| dvec3(p.x, 0., 0.)).collect(),
        cube.polygons().iter().map(<[u32]>::to_vec).collect(),
    );
    let mut mesh = shapes::mesh(&shapes::both(&pool, &shapes::cube_at(dvec3(5., 0., 0.))));
    let account = resolve_any(&mut mesh, 1e-12);
    assert!(account.left.iter().all(|l| l.obstacle == SliverObstacle::WholeComponent), "{:?}", account.left);
}

#[test]
fn bad_tolerances_are_refused_and_a_cancelled_call_changes_nothing() {
    let mut mesh = cube();
    let e = edge(&mesh, 0, 1);
    put_cap(&mut mesh, e, 0.3, false);
    let before = mesh.to_indexed();
    for bad in [f64::NAN, -1.0, f64::INFINITY] {
        let refused = mesh.resolve_slivers(SliverOptions::new(bad));
        assert!(matches!(refused, Err(SliverError::BadTolerance(_))));
        assert_eq!(mesh.slivers(-1.0), []);
    }
    for stop_at in 0..2 {
        let mut calls = 0;
        let mut hook = |_| {
            calls += 1;
            if calls > stop_at { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let options = SliverOptions { tolerance: 1e-12, control: Control::new(&mut hook) };
        assert_eq!(mesh.resolve_slivers(options), Err(SliverError::Cancelled(Cancelled)));
        assert_eq!(mesh.to_indexed(), before);
    }
}

#[test]
fn a_tolerance_of_zero_takes_only_what_has_no_area() {
    let mut mesh = cube();
    let e = edge(&mesh, 0, 1);
    put_cap(&mut mesh, e, 0.5, false);
    let v = mesh.vertices().nth(7).unwrap();
    put_needle(&mut mesh, v, 0, dvec3(0.0, 1e-300, 1e-14), true);
    let account = resolve_any(&mut mesh, 0.0);
    assert_eq!((account.resolved.len(), account.moved), (1, 0.0));
}

#[test]
fn any_scale_and_any_tolerance_give_a_valid_mesh() {
    for scale in [1e-300, 1e-150, 1e150, 1e300] {
        let mut mesh = cube();
        let e = edge(&mesh, 0, 1);
        put_cap(&mut mesh, e, 0.3, false);
        mesh.scale(scale, DVec3::ZERO).unwrap();
        let tolerance = mesh.propose_sliver_tolerance();
        let account = mesh.resolve_slivers(SliverOptions::new(tolerance)).unwrap();
        assert_eq!((account.resolved.len(), account.left.len()), (1, 0), "{scale}");
        assert_eq!(mesh.validate(), Ok(()));
    }
    for tolerance in [0.01, 0.3, 1.0, 10.0, f64::MAX] {
        for pool in [shapes::torus(12, 8), shapes::grid(6), bracket(), shapes::icosphere(2)] {
            let mut mesh = shapes::mesh(&pool);
            let before = facts(&mesh);
            let account = mesh.resolve_slivers(SliverOptions::new(tolerance)).unwrap();
            assert_eq!((mesh.validate(), facts(&mesh)), (Ok(()), before));
            assert_eq!(account.found + account.arose, account.resolved.len() + account.left.len());
        }
    }
}

#[test]
fn columns_checkpoints_and_the_record_of_changes_see_every_step() {
    use meshwright::{Lineage, Rule};
    let mut mesh = cube();
    let groups = mesh.add_face_column(0u32, Rule::keep());
    for (f, i) in mesh.faces().collect::<Vec<_>>().into_iter().zip(0..) {
        mesh.set_value(groups, f, i).unwrap();
    }
    let e = edge(&mesh, 0, 1);
    put_cap(&mut mesh, e, 0.3, false);
    let before = mesh.to_indexed();
    let numbering = mesh.numbering();
    mesh.record_changes();
    let checkpoint = mesh.checkpoint();
    resolve(&mut mesh);
    let lineage = Lineage::of(mesh.take_changes());
    let maps = lineage.maps(&numbering, &mesh.numbering());
    assert_eq!((maps.faces.old_of(0).len(), mesh.face_count()), (1, 14));
    mesh.restore(checkpoint).unwrap();
    assert_eq!(mesh.to_indexed(), before);
}

#[cfg(feature = "serde")]
#[test]
fn the_account_serialises() {
    let mut mesh = cube();
    let e = edge(&mesh, 0, 1);
    put_cap(&mut mesh, e, 0.3, false);
    let json = serde_json::to_value(resolve(&mut mesh)).unwrap();
    assert_eq!((&json["found"], &json["resolved"][0]["action"]), (&1.into(), &"merged".into()));
    assert_eq!(json["resolved"][0]["sliver"]["kind"], SliverKind::Cap.as_str());
}
