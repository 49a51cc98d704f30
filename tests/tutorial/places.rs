//! Rows about where things are: deform, rays, reduce, nearest elements.

use crate::naive::{self, Plain};
use crate::shapes::{self, Noise, cube, fanned, mesh};
use crate::{models, somewhere};
use meshwright::glam::{DVec3, dvec3};
use meshwright::{
    ClosestOptions, Crossing, DeformOptions, Feature, IndexedMesh, Mesh, Ray, RayHit, ReduceOptions,
    ReduceTarget, Side,
};

const ALL: ClosestOptions = ClosestOptions { max_distance: f64::INFINITY, isolated_vertices: true };

fn hits(mesh: &Mesh, origin: DVec3, direction: DVec3) -> Vec<RayHit> {
    mesh.index().hits(&Ray::new(origin, direction).expect("a ray"))
}

#[test]
fn deform_takes_the_tutorials_wave() {
    let pool = shapes::grid(8);
    let mut wavy = mesh(&pool);
    let wave = |p: DVec3| p + DVec3::Z * ((5.0 * p.x).sin() * (5.0 * p.y).cos() * 0.3);
    wavy.deform(wave, DeformOptions::default()).expect("finite");
    assert!(wavy.vertices().zip(pool.positions()).all(|(v, p)| wavy.position(v) == wave(*p)));
    assert_eq!(wavy.to_indexed().polygons(), pool.polygons());
}

#[test]
fn a_ray_through_an_edge_or_vertex_crosses_once_where_the_tutorials_loop_counts_every_triangle() {
    let pool = fanned(&cube());
    let (solid, plain) = (mesh(&pool), Plain::from(&pool));
    for (to, least) in [(dvec3(0.5, 0.5, 1.0), 2), (DVec3::ONE, 4)] {
        // Through a face's diagonal; along the main diagonal, through two vertices.
        let from = if to == DVec3::ONE { DVec3::splat(-1.0) } else { dvec3(0.5, 0.5, -1.0) };
        let loops = naive::raycast(&plain, from, to - from).len();
        assert!(loops > least, "{loops}");
        let ours = hits(&solid, from, to - from);
        assert_eq!(ours.iter().map(|h| h.crossing).collect::<Vec<_>>(), [Crossing::Enter, Crossing::Leave]);
    }
}

#[test]
fn there_is_no_hidden_epsilon_at_the_start_of_a_ray() {
    for pool in [cube(), fanned(&cube())] {
        let solid = mesh(&pool);
        let from = |z: f64| hits(&solid, dvec3(0.5, 0.25, z), DVec3::Z);
        // On the surface t is zero, a bit behind it there is no hit, a bit before it there is one.
        assert_eq!(from(1.0).iter().map(|h| h.t).collect::<Vec<_>>(), [0.0]);
        assert!(from(1.0f64.next_up()).is_empty());
        let before = from(1.0f64.next_down());
        assert_eq!(before.len(), 1);
        assert!(before[0].t > 0.0 && before[0].t < naive::RAY_START, "the tutorial's loop would miss it");
        assert!(
            naive::raycast(&Plain::from(&fanned(&cube())), dvec3(0.5, 0.25, 1.0f64.next_down()), DVec3::Z)
                .is_empty()
        );
    }
}

#[test]
fn hits_tell_place_face_weights_feature_and_direction_in_order() {
    let mut noise = Noise(51);
    for (name, model) in models(2000) {
        let (index, bounds) = (model.index(), model.bounds().expect("vertices"));
        let size = (bounds.max - bounds.min).length();
        for _ in 0..20 {
            let from = bounds.center() + somewhere(&mut noise, 3.0 * size);
            let to = bounds.center() + somewhere(&mut noise, 0.6 * size);
            let ray = Ray::new(from, to - from).expect("a ray");
            let found = index.hits(&ray);
            assert!(found.is_sorted_by(|a, b| a.t <= b.t), "{name}");
            assert_eq!(
                (index.first_hit(&ray), index.is_hit(&ray)),
                (found.first().copied(), !found.is_empty())
            );
            for h in found {
                let at: DVec3 =
                    h.corners.iter().zip(h.barycentrics).map(|(&v, w)| model.position(v) * w).sum();
                let slack = 1e-9 * (size + bounds.center().length());
                assert!(at.distance(h.point) <= slack && ray.at(h.t).distance(h.point) <= slack, "{name}");
                assert!(h.corners.iter().all(|&v| model.face_vertices(h.face).any(|w| w == v)), "{name}");
                if let Feature::Face(f) = h.feature {
                    assert_eq!(f, h.face, "{name}");
                    let along = model.face_normal(f).dot(to - from);
                    let is_flat = model.degree(f) == 3;
                    let is_entering = h.crossing == Crossing::Enter;
                    assert!(!is_flat || along.abs() < 1e-9 * size || is_entering == (along < 0.0), "{name}");
                }
            }
        }
    }
}

#[test]
fn no_collapse_of_a_reduction_folds_a_face_over() {
    let ball = shapes::icosphere(4);
    for n in [2000, 500, 60] {
        let mut ball = mesh(&ball);
        ball.reduce(ReduceOptions { target: ReduceTarget::Faces(n), ..Default::default() }).expect("reduces");
        for f in ball.faces() {
            let middle = ball.face_vertices(f).map(|v| ball.position(v)).sum::<DVec3>() / 3.0;
            assert!(ball.face_normal(f).dot(middle) > 0.0, "{n}: a face of the ball looks in");
        }
    }
}

/// Of some queries, in how many the face with the nearest centre is not among the nearest faces.
fn wrong_faces(pool: &IndexedMesh, queries: u32) -> f64 {
    let (mesh, mut noise) = (mesh(pool), Noise(52));
    let index = mesh.index();
    let mut wrong = 0;
    for _ in 0..queries {
        let p = somewhere(&mut noise, 4.0);
        let near = index.closest_face(p, ALL).expect("asked well").expect("a face");
        let center = index.closest_face_center(p, ALL).expect("asked well").expect("a face");
        let [a, b, c] =
            [0, 1, 2].map(|i| mesh.position(mesh.face_vertices(center.element).nth(i).expect("a triangle")));
        let true_distance = naive::on_triangle(p, [a, b, c]).distance(p);
        assert!(true_distance >= near.distance - 1e-9);
        wrong += u32::from(true_distance > near.distance + 1e-9);
    }
    f64::from(wrong) / f64::from(queries)
}

/// A cylinder of long thin triangles.
fn cylinder(n: u32) -> IndexedMesh {
    let at = |i: u32, z: f64| {
        let (y, x) = (f64::from(i) / f64::from(n) * std::f64::consts::TAU).sin_cos();
        dvec3(x, y, z)
    };
    let points = (0..n)
        .map(|i| at(i, -2.0))
        .chain((0..n).map(|i| at(i, 2.0)))
        .chain([dvec3(0., 0., -2.), dvec3(0., 0., 2.)]);
    let sides = (0..n).flat_map(|i| {
        let j = (i + 1) % n;
        [[i, j, n + j], [i, n + j, n + i], [j, i, 2 * n], [n + i, n + j, 2 * n + 1]]
    });
    IndexedMesh::from_triangles(points.collect(), &sides.collect::<Vec<_>>()).expect("valid")
}

#[test]
fn the_nearest_centre_often_names_the_wrong_face_and_closest_face_never() {
    let sphere = wrong_faces(&shapes::icosphere(3), 1000);
    assert!((0.02..0.4).contains(&sphere), "{sphere}");
    let long = wrong_faces(&cylinder(24), 1000);
    assert!(long > 0.3 && long > sphere, "{long}");
}

#[test]
fn the_nearest_edge_is_one_of_all_clamped_to_its_ends() {
    let mut noise = Noise(53);
    for pool in [cube(), shapes::icosphere(1), shapes::torus(6, 5), shapes::grid(3)] {
        let mesh = mesh(&pool);
        let index = mesh.index();
        for _ in 0..200 {
            let p = somewhere(&mut noise, 8.0);
            let found = index.closest_edge(p, ALL).expect("asked well").expect("an edge");
            let ends = |e| {
                let h = mesh.edge_halfedge(e);
                [mesh.origin(h), mesh.target(h)].map(|v| mesh.position(v))
            };
            let [a, b] = ends(found.element);
            assert!(naive::on_segment(p, a, b).distance(found.point) < 1e-9, "within the edge's ends");
            let each = mesh.edges().map(ends).map(|[a, b]| naive::on_segment(p, a, b).distance(p));
            let least = each.fold(f64::INFINITY, f64::min);
            assert!((found.distance - least).abs() < 1e-12);
        }
    }
}

#[test]
fn the_nearest_point_knows_its_side_and_how_far_to_look() {
    let solid = mesh(&shapes::torus(9, 7));
    let closed = solid.closed().expect("closed");
    let (index, mut noise) = (solid.index(), Noise(54));
    let mut sides = [0; 2];
    for _ in 0..600 {
        let p = somewhere(&mut noise, 6.0);
        let near = index.closest_point(p, ALL).expect("asked well").expect("a point");
        assert_eq!(near.side, closed.contains(p).expect("asked well"));
        assert_eq!(
            near.signed_distance(),
            if near.side == Side::Inside { -near.distance } else { near.distance }
        );
        sides[usize::from(near.side == Side::Inside)] += 1;
        let short = ClosestOptions { max_distance: near.distance * 0.999, ..ALL };
        assert_eq!(index.closest_point(p, short), Ok(None));
    }
    assert!(sides.iter().all(|&n| n > 20), "{sides:?}");
}
