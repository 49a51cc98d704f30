//! The examples do what they say.

#[path = "../examples/boundary_loops.rs"]
mod boundary_loops;
#[path = "../examples/build_a_box.rs"]
mod build_a_box;
#[path = "../examples/carry_uv.rs"]
mod carry_uv;
#[path = "../examples/clean_import.rs"]
mod clean_import;
#[path = "../examples/collapse_short_edges.rs"]
mod collapse_short_edges;
#[path = "../examples/level_of_detail.rs"]
mod level_of_detail;
#[path = "../examples/make_sample.rs"]
mod make_sample;
#[path = "../examples/one_ring.rs"]
mod one_ring;
#[path = "../examples/poke_and_flip.rs"]
mod poke_and_flip;
#[path = "../examples/probe_part.rs"]
mod probe_part;
#[path = "../examples/select_features.rs"]
mod select_features;
#[path = "../examples/undo.rs"]
mod undo;

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
fn build_a_box_is_closed_and_weighs_what_it_should() {
    let mesh = build_a_box::run([2.0, 3.0, 4.0]).expect("runs");
    mesh.validate().expect("valid");
    let closed = mesh.closed().expect("closed");
    assert_eq!((closed.volume(), closed.area()), (24.0, 52.0));
}

#[test]
fn collapse_short_edges_keeps_the_tube_open() {
    let mut mesh = collapse_short_edges::tube().expect("builds");
    let account = collapse_short_edges::collapse_shorter_than(&mut mesh, 0.5);
    mesh.validate().expect("valid");
    assert!(account.collapsed > 20, "{account:?}");
    assert_eq!((mesh.boundary_loops().len(), mesh.euler_characteristic()), (2, 0));
    // However long: what would close the tube is refused.
    let account = collapse_short_edges::collapse_shorter_than(&mut mesh, 100.0);
    assert_eq!((mesh.boundary_loops().len(), mesh.euler_characteristic()), (2, 0));
    assert!(account.refused.contains_key("would close a tunnel or a hole"), "{account:?}");
}

#[test]
fn poke_and_flip_refines_a_region_and_nothing_else() {
    let (mut mesh, region) = poke_and_flip::sheet().expect("builds");
    let (before, area) = (mesh.face_count(), mesh.to_indexed().area());
    let (poked, flipped) = poke_and_flip::refine(&mut mesh, &region).expect("runs");
    mesh.validate().expect("valid");
    assert_eq!((poked, mesh.face_count()), (region.len(), before + 2 * region.len()));
    assert!(flipped > poked && (mesh.to_indexed().area() - area).abs() < 1e-9);
}

#[test]
fn carry_uv_keeps_both_sides_of_the_seam() {
    let values = carry_uv::run().expect("runs");
    assert_eq!(values.iter().map(|v| v.to_array()).collect::<Vec<_>>(), [[1.0, 0.5], [1.0, 5.5]]);
}

#[test]
fn undo_goes_back_and_forth() {
    let mut editor = undo::Editor::new(undo::triangle().expect("builds"));
    for faces in [3, 5, 7] {
        editor.apply(Box::new(undo::poke)).expect("a face");
        assert_eq!(editor.mesh.face_count(), faces);
    }
    let after = editor.mesh.to_indexed();
    editor.undo().expect("three steps");
    editor.undo().expect("two steps");
    assert_eq!(editor.mesh.face_count(), 3);
    assert!(editor.apply(Box::new(|_| Err("refused".into()))).is_err());
    assert_eq!(editor.mesh.face_count(), 3);
    editor.undo().expect("one step");
    assert_eq!((editor.mesh.face_count(), editor.undo().is_err()), (1, true));
    editor.redo().expect("to be done again");
    assert_eq!(editor.mesh.face_count(), 3);
    editor.apply(Box::new(undo::poke)).expect("a face");
    editor.apply(Box::new(undo::poke)).expect("a face");
    assert_eq!(editor.mesh.to_indexed(), after);
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
