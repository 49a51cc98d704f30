//! [`IndexedMesh`] to [`Mesh`] and back.

use crate::arena::Arena;
use crate::indexed::list;
use crate::matching::{Chains, NONE, Pairing};
use crate::topology::Topology;
use crate::{Cancelled, Control, IndexedMesh, Mesh, Polygons};
use glam::DVec3;
use std::fmt;

/// Why faces do not form an oriented manifold: every defect, in the order of [`BuildDefect`]'s variants, then of
/// elements.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct BuildError {
    /// What is wrong and where; never empty.
    pub defects: Vec<BuildDefect>,
}

/// Why a mesh was not built under a hook.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildWithError {
    /// The faces do not form an oriented manifold.
    #[error(transparent)]
    Refused(#[from] BuildError),
    /// The hook said stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl fmt::Display for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        list(f, "not an oriented manifold", &self.defects)
    }
}

/// One reason why faces do not form an oriented manifold.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum BuildDefect {
    /// Three or more faces share an edge.
    #[error("edge {}-{} has {} faces", edge[0], edge[1], faces.len())]
    NonManifoldEdge {
        /// The edge's vertices, the lower first.
        edge: [u32; 2],
        /// Its faces, ascending.
        faces: Vec<u32>,
    },
    /// The two faces at an edge run the same way along it: one of them is wound the wrong way.
    #[error("faces {} and {} run the same way along edge {}-{}", faces[0], faces[1], edge[0], edge[1])]
    ConflictingEdge {
        /// The edge's vertices, the lower first.
        edge: [u32; 2],
        /// Its two faces.
        faces: [u32; 2],
    },
    /// The faces around a vertex fall into several fans that share no edge.
    #[error("the faces at vertex {vertex} form {fans} fans")]
    PinchedVertex {
        /// The vertex.
        vertex: u32,
        /// How many fans.
        fans: u32,
    },
    /// A face has the same corner cycle as another, in either direction.
    #[error("face {face} has the corners of face {original}")]
    DuplicateFace {
        /// The later face.
        face: u32,
        /// The face it repeats.
        original: u32,
    },
}

impl Mesh {
    /// Builds the half-edge mesh of a vertex pool.
    ///
    /// The `i`-th of [`vertices`](Mesh::vertices) is vertex `i`, the `i`-th of [`faces`](Mesh::faces) is face `i`, and
    /// each face keeps its first corner: [`to_indexed`](Mesh::to_indexed) gives back an equal pool. All
    /// attributes come along. O(corners).
    ///
    /// # Errors
    /// [`BuildError`] with every defect when the faces do not form an oriented manifold.
    ///
    /// # Examples
    /// ```
    /// use meshwright::{BuildDefect, IndexedMesh, Mesh, glam::DVec3};
    /// // The second triangle is wound the wrong way.
    /// let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X + DVec3::Y];
    /// let pool = IndexedMesh::from_triangles(points, &[[0, 1, 2], [1, 2, 3]])?;
    /// let refusal = Mesh::build(&pool).unwrap_err();
    /// assert_eq!(refusal.defects, [BuildDefect::ConflictingEdge { edge: [1, 2], faces: [0, 1] }]);
    /// # Ok::<(), meshwright::IndexedError>(())
    /// ```
    pub fn build(pool: &IndexedMesh) -> Result<Self, BuildError> {
        build_by(pool, |_, _| Ok(()))
    }

    /// As [`build`](Self::build), with a progress-and-cancel hook.
    ///
    /// # Errors
    /// [`BuildWithError`]: as [`build`](Self::build); when cancelled.
    ///
    /// # Examples
    /// ```
    /// use meshwright::{BuildWithError, Control, IndexedMesh, Mesh, Progress, glam::DVec3};
    /// use std::ops::ControlFlow;
    /// let pool = IndexedMesh::from_triangles(vec![DVec3::ZERO, DVec3::X, DVec3::Y], &[[0, 1, 2]])?;
    /// let mut stop = |p: Progress| if p.fraction > 0.3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    /// assert!(matches!(Mesh::build_with(&pool, Control::new(&mut stop)), Err(BuildWithError::Cancelled(_))));
    /// # Ok::<(), meshwright::IndexedError>(())
    /// ```
    pub fn build_with(pool: &IndexedMesh, mut control: Control<'_>) -> Result<Self, BuildWithError> {
        build_by(pool, |stage, fraction| Ok(control.report(stage, fraction)?))
    }

    /// The vertex pool of the mesh, in the order of the input for what survived, with each face's first corner kept.
    /// Carried attributes come along; user columns are [exported](Self::export_column) apart. O(slots).
    pub fn to_indexed(&self) -> IndexedMesh {
        let order = self.vertices.in_user_order();
        let mut number = vec![0u32; self.vertices.slot_count()];
        for (i, &v) in order.iter().enumerate() {
            number[v as usize] = i as u32;
        }
        let mut polygons = Polygons::with_capacity(self.face_count(), 3 * self.face_count());
        self.for_each_in_user_order(|f| {
            let corners = self.loop_slots(self.face_halfedge[f as usize]);
            polygons.push(corners.map(|h| number[self.origin[h as usize] as usize]));
        });
        let positions = order.iter().map(|&v| self.positions[v as usize]).collect();
        IndexedMesh::trusted(positions, polygons, None).carrying(self.ordered_attributes(&order))
    }
}

fn build_by<E: From<BuildError>>(
    pool: &IndexedMesh,
    mut report: impl FnMut(&'static str, f64) -> Result<(), E>,
) -> Result<Mesh, E> {
    report("match edges", 0.0)?;
    let chains = Chains::new(pool.vertex_count(), pool.polygons());
    report("link", 0.4)?;
    if chains.is_paired()
        && let Some(mesh) = lay_out(pool, &chains.into_pairing())
    {
        report("walk fans", 0.7)?;
        if each_vertex_has_one_fan(&mesh) {
            return Ok(mesh);
        }
    }
    report("find defects", 0.8)?;
    // Only a refusal needs the edges again.
    Err(BuildError { defects: defects(&pool.topology()) }.into())
}

impl TryFrom<&IndexedMesh> for Mesh {
    type Error = BuildError;

    /// [`Mesh::build`].
    fn try_from(pool: &IndexedMesh) -> Result<Self, BuildError> {
        Self::build(pool)
    }
}

impl From<&Mesh> for IndexedMesh {
    /// [`Mesh::to_indexed`].
    fn from(mesh: &Mesh) -> Self {
        mesh.to_indexed()
    }
}

/// Lays out the mesh of a pairing without conflicts and 3+ edges; `None` if a vertex is pinched or a face is there
/// twice.
pub(crate) fn assemble(pool: &IndexedMesh, pairing: &Pairing) -> Option<Mesh> {
    lay_out(pool, pairing).filter(each_vertex_has_one_fan)
}

/// The same for faces that are known to have neither pinches nor repeats.
pub(crate) fn lay_out(pool: &IndexedMesh, pairing: &Pairing) -> Option<Mesh> {
    let polygons = pool.polygons();
    let mut linking = Linking::new(pool.vertex_count(), pairing.edges, pool.face_count());
    let mut uses = pairing.use_of.as_slice();
    for corners in polygons.iter() {
        let (own, rest) = uses.split_at(corners.len());
        uses = rest;
        linking.face(corners, own);
    }
    let mut mesh = linking.finish(shifted(pool.positions()), &pairing.open)?;
    mesh.adopt(pool.attributes(), |corner| pairing.use_of[corner] + 2);
    Some(mesh)
}

/// A mesh that is being laid out, face by face. Slot 0 of every column is slotmap's sentinel, so index `i` lives in slot
/// `i + 1`, and the first use of edge `e` in half-edge `2 * e + 2`.
pub(crate) struct Linking {
    mesh: Mesh,
}

impl Linking {
    pub(crate) fn new(vertices: usize, edges: usize, faces: usize) -> Self {
        let halfedges = 2 * (edges + 1);
        let mut mesh = Mesh {
            vertices: Arena::filled(vertices),
            edges: Arena::filled(edges),
            faces: Arena::filled(faces),
            // Every entry that means anything is written later, so that no memory is touched twice.
            next: vec![0; halfedges],
            prev: vec![0; halfedges],
            origin: vec![0; halfedges],
            face: vec![0; halfedges],
            vertex_halfedge: vec![NONE; vertices + 1],
            face_halfedge: Vec::with_capacity(faces + 1),
            ..Mesh::default()
        };
        mesh.face_halfedge.push(NONE);
        mesh.face[..2].fill(NONE);
        Self { mesh }
    }

    /// The next face: its vertices, and for each corner twice its edge, plus one unless it is the edge's first use.
    #[inline(always)]
    pub(crate) fn face(&mut self, corners: &[u32], uses: &[u32]) {
        let mesh = &mut self.mesh;
        let f = mesh.face_halfedge.len() as u32;
        let mut before = uses[uses.len() - 1] + 2;
        mesh.face_halfedge.push(uses[0] + 2);
        for (&v, &u) in corners.iter().zip(uses) {
            let h = u + 2;
            mesh.next[before as usize] = h;
            mesh.prev[h as usize] = before;
            mesh.origin[h as usize] = v + 1;
            mesh.face[h as usize] = f;
            mesh.vertex_halfedge[v as usize + 1] = h;
            before = h;
        }
    }

    /// The mesh, given positions by slot and the edges with one use; `None` if a vertex is pinched at the boundary.
    pub(crate) fn finish(mut self, positions: Vec<DVec3>, open: &[u32]) -> Option<Mesh> {
        self.mesh.positions = positions;
        link_boundary(&mut self.mesh, open).then_some(self.mesh)
    }
}

fn shifted(values: &[DVec3]) -> Vec<DVec3> {
    let mut column = Vec::with_capacity(values.len() + 1);
    column.push(DVec3::ZERO);
    column.extend_from_slice(values);
    column
}

/// Links the half-edges without a face into loops; `false` if two of them leave one vertex.
fn link_boundary(mesh: &mut Mesh, open: &[u32]) -> bool {
    // The first use of an edge is its even half-edge, so the boundary half-edge is the odd one.
    let boundary = || open.iter().map(|&e| 2 * e as usize + 3);
    for h in boundary() {
        let v = mesh.origin[mesh.next[h ^ 1] as usize];
        mesh.origin[h] = v;
        mesh.face[h] = NONE;
        let out = &mut mesh.vertex_halfedge[v as usize];
        if mesh.face[*out as usize] == NONE {
            return false;
        }
        *out = h as u32;
    }
    for h in boundary() {
        let next = mesh.vertex_halfedge[mesh.origin[h ^ 1] as usize];
        mesh.next[h] = next;
        mesh.prev[next as usize] = h as u32;
    }
    true
}

/// Whether the fans reached from the vertices hold all half-edges, and no two faces close each other off.
///
/// Two faces with one corner cycle in opposite directions share all their edges, so each of their vertices has just
/// two edges: the walk that counts half-edges meets them on its way.
fn each_vertex_has_one_fan(mesh: &Mesh) -> bool {
    let mut reached = 0;
    for v in 1..mesh.vertex_halfedge.len() {
        let first = mesh.vertex_halfedge[v];
        if first == NONE {
            continue;
        }
        let mut h = first;
        let mut valence = 0usize;
        loop {
            valence += 1;
            h = mesh.prev[h as usize] ^ 1;
            if h == first {
                break;
            }
        }
        reached += valence;
        if valence == 2 && (mesh.is_pillow(first) || mesh.is_pillow(mesh.prev[first as usize] ^ 1)) {
            return false;
        }
    }
    reached == 2 * mesh.edge_count()
}

/// Every defect, with its witnesses.
fn defects(topology: &Topology<'_>) -> Vec<BuildDefect> {
    let mut found = Vec::new();
    for e in topology.nonmanifold_edges() {
        found.push(BuildDefect::NonManifoldEdge { edge: e.vertices(), faces: e.faces().collect() });
    }
    for e in topology.conflicting_edges() {
        let mut faces = e.faces();
        if let (Some(a), Some(b)) = (faces.next(), faces.next()) {
            found.push(BuildDefect::ConflictingEdge { edge: e.vertices(), faces: [a, b] });
        }
    }
    for (vertex, fans) in topology.pinched_vertices() {
        found.push(BuildDefect::PinchedVertex { vertex, fans });
    }
    for (face, original) in topology.duplicate_faces() {
        found.push(BuildDefect::DuplicateFace { face, original });
    }
    found
}
