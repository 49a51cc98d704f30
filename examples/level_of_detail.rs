//! Simplifies a part for level of detail: three levels, each with what it costs in accuracy.

use meshwright::glam::{DVec3, dvec3};
use meshwright::{IndexedMesh, Mesh, Polygons, ReduceOptions, ReduceTarget, Stopped};
use std::error::Error;

/// One level.
pub(crate) struct Level {
    pub(crate) mesh: Mesh,
    pub(crate) stopped: Stopped,
    /// The largest error of a collapse, as a share of the size of the part.
    pub(crate) error: f64,
    /// By how much the volume differs, as a share of it.
    pub(crate) volume: f64,
}

/// A knotted tube of `n` by `m` quads.
fn knot(n: u32, m: u32) -> Result<IndexedMesh, Box<dyn Error>> {
    let turn = |i: u32, n: u32| f64::from(i) / f64::from(n) * std::f64::consts::TAU;
    let center =
        |t: f64| dvec3(t.sin() + 2.0 * (2.0 * t).sin(), t.cos() - 2.0 * (2.0 * t).cos(), -(3.0 * t).sin());
    let point = |i: u32, j: u32| {
        let t = turn(i, n);
        let along = (center(t + 1e-4) - center(t - 1e-4)).normalize();
        let across = along.cross(DVec3::Z).normalize();
        let (s, c) = turn(j, m).sin_cos();
        center(t) + 0.4 * (across * c + across.cross(along) * s)
    };
    let points = (0..n).flat_map(|i| (0..m).map(move |j| (i, j))).map(|(i, j)| point(i, j)).collect();
    let at = |i: u32, j: u32| i % n * m + j % m;
    let quads: Polygons = (0..n * m)
        .map(|k| (k / m, k % m))
        .map(|(i, j)| vec![at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)])
        .collect();
    Ok(IndexedMesh::new(points, quads)?)
}

/// Each level from the one before: half the work of starting anew, and the errors add up.
pub(crate) fn run() -> Result<Vec<Level>, Box<dyn Error>> {
    let pool = knot(240, 24)?;
    let bounds = pool.bounds().ok_or("points")?;
    let size = bounds.max.distance(bounds.min);
    let mut mesh = Mesh::build(&pool)?;
    let volume = mesh.closed()?.volume();
    let mut levels = Vec::new();
    for faces in [4000, 1000, 250] {
        let account =
            mesh.reduce(ReduceOptions { target: ReduceTarget::Faces(faces), ..Default::default() })?;
        levels.push(Level {
            stopped: account.stopped,
            error: account.max_error / size,
            volume: mesh.closed()?.volume() / volume - 1.0,
            mesh: mesh.clone(),
        });
    }
    Ok(levels)
}

#[allow(dead_code, reason = "the tests call run")]
fn main() -> Result<(), Box<dyn Error>> {
    for level in run()? {
        println!(
            "{:5} faces ({}), error at most {:.4} % of the size, volume {:+.4} %",
            level.mesh.face_count(),
            level.stopped,
            100.0 * level.error,
            100.0 * level.volume
        );
    }
    Ok(())
}
