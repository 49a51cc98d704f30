//! Coordinates on their way through tobj.

use glam::DVec3;
use std::io::Write;
use std::path::Path;

/// Vertices that tobj reads at once: its tables for them stay in near memory.
const BATCH: usize = 4096;

/// tobj takes a polygon of fewer corners for a point or a line; so there are at least so many vertices in its text.
const FEWEST: usize = 3;

/// tobj did not read what it was given: some coordinate is no number.
#[derive(Debug)]
pub(super) struct Unread;

/// The positions read so far, and those that wait.
#[derive(Default)]
pub(super) struct Coordinates {
    positions: Vec<DVec3>,
    /// Statements that tobj has not seen yet.
    text: Vec<u8>,
    waiting: usize,
    /// The polygon through all vertices of a batch: tobj returns only vertices that a face names.
    polygon: Vec<u8>,
}

impl Coordinates {
    /// How many there are, those that wait included.
    pub(super) fn len(&self) -> usize {
        self.positions.len() + self.waiting
    }

    /// Takes the text of three coordinates, blanks before each.
    pub(super) fn push(&mut self, text: &[u8]) -> Result<(), Unread> {
        self.text.push(b'v');
        self.text.extend_from_slice(text);
        self.text.push(b'\n');
        self.waiting += 1;
        if self.waiting == BATCH { self.flush() } else { Ok(()) }
    }

    /// All positions.
    pub(super) fn finish(mut self) -> Result<Vec<DVec3>, Unread> {
        self.flush()?;
        Ok(self.positions)
    }

    /// Has tobj read what waits.
    fn flush(&mut self) -> Result<(), Unread> {
        if self.waiting == 0 {
            return Ok(());
        }
        let count = self.waiting.max(FEWEST);
        (self.waiting..count).for_each(|_| self.text.extend_from_slice(b"v 0 0 0\n"));
        if count == BATCH {
            if self.polygon.is_empty() {
                self.polygon = polygon(BATCH);
            }
            self.text.extend_from_slice(&self.polygon);
        } else {
            self.text.extend_from_slice(&polygon(count));
        }
        let options = tobj::LoadOptions {
            single_index: false,
            triangulate: false,
            ignore_points: false,
            ignore_lines: false,
        };
        let no_materials = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
        let (models, _) =
            tobj::load_obj_buf(&mut &self.text[..], &options, no_materials).map_err(|_| Unread)?;
        let mesh = &models.first().ok_or(Unread)?.mesh;
        let (points, _) = mesh.positions.as_chunks();
        // tobj numbers vertices by first use: the polygon's order.
        let is_whole = points.len() == count && mesh.indices.len() == count;
        if !is_whole || mesh.indices.iter().zip(0..).any(|(i, n)| *i != n) {
            return Err(Unread);
        }
        self.positions.extend(points[..self.waiting].iter().map(|p| DVec3::from_array(*p)));
        self.text.clear();
        self.waiting = 0;
        Ok(())
    }
}

/// `f 1 2 3 ...`
fn polygon(count: usize) -> Vec<u8> {
    let mut text = vec![b'f'];
    for i in 1..=count {
        // Writing to a vector does not fail.
        let _ = write!(text, " {i}");
    }
    text.push(b'\n');
    text
}
