//! Smoothing: Laplacian, Taubin, and along the mean curvature (cotangent weights), forward and backward.

mod implicit;
mod weights;

use super::unit_scale;
use crate::matching::NONE;
use crate::{Cancelled, Control, Mesh, SetError, VertexKey};
use glam::DVec3;
use weights::Apexes;

/// What pulls a vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum SmoothMethod {
    /// The mean of its one-ring. Shrinks.
    #[default]
    Laplacian,
    /// The mean of its one-ring, and then away from it by `mu`, which undoes the shrinking (Taubin, "A Signal Processing
    /// Approach to Fair Surface Design", SIGGRAPH 1995). `mu` must be below `-lambda`.
    Taubin {
        /// The factor of the second step.
        mu: f64,
    },
    /// The mean of its one-ring weighted by cotangents, found anew in every iteration: it moves along the surface's
    /// mean curvature and hardly slides within it (Desbrun et al., "Implicit Fairing of Irregular Meshes using
    /// Diffusion and Curvature Flow", SIGGRAPH 1999). A weight below zero counts as zero, so every step is a mean; a
    /// triangle without area adds none. Larger faces count as the crate's one rule cuts them at the start; their
    /// diagonals carry no weight.
    Cotangent,
    /// The same weights, taken backward (the implicit step of the same paper): vertices go where the pull of the places
    /// they reach would lead them back. However long a step, it is as stable as many short ones, and no vertex
    /// leaves the box of all; so `lambda` may be up to 10,000. One iteration costs O(edges) times the root of `lambda`.
    /// Boundary vertices that [slide](Boundary::Slide) go first, by a step of at most 1.
    Implicit,
}

/// What boundary vertices do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Boundary {
    /// They stay.
    #[default]
    Fixed,
    /// They move along the boundary edges beside them, towards the middle between their two neighbours as measured
    /// along the boundary: each stays on the boundary as it was before the step, and evenly spaced ones stay where they
    /// are. A sharp corner of the boundary that is to keep its place must be locked.
    Slide,
    /// They move as all others.
    Free,
}

/// How to smooth.
#[derive(Debug)]
pub struct SmoothOptions<'a> {
    /// What pulls a vertex.
    pub method: SmoothMethod,
    /// How far a step goes, in `(0, 1]`; for [`SmoothMethod::Implicit`] in `(0, 10000]`. 0.5 by default.
    pub lambda: f64,
    /// How often; for [`SmoothMethod::Taubin`] an iteration is a step of `lambda` and one of `mu`. 1 by default.
    pub iterations: u32,
    /// What boundary vertices do.
    pub boundary: Boundary,
    /// Vertices that stay.
    pub locked: &'a [VertexKey],
    /// The progress-and-cancel hook.
    pub control: Control<'a>,
}

impl Default for SmoothOptions<'_> {
    fn default() -> Self {
        Self {
            method: SmoothMethod::Laplacian,
            lambda: 0.5,
            iterations: 1,
            boundary: Boundary::Fixed,
            locked: &[],
            control: Control::none(),
        }
    }
}

/// Why a mesh was not smoothed; nothing has changed then.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SmoothError {
    /// The mesh has no vertices.
    #[error("there are no vertices")]
    Empty,
    /// `lambda` is not in `(0, 1]`, or for an implicit step not in `(0, 10000]`.
    #[error("a lambda of {0} is not above 0 and at most 1, or at most 10000 for an implicit step")]
    BadLambda(f64),
    /// `mu` is not below `-lambda`, or infinite.
    #[error("a mu of {mu} is not below -{lambda}")]
    BadMu {
        /// The factor of the first step.
        lambda: f64,
        /// The factor of the second.
        mu: f64,
    },
    /// A locked vertex is not there.
    #[error("{0:?} is not a vertex of the mesh")]
    Missing(VertexKey),
    /// A vertex would leave the range of numbers: `mu` is too far from `-lambda`.
    #[error("{0:?} would leave the range of numbers")]
    OutOfRange(VertexKey),
    /// The hook said stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl Mesh {
    /// Moves every vertex towards its neighbours, all at once, several times. Neighbours are the one-ring: those joined
    /// by an edge, whatever the faces' degrees. Carried normals stay as they are:
    /// [compute](Self::compute_normals) them anew. O(edges) an iteration.
    ///
    /// # Errors
    /// [`SmoothError`]: `lambda` or `mu` out of range, a mesh without vertices, a dead key, a vertex out of range; when cancelled.
    ///
    /// # Examples
    /// ```
    /// use meshwright::{IndexedMesh, Mesh, SmoothError, SmoothMethod, SmoothOptions, glam::DVec3};
    /// let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    /// let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    /// let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &faces)?)?;
    /// let (v, w) = (mesh.vertices().next().unwrap(), mesh.vertices().last().unwrap());
    /// mesh.smooth(SmoothOptions { lambda: 0.5, locked: &[w], ..Default::default() })?;
    /// assert!(mesh.position(v).distance(DVec3::splat(1.0 / 6.0)) < 1e-15);
    /// assert_eq!(mesh.position(w), DVec3::Z);
    /// let taubin = SmoothMethod::Taubin { mu: -0.4 };
    /// let refused = mesh.smooth(SmoothOptions { method: taubin, lambda: 0.5, ..Default::default() });
    /// assert_eq!(refused, Err(SmoothError::BadMu { lambda: 0.5, mu: -0.4 }));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn smooth(&mut self, options: SmoothOptions<'_>) -> Result<(), SmoothError> {
        let SmoothOptions { method, lambda, iterations, boundary, locked, mut control } = options;
        let is_implicit = matches!(method, SmoothMethod::Implicit);
        let longest = if is_implicit { implicit::LONGEST } else { 1.0 };
        if !(lambda > 0.0 && lambda <= longest) {
            return Err(SmoothError::BadLambda(lambda));
        }
        if let SmoothMethod::Taubin { mu } = method
            && !(mu < -lambda && mu.is_finite())
        {
            return Err(SmoothError::BadMu { lambda, mu });
        }
        if self.vertex_count() == 0 {
            return Err(SmoothError::Empty);
        }
        let rules = Rules::new(self, boundary, locked)?;
        // Brought to about one, so that neither sums nor cross products overflow.
        let scale = unit_scale(self.vertices.live().map(|v| self.positions[v as usize]));
        let mut now: Vec<DVec3> = self.positions.iter().map(|&p| p * scale).collect();
        let mut sums = vec![(DVec3::ZERO, 0.0); now.len()];
        let is_weighted = is_implicit || matches!(method, SmoothMethod::Cotangent);
        let apexes = is_weighted.then(|| Apexes::new(self));
        let second = if let SmoothMethod::Taubin { mu } = method { Some(mu) } else { None };
        let steps = f64::from(iterations) * if second.is_some() { 2.0 } else { 1.0 };
        let mut done = 0.0;
        for _ in 0..iterations {
            for factor in [Some(lambda), second].into_iter().flatten() {
                sums.fill((DVec3::ZERO, 0.0));
                let mut tick = |share: f64| control.report("smooth", (done + share) / steps);
                if let (true, Some(apexes)) = (is_implicit, &apexes) {
                    // Without sums, only what slides moves.
                    rules.step(&mut now, &sums, factor.min(1.0));
                    let stays = |v: usize| rules.of[v] != Rule::Free;
                    implicit::step(self, apexes, stays, &mut now, factor, &mut tick)?;
                } else {
                    sum(self, &now, apexes.as_ref(), &mut sums, &mut tick)?;
                    rules.step(&mut now, &sums, factor);
                }
                done += 1.0;
            }
        }
        let moves = |v: usize| rules.of[v] != Rule::Stay;
        let back = 1.0 / scale;
        // What did not move keeps its position to the bit.
        let new = |(v, &p): (usize, &DVec3)| if moves(v) && iterations > 0 { now[v] * back } else { p };
        let moved = self.positions.iter().enumerate().map(new).collect();
        self.replace_positions(moved).map_err(|error| match error {
            SetError::Missing(v) | SetError::NonFinite(v) => SmoothError::OutOfRange(v),
        })
    }
}

/// How a vertex may move.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Rule {
    Stay,
    Free,
    /// Along the boundary: the vertex slots before and after.
    Slide([u32; 2]),
}

/// By vertex slot.
struct Rules {
    of: Vec<Rule>,
    slides: bool,
}

impl Rules {
    fn new(mesh: &Mesh, boundary: Boundary, locked: &[VertexKey]) -> Result<Self, SmoothError> {
        let mut of = vec![Rule::Stay; mesh.positions.len()];
        for v in mesh.vertices.live() {
            let h = mesh.vertex_halfedge[v as usize];
            let is_open = h != NONE && mesh.face[h as usize] == NONE;
            of[v as usize] = match boundary {
                _ if h == NONE => Rule::Stay,
                Boundary::Fixed if is_open => Rule::Stay,
                Boundary::Slide if is_open => {
                    let [before, after] = [mesh.prev[h as usize], h ^ 1].map(|h| mesh.origin[h as usize]);
                    Rule::Slide([before, after])
                }
                _ => Rule::Free,
            };
        }
        for &v in locked {
            let slot = mesh.vertex_slot(v).ok_or(SmoothError::Missing(v))?;
            of[slot as usize] = Rule::Stay;
        }
        Ok(Self { of, slides: boundary == Boundary::Slide })
    }

    fn step(&self, now: &mut [DVec3], sums: &[(DVec3, f64)], factor: f64) {
        let before = if self.slides { now.to_vec() } else { Vec::new() };
        for ((p, &(sum, weight)), rule) in now.iter_mut().zip(sums).zip(&self.of) {
            match rule {
                Rule::Stay => {}
                Rule::Free => {
                    // All weights zero, or beyond numbers: nothing to go by.
                    let mean = sum / weight;
                    if weight > 0.0 && mean.is_finite() {
                        *p += (mean - *p) * factor;
                    }
                }
                Rule::Slide([a, b]) => {
                    let [a, b] = [*a, *b].map(|v| before[v as usize]);
                    let (behind, ahead) = (p.distance(a), p.distance(b));
                    let by = (ahead - behind) * 0.5 * factor;
                    let (to, length) = if by > 0.0 { (b, ahead) } else { (a, behind) };
                    // Half an edge at most, or neighbours could pass each other.
                    if by != 0.0 && length > 0.0 {
                        *p += (to - *p) * (by.abs() / length).min(0.5);
                    }
                }
            }
        }
    }
}

/// Adds up each vertex's neighbours and their weights, edge by edge.
fn sum(
    mesh: &Mesh,
    at: &[DVec3],
    apexes: Option<&Apexes>,
    sums: &mut [(DVec3, f64)],
    tick: &mut dyn FnMut(f64) -> Result<(), Cancelled>,
) -> Result<(), Cancelled> {
    for (i, e) in mesh.edges.live().enumerate() {
        if i.is_multiple_of(1 << 19) {
            tick(i as f64 / mesh.edge_count() as f64)?;
        }
        let [a, b] = [2 * e, 2 * e + 1].map(|h| mesh.origin[h as usize] as usize);
        let weight = apexes.map_or(1.0, |apexes| apexes.weight(mesh, at, e));
        for (a, b) in [(a, b), (b, a)] {
            sums[a].0 += at[b] * weight;
            sums[a].1 += weight;
        }
    }
    Ok(())
}
