//! Random slivers put into shapes of every kind.

use super::*;
use meshwright::SliverObstacle;
use proptest::prelude::*;
use shapes::Noise;

fn with_slivers(pool: &IndexedMesh, count: usize, seed: u64) -> Mesh {
    let mut mesh = shapes::mesh(pool);
    let mut noise = Noise(seed);
    for _ in 0..count {
        if noise.below(3) > 0 {
            let e = mesh.edges().nth(noise.below(mesh.edge_count() as u32) as usize).unwrap();
            put_cap(&mut mesh, e, 0.02 + 0.96 * noise.unit(), noise.below(2) == 0);
        } else {
            let v = mesh.vertices().nth(noise.below(mesh.vertex_count() as u32) as usize).unwrap();
            let offset = dvec3(noise.unit(), noise.unit(), noise.unit()) * f64::from(noise.below(2)) * 1e-14;
            put_needle(&mut mesh, v, noise.below(8) as usize, offset, noise.below(2) == 0);
        }
    }
    mesh
}

fn shapes_of_all_kinds() -> Vec<IndexedMesh> {
    let cube = shapes::cube();
    vec![
        shapes::icosphere(2),
        shapes::torus(12, 8),
        shapes::fanned(&shapes::torus(12, 8)),
        bracket(),
        cube.clone(),
        shapes::fanned(&cube),
        shapes::tetrahedron(),
    ]
}

#[test]
fn a_sphere_with_hundreds_of_caps_and_needles_is_resolved() {
    let mut mesh = with_slivers(&shapes::icosphere(4), 800, 5);
    let account = resolve(&mut mesh);
    assert!(account.found > 800);
}

#[test]
fn shapes_of_all_kinds_are_resolved() {
    for (i, pool) in shapes_of_all_kinds().iter().enumerate() {
        for seed in 0..6 {
            let mut mesh = with_slivers(pool, [1, 3, 10, 30, 60, 100][seed], seed as u64 + 10 * i as u64);
            let account = resolve_any(&mut mesh.clone(), mesh.propose_sliver_tolerance());
            assert_eq!(account.left, [], "shape {i}, seed {seed}");
            resolve(&mut mesh);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn slivers_put_into_closed_meshes_are_all_resolved(shape in 0usize..7, count in 1usize..40, seed in any::<u64>()) {
        let mut mesh = with_slivers(&shapes_of_all_kinds()[shape], count, seed);
        resolve(&mut mesh);
    }
}

#[test]
fn in_an_open_mesh_only_what_has_no_width_between_two_places_of_the_boundary_is_left() {
    for seed in 0..40 {
        let mut mesh = with_slivers(&shapes::grid(5), 40, seed);
        let tolerance = mesh.propose_sliver_tolerance();
        let account = resolve_any(&mut mesh, tolerance);
        assert!(
            account.left.iter().all(|l| l.obstacle == SliverObstacle::Pinch),
            "{seed} {:?}",
            account.left
        );
    }
}

#[test]
fn very_many_slivers_around_one_vertex_take_bounded_time() {
    // A double cone over a ring that runs along a segment and back; the lower tip lies on it too.
    let n = 20_000u32;
    let x = |i: u32| (if i < n / 2 { f64::from(i) } else { f64::from(n - i) - 0.5 }) / f64::from(n / 2);
    let tips = [dvec3(0.5001, 0., 0.), dvec3(0.5, 0., 1.)];
    let points = tips.into_iter().chain((0..n).map(|i| dvec3(x(i), 0., 0.))).collect();
    let faces = (0..n).flat_map(|i| {
        let (a, b) = (2 + i, 2 + (i + 1) % n);
        [vec![0, b, a], vec![1, a, b]]
    });
    let mut mesh = shapes::mesh(&shapes::pool(points, faces.collect()));
    let start = std::time::Instant::now();
    let tolerance = mesh.propose_sliver_tolerance();
    let account = mesh.resolve_slivers(SliverOptions::new(tolerance)).unwrap();
    let took = start.elapsed().as_secs_f64();
    assert_eq!((account.found, account.left.len(), mesh.validate()), (20_000, 0, Ok(())));
    assert!(took < 20.0);
}
