//! The one vocabulary for accounts of what an operation changed: [`Outcome`], [`Report`], [`Maps`].

mod kinds;
mod maps;

pub use kinds::{Attribute, Kind, LossReason, Step};
pub(crate) use maps::OldOf;
pub use maps::{MapMismatch, Maps, Relation};

use glam::DVec3;
use std::collections::BTreeMap;
use std::fmt;

/// What a lossy operation returns: the result, the account of what was changed, and the old <-> new relations.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Outcome<T> {
    /// The result.
    pub value: T,
    /// What was changed, element by element.
    pub report: Report,
    /// Which input vertices and faces became which output vertices and faces.
    pub maps: Maps,
}

/// An element of the input, in the input's own numbering.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Element {
    /// A vertex by its index.
    Vertex(u32),
    /// A face by its index.
    Face(u32),
    /// An edge by the two vertices it joins, the lower index first.
    Edge([u32; 2]),
    /// A corner by its face and its number in it, from 0.
    Corner([u32; 2]),
    /// Two faces by their indices, the lower first.
    Faces([u32; 2]),
    /// A vertex that lies on an edge: the vertex, then the two vertices that the edge joins, the lower index first.
    VertexOnEdge([u32; 3]),
}

impl fmt::Display for Element {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Vertex(v) => write!(f, "vertex {v}"),
            Self::Face(face) => write!(f, "face {face}"),
            Self::Edge([a, b]) => write!(f, "edge {a}-{b}"),
            Self::Corner([face, corner]) => write!(f, "corner {corner} of face {face}"),
            Self::VertexOnEdge([v, a, b]) => write!(f, "vertex {v} on edge {a}-{b}"),
            Self::Faces([a, b]) => write!(f, "faces {a} and {b}"),
        }
    }
}

/// A value of an attribute that was not carried, while others of it were.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LostValue {
    /// Of which attribute.
    pub attribute: Attribute,
    /// Why.
    pub reason: LossReason,
    /// Whose, in the input's numbering.
    pub element: Element,
}

/// How large something is that a record stands for, where it is more than the element named.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Extent {
    /// The edges around a hole, or the faces of a part.
    pub elements: usize,
    /// The area of what fills the hole, or of the part, in square units.
    pub area: f64,
}

/// One change, with its element in the input's numbering and its place.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Record {
    /// The step that acted.
    pub step: Step,
    /// What was found.
    pub kind: Kind,
    /// Where, in the input's numbering.
    pub element: Element,
    /// Where in space: the vertex, the edge's midpoint, the mean of the face's corners. `None` when not finite.
    pub place: Option<DVec3>,
    /// The size of a hole or a part. `None` for single elements.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub extent: Option<Extent>,
}

impl Record {
    /// A record of a single element.
    pub(crate) fn new(step: Step, kind: Kind, element: Element, place: Option<DVec3>) -> Self {
        Self { step, kind, element, place, extent: None }
    }

    /// A record of something larger than the element named.
    pub(crate) fn sized(self, elements: usize, area: f64) -> Self {
        Self { extent: Some(Extent { elements, area }), ..self }
    }
}

/// What one step did in all, recorded or not.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StepSummary {
    /// The step.
    pub step: Step,
    /// How many elements it changed; or found, if it only looks. An exact weld counts its merges here and keeps no record of them: it moves
    /// nothing, and [`Maps`] names every one.
    pub changed: usize,
    /// The tolerance it used, in the mesh's units, if it has one.
    pub tolerance: Option<f64>,
    /// How far it moved the surface, in the mesh's units: the farthest that one operation did. What was dropped or made new
    /// is told by records.
    #[cfg_attr(feature = "serde", serde(default))]
    pub moved: f64,
}

impl StepSummary {
    /// A step without a tolerance that moved nothing.
    pub(crate) fn new(step: Step, changed: usize) -> Self {
        Self { step, changed, tolerance: None, moved: 0.0 }
    }
}

/// A located, typed account. Empty means: nothing was changed but what [`Maps`] and exact welding tell. What happened to
/// attributes stands apart.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Report {
    /// The steps that ran, in order.
    pub steps: Vec<StepSummary>,
    /// The changes, in the order of the steps, and by element within a step.
    pub records: Vec<Record>,
    /// Data of the input that the result does not have.
    pub not_carried: Vec<Attribute>,
    /// Single values that the result does not have, by attribute, reason and element.
    #[cfg_attr(feature = "serde", serde(default))]
    pub lost_values: Vec<LostValue>,
}

impl Report {
    /// Whether there is no record.
    pub fn is_empty(&self) -> bool {
        self.records.is_empty()
    }

    /// Adds what a step did to what the same step did before.
    pub(crate) fn add_step(&mut self, step: StepSummary) {
        match self.steps.iter_mut().find(|s| s.step == step.step) {
            Some(all) => {
                all.changed += step.changed;
                all.moved = all.moved.max(step.moved);
            }
            None => self.steps.push(step),
        }
    }

    /// The number of records of one kind. Linear in the records.
    pub fn count(&self, kind: Kind) -> usize {
        self.records.iter().filter(|r| r.kind == kind).count()
    }

    /// The number of records of each kind that occurs.
    pub fn counts(&self) -> BTreeMap<Kind, usize> {
        let mut counts = BTreeMap::new();
        for record in &self.records {
            *counts.entry(record.kind).or_insert(0) += 1;
        }
        counts
    }
}
