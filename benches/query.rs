//! Rays and closest points on one thread, on the sphere of 1.3 million triangles and the grid of 2 million.
//!
//! `cargo bench --bench query -- --write DIR` leaves both with their questions for a peer; `-- --time FILE [--repeats N]`
//! times one of them, and without a file the sphere of `--levels N`, with what no peer is asked. A line per operation:
//! name, operation, value, unit; those with `_batch` ask all at once, the others one by one in random order. A file
//! holds, little-endian: `u64` vertices, triangles, rays and points, then three `f64` a vertex, three `u32` a triangle,
//! six `f64` a ray, three `f64` a point.

#[path = "../tests/shapes/mod.rs"]
mod shapes;

use cpu_time::ThreadTime;
use meshwright::glam::{DVec3, dvec3};
use meshwright::{ClosestOptions, IndexedMesh, Mesh, Ray, SelfIntersectionOptions, Side};
use shapes::Noise;
use std::error::Error;
use std::hint::black_box;
use std::{env, fs};

/// A shape and what is asked about it.
struct Questions {
    pool: IndexedMesh,
    rays: Vec<[DVec3; 2]>,
    points: Vec<DVec3>,
}

impl Questions {
    /// Lines through the ball around the shape, from one random point of it to another; points in 1.2 times the box.
    fn about(pool: IndexedMesh) -> Result<Self, Box<dyn Error>> {
        let mut noise = Noise(9);
        let bounds = pool.bounds().ok_or("no points")?;
        let (center, size) = (bounds.center(), bounds.max - bounds.min);
        let radius = pool.positions().iter().fold(0.0f64, |most, p| most.max(p.distance(center)));
        let mut unit = || dvec3(noise.unit(), noise.unit(), noise.unit()) - 0.5;
        let mut on_ball = || {
            let within = std::iter::repeat_with(&mut unit)
                .find(|v| (0.1..0.5).contains(&v.length()))
                .unwrap_or(DVec3::X);
            center + within.normalize() * radius
        };
        let rays = (0..1_000_000)
            .map(|_| {
                let from = on_ball();
                [from, on_ball() - from]
            })
            .collect();
        let points = (0..50_000).map(|_| center + size * unit() * 1.2).collect();
        Ok(Self { pool, rays, points })
    }

    fn to_raw(&self) -> Vec<u8> {
        let of = |places: &[DVec3]| {
            places.iter().flat_map(|p| p.to_array()).flat_map(f64::to_le_bytes).collect::<Vec<u8>>()
        };
        let mut raw = Vec::new();
        for n in [self.pool.vertex_count(), self.pool.face_count(), self.rays.len(), self.points.len()] {
            raw.extend((n as u64).to_le_bytes());
        }
        raw.append(&mut of(self.pool.positions()));
        raw.extend(self.pool.polygons().corners().iter().flat_map(|c| c.to_le_bytes()));
        raw.append(&mut of(self.rays.as_flattened()));
        raw.append(&mut of(&self.points));
        raw
    }

    fn from_raw(raw: &[u8]) -> Result<Self, Box<dyn Error>> {
        let word = |at: usize| -> Result<[u8; 8], Box<dyn Error>> {
            Ok(raw.get(at..at + 8).ok_or("the file is too short")?.try_into()?)
        };
        let count = |i: usize| Ok::<_, Box<dyn Error>>(u64::from_le_bytes(word(8 * i)?) as usize);
        let (vertices, triangles, rays, points) = (count(0)?, count(1)?, count(2)?, count(3)?);
        let place = |at: usize| -> Result<DVec3, Box<dyn Error>> {
            Ok(dvec3(
                f64::from_le_bytes(word(at)?),
                f64::from_le_bytes(word(at + 8)?),
                f64::from_le_bytes(word(at + 16)?),
            ))
        };
        let places = |at: usize, n: usize| (0..n).map(|i| place(at + 24 * i)).collect::<Result<Vec<_>, _>>();
        let corners = 32 + 24 * vertices;
        let after = corners + 12 * triangles;
        let faces = raw.get(corners..after).ok_or("the file is too short")?.chunks_exact(12);
        let corner = |f: &[u8], i: usize| u32::from_le_bytes([f[i], f[i + 1], f[i + 2], f[i + 3]]);
        let faces: Vec<[u32; 3]> = faces.map(|f| [corner(f, 0), corner(f, 4), corner(f, 8)]).collect();
        let rays = places(after, 2 * rays)?;
        let points = places(after + 24 * rays.len(), points)?;
        let pool = IndexedMesh::from_triangles(places(32, vertices)?, &faces)?;
        Ok(Self { pool, rays: rays.chunks_exact(2).map(|r| [r[0], r[1]]).collect(), points })
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = env::args().collect();
    let value = |flag: &str| args.iter().position(|a| a == flag).and_then(|i| args.get(i + 1));
    if let Some(dir) = value("--write") {
        fs::create_dir_all(dir)?;
        for (name, pool) in [("sphere1m", shapes::icosphere(8)), ("grid2m", shapes::grid(1000))] {
            fs::write(format!("{dir}/{name}.questions"), Questions::about(pool)?.to_raw())?;
        }
        return Ok(());
    }
    let repeats = value("--repeats").map_or(Ok(3), |r| r.parse())?;
    if let Some(file) = value("--time") {
        return time(&Questions::from_raw(&fs::read(file)?)?, repeats);
    }
    let questions = Questions::about(shapes::icosphere(value("--levels").map_or(Ok(8), |l| l.parse())?))?;
    time(&questions, repeats)?;
    more(&questions, repeats)
}

fn print(op: &str, value: f64, unit: &str) {
    println!("meshwright\t{op}\t{value:.3}\t{unit}");
}

/// The least processor time of several runs in seconds, and what the last returned.
fn best<T>(repeats: usize, mut run: impl FnMut() -> T) -> (f64, T) {
    let mut last = None;
    let mut best = f64::INFINITY;
    for _ in 0..repeats.max(1) {
        drop(last.take());
        let start = ThreadTime::now();
        last = Some(black_box(run()));
        best = best.min(start.elapsed().as_secs_f64());
    }
    (best, last.expect("at least one repeat"))
}

fn rate(op: &str, repeats: usize, count: usize, run: impl FnMut() -> usize) {
    let (best, found) = best(repeats, run);
    print(op, count as f64 / best / 1e3, "thousand/s");
    print(&format!("{op}_found"), found as f64, "answers");
}

/// What peers are asked as well.
fn time(questions: &Questions, repeats: usize) -> Result<(), Box<dyn Error>> {
    let mesh = Mesh::build(&questions.pool)?;
    let points = &questions.points;
    let rays: Vec<Ray> = questions.rays.iter().map(|r| Ray::new(r[0], r[1])).collect::<Result<_, _>>()?;
    let (took, index) = best(repeats, || mesh.index());
    print("index", took, "s");
    print("index_memory", index.heap_bytes() as f64 / index.triangle_count() as f64, "bytes/face");
    let count = rays.len();
    rate("first_hit", repeats, count, || rays.iter().filter(|r| index.first_hit(r).is_some()).count());
    rate("first_hit_batch", repeats, count, || index.first_hit_batch(&rays).iter().flatten().count());
    rate("is_hit", repeats, count, || rays.iter().filter(|r| index.is_hit(r)).count());
    rate("is_hit_batch", repeats, count, || index.is_hit_batch(&rays).iter().filter(|h| **h).count());
    let all = ClosestOptions::default();
    let (took, sum) = best(repeats, || -> f64 {
        points.iter().filter_map(|&p| index.closest_point(p, all).ok().flatten()).map(|c| c.distance).sum()
    });
    print("closest_point", points.len() as f64 / took / 1e3, "thousand/s");
    print("closest_point_checksum", sum, "length");
    let (took, found) = best(repeats, || index.closest_point_batch(points, all));
    print("closest_point_batch", points.len() as f64 / took / 1e3, "thousand/s");
    let sum: f64 = found?.iter().flatten().map(|c| c.distance).sum();
    print("closest_point_batch_checksum", sum, "length");
    Ok(())
}

/// The other questions.
fn more(questions: &Questions, repeats: usize) -> Result<(), Box<dyn Error>> {
    let mesh = Mesh::build(&questions.pool)?;
    let points = &questions.points;
    let rays: Vec<Ray> = questions.rays.iter().map(|r| Ray::new(r[0], r[1])).collect::<Result<_, _>>()?;
    let index = mesh.index();
    let all = ClosestOptions::default();
    rate("hits", repeats, rays.len(), || rays.iter().map(|r| index.hits(r).len()).sum());
    rate("closest_vertex", repeats, points.len(), || {
        points.iter().filter_map(|&p| index.closest_vertex(p, all).ok().flatten()).count()
    });
    let solid = mesh.closed()?.index();
    rate("contains", repeats, points.len(), || {
        points.iter().filter(|&&p| solid.contains(p) == Ok(Side::Inside)).count()
    });
    let seconds = |op: &str, mesh: &Mesh| -> Result<(), Box<dyn Error>> {
        let index = mesh.index();
        let (took, found) = best(repeats, || index.self_intersections(SelfIntersectionOptions::default()));
        print(op, took, "s");
        print(&format!("{op}_found"), found?.count() as f64, "pairs");
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

    Ok(())
}
