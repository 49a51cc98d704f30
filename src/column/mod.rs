//! User data on vertices, corners, edges and faces: dense columns that every operator keeps up to date.
//!
//! A column is made once with a [`Rule`] that says what becomes of its values when an element is split, merged or moved;
//! from then on every operator obeys it. Values are read and written through the typed key [`Column`], in O(1).
//!
//! **Corners** are the half-edges that have a face: the corner of `h` is that of `face(h)` at `origin(h)`. Two corners of
//! one vertex may hold different values: where they do, the edge between them is a *seam*. Splitting, collapsing and
//! poking keep seams where they are; [`flip_edge`](Mesh::flip_edge), [`join_faces`](Mesh::join_faces) and
//! [`dissolve_vertex`](Mesh::dissolve_vertex) take edges away, so ask [`is_seam`](Mesh::is_seam) first where seams matter.
//!
//! A seam *ends* inside the surface where both sides of its last edge hold the same value at one end, and differ at the
//! other. Collapsing that edge makes both sides one at the vertex that is left, where the seam ends then; so a seam of
//! which the edge's other end was the only vertex with two values is gone. Where a collapse takes the last triangle
//! between two seams, they become one edge, which is a seam if the values beyond them differ.
//!
//! Columns of **directions** say so by their rule: [`Rule::normals`], [`Rule::tangents`], or any other rule and how its
//! values [turn](Rule::turning). [`rotate_degrees`](Mesh::rotate_degrees), the scalings and affine maps turn the values of
//! all elements, [`reverse`](Mesh::reverse) and [`reverse_component`](Mesh::reverse_component) those of what is flipped;
//! defaults stay as they are. Moving vertices one by one, [`deform`](Mesh::deform) and [`smooth`](Mesh::smooth) turn
//! nothing, and a [`weld`](Mesh::weld) that has to turn a face leaves it what it holds.
//!
//! A mesh without columns pays one comparison for each element that an operator makes or merges.

mod derive;
mod rule;
mod store;
mod turn;

pub(crate) use derive::{Origin, Walk};
pub use rule::{Event, Interpolate, Rule};
pub(crate) use store::{Columns, Dense, Kind, Store};
pub use turn::{Direction, Turning};

use crate::mesh::dead;
use crate::{EdgeKey, FaceKey, HalfedgeKey, Mesh, VertexKey};
use std::fmt;
use std::marker::PhantomData;

/// What a column can hold. Equality tells seams.
pub trait Value: Clone + PartialEq + Send + Sync + 'static {}

impl<T: Clone + PartialEq + Send + Sync + 'static> Value for T {}

/// A kind of element that columns lie on: [`VertexKey`], [`HalfedgeKey`] (corners), [`EdgeKey`] or [`FaceKey`].
pub trait ElementKey: Copy + fmt::Debug + Sealed {}

impl<K: Copy + fmt::Debug + Sealed> ElementKey for K {}

pub(crate) use sealed::Sealed;

mod sealed {
    /// What the crate knows of an element kind.
    pub trait Sealed: Sized {
        /// Where its columns are kept.
        const KIND: super::Kind;
        /// The slot of a live key that can hold a value.
        fn slot(self, mesh: &super::Mesh) -> Option<u32>;
    }
}

impl Sealed for VertexKey {
    const KIND: Kind = Kind::Vertex;
    fn slot(self, mesh: &Mesh) -> Option<u32> {
        mesh.vertex_slot(self)
    }
}

impl Sealed for HalfedgeKey {
    const KIND: Kind = Kind::Corner;
    fn slot(self, mesh: &Mesh) -> Option<u32> {
        mesh.halfedge_slot(self)
    }
}

impl Sealed for EdgeKey {
    const KIND: Kind = Kind::Edge;
    fn slot(self, mesh: &Mesh) -> Option<u32> {
        mesh.edge_slot(self)
    }
}

impl Sealed for FaceKey {
    const KIND: Kind = Kind::Face;
    fn slot(self, mesh: &Mesh) -> Option<u32> {
        mesh.face_slot(self)
    }
}

/// The typed key of a column of `T` on elements with keys `K`. Valid on the mesh that made it and on its clones, until
/// the column is removed; keys of another mesh are not detected unless the types differ, but none writes to attributes.
pub struct Column<K, T> {
    pub(crate) index: u32,
    of: PhantomData<fn() -> (K, T)>,
}

impl<K, T> Column<K, T> {
    pub(crate) fn new(index: u32) -> Self {
        Self { index, of: PhantomData }
    }
}

impl<K, T> Clone for Column<K, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<K, T> Copy for Column<K, T> {}

impl<K, T> PartialEq for Column<K, T> {
    fn eq(&self, other: &Self) -> bool {
        self.index == other.index
    }
}

impl<K, T> Eq for Column<K, T> {}

impl<K, T> fmt::Debug for Column<K, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Column({})", self.index)
    }
}

/// Why a value was not written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ColumnError {
    /// The mesh has no such column.
    #[error("the mesh has no such column")]
    NoColumn,
    /// The key names no live element.
    #[error("the element is not in the mesh")]
    Missing,
    /// The half-edge has no face, so there is no corner.
    #[error("{0:?} is a boundary half-edge: it has no corner")]
    NoCorner(HalfedgeKey),
    /// Another number of values than elements.
    #[error("{values} values for {elements} elements")]
    Count {
        /// The values given.
        values: usize,
        /// The elements of the mesh.
        elements: usize,
    },
}

/// All values of a column in the order of [`Mesh::to_indexed`]: vertices and faces as there, corners as in
/// [`Polygons::corners`](crate::Polygons::corners), edges in the order in which corners first use them. Serialises where
/// `T` does; [`Mesh::import_column`] puts it on the mesh that is built from the same pool.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ColumnValues<T> {
    /// What new elements hold.
    pub default: T,
    /// One for each element.
    pub values: Vec<T>,
}

/// # User data
impl Mesh {
    /// Adds a column on vertices; each holds `default` to begin with. O(vertices).
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, Rule, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// let heat = mesh.add_vertex_column(0.0, Rule::interpolate());
    /// let h = mesh.halfedges().next().unwrap();
    /// mesh.set_value(heat, mesh.origin(h), 100.0)?;
    /// let new = mesh.split_edge(mesh.edge(h), DVec3::X * 0.25)?.vertex;
    /// assert_eq!(*mesh.value(heat, new), 75.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn add_vertex_column<T: Value>(&mut self, default: T, rule: Rule<T>) -> Column<VertexKey, T> {
        self.add_column(default, rule)
    }

    /// Adds a column on corners, keyed by the half-edge that starts at the corner; each holds `default` to begin with.
    /// O(half-edges).
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, Rule, glam::{DVec2, DVec3}};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// let uv = mesh.add_corner_column(DVec2::ZERO, Rule::interpolate());
    /// let f = mesh.faces().next().unwrap();
    /// for h in mesh.face_halfedges(f).collect::<Vec<_>>() {
    ///     mesh.set_value(uv, h, mesh.position(mesh.origin(h)).truncate())?;
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn add_corner_column<T: Value>(&mut self, default: T, rule: Rule<T>) -> Column<HalfedgeKey, T> {
        self.add_column(default, rule)
    }

    /// Adds a column on edges; each holds `default` to begin with. O(edges).
    pub fn add_edge_column<T: Value>(&mut self, default: T, rule: Rule<T>) -> Column<EdgeKey, T> {
        self.add_column(default, rule)
    }

    /// Adds a column on faces; each holds `default` to begin with. O(faces).
    pub fn add_face_column<T: Value>(&mut self, default: T, rule: Rule<T>) -> Column<FaceKey, T> {
        self.add_column(default, rule)
    }

    /// Adds a column on the elements that keys `K` name: what the four named forms do, for generic code.
    pub fn add_column<K: ElementKey, T: Value>(&mut self, default: T, rule: Rule<T>) -> Column<K, T> {
        let slots = self.slots_of(K::KIND);
        Column::new(self.columns.add(K::KIND, Store::new(slots, default, rule)))
    }

    /// Removes a column and its values. Whether there was one.
    pub fn remove_column<K: ElementKey, T: Value>(&mut self, column: Column<K, T>) -> bool {
        !self.carried.holds(K::KIND, column.index)
            && self.has_column(column)
            && self.columns.remove(K::KIND, column.index)
    }

    /// Whether the mesh has the column.
    pub fn has_column<K: ElementKey, T: Value>(&self, column: Column<K, T>) -> bool {
        self.columns.store::<T>(K::KIND, column.index).is_some()
    }

    /// The value of an element. A boundary half-edge, which has no corner, holds the default.
    ///
    /// # Panics
    /// On a dead key, and on a column that was removed; [`get_value`](Self::get_value) does not.
    #[track_caller]
    pub fn value<K: ElementKey, T: Value>(&self, column: Column<K, T>, key: K) -> &T {
        match self.get_value(column, key) {
            Some(value) => value,
            None if self.has_column(column) => dead(&key),
            None => dead(&column),
        }
    }

    /// [`value`](Self::value), or `None` on a dead key or a column that was removed.
    pub fn get_value<K: ElementKey, T: Value>(&self, column: Column<K, T>, key: K) -> Option<&T> {
        let slot = key.slot(self)?;
        self.columns.store::<T>(K::KIND, column.index)?.get(slot)
    }

    /// Sets the value of an element, and returns the one it had.
    ///
    /// # Errors
    /// [`ColumnError`]; nothing has changed then.
    pub fn set_value<K: ElementKey, T: Value>(
        &mut self,
        column: Column<K, T>,
        key: K,
        value: T,
    ) -> Result<T, ColumnError> {
        let slot = key.slot(self).ok_or(ColumnError::Missing)?;
        if K::KIND == Kind::Corner && self.face[slot as usize] == crate::matching::NONE {
            return Err(ColumnError::NoCorner(self.halfedge_key(slot)));
        }
        if self.carried.holds(K::KIND, column.index) {
            return Err(ColumnError::NoColumn);
        }
        self.write_value(K::KIND, column.index, slot, value).ok_or(ColumnError::NoColumn)
    }

    /// Overwrites a value of a live element, noted for checkpoints.
    pub(crate) fn write_value<T: Value>(
        &mut self,
        kind: Kind,
        column: u32,
        slot: u32,
        value: T,
    ) -> Option<T> {
        let store = self.columns.store_mut::<T>(kind, column)?;
        if let Some(undo) = &mut self.undo {
            undo.value(kind, column, slot);
            store.remember(slot);
        }
        store.replace(slot, value)
    }

    /// Whether the values of a corner column differ across an edge, at either of its ends. `false` on the boundary, on a
    /// dead key and on a column that was removed.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, Rule, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2], [2, 1, 3]])?)?;
    /// let chart = mesh.add_corner_column(0, Rule::keep());
    /// let f = mesh.faces().next().unwrap();
    /// for h in mesh.face_halfedges(f).collect::<Vec<_>>() {
    ///     mesh.set_value(chart, h, 1)?;
    /// }
    /// assert_eq!(mesh.edges().filter(|&e| mesh.is_seam(chart, e)).count(), 1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn is_seam<T: Value>(&self, column: Column<HalfedgeKey, T>, e: EdgeKey) -> bool {
        let store = self.columns.store::<T>(Kind::Corner, column.index);
        let (Some(store), Some(e)) = (store, self.edge_slot(e)) else { return false };
        self.is_seam_in(store, e)
    }

    pub(crate) fn is_seam_in<T: Value>(&self, store: &Store<T>, e: u32) -> bool {
        let (h, t) = (2 * e, 2 * e + 1);
        let inner = [h, t].iter().all(|&h| self.face[h as usize] != crate::matching::NONE);
        inner
            && (store.get(h) != store.get(self.next[t as usize])
                || store.get(t) != store.get(self.next[h as usize]))
    }

    /// The values of a column, in the order described at [`ColumnValues`]. O(slots).
    ///
    /// # Errors
    /// [`ColumnError::NoColumn`].
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{FaceKey, IndexedMesh, Mesh, Rule, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// let part = mesh.add_face_column(7, Rule::keep());
    /// let saved = mesh.export_column(part)?;
    /// let mut again = Mesh::build(&mesh.to_indexed())?;
    /// let part = again.import_column::<FaceKey, _>(saved, Rule::keep())?;
    /// assert!(again.faces().all(|f| *again.value(part, f) == 7));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn export_column<K: ElementKey, T: Value>(
        &self,
        column: Column<K, T>,
    ) -> Result<ColumnValues<T>, ColumnError> {
        let store = self.columns.store::<T>(K::KIND, column.index).ok_or(ColumnError::NoColumn)?;
        let values = self.ordered_slots(K::KIND).into_iter().filter_map(|slot| store.get(slot).cloned());
        Ok(ColumnValues { default: store.default_value().clone(), values: values.collect() })
    }

    /// Adds a column with given values, in the order described at [`ColumnValues`]. O(slots).
    ///
    /// # Errors
    /// [`ColumnError::Count`] when there is not one value for each element; nothing has changed then.
    pub fn import_column<K: ElementKey, T: Value>(
        &mut self,
        values: ColumnValues<T>,
        rule: Rule<T>,
    ) -> Result<Column<K, T>, ColumnError> {
        let order = self.ordered_slots(K::KIND);
        if order.len() != values.values.len() {
            return Err(ColumnError::Count { values: values.values.len(), elements: order.len() });
        }
        let mut store = Store::new(self.slots_of(K::KIND), values.default, rule);
        for (slot, value) in order.into_iter().zip(values.values) {
            store.replace(slot, value);
        }
        Ok(Column::new(self.columns.add(K::KIND, store)))
    }

    /// The length of the columns on a kind of element.
    pub(crate) fn slots_of(&self, kind: Kind) -> usize {
        match kind {
            Kind::Vertex => self.vertices.slot_count(),
            Kind::Corner => 2 * self.edges.slot_count(),
            Kind::Edge => self.edges.slot_count(),
            Kind::Face => self.faces.slot_count(),
        }
    }

    /// Turns the directions that columns hold on elements of a kind, noted for checkpoints. `slots` tells which elements,
    /// if there are such columns.
    pub(crate) fn turn_values(&mut self, kind: Kind, by: &Turning, slots: impl FnOnce(&Self) -> Vec<u32>) {
        if !self.columns.each(kind).any(|(_, column)| column.turns()) {
            return;
        }
        let slots = slots(self);
        for (i, column) in self.columns.on(kind).filter(|(_, column)| column.turns()) {
            for &slot in &slots {
                let is_new = column.turn(slot, by, self.undo.is_some());
                if let Some(undo) = self.undo.as_mut().filter(|_| is_new) {
                    undo.value(kind, i, slot);
                }
            }
        }
    }

    /// [`turn_values`](Self::turn_values) on all elements.
    pub(crate) fn turn_all_values(&mut self, by: &Turning) {
        for kind in Kind::ALL {
            self.turn_values(kind, by, |mesh| match kind {
                Kind::Vertex => mesh.vertices.live().collect(),
                Kind::Edge => mesh.edges.live().collect(),
                Kind::Face => mesh.faces.live().collect(),
                Kind::Corner => {
                    let sides = mesh.edges.live().flat_map(|e| [2 * e, 2 * e + 1]);
                    sides.filter(|&h| mesh.face[h as usize] != crate::matching::NONE).collect()
                }
            });
        }
    }

    /// The slots of a kind of element in the order of the indexed form.
    pub(crate) fn ordered_slots(&self, kind: Kind) -> Vec<u32> {
        let corners = || {
            let faces = self.faces.in_user_order();
            faces.into_iter().flat_map(|f| self.loop_slots(self.face_halfedge[f as usize]))
        };
        match kind {
            Kind::Vertex => self.vertices.in_user_order(),
            Kind::Face => self.faces.in_user_order(),
            Kind::Corner => corners().collect(),
            Kind::Edge => {
                let mut seen = vec![false; self.edges.slot_count()];
                corners()
                    .map(|h| h >> 1)
                    .filter(|&e| !std::mem::replace(&mut seen[e as usize], true))
                    .collect()
            }
        }
    }
}
