//! Cracks and T-junctions, closed along naked edges.

mod shapes;

use meshwright::cleanup::{CleanError, Weld, stitch};
use meshwright::glam::{DVec3, dvec2, dvec3};
use meshwright::{CornerData, Element, IndexedMesh, Kind, Outcome, PolygonSoup, Polygons, Step};
use proptest::prelude::*;
use shapes::{Noise, both, cube, cube_at, fanned, soup, unwelded};

const TOLERANCE: f64 = 1e-3;

fn stitched(soup: &PolygonSoup) -> Outcome<IndexedMesh> {
    within(soup, TOLERANCE)
}

/// Stitches, and checks what always holds.
fn within(soup: &PolygonSoup, tolerance: f64) -> Outcome<IndexedMesh> {
    let before = stitch(soup, Weld::Exact, 0.0).expect("never refused");
    let after = stitch(soup, Weld::Exact, tolerance).expect("never refused");
    let facts = |pool: &IndexedMesh| {
        let topology = pool.topology();
        (topology.boundary_edges().count(), topology.nonmanifold_edges().count())
    };
    let ((naked, more), (naked_after, more_after)) = (facts(&before.value), facts(&after.value));
    assert!(more_after <= more, "no edge gets a third face: {more} {more_after}");
    let step = after.report.steps.iter().find(|s| s.step == Step::Stitch).expect("a step");
    assert_eq!(step.changed == 0, after.value == before.value);
    assert!(step.changed == 0 || length(&after.value) < length(&before.value), "{naked} {naked_after}");
    assert!(step.moved <= tolerance);

    // Nothing moves farther than the tolerance, by the maps.
    for (v, &p) in soup.positions.iter().enumerate() {
        for &n in after.maps.vertices.new_of(v) {
            assert!(p.distance(after.value.positions()[n as usize]) <= tolerance * (1.0 + 1e-9));
        }
    }
    let at = |v: u32| after.value.positions()[v as usize];
    for (f, face) in after.value.polygons().iter().enumerate() {
        let old = after.maps.faces.old_of(f)[0];
        let old: Vec<DVec3> =
            soup.polygons[old as usize].iter().map(|&v| soup.positions[v as usize]).collect();
        for &v in face {
            let sides = (0..old.len()).map(|i| to_segment(at(v), old[i], old[(i + 1) % old.len()]));
            let nearest = sides.fold(f64::INFINITY, f64::min);
            assert!(nearest <= tolerance * (1.0 + 1e-9), "face {f}: {nearest}");
        }
    }
    after
}

fn to_segment(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let t = (p - a).dot(b - a) / (b - a).length_squared();
    p.distance(a + (b - a) * if t.is_nan() { 0.0 } else { t.clamp(0.0, 1.0) })
}

/// Of all naked edges.
fn length(pool: &IndexedMesh) -> f64 {
    let at = |v: u32| pool.positions()[v as usize];
    pool.topology().boundary_edges().map(|e| e.vertices()).map(|[a, b]| at(a).distance(at(b))).sum()
}

fn is_solid(outcome: &Outcome<IndexedMesh>) {
    let topology = outcome.value.topology();
    let left: Vec<[u32; 2]> = topology.boundary_edges().map(|e| e.vertices()).collect();
    assert_eq!(left, [[0; 2]; 0], "naked");
    assert!(topology.is_closed() && topology.is_oriented());
}

fn no_face_without_area(pool: &IndexedMesh) {
    for face in pool.polygons().iter() {
        let at = |i: usize| pool.positions()[face[i] as usize];
        let area: DVec3 = (2..face.len()).map(|i| (at(i - 1) - at(0)).cross(at(i) - at(0))).sum();
        assert!(area.length() > 1e-9, "{face:?}");
    }
}

fn changed(outcome: &Outcome<IndexedMesh>) -> usize {
    outcome.report.count(Kind::StitchedEdge) + outcome.report.count(Kind::TJunction)
}

/// The face of the unit cube at `z = 1`, cut into `n` by `m` squares, all with corners of their own.
fn tiles(n: u32, m: u32) -> PolygonSoup {
    let at = |i: u32, j: u32| dvec3(f64::from(i) / f64::from(n), f64::from(j) / f64::from(m), 1.0);
    let square = |(i, j): (u32, u32)| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
    let all = (0..n).flat_map(|i| (0..m).map(move |j| (i, j)));
    let positions: Vec<DVec3> = all.flat_map(square).collect();
    let polygons = (0..n * m).map(|i| (4 * i..4 * i + 4).collect::<Vec<_>>()).collect();
    PolygonSoup::new(positions, polygons)
}

fn with(mut a: PolygonSoup, b: &PolygonSoup) -> PolygonSoup {
    let offset = a.positions.len() as u32;
    a.positions.extend(&b.positions);
    a.polygons.extend(b.polygons.iter().map(|f| f.iter().map(|v| v + offset).collect::<Vec<_>>()));
    a
}

/// The unit cube without its face at `z = 1`.
fn box_without_lid(of: &IndexedMesh) -> PolygonSoup {
    let is_lid = |f: &&[u32]| f.iter().all(|&v| of.positions()[v as usize].z == 1.0);
    let faces: Polygons = of.polygons().iter().filter(|f| !is_lid(f)).map(<[u32]>::to_vec).collect();
    PolygonSoup::new(of.positions().to_vec(), faces)
}

#[test]
fn a_cube_with_one_face_cut_against_its_neighbours_closes() {
    for (n, m) in [(1, 1), (2, 2), (3, 5), (7, 1)] {
        let quads = with(box_without_lid(&cube()), &tiles(n, m));
        let outcome = stitched(&quads);
        is_solid(&outcome);
        assert_eq!(outcome.report.count(Kind::TJunction), 2 * (n + m) as usize - 4);
        assert_eq!(outcome.value.face_count(), 5 + (n * m) as usize, "quads stay polygons");
        let triangles = with(box_without_lid(&fanned(&cube())), &tiles(n, m));
        let outcome = stitched(&triangles);
        is_solid(&outcome);
        no_face_without_area(&outcome.value);
        assert!(outcome.value.polygons().iter().take(10).all(|f| f.len() == 3));
    }
}

#[test]
fn a_cube_whose_faces_are_all_cut_by_their_own_grids_closes() {
    let turn = |soup: PolygonSoup, by: fn(DVec3) -> DVec3| PolygonSoup {
        positions: soup.positions.into_iter().map(|p| by(p - 0.5) + 0.5).collect(),
        ..soup
    };
    let sides: [fn(DVec3) -> DVec3; 6] = [
        |p| p,
        |p| dvec3(p.x, -p.y, -p.z),
        |p| dvec3(p.z, p.x, p.y),
        |p| dvec3(-p.z, -p.x, p.y),
        |p| dvec3(p.y, p.z, p.x),
        |p| dvec3(p.y, -p.z, -p.x),
    ];
    let grids = [(2, 3), (4, 5), (3, 3), (6, 1), (1, 7), (5, 2)];
    let parts = sides.iter().zip(grids).map(|(&by, (n, m))| turn(tiles(n, m), by));
    let whole = parts.reduce(|a, b| with(a, &b)).expect("six faces");
    let outcome = stitched(&whole);
    is_solid(&outcome);
    // The same with noise of a part of the tolerance.
    let mut noise = Noise(11);
    let mut jittered = whole;
    for p in &mut jittered.positions {
        *p += dvec3(noise.unit(), noise.unit(), noise.unit()) * (TOLERANCE * 0.3);
    }
    is_solid(&stitched(&jittered));
}

#[test]
fn a_fan_against_an_edge_closes() {
    // A triangle, and below its edge a fan of triangles around one vertex.
    let n = 20u32;
    let mut points = vec![DVec3::ZERO, dvec3(1., 0., 0.), dvec3(0.5, 1., 0.), dvec3(0.4, -1., 0.)];
    points.extend((1..n).map(|i| dvec3(f64::from(i) / f64::from(n), 0., 0.)));
    let mut faces = vec![vec![0, 1, 2]];
    let on_edge: Vec<u32> = std::iter::once(0).chain(4..4 + n - 1).chain([1]).collect();
    faces.extend(on_edge.windows(2).map(|w| vec![3, w[1], w[0]]));
    let outcome = stitched(&PolygonSoup::new(points, faces.into()));
    assert_eq!(outcome.report.count(Kind::TJunction), 19);
    assert_eq!((outcome.value.face_count(), outcome.value.topology().boundary_edges().count()), (40, 4));
    no_face_without_area(&outcome.value);
    let place = outcome.report.records[0];
    assert_eq!((place.element, place.place), (Element::VertexOnEdge([4, 0, 1]), Some(dvec3(0.05, 0., 0.))));
}

#[test]
fn corner_data_is_interpolated_along_the_edge() {
    let points = [(0., 0.), (4., 0.), (4., 4.), (0., 4.), (1., 4.), (0., 6.), (4., 6.)];
    let points = points.map(|(x, y)| dvec3(x, y, 0.)).to_vec();
    for first in [vec![vec![0, 1, 2, 3]], vec![vec![0, 1, 2], vec![0, 2, 3]]] {
        let faces: Vec<Vec<u32>> = first.into_iter().chain([vec![3, 4, 5], vec![4, 2, 6]]).collect();
        let mut soup = PolygonSoup::new(points.clone(), faces.into());
        let values: Vec<[f64; 2]> = soup
            .polygons
            .corners()
            .iter()
            .map(|&v| [points[v as usize].x * 10.0, points[v as usize].y])
            .collect();
        soup.corner_uvs = Some(CornerData { indices: (0..values.len() as u32).collect(), values });
        let outcome = stitched(&soup);
        assert_eq!(outcome.report.count(Kind::TJunction), 1);
        let uvs = outcome.value.attributes().corner_uvs.as_ref().expect("carried");
        for (&v, uv) in outcome.value.polygons().corners().iter().zip(uvs) {
            let p = outcome.value.positions()[v as usize];
            assert_eq!(*uv, Some(dvec2(p.x * 10.0, p.y)));
        }
    }
}

#[test]
fn a_crack_of_half_a_tolerance_along_a_seam_closes() {
    let truth = shapes::icosphere(3);
    let mut cracked = soup(&truth);
    let offset = cracked.positions.len() as u32;
    cracked.positions.extend(truth.positions().iter().map(|p| *p + dvec3(0.3, 0.3, 0.3) * TOLERANCE));
    let upper = |f: &[u32]| f.iter().map(|&v| truth.positions()[v as usize].z).sum::<f64>() > 0.0;
    let faces = truth.polygons().iter();
    cracked.polygons =
        faces.map(|f| f.iter().map(|&v| v + offset * u32::from(upper(f))).collect::<Vec<_>>()).collect();
    let outcome = stitched(&cracked);
    is_solid(&outcome);
    let step = outcome.report.steps.iter().find(|s| s.step == Step::Stitch).expect("a step");
    assert!((step.moved / TOLERANCE - 0.27f64.sqrt()).abs() < 1e-6);
    assert_eq!(outcome.report.count(Kind::TJunction), 0);
    assert_eq!(outcome.report.count(Kind::MergedVertex), outcome.report.count(Kind::StitchedEdge));
    for record in outcome.report.records.iter().filter(|r| r.kind == Kind::MergedVertex) {
        assert!(matches!(record.element, Element::Vertex(v) if v >= offset), "the lower vertex stays");
        assert_eq!(record.step, Step::Stitch);
    }
}

#[test]
fn parts_that_merely_touch_stay_apart() {
    let near = DVec3::splat(TOLERANCE * 0.3);
    let sheet =
        shapes::pool(vec![DVec3::ZERO, DVec3::X, DVec3::ONE.with_z(0.0), DVec3::Y], vec![vec![0, 1, 2, 3]]);
    let other = |by: fn(DVec3) -> DVec3| {
        IndexedMesh::new(sheet.positions().iter().map(|p| by(*p)).collect(), sheet.polygons().clone())
            .expect("valid")
    };
    let cases = [
        both(&cube(), &cube_at(DVec3::X + near)),
        both(&cube(), &cube_at(DVec3::ONE + near)),
        both(&fanned(&cube()), &cube_at(dvec3(1.0, 0.3, 0.2) + near)),
        // Two sheets: corner to corner, a corner on an edge, crosswise.
        both(&sheet, &other(|p| p + dvec3(1.0, 1.0, 0.0002))),
        both(&sheet, &other(|p| dvec3(1.0 + p.x + p.y, 0.5 + p.x - p.y, 0.0))),
        both(&sheet, &other(|p| dvec3(1.0, p.x - 0.5, p.y - 0.4))),
    ];
    for (i, case) in cases.iter().enumerate() {
        assert_eq!(changed(&stitched(&soup(case))), 0, "case {i}");
    }
}

#[test]
fn a_vertex_near_an_edge_of_its_own_face_stays() {
    // A needle: its apex is within the tolerance of its base.
    let needle = vec![DVec3::ZERO, DVec3::X, dvec3(0.4, 0.5 * TOLERANCE, 0.0)];
    let needle = PolygonSoup::new(needle, Polygons::from_triangles(&[[0, 1, 2]]));
    assert_eq!(changed(&stitched(&needle)), 0);
    // A polygon that comes near itself.
    let hook = [(0., 0.), (3., 0.), (3., 2.), (1.5, 0.0005), (0., 2.)].map(|(x, y)| dvec3(x, y, 0.0));
    let hook = PolygonSoup::new(hook.to_vec(), Polygons::from(vec![vec![0, 1, 2, 3, 4]]));
    assert_eq!(changed(&stitched(&hook)), 0);
}

#[test]
fn edges_cut_differently_on_both_sides_close_along_the_chain() {
    // Two strips along y = 0, one with ends at every third, the other at every quarter, a little off the line.
    let strip = |n: u32, up: f64| {
        let at = |i: u32, y: f64| dvec3(f64::from(i) / f64::from(n), y, 0.0);
        let off = |i: u32| if i.is_multiple_of(n) { 0.0 } else { up * TOLERANCE * 0.4 };
        let quad = |i: u32| {
            let quad = vec![at(i, off(i)), at(i + 1, off(i + 1)), at(i + 1, up), at(i, up)];
            if up > 0.0 { quad } else { quad.into_iter().rev().collect() }
        };
        let positions: Vec<DVec3> = (0..n).flat_map(quad).collect();
        PolygonSoup::new(positions, (0..n).map(|i| (4 * i..4 * i + 4).collect::<Vec<_>>()).collect())
    };
    let outcome = stitched(&with(strip(3, 1.0), &strip(4, -1.0)));
    assert_eq!(outcome.report.count(Kind::TJunction), 5);
    assert_eq!(outcome.value.topology().boundary_edges().count(), 3 + 4 + 4);
    assert_eq!(outcome.value.face_count(), 7);
}

#[test]
fn mixed_windings_do_not_keep_a_crack_open() {
    let truth = shapes::some_reversed(&shapes::icosphere(2), 2, 5);
    let mut noise = Noise(8);
    let mut jittered = unwelded(&truth);
    for p in &mut jittered.positions {
        *p += dvec3(noise.unit(), noise.unit(), noise.unit()) * (TOLERANCE * 0.3);
    }
    let outcome = stitched(&jittered);
    assert!(outcome.value.topology().is_closed());
    assert_eq!(outcome.value.vertex_count(), truth.vertex_count());
}

#[test]
fn three_sheets_at_an_edge_are_not_joined_to_one_edge() {
    let quad =
        |p: DVec3, z: f64| [dvec3(0., 0., z), dvec3(0., 1., z), dvec3(p.x, 1., p.z), dvec3(p.x, 0., p.z)];
    let sheets = [quad(DVec3::X, 0.0), quad(-DVec3::X, 1e-4), quad(DVec3::Z, 3e-4)];
    let faces = (0..3u32).map(|i| (4 * i..4 * i + 4).collect::<Vec<_>>()).collect();
    let outcome = stitched(&PolygonSoup::new(sheets.concat(), faces));
    assert_eq!(outcome.report.count(Kind::StitchedEdge), 1);
    assert_eq!(outcome.value.topology().boundary_edges().count(), 10);
}

#[test]
fn a_tolerance_that_makes_no_sense_is_refused() {
    for t in [-1.0, f64::NAN, f64::INFINITY] {
        let refused = stitch(&PolygonSoup::default(), Weld::Exact, t);
        assert!(matches!(refused, Err(CleanError::BadTolerance(_))));
    }
}

#[test]
fn soups_with_jitter_as_large_as_their_short_edges_close_for_the_most_part() {
    let truth = shapes::bracket(64);
    let mut noise = Noise(21);
    let mut jittered = unwelded(&truth);
    // The sides of the hole are 1.18 long.
    for p in &mut jittered.positions {
        *p += (dvec3(noise.unit(), noise.unit(), noise.unit()) - 0.5) * 0.8;
    }
    let outcome = within(&jittered, 1.4);
    let naked = outcome.value.topology().boundary_edges().count();
    assert!(
        naked * 10 <= jittered.polygons.corners().len(),
        "{naked} of {}",
        jittered.polygons.corners().len()
    );
    assert_eq!(outcome.value.face_count(), truth.face_count(), "no face folds");
}

#[test]
fn files_made_to_be_quadratic_are_not() {
    // Triangles that all have an edge along one line, with ends in random places within it; or all at one place.
    let n = 20_000u32;
    for (length, spread) in [(1e-3, 1.0), (0.9, 0.1), (1e-5, 1e-9)] {
        let mut noise = Noise(3);
        let triangle = |_| {
            let (x, y) = (noise.unit() * spread, noise.unit());
            [dvec3(x, 0.0, 0.0), dvec3(x + length * (0.5 + y), 0.0, 0.0), dvec3(x, 1.0, noise.unit())]
        };
        let points: Vec<DVec3> = (0..n).flat_map(triangle).collect();
        let soup = PolygonSoup::new(points, (0..n).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect());
        for tolerance in [1e-8, 1e-4, 1e-2] {
            let start = cpu_time::ProcessTime::now();
            stitch(&soup, Weld::Exact, tolerance).expect("never refused");
            // A quadratic walk takes minutes.
            assert!(start.elapsed().as_secs() < 60, "{length} {spread} {tolerance}: {:?}", start.elapsed());
        }
    }
}

/// A closed mesh some edges of which have further vertices in one of their two faces only, moved by up to `jitter`.
fn half_split(of: &IndexedMesh, seed: u64, jitter: f64) -> PolygonSoup {
    let mut noise = Noise(seed);
    let mut positions = of.positions().to_vec();
    let mut taken = std::collections::BTreeSet::new();
    let mut faces: Vec<Vec<u32>> = Vec::new();
    for face in of.polygons().iter() {
        let mut corners = Vec::new();
        for (i, &a) in face.iter().enumerate() {
            let b = face[(i + 1) % face.len()];
            corners.push(a);
            if noise.below(3) == 0 && taken.insert((a.min(b), a.max(b))) {
                let n = 1 + noise.below(3);
                for k in 1..=n {
                    let (p, q) = (of.positions()[a as usize], of.positions()[b as usize]);
                    let off = dvec3(noise.unit(), noise.unit(), noise.unit()) - 0.5;
                    corners.push(positions.len() as u32);
                    positions.push(p.lerp(q, f64::from(k) / f64::from(n + 1)) + off * jitter);
                }
            }
        }
        faces.push(corners);
    }
    PolygonSoup::new(positions, faces.into())
}

proptest! {
    #[test]
    fn edges_split_on_one_side_only_close_again(seed in 0u64..1 << 40, shape in 0usize..5, jitter in prop_oneof![Just(0.0), Just(1.0)]) {
        let truth = [cube(), fanned(&cube()), shapes::icosphere(2), shapes::torus(12, 7), shapes::bracket(16)][shape].clone();
        let split = half_split(&truth, seed, jitter * TOLERANCE);
        let outcome = stitched(&split);
        is_solid(&outcome);
        no_face_without_area(&outcome.value);
        let further = split.positions.len() - truth.vertex_count();
        prop_assert_eq!(outcome.report.count(Kind::TJunction), further);
        prop_assert_eq!(outcome.value.vertex_count(), split.positions.len());
        // Again, nothing is left to do.
        let again = stitched(&soup(&outcome.value));
        prop_assert_eq!(changed(&again), 0);
        prop_assert_eq!(again.value.polygons(), outcome.value.polygons());
    }
}
