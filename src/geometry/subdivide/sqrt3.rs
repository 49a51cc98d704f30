//! Kobbelt's scheme: a centre in every triangle, every inner edge flipped; boundary edges cut in three at every second
//! level.

use super::carry::{Born, Sources, old_vertices, part, split};
use super::dense::Dense;
use super::refine::{Lists, Sink};
use super::{Meter, SubdivideError, build, followed};
use crate::build::Linking;
use crate::column::{Columns, Kind, Origin};
use crate::matching::NONE;
use crate::report::{Maps, Relation};
use crate::{Control, Mesh, Polygons};
use glam::DVec3;
use std::mem;
use std::sync::Arc;

pub(super) fn subdivide(
    mut dense: Dense,
    face_source: Option<Vec<u32>>,
    mesh: &Mesh,
    levels: u32,
    columns: &mut Columns,
    control: &mut Control<'_>,
) -> Result<(Mesh, Maps), SubdivideError> {
    let vertices = dense.positions.len();
    let mut maps = match face_source {
        Some(source) => Maps {
            vertices: Relation::identity(vertices),
            faces: Relation::from_parents(mesh.face_count(), source),
        },
        None => Maps::identity(vertices, dense.polygons.len()),
    };
    for level in 0..levels {
        let [from, to] = [level, level + 1].map(|l| 0.9 * 3f64.powi(l as i32 - levels as i32));
        let mut meter = Meter { control, from, to };
        let step = Step::new(&dense, level % 2 == 1);
        meter.advance(1, 4)?;
        let mut linked = None;
        let mut finer = None;
        if level + 1 == levels && columns.is_empty() && !step.cuts() {
            // The last level is linked at once.
            let corners = dense.use_of.len();
            let vertices = dense.positions.len() + step.new_vertices;
            let mut linking = Linking::new(vertices, corners + dense.edges, corners);
            let open = step.link(&mut linking, &mut meter)?;
            meter.advance(3, 4)?;
            linked = linking.finish(step.positions(1), &open);
        }
        if linked.is_none() {
            let next = step.finer(&mut meter)?;
            meter.advance(3, 4)?;
            if !columns.is_empty() {
                step.carry(columns, &next);
            }
            finer = Some(next);
        }
        let parents = step.into_parents();
        let polygons = mem::take(&mut dense.polygons);
        let next = Parents { polygons, ..parents }.maps();
        maps = if level == 0 && maps.faces.is_identity() { next } else { followed(&maps, &next) };
        if let Some(mesh) = linked {
            return Ok((mesh, maps));
        }
        dense = finer.unwrap_or(dense);
    }
    control.report("build", 0.9)?;
    Ok((build(dense)?, maps))
}

/// One level.
struct Step<'d> {
    dense: &'d Dense,
    /// For each corner the corner across its edge, or [`NONE`].
    mates: Vec<u32>,
    /// For each face its open side, if this level cuts the boundary; else [`NONE`]. Empty if no face has one.
    open_side: Vec<u32>,
    /// For each face its first new vertex: its centre, or the two on its open side. Empty likewise: then they are
    /// numbered as faces are.
    first_new: Vec<u32>,
    new_vertices: usize,
}

/// What tells where the elements of a level come from.
struct Parents {
    polygons: Polygons,
    mates: Vec<u32>,
    open_side: Vec<u32>,
    old_vertices: usize,
    new_vertices: usize,
}

impl<'d> Step<'d> {
    fn new(dense: &'d Dense, cuts_boundary: bool) -> Self {
        let mut mates = vec![NONE; dense.use_of.len()];
        let mut first = vec![NONE; dense.edges];
        for (c, &u) in dense.use_of.iter().enumerate() {
            let first = &mut first[u as usize >> 1];
            if u & 1 == 0 {
                *first = c as u32;
            } else {
                mates[c] = *first;
                mates[*first as usize] = c as u32;
            }
        }
        let faces = dense.polygons.len();
        let mut step =
            Self { dense, mates, open_side: Vec::new(), first_new: Vec::new(), new_vertices: faces };
        if cuts_boundary && !dense.open.is_empty() {
            step.new_vertices = 0;
            for f in 0..faces {
                step.first_new.push((dense.positions.len() + step.new_vertices) as u32);
                // After a first level a face has one open side at most.
                let open = (0..3).find(|&i| step.mates[3 * f + i as usize] == NONE);
                step.open_side.push(open.unwrap_or(NONE));
                step.new_vertices += if open.is_some() { 2 } else { 1 };
            }
        }
        step
    }

    /// Whether boundary edges are cut in three.
    fn cuts(&self) -> bool {
        !self.open_side.is_empty()
    }

    fn open_side(&self, face: usize) -> u32 {
        self.open_side.get(face).copied().unwrap_or(NONE)
    }

    fn first_new(&self, face: usize) -> u32 {
        self.first_new.get(face).copied().unwrap_or((self.dense.positions.len() + face) as u32)
    }

    fn into_parents(self) -> Parents {
        let Self { mates, open_side, new_vertices, dense, .. } = self;
        let (old_vertices, polygons) = (dense.positions.len(), Polygons::new());
        Parents { polygons, mates, open_side, old_vertices, new_vertices }
    }

    /// The vertex that stands for the centre of a corner's face as its edge sees it.
    fn center(&self, corner: usize) -> u32 {
        let (f, i) = (corner / 3, corner as u32 % 3);
        let first = self.first_new(f);
        match self.open_side(f) {
            NONE => first,
            // The side after the open one sees the far cut, the side before it the near one.
            open => first + u32::from(i == (open + 1) % 3),
        }
    }

    /// The finer faces, with their edges in the order of first use; returns the edges with one use. For a level that
    /// does not cut the boundary.
    ///
    /// The part at a corner joins its vertex to the centres on both sides of its half-edge. So an edge of the finer mesh
    /// lies across an old one, or joins a corner's vertex to the centre of its face.
    fn link(&self, sink: &mut impl Sink, meter: &mut Meter<'_, '_>) -> Result<Vec<u32>, SubdivideError> {
        let corners = self.dense.polygons.corners();
        let centers = self.dense.positions.len() as u32;
        let mut across = vec![NONE; self.dense.edges];
        let mut spokes = vec![NONE; corners.len()];
        let mut edges = 0;
        let mut used = |edge: &mut u32| {
            let is_first = *edge == NONE;
            if is_first {
                *edge = edges;
                edges += 1;
            }
            *edge << 1 | u32::from(!is_first)
        };
        let mut open = Vec::new();
        let mut c = 0;
        let faces = corners.chunks_exact(3).zip(self.dense.use_of.chunks_exact(3)).zip(centers..);
        for ((face, uses), center) in faces {
            meter.tick(c, 2 * corners.len())?;
            for i in 0..3 {
                let next = if i == 2 { 0 } else { i + 1 };
                let (mate, flipped) = (self.mates[c + i], &mut across[uses[i] as usize >> 1]);
                if mate == NONE {
                    let side = used(flipped);
                    open.push(side >> 1);
                    let uses = [side, used(&mut spokes[c + next]), used(&mut spokes[c + i])];
                    sink.face(&[face[i], face[next], center], &uses);
                } else {
                    let (beyond, turn) = (mate / 3, mate % 3);
                    let after = if turn == 2 { mate - 2 } else { mate + 1 } as usize;
                    let uses = [used(&mut spokes[after]), used(flipped), used(&mut spokes[c + i])];
                    sink.face(&[face[i], centers + beyond, center], &uses);
                }
            }
            c += 3;
        }
        Ok(open)
    }

    /// The finer mesh.
    fn finer(&self, meter: &mut Meter<'_, '_>) -> Result<Dense, SubdivideError> {
        let corners = self.dense.polygons.corners();
        if !self.cuts() {
            let mut lists = Lists::of_triangles(corners.len());
            let open = self.link(&mut lists, meter)?;
            let (polygons, use_of) = lists.finish();
            let edges = corners.len() + self.dense.edges;
            let (positions, creases, corners) = (self.positions(0), Vec::new(), Vec::new());
            return Ok(Dense { positions, polygons, use_of, edges, open, creases, corners });
        }
        let mut triangles = Vec::with_capacity(3 * corners.len());
        for (c, &mate) in self.mates.iter().enumerate() {
            meter.tick(c, 2 * self.mates.len())?;
            let f = c / 3;
            let [a, b, apex] = [c, c + 1, c + 2].map(|k| corners[3 * f + k % 3]);
            debug_assert_eq!(a, corners[c]);
            if mate != NONE {
                triangles.extend([a, self.center(mate as usize), self.center(c)]);
            } else if self.open_side(f) == NONE {
                triangles.extend([a, b, self.center(c)]);
            } else {
                triangles.extend([self.first_new(f), self.first_new(f) + 1, apex]);
            }
        }
        Ok(Dense::matched(self.positions(0), Polygons::uniform(3, triangles)))
    }

    /// Positions of the finer vertices, with `lead` entries in front.
    fn positions(&self, lead: usize) -> Vec<DVec3> {
        let old = &self.dense.positions;
        let mut positions = Vec::with_capacity(lead + old.len() + self.new_vertices);
        positions.resize(lead, DVec3::ZERO);
        // The sum and number of each vertex's neighbours, and the two along the boundary.
        let mut sums = vec![(DVec3::ZERO, 0u32); old.len()];
        let mut along = vec![[NONE; 2]; old.len()];
        let corners = self.dense.polygons.corners();
        for (face, mates) in corners.chunks_exact(3).zip(self.mates.chunks_exact(3)) {
            for (i, &mate) in mates.iter().enumerate() {
                let (a, b) = (face[i], face[if i == 2 { 0 } else { i + 1 }]);
                let sum = &mut sums[a as usize];
                *sum = (sum.0 + old[b as usize], sum.1 + 1);
                if mate == NONE {
                    along[a as usize][1] = b;
                    along[b as usize][0] = a;
                }
            }
        }
        let alpha = |n: f64| (4.0 - 2.0 * (std::f64::consts::TAU / n).cos()) / 9.0;
        let alphas: [f64; 32] = std::array::from_fn(|n| alpha(n as f64));
        for (v, &(sum, n)) in sums.iter().enumerate() {
            positions.push(match along[v] {
                [NONE, _] | [_, NONE] if n > 0 => {
                    let count = f64::from(n);
                    let alpha = alphas.get(n as usize).copied().unwrap_or_else(|| alpha(count));
                    old[v] * (1.0 - alpha) + sum * (alpha / count)
                }
                [before, after] if n > 0 && self.cuts() => {
                    (old[before as usize] * 4.0 + old[v] * 19.0 + old[after as usize] * 4.0) / 27.0
                }
                _ => old[v],
            });
        }
        for (f, face) in corners.chunks_exact(3).enumerate() {
            match self.open_side(f) {
                NONE => positions.push(face.iter().map(|&v| old[v as usize]).sum::<DVec3>() / 3.0),
                open => {
                    let [a, b] = [open, (open + 1) % 3].map(|i| face[i as usize]);
                    let (before, after) = (along[a as usize][0], along[b as usize][1]);
                    let [before, a, b, after] = [before, a, b, after].map(|v| old[v as usize]);
                    positions.push((before + a * 16.0 + b * 10.0) / 27.0);
                    positions.push((a * 10.0 + b * 16.0 + after) / 27.0);
                }
            }
        }
        positions
    }

    /// The corners of its face between which the vertex lies that stands for its centre as a corner's edge sees it.
    fn parents(&self, corner: usize) -> Sources {
        let (first, i) = ((corner - corner % 3) as u32, corner as u32 % 3);
        match self.open_side(corner / 3) {
            NONE => (first..first + 3).map(|c| (c, 1.0 / 3.0)).collect(),
            open => {
                let near = if i == (open + 1) % 3 { 1.0 / 3.0 } else { 2.0 / 3.0 };
                smallvec::smallvec![(first + open, near), (first + (open + 1) % 3, 1.0 - near)]
            }
        }
    }

    /// The same beyond a corner's edge as this side of it goes on: as if the other face mirrored this one.
    fn mirrored(&self, corner: usize, mate: usize) -> Sources {
        let [own, next, apex] = [0, 1, 2].map(|i| (corner - corner % 3 + (corner + i) % 3) as u32);
        let (mut weights, mut beyond) = ([0.0; 2], 0.0);
        for (c, weight) in self.parents(mate) {
            match (c as usize + 3 - mate % 3) % 3 {
                0 => weights[1] += weight,
                1 => weights[0] += weight,
                _ => beyond += weight,
            }
        }
        let all = [(own, weights[0] + beyond), (next, weights[1] + beyond), (apex, -beyond)];
        all.into_iter().filter(|s| s.1 != 0.0).collect()
    }

    /// The columns of the finer mesh. Every part lies on both sides of an old edge; it counts to the side of its old
    /// corner, and across a seam that side goes on.
    fn carry(&self, columns: &mut Columns, finer: &Dense) {
        let dense = self.dense;
        let vertex_of = dense.polygons.corners();
        columns.derive(Kind::Vertex, finer.positions.len(), &|emit| {
            old_vertices(dense, &finer.positions, emit);
            let mut tell = |corner: usize| {
                let corners = self.parents(corner);
                let ends: Sources = corners.iter().map(|&(c, w)| (vertex_of[c as usize], w)).collect();
                emit(split(&ends));
            };
            for f in 0..dense.polygons.len() {
                let open = self.open_side(f);
                match open as usize {
                    _ if open == NONE => tell(3 * f),
                    // As seen by the sides before and after the open one.
                    open => [2, 1].map(|k| 3 * f + (open + k) % 3).into_iter().for_each(&mut tell),
                }
            }
        });
        let turn = |c: usize, k: usize| c - c % 3 + (c + k) % 3;
        columns.derive(Kind::Corner, finer.use_of.len(), &|emit| {
            for (c, &mate) in self.mates.iter().enumerate() {
                let [_, next, apex] = [0, 1, 2].map(|k| turn(c, k));
                if mate != NONE {
                    let (m, own) = (mate as usize, self.parents(c));
                    let pairs = [[c as u32, turn(m, 1) as u32], [next as u32, mate]];
                    emit(Origin::Same(c as u32));
                    let (beyond, here) = (self.parents(m), self.mirrored(c, m));
                    emit(Origin::Across { pairs, beyond: &beyond, here: &here });
                    emit(split(&own));
                } else if self.open_side(c / 3) == NONE {
                    emit(Origin::Same(c as u32));
                    emit(Origin::Same(next as u32));
                    emit(split(&self.parents(c)));
                } else {
                    emit(split(&self.parents(apex)));
                    emit(split(&self.parents(next)));
                    emit(Origin::Same(apex as u32));
                }
            }
        });
        if !columns.none_on(Kind::Edge) {
            let mut born = vec![Born::Inside; finer.edges];
            let mut set = |corner: usize, of: Born| born[finer.use_of[corner] as usize >> 1] = of;
            let edge = |c: usize| dense.use_of[c] >> 1;
            for (c, &mate) in self.mates.iter().enumerate() {
                let open = self.open_side(c / 3);
                if mate != NONE {
                    set(3 * c + 1, Born::Whole(edge(c)));
                } else if open == NONE {
                    set(3 * c, Born::Whole(edge(c)));
                } else {
                    // The third in the middle, and those that the parts beside it have.
                    let (before, after) = (turn(c, 2), turn(c, 1));
                    set(3 * c, Born::Part(edge(c)));
                    set(3 * after + 2, Born::Part(edge(c)));
                    if self.mates[before] != NONE {
                        set(3 * self.mates[before] as usize, Born::Part(edge(c)));
                    }
                }
            }
            columns.derive(Kind::Edge, finer.edges, &|emit| born.iter().for_each(|b| b.tell(emit)));
        }
        columns.derive(Kind::Face, finer.polygons.len(), &|emit| {
            for (c, &mate) in self.mates.iter().enumerate() {
                let own = c as u32 / 3;
                if mate == NONE { part(emit, own) } else { emit(split(&[(own, 0.5), (mate / 3, 0.5)])) }
            }
        });
    }
}

impl Parents {
    /// Told when somebody asks.
    fn maps(self) -> Maps {
        let (old_vertices, old_faces) = (self.old_vertices, self.polygons.len());
        let (new_vertices, new_faces) = (old_vertices + self.new_vertices, self.mates.len());
        let parents = Arc::new(self);
        let same = Arc::clone(&parents);
        Maps {
            vertices: Relation::made(old_vertices, new_vertices, move |told| {
                (0..old_vertices as u32).for_each(|v| told.add([v]));
                for (f, face) in parents.polygons.iter().enumerate() {
                    match parents.open_side.get(f).copied().unwrap_or(NONE) as usize {
                        open if open < 3 => {
                            (0..2).for_each(|_| told.add([face[open], face[(open + 1) % 3]]));
                        }
                        _ => told.add(face.iter().copied()),
                    }
                }
            }),
            faces: Relation::made(old_faces, new_faces, move |told| {
                for (c, &mate) in (0u32..).zip(&same.mates) {
                    let beyond = (mate != NONE).then_some(mate / 3);
                    told.add([c / 3].into_iter().chain(beyond));
                }
            }),
        }
    }
}
