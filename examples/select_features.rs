//! Selects the features of a part: its sharp edges, strung into paths, and the smooth walls between them.

use meshwright::glam::dvec3;
use meshwright::{FaceKey, FeatureOptions, IndexedMesh, Mesh, Polygons};
use std::collections::HashSet;
use std::error::Error;

/// A sharp path.
pub(crate) struct SharpPath {
    pub(crate) edges: usize,
    pub(crate) length: f64,
    pub(crate) closed: bool,
}

/// What was found.
pub(crate) struct Features {
    pub(crate) paths: Vec<SharpPath>,
    /// How many faces each smooth region has.
    pub(crate) walls: Vec<usize>,
    /// The length of the rounded corner.
    pub(crate) arc: f64,
}

/// The outline of a block of 40 by 20, one corner rounded in eight steps.
fn outline() -> Vec<[f64; 2]> {
    let round = (0..=8).map(|i| {
        let (s, c) = (f64::from(i) / 8.0 * std::f64::consts::FRAC_PI_2).sin_cos();
        [32.0 + 8.0 * c, 12.0 + 8.0 * s]
    });
    [[0., 0.], [40., 0.]].into_iter().chain(round).chain([[0., 20.]]).collect()
}

/// The block, 10 high, and what is sharper than 30 degrees on it.
pub(crate) fn run() -> Result<Features, Box<dyn Error>> {
    let outline = outline();
    let n = outline.len() as u32;
    let level = |z: f64| outline.iter().map(move |&[x, y]| dvec3(x, y, z));
    let mut faces = Polygons::default();
    faces.push((0..n).rev());
    for i in 0..n {
        let j = (i + 1) % n;
        faces.push([i, j, n + j, n + i]);
    }
    faces.push(n..2 * n);
    let mesh = Mesh::build(&IndexedMesh::new(level(0.0).chain(level(10.0)).collect(), faces)?)?;

    let sharp = 30.0;
    let length = |h| mesh.position(mesh.origin(h)).distance(mesh.position(mesh.target(h)));
    let paths = mesh.feature_paths(FeatureOptions { degrees: sharp, boundary: true });
    let paths = paths.iter().map(|path| SharpPath {
        edges: path.halfedges.len(),
        length: path.halfedges.iter().map(|&h| length(h)).sum(),
        closed: path.closed,
    });

    let mut seen: HashSet<FaceKey> = HashSet::new();
    let mut walls = Vec::new();
    for f in mesh.faces() {
        if !seen.contains(&f) {
            let before = seen.len();
            seen.extend(mesh.smooth_region(f, sharp));
            walls.push(seen.len() - before);
        }
    }

    // The shortest way from one end of the rounding to the other leads along it.
    let v: Vec<_> = mesh.vertices().collect();
    let arc = mesh.shortest_path(v[2], v[10])?.ok_or("the rounding is connected")?.length;
    Ok(Features { paths: paths.collect(), walls, arc })
}

#[allow(dead_code, reason = "the tests call run")]
fn main() -> Result<(), Box<dyn Error>> {
    let found = run()?;
    for path in &found.paths {
        let kind = if path.closed { "closed" } else { "open" };
        println!("a sharp path, {kind}, of {} edges, {:.3} long", path.edges, path.length);
    }
    for faces in &found.walls {
        println!("a smooth wall of {faces} faces");
    }
    println!("the rounded corner is {:.3} long", found.arc);
    Ok(())
}
