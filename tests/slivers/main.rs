//! Slivers: resolved on named shapes, on shapes with random slivers put in, and on the corpus.

#[path = "../corpus/mod.rs"]
mod corpus;
#[path = "../shapes/mod.rs"]
mod shapes;

mod models;
mod named;
mod open;
mod random;

use meshwright::glam::{DVec3, dvec3};
use meshwright::{
    ClosestOptions, EdgeKey, FaceKey, IndexedMesh, Mesh, SliverAccount, SliverOptions, VertexKey,
};

/// The slivers, by brute force: every edge, every pair of corners, every triangle of the shared rule.
fn by_brute_force(mesh: &Mesh, tolerance: f64) -> Vec<FaceKey> {
    let is_sliver = |f: FaceKey| {
        let points: Vec<DVec3> = mesh.face_vertices(f).map(|v| mesh.position(v)).collect();
        let n = points.len();
        let extent = points.iter().flat_map(|p| points.iter().map(|q| p.distance(*q))).fold(0.0, f64::max);
        let fan = (2..n).map(|i| (points[i - 1] - points[0]).cross(points[i] - points[0]));
        let area = fan.fold(DVec3::ZERO, |sum, cross| sum + cross).length() / 2.0;
        let is_low = |area: f64, extent: f64| 2.0 * area <= tolerance * extent;
        let has_short_edge = (0..n).any(|i| points[i].distance(points[(i + 1) % n]) <= tolerance);
        // In place: the rule goes by the order of vertices.
        let has_low_part = n > 3 && {
            let mut cut = mesh.clone();
            let parts = cut.triangulate_face(f).expect("no diagonal is there").cuts;
            let low = |f: FaceKey| {
                let [a, b, c] = [0, 1, 2].map(|i| cut.position(cut.face_vertices(f).nth(i).unwrap()));
                let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
                is_low((b - a).cross(c - a).length() / 2.0, longest)
            };
            parts.iter().map(|p| p.face).chain([f]).any(low)
        };
        has_short_edge || is_low(area, extent) || has_low_part
    };
    mesh.faces().filter(|&f| is_sliver(f)).collect()
}

/// Components, boundary loops, Euler characteristic.
fn facts(m: &Mesh) -> (usize, usize, i64) {
    (m.components().len(), m.boundary_loops().len(), m.euler_characteristic())
}

/// How far the vertices of one and the middles of its faces are from the other at most.
fn apart(one: &Mesh, other: &Mesh) -> f64 {
    let index = other.index();
    let corners = one.vertices().map(|v| one.position(v));
    let middles = one
        .faces()
        .map(|f| one.face_vertices(f).map(|v| one.position(v)).sum::<DVec3>() / one.degree(f) as f64);
    let distance =
        |p: DVec3| index.closest_point(p, ClosestOptions::default()).unwrap().map_or(0.0, |c| c.distance);
    corners.chain(middles).map(distance).fold(0.0, f64::max)
}

/// Resolves, and checks what holds of every call but for how far the surface moved.
fn resolve_any(mesh: &mut Mesh, tolerance: f64) -> SliverAccount {
    let before = mesh.clone();
    let account = mesh.resolve_slivers(SliverOptions::new(tolerance)).expect("a good tolerance");
    assert_eq!(mesh.validate(), Ok(()));
    assert_eq!(mesh.violations(), []);
    assert_eq!(facts(mesh), facts(&before), "components, boundary loops, Euler characteristic");
    assert_eq!(mesh.is_closed(), before.is_closed());
    assert_eq!(account.found, before.slivers(tolerance).len());
    assert_eq!(account.found + account.arose, account.resolved.len() + account.left.len());
    assert_eq!(mesh.slivers(tolerance), account.left.iter().map(|l| l.sliver).collect::<Vec<_>>());
    if let (Ok(old), Ok(new)) = (before.closed(), mesh.closed()) {
        let size = before.bounds().map_or(0.0, |b| b.min.distance(b.max)).powi(3);
        assert!((old.volume() - new.volume()).abs() <= 1e-12 * size, "{} {}", old.volume(), new.volume());
    }
    let mut again = before.clone();
    assert_eq!(again.resolve_slivers(SliverOptions::new(tolerance)).unwrap(), account, "deterministic");
    assert_eq!(again.to_indexed(), mesh.to_indexed());
    account
}

/// Resolves, and checks also that nothing is left and that the surface did not move.
fn resolve(mesh: &mut Mesh) -> SliverAccount {
    let (before, tolerance) = (mesh.clone(), mesh.propose_sliver_tolerance());
    let account = resolve_any(mesh, tolerance);
    assert_eq!(account.left, []);
    assert_eq!(by_brute_force(mesh, 0.99 * tolerance), []);
    assert!(account.moved <= tolerance);
    assert!(apart(&before, mesh) <= 2.0 * tolerance, "{} of {tolerance}", apart(&before, mesh));
    assert!(apart(mesh, &before) <= 2.0 * tolerance);
    account
}

fn edge(mesh: &Mesh, a: usize, b: usize) -> EdgeKey {
    let v: Vec<VertexKey> = mesh.vertices().collect();
    mesh.edge(mesh.find_halfedge(v[a], v[b]).expect("an edge"))
}

/// Puts a cap in: a vertex on the edge, for good in one face and cut off from the other by a triangle without area.
fn put_cap(mesh: &mut Mesh, e: EdgeKey, share: f64, flip: bool) {
    let h = mesh.edge_halfedge(e);
    let (a, b) = if flip { (mesh.target(h), mesh.origin(h)) } else { (mesh.origin(h), mesh.target(h)) };
    let at = mesh.position(a).lerp(mesh.position(b), share);
    let m = mesh.split_edge(e, at).expect("an edge can be split").vertex;
    // The face of b -> m -> a is cut from a to b.
    let out = mesh.find_halfedge(m, a).unwrap();
    if let Some(f) = mesh.face(out) {
        let [from, to] = [a, b].map(|v| mesh.face_halfedges(f).find(|&h| mesh.origin(h) == v).unwrap());
        mesh.split_face(from, to).expect("the edge was there");
    }
    // The other, if it was a triangle, becomes two.
    let out = mesh.find_halfedge(m, b).unwrap();
    if mesh.face(out).is_some_and(|f| mesh.degree(f) == 4) {
        let apex = mesh.next(mesh.next(out));
        let _ = mesh.split_face(out, apex);
    }
}

/// Puts a needle in: a vertex doubled at a distance, and the faces beside the new edge cut, if they are to be.
fn put_needle(mesh: &mut Mesh, v: VertexKey, which: usize, offset: DVec3, cut: bool) {
    let around: Vec<_> = mesh.outgoing(v).collect();
    let n = around.len();
    let (first, last) = (around[which % n], around[(which + n / 2 - 1) % n]);
    let at = mesh.position(v) + offset;
    let Ok(new) = mesh.split_vertex(first, last, at) else { return };
    if cut {
        for h in [mesh.edge_halfedge(new.edge), mesh.twin(mesh.edge_halfedge(new.edge))] {
            if let Some(f) = mesh.face(h) {
                let across = mesh.next(mesh.next(h));
                if mesh.degree(f) > 3 && mesh.split_face(h, across).is_err() {
                    continue;
                }
            }
        }
    }
}

/// A bracket of two arms, ten long, with a hole of thin triangles around it: closed, of long thin triangles.
fn bracket() -> IndexedMesh {
    // An L, extruded; the arcs of its inner corner are fine, so that caps of the ends are fans of thin triangles.
    let n = 24;
    let arc = (0..=n).map(|i| {
        let turn = f64::from(i) / f64::from(n) * std::f64::consts::FRAC_PI_2;
        dvec3(2.0 - turn.sin(), 2.0 - turn.cos(), 0.0)
    });
    let corners = [[0., 0.], [10., 0.], [10., 1.]].map(|[x, y]| dvec3(x, y, 0.0));
    let outline: Vec<DVec3> =
        corners.into_iter().chain(arc).chain([dvec3(1., 10., 0.), dvec3(0., 10., 0.)]).collect();
    let k = outline.len() as u32;
    let points = outline.iter().copied().chain(outline.iter().map(|&p| p + DVec3::Z * 0.5)).collect();
    let sides = (0..k).map(|i| vec![i, (i + 1) % k, (i + 1) % k + k, i + k]);
    let faces = sides.chain([(0..k).rev().collect(), (k..2 * k).collect()]).collect();
    let mut mesh = shapes::mesh(&shapes::pool(points, faces));
    for f in mesh.faces().collect::<Vec<_>>() {
        mesh.triangulate_face(f).expect("a plane polygon");
    }
    mesh.to_indexed()
}
