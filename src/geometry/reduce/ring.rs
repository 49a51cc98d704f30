//! What lies around an end of an edge, before and after a collapse.

use super::features::{Hold, weight};
use super::part::Part;
use super::quadric::Planes;
use super::{HEAVY, Refusal, attempt::Guards};
use glam::DVec3;

/// An edge around an end, and the face to its right, between this edge and the next.
#[derive(Clone, Copy, Default)]
pub(super) struct Spoke {
    pub(super) halfedge: u32,
    pub(super) end: u32,
    /// Where the other end is, seen from the middle of the edge that collapses.
    place: DVec3,
    /// Twice the area vector of the face and its square; of the last spoke's nothing.
    area: DVec3,
    square: f64,
    /// The same after the collapse.
    later: DVec3,
    later_square: f64,
}

/// The edges around an end, clockwise, the collapsing one first.
pub(super) struct Ring {
    /// Room for as many as there may be.
    room: Vec<Spoke>,
    count: usize,
    /// Where the end is, seen from the middle of the edge.
    at: DVec3,
    /// Twice the area vectors of the faces that stay, summed.
    area: DVec3,
    /// Whether nothing holds the vertices around.
    pub(super) is_plain: bool,
}

impl Default for Ring {
    fn default() -> Self {
        let room = vec![Spoke::default(); HEAVY as usize + 1];
        Self { room, count: 0, at: DVec3::ZERO, area: DVec3::ZERO, is_plain: false }
    }
}

impl Ring {
    #[inline(always)]
    pub(super) fn spokes(&self) -> &[Spoke] {
        &self.room[..self.count]
    }

    /// All but the edge that collapses.
    #[inline(always)]
    pub(super) fn others(&self) -> &[Spoke] {
        self.spokes().get(1..).unwrap_or_default()
    }

    pub(super) fn clear(&mut self) {
        self.count = 0;
    }

    /// Walks around the origin of `first`, which lies at `at`, both seen from `middle`. Whether there is room for it.
    #[inline]
    pub(super) fn walk(&mut self, part: &Part<'_>, first: u32, middle: DVec3, at: DVec3) -> bool {
        (self.count, self.at, self.area, self.is_plain) = (0, at, DVec3::ZERO, true);
        let base = middle + at;
        let (mut h, mut before, mut count) = (first, DVec3::ZERO, 0);
        loop {
            let Some(spoke) = self.room.get_mut(count) else { return false };
            let (end, after) = part.around(h);
            let spot = part.spot(end);
            (spoke.halfedge, spoke.end) = (h, end);
            spoke.place = spot.position - middle;
            let seen = spot.position - base;
            self.is_plain &= spot.hold() == Hold::Free;
            if let Some(last) = count.checked_sub(1) {
                let area = seen.cross(before);
                let last = &mut self.room[last];
                (last.area, last.square) = (area, area.length_squared());
                if count > 1 {
                    self.area += area;
                }
            }
            before = seen;
            count += 1;
            h = after;
            if h == first {
                self.count = count;
                return true;
            }
        }
    }

    /// Whether nothing holds the end itself.
    #[inline]
    fn is_free(&self, part: &Part<'_>) -> bool {
        self.spokes().first().is_some_and(|s| part.spot(part.origin(s.halfedge)).hold() == Hold::Free)
    }

    /// Whether the faces that stay are in order once their common corner is at `place`.
    #[inline]
    pub(super) fn check(&mut self, part: &Part<'_>, place: DVec3, guards: Guards) -> Result<(), Refusal> {
        let spokes = &mut self.room[..self.count];
        let [first, rest @ ..] = spokes else { return Ok(()) };
        let end = first.place;
        let mut rest = rest.iter_mut();
        let Some(mut spoke) = rest.next() else { return Ok(()) };
        let mut v = spoke.place - place;
        let mut v_squared = v.length_squared();
        for next in rest {
            let u = next.place - place;
            let (u_squared, far) = (u.length_squared(), (u - v).length_squared());
            let after = u.cross(v);
            let (dot, was, is) = (after.dot(spoke.area), spoke.square, after.length_squared());
            (spoke.later, spoke.later_square) = (after, is);
            // What had no area cannot fold.
            if was > 0.0
                && (dot <= 0.0 || dot * dot < guards.turn * was * is)
                && !part.is_open(spoke.halfedge ^ 1)
            {
                return Err(Refusal::Flip);
            }
            let sides = u_squared + v_squared + far;
            if is_thin(is, sides, guards.shape) && !part.is_open(spoke.halfedge ^ 1) {
                let [u, v] = [next.place + end, spoke.place + end];
                let old_sides = u.length_squared() + v.length_squared() + far;
                if was * old_sides.powi(-2) > is * sides.powi(-2) {
                    return Err(Refusal::Shape);
                }
            }
            (v, v_squared, spoke) = (u, u_squared, next);
        }
        Ok(())
    }

    /// Exchanges the planes of the faces around this end in the vertices around, and returns those of the new faces.
    /// `takes` tells whether the planes of the faces that are gone are taken out of their third corners.
    #[inline]
    pub(super) fn exchange(&self, part: &mut Part<'_>, takes: bool) -> Planes {
        let (mut fan, mut carried) = (Planes::default(), Planes::default());
        let [first, others @ ..] = self.spokes() else { return fan };
        let [others @ .., last] = others else { return fan };
        if takes {
            carried = carried - Planes::one(first.area, weight(first.square));
        }
        for spoke in others {
            let after = Planes::one(spoke.later, weight(spoke.later_square));
            let change = after - Planes::one(spoke.area, weight(spoke.square));
            fan = fan + after;
            let slot = part.fan_mut(spoke.end);
            *slot = *slot + (carried + change);
            carried = change;
        }
        if takes {
            let left = self.left();
            carried = carried - Planes::one(left, weight(left.length_squared()));
        }
        let slot = part.fan_mut(last.end);
        *slot = *slot + carried;
        fan
    }

    /// Twice the area vectors of the two faces that go, to the right and to the left of the edge.
    #[inline]
    fn right(&self) -> DVec3 {
        self.spokes().first().map_or(DVec3::ZERO, |spoke| spoke.area)
    }

    #[inline]
    fn left(&self) -> DVec3 {
        self.spokes().last().map_or(DVec3::ZERO, |spoke| (-self.at - self.at).cross(spoke.place - self.at))
    }
}

/// Whether a triangle is further from equilateral than allowed: `2 √3 |cross| / (sum of squared sides)` is 1 there, and 0
/// without area.
#[inline]
fn is_thin(cross_squared: f64, sides_squared: f64, shape: f64) -> bool {
    12.0 * cross_squared < shape * shape * sides_squared * sides_squared
}

/// How far the volume would be off with the vertex at the place, and how that changes with the place; nothing where it is
/// held.
#[inline]
pub(super) fn volume(part: &Part<'_>, goes: &Ring, stays: &Ring, place: DVec3) -> Option<(f64, DVec3)> {
    if !goes.is_free(part) || !stays.is_free(part) {
        return None;
    }
    let gradient = goes.area + stays.area + goes.right() + goes.left();
    let missing = stays.area.dot(stays.at) + goes.area.dot(goes.at) - gradient.dot(place);
    Some((missing, gradient))
}
