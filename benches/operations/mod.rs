//! Every main operation on every shape that may bring out how it grows: what `growth` and `every` time.

#![allow(dead_code, reason = "each bench takes the shapes it needs")]

#[path = "../../tests/shapes/mod.rs"]
pub(crate) mod shapes;

use meshwright::cleanup::{self, CleanOptions, Weld};
use meshwright::glam::{DVec3, dvec3};
use meshwright::{
    ClosestOptions, FeatureOptions, FillHolesOptions, HalfedgeKey, IndexedMesh, Mesh, NormalWeight,
    PolygonSoup, Ray, ReduceOptions, ReduceTarget, Scheme, SelfIntersectionOptions, SliverOptions,
    SmoothMethod, SmoothOptions, SubdivideOptions, UnweldOptions, VertexKey, WeldOptions, unify_winding,
};
use shapes::Noise;
use std::hint::black_box;

/// What is operated on.
pub(crate) struct Subject {
    pub(crate) pool: IndexedMesh,
    /// The same, some faces reversed.
    mixed: IndexedMesh,
    /// Every face with vertices of its own.
    loose: PolygonSoup,
    pub(crate) mesh: Mesh,
    /// The vertex of the most edges.
    hub: VertexKey,
    rays: Vec<Ray>,
    points: Vec<DVec3>,
}

/// The kinds of shapes: in memory order and scattered, and such as have all their faces around one vertex or two.
pub(crate) const SHAPES: [&str; 6] =
    ["grid", "grid_shuffled", "sphere", "sphere_shuffled", "fan", "bipyramid"];

/// A shape of about so many faces.
pub(crate) fn shape(name: &str, faces: usize) -> IndexedMesh {
    let side = (faces as f64 / 2.0).sqrt().round().max(1.0) as u32;
    let levels = ((faces as f64 / 20.0).log(4.0).round().max(0.0)) as u32;
    match name {
        "grid" => shapes::grid(side),
        "grid_shuffled" => shapes::shuffled(&shapes::grid(side), 3),
        "sphere" => shapes::icosphere(levels),
        "sphere_shuffled" => shapes::shuffled(&shapes::icosphere(levels), 3),
        "fan" => fan(faces as u32),
        _ => bipyramid(faces as u32 / 2),
    }
}

fn circle(i: u32, n: u32, radius: f64) -> DVec3 {
    let (s, c) = (f64::from(i) / f64::from(n) * std::f64::consts::TAU).sin_cos();
    dvec3(radius * c, radius * s, 0.1 * (0.01 * f64::from(i)).sin())
}

/// `n` triangles around one vertex.
fn fan(n: u32) -> IndexedMesh {
    let points = [DVec3::Z].into_iter().chain((0..n).map(|i| circle(i, n, 1.0))).collect();
    let triangles: Vec<[u32; 3]> = (0..n).map(|i| [0, 1 + i, 1 + (i + 1) % n]).collect();
    IndexedMesh::from_triangles(points, &triangles).expect("a valid vertex pool")
}

/// `n` triangles around one vertex and `n` around another, on one ring.
fn bipyramid(n: u32) -> IndexedMesh {
    let points = [DVec3::Z, DVec3::NEG_Z].into_iter().chain((0..n).map(|i| circle(i, n, 1.0))).collect();
    let at = |i: u32| 2 + i % n;
    let pair = |i: u32| [[0, at(i), at(i + 1)], [1, at(i + 1), at(i)]];
    let triangles: Vec<[u32; 3]> = (0..n).flat_map(pair).collect();
    IndexedMesh::from_triangles(points, &triangles).expect("a valid vertex pool")
}

/// Rays and points a query operation asks about.
pub(crate) const QUESTIONS: usize = 1000;

impl Subject {
    pub(crate) fn new(pool: IndexedMesh) -> Self {
        let mesh = shapes::mesh(&pool);
        let mut valence = vec![0u32; pool.vertex_count()];
        pool.polygons().corners().iter().for_each(|&v| valence[v as usize] += 1);
        let hub = (0..valence.len()).max_by_key(|&v| (valence[v], usize::MAX - v)).expect("a vertex");
        let hub = mesh.numbering().vertices[hub];
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
        let rays = (0..QUESTIONS).map(ray).collect();
        let points = (0..QUESTIONS).map(|_| within(1.2)).collect();
        let mixed = shapes::some_reversed(&pool, 3, 5);
        let loose = shapes::unwelded(&pool);
        Self { pool, mixed, loose, mesh, hub, rays, points }
    }
}

/// What comes out: it is dropped when the clock has stopped.
pub(crate) trait Outcome {}

impl<T> Outcome for T {}

/// What is timed, once all before it is prepared.
pub(crate) type Run<'s> = Box<dyn FnOnce() -> Box<dyn Outcome + 's> + 's>;

/// An operation: its name, and how it is prepared, if it makes sense for a subject.
pub(crate) type Operation = (&'static str, fn(&Subject) -> Option<Run<'_>>);

/// Does it, and keeps the compiler from seeing that nobody looks at the result.
fn run<'s, T: 's>(f: impl FnOnce() -> T + 's) -> Option<Run<'s>> {
    Some(Box::new(move || Box::new(black_box(f())) as Box<dyn Outcome + 's>))
}

/// Does it to a copy.
fn edit<'s, T: 's>(s: &Subject, f: impl FnOnce(&mut Mesh) -> T + 's) -> Option<Run<'s>> {
    let mut mesh = s.mesh.clone();
    run(move || {
        let done = f(&mut mesh);
        (done, mesh)
    })
}

fn subdivide(s: &Subject, scheme: Scheme) -> Option<Run<'_>> {
    run(move || s.mesh.subdivide(SubdivideOptions { scheme, ..Default::default() }).expect("subdivided"))
}

fn smooth(s: &Subject, method: SmoothMethod) -> Option<Run<'_>> {
    edit(s, move |mesh| mesh.smooth(SmoothOptions { method, ..Default::default() }).expect("smoothed"))
}

/// Does it at a thousand half-edges that begin at the hub, or `across` from them; at those of a vertex and of those around
/// it, where no vertex has so many.
fn at_hub<'s>(s: &'s Subject, across: bool, f: fn(&mut Mesh, HalfedgeKey) -> bool) -> Option<Run<'s>> {
    let around = s.mesh.neighbors(s.hub).take(QUESTIONS);
    let more = around.flat_map(|v| s.mesh.outgoing(v)).take(QUESTIONS);
    let spokes: Vec<HalfedgeKey> =
        s.mesh.outgoing(s.hub).take(QUESTIONS).chain(more).take(QUESTIONS).collect();
    let at = move |h| if across { s.mesh.next(h) } else { h };
    let chosen: Vec<HalfedgeKey> = spokes.into_iter().map(at).collect();
    let mut mesh = s.mesh.clone();
    // The first birth after a build doubles the columns, which pays for as many births as there are elements.
    let last = mesh.faces().next_back();
    if let Some(last) = last {
        mesh.poke_face(last, DVec3::ZERO).expect("a live face");
    }
    run(move || {
        let count = chosen.into_iter().filter(|&h| mesh.contains_halfedge(h) && f(&mut mesh, h)).count();
        (count, mesh)
    })
}

macro_rules! files {
    ($(($read:literal, $write:literal, $format:ident, $encoding:ident)),*) => {
        /// Reading and writing of each format, from memory and to memory.
        #[cfg(feature = "io")]
        const FILES: &[Operation] = &[$(
            ($read, |s| {
                let file = written(s, meshwright::io::Format::$format, meshwright::io::Encoding::$encoding);
                run(move || meshwright::io::read(&file, meshwright::io::Format::$format, &Default::default())
                    .expect("what was written reads"))
            }),
            ($write, |s| {
                run(|| written(s, meshwright::io::Format::$format, meshwright::io::Encoding::$encoding))
            }),
        )*];
    };
}

files! {
    ("read_obj", "write_obj", Obj, Ascii),
    ("read_ply", "write_ply", Ply, Binary),
    ("read_ply_big", "write_ply_big", Ply, BigEndian),
    ("read_ply_ascii", "write_ply_ascii", Ply, Ascii),
    ("read_stl", "write_stl", Stl, Binary),
    ("read_stl_ascii", "write_stl_ascii", Stl, Ascii),
    ("read_off", "write_off", Off, Ascii)
}

#[cfg(not(feature = "io"))]
const FILES: &[Operation] = &[];

#[cfg(feature = "io")]
fn written(s: &Subject, format: meshwright::io::Format, encoding: meshwright::io::Encoding) -> Vec<u8> {
    let mut file = Vec::new();
    let soup: PolygonSoup = s.pool.clone().into();
    meshwright::io::write(&soup, format, encoding, &mut file).expect("written");
    file
}

/// All operations.
pub(crate) fn operations() -> impl Iterator<Item = Operation> {
    OPERATIONS.iter().chain(FILES).copied()
}

const OPERATIONS: &[Operation] = &[
    ("build", |s| run(|| Mesh::build(&s.pool).expect("a manifold"))),
    ("to_indexed", |s| run(|| s.mesh.to_indexed())),
    ("clone", |s| run(|| s.mesh.clone())),
    ("validate", |s| run(|| s.mesh.validate().expect("valid"))),
    ("one_rings", |s| {
        run(|| {
            let sum = |v| s.mesh.neighbors(v).map(|n| s.mesh.position(n)).sum::<DVec3>();
            s.mesh.vertices().map(sum).sum::<DVec3>()
        })
    }),
    ("find_halfedges", |s| {
        let ends: Vec<_> = s.mesh.halfedges().map(|h| (s.mesh.origin(h), s.mesh.target(h))).collect();
        let step = (ends.len() / QUESTIONS).max(1);
        run(move || ends.iter().step_by(step).filter(|e| s.mesh.find_halfedge(e.0, e.1).is_some()).count())
    }),
    ("boundary_loops", |s| run(|| s.mesh.boundary_loops())),
    ("components", |s| run(|| s.mesh.components())),
    ("closed", |s| run(|| s.mesh.closed().is_ok())),
    ("topology", |s| {
        run(|| {
            let facts = s.pool.topology();
            (
                facts.is_edge_manifold(),
                facts.is_vertex_manifold(),
                facts.orientable().is_ok(),
                facts.components().1,
            )
        })
    }),
    ("naked_edges", |s| run(|| s.pool.topology().naked_edges())),
    ("duplicate_faces", |s| run(|| s.pool.topology().duplicate_faces())),
    ("unify", |s| run(|| unify_winding(&s.mixed.topology()).expect("orientable"))),
    ("outward", |s| run(|| meshwright::orient_outward(&s.pool.topology(), Default::default()).is_ok())),
    ("index_exact", |s| run(|| cleanup::index(&s.loose, Weld::Exact).expect("welded"))),
    ("index_within", |s| run(|| cleanup::index(&s.loose, Weld::Within(1e-9)).expect("welded"))),
    ("propose_tolerance", |s| run(|| cleanup::propose_tolerance(&s.loose))),
    ("inspect", |s| run(|| cleanup::inspect(&s.loose, Weld::Exact).expect("inspected"))),
    ("clean_preserve", |s| run(|| cleanup::clean(&s.loose, CleanOptions::default()).expect("cleaned"))),
    ("clean_preserve_mixed", |s| {
        let soup: PolygonSoup = s.mixed.clone().into();
        run(move || cleanup::clean(&soup, CleanOptions::default()).expect("cleaned"))
    }),
    ("clean_solid", |s| run(|| cleanup::clean(&s.loose, CleanOptions::solid()).expect("cleaned"))),
    ("weld", |s| run(|| s.mesh.weld(WeldOptions { tolerance: 1e-9, ..Default::default() }).expect("welded"))),
    ("unweld", |s| {
        run(|| s.mesh.unweld(UnweldOptions { degrees: 30.0, ..Default::default() }).expect("unwelded"))
    }),
    ("normals", |s| edit(s, |mesh| mesh.compute_normals(NormalWeight::Angle))),
    ("area", |s| run(|| s.pool.area())),
    ("volume", |s| {
        let solid = s.mesh.closed().ok()?;
        run(move || solid.volume())
    }),
    ("translate", |s| edit(s, |mesh| mesh.translate(DVec3::ONE).expect("finite"))),
    ("midpoint", |s| subdivide(s, Scheme::Midpoint)),
    ("loop", |s| subdivide(s, Scheme::Loop)),
    ("catmull_clark", |s| subdivide(s, Scheme::CatmullClark)),
    ("sqrt3", |s| subdivide(s, Scheme::Sqrt3)),
    ("laplacian", |s| smooth(s, SmoothMethod::Laplacian)),
    ("taubin", |s| smooth(s, SmoothMethod::Taubin { mu: -0.53 })),
    ("cotangent", |s| smooth(s, SmoothMethod::Cotangent)),
    ("implicit", |s| smooth(s, SmoothMethod::Implicit)),
    ("reduce", |s| {
        let target = ReduceTarget::Faces(s.pool.face_count() / 10);
        edit(s, move |mesh| mesh.reduce(ReduceOptions { target, ..Default::default() }).expect("reduced"))
    }),
    ("fill_holes", |s| {
        edit(s, |mesh| mesh.fill_holes(FillHolesOptions::default()).expect("options that make sense"))
    }),
    ("slivers", |s| {
        edit(s, |mesh| {
            let tolerance = mesh.propose_sliver_tolerance();
            mesh.resolve_slivers(SliverOptions::new(tolerance)).expect("options that make sense")
        })
    }),
    ("feature_paths", |s| run(|| s.mesh.feature_paths(FeatureOptions { degrees: 30.0, boundary: true }))),
    ("hub_flip", |s| at_hub(s, false, |mesh, h| mesh.flip_edge(mesh.edge(h)).is_ok())),
    ("hub_split", |s| {
        at_hub(s, false, |mesh, h| {
            let middle = mesh.position(mesh.origin(h)).midpoint(mesh.position(mesh.target(h)));
            mesh.split_edge_and_faces(mesh.edge(h), middle).is_ok()
        })
    }),
    ("hub_collapse_rim", |s| at_hub(s, true, |mesh, h| mesh.collapse_into_target(h).is_ok())),
    ("hub_collapse_spokes", |s| at_hub(s, false, |mesh, h| mesh.collapse_into_target(mesh.twin(h)).is_ok())),
    ("hub_remove_faces", |s| {
        at_hub(s, false, |mesh, h| mesh.face(h).is_some_and(|f| mesh.remove_face(f).is_ok()))
    }),
    ("hub_poke", |s| {
        at_hub(s, false, |mesh, h| {
            let middle = mesh.position(mesh.target(h));
            mesh.face(h).is_some_and(|f| mesh.poke_face(f, middle).is_ok())
        })
    }),
    ("hub_join", |s| at_hub(s, false, |mesh, h| mesh.join_faces(mesh.edge(h)).is_ok())),
    ("index", |s| run(|| s.mesh.index())),
    ("first_hits", |s| {
        let index = s.mesh.index();
        run(move || s.rays.iter().filter(|r| index.first_hit(r).is_some()).count())
    }),
    ("hits", |s| {
        let index = s.mesh.index();
        run(move || s.rays.iter().map(|r| index.hits(r).len()).sum::<usize>())
    }),
    ("closest_points", |s| {
        let index = s.mesh.index();
        let near = move |p: &&DVec3| index.closest_point(**p, ClosestOptions::default()).is_ok();
        run(move || s.points.iter().filter(near).count())
    }),
    ("closest_vertices", |s| {
        let index = s.mesh.index();
        let near = move |p: &&DVec3| index.closest_vertex(**p, ClosestOptions::default()).is_ok();
        run(move || s.points.iter().filter(near).count())
    }),
    ("self_intersections", |s| {
        run(|| s.mesh.self_intersections(SelfIntersectionOptions::default()).expect("searched").count())
    }),
];
