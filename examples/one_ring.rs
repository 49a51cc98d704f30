//! Walks the one-ring of every vertex: the umbrella's mean, as smoothing wants it.

use meshwright::glam::{DVec3, dvec3};
use meshwright::{IndexedMesh, Mesh, Polygons};
use std::error::Error;

/// A pyramid without its base, and how far each vertex lies from the mean of its neighbours.
pub(crate) fn run() -> Result<Vec<f64>, Box<dyn Error>> {
    let points = vec![DVec3::ZERO, DVec3::X, dvec3(1., 1., 0.), DVec3::Y, dvec3(0.5, 0.5, 1.)];
    let faces = Polygons::from(vec![vec![0, 1, 4], vec![1, 2, 4], vec![2, 3, 4], vec![3, 0, 4]]);
    let mesh = Mesh::build(&IndexedMesh::new(points, faces)?)?;

    let mut distances = Vec::new();
    for v in mesh.vertices() {
        let ring = mesh.neighbors(v).map(|n| mesh.position(n));
        let mean = ring.sum::<DVec3>() / mesh.valence(v) as f64;
        distances.push(mean.distance(mesh.position(v)));
    }
    Ok(distances)
}

#[allow(dead_code, reason = "the tests call run")]
fn main() -> Result<(), Box<dyn Error>> {
    for (v, distance) in run()?.into_iter().enumerate() {
        println!("vertex {v}: {distance:.3} from the mean of its neighbours");
    }
    Ok(())
}
