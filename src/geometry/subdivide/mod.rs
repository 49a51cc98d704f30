//! Subdivision: midpoint, Loop, Catmull-Clark and sqrt(3), on dense arrays.
//!
//! A level works on the indexed form with its edge matching. Splitting schemes know how the matching of the finer mesh
//! follows from the coarser one, so edges are matched once, whatever the number of levels.

mod carry;
mod dense;
mod masks;
mod partial;
mod refine;
mod sqrt3;

use super::unit_scale;
use super::weld::{BadAngle, in_range};
use crate::build::lay_out;
use crate::column::{Columns, Kind};
use crate::report::{Maps, Outcome, Report, Step, StepSummary};
use crate::soup::MAX_ELEMENTS;
use crate::{BuildError, Cancelled, Control, EdgeKey, FaceKey, IndexedMesh, Mesh, VertexKey};
use dense::{Dense, Prepared};
use glam::DVec3;
use refine::Refined;

/// How faces are cut and vertices placed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Scheme {
    /// Linear: no vertex moves. A triangle gives four triangles; a larger face of `n` corners gives `n` quads around
    /// the mean of its corners.
    #[default]
    Midpoint,
    /// Loop's scheme for triangles with Warren's weights: a triangle gives four. Larger faces are cut into triangles
    /// first, by the crate's one rule. (Loop, "Smooth Subdivision Surfaces Based on Triangles", 1987; Warren,
    /// "Subdivision Methods for Geometric Design", 1995; creases as Hoppe et al., SIGGRAPH 1994.)
    Loop,
    /// Catmull and Clark's scheme for any faces ("Recursively generated B-spline surfaces", Computer-Aided Design 10,
    /// 1978): a face of `n` corners gives `n` quads. Creases as DeRose, Kass and Truong, SIGGRAPH 1998, infinitely sharp.
    CatmullClark,
    /// Kobbelt's scheme ("sqrt(3)-Subdivision", SIGGRAPH 2000): a triangle gives three, turned against its edges; two
    /// levels cut every edge in three. Boundary edges are cut at every second level of a call. Larger faces are cut
    /// into triangles first. No creases.
    Sqrt3,
}

/// How to subdivide.
#[derive(Debug)]
pub struct SubdivideOptions<'a> {
    /// How faces are cut and vertices placed.
    pub scheme: Scheme,
    /// How often. 1 by default.
    pub levels: u32,
    /// Only these faces, and at further levels what they became; `None` is all. For [`Scheme::Midpoint`]. Neighbours
    /// are closed so that no vertex lies on an edge: a triangle with one or two cut edges is bisected (along the
    /// shorter diagonal), with three it is cut as the others are; a larger face takes the vertices on its edges as
    /// corners.
    pub only: Option<&'a [FaceKey]>,
    /// Edges that stay sharp, as boundary edges do: for [`Scheme::Loop`] and [`Scheme::CatmullClark`]. Where three or
    /// more sharp or boundary edges meet, the vertex stays in place; where a single one ends, it moves as if smooth.
    pub creases: &'a [EdgeKey],
    /// Edges whose faces' normals differ by more than this angle in degrees stay sharp as well.
    pub crease_degrees: Option<f64>,
    /// Vertices that stay where they are: for [`Scheme::Loop`] and [`Scheme::CatmullClark`].
    pub corners: &'a [VertexKey],
    /// The most faces the result may have: each takes about a hundred bytes. 2^26 by default.
    pub max_faces: usize,
    /// The progress-and-cancel hook.
    pub control: Control<'a>,
}

impl Default for SubdivideOptions<'_> {
    fn default() -> Self {
        Self {
            scheme: Scheme::Midpoint,
            levels: 1,
            only: None,
            creases: &[],
            crease_degrees: None,
            corners: &[],
            max_faces: 1 << 26,
            control: Control::none(),
        }
    }
}

/// Why a mesh was not subdivided.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SubdivideError {
    /// The mesh has no faces.
    #[error("there are no faces")]
    Empty,
    /// A face to be subdivided is not there.
    #[error("{0:?} is not a face of the mesh")]
    MissingFace(FaceKey),
    /// A crease is not there.
    #[error("{0:?} is not an edge of the mesh")]
    MissingEdge(EdgeKey),
    /// A corner is not there.
    #[error("{0:?} is not a vertex of the mesh")]
    MissingVertex(VertexKey),
    /// The angle of creases is not within 0 to 180 degrees.
    #[error(transparent)]
    BadAngle(#[from] BadAngle),
    /// Only [`Scheme::Midpoint`] takes a selection of faces.
    #[error("{0:?} subdivides all faces or none")]
    NoSelection(Scheme),
    /// The scheme has no rule for creases and corners.
    #[error("{0:?} knows neither creases nor corners")]
    NoCreases(Scheme),
    /// The result would have more faces than was allowed, or more elements than a mesh can number.
    #[error("level {level} would have {elements} elements; {limit} are allowed")]
    TooLarge {
        /// The first level that is too large, from 1.
        level: u32,
        /// Its faces, or whatever is too many.
        elements: u64,
        /// How many there may be.
        limit: u64,
    },
    /// Cut into triangles, the faces form no manifold: a diagonal is an edge elsewhere.
    #[error("faces cannot be cut into triangles: {0}")]
    NotTriangulable(BuildError),
    /// The result was not a manifold after all. This is a bug of this crate; please report it with the input.
    #[error("bug in the subdivision: {0}")]
    Bug(BuildError),
    /// The hook said stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// The share of a level within the whole call.
pub(super) struct Meter<'c, 'a> {
    control: &'c mut Control<'a>,
    from: f64,
    to: f64,
}

impl Meter<'_, '_> {
    /// Reports about every half million elements.
    #[inline]
    pub(super) fn tick(&mut self, done: usize, of: usize) -> Result<(), Cancelled> {
        if done.is_multiple_of(1 << 19) { self.report(done, of) } else { Ok(()) }
    }

    /// Reports that a part of the level is done; what follows counts within the rest.
    pub(super) fn advance(&mut self, done: usize, of: usize) -> Result<(), Cancelled> {
        self.from += (self.to - self.from) * done as f64 / of as f64;
        self.report(0, 1)
    }

    #[cold]
    fn report(&mut self, done: usize, of: usize) -> Result<(), Cancelled> {
        let share = done as f64 / of.max(1) as f64;
        self.control.report("subdivide", self.from + (self.to - self.from) * share)
    }
}

impl Mesh {
    /// A finer mesh of the same shape: same Euler characteristic, boundary loops and components.
    ///
    /// Vertices keep their numbers (those of [`to_indexed`](Self::to_indexed)); those on edges follow, then those
    /// inside faces; the parts of a face stand together in its place, the part at its first corner first. The maps tell
    /// parents: a new vertex comes from one old vertex, from the two ends of the edge it was put on, or from all corners
    /// of the face it was put in; a new face from the face it is a part of (or the two, for [`Scheme::Sqrt3`]). O(faces of
    /// the result).
    ///
    /// Attributes and user columns come along, the latter under their keys, each by its [`Rule`](crate::Rule), level by
    /// level. Whatever the scheme does with positions, the sources of a new value are its parents with weights that are
    /// linear between them: half and half on an edge, all alike in a face. So under [`Scheme::Midpoint`] a linear function
    /// stays one. Corners have sources in their own face only, so a seam stays a seam and nothing is mixed across it; faces
    /// and halves of edges are split from one element, edges within faces hold the default. Carried normals are those of
    /// the coarse mesh, mixed: [compute](Self::compute_normals) them anew where the scheme moves vertices.
    ///
    /// The faces of [`Scheme::Sqrt3`] lie across the old edges, half on either side. Each counts to the side of its old
    /// vertex; at a seam, that side goes on beyond the edge as if mirrored, and the seam runs in a zigzag.
    ///
    /// # Errors
    /// [`SubdivideError`]: dead keys, options the scheme has no rule for, a mesh without faces, more faces than allowed, faces that cannot be
    /// cut into triangles; when cancelled.
    ///
    /// # Examples
    /// ```
    /// use meshwright::{IndexedMesh, Mesh, Scheme, SubdivideOptions, glam::DVec3};
    /// let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    /// let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    /// let mesh = Mesh::build(&IndexedMesh::from_triangles(points, &faces)?)?;
    /// let options = SubdivideOptions { scheme: Scheme::Loop, levels: 2, ..Default::default() };
    /// let fine = mesh.subdivide(options)?;
    /// assert_eq!(fine.value.face_count(), 64);
    /// assert_eq!(fine.value.euler_characteristic(), 2);
    /// assert_eq!(fine.maps.faces.old_of(63), &[3]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn subdivide(&self, options: SubdivideOptions<'_>) -> Result<Outcome<Mesh>, SubdivideError> {
        let SubdivideOptions { scheme, levels, max_faces, mut control, .. } = options;
        let has_creases =
            !options.creases.is_empty() || options.crease_degrees.is_some() || !options.corners.is_empty();
        match scheme {
            Scheme::Loop | Scheme::CatmullClark | Scheme::Sqrt3 if options.only.is_some() => {
                return Err(SubdivideError::NoSelection(scheme));
            }
            Scheme::Midpoint | Scheme::Sqrt3 if has_creases => return Err(SubdivideError::NoCreases(scheme)),
            _ => {}
        }
        if let Some(degrees) = options.crease_degrees {
            in_range(degrees)?;
        }
        if self.face_count() == 0 {
            return Err(SubdivideError::Empty);
        }
        control.report("subdivide", 0.0)?;
        let needs_triangles = levels > 0 && matches!(scheme, Scheme::Loop | Scheme::Sqrt3);
        let mut columns = Columns::in_order(self, |_, _| true);
        let prepared = Prepared::new(self, needs_triangles, &mut columns)?;
        let limit = max_faces.min(MAX_ELEMENTS) as u64;
        let mut report = Report::default();
        if let Some(cut) = prepared.triangulated {
            report.steps.push(StepSummary::new(Step::Triangulate, cut));
        }
        report.steps.push(StepSummary::new(Step::Subdivide, 0));
        let (mut value, maps, changed) = if let Some(only) = options.only {
            partial::subdivide(self, only, levels, limit, &mut columns, &mut control)?
        } else {
            let mut dense = prepared.dense;
            foresee(&dense, scheme, levels, limit)?;
            dense.mark_creases(self, options.creases, options.crease_degrees, options.corners)?;
            let (large, back) = shrink(&mut dense.positions);
            let changed = if levels > 0 { dense.polygons.len() } else { 0 };
            let (mut value, maps) = if scheme == Scheme::Sqrt3 {
                let source = prepared.face_source;
                sqrt3::subdivide(dense, source, self, levels, &mut columns, &mut control)?
            } else {
                let mut refined = Refined::new(dense, prepared.face_source, self);
                let share =
                    |level: u32| [level, level + 1].map(|l| 0.9 * 4f64.powi(l as i32 - levels as i32));
                for level in 1..levels {
                    let [from, to] = share(level - 1);
                    let mut meter = Meter { control: &mut control, from, to };
                    refined.step(scheme, &mut columns, &mut meter)?;
                }
                if levels == 0 {
                    let (dense, maps) = refined.unrefined();
                    (build(dense)?, maps)
                } else {
                    let [from, to] = share(levels - 1);
                    let mut meter = Meter { control: &mut control, from, to };
                    refined.last(scheme, self, &mut columns, &mut meter)?
                }
            };
            if large {
                value.positions.iter_mut().for_each(|p| *p *= back);
            }
            control.report("build", 0.9)?;
            (value, maps, changed)
        };
        if let Some(step) = report.steps.last_mut() {
            step.changed = changed;
        }
        place(&value, &mut columns);
        value.columns = columns;
        value.carried = self.carried.clone();
        Ok(Outcome { value, report, maps })
    }
}

/// Brings positions so large that sums of them could overflow to about one. Every rule is a mean, so the result is
/// back in range after multiplying with what is returned.
fn shrink(positions: &mut [DVec3]) -> (bool, f64) {
    let large = positions.iter().any(|p| p.abs().max_element() > 1e300);
    if !large {
        return (false, 1.0);
    }
    let scale = unit_scale(positions.iter().copied());
    positions.iter_mut().for_each(|p| *p *= scale);
    (true, 1.0 / scale)
}

/// Refuses before anything is allocated.
fn foresee(dense: &Dense, scheme: Scheme, levels: u32, limit: u64) -> Result<(), SubdivideError> {
    let mut vertices = dense.positions.len() as u64;
    let mut edges = dense.edges as u64;
    let mut faces = dense.polygons.len() as u64;
    let mut corners = dense.polygons.corners().len() as u64;
    let mut open = dense.open.len() as u64;
    let mut large = dense.polygons.iter().filter(|p| p.len() > 3).count() as u64;
    let mut large_corners: u64 = dense.polygons.iter().filter(|p| p.len() > 3).map(|p| p.len() as u64).sum();
    for level in 1..=levels {
        match scheme {
            Scheme::Sqrt3 => {
                let cut = if level.is_multiple_of(2) { open } else { 0 };
                vertices += faces + cut;
                faces *= 3;
                open += 2 * cut;
                corners = 3 * faces;
                edges = (corners + open) / 2;
            }
            Scheme::CatmullClark => {
                vertices += edges + faces;
                edges = 2 * edges + corners;
                faces = corners;
                corners *= 4;
            }
            Scheme::Midpoint | Scheme::Loop => {
                let triangles = faces - large;
                vertices += edges + large;
                edges = 2 * edges + 3 * triangles + large_corners;
                faces = 4 * triangles + large_corners;
                corners = 12 * triangles + 4 * large_corners;
                large = large_corners;
                large_corners *= 4;
            }
        }
        let most = vertices.max(edges).max(corners);
        if faces > limit {
            return Err(SubdivideError::TooLarge { level, elements: faces, limit });
        }
        if most > MAX_ELEMENTS as u64 {
            return Err(SubdivideError::TooLarge { level, elements: most, limit: MAX_ELEMENTS as u64 });
        }
    }
    Ok(())
}

/// The mesh of the last level. Every scheme makes a manifold of a manifold, so what `Mesh::build` checks is not asked
/// again: new edges end in a vertex of their own edge or face, so no two of them join the same vertices.
fn build(dense: Dense) -> Result<Mesh, SubdivideError> {
    let (positions, polygons, pairing) = dense.into_parts();
    let pool = IndexedMesh::trusted(positions, polygons, None);
    match lay_out(&pool, &pairing) {
        Some(mesh) => Ok(mesh),
        None => Mesh::build(&pool).map_err(SubdivideError::Bug),
    }
}

/// Brings columns to where the elements of a fresh mesh are: in slots one past their numbers.
fn place(mesh: &Mesh, columns: &mut Columns) {
    for (kind, count) in [
        (Kind::Vertex, mesh.vertex_count() as u32),
        (Kind::Edge, mesh.edge_count() as u32),
        (Kind::Face, mesh.face_count() as u32),
    ] {
        columns.place(kind, count as usize + 1, 1..count + 1);
    }
    if !columns.none_on(Kind::Corner) {
        columns.place(Kind::Corner, mesh.next.len(), mesh.ordered_slots(Kind::Corner).into_iter());
    }
}

/// Followed by another, both by construction of fitting size.
fn followed(maps: &Maps, next: &Maps) -> Maps {
    maps.then(next).unwrap_or_default()
}
