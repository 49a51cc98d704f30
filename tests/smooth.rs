//! Smoothing: meaning, shrinkage, boundaries, refusals.

mod igl;
#[path = "tutorial/naive.rs"]
mod naive;
mod shapes;

use igl::Igl;
use meshwright::glam::{DVec3, dvec3};
use meshwright::{Boundary, Control, IndexedMesh, Mesh, Progress, SmoothError, SmoothMethod, SmoothOptions};
use proptest::prelude::*;
use std::ops::ControlFlow;

const METHODS: [SmoothMethod; 4] = [
    SmoothMethod::Laplacian,
    SmoothMethod::Taubin { mu: -0.53 },
    SmoothMethod::Cotangent,
    SmoothMethod::Implicit,
];

fn smooth(mesh: &mut Mesh, options: SmoothOptions<'_>) {
    mesh.smooth(options).expect("smoothed");
    assert_eq!(mesh.validate(), Ok(()));
}

fn positions(mesh: &Mesh) -> Vec<DVec3> {
    mesh.to_indexed().positions().to_vec()
}

fn unit_sphere(levels: u32) -> Mesh {
    let mut pool = shapes::icosphere(levels);
    pool.map_positions(DVec3::normalize).expect("finite");
    shapes::mesh(&pool)
}

fn volume(mesh: &Mesh) -> f64 {
    mesh.closed().expect("closed").volume()
}

#[test]
fn laplacian_smoothing_equals_the_tutorials_loop_on_any_faces() {
    for pool in [shapes::cube(), shapes::torus(6, 5), shapes::icosphere(2), shapes::grid(4)] {
        let mesh = shapes::mesh(&pool);
        for iterations in [1, 3] {
            for (boundary, free) in [(Boundary::Fixed, false), (Boundary::Free, true)] {
                let mut ours = mesh.clone();
                smooth(&mut ours, SmoothOptions { lambda: 0.7, iterations, boundary, ..Default::default() });
                let on_boundary: Vec<bool> = mesh.vertices().map(|v| mesh.is_boundary_vertex(v)).collect();
                let expected =
                    naive::laplacian(&(&pool).into(), 0.7, iterations, |v| !free && on_boundary[v]);
                for (p, q) in positions(&ours).iter().zip(expected) {
                    assert!(p.distance(q) < 1e-12, "{p} {q}");
                }
            }
        }
    }
}

#[test]
fn neighbours_of_a_polygon_are_the_one_ring_and_not_the_diagonals() {
    let mut cube = shapes::mesh(&shapes::cube());
    smooth(&mut cube, SmoothOptions { lambda: 1.0, ..Default::default() });
    assert!(positions(&cube)[0].distance(DVec3::splat(1.0 / 3.0)) < 1e-15);
}

#[test]
fn the_update_is_simultaneous() {
    // In place, the order of vertices would show: a turned cube would smooth to something else.
    let mut cube = shapes::mesh(&shapes::cube());
    smooth(&mut cube, SmoothOptions { lambda: 0.5, iterations: 3, ..Default::default() });
    let center = DVec3::splat(0.5);
    let sizes: Vec<f64> = positions(&cube).iter().map(|p| p.distance(center)).collect();
    assert!(sizes.iter().all(|s| (s - sizes[0]).abs() < 1e-15));
}

#[test]
fn laplacian_smoothing_shrinks_and_taubin_hardly() {
    // On a sphere of 80 thousand triangles a thousand steps leave three quarters of the volume.
    let sphere = unit_sphere(6);
    let mut shrunk = sphere.clone();
    smooth(&mut shrunk, SmoothOptions { lambda: 0.5, iterations: 1000, ..Default::default() });
    let ratio = volume(&shrunk) / volume(&sphere);
    assert!((ratio - 0.764).abs() < 0.005, "{ratio}");
    for (levels, expected) in [(3, 1.047), (4, 1.012), (5, 1.003), (6, 1.0009)] {
        let sphere = unit_sphere(levels);
        let mut kept = sphere.clone();
        let method = SmoothMethod::Taubin { mu: -0.53 };
        smooth(&mut kept, SmoothOptions { method, iterations: 50, ..Default::default() });
        let ratio = volume(&kept) / volume(&sphere);
        assert!((ratio - expected).abs() < 1e-3, "{levels}: {ratio}");
    }
}

#[test]
fn taubin_smooths_noise_away_and_keeps_the_volume() {
    let mut noise = shapes::Noise(4);
    let sphere = unit_sphere(4);
    let mut rough = sphere.clone();
    rough.deform(|p| p * (1.0 + 0.05 * (noise.unit() - 0.5)), Default::default()).expect("finite");
    let roughness = |mesh: &Mesh| -> f64 {
        let of = |v| {
            let ring: Vec<DVec3> = mesh.neighbors(v).map(|w| mesh.position(w)).collect();
            let mean = ring.iter().sum::<DVec3>() / ring.len() as f64;
            (mesh.position(v).length() - mean.length()).abs()
        };
        mesh.vertices().map(of).sum::<f64>() / mesh.vertex_count() as f64
    };
    let before = roughness(&rough);
    let method = SmoothMethod::Taubin { mu: -0.53 };
    smooth(&mut rough, SmoothOptions { method, iterations: 50, ..Default::default() });
    assert!(roughness(&rough) < 0.3 * before);
    assert!((volume(&rough) / volume(&sphere) - 1.0).abs() < 0.02);
}

#[test]
fn the_cotangent_step_is_libigls() {
    let mut igl = Igl::start();
    for pool in [shapes::icosphere(2), shapes::icosphere(3), shapes::fanned(&shapes::cube())] {
        let theirs = igl.call(&pool, "cotmatrix");
        let (pull, diagonal) = (theirs.points("laplacian"), theirs.numbers("diagonal"));
        let mut mesh = shapes::mesh(&pool);
        let lambda = 0.8;
        smooth(&mut mesh, SmoothOptions { method: SmoothMethod::Cotangent, lambda, ..Default::default() });
        for (v, (p, q)) in positions(&mesh).iter().zip(pool.positions()).enumerate() {
            let expected = *q - pull[v] / diagonal[v] * lambda;
            assert!(p.distance(expected) < 1e-9, "vertex {v}: {p} {expected}");
        }
    }
}

/// For each vertex the mean of what `of` says of its neighbours, weighted by cotangents at the pool's positions that are
/// not below zero; none without a weight. Triangles only.
fn weighted_means(pool: &IndexedMesh, of: &[DVec3]) -> Vec<Option<DVec3>> {
    let mut weights = std::collections::BTreeMap::<[u32; 2], f64>::new();
    for t in pool.polygons().iter() {
        for i in 0..3 {
            let [a, b, apex] = [0, 1, 2].map(|k| t[(i + k) % 3]);
            let [p, q, o] = [a, b, apex].map(|v| pool.positions()[v as usize]);
            let (u, v) = (p - o, q - o);
            *weights.entry([a.min(b), a.max(b)]).or_default() += u.dot(v) / u.cross(v).length();
        }
    }
    let mut sums = vec![(DVec3::ZERO, 0.0); of.len()];
    for ([a, b], weight) in weights {
        for (v, w) in [(a, b), (b, a)] {
            sums[v as usize].0 += of[w as usize] * weight.max(0.0);
            sums[v as usize].1 += weight.max(0.0);
        }
    }
    sums.into_iter().map(|(sum, weight)| (weight > 0.0).then(|| sum / weight)).collect()
}

#[test]
fn an_implicit_step_goes_where_its_pull_leads_back_to_where_it_was() {
    for pool in [shapes::icosphere(2), shapes::fanned(&shapes::torus(9, 7)), shapes::grid(6)] {
        for lambda in [0.01, 0.7, 10.0, 1000.0, 10_000.0] {
            let mut mesh = shapes::mesh(&pool);
            let rim: Vec<bool> = mesh.vertices().map(|v| mesh.is_boundary_vertex(v)).collect();
            smooth(&mut mesh, SmoothOptions { method: SmoothMethod::Implicit, lambda, ..Default::default() });
            let after = positions(&mesh);
            for (v, mean) in weighted_means(&pool, &after).into_iter().enumerate() {
                let (x, p) = (after[v], pool.positions()[v]);
                let back = mean.filter(|_| !rim[v]).map_or(x, |mean| x + (x - mean) * lambda);
                assert!(back.distance(p) < 1e-11 * (1.0 + lambda), "{lambda}, vertex {v}: {back} {p}");
            }
        }
    }
}

#[test]
fn a_short_implicit_step_is_a_forward_one_and_a_long_one_stays_in_the_box() {
    let mut noise = shapes::Noise(8);
    let mut rough = unit_sphere(3);
    rough.deform(|p| p * (1.0 + 0.1 * noise.unit()), Default::default()).expect("finite");
    let stepped = |method, lambda| {
        let mut mesh = rough.clone();
        smooth(&mut mesh, SmoothOptions { method, lambda, ..Default::default() });
        mesh
    };
    let [backward, forward] =
        [SmoothMethod::Implicit, SmoothMethod::Cotangent].map(|method| positions(&stepped(method, 1e-5)));
    assert!(backward.iter().zip(&forward).all(|(p, q)| p.distance(*q) < 1e-9));
    let mut before = volume(&rough);
    for lambda in [1.0, 10.0, 100.0, 10_000.0] {
        let mesh = stepped(SmoothMethod::Implicit, lambda);
        let (inner, outer) = (mesh.bounds().expect("vertices"), rough.bounds().expect("vertices"));
        assert!(inner.min.cmpge(outer.min).all() && inner.max.cmple(outer.max).all());
        assert!(volume(&mesh) < before, "a longer step shrinks more");
        before = volume(&mesh);
    }
}

#[test]
fn an_implicit_step_obeys_locks_and_boundaries() {
    let pool = shapes::grid(6);
    for boundary in [Boundary::Fixed, Boundary::Slide, Boundary::Free] {
        let mut mesh = shapes::mesh(&pool);
        let locked: Vec<_> = mesh.vertices().filter(|&v| mesh.position(v).x == 3.0).collect();
        let rim: Vec<_> = mesh.vertices().filter(|&v| mesh.is_boundary_vertex(v)).collect();
        let method = SmoothMethod::Implicit;
        smooth(
            &mut mesh,
            SmoothOptions { method, lambda: 50.0, boundary, locked: &locked, ..Default::default() },
        );
        let moved =
            |v| mesh.position(v) != pool.positions()[mesh.vertices().position(|w| w == v).expect("there")];
        assert!(!locked.iter().any(|&v| moved(v)), "{boundary:?}");
        assert_eq!(rim.iter().any(|&v| moved(v)), boundary != Boundary::Fixed, "{boundary:?}");
        assert!(mesh.vertices().filter(|&v| moved(v)).count() > 15, "{boundary:?}");
    }
}

#[test]
fn cotangent_weights_hardly_slide_vertices_within_a_plane() {
    // An uneven flat grid: its vertices are where they should be, whatever their spacing.
    let mut pool = shapes::grid(6);
    pool.map_positions(|p| dvec3(p.x * p.x, p.y + 0.3 * p.x, 0.0)).expect("finite");
    let mesh = shapes::mesh(&pool);
    let moved = |method| {
        let mut mesh = mesh.clone();
        smooth(&mut mesh, SmoothOptions { method, ..Default::default() });
        positions(&mesh).iter().zip(pool.positions()).map(|(p, q)| p.distance(*q)).fold(0.0, f64::max)
    };
    assert!(moved(SmoothMethod::Cotangent) < 0.3 * moved(SmoothMethod::Laplacian));
}

#[test]
fn degenerate_triangles_do_no_harm() {
    let mut points: Vec<DVec3> = shapes::tetrahedron().positions().to_vec();
    points[3] = DVec3::X * 0.5;
    let faces = shapes::tetrahedron().polygons().clone();
    let flat = IndexedMesh::new(points, faces).expect("a valid vertex pool");
    let mut same = shapes::tetrahedron();
    same.map_positions(|_| DVec3::ONE).expect("finite");
    for pool in [flat, same] {
        for method in METHODS {
            let mut mesh = shapes::mesh(&pool);
            smooth(&mut mesh, SmoothOptions { method, iterations: 20, ..Default::default() });
            assert!(positions(&mesh).iter().all(|p| p.is_finite() && p.length() < 2.0));
        }
    }
}

#[test]
fn a_clamped_step_never_leaves_the_box() {
    // Needles have obtuse angles and negative weights: taken as they are, they would throw vertices out.
    let mut pool = shapes::icosphere(2);
    pool.map_positions(|p| dvec3(p.x, p.y * 1e-3, p.z)).expect("finite");
    let bounds = pool.bounds().expect("vertices");
    let mut mesh = shapes::mesh(&pool);
    let method = SmoothMethod::Cotangent;
    smooth(&mut mesh, SmoothOptions { method, lambda: 1.0, iterations: 30, ..Default::default() });
    let after = mesh.bounds().expect("vertices");
    assert!(after.min.cmpge(bounds.min - 1e-12).all() && after.max.cmple(bounds.max + 1e-12).all());
}

#[test]
fn boundaries_stay_slide_or_move() {
    let pool = shapes::grid(6);
    let mesh = shapes::mesh(&pool);
    let boundary: Vec<usize> =
        (0..).zip(mesh.vertices()).filter(|b| mesh.is_boundary_vertex(b.1)).map(|b| b.0).collect();
    let moved = |boundary| {
        let mut mesh = mesh.clone();
        smooth(&mut mesh, SmoothOptions { boundary, iterations: 5, ..Default::default() });
        positions(&mesh)
    };
    let (fixed, free) = (moved(Boundary::Fixed), moved(Boundary::Free));
    for &v in &boundary {
        assert_eq!(fixed[v], pool.positions()[v]);
        assert_ne!(free[v], pool.positions()[v]);
    }
    // A flat sheet whose boundary is unevenly spaced: sliding keeps it on its lines, and evens it out.
    let mut flat = shapes::grid(6);
    let spread = |x: f64| x * x / 6.0;
    flat.map_positions(|p| dvec3(spread(p.x), spread(p.y), 0.0)).expect("finite");
    let mut sliding = shapes::mesh(&flat);
    let corners: Vec<_> = [0, 6, 42, 48].map(|v| sliding.vertices().nth(v).expect("there")).to_vec();
    let options =
        SmoothOptions { boundary: Boundary::Slide, iterations: 3, locked: &corners, ..Default::default() };
    smooth(&mut sliding, options);
    for (p, q) in positions(&sliding).iter().zip(flat.positions()) {
        for axis in 0..2 {
            for line in [0.0, 6.0] {
                assert!(q[axis] != line || (p[axis] - line).abs() < 1e-12, "{q} {p}");
            }
        }
    }
    let first = positions(&sliding)[1].x;
    assert!(first > spread(1.0), "the short side grew: {first}");
    let even = shapes::grid(4);
    let flat_even = {
        let mut pool = even;
        pool.map_positions(|p| dvec3(p.x, p.y, 0.0)).expect("finite");
        pool
    };
    let mut still = shapes::mesh(&flat_even);
    smooth(&mut still, SmoothOptions { boundary: Boundary::Slide, iterations: 9, ..Default::default() });
    for (v, p) in (0..).zip(positions(&still)) {
        let key = still.vertices().nth(v).expect("there");
        if still.is_boundary_vertex(key) {
            assert!(
                p.distance(flat_even.positions()[v]) < 1e-12,
                "evenly spaced, corners included, it stays"
            );
        }
    }
}

#[test]
fn locked_and_isolated_vertices_keep_their_position_to_the_bit() {
    let mut points = shapes::icosphere(1).positions().to_vec();
    points[5] *= 1.0 / 3.0;
    points.push(DVec3::splat(1e-310));
    let pool =
        IndexedMesh::new(points, shapes::icosphere(1).polygons().clone()).expect("a valid vertex pool");
    let mut mesh = shapes::mesh(&pool);
    let locked: Vec<_> = [0, 5, 9].iter().map(|&v| mesh.vertices().nth(v).expect("there")).collect();
    smooth(&mut mesh, SmoothOptions { locked: &locked, iterations: 50, ..Default::default() });
    let after = positions(&mesh);
    for v in [0, 5, 9, pool.vertex_count() - 1] {
        assert_eq!(after[v], pool.positions()[v]);
    }
    assert_ne!(after[1], pool.positions()[1]);
}

#[test]
fn factors_out_of_range_and_dead_keys_are_refused_and_change_nothing() {
    let mut mesh = shapes::mesh(&shapes::cube());
    let before = mesh.to_indexed();
    for lambda in [0.0, -0.5, 1.1, f64::NAN, f64::INFINITY] {
        let refused = mesh.smooth(SmoothOptions { lambda, ..Default::default() });
        assert!(matches!(refused, Err(SmoothError::BadLambda(_))), "{lambda}");
    }
    for mu in [-0.5, -0.4, 0.6, 0.0, f64::NAN, f64::NEG_INFINITY] {
        let refused =
            mesh.smooth(SmoothOptions { method: SmoothMethod::Taubin { mu }, ..Default::default() });
        assert!(matches!(refused, Err(SmoothError::BadMu { .. })), "{mu}");
    }
    let other = shapes::mesh(&shapes::torus(5, 5));
    let stranger = other.vertices().last().expect("there");
    let refused = mesh.smooth(SmoothOptions { locked: &[stranger], ..Default::default() });
    assert_eq!(refused, Err(SmoothError::Missing(stranger)));
    let method = SmoothMethod::Taubin { mu: -1e300 };
    let refused = mesh.smooth(SmoothOptions { method, iterations: 9, ..Default::default() });
    assert!(matches!(refused, Err(SmoothError::OutOfRange(_))));
    assert_eq!(mesh.to_indexed(), before);
}

#[test]
fn a_call_cancelled_half_way_changes_nothing() {
    let mut mesh = shapes::mesh(&shapes::cube());
    let before = mesh.to_indexed();
    for stop in 0..10 {
        let mut count = 0;
        let mut hook = |_: Progress| {
            count += 1;
            if count > stop { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let options =
            SmoothOptions { iterations: 10, control: Control::new(&mut hook), ..Default::default() };
        assert!(matches!(mesh.smooth(options), Err(SmoothError::Cancelled(_))), "{stop}");
        assert_eq!(mesh.to_indexed(), before);
    }
}

#[test]
fn the_largest_and_smallest_numbers_are_smoothed_like_others() {
    for size in [1e-300, 1e300, f64::MAX] {
        for method in [SmoothMethod::Laplacian, SmoothMethod::Cotangent, SmoothMethod::Implicit] {
            let options = || SmoothOptions { method, iterations: 2, ..Default::default() };
            let mut pool = shapes::icosphere(1);
            pool.map_positions(|p| p.normalize()).expect("finite");
            let mut plain = shapes::mesh(&pool);
            smooth(&mut plain, options());
            pool.map_positions(|p| p * size).expect("finite");
            let mut mesh = shapes::mesh(&pool);
            smooth(&mut mesh, options());
            for (p, q) in positions(&mesh).iter().zip(positions(&plain)) {
                assert!((*p / size).distance(q) < 1e-12, "{size}");
            }
        }
    }
}

proptest! {
    #[test]
    fn smoothing_does_not_depend_on_how_vertices_are_numbered(seed in any::<u64>(), method in prop::sample::select(METHODS.to_vec())) {
        let pool = shapes::icosphere(1);
        let shuffled = shapes::shuffled(&pool, seed);
        let run = |pool: &IndexedMesh| {
            let mut mesh = shapes::mesh(pool);
            smooth(&mut mesh, SmoothOptions { method, iterations: 3, ..Default::default() });
            positions(&mesh)
        };
        let (a, b) = (run(&pool), run(&shuffled));
        for (p, q) in pool.positions().iter().zip(&a) {
            let same = shuffled.positions().iter().position(|s| s == p).expect("the same points");
            prop_assert!(b[same].distance(*q) < 1e-12);
        }
    }
}
