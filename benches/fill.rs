//! Filling holes: time, area and shape by the length and the kind of the loop.
//!
//! `cargo bench --bench fill [-- KIND]`: a line for each kind and length, filled with least area (up to 2,000 edges), by ears,
//! and by the shared rule for polygons (`fill_hole`, then `triangulate_face`), each with its seconds, its area and the mean
//! shape of its triangles, weighted by area: 1 is equilateral.

#[path = "../tests/shapes/mod.rs"]
mod shapes;

use cpu_time::ThreadTime;
use meshwright::glam::{DVec3, dvec3};
use meshwright::{FaceKey, FillHolesOptions, IndexedMesh, Mesh};
use shapes::Noise;
use std::error::Error;
use std::f64::consts::TAU;

/// A cone below a rim.
fn cone(rim: Vec<DVec3>) -> Result<Mesh, Box<dyn Error>> {
    let n = rim.len() as u32;
    let faces: Vec<[u32; 3]> = (0..n).map(|i| [n, (i + 1) % n, i]).collect();
    let points = rim.into_iter().chain([dvec3(0.0, 0.0, -3.0)]).collect();
    Ok(Mesh::build(&IndexedMesh::from_triangles(points, &faces)?)?)
}

fn rim(kind: &str, n: u32) -> Vec<DVec3> {
    let mut noise = Noise(3);
    let mut point = |i: u32| {
        let turn = f64::from(i) / f64::from(n) * TAU;
        let (r, z) = match kind {
            "flat" => (1.0, 0.0),
            "wavy" => (1.0 + 0.2 * (9.0 * turn).sin(), 0.3 * (4.0 * turn).sin()),
            // Teeth on teeth.
            "rough" => (
                1.0 + 0.2 * (9.0 * turn).sin() + 0.5 * TAU / f64::from(n) * noise.unit(),
                0.02 * noise.unit(),
            ),
            "saw" => (if i.is_multiple_of(2) { 1.0 } else { 0.3 }, 0.2 * (3.0 * turn).sin()),
            "random" => (0.3 + 0.7 * noise.unit(), 0.1 * noise.unit()),
            // Seen along its area vector it crosses itself.
            _ => (1.0 + 0.8 * (3.0 * turn).cos(), (2.0 * turn).sin() * 2.0),
        };
        dvec3(r * turn.cos(), r * turn.sin(), z)
    };
    if kind == "spiral" {
        // There and back along a spiral of ten turns.
        let half = n / 2;
        let at = |i: u32, wide: f64| {
            let turn = 10.0 * TAU * (0.02 + f64::from(i) / f64::from(half));
            let r = turn / TAU / 10.0 + wide;
            dvec3(r * turn.cos(), r * turn.sin(), 0.0)
        };
        return (0..half).map(|i| at(i, 0.03)).chain((0..half).rev().map(|i| at(i, -0.01))).collect();
    }
    (0..n).map(&mut point).collect()
}

/// The area of faces, and the mean of their shapes.
fn quality(mesh: &Mesh, faces: &[FaceKey]) -> (f64, f64) {
    let (mut all, mut shapes) = (0.0, 0.0);
    for &f in faces {
        let p: Vec<DVec3> = mesh.face_vertices(f).map(|v| mesh.position(v)).collect();
        let area = 0.5 * (p[1] - p[0]).cross(p[2] - p[0]).length();
        let squares = p[0].distance_squared(p[1]) + p[1].distance_squared(p[2]) + p[2].distance_squared(p[0]);
        all += area;
        shapes += area * 4.0 * 3f64.sqrt() * area / squares;
    }
    (all, shapes / all)
}

/// A torus of a million triangles with every twentieth face gone, or all of its quads apart.
fn many(kind: &str) -> Result<Mesh, Box<dyn Error>> {
    let torus = shapes::torus(1000, 500);
    if kind == "sheets" {
        let soup = shapes::unwelded(&torus);
        return Ok(Mesh::build(&IndexedMesh::new(soup.positions, soup.polygons)?)?);
    }
    let mut mesh = Mesh::build(&shapes::fanned(&torus))?;
    let mut noise = Noise(1);
    for f in mesh.faces().collect::<Vec<_>>() {
        if noise.below(20) == 0 {
            // Refused where a vertex would get two fans.
            let _ = mesh.remove_face(f);
        }
    }
    Ok(mesh)
}

fn main() -> Result<(), Box<dyn Error>> {
    let only = std::env::args().skip(1).find(|a| a != "--bench");
    for kind in ["many", "sheets"] {
        if only.as_ref().is_some_and(|k| k != kind) {
            continue;
        }
        let mut mesh = many(kind)?;
        let start = ThreadTime::now();
        let account = mesh.fill_holes(FillHolesOptions::default())?;
        let (filled, refused) = (account.filled.len(), account.refused.len());
        println!("{kind}\t{:.3} s\t{filled} filled, {refused} refused", start.elapsed().as_secs_f64());
    }
    for kind in ["flat", "wavy", "rough", "saw", "random", "spiral", "crossing"] {
        if only.as_ref().is_some_and(|k| k != kind) {
            continue;
        }
        for n in [100, 500, 1000, 10_000, 100_000, 1_000_000] {
            let open = cone(rim(kind, n))?;
            let print = |method: &str, time: f64, (area, shape): (f64, f64)| {
                println!("{kind}\t{n}\t{method}\t{time:.4} s\tarea {area:.5}\tshape {shape:.3}");
            };
            for (method, exact_edges) in [("least area", 2000), ("ears", 0)] {
                if method == "least area" && n > 2000 {
                    continue;
                }
                let mut mesh = open.clone();
                let start = ThreadTime::now();
                let options =
                    FillHolesOptions { exact_edges, max_area_ratio: f64::INFINITY, ..Default::default() };
                let account = mesh.fill_holes(options)?;
                let time = start.elapsed().as_secs_f64();
                match account.filled.first() {
                    Some(hole) => print(method, time, quality(&mesh, &hole.faces)),
                    None => println!("{kind}\t{n}\t{method}\t{time:.4} s\t{}", account.refused[0].reason),
                }
            }
            let mut mesh = open.clone();
            let h = mesh.boundary_halfedges().next().ok_or("closed")?;
            let start = ThreadTime::now();
            let f = mesh.fill_hole(h)?;
            let cut = mesh.triangulate_face(f)?;
            let time = start.elapsed().as_secs_f64();
            let faces: Vec<FaceKey> = cut.cuts.iter().map(|c| c.face).chain([f]).collect();
            print("shared rule", time, quality(&mesh, &faces));
        }
    }
    Ok(())
}
