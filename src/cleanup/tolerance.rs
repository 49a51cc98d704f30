//! A weld tolerance proposed from the data.

use super::near::Tree;
use super::pool::Pool;
use super::weld::weld;
use super::{CleanError, Weld};
use crate::geometry::measure::Aabb;
use crate::geometry::{distance, unit_scale};
use crate::matching::{Chains, Matching};
use crate::topology::{FaceOf, duplicate_faces, next_corner};
use crate::{Cancelled, Control, PolygonSoup, Polygons};
use glam::DVec3;

/// A tolerance that [`propose_tolerance`] proposes, and why.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ProposedTolerance {
    /// The tolerance for the weld, in the mesh's units; 0 for an exact one.
    pub tolerance: f64,
    /// How far apart naked edges that belong together lie, in the mesh's units: what a stitch should bridge. Greater
    /// than `tolerance` where a weld that bridges it would fold faces; 0 if no naked edges belong together.
    pub reach: f64,
    /// Naked edges after an exact weld.
    pub naked_before: usize,
    /// Naked edges after a weld with `tolerance`.
    pub naked_after: usize,
    /// How many tolerances were tried.
    pub tried: usize,
}

/// Proposes a weld tolerance from the data: the smallest that joins the naked edges that belong together, and 0, which
/// means an exact weld, if there are none.
///
/// After an exact weld each naked edge is asked for the naked edge that it comes to lie on if ends are moved least. In
/// a soup of which every corner was moved a little, these distances stop at the largest move, and then for a long while
/// nothing follows: a tolerance is proposed where there is such a gap, below the lengths of the edges, and tried. It
/// is taken if it folds no more than one face in five hundred, makes no new edge of three or more faces, joins at least a
/// quarter of the naked edges that have such a distance, and leaves as few of them as a greater one, but for one in a
/// hundred. Where faces do not share vertices yet, needles, fins and faces that are there twice show only in the weld: there
/// one face in 25 may fold, and third and later faces of edges may be up to a tenth of the naked edges. Faces that a weld lays
/// on each other join nothing. A file without naked edges gets 0, and so does one whose boundary is meant.
///
/// What it asks of the distances up to a gap and behind the one before: no more than a tenth of the length of the edges
/// they join, for most, and a thousandth of the box's diagonal; if two in five of all edges are such, no more than half of
/// the length of the edges.
///
/// Only whole edges are asked. In a file that is exact otherwise, T-junctions that lie farther off their edges than the rounding
/// of single precision, which [`clean`](super::clean) bridges anyway, speak for no tolerance: they stay open and on record,
/// unless one is given.
///
/// O(n log n) in the corners; a few welds.
///
/// # Examples
/// ```
/// use meshwright::{PolygonSoup, Polygons, cleanup::propose_tolerance, glam::DVec3};
/// // Two triangles; the second's corners are a little off.
/// let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE, DVec3::Y * 1.00002, DVec3::X * 0.99999];
/// let soup = PolygonSoup::new(points, Polygons::from_triangles(&[[0, 1, 2], [3, 4, 5]]));
/// assert!((2e-5..2e-4).contains(&propose_tolerance(&soup)));
/// ```
pub fn propose_tolerance(soup: &PolygonSoup) -> f64 {
    propose_tolerance_with_reasons(soup).tolerance
}

/// As [`propose_tolerance`], with what speaks for it.
///
/// # Examples
/// ```
/// use meshwright::{PolygonSoup, Polygons, cleanup::propose_tolerance_with_reasons, glam::DVec3};
/// let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE, DVec3::Y * 1.00002, DVec3::X * 0.99999];
/// let soup = PolygonSoup::new(points, Polygons::from_triangles(&[[0, 1, 2], [3, 4, 5]]));
/// let proposed = propose_tolerance_with_reasons(&soup);
/// assert_eq!((proposed.naked_before, proposed.naked_after), (6, 4));
/// ```
pub fn propose_tolerance_with_reasons(soup: &PolygonSoup) -> ProposedTolerance {
    let mut control = Control::none();
    let exact: Result<_, CleanError> = Pool::new(soup, Weld::Exact, &mut control);
    // Too large for a mesh: whatever is done with the tolerance says so.
    let Ok(pool) = exact else { return ProposedTolerance::default() };
    propose(&pool, &mut control).map_or(ProposedTolerance::default(), |(proposed, _)| proposed)
}

/// The proposal for an exactly welded pool; and what its vertices are merged into, unless in themselves.
pub(super) fn propose(
    pool: &Pool<'_>,
    control: &mut Control<'_>,
) -> Result<(ProposedTolerance, Option<Vec<u32>>), Cancelled> {
    let (positions, polygons) = (&pool.positions, &pool.polygons);
    control.report("propose a tolerance", 0.0)?;
    let matching = Matching::new(positions.len(), polygons);
    let naked: Vec<usize> =
        matching.edges.iter().filter(|e| e.second().is_none()).map(|e| e.first()).collect();
    let mut proposed =
        ProposedTolerance { naked_before: naked.len(), naked_after: naked.len(), ..Default::default() };
    let edge_count = matching.edges.len();
    // Where faces do not share vertices yet, needles, fins and faces that are there twice show only in the weld.
    let is_soup = naked.len() as f64 >= 0.8 * edge_count as f64;
    let may = if is_soup {
        Bounds { folded: polygons.len() / 25, more: matching.more.len() + naked.len() / 10 }
    } else {
        Bounds { folded: polygons.len() / 500, more: matching.more.len() }
    };
    let before = naked.len();
    let laid_before: usize =
        duplicate_faces(polygons, &matching).iter().map(|d| polygons[d.0 as usize].len()).sum();
    drop(matching);
    if naked.len() < 2 {
        return Ok((proposed, None));
    }
    let edges = Edges::new(positions, polygons, &naked);
    drop(naked);
    let gaps = edges.gaps(edge_count, diagonal(positions));
    drop(edges);

    let mut taken: Vec<(usize, f64, Vec<u32>)> = Vec::new();
    let mut enough = 0;
    for gap in gaps {
        if gap.count < enough {
            break;
        }
        // Above the greatest distance, for those that were not looked at; but well below what comes next.
        let most = gap.tolerance();
        for t in [most, most * 0.7, gap.last * 1.01, gap.last * 0.5, gap.last * 0.25] {
            proposed.tried += 1;
            let trial = try_weld(positions, polygons, t, control)?;
            // Edges that went with a face that was laid on another were not joined.
            let laid = trial.laid.saturating_sub(laid_before);
            let joins = before.saturating_sub(trial.naked + laid) >= gap.promised / 4;
            let lays = laid > polygons.corners().len() / 10;
            if trial.folded <= may.folded && trial.more <= may.more {
                if joins && !lays && trial.naked < before {
                    taken.push((trial.naked, t, trial.merged));
                    // Less than nearly as many could not leave nearly as few naked edges.
                    enough = gap.count - gap.count / 50;
                    break;
                }
            } else if t == most && !lays {
                // Of a soup, a weld makes a surface, but for some faces.
                let makes_surface = joins && trial.folded <= polygons.len() / 4 && trial.more <= before / 4;
                if !gap.is_soup || makes_surface {
                    proposed.reach = proposed.reach.max(most);
                }
            }
        }
    }
    let fewest = taken.iter().map(|t| t.0).min().unwrap_or(0);
    let nearly = |naked: usize| naked <= fewest + (before - fewest) / 100;
    let best = taken.into_iter().filter(|t| nearly(t.0)).min_by(|a, b| a.1.total_cmp(&b.1));
    let Some((naked_after, tolerance, merged)) = best else { return Ok((proposed, None)) };
    proposed.reach = proposed.reach.max(tolerance);
    Ok((ProposedTolerance { tolerance, naked_after, ..proposed }, Some(merged)))
}

fn diagonal(positions: &[DVec3]) -> f64 {
    Aabb::around(positions.iter().copied()).map_or(0.0, |b| distance(b.min, b.max))
}

/// What a weld may do.
#[derive(Clone, Copy)]
struct Bounds {
    /// Faces that are lost.
    folded: usize,
    /// Third and later faces of edges.
    more: usize,
}

/// What a weld on trial does.
struct Trial {
    /// Faces that are lost.
    folded: usize,
    /// Third and later faces of edges.
    more: usize,
    /// Corners of faces that come to lie on others, or do already.
    laid: usize,
    /// Naked edges that are left without those.
    naked: usize,
    /// What vertices are merged into.
    merged: Vec<u32>,
}

/// Welds on trial.
fn try_weld(
    positions: &[DVec3],
    polygons: &Polygons,
    tolerance: f64,
    control: &mut Control<'_>,
) -> Result<Trial, Cancelled> {
    control.report("propose a tolerance", 0.0)?;
    let merged = weld(positions, Some(tolerance), &mut Control::none()).unwrap_or_default();
    let mut left = Polygons::with_capacity(polygons.len(), polygons.corners().len());
    let mut sorted: Vec<u32> = Vec::new();
    let of = |v: &u32| merged.get(*v as usize).copied().unwrap_or(*v);
    for face in polygons.iter() {
        sorted.clear();
        sorted.extend(face.iter().map(of));
        sorted.sort_unstable();
        if sorted.windows(2).all(|w| w[0] != w[1]) {
            left.push(face.iter().map(of));
        }
    }
    let folded = polygons.len() - left.len();
    let (mut more, mut laid) = (0, 0);
    if folded <= polygons.len() / 4 {
        // A fin that is laid on another joins no surface, and one large polygon that is there twice has as many uses too
        // many as it has edges.
        let single = once(positions.len(), &left);
        laid = left.corners().len() - single.corners().len();
        // Where many are, the weld has laid them on each other.
        if left.len() - single.len() > polygons.len() / 10 {
            more = Chains::new(positions.len(), &left).more_uses();
        }
        left = single;
    }
    let chains = Chains::new(positions.len(), &left);
    more = more.max(chains.more_uses());
    Ok(Trial { folded, more, laid, naked: chains.into_pairing().open.len(), merged })
}

/// The faces without those that are there already.
fn once(vertex_count: usize, polygons: &Polygons) -> Polygons {
    let again = duplicate_faces(polygons, &Matching::new(vertex_count, polygons));
    let mut left = Polygons::with_capacity(polygons.len() - again.len(), polygons.corners().len());
    let mut again = again.iter().peekable();
    for (f, face) in (0u32..).zip(polygons.iter()) {
        if again.next_if(|a| a.0 == f).is_none() {
            left.push(face.iter().copied());
        }
    }
    left
}

/// A distance of naked edges after which there is none for a while.
#[derive(Clone, Copy, Debug)]
struct Gap {
    /// The greatest distance before it.
    last: f64,
    /// The least behind it.
    next: f64,
    /// How many distances lie before it.
    count: usize,
    /// How many naked edges that are in all.
    promised: usize,
    /// Whether two in five of all edges have a distance before it, and behind the gap before.
    is_soup: bool,
}

impl Gap {
    fn tolerance(self) -> f64 {
        (self.last * 2.0).min((self.last * self.next).sqrt())
    }
}

/// No more naked edges are asked, spread evenly over all.
const ASKED: usize = 1 << 15;
/// Of more naked edges than this, only those in a few slabs across the longest side of the box are looked at.
const ALL: usize = 1 << 18;
const SLABS: usize = 8;
/// No more of what lies around a naked edge is looked at.
const LOOKS: usize = 256;

/// Naked edges, or those in some slabs, scaled by a power of two so that coordinates are about one at most.
struct Edges {
    /// How many there are in all.
    naked: usize,
    /// Ends, in the direction of the face.
    ends: Vec<[DVec3; 2]>,
    faces: Vec<u32>,
    tree: Tree,
    scale: f64,
}

impl Edges {
    fn new(positions: &[DVec3], polygons: &Polygons, naked: &[usize]) -> Self {
        let scale = unit_scale(positions.iter().copied());
        let face_of = FaceOf::new(polygons);
        let at = |c: usize| positions[polygons.corners()[c] as usize] * scale;
        let end = |c: usize| at(next_corner(polygons, face_of.face(c), c));
        let middle = |c: usize| at(c) * 0.5 + end(c) * 0.5;
        let chosen = if naked.len() > ALL { slabs(naked, middle) } else { Vec::new() };
        let chosen = if chosen.is_empty() { naked } else { &chosen };
        Self {
            naked: naked.len(),
            ends: chosen.iter().map(|&c| [at(c), end(c)]).collect(),
            faces: chosen.iter().map(|&c| face_of.face(c)).collect(),
            tree: Tree::new(chosen.iter().map(|&c| middle(c)).zip(0..)),
            scale,
        }
    }

    /// How far an edge's ends must move at least to make it one with a naked edge of another face, below its own length.
    fn partner(&self, edge: usize) -> Option<f64> {
        let [a, b] = self.ends[edge];
        let own = a.distance(b);
        let (mut least, mut looks) = (own, 0);
        self.tree.ball(a * 0.5 + b * 0.5, own, |other, _| {
            looks += 1;
            let other = other as usize;
            if self.faces[other] != self.faces[edge] {
                let [c, d] = self.ends[other];
                let apart = |c: DVec3, d: DVec3| a.distance_squared(c).max(b.distance_squared(d)).sqrt();
                least = least.min(apart(d, c)).min(apart(c, d));
            }
            if looks < LOOKS { least } else { -1.0 }
        });
        (least < own).then_some(least)
    }

    /// The gaps in the distances to partners that may be where noise ends, the greatest first.
    fn gaps(&self, edge_count: usize, diagonal: f64) -> Vec<Gap> {
        let stride = self.ends.len().div_ceil(ASKED);
        let asked = self.ends.len().div_ceil(stride);
        let length = |e: usize| self.ends[e][0].distance(self.ends[e][1]);
        let mut found: Vec<(f64, f64)> = (0..self.ends.len())
            .step_by(stride)
            .filter_map(|e| self.partner(e).map(|d| (d, d / length(e))))
            .filter(|f| f.0 > 0.0)
            .collect();
        found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let mut gaps: Vec<Gap> = Vec::new();
        // Where the distances begin that no gap so far accounts for.
        let mut own = 0;
        for i in 0..found.len() {
            let (last, next) = (found[i].0, found.get(i + 1).map_or(f64::INFINITY, |f| f.0));
            if next < 2.0 * last {
                continue;
            }
            // Of the distances of this order, how long they are for the edges they join.
            let from = found.partition_point(|f| f.0 <= last * 0.5);
            let mut parts: Vec<f64> = found[from..=i].iter().map(|f| f.1).collect();
            parts.sort_unstable_by(f64::total_cmp);
            let part = parts[parts.len() / 2];
            // If a gap below has done with most of a soup, what is left is no soup.
            let in_all = |count: usize| count as f64 / asked as f64 * self.naked as f64;
            let is_soup = in_all(i + 1 - own) >= 0.4 * edge_count as f64;
            let last = last / self.scale;
            if part <= 0.5 && (is_soup || part <= 0.1 && last <= diagonal * 1e-3) {
                let promised = in_all(i + 1) as usize;
                gaps.push(Gap { last, next: next / self.scale, count: i + 1, promised, is_soup });
                own = i + 1;
            }
        }
        gaps.reverse();
        gaps.truncate(4);
        gaps
    }
}

/// Those corners of which the middles lie in slabs with about [`ALL`] of them.
fn slabs(naked: &[usize], middle: impl Fn(usize) -> DVec3) -> Vec<usize> {
    let Some(bounds) = Aabb::around(naked.iter().map(|&c| middle(c))) else { return Vec::new() };
    let axis = (bounds.max - bounds.min).max_position();
    let mut sorted: Vec<f64> = naked.iter().map(|&c| middle(c)[axis]).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let (every, thick) = (sorted.len() / SLABS, ALL / SLABS);
    let slab = |i: usize| {
        let first = i * every + (every - thick) / 2;
        [sorted[first], sorted[first + thick]]
    };
    let slabs: [[f64; 2]; SLABS] = std::array::from_fn(slab);
    let is_in = |x: f64| slabs.iter().any(|[low, high]| (*low..=*high).contains(&x));
    naked.iter().copied().filter(|&c| is_in(middle(c)[axis])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_without_naked_edges_is_welded_exactly() {
        assert_eq!(propose_tolerance(&PolygonSoup::default()), 0.0);
        let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let closed = Polygons::from_triangles(&[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
        assert_eq!(propose_tolerance(&PolygonSoup::new(points, closed)), 0.0);
    }

    #[test]
    fn a_lone_triangle_is_welded_exactly() {
        let points = vec![DVec3::ZERO, DVec3::X * 1e-9, DVec3::Y * 100.0];
        let lone = PolygonSoup::new(points, Polygons::from_triangles(&[[0, 1, 2]]));
        assert_eq!(propose_tolerance(&lone), 0.0);
    }
}
