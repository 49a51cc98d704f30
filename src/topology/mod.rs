//! How faces meet: facts with witnesses on the indexed form, where they can fail; loops, components and winding on the
//! mesh.

mod duplicates;
mod fans;
mod loops;
mod mesh;
mod orient;
mod union_find;

pub use loops::NakedEdges;
pub use orient::{NotOrientable, UnifyWithError, unify_winding, unify_winding_with};

pub(crate) use duplicates::{Cycle, duplicate_faces};
pub(crate) use fans::fan_roots;
pub(crate) use orient::{flip_faces, orient, with_flipped};
pub(crate) use union_find::UnionFind;

use crate::matching::Matching;
use crate::{IndexedMesh, Polygons};

/// How the faces of an [`IndexedMesh`] meet. Made by [`IndexedMesh::topology`]; every question may be asked of any
/// valid vertex pool, and every "no" comes with its witnesses.
///
/// # Examples
/// ```
/// use meshwright::{IndexedMesh, glam::DVec3};
/// // Three triangles on one edge.
/// let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_Y];
/// let fins = IndexedMesh::from_triangles(points, &[[0, 1, 2], [0, 1, 3], [1, 0, 4]])?;
/// let topology = fins.topology();
/// let edge = topology.nonmanifold_edges().next().unwrap();
/// assert_eq!(edge.vertices(), [0, 1]);
/// assert_eq!(edge.faces().collect::<Vec<_>>(), [0, 1, 2]);
/// assert!(!topology.is_closed());
/// # Ok::<(), meshwright::IndexedError>(())
/// ```
#[derive(Debug)]
pub struct Topology<'m> {
    pub(crate) mesh: &'m IndexedMesh,
    pub(crate) matching: Matching,
    pub(crate) face_of: FaceOf,
}

impl IndexedMesh {
    /// Matches the edges, and so makes all topology facts ready to be asked. O(corners).
    pub fn topology(&self) -> Topology<'_> {
        Topology::with_matching(self, Matching::new(self.vertex_count(), self.polygons()))
    }
}

/// An edge of an indexed mesh with its faces.
#[derive(Clone, Copy, Debug)]
pub struct EdgeRef<'t> {
    topology: &'t Topology<'t>,
    edge: usize,
}

impl<'t> EdgeRef<'t> {
    /// The two vertices, the lower index first.
    pub fn vertices(&self) -> [u32; 2] {
        let [a, b] = self.direction();
        [a.min(b), a.max(b)]
    }

    /// The two vertices as the first of the edge's faces runs along it.
    pub fn direction(&self) -> [u32; 2] {
        self.topology.corner_edge(self.topology.matching.edges[self.edge].first())
    }

    /// The faces at the edge, ascending.
    pub fn faces(&self) -> impl Iterator<Item = u32> + Clone + use<'t> {
        let topology = self.topology;
        topology.matching.uses(self.edge).map(|c| topology.face_of.face(c))
    }
}

impl<'m> Topology<'m> {
    pub(crate) fn with_matching(mesh: &'m IndexedMesh, matching: Matching) -> Self {
        Self { mesh, matching, face_of: FaceOf::new(mesh.polygons()) }
    }

    /// The half-edge of a corner, as the vertices it runs from and to.
    fn corner_edge(&self, corner: usize) -> [u32; 2] {
        let polygons = self.mesh.polygons();
        let next = next_corner(polygons, self.face_of.face(corner), corner);
        [polygons.corners()[corner], polygons.corners()[next]]
    }

    fn edge(&self, edge: usize) -> EdgeRef<'_> {
        EdgeRef { topology: self, edge }
    }

    /// The mesh the facts are about.
    pub fn mesh(&self) -> &'m IndexedMesh {
        self.mesh
    }

    /// The number of edges.
    pub fn edge_count(&self) -> usize {
        self.matching.edges.len()
    }

    /// All edges, in the order in which corners first use them (those at hub vertices last).
    pub fn edges(&self) -> impl Iterator<Item = EdgeRef<'_>> + '_ {
        (0..self.edge_count()).map(|e| self.edge(e))
    }

    /// The naked edges: those with exactly one face.
    pub fn boundary_edges(&self) -> impl Iterator<Item = EdgeRef<'_>> + '_ {
        let open = |e: &usize| self.matching.edges[*e].second().is_none();
        (0..self.edge_count()).filter(open).map(|e| self.edge(e))
    }

    /// The edges with three or more faces.
    pub fn nonmanifold_edges(&self) -> impl Iterator<Item = EdgeRef<'_>> + '_ {
        self.matching.nonmanifold_edges().map(|e| self.edge(e))
    }

    /// The edges with exactly two faces, both of which run the same way along it: their windings conflict.
    pub fn conflicting_edges(&self) -> impl Iterator<Item = EdgeRef<'_>> + '_ {
        let count = if self.matching.any_conflict { self.edge_count() } else { 0 };
        let conflict = |e: &usize| self.matching.edges[*e].is_conflict() && !self.matching.is_nonmanifold(*e);
        (0..count).filter(conflict).map(|e| self.edge(e))
    }

    /// The pinched vertices, ascending: those whose faces fall into several fans that share no edge, each with the
    /// number of its fans. O(corners).
    pub fn pinched_vertices(&self) -> Vec<(u32, u32)> {
        fans::pinched_vertices(self)
    }

    /// Faces with the same corner cycle as an earlier face, in either direction: `(face, earliest such face)`,
    /// ascending. O(corners), with a sort of the faces that share their lowest edge.
    pub fn duplicate_faces(&self) -> Vec<(u32, u32)> {
        duplicates::duplicate_faces(self.mesh.polygons(), &self.matching)
    }

    /// Vertices that no face names, ascending. O(corners).
    pub fn isolated_vertices(&self) -> Vec<u32> {
        let mut used = vec![false; self.mesh.vertex_count()];
        for &v in self.mesh.polygons().corners() {
            used[v as usize] = true;
        }
        (0..used.len() as u32).filter(|&v| !used[v as usize]).collect()
    }

    /// Whether there is a face and every edge has exactly two. Says nothing about winding or pinches.
    pub fn is_closed(&self) -> bool {
        self.edge_count() > 0
            && self.matching.more.is_empty()
            && self.matching.edges.iter().all(|e| e.second().is_some())
    }

    /// Whether no edge has more than two faces.
    pub fn is_edge_manifold(&self) -> bool {
        self.matching.more.is_empty()
    }

    /// Whether no vertex is pinched. Isolated vertices are not pinched.
    pub fn is_vertex_manifold(&self) -> bool {
        self.pinched_vertices().is_empty()
    }

    /// Whether the two faces at every two-face edge are wound alike. Edges with more faces say nothing.
    pub fn is_oriented(&self) -> bool {
        self.conflicting_edges().next().is_none()
    }

    /// Whether reversing faces could make the winding agree at every two-face edge. O(corners).
    ///
    /// # Errors
    /// [`NotOrientable`] with a cycle of faces for each part that cannot be oriented.
    pub fn orientable(&self) -> Result<(), NotOrientable> {
        if !self.matching.any_conflict {
            return Ok(());
        }
        let found = orient(self.mesh.polygons(), &self.face_of, &self.matching.mates());
        if found.cycles.is_empty() { Ok(()) } else { Err(NotOrientable { cycles: found.cycles }) }
    }

    /// The component of each face, joined across edges of any number of faces; numbered in the order of their first
    /// faces. Returns the labels and their number. O(corners).
    pub fn components(&self) -> (Vec<u32>, usize) {
        let mut sets = UnionFind::new(self.mesh.face_count());
        for e in 0..self.edge_count() {
            let mut uses = self.matching.uses(e).map(|c| self.face_of.face(c));
            if let Some(first) = uses.next() {
                uses.for_each(|f| sets.join(first, f));
            }
        }
        sets.labels()
    }

    /// Vertices that faces name, less edges, plus faces.
    pub fn euler_characteristic(&self) -> i64 {
        let used = self.mesh.vertex_count() - self.isolated_vertices().len();
        used as i64 - self.edge_count() as i64 + self.mesh.face_count() as i64
    }

    /// The number of handles of a closed, orientable surface of one component without pinches; `None` for any other.
    pub fn genus(&self) -> Option<u64> {
        let surface = self.is_closed()
            && self.components().1 == 1
            && self.is_vertex_manifold()
            && self.orientable().is_ok();
        surface.then(|| ((2 - self.euler_characteristic()) / 2).unsigned_abs())
    }

    /// The naked edges as oriented loops, and as chains where they end at edges with three or more faces. O(corners).
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, NormalWeight, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let pool = IndexedMesh::from_triangles(points, &[[0, 1, 2]])?;
    /// # let mut mesh = Mesh::build(&pool)?;
    /// assert_eq!(pool.topology().naked_edges().loops, [vec![1, 0, 2]]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn naked_edges(&self) -> NakedEdges {
        loops::naked_edges(self)
    }

    /// The number of connected pieces of the boundary: naked edges joined at shared vertices. O(vertices).
    pub fn boundary_pieces(&self) -> usize {
        let mut sets = UnionFind::new(self.mesh.vertex_count());
        let mut ends = 0;
        for [a, b] in self.boundary_edges().map(|e| e.vertices()) {
            ends += usize::from(sets.is_single(a)) + usize::from(sets.is_single(b));
            sets.join(a, b);
        }
        // Every join of two sets makes one piece fewer than there are vertices on the boundary.
        ends - sets.joins()
    }
}

/// From a corner to its face: a division where all faces have one degree, a column otherwise.
#[derive(Clone, Debug)]
pub(crate) enum FaceOf {
    Uniform(u32),
    Listed(Vec<u32>),
}

impl FaceOf {
    pub(crate) fn new(polygons: &Polygons) -> Self {
        let degree = polygons.iter().next().map_or(3, <[u32]>::len);
        if degree > 0 && polygons.iter().all(|p| p.len() == degree) {
            return Self::Uniform(degree as u32);
        }
        let mut listed = Vec::with_capacity(polygons.corners().len());
        for (f, p) in polygons.iter().enumerate() {
            listed.resize(listed.len() + p.len(), f as u32);
        }
        Self::Listed(listed)
    }

    pub(crate) fn face(&self, corner: usize) -> u32 {
        match self {
            Self::Uniform(degree) => corner as u32 / degree,
            Self::Listed(listed) => listed[corner],
        }
    }
}

/// The corner after `corner` in its face.
pub(crate) fn next_corner(polygons: &Polygons, face: u32, corner: usize) -> usize {
    let starts = polygons.starts();
    if corner + 1 == starts[face as usize + 1] { starts[face as usize] } else { corner + 1 }
}

/// The corner before `corner` in its face.
pub(crate) fn prev_corner(polygons: &Polygons, face: u32, corner: usize) -> usize {
    let starts = polygons.starts();
    if corner == starts[face as usize] { starts[face as usize + 1] - 1 } else { corner - 1 }
}
