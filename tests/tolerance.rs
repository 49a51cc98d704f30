//! The tolerance that is proposed for a weld.

mod shapes;

use meshwright::cleanup::{Weld, index, propose_tolerance, propose_tolerance_with_reasons};
use meshwright::glam::{DVec3, dvec3};
use meshwright::{IndexedMesh, PolygonSoup};
use shapes::{Noise, both, cube, cube_at, fanned, unwelded};

/// Every face with corners of its own, each moved by up to `amount` along each axis.
fn jittered(of: &IndexedMesh, amount: f64, seed: u64) -> PolygonSoup {
    let mut soup = unwelded(of);
    let mut noise = Noise(seed);
    let mut move_by = || (noise.unit() * 2.0 - 1.0) * amount;
    soup.positions.iter_mut().for_each(|p| *p += dvec3(move_by(), move_by(), move_by()));
    soup
}

fn diagonal(of: &IndexedMesh) -> f64 {
    let low = of.positions().iter().copied().reduce(DVec3::min).expect("not empty");
    let high = of.positions().iter().copied().reduce(DVec3::max).expect("not empty");
    low.distance(high)
}

fn solids() -> Vec<(&'static str, IndexedMesh)> {
    vec![
        ("cube", cube()),
        ("cube in triangles", fanned(&cube())),
        ("sphere", shapes::icosphere(3)),
        ("torus", shapes::torus(24, 12)),
        ("bracket", shapes::bracket(48)),
        ("two cubes", both(&cube(), &cube_at(DVec3::X * 1.5))),
    ]
}

#[test]
fn jittered_soups_weld_to_the_true_vertices() {
    for (name, truth) in solids() {
        for amount in [1e-12, 1e-9, 1e-7, 1e-6, 1e-5, 1e-4] {
            for seed in 0..4 {
                let soup = jittered(&truth, amount * diagonal(&truth), seed);
                let proposed = propose_tolerance_with_reasons(&soup);
                let welded = index(&soup, Weld::Auto).expect("never refused");
                assert_eq!(
                    welded.value.vertex_count(),
                    truth.vertex_count(),
                    "{name} {amount:e}: {proposed:?}"
                );
                assert!(welded.value.topology().is_closed(), "{name} {amount:e}: {proposed:?}");
                assert_eq!((proposed.naked_after, welded.value.face_count()), (0, truth.face_count()));
            }
        }
    }
}

#[test]
fn jitter_of_a_part_of_the_shortest_edge_welds_to_the_true_vertices() {
    for (name, truth) in solids() {
        let topology = truth.topology();
        let at = |v: u32| truth.positions()[v as usize];
        let length = |[a, b]: [u32; 2]| at(a).distance(at(b));
        let shortest = topology.edges().map(|e| length(e.vertices())).fold(f64::INFINITY, f64::min);
        for part in [0.001, 0.01, 0.05, 0.1] {
            let soup = jittered(&truth, part * shortest, 5);
            let proposed = propose_tolerance_with_reasons(&soup);
            let welded = index(&soup, Weld::Auto).expect("never refused").value;
            assert_eq!(welded.vertex_count(), truth.vertex_count(), "{name} {part}: {proposed:?}");
        }
    }
}

#[test]
fn clean_files_are_welded_exactly() {
    for (_, truth) in solids() {
        assert_eq!(propose_tolerance(&truth.clone().into()), 0.0);
        assert_eq!(propose_tolerance(&unwelded(&truth)), 0.0);
    }
}

#[test]
fn a_boundary_that_is_meant_is_welded_exactly() {
    let star: Vec<Vec<u32>> = (0..12).map(|i| vec![0, 1 + i, 1 + (i + 1) % 12]).collect();
    let radius = |i: u32| if i.is_multiple_of(2) { 1.0 } else { 0.4 };
    let spike = |i: u32| {
        let angle = f64::from(i) * std::f64::consts::TAU / 12.0;
        dvec3(angle.cos(), angle.sin(), 0.0) * radius(i)
    };
    let star = shapes::pool(std::iter::once(DVec3::ZERO).chain((0..12).map(spike)).collect(), star);
    let apart = both(
        &shapes::grid(6),
        &IndexedMesh::from_triangles(
            shapes::grid(6).positions().iter().map(|p| *p + DVec3::Z * 0.2).collect(),
            &shapes::grid(6).polygons().iter().map(|f| [f[0], f[2], f[1]]).collect::<Vec<_>>(),
        )
        .expect("a valid vertex pool"),
    );
    for (name, open) in [
        ("grid", shapes::grid(20)),
        ("star", star),
        ("moebius", shapes::moebius(9)),
        ("sheets", apart),
        ("fins", shapes::fins()),
    ] {
        let proposed = propose_tolerance_with_reasons(&open.clone().into());
        assert_eq!(proposed.tolerance, 0.0, "{name}: {proposed:?}");
        let proposed = propose_tolerance_with_reasons(&unwelded(&open));
        assert_eq!(proposed.tolerance, 0.0, "{name}: {proposed:?}");
    }
}

#[test]
fn a_crack_in_a_sphere_is_bridged_and_nothing_else() {
    let truth = shapes::icosphere(3);
    let mut soup: PolygonSoup = truth.clone().into();
    // The faces of one half get vertices of their own.
    let offset = soup.positions.len() as u32;
    let moved: Vec<DVec3> = soup.positions.iter().map(|p| *p + DVec3::X * 1e-5).collect();
    soup.positions.extend(moved);
    let faces: Vec<Vec<u32>> = truth
        .polygons()
        .iter()
        .map(|f| {
            let upper = f.iter().map(|&v| truth.positions()[v as usize].z).sum::<f64>() > 0.0;
            f.iter().map(|&v| if upper { v + offset } else { v }).collect()
        })
        .collect();
    soup.polygons = faces.into();
    let proposed = propose_tolerance_with_reasons(&soup);
    assert!((1e-5..1e-4).contains(&proposed.tolerance), "{proposed:?}");
    assert_eq!(proposed.naked_after, 0);
}

#[test]
fn triangles_at_random_are_not_noise() {
    let mut noise = Noise(5);
    let mut unit = || noise.unit();
    for flat in [1.0, 0.0] {
        let points: Vec<DVec3> = (0..9000).map(|_| dvec3(unit(), unit(), unit() * flat)).collect();
        let faces = (0..3000).map(|i| vec![3 * i, 3 * i + 1, 3 * i + 2]).collect::<Vec<_>>();
        let proposed = propose_tolerance_with_reasons(&PolygonSoup::new(points, faces.into()));
        assert_eq!((proposed.tolerance, proposed.reach), (0.0, 0.0), "{proposed:?}");
    }
}

#[test]
fn a_large_polygon_that_is_there_twice_does_not_speak_against_a_tolerance() {
    let truth = shapes::bracket(48);
    let mut soup = jittered(&truth, 1e-6 * diagonal(&truth), 3);
    let large = truth.polygons().iter().max_by_key(|f| f.len()).expect("faces").to_vec();
    for _ in 0..2 {
        soup.polygons.push((soup.positions.len() as u32..).take(large.len()));
        soup.positions.extend(large.iter().map(|&v| truth.positions()[v as usize]));
    }
    let welded = index(&soup, Weld::Auto).expect("never refused").value;
    assert_eq!(welded.vertex_count(), truth.vertex_count());
}

#[test]
fn fins_around_one_edge_are_not_laid_on_each_other() {
    let mut noise = Noise(5);
    for n in [30u32, 300, 3000] {
        let even = |i: u32| (f64::from(i) / f64::from(n) * std::f64::consts::TAU).sin_cos();
        let around = (0..n).map(even).map(|(s, c)| dvec3(c, s, 0.5)).collect::<Vec<_>>();
        let anywhere = (0..n).map(|_| dvec3(noise.unit(), noise.unit(), noise.unit())).collect();
        for apexes in [around, anywhere] {
            let points = [DVec3::ZERO, DVec3::Z].into_iter().chain(apexes).collect();
            let fins: meshwright::Polygons = (0..n).map(|i| [0, 1, i + 2]).collect();
            let proposed = propose_tolerance_with_reasons(&PolygonSoup::new(points, fins));
            assert_eq!((proposed.tolerance, proposed.reach), (0.0, 0.0), "{n}: {proposed:?}");
        }
    }
}
