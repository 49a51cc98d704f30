//! Reduction to fewer faces by edge collapse.
//!
//! The work is done on a compact copy of the mesh ([`copy`]; [`part`] holds its records) whose edges wait in a [`queue`] by
//! what their collapse costs ([`place`], [`quadric`]); [`attempt`] does or refuses one, [`run`] is the loop, [`rounds`] has
//! several of them on the parts of a large mesh, and [`write`] brings the result back, so that what is left keeps its keys.

mod attempt;
mod copy;
mod features;
mod part;
mod place;
mod quadric;
mod queue;
mod rounds;
mod run;
mod told;
mod write;

use crate::{BadOption, Cancelled, Control, EdgeKey, FaceKey, Mesh, VertexKey};
use attempt::Guards;
use copy::Copy;
use glam::DVec3;
use rounds::Outcome;
use run::Account;
use std::fmt;

/// A vertex with more edges stays where it is while others go into it: walking around it each time would be quadratic.
const HEAVY: u32 = 512;

/// How far a mesh is to be reduced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ReduceTarget {
    /// To this many faces, or one less: a collapse takes two.
    Faces(usize),
    /// To this share of the faces, in `0.0..=1.0` without 0.
    Ratio(f64),
    /// As far as no vertex gets further than this from the planes of the original faces it stands for, and along feature
    /// edges from those that stand upright on them: in the root of the mean square over their areas, as a length in the
    /// units of the mesh. No bound on the distance between the surfaces, but close to what that is on average: on real
    /// models single vertices came to lie up to six times as far off the surface, and twice as far off a curved rim.
    MaxError(f64),
}

/// How a mesh is reduced.
///
/// *Feature edges* are boundary edges, seams, borders of groups, sharp edges and locked edges. A vertex with two of them
/// moves along the line they make; one with another number of them stays where it is.
#[derive(Debug)]
pub struct ReduceOptions<'a> {
    /// How far.
    pub target: ReduceTarget,
    /// How much the planes that stand upright on feature edges count, beside those of faces as large as the edge's square.
    pub line_weight: f64,
    /// Edges at which the normals of the two faces differ by more than this are features. Without, sharp edges are kept
    /// as far as the error tells.
    pub sharp_degrees: Option<f64>,
    /// Whether edges at which corner data differs (texture coordinates, the caller's columns; not normals) are features.
    pub keep_seams: bool,
    /// Whether edges between faces of different groups are features.
    pub keep_groups: bool,
    /// Vertices that stay, and stay where they are.
    pub locked_vertices: &'a [VertexKey],
    /// Edges that stay as they are, with both their ends.
    pub locked_edges: &'a [EdgeKey],
    /// No collapse turns a face by more than this, which is at most 90.
    pub max_turn_degrees: f64,
    /// No collapse leaves a triangle whose shape is below this, unless it was so before: 1 is equilateral, 0 has no area.
    pub min_shape: f64,
    /// Progress and cancelling.
    pub control: Control<'a>,
}

impl Default for ReduceOptions<'_> {
    /// To half the faces; features but sharp edges kept, nothing locked.
    fn default() -> Self {
        Self {
            target: ReduceTarget::Ratio(0.5),
            line_weight: 10.0,
            sharp_degrees: None,
            keep_seams: true,
            keep_groups: true,
            locked_vertices: &[],
            locked_edges: &[],
            max_turn_degrees: 78.0,
            min_shape: 1e-4,
            control: Control::none(),
        }
    }
}

/// Why nothing was reduced. Nothing has changed then.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReduceError {
    /// The mesh has no faces.
    #[error("there are no faces")]
    Empty,
    /// No mesh is left with zero faces.
    #[error("a target of no faces makes no sense")]
    NoFaces,
    /// A ratio must be above 0 and at most 1.
    #[error("a ratio of {0} is not above 0 and at most 1")]
    BadRatio(f64),
    /// An error bound must be a number of 0 or more.
    #[error("an error bound of {0} makes no sense")]
    BadErrorBound(f64),
    /// Another option is out of range.
    #[error(transparent)]
    BadOption(#[from] BadOption),
    /// A locked vertex is not there.
    #[error("{0:?} is not a vertex of the mesh")]
    MissingVertex(VertexKey),
    /// A locked edge is not there.
    #[error("{0:?} is not an edge of the mesh")]
    MissingEdge(EdgeKey),
    /// The mesh has more edges than a reduction can number.
    #[error("{edges} edges are more than {limit}")]
    TooLarge {
        /// How many there are.
        edges: usize,
        /// How many there may be.
        limit: usize,
    },
    /// The hook said stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Why a reduction ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Stopped {
    /// There are no more faces than asked for.
    Target,
    /// Every collapse that is left is illegal or exceeds the error bound.
    ErrorBound,
    /// Every collapse that is left is refused; [`Reduced::refusals`] tells why.
    NoLegalCollapse,
}

impl Stopped {
    /// The name used in JSON.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Target => "target",
            Self::ErrorBound => "error-bound",
            Self::NoLegalCollapse => "no-legal-collapse",
        }
    }
}

impl fmt::Display for Stopped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

/// Why an edge is not collapsed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Refusal {
    Topology,
    Feature,
    Locked,
    Valence,
    Flip,
    Shape,
    ErrorBound,
    /// An end waits until the parts have come together.
    Later,
}

/// How often a collapse was refused, by reason; an edge counts again whenever it is looked at again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Refusals {
    /// [`Mesh::check_collapse`] refuses it.
    pub topology: usize,
    /// It would pull a vertex off its feature line, or make two feature edges one.
    pub feature: usize,
    /// Both ends stay where they are.
    pub locked: usize,
    /// Both ends have very many edges.
    pub valence: usize,
    /// A face would turn too far.
    pub flip: usize,
    /// A face would become too thin.
    pub shape: usize,
    /// The error would be too large.
    pub error_bound: usize,
}

/// The account of [`Mesh::reduce`].
#[derive(Clone, Debug, PartialEq)]
pub struct Reduced {
    /// The number of faces before.
    pub faces_before: usize,
    /// The number of faces now.
    pub faces: usize,
    /// The number of collapses.
    pub collapses: usize,
    /// Why it ended.
    pub stopped: Stopped,
    /// The largest error of a vertex that is left, as [`ReduceTarget::MaxError`] measures it; in the units of the mesh.
    pub max_error: f64,
    /// What was refused on the way.
    pub refusals: Refusals,
    /// Faces of more than three corners that were cut into triangles to begin with.
    pub cut: Vec<FaceKey>,
    /// Each vertex that is gone with the one it went into in the end, in storage order.
    pub merged: Vec<(VertexKey, VertexKey)>,
}

/// How many faces may be left, and with which error.
struct Goal {
    faces: usize,
    error: f64,
}

impl ReduceOptions<'_> {
    fn goal(&self, faces: usize) -> Result<Goal, ReduceError> {
        let in_range = |option, value: f64, is_fine: bool| {
            if is_fine { Ok(()) } else { Err(BadOption { option, value }) }
        };
        let (weight, turn, shape) = (self.line_weight, self.max_turn_degrees, self.min_shape);
        in_range("line_weight", weight, (0.0..=1e6).contains(&weight))?;
        in_range("max_turn_degrees", turn, turn > 0.0 && turn <= 90.0)?;
        in_range("min_shape", shape, (0.0..1.0).contains(&shape))?;
        if let Some(degrees) = self.sharp_degrees {
            in_range("sharp_degrees", degrees, (0.0..=180.0).contains(&degrees))?;
        }
        match self.target {
            ReduceTarget::Faces(0) => Err(ReduceError::NoFaces),
            ReduceTarget::Faces(n) => Ok(Goal { faces: n, error: f64::INFINITY }),
            ReduceTarget::Ratio(r) if r > 0.0 && r <= 1.0 => {
                Ok(Goal { faces: ((r * faces as f64) as usize).max(1), error: f64::INFINITY })
            }
            ReduceTarget::Ratio(r) => Err(ReduceError::BadRatio(r)),
            ReduceTarget::MaxError(e) if e >= 0.0 => Ok(Goal { faces: 0, error: e }),
            ReduceTarget::MaxError(e) => Err(ReduceError::BadErrorBound(e)),
        }
    }
}

/// # Reduction
impl Mesh {
    /// Reduces the number of faces by collapsing edges, the one with the least error first.
    ///
    /// What a collapse costs is the squared distances to the planes of the faces around the edge, weighted by area (Garland
    /// and Heckbert, "Surface simplification using quadric error metrics", 1997), as they are by then and not as they
    /// were (Lindstrom and Turk, "Evaluation of memoryless simplification", 1999); vertices are placed where that is
    /// least and the volume stays the same. The error that is bounded and told is measured to the original faces.
    ///
    /// Every collapse is one that [`check_collapse`](Self::check_collapse) allows: components, genus and boundary loops
    /// stay, a tetrahedron keeps its four faces. None turns a face over; boundaries, seams, borders of groups and locked
    /// elements stay ([`ReduceOptions`]). Where that leaves nothing to collapse it ends early and says so.
    ///
    /// Faces of more than three corners are cut into triangles first, by the rule of
    /// [`triangulate_face`](Self::triangulate_face) ([poked](Self::poke_face) where that would double an edge) and named
    /// in the account; none are if the mesh has few enough faces as it is. Elements that are left keep their keys. Columns,
    /// attributes, checkpoints and the record of changes see every collapse.
    ///
    /// The result depends on nothing but the mesh and the options. O(n log n); a large mesh is reduced in parts, on several
    /// threads with the feature `rayon`, with the same result for any number of them. There, and in any mesh of more than
    /// some 130,000 edges, the order is strictly that of the costs near the target alone, and before that within a factor
    /// of two.
    ///
    /// # Errors
    /// [`ReduceError`]; nothing has changed then.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, ReduceOptions, ReduceTarget, Stopped, glam::DVec3};
    /// // A hilly square of 2 × 20 × 20 triangles.
    /// let hill = |i: u32| DVec3::new(f64::from(i % 21), f64::from(i / 21), f64::from(i % 21 * (i / 21)).sin());
    /// let squares = (0..400).map(|i| i / 20 * 21 + i % 20);
    /// let triangles: Vec<_> = squares.flat_map(|a| [[a, a + 1, a + 22], [a, a + 22, a + 21]]).collect();
    /// let mut mesh = Mesh::build(&IndexedMesh::from_triangles((0..441).map(hill).collect(), &triangles)?)?;
    ///
    /// let account = mesh.reduce(ReduceOptions { target: ReduceTarget::Faces(200), ..Default::default() })?;
    /// assert_eq!(account.stopped, Stopped::Target);
    /// assert!(mesh.face_count() <= 200 && mesh.validate().is_ok());
    /// println!("{} collapses, error at most {}", account.collapses, account.max_error);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn reduce(&mut self, mut options: ReduceOptions<'_>) -> Result<Reduced, ReduceError> {
        let before = self.face_count();
        let goal = options.goal(before)?;
        if before == 0 {
            return Err(ReduceError::Empty);
        }
        self.check_locks(&options)?;
        options.control.report("copy", 0.0)?;
        let nothing = Reduced {
            faces_before: before,
            faces: before,
            collapses: 0,
            stopped: Stopped::Target,
            max_error: 0.0,
            refusals: Refusals::default(),
            cut: Vec::new(),
            merged: Vec::new(),
        };
        if before <= goal.faces {
            return Ok(nothing);
        }
        let polygons: Vec<FaceKey> =
            self.faces.live().filter(|&f| !self.is_triangle_slot(f)).map(|f| self.faces.key(f)).collect();
        let account = if polygons.is_empty() {
            self.reduce_triangles(&goal, &mut options)?
        } else {
            // A call that is cancelled changes nothing.
            let mut triangles = self.clone();
            polygons.iter().for_each(|&f| triangles.cut(f));
            let account = triangles.reduce_triangles(&goal, &mut options)?;
            *self = triangles;
            account
        };
        Ok(Reduced { faces: self.face_count(), cut: polygons, ..account.told(nothing) })
    }

    fn reduce_triangles(
        &mut self,
        goal: &Goal,
        options: &mut ReduceOptions<'_>,
    ) -> Result<Told, ReduceError> {
        let (edges, limit) = (self.edge_count(), part::MAX_EDGES);
        if edges > limit {
            return Err(ReduceError::TooLarge { edges, limit });
        }
        let mut copy = Copy::of(self);
        copy.mark(self, options);
        copy.sum_planes(options.line_weight, goal.error.is_finite());
        options.control.report("collapse", 0.1)?;
        let guards = Guards {
            turn: options.max_turn_degrees.to_radians().cos().powi(2),
            shape: options.min_shape,
            error: goal.error / copy.frame.length(1.0),
            line_weight: options.line_weight,
        };
        let is_watched = !self.columns.is_empty() || self.undo.is_some() || self.changes.is_some();
        let faces = self.face_count() - goal.faces;
        let Outcome { is_met, account, log } =
            copy.reduce(faces, guards, is_watched, &mut options.control)?;
        let roots = copy.roots();
        // At most the bound, but for rounding.
        let max_error = copy.frame.length(copy.error(self, &roots)).min(goal.error);
        let merged = copy.merged(self, &roots);
        options.control.report("write", 0.9)?;
        match log {
            Some(log) => self.replay(&copy, log),
            None => self.take_over(&mut copy),
        }
        let stopped = match (is_met, account.is_bounded) {
            (true, _) => Stopped::Target,
            (false, true) => Stopped::ErrorBound,
            (false, false) => Stopped::NoLegalCollapse,
        };
        Ok(Told { account, stopped, merged, max_error })
    }

    fn is_triangle_slot(&self, f: u32) -> bool {
        let h = self.face_halfedge[f as usize] as usize;
        self.next[self.next[h] as usize] == self.prev[h]
    }

    /// Cuts a face into triangles, whatever stands in the way.
    fn cut(&mut self, f: FaceKey) {
        if self.triangulate_face(f).is_err() {
            let middle = self.middle(f);
            // A face can always be poked.
            let _ = self.poke_face(f, middle);
        }
    }

    fn middle(&self, f: FaceKey) -> DVec3 {
        let count = self.degree(f) as f64;
        self.face_vertices(f).map(|v| self.position(v) / count).sum()
    }
}

/// What there is to tell.
struct Told {
    account: Account,
    stopped: Stopped,
    merged: Vec<(VertexKey, VertexKey)>,
    max_error: f64,
}

impl Told {
    fn told(self, of: Reduced) -> Reduced {
        let Account { collapses, refusals, .. } = self.account;
        Reduced {
            collapses,
            refusals,
            stopped: self.stopped,
            merged: self.merged,
            max_error: self.max_error,
            ..of
        }
    }
}
