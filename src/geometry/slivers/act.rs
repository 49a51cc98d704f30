//! The changes themselves, each made of operators.

use super::run::{Done, Run};
use super::shape::{Corners, share, to_segment};
use super::{SliverAction, SliverKind, SliverObstacle};
use crate::{CollapseError, RemoveFaceError};
use glam::DVec3;

/// A vertex with more edges is not moved if another will do: looking all around it each time would be quadratic.
const HEAVY: usize = 512;
/// In larger faces diagonals are not tried one by one.
const MANY_CORNERS: usize = 32;

impl Run {
    /// Resolves a sliver, or says what is in the way.
    pub(super) fn attempt(
        &mut self,
        f: u32,
        kind: SliverKind,
        corner: usize,
    ) -> Result<Done, SliverObstacle> {
        let first = self.mesh.face_halfedge[f as usize];
        let h = self.mesh.loop_slots(first).nth(corner).unwrap_or(first);
        let done = match kind {
            SliverKind::Needle => self.shrink_any(f),
            SliverKind::Cap => self.merge(h),
            SliverKind::Flat => return self.cut(f),
        };
        // Gentler means first.
        done.or_else(|obstacle| {
            let is_triangle = self.mesh.is_triangle(self.mesh.face_halfedge[f as usize]);
            if self.stage == 0 || !is_triangle { Err(obstacle) } else { self.collapse_any(f, obstacle) }
        })
    }

    /// Collapses one of the short edges of a face, the shortest first.
    fn shrink_any(&mut self, f: u32) -> Result<Done, SliverObstacle> {
        let mut short = self.edges_of(f);
        short.retain(|e| f64::from_bits(e.0) <= self.gauge.tolerance);
        let mut refused = SliverObstacle::Topology;
        for (i, (_, h)) in short.into_iter().enumerate() {
            match self.shrink(h) {
                Ok(done) => return Ok(done),
                Err(obstacle) if i == 0 => refused = obstacle,
                Err(_) => {}
            }
        }
        Err(refused)
    }

    /// The edges of a face by length, whose bits order as it does.
    fn edges_of(&self, f: u32) -> Vec<(u64, u32)> {
        let length = |h: u32| {
            let [a, b] = [h, h ^ 1].map(|h| self.at(self.mesh.origin[h as usize]));
            a.distance(b).to_bits()
        };
        let loop_ = self.mesh.loop_slots(self.mesh.face_halfedge[f as usize]);
        let mut edges: Vec<(u64, u32)> = loop_.map(|h| (length(h), h)).collect();
        edges.sort_unstable();
        edges
    }

    /// Collapses a short edge in the better direction.
    fn shrink(&mut self, h: u32) -> Result<Done, SliverObstacle> {
        let rank = |h: u32| {
            let [goes, stays] = [h, h ^ 1].map(|h| self.mesh.origin[h as usize]);
            let leaves_boundary = self.mesh.is_open_vertex(goes) && !self.mesh.is_open_vertex(stays);
            let valence = self.mesh.outgoing_slots(goes).count();
            (leaves_boundary, valence > HEAVY, valence)
        };
        let mut ways = [(rank(h), h), (rank(h ^ 1), h ^ 1)];
        self.gauge.work += (ways[0].0.2 + ways[1].0.2) as u64;
        ways.sort_unstable();
        let is_free = ways.iter().all(|w| !w.0.0 && !w.0.1);
        if is_free
            && let [Ok(one), Ok(other)] = [ways[0].1, ways[1].1].map(|h| self.judge_collapse(h, false))
            && other.strays < one.strays
        {
            ways.swap(0, 1);
        }
        let first = self.collapse(ways[0].1);
        first.or_else(|obstacle| self.collapse(ways[1].1).map_err(|_| obstacle))
    }

    /// Collapses a half-edge into its target, if that is fit and legal.
    fn collapse(&mut self, h: u32) -> Result<Done, SliverObstacle> {
        let at_last = self.stage == 2;
        let mut verdict = self.judge_collapse(h, at_last)?;
        let key = self.mesh.halfedge_key(h);
        let position = self.mesh.at(h ^ 1);
        for _ in 0..8 {
            let refusal = match self.mesh.check_collapse(key, position) {
                Ok(()) => {
                    let done = self.mesh.collapse_checked(h, position);
                    let vertex = self.mesh.vertex_slot(done.vertex);
                    return Ok(Done {
                        action: SliverAction::Collapsed,
                        moved: verdict.moved,
                        changed: verdict.faces,
                        born: Vec::new(),
                        vertex,
                    });
                }
                Err(refusal) => refusal,
            };
            if let CollapseError::LastFace(_) = refusal {
                return self.take_off_at(h);
            }
            if self.stage == 0 || !self.clear_collapse(h, refusal) {
                return Err(match refusal {
                    CollapseError::BetweenBoundaries(_) => SliverObstacle::Pinch,
                    _ => SliverObstacle::Topology,
                });
            }
            verdict = self.judge_collapse(h, at_last)?;
        }
        Err(SliverObstacle::Topology)
    }

    /// Collapses any edge of a triangle, the shortest first, whichever moves the surface little enough.
    fn collapse_any(&mut self, f: u32, refused: SliverObstacle) -> Result<Done, SliverObstacle> {
        let ways = self.edges_of(f).into_iter().flat_map(|(_, h)| [h, h ^ 1]);
        for h in ways {
            if let Ok(done) = self.collapse(h) {
                return Ok(done);
            }
        }
        Err(refused)
    }

    /// Merges the corner of a cap into the face across its longest edge.
    fn merge(&mut self, h: u32) -> Result<Done, SliverObstacle> {
        let t = h ^ 1;
        if self.mesh.is_open(t) {
            return self.take_off(self.mesh.face[h as usize]);
        }
        let mut verdict = self.judge_merge(h)?;
        if !self.is_merge_legal(h) {
            if self.stage == 0 || !self.clear_merge(h) || !self.is_merge_legal(h) {
                return Err(SliverObstacle::Topology);
            }
            verdict = self.judge_merge(h)?;
        }
        let c = self.mesh.origin[self.mesh.prev[h as usize] as usize];
        let [a, b] = [h, t].map(|h| self.mesh.at(h));
        let apex = self.mesh.positions[c as usize];
        let [at_a, at_b, at_c] =
            [h, t, self.mesh.prev[h as usize]].map(|h| self.at(self.mesh.origin[h as usize]));
        let mut s = share(at_c, at_a, at_b);
        let on_edge = |s: f64| a * (1.0 - s) + b * s;
        if on_edge(s) == apex {
            // Data of the corner is kept only if there is a way from one to the other to measure it on.
            s *= 1.0 - f64::from(f32::EPSILON);
        }
        let edge = self.mesh.edges.key(h >> 1);
        let split = self.mesh.split_edge_and_faces(edge, on_edge(s)).map_err(|_| SliverObstacle::Topology)?;
        let born = split.cuts.iter().map(|cut| cut.face).collect();
        let short = self.mesh.find_halfedge(split.vertex, self.mesh.vertices.key(c));
        let collapsed = short.and_then(|short| self.mesh.collapse_into_target(short).ok());
        debug_assert!(collapsed.is_some(), "the merge was found legal");
        let (moved, changed) = (verdict.moved, verdict.faces);
        Ok(Done { action: SliverAction::Merged, moved, changed, born, vertex: Some(c) })
    }

    /// Whether nothing joins the corner and the face across already.
    pub(super) fn is_merge_legal(&self, h: u32) -> bool {
        let (mesh, t) = (&self.mesh, h ^ 1);
        let c = mesh.origin[mesh.prev[h as usize] as usize];
        if mesh.is_triangle(t) {
            let d = mesh.origin[mesh.prev[t as usize] as usize];
            return c != d && mesh.find_slot(c, d).is_none();
        }
        let rest = |h: u32| mesh.loop_slots(h).skip(1);
        rest(t).all(|g| mesh.origin[g as usize] != c) && mesh.is_closed_off(rest(h).chain(rest(t))).is_none()
    }

    /// Takes off the triangle beside an edge that hangs on by it alone.
    fn take_off_at(&mut self, h: u32) -> Result<Done, SliverObstacle> {
        let hangs = |h: u32| {
            let mesh = &self.mesh;
            mesh.is_triangle(h) && mesh.loop_slots(h).skip(1).all(|g| mesh.is_open(g ^ 1))
        };
        match [h, h ^ 1].into_iter().find(|&h| hangs(h)) {
            Some(h) => self.take_off(self.mesh.face[h as usize]),
            None => Err(SliverObstacle::Topology),
        }
    }

    /// Takes off a triangle at the boundary.
    fn take_off(&mut self, f: u32) -> Result<Done, SliverObstacle> {
        let first = self.mesh.face_halfedge[f as usize];
        let (open, inner): (Vec<u32>, Vec<u32>) =
            self.mesh.loop_slots(first).partition(|&h| self.mesh.is_open(h ^ 1));
        if inner.is_empty() {
            return Err(SliverObstacle::WholeComponent);
        }
        let at = |h: u32| self.at(self.mesh.origin[h as usize]);
        // What is left of the face: its inner edges.
        let off = |p: DVec3| {
            let each = inner.iter().map(|&h| to_segment(p, at(h), at(h ^ 1)));
            each.fold(f64::INFINITY, f64::min)
        };
        let moved = if open.len() == 1 {
            self.gauge.look(&self.gauge.corners(&self.mesh, f)).height
        } else {
            self.mesh.loop_slots(first).map(|h| off(at(h))).fold(0.0, f64::max)
        };
        if moved > self.gauge.tolerance && self.stage < 2 {
            return Err(SliverObstacle::Moves);
        }
        let beside = inner.iter().map(|&h| self.mesh.faces.key(self.mesh.face[h as usize ^ 1])).collect();
        let key = self.mesh.faces.key(f);
        let removed = self.mesh.remove_face(key).map_err(|refusal| match refusal {
            RemoveFaceError::Pinch(_) => SliverObstacle::Pinch,
            _ => SliverObstacle::Topology,
        })?;
        for v in removed.isolated {
            // An isolated vertex can always go.
            let _ = self.mesh.remove_vertex(v);
        }
        Ok(Done { action: SliverAction::Removed, moved, changed: vec![key], born: beside, vertex: None })
    }

    /// Cuts a larger face: along one diagonal that leaves no sliver, or into triangles.
    fn cut(&mut self, f: u32) -> Result<Done, SliverObstacle> {
        let key = self.mesh.faces.key(f);
        let corners = self.gauge.corners(&self.mesh, f);
        let normal = self.gauge.look(&corners).normal;
        let way = if corners.len() <= MANY_CORNERS { self.best_diagonal(&corners, normal) } else { None };
        let done =
            |born| Done { action: SliverAction::Cut, moved: 0.0, changed: vec![key], born, vertex: None };
        if way.is_none_or(|w| w.0 > Leaves::None) {
            if let Ok(cut) = self.mesh.triangulate_face(key) {
                return Ok(done(cut.cuts.iter().map(|c| c.face).collect()));
            }
            if normal != DVec3::ZERO && self.poke(key) {
                return Ok(done(Vec::new()));
            }
        }
        // A cap cut off a face that has height would go back into it.
        let way = way.filter(|w| w.0 < Leaves::Triangle || normal == DVec3::ZERO);
        let (_, _, ends) = way.ok_or(SliverObstacle::Topology)?;
        let first = self.mesh.face_halfedge[f as usize];
        let nth = |i: usize| self.mesh.loop_slots(first).nth(i).unwrap_or(first);
        let [from, to] = ends.map(|i| self.mesh.halfedge_key(nth(i)));
        let cut = self.mesh.split_face(from, to).map_err(|_| SliverObstacle::Topology)?;
        Ok(done(vec![cut.face]))
    }

    /// The diagonal that leaves the least to do, the shortest of several.
    fn best_diagonal(&mut self, corners: &Corners, normal: DVec3) -> Option<(Leaves, u64, [usize; 2])> {
        let n = corners.len();
        let mut best: Option<(Leaves, u64, [usize; 2])> = None;
        for (i, j) in (0..n).flat_map(|i| (i + 2..n).map(move |j| (i, j))) {
            if i == 0 && j + 1 == n || self.mesh.find_slot(corners[i].0, corners[j].0).is_some() {
                continue;
            }
            let one: Corners = corners[i..=j].iter().copied().collect();
            let other: Corners = corners[j..].iter().chain(&corners[..=i]).copied().collect();
            let leaves = [one, other].map(|part| {
                let look = self.gauge.look(&part);
                if look.fault.is_none() && look.normal.dot(normal) >= 0.0 {
                    Leaves::None
                } else if part.len() > 3 {
                    Leaves::Larger
                } else {
                    Leaves::Triangle
                }
            });
            let leaves = leaves[0].max(leaves[1]);
            let way = (leaves, corners[i].1.distance(corners[j].1).to_bits(), [i, j]);
            best = Some(best.map_or(way, |b| b.min(way)));
        }
        best
    }
}

/// The worst that a cut leaves.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Leaves {
    None,
    /// A larger face that is to be cut again.
    Larger,
    /// A triangle that is a sliver, or turned over.
    Triangle,
}
