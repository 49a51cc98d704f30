//! Self-intersections: named cases, and beside them all pairs of triangles in rational arithmetic.

mod corpus;
mod exact;
mod shapes;

use meshwright::cleanup::{CleanOptions, clean};
use meshwright::glam::{DVec3, dvec3};
use meshwright::{
    Control, IndexedMesh, Mesh, PolygonSoup, Polygons, Progress, SelfIntersectionOptions, SelfIntersections,
};
use proptest::prelude::*;
use shapes::Noise;
use std::ops::ControlFlow;

fn ask(mesh: &Mesh) -> SelfIntersections {
    mesh.self_intersections(SelfIntersectionOptions::default()).expect("nobody cancels")
}

fn counts(mesh: &Mesh) -> [usize; 3] {
    let found = ask(mesh);
    assert_eq!(found.pairs.len(), found.count());
    [found.crossings, found.overlaps, found.touches]
}

/// The pairs as numbers, each with its contact.
fn numbered(mesh: &Mesh, found: &SelfIntersections) -> Vec<([usize; 2], u8)> {
    let faces: Vec<_> = mesh.faces().collect();
    let number = |f| faces.iter().position(|&g| g == f).expect("of the mesh");
    found.pairs.iter().map(|p| (p.faces.map(number), p.contact as u8)).collect()
}

/// Compares with the naive twin, and says how many pairs there are of each kind.
fn check(mesh: &Mesh) -> [usize; 3] {
    let found = ask(mesh);
    assert_eq!(
        numbered(mesh, &found),
        exact::self_intersections(&exact::triangles(mesh)),
        "{:?}",
        mesh.to_indexed()
    );
    let near = meshwright::ClosestOptions::default();
    for pair in &found.pairs {
        for f in pair.faces {
            let corners: Vec<DVec3> = mesh.face_vertices(f).map(|v| mesh.position(v)).collect();
            let alone =
                shapes::mesh(&shapes::pool(corners.clone(), vec![(0..corners.len() as u32).collect()]));
            let on = alone.index().closest_point(pair.place, near).expect("finite").expect("a face");
            // The rule may cut the face alone another way if it is not flat.
            assert!(on.distance < 1e-9 || corners.len() > 3, "{pair:?} is {} off", on.distance);
        }
    }
    [found.crossings, found.overlaps, found.touches]
}

fn cubes(offset: DVec3) -> Mesh {
    shapes::mesh(&shapes::both(&shapes::cube(), &shapes::cube_at(offset)))
}

/// Some faces over points, as clean-up makes a mesh of them.
fn cleaned(points: Vec<DVec3>, faces: Vec<Vec<u32>>) -> Mesh {
    clean(&PolygonSoup::new(points, Polygons::from(faces)), CleanOptions::default())
        .expect("always answers")
        .value
}

#[test]
fn surfaces_that_do_not_meet_themselves_have_no_pairs() {
    for pool in [
        shapes::cube(),
        shapes::tetrahedron(),
        shapes::torus(9, 7),
        shapes::moebius(12),
        shapes::icosphere(3),
        shapes::grid(12),
    ] {
        if let Ok(mesh) = Mesh::build(&pool) {
            assert_eq!(counts(&mesh), [0; 3]);
            assert_eq!(counts(&shapes::mesh(&shapes::fanned(&pool))), [0; 3]);
        }
    }
    assert_eq!(counts(&Mesh::default()), [0; 3]);
    let mut outer = shapes::cube();
    outer.map_positions(|p| p * 3.0).expect("finite");
    assert_eq!(check(&shapes::mesh(&shapes::both(&outer, &shapes::cube_at(DVec3::ONE)))), [0; 3], "nested");
}

#[test]
fn a_moebius_strip_cut_open_meets_itself_only_at_the_cut() {
    let strip = shapes::moebius(12);
    let mesh = cleaned(strip.positions().to_vec(), strip.polygons().iter().map(<[u32]>::to_vec).collect());
    assert_eq!(counts(&mesh), [0; 3]);
}

#[test]
fn crossing_cubes_cross() {
    // Each of the three faces at a corner crosses the two of the other's that are not parallel to it.
    assert_eq!(check(&cubes(DVec3::splat(0.5))), [6, 0, 0]);
    let both = shapes::both(&shapes::cube(), &shapes::cube_at(DVec3::splat(0.5)));
    assert_eq!(check(&shapes::mesh(&shapes::fanned(&both)))[1], 0);
}

#[test]
fn what_touches_at_a_vertex_or_along_an_edge_does_not_count() {
    assert_eq!(check(&shapes::mesh(&shapes::cubes_at_a_vertex())), [0; 3]);
    assert_eq!(check(&shapes::mesh(&shapes::cubes_at_an_edge())), [0; 3]);
    // Edges of half the length on edges; edges that cross in one point.
    let mut small = shapes::cube_at(DVec3::ZERO);
    small.map_positions(|p| p / 2.0 + dvec3(1., 1., 0.25)).expect("finite");
    assert_eq!(check(&shapes::mesh(&shapes::both(&shapes::cube(), &small))), [0; 3]);
    let mut tilted = shapes::tetrahedron();
    tilted
        .map_positions(|p| dvec3(1., 1., 0.25) + dvec3(p.x + p.y - p.z * 0.25, p.z - p.x, p.y))
        .expect("finite");
    check(&shapes::mesh(&shapes::both(&shapes::cube(), &tilted)));
}

#[test]
fn a_common_wall_overlaps_and_what_rests_on_a_face_touches() {
    // The wall; its four edges are edges of both.
    assert_eq!(check(&cubes(DVec3::X)), [0, 1, 0]);
    // Moved along the wall: two edges of each rest on the other's, and so do their other faces.
    let [cross, overlap, touch] = check(&cubes(dvec3(1., 0.5, 0.5)));
    assert_eq!((cross, overlap, touch), (0, 1, 4));
    let tip = shapes::both(&shapes::cube(), &{
        let mut tip = shapes::tetrahedron();
        tip.map_positions(|p| dvec3(0.5, 0.5, 1.) + dvec3(p.x - p.y, p.x + p.y - p.z, p.x + p.y + p.z))
            .expect("finite");
        tip
    });
    // Three faces meet in the tip.
    assert_eq!(check(&shapes::mesh(&tip)), [0, 0, 3]);
}

#[test]
fn a_folded_sheet_overlaps_and_an_opened_one_does_not() {
    let sheet = |fourth: DVec3| {
        let points = vec![DVec3::ZERO, DVec3::X * 2.0, DVec3::Y * 2.0, fourth];
        shapes::mesh(&shapes::pool(points, vec![vec![0, 1, 2], vec![1, 0, 3]]))
    };
    assert_eq!(check(&sheet(dvec3(0., -2., 0.))), [0; 3]);
    assert_eq!(check(&sheet(dvec3(0., 2., 1.))), [0; 3]);
    assert_eq!(check(&sheet(dvec3(0., 1., 0.))), [0, 1, 0]);
    assert_eq!(check(&sheet(dvec3(0., 2., 0.))), [0, 1, 0], "one on the other");
    assert_eq!(check(&sheet(dvec3(2., 2., 0.))), [0, 1, 0]);
}

#[test]
fn double_sided_sheets_overlap_where_they_are_two_surfaces() {
    let points = [DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y];
    let both: Vec<DVec3> = points.iter().chain(&points).copied().collect();
    let mesh = shapes::mesh(&shapes::pool(both, vec![vec![0, 1, 2, 3], vec![7, 6, 5, 4]]));
    assert_eq!(check(&mesh), [0, 1, 0]);
}

#[test]
fn a_polygons_cut_is_inside_and_its_parts_are_one_face() {
    // An edge rises from the middle of the square, where the cut is.
    let square = [DVec3::ZERO, DVec3::X * 2., dvec3(2., 2., 0.), DVec3::Y * 2.];
    let fin = [dvec3(1., 1., 0.), dvec3(1., 1., 1.), dvec3(3., 3., 1.)];
    let points: Vec<DVec3> = square.into_iter().chain(fin).collect();
    assert_eq!(
        check(&shapes::mesh(&shapes::pool(points.clone(), vec![vec![0, 1, 2, 3], vec![4, 5, 6]]))),
        [0, 0, 1]
    );
    // As triangles the same vertex is on their edge.
    let cut = shapes::pool(points, vec![vec![0, 1, 2], vec![0, 2, 3], vec![4, 5, 6]]);
    assert_eq!(check(&shapes::mesh(&cut)), [0; 3]);
    // A square folded over along its cut meets itself within one face.
    let bent =
        shapes::pool(vec![DVec3::ZERO, DVec3::X * 2., DVec3::Y, dvec3(0.5, 0.5, 0.)], vec![vec![0, 1, 3, 2]]);
    assert_eq!(check(&shapes::mesh(&bent)), [0; 3]);
}

#[test]
fn faces_without_area_have_edges_only() {
    // A cap between two triangles: a vertex in the middle of an edge.
    let points = vec![DVec3::ZERO, DVec3::X * 2., DVec3::X, dvec3(1., 1., 0.), dvec3(1., -1., 0.)];
    let mesh = shapes::mesh(&shapes::pool(
        points.clone(),
        vec![vec![0, 2, 3], vec![2, 1, 3], vec![0, 1, 2], vec![1, 0, 4]],
    ));
    assert_eq!(check(&mesh), [0; 3]);
    // One that pierces a triangle.
    let line = [dvec3(0.5, 0.25, -1.), dvec3(0.5, 0.25, 1.), dvec3(0.5, 0.25, 2.)];
    let points = vec![DVec3::ZERO, DVec3::X * 2., DVec3::Y * 2.].into_iter().chain(line).collect();
    assert_eq!(check(&shapes::mesh(&shapes::pool(points, vec![vec![0, 1, 2], vec![3, 4, 5]]))), [0, 0, 1]);
    // And one in its plane.
    let line = [dvec3(-1., 0.5, 0.), dvec3(3., 0.5, 0.), dvec3(5., 0.5, 0.)];
    let points = vec![DVec3::ZERO, DVec3::X * 2., DVec3::Y * 2.].into_iter().chain(line).collect();
    assert_eq!(check(&shapes::mesh(&shapes::pool(points, vec![vec![0, 1, 2], vec![3, 4, 5]]))), [0, 0, 1]);
}

#[test]
fn random_triangles_and_polygons_meet_as_rational_arithmetic_says() {
    let mut noise = Noise(31);
    let mut all = [0; 3];
    for round in 0..3000 {
        let size = 2 + noise.below(4) as i32;
        let flat = round % 5 == 0;
        let count = 5 + noise.below(8);
        let points = (0..count)
            .map(|_| {
                let mut at = || f64::from(noise.below(size as u32 + 1));
                let (x, y, z) = (at(), at(), at());
                dvec3(x, y, if flat { x + y } else { z })
            })
            .collect();
        let faces = (0..2 + noise.below(9))
            .map(|_| {
                let degree = if round % 2 == 0 { 3 } else { 3 + noise.below(3) };
                (0..degree).map(|_| noise.below(count)).collect()
            })
            .collect();
        let found = check(&cleaned(points, faces));
        all = [0, 1, 2].map(|i| all[i] + found[i]);
    }
    assert!(all.iter().all(|&n| n > 500), "{all:?}");
}

#[test]
fn any_two_triangles_of_a_small_grid_meet_as_rational_arithmetic_says() {
    let mut noise = Noise(32);
    for round in 0..20_000 {
        let size = [1, 2, 3, 6][round % 4];
        let points: Vec<DVec3> = (0..6)
            .map(|_| {
                let mut at = || f64::from(noise.below(size + 1));
                dvec3(at(), at(), if round % 7 == 0 { 0.0 } else { at() })
            })
            .collect();
        let mesh = shapes::mesh(&shapes::pool(points, vec![vec![0, 1, 2], vec![3, 4, 5]]));
        let found = ask(&mesh);
        assert_eq!(
            numbered(&mesh, &found),
            exact::self_intersections(&exact::triangles(&mesh)),
            "{:?}",
            mesh.to_indexed()
        );
    }
}

#[test]
fn hundreds_of_faces_meet_as_rational_arithmetic_says() {
    let mut noise = Noise(35);
    for degree in [3, 4] {
        let (mut points, mut faces) = (Vec::new(), Vec::new());
        for _ in 0..250 {
            let mut at = |n: u32| f64::from(noise.below(n));
            let corner = dvec3(at(16), at(16), at(16));
            let first = points.len() as u32;
            points.extend((0..degree).map(|_| corner + dvec3(at(6), at(6), at(6))));
            faces.push((first..first + degree).collect());
        }
        let [cross, overlap, touch] = check(&cleaned(points, faces));
        assert!(cross > 50 && overlap + touch > 10, "{cross} {overlap} {touch}");
    }
}

#[test]
fn real_parts_answer_and_their_pairs_lie_close_together() {
    // Goes on without the corpus.
    let Some(rows) = corpus::rows() else { return };
    let (mut asked, mut total) = (0, 0);
    for row in rows.iter().filter(|r| r.is_readable()) {
        let Ok(soup) = row.load() else { continue };
        let mesh = clean(&soup, CleanOptions::default()).expect("always answers").value;
        if mesh.face_count() > 20_000 {
            continue;
        }
        let options = SelfIntersectionOptions { max_listed: 200, ..Default::default() };
        let found = mesh.self_intersections(options).expect("nobody cancels");
        let bounds = |f| {
            let corners = mesh.face_vertices(f).map(|v| mesh.position(v));
            corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)))
        };
        for pair in &found.pairs {
            for f in pair.faces {
                let (low, high) = bounds(f);
                let slack = 1e-9 * (high.abs().max(low.abs()).max_element());
                let is_within = pair.place.cmpge(low - slack).all() && pair.place.cmple(high + slack).all();
                assert!(is_within, "{}: {pair:?}", row.path);
            }
        }
        asked += 1;
        total += found.count();
    }
    assert!(asked > 20 && total > 0, "{asked} {total}");
}

/// A solid, and the same moved by less than its size: not at whole numbers, so in general position.
fn twins(noise: &mut Noise, pool: &IndexedMesh) -> IndexedMesh {
    let by = dvec3(noise.unit(), noise.unit(), noise.unit()) * 0.5;
    let mut moved = pool.clone();
    moved.map_positions(|p| p + by).expect("finite");
    shapes::both(pool, &moved)
}

#[test]
fn size_and_place_change_nothing_and_threads_neither() {
    let mut noise = Noise(33);
    for pool in [shapes::icosphere(2), shapes::torus(9, 7), shapes::cube()] {
        let twins = twins(&mut noise, &pool);
        let found = ask(&shapes::mesh(&twins));
        assert!(found.crossings > 3);
        for scale in [1e-300, 1e-9, 3.0, 1e300] {
            let mut other = twins.clone();
            // A power of two: nothing is rounded.
            let scale = f64::from_bits(f64::to_bits(scale) >> 52 << 52);
            other.map_positions(|p| p * scale).expect("finite");
            let again = ask(&shapes::mesh(&other));
            assert_eq!((again.crossings, again.overlaps, again.touches), (found.crossings, 0, found.touches));
            let same = |(a, b): (&meshwright::FacePair, &meshwright::FacePair)| {
                a.faces == b.faces && a.contact == b.contact && a.place * scale == b.place
            };
            assert!(found.pairs.iter().zip(&again.pairs).all(same));
        }
    }
}

#[test]
fn listing_stops_where_it_is_told_and_counting_does_not() {
    // Sixty triangles through one another: all pairs.
    let spoke = |i: u32| {
        let (s, c) = (f64::from(i) * 0.05).sin_cos();
        [dvec3(s, c, -2.0), dvec3(-s, -c, -1.0), dvec3(0.01 * f64::from(i), 0.0, 9.0)]
    };
    let points = (0..60).flat_map(spoke).collect();
    let mesh =
        shapes::mesh(&shapes::pool(points, (0..60).map(|i| vec![3 * i, 3 * i + 1, 3 * i + 2]).collect()));
    let all = ask(&mesh);
    assert!(all.count() > 1000, "{}", all.count());
    for max_listed in [0, 1, 7, 500] {
        let some = mesh
            .index()
            .self_intersections(SelfIntersectionOptions { max_listed, ..Default::default() })
            .expect("nobody cancels");
        assert_eq!(some.pairs, all.pairs[..max_listed]);
        assert_eq!(some.count(), all.count());
    }
}

#[test]
fn the_hook_sees_progress_and_cancels() {
    let mesh = shapes::mesh(&shapes::icosphere(5));
    let mut seen: Vec<Progress> = Vec::new();
    let mut hook = |p: Progress| {
        seen.push(p);
        ControlFlow::Continue(())
    };
    let options = SelfIntersectionOptions { control: Control::new(&mut hook), ..Default::default() };
    assert_eq!(mesh.self_intersections(options).map(|f| f.count()), Ok(0));
    assert!(seen.len() > 1 && seen.windows(2).all(|w| w[0].fraction <= w[1].fraction), "{seen:?}");
    let mut stop = |p: Progress| {
        if p.fraction > 0.5 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let options = SelfIntersectionOptions { control: Control::new(&mut stop), ..Default::default() };
    assert_eq!(mesh.self_intersections(options), Err(meshwright::Cancelled));
}

#[cfg(feature = "rayon")]
#[test]
fn the_number_of_threads_changes_nothing() {
    let mut noise = Noise(34);
    let mesh = shapes::mesh(&twins(&mut noise, &shapes::icosphere(4)));
    let run = |threads| {
        let threads = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        threads.install(|| ask(&mesh))
    };
    assert_eq!(run(1), run(4));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn a_closed_surface_folded_over_a_small_grid_meets_itself_as_the_twin_says(
        points in prop::collection::vec((-2i8..3, -2i8..3, -2i8..3), 8),
        polygons: bool,
    ) {
        let at = |(x, y, z): (i8, i8, i8)| dvec3(x.into(), y.into(), z.into());
        let cube = if polygons { shapes::cube() } else { shapes::fanned(&shapes::cube()) };
        let pool = IndexedMesh::new(points.into_iter().map(at).collect(), cube.polygons().clone()).expect("a pool");
        check(&shapes::mesh(&pool));
    }
}
