//! Operators on every closed model of the corpus under 20,000 faces.

mod corpus;
mod shapes;

use corpus::{Row, rows};
use meshwright::cleanup::{CleanOptions, clean};
use meshwright::{EdgeKey, Mesh};
use shapes::Noise;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The closed models, on two threads.
fn on_closed_models(test: impl Fn(Mesh, &str) + Sync) {
    let Some(rows) = rows() else { return };
    let small =
        |r: &Row| r.is_readable() && r.get("closed") == "yes" && (1..20_000).contains(&r.count("faces"));
    let rows: Vec<Row> = rows.into_iter().filter(small).collect();
    let (next, met) = (AtomicUsize::new(0), AtomicUsize::new(0));
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some(row) = rows.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let Ok(soup) = row.load() else { continue };
                    let mesh = clean(&soup, CleanOptions::default()).expect("a soup is never refused").value;
                    if mesh.is_closed() && mesh.face_count() < 20_000 {
                        met.fetch_add(1, Ordering::Relaxed);
                        test(mesh, &row.path);
                    }
                }
            });
        }
    });
    assert!(met.into_inner() > 50, "the corpus has more closed models");
}

/// Euler characteristic and number of faces of each component, in order.
fn parts(mesh: &Mesh) -> Vec<i64> {
    let mut all: Vec<i64> = mesh
        .components()
        .iter()
        .map(|faces| {
            let corners = faces.iter().map(|&f| mesh.degree(f) as i64).sum::<i64>();
            let mut vertices: Vec<_> = faces.iter().flat_map(|&f| mesh.face_vertices(f)).collect();
            vertices.sort_unstable();
            vertices.dedup();
            vertices.len() as i64 - corners / 2 + faces.len() as i64
        })
        .collect();
    all.sort_unstable();
    all
}

#[test]
fn collapse_to_exhaustion_keeps_the_genus_of_every_part() {
    on_closed_models(|mut mesh, path| {
        let before = parts(&mesh);
        let mut noise = Noise(mesh.face_count() as u64);
        loop {
            let mut edges: Vec<EdgeKey> = mesh.edges().collect();
            (1..edges.len()).rev().for_each(|i| edges.swap(i, noise.below(i as u32 + 1) as usize));
            let mut done = 0;
            for e in edges {
                if let Some(h) = mesh.get_edge_halfedge(e)
                    && mesh.collapse_to_midpoint(h).is_ok()
                {
                    done += 1;
                }
            }
            if done == 0 {
                break;
            }
        }
        assert_eq!(mesh.validate(), Ok(()), "{path}");
        assert_eq!(mesh.violations(), [], "{path}");
        assert_eq!(parts(&mesh), before, "{path}");
        assert!(mesh.is_closed(), "{path}");
        // A sphere of triangles ends as a tetrahedron.
        if before == [2] && mesh.faces().all(|f| mesh.degree(f) == 3) {
            assert_eq!(mesh.face_count(), 4, "{path}");
        }
    });
}

#[test]
fn random_flips_keep_everything_but_edges() {
    on_closed_models(|mut mesh, path| {
        let facts = |m: &Mesh| {
            let degrees: Vec<usize> = m.faces().map(|f| m.degree(f)).collect();
            let keys = (
                m.vertices().collect::<Vec<_>>(),
                m.edges().collect::<Vec<_>>(),
                m.faces().collect::<Vec<_>>(),
            );
            (keys, degrees, m.is_closed(), parts(m))
        };
        let before = facts(&mesh);
        let edges: Vec<EdgeKey> = mesh.edges().collect();
        let mut noise = Noise(edges.len() as u64);
        let mut done = 0;
        for _ in 0..10 * edges.len() {
            let e = edges[noise.below(edges.len() as u32) as usize];
            done += usize::from(mesh.flip_edge(e).is_ok());
        }
        assert_eq!(mesh.validate(), Ok(()), "{path}");
        assert_eq!(mesh.violations(), [], "{path}");
        assert_eq!(facts(&mesh), before, "{path}");
        assert!(done > edges.len() || edges.len() < 30, "{path}: {done} flips of {} edges", edges.len());
    });
}
