//! What becomes of values when elements are split, merged and moved.

use super::turn::{Direction, Turning, mixed_normal, mixed_tangent};
use glam::{DVec2, DVec3, DVec4, Vec2, Vec3, Vec4};
use std::fmt;
use std::sync::Arc;

/// What happened to the element whose value is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Event {
    /// It was made by splitting others: the sources are what it lies between, with their weights.
    Split,
    /// It took in others: the first source is its own value.
    Merge,
    /// A vertex was moved by [`set_position`](crate::Mesh::set_position), a collapse or a bulk operation; the only source is
    /// its own value.
    Move,
}

/// A custom rule: the new value from what happened and the weighted sources.
type Custom<T> = Arc<dyn Fn(Event, &[(&T, f64)]) -> T + Send + Sync>;

/// The new value from the old one and what turns it.
type Turn<T> = Arc<dyn Fn(&T, &Turning) -> T + Send + Sync>;

/// What becomes of the values of a column when an operator splits or merges elements. Declared once, when the column is
/// made.
///
/// A new value is made of *sources* with weights that sum to one: a vertex that splits an edge a quarter of the way has
/// its ends with 3/4 and 1/4, one that pokes a face has its corners with their mean value coordinates. An element made
/// from nothing (a new face, a spoke) holds the column's default.
///
/// # Examples
/// ```
/// use meshwright::{Event, Rule};
/// // Counts how many faces went into one.
/// let count = Rule::custom(|event, sources: &[(&u32, f64)]| match event {
///     Event::Merge => sources.iter().map(|(n, _)| **n).sum(),
///     _ => *sources[0].0,
/// });
/// # let _: Rule<u32> = count;
/// ```
pub struct Rule<T> {
    pub(super) how: How<T>,
    /// What transforms and flips do, if they do anything.
    pub(super) turn: Option<Turn<T>>,
}

pub(super) enum How<T> {
    Keep,
    Reset,
    Mix { mix: fn(&[(&T, f64)]) -> T, weighted: bool, name: &'static str },
    Custom(Custom<T>),
}

impl<T> Clone for Rule<T> {
    fn clone(&self) -> Self {
        let how = match &self.how {
            How::Keep => How::Keep,
            How::Reset => How::Reset,
            &How::Mix { mix, weighted, name } => How::Mix { mix, weighted, name },
            How::Custom(f) => How::Custom(Arc::clone(f)),
        };
        Self { how, turn: self.turn.clone() }
    }
}

impl<T> fmt::Debug for Rule<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = match &self.how {
            How::Keep => "keep()",
            How::Reset => "reset()",
            How::Mix { name, .. } => name,
            How::Custom(_) => "custom(..)",
        };
        let turns = self.turn.is_some() && !matches!(name, "normals()" | "tangents()");
        write!(f, "Rule::{name}{}", if turns { ".turning(..)" } else { "" })
    }
}

impl<T> Rule<T> {
    fn of(how: How<T>) -> Self {
        Self { how, turn: None }
    }

    /// Whether it looks at moves.
    pub(super) fn sees_moves(&self) -> bool {
        matches!(self.how, How::Custom(_))
    }

    /// The value of the heaviest source; of the first among equals. For names, materials and marks.
    pub fn keep() -> Self {
        Self::of(How::Keep)
    }

    /// Split and merged elements go back to the default. For caches.
    pub fn reset() -> Self {
        Self::of(How::Reset)
    }

    /// Whatever `f` makes of the event and its sources. It is called with one source or more, must not panic, and should
    /// depend on its arguments alone if results are to be the same every time.
    pub fn custom(f: impl Fn(Event, &[(&T, f64)]) -> T + Send + Sync + 'static) -> Self {
        Self::of(How::Custom(Arc::new(f)))
    }

    /// The same rule for values that have to do with directions: [transforms](crate::Mesh::transform) and
    /// [flips](crate::Mesh::reverse) put each through `turn`. For frames, tensors, normals under another rule than that of
    /// [`normals`](Self::normals). What was set by an earlier call is replaced. `turn` must not panic.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, Rule, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// // The normals that faces had when they were scanned: halves of a face keep its own.
    /// let scanned = mesh.add_face_column(DVec3::Z, Rule::keep().turning(|n, by| by.normal(*n)));
    /// mesh.rotate_degrees(DVec3::X, 90.0, DVec3::ZERO)?;
    /// let f = mesh.faces().next().unwrap();
    /// assert_eq!(*mesh.value(scanned, f), DVec3::NEG_Y);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn turning(self, turn: impl Fn(&T, &Turning) -> T + Send + Sync + 'static) -> Self {
        Self { turn: Some(Arc::new(turn)), ..self }
    }
}

impl<T: Direction> Rule<T> {
    /// For normals, as the mesh carries some itself: the mean direction of the sources, of unit length. Maps of the mesh
    /// turn them by the inverse transpose and keep their lengths; a flip negates them, and a map that mirrors leaves them
    /// on the side of the surface where they were.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, Rule, glam::{DVec3, dvec3}};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// let bent = mesh.add_vertex_column(dvec3(1.0, 0.0, 1.0), Rule::normals());
    /// mesh.scale_axes(dvec3(1.0, 1.0, 2.0), DVec3::ZERO)?;
    /// let v = mesh.vertices().next().unwrap();
    /// // At right angles to (1, 0, -1), which is (1, 0, -2) now.
    /// assert!(mesh.value(bent, v).dot(dvec3(1.0, 0.0, -2.0)).abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn normals() -> Self {
        Self::of(How::Mix { mix: mixed_normal, weighted: true, name: "normals()" })
            .turning(|value, by| turned(value, by, |v| by.normal(v)))
    }

    /// For tangents, velocities, offsets: the weighted sum of the sources, under the handedness of the heaviest. Maps of
    /// the mesh put them through their linear part, lengths included, so that the vector from one vertex to another still is
    /// that afterwards; bring them to unit length again if they are to have it. Where the winding reverses, by a flip or a
    /// map that mirrors, a handedness changes its sign: the bitangent turns like the tangent.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, Rule, glam::{DVec3, dvec3, dvec4}};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// let tangent = mesh.add_corner_column(dvec4(1.0, 0.0, 0.0, 1.0), Rule::tangents());
    /// mesh.scale_axes(dvec3(-3.0, 1.0, 1.0), DVec3::ZERO)?;
    /// let h = mesh.face_halfedge(mesh.faces().next().unwrap());
    /// assert_eq!(*mesh.value(tangent, h), dvec4(-3.0, 0.0, 0.0, -1.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn tangents() -> Self {
        Self::of(How::Mix { mix: mixed_tangent, weighted: true, name: "tangents()" })
            .turning(|value, by| turned(value, by, |v| by.tangent(v)))
    }
}

fn turned<T: Direction>(value: &T, by: &Turning, turn: impl Fn(DVec3) -> DVec3) -> T {
    value.vector().map_or_else(|| value.clone(), |v| value.with_vector(turn(v), by.flips()))
}

impl<T: Interpolate> Rule<T> {
    /// The weighted sum of the sources: a linear function of position stays one. For texture coordinates, temperatures.
    pub fn interpolate() -> Self {
        Self::of(How::Mix { mix: T::mix, weighted: true, name: "interpolate()" })
    }

    /// The mean of the sources, whatever their weights.
    pub fn average() -> Self {
        Self::of(How::Mix { mix: T::mix, weighted: false, name: "average()" })
    }
}

/// Values of which a weighted sum makes sense.
pub trait Interpolate: Sized {
    /// The sum of the values times their weights, which sum to one.
    fn mix(sources: &[(&Self, f64)]) -> Self;
}

macro_rules! interpolate {
    ($($t:ty, $zero:expr, |$v:ident, $w:ident| $scaled:expr;)*) => {
        $(impl Interpolate for $t {
            fn mix(sources: &[(&Self, f64)]) -> Self {
                sources.iter().fold($zero, |sum, &(&$v, $w)| sum + $scaled)
            }
        })*
    };
}

interpolate! {
    f64, 0.0, |v, w| v * w;
    f32, 0.0, |v, w| v * w as f32;
    DVec2, DVec2::ZERO, |v, w| v * w;
    DVec3, DVec3::ZERO, |v, w| v * w;
    DVec4, DVec4::ZERO, |v, w| v * w;
    Vec2, Vec2::ZERO, |v, w| v * w as f32;
    Vec3, Vec3::ZERO, |v, w| v * w as f32;
    Vec4, Vec4::ZERO, |v, w| v * w as f32;
}

impl<T: Interpolate + Copy, const N: usize> Interpolate for [T; N] {
    fn mix(sources: &[(&Self, f64)]) -> Self {
        let mut part: smallvec::SmallVec<[(&T, f64); 8]> = smallvec::SmallVec::new();
        std::array::from_fn(|i| {
            part.clear();
            part.extend(sources.iter().map(|(v, w)| (&v[i], *w)));
            T::mix(&part)
        })
    }
}

impl<T: Interpolate> Interpolate for Option<T> {
    /// `None` unless every source that counts has a value.
    fn mix(sources: &[(&Self, f64)]) -> Self {
        let mut part: smallvec::SmallVec<[(&T, f64); 8]> = smallvec::SmallVec::new();
        for (v, w) in sources.iter().filter(|s| s.1 != 0.0) {
            part.push((v.as_ref()?, *w));
        }
        Some(T::mix(&part))
    }
}
