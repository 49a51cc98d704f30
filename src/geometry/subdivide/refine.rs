//! Schemes that cut every edge in two: midpoint, Loop, Catmull-Clark. The matching of the finer faces follows from that
//! of the coarser.

use super::dense::Dense;
use super::{Meter, Scheme, SubdivideError, carry, masks};
use crate::build::Linking;
use crate::column::Columns;
use crate::matching::NONE;
use crate::report::{Maps, OldOf, Relation};
use crate::{IndexedMesh, Mesh, Polygons};
use glam::DVec3;
use std::mem;
use std::sync::Arc;

/// The old element on which a new vertex or edge lies: an old edge or face.
#[derive(Clone, Copy)]
enum Birth {
    Edge(u32),
    Face(u32),
}

/// Levels so far.
pub(super) struct Refined {
    dense: Dense,
    /// By vertex, those of the first level left out.
    vertex_birth: Vec<Birth>,
    /// By edge; a diagonal of the triangulation lies in a face. Empty while every edge is what it was.
    edge_birth: Vec<Birth>,
    /// By face: the old face it is part of.
    parent: Vec<u32>,
    /// The first level with the faces of the mesh, once it is no longer `dense`.
    first: Option<Dense>,
    old_faces: usize,
    old_vertices: usize,
    /// Whether faces were cut into triangles before.
    is_cut: bool,
}

impl Refined {
    pub(super) fn new(dense: Dense, face_source: Option<Vec<u32>>, mesh: &Mesh) -> Self {
        let (vertices, edges, faces) = (dense.positions.len(), dense.edges, dense.polygons.len());
        let mut edge_birth = Vec::new();
        if let Some(source) = &face_source {
            edge_birth.extend((0..edges as u32).map(Birth::Edge));
            // For each edge the old face of its first use.
            let mut first_face = vec![NONE; edges];
            let mut c = 0;
            for (face, &source) in dense.polygons.iter().zip(source) {
                for _ in face {
                    let e = dense.use_of[c] as usize >> 1;
                    // An edge between two parts of one face is a diagonal.
                    if mem::replace(&mut first_face[e], source) == source {
                        edge_birth[e] = Birth::Face(source);
                    }
                    c += 1;
                }
            }
        }
        Self {
            vertex_birth: Vec::new(),
            edge_birth,
            is_cut: face_source.is_some(),
            parent: face_source.unwrap_or_else(|| (0..faces as u32).collect()),
            first: None,
            old_faces: mesh.face_count(),
            old_vertices: vertices,
            dense,
        }
    }

    /// Positions of the next level, with `lead` entries in front; columns go along.
    fn positions(
        &self,
        scheme: Scheme,
        lead: usize,
        columns: &mut Columns,
        meter: &mut Meter<'_, '_>,
    ) -> Result<Vec<DVec3>, SubdivideError> {
        let positions = match scheme {
            Scheme::Loop => masks::loop_(&self.dense, lead),
            Scheme::CatmullClark => masks::catmull_clark(&self.dense, lead),
            _ => masks::midpoint(&self.dense, lead),
        };
        meter.advance(1, 4)?;
        if !columns.is_empty() {
            carry::by_edges(columns, &self.dense, &positions[lead..], &|n| has_center(scheme, n));
            meter.advance(1, 3)?;
        }
        Ok(positions)
    }

    /// The births of the vertices that a level adds, and the parents of its faces.
    fn births(&self, scheme: Scheme, births: &mut Vec<Birth>) -> Vec<u32> {
        let dense = &self.dense;
        births.reserve_exact(dense.edges);
        if self.edge_birth.is_empty() {
            births.extend((0..dense.edges as u32).map(Birth::Edge));
        } else {
            births.extend(&self.edge_birth);
        }
        let faces = || dense.polygons.iter().zip(&self.parent);
        let centers = faces().filter(|(face, _)| has_center(scheme, face.len()));
        births.extend(centers.map(|(_, &old)| Birth::Face(old)));
        self.parents(scheme)
    }

    fn parents(&self, scheme: Scheme) -> Vec<u32> {
        let most = self.dense.use_of.len() + self.dense.polygons.len();
        let mut parent = Vec::with_capacity(most);
        for (face, &old) in self.dense.polygons.iter().zip(&self.parent) {
            let parts = if has_center(scheme, face.len()) { face.len() } else { 4 };
            parent.extend(std::iter::repeat_n(old, parts));
        }
        parent
    }

    /// One level that is not the last.
    pub(super) fn step(
        &mut self,
        scheme: Scheme,
        columns: &mut Columns,
        meter: &mut Meter<'_, '_>,
    ) -> Result<(), SubdivideError> {
        let positions = self.positions(scheme, 0, columns, meter)?;
        let mut births = mem::take(&mut self.vertex_birth);
        let parent = self.births(scheme, &mut births);
        let dense = &self.dense;
        let mut lists = Lists::new(dense, scheme);
        let split = Split::new(dense, scheme, &mut lists, meter)?;
        let mut inner = vec![Birth::Face(0); split.edges];
        for (e, &base) in (0..).zip(&split.base) {
            let birth = self.edge_birth.get(e as usize).copied().unwrap_or(Birth::Edge(e));
            inner[base as usize] = birth;
            inner[base as usize + 1] = birth;
        }
        for ((face, &old), &base) in dense.polygons.iter().zip(&self.parent).zip(&split.inner) {
            inner[base as usize..base as usize + face.len()].fill(Birth::Face(old));
        }
        let mut creases = Vec::new();
        if !dense.creases.is_empty() {
            creases = vec![false; split.edges];
            for (&base, &crease) in split.base.iter().zip(&dense.creases) {
                creases[base as usize] = crease;
                creases[base as usize + 1] = crease;
            }
        }
        let open = split.open(dense);
        let corners = mem::take(&mut self.dense.corners);
        let (polygons, use_of) = lists.finish();
        let finer = Dense { positions, polygons, use_of, edges: split.edges, open, creases, corners };
        let spent = mem::replace(&mut self.dense, finer);
        self.first.get_or_insert(spent);
        self.edge_birth = inner;
        self.vertex_birth = births;
        self.parent = parent;
        Ok(())
    }

    /// The last level, linked at once: what `Mesh::build` checks is not asked again.
    pub(super) fn last(
        self,
        scheme: Scheme,
        mesh: &Mesh,
        columns: &mut Columns,
        meter: &mut Meter<'_, '_>,
    ) -> Result<(Mesh, Maps), SubdivideError> {
        let positions = self.positions(scheme, 1, columns, meter)?;
        let dense = &self.dense;
        let (old_corners, centers) =
            (dense.use_of.len(), positions.len() - 1 - dense.positions.len() - dense.edges);
        let faces = old_corners + dense.polygons.len() - centers;
        let mut linking = Linking::new(positions.len() - 1, 2 * dense.edges + old_corners, faces);
        let split = Split::new(dense, scheme, &mut linking, meter)?;
        let linked = linking.finish(positions, &split.open(dense));
        drop(split);
        meter.advance(3, 4)?;
        let value = match linked {
            Some(mesh) => mesh,
            // A manifold has only manifolds for parts, so this is a bug: say what is wrong with the faces.
            None => {
                let positions = self.positions(scheme, 0, &mut Columns::default(), meter)?;
                let mut lists = Lists::new(dense, scheme);
                Split::new(dense, scheme, &mut lists, meter)?;
                let pool = IndexedMesh::trusted(positions, lists.finish().0, None);
                Mesh::build(&pool).map_err(SubdivideError::Bug)?
            }
        };
        let (vertices, faces) = (value.vertex_count(), value.face_count());
        Ok((value, self.maps(scheme, mesh, vertices, faces)))
    }

    /// Where the elements of the level after this come from; told when somebody asks.
    fn maps(mut self, scheme: Scheme, mesh: &Mesh, vertices: usize, faces: usize) -> Maps {
        let cut = self.is_cut.then(|| mesh.to_indexed().into_parts().1);
        self.dense.positions = Vec::new();
        if let Some(first) = &mut self.first {
            first.positions = Vec::new();
        }
        let (old_vertices, old_faces) = (self.old_vertices, self.old_faces);
        let levels = Arc::new(self);
        let same = Arc::clone(&levels);
        Maps {
            vertices: Relation::made(old_vertices, vertices, move |told| {
                levels.tell_vertices(scheme, cut.as_ref(), told);
            }),
            faces: Relation::made(old_faces, faces, move |told| {
                same.parents(scheme).into_iter().for_each(|old| told.add([old]));
            }),
        }
    }

    /// The old vertices that each vertex of the level after this lies between.
    fn tell_vertices(&self, scheme: Scheme, cut: Option<&Polygons>, told: &mut OldOf) {
        let dense = self.first.as_ref().unwrap_or(&self.dense);
        let old = cut.unwrap_or(&dense.polygons);
        let ends = dense.ends_of_edges();
        (0..self.old_vertices as u32).for_each(|v| told.add([v]));
        let mut add = |birth: Birth| match birth {
            Birth::Edge(e) => told.add(ends[e as usize]),
            Birth::Face(f) => told.add(old[f as usize].iter().copied()),
        };
        self.vertex_birth.iter().for_each(|&birth| add(birth));
        if self.edge_birth.is_empty() {
            (0..self.dense.edges as u32).for_each(|e| add(Birth::Edge(e)));
        } else {
            self.edge_birth.iter().for_each(|&birth| add(birth));
        }
        for (face, &f) in self.dense.polygons.iter().zip(&self.parent) {
            if has_center(scheme, face.len()) {
                add(Birth::Face(f));
            }
        }
    }

    /// The mesh as it is, in triangles if it was cut into them, and where its faces come from.
    pub(super) fn unrefined(self) -> (Dense, Maps) {
        let faces = Relation::from_parents(self.old_faces, self.parent);
        (self.dense, Maps { vertices: Relation::identity(self.old_vertices), faces })
    }
}

/// Whether a face of so many corners gets a vertex in its middle.
fn has_center(scheme: Scheme, corners: usize) -> bool {
    scheme == Scheme::CatmullClark || corners > 3
}

/// Who takes the finer faces: vertices, and for each corner its use of an edge.
pub(super) trait Sink {
    fn face(&mut self, corners: &[u32], uses: &[u32]);
}

impl Sink for Linking {
    #[inline(always)]
    fn face(&mut self, corners: &[u32], uses: &[u32]) {
        Linking::face(self, corners, uses);
    }
}

/// Faces for the next level.
pub(super) struct Lists {
    corners: Vec<u32>,
    use_of: Vec<u32>,
    /// Empty where all have one degree.
    starts: Vec<usize>,
    degree: Option<usize>,
}

impl Lists {
    fn new(dense: &Dense, scheme: Scheme) -> Self {
        let total = 4 * dense.use_of.len();
        let centers = dense.polygons.iter().filter(|f| has_center(scheme, f.len())).count();
        let degree = match centers {
            0 => Some(3),
            n if n == dense.polygons.len() => Some(4),
            _ => None,
        };
        let (corners, use_of) = (Vec::with_capacity(total), Vec::with_capacity(total));
        Self { corners, use_of, starts: vec![0], degree }
    }

    /// For `faces` triangles.
    pub(super) fn of_triangles(faces: usize) -> Self {
        let (corners, use_of) = (Vec::with_capacity(3 * faces), Vec::with_capacity(3 * faces));
        Self { corners, use_of, starts: vec![0], degree: Some(3) }
    }

    pub(super) fn finish(self) -> (Polygons, Vec<u32>) {
        let polygons = match self.degree {
            Some(degree) => Polygons::uniform(degree, self.corners),
            None => Polygons::with_starts(self.starts, self.corners),
        };
        (polygons, self.use_of)
    }
}

impl Sink for Lists {
    #[inline(always)]
    fn face(&mut self, corners: &[u32], uses: &[u32]) {
        self.corners.extend_from_slice(corners);
        self.use_of.extend_from_slice(uses);
        if self.degree.is_none() {
            self.starts.push(self.corners.len());
        }
    }
}

/// The finer edges; the faces went to the sink.
struct Split {
    edges: usize,
    /// By coarser edge: the half at the origin of its first use; the other half follows.
    base: Vec<u32>,
    /// By coarser face: its first inner edge; there are as many as it has corners.
    inner: Vec<u32>,
}

impl Split {
    /// The finer edges with one use.
    fn open(&self, dense: &Dense) -> Vec<u32> {
        dense.open.iter().map(|&e| self.base[e as usize]).flat_map(|e| [e, e + 1]).collect()
    }

    fn new(
        dense: &Dense,
        scheme: Scheme,
        sink: &mut impl Sink,
        meter: &mut Meter<'_, '_>,
    ) -> Result<Self, SubdivideError> {
        let faces = dense.polygons.len();
        let (vertices, mut center) =
            (dense.positions.len() as u32, (dense.positions.len() + dense.edges) as u32);
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
            if let (&[a, b, d], &[u, v, w], false) = (face, uses, has_center(scheme, n)) {
                let (mu, mv, mw) = (middle(u), middle(v), middle(w));
                let [su, sv, sw] = [spoke, spoke + 1, spoke + 2].map(|s| s << 1);
                sink.face(&[a, mu, mw], &[near(u), su, far(w)]);
                sink.face(&[b, mv, mu], &[near(v), sv, far(u)]);
                sink.face(&[d, mw, mv], &[near(w), sw, far(v)]);
                sink.face(&[mu, mv, mw], &[sv | 1, sw | 1, su | 1]);
                continue;
            }
            let mut before = uses[n - 1];
            for (i, (&a, &u)) in face.iter().zip(uses).enumerate() {
                // The spoke of a side is used first by the part at the side's origin, but for the last side.
                let [out, back] = [i, (i + n - 1) % n].map(|i| (spoke + i as u32) << 1);
                let (out, back) = (out | u32::from(i + 1 == n), back | u32::from(i != 0));
                sink.face(&[a, middle(u), center, middle(before)], &[near(u), out, back, far(before)]);
                before = u;
            }
            center += 1;
        }
        Ok(Self { edges: edges as usize, base, inner })
    }
}
