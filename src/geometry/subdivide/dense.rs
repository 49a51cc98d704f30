//! The form a level works on: faces, and for each corner its edge.

use super::{SubdivideError, carry};
use crate::column::Columns;
use crate::geometry::triangulate::Triangulator;
use crate::matching::{Chains, NONE, Pairing};
use crate::{EdgeKey, IndexedMesh, Mesh, Polygons, VertexKey};
use glam::DVec3;

/// A manifold on dense arrays.
pub(super) struct Dense {
    pub(super) positions: Vec<DVec3>,
    pub(super) polygons: Polygons,
    /// For each corner twice its edge, plus one unless it is the edge's first use.
    pub(super) use_of: Vec<u32>,
    pub(super) edges: usize,
    /// The edges with one use.
    pub(super) open: Vec<u32>,
    /// By edge; empty if no edge is a crease.
    pub(super) creases: Vec<bool>,
    /// By vertex of the first level; empty if none stays.
    pub(super) corners: Vec<bool>,
}

/// A mesh made ready for a scheme: in triangles, if it needs them.
pub(super) struct Prepared {
    pub(super) dense: Dense,
    /// For each face the one it was cut from; `None` if none was cut.
    pub(super) face_source: Option<Vec<u32>>,
    /// How many faces were cut into triangles.
    pub(super) triangulated: Option<usize>,
}

impl Prepared {
    /// Brings the columns along.
    pub(super) fn new(
        mesh: &Mesh,
        needs_triangles: bool,
        columns: &mut Columns,
    ) -> Result<Self, SubdivideError> {
        let mut dense = Dense::of(mesh);
        if !needs_triangles || dense.polygons.iter().all(|f| f.len() == 3) {
            return Ok(Self { dense, face_source: None, triangulated: None });
        }
        let mut rule = Triangulator::default();
        let mut triangles = Vec::new();
        let mut source = Vec::new();
        for (f, corners) in dense.polygons.iter().enumerate() {
            for t in rule.triangulate(corners, |v| dense.positions[v as usize]) {
                triangles.extend(t);
                source.push(f as u32);
            }
        }
        let cut = dense.polygons.iter().filter(|f| f.len() > 3).count();
        let positions = std::mem::take(&mut dense.positions);
        let pool = IndexedMesh::trusted(positions, Polygons::uniform(3, triangles), None);
        Mesh::build(&pool).map_err(SubdivideError::NotTriangulable)?;
        let (positions, polygons, _) = pool.into_parts();
        let triangles = Dense::matched(positions, polygons);
        if !columns.is_empty() {
            carry::by_triangles(columns, &dense, &triangles, &source);
        }
        Ok(Self { dense: triangles, face_source: Some(source), triangulated: Some(cut) })
    }
}

impl Dense {
    /// A mesh in the user's order, its edges numbered as faces first use them.
    pub(super) fn of(mesh: &Mesh) -> Self {
        if mesh.vertices.is_compact() {
            return Self::numbered(mesh, mesh.positions[1..].to_vec(), |slot| slot - 1);
        }
        let order = mesh.vertices.in_user_order();
        let mut number = vec![0u32; mesh.vertices.slot_count()];
        order.iter().zip(0..).for_each(|(&v, i)| number[v as usize] = i);
        let positions = order.iter().map(|&v| mesh.positions[v as usize]).collect();
        Self::numbered(mesh, positions, |slot| number[slot as usize])
    }

    fn numbered(mesh: &Mesh, positions: Vec<DVec3>, number: impl Fn(u32) -> u32) -> Self {
        let mut edge_number = vec![NONE; mesh.edges.slot_count()];
        let most = 2 * mesh.edge_count();
        let (mut corners, mut use_of) = (Vec::with_capacity(most), Vec::with_capacity(most));
        let mut starts = Vec::with_capacity(mesh.face_count() + 1);
        starts.push(0);
        let mut open = Vec::new();
        let mut edges = 0;
        mesh.for_each_in_user_order(|f| {
            for h in mesh.loop_slots(mesh.face_halfedge[f as usize]) {
                corners.push(number(mesh.origin[h as usize]));
                let edge = &mut edge_number[h as usize >> 1];
                let second = *edge != NONE;
                if !second {
                    *edge = edges;
                    if mesh.face[h as usize ^ 1] == NONE {
                        open.push(edges);
                    }
                    edges += 1;
                }
                use_of.push(*edge << 1 | u32::from(second));
            }
            starts.push(corners.len());
        });
        let polygons = Polygons::with_starts(starts, corners);
        let (creases, corners) = (Vec::new(), Vec::new());
        Self { positions, polygons, use_of, edges: edges as usize, open, creases, corners }
    }

    /// Faces that are known to form a manifold.
    pub(super) fn matched(positions: Vec<DVec3>, polygons: Polygons) -> Self {
        let Pairing { edges, use_of, open } = Chains::new(positions.len(), &polygons).into_pairing();
        Self { positions, polygons, use_of, edges, open, creases: Vec::new(), corners: Vec::new() }
    }

    pub(super) fn into_parts(self) -> (Vec<DVec3>, Polygons, Pairing) {
        let pairing = Pairing { edges: self.edges, use_of: self.use_of, open: self.open };
        (self.positions, self.polygons, pairing)
    }

    /// For each edge its first and second corner; [`NONE`] where there is no second.
    pub(super) fn corners_of_edges(&self) -> Vec<[u32; 2]> {
        let mut both = vec![[NONE; 2]; self.edges];
        for (c, &u) in self.use_of.iter().enumerate() {
            both[u as usize >> 1][u as usize & 1] = c as u32;
        }
        both
    }

    /// For each edge its two ends, as its first use runs along it.
    pub(super) fn ends_of_edges(&self) -> Vec<[u32; 2]> {
        let mut ends = vec![[NONE; 2]; self.edges];
        let mut c = 0;
        for face in self.polygons.iter() {
            for (i, &a) in face.iter().enumerate() {
                let u = self.use_of[c];
                c += 1;
                if u & 1 == 0 {
                    ends[u as usize >> 1] = [a, face[if i + 1 == face.len() { 0 } else { i + 1 }]];
                }
            }
        }
        ends
    }

    /// Takes over the creases and corners that the caller names.
    pub(super) fn mark_creases(
        &mut self,
        mesh: &Mesh,
        edges: &[EdgeKey],
        degrees: Option<f64>,
        corners: &[VertexKey],
    ) -> Result<(), SubdivideError> {
        let mut number = vec![NONE; mesh.vertices.slot_count()];
        mesh.vertices.in_user_order().into_iter().zip(0..).for_each(|(v, i)| number[v as usize] = i);
        for &v in corners {
            let slot = mesh.vertex_slot(v).ok_or(SubdivideError::MissingVertex(v))?;
            self.corners.resize(self.positions.len(), false);
            self.corners[number[slot as usize] as usize] = true;
        }
        let by_angle = degrees.map_or(Ok(Vec::new()), |d| mesh.sharp_edges(d))?;
        let mut pairs = Vec::with_capacity(edges.len() + by_angle.len());
        for &e in edges.iter().chain(&by_angle) {
            let slot = mesh.edge_slot(e).ok_or(SubdivideError::MissingEdge(e))?;
            let [a, b] = [2 * slot, 2 * slot + 1].map(|h| number[mesh.origin[h as usize] as usize]);
            pairs.push([a.min(b), a.max(b)]);
        }
        if pairs.is_empty() {
            return Ok(());
        }
        pairs.sort_unstable();
        self.creases = vec![false; self.edges];
        let mut c = 0;
        for face in self.polygons.iter() {
            for (i, &a) in face.iter().enumerate() {
                let b = face[(i + 1) % face.len()];
                if pairs.binary_search(&[a.min(b), a.max(b)]).is_ok() {
                    self.creases[self.use_of[c] as usize >> 1] = true;
                }
                c += 1;
            }
        }
        Ok(())
    }
}
