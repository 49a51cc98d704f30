//! One collapse on the copy: whether it is legal, whether it folds or flattens faces, and the links afterwards.

use super::Refusal;
use super::features::{Hold, plane};
use super::part::Part;
use super::place::{Candidate, Way};
use super::quadric::Planes;
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

/// The edges around an end, clockwise, the collapsing one first.
#[derive(Default)]
pub(super) struct Ring {
    pub(super) spokes: Vec<u32>,
    around: Vec<u32>,
    /// Where the vertices around are, seen from the middle of the edge.
    places: Vec<DVec3>,
    /// Twice the area vectors of the faces that stay, by spoke; of those that go and on the boundary nothing.
    areas: Vec<DVec3>,
    /// The same after the collapse.
    later: Vec<DVec3>,
    /// Whether nothing holds the vertices around.
    is_plain: bool,
}

/// Room to work in.
#[derive(Default)]
pub(super) struct Scratch {
    /// Around the vertex that goes.
    pub(super) goes: Ring,
    /// Around the one that stays; empty if that has too many edges to walk around.
    pub(super) stays: Ring,
    sorted: Vec<u32>,
}

impl Ring {
    /// Walks around the origin of `first`.
    #[inline]
    fn walk(&mut self, part: &Part<'_>, first: u32, middle: DVec3) {
        self.spokes.clear();
        self.around.clear();
        self.places.clear();
        self.is_plain = true;
        let mut h = first;
        loop {
            let (v, after) = part.around(h);
            let spot = part.spot(v);
            self.spokes.push(h);
            self.around.push(v);
            self.places.push(spot.position - middle);
            self.is_plain &= spot.hold() == Hold::Free;
            h = after;
            if h == first {
                return;
            }
        }
    }

    /// Looks at the faces around the end at `at`.
    #[inline]
    fn measure(&mut self, at: DVec3) {
        self.areas.clear();
        self.areas.extend(self.places.windows(2).map(|pair| (pair[1] - at).cross(pair[0] - at)));
    }

    /// Twice the area vectors of the faces that stay, summed.
    #[inline]
    fn area(&self) -> DVec3 {
        self.areas.iter().skip(1).sum()
    }

    /// Whether the faces that stay are in order once their common corner is at `place`.
    #[inline]
    fn check(&mut self, part: &Part<'_>, place: DVec3, guards: Guards) -> Result<(), Refusal> {
        // The face between spokes i and i + 1 is to the right of spoke i; that of spoke 0 goes.
        self.later.clear();
        self.later.push(DVec3::ZERO);
        for i in 1..self.areas.len() {
            let (u, v) = (self.places[i + 1] - place, self.places[i] - place);
            let (before, after) = (self.areas[i], u.cross(v));
            self.later.push(after);
            let (dot, was, is) = (after.dot(before), before.length_squared(), after.length_squared());
            // What had no area cannot fold.
            if was > 0.0
                && (dot <= 0.0 || dot * dot < guards.turn * was * is)
                && !part.is_open(self.spokes[i] ^ 1)
            {
                return Err(Refusal::Flip);
            }
            let sides = u.length_squared() + v.length_squared();
            let far = (u - v).length_squared();
            if is_thin(is, sides + far, guards.shape) && !part.is_open(self.spokes[i] ^ 1) {
                let end = self.places[0];
                let [u, v] = [self.places[i + 1] + end, self.places[i] + end];
                let old_sides = u.length_squared() + v.length_squared() + far;
                if was * old_sides.powi(-2) > is * (sides + far).powi(-2) {
                    return Err(Refusal::Shape);
                }
            }
        }
        Ok(())
    }

    /// Exchanges the planes of the faces around this end in the vertices around, and returns those of the new faces.
    /// The planes of the faces that are `gone`, right and left, are taken out of their third corners.
    #[inline]
    fn exchange(&self, part: &mut Part<'_>, gone: Option<[Planes; 2]>) -> Planes {
        let (mut fan, mut carried) = (Planes::default(), Planes::default());
        if let Some([right, _]) = gone {
            carried = Planes::default() - right;
        }
        for i in 1..self.areas.len() {
            let after = plane(self.later[i]);
            let change = after - plane(self.areas[i]);
            fan = fan + after;
            let slot = part.fan_mut(self.around[i]);
            *slot = *slot + (carried + change);
            carried = change;
        }
        if let Some([_, left]) = gone {
            carried = carried - left;
        }
        if let Some(&last) = self.around.last() {
            let slot = part.fan_mut(last);
            *slot = *slot + carried;
        }
        fan
    }
}

/// Whether a triangle is further from equilateral than allowed: `2 √3 |cross| / (sum of squared sides)` is 1 there, and 0
/// without area.
#[inline]
fn is_thin(cross_squared: f64, sides_squared: f64, shape: f64) -> bool {
    12.0 * cross_squared < shape * shape * sides_squared * sides_squared
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
        self.check_links(halfedge, candidate.middle, scratch)?;
        let (goes, stays) = (&mut scratch.goes, &mut scratch.stays);
        // The ends, seen from the middle.
        let to = if halfedge & 1 == 0 { candidate.half } else { -candidate.half };
        let from = -to;
        goes.measure(from);
        if candidate.way == Way::Anywhere {
            stays.measure(to);
            candidate.keep_volume(self, goes, stays, to);
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
            let [right, left] = goes.gone(from);
            let around = goes.exchange(self, Some([plane(right), plane(left)]));
            around + stays.exchange(self, None)
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
    fn check_links(&self, h: u32, middle: DVec3, scratch: &mut Scratch) -> Result<(), Refusal> {
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
            // The last face of its apex; two features that would become one; two faces back to back.
            if self.is_open(n ^ 1) && self.is_open(p ^ 1) {
                return Err(Refusal::Topology);
            }
            if self.is_feature(n) && self.is_feature(p) {
                return Err(Refusal::Feature);
            }
            if !self.is_open(n ^ 1) && !self.is_open(p ^ 1) && self.apex(n ^ 1) == self.apex(p ^ 1) {
                return Err(Refusal::Topology);
            }
        }
        let sides = 2 - usize::from(self.is_open(h)) - usize::from(self.is_open(t));
        let (goes, stays) = (&mut scratch.goes, &mut scratch.stays);
        goes.walk(self, h, middle);
        if self.spot(b).is_heavy() {
            if !self.is_whole {
                // Its neighbours' neighbours may be in another part.
                return Err(Refusal::Valence);
            }
            stays.spokes.clear();
            return self.check_heavy(h, &goes.spokes[1..], sides);
        }
        stays.walk(self, t, middle);
        let (others, theirs) = (&goes.around[1..], &stays.around[1..]);
        let common = if others.len() * theirs.len() <= 1024 {
            others.iter().map(|v| theirs.iter().map(|w| usize::from(w == v)).sum::<usize>()).sum()
        } else {
            scratch.sorted.clear();
            scratch.sorted.extend_from_slice(theirs);
            scratch.sorted.sort_unstable();
            others.iter().filter(|v| scratch.sorted.binary_search(v).is_ok()).count()
        };
        if common == sides { Ok(()) } else { Err(Refusal::Topology) }
    }

    /// The link condition from the side of the end that goes: whether any neighbour is a neighbour of the other end.
    fn check_heavy(&self, h: u32, spokes: &[u32], sides: usize) -> Result<(), Refusal> {
        let t = h ^ 1;
        let b = self.origin(t);
        let mut common = 0;
        for &spoke in spokes {
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
        for &spoke in &goes.spokes {
            self.set_origin(spoke, b);
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

impl Ring {
    /// Twice the area vectors of the two faces that go, to the right and to the left of the first spoke, whose origin is at
    /// `at`.
    #[inline]
    fn gone(&self, at: DVec3) -> [DVec3; 2] {
        let (Some(&right), Some(&left)) = (self.places.get(1), self.places.last()) else {
            return [DVec3::ZERO; 2];
        };
        let along = -at - at;
        [(right - at).cross(along), along.cross(left - at)]
    }
}

impl Candidate {
    /// Moves the place, at the least cost, to where the collapse changes no volume (Lindstrom and Turk, "Fast and memory
    /// efficient polygonal simplification", 1998), if that is near.
    #[inline]
    fn keep_volume(&mut self, part: &Part<'_>, goes: &Ring, stays: &Ring, to: DVec3) {
        let Some(factors) = self.factors else { return };
        let is_inside = |ring: &Ring| {
            ring.spokes.first().is_some_and(|&h| part.spot(part.origin(h)).hold() == Hold::Free)
        };
        if !is_inside(goes) || !is_inside(stays) {
            return;
        }
        let [right, left] = goes.gone(-to);
        let gradient = goes.area() + stays.area() + right + left;
        let missing = stays.area().dot(to) - goes.area().dot(to) - gradient.dot(self.place);
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
