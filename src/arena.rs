//! The one place that touches slotmap: an arena hands out keys, checks them, and knows their order.
//!
//! Links between elements are dense `u32` columns indexed by slot; they live in [`Mesh`](crate::Mesh). The slot map
//! holds no values. Beside it stands a column of versions, because slotmap cannot turn a slot number into a key. A mesh
//! that was built and not edited since needs neither: its elements have the first slots, all in their first version, and the
//! slot map is filled when the first element is added or removed.

use slotmap::{Key, KeyData, SlotMap};

/// Keys of one kind of element.
#[derive(Clone, Debug)]
pub(crate) struct Arena<K: Key> {
    /// While `versions` is empty: slots `1..=fresh` are live, in version 1. Then 0.
    fresh: u32,
    slots: SlotMap<K, ()>,
    /// The version of each slot as slotmap has it while occupied (odd), 0 while free. Slot 0 is slotmap's sentinel.
    versions: Vec<u32>,
    /// Where each slot stands in the user's order, below the number of slots, or `u32::MAX` if it was added since; empty
    /// while that is the order of slots.
    ranks: Vec<u32>,
}

impl<K: Key> Arena<K> {
    /// An arena of `count` elements in slots `1..=count`. O(1).
    pub(crate) fn filled(count: usize) -> Self {
        Self { fresh: count as u32, slots: SlotMap::with_key(), versions: Vec::new(), ranks: Vec::new() }
    }

    /// Fills the slot map, before the first change. O(elements), once.
    #[inline]
    fn settle(&mut self) {
        if self.versions.is_empty() {
            self.fill();
        }
    }

    #[cold]
    fn fill(&mut self) {
        let count = std::mem::take(&mut self.fresh) as usize;
        self.slots = SlotMap::with_capacity_and_key(count);
        let mut last = K::null();
        for _ in 0..count {
            last = self.slots.insert(());
        }
        // slotmap fills fresh slots in order, and gives each the version 1.
        debug_assert!(count == 0 || last.data().as_ffi() == 1 << 32 | count as u64);
        self.versions = vec![1; count + 1];
        self.versions[0] = 0;
    }

    /// A new element: its slot, which is the next fresh one or one that was freed.
    pub(crate) fn insert(&mut self) -> u32 {
        self.settle();
        let ffi = self.slots.insert(()).data().as_ffi();
        let (slot, version) = (ffi as u32, (ffi >> 32) as u32);
        if slot as usize == self.versions.len() {
            self.versions.push(version);
            if !self.ranks.is_empty() {
                // After all that the user gave.
                self.ranks.push(u32::MAX);
            }
        } else {
            self.versions[slot as usize] = version;
            if let Some(rank) = self.ranks.get_mut(slot as usize) {
                *rank = u32::MAX;
            }
        }
        slot
    }

    /// Frees a live slot; its key is stale from now on.
    pub(crate) fn remove(&mut self, slot: u32) {
        self.settle();
        self.slots.remove(self.key(slot));
        self.versions[slot as usize] = 0;
    }

    /// Takes a live slot out of use without freeing it, so that its key can be [put back](Self::reattach); returns its
    /// version.
    pub(crate) fn detach(&mut self, slot: u32) -> u32 {
        self.settle();
        self.slots.detach(self.key(slot));
        std::mem::take(&mut self.versions[slot as usize])
    }

    /// Puts a detached slot back into use under its old key.
    pub(crate) fn reattach(&mut self, slot: u32, version: u32) {
        self.settle();
        self.versions[slot as usize] = version;
        self.slots.reattach(self.key(slot), ());
    }

    pub(crate) fn len(&self) -> usize {
        self.fresh as usize + self.slots.len()
    }

    /// One past the highest slot ever used: the length of the element's columns.
    pub(crate) fn slot_count(&self) -> usize {
        self.versions.len().max(self.fresh as usize + 1)
    }

    /// The slot of a live key.
    pub(crate) fn slot(&self, key: K) -> Option<u32> {
        let ffi = key.data().as_ffi();
        self.is_version(ffi as u32, (ffi >> 32) as u32).then_some(ffi as u32)
    }

    /// Whether `slot` holds the element of this version.
    #[inline]
    pub(crate) fn is_version(&self, slot: u32, version: u32) -> bool {
        match self.versions.get(slot as usize) {
            Some(&v) => v == version && v != 0,
            None => version == 1 && slot.wrapping_sub(1) < self.fresh,
        }
    }

    #[inline]
    pub(crate) fn is_live(&self, slot: u32) -> bool {
        match self.versions.get(slot as usize) {
            Some(&v) => v != 0,
            None => slot.wrapping_sub(1) < self.fresh,
        }
    }

    /// The key of a live slot.
    pub(crate) fn key(&self, slot: u32) -> K {
        KeyData::from_ffi(u64::from(self.version(slot)) << 32 | u64::from(slot)).into()
    }

    #[inline]
    pub(crate) fn version(&self, slot: u32) -> u32 {
        if self.versions.is_empty() { 1 } else { self.versions[slot as usize] }
    }

    /// Live slots, ascending.
    pub(crate) fn live(&self) -> impl DoubleEndedIterator<Item = u32> + Clone + '_ {
        let settled = self.versions.iter().enumerate().filter(|&(_, &v)| v != 0).map(|(i, _)| i as u32);
        (1..self.fresh + 1).chain(settled)
    }

    /// Whether the user's order is that of slots.
    pub(crate) fn is_in_user_order(&self) -> bool {
        self.ranks.is_empty()
    }

    /// What stands for a live slot in the user's order: below what stands for those behind it.
    #[inline]
    pub(crate) fn rank(&self, slot: u32) -> u32 {
        match self.ranks.get(slot as usize) {
            None => slot,
            Some(&u32::MAX) => 1 << 31 | slot,
            Some(&rank) => rank,
        }
    }

    /// Whether the slots are `1..=len`, in the user's order.
    pub(crate) fn is_compact(&self) -> bool {
        self.ranks.is_empty() && self.slot_count() == self.len() + 1
    }

    /// Live slots in the user's order. O(slots).
    pub(crate) fn in_user_order(&self) -> Vec<u32> {
        let mut slots: Vec<u32> = Vec::with_capacity(self.len());
        if self.ranks.is_empty() {
            slots.extend(self.live());
            return slots;
        }
        // Slot 0, the sentinel, stands for none.
        let mut at = vec![0; self.slot_count()];
        let mut added = Vec::new();
        for slot in self.live() {
            match at.get_mut(self.ranks[slot as usize] as usize) {
                Some(place) => *place = slot,
                None => added.push(slot),
            }
        }
        slots.extend(at.into_iter().filter(|&slot| slot != 0).chain(added));
        slots
    }

    /// Gives each slot, the sentinel included, its place in the user's order; no two of them the same.
    pub(crate) fn set_ranks(&mut self, ranks: Vec<u32>) {
        self.ranks = ranks;
    }

    /// Whether versions, slot map and ranks agree.
    pub(crate) fn is_sound(&self) -> bool {
        let mut occupied = 0;
        let known = self.live().all(|s| {
            occupied += 1;
            self.slots.contains_key(self.key(s))
        });
        let is_fresh = self.versions.is_empty() && self.slots.is_empty();
        let is_settled =
            || known && self.fresh == 0 && occupied == self.slots.len() && self.versions.first() == Some(&0);
        (is_fresh || is_settled()) && (self.ranks.is_empty() || self.ranks.len() == self.slot_count())
    }

    /// Heap bytes held: once settled 8 per slot in slotmap and 4 in the version column; 4 more once ranks are kept.
    pub(crate) fn bytes(&self) -> usize {
        (self.slots.capacity() + 1) * 8 + (self.versions.capacity() + self.ranks.capacity()) * 4
    }
}

/// The doors through which tests break what no public call can.
#[cfg(test)]
impl<K: Key> Arena<K> {
    pub(crate) fn set_version(&mut self, slot: u32, version: u32) {
        self.settle();
        self.versions[slot as usize] = version;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::VertexKey;

    #[test]
    fn a_slot_number_and_its_version_make_the_key_slotmap_made() {
        let mut arena = Arena::<VertexKey>::filled(5);
        let ours = |arena: &Arena<VertexKey>| arena.live().map(|s| arena.key(s)).collect::<Vec<_>>();
        let fresh = ours(&arena);
        arena.settle();
        let theirs: Vec<_> = arena.slots.keys().collect();
        assert_eq!((&fresh, &ours(&arena)), (&theirs, &theirs));
    }

    #[test]
    fn keys_made_before_the_first_change_live_after_it() {
        let mut arena = Arena::<VertexKey>::filled(3);
        let keys: Vec<_> = arena.live().map(|s| arena.key(s)).collect();
        assert_eq!((arena.bytes() <= 8, arena.len(), arena.slot_count()), (true, 3, 4));
        arena.remove(2);
        assert_eq!(keys.iter().map(|&k| arena.slot(k)).collect::<Vec<_>>(), [Some(1), None, Some(3)]);
        assert_eq!((arena.len(), arena.slot_count(), arena.is_sound()), (2, 4, true));
    }

    #[test]
    fn a_stale_key_is_refused_after_its_slot_is_reused() {
        let mut arena = Arena::<VertexKey>::filled(2);
        let stale = arena.key(1);
        arena.remove(1);
        assert_eq!(arena.slot(stale), None);
        assert_eq!(arena.insert(), 1, "slotmap reuses the freed slot");
        assert_eq!(arena.slot(stale), None);
        assert!(arena.is_sound());
    }

    #[test]
    fn a_detached_slot_is_not_reused_and_comes_back_under_its_key() {
        let mut arena = Arena::<VertexKey>::filled(2);
        let key = arena.key(1);
        let version = arena.detach(1);
        assert_eq!((arena.slot(key), arena.len()), (None, 1));
        assert_eq!(arena.insert(), 3);
        arena.reattach(1, version);
        assert_eq!(arena.slot(key), Some(1));
        assert!(arena.is_sound());
    }

    #[test]
    fn ranks_carry_the_users_order_over_any_order_of_slots() {
        let mut arena = Arena::<VertexKey>::filled(3);
        arena.set_ranks(vec![0, 2, 0, 1]);
        assert_eq!(arena.in_user_order(), [2, 3, 1]);
    }

    #[test]
    fn null_and_forged_keys_are_refused() {
        let fresh = Arena::<VertexKey>::filled(1);
        let mut settled = fresh.clone();
        settled.settle();
        for arena in [fresh, settled] {
            assert_eq!(arena.slot(VertexKey::null()), None);
            assert_eq!(arena.slot(KeyData::from_ffi(u64::MAX).into()), None);
            assert_eq!(arena.slot(KeyData::from_ffi(1 << 32).into()), None, "the sentinel");
            assert_eq!(arena.slot(KeyData::from_ffi(1 << 32 | 2).into()), None, "past the end");
        }
    }
}
