//! Random edit scripts over all operators, with the naive twin beside them.

#[path = "drive/edit.rs"]
mod drive;

use arbitrary::{Arbitrary, Unstructured};
use drive::shapes::{Noise, grid, icosphere, torus};
use drive::{Edit, Op, Place, Script, Start, World, run};
use meshwright::glam::{DVec2, DVec3};
use meshwright::{IndexedMesh, Mesh, Rule};
use proptest::prelude::{Just, ProptestConfig, Strategy, any, prop, prop_oneof, proptest};
use std::collections::BTreeMap;

fn places() -> impl Strategy<Value = Place> {
    prop_oneof![
        6 => Just(Place::Mean),
        1 => Just(Place::First),
        2 => Just(Place::Quarter),
        4 => [-8i8..9, -8i8..9, -8i8..9].prop_map(Place::Near),
        1 => prop_oneof![Just(Place::NotANumber), Just(Place::Huge)],
    ]
}

fn edits() -> impl Strategy<Value = Edit> {
    let n = || prop_oneof![30 => 0u16..2000, 1 => 65_000u16..];
    let steps = || prop_oneof![20 => 0u8..12, 1 => 250u8..];
    prop_oneof![
        2 => places().prop_map(Edit::AddVertex),
        4 => (n(), 0u8..8, [n(), n(), n()]).prop_map(|(n, how, others)| Edit::AddFace(n, how, others)),
        1 => n().prop_map(Edit::RemoveVertex),
        2 => n().prop_map(Edit::RemoveEdge),
        2 => n().prop_map(Edit::RemoveFace),
        2 => (n(), places()).prop_map(|(n, p)| Edit::SplitEdge(n, p)),
        2 => (n(), places()).prop_map(|(n, p)| Edit::SplitEdgeAndFaces(n, p)),
        3 => (n(), steps()).prop_map(|(n, s)| Edit::SplitFace(n, s)),
        2 => (n(), places()).prop_map(|(n, p)| Edit::PokeFace(n, p)),
        3 => (n(), steps(), places()).prop_map(|(n, s, p)| Edit::SplitVertex(n, s, p)),
        3 => (n(), places()).prop_map(|(n, p)| Edit::Collapse(n, p)),
        3 => n().prop_map(Edit::CollapseToMidpoint),
        3 => n().prop_map(Edit::CollapseIntoTarget),
        5 => n().prop_map(Edit::FlipEdge),
        4 => n().prop_map(Edit::JoinFaces),
        4 => n().prop_map(Edit::DissolveVertex),
        2 => n().prop_map(Edit::TriangulateFace),
        2 => n().prop_map(Edit::FillHole),
        4 => (n(), n()).prop_map(|(a, b)| Edit::Stitch(a, b)),
        1 => n().prop_map(Edit::ReverseComponent),
        1 => (n(), places()).prop_map(|(n, p)| Edit::Move(n, p)),
        1 => (n(), any::<u8>()).prop_map(|(n, v)| Edit::Paint(n, v)),
        1 => Just(Edit::Checkpoint),
        1 => any::<u8>().prop_map(Edit::Restore),
        1 => prop_oneof![any::<u8>().prop_map(Edit::ForgetBefore), Just(Edit::Forget)],
        1 => prop_oneof![3 => Just(Edit::Record), 1 => Just(Edit::StopRecording)],
    ]
}

fn scripts() -> impl Strategy<Value = Script> {
    (prop::sample::select(Start::ALL.to_vec()), prop::collection::vec(edits(), 1..60))
        .prop_map(|(start, edits)| Script { start, edits })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn every_edit_does_what_its_documentation_says_or_nothing(script in scripts()) {
        run(&script);
    }

    #[test]
    fn any_bytes_drive_edits(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        drive::drive(&bytes);
    }
}

/// Bytes that look random, and are the same on every run.
fn noise_bytes(noise: &mut Noise, count: usize) -> Vec<u8> {
    (0..count).map(|_| noise.below(256) as u8).collect()
}

fn random_edit(noise: &mut Noise, kind: Option<u8>) -> Edit {
    let mut bytes = noise_bytes(noise, 16);
    if let Some(kind) = kind {
        bytes[0] = kind;
    }
    Edit::arbitrary(&mut Unstructured::new(&bytes)).expect("an edit takes any bytes")
}

/// Which starts suit which operator, by the number of its edit. Closed ones give no boundary to work on; those of large
/// faces or few vertices leave little to take away.
fn suitable(kind: u8) -> &'static [Start] {
    use Start::*;
    match kind {
        // Adding a face and filling take a boundary; stitching too, best two, or one that is long and not convex.
        1 | 17 => &[Strip, Fan, Grid, Annulus, Parts, OpenPrism, Pair],
        18 => &[Grid, Annulus, Parts],
        // A vertex is split, a face cut where there are some.
        7 | 16 => &[Quad, Cube, Mixed, Grid, Torus, Genus2, OpenPrism],
        // Taking away takes something that others do not lean on.
        2..=4 => &[Strip, Wheel, Octahedron, Cube, Mixed, Grid, Torus, Genus2],
        10..=12 => &[Octahedron, Cube, Mixed, Grid, Torus, Genus2, Wheel, Strip],
        13..=15 => &[Octahedron, Cube, Mixed, Grid, Torus, Genus2, Wheel],
        _ => &[Triangle, Strip, Tetrahedron, Cube, Mixed, Grid, Annulus, Torus, Genus2, Parts],
    }
}

#[test]
fn every_operator_is_done_at_least_every_fifth_time_on_suitable_starts() {
    let mut noise = Noise(2026);
    let mut all: BTreeMap<&str, [usize; 2]> = BTreeMap::new();
    for kind in 0..20 {
        for &start in suitable(kind) {
            for _ in 0..60 / suitable(kind).len() {
                // Every other edit is any.
                let mut world = World::new(start.build());
                let mut own: BTreeMap<&str, [usize; 2]> = BTreeMap::new();
                for i in 0..16 {
                    let edit = random_edit(&mut noise, (i % 2 == 0).then_some(kind));
                    let before = world.tally.clone();
                    world.step(i, &edit, true);
                    if i % 2 == 0 {
                        for (&name, now) in world.tally.iter().filter(|(n, now)| before.get(*n) != Some(*now))
                        {
                            let was = before.get(name).copied().unwrap_or_default();
                            let own = own.entry(name).or_default();
                            own[0] += now[0] - was[0];
                            own[1] += now[1] - was[1];
                        }
                    }
                }
                world.finish();
                for (name, [tried, done]) in own {
                    let all = all.entry(name).or_default();
                    all[0] += tried;
                    all[1] += done;
                }
            }
        }
    }
    for (name, [tried, done]) in &all {
        println!("{name}: {done} of {tried}, {:.0} %", *done as f64 * 100.0 / *tried as f64);
        assert!(*tried > 200 && done * 5 >= *tried, "{name}: {done} of {tried}");
    }
    assert_eq!(all.len(), 18);
}

/// Every operator on every element, and on every pair or triple that could fit.
fn try_everything(world: &World) {
    let mesh = &world.mesh;
    let at = DVec3::new(0.3, 0.2, 0.1);
    for v in mesh.vertices() {
        [Op::RemoveVertex(v), Op::DissolveVertex(v)].iter().for_each(|op| world.try_out(op));
    }
    for e in mesh.edges() {
        let ops = [
            Op::RemoveEdge(e),
            Op::SplitEdge(e, at),
            Op::SplitEdgeAndFaces(e, at),
            Op::FlipEdge(e),
            Op::JoinFaces(e),
        ];
        ops.iter().for_each(|op| world.try_out(op));
    }
    for f in mesh.faces() {
        let ops = [Op::RemoveFace(f), Op::PokeFace(f, at), Op::TriangulateFace(f), Op::ReverseComponent(f)];
        ops.iter().for_each(|op| world.try_out(op));
    }
    for h in mesh.halfedges() {
        [Op::Collapse(h, at), Op::FillHole(h)].iter().for_each(|op| world.try_out(op));
        for g in mesh.loop_of(h) {
            world.try_out(&Op::SplitFace(h, g));
        }
        for g in mesh.outgoing(mesh.origin(h)) {
            world.try_out(&Op::SplitVertex(h, g, at));
        }
    }
    let boundary: Vec<_> = mesh.boundary_halfedges().collect();
    for &h in &boundary {
        boundary.iter().for_each(|&g| world.try_out(&Op::Stitch(h, g)));
        for x in mesh.vertices() {
            let (a, b, c) = (mesh.origin(h), mesh.target(h), mesh.target(mesh.next(h)));
            world.try_out(&Op::AddFace(vec![a, b, x]));
            world.try_out(&Op::AddFace(vec![a, b, c, x]));
            world.try_out(&Op::AddFace(vec![b, a, x]));
        }
    }
    let vertices: Vec<_> = mesh.vertices().take(6).collect();
    for (i, j, k) in (0..6).flat_map(|i| (0..6).flat_map(move |j| (0..6).map(move |k| (i, j, k)))) {
        if let (Some(&a), Some(&b), Some(&c)) = (vertices.get(i), vertices.get(j), vertices.get(k)) {
            world.try_out(&Op::AddFace(vec![a, b, c]));
        }
    }
}

#[test]
fn every_operator_is_exact_on_every_element_of_every_start_and_after_a_few_edits() {
    let mut noise = Noise(7);
    for start in Start::ALL {
        try_everything(&World::new(start.build()));
        for _ in 0..4 {
            let mut world = World::new(start.build());
            for i in 0..8 {
                world.step(i, &random_edit(&mut noise, None), true);
            }
            try_everything(&world);
        }
    }
}

#[test]
fn values_stay_numbers_wherever_a_vertex_is_put() {
    let far = [1e300, -1e308, f64::MAX, 1e-320, 0.0];
    for start in [Start::Triangle, Start::Cube, Start::Mixed, Start::Grid] {
        for (x, y) in far.iter().flat_map(|&x| far.iter().map(move |&y| (x, y))) {
            let at = DVec3::new(x, y, -x);
            let mut mesh = start.build();
            let heat = mesh.add_vertex_column(0.5, Rule::<f64>::interpolate());
            let uv = mesh.add_corner_column(DVec2::ONE, Rule::interpolate());
            let e = mesh.edges().next().expect("an edge");
            mesh.split_edge(e, at).expect("any edge can be split");
            let f = mesh.faces().next().expect("a face");
            let middle = mesh.poke_face(f, at).expect("any face can be poked").vertex;
            let _ = mesh.dissolve_vertex(middle);
            let f = mesh.faces().last().expect("a face");
            mesh.poke_face(f, at).expect("any face can be poked");
            let around: Vec<_> = mesh.halfedges().collect();
            for h in around {
                let _ = mesh.get_origin(h).map(|_| mesh.collapse_to_midpoint(h));
            }
            assert_eq!(mesh.validate(), Ok(()));
            for v in mesh.vertices() {
                assert!(!mesh.value(heat, v).is_nan(), "{start:?} {at}");
            }
            for h in mesh.halfedges() {
                assert!(!mesh.value(uv, h).is_nan(), "{start:?} {at}");
            }
        }
    }
}

/// Thousands of edits, without the twin.
fn long(start: &IndexedMesh, edits: usize, seed: u64) {
    let mut world = World::new(Mesh::build(start).expect("a manifold"));
    let mut noise = Noise(seed);
    for i in 0..edits {
        // Reversing a whole component is left out: the cost is that of the mesh.
        let edit = match random_edit(&mut noise, None) {
            Edit::ReverseComponent(n) => Edit::FlipEdge(n),
            edit => edit,
        };
        world.step(i, &edit, false);
        if i % 100 == 0 {
            assert_eq!(world.mesh.validate(), Ok(()), "edit {i}");
        }
    }
    world.finish();
}

#[test]
fn thousands_of_edits_on_a_torus_leave_a_valid_mesh() {
    long(&torus(40, 40), 6_000, 1);
}

#[test]
fn thousands_of_edits_on_a_sphere_leave_a_valid_mesh() {
    long(&icosphere(4), 6_000, 2);
}

#[test]
fn thousands_of_edits_on_a_sheet_leave_a_valid_mesh() {
    long(&grid(30), 6_000, 3);
}

#[test]
fn the_fuzz_corpus_passes() {
    let root = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/fuzz/corpus/edit"));
    let mut count = 0;
    for entry in std::fs::read_dir(root).expect("a corpus") {
        drive::drive(&std::fs::read(entry.expect("an entry").path()).expect("a file"));
        count += 1;
    }
    assert!(count > 10);
}
