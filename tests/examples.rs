//! The examples do what they say.

#[path = "../examples/boundary_loops.rs"]
mod boundary_loops;
#[path = "../examples/clean_import.rs"]
mod clean_import;
#[path = "../examples/make_sample.rs"]
mod make_sample;
#[path = "../examples/one_ring.rs"]
mod one_ring;
#[path = "../examples/probe_part.rs"]
mod probe_part;

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
fn probe_part_measures_the_bracket_from_all_sides() {
    let probe = probe_part::run(sample()).expect("runs");
    assert!((probe.mass.volume - 20.0 * (40.0 * 6.0 + 6.0 * 24.0 + 8.0 * 8.0)).abs() < 1e-9);
    let walls: Vec<f64> = probe.walls.iter().map(|w| w.thickness).collect();
    assert!(walls.len() == 2 && (walls[0] - 6.0).abs() < 1e-9 && (walls[1] - 8.0).abs() < 1e-9, "{walls:?}");
    assert_eq!(probe.walls[0].at.x, 0.0);
    assert!(probe.clearance > 0.0 && !probe.is_inside);
}
