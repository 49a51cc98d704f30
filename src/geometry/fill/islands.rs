//! Loops that lie around one hole: a boundary within the hole of another.

use crate::Mesh;
use crate::geometry::direction;
use crate::geometry::normals::double_area_vector;
use glam::{DVec2, DVec3};

/// So many corners of an inner loop are looked for in the outer one.
const SAMPLES: usize = 8;

/// Area vectors of an outer and an inner loop enclose at least the angle with this cosine.
const AGAINST: f64 = -0.5;

/// A loop as a plane figure.
struct Outline {
    first: u32,
    /// Half-edges.
    count: usize,
    center: DVec3,
    /// Of unit length, or zero.
    normal: DVec3,
    /// The root of its area.
    size: f64,
    min: DVec3,
    max: DVec3,
}

impl Outline {
    fn of(mesh: &Mesh, first: u32, scale: f64) -> Self {
        let points = || mesh.loop_slots(first).map(|h| mesh.at(h) * scale);
        let count = points().count();
        let double = double_area_vector(points());
        let far = DVec3::splat(f64::INFINITY);
        Self {
            first,
            count,
            center: points().sum::<DVec3>() / count as f64,
            normal: direction(double),
            size: (0.5 * double.length()).sqrt(),
            min: points().fold(far, DVec3::min),
            max: points().fold(-far, DVec3::max),
        }
    }

    /// Whether the other one lies within the hole, not deeper than `depth` sizes: it faces the other way, and its corners
    /// lie inside when looked at along the area vector.
    fn holds(&self, other: &Self, mesh: &Mesh, scale: f64, depth: f64) -> bool {
        if self.normal.dot(other.normal) > AGAINST || other.size >= self.size {
            return false;
        }
        let deep = |p: DVec3| (p - self.center).dot(self.normal).abs() > depth * self.size;
        if mesh.loop_slots(other.first).any(|h| deep(mesh.at(h) * scale)) {
            return false;
        }
        let (x, y) = self.normal.any_orthonormal_pair();
        let flat = |h: u32| {
            let p = mesh.at(h) * scale - self.center;
            DVec2::new(p.dot(x), p.dot(y))
        };
        mesh.loop_slots(other.first).step_by(other.count.div_ceil(SAMPLES)).all(|h| {
            let p = flat(h);
            // A line from the point to the right crosses the outline an odd number of times.
            let mut before = flat(mesh.prev[self.first as usize]);
            let mut inside = false;
            for h in mesh.loop_slots(self.first) {
                let here = flat(h);
                if (before.y > p.y) != (here.y > p.y) {
                    let share = (p.y - before.y) / (here.y - before.y);
                    inside ^= before.x + share * (here.x - before.x) > p.x;
                }
                before = here;
            }
            inside
        })
    }
}

/// Groups of two and more loops around one hole, each sorted, in the order of their first loops. `is_outer` says which loops
/// may have others within. Loops are numbered as they are given by their first half-edges.
///
/// O(n log n) for the loops, and each is compared with those that begin within its box.
pub(super) fn shared(
    mesh: &Mesh,
    loops: &[u32],
    scale: f64,
    depth: f64,
    is_outer: impl Fn(usize) -> bool,
) -> Vec<Vec<usize>> {
    let outlines: Vec<Outline> = loops.iter().map(|&first| Outline::of(mesh, first, scale)).collect();
    let begins: Vec<DVec3> = loops.iter().map(|&h| mesh.at(h) * scale).collect();
    let far = DVec3::splat(f64::INFINITY);
    let extent = begins.iter().fold(-far, |m, &p| m.max(p)) - begins.iter().fold(far, |m, &p| m.min(p));
    // Along the axis on which they are spread most, fewest lie beside each other.
    let axis = (1..3).fold(0, |best, i| if extent[i] > extent[best] { i } else { best });
    let mut order: Vec<usize> = (0..loops.len()).collect();
    order.sort_unstable_by(|&a, &b| begins[a][axis].total_cmp(&begins[b][axis]).then(a.cmp(&b)));

    let mut group: Vec<usize> = (0..loops.len()).collect();
    for (a, outer) in outlines.iter().enumerate() {
        if outer.normal == DVec3::ZERO || !is_outer(a) {
            continue;
        }
        let slack = DVec3::splat(depth * outer.size);
        let (min, max) = (outer.min - slack, outer.max + slack);
        let start = order.partition_point(|&b| begins[b][axis] < min[axis]);
        for &b in order[start..].iter().take_while(|&&b| begins[b][axis] <= max[axis]) {
            let is_near = begins[b].cmpge(min).all() && begins[b].cmple(max).all();
            if a != b && is_near && outer.holds(&outlines[b], mesh, scale, depth) {
                let (a, b) = (root(&mut group, a), root(&mut group, b));
                group[a.max(b)] = a.min(b);
            }
        }
    }
    let mut pairs: Vec<(usize, usize)> = (0..loops.len()).map(|i| (root(&mut group, i), i)).collect();
    pairs.sort_unstable();
    let chunks = pairs.chunk_by(|a, b| a.0 == b.0).filter(|c| c.len() > 1);
    chunks.map(|c| c.iter().map(|p| p.1).collect()).collect()
}

fn root(group: &mut [usize], mut i: usize) -> usize {
    while group[i] != i {
        group[i] = group[group[i]];
        i = group[i];
    }
    i
}
