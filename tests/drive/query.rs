//! A small mesh on a grid, rays and points: every query beside rational arithmetic over all triangles. The body of the
//! property tests and of the fuzz target.

#[path = "../exact/mod.rs"]
pub(crate) mod exact;

use arbitrary::{Arbitrary, Unstructured};
use exact::{Point, lines};
use meshwright::cleanup::{CleanOptions, clean};
use meshwright::glam::{DVec3, dvec3};
use meshwright::{
    ClosestOptions, Crossing, Feature, Mesh, MeshIndex, PolygonSoup, Polygons, Ray, SelfIntersectionOptions,
    Side,
};

/// What is asked of what; every number is taken into a small range.
#[derive(Arbitrary, Clone, Debug)]
pub(crate) struct Case {
    pub(crate) closed: bool,
    pub(crate) points: Vec<[i8; 3]>,
    pub(crate) faces: Vec<Vec<u8>>,
    pub(crate) rays: Vec<([i8; 3], [i8; 3])>,
    pub(crate) asked: Vec<[i8; 3]>,
}

pub(crate) fn drive(bytes: &[u8]) {
    if let Ok(case) = Case::arbitrary_take_rest(Unstructured::new(bytes)) {
        check(&case);
    }
}

fn at([x, y, z]: [i8; 3], unit: f64) -> DVec3 {
    let small = |x: i8| f64::from(x.rem_euclid(11) - 5) * unit;
    dvec3(small(x), small(y), small(z))
}

/// The cube's faces, which close whatever points they are laid over.
const CUBE: [[u32; 4]; 6] =
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

pub(crate) fn mesh(case: &Case) -> Option<Mesh> {
    let mut points: Vec<DVec3> = case.points.iter().take(10).map(|&p| at(p, 1.0)).collect();
    let mut faces: Vec<Vec<u32>> = Vec::new();
    if case.closed {
        points.resize(points.len().max(8), DVec3::ONE);
        faces.extend(CUBE.map(|f| f.to_vec()));
    }
    let count = points.len().max(1) as u32;
    let corners = |f: &Vec<u8>| f.iter().take(6).map(|&v| u32::from(v) % count).collect();
    faces.extend(case.faces.iter().take(if case.closed { 2 } else { 8 }).map(corners));
    let mesh = clean(&PolygonSoup::new(points, Polygons::from(faces)), CleanOptions::default()).ok()?.value;
    let is_fine = |v| {
        let quarters: DVec3 = mesh.position(v) * 4.0;
        quarters == quarters.round()
    };
    let all_fine = mesh.vertices().all(is_fine);
    all_fine.then_some(mesh)
}

/// Panics where a query and its twin disagree.
pub(crate) fn check(case: &Case) {
    let Some(mesh) = mesh(case) else { return };
    let (index, all) = (mesh.index(), exact::triangles(&mesh));
    let found = index.self_intersections(SelfIntersectionOptions::default()).expect("nobody cancels");
    let faces: Vec<_> = mesh.faces().collect();
    let number = |f| faces.iter().position(|&g| g == f).expect("of the mesh");
    let pairs: Vec<_> = found.pairs.iter().map(|p| (p.faces.map(number), p.contact as u8)).collect();
    assert_eq!(pairs, exact::self_intersections(&all));
    for &(o, d) in case.rays.iter().take(8) {
        let (o, d) = (at(o, 0.5), at(d, 1.0));
        if d != DVec3::ZERO {
            ray(&mesh, &index, &all, o, d);
        }
    }
    for &p in case.asked.iter().take(8) {
        point(&mesh, &index, &all, at(p, 0.5));
    }
}

/// The list of hits is that of the twin; first and any agree; and parity on closed meshes.
pub(crate) fn ray(mesh: &Mesh, index: &MeshIndex<'_>, all: &[exact::Triangle], o: DVec3, d: DVec3) {
    let r = Ray::new(o, d).expect("a ray");
    let hits = index.hits(&r);
    assert_eq!(index.first_hit(&r), hits.first().copied());
    assert_eq!(index.is_hit(&r), !hits.is_empty());
    let sign = |c: Crossing| match c {
        Crossing::Enter => -1,
        Crossing::Leave => 1,
        Crossing::Touch => 0,
    };
    let expected = lines::hits(all, Point::new(o), Point::new(d));
    let context = || format!("{o} {d}: {hits:#?} for {expected:#?} of {:?}", mesh.to_indexed());
    assert_eq!(hits.len(), expected.len(), "{}", context());
    let mut from = 0;
    for event in expected.chunk_by(|a, b| a.t.0 * b.t.1 == b.t.0 * a.t.1) {
        let own = &hits[from..from + event.len()];
        from += event.len();
        let t = event[0].t.0 as f64 / event[0].t.1 as f64;
        assert!(own.iter().all(|h| (h.t - t).abs() <= 1e-12 * (1.0 + t)), "{}", context());
        let mut ours: Vec<i32> = own.iter().map(|h| sign(h.crossing)).collect();
        let mut theirs: Vec<i32> = event.iter().map(|e| e.crossing).collect();
        ours.sort_unstable();
        theirs.sort_unstable();
        assert_eq!(ours, theirs, "{}", context());
        for h in own {
            let kind = match h.feature {
                Feature::Vertex(_) => 0,
                Feature::Edge(_) => 1,
                Feature::Face(_) => 2,
            };
            assert!(event.iter().any(|e| e.kinds[kind]), "{}", context());
        }
    }
    if let Ok(solid) = mesh.closed()
        && let Some(inside) = solid.index().winding_number(o).expect("finite")
    {
        assert_eq!(hits.iter().map(|h| sign(h.crossing)).sum::<i32>(), inside, "{}", context());
        let crossings = hits.iter().filter(|h| h.crossing != Crossing::Touch).count();
        assert_eq!(crossings % 2, inside.unsigned_abs() as usize % 2, "{}", context());
    }
}

/// Nearest elements are at the distance that the twin says, and no vertex is nearer.
pub(crate) fn point(mesh: &Mesh, index: &MeshIndex<'_>, all: &[exact::Triangle], p: DVec3) {
    let options = ClosestOptions { isolated_vertices: false, ..Default::default() };
    let surface = index.closest_point(p, options).expect("asked well");
    let exact_p = Point::new(p);
    let least = |squares: &mut dyn Iterator<Item = (i128, i128)>| {
        squares.map(|(above, below)| (above as f64 / below as f64).sqrt()).fold(f64::INFINITY, f64::min)
    };
    let of_surface = least(&mut all.iter().map(|t| lines::square(t, exact_p)));
    let Some(surface) = surface else { return assert!(all.is_empty()) };
    let close = |a: f64, b: f64| (a - b).abs() <= 1e-12 * (1.0 + b);
    assert!(close(surface.distance, of_surface), "{p}: {surface:?} for {of_surface}");
    let number = mesh.faces().position(|f| f == surface.face).expect("of the mesh");
    let of_face = least(&mut all.iter().filter(|t| t.face == number).map(|t| lines::square(t, exact_p)));
    assert!(close(of_face, of_surface), "{p}: {surface:?} is not on its face");
    let face = index.closest_face(p, options).expect("asked well").expect("a face");
    assert_eq!((face.element, face.distance), (surface.face, surface.distance));
    let edge = index.closest_edge(p, options).expect("asked well").expect("an edge");
    let sides = all.iter().flat_map(|t| (0..3).map(move |i| (t, i)));
    let of_mesh = |t: &exact::Triangle, i: usize| {
        let corners =
            mesh.faces().nth(t.face).map(|f| mesh.face_vertices(f).collect::<Vec<_>>()).expect("a face");
        let at = |v: u32| mesh.vertices().nth(v as usize).expect("a vertex");
        let (a, b) = (at(t.vertices[i]), at(t.vertices[(i + 1) % 3]));
        (0..corners.len()).any(|k| (corners[k], corners[(k + 1) % corners.len()]) == (a, b))
    };
    let of_edges = least(
        &mut sides.filter(|&(t, i)| of_mesh(t, i)).map(|(t, i)| lines::segment_square(t.edge(i), exact_p)),
    );
    assert!(close(edge.distance, of_edges), "{p}: {edge:?} for {of_edges}");
    let vertex = index.closest_vertex(p, options).expect("asked well").expect("a vertex");
    let used = mesh.vertices().filter(|&v| !mesh.is_isolated(v));
    let nearest = used.min_by(|&v, &w| {
        let square = |v| mesh.position(v).distance_squared(p);
        square(v).total_cmp(&square(w))
    });
    assert_eq!(Some(vertex.element), nearest, "{p}");
    assert!(surface.distance <= edge.distance + 1e-12 && edge.distance <= vertex.distance + 1e-12);
    if let Ok(solid) = mesh.closed() {
        let side = solid.index().contains(p).expect("asked well");
        assert_eq!(solid.contains(p), Ok(side));
        assert_eq!(side == Side::On, all.iter().any(|t| t.contains(exact_p)), "{p}: {side:?}");
    }
}
