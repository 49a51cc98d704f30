//! Carries texture coordinates through edits: they belong to corners, so that a seam can run along an edge.

use meshwright::glam::{DVec2, DVec3, dvec2, dvec3};
use meshwright::{Column, HalfedgeKey, IndexedMesh, Mesh, Rule};
use std::error::Error;

/// Two squares that share an edge, each a chart of its own: the shared edge is a seam.
pub(crate) fn two_charts() -> Result<(Mesh, Column<HalfedgeKey, DVec2>), Box<dyn Error>> {
    let points = (0..6).map(|i| dvec3(f64::from(i % 3), f64::from(i / 3), 0.0)).collect();
    let faces = vec![vec![0, 1, 4, 3], vec![1, 2, 5, 4]];
    let mut mesh = Mesh::build(&IndexedMesh::new(points, faces.into())?)?;
    let uv = mesh.add_corner_column(DVec2::ZERO, Rule::interpolate());
    for (chart, f) in mesh.faces().collect::<Vec<_>>().into_iter().enumerate() {
        for h in mesh.face_halfedges(f).collect::<Vec<_>>() {
            let p = mesh.position(mesh.origin(h));
            mesh.set_value(uv, h, p.truncate() + dvec2(0.0, 5.0 * chart as f64))?;
        }
    }
    Ok((mesh, uv))
}

/// The texture coordinates at a new vertex halfway up the seam, one for each side.
pub(crate) fn run() -> Result<Vec<DVec2>, Box<dyn Error>> {
    let (mut mesh, uv) = two_charts()?;
    let seam = mesh.edges().find(|&e| mesh.is_seam(uv, e)).ok_or("no seam")?;
    let middle = mesh.split_edge(seam, dvec3(1.0, 0.5, 0.0))?;
    // Both halves are seams; what is put into a face is not.
    let f = mesh.face(mesh.edge_halfedge(seam)).ok_or("no face")?;
    let poked = mesh.poke_face(f, DVec3::splat(0.5))?;
    assert!(mesh.is_seam(uv, seam) && mesh.is_seam(uv, middle.edge));
    assert!(poked.edges.iter().all(|&e| !mesh.is_seam(uv, e)));

    let mut values: Vec<DVec2> = mesh.outgoing(middle.vertex).map(|h| *mesh.value(uv, h)).collect();
    values.sort_by(|a, b| a.y.total_cmp(&b.y));
    values.dedup();
    Ok(values)
}

#[allow(dead_code, reason = "the tests call run")]
fn main() -> Result<(), Box<dyn Error>> {
    for value in run()? {
        println!("uv at the new vertex: {value}");
    }
    Ok(())
}
