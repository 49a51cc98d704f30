//! Lines, words and numbers of text files.

use super::error::{Malformed, ReadError};

/// Lines with their numbers, ended by `\n`, `\r\n` or a lone `\r`.
#[derive(Clone)]
pub(super) struct Lines<'a> {
    rest: Option<&'a [u8]>,
    number: u64,
}

impl<'a> Lines<'a> {
    pub(super) fn new(text: &'a [u8]) -> Self {
        Self { rest: Some(text), number: 0 }
    }

    /// What is left; it begins with a line.
    #[inline]
    pub(super) fn rest(&self) -> Option<&'a [u8]> {
        self.rest
    }

    /// Takes so many bytes, which are a line and its end; its number.
    #[inline]
    pub(super) fn take_line(&mut self, bytes: usize) -> u64 {
        self.rest = self.rest.map(|rest| &rest[bytes..]);
        self.number += 1;
        self.number
    }

    /// How many bytes are left.
    pub(super) fn left(&self) -> usize {
        self.rest.map_or(0, <[u8]>::len)
    }
}

/// Bytes that end a line, begin a comment or continue a line.
const SPECIAL: [bool; 256] = {
    let mut special = [false; 256];
    special[b'\n' as usize] = true;
    special[b'\r' as usize] = true;
    special[b'#' as usize] = true;
    special[b'\\' as usize] = true;
    special
};

impl<'a> Lines<'a> {
    /// The next line, if it ends in `\n` or `\r\n` and has neither `#` nor backslash: one look at each byte for nearly all lines.
    pub(super) fn next_plain(&mut self) -> Option<(u64, &'a [u8])> {
        let rest = self.rest?;
        let end = rest.iter().position(|&b| SPECIAL[b as usize])?;
        let after = match rest.get(end..end + 2) {
            Some(b"\r\n") => end + 2,
            _ if rest[end] == b'\n' => end + 1,
            _ => return None,
        };
        self.number += 1;
        self.rest = Some(&rest[after..]);
        Some((self.number, &rest[..end]))
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (u64, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        let rest = self.rest?;
        self.number += 1;
        let Some(end) = rest.iter().position(|&b| b == b'\n' || b == b'\r') else {
            self.rest = None;
            return (!rest.is_empty()).then_some((self.number, rest));
        };
        let skip = if rest[end..].starts_with(b"\r\n") { 2 } else { 1 };
        self.rest = Some(&rest[end + skip..]);
        Some((self.number, &rest[..end]))
    }
}

/// Whether a byte stands between words; files from life have zeros there, too.
pub(super) fn is_blank(byte: u8) -> bool {
    byte.is_ascii_whitespace() || byte == 0
}

/// The words of a line.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> + Clone {
    line.split(|b| is_blank(*b)).filter(|w| !w.is_empty())
}

/// The line up to a `#`, unless that stands in a number such as `1.#IND`.
pub(super) fn before_comment(line: &[u8]) -> &[u8] {
    let mut from = 0;
    while let Some(at) = line[from..].iter().position(|&b| b == b'#').map(|i| from + i) {
        if !line[..at].ends_with(b"1.") {
            return &line[..at];
        }
        from = at + 1;
    }
    line
}

/// A number in any spelling that occurs, those of C libraries for NaN and infinity included.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(word).ok()?;
    text.parse().ok().or_else(|| {
        // Microsoft's: 1.#INF, -1.#IND, 1.#QNAN; with digits after them.
        let (sign, digits) = text.strip_prefix('-').map_or((1.0, text), |t| (-1.0, t));
        let special = digits.strip_prefix("1.#")?;
        if special.starts_with("INF") { Some(sign * f64::INFINITY) } else { Some(f64::NAN) }
    })
}

pub(super) fn number_at(line: u64, word: &[u8]) -> Result<f64, ReadError> {
    number(word).ok_or_else(|| ReadError::line(line, Malformed::Number(shown(word))))
}

/// A word for a message, shortened.
pub(super) fn shown(word: &[u8]) -> String {
    String::from_utf8_lossy(&word[..word.len().min(40)]).into_owned()
}

/// A whole number, or `None` if it is none or beyond `i64`.
pub(super) fn integer(word: &[u8]) -> Option<i64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// Whether a word is spelled as a whole number, of any size.
pub(super) fn is_integer(word: &[u8]) -> bool {
    let digits = word.strip_prefix(b"-").or(word.strip_prefix(b"+")).unwrap_or(word);
    !digits.is_empty() && digits.iter().all(u8::is_ascii_digit)
}

/// The text without a byte-order mark.
///
/// # Errors
/// UTF-16 is refused.
pub(super) fn without_mark(text: &[u8]) -> Result<&[u8], ReadError> {
    if text.starts_with(&[0xFE, 0xFF]) || text.starts_with(&[0xFF, 0xFE]) {
        return Err(ReadError::line(1, Malformed::Utf16));
    }
    Ok(text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(text))
}

/// A coordinate that reads back as it was, in few characters for any size.
pub(super) struct Number(pub(super) f64);

impl std::fmt::Display for Number {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let size = self.0.abs();
        if size == 0.0 || (1e-5..1e17).contains(&size) {
            write!(f, "{}", self.0)
        } else {
            write!(f, "{:e}", self.0)
        }
    }
}
