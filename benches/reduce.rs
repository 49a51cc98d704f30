//! Reduction to a tenth of the faces, on a generated sphere or on a shape from a file.
//!
//! `cargo bench --bench reduce [-- --levels N] [--shape FILE] [--faces N] [--threads N] [--repeats N] [--write OUT.ply]`:
//! prints a line per operation, processor time of all threads and time on the clock; `--write` leaves the result
//! for `peers/reduce.py`, which measures how far it is from the original. A shape is what `--bench peers -- --write`
//! makes.

#[path = "../tests/shapes/mod.rs"]
mod shapes;

use cpu_time::ProcessTime;
use meshwright::{Mesh, ReduceOptions, ReduceTarget};
use std::error::Error;
use std::time::Instant;
use std::{env, fs};

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = env::args().collect();
    let value = |flag: &str| args.iter().position(|a| a == flag).and_then(|i| args.get(i + 1));
    let number = |flag: &str, default: usize| value(flag).map_or(Ok(default), |n| n.parse());
    #[cfg(feature = "rayon")]
    rayon::ThreadPoolBuilder::new().num_threads(number("--threads", 1)?).build_global()?;
    let pool = match value("--shape") {
        Some(file) => shapes::from_raw(&fs::read(file)?)?,
        None => shapes::icosphere(number("--levels", 8)? as u32),
    };
    let mesh = Mesh::build(&pool)?;
    let target = ReduceTarget::Faces(number("--faces", pool.face_count() / 10)?);
    let (mut busy, mut clock) = (f64::INFINITY, f64::INFINITY);
    let mut reduced = mesh.clone();
    for _ in 0..number("--repeats", 3)?.max(1) {
        reduced = mesh.clone();
        let (process, start) = (ProcessTime::now(), Instant::now());
        let account = reduced.reduce(ReduceOptions { target, ..Default::default() })?;
        busy = busy.min(process.elapsed().as_secs_f64());
        clock = clock.min(start.elapsed().as_secs_f64());
        eprintln!("{} collapses, {:?}", account.collapses, account.refusals);
    }
    println!("meshwright\treduce\t{busy:.3}\ts");
    println!("meshwright\treduce_clock\t{clock:.3}\ts");
    println!("meshwright\treduce_faces\t{}\tfaces", reduced.face_count());
    if let Some(file) = value("--write") {
        meshwright::io::write_ply(&reduced.to_indexed().into(), &mut fs::File::create(file)?)?;
    }
    Ok(())
}
