//! Traversal for editors beside naive twins: rings, edge loops, shortest paths, regions, features.

mod chains;
mod features;
mod paths;
mod rings;
#[path = "../shapes/mod.rs"]
mod shapes;

use features::check_features;
use meshwright::glam::{DVec3, dvec3};
use meshwright::{EdgeKey, FaceKey, FeatureOptions, HalfedgeKey, IndexedMesh, Mesh, NormalWeight, VertexKey};
use paths::check_path;
use proptest::prelude::*;
use rings::check_rings;
use shapes::{Noise, cube, grid, icosphere, mesh, pool, tetrahedron, torus};
use std::collections::{BTreeMap, BTreeSet};

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
        degrees in 0.0..115.0f64, boundary in any::<bool>(),
    ) {
        let (v, f): (Vec<_>, Vec<_>) = (mesh.vertices().collect(), mesh.faces().collect());
        let (a, b) = (v[a.index(v.len())], v[b.index(v.len())]);
        check_rings(mesh.k_ring(a, k).collect(), &naive_distances(&vertex_pairs(&mesh, |_| 1.0), a), k);
        check_path(&mesh, a, b, |h| length(&mesh, h));
        check_features(&mesh, FeatureOptions { degrees, boundary });
        let mut seen = BTreeSet::new();
        for &f in &f {
            let region: Vec<_> = mesh.smooth_region(f, degrees).collect();
            if seen.insert(*region.iter().min().expect("a face")) {
                let loops = mesh.region_boundary(region.iter().copied());
                let sharp: BTreeSet<_> = mesh.feature_edges(FeatureOptions { degrees, boundary: true }).collect();
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
        mesh.compute_normals(NormalWeight::Angle);
        let normals: Vec<_> = mesh.vertices().map(|v| mesh.normal(v)).collect();
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
        for (v, old) in mesh.vertices().zip(&normals) {
            let reversed = mesh.faces_around(v).any(|f| component.contains(&f));
            prop_assert_eq!(mesh.normal(v), if reversed { old.map(|n| -n) } else { *old });
        }
        mesh.reverse_component(f).expect("live");
        prop_assert_eq!(links(&mesh), before);
        prop_assert!(mesh.vertices().map(|v| mesh.normal(v)).eq(normals));
    }
}
