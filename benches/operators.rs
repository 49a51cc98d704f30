//! What operators cost, alone and with user data.
//!
//! `cargo bench --bench operators` times a mix of all operators on 100,000 faces, in operations a second, refusals
//! included; `-- --faces N` on another number, `-- --columns` with a column of each kind.
//!
//! `-- --callgrind OP FACES [COUNT] [COLUMNS]` builds a grid of about so many triangles and does `COUNT` (1,000)
//! operations spread over it: OP is flip, split or collapse, COLUMNS a list of vertex, corner, edge and face. The
//! instructions of a run with 0 operations, subtracted, leave those of the operations. For the table of all:
//!
//! ```text
//! cargo bench --bench operators -- --callgrind-table
//! ```
//!
//! It runs itself under valgrind, which must be installed.
//!
//! `-- --time FILE [--repeats N]` is our side of `benches/peers/run.sh`: 100,000 random edges of a shape.

#[path = "../tests/shapes/mod.rs"]
mod shapes;

use cpu_time::ThreadTime;
use meshwright::glam::DVec3;
use meshwright::{EdgeKey, FaceKey, HalfedgeKey, IndexedMesh, Mesh, Rule, VertexKey};
use shapes::Noise;
use std::error::Error;
use std::hint::black_box;
use std::process::Command;
use std::{env, fs};

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = env::args().skip(1).filter(|a| a != "--bench").collect();
    let words: Vec<&str> = args.iter().map(String::as_str).collect();
    match words[..] {
        ["--callgrind", op, faces, ref rest @ ..] => {
            let count = rest.first().map_or(Ok(1000), |n| n.parse())?;
            let mut mesh = sheet(faces.parse()?);
            add_columns(&mut mesh, rest.get(1).copied().unwrap_or_default());
            spread(&mut mesh, op, count)
        }
        ["--callgrind-table"] => callgrind_table(),
        ["--time", file, ref rest @ ..] => {
            let repeats = if let ["--repeats", n] = rest { n.parse()? } else { 5 };
            time_peers(&shapes::from_raw(&fs::read(file)?)?, repeats);
            Ok(())
        }
        _ => {
            let faces = words.iter().skip_while(|w| **w != "--faces").nth(1);
            let columns = if words.contains(&"--columns") { "vertex,corner,edge,face" } else { "" };
            time_mix(faces.map_or(Ok(100_000), |n| n.parse())?, columns);
            Ok(())
        }
    }
}

/// A triangle grid of about so many faces.
fn sheet(faces: usize) -> Mesh {
    shapes::mesh(&shapes::grid((faces as f64 / 2.0).sqrt().ceil() as u32))
}

fn add_columns(mesh: &mut Mesh, kinds: &str) {
    for kind in kinds.split(',') {
        match kind {
            "vertex" => drop(mesh.add_vertex_column(0.0, Rule::interpolate())),
            "corner" => drop(mesh.add_corner_column([0.0, 0.0], Rule::interpolate())),
            "edge" => drop(mesh.add_edge_column(0u8, Rule::keep())),
            "face" => drop(mesh.add_face_column(0u32, Rule::keep())),
            _ => {}
        }
    }
}

/// One operation at an edge; whether it was done.
#[inline]
fn operate(mesh: &mut Mesh, op: &str, e: EdgeKey) -> bool {
    operate_at(mesh, op, e, mesh.edge_halfedge(e))
}

/// One operation at an edge, given by one of its half-edges too.
#[inline]
fn operate_at(mesh: &mut Mesh, op: &str, e: EdgeKey, h: HalfedgeKey) -> bool {
    match op {
        "flip" => mesh.flip_edge(e).is_ok(),
        "split" => {
            let middle = mesh.position(mesh.origin(h)).midpoint(mesh.position(mesh.target(h)));
            mesh.split_edge_and_faces(e, middle).is_ok()
        }
        _ => mesh.collapse_into_target(h).is_ok(),
    }
}

/// Operations at edges that lie far apart.
fn spread(mesh: &mut Mesh, op: &str, count: usize) -> Result<(), Box<dyn Error>> {
    if !["flip", "split", "collapse"].contains(&op) {
        return Err(format!("no operation {op}: flip, split or collapse").into());
    }
    let is_inside = |h: HalfedgeKey| !mesh.is_boundary_vertex(mesh.origin(h));
    let all: Vec<EdgeKey> = mesh
        .edges()
        .filter(|&e| [mesh.edge_halfedge(e), mesh.twin(mesh.edge_halfedge(e))].into_iter().all(is_inside))
        .collect();
    let edges: Vec<EdgeKey> = (0..1000).map(|i| all[i * all.len() / 1000]).collect();
    // Once beforehand, whatever the count: the first birth after a build doubles the columns, which pays for as many births
    // as there are elements.
    operate(mesh, op, all[all.len() / 2 + 7]);
    let mut done = 0;
    for &e in &edges[..count.min(edges.len())] {
        done += usize::from(mesh.contains_edge(e) && operate(mesh, op, e));
    }
    // On a small mesh some places touch.
    if black_box(done) < count * 95 / 100 {
        return Err(format!("only {done} of {count} operations were done").into());
    }
    Ok(())
}

/// Instructions of one run of this program under callgrind.
fn instructions(op: &str, faces: &str, count: &str, columns: &str) -> Result<f64, Box<dyn Error>> {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(env::current_exe()?)
        .args(["--callgrind", op, faces, count, columns])
        .output()?;
    let text = String::from_utf8_lossy(&output.stderr);
    let line = text.lines().find_map(|l| l.split_once("Collected : ")).ok_or_else(|| text.to_string())?;
    Ok(line.1.trim().parse()?)
}

fn callgrind_table() -> Result<(), Box<dyn Error>> {
    println!("instructions an operation, mean of 1,000");
    for op in ["flip", "split", "collapse"] {
        let cost = |faces: &str, columns: &str| -> Result<f64, Box<dyn Error>> {
            let all = instructions(op, faces, "1000", columns)?;
            Ok((all - instructions(op, faces, "0", columns)?) / 1000.0)
        };
        let (small, large) = (cost("10000", "")?, cost("1000000", "")?);
        println!("{op}\t10k faces {small:.0}\t1M faces {large:.0}\tratio {:.3}", large / small);
        for columns in ["vertex", "corner", "edge", "face"] {
            let with = cost("10000", columns)?;
            println!("{op}\twith a {columns} column {with:.0}\t{:+.0}", with - small);
        }
    }
    Ok(())
}

/// Elements to pick from, refreshed now and then: picking is not what is timed.
struct Picks {
    edges: Vec<EdgeKey>,
    faces: Vec<FaceKey>,
    vertices: Vec<VertexKey>,
    noise: Noise,
}

impl Picks {
    fn new(mesh: &Mesh, seed: u64) -> Self {
        let (edges, faces, vertices) =
            (mesh.edges().collect(), mesh.faces().collect(), mesh.vertices().collect());
        Self { edges, faces, vertices, noise: Noise(seed) }
    }

    fn edge(&mut self) -> EdgeKey {
        self.edges[self.noise.below(self.edges.len() as u32) as usize]
    }

    fn face(&mut self) -> FaceKey {
        self.faces[self.noise.below(self.faces.len() as u32) as usize]
    }

    fn vertex(&mut self) -> VertexKey {
        self.vertices[self.noise.below(self.vertices.len() as u32) as usize]
    }
}

/// The operators of the mix, in the order of `mixed`.
const MIX: [&str; 14] = [
    "flip_edge",
    "split_edge",
    "split_edge_and_faces",
    "collapse",
    "poke_face",
    "dissolve_vertex",
    "join_faces",
    "triangulate_face",
    "split_face",
    "split_vertex",
    "remove_face",
    "fill_hole",
    "add_face",
    "set_position",
];

/// One operator of the mix at a random place; whether it was done. Dead keys are refused like anything else.
fn mixed(mesh: &mut Mesh, picks: &mut Picks, kind: usize) -> bool {
    let e = picks.edge();
    let Some(h) = mesh.get_edge_halfedge(e) else { return mesh.flip_edge(e).is_ok() };
    match kind {
        0 => mesh.flip_edge(e).is_ok(),
        1 => mesh.split_edge(e, mesh.position(mesh.origin(h))).is_ok(),
        2 => mesh.split_edge_and_faces(e, mesh.position(mesh.origin(h))).is_ok(),
        3 => mesh.collapse_into_target(h).is_ok(),
        4 => mesh.poke_face(picks.face(), mesh.position(mesh.origin(h))).is_ok(),
        5 => mesh.dissolve_vertex(picks.vertex()).is_ok(),
        6 => mesh.join_faces(e).is_ok(),
        7 => mesh.triangulate_face(picks.face()).is_ok(),
        8 => mesh.split_face(h, mesh.next(mesh.next(h))).is_ok(),
        9 => mesh.split_vertex(h, h, mesh.position(mesh.origin(h))).is_ok(),
        10 => mesh.remove_face(picks.face()).is_ok(),
        11 => {
            let Some(v) = mesh.get_vertex_halfedge(picks.vertex()).flatten() else { return false };
            mesh.fill_hole(v).is_ok()
        }
        12 => {
            let corners = [mesh.origin(h), mesh.target(h), mesh.target(mesh.next(h))];
            mesh.add_face(&corners).is_ok()
        }
        _ => mesh.set_position(mesh.origin(h), DVec3::ONE).is_ok(),
    }
}

fn time_mix(faces: usize, columns: &str) {
    let mut mesh = sheet(faces);
    add_columns(&mut mesh, columns);
    println!("{} faces, columns: {}", mesh.face_count(), if columns.is_empty() { "none" } else { columns });
    let (mut tries, mut seconds) = (0u32, 0.0);
    let (mut done, mut each) = ([0u32; MIX.len()], [(0u32, 0.0f64); MIX.len()]);
    for round in 0..20 {
        // As much of each, in batches: the clock is read twice a batch.
        let mut picks = Picks::new(&mesh, round);
        for (kind, count) in done.iter_mut().enumerate() {
            let start = ThreadTime::now();
            for _ in 0..4000 {
                *count += u32::from(mixed(&mut mesh, &mut picks, kind));
            }
            let took = start.elapsed().as_secs_f64();
            each[kind].0 += 4000;
            each[kind].1 += took;
            (tries, seconds) = (tries + 4000, seconds + took);
        }
    }
    mesh.validate().expect("valid");
    let total: u32 = done.iter().sum();
    println!("mix\t{:.2} M operations/s ({tries} tried, {total} done)", f64::from(tries) / seconds / 1e6);
    for (kind, name) in MIX.iter().enumerate() {
        let (tried, took) = each[kind];
        println!(
            "{name}\t{:.0} ns\t{:.0} % done",
            took / f64::from(tried) * 1e9,
            f64::from(done[kind]) / f64::from(tried) * 100.0
        );
    }
}

/// Flips, splits and collapses at the same 100,000 half-edges as the peers: see `picks` in `benches/peers/shape.hpp`.
fn time_peers(pool: &IndexedMesh, repeats: usize) {
    let fresh = shapes::mesh(pool);
    let vertices = fresh.numbering().vertices;
    let pick = |n: usize| {
        let corners = &pool.polygons()[n * 7919 % pool.face_count()];
        let [a, b] = [n, n + 1].map(|i| vertices[corners[i % 3] as usize]);
        fresh.find_halfedge(a, b).expect("a face's edge")
    };
    let picked: Vec<HalfedgeKey> = (0..100_000).map(pick).collect();
    for op in ["flip", "split", "collapse"] {
        let (mut times, mut done) = (Vec::new(), 0);
        for _ in 0..repeats.max(1) {
            let mut mesh = fresh.clone();
            done = 0;
            let start = ThreadTime::now();
            for &h in &picked {
                done += u32::from(mesh.get_edge(h).is_some_and(|e| operate_at(&mut mesh, op, e, h)));
            }
            times.push(start.elapsed().as_nanos() as f64 / picked.len() as f64);
            black_box(&mesh);
        }
        times.sort_by(f64::total_cmp);
        println!("meshwright\t{op}\t{:.3}\tns/edge", times[0]);
        println!("meshwright\t{op}_done\t{done}\tedits");
    }
}
