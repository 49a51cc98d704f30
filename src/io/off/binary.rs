//! `OFF BINARY`.

use super::super::error::{Malformed, NoteKind, Notes, Place, ReadError};
use super::super::watch::Watch;
use super::super::{Limits, Loaded};
use crate::PolygonSoup;
use glam::DVec3;

/// `OFF BINARY`: counts and indices of 32 bits, coordinates in single precision; big-endian by the book, little-endian in
/// life; with or without a colour count behind each face.
pub(super) fn read(bytes: &[u8], limits: &Limits, watch: &mut Watch<'_, '_>) -> Result<Loaded, ReadError> {
    let start = bytes.iter().position(|&b| b == b'\n').map_or(bytes.len(), |i| i + 1);
    let data = &bytes[start..];
    let word = |i: usize| data.get(4 * i..4 * i + 4).and_then(|b| <[u8; 4]>::try_from(b).ok());
    let truncated = |i: usize, what| ReadError::byte(start + 4 * i, Malformed::Truncated(what));
    let counts = |read: fn([u8; 4]) -> u32| Some([read(word(0)?), read(word(1)?), read(word(2)?)]);
    let fits = |c: &[u32; 3]| 3 + 3 * u64::from(c[0]) + u64::from(c[1]) <= data.len() as u64 / 4;
    let big = counts(u32::from_be_bytes).ok_or(truncated(0, "the counts"))?;
    let (read, [vertices, faces, _]): (fn([u8; 4]) -> u32, _) = match counts(u32::from_le_bytes).filter(fits)
    {
        Some(little) if !fits(&big) || little[0] <= big[0] => (u32::from_le_bytes, little),
        _ => (u32::from_be_bytes, big),
    };
    if !fits(&[vertices, faces, 0]) {
        let room = data.len() as u64 / 12;
        let reason = Malformed::Promise { what: "vertices", wanted: u64::from(vertices), room };
        return Err(ReadError::byte(start, reason));
    }
    limits.check_vertices(u64::from(vertices))?;
    limits.check_faces(u64::from(faces))?;
    let get = |i: usize, what| word(i).map(read).ok_or(truncated(i, what));
    let mut notes = Notes::default();
    let mut soup = PolygonSoup::default();
    for v in 0..vertices as usize {
        watch.tick(data.len() - 12 * v)?;
        let mut p = DVec3::ZERO;
        for i in 0..3 {
            p[i] = f64::from(f32::from_bits(get(3 + 3 * v + i, "a vertex")?));
        }
        if !p.is_finite() {
            notes.add(NoteKind::NonFiniteCoordinate, Place::Byte((start + 4 * (3 + 3 * v)) as u64));
        }
        soup.positions.push(p);
    }
    let first = 3 + 3 * vertices as usize;
    // Walk the faces without colours; if that does not end at the end, with them.
    let end = |colors: bool| {
        (0..faces).try_fold(first, |at, _| {
            let at = at.checked_add(1)?.checked_add(get(at, "a face").ok()? as usize)?;
            if colors { at.checked_add(1)?.checked_add(get(at, "a face").ok()? as usize) } else { Some(at) }
        })
    };
    let colors = end(false) != Some(data.len() / 4) && end(true) == Some(data.len() / 4);
    let mut at = first;
    for _ in 0..faces {
        watch.tick(data.len().saturating_sub(4 * at))?;
        let place = Place::Byte((start + 4 * at) as u64);
        let degree = get(at, "a face")? as usize;
        let room = (data.len() / 4).saturating_sub(at + 1);
        if degree > room {
            return Err(truncated(at, "a face"));
        }
        limits.check_corners((soup.polygons.corners().len() + degree) as u64)?;
        let corners: Vec<u32> = (at + 1..=at + degree).filter_map(|i| word(i).map(read)).collect();
        if corners.iter().any(|&v| v >= vertices) {
            notes.add(NoteKind::IndexOutOfRange, place);
        }
        if degree < 3 {
            notes.add(NoteKind::ShortFace, place);
        }
        soup.polygons.push(corners);
        at += 1 + degree;
        if colors {
            at = at.saturating_add(1).saturating_add(get(at, "a face colour")? as usize);
            notes.add(NoteKind::FaceColor, place);
        }
    }
    if data.len() > 4 * at {
        notes.add(NoteKind::TrailingData, Place::Byte((start + 4 * at) as u64));
    }
    Ok(Loaded { soup, notes: notes.finish() })
}
