//! Our side of the comparison with C++ peers; `benches/peers/run.sh` runs both in turns.
//!
//! `cargo bench --bench peers -- --write DIR` writes the shapes: a sphere in the order of subdivision, the same
//! shuffled, and a grid; `-- --time FILE [--repeats N] [--only NAME]` times one of them, all operations or the one named,
//! and prints a line per operation: name, operation, value, unit. A file holds, little-endian: `u64` vertices, `u64`
//! triangles, three `f64` a vertex, three `u32` a triangle.

#[path = "../tests/shapes/mod.rs"]
mod shapes;

use cpu_time::ThreadTime;
use meshwright::cleanup::{self, CleanOptions, Weld};
use meshwright::glam::DVec3;
use meshwright::{
    IndexedMesh, Mesh, NormalWeight, PolygonSoup, Polygons, Scheme, SmoothMethod, SmoothOptions,
    SubdivideOptions, WeldOptions, unify_winding,
};
use std::error::Error;
use std::hint::black_box;
use std::time::Duration;
use std::{env, fs};

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = env::args().collect();
    let value = |flag: &str| args.iter().position(|a| a == flag).and_then(|i| args.get(i + 1));
    if let Some(dir) = value("--write") {
        fs::create_dir_all(dir)?;
        let sphere = shapes::icosphere(8);
        fs::write(format!("{dir}/scattered1m.raw"), to_raw(&shapes::shuffled(&sphere, 3)))?;
        fs::write(format!("{dir}/sphere1m.raw"), to_raw(&sphere))?;
        fs::write(format!("{dir}/grid2m.raw"), to_raw(&shapes::grid(1000)))?;
        return Ok(());
    }
    let repeats = value("--repeats").map_or(Ok(5), |r| r.parse())?;
    let pool = value("--time").map_or(Ok(shapes::icosphere(6)), |file| {
        fs::read(file).map_err(Box::<dyn Error>::from).and_then(|raw| Ok(shapes::from_raw(&raw)?))
    })?;
    let timer = Timer { repeats, only: value("--only").map(String::as_str).unwrap_or_default() };
    timer.mesh(&pool);
    timer.operations(&pool);
    timer.soups(&pool);
    Ok(())
}

fn to_raw(pool: &IndexedMesh) -> Vec<u8> {
    let mut raw = Vec::new();
    raw.extend((pool.vertex_count() as u64).to_le_bytes());
    raw.extend((pool.face_count() as u64).to_le_bytes());
    raw.extend(pool.positions().iter().flat_map(|p| p.to_array()).flat_map(f64::to_le_bytes));
    raw.extend(pool.polygons().corners().iter().flat_map(|c| c.to_le_bytes()));
    raw
}

/// The least processor time of several runs, as the peers measure it.
fn best<T>(repeats: usize, mut run: impl FnMut() -> T) -> (Duration, T) {
    let mut last = None;
    let mut best = Duration::MAX;
    for _ in 0..repeats.max(1) {
        drop(last.take());
        let start = ThreadTime::now();
        last = Some(black_box(run()));
        best = best.min(start.elapsed());
    }
    (best, last.expect("at least one repeat"))
}

/// Resident memory of this process in bytes, by the name the system gives it; 0 where it does not tell.
fn resident(name: &str) -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix(name));
    line.and_then(|l| l.trim().trim_end_matches(" kB").parse::<u64>().ok()).map_or(0, |kib| kib * 1024)
}

fn print(op: &str, value: f64, unit: &str) {
    println!("meshwright\t{op}\t{value:.3}\t{unit}");
}

fn nanos(took: Duration) -> f64 {
    took.as_nanos() as f64
}

struct Timer<'a> {
    repeats: usize,
    /// The one operation that is timed; empty for all.
    only: &'a str,
}

impl Timer<'_> {
    fn wants(&self, op: &str) -> bool {
        self.only.is_empty() || self.only == op
    }

    /// Times an operation in seconds, if it is wanted.
    fn seconds<T>(&self, op: &str, run: impl FnMut() -> T) -> Option<T> {
        self.wants(op).then(|| {
            let (took, last) = best(self.repeats, run);
            print(op, took.as_secs_f64(), "s");
            last
        })
    }

    /// The same where each run changes a mesh of its own, which is made before the clock starts.
    fn seconds_on(&self, op: &str, mesh: &Mesh, per: f64, unit: &str, mut run: impl FnMut(&mut Mesh)) {
        if self.wants(op) {
            let once = |_| {
                let mut mesh = mesh.clone();
                best(1, || run(&mut mesh)).0
            };
            let took = (0..self.repeats.max(1)).map(once).min().unwrap_or_default();
            print(op, took.as_secs_f64() / per, unit);
        }
    }

    fn mesh(&self, pool: &IndexedMesh) {
        let (vertices, faces) = (pool.vertex_count() as f64, pool.face_count() as f64);
        if self.wants("memory") {
            // Forgets the peak of reading the file, where the system allows that.
            let _ = fs::write("/proc/self/clear_refs", "5");
            let before = resident("VmRSS:");
            let mesh = Mesh::build(pool).expect("a manifold");
            let above = |now: u64| now.saturating_sub(before) as f64 / faces;
            print("peak", above(resident("VmHWM:")), "bytes/face");
            // More than the mesh holds: the allocator keeps freed blocks. MALLOC_MMAP_THRESHOLD_=65536 gives them back.
            print("resident", above(resident("VmRSS:")), "bytes/face");
            print("memory", mesh.heap_bytes() as f64 / faces, "bytes/face");
        }
        if self.wants("build") {
            let (build, _) = best(self.repeats, || Mesh::build(pool).expect("a manifold"));
            print("build", nanos(build) / faces, "ns/face");
        }
        let mut mesh = Mesh::build(pool).expect("a manifold");
        if self.wants("memory") {
            // The first element that is removed and the first that is added make the arenas keep versions.
            let f = mesh.faces().next().expect("a face");
            mesh.poke_face(f, DVec3::ZERO).and_then(|new| Ok(mesh.dissolve_vertex(new.vertex))).ok();
            print("memory_edited", mesh.heap_bytes() as f64 / faces, "bytes/face");
            mesh = Mesh::build(pool).expect("a manifold");
        }
        if self.wants("ring") {
            let ring = |mesh: &Mesh| {
                let mut sum = DVec3::ZERO;
                for v in mesh.vertices() {
                    for n in mesh.neighbors(v) {
                        sum += mesh.position(n);
                    }
                }
                sum.element_sum()
            };
            let (took, sum) = best(self.repeats, || ring(&mesh));
            print("ring", nanos(took) / vertices, "ns/vertex");
            print("ring_checksum", sum, "length");
            let (took, near) = best(self.repeats, || mesh.reorder());
            print("reorder", nanos(took) / faces, "ns/face");
            let (took, sum) = best(self.repeats, || ring(&near));
            print("ring_ordered", nanos(took) / vertices, "ns/vertex");
            print("ring_ordered_checksum", sum, "length");
        }
        if self.wants("validate") {
            let (validate, verdict) = best(self.repeats, || mesh.validate());
            verdict.expect("valid");
            print("validate", nanos(validate) / faces, "ns/face");
        }
        if self.wants("boundary") {
            let (boundary, count) = best(self.repeats, || mesh.boundary_halfedges().count());
            print("boundary", nanos(boundary) / mesh.edge_count() as f64, "ns/edge");
            print("boundary_edges", count as f64, "edges");
        }
        if self.wants("to_indexed") {
            let (back, pool) = best(self.repeats, || mesh.to_indexed());
            print("to_indexed", nanos(back) / pool.face_count() as f64, "ns/face");
        }
    }

    fn operations(&self, pool: &IndexedMesh) {
        let mesh = Mesh::build(pool).expect("a manifold");
        for (name, scheme) in [
            ("midpoint", Scheme::Midpoint),
            ("loop", Scheme::Loop),
            ("catmull_clark", Scheme::CatmullClark),
            ("sqrt3", Scheme::Sqrt3),
        ] {
            let options = || SubdivideOptions { scheme, ..Default::default() };
            if let Some(fine) = self.seconds(name, || mesh.subdivide(options()).expect("subdivided")) {
                print(&format!("{name}_faces"), fine.value.face_count() as f64, "faces");
            }
        }
        for (name, weight) in [("normals", NormalWeight::Area), ("normals_angle", NormalWeight::Angle)] {
            // Of vertices, which the mesh then carries, and of faces.
            self.seconds_on(name, &mesh, 1.0, "s", |mesh| {
                black_box(mesh.compute_all_normals(weight));
            });
        }
        if let Ok(closed) = mesh.closed() {
            let volume = self.seconds("volume", || closed.volume());
            volume.into_iter().for_each(|volume| print("volume_checksum", volume, "volume"));
        }
        let parts = self.seconds("components", || mesh.components().len());
        parts.into_iter().for_each(|parts| print("components_edges", parts as f64, "parts"));
        let taubin = SmoothMethod::Taubin { mu: -0.53 };
        for (name, method, per, unit) in [
            ("laplacian", SmoothMethod::Laplacian, 10.0, "s/iteration"),
            ("cotangent", SmoothMethod::Cotangent, 10.0, "s/iteration"),
            ("laplacian10", SmoothMethod::Laplacian, 1.0, "s"),
            ("taubin10", taubin, 1.0, "s"),
        ] {
            let options = || SmoothOptions { method, iterations: 10, ..Default::default() };
            self.seconds_on(name, &mesh, per, unit, |mesh| {
                mesh.smooth(options()).expect("smoothed");
            });
        }
        self.seconds("weld", || mesh.weld(WeldOptions { tolerance: 1e-9, ..Default::default() }));
    }

    fn soups(&self, pool: &IndexedMesh) {
        // Every other face reversed.
        let mut mixed = pool.polygons().clone();
        (1..mixed.len()).step_by(2).for_each(|f| mixed.reverse(f));
        let mixed = IndexedMesh::new(pool.positions().to_vec(), mixed).expect("valid");
        let unified = self.seconds("unify", || unify_winding(&mixed.topology()).expect("orientable"));
        if let Some(unified) = unified {
            print("unify_flipped", unified.report.records.len() as f64, "faces");
        }
        drop(mixed);
        // Every face with corners of its own, as in an STL file.
        let corners = pool.polygons().corners();
        let points = corners.iter().map(|&v| pool.positions()[v as usize]).collect();
        let single: Vec<[u32; 3]> =
            (0..corners.len() as u32 / 3).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
        let soup = PolygonSoup::new(points, Polygons::from_triangles(&single));
        let welded = self.seconds("weld_soup", || cleanup::index(&soup, Weld::Exact).expect("any soup"));
        if let Some(welded) = welded {
            print("weld_soup_edges", welded.value.vertex_count() as f64, "vertices");
        }
        let made = self.seconds("soup_to_mesh", || {
            let made = cleanup::clean(&soup, CleanOptions::default()).expect("any soup");
            made.value.validate().expect("valid");
            made
        });
        if let Some(made) = made {
            print("soup_to_mesh_faces", made.value.face_count() as f64, "faces");
        }
    }
}
