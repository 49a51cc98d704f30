//! Corners of faces: `7`, `7/2`, `7//3`, `-1/-1/-1`.

use super::super::error::{Malformed, NoteKind, Notes, Place, ReadError};
use super::super::text::{integer, is_blank, is_integer, shown};
use crate::{CornerData, PolygonSoup};

/// An index as the file spells it: from 1, or from the end of what was read so far if negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Index {
    Missing,
    Given(i64),
    /// No number, or one of more digits than any list has entries.
    Beyond,
}

impl Index {
    /// As an index from 0, if it can be one.
    pub(super) fn resolve(self, so_far: usize) -> Option<u32> {
        let Self::Given(i) = self else { return None };
        let from_zero = if i < 0 { i.checked_add(so_far as i64)? } else { i - 1 };
        u32::try_from(from_zero).ok()
    }

    fn of(word: Option<&[u8]>) -> Self {
        match word {
            None | Some([]) => Self::Missing,
            Some(word) => integer(word).map_or(Self::Beyond, Self::Given),
        }
    }
}

/// One corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Corner {
    pub(super) vertex: Index,
    pub(super) uv: Index,
    pub(super) normal: Index,
}

impl Corner {
    pub(super) const NONE: Self = Self { vertex: Index::Missing, uv: Index::Missing, normal: Index::Missing };

    /// The vertex, if so many were read before; the index that names none if it cannot be one.
    #[inline]
    pub(super) fn vertex_of(&self, so_far: usize) -> u32 {
        self.vertex.resolve(so_far).unwrap_or(PolygonSoup::NO_VERTEX)
    }
}

/// Reads the corner that begins at `at`, and moves `at` behind it.
///
/// # Errors
/// [`Malformed::Number`] if the vertex is no whole number.
pub(super) fn read(text: &[u8], at: &mut usize, line: u64) -> Result<Corner, ReadError> {
    let start = *at;
    if let Some(corner) = read_plain(text, at) {
        return Ok(corner);
    }
    let end = text[start..].iter().position(|&b| is_blank(b)).map_or(text.len(), |i| start + i);
    *at = end;
    let word = &text[start..end];
    let mut parts = word.split(|&b| b == b'/');
    let vertex = parts.next().unwrap_or_default();
    if !is_integer(vertex) {
        return Err(ReadError::line(line, Malformed::Number(shown(word))));
    }
    Ok(Corner {
        vertex: Index::of(Some(vertex)),
        uv: Index::of(parts.next()),
        normal: Index::of(parts.next()),
    })
}

/// Nearly all corners, in one look at each byte; `None` for whatever is odd.
#[inline]
pub(super) fn read_plain(text: &[u8], at: &mut usize) -> Option<Corner> {
    let vertex = digits(text, at)?;
    let mut corner = Corner { vertex, ..Corner::NONE };
    if text.get(*at) == Some(&b'/') {
        *at += 1;
        corner.uv = digits(text, at).unwrap_or(Index::Missing);
        if text.get(*at) == Some(&b'/') {
            *at += 1;
            corner.normal = digits(text, at).unwrap_or(Index::Missing);
        }
    }
    text.get(*at).is_none_or(|&b| is_blank(b)).then_some(corner)
}

#[inline]
fn digits(text: &[u8], at: &mut usize) -> Option<Index> {
    // As many as always fit.
    const MOST: usize = 18;
    let is_negative = text.get(*at) == Some(&b'-');
    let start = *at + usize::from(is_negative);
    let mut end = start;
    let mut value: i64 = 0;
    while let Some(digit) = text.get(end).map(|b| b.wrapping_sub(b'0')).filter(|d| *d < 10) {
        if end - start == MOST {
            return None;
        }
        value = 10 * value + i64::from(digit);
        end += 1;
    }
    if end == start {
        return None;
    }
    *at = end;
    Some(Index::Given(if is_negative { -value } else { value }))
}

/// Values that corners refer to.
#[derive(Debug, Default)]
pub(super) struct Attribute<T> {
    pub(super) values: Vec<T>,
    /// One per corner from the first corner that has a value on; empty until then.
    indices: Vec<u32>,
    is_used: bool,
}

impl<T> Attribute<T> {
    /// Whether a corner referred to a value so far.
    #[inline]
    pub(super) fn is_used(&self) -> bool {
        self.is_used
    }

    /// Notes the value of the next corner, and answers whether it may exist, if there should be one.
    pub(super) fn refer(&mut self, index: Index, corners_before: usize) -> bool {
        if index == Index::Missing {
            if self.is_used {
                self.indices.push(CornerData::<T>::NONE);
            }
            return true;
        }
        if !self.is_used {
            self.is_used = true;
            self.indices.resize(corners_before, CornerData::<T>::NONE);
        }
        // Values may come after the faces that use them; whether they do is seen at the end.
        let index = index.resolve(self.values.len()).unwrap_or(CornerData::<T>::NONE);
        self.indices.push(index);
        index != CornerData::<T>::NONE
    }

    /// Takes out the indices of values that never came; `line_of` finds the line of a corner.
    pub(super) fn finish(
        mut self,
        notes: &mut Notes,
        line_of: impl Fn(usize) -> u64,
    ) -> Option<CornerData<T>> {
        let (count, none) = (self.values.len(), CornerData::<T>::NONE);
        let mut place = None;
        let mut any = false;
        for (corner, i) in self.indices.iter_mut().enumerate().filter(|(_, i)| **i != none) {
            if (*i as usize) < count {
                any = true;
                continue;
            }
            *i = none;
            let place = *place.get_or_insert_with(|| Place::Line(line_of(corner)));
            notes.add(NoteKind::AttributeOutOfRange, place);
        }
        any.then_some(CornerData { values: self.values, indices: self.indices })
    }
}
