//! The queue of edges: buckets of costs that differ by less than two percent.

/// How many of these edges are in buckets before `end`.
#[inline]
pub(super) fn count_before(keys: &[u16], end: u16) -> usize {
    let below = |keys: &[u16]| keys.iter().map(|&key| i16::from((key as i16) < end as i16)).sum::<i16>();
    keys.chunks(1 << 12).map(|keys| below(keys) as usize).sum()
}

/// Edges by cost. A cost counts by the upper bits of its `f32`, which order as the number does; within a bucket edges go
/// by number, so that they lie together in memory. Only costs within the factor of two that is being emptied have a bucket
/// each, so that what is put in finds all buckets in the cache.
pub(super) struct Queue {
    /// By factor of two.
    coarse: Vec<Vec<u32>>,
    /// By bucket, of the factor of two of the first one.
    fine: Vec<Vec<u32>>,
    /// The first bucket that may hold something.
    at: usize,
    /// The bucket that is being emptied, and how far.
    list: Vec<u32>,
    done: usize,
}

const SHIFT: u32 = 16;
/// So many buckets for costs within a factor of two.
pub(super) const DOUBLING: usize = 1 << (23 - SHIFT);
/// Costs are no less than zero.
const BUCKETS: usize = (f32::INFINITY.to_bits() >> SHIFT) as usize + 1;
/// No bucket: the edge waits for something around it to change.
pub(super) const PARKED: u16 = i16::MAX as u16;

/// The bucket for a cost.
#[inline]
pub(super) fn bucket(cost: f64) -> u16 {
    (((cost as f32).max(0.0).to_bits() >> SHIFT) as usize).min(BUCKETS - 1) as u16
}

/// The first bucket that any of these edges is in, or [`PARKED`].
#[inline]
pub(super) fn least(keys: &[u16]) -> u16 {
    // Signed, because that is what common processors compare many of at once.
    keys.iter().fold(PARKED as i16, |least, &key| least.min(key as i16)) as u16
}

impl Queue {
    pub(super) fn new() -> Self {
        let lists = |n| vec![Vec::new(); n];
        Self {
            coarse: lists(BUCKETS / DOUBLING + 1),
            fine: lists(DOUBLING),
            at: 0,
            list: Vec::new(),
            done: 0,
        }
    }

    /// The bucket for a cost; none that has been emptied already.
    #[inline]
    pub(super) fn bucket(&self, cost: f64) -> u16 {
        bucket(cost).max(self.at as u16)
    }

    #[inline]
    pub(super) fn push(&mut self, bucket: u16, edge: u32) {
        let bucket = bucket as usize;
        if bucket / DOUBLING == self.at / DOUBLING {
            self.fine[bucket % DOUBLING].push(edge);
        } else {
            self.coarse[bucket / DOUBLING].push(edge);
        }
    }

    /// Goes on to the first bucket that has entries. `key` tells where an edge is by now: what is not where it was put is
    /// dropped.
    pub(super) fn first(&mut self, key: impl Fn(u32) -> u16) -> Option<usize> {
        while self.done == self.list.len() {
            let octave = self.at / DOUBLING;
            if let Some(i) = (self.at % DOUBLING..DOUBLING).find(|&i| !self.fine[i].is_empty()) {
                self.at = octave * DOUBLING + i;
                (self.list, self.fine[i]) =
                    (std::mem::take(&mut self.fine[i]), std::mem::take(&mut self.list));
                self.fine[i].clear();
                self.list.retain(|&e| key(e) as usize == self.at);
                self.list.sort_unstable();
                self.done = 0;
            } else {
                let next = (octave + 1..self.coarse.len()).find(|&i| !self.coarse[i].is_empty())?;
                self.at = next * DOUBLING;
                for e in std::mem::take(&mut self.coarse[next]) {
                    let bucket = key(e) as usize;
                    if bucket / DOUBLING == next {
                        self.fine[bucket % DOUBLING].push(e);
                    }
                }
            }
        }
        Some(self.at)
    }

    /// How many entries there are before `end`, which must be within the factor of two of the first.
    pub(super) fn count(&self, end: usize) -> usize {
        if self.at >= end {
            return 0;
        }
        let last = if end / DOUBLING > self.at / DOUBLING { DOUBLING } else { end % DOUBLING };
        self.list.len() - self.done + self.fine[self.at % DOUBLING..last].iter().map(Vec::len).sum::<usize>()
    }

    /// All entries of the first bucket, when it has just begun.
    #[inline]
    pub(super) fn begun(&self) -> Option<&[u32]> {
        (self.done == 0).then_some(&self.list)
    }

    /// The next entry of the first bucket, and the bucket: out of date if the edge has another by now.
    #[inline]
    pub(super) fn pop(&mut self) -> Option<(u32, u16)> {
        let next = self.list.get(self.done).map(|&e| (e, self.at as u16));
        self.done += usize::from(next.is_some());
        next
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
    fn the_first_bucket_and_the_number_before_another_are_those_of_a_plain_count() {
        let keys: Vec<u16> = (0..10_000u32)
            .map(|i| if i % 5 == 0 { PARKED } else { bucket(f64::from(i * 7919 % 613)) })
            .collect();
        for end in [0, bucket(1.0), bucket(100.0), bucket(f64::INFINITY), PARKED] {
            assert_eq!(count_before(&keys, end), keys.iter().filter(|&&key| key < end).count());
        }
        assert_eq!(
            least(&keys),
            bucket(f64::from(
                (0..10_000).filter(|i| i % 5 > 0).map(|i: u32| i * 7919 % 613).min().unwrap_or(0)
            ))
        );
        assert_eq!((least(&[]), least(&[PARKED])), (PARKED, PARKED));
    }

    #[test]
    fn edges_come_out_by_cost_and_a_cost_of_any_size_has_a_bucket() {
        let mut queue = Queue::new();
        let costs = [f64::MAX, 1e-300, 2.0, 0.0, 1.0, f64::INFINITY, 1e-9];
        let keys: Vec<u16> = costs.iter().map(|&cost| queue.bucket(cost)).collect();
        for (edge, &key) in (0..).zip(&keys) {
            queue.push(key, edge);
        }
        let key = |e: u32| if e == 6 { PARKED } else { keys[e as usize] };
        assert_eq!((queue.first(key), queue.count(DOUBLING)), (Some(0), 2));
        let mut order = Vec::new();
        while queue.first(key).is_some() {
            order.extend(queue.pop().map(|p| p.0));
        }
        assert_eq!(order, [1, 3, 4, 2, 0, 5]);
        assert_eq!(queue.bucket(0.0), queue.bucket(f64::INFINITY), "no way back");
        queue.rewind();
        assert_eq!(queue.bucket(0.0), 0);
    }
}
