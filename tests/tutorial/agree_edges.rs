//! The tutorial's loops over edges beside ours: naked edges, unify, collapse.

use crate::naive::{self, Plain};
use crate::shapes::{self, Noise};
use crate::{by_place, manifolds, models, soups, welded};
use meshwright::{CollapseError, IndexedMesh, Mesh, unify_winding};
use proptest::prelude::*;
use std::collections::BTreeSet;

fn sorted(edges: impl Iterator<Item = [u32; 2]>) -> BTreeSet<[u32; 2]> {
    edges.map(|[a, b]| [a.min(b), a.max(b)]).collect()
}

/// Naked edges by the pool's facts, strung in loops and chains, and by the mesh if it is one.
fn naked_alike(name: &str, pool: &IndexedMesh) {
    let theirs = naive::naked_edges(&Plain::from(pool));
    let topology = pool.topology();
    assert_eq!(sorted(topology.boundary_edges().map(|e| e.vertices())), theirs, "{name}");
    let naked = topology.naked_edges();
    let loops = naked.loops.iter().flat_map(|l| (0..l.len()).map(|i| [l[i], l[(i + 1) % l.len()]]));
    let chains = naked.chains.iter().flat_map(|c| c.windows(2).map(|w| [w[0], w[1]]));
    assert_eq!(sorted(loops.chain(chains)), theirs, "{name}");
    if let Ok(mesh) = Mesh::build(pool) {
        let vertices: Vec<_> = mesh.vertices().collect();
        let number = |v| vertices.binary_search(&v).expect("a vertex") as u32;
        let open = mesh.boundary_halfedges().map(|h| [mesh.origin(h), mesh.target(h)].map(number));
        assert_eq!(sorted(open), theirs, "{name}");
    }
}

#[test]
fn naked_edges_are_those_of_the_tutorials_loop_on_shapes_and_models() {
    let odd = [
        ("fins", shapes::fins()),
        ("bow tie", shapes::bow_tie()),
        ("moebius", shapes::moebius(7)),
        ("edge", welded(&shapes::soup(&shapes::cubes_at_an_edge()))),
    ];
    let odd = odd.map(|(name, pool)| (name.to_owned(), pool));
    for (name, pool) in manifolds().into_iter().chain(odd) {
        naked_alike(&name, &pool);
    }
    for (name, soup) in soups(400) {
        naked_alike(&name, &welded(&soup));
    }
}

/// Both make all windings agree; in each part all faces are wound as the loop has them, or none.
fn unified_alike(name: &str, pool: &IndexedMesh) {
    let theirs = naive::unify(&Plain::from(pool)).pool();
    let ours = unify_winding(&pool.topology()).expect("orientable").value;
    assert!(theirs.topology().is_oriented() && ours.topology().is_oriented(), "{name}");
    let (part_of, parts) = pool.topology().components();
    let mut relation: Vec<Option<bool>> = vec![None; parts];
    for ((f, ours), theirs) in ours.polygons().iter().enumerate().zip(theirs.polygons().iter()) {
        let at = theirs.iter().position(|v| *v == ours[0]).expect("the same corners");
        let same = theirs[(at + 1) % theirs.len()] == ours[1];
        let of_part = &mut relation[part_of[f] as usize];
        assert_eq!(*of_part.get_or_insert(same), same, "{name}: face {f}");
    }
}

#[test]
fn unify_is_the_tutorials_breadth_first_walk_on_shapes_and_models() {
    for (name, pool) in manifolds() {
        for seed in 0..4 {
            unified_alike(&name, &shapes::some_reversed(&pool, 3, seed));
        }
    }
    let mut walked = 0;
    for (name, soup) in soups(300) {
        let pool = welded(&soup);
        let topology = pool.topology();
        if topology.is_edge_manifold() && topology.orientable().is_ok() {
            unified_alike(&name, &shapes::some_reversed(&pool, 2, walked));
            walked += 1;
        }
    }
    eprintln!("{walked} models");
}

/// How many parts, loops and vertices beside faces: what a collapse must not change but by one vertex.
fn counts(mesh: &Mesh) -> (usize, usize, i64) {
    (mesh.components().len(), mesh.boundary_loops().len(), mesh.euler_characteristic())
}

/// Wherever ours collapses an edge it gives the loop's faces; wherever it refuses, these are no mesh of the same kind.
fn collapsed_alike(name: &str, mesh: &Mesh, most: usize) -> [usize; 2] {
    let plain = Plain::from(&mesh.to_indexed());
    let vertices: Vec<_> = mesh.vertices().collect();
    let number = |v| vertices.binary_search(&v).expect("a vertex") as u32;
    let mut done = [0, 0];
    for e in mesh.edges().take(most) {
        let h = mesh.edge_halfedge(e);
        let [drop, keep] = [mesh.origin(h), mesh.target(h)].map(number);
        let theirs = naive::collapse(&plain, keep, drop);
        let mut ours = mesh.clone();
        match ours.collapse_to_midpoint(h) {
            Ok(_) => {
                assert_eq!(ours.validate(), Ok(()), "{name}");
                assert_eq!(by_place(&Plain::from(&ours.to_indexed())), by_place(&theirs), "{name}: {e:?}");
                assert_eq!(counts(&ours), counts(mesh), "{name}");
                done[0] += 1;
            }
            Err(error) => {
                assert!(!matches!(error, CollapseError::Missing(_)), "{name}: {error}");
                assert_eq!(Plain::from(&ours.to_indexed()), plain, "{name}: a refusal changes nothing");
                let is_same = |pool: IndexedMesh| {
                    // The vertex that went is left in the list, in no face.
                    let isolated = pool.topology().isolated_vertices().len();
                    let before = mesh.vertices().filter(|&v| mesh.is_isolated(v)).count();
                    let built = Mesh::build(&pool).ok();
                    built.is_some_and(|m| isolated == before + 1 && counts(&m) == counts(mesh))
                };
                assert!(!is_same(theirs.pool()), "{name}: {error}");
                done[1] += 1;
            }
        }
    }
    done
}

#[test]
fn collapse_to_the_midpoint_is_the_tutorials_on_shapes_and_models() {
    let mut sum = [0, 0];
    let named = manifolds().into_iter().map(|(name, pool)| (name, shapes::mesh(&pool)));
    for (name, mesh) in named.chain(models(200)) {
        let done = collapsed_alike(&name, &mesh, 60);
        sum = [sum[0] + done[0], sum[1] + done[1]];
    }
    // What the generated shapes alone come to.
    assert!(sum[0] > 100 && sum[1] >= 10, "{sum:?}");
}

proptest! {
    #[test]
    fn loops_over_edges_agree_on_any_orientable_surface(seed in any::<u64>(), n in 2u32..6, gone in 0u32..4) {
        let mut noise = Noise(seed);
        let mut plain = Plain::from(&if gone % 2 == 0 { shapes::grid(n) } else { shapes::torus(n + 1, 4) });
        plain.faces.retain(|_| noise.below(8) >= gone);
        let pool = plain.pool();
        naked_alike("any", &pool);
        unified_alike("any", &shapes::some_reversed(&pool, 2, seed));
        if let Ok(mesh) = Mesh::build(&pool) {
            collapsed_alike("any", &mesh, 12);
        }
    }
}
