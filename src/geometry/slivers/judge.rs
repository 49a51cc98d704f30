//! Whether a change is fit to be made: fewer or shorter slivers after it, no face turned over, no point moved too far.

use super::SliverObstacle;
use super::run::Run;
use super::shape::{Corners, Size, to_segment};
use crate::FaceKey;
use crate::matching::NONE;
use glam::DVec3;
use smallvec::SmallVec;

/// What can be said for a change.
pub(super) struct Verdict {
    /// How far the surface moves at most; scaled.
    pub(super) moved: f64,
    /// How far it moves off the planes and boundary lines that meet at the vertex; scaled.
    pub(super) strays: f64,
    /// The faces that change.
    pub(super) faces: Vec<FaceKey>,
}

/// The slivers among the faces of a change, before and after.
#[derive(Default)]
struct Balance {
    before: SmallVec<[Size; 8]>,
    after: SmallVec<[Size; 8]>,
}

impl Balance {
    /// Whether it goes down in the multiset order: what is new is less than something that is gone. That order has no
    /// endless descent (Dershowitz and Manna, "Proving termination with multiset orderings", 1979).
    fn goes_down(&mut self) -> bool {
        for list in [&mut self.before, &mut self.after] {
            list.sort_unstable_by(|a, b| b.cmp(a));
        }
        self.after < self.before
    }
}

impl Run {
    /// Judges a collapse of a half-edge into its target. `at_last`: a spike without width may be drawn in.
    pub(super) fn judge_collapse(&mut self, h: u32, at_last: bool) -> Result<Verdict, SliverObstacle> {
        let (a, b) = (self.mesh.origin[h as usize], self.mesh.target_slot(h));
        let (from, to) = (self.at(a), self.at(b));
        let length = from.distance(to);
        let is_short = length <= self.gauge.tolerance;
        let mut balance = Balance::default();
        let (mut faces, mut strays, mut has_normal) = (Vec::new(), 0.0f64, false);
        for out in self.mesh.spokes(a) {
            let f = self.mesh.face[out as usize];
            if f == NONE {
                continue;
            }
            faces.push(self.mesh.faces.key(f));
            let corners = self.gauge.corners(&self.mesh, f);
            let look = self.gauge.look(&corners);
            balance.before.extend(look.counts());
            has_normal |= look.normal != DVec3::ZERO;
            let mut after: Corners = corners.clone();
            if corners.iter().any(|c| c.0 == b) {
                after.retain(|c| c.0 != a);
                if after.len() < 3 {
                    continue;
                }
            } else {
                after.iter_mut().filter(|c| c.0 == a).for_each(|c| *c = (b, to));
            }
            let next = self.gauge.look(&after);
            balance.after.extend(next.counts());
            if look.normal != DVec3::ZERO {
                if next.normal != DVec3::ZERO && look.normal.dot(next.normal) <= 0.0 {
                    return Err(SliverObstacle::Turn);
                }
                strays = strays.max(look.normal.dot(to - from).abs());
            } else if !is_short && next.normal != DVec3::ZERO {
                // It had no height and gets some.
                return Err(SliverObstacle::Moves);
            }
        }
        strays = strays.max(self.strays_off_boundary(h));
        let moved = if is_short {
            length
        } else if has_normal {
            strays
        } else {
            self.reach(h)
        };
        let is_far = moved > self.gauge.tolerance && (has_normal || !at_last);
        // A short edge that is gone does not come back, whatever becomes of the faces beside it: no step but splits, which
        // are counted, makes vertices.
        match (is_short || balance.goes_down(), is_far) {
            (false, _) => Err(SliverObstacle::NoGain),
            (_, true) => Err(SliverObstacle::Moves),
            _ => Ok(Verdict { moved, strays, faces }),
        }
    }

    /// How far a collapse takes the boundary off its line at the vertex that goes.
    fn strays_off_boundary(&self, h: u32) -> f64 {
        let (a, b) = (self.mesh.origin[h as usize], self.mesh.target_slot(h));
        if !self.mesh.is_open_vertex(a) {
            return 0.0;
        }
        let (at, to) = (self.at(a), self.at(b));
        let out = self.mesh.vertex_halfedge[a as usize];
        let ends = [self.mesh.target_slot(out), self.mesh.origin[self.mesh.prev[out as usize] as usize]];
        let off = |end: u32| {
            let along = crate::geometry::direction(self.at(end) - at);
            (to - at).cross(along).length()
        };
        ends.into_iter().filter(|&end| end != b).map(off).fold(0.0, f64::max)
    }

    /// How far the vertex that goes is from the edges around the one that stays.
    fn reach(&mut self, h: u32) -> f64 {
        let (a, b) = (self.mesh.origin[h as usize], self.mesh.target_slot(h));
        let (from, to) = (self.at(a), self.at(b));
        let spokes = self.mesh.spokes(b);
        self.gauge.work += spokes.len() as u64;
        let ends = spokes.iter().map(|&out| self.mesh.target_slot(out)).filter(|&v| v != a);
        ends.map(|v| to_segment(from, to, self.at(v))).fold(from.distance(to), f64::min)
    }

    /// Judges the merging of a cap's corner into the face across its longest edge `h`.
    pub(super) fn judge_merge(&mut self, h: u32) -> Result<Verdict, SliverObstacle> {
        let t = h ^ 1;
        let [f, g] = [h, t].map(|h| self.mesh.face[h as usize]);
        let (a, b) = (self.mesh.origin[h as usize], self.mesh.origin[t as usize]);
        let c = self.mesh.origin[self.mesh.prev[h as usize] as usize];
        let [at_a, at_b, at_c] = [a, b, c].map(|v| self.at(v));
        let mut balance = Balance::default();
        let own = self.gauge.corners(&self.mesh, f);
        balance.before.extend(self.gauge.look(&own).counts());
        let across = self.gauge.corners(&self.mesh, g);
        let look = self.gauge.look(&across);
        balance.before.extend(look.counts());
        let mut after: SmallVec<[Corners; 2]> = SmallVec::new();
        if across.len() == 3 {
            for gone in [a, b] {
                let with = |&(v, p): &(u32, DVec3)| if v == gone { (c, at_c) } else { (v, p) };
                after.push(across.iter().map(with).collect());
            }
        } else {
            let mut all = across.clone();
            let place = all.iter().position(|p| p.0 == b).unwrap_or(0);
            all.insert(place + 1, (c, at_c));
            after.push(all);
        }
        for corners in after {
            let next = self.gauge.look(&corners);
            // A rule that cuts the larger face badly is dealt with afterwards.
            balance.after.extend(next.counts_whole());
            if next.normal != DVec3::ZERO && look.normal.dot(next.normal) < 0.0 {
                return Err(SliverObstacle::Turn);
            }
        }
        let moved = to_segment(at_c, at_a, at_b);
        if balance.goes_down() {
            let faces = vec![self.mesh.faces.key(f), self.mesh.faces.key(g)];
            Ok(Verdict { moved, strays: moved, faces })
        } else {
            Err(SliverObstacle::NoGain)
        }
    }
}
