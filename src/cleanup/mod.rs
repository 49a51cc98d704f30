//! Any soup in, a valid mesh out, with an account of what was changed.
//!
//! [`clean`] runs the whole pipeline; [`index`] runs the part of it that makes a valid vertex pool, and [`inspect`]
//! tells what state a soup is in without changing it. How faces meet is decided on the indexed form, before half-edges
//! exist; what makes a solid of a mesh are steps on the mesh, each of which can be called on its own:
//! [`drop_fins`], [`resolve_slivers`], [`drop_debris`], [`fill_holes`], [`drop_isolated`], [`turn_outward`],
//! [`find_intersections`].

mod account;
mod carry;
mod drop;
mod facts;
mod fill;
mod fins;
mod intersections;
mod manifold;
mod near;
mod open;
mod outward;
mod pair;
mod pipeline;
mod polygons;
mod pool;
mod slivers;
mod solid;
mod split;
mod step;
mod stitch;
mod tolerance;
mod weld;

pub use account::{Account, FaceTally, LostSummary, SCHEMA};
pub use drop::{drop_debris, drop_isolated};
pub use facts::{Facts, inspect, inspect_with};
pub use fill::fill_holes;
pub use fins::drop_fins;
pub use intersections::find_intersections;
pub use outward::turn_outward;
pub use slivers::resolve_slivers;
pub use stitch::stitch;
pub use tolerance::{ProposedTolerance, propose_tolerance, propose_tolerance_with_reasons};

use crate::report::{Outcome, Report};
use crate::{BuildError, Cancelled, Control, IndexedMesh, Mesh, PolygonSoup};
use pool::Pool;
pub(crate) use solid::Names;

/// What clean-up is for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Profile {
    /// Touch only what forbids a manifold. Zero-area faces and boundary stay.
    #[default]
    Preserve,
    /// Make what a slicer or a mesher needs: closed, manifold, oriented, outward, with cavities kept. A part that cannot
    /// become a solid stays as it is, on record.
    Solid,
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
    /// Parts with fewer faces than this are dropped, if a number is given.
    pub debris: Option<usize>,
    /// The progress-and-cancel hook.
    pub control: Control<'a>,
}

impl CleanOptions<'_> {
    /// For a solid: with a weld tolerance proposed from the data, and no debris dropped.
    pub fn solid() -> Self {
        Self { profile: Profile::Solid, weld: Weld::Auto, ..Self::default() }
    }
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
/// With [`Profile::Solid`], cracks and T-junctions are [stitched](stitch()) after duplicates are dropped, and more steps
/// follow on the mesh, until none of them changes anything: [fins](drop_fins) dropped, [slivers](resolve_slivers) resolved,
/// [debris](drop_debris) dropped if asked for, [holes](fill_holes) filled, [vertices without a face](drop_isolated)
/// dropped; then shells [turned outward](turn_outward), cavities inward, and [faces that pass through each
/// other](find_intersections) looked for. A part that cannot become a solid stays as it is but for the steps of `preserve`,
/// stitching and slivers, and is named by a record: a sheet (to close it would take a filler of three quarters of its own
/// area), a strip that cannot be oriented, a part with a hole that cannot be filled. Where there is no such record, the
/// result is closed, manifold, oriented and outward. Two passes come to the same as one.
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
/// O(n log n) in the corners at worst, linear without defects; holes of up to 500 edges take the cube of that, and searches in
/// files made to be slow end early. Memory, the soup included, is at most ten times
/// what positions (24 bytes each), corners (4) and faces (8) of the soup take: four times if nothing is wrong, six if nearly
/// every corner is moved by the weld, which leaves a record of each, and nine for triangles that share no vertices.
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
///
/// // A tetrahedron without its bottom, inside out.
/// let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let soup = PolygonSoup::new(points, Polygons::from_triangles(&[[0, 3, 1], [1, 3, 2], [2, 3, 0]]));
/// let solid = clean(&soup, CleanOptions::solid())?;
/// assert_eq!(solid.report.count(Kind::FilledHole), 1);
/// assert!(solid.value.closed().is_ok_and(|closed| closed.volume() > 0.0));
/// # Ok::<(), meshwright::cleanup::CleanError>(())
/// ```
pub fn clean(soup: &PolygonSoup, options: CleanOptions<'_>) -> Result<Outcome<Mesh>, CleanError> {
    let pipeline::Cleaned { mesh, report, maps, .. } = pipeline::run(soup, options)?;
    Ok(Outcome { value: mesh, report, maps })
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
    let pipeline::Cleaned { indexed, mesh, report, maps, .. } = pipeline::run(soup, options)?;
    let value = indexed.unwrap_or_else(|| mesh.to_indexed());
    Ok(Outcome { value, report, maps })
}

/// Where the elements of the result were in the soup.
pub(crate) struct Sources {
    /// For each vertex the lowest of the soup's.
    pub(crate) vertices: Vec<u32>,
    /// For each corner the soup's.
    pub(crate) corners: Vec<u32>,
    /// For each face the soup's.
    pub(crate) faces: Vec<u32>,
    /// The corners in the middle of a parted edge, which were none of the soup's; ascending.
    pub(crate) middles: Vec<u32>,
}

/// As [`clean`] with [`Profile::Preserve`], but tells of corners too.
pub(crate) fn clean_tracked(
    soup: &PolygonSoup,
    options: CleanOptions<'_>,
) -> Result<(Outcome<Mesh>, Sources), CleanError> {
    let pipeline::Cleaned { mesh, report, maps, sources, .. } = pipeline::run(soup, options)?;
    Ok((Outcome { value: mesh, report, maps }, sources))
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
    let how = if carry::has_attributes(soup) { Pool::new } else { Pool::unlisted };
    let pool = how(soup, weld, &mut control.part(0.0, 2.0))?;
    control.report("carry attributes", 0.8)?;
    Ok(outcome(pool))
}

/// A pool as it stands, with its account.
fn outcome(mut pool: Pool<'_>) -> Outcome<IndexedMesh> {
    let mut carried = pool.carry_welded();
    let value = pool.lend(std::mem::take(&mut carried.attributes));
    let (report, maps) = pool.account(value.positions());
    let report = Report { not_carried: carried.not_carried(), lost_values: carried.lost_values(), ..report };
    Outcome { value, report, maps }
}
