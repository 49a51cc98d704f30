//! Cracks and T-junctions closed along naked edges, nothing moved farther than a tolerance.
//!
//! Only naked edges and their ends take part, so that detail inside a surface is never folded. First whole edges are
//! paired, those nearest to each other first ([`classes`], [`cracks`]); then the ends of edges that are left are put
//! into the edges that they lie on ([`junctions`]). All that is tentative: only what pairs naked edges is carried out.

mod apply;
mod classes;
mod cracks;
mod junctions;
mod seams;

use super::manifold::drop_duplicates;
use super::pool::Pool;
use super::{CleanError, Weld};
use crate::matching::Matching;
use crate::report::{Element, Kind, Outcome, Record, Step, StepSummary};
use crate::topology::next_corner;
use crate::{Cancelled, Control, IndexedMesh, PolygonSoup};
use classes::Classes;
use seams::Seams;

/// Makes a valid vertex pool of any soup, as [`index`](super::index), drops duplicate faces and stitches: cracks and
/// T-junctions between naked edges are closed, and no vertex or edge moves farther than the tolerance.
///
/// - Cracks: naked edges whose ends lie within the tolerance of each other become one, the nearest first, those that run
///   opposite ways before others.
/// - T-junctions: a vertex of a naked edge that lies within the tolerance of the inside of another face's naked edge
///   becomes a corner of that face; several on one edge in their order along it, and from both sides. A triangle that
///   gains corners is cut into triangles with an area; a larger polygon just gains them.
///
/// No face folds, no edge gets a third face, and only what pairs naked edges is done: parts that merely touch stay
/// apart. What cannot be done so stays as it is: so does a vertex at an edge with several faces, a T-junction on which a fin
/// stands too. Corner data is interpolated along the edge.
///
/// O(n log n); files made to be quadratic are stitched in part, and a record says at how many edges.
///
/// # Errors
/// [`CleanError`]: never because of what the soup holds.
///
/// # Examples
/// ```
/// use meshwright::{Kind, PolygonSoup, Polygons, cleanup::{Weld, stitch}, glam::{DVec3, dvec3}};
/// // A square; on its upper edge two triangles that share a vertex in its middle.
/// let points = [(0., 0.), (2., 0.), (2., 2.), (0., 2.), (1., 2.), (0., 3.), (2., 3.)];
/// let points = points.map(|(x, y)| dvec3(x, y, 0.)).to_vec();
/// let faces = vec![vec![0, 1, 2, 3], vec![3, 4, 5], vec![4, 2, 6]];
/// let stitched = stitch(&PolygonSoup::new(points, faces.into()), Weld::Exact, 1e-6)?;
/// assert_eq!(stitched.value.polygons()[0], [0, 1, 2, 4, 3]);
/// assert_eq!(stitched.report.count(Kind::TJunction), 1);
/// # Ok::<(), meshwright::cleanup::CleanError>(())
/// ```
pub fn stitch(soup: &PolygonSoup, weld: Weld, tolerance: f64) -> Result<Outcome<IndexedMesh>, CleanError> {
    if !(tolerance >= 0.0 && tolerance.is_finite()) {
        return Err(CleanError::BadTolerance(tolerance));
    }
    let mut control = Control::none();
    let mut pool = Pool::new(soup, weld, &mut control)?;
    let mut matching = Matching::new(pool.positions.len(), &pool.polygons);
    if drop_duplicates(&mut pool, &matching) {
        matching = Matching::new(pool.positions.len(), &pool.polygons);
    }
    stitch_pool(&mut pool, &matching, tolerance, &mut control)?;
    Ok(super::outcome(pool))
}

/// Stitches a pool. Whether anything changed: then edges are to be matched again.
pub(super) fn stitch_pool(
    pool: &mut Pool<'_>,
    matching: &Matching,
    tolerance: f64,
    control: &mut Control<'_>,
) -> Result<bool, CleanError> {
    let (plan, unsearched) = plan(pool, matching, tolerance, control)?;
    if let Some((count, corner)) = unsearched {
        record_unsearched(pool, count, corner as usize);
    }
    let (changed, moved) = match plan {
        Some(plan) => apply::apply(pool, plan)?,
        None => (0, 0.0),
    };
    let summary = StepSummary::new(Step::Stitch, changed);
    pool.report.steps.push(StepSummary { tolerance: Some(tolerance), moved, ..summary });
    Ok(changed > 0)
}

/// Records that some naked edges were not searched around to the end, at the first.
fn record_unsearched(pool: &mut Pool<'_>, count: usize, corner: usize) {
    let face = pool.polygons.starts().partition_point(|&s| s <= corner) - 1;
    let ends = [corner, next_corner(&pool.polygons, face as u32, corner)].map(|c| pool.polygons.corners()[c]);
    let [p, q] = ends.map(|v| pool.positions[v as usize]);
    let [a, b] = ends.map(|v| pool.named(v));
    let element = Element::Edge([a.min(b), a.max(b)]);
    let record = Record::new(Step::Stitch, Kind::UnsearchedEdges, element, Some(p * 0.5 + q * 0.5));
    pool.report.records.push(record.sized(count, 0.0));
}

/// What is to be done.
struct Plan {
    /// For each vertex of the pool the lowest of those that it becomes one with.
    into: Vec<u32>,
    /// `(lowest vertex, vertex at whose place)` where these differ.
    places: Vec<(u32, u32)>,
    /// Corners to insert, by the corner they come after and their order from there.
    cuts: Vec<NewCorner>,
    /// The corners of whole naked edges that become one with another: the lower of the two.
    cracks: Vec<u32>,
    /// The farthest that anything moves.
    moved: f64,
}

/// A vertex to be put into the edge behind a corner.
#[derive(Clone, Copy, Debug)]
struct NewCorner {
    corner: u32,
    /// How far along the edge, from 0 to 1.
    at: f64,
    vertex: u32,
}

/// A number of naked edges, and the corner of the first.
type Unsearched = Option<(usize, u32)>;

/// What is to be done, if anything; and how many naked edges were not searched around to the end, with the corner of the first.
fn plan(
    pool: &Pool<'_>,
    matching: &Matching,
    tolerance: f64,
    control: &mut Control<'_>,
) -> Result<(Option<Plan>, Unsearched), Cancelled> {
    if tolerance <= 0.0 {
        return Ok((None, None));
    }
    let seams = Seams::new(&pool.positions, &pool.polygons, matching, tolerance);
    if seams.edges.len() < 2 {
        return Ok((None, None));
    }
    control.report("stitch cracks", 0.52)?;
    let mut classes = Classes::new(&seams);
    cracks::pair_edges(&mut classes);
    control.report("stitch T-junctions", 0.55)?;
    let plan = junctions::settle(&mut classes);
    Ok((plan, classes.unsearched()))
}
