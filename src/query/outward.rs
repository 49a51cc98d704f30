//! Which parts of a surface to reverse so that solids face outward and cavities inward.

use super::bvh::{CUT, Tree};
use super::cast::{Cast, Meeting};
use super::contains::SKEW;
use crate::geometry::measure::Aabb;
use crate::geometry::normals::double_area_vector;
use crate::geometry::triangulate::Triangulator;
use crate::geometry::unit_scale;
use crate::matching::NONE;
use crate::report::{Outcome, Step};
use crate::topology::{Topology, with_flipped};
use crate::{Cancelled, Control, FaceKey, IndexedMesh, Mesh};
use glam::DVec3;

/// How to turn outward.
#[derive(Debug)]
pub struct OutwardOptions<'a> {
    /// An open part is turned only if its confidence reaches this, from 0 to 1; 0.5 by default.
    pub min_confidence: f64,
    /// The progress-and-cancel hook.
    pub control: Control<'a>,
}

impl Default for OutwardOptions<'_> {
    fn default() -> Self {
        Self { min_confidence: 0.5, control: Control::none() }
    }
}

/// Why a mesh was not turned outward; nothing has changed then.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OutwardError {
    /// The least confidence is not within 0 to 1.
    #[error("a confidence of {0} makes no sense")]
    BadConfidence(f64),
    /// The hook said stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// What was found about one part, faces joined across edges.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct OutwardPart<F> {
    /// Its first face.
    pub face: F,
    /// How many faces it has.
    pub faces: usize,
    /// Whether it has no boundary.
    pub closed: bool,
    /// In how many closed parts it lies. Where that is odd, it bounds a cavity and faces inward. 0 for open parts.
    pub depth: u32,
    /// Whether some of its vertices lie inside another closed part and some outside: then it is turned by itself, as if
    /// it lay in none. Looked for at up to 64 vertices. Also where so many parts lie within each other, or in one place, that
    /// this part was not asked: what all rays together meet is bounded.
    pub crosses: bool,
    /// How sure the direction is, from 0 to 1. For a closed part 1, or 0 if it encloses no more volume than rounding may
    /// make of none: then it stays as it is. For an open one twice the mean winding number on the surface, which is 1 for
    /// a closed one and 0 for a flat sheet.
    pub confidence: f64,
    /// Whether it was reversed.
    pub reversed: bool,
}

impl Mesh {
    /// Turns every part outward: reverses closed parts that are inside out, where a part that lies in an odd number of
    /// others bounds a cavity and faces inward. Open parts are turned if their direction is sure enough, and stay as they
    /// are if not.
    ///
    /// Depth is counted exactly, with the winding numbers of the other parts at vertices of the part. An open part is
    /// judged by the generalised winding number (Jacobson, Kavan and Sorkine-Hornung, "Robust Inside-Outside Segmentation
    /// using Generalized Winding Numbers", ACM Transactions on Graphics 32(4), 2013) at up to 256 of its faces.
    /// O(n log n), and for each open part its faces times the faces looked at. What rays meet is bounded, for files with very
    /// many parts in one place: see [`OutwardPart::crosses`].
    ///
    /// # Errors
    /// [`OutwardError`]; nothing has changed then.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, OutwardOptions, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    /// # let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &faces)?)?;
    /// mesh.reverse();
    /// let parts = mesh.orient_outward(OutwardOptions::default())?;
    /// assert!(parts[0].reversed && mesh.closed()?.volume() > 0.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn orient_outward(
        &mut self,
        options: OutwardOptions<'_>,
    ) -> Result<Vec<OutwardPart<FaceKey>>, OutwardError> {
        self.orient_parts_outward(options, true)
    }

    /// [`orient_outward`](Self::orient_outward), open parts too or closed ones only.
    pub(crate) fn orient_parts_outward(
        &mut self,
        options: OutwardOptions<'_>,
        open_too: bool,
    ) -> Result<Vec<OutwardPart<FaceKey>>, OutwardError> {
        let components = self.components();
        let mut part_of = vec![NONE; self.faces.slot_count()];
        let mut closed = Vec::with_capacity(components.len());
        for (part, faces) in (0..).zip(&components) {
            let slots = || faces.iter().filter_map(|&f| self.face_slot(f));
            slots().for_each(|f| part_of[f as usize] = part);
            let is_open = |h: u32| self.face[h as usize ^ 1] == NONE;
            let has_boundary = slots().any(|f| self.loop_slots(self.face_halfedge[f as usize]).any(is_open));
            closed.push(!has_boundary);
        }
        let mut triangles = Vec::with_capacity(self.face_count());
        let mut parts = Vec::with_capacity(self.face_count());
        self.for_each_cut_triangle(|f, t| {
            triangles.push(t);
            parts.push(part_of[f as usize]);
        });
        let verdicts = judge(&self.positions, &triangles, &parts, (&closed, open_too), options)?;
        let mut found = Vec::with_capacity(components.len());
        for (faces, verdict) in components.iter().zip(verdicts) {
            let face = faces[0];
            if verdict.reverse {
                // The face is the mesh's own.
                let _ = self.reverse_component(face);
            }
            found.push(verdict.part(face, faces.len()));
        }
        Ok(found)
    }
}

/// What [`orient_outward`] makes of a vertex pool.
#[derive(Clone, Debug)]
pub struct TurnedOutward {
    /// The pool with parts reversed; a record for each reversed face.
    pub outcome: Outcome<IndexedMesh>,
    /// What was found about each part, in the order of first faces.
    pub parts: Vec<OutwardPart<u32>>,
}

/// As [`Mesh::orient_outward`], on a vertex pool in any state. A part is what hangs together across edges; it counts as
/// closed if each of its edges has exactly two faces that are wound alike. Unify first: within a part, all faces are
/// reversed or none.
///
/// # Errors
/// As there.
///
/// # Examples
/// ```
/// use meshwright::{IndexedMesh, OutwardOptions, glam::DVec3, orient_outward};
/// let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let inside_out = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];
/// let pool = IndexedMesh::from_triangles(points, &inside_out)?;
/// let turned = orient_outward(&pool.topology(), OutwardOptions::default())?;
/// assert_eq!(turned.outcome.report.records.len(), 4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn orient_outward(
    topology: &Topology<'_>,
    options: OutwardOptions<'_>,
) -> Result<TurnedOutward, OutwardError> {
    let pool = topology.mesh();
    let (part_of, count) = topology.components();
    let mut closed = vec![true; count];
    let mut faces = vec![(NONE, 0); count];
    for (&part, f) in part_of.iter().zip(0..) {
        let entry = &mut faces[part as usize];
        *entry = (entry.0.min(f), entry.1 + 1);
    }
    let open =
        topology.boundary_edges().chain(topology.nonmanifold_edges()).chain(topology.conflicting_edges());
    for f in open.filter_map(|e| e.faces().next()) {
        closed[part_of[f as usize] as usize] = false;
    }
    let (mut triangles, mut parts) = (Vec::new(), Vec::new());
    let mut rule = Triangulator::default();
    for (corners, &part) in pool.polygons().iter().zip(&part_of) {
        triangles.extend_from_slice(rule.triangulate(corners, |v| pool.positions()[v as usize]));
        parts.resize(triangles.len(), part);
    }
    let verdicts = judge(pool.positions(), &triangles, &parts, (&closed, true), options)?;
    let flip: Vec<bool> = part_of.iter().map(|&part| verdicts[part as usize].reverse).collect();
    let outcome = with_flipped(pool, &flip, Step::TurnOutward);
    let parts = verdicts.iter().zip(faces).map(|(v, (face, faces))| v.part(face, faces)).collect();
    Ok(TurnedOutward { outcome, parts })
}

/// What is to be done about a part.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Verdict {
    closed: bool,
    depth: u32,
    crosses: bool,
    confidence: f64,
    pub(crate) reverse: bool,
}

impl Verdict {
    pub(crate) fn part<F>(&self, face: F, faces: usize) -> OutwardPart<F> {
        let &Self { closed, depth, crosses, confidence, reverse } = self;
        OutwardPart { face, faces, closed, depth, crosses, confidence, reversed: reverse }
    }
}

/// Judges every part, given triangles (corners may carry [`CUT`]) with the part of each, which parts are closed, and
/// whether open ones are asked at all.
pub(crate) fn judge(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    part_of: &[u32],
    (closed, open_too): (&[bool], bool),
    options: OutwardOptions<'_>,
) -> Result<Vec<Verdict>, OutwardError> {
    let OutwardOptions { min_confidence, mut control } = options;
    if !(0.0..=1.0).contains(&min_confidence) {
        return Err(OutwardError::BadConfidence(min_confidence));
    }
    control.report("measure parts", 0.0)?;
    let mut of_part: Vec<Vec<u32>> = vec![Vec::new(); closed.len()];
    part_of.iter().zip(0..).for_each(|(&part, triangle)| of_part[part as usize].push(triangle));
    let corners = |t: u32| triangles[t as usize].map(|v| v & !CUT);
    let places = |t: u32| corners(t).map(|v| positions[v as usize]);
    let boxes: Vec<Option<Aabb>> =
        of_part.iter().map(|part| Aabb::around(part.iter().flat_map(|&t| places(t)))).collect();

    control.report("index", 0.1)?;
    let solid: Vec<u32> =
        (0..triangles.len() as u32).filter(|&t| closed[part_of[t as usize] as usize]).collect();
    let several = closed.iter().filter(|c| **c).count() > 1;
    let tree = if several {
        let shapes: Vec<[u32; 3]> = solid.iter().map(|&t| triangles[t as usize]).collect();
        let parts: Vec<u32> = solid.iter().map(|&t| part_of[t as usize]).collect();
        Some(Tree::new_with(positions, &shapes, &parts, control.part(0.1, 0.3))?)
    } else {
        None
    };
    let meets_other = if several { meeting_boxes(&boxes, closed) } else { vec![false; closed.len()] };
    let mut tally = Tally::new(closed.len(), solid.len());
    let mut verdicts = Vec::with_capacity(closed.len());
    for (part, own) in of_part.iter().enumerate() {
        let [from, to] = [part, part + 1].map(|done| 0.3 + 0.7 * done as f64 / closed.len() as f64);
        control.report("turn outward", from)?;
        let mut verdict =
            Verdict { closed: closed[part], depth: 0, crosses: false, confidence: 0.0, reverse: false };
        if !closed[part] && !open_too {
            verdicts.push(verdict);
            continue;
        }
        if !closed[part] {
            let mean = mean_winding(own, places, control.part(from, to))?;
            verdict.confidence = (2.0 * mean.abs()).min(1.0);
            verdict.reverse = mean < 0.0 && verdict.confidence >= min_confidence;
            verdicts.push(verdict);
            continue;
        }
        if let Some(tree) = &tree
            && meets_other[part]
        {
            (verdict.depth, verdict.crosses) = tally.depth(tree, part, vertices_of(own, corners), positions);
        }
        let volume = signed_volume(own, places);
        verdict.confidence = if volume == 0.0 { 0.0 } else { 1.0 };
        verdict.reverse = if verdict.depth.is_multiple_of(2) { volume < 0.0 } else { volume > 0.0 };
        verdicts.push(verdict);
    }
    Ok(verdicts)
}

/// Which closed parts' boxes may meet another's: all that do, and where very many lie above each other, some that do not.
fn meeting_boxes(boxes: &[Option<Aabb>], closed: &[bool]) -> Vec<bool> {
    const LOOKS: usize = 64;
    let mut order: Vec<(usize, Aabb)> =
        (0..boxes.len()).filter(|&p| closed[p]).filter_map(|p| Some((p, boxes[p]?))).collect();
    order.sort_by(|a, b| a.1.min.x.total_cmp(&b.1.min.x));
    let mut meets = vec![false; boxes.len()];
    for (i, (part, own)) in order.iter().enumerate() {
        let mut after = order[i + 1..].iter().take_while(|b| b.1.min.x <= own.max.x);
        for (other, b) in after.by_ref().take(LOOKS) {
            if own.min.cmple(b.max).all() && b.min.cmple(own.max).all() {
                (meets[*part], meets[*other]) = (true, true);
            }
        }
        if after.next().is_some() {
            // Rays will tell.
            order.iter().for_each(|o| meets[o.0] = true);
            break;
        }
    }
    meets
}

/// The vertices of triangles, ascending.
fn vertices_of(triangles: &[u32], corners: impl Fn(u32) -> [u32; 3]) -> Vec<u32> {
    let mut vertices: Vec<u32> = triangles.iter().flat_map(|&t| corners(t)).collect();
    vertices.sort_unstable();
    vertices.dedup();
    vertices
}

/// What rays from one part met of the others.
struct Tally {
    /// By part, of one ray: how often it winds about the origin, or [`ON`](Self::ON).
    winding: Vec<i32>,
    /// By part, of all rays: how many began inside, and how many on it.
    inside: Vec<u32>,
    on: Vec<u32>,
    /// The parts met by one ray, and by all.
    met: Vec<u32>,
    ever_met: Vec<u32>,
    /// How many more triangles may be asked.
    budget: usize,
}

impl Tally {
    const ON: i32 = i32::MAX;
    /// At how many vertices of a part its depth is asked for.
    const LOOKED_AT: usize = 64;

    fn new(parts: usize, triangles: usize) -> Self {
        let counts = || vec![0; parts];
        Self {
            winding: vec![0; parts],
            inside: counts(),
            on: counts(),
            met: Vec::new(),
            ever_met: Vec::new(),
            // Rays from life ask a few dozen each.
            budget: 24 * triangles + (1 << 20),
        }
    }

    /// In how many other parts a part lies, and whether that depends on where one asks: then none. Vertices on another
    /// part's surface say nothing about that part. Once the budget is spent, it is as if all depended on it.
    fn depth(&mut self, tree: &Tree, part: usize, vertices: Vec<u32>, positions: &[DVec3]) -> (u32, bool) {
        let mut looked = 0;
        for &v in vertices.iter().step_by(vertices.len().div_ceil(Self::LOOKED_AT)) {
            if self.budget == 0 {
                self.ever_met.drain(..).for_each(|p| (self.inside[p as usize], self.on[p as usize]) = (0, 0));
                return (0, true);
            }
            looked += 1;
            self.cast(tree, part, positions[v as usize]);
            for &other in &self.met {
                let found = std::mem::take(&mut self.winding[other as usize]);
                self.inside[other as usize] += u32::from(found != 0 && found != Self::ON);
                self.on[other as usize] += u32::from(found == Self::ON);
            }
            self.ever_met.append(&mut self.met);
        }
        self.ever_met.sort_unstable();
        self.ever_met.dedup();
        let (mut within, mut crosses) = (0, false);
        for other in self.ever_met.drain(..) {
            let inside = std::mem::take(&mut self.inside[other as usize]);
            let on = std::mem::take(&mut self.on[other as usize]);
            within += u32::from(inside > 0);
            crosses |= inside > 0 && inside + on < looked;
        }
        if crosses { (0, true) } else { (within, false) }
    }

    /// Sums up how a ray passes the other parts.
    fn cast(&mut self, tree: &Tree, part: usize, origin: DVec3) {
        let outward = origin * tree.scale - tree.center;
        let cast = Cast::new(tree, origin, SKEW.copysign(outward));
        let budget = &mut self.budget;
        cast.walk(false, |range| {
            *budget = budget.saturating_sub(range.len());
            for triangle in range {
                let other = tree.faces[triangle as usize];
                if other as usize == part {
                    continue;
                }
                let (adds, is_on) = match cast.meet(triangle, f64::INFINITY) {
                    Meeting::Miss => continue,
                    Meeting::Through(passing) => (i32::from(passing.facing), passing.t == 0.0),
                    Meeting::Touching(contact) => {
                        let ahead = contact.at.iter().any(|touched| touched.t >= 0.0);
                        let behind = contact.at.iter().any(|touched| touched.t <= 0.0);
                        (if ahead { i32::from(contact.passes) } else { 0 }, ahead && behind)
                    }
                };
                self.met.push(other);
                let sum = &mut self.winding[other as usize];
                *sum = if is_on || *sum == Self::ON { Self::ON } else { *sum + adds };
            }
            f32::INFINITY
        });
        self.met.sort_unstable();
        self.met.dedup();
    }
}

/// Six times the volume of a closed part, about its first corner; scaled, so that only the sign means anything. 0 if it is
/// no more than what rounding may make of a flat part.
fn signed_volume(own: &[u32], places: impl Fn(u32) -> [DVec3; 3] + Copy) -> f64 {
    let Some(&first) = own.first() else { return 0.0 };
    let origin = places(first)[0] * 0.5;
    let local = |p: DVec3| p * 0.5 - origin;
    let scale = unit_scale(own.iter().flat_map(|&t| places(t)).map(local));
    let (mut sum, mut lost, mut size) = (0.0, 0.0, 0.0);
    for &t in own {
        let [a, b, c] = places(t).map(|p| local(p) * scale);
        let (add, before) = (a.cross(b).dot(c), sum);
        size += a.length() * b.length() * c.length();
        // Neumaier's compensated sum.
        sum += add;
        lost += if f64::abs(before) >= f64::abs(add) { (before - sum) + add } else { (add - sum) + before };
    }
    let volume = sum + lost;
    if volume.abs() > 8.0 * f64::EPSILON * size { volume } else { 0.0 }
}

/// The mean winding number of a part on its own surface, weighted by area: a half where it closes around the inside, minus
/// a half where it is inside out.
fn mean_winding(
    own: &[u32],
    places: impl Fn(u32) -> [DVec3; 3] + Copy,
    mut control: Control<'_>,
) -> Result<f64, Cancelled> {
    const LOOKED_AT: usize = 256;
    let Some(&first) = own.first() else { return Ok(0.0) };
    let origin = places(first)[0] * 0.5;
    let local = |p: DVec3| p * 0.5 - origin;
    let scale = unit_scale(own.iter().flat_map(|&t| places(t)).map(local));
    let shape = |t: u32| places(t).map(|p| local(p) * scale);
    let (mut sum, mut weight) = (0.0, 0.0);
    let (step, mut since) = (own.len().div_ceil(LOOKED_AT), 0);
    for (i, &t) in own.iter().enumerate().step_by(step) {
        since += own.len();
        if since >= 1 << 19 {
            control.report("turn outward", i as f64 / own.len() as f64)?;
            since = 0;
        }
        let area = double_area_vector(shape(t).into_iter()).length();
        let at = shape(t).iter().sum::<DVec3>() / 3.0;
        let angle: f64 =
            own.iter().filter(|&&other| other != t).map(|&other| solid_angle(shape(other), at)).sum();
        sum += area * angle;
        weight += area;
    }
    Ok(if weight > 0.0 { sum / weight / (4.0 * std::f64::consts::PI) } else { 0.0 })
}

/// The solid angle under which a triangle is seen, positive from behind (Van Oosterom and Strackee, "The Solid Angle of a
/// Plane Triangle", IEEE Transactions on Biomedical Engineering 30(2), 1983).
fn solid_angle(triangle: [DVec3; 3], from: DVec3) -> f64 {
    let [a, b, c] = triangle.map(|p| p - from);
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let above = a.dot(b.cross(c));
    let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * above.atan2(below)
}
