//! Implicit smoothing against a dense solution, and its promises.

mod shapes;

use meshwright::glam::{DVec3, dvec3};
use meshwright::{
    Boundary, Control, IndexedMesh, Mesh, Progress, SmoothError, SmoothMethod, SmoothOptions, SmoothWeights,
    VertexKey,
};
use std::ops::ControlFlow;

fn implicit(weights: SmoothWeights) -> SmoothMethod {
    SmoothMethod::Implicit { weights, tolerance: 1e-12, max_steps: 2000 }
}

fn positions(mesh: &Mesh) -> Vec<DVec3> {
    mesh.to_indexed().positions().to_vec()
}

/// Weights of vertex pairs, from triangles: one for an edge, or the cotangents opposite it.
fn weights(pool: &IndexedMesh, kind: SmoothWeights) -> Vec<Vec<f64>> {
    let n = pool.vertex_count();
    let at = pool.positions();
    let mut w = vec![vec![0.0; n]; n];
    for f in pool.polygons().iter() {
        for i in 0..f.len() {
            let [a, b, c] = [0, 1, 2].map(|k| f[(i + k) % f.len()] as usize);
            let (u, v) = (at[a] - at[c], at[b] - at[c]);
            let one = match kind {
                SmoothWeights::Cotangent => w[a][b] + u.dot(v) / u.cross(v).length(),
                _ => 1.0,
            };
            (w[a][b], w[b][a]) = (one, one);
        }
    }
    w.iter_mut().flatten().for_each(|w| *w = w.max(0.0));
    w
}

/// (M + lambda (M - W)) x = M x0 by elimination, with rows of the identity for what stays.
fn dense(pool: &IndexedMesh, kind: SmoothWeights, lambda: f64, stays: &[bool]) -> Vec<DVec3> {
    let n = pool.vertex_count();
    let w = weights(pool, kind);
    let at = pool.positions();
    let mut rows: Vec<(Vec<f64>, DVec3)> = (0..n)
        .map(|v| {
            let mass: f64 = w[v].iter().sum();
            if stays[v] || mass == 0.0 {
                let unit = (0..n).map(|i| f64::from(u8::from(i == v))).collect();
                return (unit, at[v]);
            }
            let mut row: Vec<f64> = w[v].iter().map(|w| -lambda * w).collect();
            row[v] += mass * (1.0 + lambda);
            (row, at[v] * mass)
        })
        .collect();
    for i in 0..n {
        let pivot = (i..n).max_by(|&a, &b| rows[a].0[i].abs().total_cmp(&rows[b].0[i].abs())).expect("a row");
        rows.swap(i, pivot);
        let (row, right) = rows[i].clone();
        for (other, theirs) in
            rows.iter_mut().enumerate().filter(|(k, _)| *k != i).map(|(_, r)| (&mut r.0, &mut r.1))
        {
            let factor = other[i] / row[i];
            other.iter_mut().zip(&row).for_each(|(x, y)| *x -= factor * y);
            *theirs -= right * factor;
        }
    }
    (0..n).map(|i| rows[i].1 / rows[i].0[i]).collect()
}

#[test]
fn a_step_is_the_dense_solution() {
    for (name, pool) in [
        ("tetrahedron", shapes::tetrahedron()),
        ("sphere", shapes::icosphere(1)),
        ("cube", shapes::fanned(&shapes::cube())),
        ("grid", shapes::grid(5)),
    ] {
        let mesh = shapes::mesh(&pool);
        let open: Vec<bool> = mesh.vertices().map(|v| mesh.is_boundary_vertex(v)).collect();
        for kind in [SmoothWeights::Uniform, SmoothWeights::Cotangent] {
            for lambda in [0.1, 1.0, 25.0] {
                for (boundary, fixed) in [(Boundary::Fixed, true), (Boundary::Free, false)] {
                    let mut ours = mesh.clone();
                    let options =
                        SmoothOptions { method: implicit(kind), lambda, boundary, ..Default::default() };
                    ours.smooth(options).expect("solved");
                    let stays: Vec<bool> = open.iter().map(|&open| open && fixed).collect();
                    for (p, q) in positions(&ours).iter().zip(dense(&pool, kind, lambda, &stays)) {
                        assert!(p.distance(q) < 1e-9, "{name}, {kind:?}, {lambda}, {boundary:?}: {p} {q}");
                    }
                }
            }
        }
    }
}

#[test]
fn polygons_are_smoothed_by_their_one_ring() {
    let pool = shapes::cube();
    let mut mesh = shapes::mesh(&pool);
    mesh.smooth(SmoothOptions {
        method: implicit(SmoothWeights::Uniform),
        lambda: 3.0,
        ..Default::default()
    })
    .expect("solved");
    // Every vertex has three neighbours of its own kind, so the cube shrinks about its centre: by 1 + 2/3 lambda.
    for (p, q) in positions(&mesh).iter().zip(pool.positions()) {
        let expected = DVec3::splat(0.5) + (*q - DVec3::splat(0.5)) / 3.0;
        assert!(p.distance(expected) < 1e-9, "{p} {expected}");
    }
}

#[test]
fn a_large_step_does_what_many_small_ones_do() {
    let noisy = shapes::icosphere(3);
    let run = |method, lambda, iterations| {
        let mut mesh = shapes::mesh(&noisy);
        mesh.smooth(SmoothOptions { method, lambda, iterations, ..Default::default() }).expect("smoothed");
        mesh.closed().expect("closed").volume()
    };
    let before = shapes::mesh(&noisy).closed().expect("closed").volume();
    let (once, often) =
        (run(implicit(SmoothWeights::Uniform), 20.0, 1), run(SmoothMethod::Laplacian, 0.5, 40));
    assert!(once < before && (once - often).abs() < 0.1 * (before - often), "{before}: {once} {often}");
    let far = run(implicit(SmoothWeights::Cotangent), 1e6, 1);
    assert!((0.0..0.1 * before).contains(&far), "never inside out: {far}");
}

#[test]
fn locked_vertices_stay_to_the_bit_and_sliding_ones_stay_on_the_boundary() {
    let pool = shapes::grid(6);
    let mut mesh = shapes::mesh(&pool);
    let locked: Vec<VertexKey> = mesh.vertices().step_by(5).collect();
    let before: Vec<DVec3> = locked.iter().map(|&v| mesh.position(v)).collect();
    let method = implicit(SmoothWeights::Uniform);
    let options = SmoothOptions {
        method,
        lambda: 50.0,
        iterations: 3,
        boundary: Boundary::Free,
        locked: &locked,
        ..Default::default()
    };
    mesh.smooth(options).expect("solved");
    assert!(locked.iter().zip(before).all(|(&v, p)| mesh.position(v) == p));
    let mut flat = pool;
    flat.map_positions(|p| dvec3(p.x * p.x, p.y, 0.0)).expect("finite");
    let mut mesh = shapes::mesh(&flat);
    let sides = |mesh: &Mesh| mesh.bounds().expect("points");
    let old = sides(&mesh);
    let corners: Vec<VertexKey> = mesh
        .vertices()
        .filter(|&v| {
            let p = mesh.position(v);
            [old.min.x, old.max.x].contains(&p.x) && [old.min.y, old.max.y].contains(&p.y)
        })
        .collect();
    assert_eq!(corners.len(), 4);
    let boundary = Boundary::Slide;
    let options = SmoothOptions {
        method,
        lambda: 5.0,
        iterations: 20,
        boundary,
        locked: &corners,
        ..Default::default()
    };
    mesh.smooth(options).expect("solved");
    assert_eq!(sides(&mesh), old);
    for v in mesh.vertices().filter(|&v| mesh.is_boundary_vertex(v)) {
        let p = mesh.position(v);
        assert!([old.min.x, old.max.x].contains(&p.x) || [old.min.y, old.max.y].contains(&p.y), "{p}");
    }
}

#[test]
fn what_cannot_be_done_is_refused_and_changes_nothing() {
    let mut mesh = shapes::mesh(&shapes::icosphere(3));
    let before = mesh.to_indexed();
    let mut refused = |lambda: f64, tolerance: f64, max_steps: u32| {
        let method = SmoothMethod::Implicit { weights: SmoothWeights::Uniform, tolerance, max_steps };
        let error = mesh.smooth(SmoothOptions { method, lambda, ..Default::default() });
        assert_eq!(mesh.to_indexed(), before);
        error.expect_err("refused")
    };
    assert!(matches!(refused(100.0, 1e-12, 3), SmoothError::NotConverged { residual } if residual > 1e-12));
    assert_eq!(refused(100.0, 1e-12, 0), SmoothError::NotConverged { residual: 1.0 });
    for lambda in [0.0, -1.0, f64::INFINITY] {
        assert_eq!(refused(lambda, 1e-8, 10), SmoothError::BadLambda(lambda));
    }
    for tolerance in [0.0, 1.0, -1.0] {
        assert_eq!(refused(1.0, tolerance, 10), SmoothError::BadTolerance(tolerance));
    }
    assert!(matches!(refused(f64::NAN, 1e-8, 10), SmoothError::BadLambda(_)));
    assert!(matches!(refused(1.0, f64::NAN, 10), SmoothError::BadTolerance(_)));
    assert!(matches!(refused(f64::MAX, 1e-8, 10), SmoothError::NotConverged { .. }));
}

#[test]
fn nothing_to_solve_is_solved() {
    let method = implicit(SmoothWeights::Cotangent);
    assert_eq!(Mesh::default().smooth(SmoothOptions { method, ..Default::default() }), Ok(()));
    let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    let mut triangle = shapes::mesh(&shapes::pool(points.clone(), vec![vec![0, 1, 2]]));
    assert_eq!(triangle.smooth(SmoothOptions { method, ..Default::default() }), Ok(()));
    assert_eq!(positions(&triangle), points);
}

#[test]
fn a_cancelled_solution_changes_nothing() {
    let mut mesh = shapes::mesh(&shapes::icosphere(3));
    let before = mesh.to_indexed();
    let method = implicit(SmoothWeights::Cotangent);
    let mut seen = Vec::new();
    let mut watch = |p: Progress| {
        seen.push(p.fraction);
        if p.fraction > 0.5 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let control = Control::new(&mut watch);
    let stopped = mesh.smooth(SmoothOptions { method, lambda: 100.0, control, ..Default::default() });
    assert!(matches!(stopped, Err(SmoothError::Cancelled(_))));
    assert_eq!(mesh.to_indexed(), before);
    assert!(seen.is_sorted() && seen.len() > 3, "{seen:?}");
}
