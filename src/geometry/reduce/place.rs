//! Where an edge goes, and what that costs.

use super::Refusal;
use super::features::Hold;
use super::part::{Part, Spot};
use super::quadric::{Factors, Planes, Quadric};
use glam::DVec3;

/// How strongly a vertex is drawn to the middle of its edge, as a share of the planes' weight: decides where the planes
/// do not.
const PULL: f64 = 1e-8;
/// What the length of an edge costs, as a share of its square and the planes' weight: decides where the error does not,
/// and is well above what rounding leaves of it.
const LENGTH_COST: f64 = 1e-12;

/// What rounding leaves of an error of nothing, in the same terms.
const NOISE: f64 = 1e-14;

/// Where the vertex of a collapsed edge goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    /// To where the error is least.
    Anywhere,
    /// To the target of the edge's first half-edge, which is held.
    ToTarget,
    /// To its origin.
    ToOrigin,
}

/// An edge that may be collapsed.
pub(super) struct Candidate {
    pub(super) way: Way,
    /// The middle of the edge, and the vector from there to the target.
    pub(super) middle: DVec3,
    pub(super) half: DVec3,
    /// From the middle.
    pub(super) place: DVec3,
    /// What moves the vertex at the least cost, where it is free to go.
    pub(super) factors: Option<Factors>,
    /// By which edges are ordered.
    pub(super) cost: f64,
}

impl Candidate {
    /// The planes that the new vertex would stand for, about its place.
    pub(super) fn memory(&self, a: &Quadric, b: &Quadric) -> Quadric {
        a.about(self.place + self.half) + b.about(self.place - self.half)
    }

    /// The root of the mean squared distance of the place to these planes.
    pub(super) fn error(&self, memory: &Quadric) -> f64 {
        error(memory.at(DVec3::ZERO), memory.weight(), 4.0 * self.half.length_squared())
    }
}

/// The root of the mean of squared distances, by their sum, their weight, and the square of the length they stretch over.
pub(super) fn error(sum: f64, weight: f64, length_squared: f64) -> f64 {
    let mean = sum / weight - NOISE * length_squared;
    if mean > 0.0 { mean.sqrt() } else { 0.0 }
}

/// Which end may go, by what holds the ends of the edge.
#[inline(always)]
fn way(a: &Spot, b: &Spot, is_feature: bool) -> Result<Way, Refusal> {
    let way = match (a.hold(), b.hold()) {
        (Hold::Free, Hold::Free) => Way::Anywhere,
        (Hold::Free, _) => Way::ToTarget,
        (_, Hold::Free) => Way::ToOrigin,
        (Hold::Fixed, Hold::Fixed) => return Err(Refusal::Locked),
        _ if !is_feature => return Err(Refusal::Feature),
        (Hold::Line, Hold::Line) => Way::Anywhere,
        (Hold::Line, Hold::Fixed) => Way::ToTarget,
        (Hold::Fixed, Hold::Line) => Way::ToOrigin,
    };
    // A vertex of many edges stays where it is, so that nobody has to walk around it.
    match (way, a.is_heavy(), b.is_heavy()) {
        (way, false, false) => Ok(way),
        (Way::Anywhere | Way::ToTarget, false, true) => Ok(Way::ToTarget),
        (Way::Anywhere | Way::ToOrigin, true, false) => Ok(Way::ToOrigin),
        _ => Err(Refusal::Valence),
    }
}

impl Part<'_> {
    /// What collapsing an edge would do, as far as its ends tell.
    #[inline(always)]
    pub(super) fn candidate(&self, e: u32) -> Result<Candidate, Refusal> {
        let edge = self.edge(e);
        let [a, b] = edge.ends();
        // Within a part, a vertex that does not wait has all its neighbours at hand.
        if self.spot(a.min(b)).is_seam() || self.spot(a.max(b)).is_seam() {
            return Err(Refusal::Later);
        }
        let (from, to, fan_a, fan_b) = (self.spot(a), self.spot(b), self.fan(a), self.fan(b));
        let way = way(from, to, edge.is_feature())?;
        let half = (to.position - from.position) * 0.5;
        let middle = from.position + half;
        let quadric = Planes::joined(fan_a, fan_b, half);
        let (mut place, mut factors, mut error) = (DVec3::ZERO, None, quadric.at_origin());
        match way {
            Way::ToTarget => (place, error) = (half, quadric.at(half)),
            Way::ToOrigin => (place, error) = (-half, quadric.at(-half)),
            Way::Anywhere => {
                // Far away the planes are all but parallel.
                let least =
                    quadric.least(PULL).filter(|l| l.0.length_squared() < 16.0 * half.length_squared());
                if let Some((least, how)) = least {
                    (place, factors, error) = (least, Some(how), quadric.at_least(least, PULL));
                }
            }
        }
        let weight = quadric.weight();
        let length_cost = LENGTH_COST * weight * 4.0 * half.length_squared();
        let cost = (error.max(0.0) + length_cost) * weight.sqrt();
        Ok(Candidate { way, middle, half, place, factors, cost })
    }
}
