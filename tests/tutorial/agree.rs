//! The tutorial's loops over points, faces and rays beside ours.

use crate::naive::{self, Plain};
use crate::shapes::{self, Noise};
use crate::{cut, manifolds, models, somewhere, soups, volume};
use meshwright::cleanup::{Weld, index};
use meshwright::glam::{DVec3, dvec3};
use meshwright::{Boundary, ClosestOptions, IndexedMesh, Mesh, PolygonSoup, Polygons, Ray, SmoothOptions};
use proptest::prelude::*;

/// The weld keeps and merges what the loop does, in the loop's order.
fn welds_alike(name: &str, soup: &PolygonSoup, tolerance: f64) {
    let weld = if tolerance == 0.0 { Weld::Exact } else { Weld::Within(tolerance) };
    let ours = index(soup, weld).expect("always answers");
    let theirs = naive::weld(&soup.positions, tolerance);
    let mut kept = 0;
    for (v, &into) in theirs.iter().enumerate() {
        let &[new] = ours.maps.vertices.new_of(v) else { panic!("{name}: vertex {v} is not one vertex") };
        let same = ours.value.positions()[new as usize] == soup.positions[into];
        assert!(same, "{name}, {tolerance}: vertex {v} went elsewhere than to vertex {into}");
        if into == v {
            assert_eq!(new, kept, "{name}: kept vertices stay in order");
            kept += 1;
        }
    }
    assert_eq!(ours.value.vertex_count() as u32, kept, "{name}, {tolerance}");
}

#[test]
fn weld_is_the_tutorials_loop_on_shapes_and_models() {
    let named = manifolds().into_iter().map(|(name, pool)| (name, shapes::unwelded(&pool)));
    for (name, soup) in named.chain(soups(400)) {
        if !soup.positions.iter().all(|p| p.is_finite()) {
            continue;
        }
        let size = soup.positions.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        for tolerance in [0.0, 1e-6, 0.01, 0.3, 3.0] {
            welds_alike(&name, &soup, tolerance * size);
        }
    }
}

#[test]
fn volume_is_the_tutorials_sum_on_shapes_and_models() {
    let named = manifolds().into_iter().map(|(name, pool)| (name, shapes::mesh(&pool)));
    let mut measured = 0;
    for (name, mesh) in named.chain(models(3000)) {
        let Ok(solid) = mesh.closed() else { continue };
        // Polygons that are not flat have a volume only by a rule; far from the origin the sum has no digits left.
        let mut plain = Plain::from(&cut(&mesh.to_indexed()));
        let bounds = mesh.bounds().expect("vertices");
        plain.points.iter_mut().for_each(|p| *p -= bounds.center());
        let (ours, theirs) = (solid.volume(), naive::volume(&plain));
        let far = (bounds.max - bounds.min).length();
        assert!((ours - theirs).abs() <= 1e-12 * far * solid.area(), "{name}: {ours} {theirs}");
        measured += 1;
    }
    assert!(measured >= 7, "{measured}");
}

#[test]
fn laplacian_is_the_tutorials_loop_on_shapes_and_models() {
    let named = manifolds().into_iter().map(|(name, pool)| (name, shapes::mesh(&pool)));
    for (name, mesh) in named.chain(models(200)) {
        let plain = Plain::from(&mesh.to_indexed());
        let vertices: Vec<_> = mesh.vertices().collect();
        let size = plain.points.iter().map(|p| p.length()).fold(0.0, f64::max);
        for (boundary, is_fixed) in [(Boundary::Fixed, true), (Boundary::Free, false)] {
            let mut ours = mesh.clone();
            let options = SmoothOptions { lambda: 0.4, iterations: 3, boundary, ..Default::default() };
            ours.smooth(options).expect("smoothed");
            let stays = |v: usize| is_fixed && mesh.is_boundary_vertex(vertices[v]);
            let theirs = naive::laplacian(&plain, 0.4, 3, stays);
            for (&v, q) in vertices.iter().zip(theirs) {
                assert!(ours.position(v).distance(q) <= 1e-12 * size, "{name}: {v:?}");
            }
        }
    }
}

const ALL: ClosestOptions = ClosestOptions { max_distance: f64::INFINITY, isolated_vertices: true };

#[test]
fn closest_elements_are_those_of_the_tutorials_loops_on_models() {
    let mut noise = Noise(31);
    for (name, mesh) in models(300) {
        let (plain, index) = (Plain::from(&mesh.to_indexed()), mesh.index());
        let triangles = Plain::from(&cut(&mesh.to_indexed()));
        let bounds = mesh.bounds().expect("vertices");
        let size = (bounds.max - bounds.min).length();
        for _ in 0..60 {
            let p = bounds.center() + somewhere(&mut noise, 2.0 * size);
            let slack = 1e-9 * (size + bounds.center().length());
            let vertex = index.closest_vertex(p, ALL).expect("asked well").expect("a vertex");
            assert_eq!(vertex.point, plain.points[naive::closest_vertex(&plain, p).0], "{name}: {p}");
            let center = index.closest_face_center(p, ALL).expect("asked well").expect("a face");
            assert!(
                (center.distance - naive::closest_face_center(&plain, p).1).abs() <= slack,
                "{name}: {p}"
            );
            let edge = index.closest_edge(p, ALL).expect("asked well").expect("an edge");
            assert!((edge.distance - naive::closest_edge(&plain, p)).abs() <= slack, "{name}: {p}");
            let surface = index.closest_point(p, ALL).expect("asked well").expect("a point");
            assert!((surface.distance - naive::closest_point(&triangles, p)).abs() <= slack, "{name}: {p}");
        }
    }
}

#[test]
fn the_last_line_of_the_nearest_point_is_wrong_as_printed_and_right_here() {
    let corners = [dvec3(0., 0., 0.), dvec3(2., 0., 1.), dvec3(0., 3., 1.)];
    let mesh = shapes::mesh(&shapes::pool(corners.to_vec(), vec![vec![0, 1, 2]]));
    let index = mesh.index();
    let mut noise = Noise(32);
    let mut wrong = 0;
    for _ in 0..300 {
        let p = dvec3(0.7, 0.8, 0.5) + somewhere(&mut noise, 2.0);
        let ours = index.closest_point(p, ALL).expect("asked well").expect("a point");
        assert!(ours.point.distance(naive::on_triangle(p, corners)) < 1e-12);
        let printed = naive::on_triangle_as_printed(p, corners);
        assert!(printed.distance(p) > ours.distance - 1e-12 || printed.distance(ours.point) > 1e-9);
        wrong += u32::from(printed.distance(ours.point) > 1e-9);
    }
    assert!(wrong > 50, "{wrong}");
}

#[test]
fn rays_hit_what_the_tutorials_loop_hits_on_shapes_and_models() {
    let mut noise = Noise(33);
    let named = manifolds().into_iter().map(|(name, pool)| (name, shapes::mesh(&pool)));
    let (mut cast, mut met) = (0, 0);
    for (name, mesh) in named.chain(models(600)) {
        // Cut beforehand, so that both number the same faces.
        let pool = cut(&mesh.to_indexed());
        let Ok(mesh) = Mesh::build(&pool) else { continue };
        let (plain, index) = (Plain::from(&pool), mesh.index());
        let faces: Vec<_> = mesh.faces().collect();
        let bounds = mesh.bounds().expect("vertices");
        let size = (bounds.max - bounds.min).length();
        for _ in 0..60 {
            let origin = bounds.center() + somewhere(&mut noise, 2.0 * size);
            let direction = bounds.center() + somewhere(&mut noise, 0.5 * size) - origin;
            let theirs = naive::raycast(&plain, origin, direction);
            let ours = index.hits(&Ray::new(origin, direction).expect("a ray"));
            // Where a ray passes an edge by rounding, or slivers overlap, the loop is not to be trusted.
            let near_edge = ours.iter().any(|h| h.barycentrics.iter().any(|w| *w < 1e-7));
            if near_edge || theirs.windows(2).any(|w| w[1].0 - w[0].0 < 1e-9) {
                continue;
            }
            assert_eq!(ours.len(), theirs.len(), "{name}: {origin} {direction}");
            for (h, (t, f)) in ours.iter().zip(theirs) {
                assert!((h.t - t).abs() < 1e-7, "{name}");
                assert_eq!(h.face, faces[f], "{name}");
                met += 1;
            }
            cast += 1;
        }
    }
    assert!(cast > 400 && met > 200, "{cast} {met}");
}

/// Points in clusters on a lattice, so that many are just within and just without a tolerance; any faces between them.
fn clustered() -> impl Strategy<Value = PolygonSoup> {
    let point = prop::array::uniform3((-3i8..4, -20i8..21));
    let face = prop::collection::vec(0u32..24, 3..5);
    (prop::collection::vec(point, 24), prop::collection::vec(face, 0..8)).prop_map(|(points, faces)| {
        let at = |c: (i8, i8)| f64::from(c.0) + f64::from(c.1) * 0.01;
        let points = points.into_iter().map(|p| DVec3::from(p.map(at))).collect();
        PolygonSoup::new(points, Polygons::from(faces))
    })
}

proptest! {
    #[test]
    fn weld_is_the_tutorials_loop_for_every_input(soup in clustered(), tolerance in prop_oneof![Just(0.0), Just(0.1), Just(1.0), 1e-3f64..2.0]) {
        welds_alike("clusters", &soup, tolerance);
    }

    #[test]
    fn kept_vertices_stay_in_place_a_tolerance_apart(soup in clustered(), tolerance in 1e-3f64..2.0) {
        let kept = index(&soup, Weld::Within(tolerance)).expect("always answers").value;
        let p = kept.positions();
        for i in 0..p.len() {
            prop_assert!(soup.positions.contains(&p[i]), "nothing is moved to a mean");
            for j in 0..i {
                prop_assert!(((p[i] - p[j]) / tolerance).length_squared() >= 1.0, "{} and {}", i, j);
            }
        }
    }

    #[test]
    fn volume_is_the_tutorials_sum_for_any_closed_triangles(points in prop::collection::vec(prop::array::uniform3(-5.0f64..5.0), 8)) {
        let faces = shapes::fanned(&shapes::cube()).polygons().clone();
        let pool = IndexedMesh::new(points.into_iter().map(DVec3::from).collect(), faces).expect("a pool");
        let ours = volume(&shapes::mesh(&pool));
        prop_assert!((ours - naive::volume(&Plain::from(&pool))).abs() < 1e-11);
    }

    #[test]
    fn closest_distances_are_never_above_that_of_any_used_vertex(p in prop::array::uniform3(-9.0f64..9.0), shape in 0usize..10) {
        let (_, pool) = &manifolds()[shape];
        let mesh = shapes::mesh(pool);
        let (index, p) = (mesh.index(), DVec3::from(p));
        let surface = index.closest_point(p, ALL).expect("asked well").expect("a point").distance;
        let edge = index.closest_edge(p, ALL).expect("asked well").expect("an edge").distance;
        for at in pool.positions() {
            let far = at.distance(p) * (1.0 + 1e-14);
            prop_assert!(surface <= far && edge <= far, "{}", at);
        }
    }
}
