//! Lines of an OBJ file as statements.

use super::super::text::{Lines, before_comment};
use std::borrow::Cow;

/// Statements with the number of their first line: comments taken out, lines joined that end in a backslash.
pub(super) struct Statements<'a> {
    lines: Lines<'a>,
}

impl<'a> Statements<'a> {
    pub(super) fn new(text: &'a [u8]) -> Self {
        Self { lines: Lines::new(text) }
    }

    /// How many bytes are left.
    pub(super) fn left(&self) -> usize {
        self.lines.left()
    }

    /// The text that is left, which begins with a line.
    #[inline]
    pub(super) fn rest(&self) -> Option<&'a [u8]> {
        self.lines.rest()
    }

    /// Takes so many bytes, which are a line and its end; its number.
    #[inline]
    pub(super) fn take_line(&mut self, bytes: usize) -> u64 {
        self.lines.take_line(bytes)
    }

    fn joined(&mut self, first: &[u8]) -> Vec<u8> {
        let mut joined = first.to_vec();
        for (_, line) in self.lines.by_ref() {
            let line = before_comment(line);
            let (part, more) = line.strip_suffix(b"\\").map_or((line, false), |l| (l, true));
            joined.push(b' ');
            joined.extend_from_slice(part);
            if !more {
                break;
            }
        }
        joined
    }
}

impl<'a> Iterator for Statements<'a> {
    type Item = (u64, Cow<'a, [u8]>);

    fn next(&mut self) -> Option<Self::Item> {
        if let Some((number, line)) = self.lines.next_plain() {
            return Some((number, Cow::Borrowed(line)));
        }
        let (number, line) = self.lines.next()?;
        let line = before_comment(line);
        Some(match line.strip_suffix(b"\\") {
            Some(first) => (number, Cow::Owned(self.joined(first))),
            None => (number, Cow::Borrowed(line)),
        })
    }
}
