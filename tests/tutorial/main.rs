//! The mesh tutorial's operations, sentence by sentence: the tutorial's own loops beside ours, the cases in which known
//! tools are wrong, and what bad input and cancelled calls leave behind. `tests/README.md` tells which test shows what.

#[path = "../corpus/mod.rs"]
mod corpus;
#[path = "../shapes/mod.rs"]
mod shapes;

mod agree;
mod agree_edges;
mod cancel;
mod cases;
mod corpus_closest;
mod corpus_cross;
mod corpus_edges;
mod corpus_made;
mod corpus_moved;
mod corpus_rays;
mod corpus_smooth;
mod cross;
mod forms;
mod naive;
mod places;
mod properties;
mod refusals;
mod rows;

use meshwright::cleanup::{CleanOptions, Weld, clean, index};
use meshwright::glam::{DVec3, dvec3};
use meshwright::{IndexedMesh, Mesh, PolygonSoup};
use naive::Plain;
use std::sync::OnceLock;

/// Named shapes that are manifolds: closed and open, of triangles and of polygons, of one part and of two.
fn manifolds() -> Vec<(String, IndexedMesh)> {
    let mut named = vec![
        ("cube", shapes::cube()),
        ("cube of triangles", shapes::fanned(&shapes::cube())),
        ("tetrahedron", shapes::tetrahedron()),
        ("torus", shapes::torus(7, 5)),
        ("torus of triangles", shapes::fanned(&shapes::torus(6, 5))),
        ("sphere", shapes::icosphere(1)),
        ("grid", shapes::grid(4)),
        ("cavity", cavity()),
        ("two parts", shapes::both(&shapes::cube_at(DVec3::splat(4.0)), &shapes::grid(3))),
    ];
    named.push(("open cube", lidless(&shapes::cube())));
    named.into_iter().map(|(name, pool)| (name.to_owned(), pool)).collect()
}

/// A cube of side 3 with a cube of side 1 cut out of its middle.
fn cavity() -> IndexedMesh {
    let mut outer = shapes::cube();
    outer.map_positions(|p| p * 3.0).expect("finite");
    shapes::both(&outer, &shapes::cube_at(DVec3::ONE).reversed())
}

/// Without the first face.
fn lidless(pool: &IndexedMesh) -> IndexedMesh {
    let faces = pool.polygons().iter().skip(1).map(<[u32]>::to_vec).collect();
    shapes::pool(pool.positions().to_vec(), faces)
}

/// Small models of the corpus, cleaned; none if there is no corpus.
fn models(most_faces: usize) -> Vec<(String, Mesh)> {
    let small = |(name, soup): (String, PolygonSoup)| {
        let mesh = clean(&soup, CleanOptions::default()).expect("always answers").value;
        (mesh.face_count() > 0).then_some((name, mesh))
    };
    soups(most_faces).into_iter().filter_map(small).collect()
}

/// [`models`] of up to 1000 faces, cleaned once for all tests.
fn few() -> &'static [(String, Mesh)] {
    static FEW: OnceLock<Vec<(String, Mesh)>> = OnceLock::new();
    FEW.get_or_init(|| models(1000))
}

/// Those of them that are closed, of triangles.
fn solids() -> impl Iterator<Item = &'static (String, Mesh)> {
    few().iter().filter(|(_, mesh)| mesh.is_closed() && mesh.faces().all(|f| mesh.degree(f) == 3))
}

/// Fails where a test that needs the corpus met too little of it.
fn assert_met(met: usize, least: usize) {
    assert!(met >= least || std::env::var_os("MESHWRIGHT_CORPUS").is_none(), "only {met}, not {least}");
}

/// From the middle to a corner, and how far out that is.
fn reach(mesh: &Mesh) -> (f64, f64) {
    let bounds = mesh.bounds().expect("vertices");
    ((bounds.max - bounds.min).length(), bounds.max.abs().max(bounds.min.abs()).max_element())
}

/// Small files of the corpus as they are.
fn soups(most_faces: usize) -> Vec<(String, PolygonSoup)> {
    let rows = corpus::rows().unwrap_or_default().into_iter().filter(|r| r.is_readable());
    let small = rows.filter(|r| r.number("faces").is_some_and(|n| n <= most_faces as f64));
    small.filter_map(|r| Some((r.path.clone(), r.load().ok()?))).collect()
}

/// A soup as a vertex pool, equal positions welded.
fn welded(soup: &PolygonSoup) -> IndexedMesh {
    index(soup, Weld::Exact).expect("always answers").value
}

/// Every polygon cut by the one rule, asked about each by itself: in the mesh a diagonal may be an edge already.
fn cut(pool: &IndexedMesh) -> IndexedMesh {
    let mut faces = Vec::new();
    for corners in pool.polygons().iter() {
        // The rule reads a polygon by the order of its vertices.
        let mut order = corners.to_vec();
        order.sort_unstable();
        let number = |v: &u32| order.binary_search(v).expect("a corner") as u32;
        let points = order.iter().map(|&v| pool.positions()[v as usize]).collect();
        let mut alone = shapes::mesh(&shapes::pool(points, vec![corners.iter().map(number).collect()]));
        let only = alone.faces().next().expect("one");
        alone.triangulate_face(only).expect("nothing is in the way");
        let triangles = alone.to_indexed();
        faces.extend(triangles.polygons().iter().map(|t| t.iter().map(|&i| order[i as usize]).collect()));
    }
    shapes::pool(pool.positions().to_vec(), faces)
}

fn volume(mesh: &Mesh) -> f64 {
    mesh.closed().expect("closed").volume()
}

/// A point of a cube of a size about the origin.
fn somewhere(noise: &mut shapes::Noise, size: f64) -> DVec3 {
    (dvec3(noise.unit(), noise.unit(), noise.unit()) - 0.5) * size
}

/// Faces as the places of their corners, each from its lowest, in order: so that numbering does not matter.
fn by_place(mesh: &Plain) -> Vec<Vec<[u64; 3]>> {
    let at = |&v: &u32| (mesh.points[v as usize] + DVec3::ZERO).to_array().map(f64::to_bits);
    let mut faces: Vec<Vec<[u64; 3]>> = mesh.faces.iter().map(|f| f.iter().map(at).collect()).collect();
    for f in &mut faces {
        let low = (0..f.len()).min_by_key(|&i| f[i]).unwrap_or(0);
        f.rotate_left(low);
    }
    faces.sort();
    faces
}
