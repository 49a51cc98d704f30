//! Rows about moving, on the corpus: translate, scale, rotate, deform, flip, volume.

use crate::{assert_met, few, models, reach, shapes, solids, somewhere, volume};
use meshwright::glam::{DAffine3, DMat3, DVec3, dvec3};
use meshwright::{DeformError, DeformOptions, EdgeKey, FaceKey, Mesh, NormalWeight, OutwardOptions, Rule};

fn positions(mesh: &Mesh) -> Vec<DVec3> {
    mesh.vertices().map(|v| mesh.position(v)).collect()
}

#[test]
fn models_are_moved_vertex_by_vertex_and_refusals_change_nothing() {
    for (name, mesh) in few() {
        let before = positions(mesh);
        let by = dvec3(0.3, -0.7, 1.1) * reach(mesh).0;
        let mut moved = mesh.clone();
        moved.translate(by).expect("moved");
        assert!(positions(&moved).iter().zip(&before).all(|(p, q)| *p == *q + by), "{name}");
        assert!(moved.numbering() == mesh.numbering(), "{name}");
        let mut same = mesh.clone();
        let flat = DAffine3::from_mat3(DMat3::from_cols(DVec3::X, DVec3::Y, DVec3::X + DVec3::Y));
        assert!(same.translate(DVec3::NAN).is_err() && same.scale(0.0, by).is_err(), "{name}");
        assert!(same.scale(f64::INFINITY, by).is_err(), "{name}");
        assert!(
            same.scale_axes(dvec3(1.0, 0.0, 1.0), by).is_err() && same.transform(&flat).is_err(),
            "{name}"
        );
        assert!(same.rotate_degrees(DVec3::ZERO, 9.0, by).is_err(), "{name}");
        assert!(same.rotate_degrees(DVec3::X, f64::NAN, by).is_err(), "{name}");
        let last = same.vertices().last().expect("vertices");
        let (mut left, count) = (same.vertex_count(), same.vertex_count());
        let spoilt = |p: DVec3| {
            left -= 1;
            if left == 0 { DVec3::NAN } else { p * 2.0 }
        };
        assert_eq!(
            same.deform(spoilt, DeformOptions::default()),
            Err(DeformError::NonFinite(last)),
            "{name}"
        );
        assert!(same.to_indexed() == mesh.to_indexed() && same.vertex_count() == count, "{name}");
    }
}

#[test]
fn models_scale_about_their_middle_and_along_axes_by_their_volume() {
    let mut met = 0;
    for (name, mesh) in solids() {
        let (before, bounds) = (volume(mesh), mesh.bounds().expect("vertices"));
        let (size, far) = reach(mesh);
        let slack = 1e-12 * (size + far) * mesh.closed().expect("closed").area();
        for factors in
            [dvec3(2.0, 0.5, 1.0), dvec3(-2.0, 1.0, 3.0), dvec3(-1.0, 1.0, -4.0), DVec3::splat(-0.5)]
        {
            let mut scaled = mesh.clone();
            scaled.scale_axes(factors, bounds.center()).expect("scaled");
            let now = scaled.bounds().expect("vertices");
            let expected = (bounds.max - bounds.min) * factors.abs();
            assert!((now.max - now.min).distance(expected) <= 1e-12 * (size + far), "{name}: {factors}");
            assert!(now.center().distance(bounds.center()) <= 1e-12 * (size + far), "{name}: {factors}");
            let expected = before * factors.element_product().abs();
            assert!((volume(&scaled) - expected).abs() <= 20.0 * slack, "{name}: {factors}");
            let pool = mesh.to_indexed();
            let pool = if factors.element_product() < 0.0 { pool.reversed() } else { pool };
            assert!(scaled.to_indexed().polygons() == pool.polygons(), "{name}: the winding flips with it");
        }
        met += 1;
    }
    assert_met(met, 45);
}

#[test]
fn normals_and_tangents_of_models_turn_with_them() {
    let mut met = 0;
    for (name, model) in few() {
        let mut mesh = model.clone();
        let size = reach(&mesh).0;
        mesh.translate(-mesh.bounds().expect("vertices").center()).expect("moved");
        let held = mesh.add_face_column(DVec3::ZERO, Rule::normals());
        let along = mesh.add_edge_column(DVec3::ZERO, Rule::tangents());
        let step = |mesh: &Mesh, e: EdgeKey| {
            let h = mesh.edge_halfedge(e);
            mesh.position(mesh.target(h)) - mesh.position(mesh.origin(h))
        };
        for f in mesh.faces().collect::<Vec<_>>() {
            let normal = mesh.face_normal(f);
            mesh.set_value(held, f, normal).expect("live");
            for h in mesh.face_halfedges(f).collect::<Vec<_>>() {
                mesh.set_corner_normal(h, Some(normal)).expect("a corner");
            }
        }
        for e in mesh.edges().collect::<Vec<_>>() {
            mesh.set_value(along, e, step(&mesh, e)).expect("live");
        }
        // What has hardly an area has hardly a normal.
        let is_fair = |mesh: &Mesh, f: FaceKey| {
            let corners: Vec<DVec3> = mesh.face_vertices(f).map(|v| mesh.position(v)).collect();
            let twice = (1..corners.len() - 1)
                .map(|i| (corners[i] - corners[0]).cross(corners[i + 1] - corners[0]))
                .sum::<DVec3>();
            twice.length() > 1e-4 * size * size
        };
        let fair: Vec<FaceKey> = mesh.faces().filter(|&f| is_fair(&mesh, f)).collect();
        let checkpoint = mesh.checkpoint();
        mesh.scale_axes(dvec3(-1.5, 1.0, 0.7), DVec3::ZERO).expect("scaled");
        mesh.rotate_degrees(dvec3(1.0, 2.0, 3.0), 33.0, DVec3::ZERO).expect("turned");
        for &f in &fair {
            let normal = mesh.face_normal(f);
            assert!(mesh.value(held, f).distance(normal) < 1e-9, "{name}: {f:?}");
            let h = mesh.face_halfedge(f);
            assert!(mesh.corner_normal(h).expect("carried").distance(normal) < 1e-9, "{name}: {f:?}");
            met += 1;
        }
        for e in mesh.edges() {
            let (is, was) = (step(&mesh, e), *mesh.value(along, e));
            assert!((is - was).length().min((is + was).length()) <= 1e-12 * size, "{name}: {e:?}");
        }
        mesh.restore(checkpoint).expect("known");
        assert!(fair.iter().all(|&f| *mesh.value(held, f) == mesh.face_normal(f)), "{name}: taken back");
    }
    assert_met(met, 3000);
}

#[test]
fn quarter_turns_of_models_are_exact_and_rotations_follow_rodrigues() {
    for (name, mesh) in few() {
        let before = positions(mesh);
        let mut turned = mesh.clone();
        turned.rotate_degrees(DVec3::Z, -270.0, DVec3::ZERO).expect("turned");
        assert!(positions(&turned).iter().zip(&before).all(|(p, q)| *p == dvec3(-q.y, q.x, q.z)), "{name}");
        // A third of a turn about the diagonal sends X to Y, Y to Z, Z to X.
        let mut turned = mesh.clone();
        turned.rotate_degrees(DVec3::ONE, 120.0, DVec3::ZERO).expect("turned");
        let slack = 4e-16 * before.iter().map(|p| p.length()).fold(0.0, f64::max);
        let near = |(p, q): (&DVec3, &DVec3)| p.distance(dvec3(q.z, q.x, q.y)) <= 4.0 * slack;
        assert!(positions(&turned).iter().zip(&before).all(near), "{name}");
    }
}

#[test]
fn the_wave_takes_models_vertex_by_vertex_in_order() {
    for (name, mesh) in few() {
        let (before, mut seen) = (positions(mesh), Vec::new());
        let wave = |p: DVec3| p + DVec3::Z * ((5.0 * p.x).sin() * (5.0 * p.y).cos() * 0.3);
        let mut wavy = mesh.clone();
        let noted = |p: DVec3| {
            seen.push(p);
            wave(p)
        };
        wavy.deform(noted, DeformOptions::default()).expect("finite");
        assert!(seen == before, "{name}: once for each, in order");
        assert!(positions(&wavy).iter().zip(&before).all(|(p, q)| *p == wave(*q)), "{name}");
    }
}

#[test]
fn flipping_models_or_a_part_of_them_negates_their_normals() {
    for (name, model) in few() {
        let mut mesh = model.clone();
        mesh.compute_normals(NormalWeight::Angle);
        let normals: Vec<_> = mesh.vertices().map(|v| mesh.normal(v).expect("carried")).collect();
        mesh.reverse();
        assert!(mesh.vertices().zip(&normals).all(|(v, n)| mesh.normal(v) == Some(-*n)), "{name}");
        // One part back: only what hangs together with it.
        let part = mesh.components().swap_remove(0);
        mesh.reverse_component(part[0]).expect("live");
        let turned: Vec<_> = part.iter().flat_map(|&f| mesh.face_vertices(f)).collect();
        for (v, n) in mesh.vertices().zip(&normals) {
            let expected = if turned.contains(&v) { *n } else { -*n };
            assert_eq!(mesh.normal(v), Some(expected), "{name}");
        }
        assert_eq!(mesh.validate(), Ok(()), "{name}");
    }
}

#[test]
fn volumes_of_models_are_signed_and_hold_far_away_and_open_ones_have_a_witness() {
    let (mut met, mut open) = (0, 0);
    for (name, mesh) in few() {
        let Ok(solid) = mesh.closed() else {
            let Err(meshwright::NotClosed::Open { boundary }) = mesh.closed() else {
                panic!("{name} has faces")
            };
            assert!(boundary.iter().all(|&h| mesh.is_boundary(h)), "{name}");
            assert_eq!(boundary.len(), mesh.boundary_halfedges().count(), "{name}");
            assert_eq!(mesh.to_indexed().topology().volume(), None, "{name}");
            open += 1;
            continue;
        };
        let (size, far) = reach(mesh);
        let (inside, slack) = (solid.volume(), 1e-13 * (size + far) * solid.area());
        let mut reversed = mesh.clone();
        reversed.reverse();
        assert!((volume(&reversed) + inside).abs() <= slack, "{name}");
        if mesh.faces().all(|f| mesh.degree(f) == 3) {
            let mut away = mesh.clone();
            away.translate(dvec3(1.0, -1.0, 1.0) * 1e6 * size).expect("moved");
            // Only the positions are rounded.
            let slack = 1e-9 * (size + far) * solid.area();
            assert!((volume(&away) - inside).abs() <= slack, "{name}: {} {inside}", volume(&away));
        }
        met += 1;
    }
    assert_met(met, 60);
    assert_met(open, 30);
}

#[test]
fn models_cut_out_of_a_box_leave_a_cavity_that_stays_one() {
    let mut met = 0;
    for (name, mesh) in solids().filter(|(_, mesh)| mesh.components().len() == 1) {
        let (bounds, size) = (mesh.bounds().expect("vertices"), reach(mesh).0);
        let inside = volume(mesh);
        if inside.abs() < 1e-9 * size.powi(3) {
            continue;
        }
        let mut outer = shapes::cube();
        outer.map_positions(|p| bounds.center() + (p - 0.5) * 3.0 * size).expect("finite");
        let whole = (3.0 * size).powi(3);
        for cut in [mesh.to_indexed(), mesh.to_indexed().reversed()] {
            let mut both = shapes::mesh(&shapes::both(&outer, &cut));
            both.orient_outward(OutwardOptions::default()).expect("not cancelled");
            assert!((volume(&both) - (whole - inside.abs())).abs() <= 1e-11 * whole, "{name}");
        }
        met += 1;
    }
    assert_met(met, 40);
}

/// Quads that are twisted, of which many have diagonals of one length: turned, they are the same solid.
#[test]
fn twisted_quads_of_the_corpus_hold_the_same_volume_however_they_are_turned() {
    let mut noise = shapes::Noise(91);
    let mut met = 0;
    let named = [
        "sofa__frog_quads.obj",
        "trimesh__quadknot.obj",
        "cinolib__bamboo_pen.obj",
        "cinolib__cubespikes.obj",
    ];
    for (name, mesh) in models(20_000) {
        if !named.iter().any(|n| name.ends_with(n)) {
            continue;
        }
        let Ok(solid) = mesh.closed() else { continue };
        let before = solid.volume();
        let mut worst = 0.0f64;
        for _ in 0..12 {
            let mut turned = mesh.clone();
            let axis = somewhere(&mut noise, 2.0);
            turned.rotate_degrees(axis, 360.0 * noise.unit(), DVec3::ZERO).expect("turned");
            worst = worst.max((volume(&turned) / before - 1.0).abs());
        }
        eprintln!("{name} {worst:e}");
        assert!(worst < 1e-12, "{name}: {worst:e}");
        met += 1;
    }
    assert_met(met, 4);
}

#[test]
fn mass_properties_of_models_are_those_of_the_tetrahedra_about_a_point() {
    let outer = |v: DVec3| DMat3::from_cols(v * v.x, v * v.y, v * v.z);
    let mut met = 0;
    for (name, mesh) in solids() {
        let (size, middle) = (reach(mesh).0, mesh.bounds().expect("vertices").center());
        let (mut whole, mut first, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
        for f in mesh.faces() {
            let corners: Vec<DVec3> = mesh.face_vertices(f).map(|v| mesh.position(v) - middle).collect();
            let six = corners[0].dot(corners[1].cross(corners[2]));
            let sum: DVec3 = corners.iter().sum();
            whole += six / 6.0;
            first += sum * (six / 24.0);
            second += corners.iter().fold(outer(sum), |m, &p| m + outer(p)) * (six / 120.0);
        }
        if whole < 1e-3 * size.powi(3) {
            continue;
        }
        let center = first / whole;
        second -= outer(center) * whole;
        let trace = second.x_axis.x + second.y_axis.y + second.z_axis.z;
        let inertia = DMat3::IDENTITY * trace - second;
        let found = mesh.closed().expect("closed").mass_properties().expect("a volume");
        assert!((found.volume - whole).abs() <= 1e-10 * whole, "{name}");
        assert!(found.centroid.distance(center + middle) <= 1e-9 * (size + middle.length()), "{name}");
        let off = (found.inertia - inertia).to_cols_array().into_iter().fold(0.0f64, |m, x| m.max(x.abs()));
        assert!(off <= 1e-9 * whole * size * size, "{name}: {} {inertia}", found.inertia);
        met += 1;
    }
    assert_met(met, 30);
}
