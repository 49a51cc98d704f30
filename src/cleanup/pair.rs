//! Which faces belong together at an edge that has three or more of them.
//!
//! The surface falls into *patches*: faces joined across two-face edges, wound alike by then. At an edge with more faces
//! the choice goes, in this order, to
//! 1. faces of one patch: a solid that touches itself there comes apart;
//! 2. patches that close each other: all open edges of one are open edges of the other;
//! 3. the flattest angle.
//!
//! A whole patch may have to be reversed for a pairing; a union-find with parities keeps the choices consistent. What
//! is left over stays boundary.

use crate::Polygons;
use crate::geometry::measure::Aabb;
use crate::geometry::normals::double_area_vector;
use crate::geometry::{direction, unit_scale};
use crate::matching::{Matching, NONE};
use crate::topology::{FaceOf, UnionFind, next_corner};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// One use of an edge with three or more faces.
#[derive(Clone, Copy, Debug)]
struct Use {
    corner: u32,
    patch: u32,
    /// Whether the half-edge runs from the lower to the higher vertex.
    up: bool,
    /// Where the face lies around the edge, in radians from an arbitrary start, counter-clockwise about its direction
    /// from the lower to the higher vertex.
    angle: f64,
}

/// Two uses of one edge that might be paired.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    patches: (u32, u32),
    /// Whether one of the patches must be reversed.
    reversed: bool,
    /// How far the two faces are from lying flat, in radians.
    bend: f64,
    uses: (u32, u32),
}

/// Fills in the mates of faces at edges with three or more. Returns for each such edge how many faces stay unpaired.
pub(super) fn pair_faces(
    polygons: &Polygons,
    positions: &[DVec3],
    matching: &Matching,
    face_of: &FaceOf,
    mates: &mut [u32],
) -> Vec<(u32, u32)> {
    let patches = patches(polygons.len(), face_of, mates);
    let edges: Vec<u32> = matching.nonmanifold_edges().map(|e| e as u32).collect();
    let volumes = patch_volumes(polygons, positions, &patches);
    let mut around: Vec<Vec<Use>> = Vec::with_capacity(edges.len());
    for &e in &edges {
        let mut uses = uses_around(polygons, positions, matching, face_of, &patches, e as usize);
        pair_within_patches(&uses, |patch| volumes[patch as usize] < 0.0, mates);
        uses.retain(|u| mates[u.corner as usize] == NONE);
        around.push(uses);
    }
    let mut open = vec![0u32; polygons.len()];
    for (c, _) in mates.iter().enumerate().filter(|(_, m)| **m == NONE) {
        open[patches[face_of.face(c) as usize] as usize] += 1;
    }
    let mut parity = Parity::new(polygons.len());
    for group in closing_groups(around.iter().flat_map(|uses| candidates(uses)).collect(), &open) {
        let free = |c: &Candidate| mates[c.uses.0 as usize] == NONE && mates[c.uses.1 as usize] == NONE;
        if group.iter().all(free) && parity.agrees(group[0].patches, group[0].reversed) {
            parity.join(group[0].patches, group[0].reversed);
            for c in &group {
                pair(mates, c.uses);
            }
        }
    }
    for uses in &around {
        pair_by_angle(uses, mates, &mut parity);
    }
    let left = |uses: &Vec<Use>| uses.iter().filter(|u| mates[u.corner as usize] == NONE).count() as u32;
    edges.into_iter().zip(around.iter().map(left)).collect()
}

/// Six times the signed volume between each patch and the middle of all vertices: its sign tells whether a patch that
/// is closed but for edges where it touches itself is inside out.
fn patch_volumes(polygons: &Polygons, positions: &[DVec3], patches: &[u32]) -> Vec<f64> {
    let scale = unit_scale(positions.iter().copied());
    let center = Aabb::around(positions.iter().copied()).map_or(DVec3::ZERO, |b| b.center());
    let mut volumes = vec![0.0; patches.len()];
    for (face, &patch) in polygons.iter().zip(patches) {
        let at = |v: u32| (positions[v as usize] - center) * scale;
        let area = double_area_vector(face.iter().map(|&v| at(v)));
        volumes[patch as usize] += at(face[0]).dot(area);
    }
    volumes
}

fn pair(mates: &mut [u32], (a, b): (u32, u32)) -> bool {
    let free = mates[a as usize] == NONE && mates[b as usize] == NONE;
    if free {
        mates[a as usize] = b;
        mates[b as usize] = a;
    }
    free
}

/// The patch of each face, named by its lowest face.
fn patches(faces: usize, face_of: &FaceOf, mates: &[u32]) -> Vec<u32> {
    let mut sets = UnionFind::new(faces);
    for (c, &m) in mates.iter().enumerate() {
        if m != NONE && m as usize > c {
            sets.join(face_of.face(c), face_of.face(m as usize));
        }
    }
    (0..faces as u32).map(|f| sets.root(f)).collect()
}

/// The uses of an edge in the order in which they lie around it.
fn uses_around(
    polygons: &Polygons,
    positions: &[DVec3],
    matching: &Matching,
    face_of: &FaceOf,
    patches: &[u32],
    edge: usize,
) -> Vec<Use> {
    let corners = polygons.corners();
    let at = |c: usize| positions[corners[c] as usize];
    let first = matching.edges[edge].first();
    let end = next_corner(polygons, face_of.face(first), first);
    let (lo, hi) = if corners[first] < corners[end] { (first, end) } else { (end, first) };
    let axis = direction(at(hi) - at(lo));
    let (x, y) = if axis == DVec3::ZERO { (DVec3::X, DVec3::Y) } else { axis.any_orthonormal_pair() };
    let mut uses: Vec<Use> = matching
        .uses(edge)
        .map(|c| {
            let face = face_of.face(c);
            let up = corners[c] == corners[lo];
            // Into the face, square to the edge: the face lies to the left of its half-edge.
            let range = polygons.starts()[face as usize]..polygons.starts()[face as usize + 1];
            let normal = direction(double_area_vector(range.map(at)));
            let inward = normal.cross(if up { axis } else { -axis });
            let angle = inward.dot(y).atan2(inward.dot(x));
            Use { corner: c as u32, patch: patches[face as usize], up, angle }
        })
        .collect();
    uses.sort_by(|a, b| a.angle.total_cmp(&b.angle).then(a.corner.cmp(&b.corner)));
    uses
}

/// Pairs the faces of each patch that have the material between them: of a patch wound outward, a face whose half-edge
/// runs down, and the next counter-clockwise whose half-edge runs up. Matched like brackets around the circle, so that
/// pairs do not cross. A patch with just one face each way needs no choice.
fn pair_within_patches(uses: &[Use], is_inside_out: impl Fn(u32) -> bool, mates: &mut [u32]) {
    let mut by_patch: Vec<&Use> = uses.iter().collect();
    by_patch.sort_by_key(|u| u.patch);
    let (mut open, mut early) = (Vec::new(), Vec::new());
    for own in by_patch.chunk_by(|a, b| a.patch == b.patch) {
        if own.len() < 2 {
            continue;
        }
        let opens_up = own.len() > 2 && is_inside_out(own[0].patch);
        open.clear();
        early.clear();
        for u in own {
            if u.up == opens_up {
                open.push(u.corner);
            } else if let Some(o) = open.pop() {
                pair(mates, (o, u.corner));
            } else {
                early.push(u.corner);
            }
        }
        // What was closed before it was opened: the circle has no beginning.
        for &c in &early {
            if let Some(o) = open.pop() {
                pair(mates, (o, c));
            }
        }
    }
}

/// Pairs of uses that belong to two patches: all of them at most edges, neighbours around the edge where very many
/// faces meet.
fn candidates(uses: &[Use]) -> impl Iterator<Item = Candidate> + '_ {
    const FEW: usize = 8;
    let n = uses.len();
    let reach = if n <= FEW { n / 2 } else { 1 };
    let pairs = (0..n).flat_map(move |i| (1..=reach).map(move |k| (i, (i + k) % n)));
    // With an even number, opposite uses come up twice.
    let once = pairs.filter(move |&(i, j)| i < j || (j + n - i) % n * 2 != n);
    once.map(|(i, j)| (&uses[i], &uses[j])).filter(|(a, b)| a.patch != b.patch).map(|(a, b)| candidate(a, b))
}

fn candidate(a: &Use, b: &Use) -> Candidate {
    let (a, b) = if (a.patch, a.corner) <= (b.patch, b.corner) { (a, b) } else { (b, a) };
    let turn = (b.angle - a.angle).rem_euclid(TAU);
    Candidate {
        patches: (a.patch, b.patch),
        reversed: a.up == b.up,
        bend: (turn - PI).abs(),
        uses: (a.corner, b.corner),
    }
}

/// The candidates of patches that close each other, by patches and parity, the flattest first. `open` is the number of
/// unpaired corners of each patch.
fn closing_groups(mut all: Vec<Candidate>, open: &[u32]) -> Vec<Vec<Candidate>> {
    all.sort_by_key(|c| (c.patches, c.reversed, c.uses));
    let closes = |group: &[Candidate]| {
        let (a, b) = group[0].patches;
        let distinct = |use_of: fn(&Candidate) -> u32| {
            let mut corners: Vec<u32> = group.iter().map(use_of).collect();
            corners.sort_unstable();
            corners.dedup();
            corners.len() as u32
        };
        distinct(|c| c.uses.0) == open[a as usize] && distinct(|c| c.uses.1) == open[b as usize]
    };
    let bend = |group: &[Candidate]| group.iter().map(|c| c.bend).sum::<f64>() / group.len() as f64;
    let groups = all.chunk_by(|a, b| (a.patches, a.reversed) == (b.patches, b.reversed));
    let mut closing: Vec<(f64, Vec<Candidate>)> =
        groups.filter(|g| closes(g)).map(|g| (bend(g), g.to_vec())).collect();
    closing.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1[0].patches.cmp(&b.1[0].patches)));
    closing.into_iter().map(|g| g.1).collect()
}

/// Pairs what is left at one edge, the flattest pairs first; then again what has become neighbours.
fn pair_by_angle(uses: &[Use], mates: &mut [u32], parity: &mut Parity) {
    // Two or three rounds do on any edge from life; a file made to need a round per pair is left with boundary.
    const ROUNDS: usize = 32;
    for _ in 0..ROUNDS {
        let free: Vec<Use> = uses.iter().copied().filter(|u| mates[u.corner as usize] == NONE).collect();
        let mut choices: Vec<Candidate> = candidates(&free).collect();
        choices.sort_by(|a, b| a.bend.total_cmp(&b.bend).then(a.uses.cmp(&b.uses)));
        let mut any = false;
        for c in choices {
            if parity.agrees(c.patches, c.reversed) && pair(mates, c.uses) {
                parity.join(c.patches, c.reversed);
                any = true;
            }
        }
        if !any {
            return;
        }
    }
}

/// Sets of patches with, for each patch, whether it is reversed against its root.
struct Parity {
    parent: Vec<u32>,
    odd: Vec<bool>,
}

impl Parity {
    fn new(count: usize) -> Self {
        Self { parent: (0..count as u32).collect(), odd: vec![false; count] }
    }

    fn root(&mut self, mut i: u32) -> (u32, bool) {
        let mut odd = false;
        while self.parent[i as usize] != i {
            let p = self.parent[i as usize] as usize;
            // Halve the path.
            self.odd[i as usize] ^= self.odd[p];
            self.parent[i as usize] = self.parent[p];
            odd ^= self.odd[i as usize];
            i = self.parent[i as usize];
        }
        (i, odd)
    }

    /// Whether the pairing contradicts none so far.
    fn agrees(&mut self, (a, b): (u32, u32), reversed: bool) -> bool {
        let ((a, a_odd), (b, b_odd)) = (self.root(a), self.root(b));
        a != b || (a_odd ^ b_odd) == reversed
    }

    fn join(&mut self, (a, b): (u32, u32), reversed: bool) {
        let ((a, a_odd), (b, b_odd)) = (self.root(a), self.root(b));
        if a != b {
            self.parent[a.max(b) as usize] = a.min(b);
            self.odd[a.max(b) as usize] = a_odd ^ b_odd ^ reversed;
        }
    }
}
