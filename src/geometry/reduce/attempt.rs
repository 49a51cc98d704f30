//! One collapse on the copy: whether it is legal, whether it folds or flattens faces, and the links afterwards.

use super::Refusal;
use super::part::Part;
use super::place::{Candidate, Way};
use super::quadric::Planes;
use super::ring::{Ring, Spoke, volume};
use glam::DVec3;

/// What the shape of faces must be after a collapse.
#[derive(Clone, Copy)]
pub(super) struct Guards {
    /// The square of the cosine of the angle by which a face may turn.
    pub(super) turn: f64,
    /// The least shape of a triangle, from 0 to 1, unless it was no better before.
    pub(super) shape: f64,
    /// The greatest error, in local units.
    pub(super) error: f64,
    /// How much the planes along feature edges count.
    pub(super) line_weight: f64,
}

/// Room to work in.
#[derive(Default)]
pub(super) struct Scratch {
    /// Around the vertex that goes.
    pub(super) goes: Ring,
    /// Around the one that stays; empty if that has too many edges to walk around.
    pub(super) stays: Ring,
    /// The vertices around that, but for the other end.
    ends: Vec<u32>,
}

impl Part<'_> {
    /// Collapses an edge, or says why not. Returns the half-edge from the vertex that is gone to the one that is left.
    pub(super) fn attempt(
        &mut self,
        e: u32,
        mut candidate: Candidate,
        guards: Guards,
        scratch: &mut Scratch,
    ) -> Result<u32, Refusal> {
        let halfedge = match candidate.way {
            Way::ToOrigin => 2 * e + 1,
            Way::Anywhere | Way::ToTarget => 2 * e,
        };
        // Where the target is, seen from the middle.
        let to = if halfedge & 1 == 0 { candidate.half } else { -candidate.half };
        self.check_links(halfedge, candidate.middle, to, scratch)?;
        let (goes, stays) = (&mut scratch.goes, &mut scratch.stays);
        if candidate.way == Way::Anywhere {
            candidate.keep_volume(self, goes, stays);
            stays.check(self, candidate.place, guards)?;
        }
        goes.check(self, candidate.place, guards)?;
        let [a, b] = self.edge(e).ends();
        let memory = match (self.memory_mut(a).copied(), self.memory_mut(b).copied()) {
            (Some(a), Some(b)) => {
                let memory = candidate.memory(&a, &b);
                if candidate.error(&memory) > guards.error {
                    return Err(Refusal::ErrorBound);
                }
                Some(memory)
            }
            _ => None,
        };
        // Away from features the planes of the faces that change are exchanged, which is less than to sum up anew.
        let is_plain = candidate.way == Way::Anywhere && goes.is_plain && stays.is_plain;
        let fan = if is_plain {
            let around = goes.exchange(self, true);
            around + stays.exchange(self, false)
        } else {
            Planes::default()
        };
        let first = self.join(halfedge, &candidate, &scratch.goes);
        let v = self.origin(first);
        if let (Some(memory), Some(slot)) = (memory, self.memory_mut(v)) {
            *slot = memory;
        }
        if is_plain {
            *self.fan_mut(v) = fan;
        } else {
            self.look_again(first, guards.line_weight);
        }
        Ok(halfedge)
    }

    /// The conditions of [`Mesh::check_collapse`](crate::Mesh::check_collapse), for triangles; walks around the ends.
    #[inline]
    fn check_links(&self, h: u32, middle: DVec3, to: DVec3, scratch: &mut Scratch) -> Result<(), Refusal> {
        let t = h ^ 1;
        let (a, b) = (self.origin(h), self.origin(t));
        if !self.is_open(h) && !self.is_open(t) && self.spot(a).is_open() && self.spot(b).is_open() {
            return Err(Refusal::Topology);
        }
        for h in [h, t] {
            if self.is_open(h) {
                continue;
            }
            let n = self.next(h);
            let p = self.next(n);
            // The last face of the third corner; two features that would become one; two faces back to back, because three
            // edges meet in that corner.
            if self.is_open(n ^ 1) && self.is_open(p ^ 1) {
                return Err(Refusal::Topology);
            }
            if self.is_feature(n) && self.is_feature(p) {
                return Err(Refusal::Feature);
            }
            if !self.is_open(n ^ 1) && !self.is_open(p ^ 1) && self.spot(self.origin(p)).valence() == 3 {
                return Err(Refusal::Topology);
            }
        }
        let sides = 2 - usize::from(self.is_open(h)) - usize::from(self.is_open(t));
        let (goes, stays) = (&mut scratch.goes, &mut scratch.stays);
        if !goes.walk(self, h, middle, -to) {
            return Err(Refusal::Valence);
        }
        if self.spot(b).is_heavy() {
            if !self.is_whole {
                // Its neighbours' neighbours may be in another part.
                return Err(Refusal::Valence);
            }
            stays.clear();
            return self.check_heavy(h, goes.others(), sides);
        }
        if !stays.walk(self, t, middle, to) {
            return Err(Refusal::Valence);
        }
        let theirs = &mut scratch.ends;
        theirs.clear();
        theirs.extend(stays.others().iter().map(|spoke| spoke.end));
        let others = goes.others().iter().map(|spoke| spoke.end);
        let common: usize = if others.len() * theirs.len() <= 1024 {
            others.map(|v| theirs.iter().map(|&w| u32::from(w == v)).sum::<u32>() as usize).sum()
        } else {
            theirs.sort_unstable();
            others.filter(|v| theirs.binary_search(v).is_ok()).count()
        };
        if common == sides { Ok(()) } else { Err(Refusal::Topology) }
    }

    /// The link condition from the side of the end that goes: whether any neighbour is a neighbour of the other end.
    fn check_heavy(&self, h: u32, spokes: &[Spoke], sides: usize) -> Result<(), Refusal> {
        let t = h ^ 1;
        let b = self.origin(t);
        let mut common = 0;
        for spoke in spokes.iter().map(|spoke| spoke.halfedge) {
            if self.spot(self.origin(spoke ^ 1)).is_heavy() {
                let is_left = !self.is_open(h) && spoke ^ 1 == self.prev(h);
                let is_right = !self.is_open(t) && spoke == self.next(t);
                if !is_left && !is_right {
                    return Err(Refusal::Valence);
                }
                common += 1;
                continue;
            }
            let mut around = spoke ^ 1;
            loop {
                let (end, after) = self.around(around);
                common += usize::from(end == b);
                around = after;
                if around == spoke ^ 1 {
                    break;
                }
            }
        }
        if common == sides { Ok(()) } else { Err(Refusal::Topology) }
    }

    /// Sums up the planes anew around a vertex that has changed and its neighbours, those of many edges aside.
    fn look_again(&mut self, first: u32, line_weight: f64) {
        if self.spot(self.origin(first)).is_heavy() {
            return;
        }
        self.sum_again(first, line_weight);
        let mut h = first;
        loop {
            self.sum_again(h ^ 1, line_weight);
            h = self.next(h ^ 1);
            if h == first {
                return;
            }
        }
    }

    /// Those of a seam are summed up when the parts come together.
    pub(super) fn sum_again(&mut self, first: u32, line_weight: f64) {
        let v = self.origin(first);
        if !self.spot(v).is_heavy() && !self.spot(v).is_seam() {
            *self.fan_mut(v) = self.fan_around(first, line_weight);
        }
    }

    /// Merges the origin of `h` into its target, as [`Mesh::collapse`](crate::Mesh::collapse) does; returns a half-edge
    /// that starts there.
    fn join(&mut self, h: u32, candidate: &Candidate, goes: &Ring) -> u32 {
        let t = h ^ 1;
        let (a, b) = (self.origin(h), self.origin(t));
        let before = self.removed;
        // One of them is closed, and what stays there starts or ends at the target.
        let mut left = h;
        for (h, leaves) in [(h, true), (t, false)] {
            let n = self.next(h);
            if self.is_open(h) {
                let p = self.prev(h);
                self.link(p, n);
                self.spot_mut(b).link = p;
            } else {
                let p = self.next(n);
                let (stays, gone) = if leaves { (n, p) } else { (p, n) };
                let apex = self.origin(p);
                let spot = self.spot_mut(apex);
                spot.set_valence(spot.valence() - 1);
                self.replace(gone ^ 1, stays);
                left = if leaves { stays } else { stays ^ 1 };
                self.removed += 1;
            }
        }
        self.bury(h >> 1);
        for spoke in goes.spokes() {
            self.set_origin(spoke.halfedge, b);
        }
        let faces = (self.removed - before) as u32;
        let dead = self.spot(a).valence();
        self.spot_mut(a).go_into(b);
        let spot = self.spot_mut(b);
        spot.set_valence(spot.valence() + dead - 2 - faces);
        if candidate.way == Way::Anywhere {
            spot.move_to(candidate.middle + candidate.place);
        }
        left
    }
}

impl Candidate {
    /// Moves the place, at the least cost, to where the collapse changes no volume (Lindstrom and Turk, "Fast and memory
    /// efficient polygonal simplification", 1998), if that is near.
    #[inline]
    fn keep_volume(&mut self, part: &Part<'_>, goes: &Ring, stays: &Ring) {
        let Some(factors) = self.factors else { return };
        let Some((missing, gradient)) = volume(part, goes, stays, self.place) else { return };
        let direction = factors.solve(gradient);
        let per_step = gradient.dot(direction);
        if per_step > 0.0 {
            let step = direction * (missing / per_step);
            if step.length_squared() < self.half.length_squared() {
                self.place += step;
            }
        }
    }
}
