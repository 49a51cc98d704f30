//! The spatial index of a mesh.

use super::bvh::{CUT, Tree};
use super::cast::Part;
use crate::geometry::triangulate::Triangulator;
use crate::geometry::unit_scale;
use crate::{Cancelled, Control, EdgeKey, FaceKey, Mesh, VertexKey};
use glam::DVec3;
use std::fmt;
use std::sync::OnceLock;

/// A spatial index over the faces of a [`Mesh`]: answers rays and nearest elements without looking at every face. Made by
/// [`Mesh::index`].
///
/// Polygons are cut into triangles by the rule that volume and export use; a cut is no edge, and what happens on it
/// happens on the face. Answers do not depend on the number of threads.
///
/// Coordinates less than 2^-286 of the mesh's largest are rounded to a grid of 2^-340 of it, and rays are taken to begin
/// no farther than 2^960 times that away: within these limits the answers about sides and crossings are exact.
pub struct MeshIndex<'m> {
    pub(super) mesh: &'m Mesh,
    /// Vertices are slots, faces are slots.
    pub(super) tree: Tree,
    isolated: OnceLock<Tree>,
    centers: OnceLock<Tree>,
}

/// A part of the surface: the inside of a face, an edge or a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Feature {
    /// The inside of a face.
    Face(FaceKey),
    /// An edge, its ends excluded.
    Edge(EdgeKey),
    /// A vertex.
    Vertex(VertexKey),
}

impl Mesh {
    /// Builds the spatial index for rays and nearest elements. Build it once and ask it often: a single question costs
    /// O(log n) on surfaces from life.
    ///
    /// O(n log n); about 97 bytes a triangle, and while it is being built about 60 more. The index borrows the mesh, so it
    /// cannot outlive a change.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// use meshwright::{Crossing, Ray};
    /// let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    /// let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    /// let mesh = Mesh::build(&IndexedMesh::from_triangles(points, &faces)?)?;
    /// let index = mesh.index();
    /// let hits = index.hits(&Ray::new(DVec3::splat(0.1), DVec3::X)?);
    /// assert_eq!(hits.len(), 1);
    /// assert_eq!(hits[0].crossing, Crossing::Leave);
    /// assert!((hits[0].t - 0.7).abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn index(&self) -> MeshIndex<'_> {
        let (triangles, faces) = self.cut_triangles();
        self.indexed(Tree::new(&self.positions, &triangles, &faces))
    }

    /// [`index`](Self::index) with a progress-and-cancel hook.
    ///
    /// # Errors
    /// [`Cancelled`] when the hook says so.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// use meshwright::{Cancelled, Control, Progress};
    /// use std::ops::ControlFlow;
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// let mut stop = |_: Progress| ControlFlow::Break(());
    /// assert_eq!(mesh.index_with(Control::new(&mut stop)).err(), Some(Cancelled));
    /// assert_eq!(mesh.index_with(Control::none())?.triangle_count(), 1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn index_with(&self, mut control: Control<'_>) -> Result<MeshIndex<'_>, Cancelled> {
        control.report("triangulate", 0.0)?;
        let (triangles, faces) = self.cut_triangles();
        let tree = Tree::new_with(&self.positions, &triangles, &faces, control.part(0.1, 1.0))?;
        Ok(self.indexed(tree))
    }

    fn indexed(&self, tree: Tree) -> MeshIndex<'_> {
        MeshIndex { mesh: self, tree, isolated: OnceLock::new(), centers: OnceLock::new() }
    }

    /// The triangles of [`for_each_cut_triangle`](Self::for_each_cut_triangle), and the face of each.
    fn cut_triangles(&self) -> (Vec<[u32; 3]>, Vec<u32>) {
        let mut triangles = Vec::with_capacity(self.face_count());
        let mut faces = Vec::with_capacity(self.face_count());
        self.for_each_cut_triangle(|f, t| {
            triangles.push(t);
            faces.push(f);
        });
        (triangles, faces)
    }

    /// Calls `f` with each face's slot and triangles, in order; corners are vertex slots, with [`CUT`] where the edge to
    /// the next corner is none of the face.
    pub(super) fn for_each_cut_triangle(&self, mut f: impl FnMut(u32, [u32; 3])) {
        let mut rule = Triangulator::default();
        let mut corners: Vec<u32> = Vec::new();
        let mut edges: Vec<(u32, u32)> = Vec::new();
        for face in self.faces.live() {
            corners.clear();
            corners
                .extend(self.loop_slots(self.face_halfedge[face as usize]).map(|h| self.origin[h as usize]));
            if let [a, b, c] = corners[..] {
                f(face, [a, b, c]);
                continue;
            }
            edges.clear();
            edges.extend((0..corners.len()).map(|i| (corners[i], corners[(i + 1) % corners.len()])));
            edges.sort_unstable();
            for t in rule.triangulate_by(&corners, |v| self.vertices.rank(v), |v| self.positions[v as usize])
            {
                let cut = |i: usize| {
                    let is_edge = edges.binary_search(&(t[i], t[(i + 1) % 3])).is_ok();
                    t[i] | if is_edge { 0 } else { CUT }
                };
                f(face, [cut(0), cut(1), cut(2)]);
            }
        }
    }
}

impl<'m> MeshIndex<'m> {
    /// The mesh that is indexed.
    pub fn mesh(&self) -> &'m Mesh {
        self.mesh
    }

    /// The number of triangles into which the faces are cut.
    pub fn triangle_count(&self) -> usize {
        self.tree.triangle_count()
    }

    /// Bytes of heap memory the index holds.
    pub fn heap_bytes(&self) -> usize {
        let more = [&self.isolated, &self.centers].into_iter().filter_map(OnceLock::get);
        self.tree.bytes() + more.map(Tree::bytes).sum::<usize>()
    }

    /// A tree over the vertices without a face, made when it is first needed.
    pub(super) fn isolated(&self) -> &Tree {
        self.isolated.get_or_init(|| {
            let mesh = self.mesh;
            let alone = |v: &u32| mesh.vertex_halfedge[*v as usize] == crate::matching::NONE;
            let slots: Vec<u32> = mesh.vertices.live().filter(alone).collect();
            let points: Vec<[u32; 3]> = slots.iter().map(|&v| [v; 3]).collect();
            Tree::new(&mesh.positions, &points, &slots)
        })
    }

    /// A tree over the means of the faces' corners, made when it is first needed.
    pub(super) fn centers(&self) -> &Tree {
        self.centers.get_or_init(|| {
            let mesh = self.mesh;
            let slots: Vec<u32> = mesh.faces.live().collect();
            let center = |f: &u32| {
                let corners = || mesh.loop_slots(mesh.face_halfedge[*f as usize]).map(|h| mesh.at(h));
                // Scaled, because the sum may overflow.
                let scale = unit_scale(corners());
                corners().map(|p| p * scale).sum::<DVec3>() / corners().count() as f64 / scale
            };
            let centers: Vec<DVec3> = slots.iter().map(center).collect();
            let points: Vec<[u32; 3]> = (0..slots.len() as u32).map(|i| [i; 3]).collect();
            Tree::new(&centers, &points, &slots)
        })
    }

    /// The vertices of a triangle of the tree.
    pub(super) fn corners(&self, triangle: u32) -> [VertexKey; 3] {
        self.corner_slots(triangle).map(|v| self.mesh.vertices.key(v))
    }

    pub(super) fn corner_slots(&self, triangle: u32) -> [u32; 3] {
        self.tree.corners(triangle)
    }

    pub(super) fn face_slot(&self, triangle: u32) -> u32 {
        self.tree.face(triangle)
    }

    /// The half-edge of the triangle's face from a corner to the next; `None` if that is a cut.
    pub(super) fn halfedge_slot(&self, triangle: u32, corner: usize) -> Option<u32> {
        let (mesh, corners) = (self.mesh, self.corner_slots(triangle));
        let (a, b) = (corners[corner], corners[(corner + 1) % 3]);
        let is_edge = self.tree.is_edge(triangle, corner);
        mesh.outgoing_slots(a).find(|&h| is_edge && mesh.origin[h as usize ^ 1] == b)
    }

    pub(super) fn feature(&self, triangle: u32, part: Part) -> Feature {
        let edge = |i| self.halfedge_slot(triangle, i).map(|h| Feature::Edge(self.mesh.edges.key(h >> 1)));
        let inside = Feature::Face(self.mesh.faces.key(self.face_slot(triangle)));
        match part {
            Part::Inside => inside,
            Part::Edge(i) => edge(i).unwrap_or(inside),
            Part::Corner(i) => Feature::Vertex(self.corners(triangle)[i]),
        }
    }

    /// The point of a triangle with these barycentrics; exactly the vertex's position at a vertex.
    pub(super) fn point(&self, triangle: u32, weights: [f64; 3], part: Part) -> DVec3 {
        if let Part::Corner(i) = part {
            return self.mesh.positions[self.corner_slots(triangle)[i] as usize];
        }
        let [a, b, c] = self.tree.places(triangle);
        (a + (b - a) * weights[1] + (c - a) * weights[2]) / self.tree.scale
    }
}

impl fmt::Debug for MeshIndex<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MeshIndex")
            .field("mesh", &self.mesh)
            .field("triangles", &self.triangle_count())
            .finish_non_exhaustive()
    }
}
