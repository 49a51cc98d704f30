//! Schemes that cut every edge in two: midpoint, Loop, Catmull-Clark. The matching of the finer faces follows from that
//! of the coarser.

use super::dense::Dense;
use super::{Meter, Scheme, SubdivideError, carry, masks};
use crate::column::Columns;
use crate::matching::NONE;
use crate::report::{Maps, Relation};
use crate::{Mesh, Polygons};
use std::mem;

/// The old element on which a new one lies: an old vertex, edge or face.
#[derive(Clone, Copy)]
enum Birth {
    Vertex(u32),
    Edge(u32),
    Face(u32),
}

/// Levels so far.
pub(super) struct Refined {
    dense: Dense,
    /// By vertex.
    vertex_birth: Vec<Birth>,
    /// By edge; a diagonal of the triangulation lies in a face.
    edge_birth: Vec<Birth>,
    /// By face: the old face it is part of.
    parent: Vec<u32>,
    /// The ends of the old edges.
    ends: Vec<[u32; 2]>,
    /// The corners of the old faces, once they are no longer those of `dense`.
    old: Option<Polygons>,
    old_faces: usize,
    old_vertices: usize,
}

impl Refined {
    pub(super) fn new(dense: Dense, face_source: Option<Vec<u32>>, mesh: &Mesh) -> Self {
        let (vertices, edges, faces) = (dense.positions.len(), dense.edges, dense.polygons.len());
        let mut ends = vec![[NONE; 2]; edges];
        let mut edge_birth: Vec<Birth> = (0..edges as u32).map(Birth::Edge).collect();
        let mut c = 0;
        // For each edge the old face of its first use.
        let mut first_face = if face_source.is_some() { vec![NONE; edges] } else { Vec::new() };
        for (f, face) in dense.polygons.iter().enumerate() {
            for (i, &a) in face.iter().enumerate() {
                let b = face[if i + 1 == face.len() { 0 } else { i + 1 }];
                let e = dense.use_of[c] as usize >> 1;
                ends[e] = [a.min(b), a.max(b)];
                if let Some(source) = &face_source {
                    // An edge between two parts of one face is a diagonal.
                    if mem::replace(&mut first_face[e], source[f]) == source[f] {
                        edge_birth[e] = Birth::Face(source[f]);
                    }
                }
                c += 1;
            }
        }
        let old = face_source.is_some().then(|| mesh.to_indexed().into_parts().1);
        Self {
            vertex_birth: (0..vertices as u32).map(Birth::Vertex).collect(),
            edge_birth,
            parent: face_source.unwrap_or_else(|| (0..faces as u32).collect()),
            ends,
            old,
            old_faces: mesh.face_count(),
            old_vertices: vertices,
            dense,
        }
    }

    /// One level; the births of edges are not needed after the last.
    pub(super) fn step(
        &mut self,
        scheme: Scheme,
        is_last: bool,
        columns: &mut Columns,
        meter: &mut Meter<'_, '_>,
    ) -> Result<(), SubdivideError> {
        let dense = &self.dense;
        let has_center = |n: usize| scheme == Scheme::CatmullClark || n > 3;
        let positions = match scheme {
            Scheme::Loop => masks::loop_(dense),
            Scheme::CatmullClark => masks::catmull_clark(dense),
            _ => masks::midpoint(dense),
        };
        meter.advance(1, 4)?;
        if !columns.is_empty() {
            carry::by_edges(columns, dense, &positions, &has_center);
            meter.advance(1, 3)?;
        }
        let faces = dense.polygons.len();
        let centers = positions.len() - dense.positions.len() - dense.edges;
        let mut births = mem::take(&mut self.vertex_birth);
        births.reserve_exact(positions.len() - births.len());
        births.extend(&self.edge_birth);

        let split = Split::new(dense, has_center, centers, meter)?;
        let mut parent = Vec::with_capacity(split.polygons.len());
        for (face, &old) in dense.polygons.iter().zip(&self.parent) {
            let parts = if has_center(face.len()) {
                births.push(Birth::Face(old));
                face.len()
            } else {
                4
            };
            parent.extend(std::iter::repeat_n(old, parts));
        }
        if !is_last {
            let mut inner = vec![Birth::Face(0); split.edges];
            for (e, &base) in split.base.iter().enumerate() {
                inner[base as usize] = self.edge_birth[e];
                inner[base as usize + 1] = self.edge_birth[e];
            }
            for (f, &base) in split.inner.iter().enumerate() {
                let count = dense.polygons[f].len();
                inner[base as usize..base as usize + count].fill(Birth::Face(self.parent[f]));
            }
            self.edge_birth = inner;
        }
        debug_assert_eq!(split.inner.len(), faces);
        let mut creases = Vec::new();
        if !dense.creases.is_empty() {
            creases = vec![false; split.edges];
            for (&base, &crease) in split.base.iter().zip(&dense.creases) {
                creases[base as usize] = crease;
                creases[base as usize + 1] = crease;
            }
        }
        let open = dense.open.iter().map(|&e| split.base[e as usize]).flat_map(|e| [e, e + 1]).collect();
        let corners = mem::take(&mut self.dense.corners);
        let Split { polygons, use_of, edges, .. } = split;
        let finer = Dense { positions, polygons, use_of, edges, open, creases, corners };
        let spent = mem::replace(&mut self.dense, finer);
        self.old.get_or_insert(spent.polygons);
        self.vertex_birth = births;
        self.parent = parent;
        Ok(())
    }

    /// The finest level, and where its elements come from.
    pub(super) fn finish(self) -> (Dense, Maps) {
        if self.vertex_birth.len() == self.old_vertices {
            // No level.
            let faces = Relation::from_parents(self.old_faces, self.parent);
            return (self.dense, Maps { vertices: Relation::identity(self.old_vertices), faces });
        }
        let old = self.old.unwrap_or_default();
        let count = self.vertex_birth.len();
        let mut starts = Vec::with_capacity(count + 1);
        let mut items: Vec<u32> = Vec::with_capacity(2 * count);
        starts.push(0);
        let mut sorted = Vec::new();
        for &birth in &self.vertex_birth {
            match birth {
                Birth::Vertex(v) => items.push(v),
                Birth::Edge(e) => items.extend(self.ends[e as usize]),
                Birth::Face(f) => {
                    sorted.clear();
                    sorted.extend_from_slice(&old[f as usize]);
                    sorted.sort_unstable();
                    items.extend(&sorted);
                }
            }
            starts.push(items.len() as u32);
        }
        let vertices = Relation::from_old_of(self.old_vertices, starts, items);
        let maps = Maps { vertices, faces: Relation::from_parents(self.old_faces, self.parent) };
        (self.dense, maps)
    }
}

/// The finer faces and their matching.
struct Split {
    polygons: Polygons,
    use_of: Vec<u32>,
    edges: usize,
    /// By coarser edge: the half at the origin of its first use; the other half follows.
    base: Vec<u32>,
    /// By coarser face: its first inner edge; there are as many as it has corners.
    inner: Vec<u32>,
}

impl Split {
    fn new(
        dense: &Dense,
        has_center: impl Fn(usize) -> bool,
        centers: usize,
        meter: &mut Meter<'_, '_>,
    ) -> Result<Self, SubdivideError> {
        let faces = dense.polygons.len();
        let old_corners = dense.polygons.corners().len();
        let (vertices, mut center) =
            (dense.positions.len() as u32, (dense.positions.len() + dense.edges) as u32);
        let uncut = faces - centers;
        let (parts, total) = (old_corners + uncut, 4 * old_corners);
        let mut corners: Vec<u32> = Vec::with_capacity(total);
        let mut use_of: Vec<u32> = Vec::with_capacity(total);
        let mut starts: Vec<usize> = Vec::new();
        let is_uniform = uncut == 0 || centers == 0;
        if !is_uniform {
            starts.reserve_exact(parts + 1);
            starts.push(0);
        }
        let mut base = vec![NONE; dense.edges];
        let mut inner = Vec::with_capacity(faces);
        let mut edges = 0u32;
        let mut c = 0;
        for (f, face) in dense.polygons.iter().enumerate() {
            meter.tick(f, faces)?;
            let n = face.len();
            let uses = &dense.use_of[c..c + n];
            c += n;
            for &u in uses {
                if u & 1 == 0 {
                    base[u as usize >> 1] = edges;
                    edges += 2;
                }
            }
            let spoke = edges;
            inner.push(spoke);
            edges += n as u32;
            // The half of a side at its origin, and that at its target, each as this face uses it.
            let near = |u: u32| (base[u as usize >> 1] + (u & 1)) << 1 | u & 1;
            let far = |u: u32| (base[u as usize >> 1] + 1 - (u & 1)) << 1 | u & 1;
            let middle = |u: u32| vertices + (u >> 1);
            if let (&[a, b, d], &[u, v, w], false) = (face, uses, has_center(n)) {
                let (mu, mv, mw) = (middle(u), middle(v), middle(w));
                let [su, sv, sw] = [spoke, spoke + 1, spoke + 2].map(|s| s << 1);
                corners.extend([a, mu, mw, b, mv, mu, d, mw, mv, mu, mv, mw]);
                use_of.extend([
                    near(u),
                    su,
                    far(w),
                    near(v),
                    sv,
                    far(u),
                    near(w),
                    sw,
                    far(v),
                    sv | 1,
                    sw | 1,
                    su | 1,
                ]);
                if !is_uniform {
                    let end = corners.len();
                    starts.extend([end - 9, end - 6, end - 3, end]);
                }
                continue;
            }
            let mut before = uses[n - 1];
            for (i, (&a, &u)) in face.iter().zip(uses).enumerate() {
                // The spoke of a side is used first by the part at the side's origin, but for the last side.
                let [out, back] = [i, (i + n - 1) % n].map(|i| (spoke + i as u32) << 1);
                corners.extend([a, middle(u), center, middle(before)]);
                let (out, back) = (out | u32::from(i + 1 == n), back | u32::from(i != 0));
                use_of.extend([near(u), out, back, far(before)]);
                if !is_uniform {
                    starts.push(corners.len());
                }
                before = u;
            }
            center += 1;
        }
        let polygons = if is_uniform {
            Polygons::uniform(if centers == 0 { 3 } else { 4 }, corners)
        } else {
            Polygons::with_starts(starts, corners)
        };
        Ok(Self { polygons, use_of, edges: edges as usize, base, inner })
    }
}
