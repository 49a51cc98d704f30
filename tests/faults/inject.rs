//! Faults put into shapes, each by its own function; they can follow each other.

use crate::shapes::{Noise, moebius, soup};
use crate::truth::{Truth, sheet_of_quads};
use meshwright::glam::{DVec3, dvec3};
use meshwright::{IndexedMesh, Mesh, PolygonSoup};
use std::collections::{BTreeMap, BTreeSet};

/// An edge with its two faces and its place in each.
type Joint = ([u32; 2], [(usize, usize); 2]);

/// A shape under way to a faulty file.
#[derive(Clone)]
pub(crate) struct Faulty {
    pub(crate) points: Vec<DVec3>,
    /// Each face, with that of the truth it is, if it still is one.
    pub(crate) faces: Vec<(Vec<u32>, Option<u32>)>,
    /// Which faces of the truth should be there in the end.
    pub(crate) intact: Vec<bool>,
    pub(crate) noise: Noise,
    pub(crate) diagonal: f64,
    /// How far points were moved at most.
    pub(crate) jitter: f64,
}

impl Faulty {
    pub(crate) fn new(truth: &Truth, seed: u64) -> Self {
        let faces = truth.pool.polygons().iter().zip(0..).map(|(f, i)| (f.to_vec(), Some(i))).collect();
        Self {
            points: truth.pool.positions().to_vec(),
            faces,
            intact: vec![true; truth.pool.face_count()],
            noise: Noise(seed * 7919 + 13),
            diagonal: truth.diagonal,
            jitter: 0.0,
        }
    }

    /// With faces that name shared vertices: of a truth whose parts touch.
    pub(crate) fn glued(truth: &Truth, soup: &PolygonSoup, seed: u64) -> Self {
        let mut faulty = Self::new(truth, seed);
        faulty.faces.iter_mut().zip(soup.polygons.iter()).for_each(|(face, glued)| face.0 = glued.to_vec());
        faulty
    }

    pub(crate) fn soup(&self) -> PolygonSoup {
        PolygonSoup::new(self.points.clone(), self.faces.iter().map(|f| f.0.clone()).collect())
    }

    fn below(&mut self, n: usize) -> usize {
        self.noise.below(n as u32) as usize
    }

    /// How many caps, or T-junctions, may be put in if 98 of 100 intact faces are to be kept when both come together: each
    /// makes a corner in a sound face.
    fn few(&self) -> usize {
        (self.intact.len() / 200).clamp(1, 8)
    }

    fn add(&mut self, point: DVec3) -> u32 {
        self.points.push(point);
        self.points.len() as u32 - 1
    }

    /// The faces at each edge, with the place of the edge in each.
    fn edges(&self) -> BTreeMap<[u32; 2], Vec<(usize, usize)>> {
        let mut edges: BTreeMap<[u32; 2], Vec<(usize, usize)>> = BTreeMap::new();
        for (f, (face, _)) in self.faces.iter().enumerate() {
            for i in 0..face.len() {
                let (a, b) = (face[i], face[(i + 1) % face.len()]);
                edges.entry([a.min(b), a.max(b)]).or_default().push((f, i));
            }
        }
        edges
    }

    /// A two-face edge at random whose faces are both as in the truth: its ends as the first face runs along it, and the two
    /// faces.
    fn some_edge(&mut self) -> Option<Joint> {
        let edges: Vec<_> = self.edges().into_iter().filter(|e| e.1.len() == 2).collect();
        for _ in 0..100 {
            let (_, at) = &edges[self.below(edges.len())];
            let is_intact = |f: usize| self.faces[f].1.is_some_and(|t| self.intact[t as usize]);
            if at.iter().all(|&(f, _)| is_intact(f)) {
                let (f, i) = at[0];
                let face = &self.faces[f].0;
                return Some(([face[i], face[(i + 1) % face.len()]], [at[0], at[1]]));
            }
        }
        None
    }

    fn spoil(&mut self, f: usize) {
        if let Some(truth) = self.faces[f].1.take() {
            self.intact[truth as usize] = false;
        }
    }

    /// Puts a vertex into a face after one of its corners; a triangle becomes two.
    fn insert(&mut self, (f, i): (usize, usize), vertex: u32) {
        self.spoil(f);
        let face = &mut self.faces[f].0;
        if let [x, y, z] = face[..] {
            let [a, b, c] = [[x, y, z], [y, z, x], [z, x, y]][i];
            *face = vec![a, vertex, c];
            self.faces.push((vec![vertex, b, c], None));
        } else {
            face.insert(i + 1, vertex);
        }
    }
}

/// Every face with vertices of its own.
pub(crate) fn unweld(it: &mut Faulty) {
    let mut points = Vec::new();
    for (face, _) in &mut it.faces {
        for v in face {
            let at = it.points.get(*v as usize).copied();
            if let Some(p) = at {
                points.push(p);
                *v = points.len() as u32 - 1;
            }
        }
    }
    // What is out of range stays so.
    let count = points.len() as u32;
    it.faces.iter_mut().flat_map(|f| &mut f.0).filter(|v| **v >= count).for_each(|v| *v = u32::MAX);
    it.points = points;
}

/// Every corner moved a little on its own.
pub(crate) fn jitter(it: &mut Faulty) {
    let share = [1e-7, 1e-6, 1e-5][it.below(3)];
    jitter_by(it, share);
}

/// Every corner moved by up to this share of the diagonal.
fn jitter_by(it: &mut Faulty, share: f64) {
    unweld(it);
    let by = it.diagonal * share;
    it.jitter = by;
    for i in 0..it.points.len() {
        let mut off = || it.noise.unit() - 0.5;
        it.points[i] += dvec3(off(), off(), off()) * by;
    }
}

pub(crate) fn flip(it: &mut Faulty) {
    for f in 0..it.faces.len() {
        if it.noise.below(3) == 0 {
            it.faces[f].0.reverse();
        }
    }
}

pub(crate) fn invert(it: &mut Faulty) {
    it.faces.iter_mut().for_each(|f| f.0.reverse());
}

/// A few holes of 1 to 30 faces each, in all no more than an eighth of the shape.
pub(crate) fn holes(it: &mut Faulty) {
    let edges = it.edges();
    let mut beside: Vec<Vec<usize>> = vec![Vec::new(); it.faces.len()];
    for at in edges.values().filter(|at| at.len() == 2) {
        beside[at[0].0].push(at[1].0);
        beside[at[1].0].push(at[0].0);
    }
    let mut at_vertex: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (f, (face, _)) in it.faces.iter().enumerate() {
        face.iter().for_each(|&v| at_vertex.entry(v).or_default().push(f));
    }
    let most = 1 + it.faces.len() / 40;
    let mut used = vec![false; it.faces.len()];
    let mut gone: BTreeSet<usize> = BTreeSet::new();
    for _ in 0..4 {
        let size = 1 + it.below(30.min(most));
        let mut region = vec![it.below(it.faces.len())];
        let mut next = 0;
        while region.len() < size && next < region.len() {
            for &g in &beside[region[next]] {
                if region.len() < size && !region.contains(&g) {
                    region.push(g);
                }
            }
            next += 1;
        }
        // Not beside another hole, nor a hole that touches itself, nor around something.
        let around: BTreeSet<usize> =
            region.iter().flat_map(|&f| &it.faces[f].0).flat_map(|v| &at_vertex[v]).copied().collect();
        if around.iter().any(|&f| used[f]) || !is_disc(it, &region) {
            continue;
        }
        around.iter().for_each(|&f| used[f] = true);
        gone.extend(region);
    }
    for &f in &gone {
        it.spoil(f);
    }
    let mut f = 0;
    it.faces.retain(|_| {
        f += 1;
        !gone.contains(&(f - 1))
    });
}

/// Whether faces have one boundary that passes no vertex twice.
fn is_disc(it: &Faulty, region: &[usize]) -> bool {
    let mut next: BTreeMap<u32, u32> = BTreeMap::new();
    let halfedges: BTreeSet<(u32, u32)> = region
        .iter()
        .flat_map(|&f| {
            let face = &it.faces[f].0;
            (0..face.len()).map(|i| (face[i], face[(i + 1) % face.len()])).collect::<Vec<_>>()
        })
        .collect();
    for &(a, b) in halfedges.iter().filter(|&&(a, b)| !halfedges.contains(&(b, a))) {
        if next.insert(a, b).is_some() {
            return false;
        }
    }
    let Some((&first, _)) = next.iter().next() else { return false };
    let (mut at, mut steps) = (next[&first], 1);
    while at != first {
        at = next[&at];
        steps += 1;
    }
    steps == next.len()
}

/// Faces twice, as they are or from another corner.
pub(crate) fn duplicate(it: &mut Faulty) {
    for _ in 0..1 + it.faces.len() / 50 {
        let f = it.below(it.faces.len());
        let (mut face, truth) = it.faces[f].clone();
        if truth.is_some() {
            let by = it.below(face.len());
            face.rotate_left(by);
            it.faces.push((face, None));
        }
    }
}

/// Faces twice, the second time reversed.
pub(crate) fn duplicate_reversed(it: &mut Faulty) {
    let before = it.faces.len();
    duplicate(it);
    it.faces[before..].iter_mut().for_each(|f| f.0.reverse());
}

/// Triangles without height: between an edge and a vertex on it.
pub(crate) fn caps(it: &mut Faulty) {
    for i in 0..it.few() {
        let Some(([a, b], at)) = it.some_edge() else { return };
        let share = [0.5, 0.25, 0.001][i % 3];
        let middle = it.points[a as usize].lerp(it.points[b as usize], share);
        let m = it.add(middle);
        it.insert(at[0], m);
        it.faces.push((vec![a, b, m], None));
    }
}

/// Triangles with an edge of next to no length.
pub(crate) fn needles(it: &mut Faulty) {
    for _ in 0..it.few() {
        let Some(([a, b], at)) = it.some_edge() else { return };
        let (p, q) = (it.points[a as usize], it.points[b as usize]);
        let near = p + (q - p).normalize() * it.diagonal * 1e-12;
        let m = it.add(near);
        for at in at {
            it.insert(at, m);
        }
    }
}

/// Triangles and strips that hang on an edge.
pub(crate) fn fins(it: &mut Faulty) {
    for i in 0..4 {
        let Some(([a, b], _)) = it.some_edge() else { return };
        let mut off = || it.noise.unit() - 0.5;
        let away = dvec3(off(), off(), off()) * it.diagonal * 0.1;
        let (p, q) = (it.points[a as usize], it.points[b as usize]);
        let c = it.add(p + away);
        it.faces.push((vec![a, b, c], None));
        if i % 2 == 1 {
            let d = it.add(q + away);
            it.faces.push((vec![c, b, d], None));
        }
    }
}

/// Vertices in the middle of an edge of which only one of the faces knows.
pub(crate) fn t_junctions(it: &mut Faulty) {
    for i in 0..it.few() {
        let Some(([a, b], at)) = it.some_edge() else { return };
        let share = [0.5, 1.0 / 3.0][i % 2];
        let middle = it.points[a as usize].lerp(it.points[b as usize], share);
        let m = it.add(middle);
        it.insert(at[0], m);
    }
}

/// Faces at points that are no numbers.
pub(crate) fn not_finite(it: &mut Faulty) {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let v = it.add(dvec3(0.5, bad, 0.5));
        let f = it.below(it.faces.len());
        let mut face = it.faces[f].0.clone();
        face[0] = v;
        it.faces.push((face, None));
    }
}

/// Faces at points that do not exist.
pub(crate) fn bad_indices(it: &mut Faulty) {
    for bad in [it.points.len() as u32 + 5, u32::MAX, u32::MAX - 1] {
        let f = it.below(it.faces.len());
        let mut face = it.faces[f].0.clone();
        face[1] = bad;
        it.faces.push((face, None));
    }
    it.faces.push((vec![0, 1], None));
    it.faces.push((vec![], None));
    it.faces.push((vec![2, 2, 2], None));
}

/// Points that no face names.
pub(crate) fn isolated(it: &mut Faulty) {
    for _ in 0..10 {
        let mut at = || it.noise.unit() * 2.0 - 0.5;
        let p = dvec3(at(), at(), at()) * it.diagonal;
        it.add(p);
    }
}

/// Everything that can come together but contact, which [`touched_at_an_edge`] brings, in an order in which it can.
pub(crate) fn all_at_once(it: &mut Faulty) {
    for fault in [holes, caps, needles, t_junctions, fins, duplicate, duplicate_reversed, flip] {
        fault(it);
    }
    for fault in [not_finite, isolated, unweld, bad_indices] {
        fault(it);
    }
}

/// Everything, and every corner moved a little.
pub(crate) fn all_at_once_jittered(it: &mut Faulty) {
    for fault in [holes, caps, needles, t_junctions, fins, duplicate, duplicate_reversed, flip] {
        fault(it);
    }
    not_finite(it);
    isolated(it);
    jitter_by(it, 1e-7);
    bad_indices(it);
}

/// The shape twice, touching itself at one vertex, which both name.
pub(crate) fn touching_at_a_vertex(truth: &Truth) -> (Truth, PolygonSoup) {
    let direction = dvec3(1.0, 0.311, 0.173);
    let points = truth.pool.positions();
    let by = |a: &&DVec3, b: &&DVec3| a.dot(direction).total_cmp(&b.dot(direction));
    let (low, high) = (points.iter().min_by(by).expect("points"), points.iter().max_by(by).expect("points"));
    let mut other = truth.pool.clone();
    other.map_positions(|p| p - low + high).expect("finite");
    glued(truth, &other, |p| p.distance(*high) < 1e-9 * truth.diagonal)
}

/// The shape and its mirror image, touching along an edge, which both name; if it has an edge where that can be.
pub(crate) fn touching_at_an_edge(truth: &Truth) -> Option<(Truth, PolygonSoup)> {
    let points = truth.pool.positions();
    let mut normals: BTreeMap<[u32; 2], DVec3> = BTreeMap::new();
    for face in truth.pool.polygons().iter() {
        let at = |i: usize| points[face[i % face.len()] as usize];
        let normal = (1..face.len() - 1).map(|i| (at(i) - at(0)).cross(at(i + 1) - at(0))).sum::<DVec3>();
        for i in 0..face.len() {
            let (a, b) = (face[i], face[(i + 1) % face.len()]);
            *normals.entry([a.min(b), a.max(b)]).or_default() += normal.normalize();
        }
    }
    let eps = 1e-9 * truth.diagonal;
    let (plane, normal) = normals.into_iter().find_map(|([a, _], normal)| {
        let (at, normal) = (points[a as usize], normal.normalize());
        // Faces in the plane would touch too.
        let beside = points.iter().filter(|p| (**p - at).dot(normal) > -eps).count();
        let above = points.iter().any(|p| (*p - at).dot(normal) > eps);
        (!above && beside < truth.pool.vertex_count() / 10).then_some((at, normal))
    })?;
    let on = |p: DVec3| (p - plane).dot(normal).abs() < eps;
    // A flat edge has whole faces in the plane.
    if truth.pool.polygons().iter().any(|f| f.iter().all(|&v| on(points[v as usize]))) {
        return None;
    }
    let mut other = truth.pool.clone().reversed();
    other
        .map_positions(|p| if on(p) { p } else { p - normal * 2.0 * (p - plane).dot(normal) })
        .expect("finite");
    Some(glued(truth, &other, on))
}

/// The shape and a small tetrahedron that stands on one of its edges, which both name: four faces at that edge. The edge is
/// one at random where the shape bends outward, or not at all.
pub(crate) fn touched_at_an_edge(truth: &Truth, noise: &mut Noise) -> (Truth, PolygonSoup) {
    let points = truth.pool.positions();
    let at = |v: u32| points[v as usize];
    let mut sides: BTreeMap<[u32; 2], Vec<(DVec3, DVec3)>> = BTreeMap::new();
    for face in truth.pool.polygons().iter() {
        let corner = |i: usize| at(face[i % face.len()]);
        let normal = (1..face.len() - 1)
            .map(|i| (corner(i) - corner(0)).cross(corner(i + 1) - corner(0)))
            .sum::<DVec3>();
        let normal = normal.normalize();
        for i in 0..face.len() {
            let (a, b) = (face[i], face[(i + 1) % face.len()]);
            // Into the face.
            let inward = normal.cross(at(b) - at(a)).normalize();
            sides.entry([a.min(b), a.max(b)]).or_default().push((normal, inward));
        }
    }
    let bends_outward = |s: &[(DVec3, DVec3)]| s[0].1.dot(s[1].0) < 1e-9;
    let edges: Vec<_> = sides.into_iter().filter(|s| bends_outward(&s.1)).collect();
    let ([a, b], sides) = &edges[noise.below(edges.len() as u32) as usize];
    let (p, q) = (at(*a), at(*b));
    let up = (sides[0].0 + sides[1].0).normalize();
    let across = up.cross(q - p).normalize();
    let size = p.distance(q).min(0.05 * truth.diagonal) * 0.5;
    let middle = p.lerp(q, 0.5);
    let corners = vec![p, q, middle + (up + across * 0.5) * size, middle + (up - across * 0.5) * size];
    let mut other =
        crate::shapes::pool(corners, vec![vec![0, 1, 2], vec![1, 0, 3], vec![2, 1, 3], vec![0, 2, 3]]);
    if Mesh::build(&other).expect("a manifold").closed().expect("closed").volume() < 0.0 {
        other = other.reversed();
    }
    glued(truth, &other, |r| r == p || r == q)
}

/// Both shapes in one soup; vertices of the second that lie where one of the first is, and are shared, are named by both.
fn glued(truth: &Truth, other: &IndexedMesh, is_shared: impl Fn(DVec3) -> bool) -> (Truth, PolygonSoup) {
    let whole = crate::shapes::both(&truth.pool, other);
    let mut soup = soup(&whole);
    let own = truth.pool.vertex_count() as u32;
    let shared: Vec<u32> = (0..own).filter(|&v| is_shared(whole.positions()[v as usize])).collect();
    let twin = |v: u32| {
        let p = whole.positions()[v as usize];
        let near = |&u: &u32| whole.positions()[u as usize].distance(p) < 1e-9 * truth.diagonal;
        if v < own || !is_shared(p) { v } else { shared.iter().copied().find(near).unwrap_or(v) }
    };
    soup.polygons.map_corners(twin);
    (Truth::new(truth.name, whole), soup)
}

/// The shape and a copy that it crosses.
pub(crate) fn overlapping(truth: &Truth) -> PolygonSoup {
    let mut other = truth.pool.clone();
    let bounds = other.bounds().expect("points");
    let by = (bounds.max - bounds.min) * dvec3(0.131, 0.173, 0.291);
    other.map_positions(|p| p + by).expect("finite");
    soup(&crate::shapes::both(&truth.pool, &other))
}

/// The shape with something beside it that cannot become a solid.
pub(crate) fn beside(truth: &Truth, other: &IndexedMesh) -> PolygonSoup {
    let mut other = other.clone();
    other.map_positions(|p| p + DVec3::splat(3.0 * truth.diagonal)).expect("finite");
    soup(&crate::shapes::both(&truth.pool, &other))
}

pub(crate) fn hopeless() -> [(&'static str, IndexedMesh); 2] {
    [("a Moebius strip", moebius(24)), ("a sheet", sheet_of_quads(6))]
}
