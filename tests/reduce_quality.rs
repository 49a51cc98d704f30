//! Reduction beside libigl's, on large meshes and on models of the corpus.

#[path = "corpus/mod.rs"]
mod corpus;
#[path = "igl/mod.rs"]
mod igl;
#[path = "shapes/mod.rs"]
mod shapes;

use meshwright::cleanup::{CleanOptions, clean};
use meshwright::glam::{DVec2, DVec3, dvec3};
use meshwright::{
    ClosestOptions, EdgeKey, FaceKey, IndexedMesh, Mesh, ReduceOptions, ReduceTarget, Reduced, Rule, Stopped,
};
use shapes::Noise;
use std::collections::HashMap;

fn to(target: ReduceTarget) -> ReduceOptions<'static> {
    ReduceOptions { target, ..Default::default() }
}

/// Points spread over a surface by area, and its vertices.
fn spread(mesh: &IndexedMesh) -> (Vec<DVec3>, usize) {
    let triangle = |f: &[u32]| [f[0], f[1], f[2]].map(|v| mesh.positions()[v as usize]);
    let mut sums = vec![0.0];
    for f in mesh.polygons().iter() {
        let [a, b, c] = triangle(f);
        sums.push(sums[sums.len() - 1] + (b - a).cross(c - a).length());
    }
    let count = 20_000;
    let (mut noise, mut f) = (Noise(5), 0);
    let mut points = Vec::new();
    for i in 0..count {
        let at = (i as f64 + noise.unit()) / count as f64 * sums[sums.len() - 1];
        while f + 2 < sums.len() && sums[f + 1] < at {
            f += 1;
        }
        let [a, b, c] = triangle(mesh.polygons().get(f).expect("a face"));
        let (s, t) = (noise.unit().sqrt(), noise.unit());
        points.push(a * (1.0 - s) + (b * (1.0 - t) + c * t) * s);
    }
    points.extend(mesh.positions());
    (points, count)
}

/// The mean and the largest distance between two surfaces, the greater of both directions each, as shares of the diagonal.
fn apart(a: &Mesh, b: &Mesh) -> (f64, f64) {
    let bounds = a.to_indexed().bounds().expect("points");
    let diagonal = bounds.max.distance(bounds.min);
    let one_way = |from: &Mesh, to: &Mesh| {
        let (points, spread) = spread(&from.to_indexed());
        let found = to.index().closest_point_batch(&points, ClosestOptions::default()).expect("finite");
        let distances: Vec<f64> = found.into_iter().map(|c| c.expect("faces").distance / diagonal).collect();
        let mean = distances[..spread].iter().sum::<f64>() / spread as f64;
        (mean, distances.into_iter().fold(0.0, f64::max))
    };
    let (there, back) = (one_way(a, b), one_way(b, a));
    (there.0.max(back.0), there.1.max(back.1))
}

fn beside_qslim(name: &str, mesh: &Mesh, igl: &mut igl::Igl) {
    let faces = mesh.face_count() / 10;
    let mut ours = mesh.clone();
    assert_eq!(ours.reduce(to(ReduceTarget::Faces(faces))).expect("reduces").stopped, Stopped::Target);
    let (points, triangles) = igl.ask_for(&mesh.to_indexed(), &format!("qslim:{faces}"));
    let qslim = shapes::mesh(&IndexedMesh::from_triangles(points, &triangles).expect("valid"));
    let (ours, theirs) = (apart(mesh, &ours), apart(mesh, &qslim));
    eprintln!("{name}: mean {:.3e} max {:.3e}, qslim {:.3e} {:.3e}", ours.0, ours.1, theirs.0, theirs.1);
    assert!(ours.0 <= theirs.0, "{name}: mean {} beside {}", ours.0, theirs.0);
    assert!(ours.1 <= 1.5 * theirs.1, "{name}: max {} beside {}", ours.1, theirs.1);
}

#[test]
fn the_mean_distance_is_no_more_than_that_of_qslim() {
    let mut igl = igl::Igl::start();
    beside_qslim("sphere", &shapes::mesh(&shapes::icosphere(5)), &mut igl);
    for row in corpus::rows().unwrap_or_default() {
        if ["bullet__diff_ring", "trimesh__counter.unitsmm"].iter().any(|name| row.path.contains(name)) {
            let soup = row.load().expect("readable");
            let mesh = clean(&soup, CleanOptions::default()).expect("cleans").value;
            beside_qslim(&row.path, &mesh, &mut igl);
        }
    }
}

/// Large enough for several parts.
fn large() -> Mesh {
    shapes::mesh(&shapes::shuffled(&shapes::icosphere(7), 3))
}

#[test]
fn a_large_mesh_is_reduced_in_parts_and_still_by_the_rules() {
    let original = large();
    let (mut alone, mut watched) = (original.clone(), original.clone());
    watched.record_changes();
    let target = ReduceTarget::Faces(20_000);
    let account = alone.reduce(to(target)).expect("reduces");
    assert_eq!((account.faces, account.stopped), (20_000, Stopped::Target));
    assert_eq!(alone.validate(), Ok(()));
    assert_eq!((alone.components().len(), alone.is_closed()), (1, true));
    assert_eq!(watched.reduce(to(target)).as_ref(), Ok(&account));
    assert_eq!(alone.to_indexed(), watched.to_indexed());
    assert_eq!(alone.numbering(), watched.numbering());
    // As evenly everywhere as the serial part does it: no face spans a seam of the parts.
    let (mean, most) = apart(&original, &alone);
    assert!(mean < 2e-5 && most < 3e-4, "{mean} {most}");
}

#[test]
fn a_large_mesh_with_a_boundary_locks_and_a_bound_is_reduced_in_parts() {
    let mut mesh = shapes::mesh(&shapes::grid(400));
    let locked: Vec<_> = mesh.vertices().step_by(1000).collect();
    let places: Vec<DVec3> = locked.iter().map(|&v| mesh.position(v)).collect();
    let options = ReduceOptions {
        target: ReduceTarget::MaxError(0.05),
        locked_vertices: &locked,
        ..Default::default()
    };
    let account = mesh.reduce(options).expect("reduces");
    assert_eq!((account.stopped, mesh.validate()), (Stopped::ErrorBound, Ok(())));
    assert!(account.max_error <= 0.05 && account.faces < account.faces_before / 2, "{account:?}");
    assert_eq!((mesh.boundary_loops().len(), mesh.components().len()), (1, 1));
    assert!(locked.iter().zip(places).all(|(&v, p)| mesh.get_position(v) == Some(p)));
}

#[cfg(feature = "rayon")]
#[test]
fn the_result_is_the_same_for_any_number_of_threads() {
    let original = large();
    let on = |threads: usize| -> (Reduced, IndexedMesh) {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let mut mesh = original.clone();
        let account = pool.install(|| mesh.reduce(to(ReduceTarget::Ratio(0.1)))).expect("reduces");
        (account, mesh.to_indexed())
    };
    let one = on(1);
    assert!([2, 3].into_iter().all(|threads| on(threads) == one));
}

fn seam(mesh: &Mesh) -> Vec<EdgeKey> {
    mesh.edges().filter(|&e| mesh.is_uv_seam(e)).collect()
}

/// The lines of the texture's charts along the seams, from each side.
fn lines(mesh: &Mesh) -> Vec<[DVec2; 2]> {
    let sides = seam(mesh).into_iter().flat_map(|e| {
        let h = mesh.edge_halfedge(e);
        [h, mesh.twin(h)]
    });
    sides.filter_map(|h| Some([mesh.uv(h)?, mesh.uv(mesh.next(h))?])).collect()
}

/// How many charts the seams cut the surface into.
fn charts(mesh: &Mesh) -> usize {
    let mut seen: HashMap<FaceKey, ()> = HashMap::new();
    let mut count = 0;
    for f in mesh.faces() {
        if seen.contains_key(&f) {
            continue;
        }
        count += 1;
        let mut stack = vec![f];
        while let Some(f) = stack.pop() {
            if seen.insert(f, ()).is_none() {
                let across = mesh.face_halfedges(f).filter(|&h| !mesh.is_uv_seam(mesh.edge(h)));
                stack.extend(across.filter_map(|h| mesh.face(mesh.twin(h))));
            }
        }
    }
    count
}

fn to_segment(p: DVec2, [a, b]: [DVec2; 2]) -> f64 {
    let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    if t.is_nan() { p.distance(a) } else { p.distance(a + (b - a) * t) }
}

#[test]
fn textures_of_the_corpus_keep_their_charts_and_columns_their_values() {
    let mut done = 0;
    for row in corpus::rows().unwrap_or_default() {
        if !["cinolib__spot_triangulated", "cinolib__blub_triangulated"].iter().any(|n| row.path.contains(n))
        {
            continue;
        }
        let soup = row.load().expect("readable");
        let mut mesh = clean(&soup, CleanOptions::default()).expect("cleans").value;
        let (before, had, charts_before) = (lines(&mesh), seam(&mesh).len(), charts(&mesh));
        assert!(had > 0, "{}: a seam", row.path);
        let height = mesh.add_vertex_column(0.0, Rule::interpolate());
        for v in mesh.vertices().collect::<Vec<_>>() {
            mesh.set_value(height, v, mesh.position(v).y).expect("live");
        }
        let account = mesh.reduce(to(ReduceTarget::Ratio(0.2))).expect("reduces");
        assert_eq!(mesh.validate(), Ok(()));
        let after = lines(&mesh);
        let off = after
            .iter()
            .flatten()
            .map(|&p| before.iter().map(|&l| to_segment(p, l)).fold(f64::MAX, f64::min));
        let off = off.fold(0.0, f64::max);
        let size = mesh.to_indexed().bounds().map_or(0.0, |b| b.max.distance(b.min));
        let lag =
            mesh.vertices().map(|v| (mesh.value(height, v) - mesh.position(v).y).abs()).fold(0.0, f64::max);
        eprintln!(
            "{}: {} -> {} faces, seam of {had} -> {} edges, {} charts, uv off by {off:.1e}, column by {:.1e}",
            row.path,
            account.faces_before,
            account.faces,
            seam(&mesh).len(),
            charts_before,
            lag / size,
        );
        assert!(!after.is_empty() && seam(&mesh).len() < had, "{}", row.path);
        assert_eq!(charts(&mesh), charts_before, "{}", row.path);
        assert!(off < 0.01 && lag < 0.02 * size, "{}: {off} {lag}", row.path);
        assert!(mesh.faces().all(|f| mesh.face_halfedges(f).all(|h| mesh.uv(h).is_some())));
        done += 1;
    }
    assert!(done == 2 || std::env::var_os("MESHWRIGHT_CORPUS").is_none());
}

/// A bowl: `rings` rings of `n` vertices around the bottom, the rim a circle.
fn bowl(n: u32, rings: u32) -> Mesh {
    let point = |i: u32| {
        let (ring, turn) = (i / n + 1, f64::from(i % n) / f64::from(n) * std::f64::consts::TAU);
        let r = f64::from(ring) / f64::from(rings);
        dvec3(r * turn.cos(), r * turn.sin(), 0.3 * r * r)
    };
    let points: Vec<DVec3> = (0..n * rings).map(point).chain([DVec3::ZERO]).collect();
    let mut triangles: Vec<[u32; 3]> = (0..n).map(|i| [n * rings, i, (i + 1) % n]).collect();
    for i in 0..n * (rings - 1) {
        let (a, b) = (i, i / n * n + (i + 1) % n);
        triangles.extend([[a, a + n, b + n], [a, b + n, b]]);
    }
    shapes::mesh(&IndexedMesh::from_triangles(points, &triangles).expect("valid"))
}

#[test]
fn a_curved_boundary_is_left_no_further_than_twice_the_error_that_is_told() {
    // The error is the root of a mean square, and that of a circle's tangents is below the distance to the circle.
    for bound in [1e-4, 1e-3, 1e-2] {
        let mut mesh = bowl(200, 60);
        let account = mesh.reduce(to(ReduceTarget::MaxError(bound))).expect("reduces");
        let rim = mesh.vertices().filter(|&v| mesh.is_boundary_vertex(v)).map(|v| mesh.position(v));
        let off = rim.map(|p| (p.truncate().length() - 1.0).hypot(p.z - 0.3)).fold(0.0, f64::max);
        eprintln!("{} faces, error {:.2e}, off the rim by {off:.2e}", account.faces, account.max_error);
        assert!(account.faces < account.faces_before / 4);
        assert!(off <= 2.0 * account.max_error, "{off} of {}", account.max_error);
    }
}
