//! Peers from crates.io on one shape, one line per operation as every program here prints them.
//!
//! `meshwright-peers mesh SHAPE.raw REPEATS [REDUCED.ply]`: alum, halfedge, meshopt. `query QUESTIONS REPEATS`: parry3d. `obj FILE REPEATS`: tobj.

use cpu_time::ThreadTime;
use parry3d_f64::math::Vector;
use parry3d_f64::query::{PointQuery, Ray, RayCast};
use parry3d_f64::shape::TriMesh;
use alum::{HasIterators, HasTopology};
use std::error::Error;
use std::hint::black_box;
use std::{env, fs};

/// Numbers of a little-endian file, taken from the front.
struct Numbers<'b>(&'b [u8]);

impl Numbers<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let (head, rest) = self.0.split_at(N);
        self.0 = rest;
        head.try_into().expect("N bytes")
    }

    fn count(&mut self) -> usize {
        u64::from_le_bytes(self.take()) as usize
    }

    fn floats<const N: usize>(&mut self, count: usize) -> Vec<[f64; N]> {
        (0..count).map(|_| [(); N].map(|()| f64::from_le_bytes(self.take()))).collect()
    }

    fn triangles(&mut self, count: usize) -> Vec<[u32; 3]> {
        (0..count).map(|_| [(); 3].map(|()| u32::from_le_bytes(self.take()))).collect()
    }
}

fn seconds<T>(repeats: usize, mut run: impl FnMut() -> T) -> (f64, T) {
    let mut best = f64::INFINITY;
    let mut last = None;
    for _ in 0..repeats.max(1) {
        drop(last.take());
        let start = ThreadTime::now();
        last = Some(black_box(run()));
        best = best.min(start.elapsed().as_secs_f64());
    }
    (best, last.expect("at least one run"))
}

fn print(name: &str, operation: &str, value: f64, unit: &str) {
    println!("{name}\t{operation}\t{value:.3}\t{unit}");
}

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = env::args().collect();
    let [_, what, file, repeats, rest @ ..] = &args[..] else {
        return Err("usage: meshwright-peers mesh|query|obj FILE REPEATS [REDUCED.ply]".into());
    };
    let repeats: usize = repeats.parse()?;
    let raw = fs::read(file)?;
    match what.as_str() {
        "mesh" => meshes(Numbers(&raw), repeats, rest.first().map(String::as_str)),
        "query" => query(Numbers(&raw), repeats),
        "obj" => {
            let read = || tobj::load_obj_buf(&mut &raw[..], &tobj::LoadOptions::default(), |_| Ok(Default::default()));
            let (took, found) = seconds(repeats, read);
            print("tobj", "read_obj", raw.len() as f64 / took / 1e6, "MB/s");
            print("tobj", "read_obj_found", found?.0.iter().map(|m| m.mesh.indices.len() / 3).sum::<usize>() as f64, "faces");
            Ok(())
        }
        _ => Err("mesh, query or obj".into()),
    }
}

fn meshes(mut raw: Numbers<'_>, repeats: usize, reduced: Option<&str>) -> Result<(), Box<dyn Error>> {
    let (vertices, faces) = (raw.count(), raw.count());
    let points: Vec<[f64; 3]> = raw.floats(vertices);
    let triangles = raw.triangles(faces);

    let before = resident();
    let (took, mesh) = seconds(repeats, || build_alum(&points, &triangles));
    print("alum", "resident", resident().saturating_sub(before) as f64 / faces as f64, "bytes/face");
    print("alum", "build", took * 1e9 / faces as f64, "ns/face");
    let (took, sum) = seconds(repeats, || {
        let points = mesh.points();
        let points = points.try_borrow().expect("points");
        let mut sum = alum::DVec3(0.0, 0.0, 0.0);
        for v in mesh.vertices() {
            for n in mesh.vv_ccw_iter(v) {
                sum = sum + points[n];
            }
        }
        sum.0 + sum.1 + sum.2
    });
    print("alum", "ring", took * 1e9 / vertices as f64, "ns/vertex");
    print("alum", "ring_checksum", sum, "length");
    drop(mesh);
    // A copy of this mesh is not faster than building it again.
    let changed = |op: &str, run: &dyn Fn(&mut alum::PolyMeshF64)| {
        let mut best = f64::INFINITY;
        for _ in 0..repeats.max(1) {
            let mut mesh = build_alum(&points, &triangles);
            let start = ThreadTime::now();
            run(&mut mesh);
            best = best.min(start.elapsed().as_secs_f64());
        }
        print("alum", op, best, "s");
    };
    changed("loop", &|m| m.subdivide_loop(1, true).expect("loop"));
    changed("catmull_clark", &|m| m.subdivide_catmull_clark(1, true).expect("catmull-clark"));
    changed("sqrt3", &|m| {
        m.subdivide_sqrt3(1, false).expect("sqrt3");
    });
    changed("normals", &|m| {
        m.update_face_normals().expect("normals");
        m.update_vertex_normals_fast().expect("normals");
    });

    let before = resident();
    let (took, mesh) = seconds(1, || build_halfedge(&points, &triangles));
    print("halfedge", "resident", resident().saturating_sub(before) as f64 / faces as f64, "bytes/face");
    print("halfedge", "build", took * 1e9 / faces as f64, "ns/face");
    let (took, sum) = seconds(1, || {
        let mut sum = [0.0; 3];
        for v in mesh.vertex_ids() {
            for h in halfedge::traversal::VertexRingLazy::new(&mesh, v) {
                let end = mesh.get_halfedge(h).and_then(|h| mesh.get_vertex(h.vertex)).expect("a vertex");
                (0..3).for_each(|i| sum[i] += end.position[i]);
            }
        }
        sum.iter().sum::<f64>()
    });
    print("halfedge", "ring", took * 1e9 / vertices as f64, "ns/vertex");
    print("halfedge", "ring_checksum", sum, "length");
    drop(mesh);

    // Single precision is all it has.
    let single: Vec<f32> = points.iter().flatten().map(|&x| x as f32).collect();
    let bytes: Vec<u8> = single.iter().flat_map(|x| x.to_ne_bytes()).collect();
    let adapter = meshopt::VertexDataAdapter::new(&bytes, 12, 0)?;
    let indices: Vec<u32> = triangles.iter().flatten().copied().collect();
    let options = meshopt::SimplifyOptions::empty();
    let (took, few) = seconds(repeats, || {
        meshopt::simplify(&indices, &adapter, faces / 10 * 3, f32::MAX, options, None)
    });
    print("meshopt_f32", "reduce", took, "s");
    print("meshopt_f32", "reduce_faces", (few.len() / 3) as f64, "faces");
    if let Some(path) = reduced {
        fs::write(path, ply(&points, &few))?;
    }
    Ok(())
}

fn build_alum(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> alum::PolyMeshF64 {
    let mut mesh =
        alum::PolyMeshF64::with_capacity(points.len(), points.len() + triangles.len(), triangles.len());
    for &[x, y, z] in points {
        mesh.add_vertex(alum::DVec3(x, y, z)).expect("a vertex");
    }
    for t in triangles {
        let [a, b, c] = t.map(alum::VH::from);
        mesh.add_tri_face(a, b, c).expect("a face");
    }
    mesh
}

fn build_halfedge(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> halfedge::MeshStorage {
    halfedge::build_mesh_from_vertices_and_faces(points, triangles).expect("a mesh")
}

/// Resident memory of this process in bytes; 0 where the system does not tell.
fn resident() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmRSS:"));
    line.and_then(|l| l.trim().trim_end_matches(" kB").parse::<u64>().ok()).map_or(0, |kib| kib * 1024)
}

fn ply(points: &[[f64; 3]], indices: &[u32]) -> Vec<u8> {
    let mut number = vec![u32::MAX; points.len()];
    let mut used = Vec::new();
    for &i in indices {
        if number[i as usize] == u32::MAX {
            number[i as usize] = used.len() as u32;
            used.push(points[i as usize]);
        }
    }
    let mut out = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        used.len(),
        indices.len() / 3
    )
    .into_bytes();
    out.extend(used.iter().flatten().flat_map(|x| x.to_le_bytes()));
    for t in indices.chunks_exact(3) {
        out.push(3);
        out.extend(t.iter().flat_map(|&i| number[i as usize].to_le_bytes()));
    }
    out
}

fn query(mut raw: Numbers<'_>, repeats: usize) -> Result<(), Box<dyn Error>> {
    let counts = [(); 4].map(|()| raw.count());
    let vector = |[x, y, z]: [f64; 3]| Vector::new(x, y, z);
    let points: Vec<Vector> = raw.floats(counts[0]).into_iter().map(vector).collect();
    let triangles = raw.triangles(counts[1]);
    let rays: Vec<[f64; 6]> = raw.floats(counts[2]);
    let queries: Vec<[f64; 3]> = raw.floats(counts[3]);
    let (took, mesh) = seconds(repeats, || TriMesh::new(points.clone(), triangles.clone()));
    let mesh = mesh?;
    print("parry", "index", took, "s");
    let rays: Vec<Ray> =
        rays.iter().map(|&[x, y, z, u, v, w]| Ray::new(vector([x, y, z]), vector([u, v, w]))).collect();
    let (took, found) =
        seconds(repeats, || rays.iter().filter(|r| mesh.cast_local_ray(r, f64::MAX, false).is_some()).count());
    print("parry", "first_hit", rays.len() as f64 / took / 1e3, "thousand/s");
    print("parry", "first_hit_found", found as f64, "answers");
    let (took, sum) = seconds(repeats, || {
        queries.iter().map(|&p| (mesh.project_local_point(vector(p), false).point - vector(p)).length()).sum::<f64>()
    });
    print("parry", "closest_point", queries.len() as f64 / took / 1e3, "thousand/s");
    print("parry", "closest_point_checksum", sum, "length");
    Ok(())
}
