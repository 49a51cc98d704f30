//! The rungs of the ladder: what each refuses, beside naive twins, and what comes back.

mod shapes;

use meshwright::glam::{DVec3, dvec3};
use meshwright::{
    BuildDefect, FaceKey, IndexedDefect, IndexedMesh, Mesh, NormalWeight, NotClosed, PolygonSoup, Polygons,
    SetAttributeError, SetError, VertexKey, unify_winding,
};
use proptest::prelude::*;
use shapes::{cube, mesh, torus};
use std::collections::{BTreeMap, BTreeSet};

/// For every edge its uses in order: the face, and whether it runs from the lower to the higher vertex.
fn naive_edges(polygons: &Polygons) -> BTreeMap<[u32; 2], Vec<(u32, bool)>> {
    let mut edges = BTreeMap::<_, Vec<_>>::new();
    for (f, face) in polygons.iter().enumerate() {
        for (i, &a) in face.iter().enumerate() {
            let b = face[(i + 1) % face.len()];
            edges.entry([a.min(b), a.max(b)]).or_default().push((f as u32, a < b));
        }
    }
    edges
}

/// The number of fans at a vertex: its faces, joined while any two share an edge there.
fn naive_fans(polygons: &Polygons, v: u32) -> usize {
    let edges_at = |f: &[u32]| -> Vec<u32> {
        let i = f.iter().position(|&u| u == v).expect("a face of the vertex");
        vec![f[(i + 1) % f.len()], f[(i + f.len() - 1) % f.len()]]
    };
    let mut fans: Vec<BTreeSet<u32>> = Vec::new();
    for face in polygons.iter().filter(|f| f.contains(&v)) {
        let mut joined: BTreeSet<u32> = edges_at(face).into_iter().collect();
        fans.retain(|fan| {
            let apart = fan.is_disjoint(&joined);
            if !apart {
                joined.extend(fan);
            }
            apart
        });
        fans.push(joined);
    }
    fans.len()
}

/// All turns of a cycle, both ways.
fn same_cycle(a: &[u32], b: &[u32]) -> bool {
    let n = b.len();
    a.len() == n
        && (0..n)
            .any(|k| (0..n).all(|i| a[i] == b[(k + i) % n]) || (0..n).all(|i| a[i] == b[(k + n - i) % n]))
}

fn naive_defects(pool: &IndexedMesh) -> Vec<BuildDefect> {
    let polygons = pool.polygons();
    let edges = naive_edges(polygons);
    let mut defects = Vec::new();
    for (&edge, uses) in edges.iter().filter(|(_, uses)| uses.len() > 2) {
        defects.push(BuildDefect::NonManifoldEdge { edge, faces: uses.iter().map(|u| u.0).collect() });
    }
    for (&edge, uses) in edges.iter().filter(|(_, uses)| uses.len() == 2 && uses[0].1 == uses[1].1) {
        defects.push(BuildDefect::ConflictingEdge { edge, faces: [uses[0].0, uses[1].0] });
    }
    for vertex in 0..pool.vertex_count() as u32 {
        let fans = naive_fans(polygons, vertex) as u32;
        if fans > 1 {
            defects.push(BuildDefect::PinchedVertex { vertex, fans });
        }
    }
    for (face, corners) in polygons.iter().enumerate() {
        if let Some(original) = (0..face).find(|&g| same_cycle(&polygons[g], corners)) {
            defects.push(BuildDefect::DuplicateFace { face: face as u32, original: original as u32 });
        }
    }
    defects
}

fn sorted(mut defects: Vec<BuildDefect>) -> Vec<String> {
    defects.sort_by_key(|d| format!("{d:?}"));
    defects.iter().map(|d| format!("{d:?}")).collect()
}

fn pools(faces: std::ops::Range<usize>) -> impl Strategy<Value = IndexedMesh> {
    (4u32..9, prop::collection::vec((prop::collection::vec(0u32..9, 3..6), any::<bool>()), faces)).prop_map(
        |(n, faces)| {
            let points = (0..n).map(|i| dvec3(f64::from(i), f64::from(i * i), f64::from(i % 3))).collect();
            let distinct = |(face, reversed): (Vec<u32>, bool)| {
                let mut seen = BTreeSet::new();
                let mut face: Vec<u32> =
                    face.into_iter().map(|v| v % n).filter(|&v| seen.insert(v)).collect();
                if reversed {
                    face.reverse();
                }
                face
            };
            let faces: Polygons = faces.into_iter().map(distinct).filter(|f| f.len() >= 3).collect();
            IndexedMesh::new(points, faces).expect("a valid vertex pool")
        },
    )
}

/// Whether some choice of reversals makes all two-face edges agree: all of them are tried.
fn naive_orientable(polygons: &Polygons) -> bool {
    let edges = naive_edges(polygons);
    let pairs: Vec<_> = edges.values().filter(|u| u.len() == 2).collect();
    (0u32..1 << polygons.len()).any(|flips| {
        let up = |(f, up): (u32, bool)| up ^ (flips >> f & 1 == 1);
        pairs.iter().all(|u| up(u[0]) != up(u[1]))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8_000))]

    #[test]
    fn refusals_to_build_are_exact(pool in pools(0..10)) {
        let expected = sorted(naive_defects(&pool));
        match Mesh::build(&pool) {
            Ok(mesh) => {
                prop_assert!(expected.is_empty(), "{expected:?}");
                prop_assert_eq!(mesh.violations(), []);
                prop_assert_eq!(mesh.to_indexed(), pool);
            }
            Err(error) => prop_assert_eq!(sorted(error.defects), expected),
        }
    }

    #[test]
    fn topology_facts_equal_their_definitions(pool in pools(0..9)) {
        let (polygons, topology) = (pool.polygons(), pool.topology());
        let edges = naive_edges(polygons);
        let of_degree = |ok: fn(usize) -> bool| {
            edges.iter().filter(|(_, u)| ok(u.len())).map(|(e, _)| *e).collect::<BTreeSet<_>>()
        };
        prop_assert_eq!(topology.edge_count(), edges.len());
        prop_assert_eq!(topology.boundary_edges().map(|e| e.vertices()).collect::<BTreeSet<_>>(), of_degree(|n| n == 1));
        prop_assert_eq!(topology.nonmanifold_edges().map(|e| e.vertices()).collect::<BTreeSet<_>>(), of_degree(|n| n > 2));
        prop_assert_eq!(topology.is_closed(), !edges.is_empty() && edges.values().all(|u| u.len() == 2));
        prop_assert_eq!(topology.orientable().is_ok(), naive_orientable(polygons));

        // Components, by spreading the lowest label until nothing changes.
        let mut labels: Vec<usize> = (0..polygons.len()).collect();
        for _ in 0..polygons.len() {
            for uses in edges.values() {
                let low = uses.iter().map(|u| labels[u.0 as usize]).min().expect("a use");
                uses.iter().for_each(|u| labels[u.0 as usize] = low);
            }
        }
        let (ours, count) = topology.components();
        prop_assert_eq!(count, labels.iter().collect::<BTreeSet<_>>().len());
        for f in 0..labels.len() {
            for g in 0..f {
                prop_assert_eq!(ours[f] == ours[g], labels[f] == labels[g]);
            }
        }

        // Every naked edge is in one loop or chain, and neighbours in it share a vertex.
        let naked = topology.naked_edges();
        let mut strung = Vec::new();
        for l in &naked.loops {
            strung.extend((0..l.len()).map(|i| [l[i], l[(i + 1) % l.len()]]));
        }
        for c in &naked.chains {
            strung.extend(c.windows(2).map(|w| [w[0], w[1]]));
        }
        let mut strung: Vec<[u32; 2]> = strung.into_iter().map(|[a, b]| [a.min(b), a.max(b)]).collect();
        strung.sort_unstable();
        prop_assert_eq!(strung, of_degree(|n| n == 1).into_iter().collect::<Vec<_>>());
    }

    #[test]
    fn unify_agrees_everywhere_or_shows_a_cycle_that_cannot(pool in pools(0..10)) {
        let topology = pool.topology();
        match unify_winding(&topology) {
            Ok(unified) => {
                prop_assert!(unified.value.topology().is_oriented());
                // Faces are reversed or left alone, and the first corner stays.
                for (f, (old, new)) in pool.polygons().iter().zip(unified.value.polygons().iter()).enumerate() {
                    let recorded = unified.report.records.iter().any(|r| r.element == meshwright::Element::Face(f as u32));
                    prop_assert_eq!(old != new, recorded);
                    prop_assert_eq!(old[0], new[0]);
                    prop_assert!(same_cycle(old, new));
                }
                let again = unify_winding(&unified.value.topology()).expect("agrees already");
                prop_assert!(again.report.records.is_empty());
            }
            Err(error) => {
                prop_assert!(!naive_orientable(pool.polygons()));
                for cycle in error.cycles {
                    let faces: Polygons = cycle.iter().map(|&f| pool.polygons()[f as usize].to_vec()).collect();
                    prop_assert!(cycle.len() > 1, "{cycle:?}");
                    // Going round, the winding comes back reversed: an odd number of conflicts.
                    let edges = naive_edges(pool.polygons());
                    let conflicts = (0..cycle.len()).map(|i| {
                        let (f, g) = (cycle[i], cycle[(i + 1) % cycle.len()]);
                        let shared: Vec<_> = edges
                            .values()
                            .filter(|u| u.len() == 2 && u.iter().any(|x| x.0 == f) && u.iter().any(|x| x.0 == g))
                            .collect();
                        prop_assert!(!shared.is_empty(), "{f} and {g} share a two-face edge");
                        Ok(shared.iter().map(|u| u[0].1 == u[1].1).collect::<BTreeSet<_>>())
                    }).collect::<Result<Vec<_>, _>>()?;
                    let odd = conflicts.iter().filter(|c| c.contains(&true)).count() % 2 == 1;
                    prop_assert!(odd || conflicts.iter().any(|c| c.len() == 2), "{faces:?}");
                }
            }
        }
    }
}

#[test]
fn a_vertex_pool_lists_every_defect_with_its_elements() {
    let points = vec![DVec3::ZERO, DVec3::X, dvec3(f64::NAN, 0., 0.), DVec3::Y];
    let faces = vec![vec![0, 1], vec![0, 1, 9], vec![0, 1, 3, 1], vec![0, 1, 3], vec![]];
    let refused = IndexedMesh::new(points, faces.into()).expect_err("invalid");
    assert_eq!(
        refused.defects,
        [
            IndexedDefect::NonFinitePosition { vertex: 2 },
            IndexedDefect::TooFewCorners { face: 0, corners: 2 },
            IndexedDefect::IndexOutOfRange { face: 1, corner: 2, index: 9 },
            IndexedDefect::RepeatedCorner { face: 2, corner: 3, vertex: 1 },
            IndexedDefect::TooFewCorners { face: 4, corners: 0 },
        ]
    );
    assert_eq!(
        refused.to_string(),
        "not a valid vertex pool: vertex 2 is not finite, face 0 has 2 corners, corner 2 of face 1 names vertex 9, \
         which does not exist and 2 more"
    );
}

#[test]
fn given_normals_must_be_one_finite_normal_for_each_vertex() {
    let pool = shapes::tetrahedron();
    let refused = pool.clone().with_normals(vec![DVec3::Z; 3]).expect_err("one is missing");
    assert_eq!(refused.defects, [IndexedDefect::NormalCount { normals: 3, vertices: 4 }]);
    let refused = pool.with_normals(vec![DVec3::Z, DVec3::NAN, DVec3::Z, DVec3::Z]).expect_err("one is NaN");
    assert_eq!(refused.defects, [IndexedDefect::NonFiniteNormal { vertex: 1 }]);
}

#[test]
fn given_normals_come_back_from_the_mesh() {
    let pool = cube();
    let normals: Vec<DVec3> = pool.positions().iter().map(|p| *p - 0.5).collect();
    let pool = pool.with_normals(normals).expect("finite");
    assert_eq!(mesh(&pool).to_indexed(), pool);
    let mut flipped = mesh(&pool);
    flipped.reverse();
    assert_eq!(flipped.to_indexed(), pool.clone().reversed());
    assert_eq!(flipped.to_indexed().normals().expect("carried")[0], DVec3::splat(0.5));
}

#[test]
fn isolated_vertices_are_legal_and_keep_their_place() {
    let mut points = cube().positions().to_vec();
    points.insert(3, DVec3::splat(9.0));
    let faces: Polygons = cube()
        .polygons()
        .iter()
        .map(|f| f.iter().map(|&v| v + u32::from(v >= 3)).collect::<Vec<_>>())
        .collect();
    let pool = IndexedMesh::new(points, faces).expect("valid");
    let mesh = mesh(&pool);
    let v = mesh.vertices().nth(3).expect("nine vertices");
    assert!(mesh.is_isolated(v) && !mesh.is_boundary_vertex(v));
    assert_eq!((mesh.valence(v), mesh.vertex_halfedge(v)), (0, None));
    assert_eq!(mesh.to_indexed(), pool);
}

#[test]
fn the_empty_mesh_is_a_mesh_and_is_not_closed() {
    let empty = mesh(&IndexedMesh::default());
    assert_eq!(empty.closed().expect_err("no faces"), NotClosed::Empty);
    assert_eq!(empty.validate(), Ok(()));
    assert_eq!(empty.to_indexed(), IndexedMesh::default());
    assert!(!IndexedMesh::default().topology().is_closed());
    assert_eq!(Mesh::default().to_indexed(), IndexedMesh::default());
}

#[test]
fn an_open_mesh_is_refused_with_its_boundary() {
    let mut faces = cube().polygons().iter().map(<[u32]>::to_vec).collect::<Vec<_>>();
    faces.pop();
    let open = mesh(&shapes::pool(cube().positions().to_vec(), faces));
    let NotClosed::Open { boundary } = open.closed().expect_err("open") else { panic!("not empty") };
    assert_eq!(boundary.len(), 4);
    assert!(boundary.iter().all(|&h| open.is_boundary(h)));
    assert!(!open.is_closed() && mesh(&cube()).is_closed());
}

fn volume(pool: &IndexedMesh) -> f64 {
    mesh(pool).closed().expect("closed").volume()
}

#[test]
fn volume_is_exact_far_from_the_origin() {
    for offset in [0.0, 1e5, 1e6, -3e7] {
        let far = shapes::cube_at(DVec3::splat(offset));
        assert_eq!(volume(&far), 1.0, "offset {offset}");
        assert_eq!(volume(&shapes::fanned(&far)), 1.0, "offset {offset}, in triangles");
    }
}

#[test]
fn volume_is_that_of_any_size() {
    for scale in [1e-90, 1e-30, 1e30, 1e90] {
        let mut scaled = cube();
        scaled.map_positions(|p| p * scale).expect("finite");
        assert!((volume(&scaled) / scale / scale / scale - 1.0).abs() < 1e-12, "scale {scale}");
        let centroid = mesh(&scaled).closed().expect("closed").centroid().expect("a volume");
        assert!((centroid / scale).distance(DVec3::splat(0.5)) < 1e-12);
    }
}

#[test]
fn a_cavity_subtracts() {
    let mut outer = cube();
    outer.map_positions(|p| p * 3.0).expect("finite");
    let inner = shapes::cube_at(DVec3::ONE).reversed();
    assert_eq!(volume(&shapes::both(&outer, &inner)), 26.0);
}

#[test]
fn reversal_negates_the_volume_of_polygons_that_are_not_flat() {
    let mut wavy = torus(9, 7);
    wavy.map_positions(|p| p + DVec3::Z * (5.0 * p.x).sin() * 0.3).expect("finite");
    let there = volume(&wavy);
    let back = volume(&wavy.clone().reversed());
    assert!((there + back).abs() <= 1e-15 * there.abs() * 64.0, "{there} {back}");
    let solid = mesh(&wavy);
    assert_eq!(solid.closed().expect("closed").area(), wavy.area());
}

#[test]
fn genus_is_that_of_the_shape() {
    assert_eq!(cube().topology().genus(), Some(0));
    assert_eq!(torus(8, 5).topology().genus(), Some(1));
    assert_eq!(shapes::both(&cube(), &torus(8, 5)).topology().genus(), None, "two components");
    assert_eq!(shapes::grid(3).topology().genus(), None, "open");
    assert_eq!(mesh(&torus(8, 5)).euler_characteristic(), 0);
}

#[test]
fn a_moebius_strip_is_refused_with_a_walk_around_it() {
    let strip = shapes::moebius(11);
    let error = unify_winding(&strip.topology()).expect_err("not orientable");
    assert_eq!(error.cycles.len(), 1);
    assert_eq!(error.cycles[0].len(), 11);
    assert_eq!(error.to_string(), "not orientable: a cycle of 11 faces from face 5");
}

#[test]
fn unify_keeps_the_winding_of_the_largest_consistent_piece() {
    let sphere = shapes::icosphere(3);
    let mixed = shapes::some_reversed(&sphere, 4, 2);
    assert_eq!(
        unify_winding(&mixed.topology()).expect("orientable").value.polygons().len(),
        sphere.polygons().len()
    );
    let unified = unify_winding(&mixed.topology()).expect("orientable").value;
    assert!(unified.topology().volume().expect("closed") > 0.0, "three quarters were right");
    // Most of them reversed: then those stay.
    let reversed = mixed.reversed();
    assert!(
        unify_winding(&reversed.topology()).expect("orientable").value.topology().volume().expect("closed")
            < 0.0
    );
}

#[test]
fn naked_edges_of_a_bow_tie_are_two_loops() {
    let naked = shapes::bow_tie().topology().naked_edges();
    assert_eq!((naked.loops.len(), naked.chains.len()), (2, 0));
    assert_eq!(shapes::bow_tie().topology().boundary_pieces(), 1);
    // A loop runs against its face.
    assert_eq!(naked.loops[0], [1, 0, 2]);
}

#[test]
fn naked_edges_end_at_edges_with_three_faces() {
    let naked = shapes::fins().topology().naked_edges();
    assert_eq!((naked.loops.len(), naked.chains.len()), (0, 3));
    assert!(naked.chains.iter().all(|c| c.len() == 3 && [c[0].min(c[2]), c[0].max(c[2])] == [0, 1]));
}

#[test]
fn positions_are_set_only_if_finite_and_live() {
    let mut mesh = mesh(&cube());
    let v = mesh.vertices().next().expect("a vertex");
    assert_eq!(mesh.set_position(v, DVec3::NAN), Err(SetError::NonFinite(v)));
    assert_eq!(mesh.position(v), DVec3::ZERO);
    assert_eq!(mesh.set_position(v, DVec3::NEG_ONE), Ok(()));
    assert_eq!(mesh.position(v), DVec3::NEG_ONE);
    let dead = VertexKey::default();
    assert_eq!(mesh.set_position(dead, DVec3::ONE), Err(SetError::Missing(dead)));
    assert_eq!(mesh.set_normal(v, DVec3::INFINITY), Err(SetAttributeError::NonFinite));
    assert_eq!(mesh.normal(v), None);
    assert_eq!(mesh.set_normal(v, DVec3::Z), Ok(()));
    assert_eq!(mesh.normal(v), Some(DVec3::Z));
    let mut pool = cube();
    let error = pool.map_positions(|p| if p == DVec3::ONE { DVec3::NAN } else { p * 2.0 }).expect_err("NaN");
    assert_eq!(error.defects, [IndexedDefect::NonFinitePosition { vertex: 7 }]);
    assert_eq!(pool, cube());
}

#[test]
fn normals_of_the_mesh_are_those_of_the_pool_for_polygons_too() {
    let pool = torus(11, 6);
    let mut mesh = mesh(&pool);
    for weight in [NormalWeight::Area, NormalWeight::Angle] {
        mesh.compute_normals(weight);
        for (v, expected) in mesh.vertices().zip(pool.vertex_normals(weight)) {
            assert!(mesh.vertex_normal(v, weight).expect("live").distance(expected) < 1e-14);
            assert_eq!(mesh.normal(v), Some(expected));
        }
    }
    assert_eq!(mesh.vertex_normal(VertexKey::default(), NormalWeight::Area), None);
    assert_eq!(mesh.get_face_normal(FaceKey::default()), None);
}

#[test]
fn normals_by_angle_do_not_depend_on_how_faces_are_cut() {
    let (quads, triangles) = (cube(), shapes::fanned(&cube()));
    let by_angle = |p: &IndexedMesh| p.vertex_normals(NormalWeight::Angle);
    for (a, b) in by_angle(&quads).into_iter().zip(by_angle(&triangles)) {
        assert!(a.distance(b) < 1e-15 && (a.length() - 1.0).abs() < 1e-15);
    }
    // Tiny and huge meshes have normals too.
    for scale in [1e-180, 1e150] {
        let mut scaled = cube();
        scaled.map_positions(|p| p * scale).expect("finite");
        for (a, b) in by_angle(&quads).into_iter().zip(by_angle(&scaled)) {
            assert!(a.distance(b) < 1e-12, "scale {scale}");
        }
    }
}

#[test]
fn a_soup_becomes_a_pool_or_is_refused() {
    let mut soup: PolygonSoup = cube().into();
    assert_eq!(IndexedMesh::try_from(soup.clone()), Ok(cube()));
    soup.polygons.push([0, 1, PolygonSoup::NO_VERTEX]);
    assert!(IndexedMesh::try_from(soup).is_err());
}

#[test]
fn a_hub_of_many_faces_takes_no_quadratic_time() {
    // A fan of 300,000 triangles around one vertex: the chain at the hub would take minutes.
    let n = 300_000u32;
    let rim = (0..n).map(|i| (f64::from(i) / f64::from(n) * std::f64::consts::TAU).sin_cos());
    let points: Vec<DVec3> = std::iter::once(DVec3::Z).chain(rim.map(|(s, c)| dvec3(c, s, 0.))).collect();
    let triangles: Vec<[u32; 3]> = (0..n).map(|i| [0, i + 1, (i + 1) % n + 1]).collect();
    let pool = IndexedMesh::from_triangles(points, &triangles).expect("valid");
    let mesh = mesh(&pool);
    assert_eq!(mesh.validate(), Ok(()));
    assert_eq!(mesh.boundary_loops().len(), 1);
    assert_eq!(mesh.to_indexed(), pool);
}
