//! Rays, nearest elements and self-intersections of random small meshes beside rational arithmetic.

#[path = "drive/query.rs"]
mod drive;
mod shapes;

use drive::{Case, exact};
use meshwright::glam::{DVec3, dvec3};
use proptest::prelude::*;
use shapes::Noise;

fn numbers() -> impl Strategy<Value = [i8; 3]> {
    // Few values, so that vertices, edges and planes are met.
    prop_oneof![3 => [3i8..8, 3i8..8, 3i8..8], 1 => [0i8..11, 0i8..11, 0i8..11]]
}

fn cases() -> impl Strategy<Value = Case> {
    let faces = prop::collection::vec(prop::collection::vec(any::<u8>(), 3..6), 0..8);
    let rays = prop::collection::vec((numbers(), numbers()), 8);
    let points = || prop::collection::vec(numbers(), 8..11);
    (any::<bool>(), points(), faces, rays, points()).prop_map(|(closed, points, faces, rays, asked)| Case {
        closed,
        points,
        faces,
        rays,
        asked,
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn queries_of_any_small_mesh_answer_as_rational_arithmetic_does(case in cases()) {
        drive::check(&case);
    }

    #[test]
    fn any_bytes_drive_the_queries(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        drive::drive(&bytes);
    }
}

#[test]
fn rays_at_vertices_along_edges_and_in_the_planes_of_faces_are_those_of_rational_arithmetic() {
    let mut noise = Noise(41);
    let mut outer = shapes::cube();
    outer.map_positions(|p| p * 3.0).expect("finite");
    let mut lidless: Vec<Vec<u32>> = shapes::cube().polygons().iter().map(<[u32]>::to_vec).collect();
    lidless.remove(0);
    let pools = [
        shapes::cube(),
        shapes::tetrahedron(),
        shapes::cubes_at_an_edge(),
        shapes::cubes_at_a_vertex(),
        shapes::both(&outer, &shapes::cube_at(DVec3::ONE).reversed()),
        shapes::both(&shapes::cube(), &shapes::cube_at(dvec3(0.5, 0.5, 0.))),
        shapes::pool(shapes::cube().positions().to_vec(), lidless),
    ];
    for pool in pools.iter().flat_map(|p| [p.clone(), shapes::fanned(p)]) {
        let mesh = shapes::mesh(&pool);
        let (index, all) = (mesh.index(), exact::triangles(&mesh));
        for _ in 0..400 {
            let mut at = |low: i32, count: u32| f64::from(noise.below(count) as i32 + low);
            let mut place = || dvec3(at(-4, 13), at(-4, 13), at(-4, 13)) / 2.0;
            let origin = place();
            // To a point of the half grid, where vertices, middles of edges and of faces are.
            let direction = match noise.below(3) {
                0 => [DVec3::X, DVec3::NEG_Y, DVec3::Z][noise.below(3) as usize],
                _ => {
                    (dvec3(noise.below(5).into(), noise.below(5).into(), noise.below(5).into()) / 2.0)
                        - origin
                }
            };
            if direction != DVec3::ZERO {
                drive::ray(&mesh, &index, &all, origin, direction);
            }
        }
    }
}

#[test]
fn the_fuzzers_finds_pass() {
    let root = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/fuzz/corpus/query"));
    let mut files = 0;
    for file in std::fs::read_dir(root).expect("a folder of inputs") {
        drive::drive(&std::fs::read(file.expect("an entry").path()).expect("a readable file"));
        files += 1;
    }
    assert!(files > 10, "{files}");
}
