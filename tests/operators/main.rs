//! Each operator by name: what it does on a named shape, and each of its refusals.

#[path = "../shapes/mod.rs"]
mod shapes;

mod add;
mod collapse;
mod dissolve;
mod fill;
mod flip;
mod hub;
mod join;
mod poke;
mod remove;
mod reverse;
mod split_edge;
mod split_face;
mod split_vertex;
mod stitch;
mod triangulate;

use meshwright::glam::{DVec3, dvec3};
use meshwright::{CollapseError, EdgeKey, FaceKey, HalfedgeKey, IndexedMesh, Mesh, Numbering, VertexKey};

/// A mesh with the numbers its elements were built under.
struct Subject {
    mesh: Mesh,
    names: Numbering,
}

fn subject(pool: &IndexedMesh) -> Subject {
    let mesh = shapes::mesh(pool);
    let names = mesh.numbering();
    Subject { mesh, names }
}

/// Faces between vertices on a circle; where they lie plays no part.
fn faces(vertices: u32, faces: &[&[u32]]) -> Subject {
    let at = |i: u32| {
        let (y, x) = (f64::from(i) / f64::from(vertices) * std::f64::consts::TAU).sin_cos();
        dvec3(x, y, 0.01 * f64::from(i * i))
    };
    subject(&shapes::pool((0..vertices).map(at).collect(), faces.iter().map(|f| f.to_vec()).collect()))
}

/// A hub, vertex 0, with `n` triangles around it.
fn hub(n: u32) -> Subject {
    let triangles: Vec<[u32; 3]> = (0..n).map(|i| [0, 1 + i, 1 + (i + 1) % n]).collect();
    faces(n + 1, &triangles.iter().map(|t| t.as_slice()).collect::<Vec<_>>())
}

/// `n` by `n` unit squares; vertex `y * (n + 1) + x` lies at `(x, y)`.
fn squares(n: u32) -> Subject {
    let w = n + 1;
    let points = (0..w * w).map(|i| dvec3(f64::from(i % w), f64::from(i / w), 0.0)).collect();
    let square = |i: u32| {
        let a = i / n * w + i % n;
        vec![a, a + 1, a + w + 1, a + w]
    };
    subject(&shapes::pool(points, (0..n * n).map(square).collect()))
}

/// Two triangles that share the edge 1-2.
fn hinge() -> Subject {
    let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, dvec3(1., 1., 0.)];
    subject(&shapes::pool(points, vec![vec![0, 1, 2], vec![2, 1, 3]]))
}

/// A sphere of three faces whose edge 0-1 has no common neighbour of its ends but is not the only place where they meet.
fn three_faced_sphere() -> Subject {
    faces(6, &[&[0, 1, 3, 2], &[1, 0, 5, 4], &[0, 2, 3, 1, 4, 5]])
}

impl Subject {
    fn v(&self, i: usize) -> VertexKey {
        self.names.vertices[i]
    }

    fn f(&self, i: usize) -> FaceKey {
        self.names.faces[i]
    }

    fn h(&self, a: usize, b: usize) -> HalfedgeKey {
        self.mesh.find_halfedge(self.v(a), self.v(b)).expect("an edge")
    }

    fn e(&self, a: usize, b: usize) -> EdgeKey {
        self.mesh.edge(self.h(a, b))
    }

    /// The number of a vertex: its first one, and after those that were built, the order of birth.
    fn number(&self, v: VertexKey) -> usize {
        let built = self.names.vertices.iter().position(|&n| n == v);
        built.unwrap_or_else(|| {
            let born =
                self.mesh.numbering().vertices.into_iter().filter(|v| !self.names.vertices.contains(v));
            self.names.vertices.len() + born.into_iter().position(|n| n == v).expect("a live vertex")
        })
    }

    /// The corners of a face by number, from the first on.
    fn corners(&self, f: FaceKey) -> Vec<usize> {
        self.mesh.face_vertices(f).map(|v| self.number(v)).collect()
    }

    /// Vertices, edges and faces.
    fn counts(&self) -> [usize; 3] {
        [self.mesh.vertex_count(), self.mesh.edge_count(), self.mesh.face_count()]
    }

    fn vertex(&mut self, position: DVec3) -> VertexKey {
        self.mesh.add_vertex(position).expect("a finite position")
    }
}

/// Everything that can be asked of a mesh, to see that nothing changed.
fn state(mesh: &Mesh) -> impl PartialEq + std::fmt::Debug + use<> {
    let links: Vec<_> =
        mesh.halfedges().map(|h| (h, mesh.next(h), mesh.prev(h), mesh.origin(h), mesh.face(h))).collect();
    let vertices: Vec<_> =
        mesh.vertices().map(|v| (v, mesh.position(v).to_array(), mesh.vertex_halfedge(v))).collect();
    let firsts: Vec<_> = mesh.faces().map(|f| (f, mesh.face_halfedge(f))).collect();
    (links, vertices, firsts, mesh.numbering())
}

/// The operator is refused with an error that fits, by its check as by itself, and changes nothing.
macro_rules! refuses {
    ($subject:expr, $op:ident, $check:ident($($arg:expr),*), $error:pat $(if $guard:expr)?) => {{
        let before = crate::state(&$subject.mesh);
        let check = $subject.mesh.$check($($arg),*);
        assert!(matches!(check, Err($error) $(if $guard)?), "the check says {check:?}");
        let done = $subject.mesh.$op($($arg),*).map(|_| ());
        assert!(matches!(done, Err($error) $(if $guard)?), "the operator says {done:?}");
        assert!(crate::state(&$subject.mesh) == before, "something changed");
    }};
}

/// The check agrees, the operator is done, and a valid mesh is left.
macro_rules! does {
    ($subject:expr, $op:ident, $check:ident($($arg:expr),*)) => {{
        assert_eq!($subject.mesh.$check($($arg),*), Ok(()));
        let done = $subject.mesh.$op($($arg),*).expect("the check said so");
        $subject.mesh.validate().expect("valid");
        done
    }};
}

pub(crate) use {does, refuses};
