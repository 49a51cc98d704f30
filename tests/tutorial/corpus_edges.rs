//! Rows about what a mesh is, on the corpus: the vertex pool, naked edges, winding, inside and outside.

use crate::shapes;
use crate::{assert_met, few, reach, soups, welded};
use meshwright::{
    IndexedDefect, IndexedMesh, Mesh, OutwardOptions, PolygonSoup, Polygons, orient_outward, unify_winding,
};
use std::collections::BTreeSet;

/// Every defect of a soup, counted by hand: positions, short faces, corners out of range, corners that repeat one.
fn defects(soup: &PolygonSoup) -> [usize; 4] {
    let mut found = [soup.positions.iter().filter(|p| !p.is_finite()).count(), 0, 0, 0];
    for face in soup.polygons.iter() {
        found[1] += usize::from(face.len() < 3);
        found[2] += face.iter().filter(|&&v| v as usize >= soup.positions.len()).count();
        found[3] += (1..face.len()).filter(|&i| face[..i].contains(&face[i])).count();
    }
    found
}

#[test]
fn files_of_the_corpus_become_pools_or_list_exactly_their_defects() {
    let (mut pools, mut refused) = (0, 0);
    for (name, soup) in soups(1000) {
        let expected = defects(&soup);
        match IndexedMesh::new(soup.positions.clone(), soup.polygons.clone()) {
            Ok(pool) => {
                assert_eq!(expected, [0; 4], "{name}");
                assert_eq!(pool.face_count(), soup.polygons.len(), "{name}");
                pools += 1;
            }
            Err(error) => {
                let mut listed = [0; 4];
                for defect in &error.defects {
                    match defect {
                        IndexedDefect::NonFinitePosition { vertex } => {
                            assert!(!soup.positions[*vertex as usize].is_finite(), "{name}");
                            listed[0] += 1;
                        }
                        IndexedDefect::TooFewCorners { .. } => listed[1] += 1,
                        IndexedDefect::IndexOutOfRange { face, corner, index } => {
                            assert_eq!(soup.polygons[*face as usize][*corner as usize], *index, "{name}");
                            listed[2] += 1;
                        }
                        IndexedDefect::RepeatedCorner { face, corner, vertex } => {
                            assert_eq!(soup.polygons[*face as usize][*corner as usize], *vertex, "{name}");
                            listed[3] += 1;
                        }
                        other => panic!("{name}: {other}"),
                    }
                }
                // A corner out of range is not told again as one that repeats another.
                let repeats_missing = listed[3] <= expected[3] && listed[2] > 0;
                assert!(
                    listed == expected || listed[..3] == expected[..3] && repeats_missing,
                    "{name}: {listed:?} {expected:?}"
                );
                refused += 1;
            }
        }
    }
    assert_met(pools, 120);
    assert_met(refused, 10);
}

#[test]
fn triangles_of_models_stated_as_quads_with_the_last_corner_twice_are_triangles() {
    let mut met = 0;
    for (name, mesh) in
        few().iter().filter(|(_, mesh)| mesh.faces().all(|f| [3, 4].contains(&mesh.degree(f))))
    {
        let pool = mesh.to_indexed();
        let quad = |f: &[u32]| [f[0], f[1], f[2], *f.last().expect("a corner")];
        let quads: Vec<[u32; 4]> = pool.polygons().iter().map(quad).collect();
        assert!(Polygons::from_quads(&quads) == *pool.polygons(), "{name}");
        let again = IndexedMesh::from_quads(pool.positions().to_vec(), &quads).expect("a pool");
        let again = Mesh::build(&again).expect("a manifold");
        assert_eq!((again.edge_count(), again.is_closed()), (mesh.edge_count(), mesh.is_closed()), "{name}");
        // Isolated vertices keep their place.
        assert!(again.to_indexed().positions() == pool.positions(), "{name}");
        met += 1;
    }
    assert_met(met, 100);
}

#[test]
fn around_pinched_vertices_of_the_corpus_naked_loops_go_apart() {
    let (mut pinched, mut shared) = (0, 0);
    for (name, soup) in soups(3000) {
        let pool = welded(&soup);
        let topology = pool.topology();
        let naked = topology.naked_edges();
        // Loops and chains pass a vertex once for each of its fans that is open.
        for (v, _) in topology.pinched_vertices() {
            let open = topology.boundary_edges().filter(|e| e.vertices().contains(&v)).count();
            let through = naked.loops.iter().flatten().filter(|&&w| w == v).count();
            let ending = naked.chains.iter().filter(|c| c.first() == Some(&v)).count()
                + naked.chains.iter().filter(|c| c.last() == Some(&v)).count();
            let inner = naked.chains.iter().flat_map(|c| &c[1..c.len() - 1]).filter(|&&w| w == v).count();
            assert_eq!(2 * (through + inner) + ending, open, "{name}: vertex {v}");
            pinched += 1;
        }
        // Edges with more faces are never naked, and chains end at them.
        let more: BTreeSet<[u32; 2]> = topology.nonmanifold_edges().map(|e| e.vertices()).collect();
        assert!(topology.boundary_edges().all(|e| !more.contains(&e.vertices())), "{name}");
        assert!(topology.nonmanifold_edges().all(|e| e.faces().count() > 2), "{name}");
        for c in &naked.chains {
            let at_more = |v: &u32| more.iter().any(|e| e.contains(v));
            assert!(at_more(&c[0]) && c.last().is_some_and(at_more), "{name}: {c:?}");
        }
        shared += more.len();
    }
    eprintln!("{pinched} {shared}");
    assert_met(pinched, 20);
    assert_met(shared, 20);
}

#[test]
fn unify_gives_models_back_never_crosses_three_faces_and_shows_a_cycle_where_it_cannot() {
    let (mut back, mut crossing, mut one_sided) = (0, 0, 0);
    for (name, soup) in soups(1000) {
        let pool = welded(&soup);
        let topology = pool.topology();
        match unify_winding(&topology) {
            Ok(unified) => {
                assert!(unified.value.topology().conflicting_edges().next().is_none(), "{name}");
                crossing += usize::from(!topology.is_edge_manifold());
                if topology.is_oriented() && pool.face_count() > 0 {
                    assert!(unified.value == pool && unified.report.is_empty(), "{name}");
                    // One face of every part with more than two is reversed: the larger piece keeps its winding.
                    let (part_of, parts) = topology.components();
                    let mut sizes = vec![0; parts];
                    part_of.iter().for_each(|&p| sizes[p as usize] += 1);
                    let mut seen = vec![false; parts];
                    let mut polygons = pool.polygons().clone();
                    let mut reversed = 0;
                    for (f, &p) in part_of.iter().enumerate() {
                        if sizes[p as usize] > 2 && !std::mem::replace(&mut seen[p as usize], true) {
                            polygons.reverse(f);
                            reversed += 1;
                        }
                    }
                    let mixed = IndexedMesh::new(pool.positions().to_vec(), polygons).expect("a pool");
                    assert!(
                        reversed == 0 || mixed.topology().volume().is_none(),
                        "{name}: no number for what has none"
                    );
                    let again = unify_winding(&mixed.topology()).expect("orientable");
                    // Taking a face out may leave a larger piece elsewhere; never more is turned than the half.
                    let flipped = again.report.records.len();
                    assert!(again.value.topology().is_oriented(), "{name}");
                    assert!(2 * flipped <= pool.face_count() + reversed, "{name}: {flipped} of {reversed}");
                    back += usize::from(flipped == reversed);
                }
            }
            Err(_) => {
                let error = topology.orientable().expect_err("not orientable");
                for cycle in &error.cycles {
                    // Each face lies beside the next, and the last beside the first.
                    for (i, &f) in cycle.iter().enumerate() {
                        let g = cycle[(i + 1) % cycle.len()];
                        let [f, g] = [f, g].map(|f| &pool.polygons()[f as usize]);
                        assert!(f.iter().filter(|v| g.contains(v)).count() >= 2, "{name}");
                    }
                }
                assert!(!error.cycles.is_empty(), "{name}");
                one_sided += 1;
            }
        }
    }
    eprintln!("{back} {crossing} {one_sided}");
    assert_met(back, 80);
    assert_met(crossing, 10);
    assert_met(one_sided, 2);
}

#[test]
fn open_models_are_turned_only_where_they_are_sure_and_say_how_sure() {
    let (mut sure, mut unsure) = (0, 0);
    for (name, mesh) in few().iter().filter(|(_, mesh)| !mesh.is_closed()) {
        let pool = mesh.to_indexed();
        for pool in [pool.clone(), pool.reversed()] {
            let found = orient_outward(&pool.topology(), OutwardOptions::default()).expect("not cancelled");
            for part in found.parts.iter().filter(|p| !p.closed) {
                assert!((0.0..=1.0).contains(&part.confidence), "{name}");
                assert!(!part.reversed || part.confidence >= 0.5, "{name}: {part:?}");
                if part.confidence < 0.5 {
                    let f = part.face as usize;
                    assert!(found.outcome.value.polygons()[f] == pool.polygons()[f], "{name}: it stays");
                    unsure += 1;
                } else {
                    sure += 1;
                }
            }
            // Only what is said to be reversed is on record.
            let turned: usize = found.parts.iter().filter(|p| p.reversed).map(|p| p.faces).sum();
            assert_eq!(found.outcome.report.records.len(), turned, "{name}");
        }
    }
    eprintln!("{sure} {unsure}");
    assert_met(sure, 20);
    assert_met(unsure, 20);
}

#[test]
fn vertices_of_models_without_faces_are_legal_and_keep_their_place() {
    for (name, mesh) in few() {
        let pool = mesh.to_indexed();
        let mut points = pool.positions().to_vec();
        let place = points.len() / 2;
        points.insert(place, pool.positions()[0] + reach(mesh).0);
        let faces =
            pool.polygons().iter().map(|f| f.iter().map(|&v| v + u32::from(v as usize >= place)).collect());
        let more = shapes::pool(points, faces.collect());
        let built = Mesh::build(&more).expect("a manifold");
        assert!(built.to_indexed() == more && built.validate() == Ok(()), "{name}");
        let alone = built.vertices().nth(place).expect("there");
        assert!(built.is_isolated(alone) && built.is_closed() == mesh.is_closed(), "{name}");
    }
}
