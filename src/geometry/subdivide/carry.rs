//! What becomes of columns at a level: where the values of the finer elements come from.
//!
//! Everything is linear between an element's parents, whatever the scheme does with positions; corners only look at
//! corners of their own face. Where two values weigh the same, the order of sources is that of the edge's first use, so
//! that a rule that picks one picks the same on both sides.

use super::dense::Dense;
use crate::Polygons;
use crate::column::{Columns, Event, Kind, Origin};
use crate::matching::NONE;
use glam::DVec3;
use smallvec::SmallVec;

/// Elements with their weights.
pub(super) type Sources = SmallVec<[(u32, f64); 8]>;

pub(super) fn split<'s>(sources: &'s [(u32, f64)]) -> Origin<'s> {
    Origin::Made(Event::Split, sources)
}

/// A part of one element.
pub(super) fn part(emit: &mut dyn FnMut(Origin<'_>), of: u32) {
    emit(split(&[(of, 1.0)]));
}

/// The mean of all.
fn mean(of: impl ExactSizeIterator<Item = u32>) -> Sources {
    let share = 1.0 / of.len() as f64;
    of.map(|i| (i, share)).collect()
}

/// The old vertices, which come first among the finer positions.
pub(super) fn old_vertices(dense: &Dense, positions: &[DVec3], emit: &mut dyn FnMut(Origin<'_>)) {
    for (v, (old, new)) in (0..).zip(dense.positions.iter().zip(positions)) {
        emit(if old == new { Origin::Same(v) } else { Origin::Moved(v) });
    }
}

/// Where the corners of each face begin, with the face and its uses of edges.
fn each_face(dense: &Dense) -> impl Iterator<Item = (u32, &[u32], &[u32])> {
    let mut c = 0;
    dense.polygons.iter().map(move |face| {
        let first = c;
        c += face.len();
        (first as u32, face, &dense.use_of[first..c])
    })
}

/// Between the corners at the ends of a side, in the order of the edge's first use.
fn middle(first: u32, n: u32, side: u32, u: u32) -> [(u32, f64); 2] {
    let [a, b] = [first + side, first + if side + 1 == n { 0 } else { side + 1 }];
    if u & 1 == 0 { [(a, 0.5), (b, 0.5)] } else { [(b, 0.5), (a, 0.5)] }
}

/// The columns at a level that cuts every edge in two, `has_center` faces about their centres and others in four.
pub(super) fn by_edges(
    columns: &mut Columns,
    dense: &Dense,
    positions: &[DVec3],
    has_center: &dyn Fn(usize) -> bool,
) {
    let parts = |n: usize| if has_center(n) { n } else { 4 };
    let faces: usize = dense.polygons.iter().map(|f| parts(f.len())).sum();
    if !columns.none_on(Kind::Vertex) {
        let ends = dense.ends_of_edges();
        columns.derive(Kind::Vertex, positions.len(), &|emit| {
            old_vertices(dense, positions, emit);
            ends.iter().for_each(|&[a, b]| emit(split(&[(a, 0.5), (b, 0.5)])));
            for face in dense.polygons.iter().filter(|f| has_center(f.len())) {
                emit(split(&mean(face.iter().copied())));
            }
        });
    }
    let corners = 4 * dense.use_of.len();
    columns.derive(Kind::Corner, corners, &|emit| {
        for (first, face, uses) in each_face(dense) {
            let n = face.len() as u32;
            let middle = |i: u32| middle(first, n, i, uses[i as usize]);
            if has_center(face.len()) {
                let center = mean(first..first + n);
                for i in 0..n {
                    emit(Origin::Same(first + i));
                    emit(split(&middle(i)));
                    emit(split(&center));
                    emit(split(&middle((i + n - 1) % n)));
                }
            } else {
                for i in 0..3 {
                    emit(Origin::Same(first + i));
                    emit(split(&middle(i)));
                    emit(split(&middle((i + 2) % 3)));
                }
                (0..3).for_each(|i| emit(split(&middle(i))));
            }
        }
    });
    let edges = 2 * dense.edges + dense.use_of.len();
    columns.derive(Kind::Edge, edges, &|emit| {
        for (_, _, uses) in each_face(dense) {
            for u in uses.iter().filter(|&u| u & 1 == 0) {
                part(emit, u >> 1);
                part(emit, u >> 1);
            }
            uses.iter().for_each(|_| emit(Origin::Nothing));
        }
    });
    columns.derive(Kind::Face, faces, &|emit| {
        for (f, face) in (0..).zip(dense.polygons.iter()) {
            (0..parts(face.len())).for_each(|_| part(emit, f));
        }
    });
}

/// The columns when faces are cut into triangles, given for each triangle its face.
pub(super) fn by_triangles(columns: &mut Columns, old: &Dense, new: &Dense, source: &[u32]) {
    let starts = old.polygons.starts();
    // For each new corner the old one.
    let mut corner_of = vec![NONE; new.positions.len()];
    let mut corners = Vec::with_capacity(new.use_of.len());
    for (triangle, &f) in new.polygons.iter().zip(source) {
        let first = starts[f as usize] as u32;
        (first..).zip(&old.polygons[f as usize]).for_each(|(c, &v)| corner_of[v as usize] = c);
        corners.extend(triangle.iter().map(|&v| corner_of[v as usize]));
    }
    let mut born = vec![Born::Inside; new.edges];
    for (t, &f) in source.iter().enumerate() {
        let range = starts[f as usize] as u32..starts[f as usize + 1] as u32;
        for i in 0..3 {
            let [a, b] = [i, (i + 1) % 3].map(|i| corners[3 * t + i]);
            if b == a + 1 || a + 1 == range.end && b == range.start {
                born[new.use_of[3 * t + i] as usize >> 1] = Born::Whole(old.use_of[a as usize] >> 1);
            }
        }
    }
    columns.derive(Kind::Corner, corners.len(), &|emit| corners.iter().for_each(|&c| emit(Origin::Same(c))));
    columns.derive(Kind::Edge, new.edges, &|emit| born.iter().for_each(|b| b.tell(emit)));
    columns.derive(Kind::Face, source.len(), &|emit| {
        for &f in source {
            if old.polygons[f as usize].len() == 3 { emit(Origin::Same(f)) } else { part(emit, f) }
        }
    });
}

/// What an edge was.
#[derive(Clone, Copy)]
pub(super) enum Born {
    /// Nothing: it lies in a face.
    Inside,
    /// An edge.
    Whole(u32),
    /// A part of an edge.
    Part(u32),
}

impl Born {
    pub(super) fn tell(self, emit: &mut dyn FnMut(Origin<'_>)) {
        match self {
            Self::Inside => emit(Origin::Nothing),
            Self::Whole(e) => emit(Origin::Same(e)),
            Self::Part(e) => part(emit, e),
        }
    }
}

/// Where a corner of a part lies in the face that is cut.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Spot {
    /// At a corner.
    Corner(u32),
    /// In the middle of a side.
    Middle(u32),
    /// At the mean of all corners.
    Center,
}

/// The columns at a level that cuts some edges in two: for each part its face, for each of its corners the spot.
pub(super) fn by_spots(columns: &mut Columns, dense: &Dense, finer: &Dense, source: &[u32], spots: &[Spot]) {
    let old = dense.positions.len();
    let starts = dense.polygons.starts();
    let mut parts = vec![0u32; dense.polygons.len()];
    source.iter().for_each(|&f| parts[f as usize] += 1);
    /// Calls `f` with every part's face and its corners' spots.
    fn each_part<'p>(
        polygons: &'p Polygons,
        source: &'p [u32],
        spots: &'p [Spot],
    ) -> impl Iterator<Item = (u32, usize, &'p [Spot])> {
        source
            .iter()
            .zip(polygons.starts())
            .zip(polygons.iter())
            .map(|((&f, &first), part)| (f, first, &spots[first..first + part.len()]))
    }
    let sources = |f: u32, spot: Spot| -> Sources {
        let (first, end) = (starts[f as usize] as u32, starts[f as usize + 1] as u32);
        match spot {
            Spot::Corner(i) => smallvec::smallvec![(first + i, 1.0)],
            Spot::Middle(i) => {
                middle(first, end - first, i, dense.use_of[(first + i) as usize]).into_iter().collect()
            }
            Spot::Center => mean(first..end),
        }
    };
    if !columns.none_on(Kind::Vertex) {
        // The corners of any part at a vertex tell its parents.
        let mut of: Vec<Sources> = vec![Sources::new(); finer.positions.len() - old];
        for (f, first, spots) in each_part(&finer.polygons, source, spots) {
            for (&v, &spot) in finer.polygons.corners()[first..].iter().zip(spots) {
                if let Some(of) = (v as usize).checked_sub(old).map(|v| &mut of[v])
                    && of.is_empty()
                {
                    let corners = sources(f, spot);
                    of.extend(corners.iter().map(|&(c, w)| (dense.polygons.corners()[c as usize], w)));
                }
            }
        }
        columns.derive(Kind::Vertex, finer.positions.len(), &|emit| {
            (0..old as u32).for_each(|v| emit(Origin::Same(v)));
            of.iter().for_each(|sources| emit(split(sources)));
        });
    }
    columns.derive(Kind::Corner, spots.len(), &|emit| {
        for (f, _, spots) in each_part(&finer.polygons, source, spots) {
            for &spot in spots {
                match spot {
                    Spot::Corner(i) => emit(Origin::Same(starts[f as usize] as u32 + i)),
                    spot => emit(split(&sources(f, spot))),
                }
            }
        }
    });
    if !columns.none_on(Kind::Edge) {
        let mut born = vec![Born::Inside; finer.edges];
        for (f, first, spots) in each_part(&finer.polygons, source, spots) {
            let (start, n) = (starts[f as usize], dense.polygons[f as usize].len() as u32);
            let edge = |i: u32| dense.use_of[start + i as usize] >> 1;
            for (i, &here) in spots.iter().enumerate() {
                let there = spots[(i + 1) % spots.len()];
                born[finer.use_of[first + i] as usize >> 1] = match (here, there) {
                    (Spot::Corner(a), Spot::Corner(b)) if b == (a + 1) % n => Born::Whole(edge(a)),
                    (Spot::Corner(a), Spot::Middle(b)) if a == b => Born::Part(edge(a)),
                    (Spot::Middle(a), Spot::Corner(b)) if b == (a + 1) % n => Born::Part(edge(a)),
                    _ => continue,
                };
            }
        }
        columns.derive(Kind::Edge, finer.edges, &|emit| born.iter().for_each(|b| b.tell(emit)));
    }
    columns.derive(Kind::Face, source.len(), &|emit| {
        for &f in source {
            if parts[f as usize] == 1 { emit(Origin::Same(f)) } else { part(emit, f) }
        }
    });
}
