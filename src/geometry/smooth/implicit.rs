//! A step of backward Euler, solved by conjugate gradients.

use super::SmoothError;
use super::weights::Apexes;
use crate::{Cancelled, Mesh};
use glam::DVec3;

/// When a solution counts.
#[derive(Clone, Copy)]
pub(super) struct Goal {
    /// The residual, as a share of that at the start.
    pub(super) tolerance: f64,
    pub(super) max_steps: u32,
}

/// Moves the free vertices to where `(M + lambda (M - W)) x = M x0`: `W` the weights of edges, `M` their sum at each
/// vertex. The matrix is symmetric and, for any `lambda`, diagonally dominant, so the means are weighted and stay in the
/// hull of what is there. Sums are in the order of slots.
pub(super) fn step(
    mesh: &Mesh,
    now: &mut [DVec3],
    is_free: &[bool],
    apexes: Option<&Apexes>,
    lambda: f64,
    goal: Goal,
    tick: &mut dyn FnMut(f64) -> Result<(), Cancelled>,
) -> Result<(), SmoothError> {
    tick(0.0)?;
    let system = System::new(mesh, now, is_free, apexes, lambda);
    if system.mass.iter().any(|mass| !(mass * (1.0 + lambda)).is_finite()) {
        // Beyond numbers.
        return Err(SmoothError::NotConverged { residual: 1.0 });
    }
    let mut product = vec![DVec3::ZERO; now.len()];
    system.apply(now, &mut product);
    let mut residual: Vec<DVec3> = (0..now.len()).map(|v| now[v] * system.mass[v] - product[v]).collect();
    system.clear_fixed(&mut residual);
    let start = squared(&residual);
    if start == 0.0 {
        return Ok(());
    }
    let solved = goal.tolerance * goal.tolerance;
    let scaled = |residual: &[DVec3]| -> Vec<DVec3> {
        residual.iter().zip(&system.inverse).map(|(&r, &d)| r * d).collect()
    };
    let mut along = scaled(&residual);
    let mut energy = dot(&residual, &along);
    let (mut left, mut furthest) = (1.0, 0.0f64);
    for _ in 0..goal.max_steps {
        system.apply(&along, &mut product);
        system.clear_fixed(&mut product);
        let length = ratio(energy, dot(&along, &product));
        for v in 0..now.len() {
            now[v] += along[v] * length;
            residual[v] -= product[v] * length;
        }
        left = squared(&residual) / start;
        if left <= solved {
            return Ok(());
        }
        if !left.is_finite() {
            break;
        }
        let preconditioned = scaled(&residual);
        let next = dot(&residual, &preconditioned);
        let turn = ratio(next, energy);
        energy = next;
        along.iter_mut().zip(preconditioned).for_each(|(p, z)| *p = z + *p * turn);
        // Digits won, of those wanted.
        furthest = furthest.max((left.ln() / solved.ln()).clamp(0.0, 1.0));
        tick(furthest)?;
    }
    Err(SmoothError::NotConverged { residual: left.sqrt() })
}

struct System {
    ends: Vec<([u32; 2], f64)>,
    /// The sum of weights at each vertex.
    mass: Vec<f64>,
    /// One over the diagonal; zero for vertices that do not move.
    inverse: Vec<f64>,
    lambda: f64,
}

impl System {
    fn new(mesh: &Mesh, at: &[DVec3], is_free: &[bool], apexes: Option<&Apexes>, lambda: f64) -> Self {
        let mut mass = vec![0.0; at.len()];
        let mut ends = Vec::with_capacity(mesh.edge_count());
        for e in mesh.edges.live() {
            let [a, b] = [2 * e, 2 * e + 1].map(|h| mesh.origin[h as usize]);
            let weight = apexes.map_or(1.0, |apexes| apexes.weight(mesh, at, e));
            if weight > 0.0 {
                mass[a as usize] += weight;
                mass[b as usize] += weight;
                ends.push(([a, b], weight));
            }
        }
        let of = |(&mass, &is_free): (&f64, &bool)| {
            let inverse = 1.0 / (mass * (1.0 + lambda));
            if is_free && inverse.is_finite() { inverse } else { 0.0 }
        };
        let inverse = mass.iter().zip(is_free).map(of).collect();
        Self { ends, mass, inverse, lambda }
    }

    /// The matrix times a vector.
    fn apply(&self, x: &[DVec3], product: &mut [DVec3]) {
        for ((product, &x), &mass) in product.iter_mut().zip(x).zip(&self.mass) {
            *product = x * (mass * (1.0 + self.lambda));
        }
        for &([a, b], weight) in &self.ends {
            let (a, b, weight) = (a as usize, b as usize, weight * self.lambda);
            product[a] -= x[b] * weight;
            product[b] -= x[a] * weight;
        }
    }

    /// Vertices that do not move have no equation.
    fn clear_fixed(&self, rows: &mut [DVec3]) {
        for (row, _) in rows.iter_mut().zip(&self.inverse).filter(|(_, d)| **d == 0.0) {
            *row = DVec3::ZERO;
        }
    }
}

/// For each coordinate by itself.
fn dot(a: &[DVec3], b: &[DVec3]) -> DVec3 {
    a.iter().zip(b).fold(DVec3::ZERO, |sum, (&a, &b)| sum + a * b)
}

fn squared(a: &[DVec3]) -> f64 {
    dot(a, a).element_sum()
}

/// Zero where there is nothing left.
fn ratio(a: DVec3, b: DVec3) -> DVec3 {
    let of = |a: f64, b: f64| if a == 0.0 { 0.0 } else { a / b };
    DVec3::new(of(a.x, b.x), of(a.y, b.y), of(a.z, b.z))
}
