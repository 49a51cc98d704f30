//! The steps that make a solid of a mesh, and how their accounts join that of the steps before.

use super::drop::{drop_debris, drop_isolated};
use super::fins::drop_fins;
use super::open::name_open;
use super::outward::turn_outward;
use super::{CleanError, Control};
use crate::matching::NONE;
use crate::report::{Element, Maps, Outcome, Record, Relation, Report};
use crate::{FaceKey, Mesh};

/// By what element of the soup a record names one of the mesh; [`NONE`] for what was made from nothing.
pub(super) struct Names {
    pub(super) vertex: Vec<u32>,
    pub(super) face: Vec<u32>,
}

/// A mesh on its way to a solid, with the account from the soup on.
pub(super) struct Stage {
    pub(super) mesh: Mesh,
    pub(super) report: Report,
    pub(super) maps: Maps,
    pub(super) names: Names,
}

/// Runs the steps that make a solid. `cut` are the faces at edges that were cut because they cannot be oriented.
pub(super) fn solidify(
    stage: &mut Stage,
    cut: &[u32],
    tolerance: f64,
    debris: Option<usize>,
    control: &mut Control<'_>,
) -> Result<(), CleanError> {
    let order = stage.mesh.faces.in_user_order();
    let cut: Vec<FaceKey> = cut.iter().map(|&f| stage.mesh.faces.key(order[f as usize])).collect();
    drop(order);

    control.report("drop fins", 0.0)?;
    let dropped = drop_fins(&mut stage.mesh, tolerance)?;
    stage.join(dropped);
    if let Some(fewer_than) = debris {
        control.report("drop debris", 0.2)?;
        stage.drop_debris(fewer_than);
    }
    control.report("drop isolated vertices", 0.5)?;
    let dropped = drop_isolated(&mut stage.mesh);
    stage.join(dropped);
    let turned = turn_outward(&mut stage.mesh, control.part(0.6, 0.9))?;
    stage.join(turned);
    control.report("find open parts", 0.9)?;
    let open = name_open(&stage.mesh, &cut);
    stage.join(open);
    Ok(())
}

impl Stage {
    pub(super) fn drop_debris(&mut self, fewer_than: usize) {
        let dropped = drop_debris(&mut self.mesh, fewer_than);
        self.join(dropped);
    }

    /// Takes a step's account over, in the soup's numbers.
    fn join<T>(&mut self, step: Outcome<T>) -> T {
        let Outcome { value, report, maps } = step;
        let records = report.records.into_iter().map(|r| Record { element: self.names.of(r.element), ..r });
        self.report.records.extend(records);
        self.report.steps.extend(report.steps);
        if !(maps.vertices.is_identity() && maps.faces.is_identity()) {
            self.names.follow(&maps);
            // Each relation starts where the one before ended.
            if let Ok(all) = self.maps.then(&maps) {
                self.maps = all;
            }
        }
        value
    }
}

impl Names {
    /// An element of the mesh in the soup's numbers.
    fn of(&self, element: Element) -> Element {
        let face = |f: u32| self.face[f as usize];
        let vertex = |v: u32| self.vertex[v as usize];
        match element {
            Element::Vertex(v) => Element::Vertex(vertex(v)),
            Element::Face(f) => Element::Face(face(f)),
            Element::Edge(ends) => {
                let [a, b] = ends.map(vertex);
                Element::Edge([a.min(b), a.max(b)])
            }
            Element::Corner([f, corner]) => Element::Corner([face(f), corner]),
            Element::VertexOnEdge([v, a, b]) => {
                let [a, b] = [a, b].map(vertex);
                Element::VertexOnEdge([vertex(v), a.min(b), a.max(b)])
            }
            Element::Faces(pair) => {
                let [a, b] = pair.map(face);
                Element::Faces([a.min(b), a.max(b)])
            }
        }
    }

    /// The names after a step: of what several became, the lowest.
    fn follow(&mut self, maps: &Maps) {
        let lowest = |relation: &Relation, names: &[u32]| {
            let name =
                |i: usize| relation.old_of(i).iter().map(|&old| names[old as usize]).min().unwrap_or(NONE);
            (0..relation.new_len()).map(name).collect()
        };
        self.vertex = lowest(&maps.vertices, &self.vertex);
        self.face = lowest(&maps.faces, &self.face);
    }
}
