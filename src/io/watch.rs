//! What readers and writers tell the hook.

use crate::{Cancelled, Control};
use std::io::{Error, Write};

/// Elements, or lines, between two reports.
const EVERY: u32 = 1 << 18;

/// The hook of a reader.
pub(super) struct Watch<'w, 'a> {
    control: &'w mut Control<'a>,
    /// The bytes to read.
    bytes: usize,
    /// The share of the whole call at which reading begins.
    from: f64,
    ticks: u32,
}

impl<'w, 'a> Watch<'w, 'a> {
    pub(super) fn new(control: &'w mut Control<'a>, bytes: usize, from: f64) -> Self {
        Self { control, bytes, from, ticks: 0 }
    }

    /// Notes an element, and reports about every quarter million of them how many bytes are left.
    #[inline]
    pub(super) fn tick(&mut self, left: usize) -> Result<(), Cancelled> {
        self.ticks = self.ticks.wrapping_add(1);
        if self.ticks.is_multiple_of(EVERY) { self.report(left) } else { Ok(()) }
    }

    /// Notes so many elements at once, fewer than lie between two reports.
    pub(super) fn ticks(&mut self, count: usize, left: usize) -> Result<(), Cancelled> {
        let before = self.ticks / EVERY;
        self.ticks = self.ticks.wrapping_add(count as u32);
        if self.ticks / EVERY == before { Ok(()) } else { self.report(left) }
    }

    /// Reports how many bytes are left.
    pub(super) fn report(&mut self, left: usize) -> Result<(), Cancelled> {
        let share = self.bytes.saturating_sub(left) as f64 / self.bytes.max(1) as f64;
        self.control.report("read", self.from + (1.0 - self.from) * share)
    }

    /// Reports that all is read.
    pub(super) fn end(&mut self) -> Result<(), Cancelled> {
        self.control.report("read", 1.0)
    }
}

/// A sink with a hook.
pub(super) struct Watched<'w, 'a, S> {
    pub(super) sink: &'w mut S,
    pub(super) control: &'w mut Control<'a>,
    pub(super) written: u64,
    /// How many bytes there will be, about.
    pub(super) expected: u64,
    /// At how many bytes the next report is due.
    pub(super) next: u64,
    pub(super) is_cancelled: bool,
}

impl<S: Write> Write for Watched<'_, '_, S> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        if self.written >= self.next {
            self.next = self.written + (1 << 20);
            let share = self.written as f64 / self.expected.max(1) as f64;
            if self.control.report("write", share.min(0.99)).is_err() {
                self.is_cancelled = true;
                return Err(Error::other(Cancelled));
            }
        }
        let count = self.sink.write(bytes)?;
        self.written += count as u64;
        Ok(count)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.sink.flush()
    }
}
