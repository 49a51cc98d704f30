//! The cases in which known tools were measured and found wrong, each through the library.

use crate::shapes::{self, both, cube, cube_at, fanned};
use crate::{cavity, lidless, naive, volume, welded};
use meshwright::cleanup::{CleanOptions, Weld, clean, index, inspect};
use meshwright::glam::{DVec3, dvec3};
use meshwright::{
    BuildDefect, Crossing, IndexedMesh, Kind, Mesh, NotClosed, OutwardOptions, PolygonSoup, Ray,
    ReduceOptions, ReduceTarget, Stopped, orient_outward, unify_winding,
};

/// The cube of twelve triangles.
fn triangles() -> IndexedMesh {
    fanned(&cube())
}

/// With four triangles flipped.
fn mixed() -> IndexedMesh {
    let mut polygons = triangles().polygons().clone();
    [1, 4, 6, 11].into_iter().for_each(|f| polygons.reverse(f));
    IndexedMesh::new(cube().positions().to_vec(), polygons).expect("valid")
}

/// A cube, and an inverted one apart from it.
fn one_inverted() -> IndexedMesh {
    both(&triangles(), &fanned(&cube_at(DVec3::X * 5.0)).reversed())
}

/// Unified, then turned outward.
fn outward(pool: &IndexedMesh) -> (f64, usize) {
    let unified = unify_winding(&pool.topology()).expect("orientable");
    let turned = orient_outward(&unified.value.topology(), OutwardOptions::default()).expect("not cancelled");
    let changed = pool
        .polygons()
        .iter()
        .zip(turned.outcome.value.polygons().iter())
        .filter(|(old, new)| old != new)
        .count();
    (volume(&shapes::mesh(&turned.outcome.value)), changed)
}

fn naked(pool: &IndexedMesh) -> (usize, usize) {
    let naked = pool.topology().naked_edges();
    (naked.loops.len(), naked.chains.len())
}

#[test]
fn a_cube_has_volume_one_and_nothing_is_turned() {
    let pool = triangles();
    assert_eq!(volume(&shapes::mesh(&pool)), 1.0);
    assert!(pool.topology().is_closed() && naked(&pool) == (0, 0));
    assert_eq!(outward(&pool), (1.0, 0), "nothing is turned");
}

#[test]
fn an_inverted_cube_has_a_negative_volume_until_it_is_turned() {
    let pool = triangles().reversed();
    assert_eq!(volume(&shapes::mesh(&pool)), -1.0, "signed");
    assert!(pool.topology().is_closed() && pool.topology().is_oriented());
    let unified = unify_winding(&pool.topology()).expect("orientable");
    assert!(unified.report.is_empty(), "inside out, and in agreement with itself");
    assert_eq!(outward(&pool), (1.0, 12));
}

#[test]
fn a_cube_of_mixed_winding_has_no_volume_until_it_is_unified_and_is_never_torn() {
    let pool = mixed();
    let topology = pool.topology();
    assert!(topology.is_closed() && topology.orientable().is_ok() && !topology.is_oriented());
    assert_eq!(topology.volume(), None, "no number for what has none");
    let refused = Mesh::build(&pool).expect_err("conflicting");
    assert!(refused.defects.iter().all(|d| matches!(d, BuildDefect::ConflictingEdge { .. })));
    assert_eq!(naked(&pool), (0, 0));
    assert_eq!(outward(&pool), (1.0, 4));
    // Read as a soup nothing is torn, and what was flipped is told.
    let cleaned = clean(&shapes::soup(&pool), CleanOptions::default()).expect("always answers");
    assert_eq!((cleaned.value.vertex_count(), cleaned.value.boundary_loops().len()), (8, 0));
    assert_eq!((volume(&cleaned.value), cleaned.report.count(Kind::FlippedFace)), (1.0, 4));
}

#[test]
fn a_cube_without_bottom_has_no_volume_but_a_witness() {
    let pool = fanned(&lidless(&cube()));
    assert!(!pool.topology().is_closed());
    let loops = pool.topology().naked_edges().loops;
    assert_eq!(loops.iter().map(Vec::len).collect::<Vec<_>>(), [4]);
    let mesh = shapes::mesh(&pool);
    let Err(NotClosed::Open { boundary }) = mesh.closed() else { panic!("open") };
    assert_eq!(boundary.len(), 4, "no volume, and where it is open");
    assert_eq!(pool.topology().volume(), None);
}

#[test]
fn of_two_cubes_the_inverted_one_is_turned() {
    let pool = one_inverted();
    assert_eq!(volume(&shapes::mesh(&pool)), 0.0, "signed, and asked for as it is");
    assert!(unify_winding(&pool.topology()).expect("orientable").report.is_empty(), "each part agrees");
    assert_eq!(outward(&pool), (2.0, 12));
}

#[test]
fn a_cavity_stays_inverted_and_subtracts() {
    let pool = fanned(&cavity());
    assert_eq!(volume(&shapes::mesh(&pool)), 26.0);
    assert_eq!(outward(&pool), (26.0, 0), "the cavity stays inverted");
    // With the cavity wound as a solid would be, it is turned in.
    let mut outer = cube();
    outer.map_positions(|p| p * 3.0).expect("finite");
    assert_eq!(outward(&fanned(&both(&outer, &cube_at(DVec3::ONE)))), (26.0, 12));
}

#[test]
fn two_cubes_that_share_an_edge_come_apart_into_two() {
    let pool = welded(&shapes::soup(&fanned(&shapes::cubes_at_an_edge())));
    let topology = pool.topology();
    let shared: Vec<_> = topology.nonmanifold_edges().map(|e| e.faces().count()).collect();
    assert_eq!((shared, naked(&pool)), (vec![4], (0, 0)), "one edge with four faces, and it is not naked");
    assert!(!topology.is_closed() && !topology.is_edge_manifold());
    let cleaned = clean(&shapes::soup(&pool), CleanOptions::default()).expect("always answers");
    assert_eq!((cleaned.value.components().len(), volume(&cleaned.value)), (2, 2.0));
    assert_eq!(cleaned.report.count(Kind::FlippedFace), 0);
}

#[test]
fn two_cubes_that_share_a_vertex_come_apart_into_two() {
    let pool = welded(&shapes::soup(&fanned(&shapes::cubes_at_a_vertex())));
    let topology = pool.topology();
    assert!(topology.is_closed() && topology.is_edge_manifold() && !topology.is_vertex_manifold());
    assert_eq!(topology.pinched_vertices(), [(7, 2)]);
    assert_eq!(naked(&pool), (0, 0));
    let cleaned = clean(&shapes::soup(&pool), CleanOptions::default()).expect("always answers");
    assert_eq!((cleaned.value.components().len(), volume(&cleaned.value)), (2, 2.0));
    assert_eq!(cleaned.report.count(Kind::PinchedVertex), 1);
}

#[test]
fn a_face_that_is_there_twice_is_dropped_once_and_told() {
    let mut soup = shapes::soup(&triangles());
    let again = soup.polygons[3].to_vec();
    soup.polygons.push(again);
    let facts = inspect(&soup, Weld::Exact).expect("always answers");
    assert_eq!((facts.nonmanifold_edges, facts.duplicate_faces, facts.closed), (3, 1, false));
    let cleaned = clean(&soup, CleanOptions::default()).expect("always answers");
    assert_eq!(volume(&cleaned.value), 1.0);
    let kinds: Vec<_> = cleaned.report.records.iter().map(|r| r.kind).collect();
    assert_eq!(kinds, [Kind::DuplicateFace]);
}

#[test]
fn thirty_six_corners_are_welded_to_a_cube() {
    let soup = shapes::unwelded(&triangles());
    assert_eq!(soup.positions.len(), 36);
    let apart = IndexedMesh::try_from(soup.clone()).expect("a pool");
    assert_eq!(naked(&apart), (12, 0), "every triangle by itself");
    assert_eq!(naive::weld(&soup.positions, 0.0).iter().enumerate().filter(|(i, k)| i == *k).count(), 8);
    let mesh = shapes::mesh(&apart).weld(Default::default()).expect("welded").value;
    assert_eq!((mesh.vertex_count(), mesh.is_closed(), volume(&mesh)), (8, true, 1.0));
}

#[test]
fn a_moebius_strip_is_refused_with_a_walk_of_faces() {
    let pool = fanned(&shapes::moebius(8));
    let topology = pool.topology();
    assert!(!topology.is_closed() && topology.is_edge_manifold() && topology.is_vertex_manifold());
    let witness = topology.orientable().expect_err("one-sided").cycles;
    assert_eq!((witness.len(), witness[0].len()), (1, 16), "once around");
    assert!(unify_winding(&topology).is_err());
    assert_eq!(naked(&pool), (1, 0), "one rim");
    let refused = Mesh::build(&pool).expect_err("not orientable");
    assert!(!refused.defects.is_empty());
}

#[test]
fn volume_is_right_at_an_offset_of_a_million_where_the_plain_sum_is_not() {
    let mut sphere = shapes::icosphere(3);
    let near = volume(&shapes::mesh(&sphere));
    // A power of two far away every position is rounded; by that alone may the volume differ.
    for (offset, slack) in [(1e5, 1e-9), (1e6, 1e-8)] {
        let there = dvec3(offset, -offset, offset);
        let mut far = sphere.clone();
        far.map_positions(|p| p + there).expect("finite");
        let ours = volume(&shapes::mesh(&far));
        assert!((ours - near).abs() < slack * near, "{offset}: {ours} {near}");
        let sum = naive::volume(&naive::Plain::from(&far));
        assert!(
            (sum - near).abs() > 1e3 * (ours - near).abs(),
            "{offset}: the plain sum is off by {}",
            sum - near
        );
    }
    sphere = shapes::cube_at(DVec3::splat(1e6));
    assert_eq!(volume(&shapes::mesh(&sphere)), 1.0);
}

#[test]
fn rays_along_every_diagonal_of_the_cube_cross_twice() {
    for pool in [cube(), triangles()] {
        let mesh = shapes::mesh(&pool);
        let index = mesh.index();
        for i in 0..26i32 {
            // Every way from the middle through a vertex, an edge or a face, and the faces' own diagonals.
            let [x, y, z] = [i, i / 3, i / 9].map(|k| f64::from(k % 3 - 1));
            let d = dvec3(x, y, z);
            if d == DVec3::ZERO {
                continue;
            }
            for from in [DVec3::splat(0.5), dvec3(0.5, 0.5, 0.25)] {
                let hits = index.hits(&Ray::new(from - d * 4.0, d).expect("a ray"));
                let crossings: Vec<_> = hits.iter().map(|h| h.crossing).collect();
                assert_eq!(crossings, [Crossing::Enter, Crossing::Leave], "{from} {d}");
            }
        }
    }
}

#[test]
fn a_chain_is_not_pulled_together_and_pairs_across_a_cell_are_merged() {
    // A chain of 0.7 tolerances: a union would pull all to one point, ten tolerances away.
    let chain: Vec<DVec3> = (0..15).map(|i| DVec3::X * (0.7 * f64::from(i))).collect();
    let soup = PolygonSoup::new(chain.clone(), Default::default());
    let kept = index(&soup, Weld::Within(1.0)).expect("always answers");
    for (v, p) in chain.iter().enumerate() {
        let at = kept.value.positions()[kept.maps.vertices.new_of(v)[0] as usize];
        assert!(at.distance(*p) < 1.0, "moved less than the tolerance");
    }
    assert_eq!(kept.value.vertex_count(), 8);
    // Pairs 0.02 tolerances apart, wherever a grid has its cells.
    for i in 0..500 {
        let at = DVec3::splat(f64::from(i) * 0.01 - 2.5);
        let soup = PolygonSoup::new(vec![at, at + DVec3::X * 0.02], Default::default());
        let kept = index(&soup, Weld::Within(1.0)).expect("always answers");
        assert_eq!(kept.value.positions(), [at], "{i}");
    }
}

#[test]
fn reduce_to_one_face_stops_at_the_smallest_mesh_of_the_same_kind() {
    let one = || ReduceOptions { target: ReduceTarget::Faces(1), ..Default::default() };
    for (pool, least) in [
        (shapes::tetrahedron(), 4),
        (triangles(), 4),
        (fanned(&cavity()), 8),
        (fanned(&shapes::torus(9, 6)), 14),
        (shapes::icosphere(2), 4),
    ] {
        let mut mesh = shapes::mesh(&pool);
        let kept = |m: &Mesh| (m.is_closed(), m.components().len(), m.euler_characteristic());
        let before = kept(&mesh);
        let account = mesh.reduce(one()).expect("reduces");
        assert_eq!((kept(&mesh), mesh.validate()), (before, Ok(())));
        assert_eq!((account.stopped, account.faces), (Stopped::NoLegalCollapse, mesh.face_count()));
        assert!(account.faces >= least, "{account:?}");
        let refused = account.refusals;
        assert!(refused.topology + refused.flip + refused.shape > 0, "and says why: {refused:?}");
    }
}
