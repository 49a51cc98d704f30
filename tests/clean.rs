//! Clean-up on named faults: what comes out, and what the account says.

#[path = "drive/clean.rs"]
mod drive;
mod shapes;

use meshwright::cleanup::{CleanError, CleanOptions, Weld, clean, index, inspect};
use meshwright::glam::{DVec3, dvec3};
use meshwright::{Attribute, Cancelled, Control, Element, Kind, Mesh, Outcome, PolygonSoup, Polygons, Step};
use shapes::{both, cube, cube_at, soup, unwelded};
use std::ops::ControlFlow;

fn cleaned(soup: &PolygonSoup) -> Outcome<Mesh> {
    with(soup, Weld::Exact)
}

fn with(soup: &PolygonSoup, weld: Weld) -> Outcome<Mesh> {
    let outcome = clean(soup, CleanOptions { weld, ..Default::default() }).expect("a soup is never refused");
    assert_eq!(outcome.value.violations(), []);
    outcome
}

fn volume(mesh: &Mesh) -> f64 {
    mesh.closed().expect("closed").volume()
}

/// Vertices at one place are one vertex in the soup too.
fn welded(soup: &PolygonSoup) -> PolygonSoup {
    index(soup, Weld::Exact).expect("always answers").value.into()
}

#[test]
fn a_soup_without_defects_comes_out_as_it_is_with_an_empty_record() {
    for pool in [cube(), shapes::torus(9, 5), shapes::grid(5), both(&cube(), &cube_at(DVec3::splat(2.0)))] {
        let outcome = cleaned(&soup(&pool));
        assert_eq!(outcome.value.to_indexed(), pool);
        assert!(
            outcome.report.is_empty()
                && outcome.maps.vertices.is_identity()
                && outcome.maps.faces.is_identity()
        );
    }
}

#[test]
fn an_unwelded_soup_is_welded_without_a_record() {
    let outcome = cleaned(&unwelded(&shapes::icosphere(3)));
    assert!(outcome.report.is_empty());
    let weld = outcome.report.steps.iter().find(|s| s.step == Step::Weld).expect("a step");
    assert_eq!((weld.changed, weld.tolerance), (3840 - 642, Some(0.0)));
    assert!(outcome.value.is_closed());
    assert_eq!(outcome.maps.vertices.old_of(0).len(), 5, "the first vertex of an icosphere has five faces");
}

#[test]
fn cubes_that_touch_at_an_edge_or_a_vertex_become_two_closed_cubes() {
    for pair in [shapes::cubes_at_an_edge(), shapes::cubes_at_a_vertex()] {
        for pool in [pair.clone(), shapes::fanned(&pair)] {
            for soup in [soup(&pool), unwelded(&pool), welded(&soup(&pool))] {
                let outcome = cleaned(&soup);
                assert_eq!(volume(&outcome.value), 2.0);
                assert_eq!(outcome.value.components().len(), 2);
                assert_eq!(outcome.value.vertex_count(), 16);
                assert_eq!(outcome.value.face_count(), pool.face_count());
            }
        }
    }
}

#[test]
fn a_weld_that_a_split_takes_back_leaves_no_record() {
    // In the soup, the cubes have vertices of their own; welding joins them and splitting parts them again.
    let outcome = cleaned(&soup(&shapes::cubes_at_an_edge()));
    assert_eq!(outcome.report.records, []);
    assert_eq!(outcome.value.to_indexed(), shapes::cubes_at_an_edge());
    // Where they share vertices in the soup itself, parting them is a change.
    let outcome = cleaned(&welded(&soup(&shapes::cubes_at_an_edge())));
    assert_eq!(outcome.report.count(Kind::NonManifoldEdge), 1);
    assert_eq!(outcome.report.count(Kind::PinchedVertex), 2);
    let record = outcome.report.records[0];
    assert_eq!((record.kind, record.place), (Kind::NonManifoldEdge, Some(dvec3(1., 1., 0.5))));
    for v in [3, 7] {
        assert_eq!(outcome.maps.vertices.new_of(v).len(), 2);
    }
}

/// A block of unit cubes at the given places, as one welded surface: faces between two cubes left out.
fn blocks(places: &[[i32; 3]]) -> PolygonSoup {
    let at = |p: [i32; 3]| dvec3(f64::from(p[0]), f64::from(p[1]), f64::from(p[2]));
    let mut soup = PolygonSoup::default();
    for &place in places {
        let own = cube_at(at(place));
        for face in own.polygons().iter() {
            let points: Vec<DVec3> = face.iter().map(|&v| own.positions()[v as usize]).collect();
            let middle = points.iter().sum::<DVec3>() / 4.0;
            let inside = |p: &[i32; 3]| *p != place && (at(*p) + 0.5).distance(middle) < 0.6;
            if !places.iter().any(inside) {
                let first = soup.positions.len() as u32;
                soup.polygons.push(first..first + 4);
                soup.positions.extend(points);
            }
        }
    }
    welded(&soup)
}

#[test]
fn a_solid_that_touches_itself_along_an_edge_stays_closed_and_keeps_its_volume() {
    // Five cubes in a ring whose ends touch along an edge: one patch with four faces there.
    let ring = blocks(&[[0, 0, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [1, 1, 0]]);
    let topology_edges = inspect(&ring, Weld::None).expect("always answers");
    assert_eq!((topology_edges.nonmanifold_edges, topology_edges.components), (1, 1));
    for flip in [false, true] {
        let mut soup = ring.clone();
        if flip {
            (0..soup.polygons.len()).for_each(|f| soup.polygons.reverse(f));
        }
        let outcome = cleaned(&soup);
        assert_eq!(volume(&outcome.value), if flip { -5.0 } else { 5.0 });
        assert_eq!(outcome.report.count(Kind::FlippedFace), 0);
        // The material comes apart at the edge: each of its vertices becomes two, but for those that stay joined.
        let after = inspect(&outcome.value.to_indexed().into(), Weld::None).expect("always answers");
        assert!(after.closed && after.manifold && after.oriented && after.components == 1);
    }
}

#[test]
fn checkerboard_cubes_come_apart_into_closed_cubes() {
    let mut places = Vec::new();
    for i in 0..27i32 {
        let p = [i % 3, i / 3 % 3, i / 9];
        if p.iter().sum::<i32>() % 2 == 0 {
            places.push(p);
        }
    }
    let outcome = cleaned(&blocks(&places));
    assert_eq!(outcome.value.components().len(), 14);
    assert_eq!(volume(&outcome.value), 14.0);
    assert_eq!(outcome.report.count(Kind::FlippedFace), 0);
}

#[test]
fn two_boxes_that_share_a_wall_stay_closed_around_it() {
    let mut faces: Vec<Vec<u32>> = Vec::new();
    let pair = soup(&both(&cube(), &cube_at(DVec3::X)));
    let pair = welded(&pair);
    for face in pair.polygons.iter() {
        let sorted = |f: &[u32]| {
            let mut f = f.to_vec();
            f.sort_unstable();
            f
        };
        if !faces.iter().any(|f| sorted(f) == sorted(face)) {
            faces.push(face.to_vec());
        }
    }
    assert_eq!(faces.len(), 11, "one wall for both");
    let outcome = cleaned(&PolygonSoup::new(pair.positions, faces.into()));
    // The outer hull is the flattest way round; the wall stays as a sheet of its own.
    let parts = outcome.value.components();
    assert_eq!(parts.iter().map(Vec::len).collect::<Vec<_>>(), [10, 1]);
    assert_eq!(outcome.report.count(Kind::NonManifoldEdge), 4);
    assert_eq!(outcome.value.boundary_loops().len(), 1);
}

#[test]
fn sheets_that_cross_go_straight_on() {
    // Four half-planes on one edge, like the pages of an open book.
    let mut points = vec![DVec3::ZERO, DVec3::Z];
    points.extend([DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y]);
    for order in [[2, 3, 4, 5], [5, 2, 4, 3], [3, 4, 2, 5]] {
        let faces: Polygons = order.iter().map(|&v| [0u32, 1, v]).collect();
        let outcome = cleaned(&PolygonSoup::new(points.clone(), faces));
        let mesh = &outcome.value;
        assert_eq!(mesh.components().len(), 2);
        for part in mesh.components() {
            let sum: DVec3 = part.iter().flat_map(|&f| mesh.face_vertices(f)).map(|v| mesh.position(v)).sum();
            assert_eq!((sum.x, sum.y), (0.0, 0.0), "opposite pages belong together");
        }
    }
}

#[test]
fn a_fin_on_a_sheet_is_left_with_its_boundary() {
    let outcome = cleaned(&soup(&shapes::fins()));
    assert_eq!(outcome.report.count(Kind::NonManifoldEdge), 1);
    assert_eq!(outcome.value.face_count(), 3);
    // The half-planes toward Y and -Y lie flat; the one toward Z stays alone.
    assert_eq!(outcome.value.components().iter().map(Vec::len).collect::<Vec<_>>(), [2, 1]);
}

#[test]
fn duplicates_in_either_direction_are_dropped_and_named() {
    let mut twice = soup(&cube());
    twice.polygons.push([2, 3, 1, 0]);
    twice.polygons.push([4, 6, 7, 5]);
    let outcome = cleaned(&twice);
    assert_eq!(outcome.value.to_indexed(), cube());
    let elements: Vec<Element> = outcome.report.records.iter().map(|r| r.element).collect();
    assert_eq!(elements, [Element::Face(6), Element::Face(7)]);
    assert!(outcome.maps.faces.new_of(6).is_empty());
}

#[test]
fn one_side_of_a_double_sided_sheet_stays() {
    let sheet =
        PolygonSoup::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![vec![0, 1, 2], vec![0, 2, 1]].into());
    let outcome = cleaned(&sheet);
    assert_eq!(outcome.value.face_count(), 1);
    assert_eq!(outcome.report.count(Kind::DuplicateFace), 1);
}

#[test]
fn mixed_winding_is_unified_and_every_flip_recorded() {
    let sphere = shapes::icosphere(3);
    let mixed = shapes::some_reversed(&sphere, 5, 3);
    let reversed = (0..sphere.face_count()).filter(|&f| sphere.polygons()[f] != mixed.polygons()[f]).count();
    let outcome = cleaned(&soup(&mixed));
    assert_eq!(outcome.value.to_indexed(), sphere);
    assert_eq!(outcome.report.count(Kind::FlippedFace), reversed);
    assert_eq!(outcome.report.records.len(), reversed);
}

#[test]
fn a_moebius_strip_is_cut_once_and_keeps_its_faces() {
    let outcome = cleaned(&soup(&shapes::moebius(12)));
    assert_eq!(outcome.report.count(Kind::FlippedFace), 0, "wound alike but at one edge, which is cut");
    assert_eq!(outcome.report.count(Kind::CutEdge), 1);
    assert_eq!(outcome.value.face_count(), 12);
    assert_eq!(outcome.value.boundary_loops().len(), 1);
    assert_eq!(outcome.value.components().len(), 1);
}

#[test]
fn invalid_elements_are_dropped_and_named() {
    let mut soup = soup(&cube());
    soup.positions.push(dvec3(0., f64::NAN, 0.));
    soup.positions.push(DVec3::splat(7.0));
    soup.polygons = [vec![0, 8, 1], vec![0, 1, 99], vec![1, 2], vec![], vec![0, 1, 0]]
        .into_iter()
        .chain(soup.polygons.iter().map(<[u32]>::to_vec))
        .collect();
    let outcome = cleaned(&soup);
    let kinds: Vec<(Kind, Element)> = outcome.report.records.iter().map(|r| (r.kind, r.element)).collect();
    assert_eq!(
        kinds,
        [
            (Kind::NonFiniteVertex, Element::Vertex(8)),
            (Kind::NonFiniteFace, Element::Face(0)),
            (Kind::OutOfRangeFace, Element::Face(1)),
            (Kind::ShortFace, Element::Face(2)),
            (Kind::ShortFace, Element::Face(3)),
            (Kind::DegenerateFace, Element::Face(4)),
        ]
    );
    assert_eq!(outcome.value.vertex_count(), 9, "the isolated vertex stays");
    assert_eq!(outcome.maps.vertices.new_of(9), [8]);
    assert_eq!(outcome.maps.faces.new_of(5), [0]);
}

#[test]
fn a_tolerance_welds_what_is_near_and_records_what_moved() {
    let mut jittered = unwelded(&cube());
    let mut noise = shapes::Noise(8);
    for p in &mut jittered.positions {
        *p += dvec3(noise.unit(), noise.unit(), noise.unit()) * 1e-4;
    }
    assert!(!cleaned(&jittered).value.is_closed());
    let outcome = with(&jittered, Weld::Within(1e-3));
    assert!(outcome.value.is_closed());
    assert_eq!(outcome.value.vertex_count(), 8);
    assert_eq!(outcome.report.count(Kind::MergedVertex), 16);
    for v in outcome.value.to_indexed().positions() {
        assert!(jittered.positions.contains(v), "kept vertices do not move");
    }
}

#[test]
fn an_automatic_tolerance_bridges_the_noise_of_single_precision() {
    let mut far = unwelded(&shapes::icosphere(2));
    let mut noise = shapes::Noise(3);
    for p in &mut far.positions {
        // As a program leaves them that computes in f32 at a distance: off by a unit in the last place.
        *p = (*p + 100.0).as_vec3().as_dvec3();
        p.x += f64::from(noise.below(3)) * 7.6e-6;
    }
    assert!(!cleaned(&far).value.is_closed());
    let outcome = with(&far, Weld::Auto);
    assert!(outcome.value.is_closed());
    let weld = outcome.report.steps.iter().find(|s| s.step == Step::Weld).expect("a step");
    assert!(weld.tolerance.is_some_and(|t| t > 1e-5 && t < 1e-4));
}

#[test]
fn a_senseless_tolerance_is_refused() {
    for t in [-1.0, f64::NAN, f64::INFINITY] {
        let refused = clean(&soup(&cube()), CleanOptions { weld: Weld::Within(t), ..Default::default() });
        assert!(matches!(refused, Err(CleanError::BadTolerance(_))));
        assert!(matches!(inspect(&soup(&cube()), Weld::Within(t)), Err(CleanError::BadTolerance(_))));
    }
}

#[test]
fn edges_that_would_double_each_other_are_parted_in_the_middle() {
    // Four faces on an edge whose two pairs stay connected around both ends: splitting cannot part them.
    let mut noise = shapes::Noise(0);
    let mut met = 0;
    for _ in 0..4000 {
        let points = (0..7).map(|_| dvec3(noise.unit(), noise.unit(), noise.unit())).collect();
        let faces: Polygons = (0..12).map(|_| [(); 3].map(|()| noise.below(7))).collect();
        let outcome = cleaned(&PolygonSoup::new(points, faces));
        met += outcome.report.count(Kind::ParallelEdge);
        for record in outcome.report.records.iter().filter(|r| r.kind == Kind::ParallelEdge) {
            let middle = record.place.expect("finite");
            let pool = outcome.value.to_indexed();
            let v = pool.positions().iter().position(|p| *p == middle).expect("a vertex in the middle");
            assert!(outcome.maps.vertices.old_of(v).is_empty(), "it comes from nothing");
        }
    }
    assert!(met > 2, "only {met} came up");
}

#[test]
fn cleaning_stops_when_told_to() {
    let soup = unwelded(&shapes::cubes_at_an_edge());
    let mut stages = Vec::new();
    let mut hook = |p: meshwright::Progress| {
        stages.push((p.stage, p.fraction));
        ControlFlow::Continue(())
    };
    clean(&soup, CleanOptions { control: Control::new(&mut hook), ..Default::default() })
        .expect("not cancelled");
    assert!(stages.len() >= 5 && stages.is_sorted_by(|a, b| a.1 <= b.1), "{stages:?}");
    for stop in 0..stages.len() {
        let mut seen = 0;
        let mut hook = |_| {
            seen += 1;
            if seen > stop { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let result = clean(&soup, CleanOptions { control: Control::new(&mut hook), ..Default::default() });
        assert_eq!(result.expect_err("cancelled"), CleanError::Cancelled(Cancelled));
    }
}

#[test]
fn given_normals_are_carried() {
    let mut soup = soup(&cube());
    soup.vertex_normals = soup.positions.iter().map(|p| *p - 0.5).collect();
    let outcome = cleaned(&soup);
    let v = outcome.value.vertices().nth(7).expect("eight vertices");
    assert_eq!(outcome.value.normal(v), Some(DVec3::splat(0.5)));
    // Split vertices take theirs along.
    let mut pair = welded(&shapes::soup(&shapes::cubes_at_a_vertex()));
    pair.vertex_normals = vec![DVec3::Z; pair.positions.len()];
    let outcome = cleaned(&pair);
    assert!(outcome.value.vertices().all(|v| outcome.value.normal(v) == Some(DVec3::Z)));
}

#[test]
fn normals_that_differ_where_vertices_merge_are_carried_by_the_corners() {
    let mut soup = unwelded(&cube());
    soup.vertex_normals = (0..24).map(|i| if i < 12 { DVec3::Z } else { DVec3::X }).collect();
    soup.vertex_colors = vec![[1.0; 4]; 24];
    let outcome = cleaned(&soup);
    assert!(outcome.report.not_carried.is_empty() && outcome.report.lost_values.is_empty());
    assert_eq!(outcome.value.carried_attributes(), [Attribute::VertexColors, Attribute::CornerNormals]);
}

#[test]
fn maps_compose_with_those_of_a_second_pass() {
    let first = cleaned(&welded(&soup(&shapes::cubes_at_an_edge())));
    let second = with(&first.value.to_indexed().into(), Weld::None);
    let through = first.maps.then(&second.maps).expect("they meet");
    assert_eq!(through, first.maps);
    assert_eq!(through.inverse().vertices.new_of(0), through.vertices.old_of(0));
}

#[test]
fn inspect_tells_the_state_and_changes_nothing() {
    let facts = inspect(&soup(&both(&cube(), &shapes::torus(6, 4))), Weld::Exact).expect("always answers");
    assert_eq!(
        (facts.components, facts.closed, facts.manifold, facts.oriented, facts.genus),
        (2, true, true, true, None)
    );
    assert_eq!(facts.face_degrees, [(4, 30)].into());
    let facts = inspect(&PolygonSoup::default(), Weld::Exact).expect("always answers");
    assert!(!facts.closed && facts.volume.is_none() && facts.bbox.is_none());
    let facts = inspect(&unwelded(&cube()), Weld::None).expect("always answers");
    assert_eq!((facts.components, facts.boundary_edges, facts.boundary_loops), (6, 24, 6));
}

#[test]
fn the_fuzz_corpus_passes() {
    let root = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/fuzz/corpus/clean"));
    let mut count = 0;
    for entry in std::fs::read_dir(root).expect("a corpus") {
        drive::drive(&std::fs::read(entry.expect("an entry").path()).expect("a file"));
        count += 1;
    }
    assert!(count > 1);
}

#[test]
fn one_face_that_becomes_thousands_takes_no_quadratic_time_and_is_recorded_once_a_step() {
    // A long walk over a hundred vertices; the place of each record once cost the whole walk.
    let mut noise = shapes::Noise(6);
    let points = (0..100).map(|_| dvec3(noise.unit(), noise.unit(), 0.0)).collect();
    let walk: Vec<u32> = (0..300_000).map(|_| noise.below(100)).collect();
    let outcome = cleaned(&PolygonSoup::new(points, vec![walk].into()));
    assert!(outcome.value.face_count() > 1000);
    for kind in [Kind::PinchedFace, Kind::DuplicateFace, Kind::FlippedFace] {
        assert_eq!(outcome.report.count(kind), 1, "{kind}");
    }
}

#[test]
fn many_faces_on_one_edge_take_no_quadratic_time() {
    let n = 60_000u32;
    let mut points = vec![DVec3::ZERO, DVec3::Z];
    points.extend((0..n).map(|i| {
        let (s, c) = f64::from(i * 7919 % n).sin_cos();
        dvec3(c, s, 0.5)
    }));
    let faces: Polygons = (0..n).map(|i| [0, 1, i + 2]).collect();
    let outcome = cleaned(&PolygonSoup::new(points, faces));
    assert_eq!(outcome.value.face_count(), n as usize);
}
