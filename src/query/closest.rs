//! Nearest elements: vertices, edges, faces, face centres, points of the surface.

use super::batch::each_near_with;
use super::bvh::Tree;
use super::contains::Side;
use super::nearest::{Probe, segment_foot, triangle_foot};
use super::{Feature, MeshIndex};
use crate::geometry::unit_scale;
use crate::{Cancelled, Control, EdgeKey, FaceKey, VertexKey};
use glam::DVec3;

/// How nearest elements are looked for. The default looks everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestOptions {
    /// Nothing farther than this counts, in units of length; infinite by default.
    pub max_distance: f64,
    /// Whether [`closest_vertex`](MeshIndex::closest_vertex) takes vertices without a face into account; it does by
    /// default. Faces and edges have none.
    pub isolated_vertices: bool,
}

impl Default for ClosestOptions {
    fn default() -> Self {
        Self { max_distance: f64::INFINITY, isolated_vertices: true }
    }
}

/// Why a question about a place has no answer.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum QueryError {
    /// The point is NaN or infinite; in a batch, the first such point.
    #[error("the point {0} is not finite")]
    NonFinitePoint(DVec3),
    /// The maximum distance is NaN.
    #[error("the maximum distance is not a number")]
    MaxDistance,
    /// The hook of a batch said stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// The nearest element of a kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest<K> {
    /// The element.
    pub element: K,
    /// Its point that is nearest; the centre, if centres were asked for.
    pub point: DVec3,
    /// How far that is.
    pub distance: f64,
}

/// The nearest point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoint {
    /// The point.
    pub point: DVec3,
    /// How far it is.
    pub distance: f64,
    /// The face it lies on: at an edge or a vertex, the first of its faces in storage order.
    pub face: FaceKey,
    /// On what it lies.
    pub feature: Feature,
    /// The corners of the triangle it lies in: those of the face, or of a part of it if it has more than three.
    pub corners: [VertexKey; 3],
    /// Its barycentric coordinates: how much each of `corners` counts. They add up to one.
    pub barycentrics: [f64; 3],
    /// On which side of the surface the asking point is, by the angle-weighted normal of the feature: right for every
    /// point about a closed surface that does not cross itself (Bærentzen and Aanæs, "Signed Distance Computation Using
    /// the Angle Weighted Pseudonormal", IEEE TVCG 11(3), 2005). `On` on the surface, and where a rim or a face without
    /// area leaves it open. Decided in f64: [`SolidIndex::contains`](crate::SolidIndex::contains) is exact.
    pub side: Side,
}

impl ClosestPoint {
    /// The distance, negative inside.
    pub fn signed_distance(&self) -> f64 {
        if self.side == Side::Inside { -self.distance } else { self.distance }
    }
}

/// Defines the batch forms of a question.
macro_rules! batch {
    ($name:ident, $with:ident, $one:ident -> $out:ty) => {
        #[doc = concat!("[`", stringify!($one), "`](Self::", stringify!($one),
                                    ") for every point, on several threads with the feature `rayon`.")]
        ///
        /// # Errors
        /// [`QueryError`], of the first point that is not finite.
        pub fn $name(
            &self,
            points: &[DVec3],
            options: ClosestOptions,
        ) -> Result<Vec<Option<$out>>, QueryError> {
            self.$with(points, options, Control::none())
        }

        #[doc = concat!("[`", stringify!($name), "`](Self::", stringify!($name),
                                    ") with a progress-and-cancel hook.")]
        ///
        /// # Errors
        /// [`QueryError`], of the first point that is not finite, or `Cancelled`.
        pub fn $with(
            &self,
            points: &[DVec3],
            options: ClosestOptions,
            control: Control<'_>,
        ) -> Result<Vec<Option<$out>>, QueryError> {
            let key = |p: &DVec3| self.tree.point_key(*p);
            each_near_with(&self.tree, points, "closest", control, key, |&p| self.$one(p, options))?
                .into_iter()
                .collect()
        }
    };
}

impl MeshIndex<'_> {
    /// The vertex nearest to a point, the lowest in storage order of several; `None` if there is none within the maximum
    /// distance.
    ///
    /// # Errors
    /// [`QueryError`] if the point is not finite or the maximum distance is NaN.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::{DVec3, dvec3}};
    /// use meshwright::ClosestOptions;
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// let index = mesh.index();
    /// let nearest = index.closest_vertex(dvec3(3.0, 0.5, 0.0), ClosestOptions::default())?;
    /// assert_eq!(nearest.map(|n| n.point), Some(DVec3::X));
    /// let near = ClosestOptions { max_distance: 1.0, ..Default::default() };
    /// assert_eq!(index.closest_vertex(dvec3(3.0, 0.5, 0.0), near)?, None);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn closest_vertex(
        &self,
        point: DVec3,
        options: ClosestOptions,
    ) -> Result<Option<Nearest<VertexKey>>, QueryError> {
        check(point, options)?;
        let own = self.vertex_in(&self.tree, point, options);
        let other =
            if options.isolated_vertices { self.vertex_in(self.isolated(), point, options) } else { None };
        let slot = match (own, other) {
            (Some(v), Some(w)) => {
                let [a, b] = [v, w].map(|v| self.mesh.positions[v as usize] - point);
                let scale = unit_scale([a, b].into_iter());
                let [a, b] = [a, b].map(|d| (d * scale).length_squared());
                if (b, w) < (a, v) { w } else { v }
            }
            (own, other) => match own.or(other) {
                Some(v) => v,
                None => return Ok(None),
            },
        };
        Ok(within(self.mesh.vertices.key(slot), point, self.mesh.positions[slot as usize], options))
    }

    /// The point of the edges nearest to a point, with its edge: the lowest in storage order of several; `None` if there
    /// is none within the maximum distance. Edges of no length are points.
    ///
    /// # Errors
    /// [`QueryError`] if the point is not finite or the maximum distance is NaN.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{ClosestOptions, IndexedMesh, Mesh, glam::{DVec3, dvec3}};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// let nearest = mesh.index().closest_edge(dvec3(0.25, -1.0, 0.0), ClosestOptions::default())?;
    /// assert_eq!(nearest.map(|n| (n.point, n.distance)), Some((dvec3(0.25, 0.0, 0.0), 1.0)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn closest_edge(
        &self,
        point: DVec3,
        options: ClosestOptions,
    ) -> Result<Option<Nearest<EdgeKey>>, QueryError> {
        check(point, options)?;
        let tree = &self.tree;
        let probe = Probe::new(tree, point);
        let start = bound(options, tree.scale);
        let mut best: Option<(f64, u32, DVec3)> = None;
        probe.walk(start, |triangle| {
            let (corners, places) = (tree.corners(triangle), tree.places(triangle));
            for i in (0..3).filter(|&i| tree.is_edge(triangle, i)) {
                let j = (i + 1) % 3;
                // The same computation from both faces.
                let ends = if corners[i] < corners[j] { [i, j] } else { [j, i] };
                let [p, q] = ends.map(|k| places[k] - probe.point);
                let (square, along) = segment_foot(p, q);
                if best.is_none_or(|b| square <= b.0)
                    && let Some(h) = self.halfedge_slot(triangle, i)
                    && best.is_none_or(|b| (square, h >> 1) < (b.0, b.1))
                {
                    let [p, q] = ends.map(|k| places[k]);
                    let foot = if along == 1.0 { q } else { p + (q - p) * along };
                    best = Some((square, h >> 1, foot / tree.scale));
                }
            }
            best.map_or(start, |b| b.0.min(start))
        });
        Ok(best.and_then(|(_, e, foot)| within(self.mesh.edges.key(e), point, foot, options)))
    }

    /// The face nearest to a point, the lowest in storage order of several; `None` if there is none within the maximum
    /// distance. The face of [`closest_point`](Self::closest_point).
    ///
    /// # Errors
    /// [`QueryError`] if the point is not finite or the maximum distance is NaN.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{ClosestOptions, IndexedMesh, Mesh, glam::{DVec3, dvec3}};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// let nearest = mesh.index().closest_face(dvec3(0.25, 0.25, 2.0), ClosestOptions::default())?;
    /// assert_eq!(nearest.map(|n| (n.element, n.distance)), Some((mesh.faces().next().unwrap(), 2.0)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn closest_face(
        &self,
        point: DVec3,
        options: ClosestOptions,
    ) -> Result<Option<Nearest<FaceKey>>, QueryError> {
        check(point, options)?;
        Ok(self.surface(point, options).and_then(|found| {
            let foot = self.point(found.triangle, found.foot.weights, found.foot.part);
            within(self.mesh.faces.key(self.face_slot(found.triangle)), point, foot, options)
        }))
    }

    /// The face whose centre, the mean of its corners, is nearest to a point: the lowest in storage order of several;
    /// `None` if there is none within the maximum distance. Often not the nearest face: see
    /// [`closest_face`](Self::closest_face). The first such question builds an index over the centres.
    ///
    /// # Errors
    /// [`QueryError`] if the point is not finite or the maximum distance is NaN.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{ClosestOptions, IndexedMesh, Mesh, glam::{DVec3, dvec3}};
    /// # let points = vec![DVec3::ZERO, DVec3::X * 3.0, DVec3::Y * 3.0];
    /// # let mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// let nearest = mesh.index().closest_face_center(DVec3::ZERO, ClosestOptions::default())?;
    /// assert_eq!(nearest.map(|n| n.point), Some(dvec3(1.0, 1.0, 0.0)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn closest_face_center(
        &self,
        point: DVec3,
        options: ClosestOptions,
    ) -> Result<Option<Nearest<FaceKey>>, QueryError> {
        check(point, options)?;
        let tree = self.centers();
        let probe = Probe::new(tree, point);
        let start = bound(options, tree.scale);
        let mut best: Option<(f64, u32, DVec3)> = None;
        probe.walk(start, |triangle| {
            let [center, ..] = tree.places(triangle);
            let (square, face) = ((center - probe.point).length_squared(), tree.face(triangle));
            if best.is_none_or(|b| (square, face) < (b.0, b.1)) {
                best = Some((square, face, center / tree.scale));
            }
            best.map_or(start, |b| b.0.min(start))
        });
        Ok(best.and_then(|(_, f, center)| within(self.mesh.faces.key(f), point, center, options)))
    }

    /// The point of the surface nearest to a point, with its face, feature, barycentrics and the side the asking point is
    /// on; `None` if there is none within the maximum distance. Faces without area count as the lines or points they are.
    ///
    /// # Errors
    /// [`QueryError`] if the point is not finite or the maximum distance is NaN.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{ClosestOptions, Feature, IndexedMesh, Mesh, Side, glam::{DVec3, dvec3}};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// let found = mesh.index().closest_point(dvec3(0.25, 0.25, -2.0), ClosestOptions::default())?;
    /// let found = found.expect("there is a face");
    /// assert_eq!((found.point, found.side), (dvec3(0.25, 0.25, 0.0), Side::Inside));
    /// assert_eq!((found.signed_distance(), found.feature), (-2.0, Feature::Face(found.face)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn closest_point(
        &self,
        point: DVec3,
        options: ClosestOptions,
    ) -> Result<Option<ClosestPoint>, QueryError> {
        check(point, options)?;
        Ok(self.surface(point, options).and_then(|found| {
            let (triangle, foot) = (found.triangle, found.foot);
            let place = self.point(triangle, foot.weights, foot.part);
            let near = within(self.mesh.faces.key(self.face_slot(triangle)), point, place, options)?;
            Some(ClosestPoint {
                point: near.point,
                distance: near.distance,
                face: near.element,
                feature: self.feature(triangle, foot.part),
                corners: self.corners(triangle),
                barycentrics: foot.weights,
                side: self.side_at(triangle, foot.part, point, place),
            })
        }))
    }

    batch!(closest_vertex_batch, closest_vertex_batch_with, closest_vertex -> Nearest<VertexKey>);
    batch!(closest_edge_batch, closest_edge_batch_with, closest_edge -> Nearest<EdgeKey>);
    batch!(closest_face_batch, closest_face_batch_with, closest_face -> Nearest<FaceKey>);
    batch!(closest_face_center_batch, closest_face_center_batch_with, closest_face_center -> Nearest<FaceKey>);
    batch!(closest_point_batch, closest_point_batch_with, closest_point -> ClosestPoint);

    /// The slot of the nearest vertex of a tree.
    fn vertex_in(&self, tree: &Tree, point: DVec3, options: ClosestOptions) -> Option<u32> {
        let probe = Probe::new(tree, point);
        let start = bound(options, tree.scale);
        let mut best: Option<(f64, u32)> = None;
        probe.walk(start, |triangle| {
            for (v, place) in tree.corners(triangle).into_iter().zip(tree.places(triangle)) {
                let found = ((place - probe.point).length_squared(), v);
                if best.is_none_or(|b| found < b) {
                    best = Some(found);
                }
            }
            best.map_or(start, |b| b.0.min(start))
        });
        best.map(|b| b.1)
    }

    /// The nearest point of the surface in the tree's terms.
    fn surface(&self, point: DVec3, options: ClosestOptions) -> Option<Found> {
        let tree = &self.tree;
        let probe = Probe::new(tree, point);
        let start = bound(options, tree.scale);
        let mut best: Option<Found> = None;
        probe.walk(start, |triangle| {
            let limit = best.as_ref().map_or(start, |b| b.foot.square.min(start));
            let places = tree.places(triangle).map(|p| p - probe.point);
            if let Some(foot) = triangle_foot(places, tree.corners(triangle), limit)
                && best.as_ref().is_none_or(|b| {
                    let of = |t: u32| (self.face_slot(t), self.corner_slots(t));
                    foot.square < b.foot.square
                        || foot.square == b.foot.square && of(triangle) < of(b.triangle)
                })
            {
                best = Some(Found { triangle, foot });
            }
            best.as_ref().map_or(start, |b| b.foot.square.min(start))
        });
        best
    }
}

struct Found {
    triangle: u32,
    foot: super::nearest::Foot,
}

fn check(point: DVec3, options: ClosestOptions) -> Result<(), QueryError> {
    if !point.is_finite() {
        Err(QueryError::NonFinitePoint(point))
    } else if options.max_distance.is_nan() {
        Err(QueryError::MaxDistance)
    } else {
        Ok(())
    }
}

/// The square of the maximum distance in a tree's scale, a little more for rounding: [`within`] decides.
fn bound(options: ClosestOptions, scale: f64) -> f64 {
    let scaled = options.max_distance.max(0.0) * scale;
    scaled * scaled * (1.0 + 1e-9) + f64::MIN_POSITIVE
}

fn within<K>(element: K, from: DVec3, point: DVec3, options: ClosestOptions) -> Option<Nearest<K>> {
    let distance = length(point - from);
    (distance <= options.max_distance).then_some(Nearest { element, point, distance })
}

/// The length of a vector whose squares may overflow or vanish.
fn length(v: DVec3) -> f64 {
    let scale = unit_scale(std::iter::once(v));
    (v * scale).length() / scale
}
