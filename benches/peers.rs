//! Our side of the comparison with C++ peers; `benches/peers/run.sh` runs both in turns.
//!
//! `cargo bench --bench peers -- --write DIR` writes the shapes: a sphere in the order of subdivision, the same
//! shuffled, and a grid; `-- --time FILE [--repeats N]` times one of them and
//! prints a line per operation: name, operation, value, unit. A file holds, little-endian: `u64` vertices, `u64`
//! triangles, three `f64` a vertex, three `u32` a triangle.

#[path = "../tests/shapes/mod.rs"]
mod shapes;

use cpu_time::ThreadTime;
use meshwright::glam::DVec3;
use meshwright::{IndexedMesh, Mesh, Scheme, SmoothMethod, SmoothOptions, SubdivideOptions, WeldOptions};
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
    match value("--time") {
        Some(file) => time(&shapes::from_raw(&fs::read(file)?)?, repeats),
        None => time(&shapes::icosphere(6), repeats),
    }
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

fn time(pool: &IndexedMesh, repeats: usize) {
    let (vertices, faces) = (pool.vertex_count() as f64, pool.face_count() as f64);
    let print = |op: &str, value: f64, unit: &str| println!("meshwright\t{op}\t{value:.3}\t{unit}");
    let nanos = |d: Duration| d.as_nanos() as f64;

    // Forgets the peak of reading the file, where the system allows that.
    let _ = fs::write("/proc/self/clear_refs", "5");
    let before = resident("VmRSS:");
    let mesh = Mesh::build(pool).expect("a manifold");
    let above = |now: u64| now.saturating_sub(before) as f64 / faces;
    print("peak", above(resident("VmHWM:")), "bytes/face");
    // More than the mesh holds: the allocator keeps freed blocks. MALLOC_MMAP_THRESHOLD_=65536 gives them back.
    print("resident", above(resident("VmRSS:")), "bytes/face");
    print("memory", mesh.heap_bytes() as f64 / faces, "bytes/face");
    drop(mesh);

    let (build, mesh) = best(repeats, || Mesh::build(pool).expect("a manifold"));
    print("build", nanos(build) / faces, "ns/face");
    let ring = |mesh: &Mesh| {
        let mut sum = DVec3::ZERO;
        for v in mesh.vertices() {
            for n in mesh.neighbors(v) {
                sum += mesh.position(n);
            }
        }
        sum.element_sum()
    };
    let (took, sum) = best(repeats, || ring(&mesh));
    print("ring", nanos(took) / vertices, "ns/vertex");
    print("ring_checksum", sum, "length");
    let (took, near) = best(repeats, || mesh.reorder());
    print("reorder", nanos(took) / faces, "ns/face");
    let (took, sum) = best(repeats, || ring(&near));
    print("ring_ordered", nanos(took) / vertices, "ns/vertex");
    print("ring_ordered_checksum", sum, "length");
    drop(near);
    let (validate, verdict) = best(repeats, || mesh.validate());
    verdict.expect("valid");
    print("validate", nanos(validate) / faces, "ns/face");
    let (boundary, count) = best(repeats, || mesh.boundary_halfedges().count());
    print("boundary", nanos(boundary) / mesh.edge_count() as f64, "ns/edge");
    print("boundary_edges", count as f64, "edges");
    for (name, scheme) in [
        ("midpoint", Scheme::Midpoint),
        ("loop", Scheme::Loop),
        ("catmull_clark", Scheme::CatmullClark),
        ("sqrt3", Scheme::Sqrt3),
    ] {
        let options = || SubdivideOptions { scheme, ..Default::default() };
        let (took, fine) = best(repeats, || mesh.subdivide(options()).expect("subdivided"));
        print(name, took.as_secs_f64(), "s");
        drop(fine);
    }
    for (name, method) in [("laplacian", SmoothMethod::Laplacian), ("cotangent", SmoothMethod::Cotangent)] {
        let mut mesh = mesh.clone();
        let options = || SmoothOptions { method, iterations: 10, ..Default::default() };
        let (took, _) = best(repeats, || mesh.smooth(options()).expect("smoothed"));
        print(name, took.as_secs_f64() / 10.0, "s/iteration");
    }
    let (took, _) = best(repeats, || mesh.weld(WeldOptions { tolerance: 1e-9, ..Default::default() }));
    print("weld", took.as_secs_f64(), "s");
    let (back, pool) = best(repeats, || mesh.to_indexed());
    print("to_indexed", nanos(back) / pool.face_count() as f64, "ns/face");
}
