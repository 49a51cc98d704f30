//! Filling holes with triangles: all loops are planned, then written.
//!
//! A vertex has one fan, so no two boundary loops share a vertex, and no filler's diagonal can be another's: the plans do
//! not depend on each other. Nothing is written before all are made, so a call that is cancelled has changed nothing.

mod account;
mod ears;
mod islands;
mod minimal;
mod parts;
mod ring;

use crate::geometry::triangulate::Triangulator;
use crate::geometry::{direction, unit_scale};
use crate::{Cancelled, HalfedgeKey, Mesh};
pub use account::{
    BadOption, FillHolesError, FillHolesOptions, FillMethod, FilledHole, FilledHoles, HoleRefusal,
    RefusedHole, TriangulateHoleError,
};
use glam::DVec3;
use minimal::Pace;
use parts::Parts;
use ring::{Ears, Ring};

/// How a loop is to be filled.
struct Plan {
    first: u32,
    edges: usize,
    /// None for one face.
    ears: Ears,
    area: f64,
    method: FillMethod,
}

/// # Holes
impl Mesh {
    /// Fills the hole along the boundary loop through a half-edge, as [`fill_holes`](Self::fill_holes) would. All loops are
    /// looked at for islands.
    ///
    /// ```text
    ///   ●───●───●        ●───●───●
    ///   │ ╱   ╲ │        │ ╱ │ ╲ │
    ///   ●       ●   →    ●───●───●
    ///   │ ╲   ╱ │        │ ╲ │ ╱ │      no vertex is made
    ///   ●───●───●        ●───●───●
    /// ```
    ///
    /// O(mesh), and O(n^3) or O(n log n) in the loop's edges.
    ///
    /// # Errors
    /// [`TriangulateHoleError`]; nothing has changed then.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{FillHolesOptions, IndexedMesh, Mesh, Polygons, glam::dvec3};
    /// # let corner = |i: u32| dvec3(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
    /// // A cube without its top.
    /// let walls = vec![[0, 2, 3, 1], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    /// let walls: Polygons = walls.into_iter().collect();
    /// let mut mesh = Mesh::build(&IndexedMesh::new((0..8).map(corner).collect(), walls)?)?;
    /// let rim = mesh.boundary_halfedges().next().unwrap();
    /// let hole = mesh.triangulate_hole(rim, FillHolesOptions::default())?;
    /// assert_eq!((hole.edges, hole.faces.len(), hole.area), (4, 2, 1.0));
    /// assert!(mesh.is_closed());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn triangulate_hole(
        &mut self,
        h: HalfedgeKey,
        mut options: FillHolesOptions<'_>,
    ) -> Result<FilledHole, TriangulateHoleError> {
        let slot = self.halfedge_slot(h).ok_or(TriangulateHoleError::Missing(h))?;
        if self.face[slot as usize] != crate::matching::NONE {
            return Err(TriangulateHoleError::NotBoundary(h));
        }
        options.check()?;
        let loops = self.loop_firsts();
        let own = self.loop_slots(slot).find_map(|h| loops.binary_search(&h).ok()).unwrap_or(0);
        let plan = self.plan_holes(&loops, own..own + 1, &mut options)?.0.pop();
        match plan {
            Some(Ok(plan)) => Ok(self.write_plan(&plan)),
            Some(Err(reason)) => Err(TriangulateHoleError::Refused(self.refused(slot, reason))),
            None => Err(TriangulateHoleError::NotBoundary(h)),
        }
    }

    /// Fills all holes: along each boundary loop the triangles of least area, or for long loops of little.
    ///
    /// - Of all triangulations of a loop without new vertices the one is taken that has the fewest triangles without area,
    ///   and among those the least area plus 1e-10 of the squared sides, which decides where the hole is flat. (Barequet
    ///   and Sharir, 1995; Liepa, "Filling holes in meshes", 2003, whose weight by the worst angle cannot be minimised
    ///   exactly by this method.) Above [`exact_edges`](FillHolesOptions::exact_edges) edges ears are cut, the shortest
    ///   diagonal first, seen along the loop's area vector. Whether the filler passes through other faces is not asked.
    /// - No diagonal joins vertices that an edge joins already, and no face is made that exists: the result is a valid mesh,
    ///   always.
    /// - A hole of three edges gets one face, and with [`polygon_tolerance`](FillHolesOptions::polygon_tolerance) a flat one
    ///   too: then a quad that is missing comes back as a quad.
    /// - Loops that lie around one hole, the outside of sheets, and what else [`HoleRefusal`] names, stay open. A loop is
    ///   within the hole of another if it faces the other way (their area vectors enclose more than 120 degrees), its corners
    ///   lie inside seen along that one's area vector, and not deep ([`island_depth`](FillHolesOptions::island_depth)).
    /// - New faces are in the group that most of the loop's length borders on. New corners have neither normals nor texture
    ///   coordinates, and user data is the default: what should be there cannot be known.
    /// - Checkpoints, columns and the record of changes see all of it: a hole is filled with one face, which is then split.
    ///
    /// O(mesh) and what each loop takes: O(n^3) up to `exact_edges` (0.2 s for 500), O(n log n) on longer loops from life; so
    /// too on further loops once [`exact_cost`](FillHolesOptions::exact_cost) is spent.
    ///
    /// # Errors
    /// [`FillHolesError`]; nothing has changed then. A hole that stays open is no error but in the account.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{FillHolesOptions, IndexedMesh, Mesh, Polygons, glam::dvec3};
    /// # let corner = |i: u32| dvec3(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
    /// // A cube without top and bottom.
    /// let walls: Polygons = vec![[0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]].into_iter().collect();
    /// let mut mesh = Mesh::build(&IndexedMesh::new((0..8).map(corner).collect(), walls)?)?;
    /// let account = mesh.fill_holes(FillHolesOptions { polygon_tolerance: Some(1e-9), ..Default::default() })?;
    /// assert_eq!((account.filled.len(), account.refused.len()), (2, 0));
    /// assert!(mesh.is_closed() && mesh.faces().all(|f| mesh.degree(f) == 4));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn fill_holes(&mut self, options: FillHolesOptions<'_>) -> Result<FilledHoles, FillHolesError> {
        self.fill_holes_beside(options, |_| true)
    }

    /// [`fill_holes`](Self::fill_holes) along the loops that run along a wanted face, given by its slot; others are not told
    /// of.
    pub(crate) fn fill_holes_beside(
        &mut self,
        mut options: FillHolesOptions<'_>,
        is_wanted: impl Fn(u32) -> bool,
    ) -> Result<FilledHoles, FillHolesError> {
        options.check()?;
        let mut loops = self.loop_firsts();
        loops.retain(|&h| is_wanted(self.face[h as usize ^ 1]));
        let (plans, unsearched) = self.plan_holes(&loops, 0..loops.len(), &mut options)?;
        let mut account = FilledHoles { unsearched, ..FilledHoles::default() };
        for (&first, plan) in loops.iter().zip(plans) {
            match plan {
                Ok(plan) => account.filled.push(self.write_plan(&plan)),
                Err(reason) => account.refused.push(self.refused(first, reason)),
            }
        }
        Ok(account)
    }

    /// The lowest half-edge of each boundary loop, ascending.
    fn loop_firsts(&self) -> Vec<u32> {
        let mut seen = vec![false; self.edges.slot_count()];
        let mut firsts = Vec::new();
        for h in self.boundary_slots() {
            if !seen[h as usize >> 1] {
                self.loop_slots(h).for_each(|h| seen[h as usize >> 1] = true);
                firsts.push(h);
            }
        }
        firsts
    }

    /// What is to become of the wanted ones of the loops.
    fn plan_holes(
        &self,
        loops: &[u32],
        wanted: std::ops::Range<usize>,
        options: &mut FillHolesOptions<'_>,
    ) -> Result<(Vec<Result<Plan, HoleRefusal>>, usize), Cancelled> {
        options.control.report("loops", 0.0)?;
        let scale = unit_scale(self.vertices.live().map(|v| self.positions[v as usize]));
        let parts = options.max_area_ratio.is_finite().then(|| Parts::of(self, scale));
        let lengths: Vec<usize> = loops[wanted.clone()].iter().map(|&h| self.loop_slots(h).count()).collect();
        let exact = exact_loops(&lengths, options);
        let cost = |(&n, &exact): (&usize, &bool)| if exact { (n as f64).powi(3) } else { 64.0 * n as f64 };
        let all: f64 = lengths.iter().zip(&exact).map(cost).sum();
        let costs: Vec<f64> = lengths.iter().zip(&exact).map(|loop_| cost(loop_) / all).collect();

        let mut plans = Vec::with_capacity(lengths.len());
        let mut done = 0.0;
        let mut pace = Pace::new(&mut options.control);
        let limits = Limits {
            max_edges: options.max_edges.unwrap_or(usize::MAX),
            exact_edges: options.exact_edges,
            tolerance: options.polygon_tolerance,
            ratio: options.max_area_ratio,
        };
        for (i, &first) in loops[wanted.clone()].iter().enumerate() {
            pace.fraction = 0.1 + 0.75 * done;
            pace.step(lengths[i])?;
            plans.push(self.plan_hole(
                first,
                (lengths[i], exact[i]),
                &limits,
                parts.as_ref(),
                scale,
                &mut pace,
            )?);
            done += costs[i];
        }

        options.control.report("islands", 0.85)?;
        // What stays open anyway holds no islands; but a loop that was not asked for may.
        let is_outer = |i: usize| !wanted.contains(&i) || plans[i - wanted.start].is_ok();
        let (groups, unsearched) = islands::shared(self, loops, scale, options.island_depth, is_outer);
        for group in groups {
            let keys: Vec<HalfedgeKey> = group.iter().map(|&i| self.halfedge_key(loops[i])).collect();
            for i in group.into_iter().filter(|i| wanted.contains(i)) {
                plans[i - wanted.start] = Err(HoleRefusal::Islands(keys.clone()));
            }
        }
        options.control.report("write", 0.9)?;
        Ok((plans, unsearched))
    }

    fn plan_hole(
        &self,
        first: u32,
        (edges, exact): (usize, bool),
        limits: &Limits,
        parts: Option<&Parts>,
        scale: f64,
        pace: &mut Pace<'_, '_>,
    ) -> Result<Result<Plan, HoleRefusal>, Cancelled> {
        if edges > limits.max_edges {
            return Ok(Err(HoleRefusal::TooLong(edges)));
        }
        if let Some(f) = self.is_closed_off(self.loop_slots(first)) {
            return Ok(Err(HoleRefusal::OneFace(self.faces.key(f))));
        }
        let ring = Ring::of(self, first);
        let corners: Vec<u32> = (0..edges as u32).collect();
        let (ears, area, method) = if let Some(area) = one_face(&ring, limits.tolerance) {
            (Some(Ears::new()), area, FillMethod::OneFace)
        } else {
            let (ears, method) = if exact {
                (minimal::lightest(&ring, &corners, pace)?, FillMethod::LeastArea)
            } else {
                let last = if edges > limits.exact_edges { ears::LAST } else { ears::LAST_OF_MANY };
                (ears::clip(&ring, last, pace)?, FillMethod::Ears)
            };
            let area = ears.as_ref().map_or(0.0, |ears| ring.area_of(ears));
            (ears, area, method)
        };
        let Some(ears) = ears else {
            let [a, b] = ring.chords.first().map_or([0, 0], |c| c.map(|i| ring.vertices[i as usize]));
            let chord = self.outgoing_slots(a).find(|&h| self.origin[h as usize ^ 1] == b).unwrap_or(first);
            return Ok(Err(HoleRefusal::EdgesInTheWay(self.edges.key(chord >> 1))));
        };
        if let Some(parts) = parts {
            let of_part = parts.area_at(self.face[first as usize ^ 1]);
            let filler = area * (scale / ring.scale).powi(2);
            // Both may be nothing.
            if filler >= limits.ratio * of_part {
                return Ok(Err(HoleRefusal::Sheet(filler / of_part)));
            }
        }
        let area = area / ring.scale / ring.scale;
        Ok(Ok(Plan { first: ring.first, edges, ears, area, method }))
    }

    fn write_plan(&mut self, plan: &Plan) -> FilledHole {
        let place = self.mean_of_loop(plan.first, plan.edges);
        let group = self.group_around(plan.first);
        let faces = self.fill_loop(plan.first, &plan.ears, group);
        FilledHole {
            halfedge: self.halfedge_key(plan.first),
            edges: plan.edges,
            faces,
            area: plan.area,
            place,
            method: plan.method,
        }
    }

    fn refused(&self, h: u32, reason: HoleRefusal) -> RefusedHole {
        let first = self.loop_slots(h).min_by_key(|&h| self.origin[h as usize]).unwrap_or(h);
        let vertices: Vec<_> =
            self.loop_slots(first).map(|h| self.vertices.key(self.origin[h as usize])).collect();
        let place = self.mean_of_loop(first, vertices.len());
        RefusedHole { halfedge: self.halfedge_key(first), vertices, place, reason }
    }

    fn mean_of_loop(&self, first: u32, count: usize) -> DVec3 {
        self.loop_slots(first).map(|h| self.at(h) / count as f64).sum()
    }

    /// The group that most of the length along a loop borders on, the lowest among equals.
    fn group_around(&self, first: u32) -> Option<u32> {
        let groups = self.columns.store::<u32>(crate::column::Kind::Face, self.carried.groups?.index)?;
        let mut lengths: Vec<(u32, f64)> = self
            .loop_slots(first)
            .filter_map(|h| {
                let group = groups.get(self.face[h as usize ^ 1])?;
                Some((*group, super::distance(self.at(h), self.at(h ^ 1))))
            })
            .collect();
        lengths.sort_by_key(|l| l.0);
        let sums = lengths.chunk_by(|a, b| a.0 == b.0).map(|c| (c[0].0, c.iter().map(|l| l.1).sum::<f64>()));
        sums.reduce(|best, next| if next.1 > best.1 { next } else { best }).map(|best| best.0)
    }
}

/// The options that hold for each loop.
struct Limits {
    max_edges: usize,
    exact_edges: usize,
    tolerance: Option<f64>,
    ratio: f64,
}

/// Which loops are filled with least area: the shortest, as far as it goes.
fn exact_loops(lengths: &[usize], options: &FillHolesOptions<'_>) -> Vec<bool> {
    let mut order: Vec<usize> = (0..lengths.len()).filter(|&i| lengths[i] <= options.exact_edges).collect();
    order.sort_by_key(|&i| lengths[i]);
    let mut exact = vec![false; lengths.len()];
    let mut left = options.exact_cost;
    for i in order {
        let Some(rest) = left.checked_sub((lengths[i] as u64).pow(3)) else { break };
        left = rest;
        exact[i] = true;
    }
    exact
}

/// The area of the one face that fills a loop, if one does: a triangle, or a polygon that is flat within the tolerance and
/// does not cross itself.
fn one_face(ring: &Ring, tolerance: Option<f64>) -> Option<f64> {
    let double = ring.double_area_vector();
    let area = 0.5 * double.length();
    if ring.len() == 3 {
        return Some(area);
    }
    let tolerance = tolerance?;
    let normal = direction(double);
    let mean = ring.points.iter().sum::<DVec3>() / ring.len() as f64;
    let is_flat = ring.points.iter().all(|&p| (p - mean).dot(normal).abs() <= tolerance * ring.scale);
    if normal == DVec3::ZERO || !is_flat {
        return None;
    }
    // The triangles of a polygon that crosses itself cover more than it encloses.
    let flat = |v: u32| {
        let p = ring.points[v as usize];
        p - normal * (p - mean).dot(normal)
    };
    let corners: Vec<u32> = (0..ring.len() as u32).collect();
    let mut rule = Triangulator::default();
    let covered = rule.triangulate(&corners, flat).iter().map(|t| {
        let [a, b, c] = t.map(flat);
        0.5 * (b - a).cross(c - a).length()
    });
    (covered.sum::<f64>() <= area * (1.0 + 1e-9)).then_some(area)
}
