//! The only writer of links beside the builder: every write is noted for checkpoints, if there are any.

use super::Slots;
use super::changes::Change;
use super::undo::Field;
use crate::column::{Event, Kind};
use crate::matching::NONE;
use crate::{EdgeKey, FaceKey, Mesh, VertexKey};
use glam::DVec3;

/// Writes one entry of a column of links.
macro_rules! setter {
    ($(#[$doc:meta])* $name:ident, $column:ident, $field:ident) => {
        $(#[$doc])*
        #[inline]
        pub(super) fn $name(&mut self, slot: u32, to: u32) {
            let old = std::mem::replace(&mut self.$column[slot as usize], to);
            if let Some(undo) = &mut self.undo {
                undo.push(Field::$field, slot, old);
            }
        }
    };
}

/// A vertex of more edges than this is worth a way around.
pub(super) const HUB: usize = 32;

impl Mesh {
    setter! { write_next, next, Next }
    setter! { write_prev, prev, Prev }
    setter! { set_origin, origin, Origin }
    setter! { set_face, face, Face }
    setter! { set_vertex_halfedge, vertex_halfedge, VertexHalfedge }
    setter! { set_face_halfedge, face_halfedge, FaceHalfedge }

    /// Lets `n` follow `h`.
    #[inline]
    pub(super) fn link(&mut self, h: u32, n: u32) {
        self.write_next(h, n);
        self.write_prev(n, h);
    }

    /// Moves a vertex, and tells columns and listeners.
    pub(crate) fn write_position(&mut self, v: u32, position: DVec3) {
        let old = std::mem::replace(&mut self.positions[v as usize], position);
        if let Some(undo) = &mut self.undo {
            undo.position(v, old);
        }
        if !self.columns.none_on(Kind::Vertex) {
            for (i, column) in self.columns.on(Kind::Vertex).filter(|(_, c)| c.sees_moves()) {
                if let Some(undo) = &mut self.undo {
                    undo.value(Kind::Vertex, i, v);
                    column.remember(v);
                }
                column.mix(Event::Move, v, &[(v, 1.0)]);
            }
        }
        self.tell(|m| Change::VertexMoved { vertex: m.vertices.key(v) });
    }

    /// Makes an isolated vertex that lies between others, or nowhere.
    pub(super) fn new_vertex(&mut self, position: DVec3, from: &[(u32, f64)]) -> u32 {
        let v = self.vertices.insert();
        if v as usize == self.positions.len() {
            self.positions.push(position);
            self.vertex_halfedge.push(NONE);
        } else {
            self.positions[v as usize] = position;
            self.vertex_halfedge[v as usize] = NONE;
        }
        self.note(Field::VertexBorn, v);
        self.prepare(Kind::Vertex, v);
        self.mix_new(Kind::Vertex, v, from);
        self.tell(|m| Change::VertexBorn {
            vertex: m.vertices.key(v),
            from: from.iter().map(|s| m.vertices.key(s.0)).collect(),
        });
        v
    }

    /// Makes an edge between two vertices, without faces and links; returns the half-edge that starts at the first. Its
    /// data is that of `from`, if it is a part of that.
    pub(super) fn new_edge(&mut self, a: u32, b: u32, from: Option<u32>) -> u32 {
        let e = self.edges.insert();
        let h = 2 * e;
        if h as usize == self.next.len() {
            for column in [&mut self.next, &mut self.prev, &mut self.face] {
                column.extend([NONE, NONE]);
            }
            self.origin.extend([a, b]);
        } else {
            for (h, v) in [(h as usize, a), (h as usize + 1, b)] {
                (self.next[h], self.prev[h], self.face[h], self.origin[h]) = (NONE, NONE, NONE, v);
            }
        }
        self.note(Field::EdgeBorn, e);
        self.prepare(Kind::Edge, e);
        self.prepare(Kind::Corner, h);
        self.prepare(Kind::Corner, h + 1);
        if let Some(from) = from {
            self.mix_new(Kind::Edge, e, &[(from, 1.0)]);
        }
        self.tell(|m| Change::EdgeBorn { edge: m.edges.key(e), from: from.map(|e| m.edges.key(e)) });
        h
    }

    /// Makes a face with a first half-edge; its loop is the caller's to link. Its data is that of `from`, if it is a part
    /// of that.
    pub(super) fn new_face(&mut self, first: u32, from: Option<u32>) -> u32 {
        let f = self.faces.insert();
        if f as usize == self.face_halfedge.len() {
            self.face_halfedge.push(first);
        } else {
            self.face_halfedge[f as usize] = first;
        }
        self.note(Field::FaceBorn, f);
        self.prepare(Kind::Face, f);
        if let Some(from) = from {
            self.mix_new(Kind::Face, f, &[(from, 1.0)]);
        }
        self.tell(|m| Change::FaceBorn { face: m.faces.key(f), from: from.map(|f| m.faces.key(f)) });
        f
    }

    pub(super) fn drop_vertex(&mut self, v: u32, into: Option<u32>) -> VertexKey {
        let key = self.vertices.key(v);
        self.tell(|m| Change::VertexDied { vertex: key, into: into.map(|v| m.vertices.key(v)) });
        match &mut self.undo {
            Some(undo) => undo.push(Field::VertexDied, v, self.vertices.detach(v)),
            None => self.vertices.remove(v),
        }
        key
    }

    pub(super) fn drop_edge(&mut self, e: u32, into: Option<u32>) -> EdgeKey {
        let key = self.edges.key(e);
        self.tell(|m| Change::EdgeDied { edge: key, into: into.map(|e| m.edges.key(e)) });
        match &mut self.undo {
            Some(undo) => undo.push(Field::EdgeDied, e, self.edges.detach(e)),
            None => self.edges.remove(e),
        }
        key
    }

    pub(super) fn drop_face(&mut self, f: u32, into: Option<u32>) -> FaceKey {
        let key = self.faces.key(f);
        self.tell(|m| Change::FaceDied { face: key, into: into.map(|f| m.faces.key(f)) });
        match &mut self.undo {
            Some(undo) => undo.push(Field::FaceDied, f, self.faces.detach(f)),
            None => self.faces.remove(f),
        }
        key
    }

    fn note(&mut self, born: Field, slot: u32) {
        if let Some(undo) = &mut self.undo {
            undo.push(born, slot, 0);
        }
    }

    /// Gives a new slot the default in every column.
    fn prepare(&mut self, kind: Kind, slot: u32) {
        if self.columns.none_on(kind) {
            return;
        }
        for (_, column) in self.columns.on(kind) {
            if column.len() == slot as usize {
                column.grow();
            } else {
                column.reset(slot);
            }
        }
    }

    /// Fills a new slot from its sources; nothing to note, since it goes with its element.
    fn mix_new(&mut self, kind: Kind, slot: u32, from: &[(u32, f64)]) {
        if from.is_empty() || self.columns.none_on(kind) {
            return;
        }
        for (_, column) in self.columns.on(kind) {
            column.mix(Event::Split, slot, from);
        }
    }

    /// Gives an element the value that each column's rule makes of the sources.
    #[inline]
    pub(super) fn mix(&mut self, kind: Kind, event: Event, into: u32, from: &[(u32, f64)]) {
        if !self.columns.none_on(kind) {
            self.overwrite(kind, into, |column| column.mix(event, into, from));
        }
    }

    /// Gives a corner the values of another.
    #[inline]
    pub(super) fn copy_corner(&mut self, from: u32, into: u32) {
        if !self.columns.none_on(Kind::Corner) {
            self.overwrite(Kind::Corner, into, |column| column.copy(from, into));
        }
    }

    /// Moves the corner data around a face to the half-edge before, each.
    pub(super) fn rotate_corners(&mut self, first: u32) {
        if self.columns.none_on(Kind::Corner) {
            return;
        }
        let around: Slots = self.loop_slots(first).collect();
        for (i, column) in self.columns.on(Kind::Corner) {
            for pair in around.windows(2) {
                if let Some(undo) = &mut self.undo {
                    for &h in pair {
                        undo.value(Kind::Corner, i, h);
                        column.remember(h);
                    }
                }
                column.swap(pair[0], pair[1]);
            }
        }
    }

    /// Gives a half-edge that lost its face the default.
    pub(super) fn reset_corner(&mut self, h: u32) {
        if !self.columns.none_on(Kind::Corner) {
            self.overwrite(Kind::Corner, h, |column| column.reset(h));
        }
    }

    fn overwrite(&mut self, kind: Kind, slot: u32, write: impl Fn(&mut dyn crate::column::Dense)) {
        for (i, column) in self.columns.on(kind) {
            if let Some(undo) = &mut self.undo {
                undo.value(kind, i, slot);
                column.remember(slot);
            }
            write(column.as_mut());
        }
    }

    /// Outgoing half-edge slots of a vertex, gathered before links change.
    pub(crate) fn spokes(&self, v: u32) -> Slots {
        self.outgoing_slots(v).collect()
    }

    /// The half-edge slot from one vertex to another. O(the lower valence).
    #[inline]
    pub(crate) fn find_slot(&self, a: u32, b: u32) -> Option<u32> {
        let mut around = self.outgoing_slots(a);
        for _ in 0..HUB {
            let h = around.next()?;
            if self.target_slot(h) == b {
                return Some(h);
            }
        }
        // Around a hub the other end is asked in turns: one of the two knows soon.
        let mut back = self.outgoing_slots(b);
        loop {
            let h = around.next()?;
            if self.target_slot(h) == b {
                return Some(h);
            }
            let t = back.next()?;
            if self.target_slot(t) == a {
                return Some(t ^ 1);
            }
        }
    }

    #[inline]
    pub(crate) fn target_slot(&self, h: u32) -> u32 {
        self.origin[h as usize ^ 1]
    }

    #[inline]
    pub(crate) fn is_open(&self, h: u32) -> bool {
        self.face[h as usize] == NONE
    }

    pub(crate) fn is_triangle(&self, h: u32) -> bool {
        let next = self.next[h as usize];
        self.face[h as usize] != NONE && self.next[next as usize] == self.prev[h as usize]
    }

    pub(crate) fn is_open_vertex(&self, v: u32) -> bool {
        let h = self.vertex_halfedge[v as usize];
        h != NONE && self.is_open(h)
    }

    /// Whether the face of `h` has the same corners as all its neighbours together: one face across all its edges, of the
    /// same degree. Then the two close each other off (M17).
    pub(crate) fn is_closed_off(&self, loop_: impl Iterator<Item = u32> + Clone) -> Option<u32> {
        let mut across = loop_.clone().map(|h| self.face[h as usize ^ 1]);
        let other = across.next().filter(|&f| f != NONE)?;
        let same = across.all(|f| f == other)
            && loop_.count() == self.loop_slots(self.face_halfedge[other as usize]).count();
        same.then_some(other)
    }

    /// How far along the edge from `a` to `b` a position lies, from 0 to 1.
    pub(super) fn share_along(&self, a: u32, b: u32, position: DVec3) -> f64 {
        let (a, b) = (self.positions[a as usize], self.positions[b as usize]);
        let along = b - a;
        let share = (position - a).dot(along) / along.length_squared();
        // An edge without length, or beyond what squares can hold.
        if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.5 }
    }
}
