//! The columns of a mesh that is made of another.

use super::{Columns, Event, Kind, Store, Value};
use crate::Mesh;
use crate::matching::NONE;

/// What a value of the new mesh is made of: values of the old.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Origin<'s> {
    /// Of nothing: it is the default.
    Nothing,
    /// The element is an old one.
    Same(u32),
    /// An old vertex that stands elsewhere.
    Moved(u32),
    /// What the rule makes of these.
    Made(Event, &'s [(u32, f64)]),
    /// A part of what lies between these, unless the two of a pair differ, as they do across a seam; then of the others.
    Across {
        /// Corners on both sides of an edge, at each of its ends.
        pairs: [[u32; 2]; 2],
        /// Beyond the edge.
        beyond: &'s [(u32, f64)],
        /// On this side of it.
        here: &'s [(u32, f64)],
    },
}

/// Tells the origins of all new elements, in order.
pub(crate) type Walk<'w> = dyn Fn(&mut dyn FnMut(Origin<'_>)) + 'w;

impl<T: Value> Store<T> {
    pub(super) fn derived_store(&self, count: usize, walk: &Walk<'_>) -> Self {
        let at = |i: u32| &self.values[i as usize];
        let mut values = Vec::with_capacity(count);
        walk(&mut |origin| {
            values.push(match origin {
                Origin::Nothing => self.default.clone(),
                Origin::Same(i) => at(i).clone(),
                Origin::Moved(i) if self.rule.sees_moves() => self.mixed(Event::Move, &[(i, 1.0)]),
                Origin::Moved(i) => at(i).clone(),
                Origin::Made(event, sources) => self.mixed(event, sources),
                Origin::Across { pairs, beyond, here } => {
                    let is_seam = pairs.iter().any(|&[a, b]| at(a) != at(b));
                    self.mixed(Event::Split, if is_seam { here } else { beyond })
                }
            });
        });
        Self::of(values, self.default.clone(), self.rule.clone())
    }
}

impl Columns {
    /// The columns of a mesh in the order of its indexed form, under the same keys. `keep` tells which.
    pub(crate) fn in_order(mesh: &Mesh, keep: impl Fn(Kind, u32) -> bool) -> Self {
        let mut columns = Self::default();
        for kind in Kind::ALL.into_iter().filter(|&k| !mesh.columns.none_on(k)) {
            let slots = mesh.ordered_slots(kind);
            let walk: &Walk<'_> = &|emit| slots.iter().for_each(|&s| emit(Origin::Same(s)));
            let all = (0..).zip(&mesh.columns.kinds[kind as usize]);
            columns.kinds[kind as usize] = all
                .map(|(i, c)| c.as_ref().filter(|_| keep(kind, i)).map(|c| c.derived(slots.len(), walk)))
                .collect();
        }
        columns
    }

    /// Lets the columns on a kind of element be those of so many others.
    pub(crate) fn derive(&mut self, kind: Kind, count: usize, walk: &Walk<'_>) {
        self.kinds[kind as usize].iter_mut().flatten().for_each(|c| *c = c.derived(count, walk));
    }

    /// Brings columns that stand in some order to the slots that it names.
    pub(crate) fn place(&mut self, kind: Kind, slots: usize, order: impl Iterator<Item = u32>) {
        if self.none_on(kind) {
            return;
        }
        let mut at = vec![NONE; slots];
        for (i, slot) in (0..).zip(order) {
            at[slot as usize] = i;
        }
        let origin = |&i: &u32| if i == NONE { Origin::Nothing } else { Origin::Same(i) };
        self.derive(kind, slots, &|emit| at.iter().for_each(|i| emit(origin(i))));
    }
}

impl Mesh {
    /// The columns of the user, in the order of the indexed form, under the same keys.
    pub(crate) fn user_columns(&self) -> Columns {
        let attributes = self.carried.columns();
        Columns::in_order(self, |kind, index| !attributes.contains(&(kind, index)))
    }

    /// Takes over columns that stand in the order of the indexed form, under their keys; the attributes that this mesh
    /// carries get new ones behind.
    pub(crate) fn adopt_columns(&mut self, mut columns: Columns) {
        if Kind::ALL.into_iter().all(|kind| columns.none_on(kind)) {
            return;
        }
        for kind in Kind::ALL {
            if !columns.none_on(kind) {
                columns.place(kind, self.slots_of(kind), self.ordered_slots(kind).into_iter());
            }
            let first = columns.kinds[kind as usize].len() as u32;
            columns.kinds[kind as usize].append(&mut self.columns.kinds[kind as usize]);
            self.carried.renumber(kind, first);
        }
        self.columns = columns;
    }
}
