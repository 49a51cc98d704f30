//! The algorithms of the mesh tutorial as it has them: plain lists, and loops over everything. They are slow and right
//! wherever they are well defined, so they stand beside ours as twins.
//!
//! One line is put right: the tutorial's nearest point in the middle of a triangle adds the X of an edge to Y and Z.

#![allow(dead_code, reason = "each test takes the twins it needs")]

use meshwright::IndexedMesh;
use meshwright::glam::{DVec3, dvec3};
use std::collections::{BTreeSet, VecDeque};

/// A ray's hits begin behind this, as in the tutorial.
pub(crate) const RAY_START: f64 = 1e-6;

/// A mesh as two lists.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Plain {
    pub(crate) points: Vec<DVec3>,
    pub(crate) faces: Vec<Vec<u32>>,
}

impl From<&IndexedMesh> for Plain {
    fn from(pool: &IndexedMesh) -> Self {
        let faces = pool.polygons().iter().map(<[u32]>::to_vec).collect();
        Self { points: pool.positions().to_vec(), faces }
    }
}

impl Plain {
    pub(crate) fn pool(&self) -> IndexedMesh {
        IndexedMesh::new(self.points.clone(), self.faces.clone().into()).expect("a valid vertex pool")
    }

    fn at(&self, v: u32) -> DVec3 {
        self.points[v as usize]
    }

    fn triangle(&self, f: usize) -> [DVec3; 3] {
        let [a, b, c] = self.faces[f][..] else { panic!("face {f} is no triangle") };
        [a, b, c].map(|v| self.at(v))
    }
}

/// The edges of a face, as it runs.
fn edges(face: &[u32]) -> impl Iterator<Item = [u32; 2]> {
    (0..face.len()).map(|i| [face[i], face[(i + 1) % face.len()]])
}

fn is_edge_of(face: &[u32], [a, b]: [u32; 2]) -> bool {
    edges(face).any(|e| e == [a, b] || e == [b, a])
}

/// Weld: for each vertex the first kept one nearer than the tolerance, or else itself, which is then kept. A tolerance of
/// zero takes equal coordinates.
pub(crate) fn weld(points: &[DVec3], tolerance: f64) -> Vec<usize> {
    let mut kept: Vec<usize> = Vec::new();
    let mut merged = Vec::new();
    for (i, p) in points.iter().enumerate() {
        let joins = |j: &usize| {
            let apart = (points[*j] - *p) / tolerance;
            if tolerance == 0.0 { points[*j] == *p } else { apart.length_squared() < 1.0 }
        };
        match kept.iter().copied().find(joins) {
            Some(j) => merged.push(j),
            None => {
                kept.push(i);
                merged.push(i);
            }
        }
    }
    merged
}

/// Naked edges: those that exactly one face has.
pub(crate) fn naked_edges(mesh: &Plain) -> BTreeSet<[u32; 2]> {
    let mut naked = BTreeSet::new();
    for face in &mesh.faces {
        for [a, b] in edges(face) {
            if mesh.faces.iter().filter(|f| is_edge_of(f, [a, b])).count() == 1 {
                naked.insert([a.min(b), a.max(b)]);
            }
        }
    }
    naked
}

/// Unify: from face 0 breadth-first over shared edges, each neighbour reversed if it runs along the edge the same way;
/// then from the next face not reached. Well defined where no edge has three faces and the surface can be oriented.
pub(crate) fn unify(mesh: &Plain) -> Plain {
    let mut faces = mesh.faces.clone();
    let mut reached = vec![false; faces.len()];
    for start in 0..faces.len() {
        if std::mem::replace(&mut reached[start], true) {
            continue;
        }
        let mut queue = VecDeque::from([start]);
        while let Some(f) = queue.pop_front() {
            for edge in edges(&faces[f].clone()) {
                for g in 0..faces.len() {
                    if reached[g] || !is_edge_of(&faces[g], edge) {
                        continue;
                    }
                    reached[g] = true;
                    if edges(&faces[g]).any(|e| e == edge) {
                        faces[g].reverse();
                    }
                    queue.push_back(g);
                }
            }
        }
    }
    Plain { points: mesh.points.clone(), faces }
}

/// The nearest of some places: which, and how far.
fn nearest(places: impl Iterator<Item = DVec3>, p: DVec3) -> (usize, f64) {
    let mut best = (0, f64::INFINITY);
    for (i, at) in places.enumerate() {
        if at.distance_squared(p) < best.1 {
            best = (i, at.distance_squared(p));
        }
    }
    (best.0, best.1.sqrt())
}

/// Closest vertex: the first of the nearest.
pub(crate) fn closest_vertex(mesh: &Plain, p: DVec3) -> (usize, f64) {
    nearest(mesh.points.iter().copied(), p)
}

/// Closest face as the tutorial means it: the one with the nearest centre.
pub(crate) fn closest_face_center(mesh: &Plain, p: DVec3) -> (usize, f64) {
    let center = |f: &Vec<u32>| f.iter().map(|&v| mesh.at(v)).sum::<DVec3>() / f.len() as f64;
    nearest(mesh.faces.iter().map(center), p)
}

/// The nearest point of a segment.
pub(crate) fn on_segment(p: DVec3, a: DVec3, b: DVec3) -> DVec3 {
    let along = b - a;
    let t = (p - a).dot(along) / along.length_squared();
    if t.is_finite() { a + along * t.clamp(0.0, 1.0) } else { a }
}

/// Closest edge: how far the network of edges is away.
pub(crate) fn closest_edge(mesh: &Plain, p: DVec3) -> f64 {
    let mut best = f64::INFINITY;
    for face in &mesh.faces {
        for [a, b] in edges(face) {
            best = best.min(on_segment(p, mesh.at(a), mesh.at(b)).distance(p));
        }
    }
    best
}

/// The tutorial's nearest point of a triangle by regions (Ericson), with its last line put right or as it is printed.
fn by_regions(p: DVec3, [a, b, c]: [DVec3; 3], as_printed: bool) -> DVec3 {
    let (ab, ac) = (b - a, c - a);
    let (d1, d2) = (ab.dot(p - a), ac.dot(p - a));
    let (d3, d4) = (ab.dot(p - b), ac.dot(p - b));
    let (d5, d6) = (ab.dot(p - c), ac.dot(p - c));
    if d1 <= 0. && d2 <= 0. {
        return a;
    }
    if d3 >= 0. && d4 <= d3 {
        return b;
    }
    if d6 >= 0. && d5 <= d6 {
        return c;
    }
    let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
    if vc <= 0. && d1 >= 0. && d3 <= 0. {
        return a + ab * (d1 / (d1 - d3));
    }
    if vb <= 0. && d2 >= 0. && d6 <= 0. {
        return a + ac * (d2 / (d2 - d6));
    }
    if va <= 0. && d4 >= d3 && d5 >= d6 {
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    let (v, w) = (vb / (va + vb + vc), vc / (va + vb + vc));
    if as_printed {
        return dvec3(a.x + ab.x * v + ac.x * w, a.y + ab.y * v + ac.x * w, a.z + ab.z * v + ac.x * w);
    }
    a + ab * v + ac * w
}

/// The nearest point of a triangle; of a flat one, of its sides.
pub(crate) fn on_triangle(p: DVec3, corners: [DVec3; 3]) -> DVec3 {
    let [a, b, c] = corners;
    let (ab, ac) = (b - a, c - a);
    if ab.cross(ac).length() <= 1e-9 * ab.length().max(ac.length()).powi(2) {
        let feet = [on_segment(p, a, b), on_segment(p, b, c), on_segment(p, c, a)];
        return feet.into_iter().min_by(|x, y| x.distance(p).total_cmp(&y.distance(p))).expect("three");
    }
    by_regions(p, corners, false)
}

/// What the tutorial's own last line gives.
pub(crate) fn on_triangle_as_printed(p: DVec3, corners: [DVec3; 3]) -> DVec3 {
    by_regions(p, corners, true)
}

/// Closest point: how far the surface is away. Triangles only.
pub(crate) fn closest_point(mesh: &Plain, p: DVec3) -> f64 {
    let far = |f| on_triangle(p, mesh.triangle(f)).distance(p);
    (0..mesh.faces.len()).map(far).fold(f64::INFINITY, f64::min)
}

/// Raycast (Moeller and Trumbore): every t behind [`RAY_START`] with its triangle, in order. Well defined for rays that
/// pass through no edge.
pub(crate) fn raycast(mesh: &Plain, origin: DVec3, direction: DVec3) -> Vec<(f64, usize)> {
    let mut found = Vec::new();
    for f in 0..mesh.faces.len() {
        let [a, b, c] = mesh.triangle(f);
        let (e1, e2) = (b - a, c - a);
        let p = direction.cross(e2);
        let det = e1.dot(p);
        if det == 0.0 {
            continue;
        }
        let s = origin - a;
        let u = s.dot(p) / det;
        let q = s.cross(e1);
        let v = direction.dot(q) / det;
        let t = e2.dot(q) / det;
        if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > RAY_START {
            found.push((t, f));
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found
}

/// Laplacian smoothing: every vertex goes towards the mean of those joined to it by an edge, all at once.
pub(crate) fn laplacian(
    mesh: &Plain,
    lambda: f64,
    iterations: u32,
    stays: impl Fn(usize) -> bool,
) -> Vec<DVec3> {
    let mut points = mesh.points.clone();
    for _ in 0..iterations {
        let mut moved = points.clone();
        for (v, at) in moved.iter_mut().enumerate() {
            let mut neighbours: Vec<u32> = Vec::new();
            for [a, b] in mesh.faces.iter().flat_map(|f| edges(f)) {
                for (from, to) in [(a, b), (b, a)] {
                    if from as usize == v && !neighbours.contains(&to) {
                        neighbours.push(to);
                    }
                }
            }
            if !neighbours.is_empty() && !stays(v) {
                let sum: DVec3 = neighbours.iter().map(|&w| points[w as usize]).sum();
                *at += (sum / neighbours.len() as f64 - *at) * lambda;
            }
        }
        points = moved;
    }
    points
}

/// Edge collapse: the second end goes into the first, which goes to the middle; faces that name it twice name it once,
/// and go if fewer than three corners are left.
pub(crate) fn collapse(mesh: &Plain, keep: u32, drop: u32) -> Plain {
    let mut mesh = mesh.clone();
    mesh.points[keep as usize] = (mesh.at(keep) + mesh.at(drop)) / 2.0;
    for face in &mut mesh.faces {
        face.iter_mut().filter(|v| **v == drop).for_each(|v| *v = keep);
        let mut seen = Vec::new();
        face.retain(|v| {
            let is_new = !seen.contains(v);
            seen.push(*v);
            is_new
        });
    }
    mesh.faces.retain(|f| f.len() >= 3);
    mesh
}

/// Volume by the divergence theorem, about the origin and with no care for rounding. Polygons as fans.
pub(crate) fn volume(mesh: &Plain) -> f64 {
    let mut sum = 0.0;
    for face in &mesh.faces {
        for i in 2..face.len() {
            sum += mesh.at(face[0]).dot(mesh.at(face[i - 1]).cross(mesh.at(face[i]))) / 6.0;
        }
    }
    sum
}
