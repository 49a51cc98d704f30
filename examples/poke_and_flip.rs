//! Refines a region of triangles: pokes every face in it, then flips the edges between them (one step of sqrt(3)
//! subdivision, Kobbelt 2000).

use meshwright::glam::{DVec3, dvec3};
use meshwright::{EdgeKey, FaceKey, IndexedMesh, Mesh};
use std::collections::BTreeSet;
use std::error::Error;

/// Returns how many faces were poked and how many edges flipped.
pub(crate) fn refine(mesh: &mut Mesh, region: &[FaceKey]) -> Result<(usize, usize), Box<dyn Error>> {
    // The edges inside the region, before there are new ones.
    let inside: BTreeSet<FaceKey> = region.iter().copied().collect();
    let is_inside = |f: Option<FaceKey>| f.is_some_and(|f| inside.contains(&f));
    let edges: Vec<EdgeKey> = mesh
        .edges()
        .filter(|&e| {
            let h = mesh.edge_halfedge(e);
            is_inside(mesh.face(h)) && is_inside(mesh.face(mesh.twin(h)))
        })
        .collect();
    for &f in region {
        let middle = mesh.face_vertices(f).map(|v| mesh.position(v)).sum::<DVec3>() / mesh.degree(f) as f64;
        mesh.poke_face(f, middle)?;
    }
    let flipped = edges.into_iter().filter(|&e| mesh.flip_edge(e).is_ok()).count();
    Ok((region.len(), flipped))
}

/// A sheet of 8 by 8 squares, each cut in two, and the faces within three units of its middle.
pub(crate) fn sheet() -> Result<(Mesh, Vec<FaceKey>), Box<dyn Error>> {
    let points = (0..81).map(|i| dvec3(f64::from(i % 9), f64::from(i / 9), 0.0)).collect();
    let triangles: Vec<[u32; 3]> =
        (0..64).map(|i| i / 8 * 9 + i % 8).flat_map(|a| [[a, a + 1, a + 10], [a, a + 10, a + 9]]).collect();
    let mesh = Mesh::build(&IndexedMesh::from_triangles(points, &triangles)?)?;
    let is_near =
        |f: FaceKey| mesh.face_vertices(f).all(|v| mesh.position(v).distance(dvec3(4., 4., 0.)) < 3.0);
    let region = mesh.faces().filter(|&f| is_near(f)).collect();
    Ok((mesh, region))
}

#[allow(dead_code, reason = "the tests call the parts")]
fn main() -> Result<(), Box<dyn Error>> {
    let (mut mesh, region) = sheet()?;
    let (poked, flipped) = refine(&mut mesh, &region)?;
    println!("{poked} faces poked, {flipped} edges flipped: {} faces now", mesh.face_count());
    Ok(())
}
