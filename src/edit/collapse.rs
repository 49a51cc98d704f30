//! Collapsing an edge.

use super::link::HUB;
use super::undo::Field;
use super::{Few, Slots};
use crate::column::{Dense, Event, Kind};
use crate::matching::NONE;
use crate::{EdgeKey, FaceKey, HalfedgeKey, Mesh, VertexKey};
use glam::DVec3;
use smallvec::SmallVec;

/// Why an edge was not collapsed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CollapseError {
    /// The key names no live half-edge.
    #[error("{0:?} is not a half-edge of the mesh")]
    Missing(HalfedgeKey),
    /// A coordinate is NaN or infinite.
    #[error("the position {0} is not finite")]
    NonFinite(DVec3),
    /// The edge has faces on both sides and its ends are both on the boundary: they would make a pinch.
    #[error("{0:?} runs through the inside from boundary to boundary")]
    BetweenBoundaries(EdgeKey),
    /// The ends have a common neighbour that is no apex of a triangle at the edge: two edges to it would be left.
    #[error("both ends are joined to {0:?}")]
    CommonNeighbor(VertexKey),
    /// A face that is not at the edge has both ends as corners.
    #[error("{0:?} has both ends")]
    CommonFace(FaceKey),
    /// The triangle at the edge is the only face of its apex, or of the component: that would be left bare.
    #[error("{0:?} has no other face")]
    LastFace(VertexKey),
    /// Two faces would be left with the same corners (a tetrahedron would become two triangles back to back).
    #[error("{0:?} and {1:?} would have the same corners")]
    Duplicate(FaceKey, FaceKey),
}

/// What [`Mesh::collapse`] did.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Collapsed {
    /// The vertex that is left: the target of the half-edge.
    pub vertex: VertexKey,
    /// The vertex that is gone: its origin.
    pub dead_vertex: VertexKey,
    /// The edges that are gone: the edge itself and, for each triangle beside it, the one to the vertex that is gone.
    pub dead_edges: Few<EdgeKey>,
    /// The triangles that are gone.
    pub dead_faces: Few<FaceKey>,
}

impl Mesh {
    /// Collapses an edge: its origin is merged into its target, which moves to the position. Triangles beside the edge
    /// go, larger faces lose a corner.
    ///
    /// ```text
    ///       c                   c
    ///     ╱   ╲                 │
    ///   a ─ h → b       →       ●  = b
    ///     ╲   ╱                 │
    ///       d                   d
    /// ```
    ///
    /// Euler characteristic, boundary loops and components stay what they are, and no other vertex loses its last face.
    /// Data of the two ends is merged by where between them the position lies; corners are merged within their seams, so
    /// a seam along the edge or through one of its ends stays a seam. Where a seam ends inside the surface, collapsing its
    /// last edge moves the end to the merged vertex. O(valences of the ends).
    ///
    /// The conditions extend the link condition (Dey, Edelsbrunner, Guha and Nekhayev, "Topology preserving edge
    /// contraction", 1999) to faces of any degree.
    ///
    /// # Errors
    /// [`CollapseError`]; nothing has changed then.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2], [2, 1, 3]])?)?;
    /// let h = mesh.boundary_halfedges().next().unwrap();
    /// let done = mesh.collapse(h, mesh.position(mesh.target(h)))?;
    /// assert_eq!((done.dead_edges.len(), mesh.face_count()), (2, 1));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn collapse(&mut self, h: HalfedgeKey, position: DVec3) -> Result<Collapsed, CollapseError> {
        self.check_collapse(h, position)?;
        let h = self.halfedge_slot(h).ok_or(CollapseError::Missing(h))?;
        Ok(self.collapse_checked(h, position))
    }

    /// Collapses an edge that is known to be legal to collapse.
    pub(crate) fn collapse_checked(&mut self, h: u32, position: DVec3) -> Collapsed {
        let t = h ^ 1;
        let (a, b) = (self.origin[h as usize], self.origin[t as usize]);
        let share = self.share_along(b, a, position);
        let ends = [(b, 1.0 - share), (a, share)];
        self.mix(Kind::Vertex, Event::Merge, b, &ends);
        if !self.columns.none_on(Kind::Corner) {
            self.merge_wedges(h, share);
        }
        let mut done = Collapsed {
            vertex: self.vertices.key(b),
            dead_vertex: self.vertices.key(a),
            dead_edges: Few::new(),
            dead_faces: Few::new(),
        };
        // The open half-edge of the merged vertex, if it will have one, is that of one of the ends, or beside a triangle
        // that goes.
        let open = [b, a].map(|v| self.vertex_halfedge[v as usize]);
        let is_inside = open.iter().all(|&h| !self.is_open(h));
        let moved = self.spokes(a);
        for &out in &moved {
            self.set_origin(out, b);
        }
        let other = self.close_side(h, b, true, &mut done);
        let out = self.close_side(t, b, false, &mut done);
        done.dead_edges.push(self.drop_edge(h >> 1, None));
        self.drop_vertex(a, Some(b));
        let is_it = |h: &u32| self.edges.is_live(h >> 1) && self.is_open(*h) && self.origin[*h as usize] == b;
        match open.into_iter().chain([other, out]).find(is_it) {
            Some(h) if self.vertex_halfedge[b as usize] == h => {}
            Some(h) => self.set_vertex_halfedge(b, h),
            None if is_inside => self.set_vertex_halfedge(b, out),
            None => self.settle(b, out),
        }
        self.write_position(b, position);
        done
    }

    /// [Collapses](Self::collapse) an edge to its midpoint.
    ///
    /// # Errors
    /// As there.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2], [2, 1, 3]])?)?;
    /// let h = mesh.boundary_halfedges().next().unwrap();
    /// let (a, b) = (mesh.position(mesh.origin(h)), mesh.position(mesh.target(h)));
    /// let done = mesh.collapse_to_midpoint(h)?;
    /// assert_eq!(mesh.position(done.vertex), (a + b) / 2.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn collapse_to_midpoint(&mut self, h: HalfedgeKey) -> Result<Collapsed, CollapseError> {
        let slot = self.halfedge_slot(h).ok_or(CollapseError::Missing(h))?;
        // Halved before they are added: the sum may be beyond f64.
        self.collapse(h, self.at(slot) * 0.5 + self.at(slot ^ 1) * 0.5)
    }

    /// [Collapses](Self::collapse) an edge into its target, which stays where it is.
    ///
    /// # Errors
    /// As there.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2], [2, 1, 3]])?)?;
    /// let h = mesh.boundary_halfedges().next().unwrap();
    /// let kept = mesh.target(h);
    /// assert_eq!(mesh.collapse_into_target(h)?.vertex, kept);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn collapse_into_target(&mut self, h: HalfedgeKey) -> Result<Collapsed, CollapseError> {
        let slot = self.halfedge_slot(h).ok_or(CollapseError::Missing(h))?;
        self.collapse(h, self.at(slot ^ 1))
    }

    /// Whether [`collapse`](Self::collapse) would be done.
    ///
    /// # Errors
    /// As there.
    pub fn check_collapse(&self, h: HalfedgeKey, position: DVec3) -> Result<(), CollapseError> {
        let h = self.halfedge_slot(h).ok_or(CollapseError::Missing(h))?;
        if !position.is_finite() {
            return Err(CollapseError::NonFinite(position));
        }
        let t = h ^ 1;
        let (a, b) = (self.origin[h as usize], self.origin[t as usize]);
        if !self.is_open(h) && !self.is_open(t) && self.is_open_vertex(a) && self.is_open_vertex(b) {
            return Err(CollapseError::BetweenBoundaries(self.edges.key(h >> 1)));
        }
        // A triangle of which no other edge has a face would leave nothing behind.
        let sides = [h, t].map(|h| (h, self.is_triangle(h)));
        for (h, is_triangle) in sides {
            let [n, p] = [self.next[h as usize], self.prev[h as usize]];
            if is_triangle && self.is_open(n ^ 1) && self.is_open(p ^ 1) {
                return Err(CollapseError::LastFace(self.vertices.key(self.origin[p as usize])));
            }
        }
        let apex = sides.map(
            |(h, is_triangle)| {
                if is_triangle { self.origin[self.prev[h as usize] as usize] } else { NONE }
            },
        );
        self.check_shared(a, b, apex, [self.face[h as usize], self.face[t as usize]])?;
        for (h, is_triangle) in sides {
            if is_triangle && let Some([f, g]) = self.would_coincide(h, a, b) {
                return Err(CollapseError::Duplicate(self.faces.key(f), self.faces.key(g)));
            }
        }
        Ok(())
    }

    /// No neighbour but the apexes is common to both ends, and no face but those beside the edge.
    fn check_shared(&self, a: u32, b: u32, apex: [u32; 2], beside: [u32; 2]) -> Result<(), CollapseError> {
        // The triangles that hold both ends are those beside the edge.
        let large = |h: u32| {
            let f = self.face[h as usize];
            (f != NONE && !self.is_triangle(h) && !beside.contains(&f)).then_some(f)
        };
        let (mut near, mut faces) = (Slots::new(), Slots::new());
        for h in self.outgoing_slots(b) {
            if near.len() == HUB && self.shares_nothing(a, b, apex, beside) {
                return Ok(());
            }
            near.push(self.target_slot(h));
            faces.extend(large(h));
        }
        if near.len() <= HUB
            && self.outgoing_slots(a).nth(HUB).is_some()
            && self.shares_nothing(b, a, apex, beside)
        {
            return Ok(());
        }
        let is_long = near.len() > 16;
        if is_long {
            near.sort_unstable();
            faces.sort_unstable();
        }
        let has =
            |list: &Slots, x: u32| if is_long { list.binary_search(&x).is_ok() } else { list.contains(&x) };
        let neighbors = self.outgoing_slots(a).map(|h| self.target_slot(h));
        if let Some(v) = neighbors.filter(|v| !apex.contains(v)).find(|&v| has(&near, v)) {
            return Err(CollapseError::CommonNeighbor(self.vertices.key(v)));
        }
        if faces.is_empty() {
            return Ok(());
        }
        match self.outgoing_slots(a).filter_map(large).find(|&f| has(&faces, f)) {
            Some(f) => Err(CollapseError::CommonFace(self.faces.key(f))),
            None => Ok(()),
        }
    }

    /// Whether a vertex of few edges is quickly seen to share neither a neighbour nor a large face with a hub, but for
    /// these: each neighbour and face is asked, not the hub. `false` says nothing.
    fn shares_nothing(&self, v: u32, hub: u32, apex: [u32; 2], beside: [u32; 2]) -> bool {
        let is_apart = |h: u32| {
            let (n, f) = (self.target_slot(h), self.face[h as usize]);
            (n == hub || apex.contains(&n) || self.find_slot(n, hub).is_none())
                && (f == NONE
                    || beside.contains(&f)
                    || self.is_triangle(h)
                    || self.loop_slots(h).all(|h| self.origin[h as usize] != hub))
        };
        self.outgoing_slots(v).enumerate().all(|(i, h)| i < HUB && is_apart(h))
    }

    /// The two faces across the other edges of the triangle at `h`, if they would have the same corners once `a` is `b`.
    fn would_coincide(&self, h: u32, a: u32, b: u32) -> Option<[u32; 2]> {
        // One is read forwards from the apex, the other backwards, until both come to the merged vertex.
        let (mut f, mut g) = (self.prev[h as usize] ^ 1, self.next[h as usize] ^ 1);
        let faces = [self.face[f as usize], self.face[g as usize]];
        if faces.contains(&NONE) {
            return None;
        }
        loop {
            f = self.next[f as usize];
            g = self.prev[g as usize];
            let ends = [self.target_slot(f), self.origin[g as usize]];
            match ends.map(|v| v == a || v == b) {
                [true, true] => return Some(faces),
                [false, false] if ends[0] == ends[1] => {}
                _ => return None,
            }
        }
    }

    /// Takes the half-edge of a collapsing edge out of its face, whose other corners are linked; a triangle goes, and
    /// its two other edges become one. `leaves` tells whether `h` starts at the vertex that goes. Returns a half-edge
    /// that starts at `b`.
    fn close_side(&mut self, h: u32, b: u32, leaves: bool, done: &mut Collapsed) -> u32 {
        let (p, n) = (self.prev[h as usize], self.next[h as usize]);
        let f = self.face[h as usize];
        if !self.is_triangle(h) {
            self.link(p, n);
            if f != NONE && self.face_halfedge[f as usize] == h {
                self.set_face_halfedge(f, n);
            }
            return n;
        }
        // The edge between apex and survivor stays: its half-edge in the triangle takes the place of the other edge's
        // outer half-edge.
        let (stays, goes) = if leaves { (n, p) } else { (p, n) };
        let outer = goes ^ 1;
        let (g, apex) = (self.face[outer as usize], self.origin[p as usize]);
        self.mix(Kind::Edge, Event::Merge, stays >> 1, &[(stays >> 1, 0.5), (goes >> 1, 0.5)]);
        if g != NONE {
            self.copy_corner(outer, stays);
            if self.face_halfedge[g as usize] == outer {
                self.set_face_halfedge(g, stays);
            }
        } else {
            self.reset_corner(stays);
        }
        self.set_face(stays, g);
        let (before, after) = (self.prev[outer as usize], self.next[outer as usize]);
        self.link(before, stays);
        self.link(stays, after);
        // Of the two half-edges that left the apex, one is gone.
        let (gone, instead) = if leaves { (goes, stays ^ 1) } else { (outer, stays) };
        if self.vertex_halfedge[apex as usize] == gone {
            self.set_vertex_halfedge(apex, instead);
        }
        done.dead_edges.push(self.drop_edge(goes >> 1, Some(stays >> 1)));
        done.dead_faces.push(self.drop_face(f, None));
        if self.origin[stays as usize] == b { stays } else { stays ^ 1 }
    }

    /// Finds the half-edge of a vertex anew, given one that starts there: the boundary half-edge if there is one.
    pub(super) fn settle(&mut self, v: u32, out: u32) {
        let mut h = out;
        loop {
            if self.is_open(h) {
                break;
            }
            h = self.next[h as usize ^ 1];
            if h == out {
                break;
            }
        }
        if self.vertex_halfedge[v as usize] != h {
            self.set_vertex_halfedge(v, h);
        }
    }

    /// Merges the corners at the two ends of `h`, each column within its own seams.
    ///
    /// The corners in the face on either side of the edge become one, and with them all corners around either end that
    /// hold the same value without a seam between. Other corners keep theirs. Where the two sides hold the same value at
    /// one end, a seam along the edge ends there: both sides become one, and the seam ends at the merged vertex.
    fn merge_wedges(&mut self, h: u32, share: f64) {
        // Clockwise from the edge, each end sees its own side's faces: those of `a` begin to the right, those of `b` to
        // the left.
        let ring = |first: u32| -> Slots {
            let start = self.next[first as usize ^ 1];
            std::iter::successors(Some(start), |&h| Some(self.next[h as usize ^ 1]))
                .take_while(|&h| h != first)
                .collect()
        };
        let (at_a, at_b) = (ring(h), ring(h ^ 1));
        let open = |ring: &Slots| -> SmallVec<[bool; 12]> { ring.iter().map(|&h| self.is_open(h)).collect() };
        let (open_a, open_b) = (open(&at_a), open(&at_b));
        // The corners of `b` and `a` in the left face: that of `a` is at `h` itself, that of `b` first in its ring. In the
        // right face it is the other way round.
        let left = (!self.is_open(h)).then(|| [at_b[0], h]);
        let right = (!self.is_open(h ^ 1)).then(|| [h ^ 1, at_a[0]]);
        let undo = &mut self.undo;
        for (i, column) in self.columns.on(Kind::Corner) {
            let column = column.as_mut();
            let wedges = |[b, a]: [u32; 2], is_left: bool, column: &dyn Dense| -> Slots {
                let (a_run, b_run) = (at_a.iter().zip(&open_a), at_b.iter().zip(&open_b));
                if is_left {
                    run(column, a, a_run.rev()).chain(run(column, b, b_run)).collect()
                } else {
                    run(column, a, a_run).chain(run(column, b, b_run.rev())).collect()
                }
            };
            // Read before anything is written: a wedge may reach around to the other side.
            let all = [left.map(|l| wedges(l, true, column)), right.map(|r| wedges(r, false, column))];
            let mut write = |slot: u32, column: &mut dyn Dense, how: &dyn Fn(&mut dyn Dense)| {
                if let Some(undo) = undo {
                    undo.push(Field::Value(Kind::Corner), slot, i);
                    column.remember(slot);
                }
                how(column);
            };
            if let (Some(l), Some(r)) = (left, right)
                && (column.is_same(l[0], r[0]) || column.is_same(l[1], r[1]))
            {
                let mut sources: SmallVec<[(u32, f64); 4]> = SmallVec::new();
                for (i, weight) in [(0, 1.0 - share), (1, share)] {
                    if column.is_same(l[i], r[i]) {
                        sources.push((l[i], weight));
                    } else {
                        sources.extend([(l[i], weight / 2.0), (r[i], weight / 2.0)]);
                    }
                }
                write(l[0], column, &|c| c.mix(Event::Merge, l[0], &sources));
                for &into in all.iter().flatten().flatten().filter(|&&into| into != l[0]) {
                    write(into, column, &|c| c.copy(l[0], into));
                }
                continue;
            }
            for ([b, a], wedge) in
                [left, right].into_iter().zip(&all).filter_map(|(s, w)| Some((s?, w.as_ref()?)))
            {
                write(b, column, &|c| c.mix(Event::Merge, b, &[(b, 1.0 - share), (a, share)]));
                for &into in wedge.iter().filter(|&&into| into != b) {
                    write(into, column, &|c| c.copy(b, into));
                }
            }
        }
    }
}

/// The corners at the beginning of a ring that hold the same value as `first`, up to a seam or the boundary; `first` itself
/// whatever it holds.
fn run<'a>(
    column: &dyn Dense,
    first: u32,
    ring: impl Iterator<Item = (&'a u32, &'a bool)>,
) -> impl Iterator<Item = u32> {
    let same: Slots = ring
        .take_while(|&(&h, &open)| !open && (h == first || column.is_same(first, h)))
        .map(|(&h, _)| h)
        .collect();
    same.into_iter()
}
