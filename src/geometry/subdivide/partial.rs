//! Midpoint subdivision of some faces; neighbours are closed so that no vertex lies on an edge.

use super::carry::{self, Spot};
use super::dense::Dense;
use super::{Meter, SubdivideError, build, followed};
use crate::column::Columns;
use crate::matching::NONE;
use crate::report::{Maps, Relation};
use crate::soup::MAX_ELEMENTS;
use crate::{Control, FaceKey, Mesh, Polygons};
use glam::DVec3;

/// The mesh, the maps, and how many faces were cut at the first level.
pub(super) fn subdivide(
    mesh: &Mesh,
    only: &[FaceKey],
    levels: u32,
    limit: u64,
    columns: &mut Columns,
    control: &mut Control<'_>,
) -> Result<(Mesh, Maps, usize), SubdivideError> {
    let mut rank = vec![NONE; mesh.faces.slot_count()];
    mesh.faces.in_user_order().into_iter().zip(0..).for_each(|(f, i)| rank[f as usize] = i);
    let mut selected = vec![false; mesh.face_count()];
    for &f in only {
        let slot = mesh.face_slot(f).ok_or(SubdivideError::MissingFace(f))?;
        selected[rank[slot as usize] as usize] = true;
    }
    // With nothing selected, levels past the first find nothing either.
    let levels = if only.is_empty() { 0 } else { levels };
    let mut dense = Dense::of(mesh);
    let mut maps = Maps::identity(mesh.vertex_count(), mesh.face_count());
    let mut changed = 0;
    for level in 0..levels {
        let [from, to] = [level, level + 1].map(|l| 0.9 * 4f64.powi(l as i32 - levels as i32));
        let mut meter = Meter { control: &mut *control, from, to };
        let cut = Cut::new(&dense, &selected);
        cut.check(level + 1, limit)?;
        let (next, next_selected, next_maps, cut_faces) = cut.run(columns, &mut meter)?;
        maps = if level == 0 { next_maps } else { followed(&maps, &next_maps) };
        if level == 0 {
            changed = cut_faces;
        }
        (dense, selected) = (next, next_selected);
    }
    control.report("build", 0.9)?;
    Ok((build(dense)?, maps, changed))
}

/// One level.
struct Cut<'d> {
    dense: &'d Dense,
    selected: &'d [bool],
    /// By edge: the vertex put on it, or [`NONE`].
    middle: Vec<u32>,
    /// Vertices with those on edges.
    vertices: usize,
}

impl<'d> Cut<'d> {
    fn new(dense: &'d Dense, selected: &'d [bool]) -> Self {
        let mut marked = vec![false; dense.edges];
        let mut c = 0;
        for (face, &is_selected) in dense.polygons.iter().zip(selected) {
            for &u in &dense.use_of[c..c + face.len()] {
                marked[u as usize >> 1] |= is_selected;
            }
            c += face.len();
        }
        let mut vertices = dense.positions.len();
        let number = |&is_marked: &bool| {
            vertices += usize::from(is_marked);
            if is_marked { vertices as u32 - 1 } else { NONE }
        };
        let middle = marked.iter().map(number).collect();
        Self { dense, selected, middle, vertices }
    }

    /// Refuses what is too large, by bounds that no closing exceeds.
    fn check(&self, level: u32, limit: u64) -> Result<(), SubdivideError> {
        let parts =
            |(face, &s): (&[u32], &bool)| if s { face.len() as u64 + u64::from(face.len() == 3) } else { 1 };
        let cut: u64 = self.dense.polygons.iter().zip(self.selected).map(parts).sum();
        // A closed neighbour gains at most one face for each vertex on its sides, and three corners for each face.
        let on_sides = 2 * (self.vertices - self.dense.positions.len()) as u64;
        let faces = cut + on_sides;
        if faces > limit {
            return Err(SubdivideError::TooLarge { level, elements: faces, limit });
        }
        let corners = self.dense.polygons.corners().len() as u64 * 4 + 3 * on_sides;
        let most = corners.max(self.vertices as u64 + self.dense.polygons.len() as u64);
        if most > MAX_ELEMENTS as u64 {
            return Err(SubdivideError::TooLarge { level, elements: most, limit: MAX_ELEMENTS as u64 });
        }
        Ok(())
    }

    fn run(
        self,
        columns: &mut Columns,
        meter: &mut Meter<'_, '_>,
    ) -> Result<(Dense, Vec<bool>, Maps, usize), SubdivideError> {
        let dense = self.dense;
        let old = dense.positions.len();
        let faces = dense.polygons.len();
        let mut positions = dense.positions.clone();
        positions.resize(self.vertices, DVec3::ZERO);
        let mut vertex_pairs: Vec<(u32, u32)> = (0..old as u32).map(|v| (v, v)).collect();
        let mut face_pairs = Vec::new();
        let mut polygons = Polygons::new();
        let mut selected = Vec::new();
        let (mut c, mut cut_faces) = (0, 0);
        let mut middles = Vec::new();
        // For each part its face, and for each corner of it its spot there.
        let is_carrying = !columns.is_empty();
        let (mut source, mut spots) = (Vec::new(), Vec::new());
        for (f, face) in dense.polygons.iter().enumerate() {
            meter.tick(f, faces)?;
            let n = face.len();
            let uses = &dense.use_of[c..c + n];
            c += n;
            middles.clear();
            middles.extend(uses.iter().map(|&u| self.middle[u as usize >> 1]));
            for (i, (&a, &u)) in face.iter().zip(uses).enumerate() {
                let (m, b) = (middles[i], face[(i + 1) % n]);
                if m != NONE && u & 1 == 0 {
                    positions[m as usize] =
                        dense.positions[a as usize] * 0.5 + dense.positions[b as usize] * 0.5;
                    vertex_pairs.extend([(a, m), (b, m)]);
                }
            }
            let count = middles.iter().filter(|&&m| m != NONE).count();
            cut_faces += usize::from(count > 0);
            let before = polygons.len();
            if self.selected[f] && n > 3 {
                let center = positions.len() as u32;
                let scale = 1.0 / n as f64;
                positions.push(face.iter().map(|&v| dense.positions[v as usize] * scale).sum());
                vertex_pairs.extend(face.iter().map(|&v| (v, center)));
                for i in 0..n {
                    polygons.push([face[i], middles[i], center, middles[(i + n - 1) % n]]);
                }
            } else if let &[a, b, d] = face {
                close(&dense.positions, [a, b, d], [middles[0], middles[1], middles[2]], &mut polygons);
            } else {
                let with = |(&a, &m): (&u32, &u32)| [a, m].into_iter().filter(|&v| v != NONE);
                polygons.push(face.iter().zip(&middles).flat_map(with));
            }
            for part in before..polygons.len() {
                face_pairs.push((f as u32, part as u32));
                selected.push(self.selected[f]);
                if is_carrying {
                    source.push(f as u32);
                    spots.extend(polygons[part].iter().map(|&v| spot(v, face, &middles)));
                }
            }
        }
        let maps = Maps {
            vertices: Relation::from_pairs(old, positions.len(), vertex_pairs),
            faces: Relation::from_pairs(faces, polygons.len(), face_pairs),
        };
        let finer = Dense::matched(positions, polygons);
        if is_carrying {
            carry::by_spots(columns, dense, &finer, &source, &spots);
        }
        Ok((finer, selected, maps, cut_faces))
    }
}

/// Where a corner of a part lies in its face.
fn spot(v: u32, face: &[u32], middles: &[u32]) -> Spot {
    let place = |of: &[u32]| of.iter().position(|&w| w == v).map(|i| i as u32);
    place(face).map_or_else(|| place(middles).map_or(Spot::Center, Spot::Middle), Spot::Corner)
}

/// Cuts a triangle with vertices on some of its sides into triangles.
fn close(at: &[DVec3], corners: [u32; 3], middles: [u32; 3], into: &mut Polygons) {
    let marked = middles.map(|m| m != NONE);
    // Turned so that the first side is cut, and of two the last is the other.
    let turn = match marked {
        [false, false, false] => return into.push(corners),
        [true, true, true] => 0,
        [true, false, _] => 0,
        [_, true, false] => 1,
        [false, _, true] => 2,
    };
    let [a, b, d] = [0, 1, 2].map(|i| corners[(turn + i) % 3]);
    let [m, n, k] = [0, 1, 2].map(|i| middles[(turn + i) % 3]);
    match (n != NONE, k != NONE) {
        (true, _) => [[a, m, k], [b, n, m], [d, k, n], [m, n, k]].into_iter().for_each(|t| into.push(t)),
        (false, false) => [[a, m, d], [m, b, d]].into_iter().for_each(|t| into.push(t)),
        (false, true) => {
            // The corner between the cut sides, and the rest along its shorter diagonal: m-d or b-k.
            into.push([a, m, k]);
            let [pa, pb, pd] = [a, b, d].map(|v| at[v as usize]);
            let (m_d, b_k) = ((pa * 0.5 + pb * 0.5).distance(pd), (pa * 0.5 + pd * 0.5).distance(pb));
            if m_d < b_k || m_d == b_k && d < b {
                into.push([m, b, d]);
                into.push([m, d, k]);
            } else {
                into.push([m, b, k]);
                into.push([b, d, k]);
            }
        }
    }
}
