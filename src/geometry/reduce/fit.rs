//! The last step: vertices move along their normals to fit the vertices that are gone.
//!
//! Every vertex of the original knows the one that it went into. It lies above or below one of the triangles there; the
//! heights, weighted by how much each corner has to do with the place, are the right side of a least-squares problem for
//! shifts along the normals, of which the diagonal alone is solved.

use super::HEAVY;
use super::copy::Copy;
use super::features::Hold;
use crate::Mesh;
use crate::matching::NONE;
use glam::DVec3;

/// A triangle at a vertex, ready to find where points lie over it.
struct Fan {
    /// Products with these, of the vector from the vertex, give the weights of the second and third corner.
    second: DVec3,
    third: DVec3,
    normal: DVec3,
    /// One over twice the area.
    size: f64,
    corners: [u32; 3],
}

impl Fan {
    /// The weights of the corners and the height over the triangle.
    fn locate(&self, p: DVec3) -> ([f64; 3], f64) {
        let (second, third) = (p.dot(self.second), p.dot(self.third));
        ([1.0 - second - third, second, third], p.dot(self.normal))
    }
}

/// What the samples at a vertex ask for.
#[derive(Clone, Copy, Default)]
struct Wish {
    sum: f64,
    weight: f64,
}

/// Lists by vertex.
struct Lists {
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl Lists {
    fn new(count: usize, pairs: impl Iterator<Item = (u32, u32)> + Clone) -> Self {
        let mut starts = vec![0u32; count + 1];
        pairs.clone().for_each(|(at, _)| starts[at as usize + 1] += 1);
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut next = starts.clone();
        let mut items = vec![0; starts[count] as usize];
        for (at, item) in pairs {
            let place = &mut next[at as usize];
            items[*place as usize] = item;
            *place += 1;
        }
        Self { starts, items }
    }

    fn at(&self, i: usize) -> &[u32] {
        &self.items[self.starts[i] as usize..self.starts[i + 1] as usize]
    }
}

impl Copy {
    /// Fits the vertices that may move to the original ones, whose positions the mesh still has.
    pub(super) fn fit(&mut self, mesh: &Mesh) {
        let count = self.vertices.len();
        // Left vertices in order, and for each the samples and the half-edges of its triangles.
        let roots: Vec<u32> = (0..count as u32).map(|v| self.root(v)).collect();
        let live: Vec<u32> = (0..count as u32).filter(|&v| roots[v as usize] == v).collect();
        let mut number = vec![NONE; count];
        (0..).zip(&live).for_each(|(i, &v)| number[v as usize] = i);
        let samples = Lists::new(live.len(), roots.iter().zip(0..).map(|(&r, v)| (number[r as usize], v)));
        let outgoing: Vec<[u32; 3]> = self.triangles().collect();
        let corner = |&h: &u32| (number[self.origin(h) as usize], h);
        let fans = Lists::new(live.len(), outgoing.iter().flatten().map(corner));

        let areas: Vec<DVec3> = (0..live.len()).map(|i| fans.at(i).iter().map(|&h| self.double_area(h)).sum()).collect();
        let normals: Vec<DVec3> = areas.iter().map(|a| a.normalize_or_zero()).collect();
        let mut wishes = vec![Wish::default(); live.len()];
        let mut around: Vec<Fan> = Vec::new();
        for (i, &v) in live.iter().enumerate() {
            if samples.at(i).len() < 2 || fans.at(i).len() > HEAVY as usize {
                continue;
            }
            around.clear();
            around.extend(fans.at(i).iter().filter_map(|&h| self.fan(h, &number)));
            for &sample in samples.at(i) {
                let slot = self.vertex_slot[sample as usize] as usize;
                let p = self.frame.local(mesh.positions[slot]) - self.vertex(v).position;
                if let Some((fan, weights, height)) = nearest(&around, p) {
                    let facing = fan.corners.map(|k| normals[k as usize].dot(fan.normal));
                    let total: f64 = weights.iter().zip(facing).map(|(w, f)| w * f).sum();
                    for k in 0..3 {
                        let share = weights[k] * facing[k];
                        let wish = &mut wishes[fan.corners[k] as usize];
                        wish.sum += share * height;
                        wish.weight += share * total;
                    }
                }
            }
        }
        for (i, &v) in live.iter().enumerate() {
            let (wish, vertex) = (wishes[i], self.vertex(v));
            if wish.weight <= 1e-3 || vertex.hold != Hold::Free || !vertex.is_moved {
                continue;
            }
            let limit = 0.2 * areas[i].length().sqrt();
            let shift = normals[i] * (wish.sum / wish.weight).clamp(-limit, limit);
            if fans.at(i).iter().all(|&h| self.stays_in_order(h, shift, normals[i])) {
                self.vertices[v as usize].position += shift;
            }
        }
    }

    /// The sides of the triangle of a half-edge, from its origin.
    fn sides(&self, h: u32) -> [DVec3; 2] {
        let at = self.vertex(self.origin(h)).position;
        [self.next(h), self.prev(h)].map(|h| self.vertex(self.origin(h)).position - at)
    }

    fn double_area(&self, h: u32) -> DVec3 {
        let [u, v] = self.sides(h);
        u.cross(v)
    }

    fn fan(&self, h: u32, number: &[u32]) -> Option<Fan> {
        let [u, v] = self.sides(h);
        let area = u.cross(v);
        let square = area.length_squared();
        let corners = [h, self.next(h), self.prev(h)].map(|h| number[self.origin(h) as usize]);
        let size = 1.0 / square.sqrt();
        let fan =
            Fan { second: v.cross(area) / square, third: area.cross(u) / square, normal: area * size, size, corners };
        (square > 0.0 && fan.second.is_finite() && fan.third.is_finite()).then_some(fan)
    }

    /// Whether a triangle faces along the normal of its corner, and shifting that turns it little.
    fn stays_in_order(&self, h: u32, shift: DVec3, normal: DVec3) -> bool {
        let [u, v] = self.sides(h);
        let (before, after) = (u.cross(v), (u - shift).cross(v - shift));
        let (along, turn) = (before.dot(normal), before.dot(after));
        let square = before.length_squared();
        along > 0.0
            && along * along > 0.9 * square
            && turn > 0.0
            && turn * turn > 0.8 * square * after.length_squared()
    }
}

/// The triangle that a point lies over, with its weights there and its height: the lowest of those it lies over, or the
/// one it is least outside of, unless it is far from all.
fn nearest(fans: &[Fan], p: DVec3) -> Option<(&Fan, [f64; 3], f64)> {
    let mut best: Option<(&Fan, [f64; 3], f64, f64)> = None;
    for fan in fans {
        let (weights, height) = fan.locate(p);
        let inside = weights[0].min(weights[1]).min(weights[2]);
        let better = match best {
            None => true,
            Some((.., best_height, best_inside)) if inside >= 0.0 && best_inside >= 0.0 => {
                height.abs() < f64::abs(best_height)
            }
            Some((.., best_inside)) => inside > best_inside && best_inside < 0.0,
        };
        if better {
            best = Some((fan, weights, height, inside));
        }
        if inside >= 0.0 && height * height * fan.size < 0.02 {
            break;
        }
    }
    let (fan, weights, height, inside) = best?;
    if inside < -0.5 || height * height * fan.size > 0.25 {
        return None;
    }
    let weights = weights.map(|w| w.clamp(0.0, 1.0));
    let sum: f64 = weights.iter().sum();
    Some((fan, weights.map(|w| w / sum), height))
}
