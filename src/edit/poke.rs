//! Poking a face.

use super::Few;
use crate::column::{Event, Kind};
use crate::{EdgeKey, FaceKey, Mesh, VertexKey};
use glam::DVec3;
use smallvec::SmallVec;

/// Why a face was not poked.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PokeFaceError {
    /// The key names no live face.
    #[error("{0:?} is not a face of the mesh")]
    Missing(FaceKey),
    /// A coordinate is NaN or infinite.
    #[error("the position {0} is not finite")]
    NonFinite(DVec3),
}

/// What [`Mesh::poke_face`] made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PokedFace {
    /// The vertex in the middle.
    pub vertex: VertexKey,
    /// The spokes, in the order of the face's corners, from corner to vertex.
    pub edges: Few<EdgeKey>,
    /// The new triangles, counter-clockwise from the second of the face's edges; the face itself is that at its first.
    pub faces: Few<FaceKey>,
}

impl Mesh {
    /// Pokes a face: puts a vertex in it and joins it to all corners. A face of `n` corners becomes `n` triangles, of
    /// which it stays the first. Can always be done.
    ///
    /// ```text
    ///   ●───────●        ●───────●
    ///   │       │        │ ╲   ╱ │
    ///   │       │   →    │   ●   │
    ///   │       │        │ ╱   ╲ │
    ///   ●───────●        ●───────●
    /// ```
    ///
    /// Data of the vertex and of the corners at it is made from the face's corners, weighted by their mean value
    /// coordinates at the position. O(degree).
    ///
    /// # Errors
    /// [`PokeFaceError`]; nothing has changed then.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y];
    /// # let mut mesh = Mesh::build(&IndexedMesh::new(points, vec![vec![0, 1, 2, 3]].into())?)?;
    /// let quad = mesh.faces().next().unwrap();
    /// let new = mesh.poke_face(quad, DVec3::new(0.5, 0.5, 1.0))?;
    /// assert_eq!((mesh.face_count(), mesh.valence(new.vertex)), (4, 4));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn poke_face(&mut self, f: FaceKey, position: DVec3) -> Result<PokedFace, PokeFaceError> {
        self.check_poke_face(f, position)?;
        let f = self.face_slot(f).ok_or(PokeFaceError::Missing(f))?;
        let first = self.face_halfedge[f as usize];
        let around: SmallVec<[u32; 8]> = self.loop_slots(first).collect();
        let n = around.len();
        let wanted = self.changes.is_some()
            || !self.columns.none_on(Kind::Vertex)
            || !self.columns.none_on(Kind::Corner);
        let (by_vertex, by_corner) =
            if wanted { self.loop_weights(first, position) } else { Default::default() };

        let m = self.new_vertex(position, &by_vertex);
        // Corner data at the vertex is the same in every triangle: made once, while all sources are there.
        let spokes: SmallVec<[u32; 8]> =
            around.iter().map(|&h| self.new_edge(self.origin[h as usize], m, None)).collect();
        let middle = spokes[0] ^ 1;
        self.mix(Kind::Corner, Event::Split, middle, &by_corner);
        let mut faces = Few::new();
        for i in 0..n {
            let j = if i + 1 == n { 0 } else { i + 1 };
            // The triangle along h: out along the spoke of the next corner, back along that of this one.
            let (h, out, back) = (around[i], spokes[j], spokes[i] ^ 1);
            let face = if i == 0 {
                f
            } else {
                let face = self.new_face(h, Some(f));
                faces.push(self.faces.key(face));
                face
            };
            self.copy_corner(around[j], out);
            if i > 0 {
                self.copy_corner(middle, back);
            }
            self.link(h, out);
            self.link(out, back);
            self.link(back, h);
            for h in [h, out, back] {
                self.set_face(h, face);
            }
        }
        self.set_vertex_halfedge(m, middle);
        Ok(PokedFace {
            vertex: self.vertices.key(m),
            edges: spokes.iter().map(|h| self.edges.key(h >> 1)).collect(),
            faces,
        })
    }

    /// Whether [`poke_face`](Self::poke_face) would be done.
    ///
    /// # Errors
    /// As there.
    pub fn check_poke_face(&self, f: FaceKey, position: DVec3) -> Result<(), PokeFaceError> {
        self.face_slot(f).ok_or(PokeFaceError::Missing(f))?;
        if position.is_finite() { Ok(()) } else { Err(PokeFaceError::NonFinite(position)) }
    }
}
