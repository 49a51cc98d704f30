//! Long loops: ears, the shortest diagonal first.
//!
//! The loop is looked at along its area vector. An ear is good if its tip is convex there and no reflex corner lies in its
//! triangle (reflex corners lie in a grid); an ear that is blocked waits for the corner that blocks it. Where no ear is
//! good, because the loop crosses itself when looked at like this, the blocked ones come next, then reflex tips, then
//! triangles without area. What is left in the end is triangulated with least weight.

use super::minimal::{Pace, lightest};
use super::ring::{Ears, Ring};
use crate::Cancelled;
use crate::geometry::direction;
use crate::geometry::triangulate::Grid;
use glam::DVec2;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// So many corners are left to the cubic method; fewer where there are many loops.
pub(super) const LAST: usize = 96;
pub(super) const LAST_OF_MANY: usize = 16;

/// How good an ear is, then the squared length of its diagonal, then its tip; and how often the tip was looked at before.
type Entry = Reverse<(u8, u32, u32, u32)>;

const GOOD: u8 = 0;
const BLOCKED: u8 = 1;
const REFLEX: u8 = 2;
const FLAT: u8 = 3;

struct Clipper<'r> {
    ring: &'r Ring,
    plane: Vec<DVec2>,
    next: Vec<u32>,
    prev: Vec<u32>,
    reflex: Vec<bool>,
    grid: Grid,
    heap: BinaryHeap<Entry>,
    /// How often each tip was looked at; entries of the heap that say otherwise are stale.
    looks: Vec<u32>,
    /// Tips that wait for a corner to go or to turn convex.
    waiting: Vec<Vec<u32>>,
    /// Corners in grid cells that may still be looked at: a loop from life takes a tenth of it, one made to be slow stops
    /// being looked at.
    budget: usize,
}

/// A triangulation of a long loop; `None` if it came to where every ear needs an edge that is there already. O(n log n) on
/// loops from life, and cubic in the `last` corners.
pub(super) fn clip(ring: &Ring, last: usize, pace: &mut Pace<'_, '_>) -> Result<Option<Ears>, Cancelled> {
    let mut clipper = Clipper::new(ring);
    let mut ears = Vec::with_capacity(ring.len());
    let mut left = ring.len();
    let mut start = 0;
    while left > last {
        let Some(Reverse((_, _, tip, look))) = clipper.heap.pop() else {
            break;
        };
        if clipper.looks[tip as usize] != look {
            continue;
        }
        pace.step(64)?;
        let (p, q) = (clipper.prev[tip as usize], clipper.next[tip as usize]);
        ears.push([p, tip, q]);
        clipper.cut(tip);
        left -= 1;
        start = p;
    }
    // Stuck with more: it takes the cubic method long, but not for ever.
    if left > 4 * LAST {
        return Ok(None);
    }
    let rest: Vec<u32> =
        std::iter::successors(Some(start), |&i| Some(clipper.next[i as usize])).take(left).collect();
    Ok(lightest(ring, &rest, pace)?.map(|last| {
        ears.extend(last);
        ears
    }))
}

impl<'r> Clipper<'r> {
    fn new(ring: &'r Ring) -> Self {
        let n = ring.len() as u32;
        let normal = direction(ring.double_area_vector());
        // glam's pair (x, y) is right-handed with the normal.
        let (x, y) = if normal == glam::DVec3::ZERO {
            (glam::DVec3::X, glam::DVec3::Y)
        } else {
            normal.any_orthonormal_pair()
        };
        let plane: Vec<DVec2> = ring.points.iter().map(|p| DVec2::new(p.dot(x), p.dot(y))).collect();
        let next: Vec<u32> = (1..n).chain([0]).collect();
        let prev: Vec<u32> = [n - 1].into_iter().chain(0..n - 1).collect();
        let turn = |i: u32| turn([prev[i as usize], i, next[i as usize]].map(|k| plane[k as usize]));
        let reflex: Vec<bool> = (0..n).map(|i| turn(i) <= 0.0).collect();
        let grid = Grid::new(&plane, &reflex);
        let n = n as usize;
        let mut clipper = Self {
            ring,
            plane,
            next,
            prev,
            reflex,
            grid,
            heap: BinaryHeap::with_capacity(n),
            looks: vec![0; n],
            waiting: vec![Vec::new(); n],
            budget: 256 * n + 4096,
        };
        (0..n as u32).for_each(|i| clipper.look(i));
        clipper
    }

    /// Looks at a tip, and puts its ear in the heap.
    fn look(&mut self, tip: u32) {
        self.looks[tip as usize] += 1;
        let corners = [self.prev[tip as usize], tip, self.next[tip as usize]];
        let [p, _, q] = corners;
        if self.ring.is_chord(p, q) {
            return;
        }
        let [a, b, c] = corners.map(|i| self.ring.points[i as usize]);
        let class = if self.ring.triangle(a, b, c).is_flat {
            FLAT
        } else if self.reflex[tip as usize] {
            REFLEX
        } else if self.budget == 0 {
            BLOCKED
        } else if let Some(by) = self.blocker(corners) {
            self.waiting[by as usize].push(tip);
            BLOCKED
        } else {
            GOOD
        };
        // The bits of numbers that are not negative are in their order. Lengths that differ by less than 1 in 500 count as
        // equal, so that an even loop is cut all around, not here and there as it was rounded.
        let length = (a.distance_squared(c).to_bits() >> 44) as u32;
        self.heap.push(Reverse((class, length, tip, self.looks[tip as usize])));
    }

    /// A reflex corner in an ear's triangle, its edges included.
    fn blocker(&mut self, corners: [u32; 3]) -> Option<u32> {
        let [a, b, c] = corners.map(|i| self.plane[i as usize]);
        let (min, max) = (a.min(b).min(c), a.max(b).max(c));
        let (mut looked, mut found) = (0, None);
        for cell in self.grid.cells(min, max) {
            looked += 1 + cell.len();
            found = cell.iter().copied().find(|&k| {
                let x = self.plane[k as usize];
                // Corners at the same place as one of the triangle's do not stand in the way.
                self.reflex[k as usize]
                    && !corners.contains(&k)
                    && ![a, b, c].contains(&x)
                    && (b - a).perp_dot(x - a) >= 0.0
                    && (c - b).perp_dot(x - b) >= 0.0
                    && (a - c).perp_dot(x - c) >= 0.0
            });
            if found.is_some() || looked > self.budget {
                break;
            }
        }
        self.budget = self.budget.saturating_sub(looked);
        found
    }

    /// Takes a tip away, and looks again at what that changes.
    fn cut(&mut self, tip: u32) {
        let (p, q) = (self.prev[tip as usize], self.next[tip as usize]);
        self.next[p as usize] = q;
        self.prev[q as usize] = p;
        self.looks[tip as usize] += 1;
        let mut freed = std::mem::take(&mut self.waiting[tip as usize]);
        self.reflex[tip as usize] = false;
        for k in [p, q] {
            let corners = [self.prev[k as usize], k, self.next[k as usize]];
            if self.reflex[k as usize] && turn(corners.map(|i| self.plane[i as usize])) > 0.0 {
                self.reflex[k as usize] = false;
                freed.append(&mut self.waiting[k as usize]);
            }
        }
        self.look(p);
        self.look(q);
        for waiting in freed {
            // Those that were cut themselves, and the two that were just looked at, are not concerned.
            if waiting != p && waiting != q && self.next[self.prev[waiting as usize] as usize] == waiting {
                self.look(waiting);
            }
        }
    }
}

/// Twice the signed area of a triangle.
fn turn([a, b, c]: [DVec2; 3]) -> f64 {
    (b - a).perp_dot(c - b)
}

#[cfg(test)]
mod tests {
    use super::super::ring::tests::ring_of;
    use super::*;
    use crate::Control;
    use glam::{DVec3, dvec3};

    fn clip_all(ring: &Ring) -> Ears {
        clip(ring, LAST, &mut Pace::new(&mut Control::none())).unwrap().unwrap()
    }

    fn star(n: usize, wave: f64) -> Vec<DVec3> {
        let corner = |i: usize| {
            let turn = i as f64 * std::f64::consts::TAU / n as f64;
            let r = 1.0 + 0.3 * (7.0 * turn).sin() + 0.1 * (31.0 * turn).cos();
            dvec3(turn.cos() * r, turn.sin() * r, wave * (5.0 * turn).sin())
        };
        (0..n).map(corner).collect()
    }

    #[test]
    fn a_flat_star_is_covered_once() {
        for n in [100, 1000, 20_000] {
            let ring = ring_of(star(n, 0.0));
            let ears = clip_all(&ring);
            assert_eq!(ears.len(), n - 2);
            let whole = ring.double_area_vector().length() / 2.0;
            assert!((ring.area_of(&ears) / whole - 1.0).abs() < 1e-9, "{n}");
            let turned = ears.iter().filter(|t| turn(t.map(|i| ring.points[i as usize].truncate())) <= 0.0);
            assert_eq!(turned.count(), 0, "{n}");
        }
    }

    #[test]
    fn a_wavy_loop_costs_little_more_area_than_the_least() {
        for wave in [0.05, 0.3, 1.0] {
            let ring = ring_of(star(400, wave));
            let corners: Vec<u32> = (0..400).collect();
            let least = lightest(&ring, &corners, &mut Pace::new(&mut Control::none())).unwrap().unwrap();
            let ratio = ring.area_of(&clip_all(&ring)) / ring.area_of(&least);
            println!("wave {wave}: {ratio}");
            assert!((1.0 - 1e-9..1.2).contains(&ratio), "wave {wave}: {ratio}");
        }
    }

    #[test]
    fn long_straight_sides_give_no_flat_triangle() {
        let side = |a: DVec3, b: DVec3| (0..300).map(move |i| a + (b - a) * f64::from(i) / 300.0);
        let [a, b, c, d] = [dvec3(0.1, 0., 0.), dvec3(1.1, 0.3, 0.), dvec3(1.2, 1.3, 0.), dvec3(0., 1., 0.)];
        let ring = ring_of(side(a, b).chain(side(b, c)).chain(side(c, d)).chain(side(d, a)).collect());
        let triangles = clip_all(&ring);
        let flat = triangles.iter().filter(|t| {
            let [a, b, c] = t.map(|i| ring.points[i as usize]);
            ring.triangle(a, b, c).is_flat
        });
        assert_eq!(flat.count(), 0);
    }

    #[test]
    fn chords_that_are_edges_are_not_cut() {
        let mut ring = ring_of(star(400, 0.2));
        let pairs = (0..400u32).flat_map(|i| (2..40).map(move |d| [i, i + d]));
        ring.chords = pairs.filter(|[i, j]| *j < 400 && (i * 31 + j * 17).is_multiple_of(3)).collect();
        let ears = clip_all(&ring);
        assert_eq!(ears.len(), 398);
        assert!(ears[..397].iter().all(|&[p, _, q]| !ring.is_chord(p, q)));
    }

    #[test]
    fn a_loop_that_cannot_be_cut_is_given_up() {
        let mut ring = ring_of(star(2000, 0.2));
        ring.chords = (0..1998u32).map(|i| [i, i + 2]).chain([[0, 1998], [1, 1999]]).collect();
        ring.chords.sort_unstable();
        assert_eq!(clip(&ring, LAST, &mut Pace::new(&mut Control::none())), Ok(None));
    }
}
