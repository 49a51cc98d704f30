//! The examples do what they say.

#[path = "../examples/boundary_loops.rs"]
mod boundary_loops;
#[path = "../examples/clean_import.rs"]
mod clean_import;
#[path = "../examples/level_of_detail.rs"]
mod level_of_detail;
#[path = "../examples/make_sample.rs"]
mod make_sample;
#[path = "../examples/one_ring.rs"]
mod one_ring;
#[path = "../examples/select_features.rs"]
mod select_features;

use std::path::Path;

fn sample() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/broken_bracket.obj"))
}

#[test]
fn the_sample_is_what_the_generator_makes() {
    assert_eq!(std::fs::read_to_string(sample()).expect("the sample"), make_sample::sample());
}

#[test]
fn one_ring_measures_every_vertex_against_its_neighbours() {
    let distances = one_ring::run().expect("runs");
    assert_eq!(distances.len(), 5);
    assert!((distances[4] - 1.0).abs() < 1e-12);
}

#[test]
fn boundary_loops_finds_the_outline_and_the_hole() {
    let mut lengths = boundary_loops::run().expect("runs");
    lengths.sort_by(f64::total_cmp);
    assert_eq!(lengths, [4.0, 12.0]);
}

#[test]
fn select_features_finds_the_creases_and_the_walls_of_the_rounded_block() {
    let found = select_features::run().expect("runs");
    assert_eq!(found.paths.len(), 9, "three upright edges, and three stretches of either rim");
    let total: f64 = found.paths.iter().map(|p| p.length).sum();
    let rim = 2.0 * (40.0 + 20.0) - 2.0 * 8.0 + found.arc;
    assert!((total - 2.0 * rim - 3.0 * 10.0).abs() < 1e-9, "{total}");
    assert_eq!(found.walls, [1, 1, 10, 1, 1], "the rounded corner joins two sides");
}

#[test]
fn clean_import_makes_the_broken_bracket_two_solids_and_tells_why() {
    let (mesh, account) = clean_import::run(sample()).expect("runs");
    assert_eq!(mesh.components().len(), 2);
    let area = 40.0 * 6.0 + 6.0 * 24.0 + 8.0 * 8.0;
    let volume = mesh.closed().expect("closed").volume();
    assert!((volume - 20.0 * area).abs() < 1e-9, "{volume}");
    for kind in
        ["flipped_face", "duplicate_face", "degenerate_face", "non_finite_vertex", "out_of_range_face"]
    {
        assert!(account.iter().any(|line| line.contains(kind)), "{kind}: {account:#?}");
    }
}

#[test]
fn level_of_detail_gives_three_levels_that_lose_little() {
    let levels = level_of_detail::run().expect("runs");
    let faces: Vec<usize> = levels.iter().map(|l| l.mesh.face_count()).collect();
    assert_eq!(faces, [4000, 1000, 250]);
    for (level, bound) in levels.iter().zip([1e-3, 4e-3, 2e-2]) {
        assert_eq!(level.stopped, meshwright::Stopped::Target);
        assert!(level.error > 0.0 && level.error < bound, "{}", level.error);
        assert!(level.volume.abs() < 0.02, "{}", level.volume);
        assert_eq!(level.mesh.components().len(), 1);
    }
    assert!(levels.is_sorted_by(|a, b| a.error < b.error));
}
