//! Edge loops and edge rings.

use crate::shapes::{mesh, pool, torus};
use crate::{all, between, cylinder, edges, quads};
use meshwright::glam::dvec3;
use meshwright::{EdgeChain, Mesh};
use std::collections::{BTreeMap, BTreeSet};

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
