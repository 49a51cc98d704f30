//! Many rays cast through one tree, several at a time.
//!
//! A ray alone waits for memory most of the time: each node it comes to, and each triangle, is one of millions. So some
//! rays take a step in turn, and what all of them look at next is fetched before.

use super::bvh::{Frame, Tree, WIDTH};
use super::cast::Cast;
use smallvec::SmallVec;
use std::ops::Range;

/// How many at a time. More than fetches can be under way.
const LANES: usize = 16;

/// A ray on its way, with what is known of it so far.
struct Lane<'t, S> {
    number: usize,
    cast: Cast<'t>,
    state: S,
    limit: f32,
    /// The node to look at next, if no leaves wait.
    next: (u32, Frame),
    /// Those it meets and has not looked at, the nearest last, with where it enters them.
    stack: SmallVec<[(f32, u32, Frame); 64]>,
    /// Leaves of the last node, the same way.
    waiting: SmallVec<[(f32, Range<u32>); WIDTH]>,
}

/// Casts rays, which `begin` makes ready until there are none left, as [`Cast::walk`] does, roughly nearest first; `leaf`
/// returns the limit anew, and `end` takes what came of each ray, with its number, in no certain order.
pub(crate) fn cast_all<'t, S>(
    tree: &'t Tree,
    count: usize,
    begin: impl Fn(usize) -> (Cast<'t>, S),
    leaf: impl Fn(&Cast<'t>, &mut S, Range<u32>) -> f32,
    mut end: impl FnMut(usize, &Cast<'t>, &S),
) {
    let Some(root) = tree.root() else { return };
    let mut lanes: Vec<Lane<'t, S>> = Vec::new();
    let mut begun = count.min(LANES);
    for number in 0..begun {
        let (cast, state) = begin(number);
        let (stack, waiting) = (SmallVec::new(), SmallVec::new());
        lanes.push(Lane { number, cast, state, limit: f32::INFINITY, next: root, stack, waiting });
    }
    while !lanes.is_empty() {
        lanes.iter().for_each(|lane| lane.touch(tree));
        let mut i = 0;
        while let Some(lane) = lanes.get_mut(i) {
            if lane.step(tree, &leaf) {
                i += 1;
                continue;
            }
            end(lane.number, &lane.cast, &lane.state);
            if begun < count {
                (lane.cast, lane.state) = begin(begun);
                (lane.number, lane.limit, lane.next) = (begun, f32::INFINITY, root);
                begun += 1;
                i += 1;
            } else {
                lanes.swap_remove(i);
            }
        }
    }
}

impl<'t, S> Lane<'t, S> {
    #[inline(always)]
    fn touch(&self, tree: &Tree) {
        if self.waiting.is_empty() {
            tree.touch(self.next.0);
        }
        self.waiting.iter().for_each(|(_, range)| tree.touch_triangle(range.start));
    }

    /// Looks at the leaves that wait or at the next node. Whether there is more to do.
    #[inline(always)]
    fn step(&mut self, tree: &Tree, leaf: impl Fn(&Cast<'t>, &mut S, Range<u32>) -> f32) -> bool {
        if self.waiting.is_empty() {
            let (at, frame) = self.next;
            let node = &tree.nodes[at as usize];
            let (enter, mut met) = self.cast.meets(node, &frame, self.limit);
            let bottom = self.stack.len();
            while met != 0 {
                let i = met.trailing_zeros() as usize % WIDTH;
                met &= met - 1;
                let Some(child) = node.inner(i) else {
                    self.waiting.push((enter[i], node.leaf(i)));
                    continue;
                };
                let mut j = self.stack.len();
                self.stack.push((enter[i], child, frame.of_child(node, i)));
                while j > bottom && self.stack[j - 1].0 < self.stack[j].0 {
                    self.stack.swap(j - 1, j);
                    j -= 1;
                }
            }
            if !self.waiting.is_empty() {
                return true;
            }
        } else {
            for (enter, range) in self.waiting.drain(..) {
                if enter <= self.limit {
                    self.limit = leaf(&self.cast, &mut self.state, range);
                }
            }
        }
        while let Some((enter, at, frame)) = self.stack.pop() {
            if enter <= self.limit {
                self.next = (at, frame);
                return true;
            }
        }
        false
    }
}
