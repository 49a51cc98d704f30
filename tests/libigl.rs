//! Our answers beside libigl's, on generated shapes and on the corpus.
//!
//! libigl misleads in places, and is then not asked: edge-manifoldness says nothing of winding, unreferenced vertices count
//! as not manifold, faces of no area have no normal.

mod corpus;
mod igl;
mod shapes;

use igl::Igl;
use meshwright::cleanup::{Weld, index};
use meshwright::glam::DVec3;
use meshwright::{IndexedMesh, Mesh, NormalWeight, unify_winding};
use std::collections::BTreeSet;

/// Compares everything that is well defined for both. Triangles only.
fn compare(igl: &mut Igl, name: &str, pool: &IndexedMesh) {
    let theirs = igl.ask(pool);
    let topology = pool.topology();

    let ours: BTreeSet<[u32; 2]> = topology.boundary_edges().map(|e| e.vertices()).collect();
    let edges = theirs.integers("boundary");
    let listed: BTreeSet<[u32; 2]> =
        edges.chunks_exact(2).map(|e| [e[0].min(e[1]) as u32, e[0].max(e[1]) as u32]).collect();
    // libigl lists a facet by how often it occurs: exactly once, as we do.
    assert_eq!(ours, listed, "{name}: boundary facets");

    assert_eq!(topology.is_edge_manifold(), theirs.is("edge_manifold"), "{name}: edge manifold");
    let pinched: BTreeSet<u32> = topology.pinched_vertices().into_iter().map(|p| p.0).collect();
    let isolated: BTreeSet<u32> = topology.isolated_vertices().into_iter().collect();
    let flags = theirs.flags("vertex_manifold");
    // libigl counts the vertices up to the highest that a face names.
    let top = pool.polygons().corners().iter().max().map_or(0, |&v| v + 1);
    assert_eq!(flags.len(), top as usize, "{name}: an answer for each vertex");
    for (v, flag) in (0..).zip(flags) {
        if !isolated.contains(&v) {
            assert_eq!(!pinched.contains(&v), flag, "{name}: vertex {v} manifold");
        }
    }

    let (labels, count) = topology.components();
    assert_eq!(count as f64, theirs.number("components"), "{name}: components");
    let their_labels = theirs.integers("face_component");
    assert_eq!(their_labels.len(), labels.len(), "{name}: an answer for each face");
    let pairs: BTreeSet<(u32, i64)> = labels.iter().copied().zip(their_labels).collect();
    assert_eq!(pairs.len(), count, "{name}: the components hold the same faces");

    let unused = isolated.range(..top).count() as f64;
    assert_eq!(
        topology.euler_characteristic() as f64 + unused,
        theirs.number("euler"),
        "{name}: Euler characteristic"
    );

    let scale = pool.bounds().map_or(1.0, |b| (b.max - b.min).length());
    let offset = pool.bounds().map_or(0.0, |b| b.center().length());
    assert!((pool.area() - theirs.number("area")).abs() <= 1e-9 * pool.area(), "{name}: area");
    if let Some(volume) = topology.volume() {
        // libigl sums about the origin, and loses digits with the distance.
        let slack = 1e-9 * (volume.abs() + pool.area() * (scale + offset));
        assert!((volume - theirs.number("volume")).abs() <= slack, "{name}: volume");
    }

    for (weight, column) in [(NormalWeight::Area, "normals_area"), (NormalWeight::Angle, "normals_angle")] {
        let theirs = theirs.numbers(column);
        assert_eq!(theirs.len(), 3 * pool.vertex_count(), "{name}: an answer for each vertex");
        let certainty = certainty(pool, weight);
        for ((v, ours), theirs) in
            pool.vertex_normals(weight).into_iter().enumerate().zip(theirs.chunks_exact(3))
        {
            let theirs = DVec3::from_slice(theirs);
            // Where faces cancel, or have hardly any area, the direction is noise.
            if theirs.is_finite() && certainty[v] > 1e-6 {
                assert!(ours.distance(theirs) < 1e-6, "{name}: {column} of vertex {v}: {ours} {theirs}");
            }
        }
    }

    if topology.orientable().is_ok() && topology.is_edge_manifold() && topology.is_vertex_manifold() {
        compare_winding(name, pool, &theirs);
    }
    if let Ok(mesh) = Mesh::build(pool) {
        compare_mesh(name, pool, &mesh, &theirs);
    }
}

/// The mesh says what its pool says, which was compared, and what only a mesh can say.
fn compare_mesh(name: &str, pool: &IndexedMesh, mesh: &Mesh, theirs: &igl::Opinion) {
    assert_eq!(2 * mesh.boundary_halfedges().count(), theirs.integers("boundary").len(), "{name}");
    assert_eq!(mesh.components().len() as f64, theirs.number("components"), "{name}");
    for weight in [NormalWeight::Area, NormalWeight::Angle] {
        let certainty = certainty(pool, weight);
        for ((v, expected), certainty) in mesh.vertices().zip(pool.vertex_normals(weight)).zip(certainty) {
            let ours = mesh.vertex_normal(v, weight).expect("live");
            assert!(certainty <= 1e-6 || ours.distance(expected) < 1e-9, "{name}: {ours} {expected}");
        }
    }
    assert_eq!(mesh.closed().is_ok(), theirs.integers("boundary").is_empty(), "{name}: closed");
    if let Ok(solid) = mesh.closed() {
        assert_eq!(Some(solid.volume()), pool.topology().volume(), "{name}");
    }
}

/// For each vertex, how well defined its normal is: the smallest ratio over its faces of height to longest edge, times how
/// far the weighted face normals agree.
fn certainty(pool: &IndexedMesh, weight: NormalWeight) -> Vec<f64> {
    let mut sums = vec![DVec3::ZERO; pool.vertex_count()];
    let mut weights = vec![0.0; pool.vertex_count()];
    let mut worst = vec![1.0f64; pool.vertex_count()];
    for face in pool.polygons().iter() {
        let corners = [0, 1, 2].map(|i| pool.positions()[face[i] as usize]);
        let [a, b, c] = corners;
        let cross = (b - a).cross(c - a);
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        for (i, &v) in face.iter().enumerate() {
            let (p, q, r) = (corners[(i + 2) % 3], corners[i], corners[(i + 1) % 3]);
            let w = if weight == NormalWeight::Area { cross.length() } else { (p - q).angle_between(r - q) };
            sums[v as usize] += cross.normalize_or_zero() * w;
            weights[v as usize] += w;
            worst[v as usize] =
                worst[v as usize].min(cross.length() / (longest * longest).max(f64::MIN_POSITIVE));
        }
    }
    (0..sums.len()).map(|v| worst[v] * sums[v].length() / f64::max(weights[v], f64::MIN_POSITIVE)).collect()
}

/// Both make the winding of each patch agree, though not always the same way round.
fn compare_winding(name: &str, pool: &IndexedMesh, theirs: &igl::Opinion) {
    let unified = unify_winding(&pool.topology()).expect("orientable").value;
    assert!(unified.topology().is_oriented(), "{name}: winding");
    let oriented = theirs.integers("oriented");
    let patches = theirs.integers("patch");
    let mut relation: Vec<Option<bool>> = vec![None; patches.len()];
    for (f, (ours, theirs)) in unified.polygons().iter().zip(oriented.chunks_exact(3)).enumerate() {
        let at = ours.iter().position(|&v| i64::from(v) == theirs[0]).expect("the same corners");
        let same = i64::from(ours[(at + 1) % 3]) == theirs[1];
        let patch = &mut relation[patches[f] as usize];
        assert_eq!(*patch.get_or_insert(same), same, "{name}: winding of face {f}");
    }
}

#[test]
fn libigl_agrees_on_generated_shapes() {
    let mut igl = Igl::start();
    let sphere = shapes::icosphere(3);
    let cases = [
        ("tetrahedron", shapes::tetrahedron()),
        ("cube", shapes::fanned(&shapes::cube())),
        ("torus", shapes::fanned(&shapes::torus(12, 7))),
        ("grid", shapes::grid(12)),
        (
            "two cubes apart",
            shapes::fanned(&shapes::both(&shapes::cube(), &shapes::cube_at(DVec3::splat(3.0)))),
        ),
        ("fins", shapes::fins()),
        ("bow tie", shapes::bow_tie()),
        ("moebius", shapes::fanned(&shapes::moebius(9))),
        ("mixed sphere", shapes::some_reversed(&sphere, 3, 5)),
        ("mixed grid", shapes::some_reversed(&shapes::grid(12), 2, 9)),
        ("sphere", sphere),
    ];
    for (name, pool) in cases {
        compare(&mut igl, name, &pool);
    }
    for (name, pool) in [("edge", shapes::cubes_at_an_edge()), ("vertex", shapes::cubes_at_a_vertex())] {
        let welded = index(&shapes::soup(&shapes::fanned(&pool)), Weld::Exact).expect("always answers").value;
        compare(&mut igl, name, &welded);
    }
}

#[test]
fn libigl_agrees_on_random_triangles() {
    let mut igl = Igl::start();
    let mut noise = shapes::Noise(11);
    for round in 0..300 {
        let vertices = 4 + noise.below(12);
        let points = (0..vertices).map(|_| DVec3::new(noise.unit(), noise.unit(), noise.unit())).collect();
        let mut triangles = Vec::new();
        for _ in 0..1 + noise.below(24) {
            let t = [(); 3].map(|()| noise.below(vertices));
            if t[0] != t[1] && t[1] != t[2] && t[2] != t[0] {
                triangles.push(t);
            }
        }
        if triangles.is_empty() {
            continue;
        }
        let pool = IndexedMesh::from_triangles(points, &triangles).expect("a valid vertex pool");
        compare(&mut igl, &format!("random {round}: {triangles:?}"), &pool);
    }
}

#[test]
fn libigl_agrees_on_the_corpus() {
    let Some(rows) = corpus::rows() else { return };
    let mut igl = Igl::start();
    let mut compared = 0;
    for row in rows.iter().filter(|r| r.is_readable()) {
        let Ok(soup) = row.load() else { continue };
        let pool = index(&soup, Weld::Exact).expect("always answers").value;
        if pool.face_count() == 0 {
            continue;
        }
        // What is a manifold as polygons may be none once it is cut: cut first, then compare.
        compare(&mut igl, &row.path, &shapes::fanned(&pool));
        compared += 1;
    }
    assert!(compared > 180, "only {compared} files were compared");
}

#[test]
fn libigl_finds_cleaned_meshes_manifold() {
    let Some(rows) = corpus::rows() else { return };
    let mut igl = Igl::start();
    for row in rows.iter().filter(|r| r.is_readable() && !r.path.starts_with("clean/")) {
        let Ok(soup) = row.load() else { continue };
        let cleaned = meshwright::cleanup::clean(&soup, Default::default()).expect("always answers").value;
        let pool = cleaned.to_indexed();
        if pool.face_count() == 0 || pool.polygons().iter().any(|f| f.len() != 3) {
            continue;
        }
        let theirs = igl.ask(&pool);
        assert!(theirs.is("edge_manifold"), "{}", row.path);
        let isolated: BTreeSet<u32> = pool.topology().isolated_vertices().into_iter().collect();
        let flags = theirs.flags("vertex_manifold");
        assert!((0..).zip(&flags).all(|(v, ok)| *ok || isolated.contains(&v)), "{}", row.path);
        let boundary = cleaned.boundary_halfedges().count();
        assert_eq!(theirs.integers("boundary").len(), 2 * boundary, "{}", row.path);
    }
}

#[test]
fn mesh_normals_are_those_of_the_pool_and_of_libigl() {
    let mut igl = Igl::start();
    let pool = shapes::icosphere(2);
    let theirs = igl.ask(&pool);
    let mesh = Mesh::build(&pool).expect("a manifold");
    for (weight, column) in [(NormalWeight::Area, "normals_area"), (NormalWeight::Angle, "normals_angle")] {
        for (v, theirs) in mesh.vertices().zip(theirs.numbers(column).chunks_exact(3)) {
            let ours = mesh.vertex_normal(v, weight).expect("live");
            assert!(ours.distance(DVec3::from_slice(theirs)) < 1e-9);
        }
    }
    let solid = mesh.closed().expect("closed");
    assert!((solid.volume() - theirs.number("volume")).abs() < 1e-12);
    assert!((solid.area() - theirs.number("area")).abs() < 1e-12);
    let centroid = solid.centroid().expect("a volume");
    assert!(centroid.distance(DVec3::from(theirs.vector("centroid"))) < 1e-12);
}
