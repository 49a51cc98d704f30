//! Probes a part: how thick it is along a line, how much room is left beside it, how heavy it is.
//!
//! `cargo run --example probe_part -- FILE`; without a file, the broken sample after clean-up.

use meshwright::cleanup::{CleanOptions, clean};
use meshwright::glam::DVec3;
use meshwright::io::{Limits, read_file};
use meshwright::{ClosestOptions, Crossing, MassProperties, Ray, Side};
use std::error::Error;
use std::path::Path;

/// Material between where a ray enters and where it leaves.
pub(crate) struct Wall {
    pub(crate) at: DVec3,
    pub(crate) thickness: f64,
}

/// What the probe found.
pub(crate) struct Probe {
    pub(crate) walls: Vec<Wall>,
    pub(crate) clearance: f64,
    pub(crate) is_inside: bool,
    pub(crate) mass: MassProperties,
}

/// Looks along x through the centre of mass, and down on it from above.
pub(crate) fn run(path: &Path) -> Result<Probe, Box<dyn Error>> {
    let mesh = clean(&read_file(path, &Limits::default())?.soup, CleanOptions::default())?.value;
    let bounds = mesh.to_indexed().bounds().ok_or("there is nothing to probe")?;
    // Proof first: only a closed mesh has an inside.
    let solid = mesh.closed()?;
    let index = solid.index();

    let mass = solid.mass_properties().ok_or("no volume")?;

    let size = bounds.max - bounds.min;
    let origin = mass.centroid - DVec3::X * size.x;
    let hits = index.index().hits(&Ray::new(origin, DVec3::X)?);
    // Touches change nothing, so entries and exits alternate.
    let crossings: Vec<_> = hits.iter().filter(|h| h.crossing != Crossing::Touch).collect();
    let wall = |pair: &[&meshwright::RayHit]| Wall { at: pair[0].point, thickness: pair[1].t - pair[0].t };
    let walls = crossings.chunks_exact(2).map(wall).collect();

    let above = mass.centroid + DVec3::Z * size.z;
    let nearest = index.index().closest_point(above, ClosestOptions::default())?;
    Ok(Probe {
        walls,
        clearance: nearest.ok_or("there are no faces")?.distance,
        is_inside: index.contains(above)? == Side::Inside,
        mass,
    })
}

#[allow(dead_code, reason = "the tests call run")]
fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args_os().nth(1);
    let path = file.as_deref().map_or(Path::new("examples/data/broken_bracket.obj"), Path::new);
    let probe = run(path)?;
    for wall in &probe.walls {
        println!("a wall of {} at {}", wall.thickness, wall.at);
    }
    println!("clearance {}, inside: {}", probe.clearance, probe.is_inside);
    println!("volume {}, centre of mass {}", probe.mass.volume, probe.mass.centroid);
    println!("inertia about it {}", probe.mass.inertia);
    Ok(())
}
