//! Rays and closest points on one thread, on the sphere of 1.3 million triangles.
//!
//! `cargo bench --bench query [-- --levels N] [-- --write FILE]`: prints a line per operation; `--write` leaves the
//! sphere and the questions for a peer, little-endian: `u64` vertices, triangles, rays and points, then three `f64` a
//! vertex, three `u32` a triangle, six `f64` a ray, three `f64` a point.

#[path = "../tests/shapes/mod.rs"]
mod shapes;

use cpu_time::ThreadTime;
use meshwright::glam::{DVec3, dvec3};
use meshwright::{ClosestOptions, Ray, SelfIntersectionOptions};
use shapes::Noise;
use std::error::Error;
use std::hint::black_box;
use std::{env, fs};

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = env::args().collect();
    let value = |flag: &str| args.iter().position(|a| a == flag).and_then(|i| args.get(i + 1));
    let pool = shapes::icosphere(value("--levels").map_or(Ok(8), |l| l.parse())?);
    let mesh = shapes::mesh(&pool);
    let mut noise = Noise(9);
    let bounds = pool.bounds().ok_or("no points")?;
    let mut within = |factor: f64| {
        let unit = dvec3(noise.unit(), noise.unit(), noise.unit()) - 0.5;
        bounds.center() + (bounds.max - bounds.min) * unit * factor
    };
    // From a point in twice the box towards a point in the box.
    let rays: Vec<(DVec3, DVec3)> = (0..1_000_000)
        .map(|_| {
            let origin = within(2.0);
            (origin, within(1.0) - origin)
        })
        .collect();
    let points: Vec<DVec3> = (0..50_000).map(|_| within(1.2)).collect();
    if let Some(file) = value("--write") {
        let mut raw = Vec::new();
        for n in [pool.vertex_count(), pool.face_count(), rays.len(), points.len()] {
            raw.extend((n as u64).to_le_bytes());
        }
        raw.extend(pool.positions().iter().flat_map(|p| p.to_array()).flat_map(f64::to_le_bytes));
        raw.extend(pool.polygons().corners().iter().flat_map(|c| c.to_le_bytes()));
        raw.extend(
            rays.iter().flat_map(|r| [r.0.to_array(), r.1.to_array()]).flatten().flat_map(f64::to_le_bytes),
        );
        raw.extend(points.iter().flat_map(|p| p.to_array()).flat_map(f64::to_le_bytes));
        fs::write(file, raw)?;
    }
    let rays: Vec<Ray> = rays.into_iter().map(|(o, d)| Ray::new(o, d)).collect::<Result<_, _>>()?;

    let print = |op: &str, value: f64, unit: &str| println!("meshwright\t{op}\t{value:.3}\t{unit}");
    let start = ThreadTime::now();
    let index = mesh.index();
    print("index", start.elapsed().as_secs_f64(), "s");
    print("memory", index.heap_bytes() as f64 / pool.face_count() as f64, "bytes/face");

    let seconds = |op: &str, mesh: &meshwright::Mesh| -> Result<(), Box<dyn Error>> {
        let index = mesh.index();
        let mut best = f64::INFINITY;
        let mut found = 0;
        for _ in 0..3 {
            let start = ThreadTime::now();
            found = index.self_intersections(SelfIntersectionOptions::default())?.count();
            best = best.min(start.elapsed().as_secs_f64());
        }
        print(op, best, "s");
        print(&format!("{op}_found"), found as f64, "pairs");
        Ok(())
    };
    seconds("self_intersections", &mesh)?;
    // Level ground, where everything lies in one plane; and two bodies through each other.
    let mut ground = shapes::grid(300);
    ground.map_positions(|p| dvec3(p.x, p.y, p.x + 2.0 * p.y))?;
    seconds("self_intersections_level_180k", &shapes::mesh(&ground))?;
    let body = shapes::icosphere(6);
    let mut moved = body.clone();
    moved.map_positions(|p| p + dvec3(0.3, 0.2, 0.1))?;
    seconds("self_intersections_two_82k", &shapes::mesh(&shapes::both(&body, &moved)))?;

    let rate = |op: &str, count: usize, run: &mut dyn FnMut() -> usize| {
        let mut best = f64::INFINITY;
        let mut found = 0;
        for _ in 0..3 {
            let start = ThreadTime::now();
            found = black_box(run());
            best = best.min(start.elapsed().as_secs_f64());
        }
        print(op, count as f64 / best / 1e3, "thousand/s");
        print(&format!("{op}_found"), found as f64, "answers");
    };
    rate("first_hit", rays.len(), &mut || rays.iter().filter(|r| index.first_hit(r).is_some()).count());
    rate("is_hit", rays.len(), &mut || rays.iter().filter(|r| index.is_hit(r)).count());
    rate("hits", rays.len(), &mut || rays.iter().map(|r| index.hits(r).len()).sum());
    let all = ClosestOptions::default();
    let mut sum = 0.0;
    rate("closest_point", points.len(), &mut || {
        sum = 0.0;
        let found = points.iter().filter_map(|&p| index.closest_point(p, all).ok().flatten());
        found.map(|f| sum += f.distance).count()
    });
    print("closest_point_checksum", sum, "length");
    rate("closest_vertex", points.len(), &mut || {
        points.iter().filter_map(|&p| index.closest_vertex(p, all).ok().flatten()).count()
    });
    let solid = mesh.closed()?.index();
    rate("contains", points.len(), &mut || {
        points.iter().filter(|&&p| solid.contains(p) == Ok(meshwright::Side::Inside)).count()
    });
    Ok(())
}
