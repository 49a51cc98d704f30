//! Rows about smoothing and reducing, on the corpus.

use crate::{assert_met, few, reach, solids, volume};
use meshwright::glam::DVec3;
use meshwright::{
    Boundary, ClosestOptions, EdgeKey, FeatureOptions, HalfedgeKey, Mesh, ReduceOptions, ReduceTarget,
    SmoothError, SmoothMethod, SmoothOptions, Stopped, VertexKey,
};

fn smooth(mesh: &Mesh, options: SmoothOptions<'_>) -> Vec<DVec3> {
    let mut mesh = mesh.clone();
    mesh.smooth(options).expect("smoothed");
    mesh.vertices().map(|v| mesh.position(v)).collect()
}

/// For each vertex the weights of its neighbours by cotangents, none below zero; of triangles.
fn cotangents(mesh: &Mesh, v: VertexKey) -> Vec<(VertexKey, f64)> {
    let cotangent = |h: HalfedgeKey| {
        if mesh.is_boundary(h) {
            return 0.0;
        }
        let [a, b, o] = [h, mesh.next(h), mesh.prev(h)].map(|h| mesh.position(mesh.origin(h)));
        let (u, v) = (a - o, b - o);
        u.dot(v) / u.cross(v).length()
    };
    mesh.outgoing(v).map(|h| (mesh.target(h), (cotangent(h) + cotangent(mesh.twin(h))).max(0.0))).collect()
}

/// The smallest angle of all faces, in degrees.
fn least_angle(mesh: &Mesh) -> f64 {
    let inner = mesh.halfedges().filter(|&h| !mesh.is_boundary(h));
    let angle = |h| {
        let [a, b, c] = [mesh.prev(h), h, mesh.next(h)].map(|h| mesh.position(mesh.origin(h)));
        let (u, v) = (a - b, c - b);
        u.cross(v).length().atan2(u.dot(v))
    };
    inner.map(angle).fold(f64::INFINITY, f64::min).to_degrees()
}

#[test]
fn cotangent_and_implicit_steps_of_models_are_those_of_the_weights() {
    let mut met = 0;
    for (name, mesh) in solids() {
        // What hardly has an area has weights that are all rounding.
        if least_angle(mesh) < 0.5 {
            continue;
        }
        let vertices: Vec<VertexKey> = mesh.vertices().collect();
        let number = |v: VertexKey| vertices.binary_search(&v).expect("a vertex");
        let lambda = 0.7;
        let options = |method| SmoothOptions { method, lambda, ..Default::default() };
        let forward = smooth(mesh, options(SmoothMethod::Cotangent));
        let backward = smooth(mesh, options(SmoothMethod::Implicit));
        let (size, far) = reach(mesh);
        for (i, &v) in vertices.iter().enumerate() {
            let weights = cotangents(mesh, v);
            let sum: f64 = weights.iter().map(|w| w.1).sum();
            if sum < 1e-6 {
                continue;
            }
            let mean = |at: &dyn Fn(VertexKey) -> DVec3| {
                weights.iter().map(|&(w, c)| at(w) * (c / sum)).sum::<DVec3>()
            };
            let p = mesh.position(v);
            let expected = p + (mean(&|w| mesh.position(w)) - p) * lambda;
            assert!(forward[i].distance(expected) <= 1e-9 * (size + far), "{name}: {v:?}");
            // The pull at the places that are reached leads back.
            let back = backward[i] + (backward[i] - mean(&|w| backward[number(w)])) * lambda;
            assert!(back.distance(p) <= 1e-9 * (size + far), "{name}: {v:?}");
        }
        met += 1;
    }
    assert_met(met, 40);
}

#[test]
fn laplacian_smoothing_shrinks_models_and_taubin_less() {
    let mut met = 0;
    for (name, mesh) in solids().filter(|(_, mesh)| mesh.components().len() == 1 && mesh.face_count() >= 200)
    {
        let before = volume(mesh);
        if before.abs() < 1e-6 * reach(mesh).0.powi(3) {
            continue;
        }
        let left = |method| {
            let mut mesh = mesh.clone();
            mesh.smooth(SmoothOptions { method, iterations: 20, ..Default::default() }).expect("smoothed");
            volume(&mesh) / before
        };
        let [plain, taubin] = [SmoothMethod::Laplacian, SmoothMethod::Taubin { mu: -0.53 }].map(left);
        eprintln!("{name}: {plain:.4} {taubin:.4}");
        assert!((taubin - 1.0).abs() < (plain - 1.0).abs(), "{name}: {plain} {taubin}");
        met += usize::from((taubin - 1.0).abs() < 0.5 * (plain - 1.0).abs());
    }
    assert_met(met, 10);
}

/// How far a point lies from a segment.
fn off_segment(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    crate::naive::on_segment(p, a, b).distance(p)
}

#[test]
fn rims_of_models_stay_slide_or_move_and_locked_vertices_stay() {
    let mut met = 0;
    for (name, mesh) in few().iter().filter(|(_, mesh)| !mesh.is_closed()) {
        let vertices: Vec<VertexKey> = mesh.vertices().collect();
        let locked: Vec<VertexKey> = vertices.iter().copied().step_by(4).collect();
        let slack = 1e-12 * (reach(mesh).0 + reach(mesh).1);
        for method in [SmoothMethod::Laplacian, SmoothMethod::Cotangent, SmoothMethod::Implicit] {
            for boundary in [Boundary::Fixed, Boundary::Slide, Boundary::Free] {
                let options =
                    SmoothOptions { method, boundary, locked_vertices: &locked, ..Default::default() };
                let after = smooth(mesh, options);
                for (&v, p) in vertices.iter().zip(&after) {
                    let was = mesh.position(v);
                    if locked.contains(&v) || mesh.is_isolated(v) {
                        assert_eq!(*p, was, "{name}");
                    } else if mesh.is_boundary_vertex(v) {
                        let rim = mesh.outgoing(v).find(|&h| mesh.is_boundary(h)).expect("on the rim");
                        let [before, next] =
                            [mesh.prev(rim), mesh.next(rim)].map(|h| mesh.position(mesh.origin(h)));
                        match boundary {
                            Boundary::Fixed => assert_eq!(*p, was, "{name}"),
                            Boundary::Slide => {
                                let off = off_segment(*p, was, before).min(off_segment(*p, was, next));
                                assert!(off <= slack, "{name}: {off} off the rim");
                            }
                            _ => {}
                        }
                    }
                }
            }
        }
        let mut same = mesh.clone();
        for lambda in [0.0, -1.0, 1.5, f64::NAN] {
            let refused = same.smooth(SmoothOptions { lambda, ..Default::default() });
            assert!(matches!(refused, Err(SmoothError::BadLambda(_))), "{name}");
        }
        let method = SmoothMethod::Taubin { mu: -0.5 };
        assert!(same.smooth(SmoothOptions { method, ..Default::default() }).is_err(), "{name}");
        assert!(same.to_indexed() == mesh.to_indexed(), "{name}");
        met += 1;
    }
    assert_met(met, 40);
}

type Kept = (usize, usize, i64);

fn kept(mesh: &Mesh) -> Kept {
    (mesh.components().len(), mesh.boundary_loops().len(), mesh.euler_characteristic())
}

#[test]
fn open_models_reduce_with_locks_and_stay_of_their_kind_or_say_why_not() {
    let mut met = 0;
    for (name, model) in few().iter().filter(|(_, mesh)| !mesh.is_closed()) {
        let vertices: Vec<VertexKey> = model.vertices().step_by(11).collect();
        let edges: Vec<EdgeKey> = model.edges().step_by(23).collect();
        let ends = |mesh: &Mesh, e: EdgeKey| {
            let h = mesh.edge_halfedge(e);
            [mesh.origin(h), mesh.target(h)].map(|v| mesh.position(v))
        };
        let mut mesh = model.clone();
        let target = ReduceTarget::Ratio(0.2);
        let options =
            ReduceOptions { target, locked_vertices: &vertices, locked_edges: &edges, ..Default::default() };
        let account = mesh.reduce(options).expect("reduces");
        assert_eq!((kept(&mesh), mesh.validate()), (kept(model), Ok(())), "{name}");
        assert!(vertices.iter().all(|&v| mesh.get_position(v) == Some(model.position(v))), "{name}");
        assert!(edges.iter().all(|&e| mesh.contains_edge(e) && ends(&mesh, e) == ends(model, e)), "{name}");
        let refused = account.refusals;
        let why = refused.topology
            + refused.feature
            + refused.locked
            + refused.valence
            + refused.flip
            + refused.shape;
        assert!(
            account.stopped == Stopped::Target || why > 0 || mesh.face_count() <= 2,
            "{name}: {account:?}"
        );
        met += 1;
    }
    assert_met(met, 40);
}

#[test]
fn models_reduced_to_an_error_bound_tell_no_larger_error_and_stay_near() {
    let mut met = 0;
    let mut worst = [0.0f64; 2];
    for (name, model) in few().iter().filter(|(_, mesh)| mesh.face_count() >= 100) {
        let bound = 0.01 * reach(model).0;
        let mut mesh = model.clone();
        let target = ReduceTarget::MaxError(bound);
        let account = mesh.reduce(ReduceOptions { target, ..Default::default() }).expect("reduces");
        assert!(account.max_error <= bound && account.faces <= account.faces_before, "{name}");
        assert_eq!((kept(&mesh), mesh.validate()), (kept(model), Ok(())), "{name}");
        let (index, rim) = (
            model.index(),
            model.boundary_halfedges().map(|h| [model.origin(h), model.target(h)].map(|v| model.position(v))),
        );
        let rim: Vec<_> = rim.collect();
        for v in mesh.vertices().filter(|&v| !mesh.is_isolated(v)) {
            let p = mesh.position(v);
            // The bound is one on a mean over what a vertex stands for.
            let near =
                index.closest_point(p, ClosestOptions::default()).expect("asked well").expect("a point");
            worst[0] = worst[0].max(near.distance / bound);
            assert!(near.distance <= 8.0 * bound, "{name}: {} of {bound}", near.distance);
            if mesh.is_boundary_vertex(v) {
                let off = rim.iter().map(|&[a, b]| off_segment(p, a, b)).fold(f64::INFINITY, f64::min);
                worst[1] = worst[1].max(off / bound);
                assert!(off <= 3.0 * bound, "{name}: {off} of {bound} off the rim");
            }
        }
        met += 1;
    }
    eprintln!("at most {worst:.2?} of the bound off the surface and off the rim");
    assert_met(met, 40);
}

#[test]
fn sharp_edges_of_models_stay_sharp_when_they_are_reduced() {
    let mut met = 0;
    for (name, model) in solids().filter(|(_, mesh)| mesh.face_count() >= 100) {
        let mut mesh = model.clone();
        let target = ReduceTarget::Ratio(0.4);
        let options = ReduceOptions {
            target,
            sharp_degrees: Some(40.0),
            keep_seams: false,
            keep_groups: false,
            ..Default::default()
        };
        mesh.reduce(options).expect("reduces");
        // Where sharp edges met or ended, they still do.
        let features = model.feature_edges(FeatureOptions { degrees: 40.0, boundary: false });
        let mut uses = std::collections::BTreeMap::<VertexKey, u32>::new();
        for e in features {
            let h = model.edge_halfedge(e);
            [model.origin(h), model.target(h)].into_iter().for_each(|v| *uses.entry(v).or_default() += 1);
        }
        for (&v, _) in uses.iter().filter(|u| *u.1 != 2) {
            assert_eq!(mesh.get_position(v), Some(model.position(v)), "{name}: {v:?}");
            met += 1;
        }
    }
    assert_met(met, 200);
}

#[test]
fn models_reduced_to_half_fold_nothing_over_and_keep_their_volume() {
    let mut met = 0;
    for (name, model) in solids().filter(|(_, mesh)| mesh.face_count() >= 200) {
        let (before, size) = (volume(model), reach(model).0);
        if before.abs() < 1e-3 * size.powi(3) {
            continue;
        }
        let mut mesh = model.clone();
        mesh.reduce(ReduceOptions { target: ReduceTarget::Ratio(0.5), ..Default::default() })
            .expect("reduces");
        let kept = volume(&mesh) / before;
        eprintln!("{name}: {kept:.4}");
        assert!((kept - 1.0).abs() < 0.005, "{name}: {kept}");
        met += 1;
    }
    assert_met(met, 8);
}
