//! The record of edits as a stream, and the lineage of elements across it.

use super::Few;
use crate::report::{Maps, Relation};
use crate::{EdgeKey, FaceKey, Mesh, VertexKey};
use smallvec::SmallVec;

/// One thing that an edit did. An edit tells its births before its deaths.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Change {
    /// A vertex was made.
    VertexBorn {
        /// The vertex.
        vertex: VertexKey,
        /// What it was made from: the ends of an edge, the corners of a face, the vertex it was split off; or nothing.
        from: Few<VertexKey>,
    },
    /// A vertex has another position.
    VertexMoved {
        /// The vertex.
        vertex: VertexKey,
    },
    /// A vertex was removed.
    VertexDied {
        /// The vertex.
        vertex: VertexKey,
        /// The vertex it was merged into, if it was.
        into: Option<VertexKey>,
    },
    /// An edge was made.
    EdgeBorn {
        /// The edge.
        edge: EdgeKey,
        /// The edge it was a part of, if it was.
        from: Option<EdgeKey>,
    },
    /// An edge was removed.
    EdgeDied {
        /// The edge.
        edge: EdgeKey,
        /// The edge it was merged into, if it was.
        into: Option<EdgeKey>,
    },
    /// A face was made.
    FaceBorn {
        /// The face.
        face: FaceKey,
        /// The face it was a part of, if it was.
        from: Option<FaceKey>,
    },
    /// A face was removed.
    FaceDied {
        /// The face.
        face: FaceKey,
        /// The face it was merged into, if it was.
        into: Option<FaceKey>,
    },
    /// The changes before this one were taken back by [`Mesh::restore`].
    Undone {
        /// How many, of those that were not yet taken back.
        count: usize,
    },
}

/// Changes that were told and not yet fetched.
#[derive(Clone, Debug, Default)]
pub(crate) struct Changes {
    list: Vec<Change>,
    /// How many stand, fetched or not: those taken back are not counted.
    told: u64,
    /// How much was noted for checkpoints in the oldest state that was told of: when the telling began, or what was
    /// restored since.
    since: u64,
    /// How many changes had been told in that state.
    base: u64,
}

impl Changes {
    pub(crate) fn told(&self) -> u64 {
        self.told
    }

    /// Takes back all that was told since there were `told`; returns from which word of the undo log on that covers
    /// everything.
    pub(crate) fn take_back(&mut self, told: Option<u64>) -> u64 {
        let keep = told.unwrap_or(self.base);
        let count = (self.told - keep) as usize;
        self.told = keep;
        match self.list.len().checked_sub(count) {
            // A word of taking back in the list stands for what was fetched before: it must stay.
            Some(left) if !self.list[left..].iter().any(|c| matches!(c, Change::Undone { .. })) => {
                self.list.truncate(left);
            }
            _ => self.list.push(Change::Undone { count }),
        }
        if told.is_some() { 0 } else { self.since }
    }

    /// A state with less noted was told of, piece by piece.
    pub(crate) fn reached(&mut self, words: u64) {
        if words < self.since {
            (self.since, self.base) = (words, self.told);
        }
    }
}

/// # The record of edits
impl Mesh {
    /// Begins to record what edits do, for [`take_changes`](Self::take_changes). Does nothing if it is recorded already.
    /// Bulk operations that make a new mesh are no edits: they return [`Maps`].
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{Change, IndexedMesh, Mesh, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// mesh.record_changes();
    /// let e = mesh.edges().next().unwrap();
    /// let new = mesh.split_edge(e, DVec3::X / 2.0)?;
    /// let changes = mesh.take_changes();
    /// assert!(changes.contains(&Change::EdgeBorn { edge: new.edge, from: Some(e) }));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn record_changes(&mut self) {
        let since = self.undo.as_ref().map_or(0, |u| u.len());
        self.changes.get_or_insert_with(|| Box::new(Changes { since, ..Changes::default() }));
    }

    /// The changes since the last call, in order; the recording goes on. Empty if nothing is recorded.
    pub fn take_changes(&mut self) -> Vec<Change> {
        self.changes.as_mut().map(|c| std::mem::take(&mut c.list)).unwrap_or_default()
    }

    /// Ends the recording, and returns the changes since the last call of [`take_changes`](Self::take_changes).
    pub fn stop_recording(&mut self) -> Vec<Change> {
        if let Some(undo) = &mut self.undo {
            undo.stop_listening();
        }
        self.changes.take().map(|c| c.list).unwrap_or_default()
    }

    /// Tells a change, if anybody listens.
    #[inline]
    pub(crate) fn tell(&mut self, change: impl FnOnce(&Self) -> Change) {
        if self.changes.is_some() {
            let change = change(self);
            if let Some(changes) = &mut self.changes {
                changes.told += 1;
                changes.list.push(change);
            }
        }
    }

    /// Does edits, and tells what they did; whoever listens hears it too.
    pub(crate) fn traced<T>(&mut self, edits: impl FnOnce(&mut Self) -> T) -> (T, Vec<Change>) {
        let is_heard = self.changes.is_some();
        self.record_changes();
        let heard = |mesh: &Self| mesh.changes.as_ref().map_or(0, |c| c.list.len());
        let from = heard(self);
        let result = edits(self);
        let told = match (&self.changes, is_heard) {
            (Some(changes), true) => changes.list.get(from..).unwrap_or_default().to_vec(),
            _ => self.stop_recording(),
        };
        (result, told)
    }

    /// The keys of vertices and faces in the order of [`to_indexed`](Self::to_indexed): what [`Lineage::maps`] numbers by.
    pub fn numbering(&self) -> Numbering {
        Numbering {
            vertices: self.vertices.in_user_order().into_iter().map(|v| self.vertices.key(v)).collect(),
            faces: self.faces.in_user_order().into_iter().map(|f| self.faces.key(f)).collect(),
        }
    }
}

/// Which key has which number in the indexed form of a mesh at some time.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Numbering {
    /// Vertices in order.
    pub vertices: Vec<VertexKey>,
    /// Faces in order.
    pub faces: Vec<FaceKey>,
}

/// Where elements come from, across any sequence of edits: the changes of a mesh, followed from the first to the last.
///
/// # Examples
/// ```
/// # use meshwright::{IndexedMesh, Lineage, Mesh, glam::DVec3};
/// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y];
/// # let mut mesh = Mesh::build(&IndexedMesh::new(points, vec![vec![0, 1, 2, 3]].into())?)?;
/// let before = mesh.numbering();
/// mesh.record_changes();
/// let quad = mesh.faces().next().unwrap();
/// mesh.poke_face(quad, DVec3::new(0.5, 0.5, 1.0))?;
/// let lineage = Lineage::of(mesh.take_changes());
/// let maps = lineage.maps(&before, &mesh.numbering());
/// assert_eq!(maps.faces.new_of(0), &[0, 1, 2, 3]);
/// assert_eq!(maps.vertices.old_of(4), &[0, 1, 2, 3]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Lineage {
    /// What stands.
    changes: Vec<Change>,
}

impl Lineage {
    /// The lineage across a sequence of changes.
    pub fn of(changes: impl IntoIterator<Item = Change>) -> Self {
        let mut lineage = Self::default();
        lineage.extend(changes);
        lineage
    }

    /// The changes that stand: what was taken back is not among them.
    pub fn changes(&self) -> &[Change] {
        &self.changes
    }

    /// The relation of vertices and faces, from the numbering before the first change to that after the last: an element
    /// made from others is related to them, and one that went into another to that. O(n).
    pub fn maps(&self, before: &Numbering, after: &Numbering) -> Maps {
        let mut vertices = Roots::new(&before.vertices);
        let mut faces = Roots::new(&before.faces);
        for change in &self.changes {
            match change {
                Change::VertexBorn { vertex, from } => vertices.born(*vertex, from),
                Change::VertexDied { vertex, into } => vertices.died(*vertex, *into),
                Change::FaceBorn { face, from } => faces.born(*face, from.as_slice()),
                Change::FaceDied { face, into } => faces.died(*face, *into),
                _ => {}
            }
        }
        Maps {
            vertices: vertices.relation(before.vertices.len(), &after.vertices),
            faces: faces.relation(before.faces.len(), &after.faces),
        }
    }
}

impl Extend<Change> for Lineage {
    /// Follows further changes.
    fn extend<I: IntoIterator<Item = Change>>(&mut self, changes: I) {
        for change in changes {
            match change {
                Change::Undone { count } => self.changes.truncate(self.changes.len().saturating_sub(count)),
                change => self.changes.push(change),
            }
        }
    }
}

/// For each live key the old elements it holds.
struct Roots<K> {
    /// By slot, the key that is live there.
    of: Vec<Option<(K, SmallVec<[u32; 2]>)>>,
}

impl<K: slotmap::Key> Roots<K> {
    fn new(old: &[K]) -> Self {
        let mut roots = Self { of: Vec::new() };
        old.iter().zip(0..).for_each(|(&k, i)| roots.put(k, SmallVec::from_slice(&[i])));
        roots
    }

    fn slot(key: K) -> usize {
        key.data().as_ffi() as u32 as usize
    }

    fn get(&self, key: K) -> &[u32] {
        match self.of.get(Self::slot(key)) {
            Some(Some((live, roots))) if *live == key => roots,
            _ => &[],
        }
    }

    fn put(&mut self, key: K, roots: SmallVec<[u32; 2]>) {
        let slot = Self::slot(key);
        if slot >= self.of.len() {
            self.of.resize(slot + 1, None);
        }
        self.of[slot] = Some((key, roots));
    }

    fn born(&mut self, key: K, from: &[K]) {
        let roots = from.iter().flat_map(|&k| self.get(k)).copied().collect();
        self.put(key, sorted(roots));
    }

    fn died(&mut self, key: K, into: Option<K>) {
        let mut roots = SmallVec::from_slice(self.get(key));
        if let Some(entry) = self.of.get_mut(Self::slot(key)) {
            entry.take_if(|(live, _)| *live == key);
        }
        if let Some(into) = into {
            roots.extend_from_slice(self.get(into));
            self.put(into, sorted(roots));
        }
    }

    fn relation(&self, old: usize, new: &[K]) -> Relation {
        let pairs = new.iter().zip(0..).flat_map(|(&k, new)| self.get(k).iter().map(move |&old| (old, new)));
        Relation::from_pairs(old, new.len(), pairs)
    }
}

fn sorted(mut roots: SmallVec<[u32; 2]>) -> SmallVec<[u32; 2]> {
    roots.sort_unstable();
    roots.dedup();
    roots
}
