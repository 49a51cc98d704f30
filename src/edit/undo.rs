//! Checkpoints: what was overwritten since, so that it can be put back.

use super::changes::Change;
use crate::Mesh;
use crate::column::Kind;
use glam::DVec3;
use slotmap::Key;
use std::sync::atomic::{AtomicU64, Ordering};

/// A state of a mesh to come back to: made by [`Mesh::checkpoint`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Checkpoint(u64);

/// The checkpoint is not one of the mesh's: it was forgotten, or an earlier one was restored since, or it is of another
/// mesh. Nothing has changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the mesh does not know this checkpoint (any more)")]
pub struct UnknownCheckpoint;

/// What was overwritten.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Field {
    Next,
    Prev,
    Origin,
    Face,
    VertexHalfedge,
    FaceHalfedge,
    /// The position is on the stack of positions.
    Position,
    /// The value is on the stack of the column whose place stands for the old value.
    Value(Kind),
    VertexBorn,
    EdgeBorn,
    FaceBorn,
    /// The slot was detached; its version stands for the old value.
    VertexDied,
    EdgeDied,
    FaceDied,
}

#[derive(Clone, Copy, Debug)]
struct Word {
    field: Field,
    slot: u32,
    old: u32,
}

/// A checkpoint, and how much had been overwritten and told when it was made; counted from the beginning of time.
#[derive(Clone, Copy, Debug)]
struct Mark {
    id: u64,
    words: u64,
    changes: Option<u64>,
}

/// All that was overwritten since the oldest checkpoint.
#[derive(Clone, Debug, Default)]
pub(crate) struct Undo {
    words: Vec<Word>,
    positions: Vec<DVec3>,
    marks: Vec<Mark>,
    /// How many words were forgotten.
    forgotten: u64,
}

impl Undo {
    #[inline]
    pub(crate) fn push(&mut self, field: Field, slot: u32, old: u32) {
        self.words.push(Word { field, slot, old });
    }

    pub(crate) fn position(&mut self, slot: u32, old: DVec3) {
        self.positions.push(old);
        self.push(Field::Position, slot, 0);
    }

    /// The value itself is remembered by its column.
    pub(crate) fn value(&mut self, kind: Kind, column: u32, slot: u32) {
        self.push(Field::Value(kind), slot, column);
    }

    /// Words since the beginning of time.
    pub(crate) fn len(&self) -> u64 {
        self.forgotten + self.words.len() as u64
    }

    /// What was told so far was told to a listener that is gone.
    pub(crate) fn stop_listening(&mut self) {
        self.marks.iter_mut().for_each(|m| m.changes = None);
    }

    fn mark(&self, checkpoint: Checkpoint) -> Result<usize, UnknownCheckpoint> {
        self.marks.iter().position(|m| m.id == checkpoint.0).ok_or(UnknownCheckpoint)
    }
}

/// # Checkpoints
impl Mesh {
    /// Marks this state of the mesh, to come back to with [`restore`](Self::restore). O(1).
    ///
    /// From now on, and until [`forget_checkpoints`](Self::forget_checkpoints), every edit also notes what it
    /// overwrites: 12 bytes a link, 36 a moved vertex, and every value of user data that it changes. In triangles that is
    /// about 210 bytes a flip, 530 a split with its faces and 310 a collapse; the lists they are noted in grow by doubling.
    /// Nothing is copied when the checkpoint is made, so one for each step of an editor is fine. Slots of removed elements
    /// are not reused while they can come back.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// let f = mesh.faces().next().unwrap();
    /// let before = mesh.checkpoint();
    /// mesh.remove_face(f)?;
    /// mesh.restore(before)?;
    /// assert!(mesh.contains_face(f));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn checkpoint(&mut self) -> Checkpoint {
        static NEXT: AtomicU64 = AtomicU64::new(1);
        let id = NEXT.fetch_add(1, Ordering::Relaxed);
        let changes = self.changes.as_ref().map(|c| c.told());
        let undo = self.undo.get_or_insert_default();
        undo.marks.push(Mark { id, words: undo.len(), changes });
        Checkpoint(id)
    }

    /// Puts the mesh back into the state of a checkpoint: every key that was valid then is valid again and means the same
    /// element, with the same position and data; keys of elements made since are dead. The checkpoint and all earlier
    /// ones stay valid, later ones do not. Columns that were added since stay, with what they hold for surviving elements;
    /// columns that were removed since stay removed.
    /// O(what was overwritten since).
    ///
    /// # Errors
    /// [`UnknownCheckpoint`].
    pub fn restore(&mut self, checkpoint: Checkpoint) -> Result<(), UnknownCheckpoint> {
        let Some(mut undo) = self.undo.take() else { return Err(UnknownCheckpoint) };
        let at = match undo.mark(checkpoint) {
            Ok(at) => at,
            Err(unknown) => {
                self.undo = Some(undo);
                return Err(unknown);
            }
        };
        undo.marks.truncate(at + 1);
        let mark = undo.marks[at];
        // What was told since is taken back in one word; what was changed before anybody listened is told piece by piece.
        let told_from = match &mut self.changes {
            Some(changes) => changes.take_back(mark.changes),
            None => 0,
        };
        let keep = (mark.words - undo.forgotten) as usize;
        while undo.words.len() > keep {
            let silent = undo.len() > told_from;
            if let Some(word) = undo.words.pop() {
                self.put_back(word, &mut undo.positions, silent);
            }
        }
        if let Some(changes) = &mut self.changes {
            changes.reached(mark.words);
        }
        self.undo = Some(undo);
        Ok(())
    }

    fn put_back(&mut self, Word { field, slot, old }: Word, positions: &mut Vec<DVec3>, silent: bool) {
        let i = slot as usize;
        let change = match field {
            Field::Next => return self.next[i] = old,
            Field::Prev => return self.prev[i] = old,
            Field::Origin => return self.origin[i] = old,
            Field::Face => return self.face[i] = old,
            Field::VertexHalfedge => return self.vertex_halfedge[i] = old,
            Field::FaceHalfedge => return self.face_halfedge[i] = old,
            Field::Value(kind) => {
                if let Some(column) = self.columns.get_mut(kind, old) {
                    column.recall(slot);
                }
                return;
            }
            Field::Position => {
                if let Some(position) = positions.pop() {
                    self.positions[i] = position;
                }
                Change::VertexMoved { vertex: self.vertices.key(slot) }
            }
            Field::VertexBorn => {
                let vertex = self.vertices.key(slot);
                self.vertices.remove(slot);
                Change::VertexDied { vertex, into: None }
            }
            Field::EdgeBorn => {
                let edge = self.edges.key(slot);
                self.edges.remove(slot);
                Change::EdgeDied { edge, into: None }
            }
            Field::FaceBorn => {
                let face = self.faces.key(slot);
                self.faces.remove(slot);
                Change::FaceDied { face, into: None }
            }
            Field::VertexDied => {
                self.vertices.reattach(slot, old);
                Change::VertexBorn { vertex: self.vertices.key(slot), from: Default::default() }
            }
            Field::EdgeDied => {
                self.edges.reattach(slot, old);
                Change::EdgeBorn { edge: self.edges.key(slot), from: None }
            }
            Field::FaceDied => {
                self.faces.reattach(slot, old);
                Change::FaceBorn { face: self.faces.key(slot), from: None }
            }
        };
        if !silent {
            self.tell(|_| change);
        }
    }

    /// Forgets all checkpoints: edits note nothing any more, and the slots of removed elements are free to be reused.
    /// O(what was noted).
    pub fn forget_checkpoints(&mut self) {
        if let Some(mut undo) = self.undo.take() {
            let all = undo.words.len();
            self.forget_words(&mut undo, all);
        }
    }

    /// Forgets all checkpoints older than this one, to bound the memory of an undo stack. O(what was noted).
    ///
    /// # Errors
    /// [`UnknownCheckpoint`].
    pub fn forget_checkpoints_before(&mut self, checkpoint: Checkpoint) -> Result<(), UnknownCheckpoint> {
        let Some(mut undo) = self.undo.take() else { return Err(UnknownCheckpoint) };
        let found = undo.mark(checkpoint);
        if let Ok(at) = found {
            undo.marks.drain(..at);
            let count = (undo.marks[0].words - undo.forgotten) as usize;
            self.forget_words(&mut undo, count);
        }
        self.undo = Some(undo);
        found.map(|_| ())
    }

    fn forget_words(&mut self, undo: &mut Undo, count: usize) {
        let mut moved = 0;
        let mut values: Vec<((Kind, u32), usize)> = Vec::new();
        for Word { field, slot, old } in undo.words.drain(..count) {
            match field {
                Field::Position => moved += 1,
                Field::Value(kind) => match values.iter_mut().find(|v| v.0 == (kind, old)) {
                    Some(found) => found.1 += 1,
                    None => values.push(((kind, old), 1)),
                },
                Field::VertexDied => free(&mut self.vertices, slot, old),
                Field::EdgeDied => free(&mut self.edges, slot, old),
                Field::FaceDied => free(&mut self.faces, slot, old),
                _ => {}
            }
        }
        undo.forgotten += count as u64;
        undo.positions.drain(..moved);
        for ((kind, index), count) in values {
            if let Some(column) = self.columns.get_mut(kind, index) {
                column.forget(count);
            }
        }
    }

    /// Bytes of heap memory that checkpoints hold, values of user data aside. O(1).
    pub fn checkpoint_bytes(&self) -> usize {
        self.undo.as_ref().map_or(0, |u| {
            u.words.capacity() * size_of::<Word>() + u.positions.capacity() * size_of::<DVec3>()
        })
    }
}

/// Lets a detached slot be reused.
fn free<K: Key>(arena: &mut crate::arena::Arena<K>, slot: u32, version: u32) {
    arena.reattach(slot, version);
    arena.remove(slot);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_noted_link_takes_twelve_bytes() {
        assert_eq!(size_of::<Word>(), 12);
    }

    /// Mean bytes noted for an operator at the inner edges of a triangle grid, one edge in eleven.
    fn noted(operator: impl Fn(&mut Mesh, crate::EdgeKey) -> bool) -> f64 {
        let n = 40;
        let points =
            (0..(n + 1) * (n + 1)).map(|i| DVec3::new(f64::from(i % (n + 1)), f64::from(i / (n + 1)), 0.0));
        let corner = |i: u32| i / n * (n + 1) + i % n;
        let cells = (0..n * n).map(corner).flat_map(|a| [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]);
        let triangles: Vec<[u32; 3]> = cells.collect();
        let pool = crate::IndexedMesh::from_triangles(points.collect(), &triangles).unwrap();
        let mut mesh = Mesh::build(&pool).unwrap();
        mesh.checkpoint();
        let edges: Vec<_> = mesh.edges().filter(|&e| !mesh.is_boundary_edge(e)).step_by(11).collect();
        let done = edges.into_iter().filter(|&e| mesh.contains_edge(e) && operator(&mut mesh, e)).count();
        assert!(done > 300);
        let undo = mesh.undo.as_ref().unwrap();
        (undo.words.len() * size_of::<Word>() + undo.positions.len() * size_of::<DVec3>()) as f64
            / done as f64
    }

    #[test]
    fn the_documentation_of_checkpoint_states_what_is_noted() {
        let flip = noted(|m, e| m.flip_edge(e).is_ok());
        let split = noted(|m, e| m.split_edge_and_faces(e, DVec3::ONE).is_ok());
        let collapse = noted(|m, e| m.collapse_into_target(m.edge_halfedge(e)).is_ok());
        let close = |bytes: f64, stated: f64| (bytes - stated).abs() < 0.1 * stated;
        let fits = close(flip, 210.0) && close(split, 530.0) && close(collapse, 310.0);
        assert!(fits, "flip {flip:.0}, split {split:.0}, collapse {collapse:.0}");
    }
}
