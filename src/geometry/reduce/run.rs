//! The loop: the cheapest edge is collapsed, until the target is met or nothing is left to collapse.

use super::attempt::{Guards, Scratch};
use super::part::Part;
use super::queue::{PARKED, Queue};
use super::{Refusal, Refusals};
use crate::{Cancelled, Control};

/// So many edges are looked up ahead.
const BATCH: usize = 32;

/// A reduction under way.
pub(super) struct Run {
    pub(super) queue: Queue,
    scratch: Scratch,
    guards: Guards,
    pub(super) account: Account,
    /// The half-edges that were collapsed and where the vertex went, if it is kept; no place: where it was.
    pub(super) log: Option<Vec<Step>>,
}

/// A collapse to be done again on the mesh, by numbers in the copy.
#[derive(Clone, Copy)]
pub(super) struct Step {
    pub(super) halfedge: u32,
    /// The vertex that is left, and where it was then, in local units; `None` if it was never moved.
    pub(super) vertex: u32,
    pub(super) place: Option<glam::DVec3>,
}

/// What happened so far.
#[derive(Clone, Copy, Default)]
pub(super) struct Account {
    pub(super) collapses: usize,
    pub(super) refusals: Refusals,
    /// Whether what is left was refused for its error, too.
    pub(super) is_bounded: bool,
}

impl Run {
    pub(super) fn new(guards: Guards, keep_log: bool) -> Self {
        let log = keep_log.then(Vec::new);
        Self { queue: Queue::new(), scratch: Scratch::default(), guards, account: Account::default(), log }
    }

    /// Of the same kind, with nothing done.
    pub(super) fn another(&self) -> Self {
        Self::new(self.guards, self.log.is_some())
    }

    /// Counts what another has done elsewhere before.
    pub(super) fn add(&mut self, other: Self) {
        self.account.collapses += other.account.collapses;
        self.account.refusals += other.account.refusals;
        if let (Some(log), Some(more)) = (&mut self.log, other.log) {
            log.extend(more);
        }
    }

    /// Collapses until `faces` are gone. Whether that was met. The queue `is_full` if every edge was put into it.
    pub(super) fn reduce(
        &mut self,
        part: &mut Part<'_>,
        faces: usize,
        is_full: bool,
        control: &mut Control<'_>,
    ) -> Result<bool, Cancelled> {
        let mut before = is_full.then_some(self.account.collapses);
        loop {
            if self.drain(part, faces, usize::MAX, control)? {
                return Ok(true);
            }
            // What was refused may have become legal through changes further away: only a sweep in which nothing
            // could be done is the end.
            if before == Some(self.account.collapses) {
                return Ok(false);
            }
            before = Some(self.account.collapses);
            self.queue.rewind();
            self.account.is_bounded = false;
            self.fill(part);
        }
    }

    /// Puts every edge into the queue.
    pub(super) fn fill(&mut self, part: &mut Part<'_>) {
        for i in 0..part.edges.len() as u32 {
            if !part.edges[i as usize].is_dead() {
                self.put(part, part.first_edge + i);
            }
        }
    }

    /// Puts an edge where its cost belongs.
    #[inline]
    pub(super) fn put(&mut self, part: &mut Part<'_>, e: u32) {
        let bucket = match part.candidate(e) {
            Ok(candidate) => self.queue.bucket(candidate.cost),
            Err(refusal) => self.refuse(refusal),
        };
        self.move_to(part, e, bucket);
    }

    #[inline]
    fn move_to(&mut self, part: &mut Part<'_>, e: u32, bucket: u16) {
        let key = part.key_mut(e);
        if *key != bucket {
            *key = bucket;
            if bucket != PARKED {
                self.queue.push(bucket, e);
            }
        }
    }

    /// Counts a refusal; the edge belongs nowhere.
    fn refuse(&mut self, refusal: Refusal) -> u16 {
        self.account.refusals.count(refusal);
        self.account.is_bounded |= refusal == Refusal::ErrorBound;
        PARKED
    }

    /// Collapses until `faces` are gone or the buckets before `end` are empty. Whether they are gone.
    pub(super) fn drain(
        &mut self,
        part: &mut Part<'_>,
        faces: usize,
        end: usize,
        control: &mut Control<'_>,
    ) -> Result<bool, Cancelled> {
        let total = faces.min(part.edges.len()).max(1);
        let mut taken = 0u32;
        while part.removed < faces {
            if !self.queue.go_on(end, |e, bucket| part.key(e) == bucket) {
                return Ok(false);
            }
            if self.queue.is_at_batch(BATCH) {
                touch(part, self.queue.ahead(BATCH), self.queue.at());
            }
            let Some((e, bucket)) = self.queue.pop() else { return Ok(false) };
            taken += 1;
            if taken.is_multiple_of(1 << 15) {
                let share = (part.removed as f64 / total as f64).min(1.0);
                control.report("collapse", 0.1 + 0.75 * share)?;
            }
            if part.key(e) != bucket {
                continue;
            }
            let candidate = match part.candidate(e) {
                // It has become dearer since: the neighbours' faces have moved.
                Ok(candidate) if self.queue.bucket(candidate.cost) > bucket => {
                    self.move_to(part, e, self.queue.bucket(candidate.cost));
                    continue;
                }
                other => other,
            };
            *part.key_mut(e) = PARKED;
            match candidate.and_then(|c| part.attempt(e, c, self.guards, &mut self.scratch)) {
                Err(refusal) => _ = self.refuse(refusal),
                Ok(halfedge) => self.follow(part, halfedge),
            }
        }
        Ok(true)
    }

    /// After a collapse, while all of this is at hand.
    #[inline]
    fn follow(&mut self, part: &mut Part<'_>, halfedge: u32) {
        self.account.collapses += 1;
        if let Some(log) = &mut self.log {
            let vertex = part.origin(halfedge ^ 1);
            let target = part.spot(vertex);
            log.push(Step { halfedge, vertex, place: target.is_moved().then_some(target.position) });
        }
        for i in 1..self.scratch.goes.spokes.len() {
            self.put_again(part, self.scratch.goes.spokes[i] >> 1);
        }
        for i in 1..self.scratch.stays.spokes.len() {
            self.put_again(part, self.scratch.stays.spokes[i] >> 1);
        }
    }

    #[inline]
    fn put_again(&mut self, part: &mut Part<'_>, e: u32) {
        if !part.edge(e).is_dead() {
            self.put(part, e);
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
            Refusal::Later => return,
        } += 1;
    }
}

impl std::ops::AddAssign for Refusals {
    fn add_assign(&mut self, other: Self) {
        self.topology += other.topology;
        self.feature += other.feature;
        self.locked += other.locked;
        self.valence += other.valence;
        self.flip += other.flip;
        self.shape += other.shape;
        self.error_bound += other.error_bound;
    }
}

/// Brings what the next collapses will look at into the cache: walks around all their ends at once, so that no load waits
/// for more than the one before on the same walk.
fn touch(part: &Part<'_>, edges: &[u32], bucket: u16) {
    let mut walks = [(0, 0); 2 * BATCH];
    let mut count = 0;
    for &e in edges.iter().take(BATCH).filter(|&&e| part.key(e) == bucket) {
        for h in [2 * e, 2 * e + 1] {
            walks[count] = (h, h);
            count += 1;
        }
    }
    let mut sum = 0u64;
    for _ in 0..12 {
        let mut left = 0;
        for i in 0..count {
            let (first, h) = walks[i];
            let (v, after) = part.around(h);
            sum = sum.wrapping_add(part.spot(v).position.x.to_bits());
            sum = sum.wrapping_add(part.fan(v).weight().to_bits());
            walks[left] = (first, after);
            left += usize::from(after != first);
        }
        count = left;
    }
    std::hint::black_box(sum);
}
