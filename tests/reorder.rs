//! Laying a mesh out anew in memory: what stays and what follows.

mod corpus;
mod shapes;

use meshwright::glam::{DVec2, DVec3, dvec2, dvec3};
use meshwright::{
    Attributes, Boundary, ClosestOptions, EdgeKey, FaceGroups, FaceKey, FillHolesOptions, GroupName,
    HalfedgeKey, IndexedMesh, Mesh, Rule, Scheme, SmoothOptions, SubdivideOptions, UnweldOptions, VertexKey,
    WeldOptions,
};
use shapes::Noise;

/// Shapes whose order has nothing to do with space, open and closed, polygons and isolated vertices among them.
fn examples() -> Vec<(&'static str, IndexedMesh)> {
    let mut lonely = shapes::shuffled(&shapes::grid(4), 5).positions().to_vec();
    lonely.insert(3, dvec3(0.3, 9.0, -2.0));
    let polygons = shapes::pool(
        [(0., 0.), (1., 0.), (2., 0.5), (2., 2.), (0.5, 1.5), (3., 1.)]
            .map(|(x, y)| dvec3(x, y, 0.0))
            .to_vec(),
        vec![vec![3, 4, 0, 1, 2], vec![3, 2, 5]],
    );
    vec![
        ("cube", shapes::cube()),
        ("grid", shapes::shuffled(&shapes::grid(6), 1)),
        ("sphere", shapes::shuffled(&shapes::icosphere(2), 2)),
        ("two", shapes::both(&shapes::shuffled(&shapes::icosphere(1), 3), &shapes::grid(3))),
        ("polygons", polygons),
        ("points", shapes::pool(lonely, vec![vec![0, 1, 2]])),
    ]
}

fn near(mesh: &Mesh) -> Mesh {
    let near = mesh.reorder();
    assert_eq!(near.validate(), Ok(()));
    near
}

fn close(a: &IndexedMesh, b: &IndexedMesh) -> bool {
    a.polygons() == b.polygons()
        && a.positions().iter().zip(b.positions()).all(|(p, q)| p.distance(*q) < 1e-9)
}

#[test]
fn a_mesh_laid_out_anew_converts_back_to_the_same_pool() {
    for (name, pool) in examples() {
        let mesh = shapes::mesh(&pool);
        let near = near(&mesh);
        assert_eq!(near.to_indexed(), pool, "{name}");
        assert_eq!(near.reorder().to_indexed(), pool, "{name}, again");
    }
    assert_eq!(near(&Mesh::default()).vertex_count(), 0);
}

#[test]
fn neighbors_come_near_in_memory() {
    let pool = shapes::shuffled(&shapes::icosphere(4), 7);
    let gap = |mesh: &Mesh| {
        let place: std::collections::BTreeMap<VertexKey, i64> = mesh.vertices().zip(0..).collect();
        let gaps = mesh.vertices().flat_map(|v| mesh.neighbors(v).map(move |n| (v, n)));
        let gaps: Vec<i64> = gaps.map(|(a, b)| (place[&a] - place[&b]).abs()).collect();
        gaps.iter().sum::<i64>() / gaps.len() as i64
    };
    let mesh = shapes::mesh(&pool);
    assert!(gap(&near(&mesh)) * 8 < gap(&mesh), "{} against {}", gap(&near(&mesh)), gap(&mesh));
}

#[test]
fn keys_are_translated_by_the_numbering() {
    let mesh = shapes::mesh(&shapes::shuffled(&shapes::icosphere(2), 2));
    let near = near(&mesh);
    let (old, new) = (mesh.numbering(), near.numbering());
    for (&a, &b) in old.vertices.iter().zip(&new.vertices) {
        assert_eq!(mesh.position(a), near.position(b));
    }
    for (&a, &b) in old.faces.iter().zip(&new.faces) {
        let points = |m: &Mesh, f| m.face_vertices(f).map(|v| m.position(v)).collect::<Vec<_>>();
        assert_eq!(points(&mesh, a), points(&near, b));
    }
}

#[test]
fn columns_of_every_kind_come_along_under_their_keys() {
    for (name, pool) in examples() {
        let mut mesh = shapes::mesh(&pool);
        let v = mesh.add_vertex_column(DVec3::ZERO, Rule::keep());
        let c = mesh.add_corner_column(DVec3::ZERO, Rule::keep());
        let e = mesh.add_edge_column(DVec3::ZERO, Rule::keep());
        let f = mesh.add_face_column(DVec3::ZERO, Rule::keep());
        let middle = |m: &Mesh, e: EdgeKey| {
            let h = m.edge_halfedge(e);
            m.position(m.origin(h)) + m.position(m.target(h))
        };
        let of_face = |m: &Mesh, f: FaceKey| m.face_vertices(f).map(|v| m.position(v)).sum::<DVec3>();
        let corners =
            |m: &Mesh| -> Vec<HalfedgeKey> { m.faces().flat_map(|f| m.face_halfedges(f)).collect() };
        let of_corner = |m: &Mesh, h: HalfedgeKey| m.position(m.origin(h)) * 3.0 - m.position(m.target(h));
        for key in mesh.vertices().collect::<Vec<_>>() {
            mesh.set_value(v, key, mesh.position(key)).expect("live");
        }
        for key in corners(&mesh) {
            mesh.set_value(c, key, of_corner(&mesh, key)).expect("live");
        }
        for key in mesh.edges().collect::<Vec<_>>() {
            mesh.set_value(e, key, middle(&mesh, key)).expect("live");
        }
        for key in mesh.faces().collect::<Vec<_>>() {
            mesh.set_value(f, key, of_face(&mesh, key)).expect("live");
        }
        let near = near(&mesh);
        assert!(near.vertices().all(|k| *near.value(v, k) == near.position(k)), "{name}");
        assert!(corners(&near).into_iter().all(|k| *near.value(c, k) == of_corner(&near, k)), "{name}");
        assert!(near.edges().all(|k| *near.value(e, k) == middle(&near, k)), "{name}");
        assert!(near.faces().all(|k| near.value(f, k).distance(of_face(&near, k)) < 1e-12), "{name}");
        assert_eq!(near.export_column(c), mesh.export_column(c), "{name}");
    }
}

#[test]
fn attributes_come_along() {
    let pool = shapes::shuffled(&shapes::icosphere(1), 4);
    let (n, m) = (pool.vertex_count(), pool.face_count());
    let attributes = Attributes {
        vertex_colors: Some((0..n).map(|i| [i as f32, 0.0, 1.0, 1.0]).collect()),
        corner_uvs: Some(
            (0..3 * m).map(|i| (i % 5 != 0).then(|| dvec2(i as f64, 0.5))).collect::<Vec<Option<DVec2>>>(),
        ),
        face_groups: Some(FaceGroups {
            names: vec![GroupName::default(); 2],
            of: (0..m).map(|i| i as u32 % 2).collect(),
        }),
        material_files: vec!["a.mtl".into()],
        ..Attributes::default()
    };
    let pool = pool.with_attributes(attributes).expect("attributes");
    let mesh = shapes::mesh(&pool);
    assert_eq!(near(&mesh).to_indexed(), mesh.to_indexed());
}

#[test]
fn what_is_done_to_a_mesh_laid_out_anew_is_what_is_done_to_the_old_one() {
    for (name, pool) in examples() {
        let mesh = shapes::mesh(&pool);
        let near = near(&mesh);
        let both = [&mesh, &near];
        for scheme in [Scheme::Midpoint, Scheme::Loop, Scheme::CatmullClark, Scheme::Sqrt3] {
            let fine = both.map(|m| m.subdivide(SubdivideOptions { scheme, ..Default::default() }));
            let [Ok(a), Ok(b)] = fine else { continue };
            assert!(close(&a.value.to_indexed(), &b.value.to_indexed()), "{name}, {scheme:?}");
            assert_eq!(a.maps, b.maps, "{name}, {scheme:?}");
        }
        let [a, b] = both.map(|m| {
            let some: Vec<FaceKey> = m.numbering().faces.into_iter().step_by(3).collect();
            m.subdivide(SubdivideOptions { only: Some(&some), ..Default::default() }).expect("subdivided")
        });
        assert!(close(&a.value.to_indexed(), &b.value.to_indexed()), "{name}, some");
        assert_eq!(a.maps, b.maps, "{name}, some");
        let [a, b] =
            both.map(|m| m.weld(WeldOptions { tolerance: 0.3, ..Default::default() }).expect("welded"));
        assert_eq!(a.value.to_indexed(), b.value.to_indexed(), "{name}, weld");
        assert_eq!((a.maps, a.report), (b.maps, b.report), "{name}, weld");
        let [a, b] =
            both.map(|m| m.unweld(UnweldOptions { degrees: 20.0, ..Default::default() }).expect("parted"));
        assert!(close(&a.value.to_indexed(), &b.value.to_indexed()), "{name}, unweld");
        assert_eq!(a.maps, b.maps, "{name}, unweld");
        let [a, b] = both.map(|m| {
            let mut m = m.clone();
            m.smooth(SmoothOptions { boundary: Boundary::Free, ..Default::default() }).expect("smoothed");
            m.to_indexed()
        });
        assert!(close(&a, &b), "{name}, smooth");
        let [a, b] = both.map(|m| {
            let mut m = m.clone();
            let filled = m.fill_holes(FillHolesOptions::default()).expect("filled");
            assert_eq!(m.validate(), Ok(()));
            (filled.filled.len(), m.face_count())
        });
        assert_eq!(a, b, "{name}, holes");
    }
}

#[test]
fn polygons_are_cut_as_they_were() {
    // Diagonals of the same length, and neither in the surface: the cut goes from the lowest vertex.
    let corners = [(1.0, 0.0, 1.0), (0.0, 0.0, 0.0), (0.0, 1.0, 1.0), (1.0, 1.0, 0.0)];
    let pool = shapes::pool(corners.map(|(x, y, z)| dvec3(x, y, z)).to_vec(), vec![vec![0, 1, 2, 3]]);
    let mesh = shapes::mesh(&pool);
    let near = near(&mesh);
    let asked = dvec3(0.5, 0.5, 0.4);
    let distance = |m: &Mesh| {
        let found = m.index().closest_point(asked, ClosestOptions::default()).expect("asked well");
        found.expect("a face").distance
    };
    assert_eq!(distance(&mesh), distance(&near));
    let [a, b] = [&mesh, &near].map(|m| {
        let mut m = m.clone();
        let f = m.faces().next().expect("one");
        m.triangulate_face(f).expect("four corners");
        m.to_indexed()
    });
    assert_eq!(a, b);
}

#[test]
fn edits_go_on_after_it_and_the_order_of_what_survives_stays() {
    let pool = shapes::shuffled(&shapes::icosphere(3), 11);
    let mesh = shapes::mesh(&pool);
    let mut both = [mesh.clone(), near(&mesh)];
    let mut noise = Noise(4);
    let numbers = both.each_ref().map(|m| m.numbering());
    for _ in 0..300 {
        let at = (noise.unit() * pool.face_count() as f64) as usize;
        let side = (noise.unit() * 3.0) as usize;
        let done = [0, 1].map(|i| {
            let m = &mut both[i];
            let f = numbers[i].faces[at];
            let h = m.contains_face(f).then(|| m.face_halfedges(f).nth(side))??;
            let to = m.position(m.target(h));
            Some(m.collapse(h, to).is_ok())
        });
        assert_eq!(done[0], done[1]);
    }
    let [a, b] = both.map(|m| {
        assert_eq!(m.validate(), Ok(()));
        m.to_indexed()
    });
    assert_eq!(a, b);
    assert!(a.face_count() < pool.face_count() - 100);
}

#[test]
fn models_of_the_corpus_come_back_unchanged() {
    let Some(rows) = corpus::rows() else { return };
    let mut seen = 0;
    for row in rows.iter().filter(|r| r.is_readable()) {
        let Ok(soup) = row.load() else { continue };
        let Ok(pool) = IndexedMesh::try_from(soup) else { continue };
        if let Some(mesh) = Mesh::build(&pool).ok().filter(|m| m.face_count() <= 30_000) {
            let near = mesh.reorder();
            assert_eq!(near.validate(), Ok(()), "{}", row.path);
            assert_eq!(near.to_indexed(), mesh.to_indexed(), "{}", row.path);
            seen += 1;
        }
    }
    assert!(seen > 50, "{seen}");
}
