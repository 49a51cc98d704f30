//! What steps on a mesh have in common: the numbers of elements before, parts, and the account after.

use crate::geometry::normals::double_area_vector;
use crate::geometry::unit_scale;
use crate::matching::NONE;
use crate::report::{Element, Kind, Maps, Outcome, Record, Relation, Report, Step, StepSummary};
use crate::{FaceKey, Mesh, Numbering};
use glam::DVec3;
use slotmap::Key;

/// The numbers that elements have before a step, by which it names them.
pub(super) struct Before {
    numbering: Numbering,
    /// By slot.
    vertex: Vec<u32>,
    face: Vec<u32>,
}

impl Before {
    pub(super) fn of(mesh: &Mesh) -> Self {
        let mut vertex = vec![NONE; mesh.vertices.slot_count()];
        let mut face = vec![NONE; mesh.faces.slot_count()];
        (0..).zip(mesh.vertices.in_user_order()).for_each(|(i, v)| vertex[v as usize] = i);
        (0..).zip(mesh.faces.in_user_order()).for_each(|(i, f)| face[f as usize] = i);
        Self { numbering: mesh.numbering(), vertex, face }
    }

    pub(super) fn numbering(&self) -> &Numbering {
        &self.numbering
    }

    /// The element that a key named, if it did.
    pub(super) fn face_of(&self, key: FaceKey) -> Option<Element> {
        let slot = key.data().as_ffi() as u32;
        let number = self.face.get(slot as usize).copied().filter(|&f| f != NONE)?;
        (self.numbering.faces[number as usize] == key).then_some(Element::Face(number))
    }

    pub(super) fn vertex(&self, slot: u32) -> Element {
        Element::Vertex(self.vertex[slot as usize])
    }

    pub(super) fn face(&self, slot: u32) -> Element {
        Element::Face(self.face[slot as usize])
    }

    /// The account of a step that only adds elements from nothing or removes some.
    pub(super) fn outcome<T>(
        &self,
        mesh: &Mesh,
        value: T,
        summary: StepSummary,
        mut records: Vec<Record>,
    ) -> Outcome<T> {
        records.sort_by_key(|r| r.element);
        let report = Report { steps: vec![summary], records, ..Report::default() };
        let after = mesh.numbering();
        let old =
            |at: Option<u32>, same: &dyn Fn(usize) -> bool| at.filter(|&i| i != NONE && same(i as usize));
        let vertices = (0..).zip(&after.vertices).filter_map(|(new, &key)| {
            let at = mesh.vertex_slot(key).and_then(|slot| self.vertex.get(slot as usize)).copied();
            Some((old(at, &|i| self.numbering.vertices[i] == key)?, new))
        });
        let faces = (0..).zip(&after.faces).filter_map(|(new, &key)| {
            let at = mesh.face_slot(key).and_then(|slot| self.face.get(slot as usize)).copied();
            Some((old(at, &|i| self.numbering.faces[i] == key)?, new))
        });
        let maps = Maps {
            vertices: Relation::from_pairs(self.numbering.vertices.len(), after.vertices.len(), vertices),
            faces: Relation::from_pairs(self.numbering.faces.len(), after.faces.len(), faces),
        };
        Outcome { value, report, maps }
    }
}

/// The account of a step that found nothing to do.
pub(super) fn unchanged<T>(mesh: &Mesh, value: T, step: Step) -> Outcome<T> {
    let report = Report { steps: vec![StepSummary::new(step, 0)], ..Report::default() };
    Outcome { value, report, maps: Maps::identity(mesh.vertex_count(), mesh.face_count()) }
}

/// The components of a mesh, with what steps ask of them.
pub(super) struct Parts {
    /// For each the slots of its faces; in the order of first faces.
    pub(super) faces: Vec<Vec<u32>>,
    /// By face slot the part.
    pub(super) of: Vec<u32>,
    /// Whether each has no boundary.
    pub(super) is_closed: Vec<bool>,
}

impl Parts {
    pub(super) fn of(mesh: &Mesh) -> Self {
        let components = mesh.components();
        let faces: Vec<Vec<u32>> =
            components.iter().map(|c| c.iter().filter_map(|&f| mesh.face_slot(f)).collect()).collect();
        let mut of = vec![NONE; mesh.faces.slot_count()];
        let mut is_closed = vec![true; faces.len()];
        for (part, faces) in (0u32..).zip(&faces) {
            for &f in faces {
                of[f as usize] = part;
                let mut around = mesh.loop_slots(mesh.face_halfedge[f as usize]);
                is_closed[part as usize] &= around.all(|h| mesh.face[h as usize ^ 1] != NONE);
            }
        }
        Self { faces, of, is_closed }
    }

    pub(super) fn len(&self) -> usize {
        self.faces.len()
    }

    pub(super) fn open(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.len()).filter(|&part| !self.is_closed[part])
    }
}

/// Areas of faces, safe for any coordinates.
pub(super) struct Areas<'m> {
    mesh: &'m Mesh,
    scale: f64,
}

impl<'m> Areas<'m> {
    pub(super) fn of(mesh: &'m Mesh) -> Self {
        let used = mesh.vertices.live().map(|v| mesh.positions[v as usize]);
        Self { mesh, scale: unit_scale(used) }
    }

    /// The area vector within a loop of half-edges, scaled; its length is the least that any surface within has.
    pub(super) fn vector(&self, first: u32) -> DVec3 {
        let corners = self.mesh.loop_slots(first).map(|h| self.mesh.origin[h as usize]);
        double_area_vector(corners.map(|v| self.mesh.positions[v as usize] * self.scale)) * 0.5
    }

    /// The area of some faces, scaled: to be compared.
    pub(super) fn scaled(&self, faces: &[u32]) -> f64 {
        faces.iter().map(|&f| self.vector(self.mesh.face_halfedge[f as usize]).length()).sum()
    }

    /// A scaled area in square units.
    pub(super) fn plain(&self, scaled: f64) -> f64 {
        scaled / self.scale / self.scale
    }
}

/// The mean of a face's corners.
pub(super) fn middle(mesh: &Mesh, face: u32) -> DVec3 {
    let corners = || mesh.loop_slots(mesh.face_halfedge[face as usize]);
    let share = 1.0 / corners().count() as f64;
    corners().map(|h| mesh.positions[mesh.origin[h as usize] as usize] * share).sum()
}

/// A record for each of a part's faces.
pub(super) fn record_faces(
    mesh: &Mesh,
    before: &Before,
    faces: &[u32],
    (step, kind): (Step, Kind),
    records: &mut Vec<Record>,
) {
    records.extend(faces.iter().map(|&f| Record::new(step, kind, before.face(f), Some(middle(mesh, f)))));
}
