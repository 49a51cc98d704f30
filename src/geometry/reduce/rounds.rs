//! A large mesh in parts: each lies together in memory, and each thread has parts of its own.
//!
//! The parts depend on the mesh alone, and so does the result. A vertex with a neighbour in another part waits until the
//! parts have come together. All parts go on to the next doubling of the cost together, and each sweeps over what costs less
//! in the order in which that lies in memory: nearly all that is looked up is at hand then, and what an edge costs has to be
//! known only when its turn comes. The order of collapses is that of their costs but for what lies within a factor of two,
//! for the first few, and for what became cheaper meanwhile; near the goal the steps are smaller, and the last few percent go
//! strictly by cost.

use super::attempt::Guards;
use super::copy::Copy;
use super::part::Part;
use super::quadric::Planes;
use super::queue::{DOUBLING, PARKED, count_before, least};
use super::run::{Account, Run, Step};
use crate::{Cancelled, Control};

/// The buckets within a factor of two.
const OCTAVE: u16 = DOUBLING as u16;
/// A part has this many vertices or up to twice as many.
const PART: usize = 1 << 16;

/// What came of it.
pub(super) struct Outcome {
    pub(super) is_met: bool,
    pub(super) account: Account,
    pub(super) log: Option<Vec<Step>>,
}

struct Job<'a> {
    part: Part<'a>,
    run: Run,
    /// The first bucket.
    first: u16,
    /// How many edges wait in this round.
    waiting: usize,
    /// How many faces may go in this round.
    share: usize,
}

impl Copy {
    /// Collapses until `faces` are gone or nothing is left to collapse.
    pub(super) fn reduce(
        &mut self,
        faces: usize,
        guards: Guards,
        keep_log: bool,
        control: &mut Control<'_>,
    ) -> Result<Outcome, Cancelled> {
        let mut run = Run::new(self.edges.len(), guards, keep_log);
        let cuts = self.cuts();
        let seam = if cuts.len() > 2 { self.seam(&cuts) } else { Vec::new() };
        let removed = if seam.is_empty() {
            run.fill(&mut self.whole());
            0
        } else {
            self.reduce_parts(&cuts, faces, seam.len(), guards, &mut run, control)?
        };
        let mut whole = self.whole();
        whole.removed = removed;
        if !seam.is_empty() {
            come_together(&mut whole, &mut run, &seam, guards.line_weight);
        }
        let is_met = run.reduce(&mut whole, faces, seam.is_empty(), control)?;
        Ok(Outcome { is_met, account: run.account, log: run.log })
    }

    /// Sums up the planes at every vertex; keeps them all along if the error has a bound.
    pub(super) fn sum_planes(&mut self, line_weight: f64, has_bound: bool) {
        self.fans = vec![Planes::default(); self.spots.len()];
        self.origins = vec![Planes::default(); self.spots.len()];
        let cuts = self.cuts();
        let mut jobs: Vec<_> = self.parts(&cuts).into_iter().map(|part| (part, Vec::new())).collect();
        each(&mut jobs, |(part, others)| *others = part.add_planes(line_weight));
        let others: Vec<u32> = jobs.into_iter().flat_map(|(_, others)| others).collect();
        let mut whole = self.whole();
        for h in others {
            let n = whole.next(h);
            let p = whole.next(n);
            // Told by more than one part.
            if h < n && h < p {
                whole.add_face([h, n, p], line_weight);
            }
        }
        if has_bound {
            self.memory = self.origins.iter().map(|&planes| planes.into()).collect();
        }
    }

    /// Where the parts begin and end, by vertex.
    fn cuts(&self) -> Vec<usize> {
        let (n, parts) = (self.spots.len(), (self.spots.len() / PART).max(1));
        (0..=parts).map(|k| (n as u64 * k as u64 / parts as u64) as usize).collect()
    }

    /// Marks the vertices that wait; none if too many had to.
    fn seam(&mut self, cuts: &[usize]) -> Vec<u32> {
        let mut waits: Vec<bool> = self.spots.iter().map(|spot| spot.is_heavy()).collect();
        let part = |v: u32| cuts.partition_point(|&cut| cut <= v as usize);
        let mut end = 0;
        for edge in &self.edges {
            let [a, b] = edge.ends();
            // Edges go by their lower vertex.
            if a.min(b) as usize >= end {
                end = cuts[part(a.min(b))];
            }
            if a.max(b) as usize >= end {
                (waits[a as usize], waits[b as usize]) = (true, true);
            }
        }
        // On the boundary links beyond the neighbour change.
        let beside = self.edges.iter().filter(|edge| edge.is_open()).map(|edge| edge.ends());
        let more: Vec<u32> =
            beside.filter(|ends| ends.iter().any(|&v| waits[v as usize])).flatten().collect();
        more.into_iter().for_each(|v| waits[v as usize] = true);
        let seam: Vec<u32> = (0..).zip(&waits).filter(|w| *w.1).map(|w| w.0).collect();
        if seam.len() > self.spots.len() / 8 {
            return Vec::new();
        }
        seam.iter().for_each(|&v| self.spots[v as usize].set_seam(true));
        seam
    }

    /// Reduces the parts, but for the last few faces. How many are gone.
    fn reduce_parts(
        &mut self,
        cuts: &[usize],
        faces: usize,
        seam: usize,
        guards: Guards,
        run: &mut Run,
        control: &mut Control<'_>,
    ) -> Result<usize, Cancelled> {
        let all = self.face_count;
        // What the seam has to give, and a rest that goes strictly by cost.
        let goal = (faces as f64 * (0.99 - 2.0 * seam as f64 / all.max(1) as f64)).max(0.0) as usize;
        let mut jobs: Vec<Job<'_>> = Vec::new();
        for part in self.parts(cuts) {
            let run = Run::new(0, guards, run.log.is_some());
            jobs.push(Job { part, run, first: PARKED, waiting: 0, share: 0 });
        }
        each(&mut jobs, |job| job.run.estimate(&mut job.part));
        let (mut removed, mut reached) = (0, 0);
        loop {
            each(&mut jobs, |job| job.first = least(job.part.keys));
            let start = jobs.iter().map(|job| job.first).min().unwrap_or(PARKED);
            let left = goal.saturating_sub(removed);
            if left < 64 || start == PARKED {
                break;
            }
            let count = |jobs: &mut Vec<Job<'_>>, end| {
                each(jobs, |job| job.waiting = count_before(job.part.keys, end));
                jobs.iter().map(|job| job.waiting).sum::<usize>()
            };
            // What a sweep left behind goes with the next one, and so do the first few, whatever they cost.
            let from = start.max(reached);
            let mut end = ((from / OCTAVE + 1) * OCTAVE).min(PARKED);
            let mut waiting = count(&mut jobs, end);
            while waiting < left / 32 && end < PARKED - OCTAVE {
                end += OCTAVE;
                waiting = count(&mut jobs, end);
            }
            if waiting > 2 * left {
                // Near the goal in smaller steps.
                end = end.min(from + OCTAVE / 4);
                waiting = count(&mut jobs, end);
            }
            reached = end;
            for job in &mut jobs {
                job.share = (left as u64 * job.waiting as u64).div_ceil(waiting as u64) as usize;
            }
            each(&mut jobs, |job| job.run.sweep(&mut job.part, job.share, end));
            removed = jobs.iter().map(|job| job.part.removed).sum();
            let share = removed as f64 / faces.min(all).max(1) as f64;
            control.report("collapse", 0.1 + 0.75 * share.min(1.0))?;
        }
        jobs.into_iter().for_each(|job| run.add(job.run));
        Ok(removed)
    }

    fn parts(&mut self, cuts: &[usize]) -> Vec<Part<'_>> {
        let mut rest = self.whole();
        let mut parts = Vec::new();
        for cut in cuts.windows(2) {
            let vertices = cut[1] - cut[0];
            let lower = |e: &super::part::Edge| e.ends()[0].min(e.ends()[1]) as usize;
            let edges = rest.edges.partition_point(|e| lower(e) < cut[1]);
            let (part, others) = rest.split(vertices, edges);
            parts.push(part);
            rest = others;
        }
        parts
    }
}

/// Lets the seam take part again.
fn come_together(whole: &mut Part<'_>, run: &mut Run, seam: &[u32], line_weight: f64) {
    seam.iter().for_each(|&v| whole.spot_mut(v).set_seam(false));
    let mut is_seam = vec![false; whole.spots.len()];
    seam.iter().for_each(|&v| is_seam[v as usize] = true);
    for e in 0..whole.edges.len() as u32 {
        let edge = *whole.edge(e);
        if edge.is_dead() {
            continue;
        }
        for (h, v) in (2 * e..).zip(edge.ends()) {
            if std::mem::take(&mut is_seam[v as usize]) {
                whole.sum_again(h, line_weight);
            }
        }
    }
    whole.keys.fill(PARKED);
    run.fill(whole);
}

/// Does all jobs, on several threads where the feature `rayon` allows it.
#[cfg(feature = "rayon")]
fn each<J: Send>(jobs: &mut [J], work: impl Fn(&mut J) + Sync + Send) {
    use rayon::prelude::*;
    jobs.par_iter_mut().for_each(work);
}

/// Does all jobs.
#[cfg(not(feature = "rayon"))]
fn each<J>(jobs: &mut [J], work: impl Fn(&mut J)) {
    jobs.iter_mut().for_each(work);
}
