//! Tables of slots, for walks that reach a part of the mesh and must not cost the whole.

use std::collections::{HashMap, HashSet};
use std::hash::{BuildHasherDefault, Hasher};

/// What has been reached, by slot: for looking up, not for listing.
pub(super) type SlotSet = HashSet<u32, BuildHasherDefault<SlotHasher>>;
/// What is known of what has been reached, by slot.
pub(super) type BySlot<T> = HashMap<u32, T, BuildHasherDefault<SlotHasher>>;

/// A slot times an odd constant (Knuth, "The Art of Computer Programming" 3, 6.4): slots are no one's choice, so they
/// need no guard against chosen collisions, which is most of what the default costs.
#[derive(Default)]
pub(super) struct SlotHasher(u64);

impl Hasher for SlotHasher {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&b| self.write_u32(u32::from(b)));
    }

    fn write_u32(&mut self, slot: u32) {
        // Turned, because the table takes its places from the low bits.
        self.0 = (self.0 ^ u64::from(slot)).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(26);
    }
}
