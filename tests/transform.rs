//! Translate, scale, rotate, affine maps and deform: meaning, refusals, and what stays.

mod shapes;

use meshwright::glam::{DAffine3, DMat3, DMat4, DVec3, DVec4, dvec3};
use meshwright::{
    Control, DeformError, DeformOptions, IndexedMesh, Mesh, NormalWeight, Progress, TransformError,
};
use proptest::prelude::*;
use std::ops::ControlFlow;

fn cube() -> Mesh {
    shapes::mesh(&shapes::cube())
}

fn positions(mesh: &Mesh) -> Vec<DVec3> {
    mesh.vertices().map(|v| mesh.position(v)).collect()
}

fn volume(mesh: &Mesh) -> f64 {
    mesh.closed().expect("closed").volume()
}

/// Whether the carried normals are those of the faces.
fn normals_fit(mesh: &Mesh) -> bool {
    mesh.vertices().all(|v| {
        let computed = mesh.vertex_normal(v, NormalWeight::Area).expect("live");
        mesh.normal(v).expect("carried").distance(computed) < 1e-9
    })
}

#[test]
fn translate_adds_a_vector_to_every_vertex() {
    let mut mesh = cube();
    let before = positions(&mesh);
    mesh.translate(dvec3(1.0, -2.0, 3.0)).expect("moved");
    assert!(positions(&mesh).iter().zip(before).all(|(p, q)| *p == q + dvec3(1.0, -2.0, 3.0)));
}

#[test]
fn numbers_that_are_not_finite_are_refused_and_change_nothing() {
    let mut mesh = cube();
    let before = mesh.to_indexed();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let bad = DVec3::X * bad;
        let bad_map = DAffine3::from_mat3_translation(DMat3::IDENTITY, bad);
        let mut last_row = DMat4::IDENTITY;
        last_row.w_axis.w = bad.x;
        for refused in [
            mesh.translate(bad),
            mesh.scale(bad.x, DVec3::ZERO),
            mesh.scale(2.0, bad),
            mesh.scale_axes(bad, DVec3::ZERO),
            mesh.scale_axes(dvec3(1.0, 2.0, 3.0), bad),
            mesh.rotate_degrees(bad, 10.0, DVec3::ZERO),
            mesh.rotate_degrees(DVec3::X, bad.x, DVec3::ZERO),
            mesh.rotate_degrees(DVec3::X, 10.0, bad),
            mesh.transform(&bad_map),
            mesh.transform_matrix(&last_row),
        ] {
            assert_eq!(refused, Err(TransformError::NonFinite));
        }
    }
    assert_eq!(mesh.to_indexed(), before);
}

#[test]
fn zero_factors_zero_axes_and_singular_or_projective_matrices_are_refused() {
    let mut mesh = cube();
    let before = mesh.to_indexed();
    assert_eq!(mesh.scale(0.0, DVec3::ZERO), Err(TransformError::ZeroFactor));
    assert_eq!(mesh.scale(-0.0, DVec3::ZERO), Err(TransformError::ZeroFactor));
    assert_eq!(mesh.scale_axes(dvec3(1.0, 0.0, 2.0), DVec3::ZERO), Err(TransformError::ZeroFactor));
    assert_eq!(mesh.rotate_degrees(DVec3::ZERO, 90.0, DVec3::ZERO), Err(TransformError::ZeroAxis));
    let flat = DAffine3::from_mat3(DMat3::from_cols(DVec3::X, DVec3::Y, DVec3::X + DVec3::Y));
    assert_eq!(mesh.transform(&flat), Err(TransformError::Singular));
    let mut matrix = DMat4::IDENTITY;
    matrix.x_axis.w = 0.5;
    assert_eq!(mesh.transform_matrix(&matrix), Err(TransformError::NotAffine([0.5, 0.0, 0.0, 1.0])));
    assert_eq!(
        mesh.transform_matrix(&DMat4::from_diagonal(DVec4::splat(2.0))).map_err(|e| e.to_string()),
        Err("the last row of the matrix is [0.0, 0.0, 0.0, 2.0], not 0 0 0 1".to_owned())
    );
    assert_eq!(mesh.to_indexed(), before);
}

#[test]
fn a_vertex_that_would_leave_the_range_of_numbers_is_named_and_nothing_moves() {
    let mut mesh = cube();
    mesh.translate(DVec3::X * 1e308).expect("moved");
    mesh.compute_normals(NormalWeight::Angle);
    let before = mesh.to_indexed();
    let first = mesh.vertices().next().expect("there");
    assert_eq!(mesh.translate(DVec3::X * 1e308), Err(TransformError::OutOfRange(first)));
    assert_eq!(mesh.scale(-4.0, DVec3::ZERO), Err(TransformError::OutOfRange(first)));
    assert_eq!(mesh.scale_axes(dvec3(-9.0, 1.0, 1.0), DVec3::ZERO), Err(TransformError::OutOfRange(first)));
    assert_eq!(mesh.to_indexed(), before);
}

#[test]
fn scaling_goes_about_the_origin_that_is_given() {
    let mut mesh = cube();
    let center = mesh.bounds().expect("vertices").center();
    mesh.scale(3.0, center).expect("scaled");
    let bounds = mesh.bounds().expect("vertices");
    assert_eq!((bounds.min, bounds.max), (DVec3::splat(-1.0), DVec3::splat(2.0)));
}

#[test]
fn a_factor_that_mirrors_reverses_the_winding_and_keeps_the_keys() {
    let mut mesh = cube();
    mesh.compute_normals(NormalWeight::Area);
    let (vertices, faces): (Vec<_>, Vec<_>) = (mesh.vertices().collect(), mesh.faces().collect());
    let h = mesh.halfedges().next().expect("there");
    let (origin, face) = (mesh.origin(h), mesh.face(h));
    for (k, factors) in
        [dvec3(-2.0, 1.0, 1.0), dvec3(-1.0, -2.0, -3.0), dvec3(-1.0, -2.0, 0.5), DVec3::splat(-1.5)]
            .into_iter()
            .enumerate()
    {
        let before = volume(&mesh);
        mesh.scale_axes(factors, dvec3(0.3, 0.2, 0.1)).expect("scaled");
        let expected = before * factors.element_product().abs();
        assert!((volume(&mesh) - expected).abs() < 1e-12 * expected, "{factors}");
        assert!(normals_fit(&mesh), "{factors}");
        assert_eq!(mesh.validate(), Ok(()));
        assert_eq!(mesh.face(h), face);
        assert_eq!(
            mesh.origin(h) == origin,
            [false, true, true, false][k],
            "each mirroring turns half-edges"
        );
    }
    assert!(vertices.into_iter().eq(mesh.vertices()) && faces.into_iter().eq(mesh.faces()));
}

#[test]
fn quarter_turns_about_coordinate_axes_are_exact() {
    let shape = shapes::icosphere(1);
    for (axis, x, y) in [(DVec3::X, 1, 2), (DVec3::Y, 2, 0), (DVec3::Z, 0, 1)] {
        for quarters in -5i32..6 {
            let mut mesh = shapes::mesh(&shape);
            mesh.rotate_degrees(axis * 7.0, f64::from(quarters) * 90.0, DVec3::ZERO).expect("turned");
            for (v, p) in mesh.vertices().zip(shape.positions()) {
                let mut expected = *p;
                for _ in 0..quarters.rem_euclid(4) {
                    (expected[x], expected[y]) = (-expected[y], expected[x]);
                }
                assert_eq!(mesh.position(v), expected);
            }
        }
    }
}

#[test]
fn rotation_follows_rodrigues_and_the_right_hand() {
    let mut mesh = cube();
    mesh.rotate_degrees(DVec3::ONE, 120.0, DVec3::ZERO).expect("turned");
    // A third of a turn about the diagonal sends X to Y, Y to Z, Z to X.
    for (v, p) in mesh.vertices().zip(shapes::cube().positions()) {
        assert!(mesh.position(v).distance(dvec3(p.z, p.x, p.y)) < 1e-15);
    }
    // A tiny or huge axis has a direction all the same.
    for size in [1e-320, 1e-200, 1e300] {
        let mut mesh = cube();
        mesh.rotate_degrees(DVec3::Z * size, 90.0, DVec3::ZERO).expect("turned");
        assert_eq!(mesh.position(mesh.vertices().nth(1).expect("there")), DVec3::Y);
    }
}

#[test]
fn normals_turn_by_the_inverse_transpose_and_keep_their_length() {
    let mut mesh = shapes::mesh(&shapes::icosphere(2));
    let shear = DMat3::from_cols(dvec3(2.0, 0.1, 0.0), dvec3(0.5, 1.0, 0.2), dvec3(0.0, 0.3, 3.0));
    // Face normals of a sphere carried at its vertices do not turn like vertex normals do: take flat parts.
    let mut flat = shapes::mesh(&shapes::pool(
        vec![DVec3::ZERO, DVec3::X, DVec3::ONE, DVec3::Y],
        vec![vec![0, 1, 2], vec![0, 2, 3]],
    ));
    let tilt = DMat3::from_rotation_x(0.4) * DMat3::from_diagonal(dvec3(1.0, 1.0, 0.0));
    flat.deform(|p| tilt * p, DeformOptions::default()).expect("flat");
    flat.compute_normals(NormalWeight::Area);
    for map in [shear, shear * -1.0, DMat3::from_diagonal(dvec3(1e-9, 1.0, 1e9))] {
        let mut mapped = flat.clone();
        mapped.transform(&DAffine3::from_mat3_translation(map, DVec3::ONE)).expect("mapped");
        assert!(normals_fit(&mapped), "{map}");
    }
    let v = mesh.vertices().next().expect("there");
    mesh.set_normal(v, DVec3::X * 5.0).expect("set");
    mesh.scale_axes(dvec3(3.0, 1.0, 1.0), DVec3::ZERO).expect("scaled");
    assert_eq!(mesh.normal(v), Some(DVec3::X * 5.0));
    assert_eq!(mesh.normal(mesh.vertices().nth(1).expect("there")), Some(DVec3::ZERO), "none stays none");
    // The inverses of these factors are further apart than any two numbers.
    mesh.scale_axes(dvec3(1e250, 1e-250, 1.0), DVec3::ZERO).expect("scaled");
    assert_eq!(mesh.normal(v), Some(DVec3::X * 5.0));
    mesh.set_normal(v, DVec3::X * f64::MAX).expect("set");
    mesh.rotate_degrees(dvec3(1.0, 2.0, 3.0), 33.0, DVec3::ZERO).expect("turned");
    assert!(mesh.normal(v).expect("carried").is_finite());
}

#[test]
fn corner_normals_turn_as_those_of_vertices_do() {
    let mut mesh = cube();
    let corners: Vec<_> =
        mesh.faces().flat_map(|f| mesh.face_halfedges(f).map(move |h| (f, h)).collect::<Vec<_>>()).collect();
    for (f, h) in corners {
        let normal = mesh.face_normal(f);
        mesh.set_corner_normal(h, Some(normal)).expect("a corner");
    }
    mesh.scale_axes(dvec3(-2.0, 1.0, 3.0), DVec3::ONE).expect("scaled");
    mesh.rotate_degrees(dvec3(1.0, 2.0, 3.0), 33.0, DVec3::ZERO).expect("turned");
    for f in mesh.faces() {
        for h in mesh.face_halfedges(f) {
            assert!(mesh.corner_normal(h).expect("carried").distance(mesh.face_normal(f)) < 1e-12);
        }
    }
}

#[test]
fn a_checkpoint_takes_bulk_writes_back() {
    let mut mesh = cube();
    mesh.compute_normals(NormalWeight::Angle);
    let before = mesh.to_indexed();
    let checkpoint = mesh.checkpoint();
    mesh.scale(-2.0, DVec3::ONE).expect("scaled");
    mesh.rotate_degrees(DVec3::ONE, 33.0, DVec3::ZERO).expect("turned");
    mesh.deform(|p| p + DVec3::X * p.y, DeformOptions::default()).expect("deformed");
    mesh.smooth(Default::default()).expect("smoothed");
    assert_ne!(mesh.to_indexed(), before);
    mesh.restore(checkpoint).expect("known");
    assert_eq!(mesh.to_indexed(), before);
    assert_eq!(mesh.validate(), Ok(()));
}

#[test]
fn deform_calls_once_per_vertex_in_order() {
    let pool = shapes::icosphere(1);
    let mut mesh = shapes::mesh(&pool);
    let mut seen = Vec::new();
    mesh.deform(
        |p| {
            seen.push(p);
            p * 2.0
        },
        DeformOptions::default(),
    )
    .expect("deformed");
    assert_eq!(seen, pool.positions());
    assert!(positions(&mesh).iter().zip(pool.positions()).all(|(p, q)| *p == *q * 2.0));
}

#[test]
fn a_deformation_that_is_not_finite_names_the_vertex_and_changes_nothing() {
    let mut mesh = cube();
    let before = mesh.to_indexed();
    let third = mesh.vertices().nth(3).expect("there");
    let refused =
        mesh.deform(|p| if p.x + p.y == 2.0 { p / 0.0 } else { p + DVec3::X }, DeformOptions::default());
    assert_eq!(refused, Err(DeformError::NonFinite(third)));
    assert_eq!(mesh.to_indexed(), before);
}

#[test]
fn a_cancelled_deformation_changes_nothing() {
    let mut mesh = cube();
    let before = mesh.to_indexed();
    let mut hook = |_: Progress| ControlFlow::Break(());
    let refused = mesh.deform(|p| p * 2.0, DeformOptions { control: Control::new(&mut hook) });
    assert!(matches!(refused, Err(DeformError::Cancelled(_))));
    assert_eq!(mesh.to_indexed(), before);
}

fn vector() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-10.0f64..10.0).prop_map(DVec3::from)
}

fn near(a: &Mesh, b: &IndexedMesh, slack: f64) -> bool {
    positions(a).iter().zip(b.positions()).all(|(p, q)| p.distance(*q) <= slack)
}

proptest! {
    #[test]
    fn there_and_back_is_where_it_was(by in vector(), origin in vector(), factor in prop_oneof![-9.0f64..-0.1, 0.1f64..9.0]) {
        let shape = shapes::torus(5, 4);
        let mut mesh = shapes::mesh(&shape);
        mesh.translate(by).expect("moved");
        mesh.translate(-by).expect("moved");
        prop_assert!(near(&mesh, &shape, 1e-13));
        mesh.scale(factor, origin).expect("scaled");
        mesh.scale(1.0 / factor, origin).expect("scaled");
        prop_assert!(near(&mesh, &shape, 1e-11));
        prop_assert_eq!(mesh.to_indexed().into_parts().1, shape.polygons().clone());
    }

    #[test]
    fn a_rotation_by_parts_is_the_rotation(axis in vector(), origin in vector(), a in -400.0f64..400.0, b in -400.0f64..400.0) {
        prop_assume!(axis.length() > 1e-3);
        let shape = shapes::torus(5, 4);
        let (mut parts, mut whole) = (shapes::mesh(&shape), shapes::mesh(&shape));
        parts.rotate_degrees(axis, a, origin).expect("turned");
        parts.rotate_degrees(axis, b, origin).expect("turned");
        whole.rotate_degrees(axis, a + b, origin).expect("turned");
        prop_assert!(near(&parts, &whole.to_indexed(), 1e-11));
    }

    #[test]
    fn volume_is_kept_by_rigid_motion_and_goes_with_the_cube_of_the_factor(axis in vector(), by in vector(), degrees in -400.0f64..400.0, s in prop_oneof![-9.0f64..-0.1, 0.1f64..9.0]) {
        prop_assume!(axis.length() > 1e-3);
        let mut mesh = shapes::mesh(&shapes::torus(5, 4));
        let before = volume(&mesh);
        mesh.rotate_degrees(axis, degrees, by).expect("turned");
        mesh.translate(by).expect("moved");
        prop_assert!((volume(&mesh) - before).abs() < 1e-11 * before);
        mesh.scale(s, by).expect("scaled");
        prop_assert!((volume(&mesh) / before - s.abs().powi(3)).abs() < 1e-11 * s.abs().powi(3));
    }

    #[test]
    fn flipping_twice_is_the_identity(normals in any::<bool>()) {
        let mut mesh = shapes::mesh(&shapes::torus(5, 4));
        if normals {
            mesh.compute_normals(NormalWeight::Area);
        }
        let before = mesh.to_indexed();
        mesh.reverse();
        prop_assert!(volume(&mesh) < 0.0);
        mesh.reverse();
        prop_assert_eq!(mesh.to_indexed(), before);
    }

    #[test]
    fn affine_maps_scale_the_volume_by_their_determinant(x in vector(), y in vector(), z in vector(), t in vector()) {
        let map = DMat3::from_cols(x, y, z);
        prop_assume!(map.determinant().abs() > 1.0);
        let mut mesh = cube();
        let before = volume(&mesh);
        mesh.transform(&DAffine3::from_mat3_translation(map, t)).expect("mapped");
        let expected = before * map.determinant().abs();
        prop_assert!((volume(&mesh) - expected).abs() < 1e-9 * expected.max(1.0));
    }
}
