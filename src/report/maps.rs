//! Relations between old and new elements.

use std::fmt;
use std::panic::{RefUnwindSafe, UnwindSafe};
use std::sync::{Arc, OnceLock};

/// Where old vertices and faces went, and where new ones come from.
///
/// # Examples
/// ```
/// use meshwright::{Maps, Relation};
/// let weld = Maps { vertices: Relation::from_map(&[Some(0), Some(1), Some(0)], 2), faces: Relation::identity(1) };
/// assert_eq!(weld.vertices.new_of(2), &[0]);
/// assert_eq!(weld.vertices.old_of(0), &[0, 2]);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Maps {
    /// Vertices.
    pub vertices: Relation,
    /// Faces.
    pub faces: Relation,
}

impl Maps {
    /// Nothing was renumbered.
    pub fn identity(vertices: usize, faces: usize) -> Self {
        Self { vertices: Relation::identity(vertices), faces: Relation::identity(faces) }
    }

    /// The relations of this operation followed by `next`.
    ///
    /// # Errors
    /// [`MapMismatch`] when `next` does not start where this one ends.
    pub fn then(&self, next: &Self) -> Result<Self, MapMismatch> {
        Ok(Self { vertices: self.vertices.then(&next.vertices)?, faces: self.faces.then(&next.faces)? })
    }

    /// The relations read backwards.
    pub fn inverse(&self) -> Self {
        Self { vertices: self.vertices.inverse(), faces: self.faces.inverse() }
    }
}

/// Two relations cannot be composed: the first ends with another number of elements than the second begins with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the first relation ends with {first} elements, the second begins with {second}")]
pub struct MapMismatch {
    /// The new elements of the first relation.
    pub first: usize,
    /// The old elements of the second.
    pub second: usize,
}

/// A many-to-many relation between old and new indices, readable both ways.
///
/// An old element that was dropped has no new one; one that was split has several; a new element made from nothing
/// has no old one. Lists are ascending. Each direction is made when it is first asked for, in O(pairs), unless the operation
/// had it anyway. Memory: 4 bytes per pair and direction, and 4 per element where lists differ in length.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(into = "RelationLists"))]
pub struct Relation {
    old_count: usize,
    new_count: usize,
    /// What the lists follow from while there are none.
    origin: Origin,
    /// For each old element its new ones.
    forward: OnceLock<Lists>,
    /// For each new element its old ones: `forward` the other way round.
    backward: OnceLock<Lists>,
}

/// Where the lists of a relation come from.
#[derive(Clone, Default)]
enum Origin {
    /// One direction is there.
    #[default]
    Listed,
    /// Every element stays what it is.
    Identity,
    /// Makes the lists of old elements.
    Made(Arc<dyn Fn() -> Lists + Send + Sync + UnwindSafe + RefUnwindSafe>),
}

impl fmt::Debug for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Listed => "Listed",
            Self::Identity => "Identity",
            Self::Made(_) => "Made",
        })
    }
}

impl PartialEq for Relation {
    fn eq(&self, other: &Self) -> bool {
        self.old_count == other.old_count
            && self.new_count == other.new_count
            && (self.is_known_identity() && other.is_known_identity() || self.backward() == other.backward())
    }
}

impl Eq for Relation {}

/// What a relation looks like in JSON: for each old index its new ones, for each new index its old ones.
#[cfg(feature = "serde")]
#[derive(serde::Serialize)]
struct RelationLists {
    new_of: Vec<Vec<u32>>,
    old_of: Vec<Vec<u32>>,
}

#[cfg(feature = "serde")]
impl From<Relation> for RelationLists {
    fn from(r: Relation) -> Self {
        let lists = |l: &Lists| (0..l.len()).map(|i| l.get(i).to_vec()).collect();
        Self { new_of: lists(r.forward()), old_of: lists(r.backward()) }
    }
}

/// Lists of indices, one after the other. `starts` is empty when every list holds exactly one index.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Lists {
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl Lists {
    fn len(&self) -> usize {
        if self.starts.is_empty() { self.items.len() } else { self.starts.len() - 1 }
    }

    fn get(&self, i: usize) -> &[u32] {
        if self.starts.is_empty() {
            return self.items.get(i).map_or(&[], std::slice::from_ref);
        }
        match self.starts.get(i..).and_then(<[u32]>::first_chunk) {
            Some(&[from, to]) => &self.items[from as usize..to as usize],
            None => &[],
        }
    }

    /// Groups pairs `(list, item)` that come in ascending order of item; a counting sort.
    fn group(count: usize, pairs: impl Iterator<Item = (u32, u32)> + Clone) -> Self {
        let mut starts = vec![0u32; count + 1];
        for (list, _) in pairs.clone() {
            starts[list as usize + 1] += 1;
        }
        let single = starts[1..].iter().all(|&n| n == 1);
        for i in 0..count {
            starts[i + 1] += starts[i];
        }
        let mut items = vec![0u32; starts[count] as usize];
        let mut at = starts.clone();
        for (list, item) in pairs {
            let slot = &mut at[list as usize];
            items[*slot as usize] = item;
            *slot += 1;
        }
        Self { starts: if single { Vec::new() } else { starts }, items }
    }

    /// Each its own.
    fn each(count: usize) -> Self {
        Self { starts: Vec::new(), items: (0..count as u32).collect() }
    }

    fn is_each(&self) -> bool {
        self.starts.is_empty() && self.items.iter().zip(0..).all(|(&item, i)| item == i)
    }

    /// The lists of items, of which there are `count`.
    fn turned(&self, count: usize) -> Self {
        Self::group(count, self.pairs().map(|(list, item)| (item, list)))
    }

    fn pairs(&self) -> impl Iterator<Item = (u32, u32)> + Clone + '_ {
        (0..self.len()).flat_map(move |i| self.get(i).iter().map(move |&item| (i as u32, item)))
    }
}

impl Relation {
    /// Every element stays what it is.
    pub fn identity(count: usize) -> Self {
        Self { old_count: count, new_count: count, origin: Origin::Identity, ..Self::default() }
    }

    /// Every old element has one new one or none. Entries at or past `new_count` count as none.
    pub fn from_map(new_of_old: &[Option<u32>], new_count: usize) -> Self {
        let pairs = new_of_old
            .iter()
            .enumerate()
            .filter_map(|(old, new)| new.filter(|&n| (n as usize) < new_count).map(|n| (n, old as u32)));
        Self::backwards(new_of_old.len(), Lists::group(new_count, pairs))
    }

    /// Any pairs `(old, new)`, in any order; repeats count once, pairs out of range not at all. O(n log n).
    pub fn from_pairs(
        old_count: usize,
        new_count: usize,
        pairs: impl IntoIterator<Item = (u32, u32)>,
    ) -> Self {
        let mut pairs: Vec<_> = pairs
            .into_iter()
            .filter(|&(old, new)| (old as usize) < old_count && (new as usize) < new_count)
            .collect();
        if !pairs.is_sorted() {
            pairs.sort_unstable();
        }
        pairs.dedup();
        Self::backwards(old_count, Lists::group(new_count, pairs.iter().map(|&(old, new)| (new, old))))
    }

    /// Every new element is a part of one old one, below `old_count`.
    pub(crate) fn from_parents(old_count: usize, parents: Vec<u32>) -> Self {
        Self::backwards(old_count, Lists { starts: Vec::new(), items: parents })
    }

    /// Every old element has one new one, below `new_count`, or none where the entry is `u32::MAX`.
    pub(crate) fn from_targets(targets: Vec<u32>, new_count: usize) -> Self {
        let lists = if targets.contains(&u32::MAX) {
            let mut starts = Vec::with_capacity(targets.len() + 1);
            let mut items = Vec::with_capacity(targets.len());
            starts.push(0);
            for new in targets {
                items.extend(Some(new).filter(|&n| n != u32::MAX));
                starts.push(items.len() as u32);
            }
            Lists { starts, items }
        } else {
            Lists { starts: Vec::new(), items: targets }
        };
        let forward = OnceLock::from(lists);
        let old_count = forward.get().map_or(0, Lists::len);
        Self { old_count, new_count, forward, ..Self::default() }
    }

    /// For each new element, in order, its old ones: ascending, without repeats, below `old_count`; told when somebody
    /// asks.
    pub(crate) fn made(
        old_count: usize,
        new_count: usize,
        tell: impl Fn(&mut OldOf) + Send + Sync + UnwindSafe + RefUnwindSafe + 'static,
    ) -> Self {
        let make = move || {
            let mut told = OldOf { starts: Vec::with_capacity(new_count + 1), items: Vec::new() };
            told.starts.push(0);
            tell(&mut told);
            let OldOf { starts, items } = told;
            debug_assert_eq!(starts.len(), new_count + 1);
            let single = items.len() == new_count && starts.iter().zip(0u32..).all(|(&s, i)| s == i);
            Lists { starts: if single { Vec::new() } else { starts }, items }
        };
        Self { old_count, new_count, origin: Origin::Made(Arc::new(make)), ..Self::default() }
    }

    fn backwards(old_count: usize, backward: Lists) -> Self {
        let new_count = backward.len();
        Self { old_count, new_count, backward: OnceLock::from(backward), ..Self::default() }
    }

    fn forward(&self) -> &Lists {
        self.forward.get_or_init(|| match &self.origin {
            Origin::Identity => Lists::each(self.old_count),
            _ => self.backward().turned(self.old_count),
        })
    }

    fn backward(&self) -> &Lists {
        self.backward.get_or_init(|| match (&self.origin, self.forward.get()) {
            (Origin::Identity, _) => Lists::each(self.new_count),
            (Origin::Made(make), _) => make(),
            (Origin::Listed, Some(forward)) => forward.turned(self.new_count),
            // No element at all: the default.
            (Origin::Listed, None) => Lists::default(),
        })
    }

    fn is_known_identity(&self) -> bool {
        matches!(self.origin, Origin::Identity)
    }

    /// The number of old elements.
    pub fn old_len(&self) -> usize {
        self.old_count
    }

    /// The number of new elements.
    pub fn new_len(&self) -> usize {
        self.new_count
    }

    /// The new elements that old element `i` became, ascending; none if it was dropped or never was. The first call may
    /// take O(pairs).
    pub fn new_of(&self, i: usize) -> &[u32] {
        self.forward().get(i)
    }

    /// The old elements that new element `i` was made from, ascending. The first call may take O(pairs).
    pub fn old_of(&self, i: usize) -> &[u32] {
        self.backward().get(i)
    }

    /// Whether every element stays what it is.
    pub fn is_identity(&self) -> bool {
        self.is_known_identity() || self.old_count == self.new_count && self.backward().is_each()
    }

    /// This relation followed by `next`.
    ///
    /// # Errors
    /// [`MapMismatch`] when `next` does not start where this one ends.
    pub fn then(&self, next: &Self) -> Result<Self, MapMismatch> {
        if self.new_len() != next.old_len() {
            return Err(MapMismatch { first: self.new_len(), second: next.old_len() });
        }
        if self.is_known_identity() {
            return Ok(next.clone());
        }
        if next.is_known_identity() {
            return Ok(self.clone());
        }
        let pairs = self
            .forward()
            .pairs()
            .flat_map(|(old, mid)| next.new_of(mid as usize).iter().map(move |&new| (old, new)));
        Ok(Self::from_pairs(self.old_len(), next.new_len(), pairs))
    }

    /// The same with new elements added at the end that come from nothing.
    pub(crate) fn widened(self, new_len: usize) -> Self {
        if new_len <= self.new_len() {
            return self;
        }
        let backward = Lists::group(new_len, self.backward().pairs());
        Self::backwards(self.old_count, backward)
    }

    /// The relation read backwards.
    pub fn inverse(&self) -> Self {
        if self.is_known_identity() {
            return self.clone();
        }
        Self {
            old_count: self.new_count,
            new_count: self.old_count,
            origin: Origin::Listed,
            forward: OnceLock::from(self.backward().clone()),
            backward: self.forward.clone(),
        }
    }
}

/// What each new element was made of, told in order.
pub(crate) struct OldOf {
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl OldOf {
    /// The next new element's old ones: any order, no repeats.
    pub(crate) fn add(&mut self, old: impl IntoIterator<Item = u32>) {
        let first = self.items.len();
        self.items.extend(old);
        self.items[first..].sort_unstable();
        self.starts.push(self.items.len() as u32);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_relation_followed_by_its_inverse_relates_the_merged_elements() {
        let weld = Relation::from_map(&[Some(0), Some(0), None, Some(1)], 2);
        let around = weld.then(&weld.inverse()).unwrap();
        assert_eq!(around.new_of(0), &[0, 1]);
        assert_eq!(around.new_of(2), &[] as &[u32]);
        assert_eq!(around.new_of(3), &[3]);
    }

    #[test]
    fn a_split_reads_both_ways() {
        let split = Relation::from_pairs(2, 3, [(1, 2), (0, 0), (1, 1), (1, 2)]);
        assert_eq!(split.new_of(1), &[1, 2]);
        assert_eq!(split.old_of(2), &[1]);
        assert_eq!(split.new_of(9), &[] as &[u32]);
        assert_eq!((split.old_of(3), split.new_of(usize::MAX)), (&[] as &[u32], &[] as &[u32]));
        assert_eq!(Relation::identity(2).old_of(usize::MAX), &[] as &[u32]);
    }

    #[test]
    fn composing_relations_of_different_sizes_is_refused() {
        let refused = Relation::identity(2).then(&Relation::identity(3));
        assert_eq!(refused, Err(MapMismatch { first: 2, second: 3 }));
    }

    #[test]
    fn identity_is_recognised_however_it_was_made() {
        assert!(Relation::from_map(&[Some(0), Some(1)], 2).is_identity());
        assert!(Relation::identity(2).then(&Relation::identity(2)).unwrap().is_identity());
        assert!(!Relation::from_map(&[Some(1), Some(0)], 2).is_identity());
        assert!(!Relation::from_map(&[Some(0)], 2).is_identity());
    }
}
