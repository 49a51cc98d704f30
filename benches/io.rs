//! Reading and writing each format, from memory and to memory, on one thread, beside tobj alone on the same OBJ bytes.
//!
//! `cargo bench --bench io [-- --shape FILE.raw] [--levels N] [--only NAME] [--repeats N]`: the shape `FILE` holds (see
//! `benches/peers.rs`) or the sphere of `N` subdivisions (8 by default: 1.3 million triangles). A line per operation: name,
//! operation, value, unit; the value is that of the least processor time of the repeats, which are interleaved. `MB/s` are
//! millions of the file's bytes in a second; `*_peak` is the most memory that reading takes beyond the file's bytes.
//! `read_stl_weld` is `cleanup::index(&soup, Weld::Exact)` behind `read_stl`: a valid vertex pool from bytes.
//!
//! `-- --once NAME [--levels N]` does the operation once, for a profiler: `read_ply`, `tobj_obj` and so on.

#[path = "../tests/shapes/mod.rs"]
mod shapes;

use cpu_time::ThreadTime;
use meshwright::cleanup::{self, Weld};
use meshwright::io::{self, Encoding, Format, Limits};
use meshwright::{CornerData, PolygonSoup};
use std::error::Error;
use std::hint::black_box;
use std::path::Path;
use std::process::Command;
use std::{env, fs};

/// A file in memory: its name, what is in it, and how it is written.
struct Kind {
    name: &'static str,
    format: Format,
    encoding: Encoding,
    /// Whether its soup has vertex normals and texture coordinates.
    has_data: bool,
}

const fn kind(name: &'static str, format: Format, encoding: Encoding, has_data: bool) -> Kind {
    Kind { name, format, encoding, has_data }
}

const KINDS: [Kind; 9] = [
    kind("obj", Format::Obj, Encoding::Ascii, false),
    kind("obj_data", Format::Obj, Encoding::Ascii, true),
    kind("ply", Format::Ply, Encoding::Binary, false),
    kind("ply_data", Format::Ply, Encoding::Binary, true),
    kind("ply_big", Format::Ply, Encoding::BigEndian, false),
    kind("ply_ascii", Format::Ply, Encoding::Ascii, false),
    kind("stl", Format::Stl, Encoding::Binary, false),
    kind("stl_ascii", Format::Stl, Encoding::Ascii, false),
    kind("off", Format::Off, Encoding::Ascii, false),
];

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = env::args().collect();
    let value = |flag: &str| args.iter().position(|a| a == flag).and_then(|i| args.get(i + 1));
    let once = value("--once");
    let levels = value("--levels").map_or("8", String::as_str);
    let repeats: usize = value("--repeats").map_or(Ok(5), |r| r.parse())?;
    let pool = match value("--shape") {
        Some(file) => shapes::from_raw(&fs::read(file)?)?,
        None => shapes::icosphere(levels.parse()?),
    };
    // How a process of its own finds the same shape.
    let shape = match value("--shape") {
        Some(file) => ["--shape", file],
        None => ["--levels", levels],
    };
    let plain: PolygonSoup = pool.into();
    for kind in &KINDS {
        let mut operations = kind.operations();
        if let Some(only) = value("--only").or(once) {
            operations.retain(|o| o.name() == *only || (once.is_none() && o.name().contains(only.as_str())));
        }
        if operations.is_empty() {
            continue;
        }
        let soup = if kind.has_data { with_data(&plain) } else { plain.clone() };
        let mut file = Vec::new();
        io::write(&soup, kind.format, kind.encoding, &mut file)?;
        // Files hold nothing of what the vector had room for.
        file.shrink_to_fit();
        match once {
            Some(_) => {
                let soup = if operations[0].verb == "write" { soup } else { PolygonSoup::default() };
                println!("{}", peak(|| operations[0].run(&soup, &file)));
            }
            None => time(kind, &operations, &soup, &file, repeats, &shape)?,
        }
    }
    Ok(())
}

/// An operation on a kind of file.
struct Operation<'k> {
    kind: &'k Kind,
    /// `read`, `write`, `weld` or `tobj`.
    verb: &'static str,
}

impl Kind {
    fn operations(&self) -> Vec<Operation<'_>> {
        let verbs = ["read", "write", "tobj", "weld"].into_iter().filter(|verb| match *verb {
            "tobj" => self.format == Format::Obj,
            "weld" => self.name == "stl",
            _ => true,
        });
        verbs.map(|verb| Operation { kind: self, verb }).collect()
    }
}

impl Operation<'_> {
    fn name(&self) -> String {
        match self.verb {
            "weld" => format!("read_{}_weld", self.kind.name),
            verb => format!("{verb}_{}", self.kind.name),
        }
    }

    fn run(&self, soup: &PolygonSoup, file: &[u8]) {
        match self.verb {
            "read" => drop(black_box(read(self.kind, file))),
            "write" => drop(black_box(write(self.kind, soup, file.len()))),
            "tobj" => _ = black_box(tobj_alone(file)),
            _ => _ = black_box(weld(&read(self.kind, file))),
        }
    }
}

/// The most memory that something takes, in bytes.
fn peak(run: impl FnOnce()) -> u64 {
    let _ = fs::write("/proc/self/clear_refs", "5");
    let before = resident("VmRSS:");
    run();
    resident("VmHWM:").saturating_sub(before)
}

/// Normals that are the positions, and texture coordinates that are two of them.
fn with_data(plain: &PolygonSoup) -> PolygonSoup {
    let uvs = plain.positions.iter().map(|p| [p.x, p.y]).collect();
    let indices = plain.polygons.corners().to_vec();
    PolygonSoup {
        vertex_normals: plain.positions.clone(),
        corner_uvs: Some(CornerData { values: uvs, indices }),
        ..plain.clone()
    }
}

fn read(kind: &Kind, file: &[u8]) -> PolygonSoup {
    io::read(file, kind.format, &Limits::default()).expect("what was written reads").soup
}

fn write(kind: &Kind, soup: &PolygonSoup, room: usize) -> Vec<u8> {
    let mut file = Vec::with_capacity(room);
    io::write(soup, kind.format, kind.encoding, &mut file).expect("what was read is written");
    file
}

fn tobj_alone(file: &[u8]) -> usize {
    let options = tobj::LoadOptions { single_index: false, triangulate: false, ..Default::default() };
    let loaded = tobj::load_obj_buf(&mut &file[..], &options, |_: &Path| Ok(Default::default()));
    loaded.expect("a plain OBJ file").0.iter().map(|m| m.mesh.indices.len()).sum()
}

fn weld(soup: &PolygonSoup) -> usize {
    cleanup::index(soup, Weld::Exact).expect("finite positions").value.vertex_count()
}

fn time(
    kind: &Kind,
    operations: &[Operation<'_>],
    soup: &PolygonSoup,
    file: &[u8],
    repeats: usize,
    shape: &[&str],
) -> Result<(), Box<dyn Error>> {
    let faces = soup.polygons.len() as f64;
    let print = |operation: &Operation<'_>, end: &str, value: f64, unit: &str| {
        let (who, name) = match operation.verb {
            "tobj" => ("tobj", format!("read_{}", kind.name)),
            _ => ("meshwright", operation.name()),
        };
        println!("{who}\t{name}{end}\t{value:.3}\t{unit}");
    };
    println!("meshwright\tsize_{}\t{:.3}\tbytes/face", kind.name, file.len() as f64 / faces);
    let mut least = vec![f64::INFINITY; operations.len()];
    for _ in 0..repeats.max(1) {
        for (operation, least) in operations.iter().zip(&mut least) {
            let start = ThreadTime::now();
            operation.run(soup, file);
            *least = least.min(start.elapsed().as_secs_f64());
        }
    }
    for (operation, least) in operations.iter().zip(&least) {
        print(operation, "", file.len() as f64 / least / 1e6, "MB/s");
    }
    let of = |verb: &str| operations.iter().zip(&least).find(|o| o.0.verb == verb);
    if let (Some((read, ours)), Some((_, theirs))) = (of("read"), of("tobj")) {
        print(read, "_of_tobj", theirs / ours, "ratio");
    }
    // In a process of its own that gives back what it frees: nothing of what went before may serve again.
    for operation in operations.iter().filter(|o| o.verb != "write") {
        let output = Command::new(env::current_exe()?)
            .args(["--once", &operation.name()])
            .args(shape)
            .env("MALLOC_MMAP_THRESHOLD_", "65536")
            .output()?;
        let peak: f64 = String::from_utf8(output.stdout)?.trim().parse()?;
        print(operation, "_peak", peak / faces, "bytes/face");
    }
    Ok(())
}

/// Resident memory of this process in bytes, by the name the system gives it; 0 where it does not tell.
fn resident(name: &str) -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix(name));
    line.and_then(|l| l.trim().trim_end_matches(" kB").parse::<u64>().ok()).map_or(0, |kib| kib * 1024)
}
