//! Any soup in, a valid mesh out, with an account of what was changed.
//!
//! [`clean`] runs the whole pipeline; [`index`] runs the part of it that makes a valid vertex pool, and [`inspect`]
//! tells what state a soup is in without changing it. Everything is decided on the indexed form, before half-edges
//! exist.

mod carry;
mod facts;
mod pair;
mod polygons;
mod pool;
mod split;
mod weld;

pub use facts::{Facts, inspect, inspect_with};
pub use weld::propose_tolerance;

use crate::build::assemble;
use crate::matching::{Chains, Matching, NONE};
use crate::report::{Element, Kind, Maps, Outcome, Record, Report, Step, StepSummary};
use crate::topology::{FaceOf, duplicate_faces, flip_faces, next_corner, orient};
use crate::{BuildError, Cancelled, Control, IndexedMesh, Mesh, PolygonSoup};
use carry::Carried;
use glam::DVec3;
use pool::Pool;

/// What clean-up is for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Profile {
    /// Touch only what forbids a manifold. Zero-area faces and boundary stay.
    #[default]
    Preserve,
}

/// Which vertices are merged.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Weld {
    /// None.
    None,
    /// Those with equal coordinates (-0 equals 0).
    #[default]
    Exact,
    /// Those closer than a tolerance proposed from the data: see [`propose_tolerance`].
    Auto,
    /// Those closer than this, in the mesh's units: each vertex joins the lowest vertex kept so far that is nearer than
    /// the tolerance. `Within(0.0)` is [`Exact`](Self::Exact).
    Within(f64),
}

/// How to clean.
#[derive(Debug, Default)]
pub struct CleanOptions<'a> {
    /// What for.
    pub profile: Profile,
    /// Which vertices are merged first.
    pub weld: Weld,
    /// The progress-and-cancel hook.
    pub control: Control<'a>,
}

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CleanError {
    /// The tolerance is negative, NaN or infinite.
    #[error("a weld tolerance of {0} makes no sense")]
    BadTolerance(f64),
    /// More vertices, faces or corners than [`MAX_ELEMENTS`](crate::MAX_ELEMENTS).
    #[error("{elements} elements are more than a mesh can number")]
    TooLarge {
        /// The number of vertices, faces or corners.
        elements: usize,
    },
    /// The result was not a manifold after all. This is a bug of this crate; please report it with the input.
    #[error("bug in the clean-up: {0}")]
    Bug(BuildError),
    /// The hook said stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Makes a valid mesh of any soup and accounts for every change.
///
/// The steps, each named in the report: invalid elements are dropped; vertices welded; faces that name a vertex twice
/// repaired; duplicate faces dropped, in either direction; windings unified per part; the faces at edges with three or
/// more of them paired, so that closed shells stay closed; windings unified again; parts that cannot be oriented cut
/// open; vertices split so that each has one fan. A soup without defects comes out as it is, with an empty record.
///
/// Vertices keep the soup's order (the lowest of those merged counts), and so do faces; what a split adds comes last.
/// Splits leave coincident vertices: clean the result with [`Weld::None`], and nothing changes.
///
/// Attributes go along. Corner data stays with its corner, whatever becomes of the vertex: a seam does not keep vertices
/// apart. Where vertices with different normals become one, vertex normals become normals of corners; of different
/// colours the lowest vertex's stays. The corner normals of a flipped face turn with it, unless they lie on the side where
/// it then faces. What lies in the middle of a parted edge is the mean of its ends. Values that are not finite are left
/// out. [`Report::not_carried`] names the attributes that the result does not have, [`Report::lost_values`] the single values.
///
/// O(n log n) in the corners at worst, linear without defects.
///
/// # Errors
/// [`CleanError`]: never because of what the soup holds.
///
/// # Examples
/// ```
/// use meshwright::{Kind, PolygonSoup, Polygons, cleanup::{CleanOptions, clean}, glam::DVec3};
/// // Two triangles, unwelded, the second wound the wrong way.
/// let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X, DVec3::Y, DVec3::ONE];
/// let soup = PolygonSoup::new(points, Polygons::from_triangles(&[[0, 1, 2], [3, 4, 5]]));
/// let cleaned = clean(&soup, CleanOptions::default())?;
/// assert_eq!(cleaned.value.vertex_count(), 4);
/// assert_eq!(cleaned.report.count(Kind::FlippedFace), 1);
/// assert_eq!(cleaned.maps.vertices.new_of(3), &[1]);
/// # Ok::<(), meshwright::cleanup::CleanError>(())
/// ```
pub fn clean(soup: &PolygonSoup, options: CleanOptions<'_>) -> Result<Outcome<Mesh>, CleanError> {
    let cleaned = run(soup, options, |mesh| mesh)?;
    let (value, maps) = (cleaned.kept, cleaned.maps);
    Ok(Outcome { value, report: tell(cleaned.report, &cleaned.carried), maps })
}

/// As [`clean`], but gives the vertex pool that the mesh is built of, with all its attributes: for whoever writes the
/// result to a file. [`Mesh::build`] of it succeeds.
///
/// # Errors
/// As [`clean`].
///
/// # Examples
/// ```
/// use meshwright::{CornerData, PolygonSoup, Polygons, cleanup::{CleanOptions, clean_indexed}, glam::{DVec3, dvec2}};
/// // Two triangles, unwelded, each with its own piece of the texture.
/// let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X, DVec3::ONE, DVec3::Y];
/// let mut soup = PolygonSoup::new(points, Polygons::from_triangles(&[[0, 1, 2], [3, 4, 5]]));
/// let values = (0..6).map(|i| [f64::from(i), 0.0]).collect();
/// soup.corner_uvs = Some(CornerData { values, indices: vec![0, 1, 2, 3, 4, 5] });
/// let cleaned = clean_indexed(&soup, CleanOptions::default())?;
/// assert_eq!(cleaned.value.polygons().corners(), [0, 1, 2, 1, 3, 2]);
/// let uvs = cleaned.value.attributes().corner_uvs.as_ref().expect("carried");
/// assert_eq!((uvs[1], uvs[3]), (Some(dvec2(1.0, 0.0)), Some(dvec2(3.0, 0.0))));
/// # Ok::<(), meshwright::cleanup::CleanError>(())
/// ```
pub fn clean_indexed(
    soup: &PolygonSoup,
    options: CleanOptions<'_>,
) -> Result<Outcome<IndexedMesh>, CleanError> {
    let cleaned = run(soup, options, drop)?;
    let (value, maps) = (cleaned.indexed, cleaned.maps);
    Ok(Outcome { value, report: tell(cleaned.report, &cleaned.carried), maps })
}

/// What a clean-up arrives at: a pool, and what is kept of the mesh that was built of it.
struct Cleaned<M> {
    indexed: IndexedMesh,
    kept: M,
    carried: Carried,
    report: Report,
    maps: Maps,
    sources: Sources,
}

/// Where the elements of the result were in the soup.
pub(crate) struct Sources {
    /// For each corner the soup's.
    pub(crate) corners: Vec<u32>,
    /// For each face the soup's.
    pub(crate) faces: Vec<u32>,
    /// The corners in the middle of a parted edge, which were none of the soup's; ascending.
    pub(crate) middles: Vec<u32>,
}

/// As [`clean`], but tells of corners too.
pub(crate) fn clean_tracked(
    soup: &PolygonSoup,
    options: CleanOptions<'_>,
) -> Result<(Outcome<Mesh>, Sources), CleanError> {
    let cleaned = run(soup, options, |mesh| mesh)?;
    let (value, maps) = (cleaned.kept, cleaned.maps);
    Ok((Outcome { value, report: tell(cleaned.report, &cleaned.carried), maps }, cleaned.sources))
}

fn run<M>(
    soup: &PolygonSoup,
    options: CleanOptions<'_>,
    keep: impl FnOnce(Mesh) -> M,
) -> Result<Cleaned<M>, CleanError> {
    let Profile::Preserve = options.profile;
    let mut control = options.control;
    let mut pool = Pool::new(soup, options.weld, &mut control)?;
    control.report("match edges", 0.4)?;
    let chains = Chains::new(pool.positions.len(), &pool.polygons);
    if chains.is_paired() {
        // Most files need no more: try before working out what is wrong.
        control.report("build", 0.5)?;
        let mut carried = pool.carry_welded();
        let indexed = pool.lend(std::mem::take(&mut carried.attributes));
        if let Some(mesh) = assemble(&indexed, &chains.into_pairing()) {
            let kept = keep(mesh);
            let sources = pool.sources();
            let (report, maps) = pool.account(indexed.positions());
            return Ok(Cleaned { indexed, kept, carried, report, maps, sources });
        }
        pool.take_back(indexed);
    }
    control.report("drop duplicates", 0.5)?;
    let mut matching = Matching::new(pool.positions.len(), &pool.polygons);
    if drop_duplicates(&mut pool, &matching) {
        matching = Matching::new(pool.positions.len(), &pool.polygons);
    }
    control.report("pair faces", 0.6)?;
    let mates = make_manifold(&mut pool, &matching);
    control.report("split vertices", 0.8)?;
    let (split, vertices) = split::split(&mut pool, &mates);
    pool.report.steps.push(StepSummary { step: Step::SplitVertices, changed: split, tolerance: None });
    let maps = Maps { vertices, faces: pool.face_relation() };
    let positions = std::mem::take(&mut pool.positions);
    pool.record_merges(|v| maps.vertices.new_of(v as usize).first().map(|&n| positions[n as usize]));
    pool.report.records.sort_by_key(|r| r.step);
    control.report("build", 0.9)?;
    pool.positions = positions;
    let mut carried = carry::carry(&pool, |v| maps.vertices.new_of(v));
    let indexed = pool.lend(std::mem::take(&mut carried.attributes));
    let kept = keep(Mesh::build(&indexed).map_err(CleanError::Bug)?);
    let sources = pool.sources();
    Ok(Cleaned { indexed, kept, carried, report: pool.report, maps, sources })
}

/// The report with what the result does not have of the soup's attributes.
fn tell(report: Report, carried: &Carried) -> Report {
    Report { not_carried: carried.not_carried(), lost_values: carried.lost_values(), ..report }
}

/// Makes a valid vertex pool of any soup: drops what is not finite, out of range or short, welds, and repairs faces
/// that name a vertex twice. How faces meet is left as it is. Attributes go along as in [`clean`]. Linear in the corners.
///
/// # Errors
/// [`CleanError`]: never because of what the soup holds.
///
/// # Examples
/// ```
/// use meshwright::{PolygonSoup, Polygons, cleanup::{Weld, index}, glam::DVec3};
/// let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X];
/// let soup = PolygonSoup::new(points, Polygons::from_triangles(&[[0, 1, 2], [1, 3, 2]]));
/// let indexed = index(&soup, Weld::Exact)?;
/// assert_eq!((indexed.value.vertex_count(), indexed.value.face_count()), (3, 1));
/// # Ok::<(), meshwright::cleanup::CleanError>(())
/// ```
pub fn index(soup: &PolygonSoup, weld: Weld) -> Result<Outcome<IndexedMesh>, CleanError> {
    index_with(soup, weld, Control::none())
}

/// As [`index`], with a progress-and-cancel hook.
///
/// # Errors
/// As [`index`]; when cancelled.
///
/// # Examples
/// ```
/// use meshwright::{Control, PolygonSoup, Progress, cleanup::{CleanError, Weld, index_with}};
/// use std::ops::ControlFlow;
/// let mut stop = |_: Progress| ControlFlow::Break(());
/// let refused = index_with(&PolygonSoup::default(), Weld::Exact, Control::new(&mut stop));
/// assert!(matches!(refused, Err(CleanError::Cancelled(_))));
/// ```
pub fn index_with(
    soup: &PolygonSoup,
    weld: Weld,
    mut control: Control<'_>,
) -> Result<Outcome<IndexedMesh>, CleanError> {
    control.report("weld", 0.0)?;
    // The pool is the first two fifths of a clean-up, and nearly all there is to this.
    let mut pool = control.part(0.0, 2.0, |mut control| Pool::new(soup, weld, &mut control))?;
    control.report("carry attributes", 0.8)?;
    let mut carried = pool.carry_welded();
    let value = pool.lend(std::mem::take(&mut carried.attributes));
    let (report, maps) = pool.account(value.positions());
    Ok(Outcome { value, report: tell(report, &carried), maps })
}

/// Drops faces that are there already. Whether there were any.
fn drop_duplicates(pool: &mut Pool<'_>, matching: &Matching) -> bool {
    let duplicates = duplicate_faces(&pool.polygons, matching);
    let mut gone = vec![false; pool.polygons.len()];
    for &(face, _) in &duplicates {
        gone[face as usize] = true;
        record_face(pool, face, Step::DropDuplicates, Kind::DuplicateFace);
    }
    pool.report.steps.push(StepSummary {
        step: Step::DropDuplicates,
        changed: duplicates.len(),
        tolerance: None,
    });
    if !duplicates.is_empty() {
        pool.remove_faces(&gone);
    }
    !duplicates.is_empty()
}

/// Records a change to a face, by the face of the soup it comes from; once, if that became several.
fn record_face(pool: &mut Pool<'_>, face: u32, step: Step, kind: Kind) {
    let element = Element::Face(pool.face_source[face as usize]);
    let is_same = |r: &Record| (r.step, r.kind, r.element) == (step, kind, element);
    if !pool.report.records.last().is_some_and(is_same) {
        let place = pool.middle(&pool.soup.polygons[pool.face_source[face as usize] as usize]);
        pool.record(step, kind, element, place);
    }
}

/// Unifies windings, pairs the faces at edges with three or more, unifies again and cuts what cannot be oriented:
/// returns for each corner its mate across the edge, wound alike, or [`NONE`].
fn make_manifold(pool: &mut Pool<'_>, matching: &Matching) -> Vec<u32> {
    let mut mates = matching.mates();
    let mut flipped = vec![false; pool.polygons.len()];
    let mut unify = |pool: &mut Pool<'_>, mates: &mut Vec<u32>| {
        let found = orient(&pool.polygons, &FaceOf::new(&pool.polygons), mates);
        for &c in &found.conflicts {
            let m = std::mem::replace(&mut mates[c as usize], NONE);
            mates[m as usize] = NONE;
        }
        let cut: Vec<[u32; 2]> = found.conflicts.iter().map(|&c| edge_of(pool, c as usize)).collect();
        flip_faces(&mut pool.polygons, Some(mates), &found.flip);
        flip_sources(pool, &found.flip);
        flipped.iter_mut().zip(&found.flip).for_each(|(all, &now)| *all ^= now);
        cut
    };
    let mut cut = Vec::new();
    if matching.any_conflict {
        cut = unify(pool, &mut mates);
    }
    let mut unpaired = 0;
    if !matching.more.is_empty() {
        // Flips have moved corners within their faces, so edges are matched again.
        let matching = Matching::new(pool.positions.len(), &pool.polygons);
        let face_of = FaceOf::new(&pool.polygons);
        let left = pair::pair_faces(&pool.polygons, &pool.positions, &matching, &face_of, &mut mates);
        for (e, left) in left {
            if left > 0 || !is_undone_weld(pool, &matching, &mates, e as usize) {
                let c = matching.edges[e as usize].first();
                record_edge(pool, edge_of(pool, c), Step::PairFaces, Kind::NonManifoldEdge);
            }
            unpaired += left as usize;
        }
        cut.extend(unify(pool, &mut mates));
    }
    if flipped.contains(&true) {
        pool.flipped.clone_from(&flipped);
    }
    for face in (0..flipped.len()).filter(|&f| flipped[f]) {
        record_face(pool, face as u32, Step::Unify, Kind::FlippedFace);
    }
    for edge in &cut {
        record_edge(pool, *edge, Step::CutEdges, Kind::CutEdge);
    }
    let changed = flipped.iter().filter(|f| **f).count();
    let steps = [(Step::Unify, changed), (Step::PairFaces, unpaired), (Step::CutEdges, cut.len())];
    pool.report.steps.extend(steps.map(|(step, changed)| StepSummary { step, changed, tolerance: None }));
    mates
}

/// The two vertices of a corner's half-edge.
fn edge_of(pool: &Pool<'_>, corner: usize) -> [u32; 2] {
    let face = pool.polygons.starts().partition_point(|&s| s <= corner) - 1;
    [corner, next_corner(&pool.polygons, face as u32, corner)].map(|c| pool.polygons.corners()[c])
}

fn record_edge(pool: &mut Pool<'_>, [a, b]: [u32; 2], step: Step, kind: Kind) {
    let [p, q] = [a, b].map(|v| pool.positions[v as usize]);
    let [a, b] = [pool.named(a), pool.named(b)];
    let place: DVec3 = p * 0.5 + q * 0.5;
    pool.record(step, kind, Element::Edge([a.min(b), a.max(b)]), Some(place));
}

/// Moves the sources of corners along with the corners of reversed faces, which keep their first.
fn flip_sources(pool: &mut Pool<'_>, flip: &[bool]) {
    for face in (0..flip.len()).filter(|&f| flip[f]) {
        let range = pool.polygons.starts()[face] + 1..pool.polygons.starts()[face + 1];
        pool.corner_source[range].reverse();
    }
}

/// Whether an edge with three or more faces is not one in the soup: each pair of its faces names vertices there that no
/// other pair does, so only the weld brought them together.
fn is_undone_weld(pool: &Pool<'_>, matching: &Matching, mates: &[u32], edge: usize) -> bool {
    let mut named: Vec<(u32, u32)> = Vec::new();
    for c in matching.uses(edge) {
        let face = pool.polygons.starts().partition_point(|&s| s <= c) - 1;
        let pair = (c as u32).min(mates[c]);
        for c in [c, next_corner(&pool.polygons, face as u32, c)] {
            named.push((pool.named_at(c), pair));
        }
    }
    named.sort_unstable();
    named.dedup();
    named.windows(2).all(|w| w[0].0 != w[1].0)
}
