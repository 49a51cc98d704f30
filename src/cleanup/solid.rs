//! The steps that make a solid of a mesh, and how their accounts join that of the steps before.

use super::drop::{drop_debris, drop_isolated};
use super::fill::fill_holes_of;
use super::fins::drop_fins;
use super::intersections::find_intersections;
use super::open::{hopeless, name_open};
use super::outward::turn_outward;
use super::slivers::resolve_slivers;
use super::step::Parts;
use super::{CleanError, Control};
use crate::matching::NONE;
use crate::report::{Element, Maps, Outcome, Record, Relation, Report};
use crate::{
    Cancelled, FillHolesOptions, Mesh, SelfIntersectionOptions, SliverError, SliverObstacle, SliverOptions,
};
use std::collections::BTreeMap;

/// By what element of the soup a record names one of the mesh.
pub(crate) struct Names {
    vertex: Vec<u32>,
    /// [`NONE`] for a face that was made from nothing.
    face: Vec<u32>,
    /// For those faces a vertex.
    made: BTreeMap<u32, u32>,
}

/// A mesh on its way to a solid, with the account from the soup on.
pub(super) struct Stage {
    pub(super) mesh: Mesh,
    pub(super) report: Report,
    pub(super) maps: Maps,
    pub(super) names: Names,
    /// Whether the bound on the work at slivers was reached: once is enough.
    pub(super) is_spent: bool,
    /// Whether slivers were left when they were last looked for.
    pub(super) has_slivers: bool,
}

/// How often the steps that change faces are run.
const MOST_ROUNDS: i32 = 8;

/// How many pairs of faces that pass through each other are listed.
const MOST_LISTED: usize = 10_000;

/// So many pairs of faces, and some for each face, are held against each other: many times what files from life take.
const MOST_TESTS: usize = 1 << 20;

/// Runs the steps that make a solid.
pub(super) fn solidify(
    stage: &mut Stage,
    tolerance: f64,
    debris: Option<usize>,
    control: &mut Control<'_>,
) -> Result<(), CleanError> {
    // What one step does may leave work for one before it; seldom, and hardly ever twice. Turning changes in which order
    // corners are looked at.
    let mut is_as_built = true;
    for round in 0..MOST_ROUNDS {
        let share = 1.0 - 0.5f64.powi(round);
        let mut own = control.part(0.8 * share, 0.4 + 0.4 * share);
        let is_changed = stage.round(tolerance, debris, &mut own)?;
        is_as_built &= !is_changed;
        if is_changed && round + 1 < MOST_ROUNDS {
            continue;
        }
        own.report("turn outward", 1.0)?;
        let turned = turn_outward(&mut stage.mesh, own.part(1.0, 1.0))?;
        let is_turned = stage.join(turned).iter().any(|part| part.reversed);
        is_as_built &= !is_turned;
        let is_left = stage.has_slivers || !stage.mesh.is_closed();
        if !is_turned && (is_as_built || !is_left) {
            break;
        }
        // Of changes that are as good as each other, the first is made, and which is the first depends on how the mesh is
        // stored. What is left must be left by a second pass too, which sees the mesh as it is built from the result.
        stage.mesh = Mesh::build(&stage.mesh.to_indexed()).map_err(CleanError::Bug)?;
        is_as_built = true;
    }
    let max_tests = MOST_TESTS + 8 * stage.mesh.face_count();
    let hook = control.part(0.85, 0.97);
    let options = SelfIntersectionOptions { max_listed: MOST_LISTED, max_tests, control: hook };
    let found = find_intersections(&stage.mesh, options)?;
    stage.join(found);
    control.report("find open parts", 0.97)?;
    let open = name_open(&stage.mesh)?;
    stage.join(open);
    stage.report.records.sort_by_key(|r| r.step);
    Ok(())
}

impl Stage {
    /// Runs the steps that change faces, in order; whether a step did that may leave work for another.
    fn round(
        &mut self,
        tolerance: f64,
        debris: Option<usize>,
        control: &mut Control<'_>,
    ) -> Result<bool, CleanError> {
        control.report("drop fins", 0.0)?;
        let dropped = drop_fins(&mut self.mesh, tolerance)?;
        let mut is_changed = self.join(dropped) > 0;
        if !self.is_spent {
            is_changed |= self.resolve_slivers(control.part(0.1, 0.4))?;
        }
        if let Some(fewer_than) = debris {
            self.drop_debris(fewer_than);
        }
        if !self.mesh.is_closed() {
            is_changed |= self.fill_holes(control.part(0.4, 0.9))?;
        }
        control.report("drop isolated vertices", 0.9)?;
        let dropped = drop_isolated(&mut self.mesh);
        self.join(dropped);
        Ok(is_changed)
    }

    pub(super) fn drop_debris(&mut self, fewer_than: usize) {
        let dropped = drop_debris(&mut self.mesh, fewer_than);
        self.join(dropped);
    }

    fn resolve_slivers(&mut self, control: Control<'_>) -> Result<bool, CleanError> {
        let tolerance = self.mesh.propose_sliver_tolerance();
        let options = SliverOptions { tolerance, control };
        let resolved = resolve_slivers(&mut self.mesh, options).map_err(|error| match error {
            SliverError::BadTolerance(t) => CleanError::BadTolerance(t),
            SliverError::Cancelled(c) => CleanError::Cancelled(c),
        })?;
        let resolved = self.join(resolved);
        self.has_slivers = !resolved.left.is_empty();
        self.is_spent |= resolved.left.iter().any(|left| left.obstacle == SliverObstacle::Limit);
        Ok(!resolved.resolved.is_empty())
    }

    /// Fills the holes of parts that can become solids.
    fn fill_holes(&mut self, control: Control<'_>) -> Result<bool, CleanError> {
        let mesh = &mut self.mesh;
        let parts = Parts::of(mesh);
        let hopeless = hopeless(mesh, &parts)?;
        let triangles =
            mesh.faces.live().filter(|&f| mesh.is_triangle(mesh.face_halfedge[f as usize])).count();
        let polygon_tolerance = (2 * triangles < mesh.face_count()).then(|| mesh.propose_sliver_tolerance());
        let options = FillHolesOptions {
            max_area_ratio: f64::INFINITY,
            polygon_tolerance,
            control,
            ..Default::default()
        };
        // The options are fine, so this is the only reason.
        let filled = fill_holes_of(mesh, options, |f| hopeless[parts.of[f as usize] as usize].is_none())
            .map_err(|_| CleanError::Cancelled(Cancelled))?;
        Ok(!self.join(filled).filled.is_empty())
    }

    /// Takes a step's account over, in the soup's numbers.
    fn join<T>(&mut self, step: Outcome<T>) -> T {
        let Outcome { value, report, maps } = step;
        let records = report.records.into_iter().map(|r| Record { element: self.names.of(r.element), ..r });
        self.report.records.extend(records);
        report.steps.into_iter().for_each(|step| self.report.add_step(step));
        if !(maps.vertices.is_identity() && maps.faces.is_identity()) {
            self.names.follow(&maps, &self.mesh);
            // Each relation starts where the one before ended.
            if let Ok(all) = self.maps.then(&maps) {
                self.maps = all;
            }
        }
        value
    }
}

impl Names {
    pub(crate) fn new(vertex: Vec<u32>, face: Vec<u32>) -> Self {
        Self { vertex, face, made: BTreeMap::new() }
    }

    fn face(&self, f: u32) -> Element {
        match (self.face[f as usize], self.made.get(&f)) {
            (NONE, Some(&v)) => Element::Vertex(v),
            (f, _) => Element::Face(f),
        }
    }

    /// An element of the mesh in the soup's numbers; a face made from nothing is named by a vertex.
    pub(crate) fn of(&self, element: Element) -> Element {
        let vertex = |v: u32| self.vertex[v as usize];
        match element {
            Element::Vertex(v) => Element::Vertex(vertex(v)),
            Element::Face(f) => self.face(f),
            Element::Edge(ends) => {
                let [a, b] = ends.map(vertex);
                Element::Edge([a.min(b), a.max(b)])
            }
            Element::Corner([f, corner]) => match self.face(f) {
                Element::Face(f) => Element::Corner([f, corner]),
                other => other,
            },
            Element::Faces(pair) => match pair.map(|f| self.face(f)) {
                [Element::Face(a), Element::Face(b)] => Element::Faces([a.min(b), a.max(b)]),
                [Element::Face(f), _] | [_, Element::Face(f)] => Element::Face(f),
                [other, _] => other,
            },
            Element::VertexOnEdge([v, a, b]) => {
                let [a, b] = [a, b].map(vertex);
                Element::VertexOnEdge([vertex(v), a.min(b), a.max(b)])
            }
        }
    }

    /// The names after another clean-up, whose names are in these numbers; both without faces made from nothing.
    pub(crate) fn then(&self, next: &Self) -> Self {
        let named = |names: &[u32], by: &[u32]| by.iter().map(|&i| names[i as usize]).collect();
        Self::new(named(&self.vertex, &next.vertex), named(&self.face, &next.face))
    }

    /// The names after a step: of what several became, the lowest.
    fn follow(&mut self, maps: &Maps, mesh: &Mesh) {
        let lowest = |relation: &Relation, names: &[u32]| -> Vec<u32> {
            let name =
                |i: usize| relation.old_of(i).iter().map(|&old| names[old as usize]).min().unwrap_or(NONE);
            (0..relation.new_len()).map(name).collect()
        };
        self.vertex = lowest(&maps.vertices, &self.vertex);
        self.face = lowest(&maps.faces, &self.face);
        self.made.clear();
        if !self.face.contains(&NONE) {
            return;
        }
        let mut number = vec![NONE; mesh.vertices.slot_count()];
        (0..).zip(mesh.vertices.in_user_order()).for_each(|(i, v)| number[v as usize] = i);
        for (f, slot) in (0u32..).zip(mesh.faces.in_user_order()).filter(|f| self.face[f.0 as usize] == NONE)
        {
            let corners = mesh.loop_slots(mesh.face_halfedge[slot as usize]).map(|h| mesh.origin[h as usize]);
            let name = corners.map(|v| self.vertex[number[v as usize] as usize]).min();
            self.made.insert(f, name.unwrap_or(NONE));
        }
    }
}
