//! Every model of the corpus.

use super::*;
use meshwright::SliverObstacle;
use meshwright::cleanup::{CleanOptions, clean};
use std::collections::BTreeMap;
use std::time::Instant;

#[test]
fn models_of_the_corpus_stay_valid_and_what_is_left_is_named() {
    let left = on_models(400_000, |mesh| mesh.propose_sliver_tolerance());
    // Triangles without area that are a whole component each.
    assert!(left.keys().all(|&o| o == SliverObstacle::WholeComponent), "{left:?}");
}

#[test]
fn a_tolerance_far_too_large_does_models_of_the_corpus_no_harm() {
    for share in [1e-6, 1e-4, 1e-2] {
        on_models(30_000, |mesh| mesh.bounds().map_or(0.0, |b| b.min.distance(b.max) * share));
    }
}

/// Why slivers are left in models of less than so many faces, and how many.
fn on_models(faces: i64, tolerance: impl Fn(&Mesh) -> f64) -> BTreeMap<SliverObstacle, usize> {
    let Some(rows) = corpus::rows() else { return BTreeMap::new() };
    let (mut found, mut left, mut whole) = (0, BTreeMap::new(), 0);
    for row in rows.iter().filter(|r| r.is_readable() && r.count("faces") < faces) {
        let Ok(soup) = row.load() else { continue };
        let mut mesh = clean(&soup, CleanOptions::default()).expect("a soup is never refused").value;
        let (before, was_closed) = (facts(&mesh), mesh.is_closed());
        let tolerance = tolerance(&mesh);
        let start = Instant::now();
        let account = mesh.resolve_slivers(SliverOptions::new(tolerance)).expect("a good tolerance");
        let took = start.elapsed().as_secs_f64();
        assert!(took < 10.0, "{}: {took} s", row.path);
        if account.found == 0 {
            continue;
        }
        whole += 1;
        assert_eq!(mesh.validate(), Ok(()), "{}", row.path);
        assert_eq!((facts(&mesh), mesh.is_closed()), (before, was_closed), "{}", row.path);
        assert_eq!(
            account.found + account.arose,
            account.resolved.len() + account.left.len(),
            "{}",
            row.path
        );
        assert_eq!(mesh.slivers(tolerance).len(), account.left.len(), "{}", row.path);
        found += account.found;
        let mut reasons = BTreeMap::new();
        for l in &account.left {
            *reasons.entry(l.obstacle).or_insert(0) += 1;
            *left.entry(l.obstacle).or_insert(0) += 1;
        }
        println!(
            "{}: {} found, {} arose, {} left {reasons:?}, {} splits, moved {:.1e} of {tolerance:.1e}, {took:.3} s",
            row.path,
            account.found,
            account.arose,
            account.left.len(),
            account.splits,
            account.moved
        );
    }
    println!("{whole} models with {found} slivers; left: {left:?}");
    left
}
