//! The triangulation of least weight, by dynamic programming over the chords of the loop.

use super::ring::{Ears, Ring};
use crate::{Cancelled, Control};
use glam::DVec3;

/// How much squared sides count beside the area, so that among the many triangulations of a flat hole one of good shape is
/// taken. More than rounding leaves of equal areas, and no more than what counts as flat: else folds would pay.
const SQUARES: f64 = 1e-10;

/// Triangles weighed between two questions to the hook.
const BETWEEN: usize = 1 << 24;

/// What a triangulation weighs: flat triangles count before all else.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub(super) struct Weight {
    flat: u32,
    size: f64,
}

const NOTHING: Weight = Weight { flat: 0, size: 0.0 };
const IMPOSSIBLE: Weight = Weight { flat: u32::MAX, size: f64::INFINITY };

impl Weight {
    /// Of one triangle of a ring.
    #[inline]
    fn of(ring: &Ring, [a, b, c]: [DVec3; 3]) -> Self {
        let t = ring.triangle(a, b, c);
        Self { flat: u32::from(t.is_flat), size: t.area + SQUARES * t.squares }
    }

    fn is_possible(self) -> bool {
        self.flat != u32::MAX
    }

    fn plus(self, other: Self) -> Self {
        Self { flat: self.flat + other.flat, size: self.size + other.size }
    }
}

/// The lightest triangulation of the polygon that some corners of a ring make, in their order; `None` if every one needs a
/// chord that is an edge already. Among equals the lowest apex wins, from the outermost chord inward.
///
/// Barequet and Sharir, "Filling gaps in the boundary of a polyhedron", Computer Aided Geometric Design 12(2), 1995. O(n^3)
/// time, 20 bytes for each pair of corners.
pub(super) fn lightest(
    ring: &Ring,
    corners: &[u32],
    control: &mut Pace<'_, '_>,
) -> Result<Option<Ears>, Cancelled> {
    let n = corners.len();
    if n < 3 {
        return Ok(None);
    }
    let points: Vec<DVec3> = corners.iter().map(|&i| ring.points[i as usize]).collect();
    // Both ways round, so that the two rows that are read lie together.
    let mut weights = vec![IMPOSSIBLE; n * n];
    let mut apexes = vec![0u32; n * n];
    for i in 0..n - 1 {
        (weights[i * n + i + 1], weights[(i + 1) * n + i]) = (NOTHING, NOTHING);
    }
    for span in 2..n {
        control.step((n - span) * span)?;
        for i in 0..n - span {
            let j = i + span;
            if span + 1 < n && ring.is_chord(corners[i], corners[j]) {
                continue;
            }
            let (from_i, from_j) = (&weights[i * n..][..n], &weights[j * n..][..n]);
            let (mut best, mut apex) = (IMPOSSIBLE, 0);
            let (a, c) = (points[i], points[j]);
            let apart = points[i + 1..j].iter().zip(&from_i[i + 1..j]).zip(&from_j[i + 1..j]);
            for (k, ((&b, &left), &right)) in (i as u32 + 1..).zip(apart) {
                if !left.is_possible() || !right.is_possible() {
                    continue;
                }
                let parts = left.plus(right);
                // A triangle weighs nothing at the least.
                if parts < best {
                    let whole = parts.plus(Weight::of(ring, [a, b, c]));
                    if whole < best {
                        (best, apex) = (whole, k);
                    }
                }
            }
            (weights[i * n + j], weights[j * n + i], apexes[i * n + j]) = (best, best, apex);
        }
    }
    if !weights[n - 1].is_possible() {
        return Ok(None);
    }
    // A triangle is an ear once both its sides are done.
    let mut ears = Vec::with_capacity(n - 2);
    let mut open = vec![(0, n - 1, false)];
    while let Some((i, j, is_done)) = open.pop() {
        if j - i < 2 {
            continue;
        }
        let k = apexes[i * n + j] as usize;
        if is_done {
            ears.push([corners[i], corners[k], corners[j]]);
        } else {
            open.extend([(i, j, true), (k, j, false), (i, k, false)]);
        }
    }
    Ok(Some(ears))
}

/// Asks the hook now and then.
pub(super) struct Pace<'p, 'c> {
    pub(super) control: &'p mut Control<'c>,
    pub(super) fraction: f64,
    since: usize,
}

impl<'p, 'c> Pace<'p, 'c> {
    pub(super) fn new(control: &'p mut Control<'c>) -> Self {
        Self { control, fraction: 0.0, since: 0 }
    }

    /// So many triangles are about to be weighed.
    pub(super) fn step(&mut self, work: usize) -> Result<(), Cancelled> {
        self.since += work;
        if self.since < BETWEEN {
            return Ok(());
        }
        self.since = 0;
        self.control.report("fill", self.fraction)
    }
}

#[cfg(test)]
mod tests {
    use super::super::ring::tests::{noisy_ring, ring_of};
    use super::*;
    use glam::dvec3;

    fn weight(ring: &Ring, ears: &[[u32; 3]]) -> Weight {
        ears.iter().fold(NOTHING, |sum, &t| sum.plus(Weight::of(ring, t.map(|i| ring.points[i as usize]))))
    }

    /// All triangulations of the corners `i..=j`.
    fn all(i: u32, j: u32, ring: &Ring, is_whole: bool) -> Vec<Ears> {
        if j - i < 2 {
            return vec![vec![]];
        }
        if !is_whole && ring.is_chord(i, j) {
            return vec![];
        }
        let mut found = Vec::new();
        for k in i + 1..j {
            for left in all(i, k, ring, false) {
                for right in all(k, j, ring, false) {
                    found.push([left.as_slice(), &right, &[[i, k, j]]].concat());
                }
            }
        }
        found
    }

    fn lightest_of(ring: &Ring) -> Option<Ears> {
        let corners: Vec<u32> = (0..ring.len() as u32).collect();
        lightest(ring, &corners, &mut Pace::new(&mut Control::none())).unwrap()
    }

    #[test]
    fn no_triangulation_of_all_there_are_is_lighter() {
        for n in 3..=9 {
            for seed in 0..40 {
                let mut ring = noisy_ring(n, seed);
                // Some chords are taken.
                ring.chords = (0..n as u32)
                    .flat_map(|i| (i + 2..n as u32).map(move |j| [i, j]))
                    .filter(|&[i, j]| {
                        (i, j) != (0, n as u32 - 1) && (i * 7 + j * 13 + seed as u32).is_multiple_of(4)
                    })
                    .collect();
                let twin = all(0, n as u32 - 1, &ring, true);
                let least = twin.iter().map(|t| weight(&ring, t)).min_by(|a, b| a.partial_cmp(b).unwrap());
                let ours = lightest_of(&ring).map(|t| weight(&ring, &t));
                match (least, ours) {
                    (None, None) => {}
                    (Some(least), Some(ours)) => {
                        assert_eq!(least.flat, ours.flat);
                        assert!((ours.size - least.size).abs() <= 1e-12 * least.size, "{n} corners, {seed}");
                    }
                    other => panic!("{n} corners, {seed}: {other:?}"),
                }
            }
        }
    }

    #[test]
    fn points_on_a_side_are_joined_to_others_and_not_to_each_other() {
        let square = [(0., 0.), (0.1, 0.), (0.2, 0.), (0.3, 0.), (1., 0.), (1., 1.), (0.7, 1.), (0., 1.)];
        let ring = ring_of(square.map(|(x, y)| dvec3(x * 0.3 + 0.1, y * 0.3, x * 0.7)).to_vec());
        let ears = lightest_of(&ring).unwrap();
        assert_eq!(weight(&ring, &ears).flat, 0);
    }

    #[test]
    fn a_flat_hole_gets_good_triangles_though_its_corners_are_rounded_to_f32() {
        let n = 60;
        let rim = |i: usize| {
            let (s, c) = (i as f64 / n as f64 * std::f64::consts::TAU).sin_cos();
            dvec3(1.3 + c, s * 0.8 - c * 0.3, 0.4 * s + 0.2 * c)
        };
        let exact = ring_of((0..n).map(rim).collect());
        let rounded = ring_of((0..n).map(|i| rim(i).as_vec3().as_dvec3()).collect());
        let squares = |ring: &Ring| {
            let ears = lightest_of(ring).unwrap();
            let each = ears.iter().map(|t| {
                let [a, b, c] = t.map(|i| ring.points[i as usize]);
                ring.triangle(a, b, c).squares
            });
            each.sum::<f64>()
        };
        let ratio = squares(&rounded) / squares(&exact);
        assert!((0.99..1.2).contains(&ratio), "{ratio}");
    }
}
