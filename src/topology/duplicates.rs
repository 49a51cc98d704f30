//! Faces that are there twice.

use crate::Polygons;
use crate::matching::{Matching, NONE};

/// `(face, earliest face with the same corner cycle in either direction)`, ascending by face.
///
/// Equal cycles share the edge from their lowest vertex to the lower of its two neighbours, so only faces that meet
/// there are compared: none on a mesh without duplicates, but for chance.
pub(crate) fn duplicate_faces(polygons: &Polygons, matching: &Matching) -> Vec<(u32, u32)> {
    let mut owner = vec![NONE; matching.edges.len()];
    let mut candidates: Vec<(u32, u32)> = Vec::new();
    let lowest_edge = |f: usize| {
        let start = polygons.starts()[f];
        let low = Cycle::of(&polygons[f]);
        // Downwards, the edge to the lower neighbour belongs to the corner before.
        let corner = if low.down { (low.at + low.corners.len() - 1) % low.corners.len() } else { low.at };
        matching.edge_of(start + corner)
    };
    for f in 0..polygons.len() {
        let slot = &mut owner[lowest_edge(f)];
        match *slot {
            NONE => *slot = f as u32,
            _ => candidates.push((lowest_edge(f) as u32, f as u32)),
        }
    }
    let edges: Vec<u32> = candidates.iter().map(|c| c.0).collect();
    candidates.extend(edges.iter().map(|&e| (e, owner[e as usize])));
    candidates.sort_unstable();
    candidates.dedup();

    let mut found = Vec::new();
    for group in candidates.chunk_by_mut(|a, b| a.0 == b.0) {
        let cycle = |f: u32| Cycle::of(&polygons[f as usize]);
        group.sort_unstable_by(|a, b| cycle(a.1).iter().cmp(cycle(b.1).iter()).then(a.1.cmp(&b.1)));
        for same in group.chunk_by(|a, b| cycle(a.1).iter().eq(cycle(b.1).iter())) {
            found.extend(same[1..].iter().map(|again| (again.1, same[0].1)));
        }
    }
    found.sort_unstable();
    found
}

/// A corner cycle read from its lowest vertex towards the lower of that vertex's neighbours: equal for equal cycles,
/// whatever their first corner and direction. Corners must be distinct.
pub(crate) struct Cycle<'a> {
    corners: &'a [u32],
    at: usize,
    down: bool,
}

impl<'a> Cycle<'a> {
    pub(crate) fn of(corners: &'a [u32]) -> Self {
        Self::by(corners, |v| v)
    }

    /// Low by what stands for a vertex in some order.
    pub(crate) fn by(corners: &'a [u32], order: impl Fn(u32) -> u32) -> Self {
        let n = corners.len();
        let at = (0..n).min_by_key(|&i| order(corners[i])).unwrap_or(0);
        let down = n > 0 && order(corners[(at + n - 1) % n]) < order(corners[(at + 1) % n]);
        Self { corners, at, down }
    }

    /// Whether the cycle is read against the direction in which it is stored.
    pub(crate) fn is_reversed(&self) -> bool {
        self.down
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = u32> + use<'a> {
        let (corners, at, down, n) = (self.corners, self.at, self.down, self.corners.len());
        (0..n).map(move |i| corners[(at + if down { n - i } else { i }) % n])
    }
}
