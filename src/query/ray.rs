//! Rays: where a half-line meets the surface.

use super::batch::{each_chunk_with, each_with};
use super::cast::{Cast, Meeting, Part};
use super::contacts::{Event, events};
use super::lanes::cast_all;
use super::{Feature, MeshIndex};
use crate::{Cancelled, Control, FaceKey, VertexKey};
use glam::DVec3;
use std::ops::Range;

/// What the hook is told.
const RAYS: &str = "rays";

/// A half-line: all `origin + t * direction` with `t >= 0`. Finite, with a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    origin: DVec3,
    direction: DVec3,
}

/// Why there is no such ray.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RayError {
    /// The origin is NaN or infinite.
    #[error("the ray's origin {0} is not finite")]
    NonFiniteOrigin(DVec3),
    /// The direction is NaN or infinite.
    #[error("the ray's direction {0} is not finite")]
    NonFiniteDirection(DVec3),
    /// The direction is zero.
    #[error("the ray's direction is zero")]
    ZeroDirection,
}

impl Ray {
    /// The ray from a point in a direction, of any length but zero.
    ///
    /// # Errors
    /// [`RayError`] if one of them is not finite or the direction is zero.
    ///
    /// # Examples
    /// ```
    /// use meshwright::{Ray, RayError, glam::DVec3};
    /// assert_eq!(Ray::new(DVec3::ONE, DVec3::ZERO), Err(RayError::ZeroDirection));
    /// assert_eq!(Ray::new(DVec3::ONE, DVec3::X)?.at(2.0), DVec3::new(3.0, 1.0, 1.0));
    /// # Ok::<(), RayError>(())
    /// ```
    pub fn new(origin: DVec3, direction: DVec3) -> Result<Self, RayError> {
        if !origin.is_finite() {
            Err(RayError::NonFiniteOrigin(origin))
        } else if !direction.is_finite() {
            Err(RayError::NonFiniteDirection(direction))
        } else if direction == DVec3::ZERO {
            Err(RayError::ZeroDirection)
        } else {
            Ok(Self { origin, direction })
        }
    }

    /// Where the ray begins.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// Where it goes, as it was given.
    pub fn direction(&self) -> DVec3 {
        self.direction
    }

    /// The point at a parameter.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

/// What a ray does where it meets the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Crossing {
    /// It goes from the front of the faces, where their normals point, to the back: into a solid.
    Enter,
    /// It goes from the back to the front: out of a solid.
    Leave,
    /// It meets the surface and stays on its side: it grazes a vertex or an edge, runs along a face, or meets the rim of
    /// an open surface.
    Touch,
}

/// A meeting of a ray with the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// The ray's parameter, in lengths of its direction; not negative.
    pub t: f64,
    /// The point on the surface.
    pub point: DVec3,
    /// The face; at an edge or a vertex one of its faces: one that looks the way of the crossing, then the first.
    pub face: FaceKey,
    /// What exactly is met there.
    pub feature: Feature,
    /// Whether the ray crosses the surface, and which way.
    pub crossing: Crossing,
    /// The corners of the triangle that is met: those of the face, or of a part of it if it has more than three.
    pub corners: [VertexKey; 3],
    /// The barycentric coordinates of the point: how much each of `corners` counts. They add up to one.
    pub barycentrics: [f64; 3],
}

impl MeshIndex<'_> {
    /// Every meeting of a ray with the surface, by rising `t`; at equal `t` by face.
    ///
    /// Watertight and exact: no tolerance, and no ray slips through an edge or is counted twice there. On a closed mesh
    /// the crossings (hits that are no touch) are even in number from outside and odd from inside, more precisely: even
    /// exactly if the surface winds about the origin an even number of times.
    ///
    /// A ray that runs along faces or edges meets them as one event, at the `t` where it begins: a touch, or a crossing if
    /// it comes from the one side and goes away on the other. An origin on the surface meets it at `t = 0`; what it
    /// crosses there is judged as for the whole line, and is a touch if the line runs along a face or an edge there.
    /// Where a surface that crosses itself winds about a vertex several times, the ray crosses it as often.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{Crossing, Feature, IndexedMesh, Mesh, Polygons, Ray, glam::{DVec3, dvec3}};
    /// # let at = |i: u32| dvec3(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
    /// # let quads = vec![vec![0, 2, 3, 1], vec![4, 5, 7, 6], vec![0, 1, 5, 4], vec![2, 6, 7, 3], vec![0, 4, 6, 2], vec![1, 3, 7, 5]];
    /// # let cube = Mesh::build(&IndexedMesh::new((0..8).map(at).collect(), quads.into())?)?;
    /// // Along the diagonal of the unit cube: through two vertices.
    /// let hits = cube.index().hits(&Ray::new(DVec3::splat(-1.0), DVec3::ONE)?);
    /// let crossings: Vec<_> = hits.iter().map(|h| (h.t, h.crossing)).collect();
    /// assert_eq!(crossings, [(1.0, Crossing::Enter), (2.0, Crossing::Leave)]);
    /// assert!(matches!(hits[0].feature, Feature::Vertex(_)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn hits(&self, ray: &Ray) -> Vec<RayHit> {
        let cast = self.cast(ray);
        self.all(&cast).into_iter().map(|e| self.hit(cast.parameter(e.t), e)).collect()
    }

    /// The first of [`hits`](Self::hits), touches included, without looking for the others.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, Ray, glam::{DVec3, dvec3}};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// let down = Ray::new(dvec3(0.25, 0.25, 3.0), DVec3::NEG_Z)?;
    /// assert_eq!(mesh.index().first_hit(&down).map(|hit| hit.t), Some(3.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn first_hit(&self, ray: &Ray) -> Option<RayHit> {
        let cast = self.cast(ray);
        let mut first = First::default();
        cast.walk(true, |triangles| self.add_to_first(&cast, &mut first, triangles));
        self.first(&cast, &first).map(|(t, event)| self.hit(t, event))
    }

    /// Whether a ray meets the surface at all, touches included.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, Ray, glam::{DVec3, dvec3}};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// assert!(mesh.index().is_hit(&Ray::new(dvec3(0.25, 0.25, 3.0), DVec3::NEG_Z)?));
    /// assert!(!mesh.index().is_hit(&Ray::new(dvec3(0.25, 0.25, 3.0), DVec3::Z)?));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn is_hit(&self, ray: &Ray) -> bool {
        let cast = self.cast(ray);
        let mut found = false;
        cast.walk(true, |triangles| {
            found = found || is_met(&cast, triangles);
            if found { f32::NEG_INFINITY } else { f32::INFINITY }
        });
        found
    }

    /// [`hits`](Self::hits) of every ray, on several threads with the feature `rayon`.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, Ray, glam::{DVec3, dvec3}};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// let rays = [Ray::new(dvec3(0.25, 0.25, 3.0), DVec3::NEG_Z)?, Ray::new(dvec3(2.0, 2.0, 3.0), DVec3::NEG_Z)?];
    /// let index = mesh.index();
    /// assert_eq!(index.hits_batch(&rays).iter().map(Vec::len).collect::<Vec<_>>(), [1, 0]);
    /// assert!(index.first_hit_batch(&rays)[1].is_none());
    /// assert_eq!(index.is_hit_batch(&rays), [true, false]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn hits_batch(&self, rays: &[Ray]) -> Vec<Vec<RayHit>> {
        self.hits_batch_with(rays, Control::none()).unwrap_or_default()
    }

    /// [`hits_batch`](Self::hits_batch) with a progress-and-cancel hook.
    ///
    /// # Errors
    /// [`Cancelled`] when the hook says so.
    pub fn hits_batch_with(&self, rays: &[Ray], control: Control<'_>) -> Result<Vec<Vec<RayHit>>, Cancelled> {
        each_with(rays, RAYS, control, |ray| self.hits(ray))
    }

    /// [`first_hit`](Self::first_hit) of every ray, on several threads with the feature `rayon`. On large meshes faster than
    /// one by one even on one thread.
    pub fn first_hit_batch(&self, rays: &[Ray]) -> Vec<Option<RayHit>> {
        self.first_hit_batch_with(rays, Control::none()).unwrap_or_default()
    }

    /// [`first_hit_batch`](Self::first_hit_batch) with a progress-and-cancel hook.
    ///
    /// # Errors
    /// [`Cancelled`] when the hook says so.
    pub fn first_hit_batch_with(
        &self,
        rays: &[Ray],
        control: Control<'_>,
    ) -> Result<Vec<Option<RayHit>>, Cancelled> {
        each_chunk_with(rays, RAYS, control, |rays| {
            let mut events = vec![None; rays.len()];
            cast_all(
                &self.tree,
                rays.len(),
                |i| (self.cast(&rays[i]), First::default()),
                |cast, first, triangles| self.add_to_first(cast, first, triangles),
                |i, cast, first| events[i] = self.first(cast, first),
            );
            // All that is fetched for one at the same time as for the next.
            events.into_iter().map(|e| e.map(|(t, event)| self.hit(t, event))).collect()
        })
    }

    /// [`is_hit`](Self::is_hit) of every ray, on several threads with the feature `rayon`.
    pub fn is_hit_batch(&self, rays: &[Ray]) -> Vec<bool> {
        self.is_hit_batch_with(rays, Control::none()).unwrap_or_default()
    }

    /// [`is_hit_batch`](Self::is_hit_batch) with a progress-and-cancel hook.
    ///
    /// # Errors
    /// [`Cancelled`] when the hook says so.
    pub fn is_hit_batch_with(&self, rays: &[Ray], control: Control<'_>) -> Result<Vec<bool>, Cancelled> {
        each_chunk_with(rays, RAYS, control, |rays| {
            let mut hits = vec![false; rays.len()];
            cast_all(
                &self.tree,
                rays.len(),
                |i| (self.cast(&rays[i]), false),
                |cast, found, triangles| {
                    *found = is_met(cast, triangles);
                    if *found { f32::NEG_INFINITY } else { f32::INFINITY }
                },
                |i, _, found| hits[i] = *found,
            );
            hits
        })
    }

    /// Looks at triangles that the ray of a first hit may meet, and says up to where others matter.
    #[inline]
    fn add_to_first(&self, cast: &Cast<'_>, first: &mut First, triangles: Range<u32>) -> f32 {
        for triangle in triangles {
            match cast.meet(triangle, first.best.map_or(f64::INFINITY, |b| b.t)) {
                Meeting::Miss => {}
                Meeting::Through(passing) => {
                    let event = through(passing);
                    if first.best.is_none_or(|b| self.order(&event, &b).is_lt()) {
                        first.best = Some(event);
                    }
                }
                Meeting::Touching(_) => first.is_touching = true,
            }
        }
        first.best.map_or(f32::INFINITY, |b| cast.limit(b.t))
    }

    /// The event and its parameter.
    fn first(&self, cast: &Cast<'_>, first: &First) -> Option<(f64, Event)> {
        // What happens at an edge shows only when everything there is known.
        let event = if first.is_touching { self.all(cast).into_iter().next() } else { first.best };
        event.map(|e| (cast.parameter(e.t), e))
    }

    fn cast(&self, ray: &Ray) -> Cast<'_> {
        Cast::new(&self.tree, ray.origin, ray.direction)
    }

    fn all(&self, cast: &Cast<'_>) -> Vec<Event> {
        let (mut found, mut contacts) = (Vec::new(), Vec::new());
        cast.walk(false, |triangles| {
            for triangle in triangles {
                match cast.meet(triangle, f64::INFINITY) {
                    Meeting::Miss => {}
                    Meeting::Through(passing) => found.push(through(passing)),
                    Meeting::Touching(contact) => contacts.push(contact),
                }
            }
            f32::INFINITY
        });
        if !contacts.is_empty() {
            events(cast, &contacts, &mut found);
        }
        found.sort_by(|a, b| self.order(a, b));
        found
    }

    /// By parameter, then by face; the rest only makes the order whole.
    fn order(&self, a: &Event, b: &Event) -> std::cmp::Ordering {
        let rest = |e: &Event| (self.face_slot(e.triangle), e.crossing, self.corner_slots(e.triangle));
        a.t.total_cmp(&b.t).then_with(|| rest(a).cmp(&rest(b)))
    }

    fn hit(&self, t: f64, event: Event) -> RayHit {
        RayHit {
            t,
            point: self.point(event.triangle, event.weights, event.part),
            face: self.mesh.faces.key(self.face_slot(event.triangle)),
            feature: self.feature(event.triangle, event.part),
            crossing: match event.crossing {
                0 => Crossing::Touch,
                1 => Crossing::Leave,
                _ => Crossing::Enter,
            },
            corners: self.corners(event.triangle),
            barycentrics: event.weights,
        }
    }
}

/// What is known of a first hit.
#[derive(Default)]
struct First {
    best: Option<Event>,
    /// Whether an edge or a vertex has been met on the way.
    is_touching: bool,
}

/// Whether a ray meets one of these triangles.
fn is_met(cast: &Cast<'_>, mut triangles: Range<u32>) -> bool {
    triangles.any(|triangle| match cast.meet(triangle, f64::INFINITY) {
        Meeting::Miss => false,
        Meeting::Through(_) => true,
        Meeting::Touching(contact) => contact.at.iter().any(|touched| touched.t >= 0.0),
    })
}

fn through(passing: super::cast::Passing) -> Event {
    Event {
        triangle: passing.triangle,
        t: passing.t,
        weights: passing.weights,
        part: Part::Inside,
        crossing: passing.facing,
    }
}
