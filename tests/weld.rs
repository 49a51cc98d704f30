//! Weld and unweld on the mesh.

mod corpus;
#[path = "tutorial/naive.rs"]
mod naive;
mod shapes;

use meshwright::cleanup::{CleanOptions, Weld, clean, index};
use meshwright::glam::{DVec3, dvec3};
use meshwright::{
    Control, Element, IndexedMesh, Kind, Mesh, Outcome, PolygonSoup, Polygons, Progress, Step, UnweldError,
    UnweldOptions, WeldError, WeldOptions,
};
use proptest::prelude::*;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

fn weld(mesh: &Mesh, tolerance: f64) -> Outcome<Mesh> {
    let outcome = mesh.weld(WeldOptions { tolerance, ..Default::default() }).expect("always answers");
    assert_eq!(outcome.value.validate(), Ok(()));
    outcome
}

fn unweld(mesh: &Mesh, degrees: f64) -> Outcome<Mesh> {
    let outcome = mesh.unweld(UnweldOptions { degrees, ..Default::default() }).expect("unwelded");
    assert_eq!(outcome.value.validate(), Ok(()));
    assert_eq!(outcome.maps.vertices.old_len(), mesh.vertex_count());
    assert_eq!(outcome.maps.vertices.new_len(), outcome.value.vertex_count());
    outcome
}

/// Every face of its own, as a mesh.
fn apart(pool: &IndexedMesh) -> Mesh {
    let soup = shapes::unwelded(pool);
    shapes::mesh(&IndexedMesh::try_from(soup).expect("a valid vertex pool"))
}

#[test]
fn the_soup_of_a_cube_becomes_the_cube() {
    let cube = shapes::fanned(&shapes::cube());
    let outcome = weld(&apart(&cube), 0.0);
    assert_eq!((outcome.value.vertex_count(), outcome.value.is_closed()), (8, true));
    assert_eq!(outcome.value.closed().expect("closed").volume(), 1.0);
    assert!(outcome.report.is_empty(), "an exact weld moves nothing");
    assert_eq!(outcome.report.steps.iter().find(|s| s.step == Step::Weld).map(|s| s.changed), Some(28));
}

#[test]
fn a_chain_of_near_points_is_not_pulled_together() {
    // Tips of fins along a line, three quarters of a tolerance apart: every second one is kept, where it is.
    let tips = (0..5).flat_map(|i| {
        let x = f64::from(i) * 0.75;
        [dvec3(x, 0.0, 0.0), dvec3(x, 10.0, 10.0 * x), dvec3(x, 10.0, 10.0 * x + 3.0)]
    });
    let points: Vec<DVec3> = tips.collect();
    let faces = (0..5).map(|i| vec![3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mesh = shapes::mesh(&shapes::pool(points.clone(), faces));
    let pool = index(&mesh.to_indexed().into(), Weld::Within(1.0)).expect("always answers");
    let kept: Vec<f64> = [0, 3, 6, 9, 12]
        .iter()
        .map(|&v| pool.value.positions()[pool.maps.vertices.new_of(v)[0] as usize].x)
        .collect();
    assert_eq!(kept, [0.0, 0.0, 1.5, 1.5, 3.0]);
    // On the mesh a merge at a single point would pinch, and is taken back.
    let outcome = weld(&mesh, 1.0);
    assert_eq!(outcome.value.vertex_count(), 15);
    assert_eq!(outcome.report.count(Kind::MergedVertex), 0);
}

#[test]
fn pairs_that_straddle_a_cell_of_any_grid_are_merged() {
    for i in 0..200 {
        let x = f64::from(i) * 0.005 - 0.5;
        let points = vec![
            dvec3(x, 0.0, 0.0),
            dvec3(x, 1.0, 0.0),
            dvec3(5.0, 0.0, 0.0),
            dvec3(x - 2e-3, 0.0, 0.0),
            dvec3(x - 2e-3, 1.0, 0.0),
            dvec3(-5.0, 0.0, 0.0),
        ];
        let mesh = shapes::mesh(&shapes::pool(points, vec![vec![0, 2, 1], vec![3, 4, 5]]));
        let outcome = weld(&mesh, 0.1);
        assert_eq!((outcome.value.vertex_count(), outcome.value.edge_count()), (4, 5), "{x}");
        assert_eq!(outcome.maps.vertices.new_of(3), outcome.maps.vertices.new_of(0));
        assert_eq!(outcome.report.count(Kind::MergedVertex), 2);
    }
}

#[test]
fn minus_zero_is_zero() {
    let points =
        vec![DVec3::ZERO, DVec3::X, DVec3::Y, dvec3(-0.0, 0.0, -0.0), DVec3::NEG_Y, dvec3(1.0, -0.0, 0.0)];
    let mesh = shapes::mesh(&shapes::pool(points, vec![vec![0, 1, 2], vec![3, 4, 5]]));
    assert_eq!(weld(&mesh, 0.0).value.vertex_count(), 4);
}

#[test]
fn a_merge_that_folds_a_face_drops_it_on_record() {
    let mut pool = shapes::icosphere(2);
    let mesh = shapes::mesh(&pool);
    let shortest = mesh.edges().next().expect("there");
    let h = mesh.edge_halfedge(shortest);
    let (a, b) = (mesh.position(mesh.origin(h)), mesh.position(mesh.target(h)));
    pool.map_positions(|p| if p == b { a + (b - a) * 1e-3 } else { p }).expect("finite");
    let outcome = weld(&shapes::mesh(&pool), 1e-2);
    assert_eq!(outcome.report.count(Kind::DegenerateFace), 2);
    assert_eq!(outcome.report.count(Kind::MergedVertex), 1);
    assert!(outcome.value.is_closed());
    assert_eq!(outcome.value.face_count(), pool.face_count() - 2);
    let gone = (0..pool.face_count()).filter(|&f| outcome.maps.faces.new_of(f).is_empty());
    assert_eq!(gone.count(), 2);
}

#[test]
fn a_tolerance_that_makes_no_sense_is_refused() {
    let mesh = shapes::mesh(&shapes::cube());
    for tolerance in [-1.0, f64::NAN, f64::INFINITY] {
        let refused = mesh.weld(WeldOptions { tolerance, ..Default::default() });
        assert!(matches!(refused, Err(WeldError::BadTolerance(_))));
    }
}

#[test]
fn weld_and_unweld_can_be_cancelled() {
    let mesh = shapes::mesh(&shapes::cube());
    for stop in 0..3 {
        let mut count = 0;
        let mut hook = |_: Progress| {
            count += 1;
            if count > stop { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let options = WeldOptions { tolerance: 0.1, control: Control::new(&mut hook) };
        assert!(matches!(mesh.weld(options), Err(WeldError::Cancelled(_))), "{stop}");
        count = 0;
        let mut hook = |_: Progress| {
            count += 1;
            if count > stop { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let options = UnweldOptions { degrees: 30.0, control: Control::new(&mut hook) };
        assert!(matches!(mesh.unweld(options), Err(UnweldError::Cancelled(_))), "{stop}");
    }
}

#[test]
fn unwelding_a_cube_gives_six_squares_and_welding_gives_it_back() {
    let cube = shapes::cube();
    let parted = unweld(&shapes::mesh(&cube), 30.0);
    assert_eq!(parted.value.components().len(), 6);
    assert_eq!(parted.value.vertex_count(), 24);
    assert_eq!(parted.report.count(Kind::SharpEdge), 12);
    assert_eq!(parted.report.steps[0].changed, 16);
    assert_eq!(parted.maps.vertices.new_of(0).len(), 3);
    assert!(parted.maps.faces.is_identity());
    assert_eq!(weld(&parted.value, 0.0).value.to_indexed(), cube);
}

#[test]
fn an_angle_that_is_not_exceeded_parts_nothing() {
    let cube = shapes::mesh(&shapes::fanned(&shapes::cube()));
    assert_eq!(cube.sharp_edges(90.0).expect("an angle"), []);
    assert_eq!(cube.sharp_edges(89.9).expect("an angle").len(), 12, "diagonals are flat");
    let same = unweld(&cube, 90.0);
    assert_eq!(same.value.to_indexed(), cube.to_indexed());
    assert!(same.report.is_empty() && same.maps.vertices.is_identity());
    for degrees in [-1.0, 180.1, f64::NAN] {
        let refused = cube.unweld(UnweldOptions { degrees, ..Default::default() });
        assert!(matches!(refused, Err(UnweldError::BadAngle(_))));
        assert!(cube.sharp_edges(degrees).is_err());
    }
}

#[test]
fn a_lone_sharp_edge_within_a_surface_stays_and_one_that_reaches_the_boundary_opens() {
    // A square of four by four, folded up along part of its middle line.
    let fold = |reaches: bool| {
        let mut pool = shapes::grid(4);
        pool.map_positions(|p| {
            let on_line = p.x == 2.0 && (p.y == 2.0 || reaches && p.y < 2.0 || p.y == 1.0);
            dvec3(p.x, p.y, if on_line { 2.0 } else { 0.0 })
        })
        .expect("finite");
        shapes::mesh(&pool)
    };
    for reaches in [false, true] {
        let mesh = fold(reaches);
        let parted = unweld(&mesh, 100.0);
        assert_eq!(parted.report.is_empty(), !reaches || mesh.sharp_edges(100.0).expect("angle").is_empty());
        assert_eq!(weld(&parted.value, 0.0).value.to_indexed(), mesh.to_indexed());
    }
}

#[test]
fn faces_without_area_have_no_sharp_edges() {
    let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X * 2.0];
    let mesh = shapes::mesh(&shapes::pool(points, vec![vec![0, 1, 2], vec![1, 0, 3]]));
    assert_eq!(mesh.sharp_edges(0.0).expect("an angle"), []);
}

#[test]
fn carried_normals_are_copied_to_what_is_split_off() {
    let mut mesh = shapes::mesh(&shapes::cube());
    mesh.compute_normals(Default::default());
    let parted = unweld(&mesh, 30.0);
    let (old, new) = (mesh.to_indexed(), parted.value.to_indexed());
    let (old, new) = (old.normals().expect("carried"), new.normals().expect("carried"));
    for (v, n) in new.iter().enumerate() {
        assert_eq!(*n, old[parted.maps.vertices.old_of(v)[0] as usize]);
    }
}

#[test]
fn unwelding_corpus_meshes_and_welding_them_gives_them_back() {
    let Some(rows) = corpus::rows() else { return };
    let mut compared = 0;
    for row in rows.iter().filter(|r| r.is_readable()) {
        let Ok(soup) = row.load() else { continue };
        let mesh = meshwright::cleanup::clean(&soup, Default::default()).expect("always answers").value;
        if mesh.vertex_count() == 0 {
            continue;
        }
        let parted = unweld(&mesh, 20.0);
        assert_eq!(parted.value.face_count(), mesh.face_count(), "{}", row.path);
        for record in &parted.report.records {
            assert!(matches!(record.element, Element::Edge(_)) && record.kind == Kind::SharpEdge);
        }
        // Where vertices lay at one place before, or the weld is free to pair otherwise, there is no way back.
        let exact = index(&mesh.to_indexed().into(), Weld::Exact).expect("always answers");
        if exact.value.vertex_count() == mesh.vertex_count() {
            let back = weld(&parted.value, 0.0).value;
            assert_eq!(back.to_indexed(), mesh.to_indexed(), "{}", row.path);
            compared += 1;
        }
    }
    assert!(compared > 100, "only {compared} were compared");
}

/// What is on record is in the mesh's numbers, and each vertex of the result within reach of those it comes from.
fn assert_maps_and_records(mesh: &Mesh, outcome: &Outcome<Mesh>) {
    assert_eq!(outcome.maps.vertices.old_len(), mesh.vertex_count());
    assert_eq!(outcome.maps.vertices.new_len(), outcome.value.vertex_count());
    assert_eq!(outcome.maps.faces.old_len(), mesh.face_count());
    assert_eq!(outcome.maps.faces.new_len(), outcome.value.face_count());
    let (vertices, faces) = (mesh.vertex_count() as u32, mesh.face_count() as u32);
    for record in &outcome.report.records {
        let is_there = match record.element {
            Element::Vertex(v) => v < vertices,
            Element::Edge(ends) => ends.iter().all(|&v| v < vertices),
            Element::Face(f) | Element::Corner([f, _]) => f < faces,
            Element::Faces(pair) => pair.iter().all(|&f| f < faces),
            Element::VertexOnEdge(all) => all.iter().all(|&v| v < vertices),
        };
        assert!(is_there, "{record:?}");
    }
}

#[test]
fn models_whose_merges_are_taken_back_are_welded_once() {
    let Some(rows) = corpus::rows() else { return };
    let names = [
        "manifold__openscad-nonmanifold-crash.obj",
        "bullet__lego.obj",
        "trimesh__box.STL",
        "sofa__teeth.obj",
    ];
    let mut welded = 0;
    for row in rows.iter().filter(|row| names.iter().any(|name| row.path.ends_with(name))) {
        let soup = row.load().expect("read");
        let mesh = clean(&soup, CleanOptions::default()).expect("always answers").value;
        let size = mesh.bounds().map(|b| b.min.distance(b.max)).expect("vertices");
        for share in [0.0, 1e-4, 1e-3, 1e-2, 0.05] {
            let once = weld(&mesh, share * size);
            assert_maps_and_records(&mesh, &once);
            let twice = weld(&once.value, share * size);
            assert!(twice.value.to_indexed() == once.value.to_indexed(), "{} {share}", row.path);
            welded += usize::from(once.value.vertex_count() < mesh.vertex_count());
        }
    }
    assert!(welded > 8, "only {welded} were welded");
}

/// Every readable file of up to 30,000 faces, at tolerances from none to a thousandth of its diagonal.
#[test]
fn a_second_weld_of_any_corpus_file_changes_nothing() {
    let Some(rows) = corpus::rows() else { return };
    let small = |r: &corpus::Row| r.is_readable() && r.number("faces").is_some_and(|n| n <= 30_000.0);
    let rows: Vec<corpus::Row> = rows.into_iter().filter(small).collect();
    let (next, welded) = (AtomicUsize::new(0), AtomicUsize::new(0));
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some(row) = rows.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let Ok(soup) = row.load() else { continue };
                    let mesh = clean(&soup, CleanOptions::default()).expect("always answers").value;
                    let Some(bounds) = mesh.bounds() else { continue };
                    for share in [0.0, 1e-9, 1e-6, 1e-3] {
                        let tolerance = share * bounds.min.distance(bounds.max);
                        let once = weld(&mesh, tolerance);
                        let twice = weld(&once.value, tolerance);
                        let is_same = twice.value.to_indexed() == once.value.to_indexed();
                        assert!(is_same, "{}, {share}: {:?}", row.path, twice.report.counts());
                        assert!(
                            twice.report.is_empty() && twice.maps.vertices.is_identity(),
                            "{}, {share}",
                            row.path
                        );
                        assert!(twice.maps.faces.is_identity(), "{}, {share}", row.path);
                        let is_less = once.value.vertex_count() < mesh.vertex_count();
                        welded.fetch_add(usize::from(is_less), Ordering::Relaxed);
                    }
                }
            });
        }
    });
    assert!(welded.into_inner() > 60, "more files have something to weld");
}

fn jittered(seed: u64, size: f64) -> IndexedMesh {
    let mut noise = shapes::Noise(seed);
    let soup = shapes::unwelded(&shapes::grid(3));
    let mut pool = IndexedMesh::try_from(soup).expect("a valid vertex pool");
    pool.map_positions(|p| p + dvec3(noise.unit(), noise.unit(), noise.unit()) * size).expect("finite");
    pool
}

proptest! {
    #[test]
    fn welding_a_mesh_follows_the_tutorials_loop(seed in any::<u64>(), size in 0.0f64..0.3, t in prop_oneof![Just(0.0), 1e-3f64..0.6]) {
        let pool = jittered(seed, size);
        let outcome = weld(&shapes::mesh(&pool), t);
        let expected = naive::weld(pool.positions(), t);
        // What splitting takes back keeps its own place.
        let split = outcome.report.steps.iter().any(|s| s.step == Step::SplitVertices && s.changed > 0)
            || outcome.value.vertex_count() == pool.vertex_count();
        for (v, &kept) in expected.iter().enumerate() {
            for &new in outcome.maps.vertices.new_of(v) {
                let at = outcome.value.position(outcome.value.vertices().nth(new as usize).expect("there"));
                prop_assert!(split || at == pool.positions()[kept], "vertex {}", v);
            }
        }
        let direct = index(&PolygonSoup::from(pool.clone()), Weld::Within(t)).expect("always answers");
        for (v, &kept) in expected.iter().enumerate() {
            let at = |v: usize| direct.value.positions()[direct.maps.vertices.new_of(v)[0] as usize];
            prop_assert_eq!(at(v), pool.positions()[kept]);
        }
    }

    #[test]
    fn welding_twice_is_welding_once(seed in any::<u64>(), size in 0.0f64..0.3, t in prop_oneof![Just(0.0), 1e-3f64..0.6]) {
        let once = weld(&shapes::mesh(&jittered(seed, size)), t).value;
        let twice = weld(&once, t);
        prop_assert_eq!(twice.value.to_indexed(), once.to_indexed());
        prop_assert!(twice.report.is_empty(), "{:?}", twice.report);
    }

    #[test]
    fn welding_what_crosses_and_touches_twice_is_welding_it_once(
        seed in any::<u64>(), n in 4u32..24, faces in 3..40, t in prop_oneof![Just(0.0), 1e-3f64..0.9],
    ) {
        let mut noise = shapes::Noise(seed);
        let mut polygons = Polygons::default();
        for _ in 0..faces {
            polygons.push((0..3 + noise.below(3)).map(|_| noise.below(n)).collect::<Vec<_>>());
        }
        let points = (0..n).map(|_| dvec3(noise.unit(), noise.unit(), noise.unit())).collect();
        let options = CleanOptions { weld: Weld::None, ..Default::default() };
        let mesh = clean(&PolygonSoup::new(points, polygons), options).expect("always answers").value;
        let once = weld(&mesh, t);
        assert_maps_and_records(&mesh, &once);
        let twice = weld(&once.value, t);
        prop_assert_eq!(twice.value.to_indexed(), once.value.to_indexed());
        prop_assert!(twice.report.is_empty() && twice.maps.vertices.is_identity(), "{:?}", twice.report);
    }

    #[test]
    fn unweld_opens_exactly_what_it_records(degrees in 0.0f64..180.0, seed in any::<u64>()) {
        let mut noise = shapes::Noise(seed);
        let mut pool = shapes::torus(6, 5);
        pool.map_positions(|p| p + dvec3(noise.unit(), noise.unit(), noise.unit()) * 0.7).expect("finite");
        let mesh = shapes::mesh(&pool);
        let parted = unweld(&mesh, degrees);
        let opened = parted.value.boundary_halfedges().count();
        prop_assert_eq!(opened, 2 * parted.report.count(Kind::SharpEdge));
        prop_assert!(parted.report.records.len() <= mesh.sharp_edges(degrees).expect("an angle").len());
        prop_assert_eq!(weld(&parted.value, 0.0).value.to_indexed(), mesh.to_indexed());
    }
}
