//! Loops that lie around one hole: a boundary within the hole of another.

use crate::Mesh;
use crate::geometry::direction;
use crate::geometry::normals::double_area_vector;
use glam::{DVec2, DVec3};

/// So many corners of an inner loop are looked for in the outer one.
const SAMPLES: usize = 8;

/// Area vectors of an outer and an inner loop enclose at least the angle with this cosine.
const AGAINST: f64 = -0.5;

/// So many steps along outer loops are taken in all, and a pair of loops counts as [`PAIR`]: a second or two. Tens of
/// thousands of holes within a loop of tens of thousands of edges need no more; what is left after that is taken to lie
/// beside each other, and counted.
const STEPS: usize = 1 << 29;
const PAIR: usize = 16;

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

    /// The axes of the plane across the area vector, through the center.
    fn axes(&self) -> [DVec3; 2] {
        let (x, y) = self.normal.any_orthonormal_pair();
        [x, y]
    }

    /// The corners as they are seen along the area vector.
    fn flat(&self, mesh: &Mesh, scale: f64) -> Flat {
        let axes = self.axes();
        let points: Vec<DVec2> =
            mesh.loop_slots(self.first).map(|h| seen(mesh.at(h) * scale - self.center, axes)).collect();
        let far = DVec2::splat(f64::INFINITY);
        let min = points.iter().copied().fold(far, DVec2::min);
        let max = points.iter().copied().fold(-far, DVec2::max);
        Flat { axes, points, min, max }
    }

    /// Whether the other one may lie within the hole, not deeper than `depth` sizes: it faces the other way.
    fn may_hold(&self, other: &Self, mesh: &Mesh, scale: f64, depth: f64) -> bool {
        let deep = |p: DVec3| (p - self.center).dot(self.normal).abs() > depth * self.size;
        self.normal.dot(other.normal) <= AGAINST
            && other.size < self.size
            && !mesh.loop_slots(other.first).any(|h| deep(mesh.at(h) * scale))
    }

    /// Whether corners of the other one lie inside when looked at along the area vector. `steps` is spent.
    fn holds(&self, flat: &Flat, other: &Self, mesh: &Mesh, scale: f64, steps: &mut usize) -> bool {
        mesh.loop_slots(other.first).step_by(other.count.div_ceil(SAMPLES)).all(|h| {
            let p = seen(mesh.at(h) * scale - self.center, flat.axes);
            if p.cmplt(flat.min).any() || p.cmpgt(flat.max).any() {
                return false;
            }
            let left = steps.checked_sub(flat.points.len());
            *steps = left.unwrap_or(0);
            left.is_some() && flat.is_inside(p)
        })
    }
}

/// A loop seen along its area vector.
struct Flat {
    axes: [DVec3; 2],
    points: Vec<DVec2>,
    min: DVec2,
    max: DVec2,
}

fn seen(p: DVec3, [x, y]: [DVec3; 2]) -> DVec2 {
    DVec2::new(p.dot(x), p.dot(y))
}

impl Flat {
    /// Whether a line from the point to the right crosses the outline an odd number of times.
    fn is_inside(&self, p: DVec2) -> bool {
        let Some(&last) = self.points.last() else { return false };
        let (mut before, mut inside) = (last, false);
        for &here in &self.points {
            if (before.y > p.y) != (here.y > p.y) {
                let share = (p.y - before.y) / (here.y - before.y);
                inside ^= before.x + share * (here.x - before.x) > p.x;
            }
            before = here;
        }
        inside
    }
}

/// Groups of two and more loops around one hole, each sorted, in the order of their first loops. `is_outer` says which loops
/// may have others within. Loops are numbered as they are given by their first half-edges.
///
/// O(n log n) for the loops, and each is compared with those that begin within its box; in [`STEPS`] at most. Also the number of
/// loops that were not compared with all.
pub(super) fn shared(
    mesh: &Mesh,
    loops: &[u32],
    scale: f64,
    depth: f64,
    is_outer: impl Fn(usize) -> bool,
) -> (Vec<Vec<usize>>, usize) {
    let outlines: Vec<Outline> = loops.iter().map(|&first| Outline::of(mesh, first, scale)).collect();
    let begins: Vec<DVec3> = loops.iter().map(|&h| mesh.at(h) * scale).collect();
    let far = DVec3::splat(f64::INFINITY);
    let extent = begins.iter().fold(-far, |m, &p| m.max(p)) - begins.iter().fold(far, |m, &p| m.min(p));
    // Along the axis on which they are spread most, fewest lie beside each other.
    let axis = (1..3).fold(0, |best, i| if extent[i] > extent[best] { i } else { best });
    let mut order: Vec<usize> = (0..loops.len()).collect();
    order.sort_unstable_by(|&a, &b| begins[a][axis].total_cmp(&begins[b][axis]).then(a.cmp(&b)));

    let mut group: Vec<usize> = (0..loops.len()).collect();
    let (mut steps, mut unsearched) = (STEPS, 0);
    for (a, outer) in outlines.iter().enumerate() {
        if outer.normal == DVec3::ZERO || !is_outer(a) {
            continue;
        }
        let slack = DVec3::splat(depth * outer.size);
        let (min, max) = (outer.min - slack, outer.max + slack);
        let start = order.partition_point(|&b| begins[b][axis] < min[axis]);
        let mut flat = None;
        for &b in order[start..].iter().take_while(|&&b| begins[b][axis] <= max[axis]) {
            steps = steps.saturating_sub(PAIR);
            if steps == 0 {
                unsearched += 1;
                break;
            }
            let is_near = begins[b].cmpge(min).all() && begins[b].cmple(max).all();
            if a == b || !is_near || !outer.may_hold(&outlines[b], mesh, scale, depth) {
                continue;
            }
            let flat = flat.get_or_insert_with(|| outer.flat(mesh, scale));
            if outer.holds(flat, &outlines[b], mesh, scale, &mut steps) {
                let (a, b) = (root(&mut group, a), root(&mut group, b));
                group[a.max(b)] = a.min(b);
            }
        }
    }
    let mut pairs: Vec<(usize, usize)> = (0..loops.len()).map(|i| (root(&mut group, i), i)).collect();
    pairs.sort_unstable();
    let chunks = pairs.chunk_by(|a, b| a.0 == b.0).filter(|c| c.len() > 1);
    (chunks.map(|c| c.iter().map(|p| p.1).collect()).collect(), unsearched)
}

fn root(group: &mut [usize], mut i: usize) -> usize {
    while group[i] != i {
        group[i] = group[group[i]];
        i = group[i];
    }
    i
}
