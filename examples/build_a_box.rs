//! Builds a box by hand, vertex by vertex and face by face, and weighs it.

use meshwright::Mesh;
use meshwright::glam::dvec3;
use std::error::Error;

/// A box of the given size, one corner at the origin.
pub(crate) fn run(size: [f64; 3]) -> Result<Mesh, Box<dyn Error>> {
    let mut mesh = Mesh::default();
    let [x, y, z] = size;
    let mut at = |i: usize, j: usize, k: usize| mesh.add_vertex(dvec3([0.0, x][i], [0.0, y][j], [0.0, z][k]));
    let [a, b, c, d] = [at(0, 0, 0)?, at(1, 0, 0)?, at(1, 1, 0)?, at(0, 1, 0)?];
    let [e, f, g, h] = [at(0, 0, 1)?, at(1, 0, 1)?, at(1, 1, 1)?, at(0, 1, 1)?];
    // Counter-clockwise as seen from outside: bottom, top, and the four sides.
    for face in [[a, d, c, b], [e, f, g, h], [a, b, f, e], [b, c, g, f], [c, d, h, g], [d, a, e, h]] {
        mesh.add_face(&face)?;
    }
    Ok(mesh)
}

#[allow(dead_code, reason = "the tests call run")]
fn main() -> Result<(), Box<dyn Error>> {
    let mesh = run([2.0, 3.0, 4.0])?;
    mesh.validate()?;
    let closed = mesh.closed()?;
    println!("volume {}, area {}", closed.volume(), closed.area());
    Ok(())
}
