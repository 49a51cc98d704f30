//! Where vertices go: positions of a finer level in the order old vertices, edges, faces with a centre.

use super::dense::Dense;
use crate::matching::NONE;
use glam::DVec3;

/// Room for a level, with `lead` entries that mean nothing and the old positions in front.
fn room(dense: &Dense, centers: usize, lead: usize) -> Vec<DVec3> {
    let mut positions = Vec::with_capacity(lead + dense.positions.len() + dense.edges + centers);
    positions.resize(lead, DVec3::ZERO);
    positions.extend_from_slice(&dense.positions);
    positions
}

fn mean(dense: &Dense, face: &[u32]) -> DVec3 {
    face.iter().map(|&v| dense.positions[v as usize]).sum::<DVec3>() / face.len() as f64
}

/// Calls `f` with every edge's two ends, as its first use runs along it, in the order of edges' first uses by corner.
fn for_each_edge(dense: &Dense, mut f: impl FnMut(usize, u32, u32)) {
    let mut c = 0;
    for face in dense.polygons.iter() {
        for (i, &a) in face.iter().enumerate() {
            let u = dense.use_of[c];
            c += 1;
            if u & 1 == 0 {
                f(u as usize >> 1, a, face[if i + 1 == face.len() { 0 } else { i + 1 }]);
            }
        }
    }
}

/// Edges in the middle, large faces at their mean.
pub(super) fn midpoint(dense: &Dense, lead: usize) -> Vec<DVec3> {
    let large = dense.polygons.iter().filter(|f| f.len() > 3);
    let mut positions = room(dense, large.clone().count(), lead);
    let old = positions.len();
    positions.resize(old + dense.edges, DVec3::ZERO);
    for_each_edge(dense, |e, a, b| {
        positions[old + e] = (dense.positions[a as usize] + dense.positions[b as usize]) * 0.5;
    });
    positions.extend(large.map(|f| mean(dense, f)));
    positions
}

/// What surrounds a vertex.
#[derive(Clone, Copy)]
struct Ring {
    /// The sum of its neighbours, or of those across sharp edges if there are two.
    sum: DVec3,
    count: u32,
    /// How many sharp or boundary edges end here.
    sharp: u32,
}

/// The rings of all vertices. In the first pass neighbours are summed; vertices with sharp edges then start afresh.
fn rings(dense: &Dense) -> Vec<Ring> {
    let mut rings = vec![Ring { sum: DVec3::ZERO, count: 0, sharp: 0 }; dense.positions.len()];
    for_each_edge(dense, |_, a, b| {
        for (a, b) in [(a, b), (b, a)] {
            let ring = &mut rings[a as usize];
            ring.sum += dense.positions[b as usize];
            ring.count += 1;
        }
    });
    if dense.open.is_empty() && dense.creases.is_empty() {
        return rings;
    }
    let mut sharp = dense.creases.clone();
    sharp.resize(dense.edges, false);
    dense.open.iter().for_each(|&e| sharp[e as usize] = true);
    let mut sums = vec![DVec3::ZERO; rings.len()];
    for_each_edge(dense, |e, a, b| {
        if sharp[e] {
            for (a, b) in [(a, b), (b, a)] {
                rings[a as usize].sharp += 1;
                sums[a as usize] += dense.positions[b as usize];
            }
        }
    });
    for (ring, sum) in rings.iter_mut().zip(sums) {
        if ring.sharp == 2 {
            ring.sum = sum;
        }
    }
    rings
}

/// Moves the old vertices: smooth ones by `smooth`, along a crease by the cubic spline's rule; corners stay.
fn move_old(dense: &Dense, rings: &[Ring], positions: &mut [DVec3], smooth: impl Fn(usize, &Ring) -> DVec3) {
    for (v, ring) in rings.iter().enumerate() {
        let stays = ring.count == 0 || ring.sharp > 2 || dense.corners.get(v) == Some(&true);
        if !stays {
            positions[v] = match ring.sharp {
                2 => dense.positions[v] * 0.75 + ring.sum * 0.125,
                _ => smooth(v, ring),
            };
        }
    }
}

/// Whether an edge is cut in its middle.
fn is_sharp(dense: &Dense, e: usize, second: u32) -> bool {
    second == NONE || dense.creases.get(e) == Some(&true)
}

/// Loop's scheme with Warren's weights; all faces are triangles.
pub(super) fn loop_(dense: &Dense, lead: usize) -> Vec<DVec3> {
    let mut positions = room(dense, 0, lead);
    let corners = dense.polygons.corners();
    let at = |c: usize| dense.positions[corners[c] as usize];
    let around = |c: u32| {
        let (c, turn) = (c as usize, c as usize % 3);
        let first = c - turn;
        [c, first + (turn + 1) % 3, first + (turn + 2) % 3].map(at)
    };
    for (e, &[first, second]) in dense.corners_of_edges().iter().enumerate() {
        let [a, b, c] = around(first);
        positions.push(if is_sharp(dense, e, second) {
            (a + b) * 0.5
        } else {
            let [_, _, d] = around(second);
            (a + b) * 0.375 + (c + d) * 0.125
        });
    }
    let rings = rings(dense);
    move_old(dense, &rings, &mut positions[lead..], |v, ring| {
        let n = f64::from(ring.count);
        let beta = if ring.count == 3 { 3.0 / 16.0 } else { 3.0 / (8.0 * n) };
        dense.positions[v] * (1.0 - n * beta) + ring.sum * beta
    });
    positions
}

/// Catmull and Clark's scheme.
pub(super) fn catmull_clark(dense: &Dense, lead: usize) -> Vec<DVec3> {
    let mut positions = room(dense, dense.polygons.len(), lead);
    let old = positions.len();
    positions.resize(old + dense.edges, DVec3::ZERO);
    positions.extend(dense.polygons.iter().map(|f| mean(dense, f)));
    let (moved, centers) = positions.split_at_mut(old + dense.edges);
    let (moved, middles) = moved.split_at_mut(old);
    let moved = &mut moved[lead..];
    // The centres on both sides of each edge, and around each vertex.
    let mut around = vec![DVec3::ZERO; moved.len()];
    let mut c = 0;
    for (face, &center) in dense.polygons.iter().zip(&*centers) {
        for &v in face {
            middles[dense.use_of[c] as usize >> 1] += center;
            around[v as usize] += center;
            c += 1;
        }
    }
    let mut sharp = dense.creases.clone();
    sharp.resize(dense.edges, false);
    dense.open.iter().for_each(|&e| sharp[e as usize] = true);
    for_each_edge(dense, |e, a, b| {
        let ends = dense.positions[a as usize] + dense.positions[b as usize];
        middles[e] = if sharp[e] { ends * 0.5 } else { (ends + middles[e]) * 0.25 };
    });
    let rings = rings(dense);
    move_old(dense, &rings, moved, |v, ring| {
        // With Q the mean of the centres and R that of the edges' middles: (Q + 2 R + (n - 3) v) / n.
        let n = f64::from(ring.count);
        ((around[v] + ring.sum) / n + dense.positions[v] * (n - 2.0)) / n
    });
    positions
}
