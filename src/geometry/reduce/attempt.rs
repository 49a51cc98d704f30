//! One collapse on the copy: whether it is legal, whether it folds or flattens faces, and the links afterwards.

use super::copy::Copy;
use super::features::{Hold, plane};
use super::place::{Candidate, Way};
use super::quadric::Planes;
use super::{HEAVY, Refusal};
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

/// A collapse that was done.
pub(super) struct Done {
    /// From the vertex that is gone to the one that is left.
    pub(super) halfedge: u32,
    /// The error at the new place.
    pub(super) error: f64,
}

impl Ring {
    fn walk(&mut self, copy: &Copy, first: u32) {
        self.spokes.clear();
        self.around.clear();
        let mut h = first;
        loop {
            self.spokes.push(h);
            self.around.push(copy.origin(h ^ 1));
            h = copy.next(h ^ 1);
            if h == first {
                return;
            }
        }
    }

    /// Looks at the faces around the end at `at`.
    fn measure(&mut self, copy: &Copy, middle: DVec3, at: DVec3) {
        self.places.clear();
        self.places.extend(self.around.iter().map(|&v| copy.vertex(v).position - middle));
        self.areas.clear();
        let pairs = self.places.windows(2).map(|pair| (pair[1] - at).cross(pair[0] - at));
        self.areas.extend(pairs);
    }

    /// Twice the area vectors of the faces that stay, summed.
    fn area(&self) -> DVec3 {
        self.areas.iter().skip(1).sum()
    }

    /// Whether the faces that stay are in order once their common corner is at `place`.
    fn check(&self, copy: &Copy, place: DVec3, guards: Guards) -> Result<(), Refusal> {
        // The face between spokes i and i + 1 is to the right of spoke i; that of spoke 0 goes.
        for i in 1..self.areas.len() {
            let (u, v) = (self.places[i + 1] - place, self.places[i] - place);
            let (before, after) = (self.areas[i], u.cross(v));
            let (dot, was, is) = (after.dot(before), before.length_squared(), after.length_squared());
            // What had no area cannot fold.
            if was > 0.0
                && (dot <= 0.0 || dot * dot < guards.turn * was * is)
                && !copy.is_open(self.spokes[i] ^ 1)
            {
                return Err(Refusal::Flip);
            }
            let sides = u.length_squared() + v.length_squared();
            let far = (u - v).length_squared();
            if is_thin(is, sides + far, guards.shape) && !copy.is_open(self.spokes[i] ^ 1) {
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
}

/// Whether a triangle is further from equilateral than allowed: `2 √3 |cross| / (sum of squared sides)` is 1 there, and 0
/// without area.
fn is_thin(cross_squared: f64, sides_squared: f64, shape: f64) -> bool {
    12.0 * cross_squared < shape * shape * sides_squared * sides_squared
}

impl Copy {
    /// Collapses an edge, or says why not.
    pub(super) fn attempt(
        &mut self,
        e: u32,
        mut candidate: Candidate,
        guards: Guards,
        scratch: &mut Scratch,
    ) -> Result<Done, Refusal> {
        let halfedge = match candidate.way {
            Way::ToOrigin => 2 * e + 1,
            Way::Anywhere | Way::ToTarget => 2 * e,
        };
        self.check_links(halfedge, scratch)?;
        let (goes, stays) = (&mut scratch.goes, &mut scratch.stays);
        // The ends, seen from the middle.
        let (from, to) = if halfedge & 1 == 0 {
            (-candidate.half, candidate.half)
        } else {
            (candidate.half, -candidate.half)
        };
        goes.measure(self, candidate.middle, from);
        if candidate.way == Way::Anywhere {
            stays.measure(self, candidate.middle, to);
            candidate.keep_volume(self, goes, stays, from, to);
            stays.check(self, candidate.place, guards)?;
        }
        goes.check(self, candidate.place, guards)?;
        let ends = [2 * e, 2 * e + 1].map(|h| self.vertex(self.origin(h)));
        let memory = candidate.memory(ends[0], ends[1]);
        let error = candidate.error(&memory);
        if error > guards.error {
            return Err(Refusal::ErrorBound);
        }
        // Away from features the planes of the faces that change are exchanged, which is less than to sum up anew.
        let is_plain = candidate.way == Way::Anywhere
            && [&scratch.goes, &scratch.stays]
                .iter()
                .all(|ring| ring.around.iter().all(|&v| self.vertex(v).hold == Hold::Free));
        if is_plain {
            self.withdraw(&scratch.goes);
            self.withdraw(&scratch.stays);
        }
        let first = self.join(halfedge, &candidate, &scratch.goes);
        let vertex = self.origin(first) as usize;
        self.vertices[vertex].memory = memory;
        if is_plain {
            self.contribute(first);
        } else {
            self.look_again(first, guards.line_weight);
        }
        Ok(Done { halfedge, error })
    }

    /// The conditions of [`Mesh::check_collapse`](crate::Mesh::check_collapse), for triangles; walks around the ends.
    fn check_links(&self, h: u32, scratch: &mut Scratch) -> Result<(), Refusal> {
        let t = h ^ 1;
        let (a, b) = (self.origin(h), self.origin(t));
        if !self.is_open(h) && !self.is_open(t) && self.vertex(a).is_open && self.vertex(b).is_open {
            return Err(Refusal::Topology);
        }
        for h in [h, t] {
            let (n, p) = (self.next(h), self.prev(h));
            if self.is_open(h) {
                continue;
            }
            // The last face of its apex; two features that would become one; two faces back to back.
            if self.is_open(n ^ 1) && self.is_open(p ^ 1) {
                return Err(Refusal::Topology);
            }
            if self.edges[n as usize >> 1].is_feature && self.edges[p as usize >> 1].is_feature {
                return Err(Refusal::Feature);
            }
            let beyond = [n, p].map(|h| (!self.is_open(h ^ 1)).then(|| self.origin(self.prev(h ^ 1))));
            if beyond[0].is_some() && beyond[0] == beyond[1] {
                return Err(Refusal::Topology);
            }
        }
        let sides = 2 - usize::from(self.is_open(h)) - usize::from(self.is_open(t));
        let (goes, stays) = (&mut scratch.goes, &mut scratch.stays);
        goes.walk(self, h);
        stays.spokes.clear();
        let others = &goes.around[1..];
        if self.vertex(b).valence > HEAVY {
            // From the other side: whether any neighbour is a neighbour of `b`.
            let mut common = 0;
            for &spoke in &goes.spokes[1..] {
                if self.vertex(self.origin(spoke ^ 1)).valence > HEAVY {
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
                    common += usize::from(self.origin(around ^ 1) == b);
                    around = self.next(around ^ 1);
                    if around == spoke ^ 1 {
                        break;
                    }
                }
            }
            return if common == sides { Ok(()) } else { Err(Refusal::Topology) };
        }
        stays.walk(self, t);
        let theirs = &stays.around[1..];
        let common = if others.len() * theirs.len() <= 1024 {
            others.iter().map(|v| theirs.iter().filter(|w| *w == v).count()).sum()
        } else {
            scratch.sorted.clear();
            scratch.sorted.extend_from_slice(theirs);
            scratch.sorted.sort_unstable();
            others.iter().filter(|v| scratch.sorted.binary_search(v).is_ok()).count()
        };
        if common == sides { Ok(()) } else { Err(Refusal::Topology) }
    }

    /// Takes the planes of the faces around an end out of the vertices around. The last face belongs to the other end too,
    /// as its first.
    fn withdraw(&mut self, ring: &Ring) {
        for (&area, pair) in ring.areas.iter().zip(ring.around.windows(2)) {
            self.add(pair, plane(area, -1.0));
        }
    }

    /// Gives the planes of the faces around a new vertex to it and to the vertices around.
    fn contribute(&mut self, first: u32) {
        let v = self.origin(first);
        let at = self.vertex(v).position;
        let mut fan = Planes::default();
        let (mut h, mut end) = (first, self.origin(first ^ 1));
        let mut along = self.vertex(end).position - at;
        loop {
            h = self.next(h ^ 1);
            let next = self.origin(h ^ 1);
            let next_along = self.vertex(next).position - at;
            let face = plane(next_along.cross(along), 1.0);
            fan = fan + face;
            self.add(&[end, next], face);
            (end, along) = (next, next_along);
            if h == first {
                break;
            }
        }
        self.vertices[v as usize].fan = fan;
    }

    fn add(&mut self, vertices: &[u32], planes: Planes) {
        for &v in vertices {
            let vertex = &mut self.vertices[v as usize];
            vertex.fan = vertex.fan + planes;
        }
    }

    /// Sums up the planes anew around a vertex that has changed and its neighbours, those of many edges aside.
    fn look_again(&mut self, first: u32, line_weight: f64) {
        if self.vertex(self.origin(first)).valence > HEAVY {
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

    fn sum_again(&mut self, first: u32, line_weight: f64) {
        let v = self.origin(first) as usize;
        if self.vertices[v].valence <= HEAVY {
            self.vertices[v].fan = self.fan_around(first, line_weight);
        }
    }

    /// Merges the origin of `h` into its target, as [`Mesh::collapse`](crate::Mesh::collapse) does; returns a half-edge
    /// that starts there.
    fn join(&mut self, h: u32, candidate: &Candidate, goes: &Ring) -> u32 {
        let t = h ^ 1;
        let (a, b) = (self.origin(h), self.origin(t));
        for &spoke in &goes.spokes {
            self.set_origin(spoke, b);
        }
        let before = self.removed;
        // One of them is closed, and what stays there starts or ends at the target.
        let mut left = h;
        for (h, leaves) in [(h, true), (t, false)] {
            let (n, p) = (self.next(h), self.prev(h));
            if self.is_open(h) {
                self.link(p, n);
            } else {
                let (stays, gone) = if leaves { (n, p) } else { (p, n) };
                let apex = self.origin(p) as usize;
                self.vertices[apex].valence -= 1;
                self.replace(gone ^ 1, stays);
                left = if leaves { stays } else { stays ^ 1 };
                self.removed += 1;
            }
        }
        self.bury(h >> 1);
        let faces = (self.removed - before) as u32;
        let dead = self.vertex(a).valence;
        self.vertices[a as usize].into = b;
        let vertex = &mut self.vertices[b as usize];
        vertex.valence = vertex.valence + dead - 2 - faces;
        if candidate.way == Way::Anywhere {
            vertex.position = candidate.middle + candidate.place;
            vertex.is_moved = true;
        }
        left
    }
}

impl Candidate {
    /// Moves the place, at the least cost, to where the collapse changes no volume (Lindstrom and Turk, "Fast and memory
    /// efficient polygonal simplification", 1998), if that is near.
    fn keep_volume(&mut self, copy: &Copy, goes: &Ring, stays: &Ring, from: DVec3, to: DVec3) {
        let Some(factors) = self.factors else { return };
        let is_inside = |ring: &Ring| {
            ring.spokes.first().is_some_and(|&h| copy.vertex(copy.origin(h)).hold == Hold::Free)
        };
        if !is_inside(goes) || !is_inside(stays) {
            return;
        }
        // The two faces that go: along the edge from the end that goes, and back.
        let (Some(&left), Some(&right)) = (goes.places.last(), goes.places.get(1)) else { return };
        let along = to - from;
        let beside = along.cross(left - from) + (right - from).cross(along);
        let gradient = goes.area() + stays.area() + beside;
        let missing = goes.area().dot(from) + stays.area().dot(to) - gradient.dot(self.place);
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
