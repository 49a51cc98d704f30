//! Turning outward: solids face out, cavities in, and what is not sure stays.

#[path = "corpus/mod.rs"]
mod corpus;
#[path = "shapes/mod.rs"]
mod shapes;

use meshwright::cleanup::{CleanOptions, Weld, clean, index};
use meshwright::glam::{DVec3, dvec3};
use meshwright::{
    Cancelled, Control, IndexedMesh, Mesh, OutwardError, OutwardOptions, OutwardPart, Progress,
    orient_outward, unify_winding,
};
use shapes::{both, cube, cube_at, mesh, torus};
use std::ops::ControlFlow;

/// A cube of a given size at a corner.
fn block(corner: DVec3, size: f64) -> IndexedMesh {
    let mut pool = cube();
    pool.map_positions(|p| corner + p * size).expect("finite");
    pool
}

fn turned(pool: &IndexedMesh) -> (Mesh, Vec<OutwardPart<meshwright::FaceKey>>) {
    let mut mesh = mesh(pool);
    let parts = mesh.orient_outward(OutwardOptions::default()).expect("not cancelled");
    mesh.validate().expect("valid");
    // The pool's own form says the same.
    let theirs = orient_outward(&pool.topology(), OutwardOptions::default()).expect("not cancelled");
    let flags = |p: &OutwardPart<u32>| (p.faces, p.closed, p.depth, p.crosses, p.reversed);
    let ours: Vec<_> = parts.iter().map(|p| (p.faces, p.closed, p.depth, p.crosses, p.reversed)).collect();
    assert_eq!(theirs.parts.iter().map(flags).collect::<Vec<_>>(), ours);
    assert!((theirs.outcome.value.area() - pool.area()).abs() < 1e-9);
    let volume = |m: &Mesh| m.closed().map(|c| c.volume()).ok();
    assert_eq!(volume(&Mesh::build(&theirs.outcome.value).expect("a manifold")), volume(&mesh));
    (mesh, parts)
}

fn volume(mesh: &Mesh) -> f64 {
    mesh.closed().expect("closed").volume()
}

#[test]
fn an_inverted_solid_is_turned_and_an_upright_one_stays() {
    for shape in [cube(), torus(9, 6)] {
        let right = volume(&turned(&shape).0);
        assert!(right > 0.0 && !turned(&shape).1[0].reversed);
        let (mesh, parts) = turned(&shape.clone().reversed());
        assert!((volume(&mesh) - right).abs() < 1e-12 && parts[0].reversed && parts[0].confidence == 1.0);
    }
}

#[test]
fn a_cavity_stays_a_cavity_however_its_shells_are_wound() {
    let (outer, inner) = (block(DVec3::ZERO, 3.0), cube_at(DVec3::ONE));
    for flip in 0..4 {
        let wound =
            |shell: &IndexedMesh, flip: bool| if flip { shell.clone().reversed() } else { shell.clone() };
        let (mesh, parts) = turned(&both(&wound(&outer, flip & 1 > 0), &wound(&inner, flip & 2 > 0)));
        assert_eq!(volume(&mesh), 26.0);
        assert_eq!([parts[0].depth, parts[1].depth], [0, 1]);
        assert_eq!([parts[0].reversed, parts[1].reversed], [flip & 1 > 0, flip & 2 == 0]);
    }
}

#[test]
fn shells_in_shells_alternate() {
    let shells = (0..5).map(|i| block(DVec3::splat(f64::from(i)), f64::from(11 - 2 * i)));
    let all = shells.reduce(|a, b| both(&a, &b)).expect("five");
    let (mesh, parts) = turned(&all);
    assert_eq!(parts.iter().map(|p| p.depth).collect::<Vec<_>>(), [0, 1, 2, 3, 4]);
    assert_eq!(volume(&mesh), 11f64.powi(3) - 9f64.powi(3) + 7f64.powi(3) - 5f64.powi(3) + 3f64.powi(3));
}

#[test]
fn solids_side_by_side_and_touching_are_turned_each_by_itself() {
    for at in [dvec3(5., 0., 0.), dvec3(1., 1., 0.), DVec3::ONE, dvec3(1., 0., 0.)] {
        let (mesh, parts) = turned(&both(&cube(), &cube_at(at).reversed()));
        assert_eq!((volume(&mesh), parts[1].reversed, parts[1].depth), (2.0, true, 0), "{at}");
    }
}

#[test]
fn a_shell_that_touches_the_one_around_it_from_inside_is_a_cavity() {
    let (mesh, parts) = turned(&both(&block(DVec3::ZERO, 3.0), &cube_at(dvec3(0., 1., 1.))));
    assert_eq!((volume(&mesh), parts[1].depth), (26.0, 1));
}

#[test]
fn shells_that_cross_are_turned_by_their_own_volume_and_named() {
    let (mesh, parts) = turned(&both(&block(DVec3::ZERO, 2.0), &block(DVec3::ONE, 2.0).reversed()));
    assert!(parts.iter().all(|p| p.crosses && p.depth == 0));
    assert_eq!(volume(&mesh), 16.0);
}

#[test]
fn an_open_box_is_turned_with_less_confidence_and_a_sheet_stays() {
    let lidless = |pool: &IndexedMesh| {
        let faces: Vec<Vec<u32>> = pool.polygons().iter().skip(1).map(<[u32]>::to_vec).collect();
        shapes::pool(pool.positions().to_vec(), faces)
    };
    let (_, parts) = turned(&lidless(&cube().reversed()));
    assert!(parts[0].reversed && !parts[0].closed && (0.6..0.95).contains(&parts[0].confidence), "{parts:?}");
    let (_, parts) = turned(&lidless(&cube()));
    assert!(!parts[0].reversed && parts[0].confidence > 0.6);
    let (_, parts) = turned(&shapes::grid(3));
    assert!(!parts[0].reversed && parts[0].confidence < 0.2, "{parts:?}");
}

#[test]
fn a_mesh_far_from_the_origin_and_of_any_size_is_judged_the_same() {
    for (offset, size) in [(1e6, 1.0), (1e12, 1e3), (0.0, 1e-150), (0.0, 1e150)] {
        let mut pool = both(&block(DVec3::ZERO, 3.0), &cube_at(DVec3::ONE)).reversed();
        pool.map_positions(|p| p * size + offset).expect("finite");
        let mut mesh = mesh(&pool);
        let parts = mesh.orient_outward(OutwardOptions::default()).expect("not cancelled");
        assert_eq!([parts[0].reversed, parts[1].reversed], [true, false], "{offset} {size}");
    }
}

#[test]
fn thousands_of_solids_are_turned_in_time() {
    let mut points = Vec::new();
    let mut faces = Vec::new();
    for i in 0..3000u32 {
        let place = dvec3(f64::from(i % 20), f64::from(i / 20 % 20), f64::from(i / 400)) * 1.5;
        let one = if i.is_multiple_of(3) { cube_at(place).reversed() } else { cube_at(place) };
        faces.extend(one.polygons().iter().map(|f| f.iter().map(|v| v + 8 * i).collect::<Vec<_>>()));
        points.extend_from_slice(one.positions());
    }
    let (mesh, parts) = turned(&shapes::pool(points, faces));
    assert_eq!(parts.iter().filter(|p| p.reversed).count(), 1000);
    assert!((volume(&mesh) - 3000.0).abs() < 1e-6);
}

#[test]
fn bad_confidence_and_cancelling_change_nothing() {
    let mut mesh = mesh(&cube().reversed());
    for bad in [-0.1, 1.1, f64::NAN] {
        let options = OutwardOptions { min_confidence: bad, ..Default::default() };
        assert!(matches!(mesh.orient_outward(options), Err(OutwardError::BadConfidence(_))));
    }
    let mut hook =
        |p: Progress| if p.fraction > 0.2 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    let options = OutwardOptions { control: Control::new(&mut hook), ..Default::default() };
    assert_eq!(mesh.orient_outward(options), Err(OutwardError::Cancelled(Cancelled)));
    assert_eq!(volume(&mesh), -1.0);
}

/// A doubled sheet: closed, and nothing within.
#[test]
fn a_closed_part_of_the_corpus_without_volume_stays_as_it_is_and_says_so() {
    let Some(rows) = corpus::rows() else { return };
    let mut met = 0;
    for row in rows.iter().filter(|r| r.path.ends_with("assimp__regr_3429812.obj")) {
        let soup = row.load().expect("read");
        let pool = index(&soup, Weld::Exact).expect("always answers").value;
        let unified = unify_winding(&pool.topology()).expect("orientable").value;
        for pool in [unified.clone(), unified.reversed()] {
            let found = orient_outward(&pool.topology(), OutwardOptions::default()).expect("not cancelled");
            assert!(
                found.parts.iter().all(|p| p.closed && p.confidence == 0.0 && !p.reversed),
                "{:?}",
                found.parts
            );
            assert!(found.outcome.value == pool && found.outcome.report.is_empty(), "{}", row.path);
            let mut mesh = clean(&pool.into(), CleanOptions::default()).expect("always answers").value;
            let before = mesh.to_indexed();
            let parts = mesh.orient_outward(OutwardOptions::default()).expect("not cancelled");
            assert!(parts.iter().all(|p| p.closed && p.confidence == 0.0 && !p.reversed), "{}", row.path);
            assert!(mesh.to_indexed() == before, "{}", row.path);
        }
        met += 1;
    }
    assert_eq!(met, 1);
}
