//! The queue of edges: buckets of costs that differ by less than two percent.

/// Edges by cost. A cost counts by the upper bits of its `f32`, which order as the number does; within a bucket edges go
/// by number, so that they lie together in memory.
pub(super) struct Queue {
    buckets: Vec<Vec<u32>>,
    /// The first bucket that may hold something.
    at: usize,
    /// The bucket that is being emptied, and how far.
    list: Vec<u32>,
    done: usize,
}

const SHIFT: u32 = 17;
/// So many buckets for costs within a factor of two.
pub(super) const DOUBLING: usize = 1 << (23 - SHIFT);
/// No bucket: the edge waits for something around it to change.
pub(super) const PARKED: u16 = u16::MAX;

impl Queue {
    pub(super) fn new() -> Self {
        // Costs are no less than zero.
        let buckets = vec![Vec::new(); (f32::INFINITY.to_bits() >> SHIFT) as usize + 1];
        Self { buckets, at: 0, list: Vec::new(), done: 0 }
    }

    /// The bucket for a cost; none that has been emptied already.
    #[inline]
    pub(super) fn bucket(&self, cost: f64) -> u16 {
        (((cost as f32).max(0.0).to_bits() >> SHIFT) as usize).clamp(self.at, self.buckets.len() - 1) as u16
    }

    #[inline]
    pub(super) fn push(&mut self, bucket: u16, edge: u32) {
        self.buckets[bucket as usize].push(edge);
    }

    /// Goes on to the next bucket before `end` that has entries, if the one before is empty; false if there is none.
    /// Entries that `is_due` says not to belong there any more are dropped.
    #[inline]
    pub(super) fn go_on(&mut self, end: usize, is_due: impl Fn(u32, u16) -> bool) -> bool {
        while self.done == self.list.len() {
            let end = end.min(self.buckets.len());
            while self.at < end && self.buckets[self.at].is_empty() {
                self.at += 1;
            }
            if self.at >= end {
                // What is put from here on must find a bucket.
                self.at = self.at.min(self.buckets.len() - 1);
                return false;
            }
            self.list.clear();
            self.done = 0;
            let bucket = self.at as u16;
            let entries = std::mem::take(&mut self.buckets[self.at]);
            self.list.extend(entries.into_iter().filter(|&e| is_due(e, bucket)));
            self.list.sort_unstable();
        }
        true
    }

    /// The next entry, and its bucket: out of date if the edge has another by now.
    #[inline]
    pub(super) fn pop(&mut self) -> Option<(u32, u16)> {
        let next = self.list.get(self.done).map(|&e| (e, self.at as u16));
        self.done += usize::from(next.is_some());
        next
    }

    /// What comes next, as far as it is in order already.
    #[inline]
    pub(super) fn ahead(&self, count: usize) -> &[u32] {
        &self.list[self.done..(self.done + count).min(self.list.len())]
    }

    /// The first bucket that holds anything.
    pub(super) fn first(&mut self) -> Option<usize> {
        if self.done < self.list.len() {
            return Some(self.at);
        }
        (self.at..self.buckets.len()).find(|&i| !self.buckets[i].is_empty())
    }

    /// How many entries there are in the buckets before `end`.
    pub(super) fn count(&self, end: usize) -> usize {
        let begun = if self.at < end { self.list.len() - self.done } else { 0 };
        let buckets = self.buckets.get(self.at..end.min(self.buckets.len())).unwrap_or_default();
        begun + buckets.iter().map(Vec::len).sum::<usize>()
    }

    /// The bucket that is being emptied.
    pub(super) fn at(&self) -> u16 {
        self.at as u16
    }

    pub(super) fn is_at_batch(&self, of: usize) -> bool {
        self.done.is_multiple_of(of)
    }

    /// Begins anew with the cheapest; everything must have been taken out.
    pub(super) fn rewind(&mut self) {
        self.at = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_come_out_by_cost_and_a_cost_of_any_size_has_a_bucket() {
        let mut queue = Queue::new();
        let costs = [f64::MAX, 1e-300, 2.0, 0.0, 1.0, f64::INFINITY, 1e-9];
        for (edge, &cost) in (0..).zip(&costs) {
            queue.push(queue.bucket(cost), edge);
        }
        assert_eq!((queue.first(), queue.count(usize::MAX)), (Some(0), 7));
        let mut order = Vec::new();
        while queue.go_on(usize::MAX, |e, _| e != 6) {
            order.extend(queue.pop().map(|p| p.0));
        }
        assert_eq!(order, [1, 3, 4, 2, 0, 5]);
        assert_eq!(queue.bucket(0.0), queue.bucket(f64::INFINITY), "no way back");
        queue.rewind();
        assert_eq!(queue.bucket(0.0), 0);
    }
}
