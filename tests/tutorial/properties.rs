//! Properties of the operations on shapes and on models of the corpus.

use crate::shapes::{self, Noise};
use crate::{cut, manifolds, models, reach, somewhere, volume};
use meshwright::glam::{DVec3, dvec3};
use meshwright::{
    ClosestOptions, Mesh, OutwardOptions, Scheme, SubdivideError, SubdivideOptions, WeldOptions,
};

fn subjects(most_faces: usize) -> Vec<(String, Mesh)> {
    let named = manifolds().into_iter().map(|(name, pool)| (name, shapes::mesh(&pool)));
    named.chain(models(most_faces)).collect()
}

/// How far the vertices of two meshes lie apart at most.
fn apart(a: &Mesh, b: &Mesh) -> f64 {
    let far = a.vertices().zip(b.vertices()).map(|(v, w)| a.position(v).distance(b.position(w)));
    far.fold(0.0, f64::max)
}

#[test]
fn models_come_back_from_translation_rotation_and_scaling() {
    for (name, mesh) in subjects(3000) {
        let (size, far) = reach(&mesh);
        let by = dvec3(0.3, -0.7, 1.1) * size;
        let slack = 1e-13 * (size + far);
        let mut moved = mesh.clone();
        moved.translate(by).expect("moved");
        moved.translate(-by).expect("moved");
        assert!(apart(&moved, &mesh) <= slack, "{name}");
        let axis = dvec3(1.0, 2.0, -0.5);
        let (mut parts, mut whole) = (mesh.clone(), mesh.clone());
        for degrees in [100.0, 17.0, 243.0] {
            parts.rotate_degrees(axis, degrees, by).expect("turned");
        }
        whole.rotate_degrees(axis, 360.0, by).expect("turned");
        assert!(apart(&parts, &whole) <= 10.0 * slack && apart(&whole, &mesh) <= 10.0 * slack, "{name}");
        let mut scaled = mesh.clone();
        scaled.scale(-2.5, by).expect("scaled");
        scaled.scale(-0.4, by).expect("scaled");
        assert!(apart(&scaled, &mesh) <= 10.0 * slack, "{name}");
        assert!(scaled.to_indexed().polygons() == mesh.to_indexed().polygons(), "{name}: mirrored twice");
    }
}

#[test]
fn rigid_motion_keeps_the_volume_of_models_and_scaling_cubes_its_factor() {
    for (name, mesh) in subjects(3000) {
        // A polygon that is not flat has two shapes, and where its diagonals are equal rounding chooses.
        let Ok(mesh) = Mesh::build(&cut(&mesh.to_indexed())) else { continue };
        let Ok(solid) = mesh.closed() else { continue };
        let (size, far) = reach(&mesh);
        let (before, area) = (solid.volume(), solid.area());
        let slack = 1e-12 * (size + far) * area + 1e-12 * before.abs();
        let mut moved = mesh.clone();
        moved.rotate_degrees(dvec3(1.0, -2.0, 0.3), 77.0, DVec3::ZERO).expect("turned");
        moved.translate(DVec3::splat(size)).expect("moved");
        assert!((volume(&moved) - before).abs() <= slack, "{name}");
        for s in [-2.0, 0.5] {
            let mut scaled = mesh.clone();
            scaled.scale(s, DVec3::ZERO).expect("scaled");
            let expected = before * s.abs().powi(3);
            assert!((volume(&scaled) - expected).abs() <= slack * 8.0, "{name}: {s}");
        }
    }
}

#[test]
fn flipping_twice_gives_back_models_with_their_keys() {
    for (name, mesh) in subjects(3000) {
        let links =
            |m: &Mesh| m.halfedges().map(|h| (h, m.next(h), m.origin(h), m.face(h))).collect::<Vec<_>>();
        let mut twice = mesh.clone();
        twice.reverse();
        assert!(twice.to_indexed() == mesh.to_indexed().reversed(), "{name}");
        twice.reverse();
        assert!(links(&twice) == links(&mesh) && twice.numbering() == mesh.numbering(), "{name}");
    }
}

#[test]
fn welding_models_twice_is_welding_them_once() {
    for (name, mesh) in subjects(3000) {
        for part in [0.0, 1e-4, 0.05] {
            let tolerance = part * reach(&mesh).0;
            let options = || WeldOptions { tolerance, ..Default::default() };
            let once = mesh.weld(options()).expect("welded").value;
            let twice = once.weld(options()).expect("welded");
            // Sheets that cross each other over and over: each pass has other merges to take back.
            if !name.ends_with("manifold__openscad-nonmanifold-crash.obj") {
                assert!(twice.value.to_indexed() == once.to_indexed(), "{name}: {part}");
                assert!(twice.report.is_empty(), "{name}: {part}: {:?}", twice.report.counts());
            }
        }
    }
}

#[test]
fn subdividing_models_keeps_euler_characteristic_boundaries_and_parts() {
    let mut cut = 0;
    for (name, mesh) in subjects(600) {
        let facts = |m: &Mesh| (m.euler_characteristic(), m.boundary_loops().len(), m.components().len());
        for scheme in [Scheme::Midpoint, Scheme::Loop, Scheme::CatmullClark, Scheme::Sqrt3] {
            match mesh.subdivide(SubdivideOptions { scheme, ..Default::default() }) {
                Ok(fine) => {
                    assert_eq!(facts(&fine.value), facts(&mesh), "{name}, {scheme:?}");
                    assert_eq!(fine.value.validate(), Ok(()), "{name}, {scheme:?}");
                    cut += 1;
                }
                Err(error) => assert!(matches!(error, SubdivideError::NotTriangulable(_)), "{name}: {error}"),
            }
        }
    }
    assert!(cut >= 40, "{cut}");
}

#[test]
fn turning_models_outward_twice_is_turning_them_once_and_leaves_no_solid_inside_out() {
    for (name, mesh) in subjects(3000) {
        for reversed in [false, true] {
            let mut once = mesh.clone();
            if reversed {
                once.reverse();
            }
            let parts = once.orient_outward(OutwardOptions::default()).expect("not cancelled");
            let mut twice = once.clone();
            let again = twice.orient_outward(OutwardOptions::default()).expect("not cancelled");
            assert!(again.iter().all(|p| !p.reversed), "{name}");
            assert!(twice.to_indexed() == once.to_indexed(), "{name}");
            // Faces that lie on each other enclose nothing but rounding.
            let size = reach(&once).0;
            if parts.len() == 1 && parts[0].closed && volume(&once).abs() > 1e-12 * size.powi(3) {
                assert!(volume(&once) > 0.0, "{name}");
            }
        }
    }
}

#[test]
fn nothing_is_nearer_to_models_than_the_nearest_point_says() {
    let mut noise = Noise(71);
    for (name, mesh) in subjects(1000) {
        let (index, bounds) = (mesh.index(), mesh.bounds().expect("vertices"));
        let (size, far) = reach(&mesh);
        for _ in 0..20 {
            let p = bounds.center() + somewhere(&mut noise, 2.0 * size);
            let found =
                index.closest_point(p, ClosestOptions::default()).expect("asked well").expect("a point");
            for v in mesh.vertices().filter(|&v| !mesh.is_isolated(v)) {
                assert!(found.distance <= mesh.position(v).distance(p) + 1e-12 * (size + far), "{name}");
            }
        }
    }
}
