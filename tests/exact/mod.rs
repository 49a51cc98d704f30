//! Rational geometry in 128-bit integers, for small coordinates: nothing is rounded, and nothing is shared with the library
//! but its rule for cutting polygons.

#![allow(dead_code, reason = "each test takes what it needs")]

#[path = "lines.rs"]
pub(crate) mod lines;

use meshwright::glam::DVec3;
use meshwright::{IndexedMesh, Mesh};

/// A point or a vector with a positive denominator.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point {
    pub(crate) n: [i128; 3],
    pub(crate) d: i128,
}

impl Point {
    /// Quarters at the finest.
    pub(crate) fn new(p: DVec3) -> Self {
        let quarters = p * 4.0;
        assert!(quarters == quarters.round() && quarters.abs().max_element() < 1e4, "{p}");
        Self { n: quarters.to_array().map(|x| x as i128), d: 4 }.reduced()
    }

    fn reduced(self) -> Self {
        if self.d < 1 << 20 && self.n.iter().all(|x| x.abs() < 1 << 20) {
            return self;
        }
        let divisor = self.n.into_iter().fold(self.d, gcd);
        Self { n: self.n.map(|x| x / divisor), d: self.d / divisor }
    }

    pub(crate) fn minus(self, o: Self) -> Self {
        Self { n: [0, 1, 2].map(|i| self.n[i] * o.d - o.n[i] * self.d), d: self.d * o.d }.reduced()
    }

    /// `self + v * (above / below)`.
    pub(crate) fn plus(self, v: Self, above: i128, below: i128) -> Self {
        let sign = below.signum();
        let (above, below) = (above * sign, below * sign * v.d);
        Self { n: [0, 1, 2].map(|i| self.n[i] * below + v.n[i] * above * self.d), d: self.d * below }
            .reduced()
    }

    pub(crate) fn cross(self, o: Self) -> Self {
        let (a, b) = (self.n, o.n);
        let at = |i: usize| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
        Self { n: [at(0), at(1), at(2)], d: self.d * o.d }.reduced()
    }

    /// The scalar product's numerator; its denominator is `self.d * o.d`.
    pub(crate) fn dot(self, o: Self) -> i128 {
        (0..3).map(|i| self.n[i] * o.n[i]).sum()
    }

    pub(crate) fn is_zero(self) -> bool {
        self.n == [0; 3]
    }

    pub(crate) fn place(self) -> DVec3 {
        DVec3::from(self.n.map(|x| x as f64 / self.d as f64))
    }
}

impl PartialEq for Point {
    fn eq(&self, o: &Self) -> bool {
        self.minus(*o).is_zero()
    }
}

fn gcd(a: i128, b: i128) -> i128 {
    let (mut a, mut b) = (a.abs(), b.abs());
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a.max(1)
}

/// A triangle of a face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    pub(crate) face: usize,
    pub(crate) vertices: [u32; 3],
    pub(crate) at: [Point; 3],
    /// Whether what leads from a corner to the next is an edge of the face, and no cut within it.
    pub(crate) is_side: [bool; 3],
    /// The same, where a cut beside a triangle without area counts as an edge.
    pub(crate) is_edge: [bool; 3],
}

impl Triangle {
    pub(crate) fn normal(&self) -> Point {
        let [a, b, c] = self.at;
        b.minus(a).cross(c.minus(a))
    }

    pub(crate) fn has_area(&self) -> bool {
        !self.normal().is_zero()
    }

    pub(crate) fn edge(&self, i: usize) -> [Point; 2] {
        [self.at[i], self.at[(i + 1) % 3]]
    }

    pub(crate) fn contains(&self, x: Point) -> bool {
        let n = self.normal();
        if n.is_zero() {
            return (0..3).any(|i| is_on(x, self.edge(i)));
        }
        let inward = |i: usize| {
            let [a, b] = self.edge(i);
            n.dot(b.minus(a).cross(x.minus(a)))
        };
        n.dot(x.minus(self.at[0])) == 0 && (0..3).all(|i| inward(i) >= 0)
    }

    /// Whether a point of the triangle is on no edge of its face, nor a corner.
    pub(crate) fn is_inside(&self, x: Point) -> bool {
        !self.at.contains(&x) && (0..3).all(|i| !self.is_edge[i] || !is_on(x, self.edge(i)))
    }
}

/// Whether a point is on a segment.
pub(crate) fn is_on(x: Point, [a, b]: [Point; 2]) -> bool {
    x.minus(a).cross(b.minus(a)).is_zero() && a.minus(x).dot(b.minus(x)) <= 0
}

/// The triangles of every face of a mesh, in order of faces.
pub(crate) fn triangles(mesh: &Mesh) -> Vec<Triangle> {
    let pool = mesh.to_indexed();
    let mut all = Vec::new();
    for (face, corners) in pool.polygons().iter().enumerate() {
        let alone =
            IndexedMesh::new(pool.positions().to_vec(), vec![corners.to_vec()].into()).expect("a face");
        let mut alone = Mesh::build(&alone).expect("one face");
        let vertices: Vec<_> = alone.vertices().collect();
        let only = alone.faces().next().expect("a face");
        alone.triangulate_face(only).expect("nothing is in the way");
        let mut own = Vec::new();
        for f in alone.faces() {
            let number = |v| vertices.iter().position(|&w| w == v).expect("of the mesh") as u32;
            let t: Vec<u32> = alone.face_vertices(f).map(number).collect();
            let t = [t[0], t[1], t[2]];
            let next = |v: u32| {
                let i = corners.iter().position(|&w| w == v).expect("a corner");
                corners[(i + 1) % corners.len()]
            };
            let is_edge = [0, 1, 2].map(|i| next(t[i]) == t[(i + 1) % 3]);
            let at = t.map(|v| Point::new(pool.positions()[v as usize]));
            own.push(Triangle { face, vertices: t, at, is_side: is_edge, is_edge });
        }
        let flat: Vec<[u32; 3]> = own.iter().filter(|t| !t.has_area()).map(|t| t.vertices).collect();
        for t in &mut own {
            for i in 0..3 {
                let (a, b) = (t.vertices[i], t.vertices[(i + 1) % 3]);
                let beside = |f: &[u32; 3]| (0..3).any(|j| (f[(j + 1) % 3], f[j]) == (a, b));
                t.is_edge[i] |= !t.has_area() || flat.iter().any(beside);
            }
        }
        all.extend(own);
    }
    all
}

/// Where the plane of a triangle with area meets a segment that is not in or beside it.
fn through(t: &Triangle, [p, q]: [Point; 2]) -> Option<Point> {
    let n = t.normal();
    let height = |x: Point| (n.dot(x.minus(t.at[0])), x.minus(t.at[0]).d);
    let ((a, of_a), (b, of_b)) = (height(p), height(q));
    let (a, b) = (a * of_b, b * of_a);
    ((a > 0 && b < 0) || (a < 0 && b > 0)).then(|| p.plus(q.minus(p), a, a - b))
}

/// The one point of two segments that are not parallel.
fn crossing([a, b]: [Point; 2], [c, d]: [Point; 2]) -> Option<Point> {
    let (u, v, w) = (b.minus(a), d.minus(c), c.minus(a));
    let n = u.cross(v);
    if n.is_zero() || n.dot(w) != 0 {
        return None;
    }
    // s = (w x v) . n / n . n, with the denominators of u, v and w.
    let (m, of_m) = (w.cross(v), n);
    let x = a.plus(u, m.dot(of_m) * n.d, m.d * n.dot(n));
    (is_on(x, [a, b]) && is_on(x, [c, d])).then_some(x)
}

/// How two triangles meet in more than edges: 0 a touch, 1 a crossing, 2 an overlap.
pub(crate) fn meet(s: &Triangle, t: &Triangle) -> Option<u8> {
    let mut points: Vec<Point> = Vec::new();
    points.extend(s.at.iter().filter(|&&x| t.contains(x)));
    points.extend(t.at.iter().filter(|&&x| s.contains(x)));
    for (a, b) in [(s, t), (t, s)] {
        for i in 0..3 {
            points.extend(through(b, a.edge(i)).filter(|&x| b.has_area() && b.contains(x)));
        }
    }
    for i in 0..3 {
        for j in 0..3 {
            points.extend(crossing(s.edge(i), t.edge(j)));
        }
    }
    let first = *points.first()?;
    let last = points.iter().copied().max_by(|&p, &q| {
        let (p, q) = (p.minus(first), q.minus(first));
        (p.dot(p) * q.d * q.d).cmp(&(q.dot(q) * p.d * p.d))
    })?;
    if points.iter().any(|p| !p.minus(first).cross(last.minus(first)).is_zero()) {
        return Some(2);
    }
    // The other end, farthest from the one.
    let other = points.iter().copied().max_by(|&p, &q| {
        let (p, q) = (p.minus(last), q.minus(last));
        (p.dot(p) * q.d * q.d).cmp(&(q.dot(q) * p.d * p.d))
    })?;
    let middle = last.plus(other.minus(last), 1, 2);
    let inside = [last, middle, other].map(|x| (s.is_inside(x), t.is_inside(x)));
    if inside.contains(&(true, true)) { Some(1) } else { inside.iter().any(|i| i.0 || i.1).then_some(0) }
}

/// All pairs of faces that meet in more than edges, by all pairs of triangles: faces and the strongest contact.
pub(crate) fn self_intersections(all: &[Triangle]) -> Vec<([usize; 2], u8)> {
    let mut found = Vec::new();
    for (i, s) in all.iter().enumerate() {
        for t in all[i + 1..].iter().filter(|t| t.face != s.face) {
            found.extend(meet(s, t).map(|contact| ([s.face.min(t.face), s.face.max(t.face)], contact)));
        }
    }
    found.sort_by(|a, b| a.0.cmp(&b.0).then(b.1.cmp(&a.1)));
    found.dedup_by_key(|f| f.0);
    found
}
