//! Broken meshes of known truth as files, for `benches/repair/repair.py`: the faults of `tests/faults`, in triangles.
//!
//! `cargo bench --bench faults -- DIR [SEEDS]` writes `cases.tsv` and, for each case, `CASE.obj` (the broken mesh) and `CASE.intact` (the faces
//! of `SHAPE.truth.obj` that the fault left alone).

#[path = "../tests/faults/inject.rs"]
#[allow(dead_code)]
mod inject;
#[path = "../tests/shapes/mod.rs"]
mod shapes;
#[path = "../tests/faults/truth.rs"]
#[allow(dead_code)]
mod truth;

use inject::Faulty;
use meshwright::PolygonSoup;
use std::error::Error;
use std::fmt::Write;
use std::path::Path;
use std::{env, fs};
use truth::{Truth, truths};

type Fault = (&'static str, fn(&mut Faulty));

const FAULTS: [Fault; 17] = [
    ("none", |_| {}),
    ("soup", inject::unweld),
    ("jittered soup", inject::jitter),
    ("flips", inject::flip),
    ("inside out", inject::invert),
    ("holes", inject::holes),
    ("duplicates", inject::duplicate),
    ("reversed duplicates", inject::duplicate_reversed),
    ("caps", inject::caps),
    ("needles", inject::needles),
    ("fins", inject::fins),
    ("T-junctions", inject::t_junctions),
    ("not finite", inject::not_finite),
    ("bad indices", inject::bad_indices),
    ("isolated vertices", inject::isolated),
    ("touching at a vertex", |_| {}),
    ("everything at once", inject::all_at_once),
];

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = env::args().skip(1).filter(|a| a != "--bench").collect();
    let Some(dir) = args.first().map(Path::new) else {
        println!("usage: cargo bench --bench faults -- DIR [SEEDS]");
        return Ok(());
    };
    let seeds = args.get(1).map_or(Ok(1), |s| s.parse())?;
    fs::create_dir_all(dir)?;
    let mut cases = String::from("case\tshape\tfault\n");
    for truth in truths() {
        if truth.pool.polygons().iter().any(|f| f.len() != 3) {
            continue;
        }
        for (fault, inject) in FAULTS {
            for seed in 0..seeds {
                let mut faulty = Faulty::new(&truth, seed);
                inject(&mut faulty);
                let (whole, soup, intact) = if fault == "touching at a vertex" {
                    let (both, soup) = inject::touching_at_a_vertex(&truth);
                    let intact = vec![true; both.pool.face_count()];
                    (both, soup, intact)
                } else {
                    let whole = Truth::new(truth.name, truth.pool.clone());
                    (whole, faulty.soup(), faulty.intact)
                };
                let shape = if fault == "touching at a vertex" {
                    format!("{} twice", truth.name)
                } else {
                    truth.name.into()
                };
                let case = format!("{}-{}-{seed}", truth.name, fault).replace(' ', "_");
                writeln!(cases, "{case}\t{shape}\t{fault}")?;
                fs::write(dir.join(format!("{shape}.truth.obj")), obj(&shapes::soup(&whole.pool))?)?;
                fs::write(dir.join(format!("{case}.obj")), obj(&soup)?)?;
                let lines: Vec<String> =
                    (0..intact.len()).filter(|&f| intact[f]).map(|f| f.to_string()).collect();
                fs::write(dir.join(format!("{case}.intact")), lines.join("\n") + "\n")?;
            }
        }
    }
    fs::write(dir.join("cases.tsv"), cases)?;
    Ok(())
}

/// As it is, whatever that is: the library would not write a face that it cannot read back.
fn obj(soup: &PolygonSoup) -> Result<String, Box<dyn Error>> {
    let mut text = String::new();
    for p in &soup.positions {
        writeln!(text, "v {:?} {:?} {:?}", p.x, p.y, p.z)?;
    }
    for face in soup.polygons.iter().filter(|f| f.len() >= 3) {
        text.push('f');
        for &v in face {
            write!(text, " {}", u64::from(v) + 1)?;
        }
        text.push('\n');
    }
    Ok(text)
}
