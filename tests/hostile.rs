//! Soups that are made to be slow, or that once broke clean-up: bounded work, and an account that says where it ended.

#[path = "drive/clean.rs"]
#[allow(dead_code)]
mod drive;
mod shapes;

use drive::Soup;
use meshwright::cleanup::{CleanOptions, Weld, clean};
use meshwright::glam::{DVec3, dvec3};
use meshwright::{
    FillHolesOptions, FillMethod, IndexedMesh, Kind, Mesh, PolygonSoup, Polygons, SelfIntersectionOptions,
};
use shapes::cube_at;

#[test]
fn open_parts_are_not_turned_however_sure_their_direction_seems() {
    // The part overlaps itself, so that its winding numbers are those of a closed one. Turned, its loops were no longer
    // around one hole to rounding, and a second pass filled them.
    drive::check(&Soup {
        points: vec![[1, 3, -1], [1, -1, 1], [2, 1, 1], [0, 0, 0], [0, 0, -1], [1, -2, 1]],
        faces: vec![
            vec![2, 0, 5],
            vec![3, 5, 6],
            vec![10, 5, 6, 3, 2],
            vec![7, 0, 3],
            vec![3, 0, 2, 7, 4],
            vec![8, 6, 7],
            vec![0, 10, 2],
            vec![0, 1, 5],
            vec![8, 7, 10],
        ],
        weld: 0,
    });
}

/// A cone with so many faces around its apex.
fn cone(faces: u32) -> IndexedMesh {
    let rim = |i: u32| {
        let (s, c) = (f64::from(i) / f64::from(faces) * std::f64::consts::TAU).sin_cos();
        dvec3(c, s, 0.0)
    };
    let points = (0..faces).map(rim).chain([DVec3::Z]).collect();
    shapes::pool(points, (0..faces).map(|i| vec![i, (i + 1) % faces, faces]).collect())
}

#[test]
fn a_search_that_ends_early_says_so_and_finds_nothing_that_is_not_there() {
    let mesh = shapes::mesh(&cone(2000));
    let search = |max_tests| {
        let options = SelfIntersectionOptions { max_tests, ..Default::default() };
        mesh.self_intersections(options).expect("nobody cancels")
    };
    assert_eq!((search(1 << 24).unsearched, search(1 << 24).count()), (0, 0));
    let some = search(1 << 18);
    assert!(some.unsearched > 0 && some.unsearched < 2000 && some.first_unsearched.is_some());
    assert_eq!(some, search(1 << 18));
    assert_eq!(search(0).unsearched, 2000);
}

#[test]
fn a_hub_is_closed_and_what_was_not_looked_at_is_named() {
    let soup: PolygonSoup = cone(8_000).into();
    let cleaned = clean(&soup, CleanOptions::solid()).expect("never refused");
    assert!(cleaned.value.is_closed());
    assert_eq!(cleaned.report.count(Kind::UnsearchedFaces), 1);
}

#[test]
fn ears_serve_once_the_least_area_has_cost_enough() {
    let pool = (1..6).fold(cone(12), |all, i| {
        let mut next = cone(12 + i);
        next.map_positions(|p| p + DVec3::X * f64::from(3 * i)).expect("finite");
        shapes::both(&all, &next)
    });
    let mut mesh = shapes::mesh(&pool);
    let options = FillHolesOptions { exact_cost: 12 * 12 * 12 + 13 * 13 * 13, ..Default::default() };
    let account = mesh.fill_holes(options).expect("good options");
    let methods: Vec<_> = account.filled.iter().map(|hole| (hole.edges, hole.method)).collect();
    let exact = |n| (n, if n < 14 { FillMethod::LeastArea } else { FillMethod::Ears });
    assert_eq!(methods, (12..18).map(exact).collect::<Vec<_>>());
    assert!(mesh.is_closed());
}

#[test]
fn very_many_shells_in_one_place_are_judged_in_bounded_time() {
    let mut soup = PolygonSoup::default();
    for i in 0..1000 {
        let own = cube_at(DVec3::splat(1e-9 * f64::from(i)));
        let first = soup.positions.len() as u32;
        soup.positions.extend_from_slice(own.positions());
        own.polygons().iter().for_each(|f| soup.polygons.push(f.iter().map(|v| v + first)));
    }
    let cleaned =
        clean(&soup, CleanOptions { weld: Weld::None, ..CleanOptions::solid() }).expect("never refused");
    assert!(cleaned.value.is_closed());
    assert!(cleaned.report.count(Kind::CrossingShell) > 0);
}

#[test]
fn triangles_on_one_line_do_not_multiply() {
    let mut noise = shapes::Noise(7);
    let points: Vec<DVec3> = (0..6000).map(|_| DVec3::X * noise.unit() * 1000.0).collect();
    let faces: Polygons = (0..2000).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let cleaned = clean(&PolygonSoup::new(points, faces), CleanOptions::solid()).expect("never refused");
    assert!(cleaned.value.face_count() <= 4000, "{}", cleaned.value.face_count());
    assert!(Mesh::build(&cleaned.value.to_indexed()).is_ok());
}
