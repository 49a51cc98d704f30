//! Rows about what a mesh is: the vertex pool, naked edges, closed or not, winding.

use crate::shapes::{self, both, cube, cube_at, fanned, mesh};
use crate::{lidless, manifolds, models, welded};
use meshwright::cleanup::{CleanOptions, clean};
use meshwright::glam::{DVec3, dvec3};
use meshwright::{Element, IndexedMesh, Kind, Mesh, PolygonSoup, Polygons, unify_winding};

/// A prism over a regular polygon: two faces of `n` corners, and `n` quads.
fn prism(n: u32) -> IndexedMesh {
    let at = |i: u32, z: f64| {
        let (y, x) = (f64::from(i) / f64::from(n) * std::f64::consts::TAU).sin_cos();
        dvec3(x, y, z)
    };
    let points = (0..n).map(|i| at(i, 0.0)).chain((0..n).map(|i| at(i, 1.0))).collect();
    let mut faces = vec![(0..n).rev().collect(), (n..2 * n).collect()];
    faces.extend((0..n).map(|i| vec![i, (i + 1) % n, n + (i + 1) % n, n + i]));
    shapes::pool(points, faces)
}

#[test]
fn faces_of_any_degree_share_vertices() {
    for n in [3, 4, 5, 8, 40, 500] {
        let pool = prism(n);
        let mesh = mesh(&pool);
        let degrees: Vec<_> = mesh.faces().map(|f| mesh.degree(f)).collect();
        assert_eq!((degrees[0], degrees[2], mesh.vertex_count()), (n as usize, 4, 2 * n as usize));
        assert_eq!((mesh.is_closed(), mesh.euler_characteristic()), (true, 2));
        let sector = (std::f64::consts::TAU / f64::from(n)).sin() / 2.0;
        let volume = mesh.closed().expect("closed").volume();
        assert!((volume - f64::from(n) * sector).abs() < 1e-12, "{n}");
        assert_eq!(mesh.to_indexed(), pool);
    }
}

#[test]
fn rhinos_quad_that_names_its_last_corner_twice_is_a_triangle() {
    let polygons = Polygons::from_quads(&[[0, 1, 2, 3], [0, 4, 1, 1], [4, 5, 5, 5]]);
    let degrees: Vec<_> = polygons.iter().map(<[u32]>::len).collect();
    assert_eq!((degrees, &polygons[1]), (vec![4, 3, 3], [0, 4, 1].as_slice()));
    let points = vec![DVec3::ZERO, DVec3::X, dvec3(1., 1., 0.), DVec3::Y, DVec3::NEG_Y];
    let pool = IndexedMesh::from_quads(points.clone(), &[[0, 1, 2, 3], [0, 4, 1, 1]]).expect("valid");
    assert_eq!(Mesh::build(&pool).expect("a manifold").boundary_halfedges().count(), 5);
    // A file that says it with four corners comes out the same, with a record.
    let soup = PolygonSoup::new(points, vec![vec![0, 1, 2, 3], vec![0, 4, 1, 1]].into());
    let cleaned = clean(&soup, CleanOptions::default()).expect("always answers");
    assert_eq!(cleaned.value.to_indexed(), pool);
    assert_eq!(cleaned.report.records.len(), 1);
    assert_eq!(
        (cleaned.report.records[0].kind, cleaned.report.records[0].element),
        (Kind::RepeatedCorner, Element::Face(1))
    );
}

#[test]
fn boundary_half_edges_run_in_oriented_loops() {
    let named = manifolds().into_iter().map(|(name, pool)| (name, mesh(&pool)));
    for (name, mesh) in named.chain(models(2000)) {
        let loops = mesh.boundary_loops();
        for l in &loops {
            for (i, &h) in l.iter().enumerate() {
                let next = l[(i + 1) % l.len()];
                assert!(mesh.is_boundary(h) && mesh.target(h) == mesh.origin(next), "{name}");
            }
        }
        let strung: usize = loops.iter().map(Vec::len).sum();
        assert_eq!(strung, mesh.boundary_halfedges().count(), "{name}: each in one loop");
    }
    let open = mesh(&lidless(&cube()));
    assert_eq!(open.boundary_loops().iter().map(Vec::len).collect::<Vec<_>>(), [4]);
}

#[test]
fn a_pinched_vertex_gives_two_loops_and_three_faces_on_an_edge_are_listed_apart() {
    let naked = shapes::bow_tie().topology().naked_edges();
    assert_eq!(naked.loops.len(), 2);
    assert!(naked.loops.iter().all(|l| l.len() == 3 && l.contains(&0)));
    let fins = shapes::fins();
    let topology = fins.topology();
    let more: Vec<_> = topology.nonmanifold_edges().map(|e| (e.vertices(), e.faces().count())).collect();
    assert_eq!(more, [([0, 1], 3)]);
    assert!(topology.boundary_edges().all(|e| e.vertices() != [0, 1]), "it is not naked");
}

#[test]
fn closed_edge_manifold_vertex_manifold_oriented_and_orientable_are_separate_answers() {
    let mixed = shapes::some_reversed(&fanned(&cube()), 3, 1);
    let at_an_edge = welded(&shapes::soup(&shapes::cubes_at_an_edge()));
    let at_a_vertex = welded(&shapes::soup(&shapes::cubes_at_a_vertex()));
    for (name, pool, expected) in [
        ("cube", cube(), [true, true, true, true, true]),
        ("inverted", cube().reversed(), [true, true, true, true, true]),
        ("mixed", mixed, [true, true, true, false, true]),
        ("open", lidless(&cube()), [false, true, true, true, true]),
        ("sharing an edge", at_an_edge, [false, false, true, true, true]),
        ("sharing a vertex", at_a_vertex, [true, true, false, true, true]),
        ("fins", shapes::fins(), [false, false, true, true, true]),
        ("bow tie", shapes::bow_tie(), [false, true, false, true, true]),
        ("moebius", shapes::moebius(6), [false, true, true, false, false]),
        ("nothing", IndexedMesh::default(), [false, true, true, true, true]),
    ] {
        let t = pool.topology();
        let answers = [
            t.is_closed(),
            t.is_edge_manifold(),
            t.is_vertex_manifold(),
            t.is_oriented(),
            t.orientable().is_ok(),
        ];
        assert_eq!(answers, expected, "{name}");
        // Each no has witnesses, each yes has none.
        assert_eq!(t.nonmanifold_edges().next().is_none(), answers[1], "{name}");
        assert_eq!(t.pinched_vertices().is_empty(), answers[2], "{name}");
        assert_eq!(t.conflicting_edges().next().is_none(), answers[3], "{name}");
        if let Err(error) = t.orientable() {
            assert!(!error.cycles.is_empty() && error.cycles.iter().all(|c| c.len() > 1), "{name}");
        }
        let open = t.boundary_edges().chain(t.nonmanifold_edges()).next().is_some();
        assert_eq!(open, !answers[0] && pool.face_count() > 0, "{name}");
    }
}

#[test]
fn unify_reaches_every_component() {
    let parts = (0..6).map(|i| fanned(&cube_at(DVec3::X * f64::from(3 * i))));
    let pool = parts.reduce(|a, b| both(&a, &b)).expect("six");
    for seed in 0..5 {
        let mixed = shapes::some_reversed(&pool, 4, seed);
        let unified = unify_winding(&mixed.topology()).expect("orientable");
        assert!(unified.value.topology().is_oriented());
        assert_eq!(Mesh::build(&unified.value).expect("a manifold").components().len(), 6);
    }
}

#[test]
fn unify_never_crosses_an_edge_with_three_faces() {
    // Three pages on the edge 0-1, each of two triangles; the second triangle of each page is wound against the first.
    let mut points = vec![DVec3::ZERO, DVec3::Z];
    let mut faces = Vec::new();
    for page in 0..3u32 {
        let (y, x) = (f64::from(page) * 2.0).sin_cos();
        points.extend([dvec3(x, y, 0.0), dvec3(x, y, 1.0)]);
        let (a, b) = (2 + 2 * page, 3 + 2 * page);
        let first = if page == 1 { vec![1, 0, a] } else { vec![0, 1, a] };
        let second = if page == 1 { vec![1, b, a] } else { vec![1, a, b] };
        faces.extend([first, second]);
    }
    let pool = shapes::pool(points, faces);
    let unified = unify_winding(&pool.topology()).expect("orientable");
    assert!(unified.value.topology().conflicting_edges().next().is_none());
    // Each page keeps its first face, the piece with the lowest face among equals, whatever the other pages do.
    for page in 0..3 {
        assert_eq!(unified.value.polygons()[2 * page], pool.polygons()[2 * page], "page {page}");
    }
    let flipped: Vec<_> = unified.report.records.iter().map(|r| r.element).collect();
    let page_one = pool.polygons()[3] != unified.value.polygons()[3];
    assert_eq!(flipped.contains(&Element::Face(3)), page_one);
}

#[test]
fn flip_turns_a_part_or_the_whole_and_negates_the_normals() {
    let mut two = mesh(&both(&cube(), &cube_at(DVec3::X * 5.0)));
    two.compute_normals(Default::default());
    let normals: Vec<_> = two.vertices().map(|v| two.normal(v).expect("carried")).collect();
    let faces: Vec<_> = two.faces().map(|f| two.face_normal(f)).collect();
    let first = two.faces().next().expect("one");
    two.reverse_component(first).expect("live");
    for (i, v) in two.vertices().enumerate() {
        let sign = if i < 8 { -1.0 } else { 1.0 };
        assert_eq!(two.normal(v), Some(normals[i] * sign));
    }
    two.reverse_component(first).expect("live");
    two.reverse();
    assert!(two.vertices().zip(&normals).all(|(v, n)| two.normal(v) == Some(-*n)));
    assert!(two.faces().zip(&faces).all(|(f, n)| two.face_normal(f) == -*n));
}
