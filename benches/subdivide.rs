//! What a level of subdivision costs, alone and with data, on one thread.
//!
//! `cargo bench --bench subdivide [-- --levels N] [--scheme NAME] [--repeats N]`: on the sphere of `N` subdivisions (8 by
//! default: 1.3 million triangles), each scheme or the one named, the least of the repeats in seconds; first without
//! columns, then with vertex normals and texture coordinates. Ratios hold within one run.

#[path = "../tests/shapes/mod.rs"]
mod shapes;

use cpu_time::ThreadTime;
use meshwright::glam::DVec2;
use meshwright::{Mesh, NormalWeight, Rule, Scheme, SubdivideOptions};
use std::env;
use std::error::Error;
use std::hint::black_box;

const SCHEMES: [(&str, Scheme); 4] = [
    ("midpoint", Scheme::Midpoint),
    ("loop", Scheme::Loop),
    ("catmull_clark", Scheme::CatmullClark),
    ("sqrt3", Scheme::Sqrt3),
];

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = env::args().collect();
    let value = |flag: &str| args.iter().position(|a| a == flag).and_then(|i| args.get(i + 1));
    let levels = value("--levels").map_or(Ok(8), |l| l.parse())?;
    let repeats = value("--repeats").map_or(Ok(5), |r| r.parse())?;
    let only = value("--scheme");
    let mut mesh = shapes::mesh(&shapes::icosphere(levels));
    let schemes = || SCHEMES.into_iter().filter(|s| only.is_none_or(|name| name == s.0));
    for (name, scheme) in schemes() {
        println!("meshwright\t{name}\t{:.3}\ts", least(&mesh, scheme, repeats));
    }
    mesh.compute_normals(NormalWeight::Area);
    let uv = mesh.add_corner_column(DVec2::ZERO, Rule::interpolate());
    for h in mesh.halfedges().filter(|&h| !mesh.is_boundary(h)).collect::<Vec<_>>() {
        mesh.set_value(uv, h, mesh.position(mesh.origin(h)).truncate())?;
    }
    for (name, scheme) in schemes() {
        println!("meshwright\t{name}_with_data\t{:.3}\ts", least(&mesh, scheme, repeats));
    }
    Ok(())
}

/// The least processor time of several runs.
fn least(mesh: &Mesh, scheme: Scheme, repeats: usize) -> f64 {
    let mut least = f64::INFINITY;
    for _ in 0..repeats.max(1) {
        let start = ThreadTime::now();
        let fine = mesh.subdivide(SubdivideOptions { scheme, ..Default::default() });
        least = least.min(start.elapsed().as_secs_f64());
        black_box(fine.expect("subdivided"));
    }
    least
}
