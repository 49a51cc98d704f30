//! How time grows with size: every main operation once on shapes of three sizes, some with all faces around one vertex.
//!
//! `cargo bench --bench growth [-- NAME...] [--shapes A,B] [--sizes 10000,100000,1300000] [--most SECONDS] [--repeats N]`:
//! a line per shape and operation whose name contains one of the words, or all; nanoseconds a face at each size, and what
//! a face costs on ten times the faces, as a multiple. Above 2 the line says `grows`, above 7 `QUADRATIC?`: larger meshes
//! fit no cache, which may make five of one where memory is scattered, never ten. What asks a thousand questions or does
//! a thousand edits (`hub_`, `find_halfedges`, `hits`, `closest_`) is given in nanoseconds for each; it grows with the
//! logarithm of the faces, or with the answers. A size that would take more than `SECONDS` (60), going by those before, is
//! left out. One thread.

mod operations;

use cpu_time::ThreadTime;
use operations::{QUESTIONS, SHAPES, Subject, operations, shape};
use std::env;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = env::args().skip(1).filter(|a| a != "--bench").collect();
    let value = |flag: &str| args.iter().position(|a| a == flag).and_then(|i| args.get(i + 1));
    let is_word = |i: usize| !args[i].starts_with("--") && (i == 0 || !args[i - 1].starts_with("--"));
    let words: Vec<&String> = (0..args.len()).filter(|&i| is_word(i)).map(|i| &args[i]).collect();
    let sizes = value("--sizes").map_or("10000,100000,1300000", String::as_str);
    let sizes: Vec<usize> = sizes.split(',').map(str::parse).collect::<Result<_, _>>()?;
    let most: f64 = value("--most").map_or(Ok(60.0), |s| s.parse())?;
    let repeats: usize = value("--repeats").map_or(Ok(1), |s| s.parse())?;
    let shapes: Vec<&str> = value("--shapes").map_or(SHAPES.to_vec(), |s| s.split(',').collect());
    for name in shapes {
        let subjects: Vec<Subject> = sizes.iter().map(|&faces| Subject::new(shape(name, faces))).collect();
        let counts: Vec<String> = subjects.iter().map(|s| s.pool.face_count().to_string()).collect();
        println!("{name}: {} faces", counts.join(", "));
        for (operation, prepare) in operations() {
            if !words.is_empty() && !words.iter().any(|w| operation.contains(*w)) {
                continue;
            }
            let mut times: Vec<(f64, f64)> = Vec::new();
            let mut line = String::new();
            for subject in &subjects {
                let faces = subject.pool.face_count() as f64;
                if expected(&times, faces) > most {
                    line += "\t(left out)";
                    continue;
                }
                let mut least = f64::INFINITY;
                for _ in 0..repeats.max(1) {
                    let Some(run) = prepare(subject) else { continue };
                    let start = ThreadTime::now();
                    let kept = run();
                    least = least.min(start.elapsed().as_secs_f64());
                    drop(kept);
                }
                if least.is_finite() {
                    times.push((faces, least));
                    let each = if per_question(operation) { QUESTIONS as f64 } else { faces };
                    line += &format!("\t{:.1}", least / each * 1e9);
                }
            }
            if !times.is_empty() {
                println!("{name}\t{operation}{line}\t{}", growth(&times, per_question(operation)));
            }
        }
    }
    Ok(())
}

/// Whether an operation is a thousand answers or edits, whatever the size.
fn per_question(operation: &str) -> bool {
    ["hub_", "find_", "first_hits", "hits", "closest_"].iter().any(|p| operation.starts_with(p))
}

/// Seconds that may be expected at a size: from one before by its square, from two by how they grew.
fn expected(times: &[(f64, f64)], faces: f64) -> f64 {
    match times {
        [] => 0.0,
        [(n, t)] => t * (faces / n).powi(2),
        [.., (m, s), (n, t)] => t * (faces / n).powf(((t / s).ln() / (n / m).ln()).clamp(0.0, 3.0)),
    }
}

/// What becomes of the time for each when there are ten times as many: the worst step between two sizes.
fn growth(times: &[(f64, f64)], is_fixed: bool) -> String {
    let step = |w: &[(f64, f64)]| {
        let [(m, s), (n, t)] = [w[0], w[1]];
        let times = t / s / if is_fixed { 1.0 } else { n / m };
        times.powf(10f64.ln() / (n / m).ln())
    };
    let Some(worst) = times.windows(2).map(step).max_by(f64::total_cmp) else { return String::new() };
    let verdict = if worst > 7.0 {
        "\tQUADRATIC?"
    } else if worst > 2.0 {
        "\tgrows"
    } else {
        ""
    };
    format!("x {worst:.2}{verdict}")
}
