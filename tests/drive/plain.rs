//! A mesh as plain lists of faces, on which the naive twin works.

use meshwright::glam::DVec3;
use meshwright::{EdgeKey, FaceKey, IndexedMesh, Mesh, VertexKey};
use std::collections::{BTreeMap, BTreeSet};

/// An element of the mesh before, or the i-th that the operator's result names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Id<K> {
    Old(K),
    New(usize),
}
use Id::{New, Old};

impl<K: Copy> Id<K> {
    /// The key, given those that the result names.
    pub(crate) fn key(self, named: &[K]) -> K {
        match self {
            Old(key) => key,
            New(i) => named[i],
        }
    }
}

pub(crate) type V = Id<VertexKey>;
pub(crate) type E = Id<EdgeKey>;
pub(crate) type F = Id<FaceKey>;

/// A mesh as plain lists.
#[derive(Clone, Debug)]
pub(crate) struct Plain {
    pub(crate) at: BTreeMap<V, DVec3>,
    /// From the first corner.
    pub(crate) faces: BTreeMap<F, Vec<V>>,
    /// From where to where each edge's half-edge runs.
    pub(crate) edges: BTreeMap<E, [V; 2]>,
}

/// How many there are of what topology counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Counts {
    pub(crate) euler: i64,
    pub(crate) loops: i64,
    pub(crate) components: i64,
    pub(crate) isolated: i64,
}

/// Without the half-edges of edges.
pub(crate) fn around(cycle: &[V]) -> impl Iterator<Item = (V, V)> {
    (0..cycle.len()).map(|i| (cycle[i], cycle[(i + 1) % cycle.len()]))
}

pub(crate) fn rotated(cycle: &[V], first: V) -> Vec<V> {
    let at = cycle.iter().position(|&v| v == first).expect("a corner of the face");
    cycle[at..].iter().chain(&cycle[..at]).copied().collect()
}

impl Plain {
    pub(crate) fn of(mesh: &Mesh) -> Self {
        let cycle = |f| mesh.face_vertices(f).map(Old).collect();
        let ends = |e| mesh.edge_halfedge(e);
        Self {
            at: mesh.vertices().map(|v| (Old(v), mesh.position(v))).collect(),
            faces: mesh.faces().map(|f| (Old(f), cycle(f))).collect(),
            edges: mesh
                .edges()
                .map(|e| (Old(e), [Old(mesh.origin(ends(e))), Old(mesh.target(ends(e)))]))
                .collect(),
        }
    }

    /// The face on the left of each directed edge.
    pub(crate) fn left(&self) -> BTreeMap<(V, V), F> {
        self.faces.iter().flat_map(|(&f, cycle)| around(cycle).map(move |ends| (ends, f))).collect()
    }

    /// The boundary: where each half-edge without a face leads, by its origin.
    pub(crate) fn boundary(&self) -> BTreeMap<V, V> {
        let left = self.left();
        left.keys().filter(|&&(a, b)| !left.contains_key(&(b, a))).map(|&(a, b)| (b, a)).collect()
    }

    pub(crate) fn counts(&self) -> Counts {
        let mut root: BTreeMap<V, V> = BTreeMap::new();
        fn find(root: &BTreeMap<V, V>, mut v: V) -> V {
            while root[&v] != v {
                v = root[&v];
            }
            v
        }
        let mut pairs = BTreeSet::new();
        for cycle in self.faces.values() {
            for (a, b) in around(cycle) {
                pairs.insert((a.min(b), a.max(b)));
                root.entry(a).or_insert(a);
                root.entry(b).or_insert(b);
                let (a, b) = (find(&root, a), find(&root, b));
                root.insert(a.max(b), a.min(b));
            }
        }
        let mut next = self.boundary();
        let mut loops = 0;
        while let Some((_, mut to)) = next.pop_first() {
            loops += 1;
            while let Some(further) = next.remove(&to) {
                to = further;
            }
        }
        Counts {
            euler: self.at.len() as i64 - pairs.len() as i64 + self.faces.len() as i64,
            loops,
            components: root.iter().filter(|(v, r)| v == r).count() as i64,
            isolated: self.at.len() as i64 - root.len() as i64,
        }
    }

    /// Whether the lists build a mesh, with just the edges they name.
    pub(crate) fn builds(&self) -> Result<(), String> {
        let number: BTreeMap<V, u32> = self.at.keys().copied().zip(0..).collect();
        let cycle = |c: &Vec<V>| c.iter().map(|v| number[v]).collect::<Vec<_>>();
        let faces = self.faces.values().map(cycle).collect();
        let pool = IndexedMesh::new(self.at.values().copied().collect(), faces)
            .map_err(|e| format!("{:?}", e.defects))?;
        Mesh::build(&pool).map_err(|e| format!("{:?}", e.defects))?;
        let mut named: Vec<_> = self.edges.values().map(|&[a, b]| (a.min(b), a.max(b))).collect();
        named.sort_unstable();
        let used: BTreeSet<_> =
            self.faces.values().flat_map(|c| around(c)).map(|(a, b)| (a.min(b), a.max(b))).collect();
        match named.iter().eq(&used) {
            true => Ok(()),
            false => Err(format!("edges {named:?}, but faces have {used:?}")),
        }
    }

    /// Renames vertices in faces and edges.
    pub(crate) fn rename(&mut self, name: impl Fn(V) -> V) {
        self.faces
            .values_mut()
            .flatten()
            .chain(self.edges.values_mut().flatten())
            .for_each(|v| *v = name(*v));
    }

    pub(crate) fn edge_between(&self, a: V, b: V) -> Option<E> {
        self.edges.iter().find(|(_, ends)| **ends == [a, b] || **ends == [b, a]).map(|(&e, _)| e)
    }

    /// The targets of the edges at a vertex, clockwise; from the boundary half-edge if there is one.
    pub(crate) fn clockwise(&self, v: V) -> Vec<V> {
        let boundary = self.boundary();
        let before: BTreeMap<V, V> = self
            .faces
            .values()
            .filter(|c| c.contains(&v))
            .map(|c| {
                let c = rotated(c, v);
                (c[c.len() - 1], c[1])
            })
            .collect();
        let Some(first) = boundary.get(&v).or(before.keys().next()).copied() else { return Vec::new() };
        let mut order = vec![first];
        // Clockwise after `n` comes what follows n -> v in its face.
        while let Some(&n) = before.get(&order[order.len() - 1])
            && n != first
        {
            order.push(n);
        }
        order
    }
}

/// The cycle from the face's first corner, if that is among its corners still.
pub(crate) fn keeping_first(before: &Plain, f: F, cycle: Vec<V>) -> Vec<V> {
    let first = before.faces[&f][0];
    if cycle.contains(&first) { rotated(&cycle, first) } else { cycle }
}

pub(crate) fn without_bare_edges(mut p: Plain) -> Plain {
    let left = p.left();
    p.edges.retain(|_, &mut [a, b]| left.contains_key(&(a, b)) || left.contains_key(&(b, a)));
    p
}

pub(crate) fn put_on_edge(p: &mut Plain, e: EdgeKey, position: DVec3) -> Option<()> {
    let [a, b] = *p.edges.get(&Old(e))?;
    p.at.insert(New(0), position);
    p.edges.insert(Old(e), [a, New(0)]);
    p.edges.insert(New(0), [New(0), b]);
    for cycle in p.faces.values_mut() {
        let at = around(cycle).position(|ends| ends == (a, b) || ends == (b, a));
        if let Some(at) = at {
            cycle.insert(at + 1, New(0));
        }
    }
    Some(())
}
