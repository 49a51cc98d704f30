//! Kobbelt's scheme: a centre in every triangle, every inner edge flipped; boundary edges cut in three at every second
//! level.

use super::carry::{Born, Sources, old_vertices, part, split};
use super::dense::Dense;
use super::{Meter, SubdivideError, followed};
use crate::column::{Columns, Kind, Origin};
use crate::matching::NONE;
use crate::report::{Maps, Relation};
use crate::{Control, Mesh, Polygons};
use glam::DVec3;

pub(super) fn subdivide(
    mut dense: Dense,
    face_source: Option<Vec<u32>>,
    mesh: &Mesh,
    levels: u32,
    columns: &mut Columns,
    control: &mut Control<'_>,
) -> Result<(Dense, Maps), SubdivideError> {
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
        let (polygons, next) = step.faces(&mut meter)?;
        maps = if level == 0 && maps.faces.is_identity() { next } else { followed(&maps, &next) };
        meter.advance(3, 4)?;
        let finer = Dense::matched(step.positions(), polygons);
        if !columns.is_empty() {
            step.carry(columns, &finer);
        }
        dense = finer;
    }
    Ok((dense, maps))
}

/// One level.
struct Step<'d> {
    dense: &'d Dense,
    /// For each corner the corner across its edge, or [`NONE`].
    mates: Vec<u32>,
    /// For each face its open side, if this level cuts the boundary; else [`NONE`].
    open_side: Vec<u32>,
    /// For each face its first new vertex: its centre, or the two on its open side.
    first_new: Vec<u32>,
    new_vertices: usize,
}

impl<'d> Step<'d> {
    fn new(dense: &'d Dense, cuts_boundary: bool) -> Self {
        let mut mates = vec![NONE; dense.use_of.len()];
        for [a, b] in dense.corners_of_edges() {
            if b != NONE {
                mates[a as usize] = b;
                mates[b as usize] = a;
            }
        }
        let faces = dense.polygons.len();
        let mut step =
            Self { dense, mates, open_side: vec![NONE; faces], first_new: Vec::new(), new_vertices: 0 };
        for f in 0..faces {
            step.first_new.push((dense.positions.len() + step.new_vertices) as u32);
            // After a first level a face has one open side at most.
            let open = (0..3).find(|&i| cuts_boundary && step.mates[3 * f + i as usize] == NONE);
            step.open_side[f] = open.unwrap_or(NONE);
            step.new_vertices += if open.is_some() { 2 } else { 1 };
        }
        step
    }

    /// The vertex that stands for the centre of a corner's face as its edge sees it.
    fn center(&self, corner: usize) -> u32 {
        let (f, i) = (corner / 3, corner as u32 % 3);
        let first = self.first_new[f];
        match self.open_side[f] {
            NONE => first,
            // The side after the open one sees the far cut, the side before it the near one.
            open => first + u32::from(i == (open + 1) % 3),
        }
    }

    fn faces(&self, meter: &mut Meter<'_, '_>) -> Result<(Polygons, Maps), SubdivideError> {
        let corners = self.dense.polygons.corners();
        let (old_vertices, old_faces) = (self.dense.positions.len(), self.dense.polygons.len());
        let mut triangles = Vec::with_capacity(3 * corners.len());
        let mut pairs = Vec::with_capacity(2 * corners.len());
        for (c, &mate) in self.mates.iter().enumerate() {
            meter.tick(c, 2 * self.mates.len())?;
            let f = c / 3;
            let [a, b, apex] = [c, c + 1, c + 2].map(|k| corners[3 * f + k % 3]);
            debug_assert_eq!(a, corners[c]);
            pairs.push((f as u32, c as u32));
            if mate != NONE {
                triangles.extend([a, self.center(mate as usize), self.center(c)]);
                pairs.push((mate / 3, c as u32));
            } else if self.open_side[f] == NONE {
                triangles.extend([a, b, self.center(c)]);
            } else {
                triangles.extend([self.first_new[f], self.first_new[f] + 1, apex]);
            }
        }
        let faces = Relation::from_pairs(old_faces, corners.len(), pairs);
        let mut pairs: Vec<(u32, u32)> = (0..old_vertices as u32).map(|v| (v, v)).collect();
        for (f, face) in self.dense.polygons.iter().enumerate() {
            let first = self.first_new[f];
            match self.open_side[f] {
                NONE => pairs.extend(face.iter().map(|&v| (v, first))),
                open => pairs.extend(
                    [open, (open + 1) % 3]
                        .iter()
                        .flat_map(|&i| [0, 1].map(|k| (face[i as usize], first + k))),
                ),
            }
        }
        let vertices = Relation::from_pairs(old_vertices, old_vertices + self.new_vertices, pairs);
        Ok((Polygons::uniform(3, triangles), Maps { vertices, faces }))
    }

    fn positions(&self) -> Vec<DVec3> {
        let old = &self.dense.positions;
        let mut positions = old.clone();
        positions.resize(old.len() + self.new_vertices, DVec3::ZERO);
        // The sum and number of each vertex's neighbours, and the two along the boundary.
        let mut sums = vec![(DVec3::ZERO, 0u32); old.len()];
        let mut along = vec![[NONE; 2]; old.len()];
        let corners = self.dense.polygons.corners();
        for (c, &mate) in self.mates.iter().enumerate() {
            let (a, b) = (corners[c], corners[c - c % 3 + (c + 1) % 3]);
            let sum = &mut sums[a as usize];
            *sum = (sum.0 + old[b as usize], sum.1 + 1);
            if mate == NONE {
                along[a as usize][1] = b;
                along[b as usize][0] = a;
            }
        }
        let cuts = self.open_side.iter().any(|&s| s != NONE);
        for (v, &(sum, n)) in sums.iter().enumerate() {
            positions[v] = match along[v] {
                [NONE, _] | [_, NONE] if n > 0 => {
                    let n = f64::from(n);
                    let alpha = (4.0 - 2.0 * (std::f64::consts::TAU / n).cos()) / 9.0;
                    old[v] * (1.0 - alpha) + sum * (alpha / n)
                }
                [before, after] if n > 0 && cuts => {
                    (old[before as usize] * 4.0 + old[v] * 19.0 + old[after as usize] * 4.0) / 27.0
                }
                _ => old[v],
            };
        }
        for (f, face) in self.dense.polygons.iter().enumerate() {
            let first = self.first_new[f] as usize;
            match self.open_side[f] {
                NONE => positions[first] = face.iter().map(|&v| old[v as usize]).sum::<DVec3>() / 3.0,
                open => {
                    let [a, b] = [open, (open + 1) % 3].map(|i| face[i as usize]);
                    let (before, after) = (along[a as usize][0], along[b as usize][1]);
                    let [before, a, b, after] = [before, a, b, after].map(|v| old[v as usize]);
                    positions[first] = (before + a * 16.0 + b * 10.0) / 27.0;
                    positions[first + 1] = (a * 10.0 + b * 16.0 + after) / 27.0;
                }
            }
        }
        positions
    }
    /// The corners of its face between which the vertex lies that stands for its centre as a corner's edge sees it.
    fn parents(&self, corner: usize) -> Sources {
        let (first, i) = ((corner - corner % 3) as u32, corner as u32 % 3);
        match self.open_side[corner / 3] {
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
            for (f, &open) in self.open_side.iter().enumerate() {
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
                } else if self.open_side[c / 3] == NONE {
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
                let open = self.open_side[c / 3];
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
