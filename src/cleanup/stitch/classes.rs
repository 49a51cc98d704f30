//! Ends of naked edges that are to become one vertex.

use super::seams::Seams;
use glam::DVec3;

/// Sets of ends. All members are within reach of the one that is kept, no two are in one face, and no edge has come to
/// more than two faces by them.
pub(super) struct Classes<'s, 'p> {
    pub(super) seams: &'s Seams<'p>,
    /// For each end the member after which its class is named.
    class: Vec<u32>,
    /// The members of each class in a ring.
    next: Vec<u32>,
    size: Vec<u32>,
    kept: Vec<u32>,
    /// How much may still be looked at: a file made to be slow is stitched in part.
    budget: u64,
    /// How many places may still be looked at beside that, over all edges.
    looks: usize,
    /// How many naked edges were not searched around to the end, and the first of them.
    unsearched: (usize, Option<u32>),
    around: [Around; 2],
}

/// The faces at a class, and the vertices it shares edges with, once for each use: sorted.
#[derive(Default)]
struct Around {
    faces: Vec<u32>,
    neighbors: Vec<u32>,
}

impl<'s, 'p> Classes<'s, 'p> {
    /// Each end on its own.
    pub(super) fn new(seams: &'s Seams<'p>) -> Self {
        let own: Vec<u32> = (0..seams.vertex.len() as u32).collect();
        Self {
            seams,
            class: own.clone(),
            next: own.clone(),
            size: vec![1; own.len()],
            kept: own,
            budget: 32 * seams.edges.len() as u64 + (1 << 22),
            looks: 64 * seams.edges.len() + (1 << 22),
            unsearched: (0, None),
            around: Default::default(),
        }
    }

    pub(super) fn of(&self, end: u32) -> u32 {
        self.class[end as usize]
    }

    /// The member at whose place a class is.
    pub(super) fn kept(&self, class: u32) -> u32 {
        self.kept[class as usize]
    }

    pub(super) fn place(&self, class: u32) -> DVec3 {
        self.seams.at(self.kept(class))
    }

    /// The name of the class of any vertex of the pool, among vertices of the pool.
    pub(super) fn key(&self, vertex: u32) -> u32 {
        self.seams.number(vertex).map_or(vertex, |end| self.seams.vertex[self.of(end) as usize])
    }

    pub(super) fn members(&self, class: u32) -> impl Iterator<Item = u32> + '_ {
        let mut at = Some(class);
        std::iter::from_fn(move || {
            let here = at?;
            at = Some(self.next[here as usize]).filter(|&n| n != class);
            Some(here)
        })
    }

    /// Takes a class apart.
    pub(super) fn dissolve(&mut self, class: u32) {
        for end in self.members(class).collect::<Vec<_>>() {
            let i = end as usize;
            (self.class[i], self.next[i], self.size[i], self.kept[i]) = (end, end, 1, end);
        }
    }

    /// Spends on looking at something; whether there was enough.
    fn spend(&mut self, on: usize) -> bool {
        let left = self.budget.checked_sub(on as u64);
        self.budget = left.unwrap_or(0);
        if left.is_none() && self.unsearched.0 == 0 {
            self.unsearched = (1, Some(0));
        }
        left.is_some()
    }

    /// How many places may still be looked at over all.
    pub(super) fn looks(&self) -> usize {
        self.looks
    }

    /// Spends looks on what lies around a naked edge, and writes down if that was not all.
    pub(super) fn looked(&mut self, edge: u32, looks: usize, is_all: bool) {
        self.looks = self.looks.saturating_sub(looks);
        if !is_all {
            self.unsearched.0 += 1;
            self.unsearched.1.get_or_insert(edge);
        }
    }

    /// How many naked edges were not searched around to the end, if there are any, and the corner of the first.
    pub(super) fn unsearched(&self) -> Option<(usize, u32)> {
        let (count, first) = self.unsearched;
        first.map(|edge| (count.min(self.seams.edges.len()), self.seams.edges[edge as usize].corner))
    }

    /// Whether two ends may be joined, or are.
    pub(super) fn can_join(&mut self, a: u32, b: u32) -> bool {
        self.joint(a, b).is_some()
    }

    /// Makes the classes of two ends one, if that folds no face, makes no edge of three or more faces and moves nothing
    /// too far. Whether they are one now.
    pub(super) fn join(&mut self, a: u32, b: u32) -> bool {
        let Some(kept) = self.joint(a, b) else { return false };
        let (a, b) = (self.of(a), self.of(b));
        if a != b {
            let (from, to) = if self.size[a as usize] < self.size[b as usize] { (a, b) } else { (b, a) };
            for end in self.members(from).collect::<Vec<_>>() {
                self.class[end as usize] = to;
            }
            self.next.swap(from as usize, to as usize);
            self.size[to as usize] += self.size[from as usize];
            self.kept[to as usize] = kept;
        }
        true
    }

    /// Which member a class of both would keep.
    fn joint(&mut self, a: u32, b: u32) -> Option<u32> {
        let (a, b) = (self.of(a), self.of(b));
        if a == b {
            return Some(self.kept(a));
        }
        let sizes = self.size[a as usize] + self.size[b as usize];
        if !self.spend(sizes as usize) {
            return None;
        }
        let ends = [self.kept(a), self.kept(b)];
        let can_keep = |&end: &u32| {
            let place = self.seams.at(end);
            self.members(a)
                .chain(self.members(b))
                .all(|m| self.seams.at(m).distance(place) <= self.seams.reach)
        };
        let kept = [ends[0].min(ends[1]), ends[0].max(ends[1])].into_iter().find(can_keep)?;
        let [mut first, mut second] = std::mem::take(&mut self.around);
        let looked = self.look_around(a, &mut first) && self.look_around(b, &mut second);
        let fits = looked && !first.shares_face(&second) && !first.overfills(&second);
        self.around = [first, second];
        fits.then_some(kept)
    }

    fn look_around(&mut self, class: u32, around: &mut Around) -> bool {
        around.faces.clear();
        around.neighbors.clear();
        for end in self.members(class) {
            for &c in self.seams.corners_at(end) {
                around.faces.push(self.seams.face(c));
                around.neighbors.extend(self.seams.beside(c).map(|v| self.key(v)));
            }
        }
        around.faces.sort_unstable();
        around.neighbors.sort_unstable();
        self.spend(around.faces.len())
    }

    /// Whether a class has an edge to a vertex.
    pub(super) fn is_joined(&mut self, class: u32, vertex: u32) -> bool {
        let corners: usize = self.members(class).map(|m| self.seams.corners_at(m).len()).sum();
        if !self.spend(corners) {
            return true;
        }
        let key = self.key(vertex);
        let mut at = self.members(class).flat_map(|m| self.seams.corners_at(m));
        at.any(|&c| self.seams.beside(c).iter().any(|&v| self.key(v) == key))
    }
}

impl Around {
    fn shares_face(&self, other: &Self) -> bool {
        common(&self.faces, &other.faces).next().is_some()
    }

    /// Whether an edge of one comes to lie on an edge of the other, and more than two faces are there.
    fn overfills(&self, other: &Self) -> bool {
        common(&self.neighbors, &other.neighbors).any(|(a, b)| a + b > 2)
    }
}

/// How often each value that is in both sorted lists is in each of them.
fn common<'a>(a: &'a [u32], b: &'a [u32]) -> impl Iterator<Item = (usize, usize)> + 'a {
    let (mut i, mut j) = (0, 0);
    std::iter::from_fn(move || {
        while i < a.len() && j < b.len() {
            match a[i].cmp(&b[j]) {
                std::cmp::Ordering::Less => i += 1,
                std::cmp::Ordering::Greater => j += 1,
                std::cmp::Ordering::Equal => {
                    let value = a[i];
                    let count = |list: &[u32]| list.iter().take_while(|&&x| x == value).count();
                    let counts = (count(&a[i..]), count(&b[j..]));
                    (i, j) = (i + counts.0, j + counts.1);
                    return Some(counts);
                }
            }
        }
        None
    })
}
