//! A backward step of diffusion: places from which the Laplacian leads back to where the vertices are.

use super::weights::Apexes;
use crate::{Cancelled, Mesh};
use glam::DVec3;

/// The largest step; beyond it so little of the old places is left that they cannot be told from rounding.
pub(super) const LONGEST: f64 = 1e4;

/// Cotangents beyond this are those of angles that rounding made.
const STEEPEST: f64 = 1e12;

/// The squared error at which the places count as found, for coordinates of about one.
const GOAL: f64 = 1e-28;

/// Moves every vertex that does not stay to `x` with `x + lambda (x - mean of x around it) = p`, where means are weighted by
/// the cotangents at the old places `p`. Rows times their weights make a symmetric, diagonally dominant matrix, for which
/// conjugate gradients (Hestenes and Stiefel 1952), preconditioned by its diagonal, need about the root of `lambda` rounds.
pub(super) fn step(
    mesh: &Mesh,
    apexes: &Apexes,
    stays: impl Fn(usize) -> bool,
    now: &mut [DVec3],
    lambda: f64,
    tick: &mut dyn FnMut(f64) -> Result<(), Cancelled>,
) -> Result<(), Cancelled> {
    let mut edges = Vec::with_capacity(mesh.edge_count());
    let mut sums = vec![0.0; now.len()];
    for e in mesh.edges.live() {
        let weight = apexes.weight(mesh, now, e).min(STEEPEST);
        if weight > 0.0 {
            let ends = [2 * e, 2 * e + 1].map(|h| mesh.origin[h as usize] as usize);
            ends.iter().for_each(|&v| sums[v] += weight);
            edges.push((ends, weight));
        }
    }
    // Without a weight there is nothing to go by.
    let free: Vec<bool> = (0..now.len()).map(|v| sums[v] > 0.0 && !stays(v)).collect();
    let times = |x: &[DVec3], out: &mut [DVec3]| {
        out.iter_mut().zip(x).zip(&sums).for_each(|((o, &x), &sum)| *o = x * (sum * (1.0 + lambda)));
        for &([a, b], weight) in &edges {
            out[a] -= x[b] * (lambda * weight);
            out[b] -= x[a] * (lambda * weight);
        }
        out.iter_mut().zip(&free).filter(|f| !f.1).for_each(|(o, _)| *o = DVec3::ZERO);
    };
    let precondition =
        |v: usize, r: DVec3| if free[v] { r / (sums[v] * (1.0 + lambda)) } else { DVec3::ZERO };
    let dot = |a: &[DVec3], b: &[DVec3]| a.iter().zip(b).map(|(&a, &b)| a * b).sum::<DVec3>();
    // Of each coordinate its own quotient; nothing where nothing is left to do.
    let quotient = |a: DVec3, b: DVec3| DVec3::select(b.cmpgt(DVec3::ZERO), a / b, DVec3::ZERO);

    let mut image = vec![DVec3::ZERO; now.len()];
    times(now, &mut image);
    let at = |v: usize| if free[v] { now[v] * sums[v] - image[v] } else { DVec3::ZERO };
    let mut residual: Vec<DVec3> = (0..now.len()).map(at).collect();
    let mut better: Vec<DVec3> = residual.iter().enumerate().map(|(v, &r)| precondition(v, r)).collect();
    let mut direction = better.clone();
    let mut left = dot(&residual, &better);
    let goal = GOAL * sums.iter().zip(&free).filter(|f| *f.1).map(|f| f.0).sum::<f64>();
    let rounds = 64.0 + 40.0 * (1.0 + 2.0 * lambda).sqrt();
    for round in 0..rounds as u32 {
        tick(f64::from(round) / rounds)?;
        if left.max_element() <= goal {
            break;
        }
        times(&direction, &mut image);
        let along = quotient(left, dot(&direction, &image));
        for v in 0..now.len() {
            now[v] += direction[v] * along;
            residual[v] -= image[v] * along;
            better[v] = precondition(v, residual[v]);
        }
        let before = std::mem::replace(&mut left, dot(&residual, &better));
        let keep = quotient(left, before);
        direction.iter_mut().zip(&better).for_each(|(d, &b)| *d = b + *d * keep);
    }
    Ok(())
}
