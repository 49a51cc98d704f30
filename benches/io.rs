//! Reading and writing each format, from memory and to memory, on one thread, beside tobj alone on the same OBJ bytes.
//!
//! `cargo bench --bench io [-- --shape FILE.raw] [--levels N] [--only NAME] [--repeats N]`: the shape `FILE` holds (see
//! `benches/peers.rs`) or the sphere of `N` subdivisions (8 by default: 1.3 million triangles). A line per operation: name,
//! operation, value, unit; the value is that of the least processor time of the repeats, which are interleaved. `MB/s` are
//! millions of the file's bytes in a second; `*_peak` is the most memory that reading takes beyond the file's bytes.
//! `read_stl_weld` is `cleanup::index(&soup, Weld::Exact)` behind `read_stl`: a valid vertex pool from bytes.
//!
//! `-- --callgrind NAME [--levels N]` does the operation once, and nothing else that counts (6 by default).

#[path = "../tests/shapes/mod.rs"]
mod shapes;

use cpu_time::ThreadTime;
use meshwright::cleanup::{self, Weld};
use meshwright::io::{self, Encoding, Format, Limits};
use meshwright::{CornerData, PolygonSoup};
use std::error::Error;
use std::hint::black_box;
use std::path::Path;
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
    let callgrind = value("--callgrind");
    let levels = value("--levels").map_or(Ok(if callgrind.is_some() { 6 } else { 8 }), |l| l.parse())?;
    let repeats: usize = value("--repeats").map_or(Ok(5), |r| r.parse())?;
    let only = value("--only").or(callgrind);
    let pool = match value("--shape") {
        Some(file) => shapes::from_raw(&fs::read(file)?)?,
        None => shapes::icosphere(levels),
    };
    let plain: PolygonSoup = pool.into();
    for kind in &KINDS {
        let stem = |name: &String| name.trim_start_matches("read_").trim_start_matches("write_").to_owned();
        let wanted = only.map(stem).unwrap_or_default();
        // `--only stl_weld` and `--only tobj_data` mean operations on a kind of file.
        let of_kind = [kind.name.to_owned(), format!("{}_weld", kind.name), kind.name.replace("obj", "tobj")];
        if only.is_some() && !of_kind.contains(&wanted) {
            continue;
        }
        let soup = if kind.has_data { with_data(&plain) } else { plain.clone() };
        let mut file = Vec::new();
        io::write(&soup, kind.format, kind.encoding, &mut file)?;
        // Files hold nothing of what the vector had room for.
        file.shrink_to_fit();
        match callgrind {
            Some(name) => callgrind_once(kind, &soup, &file, name),
            None => time(kind, &soup, &file, repeats),
        }
    }
    Ok(())
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

fn callgrind_once(kind: &Kind, soup: &PolygonSoup, file: &[u8], name: &str) {
    if name.starts_with("write") {
        black_box(write(kind, soup, file.len()));
    } else if name.starts_with("tobj") {
        black_box(tobj_alone(file));
    } else if name.ends_with("weld") {
        black_box(weld(&read(kind, file)));
    } else {
        black_box(read(kind, file));
    }
    println!("{} bytes\t{} faces", file.len(), soup.polygons.len());
}

/// The operations on a file: whose, which, and what it does.
type Operation<'a> = (&'static str, String, Box<dyn FnMut() + 'a>);

fn time(kind: &Kind, soup: &PolygonSoup, file: &[u8], repeats: usize) {
    let faces = soup.polygons.len() as f64;
    let print = |who: &str, what: &str, value: f64, unit: &str| println!("{who}\t{what}\t{value:.3}\t{unit}");
    let mut operations: Vec<Operation<'_>> = vec![
        ("meshwright", format!("read_{}", kind.name), Box::new(|| drop(black_box(read(kind, file))))),
        (
            "meshwright",
            format!("write_{}", kind.name),
            Box::new(|| drop(black_box(write(kind, soup, file.len())))),
        ),
    ];
    if kind.format == Format::Obj {
        operations.push((
            "tobj",
            format!("read_{}", kind.name),
            Box::new(|| drop(black_box(tobj_alone(file)))),
        ));
    }
    if kind.name == "stl" {
        operations.push((
            "meshwright",
            "read_stl_weld".to_owned(),
            Box::new(|| drop(black_box(weld(&read(kind, file))))),
        ));
    }
    print("meshwright", &format!("size_{}", kind.name), file.len() as f64 / faces, "bytes/face");
    for (who, what, run) in operations.iter_mut().filter(|o| o.1.starts_with("read")) {
        let _ = fs::write("/proc/self/clear_refs", "5");
        let before = resident("VmRSS:");
        run();
        let peak = resident("VmHWM:").saturating_sub(before) as f64 / faces;
        print(who, &format!("{what}_peak"), peak, "bytes/face");
    }
    let mut least = vec![f64::INFINITY; operations.len()];
    for _ in 0..repeats.max(1) {
        for ((_, _, run), least) in operations.iter_mut().zip(&mut least) {
            let start = ThreadTime::now();
            run();
            *least = least.min(start.elapsed().as_secs_f64());
        }
    }
    for ((who, what, _), least) in operations.iter().zip(&least) {
        print(who, what, file.len() as f64 / least / 1e6, "MB/s");
    }
    if let Some(tobj) = operations.iter().position(|o| o.0 == "tobj") {
        print("meshwright", &format!("read_{}_of_tobj", kind.name), least[tobj] / least[0], "ratio");
    }
}

/// Resident memory of this process in bytes, by the name the system gives it; 0 where it does not tell.
fn resident(name: &str) -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix(name));
    line.and_then(|l| l.trim().trim_end_matches(" kB").parse::<u64>().ok()).map_or(0, |kib| kib * 1024)
}
