//! Subdivision: what each scheme makes, where it puts it, and what it refuses.

mod corpus;
mod igl;
mod shapes;

use igl::Igl;
use meshwright::glam::{DVec3, dvec3};
use meshwright::{
    Control, IndexedMesh, Mesh, Outcome, Progress, Scheme, Step, SubdivideError, SubdivideOptions,
};
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::ops::ControlFlow;

const SCHEMES: [Scheme; 4] = [Scheme::Midpoint, Scheme::Loop, Scheme::CatmullClark, Scheme::Sqrt3];

fn fine(mesh: &Mesh, scheme: Scheme, levels: u32) -> Outcome<Mesh> {
    let options = SubdivideOptions { scheme, levels, ..Default::default() };
    let outcome = mesh.subdivide(options).expect("subdivided");
    assert_eq!(outcome.value.validate(), Ok(()));
    assert_eq!(outcome.maps.vertices.old_len(), mesh.vertex_count());
    assert_eq!(outcome.maps.vertices.new_len(), outcome.value.vertex_count());
    assert_eq!(outcome.maps.faces.old_len(), mesh.face_count());
    assert_eq!(outcome.maps.faces.new_len(), outcome.value.face_count());
    outcome
}

fn built(pool: &IndexedMesh) -> Mesh {
    shapes::mesh(pool)
}

/// An open sheet of `n` by `n` squares with a square hole, as quads.
fn sheet(n: u32) -> IndexedMesh {
    let point = |i: u32| dvec3(f64::from(i % (n + 1)), f64::from(i / (n + 1)), f64::from(i % 5) * 0.2);
    let quad = |i: u32| {
        let a = i / n * (n + 1) + i % n;
        vec![a, a + 1, a + n + 2, a + n + 1]
    };
    let quads = (0..n * n).filter(|&i| i != n * n / 2).map(quad).collect();
    shapes::pool((0..(n + 1) * (n + 1)).map(point).collect(), quads)
}

fn examples() -> Vec<(&'static str, IndexedMesh)> {
    vec![
        ("tetrahedron", shapes::tetrahedron()),
        ("cube", shapes::cube()),
        ("torus", shapes::torus(5, 4)),
        ("triangle", shapes::pool(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![vec![0, 1, 2]])),
        ("grid", shapes::grid(3)),
        ("sheet", sheet(5)),
        ("two", shapes::both(&shapes::cube(), &shapes::grid(2))),
        ("sphere", shapes::icosphere(1)),
        ("pentagon", {
            let corner = |i: u32| {
                let (y, x) = (f64::from(i) * 1.256637).sin_cos();
                dvec3(x, y, 0.0)
            };
            shapes::pool((0..5).map(corner).collect(), vec![(0..5).collect()])
        }),
    ]
}

#[test]
fn every_scheme_keeps_euler_characteristic_boundary_and_components() {
    for (name, pool) in examples() {
        let mesh = built(&pool);
        for scheme in SCHEMES {
            for levels in 0..4 {
                let fine = fine(&mesh, scheme, levels).value;
                let facts =
                    |m: &Mesh| (m.euler_characteristic(), m.boundary_loops().len(), m.components().len());
                assert_eq!(facts(&fine), facts(&mesh), "{name}, {scheme:?}, {levels} levels");
            }
        }
    }
}

#[test]
fn levels_at_once_are_levels_one_by_one() {
    for (name, pool) in examples() {
        let mesh = built(&pool);
        for scheme in [Scheme::Midpoint, Scheme::Loop, Scheme::CatmullClark] {
            let at_once = fine(&mesh, scheme, 3);
            let first = fine(&mesh, scheme, 1);
            let second = fine(&first.value, scheme, 1);
            let third = fine(&second.value, scheme, 1);
            let (a, b) = (at_once.value.to_indexed(), third.value.to_indexed());
            assert_eq!(a.face_count(), b.face_count(), "{name}, {scheme:?}");
            assert_eq!(sorted(&a), sorted(&b), "{name}, {scheme:?}");
            let maps = first.maps.then(&second.maps).and_then(|m| m.then(&third.maps)).expect("they fit");
            assert_eq!(maps.faces, at_once.maps.faces, "{name}, {scheme:?}");
        }
    }
}

/// Faces as positions, each from its lowest, in order; so that numbering does not matter. Rounded to nine digits.
fn sorted(pool: &IndexedMesh) -> Vec<Vec<[i64; 3]>> {
    let at = |&v: &u32| (pool.positions()[v as usize].to_array()).map(|x| (x * 1e9).round() as i64);
    let mut faces: Vec<Vec<[i64; 3]>> = pool.polygons().iter().map(|f| f.iter().map(at).collect()).collect();
    for f in &mut faces {
        let low = (0..f.len()).min_by_key(|&i| f[i]).unwrap_or(0);
        f.rotate_left(low);
    }
    faces.sort();
    faces
}

#[test]
fn a_triangle_gives_four_a_polygon_as_many_as_it_has_corners_and_sqrt3_three() {
    let cube = built(&shapes::cube());
    for (scheme, faces) in
        [(Scheme::Midpoint, 24), (Scheme::CatmullClark, 24), (Scheme::Loop, 48), (Scheme::Sqrt3, 36)]
    {
        assert_eq!(fine(&cube, scheme, 1).value.face_count(), faces, "{scheme:?}");
    }
    let tetrahedron = built(&shapes::tetrahedron());
    for (scheme, faces) in
        [(Scheme::Midpoint, 16), (Scheme::CatmullClark, 12), (Scheme::Loop, 16), (Scheme::Sqrt3, 12)]
    {
        assert_eq!(fine(&tetrahedron, scheme, 1).value.face_count(), faces, "{scheme:?}");
    }
}

#[test]
fn midpoint_moves_nothing_and_puts_one_vertex_on_each_edge() {
    let pool = shapes::icosphere(1);
    let mesh = built(&pool);
    let outcome = fine(&mesh, Scheme::Midpoint, 1);
    let fine = outcome.value.to_indexed();
    assert_eq!(&fine.positions()[..pool.vertex_count()], pool.positions());
    assert_eq!(fine.vertex_count(), pool.vertex_count() + mesh.edge_count());
    for v in pool.vertex_count()..fine.vertex_count() {
        let &[a, b] = outcome.maps.vertices.old_of(v) else { panic!("two parents") };
        let [a, b] = [a, b].map(|v| pool.positions()[v as usize]);
        assert_eq!(fine.positions()[v], (a + b) * 0.5);
    }
    assert!((fine.area() - pool.area()).abs() < 1e-12);
}

#[test]
fn no_level_changes_nothing() {
    let pool = shapes::cube();
    for scheme in SCHEMES {
        let outcome = fine(&built(&pool), scheme, 0);
        assert_eq!(outcome.value.to_indexed(), pool);
        assert!(outcome.maps.vertices.is_identity() && outcome.maps.faces.is_identity());
    }
}

#[test]
fn parents_are_a_vertex_an_edge_or_a_face() {
    let pool = shapes::cube();
    let outcome = fine(&built(&pool), Scheme::CatmullClark, 2);
    let parents: Vec<usize> =
        (0..outcome.value.vertex_count()).map(|v| outcome.maps.vertices.old_of(v).len()).collect();
    let count = |n| parents.iter().filter(|&&p| p == n).count();
    // After two levels an edge carries three vertices, a face nine within.
    assert_eq!((count(1), count(2), count(4)), (8, 12 * 3, 6 * 9));
    for f in 0..outcome.value.face_count() {
        let &[old] = outcome.maps.faces.old_of(f) else { panic!("one parent") };
        assert_eq!(old as usize, f / 16);
    }
    // On triangles cut from polygons, a vertex on a diagonal lies in the face.
    let outcome = fine(&built(&pool), Scheme::Loop, 1);
    assert_eq!(outcome.report.steps[0].step, Step::Triangulate);
    let inside = (0..outcome.value.vertex_count()).filter(|&v| outcome.maps.vertices.old_of(v).len() == 4);
    assert_eq!(inside.count(), 6);
    assert_eq!(outcome.maps.faces.new_of(3), (24..32).collect::<Vec<u32>>());
}

/// Whether both are the same faces at the same places, whatever the numbering.
fn assert_same(name: &str, ours: &IndexedMesh, positions: &[DVec3], triangles: &[[u32; 3]]) {
    assert_eq!(ours.vertex_count(), positions.len(), "{name}: vertices");
    let scale = ours.bounds().map_or(1.0, |b| (b.max - b.min).length());
    let nearest = |p: &DVec3| {
        let near = |q: &&(usize, &DVec3)| q.1.distance(*p) < 1e-9 * scale;
        let all: Vec<(usize, &DVec3)> = ours.positions().iter().enumerate().collect();
        let found: Vec<usize> = all.iter().filter(near).map(|q| q.0).collect();
        assert_eq!(found.len(), 1, "{name}: {p}");
        found[0] as u32
    };
    let number: Vec<u32> = positions.iter().map(nearest).collect();
    let canon = |t: [u32; 3]| {
        let low = (0..3).min_by_key(|&i| t[i]).expect("three");
        [0, 1, 2].map(|i| t[(low + i) % 3])
    };
    let mut theirs: Vec<_> = triangles.iter().map(|t| canon(t.map(|v| number[v as usize]))).collect();
    let mut own: Vec<_> = ours.polygons().iter().map(|f| canon([f[0], f[1], f[2]])).collect();
    theirs.sort_unstable();
    own.sort_unstable();
    assert_eq!(own, theirs, "{name}: faces");
}

#[test]
fn loop_and_midpoint_are_libigls() {
    let mut igl = Igl::start();
    let closed = [
        ("tetrahedron", shapes::tetrahedron()),
        ("cube", shapes::fanned(&shapes::cube())),
        ("torus", shapes::fanned(&shapes::torus(7, 5))),
        ("sphere", shapes::icosphere(2)),
        ("two", shapes::both(&shapes::tetrahedron(), &shapes::fanned(&shapes::cube_at(DVec3::splat(3.0))))),
    ];
    // libigl's boundary rule is ours as well.
    let open = [("grid", shapes::grid(5))];
    for (name, pool) in closed.into_iter().chain(open) {
        for (scheme, call) in [(Scheme::Loop, "loop"), (Scheme::Midpoint, "upsample")] {
            for levels in 1..3 {
                let ours = fine(&built(&pool), scheme, levels).value.to_indexed();
                let theirs = igl.ask_for(&pool, &format!("{call}{levels}"));
                assert_same(&format!("{name}, {call}, {levels}"), &ours, &theirs.0, &theirs.1);
            }
        }
    }
}

#[test]
fn loop_and_midpoint_are_libigls_on_the_corpus() {
    let Some(rows) = corpus::rows() else { return };
    let mut igl = Igl::start();
    let mut compared = 0;
    for row in rows.iter().filter(|r| r.is_readable()) {
        let Ok(soup) = row.load() else { continue };
        let cleaned = meshwright::cleanup::clean(&soup, Default::default()).expect("always answers").value;
        let pool = cleaned.to_indexed();
        if !cleaned.is_closed()
            || pool.face_count() > 600
            || pool.polygons().iter().any(|f| f.len() != 3)
            || !pool.topology().isolated_vertices().is_empty()
            || coincident(&pool)
        {
            continue;
        }
        for (scheme, call) in [(Scheme::Loop, "loop1"), (Scheme::Midpoint, "upsample1")] {
            let ours = fine(&cleaned, scheme, 1).value.to_indexed();
            if coincident(&ours) {
                continue;
            }
            let theirs = igl.ask_for(&pool, call);
            assert_same(&format!("{}, {call}", row.path), &ours, &theirs.0, &theirs.1);
            compared += 1;
        }
    }
    assert!(compared > 10, "only {compared} were compared");
}

fn coincident(pool: &IndexedMesh) -> bool {
    let scale = pool.bounds().map_or(1.0, |b| (b.max - b.min).length());
    let p = pool.positions();
    (0..p.len()).any(|i| (0..i).any(|j| p[i].distance(p[j]) < 4e-9 * scale))
}

#[test]
fn catmull_clark_of_the_cube_follows_the_known_rules() {
    // The unit cube about the origin: faces at .5, edges at .375 along two axes, corners at 5/18.
    let mut cube = built(&shapes::cube());
    cube.translate(DVec3::splat(-0.5)).expect("moved");
    let one = fine(&cube, Scheme::CatmullClark, 1).value.to_indexed();
    for (v, p) in one.positions().iter().enumerate() {
        let mut size = p.abs().to_array();
        size.sort_by(f64::total_cmp);
        let expected = match v {
            0..8 => [5.0 / 18.0; 3],
            8..20 => [0.0, 0.375, 0.375],
            _ => [0.0, 0.0, 0.5],
        };
        for (a, b) in size.into_iter().zip(expected) {
            assert!((a - b).abs() < 1e-15, "{v}: {p}");
        }
    }
    // The limit of a vertex of valence n: (n^2 v + 4 sum of edge points + sum of face points) / (n (n + 5)), taken from
    // the neighbours of any level.
    let limit = |mesh: &Mesh, i: usize| {
        let v = mesh.vertices().nth(i).expect("there");
        let n = mesh.valence(v) as f64;
        let edges: DVec3 = mesh.neighbors(v).map(|w| mesh.position(w)).sum();
        let across = |f| mesh.face_vertices(f).find(|&w| w != v && mesh.find_halfedge(v, w).is_none());
        let faces: DVec3 = mesh.faces_around(v).map(|f| mesh.position(across(f).expect("a quad"))).sum();
        (mesh.position(v) * n * n + edges * 4.0 + faces) / (n * (n + 5.0))
    };
    let levels: Vec<Mesh> = (1..4).map(|l| fine(&cube, Scheme::CatmullClark, l).value).collect();
    for i in [0, 9, 25] {
        let expected = limit(&levels[0], i);
        for level in &levels[1..] {
            assert!(limit(level, i).distance(expected) < 1e-14, "vertex {i}");
        }
        let deep = fine(&cube, Scheme::CatmullClark, 7).value.to_indexed();
        assert!(deep.positions()[i].distance(expected) < 1e-4);
    }
}

#[test]
fn boundaries_follow_the_cubic_spline_whatever_lies_within() {
    for scheme in [Scheme::Loop, Scheme::CatmullClark] {
        let pool = if scheme == Scheme::Loop { shapes::grid(4) } else { sheet(5) };
        let mesh = built(&pool);
        let outcome = fine(&mesh, scheme, 1);
        let new = outcome.value.to_indexed();
        for h in mesh.boundary_halfedges() {
            let at = |h| mesh.position(mesh.origin(h));
            let v = mesh.vertices().position(|v| v == mesh.origin(h)).expect("there");
            let expected = at(h) * 0.75 + (at(mesh.prev(h)) + at(mesh.next(h))) * 0.125;
            assert!(new.positions()[v].distance(expected) < 1e-14, "{scheme:?}");
        }
        // Sharp edges within, everywhere: only corners and midpoints are left of the scheme.
        let edges: Vec<_> = mesh.edges().collect();
        let options = SubdivideOptions { scheme, creases: &edges, ..Default::default() };
        let creased = mesh.subdivide(options).expect("subdivided").value.to_indexed();
        let midpoint = fine(&mesh, Scheme::Midpoint, 1).value.to_indexed();
        for v in 0..pool.vertex_count() {
            let key = mesh.vertices().nth(v).expect("there");
            if mesh.valence(key) > 2 {
                assert_eq!(creased.positions()[v], pool.positions()[v]);
            }
        }
        for v in pool.vertex_count()..pool.vertex_count() + mesh.edge_count() {
            assert!(creased.positions()[v].distance(midpoint.positions()[v]) < 1e-15);
        }
    }
}

#[test]
fn creases_by_angle_keep_the_cube_a_cube() {
    let cube = built(&shapes::cube());
    for scheme in [Scheme::Loop, Scheme::CatmullClark] {
        let options =
            SubdivideOptions { scheme, levels: 3, crease_degrees: Some(45.0), ..Default::default() };
        let sharp = cube.subdivide(options).expect("subdivided").value;
        assert!((sharp.closed().expect("closed").volume() - 1.0).abs() < 1e-12, "{scheme:?}");
        let smooth = fine(&cube, scheme, 3).value;
        assert!(smooth.closed().expect("closed").volume() < 0.9, "{scheme:?}");
    }
}

#[test]
fn corners_stay_and_creases_stay_curves() {
    let cube = built(&shapes::cube());
    let corner = cube.vertices().next().expect("there");
    for scheme in [Scheme::Loop, Scheme::CatmullClark] {
        let options = SubdivideOptions { scheme, levels: 2, corners: &[corner], ..Default::default() };
        let pinned = cube.subdivide(options).expect("subdivided").value.to_indexed();
        assert_eq!(pinned.positions()[0], DVec3::ZERO);
        assert_ne!(pinned.positions()[7], DVec3::ONE);
        // The edges of the top as a crease: its curve stays in the plane of the top.
        let top: Vec<_> = cube
            .edges()
            .filter(|&e| {
                let h = cube.edge_halfedge(e);
                cube.position(cube.origin(h)).z + cube.position(cube.target(h)).z == 2.0
            })
            .collect();
        assert_eq!(top.len(), 4);
        let options = SubdivideOptions { scheme, levels: 2, creases: &top, ..Default::default() };
        let rim = cube.subdivide(options).expect("subdivided");
        let flat = rim.value.to_indexed();
        let on_top =
            (0..flat.vertex_count()).filter(|&v| rim.maps.vertices.old_of(v).iter().all(|&o| o >= 4));
        for v in on_top {
            assert!((flat.positions()[v].z - 1.0).abs() < 1e-15, "{scheme:?}");
        }
    }
}

#[test]
fn sqrt3_twice_cuts_every_edge_in_three() {
    let pool = shapes::grid(3);
    let mesh = built(&pool);
    let one = fine(&mesh, Scheme::Sqrt3, 1).value;
    assert_eq!(one.boundary_halfedges().count(), mesh.boundary_halfedges().count());
    let two = fine(&mesh, Scheme::Sqrt3, 2).value;
    assert_eq!(two.boundary_halfedges().count(), 3 * mesh.boundary_halfedges().count());
    assert_eq!(two.face_count(), 9 * mesh.face_count());
    // Flat and regular inside, the second level is the regular lattice of thirds.
    let plane = |p: DVec3| dvec3(p.x, p.y, 0.0);
    let mut flat = shapes::grid(9);
    flat.map_positions(plane).expect("finite");
    let two = fine(&built(&flat), Scheme::Sqrt3, 2).value.to_indexed();
    for p in two.positions().iter().filter(|p| (3.0..6.0).contains(&p.x) && (3.0..6.0).contains(&p.y)) {
        let third = *p * 3.0;
        assert!((third - third.round()).length() < 1e-12, "{p}");
    }
}

#[test]
fn a_selection_is_cut_and_its_neighbours_are_closed_without_t_junctions() {
    for (name, pool) in examples() {
        let mesh = built(&pool);
        let mut noise = shapes::Noise(3);
        for round in 0..20 {
            let only: Vec<_> = mesh.faces().filter(|_| noise.below(3) == 0).collect();
            for levels in 1..3 {
                let options = SubdivideOptions { only: Some(&only), levels, ..Default::default() };
                let outcome = mesh.subdivide(options).expect("subdivided");
                let fine = &outcome.value;
                assert_eq!(fine.validate(), Ok(()));
                let facts =
                    |m: &Mesh| (m.euler_characteristic(), m.boundary_loops().len(), m.components().len());
                assert_eq!(facts(fine), facts(&mesh), "{name}, {round}");
                // A T-junction would leave an open edge.
                assert_eq!(fine.is_closed(), mesh.is_closed(), "{name}, {round}");
                let (new, old) = (fine.to_indexed(), mesh.to_indexed());
                assert_eq!(&new.positions()[..old.vertex_count()], old.positions());
                if old.polygons().iter().all(|f| f.len() == 3) {
                    assert!(new.polygons().iter().all(|f| f.len() == 3), "{name}: triangles stay triangles");
                    assert!((new.area() - old.area()).abs() < 1e-9 * old.area(), "{name}");
                }
                for (f, key) in mesh.faces().enumerate() {
                    let parts = outcome.maps.faces.new_of(f).len();
                    if only.contains(&key) {
                        let first = if mesh.degree(key) == 3 { 4 } else { mesh.degree(key) };
                        assert_eq!(parts, first * 4usize.pow(levels - 1), "{name}, {round}");
                    } else {
                        assert!(parts >= 1);
                    }
                }
            }
        }
    }
}

#[test]
fn selecting_everything_is_selecting_nothing_in_particular() {
    for (name, pool) in examples() {
        let mesh = built(&pool);
        let all: Vec<_> = mesh.faces().collect();
        let options = SubdivideOptions { only: Some(&all), levels: 2, ..Default::default() };
        let selected = mesh.subdivide(options).expect("subdivided").value.to_indexed();
        assert_eq!(sorted(&selected), sorted(&fine(&mesh, Scheme::Midpoint, 2).value.to_indexed()), "{name}");
    }
}

#[test]
fn neighbours_with_one_or_two_cut_sides_are_bisected() {
    let mesh = built(&shapes::tetrahedron());
    let only: Vec<_> = mesh.faces().take(1).collect();
    let options = SubdivideOptions { only: Some(&only), ..Default::default() };
    let outcome = mesh.subdivide(options).expect("subdivided");
    let parts: Vec<usize> = (0..4).map(|f| outcome.maps.faces.new_of(f).len()).collect();
    assert_eq!(parts, [4, 2, 2, 2]);
    let cube = built(&shapes::cube());
    let only: Vec<_> = cube.faces().take(1).collect();
    let options = SubdivideOptions { only: Some(&only), ..Default::default() };
    let fine = cube.subdivide(options).expect("subdivided").value;
    let mut degrees: BTreeMap<usize, usize> = BTreeMap::new();
    fine.faces().for_each(|f| *degrees.entry(fine.degree(f)).or_default() += 1);
    assert_eq!(degrees, BTreeMap::from([(4, 5), (5, 4)]), "larger faces take the vertex as a corner");
}

#[test]
fn too_many_faces_are_refused_before_anything_is_made() {
    let mesh = built(&shapes::cube());
    for scheme in SCHEMES {
        let options = SubdivideOptions { scheme, levels: u32::MAX, ..Default::default() };
        assert!(matches!(mesh.subdivide(options), Err(SubdivideError::TooLarge { .. })), "{scheme:?}");
        let options = SubdivideOptions { scheme, levels: 40, max_faces: usize::MAX, ..Default::default() };
        assert!(matches!(mesh.subdivide(options), Err(SubdivideError::TooLarge { .. })), "{scheme:?}");
    }
    let options = SubdivideOptions { levels: 2, max_faces: 95, ..Default::default() };
    let refused = mesh.subdivide(options).expect_err("96 faces");
    assert_eq!(refused, SubdivideError::TooLarge { level: 2, elements: 96, limit: 95 });
    let all: Vec<_> = mesh.faces().collect();
    let options =
        SubdivideOptions { levels: u32::MAX, only: Some(&all), max_faces: 5000, ..Default::default() };
    assert!(matches!(mesh.subdivide(options), Err(SubdivideError::TooLarge { .. })));
}

#[test]
fn options_a_scheme_has_no_rule_for_and_dead_keys_are_refused() {
    let mesh = built(&shapes::cube());
    let other = built(&shapes::torus(9, 9));
    let (f, e, v) = (other.faces().last(), other.edges().last(), other.vertices().last());
    let (f, e, v) = (f.expect("there"), e.expect("there"), v.expect("there"));
    macro_rules! refuse {
        ($($field:tt)*) => {
            mesh.subdivide(SubdivideOptions { $($field)*, ..Default::default() }).expect_err("refused")
        };
    }
    assert_eq!(refuse!(only: Some(&[f])), SubdivideError::MissingFace(f));
    let loop_ = Scheme::Loop;
    assert_eq!(refuse!(scheme: loop_, creases: &[e]), SubdivideError::MissingEdge(e));
    assert_eq!(refuse!(scheme: loop_, corners: &[v]), SubdivideError::MissingVertex(v));
    assert_eq!(refuse!(scheme: loop_, only: Some(&[])), SubdivideError::NoSelection(loop_));
    assert_eq!(refuse!(scheme: Scheme::Sqrt3, creases: &[e]), SubdivideError::NoCreases(Scheme::Sqrt3));
    for angle in [-1.0, 181.0, f64::NAN] {
        let refused = refuse!(scheme: loop_, crease_degrees: Some(angle));
        assert!(matches!(refused, SubdivideError::BadAngle(_)));
    }
}

#[test]
fn polygons_whose_diagonals_are_edges_elsewhere_cannot_be_cut() {
    // A sphere of three faces, of which one shares two edges with another.
    let points = vec![
        DVec3::ZERO,
        DVec3::X,
        dvec3(0., 1., 0.),
        dvec3(1., 1., 0.),
        dvec3(2., 0.5, 1.),
        dvec3(-1., 0.5, 1.),
    ];
    let pool = shapes::pool(points, vec![vec![0, 1, 3, 2], vec![1, 0, 5, 4], vec![0, 2, 3, 1, 4, 5]]);
    let mesh = built(&pool);
    for scheme in [Scheme::Loop, Scheme::Sqrt3] {
        match mesh.subdivide(SubdivideOptions { scheme, ..Default::default() }) {
            Ok(fine) => assert_eq!(fine.value.validate(), Ok(())),
            Err(error) => assert!(matches!(error, SubdivideError::NotTriangulable(_)), "{error}"),
        }
    }
    // Those that need no triangles do it.
    fine(&mesh, Scheme::CatmullClark, 2);
    fine(&mesh, Scheme::Midpoint, 2);
}

#[test]
fn the_largest_numbers_do_not_overflow() {
    let mut pool = shapes::cube();
    pool.map_positions(|p| (p - DVec3::splat(0.5)) * 2.0 * f64::MAX).expect("finite");
    for scheme in SCHEMES {
        let fine = fine(&built(&pool), scheme, 2).value;
        assert!(fine.vertices().all(|v| fine.position(v).is_finite()), "{scheme:?}");
    }
}

#[test]
fn a_cancelled_call_says_so_wherever_it_is_stopped() {
    let mesh = built(&shapes::cube());
    let all: Vec<_> = mesh.faces().collect();
    for (scheme, only) in SCHEMES.map(|s| (s, None)).into_iter().chain([(Scheme::Midpoint, Some(&all[..]))]) {
        let mut seen = Vec::new();
        let mut watch = |p: Progress| {
            seen.push(p.fraction);
            ControlFlow::Continue(())
        };
        let options = SubdivideOptions {
            scheme,
            only,
            levels: 2,
            control: Control::new(&mut watch),
            ..Default::default()
        };
        mesh.subdivide(options).expect("subdivided");
        assert!(seen.is_sorted() && seen.len() >= 4, "{scheme:?}: {seen:?}");
        for stop in 0..seen.len() {
            let mut count = 0;
            let mut hook = |_: Progress| {
                count += 1;
                if count > stop { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            };
            let options = SubdivideOptions {
                scheme,
                only,
                levels: 2,
                control: Control::new(&mut hook),
                ..Default::default()
            };
            assert!(
                matches!(mesh.subdivide(options), Err(SubdivideError::Cancelled(_))),
                "{scheme:?}, {stop}"
            );
        }
    }
}

proptest! {
    #[test]
    fn subdividing_any_cleaned_soup_keeps_its_topology(
        faces in prop::collection::vec(prop::sample::subsequence((0..9u32).collect::<Vec<_>>(), 3..6), 1..14),
        scheme in prop::sample::select(SCHEMES.to_vec()),
        levels in 1u32..3,
    ) {
        let points = (0..9).map(|i| dvec3(f64::from(i % 3), f64::from(i / 3), f64::from(i * i % 7))).collect();
        let soup = meshwright::PolygonSoup::new(points, faces.into());
        let mesh = meshwright::cleanup::clean(&soup, Default::default()).expect("always answers").value;
        match mesh.subdivide(SubdivideOptions { scheme, levels, ..Default::default() }) {
            Ok(outcome) => {
                let fine = outcome.value;
                prop_assert_eq!(fine.validate(), Ok(()));
                let facts = |m: &Mesh| (m.euler_characteristic(), m.boundary_loops().len(), m.components().len());
                prop_assert_eq!(facts(&fine), facts(&mesh));
            }
            Err(error) => prop_assert!(matches!(error, SubdivideError::NotTriangulable(_)), "{}", error),
        }
    }
}
