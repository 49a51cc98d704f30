//! Winding: which faces to reverse so that neighbours agree, or the cycle of faces that makes it impossible.

use super::{FaceOf, Topology, UnionFind};
use crate::indexed::list;
use crate::matching::NONE;
use crate::report::{Element, Kind, Maps, Outcome, Record, Report, Step, StepSummary};
use crate::{Cancelled, Control, IndexedMesh, Polygons};
use std::collections::VecDeque;
use std::fmt;

/// Some parts of the surface cannot be oriented.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct NotOrientable {
    /// For each such part, a closed walk of faces, each sharing a two-face edge with the next and the last with the
    /// first, along which the winding comes back reversed.
    pub cycles: Vec<Vec<u32>>,
}

/// Why windings were not unified under a hook.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum UnifyWithError {
    /// Some parts cannot be oriented.
    #[error(transparent)]
    Refused(#[from] NotOrientable),
    /// The hook said stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl fmt::Display for NotOrientable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown: Vec<String> =
            self.cycles.iter().map(|c| format!("a cycle of {} faces from face {}", c.len(), c[0])).collect();
        list(f, "not orientable", &shown)
    }
}

/// Reverses faces so that the two at every two-face edge are wound alike.
///
/// Each part that hangs together across two-face edges is unified by itself, and the largest piece of it whose winding
/// is consistent keeps its winding (the one with the lowest face, among equals). Edges with three or more faces are
/// never crossed. A reversed face keeps its first corner; corner data moves with its corners, and corner normals turn with
/// the face unless they lie on the side where it then faces. Vertices and their normals stay as they are. O(corners), on
/// the same matched half-edges that [`Mesh::build`](crate::Mesh::build) uses.
///
/// # Errors
/// [`NotOrientable`] with a witness for each part that cannot be oriented.
///
/// # Examples
/// ```
/// use meshwright::{IndexedMesh, Mesh, glam::DVec3, unify_winding};
/// let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X + DVec3::Y];
/// let mixed = IndexedMesh::from_triangles(points, &[[0, 1, 2], [1, 2, 3]])?;
/// let unified = unify_winding(&mixed.topology())?;
/// assert_eq!(&unified.value.polygons()[1], &[1, 3, 2]);
/// assert_eq!(unified.report.records.len(), 1);
/// assert!(Mesh::build(&unified.value).is_ok());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn unify_winding(topology: &Topology<'_>) -> Result<Outcome<IndexedMesh>, NotOrientable> {
    unify_by(topology, |_, _| Ok(()))
}

/// As [`unify_winding`], with a progress-and-cancel hook.
///
/// # Errors
/// [`UnifyWithError`]: as [`unify_winding`]; when cancelled.
///
/// # Examples
/// ```
/// use meshwright::{Control, IndexedMesh, Progress, UnifyWithError, unify_winding_with};
/// use std::ops::ControlFlow;
/// let mut stop = |_: Progress| ControlFlow::Break(());
/// let refused = unify_winding_with(&IndexedMesh::default().topology(), Control::new(&mut stop));
/// assert!(matches!(refused, Err(UnifyWithError::Cancelled(_))));
/// ```
pub fn unify_winding_with(
    topology: &Topology<'_>,
    mut control: Control<'_>,
) -> Result<Outcome<IndexedMesh>, UnifyWithError> {
    unify_by(topology, |stage, fraction| Ok(control.report(stage, fraction)?))
}

fn unify_by<E: From<NotOrientable>>(
    topology: &Topology<'_>,
    mut report: impl FnMut(&'static str, f64) -> Result<(), E>,
) -> Result<Outcome<IndexedMesh>, E> {
    let mesh = topology.mesh;
    report("unify", 0.0)?;
    let mut flip = vec![false; mesh.face_count()];
    if topology.matching.any_conflict {
        let found = orient(mesh.polygons(), &topology.face_of, &topology.matching.mates());
        if !found.cycles.is_empty() {
            return Err(NotOrientable { cycles: found.cycles }.into());
        }
        flip = found.flip;
    }
    report("reverse", 0.6)?;
    Ok(with_flipped(mesh, &flip, Step::Unify))
}

/// The pool with the given faces reversed, each of which keeps its first corner, and an account of it.
pub(crate) fn with_flipped(mesh: &IndexedMesh, flip: &[bool], step: Step) -> Outcome<IndexedMesh> {
    let mut polygons = mesh.polygons().clone();
    let mut attributes = mesh.attributes().clone();
    let mut report = Report::default();
    flip_faces(&mut polygons, None, flip);
    attributes.turn_with(flip, mesh.positions(), &polygons);
    for (face, _) in flip.iter().enumerate().filter(|(_, flip)| **flip) {
        attributes.reverse_corners(polygons.starts()[face]..polygons.starts()[face + 1]);
        let corners = &mesh.polygons()[face];
        let middle = corners.iter().map(|&v| mesh.positions()[v as usize] / corners.len() as f64).sum();
        report.records.push(Record::new(step, Kind::FlippedFace, Element::Face(face as u32), Some(middle)));
    }
    report.steps.push(StepSummary::new(step, report.records.len()));
    Outcome {
        value: IndexedMesh::trusted(mesh.positions().to_vec(), polygons, None).carrying(attributes),
        report,
        maps: Maps::identity(mesh.vertex_count(), mesh.face_count()),
    }
}

/// What [`orient`] found.
pub(crate) struct Orientation {
    /// The faces to reverse.
    pub(crate) flip: Vec<bool>,
    /// One cycle of faces per part that cannot be oriented.
    pub(crate) cycles: Vec<Vec<u32>>,
    /// The corners, one of each pair, at which flipped faces still conflict: empty if there is no cycle.
    pub(crate) conflicts: Vec<u32>,
}

/// Decides which faces to reverse, given for each corner its mate across the edge or [`NONE`].
pub(crate) fn orient(polygons: &Polygons, face_of: &FaceOf, mates: &[u32]) -> Orientation {
    let faces = polygons.len();
    let alike = |c: usize, m: u32| polygons.corners()[c] == polygons.corners()[m as usize];

    // Pieces of consistent winding, and their sizes.
    let mut pieces = UnionFind::new(faces);
    for (c, &m) in mates.iter().enumerate() {
        if m != NONE && (m as usize) > c && !alike(c, m) {
            pieces.join(face_of.face(c), face_of.face(m as usize));
        }
    }
    let mut size = vec![0u32; faces];
    for f in 0..faces as u32 {
        size[pieces.root(f) as usize] += 1;
    }

    let mut found = Orientation { flip: vec![false; faces], cycles: Vec::new(), conflicts: Vec::new() };
    // The face from which each was reached; itself for the first of its part.
    let mut parent = vec![NONE; faces];
    let mut queue = VecDeque::new();
    let mut part = Vec::new();
    let mut nearest = VecDeque::new();
    for seed in 0..faces {
        if parent[seed] != NONE {
            continue;
        }
        parent[seed] = seed as u32;
        queue.push_back(seed as u32);
        part.clear();
        let mut keeper = seed as u32;
        let mut cycle = None;
        let conflicts = found.conflicts.len();
        while let Some(f) = queue.pop_front() {
            part.push(f);
            let root = pieces.root(f);
            let (now, best) = (size[root as usize], size[pieces.root(keeper) as usize]);
            if now > best || now == best && root < pieces.root(keeper) {
                keeper = root;
            }
            let corners = polygons.starts()[f as usize]..polygons.starts()[f as usize + 1];
            for (c, &m) in corners.clone().zip(&mates[corners]) {
                if m == NONE {
                    continue;
                }
                let g = face_of.face(m as usize);
                let flip = found.flip[f as usize] ^ alike(c, m);
                if parent[g as usize] == NONE {
                    parent[g as usize] = f;
                    found.flip[g as usize] = flip;
                    queue.push_back(g);
                } else if found.flip[g as usize] != flip && (m as usize) > c {
                    found.conflicts.push(c as u32);
                    cycle = cycle.or(Some((f, g)));
                }
            }
        }
        if let Some((f, g)) = cycle {
            found.cycles.push(closed_walk(&parent, f, g));
            // Somewhere windings conflict: so that no more is reversed than must be, not within a piece.
            found.conflicts.truncate(conflicts);
            part.iter().for_each(|&f| parent[f as usize] = NONE);
            nearest.push_back((seed as u32, false));
            while let Some((f, flip)) = nearest.pop_front() {
                if parent[f as usize] != NONE {
                    continue;
                }
                parent[f as usize] = f;
                found.flip[f as usize] = flip;
                let corners = polygons.starts()[f as usize]..polygons.starts()[f as usize + 1];
                for (c, &m) in corners.clone().zip(&mates[corners]).filter(|(_, m)| **m != NONE) {
                    let g = face_of.face(m as usize);
                    match (parent[g as usize] == NONE, alike(c, m)) {
                        (true, false) => nearest.push_front((g, flip)),
                        (true, true) => nearest.push_back((g, !flip)),
                        (false, alike) => {
                            if found.flip[g as usize] != flip ^ alike {
                                found.conflicts.push((c as u32).min(m));
                            }
                        }
                    }
                }
            }
        }
        if found.flip[keeper as usize] {
            part.iter().for_each(|&f| found.flip[f as usize] ^= true);
        }
    }
    found
}

/// The tree paths of two neighbouring faces to their nearest common face, as one walk from `f` to `g`.
fn closed_walk(parent: &[u32], f: u32, g: u32) -> Vec<u32> {
    let path = |mut f: u32| {
        let mut path = vec![f];
        while parent[f as usize] != f {
            f = parent[f as usize];
            path.push(f);
        }
        path
    };
    let (mut up, mut down) = (path(f), path(g));
    while up.len() > 1 && down.len() > 1 && up[up.len() - 2] == down[down.len() - 2] {
        up.pop();
        down.pop();
    }
    down.pop();
    up.extend(down.into_iter().rev());
    up
}

/// Reverses the given faces, each of which keeps its first corner, and moves the mates of their corners along.
pub(crate) fn flip_faces(polygons: &mut Polygons, mates: Option<&mut Vec<u32>>, flip: &[bool]) {
    if let Some(mates) = mates {
        // Reversed, the half-edge of corner i in a face of n is that of corner n - 1 - i before.
        let moved = |c: usize, face: usize| {
            let (start, end) = (polygons.starts()[face], polygons.starts()[face + 1]);
            if flip[face] { start + end - 1 - c } else { c }
        };
        let face_of = FaceOf::new(polygons);
        for m in mates.iter_mut().filter(|m| **m != NONE) {
            *m = moved(*m as usize, face_of.face(*m as usize) as usize) as u32;
        }
        for face in (0..flip.len()).filter(|&f| flip[f]) {
            mates[polygons.starts()[face]..polygons.starts()[face + 1]].reverse();
        }
    }
    for face in (0..flip.len()).filter(|&f| flip[f]) {
        polygons.reverse(face);
    }
}
