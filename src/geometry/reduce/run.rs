//! The loop: the cheapest edge is collapsed, until the target is met or nothing is left to collapse.

use super::attempt::{Guards, Scratch};
use super::part::Part;
use super::queue::{DOUBLING, PARKED, Queue, bucket, least};
use super::{Refusal, Refusals};
use crate::{Cancelled, Control};

/// The edges of a cell, whose records and those of their vertices fit into the cache next to a core.
const CELL: u32 = 1 << 14;
/// Up to so many cells strictly go by cost.
const FEW: usize = 12;
/// So many edges are looked up at once.
const BATCH: usize = 32;
/// How often one in so many faces is removed, progress is told.
const REPORTS: usize = 64;

/// A reduction under way.
pub(super) struct Run {
    /// By cell.
    queues: Vec<Queue>,
    scratch: Scratch,
    batch: Vec<u32>,
    guards: Guards,
    pub(super) account: Account,
    /// The half-edges that were collapsed and where the vertex went, if it is kept; no place: where it was.
    pub(super) log: Option<Vec<Step>>,
}

/// A collapse to be done again on the mesh, by numbers in the copy.
#[derive(Clone, Copy)]
pub(super) struct Step {
    pub(super) halfedge: u32,
    /// Where the vertex that is left was then, in local units; `None` if it was never moved.
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
    /// For a part of so many edges.
    pub(super) fn new(edges: usize, guards: Guards, keep_log: bool) -> Self {
        let cells = (edges as u64).div_ceil(CELL.into()).max(1);
        Self {
            queues: (0..cells).map(|_| Queue::new()).collect(),
            scratch: Scratch::default(),
            batch: Vec::new(),
            guards,
            account: Account::default(),
            log: keep_log.then(Vec::new),
        }
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
            if self.empty(part, faces, control)? {
                return Ok(true);
            }
            // What was refused may have become legal through changes further away: only a sweep in which nothing
            // could be done is the end.
            if before == Some(self.account.collapses) {
                return Ok(false);
            }
            before = Some(self.account.collapses);
            self.queues.iter_mut().for_each(Queue::rewind);
            self.account.is_bounded = false;
            self.fill(part);
        }
    }

    /// Collapses until `faces` are gone or the queue is empty. Whether they are gone.
    fn empty(
        &mut self,
        part: &mut Part<'_>,
        faces: usize,
        control: &mut Control<'_>,
    ) -> Result<bool, Cancelled> {
        let total = faces.min(part.edges.len()).max(1);
        let mut told = part.removed;
        while part.removed < faces {
            let Some(start) = self.first(part) else { return Ok(false) };
            let (left, all) = (faces - part.removed, (start / DOUBLING + 1) * DOUBLING);
            let is_far = self.queues.len() > FEW && self.count(all) < left / 4;
            self.drain(part, left, if is_far { all } else { start + 1 });
            if part.removed - told > total / REPORTS {
                told = part.removed;
                control.report("collapse", 0.1 + 0.75 * (told as f64 / total as f64).min(1.0))?;
            }
        }
        Ok(true)
    }

    /// The first bucket that has entries.
    pub(super) fn first(&mut self, part: &Part<'_>) -> Option<usize> {
        self.queues.iter_mut().filter_map(|queue| queue.first(|e| part.key(e))).min()
    }

    /// How many entries there are before `end`, which must be within the factor of two of the first.
    pub(super) fn count(&self, end: usize) -> usize {
        self.queues.iter().map(|queue| queue.count(end)).sum()
    }

    #[inline]
    fn queue(&mut self, part: &Part<'_>, e: u32) -> &mut Queue {
        &mut self.queues[((e - part.first_edge) / CELL) as usize]
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
        match part.candidate(e) {
            Ok(candidate) => self.move_to(part, e, candidate.cost),
            Err(refusal) => *part.key_mut(e) = self.refuse(refusal),
        }
    }

    #[inline]
    fn move_to(&mut self, part: &mut Part<'_>, e: u32, cost: f64) {
        let queue = self.queue(part, e);
        let bucket = queue.bucket(cost);
        let key = part.key_mut(e);
        if *key != bucket {
            *key = bucket;
            queue.push(bucket, e);
        }
    }

    /// Counts a refusal; the edge belongs nowhere.
    fn refuse(&mut self, refusal: Refusal) -> u16 {
        self.account.refusals.count(refusal);
        self.account.is_bounded |= refusal == Refusal::ErrorBound;
        PARKED
    }

    /// Empties the buckets before `end`, cell by cell, until about `faces` more are gone: where that is less than there is,
    /// each cell gives its share.
    pub(super) fn drain(&mut self, part: &mut Part<'_>, faces: usize, end: usize) {
        let goal = part.removed + faces;
        let waiting = self.count(end).max(1);
        for cell in 0..self.queues.len() {
            let count = self.queues[cell].count(end);
            let share = (faces as u64 * count as u64).div_ceil(waiting as u64) as usize;
            let goal = goal.min(part.removed + share);
            while part.removed < goal
                && self.queues[cell].first(|e| part.key(e)).is_some_and(|first| first < end)
            {
                if let Some(entries) = self.queues[cell].begun() {
                    touch(part, entries);
                }
                if let Some((e, bucket)) = self.queues[cell].pop() {
                    self.take(part, e, bucket);
                }
            }
        }
    }

    #[inline]
    fn take(&mut self, part: &mut Part<'_>, e: u32, bucket: u16) {
        if part.key(e) != bucket {
            return;
        }
        let candidate = match part.candidate(e) {
            // It has become dearer since: the neighbours' faces have moved.
            Ok(candidate) if self.queue(part, e).bucket(candidate.cost) > bucket => {
                return self.move_to(part, e, candidate.cost);
            }
            other => other,
        };
        *part.key_mut(e) = PARKED;
        match candidate.and_then(|c| part.attempt(e, c, self.guards, &mut self.scratch)) {
            Err(refusal) => _ = self.refuse(refusal),
            Ok(halfedge) => self.follow(part, halfedge),
        }
    }

    /// Tells each edge of a part what it costs.
    pub(super) fn estimate(&mut self, part: &mut Part<'_>) {
        for i in 0..part.edges.len() {
            part.keys[i] = match part.candidate(part.first_edge + i as u32) {
                Ok(candidate) => bucket(candidate.cost),
                Err(refusal) => self.refuse(refusal),
            };
        }
    }

    /// Collapses what costs less than `end` in the order in which it lies in memory, until `faces` more are gone. What an
    /// edge costs is found out when its turn comes: around a collapse nothing is put anywhere.
    pub(super) fn sweep(&mut self, part: &mut Part<'_>, faces: usize, end: u16) {
        let goal = part.removed + faces;
        let mut batch = std::mem::take(&mut self.batch);
        let mut at = 0;
        while at < part.keys.len() {
            batch.clear();
            while at < part.keys.len() && batch.len() < BATCH {
                let keys = &part.keys[at..part.keys.len().min(at + BATCH)];
                if least(keys) < end {
                    let found = (0..).zip(keys).filter(|found| *found.1 < end);
                    batch.extend(found.map(|(i, _): (u32, _)| part.first_edge + at as u32 + i));
                }
                at += keys.len();
            }
            touch(part, &batch);
            for &e in &batch {
                if part.removed >= goal {
                    break;
                }
                if part.key(e) < end {
                    self.take_or_tell(part, e, end);
                }
            }
            if part.removed >= goal {
                break;
            }
        }
        self.batch = batch;
    }

    #[inline]
    fn take_or_tell(&mut self, part: &mut Part<'_>, e: u32, end: u16) {
        let now = part.key(e);
        let candidate = part.candidate(e);
        if let Ok(candidate) = &candidate {
            let bucket = bucket(candidate.cost);
            if bucket >= end {
                *part.key_mut(e) = bucket;
                return;
            }
        }
        *part.key_mut(e) = PARKED;
        match candidate.and_then(|c| part.attempt(e, c, self.guards, &mut self.scratch)) {
            Err(refusal) => _ = self.refuse(refusal),
            Ok(halfedge) => {
                self.note(part, halfedge);
                // What was refused may do now.
                for ring in [&self.scratch.goes, &self.scratch.stays] {
                    for e in ring.others().iter().map(|spoke| spoke.halfedge >> 1) {
                        if part.key(e) == PARKED && !part.edge(e).is_dead() {
                            *part.key_mut(e) = now;
                        }
                    }
                }
            }
        }
    }

    /// Counts a collapse, and keeps it if that is wanted.
    #[inline]
    fn note(&mut self, part: &Part<'_>, halfedge: u32) {
        self.account.collapses += 1;
        if let Some(log) = &mut self.log {
            let target = part.spot(part.origin(halfedge ^ 1));
            log.push(Step { halfedge, place: target.is_moved().then_some(target.position) });
        }
    }

    /// After a collapse, while all of this is at hand.
    #[inline]
    fn follow(&mut self, part: &mut Part<'_>, halfedge: u32) {
        self.note(part, halfedge);
        for i in 1..self.scratch.goes.spokes().len() {
            self.put_again(part, self.scratch.goes.spokes()[i].halfedge >> 1);
        }
        for i in 1..self.scratch.stays.spokes().len() {
            self.put_again(part, self.scratch.stays.spokes()[i].halfedge >> 1);
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

/// Brings what the next collapses will look at first into the cache, by loads that do not wait for one another.
fn touch(part: &Part<'_>, edges: &[u32]) {
    let mut sum = 0u64;
    for batch in edges.chunks(32) {
        let mut ends = [0; 64];
        for (ends, &e) in ends.chunks_exact_mut(2).zip(batch) {
            ends.copy_from_slice(&part.edge(e).ends());
        }
        for &v in &ends[..2 * batch.len()] {
            sum = sum.wrapping_add(part.spot(v).position.x.to_bits());
            sum = sum.wrapping_add(part.fan(v).weight().to_bits());
        }
    }
    std::hint::black_box(sum);
}
