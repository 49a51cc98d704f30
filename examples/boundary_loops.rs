//! Lists the boundary loops of a mesh with a hole: naked edges in order, ready to be filled or measured.

use meshwright::glam::dvec3;
use meshwright::{IndexedMesh, Mesh, Polygons};
use std::error::Error;

/// A square frame of eight quads; the length of each of its boundary loops.
pub(crate) fn run() -> Result<Vec<f64>, Box<dyn Error>> {
    let points = (0..16).map(|i| dvec3(f64::from(i % 4), f64::from(i / 4), 0.0)).collect();
    let quads = (0..9).filter(|&i| i != 4).map(|i| i % 3 + i / 3 * 4);
    let faces: Polygons = quads.map(|a| [a, a + 1, a + 5, a + 4]).collect();
    let mesh = Mesh::build(&IndexedMesh::new(points, faces)?)?;

    let length = |h| mesh.position(mesh.origin(h)).distance(mesh.position(mesh.target(h)));
    Ok(mesh.boundary_loops().into_iter().map(|l| l.into_iter().map(length).sum()).collect())
}

#[allow(dead_code, reason = "the tests call run")]
fn main() -> Result<(), Box<dyn Error>> {
    for length in run()? {
        println!("a boundary loop of length {length}");
    }
    Ok(())
}
