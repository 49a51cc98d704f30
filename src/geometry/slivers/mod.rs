//! Slivers: faces without height, resolved so that no hole opens.
//!
//! [`shape`] measures a face, [`judge`] says whether a change is fit to be made, [`act`] makes it, [`clear`] moves
//! obstacles out of its way, and [`run`] is the loop with its account.

mod act;
mod clear;
mod judge;
mod run;
mod shape;

use crate::{Aabb, Cancelled, Control, FaceKey, Mesh};
use glam::DVec3;
use run::Run;
use shape::Gauge;

/// How slivers are resolved.
#[derive(Debug, Default)]
pub struct SliverOptions<'a> {
    /// A face whose height is at most this is a sliver; a length in the units of the mesh.
    /// [`Mesh::propose_sliver_tolerance`] has one; with 0, the default, only faces of exactly no area count.
    pub tolerance: f64,
    /// Progress and cancelling.
    pub control: Control<'a>,
}

impl SliverOptions<'_> {
    /// With a tolerance, and without a hook.
    ///
    /// # Examples
    /// ```
    /// use meshwright::{Mesh, SliverError, SliverOptions};
    /// let refused = Mesh::default().resolve_slivers(SliverOptions::new(-1.0));
    /// assert_eq!(refused, Err(SliverError::BadTolerance(-1.0)));
    /// ```
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, control: Control::none() }
    }
}

/// Why no sliver was resolved. Nothing has changed then.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SliverError {
    /// A tolerance must be a number of 0 or more.
    #[error("a tolerance of {0} makes no sense")]
    BadTolerance(f64),
    /// The hook said stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// What makes a face a sliver.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum SliverKind {
    /// One of its edges is no longer than the tolerance.
    Needle,
    /// A triangle, with a corner within the tolerance of the opposite edge.
    Cap,
    /// A larger face that has no height, or of which the crate's one triangulation rule cuts off a triangle that has none.
    Flat,
}

impl SliverKind {
    /// The name used in JSON.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Needle => "needle",
            Self::Cap => "cap",
            Self::Flat => "flat",
        }
    }
}

/// What resolved a sliver.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum SliverAction {
    /// An edge was collapsed into one of its ends.
    Collapsed,
    /// The corner of a cap went into the face across its longest edge: what a flip of that edge does to triangles. A larger
    /// face gains a corner and stays one face.
    Merged,
    /// A cap whose longest edge was on the boundary, or that hung on by one edge, was taken off.
    Removed,
    /// A larger face was cut along diagonals.
    Cut,
}

impl SliverAction {
    /// The name used in JSON.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Collapsed => "collapsed",
            Self::Merged => "merged",
            Self::Removed => "removed",
            Self::Cut => "cut",
        }
    }
}

/// Why a sliver is left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum SliverObstacle {
    /// No operator would leave a valid mesh.
    Topology,
    /// The boundary would be pinched: the surface has no width between two places of it.
    Pinch,
    /// A face would turn over.
    Turn,
    /// Other faces would become slivers that are no better.
    NoGain,
    /// The surface would move further than the tolerance.
    Moves,
    /// All faces of the component are slivers, and some must stay.
    WholeComponent,
    /// The bound on the work was reached.
    Limit,
}

impl SliverObstacle {
    /// The name used in JSON.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Topology => "topology",
            Self::Pinch => "pinch",
            Self::Turn => "turn",
            Self::NoGain => "no-gain",
            Self::Moves => "moves",
            Self::WholeComponent => "whole-component",
            Self::Limit => "limit",
        }
    }
}

/// A face without height.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Sliver {
    /// The face.
    pub face: FaceKey,
    /// What makes it one.
    pub kind: SliverKind,
    /// Its height: twice its area over the longest edge of a triangle, over the distance of two far corners of a larger
    /// face.
    pub height: f64,
    /// The mean of its corners.
    pub place: DVec3,
}

/// A sliver that is no more.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ResolvedSliver {
    /// The face as it was; it may be gone.
    pub sliver: Sliver,
    /// What was done.
    pub action: SliverAction,
    /// No point of the surface moved further than this by that step.
    pub moved: f64,
}

/// A sliver that is still there.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct LeftSliver {
    /// The face.
    pub sliver: Sliver,
    /// Why.
    pub obstacle: SliverObstacle,
}

/// The account of [`Mesh::resolve_slivers`]. Every sliver that was found at the beginning or arose on the way stands in it
/// exactly once, resolved or left: `found + arose` are as many as both lists together.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct SliverAccount {
    /// The tolerance.
    pub tolerance: f64,
    /// How many slivers there were at the beginning.
    pub found: usize,
    /// How many arose on the way, smaller than those they came from.
    pub arose: usize,
    /// What was done, in order.
    pub resolved: Vec<ResolvedSliver>,
    /// What could not be done, in the order of the faces' keys.
    pub left: Vec<LeftSliver>,
    /// How often an edge or a face that was no sliver was split to make way.
    pub splits: usize,
    /// The furthest that a step moved the surface.
    pub moved: f64,
}

/// # Slivers
impl Mesh {
    /// The faces whose height is at most a tolerance, in storage order. None with a tolerance below 0 or NaN.
    /// O(corners).
    ///
    /// # Examples
    /// ```
    /// use meshwright::{IndexedMesh, Mesh, SliverKind, glam::DVec3};
    /// // The middle of one edge of the second triangle lies on the first's.
    /// let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X / 2.0];
    /// let mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2], [1, 0, 3]])?)?;
    /// let slivers = mesh.slivers(mesh.propose_sliver_tolerance());
    /// assert_eq!((slivers.len(), slivers[0].kind, slivers[0].height), (1, SliverKind::Cap, 0.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn slivers(&self, tolerance: f64) -> Vec<Sliver> {
        if tolerance.is_nan() || tolerance < 0.0 {
            return Vec::new();
        }
        let mut gauge = Gauge::new(self, tolerance);
        self.faces.live().filter_map(|f| gauge.sliver(self, f)).collect()
    }

    /// A tolerance for [`resolve_slivers`](Self::resolve_slivers) from the data: 1e-10 of the diagonal of the box around
    /// all vertices, but not less than 16 steps of `f64` at the largest coordinate, which is what rounding makes of a face
    /// without area. No thin face that anybody meant is near it. 0 for a mesh without extent. O(vertices).
    ///
    /// # Examples
    /// ```
    /// use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// let points = vec![DVec3::ZERO, DVec3::X * 3.0, DVec3::Y * 4.0];
    /// let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// assert_eq!(mesh.propose_sliver_tolerance(), 5e-10);
    /// mesh.translate(DVec3::splat(1e9))?;
    /// assert!(mesh.propose_sliver_tolerance() > 1e-6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn propose_sliver_tolerance(&self) -> f64 {
        let points = || self.vertices.live().map(|v| self.positions[v as usize]);
        let Some(Aabb { min, max }) = Aabb::around(points()) else { return 0.0 };
        if min == max {
            return 0.0;
        }
        let largest = min.abs().max(max.abs()).max_element();
        // Scaled down: the diagonal may be beyond f64.
        (super::distance(min * 1e-10, max * 1e-10)).max(16.0 * f64::EPSILON * largest)
    }

    /// Resolves slivers: faces whose height is at most a tolerance go, without a hole and without a crack.
    ///
    /// ```text
    ///   ●─────────────●         ●─────────────●       A needle's short edge is collapsed into one of its ends:
    ///   │      f      │         │     ╱ ╲     │       that which moves the surface less, so one on a feature stays.
    ///   a ─ cap ─ c ─ b    →    a ── c ─────── b       A cap's corner goes into the face across its longest edge:
    ///   │     g       │         │     g       │       two triangles take the place of a triangle, a larger face
    ///   ●─────────────●         ●─────────────●       stays one and has a corner more.
    /// ```
    ///
    /// A cap with its longest edge on the boundary is taken off. A larger face without height is cut along diagonals, and
    /// the triangles are resolved; where the rule of [`triangulate_face`](Self::triangulate_face) would cut a triangle
    /// without height off a face that has height, that face is cut so that none is. Where an operator is refused because an
    /// edge or a face is in the way, that is split, which moves nothing.
    ///
    /// Euler characteristic, components and boundary loops stay what they are, and a closed mesh stays closed. No step
    /// moves a point of the surface further than the tolerance, and none turns a face over; but where all faces around a
    /// vertex are slivers, a spike without width, or a face without width that hangs on by one edge, it is drawn in
    /// at last, and the account tells how long it was. Each step leaves fewer slivers or shorter ones (the longest first, as
    /// a multiset), so it ends; there is a bound on the work as well. What is left is named with the reason: a component
    /// of which all faces are slivers is never removed.
    ///
    /// Every step is an operator: columns, attributes, checkpoints and the record of changes see it. The faces beside a
    /// cap keep their own data. The result depends on nothing but the mesh and the options. O(n log n), on one thread; a
    /// mesh with slivers is copied, one without is only read.
    ///
    /// The cases are those of Botsch and Kobbelt, "A robust procedure to eliminate degenerate faces from triangle meshes",
    /// 2001; the order is our own.
    ///
    /// # Errors
    /// [`SliverError`]; nothing has changed then.
    ///
    /// # Examples
    /// ```
    /// use meshwright::{IndexedMesh, Mesh, Polygons, SliverAction, SliverOptions, glam::DVec3};
    /// // Two squares whose common edge has a third vertex on it, and a triangle without area in the gap.
    /// let points = [[0., 0.], [1., 0.], [2., 0.], [0., 1.], [1., 1.], [2., 1.], [1., 0.5]];
    /// let points = points.map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec();
    /// let faces = vec![vec![0, 1, 4, 3], vec![1, 2, 5, 4, 6], vec![1, 6, 4]];
    /// let mut mesh = Mesh::build(&IndexedMesh::new(points, Polygons::from(faces))?)?;
    ///
    /// let account = mesh.resolve_slivers(SliverOptions::new(mesh.propose_sliver_tolerance()))?;
    /// assert_eq!((account.found, account.resolved[0].action), (1, SliverAction::Merged));
    /// assert_eq!((account.left.len(), account.moved), (0, 0.0));
    /// assert_eq!(mesh.faces().map(|f| mesh.degree(f)).collect::<Vec<_>>(), [5, 5]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn resolve_slivers(&mut self, options: SliverOptions<'_>) -> Result<SliverAccount, SliverError> {
        let SliverOptions { tolerance, mut control } = options;
        if !(tolerance >= 0.0 && tolerance.is_finite()) {
            return Err(SliverError::BadTolerance(tolerance));
        }
        control.report("slivers", 0.0)?;
        let found = self.slivers(tolerance);
        if found.is_empty() {
            return Ok(SliverAccount { tolerance, ..SliverAccount::default() });
        }
        // A call that is cancelled changes nothing.
        let mut run = Run::new(self.clone(), tolerance, found);
        run.resolve(&mut control)?;
        let (mesh, account) = run.finish();
        if account.resolved.is_empty() {
            // What was split to make way made none.
            return Ok(SliverAccount { splits: 0, ..account });
        }
        *self = mesh;
        Ok(account)
    }
}
