//! What becomes of values when elements are split, merged and moved.

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
pub struct Rule<T>(pub(super) How<T>);

pub(super) enum How<T> {
    Keep,
    Reset,
    Mix { mix: fn(&[(&T, f64)]) -> T, weighted: bool },
    Custom(Custom<T>),
}

impl<T> Clone for Rule<T> {
    fn clone(&self) -> Self {
        Self(match &self.0 {
            How::Keep => How::Keep,
            How::Reset => How::Reset,
            How::Mix { mix, weighted } => How::Mix { mix: *mix, weighted: *weighted },
            How::Custom(f) => How::Custom(Arc::clone(f)),
        })
    }
}

impl<T> fmt::Debug for Rule<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match &self.0 {
            How::Keep => "Rule::keep()",
            How::Reset => "Rule::reset()",
            How::Mix { weighted: true, .. } => "Rule::interpolate()",
            How::Mix { weighted: false, .. } => "Rule::average()",
            How::Custom(_) => "Rule::custom(..)",
        })
    }
}

impl<T> Rule<T> {
    /// Whether it looks at moves.
    pub(super) fn sees_moves(&self) -> bool {
        matches!(self.0, How::Custom(_))
    }

    /// The value of the heaviest source; of the first among equals. For names, materials and marks.
    pub fn keep() -> Self {
        Self(How::Keep)
    }

    /// Split and merged elements go back to the default. For caches.
    pub fn reset() -> Self {
        Self(How::Reset)
    }

    /// Whatever `f` makes of the event and its sources. It is called with one source or more, must not panic, and should
    /// depend on its arguments alone if results are to be the same every time.
    pub fn custom(f: impl Fn(Event, &[(&T, f64)]) -> T + Send + Sync + 'static) -> Self {
        Self(How::Custom(Arc::new(f)))
    }
}

impl<T: Interpolate> Rule<T> {
    /// The weighted sum of the sources: a linear function of position stays one. For texture coordinates, temperatures.
    pub fn interpolate() -> Self {
        Self(How::Mix { mix: T::mix, weighted: true })
    }

    /// The mean of the sources, whatever their weights.
    pub fn average() -> Self {
        Self(How::Mix { mix: T::mix, weighted: false })
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
