//! How columns are kept: dense, by slot, behind an object-safe face for the operators.

use super::rule::How;
use super::{Event, Rule, Turning, Value, Walk};
use smallvec::SmallVec;
use std::any::Any;

/// The kinds of elements that columns lie on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Vertices.
    Vertex,
    /// Half-edges that have a face.
    Corner,
    /// Edges.
    Edge,
    /// Faces.
    Face,
}

impl Kind {
    pub(crate) const ALL: [Self; 4] = [Self::Vertex, Self::Corner, Self::Edge, Self::Face];
}

/// One column: a value for every slot, dead ones included (what they hold means nothing).
#[derive(Clone)]
pub(crate) struct Store<T> {
    pub(super) values: Vec<T>,
    pub(super) default: T,
    pub(super) rule: Rule<T>,
    /// Values that were overwritten since the first checkpoint, the last on top.
    old: Vec<T>,
}

impl<T: Value> Store<T> {
    pub(crate) fn new(slots: usize, default: T, rule: Rule<T>) -> Self {
        Self { values: vec![default.clone(); slots], default, rule, old: Vec::new() }
    }

    /// A column of given values, one for each slot.
    pub(crate) fn of(values: Vec<T>, default: T, rule: Rule<T>) -> Self {
        Self { values, default, rule, old: Vec::new() }
    }

    pub(crate) fn get(&self, slot: u32) -> Option<&T> {
        self.values.get(slot as usize)
    }

    pub(crate) fn default_value(&self) -> &T {
        &self.default
    }

    pub(crate) fn replace(&mut self, slot: u32, value: T) -> Option<T> {
        Some(std::mem::replace(self.values.get_mut(slot as usize)?, value))
    }

    pub(super) fn mixed(&self, event: Event, sources: &[(u32, f64)]) -> T {
        let at = |i: usize| &self.values[sources[i].0 as usize];
        match &self.rule.how {
            How::Reset => self.default.clone(),
            _ if sources.is_empty() => self.default.clone(),
            How::Keep => {
                let heaviest = (1..sources.len())
                    .fold(0, |best, i| if sources[i].1 > sources[best].1 { i } else { best });
                at(heaviest).clone()
            }
            How::Mix { mix, weighted, .. } => {
                let share = 1.0 / sources.len() as f64;
                let parts: SmallVec<[(&T, f64); 8]> = (0..sources.len())
                    .map(|i| (at(i), if *weighted { sources[i].1 } else { share }))
                    .collect();
                mix(&parts)
            }
            How::Custom(f) => {
                let parts: SmallVec<[(&T, f64); 8]> =
                    (0..sources.len()).map(|i| (at(i), sources[i].1)).collect();
                f(event, &parts)
            }
        }
    }
}

/// What operators do with a column without knowing its type. With `log`, a value that is overwritten is remembered.
pub(crate) trait Dense: Send + Sync {
    fn as_any(&self) -> &dyn Any;
    fn as_any_mut(&mut self) -> &mut dyn Any;
    fn boxed(&self) -> Box<dyn Dense>;
    fn len(&self) -> usize;
    fn bytes(&self) -> usize;
    /// Appends the default.
    fn grow(&mut self);
    /// Gives a slot the default.
    fn reset(&mut self, slot: u32);
    /// Gives a slot the value that the rule makes of the sources.
    fn mix(&mut self, event: Event, into: u32, sources: &[(u32, f64)]);
    /// A column of the same rule and default for the elements of another mesh.
    fn derived(&self, count: usize, walk: &Walk<'_>) -> Box<dyn Dense>;
    /// Gives a slot the value of another, whatever the rule.
    fn copy(&mut self, from: u32, into: u32);
    /// Exchanges two values.
    fn swap(&mut self, a: u32, b: u32);
    fn is_same(&self, a: u32, b: u32) -> bool;
    /// Whether the rule looks at moves.
    fn sees_moves(&self) -> bool;
    /// Whether the values are directions, which turn with space.
    fn turns(&self) -> bool;
    /// Turns a value; whether that changed it. What it was is put on top of the overwritten ones if it is to be remembered.
    fn turn(&mut self, slot: u32, by: &Turning, remember: bool) -> bool;
    /// Puts the value of a slot on top of the overwritten ones.
    fn remember(&mut self, slot: u32);
    /// Takes it back.
    fn recall(&mut self, slot: u32);
    /// Forgets the oldest overwritten values.
    fn forget(&mut self, count: usize);
}

impl<T: Value> Dense for Store<T> {
    fn as_any(&self) -> &dyn Any {
        self
    }

    fn as_any_mut(&mut self) -> &mut dyn Any {
        self
    }

    fn boxed(&self) -> Box<dyn Dense> {
        Box::new(self.clone())
    }

    fn len(&self) -> usize {
        self.values.len()
    }

    fn bytes(&self) -> usize {
        (self.values.capacity() + self.old.capacity()) * size_of::<T>()
    }

    fn grow(&mut self) {
        self.values.push(self.default.clone());
    }

    fn reset(&mut self, slot: u32) {
        self.values[slot as usize] = self.default.clone();
    }

    fn mix(&mut self, event: Event, into: u32, sources: &[(u32, f64)]) {
        self.values[into as usize] = self.mixed(event, sources);
    }

    fn derived(&self, count: usize, walk: &Walk<'_>) -> Box<dyn Dense> {
        Box::new(self.derived_store(count, walk))
    }

    fn copy(&mut self, from: u32, into: u32) {
        self.values[into as usize] = self.values[from as usize].clone();
    }

    fn swap(&mut self, a: u32, b: u32) {
        self.values.swap(a as usize, b as usize);
    }

    fn is_same(&self, a: u32, b: u32) -> bool {
        self.values[a as usize] == self.values[b as usize]
    }

    fn sees_moves(&self) -> bool {
        self.rule.sees_moves()
    }

    fn turns(&self) -> bool {
        self.rule.turn.is_some()
    }

    fn turn(&mut self, slot: u32, by: &Turning, remember: bool) -> bool {
        let (Some(turn), Some(value)) = (&self.rule.turn, self.values.get_mut(slot as usize)) else {
            return false;
        };
        let new = turn(value, by);
        let changes = new != *value;
        if changes {
            let old = std::mem::replace(value, new);
            if remember {
                self.old.push(old);
            }
        }
        changes
    }

    fn remember(&mut self, slot: u32) {
        self.old.push(self.values[slot as usize].clone());
    }

    fn recall(&mut self, slot: u32) {
        if let Some(value) = self.old.pop() {
            self.values[slot as usize] = value;
        }
    }

    fn forget(&mut self, count: usize) {
        self.old.drain(..count.min(self.old.len()));
    }
}

/// All columns of a mesh. A removed one leaves its place empty, so that no key ever means another column.
#[derive(Default)]
pub(crate) struct Columns {
    pub(super) kinds: [Vec<Option<Box<dyn Dense>>>; 4],
}

impl Clone for Columns {
    fn clone(&self) -> Self {
        let each =
            |kind: &Vec<Option<Box<dyn Dense>>>| kind.iter().map(|c| c.as_ref().map(|c| c.boxed())).collect();
        Self { kinds: self.kinds.each_ref().map(each) }
    }
}

impl Columns {
    pub(crate) fn add<T: Value>(&mut self, kind: Kind, store: Store<T>) -> u32 {
        let list = &mut self.kinds[kind as usize];
        list.push(Some(Box::new(store)));
        list.len() as u32 - 1
    }

    pub(crate) fn remove(&mut self, kind: Kind, index: u32) -> bool {
        self.kinds[kind as usize].get_mut(index as usize).is_some_and(|c| c.take().is_some())
    }

    pub(crate) fn store<T: Value>(&self, kind: Kind, index: u32) -> Option<&Store<T>> {
        self.kinds[kind as usize].get(index as usize)?.as_deref()?.as_any().downcast_ref()
    }

    pub(crate) fn store_mut<T: Value>(&mut self, kind: Kind, index: u32) -> Option<&mut Store<T>> {
        self.kinds[kind as usize].get_mut(index as usize)?.as_deref_mut()?.as_any_mut().downcast_mut()
    }

    /// The column of that place, whatever its type.
    pub(crate) fn get_mut(&mut self, kind: Kind, index: u32) -> Option<&mut dyn Dense> {
        match self.kinds[kind as usize].get_mut(index as usize)? {
            Some(column) => Some(column.as_mut()),
            None => None,
        }
    }

    /// Whether no column lies on this kind of element.
    #[inline]
    pub(crate) fn none_on(&self, kind: Kind) -> bool {
        self.kinds[kind as usize].is_empty()
    }

    /// The columns on a kind of element, with their places.
    pub(crate) fn on(&mut self, kind: Kind) -> impl Iterator<Item = (u32, &mut Box<dyn Dense>)> {
        (0..).zip(&mut self.kinds[kind as usize]).filter_map(|(i, c)| Some((i, c.as_mut()?)))
    }

    /// The columns on a kind of element, with their places, to be read.
    pub(crate) fn each(&self, kind: Kind) -> impl Iterator<Item = (u32, &dyn Dense)> {
        (0..).zip(&self.kinds[kind as usize]).filter_map(|(i, c)| Some((i, c.as_deref()?)))
    }

    /// Whether any column lies on anything.
    pub(crate) fn is_empty(&self) -> bool {
        self.kinds.iter().all(|kind| kind.iter().flatten().next().is_none())
    }

    /// Whether every column on a kind of element has this length.
    pub(crate) fn fit(&self, kind: Kind, len: usize) -> bool {
        self.kinds[kind as usize].iter().flatten().all(|c| c.len() == len)
    }

    pub(crate) fn bytes(&self) -> usize {
        self.kinds.iter().flatten().flatten().map(|c| c.bytes()).sum()
    }
}

impl std::fmt::Debug for Columns {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_list().entries(self.kinds.iter().map(|kind| kind.iter().flatten().count())).finish()
    }
}
