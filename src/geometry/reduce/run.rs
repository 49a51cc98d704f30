//! The loop: the cheapest edge is collapsed, until the target is met or nothing is left to collapse.

use super::attempt::{Guards, Scratch};
use super::copy::Copy;
use super::queue::{PARKED, Queue};
use super::{Refusal, Refusals};
use crate::{Cancelled, Control};

/// A reduction under way.
pub(super) struct Run {
    queue: Queue,
    scratch: Scratch,
    guards: Guards,
    pub(super) account: Account,
    /// The half-edges that were collapsed and where the vertex went, if it is kept; no place: where it was.
    pub(super) log: Option<Vec<Step>>,
}

/// A collapse to be done again on the mesh.
pub(super) struct Step {
    /// The slot of the half-edge.
    pub(super) halfedge: u32,
    /// In local units; `None` if the target was never moved.
    pub(super) place: Option<glam::DVec3>,
}

/// What happened so far.
#[derive(Clone, Copy, Default)]
pub(super) struct Account {
    pub(super) collapses: usize,
    pub(super) refusals: Refusals,
    /// In local units.
    pub(super) max_error: f64,
    /// Whether what is left was refused for its error, too.
    pub(super) is_bounded: bool,
}

impl Run {
    pub(super) fn new(guards: Guards, keep_log: bool) -> Self {
        let log = keep_log.then(Vec::new);
        Self { queue: Queue::new(), scratch: Scratch::default(), guards, account: Account::default(), log }
    }

    /// Collapses until `faces` are gone. Whether that was met.
    pub(super) fn reduce(
        &mut self,
        copy: &mut Copy,
        faces: usize,
        control: &mut Control<'_>,
    ) -> Result<bool, Cancelled> {
        loop {
            // What was refused may have become legal through changes further away: only a sweep in which nothing
            // could be done is the end.
            self.queue.rewind();
            self.account.is_bounded = false;
            self.fill(copy);
            let before = self.account.collapses;
            if self.drain(copy, faces, control)? {
                return Ok(true);
            }
            if self.account.collapses == before {
                return Ok(false);
            }
        }
    }

    fn fill(&mut self, copy: &mut Copy) {
        for e in 0..copy.edges.len() as u32 {
            if !copy.edges[e as usize].is_dead {
                self.put(copy, e);
            }
        }
    }

    /// Puts an edge where its cost belongs.
    #[inline]
    fn put(&mut self, copy: &mut Copy, e: u32) {
        let bucket = match copy.candidate(e) {
            Ok(candidate) => self.queue.bucket(candidate.cost),
            Err(refusal) => self.refuse(refusal),
        };
        let edge = &mut copy.edges[e as usize];
        if edge.bucket != bucket {
            edge.bucket = bucket;
            if bucket != PARKED {
                self.queue.push(bucket, e);
            }
        }
    }

    /// Counts a refusal; the edge belongs nowhere.
    fn refuse(&mut self, refusal: Refusal) -> u32 {
        self.account.refusals.count(refusal);
        self.account.is_bounded |= refusal == Refusal::ErrorBound;
        PARKED
    }

    fn drain(&mut self, copy: &mut Copy, faces: usize, control: &mut Control<'_>) -> Result<bool, Cancelled> {
        let total = faces.min(copy.edges.len()).max(1);
        let mut taken = 0u32;
        while copy.removed < faces {
            if self.queue.is_at_batch(32) {
                touch(copy, self.queue.ahead(32));
            }
            let Some((e, bucket)) = self.queue.pop() else { return Ok(false) };
            taken += 1;
            if taken.is_multiple_of(1 << 15) {
                let share = (copy.removed as f64 / total as f64).min(1.0);
                control.report("collapse", 0.1 + 0.75 * share)?;
            }
            if copy.edges[e as usize].bucket != bucket {
                continue;
            }
            let candidate = match copy.candidate(e) {
                // It has become dearer since: the neighbours' faces have moved.
                Ok(candidate) if self.queue.bucket(candidate.cost) > bucket => {
                    self.put(copy, e);
                    continue;
                }
                other => other,
            };
            copy.edges[e as usize].bucket = PARKED;
            match candidate.and_then(|c| copy.attempt(e, c, self.guards, &mut self.scratch)) {
                Err(refusal) => _ = self.refuse(refusal),
                Ok(done) => {
                    self.account.collapses += 1;
                    self.account.max_error = self.account.max_error.max(done.error);
                    if let Some(log) = &mut self.log {
                        let target = copy.vertex(copy.origin(done.halfedge ^ 1));
                        let slot = 2 * copy.edge_slot[done.halfedge as usize >> 1] + (done.halfedge & 1);
                        log.push(Step { halfedge: slot, place: target.is_moved.then_some(target.position) });
                    }
                    // While all of this is at hand.
                    for i in 1..self.scratch.goes.spokes.len() {
                        self.put_again(copy, self.scratch.goes.spokes[i] >> 1);
                    }
                    for i in 1..self.scratch.stays.spokes.len() {
                        self.put_again(copy, self.scratch.stays.spokes[i] >> 1);
                    }
                }
            }
        }
        Ok(true)
    }

    #[inline]
    fn put_again(&mut self, copy: &mut Copy, e: u32) {
        if !copy.edges[e as usize].is_dead {
            self.put(copy, e);
        }
    }
}

impl Refusals {
    fn count(&mut self, refusal: Refusal) {
        *match refusal {
            Refusal::Topology => &mut self.topology,
            Refusal::Feature => &mut self.feature,
            Refusal::Locked => &mut self.locked,
            Refusal::Valence => &mut self.valence,
            Refusal::Flip => &mut self.flip,
            Refusal::Shape => &mut self.shape,
            Refusal::ErrorBound => &mut self.error_bound,
        } += 1;
    }
}

/// Brings what the next collapses will look at into the cache: loads that do not wait for one another.
fn touch(copy: &Copy, edges: &[u32]) {
    let mut sum = 0u64;
    for &e in edges {
        for first in [2 * e, 2 * e + 1] {
            let mut h = first;
            for _ in 0..12 {
                sum = sum.wrapping_add(copy.vertex(copy.origin(h ^ 1)).position.x.to_bits());
                h = copy.next(h ^ 1);
                if h == first {
                    break;
                }
            }
        }
    }
    std::hint::black_box(sum);
}
