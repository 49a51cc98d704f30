//! Rings, regions and their boundaries.

use crate::shapes::{Noise, cube, mesh, torus};
use crate::{all, cylinder, naive_distances, quads, vertex_pairs};
use meshwright::{EdgeKey, FaceKey, FeatureOptions, Mesh};
use std::collections::{BTreeMap, BTreeSet};

fn face_pairs(mesh: &Mesh) -> Vec<(FaceKey, FaceKey, f64)> {
    let pair = |h| Some((mesh.face(h)?, mesh.face(mesh.twin(h))?, 1.0));
    mesh.halfedges().filter_map(pair).collect()
}

pub(crate) fn check_rings<K: Ord + Copy + std::fmt::Debug>(
    ring: Vec<(K, u32)>,
    far: &BTreeMap<K, f64>,
    k: u32,
) {
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
        for degrees in [12.0, 60.0, 90.0 - 1e-4, f64::NAN] {
            let sharp: BTreeSet<_> =
                mesh.feature_edges(FeatureOptions { degrees, boundary: false }).collect();
            for f in mesh.faces() {
                let expected = mesh.grow_region(f, |h| !sharp.contains(&mesh.edge(h)));
                assert!(mesh.smooth_region(f, degrees).eq(expected));
            }
        }
    }
    let mesh = mesh(&cylinder(12));
    let sizes: Vec<_> = mesh.faces().map(|f| mesh.smooth_region(f, 60.0).count()).collect();
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
#[should_panic(expected = "names no live element")]
fn a_dead_face_in_a_region_panics_as_documented() {
    mesh(&cube()).region_boundary([FaceKey::default()]);
}
