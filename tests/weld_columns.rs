//! What weld and unweld do with user columns.

mod shapes;

use meshwright::glam::{DVec3, dvec3};
use meshwright::{
    Column, EdgeKey, Event, FaceKey, HalfedgeKey, IndexedMesh, Kind, Mesh, Outcome, Rule, UnweldOptions,
    VertexKey, WeldOptions,
};
use shapes::Noise;

fn weld(mesh: &Mesh, tolerance: f64) -> Outcome<Mesh> {
    let outcome = mesh.weld(WeldOptions { tolerance, ..Default::default() }).expect("always answers");
    assert_eq!(outcome.value.validate(), Ok(()));
    outcome
}

fn unweld(mesh: &Mesh, degrees: f64) -> Outcome<Mesh> {
    let outcome = mesh.unweld(UnweldOptions { degrees, ..Default::default() }).expect("unwelded");
    assert_eq!(outcome.value.validate(), Ok(()));
    outcome
}

fn corners(mesh: &Mesh) -> Vec<HalfedgeKey> {
    mesh.faces().flat_map(|f| mesh.face_halfedges(f)).collect()
}

/// Two triangles of a square, apart.
fn two_triangles() -> Mesh {
    let points =
        vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X, dvec3(1., 1., 0.), dvec3(0., 1.05, 0.), DVec3::Z];
    shapes::mesh(&shapes::pool(points, vec![vec![0, 1, 2], vec![3, 4, 5]]))
}

/// The value of what a rule makes of a merge: sources and weights, in digits.
fn told() -> Rule<f64> {
    Rule::custom(|event, sources: &[(&f64, f64)]| {
        let digit = |n: f64, (v, w): &(&f64, f64)| n * 100.0 + **v * 10.0 + w;
        sources.iter().fold(if event == Event::Merge { 7.0 } else { 8.0 }, digit)
    })
}

#[test]
fn a_vertex_that_merged_another_counts_once_and_the_other_not() {
    let mut mesh = two_triangles();
    let rules = [Rule::keep(), Rule::reset(), Rule::interpolate(), Rule::average(), told()];
    let columns = rules.map(|rule| mesh.add_vertex_column(-1.0, rule));
    for (i, v) in mesh.vertices().enumerate().collect::<Vec<_>>() {
        for &c in &columns {
            mesh.set_value(c, v, i as f64).expect("live");
        }
    }
    let welded = weld(&mesh, 0.1).value;
    let values: Vec<[f64; 5]> = welded.vertices().map(|v| columns.map(|c| *welded.value(c, v))).collect();
    assert_eq!(
        values,
        [
            [0.0; 5],
            // 1 took in 3, and 2 took in 5.
            [1.0, -1.0, 1.0, 2.0, 71130.0],
            [2.0, -1.0, 2.0, 3.5, 72150.0],
            [4.0; 5],
            [6.0; 5],
        ]
    );
}

#[test]
fn corners_and_faces_keep_what_they_have_and_edges_that_become_one_count_alike() {
    let mut mesh = two_triangles();
    let chart = mesh.add_corner_column(0, Rule::reset());
    let part = mesh.add_face_column(0, Rule::reset());
    let length = [Rule::keep(), Rule::interpolate()].map(|rule| mesh.add_edge_column(0.0, rule));
    for (i, f) in mesh.faces().enumerate().collect::<Vec<_>>() {
        mesh.set_value(part, f, i + 1).expect("live");
        for h in mesh.face_halfedges(f).collect::<Vec<_>>() {
            mesh.set_value(chart, h, i + 1).expect("live");
            for &c in &length {
                mesh.set_value(c, mesh.edge(h), i as f64).expect("live");
            }
        }
    }
    let welded = weld(&mesh, 0.1).value;
    for (i, f) in welded.faces().enumerate() {
        assert_eq!(*welded.value(part, f), i + 1);
        assert!(welded.face_halfedges(f).all(|h| *welded.value(chart, h) == i + 1));
    }
    let seams: Vec<EdgeKey> = welded.edges().filter(|&e| welded.is_seam(chart, e)).collect();
    let [seam] = seams[..] else { panic!("the edge between them") };
    assert_eq!(length.map(|c| *welded.value(c, seam)), [0.0, 0.5]);
    let of_second = welded.edges().filter(|&e| *welded.value(length[0], e) == 1.0).count();
    assert_eq!(of_second, 2);
}

struct Names {
    vertex: Column<VertexKey, usize>,
    corner: Column<HalfedgeKey, [usize; 2]>,
    edge: Column<EdgeKey, [usize; 2]>,
    face: Column<FaceKey, usize>,
}

/// Everything by its number in the indexed form: corners and edges by their vertices'.
fn named(mesh: &mut Mesh) -> Names {
    let names = Names {
        vertex: mesh.add_vertex_column(usize::MAX, Rule::keep()),
        corner: mesh.add_corner_column([usize::MAX; 2], Rule::keep()),
        edge: mesh.add_edge_column([usize::MAX; 2], Rule::keep()),
        face: mesh.add_face_column(usize::MAX, Rule::keep()),
    };
    let vertices: Vec<VertexKey> = mesh.vertices().collect();
    for (i, &v) in vertices.iter().enumerate() {
        mesh.set_value(names.vertex, v, i).expect("live");
    }
    for (i, f) in mesh.faces().enumerate().collect::<Vec<_>>() {
        mesh.set_value(names.face, f, i).expect("live");
        for h in mesh.face_halfedges(f).collect::<Vec<_>>() {
            let [a, b] = [mesh.origin(h), mesh.target(h)].map(|v| *mesh.value(names.vertex, v));
            mesh.set_value(names.corner, h, [i, a]).expect("live");
            mesh.set_value(names.edge, mesh.edge(h), [a, b]).expect("live");
        }
    }
    names
}

/// Whether what the columns say is what the maps say.
fn assert_follow(name: &str, outcome: &Outcome<Mesh>, names: &Names) {
    let Outcome { value: mesh, maps, .. } = outcome;
    // The middle of a parted edge may have been merged with a vertex since.
    let is_parted = outcome.report.count(Kind::ParallelEdge) > 0;
    let number = |v: VertexKey| mesh.vertices().position(|w| w == v).expect("there");
    for (i, v) in mesh.vertices().enumerate() {
        let olds = maps.vertices.old_of(i);
        if let Some(&first) = olds.first() {
            assert_eq!(*mesh.value(names.vertex, v), first as usize, "{name}");
        }
    }
    for (i, f) in mesh.faces().enumerate() {
        assert_eq!(maps.faces.old_of(i), [*mesh.value(names.face, f) as u32], "{name}");
        for h in mesh.face_halfedges(f) {
            let olds = maps.vertices.old_of(number(mesh.origin(h)));
            let [face, vertex] = *mesh.value(names.corner, h);
            if !olds.is_empty() {
                assert_eq!(face, *mesh.value(names.face, f), "{name}");
                assert!(is_parted || olds.contains(&(vertex as u32)), "{name}: {vertex} in {olds:?}");
            }
            let edge = *mesh.value(names.edge, mesh.edge(h));
            let ends = [mesh.origin(h), mesh.target(h)].map(number);
            if edge[0] != usize::MAX && ends.iter().all(|&v| !maps.vertices.old_of(v).is_empty()) {
                let is_there = |v: &usize| {
                    let new = maps.vertices.new_of(*v);
                    ends.iter().any(|&e| new.contains(&(e as u32)))
                };
                let there = edge.iter().filter(|v| is_there(v)).count();
                assert!(there == 2 || there == 1 && is_parted, "{name}: {edge:?} at {ends:?}");
            }
        }
    }
}

#[test]
fn values_go_where_the_maps_say_whatever_the_weld_does() {
    let apart = |pool: &IndexedMesh| {
        shapes::mesh(&IndexedMesh::try_from(shapes::unwelded(pool)).expect("a valid vertex pool"))
    };
    for (name, pool) in [
        ("cube", shapes::fanned(&shapes::cube())),
        ("quads", shapes::cube()),
        ("torus", shapes::torus(5, 4)),
        ("two", shapes::both(&shapes::cube(), &shapes::grid(2))),
    ] {
        let mut mesh = apart(&pool);
        let names = named(&mut mesh);
        let outcome = weld(&mesh, 0.0);
        assert_eq!(outcome.value.to_indexed().vertex_count(), pool.vertex_count());
        assert_follow(name, &outcome, &names);
        assert!(
            outcome.value.edges().all(|e| outcome.value.value(names.edge, e)[0] != usize::MAX),
            "{name}: every edge was one"
        );
    }
    // Random triangles in a small box, of which the weld folds, doubles, crosses and flips many.
    for seed in 0..60 {
        let mut noise = Noise(seed);
        let mut point = || dvec3(noise.unit(), noise.unit(), noise.unit() * 0.5);
        let points: Vec<DVec3> = (0..90).map(|_| point()).collect();
        let faces = (0..18).map(|i| (5 * i..5 * i + 3 + i % 3).collect()).collect();
        let mut mesh = shapes::mesh(&shapes::pool(points, faces));
        let names = named(&mut mesh);
        for tolerance in [0.1, 0.3, 0.5] {
            assert_follow(&format!("seed {seed}, {tolerance}"), &weld(&mesh, tolerance), &names);
        }
    }
}

#[test]
fn a_face_that_a_weld_cuts_is_split() {
    // An hourglass of eight corners whose waist is welded: two faces.
    let points = [(0., 0.), (1., 0.9), (2., 0.), (2., 2.), (1., 1.1), (0., 2.)];
    let points = points.iter().map(|&(x, y)| dvec3(x, y, 0.)).collect();
    let mut mesh = shapes::mesh(&shapes::pool(points, vec![vec![0, 1, 2, 3, 4, 5]]));
    let kept = mesh.add_face_column(0, Rule::keep());
    let reset = mesh.add_face_column(0, Rule::reset());
    let f = mesh.faces().next().expect("there");
    mesh.set_value(kept, f, 5).expect("live");
    mesh.set_value(reset, f, 5).expect("live");
    let names = named(&mut mesh);
    let outcome = weld(&mesh, 0.5);
    assert!(outcome.value.face_count() > 1);
    for f in outcome.value.faces() {
        assert_eq!((*outcome.value.value(kept, f), *outcome.value.value(reset, f)), (5, 0));
    }
    assert_follow("hourglass", &outcome, &names);
}

#[test]
fn what_an_unweld_adds_was_split_and_all_else_keeps_its_values() {
    let mut mesh = shapes::mesh(&shapes::cube());
    let names = named(&mut mesh);
    let mixed = mesh.add_vertex_column(-1.0, Rule::interpolate());
    let reset = mesh.add_vertex_column(-1.0, Rule::reset());
    let edge_reset = mesh.add_edge_column(0, Rule::reset());
    for (i, v) in mesh.vertices().enumerate().collect::<Vec<_>>() {
        mesh.set_value(mixed, v, i as f64).expect("live");
        mesh.set_value(reset, v, i as f64).expect("live");
    }
    for e in mesh.edges().collect::<Vec<_>>() {
        mesh.set_value(edge_reset, e, 1).expect("live");
    }
    let outcome = unweld(&mesh, 30.0);
    assert_follow("cube", &outcome, &names);
    let parted = &outcome.value;
    for (i, v) in parted.vertices().enumerate() {
        let old = f64::from(outcome.maps.vertices.old_of(i)[0]);
        assert_eq!(*parted.value(mixed, v), old);
        assert_eq!(*parted.value(reset, v), if i < 8 { old } else { -1.0 });
    }
    let kept = parted.edges().filter(|&e| *parted.value(edge_reset, e) == 1).count();
    assert_eq!((parted.edge_count(), kept), (24, 12));
    // And welding gives all of it back.
    let again = weld(parted, 0.0).value;
    for (v, old) in again.vertices().zip(mesh.vertices()) {
        assert_eq!(again.value(names.vertex, v), mesh.value(names.vertex, old));
        assert_eq!(again.value(mixed, v), mesh.value(mixed, old));
    }
    for (h, old) in corners(&again).into_iter().zip(corners(&mesh)) {
        assert_eq!(again.value(names.corner, h), mesh.value(names.corner, old));
    }
}

#[test]
fn attributes_and_columns_come_along_together_and_removed_keys_stay_dead() {
    let mut mesh = shapes::mesh(&shapes::cube());
    mesh.compute_normals(Default::default());
    let gone = mesh.add_vertex_column(DVec3::ZERO, Rule::keep());
    let heat = mesh.add_vertex_column(1.5, Rule::keep());
    mesh.remove_column(gone);
    let normals: Vec<_> = mesh.vertices().map(|v| mesh.normal(v)).collect();
    for outcome in [unweld(&mesh, 180.0), weld(&mesh, 0.1)] {
        let mut same = outcome.value;
        assert!(!same.has_column(gone) && same.vertices().all(|v| *same.value(heat, v) == 1.5));
        assert!(same.vertices().map(|v| same.normal(v)).eq(normals.iter().copied()));
        assert!(same.drop_attribute(meshwright::Attribute::VertexNormals));
        assert!(same.has_column(heat));
        assert_eq!(same.validate(), Ok(()));
    }
}
