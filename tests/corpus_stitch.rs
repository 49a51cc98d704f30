//! Stitching of every open corpus file, with the tolerance proposed for it.

mod corpus;

use corpus::rows;
use meshwright::IndexedMesh;
use meshwright::cleanup::{Weld, propose_tolerance_with_reasons, stitch};
use std::time::Instant;

/// Naked edges, edges of three or more faces, and how long the naked edges are in all.
fn facts(pool: &IndexedMesh) -> (usize, usize, f64) {
    let topology = pool.topology();
    let at = |v: u32| pool.positions()[v as usize];
    let length = topology.boundary_edges().map(|e| e.vertices()).map(|[a, b]| at(a).distance(at(b))).sum();
    (topology.boundary_edges().count(), topology.nonmanifold_edges().count(), length)
}

#[test]
fn open_files_lose_boundary_and_closed_files_stay_as_they_are() {
    let Some(rows) = rows() else { return };
    let mut changed = 0;
    for row in rows.iter().filter(|r| r.is_readable() && r.count("faces") < 300_000) {
        let Ok(soup) = row.load() else { continue };
        let start = Instant::now();
        let proposed = propose_tolerance_with_reasons(&soup);
        let welded = stitch(&soup, Weld::Exact, 0.0).expect("never refused").value;
        let (naked, more, length) = facts(&welded);
        let path = &row.path;
        assert!(proposed.naked_after <= proposed.naked_before, "{path}");
        if naked == 0 {
            assert_eq!(proposed.tolerance, 0.0, "{path}");
        }
        let largest =
            soup.positions.iter().filter(|p| p.is_finite()).fold(0.0f64, |m, p| m.max(p.abs().max_element()));
        let tolerance = proposed.reach.max(largest * 4.0 / f64::from(1 << 24));
        if !tolerance.is_finite() {
            continue;
        }
        let stitched = stitch(&soup, Weld::Exact, tolerance).expect("never refused");
        let (naked_after, more_after, length_after) = facts(&stitched.value);
        let step = stitched.report.steps.last().expect("a step");
        assert_eq!(step.changed == 0, stitched.value == welded, "{path}");
        assert!(step.moved <= tolerance, "{path}");
        assert!(more_after <= more, "{path}: {more} {more_after}");
        if step.changed > 0 {
            changed += 1;
            assert!(length_after < length, "{path}: {length} {length_after}");
            assert!(naked_after <= naked, "{path}: {naked} {naked_after}");
        }
        if proposed.tolerance > 0.0 || step.changed > 0 {
            println!(
                "{path}: {proposed:?}, stitched {} of {naked} naked edges to {naked_after}",
                step.changed
            );
        }
        assert!(start.elapsed().as_secs() < 30, "{path}: {:?}", start.elapsed());
    }
    println!("{changed} files stitched");
}
