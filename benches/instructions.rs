//! Instructions of the hot paths, counted by callgrind: the same on every run, whatever else the machine does.
//!
//! `cargo bench --bench instructions [-- NAME...] [--levels N]`: for each path whose name contains one of the words, or for all,
//! the instructions for each element, on the sphere of `N` subdivisions (6: 82 thousand triangles), as subdivision leaves it
//! and shuffled. The program runs itself under valgrind, which must be installed, and counts within one function only.

#[path = "../tests/shapes/mod.rs"]
mod shapes;

use meshwright::cleanup::{self, CleanOptions, Weld};
use meshwright::glam::{DVec3, dvec3};
use meshwright::io::{self, Encoding, Format};
use meshwright::{
    ClosestOptions, Mesh, NormalWeight, PolygonSoup, Ray, ReduceOptions, ReduceTarget, Scheme, SmoothOptions,
    SubdivideOptions, unify_winding,
};
use shapes::Noise;
use std::env;
use std::error::Error;
use std::hint::black_box;
use std::process::Command;

/// What is prepared for every path.
struct Subject {
    pool: meshwright::IndexedMesh,
    mesh: Mesh,
    loose: PolygonSoup,
    rays: Vec<Ray>,
    points: Vec<DVec3>,
}

/// A path: its name, the element it is counted for, and what prepares it: how many elements there are, and what to run.
type Path = (&'static str, &'static str, for<'s> fn(&'s Subject) -> (usize, Box<dyn FnOnce() + 's>));

fn path<'s, T>(count: usize, run: impl FnOnce() -> T + 's) -> (usize, Box<dyn FnOnce() + 's>) {
    (count, Box::new(move || drop(black_box(run()))))
}

fn faces<'s, T>(s: &Subject, run: impl FnOnce() -> T + 's) -> (usize, Box<dyn FnOnce() + 's>) {
    path(s.pool.face_count(), run)
}

fn edit<'s, T>(s: &Subject, run: impl FnOnce(&mut Mesh) -> T + 's) -> (usize, Box<dyn FnOnce() + 's>) {
    let mut mesh = s.mesh.clone();
    faces(s, move || (run(&mut mesh), mesh))
}

fn subdivide(s: &Subject, scheme: Scheme) -> (usize, Box<dyn FnOnce() + '_>) {
    faces(s, move || s.mesh.subdivide(SubdivideOptions { scheme, ..Default::default() }).expect("subdivided"))
}

fn written(s: &Subject, format: Format, encoding: Encoding) -> Vec<u8> {
    let mut file = Vec::new();
    io::write(&s.pool.clone().into(), format, encoding, &mut file).expect("written");
    file
}

fn reading(s: &Subject, format: Format, encoding: Encoding) -> (usize, Box<dyn FnOnce() + '_>) {
    let file = written(s, format, encoding);
    faces(s, move || io::read(&file, format, &Default::default()).expect("what was written reads"))
}

const PATHS: &[Path] = &[
    ("one_ring", "vertex", |s| {
        let sum = |v| s.mesh.neighbors(v).map(|n| s.mesh.position(n)).sum::<DVec3>();
        path(s.pool.vertex_count(), move || s.mesh.vertices().map(sum).sum::<DVec3>())
    }),
    ("build", "face", |s| faces(s, || Mesh::build(&s.pool).expect("a manifold"))),
    ("to_indexed", "face", |s| faces(s, || s.mesh.to_indexed())),
    ("validate", "face", |s| faces(s, || s.mesh.validate().expect("valid"))),
    ("unify", "face", |s| faces(s, || unify_winding(&s.pool.topology()).expect("orientable"))),
    ("index_exact", "face", |s| faces(s, || cleanup::index(&s.loose, Weld::Exact).expect("welded"))),
    ("clean_preserve", "face", |s| {
        faces(s, || cleanup::clean(&s.loose, CleanOptions::default()).expect("cleaned"))
    }),
    ("normals", "face", |s| edit(s, |mesh| mesh.compute_normals(NormalWeight::Angle))),
    ("midpoint", "face", |s| subdivide(s, Scheme::Midpoint)),
    ("loop", "face", |s| subdivide(s, Scheme::Loop)),
    ("catmull_clark", "face", |s| subdivide(s, Scheme::CatmullClark)),
    ("laplacian", "face", |s| edit(s, |mesh| mesh.smooth(SmoothOptions::default()).expect("smoothed"))),
    ("reduce", "face", |s| {
        let target = ReduceTarget::Faces(s.pool.face_count() / 10);
        edit(s, move |mesh| mesh.reduce(ReduceOptions { target, ..Default::default() }).expect("reduced"))
    }),
    ("index", "face", |s| faces(s, || s.mesh.index())),
    ("first_hit", "ray", |s| {
        let index = s.mesh.index();
        path(s.rays.len(), move || s.rays.iter().filter(|r| index.first_hit(r).is_some()).count())
    }),
    ("closest_point", "query", |s| {
        let index = s.mesh.index();
        let near = move |p: &&DVec3| index.closest_point(**p, ClosestOptions::default()).is_ok();
        path(s.points.len(), move || s.points.iter().filter(near).count())
    }),
    ("read_obj", "face", |s| reading(s, Format::Obj, Encoding::Ascii)),
    ("read_ply", "face", |s| reading(s, Format::Ply, Encoding::Binary)),
    ("read_ply_ascii", "face", |s| reading(s, Format::Ply, Encoding::Ascii)),
    ("read_stl", "face", |s| reading(s, Format::Stl, Encoding::Binary)),
    ("read_stl_ascii", "face", |s| reading(s, Format::Stl, Encoding::Ascii)),
    ("read_off", "face", |s| reading(s, Format::Off, Encoding::Ascii)),
    ("write_obj", "face", |s| faces(s, || written(s, Format::Obj, Encoding::Ascii))),
    ("write_ply", "face", |s| faces(s, || written(s, Format::Ply, Encoding::Binary))),
    ("write_stl", "face", |s| faces(s, || written(s, Format::Stl, Encoding::Binary))),
];

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = env::args().skip(1).filter(|a| a != "--bench").collect();
    let words: Vec<&str> = args.iter().map(String::as_str).collect();
    if let ["--once", name, levels, order] = words[..] {
        let chosen = PATHS.iter().find(|p| p.0 == name).ok_or("no such path")?;
        let subject = subject(levels.parse()?, order == "shuffled");
        let (count, run) = (chosen.2)(&subject);
        counted_from_here(run);
        println!("{count}");
        return Ok(());
    }
    if Command::new("valgrind").arg("--version").output().is_err() {
        return Err("valgrind is not installed: instructions cannot be counted here".into());
    }
    let flag = words.iter().position(|w| *w == "--levels");
    let levels = flag.and_then(|i| words.get(i + 1)).copied().unwrap_or("6");
    let names: Vec<&str> = words.iter().take(flag.unwrap_or(words.len())).copied().collect();
    println!("instructions for each, on the sphere of {levels} subdivisions: in its order, and shuffled");
    for (name, element, _) in PATHS {
        if !names.is_empty() && !names.iter().any(|n| name.contains(n)) {
            continue;
        }
        let each = |order: &str| -> Result<f64, Box<dyn Error>> {
            let (all, count) = instructions(name, levels, order)?;
            Ok(all / count)
        };
        println!("{name}\t{:.0}\t{:.0}\tper {element}", each("own")?, each("shuffled")?);
    }
    Ok(())
}

/// Callgrind knows it by this name.
#[inline(never)]
fn counted_from_here(run: Box<dyn FnOnce() + '_>) {
    run();
}

fn subject(levels: u32, is_shuffled: bool) -> Subject {
    let sphere = shapes::icosphere(levels);
    let pool = if is_shuffled { shapes::shuffled(&sphere, 3) } else { sphere };
    let bounds = pool.bounds().expect("a point");
    let mut noise = Noise(9);
    let mut within = |factor: f64| {
        let unit = dvec3(noise.unit(), noise.unit(), noise.unit()) - 0.5;
        bounds.center() + (bounds.max - bounds.min) * unit * factor
    };
    let ray = |_| {
        let origin = within(2.0);
        Ray::new(origin, within(1.0) - origin).expect("a direction")
    };
    let rays = (0..10_000).map(ray).collect();
    let points = (0..2000).map(|_| within(1.2)).collect();
    Subject { mesh: shapes::mesh(&pool), loose: shapes::unwelded(&pool), pool, rays, points }
}

/// Instructions of a run of this program under callgrind, and how many elements the path has.
fn instructions(name: &str, levels: &str, order: &str) -> Result<(f64, f64), Box<dyn Error>> {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null", "--toggle-collect=*counted_from_here*"])
        .arg(env::current_exe()?)
        .args(["--once", name, levels, order])
        .output()?;
    let text = String::from_utf8_lossy(&output.stderr);
    let line = text.lines().find_map(|l| l.split_once("Collected : ")).ok_or_else(|| text.to_string())?;
    let count = String::from_utf8(output.stdout)?;
    Ok((line.1.trim().parse()?, count.trim().parse()?))
}
