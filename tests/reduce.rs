//! Reduction: what it keeps, what it refuses, how good it is.

#[path = "corpus/mod.rs"]
mod corpus;
#[path = "shapes/mod.rs"]
mod shapes;

use meshwright::cleanup::{CleanOptions, clean};
use meshwright::glam::{DVec2, DVec3, dvec3};
use meshwright::{
    Cancelled, Control, EdgeKey, IndexedMesh, Mesh, Progress, ReduceError, ReduceOptions, ReduceTarget,
    Reduced, Rule, Stopped, VertexKey,
};
use proptest::prelude::*;
use std::ops::ControlFlow;

fn to(target: ReduceTarget) -> ReduceOptions<'static> {
    ReduceOptions { target, ..Default::default() }
}

fn faces(n: usize) -> ReduceOptions<'static> {
    to(ReduceTarget::Faces(n))
}

/// Reduces, and checks what holds of every reduction.
fn reduced(mesh: &mut Mesh, options: ReduceOptions<'_>) -> Reduced {
    let kept = |m: &Mesh| {
        let loops = m.boundary_loops().len();
        let euler = m.vertex_count() as i64 - m.edge_count() as i64 + m.face_count() as i64;
        (m.components().len(), loops, euler)
    };
    let (before, target) = (kept(mesh), options.target);
    let account = mesh.reduce(options).expect("reduces");
    assert_eq!(mesh.validate(), Ok(()));
    assert_eq!(kept(mesh), before, "components, boundary loops, Euler characteristic");
    assert_eq!(account.faces, mesh.face_count());
    let goal = match target {
        ReduceTarget::Faces(n) => n,
        ReduceTarget::Ratio(r) => (r * account.faces_before as f64) as usize,
        ReduceTarget::MaxError(e) => {
            assert!(account.max_error <= e);
            0
        }
    };
    assert_eq!(account.stopped == Stopped::Target, account.faces <= goal.max(1));
    assert!(
        account.faces == account.faces_before || account.faces + 1 >= goal,
        "never more than one collapse too far"
    );
    assert!(account.merged.iter().all(|&(v, w)| !mesh.contains_vertex(v) && mesh.contains_vertex(w)));
    account
}

fn sphere(levels: u32) -> Mesh {
    shapes::mesh(&shapes::icosphere(levels))
}

#[test]
fn a_sphere_comes_down_to_the_target() {
    let mut mesh = sphere(4);
    let account = reduced(&mut mesh, to(ReduceTarget::Ratio(0.1)));
    assert_eq!((account.faces_before, account.faces, account.stopped), (5120, 512, Stopped::Target));
    assert_eq!(account.collapses, account.merged.len());
    assert!(account.max_error > 0.0 && account.max_error < 0.05, "{}", account.max_error);
}

#[test]
fn the_volume_stays() {
    let mut mesh = sphere(4);
    let before = mesh.closed().expect("closed").volume();
    reduced(&mut mesh, faces(512));
    let after = mesh.closed().expect("closed").volume();
    assert!((after / before - 1.0).abs() < 1e-3, "{after} of {before}");
}

#[test]
fn a_tetrahedron_keeps_its_four_faces_and_says_why() {
    let mut mesh = shapes::mesh(&shapes::tetrahedron());
    let before = mesh.to_indexed();
    let account = reduced(&mut mesh, faces(1));
    assert_eq!((account.faces, account.collapses, account.stopped), (4, 0, Stopped::NoLegalCollapse));
    assert!(account.refusals.topology >= 6, "{:?}", account.refusals);
    assert_eq!(mesh.to_indexed(), before);
}

#[test]
fn a_sphere_ends_as_a_tetrahedron_or_little_more() {
    let mut mesh = sphere(2);
    let account = reduced(&mut mesh, faces(1));
    assert!(account.faces >= 4 && account.faces <= 20, "{account:?}");
    assert_ne!(account.stopped, Stopped::Target);
}

#[test]
fn a_torus_stays_a_torus() {
    let mut mesh = shapes::mesh(&shapes::fanned(&shapes::torus(24, 12)));
    let options = ReduceOptions { max_turn_degrees: 90.0, min_shape: 0.0, ..faces(1) };
    let account = reduced(&mut mesh, options);
    assert!((14..60).contains(&account.faces), "{account:?}");
}

#[test]
fn two_spheres_stay_two() {
    let two = shapes::both(&shapes::icosphere(2), &shapes::icosphere(3));
    reduced(&mut shapes::mesh(&two), faces(60));
}

#[test]
fn polygons_are_cut_first_on_record_and_only_if_need_be() {
    let mut mesh = shapes::mesh(&shapes::torus(12, 8));
    let all: Vec<_> = mesh.faces().collect();
    let account = reduced(&mut mesh, faces(50));
    assert_eq!((account.faces_before, account.cut), (96, all));
    let mut mesh = shapes::mesh(&shapes::torus(12, 8));
    let account = reduced(&mut mesh, faces(96));
    assert!(account.cut.is_empty() && mesh.faces().all(|f| mesh.degree(f) == 4));
}

#[test]
fn bad_input_is_refused_and_changes_nothing() {
    let mut mesh = shapes::mesh(&shapes::cube());
    let before = mesh.to_indexed();
    let mut refused = |options| mesh.reduce(options).expect_err("refused");
    assert_eq!(refused(faces(0)), ReduceError::NoFaces);
    for r in [0.0, -0.5, 1.5, f64::INFINITY] {
        assert_eq!(refused(to(ReduceTarget::Ratio(r))), ReduceError::BadRatio(r));
    }
    assert!(matches!(refused(to(ReduceTarget::Ratio(f64::NAN))), ReduceError::BadRatio(_)));
    assert_eq!(refused(to(ReduceTarget::MaxError(-1.0))), ReduceError::BadErrorBound(-1.0));
    assert!(matches!(refused(to(ReduceTarget::MaxError(f64::NAN))), ReduceError::BadErrorBound(_)));
    for options in [
        ReduceOptions { line_weight: f64::NAN, ..Default::default() },
        ReduceOptions { max_turn_degrees: 0.0, ..Default::default() },
        ReduceOptions { min_shape: 1.0, ..Default::default() },
        ReduceOptions { sharp_degrees: Some(f64::NAN), ..Default::default() },
    ] {
        assert!(matches!(refused(options), ReduceError::BadOption { .. }));
    }
    assert_eq!(mesh.to_indexed(), before);
    assert_eq!(Mesh::default().reduce(faces(4)), Err(ReduceError::Empty));
}

#[test]
fn a_call_cancelled_at_any_stage_changes_nothing() {
    let pool = shapes::both(&shapes::icosphere(4), &shapes::cube());
    let mut mesh = shapes::mesh(&pool);
    let mut stages = Vec::new();
    for stop in 0.. {
        let mut calls = 0;
        let mut hook = |p: Progress| {
            stages.push(p.stage);
            calls += 1;
            if calls > stop { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let options = ReduceOptions { control: Control::new(&mut hook), ..faces(100) };
        match mesh.reduce(options) {
            Err(error) => assert_eq!(error, ReduceError::Cancelled(Cancelled)),
            Ok(_) => break,
        }
        assert_eq!(mesh.to_indexed(), shapes::mesh(&pool).to_indexed());
    }
    stages.dedup();
    assert!(["copy", "collapse", "write"].iter().all(|s| stages.contains(s)), "{stages:?}");
}

#[test]
fn an_error_bound_is_kept_and_reached() {
    let mut found = Vec::new();
    for bound in [1e-4, 1e-3, 1e-2] {
        let account = reduced(&mut sphere(4), to(ReduceTarget::MaxError(bound)));
        assert_eq!(account.stopped, Stopped::ErrorBound);
        assert!(account.max_error > bound * 0.5, "{} of {bound}", account.max_error);
        found.push(account.faces);
    }
    assert!(found.is_sorted_by(|a, b| a > b), "{found:?}");
}

#[test]
fn an_error_bound_of_nothing_still_thins_out_what_is_flat() {
    let flat = shapes::grid(20);
    let points = flat.positions().iter().map(|p| p.with_z(0.0)).collect();
    let mut mesh = shapes::mesh(&IndexedMesh::new(points, flat.polygons().clone()).expect("valid"));
    let account = reduced(&mut mesh, to(ReduceTarget::MaxError(0.0)));
    assert!(account.faces <= 30, "{account:?}");
    let area = mesh.to_indexed().area();
    assert!((area - 400.0).abs() < 1e-5, "{area}");
}

#[test]
fn boundary_vertices_stay_on_a_straight_boundary() {
    let mut mesh = shapes::mesh(&shapes::grid(30));
    reduced(&mut mesh, faces(200));
    let rim: Vec<_> = mesh.vertices().filter(|&v| mesh.is_boundary_vertex(v)).collect();
    for &v in &rim {
        let p = mesh.position(v);
        let off = [p.x, 30.0 - p.x, p.y, 30.0 - p.y].into_iter().fold(f64::MAX, |m, d| m.min(d.abs()));
        assert!(off < 0.05, "{p}");
    }
    assert!(rim.len() < 60);
}

#[test]
fn sharp_edges_are_kept_by_angle() {
    // A fine cube: no vertex of an edge may leave it.
    let mut cube = shapes::mesh(&shapes::cube());
    for _ in 0..4 {
        split_all(&mut cube);
    }
    let options = ReduceOptions { sharp_degrees: Some(30.0), ..faces(12) };
    let account = reduced(&mut cube, options);
    assert!(account.faces == 12, "{account:?}");
    let corners: Vec<_> = cube.vertices().map(|v| cube.position(v)).collect();
    assert!(corners.iter().all(|p| p.to_array().iter().all(|&x| x == 0.0 || x == 1.0)), "{corners:?}");
}

/// Splits every edge, joins the middles around each corner.
fn split_all(mesh: &mut Mesh) {
    for f in mesh.faces().collect::<Vec<_>>() {
        mesh.triangulate_face(f).expect("can be cut");
    }
    let edges: Vec<EdgeKey> = mesh.edges().collect();
    let mut longest = edges;
    longest.sort_by(|&a, &b| length(mesh, b).total_cmp(&length(mesh, a)));
    for e in longest {
        let h = mesh.edge_halfedge(e);
        let middle = (mesh.position(mesh.origin(h)) + mesh.position(mesh.target(h))) / 2.0;
        mesh.split_edge(e, middle).expect("can be split");
    }
}

fn length(mesh: &Mesh, e: EdgeKey) -> f64 {
    let h = mesh.edge_halfedge(e);
    mesh.position(mesh.origin(h)).distance(mesh.position(mesh.target(h)))
}

#[test]
fn locked_vertices_and_edges_stay_where_they_are() {
    let mut mesh = sphere(3);
    let vertices: Vec<VertexKey> = mesh.vertices().step_by(20).collect();
    let edges: Vec<EdgeKey> = mesh.edges().step_by(50).collect();
    let places: Vec<DVec3> = vertices.iter().map(|&v| mesh.position(v)).collect();
    let ends = |mesh: &Mesh, e| {
        let h = mesh.edge_halfedge(e);
        [mesh.origin(h), mesh.target(h)].map(|v| (v, mesh.position(v)))
    };
    let before: Vec<_> = edges.iter().map(|&e| ends(&mesh, e)).collect();
    let options = ReduceOptions {
        locked_vertices: &vertices,
        locked_edges: &edges,
        target: ReduceTarget::Faces(10),
        ..Default::default()
    };
    let account = reduced(&mut mesh, options);
    assert_eq!(account.stopped, Stopped::NoLegalCollapse);
    assert!(account.refusals.locked > 0);
    for (&v, p) in vertices.iter().zip(places) {
        assert_eq!(mesh.get_position(v), Some(p));
    }
    for (&e, was) in edges.iter().zip(before) {
        assert_eq!(ends(&mesh, e), was);
    }
}

#[test]
fn what_is_left_keeps_its_keys_with_and_without_an_audience() {
    let original = sphere(4);
    let (mut alone, mut watched) = (original.clone(), original.clone());
    watched.record_changes();
    let (a, b) = (reduced(&mut alone, faces(600)), reduced(&mut watched, faces(600)));
    assert_eq!(a, b);
    assert_eq!(alone.to_indexed(), watched.to_indexed());
    assert_eq!(alone.numbering(), watched.numbering());
    assert!(alone.vertices().all(|v| original.contains_vertex(v)));
    assert!(alone.faces().all(|f| original.contains_face(f)));
    assert!(alone.edges().eq(watched.edges()));
    let told = watched.take_changes();
    let died =
        told.iter().filter(|c| matches!(c, meshwright::Change::VertexDied { into: Some(_), .. })).count();
    assert_eq!(died, a.collapses);
}

#[test]
fn a_reduction_can_be_taken_back() {
    let mut mesh = sphere(3);
    let (before, numbering) = (mesh.to_indexed(), mesh.numbering());
    let checkpoint = mesh.checkpoint();
    reduced(&mut mesh, faces(100));
    mesh.restore(checkpoint).expect("known");
    assert_eq!(mesh.validate(), Ok(()));
    assert_eq!((mesh.to_indexed(), mesh.numbering()), (before, numbering));
}

#[test]
fn columns_follow() {
    let mut mesh = sphere(4);
    let height = mesh.add_vertex_column(0.0, Rule::interpolate());
    let count = mesh.add_vertex_column(
        1u32,
        Rule::custom(|event, sources: &[(&u32, f64)]| match event {
            meshwright::Event::Merge => sources.iter().map(|s| *s.0).sum(),
            _ => *sources[0].0,
        }),
    );
    for v in mesh.vertices().collect::<Vec<_>>() {
        mesh.set_value(height, v, mesh.position(v).z).expect("live");
    }
    let vertices = mesh.vertex_count() as u32;
    reduced(&mut mesh, faces(1000));
    let sum: u32 = mesh.vertices().map(|v| *mesh.value(count, v)).sum();
    assert_eq!(sum, vertices, "every vertex went somewhere");
    let off = mesh.vertices().map(|v| (mesh.value(height, v) - mesh.position(v).z).abs()).fold(0.0, f64::max);
    assert!(off < 0.1, "{off}");
}

/// A cylinder of quads whose texture coordinates meet in a seam.
fn wrapped(n: u32, m: u32) -> Mesh {
    let point = |i: u32| {
        let (s, c) = (f64::from(i % n) / f64::from(n) * std::f64::consts::TAU).sin_cos();
        dvec3(c, s, f64::from(i / n) * 4.0 / f64::from(m))
    };
    let quad = |i: u32| {
        let (a, b) = (i / n * n + i % n, i / n * n + (i + 1) % n);
        vec![a, b, b + n, a + n]
    };
    let pool = shapes::pool((0..n * (m + 1)).map(point).collect(), (0..n * m).map(quad).collect());
    let mut mesh = shapes::mesh(&shapes::fanned(&pool));
    for f in mesh.faces().collect::<Vec<_>>() {
        let corners: Vec<_> = mesh.face_halfedges(f).collect();
        let turns: Vec<f64> = corners
            .iter()
            .map(|&h| {
                let p = mesh.position(mesh.origin(h));
                p.y.atan2(p.x).rem_euclid(std::f64::consts::TAU) / std::f64::consts::TAU
            })
            .collect();
        let wraps = turns.iter().any(|&t| t > 0.75);
        for (&h, &t) in corners.iter().zip(&turns) {
            let u = if wraps && t < 0.25 { t + 1.0 } else { t };
            let v = mesh.position(mesh.origin(h)).z;
            mesh.set_uv(h, Some(DVec2::new(u, v))).expect("a corner");
        }
    }
    mesh
}

#[test]
fn a_seam_of_texture_coordinates_stays_a_seam_where_it_was() {
    let mut mesh = wrapped(48, 24);
    let seam = |m: &Mesh| -> Vec<EdgeKey> { m.edges().filter(|&e| m.is_uv_seam(e)).collect() };
    assert_eq!(seam(&mesh).len(), 24);
    reduced(&mut mesh, to(ReduceTarget::Ratio(0.1)));
    let left = seam(&mesh);
    assert!(!left.is_empty() && left.len() < 12, "{}", left.len());
    let total: f64 = left.iter().map(|&e| length(&mesh, e)).sum();
    assert!((total - 4.0).abs() < 1e-6, "{total}");
    for h in mesh.halfedges().filter(|&h| !mesh.is_boundary(h)) {
        let (p, uv) = (mesh.position(mesh.origin(h)), mesh.uv(h).expect("everywhere"));
        let turn = p.y.atan2(p.x) / std::f64::consts::TAU;
        let off = (uv.x - turn).abs().min((uv.x - turn - 1.0).abs());
        assert!(off < 0.02 && (uv.y - p.z).abs() < 0.2, "{p} {uv}");
    }
}

#[test]
fn borders_of_groups_stay() {
    let mut mesh = shapes::mesh(&shapes::grid(24));
    for f in mesh.faces().collect::<Vec<_>>() {
        let x = mesh.face_vertices(f).map(|v| mesh.position(v).x).sum::<f64>() / 3.0;
        let name = if x < 12.0 { "left" } else { "right" };
        let group = meshwright::GroupName { name: name.to_owned(), ..Default::default() };
        mesh.set_group(f, Some(group)).expect("live");
    }
    reduced(&mut mesh, faces(100));
    for e in mesh.edges() {
        let h = mesh.edge_halfedge(e);
        let groups = [h, mesh.twin(h)].map(|h| mesh.face(h).and_then(|f| mesh.group(f)).cloned());
        if let [Some(a), Some(b)] = groups
            && a != b
        {
            for v in [mesh.origin(h), mesh.target(h)] {
                assert!((mesh.position(v).x - 12.0).abs() < 0.1, "{}", mesh.position(v));
            }
        }
    }
}

#[test]
fn scale_and_place_make_no_difference() {
    let pool = shapes::icosphere(3);
    let mut plain = shapes::mesh(&pool);
    reduced(&mut plain, faces(200));
    let size = |m: &Mesh| m.to_indexed().bounds().expect("points").max.x;
    for exponent in [-100, 100] {
        let scale = 2f64.powi(exponent);
        let points = pool.positions().iter().map(|&p| p * scale).collect();
        let mut mesh = shapes::mesh(&IndexedMesh::new(points, pool.polygons().clone()).expect("valid"));
        reduced(&mut mesh, faces(200));
        assert_eq!(size(&mesh), size(&plain) * scale, "a power of two changes no digit");
    }
    for (offset, scale) in [(1e6, 1.0), (0.0, 1e-30), (0.0, 1e30), (0.0, 1e-300), (0.0, 1e300), (-1e30, 1e22)]
    {
        let points = pool.positions().iter().map(|&p| p * scale + DVec3::splat(offset)).collect();
        let mut mesh = shapes::mesh(&IndexedMesh::new(points, pool.polygons().clone()).expect("valid"));
        let account = reduced(&mut mesh, faces(200));
        assert_eq!((account.faces, account.stopped), (200, Stopped::Target), "{offset} {scale}");
        assert!(account.max_error.is_finite());
    }
}

#[test]
fn all_points_at_one_place_do_no_harm() {
    let pool = shapes::icosphere(2);
    let points = vec![DVec3::ONE; pool.vertex_count()];
    let mut mesh = shapes::mesh(&IndexedMesh::new(points, pool.polygons().clone()).expect("valid"));
    let account = reduced(&mut mesh, faces(20));
    assert_eq!(account.max_error, 0.0);
}

/// Two hubs and a wavy ring of `n` vertices.
fn spindle(n: u32) -> IndexedMesh {
    let ring = (0..n).map(|i| {
        let turn = f64::from(i) / f64::from(n) * std::f64::consts::TAU;
        dvec3(turn.cos(), turn.sin(), 0.05 * (8.0 * turn).sin())
    });
    let points = ring.chain([DVec3::Z, -DVec3::Z]).collect();
    let pair = |i: u32| [[i, (i + 1) % n, n], [(i + 1) % n, i, n + 1]];
    IndexedMesh::from_triangles(points, &(0..n).flat_map(pair).collect::<Vec<_>>()).expect("valid")
}

#[test]
fn hubs_of_a_hundred_thousand_edges_are_no_trouble() {
    let mut mesh = shapes::mesh(&spindle(100_000));
    let start = std::time::Instant::now();
    let account = reduced(&mut mesh, faces(2000));
    assert_eq!((account.faces, account.stopped), (2000, Stopped::Target));
    assert!(start.elapsed().as_secs() < 60, "{:?}", start.elapsed());
}

#[test]
fn vertices_of_more_than_sixty_edges_are_collapsed() {
    let mut mesh = shapes::mesh(&spindle(200));
    let account = reduced(&mut mesh, faces(40));
    assert_eq!(account.faces, 40);
}

#[test]
fn the_order_of_the_input_is_kept_and_the_result_is_the_same_every_time() {
    let mut first = sphere(4);
    let mut second = sphere(4);
    assert_eq!(reduced(&mut first, faces(512)), reduced(&mut second, faces(512)));
    assert_eq!(first.to_indexed(), second.to_indexed());
}

/// The root of the mean squared distance of the original vertices to the nearest vertex' planes would need a search; the
/// distance to the unit sphere does not.
fn off_the_sphere(mesh: &Mesh) -> f64 {
    let middles = mesh.faces().map(|f| mesh.face_vertices(f).map(|v| mesh.position(v)).sum::<DVec3>() / 3.0);
    middles.map(|p| (p.length() - 1.0).abs()).sum::<f64>() / mesh.face_count() as f64
}

/// The naive twin: of all edges that may be collapsed, each time the one that the plain quadrics of all original faces
/// find cheapest, to the best of its ends and its middle.
fn reduced_naively(mesh: &mut Mesh, faces: usize) {
    let mut planes: std::collections::BTreeMap<VertexKey, Vec<(DVec3, DVec3, f64)>> = Default::default();
    for f in mesh.faces() {
        let [a, b, c]: [VertexKey; 3] =
            mesh.face_vertices(f).collect::<Vec<_>>().try_into().expect("a triangle");
        let [p, q, r] = [a, b, c].map(|v| mesh.position(v));
        let normal = (q - p).cross(r - p);
        for v in [a, b, c] {
            planes.entry(v).or_default().push((p, normal.normalize(), normal.length()));
        }
    }
    while mesh.face_count() > faces {
        let mut best: Option<(f64, meshwright::HalfedgeKey, DVec3)> = None;
        for e in mesh.edges() {
            let h = mesh.edge_halfedge(e);
            let ends = [mesh.origin(h), mesh.target(h)];
            let [p, q] = ends.map(|v| mesh.position(v));
            for at in [p, q, (p + q) / 2.0] {
                let cost: f64 =
                    ends.iter().flat_map(|v| &planes[v]).map(|(o, n, w)| w * n.dot(at - *o).powi(2)).sum();
                if best.is_none_or(|b| cost < b.0) && mesh.check_collapse(h, at).is_ok() {
                    best = Some((cost, h, at));
                }
            }
        }
        let (_, h, at) = best.expect("a legal collapse");
        let done = mesh.collapse(h, at).expect("checked");
        let moved = planes.remove(&done.dead_vertex).unwrap_or_default();
        planes.entry(done.vertex).or_default().extend(moved);
    }
}

#[test]
fn the_error_is_well_below_that_of_the_naive_twin() {
    let ball = shapes::icosphere(3);
    let points = ball.positions().iter().map(|p| p.normalize()).collect();
    let ball = IndexedMesh::new(points, ball.polygons().clone()).expect("valid");
    let (mut ours, mut naive) = (shapes::mesh(&ball), shapes::mesh(&ball));
    reduced(&mut ours, faces(200));
    reduced_naively(&mut naive, 200);
    let (ours, naive) = (off_the_sphere(&ours), off_the_sphere(&naive));
    assert!(ours < 0.8 * naive, "{ours} beside {naive}");
}

#[test]
fn closed_models_of_the_corpus_reduce_to_a_tenth_and_stay_what_they_are() {
    let Some(rows) = corpus::rows() else { return };
    let mut done = 0;
    for row in rows.iter().filter(|r| r.get("closed") == "yes" && r.count("faces") < 20_000) {
        let Ok(soup) = row.load() else { continue };
        let mut mesh = clean(&soup, CleanOptions::default()).expect("cleans").value;
        if mesh.face_count() > 0 {
            let account = reduced(&mut mesh, to(ReduceTarget::Ratio(0.1)));
            eprintln!("{}: {} -> {} {}", row.path, account.faces_before, account.faces, account.stopped);
            done += 1;
        }
    }
    assert!(done > 10, "{done} models");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn whatever_the_shape_what_must_stay_stays(
        n in 3u32..14, m in 3u32..10, kind in 0..4, keep in 1usize..200, noise in 0.0..1.5f64, seed: u64, sharp: bool,
    ) {
        let pool = match kind {
            0 => shapes::torus(n, m),
            1 => shapes::grid(n),
            2 => shapes::both(&shapes::icosphere(1 + n % 2), &shapes::grid(m)),
            _ => shapes::fanned(&shapes::torus(n, m)),
        };
        let mut random = shapes::Noise(seed);
        let shaken = pool.positions().iter().map(|&p| p + noise * dvec3(random.unit(), random.unit(), random.unit()));
        let mut mesh = shapes::mesh(&IndexedMesh::new(shaken.collect(), pool.polygons().clone()).expect("valid"));
        if random.below(2) == 0 {
            mesh.record_changes();
        }
        let sharp_degrees = sharp.then_some(30.0);
        reduced(&mut mesh, ReduceOptions { sharp_degrees, ..faces(keep) });
    }
}
