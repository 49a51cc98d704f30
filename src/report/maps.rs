//! Relations between old and new elements.

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
/// has no old one. Lists are ascending. Memory: 4 bytes per pair and direction, and 4 per element where lists differ
/// in length.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(into = "RelationLists"))]
pub struct Relation {
    forward: Lists,
    backward: Lists,
}

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
        Self { new_of: lists(&r.forward), old_of: lists(&r.backward) }
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
            self.items.get(i..i + 1).unwrap_or(&[])
        } else if i + 1 < self.starts.len() {
            &self.items[self.starts[i] as usize..self.starts[i + 1] as usize]
        } else {
            &[]
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

    fn pairs(&self) -> impl Iterator<Item = (u32, u32)> + Clone + '_ {
        (0..self.len()).flat_map(move |i| self.get(i).iter().map(move |&item| (i as u32, item)))
    }
}

impl Relation {
    /// Every element stays what it is.
    pub fn identity(count: usize) -> Self {
        let lists = Lists { starts: Vec::new(), items: (0..count as u32).collect() };
        Self { forward: lists.clone(), backward: lists }
    }

    /// Every old element has one new one or none. Entries at or past `new_count` count as none.
    pub fn from_map(new_of_old: &[Option<u32>], new_count: usize) -> Self {
        let pairs = new_of_old
            .iter()
            .enumerate()
            .filter_map(|(old, new)| new.filter(|&n| (n as usize) < new_count).map(|n| (old as u32, n)));
        Self {
            forward: Lists::group(new_of_old.len(), pairs.clone()),
            backward: Lists::group(new_count, pairs.map(|(old, new)| (new, old))),
        }
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
        Self {
            forward: Lists::group(old_count, pairs.iter().copied()),
            backward: Lists::group(new_count, pairs.iter().map(|&(old, new)| (new, old))),
        }
    }

    /// Every new element is a part of one old one, below `old_count`. O(elements).
    pub(crate) fn from_parents(old_count: usize, parents: Vec<u32>) -> Self {
        let forward = Lists::group(old_count, parents.iter().copied().zip(0..));
        Self { forward, backward: Lists { starts: Vec::new(), items: parents } }
    }

    /// For each new element, in order, its old ones: ascending, without repeats, below `old_count`. O(pairs).
    pub(crate) fn from_old_of(old_count: usize, starts: Vec<u32>, items: Vec<u32>) -> Self {
        let count = starts.len().saturating_sub(1);
        let single = items.len() == count && starts.iter().zip(0u32..).all(|(&s, i)| s == i);
        let mut forward = vec![0u32; old_count + 1];
        items.iter().for_each(|&old| forward[old as usize + 1] += 1);
        let is_single = forward[1..].iter().all(|&n| n == 1);
        (0..old_count).for_each(|i| forward[i + 1] += forward[i]);
        let mut list = vec![0u32; items.len()];
        let mut at = forward.clone();
        for (range, new) in starts.windows(2).zip(0..) {
            for &old in &items[range[0] as usize..range[1] as usize] {
                let slot = &mut at[old as usize];
                list[*slot as usize] = new;
                *slot += 1;
            }
        }
        Self {
            forward: Lists { starts: if is_single { Vec::new() } else { forward }, items: list },
            backward: Lists { starts: if single { Vec::new() } else { starts }, items },
        }
    }

    /// The number of old elements.
    pub fn old_len(&self) -> usize {
        self.forward.len()
    }

    /// The number of new elements.
    pub fn new_len(&self) -> usize {
        self.backward.len()
    }

    /// The new elements that old element `i` became, ascending; none if it was dropped or never was.
    pub fn new_of(&self, i: usize) -> &[u32] {
        self.forward.get(i)
    }

    /// The old elements that new element `i` was made from, ascending.
    pub fn old_of(&self, i: usize) -> &[u32] {
        self.backward.get(i)
    }

    /// Whether every element stays what it is.
    pub fn is_identity(&self) -> bool {
        self.forward.starts.is_empty()
            && self.backward.starts.is_empty()
            && self.forward.items.iter().enumerate().all(|(i, &n)| n as usize == i)
    }

    /// This relation followed by `next`.
    ///
    /// # Errors
    /// [`MapMismatch`] when `next` does not start where this one ends.
    pub fn then(&self, next: &Self) -> Result<Self, MapMismatch> {
        if self.new_len() != next.old_len() {
            return Err(MapMismatch { first: self.new_len(), second: next.old_len() });
        }
        let pairs = self
            .forward
            .pairs()
            .flat_map(|(old, mid)| next.new_of(mid as usize).iter().map(move |&new| (old, new)));
        Ok(Self::from_pairs(self.old_len(), next.new_len(), pairs))
    }

    /// The same with new elements added at the end that come from nothing.
    pub(crate) fn widened(mut self, new_len: usize) -> Self {
        if new_len > self.new_len() {
            let pairs: Vec<_> = self.backward.pairs().collect();
            self.backward = Lists::group(new_len, pairs.into_iter());
        }
        self
    }

    /// The relation read backwards.
    pub fn inverse(&self) -> Self {
        Self { forward: self.backward.clone(), backward: self.forward.clone() }
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
