//! One [`Violation`] per numbered invariant of the [design page](crate::design), and the two checks.

#[cfg(test)]
mod tests;

use crate::column::{Kind, Store};
use crate::matching::NONE;
use crate::topology::Cycle;
use crate::{EdgeKey, FaceKey, HalfedgeKey, Mesh, VertexKey};
use glam::DVec3;

/// A broken invariant and where. No public call can bring one about; if you see one, it is a bug of this crate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Violation {
    /// M1: a column has not the length of its arena, or an arena's slots and versions disagree.
    #[error("M1: {column} does not fit its arena")]
    Storage {
        /// The column or arena.
        column: &'static str,
    },
    /// M2: a link of a live element leads to a dead or missing one.
    #[error("M2: {column}[{slot}] = {link} leads to nothing")]
    DanglingLink {
        /// The column of the link.
        column: &'static str,
        /// The slot whose link it is.
        slot: u32,
        /// What it holds.
        link: u32,
    },
    /// M3: `prev(next(h)) != h` or `next(prev(h)) != h`.
    #[error("M3: next and prev are not inverse at {0:?}")]
    NextPrev(HalfedgeKey),
    /// M4: `origin(next(h)) != target(h)`.
    #[error("M4: the half-edge after {0:?} starts elsewhere")]
    Gap(HalfedgeKey),
    /// M5: an edge joins a vertex to itself.
    #[error("M5: {0:?} joins a vertex to itself")]
    LoopEdge(EdgeKey),
    /// M6: `face(next(h)) != face(h)`.
    #[error("M6: the half-edge after {0:?} has another face")]
    FaceChange(HalfedgeKey),
    /// M7: `face(face_halfedge(f)) != f`.
    #[error("M7: the first half-edge of {0:?} has another face")]
    FaceHalfedge(FaceKey),
    /// M8: a face has fewer than three corners.
    #[error("M8: {0:?} has fewer than three corners")]
    ShortFace(FaceKey),
    /// M9: a face names a vertex twice.
    #[error("M9: {face:?} names {vertex:?} twice")]
    RepeatedCorner {
        /// The face.
        face: FaceKey,
        /// The vertex.
        vertex: VertexKey,
    },
    /// M10: a half-edge of a face is not on the loop of the face's first half-edge.
    #[error("M10: {0:?} is not on the loop of its face")]
    SecondLoop(HalfedgeKey),
    /// M11: an edge has no face.
    #[error("M11: {0:?} has no face")]
    FacelessEdge(EdgeKey),
    /// M12: `origin(vertex_halfedge(v)) != v`.
    #[error("M12: the half-edge of {0:?} starts elsewhere")]
    VertexHalfedge(VertexKey),
    /// M13: a boundary vertex's half-edge is not its boundary half-edge.
    #[error("M13: {0:?} lies on the boundary, its half-edge does not")]
    BoundaryHalfedge(VertexKey),
    /// M14: the faces around a vertex form more than one fan.
    #[error("M14: {0:?} has more than one fan")]
    Pinch(VertexKey),
    /// M15: a vertex without a half-edge is some half-edge's origin.
    #[error("M15: {0:?} has half-edges but does not know one")]
    FalselyIsolated(VertexKey),
    /// M16: two edges join the same two vertices.
    #[error("M16: {0:?} and {1:?} join the same vertices")]
    ParallelEdges(EdgeKey, EdgeKey),
    /// M17: two faces have the same corner cycle, in either direction.
    #[error("M17: {0:?} and {1:?} have the same corners")]
    DuplicateFaces(FaceKey, FaceKey),
    /// M18: a position or carried normal is not finite.
    #[error("M18: {0:?} is not finite")]
    NonFinite(VertexKey),
}

impl Mesh {
    /// Checks all invariants. O(elements), in a few linear passes; call it as often as doubts arise.
    ///
    /// # Errors
    /// The first violation that [`violations`](Self::violations) lists.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, NormalWeight, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let pool = IndexedMesh::from_triangles(points, &[[0, 1, 2]])?;
    /// # let mut mesh = Mesh::build(&pool)?;
    /// assert_eq!(mesh.validate(), Ok(()));
    /// assert!(mesh.violations().is_empty());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn validate(&self) -> Result<(), Violation> {
        if self.is_sound() {
            return Ok(());
        }
        self.violations().into_iter().next().map_or(Ok(()), Err)
    }

    /// Every broken invariant, in the order of their numbers. Safe on any state of the links.
    ///
    /// Invariants build on each other: M2 is examined if M1 holds, M3 to M7 if M2 holds, the rest if M3 to M6 hold,
    /// because a walk along broken links says nothing. O(n log n).
    pub fn violations(&self) -> Vec<Violation> {
        let layers =
            [Self::storage_violations, Self::dangling_links, Self::local_violations, Self::walk_violations];
        layers.into_iter().map(|layer| layer(self)).find(|found| !found.is_empty()).unwrap_or_default()
    }

    fn halfedge_slots(&self) -> impl Iterator<Item = u32> + Clone + '_ {
        self.edges.live().flat_map(|e| [2 * e, 2 * e + 1])
    }

    /// M1.
    fn storage_violations(&self) -> Vec<Violation> {
        let (v, h, f) = (self.vertices.slot_count(), 2 * self.edges.slot_count(), self.faces.slot_count());
        let checks = [
            ("next", self.next.len() == h),
            ("prev", self.prev.len() == h),
            ("origin", self.origin.len() == h),
            ("face", self.face.len() == h),
            ("vertex_halfedge", self.vertex_halfedge.len() == v),
            ("positions", self.positions.len() == v),
            ("face_halfedge", self.face_halfedge.len() == f),
            ("vertex data", self.columns.fit(Kind::Vertex, v)),
            ("corner data", self.columns.fit(Kind::Corner, h)),
            ("edge data", self.columns.fit(Kind::Edge, h / 2)),
            ("face data", self.columns.fit(Kind::Face, f)),
            ("vertices", self.vertices.is_sound()),
            ("edges", self.edges.is_sound()),
            ("faces", self.faces.is_sound()),
        ];
        let broken = checks.into_iter().filter(|(_, holds)| !holds);
        broken.map(|(column, _)| Violation::Storage { column }).collect()
    }

    /// M2.
    fn dangling_links(&self) -> Vec<Violation> {
        let live_halfedge = |h: u32| self.edges.is_live(h >> 1);
        let mut found = Vec::new();
        let mut check = |column, slot, link, holds: bool| {
            if !holds {
                found.push(Violation::DanglingLink { column, slot, link });
            }
        };
        for h in self.halfedge_slots() {
            let i = h as usize;
            check("next", h, self.next[i], live_halfedge(self.next[i]));
            check("prev", h, self.prev[i], live_halfedge(self.prev[i]));
            check("origin", h, self.origin[i], self.vertices.is_live(self.origin[i]));
            check("face", h, self.face[i], self.face[i] == NONE || self.faces.is_live(self.face[i]));
        }
        for v in self.vertices.live() {
            let h = self.vertex_halfedge[v as usize];
            check("vertex_halfedge", v, h, h == NONE || live_halfedge(h));
        }
        for f in self.faces.live() {
            let h = self.face_halfedge[f as usize];
            check("face_halfedge", f, h, live_halfedge(h));
        }
        found
    }

    /// M3 to M7: what two neighbouring records say.
    fn local_violations(&self) -> Vec<Violation> {
        let mut found = Vec::new();
        let each =
            |found: &mut Vec<_>, broken: &dyn Fn(usize) -> bool, name: fn(HalfedgeKey) -> Violation| {
                let halfedges = self.halfedge_slots().filter(|&h| broken(h as usize));
                found.extend(halfedges.map(|h| name(self.halfedge_key(h))));
            };
        let next = |h: usize| self.next[h] as usize;
        let inverse = |h: usize| self.prev[next(h)] as usize == h && next(self.prev[h] as usize) == h;
        each(&mut found, &|h| !inverse(h), Violation::NextPrev);
        each(&mut found, &|h| self.origin[next(h)] != self.origin[h ^ 1], Violation::Gap);
        let loops =
            self.edges.live().filter(|&e| self.origin[2 * e as usize] == self.origin[2 * e as usize + 1]);
        found.extend(loops.map(|e| Violation::LoopEdge(self.edges.key(e))));
        each(&mut found, &|h| self.face[next(h)] != self.face[h], Violation::FaceChange);
        let strayed = self.faces.live().filter(|&f| self.face[self.face_halfedge[f as usize] as usize] != f);
        found.extend(strayed.map(|f| Violation::FaceHalfedge(self.faces.key(f))));
        found
    }

    /// M8 to M18: what takes a walk. `next` is a permutation here, so every walk comes back.
    fn walk_violations(&self) -> Vec<Violation> {
        let mut found = self.loop_violations();
        let edges = self
            .edges
            .live()
            .filter(|&e| self.face[2 * e as usize] == NONE && self.face[2 * e as usize + 1] == NONE);
        found.extend(edges.map(|e| Violation::FacelessEdge(self.edges.key(e))));
        found.extend(self.fan_violations());
        found.extend(self.repeated_elements());
        let finite = |v: u32| {
            self.positions[v as usize].is_finite()
                && self.normal_column().is_none_or(|n| n.get(v).is_some_and(|n| n.is_finite()))
        };
        found.extend(
            self.vertices.live().filter(|&v| !finite(v)).map(|v| Violation::NonFinite(self.vertices.key(v))),
        );
        found
    }

    /// M8, M9, M10.
    fn loop_violations(&self) -> Vec<Violation> {
        let mut stamp = vec![0u32; self.vertices.slot_count()];
        let mut on_loop = vec![false; self.next.len()];
        let (mut short, mut repeated) = (Vec::new(), Vec::new());
        for f in self.faces.live() {
            let mut degree = 0;
            for h in self.loop_slots(self.face_halfedge[f as usize]) {
                degree += 1;
                on_loop[h as usize] = true;
                let v = self.origin[h as usize];
                if std::mem::replace(&mut stamp[v as usize], f) == f {
                    repeated.push(Violation::RepeatedCorner {
                        face: self.faces.key(f),
                        vertex: self.vertices.key(v),
                    });
                }
            }
            if degree < 3 {
                short.push(Violation::ShortFace(self.faces.key(f)));
            }
        }
        let second = self.halfedge_slots().filter(|&h| self.face[h as usize] != NONE && !on_loop[h as usize]);
        let second = second.map(|h| Violation::SecondLoop(self.halfedge_key(h)));
        short.into_iter().chain(repeated).chain(second).collect()
    }

    /// M12 to M15.
    fn fan_violations(&self) -> Vec<Violation> {
        let mut found = Vec::new();
        let mut starting = vec![0u32; self.vertices.slot_count()];
        let mut open = vec![0u32; self.vertices.slot_count()];
        for h in self.halfedge_slots() {
            let v = self.origin[h as usize] as usize;
            starting[v] += 1;
            open[v] += u32::from(self.face[h as usize] == NONE);
        }
        for v in self.vertices.live() {
            let (i, key) = (v as usize, self.vertices.key(v));
            let h = self.vertex_halfedge[i];
            if h == NONE {
                if starting[i] > 0 {
                    found.push(Violation::FalselyIsolated(key));
                }
                continue;
            }
            if self.origin[h as usize] != v {
                found.push(Violation::VertexHalfedge(key));
                continue;
            }
            if open[i] > 0 && self.face[h as usize] != NONE {
                found.push(Violation::BoundaryHalfedge(key));
            }
            if open[i] > 1 || self.outgoing_slots(v).count() != starting[i] as usize {
                found.push(Violation::Pinch(key));
            }
        }
        found.sort_by_key(|v| match v {
            Violation::VertexHalfedge(_) => 12,
            Violation::BoundaryHalfedge(_) => 13,
            Violation::Pinch(_) => 14,
            _ => 15,
        });
        found
    }

    /// M16, M17.
    fn repeated_elements(&self) -> Vec<Violation> {
        let ends = |e: u32| {
            let (a, b) = (self.origin[2 * e as usize], self.origin[2 * e as usize + 1]);
            (a.min(b), a.max(b))
        };
        let mut edges: Vec<_> = self.edges.live().map(|e| (ends(e), e)).collect();
        edges.sort_unstable();
        let parallel = edges.windows(2).filter(|w| w[0].0 == w[1].0);
        let mut found: Vec<_> = parallel
            .map(|w| Violation::ParallelEdges(self.edges.key(w[0].1), self.edges.key(w[1].1)))
            .collect();

        let mut cycles: Vec<(Vec<u32>, u32)> = Vec::with_capacity(self.face_count());
        for f in self.faces.live() {
            let corners: Vec<u32> =
                self.loop_slots(self.face_halfedge[f as usize]).map(|h| self.origin[h as usize]).collect();
            cycles.push((Cycle::of(&corners).iter().collect(), f));
        }
        cycles.sort_unstable();
        let same = cycles.windows(2).filter(|w| w[0].0 == w[1].0);
        found.extend(same.map(|w| Violation::DuplicateFaces(self.faces.key(w[0].1), self.faces.key(w[1].1))));
        found
    }

    /// Whether all invariants hold, as fast as that can be told.
    fn is_sound(&self) -> bool {
        self.storage_violations().is_empty()
            && self.open_if_halfedges_are_sound().is_some_and(|open| self.faces_are_sound(open))
            && self.vertices_are_sound()
    }

    /// M3 to M6 and M11, in one sweep of the half-edges; the number of those without a face if they hold. Whether their
    /// faces and origins are live (M2) shows later: the loops of live faces and the fans of live vertices must hold them
    /// all.
    fn open_if_halfedges_are_sound(&self) -> Option<usize> {
        let mut open = 0;
        for e in self.edges.live() {
            let h = 2 * e as usize;
            let (left, right) = (self.face[h], self.face[h + 1]);
            let side = |h: usize, face: u32| {
                let next = self.next[h];
                let n = next as usize;
                self.edges.is_live(next >> 1)
                    && self.prev[n] as usize == h
                    && self.origin[n] == self.origin[h ^ 1]
                    && self.face[n] == face
            };
            // `next` maps live half-edges to live ones and `prev` leads back, so both are permutations.
            let is_edge = self.origin[h] != self.origin[h + 1] && (left & right) != NONE;
            if !(is_edge && side(h, left) && side(h + 1, right)) {
                return None;
            }
            open += usize::from(left == NONE) + usize::from(right == NONE);
        }
        Some(open)
    }

    /// M7 to M10: each face has a loop of three or more, and the loops hold all half-edges that have a face.
    fn faces_are_sound(&self, open: usize) -> bool {
        let mut stamp: Vec<u32> = Vec::new();
        let mut on_loops = 0;
        for f in self.faces.live() {
            let first = self.face_halfedge[f as usize];
            if !self.edges.is_live(first >> 1) || self.face[first as usize] != f {
                return false;
            }
            let second = self.next[first as usize];
            let third = self.next[second as usize];
            if third == first {
                return false;
            }
            if self.next[third as usize] == first {
                // No edge of a triangle is a loop, so its corners are distinct.
                on_loops += 3;
                continue;
            }
            stamp.resize(self.vertices.slot_count(), 0);
            for h in self.loop_slots(first) {
                on_loops += 1;
                // An origin beyond the vertices is no live one.
                let Some(last) = stamp.get_mut(self.origin[h as usize] as usize) else { return false };
                if std::mem::replace(last, f) == f {
                    return false;
                }
            }
        }
        on_loops + open == 2 * self.edge_count()
    }

    /// M12 to M18: each vertex has one fan, the fans hold all half-edges, and nothing is there twice.
    fn vertices_are_sound(&self) -> bool {
        let mut stamp = vec![0u32; self.vertices.slot_count()];
        let mut in_fans = 0;
        for v in self.vertices.live() {
            if !self.positions[v as usize].is_finite() {
                return false;
            }
            let first = self.vertex_halfedge[v as usize];
            if first == NONE {
                continue;
            }
            if !self.edges.is_live(first >> 1) || self.origin[first as usize] != v {
                return false;
            }
            let mut valence = 0;
            let mut h = first;
            loop {
                // Only the first may lie on the boundary. The other end of an edge sees parallels too: one end is enough.
                if h != first && self.face[h as usize] == NONE {
                    return false;
                }
                let to = self.origin[h as usize ^ 1];
                if to > v {
                    let Some(last) = stamp.get_mut(to as usize) else { return false };
                    if std::mem::replace(last, v) == v {
                        return false;
                    }
                }
                valence += 1;
                h = self.next[h as usize ^ 1];
                if h == first {
                    break;
                }
            }
            if valence == 2 && (self.is_pillow(first) || self.is_pillow(self.prev[first as usize] ^ 1)) {
                return false;
            }
            in_fans += valence;
        }
        let is_finite =
            |n: &Store<DVec3>| self.vertices.live().all(|v| n.get(v).is_some_and(|n| n.is_finite()));
        let normals = self.normal_column().is_none_or(is_finite);
        in_fans == 2 * self.edge_count() && normals
    }

    /// Whether the two faces beside a half-edge have the same corners. Answers `false` unless the half-edge starts at
    /// its face's first corner, so that a large face is walked once.
    pub(crate) fn is_pillow(&self, h: u32) -> bool {
        let (f, g) = (self.face[h as usize], self.face[h as usize ^ 1]);
        f != NONE
            && g != NONE
            && self.face_halfedge[f as usize] == h
            && self.loop_slots(h).all(|k| self.face[k as usize ^ 1] == g)
            && self.loop_slots(h).count() == self.loop_slots(h ^ 1).count()
    }
}
