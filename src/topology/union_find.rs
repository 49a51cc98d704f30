//! Disjoint sets of indices; the lowest index of a set is its root, so labels do not depend on the order of joins.

#[derive(Clone, Debug)]
pub(crate) struct UnionFind {
    parent: Vec<u32>,
    joined: Vec<bool>,
    joins: usize,
}

impl UnionFind {
    pub(crate) fn new(count: usize) -> Self {
        Self { parent: (0..count as u32).collect(), joined: vec![false; count], joins: 0 }
    }

    /// The lowest index of the set. Halves the path on its way.
    pub(crate) fn root(&mut self, mut i: u32) -> u32 {
        while self.parent[i as usize] != i {
            let grand = self.parent[self.parent[i as usize] as usize];
            self.parent[i as usize] = grand;
            i = grand;
        }
        i
    }

    pub(crate) fn join(&mut self, a: u32, b: u32) {
        self.joined[a as usize] = true;
        self.joined[b as usize] = true;
        let (a, b) = (self.root(a), self.root(b));
        if a != b {
            self.parent[a.max(b) as usize] = a.min(b);
            self.joins += 1;
        }
    }

    /// Whether `i` never took part in a join.
    pub(crate) fn is_single(&self, i: u32) -> bool {
        !self.joined[i as usize]
    }

    /// How many joins made two sets into one.
    pub(crate) fn joins(&self) -> usize {
        self.joins
    }

    /// For each index the number of its set, counted in the order of lowest indices; and the number of sets.
    pub(crate) fn labels(mut self) -> (Vec<u32>, usize) {
        let mut labels: Vec<u32> = Vec::with_capacity(self.parent.len());
        let mut count = 0;
        for i in 0..self.parent.len() {
            // A root comes before its members.
            let root = self.root(i as u32) as usize;
            let label = if root < i { labels[root] } else { count };
            count += u32::from(root == i);
            labels.push(label);
        }
        (labels, count as usize)
    }
}
