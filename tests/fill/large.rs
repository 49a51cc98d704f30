//! Long loops, many holes, models of the corpus, libigl.

use super::*;

#[test]
fn long_loops_are_filled_by_ears_as_short_ones() {
    let wave = |n: u32, z: f64| -> Vec<DVec3> {
        let bend = |p: DVec3| {
            p * (1.0 + 0.2 * (9.0 * p.y.atan2(p.x)).sin()) + DVec3::Z * (0.3 * (4.0 * p.x).sin() + z)
        };
        circle(n, 1.0, 0.0).into_iter().map(bend).collect()
    };
    let mut least = shapes::mesh(&tube(&[wave(480, 0.0), wave(480, 3.0)]));
    let mut ears = least.clone();
    let exact = filled(&mut least, options());
    let fast = filled(&mut ears, FillHolesOptions { exact_edges: 100, ..options() });
    for (a, b) in exact.filled.iter().zip(&fast.filled) {
        assert_eq!((a.method, b.method), (FillMethod::LeastArea, FillMethod::Ears));
        assert!((1.0..1.05).contains(&(b.area / a.area)), "{} and {}", b.area, a.area);
    }
    let mut mesh = shapes::mesh(&tube(&[wave(30_000, 0.0), wave(30_000, 3.0)]));
    let long = filled(&mut mesh, options());
    assert!(mesh.is_closed() && (long.filled[0].area / exact.filled[0].area - 1.0).abs() < 0.05);
}

#[test]
fn scales_near_the_ends_of_the_numbers_do_no_harm() {
    let filled_at = |exponent: i32| {
        let sphere = icosphere(2);
        let scaled = sphere.positions().iter().map(|&p| p * 2f64.powi(exponent)).collect();
        let mut mesh = shapes::mesh(&IndexedMesh::new(scaled, sphere.polygons().clone()).expect("finite"));
        riddle(&mut mesh, 5, 20);
        mesh.fill_holes(options()).expect("fills");
        assert!(mesh.is_closed());
        mesh.to_indexed().polygons().clone()
    };
    for exponent in [-500, 490] {
        assert_eq!(filled_at(exponent), filled_at(0), "2^{exponent}");
    }
    let mut mesh = shapes::mesh(&icosphere(1));
    riddle(&mut mesh, 1, 20);
    for (i, v) in mesh.vertices().collect::<Vec<_>>().into_iter().enumerate() {
        mesh.set_position(v, if i % 2 == 0 { DVec3::splat(f64::MAX) } else { -DVec3::splat(f64::MAX) })
            .expect("finite");
    }
    mesh.fill_holes(options()).expect("answers");
    assert_eq!(mesh.validate(), Ok(()));
    assert_eq!(Mesh::default().fill_holes(options()), Ok(FilledHoles::default()));
}

#[cfg(feature = "serde")]
#[test]
fn the_account_serialises() {
    let mut mesh = without(&grid(4), |f| f == 11);
    let account = filled(&mut mesh, options());
    let json = serde_json::to_value(&account).expect("serialises");
    assert_eq!(json["filled"][0]["edges"], 3);
    assert_eq!(json["filled"][0]["method"], "one_face");
    assert_eq!(json["refused"][0]["vertices"].as_array().map(Vec::len), Some(16));
    assert!(json["refused"][0]["reason"]["sheet"].as_f64() > Some(0.8));
}

/// Removes random faces; on a mesh, so that every vertex keeps one fan.
pub(crate) fn riddle(mesh: &mut Mesh, seed: u64, share: u32) {
    let mut noise = Noise(seed);
    for f in mesh.faces().collect::<Vec<_>>() {
        if noise.below(100) < share {
            // Refused where a vertex would get two fans.
            let _ = mesh.remove_face(f);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn a_riddled_mesh_is_closed_again(shape in 0..4, seed in any::<u64>(), share in 1u32..40, exact in 0usize..40) {
        let shape = match shape {
            0 => icosphere(2),
            1 => fanned(&torus(12, 9)),
            2 => torus(9, 6),
            _ => both(&icosphere(1), &torus(5, 5)),
        };
        let mut mesh = shapes::mesh(&shape);
        let euler = mesh.euler_characteristic();
        riddle(&mut mesh, seed, share);
        let mut again = mesh.clone();
        // A component may have come off as a sheet, or be gone with its vertices.
        let parts = mesh.components().len();
        let isolated = mesh.vertices().filter(|&v| mesh.is_isolated(v)).count() as i64;
        let options = || FillHolesOptions {
            exact_edges: exact, max_area_ratio: f64::INFINITY, island_depth: 0.0, ..options()
        };
        let account = filled(&mut mesh, options());
        for refused in &account.refused {
            prop_assert!(!matches!(refused.reason, HoleRefusal::Sheet(_) | HoleRefusal::TooLong(_)));
        }
        if account.refused.is_empty() {
            prop_assert!(mesh.is_closed());
            // Each hole that was a disc is one again; cuts through a handle lower the genus, separate parts add spheres.
            let now = mesh.euler_characteristic();
            prop_assert!(now >= euler && (now - euler) % 2 == 0);
            if parts == 1 && isolated == 0 && share < 5 && euler == 2 {
                prop_assert_eq!(now, euler);
            }
        }
        prop_assert_eq!(&filled(&mut again, options()), &account, "the same every time");
        prop_assert_eq!(again.to_indexed(), mesh.to_indexed());
    }
}

#[test]
fn open_models_of_the_corpus_are_filled_or_refused_with_reasons() {
    let Some(rows) = corpus::rows() else { return };
    let (mut open, mut closed, mut holes, mut kept) = (0, 0, 0, 0);
    let mut reasons = std::collections::BTreeMap::<String, usize>::new();
    for row in rows.iter().filter(|r| r.is_readable()) {
        let Ok(soup) = row.load() else { continue };
        let mut mesh = clean(&soup, CleanOptions::default()).expect("a soup is never refused").value;
        if mesh.is_closed() {
            continue;
        }
        let start = std::time::Instant::now();
        let account = filled(&mut mesh, options());
        let time = start.elapsed().as_secs_f64();
        open += 1;
        closed += usize::from(mesh.is_closed());
        holes += account.filled.len();
        kept += account.refused.len();
        for refused in &account.refused {
            let name = format!("{:?}", refused.reason);
            *reasons.entry(name.split('(').next().unwrap_or_default().to_owned()).or_insert(0) += 1;
            if !matches!(refused.reason, HoleRefusal::Sheet(_) | HoleRefusal::OneFace(_)) {
                println!("  {} of {} edges", refused.reason, refused.vertices.len());
            }
        }
        println!(
            "{}: {} filled, {} refused, {time:.3} s",
            row.path,
            account.filled.len(),
            account.refused.len()
        );
        assert!(time < 10.0, "{}: {time} s", row.path);
    }
    println!("{open} open models: {closed} closed, {holes} holes filled, {kept} refused: {reasons:?}");
    assert!(open > 30 && closed > 10);
}

#[test]
fn libigl_finds_filled_meshes_closed_and_manifold() {
    let mut igl = igl::Igl::start();
    for (shape, seed) in [(icosphere(3), 1), (fanned(&torus(20, 12)), 2), (icosphere(2), 3)] {
        let mut mesh = shapes::mesh(&shape);
        riddle(&mut mesh, seed, 15);
        let account = filled(&mut mesh, sheets_too());
        if !account.refused.is_empty() {
            continue;
        }
        let opinion = igl.ask(&mesh.to_indexed());
        assert!(opinion.is("edge_manifold") && opinion.integers("boundary").is_empty());
        let isolated: Vec<bool> = mesh.vertices().map(|v| mesh.is_isolated(v)).collect();
        assert!(opinion.flags("vertex_manifold").iter().zip(isolated).all(|(&fine, alone)| fine || alone));
    }
}
