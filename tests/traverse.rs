//! Traversal for editors beside naive twins: rings, edge loops, shortest paths, regions, features.

mod shapes;

use meshwright::glam::{DVec3, dvec3};
use meshwright::{
    EdgeChain, EdgeKey, FaceKey, FeatureOptions, HalfedgeKey, IndexedMesh, Mesh, PathError, VertexKey,
};
use proptest::prelude::*;
use shapes::{Noise, cube, grid, icosphere, mesh, pool, tetrahedron, torus};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::{FRAC_PI_2, PI};

/// `n` by `m` flat unit squares.
fn quads(n: u32, m: u32) -> IndexedMesh {
    let points = (0..(n + 1) * (m + 1)).map(|i| dvec3(f64::from(i % (n + 1)), f64::from(i / (n + 1)), 0.0));
    let quad = |i: u32| {
        let a = i / n * (n + 1) + i % n;
        vec![a, a + 1, a + n + 2, a + n + 1]
    };
    pool(points.collect(), (0..n * m).map(quad).collect())
}

/// A cylinder of `n` sides, its caps two polygons.
fn cylinder(n: u32) -> IndexedMesh {
    let point = |i: u32, z: f64| {
        let turn = f64::from(i) / f64::from(n) * std::f64::consts::TAU;
        dvec3(turn.cos(), turn.sin(), z)
    };
    let points = (0..n).map(|i| point(i, 0.0)).chain((0..n).map(|i| point(i, 1.0))).collect();
    let side = |i: u32| vec![i, (i + 1) % n, n + (i + 1) % n, n + i];
    let caps = [(0..n).rev().collect(), (n..2 * n).collect()];
    pool(points, (0..n).map(side).chain(caps).collect())
}

fn all() -> Vec<Mesh> {
    let open =
        pool(cube().positions().to_vec(), cube().polygons().iter().skip(1).map(<[u32]>::to_vec).collect());
    let pools = [
        cube(),
        open,
        tetrahedron(),
        grid(4),
        quads(4, 3),
        torus(5, 4),
        cylinder(7),
        icosphere(1),
        shapes::both(&cube(), &quads(2, 2)),
        pool(vec![DVec3::ZERO, DVec3::X], vec![]),
    ];
    pools.iter().map(mesh).collect()
}

/// The half-edge from one numbered vertex to another.
fn between(mesh: &Mesh, a: usize, b: usize) -> HalfedgeKey {
    let v: Vec<_> = mesh.vertices().collect();
    mesh.find_halfedge(v[a], v[b]).expect("an edge")
}

fn edges(mesh: &Mesh, chain: &[HalfedgeKey]) -> BTreeSet<EdgeKey> {
    chain.iter().map(|&h| mesh.edge(h)).collect()
}

fn length(mesh: &Mesh, h: HalfedgeKey) -> f64 {
    mesh.position(mesh.origin(h)).distance(mesh.position(mesh.target(h)))
}

/// Distances by relaxing every pair until nothing changes.
fn naive_distances<K: Ord + Copy>(pairs: &[(K, K, f64)], from: K) -> BTreeMap<K, f64> {
    let mut found = BTreeMap::from([(from, 0.0)]);
    loop {
        let mut changed = false;
        for &(a, b, cost) in pairs {
            if let Some(&d) = found.get(&a)
                && found.get(&b).is_none_or(|&old| d + cost < old)
            {
                found.insert(b, d + cost);
                changed = true;
            }
        }
        if !changed {
            return found;
        }
    }
}

fn vertex_pairs(mesh: &Mesh, cost: impl Fn(HalfedgeKey) -> f64) -> Vec<(VertexKey, VertexKey, f64)> {
    mesh.halfedges().map(|h| (mesh.origin(h), mesh.target(h), cost(h))).collect()
}

fn face_pairs(mesh: &Mesh) -> Vec<(FaceKey, FaceKey, f64)> {
    let pair = |h| Some((mesh.face(h)?, mesh.face(mesh.twin(h))?, 1.0));
    mesh.halfedges().filter_map(pair).collect()
}

fn check_rings<K: Ord + Copy + std::fmt::Debug>(ring: Vec<(K, u32)>, far: &BTreeMap<K, f64>, k: u32) {
    assert!(ring.is_sorted_by_key(|r| r.1), "breadth-first");
    let listed: BTreeMap<K, f64> = ring.iter().map(|&(e, d)| (e, f64::from(d))).collect();
    assert_eq!(listed.len(), ring.len(), "each once");
    let expected: BTreeMap<K, f64> =
        far.iter().filter(|(_, d)| **d <= f64::from(k)).map(|(&e, &d)| (e, d)).collect();
    assert_eq!(listed, expected);
}

#[test]
fn k_rings_equal_distances_found_slowly() {
    for mesh in all() {
        let (vertices, faces) = (vertex_pairs(&mesh, |_| 1.0), face_pairs(&mesh));
        for k in [0, 1, 2, 3, u32::MAX] {
            for v in mesh.vertices() {
                check_rings(mesh.k_ring(v, k).collect(), &naive_distances(&vertices, v), k);
            }
            for f in mesh.faces() {
                check_rings(mesh.face_ring(f, k).collect(), &naive_distances(&faces, f), k);
            }
        }
    }
}

#[test]
fn a_ring_begins_with_its_element_and_the_neighbours_in_their_order() {
    for mesh in all() {
        for v in mesh.vertices() {
            let expected = std::iter::once(v).chain(mesh.neighbors(v));
            assert!(mesh.k_ring(v, 1).map(|(v, _)| v).eq(expected));
        }
    }
    let mesh = mesh(&quads(3, 3));
    let middle = mesh.faces().nth(4).expect("a face");
    let expected = std::iter::once(middle).chain(mesh.face_neighbors(middle));
    assert!(mesh.face_ring(middle, 1).map(|(f, _)| f).eq(expected));
}

#[test]
fn edge_loops_of_a_torus_close_around_it() {
    let mesh = mesh(&torus(7, 5));
    let mut lengths = BTreeMap::<usize, usize>::new();
    for e in mesh.edges() {
        let found = mesh.edge_loop(mesh.edge_halfedge(e));
        assert!(found.closed);
        *lengths.entry(found.halfedges.len()).or_default() += 1;
        assert_eq!(found.halfedges[0], mesh.edge_halfedge(e));
    }
    assert_eq!(lengths, BTreeMap::from([(5, 35), (7, 35)]));
}

#[test]
fn edge_rings_of_a_torus_close_across_it() {
    let mesh = mesh(&torus(7, 5));
    for h in mesh.halfedges() {
        let (ring, through) = (mesh.edge_ring(h), mesh.edge_loop(h));
        assert!(ring.closed);
        assert_eq!(ring.halfedges.len() + through.halfedges.len(), 12, "the other way around");
        let quads: BTreeSet<_> = ring.halfedges.iter().map(|&h| mesh.face(h)).collect();
        assert_eq!(quads.len(), ring.halfedges.len());
    }
}

#[test]
fn an_edge_loop_on_an_open_grid_runs_from_side_to_side() {
    // Vertices count along x, six to a row.
    let mesh = mesh(&quads(5, 3));
    let expected: Vec<_> = (6..11).map(|i| between(&mesh, i, i + 1)).collect();
    for &h in &expected {
        assert_eq!(mesh.edge_loop(h), EdgeChain { halfedges: expected.clone(), closed: false });
        let back: Vec<_> = expected.iter().rev().map(|&h| mesh.twin(h)).collect();
        assert_eq!(mesh.edge_loop(mesh.twin(h)), EdgeChain { halfedges: back, closed: false });
    }
}

#[test]
fn an_edge_ring_on_an_open_grid_runs_from_side_to_side() {
    let mesh = mesh(&quads(5, 3));
    let rungs: Vec<_> = (0..4).map(|row| between(&mesh, 6 * row + 2, 6 * row + 3)).collect();
    for &h in &rungs {
        assert_eq!(mesh.edge_ring(h), EdgeChain { halfedges: rungs.clone(), closed: false });
    }
}

#[test]
fn the_edge_loop_of_a_boundary_edge_is_its_boundary_loop_either_way() {
    let mesh = mesh(&quads(5, 3));
    let outline = &mesh.boundary_loops()[0];
    let h = outline[0];
    assert_eq!(mesh.edge_loop(h), EdgeChain { halfedges: outline.clone(), closed: true });
    let inner = mesh.edge_loop(mesh.twin(h));
    assert!(inner.closed && inner.halfedges[0] == mesh.twin(h));
    let mut back: Vec<_> = outline.iter().map(|&h| mesh.twin(h)).collect();
    back[1..].reverse();
    assert_eq!(inner.halfedges, back);
}

#[test]
fn edge_loops_end_where_not_four_edges_meet_and_rings_at_faces_that_are_no_quads() {
    let mesh = mesh(&cylinder(6));
    let up = between(&mesh, 0, 6);
    assert_eq!(mesh.edge_loop(up), EdgeChain { halfedges: vec![up], closed: false });
    assert_eq!(mesh.edge_ring(up).halfedges.len(), 6);
    assert!(mesh.edge_ring(up).closed);
    let rim = between(&mesh, 0, 1);
    let expected = vec![rim, between(&mesh, 6, 7)];
    assert_eq!(mesh.edge_ring(rim), EdgeChain { halfedges: expected, closed: false });
}

#[test]
fn an_edge_loop_that_crosses_itself_goes_straight_on_and_holds_each_edge_once() {
    // Two by two quads, and a band of quads that leads from their right side around to their top.
    let points = (0..9).map(|i| dvec3(f64::from(i % 3), f64::from(i / 3), 0.0));
    let band = [dvec3(4.0, 4.0, 0.0), dvec3(3.5, 3.5, 0.0), dvec3(3.0, 3.0, 0.0)];
    let quads = [
        [0, 1, 4, 3],
        [1, 2, 5, 4],
        [3, 4, 7, 6],
        [4, 5, 8, 7],
        [5, 2, 9, 10],
        [8, 5, 10, 11],
        [10, 9, 6, 7],
        [11, 10, 7, 8],
    ];
    let mesh = mesh(&pool(points.chain(band).collect(), quads.map(|q| q.to_vec()).to_vec()));
    let way = [3, 4, 5, 10, 7, 4, 1];
    let expected: Vec<_> = way.windows(2).map(|w| between(&mesh, w[0], w[1])).collect();
    for &h in &expected {
        assert_eq!(mesh.edge_loop(h), EdgeChain { halfedges: expected.clone(), closed: false });
    }
}

#[test]
fn an_edge_loop_may_wind_through_every_vertex() {
    // A torus of n by n quads, glued with a shift.
    let (n, shift) = (5u32, 2u32);
    let at = |i: u32, j: u32| (if i < n { i } else { 0 }) * n + (j + if i < n { 0 } else { shift }) % n;
    let points =
        (0..n * n).map(|i| dvec3(f64::from(i / n), f64::from(i % n), f64::from(i * i % 7))).collect();
    let quad = |k: u32| {
        let (i, j) = (k / n, k % n);
        vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]
    };
    let mesh = mesh(&pool(points, (0..n * n).map(quad).collect()));
    let winding = mesh.edge_loop(between(&mesh, 0, n as usize));
    assert!(winding.closed);
    assert_eq!(winding.halfedges.len() as u32, n * n);
}

#[test]
fn chains_hold_each_edge_once_and_every_member_finds_the_same_chain() {
    for mesh in all() {
        for h in mesh.halfedges() {
            let through = mesh.edge_loop(h);
            for pair in through.halfedges.windows(2) {
                assert_eq!(mesh.target(pair[0]), mesh.origin(pair[1]));
            }
            let last = through.halfedges[through.halfedges.len() - 1];
            if through.closed {
                assert_eq!(mesh.target(last), mesh.origin(through.halfedges[0]));
            }
            let ring = mesh.edge_ring(h);
            for pair in ring.halfedges.windows(2) {
                assert_eq!(mesh.face(pair[0]), mesh.face(mesh.twin(pair[1])));
                assert_eq!(mesh.degree(mesh.face(pair[0]).expect("a quad")), 4);
            }
            for (chain, again) in [(through, Mesh::edge_loop as fn(&Mesh, _) -> _), (ring, Mesh::edge_ring)] {
                assert!(chain.halfedges.contains(&h));
                let all = edges(&mesh, &chain.halfedges);
                assert_eq!(all.len(), chain.halfedges.len());
                for &g in &chain.halfedges {
                    let other: EdgeChain = again(&mesh, g);
                    assert_eq!(other.closed, chain.closed);
                    assert_eq!(edges(&mesh, &other.halfedges), all);
                    assert!(chain.closed || other == chain);
                    let back: EdgeChain = again(&mesh, mesh.twin(g));
                    assert_eq!(edges(&mesh, &back.halfedges), all, "the other way it is the same");
                }
            }
        }
    }
}

fn check_path(mesh: &Mesh, a: VertexKey, b: VertexKey, cost: impl Fn(HalfedgeKey) -> f64) {
    let far = naive_distances(&vertex_pairs(mesh, &cost), a);
    let path = mesh.shortest_path_by(a, b, &cost).expect("costs are fine");
    assert_eq!(path.is_some(), far.contains_key(&b));
    let Some(path) = path else { return };
    let sum = path.halfedges.iter().fold(0.0, |sum, &h| sum + cost(h));
    assert_eq!(path.length, sum, "the length is what the half-edges cost");
    assert!((path.length - far[&b]).abs() <= 1e-12 * sum, "{} {}", path.length, far[&b]);
    let mut at = a;
    for &h in &path.halfedges {
        assert_eq!(mesh.origin(h), at);
        at = mesh.target(h);
    }
    assert_eq!(at, b);
}

#[test]
fn shortest_paths_equal_distances_found_slowly() {
    for mesh in all() {
        let ends: Vec<_> = mesh.vertices().step_by(3).collect();
        for &a in &ends {
            for &b in &ends {
                check_path(&mesh, a, b, |h| length(&mesh, h));
                let path = mesh.shortest_path(a, b).expect("lengths are fine");
                assert_eq!(path, mesh.shortest_path_by(a, b, |h| length(&mesh, h)).expect("so are these"));
            }
        }
    }
}

#[test]
fn of_equally_long_paths_the_one_with_the_fewest_edges_is_taken() {
    let mesh = mesh(&quads(4, 4));
    let v: Vec<_> = mesh.vertices().collect();
    let free = mesh.shortest_path_by(v[0], v[24], |_| 0.0).expect("costs are fine").expect("connected");
    assert_eq!((free.halfedges.len(), free.length), (8, 0.0));
}

#[test]
fn the_shortest_path_to_itself_is_empty_and_to_another_component_is_none() {
    let mesh = mesh(&shapes::both(&cube(), &quads(2, 2)));
    let v: Vec<_> = mesh.vertices().collect();
    let path = mesh.shortest_path(v[3], v[3]).expect("live").expect("here");
    assert!(path.halfedges.is_empty() && path.length == 0.0);
    assert_eq!(mesh.shortest_path(v[3], v[12]), Ok(None));
}

#[test]
fn costs_that_make_no_sense_are_refused_with_their_half_edge() {
    let mesh = mesh(&cube());
    let v: Vec<_> = mesh.vertices().collect();
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        let refusal = mesh.shortest_path_by(v[0], v[7], |_| bad).expect_err("a bad cost");
        assert!(matches!(refusal, PathError::BadCost { halfedge, cost }
            if mesh.origin(halfedge) == v[0] && cost.to_bits() == bad.to_bits()));
    }
    let dead = VertexKey::default();
    assert_eq!(mesh.shortest_path(dead, v[0]), Err(PathError::Missing(dead)));
    assert_eq!(mesh.shortest_path(v[0], dead), Err(PathError::Missing(dead)));
}

#[test]
fn lengths_at_the_ends_of_f64_are_exact_or_refused() {
    for (scale, fine) in [(1e-200, true), (1e200, true), (1e-310, true), (1.7e308, false)] {
        let points = quads(2, 1).positions().iter().map(|&p| (p - DVec3::X) * scale).collect();
        let mesh = mesh(&IndexedMesh::new(points, quads(2, 1).polygons().clone()).expect("finite"));
        let v: Vec<_> = mesh.vertices().collect();
        let path = mesh.shortest_path(v[0], v[2]);
        if fine {
            assert_eq!(path.expect("finite").expect("connected").length, 2.0 * scale);
        } else {
            assert_eq!(path.expect("finite edges").expect("connected").length, f64::INFINITY);
            let cost = |h| length(&mesh, h) * f64::MAX;
            assert!(mesh.shortest_path_by(v[0], v[2], cost).is_err());
        }
    }
    let long = [dvec3(-1.7e308, 0.0, 0.0), dvec3(1.7e308, 0.0, 0.0), DVec3::Y];
    let mesh = mesh(&IndexedMesh::from_triangles(long.to_vec(), &[[0, 1, 2]]).expect("finite"));
    let v: Vec<_> = mesh.vertices().collect();
    assert!(matches!(mesh.shortest_path(v[0], v[2]), Err(PathError::BadCost { .. })));
}

#[test]
fn a_path_of_free_and_of_dear_half_edges_may_differ_by_direction() {
    let mesh = mesh(&cylinder(6));
    let v: Vec<_> = mesh.vertices().collect();
    // Only up costs.
    let up = |h| if mesh.position(mesh.target(h)).z > mesh.position(mesh.origin(h)).z { 5.0 } else { 0.0 };
    assert_eq!(mesh.shortest_path_by(v[0], v[9], up).expect("fine").expect("connected").length, 5.0);
    assert_eq!(mesh.shortest_path_by(v[9], v[0], up).expect("fine").expect("connected").length, 0.0);
}

#[test]
fn a_region_grows_across_the_edges_the_predicate_holds_for() {
    for mesh in all() {
        let mut noise = Noise(11);
        let open: BTreeSet<EdgeKey> = mesh.edges().filter(|_| noise.below(2) == 0).collect();
        let pairs: Vec<_> = mesh
            .halfedges()
            .filter(|&h| open.contains(&mesh.edge(h)))
            .filter_map(|h| Some((mesh.face(h)?, mesh.face(mesh.twin(h))?, 1.0)))
            .collect();
        for f in mesh.faces() {
            let region: Vec<_> = mesh.grow_region(f, |h| open.contains(&mesh.edge(h))).collect();
            assert_eq!(region[0], f);
            let listed: BTreeSet<_> = region.iter().copied().collect();
            assert_eq!(listed.len(), region.len());
            assert_eq!(listed, naive_distances(&pairs, f).into_keys().collect());
        }
    }
}

#[test]
fn the_predicate_is_asked_about_the_near_side_and_at_most_once() {
    let mesh = mesh(&torus(5, 4));
    let f = mesh.faces().next().expect("a face");
    let mut asked = BTreeSet::new();
    let region: Vec<_> = mesh
        .grow_region(f, |h| {
            assert!(asked.insert(h));
            asked.len() % 3 > 0
        })
        .collect();
    assert!(asked.iter().all(|&h| region.contains(&mesh.face(h).expect("a face"))));
}

#[test]
fn smooth_regions_are_what_the_feature_edges_leave_connected() {
    for mesh in all() {
        for angle in [0.2, 1.0, FRAC_PI_2 - 1e-6, f64::NAN] {
            let sharp: BTreeSet<_> = mesh.feature_edges(FeatureOptions { angle, boundary: false }).collect();
            for f in mesh.faces() {
                let expected = mesh.grow_region(f, |h| !sharp.contains(&mesh.edge(h)));
                assert!(mesh.smooth_region(f, angle).eq(expected));
            }
        }
    }
    let mesh = mesh(&cylinder(12));
    let sizes: Vec<_> = mesh.faces().map(|f| mesh.smooth_region(f, 1.0).count()).collect();
    assert_eq!(sizes, [vec![12; 12], vec![1; 2]].concat());
}

#[test]
fn the_boundary_of_a_region_holds_every_half_edge_that_leaves_it_once() {
    for mesh in all() {
        let mut noise = Noise(5);
        for one_in in [1, 2, 3, 1000] {
            let region: Vec<FaceKey> = mesh.faces().filter(|_| noise.below(one_in) == 0).collect();
            let loops = mesh.region_boundary(region.iter().copied());
            let inside: BTreeSet<_> = region.iter().copied().collect();
            let is_in = |h| mesh.face(h).is_some_and(|f| inside.contains(&f));
            let leaving: BTreeSet<_> =
                mesh.halfedges().filter(|&h| is_in(h) && !is_in(mesh.twin(h))).collect();
            let listed: Vec<_> = loops.iter().flatten().copied().collect();
            assert_eq!(listed.len(), leaving.len());
            assert_eq!(listed.into_iter().collect::<BTreeSet<_>>(), leaving);
            for l in &loops {
                assert!((0..l.len()).all(|i| mesh.target(l[i]) == mesh.origin(l[(i + 1) % l.len()])));
            }
            let twice = region.iter().chain(&region).copied();
            assert_eq!(mesh.region_boundary(twice), loops);
        }
    }
}

#[test]
fn a_region_that_touches_itself_at_a_vertex_has_a_loop_for_each_side() {
    let mesh = mesh(&quads(2, 2));
    let f: Vec<_> = mesh.faces().collect();
    let loops = mesh.region_boundary([f[0], f[3]]);
    assert_eq!(loops.iter().map(Vec::len).collect::<Vec<_>>(), [4, 4]);
    let whole = mesh.region_boundary(mesh.faces());
    let back: BTreeSet<_> = mesh.boundary_halfedges().map(|h| mesh.twin(h)).collect();
    assert_eq!(whole[0].iter().copied().collect::<BTreeSet<_>>(), back);
}

#[test]
fn dihedral_angles_are_positive_where_the_surface_is_convex() {
    let mut convex = mesh(&cube());
    for e in convex.edges() {
        assert_eq!(convex.dihedral_angle(e), Some(FRAC_PI_2));
    }
    convex.reverse();
    assert!(convex.edges().all(|e| convex.dihedral_angle(e) == Some(-FRAC_PI_2)));
    let flat = mesh(&quads(3, 3));
    for e in flat.edges() {
        let expected = if flat.is_boundary_edge(e) { None } else { Some(0.0) };
        assert_eq!(flat.dihedral_angle(e), expected);
    }
    let (n, tube) = (9u32, mesh(&cylinder(9)));
    for i in 0..n as usize {
        let e = tube.edge(between(&tube, i, i + n as usize));
        let turn = tube.dihedral_angle(e).expect("two faces");
        assert!((turn - std::f64::consts::TAU / f64::from(n)).abs() < 1e-14);
    }
}

#[test]
fn dihedral_angles_of_slivers_keep_their_digits() {
    // Two needles, 1e-9 wide, far from the origin of their plane, turned against each other by a known angle.
    for turn in [1e-3, 0.5, 1.0, FRAC_PI_2, 3.0, -1e-3, -0.5, -3.0f64] {
        for width in [1e-3, 1e-6, 1e-9, 1e-12] {
            for tip in [0.0, 0.3, 1.0] {
                let points = [
                    DVec3::ZERO,
                    DVec3::X,
                    dvec3(tip, width, 0.0),
                    dvec3(tip, -width * turn.cos(), -width * turn.sin()),
                ];
                for start in 0..3 {
                    let mut faces = [[0, 1, 2], [1, 0, 3]];
                    faces.iter_mut().for_each(|f| f.rotate_left(start));
                    let mesh = mesh(&IndexedMesh::from_triangles(points.to_vec(), &faces).expect("fine"));
                    let e = mesh.edge(between(&mesh, 0, 1));
                    let found = mesh.dihedral_angle(e).expect("two faces");
                    assert!((found - turn).abs() < 1e-14, "{turn} {width} {tip} {start}: {found}");
                }
            }
        }
    }
}

#[test]
fn a_needle_far_from_the_origin_has_the_angle_of_its_corners_as_stored() {
    // The short side first, in the middle or last: cutting from the far corner loses the width.
    let far = dvec3(1000.0, 0.0, 0.0);
    let width = 2f64.powi(-30);
    let points = [DVec3::ZERO, DVec3::Y * width, far, dvec3(0.0, 0.0, -width)];
    let mut angles = BTreeSet::new();
    for start in 0..3 {
        let mut faces = [[0, 2, 1], [2, 0, 3]];
        faces.iter_mut().for_each(|f| f.rotate_left(start));
        let mesh = mesh(&IndexedMesh::from_triangles(points.to_vec(), &faces).expect("fine"));
        let found = mesh.dihedral_angle(mesh.edge(between(&mesh, 0, 2))).expect("two faces");
        angles.insert(found.to_bits());
        assert!((found.abs() - FRAC_PI_2).abs() < 1e-15);
    }
    assert_eq!(angles.len(), 1, "whatever the first corner");
}

#[test]
fn dihedral_angles_survive_the_ends_of_f64() {
    for scale in [1e-300, 1e-160, 1e160, 1e300] {
        let points = cube().positions().iter().map(|&p| (p - 0.5) * scale).collect();
        let mesh = mesh(&IndexedMesh::new(points, cube().polygons().clone()).expect("finite"));
        assert!(mesh.edges().all(|e| mesh.dihedral_angle(e) == Some(FRAC_PI_2)), "{scale}");
    }
}

#[test]
fn an_edge_of_a_face_without_area_has_no_angle_and_a_fold_turns_by_half_a_circle() {
    let line = [DVec3::ZERO, DVec3::X, DVec3::X * 2.0, DVec3::Y];
    let flat = mesh(&IndexedMesh::from_triangles(line.to_vec(), &[[0, 1, 3], [1, 0, 2]]).expect("fine"));
    assert_eq!(flat.dihedral_angle(flat.edge(between(&flat, 0, 1))), None);
    let folded = [DVec3::ZERO, DVec3::X, DVec3::Y, dvec3(0.3, 1.0, 0.0)];
    let folded = mesh(&IndexedMesh::from_triangles(folded.to_vec(), &[[0, 1, 2], [1, 0, 3]]).expect("fine"));
    let turn = folded.dihedral_angle(folded.edge(between(&folded, 0, 1))).expect("two faces");
    assert_eq!(turn.abs(), PI);
}

fn naive_features(mesh: &Mesh, options: FeatureOptions) -> BTreeSet<EdgeKey> {
    let normal = |h| mesh.face(h).map(|f| mesh.face_normal(f));
    let is_feature = |&e: &EdgeKey| {
        let h = mesh.edge_halfedge(e);
        match (normal(h), normal(mesh.twin(h))) {
            (Some(a), Some(b)) => a.dot(b).clamp(-1.0, 1.0).acos() > options.angle,
            _ => options.boundary,
        }
    };
    mesh.edges().filter(is_feature).collect()
}

fn check_features(mesh: &Mesh, options: FeatureOptions) {
    let features: Vec<_> = mesh.feature_edges(options).collect();
    assert!(features.is_sorted());
    let features: BTreeSet<_> = features.into_iter().collect();
    assert_eq!(features, naive_features(mesh, options));
    let paths = mesh.feature_paths(options);
    let listed: Vec<_> = paths.iter().flat_map(|p| &p.halfedges).map(|&h| mesh.edge(h)).collect();
    assert_eq!(listed.len(), features.len(), "each edge in one path");
    assert_eq!(listed.into_iter().collect::<BTreeSet<_>>(), features);
    let degree = |v| mesh.edges_around(v).filter(|e| features.contains(e)).count();
    let mut first = None;
    for path in &paths {
        let h = &path.halfedges;
        for pair in h.windows(2) {
            assert_eq!(mesh.target(pair[0]), mesh.origin(pair[1]));
            assert_eq!(degree(mesh.target(pair[0])), 2, "inside a path there is no corner");
        }
        let (start, end) = (mesh.origin(h[0]), mesh.target(h[h.len() - 1]));
        if path.closed {
            assert_eq!(start, end);
            assert_eq!(degree(start), 2);
        } else {
            assert!(degree(start) != 2 && degree(end) != 2, "a path goes on to a corner");
        }
        let lowest = h.iter().copied().min_by_key(|&h| mesh.edge(h)).expect("an edge");
        assert_eq!(lowest, mesh.edge_halfedge(mesh.edge(lowest)));
        assert!(first.replace(mesh.edge(lowest)) < Some(mesh.edge(lowest)), "in order");
    }
}

#[test]
fn feature_paths_hold_every_feature_edge_once_and_end_at_corners() {
    for mesh in all() {
        for angle in [0.0001, 0.2, 1.0, 1.5, 3.5] {
            for boundary in [false, true] {
                check_features(&mesh, FeatureOptions { angle, boundary });
            }
        }
    }
}

#[test]
fn the_features_of_a_cylinder_are_its_two_rims_and_of_a_cube_its_edges() {
    let options = FeatureOptions { angle: 1.0, boundary: false };
    let rims = mesh(&cylinder(12)).feature_paths(options);
    assert_eq!(rims.iter().map(|p| (p.halfedges.len(), p.closed)).collect::<Vec<_>>(), [(12, true); 2]);
    let cube = mesh(&cube()).feature_paths(options);
    assert!(cube.len() == 12 && cube.iter().all(|p| p.halfedges.len() == 1 && !p.closed));
    let outline = mesh(&quads(3, 2)).feature_paths(FeatureOptions { boundary: true, ..options });
    assert_eq!(outline.iter().map(|p| (p.halfedges.len(), p.closed)).collect::<Vec<_>>(), [(10, true)]);
}

#[test]
fn a_path_back_to_its_own_corner_is_not_closed() {
    // A fan of triangles with one crease, from its apex to the outline.
    let n = 24u32;
    let rim = |i: u32| {
        let turn = f64::from(i) / f64::from(n) * std::f64::consts::TAU;
        dvec3(turn.cos(), turn.sin(), (turn / 2.0).sin())
    };
    let points = std::iter::once(DVec3::ZERO).chain((0..n).map(rim)).collect();
    let mesh = mesh(&pool(points, (0..n).map(|i| vec![0, 1 + i, 1 + (i + 1) % n]).collect()));
    let paths = mesh.feature_paths(FeatureOptions { angle: 0.5, boundary: true });
    let found: Vec<_> = paths.iter().map(|p| (p.halfedges.len(), p.closed)).collect();
    assert_eq!(found, [(1, false), (n as usize, false)]);
    let outline = &paths[1].halfedges;
    assert_eq!(mesh.origin(outline[0]), mesh.target(outline[outline.len() - 1]));
}

#[test]
fn readers_answer_none_to_dead_keys() {
    let mesh = mesh(&cube());
    let (v, e, f) = (VertexKey::default(), EdgeKey::default(), FaceKey::default());
    let other = shapes::mesh(&grid(9));
    let h = other.halfedges().last().expect("a half-edge");
    assert!(mesh.get_k_ring(v, 2).is_none() && mesh.get_face_ring(f, 2).is_none());
    assert!(mesh.get_edge_loop(h).is_none() && mesh.get_edge_ring(h).is_none());
    assert!(mesh.get_grow_region(f, |_| true).is_none() && mesh.get_smooth_region(f, 1.0).is_none());
    assert!(mesh.get_region_boundary([f]).is_none() && mesh.get_dihedral_angle(e).is_none());
    let live = mesh.faces().next().expect("a face");
    assert!(mesh.get_face_ring(live, 1).is_some_and(|ring| ring.eq(mesh.face_ring(live, 1))));
    assert_eq!(mesh.get_region_boundary([live]), Some(mesh.region_boundary([live])));
}

#[test]
#[should_panic(expected = "names no live element")]
fn a_dead_face_in_a_region_panics_as_documented() {
    mesh(&cube()).region_boundary([FaceKey::default()]);
}

/// Grids with holes, tori and spheres, of random size, with random heights.
fn surfaces() -> impl Strategy<Value = Mesh> {
    let base = prop_oneof![
        (1u32..7, 1u32..7, any::<u64>()).prop_map(|(n, m, seed)| {
            let (all, mut noise) = (quads(n, m), Noise(seed));
            // A face may go where no vertex is left with two fans: the builder says.
            let mut faces: Vec<Vec<u32>> = all.polygons().iter().map(<[u32]>::to_vec).collect();
            for _ in 0..n * m / 3 {
                let at = noise.below(faces.len() as u32) as usize;
                let mut fewer = faces.clone();
                fewer.swap_remove(at);
                if Mesh::build(&pool(all.positions().to_vec(), fewer.clone())).is_ok() {
                    faces = fewer;
                }
            }
            pool(all.positions().to_vec(), faces)
        }),
        (3u32..8, 3u32..8).prop_map(|(n, m)| torus(n, m)),
        (3u32..9).prop_map(cylinder),
        (0u32..2).prop_map(icosphere),
        (1u32..5).prop_map(grid),
    ];
    (base, 0.0..1.0f64, any::<u64>()).prop_map(|(base, height, seed)| {
        let mut noise = Noise(seed);
        let mut offset = || dvec3(noise.unit(), noise.unit(), noise.unit()) * height;
        let points = base.positions().iter().map(|&p| p + offset()).collect();
        mesh(&pool(points, base.polygons().iter().map(<[u32]>::to_vec).collect()))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1_000))]

    #[test]
    fn traversals_of_any_surface_equal_their_naive_twins(
        mesh in surfaces(), a in any::<prop::sample::Index>(), b in any::<prop::sample::Index>(), k in 0u32..6,
        angle in 0.0..2.0f64, boundary in any::<bool>(),
    ) {
        let (v, f): (Vec<_>, Vec<_>) = (mesh.vertices().collect(), mesh.faces().collect());
        let (a, b) = (v[a.index(v.len())], v[b.index(v.len())]);
        check_rings(mesh.k_ring(a, k).collect(), &naive_distances(&vertex_pairs(&mesh, |_| 1.0), a), k);
        check_path(&mesh, a, b, |h| length(&mesh, h));
        check_features(&mesh, FeatureOptions { angle, boundary });
        let mut seen = BTreeSet::new();
        for &f in &f {
            let region: Vec<_> = mesh.smooth_region(f, angle).collect();
            if seen.insert(*region.iter().min().expect("a face")) {
                let loops = mesh.region_boundary(region.iter().copied());
                let sharp: BTreeSet<_> = mesh.feature_edges(FeatureOptions { angle, boundary: true }).collect();
                prop_assert!(loops.iter().flatten().all(|&h| sharp.contains(&mesh.edge(h))));
            }
        }
    }

    #[test]
    fn reversing_a_component_twice_is_the_identity_and_leaves_the_others_alone(
        one in surfaces(), two in surfaces(), pick in any::<prop::sample::Index>(),
    ) {
        let both = shapes::both(&one.to_indexed(), &two.to_indexed());
        let mut mesh = shapes::mesh(&both);
        let faces: Vec<_> = mesh.faces().collect();
        let f = faces[pick.index(faces.len())];
        let links = |m: &Mesh| {
            let steps = m.halfedges().map(|h| (h, m.next(h), m.prev(h), m.origin(h), m.face(h)));
            let starts = m.vertices().map(|v| (v, m.vertex_halfedge(v)));
            let faces = m.faces().map(|f| (f, m.face_halfedge(f)));
            (steps.collect::<Vec<_>>(), starts.collect::<Vec<_>>(), faces.collect::<Vec<_>>())
        };
        let before = links(&mesh);
        let component: BTreeSet<FaceKey> = mesh.face_ring(f, u32::MAX).map(|(f, _)| f).collect();
        mesh.reverse_component(f).expect("live");
        prop_assert_eq!(mesh.validate(), Ok(()));
        let between = links(&mesh);
        for (old, new) in before.0.iter().zip(&between.0) {
            let face = old.4.or(before.0.iter().find(|s| s.0 == mesh.twin(old.0)).and_then(|s| s.4));
            let reversed = component.contains(&face.expect("an edge has a face"));
            let expected = if reversed { (old.0, old.2, old.1, mesh.origin(old.0), old.4) } else { *old };
            prop_assert_eq!(*new, expected);
            prop_assert_eq!(new.3 != old.3, reversed);
        }
        for (f, corners) in faces.iter().zip(both.polygons().iter()) {
            let mut expected = corners.to_vec();
            if component.contains(f) {
                expected[1..].reverse();
            }
            let number: BTreeMap<_, _> = mesh.vertices().zip(0u32..).collect();
            prop_assert!(mesh.face_vertices(*f).map(|v| number[&v]).eq(expected));
        }
        mesh.reverse_component(f).expect("live");
        prop_assert_eq!(links(&mesh), before);
    }
}
