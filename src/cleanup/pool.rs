//! The first half of clean-up: from a soup to a valid vertex pool that remembers where everything came from.

use super::carry::{Carried, carry};
use super::polygons::{PolygonRepair, Repair};
use super::tolerance::{ProposedTolerance, propose};
use super::weld::Welded;
use super::{CleanError, Sources, Weld};
use crate::attributes::Attributes;
use crate::geometry::distance;
use crate::matching::NONE;
use crate::report::{Element, Kind, Maps, Record, Relation, Report, Step, StepSummary};
use crate::{Cancelled, Control, IndexedMesh, MAX_ELEMENTS, PolygonSoup, Polygons};
use glam::DVec3;

/// A valid vertex pool on its way to a mesh, with its origins in the soup.
pub(super) struct Pool<'s> {
    pub(super) soup: &'s PolygonSoup,
    pub(super) positions: Vec<DVec3>,
    pub(super) polygons: Polygons,
    /// Whether all faces are as they were, and the sources of faces and corners are not [listed](Self::list) yet.
    unlisted: bool,
    /// For each face the soup's face it was made of.
    pub(super) face_source: Vec<u32>,
    /// For each corner the soup's corner it was; from the number of the soup's corners on, one of `blends`.
    pub(super) corner_source: Vec<u32>,
    /// Corners that were put into edges.
    pub(super) blends: Vec<Blend>,
    /// For each vertex the lowest of the soup's vertices in it: ascending.
    pub(super) vertex_source: Vec<u32>,
    /// For each of the soup's vertices the vertex it is in, or [`NONE`] if it was dropped.
    pub(super) vertex_of: Vec<u32>,
    /// Whether each face was reversed; empty if none was.
    pub(super) flipped: Vec<bool>,
    /// The last vertices are in the middle between these: edges that were parted.
    pub(super) parted: Vec<[u32; 2]>,
    /// The ends of edges that were cut because the surface cannot be oriented.
    pub(super) cut: Vec<u32>,
    /// The corners at those vertices, ascending.
    pub(super) middles: Vec<u32>,
    pub(super) report: Report,
    /// The tolerance of the weld; `None` if there was none.
    pub(super) tolerance: Option<f64>,
    /// The soup's vertices that stood where they stand in the soup until they were stitched: ascending.
    pub(super) stitched: Vec<u32>,
    /// What was proposed, if the tolerance was.
    pub(super) proposed: Option<ProposedTolerance>,
    /// Faces that were dropped or changed because they named a vertex twice.
    pub(super) degenerate_faces: usize,
}

/// A corner that was put into an edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Blend {
    /// The soup's vertex that it names.
    pub(super) vertex: u32,
    /// The sources of the corners at the ends of the edge.
    pub(super) ends: [u32; 2],
    /// How far it is from the first to the second.
    pub(super) at: f64,
}

/// Why a face of the soup does not enter the pool.
pub(super) fn invalid(soup: &PolygonSoup, face: &[u32]) -> Option<Kind> {
    let at = |v: &u32| soup.positions.get(*v as usize);
    if face.iter().any(|v| at(v).is_none()) {
        Some(Kind::OutOfRangeFace)
    } else if face.iter().any(|v| at(v).is_some_and(|p| !p.is_finite())) {
        Some(Kind::NonFiniteFace)
    } else if face.len() < 3 {
        Some(Kind::ShortFace)
    } else {
        None
    }
}

impl<'s> Pool<'s> {
    /// Drops what is invalid, welds, repairs polygons.
    pub(super) fn new(
        soup: &'s PolygonSoup,
        how: Weld,
        control: &mut Control<'_>,
    ) -> Result<Self, CleanError> {
        let mut pool = Self::unlisted(soup, how, control)?;
        pool.list();
        Ok(pool)
    }

    /// The same, perhaps without the sources of faces and corners: enough to be accounted for, if there are no attributes.
    pub(super) fn unlisted(
        soup: &'s PolygonSoup,
        how: Weld,
        control: &mut Control<'_>,
    ) -> Result<Self, CleanError> {
        let elements = soup.positions.len().max(soup.polygons.len()).max(soup.polygons.corners().len());
        if elements > MAX_ELEMENTS {
            return Err(CleanError::TooLarge { elements });
        }
        let tolerance = match how {
            Weld::None => None,
            Weld::Exact => Some(0.0),
            Weld::Auto => {
                let exact = Self::new(soup, Weld::Exact, &mut control.part(0.0, 0.5))?;
                control.report("propose a tolerance", 0.2)?;
                let (proposed, merged) = propose(&exact, &mut control.part(0.2, 0.3))?;
                return match merged {
                    None => Ok(Self { proposed: Some(proposed), ..exact }),
                    Some(merged) => {
                        let named = |v: u32| {
                            if v == NONE { v } else { exact.vertex_source[merged[v as usize] as usize] }
                        };
                        let merged_into = exact.vertex_of.iter().map(|&v| named(v)).collect();
                        drop(exact);
                        let welded = Welded::numbered(&soup.positions, merged_into);
                        let pool = Self::welded(soup, welded, Some(proposed.tolerance), control)?;
                        Ok(Self { proposed: Some(proposed), ..pool })
                    }
                };
            }
            Weld::Within(t) => Some(t),
        };
        let welded = Welded::new(&soup.positions, tolerance, control)?;
        Self::welded(soup, welded, tolerance, control)
    }

    /// The pool of a soup with its vertices welded.
    fn welded(
        soup: &'s PolygonSoup,
        welded: Welded,
        tolerance: Option<f64>,
        control: &mut Control<'_>,
    ) -> Result<Self, CleanError> {
        let mut pool = Self {
            soup,
            positions: welded.positions,
            polygons: Polygons::new(),
            unlisted: false,
            face_source: Vec::new(),
            corner_source: Vec::new(),
            vertex_source: welded.sources,
            vertex_of: welded.of,
            flipped: Vec::new(),
            parted: Vec::new(),
            cut: Vec::new(),
            middles: Vec::new(),
            blends: Vec::new(),
            stitched: Vec::new(),
            report: Report::default(),
            tolerance,
            proposed: None,
            degenerate_faces: 0,
        };
        let dropped = pool.drop_vertices();
        let merged = soup.positions.len() - dropped - pool.positions.len();
        let repairs = pool.take_faces(dropped, control)?;
        let elements = pool.polygons.corners().len();
        if elements > MAX_ELEMENTS {
            // Cutting faces into triangles can triple their corners.
            return Err(CleanError::TooLarge { elements });
        }
        if pool.tolerance.is_some() {
            let weld = StepSummary::new(Step::Weld, merged);
            pool.report.steps.push(StepSummary { tolerance: pool.tolerance, ..weld });
        }
        pool.report.steps.push(StepSummary::new(Step::RepairPolygons, repairs.len()));
        pool.report.records.extend(repairs);
        Ok(pool)
    }

    /// Records the vertices that are not finite; returns how many there are.
    fn drop_vertices(&mut self) -> usize {
        let of = self.vertex_of.iter().zip(0..);
        let dropped: Vec<u32> = of.filter(|(of, _)| **of == NONE).map(|(_, v)| v).collect();
        for &v in &dropped {
            self.record(Step::DropInvalid, Kind::NonFiniteVertex, Element::Vertex(v), None);
        }
        dropped.len()
    }

    /// Takes over the valid faces and repairs them; returns the records of repairs.
    fn take_faces(
        &mut self,
        dropped_vertices: usize,
        control: &mut Control<'_>,
    ) -> Result<Vec<Record>, Cancelled> {
        let soup = self.soup;
        if self.take_intact() {
            self.report.steps.push(StepSummary::new(Step::DropInvalid, dropped_vertices));
            return Ok(Vec::new());
        }
        self.polygons = Polygons::with_capacity(soup.polygons.len(), soup.polygons.corners().len());
        self.face_source.reserve(soup.polygons.len());
        self.corner_source.reserve(soup.polygons.corners().len());
        let mut repairs = Vec::new();
        let mut repair = PolygonRepair::default();
        let (mut welded, mut pieces) = (Vec::new(), Polygons::new());
        let mut dropped = dropped_vertices;
        for (f, face) in soup.polygons.iter().enumerate() {
            let first = soup.polygons.starts()[f] as u32;
            if f.is_multiple_of(1 << 19) {
                control.report("repair faces", 0.3 + 0.1 * f as f64 / soup.polygons.len() as f64)?;
            }
            let element = Element::Face(f as u32);
            if let Some(kind) = invalid(soup, face) {
                dropped += 1;
                self.record(Step::DropInvalid, kind, element, self.middle(face));
                continue;
            }
            welded.clear();
            welded.extend(face.iter().map(|&v| self.vertex_of[v as usize]));
            pieces.clear();
            let kind = match repair.repair(&welded, |v| self.positions[v as usize], &mut pieces) {
                Repair::Intact => None,
                Repair::Shortened => Some(Kind::RepeatedCorner),
                Repair::Divided => Some(Kind::PinchedFace),
                Repair::Gone => Some(Kind::DegenerateFace),
            };
            if let Some(kind) = kind {
                self.degenerate_faces += 1;
                repairs.push(Record::new(Step::RepairPolygons, kind, element, self.middle(face)));
            }
            for piece in pieces.iter() {
                self.polygons.push(piece.iter().map(|&i| welded[i as usize]));
                self.corner_source.extend(piece.iter().map(|&i| first + i));
                self.face_source.push(f as u32);
            }
        }
        self.report.steps.push(StepSummary::new(Step::DropInvalid, dropped));
        Ok(repairs)
    }

    /// Takes over the faces as they are, if all are triangles and none needs repair: nearly all soups. Says whether it did.
    fn take_intact(&mut self) -> bool {
        let faces = &self.soup.polygons;
        let corners = faces.corners();
        if corners.len() != 3 * faces.len() || faces.iter().any(|f| f.len() != 3) {
            return false;
        }
        let mut welded = Vec::with_capacity(corners.len());
        let of = |v: u32| self.vertex_of.get(v as usize).copied().unwrap_or(NONE);
        for face in corners.chunks_exact(3) {
            let [a, b, c] = [of(face[0]), of(face[1]), of(face[2])];
            if a.max(b).max(c) == NONE || a == b || b == c || c == a {
                return false;
            }
            welded.extend([a, b, c]);
        }
        self.polygons = Polygons::with_starts(faces.starts().to_vec(), welded);
        self.unlisted = true;
        true
    }

    /// Writes down where faces and corners come from.
    fn list(&mut self) {
        if std::mem::take(&mut self.unlisted) {
            self.corner_source = (0..self.polygons.corners().len() as u32).collect();
            self.face_source = (0..self.polygons.len() as u32).collect();
        }
    }

    pub(super) fn record(&mut self, step: Step, kind: Kind, element: Element, place: Option<DVec3>) {
        self.report.records.push(Record::new(step, kind, element, place));
    }

    /// The mean of a soup face's finite corners.
    pub(super) fn middle(&self, face: &[u32]) -> Option<DVec3> {
        let finite =
            || face.iter().filter_map(|&v| self.soup.positions.get(v as usize)).filter(|p| p.is_finite());
        let count = finite().count() as f64;
        (count > 0.0).then(|| finite().map(|p| p / count).sum())
    }

    /// The soup's vertex for a vertex of the pool, as records name it.
    pub(super) fn named(&self, v: u32) -> u32 {
        self.vertex_source[v as usize]
    }

    /// The soup's vertex that a corner of the pool named there.
    pub(super) fn named_at(&self, corner: usize) -> u32 {
        let (source, corners) = (self.corner_source[corner] as usize, self.soup.polygons.corners());
        corners.get(source).copied().unwrap_or_else(|| self.blends[source - corners.len()].vertex)
    }

    /// Removes faces.
    pub(super) fn remove_faces(&mut self, gone: &[bool]) {
        let kept = || (0..gone.len()).filter(|&f| !gone[f]);
        let mut polygons = Polygons::with_capacity(gone.len(), self.corner_source.len());
        let mut sources = Vec::with_capacity(self.corner_source.len());
        for f in kept() {
            polygons.push(self.polygons[f].iter().copied());
            sources.extend_from_slice(
                &self.corner_source[self.polygons.starts()[f]..self.polygons.starts()[f + 1]],
            );
        }
        self.face_source = kept().map(|f| self.face_source[f]).collect();
        self.polygons = polygons;
        self.corner_source = sources;
    }

    /// The relation of the soup's faces to the pool's.
    pub(super) fn face_relation(&self) -> Relation {
        let count = self.soup.polygons.len();
        let all_stay = || self.face_source.iter().zip(0..).all(|(&old, new)| old == new);
        if self.unlisted || self.face_source.len() == count && all_stay() {
            return Relation::identity(count);
        }
        Relation::from_parents(count, self.face_source.clone())
    }

    /// Records the merges that moved a corner, in front of all records of later steps. `ended` gives the positions at
    /// which the soup's vertices ended.
    pub(super) fn record_merges(&mut self, ended: impl Fn(u32) -> Option<DVec3>) {
        if !self.tolerance.is_some_and(|t| t > 0.0) && self.stitched.is_empty() {
            return;
        }
        let soup = self.soup;
        let merges = || {
            let vertices = soup.positions.iter().zip(0u32..).filter(|(p, _)| p.is_finite());
            vertices.filter_map(|(&p, v)| Some((v, p, ended(v).filter(|&q| q != p)?)))
        };
        let is_stitched = |v: u32| self.stitched.binary_search(&v).is_ok();
        let (mut welded, mut stitched, mut farthest) = (0, 0, 0.0f64);
        for (v, p, q) in merges() {
            if is_stitched(v) {
                stitched += 1;
            } else {
                welded += 1;
                farthest = farthest.max(distance(p, q));
            }
        }
        // In a soup there may be several for each face: they are written once, where they belong.
        let later = std::mem::take(&mut self.report.records);
        let mut records = Vec::with_capacity(later.len() + welded + stitched);
        let mut later = later.into_iter().peekable();
        for (step, wanted) in [(Step::Weld, false), (Step::Stitch, true)] {
            records.extend(std::iter::from_fn(|| later.next_if(|r| r.step < step)));
            let own = merges().filter(|m| is_stitched(m.0) == wanted);
            records.extend(
                own.map(|(v, p, _)| Record::new(step, Kind::MergedVertex, Element::Vertex(v), Some(p))),
            );
        }
        records.extend(later);
        self.report.records = records;
        for step in self.report.steps.iter_mut().filter(|s| s.step == Step::Weld) {
            step.moved = farthest;
        }
    }

    /// How far a stitch may move anything: the tolerance of the weld, or how far apart naked edges that belong together
    /// were found to lie, and at least the noise of single precision at the largest coordinate. `None` if no weld was
    /// asked for: then vertices at one place are meant to be apart.
    pub(super) fn reach(&self) -> Option<f64> {
        let tolerance = self.tolerance?;
        let largest = self.positions.iter().fold(0.0f64, |m, p| m.max(p.abs().max_element()));
        let noise = largest * 4.0 / f64::from(1 << 24);
        Some(self.proposed.map_or(tolerance, |p| p.reach.max(tolerance)).max(noise))
    }

    /// The soup's attributes on the vertices as they were welded.
    pub(super) fn carry_welded(&self) -> Carried {
        carry(self, |v| match self.vertex_of[v] {
            NONE => &[],
            _ => std::slice::from_ref(&self.vertex_of[v]),
        })
    }

    /// The pool as it stands, its positions and faces moved out.
    pub(super) fn lend(&mut self, attributes: Attributes) -> IndexedMesh {
        let (positions, polygons) = (std::mem::take(&mut self.positions), std::mem::take(&mut self.polygons));
        IndexedMesh::trusted(positions, polygons, None).carrying(attributes)
    }

    /// Takes positions and faces back.
    pub(super) fn take_back(&mut self, indexed: IndexedMesh) {
        (self.positions, self.polygons, _) = indexed.into_parts();
    }

    /// Where its elements come from, moved out but for vertices and faces, which the maps and names need.
    pub(super) fn sources(&mut self) -> Sources {
        Sources {
            vertices: self.vertex_source.clone(),
            corners: std::mem::take(&mut self.corner_source),
            faces: self.face_source.clone(),
            middles: std::mem::take(&mut self.middles),
        }
    }

    /// The account of a pool whose vertices stand as they were welded, at these positions.
    pub(super) fn account(&mut self, positions: &[DVec3]) -> (Report, Maps) {
        let of = std::mem::take(&mut self.vertex_of);
        self.record_merges(|v| positions.get(of[v as usize] as usize).copied());
        let vertices = Relation::from_targets(of, self.vertex_source.len());
        let maps = Maps { vertices, faces: self.face_relation() };
        (std::mem::take(&mut self.report), maps)
    }
}
