//! Weld: vertices nearer than a tolerance become one. Unweld: the surface is parted where it turns sharply.

mod columns;

use super::normals::double_area_vector;
use super::{direction, unit_scale};
use crate::cleanup::{CleanError, CleanOptions, Names, Weld, clean_tracked};
use crate::matching::NONE;
use crate::report::{Element, Kind, Maps, Outcome, Record, Relation, Report, Step, StepSummary};
use crate::{BuildError, Cancelled, Control, EdgeKey, IndexedMesh, Mesh, Polygons};
use glam::DVec3;

/// How to weld.
#[derive(Debug, Default)]
pub struct WeldOptions<'a> {
    /// Vertices closer than this become one, in the mesh's units; 0, the default, merges equal coordinates.
    pub tolerance: f64,
    /// The progress-and-cancel hook.
    pub control: Control<'a>,
}

/// How to unweld.
#[derive(Debug)]
pub struct UnweldOptions<'a> {
    /// Edges at which the normals of the two faces differ by more than this are parted. 30 by default.
    pub degrees: f64,
    /// The progress-and-cancel hook.
    pub control: Control<'a>,
}

impl Default for UnweldOptions<'_> {
    fn default() -> Self {
        Self { degrees: 30.0, control: Control::none() }
    }
}

/// An angle outside 0 to 180 degrees, or NaN.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("an angle of {0} degrees between two faces makes no sense")]
pub struct BadAngle(pub f64);

/// Nothing if the angle is one.
pub(super) fn in_range(degrees: f64) -> Result<(), BadAngle> {
    if (0.0..=180.0).contains(&degrees) { Ok(()) } else { Err(BadAngle(degrees)) }
}

/// Why a mesh was not welded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WeldError {
    /// The mesh has no vertices.
    #[error("there are no vertices")]
    Empty,
    /// The tolerance is negative, NaN or infinite.
    #[error("a weld tolerance of {0} makes no sense")]
    BadTolerance(f64),
    /// The result was not a manifold after all. This is a bug of this crate; please report it with the input.
    #[error("bug in the weld: {0}")]
    Bug(CleanError),
    /// The hook said stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl From<CleanError> for WeldError {
    fn from(error: CleanError) -> Self {
        match error {
            CleanError::BadTolerance(tolerance) => Self::BadTolerance(tolerance),
            CleanError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            error => Self::Bug(error),
        }
    }
}

/// Why a mesh was not unwelded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum UnweldError {
    /// The mesh has no vertices.
    #[error("there are no vertices")]
    Empty,
    /// The angle is not within 0 to 180 degrees.
    #[error(transparent)]
    BadAngle(#[from] BadAngle),
    /// The result was not a manifold after all. This is a bug of this crate; please report it with the input.
    #[error("bug in the unweld: {0}")]
    Bug(BuildError),
    /// The hook said stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// How often a weld goes over its result; three rounds are many.
const MOST_ROUNDS: i32 = 64;

fn is_split(report: &Report) -> bool {
    report.steps.iter().any(|s| s.step == Step::SplitVertices && s.changed > 0)
}

/// What a weld makes less of: places, corners, boundary edges, vertices, and what the number of faces lacks to the largest;
/// the first that differs counts. A round after which there is not less is not worth it, so there are finitely many, and
/// none after the last. What lies in the middle of an
/// edge between two faces is not counted: a weld may put vertices there to part edges.
fn extent(mesh: &Mesh) -> [usize; 5] {
    let is_open = |h: u32| mesh.face[h as usize] == NONE;
    let mut ends = vec![0u32; mesh.vertices.slot_count()];
    let halfedges = || mesh.edges.live().flat_map(|e| [2 * e, 2 * e + 1]);
    halfedges().for_each(|h| ends[mesh.origin[h as usize] as usize] += 1 + u32::from(is_open(h)));
    let counts = |v: u32| ends[v as usize] != 2;
    let corners = halfedges().filter(|&h| !is_open(h) && counts(mesh.origin[h as usize])).count();
    let boundary = halfedges().filter(|&h| is_open(h)).count();
    // Adding zero makes one of both zeros.
    let place = |v: u32| (mesh.positions[v as usize] + DVec3::ZERO).to_array().map(f64::to_bits);
    let mut places: Vec<[u64; 3]> = mesh.vertices.live().filter(|&v| counts(v)).map(place).collect();
    places.sort_unstable();
    places.dedup();
    [places.len(), corners, boundary, mesh.vertex_count(), usize::MAX - mesh.face_count()]
}

impl Mesh {
    /// Merges vertices: each joins the lowest vertex kept so far that is nearer than the tolerance, and is kept, where
    /// it is, if there is none. Kept vertices stay at least a tolerance apart, so nothing drifts along a chain.
    ///
    /// This is [`clean`](crate::cleanup::clean) on the mesh: what the merges fold or double is repaired on record, faces that
    /// no longer fit
    /// together are paired or parted, and a merge that would pinch the surface is taken back. The maps lead from the
    /// numbering of [`to_indexed`](Self::to_indexed) to the result's.
    ///
    /// Where merges were taken back, the result is welded again, as long as that leaves fewer places where vertices are, or as many and
    /// fewer corners, or else boundary edges, or else vertices, or else cuts a face. A weld that does none of that is not
    /// done at all, and nothing is on record. So welding again with the same tolerance changes nothing. O(n log n), for each of a few
    /// rounds where merges were taken back.
    ///
    /// User columns come along under their keys, each by its [`Rule`](crate::Rule). A vertex that merged others has its own
    /// value at weight 1 and theirs at 0, as it stays where it is: `keep` and `interpolate` give its own, `average` the
    /// mean of all, `reset` the default. Two edges that become one count alike; corners and faces keep what they have, and
    /// the parts of a face that was cut have the rule's answer to a split of it.
    ///
    /// # Errors
    /// [`WeldError`] on a tolerance that is negative, NaN or infinite or a mesh without vertices; when cancelled.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, WeldOptions, glam::DVec3};
    /// let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X * 1.01, DVec3::ONE, DVec3::Y];
    /// let apart = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2], [3, 4, 5]])?)?;
    /// let welded = apart.weld(WeldOptions { tolerance: 0.1, ..Default::default() })?;
    /// assert_eq!((welded.value.vertex_count(), welded.value.edge_count()), (4, 5));
    /// assert_eq!(welded.maps.vertices.new_of(3), &[1]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn weld(&self, options: WeldOptions<'_>) -> Result<Outcome<Mesh>, WeldError> {
        let WeldOptions { tolerance, mut control } = options;
        if !(tolerance >= 0.0 && tolerance.is_finite()) {
            return Err(WeldError::BadTolerance(tolerance));
        }
        if self.vertex_count() == 0 {
            return Err(WeldError::Empty);
        }
        let Some((mut all, mut names)) = self.weld_once(tolerance, control.part(0.0, 0.9))? else {
            return self.unwelded(control.part(0.9, 1.0));
        };
        for round in 1..MOST_ROUNDS {
            // Without splits the kept vertices are all there is, and lie apart.
            if !is_split(&all.report) {
                break;
            }
            let share = |round: i32| 1.0 - 0.1 * 0.5f64.powi(round - 1);
            let control = control.part(share(round), share(round + 1));
            let Some((next, sources)) = all.value.weld_once(tolerance, control)? else { break };
            let records = next.report.records.into_iter();
            all.report.records.extend(records.map(|r| Record { element: names.of(r.element), ..r }));
            all.report.records.sort_by_key(|r| r.step);
            next.report.steps.into_iter().for_each(|step| all.report.add_step(step));
            // The one starts where the other ended.
            all.maps = all.maps.then(&next.maps).unwrap_or_default();
            all.value = next.value;
            names = names.then(&sources);
        }
        Ok(all)
    }

    /// One weld, and how its result's elements are named in this mesh; nothing if it only parts what it has merged.
    fn weld_once(
        &self,
        tolerance: f64,
        control: Control<'_>,
    ) -> Result<Option<(Outcome<Mesh>, Names)>, WeldError> {
        let options = CleanOptions { weld: Weld::Within(tolerance), control, ..Default::default() };
        let (mut outcome, sources) = clean_tracked(&self.to_indexed().into(), options)?;
        if is_split(&outcome.report) && extent(&outcome.value) >= extent(self) {
            return Ok(None);
        }
        let columns = columns::welded(self, &outcome.value, &outcome.maps.vertices, &sources);
        outcome.value.adopt_columns(columns);
        Ok(Some((outcome, Names::new(sources.vertices, sources.faces))))
    }

    /// The account of a weld that merges nothing.
    fn unwelded(&self, control: Control<'_>) -> Result<Outcome<Mesh>, WeldError> {
        let options = CleanOptions { weld: Weld::None, control, ..Default::default() };
        let (mut outcome, sources) = clean_tracked(&self.to_indexed().into(), options)?;
        let columns = columns::welded(self, &outcome.value, &outcome.maps.vertices, &sources);
        outcome.value.adopt_columns(columns);
        Ok(outcome)
    }

    /// Parts the surface along sharp edges, the inverse of a weld: around each vertex, the faces between two sharp
    /// edges (or a sharp edge and the boundary) get a vertex of their own. A sharp edge is parted if either of its ends
    /// is; a lone one inside a smooth surface stays. An edge at a face without area has no angle, and is not sharp.
    ///
    /// The fan with the lowest face keeps the vertex's number; further ones are numbered at the end, by vertex and
    /// then clockwise from there. Faces keep theirs. Each parted edge is on record. Attributes are
    /// copied, normals of vertices among them: [compute](Self::compute_normals) them anew to have hard edges. User
    /// columns come along under their keys: a vertex or edge that was added has what the column's [`Rule`](crate::Rule) makes
    /// of a split of the one it was (under `reset` the default, under others the same value); all else keeps what it has.
    /// O(elements).
    ///
    /// # Errors
    /// [`UnweldError`] on an angle outside 0 to 180 degrees or a mesh without vertices; when cancelled.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, UnweldOptions, WeldOptions, glam::DVec3};
    /// let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    /// let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    /// let corner = Mesh::build(&IndexedMesh::from_triangles(points, &faces)?)?;
    /// let parted = corner.unweld(UnweldOptions { degrees: 30.0, ..Default::default() })?;
    /// assert_eq!((parted.value.vertex_count(), parted.report.records.len()), (12, 6));
    /// let again = parted.value.weld(WeldOptions::default())?;
    /// assert_eq!(again.value.to_indexed(), corner.to_indexed());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn unweld(&self, options: UnweldOptions<'_>) -> Result<Outcome<Mesh>, UnweldError> {
        let UnweldOptions { degrees, mut control } = options;
        in_range(degrees)?;
        if self.vertex_count() == 0 {
            return Err(UnweldError::Empty);
        }
        control.report("find sharp edges", 0.0)?;
        let is_sharp = self.sharp_slots(degrees)?;
        control.report("part fans", 0.3)?;
        let fans = Fans::part(self, &is_sharp);
        control.report("build", 0.6)?;
        let mut value = Mesh::build(&fans.pool(self)).map_err(UnweldError::Bug)?;
        let records = fans.parted(self);
        let changed = fans.added.len();
        let report =
            Report { steps: vec![StepSummary::new(Step::Unweld, changed)], records, ..Report::default() };
        let (old, new) = (fans.order.len(), value.vertex_count());
        let stay = (0..old as u32).map(|v| (v, v));
        let split = fans.added.iter().zip(old as u32..).map(|(&v, new)| (fans.number[v as usize], new));
        let vertices = Relation::from_pairs(old, new, stay.chain(split));
        let added: Vec<u32> = fans.added.iter().map(|&v| fans.number[v as usize]).collect();
        value.adopt_columns(columns::unwelded(self, &value, &added));
        Ok(Outcome { value, report, maps: Maps { vertices, faces: Relation::identity(self.face_count()) } })
    }

    /// The edges at which the normals of the two faces differ by more than an angle, in the order of
    /// [`edges`](Self::edges). Boundary edges and edges at a face without area are not among them. O(elements).
    ///
    /// # Errors
    /// [`BadAngle`] on an angle outside 0 to 180 degrees.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    /// let fold = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2], [1, 0, 3]])?)?;
    /// assert_eq!(fold.sharp_edges(80.0)?.len(), 1);
    /// assert_eq!(fold.sharp_edges(90.0)?.len(), 0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn sharp_edges(&self, degrees: f64) -> Result<Vec<EdgeKey>, BadAngle> {
        let is_sharp = self.sharp_slots(degrees)?;
        Ok(self.edges.live().filter(|&e| is_sharp[e as usize]).map(|e| self.edges.key(e)).collect())
    }

    /// By edge slot.
    fn sharp_slots(&self, degrees: f64) -> Result<Vec<bool>, BadAngle> {
        in_range(degrees)?;
        let mut normals = vec![DVec3::ZERO; self.faces.slot_count()];
        for f in self.faces.live() {
            let corners = || self.loop_slots(self.face_halfedge[f as usize]).map(|h| self.at(h));
            let scale = unit_scale(corners());
            normals[f as usize] = direction(double_area_vector(corners().map(|p| p * scale)));
        }
        let mut is_sharp = vec![false; self.edges.slot_count()];
        for e in self.edges.live() {
            let [f, g] = [2 * e, 2 * e + 1].map(|h| self.face[h as usize]);
            if f == NONE || g == NONE {
                continue;
            }
            let (u, v) = (normals[f as usize], normals[g as usize]);
            let angle = 2.0 * (u - v).length().atan2((u + v).length());
            is_sharp[e as usize] = u != DVec3::ZERO && v != DVec3::ZERO && angle.to_degrees() > degrees;
        }
        Ok(is_sharp)
    }
}

/// The vertices that corners get.
struct Fans {
    /// Vertex slots in the user's order, and the number of each slot.
    order: Vec<u32>,
    number: Vec<u32>,
    /// Face slots in the user's order.
    faces: Vec<u32>,
    /// By half-edge slot with a face: the number of the vertex its corner gets.
    of: Vec<u32>,
    /// For each vertex added, the slot of the one it was split from.
    added: Vec<u32>,
}

impl Fans {
    fn part(mesh: &Mesh, is_sharp: &[bool]) -> Self {
        let (order, faces) = (mesh.vertices.in_user_order(), mesh.faces.in_user_order());
        let mut number = vec![NONE; mesh.vertices.slot_count()];
        order.iter().zip(0..).for_each(|(&v, i)| number[v as usize] = i);
        let mut rank = vec![NONE; mesh.faces.slot_count()];
        faces.iter().zip(0..).for_each(|(&f, i)| rank[f as usize] = i);
        let mut of = vec![NONE; mesh.origin.len()];
        let mut added = Vec::new();
        // The corners around a vertex, clockwise, and where a new fan begins among them.
        let (mut corners, mut begins) = (Vec::new(), Vec::new());
        for &v in &order {
            corners.clear();
            corners.extend(mesh.outgoing_slots(v).filter(|&h| mesh.face[h as usize] != NONE));
            begins.clear();
            // A corner's clockwise neighbour lies across its half-edge, so it begins a fan if that edge is sharp.
            let sharp = |i: usize| is_sharp[corners[i] as usize >> 1];
            let n = corners.len();
            let h = mesh.vertex_halfedge[v as usize];
            let is_open = h != NONE && mesh.face[h as usize] == NONE;
            begins.extend((0..n).filter(|&i| if i > 0 { sharp(i - 1) } else { is_open || sharp(n - 1) }));
            if begins.len() < 2 {
                corners.iter().for_each(|&h| of[h as usize] = number[v as usize]);
                continue;
            }
            // The walk starts with the fan that has the lowest face.
            let lowest = (0..n).min_by_key(|&i| rank[mesh.face[corners[i] as usize] as usize]).unwrap_or(0);
            let keeper = begins.iter().rposition(|&b| b <= lowest).unwrap_or(begins.len() - 1);
            for k in 0..begins.len() {
                let fan = (keeper + k) % begins.len();
                let name = if k == 0 {
                    number[v as usize]
                } else {
                    added.push(v);
                    (order.len() + added.len() - 1) as u32
                };
                let mut i = begins[fan];
                let end = begins[(fan + 1) % begins.len()];
                loop {
                    of[corners[i] as usize] = name;
                    i = (i + 1) % n;
                    if i == end {
                        break;
                    }
                }
            }
        }
        Self { order, number, faces, of, added }
    }

    fn pool(&self, mesh: &Mesh) -> IndexedMesh {
        let mut polygons = Polygons::with_capacity(self.faces.len(), 3 * self.faces.len());
        for &f in &self.faces {
            polygons.push(mesh.loop_slots(mesh.face_halfedge[f as usize]).map(|h| self.of[h as usize]));
        }
        let slots: Vec<u32> = self.order.iter().chain(&self.added).copied().collect();
        let positions = slots.iter().map(|&v| mesh.positions[v as usize]).collect();
        IndexedMesh::trusted(positions, polygons, None).carrying(mesh.ordered_attributes(&slots))
    }

    /// A record for each edge whose two sides no longer share both ends.
    fn parted(&self, mesh: &Mesh) -> Vec<Record> {
        let of = |h: u32| self.of[h as usize];
        let inner = |&e: &u32| mesh.face[2 * e as usize] != NONE && mesh.face[2 * e as usize + 1] != NONE;
        let parted = |&e: &u32| {
            let (h, t) = (2 * e, 2 * e + 1);
            of(h) != of(mesh.next[t as usize]) || of(t) != of(mesh.next[h as usize])
        };
        let record = |e: u32| {
            let ends = [2 * e, 2 * e + 1].map(|h| mesh.origin[h as usize]);
            let [a, b] = ends.map(|v| self.number[v as usize]);
            let [p, q] = ends.map(|v| mesh.positions[v as usize]);
            let element = Element::Edge([a.min(b), a.max(b)]);
            Record::new(Step::Unweld, Kind::SharpEdge, element, Some(p * 0.5 + q * 0.5))
        };
        mesh.edges.live().filter(inner).filter(parted).map(record).collect()
    }
}
