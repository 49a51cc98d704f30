//! The profile `solid` on named shapes, and its steps one by one.

mod shapes;

use meshwright::cleanup::{
    Account, CleanError, CleanOptions, Profile, Weld, clean, clean_indexed, drop_debris, drop_fins,
    drop_isolated, fill_holes, resolve_slivers, turn_outward,
};
use meshwright::glam::{DVec3, dvec3};
use meshwright::{
    Attribute, Control, Element, FillHolesOptions, Group, IndexedMesh, Kind, Mesh, Outcome, PolygonSoup,
    Polygons, Progress, SliverOptions, Step,
};
use shapes::{both, cube, cube_at, soup, unwelded};
use std::ops::ControlFlow;

fn solid(soup: &PolygonSoup) -> Outcome<Mesh> {
    let outcome = clean(soup, CleanOptions::solid()).expect("a soup is never refused");
    assert_eq!(outcome.value.violations(), []);
    outcome
}

fn kinds(outcome: &Outcome<Mesh>) -> Vec<(Kind, usize)> {
    outcome.report.counts().into_iter().collect()
}

fn without(pool: &IndexedMesh, gone: &[usize]) -> IndexedMesh {
    let faces = pool.polygons().iter().enumerate().filter(|f| !gone.contains(&f.0));
    let faces: Polygons = faces.map(|f| f.1.to_vec()).collect();
    IndexedMesh::new(pool.positions().to_vec(), faces).expect("as valid as before")
}

fn with_face(pool: &IndexedMesh, points: &[DVec3], face: &[u32]) -> PolygonSoup {
    let mut soup = soup(pool);
    soup.positions.extend(points);
    soup.polygons.push(face.iter().copied());
    soup
}

fn scaled(pool: &IndexedMesh, by: f64) -> IndexedMesh {
    let mut pool = pool.clone();
    pool.map_positions(|p| p * by).expect("finite");
    pool
}

#[test]
fn a_solid_comes_out_as_it_is_with_an_empty_record() {
    let cavity = both(&scaled(&cube(), 3.0), &cube_at(DVec3::ONE).reversed());
    for pool in [cube(), shapes::torus(9, 5), shapes::icosphere(3), cavity] {
        let outcome = solid(&soup(&pool));
        assert_eq!(outcome.value.to_indexed(), pool);
        assert!(outcome.report.is_empty() && outcome.maps.faces.is_identity());
    }
}

#[test]
fn a_fin_is_dropped_and_a_wall_within_a_solid_too() {
    let fin = with_face(&cube(), &[dvec3(0.5, -0.3, -0.2)], &[0, 1, 8]);
    let outcome = solid(&fin);
    assert_eq!(outcome.value.to_indexed(), cube());
    assert_eq!(outcome.report.count(Kind::Fin), 1);
    let record = outcome.report.records.iter().find(|r| r.kind == Kind::Fin).expect("one");
    assert_eq!((record.step, record.element), (Step::DropFins, Element::Face(6)));

    // Two cubes with one wall between them.
    let pair = both(&cube(), &cube_at(DVec3::X));
    let mut pair = unwelded(&pair);
    let wall = pair.polygons.iter().position(|f| f.iter().all(|&v| pair.positions[v as usize].x == 1.0));
    let faces = pair.polygons.iter().enumerate().filter(|f| Some(f.0) != wall).map(|f| f.1.to_vec());
    pair.polygons = faces.collect();
    let outcome = solid(&pair);
    assert_eq!(outcome.value.closed().expect("closed").volume(), 2.0);
    assert_eq!((outcome.value.face_count(), outcome.report.count(Kind::Fin)), (10, 1));
}

#[test]
fn a_body_with_a_hole_is_no_fin_of_a_small_solid_that_touches_its_rim() {
    // A large open box; a small tetrahedron stands on one edge of the rim, and has the edge to itself.
    let large = without(&scaled(&cube(), 10.0), &[1]);
    let mut soup = soup(&large);
    let n = soup.positions.len() as u32;
    soup.positions.extend([dvec3(4., -1., 11.), dvec3(6., -1., 12.)]);
    for face in [[4, 5, n + 1], [4, n + 1, n], [5, n, n + 1], [4, n, 5]] {
        soup.polygons.push(face);
    }
    let outcome = solid(&soup);
    assert_eq!(outcome.report.count(Kind::Fin), 0);
    assert_eq!((outcome.value.components().len(), outcome.report.count(Kind::FilledHole)), (2, 1));
    assert!(outcome.value.is_closed());
}

#[test]
fn a_sheet_on_a_small_solid_that_touches_a_large_one_along_an_edge_is_a_fin() {
    // A small tetrahedron stands on the upper edge of a large box; a flag of more than its area hangs on its tip.
    let mut soup = soup(&scaled(&cube(), 10.0));
    let [a, b] = [4, 5].map(|v| soup.positions[v as usize]);
    let n = soup.positions.len() as u32;
    let up = |x: f64, y: f64, z: f64| a.lerp(b, x) + dvec3(0.0, y, z);
    soup.positions.extend([up(0.4, -0.1, 1.0), up(0.6, -0.1, 2.0), up(0.5, -40.0, 50.0)]);
    let tetrahedron = [[4, 5, n + 1], [4, n + 1, n], [5, n, n + 1], [4, n, 5]];
    tetrahedron.into_iter().for_each(|face| soup.polygons.push(face));
    let without_flag = solid(&soup);
    assert!(without_flag.value.is_closed());
    soup.polygons.push([n, n + 1, n + 2]);
    let outcome = solid(&soup);
    assert_eq!(outcome.report.count(Kind::Fin), 1);
    assert_eq!(outcome.value.to_indexed(), without_flag.value.to_indexed());
}

#[test]
fn a_sheet_keeps_what_hangs_on_it() {
    let outcome = solid(&soup(&shapes::fins()));
    assert_eq!(outcome.value.face_count(), 3);
    assert_eq!(outcome.report.count(Kind::Fin), 0);
    assert_eq!(outcome.report.count(Kind::OpenSheet), 2);
}

#[test]
fn a_moebius_strip_is_named_also_on_a_second_pass() {
    let outcome = solid(&unwelded(&shapes::moebius(12)));
    let [cut, named] = [Kind::CutEdge, Kind::NotOrientable].map(|k| outcome.report.count(k));
    assert_eq!((cut, named, outcome.value.face_count()), (1, 1, 12));
    let again = CleanOptions { weld: Weld::None, ..CleanOptions::solid() };
    let again = clean(&outcome.value.to_indexed().into(), again).expect("never refused");
    assert_eq!(kinds(&again), [(Kind::NotOrientable, 1)]);
    assert_eq!(again.value.to_indexed(), outcome.value.to_indexed());
}

#[test]
fn debris_is_dropped_only_if_asked_for_in_either_profile() {
    let pair = soup(&both(&shapes::icosphere(1), &cube_at(DVec3::splat(5.0))));
    assert_eq!(solid(&pair).value.face_count(), 86);
    for options in [CleanOptions::solid(), CleanOptions::default()] {
        let options = CleanOptions { debris: Some(7), ..options };
        let outcome = clean(&pair, options).expect("never refused");
        assert_eq!((outcome.value.face_count(), outcome.value.vertex_count()), (80, 42));
        let gone: Vec<Element> = outcome.report.records.iter().map(|r| r.element).collect();
        assert_eq!(gone, (80..86).map(Element::Face).collect::<Vec<_>>());
    }
}

#[test]
fn records_of_late_steps_are_in_the_numbers_of_the_input() {
    // Face 0 goes at once, so all numbers shift; vertices 0 to 2 are its own.
    let open = without(&cube(), &[1]);
    let mut soup = PolygonSoup::new(vec![DVec3::splat(f64::NAN), DVec3::ZERO, DVec3::X], Polygons::new());
    soup.polygons.push([0, 1, 2]);
    soup.positions.extend(open.positions());
    open.polygons().iter().for_each(|f| soup.polygons.push(f.iter().map(|v| v + 3)));
    let outcome = solid(&soup);
    let found: Vec<_> = outcome.report.records.iter().map(|r| (r.kind, r.element)).collect();
    let expected = [
        (Kind::NonFiniteVertex, Element::Vertex(0)),
        (Kind::NonFiniteFace, Element::Face(0)),
        (Kind::FilledHole, Element::Vertex(4 + 3)),
    ];
    assert_eq!(found, expected);
    // Welded, vertex 1 is vertex 3.
    assert_eq!(outcome.maps.vertices.new_of(1), outcome.maps.vertices.new_of(3));
    assert!(outcome.maps.faces.old_of(5).is_empty(), "the filler comes from nothing");
}

#[test]
fn polygons_stay_polygons_and_attributes_go_along() {
    let open = without(&shapes::torus(12, 8), &[17, 40]);
    let mut soup = soup(&open);
    soup.groups = vec![Group { name: "ring".into(), material: None, faces: 0..soup.polygons.len() }];
    soup.vertex_colors = vec![[0.5; 4]; soup.positions.len()];
    let options = CleanOptions::solid();
    let cleaned = clean_indexed(&soup, options).expect("never refused");
    let pool = cleaned.value;
    assert!(pool.polygons().iter().filter(|f| f.len() == 4).count() >= 94);
    let groups = pool.attributes().face_groups.as_ref().expect("carried");
    assert!((0..pool.face_count()).all(|f| groups.group(f).is_some_and(|g| g.name == "ring")));
    assert_eq!(pool.attributes().vertex_colors.as_ref().map(Vec::len), Some(pool.vertex_count()));
    assert_eq!(cleaned.report.not_carried, [] as [Attribute; 0]);
}

#[test]
fn each_step_can_be_called_on_its_own() {
    let open = without(&shapes::icosphere(2), &[3]);
    let mut mesh = Mesh::build(&both(&open, &cube_at(DVec3::splat(4.0)).reversed())).expect("a manifold");
    assert_eq!(drop_fins(&mut mesh, 0.0).expect("a tolerance").value, 0);
    let slivers = resolve_slivers(&mut mesh, SliverOptions::new(1e-9)).expect("a tolerance");
    assert!(slivers.report.is_empty() && slivers.maps.faces.is_identity());
    let filled = fill_holes(&mut mesh, FillHolesOptions::default()).expect("not cancelled");
    assert_eq!(filled.report.count(Kind::FilledHole), 1);
    assert_eq!((filled.maps.faces.old_len(), filled.maps.faces.new_len()), (325, 326));
    let turned = turn_outward(&mut mesh, Control::none()).expect("not cancelled");
    assert_eq!(turned.report.count(Kind::TurnedShell), 1);
    let gone = drop_debris(&mut mesh, 10);
    assert_eq!((gone.value, gone.maps.faces.new_of(319).len(), mesh.face_count()), (1, 0, 320));
    assert_eq!(drop_isolated(&mut mesh).value, 0);
    assert_eq!(mesh.violations(), []);
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(drop_fins(&mut mesh, bad), Err(CleanError::BadTolerance(_))));
    }
}

#[test]
fn the_account_is_the_same_from_the_library_and_in_json() {
    let soup = with_face(&without(&cube(), &[1]), &[dvec3(0.5, -0.3, -0.2), DVec3::splat(9.0)], &[0, 1, 8]);
    let cleaned = clean_indexed(&soup, CleanOptions::solid()).expect("never refused");
    let account = Account::new(
        &soup,
        (Profile::Solid, Weld::Auto),
        &cleaned.value,
        cleaned.report.clone(),
        &cleaned.maps,
    );
    let account = account.expect("never refused");
    let tally = account.face_tally;
    assert_eq!((tally.input, tally.kept, tally.dropped, tally.added), (6, 5, 1, 1));
    assert_eq!(account.counts[&Kind::IsolatedVertex], 1);
    assert!(account.solid && !account.before.closed && account.after.closed);
    assert_eq!(account.defects, cleaned.report.records);
}

#[test]
fn a_clean_up_for_a_solid_reports_its_progress_and_stops_when_told_to() {
    let soup = with_face(&without(&shapes::icosphere(2), &[5, 90]), &[dvec3(3., 3., 3.)], &[0, 1, 162]);
    let soup = PolygonSoup::new(soup.positions, soup.polygons);
    let mut stages = Vec::new();
    let mut hook = |p: Progress| {
        stages.push((p.stage, p.fraction));
        ControlFlow::Continue(())
    };
    clean(&soup, CleanOptions { control: Control::new(&mut hook), ..CleanOptions::solid() })
        .expect("not cancelled");
    assert!(stages.len() >= 10 && stages.is_sorted_by(|a, b| a.1 <= b.1), "{stages:?}");
    for stop in 0..stages.len() {
        let mut seen = 0;
        let mut hook = |_: Progress| {
            seen += 1;
            if seen > stop { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let options = CleanOptions { control: Control::new(&mut hook), ..CleanOptions::solid() };
        assert!(
            matches!(clean(&soup, options), Err(CleanError::Cancelled(_))),
            "at stop {stop} of {stages:?}"
        );
    }
}
